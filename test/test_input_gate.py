# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The gate accepts what the scene allows, refuses the rest with a reason, and holds the last good value."""

import math
import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim import load_scene
from bearing_sim.inputs.gate import CHANNELS, InputGate
from bearing_sim.messages.events import Level
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

START = Inputs(shaft_speed=100.0, load_y=800.0, load_z=0.0, oil_temperature=393.15)
LIMITS = InputLimits(maximum_speed=5000.0, maximum_load=2000.0, reverse_rotation=False, stale_after=1.0, minimum_rate=5.0, maximum_rate=200.0)


@pytest.fixture
def gate():
    return InputGate(LIMITS, START)


def feed(gate, rate, duration, start=0.0, channel="shaft_speed", values=(100.0,)):
    """Offer good messages at a rate; return the time of the last."""
    stamp = start
    for index in range(1, int(rate * duration) + 1):
        stamp = start + index / rate
        assert gate.offer(channel, stamp, values) is None
    return stamp


def test_good_messages_of_all_channels_are_held_together(gate):
    assert gate.offer("shaft_speed", 0.1, (4712.0,)) is None
    assert gate.offer("radial_load", 0.1, (-300.0, 400.0)) is None
    assert gate.offer("oil_temperature", 0.1, (350.0,)) is None
    assert gate.held == Inputs(4712.0, -300.0, 400.0, 350.0)
    assert not gate.refused


@pytest.mark.parametrize(
    "channel, values, code, words",
    [
        ("shaft_speed", (math.nan,), "input.not_finite", "nan rad/s"),
        ("shaft_speed", (math.inf,), "input.not_finite", "inf rad/s"),
        ("shaft_speed", (-1.0,), "input.negative", "reverse_rotation"),
        ("shaft_speed", (5001.0,), "input.too_large", "5000 rad/s"),
        ("shaft_speed", (), "input.malformed", "0 values"),
        ("radial_load", (-1.0,), "input.negative", "-1 N"),
        ("radial_load", (1500.0, 1500.0), "input.too_large", "2000 N"),
        ("radial_load", (0.0, -math.inf), "input.not_finite", "(0, -inf) N"),
        ("radial_load", (1.0, 2.0, 3.0), "input.malformed", "3 values"),
        ("oil_temperature", (20.0,), "input.too_small", "-253.15 degC is outside -40 degC to 250 degC"),
        ("oil_temperature", (1e9,), "input.too_large", "250 degC"),
        ("oil_temperature", (math.nan,), "input.not_finite", "nan degC"),
        ("inner_ring_temperature", (20.0,), "input.too_small", "-40 degC"),
        ("outer_ring_temperature", (1e9,), "input.too_large", "input_limits.maximum_temperature"),
    ],
)
def test_a_bad_value_is_refused_with_its_reason_and_the_last_good_one_held(gate, channel, values, code, words):
    event = gate.offer(channel, 0.5, values)
    assert (event.kind, event.level, event.time) == (code, Level.ERROR, 0.5)
    assert words in event.text and event.text.startswith(channel)
    assert gate.held == START
    assert gate.refused == {code: 1}
    assert gate.offer("shaft_speed", 0.6, (200.0,)) is None, "the gate works on after a refusal"


def test_values_on_the_bounds_are_accepted(gate):
    for channel, values in [("shaft_speed", (5000.0,)), ("shaft_speed", (0.0,)), ("radial_load", (1200.0, 1600.0)), ("oil_temperature", (233.15,))]:
        assert gate.offer(channel, 1.0 + len(gate.accepted) + gate.accepted.total(), values) is None


def test_a_negative_speed_is_good_where_the_scene_allows_reverse_rotation():
    gate = InputGate(InputLimits(reverse_rotation=True, maximum_speed=5000.0), START)
    assert gate.offer("shaft_speed", 0.1, (-4999.0,)) is None
    assert gate.held.shaft_speed == -4999.0
    assert gate.offer("shaft_speed", 0.2, (-5001.0,)).kind == "input.too_large"


def test_a_scalar_load_acts_along_y(gate):
    gate.offer("radial_load", 0.1, (1.0, 2.0))
    gate.offer("radial_load", 0.2, (700.0,))
    assert (gate.held.load_y, gate.held.load_z) == (700.0, 0.0)


