# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``spatial``: contacts along every roller, with tilt and skew; tilting cage and inner ring.

State and memory: `bearing_sim.levels.spatial.state`; equations: `bearing_sim.levels.spatial.forces`, contacts along the rollers:
`bearing_sim.levels.spatial.slices`; their Jacobian and the linear algebra of implicit steps: `bearing_sim.levels.spatial.jacobian`.  Left out: the
rollers' motion along their axes, and twist of the rings.
"""

import math

import numpy as np

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.common.bending import observe_ring
from bearing_sim.levels.common.dynamic import average_step, dynamic_kernels, observe_level
from bearing_sim.levels.common.flanges import largest_corner
from bearing_sim.levels.common.model import FIFTH_PITCH, shaft_speed_at
from bearing_sim.levels.common.observation import count_damage, oil_at_speed, turn_is_over
from bearing_sim.levels.common.slice_balance import balance, roller_tilts
from bearing_sim.levels.common.state_transfer import FIRST_CAGE_TILT, first_cage_centre, rolling_state
from bearing_sim.levels.common.support import place_support
from bearing_sim.levels.spatial import state as spatial_state
from bearing_sim.levels.spatial.forces import carry_forces, equations
from bearing_sim.levels.spatial.power import spatial_powers
from bearing_sim.levels.spatial.predictor import predict
from bearing_sim.levels.spatial.slices import average_laminae, lamina_pressures, sum_lamina_powers
from bearing_sim.levels.spatial.state import (
    BLOCK,
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    LAYOUT,
    OMEGA,
    R_SPEED,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    RUNS,
    SLICED,
    TILT,
    TILT_SPEED,
    R,
)
from bearing_sim.model.params import Params
from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.lamina import ROLLER_ROW
from bearing_sim.physics.lamina_life import equivalent_lamina_loads
from bearing_sim.physics.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT

_LAMINA_INTERVAL = 0.25 * FIFTH_PITCH  # of a pitch: the longest steps all count for laminae, also in resonance (assumption)
_CAGE_STEP = 1e-3  # rad, over which speeds are differences: a hundredth of what a lobe or a roller pitch takes


def _is_unequal_along_rollers(params) -> bool:
    """Return whether crown, moment or misalignment load a roller unequally along its length."""
    tilts = params.tilts
    moved = (tilts.moment_y, tilts.moment_z, tilts.misalignment_y, tilts.misalignment_z)
    return any(moved) or bool(np.any(params.slices.crown))


def _balance_by_slices(params, cage_speed, load, growth, state) -> None:
    """Enter positions and tilts of ring and rollers in balance into a state, and the speeds at which the rollers follow it.

    The ring stays at rest: it is too heavy to follow every roller that passes.  Where no balance is found only a ring that is held is
    inclined, and all else starts as it is.

    Parameters
    ----------
    params : of the bearing.
    cage_speed : [rad/s].
    load : y, z on the inner ring [N].
    growth : of the inner raceway [m].
    state : see `bearing_sim.levels.spatial.state`; roller 0 at azimuth 0; changed in place.
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
        found, positions = rollers_at(0.0)
        ring = found.ring.copy()
        before, after = rollers_at(-_CAGE_STEP, found)[1], rollers_at(_CAGE_STEP, found)[1]
    except ArithmeticError:
        return
    speeds = (after - before) * (cage_speed / (2.0 * _CAGE_STEP))
    state[RING_Y], state[RING_Z], state[RING_TILT_Y], state[RING_TILT_Z] = ring[0], ring[1], ring[3], -ring[2]
    rollers = state[ROLLERS : ROLLERS + BLOCK * count].reshape(BLOCK, count)
    rollers[[R, TILT]], rollers[[R_SPEED, TILT_SPEED]] = positions, speeds


