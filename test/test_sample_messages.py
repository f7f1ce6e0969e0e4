# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages filled byte by byte: held against those that rclpy and rosbags serialise from message objects."""

import numpy as np
import pytest

from bearing_sim.messages.cdr import message_type
from bearing_sim.messages.sample_messages import SampleMessages, message_templates
from bearing_sim.messages.topics import Topic, outputs, recorded
from bearing_sim.model.sample import new_block
from bearing_sim.scene.loader import load_scene

LEVELS = ("steady", "slip", "planar", "spatial")
STAMPS = (1_700_000_000_000_000_000, 1_700_000_000_999_999_999, 0, 1)


def random_block(samples, rollers):
    block = new_block(samples, rollers)
    noise = np.random.default_rng(7)
    for name in block.dtype.names:
        block[name] = noise.normal(size=block[name].shape)
    block["cage_slip"][0], block["rating_life"][1], block["damage"][2], block["cage_angle"][3] = np.nan, np.inf, 0.0, -0.0
    return block


def filled(topics, scene):
    """Fill the messages of a few samples, one after the other in the same place; yield topic, message, and the fields it should have."""
    rollers = scene.bearing.roller.count
    messages = SampleMessages(message_templates(topics, rollers))
    for stamp_ns, sample in zip(STAMPS, random_block(len(STAMPS), rollers)):
        messages.fill(stamp_ns, sample)
        for k, topic in enumerate(topics):
            yield topic, bytes(messages.parts[k]), topic.message(stamp_ns, sample)


@pytest.mark.parametrize("level", LEVELS)
def test_every_recorded_topic_is_filled_to_the_bytes_that_rosbags_serialises(level):
    scene = load_scene("deng2017_table1", [f"level={level}"])
    for topic, found, fields in filled(tuple(recorded(scene).values()), scene):
        assert found == message_type(topic.ros_type).serialize(fields), topic.name


@pytest.mark.parametrize("level", LEVELS)
def test_every_output_topic_is_filled_to_what_rclpy_serialises_and_reads_but_for_padding(level):
    """Rclpy leaves in the padding whatever the memory held, and reads over it."""
    pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
    from rclpy.serialization import deserialize_message, serialize_message

    from bearing_sim.ros.messages import message, message_class

    def read(topic, data):
        return repr(deserialize_message(data, message_class(topic.ros_type)))

    scene = load_scene("deng2017_table1", [f"level={level}"])
    for topic, found, fields in filled(tuple(outputs(scene).values()), scene):
        expected = message(topic.ros_type, fields)
        assert read(topic, found) == repr(expected), topic.name
        serialised = serialize_message(expected)
        behind = 8 if topic.ros_type == "sensor_msgs/msg/JointState" else 0  # rclpy aligns the numbers of empty arrays, which have none
        assert 0 <= len(serialised) - len(found) <= behind, topic.name
        for place in (k for k in range(len(found)) if found[k] != serialised[k]):
            changed = found[:place] + bytes([255 - found[place]]) + found[place + 1 :]
            assert read(topic, changed) == repr(expected), f"{topic.name}: byte {place} is not padding"


def test_rclpy_reads_from_the_bytes_what_the_sample_says():
    pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
    from rclpy.serialization import deserialize_message

    from bearing_sim.ros.messages import message_class

    scene = load_scene("deng2017_table1")
    chosen = [topic for name, topic in outputs(scene).items() if name in ("cage_slip", "bearing_joints", "roller_loads")]
    sample = random_block(4, scene.bearing.roller.count)[3]
    messages = SampleMessages(message_templates(chosen, scene.bearing.roller.count))
    messages.fill(1_234_000_000_005, sample)
    slip, joints, loads = (deserialize_message(bytes(messages.parts[k]), message_class(topic.ros_type)) for k, topic in enumerate(chosen))
    assert slip.data == sample["cage_slip"]
    assert (joints.header.stamp.sec, joints.header.stamp.nanosec) == (1234, 5) and joints.name == ["shaft", "cage", "cage_ideal"]
    assert list(joints.velocity) == [sample["shaft_speed"], sample["cage_speed"], sample["ideal_cage_speed"]]
    assert list(loads.data) == [*sample["inner_load"], *sample["outer_load"]]


def test_a_sample_that_is_one_of_a_block_is_read_where_it_stands():
    scene = load_scene("deng2017_table1")
    block = random_block(4, scene.bearing.roller.count)
    messages = SampleMessages(message_templates([outputs(scene)["damage"]], scene.bearing.roller.count))
    found = []
    for sample in block:
        messages.fill(0, sample)
        found.append(np.frombuffer(messages.parts[0][4:])[0])
    assert found == block["damage"].tolist()


def test_a_topic_whose_numbers_are_not_those_of_the_sample_is_refused():
    celsius = Topic("celsius", "std_msgs/msg/Float64", "", lambda stamp_ns, sample: {"data": float(sample["oil_temperature"]) - 273.15})
    with pytest.raises(ValueError, match="celsius.*hold no number of a sample"):
        message_templates([celsius], 6)
    single = Topic("single", "std_msgs/msg/Float32", "", lambda stamp_ns, sample: {"data": 0.0}, {"data": ("cage_slip",)})
    with pytest.raises(ValueError, match="single: data has 1 numbers of float32"):
        message_templates([single], 6)
