# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Reproduce the figures of Deng et al. 2017 and judge its claims: ``python examples/deng2017 -o FOLDER``, from a checkout."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "examples")]

import click  # noqa: E402

from bearing_sim.cli.options import executor_options, json_option, set_option  # noqa: E402
from bearing_sim.cli.outputs import OutputFolder  # noqa: E402
from bearing_sim.cli.reporting import Points, announce_compilation, as_ending, print_json  # noqa: E402
from bearing_sim.cli.results import Command  # noqa: E402


@click.command("deng2017", cls=Command)
@click.option("-o", "--out", type=OutputFolder(), default="deng2017", show_default=True, metavar="FOLDER", help="Output folder.")
@set_option
@click.option("--quick", is_flag=True, help="Few points and short runs, to check that everything works.")
@executor_options
@json_option
def deng2017(out, overrides, quick, workers, dask, as_json):
    """Reproduce the figures of Deng 2017 at levels slip and planar, with the parameters of the paper, and check its claims.

    Writes tables (Parquet, CSV), figures, claims and a page of them, report.html, to FOLDER.  An interrupted study
    resumes where it stopped.  With --set every scene of the study departs from the paper, for example by a support.
    """
    announce_compilation()
    from deng2017.page import study_page
    from deng2017.run import require_same_study, run_study

    points = Points("deng2017", 0)
    with as_ending(), points:
        require_same_study(out, quick, overrides)
        findings = run_study(out.path, quick, workers, dask, points.update, overrides)
        (out.path / "report.html").write_text(study_page(out.path))
    if as_json:
        print_json({"folder": str(out), "computed": points.computed, "claims": [finding._asdict() for finding in findings]})
        return
    for finding in findings:
        click.echo(f"{finding.claim} at level {finding.level}: {finding.verdict}" if finding.claim else f"contours: {finding.verdict}")
        for name in ("gives", "off", "why"):
            if getattr(finding, name):
                click.echo(f"    {name}: {getattr(finding, name)}")
    click.echo(f"{points.computed} points computed; {out}/report.html")


if __name__ == "__main__":
    deng2017()
