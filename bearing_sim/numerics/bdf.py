# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Backward differentiation formulas of orders 1 to 5 with variable step and order (Gear's method).

Quasi-constant steps in backward differences: L. F. Shampine, M. W. Reichelt: The MATLAB ODE suite, SIAM J. Sci. Comput. 18
(1997), section 2, with their kappa = 0, that is the formulas of C. W. Gear: Numerical Initial Value Problems in Ordinary
Differential Equations (1971).  The idea of keeping the history of a polynomial is that of G. D. Byrne, A. C. Hindmarsh, ACM Trans.
Math. Softw. 1 (1975).

The polynomial of order k through the last k + 1 states, h apart, is y(t + s h) = sum_j D_j s (s + 1) ... (s + j - 1)/j!, where
D_j is the j-th backward difference at t and D_0 the state (Shampine and Reichelt 1997, section 2.1).

Steps go past the end of an interval, whose state is read from the polynomial, but never past `stop`: what drives the system from
outside may have a kink there.  The history outlives the call.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel, template
from bearing_sim.numerics.newton import NEWTON, solve_implicit
from bearing_sim.numerics.time_stepping import (
    CONTROL,
    COUNT,
    NOT_CONVERGED,
    NOT_EVALUATED,
    OK,
    SMALLEST_STEP,
    STEP_BUDGET,
    advance_adaptively,
    start_from_known,
)

HIGHEST_ORDER = 5  # the formula of order 6 is hardly stable, those above are not
_ENOUGH = 0.1  # of the tolerances, times order + 1: the error that the iteration of a step may leave
# Safety factors in the step of the order below, at hand and above (Shampine and Reichelt 1997); the others are assumptions.
_LOWER, _SAME, _HIGHER = 1.3, 1.2, 1.4
_WORTH_CHANGING, _LARGEST_GROWTH, _LARGEST_SHRINK = 1.5, 10.0, 0.2
_SHRINK_FIRST, _SHRINK_LATER, _SHRINK_UNSOLVED, _SHRINK_NON_FINITE = 0.9, 0.5, 0.5, 0.1
_TRUSTED_FAILURES = 2  # in succession; after more the history is no guide
_BELOW_LIMIT = 0.9  # of a step limit that varies: a step just at the limit would have to change each time
_AFTER_SHORT_STEP = 4.0  # growth at most, because differences at short steps say little about long ones


class Count(NamedTuple):
    """Where each number stands in ``History.order``."""

    order: int = 0  # 0 where there is no history
    equal_steps: int = 1  # since step or order changed
    failures: int = 2  # in succession


ORDER = Count()


class History(NamedTuple):
    """Memory of the method."""

    scratch: np.ndarray  # rate, new state, change, correction, what is known, shape (5, n); the first is free between calls
    differences: np.ndarray  # D_0 to D_7, shape (8, n)
    resized: np.ndarray  # scratch, shape (HIGHEST_ORDER, n)
    weights: np.ndarray  # scratch, shape (HIGHEST_ORDER + 1, HIGHEST_ORDER + 1)
    state: np.ndarray  # that the last call returned, shape (n,)
    returned: np.ndarray  # time of that state [s], shape (1,)
    control: np.ndarray  # see `bearing_sim.numerics.time_stepping.Control`; the step is the spacing of the differences
    newton: np.ndarray  # see `bearing_sim.numerics.newton.Newton`
    order: np.ndarray  # see `Count`, int64


def new_history(size: int) -> History:
    """Return an empty history of ``size`` states."""
    ends = HIGHEST_ORDER + 1
    arrays = [np.zeros((rows, size)) for rows in (5, HIGHEST_ORDER + 3, HIGHEST_ORDER)]
    numbers = np.zeros(1), np.zeros(len(CONTROL)), np.zeros(len(NEWTON))
    return History(*arrays, np.zeros((ends, ends)), np.zeros(size), *numbers, np.zeros(len(ORDER), np.int64))


@kernel
def resume(t, y, h, maximum_step, history):
    """Return whether the history leads to this time and state; start a new one if not, and leave its D_1 to `start_along_tangent`."""
    control, known = history.control, history.order[ORDER.order] > 0
    history.order[ORDER.failures] = 0
    if known and abs(t - history.returned[0]) <= 1e-6 * control[CONTROL.step]:
        for i in range(y.shape[0]):
            known = known and y[i] == history.state[i]
        if known:
            return True
    history.differences[:] = 0.0
    for i in range(y.shape[0]):
        history.differences[0, i] = y[i]
    history.order[ORDER.order], history.order[ORDER.equal_steps] = 1, 0
    control[CONTROL.time], history.newton[NEWTON.shift], history.newton[NEWTON.contraction] = t, 0.0, 1.0
    control[CONTROL.step] = control[CONTROL.next_step] = min(h, maximum_step)
    return False


