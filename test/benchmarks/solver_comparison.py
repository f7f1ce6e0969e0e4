# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Each level against other solvers on the same compiled right-hand side, what bounds a step, growth with the rollers, look-ups.

``python test/benchmarks/solver_comparison.py --level slip --level planar`` measures the installed package; a few minutes for each level
once compiled, longer for level spatial.  ``--quick`` measures almost nothing, ``--json`` prints one JSON object.

Reference of a trajectory is DOP853 at a tolerance of 1e-10.  CVODE needs scikit-sundae.  One process on one core measures everything;
times are processor times, and the minimum of repeats counts (see `level_speed`, which measures speed and errors alone).
"""

import argparse
import functools
import json
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

import numpy as np
from level_speed import (
    BEARING,
    LOAD,
    SPEEDS,
    SettledReference,
    Timed,
    bench_scene,
    level_integrators,
    machine_facts,
    one_core,
    timed_run,
)

from bearing_sim.cli.reporting import print_rows
from bearing_sim.levels.common.model import Drive, Model
from bearing_sim.levels.level import LEVELS
from bearing_sim.levels.steady.table_builder import look_up, obtain_table
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.compilation import kernel
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation, scene_inputs, tolerances_of

STOCK_ROLLERS = 18


class Kernels(NamedTuple):
    """Compiled functions of a level by name; None where the level has none."""

    rhs: Callable | None
    rhs_and_jacobian: Callable | None
    factor: Callable | None
    solve: Callable | None
    error_norm: Callable | None


class Problem(NamedTuple):
    """One level at one condition as a differential equation dy/dt = f(t, y), y(0) = start."""

    kernels: Kernels
    model: Model
    work: tuple
    start: np.ndarray  # shape (n,)


def level_kernels(level: str) -> Kernels:
    """Return the kernels in the module of the level's initial state."""
    module = sys.modules[LEVELS[level].initial_state.__module__]
    return Kernels(*(getattr(module, name, getattr(getattr(module, "KERNELS", None), name, None)) for name in Kernels._fields))


def scaled_scene(level: str, speed_rpm: float, rollers: int) -> Scene:
    """Return the scene of the bench, scaled to a number of rollers.

    Rollers, their spacing, all clearances and the height of the lobes are kept.  The pitch radius is therefore proportional to Z, and
    all other radii shift with it; the masses of cage, ring and shaft and the load are proportional to Z; the shaft speed is
    proportional to 1/Z, so that surface speeds and the roller passing frequency equal those of the stock bearing.

    Parameters
    ----------
    level : name.
    speed_rpm : shaft speed of the stock bearing.
    rollers : Z.
    """
    ratio = rollers / STOCK_ROLLERS
    scene = load_scene(BEARING)
    bearing = scene.bearing
    outward = bearing.pitch_radius * (ratio - 1.0)
    inner, cage = bearing.inner_raceway, bearing.cage
    overrides = [
        f"operating.radial_load={LOAD * ratio} N",
        f"bearing.roller.count={rollers}",
        f"bearing.inner_raceway.radius={inner.radius + outward}",
        f"bearing.inner_raceway.bore_radius={inner.bore_radius + outward}",
        f"bearing.outer_raceway.outside_radius={bearing.outer_raceway.outside_radius + outward}",
        f"bearing.outer_raceway.low_radius={bearing.outer_raceway.low_radius + outward}",
        f"bearing.cage.inner_radius={cage.inner_radius + outward}",
        f"bearing.cage.guide_radius={cage.guide_radius + outward}",
        f"bearing.cage.mass={cage.mass * ratio}",
        f"bearing.inner_raceway.ring_mass={inner.ring_mass * ratio}",
        f"support.shaft.mass={scene.support.shaft.mass * ratio}",
    ]
    return bench_scene(level, speed_rpm / ratio, overrides)


