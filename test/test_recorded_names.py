# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A recording of a node has the names of the ROS graph, and is read as one without a node is."""

import numpy as np
import pytest
from rosbags.rosbag2 import Reader
from synthetic_run import synthetic_block

from bearing_sim.inputs.log import read_input_log
from bearing_sim.messages.events import Event, Level, ReceivedInputs, Report
from bearing_sim.messages.topics import OWN_NAMES, Names
from bearing_sim.recording.bag import Limits
from bearing_sim.recording.compare import compare
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recovery import recover
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Inputs

SCENE, START = load_scene("deng2017_table1"), 1_700_000_000_000_000_000
RUN = synthetic_block(SCENE, 0.01 * np.arange(1, 201))
IN_A_NAMESPACE = {name: f"/ship/front/{name}" for name in ("cage_slip", "roller_loads", "shaft_speed", "radial_load", "bearing_joints")}
# Topics have each other's names, which a ROS graph allows.
SWAPPED = {"cage_slip": "/damage", "damage": "/cage_slip", "shaft_speed": "/radial_load", "radial_load": "/shaft_speed", "diagnostics": "/told"}


def record(path, names, limits=None):
    with McapSink(path, SCENE, START, names=names, **({} if limits is None else {"limits": limits})) as sink:
        for start in range(0, 200, 10):
            sink.write(ReceivedInputs(float(RUN["time"][start]), Inputs(4000.0 + start, 800.0, -50.0, 393.15)))
            sink.write(RUN[start : start + 10])
        sink.write(Event(1.0, Level.WARN, "bearing.slip", "", "slip is high"))
        sink.write(Report(1.5, (), {"cage slip [fraction]": 0.1}))
    return path


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return record(tmp_path_factory.mktemp("plain") / "run.mcap", OWN_NAMES)


@pytest.mark.parametrize("full", [IN_A_NAMESPACE, SWAPPED], ids=["namespace", "swapped"])
def test_samples_inputs_and_events_are_found_under_names_that_were_remapped(tmp_path, plain, full):
    named = record(tmp_path / "run.mcap", Names(full, "ship/bearing_node/front", "A17"))
    own, others = Recording(plain), Recording(named)
    assert others.samples == own.samples == 200 and others.largest_load == own.largest_load
    for expected, found in zip(own, others, strict=True):
        assert expected.tobytes() == found.tobytes() if isinstance(expected, np.ndarray) else expected == found
    for channel, series in read_input_log(named).series.items():
        expected = read_input_log(plain).series[channel]
        assert series.values == expected.values and series.topic == full.get(channel, f"/{channel}")
    differences = compare(plain, named)[0]
    assert differences and all(each.matched and not (each.differing or each.only_first or each.only_second) for each in differences)


def test_strict_readers_see_the_names_of_the_graph_and_the_node_in_diagnostics(tmp_path):
    bag = record(tmp_path / "run", Names(IN_A_NAMESPACE, "ship/bearing_node/front", "A17"), Limits(part_duration=0.5))
    with Reader(bag) as reader:
        counts = {topic: info.msgcount for topic, info in reader.topics.items()}
        statuses = [data for connection, _, data in reader.messages() if connection.topic == "/diagnostics"]
    assert counts["/ship/front/cage_slip"] == 200 and counts["/ship/front/shaft_speed"] == 20 and counts["/damage"] == 200
    assert not {"/cage_slip", "/shaft_speed"} & counts.keys()
    assert all(b"ship/bearing_node/front: " in data and b"A17" in data for data in statuses) and len(statuses) == 2
    assert len(Recording(bag).files) > 2


def test_a_recovered_recording_keeps_the_names_and_what_they_stand_for(tmp_path):
    whole = record(tmp_path / "run.mcap", Names(IN_A_NAMESPACE, "ship/bearing_node", "")).read_bytes()
    (tmp_path / "cut.mcap.active").write_bytes(whole[: 3 * len(whole) // 4])
    found = recover(tmp_path / "cut.mcap.active", tmp_path / "good.mcap")
    assert found.messages["/ship/front/cage_slip"] > 50
    assert Recording(tmp_path / "good.mcap").samples > 50 and "shaft_speed" in read_input_log(tmp_path / "good.mcap").series


def test_a_topic_can_be_named_as_it_was_in_the_graph(tmp_path):
    named = record(tmp_path / "run.mcap", Names(IN_A_NAMESPACE, "", ""))
    series = read_input_log(named, {"shaft_speed": "/ship/front/shaft_speed"}).series
    assert len(series["shaft_speed"].stamps) == 20
