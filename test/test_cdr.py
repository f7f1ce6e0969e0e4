# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Layouts derived from message definitions, against messages that rosbags and rclpy serialise and read."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore

from bearing_sim.files.limits import VARIABLE
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import CdrError, CdrLayout, NumberColumns, is_known

STORE = get_typestore(Stores.ROS2_JAZZY)
USED = sorted(
    {topic.ros_type for topic in (*topics.INPUTS.values(), *topics.MEASUREMENTS.values(), *topics.OUTPUTS.values())} | {topics.DIAGNOSTICS[1]}
)
DTYPES = {"bool": np.bool_, "byte": np.uint8, "char": np.uint8} | {
    kind: getattr(np, kind) for kind in ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64")
}


def random_value(rng, node, detail):
    """Return a value of a field and, for each number and string in it, (path below the field, value)."""
    if node == Nodetype.NAME:
        return random_message(rng, detail)
    if node == Nodetype.BASE:
        if detail[0] == "string":
            text = "".join(rng.choice(list("aä/ "), rng.integers(0, 9)))
            return text, [("", text)]
        number = random_numbers(rng, detail[0], 1)[0].item()
        return number, [("", number)]
    (item, item_detail), count = detail
    count = count if node == Nodetype.ARRAY else int(rng.integers(0, 4))
    if item == Nodetype.BASE and item_detail[0] != "string":
        numbers = random_numbers(rng, item_detail[0], count)
        return numbers, [("", numbers)]
    items = [random_value(rng, item, item_detail) for _ in range(count)]
    return [value for value, _ in items], [(f"[{k}]{path}", leaf) for k, (_, leaves) in enumerate(items) for path, leaf in leaves]


def random_numbers(rng, kind, count):
    dtype = np.dtype(DTYPES[kind])
    if dtype.kind == "f":
        return rng.normal(size=count).astype(dtype)
    most = 2 if dtype.kind == "b" else 128 if kind in ("byte", "char") else min(np.iinfo(dtype).max, 2**62)  # rosbags takes a single byte as signed
    return rng.integers(0, most, count).astype(dtype)


def random_message(rng, ros_type):
    values, leaves = {}, []
    for name, (node, detail) in STORE.fielddefs[ros_type][1]:
        values[name], found = random_value(rng, node, detail)
        leaves += [(f".{name}{path}", leaf) for path, leaf in found]
    return STORE.types[ros_type](**values), leaves


def value_at(data, field):
    """Return what stands at a field of a message, by the rules of CDR."""
    if field.dtype is None:
        length = int.from_bytes(data[field.begin : field.begin + 4], "little")
        return data[field.begin + 4 : field.begin + 4 + length - 1].decode()
    return np.frombuffer(data, field.dtype, field.count, field.begin)


@pytest.mark.parametrize("ros_type", sorted(STORE.types))
@settings(max_examples=5, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_every_field_of_every_standard_message_stands_where_rosbags_serialised_it(ros_type, seed):
    message, leaves = random_message(np.random.default_rng(seed), ros_type)
    data = bytes(STORE.serialize_cdr(message, ros_type))
    layout = CdrLayout(ros_type, data)
    expected = {path[1:]: leaf for path, leaf in leaves}
    assert set(layout.by_path) == set(expected)
    for path, field in layout.by_path.items():
        np.testing.assert_array_equal(value_at(data, field), expected[path], err_msg=path)
    assert layout.fields == sorted(layout.fields, key=lambda field: (field.begin, field.end)), "fields do not overlap"
    assert all(one.end <= other.begin for one, other in zip(layout.fields, layout.fields[1:]))
    assert layout.fields[-1].end == len(data)


@pytest.mark.parametrize("ros_type", USED)
@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_every_field_stands_where_rclpy_serialised_it(ros_type, seed):
    pytest.importorskip("rclpy", reason="the node needs ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")
    from rclpy.serialization import serialize_message

    from bearing_sim.ros.messages import message_class

    message, leaves = random_message(np.random.default_rng(seed), ros_type)
    data = serialize_message(as_rclpy(message, message_class(ros_type)()))
    layout = CdrLayout(ros_type, data)
    expected = {path[1:]: leaf for path, leaf in leaves}
    assert set(layout.by_path) == set(expected)
    for path, field in layout.by_path.items():
        np.testing.assert_array_equal(value_at(data, field), expected[path], err_msg=path)


def as_rclpy(message, target):
    """Return a message of rclpy with the fields of one of rosbags."""
    from bearing_sim.ros.messages import message_class

    for name in target.get_fields_and_field_types():
        value, own = getattr(message, name), getattr(target, name)
        if hasattr(value, "__dataclass_fields__"):
            as_rclpy(value, own)
        elif isinstance(value, list) and value and hasattr(value[0], "__msgtype__"):
            setattr(target, name, [as_rclpy(item, message_class(item.__msgtype__)()) for item in value])
        elif isinstance(value, np.ndarray):
            setattr(target, name, value.tolist())
        else:
            setattr(target, name, bytes([value]) if isinstance(own, bytes) else value)
    return target


def joint_state(velocity, names=("shaft", "cage"), frame="lab", stamp=7):
    types = STORE.types
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](stamp, 5), frame)
    none = np.zeros(0)
    message = types["sensor_msgs/msg/JointState"](header, list(names), none, np.array(velocity, float), none)
    return bytes(STORE.serialize_cdr(message, "sensor_msgs/msg/JointState"))


