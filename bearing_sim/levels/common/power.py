# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause: where the work of the shaft goes; one balance for all levels.

At each instant, with exactly the forces of the level's equations of motion,

    shaft_power + (power of the radial load) = sum of the losses + d(kinetic + elastic energy)/dt.

A loss is force times sliding speed, or force times rate of approach.  The shaft puts power in through the tractions on the inner
ring, through the resistance to rolling there, through the mixture in the cage's bore, through guide lands where they are the inner ring's, through
its flanges, through seals, and through an unbalance; what the ring and the shaft do to the mixture elsewhere is outside the model.
"""

import math
from typing import NamedTuple

from bearing_sim.levels.common.model import shaft_speed_at
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES
from bearing_sim.numerics.time_stepping import INNER_STAGE
from bearing_sim.numerics.tr_bdf2 import WEIGHT
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.drag import bore_torque, mixture_torque


class Powers(NamedTuple):
    """Power by cause [W]; the fields are those of `bearing_sim.model.sample` without the ending ``_power``."""

    shaft: float
    inner_sliding: float
    outer_sliding: float
    inner_rolling: float
    outer_rolling: float
    churning: float
    windage: float
    land: float
    pocket: float
    damping: float
    seal: float
    flange: float
    support: float


@kernel
def write_powers(powers, row):
    """Write the losses into a flat sample (see `bearing_sim.model.sample.flat`), whose columns have the order of `Powers`."""
    for k in range(1, len(powers)):
        row[COLUMN.shaft_power + k] = powers[k]


@kernel
def write_step_powers(rhs, state_powers, t, y, model, work, memory, row):
    """Write the losses of the step that ended at ``t`` in state ``y``, or those of the state itself before the first step, into a flat sample.

    The work in a step of tr_bdf2 is that of its beginning, of Y_1 and of its end, with the weights w, w and 1 - 2 w.  One step's end is the next
    one's beginning, so that w P(Y_1) + (1 - w) P(y) has the same mean.  At the end alone stiff forces, those of pockets above all, are too large
    where a step is long beside their own times.  The right-hand side at ``y`` is in ``work`` afterwards.

    Parameters
    ----------
    rhs : kernel of the level.
    state_powers : kernel of the level, ``(t, y, shaft_speed, model, work)``, that returns the `Powers` of the state in ``work``.
    """
    time, stage, weight = memory.stage_time[0], memory.scratch[INNER_STAGE], 1.0
    if not math.isnan(time):
        rhs(time, stage, model, work, memory.scratch[0])
        write_powers(state_powers(time, stage, shaft_speed_at(time, model.drive), model, work), row)
        weight = 1.0 - WEIGHT
    rhs(t, y, model, work, memory.scratch[0])
    powers = state_powers(t, y, shaft_speed_at(t, model.drive), model, work)
    for k in range(1, len(powers)):
        before = row[COLUMN.shaft_power + k]
        row[COLUMN.shaft_power + k] = powers[k] if weight == 1.0 else before + weight * (powers[k] - before)


@kernel
def sliding_power(contacts, first, count):
    """Return the power lost by sliding between one raceway and all rollers [W]: T du of each.

    Parameters
    ----------
    contacts : rows `bearing_sim.physics.contact.CONTACT`, tractions computed.
    first : the raceway's first block.
    count : number of rollers.
    """
    lost = 0.0
    for j in range(count):
        block, lane = first + j // LANES, j % LANES
        lost += contacts[block, CONTACT.force, lane] * contacts[block, CONTACT.sliding, lane]
    return lost


@kernel
def rolling_power(contacts, first, count):
    """Return the power lost by resistance to rolling between one raceway and all rollers [W]: 2 F_R u of each; parameters as of `sliding_power`."""
    lost = 0.0
    for j in range(count):
        block, lane = first + j // LANES, j % LANES
        lost += 2.0 * contacts[block, CONTACT.resistance, lane] * contacts[block, CONTACT.rolling, lane]
    return lost


@kernel
def seal_power(shaft_speed, params):
    """Return the power that seals take from the shaft, and lose [W]."""
    return params.envelope.seal_moment * abs(shaft_speed)


@kernel
def shaft_traction_power(contacts, count, shaft_speed, inner_radius):
    """Return the power of the shaft through the tractions and the resistance to rolling on the inner ring [W]: their torque times its speed.

    Parameters
    ----------
    contacts : rows `bearing_sim.physics.contact.CONTACT`, the inner contacts first.
    count : number of rollers.
    shaft_speed : [rad/s].
    inner_radius : R_i [m].
    """
    force = 0.0
    for j in range(count):
        force += contacts[j // LANES, CONTACT.force, j % LANES] + contacts[j // LANES, CONTACT.resistance, j % LANES]
    return force * inner_radius * shaft_speed


@kernel
def windage_powers(cage_speed, shaft_speed, params, lubrication):
    """Return what the shaft puts into the mixture in the cage's bore and what cage and shaft lose to the mixture there [W].

    Heat in the bore is torque times the difference of both speeds, on the cage's other faces torque times cage speed.

    Parameters
    ----------
    cage_speed, shaft_speed : [rad/s].
    params, lubrication : of the bearing, see `bearing_sim.model.params`.
    """
    driven = bore_torque(cage_speed, shaft_speed, params, lubrication)[0] * shaft_speed
    return driven, driven - mixture_torque(cage_speed, shaft_speed, params, lubrication)[0] * cage_speed
