# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What acts on inner ring and cage in the plane besides the rollers: the load, the guide lands, the mixture."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels.inputs import load_at, shaft_speed_at
from bearing_sim.levels.mixture import mixture_torque
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_land import land_contact, land_film, place_in_lands
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z, THETA

LAND_SLIDING = 0.1  # m/s; boundary friction is proportional to the sliding speed well below this


@kernel
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, drive, own = model.params, model.drive, work.border_own
    cage, shaft_speed = params.cage, shaft_speed_at(t, drive)
    load_y, load_z = load_at(t, drive)
    rate[BORDER + RING_Y], rate[BORDER + RING_Z] = load_y / params.ring.mass, load_z / params.ring.mass
    drag, drag_slope = mixture_torque(y[OMEGA], shaft_speed, params, model.lubrication)
    if cage.guidance.lands:
        _lands(place_in_lands(y, shaft_speed, cage), model, own, rate, with_jacobian)
    else:
        rate[BORDER + CAGE_Y], rate[BORDER + CAGE_Z], rate[OMEGA], own[THETA, OMEGA] = 0.0, 0.0, 0.0, 0.0
    rate[OMEGA] += drag / cage.inertia
    if with_jacobian:
        own[THETA, OMEGA] += drag_slope / cage.inertia


@kernel
def _lands(land, model, own, rate, with_jacobian):
    """Write what the lands do to the cage, and to the ring where they are the inner ring's."""
    params = model.params
    cage = params.cage
    film = land_film(land, cage, model.lubrication.viscosity)
    contact, by_depth, by_rate, eccentricity, approach = land_contact(land, params)
    n_y, n_z = 0.0, 0.0
    surface = (land.cage_speed - land.ring_speed) * cage.guide_radius
    smooth = math.sqrt(surface * surface + LAND_SLIDING * LAND_SLIDING)
    friction = cage.land_friction * surface / smooth
    if contact > 0.0:
        n_y, n_z = land.y / eccentricity, land.z / eccentricity
    # the inner ring touches the cage on the side that the cage has left, and there friction points the other way
    side = 1.0 - 2.0 * cage.guidance.turning
    across = side * friction
    d_y, d_z = -n_y + across * n_z, -n_z - across * n_y  # direction of the land's force on the cage
    rate[BORDER + CAGE_Y] = (film[0] + contact * d_y) / cage.mass
    rate[BORDER + CAGE_Z] = (film[1] + contact * d_z) / cage.mass
    rate[OMEGA] = (film[2] - friction * contact * cage.guide_radius) / cage.inertia
    if with_jacobian:
        for row in range(3):
            inertia = cage.mass if row < 2 else cage.inertia
            own[CAGE_Y + row, CAGE_Y], own[CAGE_Y + row, CAGE_Z] = film[3 + 5 * row] / inertia, film[4 + 5 * row] / inertia
            own[CAGE_Y + row, BORDER + CAGE_Y], own[CAGE_Y + row, BORDER + CAGE_Z] = film[5 + 5 * row] / inertia, film[6 + 5 * row] / inertia
            own[CAGE_Y + row, OMEGA] = film[7 + 5 * row] / inertia
        if contact > 0.0:
            friction_slope = cage.land_friction * cage.guide_radius * LAND_SLIDING * LAND_SLIDING / (smooth * smooth * smooth)
            along_y, along_z = land.y_speed - approach * n_y, land.z_speed - approach * n_z
            _contact_slopes(contact, by_depth, by_rate, n_y, n_z, along_y, along_z, 1.0 / eccentricity, friction, friction_slope, side, cage, own)
    if cage.guidance.turning > 0.0:
        _react_on_ring(params, own, rate, with_jacobian)


@kernel
def _contact_slopes(contact, by_depth, by_rate, n_y, n_z, along_y, along_z, turn, friction, friction_slope, side, cage, own):
    """Add the derivatives of the land's contact: its direction turns with the cage's centre, the depth's rate with its velocity."""
    across = side * friction
    d_y, d_z = -n_y + across * n_z, -n_z - across * n_y
    by_y, by_z = by_depth * n_y + by_rate * along_y * turn, by_depth * n_z + by_rate * along_z * turn
    n_yy, n_yz, n_zz = n_z * n_z * turn, -n_y * n_z * turn, n_y * n_y * turn
    own[CAGE_Y, CAGE_Y] += (by_y * d_y + contact * (-n_yy + across * n_yz)) / cage.mass
    own[CAGE_Y, CAGE_Z] += (by_z * d_y + contact * (-n_yz + across * n_zz)) / cage.mass
    own[CAGE_Z, CAGE_Y] += (by_y * d_z + contact * (-n_yz - across * n_yy)) / cage.mass
    own[CAGE_Z, CAGE_Z] += (by_z * d_z + contact * (-n_zz - across * n_yz)) / cage.mass
    lever = -friction * cage.guide_radius / cage.inertia
    own[THETA, CAGE_Y] += lever * by_y
    own[THETA, CAGE_Z] += lever * by_z
    own[CAGE_Y, OMEGA] += side * contact * friction_slope * n_z / cage.mass
    own[CAGE_Z, OMEGA] -= side * contact * friction_slope * n_y / cage.mass
    own[THETA, OMEGA] -= friction_slope * contact * cage.guide_radius / cage.inertia
    own[CAGE_Y, BORDER + CAGE_Y] += by_rate * n_y * d_y / cage.mass
    own[CAGE_Y, BORDER + CAGE_Z] += by_rate * n_z * d_y / cage.mass
    own[CAGE_Z, BORDER + CAGE_Y] += by_rate * n_y * d_z / cage.mass
    own[CAGE_Z, BORDER + CAGE_Z] += by_rate * n_z * d_z / cage.mass
    own[THETA, BORDER + CAGE_Y] += lever * by_rate * n_y
    own[THETA, BORDER + CAGE_Z] += lever * by_rate * n_z


@kernel
def _react_on_ring(params, own, rate, with_jacobian):
    """Give the inner ring the reaction of its lands; a ring that moves is a cage that moves the other way."""
    share = -params.cage.mass / params.ring.mass
    for axis in range(2):
        rate[BORDER + RING_Y + axis] += share * rate[BORDER + CAGE_Y + axis]
    if not with_jacobian:
        return
    for axis in range(2):
        for row in range(3):
            own[CAGE_Y + row, RING_Y + axis] = -own[CAGE_Y + row, CAGE_Y + axis]
            own[CAGE_Y + row, BORDER + RING_Y + axis] = -own[CAGE_Y + row, BORDER + CAGE_Y + axis]
    for axis in range(2):
        for column in range(2 * BORDER):
            own[RING_Y + axis, column] = share * own[CAGE_Y + axis, column]
