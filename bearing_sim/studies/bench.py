# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench: how fast each level and method is, how far off, against which other solvers, and what bounds it.

One process on one core measures everything, so that its figures compare with each other.  All times are those that the process
has the core: whatever else runs on the machine does not count, and on an idle one it is the time on the wall.  Of repeats the
least is taken, because a disturbance can only add.
"""

import os
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.level import LEVELS
from bearing_sim.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.studies import bench_bound, bench_settled
from bearing_sim.studies.bench_problem import LOAD, STOCK_ROLLERS, bare_problem, error_share, level_methods, scaled_scene
from bearing_sim.studies.bench_solvers import SolverRun, solve_with
from bearing_sim.studies.bench_start_up import start_up
from bearing_sim.studies.stock_bearing import BEARING

SPEEDS = (15_000.0, 45_000.0)  # rpm
# With looser tolerances of LSODA, so that it can be had at no smaller an error than ours, too.
OTHERS = (("LSODA", 1e-5), ("LSODA", 1e-4), ("LSODA", 1e-3), ("LSODA", 1e-2), ("BDF", 1e-5), ("CVODE", 1e-5), ("CVODE", 1e-3))
LSODA_TOLERANCE = 1e-5
_REFERENCE_TOLERANCE = 1e-10
# Fields of a case; null where there is nothing to measure (a level without a differential equation) or nobody who counts.
_MEASURED = (
    *("real_time_factor", "step_us", "simulated_seconds"),
    *("steps", "rejected_steps", "non_finite_steps", "right_hand_sides", "jacobians", "factorisations"),
    *("slip_error", "slip_standard_error", "load_error", "orbit_error", "pocket_error"),
    *("trajectory_error", "window_seconds", "lsoda_ratio", "lsoda_ratio_at_our_error"),
)


class Extent(NamedTuple):
    """How much is measured."""

    window: float = 2e-3  # for trajectories and other solvers, from ideal rolling [s]
    window_times: int = 4  # in it at which states are compared
    settled: tuple = (0.2, 0.4)  # for means and quantiles [s]
    timed: float = 0.1  # for speed, after settling [s]
    repeats: int = 5
    tight: tuple = (3e-4, 1e-3)  # tolerances of the settled reference, and of the run that shows it converged
    others: tuple = OTHERS
    rollers: tuple = (9, 18, 36, 72, 144)
    scaling_settled: tuple = (0.02, 0.04)
    scaling_tight: float = 1e-3
    kernel_calls: int = 2000
    start_up: bool = True


FULL = Extent()
QUICK = Extent(
    5e-5, 2, (1e-3, 2e-3), 1e-3, 1, (3e-3, 5e-3), (("LSODA", 1e-5), ("CVODE", 1e-5)), (9, 18), (1e-3, 2e-3), 5e-3, 200, False
)  # fmt: skip


@contextmanager
def one_core() -> Iterator[int]:
    """Keep this process on one core while in the block; yields its number, -1 where the system cannot."""
    if not hasattr(os, "sched_setaffinity"):
        yield -1
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield max(before)
    finally:
        os.sched_setaffinity(0, before)


def run_bench(quick: bool = False, cold: bool = False, tell: Callable[[str], None] = lambda text: None, levels: Sequence[str] = ()) -> dict:
    """Measure and return the report.

    Parameters
    ----------
    quick : measure next to nothing, to see that it works.
    cold : measure the start of a process with an empty cache of machine code, too.
    tell : takes a word on what is being measured.
    levels : which to measure; all where none is named.

    Returns
    -------
    report : plain numbers, strings, lists and dicts.
    """
    extent = QUICK if quick else FULL
    with one_core() as core:
        began, had = time.perf_counter(), time.process_time()
        report = {"bearing": BEARING, "radial_load": LOAD, "quick": quick, "machine": _machine(core)}
        cases, references, others, bounds = [], [], [], []
        levels = levels or tuple(LEVELS)
        for level in levels:
            for speed in SPEEDS:
                tell(f"{level} at {speed:g} rpm: references and other solvers")
                course, settled = _Course(level, speed, extent), _SettledReference(level, speed, STOCK_ROLLERS, extent.settled, extent.tight)
                references.append({"level": level, "speed_rpm": speed, **course.described(), **settled.described()})
                others += course.others
                for method, overrides in level_methods(level).items():
                    tell(f"{level} at {speed:g} rpm: {method}")
                    case, bound = _case(level, method, overrides, speed, extent, course, settled)
                    cases.append(case)
                    bounds.append(bound)
        tell("scaling with the number of rollers")
        scaling = [_scaling_case(level, rollers, extent) for level in levels for rollers in extent.rollers]
        cases += [case for case in scaling if case["rollers"] != STOCK_ROLLERS]
        report |= {"cases": cases, "others": others, "references": references, "bound": bounds, "scaling": _scaling(scaling)}
        report["machine"]["share_of_core"] = (time.process_time() - had) / (time.perf_counter() - began)
        if extent.start_up:
            tell("start-up")
            report["start_up"] = [
                {"level": level, "cold": is_cold, **start_up(BEARING, level, is_cold)}
                for is_cold in ([False, True] if cold else [False])
                for level in levels
            ]
    return report


def _machine(core: int) -> dict:
    try:
        sundae = version("scikit-sundae")
    except PackageNotFoundError:
        sundae = None
    return {
        "core": core,
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
        "processor": _processor(),
        "python": platform.python_version(),
        "numba": version("numba"),
        "scipy": version("scipy"),
        "scikit_sundae": sundae,
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    except OSError:
        return platform.machine()


class _Course:
    """The first milliseconds from ideal rolling: a tight solution, and how others do on them."""

    def __init__(self, level: str, speed: float, extent: Extent):
        self.times = extent.window * np.arange(1, extent.window_times + 1) / extent.window_times
        self.problem = bare_problem(scaled_scene(level, speed))
        self.reference, self.own_error, self.others = None, None, []
        if self.problem is None:
            return
        self.reference = solve_with("DOP853", self.problem, self.times, _REFERENCE_TOLERANCE)
        check = solve_with("CVODE", self.problem, self.times, _REFERENCE_TOLERANCE)
        if check.states is None:
            check = solve_with("LSODA", self.problem, self.times, _REFERENCE_TOLERANCE)
        self.own_error = self.error(check.states)
        for solver, tolerance in extent.others:
            run = solve_with(solver, self.problem, self.times, tolerance)
            self.others.append({"level": level, "speed_rpm": speed, "solver": solver, "tolerance": tolerance, **self._described(run)})

    def _described(self, run: SolverRun) -> dict:
        if run.states is None:
            return {"core_seconds": None, "real_time_factor": None, "right_hand_sides": None, "trajectory_error": None, "fault": run.fault}
        return {
            "core_seconds": run.spent,
            "real_time_factor": self.times[-1] / run.spent,
            "right_hand_sides": run.right_hand_sides,
            "trajectory_error": self.error(run.states),
            "fault": "",
        }

    def error(self, states) -> float | None:
        """The largest error in the window, in the level's own measure."""
        if self.reference is None or self.reference.states is None or states is None:
            return None
        return max(error_share(self.problem, *pair) for pair in zip(states, self.reference.states))

    def lsoda_time(self, allowed_error: float | None = None) -> float | None:
        """Time of LSODA at 1e-5, or the least at no larger an error than is allowed."""
        runs = [run for run in self.others if run["solver"] == "LSODA" and run["core_seconds"] is not None]
        if allowed_error is None:
            runs = [run for run in runs if run["tolerance"] == LSODA_TOLERANCE]
        else:
            runs = [run for run in runs if run["trajectory_error"] <= allowed_error]
        return min((run["core_seconds"] for run in runs), default=None)

    def described(self) -> dict:
        return {"trajectory_method": "DOP853", "trajectory_tolerance": _REFERENCE_TOLERANCE, "trajectory_own_error": self.own_error}


