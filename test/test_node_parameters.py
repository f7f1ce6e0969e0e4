# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's parameters: descriptors from the scene's declarations, refusals with reasons, changes in mid-run, files; several bearings."""

import dataclasses
import re
import signal
from array import array
from pathlib import Path

import numpy as np
import pytest
import yaml

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from lifecycle_msgs.msg import Transition  # noqa: E402
from lifecycle_msgs.srv import ChangeState  # noqa: E402
from rcl_interfaces.msg import Parameter as ParameterMessage  # noqa: E402
from rcl_interfaces.srv import DescribeParameters, GetParameters, ListParameters, SetParameters  # noqa: E402
from rclpy.parameter import Parameter, parameter_value_to_python  # noqa: E402
from rclpy.qos import ReliabilityPolicy  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import SetBool, Trigger  # noqa: E402

from bearing_sim.inputs.log import read_input_log  # noqa: E402
from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.recording.bag_reader import BagReader, BagTopic  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros.messages import message  # noqa: E402
from bearing_sim.ros.parameters import (  # noqa: E402
    DECLARATIONS,
    SCENE_DECLARATIONS,
    BearingSettings,
    parameter_file,  # noqa: E402
    parameter_value,
    scene_value,
)
from bearing_sim.scene.loader import load_scene, scene_names  # noqa: E402
from bearing_sim.scene.scene import Thresholds  # noqa: E402
from bearing_sim.scene.uncertainty import messages, with_values  # noqa: E402

pytestmark = pytest.mark.timeout(240)
EXAMPLE = Path(__file__).resolve().parents[1] / "launch_scripts" / "bearing_node.yaml"


class Parameters:
    """Reads and sets the parameters of a node."""

    def __init__(self, client, process):
        self.client, self.process = client, process

    def set(self, name, value):
        """Set one; return the reason of the refusal, empty where it was taken."""
        request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
        (result,) = self.client.call(SetParameters, "set_parameters", request, self.process).results
        assert result.successful or result.reason
        return result.reason

    def value(self, name):
        """Return the value of one."""
        (value,) = self.client.call(GetParameters, "get_parameters", GetParameters.Request(names=[name]), self.process).values
        return parameter_value_to_python(value)

    def names(self):
        """Return all names."""
        return set(self.client.call(ListParameters, "list_parameters", ListParameters.Request(), self.process).result.names)

    def dump(self, node="/bearing_node"):
        """Return all parameters as the text of a file, as `ros2 param dump` (package ros2param, jazzy) does."""
        tree = {}
        names = sorted(self.names())
        values = self.client.call(GetParameters, "get_parameters", GetParameters.Request(names=names), self.process).values
        for name, value in zip(names, map(parameter_value_to_python, values), strict=True):
            *blocks, last = name.split(".")
            block = tree
            for each in blocks:
                block = block.setdefault(each, {})
            block[last] = value.tolist() if isinstance(value, array) else value
        return yaml.dump({node: {"ros__parameters": tree}}, default_flow_style=False)

    def change(self, label):
        """Ask for a transition; return whether it was made."""
        return self.client.call(ChangeState, "change_state", ChangeState.Request(transition=Transition(label=label)), self.process).success


def start(folder, *parameters, namespace="", arguments=()):
    domain = fresh_domain()
    pairs = [word for parameter in parameters for word in ("-p", parameter)]
    process = NodeProcess(folder, domain, "--ros-args", *pairs, *arguments, limit=220)
    return process, Client(domain, namespace)


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """A node that runs, and its parameters."""
    process, client = start(tmp_path_factory.mktemp("parameters"), "governor:=false", "publish_rate:=20")
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"], "the node runs", process)
    yield Parameters(client, process)
    assert process.end(signal.SIGTERM) == 0 and "Traceback" not in process.text
    client.close()


