# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What ``bearing-sim to-csv`` and ``to-parquet`` share."""

from collections.abc import Callable
from pathlib import Path

import click

from bearing_sim.commands.reporting import print_json, progress_bar, told_as_bad_input, told_file_faults


def with_excerpt(command: Callable) -> Callable:
    """Give a command the options that choose what of a recording goes into a table."""
    for option in (
        click.option("--json", "as_json", is_flag=True, help="Print one JSON object."),
        click.option("--to", "last", type=float, metavar="S", help="Last simulated time [default: the end]."),
        click.option("--from", "first", type=float, metavar="S", help="First simulated time [default: the beginning]."),
        click.option("--every", type=click.IntRange(min=1), default=1, show_default=True, metavar="N", help="Take one sample of N."),
        click.option("--no-rollers", is_flag=True, help="Leave out what is recorded for each roller."),
        click.option("--column", "columns", multiple=True, metavar="NAME", help="Take this observable; may be repeated [default: all]."),
        click.argument("recording", type=click.Path(path_type=Path), metavar="RUN.mcap"),
    ):
        command = option(command)
    return command


def export(kind: str, recording: Path, out: Path, columns, no_rollers, every, first, last, as_json) -> None:
    """Write a recording as a table of a kind, ``csv`` or ``parquet``, and say so."""
    from bearing_sim.recording_reader import Recording, RecordingError
    from bearing_sim.recording_table import Excerpt, TableError, write_csv, write_parquet

    write = {"csv": write_csv, "parquet": write_parquet}[kind]
    infinity = float("inf")
    excerpt = Excerpt(tuple(columns), not no_rollers, every, -infinity if first is None else first, infinity if last is None else last)
    with told_as_bad_input(RecordingError, TableError), told_file_faults():
        source = Recording(recording)
        with progress_bar(f"writing {out.name}", source.duration) as progress:
            rows = write(source, out, excerpt, progress)
    if source.unfinished:
        click.echo(f"{recording}: {source.unfinished}", err=True)
    if as_json:
        print_json({"recording": str(recording), "out": str(out), "rows": rows, "size": out.stat().st_size})
    else:
        click.echo(f"{out}: {rows} samples, {out.stat().st_size / 1e6:.4g} MB")
