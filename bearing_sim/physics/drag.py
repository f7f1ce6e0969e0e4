# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Drag of the oil-air mixture on cage and rollers (Deng 2017, section 3.1.4, and the general literature)."""

import math

import numpy as np

from bearing_sim.kernels.compilation import kernel

# Drag coefficient of a cylinder across the flow by Reynolds number, interpolated in logarithms (physics of
# bluff bodies; the table of the bearing literature).
_REYNOLDS = np.log(np.array([0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 2e5, 3e5, 4e5, 5e5, 1e6]))
_DRAG_COEFFICIENT = np.log(np.array([60.0, 10.0, 3.0, 1.8, 1.0, 1.2, 1.2, 0.9, 0.65, 0.3, 0.3]))


@kernel
def churning_force(speed, density, viscosity, roller_diameter, roller_length):
    """Return the drag on a roller moving across the mixture [N] and its slope by speed [N s/m].

    F = 0.5 rho C_d (L D_w) v |v|, against the motion.

    Parameters
    ----------
    speed : orbital speed of the roller centre [m/s].
    density, viscosity : of the oil-air mixture [kg/m^3, Pa s].
    roller_diameter, roller_length : [m].
    """
    magnitude = abs(speed)
    reynolds = density * magnitude * roller_diameter / viscosity
    if reynolds < 1e-12:
        return 0.0, 0.0
    logarithm = math.log(reynolds)
    segment = 0
    while segment < _REYNOLDS.shape[0] - 2 and logarithm > _REYNOLDS[segment + 1]:
        segment += 1
    exponent = (_DRAG_COEFFICIENT[segment + 1] - _DRAG_COEFFICIENT[segment]) / (_REYNOLDS[segment + 1] - _REYNOLDS[segment])
    if logarithm > _REYNOLDS[-1]:  # constant beyond the table
        exponent = 0.0
        logarithm = _REYNOLDS[-1]
    coefficient = math.exp(_DRAG_COEFFICIENT[segment] + exponent * (logarithm - _REYNOLDS[segment]))
    if logarithm >= _REYNOLDS[-1]:
        coefficient = math.exp(_DRAG_COEFFICIENT[-1])
    force = 0.5 * density * coefficient * roller_length * roller_diameter * speed * magnitude
    return force, (2.0 + exponent) * force / speed


@kernel
def cylinder_torque(relative_speed, radius, clearance, width, density, viscosity):
    """Return the torque between coaxial cylinders in the mixture [N m] and its slope by relative speed [N m s].

    Petroff's laminar torque 2 pi eta R^3 omega L/c times f/f_L: 1.3 (Ta/41)^0.539 in Taylor vortices (Ta = Re sqrt(c/R)),
    3.0 (Re/2500)^0.856 in turbulence; the largest of the three is taken, so that nothing jumps between regimes.

    Parameters
    ----------
    relative_speed : angular speed of one cylinder relative to the other [rad/s]; the torque has its sign.
    radius, clearance, width : [m].
    density, viscosity : of the mixture [kg/m^3, Pa s].
    """
    petroff = 2.0 * math.pi * viscosity * radius**3 * width / clearance
    reynolds = density * abs(relative_speed) * radius * clearance / viscosity
    factor, exponent = 1.0, 0.0
    vortices = 1.3 * (reynolds * math.sqrt(clearance / radius) / 41.0) ** 0.539
    if vortices > factor:
        factor, exponent = vortices, 0.539
    turbulence = 3.0 * (reynolds / 2500.0) ** 0.856
    if turbulence > factor:
        factor, exponent = turbulence, 0.856
    return petroff * factor * relative_speed, petroff * factor * (1.0 + exponent)


@kernel
def end_face_torque(speed, outer_radius, inner_radius, density, viscosity):
    """Return the drag on both end faces of a rotating annulus [N m], against its rotation, and its slope [N m s].

    M = 0.5 rho omega^2 (R_o^5 - R_in^5) C_n, C_n = 3.87 Re^-0.5 in laminar and 0.146 Re^-0.2 in turbulent flow, Re =
    rho omega R_o^2/eta.  The literature switches at 3e5, where C_n jumps by 1.66; here it goes over between 2.5e5 and 3.5e5.

    Parameters
    ----------
    speed : angular speed [rad/s].
    outer_radius, inner_radius : of the faces [m].
    density, viscosity : of the mixture [kg/m^3, Pa s].
    """
    magnitude = abs(speed)
    reynolds = density * magnitude * outer_radius**2 / viscosity
    if reynolds < 1e-12:
        return 0.0, 0.0
    turbulent_share = min(max((reynolds - 2.5e5) / 1e5, 0.0), 1.0)
    coefficient = (1.0 - turbulent_share) * 3.87 / math.sqrt(reynolds) + turbulent_share * 0.146 * reynolds**-0.2
    exponent = 1.5 + 0.3 * turbulent_share
    torque = 0.5 * density * speed * magnitude * (outer_radius**5 - inner_radius**5) * coefficient
    return torque, exponent * torque / speed