def bare_problem(scene: Scene) -> Problem | None:
    """Return the differential equation of a scene, or None if its level has no right-hand side."""
    kernels = level_kernels(scene.level)
    if kernels.rhs is None:
        return None
    params, inputs = pack(scene), scene_inputs(scene)
    lubrication = lubricate(scene.lubricant, params, inputs.oil_temperature)
    drive = Drive(0.0, inputs.shaft_speed, 0.0, inputs.load_y, 0.0, inputs.load_z, 0.0, 0.0)
    model = Model(params, lubrication, drive, tolerances_of(scene.integration))
    return Problem(kernels, model, LEVELS[scene.level].new_work(params), Simulation(scene).state)


def relative_error(problem: Problem, state: np.ndarray, reference: np.ndarray) -> float:
    """Return the error of a state in the level's own norm, times the relative tolerance: a relative error of speeds."""
    reference = np.ascontiguousarray(reference)  # a strided column would be another type and compiled again
    return problem.model.tolerances.relative * float(problem.kernels.error_norm(0.0, reference, state - reference, problem.model))


def state_scales(problem: Problem) -> np.ndarray:
    """Return the scale of each state in the level's own error norm, 1 (SI) where it has none, shape (n,)."""
    scales, norm = np.ones_like(problem.start), problem.kernels.error_norm
    for i in range(scales.size):
        change = np.zeros_like(problem.start)
        change[i] = 1.0
        error = norm(0.0, problem.start, change, problem.model)
        if error > 0.0:
            scales[i] = 1.0 / (error * problem.model.tolerances.relative)
    return scales


_FIRST_STEP = 1e-8  # s


class SolverRun(NamedTuple):
    """Result of a solver."""

    states: np.ndarray | None  # at the given times, shape (times, n); None if it failed
    spent: float  # processor time [s]
    right_hand_sides: int
    failure: str  # why there is no result, or ""


class _TooLong(Exception):
    pass


def solve_with(solver: str, problem: Problem, times: np.ndarray, tolerance: float, patience: float = 60.0) -> SolverRun:
    """Integrate a problem from its start at time 0.

    Parameters
    ----------
    solver : a method of `scipy.integrate.solve_ivp`, or "CVODE" (scikit-sundae, BDF of order 1 to 5 with a dense Jacobian).
    problem : what to integrate.
    times : of the returned states [s], increasing; the last is the end.
    tolerance : relative.
    patience : processor time after which to give up [s].
    """
    rhs, model, work = problem.kernels.rhs, problem.model, problem.work
    state, out, evaluations, deadline = np.zeros_like(problem.start), np.zeros_like(problem.start), 0, np.inf

    def rate(t, y):
        nonlocal evaluations
        evaluations += 1
        if time.process_time() > deadline:
            raise _TooLong
        state[:] = y  # some solvers pass read-only or strided memory, which would be compiled again
        rhs(t, state, model, work, out)
        return out.copy()

    rate(0.0, problem.start)  # compiles
    evaluations, scales = 0, state_scales(problem)
    started = time.process_time()
    deadline = started + patience
    try:
        states, failure = (_sundials if solver == "CVODE" else _scipy)(rate, solver, problem.start, times, tolerance, scales)
    except _TooLong:
        states, failure = None, f"gave up after {patience:g} s"
    except ImportError:
        states, failure = None, "scikit-sundae is not installed"
    return SolverRun(states, time.process_time() - started, evaluations, failure)


def _scipy(rate, solver, start, times, tolerance, scales):
    from scipy.integrate import solve_ivp

    # The first step is given, because SciPy's guess lets explicit methods try states that overflow.
    with np.errstate(all="ignore"):
        found = solve_ivp(rate, (0.0, times[-1]), start, solver, t_eval=times, rtol=tolerance, atol=tolerance * scales, first_step=_FIRST_STEP)
    return (found.y.T, "") if found.success else (None, found.message)


