# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Which samples are due: as many as asked for over a long run, evenly, whatever the rate of samples and the skips of run time."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from bearing_sim.runtime.pacing import Decimator, OutputCount


def due(decimator, times):
    return [time for time in times if decimator.is_due(time)]


@pytest.mark.parametrize("ticks", [200.0, 300.0, 250.0])
@pytest.mark.parametrize("rate", [100.0, 50.0, 30.0, 97.0, 7.3, 0.1, 199.9])
def test_an_hours_mean_rate_is_the_one_asked_for_also_where_it_does_not_divide_that_of_the_ticks(rate, ticks):
    found = due(Decimator(rate), 0.123456789 + np.arange(3600 * ticks) / ticks)
    assert abs(len(found) - 3600 * rate) <= 1
    assert np.diff(found).max() < 1 / rate + 1 / ticks + 1e-6, "none is left out"


@pytest.mark.parametrize("every", [1, 2, 4, 20])
def test_a_rate_that_divides_that_of_the_ticks_takes_every_nth_tick_however_its_times_are_rounded(every):
    times = np.cumsum(np.full(100_000, 0.005)) + np.random.default_rng(1).uniform(-1e-9, 1e-9, 100_000)
    assert due(Decimator(200.0 / every), times) == times[::every].tolist()


def test_of_a_rate_above_that_of_the_ticks_every_tick_is_due():
    times = (np.arange(1000) * 0.005).tolist()
    assert due(Decimator(777.0), times) == times


def test_after_a_skip_of_run_time_nothing_is_made_up_for():
    times = [*np.arange(0.0, 1.0, 0.005), *np.arange(7.0012, 8.0, 0.005)]
    later = [time for time in due(Decimator(50.0), times) if time > 1.0]
    assert later[0] == 7.0012 and np.diff(later) == pytest.approx(0.02)


def test_a_rate_that_changes_counts_from_the_sample_that_was_due_last():
    decimator = Decimator(10.0)
    before = due(decimator, np.arange(200) * 0.005)
    decimator.rate = 100.0
    after = due(decimator, np.arange(200, 400) * 0.005)
    assert len(before) == 10 and len(after) == 100
    decimator.rate = 1.0
    assert len(due(decimator, np.arange(400, 1400) * 0.005)) == 5


@given(steps=some.lists(some.floats(1e-4, 0.5), min_size=2, max_size=300), rate=some.floats(0.1, 200.0))
def test_two_that_are_due_are_never_closer_on_the_average_than_a_period(steps, rate):
    times = np.cumsum(steps)
    found = due(Decimator(rate), times.tolist())
    assert len(found) <= (times[-1] - times[0]) * rate + 1 + 1e-6 * rate * len(steps)


def test_a_skip_of_less_than_a_period_keeps_the_multiples_and_a_longer_one_counts_from_its_end():
    assert due(Decimator(100.0), [0.0, 0.015, 0.02, 0.03]) == [0.0, 0.015, 0.02, 0.03]
    assert due(Decimator(100.0), [0.0, 0.019, 0.02, 0.03]) == [0.0, 0.019, 0.02, 0.03]
    assert due(Decimator(100.0), [0.0, 0.025, 0.03, 0.034, 0.035, 0.04, 0.045]) == [0.0, 0.025, 0.035, 0.045]


@given(gaps=some.lists(some.integers(1, 40), min_size=1, max_size=50))
def test_outputs_picked_and_left_out_are_together_as_many_as_periods_have_gone_by(gaps):
    decimator, period = Decimator(50.0), 0.02
    ticks = np.cumsum([0, *gaps])  # of half a period, as in a node; some are skipped
    due(decimator, (0.5 * period * ticks).tolist())
    # An output may come half a period late, and the multiples then count from there; each such skip may hide one half.
    assert 0 <= 1 + ticks[-1] // 2 - (decimator.picked + decimator.left_out) <= len(gaps)
    assert decimator.left_out <= sum(gap // 2 for gap in gaps)


def test_without_skips_nothing_is_left_out_and_a_skip_leaves_out_what_was_due_in_it():
    decimator = Decimator(50.0)
    due(decimator, (np.arange(1000) * 0.01).tolist())
    assert (decimator.picked, decimator.left_out) == (500, 0)
    due(decimator, (10.0 + np.arange(30, 100) * 0.01).tolist())  # 0.3 s are skipped
    assert decimator.left_out == 15


def test_what_was_due_during_a_pause_is_not_left_out():
    decimator = Decimator(50.0)
    due(decimator, (np.arange(100) * 0.01).tolist())
    decimator.interrupt()
    assert due(decimator, [100.0, 100.01, 100.02]) == [100.0, 100.02] and decimator.left_out == 0


class Told:
    """The warning over a course of seconds, each with the fraction of its 50 outputs that was left out; reviewed five times a second."""

    def __init__(self):
        self.count, self.second, self.published, self.left_out = OutputCount(), 0, 0, 0

    def after(self, *fractions):
        for fraction in fractions:
            self.left_out += round(50 * fraction)
            self.published += 50 - round(50 * fraction)
            self.second += 1
            for part in range(5):
                self.count.update(self.second + 0.2 * part, self.published, self.left_out)
        return self.count.is_raised


def test_one_stall_of_a_busy_machine_raises_no_warning_however_long_and_one_each_five_seconds_neither():
    assert not Told().after(0, 0, 0, 0, 0, 1.0, 1.0, 1.0, 0, 0, 0, 0)
    told = Told()
    assert not any(told.after(0.4, 0, 0, 0, 0) for _ in range(20))


def test_a_lasting_loss_is_warned_of_once_and_the_warning_holds_until_five_seconds_were_complete():
    told = Told()
    assert not told.after(0, 0, 0.2, 0.2, 0.2, 0.2), "four seconds"
    assert told.after(0.2) and told.count.recent == 50
    assert told.after(0, 0.1, 0, 0, 0, 0) and not told.after(0), "what flickers holds"


def test_a_loss_of_a_fiftieth_is_no_reason_to_warn():
    assert not Told().after(*[0.02] * 30)
