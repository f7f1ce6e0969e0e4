# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Periodic scalar differential equations along an orbit: backward differences that close upon themselves.

    alpha_0 x_m + alpha_1 x_(m-1) + alpha_2 x_(m-2) + alpha_3 x_(m-3) + slope_m x_m = b_m,   m modulo M.

A sweep around the orbit eliminates all but three numbers, those that the sweep began with; they are found by closing it.
Cost: O(M) for each right side.
"""

from bearing_sim.kernels.compilation import kernel

# Three-step backward differentiation formula (Gear 1971): stable for every decaying scalar equation, however stiff.
ALPHA_0, ALPHA_1, ALPHA_2, ALPHA_3 = 11.0 / 6.0, -3.0, 1.5, -1.0 / 3.0
STEPS = 3


@kernel
def backward_difference(x, m):
    """Return the difference of a periodic sequence at place ``m``, shape of ``x`` (M,): the derivative times the spacing."""
    return ALPHA_0 * x[m] + ALPHA_1 * x[m - 1] + ALPHA_2 * x[m - 2] + ALPHA_3 * x[m - 3]  # negative places count from the end


@kernel
def _sweep(slopes, x):
    """Solve from the first place to the last, as if everything before it were zero; all columns at once."""
    places, columns = x.shape
    for m in range(places):
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
    slopes : added to alpha_0 at each place, shape (M,), M at least 3.
    x : right sides in all columns but the last three, which are scratch; shape (M, columns + 3).
    """
    places, columns = x.shape[0], x.shape[1] - STEPS
    for m in range(places):
        for c in range(columns, columns + STEPS):
            x[m, c] = 0.0
    # One of the last columns each for x = 1 one, two and three places before the first, moved to the right side.
    x[0, columns], x[1, columns], x[2, columns] = -ALPHA_1, -ALPHA_2, -ALPHA_3
    x[0, columns + 1], x[1, columns + 1] = -ALPHA_2, -ALPHA_3
    x[0, columns + 2] = -ALPHA_3
    _sweep(slopes, x)
    # (I - H) e = p: the three last numbers e (nearest the end first) are also those before the first.
    last = places - 1
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
        for m in range(places):
            x[m, column] += first * x[m, columns] + second * x[m, columns + 1] + third * x[m, columns + 2]
    return True
