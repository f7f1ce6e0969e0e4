# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench recording``: what recording all observables and a live view cost a run in real time."""

import click

from bearing_sim.commands.reporting import print_json, print_rows, require_levels, tell_compilation

_FIGURES = {
    "rate": "rate by wall time, of that without",
    "core_rate": "rate while a core was to be had",
    "processor_rate": "rate by its thread's processor time",
    "worst_stall_ms": "worst stall [ms], beyond that without",
    "late_stall_ms": "99.9 % of ticks stall less [ms], beyond",
    "worst_held_ms": "worst stall but for waits for a core [ms], beyond",
    "late_held_ms": "99.9 % of these [ms], beyond",
}


@click.command()
@click.option("--level", "levels", multiple=True, default=("slip", "planar"), show_default=True, metavar="LEVEL", help="Level; may be repeated.")
@click.option("--seconds", type=click.FloatRange(min=0.5), default=1.0, show_default=True, metavar="S", help="Length of a stretch.")
@click.option("--pairs", type=click.IntRange(min=1), default=24, show_default=True, metavar="N", help="Pairs of stretches, with and without.")
@click.option("--rate", type=click.FloatRange(min=1), default=1000.0, show_default=True, metavar="HZ", help="Samples a second.")
@click.option(
    "--viewer",
    type=click.Choice(["drawing", "taking", "nobody", "no-view"]),
    default="drawing",
    show_default=True,
    help="Of the live view: one that draws on this processor, one that takes all that is to be drawn elsewhere, nobody; or no view.",
)
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(levels, seconds, pairs, rate, viewer, quick, as_json):
    """Run bearing deng2017_table1 in real time with and without sinks, in turn: the solver's rate and stalls.

    Every other stretch has no sinks; of the others every other one has none either and tells how much the machine itself makes of nothing.
    """
    require_levels(levels)
    tell_compilation()
    if quick:
        seconds, pairs = 0.5, 1
    from bearing_sim.scene_file import load_scene
    from bearing_sim.studies.bench_recording import at_level, recording_cost

    def told(level):
        return lambda text: click.echo(f"{level}: {text} ...", err=True)

    scene = load_scene("deng2017_table1")
    reports = [recording_cost(at_level(scene, level), seconds, rate, pairs, viewer, progress=told(level)) for level in levels]
    if as_json:
        print_json({"recording": reports})
        return
    for report in reports:
        _print(report)


def _print(report) -> None:
    def spread(found):
        return f"{found['median']:.3f} ({found['low']:.3f} to {found['high']:.3f})"

    rows = [
        (meaning, spread(report["with"][name]), spread(report["control"][name]), format(report["without"][name], ".3g"))
        for name, meaning in _FIGURES.items()
    ]
    title = (
        f"{report['level']}: recording at {report['sample_rate']:g} Hz and a live view (viewer: {report['viewer']}), {report['pairs']} pairs of "
        f"stretches of {report['seconds']:g} s"
    )
    print_rows(title, ("recording", "with", "control, without", "without"), rows, words=("recording",), width=170)
    click.echo(
        f"median, and where it lies with 95 % confidence; {report['recording_mb_per_second']:.3g} MB/s written, {report['dropped']} blocks missed; "
        f"load average {report['load_average']:.2f}, {100 * report['stolen_share']:.1f} % of the processors' time stolen by the host"
    )
