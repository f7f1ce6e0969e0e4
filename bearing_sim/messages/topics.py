# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Topics: the ROS messages of inputs, samples and events, and the numbers that an input message holds.

One table serves recordings and the node; it needs no ROS.  A message is a nested dict of field to value: a dict for a
message, a list for a sequence of messages or strings, a float64 array for a sequence of numbers, float, int, str, and bytes of
length one for a ``byte``.

An array of a JointState that has no meaning is empty, as the definition of that message asks.  rclpy's ``serialize_message`` pads messages
with empty arrays, which strict readers reject: recordings and outputs are serialised by `bearing_sim.messages.cdr`, as the wire has them.

Names are relative; a recording writes them with a leading slash.
"""

import math
import tomllib
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np

from bearing_sim.messages.bands import BANDS, ESTIMATES, Bands
from bearing_sim.messages.point_cloud import ROLLER_FIELDS, RollerField, point_cloud, roller_fields, roller_points
from bearing_sim.model.characteristic_frequencies import FREQUENCIES, characteristic_frequencies
from bearing_sim.model.loads import largest_loads  # noqa: F401 - for rooms that show samples and import messages only
from bearing_sim.model.sample import OBSERVABLES, RING_TEMPERATURES
from bearing_sim.model.turning import SLIP_FROM_SPEED, turns  # noqa: F401 - likewise

SHAFT_JOINT, CAGE_JOINT, CLEARANCE_JOINT = "shaft", "cage", "running_clearance"
FRAME = "bearing"  # unless the bearing has another frame; x along the shaft
ZERO_CELSIUS = 273.15  # [K]
TEMPERATURES = ("oil_temperature", *RING_TEMPERATURES)
"""The input channels that carry a temperature."""

REPEATING_RATE = 50.0
"""Messages a second, in simulated time, that a recording has at most of a topic that only repeats others: the rate at which the node publishes."""


class Computed(NamedTuple):
    """Numbers of messages that are computed from samples.

    Attributes
    ----------
    field : of the message, where the first of them stands.
    numbers : ``numbers(samples) -> array`` of shape (n, numbers), of the type that the message has, for samples of shape (n,).
    """

    field: str
    numbers: Callable[[np.ndarray], np.ndarray]


class Topic(NamedTuple):
    """One topic.

    Attributes
    ----------
    name : relative topic name.
    ros_type : ``package/msg/Type``.
    meaning : what it carries, with units.
    message : ``message(stamp_ns, source) -> dict``, where ``source`` is a `bearing_sim.simulation.Inputs` for an input
        topic and one sample (see `bearing_sim.model.sample`) for an output topic.
    observables : of an output topic, by field of its message: the observables whose numbers stand there one after the other,
        exactly as in the sample.
    of_tilting_levels : whether levels without tilts and slices omit it.
    of_heat : whether scenes without a law of heat omit it.
    of_bending : whether scenes with a rigid outer ring omit it.
    computed : of an output topic, numbers that are not observables themselves.
    of_scene : returns the topic of a scene, where its messages depend on the scene.
    repeats : whether its numbers follow from those of the other topics: a recording has it for `REPEATING_RATE` samples a second at most, and
        reading the recording back does not need it.
    """

    name: str
    ros_type: str
    meaning: str
    message: Callable[[int, Any], dict]
    observables: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    of_tilting_levels: bool = False
    of_heat: bool = False
    of_bending: bool = False
    computed: Computed | None = None
    of_scene: Callable[[Any], "Topic"] | None = None
    repeats: bool = False


def stamp(stamp_ns: int) -> dict:
    """Return builtin_interfaces/Time of nanoseconds since the epoch."""
    seconds, nanoseconds = divmod(int(stamp_ns), 1_000_000_000)
    return {"sec": seconds, "nanosec": nanoseconds}


class Origin(NamedTuple):
    """Stamp [ns since the epoch] and frame in the header of an input message; the stamp is None for a message without one."""

    stamp_ns: int | None
    frame_id: str


class Names(NamedTuple):
    """What a run is called in the messages of its recording; as in the ROS graph where a node records it.

    Attributes
    ----------
    topics : full names of topics by their own, where they differ from ``/NAME``.
    component, hardware_id : of the statuses of diagnostics (see `bearing_sim.messages.diagnostics.report`); the bearing's name where empty.
    """

    topics: Mapping[str, str]
    component: str
    hardware_id: str


OWN_NAMES = Names({}, "bearing_sim", "")
"""Those of a run without a node."""


def header(stamp_ns: int, frame_id: str = "") -> dict:
    """Return std_msgs/Header."""
    return {"stamp": stamp(stamp_ns), "frame_id": frame_id}


def transforms(stamp_ns: int, poses: Iterable[tuple[str, str, Iterable[float], Iterable[float]]]) -> dict:
    """Return tf2_msgs/TFMessage of (parent, child, position x, y, z [m], orientation quaternion x, y, z, w)."""

    def stamped(parent: str, child: str, position: Iterable[float], orientation: Iterable[float]) -> dict:
        pose = {"translation": dict(zip("xyz", position)), "rotation": dict(zip("xyzw", orientation))}
        return {"header": header(stamp_ns, parent), "child_frame_id": child, "transform": pose}

    return {"transforms": [stamped(*pose) for pose in poses]}


def _joints(stamp_ns: int, names: list[str], position: Iterable[float] = (), velocity: Iterable[float] = ()) -> dict:
    """Return sensor_msgs/JointState; an array that has no meaning is empty, as that of the torques always is."""
    return {
        "header": header(stamp_ns, FRAME),
        "name": names,
        "position": np.array(list(position), float),
        "velocity": np.array(list(velocity), float),
        "effort": np.zeros(0),
    }


def _shaft_speed(stamp_ns: int, inputs) -> dict:
    return _joints(stamp_ns, [SHAFT_JOINT], velocity=[inputs.shaft_speed])  # the angle is unknown


def _radial_load(stamp_ns: int, inputs) -> dict:
    force = {"x": 0.0, "y": float(inputs.load_y), "z": float(inputs.load_z)}
    return {"header": header(stamp_ns, FRAME), "wrench": {"force": force, "torque": {"x": 0.0, "y": 0.0, "z": 0.0}}}


def _temperature(name: str, meaning: str, of_heat: bool = False) -> Topic:
    """Return the topic of an input that is a temperature."""

    def message(stamp_ns: int, inputs) -> dict:
        return {"header": header(stamp_ns, FRAME), "temperature": float(getattr(inputs, name)) - ZERO_CELSIUS, "variance": 0.0}

    return Topic(name, "sensor_msgs/msg/Temperature", meaning, message, of_heat=of_heat)


def standard_error_joint(joint: str) -> str:
    """Return the name of the joint whose number is the standard error of that of another joint."""
    return f"{joint}_standard_error"


def _cage_speed(stamp_ns: int, values: Sequence[float]) -> dict:
    names, numbers = _with_standard_error(CAGE_JOINT, values)
    return _joints(stamp_ns, names, velocity=numbers)


def _running_clearance(stamp_ns: int, values: Sequence[float]) -> dict:
    names, numbers = _with_standard_error(CLEARANCE_JOINT, values)
    return _joints(stamp_ns, names, position=numbers)


def _with_standard_error(joint: str, values: Sequence[float]) -> tuple[list[str], list[float]]:
    """Return joints and numbers of a measurement (value,) or (value, standard error); without the latter where it is NaN."""
    value, *errors = values
    known = [error for error in errors if not math.isnan(error)]
    return [joint, *[standard_error_joint(joint)] * len(known)], [value, *known]


def _number(name: str, meaning: str) -> Topic:
    """Return the topic of an observable that is one number."""
    return Topic(name, "std_msgs/msg/Float64", meaning, lambda stamp_ns, sample: {"data": float(sample[name])}, {"data": (name,)})


JOINTS = {
    SHAFT_JOINT: ("shaft_angle", "shaft_speed"),
    CAGE_JOINT: ("cage_angle", "cage_speed"),
    "cage_ideal": ("ideal_cage_angle", "ideal_cage_speed"),
}
"""Angle and speed of each joint of ``bearing_joints``, by its name."""


def _bearing_joints(stamp_ns: int, sample) -> dict:
    angles, speeds = zip(*JOINTS.values())
    return _joints(stamp_ns, list(JOINTS), [sample[name] for name in angles], [sample[name] for name in speeds])


_UNITS = {observable.name: observable.unit for observable in OBSERVABLES}
STATE_NUMBERS = ("cage_slip", "rating_life", "modified_rating_life", "level", "damage", "running_clearance", "friction_moment")
"""The observables of topic ``bearing_state``, in order."""
STATE_LIMITS = ("slip_warning", "slip_error")
"""The thresholds that follow them, as the scene has them."""


def name_with_unit(name: str, unit: str) -> str:
    """Return the name of a number with its unit behind it, which a number without a dimension has not."""
    return f"{name} [{unit}]" if unit else name


STATE_NAMES = tuple(name_with_unit(name, _UNITS[name]) for name in STATE_NUMBERS) + STATE_LIMITS
"""The names in messages of topic ``bearing_state``, in order."""
FREQUENCY_NAMES = tuple(name_with_unit(frequency.name, "Hz") for frequency in FREQUENCIES)
"""The names in messages of topic ``characteristic_frequencies``, in order."""


def _bearing_state(limits: tuple[float, ...]) -> Topic:
    """Return the topic of stamped and named numbers, with `STATE_LIMITS` at the end."""

    def message(stamp_ns: int, sample) -> dict:
        return _joints(stamp_ns, list(STATE_NAMES), [*(sample[name] for name in STATE_NUMBERS), *limits])

    return Topic(
        "bearing_state",
        "sensor_msgs/msg/JointState",
        "numbers of the bearing with a stamp, by name and unit, in position: " + ", ".join(STATE_NAMES),
        message,
        {"position": STATE_NUMBERS},
        of_scene=lambda scene: _bearing_state(tuple(getattr(scene.thresholds, name) for name in STATE_LIMITS)),
        repeats=True,
    )


def _characteristic_frequencies(stamp_ns: int, sample) -> dict:
    return _joints(stamp_ns, list(FREQUENCY_NAMES), characteristic_frequencies(_as_block(sample))[0])


def _rollers(fields: tuple[RollerField, ...]) -> Topic:
    """Return the topic of the cloud of rollers with these fields."""
    units = ", ".join(name_with_unit(field.name, field.unit) for field in ROLLER_FIELDS)
    return Topic(
        "rollers",
        "sensor_msgs/msg/PointCloud2",
        f"one point for each roller, in the bearing's frame: {units}; tilt and skew at level spatial",
        lambda stamp_ns, sample: point_cloud(header(stamp_ns, FRAME), fields, _as_block(sample)),
        computed=Computed("data", lambda samples: roller_points(fields, samples)),
        of_scene=lambda scene: _rollers(roller_fields(scene.bodies_tilt)),
        repeats=True,
    )


def _as_block(sample) -> np.ndarray:
    """Return a sample as a block of one."""
    return np.frombuffer(sample, sample.dtype)


class ArrayRows(NamedTuple):
    """The rows of a std_msgs/Float64MultiArray: observables one after the other, each one number or one for each roller.

    New rows, and their words in the label, are appended, so that recordings of earlier versions can be read.

    Attributes
    ----------
    label : of the array's first dimension; names its rows in order.
    fields : the observable of each row.
    """

    label: str
    fields: tuple[str, ...]


_ARRAYS = tomllib.loads(Path(__file__).with_name("arrays.toml").read_text("utf-8"))
ARRAYS = {name: ArrayRows(entry["label"], tuple(entry["rows"])) for name, entry in _ARRAYS.items()}
"""The topics of samples that carry arrays, by name, from ``arrays.toml``; a second dimension ``roller`` where rows have a number for each roller."""

LIFE_SYMBOLS = dict(zip(ARRAYS["rating_lives"].fields, ARRAYS["rating_lives"].label.split(", ")))
"""The standards' symbols of rating lives, by observable."""