def test_every_quantity_of_the_thresholds_is_a_parameter_with_its_bounds_unit_and_meaning():
    rows = {row.name: row for row in SCENE_DECLARATIONS}
    slip = rows["thresholds.slip_warning"]
    assert (slip.low, slip.high, slip.default) == (0.0, 1.0, 0.05) and slip.meaning.startswith("cage slip that is a warning")
    assert "[s]" in rows["thresholds.slip_hold.raise_after"].meaning and "degC" in rows["lubricant.temperature"].meaning
    assert "0: " in rows["thresholds.pocket_force_error"].meaning
    scene = load_scene("deng2017_table1")

    def leaves(record, path):
        for name in record.__dataclass_fields__:
            value = getattr(record, name)
            yield from leaves(value, f"{path}.{name}") if hasattr(value, "__dataclass_fields__") else [f"{path}.{name}"]

    assert set(leaves(scene.thresholds, "thresholds")) | {"lubricant.temperature"} == set(rows)
    for name in rows:
        assert rows[name].low <= parameter_value(name, scene) <= rows[name].high


def test_zero_stands_for_none_where_the_scene_allows_none_and_for_zero_elsewhere():
    assert scene_value("thresholds.pocket_force_warning", 0.0) is None and scene_value("thresholds.pocket_force_warning", 3.0) == 3.0
    assert scene_value("thresholds.life_error", 0.0) == 0.0


@pytest.mark.parametrize("name", scene_names())
def test_the_scene_parameters_of_a_scene_that_were_read_from_it_change_nothing_in_it(name):
    scene = load_scene(name)
    others = {field.name: None for field in dataclasses.fields(BearingSettings)} | {"overrides": ()}
    settings = BearingSettings(**others | {"conditions": {row.name: parameter_value(row.name, scene) for row in SCENE_DECLARATIONS}})
    assert load_scene(name, settings.scene_overrides) == scene


def test_thresholds_are_changed_by_their_place_and_faults_are_told():
    changed = with_values(Thresholds(), {"slip_warning": 0.02, "slip_hold.raise_after": 3.0, "pocket_force_error": None})
    assert (changed.slip_warning, changed.slip_hold.raise_after, changed.slip_error) == (0.02, 3.0, 0.10)
    for path, number, reason in (
        ("slip_warning", 2.0, "slip_warning: 200 % is outside"),
        ("residual.learning", 2.0, "expected 30 or more"),
        ("slip_error", 0.04, "slip_warning: 5 % is above slip_error, 4 %"),
        ("life_error", 400.0, "life_warning: 300 h is below life_error, 400 h"),
        ("lambda_error", 2.0, "lambda_warning: 1 is below lambda_error, 2"),
        ("slip_waning", 0.1, "slip_waning: "),
    ):
        with pytest.raises(ValueError) as raised:
            with_values(Thresholds(), {path: number})
        assert reason in messages(raised.value)


def test_the_bounds_of_the_nodes_own_parameters_are_these():
    assert {row.name: (row.low, row.high) for row in DECLARATIONS if np.isfinite([row.low, row.high]).any()} == {
        "processes": (0, 256),
        "publish_rate": (0.1, 200.0),
        "sample_rate": (1.0, 10_000.0),
        "clock_tolerance": (0.0, 10.0),
        "stamp_tolerance": (0.0, 1e9),
        "inputs_expected_within": (0.0, 1e6),
        "maximum_lag": (0.02, 10.0),
        "record_part_size": (0.0, 1e6),
        "record_part_duration": (0.0, 1e7),
        "record_keep_free": (0.0, 1e7),
        "rerun_port": (0, 65535),
        "rerun_web_port": (0, 65535),
    }


def test_each_parameter_is_described_with_range_and_with_when_a_change_counts(running):
    names = [row.name for row in (*DECLARATIONS, *SCENE_DECLARATIONS)]
    assert running.names() >= set(names)
    answer = running.client.call(DescribeParameters, "describe_parameters", DescribeParameters.Request(names=names), running.process)
    for row, told in zip((*DECLARATIONS, *SCENE_DECLARATIONS), answer.descriptors):
        assert told.description.startswith(row.meaning) and not told.read_only
        assert ("can be changed while the node runs" in told.description) == row.running
        assert ("takes effect at the next configure" in told.description) == (not row.running)
        if isinstance(row.default, float):
            (bounds,) = told.floating_point_range
            assert (bounds.from_value, bounds.to_value) == (row.low, row.high)
    assert {row.name for row in DECLARATIONS if row.running} == {"serial", "publish_rate", "governor"}


