# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy: every level and tolerance or step on the same manoeuvre, against a tight reference.

The manoeuvre starts at a scene's conditions, halves the load, restores it, and slows the shaft by a fifth, so that errors show in
transients as well as in steady states.  Its parts are measured in cage turns, so that slow and fast bearings see the same manoeuvre.
All times are processor times of one core.
"""

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.levels.steady.table_builder import obtain_table
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.sweep.table import new_figure

TURNS = 160  # of the cage in a manoeuvre
_SETTLING = 48  # of these, ignored at the start
_BIN = 1.5  # cage turns over which slip and loads are averaged: trajectories with impacts diverge in phase, their means do not
_PER_BIN = 8  # samples
# Cage turn, and fractions of the scene's speed and load there; linear in between.
_COURSE = ((0, 1.0, 1.0), (72, 1.0, 1.0), (78, 1.0, 0.5), (102, 1.0, 0.5), (108, 1.0, 1.0), (120, 1.0, 1.0), (132, 0.8, 1.0), (TURNS, 0.8, 1.0))
_REFERENCE = 0.01  # times the default tolerances, of the reference
_CHECK = 0.04  # times the default tolerances, of the run that estimates the reference's own error
_FACTORS = (3.0, 1.0, 0.3, 0.1, 0.03)  # times the default tolerances, to compare
_ENOUGH = 1.0  # s of processor time after which a setting is not timed again
_REPEATS = 3


class Setting(NamedTuple):
    """One way to compute a scene, as overrides of its file."""

    level: str
    detail: str  # tolerances, step or slices, as text
    overrides: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name in tables and pictures."""
        return f"{self.level} {self.detail}"


class Course(NamedTuple):
    """Results of a manoeuvre, by bins."""

    slip: np.ndarray  # mean cage slip [%]
    load: np.ndarray  # mean of the largest roller load at each instant [N]
    damage: float  # after settling


class Traded(NamedTuple):
    """Measured speed and errors of one setting."""

    setting: Setting
    real_time_factor: float
    slip_error: float  # root mean square over bins [percentage points]
    largest_slip_error: float  # of any bin [percentage points]
    load_error: float  # root mean square over bins, relative to the mean
    life_error: float  # relative, from the damage of the manoeuvre
    failure: str  # why there is no result, or empty


class Trade(NamedTuple):
    """All settings, their Pareto front and the reference."""

    measured: list[Traded]
    front: list[int]  # Pareto front of slip error and real-time factor, fastest first
    reference: str
    own_error: tuple[float, float, float, float]  # of the reference: slip, largest slip error [percentage points], load, life
    simulated: float  # s
    left_out: dict[str, str]  # levels that cannot compute the scene, and why


def settings_of(level: str, quick: bool = False) -> list[Setting]:
    """Return the settings of a level: tolerances, fixed steps, numbers of slices; only one for a table."""
    if LEVELS[level].advance_profile is not None:
        return [Setting(level, "table", ())]
    found = [
        Setting(level, f"tolerances x {factor:g}", tuple(tolerance_overrides(factor)) if factor != 1.0 else ())
        for factor in ((1.0,) if quick else _FACTORS)
    ]
    if quick:
        return found
    found += [Setting(level, f"step {step} us", (f"integration.fixed_step={step} us",)) for step in (5, 10, 20, 40)]
    if level == "spatial":
        found += [Setting(level, f"{count} slices", (f"bearing.roller.slices={count}",)) for count in (5, 10, 50, 200)]
    return found


