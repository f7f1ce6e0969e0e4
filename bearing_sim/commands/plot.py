# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim plot``: the picture of a sweep's table."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import picture_option, told_as_bad_input, told_file_faults


@click.command()
@click.argument("path", metavar="TABLE.parquet", type=click.Path(path_type=Path))
@picture_option("Draw the results")
@click.option("--quantity", "quantities", multiple=True, metavar="COLUMN", help="Draw this column; may be repeated [default: slip, life, loads].")
def command(path, picture, quantities):
    """Draw a sweep: lines over one variable, maps over two; into TABLE.png unless --picture says otherwise."""
    from bearing_sim.sweep.picture import QUANTITIES, NotDrawable, draw
    from bearing_sim.sweep.table import read_table

    picture = picture or path.with_suffix(".png")
    with told_file_faults(), told_as_bad_input(NotDrawable, ValueError):
        draw(picture, read_table(path), quantities or QUANTITIES)
    click.echo(str(picture))
