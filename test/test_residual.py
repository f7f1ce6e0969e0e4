# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Residual slip and temperatures: synthetic faults are found; noise, rest, start-up and lost sensors are none."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from bearing_sim.model.sample import new_block
from bearing_sim.scene.loader import load_scene
from bearing_sim.scene.scene import ResidualDetection
from bearing_sim.simulation import Simulation
from bearing_sim.watchers.monitoring.residual import ResidualMonitor, TemperatureResiduals

SPEED = 4712.0  # rad/s
RATE = 10.0  # Hz
READING = 0.003  # standard deviation of a slip from a cage speed sensor


def monitor(**settings):
    return ResidualMonitor(ResidualDetection(**settings), from_speed=20.0)


def feed(one, seconds, residual, start, lot, correlation=0.0, predicted=0.05):
    """Give a monitor noisy residuals; return when it told a change first, and its time at the end."""
    count = round(seconds * RATE)
    noise = READING * lfilter([math.sqrt(1 - correlation**2)], [1, -correlation], lot.normal(size=count))
    told = math.nan
    for k, wobble in enumerate(noise.tolist()):
        now = start + (k + 1) / RATE
        one.compare(now, SPEED, predicted + residual + wobble, predicted)
        if math.isnan(told) and one.events(now):
            told = now - start
    return told, start + seconds


@pytest.mark.parametrize("correlation", [0.0, 0.95])
def test_24_hours_of_noise_give_no_false_alarm_at_one_in_1000_hours(correlation):
    """86,400 batches; the chance of a false alarm is 2.4 %, and the noise always the same.  Readings of 0.95 resemble each other over 2 s."""
    one, lot = monitor(), np.random.default_rng(24)
    told, end = feed(one, 24 * 3600.0, 0.01, 0.0, lot, correlation)
    assert math.isnan(told) and one.verdict(end) == "as predicted"
    assert one.values(end)["residual slip, usual mean [fraction]"] == pytest.approx(0.01, abs=0.0002)
    told, _ = feed(one, 60.0, 0.02, end, lot, correlation)
    assert told < 60.0, "and a point of slip is found after that day"


def test_false_alarms_come_as_often_as_stated():
    """Of an hour's noise where one false alarm in 100 s is asked for: the detector is no deaf one."""
    one, lot, alarms, before = monitor(false_alarm_time=100.0, tolerance=1e-6), np.random.default_rng(7), 0, False
    for k, wobble in enumerate((READING * lot.normal(size=200_000)).tolist()):
        one.compare(k / RATE, SPEED, wobble, 0.0)
        alarms, before = alarms + (bool(one.events(0.0)) and not before), bool(one.events(0.0))
    assert 0.5 < 20_000 / alarms / 100.0 < 2.5, "an alarm lasts for a while, in which there is no other"


FAULTS = {
    "drag up": ["lubricant.mixture_fraction=0.06"],
    "traction down": ["lubricant.traction_scale=0.7"],
    "load loss": ["operating.radial_load=400 N"],
}
LOW_PRELOAD = ["bearing.outer_raceway.low_radius=34.8675mm"]  # where lobes squeeze more, a radial load lost changes slip less


def settled_slip(overrides):
    return float(Simulation(load_scene("deng2017_table1", LOW_PRELOAD + overrides)).advance(0.5, samples=500)["cage_slip"][250:].mean())


@pytest.fixture(scope="module")
def predicted():
    return settled_slip([])


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_found_within_20_seconds_and_over_after_the_repair(fault, predicted):
    """The measured machine is the model with a changed scene; a constant error of the model (1 point) is no fault."""
    change = settled_slip(FAULTS[fault]) - predicted
    assert change > 0.004, "all of these make the cage slip more"
    one, lot = monitor(), np.random.default_rng(11)
    told, now = feed(one, 600.0, 0.01, 0.0, lot, predicted=predicted)
    assert math.isnan(told)
    told, now = feed(one, 120.0, 0.01 + change, now, lot, predicted=predicted)
    assert told < 20.0
    (event,) = one.events(now)
    assert event.kind == "residual.shift" and "slips more than predicted" in event.text and "one false alarm in 1000 h" in event.text
    assert one.verdict(now) == "slips more than predicted"
    told, now = feed(one, 120.0, 0.01, now, lot, predicted=predicted)
    assert not one.events(now) and one.verdict(now) == "as predicted"


def test_less_slip_than_predicted_is_found_too():
    one, lot = monitor(), np.random.default_rng(12)
    _, now = feed(one, 300.0, 0.0, 0.0, lot)
    feed(one, 60.0, -0.01, now, lot)
    assert "slips less than predicted" in one.events(now)[0].text


