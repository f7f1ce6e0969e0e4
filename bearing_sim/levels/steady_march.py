# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""An operating point of level ``steady`` by marching level ``slip`` until it has settled: where the search for a periodic state ends without one.

A traction curve that falls steeply (oil at frost, a loaded bearing that creeps) lets spins jump: they have no smooth periodic
curve, and what the bearing does in the mean is found by letting it run.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.integrators.memory import Memory, new_memory
from bearing_sim.integrators.status import OK, STEP_BUDGET, new_counts
from bearing_sim.kernels.compilation import kernel
from bearing_sim.levels import slip
from bearing_sim.levels.slip import OMEGA, THETA
from bearing_sim.levels.steady_point import ANSWER
from bearing_sim.sample import COLUMN, flat, new_block

_SAMPLES = 24  # in a window
_TURNS = 3.37  # of an ideal cage in the first window, no whole number of pitches
_WINDOWS = 12  # each twice as long as the one before from the second on
_AGREED, _AGREED_FLOOR = 2e-3, 5e-5  # of slips of two windows
_BUDGET = np.int64(60_000)  # steps of a window; a Python number would be a literal type, and with it a second compilation of the march
_FIRST_STEP, _LONGEST_STEP = 1e-6, 1.0  # s
_AN_INSTANT = 1e-6  # of an ideal cage turn


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
def march(model, work, memory, answer):
    """March from ideal rolling until two windows agree; write the means over the last.

    The lag is the area between the cage's speed and its end, over their first distance.  A march that runs out of steps, because spins
    jump all the time, is taken as far as it came.

    Parameters
    ----------
    model : of level slip; inputs constant.
    work : of level slip.
    memory : `March`.
    answer : result, shape (len(ANSWER),).

    Returns
    -------
    status : OK, or STEP_BUDGET where the answer is no settled one; anything else means that there is none.
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
    mean, turned, status = ideal, 0.0, OK
    for _ in range(_WINDOWS):
        angle = y[THETA]
        status, step = slip.advance(
            time, window, y, step, _LONGEST_STEP, _BUDGET, model, work, memory.memory, memory.counts, rows[rows.shape[0] - 1], rows
        )
        if status == STEP_BUDGET:
            break
        if status != OK:
            return status
        time += window
        turned = y[THETA]
        mean = (y[THETA] - angle) / window
        slipped = 1.0 - mean / ideal
        if abs(slipped - before) < _AGREED_FLOOR + _AGREED * abs(slipped):
            break
        before = slipped
        window *= 2.0
    if status == STEP_BUDGET and time == 0.0:
        mean = y[OMEGA]
        instant = _AN_INSTANT * window
        again, step = slip.advance(
            time, instant, y, _FIRST_STEP, _LONGEST_STEP, _BUDGET, model, work, memory.memory, memory.counts, rows[rows.shape[0] - 1], rows
        )
        if again != OK:
            return again
    answer[ANSWER.cage_slip] = 1.0 - mean / ideal
    away = ideal - mean
    lag = (turned - mean * time) / away if abs(away) > 1e-6 * abs(ideal) else 0.0
    answer[ANSWER.lag] = min(max(lag, 0.0), time)
    for column in range(ANSWER.inner_equivalent_load, answer.shape[0]):
        source = COLUMN.inner_equivalent_load + column - ANSWER.inner_equivalent_load
        if column >= ANSWER.shaft_power:
            source = COLUMN.shaft_power + column - ANSWER.shaft_power
        total = 0.0
        for k in range(rows.shape[0]):
            total += rows[k, source]
        answer[column] = total / rows.shape[0]
    return status
