# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Block-arrow algebra of the spatial level: a 5x5 block for each roller and one 9x9 border; ``LANES`` rollers at a time.

(I - s J) x = b for the whole first-order state, reduced to speeds: every position is x = b + s v.  Cost O(Z).

Derivatives through a roller, rows of an array of `bearing_sim.kernels.lanes.new_rows`: those of its r'', phi'', tilt'', skew'', w' by
its own nine variables and the border's 18 first; then those of the ring's four accelerations by its own nine and the ring's eight,
for the ring does not feel the cage; then those of the cage's five by its own nine and the cage's ten.
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.dense import back_substitute, decompose
from bearing_sim.kernels.lanes import LANES, load, magnitude, new_rows, store, total, where_positive
from bearing_sim.kernels.runs import collect_runs, spread_runs

RING, CAGE = 4, 5
BORDER = RING + CAGE  # positions of ring and cage, and as many speeds
BLOCK = 9  # states of a roller: four positions, their speeds, and the spin
_SPEEDS, _POSITIONS = 5, 4
AT_RING, AT_RING_SPEEDS = BLOCK, BLOCK + RING  # where border positions and speeds stand among what a roller depends on
AT_CAGE = BLOCK + 2 * RING
AT_CAGE_SPEEDS = AT_CAGE + CAGE
LOCAL = AT_CAGE + 2 * CAGE
RING_COLUMNS, CAGE_COLUMNS = BLOCK + 2 * RING, BLOCK + 2 * CAGE
RING_ROWS = _SPEEDS * LOCAL  # where the rows of the ring and the cage begin
CAGE_ROWS = RING_ROWS + RING * RING_COLUMNS
SLOPES = CAGE_ROWS + CAGE * CAGE_COLUMNS
_RIGHT = _SPEEDS * _SPEEDS  # rows of a factorisation
_BELOW = _RIGHT + _SPEEDS * BORDER
_FACTORED = _BELOW + BORDER * _SPEEDS


class Factored(NamedTuple):
    """A factorisation of I - s J."""

    shift: np.ndarray  # s, shape (1,)
    rows: np.ndarray  # by roller: inverse block (5x5), that times its coupling to the border's speeds (5x9), the border's to it (9x5)
    right: np.ndarray  # right sides by roller: four positions and five speeds
    positions: np.ndarray  # d(border accelerations)/d(border positions), all rollers together, shape (9, 9)
    schur: np.ndarray  # factors of the Schur complement, shape (9, 9)
    order: np.ndarray  # its pivots, int64, shape (9,)
    block: np.ndarray  # scratch, shape (1, 25, LANES)


def new_factored(count):
    """Return a zeroed factorisation for ``count`` rollers."""
    square = (BORDER, BORDER)
    return Factored(
        np.zeros(1),
        new_rows(_FACTORED, count),
        new_rows(BLOCK, count),
        np.zeros(square),
        np.zeros(square),
        np.zeros(BORDER, np.int64),
        np.zeros((1, _SPEEDS * _SPEEDS, LANES)),
    )


@template
def _shifted(slopes, block, position, speed, s):
    """Return s (d/d(speed) + s d/d(position)): what a speed does within an implicit step."""
    return s * (load(slopes, block, speed) + s * load(slopes, block, position))


@kernel
def _own(slopes, block, first, k, s):
    """Return what a roller's own k-th speed does to a row within an implicit step."""
    if k == _POSITIONS:
        return s * load(slopes, block, first + 2 * _POSITIONS)
    return _shifted(slopes, block, first + k, first + _POSITIONS + k, s)


