# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bearings beside each other in one process: what is counted, and the bench that counts."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from bearing_sim.runtime import fleet
from bearing_sim.runtime.fleet import FleetRun, most_bearings, run_fleet
from bearing_sim.scene_file import load_scene

ROOT = Path(__file__).resolve().parents[1]


def test_a_fleet_of_two_is_really_run_and_no_faster_than_real_time():
    run = run_fleet(load_scene("deng2017_table1", ["operating.shaft_speed=1500 rpm"]), 2, 0.5)
    assert run.bearings == 2 and run.core_seconds > 0.0
    assert 0.0 < run.real_time_factor < 1.2 and (run.lost > 0.0 or run.real_time_factor > 0.5)


@pytest.mark.parametrize(("capacity", "found"), [(7, 7), (6, 5), (10, 9), (100, 9), (1, 1)])
def test_fewer_and_fewer_are_tried_until_all_hold(monkeypatch, capacity, found):
    monkeypatch.setattr(fleet, "run_fleet", lambda scene, count, seconds: FleetRun(count, 0.1, 0.0 if count <= capacity else 1.0, 1.0))
    runs = most_bearings(None, 1.0)
    assert runs[-1].bearings == found and runs[-1].holds
    assert 1 in [run.bearings for run in runs]


def test_the_bench_tells_the_count_for_each_level_as_json():
    words = [sys.executable, "-m", "bearing_sim.cli", "bench", "fleet", "--quick", "--json", "--level", "slip"]
    report = json.loads(subprocess.run(words, capture_output=True, text=True, timeout=300, cwd=ROOT, check=True).stdout)
    (case,) = report["cases"]
    assert (case["level"], case["speed_rpm"]) == ("slip", 1500.0)
    assert case["expected_from_one"] == pytest.approx(1.0 / case["core_share_of_one"]) and case["bearings"] >= 0
    assert case["runs"][0]["bearings"] == 1 or any(run["bearings"] == 1 for run in case["runs"])
