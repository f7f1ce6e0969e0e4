# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One operating point of level ``steady``: which periodic state a bearing settles in, and its means there.

**The spins of an even cage.** After a roller pitch of cage rotation every roller stands where the one ahead of it stood, and so do loads and
spins.  Along the orbit a spin obeys

    |omega_c| dw/dtheta = f(theta, w),

f the right-hand side of level ``slip``.  It is solved at N nodes a pitch, Z N in all, by backward differences that close upon themselves
(`bearing_sim.numerics.linear_algebra`) and Newton's method: means over a pitch are found without marching to them.  The cage's speed is held
constant.

**The cage's speed.** The mean torque on a cage that is held at a slip is its *drive*.  It is scanned from a cage that leads to one that stands
still.  A cage rests where the drive changes from braking to driving as slip rises; there may be several such balances.  A cage goes from where
it starts (ideal rolling, or a skid) to the first of them in the sense of its drive: the spins follow the cage within a fraction of its own time.

**How many angles.** The drive, the losses and the equivalent loads are means over a pitch, and what a roller meets on its way may be short: few
angles alias it.  The point that was found is solved again at twice as many angles, until slip, losses and lives have changed by less than
`SLIP_CHANGE`, `LOSS_CHANGE` and `LIFE_CHANGE`.  The last changes are the estimate of the error.

**False balances.** Where spins stick and slip within a pitch there may be several spin curves at one speed of the cage, or the differences do not
resolve the one there is.  The drive then scatters with the cage's speed by as much as its own size, and a scatter looks like a change of sign: a
slip at which the cage is left with a noticeable torque is none at which it rests.  There, and where a traction curve that falls steeply (cold oil,
a loaded bearing that creeps) makes spins jump, so that they have no smooth periodic curve, no point is found
(`bearing_sim.levels.steady.marching` then runs level ``slip`` until it has settled).
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
from bearing_sim.levels.common.observation import oil_at_speed
from bearing_sim.levels.slip.model import rhs_and_jacobian
from bearing_sim.levels.slip.power import inertia_of_orbits, kinetic_power, slip_powers
from bearing_sim.levels.slip.state import OMEGA, SPIN, THETA
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.linear_algebra import (
    ALPHA_0,
    ALPHA_1,
    ALPHA_2,
    ALPHA_3,
    ARROW,
    STEPS,
    back_substitute,
    backward_difference,
    decompose,
    solve_cyclic,
)
from bearing_sim.physics.lamina_life import add_load_moments, equivalent_loads
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.rating_life import rating_life_revolutions

ANGLES = 11  # N of the scan, of a bearing with twelve rollers or more
_FEW_ROLLERS = 1600  # N Z^2 at least: four rollers share the load so unevenly over a pitch that the books miss 9 % at 11 angles, 0.1 % at 100
_DOUBLINGS = 5  # of the angles at most
SLIP_CHANGE = (1e-4, 5e-4)  # when the angles were doubled, below which they are enough: absolute, and over the slip
LOSS_CHANGE, LIFE_CHANGE = 5e-3, 5e-3  # likewise, relative
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
_ROUGH, _USUAL, _FINE = 4e-3, 1e-4, 1e-5  # last changes of spins, over that of rolling: of a scan, where a balance is narrowed, at the end
_SLIP_TOLERANCE = 1e-5
_NARROW = 0.05  # of 0.01 + slip: so near to the balance of an even cage the periodic motion is sought at first
_LARGEST_LEAD = 0.1  # negative slip; a cage that seems to be driven beyond has spins that were not resolved
_FLANGED_LEAD = 0.3  # the same where flanges of the inner ring drive the rollers: by their height over the roller's radius at most
_HALVINGS = 40
_ITERATIONS = np.array([15, 150])  # of Newton's method, and of the careful one
_RIPPLE_ITERATIONS = np.array([20, 150])  # the same for the speeds of a cage
_RIPPLE_TOLERANCE = 0.1  # last change of such a speed, over the tolerance of slip
_STALLED, _LEAST_FRACTION = 0.8, 1.0 / 16.0  # of the change before, from which on half of a change is taken; the least part of one
_LIGHTEST, _LIGHTER = 1.0 / 256.0, 4.0  # weights of what accelerates a cage: the first, and the next over the one before
_LEFT = 1e-2  # of the losses; a cage driven by more at the slip that was found is not in balance
_LAG_CHANGE = 1e-2  # of the slip
_SKID_LOAD_STEP, _SKID_LOAD_WITHIN = 1.6, 1.03  # ratios of loads that are looked at: of the first ones, and of both ends of what is left at last
_LIGHTEST_SKID = 100.0  # of the least load at first; lighter ones are not looked at

SCANNED = np.array(
    [-1.2, -0.9, -0.64, -0.45, -0.3, -0.2, -0.15, -0.1, -0.06, -0.03, -0.012, -4e-3, -1e-3]  # only as far as the cage leads
    + [0.0, 1e-3, 4e-3, 0.012, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.33, 0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.88, 0.94, 0.98, 0.995, 0.999]
)
"""Slips at which the drive of a cage is looked at."""
ROLLING = int(np.searchsorted(SCANNED, 0.0))
"""Which of them is that of ideal rolling."""
CAGE_SLIPS = np.array([-0.1, 0.0, 0.03, 0.1, 0.2, 0.33, 0.48, 0.64])
"""Slips at which a cage's acceleration is part of the answer to an operating point."""
_PASSED = np.searchsorted(SCANNED, CAGE_SLIPS)
_SKIDDING = int(_PASSED[5])  # where spins are asked how they follow a cage that is far from its balance
_SLOW, _SLOWEST = 0.7, 0.9  # slips from which on a cage is looked at only where it was braked before, unless to standstill; always
_AS_SKIDDING = 0.2  # slip from which on a balance is as such
_LONGEST_LAG = 1e4  # s
_APART = 0.01  # slip by which one of `CAGE_SLIPS` has to be apart from the balance to count


