# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench: speed and error of each level and method, other solvers for comparison, and what bounds the speed.

One process on one core measures everything, so that its figures are comparable.  All times are processor times of this process,
independent of other load; on an idle machine they equal wall time.  The minimum of repeats counts, because disturbances only add.
"""

import functools
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import PackageNotFoundError, version
from typing import NamedTuple

import numba
import numpy as np

from bearing_sim.levels.common.model import Drive, Model
from bearing_sim.levels.level import LEVELS
from bearing_sim.model.params import lubricate, pack
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene, tolerance_overrides
from bearing_sim.simulation import IntegrationError, Simulation, scene_inputs, tolerances_of

BEARING = "deng2017_table1"  # scene of the bench
LOAD = 800.0  # N
STOCK_ROLLERS = 18
FIXED_STEP = "integration.fixed_step=10 us"


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
    return Kernels(*(getattr(module, name, None) for name in Kernels._fields))


def level_methods(level: str) -> dict[str, list[str]]:
    """Return the overrides of a scene for each integration method of a level, by name, its default first.

    Methods with a fixed step appear a second time with a step of 10 us.
    """
    methods, found = LEVELS[level].methods, {}
    for name in methods:
        found[name] = [f"integration.method={name}"]
        if methods[name].advance_fixed is not None:
            found[f"{name}, fixed step"] = [*found[name], FIXED_STEP]
    return found


def scaled_scene(level: str, speed_rpm: float, rollers: int = STOCK_ROLLERS, overrides: Sequence[str] = (), tolerances: float = 1.0) -> Scene:
    """Return the scene of the bench, scaled to a number of rollers.

    Rollers, their spacing, all clearances and the height of the lobes are kept.  The pitch radius is therefore proportional to Z, and
    all other radii shift with it; the masses of cage, ring and shaft and the load are proportional to Z; the shaft speed is
    proportional to 1/Z, so that surface speeds and the roller passing frequency equal those of the stock bearing.

    Parameters
    ----------
    level : name.
    speed_rpm : shaft speed of the stock bearing.
    rollers : Z.
    overrides : further overrides, such as those of a method.
    tolerances : factor on the default ones.
    """
    ratio = rollers / STOCK_ROLLERS
    overrides = [*overrides, f"level={level}", f"operating.shaft_speed={speed_rpm / ratio} rpm", f"operating.radial_load={LOAD * ratio} N"]
    if tolerances != 1.0:
        overrides += tolerance_overrides(tolerances)
    if rollers != STOCK_ROLLERS:
        bearing = load_scene(BEARING).bearing
        outward = bearing.pitch_radius * (ratio - 1.0)
        inner, cage = bearing.inner_raceway, bearing.cage
        overrides += [
            f"bearing.roller.count={rollers}",
            f"bearing.inner_raceway.radius={inner.radius + outward}",
            f"bearing.outer_raceway.low_radius={bearing.outer_raceway.low_radius + outward}",
            f"bearing.cage.inner_radius={cage.inner_radius + outward}",
            f"bearing.cage.guide_radius={cage.guide_radius + outward}",
            f"bearing.cage.mass={cage.mass * ratio}",
            f"bearing.inner_raceway.ring_mass={inner.ring_mass * ratio}",
            f"bearing.inner_raceway.supported_mass={inner.supported_mass * ratio}",
        ]
    return load_scene(BEARING, overrides)


def bare_problem(scene: Scene) -> Problem | None:
    """Return the differential equation of a scene, or None if its level has no right-hand side."""
    kernels = level_kernels(scene.level)
    if kernels.rhs is None:
        return None
    params, inputs = pack(scene), scene_inputs(scene)
    lubrication = lubricate(scene.lubricant, params, inputs.oil_temperature)
    drive = Drive(0.0, inputs.shaft_speed, 0.0, inputs.load_y, 0.0, inputs.load_z, 0.0)
    model = Model(params, lubrication, drive, tolerances_of(scene.integration))
    return Problem(kernels, model, LEVELS[scene.level].new_work(params), Simulation(scene).state)


def relative_error(problem: Problem, state: np.ndarray, reference: np.ndarray) -> float:
    """Return the error of a state in the level's own norm, times the relative tolerance: a relative error of speeds."""
    reference = np.ascontiguousarray(reference)  # a strided column would be another type and compiled again
    return problem.model.tolerances.relative * float(_norm(problem.kernels.error_norm)(0.0, reference, state - reference, problem.model))


