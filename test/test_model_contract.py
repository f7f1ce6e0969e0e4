# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What every model does, in wall time and in simulated time alike: one list of claims, run over both."""

import itertools
import math
import time

import pytest
from fake_simulation import FakeSimulation
from sim_time_bench import START_NS, FalseWall
from support import ListSink

from bearing_sim.inputs.gate import Sources
from bearing_sim.messages.diagnostics import report
from bearing_sim.messages.events import Level
from bearing_sim.runtime.health import Phase
from bearing_sim.runtime.live import LiveModel
from bearing_sim.runtime.sim_time import SimTimeModel
from bearing_sim.scene.loader import load_scene

pytestmark = pytest.mark.timeout(120)
PATIENCE = 30.0  # [s]
STEP = 0.02  # [s] between messages
OVERRIDES = ["input_limits.minimum_rate=0Hz", "input_limits.stale_after=0.5s", "input_limits.reverse_rotation=false"]
# batches of 20 ms and a second of learning: in wall time the test's time is real
QUICK = "thresholds.residual={batch: 20 ms, learning: 1 s, settling: 50 ms, memory: 500 ms, false_alarm_time: 1 h, tolerance: 0.1 %}"
SCENE = load_scene("deng2017_table1", [*OVERRIDES, QUICK])


def times(sink):
    return [time for block in sink.with_start for time in block["time"].tolist()]


class Driver:
    """Sends messages to a model at even intervals and collects, until something holds or for a while of run time."""

    def __init__(self, scene=SCENE):
        self.scene, self.simulation, self.news, self.output = scene, FakeSimulation(), [], []
        self.simulation.scene, self.simulation.counters = scene, (0, 0, 0)
        self.speed, self.cage, self.rings = 100.0, None, {}

    def step(self, drive=True):
        """Let one interval pass, with messages of speed, load and, where set, the cage and the temperatures of the rings."""
        self.wait()
        if drive:
            self.model.offer("shaft_speed", (self.speed,), self.now_ns, self.now_ns)
            self.model.offer("radial_load", (800.0, 0.0), self.now_ns, self.now_ns)
            if self.cage is not None:
                self.model.offer("cage_speed_measured", (self.cage,), self.now_ns, self.now_ns)
            for channel, kelvin in self.rings.items():
                self.model.offer(channel, (kelvin,), self.now_ns, self.now_ns)
        self.news += self.model.collect(self.now_ns)
        self.output += self.model.published()

    def until(self, condition, drive=True):
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, f"waited in vain; {self.model.condition(self.now_ns)}"
            self.step(drive)

    def run(self, seconds, drive=True):
        end = self.now_ns + round(seconds * 1e9)
        self.until(lambda: self.now_ns >= end, drive)

    def condition(self):
        return self.model.condition(self.now_ns)

    def kinds(self):
        return {event.kind for event in self.condition().events}

    def newest(self, name):
        sample = self.model.solver.newest
        return math.nan if sample is None else float(sample[name])


class WallDriver(Driver):
    """Of a model in wall time."""

    def __init__(self, scene=SCENE, **options):
        super().__init__(scene)
        self.began = time.monotonic()
        self.model = LiveModel(scene, self.simulation, START_NS, **options)

    @property
    def now_ns(self):
        return START_NS + round((time.monotonic() - self.began) * 1e9)

    def wait(self):
        time.sleep(STEP)


class SimDriver(Driver):
    """Of a model in simulated time, whose clock goes as fast as the model follows."""

    def __init__(self, scene=SCENE, **options):
        super().__init__(scene)
        self.wall, self.now_ns = FalseWall(), 0
        self.model = SimTimeModel(scene, self.simulation, wall=self.wall, **options)

    def wait(self):
        self.now_ns = (self.now_ns or START_NS) + round(STEP * 1e9)
        self.wall.now += STEP
        time.sleep(0.001)


@pytest.fixture(params=[WallDriver, SimDriver], ids=["wall time", "simulated time"])
def make(request):
    """Return a function that makes drivers; their models are closed at the end."""
    drivers = []

    def made(*given, **named):
        drivers.append(request.param(*given, **named))
        return drivers[-1]

    yield made
    for driver in drivers:
        driver.simulation.seconds_per_tick = 0.0
        assert driver.model.close()


def test_it_waits_for_the_first_speed_and_runs_from_then_on(make):
    one = make()
    one.step(drive=False)
    assert one.model.solver.newest is None and "run.waiting" in one.kinds()
    one.until(lambda: one.newest("time") > 0.2)
    assert one.model.solver.phase is Phase.RUNNING and "run.waiting" not in one.kinds()
    assert one.newest("shaft_speed") == 100.0 and one.newest("load_y") == 800.0


