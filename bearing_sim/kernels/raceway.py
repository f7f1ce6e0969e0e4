"""The outer raceway contour R_e(phi), in the one form that every contour takes: a periodic cubic table."""

import math

import numpy as np

from bearing_sim.kernels.compilation import template
from bearing_sim.kernels.lanes import floor, gather, where_positive

TABLE_INTERVALS = 720


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


def lobed_contour(low_radius, d_value, lobes, installation_angle):
    """Return the table of R_e = A + B cos(C phi + E) (Deng 2017, eq. 2).

    A = R_low + D/2, B = -D/2, C = n lobes, E = -n phi_e; D = 0 gives a round raceway.

    Parameters
    ----------
    low_radius : radius at the low points, R_low [m].
    d_value : high-point radius less low-point radius, D [m].
    lobes : number of low points.
    installation_angle : azimuth of a low point, phi_e [rad].
    """
    phase = lobes * (np.linspace(0.0, 2.0 * math.pi, TABLE_INTERVALS, endpoint=False) - installation_angle)
    return contour_table(low_radius + d_value / 2 * (1.0 - np.cos(phase)), lobes * d_value / 2 * np.sin(phase))


@template
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


@template
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
