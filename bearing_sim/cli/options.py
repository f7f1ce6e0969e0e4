# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Options and arguments that several commands have."""

from collections.abc import Callable
from pathlib import Path

import click

from bearing_sim.cli.reporting import UsageError
from bearing_sim.scene.fidelity import LEVELS

PICTURES = (".png", ".svg", ".pdf")

level_type = click.Choice(LEVELS)
scene_argument = click.argument("scene_name", metavar="SCENE")
set_option = click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; can be repeated.")
json_option = click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
quick_option = click.option("--quick", is_flag=True, help="Measure almost nothing, to check that everything works.")


def executor_options(command: Callable) -> Callable:
    """Add the options that choose where points are computed."""
    command = click.option("--dask", metavar="ADDRESS", help="Compute on this Dask cluster, such as tcp://10.0.0.1:8786.")(command)
    return click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")(command)


def table_option(default: str, beside: str) -> Callable:
    """Return the option for the output path of many points; ``beside`` is the part of its help that names the files."""
    kind = click.Path(path_type=Path)
    text = f"{beside} PATH.journal, from which an interrupted run resumes."
    return click.option("-o", "--out", type=kind, default=Path(default), show_default=True, metavar="PATH.parquet", help=text)


def picture_option(drawn: str, *names: str) -> Callable:
    """Return the option for the path of a picture with a known suffix, ``--picture`` after other names for it.

    Parameters
    ----------
    drawn : what it draws, as in "Draw the map".
    names : other names, such as ``-o``.
    """

    def checked(context, parameter, path):
        if path is not None and path.suffix.lower() not in PICTURES:
            raise UsageError(f"{max(parameter.opts[:2], key=len)} {path}: expected a name that ends in {', '.join(PICTURES)}")
        return path

    kind, text = click.Path(path_type=Path), f"{drawn} ({', '.join(PICTURES[:-1])} or {PICTURES[-1]})."
    return click.option(*names, "--picture", "picture", type=kind, callback=checked, metavar="PATH.png", help=text)
