# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Idling with cold oil: a skid grows as oil cools and falls as load grows, whatever the bearing; run-ups decide where two states are."""

import json

import pytest
from click.testing import CliRunner
from validation.cold_oil_trends import trends

from bearing_sim.cli.main import main
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.cold_oil import SKID, Point, SkidLoad, SkidMap, run_up, skid_map

BEARINGS = {"NU 232": ("ISO VG 320", 1500), "NU 210": ("ISO VG 68", 3000), "NU 2308": ("ISO VG 100", 3000)}


def of(name):
    oil, rpm = BEARINGS[name]
    lubricant = {"oil": oil, "supply": "oil_bath", "temperature": "40 degC"}
    return load_scene({"name": name, "bearing": name, "lubricant": lubricant, "operating": {"shaft_speed": f"{rpm} rpm", "radial_load": "1 kN"}})


@pytest.mark.parametrize("name", BEARINGS)
@pytest.mark.parametrize("supply", ["oil_bath", "circulating"])
def test_where_oil_stands_skid_and_skid_load_never_fall_as_it_cools_nor_slip_as_the_load_falls(name, supply):
    found = skid_map(of(name), (supply,), (0.0, 20.0, 60.0))
    assert [(one.claim, one.holds) for one in trends(found) if one.holds is False] == []
    assert any(one.holds for one in trends(found)) and max(point.skid for point in found.points) > SKID


def test_below_a_jet_the_skid_load_grows_as_the_oil_cools_though_the_skid_itself_does_not():
    found = skid_map(of("NU 232"), ("oil_jet",), (0.0, 20.0, 40.0))
    held = {one.claim.partition(": ")[2]: one.holds for one in trends(found)}
    assert held["the skid load never falls as the oil cools"] and not held["a skid never falls as the oil cools"]


def test_without_flooding_below_the_minimum_load_the_coldest_start_is_called_safe():
    # the constant was measured on loaded bearings; below the minimum load it would take the skid away that practice has
    plain, starved = (load_scene(of("NU 232"), each) for each in ([], ["lubricant.starvation.under_minimum_load=starved"]))
    flooded, trusting = (skid_map(each, ("oil_bath",), (20.0,), [2000.0]).points[0] for each in (plain, starved))
    assert flooded.rolling > 0.5 and trusting.rolling < 0.3 * flooded.rolling


def test_a_fast_run_up_leaves_a_cage_in_a_skid_that_a_slow_one_avoids():
    # NU 232 at 10 degC and 3 kN has both states
    scene = of("NU 232")
    (point,) = skid_map(scene, ("oil_bath",), (10.0,), [3000.0]).points
    assert point.skid - point.rolling > SKID
    fast, slow = (run_up(scene, "oil_bath", 3000.0, 10.0, seconds).slip for seconds in (0.3, 3.0))
    assert fast == pytest.approx(point.skid, rel=0.02) and slow == pytest.approx(point.rolling, abs=1e-4)


def test_a_trend_that_a_map_does_not_have_is_said_and_one_without_a_case_too():
    def told(*slips):
        points = tuple(Point("oil_bath", load, celsius, slip, slip) for (load, celsius), slip in zip(((1e2, 0.0), (1e2, 40.0), (1e3, 0.0)), slips))
        return [one.holds for one in trends(SkidMap(500.0, points, (SkidLoad("oil_bath", 0.0, 10.0), SkidLoad("oil_bath", 40.0, 20.0))))]

    assert told(0.6, 0.5, 0.3) == [False, True, True]
    assert told(0.4, 0.5, 0.45) == [False, False, False]
    assert told(0.04, 0.05, 0.01) == [False, None, True]


def test_the_command_maps_any_scene_and_refuses_what_it_cannot(tmp_path):
    def call(*arguments):
        return CliRunner().invoke(main, ["study", "cold-oil", "nu215_rig", *arguments])

    found = call("--supply", "grease", "--temperature", "10 degC", "--load", "0.2 kN", "--json", "--picture", str(tmp_path / "map.png"))
    assert found.exit_code == 0, found.output
    (point,) = json.loads(found.stdout)["points"]
    assert point["load"] == 200.0 and 0.0 < point["rolling"] <= point["skid"] < 1.0 and (tmp_path / "map.png").stat().st_size > 10_000
    for wrong, said in ((("--load", "-5 N"), "radial_load"), (("--supply", "milk"), "milk"), (("--set", "operating.shaft_speed=0"), "shaft_speed")):
        refused = call(*wrong)
        assert refused.exit_code == 2 and said in refused.output