def _sundials(rate, solver, start, times, tolerance, scales):
    from sksundae.cvode import CVODE

    def fill(t, y, rates):
        rates[:] = rate(t, y)

    method = CVODE(fill, method="BDF", rtol=tolerance, atol=tolerance * scales, first_step=_FIRST_STEP, max_num_steps=10_000_000)
    found = method.solve(np.concatenate([[0.0], times]), start)
    return (np.asarray(found.y)[1:], "") if found.success else (None, str(found.message))


_REPEATS = 5
_SHIFT = 2e-6  # s; the time of a solution does not depend on it


def kernel_times(problem: Problem, state: np.ndarray, calls: int) -> dict[str, float]:
    """Return the time of one call of each kernel [us] at a state, the minimum of five loops over ``calls`` calls.

    ``jacobian`` is the time of `rhs_and_jacobian` minus that of the right-hand side.
    """
    kernels, model, work = problem.kernels, problem.model, problem.work
    rate, x = np.zeros_like(state), np.zeros_like(state)
    times = {"right_hand_side": _shortest(_evaluations(kernels.rhs), calls, 0.0, state, model, work, rate)}
    if None not in kernels:
        both = _shortest(_evaluations(kernels.rhs_and_jacobian), calls, 0.0, state, model, work, rate)
        times["jacobian"] = both - times["right_hand_side"]
        times["factorisation"] = _shortest(_factorisations(kernels.factor), calls, _SHIFT, work)
        times["solve"] = _shortest(_solutions(kernels.solve), calls, work, rate, x)
        times["error_norm"] = _shortest(_norms(kernels.error_norm), calls, 0.0, state, rate, model)
    return times


def kernel_fractions(times: dict[str, float], counters: dict, step_us: float) -> dict[str, float]:
    """Return the fraction of a step's time spent in each kernel, from the counters of a run.

    It assumes one solution and one error norm per right-hand side, and at least one factorisation per Jacobian.  The rest is the
    method's own arithmetic and the loop around it.
    """
    steps, evaluations = counters["steps"], counters["right_hand_sides"]
    factorisations = max(counters.get("factorisations", 0), counters["jacobians"])
    calls = {
        "right_hand_side": evaluations,
        "jacobian": counters["jacobians"],
        "factorisation": factorisations,
        "solve": evaluations,
        "error_norm": evaluations,
    }
    parts = {name: calls[name] / steps * spent / step_us for name, spent in times.items()}
    return {**parts, "rest": 1.0 - sum(parts.values())}


def _shortest(loop, calls, *arguments):
    loop(1, *arguments)  # compiles
    best = np.inf
    for _ in range(_REPEATS):
        started = time.process_time()
        loop(calls, *arguments)
        best = min(best, time.process_time() - started)
    return 1e6 * best / calls


# Loops around kernels are compiled in each process: they are small, and the cache on disk cannot hold them.
@functools.cache
def _evaluations(evaluate):
    @kernel
    def loop(calls, t, y, model, work, rate):
        for _ in range(calls):
            evaluate(t, y, model, work, rate)

    return loop


@functools.cache
def _factorisations(factor):
    @kernel
    def loop(calls, shift, work):
        for _ in range(calls):
            factor(shift, work)

    return loop


@functools.cache
def _solutions(solve):
    @kernel
    def loop(calls, work, right, x):
        for _ in range(calls):
            for i in range(x.shape[0]):  # solving the same vector repeatedly would decay into slow subnormal numbers
                x[i] = right[i]
            solve(work, x)

    return loop


@functools.cache
def _norms(error_norm):
    @kernel
    def loop(calls, t, y, change, model):
        largest = 0.0
        for _ in range(calls):
            largest += error_norm(t, y, change, model)
            change[0] += 1e-300  # prevents the compiler from hoisting the call
        return largest

    return loop


