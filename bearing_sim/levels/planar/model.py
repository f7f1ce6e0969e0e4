# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``planar``: every roller, the cage and the inner ring move in the plane.  Left out: tilt and skew.

State and memory: `bearing_sim.levels.planar.state`; equations: `bearing_sim.levels.planar.forces`; their Jacobian and the linear algebra of
implicit steps: `bearing_sim.levels.planar.jacobian`.
"""

from bearing_sim.levels.common.advance import advance_by
from bearing_sim.levels.common.bending import observe_ring
from bearing_sim.levels.common.dynamic import average_step, dynamic_kernels, observe_level
from bearing_sim.levels.common.model import shaft_speed_at
from bearing_sim.levels.common.observation import count_damage, oil_at_speed, turn_is_over
from bearing_sim.levels.common.state_transfer import first_cage_centre, rolling_state
from bearing_sim.levels.common.support import place_support
from bearing_sim.levels.planar import state as planar_state
from bearing_sim.levels.planar.forces import carry_forces, equations
from bearing_sim.levels.planar.power import planar_powers
from bearing_sim.levels.planar.predictor import predict
from bearing_sim.levels.planar.state import (
    CAGE_Y,
    CAGE_Z,
    LAYOUT,
    OMEGA,
    RING_Y,
    RING_Z,
    ROLLER,
    RUNS,
)
from bearing_sim.model.params import Params
from bearing_sim.numerics.compilation import fused, kernel
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
    observe_ring(work.bending, model.params.rollers.count, row)


KERNELS = dynamic_kernels(LAYOUT, ROLLER, CONTACT, RUNS, equations, rhs, predict, sum_up, observe)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance with error control, or ``fixed`` in steps of ``maximum_step`` [s]; see `bearing_sim.levels.common.advance.advance_by`."""
    return advance_by(KERNELS, fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
