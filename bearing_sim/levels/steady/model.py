# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``steady``: the periodic state of level ``slip`` at the present inputs, and how cage and spins follow it.

State: y = (theta_c, omega_c, s) in rad and rad/s, s the cage speed that the spins have followed to.  The cage goes to its speed at the operating
point with the acceleration that it has at its slip, also from the operating point; everything else takes the operating point's value at once.
Operating points come from a table where there is one that holds the inputs, otherwise from `bearing_sim.levels.steady.operating_point`: nothing is
extrapolated.

A sample has the loads, radii and ring position of level ``slip`` at the cage's angle and speed; equivalent loads, lives and
powers are means over a roller pitch.  Roller spins, their angles and pocket forces are not computed: they are NaN.  Left out, besides
what level ``slip`` leaves out: everything that happens within a cage turn, and how the spins of single rollers differ on the way.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import Drive, Model, load_at, shaft_speed_at, write_growth
from bearing_sim.levels.common.observation import TALLY, Tally, damage_rate, mean_rate, observe_course, observe_rest, oil_at_speed
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.slip.model import observe_orbits
from bearing_sim.levels.slip.state import OMEGA, THETA
from bearing_sim.levels.steady.marching import march
from bearing_sim.levels.steady.operating_point import (
    ACCELERATIONS,
    ANSWER,
    CREEP,
    FAILED,
    SCANNED,
    Orbit,
    basin,
    between,
    lag_at,
    new_orbit,
    solve_point,
)
from bearing_sim.levels.steady.table import LookUp, Table, covers, empty_table, look_up, new_look_up
from bearing_sim.model.params import Lubrication
from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.time_stepping import COUNT, NEEDS_POINT, OK, STEP_BUDGET
from bearing_sim.physics.growth import Temperatures, excess_growth, growth_at, seats_at
from bearing_sim.physics.lamina_life import EquivalentLoads
from bearing_sim.physics.thermal_network import BOOK, NODE, NODES, NetworkInputs, oil_properties, step

_NEAR, _EVEN = 0.02, 0.02  # slip, and fraction of the lag; as near, and where the lag changes by less, one step follows exactly
_PIECES = 4  # of an interval in which it changes by more
_MUCH, _MOST_PARTS = 0.01, 16  # change of the settled slip in an interval, by each of which it is cut in one part more
_ROLLS = 0.05  # slip below which a cage's balance is sought from ideal rolling
_HARDLY_FELT = 1.0 + 1e-6  # inertia up to which spins count for nothing
FOLLOWED = 2  # where the state holds the cage speed that the spins have followed to
_FIRST_LOSS = COLUMN.shaft_power + 1  # the losses by cause stand behind the power of the shaft


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    bearing: slip_state.Work  # of level slip
    orbit: Orbit
    table: Table
    scratch: LookUp
    answer: np.ndarray  # at the newest inputs, shape (len(ANSWER),)
    ways: np.ndarray  # how a cage goes, columns as of the answer, where an interval begins and within it; shape (2, ACCELERATIONS.stop)
    wanted: np.ndarray  # condition whose operating point is wanted: speed, loads y and z, temperature; and the cage's slip, shape (5,)
    asked: np.ndarray  # the condition that was last solved for, shape (4,); see `forget`
    solved: np.ndarray  # the answer to it, shape (len(ANSWER),)
    basin: np.ndarray  # slips between which a cage comes to that answer, shape (2,)
    done: np.ndarray  # samples of the present call that are complete, -1 before it has begun, int64, shape (1,)
    tally: np.ndarray  # sums over time, see `bearing_sim.levels.common.observation.Tally`
    solutions: np.ndarray  # operating points solved so far, and how many of them by marching, and without an end to it, int64, shape (3,)


class Condition(NamedTuple):
    """What an operating point is looked up by."""

    shaft_speed: float  # [rad/s]
    load_y: float  # [N]
    load_z: float
    temperature: float  # of the films [K]
    growth: float  # of the inner raceway beyond that of a bearing of one temperature [m]


def new_work(params, table: Table | None = None):
    """Return the level's workspace for a bearing; without a table every operating point is solved."""
    return Work(
        bearing=slip_state.new_work(params),
        orbit=new_orbit(params.rollers.count),
        table=table if table is not None else empty_table(),
        scratch=new_look_up(),
        answer=np.full(len(ANSWER), math.nan),
        ways=np.full((2, ACCELERATIONS.stop), math.nan),
        wanted=np.full(5, math.nan),
        asked=np.full(4, math.nan),
        solved=np.full(len(ANSWER), math.nan),
        basin=np.full(2, math.nan),
        done=np.full(1, -1, np.int64),
        tally=np.zeros(len(Tally._fields)),
        solutions=np.zeros(3, np.int64),
    )


