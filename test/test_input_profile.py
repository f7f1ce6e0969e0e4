# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about judging a log: the gate's verdicts, linear between good messages, gaps and the common time told."""

import math
import random

import numpy as np
import pytest
from recordings import JOINTS, SECOND, TEMPERATURE, WRENCH, joint_state, steady_log, temperature, truncated, wrench, write_log

from bearing_sim.inputs.log import InputLogError, ReadError, read_input_log
from bearing_sim.inputs.profile import Messages, OnlineInputProfile, inputs_at, judge
from bearing_sim.recording.writer import McapFile
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

pytestmark = pytest.mark.filterwarnings("ignore::bearing_sim.files.tally.PartlyUsedWarning")
HELD = Inputs(0.0, 0.0, 0.0, 393.15)
LIMITS = InputLimits(maximum_speed=5000.0, maximum_load=2000.0, reverse_rotation=False, stale_after=1.0)
T0 = 1_700_000_000 * SECOND


def course_of(path, **options):
    return judge(read_input_log(path), LIMITS, HELD, **options)


def codes(course):
    return [event.kind for event in course.events]


def test_inputs_are_linear_between_stamps_of_each_channel(tmp_path):
    course = course_of(write_log(tmp_path / "log.mcap", [(0.0, 100.0), (0.4, 300.0)], [(0.0, 0.0, 50.0), (0.1, 100.0, 50.0), (0.4, 100.0, -10.0)]))
    middle = course.at(np.array([200_000_000]), 393.15)[0]
    assert middle == pytest.approx([200.0, 100.0, 30.0, 393.15, math.nan, math.nan], nan_ok=True)
    assert list(course.instants) == [0, 100_000_000, 400_000_000]


def test_course_begins_when_both_are_known_and_ends_with_the_first_that_ends(tmp_path):
    course = course_of(write_log(tmp_path / "log.mcap", [(t / 10, 100.0) for t in range(11)], [(t / 10, 1.0, 0.0) for t in range(3, 15)]))
    assert course.start_ns == T0 + 300_000_000
    assert course.end == 700_000_000


def test_oil_temperature_is_followed_where_recorded_and_else_the_scenes(tmp_path):
    speeds, loads = [(0.0, 1.0), (1.0, 1.0)], [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)]
    with_it = course_of(write_log(tmp_path / "a.mcap", speeds, loads, [(0.0, 20.0), (1.0, 40.0)]))
    without = course_of(write_log(tmp_path / "b.mcap", speeds, loads))
    assert with_it.at(np.array([500_000_000, 1_000_000_000]), 393.15)[:, 3] == pytest.approx([293.15, 313.15]), "held, as a live run must"
    assert without.at(np.array([500_000_000]), 393.15)[0, 3] == 393.15


def test_first_oil_temperature_counts_from_the_start_where_it_comes_soon_and_else_from_its_stamp(tmp_path):
    times = [t / 2 for t in range(31)]
    speeds, loads = [(t, 1.0) for t in times], [(t, 1.0, 0.0) for t in times]
    soon = course_of(write_log(tmp_path / "a.mcap", speeds, loads, [(9.0, 20.0)]))
    late = course_of(write_log(tmp_path / "b.mcap", speeds, loads, [(11.0, 20.0)]))
    assert soon.at(np.array([0, 8, 12]) * SECOND, 393.15)[:, 3] == pytest.approx([293.15, 293.15, 293.15])
    assert late.at(np.array([0, 8, 12]) * SECOND, 393.15)[:, 3] == pytest.approx([393.15, 393.15, 293.15])


