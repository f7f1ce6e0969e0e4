# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Drag of the oil-air mixture on rollers and cage (Deng 2017, section 3.1.4), and of oil that stands in the bearing.

The mixture has the density rho = mixture fraction times that of the oil, and the oil's viscosity eta: both are *assumptions*, the first
is the knob to calibrate (published fractions 0.015 to 0.05).  Of a jet whose flow is known the fraction follows from flow and speed.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import exponential, logarithm, power

# Drag coefficient C_d of a long cylinder across a flow by Re = rho v D_w/eta, interpolated in logarithms and constant beyond the table.
# Assumption: read off the curve for one cylinder in an unbounded flow that textbooks show (H. Schlichting, Boundary-Layer Theory); the
# rollers of a bearing stand close behind each other.
_REYNOLDS = np.log(np.array([0.1, 1.0, 10.0, 100.0, 1e3, 1e4, 2e5, 3e5, 4e5, 5e5, 1e6]))
_DRAG_COEFFICIENT = np.log(np.array([60.0, 10.0, 3.0, 1.8, 1.0, 1.2, 1.2, 0.9, 0.65, 0.3, 0.3]))


# Factor V_M of rolling elements in an oil bath by the level of the oil over the mean diameter, H/d_m, for roller bearings: read off the diagram of
# SKF, The SKF model for calculating the frictional moment.  Two public digitisations of it agree within 20 % at levels below 0.1 and within 5 %
# above; interpolated linearly and constant beyond.
_LEVELS = (0.0, 0.0126, 0.027, 0.0456, 0.0611, 0.0819, 0.0978, 0.1219, 0.1448, 0.2, 0.2435, 0.3152, 0.4891, 0.6609, 0.8891, 1.1087, 1.2)
_DRAG_LOSS = (
    0.0, 7.3e-6, 1.81e-5, 3.45e-5, 5.33e-5, 8.47e-5, 1.121e-4, 1.618e-4, 2.167e-4, 3.03e-4, 3.78e-4, 4.70e-4, 6.72e-4, 8.46e-4, 1.079e-3,
    1.321e-3, 1.434e-3,
)  # fmt: skip
_SHAPE, _ROLLER_SHAPE = 5.1, 0.65  # K_Z and K_L of cylindrical roller bearings with a cage
_THICKEST, _THICK_EXPONENT = 500.0, 0.37  # mm^2/s; up to there SKF's moment is valid, and how the oil's own friction grows beyond
_SLOWED = -1.379  # exponent of the Reynolds number in the moment of the oil's own friction
_STILL = 1.0  # rad/s of the cage, below which that moment, a root of the speed, is linear


LARGEST_FRACTION = 0.3
"""Assumption: the oil-air mixture of a jet holds no more oil than that, for what is more drains off."""


def swept_fraction(flow, pitch_diameter):
    """Return the oil's fraction of the mixture times the shaft's speed [rad/s] of a bearing with an oil jet.

    x = 1e5 Q^0.37/(n d_m^1.7) with Q in cm^3/min, n in rpm and d_m in mm: R. J. Parker, NASA TP-2275 (1984), from the heat and the temperatures
    of jet-lubricated ball bearings and roller bearings of 75 to 120 mm bore at 1 to 3 million rpm mm, as secondary literature quotes it; the
    original has not been read.

    Parameters
    ----------
    flow : Q [m^3/s].
    pitch_diameter : d_m [m].
    """
    return 1e5 * (6e7 * flow) ** 0.37 / (1e3 * pitch_diameter) ** 1.7 * (math.pi / 30.0)


@kernel
def mixture_density(shaft_speed, lubrication):
    """Return the density of the oil-air mixture [kg/m^3] at a speed of the shaft [rad/s]; ``lubrication`` as of `roller_drag`."""
    return min(lubrication.mixture_density, lubrication.mixture_flow / max(abs(shaft_speed), 1e-9))


