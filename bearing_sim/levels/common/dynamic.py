# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What levels ``planar`` and ``spatial`` do alike with their whole state: first guesses, norms, sums over steps, samples.

A level passes its layout (`bearing_sim.numerics.block_arrow.Layout`) and the records of its rows (`bearing_sim.levels.common.rollers`), which are
constants to the compiler.  The border is the inner ring, y and z first, and the cage: y and z first, its angle last; tilts stand behind y and z.
"""

import math

from bearing_sim.levels.common.flanges import observe_flanges
from bearing_sim.levels.common.model import POSITION_WEIGHT, orbital_speed_tolerance, play_weight, ring_step, ring_weight
from bearing_sim.levels.common.observation import average_moments, observe_course, observe_rest
from bearing_sim.levels.common.power import write_step_powers
from bearing_sim.levels.common.rollers import average_stiffness, land_eccentricity, observe_rollers, restrain_rollers
from bearing_sim.levels.common.support import extrapolate_support, factor_level, observe_support, solve_level, support_change
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, highest, larger, load, load_run, magnitude, spread, store_run, total
from bearing_sim.numerics.time_stepping import Kernels

TILT = 2  # where the tilts begin, behind two positions, of ring, cage and rollers; level ``planar`` has none


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


@fused
def _largest_ratio(layout, runs, t, y, change, model, position_weight, own_ring_weight, own_play_weight):
    """Return the largest ratio of any state's change to its tolerance, positions, but not tilts, the ring's, and play with weights of their own.

    Positions are the rollers' radii and the ring's centre; play have the rollers in their pockets and the cage.  Spins count by the speed of the
    roller's surface, tilts by what they move the end of a roller, a raceway or a land; skew and the cage's tilts have play.  Radial speeds and those
    of both centres follow the positions and are not weighed.
    """
    raceways, rollers, cage, border, tilts = model.params.raceways, model.params.rollers, layout.size[0], layout.border, layout.positions > TILT
    position, play, half = position_weight / model.tolerances.position, own_play_weight / model.tolerances.play, 0.5 * rollers.length
    speed = 1.0 / orbital_speed_tolerance(t, y[2 * border - 1], model)
    offset, spin = play * raceways.pitch_radius, speed * rollers.radius / raceways.pitch_radius
    tilt, skew = half / model.tolerances.position, play * half
    largest = max(max(abs(change[0]), abs(change[1])) * own_ring_weight * position, max(abs(change[cage]), abs(change[cage + 1])) * play)
    largest = max(largest, abs(change[2 * border - 1]) * speed)
    if tilts:
        largest = max(largest, max(abs(change[TILT]), abs(change[TILT + 1])) * tilt)
        largest = max(largest, max(abs(change[cage + TILT]), abs(change[cage + TILT + 1])) * play * model.params.tilts.land_position)
    count, first = rollers.count, runs.first
    if change.shape[0] > first + layout.block * count:
        largest = max(largest, support_change(change) * position)
    whole, turned = count // LANES, change[border - 1]
    highest_ratio, finite = spread(largest), spread(0.0)
    for block in range(whole):
        j = first + block * LANES
        radial, orbital = load_run(change, j), load_run(change, j + runs.angle * count)
        orbital_speed, spinning = load_run(change, j + runs.orbital_speed * count), load_run(change, j + runs.spin * count)
        ratio = larger(magnitude(radial) * position, magnitude(orbital - turned) * offset)
        ratio = larger(ratio, larger(magnitude(orbital_speed) * speed, magnitude(spinning) * spin))
        finite += (radial + orbital) + (orbital_speed + spinning)
        if tilts:
            tilting, skewing = load_run(change, j + TILT * count), load_run(change, j + (TILT + 1) * count)
            ratio = larger(ratio, larger(magnitude(tilting) * tilt, magnitude(skewing) * skew))
            finite += tilting + skewing
        highest_ratio = larger(highest_ratio, ratio)
    largest, passed = highest(highest_ratio), total(finite)
    for j in range(first + whole * LANES, first + count):
        ratio = max(abs(change[j]) * position, abs(change[j + runs.angle * count] - turned) * offset)
        largest = max(largest, ratio, abs(change[j + runs.orbital_speed * count]) * speed, abs(change[j + runs.spin * count]) * spin)
        passed += change[j] + change[j + runs.angle * count] + change[j + runs.orbital_speed * count] + change[j + runs.spin * count]
        if tilts:
            largest = max(largest, abs(change[j + TILT * count]) * tilt, abs(change[j + (TILT + 1) * count]) * skew)
            passed += change[j + TILT * count] + change[j + (TILT + 1) * count]
    return largest if math.isfinite(passed) else passed  # a comparison with NaN would lose it


def dynamic_kernels(layout, row, contact, runs, equations, rhs, predict, step_taken, observe) -> Kernels:
    """Return the kernels of a level, of which the last four are its own.

    Parameters
    ----------
    layout, row, contact : of the level, see the docstring of the module.
    runs : `bearing_sim.levels.common.rollers.StateRuns` of the level.
    equations : kernel, ``(t, y, model, work, rate, with_jacobian)``.
    """

    @fused
    def rhs_and_jacobian(t, y, model, work, rate):
        """Write dy/dt into ``rate`` and all derivatives into ``work``."""
        return equations(t, y, model, work, rate, True)

    @fused
    def factor(shift, work):
        """Factor I - shift J; return False where it is singular."""
        return factor_level(layout, shift, work)

    @fused
    def solve(work, x):
        """Replace the right side ``x`` by the solution with the last factorisation."""
        solve_level(layout, work, x)

    @fused
    def error_norm(t, y, change, model):
        """Return the largest ratio of any state's change to its tolerance."""
        return _largest_ratio(layout, runs, t, y, change, model, 1.0, ring_weight(t, model), 1.0)

    @fused
    def correction_norm(t, y, change, model):
        """Return `error_norm` of an iteration's correction, in which positions have the weight `POSITION_WEIGHT`, and play `play_weight`."""
        play = play_weight(y[2 * layout.border - 1], model.params.raceways.pitch_radius)
        return _largest_ratio(layout, runs, t, y, change, model, POSITION_WEIGHT, 1.0, play)

    @fused
    def restrain(y, change, model, work):
        """Shorten the correction of an iteration; see `bearing_sim.levels.common.rollers.restrain_rollers`."""
        restrain_rollers(row, contact, runs, y, change, model.params, work.rollers, work.contacts)

    @fused
    def step_limit(t, y, model, work):
        """Return the longest sensible step [s] (see `bearing_sim.levels.common.model.ring_step`)."""
        return ring_step(y[2 * layout.border - 1], model.params, work.ring_stiffness)

    return Kernels(rhs, rhs_and_jacobian, predict, factor, solve, error_norm, correction_norm, restrain, step_limit, step_taken, observe)
