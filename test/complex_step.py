# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Derivatives of the plain NumPy models by complex steps, and how a level's own are held against them."""

import numpy as np

_STEP = 1e-30  # nothing is subtracted, so no step is too small


def complex_step_jacobian(rate, state):
    """Return d rate / d state of ``rate(state)``, shape (states, states)."""
    matrix = np.zeros((state.size, state.size))
    for i in range(state.size):
        shifted = state.astype(complex)
        shifted[i] += _STEP * 1j
        matrix[:, i] = rate(shifted).imag / _STEP
    return matrix


def assert_blocks_agree(found, expected, kinds):
    """Compare Jacobians block by block: each of one kind of rate by one kind of state has a unit, and so a largest entry, of its own."""
    round_off = np.abs(expected).max(1)  # some blocks are sums, over rollers or slices, that vanish
    for row in np.unique(kinds):
        for column in np.unique(kinds):
            block = np.ix_(kinds == row, kinds == column)
            largest = np.abs(expected[block]).max() + 1e-9 * round_off[kinds == row].min()
            error = np.abs(found - expected)[block].max()
            assert error <= 1e-6 * largest, (row, column, error, largest)
