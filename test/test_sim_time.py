# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about runs that follow a clock: the same as a replay of the same messages, whatever the clock and the order of topics do."""

import random
import time

import numpy as np
import pytest
from fake_simulation import FakeSimulation
from rosbags.highlevel import AnyReader
from sim_time_bench import RATE, SCENE, START_NS, FalseWall, ListSink, Message, Player, assert_same_samples, course, replayed, write

from bearing_sim.inputs.gate import ClockJumpFilter, Verdict
from bearing_sim.inputs.gate import Message as Aside
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.profile import OnlineInputProfile, is_gap, judge
from bearing_sim.levels.steady import table_builder as store
from bearing_sim.messages import topics
from bearing_sim.messages.events import Level
from bearing_sim.recording.writer import McapSink
from bearing_sim.runtime.health import Phase
from bearing_sim.runtime.replay import replay
from bearing_sim.runtime.sim_time import SimClock, SimTimeModel, Step
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs, Simulation

pytestmark = pytest.mark.timeout(180)
SECONDS = 1.2


class FakeReset(FakeSimulation):
    """The stand-in as `Simulation` is made and reset."""

    def __init__(self, scene=SCENE, inputs=None):
        super().__init__(*([inputs] if inputs is not None else []))
        self.scene, self.counters = scene, (0, 0, 0)


class Run:
    """A model under a false wall clock, its player and what it has recorded."""

    def __init__(self, simulation=None, scene=SCENE, publish_rate=RATE, **options):
        self.wall, self.recordings = FalseWall(), []
        self.model = SimTimeModel(scene, simulation or FakeReset(), RATE, publish_rate, wall=self.wall, **options)
        self.player = Player(self.model, self.wall)
        self.model.open("record", self._record, reopen=True)

    def _record(self, start_ns):
        self.recordings.append(ListSink(start_ns))
        return self.recordings[-1]

    def finish(self):
        """Let the clock's end settle, and the model compute all."""
        self.player.stand(1.0)
        self.player.until_idle()
        return self.recordings[-1]

    def events(self):
        return {event.kind: event for event in self.model.condition(self.player.now_ns).events}

    def values(self):
        return self.model.condition(self.player.now_ns).values


@pytest.fixture
def make():
    """Return a function that makes runs; all are closed at the end."""
    runs = []

    def made(*given, **named):
        runs.append(Run(*given, **named))
        return runs[-1]

    yield made
    for run in runs:
        assert run.model.close()


def ticks(end, step, begin=0.0):
    return [*np.arange(begin, end, step).tolist(), end]


@pytest.fixture(scope="module")
def manoeuvre(tmp_path_factory):
    """Messages, and what an offline replay of them writes."""
    messages = course(SECONDS, cage=True)
    return messages, replayed(write(tmp_path_factory.mktemp("log") / "log.mcap", messages))


@pytest.mark.parametrize("step, pace", [(0.01, 0.1), (0.1, 1.0), (2.0, 20.0)])
def test_any_pace_of_the_clock_and_any_order_of_topics_give_what_a_replay_gives_to_the_last_bit(make, manoeuvre, step, pace):
    messages, expected = manoeuvre
    run = make(Simulation(SCENE))
    run.model.note_publishers("oil_temperature", 1)
    run.player.play(messages, ticks(SECONDS, step), random.Random(3), pace)
    got = run.finish()
    assert_same_samples(got.samples, expected.samples)
    assert len(got.samples) == 59 and got.start_ns == expected.start_ns == START_NS + 7_100_000
    assert got.inputs == expected.inputs
    np.testing.assert_array_equal(got.measurements, expected.measurements)
    assert len(got.clearances) == 6 and got.clearances == expected.clearances
    assert len(got.measurements) == 12 and run.values()["late inputs"] == 0 and run.values()["messages refused"] == 0