@pytest.mark.parametrize(
    ("name", "value", "reason"),
    [
        ("scene", "deng2017_table2", "scene cannot change while the node is active.*deactivate.*cleanup.*configure and activate"),
        ("joint", "rotor", "joint cannot change while the node is active"),
        ("publish_rate", 1000.0, "out of range.*200"),
        ("publish_rate", "fast", "[Tt]ype"),
        ("thresholds.slip_warning", 1.5, "out of range"),
        ("thresholds.slip_warning", float("nan"), "out of range"),
        ("thresholds.slip_warning", 0.2, "slip_warning: 20 % is above slip_error, 10 %.*change the other one first"),
        ("thresholds.slip_warning", "20 %", "slip_warning: 20 % is above slip_error, 10 %"),
        ("thresholds.slip_from_speed", "20 kN", "[Tt]ype"),
        ("thresholds.residual.learning", 2.0, "2 s are 2 batches of 1 s; expected 30 or more"),
        ("lubricant.temperature", 120.0, "out of range.*220"),
        ("no_such_parameter", 1.0, "."),
    ],
)
def test_what_cannot_be_taken_is_refused_with_the_reason_and_changes_nothing(running, name, value, reason):
    before = running.value(name) if name in running.names() else None
    assert re.search(reason, running.set(name, value))
    if before is not None:
        assert running.value(name) == before


def test_a_threshold_changes_in_mid_run_and_the_warning_comes_and_goes(running):
    client = running.client
    report = len(client.received["diagnostics"])
    assert running.set("thresholds.life_warning", 1e8) == "" and running.set("thresholds.life_hold.clear_after", 0.1) == ""
    told = lambda: [status for status in client.statuses(report) if status[1] == "bearing_node: bearing.life"]  # noqa: E731
    client.drive_until(told, "the life is told", running.process)
    level, _, text = told()[0]
    assert level == 1 and text.endswith("is below 1e+08 h")
    assert running.set("thresholds.life_warning", 300) == "", "a whole number will do"
    report = len(client.received["diagnostics"])
    over = lambda: any(client.is_calm(k) for k in range(report, len(client.received["diagnostics"])))  # noqa: E731
    client.drive_until(over, "the warning is over", running.process)
    assert running.value("thresholds.life_warning") == 300.0


def test_the_oil_temperature_changes_in_mid_run_until_the_topic_has_given_it(running):
    client = running.client
    assert running.set("lubricant.temperature", 373.15) == ""
    client.drive_until(lambda: client.values().get("oil temperature [degC]") == "100", "the oil is cooler", running.process)
    topic = topics.INPUTS["oil_temperature"]
    publisher = client.node.create_publisher(type(message(topic.ros_type, {})), "oil_temperature", 10)
    client.spin_until(publisher.get_subscription_count, "the node listens", running.process)

    def told():  # until it is heard: a best-effort subscription may miss the first messages
        warmer = GOOD._replace(oil_temperature=383.15)
        publisher.publish(message(topic.ros_type, topic.message(client.node.get_clock().now().nanoseconds, warmer)))
        return client.values().get("oil temperature [degC]") == "110"

    client.drive_until(told, "the topic counts", running.process)
    assert "the topic oil_temperature has given the temperature" in running.set("lubricant.temperature", 363.15)


def test_a_text_with_a_unit_is_read_as_it_and_the_reason_of_one_that_cannot_be_is_in_the_log(running):
    assert running.set("thresholds.slip_from_speed", "300 rpm") == ""
    assert running.value("thresholds.slip_from_speed") == pytest.approx(31.4159, rel=1e-5)
    assert "thresholds.slip_from_speed = '20 kN'" in running.process.text and "expected a speed such as '45000 rpm'" in running.process.text


