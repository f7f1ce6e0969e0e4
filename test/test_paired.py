# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pairs of stretches tell a small cost from noise and drift, and controls tell nothing where there is nothing."""

import numpy as np
import pytest
from paired import CONTROL, WITH, WITHOUT, ThreadStatistics, differences, order, ratios, spread
from scipy.stats import binom


def test_every_stretch_with_and_every_control_stands_between_two_without():
    kinds = order(5)
    assert kinds.count(WITH) == kinds.count(CONTROL) == 5 and kinds[0] == kinds[-1] == WITHOUT
    for place, kind in enumerate(kinds):
        if kind != WITHOUT:
            assert kinds[place - 1] == kinds[place + 1] == WITHOUT


def test_a_cost_of_three_percent_is_found_under_noise_and_a_drift_ten_times_as_large():
    kinds, noise = order(40), np.random.default_rng(1)
    values = [(1.0 - 0.003 * k) * (0.97 if kind == WITH else 1.0) * (1 + 0.02 * noise.normal()) for k, kind in enumerate(kinds)]
    cost, nothing = ratios(kinds, values, WITH), ratios(kinds, values, CONTROL)
    assert cost.low < 0.97 < cost.high < 1.0 and cost.high - cost.low < 0.03
    assert nothing.low < 1.0 < nothing.high and cost.pairs == nothing.pairs == 40


def test_differences_are_to_the_mean_of_the_neighbours():
    assert differences([WITHOUT, WITH, WITHOUT], [1.0, 5.0, 2.0], WITH).median == 3.5


@pytest.mark.parametrize("count", [6, 12, 25])
def test_the_interval_holds_the_median_as_often_as_it_says(count):
    noise = np.random.default_rng(2)
    found = [spread(noise.exponential(size=count)) for _ in range(4000)]
    held = np.mean([one.low <= np.log(2) <= one.high for one in found])
    outside = next(k for k in range(count) if binom.cdf(k, count, 0.5) > 0.025)  # values on either side of the interval, at most
    assert held == pytest.approx(1 - 2 * binom.cdf(outside - 1, count, 0.5), abs=0.015) and held > 0.94


def test_what_a_thread_waited_never_gets_less():
    books = ThreadStatistics()
    waited = [books.waited() for _ in range(100)]
    books.close()
    assert waited == sorted(waited) and waited[0] >= 0.0