class Resolution(NamedTuple):
    """Where each number stands in ``Orbit.resolution``."""

    first: int = 0  # angles a pitch to begin with
    angles: int = 1  # at the end
    slip_change: int = 2  # by the last doubling of the angles
    loss_change: int = 3  # of the sum of the losses, relative; or by how much the shaft's power misses that sum, if it is more
    life_change: int = 4  # of the rating lives, relative


RESOLUTION = Resolution()


class Orbit(NamedTuple):
    """State and workspace; M = N Z nodes along the orbit, in the order in which a roller passes them, of the finest resolution."""

    speed: np.ndarray  # of the cage that the spins belong to, its mean in time [rad/s], shape (1,)
    cage: np.ndarray  # the same at each angle, shape (N,)
    spins: np.ndarray  # [rad/s], shape (M,)
    accelerations: np.ndarray  # of the cage at N angles [rad/s^2], shape (N,)
    rates: np.ndarray  # dw/dt [rad/s^2], shape (M,)
    d_spin: np.ndarray  # derivatives of these by the spin itself [1/s], shape (M,)
    drives: np.ndarray  # derivatives of the cage's acceleration by the spins [1/s], shape (M,)
    d_cage: np.ndarray  # derivatives of the rates by the cage's speed [1/s], shape (M,)
    pulled: np.ndarray  # derivatives of the rates by the cage's acceleration, shape (M,)
    damped: np.ndarray  # derivatives of the cage's acceleration by its speed [1/s], shape (N,)
    diagonal: np.ndarray  # of the differences' equations, shape (M,)
    column: np.ndarray  # a right side, and three for the closing of the orbit, shape (M, 1 + 3)
    columns: np.ndarray  # the same with a column for the cage's speed at each angle, M (1 + N + 3) numbers
    matrix: np.ndarray  # equations of the cage's speeds, N N numbers
    order: np.ndarray  # of its rows, int64, shape (N,)
    right: np.ndarray  # their right side, then the changes of the speeds, shape (N,)
    beside: np.ndarray  # spins at a cage speed nearby, shape (M,)
    found: np.ndarray  # spins of ideal rolling, while others are sought, shape (M,)
    residual: np.ndarray  # right side of the iteration before, shape (M,)
    reach: np.ndarray  # how far each spin may go in an iteration [rad/s], shape (M,)
    rings_y: np.ndarray  # where the ring is at each angle [m], from which the search for it starts, shape (N,)
    rings_z: np.ndarray
    state: np.ndarray  # of level slip, shape (Z + 2,)
    rate: np.ndarray  # shape (Z + 2,)
    scanned: np.ndarray  # drives at `SCANNED` [rad/s^2], positive where the cage gains speed; NaN where not looked at or not found
    slope: np.ndarray  # of the mean drive by the cage's speed where `_narrow` has found it in balance [1/s], shape (1,)
    skid: np.ndarray  # inertia and delay of the spins of a cage that skids, see `AnswerColumn`, shape (2,)
    before: np.ndarray  # the answer with half as many angles, shape (len(ANSWER),)
    resolution: np.ndarray  # see `Resolution`, shape (len(RESOLUTION),)
    tolerances: np.ndarray  # of the slip, over 0.01 + slip, and of spins, over the spin of rolling, shape (2,)


def first_angles(count: int) -> int:
    """Return the angles a pitch with which a bearing of so many rollers begins."""
    return max(ANGLES, math.ceil(_FEW_ROLLERS / count**2))


def new_orbit(
    count: int, angles: int | None = None, tolerances: tuple[float, float] = (_SLIP_TOLERANCE, _FINE), doublings: int = _DOUBLINGS
) -> Orbit:
    """Return zeroed memory for ``count`` rollers.

    Parameters
    ----------
    angles : a pitch to begin with; None: what these rollers need.
    tolerances : see `Orbit`.
    doublings : how often the angles may be doubled.
    """
    angles = first_angles(count) if angles is None else angles
    most = angles * 2**doublings
    nodes = count * most
    return Orbit(
        speed=np.ones(1),
        cage=np.ones(most),
        spins=np.zeros(nodes),
        accelerations=np.zeros(most),
        rates=np.zeros(nodes),
        d_spin=np.zeros(nodes),
        drives=np.zeros(nodes),
        d_cage=np.zeros(nodes),
        pulled=np.zeros(nodes),
        damped=np.zeros(most),
        diagonal=np.zeros(nodes),
        column=np.zeros((nodes, 1 + STEPS)),
        columns=np.zeros(nodes * (1 + most + STEPS)),
        matrix=np.zeros(most * most),
        order=np.zeros(most, np.int64),
        right=np.zeros(most),
        beside=np.zeros(nodes),
        found=np.zeros(nodes),
        residual=np.zeros(nodes),
        reach=np.zeros(nodes),
        rings_y=np.zeros(most),
        rings_z=np.zeros(most),
        state=np.zeros(count + 2),
        rate=np.zeros(count + 2),
        scanned=np.full(len(SCANNED), math.nan),
        slope=np.full(1, math.nan),
        skid=np.full(2, math.nan),
        before=np.full(len(ANSWER), math.nan),
        resolution=np.array([angles, angles, math.nan, math.nan, math.nan]),
        tolerances=np.array(tolerances),
    )


