# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Monitoring in the live model: a measured cage against the predicted one, thresholds changed in mid-run, and a reset."""

import math
import random
import time

import pytest
from fake_simulation import FakeSimulation
from support import ListSink
from test_live import Bench

from bearing_sim.messages.events import Level
from bearing_sim.scene.loader import load_scene

# batches of 20 ms and a second of learning: the test's time is real
QUICK = ["thresholds.residual={batch: 20 ms, learning: 1 s, settling: 50 ms, memory: 500 ms, false_alarm_time: 1 h, tolerance: 0.1 %}"]
IDEAL = 40.0  # rad/s, of the stand-in's cage at 100 rad/s; it predicts a slip of 1 %


class Measured(Bench):
    """A bench whose cage is measured, with noise."""

    def __init__(self, **options):
        super().__init__(scene=QUICK, **options)
        self.lot = random.Random(1)

    def measure(self, seconds, slip, until=None):
        """Measure for so long; where a verdict is named, on until it stands: a machine that stalls makes a measurement stale and learning longer."""
        end = time.monotonic() + seconds
        latest = end + (0.0 if until is None else 60.0)
        while (now := time.monotonic()) < end or (now < latest and not self.verdict.startswith(until)):
            self.speed(100.0)
            self.load()
            self.live.offer("cage_speed_measured", (IDEAL * (1 - slip - self.lot.gauss(0.0, 2e-3)),), None, self.now_ns)
            self.news += self.live.collect(self.now_ns)
            time.sleep(0.005)

    @property
    def verdict(self):
        return self.live.condition(self.now_ns).values.get("residual slip, verdict", "")


@pytest.fixture
def bench():
    one = Measured()
    yield one
    assert one.live.close()


def test_a_cage_that_is_not_measured_leaves_no_trace(bench):
    bench.run(0.2)
    condition = bench.live.condition(bench.now_ns)
    assert not any("residual" in key for key in condition.values) and not any("cage_speed" in event.text for event in condition.events)


def test_a_cage_that_slips_more_than_predicted_is_told_in_the_verdict_and_as_news_once(bench):
    recorder = ListSink()
    bench.live.sinks.attach("record", recorder)
    bench.measure(2.0, slip=0.015, until="as predicted")
    assert bench.verdict == "as predicted"
    assert bench.live.condition(bench.now_ns).values["residual slip, usual mean [fraction]"] == pytest.approx(0.005, abs=0.001)
    assert not [event for event in bench.news if event.kind == "residual.shift"]
    bench.measure(1.5, slip=0.03, until="slips more than predicted")
    assert bench.verdict == "slips more than predicted"
    (event,) = [event for event in bench.news if event.kind == "residual.shift"]
    assert event.level is Level.WARN and event in recorder.events
    assert recorder.measurements[-1][1] == pytest.approx(IDEAL * 0.97, rel=0.01) and recorder.measurements[-1][2] == pytest.approx(0.02, abs=0.01)


def test_a_measurement_that_cannot_be_is_refused_as_an_input_is_and_one_that_stops_is_stale(bench):
    bench.measure(0.3, slip=0.01)
    event = bench.live.offer("cage_speed_measured", (math.nan,), None, bench.now_ns)
    assert event.kind == "input.not_finite" and event.text.startswith("cage_speed_measured") and "rad/s" in event.text
    assert bench.live.offer("cage_speed_measured", (-1.0,), None, bench.now_ns).kind == "input.negative"
    bench.run(0.8)
    assert any(event.kind == "input.stale" and "cage_speed_measured" in event.text for event in bench.live.condition(bench.now_ns).events)


def test_a_measurement_alone_starts_no_model(bench):
    bench.live.offer("cage_speed_measured", (40.0,), None, bench.now_ns)
    bench.run(0.2, drive=False)
    assert bench.live.solver.newest is None and bench.live.condition(bench.now_ns).level is Level.OK


def test_after_a_reset_the_cage_is_not_judged_until_the_prediction_has_settled(bench):
    bench.measure(0.5, slip=0.01)
    assert bench.live.solver.reset()
    bench.live.adjust(load_scene("deng2017_table1", [*QUICK, "thresholds.residual.settling=10 s"]).thresholds)
    bench.measure(0.3, slip=0.01, until="not judged")
    assert bench.verdict.startswith("not judged")


class Fallen:
    """A governor that has fallen to a cheaper level."""

    level, wanted, is_at_wanted = "slip", "planar", False
    setting = wanted_setting = ""
    slip_error = life_error = math.nan

    def __init__(self, simulation):
        self._simulation = simulation
        self.scene = load_scene("deng2017_table1", ["level=slip"])

    def consider(self, simulated, spent, *others):
        return None

    def is_measured_at(self, sample):
        return True

    def restart(self):
        return self._simulation


def test_a_cage_is_not_held_against_the_prediction_of_a_cheaper_level():
    simulation = FakeSimulation()
    bench = Measured(simulation=simulation, governor=Fallen(simulation))
    try:
        bench.measure(0.5, slip=0.03, until="not judged")
        assert bench.verdict.startswith("not judged") and math.isnan(bench.live.watchers.get("cage_slip").monitor.residual)
    finally:
        assert bench.live.close()


def test_a_threshold_changed_in_mid_run_holds_and_a_reset_forgets_what_was_raised(bench):
    bench.run(0.8)
    assert "bearing.slip" not in bench.codes()
    bench.live.adjust(load_scene("deng2017_table1", [*QUICK, "thresholds.slip_warning=0.5 %"]).thresholds)
    bench.run(0.8)
    (told,) = [event for event in bench.live.condition(bench.now_ns).events if event.kind == "bearing.slip"]
    assert told.text == "cage slip: 1 % has reached 0.5 %"
    assert bench.live.solver.reset()
    bench.run(0.2)
    assert "bearing.slip" not in bench.codes(), "the hold time has begun anew"
    bench.run(0.6)
    assert "bearing.slip" in bench.codes()