def test_values_that_are_what_they_were_are_no_news(running):
    """Tools that restore a file of parameters set them all, also those that cannot change while the node runs."""
    client = running.client
    client.drive_until(lambda: client.values()["phase"] == "running", "the node runs", running.process)
    before, report = running.process.text, len(client.received["diagnostics"])
    began = client.values()["time lost [s]"], float(client.values()["run time [s]"])
    names = sorted(running.names() - {"start_type_description_service"})  # rclpy's own, which is read-only
    values = client.call(GetParameters, "get_parameters", GetParameters.Request(names=names), running.process).values
    request = SetParameters.Request(parameters=[ParameterMessage(name=name, value=value) for name, value in zip(names, values)])
    results = client.call(SetParameters, "set_parameters", request, running.process).results
    assert [(name, result.reason) for name, result in zip(names, results) if not result.successful] == [] and len(names) > 70
    client.drive_until(lambda: float(client.values()["run time [s]"]) > began[1] + 0.5, "the node runs on", running.process)
    assert running.process.text == before and client.values()["time lost [s]"] == began[0]
    assert {name for _, name, _ in client.statuses(report) if not name.startswith("bearing_node: validity.")} == set()


def test_the_publish_rate_and_the_governor_change_in_mid_run(running):
    client = running.client
    assert running.set("publish_rate", 2.0) == "" and running.set("governor", True) == "" and running.set("governor", False) == ""
    client.drive(0.5)
    seen = len(client.received["cage_slip"])
    client.drive(1.5)
    assert 1 <= len(client.received["cage_slip"]) - seen <= 6
    assert running.set("publish_rate", 50) == ""
    seen = len(client.received["cage_slip"])
    client.drive_until(lambda: len(client.received["cage_slip"]) > seen + 20, "it comes faster", running.process)


def test_a_change_is_still_there_after_the_next_configure_whatever_its_unit(running):
    wanted = {"thresholds.slip_from_speed": 30.0, "thresholds.clearance_warning": -5e-06, "thresholds.pocket_force_warning": 0.0}
    for name, value in wanted.items():
        assert running.set(name, value) == ""
    assert all(running.change(step) for step in ("deactivate", "cleanup", "configure", "activate"))
    assert {name: running.value(name) for name in wanted} == wanted


def test_what_is_set_while_unconfigured_counts_at_the_next_configure(tmp_path):
    process, client = start(tmp_path, "autostart:=false", "governor:=false", "publish_rate:=fast")
    parameters = Parameters(client, process)
    try:
        assert not parameters.change("configure")
        told = lambda: [status for status in client.statuses() if "publish_rate = 'fast': expected a number" in status[2]]  # noqa: E731
        client.spin_until(told, "the parameter's fault is told", process)
        assert parameters.set("publish_rate", 20.0) == "" and parameters.set("joint", "rotor") == ""
        assert parameters.set("thresholds.slip_warning", 0.03) == "" and parameters.change("configure")
        assert parameters.set("joint", "rotor_2") == "", "inactive: for the next configure"
        assert parameters.change("activate") and parameters.value("thresholds.slip_warning") == 0.03
        client.wait_until_matched(process)
        client.send("shaft_speed")
        refused = lambda: [status for status in client.statuses() if "no joint 'rotor' in the message" in status[2]]  # noqa: E731
        client.drive_until(refused, "the joint of the configure is looked for", process)
    finally:
        client.close()
        process.end(signal.SIGKILL)


def test_an_oil_temperature_that_is_set_while_inactive_holds_in_the_run(tmp_path):
    process, client = start(tmp_path, "autostart:=false", "governor:=false")
    parameters = Parameters(client, process)
    try:
        assert parameters.change("configure")
        warm = lambda: any("ready to be activated" in text for _, _, text in client.statuses())  # noqa: E731
        client.spin_until(warm, "the model is compiled", process, 100.0)
        assert parameters.set("lubricant.temperature", 373.15) == "" and parameters.change("activate")
        client.wait_until_matched(process)
        client.drive_until(lambda: "oil temperature [degC]" in client.values(), "the node runs", process)
        assert client.values()["oil temperature [degC]"] == "100"
    finally:
        client.close()
        process.end(signal.SIGKILL)