def test_fading_mean_and_deviation_are_those_of_the_noise():
    one, lot = monitor(memory=100.0), np.random.default_rng(13)
    feed(one, 1000.0, 0.02, 0.0, lot)
    assert one.mean == pytest.approx(0.02, abs=3e-4) and one.deviation == pytest.approx(READING, rel=0.1)


def test_rest_start_up_and_changes_of_speed_are_not_judged():
    one, lot, now = monitor(), np.random.default_rng(14), 0.0
    for _ in range(20):  # starts and stops, where sensor and model disagree as they like
        for _ in range(50):
            now += 1 / RATE
            one.compare(now, 0.0, math.nan, math.nan)
        assert one.verdict(now).startswith("not judged")
        for k in range(50):
            now += 1 / RATE
            one.compare(now, SPEED * (k + 1) / 50, lot.uniform(-0.5, 0.5), 0.05)
        for _ in range(30):  # and while the bearing settles after the ramp
            now += 1 / RATE
            one.compare(now, SPEED, lot.uniform(-0.5, 0.5), 0.05)
        now += 2.0
        told, now = feed(one, 30.0, 0.0, now, lot)
        assert math.isnan(told)
    assert one.values(now)["residual slip, usual mean [fraction]"] == pytest.approx(0.0, abs=0.0005)
    assert one.verdict(now) == "as predicted"


@pytest.mark.parametrize(("change", "found"), [(0.0015, False), (0.005, True)])
def test_a_lasting_change_within_the_tolerance_is_no_fault_and_one_well_beyond_it_is(change, found):
    one, lot = monitor(tolerance=0.002), np.random.default_rng(18)
    _, now = feed(one, 300.0, 0.0, 0.0, lot)
    told, _ = feed(one, 600.0, change, now, lot)
    assert math.isnan(told) != found


def test_verdicts_before_during_and_after_a_measurement():
    one, lot = monitor(), np.random.default_rng(15)
    assert one.values(5.0) == {} and one.verdict(5.0) == "no measurement"
    _, now = feed(one, 40.0, 0.0, 5.0, lot)
    assert one.verdict(now).startswith("learning what is usual: 3") and "of 120 s" in one.verdict(now)
    assert one.verdict(now + 10.0) == "no measurement"
    told, now = feed(one, 300.0, 0.0, now + 3600.0, lot)
    assert math.isnan(told) and one.verdict(now) == "as predicted"


def test_measurements_rarer_than_batches_are_judged_one_by_one():
    one, lot = monitor(), np.random.default_rng(16)
    for k in range(400):
        one.compare(2.0 * k, SPEED, READING * lot.normal() + (0.02 if k > 300 else 0.0), 0.0)
    assert one.verdict(799.0) == "slips more than predicted"


def test_a_restarted_monitor_is_as_one_that_has_never_measured():
    fresh, restarted = monitor(), monitor()
    feed(restarted, 40.3, 0.02, 0.0, np.random.default_rng(5))
    restarted.restart()
    for one in (fresh, restarted):
        feed(one, 45.0, 0.01, 100.0, np.random.default_rng(6))
    assert restarted.learned == fresh.learned and restarted.values(145.0) == fresh.values(145.0)


def test_settings_that_cannot_be_are_refused():
    with pytest.raises(ValueError, match="30 or more"):
        ResidualDetection(batch=10.0)
    with pytest.raises(ValueError, match="20 batches"):
        ResidualDetection(batch=4.0, false_alarm_time=60.0)


def test_other_settings_in_mid_run_keep_what_was_learned_unless_batches_change():
    one, lot = monitor(), np.random.default_rng(17)
    _, now = feed(one, 200.0, 0.01, 0.0, lot)
    one.adjust(ResidualDetection(false_alarm_time=3600.0), 20.0)
    assert one.verdict(now) == "as predicted"
    one.adjust(ResidualDetection(batch=2.0), 20.0)
    assert one.verdict(now) == "no measurement"


HEATED = ["heat={law: network}"]


def temperatures(seconds, inner, outer, start=0.0, seed=3):
    """Return samples at 10 Hz with measured rings that are warmer than predicted by so much [K], and the noise of a sensor."""
    draw, count = np.random.default_rng(seed), round(10.0 * seconds)
    block = new_block(count, 18)
    block["time"], block["shaft_speed"], block["oil_temperature"] = start + 0.1 * np.arange(1, count + 1), SPEED, 393.15
    block["rating_life"] = block["modified_rating_life"] = 1e4
    for name, kelvin in (("inner_ring_temperature", inner), ("outer_ring_temperature", outer)):
        block[f"{name}_uncorrected"], block[f"{name}_measured"] = 400.0, 400.0 + kelvin + 0.2 * draw.normal(size=count)
    return block


