# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The explicit method on problems with closed forms and against scipy; it knows no bearings."""

import math

import numpy as np
import pytest
from one_equation import failing, kept, no_limit
from scipy.integrate import solve_ivp

from bearing_sim.integrators.rk45 import rk45
from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_EVALUATED, OK, STEP_BUDGET, new_counts
from bearing_sim.kernels.compilation import kernel


@kernel
def oscillation(t, y, model, work, rate):
    # model: (damping of van der Pol, time from which all is NaN)
    rate[0], rate[1] = y[1], model[0] * (1.0 - y[0] * y[0]) * y[1] - y[0]
    if t > model[1]:
        rate[1] = math.nan
    return True


@kernel
def prothero_robinson(t, y, model, work, rate):
    rate[0], rate[1] = -model[0] * (y[0] - math.cos(t)) - math.sin(t), 0.0
    return True


@kernel
def norm(t, y, change, tolerance, model):
    first, second = abs(change[0]) / tolerance, abs(change[1]) / tolerance
    return second if not second <= first else first


@kernel
def advance(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return rk45(oscillation, norm, no_limit, kept, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


@kernel
def advance_driven(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return rk45(prothero_robinson, norm, no_limit, kept, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


@kernel
def advance_failing(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return rk45(failing, norm, no_limit, kept, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


def solution(run=advance, parameter=0.0, nan_from=math.inf, start=(0.0, 1.0), end=2.0, steps=0, tolerance=1e9, budget=10**7):
    """Return state, status and counts at ``end``; a fixed step where ``steps`` is given."""
    y, counts, longest = np.array(start), new_counts(), end / steps if steps else 1e9
    status, _ = run(
        0.0,
        end,
        y,
        longest if steps else 1e-3,
        tolerance,
        longest,
        budget,
        np.array([parameter, nan_from]),
        np.zeros(1),
        np.zeros((9, 2)),
        counts,
    )
    return y, status, counts


def test_rk45_is_of_order_5_on_an_oscillator():
    exact = (math.sin(2.0), math.cos(2.0))
    errors = [np.abs(solution(steps=steps)[0] - exact).max() for steps in (10, 20, 40)]
    assert [math.log2(a / b) for a, b in zip(errors, errors[1:])] == pytest.approx([5.0, 5.0], abs=0.3)


def test_rk45_is_of_order_5_where_the_rate_depends_on_time():
    # not at t = 2, where the error's leading term happens to vanish
    errors = [abs(solution(advance_driven, 2.0, start=(1.0, 0.0), end=1.5, steps=steps)[0][0] - math.cos(1.5)) for steps in (20, 40, 80)]
    assert [math.log2(a / b) for a, b in zip(errors, errors[1:])] == pytest.approx([5.0, 5.0], abs=0.3)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-8])
def test_error_on_van_der_pol_follows_the_tolerance(tolerance):
    reference = solve_ivp(lambda t, y: (y[1], 2 * (1 - y[0] ** 2) * y[1] - y[0]), (0, 10), (2, 0), method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    y, status, _ = solution(parameter=2.0, start=(2.0, 0.0), end=10.0, tolerance=tolerance)
    assert status == OK and np.abs(y - reference).max() < 30 * tolerance


def test_six_right_hand_sides_a_step_because_the_last_stage_is_the_first_of_the_next():
    counts = solution(steps=50)[2]
    assert counts[COUNT.steps] == 50 and counts[COUNT.right_hand_sides] == 301
    assert counts[COUNT.jacobians] == counts[COUNT.factorisations] == 0


def test_stability_bounds_the_step_on_a_stiff_problem_and_few_steps_are_rejected_there():
    _, status, counts = solution(advance_driven, 1e4, start=(1.0, 0.0), end=1.0, tolerance=1e-4)
    # the real stability interval of the method is 3.3 long
    assert status == OK and 1e4 / 3.6 < counts[COUNT.steps] < 1e4 / 2.8
    assert counts[COUNT.rejected_steps] < 0.1 * counts[COUNT.steps]


def test_a_step_budget_bounds_the_work():
    _, status, counts = solution(steps=1000, budget=17)
    assert status == STEP_BUDGET and counts[COUNT.steps] + counts[COUNT.rejected_steps] == 17


def test_nan_and_kernels_that_fail_end_with_a_status_not_a_hang():
    _, status, counts = solution(nan_from=0.5, tolerance=1e-3)
    assert status == NON_FINITE and counts[COUNT.non_finite_steps] > 0
    assert solution(advance_failing)[1] == NOT_EVALUATED


def test_a_tolerance_that_cannot_be_met_takes_the_smallest_steps_and_counts_them():
    value, status, counts = solution(advance_driven, 1e3, start=(5.0, 0.0), tolerance=1e-30, budget=200)
    assert status == STEP_BUDGET and counts[COUNT.smallest_steps] > 50 and np.isfinite(value).all()
