# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Symmetry of an outer raceway's contour, which spares a table of operating points directions and the reverse sense of rotation."""

import math

import numpy as np

_TOLERANCE = 1e-9  # m; tables of a contour are good to a fifth of it
_MOST_LOBES = 12
_PROBES = 997  # azimuths, a prime number: none falls together with its image


def radius_at(contour: np.ndarray, azimuths: np.ndarray) -> np.ndarray:
    """Return R_e [m] at azimuths [rad] from the periodic cubic table of `bearing_sim.kernels.raceway`."""
    intervals = contour.shape[0]
    position = np.mod(azimuths / (2.0 * math.pi), 1.0) * intervals
    index = np.minimum(position.astype(int), intervals - 1)
    x = (position - index) * (2.0 * math.pi / intervals)
    a, b, c, d = contour[index].T
    return ((a * x + b) * x + c) * x + d


def contour_period(contour: np.ndarray) -> float:
    """Return the smallest turn that leaves a contour as it is, 2 pi over a whole number up to 12 [rad]; 0 where any turn does."""
    probes = np.arange(_PROBES) * (2.0 * math.pi / _PROBES)
    radii = radius_at(contour, probes)
    if np.ptp(radii) <= _TOLERANCE:
        return 0.0
    for lobes in range(_MOST_LOBES, 0, -1):
        period = 2.0 * math.pi / lobes
        if np.abs(radius_at(contour, probes + period) - radii).max() <= _TOLERANCE:
            return period
    return 2.0 * math.pi


def mirror_axis(contour: np.ndarray) -> float:
    """Return the azimuth of an axis about which a contour is its own mirror image [rad]; NaN where there is none."""
    probes = np.arange(_PROBES) * (2.0 * math.pi / _PROBES)
    waves = np.fft.rfft(radius_at(contour, probes))
    waves[0] = 0.0
    strongest = int(np.abs(waves).argmax())
    if 2.0 * abs(waves[strongest]) / _PROBES <= _TOLERANCE:
        return 0.0
    # cos(n phi + a) is even about -a/n and every half wave further on
    for half in range(2 * strongest):
        axis = (half * math.pi - np.angle(waves[strongest])) / strongest
        if np.abs(radius_at(contour, axis + probes) - radius_at(contour, axis - probes)).max() <= _TOLERANCE:
            return float(axis)
    return math.nan
