# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench`` and ``compile``: how fast the model is, and compiling ahead of a run."""

import time

import click
from click import IntRange

from bearing_sim.cli.options import flag, json_option, level_type, option, quick_option
from bearing_sim.cli.reporting import announce_compilation, note, print_rows, progress_bar
from bearing_sim.cli.results import Result, command

_WORDS = ("level", "integrator")  # columns of text


@command("levels")
@option("--level", "levels", "Measure this level; can be repeated [default: all].", level_type, multiple=True)
@flag("--cold", "Also measure the very first start, which compiles.")
@quick_option
@json_option
def levels(levels, cold, quick):
    """Measure how fast each level is with error control and with a fixed step, what work it does, and how large its errors are.

    Bearing deng2017_table1 at 800 N, 15,000 and 45,000 rpm.  Takes less than a minute per level once compiled, and longer for level spatial.
    """
    announce_compilation()
    from bearing_sim.studies.bench import run_bench

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


_SPEEDS = (1500.0, 15_000.0, 45_000.0)  # rpm
_SECONDS, _QUICK_SECONDS = 5.0, 0.5  # per run


@command("fleet")
@option("--level", "levels", "Level; can be repeated.", level_type, multiple=True, default=("steady", "slip", "planar"))
@quick_option
@json_option
def fleet(levels, quick):
    """Run more and more bearings deng2017_table1 on one core, at 1500, 15,000 and 45,000 rpm, until it no longer holds real time."""
    announce_compilation()
    report = _measure(levels, quick)
    return Result(report, lambda: _print_fleet(report))


def _measure(levels, quick) -> dict:
    import os

    from bearing_sim.runtime.fleet import most_bearings
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.studies.bench import one_core

    cases = []
    with one_core() as core:
        for level in levels:
            for speed in _SPEEDS[:1] if quick else _SPEEDS:
                note(f"{level} at {speed:g} rpm ...")
                scene = load_scene("deng2017_table1", [f"level={level}", f"operating.shaft_speed={speed} rpm"])
                cases.append(_case(level, speed, most_bearings(scene, _QUICK_SECONDS if quick else _SECONDS)))
    return {"bearing": "deng2017_table1", "core": core, "load_average": os.getloadavg()[0], "quick": quick, "cases": cases}


def _case(level, speed, runs) -> dict:
    one, most = next(run for run in runs if run.bearings == 1), runs[-1]
    return {
        "level": level,
        "speed_rpm": speed,
        "core_share_of_one": one.core_seconds,
        "expected_from_one": 1.0 / one.core_seconds,
        "bearings": most.bearings if most.holds else 0,
        "core_share_of_each": most.core_seconds,
        "runs": [{**run._asdict(), "holds": run.holds} for run in runs],
    }


def _print_fleet(report) -> None:
    rows = []
    for case in report["cases"]:
        shares = [f"{100 * case[name]:.2f}" for name in ("core_share_of_one", "core_share_of_each")]
        rows.append((case["level"], f"{case['speed_rpm']:.0f}", shares[0], f"{case['expected_from_one']:.0f}", str(case["bearings"]), shares[1]))
    columns = ("level", "rpm", "core for one [%]", "expected", "held", "core for each [%]")
    print_rows("bearings that one core holds in real time, measured by running them, without ROS", columns, rows, words=("level",), width=120)
    click.echo(f"core {report['core']}, load average {report['load_average']:.2f}; 0 held: the machine was busy")


@command("compile")
@option("--level", "levels", "Compile this level; can be repeated [default: all].", level_type, multiple=True)
@option("--workers", "Number of processes [default: one per core].", IntRange(min=1), metavar="N")
@flag("--prune", "Afterwards remove the compiled code of other versions of bearing_sim.")
def compile_levels(levels, workers, prune):
    """Compile levels now instead of at their first run, in parallel on all cores.

    Compiled code is cached on disk, per user and version of the model; code that is already in the cache is not compiled again.
    """
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.runtime.precompilation import announcement, builds, compile_all, is_compiled, remove_other_versions

    wanted, began = builds(levels or tuple(LEVELS)), time.monotonic()
    if missing := [build for build in wanted if not is_compiled(build.level)]:
        note(announcement(missing))
    with progress_bar("compiling", len(wanted)) as show:
        for done, build in enumerate(compile_all(wanted, workers), 1):
            note(f"{build}: compiled ({time.monotonic() - began:.0f} s)")
            show(done)
    if prune:
        note(f"{remove_other_versions() / 1e6:.0f} MB of other versions removed")
