# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One operating point of level ``steady``: which periodic state a bearing settles in, and its means there.

**The spins of an even cage.** After a roller pitch of cage rotation every roller stands where the one ahead of it stood, and so do loads and
spins.  Along the orbit a spin obeys

    |omega_c| dw/dtheta = f(theta, w),

f the right-hand side of level ``slip``.  It is solved at N nodes a pitch, Z N in all, by backward differences that close upon themselves
(`bearing_sim.numerics.linear_algebra`) and Newton's method: means over a pitch are found without marching to them.  The cage's speed is held
constant; its ripple within a pitch moves the mean slip by far less than the error of the differences (`test/test_level_steady.py`
measures both).

**The cage's speed.** Where slip is large, several states may be in balance.  A run from ideal rolling settles in the one whose slip comes
first: the spins follow the cage within a fraction of its own time, so the cage follows the mean torque until that is zero.  The search
does the same: from ideal rolling in steps of slip until the mean torque on the cage changes its sign.

**False balances.** Where spins stick and slip within a pitch there may be several spin curves at one speed of the cage, or the differences do not
resolve the one there is.  The mean torque then scatters with the cage's speed by as much as its own size, and a scatter looks like a change of
sign: a slip at which the cage is left with a noticeable torque is none at which it rests.

**Marching.** A traction curve that falls steeply (cold oil, a loaded bearing that creeps) makes spins jump: they have no smooth periodic curve.
There, and where only false balances are found, level ``slip`` is marched until it has settled.  Where spins jump, its way
there, and so the lag, is up to ten times too short at stock tolerances; the state that it ends in is not (`test/test_level_steady.py`).
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.observation import oil_at_speed
from bearing_sim.levels.slip.forces import pitch_loads
from bearing_sim.levels.slip.methods import advance as advance_slip
from bearing_sim.levels.slip.model import rhs, rhs_and_jacobian
from bearing_sim.levels.slip.power import inertia_of_orbits, kinetic_power, slip_powers
from bearing_sim.levels.slip.state import OMEGA, SPIN, THETA
from bearing_sim.model.sample import COLUMN, SCALARS, flat, new_block
from bearing_sim.numerics.compilation import kernel, template
from bearing_sim.numerics.linear_algebra import ALPHA_0, ARROW, STEPS, backward_difference, solve_cyclic
from bearing_sim.numerics.time_stepping import CONTROL, OK, STEP_BUDGET, Memory, new_counts, new_memory
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.pocket import pocket_friction

ANGLES = 11  # N, of a bearing with twelve rollers or more
_FEW_ROLLERS = 1600  # N Z^2 at least: four rollers share the load so unevenly over a pitch that the books miss 9 % at 11 angles, 0.1 % at 100
_LEAST_SLOPE = 1e-6  # a spin that nothing brakes or drives keeps what it has
_FALLING = -0.8  # of alpha_0; more of a falling traction curve would reverse Newton's step
_SHORTER, _LONGER = 0.4, 1.6
_SHORTEST_CHANGE = 1e-9
_LONGEST_CHANGE = 0.3  # of the spin of rolling, in an iteration
CREEP = 1.0  # rad/s; a slower shaft is answered for as if it turned so fast
SETTLED, STOPPED, FAILED = 0, 1, 2
REASONS = {
    SETTLED: "periodic state found",
    STOPPED: "nothing drives the cage",
    FAILED: "no periodic state was found",
}
_ITERATIONS = 15
_CAREFUL_ITERATIONS = 150
_STUCK, _NEXT_TO_BALANCE = 1e-3, 0.1  # of a bracket, and of the drive at its other end, below which that at an end may have the wrong sign
_ROUGH, _FINE = 1e-3, 1e-5  # of the spin of rolling
_SLIP_TOLERANCE = 1e-5
_LARGEST_LEAD = 0.1  # negative slip; a cage that seems to be driven beyond has spins that were not resolved
_FLANGED_LEAD = 0.3  # the same where flanges of the inner ring drive the rollers: by their height over the roller's radius at most
_HALVINGS = 40
_LEFT = 1e-2  # of the losses; a cage driven by more at the slip that was found is not in balance
_LAG_CHANGE = 1e-2  # of the slip
_SAMPLES = 24  # in a window
_TURNS = 3.37  # of an ideal cage in the first window, no whole number of pitches
_WINDOWS = 12  # each twice as long as the one before from the second on
_AGREED, _AGREED_FLOOR = 2e-3, 5e-5  # of slips of two windows
_RESTS = 5e-4  # instead of the floor where steps run out: what counts as rest in a run, see `bearing_sim.sweep.settling.OBSERVED`
_SHORTEST_WINDOW, _CUT_WINDOWS = 0.1, 3  # of the first window, and how many of them are marched, where steps run out
_FIRST_STEP, _LONGEST_STEP = 1e-6, 1.0  # s
_AN_INSTANT = 1e-6  # of an ideal cage turn