def forget(work):
    """Let the next operating point be solved anew: parameters or lubrication have changed at the same inputs."""
    work.asked[:] = math.nan


def initial_state(params, work, shaft_speed, load_y, load_z):
    """Return the state of ideal rolling: the cage at omega_i (1 - gamma)/2, and spins that go with it."""
    speed = 0.5 * shaft_speed * (1 - params.raceways.diameter_ratio)
    return np.array([0.0, speed, speed])


def solve_condition(shaft_speed: float, load_y: float, load_z: float, model, work: Work, start: float = 0.0, to_standstill: bool = False) -> bool:
    """Solve for an operating point into ``work.solved``, unless it was the last one; return whether it was found.

    Where a cage has several balances under the same inputs, the answer is that to which it comes from its slip.

    Parameters
    ----------
    shaft_speed : [rad/s]; a shaft slower than `CREEP` is taken to turn so fast.
    load_y, load_z : [N].
    model : of the level, its lubrication that of the condition; its drive goes unused.
    work : `Work`.
    start : slip at which the cage begins, 0 in ideal rolling, 1 where it stands.
    to_standstill : see `bearing_sim.levels.steady.operating_point.scan`.
    """
    asked, here = work.asked, (shaft_speed, load_y, load_z, model.lubrication.temperature)
    if tuple(asked) == here and work.basin[0] <= start <= work.basin[1] and not to_standstill:
        return True
    asked[:] = math.nan
    creeps = -CREEP if shaft_speed < 0.0 else CREEP
    drive = Drive(0.0, shaft_speed if abs(shaft_speed) > CREEP else creeps, 0.0, load_y, 0.0, load_z, 0.0, 0.0)
    constant = Model(model.params, model.lubrication, drive, model.tolerances)
    status = solve_point(start, to_standstill or start > 0.0, constant, work.bearing, work.orbit, work.solved)
    work.solutions[0] += 1
    if status == FAILED:
        marched = march(_near_balance(start, work.orbit.scanned), constant, work.solved)
        work.solutions[1] += 1
        work.solutions[2] += marched == STEP_BUDGET
        if marched not in (OK, STEP_BUDGET):
            return False
    asked[:] = here
    work.basin[:] = basin(*between(start, work.orbit.scanned), work.orbit.scanned)
    return True


def _near_balance(start: float, scanned: np.ndarray) -> float:
    """Return a slip near the balance to which a cage goes from one; the same where the scan knows of none."""
    low, high = between(start, scanned)
    return start if low < 0 or high == len(SCANNED) else 0.5 * float(SCANNED[low] + SCANNED[high])


def supply(model, work: Work) -> bool:
    """Solve for the operating point that compiled code has asked for by `NEEDS_POINT`; return whether it was found."""
    speed, load_y, load_z, _, slip = work.wanted.tolist()
    return solve_condition(speed, load_y, load_z, model, work, slip)


@kernel
def _covered(condition, work):
    """Return whether the table answers for a condition."""
    return covers(condition.shaft_speed, math.hypot(condition.load_y, condition.load_z), condition.temperature, condition.growth, work.table)


@kernel
def _from_table(condition, work):
    """Write the table's answer to a condition into ``work.answer``; return whether it has one."""
    if not _covered(condition, work):
        return False
    speed, load_y, load_z, temperature, growth = condition
    look_up(speed, math.hypot(load_y, load_z), temperature, math.atan2(load_z, load_y), growth, work.table, work.scratch, work.answer)
    return math.isfinite(work.answer[ANSWER.cage_slip])


@kernel
def _condition_at(t, model):
    """Return the condition at a time [s]."""
    load_y, load_z = load_at(t, model.drive)
    speed, films = shaft_speed_at(t, model.drive), model.lubrication.film_temperature
    return Condition(speed, load_y, load_z, films, excess_growth(speed, films, model.lubrication.growth, model.params.mounted))


