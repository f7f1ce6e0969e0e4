# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node with a measured cage and measured rings: residuals published, recorded and judged, sensors that die, over DDS."""

import math
import signal
import time

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402

from bearing_sim.inputs.log import read_input_log  # noqa: E402
from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402

pytestmark = pytest.mark.timeout(180)
QUICK = ("batch=40ms", "learning=1.5s", "settling=0.2s", "tolerance=0.2%")


@pytest.fixture
def node(tmp_path):
    """A node that records, and a client of it."""
    domain = fresh_domain()
    words = ", ".join(f"'thresholds.residual.{word}'" for word in QUICK)
    arguments = ("-p", f"overrides:=[{words}]", "-p", "governor:=false", "-p", "cage_joint:=m1_cage", "-p", f"record:={tmp_path / 'run.mcap'}")
    process, client = NodeProcess(tmp_path, domain, "--ros-args", *arguments), Client(domain)
    yield process, client
    client.close()
    process.end(signal.SIGKILL)


class Cage:
    """Publishes what a sensor at the cage would, told from the node's own prediction."""

    def __init__(self, client):
        self.client = client
        self.publisher = client.node.create_publisher(
            message_class(topics.MEASUREMENTS[topics.MEASURED].ros_type), topics.MEASURED, qos_profile_sensor_data
        )
        self.residuals = []
        client.listen("std_msgs/msg/Float64", "cage_slip_residual", lambda got: self.residuals.append(got.data))

    def send(self, speed, name="m1_cage"):
        topic = topics.MEASUREMENTS[topics.MEASURED]
        fields = topic.message(self.client.node.get_clock().now().nanoseconds, (speed, 0.5)) | {"name": [name, f"{name}_standard_error"]}
        self.publisher.publish(message(topic.ros_type, fields))

    def drive_until(self, condition, extra, patience=40.0):
        """Drive the node, with a cage that slips by ``extra`` more than the node says, until the condition holds."""
        end = time.monotonic() + patience
        while not condition():
            assert time.monotonic() < end, f"{self.client.values()}"
            self.client.drive(0.02)
            if joints := self.client.received["bearing_joints"]:
                _, cage, ideal = joints[-1].velocity
                self.send(cage - extra * ideal)


@pytest.mark.long
def test_a_measured_cage_is_compared_judged_published_and_recorded(node, tmp_path):
    process, client = node
    cage = Cage(client)
    client.wait_until_matched(process)
    client.drive_until(lambda: client.received["cage_slip"] and client.received["diagnostics"], "the node runs", process)
    assert not any("residual" in key for key in client.values()) and not cage.residuals

    def verdict():
        return client.values().get("residual slip, verdict")

    cage.drive_until(lambda: verdict() == "as predicted", extra=0.01)
    assert cage.residuals[-1] == pytest.approx(0.01, abs=3e-3)
    assert float(client.values()["residual slip, usual mean [fraction]"]) == pytest.approx(0.01, abs=0.003)
    cage.drive_until(lambda: verdict() == "slips more than predicted", extra=0.05)
    (told,) = {(level, text.partition(", usually")[0]) for level, name, text in client.statuses() if name.endswith("residual.shift")}
    assert told == (1, "residual slip: the cage slips more than predicted")
    assert process.text.count("residual.shift") == 1, "logged once"

    cage.send(math.nan)
    cage.send(100.0, name="propeller")
    for words in ("nan rad/s is not finite", "no joint 'm1_cage'"):
        client.drive_until(lambda words=words: any(words in text for _, _, text in client.statuses()), "the fault is told", process)

    assert process.end(signal.SIGINT) == 0, process.text
    with AnyReader([tmp_path / "run.mcap"]) as reader:
        found = {connection.topic: reader.deserialize(data, connection.msgtype) for connection, _, data in reader.messages()}
    assert found["/cage_slip_residual"].data == pytest.approx(0.05, abs=0.01)
    assert found["/cage_speed_measured"].name == ["cage", "cage_standard_error"] and found["/cage_speed_measured"].velocity[1] == 0.5
    assert found["/cage_speed_measured"].velocity[0] > 100.0
    assert len(read_input_log(tmp_path / "run.mcap").series["shaft_speed"].log_times) > 100
    samples = sum(len(item) for item in Recording(tmp_path / "run.mcap") if isinstance(item, np.ndarray))
    assert samples > 100, "readers of runs are not troubled by what they do not know"


