# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Backward differentiation formulas on problems with closed forms and against scipy; they know no bearings."""

import math

import numpy as np
import pytest
from one_equation import failing, no_limit, step_taken
from scipy.integrate import solve_ivp

from bearing_sim.numerics.bdf import ORDER, bdf, bdf_attempt, new_history, take_into_differences
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.newton import NEWTON
from bearing_sim.numerics.time_stepping import CONTROL, COUNT, NON_FINITE, NOT_EVALUATED, OK, STEP_BUDGET, new_counts, start_from_known

# model: (problem, parameter, tolerance); work: rows of the Jacobian, then rows of I - shift J, shape (4, 2)
OSCILLATOR, VAN_DER_POL, STIFF, KINK = 0.0, 1.0, 2.0, 3.0


@kernel
def rate_of(t, y, model, work, rate):
    rate[0] = y[1]
    if model[0] == OSCILLATOR:
        rate[1] = -model[1] * model[1] * y[0]
    elif model[0] == VAN_DER_POL:
        rate[1] = model[1] * (1.0 - y[0] * y[0]) * y[1] - y[0]
    elif model[0] == STIFF:
        # Prothero and Robinson 1974, twice: y' = -k (y - cos t) - sin t, solution cos t for any k
        rate[0] = -model[1] * (y[0] - math.cos(t)) - math.sin(t)
        rate[1] = -(y[1] - math.cos(t)) - math.sin(t)
    else:
        rate[0], rate[1] = abs(t - model[1]), -1e3 * (y[1] - y[0])
    return True


@kernel
def rate_and_jacobian(t, y, model, work, rate):
    work[0, 0], work[0, 1] = 0.0, 1.0
    if model[0] == OSCILLATOR:
        work[1, 0], work[1, 1] = -model[1] * model[1], 0.0
    elif model[0] == VAN_DER_POL:
        work[1, 0], work[1, 1] = -2.0 * model[1] * y[0] * y[1] - 1.0, model[1] * (1.0 - y[0] * y[0])
    elif model[0] == STIFF:
        work[0, 0], work[0, 1], work[1, 0], work[1, 1] = -model[1], 0.0, 0.0, -1.0
    else:
        work[0, 1], work[1, 0], work[1, 1] = 0.0, 1e3, -1e3
    return rate_of(t, y, model, work, rate)


@kernel
def factor(shift, work):
    work[2, 0], work[2, 1], work[3, 0], work[3, 1] = 1.0 - shift * work[0, 0], -shift * work[0, 1], -shift * work[1, 0], 1.0 - shift * work[1, 1]
    return work[2, 0] * work[3, 1] != work[2, 1] * work[3, 0]


@kernel
def solve(work, x):
    determinant = work[2, 0] * work[3, 1] - work[2, 1] * work[3, 0]
    x[0], x[1] = (work[3, 1] * x[0] - work[2, 1] * x[1]) / determinant, (work[2, 0] * x[1] - work[3, 0] * x[0]) / determinant


@kernel
def norm(t, y, change, model):
    tolerance = model[2]
    first, second = abs(change[0]) / (tolerance * (1.0 + abs(y[0]))), abs(change[1]) / (tolerance * (1.0 + abs(y[1])))
    return second if not second <= first else first


@kernel
def nan_rate(t, y, model, work, rate):
    rate[0], rate[1] = math.nan, 0.0
    return True


@kernel
def nan_rate_and_jacobian(t, y, model, work, rate):
    work[:] = 0.0
    return nan_rate(t, y, model, work, rate)


@kernel
def nan_later(t, y, model, work, rate):
    return rate_of(t, y, model, work, rate) if t < 0.5 else nan_rate(t, y, model, work, rate)


@kernel
def advance(t, end, stop, y, h, longest, budget, model, work, history, counts):
    return bdf(
        rate_of, rate_and_jacobian, start_from_known, factor, solve, norm, no_limit, step_taken,
        t, end, stop, y, h, longest, budget, model, work, history, counts,
    )  # fmt: skip