@kernel
def _answer_to(condition, y, model, work):
    """Write the operating point to which a cage comes into ``work.answer``; return whether it is known, else it is wanted.

    Tables have the state that a cage comes to from ideal rolling.
    """
    if _from_table(condition, work):
        return True
    wanted, asked = work.wanted, work.asked
    wanted[0], wanted[1], wanted[2], wanted[3] = condition.shaft_speed, condition.load_y, condition.load_z, model.lubrication.temperature
    wanted[4] = _slip_of(y[OMEGA], condition.shaft_speed, model)
    if not (work.basin[0] <= wanted[4] <= work.basin[1]):
        return False
    for k in range(asked.shape[0]):
        if not asked[k] == wanted[k]:
            return False
    for column in range(work.answer.shape[0]):
        work.answer[column] = work.solved[column]
    return True


@kernel
def _write_sample(t, y, model, work, interval, previous, row):
    """Write the sample of a state; ``work.answer`` is that of the inputs at the time."""
    params, answer = model.params, work.answer
    count, cage_angle, cage_speed = params.rollers.count, y[THETA], y[OMEGA]
    equivalent = EquivalentLoads(
        answer[ANSWER.inner_equivalent_load],
        answer[ANSWER.outer_equivalent_load],
        answer[ANSWER.inner_lamina_load],
        answer[ANSWER.outer_lamina_load],
        answer[ANSWER.reference_modification_factor],
    )
    shaft_speed, tally = shaft_speed_at(t, model.drive), work.tally
    oil = oil_at_speed(shaft_speed, model)
    rate = damage_rate(t, equivalent, oil, model)
    if interval > 0.0:
        turned = 0.5 * abs(shaft_speed + previous[COLUMN.shaft_speed]) * interval
        tally[TALLY.damage] += turned * mean_rate(tally[TALLY.rate], rate)
    tally[TALLY.rate] = rate
    tally[TALLY.inner_load], tally[TALLY.outer_load] = answer[ANSWER.inner_load_maximum], answer[ANSWER.outer_load_maximum]
    observe_course(t, cage_angle, cage_speed, equivalent, oil, model, interval, previous, tally, row)
    for column in range(ANSWER.flange_power - ANSWER.shaft_power + 1):
        row[COLUMN.shaft_power + column] = answer[ANSWER.shaft_power + column]
    load_y, load_z = load_at(t, model.drive)
    write_growth(shaft_speed_at(t, model.drive), model.lubrication.growth, work.bearing.growth)
    balance_loads(cage_angle, cage_speed, load_y, load_z, params, work.bearing)
    observe_orbits(cage_angle, cage_speed, count, work.bearing, row)
    for column in (COLUMN.roller_spin, COLUMN.roller_rotation, COLUMN.pocket_force):
        row[SCALARS + column * count : SCALARS + (column + 1) * count] = math.nan
    observe_rest(interval, previous, params, tally, row)


@kernel
def observe(t, y, model, work, interval, previous, row, memory):
    """Write the sample of state ``y``; return OK, or `NEEDS_POINT` where it lacks an operating point.

    Parameters as of `bearing_sim.levels.slip.model.observe`.
    """
    known = _answer_to(_condition_at(t, model), y, model, work)
    if not known:
        for column in range(work.answer.shape[0]):
            work.answer[column] = math.nan
    _write_sample(t, y, model, work, interval, previous, row)
    return OK if known else NEEDS_POINT


@kernel
def _follow_evenly(before, after, lag, answer, duration, y):
    """Let cage and spins follow, exactly, a speed that changes linearly, with constant coefficients.

    With the lag tau, the inertia I and the delay T of the spins, cage speed w and spins' s:  w' = I (w_settled - w)/tau - (I - 1) s',
    s' = (w - s)/T.
    """
    rise, mean = (after - before) / duration, 0.5 * (before + after)
    away = y[OMEGA] - before + rise * lag  # from the solution that changes linearly
    inertia, delay = answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay]
    if not (inertia > _HARDLY_FELT and delay > 0.0):
        speed = after - rise * lag + away * math.exp(-duration / lag)
        y[THETA] += mean * duration - lag * (speed - y[OMEGA])
        y[OMEGA] = y[FOLLOWED] = speed
        return
    spins_away = y[FOLLOWED] - before + rise * (lag + delay)
    by_cage, by_spins = -(inertia / lag + (inertia - 1.0) / delay), (inertia - 1.0) / delay
    middle, product = 0.5 * (by_cage - 1.0 / delay), inertia / (lag * delay)
    fast = middle - math.sqrt(middle * middle - product)
    slow = product / fast
    one, other = math.exp(slow * duration) / (slow - fast), math.exp(fast * duration) / (slow - fast)
    cage_left = one * ((by_cage - fast) * away + by_spins * spins_away) - other * ((by_cage - slow) * away + by_spins * spins_away)
    spins_left = one * (away / delay - (1.0 / delay + fast) * spins_away) - other * (away / delay - (1.0 / delay + slow) * spins_away)
    speed, followed = after - rise * lag + cage_left, after - rise * (lag + delay) + spins_left
    y[THETA] += mean * duration - lag / inertia * (speed - y[OMEGA] + (inertia - 1.0) * (followed - y[FOLLOWED]))
    y[OMEGA], y[FOLLOWED] = speed, followed


