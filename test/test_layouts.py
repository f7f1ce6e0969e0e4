# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the layouts for Foxglove, PlotJuggler and RViz: what they name is published, with that type and under that name."""

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
import yaml

from bearing_sim.messages import topics
from bearing_sim.messages.point_cloud import roller_fields

FOLDER = Path(__file__).resolve().parents[1] / "launch_scripts" / "layouts"
FOXGLOVE = json.loads((FOLDER / "foxglove.json").read_text())
PLOTJUGGLER = ElementTree.parse(FOLDER / "plotjuggler.xml").getroot()
RVIZ = yaml.safe_load((FOLDER / "bearing.rviz").read_text())
JOINTS = {
    "bearing_joints": list(topics.JOINTS),
    "bearing_state": list(topics.STATE_NAMES),
    "characteristic_frequencies": list(topics.FREQUENCY_NAMES),
}
"""Names in the joint states of each topic, as they are published."""
FILLED = {"bearing_joints": ("position", "velocity"), "bearing_state": ("position",), "characteristic_frequencies": ("position",)}


def panels(kind):
    """Return the configurations of Foxglove's panels of a kind."""
    return {name: config for name, config in FOXGLOVE["configById"].items() if name.partition("!")[0] == kind}


def lines():
    return [(name, path) for name, config in panels("Plot").items() for path in config["paths"]]


@pytest.mark.parametrize("panel, line", lines(), ids=lambda value: value["value"] if isinstance(value, dict) else value)
def test_every_line_of_foxglove_is_a_number_of_a_topic_and_is_labelled_by_its_name(panel, line):
    topic, path = line["value"].removeprefix("/").split(".", 1)
    assert topics.OUTPUTS[topic].ros_type == "sensor_msgs/msg/JointState" and line["timestampMethod"] == "headerStamp"
    array, index = re.fullmatch(r"(\w+)\[(\d+)\]", path).groups()
    assert array in FILLED[topic]
    words = {
        "cage_ideal": "cage without slip",
        "cage_slip": "slip",
        "slip_warning": "warning",
        "slip_error": "error",
        "rating_life": "basic",
        "modified_rating_life": "modified",
    } | {"ball_pass_outer": "BPFO", "ball_pass_inner": "BPFI", "roller_spin": "BSF"}
    name = JOINTS[topic][int(index)].partition(" [")[0]
    symbol = {"cage": "FTF"} if topic == "characteristic_frequencies" else {}
    assert line["label"] == (words | symbol).get(name, name)


def test_foxglove_shows_speeds_slip_with_its_limits_life_rollers_and_diagnostics():
    shown = {line["value"] for _, line in lines()}
    state = {name: f"/bearing_state.position[{k}]" for k, name in enumerate(topics.STATE_NAMES)}
    assert {state[name] for name in ("cage_slip", "slip_warning", "slip_error", "rating_life [h]", "damage")} <= shown
    assert {f"/bearing_joints.velocity[{k}]" for k in range(3)} <= shown
    for kind in ("DiagnosticSummary", "DiagnosticStatusPanel"):
        assert [config["topicToRender"] for config in panels(kind).values()] == [f"/{topics.DIAGNOSTICS[0]}"]
    (scene,) = panels("3D").values()
    assert scene["followTf"] == topics.FRAME
    for topic, settings in scene["topics"].items():
        assert topics.OUTPUTS[topic[1:]].ros_type == "sensor_msgs/msg/PointCloud2"
        assert settings["colorField"] in [field.name for field in roller_fields(tilting=False)]


def test_foxglove_lays_out_every_panel_once():
    def leaves(node):
        return [node] if isinstance(node, str) else [*leaves(node["first"]), *leaves(node["second"])]

    assert sorted(leaves(FOXGLOVE["layout"])) == sorted(FOXGLOVE["configById"])


def test_every_curve_of_plotjuggler_is_a_series_that_it_makes_of_our_topics():
    """Of a joint state /TOPIC/NAME/ARRAY; of other messages /TOPIC/FIELD."""
    curves = [curve.get("name") for curve in PLOTJUGGLER.iter("curve")]
    made = {f"/{topic}/{name}/{array}" for topic, names in JOINTS.items() for name in names for array in FILLED[topic]}
    made |= {f"/{name}/data" for name, topic in topics.OUTPUTS.items() if topic.ros_type == "std_msgs/msg/Float64"}
    assert curves and set(curves) <= made
    assert {f"/bearing_state/{name}/position" for name in ("cage_slip", "slip_warning", "slip_error", "rating_life [h]", "damage")} <= set(curves)
    assert {f"/bearing_joints/{name}/velocity" for name in topics.JOINTS} <= set(curves)


def test_plotjuggler_finds_as_many_plots_in_each_row_as_it_is_told():
    assert PLOTJUGGLER.tag == "root" and [widget.get("name") for widget in PLOTJUGGLER.findall("tabbed_widget")] == ["Main Window"]
    for splitter in PLOTJUGGLER.iter("DockSplitter"):
        count = int(splitter.get("count"))
        assert len(splitter.findall("DockArea")) == count == len(splitter.get("sizes").split(";"))
        assert sum(map(float, splitter.get("sizes").split(";"))) == pytest.approx(1.0, abs=1e-5)
    assert all(area.find("plot").get("mode") == "TimeSeries" and area.get("name") for area in PLOTJUGGLER.iter("DockArea"))


def test_rviz_shows_the_rollers_in_the_frame_of_the_bearing():
    manager = RVIZ["Visualization Manager"]
    assert manager["Global Options"]["Fixed Frame"] == topics.FRAME
    displays = {display["Class"].rpartition("/")[2]: display for display in manager["Displays"]}
    cloud = displays["PointCloud2"]
    assert topics.OUTPUTS[cloud["Topic"]["Value"][1:]].ros_type == "sensor_msgs/msg/PointCloud2"
    assert cloud["Channel Name"] in [field.name for field in roller_fields(tilting=False)] and cloud["Color Transformer"] == "Intensity"
    assert (cloud["Topic"]["Reliability Policy"], cloud["Topic"]["Durability Policy"]) == ("Reliable", "Volatile"), "as the node offers"