@kernel
def advance_nan(t, end, stop, y, h, longest, budget, model, work, history, counts):
    return bdf(
        nan_later, nan_rate_and_jacobian, start_from_known, factor, solve, norm, no_limit, step_taken,
        t, end, stop, y, h, longest, budget, model, work, history, counts,
    )  # fmt: skip


@kernel
def advance_failing(t, end, stop, y, h, longest, budget, model, work, history, counts):
    return bdf(
        failing, failing, start_from_known, factor, solve, norm, no_limit, step_taken,
        t, end, stop, y, h, longest, budget, model, work, history, counts,
    )  # fmt: skip


@kernel
def constant_steps(number, model, work, history, counts):
    """The formula alone: equal steps of the order at hand."""
    solved = True
    for _ in range(number):
        outcome = bdf_attempt(
            rate_of, rate_and_jacobian, start_from_known, factor, solve, norm,
            history.control[CONTROL.time], history.differences[0], history.control[CONTROL.step], model, work, history, counts,
        )  # fmt: skip
        solved = solved and outcome == OK
        take_into_differences(math.inf, history)
    return solved


class Run:
    """A problem in time, with history, work and counts."""

    def __init__(self, problem, parameter, start, tolerance, run=advance, budget=10**6):
        self.model, self.y, self.run, self.budget = np.array([problem, parameter, tolerance]), np.array(start), run, budget
        self.time, self.history, self.work, self.counts, self.step = 0.0, new_history(2), np.zeros((4, 2)), new_counts(), 1e-6

    def to(self, end, stop=math.inf):
        status, self.step = self.run(
            self.time,
            end,
            stop,
            self.y,
            self.step,
            1e9,
            self.budget,
            self.model,
            self.work,
            self.history,
            self.counts,
        )
        self.time = end
        return status


def end_of_constant_steps(order, number, problem, parameter, exact):
    """Return the error after ``number`` equal steps to t = 1 that begin with the exact solution."""
    history, h = new_history(2), 1.0 / number
    table = [np.array(exact(-m * h)) for m in range(order + 1)]
    for m in range(order + 1):
        history.differences[m] = table[0]
        table = [newer - older for newer, older in zip(table, table[1:])]
    history.order[ORDER.order], history.control[CONTROL.step], history.control[CONTROL.next_step], history.newton[NEWTON.contraction] = (
        order,
        h,
        h,
        1.0,
    )
    # so tight that the iteration ends at round-off
    assert constant_steps(number, np.array([problem, parameter, 1e-12]), np.zeros((4, 2)), history, new_counts())
    return np.abs(history.differences[0] - exact(1.0)).max()


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_each_order_is_its_own_with_constant_steps_on_an_oscillator(order):
    coarsest = {1: 400, 2: 200, 3: 80, 4: 50, 5: 40}[order]
    errors = [end_of_constant_steps(order, coarsest * 2**k, OSCILLATOR, 3.0, lambda t: (math.sin(3 * t), 3 * math.cos(3 * t))) for k in range(3)]
    assert [math.log2(a / b) for a, b in zip(errors, errors[1:])] == pytest.approx([order, order], abs=0.2)


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5])
def test_each_order_holds_on_a_solution_a_million_times_slower_than_the_system(order):
    errors = [end_of_constant_steps(order, 10 * 2**k, STIFF, 1e6, lambda t: (math.cos(t), math.cos(t))) for k in range(3)]
    assert [math.log2(a / b) for a, b in zip(errors, errors[1:])] == pytest.approx([order, order], abs=0.3)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_error_on_van_der_pol_follows_the_tolerance(tolerance):
    # mu = 50: relaxation oscillations, stiff along the slow arcs
    reference = solve_ivp(
        lambda t, y: (y[1], 50 * (1 - y[0] ** 2) * y[1] - y[0]), (0, 30), (2, 0), method="Radau", rtol=1e-10, atol=1e-10, t_eval=[10, 20, 30]
    ).y[0]
    run, errors = Run(VAN_DER_POL, 50.0, [2.0, 0.0], tolerance), []
    for end, expected in zip((10.0, 20.0, 30.0), reference):
        assert run.to(end) == OK
        errors.append(abs(run.y[0] - expected))
    assert max(errors) < 100 * tolerance


