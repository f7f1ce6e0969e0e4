# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How long a fresh process takes until it has advanced."""

import json
import os
import subprocess
import sys
import tempfile

_SCRIPT = """
import json, sys, time
began = time.perf_counter()
from bearing_sim import Simulation, load_scene
imported = time.perf_counter()
scene = load_scene(sys.argv[1], ["level=" + sys.argv[2]])
read = time.perf_counter()
run = Simulation(scene)
run.advance(1e-4)
advanced = time.perf_counter()
run.advance(1e-4)
print(json.dumps({"import_seconds": imported - began, "scene_seconds": read - imported, "first_advance_seconds": advanced - read,
    "second_advance_seconds": time.perf_counter() - advanced}))
"""


def start_up(bearing: str, level: str, cold: bool) -> dict[str, float]:
    """Return times [s] of importing, reading a scene, and the first and second 0.1 ms, in a fresh process.

    Parameters
    ----------
    bearing, level : scene and level.
    cold : with an empty cache of machine code, so that the first advance compiles everything; else it has run before.
    """
    with tempfile.TemporaryDirectory() as empty:
        environment = {**os.environ, "XDG_CACHE_HOME": empty} if cold else dict(os.environ)
        found = subprocess.run([sys.executable, "-c", _SCRIPT, bearing, level], capture_output=True, text=True, check=True, env=environment)
    return json.loads(found.stdout)
