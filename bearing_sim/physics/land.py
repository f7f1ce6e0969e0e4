# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The guide land of a cage that rotates and whirls: the film of a short journal bearing, and contact where it ends.

Lands of the outer ring lie around the cage and rest; those of the inner ring lie in its bore, turn with the shaft and move with the
ring.  For both, what counts is how the cage moves against the ring.
"""

import math
from typing import NamedTuple

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z

_WEDGE = 10.0  # rad/s; the film's half-circle changes sides smoothly where the wedge speed changes sign


class Land(NamedTuple):
    """How a cage lies in its guide lands: its centre seen from that of the ring whose lands they are."""

    y: float  # [m]
    z: float
    y_speed: float  # [m/s]
    z_speed: float
    cage_speed: float  # omega [rad/s]
    ring_speed: float  # [rad/s]


@kernel
def place_in_lands(y, shaft_speed, cage):
    """Return `Land` of a state.

    Parameters
    ----------
    y : state of level ``planar``, its border at least.
    shaft_speed : [rad/s].
    cage : `bearing_sim.params.CageBody`.
    """
    turning = cage.guidance.turning
    return Land(
        y[CAGE_Y] - turning * y[RING_Y],
        y[CAGE_Z] - turning * y[RING_Z],
        y[BORDER + CAGE_Y] - turning * y[BORDER + RING_Y],
        y[BORDER + CAGE_Z] - turning * y[BORDER + RING_Z],
        y[OMEGA],
        turning * shaft_speed,
    )


@kernel
def _film_coefficients(eccentricity, cage):
    """Return, by eccentricity and each with its slope: entrainment inwards and across, squeeze inwards and across, 1/sqrt(1 - eps^2)."""
    clearance = cage.guide_clearance
    thinnest = max(1.0 - cage.land_film / clearance, 0.0)
    ratio = eccentricity / clearance
    changing = 1.0 / clearance
    if ratio > thinnest:  # thinner films touch, and stiffen no more
        ratio, changing = thinnest, 0.0
    rest = 1.0 - ratio * ratio
    root = math.sqrt(rest)
    square, cube = rest * rest, rest * root
    inwards, inwards_slope = ratio / square, (1.0 + 3.0 * ratio * ratio) / (square * rest)
    across, across_slope = 0.25 * math.pi / cube, 0.75 * math.pi * ratio / (cube * rest)
    press, press_slope = (
        0.5 * math.pi * (1.0 + 2.0 * ratio * ratio) / (square * root),
        1.5 * math.pi * ratio * (3.0 + 2.0 * ratio * ratio) / (square * cube),
    )
    shift, shift_slope = 2.0 * ratio / square, (2.0 + 6.0 * ratio * ratio) / (square * rest)
    drag, drag_slope = 1.0 / root, ratio / cube
    return (
        inwards, inwards_slope * changing, across, across_slope * changing, press, press_slope * changing,
        shift, shift_slope * changing, drag, drag_slope * changing,
    )  # fmt: skip


@kernel
def land_film(land, cage, viscosity):
    """Return forces y, z [N] and torque [N m] of the guide lands' film on the cage, then their derivatives by y, z, y', z' and omega (3 rows of 5).

    Short journal bearing with half a film (Ocvirk 1953; Childs 1993, section 3.4), two lands of width L, eps = e/c, per
    eta R L^3/c^2:

        inwards  |X| eps/(1 - eps^2)^2 + (pi/2)(1 + 2 eps^2)/(1 - eps^2)^2.5 e'/c
        across   pi/4 X/(1 - eps^2)^1.5 + 2 eps sign(X)/(1 - eps^2)^2 e'/c,     X = eps (omega + omega_ring - 2 psi')

    for a cage whose centre moves by e' outwards and whirls by psi', both seen from the ring's centre.  It does not matter which of
    both is the journal.  A film that is carried round by the whirl at the mean speed of both surfaces has no wedge left: it is
    what keeps the whirl from going faster.  Deng 2017, section 3.1.3, has the film of a cage whose centre rests, X = eps (omega +
    omega_ring) and e' = 0 (``land_squeeze: false``).  The torque is his: both surfaces share it, and what the force's way across
    the eccentricity adds, a thousandth of it, is the ring's (see `bearing_sim.levels.planar_power`).

    Parameters
    ----------
    land : `Land`.
    cage : `bearing_sim.params.CageBody`.
    viscosity : of the oil [Pa s].
    """
    entraining, turning = land.cage_speed + land.ring_speed, land.cage_speed - land.ring_speed
    clearance, radius, width = cage.guide_clearance, cage.guide_radius, 0.5 * cage.guide_width
    unit = viscosity * radius * 2.0 * width**3 / (clearance * clearance)
    eccentricity = math.sqrt(land.y * land.y + land.z * land.z)
    n_y, n_z = 1.0, 0.0
    if eccentricity > 1e-9 * clearance:
        n_y, n_z = land.y / eccentricity, land.z / eccentricity
    turn = 1.0 / max(eccentricity, 1e-9 * clearance)
    moving = cage.land_squeeze / clearance
    outwards = n_y * land.y_speed + n_z * land.z_speed
    along = n_y * land.z_speed - n_z * land.y_speed
    inwards, inwards_e, across, across_e, press, press_e, shift, shift_e, drag, drag_e = _film_coefficients(eccentricity, cage)
    wedge = eccentricity / clearance * entraining - 2.0 * moving * along
    root = math.sqrt(wedge * wedge + _WEDGE * _WEDGE)
    side, side_slope = wedge / root, _WEDGE * _WEDGE / (root * root * root)
    size, size_slope = wedge * side, side + wedge * side_slope
    rate = moving * outwards
    f_in = unit * (inwards * size + press * rate)
    f_across = unit * (across * wedge + shift * side * rate)
    # by eccentricity, outward speed, speed along and omega
    in_wedge, across_wedge = unit * inwards * size_slope, unit * (across + shift * side_slope * rate)
    in_e = unit * (inwards_e * size + press_e * rate) + in_wedge * entraining / clearance
    across_by_e = unit * (across_e * wedge + shift_e * side * rate) + across_wedge * entraining / clearance
    in_out, across_out = unit * press * moving, unit * shift * side * moving
    in_along, across_along = -2.0 * moving * in_wedge, -2.0 * moving * across_wedge
    in_omega, across_omega = in_wedge * eccentricity / clearance, across_wedge * eccentricity / clearance
    # as the centre moves across, the frame turns by 1/e and sees the speeds turned
    in_t = turn * (in_out * along - in_along * outwards)
    across_t = turn * (across_out * along - across_along * outwards)
    n_n, t_n, n_t, t_t = -in_e, across_by_e, -in_t - f_across * turn, across_t - f_in * turn
    friction = -2.0 * math.pi * viscosity * radius**3 * cage.guide_width / clearance
    torque = friction * drag * turning
    return (
        -f_in * n_y - f_across * n_z, -f_in * n_z + f_across * n_y, torque,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[:2], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[:2],
        -in_omega * n_y - across_omega * n_z,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[2:], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[2:],
        -in_omega * n_z + across_omega * n_y,
        friction * drag_e * turning * n_y, friction * drag_e * turning * n_z, 0.0, 0.0, friction * drag,
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


@kernel
def land_contact(land, params):
    """Force on the cage towards the ring's centre [N] where both touch, with its slopes by eccentricity and its rate; and both.

    Parameters
    ----------
    land : `Land`.
    params : of the bearing.
    """
    cage = params.cage
    eccentricity = math.sqrt(land.y * land.y + land.z * land.z)
    depth = eccentricity - (cage.guide_clearance - cage.land_film)
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, 0.0
    rate = (land.y * land.y_speed + land.z * land.z_speed) / eccentricity
    root = params.raceways.stiffness * depth ** (1.0 / 9.0)
    damping = 1.0 + params.ring.contact_damping * rate
    if damping <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, rate
    return root * depth * damping, 10.0 / 9.0 * root * damping, root * depth * params.ring.contact_damping, eccentricity, rate