@kernel
def at_angles(angles, count, orbit):
    """Return the first part of an orbit's memory, for so many angles a pitch."""
    nodes = angles * count
    return Orbit(
        orbit.speed,
        orbit.cage[:angles],
        orbit.spins[:nodes],
        orbit.accelerations[:angles],
        orbit.rates[:nodes],
        orbit.d_spin[:nodes],
        orbit.drives[:nodes],
        orbit.d_cage[:nodes],
        orbit.pulled[:nodes],
        orbit.damped[:angles],
        orbit.diagonal[:nodes],
        orbit.column[:nodes],
        orbit.columns[: nodes * (1 + angles + STEPS)],
        orbit.matrix[: angles * angles],
        orbit.order[:angles],
        orbit.right[:angles],
        orbit.beside[:nodes],
        orbit.found[:nodes],
        orbit.residual[:nodes],
        orbit.reach[:nodes],
        orbit.rings_y[:angles],
        orbit.rings_z[:angles],
        orbit.state,
        orbit.rate,
        orbit.scanned,
        orbit.slope,
        orbit.skid,
        orbit.before,
        orbit.resolution,
        orbit.tolerances,
    )


@kernel
def roller_at(i, sense, count):
    """Return which roller stands i pitches along the orbit from roller 0."""
    return i if sense > 0.0 else (count - i) % count


@kernel
def _evaluate(k, sense, model, work, orbit):
    """Evaluate level slip at the k-th angle: node k + N i of the orbit is where roller `roller_at` of i stands; return whether loads balanced."""
    angles, count, state = orbit.accelerations.shape[0], model.params.rollers.count, orbit.state
    state[THETA] = sense * 2.0 * math.pi * k / (angles * count)
    state[OMEGA] = orbit.cage[k]
    for i in range(count):
        state[SPIN + roller_at(i, sense, count)] = orbit.spins[k + angles * i]
    work.ring[0], work.ring[1] = orbit.rings_y[k], orbit.rings_z[k]
    balanced = rhs_and_jacobian(0.0, state, model, work, orbit.rate)
    orbit.rings_y[k], orbit.rings_z[k] = work.ring[0], work.ring[1]
    return balanced


@kernel
def _linearise(sense, model, work, orbit):
    """Evaluate level slip at all angles; write derivatives, and the spins' residuals into ``orbit.column``; return whether loads balanced."""
    angles, count, nodes, rows = orbit.accelerations.shape[0], model.params.rollers.count, orbit.spins.shape[0], work.jacobian.rows
    for k in range(angles):
        if not _evaluate(k, sense, model, work, orbit):
            return False
        orbit.accelerations[k], orbit.damped[k] = orbit.rate[OMEGA], work.jacobian.border[1]
        for i in range(count):
            node, j = k + angles * i, roller_at(i, sense, count)
            orbit.rates[node] = orbit.rate[SPIN + j]
            orbit.drives[node], orbit.d_cage[node], orbit.d_spin[node] = rows[ARROW.row, j], rows[ARROW.column, j], rows[ARROW.diagonal, j]
            orbit.pulled[node] = rows[ARROW.pulled, j]
    for m in range(nodes):
        interval = _interval(m % angles, sense, orbit)
        orbit.diagonal[m] = max(_LEAST_SLOPE - interval * orbit.d_spin[m], _FALLING * ALPHA_0)
        orbit.column[m, 0] = interval * orbit.rates[m] - backward_difference(orbit.spins, m)
    return True


@kernel
def _interval(k, sense, orbit):
    """Return the time from node to node by the cage's speed at the k-th angle [s]."""
    return 2.0 * math.pi / (orbit.spins.shape[0] * sense * orbit.cage[k])


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
def _rolling_spin(model):
    """Return the spin of a roller of a cage without slip, without sign [rad/s]."""
    raceways = model.params.raceways
    return 0.5 * abs(model.drive.shaft_speed) * (1.0 - raceways.diameter_ratio) * raceways.pitch_radius / model.params.rollers.radius


@kernel
def solve_spins(sense, model, work, orbit, tolerance, careful):
    """Find the spin curve by Newton's method from ``orbit.spins`` on; ``orbit.accelerations`` are those of the last iterate but one.

    Parameters
    ----------
    sense : of rotation, 1.0 or -1.0.
    model, work : of level slip, the inputs constant.
    tolerance : longest last change, a fraction of the spin of rolling.
    careful : 1 where each spin has a reach of its own, which keeps the iteration together on traction curves that rise
        steeply and are flat beyond, where Newton's leaps from one side to the other; else 0.

    Returns
    -------
    converged : bool
    """
    nodes, scale = orbit.spins.shape[0], _rolling_spin(model)
    for iteration in range(_ITERATIONS[careful]):
        if not _linearise(sense, model, work, orbit):
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
    inner_load_maximum: int = 17  # largest of any roller [N]
    outer_load_maximum: int = 18
    shaft_power: int = 19  # from here on means in time [W]; the order is that of `bearing_sim.levels.common.power.Powers`
    inner_sliding_power: int = 20
    outer_sliding_power: int = 21
    inner_rolling_power: int = 22
    outer_rolling_power: int = 23
    churning_power: int = 24
    windage_power: int = 25
    land_power: int = 26
    pocket_power: int = 27
    damping_power: int = 28
    seal_power: int = 29
    flange_power: int = 30


