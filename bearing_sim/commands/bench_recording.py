# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench recording``: what recording all observables costs a live run."""

import click

from bearing_sim.commands.reporting import print_json, print_rows, require_levels, tell_compilation

_QUICK_SECONDS = 2.0


@click.command()
@click.option("--level", "levels", multiple=True, default=("slip", "planar"), show_default=True, metavar="LEVEL", help="Level; may be repeated.")
@click.option("--seconds", type=click.FloatRange(min=2), default=20.0, show_default=True, metavar="S", help="Length of a run.")
@click.option("--rate", type=click.FloatRange(min=1), default=1000.0, show_default=True, metavar="HZ", help="Samples a second.")
@click.option("--repetitions", type=click.IntRange(min=1), default=3, show_default=True, metavar="N", help="Runs of each kind.")
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(levels, seconds, rate, repetitions, quick, as_json):
    """Run bearing deng2017_table1 in real time with and without a recording of all observables: the solver's rate, ticks and stalls."""
    require_levels(levels)
    tell_compilation()
    if quick:
        seconds, repetitions = _QUICK_SECONDS, 1
    from bearing_sim.scene_file import load_scene
    from bearing_sim.studies.bench_recording import at_level, recording_cost

    scene = load_scene("deng2017_table1")
    reports = [
        recording_cost(at_level(scene, level), seconds, rate, repetitions, lambda text, level=level: click.echo(f"{level}: {text} ...", err=True))
        for level in levels
    ]
    if as_json:
        print_json({"recording": reports})
    else:
        _print(reports, f"live runs of {seconds:g} s at {rate:g} samples a second, medians of {repetitions} of each kind")


def _print(reports, title) -> None:
    columns = ("level", "recording", "times real time", "tick [ms]", "late p50", "p99", "p99.9", "worst [ms]", "processor")
    rows = []
    for report in reports:
        for kind in ("without", "with"):
            told = report[kind]
            names = ("solver_rate", "spent_median_ms", "late_p50_ms", "late_p99_ms", "late_p999_ms", "late_worst_ms")
            rows.append([report["level"], kind, *(format(told[name], ".3g") for name in names), f"{100 * told['processor_share']:.0f} %"])
    print_rows(title, columns, rows, words=("level", "recording"), width=170)
    for report in reports:
        click.echo(
            f"{report['level']}: recording costs {100 * (1 - report['rate_ratio']):.2f} % of the solver's rate "
            f"({100 * (1 - report['processor_rate_ratio']):.2f} % by its thread's processor time); worst stall {report['worst_stall_ms']:+.2f} ms, "
            f"p99.9 {report['p999_stall_ms']:+.2f} ms beyond the runs without; {report['recording_mb_per_second']:.3g} MB/s written"
        )
