# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The guide lands of a cage: the film of a short journal bearing, contact where it ends, and boundary friction (Deng 2017, section 3.1.3).

Lands of the outer ring lie around the cage and rest; those of the inner ring lie in its bore, turn with the shaft and move with the
ring.  For both, only the cage's motion relative to the ring matters.

Symbols: e eccentricity of the cage in the lands [m], c their clearance [m], eps = e/c, R_g their radius [m], L_g width of both lands together
[m], eta_0 viscosity of the oil [Pa s], omega_c and omega_ring speeds of cage and ring [rad/s].
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.physics.contact import EXPONENT, damping_factor
from bearing_sim.physics.drag import regime_factor

_WEDGE = 10.0  # rad/s; assumption: the film's half-circle changes sides smoothly where the wedge speed changes sign
_SLIDING = 0.1  # m/s; assumption: boundary friction is proportional to the sliding speed well below this


@kernel
def _land_regime(turning, lubrication, cage):
    """Return the torque of lands that turn against the cage over the laminar one, and its exponent of speed; 1 and 0 of laminar lands.

    `bearing_sim.physics.drag.regime_factor` with the film of a concentric land; *assumption*: an eccentric one begins to whirl in vortices
    there, too.

    Parameters
    ----------
    turning : speed of one surface relative to the other [rad/s].
    lubrication : `bearing_sim.model.params.Lubrication`.
    cage : `bearing_sim.model.params.CageBody`.
    """
    if not cage.land_vortices:
        return 1.0, 0.0
    clearance, radius = cage.guide_clearance, cage.guide_radius
    return regime_factor(lubrication.density * abs(turning) * radius * clearance / lubrication.viscosity, clearance / radius)


@kernel
def land_torque(cage_speed, ring_speed, eccentricity_ratio, lubrication, cage):
    """Return the torque of the oil in the guide lands on the cage [N m] and its derivative by cage speed [N m s].

    M = 2 pi eta_0 V R_g^2 L_g/(c sqrt(1 - eps^2)), V = R_g (omega_ring - omega_c) (Deng 2017, section 3.1.3): Petroff's torque of an
    eccentric journal, the land full of oil; laminar, or with vortices and turbulence where ``land_vortices`` is true.

    Parameters
    ----------
    cage_speed, ring_speed : omega_c and omega_ring [rad/s].
    eccentricity_ratio : eps, below 1.
    lubrication : `bearing_sim.model.params.Lubrication`.
    cage : `bearing_sim.model.params.CageBody`.
    """
    slope = (
        2.0
        * math.pi
        * lubrication.viscosity
        * cage.guide_radius**3
        * cage.guide_width
        / (cage.guide_clearance * math.sqrt(1.0 - eccentricity_ratio * eccentricity_ratio))
    )
    factor, exponent = _land_regime(ring_speed - cage_speed, lubrication, cage)
    slope *= factor
    return slope * (ring_speed - cage_speed), -slope * (1.0 + exponent)


class Land(NamedTuple):
    """How a cage lies in its guide lands: its centre seen from that of the ring whose lands they are."""

    y: float  # [m]
    z: float
    y_speed: float  # [m/s]
    z_speed: float
    cage_speed: float  # omega [rad/s]
    ring_speed: float  # [rad/s]


@kernel
def _film_coefficients(eccentricity, cage):
    """Return five functions of the eccentricity ratio eps, each followed by its derivative by e [1/m].

    Those of `land_film` in this order: entrainment inwards and across, squeeze inwards and across, and 1/sqrt(1 - eps^2).  Films
    thinner than ``cage.land_film`` touch and stiffen no further.
    """
    clearance = cage.guide_clearance
    thinnest = max(1.0 - cage.land_film / clearance, 0.0)
    ratio = eccentricity / clearance
    changing = 1.0 / clearance
    if ratio > thinnest:  # thinner films touch, and stiffen no more
        ratio, changing = thinnest, 0.0
    rest = 1.0 - ratio * ratio
    root = math.sqrt(rest)
    square, cube = rest * rest, rest * root
    inwards, d_inwards = ratio / square, (1.0 + 3.0 * ratio * ratio) / (square * rest)
    across, d_across = 0.25 * math.pi / cube, 0.75 * math.pi * ratio / (cube * rest)
    press, d_press = (
        0.5 * math.pi * (1.0 + 2.0 * ratio * ratio) / (square * root),
        1.5 * math.pi * ratio * (3.0 + 2.0 * ratio * ratio) / (square * cube),
    )
    shift, d_shift = 2.0 * ratio / square, (2.0 + 6.0 * ratio * ratio) / (square * rest)
    drag, d_drag = 1.0 / root, ratio / cube
    return (
        inwards, d_inwards * changing, across, d_across * changing, press, d_press * changing,
        shift, d_shift * changing, drag, d_drag * changing,
    )  # fmt: skip


