# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where level ``spatial`` begins: in the balance by slices, and moving as that balance moves with the cage."""

import numpy as np

from bearing_sim.kernels.lamina import ROLLER_ROW
from bearing_sim.levels.slice_balance import balance, roller_tilts
from bearing_sim.levels.spatial_algebra import BLOCK
from bearing_sim.levels.spatial_state import R_SPEED, RING_TILT_Y, RING_TILT_Z, RING_Y, RING_Z, ROLLERS, TILT, TILT_SPEED, R

_CAGE_STEP = 1e-3  # rad, over which speeds are differences: a hundredth of what a lobe or a roller pitch takes


def has_slices_of_its_own(params) -> bool:
    """Return whether a bearing's slices carry anything else than equal shares."""
    tilts = params.tilts
    moved = (tilts.moment_y, tilts.moment_z, tilts.misalignment_y, tilts.misalignment_z)
    return any(moved) or bool(np.any(params.slices.crown))


def balance_by_slices(params, cage_speed, load, growth, state) -> None:
    """Enter places and tilts of ring and rollers in balance into a state, and the speeds at which the rollers follow it.

    The ring stays at rest: it is too heavy to follow every roller that passes.  Where no balance is found only a ring that is held is
    inclined, and all else starts as it is.

    Parameters
    ----------
    params : of the bearing.
    cage_speed : [rad/s].
    load : y, z on the inner ring [N].
    growth : of the inner raceway [m].
    state : see `bearing_sim.levels.spatial_state`; roller 0 at azimuth 0; changed in place.
    """
    count, tilts = params.rollers.count, params.tilts
    moment = (-tilts.moment_z, tilts.moment_y)  # about y and z what leans towards y and z
    held = None if tilts.ring_free else (-tilts.misalignment_z, tilts.misalignment_y)

    def rollers_at(cage_angle, near=None):
        found = balance(params, cage_angle, cage_speed, load, moment, held, near, growth)
        row = found.roller
        contour = params.raceways.inner_radius + growth + 2.0 * params.rollers.radius - row[ROLLER_ROW.squeeze]
        return found, np.stack([contour - params.rollers.radius + row[ROLLER_ROW.penetration], roller_tilts(found)])

    state[RING_TILT_Y], state[RING_TILT_Z] = tilts.misalignment_y, tilts.misalignment_z  # 0 where the ring is free
    try:
        found, places = rollers_at(0.0)
        ring = found.ring.copy()
        before, after = rollers_at(-_CAGE_STEP, found)[1], rollers_at(_CAGE_STEP, found)[1]
    except ArithmeticError:
        return
    speeds = (after - before) * (cage_speed / (2.0 * _CAGE_STEP))
    state[RING_Y], state[RING_Z], state[RING_TILT_Y], state[RING_TILT_Z] = ring[0], ring[1], ring[3], -ring[2]
    rollers = state[ROLLERS:].reshape(BLOCK, count)
    rollers[[R, TILT]], rollers[[R_SPEED, TILT_SPEED]] = places, speeds