class _SettledReference:
    """The level's own method at a tight tolerance, and at one less tight, which shows how far it has converged."""

    def __init__(self, level: str, speed: float, rollers: int, window: tuple, tolerances: tuple):
        self.window, self.tolerances = window, tolerances
        runs = [bench_settled.settle(scaled_scene(level, speed, rollers, tolerance=tolerance), *window) for tolerance in tolerances]
        self.best, self.check = runs[0], runs[-1]

    def described(self) -> dict:
        return {
            "settled_tolerances": list(self.tolerances),
            "settled_slip_change": bench_settled.slip_error(self.check, self.best),
            "settled_load_change": bench_settled.quantile_error(self.check.loads, self.best.loads),
            **bench_settled.described(self.best),
        }

    def errors(self, scene: Scene) -> dict:
        """Errors of a scene's run over the same window."""
        found = bench_settled.settle(scene, *self.window)
        return {
            "slip_error": bench_settled.slip_error(found, self.best),
            "load_error": bench_settled.quantile_error(found.loads, self.best.loads),
            "orbit_error": bench_settled.orbit_error(found, self.best),
            "pocket_error": bench_settled.quantile_error(found.pocket, self.best.pocket),
            "slip_standard_error": found.slip_spread,
        }


class _Timed(NamedTuple):
    """A timed run."""

    spent: float  # least of the repeats [s]
    counters: dict  # of one run
    state: np.ndarray  # at its end


