# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""TR-BDF2 and both loops around them on problems with closed forms; they know no bearings."""

import math

import numpy as np
import pytest
from one_equation import factor, failing, no_limit, solve, step_taken

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.time_stepping import (
    COUNT,
    NON_FINITE,
    NOT_CONVERGED,
    NOT_EVALUATED,
    OK,
    STEP_BUDGET,
    Kernels,
    advance_in_steps,
    new_counts,
    new_memory,
)
from bearing_sim.numerics.tr_bdf2 import ERROR_ORDER, tr_bdf2_attempt

# model: (stiffness, fraction of the Jacobian that the method is given, absolute tolerance, time from which all is NaN, longest step that
# can be solved); work: (jacobian, factored)
STIFFNESS, GIVEN, TOLERANCE, NAN_FROM, SOLVABLE = range(5)
_REGULAR_SPEED = 1e-3


@kernel
def rate_of(t, y, model, work, rate):
    # Prothero and Robinson 1974: y' = -k (y - cos t) - sin t, solution cos t for any k
    rate[0] = -model[STIFFNESS] * (y[0] - math.cos(t)) - math.sin(t)
    if t > model[NAN_FROM]:
        rate[0] = math.nan
    return True


@kernel
def rate_and_jacobian(t, y, model, work, rate):
    work[0] = -model[STIFFNESS] * model[GIVEN]
    return rate_of(t, y, model, work, rate)


@kernel
def norm(t, y, change, model):
    return abs(change[0]) / model[TOLERANCE]


@kernel
def solved_if_short(kernels, t, y, h, model, work, memory, counts):
    # what contacts do to an iteration: whether it converges depends on the length of the step
    memory.scratch[1, 0] = y[0] + h
    return OK if h <= model[SOLVABLE] else NOT_CONVERGED


@kernel
def unsolved_across_an_impact(kernels, t, y, h, model, work, memory, counts):
    memory.scratch[1, 0] = y[0] + h
    return OK if h <= 2.0**-9 or not t <= model[SOLVABLE] < t + h else NOT_CONVERGED


@kernel
def error_by_length(kernels, t, y, h, model, work, memory, counts):
    memory.scratch[1, 0], memory.scratch[2, 0] = y[0] + h, h
    return OK


@kernel
def keep_longest(t, h, y, model, work):
    work[0] = max(work[0], h)


@kernel
def rubbed(t, y, model, work, rate):
    # braked by dry friction, whose law is all but a step at rest
    rate[0] = -model[STIFFNESS] * math.tanh(y[0] / _REGULAR_SPEED)
    return True


@kernel
def rubbed_with_jacobian(t, y, model, work, rate):
    rubbed(t, y, model, work, rate)
    work[0] = -(model[STIFFNESS] - rate[0] * rate[0] / model[STIFFNESS]) / _REGULAR_SPEED
    return True


@kernel
def guess_known(known, shift, slope, model, work, guess):
    guess[0] = known[0]


@kernel
def keep_correction(y, change, model, work):
    pass


def kernels_of(rhs, rhs_and_jacobian, taken=step_taken):
    """Return the functions of a level of one equation; nobody asks for samples."""
    return Kernels(rhs, rhs_and_jacobian, guess_known, factor, solve, norm, norm, keep_correction, no_limit, taken, failing)


STIFF, LENGTHS = kernels_of(rate_of, rate_and_jacobian), kernels_of(rate_of, rate_and_jacobian, keep_longest)
RUBBED, FAILING = kernels_of(rubbed, rubbed_with_jacobian), kernels_of(failing, failing)


