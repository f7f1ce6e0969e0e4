# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Viscosity classes of ISO 3448, and the viscosity index of ASTM D2270 forwards and backwards."""

import math
from typing import NamedTuple

# Kinematic viscosity at 40 degC in the middle of each class, mm^2/s, by the class's number (ISO 3448:1992, table 1); a class reaches 10 % to
# either side.
ISO_VISCOSITY_CLASSES = {
    **{2: 2.2, 3: 3.2, 5: 4.6, 7: 6.8},
    **{number: float(number) for number in (10, 15, 22, 32, 46, 68, 100, 150, 220, 320, 460, 680, 1000, 1500, 2200, 3200)},
}


class _IndexRow(NamedTuple):
    """L = a Y^2 + b Y + c and H = d Y^2 + e Y + f for viscosities at 100 degC, Y, from `start` to the next row's [mm^2/s]."""

    start: float
    a: float
    b: float
    c: float
    d: float
    e: float
    f: float


# ASTM D2270, table X2.1: the quadratics by which the standard computes its table 1.
_INDEX_ROWS = (
    _IndexRow(2.0, 1.14673, 1.7576, -0.109, 0.84155, 1.5521, -0.077),
    _IndexRow(3.8, 3.38095, -15.4952, 33.196, 0.78571, 1.7929, -0.183),
    _IndexRow(4.4, 2.5, -7.2143, 13.812, 0.82143, 1.5679, 0.119),
    _IndexRow(5.0, 0.101, 16.635, -45.469, 0.04985, 9.1613, -18.557),
    _IndexRow(6.4, 3.35714, -23.5643, 78.466, 0.22619, 7.7369, -16.656),
    _IndexRow(7.0, 0.01191, 21.475, -72.87, 0.79762, -0.7321, 14.61),
    _IndexRow(7.7, 0.41858, 16.1558, -56.04, 0.05794, 10.5156, -28.24),
    _IndexRow(9.0, 0.88779, 7.5527, -16.6, 0.26665, 6.7015, -10.81),
    _IndexRow(12.0, 0.7672, 10.7972, -38.18, 0.20073, 8.4658, -22.49),
    _IndexRow(15.0, 0.97305, 5.3135, -2.2, 0.28889, 5.9741, -4.93),
    _IndexRow(18.0, 0.97256, 5.25, -0.98, 0.24504, 7.416, -16.73),
    _IndexRow(22.0, 0.91413, 7.4759, -21.82, 0.20323, 9.1267, -34.23),
    _IndexRow(28.0, 0.87031, 9.7157, -50.77, 0.18411, 10.1015, -46.75),
    _IndexRow(40.0, 0.84703, 12.6752, -133.31, 0.17029, 11.4866, -80.62),
    _IndexRow(55.0, 0.85921, 11.1009, -83.19, 0.1713, 11.368, -76.94),
    _IndexRow(70.0, 0.83531, 14.6731, -216.246, 0.16841, 11.8493, -96.947),
)


def reference_viscosities(viscosity_100: float) -> tuple[float, float]:
    """Return L and H [mm^2/s]: viscosities at 40 degC of oils with the indices 0 and 100 (ASTM D2270, table X2.1).

    The standard begins at 2 mm^2/s; *assumption*: below it the first row goes on, as the thinnest classes need it.

    Parameters
    ----------
    viscosity_100 : kinematic viscosity at 100 degC, Y [mm^2/s].
    """
    row = next((each for each in reversed(_INDEX_ROWS) if viscosity_100 >= each.start), _INDEX_ROWS[0])
    square = viscosity_100 * viscosity_100
    return row.a * square + row.b * viscosity_100 + row.c, row.d * square + row.e * viscosity_100 + row.f


def viscosity_index(viscosity_40: float, viscosity_100: float) -> float:
    """Return the viscosity index by ASTM D2270, procedure A up to 100 and procedure B above.

    A: 100 (L - U)/(L - H).  B: 100 + (10^N - 1)/0.00715, N = lg(H/U)/lg Y.  Below 2 mm^2/s at 100 degC, where procedure B loses its sense as
    Y comes to 1, procedure A is continued; *assumption*.

    Parameters
    ----------
    viscosity_40, viscosity_100 : kinematic viscosities at 40 and 100 degC, U and Y [mm^2/s].
    """
    low, high = reference_viscosities(viscosity_100)
    if viscosity_40 >= high or viscosity_100 < _INDEX_ROWS[0].start:
        return 100.0 * (low - viscosity_40) / (low - high)
    exponent = math.log10(high / viscosity_40) / math.log10(viscosity_100)
    return 100.0 + (10.0**exponent - 1.0) / 0.00715


def viscosity_at_100(viscosity_40: float, index: float) -> float:
    """Return the kinematic viscosity at 100 degC [mm^2/s] of an oil by its viscosity index, the inverse of `viscosity_index`.

    Parameters
    ----------
    viscosity_40 : kinematic viscosity at 40 degC [mm^2/s].
    index : viscosity index.
    """
    from scipy.optimize import brentq

    return brentq(lambda thin: viscosity_index(viscosity_40, thin) - index, 0.3 * viscosity_40**0.5, 0.999 * viscosity_40, xtol=1e-12, rtol=1e-13)