class Bath(NamedTuple):
    """Drag of an oil bath on each roller along the orbit: F = displacing omega_c |omega_c| + rubbing omega_c |omega_c|^-0.379."""

    displacing: float  # [N s^2]
    rubbing: float  # [N s^0.621]


def bath_moment(level, speed, kinematic_viscosity, bore_diameter, outside_diameter, width):
    """Return SKF's two moments of drag in an oil bath on a horizontal bearing [N m]: of displacing the oil and of its own friction.

    M_drag = 4 V_M K_roll C_w B d_m^4 n^2 + 1.093e-7 n^2 d_m^3 (n d_m^2 f_t/nu)^-1.379 R_s [N mm, mm, rpm, mm^2/s] with d_m = (d + D)/2,
    K_roll = K_L K_Z (d + D)/(D - d) 1e-12, C_w = 2.789e-10 l_D^3 - 2.786e-4 l_D^2 + 0.0195 l_D + 0.6439, l_D = 5 K_L B/d_m, f_t = sin(t/2) up
    to t = pi and 1 beyond, t = 2 arccos((0.6 d_m - H)/(0.6 d_m)), H at most 1.2 d_m, R_s = 0.36 d_m^2 (t - sin t) f_A, f_A = 0.05 K_Z (D + d)/(D - d)
    (SKF, The SKF model for calculating the frictional moment).  It is for a large bath, a horizontal shaft, constant speed and oils up to
    500 mm^2/s, and counts rollers and cage together.  Of oil that is sprayed in SKF counts twice the moment of a bath up to the middle of the
    lowest roller.  *Assumption*: above 500 mm^2/s the oil's own friction grows with nu^0.37, as the drag of a cylinder in a flow does between
    Re = 100 and 1 (the table above), and not with nu^1.379.

    Parameters
    ----------
    level : H above the lowest point of the outer raceway [m].
    speed : of the shaft [rad/s], positive.
    kinematic_viscosity : nu [m^2/s].
    bore_diameter, outside_diameter, width : d, D and B [m].
    """
    inside, outside, broad = 1e3 * bore_diameter, 1e3 * outside_diameter, 1e3 * width
    mean, turns = 0.5 * (inside + outside), speed * 30.0 / math.pi
    height = min(1e3 * level, 1.2 * mean)
    slenderness = (inside + outside) / (outside - inside)
    length = 5.0 * _ROLLER_SHAPE * broad / mean
    shape = 2.789e-10 * length**3 - 2.786e-4 * length**2 + 0.0195 * length + 0.6439
    loss = float(np.interp(height / mean, _LEVELS, _DRAG_LOSS))
    displacing = 4.0 * loss * _ROLLER_SHAPE * _SHAPE * slenderness * 1e-12 * shape * broad * mean**4 * turns**2
    wetted = 2.0 * math.acos((0.6 * mean - height) / (0.6 * mean))
    if wetted <= 0.0:
        return 1e-3 * displacing, 0.0
    chord = math.sin(0.5 * wetted) if wetted <= math.pi else 1.0
    viscosity = 1e6 * kinematic_viscosity
    reynolds = turns * mean**2 * chord / min(viscosity, _THICKEST)
    thicker = max(viscosity / _THICKEST, 1.0) ** _THICK_EXPONENT
    surface = 0.36 * mean**2 * (wetted - math.sin(wetted)) * 0.05 * _SHAPE * slenderness
    return 1e-3 * displacing, 1e-3 * 1.093e-7 * turns**2 * mean**3 * reynolds**_SLOWED * surface * thicker


def bath_drag(level, kinematic_viscosity, rollers, raceways, bore_diameter, outside_diameter, width, factor=1.0):
    """Return the `Bath` whose force on all rollers takes the power of `bath_moment`, times a factor, from a cage that does not slip.

    Parameters
    ----------
    level, kinematic_viscosity, bore_diameter, outside_diameter, width : as of `bath_moment`.
    rollers, raceways : of `bearing_sim.model.params.Params`.
    """
    shaft_speed = 2.0 / (1.0 - raceways.diameter_ratio)  # at a cage speed of 1 rad/s
    displacing, rubbing = bath_moment(level, shaft_speed, kinematic_viscosity, bore_diameter, outside_diameter, width)
    lever = factor * shaft_speed / (rollers.count * raceways.pitch_radius)
    return Bath(displacing * lever, rubbing * lever)


