"""Block-arrow linear algebra: many small blocks that couple only through one border.

    [ D_1           R_1 ] [x_1]   [b_1]
    [      ...      ... ] [...] = [...]
    [          D_Z  R_Z ] [x_Z]   [b_Z]
    [ L_1  ...  L_Z  C  ] [x_c]   [b_c]

Factor and solve cost O(Z).  The border comes first in the vectors: x = (x_c, x_1, ..., x_Z).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel


class BlockArrow(NamedTuple):
    """A block-arrow matrix, or its factorisation."""

    blocks: np.ndarray  # D, shape (Z, b, b); inverse blocks once factored
    right: np.ndarray  # R, shape (Z, b, m); D^-1 R once factored
    below: np.ndarray  # L, shape (Z, m, b)
    corner: np.ndarray  # C, shape (m, m); inverse Schur complement once factored


def new_block_arrow(count, block, border):
    """Return a zeroed matrix of ``count`` blocks of size ``block`` with a border of size ``border``."""
    return BlockArrow(
        np.zeros((count, block, block)), np.zeros((count, block, border)), np.zeros((count, border, block)), np.zeros((border, border))
    )


@kernel
def _invert(matrix, inverse):
    """Invert a small matrix in place of ``inverse`` by Gauss-Jordan with row pivoting; return False if singular."""
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
        if not abs(value) > 0.0:  # NaN ends here too
            return False
        if pivot != k:
            for j in range(n):
                matrix[k, j], matrix[pivot, j] = matrix[pivot, j], matrix[k, j]
                inverse[k, j], inverse[pivot, j] = inverse[pivot, j], inverse[k, j]
        for j in range(n):
            matrix[k, j] /= value
            inverse[k, j] /= value
        for i in range(n):
            if i != k:
                factor = matrix[i, k]
                for j in range(n):
                    matrix[i, j] -= factor * matrix[k, j]
                    inverse[i, j] -= factor * inverse[k, j]
    return True


@kernel
def factor_shifted(jacobian, shift, scratch, factored):
    """Factor I - shift * J.

    Parameters
    ----------
    jacobian : J, a `BlockArrow`.
    shift : gamma h [s].
    scratch : array of shape (>= max(b, m), >= max(b, m)).
    factored : `BlockArrow` that takes the factorisation.

    Returns
    -------
    regular : False where a block or the Schur complement is singular or not finite.
    """
    count, block, border = jacobian.right.shape
    for a in range(border):
        for c in range(border):
            factored.corner[a, c] = (1.0 if a == c else 0.0) - shift * jacobian.corner[a, c]
    for j in range(count):
        for a in range(block):
            for c in range(block):
                scratch[a, c] = (1.0 if a == c else 0.0) - shift * jacobian.blocks[j, a, c]
        if not _invert(scratch[:block, :block], factored.blocks[j]):
            return False
        for a in range(block):
            for c in range(border):
                total = 0.0
                for k in range(block):
                    total -= factored.blocks[j, a, k] * shift * jacobian.right[j, k, c]
                factored.right[j, a, c] = total
        for a in range(border):
            for k in range(block):
                factored.below[j, a, k] = -shift * jacobian.below[j, a, k]
            for c in range(border):
                for k in range(block):
                    factored.corner[a, c] -= factored.below[j, a, k] * factored.right[j, k, c]
    for a in range(border):
        for c in range(border):
            scratch[a, c] = factored.corner[a, c]
    return _invert(scratch[:border, :border], factored.corner)


@kernel
def solve_factored(factored, x, scratch):
    """Solve with a factorisation of `factor_shifted`; ``x`` (border first) holds the right side and takes the solution.

    Parameters
    ----------
    scratch : array of shape (>= max(b, m), >= 2).
    """
    count, block, border = factored.right.shape
    for j in range(count):
        start = border + j * block
        for a in range(block):
            total = 0.0
            for k in range(block):
                total += factored.blocks[j, a, k] * x[start + k]
            scratch[a, 0] = total
        for a in range(block):
            x[start + a] = scratch[a, 0]
        for a in range(border):
            for k in range(block):
                x[a] -= factored.below[j, a, k] * x[start + k]
    for a in range(border):
        total = 0.0
        for k in range(border):
            total += factored.corner[a, k] * x[k]
        scratch[a, 0] = total
    for a in range(border):
        x[a] = scratch[a, 0]
    for j in range(count):
        start = border + j * block
        for a in range(block):
            for k in range(border):
                x[start + a] -= factored.right[j, a, k] * x[k]
