# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node with blocks of vibration over DDS: a cage speed with its standard error out of them, no line where there is none, refused blocks."""

import itertools
import math
import signal
import time

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.qos import qos_profile_sensor_data  # noqa: E402
from ros_bench import GOOD, Client, NodeProcess, fresh_domain  # noqa: E402
from rosbags.highlevel import AnyReader  # noqa: E402
from synthetic_vibration import Machine, record  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.ros.messages import message, message_class  # noqa: E402
from bearing_sim.scene.loader import load_scene  # noqa: E402

pytestmark = pytest.mark.timeout(300)
RATE, WINDOW, BLOCKS = 51_200.0, 0.5, 2
AGAIN = 10.0  # [s] after which a window is sent again, in case that it was lost


@pytest.mark.long
def test_blocks_of_vibration_become_a_measured_cage_speed_with_its_error_and_noise_becomes_none(tmp_path):
    bearing = load_scene("deng2017_table1").bearing
    size = bearing.roller.diameter / bearing.pitch_diameter
    machine = Machine("outer_ring", bearing.roller.count, size, 0.03, GOOD.shaft_speed, interfering=0, pocket_play=0.03, signal_to_noise=10.0)
    synthetic = record(machine, RATE, WINDOW, np.random.default_rng(3))
    noise = np.random.default_rng(4).normal(size=int(RATE * WINDOW))
    domain = fresh_domain()
    arguments = ("-p", "overrides:=['vibration.window=0.5 s']", "-p", "governor:=false", "-p", f"record:={tmp_path / 'run.mcap'}")
    process, client = NodeProcess(tmp_path, domain, "--ros-args", *arguments), Client(domain)
    kind = topics.VIBRATION.ros_type
    publisher = client.node.create_publisher(message_class(kind), topics.VIBRATION.name, qos_profile_sensor_data)

    numbers = itertools.count()

    def send(samples, **sizes):
        dimensions = [{"label": label, "size": size, "stride": 0} for label, size in sizes.items()]
        publisher.publish(message(kind, {"layout": {"dim": dimensions, "data_offset": 0}, "data": np.asarray(samples)}))

    def send_window(samples):
        """Send the blocks of a window at once, so that no busy machine tears it, and wait until it is analysed."""
        before, end = value("windows"), time.monotonic() + AGAIN
        for block in np.split(samples, BLOCKS):
            send(block, rate=int(RATE), sequence=next(numbers))
        while value("windows") == before and time.monotonic() < end:
            client.drive(0.1)

    def value(key):
        return client.values().get(f"vibration: {key}", "")

    def send_until(samples, condition):
        for _ in range(20):
            send_window(samples)
            if condition():
                return
        raise AssertionError(f"waited in vain: {client.values()}\n{process.text}")

    try:
        client.wait_until_matched(process)
        client.spin_until(lambda: publisher.get_subscription_count(), "the node listens to the vibration", process)
        client.drive_until(lambda: client.received["cage_slip"] and value("last window"), "the node runs", process)
        send_until(noise, lambda: value("windows without a claim") not in ("", "0"))
        assert "no line of this bearing" in value("last window") and not any("residual slip" in key for key in client.values())
        send_until(synthetic.vibration.samples, lambda: "outer ring shows" in value("last window"))
        for samples, sizes, reason in (([1.0, math.nan], {"rate": 1000}, "sample 1 of the block is nan"), ([1.0], {}, "label 'rate'")):
            send(samples, **sizes)
            client.drive_until(lambda reason=reason: any(reason in text for _, _, text in client.statuses()), reason, process)
        assert process.end(signal.SIGINT) == 0, process.text
    finally:
        client.close()
        process.end(signal.SIGKILL)
    with AnyReader([tmp_path / "run.mcap"]) as reader:
        found = [reader.deserialize(data, each.msgtype) for each, _, data in reader.messages() if each.topic == "/cage_speed_measured"]
    assert found and all(list(each.name) == ["cage", "cage_standard_error"] for each in found)
    speed, error = found[0].velocity
    assert abs(speed / (synthetic.ratio * GOOD.shaft_speed) - 1.0) < 0.02 and 0.0 < error < 0.02 * speed
