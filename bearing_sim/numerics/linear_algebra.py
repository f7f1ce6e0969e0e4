# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Linear systems of the shapes that the levels lead to: small dense ones, arrows, and periodic differences.

Dense systems: LU decomposition with row pivoting, in place.

Arrows: many scalar equations that couple only through a border of two,

    [ C    L_1 ... L_Z ] [x_c]   [b_c]
    [ R_1  D_1         ] [x_1]   [b_1]
    [ ...       ...    ] [...] = [...]
    [ R_Z          D_Z ] [x_Z]   [b_Z]

The border is a position and its speed: its first column is zero but for the position itself, on which nothing depends.  Factoring and
solving cost O(Z).

Periodic differences: scalar differential equations along an orbit by backward differences that close upon themselves,

    alpha_0 x_m + alpha_1 x_(m-1) + alpha_2 x_(m-2) + alpha_3 x_(m-3) + slope_m x_m = b_m,   m modulo M.

A sweep around the orbit eliminates all but three numbers, those that the sweep started with; closing it gives these.  Cost: O(M) for
each right side.
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel


@fused
def decompose(n, matrix, order):
    """Replace a matrix by its factors L (unit diagonal) and U (its diagonal inverted); return False if it is singular or not finite.

    Parameters
    ----------
    n : size; where it is a constant, the loops are unrolled.
    matrix : shape (n, n).
    order : takes the row of each pivot, int64, shape (n,).
    """
    for k in range(n):
        pivot = k
        for i in range(k + 1, n):
            if abs(matrix[i, k]) > abs(matrix[pivot, k]):
                pivot = i
        order[k] = pivot
        if not abs(matrix[pivot, k]) > 0.0:
            return False
        if pivot != k:
            for j in range(n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
        inverse = 1.0 / matrix[k, k]  # solutions multiply by it instead of dividing
        matrix[k, k] = inverse
        for i in range(k + 1, n):
            factor = matrix[i, k] * inverse
            matrix[i, k] = factor
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
    return True


@fused
def back_substitute(n, matrix, order, x):
    """Replace the first ``n`` numbers of ``x`` by the solution with the factors of `decompose`."""
    for k in range(n):
        pivot = order[k]
        x[k], x[pivot] = x[pivot], x[k]
    for i in range(n):
        value = x[i]
        for j in range(i):
            value -= matrix[i, j] * x[j]
        x[i] = value
    for i in range(n - 1, -1, -1):
        value = x[i]
        for j in range(i + 1, n):
            value -= matrix[i, j] * x[j]
        x[i] = value * matrix[i, i]


class Arrow(NamedTuple):
    """An arrow matrix of position, speed and Z scalars, which may also follow the derivative of the speed; or the factorisation of I - shift * J."""

    border: np.ndarray  # d(position')/d(speed) and d(speed')/d(speed), shape (2,); factored: times shift, inverse Schur complement
    rows: np.ndarray  # rows `ARROW`, shape (4, Z)


class ArrowRow(NamedTuple):
    """Rows of `Arrow.rows`."""

    diagonal: int = 0  # d(scalar')/d(scalar); factored: its inverse
    column: int = 1  # d(scalar')/d(speed) at the same speed'; factored: times shift, and pulled
    row: int = 2  # d(speed')/d(scalar); factored: times shift and inverse diagonal
    pulled: int = 3  # d(scalar')/d(speed')


ARROW = ArrowRow()


def new_arrow(count):
    """Return a zeroed matrix with ``count`` scalars."""
    return Arrow(np.zeros(2), np.zeros((len(ARROW), count)))


@kernel
def factor_shifted(jacobian, shift, factored):
    """Factor I - shift * J into ``factored``; return False where a pivot is zero or not finite."""
    given, result = jacobian.rows, factored.rows
    schur = 1.0 - shift * jacobian.border[1]
    regular = True
    for j in range(given.shape[1]):
        pivot = 1.0 - shift * given[ARROW.diagonal, j]
        regular = regular and abs(pivot) > 0.0
        inverse = 1.0 / pivot
        # by the equation of the speed, shift d(speed') is what the speed changes by less its right side
        column = shift * given[ARROW.column, j] + given[ARROW.pulled, j]
        row = shift * given[ARROW.row, j] * inverse
        result[ARROW.diagonal, j] = inverse
        result[ARROW.column, j] = column
        result[ARROW.row, j] = row
        result[ARROW.pulled, j] = given[ARROW.pulled, j]
        schur -= row * column
    factored.border[0] = shift * jacobian.border[0]
    factored.border[1] = 1.0 / schur
    return regular and abs(schur) > 0.0


@kernel
def solve_factored(factored, x):
    """Replace the right side ``x`` = (position, speed, scalars) by the solution."""
    rows = factored.rows
    total = x[1]
    for j in range(rows.shape[1]):
        x[2 + j] -= rows[ARROW.pulled, j] * x[1]
        total += rows[ARROW.row, j] * x[2 + j]
    speed = factored.border[1] * total
    x[0] += factored.border[0] * speed
    x[1] = speed
    for j in range(rows.shape[1]):
        x[2 + j] = (x[2 + j] + rows[ARROW.column, j] * speed) * rows[ARROW.diagonal, j]


# Three-step backward differentiation formula (Gear 1971): stable for every decaying scalar equation, however stiff.
ALPHA_0, ALPHA_1, ALPHA_2, ALPHA_3 = 11.0 / 6.0, -3.0, 1.5, -1.0 / 3.0
STEPS = 3


@kernel
def backward_difference(x, m):
    """Return the difference of a periodic sequence at position ``m``, shape of ``x`` (M,): the derivative times the spacing."""
    return ALPHA_0 * x[m] + ALPHA_1 * x[m - 1] + ALPHA_2 * x[m - 2] + ALPHA_3 * x[m - 3]  # negative indices count from the end


@kernel
def _sweep(slopes, x):
    """Solve from the first position to the last, with zeros before the first; all columns at once."""
    positions, columns = x.shape
    for m in range(positions):
        inverse = 1.0 / (ALPHA_0 + slopes[m])
        for c in range(columns):
            value = x[m, c]
            if m >= 1:
                value -= ALPHA_1 * x[m - 1, c]
            if m >= 2:
                value -= ALPHA_2 * x[m - 2, c]
            if m >= 3:
                value -= ALPHA_3 * x[m - 3, c]
            x[m, c] = value * inverse


@kernel
def solve_cyclic(slopes, x):
    """Replace right sides by the periodic solutions; return False where there is none.

    Parameters
    ----------
    slopes : added to alpha_0 at each position, shape (M,), M at least 3.
    x : right sides in all columns but the last three, which are scratch; shape (M, columns + 3).
    """
    positions, columns = x.shape[0], x.shape[1] - STEPS
    for m in range(positions):
        for c in range(columns, columns + STEPS):
            x[m, c] = 0.0
    # The last columns: unit values one, two and three positions before the first, moved to the right side.
    x[0, columns], x[1, columns], x[2, columns] = -ALPHA_1, -ALPHA_2, -ALPHA_3
    x[0, columns + 1], x[1, columns + 1] = -ALPHA_2, -ALPHA_3
    x[0, columns + 2] = -ALPHA_3
    _sweep(slopes, x)
    # (I - H) e = p: the last three numbers e (nearest the end first) are also those before the first.
    last = positions - 1
    a, b, c = 1.0 - x[last, columns], -x[last, columns + 1], -x[last, columns + 2]
    d, e, f = -x[last - 1, columns], 1.0 - x[last - 1, columns + 1], -x[last - 1, columns + 2]
    g, h, i = -x[last - 2, columns], -x[last - 2, columns + 1], 1.0 - x[last - 2, columns + 2]
    determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    if not abs(determinant) > 1e-12:
        return False
    inverse = 1.0 / determinant
    for column in range(columns):
        p, q, r = x[last, column], x[last - 1, column], x[last - 2, column]
        first = (p * (e * i - f * h) - b * (q * i - f * r) + c * (q * h - e * r)) * inverse
        second = (a * (q * i - f * r) - p * (d * i - f * g) + c * (d * r - q * g)) * inverse
        third = (a * (e * r - q * h) - b * (d * r - q * g) + p * (d * h - e * g)) * inverse
        for m in range(positions):
            x[m, column] += first * x[m, columns] + second * x[m, columns + 1] + third * x[m, columns + 2]
    return True