_SLIPS = np.array([0.0, 1e-3, 4e-3, 0.012, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.33, 0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.88, 0.94, 0.98, 0.995, 0.999])
CAGE_SLIPS = np.array([-0.1, 0.0, 0.03, 0.1, 0.2, 0.33, 0.48, 0.64])
"""Slips at which a cage's acceleration is part of the answer to an operating point."""
_PASSED = np.searchsorted(_SLIPS, CAGE_SLIPS)  # which of the slips of the search they are, all but the first
_SKIDDING = 5  # up to which of them spins are asked how they follow a cage that is far from its balance
_LONGEST_LAG = 1e4  # s
_APART = 0.01  # slip by which one of `CAGE_SLIPS` has to be apart from the balance to count


class Orbit(NamedTuple):
    """State and workspace; M = N Z nodes along the orbit, in the order in which a roller passes them."""

    speed: np.ndarray  # of the cage that the spins belong to [rad/s], shape (1,)
    spins: np.ndarray  # [rad/s], shape (M,)
    accelerations: np.ndarray  # of the cage at N angles [rad/s^2], shape (N,)
    rates: np.ndarray  # dw/dt [rad/s^2], shape (M,)
    d_spin: np.ndarray  # derivatives of these by the spin itself [1/s], shape (M,)
    drives: np.ndarray  # derivatives of the cage's acceleration by the spins [1/s], shape (M,)
    diagonal: np.ndarray  # of the differences' equations, shape (M,)
    column: np.ndarray  # a right side, and three for the closing of the orbit, shape (M, 1 + 3)
    beside: np.ndarray  # spins at a cage speed nearby, shape (M,)
    found: np.ndarray  # spins of the operating point, while others are sought, shape (M,)
    residual: np.ndarray  # right side of the iteration before, shape (M,)
    reach: np.ndarray  # how far each spin may go in an iteration [rad/s], shape (M,)
    state: np.ndarray  # of level slip, shape (Z + 2,)
    rate: np.ndarray  # shape (Z + 2,)
    passed: np.ndarray  # mean accelerations at the slips that the search for the operating point has passed, else NaN [rad/s^2]
    tolerances: np.ndarray  # of the slip, over 0.01 + slip, and of spins, over the spin of rolling, shape (2,)


def new_orbit(count: int, angles: int | None = None, tolerances: tuple[float, float] = (_SLIP_TOLERANCE, _FINE)) -> Orbit:
    """Return zeroed memory for ``count`` rollers and that many angles a pitch (None: what these rollers need); see `Orbit` for the tolerances."""
    if angles is None:
        angles = max(ANGLES, math.ceil(_FEW_ROLLERS / count**2))
    nodes = count * angles
    return Orbit(
        speed=np.ones(1),
        spins=np.zeros(nodes),
        accelerations=np.zeros(angles),
        rates=np.zeros(nodes),
        d_spin=np.zeros(nodes),
        drives=np.zeros(nodes),
        diagonal=np.zeros(nodes),
        column=np.zeros((nodes, 1 + STEPS)),
        beside=np.zeros(nodes),
        found=np.zeros(nodes),
        residual=np.zeros(nodes),
        reach=np.zeros(nodes),
        state=np.zeros(count + 2),
        rate=np.zeros(count + 2),
        passed=np.full(_SLIPS.shape[0], math.nan),
        tolerances=np.array(tolerances),
    )


@kernel
def roller_at(i, sense, count):
    """Return which roller stands i pitches along the orbit from roller 0."""
    return i if sense > 0.0 else (count - i) % count


@kernel
def set_state(k, speed, sense, params, orbit):
    """Write the state of level slip at the k-th angle: node k + N i of the orbit is where roller `roller_at` of i stands."""
    angles, count, state = orbit.accelerations.shape[0], params.rollers.count, orbit.state
    state[THETA] = sense * 2.0 * math.pi * k / (angles * count)
    state[OMEGA] = speed
    for i in range(count):
        state[SPIN + roller_at(i, sense, count)] = orbit.spins[k + angles * i]


