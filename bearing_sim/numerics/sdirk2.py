# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Two-stage singly diagonally implicit Runge-Kutta method of order 2 with a Newton iteration in each stage.

R. Alexander: Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977), theorem 5:

    Y_1 = y + gamma h f(Y_1),    y_new = y + (1 - gamma) h f(Y_1) + gamma h f(y_new).

L-stable and stiffly accurate with gamma = 1 - 1/sqrt 2.  The stages are solved, where a linearly implicit method takes one
iteration for the solution: this is what carries a step over contacts that open or close within it.
"""

import math

from bearing_sim.numerics.compilation import template
from bearing_sim.numerics.newton import solve_implicit
from bearing_sim.numerics.time_stepping import INNER_STAGE, OK

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
_ENOUGH = 1 / 60  # of the tolerances: the error that the iteration of a stage may leave (assumption)


@template
def sdirk2_attempt(rhs_and_jacobian, predict, factor, solve, correction_norm, restrain, t, y, h, model, work, memory, counts):
    """Compute one step of ``h`` [s] from (t, y); see `bearing_sim.numerics.time_stepping`.

    The error estimate is the difference to the embedded method of order 1, y + h f(Y_1), filtered by the iteration's matrix so that
    stiff components do not dominate it (L. F. Shampine, L. S. Baca: Error estimators for stiff differential equations, J. Comput.
    Appl. Math. 11, 1984).  Row 8 of ``memory.scratch`` keeps the slope at the end of a step for the next one to predict with, row
    `INNER_STAGE` the state Y_1, at ``memory.stage_time``.
    """
    scratch = memory.scratch
    result, error = scratch[1], scratch[2]
    first, known, rate, change, slope, next_slope = scratch[INNER_STAGE], scratch[4], scratch[5], scratch[6], scratch[7], scratch[8]
    shift = GAMMA * h
    per_shift = 1.0 / shift
    if abs(memory.derivative_time[0] - t) < 0.01 * h:
        for i in range(y.shape[0]):
            slope[i] = next_slope[i]
    for i in range(y.shape[0]):
        known[i] = y[i]
    for stage in range(2):
        # a loop and not two texts: the kernels are compiled into it, and both copies would not fit the instruction cache
        predict(known, shift, slope if stage == 0 else error, model, work, result)
        outcome = solve_implicit(
            rhs_and_jacobian, factor, solve, correction_norm, restrain,
            t + (h if stage else shift), known, shift, _ENOUGH, result, rate, change, model, work, counts,
        )  # fmt: skip
        if outcome != OK:
            return outcome
        if stage == 0:
            for i in range(y.shape[0]):
                first[i] = result[i]
                error[i] = (result[i] - y[i]) * per_shift
                known[i] = y[i] + (1.0 - GAMMA) * h * error[i]
    for i in range(y.shape[0]):
        next_slope[i] = (result[i] - known[i]) * per_shift
        error[i] = shift * (next_slope[i] - error[i])
    memory.derivative_time[0], memory.stage_time[0] = t + h, t + shift
    solve(work, error)
    return OK