# LSODA also with looser tolerances, to compare it at an error no smaller than ours.
OTHERS = (("LSODA", 1e-5), ("LSODA", 1e-4), ("LSODA", 1e-3), ("LSODA", 1e-2), ("BDF", 1e-5), ("CVODE", 1e-5), ("CVODE", 1e-3))
LSODA_TOLERANCE = 1e-5
_REFERENCE_TOLERANCE = 1e-10


class Extent(NamedTuple):
    """Extent of the measurement."""

    window: float = 2e-3  # for trajectories and other solvers, from ideal rolling [s]
    window_times: int = 4  # instants in the window at which states are compared
    settling: float = 0.2  # before the timed run [s]
    timed: float = 0.1  # for the time of a step [s]
    repeats: int = 5
    others: tuple = OTHERS
    rollers: tuple[int, ...] = (9, 18, 36, 72, 144)
    scaling_settled: tuple[float, float] = (0.02, 0.04)
    scaling_tight: float = 0.1  # times the default tolerances, of the reference
    kernel_calls: int = 2000


FULL = Extent()
QUICK = Extent(5e-5, 2, 1e-3, 1e-3, 1, (("LSODA", 1e-5), ("CVODE", 1e-5)), (9, 18, 36), (1e-3, 2e-3), 0.5, 200)


def compare(levels: Sequence[str], extent: Extent, progress: Callable[[str], None]) -> dict:
    """Measure and return the report: plain numbers, strings, lists and dicts.

    Parameters
    ----------
    levels : to measure.
    extent : of the measurement.
    progress : called with a line of text for each measurement.
    """
    with one_core() as core:
        cases, others, references, bounds = [], [], [], []
        report = {"bearing": BEARING, "radial_load": LOAD, "machine": {**machine_facts(core), "scipy": version("scipy"), "scikit_sundae": _sundae()}}
        for level in levels:
            for speed in SPEEDS:
                progress(f"{level} at {speed:g} rpm: other solvers")
                course = _Course(level, speed, extent)
                references.append({"level": level, "speed_rpm": speed, **course.described()})
                others += course.others
                for name, overrides in level_integrators(level).items():
                    progress(f"{level} at {speed:g} rpm: {name}")
                    scene, named = bench_scene(level, speed, overrides), {"level": level, "integrator": name, "speed_rpm": speed}
                    cases.append(named | _compared(scene, course, extent))
                    bounds.append(named | _bound(scene, course.problem, extent))
        progress("scaling with the number of rollers")
        scaling = [_scaling(level, extent) for level in levels]
        if "steady" in levels:
            progress("look-ups of level steady")
            report["look_up"] = look_up_times(bench_scene("steady", SPEEDS[-1]))
        return report | {"cases": cases, "others": others, "references": references, "bound": bounds, "scaling": scaling}


def _sundae() -> str | None:
    try:
        return version("scikit-sundae")
    except PackageNotFoundError:
        return None


class _Course:
    """The first milliseconds from ideal rolling: an accurate solution, and the results of other solvers."""

    def __init__(self, level: str, speed: float, extent: Extent):
        self.times = extent.window * np.arange(1, extent.window_times + 1) / extent.window_times
        self.problem = bare_problem(bench_scene(level, speed))
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
            return {"core_seconds": None, "real_time_factor": None, "right_hand_sides": None, "trajectory_error": None, "failure": run.failure}
        return {
            "core_seconds": run.spent,
            "real_time_factor": self.times[-1] / run.spent,
            "right_hand_sides": run.right_hand_sides,
            "trajectory_error": self.error(run.states),
            "failure": "",
        }

    def error(self, states) -> float | None:
        """Return the largest error in the window, in the level's own norm."""
        if self.reference is None or self.reference.states is None or states is None:
            return None
        return max(relative_error(self.problem, *pair) for pair in zip(states, self.reference.states))

    def lsoda_time(self, allowed_error: float | None = None) -> float | None:
        """Return the time of LSODA at tolerance 1e-5, or its shortest time within an allowed error."""
        runs = [run for run in self.others if run["solver"] == "LSODA" and run["core_seconds"] is not None]
        if allowed_error is None:
            runs = [run for run in runs if run["tolerance"] == LSODA_TOLERANCE]
        else:
            runs = [run for run in runs if run["trajectory_error"] <= allowed_error]
        return min((run["core_seconds"] for run in runs), default=None)

    def described(self) -> dict:
        """Return how the reference was computed, and how far two solvers differ at its tolerance."""
        return {"trajectory_method": "DOP853", "trajectory_tolerance": _REFERENCE_TOLERANCE, "trajectory_own_error": self.own_error}


