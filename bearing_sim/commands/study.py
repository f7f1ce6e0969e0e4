# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study``: studies by name, each a command of its own."""

import click

from bearing_sim.commands.lazy_group import LazyGroup

_STUDIES = {
    "deng2017": "The results of Deng 2017 with this code, claim by claim.",
    "damage": "The damage of a measured course by levels, side by side.",
    "misalignment": "Edges, tilts, skews and life over the misalignment of the inner ring.",
    "situations": "Pictures of six situations, from start to fault, in rerun.",
    "slices": "How results settle with the number of slices, and what slices and rollers cost.",
    "extremes": "Map where the model finishes, is clamped, refuses or fails.",
    "kills": "How much a killed recorder loses.",
}


@click.group(cls=LazyGroup, told=_STUDIES, within="bearing_sim.commands.study_", heading="Studies")
def command():
    """Run one of the studies of the model itself."""
