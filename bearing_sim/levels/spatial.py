# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``spatial``: every roller in slices, with tilt and skew; tilting cage and inner ring.

State: `bearing_sim.levels.spatial_state`; equations: `spatial_rollers` and `spatial_border`, contacts: `spatial_slices` and
`spatial_pockets`, derivatives: `spatial_slopes` and `spatial_pocket_slopes`; algebra: `spatial_algebra`.  Left out: the rollers'
way along their axes, and bending of the rings.
"""

import math

import numpy as np

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.sdirk2 import sdirk2_step
from bearing_sim.integrators.status import COUNT
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.lanes import LANES
from bearing_sim.kernels.load_balance import LOAD
from bearing_sim.levels import slip, spatial_algebra, spatial_rollers
from bearing_sim.levels.advance import advance_by
from bearing_sim.levels.carried import FIRST_ECCENTRICITY
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.load_means import average_powers
from bearing_sim.levels.observation import observe_course, observe_life
from bearing_sim.levels.pitch import FIFTH_PITCH, pitch_step
from bearing_sim.levels.planar import FAR, NEAR, TURNING, count_iterations, nothing
from bearing_sim.levels.power import write_powers
from bearing_sim.levels.spatial_algebra import BLOCK, BORDER
from bearing_sim.levels.spatial_life import average_slices, slice_pressures
from bearing_sim.levels.spatial_power import spatial_powers
from bearing_sim.levels.spatial_prediction import predict
from bearing_sim.levels.spatial_slices import SLICED
from bearing_sim.levels.spatial_start import balance_by_slices, has_slices_of_its_own
from bearing_sim.levels.spatial_state import (
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    OMEGA,
    PHI,
    PHI_SPEED,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    SKEW,
    SPIN,
    THETA,
    TILT,
)
from bearing_sim.params import Params
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT, lamina_life_revolutions, rating_life_revolutions
from bearing_sim.sample import COLUMN, SCALARS


def initial_state(params: Params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling with all rollers in the middle of their pockets and in quasi-static balance.

    Where crown, moment or misalignment tell slices apart, the balance is that by slices, and rollers move as it moves with the cage;
    elsewhere it is the start of level ``planar``, to the last digit.

    Parameters
    ----------
    work : the level's workspace; its running means start here too.
    shaft_speed, load_y, load_z : conditions [rad/s, N].
    """
    count = params.rollers.count
    balance, course = slip.new_work(params), slip.initial_state(params, None, shaft_speed, load_y, load_z)
    balance.growth[0] = params.growth.by_square_speed * shaft_speed * shaft_speed  # as at level `planar`
    inner, outer = slip.equivalent_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    work.load_means[:] = inner**ROTATING_EXPONENT, outer**STATIONARY_EXPONENT
    slip.balance_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    state = np.zeros(2 * BORDER + BLOCK * count)
    state[RING_Y], state[RING_Z] = balance.ring
    state[OMEGA] = course[slip.OMEGA]
    rollers = state[ROLLERS:].reshape(BLOCK, count)
    rollers[0] = balance.loads[LOAD.radius]
    rollers[PHI] = 2.0 * math.pi * np.arange(count) / count
    rollers[PHI_SPEED] = course[slip.OMEGA]
    rollers[SPIN] = course[slip.SPIN :]
    if has_slices_of_its_own(params):
        balance_by_slices(params, course[slip.OMEGA], (load_y, load_z), balance.growth[0], state)
    turning = params.cage.guidance.turning
    state[CAGE_Y] = turning * state[RING_Y] + FIRST_ECCENTRICITY * params.cage.guide_clearance
    state[CAGE_Z] = turning * state[RING_Z]
    state[CAGE_TILT_Y], state[CAGE_TILT_Z] = turning * state[RING_TILT_Y], turning * state[RING_TILT_Z]
    return state


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``."""
    return spatial_rollers.equations(t, y, model, work, rate, False)


@kernel
def rhs_and_jacobian(t, y, model, work, rate):
    """Write dy/dt into ``rate`` and all derivatives into ``work``."""
    return spatial_rollers.equations(t, y, model, work, rate, True)


@kernel
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return spatial_algebra.factor(work.slopes, work.border_own, shift, work.factored)


@kernel
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    spatial_algebra.solve(work.slopes, work.factored, x)


@kernel
def error_norm(t, y, change, tolerance, model):
    """Return the largest share of its tolerance that any state's error takes.

    As at level ``planar``; tilts count by what they move a roller's, a raceway's or a land's end: tilts of rollers and ring as their
    positions do, skew and the cage's tilts as pocket offsets do.
    """
    raceways, rollers, half = model.params.raceways, model.params.rollers, 0.5 * model.params.rollers.length
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(y[OMEGA]), 10.0)
    near, far = 1.0 / (NEAR * tolerance), 1.0 / (FAR * tolerance)
    turning = 1.0 / (TURNING * tolerance * ideal)
    angle, spin = far * raceways.pitch_radius, turning * rollers.radius / raceways.pitch_radius
    largest = max(abs(change[RING_Y]) * near, abs(change[RING_Z]) * near, abs(change[CAGE_Y]) * far, abs(change[CAGE_Z]) * far)
    largest = max(largest, abs(change[OMEGA]) * turning, max(abs(change[RING_TILT_Y]), abs(change[RING_TILT_Z])) * near * half)
    largest = max(largest, max(abs(change[CAGE_TILT_Y]), abs(change[CAGE_TILT_Z])) * far * model.params.tilts.land_place)
    count = rollers.count
    for j in range(ROLLERS, ROLLERS + count):
        share = max(abs(change[j]) * near, abs(change[j + PHI * count] - change[THETA]) * angle)
        share = max(share, abs(change[j + PHI_SPEED * count]) * turning, abs(change[j + SPIN * count]) * spin)
        share = max(share, abs(change[j + TILT * count]) * near * half, abs(change[j + SKEW * count]) * far * half)
        if not share <= largest:
            largest = share
    return largest


@kernel
def step_limit(t, y, model):
    """Return the longest sensible step [s] (see `bearing_sim.levels.pitch.pitch_step`)."""
    return pitch_step(y[OMEGA], model.params.rollers.count, FIFTH_PITCH)


@kernel
def sdirk2(t, y, rate, h, model, work, stages, next_y, error):
    """Take one step of the level's own method (see `bearing_sim.integrators.sdirk2`)."""
    return sdirk2_step(
        rhs, rhs_and_jacobian, predict, factor, solve, error_norm,
        t, y, h, model.tolerance, model, work, stages, next_y, error, work.held, work.counts,
    )  # fmt: skip


