# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What other nodes may do wrong, over real topics: names, frames, floods, rivals, silence; each told in diagnostics in so many words."""

import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402

pytestmark = pytest.mark.timeout(240)
FLOOD = 5000.0  # Hz


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    """One node that runs, and its client."""
    domain = fresh_domain()
    limits = "['input_limits.maximum_rate=120Hz', 'input_limits.stale_after=0.5s']"
    process = NodeProcess(
        tmp_path_factory.mktemp("inputs"), domain, "--ros-args", "-p", f"overrides:={limits}", "-p", "governor:=false", limit=230
    )  # fmt: skip
    client = Client(domain)
    client.domain = domain
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"], "the node runs", process)
    yield process, client
    assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text
    client.close()


def joint_state(**fields):
    made = topics.INPUTS["shaft_speed"].message(time.time_ns(), GOOD._replace(shaft_speed=1.0)) | fields
    return "shaft_speed", message(topics.INPUTS["shaft_speed"].ros_type, made)


def wrench(frame, stamp_ns=None):
    made = topics.INPUTS["radial_load"].message(stamp_ns or time.time_ns(), GOOD._replace(load_y=801.0))
    made["header"]["frame_id"] = frame
    return "radial_load", message(topics.INPUTS["radial_load"].ros_type, made)


@pytest.mark.parametrize(
    ("make", "code", "text"),
    [
        (
            lambda: joint_state(name=["propeller"]),
            "input.malformed",
            "shaft_speed: no joint 'shaft' in the message; it has 'propeller'; message refused, holding 1000 rad/s",
        ),
        (
            lambda: joint_state(name=[], velocity=np.array([]), position=np.array([]), effort=np.array([])),
            "input.malformed",
            "shaft_speed: no joint 'shaft' in the message; it has none; message refused, holding 1000 rad/s",
        ),
        (
            lambda: joint_state(velocity=np.array([])),
            "input.malformed",
            "shaft_speed: the message has no velocity for the joint 'shaft' (0 velocities for 1 joints); message refused, holding 1000 rad/s",
        ),
        (
            lambda: wrench("map"),
            "input.frame",
            "radial_load: frame 'map', expected 'bearing' (parameter frame_id); the direction of the force would be wrong; "
            "message refused, holding (800, 0) N",
        ),
    ],
    ids=["wrong_joint", "empty_arrays", "no_velocity", "wrong_frame"],
)
def test_a_message_about_something_else_is_refused_and_told_word_for_word(node, make, code, text):
    process, client = node
    client.drive(0.3)
    report, joint = len(client.received["diagnostics"]), len(client.received["bearing_joints"])
    channel, made = make()
    client.publishers[channel].publish(made)
    told = lambda: [s for s in client.statuses(report) if s[1] == f"bearing_node: {code}"]  # noqa: E731
    client.drive_until(told, f"{code} is reported", process)
    found = re.sub(r" \(\d+ times\)$", "", told()[0][2])
    found = re.sub(r"(would be wrong): .*;", r"\1;", found)  # why there is no transform depends on what is installed
    assert told()[0][0] == 2 and found == text
    assert {round(message.velocity[0], 3) for message in client.received["bearing_joints"][joint:]} == {round(GOOD.shaft_speed, 3)}


def test_a_load_without_a_frame_is_taken(node):
    process, client = node
    client.drive_until(client.is_calm, "what was wrong before is over", process)
    report = len(client.received["diagnostics"])

    def sent():
        client.publishers["radial_load"].publish(wrench("")[1])
        return client.values().get("radial load [N]") == "801"

    client.drive_until(sent, "the load counts", process, load_y=801.0)
    assert not [status for status in client.statuses(report) if "input.frame" in status[1]]


def test_a_flood_of_five_thousand_messages_a_second_is_told_with_its_rate_and_the_node_lives_on(node):
    process, client = node
    report, seen = len(client.received["diagnostics"]), len(client.received["cage_slip"])
    flood = _flooding(client.domain)
    try:
        told = lambda: [s for s in client.statuses(report) if s[1] == "bearing_node: input.rate" and s[2].startswith("shaft_speed")]  # noqa: E731
        client.drive_until(told, "the flood is told", process)
        level, _, text = told()[0]
        assert (level, text) == (1, "shaft_speed: messages arrive at more than 120 Hz; values are used as they arrive")
        client.drive_until(lambda: len(client.received["cage_slip"]) > seen + 20, "slip comes in spite of it", process)
    finally:
        flood.terminate()
        flood.wait(10)
    client.drive_until(client.is_calm, "all is well again", process)