@fused
def land_film(land, squeeze, cage, lubrication):
    """Return forces y, z [N] and torque [N m] of the guide lands' film on the cage, then their derivatives by y, z, y', z' and omega_c (3 rows of 5).

    Short journal bearing with half a film: F. W. Ocvirk, NACA TN 2808 (1952), and G. B. DuBois, F. W. Ocvirk, NACA Report 1157 (1953), for a
    centre at rest; with its motion as in D. Childs, Turbomachinery Rotordynamics (1993), section 3.4.  Two lands of width L = L_g/2, forces per
    eta_0 R_g L^3/c^2:

        inwards  |X| eps/(1 - eps^2)^2 + (pi/2)(1 + 2 eps^2)/(1 - eps^2)^2.5 e'/c
        across   pi/4 X/(1 - eps^2)^1.5 + 2 eps sign(X)/(1 - eps^2)^2 e'/c,     X = eps (omega_c + omega_ring - 2 psi')

    for a cage that moves outwards by e' and whirls by psi', both relative to the ring's centre; ``across`` is ahead of the eccentricity in the
    direction of rotation.  Which of both bodies is the journal does not matter.  A film that whirls at the mean speed of both surfaces has
    no wedge left, which is what limits the whirl.  Deng 2017, section 3.1.3, is the film of a centre at rest, X = eps (omega_c + omega_ring)
    and e' = 0 (``land_squeeze: false``).  The torque is that of `land_torque`: both surfaces share it, and what the force's lever across the
    eccentricity adds, a thousandth of it, is given to the ring (see `bearing_sim.levels.planar.power`).

    Range: L small against R_g, isoviscous, and a film that is full over the half-circle where the wedge or the approach fills it.  Forces are
    those of a laminar film; vortices and turbulence change the torque alone.

    Parameters
    ----------
    land : `Land`.
    squeeze : 1 for the film of a moving centre, 0 for Deng's, of a centre at rest.
    cage : `bearing_sim.model.params.CageBody`.
    lubrication : `bearing_sim.model.params.Lubrication`.
    """
    viscosity = lubrication.viscosity
    entraining, turning = land.cage_speed + land.ring_speed, land.cage_speed - land.ring_speed
    clearance, radius, width = cage.guide_clearance, cage.guide_radius, 0.5 * cage.guide_width
    unit = viscosity * radius * 2.0 * width**3 / (clearance * clearance)
    eccentricity = math.sqrt(land.y * land.y + land.z * land.z)
    n_y, n_z = 1.0, 0.0
    if eccentricity > 1e-9 * clearance:
        n_y, n_z = land.y / eccentricity, land.z / eccentricity
    turn = 1.0 / max(eccentricity, 1e-9 * clearance)
    moving = squeeze / clearance
    outwards = n_y * land.y_speed + n_z * land.z_speed
    along = n_y * land.z_speed - n_z * land.y_speed
    inwards, inwards_e, across, across_e, press, press_e, shift, shift_e, drag, drag_e = _film_coefficients(eccentricity, cage)
    wedge = eccentricity / clearance * entraining - 2.0 * moving * along
    root = math.sqrt(wedge * wedge + _WEDGE * _WEDGE)
    side, d_side = wedge / root, _WEDGE * _WEDGE / (root * root * root)
    size, d_size = wedge * side, side + wedge * d_side
    rate = moving * outwards
    f_in = unit * (inwards * size + press * rate)
    f_across = unit * (across * wedge + shift * side * rate)
    # by eccentricity, outward speed, speed along and omega
    in_wedge, across_wedge = unit * inwards * d_size, unit * (across + shift * d_side * rate)
    in_e = unit * (inwards_e * size + press_e * rate) + in_wedge * entraining / clearance
    across_d_e = unit * (across_e * wedge + shift_e * side * rate) + across_wedge * entraining / clearance
    in_out, across_out = unit * press * moving, unit * shift * side * moving
    in_along, across_along = -2.0 * moving * in_wedge, -2.0 * moving * across_wedge
    in_omega, across_omega = in_wedge * eccentricity / clearance, across_wedge * eccentricity / clearance
    # as the centre moves across, the frame turns by 1/e and sees the speeds turned
    in_t = turn * (in_out * along - in_along * outwards)
    across_t = turn * (across_out * along - across_along * outwards)
    n_n, t_n, n_t, t_t = -in_e, across_d_e, -in_t - f_across * turn, across_t - f_in * turn
    regime, exponent = _land_regime(turning, lubrication, cage)
    friction = -2.0 * math.pi * viscosity * radius**3 * cage.guide_width / clearance * regime
    torque = friction * drag * turning
    return (
        -f_in * n_y - f_across * n_z, -f_in * n_z + f_across * n_y, torque,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[:2], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[:2],
        -in_omega * n_y - across_omega * n_z,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[2:], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[2:],
        -in_omega * n_z + across_omega * n_y,
        friction * drag_e * turning * n_y, friction * drag_e * turning * n_z, 0.0, 0.0, friction * drag * (1.0 + exponent),
    )  # fmt: skip