def _arrays(only_recorded: bool) -> dict[str, Topic]:
    """Return the topics of arrays by name, in their order: those of recordings alone, or the others."""
    chosen = {name: entry for name, entry in _ARRAYS.items() if entry.get("only_recorded", False) == only_recorded}
    return {name: _array(name, entry) for name, entry in chosen.items()}


def _array(name: str, entry: Mapping[str, Any]) -> Topic:
    """Return the topic of an array."""
    label, fields = ARRAYS[name]

    def message(stamp_ns: int, sample) -> dict:
        data = np.array([sample[field] for field in fields], float)
        dim = [{"label": label, "size": len(fields), "stride": data.size}]
        if data.ndim == 2:
            dim.append({"label": "roller", "size": data.shape[1], "stride": data.shape[1]})
        return {"layout": {"dim": dim, "data_offset": 0}, "data": data.ravel()}

    flags = {flag: entry.get(flag, False) for flag in ("of_tilting_levels", "of_heat", "of_bending")}
    return Topic(name, "std_msgs/msg/Float64MultiArray", entry["meaning"], message, {"data": fields}, **flags)


INPUTS = {
    topic.name: topic
    for topic in (
        Topic("shaft_speed", "sensor_msgs/msg/JointState", "velocity of the joint 'shaft' [rad/s]", _shaft_speed),
        Topic("radial_load", "geometry_msgs/msg/WrenchStamped", "force.y, force.z on the inner ring in the bearing frame [N]", _radial_load),
        _temperature("oil_temperature", "optional: oil temperature [degC]"),
        _temperature("inner_ring_temperature", "optional: measured temperature of the inner ring [degC]; without a law of heat it is not read", True),
        _temperature("outer_ring_temperature", "optional: measured temperature of the outer ring [degC]; without a law of heat it is not read", True),
    )
}
"""The input topics by channel (`bearing_sim.inputs.gate` uses the same channel names)."""
ALWAYS_KNOWN = tuple(name for name in INPUTS if name not in RING_TEMPERATURES)
"""The input channels that have a value at every instant of a run."""

