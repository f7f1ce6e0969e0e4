# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The spins of all rollers while a cage of level ``slip`` turns evenly under constant inputs: one periodic curve around the bearing.

After a roller pitch of cage rotation every roller stands where the one ahead of it stood, and so do loads and spins.  Along the
orbit a spin obeys

    |omega_c| dw/dtheta = f(theta, w),

f the right-hand side of level ``slip``.  It is solved for at N places a pitch, Z N in all, by backward differences that close
upon themselves and Newton's method: means over a pitch are found without marching to them.

The cage's speed is held even.  Its ripple within a pitch moves the mean slip by far less than the differences' own error
(`test/test_level_steady.py` measures both).
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.arrow import ARROW
from bearing_sim.kernels.cage import pocket_friction
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.cyclic import ALPHA_0, STEPS, backward_difference, solve_cyclic
from bearing_sim.kernels.load_balance import LOAD
from bearing_sim.levels.slip import OMEGA, SPIN, THETA, rhs_and_jacobian

ANGLES = 11  # N
_LEAST_SLOPE = 1e-6  # a spin that nothing brakes or drives keeps what it has
_FALLING = -0.8  # of alpha_0; more than that of a falling traction curve would turn Newton's step round
_SHORTER, _LONGER = 0.4, 1.6
_SHORTEST_CHANGE = 1e-9
_LONGEST_CHANGE = 0.3  # of the spin of rolling, in an iteration


class Orbit(NamedTuple):
    """State and workspace; M = N Z places along the orbit, in the order in which a roller passes them."""

    speed: np.ndarray  # of the cage that the spins belong to [rad/s], shape (1,)
    spins: np.ndarray  # [rad/s], shape (M,)
    accelerations: np.ndarray  # of the cage at N angles [rad/s^2], shape (N,)
    rates: np.ndarray  # dw/dt [rad/s^2], shape (M,)
    by_spin: np.ndarray  # slopes of these by the spin itself [1/s], shape (M,)
    drives: np.ndarray  # slopes of the cage's acceleration by the spins [1/s], shape (M,)
    slopes: np.ndarray  # of the differences' equations, shape (M,)
    column: np.ndarray  # a right side, and three for the closing of the orbit, shape (M, 1 + 3)
    beside: np.ndarray  # spins at a cage speed nearby, shape (M,)
    missing: np.ndarray  # right side of the iteration before, shape (M,)
    reach: np.ndarray  # how far each spin may go in an iteration [rad/s], shape (M,)
    state: np.ndarray  # of level slip, shape (Z + 2,)
    rate: np.ndarray  # shape (Z + 2,)


def new_orbit(count: int, angles: int = ANGLES) -> Orbit:
    """Return zeroed memory for ``count`` rollers and that many angles a pitch."""
    places = count * angles
    return Orbit(
        speed=np.ones(1),
        spins=np.zeros(places),
        accelerations=np.zeros(angles),
        rates=np.zeros(places),
        by_spin=np.zeros(places),
        drives=np.zeros(places),
        slopes=np.zeros(places),
        column=np.zeros((places, 1 + STEPS)),
        beside=np.zeros(places),
        missing=np.zeros(places),
        reach=np.zeros(places),
        state=np.zeros(count + 2),
        rate=np.zeros(count + 2),
    )


@kernel
def roller_at(i, sense, count):
    """Return which roller stands i pitches along the orbit from roller 0."""
    return i if sense > 0.0 else (count - i) % count


@kernel
def set_state(k, speed, sense, params, orbit):
    """Write the state of level slip at the k-th angle: place k + N i of the orbit is where roller `roller_at` of i stands."""
    angles, count, state = orbit.accelerations.shape[0], params.rollers.count, orbit.state
    state[THETA] = sense * 2.0 * math.pi * k / (angles * count)
    state[OMEGA] = speed
    for i in range(count):
        state[SPIN + roller_at(i, sense, count)] = orbit.spins[k + angles * i]