def _timed(scene: Scene, before: float, duration: float, repeats: int) -> _Timed:
    """Time ``duration`` [s] at a sample a millisecond, once ``before`` [s] has passed; the runs follow upon each other."""
    run = Simulation(scene)
    run.advance(max(before, 1e-6))  # compiles
    spent = []
    for _ in range(repeats):
        counted = run.counters
        started = time.process_time()
        run.advance(duration, samples=max(round(1e3 * duration), 1))
        spent.append(time.process_time() - started)
    counters = {name: after - counted._asdict()[name] for name, after in run.counters._asdict().items()}
    return _Timed(min(spent), counters, run.state)


def _window_time(scene: Scene, window: float, repeats: int) -> float:
    """Time that the window from ideal rolling takes, the same that others are timed on."""
    run, spent = Simulation(scene), []
    for _ in range(4 * repeats):
        run.reset()
        started = time.process_time()
        run.advance(window)
        spent.append(time.process_time() - started)
    return min(spent)


def _new_case(level: str, method: str, speed: float, rollers: int) -> dict:
    """A case with nothing measured yet."""
    return {"level": level, "integrator": method, "speed_rpm": speed, "rollers": rollers, "fault": "", **dict.fromkeys(_MEASURED)}


def _case(level, method, overrides, speed, extent, course, settled) -> tuple[dict, dict]:
    """Measure one level and method at one speed; return the case and what bounds it."""
    scene = scaled_scene(level, speed, overrides=overrides)
    case = _new_case(level, method, speed, STOCK_ROLLERS)
    bound = {"level": level, "integrator": method, "speed_rpm": speed}
    try:
        timed = _timed(scene, extent.settled[0], extent.timed, extent.repeats)
        looser_scene = scaled_scene(level, speed, overrides=overrides, tolerance=min(10 * scene.integration.relative_tolerance, 0.1))
        looser = _timed(looser_scene, extent.settled[0], extent.timed, 1)
        case |= _speed(timed, extent.timed) | settled.errors(scene)
    except IntegrationError as fault:
        return case | {"fault": str(fault)}, bound
    run, states = Simulation(scene), []
    for before, after in zip([0.0, *course.times], course.times):
        run.advance(after - before)
        states.append(run.state)
    case["trajectory_error"] = course.error(states)
    ours, lsoda = _window_time(scene, extent.window, extent.repeats), course.lsoda_time()
    case["window_seconds"] = ours
    if lsoda is not None:
        fair = course.lsoda_time(case["trajectory_error"])
        case |= {"lsoda_ratio": lsoda / ours, "lsoda_ratio_at_our_error": fair / ours if fair is not None else None}
    bound |= {
        "step_simulated_us": _per(1e6 * extent.timed, timed.counters["steps"]),
        "step_simulated_at_tenfold_tolerance_us": _per(1e6 * extent.timed, looser.counters["steps"]),
    }
    if course.problem is not None and case["step_us"] is not None:
        times = bench_bound.kernel_times(course.problem, timed.state, extent.kernel_calls)
        bound |= {"kernel_us": times, "share": bench_bound.shares(times, timed.counters, case["step_us"])}
    return case, bound


def _per(amount: float, count: int) -> float | None:
    return amount / count if count else None


def _speed(timed: _Timed, duration: float) -> dict:
    counters = timed.counters
    return {
        "real_time_factor": duration / timed.spent,
        "step_us": _per(1e6 * timed.spent, counters["steps"]),
        "simulated_seconds": duration,
        **counters,
    }


def _scaling_case(level: str, rollers: int, extent: Extent) -> dict:
    """Measure the level's own method on a bearing scaled to other numbers of rollers, from 45,000 rpm."""
    speed, (start, end) = SPEEDS[-1], extent.scaling_settled
    scene = scaled_scene(level, speed, rollers)
    timed = _timed(scene, start, end - start, extent.repeats)
    settled = _SettledReference(level, speed, rollers, extent.scaling_settled, (extent.scaling_tight,))
    case = _new_case(level, next(iter(level_methods(level))), speed * STOCK_ROLLERS / rollers, rollers)
    return case | _speed(timed, end - start) | settled.errors(scene)


def _scaling(cases: list[dict]) -> list[dict]:
    """Time that a simulated second takes by the number of rollers, and the power of Z that it grows with from 18 on."""
    found = []
    for level in dict.fromkeys(case["level"] for case in cases):
        own = {case["rollers"]: 1.0 / case["real_time_factor"] for case in cases if case["level"] == level}
        first, last = STOCK_ROLLERS, max(own)
        exponent = np.log(own[last] / own[first]) / np.log(last / first) if last > first else None
        found.append({"level": level, "rollers": list(own), "core_seconds_per_second": list(own.values()), "exponent": exponent})
    return found