ANSWER = AnswerColumn()
ACCELERATIONS = slice(ANSWER.acceleration_lead_10, ANSWER.acceleration_64 + 1)
"""Columns of an answer that hold accelerations of a cage, as many as `CAGE_SLIPS`."""


@kernel
def _roll(speed, params, orbit):
    """Let all rollers roll on the outer raceway, the cage at an even speed: nothing is left of the operating point before."""
    orbit.speed[0] = speed
    for k in range(orbit.accelerations.shape[0]):
        orbit.cage[k], orbit.accelerations[k] = speed, 0.0
    for m in range(orbit.spins.shape[0]):
        orbit.spins[m] = speed * params.raceways.pitch_radius / params.rollers.radius


@kernel
def _mean_drive(speed, sense, model, work, orbit, tolerance):
    """Return the mean acceleration of a cage held at a speed, in its sense [rad/s^2]; NaN where the spins were not found.

    The search for spins starts from those at the cage speed before, in proportion.  What their last change does to the acceleration is added to
    first order.
    """
    ratio = speed / orbit.speed[0]
    orbit.speed[0] = speed
    for k in range(orbit.cage.shape[0]):
        orbit.cage[k] = speed
    for m in range(orbit.spins.shape[0]):
        orbit.spins[m] *= ratio
    careful = 0
    while not solve_spins(sense, model, work, orbit, tolerance, careful):
        if careful:
            return math.nan
        careful = 1
        _roll(speed, model.params, orbit)
    total = 0.0
    for k in range(orbit.accelerations.shape[0]):
        total += orbit.accelerations[k]
    for m in range(orbit.spins.shape[0]):
        total += orbit.drives[m] * orbit.column[m, 0]
    return sense * total / orbit.accelerations.shape[0]


@kernel
def _write_cage_columns(weight, sense, orbit, columns):
    """Write what a change of the cage's speed at each angle does to the spins' equations, as right sides behind the first.

    Parameters
    ----------
    weight : as of `_ripple`.
    """
    angles = orbit.accelerations.shape[0]
    for k in range(angles):
        orbit.right[k] = weight * _interval(k, sense, orbit) * orbit.accelerations[k] - backward_difference(orbit.cage, k)
    for m in range(orbit.spins.shape[0]):
        here = m % angles
        for k in range(angles):
            columns[m, 1 + k] = 0.0
        interval, pulled = _interval(here, sense, orbit), orbit.pulled[m] / weight
        columns[m, 0] = orbit.column[m, 0] - pulled * orbit.right[here]
        own = orbit.d_cage[m] + (orbit.pulled[m] * orbit.accelerations[here] - orbit.rates[m]) / orbit.cage[here]
        columns[m, 1 + here] = interval * own + pulled * ALPHA_0
        columns[m, 1 + (here - 1) % angles] += pulled * ALPHA_1
        columns[m, 1 + (here - 2) % angles] += pulled * ALPHA_2
        columns[m, 1 + (here - 3) % angles] += pulled * ALPHA_3


@kernel
def _write_cage_equations(weight, sense, orbit, columns, matrix):
    """Write the equations of the cage's speeds, the spins' eliminated by the solutions in ``columns``; ``weight`` as of `_ripple`.

    The derivatives of level slip leave out that loads change with the cage's speed by the centrifugal forces.  Where the drive hardly depends on the
    speed otherwise, that is all that holds a cage: all angles alike get what the slope of the mean drive has more.
    """
    angles, nodes = orbit.accelerations.shape[0], orbit.spins.shape[0]
    more = orbit.slope[0]
    for k in range(angles):
        more -= orbit.damped[k] / angles
    for m in range(nodes):
        for k in range(angles):
            more -= orbit.drives[m] * columns[m, 1 + k] / angles
    if not math.isfinite(more):
        more = 0.0
    for k in range(angles):
        interval = weight * _interval(k, sense, orbit)
        for other in range(angles):
            matrix[k, other] = 0.0
        matrix[k, k] += ALPHA_0 - interval * (orbit.damped[k] + more - orbit.accelerations[k] / orbit.cage[k])
        matrix[k, (k - 1) % angles] += ALPHA_1
        matrix[k, (k - 2) % angles] += ALPHA_2
        matrix[k, (k - 3) % angles] += ALPHA_3
        for m in range(k, nodes, angles):
            felt = interval * orbit.drives[m]
            orbit.right[k] += felt * columns[m, 0]
            for other in range(angles):
                matrix[k, other] -= felt * columns[m, 1 + other]