@pytest.mark.parametrize("heat", ["{law: given}", "{law: network, interval: 50 ms}"])
def test_measured_temperatures_that_die_and_return_give_what_a_replay_gives_to_the_last_bit(make, tmp_path, heat):
    """A sensor counts as dead 0.2 s after its last message: the inner ring's does from 0.6 to 0.9 s."""
    scene = load_scene("deng2017_table1", [f"heat={heat}", "input_limits.stale_after=20 ms"])
    times = [0.02, 0.1, 0.2, 0.3, 0.4, 0.9, 1.0, 1.1]
    measured = [Message(time + 0.0003, "inner_ring_temperature", (395.0 + 20.0 * time,)) for time in times]
    measured += [Message(0.1 * k + 0.0007, "outer_ring_temperature", (394.0,)) for k in range(12)]
    messages = sorted([*course(SECONDS), *measured])
    expected = replayed(write(tmp_path / "log.mcap", messages), scene)
    run = make(Simulation(scene), scene)
    for channel in topics.TEMPERATURES:
        run.model.note_publishers(channel, 1)
    run.player.play(messages, ticks(SECONDS, 0.1), random.Random(3))
    got = run.finish()
    assert_same_samples(got.samples, expected.samples)
    assert got.inputs == expected.inputs
    known = {round((ns - START_NS) * 1e-9, 2): float(sample["inner_ring_temperature_measured"]) for ns, sample in got.samples.items()}
    dead = {time for time, kelvin in known.items() if np.isnan(kelvin)}
    assert {time for time in known if 0.61 < time < 0.89} <= dead and not {time for time in known if 0.01 < time < 0.59 or time > 0.91} & dead
    rings = {float(sample["inner_ring_temperature"]) for sample in got.samples.values()}
    assert len(rings) > 5, "the model follows what is measured"
    kinds = {event.kind for event in expected.events}
    assert {"input.stale", "input.returned"} <= kinds and "input.unused" not in kinds


def test_a_pause_of_the_clock_and_of_the_model_and_a_machine_that_lags_change_nothing(make, manoeuvre):
    messages, expected = manoeuvre
    run = make(Simulation(SCENE))
    run.model.note_publishers("oil_temperature", 1)
    rest = run.player.play(messages, ticks(0.5, 0.05))
    run.player.stand(60.0)
    assert "clock.stands_still" in run.events() and "input.stale" not in run.events(), "paused is not stale"
    run.player.until_idle()
    run.model.solver.pause()
    rest = run.player.play(rest, ticks(0.9, 0.05, 0.5))
    run.player.stand(5.0)
    run.player.until(lambda: "run.paused" in run.events(), "the solver has seen the pause")
    assert float(run.values()["behind the clock [s]"]) == pytest.approx(0.4, abs=0.05)
    run.model.solver.pause(False)
    run.player.play(rest, ticks(SECONDS, 0.05, 0.9))
    assert_same_samples(run.finish().samples, expected.samples)


def test_a_reset_in_a_pause_acts_at_once_and_does_not_end_the_pause(make, manoeuvre):
    simulation = FakeReset()
    simulation.seconds_per_tick = 0.02
    run = make(simulation)
    solver, computed = run.model.solver, simulation.calls
    run.model.note_publishers("oil_temperature", 1)
    run.player.play(manoeuvre[0], ticks(SECONDS, 0.3))
    run.player.until(lambda: len(computed) > 3, "the model is amid a segment")
    assert solver.hold() and solver.busy_for == 0.0
    held = len(computed)
    assert run.model.reset() and len(simulation.resets) == 3, "at first, at the start of the profile, and now"
    time.sleep(0.1)
    assert solver.phase is Phase.PAUSED and len(computed) == held
    solver.pause(False)
    assert len(run.finish().samples) == 59, "none is lost, and none computed twice"


def test_level_steady_goes_its_course_through_operating_points_as_in_a_replay(make, tmp_path, monkeypatch):
    monkeypatch.setattr(store, "FOLDER", tmp_path)  # both solve: a table that another process makes meanwhile would serve only one of them
    scene, messages = load_scene("deng2017_table1", ["level=steady"]), course(SECONDS)
    expected = replayed(write(tmp_path / "log.mcap", messages), scene)
    run = make(Simulation(scene), scene)
    run.model.note_publishers("oil_temperature", 1)
    run.player.play(messages, ticks(SECONDS, 0.1), random.Random(3))
    got = run.finish().samples
    assert_same_samples(got, expected.samples)
    assert len({float(sample["cage_slip"]) for sample in got.values()}) > 50, "the slip follows the inputs"


