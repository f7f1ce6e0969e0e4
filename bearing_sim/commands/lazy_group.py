# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A group of commands of which each is imported only when it is called, so that ``--help`` stays fast (click's lazy-group pattern)."""

import importlib
from collections.abc import Mapping

import click


class LazyGroup(click.Group):
    """A group whose commands live in modules of their own, each with a ``command``.

    Parameters
    ----------
    told : what each command does, by its name, in the order in which they are listed.
    within : what a command's name, its hyphens turned into underscores, stands behind in the name of its module.
    heading : of the list of commands.
    """

    def __init__(self, *args, told: Mapping[str, str], within: str, heading: str, **options):
        super().__init__(*args, **options)
        self._told, self._within, self._heading = told, within, heading

    def list_commands(self, context):
        """Return the names in their order."""
        return list(self._told)

    def get_command(self, context, name):
        """Return a command by its name, None where there is none."""
        return importlib.import_module(self._within + name.replace("-", "_")).command if name in self._told else None

    def format_commands(self, context, formatter):
        """Write the list of commands without importing any."""
        with formatter.section(self._heading):
            formatter.write_dl(list(self._told.items()))
