# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim catalog`` and ``new``: bearings by designation, and scenes that load, run and name every choice that was made."""

import json

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.scene.loader import load_bearing, load_scene
from bearing_sim.scene.uncertainty import ranges_of
from bearing_sim.studies import bearing_facts
from bearing_sim.sweep.pictures import new_figure


def called(*arguments, code=0):
    result = CliRunner().invoke(main, list(map(str, arguments)))
    assert result.exit_code == code, result.output
    return result


def test_the_list_holds_exactly_the_bearings_within_the_bounds():
    found = json.loads(called("catalog", "--type", "nu", "--bore", "50mm", "--dynamic-rating-above", "100kN", "--json").stdout)["bearings"]
    assert [each["designation"] for each in found] == ["NU 310", "NU 2310", "NU 410"]
    assert all(each["bore"] == pytest.approx(0.05) and each["dynamic_rating"] >= 100e3 for each in found)
    ranged = json.loads(called("catalog", "--series", "2", "--type", "NU", "--bore", "50mm:60mm", "--json").stdout)["bearings"]
    assert [each["designation"] for each in ranged] == ["NU 210", "NU 211", "NU 212"]


def test_bundled_scenes_are_listed_as_a_table_or_as_json():
    found = json.loads(called("scenes", "--json").stdout)
    table = called("scenes").stdout
    assert "deng2017_table1" in found["scenes"] and "deng2017_table1" in table and not table.lstrip().startswith("{")


def test_every_bearing_of_the_list_has_ratings_and_says_whose():
    found = json.loads(called("catalog", "--type", "NU", "--json").stdout)["bearings"]
    assert len(found) > 150 and all(each["dynamic_rating"] > 0.0 and each["static_rating"] > 0.0 and each["ratings_by"] for each in found)


def test_one_bearing_is_shown_with_what_is_estimated_and_drawn(tmp_path):
    picture = tmp_path / "nu210.svg"
    shown = called("catalog", "nu 210 ecp/c3", "--picture", picture).stdout
    for text in ("NU 210 ECP/C3", "d 50 mm, D 90 mm, B 20 mm", "C3: 50 to 80 µm", "C 73.5 kN", "16 of 11 mm", "estimated cage.mass"):
        assert text in shown
    assert picture.read_text().count("</svg>") == 1
    facts = json.loads(called("catalog", "NU 210", "--json").stdout)
    assert (
        facts["rollers"] == 16 and facts["clearance_um"] == pytest.approx([30, 60]) and "cage.mass" in [each["field"] for each in facts["estimated"]]
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("catalog", "NU 211 ECX"), "unknown suffix 'ECX' (did you mean EC?)"),
        (("catalog", "6205"), "a deep groove ball bearing, not a cylindrical roller bearing"),
        (("catalog", "--bore", "50"), "--bore: 50 has no unit; write 50 mm"),
        (("catalog", "--bore", "60mm:50mm"), "expected a length such as 50mm, or a range"),
        (("catalog", "--type", "NX"), "--type NX: expected one of N, NU"),
        (("catalog", "--picture", "a.png"), "--picture draws one bearing; give its designation"),
        (("catalog", "NU 210", "--bore", "50mm"), "do not go with a designation"),
        (("new", "NU 210", "--speed", "3000rpm", "--load", "5kN"), "give --oil or --grease"),
        (("new", "NU 210", "--oil", "ISO VG 67", "--speed", "3000", "--load", "5kN"), "ISO 3448 has no class 67"),
        (("new", "NU 210", "--oil", "ISO VG 68", "--speed", "3000", "--load", "5kN"), "'3000' has no unit; write 3000 rpm"),
    ],
)
def test_what_cannot_be_is_refused_in_words(arguments, words):
    assert words in called(*arguments, code=2).output


def test_all_faults_of_a_new_scene_come_at_once():
    output = called("new", "NU 210 ECX", "--oil", "ISO VG 67", "--speed", "3000", "--load", "5 apples", code=2).output
    for words in ("'ECX'", "no class 67", "'3000' has no unit", "'apples'"):
        assert words in output


