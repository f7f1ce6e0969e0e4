# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The trade: front and recommendation against brute force, errors against known ones, and the command."""

import csv
import json
import math
import re

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st
from recordings import steady_log

from bearing_sim import load_scene
from bearing_sim.cli.main import main
from bearing_sim.cli.trade import _COURSES, measured_in_words, print_trade
from bearing_sim.simulation import Simulation
from bearing_sim.studies.trade import (
    NO_ERRORS,
    Candidate,
    Errors,
    Results,
    Trade,
    Traded,
    _Lowered,
    _settled_start,
    _with_edges,
    front_of,
    recommend,
    settings_of,
    trade,
)
from bearing_sim.studies.trade import _errors as errors
from bearing_sim.studies.trade import _mean_slips as mean_slips
from bearing_sim.studies.trade_course import OUTLINES, bin_edges, built_in, time_of_turns, turned, windows_of

SETTING = Candidate("slip", "tolerances x 1", ())
SCENE = load_scene("deng2017_table1")
COURSE = built_in("manoeuvre", SCENE)
PAIRS = st.lists(st.tuples(st.floats(0.01, 1e5), st.floats(0.0, 10.0)), min_size=1, max_size=30)


def measured(pairs):
    return [Traded(SETTING, factor, Errors(error, error, 0.0, 0.0, 0.0, 0.0)) for factor, error in pairs]


def found(pairs):
    ones = measured(pairs)
    return Trade(ones, front_of(ones), "", Errors(*[0.0] * 6), COURSE, {})


@given(PAIRS)
def test_front_holds_what_nothing_beats_in_speed_and_error(pairs):
    ones = measured(pairs)
    front = {(ones[k].real_time_factor, ones[k].errors.slip) for k in front_of(ones)}
    unbeaten = {a for a in pairs if not any(b != a and b[0] >= a[0] and b[1] <= a[1] for b in pairs)}
    assert front == unbeaten


@given(PAIRS, st.floats(0.01, 1e5), st.floats(0.0, 10.0))
def test_recommendation_is_the_best_of_all_settings(pairs, factor, error):
    exact = recommend(found(pairs), factor=factor)
    able = [pair[1] for pair in pairs if pair[0] >= factor]
    assert (exact.errors.slip if exact else None) == (min(able) if able else None)
    fast = recommend(found(pairs), error=error)
    able = [pair[0] for pair in pairs if pair[1] <= error]
    assert (fast.real_time_factor if fast else None) == (max(able) if able else None)


def test_errors_that_the_reference_cannot_tell_apart_do_not_lengthen_the_front():
    ones = measured([(10.0, 0.02), (5.0, 0.01), (1.0, 0.001)])
    assert front_of(ones) == [0, 1, 2]
    assert front_of(ones, 0.015) == [0, 1]


def test_the_front_ends_where_errors_fall_below_that_of_the_reference():
    ones = measured([(900.0, 2.0), (12.0, 2.1), (5.0, 0.05), (1.0, 0.0004), (0.5, 0.0001)])
    assert front_of(ones, 0.0005) == [0, 2, 3]


def test_a_failed_setting_is_on_no_front():
    ones = [*measured([(1.0, 0.1)]), Traded(SETTING, math.nan, NO_ERRORS, "ran out of steps")]
    assert front_of(ones) == [0]


def results(slip, load, damage):
    return Results(np.array(slip), np.array(load), damage, np.zeros(len(slip)), np.zeros(len(slip)))


def test_errors_are_root_mean_squares_over_bins_with_the_largest_and_the_life_that_damage_means():
    reference, other = results([6.0, 8.0], [900.0, 1100.0], 1e-6), results([6.3, 8.4], [930.0, 1060.0], 2e-6)
    one = errors([other], [reference])
    assert one.slip == pytest.approx(math.sqrt((0.3**2 + 0.4**2) / 2))
    assert one.largest_slip == pytest.approx(0.4)
    assert one.load == pytest.approx(math.sqrt((30**2 + 40**2) / 2) / 1000)
    assert one.largest_load == pytest.approx(0.04)
    assert one.life == one.window_life == pytest.approx(0.5)  # half the life
    assert errors([reference], [reference])[:6] == (0.0,) * 6
    assert math.isnan(one.edge)  # which only slices have


def test_life_errors_that_cancel_over_a_course_show_in_its_windows():
    true = [results([5.0], [1.0], 1e-6), results([5.0], [1.0], 3e-6)]
    found = [results([5.0], [1.0], 2e-6), results([5.0], [1.0], 2e-6)]
    one = errors(found, true)
    assert one.life == pytest.approx(0.0)
    assert one.window_life == pytest.approx(0.5)  # 1e-6 instead of 2e-6; the other window errs by as much the other way