def _flooding(domain):
    """Start a process that sends shaft speeds at `FLOOD`."""
    code = f"""
import time, rclpy
from rclpy.qos import qos_profile_sensor_data
from bearing_sim.messages import topics
from bearing_sim.ros.messages import message, message_class
from bearing_sim.simulation import Inputs
rclpy.init(args=[], domain_id={domain})
node, topic = rclpy.create_node("flood"), topics.INPUTS["shaft_speed"]
publisher = node.create_publisher(message_class(topic.ros_type), "shaft_speed", qos_profile_sensor_data)
inputs, due = Inputs(1000.0, 800.0, 0.0, 393.15), time.monotonic()
while True:
    publisher.publish(message(topic.ros_type, topic.message(time.time_ns(), inputs)))
    due += 1 / {FLOOD}
    time.sleep(max(0.0, due - time.monotonic()))
"""
    return subprocess.Popen(["timeout", "-s", "KILL", "60", sys.executable, "-c", code], cwd=Path(__file__).resolve().parents[1])


class Rival:
    """Another publisher of shaft_speed."""

    def __init__(self, client):
        self._client, self._node = client, client.node
        self._publisher = client.node.create_publisher(message_class(topics.INPUTS["shaft_speed"].ros_type), "shaft_speed", qos_profile_sensor_data)

    def send(self, speed):
        topic = topics.INPUTS["shaft_speed"]
        made = topic.message(self._node.get_clock().now().nanoseconds, GOOD._replace(shaft_speed=speed))
        self._publisher.publish(message(topic.ros_type, made))

    def close(self):
        self._node.destroy_publisher(self._publisher)


def test_two_publishers_of_one_input_are_told_and_worse_where_they_disagree(node):
    process, client = node
    report, rival = len(client.received["diagnostics"]), Rival(client)
    told = lambda level: [s for s in client.statuses(report) if s[1] == "bearing_node: input.publishers" and s[0] == level]  # noqa: E731
    client.drive_until(lambda: told(1), "two publishers are told", process)
    assert told(1)[0][2] == "shaft_speed: 2 publishers, expected one; the newest value of any of them is used"

    def contradicted():
        rival.send(1500.0)
        client.drive(0.02)
        return told(2)

    client.drive_until(contradicted, "they disagree", process)
    assert told(2)[0][2] == "shaft_speed: 2 publishers, expected one, and they disagree; the newest value is used, which is wrong for one of them"
    assert client.values()["shaft_speed jumps between"] == "1000 rad/s and 1500 rad/s"
    rival.close()
    gone = lambda: not [name for _, name, _ in client.statuses(-1) if "input.publishers" in name]  # noqa: E731
    client.drive_until(gone, "one is left", process)


def test_a_publisher_that_is_gone_for_three_seconds_and_back_is_told_and_the_model_takes_it_up_again(node):
    process, client = node
    client.drive(0.3)
    report = len(client.received["diagnostics"])
    old = client.publishers["shaft_speed"]
    client.node.destroy_publisher(old)
    end = time.monotonic() + 3.0
    while time.monotonic() < end:
        client.send("radial_load")
        client.spin(0.05)
    stale = [s for s in client.statuses(report) if s[1] == "bearing_node: input.stale"]
    assert stale and stale[-1][0] == 1
    assert stale[-1][2] == (
        "shaft_speed: no good message for longer than 0.5 s: nobody publishes /shaft_speed (sensor_msgs/msg/JointState); the last good value is held"
        "; start its publisher, or remap the topic"
    )
    assert client.received["bearing_joints"][-1].velocity[0] == pytest.approx(1000.0), "the model went on with the last one"
    client.publishers["shaft_speed"] = client.node.create_publisher(
        message_class(topics.INPUTS["shaft_speed"].ros_type), "shaft_speed", qos_profile_sensor_data
    )
    client.drive_until(
        lambda: client.received["bearing_joints"][-1].velocity[0] == pytest.approx(1100.0), "the new one counts", process, shaft_speed=1100.0
    )
    client.drive_until(client.is_calm, "nothing is stale", process, shaft_speed=1100.0)