def test_the_example_file_holds_every_parameter_at_its_default_and_the_node_takes_it(tmp_path):
    assert EXAMPLE.read_text() == parameter_file(), "python -m bearing_sim.ros.parameters > launch_scripts/bearing_node.yaml"
    given = yaml.safe_load(EXAMPLE.read_text())["/**"]["ros__parameters"]

    def flat(tree, path=""):
        for key, value in tree.items():
            yield from flat(value, f"{path}{key}.") if isinstance(value, dict) else [(f"{path}{key}", value)]

    defaults = {row.name: row.default for row in (*DECLARATIONS, *SCENE_DECLARATIONS)}
    assert dict(flat(given)) == defaults
    process, client = start(tmp_path, arguments=["--params-file", str(EXAMPLE), "-p", "scene:=deng2017_tabel1"])
    assert process.wait() == 2 and "deng2017_tabel1" in process.text and "unknown" not in process.text, "what comes later counts more"
    client.close()


def is_active(process):
    return "activate: inactive -> active" in process.text


def test_a_node_starts_from_the_example_file_and_from_what_was_dumped_of_a_node_and_has_the_same_parameters_again(tmp_path):
    process, client = start(tmp_path, arguments=["--params-file", str(EXAMPLE)])
    client.wait_until_matched(process)
    client.close()
    assert is_active(process) and process.end(signal.SIGTERM) == 0 and "WARN" not in process.text

    asked = ("front.thresholds.slip_from_speed:='200 rpm'", "rear.scene:=deng2017_table2", "rear.frame_position:=[0.0, 0.5, 1.0e-05]")
    qos = "qos_overrides./front/cage_slip.publisher.reliability:=best_effort"
    process, client = start(tmp_path, "bearings:=[front, rear]", *asked, qos, "publish_rate:=20", "overrides:=[]", "record_keep_free:=0.0")
    dumped = []
    for _ in range(2):
        parameters = Parameters(client, process)
        client.spin_until(lambda: is_active(process), "the node is active", process, 100.0)  # noqa: B023
        (offered,) = client.node.get_publishers_info_by_topic("/front/cage_slip")
        assert offered.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
        dumped.append(parameters.dump())
        if len(dumped) == 1:  # at the next configure it is as it was
            assert all(parameters.change(step) for step in ("deactivate", "cleanup", "configure", "activate"))
            dumped.append(parameters.dump())
        client.close()
        assert process.end(signal.SIGINT) == 0 and "unknown" not in process.text and "WARN" not in process.text
        if len(dumped) == 2:
            (tmp_path / "dumped.yaml").write_text(dumped[0])
            process, client = start(tmp_path, arguments=["--params-file", str(tmp_path / "dumped.yaml")])
    assert len(set(dumped)) == 1
    first = yaml.safe_load(dumped[0])["/bearing_node"]["ros__parameters"]
    assert first["front"]["thresholds"]["slip_from_speed"] == pytest.approx(200 * 2 * np.pi / 60)
    assert first["qos_overrides"]["/front/cage_slip"]["publisher"] == {
        "depth": 10, "durability": "volatile", "history": "keep_last", "reliability": "best_effort",
    }  # fmt: skip
    assert {"/front/shaft_speed", "/rear/radial_load", "/diagnostics"} <= first["qos_overrides"].keys()


def test_qualities_of_service_that_cannot_be_are_all_told_at_once(tmp_path):
    wrong = ("/cage_slip.publisher.reliability:=reliabel", "/damage.publisher.depth:=0", "/shaft_speed.subscription.depth:=five")
    process, client = start(tmp_path, *(f"qos_overrides.{each}" for each in wrong))
    client.close()
    assert process.wait() == 2 and "3 parameter errors" in process.text and "(did you mean 'reliable'?)" in process.text
    assert "/damage.publisher.depth = 0: outside 1 to" in process.text and "depth = 'five': expected an integer" in process.text


