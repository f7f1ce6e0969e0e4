# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Speed against accuracy: every level and tolerance or step on the same course, against a tight reference.

A course (`bearing_sim.studies.trade_course`) is one of the built-in ones or windows of a log; errors show in its transients as well as in
its steady states.  Each setting runs each window as a task of its own, so an interrupted trade resumes.  Every window begins in
the state to which level ``steady`` settles at its first inputs, in thermal equilibrium where the scene has a thermal network.  All times are
processor times of one core.
"""

import dataclasses
import math
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.levels.steady.table import Table, empty_table
from bearing_sim.levels.steady.table_builder import obtain_table
from bearing_sim.model.table_span import rounded_temperatures, spanning
from bearing_sim.scene.fidelity import WHIRLING
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, complete_overrides
from bearing_sim.scene.scene import Integration, Scene, tolerance_overrides
from bearing_sim.simulation import Inputs, IntegrationError, Simulation
from bearing_sim.studies.correction_points import obtain_corrected_table
from bearing_sim.studies.trade_course import BIN, Course, Window, bin_edges, built_in, cage_rate, turned
from bearing_sim.sweep.pictures import new_figure, plain_numbers
from bearing_sim.sweep.tasks import Journal, Task, program_hash, run_tasks, task
from bearing_sim.sweep.thermal import equilibrium_temperatures

_PER_BIN = 8  # samples
_REFERENCE = 0.01  # times the default tolerances, of the reference
_CHECK = 0.04  # times the default tolerances, of the run that estimates the reference's own error
_FACTORS = (3.0, 1.0, 0.6, 0.3, 0.15, 0.08, 0.03)  # times the default tolerances, to compare: factors of two below the default ones
_ENOUGH = 1.0  # s of processor time after which a setting is not timed again
_REPEATS = 3
_SHORT, _OFTEN = 0.01, 10  # s of processor time below which a run is timed so many times as often
_MOST_SLICES = 200  # of the settings; edge loads are compared with theirs
_FIRST_REST, _LONGEST_REST, _RESTS = 20.0, 2000.0, 1e-4  # cage turns in which the start settles, and the change of slip that counts as rest
_MORE_SOURCES = ("studies/trade_course.py", "studies/correction_points.py", "watchers/estimation/*.py")  # that results depend on


class Candidate(NamedTuple):
    """One way to compute a scene, as overrides of its file."""

    level: str
    detail: str  # tolerances, step or slices, as text
    overrides: tuple[str, ...]

    @property
    def name(self) -> str:
        """Name in tables and pictures."""
        return f"{self.level} {self.detail}"


class Results(NamedTuple):
    """Results of one window, by bins."""

    slip: np.ndarray  # mean cage slip [%]
    load: np.ndarray  # mean of the largest roller load at each instant [N]
    damage: float  # after settling
    edge: np.ndarray  # mean of the largest pressure of end laminae at each instant [Pa]; 0 at a level without slices
    pressure: np.ndarray  # mean of the largest pressure of any lamina at each instant [Pa]; likewise


class Errors(NamedTuple):
    """Errors of a setting over all windows.

    Attributes
    ----------
    slip, largest_slip : root mean square over bins, and of any bin [percentage points].
    load, largest_load : of the largest roller load, likewise, relative to its mean.
    life : relative, from the damage of all windows together.
    window_life : the largest of any window.
    edge, largest_edge : of the largest pressure of end laminae, over bins, relative to the mean of the largest pressure of any lamina; against level
        ``spatial`` with 200 slices, NaN where that was not measured and at levels without slices.
    """

    slip: float
    largest_slip: float
    load: float
    largest_load: float
    life: float
    window_life: float
    edge: float = math.nan
    largest_edge: float = math.nan


NO_ERRORS = Errors(*[math.nan] * len(Errors._fields))
"""The errors of a setting that has no result."""


class Traded(NamedTuple):
    """Measured speed and errors of one setting."""

    setting: Candidate
    real_time_factor: float
    errors: Errors
    failure: str = ""  # why there is no result, or empty
    overrides: tuple[str, ...] = ()  # all of integration and slices, also what is default or comes from the scene


class Trade(NamedTuple):
    """All settings, their Pareto front and the reference.

    Attributes
    ----------
    measured : the settings.
    front : Pareto front of slip error and real-time factor, the fastest first.
    reference : in words.
    own_error : of the reference.
    course : what was measured on.
    left_out : levels that cannot compute the scene, and why.
    reference_level : of the reference.
    """

    measured: list[Traded]
    front: list[int]
    reference: str
    own_error: Errors
    course: Course
    left_out: dict[str, str]
    reference_level: str = "planar"

    @property
    def is_complete(self) -> bool:
        """Whether errors against the reference leave nothing out (see `has_all`)."""
        return has_all(self.reference_level, self.left_out)

    @property
    def simulated(self) -> float:
        """Simulated time of each setting [s]."""
        return self.course.measured


def has_all(reference: str, left_out: Mapping[str, str]) -> bool:
    """Return whether a level vibrates and whirls, as that of a reference, or no level can that computes the scene; ``left_out`` as of `Trade`."""
    return reference in WHIRLING or all(level in left_out for level in WHIRLING)


def settings_of(level: str, quick: bool = False) -> list[Candidate]:
    """Return the settings of a level: tolerances, fixed steps, numbers of slices; only one for a table."""
    if LEVELS[level].advance_profile is not None:
        plain = Candidate(level, "table", ("table.correction=none",))
        return [plain] if quick else [plain, Candidate(level, "table corrected by planar", ("table.correction=planar",))]
    found = [
        Candidate(level, f"tolerances x {factor:g}", tuple(tolerance_overrides(factor)) if factor != 1.0 else ())
        for factor in ((1.0,) if quick else _FACTORS)
    ]
    if quick:
        return found
    found += [Candidate(level, f"step {step} us", (f"integration.fixed_step={step} us",)) for step in (5, 10, 20, 40)]
    if level == "spatial":
        found += [Candidate(level, f"{count} slices", (f"bearing.roller.slices={count}",)) for count in (10, 20, 50, _MOST_SLICES)]
    return found


def able_levels(name: str, overrides: Sequence[str]) -> tuple[dict[str, Scene], dict[str, str]]:
    """Return a scene at each level that can compute it, and why the others cannot; `SceneError` if the scene itself is invalid."""
    load_scene(name, overrides)
    able, left_out = {}, {}
    for level in LEVELS:
        try:
            able[level] = load_scene(name, [*overrides, f"level={level}"])
        except SceneError as error:
            left_out[level] = str(error)
    return able, left_out


def trade(
    name: str,
    overrides: Sequence[str],
    levels: Sequence[str] = (),
    quick: bool = False,
    progress: Callable[[int, int], None] = lambda done, total: None,
    against: str | None = None,
    course: str | Callable[[Scene], Course] = "manoeuvre",
    journal: Path | None = None,
    workers: int | None = None,
) -> Trade:
    """Measure all settings on one scene.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene.loader.load_scene` takes them.
    levels : to measure; empty: all.
    quick : measure as little as possible, for testing.
    progress : called with the number of finished runs and of all that are not in the journal.
    against : level of the reference; None: `planar`, or the highest level that can compute the scene where planar cannot.
    course : name of a built-in course, or a function that returns the course of a scene (see `bearing_sim.studies.trade_course`).
    journal : file from which an interrupted trade of the same scene, course and program resumes; None: it cannot.
    workers : number of processes; None: one per core.

    Raises
    ------
    SceneError
        The scene is invalid.
    ValueError
        The shaft does not turn, or none of the levels can compute the scene.
    IntegrationError
        The run of the reference stopped early.
    bearing_sim.sweep.tasks.JournalInUse
        Another process is writing the journal.
    """
    able, left_out = able_levels(name, overrides)
    if isinstance(course, str) and load_scene(name, overrides).operating.shaft_speed == 0.0:
        raise ValueError("operating.shaft_speed: 0; expected a rotating shaft")
    wanted = [level for level in able if not levels or level in levels]
    if not wanted:
        raise ValueError(f"none of {', '.join(levels)} can compute this scene: {'; '.join(left_out.values())}")
    if against is not None and against not in able:
        raise ValueError(f"level {against} cannot compute this scene: {left_out[against]}")
    best = against or ("planar" if "planar" in able else list(able)[-1])  # without tilting, spatial equals planar to round-off
    found = built_in(course, able[best], quick) if isinstance(course, str) else course(able[best])
    factors = (_CHECK, 4 * _CHECK) if quick else (_REFERENCE, _CHECK)
    tight = [dataclasses.replace(able[best], integration=able[best].integration.with_tolerances(factor)) for factor in factors]
    settings = [setting for level in wanted for setting in settings_of(level, quick)]
    scenes = [load_scene(name, [*overrides, f"level={setting.level}", *setting.overrides]) for setting in settings]
    fastest = found.extent()["shaft_speed"][1]
    scenes = [spanning(scene, fastest) if scene.level == "steady" else scene for scene in scenes]
    without = {k: why for k, scene in enumerate(scenes) if scene.level == "steady" and (why := _why_no_table(scene, found, workers))}
    tasks = [task for scene in tight for task in _tasks(scene, found, 1)]
    tasks += [task for k, scene in enumerate(scenes) if k not in without for task in _tasks(scene, found, _REPEATS)]
    with Journal(journal) as kept:
        results = run_tasks(tasks, kept, workers, None, progress)
    size = len(found.windows)
    runs = [results[begin : begin + size] for begin in range(0, len(results), size)]
    for k, why in sorted(without.items()):
        runs.insert(2 + k, [{"failure": why}])
    for run in runs[:2]:
        if failure := _failure(run):
            raise IntegrationError(failure)
    reference, check = (_results(run) for run in runs[:2])
    measured = [_traded(setting, run, reference) for setting, run in zip(settings, runs[2:])]
    measured = _with_edges(measured, runs[2:])
    measured = [one._replace(overrides=complete_overrides(scene)) for one, scene in zip(measured, scenes)]
    described = f"{best} with tolerances x {factors[0]:g}"
    own = _errors(check, reference)
    return Trade(measured, front_of(measured, own.slip), described, own, found, left_out, best)


def front_of(measured: Sequence[Traded], certain: float = 0.0) -> list[int]:
    """Return the Pareto front: settings that no other beats in both speed and slip error, the fastest first.

    Parameters
    ----------
    measured : settings; failed ones are ignored.
    certain : the reference's own error [percentage points]; errors below it count as equal.
    """
    front, least = [], math.inf
    for k in sorted(range(len(measured)), key=lambda k: (-measured[k].real_time_factor, measured[k].errors.slip)):
        error = max(measured[k].errors.slip, certain)
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
    within = [one for one in front if (factor is None or one.real_time_factor >= factor) and (error is None or one.errors.slip <= error)]
    if not within:
        return None
    return within[-1] if error is None else within[0]


def measured_course(found: Trade) -> MeasuredCourse:
    """Return what a trade leaves for later: its settings with a result, and where they were measured."""
    settings = [
        Setting(one.setting.level, one.setting.detail, one.overrides, one.real_time_factor, one.errors._asdict())
        for one in found.measured
        if not one.failure
    ]
    return MeasuredCourse(found.course.name, found.reference, found.own_error._asdict(), found.course.extent(), tuple(settings))


def _tasks(scene: Scene, course: Course, repeats: int) -> Iterator[Task]:
    """Yield the tasks of a scene in all windows of a course."""
    temperatures = _temperatures(course) if scene.level == "steady" else ()
    for window in course.windows:
        yield task(scene.level, measure, scene, window, temperatures, repeats, program_hash(*_MORE_SOURCES))


def measure(scene: Scene, window: Window, temperatures: tuple[float, ...], repeats: int, program: str) -> dict:
    """Return the results of a scene in a window, and the least processor time of its runs; a task.

    Parameters
    ----------
    scene : at the level and with the settings to measure.
    window : of the course.
    temperatures : between which the table of level ``steady`` is [K]; empty at other levels.
    repeats : runs at most, as long as these take no more than a second; runs below 10 ms scatter and are repeated ten times as often.
    program : hash of further sources that the result depends on.

    Returns
    -------
    ``slip``, ``load``, ``edge`` and ``pressure`` by bins, ``damage``, ``simulated`` and ``spent`` [s]; or ``failure``, why there is no result.
    """
    try:
        table = _table_of(scene, temperatures) if scene.level == "steady" else None
        start, nodes = _settled_start(_Lowered(scene), window.at(0.0))
        first = _begun(scene, window, table, start, nodes)
        run = _look_up if first.takes_profiles else _march
        first.advance(1e-6)  # compiles
        if first.takes_profiles:
            first.advance_profile(np.full(1, 1e-6), np.array([first.inputs]))
        results, spent = run(_begun(scene, window, table, start, nodes), window)
        more = repeats - 1 if spent > _SHORT else _OFTEN * repeats
        for _ in range(more):
            if spent > _ENOUGH:
                break
            spent = min(spent, run(_begun(scene, window, table, start, nodes), window)[1])
    except IntegrationError as error:
        return {"failure": str(error)}
    return {name: value if isinstance(value, float) else value.tolist() for name, value in results._asdict().items()} | {
        "simulated": window.seconds,
        "spent": spent,
        "failure": "",
    }


class _Lowered(NamedTuple):
    """A scene for its state at level ``steady``; equal to others of the same text."""

    scene: Scene

    def __hash__(self):
        return hash(repr(self.scene))


def _at_steady(scene: Scene) -> Scene:
    """Return a scene at level steady without what this level lacks."""
    operating = dataclasses.replace(scene.operating, moment=None, misalignment=0.0)
    unbalance = dataclasses.replace(scene.support.unbalance, amount=0.0)
    support = dataclasses.replace(scene.support, unbalance=unbalance)
    return dataclasses.replace(scene, level="steady", level_reason="", wants=(), operating=operating, support=support, integration=Integration())


@lru_cache(maxsize=64)
def _settled_start(lowered: _Lowered, inputs: Inputs) -> tuple[np.void | None, np.ndarray | None]:
    """Return the sample of the steady state at inputs, and the temperatures of the thermal network's nodes [K]; None where there is none."""
    scene, nodes = _at_steady(lowered.scene), None
    try:
        if scene.heat.law == "network":
            nodes = equilibrium_temperatures(scene, inputs)
    except IntegrationError:
        pass  # then it begins as the scene does
    if inputs.shaft_speed == 0.0:
        return None, nodes
    try:
        run = Simulation(scene, inputs, table=empty_table(), nodes=nodes)
        if nodes is not None:
            run.set_temperatures(nodes)
        turn, length, before = 1.0 / abs(cage_rate(scene, inputs.shaft_speed)), _FIRST_REST, math.inf
        while length <= _LONGEST_REST:
            slip = float(run.advance(length * turn)["cage_slip"][-1])
            if not abs(slip - before) > _RESTS:
                break
            before, length = slip, 2.0 * length
    except IntegrationError:
        return None, nodes
    return run.sample.copy(), nodes


def _begun(scene: Scene, window: Window, table: Table | None, start: np.void | None, nodes: np.ndarray | None) -> Simulation:
    return Simulation(scene, window.at(0.0), table, start, nodes)


def _temperatures(course: Course) -> tuple[float, float]:
    """Return between which oil temperatures a table is for a course [K]."""
    return rounded_temperatures(*course.extent()["oil_temperature"])


def _why_no_table(scene: Scene, course: Course, workers: int | None) -> str:
    """Build the table of a scene if it is not on disk, before any time is taken; return why there is none, or an empty text."""
    try:
        obtain_corrected_table(scene, _temperatures(course), workers)
    except (SceneError, ValueError, IntegrationError) as error:
        return str(error)
    return ""


_tables: dict[str, Table] = {}


def _table_of(scene: Scene, temperatures: tuple[float, ...]) -> Table:
    """Return the table of a scene, from memory, from disk or built."""
    key = f"{scene!r} {temperatures}"
    if key not in _tables:
        _tables.clear()  # they are large
        _tables[key] = obtain_table(scene, temperatures)[0]
    return _tables[key]


def _look_up(run: Simulation, window: Window) -> tuple[Results, float]:
    """Run a level that looks up operating points, with a sample at each edge; return results and processor time."""
    edges = bin_edges(run.scene, window)
    instants = np.array(sorted({*edges.tolist(), *window.times, *_before(run.scene, window, edges[0])}))
    inputs, stretches = np.array([window.at(at) for at in instants[1:]]), np.diff(instants)
    first = np.array([run.sample])
    clock, blocks, done = time.process_time(), [first], 0
    while done < len(stretches):
        block = run.advance_profile(stretches[done:], inputs[done:])
        done += len(block)
        blocks.append(block)
        if done < len(stretches):  # the table does not hold this one
            blocks.append(run.advance(stretches[done], Inputs(*inputs[done])))
            done += 1
    spent = time.process_time() - clock
    whole = np.concatenate(blocks)
    means = {name: 0.5 * (row[1:] + row[:-1]) for name, row in _observed(whole).items()}  # of the time between two samples
    return _binned(means | {"slip": _mean_slips(run.scene, whole)}, whole["damage"], instants, edges), spent


def _march(run: Simulation, window: Window) -> tuple[Results, float]:
    """Run a level that integrates; return results and processor time."""
    edges = bin_edges(run.scene, window)
    instants = sorted({*edges.tolist(), *window.times, *_before(run.scene, window, edges[0])})
    speeds = [row[0] for row in window.inputs]
    turns = np.diff(turned(run.scene, np.array(window.times), np.array(speeds), np.array(instants)))
    blocks, times, damage, spent, before = [], [np.zeros(1)], [run.sample["damage"]], 0.0, run.sample.copy()
    for begin, end, parts in zip(instants, instants[1:], turns.tolist()):
        samples = max(round(_PER_BIN * parts / BIN), 1)
        inputs = window.at(end)
        clock = time.process_time()
        block = run.advance(end - begin, inputs, samples=samples)
        spent += time.process_time() - clock
        blocks.append(_observed(block) | {"slip": _mean_slips(run.scene, np.array([before, *block]))})
        before = block[-1]
        times.append(np.linspace(begin, end, samples + 1)[1:])
        damage += block["damage"].tolist()
    observed = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    return _binned(observed, np.array(damage), np.concatenate(times), edges), spent


def _before(scene: Scene, window: Window, end: float) -> list[float]:
    """Return instants [s] before the first bin about a bin apart, so that no call of the model is long."""
    times, speeds = np.array(window.times), np.array([row[0] for row in window.inputs])
    turns = float(turned(scene, times, speeds, np.array([end]))[0])
    return np.linspace(0.0, end, max(round(turns / BIN), 1) + 1).tolist()


def _observed(block: np.ndarray) -> dict[str, np.ndarray]:
    """Return the observables that are compared at instants, shape (n,) each."""
    return {
        "load": np.maximum(block["inner_load"], block["outer_load"]).max(axis=1),
        "edge": np.maximum(block["inner_edge_pressure"], block["outer_edge_pressure"]),
        "pressure": np.maximum(block["inner_pressure"], block["outer_pressure"]),
    }


def _mean_slips(scene: Scene, samples: np.ndarray) -> np.ndarray:
    """Return the mean slips [%] between samples, shape (n - 1,), by the angles of cage and shaft: exact however far apart they are."""
    with np.errstate(divide="ignore", invalid="ignore"):
        turned = np.diff(samples["cage_angle"]) / np.diff(samples["shaft_angle"])
    return 100.0 * (1.0 - turned * 2.0 / (1.0 - scene.bearing.diameter_ratio))


def _binned(observed: dict[str, np.ndarray], damage: np.ndarray, times: np.ndarray, edges: np.ndarray) -> Results:
    """Return means over bins.

    Parameters
    ----------
    observed : by name, each value for the time between two instants, shape (n,).
    damage : at the instants, shape (n + 1,).
    times : the instants [s], among them all edges, shape (n + 1,).
    edges : of the bins [s].
    """
    weights, bins = np.diff(times), np.searchsorted(edges, 0.5 * (times[1:] + times[:-1]), "right") - 1
    settled = bins >= 0
    bins, weights = np.minimum(bins[settled], len(edges) - 2), weights[settled]
    total = np.bincount(bins, weights)
    means = {name: np.bincount(bins, weights * values[settled]) / total for name, values in observed.items()}
    begin = int(np.argmin(np.abs(times - edges[0])))
    return Results(means["slip"], means["load"], float(damage[-1] - damage[begin]), means["edge"], means["pressure"])


def _failure(run: Sequence[dict]) -> str:
    """Return why a setting has no result, or an empty text."""
    for number, result in enumerate(run, 1):
        if failure := result.get("failure", "") or result.get("reason", ""):
            return failure if len(run) == 1 else f"window {number}: {failure}"
    return ""


def _results(run: Sequence[dict]) -> list[Results]:
    """Return the results of all windows from those of their tasks."""
    return [Results(**{name: one[name] if name == "damage" else np.array(one[name]) for name in Results._fields}) for one in run]


def _traded(setting: Candidate, run: Sequence[dict], reference: Sequence[Results]) -> Traded:
    if failure := _failure(run):
        return Traded(setting, math.nan, NO_ERRORS, failure)
    factor = sum(one["simulated"] for one in run) / max(sum(one["spent"] for one in run), 1e-9)
    return Traded(setting, factor, _errors(_results(run), reference))


def _errors(windows: Sequence[Results], reference: Sequence[Results]) -> Errors:
    """Return the errors of the results of all windows; those of edges are not known."""
    slip, true_slip = (np.concatenate([one.slip for one in each]) for each in (windows, reference))
    load, true_load = (np.concatenate([one.load for one in each]) for each in (windows, reference))
    away, off = np.abs(slip - true_slip), np.abs(load - true_load) / true_load.mean()
    lives = [_life_error(one.damage, true.damage) for one, true in zip(windows, reference)]
    life = _life_error(sum(one.damage for one in windows), sum(true.damage for true in reference))
    return Errors(_rms(away), float(away.max()), _rms(off), float(off.max()), life, max(lives))


def _life_error(damage: float, true: float) -> float:
    """Return the relative error of a life from damages; 0 where neither has any."""
    if damage > 0.0:
        return abs(true / damage - 1.0)
    return math.inf if true > 0.0 else 0.0


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _with_edges(measured: Sequence[Traded], runs: Sequence[Sequence[dict]]) -> list[Traded]:
    """Return the settings with the errors of edge loads, where the finest number of slices was measured."""
    finest = next((k for k, one in enumerate(measured) if one.setting.detail == f"{_MOST_SLICES} slices" and not one.failure), None)
    if finest is None:
        return list(measured)
    edge, pressure = (np.concatenate([one[name] for one in runs[finest]]) for name in ("edge", "pressure"))
    found = []
    for k, one in enumerate(measured):
        if one.setting.level == "spatial" and not one.failure and k != finest and pressure.mean() > 0.0:
            off = np.abs(np.concatenate([each["edge"] for each in runs[k]]) - edge) / pressure.mean()
            one = one._replace(errors=one.errors._replace(edge=_rms(off), largest_edge=float(off.max())))
        found.append(one)
    return found


# Okabe and Ito's colours, safe for colour-blind readers, and a marker for each level
_LEVELS = {"steady": ("#009e73", "D"), "slip": ("#0072b2", "o"), "planar": ("#d55e00", "s"), "spatial": ("#cc79a7", "^")}
_FLOORS = (1e-4, 1e-4, 1e-4)  # smallest error shown on each logarithmic axis


def plot_trade(path: Path, title: str, found: Trade) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(14, 5.6)
    labels = ("error of cage slip [percentage points]", "error of the largest roller load", "error of the life")
    names = ("slip", "load", "life")
    own_errors = [getattr(found.own_error, name) for name in names]
    for axes, name, label, own, floor in zip(figure.subplots(1, 3, sharex=True), names, labels, own_errors, _FLOORS):
        _draw_errors(axes, found, name, floor)
        axes.axhspan(floor / 2, max(own, floor), color="0.88", zorder=0, label="error of the reference")
        axes.set(xscale="log", yscale="log", xlabel="real-time factor, one core", ylabel=label)
        axes.set_ylim(bottom=floor / 2)
        plain_numbers(axes.xaxis, axes.yaxis)
        axes.axvline(1.0, color="0.6", lw=0.8)
        axes.grid(alpha=0.25)
    _draw_front(figure.axes[0], found)
    handles, names = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=len(names), frameon=False)
    figure.suptitle(f"{title}, {found.course.name}\nagainst {found.reference}, over {found.simulated:.3g} s")
    figure.savefig(path, dpi=130)


def _draw_errors(axes, found, name, floor):
    for level in dict.fromkeys(one.setting.level for one in found.measured):
        mine = [one for one in found.measured if one.setting.level == level and not one.failure]
        colour, marker = _LEVELS[level]
        errors = np.maximum([getattr(one.errors, name) for one in mine], floor)
        axes.plot([one.real_time_factor for one in mine], errors, marker, color=colour, ms=6, alpha=0.8, label=level)


def _draw_front(axes, found):
    """Join the settings of the front, and name the fastest of each level."""
    front = [found.measured[k] for k in found.front]
    factors, errors = [one.real_time_factor for one in front], np.maximum([one.errors.slip for one in front], _FLOORS[0])
    axes.step(factors, errors, where="post", color="0.3", lw=1.0, label="Pareto front", zorder=1)
    for level in dict.fromkeys(one.setting.level for one in front):
        best = next(one for one in front if one.setting.level == level)
        point = best.real_time_factor, max(best.errors.slip, _FLOORS[0])
        axes.annotate(best.setting.detail, point, (-4, 9), textcoords="offset points", fontsize=8, ha="right")
