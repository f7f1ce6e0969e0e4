# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's parameters: one table of declarations, their values on a running node, and the example file.

``python -m bearing_sim.ros.parameters > my_node.yaml`` writes all parameters with their defaults and meanings.
"""

import dataclasses
import json
import math
import re
import tomllib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.inputs.static_transforms import Transform, quaternion
from bearing_sim.messages.topics import FRAME
from bearing_sim.scene.loader import did_you_mean
from bearing_sim.scene.lubricant import Lubricant
from bearing_sim.scene.quantity import Quantity, expected
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.scene.uncertainty import declared_in, value_at


class SettingsError(ValueError):
    """Parameters that cannot be used; the message lists every error."""

    def __init__(self, errors: list[str]):
        super().__init__("\n".join([f"{len(errors)} parameter error{'s' * (len(errors) != 1)}"] + [f"  {error}" for error in errors]))


class Declaration(NamedTuple):
    """One parameter.

    Attributes
    ----------
    per_bearing : whether each bearing of a fleet may have its own value, as ``NAME.parameter``.
    running : whether a change takes effect while the node runs; otherwise it takes effect at the next configure.
    quantity : of a scene's number: a text with a unit is read as it, such as ``"200 rpm"``.
    """

    name: str
    default: object
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    choices: Sequence[str] = ()
    per_bearing: bool = False
    running: bool = False
    quantity: Quantity | None = None


_ROWS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
DECLARATIONS = tuple(Declaration(name, **row) for name, row in _ROWS.items())
"""The node's own parameters; those of the scene are `SCENE_DECLARATIONS`."""

_PORTS = ("rerun_port", "rerun_web_port")


@dataclass(frozen=True)
class BearingSettings:
    """The parameters of one bearing (see `DECLARATIONS`).

    Attributes
    ----------
    name : its name in the fleet; empty for a single bearing.
    serial : serial number of the bearing; empty for none.
    state_file : file of its state; empty for that of its serial number, if it has one.
    conditions : scene parameters that were set explicitly, by name, in SI; 0 for "none" where the scene allows none.
    """

    name: str
    scene: str
    overrides: tuple[str, ...]
    allow_outside: bool
    serial: str
    state_file: str
    joint: str
    cage_joint: str
    frame_id: str
    parent_frame: str
    frame_position: tuple[float, ...]
    frame_orientation: tuple[float, ...]
    record: str
    rrd: str
    rerun_port: int
    rerun_web_port: int
    conditions: Mapping[str, float]

    @property
    def has_view(self) -> bool:
        """Whether the bearing is shown in rerun from the start."""
        return bool(self.rrd or self.rerun_port or self.rerun_web_port)

    @property
    def frame(self) -> str:
        """The bearing's frame, in the headers of its outputs."""
        return self.frame_id or FRAME

    @property
    def transform(self) -> Transform | None:
        """The transform from the bearing's frame to its parent frame; None where it has none."""
        return Transform(self.parent_frame, self.frame, self.frame_position, quaternion(self.frame_orientation)) if self.parent_frame else None

    @property
    def scene_overrides(self) -> list[str]:
        """All scene fields to change, as `bearing_sim.scene.loader.load_scene` takes them."""
        return [*self.overrides, *(f"{name}={_written(name, scene_value(name, value))}" for name, value in self.conditions.items())]


@dataclass(frozen=True)
class NodeSettings:
    """The parameters that all bearings of the node share (see `DECLARATIONS`)."""

    input_type: str
    publish_rate: float
    sample_rate: float
    maximum_lag: float
    clock_jump_back: str
    clock_tolerance: float
    stamp_tolerance: float
    inputs_expected_within: float
    governor: bool
    record_part_size: float
    record_part_duration: float
    record_keep_free: float


