# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``slip``: the cage's angle and speed and Z roller spins; everything radial is quasi-static.

Rollers are locked to their pockets, so all of them orbit with the cage; each is held radially by Q_e = Q_i + F_c, and the inner ring by the
load.  What is left of Deng 2017, eq. 14 to 16, is one balance of angular momentum for cage and rollers together and one spin equation
for each roller (`bearing_sim.levels.slip.forces`).  Left out: pocket play, radial vibration, cage whirl.

State: `bearing_sim.levels.slip.state`; its Jacobian is an arrow whose border comes first (`bearing_sim.numerics.linear_algebra`).
"""

import math

import numpy as np

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.common.bending import observe_bending
from bearing_sim.levels.common.model import HALF_PITCH, orbital_speed_tolerance, pitch_step, shaft_speed_at
from bearing_sim.levels.common.observation import TALLY, count_damage, fade_moment, observe_course, observe_rest, oil_at_speed, turn_is_over
from bearing_sim.levels.common.power import write_powers
from bearing_sim.levels.slip.forces import equations, largest_flange_load, up_to_rolling
from bearing_sim.levels.slip.power import slip_powers
from bearing_sim.levels.slip.state import OMEGA, POCKET, SPIN, THETA
from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.linear_algebra import factor_shifted, solve_factored
from bearing_sim.numerics.time_stepping import Kernels
from bearing_sim.physics.lamina_life import MOMENTS, add_load_moments, equivalent_loads
from bearing_sim.physics.load_balance import LOAD

_CAGE_WEIGHT = 10.0  # slip is a small part of the cage's speed (assumption)
_CORRECTION_WEIGHT = 1.0 / 3.0  # most of the error of a spin is gone within a step (assumption)


def initial_state(params, work, shaft_speed, load_y, load_z):
    """Return the state of ideal rolling: the cage at omega_i (1 - gamma)/2, rollers rolling on the outer ring."""
    cage_speed = 0.5 * shaft_speed * (1 - params.raceways.diameter_ratio)
    state = np.zeros(params.rollers.count + 2)
    state[OMEGA] = cage_speed
    state[SPIN:] = cage_speed * params.raceways.pitch_radius / params.rollers.radius
    return state


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``; return False where the loads did not balance."""
    return equations(t, y, model, work, rate, False)


@fused
def rhs_and_jacobian(t, y, model, work, rate):
    """Write dy/dt into ``rate`` and its Jacobian by y into ``work.jacobian``.

    The change of loads with cage angle and speed is left out: it is slow.
    """
    return equations(t, y, model, work, rate, True)


@kernel
def error_norm(t, y, change, model):
    """Return the largest ratio of any state's change to its tolerance.

    Spins count by the speed of the roller's surface, the cage by `_CAGE_WEIGHT` times the speed of its pockets.  The cage's angle is not weighed,
    because nothing restores it.
    """
    return _largest_ratio(t, y, change, model)


@kernel
def correction_norm(t, y, change, model):
    """Return `error_norm` of an iteration's correction, times `_CORRECTION_WEIGHT`."""
    return _CORRECTION_WEIGHT * _largest_ratio(t, y, change, model)


@fused
def _largest_ratio(t, y, change, model):
    raceways, rollers = model.params.raceways, model.params.rollers
    scale = 1.0 / orbital_speed_tolerance(t, y[OMEGA], model)
    largest = _CAGE_WEIGHT * abs(change[OMEGA]) * scale
    spin_scale = scale * rollers.radius / raceways.pitch_radius
    for j in range(rollers.count):
        ratio = abs(change[SPIN + j]) * spin_scale
        if not ratio <= largest:  # NaN goes through
            largest = ratio
    return largest


@kernel
def step_limit(t, y, model, work):
    """Return the longest sensible step [s] (see `bearing_sim.levels.common.model.pitch_step`)."""
    return pitch_step(y[OMEGA], model.params.rollers.count, HALF_PITCH)