def test_a_stamp_going_back_or_repeating_is_refused_and_channels_do_not_mix(gate):
    gate.offer("shaft_speed", 5.0, (200.0,))
    assert gate.offer("radial_load", 1.0, (900.0, 0.0)) is None
    assert gate.offer("shaft_speed", 5.0, (300.0,)).kind == "input.time_repeated"
    back = gate.offer("shaft_speed", 2.0, (300.0,))
    assert back.kind == "input.time_backwards" and "3 s before" in back.text
    assert gate.offer("shaft_speed", math.nan, (300.0,)).kind == "input.stamp_not_finite"
    assert gate.held.shaft_speed == 200.0
    assert gate.offer("shaft_speed", 5.1, (300.0,)) is None


def test_a_log_never_goes_back_in_time(gate):
    gate.offer("shaft_speed", 100.0, (200.0,))
    assert all(gate.offer("shaft_speed", 1.0 + 0.1 * k, (300.0,)) is not None for k in range(50))


def test_a_live_sender_whose_clock_was_set_back_is_followed_after_a_few_refusals(gate):
    gate.offer("shaft_speed", 100.0, (200.0,), arrival=1.0)
    answers = [gate.offer("shaft_speed", 1.0 + 0.1 * k, (300.0,), arrival=1.1 + 0.1 * k) for k in range(6)]
    assert [answer is None for answer in answers] == [False, False, False, True, True, True]
    assert gate.held.shaft_speed == 300.0


def test_two_live_senders_with_different_clocks_are_not_followed_in_turns(gate):
    for k in range(20):
        assert gate.offer("shaft_speed", 100.0 + k, (200.0,), arrival=0.1 * k) is None
        assert gate.offer("shaft_speed", 10.0 + k, (300.0,), arrival=0.1 * k + 0.05).kind == "input.time_backwards"


def test_an_input_is_stale_when_no_good_message_came_for_the_set_time(gate):
    last = feed(gate, 20.0, 3.0)
    feed(gate, 20.0, 3.0, channel="radial_load", values=(800.0, 0.0))
    assert gate.check(last + 0.9) == []
    (stale, other) = gate.check(last + 1.1)
    assert stale.kind == other.kind == "input.stale" and stale.level == Level.WARN
    assert stale.text == "shaft_speed: no good message for longer than 1 s; the last good value is held"
    assert gate.numbers(last + 1.1)["shaft_speed last good message [s ago]"] == pytest.approx(1.1)
    gate.offer("shaft_speed", last + 1.2, (math.nan,))
    assert len(gate.check(last + 1.2)) == 2, "a refused message does not refresh an input"


def test_nothing_is_stale_before_the_first_message_and_no_value_is_said_to_be_held_that_nobody_sent(gate):
    assert gate.check(1000.0) == []
    assert gate.state("shaft_speed") == "no message so far, nothing is computed before the first good one"
    assert gate.state("radial_load") == "no message so far, the scene's value is used, (800, 0) N"
    assert gate.state("oil_temperature") == "no message so far, the scene's value is used, 120 degC"
    refused = gate.offer("shaft_speed", 1000.0, (math.nan,))
    assert refused.action == "message refused, nothing is computed before the first good one"
    assert gate.check(1000.9) == []
    speed, load = gate.check(1001.1)
    assert speed.text.startswith("shaft_speed: no good message yet, expected one within 1 s of the first input") and load.subject == "radial_load"
    assert load.action == "the scene's value is used, (800, 0) N"
    gate.offer("shaft_speed", 1001.2, (-0.0,))
    assert gate.state("shaft_speed") == "its messages are used"
    assert gate.offer("shaft_speed", 1001.3, (math.nan,)).action == "message refused, holding 0 rad/s", "not -0"