@kernel
def _invert_blocks(block, slopes, s, rows, matrix):
    """Invert I - s (dv'/dv + s dv'/dq) of a block of rollers; return whether all are regular.

    Gauss and Jordan without pivoting: springs, dampers and inertia keep the diagonal above what else is in the matrix.
    """
    n = _SPEEDS
    for i in range(n):
        for j in range(n):
            store(matrix, 0, n * i + j, (1.0 if i == j else 0.0) - _own(slopes, block, i * LOCAL, j, s))
            store(rows, block, n * i + j, 1.0 if i == j else 0.0)
    regular = True
    for k in range(n):
        pivot = load(matrix, 0, n * k + k)
        regular = regular and total(where_positive(magnitude(pivot), 1.0, 0.0)) == LANES
        inverse = 1.0 / pivot
        for j in range(k + 1, n):
            store(matrix, 0, n * k + j, inverse * load(matrix, 0, n * k + j))
        for j in range(k + 1):
            store(rows, block, n * k + j, inverse * load(rows, block, n * k + j))
        for i in range(n):
            if i != k:
                factor = load(matrix, 0, n * i + k)
                for j in range(k + 1, n):
                    store(matrix, 0, n * i + j, load(matrix, 0, n * i + j) - factor * load(matrix, 0, n * k + j))
                for j in range(k + 1):
                    store(rows, block, n * i + j, load(rows, block, n * i + j) - factor * load(rows, block, n * k + j))
    return regular


@kernel
def _couplings(block, slopes, s, rows):
    """Write how a block of rollers and the border act on each other."""
    for m in range(BORDER):
        position = AT_RING + m if m < RING else AT_CAGE + m - RING
        speed = position + (RING if m < RING else CAGE)
        c_0, c_1 = _shifted(slopes, block, position, speed, s), _shifted(slopes, block, LOCAL + position, LOCAL + speed, s)
        c_2 = _shifted(slopes, block, 2 * LOCAL + position, 2 * LOCAL + speed, s)
        c_3 = _shifted(slopes, block, 3 * LOCAL + position, 3 * LOCAL + speed, s)
        c_4 = _shifted(slopes, block, 4 * LOCAL + position, 4 * LOCAL + speed, s)
        for k in range(_SPEEDS):
            row = _SPEEDS * k
            value = load(rows, block, row) * c_0 + load(rows, block, row + 1) * c_1 + load(rows, block, row + 2) * c_2
            value += load(rows, block, row + 3) * c_3 + load(rows, block, row + 4) * c_4
            store(rows, block, _RIGHT + BORDER * k + m, value)
    for k in range(BORDER):
        first = RING_ROWS + k * RING_COLUMNS if k < RING else CAGE_ROWS + (k - RING) * CAGE_COLUMNS
        for m in range(_SPEEDS):
            store(rows, block, _BELOW + _SPEEDS * k + m, _own(slopes, block, first, m, s))


@kernel
def _reduce(block, slopes, s, rows, positions, corner):
    """Take a block of rollers out of the border's system."""
    for k in range(BORDER):
        below = _BELOW + _SPEEDS * k
        b_0, b_1, b_2 = load(rows, block, below), load(rows, block, below + 1), load(rows, block, below + 2)
        b_3, b_4 = load(rows, block, below + 3), load(rows, block, below + 4)
        on_ring = k < RING
        first = RING_ROWS + k * RING_COLUMNS if on_ring else CAGE_ROWS + (k - RING) * CAGE_COLUMNS
        for m in range(BORDER):
            right = _RIGHT + m
            through = b_0 * load(rows, block, right) + b_1 * load(rows, block, right + BORDER) + b_2 * load(rows, block, right + 2 * BORDER)
            through += b_3 * load(rows, block, right + 3 * BORDER) + b_4 * load(rows, block, right + 4 * BORDER)
            if on_ring == (m < RING):
                column = first + BLOCK + (m if on_ring else m - RING)
                by_position = load(slopes, block, column)
                through += s * (load(slopes, block, column + (RING if on_ring else CAGE)) + s * by_position)
                positions[k, m] += total(by_position)
            corner[k, m] -= total(through)


@kernel
def factor(slopes, border, s, factored):
    """Factor I - s J.

    Parameters
    ----------
    slopes : derivatives through each roller.
    border : derivatives of the border's accelerations by its own positions and speeds, shape (9, 18).
    s : gamma h [s].
    factored : takes the factorisation.

    Returns
    -------
    regular : False where a pivot is zero or not finite.
    """
    rows, positions, corner = factored.rows, factored.positions, factored.schur
    factored.shift[0] = s
    for k in range(BORDER):
        for m in range(BORDER):
            positions[k, m] = border[k, m]
            corner[k, m] = (1.0 if k == m else 0.0) - s * (border[k, BORDER + m] + s * border[k, m])
    regular = True
    for block in range(slopes.shape[0]):
        regular = _invert_blocks(block, slopes, s, rows, factored.block) and regular
        _couplings(block, slopes, s, rows)
        _reduce(block, slopes, s, rows, positions, corner)
    return decompose(corner, factored.order) and regular


