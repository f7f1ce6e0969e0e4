# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A drive loop for hard real time: steps of one length, no error control, a bound on the work of each step."""

import math

from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_CONVERGED, NOT_EVALUATED, OK, STEP_BUDGET
from bearing_sim.kernels.compilation import kernel, template

_HALVINGS = 10
_COARSE = 8  # parts of a step up to which a step that was divided stays so to its end


@kernel
def _all_finite(y):
    for i in range(y.shape[0]):
        if not math.isfinite(y[i]):
            return False
    return True


@template
def fixed_step(rhs_and_jacobian, step, accepted, t, end, y, h, budget, model, work, scratch, counts):
    """Advance ``y`` in place from ``t`` to ``end`` in equal steps, as long as may be but not longer than ``h``.

    A step that does not succeed is done in two halves, those again in halves, and so on ten times at most; parts finer than an
    eighth go over to longer ones as soon as they are past the place.  A step in eighths costs eleven attempts, one with an
    impact in it some twenty, and none more than 2^11.

    Parameters
    ----------
    rhs_and_jacobian, step, accepted : kernels, as in `bearing_sim.integrators.drive.drive`.
    h : longest step [s].
    budget : steps allowed, rejected ones included.
    scratch : shape (7, n) or more.
    counts : work done, see `bearing_sim.integrators.status.Count`; added to.

    Returns
    -------
    status : see `bearing_sim.integrators.status`.
    h : as given.
    """
    rate, next_y, error, stages = scratch[0], scratch[1], scratch[2], scratch[3:]
    whole = math.ceil((end - t) / h * (1.0 - 1e-9))
    length = (end - t) / max(whole, 1.0)
    if abs(length - h) <= 1e-9 * h:
        length = h  # to the last digit, so that a factorisation still fits the next call
    done, halves, finer = 0, 0, 1  # whole steps done; parts of the next one done, of how many
    fresh = False
    while done < whole:
        if budget <= 0:
            return STEP_BUDGET, h
        budget -= 1
        now, this = t + length * (done + halves / finer), length / finer
        if not fresh:
            counts[COUNT.right_hand_sides] += 1
            counts[COUNT.jacobians] += 1
            if not rhs_and_jacobian(now, y, model, work, rate):
                return NOT_EVALUATED, h
            fresh = True
        succeeded = step(now, y, rate, this, model, work, stages, next_y, error)
        counts[COUNT.right_hand_sides] += 1
        counts[COUNT.factorisations] += 1
        finite = succeeded and _all_finite(next_y)
        if finite:
            counts[COUNT.steps] += 1
            for i in range(y.shape[0]):
                y[i] = next_y[i]
            accepted(this, y, model, work)
            fresh = False
            halves += 1
            while finer > _COARSE and halves % 2 == 0:
                halves, finer = halves // 2, finer // 2
            if halves == finer:
                done, halves, finer = done + 1, 0, 1
            continue
        counts[COUNT.rejected_steps] += 1
        if succeeded:
            counts[COUNT.non_finite_steps] += 1
        if finer == 2**_HALVINGS:
            return NON_FINITE if succeeded else NOT_CONVERGED, h
        halves, finer = 2 * halves, 2 * finer
    return OK, h
