# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Two-stage singly diagonally implicit Runge-Kutta method of order 2 with Newton's method in each stage.

R. Alexander: Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977), theorem 5.  L-stable
and stiffly accurate with gamma = 1 - 1/sqrt 2.  Solving the stages, where a linearly implicit method takes them as found, is
what carries a step over contacts that open or close within it.
"""

import math

from bearing_sim.kernels.compilation import template

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
_ITERATIONS, _DAMPED_ITERATIONS = 12, 40
_STALLED = 0.8  # of the correction before: an iteration that hardly contracts goes to and fro
_CONVERGED = 0.05  # of the error that a step may make
_SETTLED = 0.5  # so small a first correction leaves, squared, less than that
_CONTRACTION = 0.4  # slower than this, an iteration wants new derivatives


@template
def solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t, known, shift, tolerance, model, work, y, rate, change, held, counts):
    """Solve y = known + shift f(t, y) by Newton's method.

    Derivatives are taken where the iteration starts: the guess is so good that with them one iteration is most often enough,
    while those of an earlier stage, where other contacts were loaded, leave several to do.  Later iterations keep them for as
    long as each more than halves what is left.  Where corrections go to and fro across a bend of f, such as between both flat
    ends of a law of traction, half of each is taken, then a quarter and so on, and longer each time before
    a whole one is tried again: the middle is where the bend is.

    Parameters
    ----------
    rhs, rhs_and_jacobian, factor, solve, norm : kernels of the level (see `bearing_sim.integrators.drive`).
    known : what the stage builds on, shape (n,).
    shift : gamma h [s].
    y : start of the iteration, and the stage's result.
    rate : takes f(t, y) of the last but one iterate.
    change : scratch, shape (n,).
    held : the shift of the factorisation at hand first, 0 where there is none.
    counts : int64 array: right-hand sides, Jacobians, factorisations.

    Returns
    -------
    converged : bool
    """
    before, outdated = math.inf, True
    share, calm, patience = 1.0, 0, 1
    for iteration in range(_DAMPED_ITERATIONS):
        if iteration >= _ITERATIONS and patience == 1:
            break
        fresh = outdated or held[0] == 0.0
        if fresh:
            evaluated = rhs_and_jacobian(t, y, model, work, rate)
            counts[1] += 1
        else:
            evaluated = rhs(t, y, model, work, rate)
        counts[0] += 1
        if not evaluated:
            return False
        if fresh or held[0] != shift:
            held[0] = 0.0
            counts[2] += 1
            if not factor(shift, work):
                return False
            held[0] = shift
        for i in range(y.shape[0]):
            change[i] = known[i] + shift * rate[i] - y[i]
        solve(work, change)
        for i in range(y.shape[0]):
            y[i] += change[i]
        size = norm(t, y, change, tolerance, model)
        if not math.isfinite(size):
            held[0] = 0.0
            return False
        if size < (_SETTLED if fresh else _CONVERGED):
            return True
        outdated = size > _CONTRACTION * before or size > 1.0
        if size > _STALLED * before:
            share, calm, patience = 0.5 * share, 0, 2 * patience
        else:
            calm += 1
            if calm >= patience:
                share, calm = min(2.0 * share, 1.0), 0
        if share < 1.0:
            for i in range(y.shape[0]):
                y[i] -= (1.0 - share) * change[i]
        before = size
    held[0] = 0.0
    return False


@template
def sdirk2_step(rhs, rhs_and_jacobian, predict, factor, solve, norm, t, y, h, tolerance, model, work, stages, next_y, error, held, counts):
    """Take one step from (t, y); write the result and its error estimate.

    Parameters
    ----------
    rhs, rhs_and_jacobian, predict, factor, solve, norm : kernels of the level; ``predict(known, shift, slope, model, work,
        guess)`` writes a first guess of the solution of guess = known + shift f(guess), given f a little earlier.
    h : step [s].
    stages : shape (6, n); the last two rows keep the slope at the end of a step for the next one.
    next_y, error : results, shape (n,); the error is the difference to the embedded method of order 1, filtered by the
        iteration matrix so that stiff components do not dominate it (Shampine and Baca 1984).
    held : see `solve_stage`, and the time where the last step ended [s], shape (2,).
    counts : see `solve_stage`.

    Returns
    -------
    converged : False where a stage did not.
    """
    first, known, rate, change, slope, next_slope = stages[0], stages[1], stages[2], stages[3], stages[4], stages[5]
    shift = GAMMA * h
    per_shift = 1.0 / shift
    if abs(held[1] - t) < 0.01 * h:
        for i in range(y.shape[0]):
            slope[i] = next_slope[i]
    predict(y, shift, slope, model, work, first)
    if not solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t + shift, y, shift, tolerance, model, work, first, rate, change, held, counts):
        return False
    for i in range(y.shape[0]):
        error[i] = (first[i] - y[i]) * per_shift  # the first stage's slope
        known[i] = y[i] + (1.0 - GAMMA) * h * error[i]
    predict(known, shift, error, model, work, next_y)
    if not solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t + h, known, shift, tolerance, model, work, next_y, rate, change, held, counts):
        return False
    for i in range(y.shape[0]):
        next_slope[i] = (next_y[i] - known[i]) * per_shift
        error[i] = shift * (next_slope[i] - error[i])
    held[1] = t + h
    solve(work, error)
    return True
