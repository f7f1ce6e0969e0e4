# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim to-parquet``: a recording as one Parquet table."""

from pathlib import Path

import click

from bearing_sim.commands.exporting import export, with_excerpt


@click.command("to-parquet")
@with_excerpt
@click.option("-o", "--out", required=True, type=click.Path(path_type=Path, dir_okay=False), metavar="RUN.parquet", help="The table.")
def command(recording, out, columns, no_rollers, every, first, last, as_json):
    """Write the samples of RUN.mcap, a recording of bearing-sim or of the node, as a Parquet table.

    A row for each sample, a column for each observable and, where rollers have their own, one for each roller (inner_load_07). Units and
    meanings are in the metadata of the columns, the scene in that of the file; numbers are in SI.
    """
    export("parquet", recording, out, columns, no_rollers, every, first, last, as_json)
