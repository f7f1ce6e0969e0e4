# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Speed, work and errors of each level on this machine, with error control and with a fixed step: ``python test/benchmarks/level_speed.py``.

Start-up times stand beside them.

One process on one core measures everything, so that its figures are comparable.  All times are processor times of this process,
independent of other load; on an idle machine they equal wall time.  The minimum of repeats counts, because disturbances only add.
``test/benchmarks/solver_comparison.py`` compares with other solvers.
"""

import itertools
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import NamedTuple

import click
import numpy as np

from bearing_sim.cli.bench import one_core
from bearing_sim.cli.options import flag, json_option, level_type, option, quick_option
from bearing_sim.cli.reporting import announce_compilation, note, print_rows
from bearing_sim.cli.results import Result, command
from bearing_sim.levels.level import LEVELS
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation

BEARING = "deng2017_table1"  # scene of the bench
LOAD = 800.0  # N
SPEEDS = (15_000.0, 45_000.0)  # rpm


def level_integrators(level: str) -> dict[str, list[str]]:
    """Return the overrides of a scene for each way to integrate a level, by name: with error control, and in steps of 10 us."""
    method = LEVELS[level].method
    found = {method: []}
    if LEVELS[level].takes_steps:
        found[f"{method}, fixed step"] = ["integration.fixed_step=10 us"]
    return found


def bench_scene(level: str, speed_rpm: float, overrides: Sequence[str] = ()) -> Scene:
    """Return the scene of the bench at a level and a shaft speed, with further overrides."""
    own = [f"level={level}", f"operating.shaft_speed={speed_rpm} rpm", f"operating.radial_load={LOAD} N"]
    return load_scene(BEARING, [*own, *overrides])


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


class SettledReference:
    """Reference for settled results: the level's own method at a tight tolerance, and at a looser one that shows the convergence.

    Parameters
    ----------
    scene : with the default tolerances.
    window : start and end of the time over which results are compared [s].
    tolerances : factors on the tolerances of the scene, the tightest first.
    """

    def __init__(self, scene: Scene, window: tuple[float, float], tolerances: Sequence[float]):
        self.window, self.tolerances = window, tolerances
        runs = [settle(replace(scene, integration=scene.integration.with_tolerances(factor)), *window) for factor in tolerances]
        self.best, self.check = runs[0], runs[-1]

    def described(self) -> dict:
        """Return the reference and its change from the looser tolerance as plain numbers in display units."""
        return {
            "settled_tolerances": list(self.tolerances),
            "settled_slip_change": slip_error(self.check, self.best),
            "settled_load_change": quantile_error(self.check.loads, self.best.loads),
            "slip_percent": self.best.slip,
            "slip_standard_error": self.best.slip_spread,
            "inner_load_quantiles": self.best.loads[0].tolist(),
            "outer_load_quantiles": self.best.loads[1].tolist(),
            "load_quantile_standard_error": quantile_error(self.best.loads + self.best.loads_spread, self.best.loads),
            "orbit_radius_um": 1e6 * self.best.orbit,
            "pocket_force_quantiles": self.best.pocket.tolist(),
        }

    def errors(self, scene: Scene) -> dict[str, float]:
        """Return the errors of a scene's run over the same window: of slip in percentage points, the others relative.

        The orbit's error is that of its radius; 0 at levels without an orbit.
        """
        found = settle(scene, *self.window)
        return {
            "slip_error": slip_error(found, self.best),
            "load_error": quantile_error(found.loads, self.best.loads),
            "orbit_error": abs(found.orbit - self.best.orbit) / self.best.orbit if self.best.orbit > 0.0 else 0.0,
            "pocket_error": quantile_error(found.pocket, self.best.pocket),
            "slip_standard_error": found.slip_spread,
        }


class Timed(NamedTuple):
    """Result of a timed run."""

    duration: float  # simulated [s]
    spent: float  # processor time, minimum of the repeats [s]
    counters: dict[str, int]  # of one repeat
    state: np.ndarray  # at its end

    def described(self) -> dict[str, float | None]:
        """Return speed and work as plain numbers."""
        return {
            "real_time_factor": self.duration / self.spent,
            "step_us": 1e6 * self.spent / self.counters["steps"] if self.counters["steps"] else None,
            "simulated_seconds": self.duration,
            **self.counters,
        }


def timed_run(scene: Scene, before: float, duration: float, repeats: int) -> Timed:
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
    return Timed(duration, min(spent), counters, run.state)


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


# Fields of a case; null if there is nothing to measure or no counter.
_MEASURED = (
    *("real_time_factor", "step_us", "simulated_seconds"),
    *("steps", "rejected_steps", "non_finite_steps", "right_hand_sides", "jacobians", "factorisations"),
    *("slip_error", "slip_standard_error", "load_error", "orbit_error", "pocket_error"),
)


class Extent(NamedTuple):
    """Extent of the measurement."""

    settled: tuple[float, float] = (0.2, 0.4)  # for means and quantiles [s]
    timed: float = 0.1  # for speed, after settling [s]
    repeats: int = 5
    tight: tuple[float, ...] = (0.03, 0.1)  # times the default tolerances: of the reference, and of the run that shows its convergence
    start_up: bool = True


FULL = Extent()
QUICK = Extent((1e-3, 2e-3), 1e-3, 1, (0.3, 0.5), False)


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
    extent, levels = QUICK if quick else FULL, levels or tuple(LEVELS)
    with one_core() as core:
        began, used = time.perf_counter(), time.process_time()
        report = {"bearing": BEARING, "radial_load": LOAD, "quick": quick, "machine": machine_facts(core), "cases": [], "references": []}
        for level, speed in itertools.product(levels, SPEEDS):
            where = {"level": level, "speed_rpm": speed}
            progress(f"{level} at {speed:g} rpm: reference")
            settled = SettledReference(bench_scene(level, speed), extent.settled, extent.tight)
            report["references"].append(where | settled.described())
            for name, overrides in level_integrators(level).items():
                progress(f"{level} at {speed:g} rpm: {name}")
                measured = _measure(bench_scene(level, speed, overrides), settled, extent)
                report["cases"].append(where | {"integrator": name} | measured)
        report["machine"]["core_fraction"] = (time.process_time() - used) / (time.perf_counter() - began)
        if extent.start_up:
            progress("start-up")
            starts = itertools.product((False, True) if cold else (False,), levels)
            report["start_up"] = [{"level": level, "cold": is_cold, **start_up(BEARING, level, is_cold)} for is_cold, level in starts]
    return report


def _measure(scene: Scene, settled: SettledReference, extent: Extent) -> dict:
    """Return speed, work and errors of a scene, or why it failed."""
    case = {"failure": "", **dict.fromkeys(_MEASURED)}
    try:
        timed = timed_run(scene, extent.settled[0], extent.timed, extent.repeats)
        return case | timed.described() | settled.errors(scene)
    except IntegrationError as error:
        return case | {"failure": str(error)}


def machine_facts(core: int) -> dict[str, str | float | None]:
    """Return what the figures depend on besides the code: processor, load and versions."""
    return {
        "core": core,
        "cores": os.cpu_count(),
        "load_average": os.getloadavg()[0],
        "processor": _processor(),
        "python": platform.python_version(),
        "numba": version("numba"),
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    except OSError:
        return platform.machine()


_WORDS = ("level", "integrator")  # columns of text


@command("levels")
@option("--level", "levels", "Measure this level; can be repeated [default: all].", level_type, multiple=True)
@flag("--cold", "Also measure the very first start, which compiles.")
@quick_option
@json_option
def main(levels, cold, quick):
    """Measure how fast each level is with error control and with a fixed step, what work it does, and how large its errors are.

    Bearing deng2017_table1 at 800 N, 15,000 and 45,000 rpm.  Takes less than a minute per level once compiled, and longer for level spatial.
    """
    announce_compilation()
    report = run_bench(quick, cold, lambda text: note(f"{text} ..."), levels)
    return Result(report, lambda: _print_levels(report))


def _print_levels(report) -> None:
    machine = report["machine"]
    click.echo(f"core {machine['core']} of {machine['cores']} ({machine['processor']}), load average {machine['load_average']:.2f} at the start")
    click.echo(f"times are on the core, which the benchmark had for {100 * machine['core_fraction']:.0f} % of the time")
    _print_cases(report["cases"])
    _print_references(report["references"])
    for start in report.get("start_up", []):
        how = "with an empty cache" if start["cold"] else "warm"
        click.echo(
            f"start of {start['level']}, {how}: import {start['import_seconds']:.2f} s, scene {start['scene_seconds']:.2f} s, "
            f"first advance {start['first_advance_seconds']:.2f} s"
        )


def _number(value, form=".3g") -> str:
    return "-" if value is None else format(value, form)


def _print_cases(cases) -> None:
    def named(case):
        return [case["level"], case["integrator"], f"{case['speed_rpm']:.0f}"]

    def cost(case):
        if case["failure"]:
            return [*named(case), case["failure"]]
        steps = case["steps"]
        counted = ("rejected_steps", "right_hand_sides", "jacobians", "factorisations")
        per_step = [None if case[name] is None or not steps else case[name] / steps for name in counted]
        numbers = [case["real_time_factor"], case["step_us"], steps / case["simulated_seconds"], *per_step]
        return [*named(case), *map(_number, numbers)]

    def error(case):
        shares = [case[name] and 100 * case[name] for name in ("load_error", "orbit_error", "pocket_error")]
        slip = [_number(case[name], ".3f") for name in ("slip_error", "slip_standard_error")]
        return [*named(case), *slip, *map(_number, shares)]

    columns = ("level", "integrator", "rpm")
    costs = ("x real time", "us/step", "steps/s", "rejected/step", "rhs/step", "jac/step", "fact/step")
    errors = ("slip [pp]", "standard error", "loads [%]", "orbit [%]", "pocket [%]")
    print_rows("speed", columns + costs, map(cost, cases), words=_WORDS)
    print_rows("errors", columns + errors, map(error, [case for case in cases if not case["failure"]]), words=_WORDS)


def _print_references(references) -> None:
    def row(found):
        names = ("slip_percent", "slip_standard_error", "settled_slip_change", "settled_load_change", "orbit_radius_um")
        return [found["level"], f"{found['speed_rpm']:.0f}", *[_number(found[name], ".4g") for name in names]]

    columns = ("level", "speed [rpm]", "slip [%]", "±", "change of slip [points]", "of loads", "orbit [µm]")
    title = "references: the level's own method at a tight tolerance, and its change from a less tight one"
    print_rows(title, columns, map(row, references), words=_WORDS)


if __name__ == "__main__":
    main()
