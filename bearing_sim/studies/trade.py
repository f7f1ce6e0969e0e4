# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy: every level, integrator and tolerance or step on the same manoeuvre, against a tight reference.

The manoeuvre starts at a scene's conditions, halves the load, restores it, and slows the shaft by a fifth: what a level leaves out of
a transient shows as well as what it leaves out of a steady state.  Its parts are counted in cage turns, so that it does as much to a slow
bearing as to a fast one.  All times are processor times of one core.
"""

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, load_scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.tables.store import obtain_table

TURNS = 160  # of the cage in a manoeuvre
_SETTLING = 48  # of them not judged
_BIN = 1.5  # cage turns over which slip and loads are compared: trajectories with impacts part in phase, their means do not
_PER_BIN = 8  # samples
# Cage turn at which a manoeuvre's inputs stand at shares of the scene's speed and load; they go linearly between.
_COURSE = ((0, 1.0, 1.0), (72, 1.0, 1.0), (78, 1.0, 0.5), (102, 1.0, 0.5), (108, 1.0, 1.0), (120, 1.0, 1.0), (132, 0.8, 1.0), (TURNS, 0.8, 1.0))
_REFERENCE = 1e-4  # tolerance of the reference
_CHECK = 4e-4  # of the run that tells how far the reference itself may be off
_ENOUGH = 1.0  # s of processor time after which a setting's speed is known well enough
_REPEATS = 3


class Setting(NamedTuple):
    """One way to compute a scene, as overrides of its file."""

    level: str
    method: str
    detail: str  # tolerance, step or slices, in words
    overrides: tuple[str, ...]

    @property
    def name(self) -> str:
        """What tables and pictures call it."""
        return " ".join(part for part in (self.level, self.method, self.detail) if part)


class Course(NamedTuple):
    """What comes out of a manoeuvre, by bins."""

    slip: np.ndarray  # mean cage slip [%]
    load: np.ndarray  # mean of the largest roller load of an instant [N]
    damage: float  # from the end of settling on


class Traded(NamedTuple):
    """One setting measured."""

    setting: Setting
    real_time_factor: float
    slip_error: float  # root mean square over bins [percentage points]
    largest_slip_error: float  # of any bin [percentage points]: what an instant may be off
    load_error: float  # root mean square over bins, relative to the mean
    life_error: float  # relative, of the life that the damage of the manoeuvre means
    fault: str  # why there is nothing, or empty


class Trade(NamedTuple):
    """All settings, the best of them, and what they are measured against."""

    measured: list[Traded]
    front: list[int]  # of slip error over real-time factor, fastest first
    reference: str
    own_error: tuple[float, float, float, float]  # of the reference: slip and its largest [percentage points], load, life
    simulated: float  # s
    left_out: dict[str, str]  # levels that cannot compute the scene, and why


def settings_of(level: str, quick: bool = False) -> list[Setting]:
    """Return the settings of a level that are compared: methods at tolerances, fixed steps, numbers of slices; a table has one."""
    if LEVELS[level].advance_course is not None:
        return [Setting(level, "", "table", ())]
    methods, found = LEVELS[level].methods, []
    for method in list(methods)[: 1 if quick else None]:
        by = f"integration.method={method}"
        for tolerance in (1e-2,) if quick else (3e-2, 1e-2, 3e-3, 1e-3):
            found.append(Setting(level, method, f"tolerance {tolerance:g}", (by, f"integration.relative_tolerance={tolerance:g}")))
        if methods[method].advance_fixed is not None and not quick:
            found += [Setting(level, method, f"step {step} us", (by, f"integration.fixed_step={step} us")) for step in (5, 10, 20, 40)]
    if level == "spatial" and not quick:
        found += [Setting(level, "", f"{count} slices", (f"bearing.roller.slices={count}",)) for count in (5, 10, 50, 200)]
    return found


def trade(name: str, overrides: Sequence[str], levels: Sequence[str] = (), quick: bool = False, tell: Callable[[str], None] = print) -> Trade:
    """Measure all settings on one scene.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene_file.load_scene` takes them.
    levels : to measure; all where empty.
    quick : next to nothing, to see that everything works.
    tell : takes a line of progress.

    Raises
    ------
    SceneError
        The scene itself is faulty.
    ValueError
        The scene's shaft is at rest, or no level wanted can compute it.
    IntegrationError
        The reference did not come to its end.
    """
    if load_scene(name, overrides).operating.shaft_speed == 0.0:
        raise ValueError("operating.shaft_speed: 0; at rest there is nothing to trade, give a speed")
    able, left_out = {}, {}
    for level in LEVELS:
        try:
            able[level] = load_scene(name, [*overrides, f"level={level}"])
        except SceneError as fault:
            left_out[level] = str(fault)
    wanted = [level for level in able if not levels or level in levels]
    if not wanted:
        raise ValueError(f"no level of {', '.join(levels)} can compute this scene: {'; '.join(left_out.values())}")
    best = "planar" if "planar" in able else list(able)[-1]  # with nothing that tilts or leans, spatial is planar to round-off
    turns = _SETTLING + 24 if quick else TURNS
    tell(f"reference: {best}")
    reference, own = _reference(able[best], turns, quick)
    measured = []
    for level in wanted:
        for setting in settings_of(level, quick):
            tell(setting.name)
            measured.append(_measure(load_scene(name, [*overrides, f"level={level}", *setting.overrides]), setting, reference, turns))
    told = f"{best} by {able[best].integration.method or next(iter(LEVELS[best].methods))} at a tolerance of {_CHECK if quick else _REFERENCE:g}"
    return Trade(measured, front_of(measured, own[0]), told, own, turns * _turn(able[best]), left_out)


def front_of(measured: Sequence[Traded], certain: float = 0.0) -> list[int]:
    """Return which settings no other beats in both speed and slip error, the fastest first.

    Parameters
    ----------
    measured : settings; those with a fault are on no front.
    certain : the reference's own error [percentage points]: two errors below it are equal.
    """
    front, least = [], math.inf
    for k in sorted(range(len(measured)), key=lambda k: (-measured[k].real_time_factor, measured[k].slip_error)):
        error = max(measured[k].slip_error, certain)
        if not measured[k].fault and error < least:
            front.append(k)
            least = error
    return front


def recommend(found: Trade, factor: float | None = None, error: float | None = None) -> Traded | None:
    """Return the least slip error at a real-time factor or above, or the fastest setting within a slip error; None if there is none.

    Parameters
    ----------
    factor : times real time.
    error : of slip [percentage points].
    """
    front = [found.measured[k] for k in found.front]  # faster and less exact before slower and more exact
    within = [one for one in front if (factor is None or one.real_time_factor >= factor) and (error is None or one.slip_error <= error)]
    if not within:
        return None
    return within[-1] if error is None else within[0]


def _reference(scene, turns, quick):
    tolerances = (_CHECK, 4 * _CHECK) if quick else (_REFERENCE, _CHECK)
    courses = [_run(_with_tolerance(scene, tolerance), turns)[0] for tolerance in tolerances]
    return courses[0], _errors(courses[1], courses[0])


def _with_tolerance(scene: Scene, tolerance: float) -> Scene:
    return dataclasses.replace(scene, integration=dataclasses.replace(scene.integration, relative_tolerance=tolerance))


def _measure(scene, setting, reference, turns):
    try:
        Simulation(scene).advance(1e-6)  # compiles
        course, spent = _run(scene, turns)  # a table that has to be built is built here, and not counted
        for _ in range(_REPEATS - 1):
            if spent > _ENOUGH:
                break
            spent = min(spent, _run(scene, turns)[1])
    except IntegrationError as fault:
        return Traded(setting, *[math.nan] * 5, str(fault))
    return Traded(setting, turns * _turn(scene) / spent, *_errors(course, reference), "")


def _turn(scene) -> float:
    """Return the time of one turn of a cage without slip [s]."""
    return 2 * math.pi / abs(0.5 * scene.operating.shaft_speed * (1.0 - scene.bearing.diameter_ratio))


def _run(scene, turns):
    """Run the manoeuvre; return its course and the processor time spent."""
    start, turn = scene_inputs(scene), _turn(scene)
    edges = sorted({*np.arange(0.0, turns + 1e-9, _BIN).tolist(), *(at for at, _, _ in _COURSE if at < turns), float(turns)})
    whole, spent = (_look_up if LEVELS[scene.level].advance_course is not None else _march)(scene, start, turn, edges)
    settled = whole["time"] > (_SETTLING + 1e-6) * turn
    bins = np.floor(whole["time"][settled] / (_BIN * turn) - 1e-6).astype(int)
    _, bins = np.unique(bins, return_inverse=True)
    slip = 100.0 * whole["cage_slip"][settled]
    load = np.maximum(whole["inner_load"], whole["outer_load"]).max(axis=1)[settled]
    damage = whole["damage"][-1] - whole["damage"][~settled][-1]
    return Course(_means(slip, bins), _means(load, bins), float(damage)), spent


def _look_up(scene, start, turn, edges):
    """Run a level that looks up operating points: a sample at each edge, all at once, for it has nothing to tell in between."""
    run = Simulation(scene, table=obtain_table(scene, (start.oil_temperature, start.oil_temperature))[0])
    inputs, stretches = np.array([_inputs_at(edge, start) for edge in edges[1:]]), np.diff(edges) * turn
    run.advance_course(stretches[:1] * 1e-6, inputs[:1])  # compiles
    run.reset()
    clock = time.process_time()
    whole = run.advance_course(stretches, inputs)
    return whole, time.process_time() - clock


def _march(scene, start, turn, edges):
    """Run a level that marches; return samples and the processor time spent."""
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