@kernel
def _ripple(weight, careful, sense, model, work, orbit):
    """Find the periodic motion of cage and spins by Newton's method from ``orbit`` on; return whether it was found.

    Unknown are the cage's speeds at the angles of a pitch, besides the spins: omega domega/dtheta = weight alpha, by the same differences.  What the
    speeds do to the spins is eliminated by a right side for each.  Where changes do not shrink, half of them is taken.

    Parameters
    ----------
    weight : 1; less for a cage that is more inert by as much, and so ripples less.
    careful : as of `solve_spins`.
    """
    angles, nodes = orbit.accelerations.shape[0], orbit.spins.shape[0]
    columns, matrix = orbit.columns.reshape((nodes, 1 + angles + STEPS)), orbit.matrix.reshape((angles, angles))
    fraction, before, scale = 1.0, math.inf, _rolling_spin(model)
    for iteration in range(_RIPPLE_ITERATIONS[careful]):
        if not _linearise(sense, model, work, orbit):
            return False
        if careful:
            _adapt_reach(scale, iteration, orbit)
        _write_cage_columns(weight, sense, orbit, columns)
        if not solve_cyclic(orbit.diagonal, columns):
            return False
        _write_cage_equations(weight, sense, orbit, columns, matrix)
        if not decompose(angles, matrix, orbit.order):
            return False
        back_substitute(angles, matrix, orbit.order, orbit.right)
        spin_change, cage_change = 0.0, 0.0
        for m in range(nodes):
            for k in range(angles):
                columns[m, 0] += columns[m, 1 + k] * orbit.right[k]
            if careful:
                columns[m, 0] = min(max(columns[m, 0], -orbit.reach[m]), orbit.reach[m])
            spin_change = max(spin_change, abs(columns[m, 0]) / scale)
        for k in range(angles):
            cage_change = max(cage_change, abs(orbit.right[k] / orbit.speed[0]))
        largest = max(spin_change, cage_change)
        if not math.isfinite(largest):
            return False
        alternates = _STALLED * before < largest < _LONGEST_CHANGE
        fraction = max(0.5 * fraction, _LEAST_FRACTION) if alternates else min(2.0 * fraction, 1.0)
        taken, before = min(fraction, _LONGEST_CHANGE / max(largest, 1e-300)), largest
        for m in range(nodes):
            orbit.spins[m] += taken * columns[m, 0]
        passing = 0.0
        for k in range(angles):
            orbit.cage[k] += taken * orbit.right[k]
            if not sense * orbit.cage[k] > 0.0:
                return False
            passing += 1.0 / (angles * orbit.cage[k])
        orbit.speed[0] = 1.0 / passing
        if spin_change <= orbit.tolerances[1] and cage_change <= _RIPPLE_TOLERANCE * orbit.tolerances[0]:
            return True
    return False


@kernel
def _lighten(sense, model, work, orbit):
    """Find the periodic motion of cage and spins with an ever less inert cage, from that of an even one on; return whether it was found."""
    weight, careful = _LIGHTEST, 0
    while True:
        if _ripple(weight, careful, sense, model, work, orbit):
            if weight == 1.0:
                return True
            weight, careful = min(_LIGHTER * weight, 1.0), 0
        elif careful:
            return False
        else:
            careful = 1


@kernel
def _narrow(within, low, drive_low, high, drive_high, ideal, sense, model, work, orbit):
    """Return the slip between two at which the cage is in balance, by the Illinois rule; NaN where spins were not found.

    The slope of the drive there is that of the last two speeds.

    Parameters
    ----------
    within : how near, over 0.01 + slip.
    low, drive_low, high, drive_high : slips, and the drives there.
    """
    slip, slope, beside, drive_beside = high, (drive_high - drive_low) / (high - low), high, drive_high
    orbit.slope[0] = -slope / abs(ideal)
    for _ in range(_HALVINGS):
        slip = low - drive_low * (high - low) / (drive_high - drive_low)
        drive = _mean_drive(ideal * (1.0 - slip), sense, model, work, orbit, _USUAL)
        if not math.isfinite(drive):
            return math.nan
        if slip != beside and drive != drive_beside:
            orbit.slope[0] = -(drive - drive_beside) / ((slip - beside) * abs(ideal))
        beside, drive_beside = slip, drive
        if min(abs(drive / slope), abs(high - low)) < within * (1e-2 + abs(slip)):
            return slip
        if drive * drive_high > 0.0:
            drive_low *= 0.5
        else:
            low, drive_low = high, drive_high
        high, drive_high = slip, drive
    return slip


@kernel
def _settle(low, high, ideal, sense, model, work, orbit):
    """Find the periodic motion of cage and spins between two of `SCANNED`; return whether it was found."""
    scanned = orbit.scanned
    for attempt in range(2):
        _keep_spins(orbit.found, orbit.spins)
        orbit.speed[0] = ideal
        within = orbit.tolerances[0] if attempt else _NARROW
        if not math.isfinite(_narrow(within, SCANNED[low], scanned[low], SCANNED[high], scanned[high], ideal, sense, model, work, orbit)):
            return False
        if _lighten(sense, model, work, orbit) if attempt else _ripple(1.0, 0, sense, model, work, orbit):
            return True
    return False


@kernel
def _losses(answer):
    """Return the sum of an operating point's losses [W]."""
    total = 0.0
    for column in range(ANSWER.inner_sliding_power, ANSWER.flange_power + 1):
        total += answer[column]
    return total


@kernel
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


@kernel
def _keep_spins(spins, kept):
    for m in range(spins.shape[0]):
        kept[m] = spins[m]


