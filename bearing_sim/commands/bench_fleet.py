# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench fleet``: how many bearings one core holds in real time."""

import click

from bearing_sim.commands.reporting import print_json, print_rows, require_levels, tell_compilation

_SPEEDS = (1500.0, 15_000.0, 45_000.0)  # rpm
_SECONDS, _QUICK_SECONDS = 5.0, 0.5  # of each run


@click.command()
@click.option(
    "--level", "levels", multiple=True, default=("steady", "slip", "planar"), show_default=True, metavar="LEVEL", help="Level; may be repeated."
)
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(levels, quick, as_json):
    """Measure how many bearings deng2017_table1 one core holds in real time, by running them, at 1500, 15,000 and 45,000 rpm."""
    require_levels(levels)
    tell_compilation()
    report = _measure(levels, quick)
    if as_json:
        print_json(report)
    else:
        _print(report)


def _measure(levels, quick) -> dict:
    import os

    from bearing_sim.runtime.fleet import most_bearings
    from bearing_sim.scene_file import load_scene
    from bearing_sim.studies.bench import one_core

    cases = []
    with one_core() as core:
        for level in levels:
            for speed in _SPEEDS[:1] if quick else _SPEEDS:
                click.echo(f"{level} at {speed:g} rpm ...", err=True)
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


def _print(report) -> None:
    rows = []
    for case in report["cases"]:
        shares = [f"{100 * case[name]:.2f}" for name in ("core_share_of_one", "core_share_of_each")]
        rows.append((case["level"], f"{case['speed_rpm']:.0f}", shares[0], f"{case['expected_from_one']:.0f}", str(case["bearings"]), shares[1]))
    columns = ("level", "rpm", "core for one [%]", "so many expected", "so many held", "core for each [%]")
    print_rows("bearings that one core holds in real time, really run, without ROS", columns, rows, words=("level",), width=120)
    click.echo(f"core {report['core']}, load average {report['load_average']:.2f}; 0 held: the machine was busy with other things")
