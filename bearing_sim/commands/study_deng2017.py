# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study deng2017``: the results of the paper with this code."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import orderly_end, print_json, tell_compilation, told_as_bad_input, told_file_faults
from bearing_sim.commands.sweeping import Points, executor_options


@click.command()
@click.option("-o", "--out", type=click.Path(path_type=Path), default=Path("deng2017"), show_default=True, metavar="FOLDER", help="Where it goes.")
@click.option("--quick", is_flag=True, help="Few points and short runs, to see that everything works.")
@executor_options
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(out, quick, workers, dask, as_json):
    """Reproduce the figures of Deng 2017 at levels slip and planar, all parameters stock, and test its claims on the numbers.

    FOLDER gets tables (Parquet, CSV), figures and claims; `bearing-sim report FOLDER` makes a page of it.  A study that was stopped goes
    on where it was.
    """
    from bearing_sim.sweep.executor import ClusterError
    from bearing_sim.sweep.journal import JournalInUse

    tell_compilation()
    from bearing_sim.studies.deng2017_run import run_study

    points = Points("deng2017", 0)
    with told_file_faults(), orderly_end(), told_as_bad_input(ClusterError, JournalInUse), points:
        findings = run_study(out, quick, workers, dask, points.tell)
    if as_json:
        print_json({"folder": str(out), "computed": points.computed, "claims": [finding._asdict() for finding in findings]})
        return
    for finding in findings:
        click.echo(f"{finding.claim} at level {finding.level}: {finding.verdict}" if finding.claim else f"contours: {finding.verdict}")
        for name in ("gives", "off", "why"):
            if getattr(finding, name):
                click.echo(f"    {name}: {getattr(finding, name)}")
    click.echo(f"{points.computed} points computed; {out}; bearing-sim report {out} makes a page of it")