VIBRATION = Topic(
    "vibration",
    "std_msgs/msg/Float64MultiArray",
    "where the scene asks for `vibration.window`: a block of samples of an accelerometer, in any unit; `layout.dim` has an entry with the label "
    "`rate` and the sampling rate [Hz] as size, and may have one with the label `sequence` and the number of the block, by which lost ones are "
    "noticed",
    lambda stamp_ns, samples: {"layout": {"dim": [], "data_offset": 0}, "data": samples},
)
"""The topic from which a live run finds the cage speed (see `bearing_sim.watchers.vibration.meter`); recordings have the cage speed, not the
blocks."""

MEASURED, RESIDUAL, MEASURED_CLEARANCE = "cage_speed_measured", "cage_slip_residual", "running_clearance_measured"
MEASURED_CHANNELS = (MEASURED, MEASURED_CLEARANCE)
"""The input channels of what the model predicts: each has a value and, where it is known, the standard error of that."""
MEASUREMENTS = {
    topic.name: topic
    for topic in (
        Topic(
            MEASURED,
            "sensor_msgs/msg/JointState",
            "optional: measured velocity of the joint 'cage' [rad/s]; where a joint 'cage_standard_error' follows, its velocity is the standard "
            "error of the measurement [rad/s]",
            _cage_speed,
        ),
        Topic(
            RESIDUAL,
            "std_msgs/msg/Float64",
            "measured less predicted cage slip [fraction]",
            lambda stamp_ns, residual: {"data": residual},
        ),
        Topic(
            MEASURED_CLEARANCE,
            "sensor_msgs/msg/JointState",
            "optional: measured diametral clearance of the running bearing, position of the joint 'running_clearance' [m], negative is preload; "
            "where a joint 'running_clearance_standard_error' follows, its position is the standard error of the measurement [m]",
            _running_clearance,
        ),
    )
}
"""Topics of what the model predicts and somebody measures, by name: measured cage, difference from the prediction, measured clearance.

The source of a measurement is ``(value,)`` or ``(value, standard error)``, NaN where that is not known; of the difference, one number.
"""


