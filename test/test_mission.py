# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the synthetic mission: smooth, through its phases in order, within the bundled scene's limits, said to be synthetic."""

import json
import math

import numpy as np
import pytest
from click.testing import CliRunner
from mcap.reader import make_reader

from bearing_sim.cli.main import main
from bearing_sim.inputs.log import read_input_log
from bearing_sim.inputs.mission import DURATION, METADATA, PHASES, mission, write_mission
from bearing_sim.inputs.profile import judge
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

RPM = math.pi / 30


def course(duration=DURATION, points=20_001):
    times = np.linspace(0.0, duration, points)
    return times, np.array([mission(time, duration)[:4] for time in times])


def test_shaft_starts_and_ends_at_rest_and_peaks_at_45000_rpm():
    _, inputs = course()
    assert inputs[0, 0] == inputs[-1, 0] == 0.0
    assert inputs[:, 0].max() == pytest.approx(45_000 * RPM, rel=1e-12)
    assert (inputs[:, 0] >= 0.0).all()


def test_value_and_slope_are_continuous():
    """No second difference exceeds what the steepest smooth step and the gust can have: a jump in value or slope would stand out."""
    times, inputs = course()
    step = times[1]
    scale = np.abs(inputs).max(axis=0)
    curvature = np.abs(np.diff(inputs, 2, axis=0)).max(axis=0) / step**2 / scale
    finer_times, finer = course(points=200_001)
    finer_curvature = np.abs(np.diff(finer, 2, axis=0)).max(axis=0) / finer_times[1] ** 2 / scale
    assert finer_curvature == pytest.approx(curvature, rel=0.05)  # would grow tenfold at a kink, a hundredfold at a jump


def phase(time):
    """Return the name of the phase at a time of the mission."""
    return next((name for name, end, *_ in PHASES if time / DURATION <= end), PHASES[-1][0])


def test_all_phases_scale_with_the_duration():
    for share in np.linspace(0, 1, 41):
        assert mission(share * 30.0, 30.0)[:4] == pytest.approx(mission(share * DURATION)[:4])


def test_gust_strikes_during_the_descent_and_turns_the_load():
    times, inputs = course()
    descent = np.array([phase(time) == "descent" for time in times])
    loads = np.hypot(inputs[:, 1], inputs[:, 2])
    assert loads[descent].min() == pytest.approx(100.0) and loads[descent].max() > 800.0
    assert inputs[descent, 2].min() == pytest.approx(-400.0, rel=1e-3)


def test_outside_the_mission_its_ends_hold():
    assert mission(-5.0) == mission(0.0) and mission(1e9) == mission(DURATION)


def test_phases_come_in_order_and_fill_the_mission():
    ends = [end for _, end, *_ in PHASES]
    assert ends == sorted(ends) and ends[-1] == 1.0
    assert [phase(0.0), phase(0.37 * DURATION), phase(2 * DURATION)] == ["rest", "take-off", "standstill"]


def test_written_mission_passes_the_gate_whole_and_comes_back_equal(tmp_path):
    written = write_mission(tmp_path / "mission.mcap", 10**18, duration=6.0)
    scene = load_scene("deng2017_table1")
    log = read_input_log(tmp_path / "mission.mcap")
    judged = judge(log, scene.accepted_inputs, Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature))
    assert judged.tally.is_whole and not judged.events
    assert judged.tally.there == written == 2 * 301 + 7
    instants = judged.instants
    assert len(instants) == 301
    expected = np.array([mission(instant * 1e-9, 6.0) for instant in instants])
    assert judged.at(instants, 0.0)[:, :3] == pytest.approx(expected[:, :3], abs=1e-9)


def test_recording_says_that_it_is_synthetic(tmp_path):
    write_mission(tmp_path / "mission.mcap", 10**18, duration=2.0)
    with open(tmp_path / "mission.mcap", "rb") as stream:
        record = next(record.metadata for record in make_reader(stream).iter_metadata() if record.name == METADATA)
    assert record["synthetic"] == "true" and float(record["duration"]) == 2.0


def test_command_writes_the_mission(tmp_path):
    arguments = ["mission", "-o", str(tmp_path / "m.mcap"), "--duration", "2", "--rate", "10", "--start", "2020-01-01", "--json"]
    ran = CliRunner().invoke(main, arguments)
    assert ran.exit_code == 0, ran.output
    report = json.loads(ran.stdout)
    assert report["synthetic"] is True and report["messages"] == 2 * 21 + 3 and report["start_ns"] == 1_577_836_800_000_000_000
    assert CliRunner().invoke(main, ["mission", "-o", str(tmp_path / "m.mcap"), "--rate", "0"]).exit_code == 2
