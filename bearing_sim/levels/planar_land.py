"""The guide land under a cage that rotates and whirls: the film of a short journal bearing, and contact where it ends."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA

_WEDGE = 10.0  # rad/s; the film's half-circle changes sides smoothly where the wedge speed changes sign


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
def land_film(y, params, viscosity):
    """Return forces y, z [N] and torque [N m] of the guide lands' film, then their derivatives by cage y, z, y', z' and omega (3 rows of 5).

    Short journal bearing with half a film (Ocvirk 1953; Childs 1993, section 3.4), two lands of width L, eps = e/c, per
    eta R L^3/c^2:

        inwards  |X| eps/(1 - eps^2)^2 + (pi/2)(1 + 2 eps^2)/(1 - eps^2)^2.5 e'/c
        across   pi/4 X/(1 - eps^2)^1.5 + 2 eps sign(X)/(1 - eps^2)^2 e'/c,     X = eps (omega - 2 psi')

    for a cage whose centre moves by e' outwards and whirls by psi'.  A film that is carried round by the whirl at half the
    cage's speed has no wedge left: it is what keeps the whirl from going faster.  Deng 2017, section 3.1.3, has the film of a
    cage whose centre rests, X = eps omega and e' = 0 (``land_squeeze: false``).
    """
    cage = params.cage
    omega, clearance, radius, width = y[OMEGA], cage.guide_clearance, cage.guide_radius, 0.5 * cage.guide_width
    unit = viscosity * radius * 2.0 * width**3 / (clearance * clearance)
    eccentricity = math.sqrt(y[CAGE_Y] * y[CAGE_Y] + y[CAGE_Z] * y[CAGE_Z])
    n_y, n_z = 1.0, 0.0
    if eccentricity > 1e-9 * clearance:
        n_y, n_z = y[CAGE_Y] / eccentricity, y[CAGE_Z] / eccentricity
    turn = 1.0 / max(eccentricity, 1e-9 * clearance)
    moving = cage.land_squeeze / clearance
    outwards = n_y * y[BORDER + CAGE_Y] + n_z * y[BORDER + CAGE_Z]
    along = n_y * y[BORDER + CAGE_Z] - n_z * y[BORDER + CAGE_Y]
    inwards, inwards_e, across, across_e, press, press_e, shift, shift_e, drag, drag_e = _film_coefficients(eccentricity, cage)
    wedge = eccentricity / clearance * omega - 2.0 * moving * along
    root = math.sqrt(wedge * wedge + _WEDGE * _WEDGE)
    side, side_slope = wedge / root, _WEDGE * _WEDGE / (root * root * root)
    size, size_slope = wedge * side, side + wedge * side_slope
    rate = moving * outwards
    f_in = unit * (inwards * size + press * rate)
    f_across = unit * (across * wedge + shift * side * rate)
    # by eccentricity, outward speed, speed along and omega
    in_wedge, across_wedge = unit * inwards * size_slope, unit * (across + shift * side_slope * rate)
    in_e = unit * (inwards_e * size + press_e * rate) + in_wedge * omega / clearance
    across_by_e = unit * (across_e * wedge + shift_e * side * rate) + across_wedge * omega / clearance
    in_out, across_out = unit * press * moving, unit * shift * side * moving
    in_along, across_along = -2.0 * moving * in_wedge, -2.0 * moving * across_wedge
    in_omega, across_omega = in_wedge * eccentricity / clearance, across_wedge * eccentricity / clearance
    # as the centre moves across, the frame turns by 1/e and sees the speeds turned
    in_t = turn * (in_out * along - in_along * outwards)
    across_t = turn * (across_out * along - across_along * outwards)
    n_n, t_n, n_t, t_t = -in_e, across_by_e, -in_t - f_across * turn, across_t - f_in * turn
    friction = -2.0 * math.pi * viscosity * radius**3 * cage.guide_width / clearance
    torque = friction * drag * omega
    return (
        -f_in * n_y - f_across * n_z, -f_in * n_z + f_across * n_y, torque,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[:2], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[:2],
        -in_omega * n_y - across_omega * n_z,
        *_in_plane(n_n, t_n, n_t, t_t, n_y, n_z)[2:], *_in_plane(-in_out, across_out, -in_along, across_along, n_y, n_z)[2:],
        -in_omega * n_z + across_omega * n_y,
        friction * drag_e * omega * n_y, friction * drag_e * omega * n_z, 0.0, 0.0, friction * drag,
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
def land_contact(y, params):
    """Force towards the centre [N] where the cage touches its land, with its slopes by eccentricity and its rate; and both."""
    cage = params.cage
    eccentricity = math.sqrt(y[CAGE_Y] * y[CAGE_Y] + y[CAGE_Z] * y[CAGE_Z])
    depth = eccentricity - (cage.guide_clearance - cage.land_film)
    if depth <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, 0.0
    rate = (y[CAGE_Y] * y[BORDER + CAGE_Y] + y[CAGE_Z] * y[BORDER + CAGE_Z]) / eccentricity
    root = params.raceways.stiffness * depth ** (1.0 / 9.0)
    damping = 1.0 + params.ring.contact_damping * rate
    if damping <= 0.0:
        return 0.0, 0.0, 0.0, eccentricity, rate
    return root * depth * damping, 10.0 / 9.0 * root * damping, root * depth * params.ring.contact_damping, eccentricity, rate
