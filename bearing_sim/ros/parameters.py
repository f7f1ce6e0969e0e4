# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's parameters: one table with meaning and bounds, checked all at once."""

import dataclasses
import math
from dataclasses import dataclass
from typing import NamedTuple

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.node import Node
from rclpy.parameter import Parameter

from bearing_sim.scene_file import did_you_mean


class SettingsError(ValueError):
    """Parameters that cannot be used; the message lists everything wrong with them."""


class Declaration(NamedTuple):
    """One parameter."""

    name: str
    default: object
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()


DECLARATIONS = (
    Declaration("scene", "deng2017_table1", "name of a bundled scene, or path of a scene file"),
    Declaration("overrides", [""], "scene fields to change, each FIELD=VALUE, such as bearing.outer_raceway.low_radius=34.865mm"),
    Declaration("joint", "shaft", "name of the shaft's joint in shaft_speed messages"),
    Declaration("cage_joint", "cage", "name of the cage's joint in cage_speed_measured messages"),
    Declaration(
        "input_type", "stamped", "stamped: JointState and WrenchStamped; scalar: Float64 [rad/s] and [N] along +y", choices=("stamped", "scalar")
    ),
    Declaration("publish_rate", 50.0, "rate of the output topics [Hz]", 0.1, 200.0),
    Declaration("sample_rate", 100.0, "samples recorded for each simulated second [Hz]", 1.0, 10_000.0),
    Declaration("maximum_lag", 0.2, "lag behind real time that is caught up [s]; more is given up, counted and told", 0.02, 10.0),
    Declaration("governor", True, "whether to compute at a cheaper level while the machine is too slow for the scene's"),
    Declaration("record", "", "to record from the start: an MCAP file, or a bag's folder (a name without .mcap); empty for none yet"),
    Declaration("record_part_size", 0.0, "size of a file of the recording beyond which the next one begins [MB]; 0 for none", 0.0, 1e6),
    Declaration("record_part_duration", 0.0, "time in a file of the recording beyond which the next one begins [s]; 0 for none", 0.0, 1e7),
    Declaration("record_keep_free", 100.0, "free space that the disk shall keep [MB]; below it the recording stops", 0.0, 1e7),
    Declaration("rrd", "", "rerun recording (.rrd) to write from the start; empty for none"),
    Declaration("rerun_port", 0, "port on 127.0.0.1 at which a rerun viewer can watch live; 0 for none", 0, 65535),
)
"""Every parameter of `bearing_sim.ros.node`; all are fixed at the start."""

_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service", "qos_overrides")


@dataclass(frozen=True)
class Settings:
    """The parameters' values (see `DECLARATIONS`)."""

    scene: str
    overrides: tuple[str, ...]
    joint: str
    cage_joint: str
    input_type: str
    publish_rate: float
    sample_rate: float
    maximum_lag: float
    governor: bool
    record: str
    record_part_size: float
    record_part_duration: float
    record_keep_free: float
    rrd: str
    rerun_port: int


def declare(node: Node) -> Settings:
    """Declare all parameters on a node and return their values.

    The node must have been made with ``automatically_declare_parameters_from_overrides=True``: so what was set from
    outside is known by name, a misspelt one too, and is warned of.

    Raises
    ------
    SettingsError
        Listing every parameter of a wrong type or outside its bounds.
    """
    given = {parameter.name: parameter.value for parameter in node.get_parameters_by_prefix("").values()}
    known = [declaration.name for declaration in DECLARATIONS]
    for name in given:
        if name not in known and not name.startswith(_OF_EVERY_NODE):
            node.get_logger().warning(f"parameter {name!r} is unknown and ignored{did_you_mean(name, known)}")
    values, faults = {}, []
    for declaration in DECLARATIONS:
        try:
            values[declaration.name] = _checked(declaration, given.get(declaration.name, declaration.default))
        except ValueError as fault:
            faults.append(str(fault))
    if faults:
        raise SettingsError("\n".join([f"{len(faults)} parameter fault{'s' * (len(faults) != 1)}"] + [f"  {fault}" for fault in faults]))
    for declaration in DECLARATIONS:
        if node.has_parameter(declaration.name):
            node.undeclare_parameter(declaration.name)
        node.declare_parameter(declaration.name, values[declaration.name], _descriptor(declaration), ignore_override=True)
    settings = Settings(**values)
    return dataclasses.replace(settings, overrides=tuple(text for text in settings.overrides if text.strip()))


def _checked(declaration: Declaration, value: object) -> object:
    """Return the value in the parameter's own type, or raise what the user should read."""
    kind, name = type(declaration.default), declaration.name
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)  # `-p publish_rate:=50` is meant
    if kind is list:
        if isinstance(value, str) or not all(isinstance(item, str) for item in value or []):
            raise ValueError(f"{name} = {value!r}: expected a list of texts, such as ['level=slip']")
        return list(value or [""])
    if not isinstance(value, kind) or isinstance(value, bool) != (kind is bool):
        raise ValueError(f"{name} = {value!r}: expected {_KINDS[kind]}; {declaration.meaning}")
    if declaration.choices and value not in declaration.choices:
        raise ValueError(f"{name} = {value!r}: expected {' or '.join(declaration.choices)}{did_you_mean(value, declaration.choices)}")
    if kind is not str and not declaration.low <= value <= declaration.high:
        raise ValueError(f"{name} = {value:g}: outside {declaration.low:g} to {declaration.high:g}; {declaration.meaning}")
    return value


_KINDS = {float: "a number", int: "a whole number", str: "a text", bool: "true or false"}


def _descriptor(declaration: Declaration) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(description=declaration.meaning, read_only=True)
    if declaration.choices:
        descriptor.additional_constraints = f"one of {', '.join(declaration.choices)}"
    if isinstance(declaration.default, float):
        descriptor.floating_point_range = [FloatingPointRange(from_value=declaration.low, to_value=declaration.high)]
    if isinstance(declaration.default, int) and not isinstance(declaration.default, bool):
        descriptor.integer_range = [IntegerRange(from_value=int(declaration.low), to_value=int(declaration.high))]
    descriptor.type = Parameter.Type.from_parameter_value(declaration.default).value
    return descriptor
