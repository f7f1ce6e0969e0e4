# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The change detector: its false-alarm rate by simulation, correlated noise, wild readings, and how soon it finds a change."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.stats import kstest

from bearing_sim.watchers.monitoring.residual import Cusum, Whitener, run_length, threshold_for


def correlated(lot, count, correlation):
    """Return noise of standard deviation 1 whose neighbours resemble each other: a first-order autoregression."""
    return lfilter([math.sqrt(1 - correlation**2)], [1, -correlation], lot.normal(size=count + 500))[500:]


def first_alarm(cusum, numbers):
    """Return how many numbers it took."""
    for k, number in enumerate(numbers):
        if cusum.accumulate(number):
            return k + 1
    raise AssertionError("no alarm at all")


@pytest.mark.parametrize("wanted", [50.0, 400.0])
def test_the_mean_time_between_false_alarms_is_the_one_asked_for(wanted):
    lot, threshold, runs = np.random.default_rng(1), threshold_for(wanted), 600
    lengths = [first_alarm(Cusum(threshold), iter(lot.normal, None)) for _ in range(runs)]
    # run lengths scatter as much as their mean: 4 % standard error; Siegmund's formula is good to some 3 %
    assert np.mean(lengths) == pytest.approx(wanted, rel=0.15)


@pytest.mark.parametrize(("threshold", "length"), [(4.0, 168.0), (5.0, 465.0)])
def test_run_lengths_are_those_of_the_tables(threshold, length):
    """Two-sided CUSUM, k = 0.5: 168 and 465 (Montgomery, Introduction to Statistical Quality Control, table 9.3)."""
    assert run_length(threshold) == pytest.approx(length, rel=0.01)
    assert threshold_for(run_length(threshold)) == pytest.approx(threshold)


def test_a_run_between_false_alarms_of_next_to_nothing_is_refused():
    with pytest.raises(ValueError, match="too short"):
        threshold_for(1.0)


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_whitened_noise_is_standard_normal_and_independent_whatever_its_mean_scatter_and_correlation(correlation):
    noise = 3.0 + 0.02 * correlated(np.random.default_rng(2), 20_000, correlation)
    whitener = Whitener(1e-9)
    numbers = np.array([whitener.whiten(value) for value in noise])[1000:]
    assert kstest(numbers, "norm").statistic < 0.02
    assert abs(np.mean(numbers[1:] * numbers[:-1])) < 0.05 and abs(np.mean(numbers[3:] * numbers[:-3])) < 0.05
    assert whitener.correlation == pytest.approx(correlation, abs=0.03)


def test_a_number_is_as_rare_as_it_should_be_even_when_little_is_known_before_it():
    """The ninth batch: beyond 3 standard deviations in 0.27 % of all cases; without Student's distribution it would be in 4 %."""
    numbers = []
    for course in np.random.default_rng(8).normal(size=(4000, 9)):
        whitener = Whitener(1e-9)
        numbers.append([whitener.whiten(value) for value in course][-1])
    assert np.mean(np.abs(numbers) > 3.0) < 0.008


@pytest.mark.parametrize("correlation", [0.0, 0.6, 0.9])
def test_correlated_noise_alarms_no_more_often_than_asked_for(correlation):
    lot, wanted, learning, lengths = np.random.default_rng(3), 300.0, 1000, []
    for _ in range(100):
        whitener, cusum = Whitener(1e-9), Cusum(threshold_for(wanted))
        noise = iter(correlated(lot, learning + 10_000, correlation))
        for _ in range(learning):
            whitener.whiten(next(noise))
        lengths.append(first_alarm(cusum, (whitener.whiten(value) for value in noise)))
    assert np.mean(lengths) > 0.7 * wanted, "a tenth of standard error, and what is left of the correlation"


def test_what_only_whitening_achieves():
    """The same noise, not whitened, alarms ten times as often as asked for: the test above can fail."""
    lot, wanted = np.random.default_rng(3), 300.0
    lengths = [first_alarm(Cusum(threshold_for(wanted)), correlated(lot, 20_000, 0.9)) for _ in range(100)]
    assert np.mean(lengths) < 0.2 * wanted


def test_a_change_is_found_on_its_side_and_over_when_it_is_gone():
    lot, cusum = np.random.default_rng(4), Cusum(threshold_for(3.6e6))
    for side in (1, -1):
        found = first_alarm(cusum, lot.normal(loc=2.0 * side, size=100))
        assert cusum.side == side and found < 25, "h/(2 - k) = 9.3 on average"
        lasted = cusum.rising_for if side > 0 else cusum.falling_for
        assert lasted == pytest.approx(found, abs=5)
        for number in lot.normal(size=100):
            cusum.accumulate(number)
        assert cusum.side == 0


def test_wild_readings_are_no_change_and_do_not_become_usual():
    lot, whitener, cusum = np.random.default_rng(5), Whitener(1e-9), Cusum(threshold_for(1e5))
    for k, value in enumerate(lot.normal(size=5000)):
        cusum.accumulate(whitener.whiten(value if k % 200 or k < 200 else 1e6))
        assert cusum.side == 0
    assert abs(whitener.mean) < 0.2


def test_a_change_within_the_tolerance_is_no_change_and_a_larger_one_is():
    lot = np.random.default_rng(6)
    for change, expected in ((0.9, 0), (2.5, 1), (-2.5, -1)):
        whitener, cusum = Whitener(tolerance=1.0), Cusum(threshold_for(3.6e6))
        for value in 1e-3 * lot.normal(size=300):
            whitener.whiten(value)
        for value in change + 1e-3 * lot.normal(size=2000):
            cusum.accumulate(whitener.whiten(value, learn=False))
        assert cusum.side == expected


def test_what_is_not_a_number_changes_nothing():
    cusum = Cusum(5.0)
    cusum.accumulate(3.0)
    assert cusum.accumulate(math.nan) == 0 and cusum.up == 2.5


@pytest.mark.parametrize(("batches", "correlation"), [(20, 0.9), (40, 0.9)])
def test_the_correlation_of_a_short_course_is_more_often_over_than_underestimated(batches, correlation):
    """A standard error above an unbiased estimate; Kendall's correction left out, it is below in 60 % of the courses and more."""
    lot, above = np.random.default_rng(11), 0
    for _ in range(600):
        whitener = Whitener(1e-9)
        for value in correlated(lot, batches, correlation):
            whitener.whiten(value)
        above += whitener.correlation >= correlation
    assert above / 600 > 0.58