@kernel
def scan(to_standstill, model, work, orbit):
    """Look at the drives of cages from one that leads to one that stands still; write them, and how spins follow a cage that skids.

    Parameters
    ----------
    to_standstill : whether to look at slow cages, too, where one that slips by two thirds is driven.
    model : of level slip; inputs constant, the shaft not slower than `CREEP`.
    work : of level slip.
    orbit : `Orbit` of the resolution that is wanted; ``scanned`` and ``skid`` are written.
    """
    params, shaft_speed, scanned = model.params, model.drive.shaft_speed, orbit.scanned
    sense, ideal = 1.0 if shaft_speed > 0.0 else -1.0, 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
    for k in range(orbit.cage.shape[0]):
        orbit.rings_y[k], orbit.rings_z[k] = 0.0, 0.0
    scanned[:] = math.nan
    orbit.skid[:] = math.nan
    _roll(ideal, params, orbit)
    farthest = _FLANGED_LEAD if params.flanges.inner.area > 0.0 else _LARGEST_LEAD
    if params.cage.guidance.turning > 0.0:
        farthest = -SCANNED[0]
    for i in range(ROLLING, SCANNED.shape[0] + ROLLING):
        k = i if i < SCANNED.shape[0] else SCANNED.shape[0] - 1 - i + ROLLING  # lags first, then leads
        if k < ROLLING:
            leads = scanned[ROLLING] > 0.0 and scanned[k + 1] > 0.0 and SCANNED[k] >= -farthest
            if k != _PASSED[0] and not leads:
                continue
            if k == ROLLING - 1 or not leads:
                orbit.speed[0] = ideal
                _keep_spins(orbit.found, orbit.spins)
        elif SCANNED[k] > (_SLOWEST if to_standstill else _SLOW) and not scanned[k - 1] < 0.0:
            continue  # what brakes a cage goes with its speed
        scanned[k] = _mean_drive(ideal * (1.0 - SCANNED[k]), sense, model, work, orbit, _ROUGH)
        if k == ROLLING:
            _keep_spins(orbit.spins, orbit.found)
        elif k == _SKIDDING - 1:
            _keep_spins(orbit.spins, orbit.beside)
        elif k == _SKIDDING:
            inertia, delay = _inertia_and_delay((SCANNED[k] - SCANNED[k - 1]) * ideal, sense, orbit)
            orbit.skid[0], orbit.skid[1] = max(inertia, 1.0), max(delay, 0.0)


@kernel
def _at_load(load, angle, model):
    """Return a model whose constant load [N] has another size; ``angle`` is its direction [rad]."""
    drive = Drive(0.0, model.drive.shaft_speed, 0.0, load * math.cos(angle), 0.0, load * math.sin(angle), 0.0, 0.0)
    return Model(model.params, model.lubrication, drive, model.tolerances)


@kernel
def _least_drive(slip, model, work, orbit):
    """Return the least drive of cages that slip by more than ``slip``, followed from a standstill [rad/s^2]; NaN where none is known."""
    shaft_speed = model.drive.shaft_speed
    sense, ideal = 1.0 if shaft_speed > 0.0 else -1.0, 0.5 * shaft_speed * (1.0 - model.params.raceways.diameter_ratio)
    orbit.rings_y[:] = orbit.rings_z[:] = 0.0
    least = math.nan
    _roll(ideal * (1.0 - SCANNED[SCANNED.shape[0] - 1]), model.params, orbit)
    for back in range(0, SCANNED.shape[0], 2):
        k = SCANNED.shape[0] - 1 - back
        if SCANNED[k] < slip:
            break
        drive = _mean_drive(ideal * (1.0 - SCANNED[k]), sense, model, work, orbit, _ROUGH)
        if not drive >= least and math.isfinite(drive):
            least = drive
    return least


@kernel
def _rolls(slip, model, work, orbit):
    """Return whether a cage that rolls goes on rolling: one that slips by no more than ``slip`` is driven at some of its slips."""
    shaft_speed = model.drive.shaft_speed
    sense, ideal = 1.0 if shaft_speed > 0.0 else -1.0, 0.5 * shaft_speed * (1.0 - model.params.raceways.diameter_ratio)
    orbit.rings_y[:] = orbit.rings_z[:] = 0.0
    _roll(ideal, model.params, orbit)
    for k in range(ROLLING, SCANNED.shape[0]):
        if SCANNED[k] > slip:
            break
        if _mean_drive(ideal * (1.0 - SCANNED[k]), sense, model, work, orbit, _ROUGH) >= 0.0:
            return True
    return False


@kernel
def find_skid_load(slip, angle, least, most, model, work, orbit):
    """Find the load below which a cage that skids goes on skidding although one that rolls goes on rolling.

    The least drive of a skidding cage rises with the load; its zero is bracketed from below, where skids are solved for easily, and narrowed.

    Parameters
    ----------
    slip : above which a cage skids.
    angle : direction of the load [rad].
    least, most : loads between which it is sought [N].
    model : of level slip; its shaft not slower than `CREEP`, its load goes unused.
    work : of level slip.
    orbit : `Orbit`.

    Returns
    -------
    load : [N]; 0 where there is none.
    """
    first = at_angles(int(orbit.resolution[RESOLUTION.first]), model.params.rollers.count, orbit)
    below, above, load = 0.0, math.inf, least
    drive_below = drive_above = math.nan
    while above > _SKID_LOAD_WITHIN * below:
        drive = _least_drive(slip, _at_load(load, angle, model), work, first)
        if drive < 0.0:
            below, drive_below = load, drive
        else:
            above, drive_above = load, drive
        if below == 0.0 and load < least / _LIGHTEST_SKID or load > most:
            return 0.0
        if below == 0.0:
            load = above / _SKID_LOAD_STEP**2
        elif above == math.inf:
            load = below * _SKID_LOAD_STEP
        else:
            part = drive_below / (drive_below - drive_above)
            load = below + (above - below) * (min(max(part, 0.1), 0.9) if math.isfinite(part) else 0.5)
    return below if _rolls(slip, _at_load(below, angle, model), work, first) else 0.0