def test_a_refused_message_is_counted_reported_and_leaves_the_inputs_as_they_were(make):
    one = make()
    one.until(lambda: one.newest("time") > 0.1)
    for _ in range(3):
        one.wait()
        event = one.model.offer("shaft_speed", (-1.0,), one.now_ns, one.now_ns)
        assert event.key == ("input.negative", "shaft_speed") and event.level is Level.ERROR
    unread = one.model.refuse("radial_load", "input.malformed", "3 bytes", one.now_ns)
    assert unread.key == ("input.malformed", "radial_load")
    condition = one.condition()
    assert condition.values["refused: input.negative"] == 3 and condition.values["messages refused"] == 4
    assert next(event for event in condition.events if event.kind == "input.negative").count == 3
    one.run(0.2)
    assert one.newest("shaft_speed") == 100.0
    assert [event.kind for event in one.news if event.kind.startswith("input.")] == ["input.negative", "input.malformed"]


def test_two_publishers_whose_values_jump_to_and_fro_are_an_error_and_of_the_same_value_a_warning(make):
    one = make()
    one.model.note_publishers("shaft_speed", 2)
    one.run(0.6)
    (event,) = [event for event in one.condition().events if event.kind == "input.publishers"]
    assert event.level is Level.WARN and event.subject == "shaft_speed"
    speeds = itertools.cycle([100.0, 150.0])
    for _ in range(20):
        one.speed = next(speeds)
        one.step()
    (event,) = [event for event in one.condition().events if event.kind == "input.publishers"]
    assert event.level is Level.ERROR and one.condition().values["shaft_speed jumps between"] == "100 rad/s and 150 rad/s"
    one.model.note_publishers("shaft_speed", 1)
    assert "input.publishers" not in one.kinds()


def test_the_oil_temperature_can_be_set_any_number_of_times_and_is_recorded(make):
    one = make()
    one.model.open("record", ListSink)
    one.model.set_oil_temperature(350.0, one.now_ns)
    one.until(lambda: one.newest("oil_temperature") == 350.0)
    for temperature in (340.0, 330.0, 345.0):
        one.model.set_oil_temperature(temperature, one.now_ns)
        one.until(lambda temperature=temperature: one.newest("oil_temperature") == temperature)
    assert one.model.gate.accepted["oil_temperature"] == 0, "the topic has given none"
    one.run(0.2)
    sink = one.model.detach("record")
    recorded = [inputs.oil_temperature for _, inputs, channels in sink.inputs if "oil_temperature" in channels]
    assert [temperature for temperature in recorded if temperature != 350.0] == [340.0, 330.0, 345.0]
    one.wait()
    assert one.model.offer("oil_temperature", (360.0,), one.now_ns, one.now_ns) is None
    one.until(lambda: one.newest("oil_temperature") == 360.0)
    assert one.model.gate.accepted["oil_temperature"] == 1


@pytest.mark.parametrize("law, stands_in", [("given", "given in the scene"), ("network", "the thermal network")])
def test_a_ring_temperature_that_dies_falls_back_says_so_and_returns(make, law, stands_in):
    one = make(scene=load_scene("deng2017_table1", [*OVERRIDES, "input_limits.stale_after=60 ms", f"heat.law={law}"]))
    one.model.note_publishers("inner_ring_temperature", 1)
    one.rings = {"inner_ring_temperature": 380.0}
    one.until(lambda: one.newest("inner_ring_temperature_measured") == 380.0)
    assert math.isnan(one.newest("outer_ring_temperature_measured")), "each is optional"
    one.rings = {}
    one.until(lambda: math.isnan(one.newest("inner_ring_temperature_measured")))
    one.until(lambda: ("input.stale", "inner_ring_temperature") in {event.key for event in one.news})
    (stale,) = [event for event in one.condition().events if event.key == ("input.stale", "inner_ring_temperature")]
    assert stale.level is Level.WARN and stands_in in stale.action
    assert one.newest("shaft_speed") == 100.0, "the model runs on"
    one.rings = {"inner_ring_temperature": 385.0}
    one.until(lambda: one.newest("inner_ring_temperature_measured") == 385.0)
    one.until(lambda: "input.returned" in {event.kind for event in one.news})
    one.run(0.1)
    assert ("input.stale", "inner_ring_temperature") not in {event.key for event in one.condition().events}
    assert [event.kind for event in one.news if event.subject == "inner_ring_temperature"].count("input.returned") == 1