@pytest.mark.long
def test_two_bearings_in_one_process_have_their_own_topics_services_parameters_diagnostics_and_recordings(tmp_path):
    scenes = ["front.scene:=deng2017_table1", "rear.scene:=deng2017_table2", "front.thresholds.life_warning:=1e8"]
    process, front = start(
        tmp_path, "bearings:=[front, rear]", *scenes, "governor:=false", f"record:={tmp_path / 'run.mcap'}", namespace="ship/front",
        arguments=["-r", "__ns:=/ship", "-r", "rear/damage:=/plant/damage"],
    )  # fmt: skip
    rear = Client(front.context.get_domain_id(), "ship/rear")
    try:
        front.wait_until_matched(process)
        rear.wait_until_matched(process)

        def both():
            front.drive(0.1, shaft_speed=1000.0)
            rear.drive(0.1, shaft_speed=500.0)
            return front.received["bearing_joints"] and rear.received["bearing_joints"]

        front.spin_until(both, "both run", process)
        assert front.received["bearing_joints"][-1].velocity[0] == pytest.approx(1000.0)
        assert rear.received["bearing_joints"][-1].velocity[0] == pytest.approx(500.0)
        names = lambda: {status.name: status for report in front.received["diagnostics"] for status in report.status}  # noqa: E731
        # Each bearing reports at its own instants.
        front.drive_until(lambda: names()["ship/bearing_node/front: life"].level == b"\x01", "the front's threshold counts", process)
        front.drive_until(lambda: "ship/bearing_node/rear: condition" in names(), "the rear reports", process)
        assert names()["ship/bearing_node/front: condition"].hardware_id == "front/deng2017_table1"
        assert names()["ship/bearing_node/rear: condition"].hardware_id == "rear/deng2017_table2"
        pausing = rear.node.create_client(SetBool, "/ship/bearing_node/rear/pause")
        rear.spin_until(pausing.service_is_ready, "the rear's service is there", process)
        answer = pausing.call_async(SetBool.Request(data=True))
        rear.spin_until(answer.done, "the rear pauses", process)
        rear.drive(0.3, shaft_speed=500.0)
        held, seen = len(rear.received["cage_slip"]), len(front.received["cage_slip"])
        rear.drive(0.3, shaft_speed=500.0)
        front.drive_until(lambda: len(front.received["cage_slip"]) > seen, "the front goes on", process)
        rear.spin(0.1)
        assert len(rear.received["cage_slip"]) == held
        stopping = front.node.create_client(Trigger, "/ship/bearing_node/front/stop_recording")
        front.spin_until(stopping.service_is_ready, "the front's service is there", process)
        answer = stopping.call_async(Trigger.Request())
        front.spin_until(answer.done, "the front's recording ends", process)
        assert answer.result().success and (tmp_path / "run_front.mcap").is_file() and not (tmp_path / "run_rear.mcap").exists()
        assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text
        assert sorted(path.name for path in tmp_path.glob("run*")) == ["run_front.mcap", "run_rear.mcap"]
        found = [item for item in BagReader(tmp_path / "run_rear.mcap") if isinstance(item, BagTopic)]
        assert {"/ship/rear/cage_slip", "/ship/rear/shaft_speed", "/plant/damage", "/diagnostics"} <= {topic.name for topic in found}
        assert read_input_log(tmp_path / "run_rear.mcap").series["shaft_speed"].topic == "/ship/rear/shaft_speed"
        recording = Recording(tmp_path / "run_rear.mcap")
        assert recording.samples == sum(len(item) for item in recording if isinstance(item, np.ndarray)) > 0
    finally:
        rear.close()
        front.close()
        process.end(signal.SIGKILL)


@pytest.mark.long
@pytest.mark.parametrize(
    ("names", "words"), [("[Front]", "is not a valid name"), ("[front, front]", "is given 2 times"), ("[scene]", "is the name of a parameter")]
)
def test_names_that_cannot_be_a_fleet_are_refused_with_the_reason(tmp_path, names, words):
    process, client = start(tmp_path, f"bearings:={names}")
    assert process.wait() == 2 and words in process.text and "Traceback" not in process.text
    client.close()
