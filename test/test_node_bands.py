# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A node whose scene asks for bands and a calibration, over DDS: its topics, what a measured cage with a standard error does, the service."""

import math
import signal

import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from made_up_response import FACTOR, FIELD, asking_scene, made_up_response  # noqa: E402
from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import Client, NodeProcess, fresh_domain  # noqa: E402
from std_srvs.srv import Trigger  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.messages.bands import BANDS, ESTIMATES, bands_of_message  # noqa: E402
from bearing_sim.messages.events import Event  # noqa: E402
from bearing_sim.recording.reader import Recording  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.watchers.estimation.response import response_path, write_response  # noqa: E402

pytestmark = pytest.mark.timeout(180)
OVERRIDES = ("uncertainty=null", f"uncertainty.{FIELD}=[0.0201, 0.0601]", "estimation.bands=true", f"estimation.calibrated=[{FIELD}]")
"""A range that no other scene has, so that the response made up for it serves this test alone."""
QUICK = ("estimation.interval=0.2s", "thresholds.residual={batch: 0.2 s, learning: 6 s, settling: 0.5 s, false_alarm_time: 1 h}")

FAST = {"shaft_speed": 4700.0}
"""At which the cage slips by several points [rad/s]."""


def keep_response():
    """Keep a response for the scene and return where."""
    scene = asking_scene(*OVERRIDES, *QUICK)
    write_response(response_path(scene), made_up_response(scene))
    return response_path(scene)


@pytest.fixture
def node(tmp_path, request):
    """A node that records, for whose scene a response is kept, unless it is asked for without, and a client of it."""
    domain, path = fresh_domain(), keep_response()
    if getattr(request, "param", "") == "without":
        path.unlink()
    words = ", ".join(f"'{word}'" for word in (*OVERRIDES, *QUICK))
    arguments = ("-p", f"overrides:=[{words}]", "-p", "governor:=false", "-p", f"record:={tmp_path / 'run.mcap'}")
    process, client = NodeProcess(tmp_path, domain, "--ros-args", *arguments), Client(domain)
    yield process, client
    client.close()
    process.end(signal.SIGKILL)
    path.unlink(missing_ok=True)


@pytest.mark.long
@pytest.mark.parametrize("node", ["with", "without"], indirect=True, ids=["response kept", "response built while it runs"])
def test_bands_and_estimates_are_published_calibrated_by_a_measured_cage_and_recorded(node, tmp_path):
    process, client = node
    kind, heard = topics.ESTIMATED[BANDS].ros_type, {BANDS: [], ESTIMATES: []}
    for name, found in heard.items():
        client.listen(kind, name, found.append)
    topic = topics.MEASUREMENTS[topics.MEASURED]
    cage = client.node.create_publisher(message_class(topic.ros_type), topics.MEASURED, qos_profile_sensor_data)
    client.wait_until_matched(process)
    keep_response()  # again, or now
    client.drive_until(lambda: heard[BANDS] and heard[ESTIMATES] and client.received["diagnostics"], "bands and estimates", process)
    first = heard[BANDS][-1]
    bands = bands_of_message(BANDS, 0.0, list(first.name), first.position)
    assert bands.names == ("cage_slip", "rating_life", "running_clearance", "remaining_life") and first.header.frame_id == "bearing"
    slip, low, high = bands.numbers[0, 0]
    assert low < slip < high and not any(key.endswith(", calibrated") for key in client.values())

    def calibrated():
        if joints := client.received["bearing_joints"]:
            speed = joints[-1].velocity[2] * (1.0 - slip) * (1.0 + 1e-5 * math.sin(joints[-1].header.stamp.nanosec))
            stamp_ns = client.node.get_clock().now().nanoseconds
            cage.publish(message(topic.ros_type, topic.message(stamp_ns, (speed, 1e-3 * speed))))
        return any(key.endswith(", calibrated") for key in client.values())

    client.drive_until(calibrated, "the measured cage teaches the field", process)
    count = len(heard[ESTIMATES])
    client.drive_until(lambda: len(heard[ESTIMATES]) > count, "newer estimates", process)
    estimates = heard[ESTIMATES][-1]
    assert list(estimates.name) == [FIELD, f"{FIELD} 5 %", f"{FIELD} 95 %"] and estimates.position[1] < estimates.position[0] < estimates.position[2]
    answer = client.call(Trigger, "accept_change", Trigger.Request(), process)
    assert not answer.success and "no change to accept" in answer.message

    assert process.end(signal.SIGINT) == 0, process.text
    recorded = list(Recording(tmp_path / "run.mcap").bands())
    assert {each.topic for each in recorded} == {BANDS, ESTIMATES}
    errors = [each.standard_error for each in Recording(tmp_path / "run.mcap").with_measurements() if hasattr(each, "standard_error")]
    assert errors and all(error > 0.0 for error in errors), "a measurement is recorded with its standard error"


