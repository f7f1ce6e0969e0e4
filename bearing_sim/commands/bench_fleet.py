# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench --fleet``: how many bearings one core holds in real time."""

import click

from bearing_sim.commands.reporting import print_json

_LEVELS = ("steady", "slip", "planar")
_SPEEDS = (1500.0, 15_000.0, 45_000.0)  # rpm
_SECONDS, _QUICK_SECONDS = 5.0, 0.5  # of each run


def run(as_json: bool, quick: bool, levels: tuple[str, ...]) -> None:
    """Measure and print."""
    import os

    from bearing_sim.runtime.fleet import most_bearings
    from bearing_sim.scene_file import load_scene
    from bearing_sim.studies.bench import one_core

    cases = []
    with one_core() as core:
        for level in levels or _LEVELS:
            for speed in _SPEEDS[:1] if quick else _SPEEDS:
                click.echo(f"{level} at {speed:g} rpm ...", err=True)
                scene = load_scene("deng2017_table1", [f"level={level}", f"operating.shaft_speed={speed} rpm"])
                runs = most_bearings(scene, _QUICK_SECONDS if quick else _SECONDS)
                one, most = next(run for run in runs if run.bearings == 1), runs[-1]
                cases.append(
                    {
                        "level": level,
                        "speed_rpm": speed,
                        "core_share_of_one": one.core_seconds,
                        "expected_from_one": 1.0 / one.core_seconds,
                        "bearings": most.bearings if most.holds else 0,
                        "core_share_of_each": most.core_seconds,
                        "runs": [{**run._asdict(), "holds": run.holds} for run in runs],
                    }
                )
    report = {"bearing": "deng2017_table1", "core": core, "load_average": os.getloadavg()[0], "quick": quick, "cases": cases}
    if as_json:
        print_json(report)
    else:
        _print(report)


def _print(report: dict) -> None:
    import sys

    from rich.console import Console
    from rich.table import Table

    table = Table(title="bearings that one core holds in real time, really run, without ROS", title_justify="left")
    for name in ("level", "rpm", "core for one [%]", "so many expected", "so many held", "core for each [%]"):
        table.add_column(name, justify="right")
    for case in report["cases"]:
        shares = [f"{100 * case[name]:.2f}" for name in ("core_share_of_one", "core_share_of_each")]
        table.add_row(case["level"], f"{case['speed_rpm']:.0f}", shares[0], f"{case['expected_from_one']:.0f}", str(case["bearings"]), shares[1])
    Console(width=None if sys.stdout.isatty() else 120).print(table)
    click.echo(f"core {report['core']}, load average {report['load_average']:.2f}; 0 held: the machine was busy with other things")