@kernel
def average_loads(h, y, model, work):
    """Take the loads at the end of a step of length ``h`` [s] into the running means over a cage turn."""
    count, turned = model.params.rollers.count, h * y[OMEGA]
    share = 1.0 - math.exp(-abs(turned) / (2.0 * math.pi))
    average_powers(share, work.rollers, ROLLER.present, work.contacts, SLICED.load, count, work.load_means)
    average_slices(share, model.params, work)


@kernel
def _drive(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    evaluated, derived, factored = counts[COUNT.right_hand_sides], counts[COUNT.jacobians], counts[COUNT.factorisations]
    status, h = drive(
        nothing, sdirk2, error_norm, step_limit, average_loads, 2,
        t, end, y, h, tolerance, maximum_step, budget, model, work, memory.scratch, counts,
    )  # fmt: skip
    count_iterations(evaluated, derived, factored, work, counts)
    return status, h


@kernel
def observe(t, y, model, work, interval, previous, row, rate):
    """Write the sample of state ``y``; parameters as in `bearing_sim.levels.slip.observe`."""
    rhs(t, y, model, work, rate)
    rows, count = work.rollers, model.params.rollers.count
    inner, outer = work.load_means[0] ** (1.0 / ROTATING_EXPONENT), work.load_means[1] ** (1.0 / STATIONARY_EXPONENT)
    observe_course(t, y[THETA], y[OMEGA], inner, outer, model, interval, previous, row)
    life = model.params.life
    by_slices = lamina_life_revolutions(work.slice_means[0], work.slice_means[1], life)
    observe_life(rating_life_revolutions(inner, outer, life), by_slices, model, interval, previous, row)
    row[COLUMN.ring_y], row[COLUMN.ring_z] = y[RING_Y], y[RING_Z]
    row[COLUMN.cage_y], row[COLUMN.cage_z] = y[CAGE_Y], y[CAGE_Z]
    row[COLUMN.ring_tilt_y], row[COLUMN.ring_tilt_z] = y[RING_TILT_Y], y[RING_TILT_Z]
    row[COLUMN.cage_tilt_y], row[COLUMN.cage_tilt_z] = y[CAGE_TILT_Y], y[CAGE_TILT_Z]
    pressures = slice_pressures(model.params, work)
    row[COLUMN.inner_pressure], row[COLUMN.outer_pressure], row[COLUMN.inner_edge_pressure], row[COLUMN.outer_edge_pressure] = pressures
    turning = model.params.cage.guidance.turning
    eccentricity = math.hypot(y[CAGE_Y] - turning * y[RING_Y], y[CAGE_Z] - turning * y[RING_Z])
    row[COLUMN.land_eccentricity] = eccentricity / model.params.cage.guide_clearance
    write_powers(spatial_powers(y, shaft_speed_at(t, model.drive), model, work), row)
    for j in range(count):
        first, block, lane = SCALARS + j, j // LANES, j % LANES
        spin = rows[block, ROLLER.spin, lane]
        row[first + COLUMN.roller_angle * count] = rows[block, ROLLER.angle, lane]
        row[first + COLUMN.roller_radius * count] = rows[block, ROLLER.radius, lane]
        row[first + COLUMN.roller_spin * count] = spin
        place = first + COLUMN.roller_rotation * count
        row[place] = previous[place] + 0.5 * (previous[first + COLUMN.roller_spin * count] + spin) * interval
        row[first + COLUMN.inner_load * count] = work.contacts[block, SLICED.load, lane]
        row[first + COLUMN.outer_load * count] = work.contacts[rows.shape[0] + block, SLICED.load, lane]
        row[first + COLUMN.orbital_speed * count] = rows[block, ROLLER.orbital_speed, lane]
        row[first + COLUMN.pocket_force * count] = rows[block, ROLLER.pocket_force, lane]
        row[first + COLUMN.roller_tilt * count] = rows[block, ROLLER.tilt, lane]
        row[first + COLUMN.roller_skew * count] = rows[block, ROLLER.skew, lane]


@kernel
def advance(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by the level's own method, adaptive; parameters and results as in `bearing_sim.levels.advance.advance_by`."""
    return advance_by(_drive, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
