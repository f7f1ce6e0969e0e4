# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``planar``: every roller, the cage and the inner ring move in the plane.  Left out: tilt and skew.

State and memory: `bearing_sim.levels.planar.state`; equations: `bearing_sim.levels.planar.forces`; their Jacobian and the linear algebra of
implicit steps: `bearing_sim.levels.planar.jacobian`.
"""

import math

from bearing_sim.levels.common.flanges import observe_flanges
from bearing_sim.levels.common.model import POSITION_WEIGHT, orbital_speed_tolerance, play_weight, ring_step, ring_weight, shaft_speed_at
from bearing_sim.levels.common.observation import average_moments, count_damage, observe_course, observe_rest, oil_at_speed, turn_is_over
from bearing_sim.levels.common.power import step_powers, write_powers
from bearing_sim.levels.common.rollers import average_stiffness, land_eccentricity, observe_rollers, restrain_rollers
from bearing_sim.levels.common.state_transfer import first_cage_centre, rolling_state
from bearing_sim.levels.common.support import factor_level, observe_support, place_support, solve_level, support_change
from bearing_sim.levels.planar import state as planar_state
from bearing_sim.levels.planar.forces import carry_forces, equations
from bearing_sim.levels.planar.power import planar_powers
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
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, highest, larger, load_run, magnitude, spread, total
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

    A step leaves the loads of its last iterate but one, and only a micrometre away a load may be another altogether.
    """
    count, turned = model.params.rollers.count, h * y[OMEGA]
    carry_forces(y, count, work)
    fraction = 1.0 - math.exp(-abs(turned) / (2.0 * math.pi))
    average_moments(fraction, work.rollers, ROLLER.present, work.contacts, CONTACT.load, count, work.load_moments, work.last_moments, work.tally)
    average_stiffness(ROLLER, CONTACT, fraction, work.rollers, work.contacts, work.ring_stiffness)
    if turn_is_over(t, h, model, work.tally):
        oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
        count_damage(t, equivalent_loads(work.load_moments, oil, model.params.life), oil, model, work.tally)


@kernel
def _powers(t, y, model, work, memory):
    """Return the powers of the step that ended at ``t`` in state ``y`` (see `step_powers`)."""
    return step_powers(rhs, planar_powers, t, y, model, work, memory)


@kernel
def observe(t, y, model, work, interval, previous, row, memory):
    """Write the sample of state ``y``; parameters as in `bearing_sim.levels.slip.model.observe`."""
    powers = _powers(t, y, model, work, memory)
    rows, count = work.rollers, model.params.rollers.count
    oil = oil_at_speed(shaft_speed_at(t, model.drive), model)
    equivalent = equivalent_loads(work.load_moments, oil, model.params.life)
    observe_course(t, y[THETA], y[OMEGA], equivalent, oil, model, interval, previous, work.tally, row)
    row[COLUMN.ring_y], row[COLUMN.ring_z] = y[RING_Y], y[RING_Z]
    row[COLUMN.cage_y], row[COLUMN.cage_z] = y[CAGE_Y], y[CAGE_Z]
    observe_support(y, y[RING_Y], y[RING_Z], model.params.support, row)
    row[COLUMN.land_eccentricity] = land_eccentricity(y[RING_Y], y[RING_Z], y[CAGE_Y], y[CAGE_Z], model.params.cage)
    write_powers(powers, row)
    if model.params.flanges.on:
        observe_flanges(ROLLER, CONTACT.load, count, model.params.flanges, rows, work.contacts, row)
    observe_rollers(ROLLER, CONTACT.load, count, interval, rows, work.contacts, previous, row)
    observe_rest(interval, previous, model.params, work.tally, row)
