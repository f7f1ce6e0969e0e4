# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim compile``: compile levels ahead of their first run."""

import time

import click

from bearing_sim.commands.reporting import progress_bar, require_levels


@click.command()
@click.option("--level", "levels", multiple=True, metavar="LEVEL", help="Compile this level; may be repeated [default: all].")
@click.option("--every-method", is_flag=True, help="Also the methods that a scene must ask for (integration.method, integration.fixed_step).")
@click.option("--workers", type=click.IntRange(min=1), metavar="N", help="Processes at once [default: one for each core].")
@click.option("--prune", is_flag=True, help="Then remove what other versions of bearing_sim have compiled.")
def command(levels, every_method, workers, prune):
    """Compile levels now instead of when they first run, side by side on all cores.

    What is compiled stays on disk, for this version of the model and this user; what is there already is only looked at.
    """
    from bearing_sim.levels.level import LEVELS
    from bearing_sim.precompilation import builds, compile_all, remove_other_versions

    require_levels(levels)
    wanted, began = builds(levels or tuple(LEVELS), every_method), time.monotonic()
    with progress_bar("compiling", len(wanted)) as tell:
        for done, build in enumerate(compile_all(wanted, workers), 1):
            click.echo(f"{build}: compiled ({time.monotonic() - began:.0f} s)", err=True)
            tell(done)
    if prune:
        click.echo(f"{remove_other_versions() / 1e6:.0f} MB of other versions removed", err=True)
