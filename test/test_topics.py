# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the message table: arrays filled or empty as the messages' definitions ask, names and units where readers look for them."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from bearing_sim.inputs.gate import InputGate
from bearing_sim.messages import topics
from bearing_sim.messages.diagnostics import condition, report
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.point_cloud import ROLLER_FIELDS
from bearing_sim.messages.sample_messages import SampleMessages, message_templates
from bearing_sim.model.characteristic_frequencies import characteristic_frequencies, frequencies_text
from bearing_sim.model.sample import OBSERVABLES, new_block
from bearing_sim.scene.loader import load_scene
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
def test_arrays_are_filled_but_for_those_of_joint_states_that_have_no_meaning(topic):
    """JointState: all arrays have the same size, or are empty where there is no such quantity."""
    message = topic.message(STAMP, Inputs(1.0, 2.0, 3.0, 390.0) if topic.name in topics.INPUTS else one_sample())
    if topic.ros_type != "sensor_msgs/msg/JointState":
        assert all(len(array) > 0 for array in arrays(message))
        return
    assert {len(message[part]) for part in ("position", "velocity", "effort")} == {0, len(message["name"])}
    filled = {"shaft_speed": ["velocity"], "bearing_joints": ["position", "velocity"]}.get(topic.name, ["position"])
    assert [part for part in ("position", "velocity", "effort") if len(message[part])] == filled
    numbers = np.concatenate([message[part] for part in filled])
    assert np.isfinite(numbers[: -len(topics.STATE_LIMITS)] if topic.name == "bearing_state" else numbers).all(), "limits are those of a scene"


def test_all_messages_with_a_header_name_the_frame_of_the_bearing():
    headers = {
        topic.name: topic.message(STAMP, one_sample())["header"]
        for topic in topics.OUTPUTS.values()
        if "header" in topic.message(STAMP, one_sample())
    }
    assert {"bearing_joints", "bearing_state", "characteristic_frequencies", "rollers"} <= headers.keys()
    assert {head["frame_id"] for head in headers.values()} == {"bearing"}
    cloud = topics.OUTPUTS["rollers"]
    (template,) = message_templates([cloud], 5, "gearbox/rear")
    assert get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(template.data, cloud.ros_type).header.frame_id == "gearbox/rear"


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


def test_a_measured_cage_comes_with_its_standard_error_where_the_message_has_a_joint_for_it():
    topic = topics.MEASUREMENTS[topics.MEASURED]
    for values, expected in (((40.0, 0.2), (40.0, 0.2)), ((40.0, math.nan), (40.0,)), ((40.0,), (40.0,))):
        message = SimpleNamespace(**topic.message(STAMP, values))
        assert topics.input_values(topics.MEASURED, topic.ros_type, message, "cage") == expected
    own = SimpleNamespace(name=["m1_cage_standard_error", "m1_cage"], velocity=[0.2, 40.0])
    assert topics.input_values(topics.MEASURED, topic.ros_type, own, "m1_cage") == (40.0, 0.2)
    assert topics.input_values("shaft_speed", topic.ros_type, own, "m1_cage") == (40.0,), "of a shaft there is none"
    with pytest.raises(ValueError, match="no velocity for the joint 'm1_cage_standard_error'"):
        topics.input_values(topics.MEASURED, topic.ros_type, SimpleNamespace(name=own.name[::-1], velocity=[40.0]), "m1_cage")


