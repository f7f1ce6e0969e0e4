# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The loop around a time-stepping method, with error control or with a fixed step.

It knows no bearing and no method.  A level comes in as `Kernels`.  The method comes in as a kernel ``attempt``, ``(kernels, t, y, h, model, work,
memory, counts)``, such as `bearing_sim.numerics.tr_bdf2.tr_bdf2_attempt`: it computes a step of ``h`` [s] from (t, y), leaves the result in row 1 of
``memory.scratch`` and the error estimate in row 2, and returns a status.

Compiled code raises nothing: how an advance ended is a value.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel

OK = 0
STEP_BUDGET = 1
NON_FINITE = 2
NOT_EVALUATED = 3
NOT_CONVERGED = 4
NEEDS_POINT = 5  # no end: a level without steps wants an operating point before it goes on

REASONS = {
    STEP_BUDGET: "the step budget was used up before the end of the interval",
    NON_FINITE: "the state stopped being finite",
    NOT_EVALUATED: "the right-hand side could not be evaluated",
    NOT_CONVERGED: "the equations of a step could not be solved, not even for the smallest step",
}


class Kernels(NamedTuple):
    """The compiled functions of a level.

    Attributes
    ----------
    rhs, rhs_and_jacobian : ``(t, y, model, work, rate)`` write dy/dt into ``rate``, the second also the Jacobian into ``work``;
        return False where they cannot be evaluated.
    predict : ``(known, shift, slope, model, work, guess)`` writes a first guess of the solution of guess = known + shift f(guess),
        given f a little earlier.
    factor : ``(shift, work)`` factors I - shift J; returns False where it is singular.
    solve : ``(work, x)`` replaces the right side by the solution with the last factorisation.
    error_norm : ``(t, y, change, model)`` returns the largest ratio of any state's change to what the tolerances allow it.
    correction_norm : the same of an iteration's correction, in which a level may weigh states otherwise.
    restrain : ``(y, change, model, work)`` limits the correction of an iteration where a contact opens or closes; updates ``y`` and ``change``.
    step_limit : ``(t, y, model, work)`` returns the longest sensible step [s].
    step_taken : ``(t, h, y, model, work)`` is called after each accepted step of length h, which ended at t.
    observe : ``(t, y, model, work, interval, previous, row, memory)`` writes a sample.
    """

    rhs: Callable
    rhs_and_jacobian: Callable
    predict: Callable
    factor: Callable
    solve: Callable
    error_norm: Callable
    correction_norm: Callable
    restrain: Callable
    step_limit: Callable
    step_taken: Callable
    observe: Callable


class Count(NamedTuple):
    """Where each kind of work is counted in an int64 array of shape (len(Count),)."""

    steps: int = 0
    rejected_steps: int = 1
    non_finite_steps: int = 2
    right_hand_sides: int = 3
    jacobians: int = 4
    factorisations: int = 5
    smallest_steps: int = 6  # accepted although their error was too large, because no step is smaller
    unsettled_points: int = 7  # operating points of level steady whose march ended before it had settled


COUNT = Count()
SMALLEST_STEP = 1e-12  # s; a step this small is accepted whatever its error, which is then that of a jump, or round-off


def new_counts() -> np.ndarray:
    """Return zeroed counts."""
    return np.zeros(len(COUNT), np.int64)


class Control(NamedTuple):
    """Where each number of the step-size controller stands in ``memory.control`` [s], or as a count."""

    time: int = 0  # of the newest state
    step: int = 1  # being attempted, or taken last
    allowed: int = 2  # by error and bounds, before the step is fitted to the end of the interval
    next_step: int = 3  # that the error allows
    # of fixed steps
    start: int = 4  # of the interval
    length: int = 5  # of a whole step
    whole: int = 6  # whole steps in the interval
    done: int = 7  # whole steps done
    parts_done: int = 8  # parts done of the present one
    parts: int = 9  # into which it is divided


CONTROL = Control()
INNER_STAGE = 3  # row of ``memory.scratch`` that keeps the state of a step's inner stage, where a method's forces act in it too