@pytest.mark.parametrize("rate, wrong", [(2.0, True), (10.0, False), (100.0, False), (400.0, True)])
def test_a_message_rate_outside_the_limits_is_named(gate, rate, wrong):
    last = feed(gate, rate, 4.0)
    feed(gate, 20.0, 4.0, channel="radial_load", values=(800.0,))
    events = gate.check(last)
    assert [event.kind for event in events] == ["input.rate"] * wrong
    assert gate.rate("shaft_speed") == pytest.approx(rate, rel=0.02)
    if wrong:
        assert f"at {'less than 5 Hz' if rate < 5.0 else 'more than 200 Hz'}" in events[0].text
        assert gate.numbers(last)["shaft_speed rate [Hz]"] == pytest.approx(rate, rel=0.02)


def test_an_input_that_was_silent_and_comes_again_is_well_at_once_and_one_that_comes_rarely_is_not(gate):
    last = feed(gate, 20.0, 3.0)
    feed(gate, 20.0, 3.0, channel="radial_load", values=(800.0,))
    assert [event.kind for event in gate.check(last + 30.0)] == ["input.stale"] * 2
    for channel, values in (("shaft_speed", (100.0,)), ("radial_load", (800.0,))):
        end = feed(gate, 20.0, 2.0, start=last + 30.0, channel=channel, values=values)
    assert gate.check(end) == [] and gate.rate("shaft_speed") == pytest.approx(20.0, rel=0.05)
    rare = InputGate(LIMITS, START)
    for k in range(6):
        rare.offer("shaft_speed", 5.0 * k, (100.0,))
        assert not k or rare.check(5.0 * k)[0].kind == "input.stale", "no sooner well than missing again"


@pytest.mark.parametrize("rate", [0.3, 0.8, 1.2, 4.45, 4.55, 20.0, 230.0])
def test_as_long_as_messages_come_at_one_rate_the_trouble_with_it_has_one_text(gate, rate):
    texts, end = set(), 30.0
    for k in range(int(end * rate)):
        time = k / rate
        gate.offer("shaft_speed", time + 0.02 * (-1) ** k / rate, (100.0 + math.sin(time),))
        gate.offer("radial_load", time, (800.0,))
        for part in (0.1, 0.5, 0.9):
            if time > 10.0:
                texts.add(tuple(event.text for event in gate.check(time + part / rate) if event.subject == "shaft_speed"))
    assert len(texts) == 1 and bool(*texts) == (rate not in (4.55, 20.0)), texts


@pytest.mark.parametrize("offset", [30.0, -30.0, 365.25 * 86400.0, -3.0 * 86400.0, 2.1, -2.1])
def test_stamps_far_from_the_receivers_clock_are_used_and_told_with_their_offset_as_long_as_they_are_and_two_seconds_more(offset):
    gate, now, texts = InputGate(LIMITS, START, stamp_tolerance=2.0), 0.0, set()
    for k in range(600):
        now = 0.1 * k
        assert gate.offer("shaft_speed", now + offset + 0.05 * math.sin(k), (100.0,), arrival=now) is None
        gate.offer("radial_load", now, (800.0,), arrival=now)
        texts |= {(event.kind, event.subject, event.level, event.text) for event in gate.check(now)}
    side = "ahead of" if offset > 0.0 else "behind"
    ((kind, subject, level, text),) = texts
    assert (kind, subject, level) == ("input.stamp_offset", "shaft_speed", Level.WARN)
    assert text.startswith(f"shaft_speed: stamps are more than 2 s {side} this machine's clock")
    assert gate.numbers(now)["shaft_speed stamp offset [s]"] == pytest.approx(offset, abs=0.06)
    for k in range(60):  # corrected: a few of the first messages are refused where the stamps fell
        time = now + 0.1 * (k + 1)
        gate.offer("shaft_speed", time, (100.0,), arrival=time)
        gate.offer("radial_load", time, (800.0,), arrival=time)
        assert ("input.stamp_offset" in {event.kind for event in gate.check(time)}) == (time - now < 2.01)


@pytest.mark.parametrize("offset, tolerance", [(1.9, 2.0), (-1.9, 2.0), (30.0, math.inf), (300.0, 600.0)])
def test_stamps_within_the_tolerance_and_all_of_a_log_are_not_judged_by_a_clock(offset, tolerance):
    gate = InputGate(LIMITS, START, stamp_tolerance=tolerance)
    for k in range(30):
        gate.offer("shaft_speed", 0.1 * k + offset, (100.0,), arrival=0.1 * k)
        gate.offer("radial_load", 0.1 * k + offset, (800.0,), arrival=0.1 * k)
    assert gate.check(2.9) == []
    log = InputGate(LIMITS, START)
    log.offer("shaft_speed", 1e9, (100.0,))
    assert "shaft_speed stamp offset [s]" not in log.numbers(1e9)


