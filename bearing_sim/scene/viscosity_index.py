# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Viscosity classes of ISO 3448, and the viscosity index of ASTM D2270 forwards and backwards."""

import math

from bearing_sim.scene.bundled import catalog_table

ISO_VISCOSITY_CLASSES = {int(row["number"]): float(row["viscosity_40"]) for row in catalog_table("tables/iso_3448")}
"""Kinematic viscosity at 40 degC in the middle of each class of ISO 3448 [mm^2/s], by the class's number."""
_BEGIN = 2.0  # mm^2/s at 100 degC, where the standard begins


def reference_viscosities(viscosity_100: float) -> tuple[float, float]:
    """Return L and H [mm^2/s]: viscosities at 40 degC of oils with the indices 0 and 100 (ASTM D2270, table X2.1).

    The standard begins at 2 mm^2/s; *assumption*: below it the first row goes on, as the thinnest classes need it.

    Parameters
    ----------
    viscosity_100 : kinematic viscosity at 100 degC, Y [mm^2/s].
    """
    rows = catalog_table("tables/astm_d2270")
    row = next((each for each in reversed(rows) if viscosity_100 >= float(each["start"])), rows[0])
    a, b, c, d, e, f = (float(row[name]) for name in "abcdef")
    square = viscosity_100 * viscosity_100
    return a * square + b * viscosity_100 + c, d * square + e * viscosity_100 + f


def viscosity_index(viscosity_40: float, viscosity_100: float) -> float:
    """Return the viscosity index by ASTM D2270, procedure A up to 100 and procedure B above.

    A: 100 (L - U)/(L - H).  B: 100 + (10^N - 1)/0.00715, N = lg(H/U)/lg Y.  Below 2 mm^2/s at 100 degC, where procedure B loses its sense as
    Y comes to 1, procedure A is continued; *assumption*.

    Parameters
    ----------
    viscosity_40, viscosity_100 : kinematic viscosities at 40 and 100 degC, U and Y [mm^2/s].
    """
    low, high = reference_viscosities(viscosity_100)
    if viscosity_40 >= high or viscosity_100 < _BEGIN:
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
