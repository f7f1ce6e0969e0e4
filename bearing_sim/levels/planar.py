"""Level ``planar``: every roller, the cage and the inner ring move in the plane.

State and equations: `bearing_sim.levels.planar_equations` and `planar_rollers`; algebra: `planar_algebra`.  Left out: tilt
and skew.
"""

import math

import numpy as np

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.sdirk2 import sdirk2_step
from bearing_sim.integrators.status import COUNT, OK
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.load_balance import LOAD
from bearing_sim.kernels.raceway import contour_at
from bearing_sim.levels import planar_algebra, planar_rollers, slip
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.observation import observe_course
from bearing_sim.levels.pitch import pitch_step
from bearing_sim.levels.planar_algebra import BLOCK, BORDER
from bearing_sim.levels.planar_equations import (
    CAGE_Y,
    CAGE_Z,
    OMEGA,
    PHI_SPEED,
    R_SPEED,
    RING_Y,
    RING_Z,
    ROLLER,
    SPIN,
    THETA,
)
from bearing_sim.levels.planar_power import planar_powers
from bearing_sim.levels.power import write_powers
from bearing_sim.params import Params
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT
from bearing_sim.sample import COLUMN, SCALARS

_FIRST_ECCENTRICITY = 0.3  # of the guide clearance; a cage exactly in the centre would have no direction to whirl from