def test_work_grows_with_accuracy_as_a_high_order_would_have_it():
    counts = {}
    for tolerance in (1e-3, 1e-9):
        run = Run(OSCILLATOR, 1.0, [0.0, 1.0], tolerance)
        assert run.to(20.0) == OK
        counts[tolerance] = run.counts[COUNT.steps]
        # nothing damps an oscillator's errors: each step may add one tolerance
        assert abs(run.y[0] - math.sin(20.0)) < counts[tolerance] * tolerance
    # a million times the accuracy: at order 5 ten times the steps, at order 2 a hundred times
    assert 3 < counts[1e-9] / counts[1e-3] < 30


def test_a_stiff_solution_is_followed_by_long_steps():
    run = Run(STIFF, 1e9, [1.0, 1.0], 1e-4)
    assert run.to(10.0) == OK
    assert abs(run.y[0] - math.cos(10.0)) < 1e-3 and run.counts[COUNT.steps] < 150


def test_derivatives_are_kept_on_a_linear_problem():
    run = Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-5)
    assert run.to(20.0) == OK
    # the Jacobian is the same all along: only the first is needed
    assert run.counts[COUNT.jacobians] == 1
    assert run.counts[COUNT.jacobians] < run.counts[COUNT.factorisations] < run.counts[COUNT.steps] / 4
    assert run.counts[COUNT.right_hand_sides] < 2.2 * run.counts[COUNT.steps]


@pytest.mark.parametrize("stopping", [True, False])
def test_history_survives_a_split_of_the_interval(stopping):
    whole, split, restarted = [Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-6) for _ in range(3)]
    assert whole.to(20.0, 20.0) == OK
    for k in range(1, 21):
        assert split.to(float(k), float(k) if stopping else math.inf) == OK
        assert restarted.to(float(k), float(k)) == OK
        restarted.history, restarted.step = new_history(2), 1e-6
    assert abs(split.y[0] - math.sin(20.0)) < 1e-6 * split.counts[COUNT.steps]
    steps = [run.counts[COUNT.steps] for run in (whole, split, restarted)]
    # a stop shortens two steps and may cost one; reading the polynomial costs nothing
    assert steps[1] <= steps[0] + (40 if stopping else 2) and steps[2] > steps[0] + 200


def test_another_state_than_the_history_leads_to_begins_a_new_one():
    run = Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-6)
    assert run.to(1.0) == OK
    run.y[:], run.time = (0.0, 2.0), 0.0
    assert run.to(1.0) == OK
    assert run.y[0] == pytest.approx(2 * math.sin(1.0), abs=1e-4)


def test_no_step_passes_a_stop_and_the_interval_ends_there_exactly():
    # the rate has a kink at 0.7; t^2/2 - 0.7 t up to it
    run = Run(KINK, 0.7, [0.0, 0.0], 1e-5)
    assert run.to(0.7, 0.7) == OK
    assert run.history.control[CONTROL.time] == 0.7
    assert run.y[0] == pytest.approx(0.245, abs=1e-5)
    assert run.to(1.4, 1.4) == OK
    assert run.y[0] == pytest.approx(0.49, abs=2e-4)


def test_a_step_budget_bounds_the_work():
    run = Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-6, budget=17)
    assert run.to(20.0) == STEP_BUDGET and run.counts[COUNT.steps] + run.counts[COUNT.rejected_steps] == 17


def test_nan_and_kernels_that_fail_end_with_a_status_not_a_hang():
    run = Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-6, advance_nan)
    assert run.to(1.0) == NON_FINITE and run.counts[COUNT.non_finite_steps] > 0
    assert Run(OSCILLATOR, 1.0, [0.0, 1.0], 1e-6, advance_failing).to(1.0) == NOT_EVALUATED


def test_a_tolerance_that_cannot_be_met_takes_the_smallest_steps_and_counts_them():
    run = Run(STIFF, 1e3, [5.0, 1.0], 1e-30, budget=200)
    assert run.to(1.0) == STEP_BUDGET and run.counts[COUNT.smallest_steps] > 50 and np.isfinite(run.y).all()
