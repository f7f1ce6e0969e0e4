# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What every level observes in the same way: inputs, slip, life and damage; and running means of loads for lives at dynamic levels."""

import math

from bearing_sim.levels.common.model import load_at, shaft_speed_at
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import load, spread, square_root, total
from bearing_sim.physics.growth import clearance_at
from bearing_sim.physics.rating_life import oil_factors, rate_lives


@kernel
def oil_at_speed(shaft_speed, model):
    """Return the `bearing_sim.physics.rating_life.OilFactors` of a level's model at a shaft speed [rad/s]."""
    params = model.params
    return oil_factors(shaft_speed, model.lubrication.kinematic_viscosity, 2.0 * params.raceways.pitch_radius, params.life)


@kernel
def observe_course(t, cage_angle, cage_speed, equivalent, oil, model, interval, previous, row):
    """Write inputs, cage, slip, lives and damage of one instant.

    Damage counts the modified life by the method of the scene.

    Parameters
    ----------
    cage_angle, cage_speed : of the cage [rad, rad/s].
    equivalent : `bearing_sim.physics.lamina_life.EquivalentLoads`.
    oil : `oil_at_speed` of the instant.
    model : a level's model with params, lubrication and drive.
    interval : time since the previous sample [s]; damage and angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.model.sample.flat`.
    """
    params, ratio = model.params, model.params.raceways.diameter_ratio
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
    _write_clearance(clearance_at(shaft_speed, model.lubrication.growth, params), row)
    row[COLUMN.cage_angle] = cage_angle
    row[COLUMN.cage_speed] = cage_speed
    row[COLUMN.ideal_cage_angle] = previous[COLUMN.ideal_cage_angle] + 0.5 * rotation * (1.0 - ratio)
    row[COLUMN.ideal_cage_speed] = ideal
    row[COLUMN.cage_slip] = 1.0 - cage_speed / ideal if ideal != 0.0 else math.nan
    row[COLUMN.inner_equivalent_load] = equivalent.inner
    row[COLUMN.outer_equivalent_load] = equivalent.outer
    row[COLUMN.inner_lamina_load] = equivalent.inner_lamina
    row[COLUMN.outer_lamina_load] = equivalent.outer_lamina
    lives = rate_lives(math.hypot(load_y, load_z), equivalent, oil, params.life)
    _write_lives(lives, 2.0 * math.pi / (3600.0 * abs(shaft_speed)), row)
    row[COLUMN.damage] = previous[COLUMN.damage] + abs(rotation) / (2.0 * math.pi * lives.modified)


@kernel
def _write_clearance(clearance, row):
    """Write a `bearing_sim.physics.growth.Clearance`."""
    row[COLUMN.running_clearance] = clearance.running
    row[COLUMN.initial_clearance] = clearance.initial
    row[COLUMN.fit_clearance] = clearance.fits
    row[COLUMN.rotation_clearance] = clearance.rotation
    row[COLUMN.heat_clearance] = clearance.heat
    row[COLUMN.contour_clearance] = clearance.contour


@kernel
def _write_lives(lives, hours, row):
    """Write lives and what they follow from; ``hours`` is the duration of a revolution [h]."""
    row[COLUMN.rating_life] = hours * lives.basic
    row[COLUMN.modified_rating_life] = hours * lives.modified
    row[COLUMN.l10] = hours * lives.l10
    row[COLUMN.lnm] = hours * lives.lnm
    row[COLUMN.l10r] = hours * lives.l10r
    row[COLUMN.lnmr] = hours * lives.lnmr
    row[COLUMN.equivalent_load] = lives.equivalent_load
    row[COLUMN.reference_load] = lives.reference_load
    row[COLUMN.viscosity_ratio] = lives.viscosity_ratio
    row[COLUMN.contamination_factor] = lives.contamination_factor
    row[COLUMN.modification_factor] = lives.modification_factor
    row[COLUMN.reference_modification_factor] = lives.reference_modification_factor
    row[COLUMN.static_safety] = lives.static_safety


@fused
def average_moments(fraction, rows, present_row, contacts, load_row, count, moments, last_moments):
    """Include the loads of a step in the running means over all rollers of `bearing_sim.physics.lamina_life.add_load_moments`.

    A step counts by the mean of the powers at its start and at its end.  By those at its end alone the means would be too low: error control
    takes short steps where loads rise and lengthens them where they fall.

    Parameters
    ----------
    fraction : weight of the step.
    rows, present_row : rows of the rollers, and which of them says whether a lane holds one.
    contacts, load_row : rows of the contacts, those with the inner raceway first, and which of them is the normal force [N].
    count : number of rollers.
    moments : changed in place, shape (2, MOMENTS).
    last_moments : powers at the start of the step, replaced by those at its end, likewise.
    """
    blocks = rows.shape[0]
    inner_0, inner_1, inner_2, inner_3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    outer_0, outer_1, outer_2, outer_3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for block in range(blocks):
        present, q_i, q_e = load(rows, block, present_row), load(contacts, block, load_row), load(contacts, blocks + block, load_row)
        inside = present * (q_i * q_i) * (q_i * q_i)
        outside = present * (q_e * q_e) * (q_e * q_e) * square_root(q_e)
        inner_0 += inside
        inner_1 += inside * q_i
        inner_2 += inside * (q_i * q_i)
        inner_3 += inside * (q_i * q_i) * q_i
        outer_0 += outside
        outer_1 += outside * q_e
        outer_2 += outside * (q_e * q_e)
        outer_3 += outside * (q_e * q_e) * q_e
    share = 1.0 / count
    _fade(moments[0], last_moments[0], fraction, share, inner_0, inner_1, inner_2, inner_3)
    _fade(moments[1], last_moments[1], fraction, share, outer_0, outer_1, outer_2, outer_3)


@kernel
def _fade(means, last, fraction, share, power_0, power_1, power_2, power_3):
    """Take sums over the lanes of four powers, times ``share``, into their running means; ``last`` holds them at the start of the step."""
    _fade_one(means, last, 0, fraction, share * total(power_0))
    _fade_one(means, last, 1, fraction, share * total(power_1))
    _fade_one(means, last, 2, fraction, share * total(power_2))
    _fade_one(means, last, 3, fraction, share * total(power_3))


@kernel
def _fade_one(means, last, k, fraction, now):
    means[k] += fraction * (0.5 * (last[k] + now) - means[k])
    last[k] = now
