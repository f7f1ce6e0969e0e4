# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Input messages read from their bytes say what their objects say, whoever sends them, and what is none is refused."""

import math

import numpy as np
import pytest

pytest.importorskip("rclpy", reason="messages need ROS 2 (pip install 'bearing_sim[ros]', or a ROS installation)")

from rclpy.serialization import deserialize_message, serialize_message  # noqa: E402

from bearing_sim.messages import topics  # noqa: E402
from bearing_sim.ros import messages  # noqa: E402
from bearing_sim.ros.messages import InputReader, Refused, message, message_class  # noqa: E402

JOINT_STATE, WRENCH = topics.INPUTS["shaft_speed"].ros_type, topics.INPUTS["radial_load"].ros_type
TEMPERATURE, SCALAR = topics.INPUTS["oil_temperature"].ros_type, "std_msgs/msg/Float64"


def joint_state(rng, names, joint, frame, stamp):
    count = len(names)
    header = {"stamp": {"sec": stamp[0], "nanosec": stamp[1]}, "frame_id": frame}
    numbers = {field: rng.normal(size=count) for field in ("position", "velocity", "effort")}
    made = message(JOINT_STATE, {"header": header, "name": names, **numbers})
    return made, (float(numbers["velocity"][names.index(joint)]),)


def wrench(rng, frame, stamp):
    force, torque = ({axis: float(rng.normal()) for axis in "xyz"} for _ in range(2))
    header = {"stamp": {"sec": stamp[0], "nanosec": stamp[1]}, "frame_id": frame}
    return message(WRENCH, {"header": header, "wrench": {"force": force, "torque": torque}}), (force["y"], force["z"])


def with_other_padding(cdr: bytes, kind, rng) -> bytes:
    """Return the message with other bytes wherever they say nothing: those that can be any without a change of the object."""
    told, found = deserialize_message(cdr, kind), bytearray(cdr)
    for place in range(len(cdr)):
        tried = bytearray(found)
        tried[place] ^= int(rng.integers(1, 256))
        try:
            if deserialize_message(bytes(tried), kind) == told:
                found = tried
        except Exception:
            continue
    return bytes(found)


@pytest.mark.parametrize("names", [["shaft"], ["a", "shaft", "gearbox_output"], ["a_rather_long_name", "b", "shaft"]])
@pytest.mark.parametrize("frame", ["", "bearing", "ünïcode"])
def test_joint_states_of_any_sender_say_what_was_put_in(names, frame):
    rng, reader = np.random.default_rng(1), InputReader("shaft_speed", JOINT_STATE, "shaft", "bearing")
    for _ in range(5):
        stamp = (int(rng.integers(1, 2**31)), int(rng.integers(0, 1_000_000_000)))
        made, values = joint_state(rng, names, "shaft", frame, stamp)
        assert reader.read(serialize_message(made)) == (values, stamp[0] * 1_000_000_000 + stamp[1], frame)
        assert len(reader._layouts) == 1, "the first message tells where the others have their numbers"


@pytest.mark.parametrize("names", [["cage", "cage_standard_error"], ["shaft", "cage", "cage_standard_error"], ["cage_standard_error", "cage"]])
def test_a_measured_cage_is_read_with_its_standard_error_wherever_its_joint_is(names):
    rng, reader = np.random.default_rng(3), InputReader(topics.MEASURED, JOINT_STATE, "cage", "bearing")
    for _ in range(3):
        made, (speed,) = joint_state(rng, names, "cage", "", (5, 7))
        error = float(made.velocity[names.index("cage_standard_error")])
        assert reader.read(serialize_message(made)) == ((speed, error), 5_000_000_007, "")


@pytest.mark.parametrize("names", [["running_clearance", "running_clearance_standard_error"], ["a", "running_clearance"]])
def test_a_measured_clearance_is_read_out_of_the_positions(names):
    rng, reader = np.random.default_rng(3), InputReader(topics.MEASURED_CLEARANCE, JOINT_STATE, topics.CLEARANCE_JOINT, "bearing")
    for _ in range(3):
        made, _ = joint_state(rng, names, topics.CLEARANCE_JOINT, "", (5, 7))
        expected = tuple(float(made.position[k]) for k, name in enumerate(names) if name.startswith(topics.CLEARANCE_JOINT))
        assert reader.read(serialize_message(made)) == (expected, 5_000_000_007, "")
    assert len(reader._layouts) == 1, "the first message tells where the others have their numbers"


