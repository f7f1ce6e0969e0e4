"""The outer raceway contour R_e(phi), in the one form that every contour takes: a periodic cubic table."""

import math

import numpy as np
from scipy.interpolate import CubicSpline

from bearing_sim.kernels.compilation import kernel, template

TABLE_INTERVALS = 720


def contour_table(angles, radii):
    """Return the periodic cubic spline through (angle, radius) points as a table for `contour_at`.

    Parameters
    ----------
    angles : rising angles over less than one turn [rad], shape (n,), n >= 3.
    radii : contour radius there [m], shape (n,).

    Returns
    -------
    table : spline coefficients on even intervals of one turn from azimuth 0, highest power first,
        shape (TABLE_INTERVALS, 4).
    """
    turn = 2.0 * math.pi
    spline = CubicSpline(np.append(angles, angles[0] + turn), np.append(radii, radii[0]), bc_type="periodic")
    knots = np.linspace(0.0, turn, TABLE_INTERVALS + 1)
    even_radii = spline(knots)
    even_radii[-1] = even_radii[0]
    return np.ascontiguousarray(CubicSpline(knots, even_radii, bc_type="periodic").c.T)


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
    angles = np.linspace(0.0, 2.0 * math.pi, TABLE_INTERVALS, endpoint=False)
    radii = low_radius + d_value / 2 - d_value / 2 * np.cos(lobes * (angles - installation_angle))
    return contour_table(angles, radii)


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
