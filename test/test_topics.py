# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the message table: every array filled, names and units where readers look for them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from bearing_sim.inputs.gate import InputGate
from bearing_sim.messages import topics
from bearing_sim.messages.diagnostics import condition, report
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.sample_messages import SampleMessages, message_templates
from bearing_sim.model.sample import OBSERVABLES, new_block
from bearing_sim.scene.scene import InputLimits
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
    events = [Event(1.0, Level.WARN, "bearing.slip", "", "slip is 6 %"), Event(1.0, Level.ERROR, "input.stale", "", "no speed for 2 s")]
    message = report(STAMP, events, condition(one_sample()), hardware_id="b1")
    level = {status["name"]: status["level"] for status in message["status"]}
    assert level["bearing_sim: condition"] == level["bearing_sim: inputs"] == b"\x02" and level["bearing_sim: slip"] == b"\x01"
    assert message["status"][0]["message"] == "no speed for 2 s (and 1 more)"
    assert {status["level"] for status in report(STAMP)["status"]} == {b"\x00"}


def test_diagnostics_state_a_sample_in_the_units_that_their_keys_name():
    """Written out: 15,000 rpm, a load of 3-4-5, oil at 120 degC."""
    sample = one_sample()
    for name, value in {
        "shaft_speed": 500.0 * math.pi,
        "load_y": 300.0,
        "load_z": -400.0,
        "oil_temperature": 393.15,
        "running_clearance": -3.5e-6,
        "cage_slip": 0.0625,
        "rating_life": 389.0,
        "damage": 0.005,
    }.items():
        sample[name] = value
    assert condition(sample) == pytest.approx(
        {
            "shaft speed [rad/s]": 500.0 * math.pi,
            "radial load [N]": 500.0,
            "oil temperature [degC]": 120.0,
            "running clearance [m]": -3.5e-6,
            "cage slip [fraction]": 0.0625,
            "rating life [h]": 389.0,
            "damage [fraction of life]": 0.005,
        }
    )


def test_diagnostics_numbers_are_strings_with_the_unit_in_the_key():
    sample = one_sample()
    sample["shaft_speed"] = 1500 * math.pi
    values = {pair["key"]: pair["value"] for pair in report(STAMP, (), condition(sample))["status"][0]["values"]}
    assert float(values["shaft speed [rad/s]"]) == pytest.approx(1500 * math.pi) and values.pop("events") == "0"
    assert all("[" in key and isinstance(value, str) and value for key, value in values.items())