@kernel
def _in_plane(n_n, t_n, n_t, t_t, n_y, n_z):
    """Return yy, yz, zy, zz of a matrix that is n_n, n_t; t_n, t_t in the frame of the eccentricity."""
    return (
        n_n * n_y * n_y - (n_t + t_n) * n_y * n_z + t_t * n_z * n_z,
        (n_n - t_t) * n_y * n_z + n_t * n_y * n_y - t_n * n_z * n_z,
        (n_n - t_t) * n_y * n_z + t_n * n_y * n_y - n_t * n_z * n_z,
        n_n * n_z * n_z + (n_t + t_n) * n_y * n_z + t_t * n_y * n_y,
    )


@fused
def land_contact(land, params):
    """Return the contact force of cage and land, its derivatives, and how they approach.

    Q = K delta^(10/9) (1 + d delta'), delta = e - (c - h_0), as between rollers and raceways (`bearing_sim.physics.contact`): films thinner than
    h_0 = ``cage.land_film`` touch.  *Assumption*: line contact with the raceways' K and damping stands for that of two lands.

    Parameters
    ----------
    land : `Land`.
    params : of the bearing.

    Returns
    -------
    force on the cage towards the ring's centre [N], d_eccentricity [N/m], d_rate [N s/m], eccentricity [m], its rate [m/s]
    """
    cage = params.cage
    eccentricity = math.sqrt(land.y * land.y + land.z * land.z)
    depth = eccentricity - (cage.guide_clearance - cage.land_film)
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, 0.0
    rate = (land.y * land.y_speed + land.z * land.z_speed) / eccentricity
    root = params.raceways.stiffness * depth ** (1.0 / 9.0)
    per_rate, slope = damping_factor(depth, params.raceways.damping)
    factor = 1.0 + per_rate * rate
    if factor <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, rate
    return root * depth * factor, root * (EXPONENT * factor + depth * slope * rate), root * depth * per_rate, eccentricity, rate


@kernel
def land_friction(sliding, coefficient):
    """Return the coefficient of boundary friction with the sign of the sliding speed, mu s/sqrt(s^2 + s_0^2), and its derivative [s/m].

    *Assumption*: mu (0.08 by default) and s_0 = 0.1 m/s, which only makes the law smooth through s = 0.

    Parameters
    ----------
    sliding : s, speed of the cage's surface less that of the ring's [m/s].
    coefficient : mu.
    """
    smooth = math.sqrt(sliding * sliding + _SLIDING * _SLIDING)
    return coefficient * sliding / smooth, coefficient * _SLIDING * _SLIDING / (smooth * smooth * smooth)