@template
def start_along_tangent(rhs, model, work, history, counts):
    """Write D_1 of a history of order 1; return False, and drop the history, where the right-hand side cannot be evaluated."""
    control, slope = history.control, history.differences[1]
    counts[COUNT.right_hand_sides] += 1
    history.order[ORDER.order], history.order[ORDER.equal_steps] = 1, 0
    if not rhs(control[CONTROL.time], history.differences[0], model, work, slope):
        history.order[ORDER.order] = 0
        return False
    for i in range(slope.shape[0]):
        slope[i] *= control[CONTROL.step]
    return True


@kernel
def change_step(ratio, history):
    """Turn the differences into those of the same polynomial at steps ``ratio`` times as long."""
    order, differences, weights, resized = history.order[ORDER.order], history.differences, history.weights, history.resized
    history.order[ORDER.equal_steps] = 0
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
def fit_bdf_step(limit, maximum_step, stop, history):
    """Set the step to attempt, within its limits and ending evenly at ``stop``, and bring the differences to its spacing."""
    control = history.control
    wanted = control[CONTROL.next_step]
    if wanted > limit:
        wanted = _BELOW_LIMIT * limit
    wanted = min(wanted, maximum_step)
    control[CONTROL.next_step] = wanted
    left = stop - control[CONTROL.time]
    # The last two steps share what is left evenly.
    step = left if wanted >= left * (1.0 - 1e-9) else (0.5 * left if 2.0 * wanted > left else wanted)
    if step != control[CONTROL.step]:
        change_step(step / control[CONTROL.step], history)
        control[CONTROL.step] = step


@kernel
def predict_by_history(history):
    """Write the state predicted one step on, a correction of 0, and what the formula knows; return h over its leading coefficient.

    The formula, sum of D_m/m over 1 to k at the new time = h f, reads correction = shift f - known with the new state as
    prediction plus correction.
    """
    order, differences = history.order[ORDER.order], history.differences
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
    return history.control[CONTROL.step] / leading


@template
def bdf_attempt(rhs, rhs_and_jacobian, predict, factor, solve, error_norm, t, y, h, model, work, history, counts):
    """Solve the formula of the order at hand for the state one step on; see `bearing_sim.numerics.time_stepping.advance_adaptively`."""
    rate, result, change, correction, known = (
        history.scratch[0], history.scratch[1], history.scratch[2], history.scratch[3], history.scratch[4],
    )  # fmt: skip
    shift = predict_by_history(history)
    return solve_implicit(
        rhs, rhs_and_jacobian, factor, solve, error_norm, True,
        t + h, known, shift, _ENOUGH * (history.order[ORDER.order] + 1.0), result, correction, rate, change, history.newton, model, work, counts,
    )  # fmt: skip


@template
def bdf_error(error_norm, y, model, history):
    """Return the error of the step attempted over what the tolerances allow: correction/(k + 1) (Shampine and Reichelt 1997)."""
    after = history.control[CONTROL.time] + history.control[CONTROL.step]
    return error_norm(after, history.scratch[1], history.scratch[3], model) / (history.order[ORDER.order] + 1.0)


@kernel
def take_into_differences(stop, history):
    """Take the corrected step into the differences; the time becomes exactly ``stop`` where the step ends there."""
    order, differences, correction, control = history.order[ORDER.order], history.differences, history.scratch[3], history.control
    for i in range(correction.shape[0]):
        differences[order + 2, i] = correction[i] - differences[order + 1, i]
        differences[order + 1, i] = correction[i]
    for m in range(order, -1, -1):
        for i in range(correction.shape[0]):
            differences[m, i] += differences[m + 1, i]
    control[CONTROL.time] += control[CONTROL.step]
    if abs(stop - control[CONTROL.time]) <= 1e-6 * control[CONTROL.step]:
        control[CONTROL.time] = stop
    control[CONTROL.next_step] = min(control[CONTROL.next_step], _AFTER_SHORT_STEP * control[CONTROL.step])
    history.order[ORDER.equal_steps] += 1


