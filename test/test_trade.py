# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The trade: front and recommendation against brute force, errors against known ones, and the command."""

import csv
import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given
from hypothesis import strategies as st

from bearing_sim import load_scene
from bearing_sim.cli.bench import _print_trade
from bearing_sim.cli.main import main
from bearing_sim.studies.trade import Course, Setting, Trade, Traded, front_of, recommend, settings_of, trade
from bearing_sim.studies.trade import _errors as errors

SETTING = Setting("slip", "tolerances x 1", ())
PAIRS = st.lists(st.tuples(st.floats(0.01, 1e5), st.floats(0.0, 10.0)), min_size=1, max_size=30)


def measured(pairs):
    return [Traded(SETTING, factor, error, error, 0.0, 0.0, "") for factor, error in pairs]


def found(pairs):
    ones = measured(pairs)
    return Trade(ones, front_of(ones), "", (0.0, 0.0, 0.0, 0.0), 1.0, {})


@given(PAIRS)
def test_front_holds_what_nothing_beats_in_speed_and_error(pairs):
    ones = measured(pairs)
    front = {(ones[k].real_time_factor, ones[k].slip_error) for k in front_of(ones)}
    unbeaten = {a for a in pairs if not any(b != a and b[0] >= a[0] and b[1] <= a[1] for b in pairs)}
    assert front == unbeaten


@given(PAIRS, st.floats(0.01, 1e5), st.floats(0.0, 10.0))
def test_recommendation_is_the_best_of_all_settings(pairs, factor, error):
    exact = recommend(found(pairs), factor=factor)
    able = [pair[1] for pair in pairs if pair[0] >= factor]
    assert (exact.slip_error if exact else None) == (min(able) if able else None)
    fast = recommend(found(pairs), error=error)
    able = [pair[0] for pair in pairs if pair[1] <= error]
    assert (fast.real_time_factor if fast else None) == (max(able) if able else None)


def test_errors_that_the_reference_cannot_tell_apart_do_not_lengthen_the_front():
    ones = measured([(10.0, 0.02), (5.0, 0.01), (1.0, 0.001)])
    assert front_of(ones) == [0, 1, 2]
    assert front_of(ones, 0.015) == [0, 1]


def test_a_failed_setting_is_on_no_front():
    ones = [*measured([(1.0, 0.1)]), Traded(SETTING, *[math.nan] * 5, "ran out of steps")]
    assert front_of(ones) == [0]


def test_errors_are_root_mean_squares_over_bins_with_the_largest_of_slip_and_the_life_that_damage_means():
    reference = Course(np.array([6.0, 8.0]), np.array([900.0, 1100.0]), 1e-6)
    other = Course(np.array([6.3, 8.4]), np.array([930.0, 1060.0]), 2e-6)
    slip, largest, load, life = errors(other, reference)
    assert slip == pytest.approx(math.sqrt((0.3**2 + 0.4**2) / 2))
    assert largest == pytest.approx(0.4)
    assert load == pytest.approx(math.sqrt((30**2 + 40**2) / 2) / 1000)
    assert life == pytest.approx(0.5)  # half the life
    assert errors(reference, reference) == (0.0, 0.0, 0.0, 0.0)


def test_every_setting_of_every_level_is_a_scene():
    for level in ("slip", "planar", "spatial"):
        for setting in settings_of(level):
            load_scene("deng2017_table1", [f"level={level}", *setting.overrides])


def test_command_measures_writes_and_recommends(tmp_path):
    table, picture = tmp_path / "trade.csv", tmp_path / "trade.png"
    words = ["trade", "deng2017_table1", "--quick", "--level", "slip", "--level", "planar", "--error", "0.5", "--json"]
    result = CliRunner().invoke(main, [*words, "--csv", str(table), "--picture", str(picture)])
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
        trade("deng2017_table1", overrides, ["slip"], quick=True, progress=lambda name: None)


def test_a_scene_at_rest_is_refused():
    result = CliRunner().invoke(main, ["trade", "deng2017_table1", "--set", "operating.shaft_speed=0 rpm"])
    assert result.exit_code == 2
    assert "expected a rotating shaft" in result.output


def test_a_trade_names_the_levels_that_it_did_not_measure(capsys):
    found = Trade([], [], "planar", (0.01, 0.02, 1e-3, 1e-3), 0.5, {"spatial": "needs slices"})
    _print_trade("motor", found)
    assert "not measured: spatial (needs slices)" in capsys.readouterr().out