def test_oil_topic_without_one_readable_message_leaves_the_scenes_temperature(tmp_path):
    path = tmp_path / "log.mcap"
    with McapFile(path) as recording:
        recording.write("/oil_temperature", TEMPERATURE, T0, temperature(0, 20.0))
        recording.write("/oil_temperature", TEMPERATURE, T0 + 1, temperature(0, 20.0))
        for place in range(3):
            recording.write("/shaft_speed", JOINTS, T0 + place, joint_state(T0 + place, 1.0))
            recording.write("/radial_load", WRENCH, T0 + place, wrench(T0 + place, 1.0))
    log = read_input_log(path)
    log.series["oil_temperature"].errors.append(ReadError(T0, "input.unreadable", "cannot be decoded"))
    for numbers in (log.series["oil_temperature"].stamps, log.series["oil_temperature"].log_times, log.series["oil_temperature"].values):
        numbers.clear()
    course = judge(log, LIMITS, HELD)
    assert course.at(course.instants, 350.0)[:, 3] == pytest.approx(350.0)
    assert course.tally.refused == {"input.unreadable": 1}


@pytest.mark.parametrize(
    "bad, code",
    [(math.nan, "input.not_finite"), (math.inf, "input.not_finite"), (-1.0, "input.negative"), (5001.0, "input.too_large")],
)
def test_bad_value_is_refused_counted_and_bridged_by_its_good_neighbours(tmp_path, bad, code):
    speeds = [(0.0, 100.0), (0.1, bad), (0.2, 300.0)]
    course = course_of(write_log(tmp_path / "log.mcap", speeds, [(t / 10, 1.0, 0.0) for t in range(3)]))
    assert course.tally.refused == {code: 1}
    assert codes(course) == [code] and course.events[0].time == pytest.approx(0.1)
    assert list(course.values["shaft_speed"]) == [100.0, 300.0]
    assert course.tally.there == 6


def test_repeated_and_backward_stamps_are_refused_by_their_own_names(tmp_path):
    speeds = [(0.0, 1.0), (0.1, 2.0), (0.1, 3.0), (0.05, 4.0), (0.2, 5.0)]
    course = course_of(write_log(tmp_path / "log.mcap", speeds, [(0.0, 1.0, 0.0), (0.2, 1.0, 0.0)]))
    assert course.tally.refused == {"input.time_repeated": 1, "input.time_backwards": 1}
    assert list(course.values["shaft_speed"]) == [1.0, 2.0, 5.0]


def test_of_many_faults_the_first_are_told_and_all_are_counted(tmp_path):
    speeds = [(t / 10, 1.0 if t in (0, 50) else math.nan) for t in range(51)]
    course = course_of(write_log(tmp_path / "log.mcap", speeds, [(t / 10, 1.0, 0.0) for t in range(51)]))
    assert course.tally.refused["input.not_finite"] == 49
    told = [event for event in course.events if event.kind == "input.not_finite"]
    assert len(told) == 6 and "44 more" in told[-1].text


def test_events_are_in_order_of_time(tmp_path):
    noise = random.Random(3)
    speeds = [(t / 10, noise.choice([1.0, math.nan, -5.0, 9e9])) for t in range(200)]
    course = course_of(write_log(tmp_path / "log.mcap", [(0.0, 1.0), *speeds[1:], (20.0, 1.0)], [(t / 10, 1.0, 0.0) for t in range(201)]))
    times = [event.time for event in course.events]
    assert times == sorted(times)


def test_a_long_silence_is_stale_and_a_gap(tmp_path):
    times = [t / 10 for t in range(10)] + [t / 10 for t in range(40, 50)]
    course = course_of(write_log(tmp_path / "log.mcap", [(t, 1.0) for t in times], [(t / 10, 1.0, 0.0) for t in range(50)]))
    assert course.gaps == [(900_000_000, 4_000_000_000)]
    assert {"input.stale", "input.gap"} <= set(codes(course))
    assert next(event.time for event in course.events if event.kind == "input.gap") == pytest.approx(0.9)