def state_scales(problem: Problem) -> np.ndarray:
    """Return the scale of each state in the level's own error norm, 1 (SI) where it has none, shape (n,)."""
    scales, norm = np.ones_like(problem.start), _norm(problem.kernels.error_norm)
    for i in range(scales.size):
        change = np.zeros_like(problem.start)
        change[i] = 1.0
        error = norm(0.0, problem.start, change, problem.model)
        if error > 0.0:
            scales[i] = 1.0 / (error * problem.model.tolerances.relative)
    return scales


@functools.cache
def _norm(error_norm):
    # Templates need a concrete kernel around them.
    return numba.njit(error_model="numpy")(lambda t, y, change, model: error_norm(t, y, change, model))


QUANTILES = (0.5, 0.9, 0.99)
_BLOCKS = 10
_RATE = 5000.0  # Hz; a higher rate would shorten the steps, a lower one make quantiles uncertain


class Settled(NamedTuple):
    """Means and quantiles over the window after settling; ``_spread`` is one standard error, from ten blocks of the window."""

    slip: float  # mean cage slip [%]
    slip_spread: float
    loads: np.ndarray  # quantiles of inner and outer roller loads [N], shape (2, 3)
    loads_spread: np.ndarray
    orbit: float  # mean distance of the cage's centre from the axis [m]
    pocket: np.ndarray  # quantiles of the magnitude of pocket forces [N], shape (3,)


def settle(scene: Scene, start: float, end: float) -> Settled:
    """Run a scene from ideal rolling and return its means and quantiles from ``start`` to ``end`` [s]."""
    samples = max(round((end - start) * _RATE), _BLOCKS)
    run = Simulation(scene)
    run.advance(start, samples=max(round(start * _RATE), 1))
    block = run.advance(end - start, samples=samples)
    slips, slip_spread = _with_spread(100.0 * block["cage_slip"], np.mean)
    loads = [_with_spread(block[name], _quantiles) for name in ("inner_load", "outer_load")]
    return Settled(
        float(slips),
        float(slip_spread),
        np.array([value for value, _ in loads]),
        np.array([spread for _, spread in loads]),
        float(np.hypot(block["cage_y"], block["cage_z"]).mean()),
        _quantiles(np.abs(block["pocket_force"])),
    )


def _quantiles(values):
    return np.quantile(values, QUANTILES)


def _with_spread(values, statistic):
    """Return a statistic and its standard error from blocks, which are taken as independent."""
    blocks = np.array([statistic(part) for part in np.array_split(values, _BLOCKS)])
    return statistic(values), blocks.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)


def slip_error(found: Settled, reference: Settled) -> float:
    """Return the error of the mean slip [percentage points]."""
    return abs(found.slip - reference.slip)


