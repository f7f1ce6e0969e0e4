# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim to-csv``: a recording as one CSV table."""

from pathlib import Path

import click

from bearing_sim.commands.exporting import export, with_excerpt


@click.command("to-csv")
@with_excerpt
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path, dir_okay=False), metavar="RUN.csv", help="The table.")
def command(recording, out, columns, no_rollers, every, first, last, as_json):
    """Write the samples of RUN.mcap, a recording of bearing-sim or of the node, as a CSV table.

    A row for each sample, a column for each observable and, where rollers have their own, one for each roller (inner_load_07). Units stand
    in the header, numbers in SI.
    """
    export("csv", recording, out, columns, no_rollers, every, first, last, as_json)
