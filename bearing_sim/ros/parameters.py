# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What parameters the node has: one table with meaning, bounds and when a change counts; the scene's own are made from its declarations."""

import dataclasses
import math
import types
import typing
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import NamedTuple

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.parameter import Parameter

from bearing_sim.quantity import Quantity
from bearing_sim.scene import Lubricant, Scene, Thresholds
from bearing_sim.scene_file import did_you_mean


class SettingsError(ValueError):
    """Parameters that cannot be used; the message lists everything wrong with them."""

    def __init__(self, faults: list[str]):
        super().__init__("\n".join([f"{len(faults)} parameter fault{'s' * (len(faults) != 1)}"] + [f"  {fault}" for fault in faults]))


class Declaration(NamedTuple):
    """One parameter.

    Attributes
    ----------
    per_bearing : whether each bearing of a fleet may have its own, as ``NAME.parameter``.
    running : whether a change counts at once while the node runs; else it waits for the next configure.
    """

    name: str
    default: object
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    choices: tuple[str, ...] = ()
    per_bearing: bool = False
    running: bool = False


DECLARATIONS = (
    Declaration("autostart", True, "whether the node configures and activates itself; false: it waits for its lifecycle services"),
    Declaration("bearings", [""], "names of several bearings, each with NAME.scene and its topics below NAME/; empty for one without a name"),
    Declaration("scene", "deng2017_table1", "name of a bundled scene, or path of a scene file", per_bearing=True),
    Declaration(
        "overrides",
        [""],
        "scene fields to change, each FIELD=VALUE, such as bearing.outer_raceway.low_radius=34.865mm",
        per_bearing=True,
    ),
    Declaration("joint", "shaft", "name of the shaft's joint in shaft_speed messages", per_bearing=True),
    Declaration("cage_joint", "cage", "name of the cage's joint in cage_speed_measured messages", per_bearing=True),
    Declaration("frame_id", "bearing", "frame that radial_load messages must be in; one without a frame is taken; empty: any is", per_bearing=True),
    Declaration(
        "input_type", "stamped", "stamped: JointState and WrenchStamped; scalar: Float64 [rad/s] and [N] along +y", choices=("stamped", "scalar")
    ),
    Declaration("publish_rate", 50.0, "rate of the output topics [Hz]", 0.1, 200.0, running=True),
    Declaration("sample_rate", 100.0, "samples recorded for each simulated second [Hz]", 1.0, 10_000.0),
    Declaration(
        "clock_jump_back",
        "reset",
        "with use_sim_time, what a /clock that jumps back does: reset: state and damage begin anew there; error: the last state is held",
        choices=("reset", "error"),
    ),
    Declaration("maximum_lag", 0.2, "lag behind real time that is caught up [s]; more is given up, counted and told", 0.02, 10.0),
    Declaration("governor", True, "whether to compute at a cheaper level while the machine is too slow for the scene's", running=True),
    Declaration(
        "record", "", "MCAP file, or bag's folder (no .mcap), to record from the start; empty for none until ~/start_recording", per_bearing=True
    ),
    Declaration("record_part_size", 0.0, "size of a recording's file beyond which the next one begins [MB]; 0 for none", 0.0, 1e6),
    Declaration("record_part_duration", 0.0, "time in a recording's file beyond which the next one begins [s]; 0 for none", 0.0, 1e7),
    Declaration("record_keep_free", 100.0, "free space that the disk shall keep [MB]; below it recording stops", 0.0, 1e7),
    Declaration("rrd", "", "rerun recording (.rrd) to write from the start; empty for none", per_bearing=True),
    Declaration("rerun_port", 0, "port on 127.0.0.1 at which a rerun viewer can watch live; 0 for none", 0, 65535, per_bearing=True),
)
"""The node's own parameters; those of the scene are `SCENE_DECLARATIONS`."""


@dataclass(frozen=True)
class BearingSettings:
    """The parameters of one bearing (see `DECLARATIONS`).

    Attributes
    ----------
    name : its name in the fleet; empty where it is alone.
    conditions : scene parameters that somebody has set, by name, in SI; 0 for "none" where the scene allows none.
    """

    name: str
    scene: str
    overrides: tuple[str, ...]
    joint: str
    cage_joint: str
    frame_id: str
    record: str
    rrd: str
    rerun_port: int
    conditions: Mapping[str, float]

    @property
    def scene_overrides(self) -> list[str]:
        """All fields of the scene to change, as `bearing_sim.scene_file.load_scene` takes them."""
        return [*self.overrides, *(f"{name}={scene_value(name, value)!r}".replace("=None", "=null") for name, value in self.conditions.items())]


