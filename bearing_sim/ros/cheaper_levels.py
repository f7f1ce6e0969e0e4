# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Compile the levels that a governor may need in a process of their own, so that the model that runs meanwhile is not disturbed."""

import subprocess
import sys

from bearing_sim import effects
from bearing_sim.kernels.compilation import CACHE_FOLDER
from bearing_sim.scene import Scene
from bearing_sim.scene_file import scene_to_yaml
from bearing_sim.sinks.priority import giving_way

_PROGRAM = """
import sys
from bearing_sim.runtime.live import governor_of
from bearing_sim.scene_file import scene_from_yaml
from bearing_sim.simulation import Simulation
governor_of(Simulation(scene_from_yaml(sys.stdin.read())))
"""
_NICENESS = 10  # what runs now comes first; not idle time: where the solver takes all there is, the cheaper levels are wanted most


def levels_to_compile(scene: Scene) -> list[str]:
    """Return the levels below a scene's own whose code has not been compiled yet for this version."""
    return [level for level in effects.cheaper_levels(scene) if not any(CACHE_FOLDER.rglob(f"{level}.advance-*.nbi"))]


def start_compiling(scene: Scene) -> subprocess.Popen:
    """Start a process that compiles all levels below a scene's own and ends."""
    process = subprocess.Popen(
        giving_way([sys.executable, "-c", _PROGRAM], _NICENESS),
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    process.stdin.write(scene_to_yaml(scene))
    process.stdin.close()
    return process
