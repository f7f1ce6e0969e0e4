"""Two-stage singly diagonally implicit Runge-Kutta method of order 2 with Newton's method in each stage.

R. Alexander: Diagonally implicit Runge-Kutta methods for stiff O.D.E.'s, SIAM J. Numer. Anal. 14 (1977), theorem 5.  L-stable
and stiffly accurate with gamma = 1 - 1/sqrt 2.  Solving the stages, where a linearly implicit method takes them as found, is
what carries a step over contacts that open or close within it.
"""

import math

from bearing_sim.kernels.compilation import template

GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
_ITERATIONS = 12
_CONVERGED = 0.05  # of the error that a step may make
_CONTRACTION = 0.4  # slower than this, an iteration wants new derivatives
_FAR = 100.0  # so far off, old derivatives may belong to other contacts


@template
def solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t, known, shift, tolerance, model, work, y, rate, change, held, counts):
    """Solve y = known + shift f(t, y) by Newton's method.

    Derivatives are the dearest part of an iteration: they are kept from iteration to iteration and from step to step for as
    long as each iteration more than halves what is left.

    Parameters
    ----------
    rhs, rhs_and_jacobian, factor, solve, norm : kernels of the level (see `bearing_sim.integrators.drive`).
    known : what the stage builds on, shape (n,).
    shift : gamma h [s].
    y : start of the iteration, and the stage's result.
    rate : takes f(t, y) of the last but one iterate.
    change : scratch, shape (n,).
    held : the shift of the factorisation at hand, 0 where there is none, shape (1,).
    counts : int64 array; [0] right-hand sides, [1] Jacobians.

    Returns
    -------
    converged : bool
    """
    before, slow = math.inf, False
    for _ in range(_ITERATIONS):
        if slow or held[0] == 0.0:
            evaluated = rhs_and_jacobian(t, y, model, work, rate)
            counts[1] += 1
            held[0] = 0.0
        else:
            evaluated = rhs(t, y, model, work, rate)
        counts[0] += 1
        if not evaluated:
            return False
        if held[0] != shift:
            if not factor(shift, work):
                held[0] = 0.0
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
        if size < _CONVERGED:
            return True
        slow = size > _CONTRACTION * before or size > _FAR
        before = size
    held[0] = 0.0
    return False


@template
def sdirk2_step(rhs, rhs_and_jacobian, predict, factor, solve, norm, t, y, h, tolerance, model, work, stages, next_y, error, held, counts):
    """Take one step from (t, y); write the result and its error estimate.

    Parameters
    ----------
    rhs, rhs_and_jacobian, predict, factor, solve, norm : kernels of the level; ``predict(y, h, model, guess)`` writes where the
        state will be after h, roughly.
    h : step [s].
    stages : scratch, shape (4, n).
    next_y, error : results, shape (n,); the error is the difference to the embedded method of order 1, filtered by the
        iteration matrix so that stiff components do not dominate it (Shampine and Baca 1984).
    held, counts : see `solve_stage`.

    Returns
    -------
    converged : False where a stage did not.
    """
    first, known, rate, change = stages[0], stages[1], stages[2], stages[3]
    shift = GAMMA * h
    predict(y, shift, model, first)
    if not solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t + shift, y, shift, tolerance, model, work, first, rate, change, held, counts):
        return False
    for i in range(y.shape[0]):
        error[i] = (first[i] - y[i]) / shift  # the first stage's slope
        known[i] = y[i] + (1.0 - GAMMA) * h * error[i]
    predict(first, h - shift, model, next_y)
    if not solve_stage(rhs, rhs_and_jacobian, factor, solve, norm, t + h, known, shift, tolerance, model, work, next_y, rate, change, held, counts):
        return False
    for i in range(y.shape[0]):
        error[i] = next_y[i] - known[i] - shift * error[i]
    solve(work, error)
    return True