@fused
def roller_drag(cage_speed, shaft_speed, params, lubrication):
    """Return the drag on one roller along the orbit [N], against it, and its derivative by the cage's speed [N s].

    That of the mixture, all rollers orbiting at the pitch radius (to 0.3 %), and that of the bath.

    Parameters
    ----------
    cage_speed, shaft_speed : [rad/s].
    params, lubrication : of the bearing, see `bearing_sim.model.params`.
    """
    radius, bath = params.raceways.pitch_radius, lubrication.bath
    density = mixture_density(shaft_speed, lubrication)
    force, d_speed = churning_force(radius * cage_speed, density, lubrication.viscosity, 2.0 * params.rollers.radius, params.rollers.length)
    square, exponent = cage_speed * cage_speed + _STILL * _STILL, 0.5 * (1.0 + _SLOWED)
    rubbing = bath.rubbing * power(square, exponent)
    force += (bath.displacing * abs(cage_speed) + rubbing) * cage_speed
    return force, radius * d_speed + 2.0 * bath.displacing * abs(cage_speed) + rubbing * (1.0 + 2.0 * exponent * cage_speed * cage_speed / square)


@fused
def churning_force(speed, density, viscosity, roller_diameter, roller_length):
    """Return the drag on a roller that moves across the mixture [N], and its derivative by speed [N s/m].

    F = 0.5 rho C_d(Re) (L D_w) v |v|, against the motion; C_d is the table above, an *assumption*.

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
    log_reynolds = logarithm(reynolds)
    segment = 0
    while segment < _REYNOLDS.shape[0] - 2 and log_reynolds > _REYNOLDS[segment + 1]:
        segment += 1
    exponent = (_DRAG_COEFFICIENT[segment + 1] - _DRAG_COEFFICIENT[segment]) / (_REYNOLDS[segment + 1] - _REYNOLDS[segment])
    if log_reynolds > _REYNOLDS[-1]:  # constant beyond the table
        exponent = 0.0
        log_reynolds = _REYNOLDS[-1]
    coefficient = exponential(_DRAG_COEFFICIENT[segment] + exponent * (log_reynolds - _REYNOLDS[segment]))
    if log_reynolds >= _REYNOLDS[-1]:
        coefficient = exponential(_DRAG_COEFFICIENT[-1])
    force = 0.5 * density * coefficient * roller_length * roller_diameter * speed * magnitude
    return force, (2.0 + exponent) * force / speed


@kernel
def regime_factor(reynolds, clearance_ratio):
    """Return the torque between coaxial cylinders over Petroff's, and its exponent of speed.

    It is the largest of

        1,   1.3 (Ta/41)^0.539 (Taylor vortices),   3.0 (Re/2500)^0.856 (turbulence),    Re = rho omega R c/eta, Ta = Re sqrt(c/R),

    so that nothing jumps between the regimes.  41 is the critical Taylor number of a narrow gap whose inner cylinder turns (G. I. Taylor, Phil.
    Trans. R. Soc. A 223 (1923)); the two factors and their exponents are *assumptions*, common in dynamic models of roller bearings.

    Parameters
    ----------
    reynolds : Re.
    clearance_ratio : c/R.
    """
    factor, exponent = 1.0, 0.0
    vortices = 1.3 * power(reynolds * math.sqrt(clearance_ratio) / 41.0, 0.539)
    if vortices > factor:
        factor, exponent = vortices, 0.539
    turbulence = 3.0 * power(reynolds / 2500.0, 0.856)
    if turbulence > factor:
        factor, exponent = turbulence, 0.856
    return factor, exponent


@fused
def cylinder_torque(relative_speed, radius, clearance, width, density, viscosity):
    """Return the torque between coaxial cylinders in the mixture [N m] and its derivative by relative speed [N m s].

    Petroff's laminar torque 2 pi eta R^3 omega L/c times `regime_factor`; air without oil has none.

    Parameters
    ----------
    relative_speed : angular speed of one cylinder relative to the other [rad/s]; the torque has its sign.
    radius, clearance, width : [m].
    density, viscosity : of the mixture [kg/m^3, Pa s].
    """
    if density == 0.0:
        return 0.0, 0.0
    petroff = 2.0 * math.pi * viscosity * radius**3 * width / clearance
    reynolds = density * abs(relative_speed) * radius * clearance / viscosity
    factor, exponent = regime_factor(reynolds, clearance / radius)
    return petroff * factor * relative_speed, petroff * factor * (1.0 + exponent)


@fused
def end_face_torque(speed, outer_radius, inner_radius, density, viscosity):
    """Return the drag on both end faces of a rotating annulus [N m], against its rotation, and its derivative by speed [N m s].

    M = 0.5 rho omega^2 (R_o^5 - R_in^5) C_n, Re = rho omega R_o^2/eta: a free disc, both sides wetted.  C_n = 3.87 Re^-0.5 in laminar flow
    (W. G. Cochran, Proc. Camb. Phil. Soc. 30 (1934)) and 0.146 Re^-0.2 in turbulent flow (T. von Karman, Z. angew. Math. Mech. 1 (1921)), as in
    H. Schlichting, Boundary-Layer Theory.  The formulas meet at 3e5, where C_n jumps by 1.66; *assumption*: here it changes linearly
    between 2.5e5 and 3.5e5, and a ring's torque is the difference of two discs'.

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
    turbulent_fraction = min(max((reynolds - 2.5e5) / 1e5, 0.0), 1.0)
    coefficient = (1.0 - turbulent_fraction) * 3.87 / math.sqrt(reynolds) + turbulent_fraction * 0.146 * power(reynolds, -0.2)
    exponent = 1.5 + 0.3 * turbulent_fraction
    torque = 0.5 * density * speed * magnitude * (outer_radius**5 - inner_radius**5) * coefficient
    return torque, exponent * torque / speed