def test_a_publisher_of_a_ring_temperature_is_told_that_a_scene_without_a_law_of_heat_does_not_read_it(make):
    one = make()
    one.model.note_publishers("outer_ring_temperature", 1)
    one.run(0.3)
    (unused,) = [event for event in one.condition().events if event.kind == "input.unused"]
    assert unused.subject == "outer_ring_temperature" and unused.level is Level.WARN and "heat.law" in unused.reason
    one.model.note_publishers("outer_ring_temperature", 0)
    assert "input.unused" not in one.kinds()


TOPIC, JOINTS, FLOAT = "/m/shaft_speed", "sensor_msgs/msg/JointState", "std_msgs/msg/Float64"


@pytest.mark.parametrize(
    "sources, kind, words",
    [
        (Sources(TOPIC, JOINTS, 0), "input.absent", ["nobody publishes /m/shaft_speed (sensor_msgs/msg/JointState)", "remap the topic"]),
        (Sources(TOPIC, JOINTS, 0, alternatives=("/m/speed",)), "input.absent", ["nobody publishes", "the type is published on /m/speed"]),
        (Sources(TOPIC, JOINTS, 1), "input.absent", ["has a publisher that sends nothing", "ros2 topic echo /m/shaft_speed"]),
        (Sources(TOPIC, JOINTS, 0, other_types=(FLOAT,)), "input.type", [FLOAT, JOINTS, "set input_type to scalar"]),
        (Sources(TOPIC, FLOAT, 0, other_types=(JOINTS,)), "input.type", [FLOAT, JOINTS, "or remap the topic"]),
        (Sources(TOPIC, JOINTS, 0, misfits=("Best effort publisher and reliable subscription",)), "input.qos", ["Best effort publisher"]),
        (None, "input.absent", ["no good message within 0.2 s"]),
    ],
)
def test_an_input_that_cannot_be_monitored_is_a_warning_with_its_topic_the_cause_and_what_to_do_in_one_text(make, sources, kind, words):
    one = make(inputs_expected_within=0.2)
    if sources is not None:
        one.model.note_sources("shaft_speed", sources)
    one.step(drive=False)
    at_once = [event.key for event in one.condition().events if event.level]
    assert at_once == ([] if kind == "input.absent" or one.now_ns is None else [(kind, "shaft_speed")])
    one.run(0.25, drive=False)
    texts = set()
    for _ in range(4):
        one.run(0.04, drive=False)
        texts |= {event.text for event in one.condition().events if event.key == (kind, "shaft_speed") and event.level is Level.WARN}
    (text,) = texts
    assert all(word in text for word in words), text
    assert ("input.absent", "radial_load") in {event.key for event in one.condition().events}, "nothing is known of its topic"
    one.run(0.1)
    assert not {"input.absent", "input.stale"} & one.kinds(), "good messages come"


def test_an_optional_input_is_missed_only_where_somebody_publishes_it(make):
    one = make(inputs_expected_within=0.2)
    one.model.note_sources("cage_speed_measured", Sources("/cage_speed_measured", JOINTS, 0))
    one.step()
    one.run(0.4)
    assert "input.absent" not in one.kinds() and "cage_speed_measured" in one.condition().unused
    one.model.note_sources("cage_speed_measured", Sources("/cage_speed_measured", JOINTS, 1))
    one.run(0.1)
    (absent,) = [event for event in one.condition().events if event.kind == "input.absent"]
    assert absent.subject == "cage_speed_measured" and "nothing is compared" in absent.action and absent.level is Level.WARN
    assert "cage_speed_measured" not in one.condition().unused


def test_each_status_has_one_text_as_long_as_the_state_does_not_change_whatever_the_numbers_do(make):
    one = make(inputs_expected_within=0.2)
    speeds, texts, statuses = itertools.count(100), {}, set()
    one.model.note_publishers("shaft_speed", 2)
    for turn in range(60):
        one.speed = 100.0 + 0.3 * (next(speeds) % 7) if turn % 3 else -1.0
        one.step()
        condition = one.condition()
        made = report(0, condition.events, condition.values, "n", "", condition.remarks, condition.otherwise, condition.unused)["status"]
        statuses.add(len(made))
        if turn > 40:
            for status in made:
                texts.setdefault(status["name"], set()).add(status["message"])
    assert {name: said for name, said in texts.items() if len(said) != 1} == {}
    (unused,) = texts["n: unused"]
    assert unused.startswith("not used: ") and "inner_ring_temperature" in unused and len(texts) <= 16 and max(statuses) == len(texts)


