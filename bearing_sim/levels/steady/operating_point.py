# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One operating point of level ``steady``: which periodic state a bearing settles in, and what it is like there.

Several states may be in balance where slip is large.  A run from ideal rolling settles in the one whose slip comes first: the
spins follow the cage within a fraction of its own time, so the cage goes down the mean torque until that is zero.  The search
does the same: from ideal rolling on in steps of slip until the mean torque on the cage changes its sign.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.cyclic import solve_cyclic
from bearing_sim.levels.slip import OMEGA, SPIN, equivalent_loads, rhs
from bearing_sim.levels.slip_power import slip_powers
from bearing_sim.levels.steady_orbit import set_state, solve_spins

CREEP = 1.0  # rad/s; a slower shaft is answered for as if it turned so fast
SETTLED, STOPPED, FAILED = 0, 1, 2
REASONS = {
    SETTLED: "periodic state found",
    STOPPED: "nothing drives the cage",
    FAILED: "no periodic state was found",
}

_SLIPS = np.array([0.0, 1e-3, 4e-3, 0.012, 0.03, 0.06, 0.1, 0.15, 0.2, 0.26, 0.33, 0.4, 0.48, 0.56, 0.64, 0.72, 0.8, 0.88, 0.94, 0.98, 0.995, 0.999])
_ITERATIONS = 15
_CAREFUL_ITERATIONS = 150
_ROUGH, _FINE = 1e-3, 1e-5  # of the spin of rolling
_SLIP_TOLERANCE = 1e-5
_LARGEST_LEAD = 0.1  # negative slip; a cage that seems to be driven beyond has spins that were not resolved
_HALVINGS = 40
_LAG_CHANGE = 1e-2  # of the slip


class AnswerColumn(NamedTuple):
    """What an operating point is answered by, and where."""

    cage_slip: int = 0  # mean in time
    lag: int = 1  # time constant of the cage's way back to it [s]
    inner_equivalent_load: int = 2  # [N]
    outer_equivalent_load: int = 3
    shaft_power: int = 4  # from here on means in time [W]; the order is that of `bearing_sim.levels.power.Powers`
    inner_sliding_power: int = 5
    outer_sliding_power: int = 6
    churning_power: int = 7
    windage_power: int = 8
    land_power: int = 9
    pocket_power: int = 10
    damping_power: int = 11


ANSWER = AnswerColumn()


@kernel
def _roll(speed, params, orbit):
    """Let all rollers roll on the outer raceway."""
    orbit.speed[0] = speed
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
    before, drive_before = 0.0, _mean_drive(ideal, sense, model, work, orbit, _ROUGH)
    away = 1.0 if drive_before < 0.0 else -1.0  # most cages lag, those of slow bearings lead by next to nothing
    for i in range(1, _SLIPS.shape[0]):
        slip = away * _SLIPS[i]
        drive = _mean_drive(ideal * (1.0 - slip), sense, model, work, orbit, _ROUGH)
        if not math.isfinite(drive + drive_before) or slip < -_LARGEST_LEAD:
            return math.nan, math.nan, math.nan, math.nan
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
        drive = _mean_drive(ideal * (1.0 - slip), sense, model, work, orbit, _FINE)
        if not math.isfinite(drive):
            return math.nan
        if min(abs(drive / slope), abs(high - low)) < _SLIP_TOLERANCE * (1e-2 + abs(slip)):
            return slip
        if drive * drive_high > 0.0:
            drive_low *= 0.5
        else:
            low, drive_low = high, drive_high
        high, drive_high = slip, drive
    return slip


@kernel
def _lag(slip, ideal, sense, model, work, orbit):
    """Return the time constant of the cage's way to balance [s]; NaN where it leads away.

    The slope of the mean drive by cage speed, over the inertia: that of cage and orbiting rollers, and of the spins that must
    go with them, felt through the tractions.
    """
    places, angles = orbit.spins.shape[0], orbit.accelerations.shape[0]
    change = _LAG_CHANGE * max(abs(slip), 1e-3) * ideal
    speed = ideal * (1.0 - slip)
    above = _mean_drive(speed + change, sense, model, work, orbit, _FINE)
    for m in range(places):
        orbit.beside[m] = orbit.spins[m]
    below = _mean_drive(speed - change, sense, model, work, orbit, _FINE)
    slope = sense * (above - below) / (2.0 * change)
    interval = 2.0 * math.pi / (places * sense * speed)
    for m in range(places):
        orbit.column[m, 0] = interval * (orbit.beside[m] - orbit.spins[m]) / (2.0 * change)
    if not math.isfinite(slope) or not slope < 0.0 or not solve_cyclic(orbit.slopes, orbit.column):
        return math.nan
    inertia = 1.0
    for m in range(places):
        inertia += orbit.drives[m] * orbit.column[m, 0] / angles
    return -inertia / slope


@kernel
def _write_powers(speed, sense, model, work, orbit, answer):
    """Write powers, means over a pitch."""
    angles, rate = orbit.accelerations.shape[0], orbit.rate
    for column in range(ANSWER.shaft_power, ANSWER.damping_power + 1):
        answer[column] = 0.0
    for k in range(angles):
        set_state(k, speed, sense, model.params, orbit)
        rhs(0.0, orbit.state, model, work, rate)
        powers = slip_powers(speed, rate[OMEGA], orbit.state[SPIN:], model.drive.shaft_speed, model, work)
        answer[ANSWER.shaft_power] += powers.shaft / angles
        answer[ANSWER.inner_sliding_power] += powers.inner_sliding / angles
        answer[ANSWER.outer_sliding_power] += powers.outer_sliding / angles
        answer[ANSWER.churning_power] += powers.churning / angles
        answer[ANSWER.windage_power] += powers.windage / angles
        answer[ANSWER.land_power] += powers.land / angles
        answer[ANSWER.pocket_power] += powers.pocket / angles
        answer[ANSWER.damping_power] += powers.damping / angles


@kernel
def solve_point(model, work, orbit, answer):
    """Find the periodic state that the bearing settles in under the model's inputs at the time 0.

    Parameters
    ----------
    model : of level slip; inputs constant, the shaft not slower than `CREEP`.
    work : of level slip.
    orbit : `bearing_sim.levels.steady_orbit.Orbit`; keeps the state that was found, and the cage's accelerations in it.
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
        slip = _narrow(slip, drive, beyond, drive_beyond, ideal, sense, model, work, orbit)
    if not math.isfinite(slip):
        return FAILED
    answer[ANSWER.lag] = _lag(slip, ideal, sense, model, work, orbit)
    speed = ideal * (1.0 - slip)
    if not math.isfinite(_mean_drive(speed, sense, model, work, orbit, _FINE)):
        return FAILED
    answer[ANSWER.cage_slip] = slip if status == SETTLED else 1.0
    _write_powers(speed, sense, model, work, orbit, answer)
    answer[ANSWER.inner_equivalent_load], answer[ANSWER.outer_equivalent_load] = equivalent_loads(
        0.0, speed, model.drive.load_y, model.drive.load_z, model.params, work
    )
    return status
