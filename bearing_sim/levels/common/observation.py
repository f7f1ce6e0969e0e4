# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What every level observes in the same way: inputs, slip, life and damage; and what it sums up between samples.

**Damage** counts whole turns of the shaft by the life at the end of each, and what has turned since by the life at the sample.  So it does not depend
on how many samples are taken.  Level ``steady`` takes no steps: it counts each interval by the lives at both its ends, see `mean_rate`.

**Largest loads** of rollers are those of all steps since the sample before: samples alone alias with the passing of the rollers.

**The shaft's power** is the sum of the losses, and of what cage, orbits and spins have taken up in the mean since the sample before.  At an
instant it also feeds and drains elastic energy and vibration, many times the losses in a stiff bearing.
"""

import math
from typing import NamedTuple

from bearing_sim.levels.common.model import load_at, shaft_speed_at
from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import highest, larger, load, spread, square_root, total
from bearing_sim.physics.growth import clearance_at
from bearing_sim.physics.rating_life import oil_factors, rate_lives

_STANDS = 1e-9  # [rad/s] assumption: a slower shaft is one of rounding errors, as at the begin of a smooth ramp, and so would be its slip
_DAMAGE_EXPONENT = 10.0 / 3.0  # of a load in the damage of a turn (ISO 281)


class Tally(NamedTuple):
    """Where each sum over time stands in a level's array ``tally``, shape (len(Tally),)."""

    damage: int = 0  # of the turns of the shaft that are over
    turned: int = 1  # by the shaft since then [rad]
    rate: int = 2  # damage per radian at the sample before [1/rad]; level steady
    inner_load: int = 3  # largest of any roller since the sample before [N]
    outer_load: int = 4


TALLY = Tally()


@kernel
def oil_at_speed(shaft_speed, model):
    """Return the `bearing_sim.physics.rating_life.OilFactors` of a level's model at a shaft speed [rad/s]."""
    params = model.params
    viscosity, pitch_diameter = model.lubrication.kinematic_viscosity, 2.0 * params.raceways.pitch_radius
    return oil_factors(shaft_speed, viscosity, pitch_diameter, params.starvation, params.life)


@kernel
def turn_is_over(t, h, model, tally):
    """Count by how much the shaft has turned in a step of length ``h`` [s] that ended at ``t``; return whether its damage is to be counted."""
    tally[TALLY.turned] += abs(shaft_speed_at(t, model.drive)) * h
    return tally[TALLY.turned] >= 2.0 * math.pi


@kernel
def count_damage(t, equivalent, oil, model, tally):
    """Count the damage of what the shaft has turned since it was counted last; parameters as of `observe_course`."""
    tally[TALLY.damage] += tally[TALLY.turned] * damage_rate(t, equivalent, oil, model)
    tally[TALLY.turned] = 0.0


@kernel
def damage_rate(t, equivalent, oil, model):
    """Return the damage of a turn of the shaft by a radian [1/rad], by the modified life; parameters as of `observe_course`."""
    load_y, load_z = load_at(t, model.drive)
    return 1.0 / (2.0 * math.pi * rate_lives(math.hypot(load_y, load_z), equivalent, oil, model.params.life).modified)


@kernel
def mean_rate(before, after):
    """Return the mean damage rate [1/rad] over an interval in which loads change linearly, given those at its ends."""
    if not (before >= 0.0 and after >= 0.0) or abs(after - before) <= 1e-6 * (after + before):
        return 0.5 * (before + after)
    first, last = before ** (1.0 / _DAMAGE_EXPONENT), after ** (1.0 / _DAMAGE_EXPONENT)
    return (last * after - first * before) / ((_DAMAGE_EXPONENT + 1.0) * (last - first))