def test_thresholds_can_be_changed_in_mid_run(make):
    one = make()
    one.run(0.8)
    assert "bearing.slip" not in one.kinds()
    one.model.adjust(load_scene("deng2017_table1", [*OVERRIDES, QUICK, "thresholds.slip_warning=0.5 %"]).thresholds)
    one.until(lambda: "bearing.slip" in one.kinds())
    assert sum(event.kind == "bearing.slip" for event in one.news) <= 1


def test_a_reset_returns_damage_to_the_start_and_is_reported(make):
    one = make()
    one.until(lambda: one.newest("damage") > 1e-8)
    assert one.model.reset()
    one.until(lambda: any(event.kind == "run.reset" for event in one.news))
    assert len(one.simulation.resets) >= 2 and one.newest("damage") < 1e-8 * (1 + one.now_ns)
    assert one.simulation.angle < 100.0 * (one.now_ns - START_NS) * 1e-9


def test_a_pause_holds_the_model_and_a_reset_works_meanwhile(make):
    one = make()
    one.until(lambda: one.newest("time") > 0.1)
    one.model.pause()
    one.until(lambda: one.model.solver.phase is Phase.PAUSED)
    calls = len(one.simulation.calls)
    one.run(0.3)
    assert len(one.simulation.calls) == calls and "run.paused" in one.kinds()
    assert one.model.reset()
    one.until(lambda: one.model.solver.phase is Phase.PAUSED)
    assert len(one.simulation.calls) == calls
    one.model.pause(False)
    one.until(lambda: len(one.simulation.calls) > calls)
    assert "run.paused" not in one.kinds()


@pytest.mark.parametrize("odd", [0, 1], ids=["between messages", "before a message"])  # two outputs from message to message
def test_a_reset_in_a_pause_amid_a_stretch_computes_nothing_until_the_run_continues(odd):
    one = SimDriver()
    try:
        one.until(lambda: one.newest("time") > 0.1)
        last = len(one.simulation.calls) // 2 * 2 + 10 + odd
        one.simulation.fails_at = lambda time, inputs: len(one.simulation.calls) == last - 1 and one.model.pause()
        for _ in range(20):  # the clock is read once after them: they become known together
            one.wait()
            one.model.offer("shaft_speed", (one.speed,), one.now_ns, one.now_ns)
            one.model.offer("radial_load", (800.0, 0.0), one.now_ns, one.now_ns)
        one.until(lambda: one.model.solver.phase is Phase.PAUSED, drive=False)
        assert len(one.simulation.calls) == last and one.model.reset()
        one.run(0.3)
        assert len(one.simulation.calls) == last
        one.model.pause(False)
        one.until(lambda: len(one.simulation.calls) > last + 20)
    finally:
        one.model.close()


def test_sinks_are_opened_with_run_time_0_get_everything_in_order_and_are_completed_once(make):
    one, opened = make(), []

    def opener(start_ns):
        opened.append(ListSink(start_ns))
        return opened[-1]

    one.model.open("record", opener, reopen=True)
    assert one.model.has("record") and not one.model.has("view")
    one.cage = 39.0
    one.until(lambda: opened)
    one.run(0.6)
    assert len(opened) == 1 and opened[0].start_ns == one.model.start_ns
    one.model.record_diagnostics(one.condition(), one.now_ns)
    sink = one.model.detach("record")
    assert sink is opened[0] and sink.closed == 1 and not one.model.has("record") and one.model.detach("record") is None
    assert len(times(sink)) > 30 and times(sink) == sorted(set(times(sink)))
    assert {channel for _, _, channels in sink.inputs for channel in channels} == {"shaft_speed", "radial_load"}
    assert len(sink.measurements) > 10 and len(sink.diagnostics) == 1
    written = len(times(sink))
    one.run(0.2)
    assert len(times(sink)) == written


def test_a_sink_that_fails_is_closed_and_reported_and_another_one_can_take_its_place(make):
    one = make()
    one.model.open("record", ListSink, reopen=True)
    one.until(lambda: one.newest("time") > 0.1)
    sink = one.model.sinks.recorders["record"]
    sink.fails = True
    one.until(lambda: not one.model.has("record"))
    assert sink.closed == 1
    (event,) = [event for event in one.condition().events if event.kind == "sink.failed"]
    assert event.subject == "record" and event.level is Level.ERROR and "no space left" in event.reason
    one.model.open("record", ListSink, reopen=True)
    one.run(0.2)
    assert "sink.failed" not in one.kinds() and one.model.has("record")
    with pytest.raises(ValueError, match="record"):
        one.model.open("record", ListSink)


