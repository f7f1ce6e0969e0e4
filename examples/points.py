# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the examples have in common that run a scene at several points: options, and the table, the JSON and the picture of their results."""

import click
from click import Choice, FloatRange

from bearing_sim.cli.options import allow_outside_option, csv_option, json_option, option, picture_option, set_option, together
from bearing_sim.cli.reporting import print_rows
from bearing_sim.cli.results import Result
from bearing_sim.scene.display import number

varied_scene = together(csv_option("Write the results to a table."), picture_option("Draw the results"), json_option)
scene_or_paper = together(allow_outside_option, click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1"), set_option)
vibrating_level = option("--level", "Level with vibration.", Choice(["planar", "spatial"]), default="planar")


def speed_option(name: str, parameter: str, which: str, default: float | None = None, otherwise: str = ""):
    """Return the option for an end of a range of shaft speeds."""
    return option(name, parameter, f"{which} shaft speed{otherwise}.", FloatRange(1.0), default=default, metavar="RPM")


def over_points(title, columns, rows, plot, about, shown=None, words=None, remarks=()) -> Result:
    """Return the result of a study whose rows have the columns of its table, the first of them in words; ``shown`` are its cells if others."""
    texts = [[cell if isinstance(cell, str) else number(cell) for cell in cells] for cells in shown or (row.values() for row in rows)]
    return Result({**about, "points": rows}, lambda: print_rows(title, columns, texts, words or columns[:1]), plot, rows, remarks)