@kernel
def with_error_by_length(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(error_by_length, ERROR_ORDER, LENGTHS, False, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_tr_bdf2(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, STIFF, False, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_tr_bdf2_fixed(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, STIFF, True, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_rubbed_fixed(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, RUBBED, True, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_failing_kernels(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, FAILING, False, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_failing_kernels_fixed(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(tr_bdf2_attempt, ERROR_ORDER, FAILING, True, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def by_short_steps_fixed(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(solved_if_short, ERROR_ORDER, STIFF, True, t, end, y, h, longest, budget, model, work, memory, counts)


@kernel
def across_an_impact_fixed(t, end, y, h, longest, budget, model, work, memory, counts):
    return advance_in_steps(unsolved_across_an_impact, ERROR_ORDER, STIFF, True, t, end, y, h, longest, budget, model, work, memory, counts)


def solution(run, stiffness=2.0, step=1e9, given=1.0, tolerance=1e-9, end=2.0, budget=10**7, start=1.0, nan_from=math.inf, solvable=math.inf):
    """Return value, status and counts at ``end``; ``step`` is the fixed or longest one."""
    y, counts, model = np.array([start]), new_counts(), np.array([stiffness, given, tolerance, nan_from, solvable])
    status, _ = run(0.0, end, y, 1e-3, step, budget, model, np.zeros(2), new_memory(1), counts)
    return y[0], status, counts


def orders(run, stiffness=2.0, given=1.0, tolerance=1e-9):
    errors = [abs(solution(run, stiffness, 2.0 / steps, given, tolerance)[0] - math.cos(2.0)) for steps in (64, 128, 256)]
    return [math.log2(a / b) for a, b in zip(errors, errors[1:])]


@pytest.mark.parametrize("stiffness", [1.0, 2.0])
def test_tr_bdf2_is_of_order_3(stiffness):
    assert orders(by_tr_bdf2_fixed, stiffness, tolerance=1.0) == pytest.approx([3.0, 3.0], abs=0.15)


def test_tr_bdf2_is_of_order_3_without_a_jacobian_too():
    # that of level slip leaves small couplings out: the iteration then takes longer, and the filter is another
    assert orders(by_tr_bdf2_fixed, 2.0, given=0.0, tolerance=1e-9) == pytest.approx([3.0, 3.0], abs=0.15)


def test_what_tr_bdf2_adds_to_its_stages_is_left_out_where_it_is_many_tolerances():
    # as after the impact of a body: with nothing added the order is that of the stages
    assert orders(by_tr_bdf2_fixed, 2.0, tolerance=1e-12) == pytest.approx([2.0, 2.0], abs=0.15)


def factor_of_a_step(z):
    """Return R(z) of y' = lambda y, z = lambda h: the stages of Hosea and Shampine 1996 and the filtered error, written out."""
    d, w, b = 1.0 - math.sqrt(0.5), math.sqrt(2.0) / 4.0, 0.85
    inner = (1.0 + d * z) / (1.0 - d * z)
    end = (1.0 + w * z * (1.0 + inner)) / (1.0 - d * z)
    third = 1.0 + z * ((1.0 - w) / 3.0 + (3.0 * w + 1.0) / 3.0 * inner + d / 3.0 * end)
    filtered = 1.0 / (1.0 - d * z)
    return end + filtered**2 * ((1.0 + b) - b * filtered) * (third - end)


@pytest.mark.parametrize("z", [-0.1, -2.0, -30.0])
def test_tr_bdf2_takes_the_steps_of_its_formulas(z):
    # y' = -k (y - cos t) - sin t with two starts: the difference of the solutions decays without the right side
    steps, decay = 5, [solution(by_tr_bdf2_fixed, -z, 1.0, end=5.0, start=start, tolerance=100.0)[0] for start in (3.0, 1.0)]
    assert (decay[0] - decay[1]) / 2.0 == pytest.approx(factor_of_a_step(z) ** steps, rel=1e-6, abs=1e-12)


def test_tr_bdf2_is_stable_on_the_left_half_plane_and_damps_what_is_stiff():
    along, across = np.r_[0.0, np.geomspace(1e-3, 1e5, 300)], np.r_[0.0, np.geomspace(1e-3, 1e5, 300)]
    z = -along[:, None] + 1j * across[None, :]
    assert abs(factor_of_a_step(z)).max() < 1.0 + 1e-12
    assert abs(factor_of_a_step(1j * 1e4)) < 1e-3 and abs(factor_of_a_step(-1e4)) < 1e-3


def test_an_oscillation_keeps_its_amplitude_and_its_time_at_six_steps_a_period():
    # A ring in resonance with the passing rollers has a life that an error of the period decides: that of Y_2 is 4 % here.
    factor = factor_of_a_step(1j * 2.0 * math.pi / 6.0)
    assert abs(factor) == pytest.approx(1.0, abs=3e-3)
    assert np.angle(factor) == pytest.approx(2.0 * math.pi / 6.0, rel=1e-3)


def test_tr_bdf2_evaluates_the_slope_anew_where_none_is_kept():
    y, counts, memory, model = np.array([3.0]), new_counts(), new_memory(1), np.array([2.0, 1.0, 1.0, math.inf, 0.0])
    memory.scratch[7:9] = 1e3  # of other inputs
    by_tr_bdf2_fixed(0.0, 0.1, y, 0.1, 0.1, 10, model, np.zeros(2), memory, counts)
    assert y[0] == pytest.approx(math.cos(0.1) + 2.0 * math.exp(-0.2), abs=1e-4)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3])
def test_a_body_braked_by_dry_friction_comes_to_rest_in_steps_that_lead_across_the_bend_of_the_law(tolerance):
    # Whole corrections lead to and fro between both flat parts of the law, and the iteration would not end.
    value, status, counts = solution(by_rubbed_fixed, 10.0, 0.07, end=0.3, start=1.0, tolerance=tolerance)
    assert status == OK and abs(value) < 0.1 * _REGULAR_SPEED
    assert counts[COUNT.rejected_steps] < 2 and counts[COUNT.factorisations] < 100


def test_tr_bdf2_follows_a_stiff_solution_without_lagging():
    assert solution(by_tr_bdf2_fixed, 1e9, 0.02)[0] == pytest.approx(math.cos(2.0), abs=1e-8)


def test_a_stiff_transient_dies_in_one_long_step():
    # L-stability: the factor of one step goes to zero with the stiffness
    assert solution(by_tr_bdf2_fixed, 1e12, 1e-3, end=1e-3, start=5.0)[0] == pytest.approx(1.0, abs=1e-5)


def test_error_stays_within_a_few_tolerances_and_work_grows_with_accuracy():
    loose, _, loose_counts = solution(by_tr_bdf2, 50.0, tolerance=3e-3)
    tight, _, tight_counts = solution(by_tr_bdf2, 50.0, tolerance=3e-6)
    assert abs(loose - math.cos(2.0)) < 5e-3 and abs(tight - math.cos(2.0)) < 5e-6
    assert tight_counts[COUNT.steps] > 4 * loose_counts[COUNT.steps]


@pytest.mark.parametrize("first", [1.0, 1e-6])
def test_no_step_is_accepted_whose_error_is_above_the_tolerance(first):
    # the error of a step is its length, the tolerance 0.01
    work, counts, model = np.zeros(2), new_counts(), np.array([2.0, 1.0, 0.01, math.inf, 0.0])
    status, _ = with_error_by_length(0.0, 2.0, np.zeros(1), first, 1e9, 10**6, model, work, new_memory(1), counts)
    assert status == OK and 0.001 < work[0] <= 0.01
    assert (counts[COUNT.rejected_steps] > 0) == (first > 0.01)


def test_the_last_step_ends_exactly_at_the_end():
    y, counts, memory = np.array([1.0]), new_counts(), new_memory(1)
    for k in range(10):
        by_tr_bdf2(0.1 * k, 0.1 * (k + 1), y, 0.03, 0.03, 10**6, np.array([3.0, 1.0, 1e9, math.inf, 0.0]), np.zeros(2), memory, counts)
    assert y[0] == pytest.approx(math.cos(1.0), abs=2e-4)
    assert counts[COUNT.steps] == 40


@pytest.mark.parametrize("run", [by_tr_bdf2, by_tr_bdf2_fixed])
def test_a_step_budget_bounds_the_work(run):
    _, status, counts = solution(run, step=2e-3, budget=17)
    assert status == STEP_BUDGET and counts[COUNT.steps] + counts[COUNT.rejected_steps] == 17


def test_nan_ends_with_a_status_not_a_hang():
    _, status, counts = solution(by_tr_bdf2, nan_from=0.5, tolerance=1e-3)
    assert status == NON_FINITE and counts[COUNT.non_finite_steps] > 0


@pytest.mark.parametrize("run", [by_failing_kernels, by_failing_kernels_fixed])
def test_kernels_that_fail_end_with_a_status_not_a_hang(run):
    assert solution(run, step=1e-3)[1] == NOT_EVALUATED


def test_a_tolerance_that_cannot_be_met_takes_the_smallest_steps_and_counts_them():
    value, status, counts = solution(with_error_by_length, tolerance=1e-30, budget=200)
    assert status == STEP_BUDGET and counts[COUNT.smallest_steps] > 50 and math.isfinite(value)


def test_fixed_steps_are_equal_and_no_longer_than_asked_for():
    _, status, counts = solution(by_tr_bdf2_fixed, step=0.03)
    assert status == OK and counts[COUNT.steps] == math.ceil(2.0 / 0.03) and counts[COUNT.rejected_steps] == 0
    assert solution(by_tr_bdf2_fixed, step=0.1)[2][COUNT.steps] == 20


def test_a_fixed_step_that_cannot_be_solved_is_halved_and_counted():
    value, status, counts = solution(by_short_steps_fixed, step=0.5, solvable=0.13)
    # every step of 0.5 is done as four of 0.125, after one attempt in one piece and one in halves
    assert status == OK and value == pytest.approx(3.0)
    assert counts[COUNT.steps] == 16 and counts[COUNT.rejected_steps] == 8


def test_a_fixed_step_whose_thousandth_part_cannot_be_solved_ends_with_a_status_after_eleven_attempts():
    value, status, counts = solution(by_short_steps_fixed, step=0.5, solvable=0.5 / 1500)
    assert status == NOT_CONVERGED and value == 1.0
    assert counts[COUNT.steps] == 0 and counts[COUNT.rejected_steps] == 11


def test_a_fixed_step_with_an_impact_in_it_is_fine_there_alone():
    value, status, counts = solution(across_an_impact_fixed, step=0.5, solvable=1.1)
    # the impact is at 1.1; its step begins at 1.0 and needs parts of 2^-9, of which it has 256
    assert status == OK and value == pytest.approx(3.0)
    assert counts[COUNT.steps] < 30 and counts[COUNT.rejected_steps] < 20


def test_a_state_that_is_not_finite_ends_fixed_steps_with_a_status():
    value, status, counts = solution(by_tr_bdf2_fixed, step=0.02, nan_from=0.5)
    assert status == NON_FINITE and value == pytest.approx(math.cos(0.5), abs=0.02)
    assert 0 < counts[COUNT.rejected_steps] < 12