@pytest.mark.parametrize("spacing", [1.0, 60.0, 600.0, 7200.0])
def test_slow_but_steady_log_is_neither_stale_nor_too_slow_nor_a_gap_unless_asked_for(tmp_path, spacing):
    times = [spacing * k for k in range(5)]
    path = write_log(tmp_path / "log.mcap", [(t, 1.0) for t in times], [(t, 1.0, 0.0) for t in times], [(t, 60.0) for t in times])
    course = course_of(path)
    assert (course.gaps, codes(course)) == ([], []) if spacing < 3600.0 else codes(course)  # three spacings of hours alone prove no rate
    assert len(course_of(path, longest_gap=spacing / 2).gaps) == 8


def test_silence_of_a_slow_log_is_stale_by_its_own_rate(tmp_path):
    times = [60.0 * k for k in (*range(10), *range(14, 20))]  # five minutes between the tenth and the eleventh
    course = course_of(write_log(tmp_path / "log.mcap", [(t, 1.0) for t in times], [(60.0 * k, 1.0, 0.0) for k in range(20)]))
    assert codes(course) == ["input.stale"] and course.events[0].subject == "shaft_speed"
    assert " 180 s" in course.events[0].text and "linear" in course.events[0].text


def test_a_measured_ring_temperature_of_a_slow_log_holds_until_its_next_row(tmp_path):
    times = np.arange(5) * 600 * SECOND
    messages = {"shaft_speed": np.ones(5), "radial_load": np.ones((5, 2)), "inner_ring_temperature": np.array([340.0, 341.0, 342.0, 343.0, 344.0])}
    stamps = dict.fromkeys(messages, times)
    between = np.array([300, 900, 2700, 2400 + 1801]) * SECOND
    column = Inputs._fields.index("inner_ring_temperature")
    own, live = ({"inner_ring_temperature": 600.0}, {})
    found = [inputs_at(between, Messages(stamps, messages), LIMITS, 300.0, spacings)[:, column] for spacings in (own, live)]
    assert found[0] == pytest.approx([340.0, 341.0, 344.0, math.nan], nan_ok=True), "three of its spacings"
    assert np.isnan(found[1]).all(), "ten times stale_after in a live run"


def test_a_rate_that_falls_below_that_of_the_scene_and_of_the_log_is_told_once(tmp_path):
    times = [t / 10 for t in range(100)] + [10.0 + 2.0 * t for t in range(10)]
    path = write_log(tmp_path / "log.mcap", [(t, 1.0) for t in times], [(t / 10, 1.0, 0.0) for t in range(290)])
    course = judge(read_input_log(path), InputLimits(minimum_rate=5.0, stale_after=5.0), HELD)
    assert codes(course) == ["input.rate"] and course.events[0].subject == "shaft_speed"


def test_cut_log_is_told_at_its_end(tmp_path):
    whole = steady_log(tmp_path / "log.mcap", duration=2.0)
    cut = truncated(whole, tmp_path / "log.mcap.active", whole.stat().st_size - 20)
    assert codes(course_of(cut)) == ["log.unfinished"]


def test_log_of_which_nothing_passes_is_refused_with_the_reasons(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, math.nan), (1.0, math.nan)], [(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)])
    with pytest.raises(InputLogError, match="every message of shaft_speed was refused: 2 x input.not_finite"):
        course_of(path)


def test_channels_on_different_clocks_are_refused_with_their_spans(tmp_path):
    path = write_log(tmp_path / "log.mcap", [(0.0, 1.0), (1.0, 1.0)], [(5.0, 1.0, 0.0), (6.0, 1.0, 0.0)])
    with pytest.raises(InputLogError, match="both shaft speed and radial load are known .*--stamps log"):
        course_of(path)


def _messages(oil_ns):
    """Return constant speed and load over 100 s, and one oil temperature of 350 K at a stamp [ns]."""
    ends = np.array([0, 100 * SECOND])
    stamps = {"shaft_speed": ends, "radial_load": ends, "oil_temperature": np.array([oil_ns])}
    return Messages(stamps, {"shaft_speed": np.array([100.0, 100.0]), "radial_load": np.zeros((2, 2)), "oil_temperature": np.array([350.0])})


