# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench view``: what a live view costs the solver, and how an hour opens."""

import click

from bearing_sim.commands.reporting import FailedRun, print_json, print_rows, tell_compilation


@click.command()
@click.option("--seconds", type=click.FloatRange(min=0.1), default=60.0, show_default=True, metavar="S", help="How long each situation is measured.")
@click.option("--frozen", type=click.FloatRange(min=0.1), default=60.0, show_default=True, metavar="S", help="How long the viewer is frozen.")
@click.option("--quick", is_flag=True, help="Measure next to nothing, to see that everything works.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(seconds, frozen, quick, as_json):
    """Measure what a live view costs the solver while viewers are absent, attached, frozen and killed, and how an hour's recording opens.

    Needs a Vulkan driver, which may be a software one.
    """
    from bearing_sim.screenshot import ViewerFailed
    from bearing_sim.studies.bench_view import run_hour, run_view_bench

    def tell(text):
        click.echo(f"{text} ...", err=True)

    tell_compilation()
    try:
        report = run_view_bench(min(seconds, 1.0) if quick else seconds, min(frozen, 1.0) if quick else frozen, tell)
        report["hour"] = run_hour(*([120.0] if quick else []), progress=tell)
    except ViewerFailed as fault:
        raise FailedRun(f"no viewer to measure with: {fault}") from None
    if as_json:
        print_json(report)
    else:
        _print(report)


def _print(report) -> None:
    def spread(found):
        return f"{found['median']:.4f} ({found['low']:.4f} to {found['high']:.4f})"

    columns = ("while", "pairs", "rate, by wall", "control", "share of time computing", "control", "by processor time", "worst wait [ms]", "missed")
    shown = (("with", "wall_rate"), ("control", "wall_rate"), ("with", "share"), ("control", "share"), ("with", "processor_rate"))
    rows = []
    for row in (*report["situations"], {"name": "all with a view, together", **report["together"]}):
        told = [spread(row[kind][name]) for kind, name in shown]
        waits = f"{1e3 * row['worst_wait_with']:.2f}, without {1e3 * row['worst_wait_without']:.2f}" if "worst_wait_with" in row else ""
        rows.append((row["name"], str(row["with"]["rate"]["pairs"]), *told, waits, str(row.get("dropped", ""))))
    title = f"the solver with a live view, 1000 samples a second, to stretches of {report['stretch']:g} s without; "
    print_rows(f"{title}load average {report['load_average']:.2f}", columns, rows, words=("while",), width=220)
    click.echo("median, and where it lies with 95 % confidence; a wait is what a tick neither worked nor waited for a core")
    hour = report["hour"]
    click.echo(
        f"{hour['simulated_seconds']:g} s at 1 kHz: {hour['samples']} samples, {hour['bytes'] / 1e6:.1f} MB, made "
        f"in {hour['writing_seconds']:.0f} s, opened in {hour['opening_seconds']:.1f} s with {hour['viewer_bytes'] / 1e6:.0f} MB in the viewer"
    )