class Machine:
    """A synthetic bearing: the node's own slip, changed as the response made up says that a value of the field changes it, and a sensor of its cage.

    Parameters
    ----------
    client : publishes the readings.
    field : of the machine [SI].
    """

    def __init__(self, client, field):
        self._client, self.field, self.readings = client, field, 0
        self._own = asking_scene(*OVERRIDES).lubricant.mixture_fraction
        self._topic = topics.MEASUREMENTS[topics.MEASURED]
        self._publisher = client.node.create_publisher(message_class(self._topic.ros_type), topics.MEASURED, qos_profile_sensor_data)

    def measured(self):
        """Publish a reading with a noise of 0.05 points of slip."""
        joints, slips = self._client.received["bearing_joints"], self._client.received["cage_slip"]
        if joints and slips:
            slip = slips[-1].data * FACTOR ** ((self.field - self._own) / 0.04) + 5e-4 * math.sin(1e3 * self.readings**2)
            speed = joints[-1].velocity[2] * (1.0 - slip)
            stamp_ns = self._client.node.get_clock().now().nanoseconds
            self._publisher.publish(message(self._topic.ros_type, self._topic.message(stamp_ns, (speed,))))
            self.readings += 1


@pytest.mark.long
def test_a_change_of_the_machine_is_told_accepted_and_becomes_the_new_normal(node, tmp_path):
    process, client = node
    estimates = []
    client.listen(topics.ESTIMATED[ESTIMATES].ros_type, ESTIMATES, estimates.append)
    machine = Machine(client, 0.03)
    client.wait_until_matched(process)

    def learned(readings):
        """Whether so many readings have been sent since, and the newest estimate is near the machine's field and sure of it."""
        machine.measured()
        value, low, high = estimates[-1].position[:3] if estimates else (math.nan,) * 3
        return machine.readings >= readings and high - low < 0.01 and abs(value - machine.field) < 0.003

    def alarm():
        return any(kind.endswith("calibration.change") for _, kind, _ in client.statuses(-1))

    def told():
        machine.measured()
        return alarm()

    client.drive_until(lambda: learned(90), "the machine's field is learned", process, **FAST)
    assert not alarm()
    machine.field = 0.05
    client.drive_until(told, "the change is told", process, **FAST)
    answer = client.call(Trigger, "accept_change", Trigger.Request(), process)
    assert answer.success, answer.message
    again = machine.readings + 60
    client.drive_until(lambda: learned(again), "the changed machine's field is learned", process, **FAST)
    count = len(client.received["diagnostics"])
    client.drive_until(lambda: learned(again) and len(client.received["diagnostics"]) >= count + 3, "newer reports", process, **FAST)
    assert not any(kind.endswith("calibration.change") for _, kind, _ in client.statuses(count)), "it is the new normal"
    refused = client.call(Trigger, "accept_change", Trigger.Request(), process)
    assert not refused.success and "no change to accept" in refused.message
    assert process.end(signal.SIGINT) == 0, process.text
    kinds = [event.kind for event in Recording(tmp_path / "run.mcap") if isinstance(event, Event)]
    assert "calibration.change" in kinds, "the change is recorded"