def test_events_go_to_the_sinks_with_times_of_the_run(make):
    one = make()
    one.model.open("record", ListSink)
    one.until(lambda: one.newest("time") > 0.1)
    one.wait()
    one.model.offer("shaft_speed", (math.nan,), one.now_ns, one.now_ns)
    one.step()
    events = one.model.detach("record").events
    assert [event.kind for event in events if event.kind.startswith("input")] == ["input.not_finite"]
    assert all(0.0 <= event.time <= one.model.run_time(one.now_ns) for event in events)


def test_outputs_are_stamped_by_the_clock_and_each_comes_once(make):
    one = make(publish_rate=25.0)
    one.until(lambda: len(one.output) > 5)
    stamps = [output.stamp_ns for output in one.output]
    assert stamps == sorted(set(stamps)) and all(START_NS <= stamp <= one.now_ns for stamp in stamps)
    assert all(output.stamp_ns == one.model.stamp(float(output.sample["time"])) for output in one.output)


def test_the_residual_of_a_measured_cage_is_published_with_its_stamp_and_reported_when_it_shifts(make):
    one, found = make(), []
    one.cage = 40.0 * (1 - 0.015)  # the stand-in predicts a slip of 1 % at an ideal 40 rad/s
    for _ in range(120):
        one.step()
        found += one.model.residuals()
    assert len(found) > 50 and all(residual == pytest.approx(0.005, abs=1e-9) for _, residual in found)
    stamps = [stamp for stamp, _ in found]
    assert stamps == sorted(set(stamps)) and START_NS <= stamps[0] and stamps[-1] <= one.now_ns
    one.cage = 40.0 * (1 - 0.05)
    one.until(lambda: any(event.kind == "residual.shift" for event in one.news))


def test_a_solver_that_fails_is_reported_and_the_run_continues_when_it_can(make):
    one = make()
    one.until(lambda: one.newest("time") > 0.1)
    one.simulation.fails_at = lambda now, inputs: True
    one.until(lambda: "solver.failed" in one.kinds())
    assert one.condition().level is Level.ERROR
    held = one.newest("time")
    one.simulation.fails_at = lambda now, inputs: False
    one.model.reset()  # where the run was given up after ten failures in a row
    one.until(lambda: one.newest("time") > held + 0.1)
    assert one.model.solver.failed_ticks == 0


def test_a_programming_error_in_the_solver_is_reported_and_the_rest_works_on(make):
    one = make()
    one.until(lambda: one.newest("time") > 0.1)
    one.simulation.breaks_at = lambda now: True
    one.until(lambda: one.model.solver.phase is Phase.CRASHED)
    one.until(lambda: any(event.kind == "solver.crashed" and "ZeroDivisionError" in event.reason for event in one.news))
    assert "solver.crashed" in one.kinds() and one.newest("time") > 0.1
    assert one.model.reset(timeout=0.2) is False
    assert one.model.offer("shaft_speed", (math.nan,), one.now_ns, one.now_ns).kind == "input.not_finite"
    assert one.model.close(), "the thread has ended"


def test_closing_ends_the_thread_completes_the_sinks_and_keeps_what_was_computed(make):
    one = make()
    one.model.open("record", ListSink)
    one.until(lambda: one.newest("time") > 0.1)
    sink = one.model.sinks.recorders["record"]
    assert one.model.close()
    assert sink.closed == 1 and one.model.solver.phase is Phase.STOPPED
    assert times(sink)[-1] == pytest.approx(one.newest("time"), abs=0.0101)


def test_after_a_refused_overload_life_is_at_most_and_damage_at_least_until_the_run_is_reset(make):
    one = make(load_scene("deng2017_table1", [*OVERRIDES, QUICK, "input_limits.maximum_load=5 kN"]))
    one.until(lambda: one.newest("time") > 0.1)
    assert one.condition().values["inputs unknown [s]"] == 0.0 and "input.unknown" not in one.kinds()
    one.model.offer("radial_load", (6000.0, 0.0), one.now_ns + 1000, one.now_ns + 1000)
    one.run(0.2)
    condition = one.condition()
    (event,) = [event for event in condition.events if event.kind == "input.unknown"]
    assert event.level == Level.WARN and "life is at most, and the damage at least" in event.text and "input_limits.maximum_load" in event.text
    assert 0.0 < condition.values["inputs unknown [s]"] < 0.2
    assert one.model.reset()
    one.until(lambda: "input.unknown" not in one.kinds())
    assert one.condition().values["inputs unknown [s]"] == 0.0
