# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The stiff method and the drive loop on problems with closed forms; they know no bearings."""

import math

import numpy as np
import pytest
from one_equation import factor, failing, kept, no_limit, norm, nothing, solve, stay

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.rosenbrock2 import rosenbrock2_step
from bearing_sim.integrators.sdirk2 import sdirk2_step
from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_EVALUATED, OK, STEP_BUDGET, new_counts
from bearing_sim.kernels.compilation import kernel

# work: [jacobian, factored]; model: (stiffness, share of the Jacobian that the method is told)


@kernel
def rate_of(t, y, model, work, rate):
    # Prothero and Robinson 1974: y' = -k (y - cos t) - sin t, solution cos t for any k
    rate[0] = -model[0] * (y[0] - math.cos(t)) - math.sin(t)
    return True


@kernel
def rate_and_jacobian(t, y, model, work, rate):
    work[0] = -model[0] * model[1]
    return rate_of(t, y, model, work, rate)


@kernel
def nan_rate(t, y, model, work, rate):
    rate[0] = math.nan
    work[0] = 0.0
    return True


@kernel
def step(t, y, rate, h, model, work, stages, next_y, error):
    return rosenbrock2_step(rate_of, factor, solve, t, y, rate, h, model, work, stages, next_y, error)


@kernel
def nan_step(t, y, rate, h, model, work, stages, next_y, error):
    return rosenbrock2_step(nan_rate, factor, solve, t, y, rate, h, model, work, stages, next_y, error)


@kernel
def implicit_step(t, y, rate, h, model, work, stages, next_y, error):
    # the counts of iterations go where no stage stands
    return sdirk2_step(rate_of, rate_and_jacobian, stay, factor, solve, norm, t, y, h, 1e-9, model, work, stages, next_y, error, work[2:4], work[4:])


@kernel
def advance_implicit(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return drive(nothing, implicit_step, norm, no_limit, kept, 2, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


@kernel
def advance(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return drive(rate_and_jacobian, step, norm, no_limit, kept, 2, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


@kernel
def advance_nan(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return drive(nan_rate, nan_step, norm, no_limit, kept, 2, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


@kernel
def advance_failing(t, end, y, h, tolerance, longest, budget, model, work, scratch, counts):
    return drive(failing, step, norm, no_limit, kept, 2, t, end, y, h, tolerance, longest, budget, model, work, scratch, counts)


def solution(stiffness, steps=0, told=1.0, tolerance=1e9, end=2.0, budget=10**7, run=advance, start=1.0):
    """Return value, status and counts at ``end``; a fixed step where ``steps`` is given."""
    y, counts = np.array([start]), new_counts()
    longest = end / steps if steps else 1e9
    status, _ = run(
        0.0, end, y, longest if steps else 1e-3, tolerance, longest, budget, np.array([stiffness, told]), np.zeros(7), np.zeros((9, 1)), counts
    )
    return y[0], status, counts


@pytest.mark.parametrize("told", [1.0, 0.7, 0.0])
def test_rosenbrock2_is_of_order_2_whatever_jacobian_it_is_told(told):
    errors = [abs(solution(2.0, steps, told)[0] - math.cos(2.0)) for steps in (64, 128, 256)]
    orders = [math.log2(a / b) for a, b in zip(errors, errors[1:])]
    assert orders == pytest.approx([2.0, 2.0], abs=0.2)


def test_stiff_solution_is_followed_at_steps_a_million_times_its_time_constant():
    value, status, counts = solution(1e9, steps=100)
    assert status == OK and counts[COUNT.steps] == 100
    # Of first order here: the method knows no derivative by time, so that a stiff solution lags by a part of the step.
    assert abs(value - math.cos(2.0)) < 0.02
    assert abs(solution(1e9, steps=400)[0] - math.cos(2.0)) < 0.005


@pytest.mark.parametrize("stiffness", [2.0, 50.0])
def test_sdirk2_is_of_order_2(stiffness):
    errors = [abs(solution(stiffness, steps, run=advance_implicit)[0] - math.cos(2.0)) for steps in (64, 128, 256)]
    orders = [math.log2(a / b) for a, b in zip(errors, errors[1:])]
    assert orders == pytest.approx([2.0, 2.0], abs=0.25)


def test_sdirk2_follows_a_stiff_solution_without_lagging():
    assert solution(1e9, steps=100, run=advance_implicit)[0] == pytest.approx(math.cos(2.0), abs=1e-8)


def test_sdirk2_lets_a_stiff_transient_die_in_one_long_step():
    assert solution(1e12, steps=1, end=1e-3, start=5.0, run=advance_implicit)[0] == pytest.approx(1.0, abs=1e-5)


def test_a_stiff_transient_dies_in_one_long_step():
    # L-stability: the factor of one step goes to zero with the stiffness
    value, _, _ = solution(1e12, steps=1, end=1e-3, start=5.0)
    assert value == pytest.approx(1.0, abs=1e-2)


def test_error_stays_within_a_few_tolerances_and_work_grows_with_accuracy():
    loose, _, loose_counts = solution(50.0, tolerance=1e-3)
    tight, _, tight_counts = solution(50.0, tolerance=1e-6)
    assert abs(loose - math.cos(2.0)) < 5e-3 and abs(tight - math.cos(2.0)) < 5e-6
    assert tight_counts[COUNT.steps] > 5 * loose_counts[COUNT.steps]


def test_the_last_step_ends_exactly_at_the_end():
    y, counts = np.array([1.0]), new_counts()
    for k in range(10):
        advance(0.1 * k, 0.1 * (k + 1), y, 0.03, 1e9, 0.03, 10**6, np.array([3.0, 1.0]), np.zeros(7), np.zeros((9, 1)), counts)
    assert y[0] == pytest.approx(math.cos(1.0), abs=2e-4)
    assert counts[COUNT.steps] == 40


def test_a_step_budget_bounds_the_work():
    _, status, counts = solution(1.0, steps=1000, budget=17)
    assert status == STEP_BUDGET and counts[COUNT.steps] + counts[COUNT.rejected_steps] == 17


def test_nan_and_kernels_that_fail_end_with_a_status_not_a_hang():
    assert solution(1.0, run=advance_nan)[1] == NON_FINITE
    assert solution(1.0, run=advance_nan)[2][COUNT.non_finite_steps] > 0
    assert solution(1.0, run=advance_failing)[1] == NOT_EVALUATED


def test_a_tolerance_that_cannot_be_met_takes_the_smallest_steps_and_counts_them():
    value, status, counts = solution(1e3, tolerance=1e-30, budget=200)
    assert status == STEP_BUDGET and counts[COUNT.smallest_steps] > 50 and math.isfinite(value)