def told_of(monitor, block):
    """Return the events of residuals and the time of each when it begins, feeding ten samples at a time."""
    found = {}
    for k in range(0, len(block), 10):
        monitor.see(block[k : k + 10])
        now = float(block["time"][k : k + 10][-1])
        for event in monitor.events(now):
            if event.kind == "residual.shift":
                found.setdefault(event.subject, (now, event))
    return found


def test_a_ring_that_becomes_warmer_than_predicted_is_found_and_named_and_one_that_is_always_warmer_is_not():
    one = TemperatureResiduals(load_scene("deng2017_table1", HEATED))
    assert told_of(one, temperatures(1800.0, 1.0, 0.0)) == {}, "the network is wrong by a kelvin, always"
    assert one.values(1800.0)["residual temperature of the inner ring, usual mean [K]"] == pytest.approx(1.0, abs=0.05)
    assert one.values(1800.0)["residual temperature of the inner ring, verdict"] == "as predicted"
    told = told_of(one, temperatures(600.0, 1.0, 6.0, start=1800.0))
    assert [*told] == ["residual temperature of the outer ring"]
    at, event = told["residual temperature of the outer ring"]
    assert at < 1800.0 + 300.0 and "the outer ring is warmer than predicted" in event.text and ", usually +0.1" in event.text
    assert one.values(2400.0)["residual temperature of the outer ring, changed for [s of measurement]"] > 0.0
    assert one.values(2400.0)["residual temperature of the outer ring, verdict"] == "is warmer than predicted"


def test_measured_temperatures_correct_the_network_but_not_what_they_are_compared_with():
    scene = load_scene("deng2017_table1", HEATED)
    corrected, alone = Simulation(scene), Simulation(scene)
    for run in (corrected, alone):
        run.advance(1.0)
        assert run.sample["inner_ring_temperature_uncorrected"] == run.sample["inner_ring_temperature"], "nothing is measured yet"
    warmer = corrected.inputs._replace(inner_ring_temperature=float(corrected.sample["inner_ring_temperature"]) + 20.0)
    for _ in range(20):
        corrected.advance(0.1, warmer)
        alone.advance(0.1)
    moved = float(corrected.sample["inner_ring_temperature"] - alone.sample["inner_ring_temperature"])
    assert moved > 2.0
    for ring in ("inner", "outer"):  # only the losses of a warmer bearing differ
        off = corrected.sample[f"{ring}_ring_temperature_uncorrected"] - alone.sample[f"{ring}_ring_temperature"]
        assert abs(off) < 0.05 * moved
    other = Simulation(scene)
    other.take_over(corrected)
    after = [float(run.advance(0.1, warmer)["inner_ring_temperature_uncorrected"][0]) for run in (other, corrected)]
    assert after[0] == pytest.approx(after[1], abs=0.02 * moved), "another level continues both networks"


def test_a_ring_that_is_not_measured_or_not_predicted_has_no_residual():
    unmeasured = temperatures(60.0, 0.0, 0.0)
    unmeasured["inner_ring_temperature_measured"] = math.nan
    one = TemperatureResiduals(load_scene("deng2017_table1", HEATED))
    told_of(one, unmeasured)
    assert "residual temperature of the outer ring [K]" in one.values(60.0)
    assert not any("inner ring" in key for key in one.values(60.0))
    given = TemperatureResiduals(load_scene("deng2017_table1", ["heat={law: given, inner_ring: 127 degC}"]))
    told_of(given, temperatures(60.0, 5.0, 5.0))
    assert not any(key.startswith("residual") for key in given.values(60.0)), "nothing predicts it: measured replaces given"


def test_temperature_sensors_that_are_lost_leave_the_verdict_and_a_reset_lets_the_bearing_settle():
    one = TemperatureResiduals(load_scene("deng2017_table1", HEATED))
    told_of(one, temperatures(1800.0, 0.0, 0.0))
    lost = temperatures(120.0, 0.0, 0.0, start=1800.0)
    for ring in ("inner", "outer"):
        lost[f"{ring}_ring_temperature_measured"] = math.nan
    assert told_of(one, lost) == {} and one.values(1920.0)["residual temperature of the inner ring, verdict"] == "no measurement"
    one.restart()
    assert told_of(one, temperatures(50.0, 9.0, 9.0)) == {}, "after a reset the run's time may begin again; it settles for a minute first"
