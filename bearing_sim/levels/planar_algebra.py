# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Block-arrow algebra of the planar level: a 3x3 block for each roller and one 5x5 border; ``LANES`` rollers at a time.

(I - s J) x = b for the whole first-order state, reduced to speeds: every position is x = b + s v.  Cost O(Z).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.dense import back_substitute, decompose
from bearing_sim.kernels.lanes import LANES, load, magnitude, new_rows, spread, store, total, where_positive
from bearing_sim.kernels.runs import collect_runs, spread_runs

BORDER = 5  # positions of ring and cage, and as many speeds
_RING = 2  # of them the ring's
BLOCK = 5  # states of a roller
LOCAL = BLOCK + 2 * BORDER  # what a roller depends on
AT_POSITIONS, AT_SPEEDS = BLOCK, BLOCK + BORDER  # where border positions and speeds stand among them
SLOPES = (3 + BORDER) * LOCAL  # rows of derivatives: of r'', phi'', w', then of the border's accelerations, each by `LOCAL` variables
_INVERSE, _RIGHT, _BELOW = 0, 9, 9 + 3 * BORDER  # rows of a factorisation
_FACTORED = _BELOW + 3 * BORDER


class Factored(NamedTuple):
    """A factorisation of I - s J."""

    shift: np.ndarray  # s, shape (1,)
    rows: np.ndarray  # by roller: inverse block (3x3), that times its coupling to the border's speeds (3x5), the border's to it (5x3)
    right: np.ndarray  # right sides by roller: r, phi, and the three speeds
    positions: np.ndarray  # d(border accelerations)/d(border positions), all rollers together, shape (5, 5)
    schur: np.ndarray  # Schur complement as L U, shape (5, 5)
    order: np.ndarray  # of its rows, shape (5,)


def new_factored(count):
    """Return a zeroed factorisation for ``count`` rollers."""
    square = (BORDER, BORDER)
    rows, right = new_rows(_FACTORED, count), new_rows(BLOCK, count)
    return Factored(np.zeros(1), rows, right, np.zeros(square), np.zeros(square), np.zeros(BORDER, np.int64))


@template
def _shifted(slopes, block, row, position, speed, s):
    """Return s (d/d(speed) + s d/d(position)): what a speed does within an implicit step."""
    return s * (load(slopes, block, row + speed) + s * load(slopes, block, row + position))


@kernel
def _roller_blocks(block, slopes, s, rows):
    """Invert I - s (dv'/dv + s dv'/dq) of a block of rollers; return whether all are regular."""
    a, b = 1.0 - _shifted(slopes, block, 0, 0, 2, s), -_shifted(slopes, block, 0, 1, 3, s)
    d, e = -_shifted(slopes, block, LOCAL, 0, 2, s), 1.0 - _shifted(slopes, block, LOCAL, 1, 3, s)
    g, h = -_shifted(slopes, block, 2 * LOCAL, 0, 2, s), -_shifted(slopes, block, 2 * LOCAL, 1, 3, s)
    c, f, i = -(s * load(slopes, block, 4)), -(s * load(slopes, block, LOCAL + 4)), 1.0 - s * load(slopes, block, 2 * LOCAL + 4)
    m_0, m_1, m_2 = e * i - f * h, f * g - d * i, d * h - e * g
    determinant = a * m_0 + b * m_1 + c * m_2
    scale = 1.0 / determinant
    store(rows, block, _INVERSE, m_0 * scale)
    store(rows, block, _INVERSE + 1, (c * h - b * i) * scale)
    store(rows, block, _INVERSE + 2, (b * f - c * e) * scale)
    store(rows, block, _INVERSE + 3, m_1 * scale)
    store(rows, block, _INVERSE + 4, (a * i - c * g) * scale)
    store(rows, block, _INVERSE + 5, (c * d - a * f) * scale)
    store(rows, block, _INVERSE + 6, m_2 * scale)
    store(rows, block, _INVERSE + 7, (b * g - a * h) * scale)
    store(rows, block, _INVERSE + 8, (a * e - b * d) * scale)
    return total(where_positive(magnitude(determinant), 1.0, 0.0)) == LANES


@kernel
def _couplings(block, slopes, s, rows):
    """Write how a block of rollers and the border act on each other."""
    for m in range(BORDER):
        c_0 = _shifted(slopes, block, m, AT_POSITIONS, AT_SPEEDS, s)
        c_1 = _shifted(slopes, block, LOCAL + m, AT_POSITIONS, AT_SPEEDS, s)
        c_2 = _shifted(slopes, block, 2 * LOCAL + m, AT_POSITIONS, AT_SPEEDS, s)
        for k in range(3):
            row = load(rows, block, 3 * k) * c_0 + load(rows, block, 3 * k + 1) * c_1 + load(rows, block, 3 * k + 2) * c_2
            store(rows, block, _RIGHT + BORDER * k + m, row)
    for k in range(BORDER):
        first = (3 + k) * LOCAL
        store(rows, block, _BELOW + 3 * k, _shifted(slopes, block, first, 0, 2, s))
        store(rows, block, _BELOW + 3 * k + 1, _shifted(slopes, block, first, 1, 3, s))
        store(rows, block, _BELOW + 3 * k + 2, s * load(slopes, block, first + 4))