def _declaration(name: str, quantity: Quantity, default: float | None) -> Declaration:
    what, *further = quantity.meaning.split("; ")
    unit = _UNIT_NAMES.get(quantity.unit, quantity.unit) or ("fraction" if quantity.shown_in else "")
    if unit:
        what += f" [{unit}]"
    if default and quantity.shown_in not in ("", unit):
        what += f" ({default:g} is {quantity.show(default)})"
    if default is None:
        further = [text.replace("None: ", "0: ") for text in further]
    if name == OIL_TEMPERATURE:
        further.append("a message on the topic oil_temperature takes precedence")
    meaning, default = "; ".join([what.replace(": None", ": 0"), *further]), default or 0.0
    return Declaration(name, default, meaning, quantity.minimum, quantity.maximum, per_bearing=True, running=True, quantity=quantity)


_UNIT_NAMES = {"delta_degC": "K"}


OIL_TEMPERATURE = "lubricant.temperature"
_SCENE_FIELDS = {OIL_TEMPERATURE: dict(declared_in("lubricant", Lubricant))[OIL_TEMPERATURE], **dict(declared_in("thresholds", Thresholds))}
_DEFAULTS = {path: value_at(Thresholds(), path.partition(".")[2]) for path in _SCENE_FIELDS}
_DEFAULTS[OIL_TEMPERATURE] = next(field.default for field in dataclasses.fields(Lubricant) if field.name == "temperature")
SCENE_DECLARATIONS = tuple(_declaration(path, quantity, _DEFAULTS[path]) for path, quantity in _SCENE_FIELDS.items())
"""Scene fields that can be changed while the scene runs, by their path; fields that are not set keep the scene's values."""
_OPTIONAL = {path for path, default in _DEFAULTS.items() if default is None}


def scene_value(name: str, parameter: float) -> float | None:
    """Return the scene's value for a scene parameter: None for 0 where the field is optional."""
    return None if name in _OPTIONAL and parameter == 0.0 else parameter


def _written(name: str, value: float | None) -> str:
    """Return a scene's value as a scene file has it, with its unit where a plain number would be refused."""
    return "null" if value is None else _SCENE_FIELDS[name].written(value)


def parameter_value(name: str, scene: Scene) -> float:
    """Return the parameter value of a scene's field; 0 for None."""
    value = value_at(scene, name)
    return 0.0 if value is None else float(value)


def scene_values_in(changes: Mapping[str, object]) -> dict[str, float | None]:
    """Return the scene's values among parameter changes, by their path in the scene."""
    return {name: scene_value(name, value) for name, value in changes.items() if name in _SCENE_FIELDS}


def checked(declaration: Declaration, name: str, value: object) -> object:
    """Return a value in the parameter's own type.

    Raises
    ------
    ValueError
        The value has another type or is out of range; the message is written for the user.
    """
    kind = type(declaration.default)
    if isinstance(value, str) and declaration.quantity is not None:
        try:
            value = declaration.quantity.read(value)
        except ValueError as error:
            raise ValueError(f"{name} = {value!r}: {error}") from None
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)  # `-p publish_rate:=50` is meant as a float
    if kind is list and declaration.default != [""]:
        return _pose_numbers(declaration, name, value)
    if kind is list:
        items = [] if value is None else value
        if isinstance(items, str) or not isinstance(items, Iterable) or not all(isinstance(item, str) for item in items):
            example = "[front, rear]" if declaration.name == "bearings" else "['level=slip']"
            raise ValueError(f"{name} = {value!r}: expected a list of strings, such as {example}; {declaration.meaning}")
        return list(items) or [""]
    if not isinstance(value, kind) or isinstance(value, bool) != (kind is bool):
        quoted = f""", such as -p {name}:="'{value}'\"""" if kind is str else ""
        raise ValueError(f"{name} = {value!r}: expected {_KINDS[kind]}{quoted}; {declaration.meaning}")
    if declaration.choices and value not in declaration.choices:
        raise ValueError(f"{name} = {value!r}: expected {' or '.join(declaration.choices)}{did_you_mean(value, declaration.choices)}")
    if kind is not str and not declaration.low <= value <= declaration.high:
        raise ValueError(f"{name} = {value:g}: outside {declaration.low:g} to {declaration.high:g}; {declaration.meaning}")
    return value


