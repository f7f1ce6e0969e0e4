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
        report = run_view_bench(0.5 if quick else 15.0, min(frozen, 0.5) if quick else frozen, tell)
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

    table = Table(title=f"the solver with a live view, 1000 samples a second; load average {report['load_average']:.2f}", title_justify="left")
    columns = ("while", "x real time", "rate to none", "work to none", "worst tick [ms]", "worst wait [ms]", "99.9 % [ms]", "dropped")
    for name in columns:
        table.add_column(name, justify="left" if name == "while" else "right")
    for row in report["stretches"]:
        times = (f"{1e3 * row[name]:.2f}" for name in ("worst_tick", "worst_wait", "late_wait"))
        table.add_row(row["name"], f"{row['wall_rate']:.2f}", f"{row['rate_ratio']:.3f}", f"{row['work_ratio']:.3f}", *times, str(row["dropped"]))
    Console(width=None if sys.stdout.isatty() else 150).print(table)
    click.echo("rates for the time in which a core was to be had; a wait is what a tick neither worked nor waited for a core")
    hour = report["hour"]
    click.echo(
        f"{hour['simulated_seconds']:g} s at 1 kHz: {hour['samples']} samples, {hour['bytes'] / 1e6:.1f} MB, made "
        f"in {hour['writing_seconds']:.0f} s, opened in {hour['opening_seconds']:.1f} s with {hour['viewer_bytes'] / 1e6:.0f} MB in the viewer"
    )
