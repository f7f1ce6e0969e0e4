# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The pacer keeps (wall, sim) in step, gives up what it cannot catch up, and measures; all on made-up clocks."""

import math

import pytest

from bearing_sim.runtime.pacing import SHORTEST_LIMIT, Pacer, tick_limit, tick_schedule

TICK = 0.01


def run(pacer, solver_seconds, ticks, wall=0.0, sim=0.0):
    """Run ticks on a fake clock; ``solver_seconds`` is a number or a function of the tick number.  Return (wall, sim)."""
    cost = solver_seconds if callable(solver_seconds) else lambda tick: solver_seconds
    for tick in range(ticks):
        wall += pacer.delay(wall, sim + TICK)
        wall += cost(tick)
        sim += TICK
        pacer.worked(wall, TICK, cost(tick))
    return wall, sim


@pytest.mark.parametrize("rate", [0.5, 1.0, 3.0])
def test_a_fast_solver_keeps_the_rate_exactly_and_loses_nothing(rate):
    pacer = Pacer(rate)
    pacer.anchor(0.0, 0.0)
    wall, sim = run(pacer, 0.0005, 2000)
    assert sim / wall == pytest.approx(rate, rel=1e-3)
    assert pacer.pace.real_time_factor == pytest.approx(rate, rel=1e-3)
    assert pacer.pace.solver_factor == pytest.approx(20.0, rel=1e-6)
    assert (pacer.pace.lost, pacer.pace.resyncs) == (0.0, 0)


def test_a_tick_is_due_when_its_end_has_come_never_before():
    pacer = Pacer()
    pacer.anchor(100.0, 7.0)
    assert pacer.delay(100.0, 7.01) == pytest.approx(0.01)
    assert pacer.delay(100.02, 7.01) == 0.0


def test_a_solver_too_slow_by_half_is_not_chased_and_all_its_lost_time_is_counted():
    pacer = Pacer(maximum_lag=0.1)
    pacer.anchor(0.0, 0.0)
    wall, sim = run(pacer, 0.02, 5000)
    pace = pacer.pace
    assert pace.real_time_factor == pytest.approx(0.5, rel=1e-3)
    assert pace.solver_factor == pytest.approx(0.5, rel=1e-3)
    assert 0.0 <= wall - sim - pace.lost <= 0.1 + 0.02, "what is not counted as lost is a lag that is caught up"
    assert pace.resyncs > 100


def test_a_short_stall_is_caught_up_and_a_long_one_is_given_up():
    short = Pacer(maximum_lag=0.1)
    short.anchor(0.0, 0.0)
    wall, sim = run(short, lambda tick: 0.08 if tick == 10 else 0.001, 100)
    assert short.pace.lost == 0.0
    assert abs(wall - sim) < 0.002

    long = Pacer(maximum_lag=0.1)
    long.anchor(0.0, 0.0)
    wall, sim = run(long, lambda tick: 5.0 if tick == 10 else 0.001, 100)
    assert long.pace.resyncs == 1
    assert long.pace.lost == pytest.approx(5.0 - TICK + 0.001, abs=0.02)
    assert wall == pytest.approx(sim + long.pace.lost, abs=0.01)


def test_after_a_resync_ticks_are_not_run_in_a_burst():
    pacer = Pacer(maximum_lag=0.1)
    pacer.anchor(0.0, 0.0)
    assert pacer.delay(60.0, TICK) == 0.0
    assert pacer.delay(60.0, 2 * TICK) == pytest.approx(TICK)


def test_a_pause_is_no_loss():
    pacer = Pacer()
    pacer.anchor(0.0, 0.0)
    _, sim = run(pacer, 0.001, 100)
    pacer.anchor(1000.0, sim)
    run(pacer, 0.001, 100, wall=1000.0, sim=sim)
    assert pacer.pace.lost == 0.0
    assert pacer.pace.real_time_factor == pytest.approx(1.0, rel=0.01)


def test_nothing_is_claimed_before_the_first_tick():
    pace = Pacer().pace
    assert math.isnan(pace.real_time_factor) and math.isnan(pace.solver_factor)


@pytest.mark.parametrize("parameter", ["rate", "maximum_lag", "memory"])
@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_parameter_that_is_no_positive_number_is_refused_by_name(parameter, value):
    with pytest.raises(ValueError, match=parameter):
        Pacer(**{parameter: value})


@pytest.mark.parametrize("sample_rate", [0.5, 10.0, 48.0, 100.0, 1000.0, 44100.0])
@pytest.mark.parametrize("publish_rate", [1.0, 30.0, 50.0, 100.0, 200.0])
def test_ticks_give_the_sample_rate_and_are_as_long_as_the_outputs_allow(sample_rate, publish_rate):
    tick, samples, every = tick_schedule(sample_rate, publish_rate)
    assert samples / (tick * every) == pytest.approx(sample_rate) and min(samples, every) == 1
    limit = tick_limit(publish_rate)
    assert tick <= limit * (1 + 1e-9)
    if tick < SHORTEST_LIMIT / 2:  # then another sample in each block would be too long
        assert (samples + 1) / sample_rate > SHORTEST_LIMIT


def test_ticks_are_long_only_where_a_period_of_outputs_is_a_whole_number_of_them():
    assert tick_schedule(100.0, 50.0).tick == pytest.approx(0.01)
    assert tick_schedule(100.0, 100.0).tick == pytest.approx(0.005)
    assert tick_schedule(100.0, 30.0).tick == pytest.approx(0.005), "30 outputs a second are no whole number of ticks of 10 ms apart"
    assert tick_schedule(200.0, 40.0).tick == pytest.approx(0.005) and tick_schedule(200.0, 20.0).tick == pytest.approx(0.01)