def test_numbers_are_read_from_many_messages_at_once_whatever_their_stamps_and_padding():
    rows = [joint_state((k, -k), stamp=k) for k in range(5)]
    layout = CdrLayout("sensor_msgs/msg/JointState", rows[0])
    gaps = [at for one, other in zip(layout.fields, layout.fields[1:]) for at in range(one.end, other.begin)]
    assert gaps, "there is padding between the names and the numbers"
    table = np.array([list(row) for row in rows], np.uint8)
    table[2, gaps] = 99
    columns = NumberColumns(table[0], [(0, layout)])
    np.testing.assert_array_equal(columns.read(table), [[k, -k] for k in range(5)])


@pytest.mark.parametrize("other", [joint_state((1.0, 2.0), ("shaft", "cagf")), joint_state((1.0, 2.0), frame="lac")])
def test_messages_with_other_names_or_frames_are_not_read_as_alike(other):
    data = joint_state((1.0, 2.0))
    columns = NumberColumns(np.frombuffer(data, np.uint8), [(0, CdrLayout("sensor_msgs/msg/JointState", data))])
    assert len(other) == len(data) and columns.read(np.frombuffer(other, np.uint8)[None]) is None


def test_numbers_of_several_messages_in_a_row_are_read_by_their_types():
    flag = bytes(STORE.serialize_cdr(STORE.types["std_msgs/msg/Int16"](-300), "std_msgs/msg/Int16"))
    speed = joint_state((math.inf, -2.5))
    row = np.frombuffer(b"?" + flag + b"??" + speed, np.uint8)
    columns = NumberColumns(row, [(1, CdrLayout("std_msgs/msg/Int16", flag)), (3 + len(flag), CdrLayout("sensor_msgs/msg/JointState", speed))])
    np.testing.assert_array_equal(columns.read(row[None]), [[-300.0, math.inf, -2.5]])


def test_a_big_endian_message_is_read():
    data = b"\x00\x00\x00\x00" + np.array([1.5], ">f8").tobytes()
    assert CdrLayout("std_msgs/msg/Float64", data).values(data)["data"].tolist() == [1.5]


@pytest.mark.parametrize("ros_type", USED)
@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), share=st.floats(0.0, 0.999))
def test_a_message_cut_short_is_refused(ros_type, seed, share):
    message, _ = random_message(np.random.default_rng(seed), ros_type)
    data = bytes(STORE.serialize_cdr(message, ros_type))
    with pytest.raises(CdrError, match="of sensor_msgs|of std_msgs|of geometry_msgs|of diagnostic_msgs"):
        CdrLayout(ros_type, data[: int(share * len(data))])


@pytest.mark.parametrize(
    "data", [b"", b"\x00\x01\x00\x00" + 9 * b"\xff", b"\x00\x07\x00\x00" + bytes(80)], ids=["nothing", "long_string", "other_representation"]
)
def test_bytes_that_are_no_message_are_refused(data):
    with pytest.raises(CdrError):
        CdrLayout("sensor_msgs/msg/JointState", data)


def test_a_layout_has_no_more_fields_than_the_limit(monkeypatch):
    data = joint_state((1.0, 2.0))
    count = len(CdrLayout("sensor_msgs/msg/JointState", data).fields)
    monkeypatch.setenv(VARIABLE, f"message_items={count}")
    assert len(CdrLayout("sensor_msgs/msg/JointState", data).fields) == count == 12
    monkeypatch.setenv(VARIABLE, f"message_items={count - 1}")
    with pytest.raises(CdrError, match="message_items=NUMBER"):
        CdrLayout("sensor_msgs/msg/JointState", data)


def test_types_outside_ros_2_jazzy_are_unknown():
    assert is_known("std_msgs/msg/Float64") and not is_known("drive_msgs/msg/ServoState")
