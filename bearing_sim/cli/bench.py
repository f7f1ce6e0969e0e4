# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench`` and ``compile``: how many bearings a core holds, and compiling ahead of a run."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager

import click
from click import IntRange

from bearing_sim.cli.options import flag, json_option, level_type, option, quick_option
from bearing_sim.cli.reporting import announce_compilation, note, print_rows, progress_bar
from bearing_sim.cli.results import Result, command

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


def _measure(levels, quick) -> dict:
    from bearing_sim.runtime.fleet import most_bearings
    from bearing_sim.scene.loader import load_scene

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
@flag("--bending", "Compile for outer rings that bend, which need a version of their own.")
@flag("--prune", "Afterwards remove the compiled code of other versions of bearing_sim.")
def compile_levels(levels, workers, bending, prune):
    """Compile levels now instead of at their first run, in parallel on all cores.

    Compiled code is cached on disk, per user and version of the model; code that is already in the cache is not compiled again.
    """
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.runtime.precompilation import announcement, builds, compile_all, is_compiled, remove_other_versions

    wanted, began = builds(levels or tuple(LEVELS), bending), time.monotonic()
    if missing := [build for build in wanted if not is_compiled(build.level, build.bends)]:
        note(announcement(missing))
    with progress_bar("compiling", len(wanted)) as show:
        for done, build in enumerate(compile_all(wanted, workers), 1):
            note(f"{build}: compiled ({time.monotonic() - began:.0f} s)")
            show(done)
    if prune:
        note(f"{remove_other_versions() / 1e6:.0f} MB of other versions removed")
