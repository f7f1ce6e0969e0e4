# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Between a state, where each quantity of all rollers is one run of numbers, and lanes."""

from bearing_sim.kernels.compilation import template
from bearing_sim.kernels.lanes import LANES


@template
def spread_runs(x, first, runs, count, rows):
    """Copy runs of ``count`` numbers into the first rows of all blocks, and leave lanes without a roller as they are.

    Parameters
    ----------
    x : numbers, the runs one after the other from ``first`` on.
    runs, count : how many runs, and numbers in each.
    rows : see `bearing_sim.kernels.lanes.new_rows`.
    """
    for k in range(runs):
        start = first + k * count
        for j in range(count):
            rows[j // LANES, k, j % LANES] = x[start + j]


@template
def fill_lanes(rows, runs, count):
    """Let lanes without a roller go with the last roller in the first ``runs`` rows, to stay finite."""
    last = count - 1
    for k in range(runs):
        for j in range(count, rows.shape[0] * LANES):
            rows[j // LANES, k, j % LANES] = rows[last // LANES, k, last % LANES]


@template
def collect_runs(rows, row, runs, count, x, first):
    """Copy rows from ``row`` on back into runs from ``first`` on; parameters as of `spread_runs`."""
    for k in range(runs):
        start = first + k * count
        for j in range(count):
            x[start + j] = rows[j // LANES, row + k, j % LANES]