def initial_state(params: Params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling with all rollers in the middle of their pockets and in quasi-static balance.

    Parameters
    ----------
    work : the level's workspace; its running means start here too.
    shaft_speed, load_y, load_z : conditions [rad/s, N].
    """
    count = params.rollers.count
    balance, course = slip.new_work(params), slip.initial_state(params, None, shaft_speed, load_y, load_z)
    inner, outer = slip.equivalent_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    work.powers[:] = inner**ROTATING_EXPONENT, outer**STATIONARY_EXPONENT
    slip.balance_loads(0.0, course[slip.OMEGA], load_y, load_z, params, balance)
    state = np.zeros(2 * BORDER + BLOCK * count)
    state[RING_Y], state[RING_Z] = balance.ring
    state[CAGE_Y] = _FIRST_ECCENTRICITY * params.cage.guide_clearance
    state[OMEGA] = course[slip.OMEGA]
    rollers = state[2 * BORDER :].reshape(count, BLOCK)
    rollers[:, 0] = balance.loads[LOAD.radius]
    rollers[:, 1] = 2.0 * math.pi * np.arange(count) / count
    rollers[:, PHI_SPEED] = course[slip.OMEGA]
    rollers[:, SPIN] = course[slip.SPIN :]
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
    return planar_algebra.factor(work.roller_rows, work.border_rows, work.border_own, shift, work.factored)


@kernel
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    planar_algebra.solve(work.roller_rows, work.border_rows, work.factored, x)


@kernel
def predict(y, h, model, guess):
    """Write where the state will be after ``h``: positions go on with their speeds, rollers follow the contour."""
    contour = model.params.raceways.contour
    intervals = contour.shape[0]
    for k in range(BORDER):
        guess[k] = y[k] + h * y[BORDER + k]
        guess[BORDER + k] = y[BORDER + k]
    for first in range(2 * BORDER, y.shape[0], BLOCK):
        phi = y[first + 1]
        after = phi + h * y[first + PHI_SPEED]
        turns = phi / (2.0 * math.pi)
        before = contour_at(contour, (turns - math.floor(turns)) * intervals)[0]
        turns = after / (2.0 * math.pi)
        radius, slope = contour_at(contour, (turns - math.floor(turns)) * intervals)
        guess[first] = y[first] + radius - before
        guess[first + 1] = after
        guess[first + R_SPEED] = slope * y[first + PHI_SPEED]
        guess[first + PHI_SPEED] = y[first + PHI_SPEED]
        guess[first + SPIN] = y[first + SPIN]


@kernel
def error_norm(t, y, change, tolerance, model):
    """Return the largest share of its tolerance that any state's error takes.

    At a tolerance of 1e-2: roller and ring positions 0.5 um, pocket offsets and the cage 15 um, speeds along the orbit and
    spins 5 % of ideal rolling, for a step.  Radial speeds follow the positions.
    """
    raceways, rollers = model.params.raceways, model.params.rollers
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(y[OMEGA]), 10.0)
    near, far = 1.0 / (5e-5 * tolerance), 1.0 / (1.5e-3 * tolerance)
    turning = 1.0 / (5.0 * tolerance * ideal)
    angle, spin = far * raceways.pitch_radius, turning * rollers.radius / raceways.pitch_radius
    largest = max(abs(change[RING_Y]) * near, abs(change[RING_Z]) * near, abs(change[CAGE_Y]) * far, abs(change[CAGE_Z]) * far)
    largest = max(largest, abs(change[OMEGA]) * turning)
    for first in range(2 * BORDER, y.shape[0], BLOCK):
        share = max(abs(change[first]) * near, abs(change[first + 1] - change[THETA]) * angle)
        share = max(share, abs(change[first + PHI_SPEED]) * turning, abs(change[first + SPIN]) * spin)
        if not share <= largest:
            largest = share
    return largest


@kernel
def step_limit(t, y, model):
    """Return the longest sensible step [s] (see `bearing_sim.levels.pitch.pitch_step`)."""
    return pitch_step(y[OMEGA], model.params.rollers.count)


@kernel
def _step(t, y, rate, h, model, work, stages, next_y, error):
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
def _drive(t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts):
    return drive(nothing, _step, error_norm, step_limit, 2, t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts)


@kernel
def _average_loads(turned, work):
    """Take the loads of this instant into the running means over a cage turn; ``turned`` is the cage's rotation since [rad]."""
    rows = work.rollers
    inner, outer = 0.0, 0.0
    for j in range(rows.shape[1]):
        inner += rows[ROLLER.inner_load, j] ** ROTATING_EXPONENT
        outer += rows[ROLLER.outer_load, j] ** STATIONARY_EXPONENT
    share = 1.0 - math.exp(-abs(turned) / (2.0 * math.pi))
    work.powers[0] += share * (inner / rows.shape[1] - work.powers[0])
    work.powers[1] += share * (outer / rows.shape[1] - work.powers[1])


@kernel
def observe(t, y, model, work, interval, previous, row, rate):
    """Write the sample of state ``y``; parameters as in `bearing_sim.levels.slip.observe`."""
    rhs(t, y, model, work, rate)
    rows, count = work.rollers, work.rollers.shape[1]
    inner, outer = work.powers[0] ** (1.0 / ROTATING_EXPONENT), work.powers[1] ** (1.0 / STATIONARY_EXPONENT)
    observe_course(t, y[THETA], y[OMEGA], inner, outer, model, interval, previous, row)
    row[COLUMN.ring_y], row[COLUMN.ring_z] = y[RING_Y], y[RING_Z]
    row[COLUMN.cage_y], row[COLUMN.cage_z] = y[CAGE_Y], y[CAGE_Z]
    row[COLUMN.land_eccentricity] = math.hypot(y[CAGE_Y], y[CAGE_Z]) / model.params.cage.guide_clearance
    write_powers(planar_powers(y, shaft_speed_at(t, model.drive), model, work), row)
    for j in range(count):
        state, first = 2 * BORDER + BLOCK * j, SCALARS + j
        row[first + COLUMN.roller_angle * count] = y[state + 1]
        row[first + COLUMN.roller_radius * count] = y[state]
        row[first + COLUMN.roller_spin * count] = y[state + SPIN]
        place = first + COLUMN.roller_rotation * count
        row[place] = previous[place] + 0.5 * (previous[first + COLUMN.roller_spin * count] + y[state + SPIN]) * interval
        row[first + COLUMN.inner_load * count] = rows[ROLLER.inner_load, j]
        row[first + COLUMN.outer_load * count] = rows[ROLLER.outer_load, j]
        row[first + COLUMN.orbital_speed * count] = y[state + PHI_SPEED]
        row[first + COLUMN.pocket_force * count] = rows[ROLLER.pocket_force, j]


@kernel
def advance(t, duration, y, h, maximum_step, budget, model, work, scratch, counts, previous, rows):
    """Advance ``y`` in place by ``duration`` [s] and write evenly spaced samples into ``rows``, the last at the end.

    Parameters and results as in `bearing_sim.levels.slip.advance`.
    """
    samples = rows.shape[0]
    interval = duration / samples
    before = previous
    taken = counts[COUNT.steps] + counts[COUNT.rejected_steps]
    evaluated, derived = counts[COUNT.right_hand_sides], counts[COUNT.jacobians]
    work.counts[:] = 0
    for k in range(samples):
        now, end = t + k * interval, t + (k + 1) * interval
        while now < end:
            # loads are averaged as often as a step may be long, and for the same reason
            pieces = math.ceil((end - now) / step_limit(now, y, model))
            then = end if pieces <= 1.0 else now + (end - now) / pieces
            angle = y[THETA]
            left = budget - (counts[COUNT.steps] + counts[COUNT.rejected_steps] - taken)
            status, h = _drive(now, then, y, h, model.tolerance, maximum_step, left, model, work, scratch, counts)
            # the drive loop cannot see the iterations inside a step
            counts[COUNT.right_hand_sides], counts[COUNT.jacobians] = evaluated + work.counts[0], derived + work.counts[1]
            if status != OK:
                return status, h
            _average_loads(y[THETA] - angle, work)
            now = then
        observe(end, y, model, work, interval, before, rows[k], scratch[0])
        before = rows[k]
    return OK, h