@kernel
def _begin_interval(work):
    """Keep how a cage goes at the newest inputs, where the next interval begins."""
    for column in range(work.ways.shape[1]):
        work.ways[0, column] = work.answer[column]


@kernel
def _write_between(work, fraction):
    """Write how a cage goes at a fraction of an interval into ``work.ways[1]``."""
    for column in range(work.ways.shape[1]):
        work.ways[1, column] = work.ways[0, column] + fraction * (work.answer[column] - work.ways[0, column])


@kernel
def _follow(before, after, shaft_speeds, model, work, duration, y):
    """Let the cage follow a speed that changes linearly; an unknown lag (NaN) counts as 0.

    Parameters
    ----------
    before, after : settled speeds at both ends of an interval [rad/s].
    shaft_speeds : likewise [rad/s].
    model : of the level.
    work : its answer is that at the end.
    duration : of the interval [s].
    y : state, changed in place.
    """
    lag, lag_before = work.answer[ANSWER.lag], work.ways[0, ANSWER.lag]
    if not (lag > 0.0 and lag_before > 0.0):
        y[THETA] += 0.5 * (before + after) * duration
        y[OMEGA] = y[FOLLOWED] = after
        return
    ideals = (_ideal_speed(shaft_speeds[0], model), _ideal_speed(shaft_speeds[1], model))
    sense = 1.0 if shaft_speeds[1] >= 0.0 else -1.0
    farthest = max(abs(before - y[OMEGA]), abs(after - y[OMEGA])) / ideals[1]
    far = max(abs(lag_at(farthest, ideals[1], work.answer) - lag), abs(lag_at(-farthest, ideals[1], work.answer) - lag), abs(lag_before - lag))
    if farthest < _NEAR and far <= _EVEN * lag:
        _follow_evenly(before, after, lag, work.answer, duration, y)
        return
    piece, settled, way = duration / _PIECES, before, work.ways[1]
    for k in range(_PIECES):
        _write_between(work, (k + 0.5) / _PIECES)
        ideal = ideals[0] + (ideals[1] - ideals[0]) * (k + 0.5) / _PIECES
        towards = before + (after - before) * (k + 1) / _PIECES
        angle, speed, followed = y[THETA], y[OMEGA], y[FOLLOWED]
        _follow_evenly(settled, towards, lag_at(sense * (settled - speed) / ideal, ideal, way), way, piece, y)
        halfway = 0.5 * (settled - speed + towards - y[OMEGA])
        y[THETA], y[OMEGA], y[FOLLOWED] = angle, speed, followed
        _follow_evenly(settled, towards, lag_at(sense * halfway / ideal, ideal, way), way, piece, y)
        settled = towards


@kernel
def _slip_of(cage_speed, shaft_speed, model):
    """Return the slip from which a cage's balance is sought: none where it is near ideal rolling, 1 where it turns against the shaft."""
    ideal = _ideal_speed(shaft_speed, model)
    slip = 1.0 - (cage_speed if shaft_speed >= 0.0 else -cage_speed) / ideal
    return 0.0 if abs(slip) < _ROLLS else min(slip, 1.0)


@kernel
def _ideal_speed(shaft_speed, model):
    """Return the speed of a cage without slip, without sign [rad/s]."""
    return 0.5 * max(abs(shaft_speed), CREEP) * (1.0 - model.params.raceways.diameter_ratio)


@kernel
def _settled_speed(shaft_speed, slip, model):
    return 0.5 * shaft_speed * (1.0 - model.params.raceways.diameter_ratio) * (1.0 - slip)