def test_messages_whose_spacing_varies_around_the_patience_are_late_all_the_time_and_ten_in_time_are_enough(gate):
    draw, now, texts = random.Random(5), 0.0, set()
    for k in range(100):
        now += draw.uniform(0.8, 1.3)
        gate.offer("shaft_speed", now, (100.0,))
        if k > 10:
            texts |= {tuple(event.kind for event in gate.check(now + later) if event.subject == "shaft_speed") for later in (0.0, 0.4, 0.79)}
    assert texts == {("input.stale",)}
    for _ in range(12):
        now += 0.9
        gate.offer("shaft_speed", now, (100.0,))
    assert "input.stale" not in {event.kind for event in gate.check(now + 0.5) if event.subject == "shaft_speed"}


def test_onsets_report_a_lasting_trouble_once_and_again_after_it_was_gone(gate):
    gate.offer("shaft_speed", 0.0, (math.nan,))
    assert len(gate.onsets(2.0)) == 2
    assert gate.onsets(3.0) == []
    last = feed(gate, 20.0, 2.0, start=3.0)
    assert gate.onsets(last) == []
    assert [event.kind for event in gate.onsets(last + 2.0)] == ["input.stale"]


def test_random_messages_never_leave_a_bad_value_held():
    draw, gate = random.Random(1), InputGate(LIMITS, START)
    odd = [math.nan, math.inf, -math.inf, -1.0, 0.0, 1e300, 1e-320, 100.0, 400.0]
    for k in range(3000):
        channel = draw.choice(["shaft_speed", "radial_load", "oil_temperature"])
        stamp = draw.choice([*[float(k)] * 20, k - 5.0, *odd])
        gate.offer(channel, stamp, tuple(draw.choices(odd, k=draw.choice([0, 1, 1, 1, 2, 3]))), arrival=float(k))
        held = gate.held
        assert 0.0 <= held.shaft_speed <= 5000.0 and math.hypot(held.load_y, held.load_z) <= 2000.0 and 233.15 <= held.oil_temperature <= 523.15
    assert gate.refused.total() + gate.accepted.total() == 3000 and gate.accepted.total() > 100


@pytest.mark.parametrize("values", [(), (1e-3, 2e-3), (1e-3, 2e-3, 3e-3)], ids=len)
@pytest.mark.parametrize("channel", CHANNELS)
def test_as_many_values_as_the_channel_has_are_accepted_and_no_others(channel, values):
    gate = InputGate(LIMITS, START)
    event = gate.offer(channel, 1.0, values)
    if channel == "radial_load" and len(values) == 2:
        assert event is None and (gate.held.load_y, gate.held.load_z) == values
    elif channel in ("cage_speed_measured", "running_clearance_measured") and len(values) == 2:
        assert event is None and gate.latest(channel) == values and gate.held == START
    else:
        assert event.kind == "input.malformed" and f"{len(values)} values, expected" in event.text
        assert gate.held == START


def test_values_so_large_that_their_sum_overflows_are_too_large_and_not_called_infinite():
    event = InputGate(LIMITS, START).offer("radial_load", 1.0, (1e308, 1.7e308))
    assert event.kind == "input.too_large"


def test_reverse_rotation_is_good_unless_a_scene_forbids_it():
    assert InputGate(InputLimits(), START).offer("shaft_speed", 0.1, (-100.0,)) is None
    refused = InputGate(InputLimits(reverse_rotation=False), START).offer("shaft_speed", 0.1, (-100.0,))
    assert refused.kind == "input.negative" and "input_limits.reverse_rotation" in refused.text


