# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What commands that run many points share: where they run, how far they are, where their tables go."""

from contextlib import ExitStack
from pathlib import Path

import click

from bearing_sim.commands.reporting import progress_bar


def executor_options(command):
    """Add the options that say where points are computed."""
    command = click.option("--dask", metavar="ADDRESS", help="Compute on this Dask cluster, such as tcp://10.0.0.1:8786.")(command)
    return click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Processes [default: all cores].")(command)


def table_option(default: str, beside: str):
    """Return the option that says where results go; ``beside`` completes its help: what there is besides the table."""
    kind = click.Path(path_type=Path)
    text = f"{beside} PATH.journal, from which it goes on after a kill."
    return click.option("-o", "--out", type=kind, default=Path(default), show_default=True, metavar="PATH.parquet", help=text)


class Points:
    """A bar for points, with the time to go, and the count of those computed and those kept from before; a context manager.

    Attributes
    ----------
    computed, kept : counts so far.
    """

    def __init__(self, text: str, total: int):
        self._text, self._total, self._stack = text, total, ExitStack()
        self._show = None
        self.computed, self.kept = 0, total

    def __enter__(self):
        return self

    def __exit__(self, *fault):
        return self._stack.__exit__(*fault)

    def tell(self, done: int, pending: int) -> None:
        """Take how many of the pending points are done, and how many there are."""
        self.computed, self.kept = done, self._total - pending
        if self._show is None:
            kept = f", {self.kept} more kept from before" if self.kept else ""
            self._show = self._stack.enter_context(progress_bar(f"{self._text}: {pending} points{kept}", max(pending, 1)))
        self._show(done)