@kernel
def _condition_between(begin, end, fraction):
    """Return the condition at a fraction of an interval in which all inputs change linearly."""
    return Condition(
        begin.shaft_speed + (end.shaft_speed - begin.shaft_speed) * fraction,
        begin.load_y + (end.load_y - begin.load_y) * fraction,
        begin.load_z + (end.load_z - begin.load_z) * fraction,
        begin.temperature + (end.temperature - begin.temperature) * fraction,
        begin.growth + (end.growth - begin.growth) * fraction,
    )


@kernel
def _follow_inputs(begin, end, duration, model, work, y):
    """Let the cage follow inputs that change linearly; afterwards ``work`` is ready for the next interval.

    Where the settled slip changes much, a table is asked for inputs in between, too.

    Parameters
    ----------
    begin, end : `Condition`; ``work`` has the answers to both.
    duration : [s].
    model : of the level.
    work : `Work`.
    y : state, changed in place.
    """
    first_slip, last_slip, parts = work.ways[0, ANSWER.cage_slip], work.answer[ANSWER.cage_slip], 1
    if _covered(begin, work) and _covered(end, work):
        parts += min(int(abs(last_slip - first_slip) / _MUCH), _MOST_PARTS - 1)
    settled, speed = _settled_speed(begin.shaft_speed, first_slip, model), begin.shaft_speed
    for k in range(1, parts):
        there = _condition_between(begin, end, k / parts)
        if not _from_table(there, work):  # beside a node without an answer
            for column in range(work.ways.shape[1]):
                work.answer[column] = work.ways[0, column]
        reached = _settled_speed(there.shaft_speed, work.answer[ANSWER.cage_slip], model)
        _follow(settled, reached, (speed, there.shaft_speed), model, work, duration / parts, y)
        _begin_interval(work)
        settled, speed = reached, there.shaft_speed
    if parts > 1:
        _from_table(end, work)
    _follow(settled, _settled_speed(end.shaft_speed, last_slip, model), (speed, end.shaft_speed), model, work, duration / parts, y)
    _begin_interval(work)


