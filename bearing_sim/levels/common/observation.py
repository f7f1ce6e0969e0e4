# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What every level observes in the same way: inputs, slip, life and damage; and running means of loads for lives at dynamic levels."""

import math

from bearing_sim.levels.common.model import load_at, shaft_speed_at
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import load, square_root, total
from bearing_sim.physics.rating_life import modified_life_revolutions, rating_life_revolutions

_SLIP_FLOOR = 1.0  # rad/s of ideal cage speed; slip of a bearing at rest is not defined


@kernel
def observe_course(t, cage_angle, cage_speed, inner_equivalent, outer_equivalent, model, interval, previous, row):
    """Write inputs, cage, slip, life and damage of one instant.

    Parameters
    ----------
    cage_angle, cage_speed : of the cage [rad, rad/s].
    inner_equivalent, outer_equivalent : dynamic equivalent roller loads [N].
    model : a level's model with params, lubrication and drive.
    interval : time since the previous sample [s]; damage and angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.model.sample.flat`.
    """
    ratio = model.params.raceways.diameter_ratio
    shaft_speed = shaft_speed_at(t, model.drive)
    load_y, load_z = load_at(t, model.drive)
    ideal = 0.5 * shaft_speed * (1.0 - ratio)
    rotation = 0.5 * (shaft_speed + previous[COLUMN.shaft_speed]) * interval
    row[COLUMN.time] = t
    row[COLUMN.shaft_speed] = shaft_speed
    row[COLUMN.shaft_angle] = previous[COLUMN.shaft_angle] + rotation
    row[COLUMN.load_y] = load_y
    row[COLUMN.load_z] = load_z
    row[COLUMN.oil_temperature] = model.lubrication.temperature
    row[COLUMN.cage_angle] = cage_angle
    row[COLUMN.cage_speed] = cage_speed
    row[COLUMN.ideal_cage_angle] = previous[COLUMN.ideal_cage_angle] + 0.5 * rotation * (1.0 - ratio)
    row[COLUMN.ideal_cage_speed] = ideal
    row[COLUMN.cage_slip] = 1.0 - cage_speed / ideal if abs(ideal) >= _SLIP_FLOOR else math.nan
    revolutions = rating_life_revolutions(inner_equivalent, outer_equivalent, model.params.life)
    row[COLUMN.inner_equivalent_load] = inner_equivalent
    row[COLUMN.outer_equivalent_load] = outer_equivalent
    observe_life(revolutions, revolutions, model, interval, previous, row)


@kernel
def observe_life(revolutions, lamina_revolutions, model, interval, previous, row):
    """Write the lives of one instant and the damage since the start; a level with slices calls it once more with its own.

    Damage counts the modified life: of the lamina life where the scene wants that, of the basic life elsewhere.

    Parameters
    ----------
    revolutions : basic life L10.
    lamina_revolutions : life by slices; L10 at a level without slices.
    model, interval, previous, row : as in `observe_course`, which has written the shaft's speed.
    """
    params, shaft_speed = model.params, row[COLUMN.shaft_speed]
    chosen = lamina_revolutions if params.life.lamina else revolutions
    modified = modified_life_revolutions(chosen, shaft_speed, model.lubrication.kinematic_viscosity, 2.0 * params.raceways.pitch_radius, params.life)
    hours = 2.0 * math.pi / (3600.0 * abs(shaft_speed))
    rotation = 0.5 * (shaft_speed + previous[COLUMN.shaft_speed]) * interval
    row[COLUMN.rating_life] = hours * revolutions
    row[COLUMN.lamina_life] = hours * lamina_revolutions
    row[COLUMN.modified_rating_life] = hours * modified
    row[COLUMN.damage] = previous[COLUMN.damage] + abs(rotation) / (2.0 * math.pi * modified)


@kernel
def average_powers(fraction, rows, present_row, contacts, load_row, count, means):
    """Include the loads of this instant in the running means of Q_i^4 and Q_e^4.5 over all rollers.

    Parameters
    ----------
    fraction : weight of this instant.
    rows, present_row : rows of the rollers, and which of them says whether a lane holds one.
    contacts, load_row : rows of the contacts, those with the inner raceway first, and which of them is the normal force [N].
    count : number of rollers.
    means : changed in place, shape (2,).
    """
    blocks = rows.shape[0]
    inner, outer = 0.0, 0.0
    for block in range(blocks):
        present, q_i, q_e = load(rows, block, present_row), load(contacts, block, load_row), load(contacts, blocks + block, load_row)
        inner += total(present * (q_i * q_i) * (q_i * q_i))
        outer += total(present * (q_e * q_e) * (q_e * q_e) * square_root(q_e))
    means[0] += fraction * (inner / count - means[0])
    means[1] += fraction * (outer / count - means[1])