def trade(
    name: str,
    overrides: Sequence[str],
    levels: Sequence[str] = (),
    quick: bool = False,
    progress: Callable[[str], None] = print,
    against: str | None = None,
) -> Trade:
    """Measure all settings on one scene.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene.loader.load_scene` takes them.
    levels : to measure; empty: all.
    quick : measure as little as possible, for testing.
    progress : called with the name of each setting.
    against : level of the reference; None: `planar`, or the highest level that can compute the scene where planar cannot.

    Raises
    ------
    SceneError
        The scene is invalid.
    ValueError
        The shaft of the scene is at rest, or none of the levels can compute it.
    IntegrationError
        The run of the reference stopped early.
    """
    if load_scene(name, overrides).operating.shaft_speed == 0.0:
        raise ValueError("operating.shaft_speed: 0; expected a rotating shaft")
    able, left_out = {}, {}
    for level in LEVELS:
        try:
            able[level] = load_scene(name, [*overrides, f"level={level}"])
        except SceneError as error:
            left_out[level] = str(error)
    wanted = [level for level in able if not levels or level in levels]
    if not wanted:
        raise ValueError(f"none of {', '.join(levels)} can compute this scene: {'; '.join(left_out.values())}")
    if against is not None and against not in able:
        raise ValueError(f"level {against} cannot compute this scene: {left_out[against]}")
    best = against or ("planar" if "planar" in able else list(able)[-1])  # without tilting, spatial equals planar to round-off
    turns = _SETTLING + 24 if quick else TURNS
    progress(f"reference: {best}")
    reference, own = _reference(able[best], turns, quick)
    measured = []
    for level in wanted:
        for setting in settings_of(level, quick):
            progress(setting.name)
            measured.append(_measure(load_scene(name, [*overrides, f"level={level}", *setting.overrides]), setting, reference, turns))
    described = f"{best} with tolerances x {_CHECK if quick else _REFERENCE:g}"
    return Trade(measured, front_of(measured, own[0]), described, own, turns * _turn(able[best]), left_out)


def front_of(measured: Sequence[Traded], certain: float = 0.0) -> list[int]:
    """Return the Pareto front: settings that no other beats in both speed and slip error, the fastest first.

    Parameters
    ----------
    measured : settings; failed ones are ignored.
    certain : the reference's own error [percentage points]; errors below it count as equal.
    """
    front, least = [], math.inf
    for k in sorted(range(len(measured)), key=lambda k: (-measured[k].real_time_factor, measured[k].slip_error)):
        error = max(measured[k].slip_error, certain)
        if not measured[k].failure and error < least:
            front.append(k)
            least = error
    return front


def recommend(found: Trade, factor: float | None = None, error: float | None = None) -> Traded | None:
    """Return the most accurate setting with at least a real-time factor, or the fastest within a slip error; None if there is none.

    Parameters
    ----------
    factor : smallest real-time factor.
    error : largest slip error [percentage points].
    """
    front = [found.measured[k] for k in found.front]  # from fast to accurate
    within = [one for one in front if (factor is None or one.real_time_factor >= factor) and (error is None or one.slip_error <= error)]
    if not within:
        return None
    return within[-1] if error is None else within[0]


def _reference(scene, turns, quick):
    factors = (_CHECK, 4 * _CHECK) if quick else (_REFERENCE, _CHECK)
    courses = [_run(dataclasses.replace(scene, integration=scene.integration.with_tolerances(factor)), turns)[0] for factor in factors]
    return courses[0], _errors(courses[1], courses[0])


def _measure(scene, setting, reference, turns):
    try:
        Simulation(scene).advance(1e-6)  # compiles
        course, spent = _run(scene, turns)  # builds a missing table, which is not timed
        for _ in range(_REPEATS - 1):
            if spent > _ENOUGH:
                break
            spent = min(spent, _run(scene, turns)[1])
    except IntegrationError as error:
        return Traded(setting, *[math.nan] * 5, str(error))
    return Traded(setting, turns * _turn(scene) / spent, *_errors(course, reference), "")


def _turn(scene) -> float:
    """Return the time of one turn of a cage without slip [s]."""
    return 2 * math.pi / abs(0.5 * scene.operating.shaft_speed * (1.0 - scene.bearing.diameter_ratio))


def _run(scene, turns):
    """Run the manoeuvre; return its results and the processor time."""
    start, turn = scene_inputs(scene), _turn(scene)
    edges = sorted({*np.arange(0.0, turns + 1e-9, _BIN).tolist(), *(at for at, _, _ in _COURSE if at < turns), float(turns)})
    whole, spent = (_look_up if LEVELS[scene.level].advance_profile is not None else _march)(scene, start, turn, edges)
    settled = whole["time"] > (_SETTLING + 1e-6) * turn
    bins = np.floor(whole["time"][settled] / (_BIN * turn) - 1e-6).astype(int)
    _, bins = np.unique(bins, return_inverse=True)
    slip = 100.0 * whole["cage_slip"][settled]
    load = np.maximum(whole["inner_load"], whole["outer_load"]).max(axis=1)[settled]
    damage = whole["damage"][-1] - whole["damage"][~settled][-1]
    return Course(_means(slip, bins), _means(load, bins), float(damage)), spent


