# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Wants with errors: the fastest measured setting that keeps them, in the recorded scene too, and no claim where nothing is known."""

import math

import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from bearing_sim import SceneError, load_scene
from bearing_sim.cli.main import main
from bearing_sim.scene import measured_tradeoffs
from bearing_sim.scene.fidelity import hint
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml, with_setting
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting, Tradeoffs, complete_overrides, keep
from bearing_sim.scene.requirements import candidates
from bearing_sim.studies.trade import Errors

NAMES = Errors._fields


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path / "fronts")


def scene(*overrides):
    return load_scene("deng2017_table1", overrides)


AUTO = ("level=auto", "wants={slip: 0.3 %, life: 5 %}")
HERE = scene()
EXTENT = {
    "shaft_speed": (0.5 * HERE.operating.shaft_speed, HERE.operating.shaft_speed),
    "radial_load": (400.0, 800.0),
    "oil_temperature": (HERE.lubricant.temperature, HERE.lubricant.temperature),
}


def setting(level, factor, slip, life, overrides=(), detail="tolerances x 1", **more):
    errors = dict.fromkeys(NAMES, math.nan) | {"slip": slip, "largest_slip": 1.5 * slip, "life": life, "window_life": 1.5 * life} | more
    return Setting(level, detail, complete_overrides(scene(f"level={level}", *overrides)), factor, errors)


STEADY = setting("steady", 1860.0, 1.9, 0.12, detail="table")
SLIP = setting("slip", 15.0, 1.85, 0.12)
COARSE = setting("planar", 6.9, 0.06, 0.01, ["integration.relative_tolerance=0.09"], "tolerances x 3")
PLANAR = setting("planar", 5.2, 0.047, 0.008)
FINE = setting("planar", 0.4, 0.0003, 0.0001, ["integration.relative_tolerance=0.0009"], "tolerances x 0.03")
SPATIAL = setting("spatial", 1.03, 0.047, 0.008, edge=0.08, largest_edge=0.1)
SLICED = setting("spatial", 0.3, 0.047, 0.008, ["bearing.roller.slices=50"], "50 slices", edge=0.02, largest_edge=0.04)
ALL = (STEADY, SLIP, COARSE, PLANAR, FINE, SPATIAL, SLICED)


def course(*ones, name="manoeuvre", extent=EXTENT, own=0.0001):
    return MeasuredCourse(name, "planar with tolerances x 0.01", dict.fromkeys(NAMES, own), extent, ones or ALL)


def test_the_fastest_setting_within_all_wanted_errors_is_chosen_with_its_overrides():
    keep(HERE, course())
    chosen = scene(*AUTO)
    assert chosen.level == "planar"
    assert chosen.integration.relative_tolerance == 0.09
    assert scene("level=auto", "wants={slip: 3 %, life: 20 %}").level == "steady"
    assert scene("level=auto", "wants={slip: 0.001 %}").integration.relative_tolerance == 0.0009


def test_the_choice_says_in_one_line_what_was_measured_and_how_fast_it_ran():
    keep(HERE, course())
    line = hint(scene(*AUTO))
    assert line.startswith("level planar chosen with tolerances x 3") and "\n" not in line
    for words in (
        "slip 0.06 of 0.3 points (largest 0.09)",
        "life 1 of 5 % (largest 1.5)",
        "6.9 times real time",
        "86 % of a core to spare",
        "manoeuvre",
    ):
        assert words in line
    assert "too slow to follow a live bearing" in hint(scene("level=auto", "wants={slip: 0.001 %}"))


def test_a_scene_recorded_after_the_choice_is_the_same_without_the_front(monkeypatch, tmp_path):
    keep(HERE, course())
    chosen = scene("level=auto", "wants={slip: 0.3 %, life: 5 %, edge_loads: 3 %}")
    assert chosen.level == "spatial" and chosen.bearing.roller.slices == 50
    text = scene_to_yaml(chosen)
    monkeypatch.setattr(measured_tradeoffs, "FOLDER", tmp_path / "elsewhere")
    assert scene_from_yaml(text) == chosen
    assert "level: spatial" in text and "slip: 0.003" in text


def test_a_corrected_table_is_chosen_with_the_command_that_builds_it():
    keep(HERE, course(*ALL, STEADY._replace(errors=PLANAR.errors, overrides=("integration.fixed_step=null", "table.correction=planar"))))
    chosen = scene(*AUTO)
    assert chosen.level == "steady" and chosen.table.correction == "planar"
    assert chosen.level_reason.endswith("; a node needs its table: bearing-sim table deng2017_table1, with the same --set, if any")


def test_edge_loads_have_an_error_only_where_slices_were_measured():
    keep(HERE, course())
    assert scene("level=auto", "wants={edge_loads: 10 %}").bearing.roller.slices is None
    line = scene("level=auto", "wants={edge_loads: 1 %}").level_reason
    assert line.startswith("level spatial chosen, the most accurate") and "no setting measured on manoeuvre (kept front " in line


def test_a_largest_error_above_three_times_the_wanted_one_is_too_much():
    rare = setting("planar", 50.0, 0.06, 0.01, detail="rare", largest_slip=0.95)
    keep(HERE, course(*ALL, rare._replace(overrides=("integration.relative_tolerance=0.2",))))
    assert scene(*AUTO).integration.relative_tolerance == 0.09
    assert scene("level=auto", "wants={slip: 0.32 %}").integration.relative_tolerance == 0.2


def test_an_error_below_that_of_the_reference_is_not_claimed():
    keep(HERE, course(own=0.01))
    assert "no setting measured" in scene("level=auto", "wants={slip: 0.005 %}").level_reason
    assert scene("level=auto", "wants={slip: 0.02 %}").integration.relative_tolerance == 0.0009