@fused
def bore_torque(cage_speed, shaft_speed, params, lubrication):
    """Return the torque of the mixture in the cage's bore, which the inner ring drives [N m], and minus its derivative by cage speed [N m s].

    Parameters as of `mixture_torque`.
    """
    radius = params.cage.inner_radius
    gap = radius - params.raceways.inner_radius
    density = mixture_density(shaft_speed, lubrication)
    return cylinder_torque(shaft_speed - cage_speed, radius, gap, params.cage.inner_width, density, lubrication.viscosity)


@fused
def mixture_torque(cage_speed, shaft_speed, params, lubrication):
    """Return the torque of the mixture on the cage [N m] and its derivative by cage speed [N m s].

    It acts on the outer cylindrical face and on the bore, which the inner ring drives, as far as they do not run on lands, and on both end
    faces (Deng 2017, section 3.1.4).

    Parameters
    ----------
    cage_speed, shaft_speed : [rad/s].
    params, lubrication : of the bearing, see `bearing_sim.model.params`.
    """
    cage, density, viscosity = params.cage, mixture_density(shaft_speed, lubrication), lubrication.viscosity
    outer_gap = params.raceways.low_radius - cage.outer_radius
    outside, d_outside = cylinder_torque(-cage_speed, cage.outer_radius, outer_gap, cage.outer_width, density, viscosity)
    inside, d_inside = bore_torque(cage_speed, shaft_speed, params, lubrication)
    faces, d_faces = end_face_torque(cage_speed, cage.outer_radius, cage.inner_radius, density, viscosity)
    return outside + inside - faces, -d_outside - d_inside - d_faces