def test_errors_of_edge_loads_are_against_the_finest_slices_and_unknown_without_them():
    settings = [setting for setting in settings_of("spatial") if setting.detail in ("tolerances x 1", "200 slices")]
    runs = [[{"edge": [11.0, 9.0], "pressure": [100.0, 100.0]}], [{"edge": [10.0, 10.0], "pressure": [150.0, 50.0]}]]
    ones = [Traded(setting, 1.0, Errors(*[0.0] * 6)) for setting in settings]
    coarse, finest = _with_edges(ones, runs)
    assert (coarse.errors.edge, coarse.errors.largest_edge) == pytest.approx((0.01, 0.01))
    assert math.isnan(finest.errors.edge)
    assert math.isnan(_with_edges(ones[:1], runs[:1])[0].errors.edge)


def test_every_setting_of_every_level_is_a_scene():
    for level in ("slip", "planar", "spatial"):
        for setting in settings_of(level):
            load_scene("deng2017_table1", [f"level={level}", *setting.overrides])


def test_command_measures_writes_and_recommends(tmp_path):
    table, picture = tmp_path / "trade.csv", tmp_path / "trade.png"
    words = ["trade", "deng2017_table1", "--quick", "--level", "slip", "--level", "planar", "--error", "0.5", "--json", "--workers", "1"]
    result = CliRunner().invoke(main, [*words, "--out", str(table), "--picture", str(picture)])
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    slip, planar = report["settings"]
    assert planar["slip_error_points"] < 0.2 < slip["slip_error_points"]
    assert report["recommended"].startswith("planar")
    with open(table, newline="") as file:
        assert [row["level"] for row in csv.DictReader(file)] == ["slip", "planar"]
    assert picture.stat().st_size > 10_000


def test_a_level_that_cannot_compute_the_scene_is_left_out_with_its_reason():
    overrides = ["level=spatial", "operating.misalignment=1 mrad"]
    with pytest.raises(ValueError, match="misalignment: needs level spatial"):
        trade("deng2017_table1", overrides, ["slip"], quick=True)


def test_a_scene_at_rest_is_refused():
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", "--set", "operating.shaft_speed=0 rpm"])
    assert result.exit_code == 2
    assert "expected a rotating shaft" in result.output


def test_a_trade_names_the_levels_that_it_did_not_measure(capsys):
    found = Trade([], [], "planar", Errors(0.01, 0.02, 1e-3, 2e-3, 1e-3, 1e-3), COURSE, {"spatial": "needs slices"})
    print_trade("motor", found)
    assert "not measured: spatial (needs slices)" in capsys.readouterr().out


def test_a_trade_prints_failed_settings_last_and_no_number_where_there_is_none(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "300")  # wide enough for all in one part
    failed = Traded(SETTING, math.nan, NO_ERRORS, "ran out of steps")
    sliced = measured([(3.0, 0.1)])[0]
    sliced = sliced._replace(errors=sliced.errors._replace(edge=0.01))
    found = Trade([failed, *measured([(1.0, 0.1), (2.0, 0.1)]), sliced], [], "planar", Errors(0.01, 0.02, 1e-3, 2e-3, 1e-3, 1e-3), COURSE, {})
    print_trade("motor", found)
    printed = capsys.readouterr().out
    rows = [line for line in printed.splitlines() if line.count("│") > 5]
    factors = [line.split("│")[4].strip() for line in rows]
    assert factors == ["3", "2", "1", "-"] and "ran out of steps" in rows[-1] and "nan" not in printed


def numeric_turns(times, speeds, end):
    """Return turns of an ideal cage by summing over a million instants."""
    gamma, instants = SCENE.bearing.diameter_ratio, np.linspace(times[0], end, 1_000_001)
    middle = 0.5 * (instants[1:] + instants[:-1])
    return float(np.sum(np.interp(middle, times, speeds)) * (instants[1] - instants[0]) * 0.5 * (1 - gamma) / (2 * np.pi))


def test_turns_of_the_cage_are_the_integral_of_its_speed_and_their_instants_the_inverse():
    times, speeds = np.array([0.0, 0.1, 0.4, 0.5]), np.array([100.0, 4000.0, 4000.0, 500.0])
    ends = np.array([0.05, 0.1, 0.27, 0.5])
    found = turned(SCENE, times, speeds, ends)
    assert found == pytest.approx([numeric_turns(times, speeds, end) for end in ends], rel=1e-6)
    assert time_of_turns(SCENE, times, speeds, found) == pytest.approx(ends, rel=1e-12)


