# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``planar``: every roller, the cage and the inner ring move in the plane.

State: `bearing_sim.levels.planar_state`; equations: `planar_rollers` and `planar_border`, their derivatives: `planar_slopes`;
algebra: `planar_algebra`.  Left out: tilt
and skew.
"""

import math

import numpy as np

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.sdirk2 import sdirk2_step
from bearing_sim.integrators.status import COUNT
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.lanes import LANES
from bearing_sim.kernels.load_balance import LOAD
from bearing_sim.kernels.traction import CONTACT
from bearing_sim.levels import planar_algebra, planar_rollers, slip
from bearing_sim.levels.advance import advance_by
from bearing_sim.levels.carried import FIRST_ECCENTRICITY
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.load_means import average_powers
from bearing_sim.levels.observation import observe_course
from bearing_sim.levels.pitch import FIFTH_PITCH, pitch_step
from bearing_sim.levels.planar_algebra import BLOCK, BORDER
from bearing_sim.levels.planar_power import planar_powers
from bearing_sim.levels.planar_prediction import predict
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z, ROLLER, ROLLERS, THETA
from bearing_sim.levels.power import write_powers
from bearing_sim.params import Params
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT
from bearing_sim.sample import COLUMN, SCALARS

NEAR, FAR, TURNING = 8.5e-5, 1.7e-4, 4.25  # what a tolerance of 1 allows: positions, pockets and the cage [m], speeds against ideal rolling


def initial_state(params: Params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling with all rollers in the middle of their pockets and in quasi-static balance.

    Parameters
    ----------
    work : the level's workspace; its running means start here too.
    shaft_speed, load_y, load_z : conditions [rad/s, N].
    """
    count = params.rollers.count
    balance, course = slip.new_work(params), slip.initial_state(params, None, shaft_speed, load_y, load_z)
    balance.growth[0] = params.growth.by_square_speed * shaft_speed * shaft_speed  # heat, not known here, comes with the first step
    inner, outer = slip.equivalent_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    work.load_means[:] = inner**ROTATING_EXPONENT, outer**STATIONARY_EXPONENT
    slip.balance_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    state = np.zeros(2 * BORDER + BLOCK * count)
    state[RING_Y], state[RING_Z] = balance.ring
    turning = params.cage.guidance.turning
    state[CAGE_Y] = turning * state[RING_Y] + FIRST_ECCENTRICITY * params.cage.guide_clearance
    state[CAGE_Z] = turning * state[RING_Z]
    state[OMEGA] = course[slip.OMEGA]
    radius, angle, _, orbital_speed, spin = state[ROLLERS:].reshape(BLOCK, count)
    radius[:] = balance.loads[LOAD.radius]
    angle[:] = 2.0 * math.pi * np.arange(count) / count
    orbital_speed[:] = course[slip.OMEGA]
    spin[:] = course[slip.SPIN :]
    return state


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``."""
    return planar_rollers.equations(t, y, model, work, rate, False)


@kernel
def rhs_and_jacobian(t, y, model, work, rate):
    """Write dy/dt into ``rate`` and all derivatives into ``work``."""
    return planar_rollers.equations(t, y, model, work, rate, True)


@kernel
def nothing(t, y, model, work, rate):
    """Prepare nothing: the method evaluates inside its stages."""
    return True


@kernel
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return planar_algebra.factor(work.slopes, work.border_own, shift, work.factored)


@kernel
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    planar_algebra.solve(work.slopes, work.factored, x)


@kernel
def error_norm(t, y, change, tolerance, model):
    """Return the largest share of its tolerance that any state's error takes.

    At a tolerance of 1e-2: roller and ring positions 0.85 um, pocket offsets and the cage 1.7 um, speeds along the orbit and
    spins 4 % of ideal rolling, for a step.  Radial speeds follow the positions.  The error is that of the embedded method of
    order 1, the result's is a hundredth of it; pockets weigh most, because their oscillation is what a long step blurs first.
    """
    raceways, rollers = model.params.raceways, model.params.rollers
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(y[OMEGA]), 10.0)
    near, far = 1.0 / (NEAR * tolerance), 1.0 / (FAR * tolerance)
    turning = 1.0 / (TURNING * tolerance * ideal)
    angle, spin = far * raceways.pitch_radius, turning * rollers.radius / raceways.pitch_radius
    largest = max(abs(change[RING_Y]) * near, abs(change[RING_Z]) * near, abs(change[CAGE_Y]) * far, abs(change[CAGE_Z]) * far)
    largest = max(largest, abs(change[OMEGA]) * turning)
    count = rollers.count
    for j in range(ROLLERS, ROLLERS + count):
        share = max(abs(change[j]) * near, abs(change[j + count] - change[THETA]) * angle)
        share = max(share, abs(change[j + 3 * count]) * turning, abs(change[j + 4 * count]) * spin)
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
        rhs,
        rhs_and_jacobian,
        predict,
        factor,
        solve,
        error_norm,
        t,
        y,
        h,
        model.tolerance,
        model,
        work,
        stages,
        next_y,
        error,
        work.held,
        work.counts,
    )


@kernel
def average_loads(h, y, model, work):
    """Take the loads at the end of a step of length ``h`` [s] into the running means over a cage turn."""
    count, turned = model.params.rollers.count, h * y[OMEGA]
    share = 1.0 - math.exp(-abs(turned) / (2.0 * math.pi))
    average_powers(share, work.rollers, ROLLER.present, work.contacts, CONTACT.load, count, work.load_means)


@kernel
def count_iterations(evaluated, derived, factored, work, counts):
    """Replace what a drive loop counted by what the iterations inside its steps cost, which it cannot see.

    Parameters
    ----------
    evaluated, derived, factored : right-hand sides, Jacobians and factorisations before.
    """
    counts[COUNT.right_hand_sides] = evaluated + work.counts[0]
    counts[COUNT.jacobians] = derived + work.counts[1]
    counts[COUNT.factorisations] = factored + work.counts[2]
    work.counts[:] = 0


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
    row[COLUMN.ring_y], row[COLUMN.ring_z] = y[RING_Y], y[RING_Z]
    row[COLUMN.cage_y], row[COLUMN.cage_z] = y[CAGE_Y], y[CAGE_Z]
    turning = model.params.cage.guidance.turning
    eccentricity = math.hypot(y[CAGE_Y] - turning * y[RING_Y], y[CAGE_Z] - turning * y[RING_Z])
    row[COLUMN.land_eccentricity] = eccentricity / model.params.cage.guide_clearance
    write_powers(planar_powers(y, shaft_speed_at(t, model.drive), model, work), row)
    for j in range(count):
        first, block, lane = SCALARS + j, j // LANES, j % LANES
        spin = rows[block, ROLLER.spin, lane]
        row[first + COLUMN.roller_angle * count] = rows[block, ROLLER.angle, lane]
        row[first + COLUMN.roller_radius * count] = rows[block, ROLLER.radius, lane]
        row[first + COLUMN.roller_spin * count] = spin
        place = first + COLUMN.roller_rotation * count
        row[place] = previous[place] + 0.5 * (previous[first + COLUMN.roller_spin * count] + spin) * interval
        row[first + COLUMN.inner_load * count] = work.contacts[block, CONTACT.load, lane]
        row[first + COLUMN.outer_load * count] = work.contacts[rows.shape[0] + block, CONTACT.load, lane]
        row[first + COLUMN.orbital_speed * count] = rows[block, ROLLER.orbital_speed, lane]
        row[first + COLUMN.pocket_force * count] = rows[block, ROLLER.pocket_force, lane]


@kernel
def advance(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by the level's own method, adaptive; parameters and results as in `bearing_sim.levels.advance.advance_by`."""
    return advance_by(_drive, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