@pytest.mark.parametrize("name", ["deng2017_table1", "deng2017_table2"])
def test_default_bounds_are_beyond_what_the_bearing_survives_and_given_ones_are_kept(name):
    scene = load_scene(name)
    roller, gamma = scene.bearing.roller, scene.bearing.diameter_ratio
    static = 44 * (1 - gamma) * roller.count * (1e3 * roller.length) * (1e3 * roller.diameter)  # ISO 76
    assert scene.accepted_inputs.maximum_load == pytest.approx(10 * static)
    assert scene.accepted_inputs.maximum_speed == pytest.approx(min(350.0 / scene.bearing.inner_raceway.radius, 12000.0))
    given = load_scene(name, ["input_limits.maximum_load=5 kN", "input_limits.maximum_speed=3000 rpm"]).accepted_inputs
    assert (given.maximum_load, given.maximum_speed) == (5000.0, pytest.approx(100 * math.pi))


MESSAGES = st.lists(st.tuples(st.integers(1, 3000), st.sampled_from(["shaft_speed", "radial_load", "oil_temperature"]), st.booleans()), max_size=300)


@given(MESSAGES)
def test_inputs_are_unknown_from_the_last_good_message_before_a_refused_one_to_the_next_good_one_on_any_channel(messages):
    gate, good, bad = InputGate(LIMITS, START), {"shaft_speed": 100.0, "radial_load": 800.0, "oil_temperature": 350.0}, 1e6
    unknown, last, since = set(), {}, {}
    end = 0
    for tenths, channel, is_good in sorted(messages, key=lambda message: message[0]):
        refused = gate.offer(channel, tenths / 10, (good[channel] if is_good else bad,))
        if refused is not None and refused.kind.startswith("input.time"):
            continue
        end = tenths
        if refused is not None:
            since.setdefault(channel, last.get(channel, tenths))
        else:
            if channel in since:
                unknown |= set(range(since.pop(channel), tenths))
            last[channel] = tenths
    for begin in since.values():
        unknown |= set(range(begin, end))
    assert gate.coverage.unknown_until(end / 10) == pytest.approx(len(unknown) / 10, abs=1e-9)


def test_what_is_refused_as_too_large_makes_life_an_upper_bound_and_names_the_fields(gate):
    gate.offer("shaft_speed", 0.1, (math.nan,))
    assert gate.coverage.verdict == "", "nobody knows whether the speed was higher or lower"
    gate.offer("radial_load", 0.2, (2500.0,))
    gate.offer("shaft_speed", 0.3, (6000.0,))
    assert "life is at most, and the damage at least" in gate.coverage.verdict
    assert gate.coverage.verdict.endswith("(bound: input_limits.maximum_load, input_limits.maximum_speed)")
    gate.offer("cage_speed_measured", 0.4, (math.nan,))
    assert gate.coverage.unknown_until(0.4) == pytest.approx(0.3), "a measured cage is no input of the model"


def test_a_measured_cage_may_state_its_standard_error(gate):
    assert gate.offer("cage_speed_measured", 0.1, (400.0, 0.5)) is None and (gate.measured, gate.standard_error) == (400.0, 0.5)
    assert gate.offer("cage_speed_measured", 0.2, (401.0,)) is None and gate.measured == 401.0 and math.isnan(gate.standard_error)
    assert gate.offer("cage_speed_measured", 0.3, (402.0, math.nan)) is None and math.isnan(gate.standard_error), "not known"
    for wrong in (0.0, -0.5, math.inf):
        event = gate.offer("cage_speed_measured", 0.4, (403.0, wrong))
        assert event.kind == "input.standard_error" and "expected a positive number" in event.reason and gate.measured == 402.0
    event = gate.offer("cage_speed_measured", 0.4, (math.nan, 0.5))
    assert event.kind == "input.not_finite" and event.reason == "nan rad/s is not finite", "the error of a speed that is none says nothing"


