# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``planar``: every roller, the cage and the inner ring move in the plane.  Left out: tilt and skew.

State and memory: `bearing_sim.levels.planar.state`; equations: `bearing_sim.levels.planar.forces`; their Jacobian and the linear algebra of
implicit steps: `bearing_sim.levels.planar.jacobian`.
"""

import math

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.common.dynamic import average_step, observe_level
from bearing_sim.levels.common.model import POSITION_WEIGHT, orbital_speed_tolerance, play_weight, ring_step, ring_weight, shaft_speed_at
from bearing_sim.levels.common.observation import count_damage, oil_at_speed, turn_is_over
from bearing_sim.levels.common.rollers import restrain_rollers
from bearing_sim.levels.common.state_transfer import first_cage_centre, rolling_state
from bearing_sim.levels.common.support import factor_level, place_support, solve_level, support_change
from bearing_sim.levels.planar import state as planar_state
from bearing_sim.levels.planar.forces import carry_forces, equations
from bearing_sim.levels.planar.power import planar_powers
from bearing_sim.levels.planar.predictor import predict
from bearing_sim.levels.planar.state import (
    BLOCK,
    CAGE_Y,
    CAGE_Z,
    LAYOUT,
    OMEGA,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    RUNS,
    THETA,
)
from bearing_sim.model.params import Params
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, highest, larger, load_run, magnitude, spread, total
from bearing_sim.numerics.time_stepping import Kernels
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.lamina_life import equivalent_loads


def initial_state(params: Params, work, shaft_speed, load_y, load_z):
    """Return ideal rolling; see `bearing_sim.levels.common.state_transfer.rolling_state`, also for the parameters."""
    state, _ = rolling_state(planar_state, params, work, shaft_speed, load_y, load_z)
    state[CAGE_Y], state[CAGE_Z] = first_cage_centre(params, state[RING_Y], state[RING_Z])
    place_support(params, state, (state[RING_Y], state[RING_Z]), (load_y, load_z))
    return state


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``."""
    return equations(t, y, model, work, rate, False)


@fused
def rhs_and_jacobian(t, y, model, work, rate):
    """Write dy/dt into ``rate`` and all derivatives into ``work``."""
    return equations(t, y, model, work, rate, True)


@fused
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return factor_level(LAYOUT, shift, work)


@fused
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    solve_level(LAYOUT, work, x)


@fused
def error_norm(t, y, change, model):
    """Return the largest ratio of any state's change to its tolerance."""
    return _largest_ratio(t, y, change, model, 1.0, ring_weight(t, model), 1.0)


@fused
def correction_norm(t, y, change, model):
    """Return `error_norm` of an iteration's correction, in which positions have the weight `POSITION_WEIGHT`, and play `play_weight`."""
    return _largest_ratio(t, y, change, model, POSITION_WEIGHT, 1.0, play_weight(y[OMEGA], model.params.raceways.pitch_radius))


@fused
def _largest_ratio(t, y, change, model, position_weight, own_ring_weight, own_play_weight):
    """Return the largest ratio of any state's change to its tolerance, positions, the ring's besides, and play with weights of their own.

    Positions are the rollers' radii and the ring's centre; play have the rollers in their pockets and the cage.  Spins count by the
    speed of the roller's surface.  Radial speeds and those of both centres follow the positions and are not weighed.
    """
    raceways, rollers = model.params.raceways, model.params.rollers
    position, play = position_weight / model.tolerances.position, own_play_weight / model.tolerances.play
    speed = 1.0 / orbital_speed_tolerance(t, y[OMEGA], model)
    offset, spin = play * raceways.pitch_radius, speed * rollers.radius / raceways.pitch_radius
    largest = max(max(abs(change[RING_Y]), abs(change[RING_Z])) * own_ring_weight * position, max(abs(change[CAGE_Y]), abs(change[CAGE_Z])) * play)
    largest = max(largest, abs(change[OMEGA]) * speed)
    count = rollers.count
    if change.shape[0] > ROLLERS + BLOCK * count:
        largest = max(largest, support_change(change) * position)
    whole, turned = count // LANES, change[THETA]
    highest_ratio, finite = spread(largest), spread(0.0)
    for block in range(whole):
        j = ROLLERS + block * LANES
        ratio = larger(magnitude(load_run(change, j)) * position, magnitude(load_run(change, j + count) - turned) * offset)
        ratio = larger(ratio, larger(magnitude(load_run(change, j + 3 * count)) * speed, magnitude(load_run(change, j + 4 * count)) * spin))
        highest_ratio = larger(highest_ratio, ratio)
        finite += load_run(change, j) + load_run(change, j + count) + load_run(change, j + 3 * count) + load_run(change, j + 4 * count)
    largest, passed = highest(highest_ratio), total(finite)
    for j in range(ROLLERS + whole * LANES, ROLLERS + count):
        ratio = max(abs(change[j]) * position, abs(change[j + count] - turned) * offset)
        largest = max(largest, ratio, abs(change[j + 3 * count]) * speed, abs(change[j + 4 * count]) * spin)
        passed += change[j] + change[j + count] + change[j + 3 * count] + change[j + 4 * count]
    return largest if math.isfinite(passed) else passed  # a comparison with NaN would lose it


@fused
def restrain(y, change, model, work):
    """Shorten the correction of an iteration; see `bearing_sim.levels.common.rollers.restrain_rollers`."""
    restrain_rollers(ROLLER, CONTACT, RUNS, y, change, model.params, work.rollers, work.contacts)


@fused
def step_limit(t, y, model, work):
    """Return the longest sensible step [s] (see `bearing_sim.levels.common.model.ring_step`)."""
    return ring_step(y[OMEGA], model.params, work.ring_stiffness)


@fused
def sum_up(t, h, y, model, work):
    """Take the loads of a step of length ``h`` [s], and the stiffness at its end, into the running means over a cage turn, and count damage.

    After a step, ``work`` holds loads of the second-last iterate; they are carried to ``y``, because contact loads are stiff.
    """
    carry_forces(y, model.params.rollers.count, work)
    average_step(ROLLER, CONTACT, h * y[OMEGA], model, work)
    if turn_is_over(t, h, model, work.tally):
        oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
        count_damage(t, equivalent_loads(work.load_moments, oil, model.params.life), oil, model, work.tally)


@kernel
def observe(t, y, model, work, interval, previous, row, memory):
    """Write the sample of state ``y``; parameters as in `bearing_sim.levels.slip.model.observe`."""
    oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
    equivalent = equivalent_loads(work.load_moments, oil, model.params.life)
    observe_level(LAYOUT, ROLLER, CONTACT, rhs, planar_powers, t, y, oil, equivalent, model, work, interval, previous, row, memory)


KERNELS = Kernels(rhs, rhs_and_jacobian, predict, factor, solve, error_norm, correction_norm, restrain, step_limit, sum_up, observe)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control, or ``fixed`` in steps of ``maximum_step`` [s]; see `bearing_sim.levels.common.advance.advance_by`."""
    return advance_by(KERNELS, fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