class Memory(NamedTuple):
    """What a method writes."""

    scratch: np.ndarray  # rate, result, error and up to six rows of the method's own, shape (9, n); the first is free between calls
    control: np.ndarray  # see `Control`
    derivative_time: np.ndarray  # where the derivatives that the method keeps belong to [s], NaN where it keeps none, shape (1,)
    stage_time: np.ndarray  # of the inner stage of the newest step [s], whose state is row `INNER_STAGE`; NaN where there is none, shape (1,)


def new_memory(size: int) -> Memory:
    """Return memory for ``size`` states."""
    return Memory(np.zeros((9, size)), np.zeros(len(CONTROL)), np.full(1, np.nan), np.full(1, np.nan))


# The step-size rule.  The form is standard (E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed. 1996, section
# IV.8); the numbers are an assumption.  The rule aims at a quarter of the tolerances, because a rejected step costs as much as an
# accepted one, and its growth is damped (_GAIN), because the error of a step with impacts scatters by a factor of ten from one step
# to the next.
_AIM, _GAIN = 0.24, 0.2
_LARGEST_GROWTH, _LARGEST_SHRINK, _SHRINK_UNSOLVED = 4.0, 0.2, 0.3


@kernel
def _fit(limit, maximum_step, end, control):
    """Set the step to attempt; the last two steps before ``end`` share what is left evenly, because a sliver would spoil the next size."""
    allowed = min(control[CONTROL.next_step], maximum_step, limit)
    left = end - control[CONTROL.time]
    control[CONTROL.allowed] = allowed
    control[CONTROL.step] = left if allowed >= left else (0.5 * left if allowed > 0.5 * left else allowed)


@kernel
def _accept(error, order, end, y, result, control):
    """Take the result of the step, and grow or shrink the next one so that its error comes near the aim."""
    step, allowed = control[CONTROL.step], control[CONTROL.allowed]
    for i in range(y.shape[0]):
        y[i] = result[i]
    control[CONTROL.time] = end if step == end - control[CONTROL.time] else control[CONTROL.time] + step
    growth = min(_LARGEST_GROWTH, (_AIM / (error + 1e-10)) ** (_GAIN / order))
    if step < allowed:
        control[CONTROL.next_step] = max(step * growth, control[CONTROL.next_step])
    else:
        control[CONTROL.next_step] = max(allowed * growth, SMALLEST_STEP)


@kernel
def _reject(error, order, control):
    """Shorten the step so that its error comes near the aim, or to three tenths where there is no error to go by."""
    step = control[CONTROL.step]
    if math.isfinite(error):
        control[CONTROL.next_step] = max(step * max(_LARGEST_SHRINK, (_AIM / error) ** (1.0 / order)), SMALLEST_STEP)
    else:
        control[CONTROL.next_step] = step * _SHRINK_UNSOLVED


_HALVINGS = 10
_COARSEST_KEPT = 8  # parts into which a divided step stays divided to its end; finer parts are joined again behind the difficulty


@kernel
def _all_finite(y):
    for i in range(y.shape[0]):
        if not math.isfinite(y[i]):
            return False
    return True


@kernel
def _begin(t, h, end, maximum_step, control):
    """Prepare both ways of stepping over an interval."""
    control[CONTROL.time], control[CONTROL.next_step] = t, h
    whole = math.ceil((end - t) / maximum_step * (1.0 - 1e-9))
    length = (end - t) / max(whole, 1.0)
    if abs(length - maximum_step) <= 1e-9 * maximum_step:
        length = maximum_step  # to the last digit, so that steps do not change from call to call
    control[CONTROL.start], control[CONTROL.length], control[CONTROL.whole] = t, length, whole
    control[CONTROL.done], control[CONTROL.parts_done], control[CONTROL.parts] = 0.0, 0.0, 1.0


@kernel
def _fit_part(control):
    """Set the part of a fixed step to attempt."""
    length, parts = control[CONTROL.length], control[CONTROL.parts]
    control[CONTROL.time] = control[CONTROL.start] + length * (control[CONTROL.done] + control[CONTROL.parts_done] / parts)
    control[CONTROL.step] = length / parts


