# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The outer raceway contour R_e(phi) in the one form that every contour takes: a periodic table of cubics.

Between two knots the cubic Hermite interpolant of radii and slopes: continuous to the first derivative, so that contact forces have no kink.
Which contour it is (Deng 2017, eq. 1 and 2, measured, machined) is decided in `bearing_sim.scene.contour`.
"""

import math

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import floor, gather, where_positive

TABLE_INTERVALS = 720
_TABLE_MISS = 0.2e-9  # m


def contour_table(radii, slopes):
    """Return the periodic cubic table with given radii and slopes at its knots, for `contour_at`.

    Parameters
    ----------
    radii : R_e at n even azimuths of one turn from 0 [m], shape (n,).
    slopes : dR_e/dphi there [m/rad], shape (n,).

    Returns
    -------
    table : coefficients by interval, highest power of the azimuth within it first, shape (n, 4).
    """
    spacing = 2.0 * math.pi / len(radii)
    rise = (np.roll(radii, -1) - radii) / spacing
    next_slopes = np.roll(slopes, -1)
    cubic = (slopes + next_slopes - 2.0 * rise) / spacing**2
    square = (3.0 * rise - 2.0 * slopes - next_slopes) / spacing
    return np.ascontiguousarray(np.stack([cubic, square, slopes, radii], axis=1))


def tabulated(contour):
    """Return the table of a contour, refined until it is within 0.2 nm of it, or has 16 times the usual 720 knots.

    Parameters
    ----------
    contour : azimuths [rad] -> radii [m] and slopes [m/rad].
    """
    intervals = TABLE_INTERVALS
    while True:
        knots = np.linspace(0.0, 2.0 * math.pi, intervals, endpoint=False)
        table = contour_table(*contour(knots))
        spacing, miss = 2.0 * math.pi / intervals, 0.0
        for fraction in (0.25, 0.5, 0.75):
            x = fraction * spacing
            between = ((table[:, 0] * x + table[:, 1]) * x + table[:, 2]) * x + table[:, 3]
            miss = max(miss, float(np.abs(between - contour(knots + x)[0]).max()))
        if miss <= _TABLE_MISS or intervals >= 16 * TABLE_INTERVALS:
            return table
        intervals *= 2


@kernel
def contour_at(table, position):
    """Return contour radius [m] and its derivative by azimuth [m/rad].

    Parameters
    ----------
    table : periodic cubic table, shape (n, 4), see `contour_table`.
    position : azimuth in intervals of the table, n azimuth/(2 pi), from 0 to n.
    """
    intervals = table.shape[0]
    index = min(int(position), intervals - 1)
    x = (position - index) * (2.0 * math.pi / intervals)
    a, b, c = table[index, 0], table[index, 1], table[index, 2]
    return ((a * x + b) * x + c) * x + table[index, 3], (3.0 * a * x + 2.0 * b) * x + c


@kernel
def contour_lanes(table, turn):
    """Return contour radius [m] and its first and second derivative by azimuth [m/rad, m/rad^2], several at once.

    Parameters
    ----------
    table : periodic cubic table, shape (n, 4), see `contour_table`.
    turn : azimuth in turns, from 0 to 1 (lanes).
    """
    intervals = table.shape[0]
    position = turn * intervals
    index = floor(position)
    index -= where_positive(index - (intervals - 0.5), 1.0, 0.0)  # a turn of all but 1 may round up to the end of the table
    x = (position - index) * (2.0 * math.pi / intervals)
    cubic, square, line = gather(table, index, 0), gather(table, index, 1), gather(table, index, 2)
    radius = ((cubic * x + square) * x + line) * x + gather(table, index, 3)
    return radius, (3.0 * cubic * x + 2.0 * square) * x + line, 6.0 * cubic * x + 2.0 * square
