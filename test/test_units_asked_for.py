# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A bare number on the command line is refused with what it may mean; what a scene may say is printed by ``bearing-sim fields``."""

import dataclasses
import json

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.scene.fields import blocks
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.mounting import clearance_limits
from bearing_sim.scene.overrides import require_units
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import number_at

NEW = ["new", "NU 210/C3", "--oil", "ISO VG 68", "--speed", "3000rpm"]


def called(*arguments, code=0):
    result = CliRunner().invoke(main, list(map(str, arguments)))
    assert result.exit_code == code, result.output
    return result.output


@pytest.fixture(scope="module")
def motor(tmp_path_factory):
    path = tmp_path_factory.mktemp("scene") / "motor.yaml"
    called(*NEW, "--load", "5kN", "-o", path)
    return path


@pytest.mark.parametrize(
    ("override", "meant"),
    [
        ("operating.radial_load=5", "write 5 N or 5 kN"),
        ("lubricant.temperature=70", "write 70 degC"),
        ("lubricant.temperature=0", "write 0 degC"),
        ("operating.shaft_speed=3000", "write 3000 rpm"),
        ("bearing.clearance=60", "write 60 um"),
        ("bearing.inner_raceway.bore_diameter=45", "write 45 mm"),
        ("heat={law: given, inner_ring: 70, outer_ring: 60 degC}", "heat.inner_ring: 70 has no unit; write 70 degC"),
        ("uncertainty.lubricant.temperature=[60, 80 degC]", "uncertainty.lubricant.temperature: 60 has no unit; write 60 degC"),
        ("uncertainty.bearing.clearance={low: 40 um, high: 90}", "uncertainty.bearing.clearance.high: 90 has no unit; write 90 um"),
    ],
)
def test_an_override_without_a_unit_is_refused_with_the_units_that_fit(motor, override, meant):
    assert meant in called("run", motor, "--set", override, code=2)


@pytest.mark.parametrize(
    "override",
    ["lubricant.mixture_fraction=0.02", "operating.radial_load=0", "bearing.roller.count=17", "bearing.clearance=C3", "operating.radial_load=null",
     "level=steady", "uncertainty.lubricant.mixture_fraction=[0.01, 0.02]", "operating.radial_load=5kN"],
)  # fmt: skip
def test_pure_numbers_zeros_counts_and_names_need_no_unit(override):
    require_units([override])


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        ([*NEW, "--load", "5"], "--load: 5 has no unit; write 5 N or 5 kN"),
        ([*NEW, "--load", "5kN", "--temperature", "70"], "write 70 degC"),
        ([*NEW, "--load", "5kN", "--mass", "3", "--level", "planar"], "write 3 kg or 3 g"),
        (["catalog", "--width", "20:30"], "write 20 mm"),
        (["sweep", "deng2017_table1", "--vary", "operating.radial_load=100:200:3"], "write 100 N or 100 kN"),
        (["machine", "--pressure", "2"], "write 2 MPa"),
    ],
)
def test_an_option_without_a_unit_is_refused_with_the_units_that_fit(arguments, meant):
    assert meant in called(*arguments, code=2)


def test_a_bare_number_in_a_file_is_si_and_one_outside_of_its_range_is_told_the_unit_that_it_may_have(motor):
    text = motor.read_text()
    assert load_scene(motor, ["operating.radial_load=800"]).operating.radial_load == 800.0
    for field, bare, meant in (("temperature: 40 degC", "temperature: 70", "70 K is outside"), ("radial_load: 5kN", "radial_load: 5000", None)):
        assert field in text
        motor_with = motor.with_name("bare.yaml")
        motor_with.write_text(text.replace(field, bare))
        if meant is None:
            assert load_scene(motor_with).operating.radial_load == 5000.0
            continue
        with pytest.raises(SceneError, match=f"{meant} .*write 70 degC"):
            load_scene(motor_with)


@pytest.mark.parametrize("bearing", ["NU 210", "NU 232", "NJ 2208"])
def test_a_group_of_clearance_is_the_centre_of_a_range_and_may_be_its_ends(motor, bearing):
    given = "uncertainty.bearing.clearance={low: C3, high: C4, mode: C3, distribution: triangular}"
    scene = load_scene(motor, [f"bearing={bearing}", "bearing.clearance=C3", given])
    bore = 2.0 * scene.bearing.inner_raceway.bore_radius
    (one,) = [each for each in scene.uncertainty if each.field == "bearing.clearance"]
    group, looser = clearance_limits("C3", bore), clearance_limits("C4", bore)
    assert (one.low, one.high, one.mode) == (group.least, looser.largest, 0.5 * (group.least + group.largest))
    assert number_at(scene, "bearing.clearance") == pytest.approx(one.mode, rel=1e-9)


