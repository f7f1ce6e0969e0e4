# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim report``: a study's folder as one page."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import told_as_bad_input, told_file_faults


@click.command()
@click.argument("folder", type=click.Path(path_type=Path))
@click.option("-o", "--out", type=click.Path(path_type=Path), metavar="PATH.html", help="The page [default: report.html in FOLDER].")
def command(folder, out):
    """Make one HTML page of what `bearing-sim study deng2017` left in FOLDER: claims, figures, settings, versions.

    The page holds everything it shows; it needs no network and no other file.
    """
    from bearing_sim.studies.report_page import NoStudy, write_page

    out = out or folder / "report.html"
    with told_as_bad_input(NoStudy), told_file_faults():
        write_page(folder, out)
    click.echo(f"{out}: {out.stat().st_size / 1e6:.1f} MB")