@kernel
def _eliminate(block, slopes, s, x, factored):
    """Reduce a block's right side to speeds, solve for them without the border, and take what they do to it from its own."""
    rows, right, reduced = factored.rows, factored.right, factored.block
    q_0, q_1, q_2, q_3 = load(right, block, 0), load(right, block, 1), load(right, block, 2), load(right, block, 3)
    for k in range(_SPEEDS):
        first = k * LOCAL
        value = load(slopes, block, first) * q_0 + load(slopes, block, first + 1) * q_1
        value += load(slopes, block, first + 2) * q_2 + load(slopes, block, first + 3) * q_3
        for m in range(RING):
            value += x[m] * load(slopes, block, first + AT_RING + m)
        for m in range(CAGE):
            value += x[RING + m] * load(slopes, block, first + AT_CAGE + m)
        store(reduced, 0, k, load(right, block, _POSITIONS + k) + s * value)
    b_0, b_1, b_2 = load(reduced, 0, 0), load(reduced, 0, 1), load(reduced, 0, 2)
    b_3, b_4 = load(reduced, 0, 3), load(reduced, 0, 4)
    for k in range(_SPEEDS):
        row = _SPEEDS * k
        value = load(rows, block, row) * b_0 + load(rows, block, row + 1) * b_1 + load(rows, block, row + 2) * b_2
        store(right, block, _POSITIONS + k, value + load(rows, block, row + 3) * b_3 + load(rows, block, row + 4) * b_4)
    v_0, v_1, v_2 = load(right, block, 4), load(right, block, 5), load(right, block, 6)
    v_3, v_4 = load(right, block, 7), load(right, block, 8)
    for k in range(BORDER):
        below = _BELOW + _SPEEDS * k
        first = RING_ROWS + k * RING_COLUMNS if k < RING else CAGE_ROWS + (k - RING) * CAGE_COLUMNS
        passed = load(slopes, block, first) * q_0 + load(slopes, block, first + 1) * q_1
        passed = s * (passed + load(slopes, block, first + 2) * q_2 + load(slopes, block, first + 3) * q_3)
        passed += load(rows, block, below) * v_0 + load(rows, block, below + 1) * v_1 + load(rows, block, below + 2) * v_2
        x[BORDER + k] += total(passed + load(rows, block, below + 3) * v_3 + load(rows, block, below + 4) * v_4)


@kernel
def _substitute(block, s, x, factored):
    """Complete a block's speeds by what the border does to them, and its positions."""
    rows, right = factored.rows, factored.right
    for k in range(_SPEEDS):
        value = load(right, block, _POSITIONS + k)
        for m in range(BORDER):
            value += x[BORDER + m] * load(rows, block, _RIGHT + BORDER * k + m)
        store(right, block, _POSITIONS + k, value)
        if k < _POSITIONS:
            store(right, block, k, load(right, block, k) + s * value)


@kernel
def solve(slopes, factored, x):
    """Replace the right side ``x``, a whole state, by the solution of (I - s J) x = b."""
    s = factored.shift[0]
    count = (x.shape[0] - 2 * BORDER) // BLOCK
    spread_runs(x, 2 * BORDER, BLOCK, count, factored.right)
    for k in range(BORDER):
        through = 0.0
        for m in range(BORDER):
            through += factored.positions[k, m] * x[m]
        x[BORDER + k] += s * through
    for block in range(slopes.shape[0]):
        _eliminate(block, slopes, s, x, factored)
    back_substitute(factored.schur, factored.order, x[BORDER : 2 * BORDER])
    for block in range(slopes.shape[0]):
        _substitute(block, s, x, factored)
    for k in range(BORDER):
        x[k] += s * x[BORDER + k]
    collect_runs(factored.right, 0, BLOCK, count, x, 2 * BORDER)
