# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What messages of samples cost: ``python test/benchmarks/message_cost.py`` from the root of the tree to measure.

Printed are microseconds of processor time for each sample: to fill the messages of all topics with the numbers of a sample, as the node does,
without and with those that are computed (characteristic frequencies, the cloud of rollers); to publish a plain number and the cloud to one
subscriber; to write a recording, and its size, with and without the topics that repeat the numbers of others.  Every time is the least of some
repetitions, because other programs only add to it.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

sys.path.insert(0, str(Path.cwd()))
REPEATED, SAMPLES = 7, 2000


def least(act: Callable[[], object], samples: int = SAMPLES) -> float:
    """Return the processor time of an act for each of its samples [us]."""
    found = []
    for _ in range(REPEATED):
        began = time.process_time()
        act()
        found.append((time.process_time() - began) / samples * 1e6)
    return min(found)


def main() -> None:
    """Measure and print."""
    import numpy as np

    from bearing_sim.messages import topics
    from bearing_sim.messages.sample_messages import SampleMessages, message_templates
    from bearing_sim.recording import writer
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.simulation import Simulation

    scene = load_scene("deng2017_table1", ["level=planar"])
    table, rollers = topics.outputs(scene), scene.bearing.roller.count
    block = Simulation(scene).advance(0.001 * SAMPLES, None, SAMPLES)
    messages = SampleMessages(message_templates(tuple(table.values()), rollers))

    def fill_all() -> None:
        for k in range(SAMPLES):
            messages.fill(k, block[k])

    print(f"{rollers} rollers, cloud of {len(messages.parts[list(table).index('rollers')])} bytes")
    for name, wanted in {"fill": (), "fill with frequencies": ("characteristic_frequencies",), "fill with rollers": ("rollers",)}.items():
        messages.compute([topic in wanted for topic in table])
        print(f"{name:28}{least(fill_all):8.1f} us a sample")
    publish(table, messages)
    recorded = topics.recorded
    for name, kept in {"record": lambda topic: True, "record without repeating": lambda topic: not topic.repeats}.items():
        topics.recorded = lambda scene, kept=kept: {key: topic for key, topic in recorded(scene).items() if kept(topic)}
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "run.mcap"

            def record(path: Path = path) -> None:
                with writer.McapSink(path, scene, 0, replace=True) as sink:
                    for part in np.array_split(block, SAMPLES // 50):
                        sink.write(part)

            print(f"{name:28}{least(record):8.1f} us a sample, {path.stat().st_size / SAMPLES:.0f} bytes a sample")


def publish(table, messages) -> None:
    """Measure the cost of publishing serialised messages, where ROS is installed."""
    os.environ |= {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(50 + os.getpid() % 50)}
    try:
        import rclpy
    except ImportError:
        print("publishing is not measured: no rclpy")
        return
    from bearing_sim.ros.messages import message_class

    rclpy.init()
    node = rclpy.create_node("message_cost")
    for name in ("cage_slip", "rollers"):
        part = messages.parts[list(table).index(name)]
        kind = message_class(table[name].ros_type)
        publisher = node.create_publisher(kind, name, 10)
        node.create_subscription(kind, name, lambda cdr: None, 10, raw=True)
        deadline = time.monotonic() + 20.0
        while not publisher.get_subscription_count() and time.monotonic() < deadline:
            rclpy.spin_once(node, timeout_sec=0.1)

        def send(publisher=publisher, part=part) -> None:
            for _ in range(SAMPLES):
                publisher.publish(bytes(part))

        print(f"{'publish ' + name:28}{least(send):8.1f} us a message, {len(part)} bytes")
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
