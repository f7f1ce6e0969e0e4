# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim bench``: benchmarks by name, each a command of its own."""

import click

from bearing_sim.commands.lazy_group import LazyGroup

_BENCHMARKS = {
    "levels": "Speed and error of every level and integration method, and what bounds them.",
    "recording": "What recording all observables costs a live run.",
    "view": "What a live view costs the solver whatever viewers do, and how an hour opens.",
    "fleet": "How many bearings one core holds in real time.",
}


@click.group(cls=LazyGroup, told=_BENCHMARKS, within="bearing_sim.commands.bench_", heading="Benchmarks")
def command():
    """Measure how fast the model is, and what recordings, views and many bearings cost."""