def test_a_measured_clearance_is_a_position_and_comes_with_its_standard_error_where_the_message_has_a_joint_for_it():
    topic = topics.MEASUREMENTS[topics.MEASURED_CLEARANCE]
    for values, expected in (((3e-5, 1e-6), (3e-5, 1e-6)), ((-3e-6, math.nan), (-3e-6,)), ((3e-5,), (3e-5,))):
        message = SimpleNamespace(**topic.message(STAMP, values))
        assert message.velocity.tolist() == [] and message.name[0] == "running_clearance"
        assert topics.input_values(topics.MEASURED_CLEARANCE, topic.ros_type, message, topics.CLEARANCE_JOINT) == expected
    as_velocity = SimpleNamespace(name=["running_clearance"], velocity=[3e-5], position=[])
    with pytest.raises(ValueError, match="no position for the joint 'running_clearance'"):
        topics.input_values(topics.MEASURED_CLEARANCE, topic.ros_type, as_velocity, topics.CLEARANCE_JOINT)


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
        "running, initial, fits, rotation, heat, contour, bending",
        [
            ("running_clearance", "m"),
            ("initial_clearance", "m"),
            ("fit_clearance", "m"),
            ("rotation_clearance", "m"),
            ("heat_clearance", "m"),
            ("contour_clearance", "m"),
            ("bending_clearance", "m"),
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
        "inner, outer, inner end laminae, outer end laminae",
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
        "load y, z, oil temperature, land eccentricity, inner and outer flange force, flange load, largest inner and outer roller load, "
        "arc of the seat",
        [
            ("load_y", "N"),
            ("load_z", "N"),
            ("oil_temperature", "K"),
            ("land_eccentricity", ""),
            ("inner_flange_force", "N"),
            ("outer_flange_force", "N"),
            ("flange_load", "N"),
            ("inner_load_maximum", "N"),
            ("outer_load_maximum", "N"),
            ("seat_arc", "rad"),
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
    "raceway_deflections": ("deflection", [("raceway_deflection", "m")]),
    "roller_places": ("angle, radius, rotation", [("roller_angle", "rad"), ("roller_radius", "m"), ("roller_rotation", "rad")]),
}
NUMBERS = {"cage_slip": "", "rating_life": "h", "modified_rating_life": "h", "level": "", "damage": ""}
NAMED = {
    "bearing_state": (
        "cage_slip",
        "rating_life [h]",
        "modified_rating_life [h]",
        "level",
        "damage",
        "running_clearance [m]",
        "friction_moment [N*m]",
        "slip_warning",
        "slip_error",
    ),
    "characteristic_frequencies": ("cage [Hz]", "ball_pass_outer [Hz]", "ball_pass_inner [Hz]", "roller_spin [Hz]"),
}
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
    assert {*WIRE, *NUMBERS, *NAMED, "bearing_joints", "rollers"} == {*topics.OUTPUTS, *topics.RECORDED}


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
    assert not len(joints.effort) and (joints.header.stamp.sec, joints.header.stamp.nanosec) == (1_700_000_000, 250_000_001)


def test_named_numbers_are_those_of_the_sample_and_the_limits_those_of_the_scene():
    sample = one_sample(18)
    scene = load_scene("deng2017_table1", ["thresholds.slip_warning=3%", "thresholds.slip_error=7%"])
    topic = topics.outputs(scene)["bearing_state"]
    messages = SampleMessages(message_templates([topic], 18))
    messages.fill(STAMP, sample)
    state = get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(bytes(messages.parts[0]), topic.ros_type)
    assert tuple(state.name) == NAMED["bearing_state"] and not len(state.velocity)
    found = {name.partition(" [")[0]: value for name, value in zip(state.name, state.position)}
    assert (found.pop("slip_warning"), found.pop("slip_error")) == (0.03, 0.07)
    assert found == {name: sample[name] for name in found}
    units = {observable.name: observable.unit for observable in OBSERVABLES}
    assert all(name == (f"{plain} [{units[plain]}]" if units[plain] else plain) for name, plain in zip(state.name, found))


def points_of(cloud):
    """Return the points of a sensor_msgs/PointCloud2 by the names of its fields, as its definition says and without any code of ours."""
    types = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
    order = ">" if cloud.is_bigendian else "<"
    names, offsets, formats = zip(*((field.name, field.offset, (order + types[field.datatype], (field.count,))) for field in cloud.fields))
    kind = np.dtype({"names": names, "offsets": offsets, "formats": formats, "itemsize": cloud.point_step})
    rows = np.asarray(cloud.data).reshape(cloud.height, cloud.row_step)[:, : cloud.width * cloud.point_step]
    return np.ascontiguousarray(rows).view(kind).ravel()


CLOUD = {  # by name: observable, or None where the test computes it
    "x": None,
    "y": None,
    "z": None,
    "inner_load": "inner_load",
    "outer_load": "outer_load",
    "pocket_force": "pocket_force",
    "orbital_speed": "orbital_speed",
    "spin": "roller_spin",
    "orbital_slip": None,
    "tilt": "roller_tilt",
    "skew": "roller_skew",
}


@pytest.mark.parametrize("level, lacks", [("steady", ("tilt", "skew")), ("planar", ("tilt", "skew")), ("spatial", ())])
def test_an_independent_reader_finds_every_roller_in_the_cloud_by_the_names_of_its_fields(level, lacks):
    sample = one_sample(18)
    sample["roller_angle"], sample["roller_radius"] = np.radians(20.0) * np.arange(18), 0.031
    sample["ideal_cage_speed"], sample["orbital_speed"] = 2000.0, np.linspace(1800.0, 2100.0, 18)
    topic = topics.outputs(load_scene("deng2017_table1", [f"level={level}"]))["rollers"]
    messages = SampleMessages(message_templates([topic], 18, "rear"))
    messages.fill(STAMP, sample)
    cloud = get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(bytes(messages.parts[0]), topic.ros_type)
    assert (cloud.height, cloud.width, cloud.row_step, len(cloud.data)) == (1, 18, 18 * cloud.point_step, 18 * cloud.point_step)
    assert (cloud.header.frame_id, cloud.header.stamp.sec, cloud.header.stamp.nanosec) == ("rear", 1_700_000_000, 250_000_001)
    assert [field.name for field in cloud.fields] == [name for name in CLOUD if name not in lacks]
    assert {(field.datatype, field.count) for field in cloud.fields} == {(7, 1)} and cloud.is_dense and not cloud.is_bigendian
    points = points_of(cloud)
    for name, observable in CLOUD.items():
        if observable is not None and name not in lacks:
            np.testing.assert_array_equal(points[name].ravel(), sample[observable].astype(np.float32), err_msg=name)
    np.testing.assert_allclose(np.hypot(points["y"], points["z"]).ravel(), 0.031, rtol=1e-6)
    np.testing.assert_allclose(np.arctan2(points["z"], points["y"]).ravel() % (2 * np.pi), sample["roller_angle"], atol=1e-6)
    np.testing.assert_allclose(points["orbital_slip"].ravel(), np.linspace(0.1, -0.05, 18), atol=1e-7)
    assert not points["x"].any()


def test_a_cloud_with_a_number_that_is_not_known_says_that_it_is_not_dense():
    sample = one_sample()
    sample["ideal_cage_speed"] = 0.0  # at rest slip has no meaning
    cloud = topics.OUTPUTS["rollers"]
    messages = SampleMessages(message_templates([cloud], 5))
    messages.fill(STAMP, sample)
    found = get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(bytes(messages.parts[0]), cloud.ros_type)
    points = points_of(found)
    assert not found.is_dense and np.isnan(points["orbital_slip"]).all() and all(np.isfinite(points[name]).all() for name in "xyz")
    sample["ideal_cage_speed"] = 100.0
    messages.fill(STAMP, sample)
    assert get_typestore(Stores.ROS2_JAZZY).deserialize_cdr(bytes(messages.parts[0]), cloud.ros_type).is_dense


def test_numbers_of_a_topic_that_nobody_wants_are_not_computed():
    sample = one_sample()
    chosen = [topics.OUTPUTS[name] for name in ("cage_slip", "characteristic_frequencies", "rollers")]
    messages = SampleMessages(message_templates(chosen, 5))
    before = bytes(messages.parts[2])
    messages.compute([True, True, False])
    messages.fill(0, sample)
    assert bytes(messages.parts[2]) == before and bytes(messages.parts[1]) != bytes(SampleMessages(message_templates(chosen, 5)).parts[1])


def test_documents_name_the_unit_of_every_field_of_the_cloud():
    units = {"x": "m", "y": "m", "z": "m", "orbital_slip": "", "tilt": "rad", "skew": "rad", "spin": "rad/s", "orbital_speed": "rad/s"}
    assert {field.name: field.unit for field in ROLLER_FIELDS} == {**dict.fromkeys(CLOUD, "N"), **units}
    assert all(f"{field.name} [{field.unit}]" in topics.OUTPUTS["rollers"].meaning for field in ROLLER_FIELDS if field.unit)


@pytest.mark.parametrize("rollers, diameter, pitch, shaft_turns", [(18, 7.5, 62.0, 750.0), (16, 18.0, 102.5, 25.0), (30, 34.0, 410.0, 0.2)])
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_without_slip_characteristic_frequencies_are_those_of_the_handbooks(rollers, diameter, pitch, shaft_turns, direction):
    """Contact angle 0: n/2 (1 - D/d_m), Z times it, Z n/2 (1 + D/d_m), and n d_m/(2 D) (1 - (D/d_m)^2)."""
    ratio, block = diameter / pitch, new_block(3, rollers)
    block["shaft_speed"] = direction * 2.0 * math.pi * shaft_turns
    block["cage_speed"] = 0.5 * block["shaft_speed"] * (1.0 - ratio)
    block["orbital_speed"] = block["cage_speed"][:, None]
    block["roller_spin"] = block["orbital_speed"] / ratio  # rolls on the outer ring: spin times D/2 = orbital speed times d_m/2
    handbook = [
        0.5 * shaft_turns * (1.0 - ratio),
        0.5 * rollers * shaft_turns * (1.0 - ratio),
        0.5 * rollers * shaft_turns * (1.0 + ratio),
        0.5 * shaft_turns / ratio * (1.0 - ratio**2),
    ]
    np.testing.assert_allclose(characteristic_frequencies(block), [handbook] * 3, rtol=1e-12)


def test_people_are_told_which_frequency_a_level_does_not_compute():
    known = {"cage": 312.3472, "ball_pass_outer": 5622.2, "ball_pass_inner": 7877.8, "roller_spin": 1500.0}
    assert frequencies_text(known) == "FTF 312.35, BPFO 5622.2, BPFI 7877.8, BSF 1500 Hz, with this slip"
    without = frequencies_text(known | {"roller_spin": math.nan})
    assert without == "FTF 312.35, BPFO 5622.2, BPFI 7877.8 Hz, with this slip; not BSF, which this level does not compute"
    assert "nan" not in frequencies_text(dict.fromkeys(known, math.nan))


def test_slip_lowers_the_frequencies_of_cage_and_outer_ring_and_raises_that_of_the_inner_ring():
    block = new_block(2, 18)
    block["shaft_speed"], block["cage_speed"] = 1000.0, [440.0, 396.0]  # the second with 10 % slip
    block["orbital_speed"], block["roller_spin"] = block["cage_speed"][:, None], 3600.0
    block["inner_load"][:, :3], block["roller_spin"][1, :3] = 100.0, [3500.0, 3400.0, 3300.0]
    (cage, outer, inner, spin), slipping = characteristic_frequencies(block)
    np.testing.assert_allclose(slipping[:2], [0.9 * cage, 0.9 * outer], rtol=1e-14)
    assert inner + outer == pytest.approx(18 * 1000.0 / (2 * math.pi)) == slipping[1] + slipping[2] and slipping[2] > inner
    assert (spin, slipping[3]) == pytest.approx((4040.0 / (2 * math.pi), 3796.0 / (2 * math.pi))), "of the rollers that are loaded"


def test_temperatures_and_flows_of_heat_are_published_only_for_scenes_with_a_law_of_heat():
    without, given = (topics.outputs(load_scene("deng2017_table1", overrides)) for overrides in ([], ["heat.law=given"]))
    assert given.keys() - without.keys() == {"predicted_temperatures", "heat_flows"} and without.keys() <= given.keys()
