# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bearing that studies vary, by overrides of its fields."""

from bearing_sim.scene_file import SceneError, load_scene

BEARING = "deng2017_table1"
"""Its scene's name."""


def takes(level: str, override: str) -> bool:
    """Return whether its scene at a level may have a field overridden."""
    try:
        load_scene(BEARING, [f"level={level}", override])
    except SceneError:
        return False
    return True
