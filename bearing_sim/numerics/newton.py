# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One damped Newton iteration for the equations of all implicit methods, y = known + shift f(t, y).

What it keeps of its matrix, and how it scales corrections by one that belongs to another step, is as in A. C. Hindmarsh et al.:
SUNDIALS, ACM Trans. Math. Softw. 31 (2005), section 2.1.

The damping is an assumption that contacts and laws of friction made necessary.  Where the corrections alternate across a bend of f,
such as between the two flat ends of a law of traction, half of each is taken, then a quarter and so on, and for longer each time
before a whole correction is tried again: the solution lies in the middle, at the bend.
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import template
from bearing_sim.numerics.time_stepping import COUNT, NON_FINITE, NOT_CONVERGED, NOT_EVALUATED, OK

_ITERATIONS, _DAMPED_ITERATIONS = 12, 40
_STALLED = 0.8  # of the correction before: an iteration that hardly contracts alternates
_SLOW = 0.4  # of the correction before: worse than this, an iteration needs new derivatives
_FAR = 1 / 3  # of the tolerances: after a larger correction, derivatives of the iterate before are outdated
_FRESH_CONTRACTION = 0.1  # assumed of an iteration with derivatives of this very iterate
_SHIFT_CHANGE = 0.3  # relative; beyond it a matrix that is kept is factored again with the derivatives at hand
_LEAST_IMPROVEMENT = 0.3  # to which the estimate of the contraction may fall from one iteration to the next


class Newton(NamedTuple):
    """Where each number of the iteration stands in ``memory.newton``."""

    shift: int = 0  # of the factorisation at hand [s]; 0 where there is none
    contraction: int = 1  # of the iteration, latest estimate


NEWTON = Newton()


@template
def solve_implicit(
    rhs, rhs_and_jacobian, factor, solve, error_norm, multistep,
    t, known, shift, enough, y, correction, rate, change, newton, model, work, counts,
):  # fmt: skip
    """Solve y = known + shift f(t, y) by a damped Newton iteration.

    Parameters
    ----------
    rhs, rhs_and_jacobian, factor, solve, error_norm : kernels of the level, see `bearing_sim.numerics.time_stepping`.
    multistep : compile-time bool.  False for a stage of a one-step method: ``known`` is what the stage builds on, and derivatives
        are those of the iterate where the iteration starts; the guess is so good that one iteration is most often enough with
        them, while those of an earlier stage, with other contacts loaded, leave several to do.  True for a multistep method:
        ``y`` = prediction + ``correction``, ``known`` is correction's share of the formula, correction = shift f - known (its
        digits would be lost in those of y), and the matrix outlives steps.
    known : shape (n,).
    shift : step over the method's leading coefficient [s].
    enough : error that the iteration may leave, over what the tolerances allow in a step.
    y : start of the iteration, and the solution.
    correction : sum of all changes; multistep only.
    rate : takes f(t, y) of the last iterate but one.
    change : scratch, shape (n,).
    newton : see `Newton`; shift 0 forces new derivatives.
    counts : work done, see `bearing_sim.numerics.time_stepping.Count`; added to.

    Returns
    -------
    status : OK, NOT_EVALUATED, NOT_CONVERGED (singular matrices, too) or NON_FINITE.
    """
    before, outdated = math.inf, False
    fraction, calm, patience = 1.0, 0, 1  # of each correction that is taken; corrections since it changed, and until it grows
    for iteration in range(_DAMPED_ITERATIONS):
        if iteration >= _ITERATIONS and patience == 1:
            break
        fresh = outdated or newton[NEWTON.shift] == 0.0
        counts[COUNT.right_hand_sides] += 1
        if fresh:
            newton[NEWTON.shift] = 0.0
            counts[COUNT.jacobians] += 1
            evaluated = rhs_and_jacobian(t, y, model, work, rate)
        else:
            evaluated = rhs(t, y, model, work, rate)
        if not evaluated:
            return NOT_EVALUATED
        if fresh or abs(shift / newton[NEWTON.shift] - 1.0) > _SHIFT_CHANGE:
            newton[NEWTON.shift] = 0.0
            counts[COUNT.factorisations] += 1
            if not factor(shift, work):
                return NOT_CONVERGED
            newton[NEWTON.shift], newton[NEWTON.contraction] = shift, 1.0
        if multistep:
            for i in range(y.shape[0]):
                change[i] = shift * rate[i] - known[i] - correction[i]
            solve(work, change)
            scale = 2.0 / (1.0 + shift / newton[NEWTON.shift])
            for i in range(y.shape[0]):
                change[i] *= scale
                correction[i] += change[i]
                y[i] += change[i]
        else:
            for i in range(y.shape[0]):
                change[i] = known[i] + shift * rate[i] - y[i]
            solve(work, change)
            for i in range(y.shape[0]):
                y[i] += change[i]
        size = error_norm(t, y, change, model)
        if not math.isfinite(size):
            newton[NEWTON.shift] = 0.0
            return NON_FINITE
        outdated = size > _SLOW * before
        if multistep:
            if iteration > 0:
                newton[NEWTON.contraction] = max(_LEAST_IMPROVEMENT * newton[NEWTON.contraction], size / before) if before > 0.0 else 0.0
        else:
            newton[NEWTON.contraction] = _FRESH_CONTRACTION if fresh else 1.0
            outdated = outdated or size > _FAR
        if size * min(1.0, newton[NEWTON.contraction]) < enough:
            return OK
        if size > _STALLED * before:
            fraction, calm, patience = 0.5 * fraction, 0, 2 * patience
        else:
            calm += 1
            if calm >= patience:
                fraction, calm = min(2.0 * fraction, 1.0), 0
        if fraction < 1.0:
            for i in range(y.shape[0]):
                y[i] -= (1.0 - fraction) * change[i]
                if multistep:
                    correction[i] -= (1.0 - fraction) * change[i]
        before = size
    return NOT_CONVERGED