def _pose_numbers(declaration: Declaration, name: str, value: object) -> list[float]:
    """Return the numbers of a position or an orientation; raises as `checked`."""
    try:
        if isinstance(value, str) or any(isinstance(number, str) for number in value):
            raise TypeError
        numbers = [float(number) for number in value]
        if declaration.name == "frame_orientation":
            quaternion(numbers)
        elif len(numbers) != len(declaration.default) or not all(map(math.isfinite, numbers)):
            raise ValueError(f"{numbers}: expected {len(declaration.default)} finite numbers")
    except TypeError:
        raise ValueError(f"{name} = {value!r}: expected numbers, such as {declaration.default}; {declaration.meaning}") from None
    except ValueError as error:
        raise ValueError(f"{name} = {error}; {declaration.meaning}") from None
    return numbers


_KINDS = {float: "a number", int: "an integer", str: "a string", bool: "true or false"}
_CHANGES = {
    True: "can be changed while the node runs",
    False: "a change takes effect at the next configure: deactivate, clean up, set it, configure, activate",
}


def descriptor(declaration: Declaration) -> ParameterDescriptor:
    """Return the descriptor that tools show."""
    filled = ParameterDescriptor(description=f"{declaration.meaning}; {_CHANGES[declaration.running]}")
    if declaration.choices:
        filled.additional_constraints = f"one of {', '.join(declaration.choices)}"
    if declaration.quantity is not None:
        filled.additional_constraints = f"a number, or a text with a unit: {expected(declaration.quantity.unit)}"
    if isinstance(declaration.default, float):
        filled.floating_point_range = [FloatingPointRange(from_value=declaration.low, to_value=declaration.high)]
    if isinstance(declaration.default, int) and not isinstance(declaration.default, bool):
        filled.integer_range = [IntegerRange(from_value=int(declaration.low), to_value=int(declaration.high))]
    filled.type = Parameter.Type.from_parameter_value(declaration.default).value
    return filled


QOS_OVERRIDES = "qos_overrides"
"""First part of the names of parameters of the quality of service, as rclpy has it."""
_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service", QOS_OVERRIDES)
_TOPICS_OF_EVERY_NODE = ("/clock", "/parameter_events", "/rosout")
_TABLE = {row.name: row for row in (*DECLARATIONS, *SCENE_DECLARATIONS)}
_RESERVED = {name.partition(".")[0] for name in (*_TABLE, *_OF_EVERY_NODE)}


def follows_clock(node: Node) -> bool:
    """Return whether a node uses /clock (parameter ``use_sim_time``)."""
    return bool(node.get_parameter("use_sim_time").value)