def test_a_recording_replayed_twice_is_equal_to_the_byte_in_every_message_and_log_time(tmp_path):
    path = write(tmp_path / "log.mcap", course(SECONDS, cage=True))
    judged = judge(read_input_log(path), SCENE.accepted_inputs, Inputs(0.0, 0.0, 0.0, SCENE.lubricant.temperature))
    found = []
    for name in ("first", "second"):
        with McapSink(tmp_path / f"{name}.mcap", SCENE, judged.start_ns) as recording:
            replay(SCENE, judged, recording, rate=RATE)
        with AnyReader([tmp_path / f"{name}.mcap"]) as reader:
            found.append([(connection.topic, time, bytes(data)) for connection, time, data in reader.messages()])
    assert found[0] == found[1]
    assert {topic for topic, _, _ in found[0]} >= {"/cage_slip", "/damage", "/diagnostics", "/cage_slip_residual", "/oil_temperature"}


def test_only_what_is_known_is_computed_and_the_model_waits_for_a_load_that_stops(make):
    run = make()
    messages = [message for message in course(4.0, oil=False) if message.channel == "shaft_speed" or message.stamp < 1.0]
    run.player.play(messages, ticks(4.0, 0.1))
    run.player.stand(3.0)
    got = run.finish()
    last_load = max(message.stamp_ns for message in messages if message.channel == "radial_load")
    assert last_load - 1e9 / RATE < max(got.samples) <= last_load
    stale = run.events()["input.stale"]
    assert stale.text == "radial_load: no good message for longer than 1 s; the model waits where it is"
    assert run.values()["radial_load last good message [s ago]"] == pytest.approx(3.01, abs=0.02)
    assert run.values()["waits for"] == "radial_load"


def test_time_without_messages_is_a_gap_as_in_a_replay_however_long(make, tmp_path):
    year = 3.2e7
    messages = [*course(1.0, oil=False), *course(1.0, 10.0, oil=False), *course(1.0, year, oil=False)]
    expected = replayed(write(tmp_path / "log.mcap", messages), model=FakeReset)
    run = make()
    run.player.play(messages, [*ticks(1.0, 0.1), *ticks(11.0, 0.1, 10.0), *ticks(year + 1.0, 0.1, year)])
    assert {"clock.leapt_ahead", "input.gap"} <= {event.kind for event in run.player.news}
    got = run.finish()
    assert list(got.samples) == list(expected.samples) and len(got.samples) < 160
    assert got.samples[max(got.samples)]["shaft_angle"] == expected.samples[max(got.samples)]["shaft_angle"]
    assert run.values()["gaps"] == 4


def test_clock_that_jumps_back_begins_anew_with_a_recording_of_its_own(make, manoeuvre):
    messages, expected = manoeuvre
    run = make(Simulation(SCENE))
    run.model.note_publishers("oil_temperature", 1)
    for _ in range(2):
        run.player.play(messages, ticks(SECONDS, 0.1))
        run.finish()
    assert [event.level for event in run.player.news if event.kind == "clock.jumped_back"] == [Level.WARN]
    assert len(run.recordings) == 2 and run.recordings[0].closed
    assert_same_samples(run.recordings[1].samples, expected.samples)
    assert_same_samples(run.recordings[0].samples, expected.samples)
    assert run.values()["messages refused"] == 0


def test_messages_around_a_jump_back_may_come_on_its_wrong_side(make, tmp_path):
    messages = course(SECONDS, oil=False)
    expected = replayed(write(tmp_path / "log.mcap", messages), model=FakeReset)
    run = make()
    late = [message for message in messages if message.stamp > 1.15]
    run.player.play(messages[: -len(late)], ticks(1.15, 0.1))
    early = [message for message in messages if message.stamp < 0.2]
    for message in early:
        run.player.offer(message)
    run.player.tick(0.0)
    for message in late:
        run.player.offer(message)
    run.player.play(messages[len(early) :], ticks(SECONDS, 0.1, 0.2))
    got = run.finish()
    assert_same_samples(got.samples, expected.samples)
    assert run.model.gate.refused == {"input.leftover": len(late)}


def test_a_reading_is_settled_half_a_second_later_and_what_is_missing_is_told_after_two():
    watch = SimClock(tolerance=0.0)
    assert watch.read(100, wall=10.0) is Step.FIRST and watch.read(100, wall=10.1) is None
    assert (watch.settled(10.49), watch.settled(10.51), watch.overdue(11.99), watch.overdue(12.01)) == (-1, 100, -1, 100)
    assert not watch.stands_still(10.99) and watch.stands_still(11.01)
    assert watch.read(50, wall=13.0) is Step.BACK and watch.settled(13.4) == watch.overdue(13.4) == -1, "readings from before the jump say nothing"


