# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What commands share in talking to people and to programs: faults, JSON, tables, progress."""

import errno
import json
import math
import signal
import sys
import threading
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import click

_PICTURES = (".png", ".svg", ".pdf")


class BadInput(click.ClickException):
    """The caller gave something that cannot be used: one message, exit code 2."""

    exit_code = 2


class FailedRun(click.ClickException):
    """A run that did not come to its end: one message, exit code 1."""

    exit_code = 1


@contextmanager
def told_as_bad_input(*kinds: type[Exception]) -> Iterator[None]:
    """Turn exceptions of these kinds into one message and exit code 2."""
    try:
        yield
    except kinds as fault:
        raise BadInput(str(fault)) from None


@contextmanager
def told_file_faults() -> Iterator[None]:
    """Turn a file that cannot be opened into exit code 2, and a disk that fails or fills up during a run into exit code 1."""
    try:
        yield
    except OSError as fault:
        failed = fault.errno in (errno.ENOSPC, errno.EIO, errno.EDQUOT, errno.EFBIG)
        raise (FailedRun if failed else BadInput)(str(fault)) from None


@contextmanager
def orderly_end() -> Iterator[None]:
    """Make SIGTERM unwind the program as Ctrl-C does, so that recordings are finished; exit code 143."""
    if threading.current_thread() is not threading.main_thread():  # only the main thread may set handlers
        yield
        return
    before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def require_levels(levels: Iterable[str]) -> None:
    """Refuse what is no level of fidelity."""
    from bearing_sim.effects import LEVELS

    for level in levels:
        if level not in LEVELS:
            raise BadInput(f"--level {level}: expected one of {', '.join(LEVELS)}")


def picture_option(drawn: str) -> Callable:
    """Return the option ``--picture``, which takes a path of a kind that can be drawn; ``drawn`` says what, as in "Draw the map"."""

    def checked(context, parameter, path):
        if path is not None and path.suffix.lower() not in _PICTURES:
            raise BadInput(f"--{parameter.name} {path}: expected a name that ends in {', '.join(_PICTURES)}")
        return path

    kind = click.Path(path_type=Path)
    return click.option(
        "--picture", type=kind, callback=checked, metavar="PATH.png", help=f"{drawn} ({', '.join(_PICTURES[:-1])} or {_PICTURES[-1]})."
    )


def tell_compilation() -> None:
    """Say on stderr that compiling will take a while, where this version of the model has not run here yet."""
    from bearing_sim.kernels.compilation import CACHE_FOLDER

    if not any(CACHE_FOLDER.rglob("*.nbi")):
        click.echo("compiling the model, once for this version: about 20 s ...", err=True)


def tell_replacement(out: Path) -> None:
    """Say on stderr that a finished file will be replaced."""
    if out.is_file():
        click.echo(f"{out} exists and is replaced when the new one is complete", err=True)


def tell_cheaper_level(scene) -> None:
    """Say on stderr where a cheaper level computes the same."""
    from bearing_sim.effects import hint

    if line := hint(scene):
        click.echo(line, err=True)


def print_json(report: Mapping) -> None:
    """Print one JSON object and nothing else; NaN and infinity become null."""
    click.echo(json.dumps(_finite(report), indent=2, allow_nan=False))


def _finite(value):
    if isinstance(value, Mapping):
        return {str(key): _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def print_table(title: str, rows: Iterable[tuple[str, str]]) -> None:
    """Print names and values in two columns."""
    from rich.table import Table

    table = Table("", "", title=title, show_header=False, title_justify="left")
    for name, value in rows:
        table.add_row(name, value)
    _show(table)


def print_rows(
    title: str, columns: Sequence[str], rows: Iterable[Sequence[str]], words: Container[str] = (), width: int = 150, whole: Container[str] = ()
) -> None:
    """Print rows under headings, numbers flushed right.

    Parameters
    ----------
    title : above the table.
    columns : headings.
    rows : texts, as many as there are columns.
    words : columns that are flushed left.
    width : of the table where there is no terminal.
    whole : columns whose texts are never broken over lines.
    """
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for name in columns:
        table.add_column(name, justify="left" if name in words else "right", no_wrap=name in whole)
    for row in rows:
        table.add_row(*row)
    _show(table, width)


def _show(table, width: int = 150) -> None:
    from rich.console import Console

    # A unit in brackets is a unit, no mark-up.
    Console(width=None if sys.stdout.isatty() else width, markup=False, emoji=False).print(table)


@contextmanager
def progress_bar(text: str, total: float) -> Iterator[Callable[[float], None]]:
    """Show a bar with the time to go on stderr, on a terminal only; yields the function that takes what is done of ``total``."""
    if not sys.stderr.isatty():
        yield lambda done: None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TextColumn("to go"), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(text, total=total)
        yield lambda done: bar.update(task, completed=done)