def _quantities_with_bands(stamp_ns: int, bands: Bands) -> dict:
    return _joints(stamp_ns, list(bands.message_names), bands.numbers[0].ravel())


ESTIMATED = {
    topic.name: topic
    for topic in (
        Topic(
            BANDS,
            "sensor_msgs/msg/JointState",
            "where the scene asks for `estimation.bands`: cage slip [fraction], rating life [h], running clearance [m] and remaining life [h], each "
            "with its 5 and 95 % quantiles, by name and unit, in position",
            _quantities_with_bands,
        ),
        Topic(
            ESTIMATES,
            "sensor_msgs/msg/JointState",
            "where the scene names fields in `estimation.calibrated`: the value of each in its SI unit with its 5 and 95 % quantiles, by name and "
            "unit, in position",
            _quantities_with_bands,
        ),
    )
}
"""Topics of estimates by name; the source of each message is a `bearing_sim.messages.bands.Bands` of one instant."""

OUTPUTS = {
    topic.name: topic
    for topic in (
        _number("cage_slip", "cage slip [fraction]; NaN at rest"),
        _number("rating_life", "basic rating life at the present condition by the method of the scene [h]; infinite at rest"),
        _number("modified_rating_life", "the same with reliability and oil [h]; damage counts it"),
        _number("level", "level that computed the sample: 0 steady, 1 slip, 2 planar, 3 spatial"),
        _number("damage", "fraction of life used since the start"),
        Topic(
            "bearing_joints",
            "sensor_msgs/msg/JointState",
            "shaft, cage, cage_ideal: angle [rad], speed [rad/s]; effort is empty",
            _bearing_joints,
            {"position": tuple(angle for angle, _ in JOINTS.values()), "velocity": tuple(speed for _, speed in JOINTS.values())},
        ),
        _bearing_state((math.nan,) * len(STATE_LIMITS)),
        Topic(
            "characteristic_frequencies",
            "sensor_msgs/msg/JointState",
            f"frequencies with the predicted slip [Hz], by name in position: {', '.join(FREQUENCY_NAMES)}",
            _characteristic_frequencies,
            computed=Computed("position", characteristic_frequencies),
            repeats=True,
        ),
        _rollers(ROLLER_FIELDS),
    )
} | _arrays(only_recorded=False)
"""The output topics by name; a level has those of `outputs`."""