def test_nothing_is_known_beyond_the_clock_though_messages_are_stamped_later():
    known = OnlineInputProfile(RATE, SCENE.accepted_inputs, 390.0)
    for channel, value in (("shaft_speed", 100.0), ("radial_load", (800.0, 0.0))):
        for stamp in (100, 1000):
            known.add_message(channel, stamp, value)
    assert [known.known_until(clock, clock, []) for clock in (500, 1000, 2000)] == [500, 1000, 1000]


def test_of_messages_set_aside_a_jump_takes_those_nearer_to_where_the_clock_has_gone():
    sorter, newest = ClockJumpFilter(), {"shaft_speed": 1000, "radial_load": 900}
    early, faulty = Aside("shaft_speed", (1.0,), 120), Aside("radial_load", (1.0, 0.0), 890)
    assert [sorter.sort(message, newest[message.channel], wall=0.0) for message in (early, faulty)] == [Verdict.SET_ASIDE, Verdict.SET_ASIDE]
    assert sorter.jump(100, newest) == [early], "the other was faulty before the jump, and belongs to no course"
    assert sorter.expired(wall=10.0) == []


@pytest.mark.parametrize("back", [1e-6, 0.005, 0.05, 0.099])
@pytest.mark.parametrize("jump_back", ["reset", "error"])
def test_a_clock_that_steps_back_by_less_than_the_tolerance_changes_nothing(make, manoeuvre, back, jump_back):
    messages, expected = manoeuvre
    run = make(Simulation(SCENE), jump_back=jump_back)
    run.model.note_publishers("oil_temperature", 1)
    course_of_clock = [time for tick in ticks(SECONDS, 0.1) for time in (tick, tick - back if tick > back else tick, tick)]
    run.player.play(messages, course_of_clock)
    got = run.finish()
    assert_same_samples(got.samples, expected.samples)
    assert len(run.recordings) == 1 and run.values()["clock: readings a little earlier than the latest"] == 12
    assert "clock.jumped_back" not in {event.kind for event in run.player.news}


@pytest.mark.parametrize("steps, resets", [([0.1], 1), ([0.2], 1), ([0.06, 0.06], 1), ([0.06, -0.07, 0.06], 0)])
def test_a_step_back_from_the_tolerance_on_is_a_jump_and_small_ones_count_together_until_the_clock_has_passed(make, steps, resets):
    run, now = make(), 1.0
    run.player.play(course(1.0, oil=False), ticks(1.0, 0.1))
    for step in steps:
        now -= step
        run.player.play([], [now])
    assert [event.kind for event in run.player.news].count("clock.jumped_back") == resets


@pytest.mark.parametrize("tolerance, resets", [(0.0, 1), (0.005, 1), (0.006, 0), (1.0, 0)])
def test_the_tolerance_of_steps_back_can_be_set(make, tolerance, resets):
    run = make(clock_tolerance=tolerance)
    run.player.play(course(1.0, oil=False), [*ticks(1.0, 0.1), 0.995])
    assert [event.kind for event in run.player.news].count("clock.jumped_back") == resets


def test_after_a_jump_back_the_bearing_is_judged_anew(make):
    run = make(scene=load_scene("deng2017_table1", ["thresholds.slip_warning=0.5 %"]))
    messages = course(SECONDS, oil=False)
    run.player.play(messages, ticks(SECONDS, 0.1))
    run.finish()
    assert "bearing.slip" in run.events()
    run.player.offer(Message(SECONDS + 0.1, "shaft_speed", (float("nan"),)))
    run.player.play([message for message in messages if message.stamp <= 0.3], ticks(0.3, 0.1))
    run.finish()
    assert len(run.recordings) == 2 and "bearing.slip" not in run.events(), "it has not held for its hold time yet"
    assert run.model.gate.refused == {"input.not_finite": 1}, "what was refused stays counted"


