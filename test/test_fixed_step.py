# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The drive loop for hard real time: equal steps, a bound on the work of each; it knows no bearings."""

import math

import numpy as np
import pytest
from one_equation import factor, failing, kept, norm, nothing, solve, stay

from bearing_sim.integrators.fixed_step import fixed_step
from bearing_sim.integrators.rosenbrock2 import rosenbrock2_step
from bearing_sim.integrators.sdirk2 import sdirk2_step
from bearing_sim.integrators.status import COUNT, NON_FINITE, NOT_CONVERGED, NOT_EVALUATED, OK, STEP_BUDGET, new_counts
from bearing_sim.kernels.compilation import kernel

# model: (stiffness, time from which all is NaN, longest step that converges); work: jacobian, factored, held shift, counts


@kernel
def rate_of(t, y, model, work, rate):
    # Prothero and Robinson 1974: y' = -k (y - cos t) - sin t, solution cos t for any k
    rate[0] = -model[0] * (y[0] - math.cos(t)) - math.sin(t)
    if t > model[1]:
        rate[0] = math.nan
    return True


@kernel
def rate_and_jacobian(t, y, model, work, rate):
    work[0] = -model[0]
    return rate_of(t, y, model, work, rate)


@kernel
def linear_step(t, y, rate, h, model, work, stages, next_y, error):
    return rosenbrock2_step(rate_of, factor, solve, t, y, rate, h, model, work, stages, next_y, error)


@kernel
def solved_step(t, y, rate, h, model, work, stages, next_y, error):
    return sdirk2_step(rate_of, rate_and_jacobian, stay, factor, solve, norm, t, y, h, 1e-9, model, work, stages, next_y, error, work[2:4], work[4:])


@kernel
def capricious_step(t, y, rate, h, model, work, stages, next_y, error):
    # what contacts do to an iteration: it converges, or not, by the length of the step
    next_y[0] = y[0] + h
    return h <= model[2]


@kernel
def stumbling_step(t, y, rate, h, model, work, stages, next_y, error):
    # an impact: no step across one place converges unless it is short
    next_y[0] = y[0] + h
    return h <= 2.0**-9 or not t <= model[2] < t + h


@kernel
def linear(t, end, y, h, budget, model, work, scratch, counts):
    return fixed_step(rate_and_jacobian, linear_step, kept, t, end, y, h, budget, model, work, scratch, counts)


@kernel
def solved(t, end, y, h, budget, model, work, scratch, counts):
    return fixed_step(nothing, solved_step, kept, t, end, y, h, budget, model, work, scratch, counts)


@kernel
def capricious(t, end, y, h, budget, model, work, scratch, counts):
    return fixed_step(nothing, capricious_step, kept, t, end, y, h, budget, model, work, scratch, counts)


@kernel
def stumbling(t, end, y, h, budget, model, work, scratch, counts):
    return fixed_step(nothing, stumbling_step, kept, t, end, y, h, budget, model, work, scratch, counts)


@kernel
def failed(t, end, y, h, budget, model, work, scratch, counts):
    return fixed_step(failing, linear_step, kept, t, end, y, h, budget, model, work, scratch, counts)


def solution(run, h, stiffness=2.0, nan_from=math.inf, converging=math.inf, end=2.0, budget=10**6, start=1.0):
    """Return value, status and counts at ``end``."""
    y, counts = np.array([start]), new_counts()
    status, again = run(0.0, end, y, h, budget, np.array([stiffness, nan_from, converging]), np.zeros(7), np.zeros((9, 1)), counts)
    assert again == h
    return y[0], status, counts


@pytest.mark.parametrize("run", [linear, solved])
def test_one_step_methods_are_of_order_2_with_fixed_steps(run):
    errors = [abs(solution(run, 2.0 / steps)[0] - math.cos(2.0)) for steps in (64, 128, 256)]
    assert [math.log2(a / b) for a, b in zip(errors, errors[1:])] == pytest.approx([2.0, 2.0], abs=0.25)


@pytest.mark.parametrize("run", [linear, solved])
def test_steps_are_equal_and_no_longer_than_asked_for(run):
    _, status, counts = solution(run, 0.03)
    assert status == OK and counts[COUNT.steps] == math.ceil(2.0 / 0.03) and counts[COUNT.rejected_steps] == 0
    assert solution(run, 0.1)[2][COUNT.steps] == 20


def test_a_stiff_solution_is_followed_at_steps_a_million_times_its_time_constant():
    assert solution(solved, 0.02, stiffness=1e9)[0] == pytest.approx(math.cos(2.0), abs=1e-8)


def test_a_step_that_does_not_converge_is_halved_and_counted():
    value, status, counts = solution(capricious, 0.5, converging=0.13)
    # every step of 0.5 is done as four of 0.125, after one attempt in one piece and one in halves
    assert status == OK and value == pytest.approx(3.0)
    assert counts[COUNT.steps] == 16 and counts[COUNT.rejected_steps] == 8


def test_a_step_whose_thousandth_part_does_not_converge_ends_with_a_status_after_eleven_attempts():
    value, status, counts = solution(capricious, 0.5, converging=0.5 / 1500)
    assert status == NOT_CONVERGED and value == 1.0
    assert counts[COUNT.steps] == 0 and counts[COUNT.rejected_steps] == 11


def test_a_step_with_one_hard_place_in_it_is_fine_there_alone():
    value, status, counts = solution(stumbling, 0.5, converging=1.1)
    # the place is 1.1; its step begins at 1.0 and needs parts of 2^-9, of which there are 256 in it
    assert status == OK and value == pytest.approx(3.0)
    assert counts[COUNT.steps] < 30 and counts[COUNT.rejected_steps] < 20


@pytest.mark.parametrize("run", [linear, solved])
def test_a_state_that_is_not_finite_ends_with_a_status(run):
    value, status, counts = solution(run, 0.02, nan_from=0.5)
    assert status in (NON_FINITE, NOT_CONVERGED) and value == pytest.approx(math.cos(0.5), abs=0.02)
    assert 0 < counts[COUNT.rejected_steps] < 12


def test_a_step_budget_bounds_the_work_and_a_kernel_that_fails_ends():
    _, status, counts = solution(linear, 1e-3, budget=17)
    assert status == STEP_BUDGET and counts[COUNT.steps] == 17
    assert solution(failed, 1e-3)[1] == NOT_EVALUATED