@kernel
def _take_jacobian(k, sense, params, work, orbit):
    """Take level slip's derivatives at the k-th angle, and add what its Jacobian leaves out: a pocket presses as its roller is driven."""
    angles, rollers, cage = orbit.accelerations.shape[0], params.rollers, params.cage
    rows, loads, count = work.jacobian.rows, work.loads, params.rollers.count
    inertia = cage.inertia
    for j in range(count):
        inertia += rollers.mass * loads[LOAD.radius, j] * loads[LOAD.radius, j]
    for i in range(count):
        node, j = k + angles * i, roller_at(i, sense, count)
        radius = loads[LOAD.radius, j]
        pressed = work.tangential[j] > rollers.mass * radius * orbit.accelerations[k]
        friction = pocket_friction(orbit.state[SPIN + j], cage.pocket_friction) * (1.0 if pressed else -1.0)
        driven = rows[ARROW.row, j] / radius  # derivative of the force along the orbit, over the inertia
        orbit.d_spin[node] = rows[ARROW.diagonal, j] - friction * rollers.radius * inertia * driven / rollers.inertia
        orbit.drives[node] = rows[ARROW.row, j] - params.variants.pocket_reaction * friction * rollers.radius * driven


@kernel
def _linearise(speed, sense, model, work, orbit):
    """Evaluate level slip at all angles; write derivatives, and the residuals into ``orbit.column``; return whether loads balanced."""
    angles, count, nodes = orbit.accelerations.shape[0], model.params.rollers.count, orbit.spins.shape[0]
    for k in range(angles):
        set_state(k, speed, sense, model.params, orbit)
        if not rhs_and_jacobian(0.0, orbit.state, model, work, orbit.rate):
            return False
        orbit.accelerations[k] = orbit.rate[OMEGA]
        for i in range(count):
            orbit.rates[k + angles * i] = orbit.rate[SPIN + roller_at(i, sense, count)]
        _take_jacobian(k, sense, model.params, work, orbit)
    interval = 2.0 * math.pi / (nodes * sense * speed)  # time from node to node
    for m in range(nodes):
        orbit.diagonal[m] = max(_LEAST_SLOPE - interval * orbit.d_spin[m], _FALLING * ALPHA_0)
        orbit.column[m, 0] = interval * orbit.rates[m] - backward_difference(orbit.spins, m)
    return True


@kernel
def _largest(column):
    """Return the largest magnitude of a first column; NaN where it holds one."""
    largest = 0.0
    for m in range(column.shape[0]):
        size = abs(column[m, 0])
        if not size <= largest:
            largest = size
    return largest


@kernel
def _adapt_reach(scale, iteration, orbit):
    """Shorten the reach of a spin that was sent past its root, lengthen it where it was not."""
    for m in range(orbit.spins.shape[0]):
        left, longest = orbit.column[m, 0], _LONGEST_CHANGE * scale
        if iteration == 0:
            orbit.reach[m] = longest
        elif left * orbit.residual[m] < 0.0:
            orbit.reach[m] *= _SHORTER
        else:
            orbit.reach[m] = min(orbit.reach[m] * _LONGER, longest)
        orbit.reach[m] = max(orbit.reach[m], _SHORTEST_CHANGE * scale)
        orbit.residual[m] = left
        # where traction falls with sliding, the root lies in the direction of the residual, not in that of the derivative
        orbit.diagonal[m] = max(orbit.diagonal[m], _LEAST_SLOPE)


@kernel
def solve_spins(speed, sense, model, work, orbit, tolerance, iterations, careful):
    """Find the spin curve by Newton's method from ``orbit.spins`` on; ``orbit.accelerations`` are those of the last iterate but one.

    Parameters
    ----------
    speed : of the cage [rad/s].
    sense : of rotation, 1.0 or -1.0.
    model, work : of level slip, the inputs constant.
    tolerance : longest last change, a fraction of the spin of rolling.
    iterations : most of them.
    careful : whether each spin has a reach of its own, which keeps the iteration together on traction curves that rise
        steeply and are flat beyond, where Newton's leaps from one side to the other.

    Returns
    -------
    converged : bool
    """
    nodes = orbit.spins.shape[0]
    scale = abs(speed) * model.params.raceways.pitch_radius / model.params.rollers.radius
    for iteration in range(iterations):
        if not _linearise(speed, sense, model, work, orbit):
            return False
        if careful:
            _adapt_reach(scale, iteration, orbit)
        if not solve_cyclic(orbit.diagonal, orbit.column):
            return False
        if careful:
            for m in range(nodes):
                orbit.column[m, 0] = min(max(orbit.column[m, 0], -orbit.reach[m]), orbit.reach[m])
        change = _largest(orbit.column)
        if not math.isfinite(change):
            return False
        fraction = min(1.0, _LONGEST_CHANGE * scale / max(change, 1e-300))
        for m in range(nodes):
            orbit.spins[m] += fraction * orbit.column[m, 0]
        if change <= tolerance * scale:
            return True
    return False


