# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Explicit Runge-Kutta method of order 5 with an embedded one of order 4, as a drive loop.

J. R. Dormand, P. J. Prince: A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980), RK5(4)7M.  Its last stage
is the first of the next step.  The step-size rule remembers the last error, which keeps steps even where stability bounds them:
E. Hairer, G. Wanner: Solving Ordinary Differential Equations II, 2nd ed. (1996), section IV.2.
"""

import math

import numpy as np

from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_EVALUATED, OK, SMALLEST_STEP, STEP_BUDGET
from bearing_sim.kernels.compilation import kernel, template

_SAFETY, _LARGEST_GROWTH, _LARGEST_SHRINK, _MEMORY = 0.9, 5.0, 0.2, 0.04
_STAGES = 7

# the tableau of the 1980 paper; the last row is the result of order 5
_NODES = np.array([0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_WEIGHTS = np.array(
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        [1 / 5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [3 / 40, 9 / 40, 0.0, 0.0, 0.0, 0.0],
        [44 / 45, -56 / 15, 32 / 9, 0.0, 0.0, 0.0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0.0, 0.0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0.0],
        [35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
# order 5 less order 4
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@kernel
def _combine(y, h, weights, terms, stages, result):
    """Write y + h sum of the first ``terms`` weighted stages into ``result``."""
    for i in range(y.shape[0]):
        result[i] = y[i]
    for stage in range(terms):
        weight = h * weights[stage]
        if weight != 0.0:
            for i in range(y.shape[0]):
                result[i] += weight * stages[stage, i]


@template
def rk45_step(rhs, t, y, h, model, work, stages, next_y, error, counts):
    """Take one step from (t, y); write the result and its error estimate.

    Parameters
    ----------
    rhs : kernel of the level.
    h : step [s].
    stages : shape (7, n); the first holds dy/dt at (t, y), the last takes dy/dt at the result.
    next_y, error : results, shape (n,); the error is the difference to the embedded method of order 4.
    counts : work done; added to.

    Returns
    -------
    evaluated : False where the right-hand side was not.
    """
    for stage in range(1, _STAGES):
        _combine(y, h, _WEIGHTS[stage], stage, stages, next_y)
        counts[COUNT.right_hand_sides] += 1
        if not rhs(t + _NODES[stage] * h, next_y, model, work, stages[stage]):
            return False
    error[:] = 0.0
    _combine(error, h, _ERROR, _STAGES, stages, error)
    return True


@template
def rk45(rhs, error_norm, step_limit, accepted, t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts):
    """Advance ``y`` in place from ``t`` to ``end``.

    Parameters and results as in `bearing_sim.integrators.drive.drive`, but for the kernels, of which there is no Jacobian, and
    ``scratch``, shape (9, n).
    """
    stages, next_y, error = scratch[:_STAGES], scratch[_STAGES], scratch[_STAGES + 1]
    if t < end:
        counts[COUNT.right_hand_sides] += 1
        if not rhs(t, y, model, work, stages[0]):
            return NOT_EVALUATED, h
    before, rejected = 1e-4, False
    while t < end:
        if budget <= 0:
            return STEP_BUDGET, h
        budget -= 1
        wanted = min(h, maximum_step, step_limit(t, y, model))
        left = end - t
        # the last two steps share what is left evenly, as in `bearing_sim.integrators.drive`
        this = left if wanted >= left else (0.5 * left if wanted > 0.5 * left else wanted)
        evaluated = rk45_step(rhs, t, y, this, model, work, stages, next_y, error, counts)
        share = error_norm(t, y, error, tolerance, model) if evaluated else math.inf
        finite = math.isfinite(share)
        if share <= 1.0 or (finite and this <= SMALLEST_STEP):
            counts[COUNT.steps] += 1
            if share > 1.0:
                counts[COUNT.smallest_steps] += 1
            growth = _SAFETY * (share + 1e-10) ** (0.75 * _MEMORY - 0.2) * before**_MEMORY
            growth = max(_LARGEST_SHRINK, min(1.0 if rejected else _LARGEST_GROWTH, growth))
            before, rejected = max(share, 1e-4), False
            for i in range(y.shape[0]):
                y[i] = next_y[i]
                stages[0, i] = stages[_STAGES - 1, i]
            t = end if this == left else t + this
            accepted(this, y, model, work)
            h = max(this * growth, h) if this < wanted else max(wanted * growth, SMALLEST_STEP)
            continue
        counts[COUNT.rejected_steps] += 1
        rejected = True
        if not finite and evaluated:
            counts[COUNT.non_finite_steps] += 1
        shrink = max(_LARGEST_SHRINK, _SAFETY * share**-0.2) if finite else 0.1
        h = max(this * shrink, SMALLEST_STEP) if finite else this * shrink
        if h < SMALLEST_STEP:
            return NON_FINITE if evaluated else NOT_EVALUATED, h
    return OK, h