def quantile_error(found: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest relative error of quantiles in rows of increasing probability.

    Errors are relative to at least a hundredth of the highest quantile, because the median is 0 if half of the rollers are unloaded.
    """
    scale = np.maximum(reference, 0.01 * reference[..., -1:])
    return float(np.max(np.abs(found - reference) / np.where(scale > 0.0, scale, 1.0)))


def orbit_error(found: Settled, reference: Settled) -> float:
    """Return the relative error of the radius of the cage's orbit; 0 at levels without an orbit."""
    return abs(found.orbit - reference.orbit) / reference.orbit if reference.orbit > 0.0 else 0.0


def _settled_report(settled: Settled) -> dict:
    """Return a settled run as plain numbers in display units."""
    return {
        "slip_percent": settled.slip,
        "slip_standard_error": settled.slip_spread,
        "inner_load_quantiles": settled.loads[0].tolist(),
        "outer_load_quantiles": settled.loads[1].tolist(),
        "load_quantile_standard_error": quantile_error(settled.loads + settled.loads_spread, settled.loads),
        "orbit_radius_um": 1e6 * settled.orbit,
        "pocket_force_quantiles": settled.pocket.tolist(),
    }


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
    @numba.njit(error_model="numpy")
    def loop(calls, t, y, model, work, rate):
        for _ in range(calls):
            evaluate(t, y, model, work, rate)

    return loop


@functools.cache
def _factorisations(factor):
    @numba.njit(error_model="numpy")
    def loop(calls, shift, work):
        for _ in range(calls):
            factor(shift, work)

    return loop


@functools.cache
def _solutions(solve):
    @numba.njit(error_model="numpy")
    def loop(calls, work, right, x):
        for _ in range(calls):
            for i in range(x.shape[0]):  # solving the same vector repeatedly would decay into slow subnormal numbers
                x[i] = right[i]
            solve(work, x)

    return loop


@functools.cache
def _norms(error_norm):
    @numba.njit(error_model="numpy")
    def loop(calls, t, y, change, model):
        largest = 0.0
        for _ in range(calls):
            largest += error_norm(t, y, change, model)
            change[0] += 1e-300  # prevents the compiler from hoisting the call
        return largest

    return loop


_SCRIPT = """
import json, sys, time
began = time.perf_counter()
from bearing_sim import Simulation, load_scene
imported = time.perf_counter()
scene = load_scene(sys.argv[1], ["level=" + sys.argv[2]])
read = time.perf_counter()
run = Simulation(scene)
run.advance(1e-4)
advanced = time.perf_counter()
run.advance(1e-4)
print(json.dumps({"import_seconds": imported - began, "scene_seconds": read - imported, "first_advance_seconds": advanced - read,
    "second_advance_seconds": time.perf_counter() - advanced}))
"""


def start_up(bearing: str, level: str, cold: bool) -> dict[str, float]:
    """Return times [s] of importing, reading a scene, and the first and second 0.1 ms, in a fresh process.

    Parameters
    ----------
    bearing, level : scene and level.
    cold : with an empty cache of machine code, so that the first advance compiles everything.
    """
    with tempfile.TemporaryDirectory() as empty:
        environment = {**os.environ, "XDG_CACHE_HOME": empty} if cold else dict(os.environ)
        found = subprocess.run([sys.executable, "-c", _SCRIPT, bearing, level], capture_output=True, text=True, check=True, env=environment)
    return json.loads(found.stdout)


SPEEDS = (15_000.0, 45_000.0)  # rpm
# LSODA also with looser tolerances, to compare it at an error no smaller than ours.
OTHERS = (("LSODA", 1e-5), ("LSODA", 1e-4), ("LSODA", 1e-3), ("LSODA", 1e-2), ("BDF", 1e-5), ("CVODE", 1e-5), ("CVODE", 1e-3))
LSODA_TOLERANCE = 1e-5
_REFERENCE_TOLERANCE = 1e-10
# Fields of a case; null if there is nothing to measure (a level without a differential equation) or no counter.
_MEASURED = (
    *("real_time_factor", "step_us", "simulated_seconds"),
    *("steps", "rejected_steps", "non_finite_steps", "right_hand_sides", "jacobians", "factorisations"),
    *("slip_error", "slip_standard_error", "load_error", "orbit_error", "pocket_error"),
    *("trajectory_error", "window_seconds", "lsoda_ratio", "lsoda_ratio_at_our_error"),
)


class Extent(NamedTuple):
    """Extent of the measurement."""

    window: float = 2e-3  # for trajectories and other solvers, from ideal rolling [s]
    window_times: int = 4  # instants in the window at which states are compared
    settled: tuple = (0.2, 0.4)  # for means and quantiles [s]
    timed: float = 0.1  # for speed, after settling [s]
    repeats: int = 5
    tight: tuple = (0.03, 0.1)  # times the default tolerances: of the settled reference, and of the run that shows its convergence
    others: tuple = OTHERS
    rollers: tuple = (9, 18, 36, 72, 144)
    scaling_settled: tuple = (0.02, 0.04)
    scaling_tight: float = 0.1
    kernel_calls: int = 2000
    start_up: bool = True


FULL = Extent()
QUICK = Extent(
    5e-5, 2, (1e-3, 2e-3), 1e-3, 1, (0.3, 0.5), (("LSODA", 1e-5), ("CVODE", 1e-5)), (9, 18), (1e-3, 2e-3), 0.5, 200, False
)  # fmt: skip


@contextmanager
def one_core() -> Iterator[int]:
    """Keep this process on one core inside the block; yields its number, or -1 if the system does not support it."""
    if not hasattr(os, "sched_setaffinity"):
        yield -1
        return
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {max(before)})
    try:
        yield max(before)
    finally:
        os.sched_setaffinity(0, before)


