"""What acts on inner ring and cage in the plane besides the rollers: the load, the guide land, the mixture."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.inputs import load_at, shaft_speed_at
from bearing_sim.levels.mixture import mixture_torque
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_land import land_contact, land_film
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z, THETA

LAND_SLIDING = 0.1  # m/s; boundary friction is proportional to the sliding speed well below this


@kernel
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, drive, own = model.params, model.drive, work.border_own
    cage = params.cage
    load_y, load_z = load_at(t, drive)
    rate[BORDER + RING_Y], rate[BORDER + RING_Z] = load_y / params.ring.mass, load_z / params.ring.mass
    film = land_film(y, params, model.lubrication.viscosity)
    drag, drag_slope = mixture_torque(y[OMEGA], shaft_speed_at(t, drive), params, model.lubrication)
    contact, by_depth, by_rate, eccentricity, approach = land_contact(y, params)
    n_y, n_z = 0.0, 0.0
    surface = y[OMEGA] * cage.guide_radius
    smooth = math.sqrt(surface * surface + LAND_SLIDING * LAND_SLIDING)
    friction = cage.land_friction * surface / smooth
    if contact > 0.0:
        n_y, n_z = y[CAGE_Y] / eccentricity, y[CAGE_Z] / eccentricity
    d_y, d_z = -n_y + friction * n_z, -n_z - friction * n_y  # direction of the land's force on the cage
    rate[BORDER + CAGE_Y] = (film[0] + contact * d_y) / cage.mass
    rate[BORDER + CAGE_Z] = (film[1] + contact * d_z) / cage.mass
    rate[OMEGA] = (film[2] + drag - friction * contact * cage.guide_radius) / cage.inertia
    if not with_jacobian:
        return
    for row in range(3):
        inertia = cage.mass if row < 2 else cage.inertia
        own[CAGE_Y + row, CAGE_Y], own[CAGE_Y + row, CAGE_Z] = film[3 + 5 * row] / inertia, film[4 + 5 * row] / inertia
        own[CAGE_Y + row, BORDER + CAGE_Y], own[CAGE_Y + row, BORDER + CAGE_Z] = film[5 + 5 * row] / inertia, film[6 + 5 * row] / inertia
        own[CAGE_Y + row, OMEGA] = film[7 + 5 * row] / inertia
    own[THETA, OMEGA] += drag_slope / cage.inertia
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
    own[CAGE_Y, BORDER + CAGE_Y] += by_rate * n_y * d_y / cage.mass
    own[CAGE_Y, BORDER + CAGE_Z] += by_rate * n_z * d_y / cage.mass
    own[CAGE_Z, BORDER + CAGE_Y] += by_rate * n_y * d_z / cage.mass
    own[CAGE_Z, BORDER + CAGE_Z] += by_rate * n_z * d_z / cage.mass
    own[THETA, BORDER + CAGE_Y] += lever * by_rate * n_y
    own[THETA, BORDER + CAGE_Z] += lever * by_rate * n_z
