# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Arrow linear algebra: many scalar equations that couple only through a border of two.

    [ C    L_1 ... L_Z ] [x_c]   [b_c]
    [ R_1  D_1         ] [x_1]   [b_1]
    [ ...       ...    ] [...] = [...]
    [ R_Z          D_Z ] [x_Z]   [b_Z]

The border is a position and its speed: its first column is zero but for the position itself, which nothing
depends on.  Factor and solve cost O(Z).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel


class Arrow(NamedTuple):
    """An arrow matrix of position, speed and Z scalars; or the factorisation of I - shift * J."""

    border: np.ndarray  # d(position')/d(speed) and d(speed')/d(speed), shape (2,); factored: times shift, inverse Schur complement
    rows: np.ndarray  # rows `ARROW`, shape (3, Z)


class ArrowRow(NamedTuple):
    """Rows of `Arrow.rows`."""

    diagonal: int = 0  # d(scalar')/d(scalar); factored: its inverse
    column: int = 1  # d(scalar')/d(speed); factored: times shift
    row: int = 2  # d(speed')/d(scalar); factored: times shift and inverse diagonal


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
        column = shift * given[ARROW.column, j]
        row = shift * given[ARROW.row, j] * inverse
        result[ARROW.diagonal, j] = inverse
        result[ARROW.column, j] = column
        result[ARROW.row, j] = row
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
        total += rows[ARROW.row, j] * x[2 + j]
    speed = factored.border[1] * total
    x[0] += factored.border[0] * speed
    x[1] = speed
    for j in range(rows.shape[1]):
        x[2 + j] = (x[2 + j] + rows[ARROW.column, j] * speed) * rows[ARROW.diagonal, j]
