# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What levels ``planar`` and ``spatial`` do alike with their whole state: first guesses, sums over steps, samples.

A level passes its layout (`bearing_sim.numerics.block_arrow.Layout`) and the records of its rows (`bearing_sim.levels.common.rollers`), which are
constants to the compiler.  The border is the inner ring, y and z first, and the cage: y and z first, its angle last.
"""

import math

from bearing_sim.levels.common.flanges import observe_flanges
from bearing_sim.levels.common.observation import average_moments, observe_course, observe_rest
from bearing_sim.levels.common.power import write_step_powers
from bearing_sim.levels.common.rollers import average_stiffness, land_eccentricity, observe_rollers
from bearing_sim.levels.common.support import extrapolate_support, observe_support
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, load, store_run


@fused
def extrapolate(layout, known, shift, slope, count, guess):
    """Extrapolate speeds by their rates, and write the positions that belong to them; the first position of a roller is left to its equation.

    Parameters
    ----------
    known, shift, slope, guess : as in `bearing_sim.numerics.time_stepping.Kernels`.
    count : of rollers.
    """
    border, positions, first = layout.border, layout.positions, 2 * layout.border
    for k in range(border):
        guess[border + k] = known[border + k] + shift * slope[border + k]
        guess[k] = known[k] + shift * guess[border + k]
    for j in range(first + (positions + 1) * count, first + layout.block * count):
        guess[j] = known[j] + shift * slope[j]
    for j in range(first + count, first + positions * count):
        guess[j] = known[j] + shift * guess[j + positions * count]
    extrapolate_support(known, shift, slope, first + layout.block * count, guess)


@fused
def write_guess(layout, k, row, before, known, shift, count, rows, guess):
    """Write the k-th position of all rollers, which stands in a row, and the speed that has led to it from what a stage builds on, row ``before``."""
    per_shift, whole, speeds = 1.0 / shift, count // LANES, layout.positions * count
    first = 2 * layout.border + k * count
    for block in range(whole):
        position, at = load(rows, block, row), first + block * LANES
        store_run(guess, at, position)
        store_run(guess, at + speeds, (position - load(rows, block, before)) * per_shift)
    for j in range(whole * LANES, count):
        guess[first + j] = rows[whole, row, j - whole * LANES]
        guess[first + j + speeds] = (guess[first + j] - known[first + j]) * per_shift


@fused
def average_step(row, contact, turned, model, work):
    """Include the loads of a step, and the stiffness at its end, in the running means over a cage turn.

    Parameters
    ----------
    row, contact : rows of the rollers and of the contacts.
    turned : by the cage in the step [rad].
    model, work : of the level; loads are those at the end of the step.
    """
    fraction, rows, contacts = 1.0 - math.exp(-abs(turned) / (2.0 * math.pi)), work.rollers, work.contacts
    count = model.params.rollers.count
    average_moments(fraction, rows, row.present, contacts, contact.load, count, work.load_moments, work.last_moments, work.tally)
    average_stiffness(row, contact, fraction, rows, contacts, work.ring_stiffness)


@kernel
def observe_level(layout, row, contact, rhs, state_powers, t, y, oil, equivalent, model, work, interval, previous, sample, memory):
    """Write what both levels observe of state ``y``.

    Parameters
    ----------
    layout, row, contact : of the level.
    rhs, state_powers : kernels of the level, see `write_step_powers`.
    oil, equivalent : see `bearing_sim.levels.common.observation.observe_course`.
    sample : row of a flat sample; for the others see `bearing_sim.levels.slip.model.observe`.
    """
    params, rows, border, cage = model.params, work.rollers, layout.border, layout.size[0]
    count = params.rollers.count
    write_step_powers(rhs, state_powers, t, y, model, work, memory, sample)
    observe_course(t, y[border - 1], y[2 * border - 1], equivalent, oil, model, interval, previous, work.tally, sample)
    sample[COLUMN.ring_y], sample[COLUMN.ring_z] = y[0], y[1]
    sample[COLUMN.cage_y], sample[COLUMN.cage_z] = y[cage], y[cage + 1]
    observe_support(y, y[0], y[1], params.support, sample)
    sample[COLUMN.land_eccentricity] = land_eccentricity(y[0], y[1], y[cage], y[cage + 1], params.cage)
    if params.flanges.on:
        observe_flanges(row, contact.load, count, params.flanges, rows, work.contacts, sample)
    observe_rollers(row, contact.load, count, interval, rows, work.contacts, previous, sample)
    observe_rest(interval, previous, params, work.tally, sample)