@template
def accept_bdf_step(error_norm, error, stop, y, model, history):
    """Take the step into the history, and choose order and step after as many equal steps as the differences need."""
    take_into_differences(stop, history)
    history.order[ORDER.failures] = 0
    order = history.order[ORDER.order]
    if history.order[ORDER.equal_steps] > order:
        control, differences = history.control, history.differences
        time, best = control[CONTROL.time], order
        growth = 1.0 / (_SAME * error ** (1.0 / (order + 1.0)) + 1e-10)
        if order > 1:
            lower = error_norm(time, differences[0], differences[order], model) / order
            candidate = 1.0 / (_LOWER * lower ** (1.0 / order) + 1e-10)
            if candidate > growth:
                growth, best = candidate, order - 1
        if order < HIGHEST_ORDER:
            higher = error_norm(time, differences[0], differences[order + 2], model) / (order + 2.0)
            candidate = 1.0 / (_HIGHER * higher ** (1.0 / (order + 2.0)) + 1e-10)
            if candidate > growth:
                growth, best = candidate, order + 1
        growth = min(growth, _LARGEST_GROWTH)
        if growth >= _WORTH_CHANGING:
            history.order[ORDER.order], history.order[ORDER.equal_steps] = best, 0
            control[CONTROL.next_step] = control[CONTROL.step] * growth


@template
def reject_bdf_step(rhs, error_norm, outcome, error, y, model, work, history, counts):
    """Choose a shorter step, and a lower order where that one had erred less; start a new history after several failures."""
    control, order, correction, change = history.control, history.order[ORDER.order], history.scratch[3], history.scratch[2]
    history.order[ORDER.failures] += 1
    failures = history.order[ORDER.failures]
    history.order[ORDER.equal_steps] = 0
    if math.isfinite(error):
        shrink = 1.0 / (_SAME * error ** (1.0 / (order + 1.0)))
        if order > 1:
            for i in range(change.shape[0]):
                change[i] = history.differences[order, i] + correction[i]
            lower = error_norm(control[CONTROL.time], history.differences[0], change, model) / order
            candidate = 1.0 / (_LOWER * lower ** (1.0 / order) + 1e-10)
            if candidate > shrink:
                shrink, history.order[ORDER.order] = candidate, order - 1
        shrink = max(_LARGEST_SHRINK, min(shrink, _SHRINK_FIRST if failures < 2 else _SHRINK_LATER))
        control[CONTROL.next_step] = max(control[CONTROL.step] * shrink, SMALLEST_STEP)
    else:
        history.newton[NEWTON.shift] = 0.0
        control[CONTROL.next_step] = control[CONTROL.step] * (_SHRINK_UNSOLVED if outcome == NOT_CONVERGED else _SHRINK_NON_FINITE)
    if failures > _TRUSTED_FAILURES:
        # A secant of the past would leave an error that falls with the step only, not with its square.
        return start_along_tangent(rhs, model, work, history, counts)
    return True


@kernel
def interpolate(t, history, y):
    """Write the state at ``t``, not later than the newest, into ``y`` and into the history as the state that the call returned."""
    control, differences = history.control, history.differences
    position, weight = (t - control[CONTROL.time]) / control[CONTROL.step], 1.0
    for i in range(y.shape[0]):
        y[i] = differences[0, i]
    for j in range(1, history.order[ORDER.order] + 1):
        weight *= (position + j - 1.0) / j
        for i in range(y.shape[0]):
            y[i] += weight * differences[j, i]
    for i in range(y.shape[0]):
        history.state[i] = y[i]
    history.returned[0] = t


@template
def bdf(
    rhs, rhs_and_jacobian, predict, factor, solve, error_norm, step_limit, step_taken,
    t, end, stop, y, h, maximum_step, budget, model, work, history, counts,
):  # fmt: skip
    """Advance ``y`` in place from ``t`` to ``end``.

    Parameters and results as of `bearing_sim.numerics.time_stepping.advance_adaptively`; ``predict`` is not used, and ``h`` is the
    first step where no history leads to this time and state [s].
    """
    if not resume(t, y, h, maximum_step, history):
        if not start_along_tangent(rhs, model, work, history, counts):
            return NOT_EVALUATED, h
    status, h = advance_adaptively(
        fit_bdf_step, bdf_attempt, bdf_error, accept_bdf_step, reject_bdf_step,
        rhs, rhs_and_jacobian, start_from_known, factor, solve, error_norm, step_limit, step_taken,
        end, stop, history.differences[0], maximum_step, budget, model, work, history, counts,
    )  # fmt: skip
    if status == OK:
        interpolate(end, history, y)
    elif status != STEP_BUDGET:
        history.order[ORDER.order] = 0
    return status, h
