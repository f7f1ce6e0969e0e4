# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim scenes``: what is bundled."""

import click

from bearing_sim.commands.reporting import print_json, print_table


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(as_json):
    """List the bundled scenes, bearings, oils and mappings."""
    from bearing_sim.scene_file import catalog_names, load_scene, scene_names

    found = {"scenes": {name: load_scene(name).description for name in scene_names()}}
    found |= {kind: catalog_names(kind) for kind in ("bearings", "oils", "mappings")}
    if as_json:
        print_json(found)
        return
    print_table("scenes", found["scenes"].items())
    print_table("catalog", [(kind, ", ".join(found[kind])) for kind in ("bearings", "oils", "mappings")])