# What each row of each array is, written out: label on the wire, observable, unit.  These are promises to readers of recordings and topics.
WIRE = {
    "equivalent_loads": (
        "whole rollers inner, outer, laminae inner, outer",
        [("inner_equivalent_load", "N"), ("outer_equivalent_load", "N"), ("inner_lamina_load", "N"), ("outer_lamina_load", "N")],
    ),
    "rating_lives": ("L10, L_nm, L10r, L_nmr", [("l10", "h"), ("lnm", "h"), ("l10r", "h"), ("lnmr", "h")]),
    "life_factors": (
        "P, P_ref, kappa, e_C, a_ISO at P, a_ISO of laminae, S_0",
        [
            ("equivalent_load", "N"),
            ("reference_load", "N"),
            ("viscosity_ratio", ""),
            ("contamination_factor", ""),
            ("modification_factor", ""),
            ("reference_modification_factor", ""),
            ("static_safety", ""),
        ],
    ),
    "running_clearance": (
        "running, initial, fits, rotation, heat, contour",
        [
            ("running_clearance", "m"),
            ("initial_clearance", "m"),
            ("fit_clearance", "m"),
            ("rotation_clearance", "m"),
            ("heat_clearance", "m"),
            ("contour_clearance", "m"),
        ],
    ),
    "centre_positions": (
        "inner ring y, z, cage y, z, outer ring y, z, shaft y, z",
        [(f"{body}_{axis}", "m") for body in ("ring", "cage", "outer_ring", "shaft") for axis in "yz"],
    ),
    "axis_tilts": (
        "inner ring y, z, cage y, z",
        [("ring_tilt_y", "rad"), ("ring_tilt_z", "rad"), ("cage_tilt_y", "rad"), ("cage_tilt_z", "rad")],
    ),
    "slice_pressures": (
        "inner, outer, inner end slices, outer end slices",
        [("inner_pressure", "Pa"), ("outer_pressure", "Pa"), ("inner_edge_pressure", "Pa"), ("outer_edge_pressure", "Pa")],
    ),
    "power": (
        "shaft, inner sliding, outer sliding, churning, windage, land, pocket, damping, inner rolling, outer rolling, seal, support, "
        "friction moment, flange",
        [
            ("shaft_power", "W"),
            ("inner_sliding_power", "W"),
            ("outer_sliding_power", "W"),
            ("churning_power", "W"),
            ("windage_power", "W"),
            ("land_power", "W"),
            ("pocket_power", "W"),
            ("damping_power", "W"),
            ("inner_rolling_power", "W"),
            ("outer_rolling_power", "W"),
            ("seal_power", "W"),
            ("support_power", "W"),
            ("friction_moment", "N*m"),
            ("flange_power", "W"),
        ],
    ),
    "roller_speeds": ("speed: orbital, spin", [("orbital_speed", "rad/s"), ("roller_spin", "rad/s")]),
    "pocket_forces": ("force on", [("pocket_force", "N")]),
    "roller_tilts": ("inclination: outwards, along the orbit", [("roller_tilt", "rad"), ("roller_skew", "rad")]),
    "roller_loads": ("ring", [("inner_load", "N"), ("outer_load", "N")]),
    "operating_point": (
        "load y, z, oil temperature, land eccentricity, inner and outer flange force, flange load",
        [
            ("load_y", "N"),
            ("load_z", "N"),
            ("oil_temperature", "K"),
            ("land_eccentricity", ""),
            ("inner_flange_force", "N"),
            ("outer_flange_force", "N"),
            ("flange_load", "N"),
        ],
    ),
    "predicted_temperatures": (
        "shaft, inner ring, rollers, outer ring, housing, oil that leaves",
        [
            ("shaft_temperature", "K"),
            ("inner_ring_temperature", "K"),
            ("roller_temperature", "K"),
            ("outer_ring_temperature", "K"),
            ("housing_temperature", "K"),
            ("oil_outlet_temperature", "K"),
        ],
    ),
    "heat_flows": ("to the oil, to ambient", [("heat_to_oil", "W"), ("heat_to_ambient", "W")]),
    "measured_temperatures": (
        "measured inner ring, outer ring, uncorrected inner ring, outer ring",
        [
            ("inner_ring_temperature_measured", "K"),
            ("outer_ring_temperature_measured", "K"),
            ("inner_ring_temperature_uncorrected", "K"),
            ("outer_ring_temperature_uncorrected", "K"),
        ],
    ),
    "roller_places": ("angle, radius, rotation", [("roller_angle", "rad"), ("roller_radius", "m"), ("roller_rotation", "rad")]),
}
NUMBERS = {"cage_slip": "", "rating_life": "h", "modified_rating_life": "h", "level": "", "damage": ""}
JOINT_ROWS = {
    "shaft": ("shaft_angle", "shaft_speed"),
    "cage": ("cage_angle", "cage_speed"),
    "cage_ideal": ("ideal_cage_angle", "ideal_cage_speed"),
}


def on_the_wire(rollers=4):
    """Return one sample, and its messages by topic as another library reads them from the bytes that are published and recorded."""
    sample, store = one_sample(rollers), get_typestore(Stores.ROS2_JAZZY)
    table = tuple((topics.OUTPUTS | topics.RECORDED).values())
    messages = SampleMessages(message_templates(table, rollers))
    messages.fill(STAMP, sample)
    return sample, {topic.name: store.deserialize_cdr(bytes(part), topic.ros_type) for topic, part in zip(table, messages.parts)}


def test_no_topic_of_samples_is_missing_from_what_is_written_out_here():
    assert {*WIRE, *NUMBERS, "bearing_joints"} == {*topics.OUTPUTS, *topics.RECORDED}


@pytest.mark.parametrize("name", WIRE)
def test_rows_of_an_array_are_those_that_its_label_names_in_their_order_and_unit(name):
    sample, messages = on_the_wire()
    message, (label, rows) = messages[name], WIRE[name]
    assert message.layout.dim[0].label == label
    data = message.data.reshape(len(rows), -1)
    units = {observable.name: observable.unit for observable in OBSERVABLES}
    for row, (observable, unit) in zip(data, rows):
        np.testing.assert_array_equal(row, np.atleast_1d(sample[observable]), err_msg=observable)
        assert units[observable] == unit, observable
        assert f"[{unit}]" in (topics.OUTPUTS | topics.RECORDED)[name].meaning or not unit


def test_plain_numbers_and_joints_carry_the_observable_that_they_name():
    sample, messages = on_the_wire()
    for name, unit in NUMBERS.items():
        assert messages[name].data == sample[name] and (f"[{unit}]" in topics.OUTPUTS[name].meaning or not unit), name
    joints = messages["bearing_joints"]
    found = {name: (angle, speed) for name, angle, speed in zip(joints.name, joints.position, joints.velocity)}
    assert found == {name: (sample[angle], sample[speed]) for name, (angle, speed) in JOINT_ROWS.items()}
    assert np.isnan(joints.effort).all() and (joints.header.stamp.sec, joints.header.stamp.nanosec) == (1_700_000_000, 250_000_001)
