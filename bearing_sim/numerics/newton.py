# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One damped Newton iteration for the equations of implicit methods, y = known + shift f(t, y).

**Damping.** Contacts and laws of friction bend f, and corrections may lead to and fro across a bend.  Where a correction turns back the one before,
half of the next is taken, and a quarter and so on: the solution lies in between, at the bend, so that an iteration that turns back is at its end
when what it has moved by is small enough, however large the correction is there.  Where corrections point the same way, more is taken again.
Several bends may be crossed in turn: then corrections do not turn back from one to the next, but are as large as two iterations before, and half
of them is taken, too.
Where a level knows the bend, it restrains its own part of a correction instead, as programs for circuits limit the voltage of each junction
(L. W. Nagel: SPICE2, Memorandum ERL-M520, Univ. of California, Berkeley 1975).  The numbers are assumptions.
"""

import math

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.time_stepping import COUNT, NON_FINITE, NOT_CONVERGED, NOT_EVALUATED, OK

_ITERATIONS, _DAMPED_ITERATIONS = 12, 40
_STALLED = 0.8  # of the correction two iterations before
_TURNS_BACK, _GOES_ON = 0.6, 1.5  # of the size of a correction: that of the sum of it and the one before
_SHRINKS = 0.5  # of the correction before: with it more of a correction is taken again
_LEAST = 1.0 / 64.0  # part of a correction
_CONTRACTION, _SLOWEST = 0.1, 0.9  # of an iteration: assumed of the first, and at least and at most of the others


@kernel
def solve_implicit(kernels, t, known, shift, enough, y, rate, change, previous, model, work, counts):
    """Solve y = known + shift f(t, y) by a damped Newton iteration.

    It ends when the corrections still to come, a geometric series with the ratio of the last two, are small enough together.

    Parameters
    ----------
    kernels : of the level, see `bearing_sim.numerics.time_stepping`.
    known : what the stage builds on, shape (n,).
    shift : step over the method's leading coefficient [s].
    enough : error that the iteration may leave, over what the tolerances allow in a step.
    y : start of the iteration, and the solution.
    rate, change, previous : scratch, shape (n,).
    counts : work done, see `bearing_sim.numerics.time_stepping.Count`; added to.

    Returns
    -------
    status : OK, NOT_EVALUATED, NOT_CONVERGED (singular matrices, too) or NON_FINITE.
    """
    # Derivatives are those of each iterate: the guess is so good that one iteration is most often enough with them, while those of an
    # earlier iterate or stage, with other contacts loaded, leave several to do.
    whole, before, earlier, fraction = math.inf, math.inf, math.inf, 1.0  # sizes of the last corrections, the first unrestrained
    for iteration in range(_DAMPED_ITERATIONS):
        if iteration >= _ITERATIONS and fraction == 1.0:
            break
        counts[COUNT.right_hand_sides] += 1
        counts[COUNT.jacobians] += 1
        if not kernels.rhs_and_jacobian(t, y, model, work, rate):
            return NOT_EVALUATED
        counts[COUNT.factorisations] += 1
        if not kernels.factor(shift, work):
            return NOT_CONVERGED
        for i in range(y.shape[0]):
            change[i] = known[i] + shift * rate[i] - y[i]
        kernels.solve(work, change)
        for i in range(y.shape[0]):
            y[i] += change[i]
        size = kernels.correction_norm(t, y, change, model)
        if not math.isfinite(size):
            return NON_FINITE
        ratio, whole = min(max(size / whole, _CONTRACTION), _SLOWEST), size
        if size * ratio < enough * (1.0 - ratio):
            return OK
        kernels.restrain(y, change, model, work)
        size, sum_with_previous = kernels.correction_norm(t, y, change, model), math.inf
        if iteration > 0:
            for i in range(y.shape[0]):
                previous[i] += change[i]
            sum_with_previous = kernels.correction_norm(t, y, previous, model)
        turns_back, goes_on = sum_with_previous < _TURNS_BACK * size, sum_with_previous > _GOES_ON * size
        if turns_back and fraction * before < enough:
            for i in range(y.shape[0]):
                y[i] -= change[i]
            return OK
        if turns_back or (size > _STALLED * earlier and not goes_on):
            fraction = max(0.5 * fraction, _LEAST)
        elif goes_on or size < _SHRINKS * before:
            fraction = min(2.0 * fraction, 1.0)
        for i in range(y.shape[0]):
            y[i] -= (1.0 - fraction) * change[i]
            previous[i] = change[i]
        earlier, before = before, size
    return NOT_CONVERGED
