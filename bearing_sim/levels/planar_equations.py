"""Equations of motion in the plane: every roller, the cage with its pockets and guide land, the inner ring.

Deng 2017, eq. 14 to 16, with the exact directions about the displaced inner ring.

State: y = (positions of the border, speeds of the border, then r, phi, r', phi', w of each roller); the border is inner ring
y and z, cage y, z and angle.  A roller sees 15 variables: its own five, the border's five positions and five speeds; all
derivatives are rows over these.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.raceway import contour_at
from bearing_sim.kernels.traction import FILM, traction
from bearing_sim.levels.inputs import load_at, shaft_speed_at
from bearing_sim.levels.mixture import mixture_torque
from bearing_sim.levels.planar_algebra import BLOCK, BORDER, LOCAL, Factored, new_factored

RING_Y, RING_Z, CAGE_Y, CAGE_Z, THETA = 0, 1, 2, 3, 4
OMEGA = BORDER + THETA
R, PHI, R_SPEED, PHI_SPEED, SPIN = 0, 1, 2, 3, 4
FRICTION_SPIN = 10.0  # rad/s; friction is proportional to the speed well below this
_LAND_SLIDING = 0.1  # m/s; likewise at the guide land
_TINY = 1e-15  # m


class RollerRow(NamedTuple):
    """Rows of the rollers array, shape (len(ROLLER), Z)."""

    cosine: int = 0  # of the roller's azimuth
    sine: int = 1
    pocket_sine: int = 2  # of the angle from the pocket to the roller
    pocket_cosine: int = 3
    normal_r: int = 4  # direction from the ring's centre to the roller's, in the roller's frame
    normal_t: int = 5
    distance: int = 6  # of both centres [m]
    speed_normal: int = 7  # of the roller's centre seen from the ring's [m/s]
    speed_tangent: int = 8
    contour: int = 9  # R_e [m]
    slope: int = 10  # dR_e/dphi [m/rad]
    curvature: int = 11  # d2R_e/dphi2 [m/rad^2]
    inner_penetration: int = 12  # [m]
    outer_penetration: int = 13
    inner_rate: int = 14  # its time derivative [m/s]
    outer_rate: int = 15
    inner_root: int = 16  # penetration^(1/9)
    outer_root: int = 17
    inner_load: int = 18  # Q_i [N]
    outer_load: int = 19  # Q_e [N]
    pocket_force: int = 20  # of the pocket's wall on the roller along the orbit [N]
    pocket_offset: int = 21  # of the roller from the middle of its pocket [m]
    log: int = 22


ROLLER = RollerRow()


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    rollers: np.ndarray  # rows `ROLLER`
    film: np.ndarray  # rows `bearing_sim.kernels.traction.FILM`, shape (15, 2 Z)
    pitch: np.ndarray  # rows cosine, sine and angle of 2 pi j/Z
    gradient: np.ndarray  # scratch, shape (12, 15)
    roller_rows: np.ndarray  # derivatives of r'', phi'', w' of each roller, shape (Z, 3, 15)
    border_rows: np.ndarray  # derivatives of the border's accelerations through each roller, shape (Z, 5, 15)
    border_own: np.ndarray  # derivatives of the border's accelerations by border positions and speeds, shape (5, 10)
    factored: Factored  # of I - gamma h J
    powers: np.ndarray  # running means of Q_i^4 and Q_e^4.5 over a cage turn, shape (2,)
    held: np.ndarray  # shift of the factorisation at hand [s], shape (1,)
    counts: np.ndarray  # Newton iterations and factorisations, int64


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    angles = 2 * math.pi * np.arange(count) / count
    return Work(
        np.zeros((len(ROLLER), count)),
        np.zeros((len(FILM), 2 * count)),
        np.array([np.cos(angles), np.sin(angles), angles]),
        np.zeros((12, LOCAL)),
        np.zeros((count, 3, LOCAL)),
        np.zeros((count, BORDER, LOCAL)),
        np.zeros((BORDER, 2 * BORDER)),
        new_factored(count),
        np.zeros(2),
        np.zeros(1),
        np.zeros(2, np.int64),
    )


@kernel
def place_rollers(y, params, work):
    """Write directions, penetrations and their rates of all rollers into ``work.rollers``."""
    rows, raceways, roller_radius = work.rollers, params.raceways, params.rollers.radius
    intervals = raceways.contour.shape[0]
    cage_cosine, cage_sine = math.cos(y[THETA]), math.sin(y[THETA])
    ring_y, ring_z, ring_y_speed, ring_z_speed = y[RING_Y], y[RING_Z], y[BORDER + RING_Y], y[BORDER + RING_Z]
    for j in range(rows.shape[1]):
        first = 2 * BORDER + BLOCK * j
        radius, phi, radius_speed, phi_speed = y[first], y[first + PHI], y[first + R_SPEED], y[first + PHI_SPEED]
        pocket_cosine = cage_cosine * work.pitch[0, j] - cage_sine * work.pitch[1, j]
        pocket_sine = cage_sine * work.pitch[0, j] + cage_cosine * work.pitch[1, j]
        play = phi - y[THETA] - work.pitch[2, j]
        if abs(play) < 0.05:
            # Taylor series: a roller is never far from its pocket, and this is a third of the library's time
            p = play * play
            play_sine = play * (1.0 - p / 6.0 * (1.0 - p / 20.0 * (1.0 - p / 42.0 * (1.0 - p / 72.0))))
            play_cosine = 1.0 - 0.5 * p * (1.0 - p / 12.0 * (1.0 - p / 30.0 * (1.0 - p / 56.0)))
        else:
            play_sine, play_cosine = math.sin(play), math.cos(play)
        cosine = pocket_cosine * play_cosine - pocket_sine * play_sine
        sine = pocket_sine * play_cosine + pocket_cosine * play_sine
        along, across = ring_y * cosine + ring_z * sine, -ring_y * sine + ring_z * cosine
        distance = math.sqrt((radius - along) * (radius - along) + across * across)
        normal_r, normal_t = (radius - along) / distance, -across / distance
        speed_r = radius_speed - (ring_y_speed * cosine + ring_z_speed * sine)
        speed_t = radius * phi_speed - (-ring_y_speed * sine + ring_z_speed * cosine)
        turns = phi / (2.0 * math.pi)
        position = (turns - math.floor(turns)) * intervals
        contour, slope = contour_at(raceways.contour, position)
        index = min(int(position), intervals - 1)
        x = (position - index) * (2.0 * math.pi / intervals)
        rows[ROLLER.curvature, j] = 6.0 * raceways.contour[index, 0] * x + 2.0 * raceways.contour[index, 1]
        rows[ROLLER.cosine, j] = cosine
        rows[ROLLER.sine, j] = sine
        rows[ROLLER.pocket_cosine, j] = play_cosine
        rows[ROLLER.pocket_sine, j] = play_sine
        rows[ROLLER.normal_r, j] = normal_r
        rows[ROLLER.normal_t, j] = normal_t
        rows[ROLLER.distance, j] = distance
        rows[ROLLER.speed_normal, j] = normal_r * speed_r + normal_t * speed_t
        rows[ROLLER.speed_tangent, j] = normal_r * speed_t - normal_t * speed_r
        rows[ROLLER.contour, j] = contour
        rows[ROLLER.slope, j] = slope
        rows[ROLLER.inner_penetration, j] = raceways.inner_radius + roller_radius - distance
        rows[ROLLER.outer_penetration, j] = radius + roller_radius - contour
        rows[ROLLER.inner_rate, j] = -(normal_r * speed_r + normal_t * speed_t)
        rows[ROLLER.outer_rate, j] = radius_speed - slope * phi_speed


@kernel
def normal_loads(params, work):
    """Write normal forces with Hunt-Crossley damping, Q (1 + a d(delta)/dt) and never pulling, into ``work.rollers``."""
    rows, stiffness, damping = work.rollers, params.raceways.stiffness, params.ring.contact_damping
    for j in range(rows.shape[1]):
        rows[ROLLER.log, j] = logarithm(max(rows[ROLLER.inner_penetration, j], _TINY))
    for j in range(rows.shape[1]):
        rows[ROLLER.inner_root, j] = exponential(rows[ROLLER.log, j] / 9.0)
    for j in range(rows.shape[1]):
        rows[ROLLER.log, j] = logarithm(max(rows[ROLLER.outer_penetration, j], _TINY))
    for j in range(rows.shape[1]):
        rows[ROLLER.outer_root, j] = exponential(rows[ROLLER.log, j] / 9.0)
    for j in range(rows.shape[1]):
        inner, outer = max(rows[ROLLER.inner_penetration, j], 0.0), max(rows[ROLLER.outer_penetration, j], 0.0)
        rows[ROLLER.inner_load, j] = stiffness * rows[ROLLER.inner_root, j] * inner * max(1.0 + damping * rows[ROLLER.inner_rate, j], 0.0)
        rows[ROLLER.outer_load, j] = stiffness * rows[ROLLER.outer_root, j] * outer * max(1.0 + damping * rows[ROLLER.outer_rate, j], 0.0)


@kernel
def tractions(shaft_speed, y, model, work):
    """Write the tangential forces of both raceways into ``work.film``."""
    rows, film, count = work.rollers, work.film, work.rollers.shape[1]
    roller_radius, inner_radius = model.params.rollers.radius, model.params.raceways.inner_radius
    for j in range(rows.shape[1]):
        first = 2 * BORDER + BLOCK * j
        radius, phi_speed, surface = y[first], y[first + PHI_SPEED], y[first + SPIN] * roller_radius
        roller_rolling = surface + phi_speed * roller_radius
        film[FILM.rolling, j] = 0.5 * ((shaft_speed - phi_speed) * inner_radius + roller_rolling)
        film[FILM.sliding, j] = shaft_speed * inner_radius - rows[ROLLER.speed_tangent, j] - surface
        film[FILM.rolling, count + j] = 0.5 * (phi_speed * (radius + roller_radius) + roller_rolling)
        film[FILM.sliding, count + j] = surface - radius * phi_speed
        film[FILM.load, j] = rows[ROLLER.inner_load, j]
        film[FILM.load, count + j] = rows[ROLLER.outer_load, j]
    traction(film, model.lubrication.inner, model.lubrication.outer)


@template
def pocket_force(offset, rate, cage, contact_stiffness, contact_damping):
    """Return the force of a pocket against a roller's offset [N] and its slopes by offset and rate.

    The film's spring until the clearance is used up, then line contact on top of it (Deng 2017, eq. 10, made continuous).
    """
    magnitude = abs(offset)
    sign = 1.0 if offset >= 0.0 else -1.0
    force = cage.pocket_stiffness * offset + cage.pocket_damping * rate
    by_offset, by_rate = cage.pocket_stiffness, cage.pocket_damping
    excess = magnitude - cage.pocket_clearance
    if excess > 0.0:
        root = contact_stiffness * excess ** (1.0 / 9.0)
        damping = 1.0 + contact_damping * rate * sign
        force -= sign * cage.pocket_stiffness * excess
        by_offset = 0.0
        if damping > 0.0:
            force += sign * root * excess * damping
            by_offset += 10.0 / 9.0 * root * damping
            by_rate += root * excess * contact_damping
    return force, by_offset, by_rate


@kernel
def _land(y, params, viscosity):
    """Forces y, z [N] and torque [N m] of guide land and their derivatives by cage y, z, and speeds y, z, omega (3 rows of 5).

    A short journal bearing (Deng 2017, section 3.1.3) whose film goes over into line contact with boundary friction where it
    is thinner than 3 um, so that no load brings the eccentricity to 1.
    """
    cage = params.cage
    cage_y, cage_z, omega = y[CAGE_Y], y[CAGE_Z], y[OMEGA]
    clearance, radius = cage.guide_clearance, cage.guide_radius
    squared = (cage_y * cage_y + cage_z * cage_z) / (clearance * clearance)
    thinnest = max(1.0 - cage.land_film / clearance, 0.0)
    touching = squared > thinnest * thinnest
    q = thinnest * thinnest if touching else squared
    by_q = 0.0 if touching else 2.0 / (clearance * clearance)  # dq/dy = by_q y
    rest = 1.0 - q
    root, width = math.sqrt(rest), 0.5 * cage.guide_width
    entraining = viscosity * radius * omega * 2.0 * width**3 / clearance**3
    towards, across = math.sqrt(q) / (rest * rest), math.pi / (4.0 * rest * root)
    towards_slope = 0.5 / math.sqrt(max(q, 1e-12)) / (rest * rest) + 2.0 * math.sqrt(q) / (rest * rest * rest)
    across_slope = 1.5 * math.pi / (4.0 * rest * rest * root)
    drag = 2.0 * math.pi * viscosity * radius**3 * cage.guide_width / (clearance * root)
    sense = 1.0 if omega >= 0.0 else -1.0
    f_y = -sense * towards * cage_y - across * cage_z
    f_z = -sense * towards * cage_z + across * cage_y
    own = (-sense * towards * entraining, across * entraining)
    slope_y = (-sense * towards_slope * cage_y - across_slope * cage_z) * entraining * by_q
    slope_z = (-sense * towards_slope * cage_z + across_slope * cage_y) * entraining * by_q
    unit = entraining / omega if omega != 0.0 else viscosity * radius * 2.0 * width**3 / clearance**3
    return (
        f_y * entraining, f_z * entraining, -drag * omega,
        own[0] + slope_y * cage_y, -own[1] + slope_y * cage_z, f_y * unit,
        own[1] + slope_z * cage_y, own[0] + slope_z * cage_z, f_z * unit,
        -drag * omega * 0.5 * by_q / rest * cage_y, -drag * omega * 0.5 * by_q / rest * cage_z, -drag,
    )  # fmt: skip


@kernel
def _land_contact(y, params):
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


@kernel
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, drive, own = model.params, model.drive, work.border_own
    cage = params.cage
    load_y, load_z = load_at(t, drive)
    rate[BORDER + RING_Y], rate[BORDER + RING_Z] = load_y / params.ring.mass, load_z / params.ring.mass
    f_y, f_z, m, yy, yz, yo, zy, zz, zo, my, mz, mo = _land(y, params, model.lubrication.viscosity)
    drag, drag_slope = mixture_torque(y[OMEGA], shaft_speed_at(t, drive), params, model.lubrication)
    contact, by_depth, by_rate, eccentricity, approach = _land_contact(y, params)
    n_y, n_z = 0.0, 0.0
    surface = y[OMEGA] * cage.guide_radius
    smooth = math.sqrt(surface * surface + _LAND_SLIDING * _LAND_SLIDING)
    friction = cage.land_friction * surface / smooth
    if contact > 0.0:
        n_y, n_z = y[CAGE_Y] / eccentricity, y[CAGE_Z] / eccentricity
    d_y, d_z = -n_y + friction * n_z, -n_z - friction * n_y  # direction of the land's force on the cage
    rate[BORDER + CAGE_Y] = (f_y + contact * d_y) / cage.mass
    rate[BORDER + CAGE_Z] = (f_z + contact * d_z) / cage.mass
    rate[OMEGA] = (m + drag - friction * contact * cage.guide_radius) / cage.inertia
    if not with_jacobian:
        return
    own[CAGE_Y, CAGE_Y], own[CAGE_Y, CAGE_Z], own[CAGE_Y, OMEGA] = yy / cage.mass, yz / cage.mass, yo / cage.mass
    own[CAGE_Z, CAGE_Y], own[CAGE_Z, CAGE_Z], own[CAGE_Z, OMEGA] = zy / cage.mass, zz / cage.mass, zo / cage.mass
    own[THETA, CAGE_Y], own[THETA, CAGE_Z], own[THETA, OMEGA] = my / cage.inertia, mz / cage.inertia, (mo + drag_slope) / cage.inertia
    for column in range(BORDER, BORDER + THETA):
        for row in range(CAGE_Y, BORDER):
            own[row, column] = 0.0
    if contact <= 0.0:
        return
    # the direction turns with the cage's centre, the depth's rate with its velocity
    turn = 1.0 / eccentricity
    rate_y = (y[BORDER + CAGE_Y] - approach * n_y) * turn
    rate_z = (y[BORDER + CAGE_Z] - approach * n_z) * turn
    by_y, by_z = by_depth * n_y + by_rate * rate_y, by_depth * n_z + by_rate * rate_z
    n_yy, n_yz, n_zz = n_z * n_z * turn, -n_y * n_z * turn, n_y * n_y * turn
    own[CAGE_Y, CAGE_Y] += (by_y * d_y + contact * (-n_yy + friction * n_yz)) / cage.mass
    own[CAGE_Y, CAGE_Z] += (by_z * d_y + contact * (-n_yz + friction * n_zz)) / cage.mass
    own[CAGE_Z, CAGE_Y] += (by_y * d_z + contact * (-n_yz - friction * n_yy)) / cage.mass
    own[CAGE_Z, CAGE_Z] += (by_z * d_z + contact * (-n_zz - friction * n_yz)) / cage.mass
    lever = -friction * cage.guide_radius / cage.inertia
    own[THETA, CAGE_Y] += lever * by_y
    own[THETA, CAGE_Z] += lever * by_z
    friction_slope = cage.land_friction * cage.guide_radius * _LAND_SLIDING * _LAND_SLIDING / (smooth * smooth * smooth)
    own[CAGE_Y, OMEGA] += contact * friction_slope * n_z / cage.mass
    own[CAGE_Z, OMEGA] -= contact * friction_slope * n_y / cage.mass
    own[THETA, OMEGA] -= friction_slope * contact * cage.guide_radius / cage.inertia
    own[CAGE_Y, BORDER + CAGE_Y] = by_rate * n_y * d_y / cage.mass
    own[CAGE_Y, BORDER + CAGE_Z] = by_rate * n_z * d_y / cage.mass
    own[CAGE_Z, BORDER + CAGE_Y] = by_rate * n_y * d_z / cage.mass
    own[CAGE_Z, BORDER + CAGE_Z] = by_rate * n_z * d_z / cage.mass
    own[THETA, BORDER + CAGE_Y] = lever * by_rate * n_y
    own[THETA, BORDER + CAGE_Z] = lever * by_rate * n_z