def _look_up(scene, start, turn, edges):
    """Run a level that looks up operating points, in one call with a sample at each edge; return samples and processor time."""
    run = Simulation(scene, table=obtain_table(scene, (start.oil_temperature, start.oil_temperature))[0])
    inputs, stretches = np.array([_inputs_at(edge, start) for edge in edges[1:]]), np.diff(edges) * turn
    run.advance_profile(stretches[:1] * 1e-6, inputs[:1])  # compiles
    run.reset()
    clock = time.process_time()
    whole = run.advance_profile(stretches, inputs)
    return whole, time.process_time() - clock


def _march(scene, start, turn, edges):
    """Run a level that integrates; return samples and processor time."""
    run, blocks, spent = Simulation(scene), [], 0.0
    for begin, end in zip(edges, edges[1:]):
        samples = max(round(_PER_BIN * (end - begin) / _BIN), 1)
        inputs = _inputs_at(end, start)
        clock = time.process_time()
        block = run.advance((end - begin) * turn, inputs, samples=samples)
        spent += time.process_time() - clock
        blocks.append(block)
    return np.concatenate(blocks), spent


def _means(values, bins):
    return np.bincount(bins, values) / np.bincount(bins)


def _inputs_at(turn, start: Inputs) -> Inputs:
    at = [row[0] for row in _COURSE]
    speed, load = (np.interp(turn, at, [row[column] for row in _COURSE]) for column in (1, 2))
    return Inputs(start.shaft_speed * float(speed), start.load_y * float(load), start.load_z * float(load), start.oil_temperature)


def _errors(course, reference):
    away = np.abs(course.slip - reference.slip)
    load = np.sqrt(np.mean((course.load - reference.load) ** 2)) / reference.load.mean()
    life = abs(reference.damage / course.damage - 1.0) if course.damage > 0.0 else math.inf
    return float(np.sqrt(np.mean(away**2))), float(away.max()), float(load), float(life)


# Okabe and Ito's colours, safe for colour-blind readers, and a marker for each level
_LEVELS = {"steady": ("#009e73", "D"), "slip": ("#0072b2", "o"), "planar": ("#d55e00", "s"), "spatial": ("#cc79a7", "^")}
_FLOORS = (1e-4, 1e-4, 1e-4)  # smallest error shown on each logarithmic axis


def draw(path: Path, title: str, found: Trade) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(14, 5.6)
    names = ("slip_error", "load_error", "life_error")
    labels = ("error of cage slip [percentage points]", "error of the largest roller load", "error of the life")
    own_errors = found.own_error[0], *found.own_error[2:]
    for axes, name, label, own, floor in zip(figure.subplots(1, 3, sharex=True), names, labels, own_errors, _FLOORS):
        _draw_errors(axes, found, name, floor)
        axes.axhspan(floor / 2, max(own, floor), color="0.88", zorder=0, label="error of the reference")
        axes.set(xscale="log", yscale="log", xlabel="real-time factor, one core", ylabel=label)
        axes.set_ylim(bottom=floor / 2)
        axes.axvline(1.0, color="0.6", lw=0.8)
        axes.grid(alpha=0.25)
    _draw_front(figure.axes[0], found)
    handles, names = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=len(names), frameon=False)
    figure.suptitle(f"{title}\nagainst {found.reference}, over {found.simulated:.3g} s")
    figure.savefig(path, dpi=130)


def _draw_errors(axes, found, name, floor):
    for level in dict.fromkeys(one.setting.level for one in found.measured):
        mine = [one for one in found.measured if one.setting.level == level and not one.failure]
        colour, marker = _LEVELS[level]
        errors = np.maximum([getattr(one, name) for one in mine], floor)
        axes.plot([one.real_time_factor for one in mine], errors, marker, color=colour, ms=6, alpha=0.8, label=level)


def _draw_front(axes, found):
    """Join the settings of the front, and name the fastest of each level."""
    front = [found.measured[k] for k in found.front]
    factors, errors = [one.real_time_factor for one in front], np.maximum([one.slip_error for one in front], _FLOORS[0])
    axes.step(factors, errors, where="post", color="0.3", lw=1.0, label="Pareto front", zorder=1)
    for level in dict.fromkeys(one.setting.level for one in front):
        best = next(one for one in front if one.setting.level == level)
        point = best.real_time_factor, max(best.slip_error, _FLOORS[0])
        axes.annotate(best.setting.detail, point, (-4, 9), textcoords="offset points", fontsize=8, ha="right")