@kernel
def _accept_part(y, result, control):
    """Take the result of a part of a fixed step, and join parts that are finer than need be."""
    for i in range(y.shape[0]):
        y[i] = result[i]
    parts_done, parts = control[CONTROL.parts_done] + 1.0, control[CONTROL.parts]
    while parts > _COARSEST_KEPT and parts_done % 2.0 == 0.0:
        parts_done, parts = 0.5 * parts_done, 0.5 * parts
    if parts_done == parts:
        control[CONTROL.done] += 1.0
        parts_done, parts = 0.0, 1.0
    control[CONTROL.parts_done], control[CONTROL.parts] = parts_done, parts


@kernel
def advance_in_steps(attempt, error_order, kernels, fixed, t, end, y, h, maximum_step, budget, model, work, memory, counts):
    """Advance ``y`` in place from ``t`` to ``end``, accepting or rejecting each step by its error, or in equal steps.

    Equal steps are for hard real time, and nothing estimates their error.  They are as long as they can be, but not longer than
    ``maximum_step``.  A step that cannot be solved is divided into two halves, those again into halves, and so on ten times at most; parts
    finer than an eighth are joined again as soon as they are past the difficulty.  A step in eighths costs eleven attempts, one with an
    impact in it some twenty, and none more than 2^11.

    Parameters
    ----------
    attempt : the method, see the module's docstring.
    error_order : power of the step with which the error estimate goes, such as `bearing_sim.numerics.tr_bdf2.ERROR_ORDER`.
    kernels : of the level.
    fixed : whether steps are equal.  Both ways share one loop, because most of what there is to compile is the attempt in it.
    t, end : time, and time to reach [s].
    y : newest state, changed in place.
    h : step to try first [s]; fixed steps ignore it.
    maximum_step : longest step [s].
    budget : steps allowed, rejected ones included.
    memory : of the method.
    counts : work done, see `Count`; added to.

    Returns
    -------
    status : OK, or a key of `REASONS`.
    h : step to try next [s].
    """
    control, result = memory.control, memory.scratch[1]
    _begin(t, h, end, maximum_step, control)
    while (control[CONTROL.done] < control[CONTROL.whole]) if fixed else (control[CONTROL.time] < end):
        if budget <= 0:
            return STEP_BUDGET, control[CONTROL.next_step]
        budget -= 1
        if fixed:
            _fit_part(control)
        else:
            _fit(kernels.step_limit(control[CONTROL.time], y, model, work), maximum_step, end, control)
        now, step = control[CONTROL.time], control[CONTROL.step]
        outcome, error = attempt(kernels, now, y, step, model, work, memory, counts), math.inf
        if outcome == OK and fixed:
            error = 0.0 if _all_finite(result) else math.nan
        elif outcome == OK:
            error = kernels.error_norm(now, y, memory.scratch[2], model)
        finite = math.isfinite(error)
        if error <= 1.0 or (finite and step <= SMALLEST_STEP):
            counts[COUNT.steps] += 1
            if error > 1.0:
                counts[COUNT.smallest_steps] += 1
            if fixed:
                _accept_part(y, result, control)
            else:
                _accept(error, error_order, end, y, result, control)
            kernels.step_taken(now + step, step, y, model, work)
            continue
        if outcome == OK and not finite:
            outcome = NON_FINITE
        counts[COUNT.rejected_steps] += 1
        if outcome == NON_FINITE:
            counts[COUNT.non_finite_steps] += 1
        if fixed:
            if control[CONTROL.parts] >= 2.0**_HALVINGS:
                return outcome, control[CONTROL.next_step]
            control[CONTROL.parts_done], control[CONTROL.parts] = 2.0 * control[CONTROL.parts_done], 2.0 * control[CONTROL.parts]
        else:
            _reject(error, error_order, control)
            if control[CONTROL.next_step] < SMALLEST_STEP:
                return outcome if outcome != OK else NON_FINITE, control[CONTROL.next_step]
    return OK, control[CONTROL.next_step]
