# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench --view``: what a live view costs the solver, and how an hour opens."""

import click

from bearing_sim.commands.reporting import FailedRun, print_json, tell_compilation


def measure_view(as_json: bool, quick: bool, frozen: float) -> None:
    """Measure and print.

    Parameters
    ----------
    as_json : print one JSON object instead of tables.
    quick : measure next to nothing, to see that everything works.
    frozen : for how long the viewer is frozen [s].
    """
    from bearing_sim.screenshot import ViewerFailed
    from bearing_sim.studies.bench_view import run_hour, run_view_bench

    def tell(text):
        click.echo(f"{text} ...", err=True)

    tell_compilation()
    try:
        report = run_view_bench(1.0 if quick else 60.0, min(frozen, 1.0) if quick else frozen, tell)
        report["hour"] = run_hour(*([120.0] if quick else []), progress=tell)
    except ViewerFailed as fault:
        raise FailedRun(f"no viewer to measure with: {fault}") from None
    if as_json:
        print_json(report)
    else:
        _print(report)


def _print(report) -> None:
    import sys

    from rich.console import Console
    from rich.table import Table

    def spread(found):
        return f"{found['median']:.4f} ({found['low']:.4f} to {found['high']:.4f})"

    title = f"the solver with a live view, 1000 samples a second, to stretches of {report['stretch']:g} s without; "
    table = Table(title=f"{title}load average {report['load_average']:.2f}", title_justify="left")
    columns = (
        "while",
        "pairs",
        "rate, by wall",
        "while a core was to be had",
        "by processor time",
        "control, by processor time",
        "worst wait [ms]",
        "missed",
    )
    for name in columns:
        table.add_column(name, justify="left" if name == "while" else "right")
    for row in report["situations"]:
        told = [spread(row["with"][name]) for name in ("wall_rate", "rate", "processor_rate")]
        waits = f"{1e3 * row['worst_wait_with']:.2f}, without {1e3 * row['worst_wait_without']:.2f}"
        pairs, control = str(row["with"]["rate"]["pairs"]), spread(row["control"]["processor_rate"])
        table.add_row(row["name"], pairs, *told, control, waits, str(row["dropped"]))
    Console(width=None if sys.stdout.isatty() else 200).print(table)
    click.echo("median, and where it lies with 95 % confidence; a wait is what a tick neither worked nor waited for a core")
    hour = report["hour"]
    click.echo(
        f"{hour['simulated_seconds']:g} s at 1 kHz: {hour['samples']} samples, {hour['bytes'] / 1e6:.1f} MB, made "
        f"in {hour['writing_seconds']:.0f} s, opened in {hour['opening_seconds']:.1f} s with {hour['viewer_bytes'] / 1e6:.0f} MB in the viewer"
    )
