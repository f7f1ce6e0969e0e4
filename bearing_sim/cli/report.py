# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim report``: one page of any result."""

from pathlib import Path

import click

from bearing_sim.cli.options import option
from bearing_sim.cli.outputs import OutputFile, default_output
from bearing_sim.cli.reporting import UsageError, tell_use
from bearing_sim.cli.results import Result, command


@command("report")
@click.argument("source", metavar="RESULT")
@option("-o", "--out", "The page [default: RESULT.html, or report.html in a folder].", OutputFile(".html", ".htm"), metavar="PATH.html")
def report(source, out):
    """Make one page of RESULT: scene and bearing, tables, pictures, warnings, where it comes from, and the command that made it.

    RESULT is a table written by `sweep`, `design` or `study` (.parquet, or the .csv beside it), a recording written by `run` or `replay`
    (.mcap, or a bag's folder), or a folder of such files. The page is self-contained: it
    needs no network and no other file.
    """
    from bearing_sim.studies.report_page import page_of

    result = Path(source)
    if source == "validation" and not result.exists():
        raise UsageError("report validation is no longer part of the program; from a checkout of the repository: python test/validation report")
    out = out or default_output(result / "report.html" if result.is_dir() else result.with_suffix(".html"))
    page = page_of(result, tell_use)
    out.write_text(page)
    return Result({}, remarks=[f"{out}: {len(page.encode()) / 1e6:.1f} MB"])
