# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study``: studies by name, each a command of its own."""

import importlib

import click

_STUDIES = {
    "deng2017": "The results of Deng 2017 with this code, claim by claim.",
    "damage": "The damage of a measured course by levels, side by side.",
    "misalignment": "Edges, tilts, skews and life over the misalignment of the inner ring.",
    "situations": "Pictures of six situations, from start to fault, in rerun.",
    "slices": "How results settle with the number of slices, and what slices and rollers cost.",
    "extremes": "Map where the model finishes, is clamped, refuses or fails.",
    "kills": "How much a killed recorder loses.",
}


class _LazyStudies(click.Group):
    def list_commands(self, context):
        return list(_STUDIES)

    def get_command(self, context, name):
        return importlib.import_module(f"bearing_sim.commands.study_{name}").command if name in _STUDIES else None

    def format_commands(self, context, formatter):
        with formatter.section("Studies"):
            formatter.write_dl(list(_STUDIES.items()))


@click.group(cls=_LazyStudies)
def command():
    """Run one of the studies of the model itself."""