def initial_state(params: Params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling; see `bearing_sim.levels.common.state_transfer.rolling_state`, also for the parameters.

    If crown, moment or misalignment load rollers unequally along their length, the balance is that by slices, and rollers move as it does with
    the cage; otherwise it is the start of level ``planar``, to the last digit.

    The cage is tilted by a trace: one that tilts by itself would else stand upright until round-off has grown, long after slip and life seem to
    rest.
    """
    state, growth = rolling_state(spatial_state, params, work, shaft_speed, load_y, load_z)
    if _is_unequal_along_rollers(params):
        _balance_by_slices(params, state[OMEGA], (load_y, load_z), growth, state)
    turning = params.cage.guidance.turning
    state[CAGE_Y], state[CAGE_Z] = first_cage_centre(params, state[RING_Y], state[RING_Z])
    state[CAGE_TILT_Y], state[CAGE_TILT_Z] = turning * state[RING_TILT_Y] + FIRST_CAGE_TILT, turning * state[RING_TILT_Z]
    place_support(params, state, (state[RING_Y], state[RING_Z]), (load_y, load_z))
    return state


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``."""
    return equations(t, y, model, work, rate, False)


@fused
def sum_up(t, h, y, model, work):
    """Take the loads of a step of length ``h`` [s], and the stiffness at its end, into the running means over a cage turn, and count damage.

    After a step, ``work`` holds loads of the second-last iterate; they are carried to ``y``, because contact loads are stiff.
    """
    count, turned = model.params.rollers.count, h * y[OMEGA]
    carry_forces(y, count, work)
    average_step(ROLLER, SLICED, turned, model, work)
    average_laminae(abs(turned), _LAMINA_INTERVAL * 2.0 * math.pi / count, model.params, work)
    if turn_is_over(t, h, model, work.tally):
        oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
        count_damage(t, _equivalent_loads(oil, model.params.life, work), oil, model, work.tally)


@kernel
def _equivalent_loads(oil, life, work):
    """Return the `bearing_sim.physics.lamina_life.EquivalentLoads` of the running means."""
    inner, outer = work.load_moments[0, 0] ** (1.0 / ROTATING_EXPONENT), work.load_moments[1, 0] ** (1.0 / STATIONARY_EXPONENT)
    sum_lamina_powers(work)
    return equivalent_lamina_loads(inner, outer, work.lamina_means[0], work.lamina_means[1], oil, life)


@kernel
def observe(t, y, model, work, interval, previous, row, memory):
    """Write the sample of state ``y``; parameters as in `bearing_sim.levels.slip.model.observe`."""
    rows, count = work.rollers, model.params.rollers.count
    oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
    equivalent = _equivalent_loads(oil, model.params.life, work)
    observe_level(LAYOUT, ROLLER, SLICED, rhs, spatial_powers, t, y, oil, equivalent, model, work, interval, previous, row, memory)
    observe_ring(work.bending, count, row)
    row[COLUMN.ring_tilt_y], row[COLUMN.ring_tilt_z] = y[RING_TILT_Y], y[RING_TILT_Z]
    row[COLUMN.cage_tilt_y], row[COLUMN.cage_tilt_z] = y[CAGE_TILT_Y], y[CAGE_TILT_Z]
    pressures = lamina_pressures(model.params, work)
    row[COLUMN.inner_pressure], row[COLUMN.outer_pressure], row[COLUMN.inner_edge_pressure], row[COLUMN.outer_edge_pressure] = pressures
    if model.params.flanges.on:
        row[COLUMN.flange_load] += largest_corner(ROLLER, rows)
    for j in range(count):
        first, block, lane = SCALARS + j, j // LANES, j % LANES
        row[first + COLUMN.roller_tilt * count] = rows[block, ROLLER.tilt, lane]
        row[first + COLUMN.roller_skew * count] = rows[block, ROLLER.skew, lane]


KERNELS = dynamic_kernels(LAYOUT, ROLLER, SLICED, RUNS, equations, rhs, predict, sum_up, observe)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control, or ``fixed`` in steps of ``maximum_step`` [s]; see `bearing_sim.levels.common.advance.advance_by`."""
    return advance_by(KERNELS, fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
