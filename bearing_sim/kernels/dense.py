# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Small dense systems: LU decomposition with row pivoting, in place."""

from bearing_sim.kernels.compilation import kernel


@kernel
def decompose(matrix, order):
    """Replace a matrix by its factors L (unit diagonal) and U (its diagonal inverted); return False if it is singular or not finite.

    Parameters
    ----------
    matrix : shape (n, n).
    order : takes which row each pivot came from, int64, shape (n,).
    """
    n = matrix.shape[0]
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
        inverse = 1.0 / matrix[k, k]  # what a solution wants, for it cannot wait for divisions
        matrix[k, k] = inverse
        for i in range(k + 1, n):
            factor = matrix[i, k] * inverse
            matrix[i, k] = factor
            for j in range(k + 1, n):
                matrix[i, j] -= factor * matrix[k, j]
    return True


@kernel
def back_substitute(matrix, order, x):
    """Replace ``x`` by the solution with the factors of `decompose`."""
    n = matrix.shape[0]
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