def test_clock_that_jumps_back_is_an_error_where_that_is_asked_for_and_ends_when_it_has_passed(make, tmp_path):
    messages = course(SECONDS, oil=False)
    expected = replayed(write(tmp_path / "log.mcap", messages), model=FakeReset)
    run = make(jump_back="error")
    first, rest = [m for m in messages if m.stamp <= 0.8], [m for m in messages if m.stamp > 0.8]
    run.player.play(first, ticks(0.8, 0.1))
    run.player.until_idle()
    held = run.model.solver.newest["time"]
    run.player.play([m for m in messages if 0.3 < m.stamp <= 0.7], ticks(0.7, 0.1, 0.3))
    run.player.stand(2.0)
    event = run.events()["clock.jumped_back"]
    assert event.level == Level.ERROR and "the clock jumped back" in event.text and "passed 1700000000.800 s" in event.text
    assert run.model.solver.newest["time"] == held
    assert run.model.gate.refused["input.time_backwards"] > 10, "none is used silently"
    run.player.play(rest, ticks(SECONDS, 0.1, 0.8))
    got = run.finish()
    assert "clock.jumped_back" not in run.events() and len(run.recordings) == 1
    assert_same_samples(got.samples, expected.samples)


def test_reset_ends_the_error_of_a_jump_back_and_begins_anew(make, tmp_path):
    messages = course(SECONDS, oil=False)
    later = [message for message in messages if message.stamp > 0.3]
    expected = replayed(write(tmp_path / "log.mcap", later), model=FakeReset)
    run = make(jump_back="error")
    run.player.play([m for m in messages if m.stamp <= 0.8], ticks(0.8, 0.1))
    run.finish()
    run.player.play(later, ticks(0.5, 0.1, 0.3))
    assert run.events()["clock.jumped_back"].level == Level.ERROR
    assert run.model.reset()
    rest = [message for message in later if message.stamp > 0.5]
    run.player.play(rest, ticks(SECONDS, 0.1, 0.5))
    got = run.finish()
    assert "clock.jumped_back" not in run.events() and len(run.recordings) == 2
    assert_same_samples(got.samples, expected.samples)


def test_late_oil_temperature_is_refused_counted_and_told(make):
    run = make()
    messages = course(SECONDS, oil=False)
    run.player.play(messages, ticks(1.0, 0.1))
    run.finish()
    run.player.offer(Message(0.5, "oil_temperature", (350.0,)))
    run.player.collect()
    assert run.values()["late inputs"] == 1 and run.values()["refused: input.late"] == 1
    event = run.events()["input.late"]
    assert event.level == Level.WARN and event.text.startswith("oil_temperature: stamped 1700000000.500000 s, which the model has passed by")
    got = run.recordings[-1]
    assert {float(sample["oil_temperature"]) for sample in got.samples.values()} == {SCENE.lubricant.temperature}


def test_without_a_clock_nothing_is_computed_and_that_is_said(make):
    run = make()
    for message in course(0.5):
        run.player.offer(message)
    run.wall.now += 10.0
    run.player.collect()
    event = run.events()["clock.absent"]
    assert event.level == Level.WARN and "/clock" in event.text
    assert run.model.solver.newest is None and run.values()["phase"] == "waiting for the first input"
    run.player.tick(0.5)
    run.finish()
    assert "clock.absent" not in run.events() and run.model.solver.newest["time"] > 0.4


def test_outputs_are_published_at_their_stamps_at_the_publish_rate(make):
    run = make(publish_rate=10.0)
    run.player.play(course(SECONDS, oil=False), ticks(SECONDS, 0.3))
    start = run.finish().start_ns
    assert [round((one.stamp_ns - start) * 1e-9, 9) for one in run.model.published()] == [round(0.1 * k, 9) for k in range(1, 12)]
    assert run.model.published() == []


def test_a_machine_too_slow_loses_nothing_and_says_how_far_behind_it_is(make, tmp_path):
    messages = course(SECONDS, oil=False)
    expected = replayed(write(tmp_path / "log.mcap", messages), model=FakeReset)
    slow = FakeReset()
    slow.seconds_per_tick = 0.01
    run = make(slow)
    run.player.play(messages, ticks(SECONDS, 0.4), pace=20.0)
    run.player.stand(1.0, 1)
    run.player.until(lambda: run.model.solver.busy_for >= 0.0 and run.model.solver.reached is not None, "it has begun")
    run.wall.now += 3.0
    event = run.events()["run.behind"]
    assert event.level == Level.WARN and "behind the clock and catches up; nothing is lost" in event.text
    run.player.until_idle()
    assert_same_samples(run.recordings[-1].samples, expected.samples)
    assert "run.behind" not in run.events()