@kernel
def observe_course(t, cage_angle, cage_speed, equivalent, oil, model, interval, previous, tally, row):
    """Write inputs, cage, slip, lives and damage of one instant.

    Parameters
    ----------
    cage_angle, cage_speed : of the cage [rad, rad/s].
    equivalent : `bearing_sim.physics.lamina_life.EquivalentLoads`.
    oil : `oil_at_speed` of the instant.
    model : a level's model with params, lubrication and drive.
    interval : time since the previous sample [s]; angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.model.sample.flat`.
    tally : see `Tally`; what has turned since its damage counts by the present life.
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
    write_clearance(clearance_at(shaft_speed, model.lubrication.growth, params), row)
    row[COLUMN.cage_angle] = cage_angle
    row[COLUMN.cage_speed] = cage_speed
    row[COLUMN.ideal_cage_angle] = previous[COLUMN.ideal_cage_angle] + 0.5 * rotation * (1.0 - ratio)
    row[COLUMN.ideal_cage_speed] = ideal
    row[COLUMN.cage_slip] = 1.0 - cage_speed / ideal if abs(shaft_speed) >= _STANDS else math.nan
    row[COLUMN.inner_equivalent_load] = equivalent.inner
    row[COLUMN.outer_equivalent_load] = equivalent.outer
    row[COLUMN.inner_lamina_load] = equivalent.inner_lamina
    row[COLUMN.outer_lamina_load] = equivalent.outer_lamina
    lives = rate_lives(math.hypot(load_y, load_z), equivalent, oil, params.life)
    _write_lives(lives, 2.0 * math.pi / (3600.0 * abs(shaft_speed)), row)
    row[COLUMN.damage] = tally[TALLY.damage] + tally[TALLY.turned] / (2.0 * math.pi * lives.modified)


@kernel
def observe_rest(interval, previous, params, tally, row):
    """Write what follows from the rest of a sample: the shaft's power, the friction moment and the largest loads.

    Parameters
    ----------
    interval, previous, tally, row : as of `observe_course`; ``row`` is complete but for these.
    params : of the bearing.
    """
    count = params.rollers.count
    lost = 0.0
    for column in range(COLUMN.inner_sliding_power, COLUMN.support_power + 1):
        lost += row[column]
    gained = _rotational_energy(row, params) - _rotational_energy(previous, params) if interval > 0.0 else 0.0
    row[COLUMN.shaft_power] = lost + gained / interval if math.isfinite(gained) and interval > 0.0 else lost
    write_friction_moment(row)
    for j in range(count):
        tally[TALLY.inner_load] = max(tally[TALLY.inner_load], row[SCALARS + COLUMN.inner_load * count + j])
        tally[TALLY.outer_load] = max(tally[TALLY.outer_load], row[SCALARS + COLUMN.outer_load * count + j])
    row[COLUMN.inner_load_maximum], row[COLUMN.outer_load_maximum] = tally[TALLY.inner_load], tally[TALLY.outer_load]
    tally[TALLY.inner_load] = tally[TALLY.outer_load] = 0.0


@kernel
def _rotational_energy(row, params):
    """Return the kinetic energy of cage, orbits and spins in a flat sample [J]."""
    rollers, count = params.rollers, params.rollers.count
    energy = 0.5 * params.cage.inertia * row[COLUMN.cage_speed] * row[COLUMN.cage_speed]
    for j in range(count):
        along = row[SCALARS + COLUMN.roller_radius * count + j] * row[SCALARS + COLUMN.orbital_speed * count + j]
        spin = row[SCALARS + COLUMN.roller_spin * count + j]
        energy += 0.5 * (rollers.mass * along * along + rollers.inertia * spin * spin)
    return energy


@kernel
def write_friction_moment(row):
    """Write the frictional moment, shaft power over shaft speed [N m], into a flat sample that has both; NaN at rest."""
    speed = row[COLUMN.shaft_speed]
    row[COLUMN.friction_moment] = row[COLUMN.shaft_power] / speed if speed != 0.0 else math.nan


@kernel
def write_clearance(clearance, row):
    """Write a `bearing_sim.physics.growth.Clearance` of a bearing whose outer ring is rigid into a flat sample."""
    row[COLUMN.running_clearance] = clearance.running
    row[COLUMN.initial_clearance] = clearance.initial
    row[COLUMN.fit_clearance] = clearance.fits
    row[COLUMN.rotation_clearance] = clearance.rotation
    row[COLUMN.heat_clearance] = clearance.heat
    row[COLUMN.contour_clearance] = clearance.contour
    row[COLUMN.bending_clearance], row[COLUMN.seat_arc] = 0.0, math.nan


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
def average_moments(fraction, rows, present_row, contacts, load_row, count, moments, last_moments, tally):
    """Include the loads of a step in the running means over all rollers of `bearing_sim.physics.lamina_life.add_load_moments`, and in the largest.

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
    tally : see `Tally`.
    """
    blocks = rows.shape[0]
    inner_largest, outer_largest = spread(tally[TALLY.inner_load]), spread(tally[TALLY.outer_load])
    inner_0, inner_1, inner_2, inner_3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    outer_0, outer_1, outer_2, outer_3 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for block in range(blocks):
        present, q_i, q_e = load(rows, block, present_row), load(contacts, block, load_row), load(contacts, blocks + block, load_row)
        inner_largest, outer_largest = larger(inner_largest, present * q_i), larger(outer_largest, present * q_e)
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
    tally[TALLY.inner_load], tally[TALLY.outer_load] = highest(inner_largest), highest(outer_largest)
    share = 1.0 / count
    _fade(moments[0], last_moments[0], fraction, share, inner_0, inner_1, inner_2, inner_3)
    _fade(moments[1], last_moments[1], fraction, share, outer_0, outer_1, outer_2, outer_3)


@kernel
def _fade(means, last, fraction, share, power_0, power_1, power_2, power_3):
    """Take sums over the lanes of four powers, times ``share``, into their running means; ``last`` holds them at the start of the step."""
    fade_moment(means, last, 0, fraction, share * total(power_0))
    fade_moment(means, last, 1, fraction, share * total(power_1))
    fade_moment(means, last, 2, fraction, share * total(power_2))
    fade_moment(means, last, 3, fraction, share * total(power_3))


@kernel
def fade_moment(means, last, k, fraction, now):
    """Include a step in a running mean, by the mean of its power at the start and at the end."""
    means[k] += fraction * (0.5 * (last[k] + now) - means[k])
    last[k] = now
