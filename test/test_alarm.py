# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""An alarm tells a trouble once, however the value flickers, and only after it has lasted."""

import math

import numpy as np
import pytest

from bearing_sim.scene.scene import Hold
from bearing_sim.watchers.monitoring.monitor import Alarm

HOLD = Hold(hysteresis=0.1, raise_after=1.0, clear_after=2.0)
STEP = 0.1  # s


def turns(values, limit=10.0, hold=HOLD, below=False):
    """Return (time, whether raised) at each change of an alarm that is given values every tenth of a second."""
    alarm, found, before = Alarm(limit, hold, below), [], False
    for k, value in enumerate(values):
        now = alarm.judge(k * STEP, value)
        if now != before:
            found.append((pytest.approx(k * STEP), now))
        before = now
    return found


def test_a_value_that_stays_beyond_raises_after_the_hold_time_and_one_that_stays_back_clears_after_its_own():
    assert turns([5.0] * 10 + [11.0] * 30 + [5.0] * 40) == [(2.0, True), (6.0, False)]


def test_a_value_on_its_limit_is_beyond_it():
    assert turns([10.0] * 20) == [(1.0, True)]


@pytest.mark.parametrize("swing", [0.3, 0.9])
def test_a_value_that_flickers_around_its_limit_within_the_hysteresis_is_one_event(swing):
    lot = np.random.default_rng(1)
    assert turns(10.0 + lot.uniform(-swing, swing, 5000)) == [(pytest.approx(1.0, abs=0.5), True)]


def test_a_value_that_swings_wider_than_the_hysteresis_but_faster_than_the_hold_time_is_none():
    assert turns([5.0, 5.0, 20.0, 20.0] * 500) == []


def test_once_raised_such_a_swing_does_not_clear_it():
    assert turns([20.0] * 20 + [5.0, 5.0, 20.0, 20.0] * 500) == [(1.0, True)]


def test_a_value_within_the_hysteresis_of_its_limit_is_not_back():
    assert turns([11.0] * 20 + [9.5] * 1000) == [(1.0, True)]
    assert turns([11.0] * 20 + [8.9] * 100) == [(1.0, True), (4.0, False)]


def test_a_lower_limit_works_the_other_way_round():
    assert turns([10.0] * 10 + [9.9] * 30 + [10.5] * 1000, below=True) == [(2.0, True)]
    assert turns([10.0] * 10 + [9.9] * 30 + [11.5] * 100, below=True) == [(2.0, True), (6.0, False)]


def test_what_is_not_a_number_is_no_trouble_and_ends_one():
    assert turns([math.nan] * 100) == []
    assert turns([11.0] * 20 + [math.nan] * 100) == [(1.0, True), (4.0, False)]
    assert turns([math.inf] * 20) == [(1.0, True)] and turns([math.inf] * 20, below=True) == []


def test_without_hold_times_it_acts_at_once_and_without_a_limit_never():
    at_once = Hold(hysteresis=0.0, raise_after=0.0, clear_after=0.0)
    assert turns([9.0, 10.0, 9.9], hold=at_once) == [(0.1, True), (0.2, False)]
    assert turns([1e9] * 100, limit=None) == []