RECORDED = _arrays(only_recorded=True)
"""Topics of recordings alone: with them and `OUTPUTS` a recording holds every observable of `bearing_sim.model.sample`."""


def recorded(scene) -> dict[str, Topic]:
    """Return the topics that hold all observables of a scene's level, by name, in the order in which a recording has them."""
    return {**_of_scene(RECORDED, scene), **outputs(scene)}


def outputs(scene) -> dict[str, Topic]:
    """Return the output topics that a scene has, by name."""
    return _of_scene(OUTPUTS, scene)


def estimated(scene) -> dict[str, Topic]:
    """Return the topics of estimates that a scene asks for, by name."""
    asked = {BANDS: scene.estimation.bands, ESTIMATES: bool(scene.estimation.calibrated)}
    return {name: topic for name, topic in ESTIMATED.items() if asked[name]}


def inputs(scene) -> dict[str, Topic]:
    """Return the input topics that a scene uses, by channel."""
    return _of_scene(INPUTS, scene)


def _of_scene(table: Mapping[str, Topic], scene) -> dict[str, Topic]:
    absent = [topic.name for topic in table.values() if topic.of_tilting_levels and not scene.bodies_tilt]
    absent += [topic.name for topic in table.values() if topic.of_heat and not scene.uses_ring_temperatures]
    absent += [topic.name for topic in table.values() if topic.of_bending and not scene.outer_ring_bends]
    return {name: topic if topic.of_scene is None else topic.of_scene(scene) for name, topic in table.items() if name not in absent}