@pytest.mark.parametrize("name", OUTLINES)
def test_a_built_in_course_has_bins_of_equal_turns_after_settling_whatever_the_speed(name):
    (window,) = built_in(name, SCENE).windows
    edges = bin_edges(SCENE, window)
    assert edges[0] == window.settling and edges[-1] == window.seconds
    speeds = [row[0] for row in window.inputs]
    turns = [numeric_turns(window.times, speeds, edge) for edge in (edges[0] or 1e-12, edges[1], edges[-2], edges[-1])]
    assert turns[1] - turns[0] == pytest.approx(turns[3] - turns[2], rel=1e-3)
    assert 1.0 < turns[1] - turns[0] < 2.2


def test_built_in_courses_are_fractions_of_the_scene():
    scene = load_scene("deng2017_table1", ["operating.radial_load=100 N"])
    course = built_in("run_down", scene)
    fastest = scene.operating.shaft_speed
    assert course.extent()["shaft_speed"] == pytest.approx((0.1 * fastest, fastest))
    assert course.extent()["radial_load"] == pytest.approx((100.0, 100.0))
    assert set(_COURSES) == set(OUTLINES)
    start = built_in("start", scene).windows[0]
    assert start.at(0.0).shaft_speed == pytest.approx(0.03 * fastest) and start.at(start.seconds).shaft_speed == pytest.approx(fastest)


def log_of(speed_of, seconds, spacing=0.1):
    times = np.arange(0.0, seconds + 1e-9, spacing)
    inputs = np.full((len(times), 6), np.nan)
    inputs[:, 0], inputs[:, 1], inputs[:, 2], inputs[:, 3] = speed_of(times), 800.0, 0.0, 350.0
    return times, inputs, np.zeros(len(times), bool)


def test_windows_of_a_log_have_as_many_turns_and_spread_evenly_over_the_time_in_which_the_shaft_turns():
    def speeds(times):
        return np.select([times < 100.0, times < 300.0, times < 400.0], [0.0, 1000.0, 0.0], 4000.0)

    times, inputs, in_gap = log_of(speeds, 600.0)
    in_gap[2000] = True  # nothing is known from 199.9 to 200 s
    course = windows_of("flight", SCENE, times, inputs, in_gap, 20, 60.0)
    assert len(course.windows) == 20
    for window in course.windows:
        speeds = [row[0] for row in window.inputs]
        assert min(speeds) > 0.0
        assert not window.begin < 199.95 < window.begin + window.seconds
        assert numeric_turns(window.times, speeds, window.seconds) == pytest.approx(60.0, rel=1e-3)
        assert numeric_turns(window.times, speeds, window.settling) == pytest.approx(20.0, rel=1e-3)
    begins = np.array([window.begin for window in course.windows])
    assert sum(begins < 300.0) == 10  # turns for as long in both parts, though four times as fast in the second
    assert np.ptp(np.diff(begins[begins > 400.0])) < 1.0
    assert course.turning == pytest.approx(400.0, abs=1.0) and course.log_seconds == pytest.approx(600.0)


def test_a_short_log_has_fewer_windows_and_none_without_a_few_turns():
    times, inputs, in_gap = log_of(lambda times: np.full(len(times), 100.0), 3.0)  # 20 turns or so of the cage
    course = windows_of("short", SCENE, times, inputs, in_gap)
    assert len(course.windows) == 1 and course.measured == pytest.approx(3.0)
    with pytest.raises(ValueError, match="for at most 2.* turns of the cage.*give a longer log, or a built-in course"):
        windows_of("shorter", SCENE, *(part[:5] for part in (times, inputs, in_gap)))


def test_inputs_within_a_window_are_those_of_the_log():
    times, inputs, in_gap = log_of(lambda times: 500.0 + 10.0 * times, 60.0)
    inputs[:, 1], inputs[:, 3] = 100.0 + times, 350.0 + np.floor(times)
    for window in windows_of("ramp", SCENE, times, inputs, in_gap, 3, 20.0).windows:
        for at in (0.0, 0.37 * window.seconds, window.seconds):
            there = window.at(at)
            assert there.shaft_speed == pytest.approx(500.0 + 10.0 * (window.begin + at))
            assert there.load_y == pytest.approx(100.0 + window.begin + at)
            assert there.oil_temperature == pytest.approx(350.0 + np.floor(window.begin + at), abs=1.0) and there.oil_temperature % 1.0 == 0.0


def test_a_table_that_cannot_be_corrected_fails_alone(monkeypatch):
    plain, corrected = settings_of("steady")
    monkeypatch.setattr("bearing_sim.studies.trade.settings_of", lambda level, quick: [corrected, SETTING, corrected])

    def refuse(*_):
        raise ValueError("too few points have answers")

    monkeypatch.setattr("bearing_sim.studies.trade.obtain_corrected_table", refuse)
    found = trade("deng2017_table1", [], ["slip"], quick=True, against="slip", workers=1)
    assert [one.failure for one in found.measured] == ["too few points have answers", "", "too few points have answers"]
    assert found.front == [1]


