# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim report``: one HTML page of any result."""

from pathlib import Path

import click

from bearing_sim.cli.outputs import OutputFile, WritingCommand, default_output
from bearing_sim.cli.reporting import as_file_error, as_usage_error


@click.command("report", cls=WritingCommand)
@click.argument("source", type=click.Path(path_type=Path), metavar="RESULT")
@click.option("-o", "--out", type=OutputFile(), metavar="PATH.html", help="The page [default: RESULT.html, or report.html in a folder].")
def report(source, out):
    """Make one HTML page of RESULT: scene and bearing, tables, pictures, warnings, where it comes from, and the command that made it.

    RESULT is a table written by `sweep`, `design` or `study` (.parquet, or the .csv beside it), a recording written by `run` or `replay`
    (.mcap, or a bag's folder), a folder of such files, or the folder of `bearing-sim study deng2017`. The page is self-contained: it
    needs no network and no other file.
    """
    from bearing_sim.studies.page import NoResults
    from bearing_sim.studies.report_page import page_of

    out = out or default_output(source / "report.html" if source.is_dir() else source.with_suffix(".html"))
    with as_usage_error(NoResults), as_file_error():
        page = page_of(source)
        out.write_text(page)
    click.echo(f"{out}: {len(page.encode()) / 1e6:.1f} MB")
