# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What acts on inner ring and cage besides the rollers: load, moment, guide lands, mixture, gyroscopic moments.

Each of the two guide lands carries half of what both together would carry where that land stands; the cage's tilt sets them
apart, against the ring's where they are the inner ring's.  The law of a land is that of level ``planar``.
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels import planar_state
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.planar_algebra import BORDER as PLANAR
from bearing_sim.levels.planar_border import border_accelerations as planar_accelerations
from bearing_sim.levels.spatial_algebra import BORDER
from bearing_sim.levels.spatial_state import (
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    OMEGA,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    THETA,
)


class LandWork(NamedTuple):
    """As much of the planar level's memory as a guide land needs."""

    border_own: np.ndarray  # shape (5, 10)


@kernel
def place_land(y, place, land):
    """Write the state of a planar cage and ring that stand where their axes pass a land.

    Parameters
    ----------
    y : state.
    place : of the land along the axis [m].
    land : takes the planar border's positions and speeds, shape (10,) or longer.
    """
    land[planar_state.RING_Y] = y[RING_Y] + place * y[RING_TILT_Y]
    land[planar_state.RING_Z] = y[RING_Z] + place * y[RING_TILT_Z]
    land[PLANAR + planar_state.RING_Y] = y[BORDER + RING_Y] + place * y[BORDER + RING_TILT_Y]
    land[PLANAR + planar_state.RING_Z] = y[BORDER + RING_Z] + place * y[BORDER + RING_TILT_Z]
    land[planar_state.CAGE_Y] = y[CAGE_Y] + place * y[CAGE_TILT_Y]
    land[planar_state.CAGE_Z] = y[CAGE_Z] + place * y[CAGE_TILT_Z]
    land[planar_state.THETA] = y[THETA]
    land[PLANAR + planar_state.CAGE_Y] = y[BORDER + CAGE_Y] + place * y[BORDER + CAGE_TILT_Y]
    land[PLANAR + planar_state.CAGE_Z] = y[BORDER + CAGE_Z] + place * y[BORDER + CAGE_TILT_Z]
    land[planar_state.OMEGA] = y[OMEGA]


@kernel
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, tilts = model.params, model.params.tilts
    place, near, far = tilts.land_place, work.lands[2], work.lands[3]
    place_land(y, place, work.lands[0])
    place_land(y, -place, work.lands[1])
    planar_accelerations(t, work.lands[0], model, LandWork(work.land_own[0]), near, with_jacobian)
    planar_accelerations(t, work.lands[1], model, LandWork(work.land_own[1]), far, with_jacobian)
    rate[BORDER + RING_Y] = 0.5 * (near[PLANAR + planar_state.RING_Y] + far[PLANAR + planar_state.RING_Y])
    rate[BORDER + RING_Z] = 0.5 * (near[PLANAR + planar_state.RING_Z] + far[PLANAR + planar_state.RING_Z])
    rate[BORDER + CAGE_Y] = 0.5 * (near[PLANAR + planar_state.CAGE_Y] + far[PLANAR + planar_state.CAGE_Y])
    rate[BORDER + CAGE_Z] = 0.5 * (near[PLANAR + planar_state.CAGE_Z] + far[PLANAR + planar_state.CAGE_Z])
    rate[OMEGA] = 0.5 * (near[planar_state.OMEGA] + far[planar_state.OMEGA])
    lever = 0.5 * place * params.cage.mass / tilts.cage_inertia
    # I x'' = M_y - J omega y', I y'' = M_z + J omega x' of an axis inclined by (x, y) that turns at omega
    cage_moment = tilts.gyroscopic * params.cage.inertia / tilts.cage_inertia
    precession = cage_moment * y[OMEGA]
    apart_y = near[PLANAR + planar_state.CAGE_Y] - far[PLANAR + planar_state.CAGE_Y]
    apart_z = near[PLANAR + planar_state.CAGE_Z] - far[PLANAR + planar_state.CAGE_Z]
    rate[BORDER + CAGE_TILT_Y] = lever * apart_y - precession * y[BORDER + CAGE_TILT_Z]
    rate[BORDER + CAGE_TILT_Z] = lever * apart_z + precession * y[BORDER + CAGE_TILT_Y]
    free = tilts.ring_free / tilts.ring_inertia
    ring_precession = free * tilts.gyroscopic * tilts.ring_polar_inertia * shaft_speed_at(t, model.drive)
    rate[BORDER + RING_TILT_Y] = free * tilts.moment_y - ring_precession * y[BORDER + RING_TILT_Z]
    rate[BORDER + RING_TILT_Z] = free * tilts.moment_z + ring_precession * y[BORDER + RING_TILT_Y]
    on_ring = params.cage.guidance.turning > 0.0
    ring_lever = 0.5 * place * params.ring.mass * free
    if on_ring:
        rate[BORDER + RING_TILT_Y] += ring_lever * (near[PLANAR + planar_state.RING_Y] - far[PLANAR + planar_state.RING_Y])
        rate[BORDER + RING_TILT_Z] += ring_lever * (near[PLANAR + planar_state.RING_Z] - far[PLANAR + planar_state.RING_Z])
    if not with_jacobian:
        return
    own = work.border_own
    _cage_slopes(place, lever, work.land_own, own)
    own[RING_TILT_Y, BORDER + RING_TILT_Z], own[RING_TILT_Z, BORDER + RING_TILT_Y] = 0.0, 0.0
    if on_ring:
        _ring_slopes(place, lever, ring_lever, work.land_own, own)
    own[CAGE_TILT_Y, BORDER + CAGE_TILT_Z] -= precession
    own[CAGE_TILT_Z, BORDER + CAGE_TILT_Y] += precession
    own[CAGE_TILT_Y, OMEGA] -= cage_moment * y[BORDER + CAGE_TILT_Z]
    own[CAGE_TILT_Z, OMEGA] += cage_moment * y[BORDER + CAGE_TILT_Y]
    own[RING_TILT_Y, BORDER + RING_TILT_Z] -= ring_precession
    own[RING_TILT_Z, BORDER + RING_TILT_Y] += ring_precession