@dataclass(frozen=True)
class NodeSettings:
    """The parameters that all bearings of the node share (see `DECLARATIONS`)."""

    input_type: str
    publish_rate: float
    sample_rate: float
    maximum_lag: float
    clock_jump_back: str
    governor: bool
    record_part_size: float
    record_part_duration: float
    record_keep_free: float


def _declarations_of(record: type, path: str, default: object) -> Iterator[tuple[Declaration, bool]]:
    """Yield the declaration of each quantity of a record and the records inside it, and whether it may be none."""
    hints = typing.get_type_hints(record, include_extras=True)
    for field in dataclasses.fields(record):
        hint, value = hints[field.name], getattr(default, field.name, None)
        if dataclasses.is_dataclass(hint):
            yield from _declarations_of(hint, f"{path}.{field.name}", value)
            continue
        optional = isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union
        annotated = typing.get_args(hint)[0] if optional else hint
        for quantity in getattr(annotated, "__metadata__", ()):
            if isinstance(quantity, Quantity):
                yield _declaration(f"{path}.{field.name}", quantity, value, optional), optional


def _declaration(name: str, quantity: Quantity, default: float | None, optional: bool) -> Declaration:
    shown, unit = quantity.shown_in or quantity.unit, quantity.unit or ("fraction" if quantity.shown_in else "")
    meaning = f"{quantity.meaning} [{unit}]" if unit else quantity.meaning
    if shown not in ("", quantity.unit):
        meaning += f", {quantity.show(quantity.minimum)} to {quantity.show(quantity.maximum)}"
    if optional:
        meaning = meaning.replace("None: none is", "0: none is")
    return Declaration(name, 0.0 if default is None else default, meaning, quantity.minimum, quantity.maximum, per_bearing=True, running=True)


OIL_TEMPERATURE = "lubricant.temperature"
_OF_SCENE = [
    *((row, optional) for row, optional in _declarations_of(Lubricant, "lubricant", None) if row.name == OIL_TEMPERATURE),
    *_declarations_of(Thresholds, "thresholds", Thresholds()),
]
_temperature = next(field.default for field in dataclasses.fields(Lubricant) if field.name == "temperature")
SCENE_DECLARATIONS = tuple(
    row._replace(default=_temperature, meaning=f"{row.meaning}; once a message has come on the topic oil_temperature, that counts instead")
    if row.name == OIL_TEMPERATURE
    else row
    for row, _ in _OF_SCENE
)
"""Fields of the scene that can be changed while it runs, by their place in it; where nobody sets them the scene's own values hold."""
_MAY_BE_NONE = {row.name for row, optional in _OF_SCENE if optional}


def scene_value(name: str, parameter: float) -> float | None:
    """Return what a scene parameter's value is in the scene, where a field without a limit holds None."""
    return None if name in _MAY_BE_NONE and parameter == 0.0 else parameter


def parameter_value(name: str, scene: Scene) -> float:
    """Return the value that a scene parameter has in a scene; 0 for none."""
    value = reduce(getattr, name.split("."), scene)
    return 0.0 if value is None else float(value)


def checked(declaration: Declaration, name: str, value: object) -> object:
    """Return a value in the parameter's own type, or raise ValueError with what the user should read."""
    kind = type(declaration.default)
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
_CHANGES = {
    True: "can be changed while the node runs",
    False: "a change needs a re-configure: deactivate, cleanup, set it, configure, activate",
}


def descriptor(declaration: Declaration) -> ParameterDescriptor:
    """Return what tools show of a parameter."""
    filled = ParameterDescriptor(description=f"{declaration.meaning}; {_CHANGES[declaration.running]}")
    if declaration.choices:
        filled.additional_constraints = f"one of {', '.join(declaration.choices)}"
    if isinstance(declaration.default, float):
        filled.floating_point_range = [FloatingPointRange(from_value=declaration.low, to_value=declaration.high)]
    if isinstance(declaration.default, int) and not isinstance(declaration.default, bool):
        filled.integer_range = [IntegerRange(from_value=int(declaration.low), to_value=int(declaration.high))]
    filled.type = Parameter.Type.from_parameter_value(declaration.default).value
    return filled