def _window_time(scene: Scene, window: float, repeats: int) -> float:
    """Return the time of the window from ideal rolling, over which other solvers are timed."""
    run, spent = Simulation(scene), []
    for _ in range(4 * repeats):
        run.reset()
        started = time.process_time()
        run.advance(window)
        spent.append(time.process_time() - started)
    return min(spent)


def _compared(scene: Scene, course: _Course, extent: Extent) -> dict:
    """Return error and time of a scene over the window, and the times of LSODA over it; null if there is nothing to compare with."""
    run, states = Simulation(scene), []
    for before, after in zip([0.0, *course.times], course.times):
        run.advance(after - before)
        states.append(run.state)
    error, ours, lsoda = course.error(states), _window_time(scene, extent.window, extent.repeats), course.lsoda_time()
    at_our_error = course.lsoda_time(error) if lsoda is not None else None
    return {
        "trajectory_error": error,
        "window_seconds": ours,
        "lsoda_ratio": lsoda and lsoda / ours,
        "lsoda_ratio_at_our_error": at_our_error and at_our_error / ours,
    }


def _bound(scene: Scene, problem: Problem | None, extent: Extent) -> dict:
    """Return the mean step, that at ten times the tolerances, and what bounds the time of a step; empty at a level without steps."""
    timed = timed_run(scene, extent.settling, extent.timed, extent.repeats)
    if problem is None or not timed.counters["steps"]:
        return {}
    looser = timed_run(replace(scene, integration=scene.integration.with_tolerances(10.0)), extent.settling, extent.timed, 1)
    times = kernel_times(problem, timed.state, extent.kernel_calls)
    return {
        "step_simulated_us": _mean_step(timed),
        "step_simulated_at_tenfold_tolerance_us": _mean_step(looser),
        "kernel_us": times,
        "fraction": kernel_fractions(times, timed.counters, timed.described()["step_us"]),
    }


def _mean_step(timed: Timed) -> float:
    """Return the simulated time of a step [us]."""
    return 1e6 * timed.duration / timed.counters["steps"]


def _scaling(level: str, extent: Extent) -> dict:
    """Return speed and errors by number of rollers, from 45,000 rpm, and the power of Z with which the time grows from 18 rollers."""
    start, end = extent.scaling_settled
    cases = []
    for rollers in extent.rollers:
        scene = scaled_scene(level, SPEEDS[-1], rollers)
        timed = timed_run(scene, start, end - start, extent.repeats)
        errors = SettledReference(scene, extent.scaling_settled, (extent.scaling_tight,)).errors(scene)
        cases.append({"rollers": rollers, **timed.described(), **errors})
    own = {case["rollers"]: 1.0 / case["real_time_factor"] for case in cases}
    first, last = STOCK_ROLLERS, max(own)
    exponent = float(np.log(own[last] / own[first]) / np.log(last / first))
    return {"level": level, "rollers": list(own), "core_seconds_per_second": list(own.values()), "exponent": exponent, "cases": cases}