@pytest.mark.parametrize("stale_after", [0.5, 1.0])
def test_a_first_oil_temperature_counts_from_the_start_if_it_comes_within_ten_stale_times_and_from_its_stamp_if_later(stale_after):
    limits, instants = InputLimits(maximum_speed=5000.0, maximum_load=2000.0, stale_after=stale_after), np.array([0, 3 * SECOND, 20 * SECOND])
    patience = round(10 * stale_after * SECOND)
    soon, late = (inputs_at(instants, _messages(stamp), limits, 300.0)[:, 3] for stamp in (patience, patience + 1))
    assert soon.tolist() == [350.0, 350.0, 350.0]
    assert late.tolist() == [300.0, 300.0, 350.0]


def test_a_run_that_expects_an_oil_temperature_waits_for_it_ten_stale_times_and_no_longer():
    profile = OnlineInputProfile(100.0, LIMITS, 300.0)  # stale after 1 s
    for stamp in (T0, T0 + 60 * SECOND):
        profile.add_message("shaft_speed", stamp, 100.0)
        profile.add_message("radial_load", stamp, (800.0, 0.0))
    clock = T0 + 60 * SECOND
    assert profile.known_until(clock, T0 + 10 * SECOND, ["oil_temperature"]) == -1 and profile.awaited(T0 + 10 * SECOND, ["oil_temperature"]) == [
        "oil_temperature"
    ]
    assert profile.known_until(clock, T0 + 10 * SECOND + 1, ["oil_temperature"]) == T0 + 10 * SECOND + 1
    assert profile.known_until(clock, T0, []) == clock, "without a publisher it does not wait"