def test_a_flight_is_measured_in_a_few_windows_and_says_so():
    times, inputs, in_gap = log_of(lambda times: np.full(len(times), 4700.0), 4680.0, 1.0)
    course = windows_of("flight.mcap", SCENE, times, inputs, in_gap)
    said = measured_in_words(course)
    assert "over 12 windows" in said and "of the 4680 s" in said
    assert f"({100 * course.measured / 4680.0:.2g} %)" in said


SLIP = ("--level", "slip", "--against", "slip", "--workers", "1", "--json")


def traded(*words):
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", *map(str, words)])
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


def test_a_trade_on_a_recording_measures_its_windows(tmp_path):
    steady_log(tmp_path / "log.mcap", duration=3.0, speed=2000.0, load=600.0)
    report = traded("--course", tmp_path / "log.mcap", "--quick", "--window-turns", "20", *SLIP)
    (window,) = report["windows"]
    assert window["seconds"] == pytest.approx(20.0 / numeric_turns([0.0, 1.0], [2000.0, 2000.0], 1.0), rel=1e-4)
    assert report["range"]["shaft_speed"] == pytest.approx([2000.0, 2000.0]) and report["range"]["radial_load"] == pytest.approx([600.0, 600.0])
    assert report["course"] == "log.mcap" and report["turning_seconds"] == pytest.approx(3.0, abs=0.2)
    (slip,) = report["settings"]
    assert slip["slip_error_points"] < 0.1 and slip["failure"] == ""


MAPPING = """
name: rig
time: {column: t, unit: s, epoch: 2020-01-01}
shaft_speed: {column: n, unit: rpm}
radial_load: {law: sum, columns: [{column: f, unit: N}]}
"""


def test_a_trade_on_a_table_takes_a_mapping_and_asks_for_it(tmp_path):
    table, mapping = tmp_path / "rig.csv", tmp_path / "rig.yaml"
    table.write_text("t,n,f\n" + "".join(f"{k / 10},20000,600\n" for k in range(20)))
    mapping.write_text(MAPPING)
    report = traded("--course", table, "--mapping", mapping, "--quick", "--window-turns", "20", *SLIP)
    assert report["range"]["shaft_speed"] == pytest.approx([20000 * np.pi / 30] * 2)
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", "--course", str(table)])
    assert result.exit_code == 2 and "needs a mapping" in result.output and "import-csv --guess" in result.output


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--course", "run_dwon"), "no such file or built-in course.*run_down"),
        (("--course", "idle", "--load", "800N"), "is built in"),
        (("--windows", "0"), "--windows"),
    ],
)
def test_a_course_that_cannot_be_is_refused(words, message):
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", *words])
    assert result.exit_code == 2
    assert re.search(message, result.output), result.output


def test_a_log_of_a_shaft_at_rest_is_refused(tmp_path):
    steady_log(tmp_path / "rest.mcap", speed=0.0)
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", "--course", str(tmp_path / "rest.mcap")])
    assert result.exit_code == 2 and "give a longer log" in result.output


def test_an_interrupted_trade_goes_on_from_its_journal(tmp_path):
    journal = tmp_path / "trade.journal"
    words = ("--quick", "--journal", journal, *SLIP)
    whole = traded(*words)
    lines = journal.read_text().splitlines(keepends=True)
    assert len(lines) == 3  # two runs of the reference and one setting
    again = traded(*words)
    assert again == whole  # with the same processor times
    journal.write_text("".join(lines[:2]))
    assert traded(*words)["reference_error"] == whole["reference_error"]
    assert journal.read_text().splitlines(keepends=True)[:2] == lines[:2] and len(journal.read_text().splitlines()) == 3


def test_a_window_begins_in_the_settled_state_of_the_bearing():
    run = Simulation(load_scene("deng2017_table1", ["operating.shaft_speed=15000 rpm", "level=slip"]))
    run.advance(1.0)
    rested = float(run.advance(0.05, samples=50)["cage_slip"].mean())
    start, nodes = _settled_start(_Lowered(run.scene), run.inputs)
    assert float(start["cage_slip"]) == pytest.approx(rested, abs=1e-3) and nodes is None


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_mean_slips_are_exact_however_far_samples_are_apart_and_slip_changes(sense):
    """A cage that begins to slip, by half in the end, evenly in time, on a shaft that turns evenly."""
    scene, times = load_scene("deng2017_table1"), np.array([0.0, 0.1, 0.15, 1.0])
    samples = np.zeros(4, [("cage_angle", float), ("shaft_angle", float)])
    samples["shaft_angle"] = sense * 1000.0 * times
    samples["cage_angle"] = 7.0 + sense * 500.0 * (1.0 - scene.bearing.diameter_ratio) * (times - 0.25 * times**2)
    assert mean_slips(scene, samples) == pytest.approx(100.0 * 0.25 * (times[1:] + times[:-1]), rel=1e-9)