class AnswerColumn(NamedTuple):
    """What an operating point is answered by, and where."""

    cage_slip: int = 0  # mean in time
    lag: int = 1  # time constant of the cage's way back to it from nearby [s]
    spin_inertia: int = 2  # inertia of a skidding cage, orbiting rollers and the spins that follow it, over that of cage and orbiting rollers
    spin_delay: int = 3  # with which they follow [s]
    acceleration_lead_10: int = 4  # of a cage whose spins have followed it, at each of `CAGE_SLIPS`, positive where it gains speed [rad/s^2]
    acceleration_0: int = 5
    acceleration_3: int = 6
    acceleration_10: int = 7
    acceleration_20: int = 8
    acceleration_33: int = 9
    acceleration_48: int = 10
    acceleration_64: int = 11
    inner_equivalent_load: int = 12  # [N]
    outer_equivalent_load: int = 13
    inner_lamina_load: int = 14  # the same by laminae
    outer_lamina_load: int = 15
    reference_modification_factor: int = 16  # a_ISO of all laminae together
    shaft_power: int = 17  # from here on means in time [W]; the order is that of `bearing_sim.levels.common.power.Powers`
    inner_sliding_power: int = 18
    outer_sliding_power: int = 19
    inner_rolling_power: int = 20
    outer_rolling_power: int = 21
    churning_power: int = 22
    windage_power: int = 23
    land_power: int = 24
    pocket_power: int = 25
    damping_power: int = 26
    seal_power: int = 27
    flange_power: int = 28


ANSWER = AnswerColumn()
ACCELERATIONS = slice(ANSWER.acceleration_lead_10, ANSWER.acceleration_64 + 1)
"""Columns of an answer that hold accelerations of a cage, as many as `CAGE_SLIPS`."""


@kernel
def _roll(speed, params, orbit):
    """Let all rollers roll on the outer raceway, the cage at an even speed: nothing is left of the operating point before."""
    orbit.speed[0] = speed
    for k in range(orbit.accelerations.shape[0]):
        orbit.accelerations[k] = 0.0
    for m in range(orbit.spins.shape[0]):
        orbit.spins[m] = speed * params.raceways.pitch_radius / params.rollers.radius


@kernel
def _mean_drive(speed, sense, model, work, orbit, tolerance):
    """Return the mean acceleration of a cage held at a speed, in its sense [rad/s^2]; NaN where the spins were not found.

    The search for spins starts from those at the cage speed before, in proportion.
    """
    ratio = speed / orbit.speed[0]
    orbit.speed[0] = speed
    for m in range(orbit.spins.shape[0]):
        orbit.spins[m] *= ratio
    if not solve_spins(speed, sense, model, work, orbit, tolerance, _ITERATIONS, False):
        _roll(speed, model.params, orbit)
        if not solve_spins(speed, sense, model, work, orbit, tolerance, _CAREFUL_ITERATIONS, True):
            return math.nan
    total = 0.0
    for k in range(orbit.accelerations.shape[0]):
        total += orbit.accelerations[k]
    return sense * total / orbit.accelerations.shape[0]


@kernel
def _bracket(ideal, sense, model, work, orbit):
    """Go from ideal rolling to where the mean torque changes its sign; return (slip before, drive there, slip after, drive there)."""
    for i in range(_SLIPS.shape[0]):
        orbit.passed[i] = math.nan
    before, drive_before = 0.0, _mean_drive(ideal, sense, model, work, orbit, _ROUGH)
    orbit.passed[0] = drive_before
    farthest = _FLANGED_LEAD if model.params.flanges.inner.area > 0.0 else _LARGEST_LEAD
    away = 1.0 if drive_before < 0.0 else -1.0  # most cages lag, those of slow bearings lead by next to nothing
    for i in range(1, _SLIPS.shape[0]):
        slip = away * _SLIPS[i]
        drive = _mean_drive(ideal * (1.0 - slip), sense, model, work, orbit, _ROUGH)
        if not math.isfinite(drive + drive_before) or slip < -farthest:
            return math.nan, math.nan, math.nan, math.nan
        if away > 0.0:
            orbit.passed[i] = drive
        if drive * away >= 0.0:
            return before, drive_before, slip, drive
        before, drive_before = slip, drive
    return before, drive_before, math.inf, 0.0