def test_a_set_of_the_oil_temperature_is_nothing_to_wait_for_and_acts_from_its_instant_or_where_the_model_is():
    profile = OnlineInputProfile(10.0, LIMITS, 300.0)
    for stamp in (T0, T0 + 2 * SECOND):
        profile.add_message("shaft_speed", stamp, 100.0)
        profile.add_message("radial_load", stamp, (800.0, 0.0))
    profile.set_oil_temperature(T0 + SECOND // 2, 310.0)
    assert profile.known_until(T0 + 2 * SECOND, T0, []) == T0 + 2 * SECOND
    first = profile.claim(T0 + SECOND)
    profile.set_oil_temperature(T0 + SECOND // 2, 320.0)
    second = profile.claim(T0 + 2 * SECOND)
    assert first.inputs[:, 3].tolist() == [300.0] * 6 + [310.0] * 5 and set(second.inputs[:, 3]) == {320.0}
    assert sum(map(len, (first.arrived, second.arrived))) == 5, "start, the temperature before the first set, two sets, end"


def test_what_is_unknown_is_a_part_of_the_log_also_where_one_channel_was_refused_before_the_other_begins(tmp_path):
    loads = [(0.1 * k, 3000.0 if k < 100 else 800.0, 0.0) for k in range(201)]
    speeds = [(0.1 * k, 100.0) for k in range(50, 201)]
    course = judge(read_input_log(write_log(tmp_path / "log.mcap", speeds, loads)), LIMITS, HELD)
    assert course.log_seconds == pytest.approx(15.0) and course.unknown_seconds == pytest.approx(5.0), "speed is known from 5 s on, load from 10 s on"
    assert course.end * 1e-9 == pytest.approx(10.0)


def test_a_measured_temperature_counts_for_ten_stale_times_after_its_stamp_and_then_is_not_measured():
    stamps = {"shaft_speed": np.array([0, 100 * SECOND]), "radial_load": np.array([0, 100 * SECOND])}
    stamps["inner_ring_temperature"] = np.array([2 * SECOND, 30 * SECOND])
    values = {"shaft_speed": np.array([100.0, 100.0]), "radial_load": np.zeros((2, 2)), "inner_ring_temperature": np.array([350.0, 360.0])}
    instants = np.array([0, 1, 12, 13, 29, 30, 40, 41]) * SECOND
    found = inputs_at(instants, Messages(stamps, values), LIMITS, 300.0)  # stale after 1 s
    np.testing.assert_array_equal(found[:, 4], [350.0, 350.0, 350.0, math.nan, math.nan, 360.0, 360.0, math.nan])
    assert np.isnan(found[:, 5]).all() and (found[:, 3] == 300.0).all()


def test_a_run_under_way_has_the_measured_temperatures_of_the_whole_log_however_it_is_cut():
    whole, channels = random.Random(4), ("shaft_speed", "radial_load", "oil_temperature", "inner_ring_temperature")
    measured = [(T0 + whole.randrange(0, 60 * SECOND), 340.0 + k) for k in range(8)]
    sent = {"shaft_speed": [(T0, 100.0), (T0 + 60 * SECOND, 100.0)], "radial_load": [(T0, (800.0, 0.0)), (T0 + 60 * SECOND, (800.0, 0.0))]}
    sent["inner_ring_temperature"] = sorted(measured)
    stamps = {channel: np.array([stamp for stamp, _ in found]) - T0 for channel, found in sent.items()}
    values = {channel: np.array([value for _, value in found]) for channel, found in sent.items()}
    profile = OnlineInputProfile(2.0, LIMITS, 300.0, channels)
    for channel, found in sent.items():
        for stamp, value in found:
            profile.add_message(channel, stamp, value)
    taken, until = [], T0
    while until < T0 + 60 * SECOND:
        until = min(until + whole.randrange(1, 5 * SECOND), T0 + 60 * SECOND)
        while (part := profile.claim(until)) is not None:
            taken.append(part)
    instants, found = np.concatenate([part.instants for part in taken]), np.concatenate([part.inputs for part in taken])
    expected = inputs_at(instants, Messages(stamps, values), LIMITS, 300.0)
    np.testing.assert_array_equal(found, expected)
    assert 0 < np.isnan(expected[:, 4]).sum() < len(expected)


def test_measured_temperatures_of_a_log_are_left_out_and_told_where_the_scene_has_no_law_of_heat(tmp_path):
    from sim_time_bench import Message, write

    at = [0.0, 1.0, 2.0]
    found = [Message(time, channel, values) for time in at for channel, values in (("shaft_speed", (100.0,)), ("radial_load", (800.0, 0.0)))]
    path = write(tmp_path / "log.mcap", [*found, *(Message(time, "inner_ring_temperature", (350.0,)) for time in at)])
    log = read_input_log(path)
    used, unused = (judge(log, LIMITS, HELD, heat_law=law) for law in ("network", "none"))
    assert used.at(np.array([SECOND]), 300.0)[0, 4] == 350.0 and "input.unused" not in codes(used)
    assert "inner_ring_temperature" not in unused.stamps and math.isnan(unused.at(np.array([SECOND]), 300.0)[0, 4])
    (told,) = [event for event in unused.events if event.kind == "input.unused"]
    assert told.subject == "inner_ring_temperature" and "set heat.law to given or network" in told.action


def test_measured_cage_speeds_come_with_their_times_in_seconds(tmp_path):
    from sim_time_bench import Message, write

    found = [Message(time, channel, values) for time in (0.0, 0.5) for channel, values in (("shaft_speed", (100.0,)), ("radial_load", (800.0, 0.0)))]
    cage = [Message(0.25, "cage_speed_measured", (40.0,)), Message(0.5, "cage_speed_measured", (41.0, 0.2))]
    without, stated = course_of(write(tmp_path / "log.mcap", [*found, *cage])).measured
    assert without == pytest.approx((0.25, 40.0, math.nan), nan_ok=True) and stated == pytest.approx((0.5, 41.0, 0.2))
    assert course_of(write_log(tmp_path / "without.mcap", [(0.0, 100.0), (0.5, 100.0)], [(0.0, 1.0, 0.0), (0.5, 1.0, 0.0)])).measured == []