@kernel
def _take_slopes(k, sense, params, work, orbit):
    """Take over level slip's slopes at the k-th angle, and add what its Jacobian leaves out: a pocket presses as its roller is driven."""
    angles, rollers, cage = orbit.accelerations.shape[0], params.rollers, params.cage
    rows, loads, count = work.jacobian.rows, work.loads, params.rollers.count
    inertia = cage.inertia
    for j in range(count):
        inertia += rollers.mass * loads[LOAD.radius, j] * loads[LOAD.radius, j]
    for i in range(count):
        place, j = k + angles * i, roller_at(i, sense, count)
        radius = loads[LOAD.radius, j]
        pressed = work.tangential[j] > rollers.mass * radius * orbit.accelerations[k]
        friction = pocket_friction(orbit.state[SPIN + j], cage.pocket_friction) * (1.0 if pressed else -1.0)
        driven = rows[ARROW.row, j] / radius  # slope of the force along the orbit, over the inertia
        orbit.by_spin[place] = rows[ARROW.diagonal, j] - friction * rollers.radius * inertia * driven / rollers.inertia
        orbit.drives[place] = rows[ARROW.row, j] - cage.pocket_reaction * friction * rollers.radius * driven


@kernel
def _linearise(speed, sense, model, work, orbit):
    """Evaluate level slip at all angles; write slopes, and what is missing into ``orbit.column``; return whether loads balanced."""
    angles, count, places = orbit.accelerations.shape[0], model.params.rollers.count, orbit.spins.shape[0]
    for k in range(angles):
        set_state(k, speed, sense, model.params, orbit)
        if not rhs_and_jacobian(0.0, orbit.state, model, work, orbit.rate):
            return False
        orbit.accelerations[k] = orbit.rate[OMEGA]
        for i in range(count):
            orbit.rates[k + angles * i] = orbit.rate[SPIN + roller_at(i, sense, count)]
        _take_slopes(k, sense, model.params, work, orbit)
    interval = 2.0 * math.pi / (places * sense * speed)  # time from place to place
    for m in range(places):
        orbit.slopes[m] = max(_LEAST_SLOPE - interval * orbit.by_spin[m], _FALLING * ALPHA_0)
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
        elif left * orbit.missing[m] < 0.0:
            orbit.reach[m] *= _SHORTER
        else:
            orbit.reach[m] = min(orbit.reach[m] * _LONGER, longest)
        orbit.reach[m] = max(orbit.reach[m], _SHORTEST_CHANGE * scale)
        orbit.missing[m] = left
        # where traction falls with sliding, the root lies where the residual points to, not where the slope does
        orbit.slopes[m] = max(orbit.slopes[m], _LEAST_SLOPE)


@kernel
def solve_spins(speed, sense, model, work, orbit, tolerance, iterations, careful):
    """Find the spin curve by Newton's method from ``orbit.spins`` on; ``orbit.accelerations`` are those of the last iterate but one.

    Parameters
    ----------
    speed : of the cage [rad/s].
    sense : of rotation, 1.0 or -1.0.
    model, work : of level slip, the inputs constant.
    tolerance : longest last change, a share of the spin of rolling.
    iterations : most of them.
    careful : whether each spin has a reach of its own, which keeps the iteration together on traction curves that rise
        steeply and are flat beyond, where Newton's leaps from one side to the other.

    Returns
    -------
    converged : bool
    """
    places = orbit.spins.shape[0]
    scale = abs(speed) * model.params.raceways.pitch_radius / model.params.rollers.radius
    for iteration in range(iterations):
        if not _linearise(speed, sense, model, work, orbit):
            return False
        if careful:
            _adapt_reach(scale, iteration, orbit)
        if not solve_cyclic(orbit.slopes, orbit.column):
            return False
        if careful:
            for m in range(places):
                orbit.column[m, 0] = min(max(orbit.column[m, 0], -orbit.reach[m]), orbit.reach[m])
        change = _largest(orbit.column)
        if not math.isfinite(change):
            return False
        share = min(1.0, _LONGEST_CHANGE * scale / max(change, 1e-300))
        for m in range(places):
            orbit.spins[m] += share * orbit.column[m, 0]
        if change <= tolerance * scale:
            return True
    return False