@pytest.mark.parametrize("frame", ["", "bearing"])
def test_loads_say_what_was_put_in_and_what_cdr_leaves_unused_does_not_count(frame, monkeypatch):
    rng, reader = np.random.default_rng(2), InputReader("radial_load", WRENCH, "", "bearing")
    made, values = wrench(rng, frame, (5, 7))
    cdr = serialize_message(made)
    assert reader.read(cdr) == (values, 5_000_000_007, frame)
    monkeypatch.setattr(messages, "deserialize_message", lambda *_: pytest.fail("read through an object again"))
    assert reader.read(with_other_padding(cdr, message_class(WRENCH), rng)) == (values, 5_000_000_007, frame)


@pytest.mark.parametrize(
    ("channel", "ros_type", "field", "expected"),
    [
        ("shaft_speed", SCALAR, {"data": 3.5}, 3.5),
        ("radial_load", SCALAR, {"data": 800.0}, 800.0),
        ("oil_temperature", TEMPERATURE, {"temperature": 120.0}, 393.15),
    ],
)
def test_the_other_types_say_what_was_put_in_each_time(channel, ros_type, field, expected):
    reader = InputReader(channel, ros_type, "shaft", "bearing")
    for factor in (1.0, 2.0, 3.0):
        cdr = serialize_message(message(ros_type, {name: factor * value for name, value in field.items()}))
        offset = topics.ZERO_CELSIUS if channel == "oil_temperature" else 0.0
        assert reader.read(cdr)[0] == pytest.approx(((expected - offset) * factor + offset,), rel=1e-15)
        assert reader.read(cdr)[1] is None


def test_a_sender_with_other_names_is_read_anew_and_the_joint_is_found_where_it_is_there():
    rng, reader = np.random.default_rng(3), InputReader("shaft_speed", JOINT_STATE, "shaft", "")
    for names in (["shaft", "other"], ["other", "shaft"]) * 3:  # of equal length
        made, values = joint_state(rng, names, "shaft", "", (1, 2))
        assert reader.read(serialize_message(made))[0] == values
    without, _ = joint_state(rng, ["shafu", "other"], "other", "", (1, 2))
    with pytest.raises(Refused, match="no joint 'shaft' in the message; it has 'shafu', 'other'") as fault:
        reader.read(serialize_message(without))
    assert fault.value.kind == "input.malformed"


def test_a_load_in_another_frame_is_refused_after_good_ones_too():
    rng, reader = np.random.default_rng(4), InputReader("radial_load", WRENCH, "", "bearing")
    assert reader.read(serialize_message(wrench(rng, "bearing", (1, 2))[0]))[2] == "bearing"
    for _ in range(2):
        with pytest.raises(Refused, match="frame 'bearinh', expected 'bearing'") as fault:
            reader.read(serialize_message(wrench(rng, "bearinh", (1, 2))[0]))
        assert fault.value.kind == "input.frame"


def test_a_joint_without_velocity_is_refused_after_good_ones_too():
    rng, reader = np.random.default_rng(5), InputReader("shaft_speed", JOINT_STATE, "shaft", "")
    good, _ = joint_state(rng, ["shaft"], "shaft", "", (1, 2))
    reader.read(serialize_message(good))
    good.velocity, good.effort = [], [1.0, 2.0]  # of the same length in all
    assert len(serialize_message(good)) == len(serialize_message(joint_state(rng, ["shaft"], "shaft", "", (1, 2))[0]))
    with pytest.raises(Refused, match="no velocity for the joint 'shaft'"):
        reader.read(serialize_message(good))


def test_what_is_not_finite_comes_through_for_the_gate_to_judge():
    reader = InputReader("shaft_speed", SCALAR, "shaft", "")
    for value in (1.0, math.inf, math.nan):
        (found,) = reader.read(serialize_message(message(SCALAR, {"data": value})))[0]
        assert found == value or math.isnan(found) and math.isnan(value)


def test_senders_that_differ_from_message_to_message_are_read_through_objects_and_not_learned_for_ever():
    rng, reader = np.random.default_rng(6), InputReader("shaft_speed", JOINT_STATE, "shaft", "")
    for k in range(60):
        made, values = joint_state(rng, ["shaft"], "shaft", "x" * k, (1, 2))
        assert reader.read(serialize_message(made))[0] == values
    assert len(reader._layouts) < 20


@pytest.mark.parametrize("cdr", [b"", b"\x00\x01\x00\x00", b"\x00\x01\x00\x00" + 9 * b"\xff"], ids=["nothing", "no_content", "too_long_a_frame"])
def test_bytes_that_are_no_message_are_refused(cdr):
    with pytest.raises(Refused, match="bytes are not a sensor_msgs/msg/JointState") as fault:
        InputReader("shaft_speed", JOINT_STATE, "shaft", "").read(cdr)
    assert fault.value.kind == "input.malformed"