@kernel
def between(start, scanned):
    """Return between which of `SCANNED` a cage comes to rest: the last at which it is braked, the first at which it is driven.

    The first is -1 where it is not known, the second `SCANNED.shape[0]` where the cage slows down until it stands.

    Parameters
    ----------
    start : slip at which the cage begins; the nearest one that was looked at counts.
    scanned : drives, see `scan`.
    """
    near, most = ROLLING, SCANNED.shape[0]
    for i in range(most):
        if math.isfinite(scanned[i]) and abs(SCANNED[i] - start) < abs(SCANNED[near] - start):
            near = i
    if scanned[near] < 0.0:
        for i in range(near + 1, most):
            if not scanned[i] < 0.0:
                return (i - 1, i) if scanned[i] >= 0.0 else (-1, i)
        return most - 1, most
    for i in range(near - 1, -1, -1):
        if not scanned[i] >= 0.0:
            return (i, i + 1) if scanned[i] < 0.0 and scanned[i + 1] >= 0.0 else (-1, i)
    return -1, 0


def stable_balances(scanned: np.ndarray) -> list[tuple[int, int]]:
    """Return between which two of `SCANNED` cages come to rest, all of them, see `between`; those where drives are not known are left out."""
    looked_at = np.flatnonzero(np.isfinite(scanned))
    found = [(int(low), int(high)) for low, high in zip(looked_at[:-1], looked_at[1:]) if high == low + 1 and scanned[low] < 0.0 <= scanned[high]]
    stops = bool(scanned[-1] < 0.0)  # NaN where it was not looked at
    return found + [(len(scanned) - 1, len(scanned))] * stops


def basin(low: int, high: int, scanned: np.ndarray) -> tuple[float, float]:
    """Return the slips between which a cage comes to a balance between two of `SCANNED`; infinite where nothing else was seen on that side."""
    while low > 0 and scanned[low - 1] < 0.0:
        low -= 1
    while high < len(scanned) and scanned[high] >= 0.0:
        high += 1
    nearest, farthest = -math.inf, math.inf
    if low > 0 and scanned[low - 1] >= 0.0:
        nearest = float(SCANNED[low])
    if high < len(scanned) and scanned[high] < 0.0:
        farthest = float(SCANNED[high - 1])
    return nearest, farthest


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
def _write_way(slip, ideal, sense, model, work, orbit, answer):
    """Write how a cage goes to an operating point, NaN where it leads away from it; ``orbit`` holds its spins."""
    change = _LAG_CHANGE * max(abs(slip), 1e-3) * ideal
    speed = ideal * (1.0 - slip)
    above = _mean_drive(speed + change, sense, model, work, orbit, _USUAL)
    _keep_spins(orbit.spins, orbit.beside)
    below = _mean_drive(speed - change, sense, model, work, orbit, _USUAL)
    slope = sense * (above - below) / (2.0 * change)
    inertia, delay = _inertia_and_delay(2.0 * change, sense, orbit)
    if not math.isfinite(slope + inertia) or not slope < 0.0:
        return
    answer[ANSWER.lag] = -inertia / slope
    answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = max(inertia, 1.0), max(delay, 0.0)
    if slip < _AS_SKIDDING and math.isfinite(orbit.skid[0] + orbit.skid[1]):
        answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = orbit.skid[0], orbit.skid[1]
    for k in range(CAGE_SLIPS.shape[0]):
        answer[ANSWER.acceleration_lead_10 + k] = orbit.scanned[_PASSED[k]] / answer[ANSWER.spin_inertia]


@kernel
def _write_means(sense, model, work, orbit, answer):
    """Write powers and equivalent loads, means in time over a pitch; return the power left to drive the cage [W]."""
    angles, rate, params, moments = orbit.accelerations.shape[0], orbit.rate, model.params, work.load_moments
    answer[ANSWER.shaft_power : ANSWER.flange_power + 1] = 0.0
    moments[:] = 0.0
    answer[ANSWER.inner_load_maximum] = answer[ANSWER.outer_load_maximum] = 0.0
    left, count = 0.0, params.rollers.count
    for k in range(angles):
        _evaluate(k, sense, model, work, orbit)
        cage_speed = orbit.cage[k]
        part = orbit.speed[0] / (cage_speed * angles)  # of the time
        powers = slip_powers(cage_speed, orbit.state[SPIN:], model.drive.shaft_speed, model, work)
        answer[ANSWER.shaft_power] += part * (powers.shaft - kinetic_power(orbit.state, rate, model, work))
        for cause in range(1, ANSWER.flange_power - ANSWER.shaft_power + 1):
            answer[ANSWER.shaft_power + cause] += part * powers[cause]
        left += part * rate[OMEGA]
        for j in range(count):
            inner, outer = work.loads[LOAD.inner, j], work.loads[LOAD.outer, j]
            add_load_moments(inner, outer, part / count, moments)
            answer[ANSWER.inner_load_maximum] = max(answer[ANSWER.inner_load_maximum], inner)
            answer[ANSWER.outer_load_maximum] = max(answer[ANSWER.outer_load_maximum], outer)
    loads = equivalent_loads(moments, oil_at_speed(model.drive.shaft_speed, model), params.life)
    answer[ANSWER.inner_equivalent_load], answer[ANSWER.outer_equivalent_load] = loads.inner, loads.outer
    answer[ANSWER.inner_lamina_load], answer[ANSWER.outer_lamina_load] = loads.inner_lamina, loads.outer_lamina
    answer[ANSWER.reference_modification_factor] = loads.reference_modification_factor
    return abs(left * orbit.speed[0]) * inertia_of_orbits(params, work.loads)