class ParameterServer:
    """Declares all parameters on a node, checks changes, and passes them on.

    An unusable value is reported by `settings`, not on construction, so that a node that waits for its configure transition can
    still be given a better value.

    Parameters
    ----------
    node : a `bearing_sim.ros.node.BearingNode`, made with ``automatically_declare_parameters_from_overrides=True``: all values set from
        outside are then known by name, including misspelt ones, which are reported.  Asked for ``is_running``,
        ``reason_to_refuse(changes)`` and ``apply(changes)``.
    """

    def __init__(self, node: Node):
        self._node, self._is_own_change = node, False
        self._errors: dict[str, str] = {}
        self._known: dict[str, Declaration] = {}
        self._unchanged: set[str] = set()  # of the parameters that are being set
        given = {parameter.name: parameter.value for parameter in node.get_parameters_by_prefix("").values()}
        self._chosen = set(given)
        self._declare(_TABLE.values(), "", given)
        for name in self.bearings():
            self._declare_bearing(name, given)
        for name in given:
            if name not in self._known and not name.startswith(_OF_EVERY_NODE):
                self._warn_of_unknown(name)
        node.add_pre_set_parameters_callback(self._converted)
        node.add_on_set_parameters_callback(self._validate)
        node.add_post_set_parameters_callback(self._after_change)

    def value(self, name: str, bearing: str = "") -> object:
        """Return the value of a parameter, or a bearing's own value where it has one."""
        own = f"{bearing}.{name}"
        return self._node.get_parameter(own if bearing and own in self._chosen else name).value

    def settings(self) -> tuple[NodeSettings, list[BearingSettings]]:
        """Return the settings for a configure transition.

        Raises
        ------
        SettingsError
            Listing every parameter that cannot be used.
        """
        names = self.bearings()
        errors = [error for name, error in self._errors.items() if name in self._known] + _name_errors(names)
        if errors:
            raise SettingsError(errors)
        for name in names:
            self._declare_bearing(name, {})
        shared = NodeSettings(**{field.name: self.value(field.name) for field in dataclasses.fields(NodeSettings)})
        bearings = [self._bearing_settings(name, position) for position, name in enumerate(names or [""])]
        for row in DECLARATIONS:
            if row.per_bearing:
                self._show({f"{bearing.name}.{row.name}": getattr(bearing, row.name) for bearing in bearings if bearing.name})
        return shared, [dataclasses.replace(bearing, overrides=tuple(text for text in bearing.overrides if text.strip())) for bearing in bearings]

    def declare_further(self, rows: Sequence[Declaration]) -> dict[str, object]:
        """Declare parameters whose names are known only now, and return their values; those that nobody has set have their defaults.

        Raises
        ------
        SettingsError
            Listing every one of them that cannot be used.
        """
        is_set = [row.name for row in rows if row.name in self._chosen and self._node.has_parameter(row.name)]
        self._declare(rows, "", {name: self._node.get_parameter(name).value for name in is_set})
        if errors := [self._errors[row.name] for row in rows if row.name in self._errors]:
            raise SettingsError(list(dict.fromkeys(errors)))
        return {row.name: self._node.get_parameter(row.name).value for row in rows}

    def warn_of_unknown_topics(self) -> None:
        """Tell which parameters of the quality of service belong to no topic of the node; to be called when all are declared."""
        for name in sorted(self._chosen - self._known.keys()):
            if name.startswith(f"{QOS_OVERRIDES}.") and not name.startswith(tuple(f"{QOS_OVERRIDES}.{topic}." for topic in _TOPICS_OF_EVERY_NODE)):
                self._warn_of_unknown(name)

    def show_scene(self, bearing: str, scene: Scene) -> None:
        """Set the scene parameters of a bearing to its scene's values."""
        prefix = f"{bearing}." if bearing else ""
        self._show({f"{prefix}{row.name}": parameter_value(row.name, scene) for row in SCENE_DECLARATIONS})

    def changes_of(self, bearing: str, changes: dict[str, object]) -> dict[str, object]:
        """Return the changes that concern a bearing, by parameter names without the bearing's; its own values take precedence."""
        own = f"{bearing}." if bearing else ""
        shared = {name: value for name, value in changes.items() if name in _TABLE and (not bearing or f"{own}{name}" not in self._chosen)}
        return shared | {name.removeprefix(own): value for name, value in changes.items() if bearing and name.startswith(own)}

    def of_share(self, changes: Mapping[str, object], names: Collection[str]) -> dict[str, object]:
        """Return the changes that concern some of the bearings."""
        others = tuple(f"{name}." for name in self.bearings() if name not in names)
        return {name: value for name, value in changes.items() if not name.startswith(others)}

    def for_worker(self, bearings: Sequence[BearingSettings]) -> dict[str, object]:
        """Return the parameters of a process that hosts only some of the bearings, with the ports that they have in this node."""
        names = [settings.name for settings in bearings]
        known = {name: self._node.get_parameter(name).value for name in sorted(self._chosen) if name in self._known}
        # Ports depend on the place among all bearings.
        ports = {f"{settings.name}.{key}": getattr(settings, key) for settings in bearings for key in _PORTS}
        common = {"bearings": names, "autostart": False, "processes": 1, "use_sim_time": follows_clock(self._node)}
        return self.of_share(known, names) | ports | common

    def bearings(self) -> list[str]:
        """Return the names of the bearings; empty for one bearing without a name."""
        return [name for name in self._node.get_parameter("bearings").value if name.strip()]

    def _warn_of_unknown(self, name: str) -> None:
        self._node.get_logger().warning(f"parameter {name!r} is unknown and ignored{did_you_mean(name, self._known)}")

    def _bearing_settings(self, name: str, position: int) -> BearingSettings:
        values = {row.name: self.value(row.name, name) for row in DECLARATIONS if row.per_bearing}
        for key in ("record", "rrd", "state_file"):  # several bearings cannot share one file
            if name and values[key] and f"{name}.{key}" not in self._chosen:
                path = Path(values[key])
                values[key] = str(path.with_stem(f"{path.stem}_{name}"))
        for key in _PORTS:
            if name and values[key] and f"{name}.{key}" not in self._chosen:
                values[key] += position
        chosen = [row.name for row in SCENE_DECLARATIONS if {row.name, f"{name}.{row.name}"} & self._chosen]
        for key in ("overrides", "frame_position", "frame_orientation"):
            values[key] = tuple(values[key])
        return BearingSettings(name=name, conditions={key: self.value(key, name) for key in chosen}, **values)

    def _declare_bearing(self, name: str, given: dict) -> None:
        if not _name_errors([name]) and f"{name}.scene" not in self._known:
            self._declare([row for row in _TABLE.values() if row.per_bearing], f"{name}.", given)

    def _declare(self, rows: Iterable[Declaration], prefix: str, given: dict) -> None:
        self._is_own_change = True
        for row in rows:
            name, value = f"{prefix}{row.name}", row.default
            self._known[name] = row
            try:
                value = checked(row, name, given.get(name, row.default))
            except ValueError as error:
                self._errors[name] = str(error)
            if self._node.has_parameter(name):
                self._node.undeclare_parameter(name)
            self._node.declare_parameter(name, value, descriptor(row), ignore_override=True)
        self._is_own_change = False

    def _show(self, values: dict[str, object]) -> None:
        self._is_own_change = True
        changed = {name: value for name, value in values.items() if self._node.get_parameter(name).value != value}
        self._node.set_parameters([Parameter(name, value=list(value) if isinstance(value, tuple) else value) for name, value in changed.items()])
        self._is_own_change = False

    def _converted(self, parameters: list[Parameter]) -> list[Parameter]:
        """Convert integers and texts with a unit where floats are expected.

        Such as ``ros2 param set ... publish_rate 20``, ``... frame_position "[0, 0, 1]"``, ``... thresholds.slip_from_speed "200 rpm"``.
        """
        return list(map(self._as_declared, parameters))

    def _as_declared(self, parameter: Parameter) -> Parameter:
        row = self._known.get(parameter.name)
        if row is None or parameter.type_ is Parameter.Type.NOT_SET:
            return parameter
        try:
            return Parameter(parameter.name, value=checked(row, parameter.name, parameter.value))
        except ValueError as error:  # which `_validate` reports, unless rclpy itself has answered no more than that the type is wrong
            if row.quantity is not None and parameter.type_ is Parameter.Type.STRING:
                self._node.get_logger().warning(str(error))
            return parameter

    def _validate(self, parameters: list[Parameter]) -> SetParametersResult:
        if self._is_own_change:
            return SetParametersResult(successful=True)
        changes, self._unchanged = {}, set(filter(None, map(self._name_if_unchanged, parameters)))
        for parameter in parameters:
            row, name = self._known.get(parameter.name), parameter.name
            if name in self._unchanged:
                continue
            if name == "use_sim_time" and self._node.is_running:
                return SetParametersResult(successful=False, reason=self._needs_configure(name))
            if row is None:
                continue
            try:
                value = checked(row, name, parameter.value)
            except ValueError as error:
                return SetParametersResult(successful=False, reason=str(error))
            if row.running:
                changes[name] = value
            elif self._node.is_running:
                return SetParametersResult(successful=False, reason=self._needs_configure(name))
        reason = self._node.reason_to_refuse(changes) if changes else ""
        return SetParametersResult(successful=not reason, reason=reason)

    def _name_if_unchanged(self, parameter: Parameter) -> str:
        """Return the name of a parameter that has this value already, empty otherwise: to set it changes nothing."""
        name, now = parameter.name, self._node.get_parameter_or(parameter.name).value
        if name in self._errors or isinstance(now, bool) != isinstance(parameter.value, bool):
            return ""
        is_list = isinstance(parameter.value, Iterable) and not isinstance(parameter.value, str)
        is_same = list(now or ()) == list(parameter.value) if is_list else now == parameter.value
        return name if is_same else ""

    def _needs_configure(self, name: str) -> str:
        node = self._node.get_fully_qualified_name()
        steps = ", ".join(f"ros2 lifecycle set {node} {step}" for step in ("deactivate", "cleanup"))
        return f"{name} cannot change while the node is active, because the model is built from it: {steps}; then set it, configure and activate"

    def _after_change(self, parameters: list[Parameter]) -> None:
        if self._is_own_change:
            return
        known = {each.name: each.value for each in parameters if each.name in self._known and each.name not in self._unchanged}
        self._chosen.update(known)
        for name in known:
            self._errors.pop(name, None)
        if waiting := [name for name in known if not self._known[name].running]:
            self._node.get_logger().info(f"{', '.join(waiting)}: takes effect at the next configure")
        changes = {name: value for name, value in known.items() if self._known[name].running}
        if changes:
            self._node.apply(changes)


