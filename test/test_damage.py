# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Damage of one course at three levels: each against runs of its own."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from recordings import steady_log

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.cli.main import main
from bearing_sim.studies.damage import damages

START = Inputs(1500.0, 1500.0, 0.0, 393.15)


def course(seconds=3.0, rate=10.0):
    times = np.arange(round(seconds * rate) + 1) / rate
    inputs = np.tile(START, (len(times), 1))
    inputs[:, 0] += 100.0 * times
    return times, inputs


def test_whole_course_at_slip_is_a_run_of_its_own_and_steady_is_near_it():
    times, inputs = course()
    found = damages("deng2017_table1", [], times, inputs, np.zeros(len(times), bool), windows=1, length=0.2)
    run = Simulation(load_scene("deng2017_table1"), START)
    for before, after, at in zip(times, times[1:], inputs[1:]):
        run.advance(after - before, Inputs(*at))
    assert found.slip == pytest.approx(float(run.sample["damage"]), rel=1e-9)
    assert found.steady == pytest.approx(found.slip, rel=0.02)
    assert found.seconds == pytest.approx(3.0)


def test_windows_are_shares_of_the_course_and_planar_is_near_a_run_of_its_own_from_ideal_rolling():
    times, inputs = course()
    found = damages("deng2017_table1", [], times, inputs, np.zeros(len(times), bool), windows=3, length=0.3)
    assert [window.start for window in found.windows] == pytest.approx([0.5, 1.5, 2.5])
    for window in found.windows:
        assert window.shaft_speed == pytest.approx(1500.0 + 100.0 * (window.start + 0.15), abs=5.0)
        assert window.slip == pytest.approx(found.slip * 0.3 / 3.0, rel=0.15)  # the speed rises by a fifth
        assert window.steady == pytest.approx(window.slip, rel=0.02)
        run = Simulation(load_scene("deng2017_table1", ["level=planar"]), START._replace(shaft_speed=window.shaft_speed))
        run.advance(0.5)
        before = float(run.sample["damage"])
        assert window.planar == pytest.approx(float(run.advance(0.3)["damage"][-1]) - before, rel=0.1)


def test_time_in_gaps_does_no_damage():
    times, inputs = course()
    in_gap = (times > 1.0) & (times <= 2.0)
    whole = damages("deng2017_table1", [], times, inputs, np.zeros(len(times), bool), windows=1, length=0.1)
    gapped = damages("deng2017_table1", [], times, inputs, in_gap, windows=1, length=0.1)
    assert gapped.seconds == pytest.approx(2.0)
    for level in ("steady", "slip"):
        assert getattr(gapped, level) == pytest.approx(getattr(whole, level) * 2 / 3, rel=0.03)


def test_command_reads_a_log(tmp_path):
    log = steady_log(tmp_path / "log.mcap", duration=1.0)
    words = ["study", "damage", str(log), "--scene", "deng2017_table1", "--windows", "1", "--length", "0.2", "--json"]
    result = CliRunner().invoke(main, [*words, "--set", "table.tolerance=20 %", "--set", "table.maximum_load=1 kN"])
    assert result.exit_code == 0, result.output
    report = json.loads(result.stdout)
    assert report["steady"] == pytest.approx(report["slip"], rel=0.25)
    assert len(report["windows"]) == 1