def test_model_that_cannot_go_on_is_given_up_as_in_a_replay_and_a_reset_revives_it(make):
    broken = FakeReset()
    broken.fails_at = lambda time, inputs: time > 0.3
    run = make(broken)
    messages = course(2.0, oil=False)
    rest = run.player.play(messages, ticks(1.5, 0.1))
    run.finish()
    assert run.events()["run.given_up"].level == Level.ERROR and "10 stretches in a row" in run.events()["run.given_up"].text
    broken.fails_at = lambda time, inputs: False
    assert run.model.reset()
    run.player.play(rest, ticks(2.0, 0.1, 1.5))
    got = run.finish()
    run.player.stand(3.0)
    assert "run.given_up" not in run.events() and (max(got.samples) - START_NS) * 1e-9 > 1.9


def test_gaps_are_told_by_the_spacings_so_far():
    limits, second = SCENE.accepted_inputs, 1_000_000_000
    assert is_gap([second // 10] * 5 + [2 * second], limits)
    assert not is_gap([second // 10] * 5 + [second // 2], limits), "no spacing that is not stale is one"
    assert not is_gap([10 * second] * 5 + [90 * second], limits)
    assert not is_gap([60 * second], limits) and is_gap([5000 * second], limits), "a first one an hour long at most"
    assert is_gap([second, 7 * second], limits, longest_gap=5.0) and not is_gap([second // 10, 3 * second], limits, longest_gap=5.0)


def test_replay_compares_the_measured_cage_of_the_log_at_its_own_stamps(manoeuvre):
    messages, expected = manoeuvre
    by_stamp = {message.stamp_ns: message.values[0] for message in messages if message.channel == topics.MEASURED}
    assert [stamp for stamp, _, _ in expected.measurements] == [stamp for stamp in by_stamp if stamp >= expected.start_ns][
        : len(expected.measurements)
    ]
    stamps = np.array(list(expected.samples))
    slips = np.array([sample["cage_slip"] for sample in expected.samples.values()])
    ideal = np.array([sample["ideal_cage_speed"] for sample in expected.samples.values()])
    for stamp, speed, residual in expected.measurements[2:]:
        assert speed == by_stamp[stamp]
        assert residual == pytest.approx(1.0 - speed / np.interp(stamp, stamps, ideal) - np.interp(stamp, stamps, slips), abs=1e-6)


def test_replay_holds_slip_for_its_hold_time_before_it_is_told(tmp_path):
    scene = load_scene("deng2017_table1", ["thresholds.slip_warning=0.5%", "thresholds.slip_error=50%", "thresholds.slip_hold.raise_after=0.4s"])
    sink = replayed(write(tmp_path / "log.mcap", course(SECONDS, oil=False)), scene, model=FakeReset)
    (event,) = [event for event in sink.events if event.kind == "bearing.slip"]
    assert event.time == pytest.approx(0.42) and event.level == Level.WARN


def test_oil_temperature_can_be_set_again_and_again_and_no_set_counts_as_a_message(make):
    run, messages = make(), course(SECONDS, oil=False)
    rest = run.player.play(messages, ticks(0.4, 0.1))
    run.finish()
    run.model.set_oil_temperature(350.0, run.player.now_ns)
    rest = run.player.play(rest, ticks(0.8, 0.1, 0.4))
    run.finish()
    run.model.set_oil_temperature(340.0, run.player.now_ns)
    run.player.play(rest, ticks(SECONDS, 0.1, 0.8))
    got = run.finish().samples
    found = {round((ns - START_NS) * 1e-9, 3): float(sample["oil_temperature"]) for ns, sample in got.items()}
    assert {value for time, value in found.items() if time < 0.39} == {SCENE.lubricant.temperature}
    assert {value for time, value in found.items() if 0.41 < time < 0.79} == {350.0}
    assert {value for time, value in found.items() if time > 0.81} == {340.0}
    assert run.model.gate.accepted["oil_temperature"] == 0, "the topic has given none"


def test_oil_temperature_set_before_the_first_clock_holds_from_the_start(make):
    run = make()
    run.model.set_oil_temperature(350.0, 0)
    run.player.play(course(0.5, oil=False), ticks(0.5, 0.1))
    assert {float(sample["oil_temperature"]) for sample in run.finish().samples.values()} == {350.0}