def test_a_measured_clearance_may_be_preload_and_state_its_standard_error_but_not_be_in_micrometres(gate):
    channel = "running_clearance_measured"
    assert gate.state(channel) == "no message so far, nothing is calibrated by it"
    assert gate.offer(channel, 0.1, (-4e-6, 1e-6)) is None and gate.latest(channel) == (-4e-6, 1e-6)
    assert gate.offer(channel, 0.2, (3e-5,)) is None and gate.latest(channel) == pytest.approx((3e-5, math.nan), nan_ok=True)
    for wrong in (31.0, -31.0):
        event = gate.offer(channel, 0.3, (wrong, 1.0))
        assert event.kind == "input.too_large" and "expected metres" in event.reason and f"{wrong:g} m" in event.reason
    assert gate.offer(channel, 0.3, (3e-5, 0.0)).kind == "input.standard_error"
    assert gate.offer(channel, 0.3, (math.nan,)).kind == "input.not_finite"
    assert "holding 3e-05 m" in gate.offer(channel, 0.2, (3e-5,)).action, "a stamp that was there"
    assert gate.coverage.unknown_until(1.0) == 0.0 and gate.held == START, "it is no input of the model"


@pytest.mark.parametrize("kind", ["input.frame", "input.not_stamped", "input.malformed"])
def test_a_message_that_only_the_caller_can_refuse_leaves_its_input_unknown_too(gate, kind):
    gate.offer("radial_load", 1.0, (800.0,))
    gate.refuse("radial_load", 1.5, kind, "as the caller says")
    assert gate.coverage.unknown_until(3.0) == pytest.approx(2.0)


def test_years_of_rare_faults_beside_a_silent_channel_are_counted_in_bounded_memory(gate):
    gate.offer("oil_temperature", 0.0, (350.0,))
    for k in range(1, 5001):
        for after, speed in ((0.0, 100.0), (1.0, math.nan), (2.0, 100.0)):
            gate.offer("shaft_speed", 10.0 * k + after, (speed,))
    assert gate.coverage.unknown_until(60_000.0) == pytest.approx(2.0 * 5000)
    assert len(gate.coverage._spans) <= 1001


@pytest.mark.parametrize("law, stands_in", [("network", "the thermal network"), ("given", "given in the scene")])
def test_a_ring_temperature_that_dies_leaves_the_held_inputs_after_ten_stale_times_says_what_stands_in_and_comes_back(law, stands_in):
    gate = InputGate(LIMITS, START, heat_law=law)
    assert gate.offer("inner_ring_temperature", 1.0, (350.0,)) is None
    assert not gate.expire(11.0) and gate.held.inner_ring_temperature == 350.0, "stale after 1 s, a temperature after ten times that"
    assert gate.expire(11.5) and math.isnan(gate.held.inner_ring_temperature)
    assert not gate.expire(12.0), "told once"
    (stale,) = [event for event in gate.check(12.0) if event.subject == "inner_ring_temperature"]
    assert stale.kind == "input.stale" and stale.level == Level.WARN and "10 s" in stale.reason and stands_in in stale.action
    assert gate.held._replace(inner_ring_temperature=math.nan)[:4] == START[:4], "what drives the bearing is held however old it is"
    assert gate.drain_returned() == []
    assert gate.offer("inner_ring_temperature", 20.0, (355.0,)) is None and gate.held.inner_ring_temperature == 355.0
    (returned,) = gate.drain_returned()
    assert (returned.kind, returned.level, returned.subject, returned.time) == ("input.returned", Level.OK, "inner_ring_temperature", 20.0)
    assert "input.stale" not in {event.kind for event in gate.check(20.0) if event.subject == "inner_ring_temperature"}
    assert gate.drain_returned() == []


def test_a_refused_ring_temperature_leaves_no_input_unknown_because_the_model_predicts_it():
    gate = InputGate(LIMITS, START, heat_law="network")
    gate.offer("inner_ring_temperature", 1.0, (350.0,))
    refused = gate.offer("inner_ring_temperature", 2.0, (math.nan,))
    assert refused.action == "message refused, holding 76.85 degC" and gate.coverage.unknown_until(5.0) == 0.0


def test_oil_and_rings_do_not_share_their_temperatures():
    gate = InputGate(LIMITS, START, heat_law="network")
    for channel, kelvin in (("oil_temperature", 340.0), ("inner_ring_temperature", 350.0), ("outer_ring_temperature", 345.0)):
        assert gate.offer(channel, 1.0, (kelvin,)) is None
    assert gate.held == (100.0, 800.0, 0.0, 340.0, 350.0, 345.0)
