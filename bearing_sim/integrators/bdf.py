# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Backward differentiation formulas of orders 1 to 5 with variable step and order (Gear's method), as a drive loop.

Quasi-constant steps in backward differences: L. F. Shampine, M. W. Reichelt: The MATLAB ODE suite, SIAM J. Sci. Comput. 18
(1997), section 2, with their kappa = 0, that is the formulas of C. W. Gear (1971) themselves.  The iteration keeps its matrix
and scales its corrections as in A. C. Hindmarsh et al.: SUNDIALS, ACM Trans. Math. Softw. 31 (2005), section 2.1; the
idea is that of G. D. Byrne, A. C. Hindmarsh, ACM Trans. Math. Softw. 1 (1975).

Steps go past the end of an interval, whose state is read from the interpolating polynomial, but never past `stop`: what drives
the system from outside may have a kink there.  The history outlives the call.
"""

import math

from bearing_sim.integrators.history import CONVERGED, FAILED, FIGURE, HIGHEST_ORDER, INFINITE, accept, change_step, interpolate, predict, remember
from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_EVALUATED, OK, SMALLEST_STEP, STEP_BUDGET, STEP_TOO_SMALL
from bearing_sim.kernels.compilation import kernel, template

_ITERATIONS, _DAMPED_ITERATIONS = 6, 30
_STALLED = 0.8  # of the correction before, as in `bearing_sim.integrators.sdirk2.solve_stage`
_ENOUGH = 0.1  # of the error that a step may make: an iteration ends there
_CONTRACTION = 0.4  # slower than this, an iteration wants new derivatives
_SHIFT_CHANGE = 0.3  # relative; further off, the matrix is factored anew with the derivatives at hand
_LOWER, _SAME, _HIGHER = 1.3, 1.2, 1.4  # safety in the step of the order below, at hand and above (Shampine and Reichelt)
_WORTH_CHANGING, _LARGEST_GROWTH, _LARGEST_SHRINK = 1.5, 10.0, 0.2
_DOUBTFUL = 2  # failures in succession that a history outlives
_BELOW_LIMIT = 0.9  # of a limit that wanders; following it would change the step each time


@kernel
def fit_step(limit, maximum_step, stop, history):
    """Bring the spacing of the differences to the step wanted, within its limits and ending evenly at ``stop``."""
    figures = history.figures
    wanted = figures[FIGURE.wanted]
    if wanted > limit:
        wanted = _BELOW_LIMIT * limit
    wanted = min(wanted, maximum_step)
    figures[FIGURE.wanted] = wanted
    left = stop - figures[FIGURE.time]
    # The last two steps share what is left evenly.
    step = left if wanted >= left * (1.0 - 1e-9) else (0.5 * left if 2.0 * wanted > left else wanted)
    if step != figures[FIGURE.step]:
        change_step(step / figures[FIGURE.step], history)
        figures[FIGURE.step] = step


@template
def solve_step(rhs, rhs_and_jacobian, factor, solve, error_norm, tolerance, model, work, history, counts):
    """Solve the formula of the order at hand for the state one step on, by Newton's method with a kept matrix.

    Parameters
    ----------
    rhs, rhs_and_jacobian, factor, solve, error_norm : kernels of the level (see `bearing_sim.integrators.drive`).
    tolerance : relative error allowed in a step.
    history : takes the new state into ``scratch[1]`` and what it differs by from the prediction into ``scratch[3]``.
    counts : work done; added to.

    Returns
    -------
    outcome : CONVERGED, FAILED, INFINITE (something is not finite) or NOT_EVALUATED.
    """
    figures = history.figures
    rate, y, change, correction, known = history.scratch[0], history.scratch[1], history.scratch[2], history.scratch[3], history.scratch[4]
    order, shift = history.order[0], predict(history)
    after, enough = figures[FIGURE.time] + figures[FIGURE.step], _ENOUGH * (order + 1.0)
    before, slow = 0.0, False
    share, calm, patience = 1.0, 0, 1
    for iteration in range(_DAMPED_ITERATIONS):
        if iteration >= _ITERATIONS and patience == 1:
            break
        derive = slow or figures[FIGURE.shift] == 0.0
        counts[COUNT.right_hand_sides] += 1
        if derive:
            figures[FIGURE.shift] = 0.0
            counts[COUNT.jacobians] += 1
            evaluated = rhs_and_jacobian(after, y, model, work, rate)
        else:
            evaluated = rhs(after, y, model, work, rate)
        if not evaluated:
            return NOT_EVALUATED
        if derive or abs(shift / figures[FIGURE.shift] - 1.0) > _SHIFT_CHANGE:
            figures[FIGURE.shift] = 0.0
            counts[COUNT.factorisations] += 1
            if not factor(shift, work):
                return FAILED
            figures[FIGURE.shift], figures[FIGURE.contraction] = shift, 1.0
        for i in range(y.shape[0]):
            change[i] = shift * rate[i] - known[i] - correction[i]
        solve(work, change)
        scale = 2.0 / (1.0 + shift / figures[FIGURE.shift])
        for i in range(y.shape[0]):
            change[i] *= scale
            correction[i] += change[i]
            y[i] += change[i]
        size = error_norm(after, y, change, tolerance, model)
        if not math.isfinite(size):
            return INFINITE
        slow = iteration > 0 and size > _CONTRACTION * before
        if iteration > 0:
            figures[FIGURE.contraction] = max(0.3 * figures[FIGURE.contraction], size / before) if before > 0.0 else 0.0
        if size * min(1.0, figures[FIGURE.contraction]) < enough:
            return CONVERGED
        if iteration > 0 and size > _STALLED * before:  # corrections that go to and fro: part of each
            share, calm, patience = 0.5 * share, 0, 2 * patience
        else:
            calm += 1
            if calm >= patience:
                share, calm = min(2.0 * share, 1.0), 0
        if share < 1.0:
            for i in range(y.shape[0]):
                correction[i] -= (1.0 - share) * change[i]
                y[i] -= (1.0 - share) * change[i]
        before = size
    return FAILED


@template
def choose_step_and_order(error_norm, share, tolerance, model, history):
    """Choose the step wanted and the order after as many equal steps as the differences need.

    Parameters
    ----------
    error_norm : kernel.
    share : of its tolerance that the error of the last step took.
    """
    figures, differences, order = history.figures, history.differences, history.order[0]
    time, best = figures[FIGURE.time], order
    growth = 1.0 / (_SAME * share ** (1.0 / (order + 1.0)) + 1e-10)
    if order > 1:
        lower = error_norm(time, differences[0], differences[order], tolerance, model) / order
        candidate = 1.0 / (_LOWER * lower ** (1.0 / order) + 1e-10)
        if candidate > growth:
            growth, best = candidate, order - 1
    if order < HIGHEST_ORDER:
        higher = error_norm(time, differences[0], differences[order + 2], tolerance, model) / (order + 2.0)
        candidate = 1.0 / (_HIGHER * higher ** (1.0 / (order + 2.0)) + 1e-10)
        if candidate > growth:
            growth, best = candidate, order + 1
    growth = min(growth, _LARGEST_GROWTH)
    if growth >= _WORTH_CHANGING:
        history.order[0], history.order[1] = best, 0
        figures[FIGURE.wanted] = figures[FIGURE.step] * growth


@template
def retreat(error_norm, share, failures, tolerance, model, history):
    """Choose a smaller step, and a lower order where that one had erred less, after a step whose error was too large.

    Parameters
    ----------
    error_norm : kernel.
    share : of its tolerance that the error took.
    failures : how many times in succession.
    """
    figures, order, correction, change = history.figures, history.order[0], history.scratch[3], history.scratch[2]
    shrink = 1.0 / (_SAME * share ** (1.0 / (order + 1.0)))
    if order > 1:
        for i in range(change.shape[0]):
            change[i] = history.differences[order, i] + correction[i]
        lower = error_norm(figures[FIGURE.time], history.differences[0], change, tolerance, model) / order
        candidate = 1.0 / (_LOWER * lower ** (1.0 / order) + 1e-10)
        if candidate > shrink:
            shrink, history.order[0] = candidate, order - 1
    if failures > _DOUBTFUL:
        history.order[0] = 1  # what lies behind is no guide
    history.order[1] = 0
    figures[FIGURE.wanted] = figures[FIGURE.step] * max(_LARGEST_SHRINK, min(shrink, 0.9 if failures < 2 else 0.5))


@template
def bdf(
    rhs, rhs_and_jacobian, factor, solve, error_norm, step_limit, accepted,
    t, end, stop, y, h, tolerance, maximum_step, budget, model, work, history, counts,
):  # fmt: skip
    """Advance ``y`` in place from ``t`` to ``end``.

    Parameters
    ----------
    rhs, rhs_and_jacobian, factor, solve, error_norm, step_limit : kernels of the level (see `bearing_sim.levels.planar`).
    accepted : kernel called after each accepted step, as in `bearing_sim.integrators.drive.drive`.
    stop : time that no step may pass, at least ``end`` [s].
    h : first step where no history leads to this time and state [s].
    tolerance : relative error allowed in a step.
    maximum_step : longest step [s].
    budget : steps allowed, rejected ones included.
    history : see `bearing_sim.integrators.history.History`.
    counts : work done, see `bearing_sim.integrators.status.Count`; added to.

    Returns
    -------
    status : see `bearing_sim.integrators.status`.
    h : step wanted next [s].
    """
    figures = history.figures
    if not remember(t, y, h, maximum_step, history):
        counts[COUNT.right_hand_sides] += 1
        if not rhs(t, y, model, work, history.differences[1]):
            history.order[0] = 0
            return NOT_EVALUATED, h
        for i in range(y.shape[0]):
            history.differences[1, i] *= figures[FIGURE.step]
    failures = 0
    while figures[FIGURE.time] < end:
        if budget <= 0:
            return STEP_BUDGET, figures[FIGURE.wanted]
        budget -= 1
        fit_step(step_limit(figures[FIGURE.time], history.differences[0], model), maximum_step, stop, history)
        outcome = solve_step(rhs, rhs_and_jacobian, factor, solve, error_norm, tolerance, model, work, history, counts)
        share = math.inf
        if outcome == CONVERGED:
            after = figures[FIGURE.time] + figures[FIGURE.step]
            share = error_norm(after, history.scratch[1], history.scratch[3], tolerance, model) / (history.order[0] + 1.0)
        smallest = outcome == CONVERGED and math.isfinite(share) and figures[FIGURE.step] <= SMALLEST_STEP
        if share <= 1.0 or smallest:
            counts[COUNT.steps] += 1
            if share > 1.0:
                counts[COUNT.smallest_steps] += 1
            failures = 0
            accepted(figures[FIGURE.step], history.scratch[1], model, work)
            accept(stop, history)
            if history.order[1] > history.order[0]:
                choose_step_and_order(error_norm, share, tolerance, model, history)
            continue
        counts[COUNT.rejected_steps] += 1
        failures += 1
        if outcome == INFINITE or math.isnan(share):
            counts[COUNT.non_finite_steps] += 1
        if math.isfinite(share):
            retreat(error_norm, share, failures, tolerance, model, history)
        else:
            figures[FIGURE.shift], history.order[1] = 0.0, 0
            figures[FIGURE.wanted] = figures[FIGURE.step] * (0.5 if outcome == FAILED else 0.1)
        if math.isfinite(share):
            figures[FIGURE.wanted] = max(figures[FIGURE.wanted], SMALLEST_STEP)
        if failures > _DOUBTFUL:
            # A secant of the past would leave an error that goes with the step, not with its square: begin anew along the tangent.
            counts[COUNT.right_hand_sides] += 1
            history.order[0], history.order[1] = 1, 0
            if not rhs(figures[FIGURE.time], history.differences[0], model, work, history.differences[1]):
                history.order[0] = 0
                return NOT_EVALUATED, h
            for i in range(y.shape[0]):
                history.differences[1, i] *= figures[FIGURE.step]
        if figures[FIGURE.wanted] < SMALLEST_STEP:
            history.order[0] = 0
            if outcome == NOT_EVALUATED:
                return NOT_EVALUATED, h
            return NON_FINITE if outcome == INFINITE or math.isnan(share) else STEP_TOO_SMALL, h
    interpolate(end, history, y)
    return OK, figures[FIGURE.wanted]