@kernel
def _cage_slopes(place, lever, lands, own):
    """Write the derivatives of the cage's accelerations by its positions and speeds from those of both lands."""
    for which in range(2):
        first, planar_first = which * BORDER, which * PLANAR
        for row in range(3):
            planar_row = planar_state.CAGE_Y + row
            for column in range(3):
                near, far = lands[0, planar_row, planar_first + 2 + column], lands[1, planar_row, planar_first + 2 + column]
                mean, apart = 0.5 * (near + far), near - far
                to = first + (THETA if column == 2 else CAGE_Y + column)
                if row == 2:
                    own[THETA, to] = mean
                    if column < 2:
                        own[THETA, first + CAGE_TILT_Y + column] = 0.5 * place * apart
                    continue
                own[CAGE_Y + row, to] = mean
                own[CAGE_TILT_Y + row, to] = lever * apart
                if column < 2:
                    own[CAGE_Y + row, first + CAGE_TILT_Y + column] = 0.5 * place * apart
                    own[CAGE_TILT_Y + row, first + CAGE_TILT_Y + column] = 2.0 * lever * place * mean


@kernel
def _ring_slopes(place, lever, ring_lever, lands, own):
    """Write what the inner ring's motion does to the cage in its lands, and what both motions do to the ring."""
    for which in range(2):
        first, planar_first = which * BORDER, which * PLANAR
        for axis in range(2):
            for other in range(2):
                _pair(CAGE_Y + axis, CAGE_TILT_Y + axis, planar_state.CAGE_Y + axis, lever,
                      first + RING_Y + other, first + RING_TILT_Y + other, planar_first + planar_state.RING_Y + other, place, lands, own)  # fmt: skip
                _pair(RING_Y + axis, RING_TILT_Y + axis, planar_state.RING_Y + axis, ring_lever,
                      first + RING_Y + other, first + RING_TILT_Y + other, planar_first + planar_state.RING_Y + other, place, lands, own)  # fmt: skip
                _pair(RING_Y + axis, RING_TILT_Y + axis, planar_state.RING_Y + axis, ring_lever,
                      first + CAGE_Y + other, first + CAGE_TILT_Y + other, planar_first + planar_state.CAGE_Y + other, place, lands, own)  # fmt: skip
            near, far = lands[0, planar_state.THETA, planar_first + axis], lands[1, planar_state.THETA, planar_first + axis]
            own[THETA, first + RING_Y + axis] = 0.5 * (near + far)
            own[THETA, first + RING_TILT_Y + axis] = 0.5 * place * (near - far)
            near = lands[0, planar_state.RING_Y + axis, planar_first + planar_state.THETA]
            far = lands[1, planar_state.RING_Y + axis, planar_first + planar_state.THETA]
            own[RING_Y + axis, first + THETA] = 0.5 * (near + far)
            own[RING_TILT_Y + axis, first + THETA] = ring_lever * (near - far)


@kernel
def _pair(row, tilt_row, planar_row, lever, column, tilt_column, planar_column, place, lands, own):
    """Write the derivatives of a body's acceleration and tilting by a body's place and tilt, from those of both lands."""
    near, far = lands[0, planar_row, planar_column], lands[1, planar_row, planar_column]
    own[row, column] = 0.5 * (near + far)
    own[row, tilt_column] = 0.5 * place * (near - far)
    own[tilt_row, column] = lever * (near - far)
    own[tilt_row, tilt_column] = lever * place * (near + far)