_MOST_LISTED = 10  # joints in a message
DIAGNOSTICS = ("diagnostics", "diagnostic_msgs/msg/DiagnosticArray")
"""Name and type of the topic of `bearing_sim.messages.diagnostics`."""


def input_types(channel: str) -> tuple[str, ...]:
    """Return the message types that can carry a channel."""
    if channel in MEASURED_CHANNELS:
        return (MEASUREMENTS[channel].ros_type,)
    scalar = ("std_msgs/msg/Float64",) if channel not in TEMPERATURES else ()
    return (INPUTS[channel].ros_type, *scalar)


def joint_numbers(channel: str) -> str:
    """Return the field of a JointState that has the numbers of a channel."""
    return "position" if channel == MEASURED_CLEARANCE else "velocity"


def input_values(channel: str, ros_type: str, message, joint: str = SHAFT_JOINT) -> tuple[float, ...]:
    """Return the numbers of an input message in SI, as `bearing_sim.inputs.gate.InputGate.offer` takes them.

    Parameters
    ----------
    channel : ``"shaft_speed"`` -> (speed,), ``"radial_load"`` -> (force_y, force_z), a temperature -> (kelvin,),
        ``"cage_speed_measured"`` -> (speed,), or (speed, standard error) where the message has a joint for it (`standard_error_joint`);
        ``"running_clearance_measured"`` likewise.
    ros_type : one of `input_types`; a scalar load gives (force,), a magnitude along +y.
    message : any object with the fields of that type as attributes.
    joint : name of the joint in a JointState: of the shaft, the cage or the clearance.

    Raises
    ------
    ValueError
        The type does not fit the channel, or the message does not hold the joint's number.
    """
    if ros_type not in input_types(channel):
        raise ValueError(f"{ros_type} cannot carry {channel}; expected {' or '.join(input_types(channel))}")
    if ros_type == "std_msgs/msg/Float64":
        return (float(message.data),)
    if channel in TEMPERATURES:
        return (float(message.temperature) + ZERO_CELSIUS,)
    if channel == "radial_load":
        return (float(message.wrench.force.y), float(message.wrench.force.z))
    names = list(message.name)
    if joint not in names:
        there = [repr(name[:80]) for name in names[:_MOST_LISTED]] + ["..."] * (len(names) > _MOST_LISTED)
        raise ValueError(f"no joint {joint!r} in the message; it has {', '.join(there) or 'none'}")
    wanted = [joint]
    if channel in MEASURED_CHANNELS and standard_error_joint(joint) in names:
        wanted.append(standard_error_joint(joint))
    places, field = [names.index(name) for name in wanted], joint_numbers(channel)
    numbers = getattr(message, field)
    if max(places) >= len(numbers):
        lacking = wanted[places.index(max(places))]
        counted = "velocities" if field == "velocity" else "positions"
        raise ValueError(f"the message has no {field} for the joint {lacking!r} ({len(numbers)} {counted} for {len(names)} joints)")
    return tuple(float(numbers[place]) for place in places)


def header_stamp_ns(message) -> int | None:
    """Return the header's stamp [ns since the epoch], or None for a message without one (or with stamp zero, which means unset)."""
    stamped = getattr(message, "header", None)
    if stamped is None:
        return None
    time = stamped.stamp
    # Jazzy calls the field nanosec; ROS 1 style bindings say nsec.
    nanoseconds = int(time.sec) * 1_000_000_000 + int(time.nanosec if hasattr(time, "nanosec") else time.nsec)
    return nanoseconds or None


def frame_of(message) -> str:
    """Return the frame in the header of a message; ``""`` for a message without a header."""
    stamped = getattr(message, "header", None)
    return "" if stamped is None else str(stamped.frame_id)
