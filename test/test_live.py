# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The live model: messages in, samples and news out, sinks fed and survived; without ROS and with a stand-in for the physics."""

import math
import time
from types import SimpleNamespace

import numpy as np
import pytest
from fake_simulation import FakeSimulation
from support import ListSink

from bearing_sim.messages.events import Event, Level
from bearing_sim.runtime.health import Health, Phase
from bearing_sim.runtime.live import LiveModel
from bearing_sim.runtime.pacing import LONGEST_TICK, SHORTEST_LIMIT, tick_limit, tick_schedule
from bearing_sim.scene.loader import load_scene

START_NS = 1_700_000_000_000_000_000


class Bench:
    """A live model, a made-up receiver's clock, and every piece of news so far."""

    def __init__(self, simulation=None, scene=(), **options):
        overrides = ["input_limits.stale_after=0.5s", "input_limits.minimum_rate=0Hz", "input_limits.reverse_rotation=false", *scene]
        self.simulation = simulation or FakeSimulation()
        self.live = LiveModel(load_scene("deng2017_table1", overrides), self.simulation, START_NS, **options)
        self.began = time.monotonic()
        self.news = []

    @property
    def now_ns(self):
        return START_NS + round((time.monotonic() - self.began) * 1e9)

    def speed(self, value, stamp_ns=None):
        return self.live.offer("shaft_speed", (value,), stamp_ns, self.now_ns)

    def load(self, y=800.0, z=0.0):
        return self.live.offer("radial_load", (y, z), None, self.now_ns)

    def run(self, seconds, drive=True):
        """Feed good inputs at 50 Hz, or none, and collect."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if drive:
                self.speed(100.0)
                self.load()
            self.news += self.live.collect(self.now_ns)
            time.sleep(0.02)

    def codes(self):
        return {event.kind for event in self.live.condition(self.now_ns).events}


@pytest.fixture
def bench():
    benches = []

    def make(*args, **options):
        benches.append(Bench(*args, **options))
        return benches[-1]

    yield make
    for one in benches:
        assert one.live.close()


def test_the_model_waits_for_the_first_good_speed_and_says_so(bench):
    one = bench()
    one.load()
    one.speed(math.nan)
    one.run(0.1, drive=False)
    assert one.live.solver.phase is Phase.WAITING
    assert {"run.waiting", "input.not_finite"} <= one.codes()
    one.run(0.2)
    assert one.live.solver.phase is Phase.RUNNING
    assert "run.waiting" not in one.codes()


def test_a_refused_message_is_news_once_shown_for_a_while_with_its_count_and_the_model_holds(bench):
    one = bench()
    one.run(0.1)
    for _ in range(5):
        one.speed(-1.0)
    one.run(0.1)
    assert [event.kind for event in one.news if event.kind.startswith("input.")] == ["input.negative"]
    condition = one.live.condition(one.now_ns)
    assert condition.level is Level.ERROR
    assert "(5 times)" in condition.events[0].text
    assert condition.values["messages refused"] == condition.values["refused: input.negative"] == 5
    assert one.live.solver.newest["shaft_speed"] == 100.0
    one.run(2.2)
    assert "input.negative" not in one.codes(), "it is over"


def test_a_stale_input_is_news_when_it_starts_and_gone_when_messages_come_again(bench):
    one = bench()
    one.run(0.1)
    one.run(0.8, drive=False)
    assert "input.stale" in one.codes()
    assert sum(event.kind == "input.stale" for event in one.news) == 2, "once for speed, once for load"
    one.run(0.1)
    assert "input.stale" in one.codes(), "one message is no flow"
    one.run(0.6)
    assert "input.stale" not in one.codes()


def test_sinks_get_every_sample_once_in_order_and_recorders_the_inputs_too(bench):
    one = bench(sample_rate=1 / LONGEST_TICK)
    sink, recorder = ListSink(keeps_all=False), ListSink()
    one.live.sinks.attach("view", sink)
    one.live.sinks.attach("record", recorder)
    one.run(0.5)
    assert one.live.close()
    times = [t for block in sink.blocks for t in block["time"]]
    assert len(times) == 1 + len(one.simulation.calls) and times == sorted(times)  # the first is the state at the start
    assert [t for block in recorder.blocks for t in block["time"]] == times
    assert sink.closed == recorder.closed == 1 and not sink.inputs
    assert {tuple(channels) for _, _, channels in recorder.inputs} == {("shaft_speed",), ("radial_load",)}
    assert recorder.inputs[0][1].shaft_speed == 100.0


def test_a_sink_that_cannot_write_is_given_up_and_named_and_the_rest_goes_on(bench):
    one = bench()
    broken, good = ListSink(fails=True), ListSink()
    one.live.sinks.attach("record", broken)
    one.live.sinks.attach("view", good)
    one.run(0.3)
    condition = one.live.condition(one.now_ns)
    assert condition.level is Level.ERROR
    assert any(event.subject == "record" and "no space left" in event.text for event in condition.events)
    assert sum(event.kind.startswith("sink.failed") for event in one.news) == 1
    assert len(good.blocks) > 10 and broken.closed == 1
    one.live.sinks.attach("record", ListSink())
    assert not any(code.startswith("sink.failed") for code in one.codes()), "a new recording ends the trouble"


def test_two_sinks_of_a_name_are_refused_and_an_absent_one_detaches_to_nothing(bench):
    one = bench()
    one.live.sinks.attach("record", ListSink())
    with pytest.raises(ValueError, match="record"):
        one.live.sinks.attach("record", ListSink())
    assert one.live.detach("other") is None


def test_a_solver_that_fails_is_an_error_as_long_as_it_fails(bench):
    one = bench()
    one.run(0.1)
    one.simulation.fails_at = lambda now, inputs: True
    one.run(0.2)
    assert one.live.condition(one.now_ns).level is Level.ERROR and "solver.failed" in one.codes()
    one.simulation.fails_at = lambda now, inputs: False
    one.run(2.3)
    assert "solver.failed" not in one.codes()
    assert {"solver.failed", "solver.recovered"} <= {event.kind for event in one.news}


def test_time_lost_to_a_slow_solver_is_told_with_both_factors(bench):
    simulation = FakeSimulation()
    simulation.seconds_per_tick = 4 * LONGEST_TICK
    one = bench(simulation)
    one.run(1.0)
    condition = one.live.condition(one.now_ns)
    (told,) = [event for event in one.news if event.kind == "pace.lost"]
    assert "of real time, the solver alone would reach" in told.text and "pace.lost" not in one.codes(), "it has happened; nothing is wrong now"
    assert condition.values["time lost [s]"] > 0.2
    assert 0.0 < condition.values["real-time factor held"] < 0.35
    assert 0.0 < condition.values["real-time factor possible"] < 0.35


def test_a_slip_that_flickers_around_its_limit_is_told_once_and_its_rise_to_an_error_again(bench):
    one = bench()
    one.run(0.2)
    slip = iter([0.049, 0.051] * 40)
    observe = one.simulation._observe

    def flickering(now, inputs):
        sample = observe(now, inputs)
        sample["cage_slip"] = next(slip, 0.3)
        return sample

    one.simulation._observe = flickering
    one.news.clear()
    one.run(2.0)
    told = [event.level for event in one.news if event.kind == "bearing.slip"]
    assert told == [Level.WARN, Level.ERROR]


def test_the_worst_event_comes_first(bench):
    one = bench()
    one.live.health.note(Event(0.0, Level.WARN, "a.warning", "", "w"))
    one.live.health.note(Event(0.0, Level.ERROR, "an.error", "", "e"))
    one.live.health.note(Event(0.0, Level.OK, "fine", "", "f"))
    levels = [event.level for event in one.live.condition(START_NS).events]
    assert levels == sorted(levels, reverse=True) and levels[0] is Level.ERROR


@pytest.mark.parametrize("rate", [0.5, 1.0, 30.0, 99.0, 100.0, 250.0, 1000.0, 4321.0])
@pytest.mark.parametrize("publish_rate", [1.0, 50.0, 60.0, 100.0, 200.0, math.inf])
def test_ticks_stay_short_and_make_the_sample_rate_exactly(rate, publish_rate):
    beat = tick_schedule(rate, publish_rate)
    assert 0.5 * SHORTEST_LIMIT < beat.tick <= tick_limit(publish_rate) * (1 + 1e-6)
    assert beat.samples / (beat.tick * beat.every) == pytest.approx(rate, rel=1e-12)


def test_ticks_are_half_a_period_of_the_outputs_between_5_and_10_ms_where_outputs_come_evenly_so():
    assert [tick_limit(rate) for rate in (1.0, 50.0, 62.5, 100.0, 200.0)] == pytest.approx([0.010, 0.010, 0.008, 0.005, 0.005])
    assert (tick_schedule(100.0, 50.0), tick_schedule(100.0, 100.0), tick_schedule(1000.0, 62.5)) == ((0.01, 1, 1), (0.005, 1, 2), (0.008, 8, 1))
    assert tick_schedule(100.0, 40.0).tick == 0.005, "25 ms are no whole number of 10 ms"


def test_ticks_follow_the_publish_rate_and_sinks_get_their_samples_as_before(bench):
    one = bench(publish_rate=100.0)
    sink = ListSink()
    one.live.sinks.attach("view", sink)
    ticks = []
    for rate in (100.0, 50.0, 100.0):
        one.live.publish_at(rate)
        one.run(0.1)
        calls, began = len(one.simulation.calls), one.simulation.time
        one.run(0.5)
        ticks.append((one.simulation.time - began) / (len(one.simulation.calls) - calls))
    assert one.live.close()
    assert ticks == pytest.approx([SHORTEST_LIMIT, LONGEST_TICK, SHORTEST_LIMIT], rel=0.1)
    times = np.concatenate([block["time"] for block in sink.blocks])
    assert np.diff(times) == pytest.approx(0.01, abs=1e-6) or one.live.solver.pace.lost


def test_a_message_that_waited_for_its_thread_is_no_jump_of_the_clock(bench):
    def receiver():
        return START_NS + round((time.monotonic() - began) * 1e9)

    began = time.monotonic()
    one = bench(receiver=receiver)
    one.live.offer("shaft_speed", (100.0,), None, receiver() - 5 * 10**9)
    one.run(0.1)
    assert not [event for event in one.news if event.kind == "clock.jumped"] and one.live.start_ns == START_NS


def test_a_low_sample_rate_thins_what_sinks_get_not_what_the_model_does(bench):
    one = bench(sample_rate=10.0, publish_rate=100.0)
    sink = ListSink()
    one.live.sinks.attach("view", sink)
    one.run(1.0)
    assert one.live.close()
    every = tick_schedule(10.0, 100.0).every
    given = len(sink.blocks) - 1  # after the start; ticks after the last call of collect are nobody's
    assert 1 <= given <= len(one.simulation.calls) // every
    steps = np.diff([block["time"][0] for block in sink.blocks])
    assert np.all(steps > 0.1 - 1e-6)
    assert np.all(steps < 0.1 + 1e-6) or one.live.solver.pace.lost


def test_a_sample_that_is_due_is_told_at_once_so_often_as_asked_for_and_never_while_paused(bench):
    told = []
    one = bench(publish_rate=40.0, due=lambda: told.append(float(one.live.solver.newest["time"])))
    one.run(1.0)
    assert np.median(np.diff(told)) == pytest.approx(0.025, abs=1e-6)
    one.live.publish_at(100.0)
    seen = len(told)
    one.run(0.5)
    assert np.median(np.diff(told[seen:])) == pytest.approx(0.01, abs=1e-6)
    one.live.publish_at(1e4)
    seen = len(told)
    one.run(0.5)
    assert np.median(np.diff(told[seen:])) == pytest.approx(SHORTEST_LIMIT, abs=1e-6), "there is no more than every tick"
    one.live.solver.pause()
    one.run(0.1)
    seen = len(told)
    one.run(0.3)
    assert len(told) == seen
    one.live.solver.pause(False)
    one.run(0.3)
    assert len(told) > seen


def refused(reason, time=0.0, kind="input.malformed", action="message refused, holding 1000 rad/s"):
    return Event(time, Level.ERROR, kind, "shaft_speed", reason, action)


def shown_over(noted, until, step=0.1):
    """Return the texts that hold, at even instants [s], of events noted at theirs."""
    health, waiting, texts = Health(), sorted(noted, key=lambda event: event.time), []
    solver = SimpleNamespace(phase=Phase.RUNNING, failed_ticks=0, dropped=0, newest=None, pace=SimpleNamespace(lost=0.0))
    for now in np.arange(0.0, until, step).tolist():
        while waiting and waiting[0].time <= now:
            health.note(waiting.pop(0))
        (held,) = health.events(now, [], solver) or [None]
        texts.append(None if held is None else held._replace(count=1).text)
    return texts


@pytest.mark.parametrize("reasons", [["nan rad/s is not finite", "inf rad/s is not finite"], ["-3 N", "1e+07 N", "2.5e-3 N"]])
def test_numbers_alone_make_no_other_text_of_a_trouble(reasons):
    texts = shown_over([refused(reasons[k % len(reasons)], 0.05 * k) for k in range(400)], 20.0)
    assert set(texts) == {f"shaft_speed: {reasons[0]}; message refused, holding 1000 rad/s"}


def test_another_reason_is_told_at_once_and_reasons_that_alternate_share_one_text_until_one_of_them_is_over():
    first, second = "no joint 'shaft'", "it has no velocity"
    texts = shown_over([refused((first, second)[k % 2], 0.05 * k) for k in range(400)] + [refused(first, 20.0 + 0.05 * k) for k in range(100)], 25.0)
    runs = [text for before, text in zip([None, *texts], texts) if text != before]
    assert [first in text for text in runs] == [True, False, True], "the newest of both while they alternate"
    assert 29 <= sum(first in text for text in texts) <= 32, "two seconds after the other one was over"


@pytest.mark.parametrize("period, least, most", [(3.0, 1, 1), (9.0, 1, 1), (15.0, 3, 4)])
def test_a_trouble_that_comes_again_within_ten_seconds_is_one_and_not_many(period, least, most):
    texts = shown_over([refused("nan rad/s is not finite", period * k) for k in range(math.ceil(60.0 / period))], 60.0)
    begun = sum(before is None and text is not None for before, text in zip([None, *texts], texts))
    assert least <= begun - (period < 10.0) <= most


def test_what_has_merely_happened_is_news_and_changes_no_status():
    health = Health()
    health.note(Event(1.0, Level.OK, "run.reset", "", "the model returned"))
    health.note(Event(1.1, Level.OK, "run.reset", "", "the model returned"))
    solver = SimpleNamespace(phase=Phase.RUNNING, failed_ticks=0, dropped=0, newest=None, pace=SimpleNamespace(lost=0.0))
    events = health.events(1.2, [], solver)
    assert events == [] and [event.kind for event in health.news(events)] == ["run.reset"]