FACTORS, SLIPS, LIVES = st.floats(0.01, 1e4), st.floats(1e-4, 5.0), st.floats(1e-4, 0.5)


@settings(max_examples=50, deadline=None)
@given(st.lists(st.tuples(FACTORS, SLIPS, LIVES), min_size=1, max_size=8), SLIPS, LIVES)
def test_candidates_are_those_that_a_plain_comparison_finds(rows, slip, life):
    ones = [PLANAR._replace(real_time_factor=factor, detail=str(k), overrides=(str(k),), errors=dict.fromkeys(NAMES, math.nan) | {
        "slip": a, "largest_slip": 2.0 * a, "life": b, "window_life": 4.0 * b}) for k, (factor, a, b) in enumerate(rows)]  # fmt: skip
    found = candidates(HERE, {"slip": slip / 100, "life": life}, Tradeoffs(None, (course(*ones, own=0.0),)))
    plain = [k for k, (_, a, b) in enumerate(rows) if a / 100 <= slip / 100 and 4.0 * b <= 3.0 * life]
    assert sorted(int(one.detail) for one in found) == plain
    assert [one.real_time_factor for one in found] == sorted((rows[k][0] for k in plain), reverse=True)


def test_where_nothing_was_measured_the_most_accurate_level_is_taken_and_no_error_claimed():
    chosen = scene(*AUTO)
    assert chosen.level == "planar" and chosen.integration == HERE.integration
    line = hint(chosen)
    assert "its errors are not known" in line and "bearing-sim trade deng2017_table1" in line and "\n" not in line
    assert scene(*AUTO, "operating.misalignment=1 mrad").level == "spatial"
    assert scene("level=auto", "wants={slip: 1 %}", "bearing.cage.guidance=full_complement").level == "slip"


def test_what_was_measured_elsewhere_says_nothing_here():
    keep(HERE, course())
    line = scene(*AUTO, "operating.radial_load=3 kN").level_reason
    assert "measured elsewhere than where the scene operates" in line and "400 to 800 N" in line and "45000 rpm" in line


def test_another_bearing_has_no_front():
    keep(HERE, course())
    assert "no error was measured of this bearing" in scene(*AUTO, "bearing.roller.count=17").level_reason


def test_the_worst_of_several_courses_counts():
    keep(HERE, course())
    keep(HERE, course(PLANAR, COARSE._replace(errors=COARSE.errors | {"slip": 0.4}), name="start"))
    chosen = scene(*AUTO)
    assert chosen.integration.relative_tolerance == HERE.integration.relative_tolerance and "(manoeuvre, start; kept front " in chosen.level_reason


def test_a_level_that_lacks_what_the_scene_asks_for_is_not_chosen_however_fast():
    keep(HERE, course())
    assert scene("level=auto", "wants={slip: 3 %, cage_orbit: }").level == "planar"


def test_a_fixed_step_too_long_for_the_speed_is_passed_over():
    step = Setting("planar", "step 40 us", ("integration.fixed_step=4e-05",), 100.0, PLANAR.errors)
    keep(HERE, course(step, PLANAR, extent=EXTENT | {"shaft_speed": (100.0, 11000.0)}))
    fast = 0.5 * 2 * math.pi / (18 * 0.5 * 4e-5 * (1 - HERE.bearing.diameter_ratio))  # half a pitch takes 40 us
    chosen = scene(*AUTO, f"operating.shaft_speed={min(1.1 * fast, 11000.0)} rad/s")
    assert chosen.level == "planar" and (chosen.integration.fixed_step is None) == (1.1 * fast < 11000.0)


@pytest.mark.parametrize(
    ("wants", "path", "message"),
    [
        ("{slip: 0.3 %, power: 2 %}", "wants.power", "measures no error of it, only of slip, life, roller_loads, edge_loads"),
        ("{slipp: 1 %}", "wants.slipp", "did you mean 'slip'"),
        ("{slip: 3 mm}", "wants.slip", "wrong dimension"),
        ("{life: 0 %}", "wants.life", "above 0"),
        ("{life: 200 %}", "wants.life", "up to 100 %"),
    ],
)
def test_a_want_that_cannot_be_is_refused(wants, path, message):
    with pytest.raises(SceneError, match=message) as caught:
        scene("level=auto", f"wants={wants}")
    assert [each.path for each in caught.value.errors] == [path]


def test_a_list_of_wants_needs_no_front_and_a_mapping_without_errors_is_a_list():
    keep(HERE, course())
    assert scene("level=auto", "wants=[slip, life]").level == "steady"
    plain = scene("level=auto", "wants={slip: , life: }")
    assert plain.level == "steady" and plain.wants == ("slip", "life") and plain.wanted_errors == ()


def test_a_scene_takes_a_measured_setting_as_its_own():
    taken = with_setting(scene("level=slip", "integration.fixed_step=5 us"), COARSE)
    assert (taken.level, taken.integration.relative_tolerance, taken.integration.fixed_step) == ("planar", 0.09, None)


def test_run_says_what_it_chose_and_why(tmp_path):
    keep(HERE, course(SLIP._replace(errors=PLANAR.errors)))
    ran = CliRunner().invoke(main, ["run", "deng2017_table1", "--level", "auto", "--set", AUTO[1], "--duration", "0.2 ms", "--json"])
    assert ran.exit_code == 0, ran.output
    assert "level slip chosen with tolerances x 1, the fastest setting whose measured errors keep the wants" in ran.stderr
