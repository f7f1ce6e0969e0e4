# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bearings beside each other in one process: what is counted, and the bench that counts."""

import json

import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.runtime import fleet
from bearing_sim.runtime.fleet import FleetRun, most_bearings, run_fleet
from bearing_sim.scene.loader import load_scene


def test_a_fleet_of_two_is_really_run_and_no_faster_than_real_time():
    run = run_fleet(load_scene("deng2017_table1", ["operating.shaft_speed=1500 rpm"]), 2, 0.5)
    assert run.bearings == 2 and run.core_seconds > 0.0
    assert 0.0 < run.real_time_factor < 1.2 and (run.lost > 0.0 or run.real_time_factor > 0.5)
    assert 0.0 < run.input_rate < 103.0


def test_a_fleet_holds_where_all_keep_real_time_and_are_driven_as_often_as_meant():
    held = FleetRun(3, 0.1, 0.0, 1.0, 100.0)
    assert held.holds and held._replace(input_rate=99.7).holds
    assert not any(held._replace(**lapse).holds for lapse in ({"lost": 0.3}, {"real_time_factor": 0.99}, {"input_rate": 95.0}))


@pytest.mark.parametrize(("capacity", "found"), [(7, 7), (6, 6), (10, 9), (100, 9), (1, 1), (0, 1)])
def test_fewer_are_tried_where_not_all_hold(monkeypatch, capacity, found):
    tried = []

    def run(scene, count, seconds):
        tried.append(count)
        return FleetRun(count, 0.1, 0.0 if count <= capacity else 1.0, 1.0, 100.0)

    monkeypatch.setattr(fleet, "run_fleet", run)
    runs = most_bearings(None, 1.0)
    assert tried[0] == 1, "what one takes says how many are tried next"
    assert runs[-1].bearings == found and runs[-1].holds == (capacity > 0)
    assert 1 in [run.bearings for run in runs] and len({run.bearings for run in runs}) == len(runs)


@pytest.mark.parametrize("capacity", [11, 40, 85, 1000])
def test_more_are_tried_as_each_takes_less_beside_others(monkeypatch, capacity):
    def share(count):
        return 0.01 + 0.09 / count

    monkeypatch.setattr(
        fleet, "run_fleet", lambda scene, count, seconds: FleetRun(count, share(count), 0.0, 1.0 if count <= capacity else 0.98, 100.0)
    )
    runs = most_bearings(None, 1.0)
    assert runs[-1].holds and min(0.9 * capacity, 80) < runs[-1].bearings <= capacity
    assert runs[-1].bearings * share(runs[-1].bearings) <= 0.96


def test_the_bench_tells_the_count_for_each_level_as_json(monkeypatch):
    monkeypatch.setattr(fleet, "run_fleet", lambda scene, count, seconds: FleetRun(count, 0.1, 0.0 if count <= 7 else 1.0, 1.0, 100.0))
    result = CliRunner().invoke(main, ["bench", "fleet", "--quick", "--json", "--level", "slip", "--level", "planar"], catch_exceptions=False)
    cases = json.loads(result.stdout)["cases"]
    assert [(case["level"], case["speed_rpm"], case["bearings"]) for case in cases] == [("slip", 1500.0, 7), ("planar", 1500.0, 7)]
    for case in cases:
        assert case["expected_from_one"] == pytest.approx(1.0 / case["core_share_of_one"]) == 10.0
        assert case["runs"][0]["bearings"] == 1 and case["runs"][-1]["bearings"] == 7 and case["runs"][-1]["holds"]