@kernel
def _narrow(low, drive_low, high, drive_high, ideal, sense, model, work, orbit):
    """Return the slip between two at which the cage is in balance, by the Illinois rule; NaN where spins were not found."""
    slip, slope = high, (drive_high - drive_low) / (high - low)
    for _ in range(_HALVINGS):
        slip = low - drive_low * (high - low) / (drive_high - drive_low)
        drive = _mean_drive(ideal * (1.0 - slip), sense, model, work, orbit, orbit.tolerances[1])
        if not math.isfinite(drive):
            return math.nan
        if min(abs(drive / slope), abs(high - low)) < orbit.tolerances[0] * (1e-2 + abs(slip)):
            return slip
        if drive * drive_high > 0.0:
            drive_low *= 0.5
        else:
            low, drive_low = high, drive_high
        high, drive_high = slip, drive
    return slip


@kernel
def _beyond_an_end(slip, low, drive_low, high, drive_high, ideal, sense, model, work, orbit):
    """Return the slip of the balance where the search for it has stuck at an end of its bracket, else the same slip.

    Brackets ask for spins to a thousandth only, so that a drive next to a balance may have the wrong sign there, and the balance is on the other side
    of that end.  Only a drive that was small and still is counts as such: where spins stick and slip within a pitch drives scatter.

    Parameters
    ----------
    slip : found by `_narrow`.
    low, drive_low, high, drive_high : as of `_bracket`.
    """
    for i in range(1, _SLIPS.shape[0] - 1):
        end, outwards = math.copysign(_SLIPS[i], high), 1 if abs(high) == _SLIPS[i] else -1
        if (end != low and end != high) or abs(slip - end) > _STUCK * abs(high - low):
            continue
        beyond = math.copysign(_SLIPS[i + outwards], high)
        drive_beyond = _mean_drive(ideal * (1.0 - beyond), sense, model, work, orbit, orbit.tolerances[1])
        drive_end = _mean_drive(ideal * (1.0 - end), sense, model, work, orbit, orbit.tolerances[1])
        roughly = drive_high if end == high else drive_low
        if drive_end * drive_beyond < 0.0 and max(abs(drive_end), abs(roughly)) < _NEXT_TO_BALANCE * abs(drive_beyond):
            return _narrow(beyond, drive_beyond, end, drive_end, ideal, sense, model, work, orbit)
    return slip


@kernel
def _losses(answer):
    """Return the sum of an operating point's losses [W]."""
    total = 0.0
    for column in range(ANSWER.inner_sliding_power, ANSWER.flange_power + 1):
        total += answer[column]
    return total


@template
def _felt_behind(interval, orbit):
    """Replace what spins change by, in ``orbit.column``, by how far they are behind it; return what the cage feels of that, NaN where not known."""
    for m in range(orbit.spins.shape[0]):
        orbit.column[m, 0] *= interval
    felt = math.nan
    if solve_cyclic(orbit.diagonal, orbit.column):
        felt = 0.0
        for m in range(orbit.spins.shape[0]):
            felt += orbit.drives[m] * orbit.column[m, 0] / orbit.accelerations.shape[0]
    return felt


@kernel
def _inertia_and_delay(faster, sense, orbit):
    """Return how spins follow a cage that changes its speed slowly; NaN where that is not known.

    Parameters
    ----------
    faster : by how much a cage is whose spins are those of ``orbit.beside`` [rad/s].
    sense : of rotation.
    orbit : holds the spins of the cage.

    Returns
    -------
    inertia that goes with cage and orbiting rollers, which count 1: spins are felt through the tractions; mean time until a spin has followed [s].
    """
    nodes = orbit.spins.shape[0]
    interval = 2.0 * math.pi / (nodes * sense * orbit.speed[0])
    for m in range(nodes):
        orbit.column[m, 0] = (orbit.beside[m] - orbit.spins[m]) / faster
    behind = _felt_behind(interval, orbit)  # how far spins are, by the acceleration of the cage
    later = _felt_behind(interval, orbit)
    return 1.0 + behind, later / behind if behind != 0.0 else 0.0


