"""Block-arrow algebra of the planar level: a 3x3 block for each roller and one 5x5 border.

(I - s J) x = b for the whole first-order state, reduced to speeds: every position is x = b + s v.  Cost O(Z).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel

BORDER = 5  # positions of ring and cage, and as many speeds
BLOCK = 5  # states of a roller
LOCAL = BLOCK + 2 * BORDER  # what a roller depends on
AT_POSITIONS, AT_SPEEDS = BLOCK, BLOCK + BORDER  # where border positions and speeds stand among them


class Factored(NamedTuple):
    """A factorisation of I - s J."""

    shift: np.ndarray  # s, shape (1,)
    inverse: np.ndarray  # inverse roller blocks, shape (Z, 3, 3)
    right: np.ndarray  # inverse block times the roller's coupling to the border's speeds, shape (Z, 3, 5)
    below: np.ndarray  # the border's coupling to the roller's speeds, shape (Z, 5, 3)
    positions: np.ndarray  # d(border accelerations)/d(border positions), all rollers together, shape (5, 5)
    schur: np.ndarray  # inverse Schur complement, shape (5, 5)
    scratch: np.ndarray  # shape (5, 5)


def new_factored(count):
    """Return a zeroed factorisation for ``count`` rollers."""
    shapes = (1,), (count, 3, 3), (count, 3, BORDER), (count, BORDER, 3), (BORDER, BORDER), (BORDER, BORDER), (BORDER, BORDER)
    return Factored(*[np.zeros(shape) for shape in shapes])


@kernel
def _invert(matrix, inverse):
    """Invert a small matrix by Gauss-Jordan elimination with row pivoting; return False if it is singular or not finite."""
    n = matrix.shape[0]
    for i in range(n):
        for j in range(n):
            inverse[i, j] = 1.0 if i == j else 0.0
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        value = matrix[pivot, k]
        if not abs(value) > 0.0:
            return False
        for j in range(n):
            matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
            inverse[k, j], inverse[pivot, j] = inverse[pivot, j], inverse[k, j]
        for j in range(n):
            matrix[k, j] /= value
            inverse[k, j] /= value
        for i in range(n):
            factor = matrix[i, k]
            if i != k and factor != 0.0:
                for j in range(n):
                    matrix[i, j] -= factor * matrix[k, j]
                    inverse[i, j] -= factor * inverse[k, j]
    return True


@kernel
def _roller_block(own, j, s, inverse):
    """Invert I - s (dv'/dv + s dv'/dq) of roller j; return False if singular."""
    a, b, c = 1.0 - s * (own[j, 0, 2] + s * own[j, 0, 0]), -s * (own[j, 0, 3] + s * own[j, 0, 1]), -s * own[j, 0, 4]
    d, e, f = -s * (own[j, 1, 2] + s * own[j, 1, 0]), 1.0 - s * (own[j, 1, 3] + s * own[j, 1, 1]), -s * own[j, 1, 4]
    g, h, i = -s * (own[j, 2, 2] + s * own[j, 2, 0]), -s * (own[j, 2, 3] + s * own[j, 2, 1]), 1.0 - s * own[j, 2, 4]
    m_0, m_1, m_2 = e * i - f * h, f * g - d * i, d * h - e * g
    determinant = a * m_0 + b * m_1 + c * m_2
    scale = 1.0 / determinant
    inverse[j, 0, 0], inverse[j, 0, 1], inverse[j, 0, 2] = m_0 * scale, (c * h - b * i) * scale, (b * f - c * e) * scale
    inverse[j, 1, 0], inverse[j, 1, 1], inverse[j, 1, 2] = m_1 * scale, (a * i - c * g) * scale, (c * d - a * f) * scale
    inverse[j, 2, 0], inverse[j, 2, 1], inverse[j, 2, 2] = m_2 * scale, (b * g - a * h) * scale, (a * e - b * d) * scale
    return abs(determinant) > 0.0


@kernel
def factor(own, passed, border, s, factored):
    """Factor I - s J.

    Parameters
    ----------
    own, passed, border : derivatives, see `bearing_sim.levels.planar_equations.Work`.
    s : gamma h [s].
    factored : takes the factorisation.

    Returns
    -------
    regular : False where a pivot is zero or not finite.
    """
    inverse, right, below = factored.inverse, factored.right, factored.below
    positions, corner = factored.positions, factored.scratch
    factored.shift[0] = s
    for k in range(BORDER):
        for m in range(BORDER):
            positions[k, m] = border[k, m]
            corner[k, m] = (1.0 if k == m else 0.0) - s * (border[k, BORDER + m] + s * border[k, m])
    regular = True
    for j in range(own.shape[0]):
        regular = _roller_block(own, j, s, inverse) and regular
        for k in range(3):
            for m in range(BORDER):
                total = 0.0
                for a in range(3):
                    total -= inverse[j, k, a] * s * (own[j, a, AT_SPEEDS + m] + s * own[j, a, AT_POSITIONS + m])
                right[j, k, m] = total
        for k in range(BORDER):
            below[j, k, 0] = -s * (passed[j, k, 2] + s * passed[j, k, 0])
            below[j, k, 1] = -s * (passed[j, k, 3] + s * passed[j, k, 1])
            below[j, k, 2] = -s * passed[j, k, 4]
            for m in range(BORDER):
                positions[k, m] += passed[j, k, AT_POSITIONS + m]
                corner[k, m] -= (
                    s * (passed[j, k, AT_SPEEDS + m] + s * passed[j, k, AT_POSITIONS + m])
                    + below[j, k, 0] * right[j, 0, m]
                    + below[j, k, 1] * right[j, 1, m]
                    + below[j, k, 2] * right[j, 2, m]
                )
    return _invert(corner, factored.schur) and regular


@kernel
def solve(own, passed, factored, x):
    """Replace the right side ``x``, a whole state, by the solution of (I - s J) x = b."""
    s, inverse, right, below = factored.shift[0], factored.inverse, factored.right, factored.below
    for k in range(BORDER):
        total = 0.0
        for m in range(BORDER):
            total += factored.positions[k, m] * x[m]
        x[BORDER + k] += s * total
    for j in range(own.shape[0]):
        first = 2 * BORDER + BLOCK * j
        radius, phi = x[first], x[first + 1]
        b_0, b_1, b_2 = 0.0, 0.0, 0.0
        for m in range(BORDER):
            b_0 += own[j, 0, AT_POSITIONS + m] * x[m]
            b_1 += own[j, 1, AT_POSITIONS + m] * x[m]
            b_2 += own[j, 2, AT_POSITIONS + m] * x[m]
        b_0 = x[first + 2] + s * (own[j, 0, 0] * radius + own[j, 0, 1] * phi + b_0)
        b_1 = x[first + 3] + s * (own[j, 1, 0] * radius + own[j, 1, 1] * phi + b_1)
        b_2 = x[first + 4] + s * (own[j, 2, 0] * radius + own[j, 2, 1] * phi + b_2)
        v_0 = inverse[j, 0, 0] * b_0 + inverse[j, 0, 1] * b_1 + inverse[j, 0, 2] * b_2
        v_1 = inverse[j, 1, 0] * b_0 + inverse[j, 1, 1] * b_1 + inverse[j, 1, 2] * b_2
        v_2 = inverse[j, 2, 0] * b_0 + inverse[j, 2, 1] * b_1 + inverse[j, 2, 2] * b_2
        x[first + 2], x[first + 3], x[first + 4] = v_0, v_1, v_2
        for k in range(BORDER):
            x[BORDER + k] += s * (passed[j, k, 0] * radius + passed[j, k, 1] * phi)
            x[BORDER + k] -= below[j, k, 0] * v_0 + below[j, k, 1] * v_1 + below[j, k, 2] * v_2
    u_0 = u_1 = u_2 = u_3 = u_4 = 0.0
    for m in range(BORDER):
        value = x[BORDER + m]
        u_0 += factored.schur[0, m] * value
        u_1 += factored.schur[1, m] * value
        u_2 += factored.schur[2, m] * value
        u_3 += factored.schur[3, m] * value
        u_4 += factored.schur[4, m] * value
    x[BORDER], x[BORDER + 1], x[BORDER + 2], x[BORDER + 3], x[BORDER + 4] = u_0, u_1, u_2, u_3, u_4
    for k in range(BORDER):
        x[k] += s * x[BORDER + k]
    for j in range(own.shape[0]):
        first = 2 * BORDER + BLOCK * j
        for k in range(3):
            for m in range(BORDER):
                x[first + 2 + k] -= right[j, k, m] * x[BORDER + m]
        x[first] += s * x[first + 2]
        x[first + 1] += s * x[first + 3]
