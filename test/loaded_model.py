# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Imported ahead for nodes: the compiled code of the bundled scene, of its own level and of those below it."""

from bearing_sim.runtime.live import governor_of, warmed_up
from bearing_sim.scene.loader import load_scene

governor_of(warmed_up(load_scene("deng2017_table1")))
