# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the message table: every array filled, names and units where readers look for them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.runtime.input_gate import InputGate
from bearing_sim.sample import new_block
from bearing_sim.scene import InputLimits
from bearing_sim.simulation import Inputs

STAMP = 1_700_000_000_250_000_001


def one_sample(rollers=5):
    sample = new_block(1, rollers)[0]
    for place, name in enumerate(sample.dtype.names):
        sample[name] = place + 1 + np.arange(rollers) / 10 if sample[name].shape else place + 1
    return sample


def arrays(message):
    if isinstance(message, dict):
        for value in message.values():
            yield from arrays(value)
    elif isinstance(message, (list, np.ndarray)):
        yield message
        if isinstance(message, list):
            for item in message:
                yield from arrays(item)


def as_object(message):
    if isinstance(message, dict):
        return SimpleNamespace(**{key: as_object(value) for key, value in message.items()})
    return [as_object(item) for item in message] if isinstance(message, list) else message


@pytest.mark.parametrize("topic", [*topics.INPUTS.values(), *topics.OUTPUTS.values()], ids=lambda topic: topic.name)
def test_every_array_of_every_message_is_filled(topic):
    source = Inputs(1.0, 2.0, 3.0, 390.0) if topic.name in topics.INPUTS else one_sample()
    assert all(len(array) > 0 for array in arrays(topic.message(STAMP, source)))


def test_stamp_keeps_every_nanosecond():
    assert topics.stamp(STAMP) == {"sec": 1_700_000_000, "nanosec": 250_000_001}


@pytest.mark.parametrize("channel, expected", [("shaft_speed", (4712.5,)), ("radial_load", (600.0, -300.0)), ("oil_temperature", (393.15,))])
def test_an_input_written_is_the_input_read(channel, expected):
    topic = topics.INPUTS[channel]
    message = as_object(topic.message(STAMP, Inputs(4712.5, 600.0, -300.0, 393.15)))
    assert topics.input_values(channel, topic.ros_type, message) == pytest.approx(expected, rel=1e-14)
    assert topics.header_stamp_ns(message) == STAMP


def test_oil_temperature_travels_in_celsius():
    assert topics.INPUTS["oil_temperature"].message(STAMP, Inputs(0, 0, 0, 393.15))["temperature"] == pytest.approx(120.0)


def test_scalar_load_is_a_magnitude_which_the_gate_puts_along_y():
    gate = InputGate(InputLimits(), Inputs(0.0, 1.0, 2.0, 390.0))
    assert gate.offer("radial_load", 0.0, topics.input_values("radial_load", "std_msgs/msg/Float64", SimpleNamespace(data=800.0))) is None
    assert (gate.held.load_y, gate.held.load_z) == (800.0, 0.0)


def test_joints_are_found_by_name_not_by_place():
    message = SimpleNamespace(name=["fan", "spool"], velocity=[1.0, 2.0])
    assert topics.input_values("shaft_speed", "sensor_msgs/msg/JointState", message, joint="spool") == (2.0,)


def test_absent_joint_or_velocity_is_said():
    with pytest.raises(ValueError, match="no joint 'shaft'.*'fan'"):
        topics.input_values("shaft_speed", "sensor_msgs/msg/JointState", SimpleNamespace(name=["fan"], velocity=[1.0]))
    with pytest.raises(ValueError, match="no velocity"):
        topics.input_values("shaft_speed", "sensor_msgs/msg/JointState", SimpleNamespace(name=["shaft"], velocity=[]))
    with pytest.raises(ValueError, match="cannot carry"):
        topics.input_values("oil_temperature", "std_msgs/msg/Float64", SimpleNamespace(data=1.0))


def test_roller_loads_layout_indexes_the_data():
    sample = one_sample(rollers=4)
    message = topics.OUTPUTS["roller_loads"].message(STAMP, sample)
    ring, roller = message["layout"]["dim"]
    assert (ring["label"], roller["label"]) == ("ring", "roller")
    assert ring["stride"] == ring["size"] * roller["stride"] == len(message["data"])
    assert message["data"][1 * roller["stride"] + 2] == sample["outer_load"][2]


@pytest.mark.parametrize("name", topics.ARRAYS)
def test_every_array_says_how_its_numbers_lie(name):
    sample = one_sample(rollers=4)
    message = (topics.OUTPUTS | topics.RECORDED)[name].message(STAMP, sample)
    dim, (label, fields) = message["layout"]["dim"], topics.ARRAYS[name]
    assert dim[0]["label"] == label and math.prod(d["size"] for d in dim) == dim[0]["stride"] == len(message["data"])
    step = dim[1]["stride"] if len(dim) == 2 else 1
    for row, field in enumerate(fields):
        np.testing.assert_array_equal(message["data"][row * step : (row + 1) * step], np.atleast_1d(sample[field]))


def test_diagnostics_level_is_a_byte_and_the_worst_of_the_events():
    events = [Event(1.0, Level.WARN, "slip.high", "slip is 6 %"), Event(1.0, Level.ERROR, "input.stale", "no speed for 2 s")]
    message = topics.diagnostics(STAMP, events, topics.condition(one_sample()), hardware_id="b1")
    assert [status["level"] for status in message["status"]] == [b"\x02", b"\x01", b"\x02"]
    assert message["status"][0]["message"] == "no speed for 2 s"
    assert topics.diagnostics(STAMP)["status"][0]["level"] == b"\x00"


def test_diagnostics_numbers_are_strings_with_the_unit_in_the_key():
    sample = one_sample()
    sample["shaft_speed"] = 1500 * math.pi
    values = {pair["key"]: pair["value"] for pair in topics.diagnostics(STAMP, (), topics.condition(sample))["status"][0]["values"]}
    assert float(values["shaft speed [rpm]"]) == pytest.approx(45_000)
    assert all("[" in key and isinstance(value, str) and value for key, value in values.items())
