# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage's guide lands: short journal bearings between cage and guiding ring (Deng 2017, section 3.1.3)."""

import math

from bearing_sim.kernels.compilation import kernel, template

FRICTION_SPIN = 10.0  # rad/s; pocket friction is proportional to spin well below this


@template
def pocket_friction(spin, coefficient):
    """Return the friction coefficient of a pocket with the sign of the roller's spin, smooth through zero.

    Parameters
    ----------
    spin : of the roller [rad/s].
    coefficient : mu_c of a roller that turns fast (Deng 2017, eq. 13).
    """
    return coefficient * spin / math.sqrt(spin * spin + FRICTION_SPIN * FRICTION_SPIN)


@kernel
def land_torque(cage_speed, ring_speed, eccentricity_ratio, viscosity, cage):
    """Return the torque of the oil in the guide lands on the cage [N m] and its slope by cage speed [N m s].

    M = 2 pi eta_0 V R_g^2 L_g/(c sqrt(1 - eps^2)), V = R_g (omega_ring - omega_c) (Deng 2017, eq. 12 f.).

    Parameters
    ----------
    cage_speed, ring_speed : angular speeds of cage and guiding ring [rad/s].
    eccentricity_ratio : eps = cage eccentricity / guide clearance, below 1.
    viscosity : of the oil in the land [Pa s].
    cage : `bearing_sim.params.CageBody`.
    """
    slope = (
        2.0
        * math.pi
        * viscosity
        * cage.guide_radius**3
        * cage.guide_width
        / (cage.guide_clearance * math.sqrt(1.0 - eccentricity_ratio * eccentricity_ratio))
    )
    return slope * (ring_speed - cage_speed), -slope