@kernel
def _double(orbit, nodes, angles):
    """Let spins and cage be known at twice as many angles, those in between in the middle of their neighbours.

    Parameters
    ----------
    nodes, angles : as many as there are at present.
    """
    _put_between(orbit.spins, nodes)
    _put_between(orbit.cage, angles)
    _put_between(orbit.rings_y, angles)
    _put_between(orbit.rings_z, angles)


@kernel
def _put_between(values, count):
    """Spread a periodic sequence to every other place, and put the means of neighbours between."""
    first = values[0]
    for back in range(count):
        m = count - 1 - back
        after = first if back == 0 else values[m + 1]
        values[2 * m + 1] = 0.5 * (values[m] + after)
        values[2 * m] = values[m]


@kernel
def _relative(value, before):
    """Return by how much a value differs from the one before, relative; 0 where both are 0."""
    return abs(value - before) / max(abs(before), 1e-300) if value != before else 0.0


@kernel
def _changes(orbit, answer, life):
    """Write by how much the last doubling of the angles has changed an answer, and return the largest of these over what is allowed."""
    before, resolution = orbit.before, orbit.resolution
    lost = _losses(answer)
    resolution[RESOLUTION.slip_change] = abs(answer[ANSWER.cage_slip] - before[ANSWER.cage_slip])
    resolution[RESOLUTION.loss_change] = max(_relative(lost, _losses(before)), _relative(answer[ANSWER.shaft_power], lost))
    resolution[RESOLUTION.life_change] = max(
        _relative(_rate(answer, ANSWER.inner_equivalent_load, life), _rate(before, ANSWER.inner_equivalent_load, life)),
        _relative(_rate(answer, ANSWER.inner_lamina_load, life), _rate(before, ANSWER.inner_lamina_load, life)),
    )
    return max(
        resolution[RESOLUTION.slip_change] / (SLIP_CHANGE[0] + SLIP_CHANGE[1] * abs(answer[ANSWER.cage_slip])),
        resolution[RESOLUTION.loss_change] / LOSS_CHANGE,
        resolution[RESOLUTION.life_change] / LIFE_CHANGE,
    )


@kernel
def _rate(answer, column, life):
    """Return the inverse of a life, of equivalent loads from a column on [1/revolutions]."""
    return 1.0 / rating_life_revolutions(answer[column], answer[column + 1], life)


@kernel
def solve_point(start, to_standstill, model, work, orbit, answer):
    """Find the periodic state that the bearing settles in under the model's inputs at the time 0.

    Parameters
    ----------
    start : slip at which the cage begins: 0 in ideal rolling, 1 where it stands.
    to_standstill : as of `scan`.
    model : of level slip; inputs constant, the shaft not slower than `CREEP`.
    work : of level slip.
    orbit : `Orbit`; keeps the state that was found, the drives of the scan, and how fine the state is resolved.
    answer : result, shape (len(ANSWER),); NaN where no state was found.

    Returns
    -------
    status : see `REASONS`.
    """
    params, shaft_speed, resolution = model.params, model.drive.shaft_speed, orbit.resolution
    sense, ideal = 1.0 if shaft_speed > 0.0 else -1.0, 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
    count, allowed = params.rollers.count, min(model.tolerances.relative / DEFAULT_TOLERANCES.relative, 1.0)
    angles, most = int(resolution[RESOLUTION.first]), orbit.accelerations.shape[0]
    slip, status = math.nan, FAILED
    orbit.before[:] = math.nan
    while True:
        view = at_angles(angles, count, orbit)
        answer[:] = math.nan
        if status == SETTLED and not _ripple(1.0, 0, sense, model, work, view):
            status = FAILED
        elif status == SETTLED:
            slip = 1.0 - view.speed[0] / ideal
        if status == FAILED:
            scan(to_standstill, model, work, view)
            low, high = between(start, orbit.scanned)
            if low < 0:
                return FAILED
            status, slip = STOPPED, SCANNED[SCANNED.shape[0] - 1]
            if high < SCANNED.shape[0]:
                status = SETTLED if _settle(low, high, ideal, sense, model, work, view) else FAILED
                slip = 1.0 - view.speed[0] / ideal
        if status == FAILED:  # more angles may resolve what these do not
            if 2 * angles > most:
                return FAILED
            angles *= 2
            continue
        if status == STOPPED:
            _mean_drive(ideal * (1.0 - slip), sense, model, work, view, _ROUGH)
        answer[ANSWER.cage_slip] = slip if status == SETTLED else 1.0
        left = _write_means(sense, model, work, view, answer)
        if not math.isfinite(left) or (status == SETTLED and left > _LEFT * _losses(answer)):
            status = FAILED
        if status == FAILED and 2 * angles <= most:
            angles *= 2
            continue
        if status == FAILED:
            answer[:] = math.nan
            return FAILED
        resolution[RESOLUTION.angles] = angles
        enough = _changes(orbit, answer, params.life) <= allowed
        if enough or 2 * angles > most:
            break
        for column in range(answer.shape[0]):
            orbit.before[column] = answer[column]
        _double(orbit, angles * count, angles)
        angles *= 2
    answer[ANSWER.shaft_power] = _losses(answer)  # the same, after the check, as of a sample
    _write_way(slip, ideal, sense, model, work, view, answer)
    return status