def look_up_times(scene: Scene) -> dict[str, float]:
    """Return the time of a look-up in the table of level steady at random points [us], in compiled code and called from Python."""
    table, _ = obtain_table(scene)
    last = [table.speeds[-1], table.loads[-1], table.temperatures[-1] - table.temperatures[0], 2 * np.pi]
    conditions = np.random.default_rng(1).random((20_000, 4)) * last + [0.0, 0.0, table.temperatures[0], 0.0]
    few = conditions[:200]

    def one_by_one(calls):
        for _ in range(calls):
            for condition in few:
                look_up(table, condition[None])

    def at_once(calls):
        for _ in range(calls):
            look_up(table, conditions)

    return {"compiled_us": _shortest(at_once, 1) / len(conditions), "from_python_us": _shortest(one_by_one, 1) / len(few)}


def _number(value, form=".3g") -> str:
    return "-" if value is None else format(value, form)


def _table(title: str, columns: dict[str, str], rows: Sequence[dict]) -> None:
    """Print fields of rows under headings, after the level and the speed; ``columns`` gives the field of each heading."""

    def text(row, name):
        value = row.get(name)
        return value if isinstance(value, str) else _number(value)

    headings = ("level", "rpm", *columns)
    texts = [(row["level"], f"{row['speed_rpm']:.0f}", *(text(row, name) for name in columns.values())) for row in rows]
    print_rows(title, headings, texts, words=("level", "integrator", "solver", "failure"), width=170)


def print_report(report: dict) -> None:
    """Print the report as tables."""
    machine = report["machine"]
    print(f"core {machine['core']} of {machine['cores']} ({machine['processor']}), load average {machine['load_average']:.2f} at the start")
    found = {
        "integrator": "integrator",
        "error, first 2 ms": "trajectory_error",
        "x LSODA": "lsoda_ratio",
        "at our error": "lsoda_ratio_at_our_error",
    }
    _table("against LSODA at 1e-5, and at an error no smaller than ours", found, report["cases"])
    others = {"solver": "solver", "tolerance": "tolerance", "spent [s]": "core_seconds", "x real time": "real_time_factor", "rhs": "right_hand_sides"}
    others |= {"error": "trajectory_error", "failure": "failure"}
    _table("other solvers on the same compiled right-hand side, from ideal rolling", others, report["others"])
    _table("references: DOP853 against CVODE at 1e-10", {"difference": "trajectory_own_error"}, report["references"])
    kernels = ("right_hand_side", "jacobian", "factorisation", "solve", "error_norm")
    steps = {"mean step [us]": "step_simulated_us", "at 10x tolerance": "step_simulated_at_tenfold_tolerance_us"}
    rows = []
    for bound in report["bound"]:
        times, fractions = bound.get("kernel_us", {}), bound.get("fraction", {})
        shown = {name: f"{_number(times.get(name))} us, {100 * fractions.get(name, 0.0):.0f} %" for name in kernels}
        rows.append({**bound, **shown, "rest": f"{100 * fractions.get('rest', 0.0):.0f} %"})
    bounds = {"integrator": "integrator", **{name: name for name in (*kernels, "rest")}, **steps}
    _table("what bounds it: a call of each kernel alone, and its fraction of a step", bounds, rows)
    for level in report["scaling"]:
        costs = ", ".join(f"{rollers}: {cost:.3g}" for rollers, cost in zip(level["rollers"], level["core_seconds_per_second"]))
        print(f"{level['level']}, time of a simulated second by rollers: {costs}; power of Z from 18 on {level['exponent']:.3g}")
    if "look_up" in report:
        print(
            f"look-up of level steady: {report['look_up']['compiled_us']:.3g} us compiled, {report['look_up']['from_python_us']:.3g} us from Python"
        )


def main() -> None:
    """Measure what the arguments ask for, and print it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", action="append", choices=list(LEVELS), help="measure this level; can be repeated (default: all)")
    parser.add_argument("--quick", action="store_true", help="measure almost nothing, to check that everything works")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    asked = parser.parse_args()
    report = compare(asked.level or tuple(LEVELS), QUICK if asked.quick else FULL, lambda text: print(f"{text} ...", file=sys.stderr))
    print(json.dumps(report, indent=2)) if asked.json else print_report(report)


if __name__ == "__main__":
    main()