@template
def _keep_spins(orbit, kept):
    for m in range(orbit.spins.shape[0]):
        kept[m] = orbit.spins[m]


@template
def _go_back(speed, orbit):
    """Let the orbit hold the spins in ``found`` again, which belong to a cage speed."""
    orbit.speed[0] = speed
    for m in range(orbit.spins.shape[0]):
        orbit.spins[m] = orbit.found[m]


@kernel
def lag_at(behind, ideal, answer):
    """Return the time constant of a cage's way to its settled speed, its distance over its acceleration [s].

    It changes linearly with the distance between those that are known, as that of a body does which a limited torque brings back, and in proportion
    to it beyond.  A slip at which the cage is driven away from its settled speed is passed over.

    Parameters
    ----------
    behind : by how much more than it settles at the cage slips, less where that is negative.
    ideal : speed of the cage without slip [rad/s, positive].
    answer : columns `ANSWER`.
    """
    slip, distance, toward = answer[ANSWER.cage_slip], abs(behind), 1.0 if behind > 0.0 else -1.0
    count, known, lag = CAGE_SLIPS.shape[0], 0.0, answer[ANSWER.lag]
    for i in range(count):
        k = i if toward > 0.0 else count - 1 - i
        there, acceleration = toward * (CAGE_SLIPS[k] - slip), toward * answer[ANSWER.acceleration_lead_10 + k]
        if not (there > _APART and acceleration > 0.0):
            continue
        lag_there = min(there * ideal / acceleration, _LONGEST_LAG)
        if distance <= there:
            return lag + (lag_there - lag) * (distance - known) / (there - known)
        known, lag = there, lag_there
    return lag * distance / known if known > 0.0 else lag


@kernel
def _write_accelerations(slip, ideal, sense, model, work, orbit, answer):
    """Write accelerations at `CAGE_SLIPS`, and how spins follow a cage that skids; ``orbit`` holds the spins at ``slip``, and does afterwards."""
    speed, count = orbit.speed[0], CAGE_SLIPS.shape[0]
    _keep_spins(orbit, orbit.found)
    ahead = 0  # so many of them are not behind the operating point
    while ahead < count and CAGE_SLIPS[ahead] <= slip:
        ahead += 1
    for k in range(ahead - 1, -1, -1):  # away from the operating point: spins are sought from those found before
        drive = orbit.passed[_PASSED[k]] if k > 0 else math.nan
        if not math.isfinite(drive):
            drive = _mean_drive(ideal * (1.0 - CAGE_SLIPS[k]), sense, model, work, orbit, _ROUGH)
        answer[ANSWER.acceleration_lead_10 + k] = drive
    _go_back(speed, orbit)
    for k in range(ahead, count):
        if k == _SKIDDING:
            _keep_spins(orbit, orbit.beside)
        answer[ANSWER.acceleration_lead_10 + k] = _mean_drive(ideal * (1.0 - CAGE_SLIPS[k]), sense, model, work, orbit, _ROUGH)
        if k == _SKIDDING and k > ahead:
            inertia, delay = _inertia_and_delay((CAGE_SLIPS[k] - CAGE_SLIPS[k - 1]) * ideal, sense, orbit)
            if math.isfinite(inertia + delay):
                answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = max(inertia, 1.0), max(delay, 0.0)
    _go_back(speed, orbit)
    for k in range(count):
        answer[ANSWER.acceleration_lead_10 + k] /= answer[ANSWER.spin_inertia]


@kernel
def _write_lag(slip, ideal, sense, model, work, orbit, answer):
    """Write how a cage goes to an operating point, NaN where it leads away from it; ``orbit`` holds its spins, and does so afterwards."""
    change = _LAG_CHANGE * max(abs(slip), 1e-3) * ideal
    speed = ideal * (1.0 - slip)
    above = _mean_drive(speed + change, sense, model, work, orbit, _FINE)
    _keep_spins(orbit, orbit.beside)
    below = _mean_drive(speed - change, sense, model, work, orbit, _FINE)
    slope = sense * (above - below) / (2.0 * change)
    inertia, delay = _inertia_and_delay(2.0 * change, sense, orbit)
    if not math.isfinite(slope + inertia) or not slope < 0.0:
        return
    answer[ANSWER.lag] = -inertia / slope
    answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = max(inertia, 1.0), max(delay, 0.0)
    _write_accelerations(slip, ideal, sense, model, work, orbit, answer)