@kernel
def advance(fixed, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance sample by sample; parameters and results as in `bearing_sim.levels.common.advance.advance_by`.

    A step is a sample: the inputs change linearly between samples, and so does the speed that the cage follows.  Where an operating point is
    wanted the status is `NEEDS_POINT`: once it is supplied, another call with the same arguments goes on from there.
    """
    samples, done = rows.shape[0], work.done
    interval = duration / samples
    if done[0] < 0:
        if not _answer_to(_condition_at(t, model), y, model, work):
            return NEEDS_POINT, h
        _begin_interval(work)
        done[0] = 0
    for k in range(done[0], samples):
        begin, end = _condition_at(t + k * interval, model), _condition_at(t + (k + 1) * interval, model)
        if not _answer_to(end, y, model, work):
            return NEEDS_POINT, h
        _follow_inputs(begin, end, interval, model, work, y)
        counts[COUNT.steps] += 1
        counts[COUNT.unsettled_points] = work.solutions[2]
        _write_sample(t + (k + 1) * interval, y, model, work, interval, previous if k == 0 else rows[k - 1], rows[k])
        done[0] = k + 1
    done[0] = -1
    return OK, h


@kernel
def _warmed(lubrication, inlet, growth, viscosity, film_temperature):
    """Return a lubrication at other temperatures as far as samples show it; tractions and drags, which no table needs, stay.

    Parameters
    ----------
    lubrication : `bearing_sim.model.params.Lubrication`.
    inlet, film_temperature : of the oil that comes in, and the mean of the films [K].
    growth : `bearing_sim.physics.growth.Growth`.
    viscosity : nu in the films [m^2/s].
    """
    return Lubrication(
        lubrication.inner,
        lubrication.outer,
        lubrication.viscosity,
        lubrication.density,
        lubrication.mixture_density,
        lubrication.mixture_flow,
        inlet,
        lubrication.rolling_resistance,
        lubrication.bath,
        growth,
        viscosity,
        film_temperature,
    )


@kernel
def advance_profile(start, stretches, inputs, kinematic_viscosities, y, model, work, counts, previous, rows):
    """Advance from instant to instant of a course of inputs, for as long as the table holds them.

    Time is summed stretch by stretch, as `bearing_sim.simulation.Simulation.advance` does: how a course is cut into calls changes nothing.

    Parameters
    ----------
    start : time of the state [s].
    stretches : time from each instant to the next [s], positive, shape (n,).
    inputs : shaft speed [rad/s], load y, load z [N], oil temperature [K] before the first instant and at each, shape (n + 1, 4).
    kinematic_viscosities : of the oil at each instant [m^2/s], shape (n,).
    y : state, advanced in place.
    model : of the level; its drive goes unused, and of its lubrication what depends on temperature.
    work, counts, previous : as in `advance`.
    rows : flat samples, shape (n, SCALARS + runs * Z).

    Returns
    -------
    how many instants were reached; the state is that of the last of them.
    """
    lubrication, mounted = model.lubrication, model.params.mounted
    begin, before, now = Condition(inputs[0, 0], inputs[0, 1], inputs[0, 2], inputs[0, 3], 0.0), previous, start
    if not _from_table(begin, work):
        return 0
    _begin_interval(work)
    for k in range(stretches.shape[0]):
        speed, load_y, load_z, temperature = inputs[k + 1, 0], inputs[k + 1, 1], inputs[k + 1, 2], inputs[k + 1, 3]
        end = Condition(speed, load_y, load_z, temperature, 0.0)
        if not _from_table(end, work):
            return k
        interval = stretches[k]
        now += interval
        _follow_inputs(begin, end, interval, model, work, y)
        counts[COUNT.steps] += 1
        growth = growth_at(mounted, Temperatures(temperature, temperature, temperature, temperature, temperature))
        warmed = _warmed(lubrication, temperature, growth, kinematic_viscosities[k], temperature)
        there = Model(model.params, warmed, Drive(now, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0), model.tolerances)
        _write_sample(now, y, there, work, interval, before, rows[k])
        begin, before = end, rows[k]
    return stretches.shape[0]


@kernel
def _lubrication_at(inlet, temperatures, oils, mounted, lubrication):
    """Return a lubrication with the growth and the films of a network's temperatures, see `_warmed`."""
    inner, rollers, outer = temperatures[NODE.inner_ring], temperatures[NODE.rollers], temperatures[NODE.outer_ring]
    solids = Temperatures(temperatures[NODE.shaft], inner, rollers, outer, temperatures[NODE.housing])
    inner_film, outer_film = 0.5 * (inner + rollers), 0.5 * (outer + rollers)
    viscosity = 0.5 * (oil_properties(inner_film, oils)[0] + oil_properties(outer_film, oils)[0])
    return _warmed(lubrication, inlet, growth_at(mounted, solids), viscosity, 0.5 * (inner_film + outer_film))


@kernel
def _write_heat(heat, row):
    """Write temperatures and flows of heat into a flat sample."""
    for node in range(NODES):
        row[COLUMN.shaft_temperature + node] = heat.temperatures[node]
    row[COLUMN.heat_to_oil], row[COLUMN.heat_to_ambient] = heat.flows[0], heat.flows[1]
    row[COLUMN.inner_ring_temperature_uncorrected] = heat.temperatures[NODE.inner_ring]  # nothing is measured along a course
    row[COLUMN.outer_ring_temperature_uncorrected] = heat.temperatures[NODE.outer_ring]


@kernel
def _take_heat(interval, inlet, count, before, row, heat):
    """Sum the losses of a sample; step the network where an interval is over, and return whether it has."""
    losses, since = heat.losses, heat.since
    if since[0] == 0.0:
        since[1], since[2] = before[COLUMN.shaft_angle], before[COLUMN.cage_angle]
    for cause in range(losses.shape[0]):
        losses[cause] += interval * row[_FIRST_LOSS + cause]
    since[0] += interval
    elapsed = since[0]
    if elapsed < heat.interval:
        return False
    for j in range(count):
        heat.loads[0, j] = row[SCALARS + COLUMN.inner_load * count + j]
        heat.loads[1, j] = row[SCALARS + COLUMN.outer_load * count + j]
    for cause in range(losses.shape[0]):
        losses[cause] /= elapsed
    seats = heat.seats
    shaft_speed, cage_speed = (row[COLUMN.shaft_angle] - since[1]) / elapsed, (row[COLUMN.cage_angle] - since[2]) / elapsed
    inputs = NetworkInputs(shaft_speed, cage_speed, inlet, seats[0], seats[1], seats[2], seats[3])
    step(elapsed, heat.temperatures, losses, heat.loads, inputs, heat.network, heat.work)
    for page in range(heat.books.shape[0]):
        heat.books[page] += heat.work.books[page]
    heat.flows[0], heat.flows[1] = heat.work.books[BOOK.to_oil] / elapsed, heat.work.books[BOOK.to_ambient] / elapsed
    losses[:] = 0.0
    since[:] = 0.0
    _write_heat(heat, row)
    return True


@kernel
def advance_warm_profile(start, stretches, inputs, y, model, work, counts, previous, rows, heat):
    """Advance from instant to instant of a course as `advance_profile`, beside a thermal network that the losses heat.

    The table answers at the mean temperature of the films and at the growth of the present temperatures; drag and lands are taken at that
    temperature, too.

    Parameters
    ----------
    start, stretches, inputs, y, model, work, counts, previous, rows : as of `advance_profile`.
    heat : `bearing_sim.physics.thermal_network.HeatCourse`.

    Returns
    -------
    how many instants were reached; state and temperatures are those of the last of them.
    """
    mounted, count = model.params.mounted, model.params.rollers.count
    lubrication = _lubrication_at(inputs[0, 3], heat.temperatures, heat.network.oils, mounted, model.lubrication)
    growth = excess_growth(inputs[0, 0], lubrication.film_temperature, lubrication.growth, mounted)
    begin, before, now = Condition(inputs[0, 0], inputs[0, 1], inputs[0, 2], lubrication.film_temperature, growth), previous, start
    if not _from_table(begin, work):
        return 0
    _begin_interval(work)
    for k in range(stretches.shape[0]):
        speed, load_y, load_z, inlet = inputs[k + 1, 0], inputs[k + 1, 1], inputs[k + 1, 2], inputs[k + 1, 3]
        lubrication = _lubrication_at(inlet, heat.temperatures, heat.network.oils, mounted, lubrication)
        growth = excess_growth(speed, lubrication.film_temperature, lubrication.growth, mounted)
        end = Condition(speed, load_y, load_z, lubrication.film_temperature, growth)
        if not _from_table(end, work):
            return k
        interval = stretches[k]
        now += interval
        _follow_inputs(begin, end, interval, model, work, y)
        counts[COUNT.steps] += 1
        there = Model(model.params, lubrication, Drive(now, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0), model.tolerances)
        _write_sample(now, y, there, work, interval, before, rows[k])
        _write_heat(heat, rows[k])
        took = _take_heat(interval, inlet, count, before, rows[k], heat)
        begin, before = end, rows[k]
        if took:
            lubrication = _lubrication_at(inlet, heat.temperatures, heat.network.oils, mounted, lubrication)
            heat.seats[0], heat.seats[1], heat.seats[2], heat.seats[3] = seats_at(speed, lubrication.growth, mounted, heat.gaps)
            growth = excess_growth(speed, lubrication.film_temperature, lubrication.growth, mounted)
            warmer = Condition(speed, load_y, load_z, lubrication.film_temperature, growth)
            if _from_table(warmer, work):
                begin = warmer
                _begin_interval(work)
    return stretches.shape[0]


def solve_conditions(conditions: np.ndarray, model, work: Work, answers: np.ndarray) -> None:
    """Solve for operating points one after the other; an answer that was not found is NaN.

    Parameters
    ----------
    conditions : shaft speed [rad/s], load [N] and its direction [rad] of each, shape (n, 3).
    model : of the level; its drive goes unused.
    work : `Work`, of the calling thread alone.
    answers : result, shape (n, len(ANSWER)).
    """
    forget(work)  # the model may be another one
    for (speed, load, angle), answer in zip(conditions.tolist(), answers):
        found = solve_condition(speed, load * math.cos(angle), load * math.sin(angle), model, work)
        answer[:] = work.solved if found else math.nan


@kernel
def look_up_conditions(conditions, table, scratch, answers):
    """Interpolate in a table; an answer outside of it is NaN.

    Parameters
    ----------
    conditions : shaft speed [rad/s], load [N], oil temperature [K], direction of the load [rad] and growth [m] of each, shape (n, 5).
    table, scratch : as in `bearing_sim.levels.steady.table.look_up`.
    answers : result, shape (n, len(ANSWER)).
    """
    for k in range(conditions.shape[0]):
        speed, load, temperature, angle, growth = conditions[k, 0], conditions[k, 1], conditions[k, 2], conditions[k, 3], conditions[k, 4]
        if covers(speed, load, temperature, growth, table):
            look_up(speed, load, temperature, angle, growth, table, scratch, answers[k])
        else:
            for column in range(answers.shape[1]):
                answers[k, column] = math.nan
