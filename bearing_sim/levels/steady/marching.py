# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Operating points of level ``steady`` that have no smooth periodic state: level ``slip`` is run until its mean slip rests.

Where spins jump, the way there, and so the lag, is up to ten times too short at stock tolerances; the state that it ends in is not
(`test/test_level_steady.py`).
"""

import math

import numpy as np

from bearing_sim.levels.common.state_transfer import start_means
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.model import advance
from bearing_sim.levels.slip.state import OMEGA, THETA
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.model.sample import OBSERVABLES, flat, new_block
from bearing_sim.numerics.time_stepping import CONTROL, OK, STEP_BUDGET, new_counts, new_memory

_SAMPLES = 96  # in a window
_TURNS = 3.37  # of an ideal cage in the first window, no whole number of pitches
_WINDOWS = 12  # each twice as long as the one before from the second on
_AGREED, _AGREED_FLOOR = 2e-3, 5e-5  # of slips of two windows
_RESTS = 5e-4  # instead of the floor where steps run out: what counts as rest in a run, see `bearing_sim.sweep.settling.OBSERVED`
_SHORTEST_WINDOW, _CUT_WINDOWS = 0.1, 3  # of the first window, and how many of them are marched, where steps run out
_FIRST_STEP, _LONGEST_STEP = 1e-6, 1.0  # s
_BUDGET = 60_000  # steps of a window
_AN_INSTANT = 1e-6  # of an ideal cage turn
_MEANS = [each.name for each in OBSERVABLES if each.name in ANSWER._fields[ANSWER.inner_equivalent_load :]]


def march(start: float, model, answer: np.ndarray) -> int:
    """March until two windows agree; write the means over the last.

    The lag is the area between the cage's speed and its end, over their first distance.  Where spins jump all the time a window runs out of steps.
    It ends there, and so do the next ones; the march has settled if two of them agree as far as slip rests in any run.

    Parameters
    ----------
    start : slip at which the cage begins, rollers rolling on the outer raceway.
    model : of level slip; inputs constant.
    answer : result, shape (len(ANSWER),).

    Returns
    -------
    status : OK, or STEP_BUDGET where the answer has not settled; anything else means that there is none.
    """
    params = model.params
    count, ideal = params.rollers.count, 0.5 * model.drive.shaft_speed * (1.0 - params.raceways.diameter_ratio)
    first = (1.0 - start) * ideal
    work, memory, counts = slip_state.new_work(params), new_memory(count + 2), new_counts()
    y = np.full(count + 2, first * params.raceways.pitch_radius / params.rollers.radius)
    y[THETA], y[OMEGA] = 0.0, first
    start_means(model, work, first)
    block = new_block(_SAMPLES, count)
    rows, previous = flat(block), flat(new_block(1, count))[0]
    _forget_spins(previous, count)

    def window_of(length: float, step: float) -> tuple[int, float]:
        return advance(False, time, length, y, step, _LONGEST_STEP, _BUDGET, model, work, memory, counts, previous, rows)

    time, window, step, before = 0.0, _TURNS * math.tau / abs(ideal), _FIRST_STEP, math.inf
    shortest, cut, mean, turned, status, filled = _SHORTEST_WINDOW * window, 0, first, 0.0, OK, _SAMPLES
    for _ in range(_WINDOWS):
        angle = y[THETA]
        status, step = window_of(window, step)
        if status not in (OK, STEP_BUDGET):
            return status
        marched = window if status == OK else memory.control[CONTROL.time] - time
        if marched < shortest:
            break
        time += marched
        turned, filled = y[THETA], int(_SAMPLES * marched / window)
        mean = (y[THETA] - angle) / marched
        slipped = 1.0 - mean / ideal
        if abs(slipped - before) < (_AGREED_FLOOR if status == OK else _RESTS) + _AGREED * abs(slipped):
            status = OK
            break
        before = slipped
        previous[:] = rows[-1]
        if status == OK:
            window *= 2.0
            continue
        cut += 1
        if cut == _CUT_WINDOWS:
            break
        window = marched
        _forget_spins(previous, count)
    if status == STEP_BUDGET and time == 0.0:
        mean = y[OMEGA]
        again, _ = window_of(_AN_INSTANT * window, _FIRST_STEP)
        if again != OK:
            return again
    away = first - mean
    lag = (turned - mean * time) / away if abs(away) > 1e-6 * abs(ideal) else 0.0
    answer[:] = math.nan
    answer[ANSWER.cage_slip], answer[ANSWER.lag] = 1.0 - mean / ideal, min(max(lag, 0.0), time)
    answer[ANSWER.spin_inertia], answer[ANSWER.spin_delay] = 1.0, 0.0  # in this lag
    for name in _MEANS:
        taken = block[name][: max(filled, 1)]
        answer[getattr(ANSWER, name)] = taken.max() if name.endswith("_maximum") else taken.mean()
    return status


def _forget_spins(row: np.ndarray, count: int) -> None:
    """Let the next sample take its powers from its instant alone: nothing was sampled where its interval begins."""
    row.view(new_block(1, count).dtype)["roller_spin"] = math.nan