@kernel
def _write_powers(speed, sense, model, work, orbit, answer):
    """Write powers, means over a pitch, in which cage and rollers store nothing: what they seem to is an error of the differences."""
    angles, rate = orbit.accelerations.shape[0], orbit.rate
    for column in range(ANSWER.shaft_power, ANSWER.flange_power + 1):
        answer[column] = 0.0
    for k in range(angles):
        set_state(k, speed, sense, model.params, orbit)
        rhs(0.0, orbit.state, model, work, rate)
        powers = slip_powers(speed, rate[OMEGA], orbit.state[SPIN:], model.drive.shaft_speed, model, work)
        answer[ANSWER.shaft_power] += (powers.shaft - kinetic_power(orbit.state, rate, model, work)) / angles
        answer[ANSWER.inner_sliding_power] += powers.inner_sliding / angles
        answer[ANSWER.outer_sliding_power] += powers.outer_sliding / angles
        answer[ANSWER.inner_rolling_power] += powers.inner_rolling / angles
        answer[ANSWER.outer_rolling_power] += powers.outer_rolling / angles
        answer[ANSWER.churning_power] += powers.churning / angles
        answer[ANSWER.windage_power] += powers.windage / angles
        answer[ANSWER.land_power] += powers.land / angles
        answer[ANSWER.pocket_power] += powers.pocket / angles
        answer[ANSWER.damping_power] += powers.damping / angles
        answer[ANSWER.seal_power] += powers.seal / angles
        answer[ANSWER.flange_power] += powers.flange / angles


@kernel
def solve_point(model, work, orbit, answer):
    """Find the periodic state that the bearing settles in under the model's inputs at the time 0.

    Parameters
    ----------
    model : of level slip; inputs constant, the shaft not slower than `CREEP`.
    work : of level slip.
    orbit : `bearing_sim.levels.steady.operating_point.Orbit`; keeps the state that was found, and the cage's accelerations in it.
    answer : result, shape (len(ANSWER),); NaN where no state was found.

    Returns
    -------
    status : see `REASONS`.
    """
    shaft_speed = model.drive.shaft_speed
    sense = 1.0 if shaft_speed > 0.0 else -1.0
    ideal = 0.5 * shaft_speed * (1.0 - model.params.raceways.diameter_ratio)
    work.ring[0], work.ring[1] = 0.0, 0.0
    for column in range(answer.shape[0]):
        answer[column] = math.nan
    _roll(ideal, model.params, orbit)
    slip, drive, beyond, drive_beyond = _bracket(ideal, sense, model, work, orbit)
    status = SETTLED
    if math.isinf(beyond):
        status = STOPPED
    elif math.isfinite(slip):
        low, high = slip, beyond
        slip = _narrow(low, drive, high, drive_beyond, ideal, sense, model, work, orbit)
        slip = _beyond_an_end(slip, low, drive, high, drive_beyond, ideal, sense, model, work, orbit)
    if not math.isfinite(slip):
        return FAILED
    _write_lag(slip, ideal, sense, model, work, orbit, answer)
    speed = ideal * (1.0 - slip)
    left = _mean_drive(speed, sense, model, work, orbit, orbit.tolerances[1])
    if not math.isfinite(left):
        return FAILED
    answer[ANSWER.cage_slip] = slip if status == SETTLED else 1.0
    _write_powers(speed, sense, model, work, orbit, answer)
    driving = abs(left * speed) * inertia_of_orbits(model.params, work.loads)
    if status == SETTLED and driving > _LEFT * _losses(answer):
        for column in range(answer.shape[0]):
            answer[column] = math.nan
        return FAILED
    loads = pitch_loads(0.0, speed, model.drive.load_y, model.drive.load_z, oil_at_speed(shaft_speed, model), model.params, work)
    answer[ANSWER.inner_equivalent_load], answer[ANSWER.outer_equivalent_load] = loads.inner, loads.outer
    answer[ANSWER.inner_lamina_load], answer[ANSWER.outer_lamina_load] = loads.inner_lamina, loads.outer_lamina
    answer[ANSWER.reference_modification_factor] = loads.reference_modification_factor
    return status


