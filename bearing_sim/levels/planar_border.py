"""What acts on inner ring and cage in the plane besides the rollers: the load, the guide land, the mixture."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.inputs import load_at, shaft_speed_at
from bearing_sim.levels.mixture import mixture_torque
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z, THETA

LAND_SLIDING = 0.1  # m/s; boundary friction is proportional to the sliding speed well below this


@kernel
def land_film(y, params, viscosity):
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


@kernel
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, drive, own = model.params, model.drive, work.border_own
    cage = params.cage
    load_y, load_z = load_at(t, drive)
    rate[BORDER + RING_Y], rate[BORDER + RING_Z] = load_y / params.ring.mass, load_z / params.ring.mass
    f_y, f_z, m, yy, yz, yo, zy, zz, zo, my, mz, mo = land_film(y, params, model.lubrication.viscosity)
    drag, drag_slope = mixture_torque(y[OMEGA], shaft_speed_at(t, drive), params, model.lubrication)
    contact, by_depth, by_rate, eccentricity, approach = land_contact(y, params)
    n_y, n_z = 0.0, 0.0
    surface = y[OMEGA] * cage.guide_radius
    smooth = math.sqrt(surface * surface + LAND_SLIDING * LAND_SLIDING)
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
    friction_slope = cage.land_friction * cage.guide_radius * LAND_SLIDING * LAND_SLIDING / (smooth * smooth * smooth)
    own[CAGE_Y, OMEGA] += contact * friction_slope * n_z / cage.mass
    own[CAGE_Z, OMEGA] -= contact * friction_slope * n_y / cage.mass
    own[THETA, OMEGA] -= friction_slope * contact * cage.guide_radius / cage.inertia
    own[CAGE_Y, BORDER + CAGE_Y] = by_rate * n_y * d_y / cage.mass
    own[CAGE_Y, BORDER + CAGE_Z] = by_rate * n_z * d_y / cage.mass
    own[CAGE_Z, BORDER + CAGE_Y] = by_rate * n_y * d_z / cage.mass
    own[CAGE_Z, BORDER + CAGE_Z] = by_rate * n_z * d_z / cage.mass
    own[THETA, BORDER + CAGE_Y] = lever * by_rate * n_y
    own[THETA, BORDER + CAGE_Z] = lever * by_rate * n_z
