# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study extremes``: the stability map."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import FailedRun, picture_option, print_json, print_table, progress_bar, require_levels, told_file_faults

_SHOWN = 12  # reasons in a table


@click.command()
@click.option("--samples", default=500, show_default=True, type=click.IntRange(0, 1_000_000), help="Scenes of the Latin hypercube for each level.")
@click.option("--level", "levels", multiple=True, metavar="LEVEL", help="Study this level; may be repeated [default: all].")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Of the Latin hypercube.")
@click.option("--long/--no-long", default=True, show_default=True, help="Make the long continuous runs, too.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@picture_option("Draw the map")
@click.option("--csv", "table", type=click.Path(path_type=Path), metavar="PATH.csv", help="Write all cases, one a line.")
def command(samples, levels, seed, long, as_json, picture, table):
    """Run scenes at the extremes of everything and tell which finish, are clamped, are refused or fail.

    Speed, load, play, lobes, rollers, pockets, lands, oil, slices, methods, tolerances and steps by a Latin hypercube, and corners by name, on
    all cores this process may use.  Exit code 1 where anything fails.
    """
    from bearing_sim.studies.extremes import run_extremes

    require_levels(levels)
    with progress_bar("extremes", 1.0) as progress:
        report, outcomes = run_extremes(samples, levels, seed, long, lambda text: click.echo(f"{text} ...", err=True), progress)
    with told_file_faults():
        if table is not None:
            from bearing_sim.studies.extremes_table import write_table

            write_table(table, outcomes)
        if picture is not None:
            from bearing_sim.studies.extremes_picture import draw

            draw(picture, outcomes)
    if as_json:
        print_json(report)
    else:
        for level, told in report["levels"].items():
            _print(level, told)
    if report["failed"]:
        raise FailedRun(f"{report['failed']} of {sum(report[name] for name in ('finished', 'clamped', 'refused', 'failed'))} cases failed")


def _print(level, told) -> None:
    rows = [(name, str(told[name])) for name in ("finished", "clamped", "refused", "failed")]
    rows += [(f"clamped by {reason}", str(count)) for reason, count in list(told["clamped_by"].items())[:_SHOWN]]
    rows += [(f"refused for {reason}", str(count)) for reason, count in list(told["refused_by"].items())[:_SHOWN]]
    rows += [(f"failed: {failure['case']}", failure["reason"]) for failure in told["failures"][:_SHOWN]]
    worst = {
        "steps_per_ms": "most steps in a simulated ms",
        "right_hand_sides_per_ms": "most right-hand sides in a simulated ms",
        "core_ms_per_ms": "most core time for a simulated ms, in ms",
        "step_us": "longest step, in us of core time",
    }
    for kind, whose in (("worst_by_the_model", ""), ("worst", ", settings that ask for small steps included")):
        rows += [
            (text + whose, f"{told[kind][name]['value']:.4g} ({told[kind][name]['case']})") for name, text in worst.items() if name in told[kind]
        ]
    rows += [
        (
            f"{run['simulated']:g} s at {run['speed_rpm']:g} rpm",
            run["fault"]
            or f"{run['real_time_factor']:.3g} times real time; drift of slip {run['slip_drift']:.1e}, damage rate {run['damage_drift']:.1e}, energy "
            f"{run['energy_drift']:.1e}; angle errors {run['shaft_angle_error']:.1e} shaft, {run['cage_angle_error']:.1e} cage",
        )
        for run in told["long_runs"]
    ]
    print_table(f"extremes at level {level}, {told['core_seconds']:.0f} s of core time", rows)
