# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How much rings grow by rotation, fits and heat.

Rotation: a thin elastic ring, u = rho R^3 omega^2/E.  Fits: thick-walled cylinders of one material (G. Lame; any text on the strength of
materials).  Heat: alpha R dT.  All are linear elastic and plane; ribs and the support by shaft and housing under rotation are left out.
"""

from typing import NamedTuple

from bearing_sim.scene.bearing import Bearing


class Growth(NamedTuple):
    """Growth of the inner raceway against rollers and outer raceway, as compiled code wants it."""

    by_square_speed: float  # of the inner raceway's radius by the square of the shaft's speed [m s^2]
    by_temperature: float  # of inner raceway and rollers less that of the outer raceway, by the oil's temperature [m/K]
    constant: float  # the same at 0 K [m]


def centrifugal_growth(mean_radius: float, density: float, youngs_modulus: float) -> float:
    """Return the radial growth of a thin ring divided by the square of its speed, rho R^3/E [m s^2].

    Parameters
    ----------
    mean_radius : [m].
    density, youngs_modulus : [kg/m^3, Pa].
    """
    return density * mean_radius**3 / youngs_modulus


def inner_fit_growth(interference: float, shaft_bore: float, bore: float, raceway: float) -> float:
    """Return how far the raceway of an inner ring grows on a shaft of the same material [m] (Lame).

    Parameters
    ----------
    interference : diametral [m].
    shaft_bore, bore, raceway : radii of the shaft's bore, the ring's bore and its raceway [m].
    """
    shaft, ring = (bore**2 + shaft_bore**2) / (bore**2 - shaft_bore**2), (raceway**2 + bore**2) / (raceway**2 - bore**2)
    strain = interference / (2 * bore) / (shaft + ring)  # pressure by Young's modulus; Poisson's ratio drops out
    return 2 * strain * bore**2 * raceway / (raceway**2 - bore**2)


def outer_fit_shrinkage(interference: float, raceway: float, outside: float, housing: float) -> float:
    """Return how far the raceway of an outer ring shrinks in a housing of the same material [m] (Lame).

    Parameters
    ----------
    interference : diametral [m].
    raceway, outside, housing : radii of the ring's raceway, its outside and the housing's outside [m].
    """
    ring, around = (outside**2 + raceway**2) / (outside**2 - raceway**2), (housing**2 + outside**2) / (housing**2 - outside**2)
    strain = interference / (2 * outside) / (ring + around)
    return 2 * strain * outside**2 * raceway / (outside**2 - raceway**2)


def fit_growth(bearing: Bearing) -> tuple[float, float]:
    """Return how far the fits move inner and outer raceway outwards [m]."""
    growth, inner, outer = bearing.ring_growth, bearing.inner_raceway, bearing.outer_raceway
    grown, shrunk = 0.0, 0.0
    if growth.shaft_interference:
        grown = inner_fit_growth(growth.shaft_interference, growth.shaft_bore_radius, inner.bore_radius, inner.radius)
    if growth.housing_interference:
        shrunk = outer_fit_shrinkage(growth.housing_interference, outer.low_radius + outer.d_value / 2, outer.outside_radius, growth.housing_radius)
    return grown, -shrunk


def running_growth(bearing: Bearing) -> Growth:
    """Return the growth that depends on speed and oil temperature.

    What the rollers gain in diameter and the outer raceway in radius is counted at the inner raceway: the play is what matters,
    and the rollers' orbit changes by a ten-thousandth.
    """
    options, material, inner, outer = bearing.ring_growth, bearing.material, bearing.inner_raceway, bearing.outer_raceway
    d_speed = by_temperature = constant = 0.0
    if options.centrifugal:
        d_speed = centrifugal_growth((inner.bore_radius + inner.radius) / 2, material.density, material.youngs_modulus)
    if options.thermal:
        parts = (
            (inner.radius, options.inner_excess),
            (bearing.roller.diameter, options.roller_excess),
            (-(outer.low_radius + outer.d_value / 2), options.outer_excess),
        )
        by_temperature = options.expansion * sum(length for length, _ in parts)
        constant = options.expansion * sum(length * (excess - options.reference_temperature) for length, excess in parts)
    return Growth(d_speed, by_temperature, constant)