@kernel
def observe(t, y, model, work, interval, previous, row, memory):
    """Write the sample of state ``y``.

    Parameters
    ----------
    interval : time since the previous sample [s]; angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.model.sample.flat`.
    memory : of the method, see `bearing_sim.numerics.time_stepping.Memory`.
    """
    params, loads, rate = model.params, work.loads, memory.scratch[0]
    count, cage_speed = params.rollers.count, y[OMEGA]
    oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
    equivalent = equivalent_loads(work.load_moments, oil, params.life)
    observe_course(t, y[THETA], cage_speed, equivalent, oil, model, interval, previous, work.tally, row)
    rhs(t, y, model, work, rate)
    write_powers(slip_powers(cage_speed, y[SPIN:], shaft_speed_at(t, model.drive), model, work), row)
    if params.flanges.on:
        row[COLUMN.inner_flange_force], row[COLUMN.outer_flange_force] = 0.0, 0.0
        for j in range(count):
            row[COLUMN.inner_flange_force] += work.flanges[0, j] / count
            row[COLUMN.outer_flange_force] += work.flanges[2, j] / count
        row[COLUMN.flange_load] = largest_flange_load(params, loads)
    observe_orbits(y[THETA], cage_speed, count, work, row)
    for j in range(count):
        first = SCALARS + j
        row[first + COLUMN.roller_spin * count] = y[SPIN + j]
        before = first + COLUMN.roller_rotation * count
        spin_before = previous[first + COLUMN.roller_spin * count]
        row[before] = previous[before] + 0.5 * (spin_before + y[SPIN + j]) * interval
        row[first + COLUMN.pocket_force * count] = -work.pockets[POCKET.force, j]
    observe_rest(interval, previous, params, work.tally, row)


@kernel
def observe_orbits(cage_angle, cage_speed, count, work, row):
    """Write the inner ring, and the rollers that orbit with the cage in quasi-static balance, into a flat sample; ``work`` holds the balance."""
    loads = work.loads
    row[COLUMN.ring_y], row[COLUMN.ring_z] = work.ring[0], work.ring[1]
    for j in range(count):
        first = SCALARS + j
        row[first + COLUMN.roller_angle * count] = cage_angle + 2.0 * math.pi * j / count
        row[first + COLUMN.roller_radius * count] = loads[LOAD.radius, j]
        row[first + COLUMN.inner_load * count] = loads[LOAD.inner, j]
        row[first + COLUMN.outer_load * count] = loads[LOAD.outer, j]
        row[first + COLUMN.orbital_speed * count] = cage_speed
    observe_bending(work.bending, count, row)


@kernel
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return factor_shifted(work.jacobian, shift, work.factored)


@kernel
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    solve_factored(work.factored, x)


@fused
def predict(known, shift, slope, model, work, guess):
    """Write a first guess of the solution of guess = known + shift f(guess): spins are stiff, and more likely to stay than to go on."""
    for i in range(known.shape[0]):
        guess[i] = known[i]
    guess[THETA] += shift * known[OMEGA]


@fused
def restrain(y, change, model, work):
    """Shorten the corrections of spins that lead from a flat part of a law of traction across pure rolling; see `up_to_rolling`."""
    rollers = model.params.rollers
    for j in range(rollers.count):
        part = up_to_rolling(j, work.loads[LOAD.radius, j] * change[OMEGA], rollers.radius * change[SPIN + j], work.contacts)
        y[SPIN + j] -= (1.0 - part) * change[SPIN + j]
        change[SPIN + j] *= part


@kernel
def sum_up(t, h, y, model, work):
    """Take the loads of a step of length ``h`` [s] into the running means over a cage turn and into the largest, and count damage."""
    loads, now, tally, count = work.loads, work.present_moments, work.tally, model.params.rollers.count
    now[:] = 0.0
    for j in range(count):
        inner, outer = loads[LOAD.inner, j], loads[LOAD.outer, j]
        add_load_moments(inner, outer, 1.0 / count, now)
        tally[TALLY.inner_load], tally[TALLY.outer_load] = max(tally[TALLY.inner_load], inner), max(tally[TALLY.outer_load], outer)
    fraction = 1.0 - math.exp(-abs(h * y[OMEGA]) / (2.0 * math.pi))
    for ring in range(2):
        for k in range(MOMENTS):
            fade_moment(work.load_moments[ring], work.last_moments[ring], k, fraction, now[ring, k])
    if turn_is_over(t, h, model, tally):
        oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
        count_damage(t, equivalent_loads(work.load_moments, oil, model.params.life), oil, model, tally)


KERNELS = Kernels(rhs, rhs_and_jacobian, predict, factor, solve, error_norm, correction_norm, restrain, step_limit, sum_up, observe)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control, or ``fixed`` in steps of ``maximum_step`` [s]; see `bearing_sim.levels.common.advance.advance_by`."""
    return advance_by(KERNELS, fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
