# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Put the response of the scene of the demonstration into the package, after a change of compiled code: ``python test/bundle_response.py``."""

import sys

from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.response_points import obtain_response
from bearing_sim.sweep.tasks import Execution
from bearing_sim.watchers.estimation.response import bundled_path, write_response

if __name__ == "__main__":
    scene = load_scene("deng2017_table1")
    target = bundled_path(scene)
    found = obtain_response(scene, Execution(progress=lambda done, total: print(f"\r{done} of {total} points", end="", flush=True)))
    if bundled_path(scene) != target:
        sys.exit("\ncompiled code has changed in the meantime; start again")
    for old in target.parent.glob("*.bands.npz"):
        old.unlink()
    write_response(target, found)
    print(f"\n{target}: {target.stat().st_size / 1e6:.1f} MB")
