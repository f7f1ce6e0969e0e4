# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a support that yields costs: times of the same stretch with and without ``support.elastic``, in alternating pairs.

``python test/benchmarks/support_cost.py``
"""

import time

import numpy as np

from bearing_sim import Simulation, load_scene

PAIRS = 20
STRETCHES = {"planar": 0.1, "spatial": 0.05}  # s of simulated time
VARIANTS = ((), ("support.elastic=true",))


def compare(level: str) -> np.ndarray:
    """Return the processor time of a step [s], shape (PAIRS, 2): without and with the support."""
    runs = [Simulation(load_scene("deng2017_table1", [f"level={level}", *overrides])) for overrides in VARIANTS]
    for run in runs:
        run.advance(0.05)
    found = np.zeros((PAIRS, 2))
    for pair in range(PAIRS):
        for which in (0, 1) if pair % 2 else (1, 0):
            steps, began = runs[which].counters.steps, time.process_time()
            runs[which].advance(STRETCHES[level], samples=50)
            found[pair, which] = (time.process_time() - began) / (runs[which].counters.steps - steps)
    return found


if __name__ == "__main__":
    for level in STRETCHES:
        times = compare(level)
        ratios = np.sort(times[:, 1] / times[:, 0])
        without, carried = 1e6 * np.median(times, axis=0)
        print(
            f"{level}: {without:.1f} us a step, {carried:.1f} us with a support: {np.median(ratios):.2f} times "
            f"({ratios[PAIRS // 4]:.2f} to {ratios[-PAIRS // 4]:.2f})"
        )
