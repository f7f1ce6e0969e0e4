# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A receiver's clock that is set is told from a thread that stood still between its readings."""

import pytest

from bearing_sim.runtime.pacing import WallClock

START_NS = 1_700_000_000_000_000_000


class Clocks:
    """A monotonic clock and a receiver's, which every reading lets go on by a while."""

    def __init__(self):
        self.time, self.each, self.set_by = 100.0, 1e-6, 0.0

    def monotonic(self):
        self.time += self.each
        return self.time

    def receiver(self):
        self.time += self.each
        return START_NS + round((self.time - 100.0 + self.set_by) * 1e9)


@pytest.fixture
def clocks():
    return Clocks()


def test_a_clock_that_goes_on_does_not_jump(clocks):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver)
    for _ in range(100):
        clocks.time += 7.0
        assert watched.jump(clocks.receiver()) == 0.0


@pytest.mark.parametrize("late", [0.5, 1.5, 40.0])
def test_a_thread_that_stood_still_after_its_reading_is_no_jump_then_nor_afterwards(clocks, late):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver)
    for delay in (late, 0.0, 0.9, 1.8, 0.0):
        old = clocks.receiver()
        clocks.time += delay
        assert watched.jump(old) == 0.0


def test_one_that_stood_still_before_the_first_look_is_no_jump_either(clocks):
    old = clocks.receiver()
    clocks.time += 3.0
    watched = WallClock(old, clocks.monotonic, clocks.receiver)
    assert watched.jump(clocks.receiver()) == 0.0


@pytest.mark.parametrize("by", [3600.0, 1.5, -1.5, -7200.0])
@pytest.mark.parametrize("has_receiver", [True, False])
def test_a_clock_that_is_set_is_told_once_and_by_how_much(clocks, by, has_receiver):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver if has_receiver else None)
    clocks.set_by += by
    assert watched.jump(clocks.receiver()) == pytest.approx(by, abs=1e-3)
    assert watched.jump(clocks.receiver()) == 0.0


def test_a_clock_that_is_set_while_the_thread_stands_still_is_told_by_what_it_was_set(clocks):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver)
    clocks.set_by -= 60.0
    old = clocks.receiver()
    clocks.time += 5.0
    assert watched.jump(old) == pytest.approx(-60.0, abs=1e-3)


def test_where_no_two_readings_are_of_one_moment_the_jump_is_told_once_they_are(clocks):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver)
    clocks.set_by, clocks.each = 60.0, 0.4
    assert watched.jump(clocks.receiver()) == 0.0
    clocks.each = 1e-6
    assert watched.jump(clocks.receiver()) == pytest.approx(60.0, abs=1e-3)


def test_a_clock_that_is_kept_right_little_by_little_does_not_jump(clocks):
    watched = WallClock(clocks.receiver(), clocks.monotonic, clocks.receiver)
    for _ in range(100):
        clocks.set_by += 0.05
        assert watched.jump(clocks.receiver()) == 0.0