@kernel
def _through_rollers(k, m, rows):
    """Return what a border speed does to another border equation by way of all rollers that give way."""
    radial, orbital, spinning = spread(0.0), spread(0.0), spread(0.0)
    for block in range(rows.shape[0]):
        radial += load(rows, block, _BELOW + 3 * k) * load(rows, block, _RIGHT + m)
        orbital += load(rows, block, _BELOW + 3 * k + 1) * load(rows, block, _RIGHT + BORDER + m)
        spinning += load(rows, block, _BELOW + 3 * k + 2) * load(rows, block, _RIGHT + 2 * BORDER + m)
    return total(radial + orbital + spinning)


@kernel
def _passed_by_rollers(k, m, slopes):
    """Return what a border position and its speed do to a border acceleration by way of all rollers that stand still."""
    by_position, by_speed = spread(0.0), spread(0.0)
    first = (3 + k) * LOCAL + m
    for block in range(slopes.shape[0]):
        by_position += load(slopes, block, first + AT_POSITIONS)
        by_speed += load(slopes, block, first + AT_SPEEDS)
    return total(by_position), total(by_speed)


@kernel
def factor(slopes, border, s, factored):
    """Factor I - s J.

    Parameters
    ----------
    slopes : derivatives through each roller, rows as `SLOPES` says.
    border : derivatives of the border's accelerations by its own positions and speeds, shape (5, 10).
    s : gamma h [s].
    factored : takes the factorisation.

    Returns
    -------
    regular : False where a pivot is zero or not finite.
    """
    rows, corner = factored.rows, factored.schur
    factored.shift[0] = s
    regular = True
    for block in range(slopes.shape[0]):
        regular = _roller_blocks(block, slopes, s, rows) and regular
        _couplings(block, slopes, s, rows)
    for k in range(BORDER):
        for m in range(BORDER):
            corner[k, m] = (1.0 if k == m else 0.0) - s * (border[k, BORDER + m] + s * border[k, m]) - _through_rollers(k, m, rows)
            factored.positions[k, m] = border[k, m]
            if (k < _RING) == (m < _RING):  # ring and cage meet only in the rollers
                by_position, by_speed = _passed_by_rollers(k, m, slopes)
                corner[k, m] -= s * (by_speed + s * by_position)
                factored.positions[k, m] += by_position
    return decompose(corner, factored.order) and regular


@kernel
def _eliminate(block, slopes, s, x, factored):
    """Reduce a block's right side to speeds, solve for them without the border, and take what they do to it from its own."""
    rows, right = factored.rows, factored.right
    radius, angle = load(right, block, 0), load(right, block, 1)
    b_0 = load(slopes, block, 0) * radius + load(slopes, block, 1) * angle
    b_1 = load(slopes, block, LOCAL) * radius + load(slopes, block, LOCAL + 1) * angle
    b_2 = load(slopes, block, 2 * LOCAL) * radius + load(slopes, block, 2 * LOCAL + 1) * angle
    for m in range(BORDER):
        b_0 += x[m] * load(slopes, block, AT_POSITIONS + m)
        b_1 += x[m] * load(slopes, block, LOCAL + AT_POSITIONS + m)
        b_2 += x[m] * load(slopes, block, 2 * LOCAL + AT_POSITIONS + m)
    b_0, b_1, b_2 = load(right, block, 2) + s * b_0, load(right, block, 3) + s * b_1, load(right, block, 4) + s * b_2
    v_0 = load(rows, block, 0) * b_0 + load(rows, block, 1) * b_1 + load(rows, block, 2) * b_2
    v_1 = load(rows, block, 3) * b_0 + load(rows, block, 4) * b_1 + load(rows, block, 5) * b_2
    v_2 = load(rows, block, 6) * b_0 + load(rows, block, 7) * b_1 + load(rows, block, 8) * b_2
    store(right, block, 2, v_0)
    store(right, block, 3, v_1)
    store(right, block, 4, v_2)
    for k in range(BORDER):
        first, below = (3 + k) * LOCAL, _BELOW + 3 * k
        passed = s * (load(slopes, block, first) * radius + load(slopes, block, first + 1) * angle)
        passed += load(rows, block, below) * v_0 + load(rows, block, below + 1) * v_1 + load(rows, block, below + 2) * v_2
        x[BORDER + k] += total(passed)


@kernel
def _substitute(block, s, x, factored):
    """Complete a block's speeds by what the border does to them, and its positions."""
    rows, right = factored.rows, factored.right
    v_0, v_1, v_2 = load(right, block, 2), load(right, block, 3), load(right, block, 4)
    for m in range(BORDER):
        v_0 += x[BORDER + m] * load(rows, block, _RIGHT + m)
        v_1 += x[BORDER + m] * load(rows, block, _RIGHT + BORDER + m)
        v_2 += x[BORDER + m] * load(rows, block, _RIGHT + 2 * BORDER + m)
    store(right, block, 0, load(right, block, 0) + s * v_0)
    store(right, block, 1, load(right, block, 1) + s * v_1)
    store(right, block, 2, v_0)
    store(right, block, 3, v_1)
    store(right, block, 4, v_2)


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