def run_bench(quick: bool = False, cold: bool = False, progress: Callable[[str], None] = lambda text: None, levels: Sequence[str] = ()) -> dict:
    """Measure and return the report.

    Parameters
    ----------
    quick : measure as little as possible, for testing.
    cold : also measure the start of a process with an empty cache of machine code.
    progress : called with a line of text for each measurement.
    levels : to measure; empty: all.

    Returns
    -------
    report : plain numbers, strings, lists and dicts.
    """
    extent = QUICK if quick else FULL
    with one_core() as core:
        began, used = time.perf_counter(), time.process_time()
        report = {"bearing": BEARING, "radial_load": LOAD, "quick": quick, "machine": _machine(core)}
        cases, references, others, bounds = [], [], [], []
        levels = levels or tuple(LEVELS)
        for level in levels:
            for speed in SPEEDS:
                progress(f"{level} at {speed:g} rpm: references and other solvers")
                course, settled = _Course(level, speed, extent), _SettledReference(level, speed, STOCK_ROLLERS, extent.settled, extent.tight)
                references.append({"level": level, "speed_rpm": speed, **course.described(), **settled.described()})
                others += course.others
                for method, overrides in level_methods(level).items():
                    progress(f"{level} at {speed:g} rpm: {method}")
                    case, bound = _case(level, method, overrides, speed, extent, course, settled)
                    cases.append(case)
                    bounds.append(bound)
        progress("scaling with the number of rollers")
        scaling = [_scaling_case(level, rollers, extent) for level in levels for rollers in extent.rollers]
        cases += [case for case in scaling if case["rollers"] != STOCK_ROLLERS]
        report |= {"cases": cases, "others": others, "references": references, "bound": bounds, "scaling": _scaling(scaling)}
        report["machine"]["core_fraction"] = (time.process_time() - used) / (time.perf_counter() - began)
        if extent.start_up:
            progress("start-up")
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
    """The first milliseconds from ideal rolling: an accurate solution, and the results of other solvers."""

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
        return {"trajectory_method": "DOP853", "trajectory_tolerance": _REFERENCE_TOLERANCE, "trajectory_own_error": self.own_error}


class _SettledReference:
    """Reference for settled results: the level's own method at a tight tolerance, and at a looser one that shows the convergence."""

    def __init__(self, level: str, speed: float, rollers: int, window: tuple, tolerances: tuple):
        self.window, self.tolerances = window, tolerances
        runs = [settle(scaled_scene(level, speed, rollers, tolerances=factor), *window) for factor in tolerances]
        self.best, self.check = runs[0], runs[-1]

    def described(self) -> dict:
        return {
            "settled_tolerances": list(self.tolerances),
            "settled_slip_change": slip_error(self.check, self.best),
            "settled_load_change": quantile_error(self.check.loads, self.best.loads),
            **_settled_report(self.best),
        }

    def errors(self, scene: Scene) -> dict:
        """Return the errors of a scene's run over the same window."""
        found = settle(scene, *self.window)
        return {
            "slip_error": slip_error(found, self.best),
            "load_error": quantile_error(found.loads, self.best.loads),
            "orbit_error": orbit_error(found, self.best),
            "pocket_error": quantile_error(found.pocket, self.best.pocket),
            "slip_standard_error": found.slip_spread,
        }


