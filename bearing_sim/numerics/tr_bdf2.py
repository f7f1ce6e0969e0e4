# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""TR-BDF2, two implicit stages with a Newton iteration in each, continued with a result of order 3.

R. E. Bank, W. M. Coughran, W. Fichtner, E. H. Grosse, D. J. Rose, R. K. Smith: Transient simulation of silicon devices and circuits, IEEE Trans.
Computer-Aided Design 4 (1985) 436; as a Runge-Kutta method M. E. Hosea, L. F. Shampine: Analysis and implementation of TR-BDF2, Appl. Numer.
Math. 20 (1996) 21:

    Y_1 = y + d h (f(y) + f(Y_1))  at t + 2 d h,    Y_2 = y + w h (f(y) + f(Y_1)) + d h f(Y_2)  at t + h,
    d = 1 - 1/sqrt 2,    w = sqrt 2 / 4.

Y_2 is of order 2, L-stable and stiffly accurate.  The stages are solved, where a linearly implicit method takes one iteration for the
solution: this is what carries a step over contacts that open or close within it.

The difference to the embedded result of order 3,

    e = h ((1 - 4 w)/3 f(y) + 1/3 f(Y_1) - 2 d/3 f(Y_2)),

is the error of Y_2.  Added as it is, it would destroy the stability.  Filtered by F = (I - d h J)^-1 it does not:

    y_new = Y_2 + F^2 ((1 + b) I - b F) e

is of order 3 for every b, and L-stable; |R(z)| <= 1 in the left half plane up to b = 0.88.  At b = 0.896 the error of order 4 of a linear
system vanishes, so that an oscillation keeps its amplitude; 0.85 leaves a twentieth of that at b = 0, as damping.
"""

import math

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.newton import solve_implicit
from bearing_sim.numerics.time_stepping import COUNT, INNER_STAGE, NOT_EVALUATED, OK

_GAMMA = 1.0 - 1.0 / math.sqrt(2.0)  # d
WEIGHT = math.sqrt(2.0) / 4.0  # w
_FILTER = 0.85  # b (assumption)
ERROR_ORDER = 3.0  # the error estimate goes with this power of the step
_WHOLE = 0.5  # of the tolerances: up to here e is added as a whole (assumption)
_EMBEDDED = ((1.0 - 4.0 * WEIGHT) / 3.0, 1.0 / 3.0, -2.0 * _GAMMA / 3.0)
_ENOUGH = 1 / 60  # of the tolerances: the error that the iteration of a stage may leave (assumption)


@kernel
def tr_bdf2_attempt(kernels, t, y, h, model, work, memory, counts):
    """Compute one step of ``h`` [s] from (t, y); see `bearing_sim.numerics.time_stepping`.

    The error estimate is F e, so that stiff components do not dominate it (L. F. Shampine, L. S. Baca: Error estimators for stiff differential
    equations, J. Comput. Appl. Math. 11, 1984).  Rows 7 and 8 of ``memory.scratch`` keep the slopes at the beginning and at the end of a step;
    where ``memory.derivative_time`` is NaN, as after a change of the inputs, the slope at the beginning is evaluated.  Row `INNER_STAGE`
    keeps the state Y_1, at ``memory.stage_time``.
    """
    scratch = memory.scratch
    result, error = scratch[1], scratch[2]
    first, known, rate, change, slope, next_slope = scratch[INNER_STAGE], scratch[4], scratch[5], scratch[6], scratch[7], scratch[8]
    shift = _GAMMA * h
    per_shift = 1.0 / shift
    if math.isnan(memory.derivative_time[0]):
        counts[COUNT.right_hand_sides] += 1
        if not kernels.rhs(t, y, model, work, slope):
            return NOT_EVALUATED
    elif abs(memory.derivative_time[0] - t) < 0.01 * h:  # not after a rejected step, whose slope at the beginning still stands
        for i in range(y.shape[0]):
            slope[i] = next_slope[i]
    for i in range(y.shape[0]):
        known[i] = y[i] + shift * slope[i]
    for stage in range(2):
        # a loop and not two texts: the kernels are compiled into it, and both copies would not fit the instruction cache
        kernels.predict(known, shift, slope if stage == 0 else error, model, work, result)
        end = t + (h if stage else 2.0 * shift)
        outcome = solve_implicit(kernels, end, known, shift, _ENOUGH, result, rate, change, scratch[0], model, work, counts)
        if outcome != OK:
            return outcome
        if stage == 0:
            for i in range(y.shape[0]):
                first[i] = result[i]
                error[i] = (result[i] - known[i]) * per_shift
                known[i] = y[i] + WEIGHT * h * (slope[i] + error[i])
    by_first, by_inner, by_last = h * _EMBEDDED[0], h * _EMBEDDED[1], h * _EMBEDDED[2]
    for i in range(y.shape[0]):
        next_slope[i] = (result[i] - known[i]) * per_shift
        error[i] = by_first * slope[i] + by_inner * error[i] + by_last * next_slope[i]
    memory.derivative_time[0], memory.stage_time[0] = t + h, t + 2.0 * shift
    _raise_order(kernels, t, per_shift, y, result, error, change, rate, next_slope, model, work)
    return OK


@kernel
def _raise_order(kernels, t, per_shift, y, result, error, change, ahead, slope, model, work):
    """Filter the error of Y_2 and add it to the result, and to the slope what that changes.

    d h J F x = F x - x for any x: with it ``ahead`` becomes d h J (y_new - Y_2), what the addition makes of the state within d h.  Where that is
    more than `_WHOLE` tolerances, a contact has most likely opened: the force that it had at the beginning is in e, but its stiffness is no more
    in F, which would take the force out, so that bodies would be pushed.  The larger such a push, the less of it is taken.

    Parameters
    ----------
    error : e, and F e afterwards.
    change, ahead : scratch, shape (n,).
    """
    filtered = (error, ahead, change)
    for times in range(3):  # a loop and not three texts, as above
        if times > 0:
            for i in range(error.shape[0]):
                filtered[times][i] = filtered[times - 1][i]
        kernels.solve(work, filtered[times])
    for i in range(error.shape[0]):
        twice, thrice = ahead[i], change[i]
        change[i] = (1.0 + _FILTER) * twice - _FILTER * thrice
        ahead[i] = (1.0 + _FILTER) * (twice - error[i]) - _FILTER * (thrice - twice)
    size = kernels.error_norm(t, y, ahead, model)
    part = (_WHOLE / size) ** 2 if size > _WHOLE else 1.0
    for i in range(error.shape[0]):
        result[i] += part * change[i]
        slope[i] += part * ahead[i] * per_shift
