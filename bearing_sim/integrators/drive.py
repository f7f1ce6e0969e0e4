# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The drive loop: accepts or rejects steps, chooses their size, counts work, and always ends.

Knows no bearings and no method: both come in as kernels.
"""

import math

from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_EVALUATED, OK, SMALLEST_STEP, STEP_BUDGET
from bearing_sim.kernels.compilation import template

_BEARABLE = 3.0  # times the tolerance: the estimate is a pessimist, and a repeated step costs as much as a whole one
_GOAL, _GAIN = 0.7, 0.2
_SAFETY, _LARGEST_GROWTH, _LARGEST_SHRINK = 0.85, 4.0, 0.2


@template
def drive(
    rhs_and_jacobian, step, error_norm, step_limit, accepted, order,
    t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts,
):  # fmt: skip
    """Advance ``y`` in place from ``t`` to ``end``.

    Parameters
    ----------
    rhs_and_jacobian, step, error_norm, step_limit : kernels (see `bearing_sim.levels.slip` and `rosenbrock2`).
    accepted : kernel called after each accepted step, ``accepted(h, y, model, work)``.
    order : order of the error estimate plus one, the root in the step-size rule.
    h : step to try first [s].
    tolerance : relative error allowed in a step.
    maximum_step : longest step [s].
    budget : steps allowed, rejected ones included.
    scratch : shape (5, n).
    counts : work done, see `bearing_sim.integrators.status.Count`; added to.

    Returns
    -------
    status : see `bearing_sim.integrators.status`.
    h : step to try next [s].
    """
    rate, next_y, error, stages = scratch[0], scratch[1], scratch[2], scratch[3:]
    size = y.shape[0]
    fresh = False
    while t < end:
        if budget <= 0:
            return STEP_BUDGET, h
        budget -= 1
        if not fresh:
            if not rhs_and_jacobian(t, y, model, work, rate):
                return NOT_EVALUATED, h
            counts[COUNT.right_hand_sides] += 1
            counts[COUNT.jacobians] += 1
            fresh = True
        wanted = min(h, maximum_step, step_limit(t, y, model))
        # The last two steps share what is left evenly: a sliver at the end would cost a step and spoil the next size.
        left = end - t
        this = left if wanted >= left else (0.5 * left if wanted > 0.5 * left else wanted)
        evaluated = step(t, y, rate, this, model, work, stages, next_y, error)
        counts[COUNT.right_hand_sides] += 1
        counts[COUNT.factorisations] += 1
        share = error_norm(t, y, error, tolerance, model) if evaluated else math.inf
        finite = math.isfinite(share)
        if share <= _BEARABLE or (finite and this <= SMALLEST_STEP):
            counts[COUNT.steps] += 1
            if share > _BEARABLE:
                counts[COUNT.smallest_steps] += 1
            for i in range(size):
                y[i] = next_y[i]
            t = end if this == left else t + this
            accepted(this, y, model, work)
            fresh = False
            growth = min(_LARGEST_GROWTH, (_GOAL / (share + 1e-10)) ** (_GAIN / order))
            h = max(this * growth, h) if this < wanted else max(wanted * growth, SMALLEST_STEP)
        else:
            counts[COUNT.rejected_steps] += 1
            if not finite and evaluated:
                counts[COUNT.non_finite_steps] += 1
            shrink = max(_LARGEST_SHRINK, _SAFETY * share ** (-1.0 / order)) if finite else 0.1
            h = max(this * shrink, SMALLEST_STEP) if finite else this * shrink
            if h < SMALLEST_STEP:
                return NON_FINITE if evaluated else NOT_EVALUATED, h
    return OK, h
