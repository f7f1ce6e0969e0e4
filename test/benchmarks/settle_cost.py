# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What `settle` costs in an optimiser: the load of 2 % slip by `scipy.optimize.brentq`, from ideal rolling and from the point before.

python test/benchmarks/settle_cost.py
"""

import time

from scipy.optimize import brentq

from bearing_sim import load_scene, settle

MOTOR = {
    "name": "NU 210/C3",
    "bearing": "NU 210/C3",
    "lubricant": {"oil": "ISO VG 68", "temperature": "70 degC", "supply": "oil_bath"},
    "operating": {"shaft_speed": "3000 rpm", "radial_load": "5 kN"},
}
SLIP = 0.02


def find_load(scene, level, warm, low, high):
    """Return the load of 2 % slip [N], how often slip was computed, and the seconds that took, on the clock and of the processor."""
    before, calls = None, 0

    def excess(load):
        nonlocal before, calls
        result, calls = settle(scene, level, radial_load=load, start=before), calls + 1
        before = result if warm else None
        return result.cage_slip - SLIP

    excess(high)
    began, busy, calls = time.perf_counter(), time.process_time(), 0
    load = brentq(excess, low, high, xtol=0.5)
    return load, calls, time.perf_counter() - began, time.process_time() - busy


def main():
    """Print a line for each scene, level and kind of start."""
    motor = load_scene(MOTOR)
    scenes = {
        "NU 210/C3, ISO VG 68": (motor, 50.0, 5000.0),
        "the same with a thermal network": (load_scene(motor, ["heat.law=network"]), 50.0, 5000.0),
        "deng2017_table1": (load_scene("deng2017_table1"), 50.0, 40_000.0),
    }
    for name, (scene, low, high) in scenes.items():
        for level in ("steady", "slip"):
            for warm in (False, True):
                load, calls, seconds, busy = find_load(scene, level, warm, low, high)
                kind = "from the point before" if warm else "from ideal rolling"
                cost = f"{seconds:.3f} s, {busy:.3f} s of the processor, {1e3 * busy / calls:.1f} ms each"
                print(f"{name}, {level}, {kind}: {load:.1f} N, {calls} points, {cost}", flush=True)


if __name__ == "__main__":
    main()