def test_an_override_within_a_block_of_defaults_keeps_its_law_and_names_the_law_that_has_a_field_which_it_lacks(motor):
    before, after = load_scene(motor), load_scene(motor, ["lubricant.mixed_friction.skew=0", "lubricant.starvation.constant=1e-8"])
    assert after.lubricant.mixed_friction == dataclasses.replace(before.lubricant.mixed_friction, skew=0.0)
    assert after.lubricant.starvation.law == before.lubricant.starvation.law
    with pytest.raises(SceneError, match="lubricant.mixed_friction.law to film_ratio"):
        load_scene("deng2017_table1", ["lubricant.mixed_friction.skew=0"])
    with pytest.raises(SceneError, match="laws with conductances: network"):
        load_scene("deng2017_table1", ["heat.conductances.housing_ambient=0.5"])
    both = load_scene(motor, ["heat=null", "heat.ambient_temperature=30 degC", "heat.law=network"])
    assert both.heat.ambient_temperature == pytest.approx(303.15), "an override of a field stays when the law follows"


def test_fields_prints_what_a_scene_may_say_and_a_misspelt_path_is_told_what_is_near():
    shown = json.loads(called("fields", "operating", "--json"))["fields"]
    assert [each["path"].rpartition(".")[2] for each in shown] == [
        field.name for field in dataclasses.fields(type(load_scene("deng2017_table1").operating))
    ]
    (load,) = json.loads(called("fields", "operating.radial_load", "--json"))["fields"]
    assert (load["kind"], load["default"]) == ("N", "0 N") and "radial load" in load["meaning"]
    assert {each.law for each in blocks(Scene) if each.path == "heat"} == {"none", "given", "network"}
    assert "lubricant" in called("fields") and "law: oil_bath" in called("fields", "lubricant.supply")
    assert "did you mean 'lubricant.supply'?" in called("fields", "lubrcant.suply", code=2)
    assert "twice radius" in called("fields", "bearing.inner_raceway.diameter", code=2)


def test_observables_are_listed_as_a_table_and_as_json():
    names = [each["name"] for each in json.loads(called("observables", "cage slip", "--json"))["observables"]]
    assert "cage_slip" in names and "cage_slip" in called("observables", "cage slip")


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["run", "deng2017_table1", "--duration", "2e6"], "--duration 2e6: 2e+06 s is outside 1e-12 s to 1e+06 s"),
        (["design", "deng2017_table1", "--slip-below", "110%", "--life-above", "300h"], "--slip-below 110%: 110 % is outside 0 % to 100 %"),
        (["study", "cold-start", "--rise", "60s"], "--rise 60s: 60 s is outside 0.001 s to 10 s"),
        (["machine", "--modulus", "3 GN"], "--modulus 3 GN: '3 GN' has the wrong dimension"),
        (["catalog", "--bore", "60mm:50mm"], "--bore 60mm:50mm: expected a length such as 50mm, or a range such as 50mm:80mm"),
        (["vibration", "a.npy", "--rollers", "13", "--band", "6kHz"], "--band 6kHz: expected LOW:HIGH"),
    ],
)
def test_an_option_out_of_its_bounds_is_refused_with_the_bounds_in_its_unit(arguments, meant):
    assert meant in called(*arguments, code=2)


@pytest.mark.parametrize("command", ["uncertainty", "trade"])
def test_a_removed_option_is_refused_with_its_successor(command):
    assert "--csv is no longer an option; give -o, --out instead" in called(command, "deng2017_table1", "--csv", "a.csv", code=2)


@pytest.mark.parametrize("words", [["--against-slip", "5"], ["--seed", "3", "--against-slip", "5"]])
def test_the_comparison_with_level_slip_that_left_table_names_what_to_run_instead(words):
    refused = called("table", "deng2017_table1", *words, code=2)
    assert f"{words[0]} is no longer an option" in refused
    assert "bearing-sim trade SCENE --level steady --against slip" in refused and "python test/validation against-slip SCENE" in refused