def _name_errors(names: list[str]) -> list[str]:
    errors = []
    for name in dict.fromkeys(names):
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            errors.append(f"bearings: {name!r} is not a valid name; use lower-case letters, digits and underscores, starting with a letter")
        elif name in _RESERVED:
            errors.append(f"bearings: {name!r} is the name of a parameter; choose another name")
        if names.count(name) > 1:
            errors.append(f"bearings: {name!r} is given {names.count(name)} times; every bearing needs its own name")
    return errors


_FILE_HEAD = """# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
# All parameters of bearing_node with their defaults: bearing_node --ros-args --params-file THIS_FILE
# Generated by python -m bearing_sim.ros.parameters. * marks parameters that can be changed while the node runs; others require reconfiguring.
# Several bearings in one node: set bearings: [front, rear] and add front: {scene: a.yaml, joint: front_shaft} and so on below it.
# The oil temperature and the thresholds given here replace those of the scene file: leave out what the scene file defines.
# They may be texts with a unit, such as '120 degC' or '200 rpm'.
"""


def parameter_file() -> str:
    """Return the text of an example file with all parameters."""
    lines = [_FILE_HEAD + "/**:", "  ros__parameters:"]
    blocks: list[str] = []
    for row in (*DECLARATIONS, *SCENE_DECLARATIONS):
        *path, name = row.name.split(".")
        shared = next((depth for depth, pair in enumerate(zip(path, blocks)) if pair[0] != pair[1]), min(len(path), len(blocks)))
        lines += [f"{'  ' * (2 + depth)}{path[depth]}:" for depth in range(shared, len(path))]
        blocks = path
        choices = f" ({', '.join(row.choices)})" if row.choices else ""
        # ROS reads a number without a decimal point as an integer.
        value = repr(row.default) if isinstance(row.default, float) else json.dumps(row.default)
        lines += [f"{'  ' * (2 + len(path))}{text}" for text in (f"# {'* ' if row.running else ''}{row.meaning}{choices}", f"{name}: {value}")]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    with standard_streams():
        print(parameter_file(), end="")