@pytest.mark.parametrize(
    ("lubricant", "supply", "cleanliness"),
    [(("--oil", "ISO VG 68"), "oil_bath", "bath_17_14"), (("--grease", "lithium NLGI 2"), "grease", "grease_normal_cleanliness")],
)
def test_a_new_scene_loads_and_names_every_choice_that_was_made(tmp_path, lubricant, supply, cleanliness):
    out = tmp_path / "motor.yaml"
    told = called("new", "NU 210/C3", *lubricant, "--speed", "3000rpm", "--load", "5kN", "-o", out).stdout
    scene, text = load_scene(out), out.read_text()
    assert (scene.name, scene.bearing.designation, scene.bearing.clearance) == ("motor", "NU 210/C3", "C3")
    assert (scene.lubricant.supply.law, scene.life.a_iso, scene.heat.law, scene.mounting.shaft.fit) == (supply, cleanliness, "network", "j6")
    assert all(f"#   {each.field}: " in text for each in scene.bearing.estimated) and text.count("Assumption") >= 4
    assert f"bearing-sim run {out}" in told and "estimated" in told
    refused = called("new", "NU 210", *lubricant, "--speed", "1rpm", "--load", "1N", "-o", out, code=2)
    assert "exists; use --force to replace it" in refused.output
    assert out.read_text() == text


def test_fast_bearings_get_a_jet_and_heavy_loads_a_tighter_fit():
    made = called("new", "NU 210", "--oil", "ISO VG 10", "--speed", "9000rpm", "--load", "15kN").stdout
    assert "supply: oil_jet" in made and "fit: k6" in made
    given = called("new", "NU 210", "--oil", "ISO VG 10", "--speed", "9000rpm", "--load", "15kN", "--temperature", "70degC").stdout
    assert "temperature: 70degC" in given and "heat:" not in given


@pytest.mark.parametrize("supply", ["circulating", "oil_jet", "oil_air", "oil_bath"])
def test_a_supply_by_name_keeps_the_temperatures_computed(tmp_path, supply):
    out = tmp_path / "supplied.yaml"
    called("new", "N 1014", "--oil", "ISO VG 68", "--supply", supply, "--speed", "3000rpm", "--load", "2kN", "-o", out)
    assert load_scene(out).lubricant.supply.law == supply and load_scene(out).heat.law == "network"


@pytest.mark.parametrize("shaft", ["motor", "gear", "cold"])
def test_what_heats_or_cools_the_shaft_is_written_with_its_ranges(tmp_path, shaft):
    out = tmp_path / "shaft.yaml"
    called("new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm", "--load", "5kN", "--shaft", shaft, "-o", out)
    scene = load_scene(out)
    ranges = {each.field: each for each in ranges_of(scene)}
    for field, value in (("heat.shaft.back_temperature", scene.heat.shaft.back_temperature), ("heat.shaft.back", scene.heat.shaft.back)):
        assert ranges[field].low < value < ranges[field].high
    assert "assumption" in out.read_text()
    refused = called("new", "NU 210", "--oil", "ISO VG 68", "--speed", "1rpm", "--load", "1N", "--shaft", shaft, "--temperature", "70degC", code=2)
    assert "--shaft is for temperatures that are computed" in refused.output


@pytest.mark.parametrize("designation", ["NU 210", "NU 1010", "N 2310 ECP"])
def test_all_of_a_drawing_lies_within_its_frame(designation):
    axes = new_figure(6, 6).subplots()
    bearing_facts._draw_section(axes, load_bearing(designation))
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    places = [text.get_position() for text in axes.texts]
    places += [corner for patch in axes.patches for corner in patch.get_corners()]
    places += [point for line in axes.lines for point in line.get_xydata()]
    assert len(places) > 30
    assert all(left < x < right and bottom < y < top for x, y in places)
