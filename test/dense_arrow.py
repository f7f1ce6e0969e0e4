# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The whole Jacobian that a level has written as a block arrow."""

import numpy as np

from bearing_sim.numerics.simd import LANES


def dense_arrow(layout, work, count):
    """Return d rate / d state of ``count`` rollers and the border, without a support, shape (states, states).

    Parameters
    ----------
    layout : `bearing_sim.numerics.block_arrow.Layout`.
    work : of the level, whose derivatives have been written.
    """
    border, states, positions = layout.border, 2 * layout.border, layout.positions
    matrix = np.zeros((states + layout.block * count,) * 2)
    matrix[:border, border:states], matrix[border:states, :states] = np.eye(border), work.global_block
    bodies = [np.flatnonzero(layout.body == body) for body in np.unique(layout.body)]
    seen = [np.concatenate([body, border + body]) for body in bodies]  # positions and speeds, body by body
    for j in range(count):
        own, slopes = states + j + count * np.arange(layout.block), work.jacobian[j // LANES, :, j % LANES]
        matrix[own[:positions], own[positions : 2 * positions]] = 1.0
        first = layout.speeds * layout.local
        matrix[own[positions:, None], np.concatenate([own, *seen])] = slopes[:first].reshape(layout.speeds, layout.local)
        for body, variables in zip(bodies, seen):
            rows = slopes[first : first + len(body) * (layout.block + len(variables))].reshape(len(body), -1)
            first += rows.size
            matrix[border + body[:, None], own] = rows[:, : layout.block]
            matrix[border + body[:, None], variables] += rows[:, layout.block :]
        assert first == layout.rows
    return matrix