def started(tmp_path, *overrides):
    """Return a node with these overrides of its scene, and a client of it."""
    domain, words = fresh_domain(), ", ".join(f"'{override}'" for override in overrides)
    process, client = NodeProcess(tmp_path, domain, "--ros-args", "-p", f"overrides:=[{words}]", "-p", "governor:=false"), Client(domain)
    client.wait_until_matched(process)
    return process, client


class RingSensor:
    """Publishes the temperature of the inner ring [degC] whenever the node is driven."""

    def __init__(self, client):
        self.client, self.topic = client, topics.INPUTS["inner_ring_temperature"]
        self.publisher = client.node.create_publisher(message_class(self.topic.ros_type), self.topic.name, qos_profile_sensor_data)
        self.celsius = None

    def drive_until(self, condition, process):
        end = time.monotonic() + 40.0
        while not condition():
            assert time.monotonic() < end and process.process.poll() is None, f"{self.client.statuses()[-12:]}\n{process.text}"
            self.client.drive(0.05)
            if self.celsius is not None:
                stamp = self.client.node.get_clock().now().nanoseconds
                fields = self.topic.message(stamp, GOOD._replace(inner_ring_temperature=self.celsius + topics.ZERO_CELSIUS))
                self.publisher.publish(message(self.topic.ros_type, fields))


@pytest.mark.long
def test_a_ring_temperature_corrects_the_network_and_when_its_sensor_dies_the_network_takes_over_and_diagnostics_say_so(tmp_path):
    process, client = started(tmp_path, "heat.law=network", "input_limits.stale_after=0.1s")  # a temperature dies after 1 s
    sensor, key = RingSensor(client), "inner ring temperature measured [degC]"

    def told(kind):
        return [text for _, name, text in client.statuses(-3) if name.endswith(f": {kind}") and text.startswith("inner_ring_temperature")]

    client.drive_until(lambda: client.received["predicted_temperatures"] and client.received["diagnostics"], "the node runs", process)
    before = client.received["predicted_temperatures"][-1].data[1]
    sensor.celsius = before - topics.ZERO_CELSIUS + 20.0
    sensor.drive_until(lambda: float(client.values().get(key, "nan")) == pytest.approx(sensor.celsius, abs=1e-6), process)
    sensor.drive_until(lambda: client.received["predicted_temperatures"][-1].data[1] > before + 1.0, process)
    sensor.drive_until(lambda: "residual temperature of the inner ring [K]" in client.values(), process)
    sensor.celsius, alive = None, sensor.celsius
    sensor.drive_until(lambda: told("input.stale"), process)
    assert "the temperature of the thermal network stands in" in told("input.stale")[-1]
    sensor.drive_until(lambda: key not in client.values(), process)
    count = len(client.received["cage_slip"])
    sensor.drive_until(lambda: len(client.received["cage_slip"]) > count + 20, process)
    sensor.celsius = alive
    sensor.drive_until(lambda: key in client.values() and not told("input.stale"), process)
    assert process.text.count("input.returned: inner_ring_temperature: it is measured again") == 1
    client.close()
    assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text


def test_a_node_without_a_law_of_heat_says_that_nobody_reads_the_temperature_of_a_ring(tmp_path):
    process, client = started(tmp_path, "heat.law=none")
    sensor = RingSensor(client)
    sensor.celsius = 120.0
    sensor.drive_until(lambda: any(name.endswith(": input.unused") for _, name, _ in client.statuses(-3)), process)
    assert sensor.publisher.get_subscription_count() == 0 and not client.received["predicted_temperatures"]
    (told,) = {text for _, name, text in client.statuses() if name.endswith(": input.unused")}
    assert told.startswith("inner_ring_temperature: heat.law is none") and "set heat.law to given or network" in told
    client.close()
    assert process.end(signal.SIGINT) == 0 and "Traceback" not in process.text