class _Timed(NamedTuple):
    """Result of a timed run."""

    spent: float  # minimum of the repeats [s]
    counters: dict  # of one run
    state: np.ndarray  # at its end


def _timed(scene: Scene, before: float, duration: float, repeats: int) -> _Timed:
    """Time runs of ``duration`` [s] with a sample per millisecond, after ``before`` [s]; each continues the previous one."""
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
    """Return the time of the window from ideal rolling, over which other solvers are timed."""
    run, spent = Simulation(scene), []
    for _ in range(4 * repeats):
        run.reset()
        started = time.process_time()
        run.advance(window)
        spent.append(time.process_time() - started)
    return min(spent)


def _new_case(level: str, method: str, speed: float, rollers: int) -> dict:
    """Return a case without measurements."""
    return {"level": level, "integrator": method, "speed_rpm": speed, "rollers": rollers, "failure": "", **dict.fromkeys(_MEASURED)}


def _case(level, method, overrides, speed, extent, course, settled) -> tuple[dict, dict]:
    """Measure one level and method at one speed; return the case and what bounds its speed."""
    scene = scaled_scene(level, speed, overrides=overrides)
    case = _new_case(level, method, speed, STOCK_ROLLERS)
    bound = {"level": level, "integrator": method, "speed_rpm": speed}
    try:
        timed = _timed(scene, extent.settled[0], extent.timed, extent.repeats)
        looser_scene = scaled_scene(level, speed, overrides=overrides, tolerances=10.0)
        looser = _timed(looser_scene, extent.settled[0], extent.timed, 1)
        case |= _speed(timed, extent.timed) | settled.errors(scene)
    except IntegrationError as error:
        return case | {"failure": str(error)}, bound
    run, states = Simulation(scene), []
    for before, after in zip([0.0, *course.times], course.times):
        run.advance(after - before)
        states.append(run.state)
    case["trajectory_error"] = course.error(states)
    ours, lsoda = _window_time(scene, extent.window, extent.repeats), course.lsoda_time()
    case["window_seconds"] = ours
    if lsoda is not None:
        at_our_error = course.lsoda_time(case["trajectory_error"])
        case |= {"lsoda_ratio": lsoda / ours, "lsoda_ratio_at_our_error": at_our_error / ours if at_our_error is not None else None}
    bound |= {
        "step_simulated_us": _per(1e6 * extent.timed, timed.counters["steps"]),
        "step_simulated_at_tenfold_tolerance_us": _per(1e6 * extent.timed, looser.counters["steps"]),
    }
    if course.problem is not None and case["step_us"] is not None:
        times = kernel_times(course.problem, timed.state, extent.kernel_calls)
        bound |= {"kernel_us": times, "fraction": kernel_fractions(times, timed.counters, case["step_us"])}
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
    """Measure the level's own method on a bearing scaled to another number of rollers, from 45,000 rpm."""
    speed, (start, end) = SPEEDS[-1], extent.scaling_settled
    scene = scaled_scene(level, speed, rollers)
    timed = _timed(scene, start, end - start, extent.repeats)
    settled = _SettledReference(level, speed, rollers, extent.scaling_settled, (extent.scaling_tight,))
    case = _new_case(level, next(iter(level_methods(level))), speed * STOCK_ROLLERS / rollers, rollers)
    return case | _speed(timed, end - start) | settled.errors(scene)


def _scaling(cases: list[dict]) -> list[dict]:
    """Return the time of a simulated second by number of rollers, and the power of Z with which it grows from 18 rollers."""
    found = []
    for level in dict.fromkeys(case["level"] for case in cases):
        own = {case["rollers"]: 1.0 / case["real_time_factor"] for case in cases if case["level"] == level}
        first, last = STOCK_ROLLERS, max(own)
        exponent = np.log(own[last] / own[first]) / np.log(last / first) if last > first else None
        found.append({"level": level, "rollers": list(own), "core_seconds_per_second": list(own.values()), "exponent": exponent})
    return found
