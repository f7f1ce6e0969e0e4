# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What backward differentiation formulas keep from step to step: backward differences of the state, and their algebra.

The polynomial of order k through the last k + 1 states, h apart, is y(t + s h) = sum_j D_j s (s + 1) ... (s + j - 1)/j!, where
D_j is the j-th backward difference at t and D_0 the state (Shampine and Reichelt 1997, section 2.1).
"""

from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel

HIGHEST_ORDER = 5  # the formula of order 6 is hardly stable, those above are not
_AFTER_SLIVER = 4.0
CONVERGED, FAILED, INFINITE = -1, -2, -3  # how an iteration ended, where it is none of the statuses of a drive loop


class Figure(NamedTuple):
    """Where each number stands in ``History.figures``."""

    time: int = 0  # of the newest state [s]
    step: int = 1  # spacing of the differences [s]
    wanted: int = 2  # step that the error allows [s]
    shift: int = 3  # of the factorisation at hand [s]; 0 where there is none
    contraction: int = 4  # of the iteration, latest estimate
    returned: int = 5  # time to which the last call came [s]


FIGURE = Figure()


class History(NamedTuple):
    """Memory of the method."""

    scratch: np.ndarray  # rate, new state, change, correction, what is known, shape (5, n)
    differences: np.ndarray  # D_0 to D_7, shape (8, n)
    resized: np.ndarray  # scratch, shape (HIGHEST_ORDER, n)
    weights: np.ndarray  # scratch, shape (HIGHEST_ORDER + 1, HIGHEST_ORDER + 1)
    state: np.ndarray  # that the last call came to, shape (n,)
    figures: np.ndarray  # see Figure
    order: np.ndarray  # order, 0 where there is no history; steps since step or order changed; int64


def new_history(size: int) -> History:
    """Return an empty history of ``size`` states."""
    ends = HIGHEST_ORDER + 1
    arrays = [np.zeros((rows, size)) for rows in (5, HIGHEST_ORDER + 3, HIGHEST_ORDER)]
    return History(*arrays, np.zeros((ends, ends)), np.zeros(size), np.zeros(len(FIGURE)), np.zeros(2, np.int64))


@kernel
def remember(t, y, h, maximum_step, history):
    """Return whether the history leads to this time and state; begin a new one where not, whose D_1 is left to the caller."""
    figures, known = history.figures, history.order[0] > 0
    if known and abs(t - figures[FIGURE.returned]) <= 1e-6 * figures[FIGURE.step]:
        for i in range(y.shape[0]):
            known = known and y[i] == history.state[i]
        if known:
            return True
    history.differences[:] = 0.0
    for i in range(y.shape[0]):
        history.differences[0, i] = y[i]
    history.order[0], history.order[1] = 1, 0
    figures[FIGURE.time], figures[FIGURE.shift], figures[FIGURE.contraction] = t, 0.0, 1.0
    figures[FIGURE.step] = figures[FIGURE.wanted] = min(h, maximum_step)
    return False


@kernel
def change_step(ratio, history):
    """Turn the differences into those of the same polynomial at steps ``ratio`` times as long."""
    order, differences, weights, resized = history.order[0], history.differences, history.weights, history.resized
    history.order[1] = 0
    # values at 0, -ratio, -2 ratio ... of the polynomial of one difference alone, then their differences
    for m in range(order + 1):
        value = 1.0
        for j in range(1, order + 1):
            value *= (j - 1.0 - m * ratio) / j
            weights[m, j] = value
    for level in range(1, order + 1):
        for m in range(order, level - 1, -1):
            for j in range(1, order + 1):
                weights[m, j] = weights[m - 1, j] - weights[m, j]
    for m in range(1, order + 1):
        resized[m - 1, :] = 0.0
        for j in range(1, order + 1):
            weight = weights[m, j]
            for i in range(differences.shape[1]):
                resized[m - 1, i] += weight * differences[j, i]
    for m in range(1, order + 1):
        for i in range(differences.shape[1]):
            differences[m, i] = resized[m - 1, i]


@kernel
def predict(history):
    """Write the state predicted one step on, a correction of 0, and what the formula knows; return h over its leading coefficient.

    The formula, sum of D_m/m over 1 to k at the new time = h f, reads correction = shift f - known with the new state as
    prediction plus correction.
    """
    order, differences = history.order[0], history.differences
    y, correction, known = history.scratch[1], history.scratch[3], history.scratch[4]
    for i in range(y.shape[0]):
        y[i], correction[i], known[i] = differences[0, i], 0.0, 0.0
    leading = 0.0
    for m in range(1, order + 1):
        leading += 1.0 / m
        for i in range(y.shape[0]):
            y[i] += differences[m, i]
            known[i] += leading * differences[m, i]
    for i in range(y.shape[0]):
        known[i] /= leading
    return history.figures[FIGURE.step] / leading


@kernel
def accept(stop, history):
    """Take the corrected step into the differences; the time becomes exactly ``stop`` where the step ends there."""
    order, differences, correction, figures = history.order[0], history.differences, history.scratch[3], history.figures
    for i in range(correction.shape[0]):
        differences[order + 2, i] = correction[i] - differences[order + 1, i]
        differences[order + 1, i] = correction[i]
    for m in range(order, -1, -1):
        for i in range(correction.shape[0]):
            differences[m, i] += differences[m + 1, i]
    figures[FIGURE.time] += figures[FIGURE.step]
    if abs(stop - figures[FIGURE.time]) <= 1e-6 * figures[FIGURE.step]:
        figures[FIGURE.time] = stop
    # After a sliver before `stop` the differences say little about the length of the next step.
    figures[FIGURE.wanted] = min(figures[FIGURE.wanted], _AFTER_SLIVER * figures[FIGURE.step])
    history.order[1] += 1


@kernel
def interpolate(t, history, y):
    """Write the state at ``t``, not later than the newest, into ``y`` and into the history as where the call came to."""
    figures, differences = history.figures, history.differences
    place, weight = (t - figures[FIGURE.time]) / figures[FIGURE.step], 1.0
    for i in range(y.shape[0]):
        y[i] = differences[0, i]
    for j in range(1, history.order[0] + 1):
        weight *= (place + j - 1.0) / j
        for i in range(y.shape[0]):
            y[i] += weight * differences[j, i]
    for i in range(y.shape[0]):
        history.state[i] = y[i]
    figures[FIGURE.returned] = t
