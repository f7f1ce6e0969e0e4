# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One damped Newton iteration for the equations of implicit methods, y = known + shift f(t, y).

The damping is an assumption that contacts and laws of friction made necessary.  Where the corrections alternate across a bend of f,
half of one is taken; if they alternate again, a quarter and so on, and for longer each time before a whole correction is tried again: the
solution lies in the middle, at the bend.  Where a level knows the bend, it restrains its own part of a correction instead, as programs for
circuits limit the voltage of each junction (L. W. Nagel: SPICE2, Memorandum ERL-M520, Univ. of California, Berkeley 1975).
"""

import math

from bearing_sim.numerics.compilation import template
from bearing_sim.numerics.time_stepping import COUNT, NON_FINITE, NOT_CONVERGED, NOT_EVALUATED, OK

_ITERATIONS, _DAMPED_ITERATIONS = 12, 40
_STALLED = 0.8  # of the correction before: an iteration that hardly contracts alternates
_CONTRACTION = 0.1  # assumed of an iteration


@template
def solve_implicit(
    rhs_and_jacobian, factor, solve, correction_norm, restrain,
    t, known, shift, enough, y, rate, change, model, work, counts,
):  # fmt: skip
    """Solve y = known + shift f(t, y) by a damped Newton iteration.

    Parameters
    ----------
    rhs_and_jacobian, factor, solve, correction_norm, restrain : kernels of the level, see `bearing_sim.numerics.time_stepping`.
    known : what the stage builds on, shape (n,).
    shift : step over the method's leading coefficient [s].
    enough : error that the iteration may leave, over what the tolerances allow in a step.
    y : start of the iteration, and the solution.
    rate : takes f(t, y) of the last iterate but one.
    change : scratch, shape (n,).
    counts : work done, see `bearing_sim.numerics.time_stepping.Count`; added to.

    Returns
    -------
    status : OK, NOT_EVALUATED, NOT_CONVERGED (singular matrices, too) or NON_FINITE.
    """
    # Derivatives are those of each iterate: the guess is so good that one iteration is most often enough with them, while those of an
    # earlier iterate or stage, with other contacts loaded, leave several to do.
    before = math.inf
    fraction, calm, patience = 1.0, 0, 0  # of each correction that is taken; corrections since it changed, and until it grows
    for iteration in range(_DAMPED_ITERATIONS):
        if iteration >= _ITERATIONS and patience == 0:
            break
        counts[COUNT.right_hand_sides] += 1
        counts[COUNT.jacobians] += 1
        if not rhs_and_jacobian(t, y, model, work, rate):
            return NOT_EVALUATED
        counts[COUNT.factorisations] += 1
        if not factor(shift, work):
            return NOT_CONVERGED
        for i in range(y.shape[0]):
            change[i] = known[i] + shift * rate[i] - y[i]
        solve(work, change)
        for i in range(y.shape[0]):
            y[i] += change[i]
        size = correction_norm(t, y, change, model)
        if not math.isfinite(size):
            return NON_FINITE
        if size * _CONTRACTION < enough:
            return OK
        restrain(y, change, model, work)
        if size > _STALLED * before:
            fraction, calm, patience = 0.5 * fraction, 0, max(2 * patience, 1)
        else:
            calm += 1
            if calm >= patience:
                fraction, calm = min(2.0 * fraction, 1.0), 0
        if fraction < 1.0:
            for i in range(y.shape[0]):
                y[i] -= (1.0 - fraction) * change[i]
        before = size
    return NOT_CONVERGED