_BUDGET = np.int64(60_000)  # steps of a window; a Python number would be a literal type, and with it a second compilation of the march


class March(NamedTuple):
    """Memory of a march."""

    state: np.ndarray  # of level slip, shape (Z + 2,)
    memory: Memory
    counts: np.ndarray
    rows: np.ndarray  # flat samples, shape (24, ...)


def new_march(count: int) -> March:
    """Return memory for ``count`` rollers."""
    return March(np.zeros(count + 2), new_memory(count + 2), new_counts(), flat(new_block(_SAMPLES, count)))


@kernel
def _forget_spins(row, count):
    """Let the next sample take its powers from its instant alone: nothing was sampled where its interval begins."""
    for j in range(count):
        row[SCALARS + COLUMN.roller_spin * count + j] = math.nan


@kernel
def march(model, work, memory, answer):
    """March from ideal rolling until two windows agree; write the means over the last.

    The lag is the area between the cage's speed and its end, over their first distance.  Where spins jump all the time a window runs out of steps.
    It ends there, and so do the next ones; the march has settled if two of them agree as far as slip rests in any run.

    Parameters
    ----------
    model : of level slip; inputs constant.
    work : of level slip.
    memory : `March`.
    answer : result, shape (len(ANSWER),).

    Returns
    -------
    status : OK, or STEP_BUDGET where the answer has not settled; anything else means that there is none.
    """
    params, y, rows = model.params, memory.state, memory.rows
    shaft_speed = model.drive.shaft_speed
    ideal = 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
    for i in range(y.shape[0]):
        y[i] = ideal * params.raceways.pitch_radius / params.rollers.radius
    y[THETA], y[OMEGA] = 0.0, ideal
    for i in range(memory.counts.shape[0]):
        memory.counts[i] = 0
    work.ring[0], work.ring[1] = 0.0, 0.0
    time, window, step, before = 0.0, _TURNS * math.tau / abs(ideal), _FIRST_STEP, math.inf
    mean, turned, status, filled, cut, shortest = ideal, 0.0, OK, rows.shape[0], 0, _SHORTEST_WINDOW * window
    _forget_spins(rows[rows.shape[0] - 1], params.rollers.count)
    for _ in range(_WINDOWS):
        angle = y[THETA]
        status, step = advance_slip(
            False, time, window, y, step, _LONGEST_STEP, _BUDGET, model, work, memory.memory, memory.counts, rows[rows.shape[0] - 1], rows
        )
        if status != OK and status != STEP_BUDGET:
            return status
        marched = window if status == OK else memory.memory.control[CONTROL.time] - time
        if marched < shortest:
            break
        time += marched
        turned, filled = y[THETA], int(rows.shape[0] * marched / window)
        mean = (y[THETA] - angle) / marched
        slipped = 1.0 - mean / ideal
        if abs(slipped - before) < (_AGREED_FLOOR if status == OK else _RESTS) + _AGREED * abs(slipped):
            status = OK
            break
        before = slipped
        if status == OK:
            window *= 2.0
            continue
        cut += 1
        if cut == _CUT_WINDOWS:
            break
        window = marched
        _forget_spins(rows[rows.shape[0] - 1], params.rollers.count)
    if status == STEP_BUDGET and time == 0.0:
        mean = y[OMEGA]
        instant = _AN_INSTANT * window
        again, step = advance_slip(
            False, time, instant, y, _FIRST_STEP, _LONGEST_STEP, _BUDGET, model, work, memory.memory, memory.counts, rows[rows.shape[0] - 1], rows
        )
        if again != OK:
            return again
    answer[ANSWER.cage_slip] = 1.0 - mean / ideal
    away = ideal - mean
    lag = (turned - mean * time) / away if abs(away) > 1e-6 * abs(ideal) else 0.0
    answer[ANSWER.lag] = min(max(lag, 0.0), time)
    answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = 1.0, 0.0  # in this lag
    for k in range(CAGE_SLIPS.shape[0]):
        answer[ANSWER.acceleration_lead_10 + k] = math.nan
    for column in range(ANSWER.inner_equivalent_load, answer.shape[0]):
        source = COLUMN.inner_equivalent_load + column - ANSWER.inner_equivalent_load
        if column >= ANSWER.shaft_power:
            source = COLUMN.shaft_power + column - ANSWER.shaft_power
        total = 0.0
        for k in range(filled):
            total += rows[k, source]
        answer[column] = total / filled
    return status
