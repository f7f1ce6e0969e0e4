# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The node's parameters at work: declared, checked, refused with a reason, and read for the next configure."""

import dataclasses
import re
from collections.abc import Iterable
from pathlib import Path
from typing import Protocol

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter

from bearing_sim.ros.parameters import (
    DECLARATIONS,
    SCENE_DECLARATIONS,
    BearingSettings,
    Declaration,
    NodeSettings,
    SettingsError,
    checked,
    descriptor,
    parameter_value,
)
from bearing_sim.scene import Scene
from bearing_sim.scene_file import did_you_mean

_OF_EVERY_NODE = ("use_sim_time", "start_type_description_service", "qos_overrides")
_TABLE = {row.name: row for row in (*DECLARATIONS, *SCENE_DECLARATIONS)}
_RESERVED = {name.partition(".")[0] for name in (*_TABLE, *_OF_EVERY_NODE)}


class Owner(Protocol):
    """Who runs by the parameters."""

    @property
    def is_running(self) -> bool:
        """Whether what needs a re-configure cannot be changed now."""
        ...

    def objection(self, changes: dict[str, object]) -> str:
        """Return why changes of parameters that can be changed while the node runs cannot be made; empty where they can."""
        ...

    def apply(self, changes: dict[str, object]) -> None:
        """Make such changes."""
        ...


class ParameterServer:
    """Declares every parameter on a node and keeps watch over them.

    The node must have been made with ``automatically_declare_parameters_from_overrides=True``: so what was set from
    outside is known by name, a misspelt one too, and is warned of.  A value that cannot be used is told by `read`, not
    here: a node that waits for its configure can still be given a better one.
    """

    def __init__(self, node: Node, owner: Owner):
        self._node, self._owner, self._own_change = node, owner, False
        self._faults: dict[str, str] = {}
        self._known: dict[str, Declaration] = {}
        given = {parameter.name: parameter.value for parameter in node.get_parameters_by_prefix("").values()}
        self._chosen = set(given)
        self._declare(_TABLE.values(), "", given)
        for name in self._names():
            self._declare_bearing(name, given)
        for name in given:
            if name not in self._known and not name.startswith(_OF_EVERY_NODE):
                node.get_logger().warning(f"parameter {name!r} is unknown and ignored{did_you_mean(name, self._known)}")
        node.add_pre_set_parameters_callback(self._in_own_types)
        node.add_on_set_parameters_callback(self._judge)
        node.add_post_set_parameters_callback(self._take)

    def value(self, name: str, bearing: str = "") -> object:
        """Return the value of a parameter, for a bearing its own where it has one."""
        own = f"{bearing}.{name}"
        return self._node.get_parameter(own if bearing and own in self._chosen else name).value

    def read(self) -> tuple[NodeSettings, list[BearingSettings]]:
        """Return what a configure goes by.

        Raises
        ------
        SettingsError
            Listing every parameter that cannot be used.
        """
        names = self._names()
        faults = [fault for name, fault in self._faults.items() if name in self._known] + _name_faults(names)
        if faults:
            raise SettingsError(faults)
        for name in names:
            self._declare_bearing(name, {})
        shared = NodeSettings(**{field.name: self.value(field.name) for field in dataclasses.fields(NodeSettings)})
        bearings = [self._of_bearing(name, place) for place, name in enumerate(names or [""])]
        for row in DECLARATIONS:
            if row.per_bearing:
                self._show({f"{bearing.name}.{row.name}": getattr(bearing, row.name) for bearing in bearings if bearing.name})
        return shared, [dataclasses.replace(bearing, overrides=tuple(text for text in bearing.overrides if text.strip())) for bearing in bearings]

    def show_scene(self, bearing: str, scene: Scene) -> None:
        """Let the parameters of the scene show what a bearing's scene says."""
        prefix = f"{bearing}." if bearing else ""
        self._show({f"{prefix}{row.name}": parameter_value(row.name, scene) for row in SCENE_DECLARATIONS})

    def changes_of(self, bearing: str, changes: dict[str, object]) -> dict[str, object]:
        """Return those changes that concern a bearing, by the parameter's name without the bearing's; what it has of its own counts more."""
        own = f"{bearing}." if bearing else ""
        shared = {name: value for name, value in changes.items() if name in _TABLE and (not bearing or f"{own}{name}" not in self._chosen)}
        return shared | {name.removeprefix(own): value for name, value in changes.items() if bearing and name.startswith(own)}

    def _names(self) -> list[str]:
        return [name for name in self._node.get_parameter("bearings").value if name.strip()]

    def _of_bearing(self, name: str, place: int) -> BearingSettings:
        values = {row.name: self.value(row.name, name) for row in DECLARATIONS if row.per_bearing}
        for key in ("record", "rrd"):  # one path for all would be one file for all
            if name and values[key] and f"{name}.{key}" not in self._chosen:
                path = Path(values[key])
                values[key] = str(path.with_stem(f"{path.stem}_{name}"))
        if name and values["rerun_port"] and f"{name}.rerun_port" not in self._chosen:
            values["rerun_port"] += place
        chosen = [row.name for row in SCENE_DECLARATIONS if {row.name, f"{name}.{row.name}"} & self._chosen]
        values["overrides"] = tuple(values["overrides"])
        return BearingSettings(name=name, conditions={key: self.value(key, name) for key in chosen}, **values)

    def _declare_bearing(self, name: str, given: dict) -> None:
        if not _name_faults([name]) and f"{name}.scene" not in self._known:
            self._declare([row for row in _TABLE.values() if row.per_bearing], f"{name}.", given)

    def _declare(self, rows: Iterable[Declaration], prefix: str, given: dict) -> None:
        self._own_change = True
        for row in rows:
            name, value = f"{prefix}{row.name}", row.default
            self._known[name] = row
            try:
                value = checked(row, name, given.get(name, row.default))
            except ValueError as fault:
                self._faults[name] = str(fault)
            if self._node.has_parameter(name):
                self._node.undeclare_parameter(name)
            self._node.declare_parameter(name, value, descriptor(row), ignore_override=True)
        self._own_change = False

    def _show(self, values: dict[str, object]) -> None:
        self._own_change = True
        changed = {name: value for name, value in values.items() if self._node.get_parameter(name).value != value}
        self._node.set_parameters([Parameter(name, value=list(value) if isinstance(value, tuple) else value) for name, value in changed.items()])
        self._own_change = False

    def _in_own_types(self, parameters: list[Parameter]) -> list[Parameter]:
        """Take a whole number where a number is wanted: ``ros2 param set ... publish_rate 20`` is meant."""
        return [
            Parameter(parameter.name, value=float(parameter.value))
            if parameter.type_ is Parameter.Type.INTEGER and isinstance(getattr(self._known.get(parameter.name), "default", None), float)
            else parameter
            for parameter in parameters
        ]

    def _judge(self, parameters: list[Parameter]) -> SetParametersResult:
        if self._own_change:
            return SetParametersResult(successful=True)
        changes = {}
        for parameter in parameters:
            row, name = self._known.get(parameter.name), parameter.name
            if row is None:
                continue
            try:
                value = checked(row, name, parameter.value)
            except ValueError as fault:
                return SetParametersResult(successful=False, reason=str(fault))
            if row.running:
                changes[name] = value
            elif self._owner.is_running and value != self._node.get_parameter(name).value:
                return SetParametersResult(successful=False, reason=self._needs_configure(name))
        objection = self._owner.objection(changes) if changes else ""
        return SetParametersResult(successful=not objection, reason=objection)

    def _needs_configure(self, name: str) -> str:
        node = self._node.get_fully_qualified_name()
        steps = ", ".join(f"ros2 lifecycle set {node} {step}" for step in ("deactivate", "cleanup"))
        return f"{name} cannot change while the node is active, for the model is built from it: {steps}; then set it, configure and activate"

    def _take(self, parameters: list[Parameter]) -> None:
        if self._own_change:
            return
        known = {parameter.name: parameter.value for parameter in parameters if parameter.name in self._known}
        self._chosen.update(known)
        for name in known:
            self._faults.pop(name, None)
        if waiting := [name for name in known if not self._known[name].running]:
            self._node.get_logger().info(f"{', '.join(waiting)}: taken at the next configure")
        changes = {name: value for name, value in known.items() if self._known[name].running}
        if changes:
            self._owner.apply(changes)


def _name_faults(names: list[str]) -> list[str]:
    faults = []
    for name in dict.fromkeys(names):
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            faults.append(f"bearings: {name!r} is no name; expected small letters, digits and underscores, beginning with a letter")
        elif name in _RESERVED:
            faults.append(f"bearings: {name!r} is the name of a parameter; choose another")
        if names.count(name) > 1:
            faults.append(f"bearings: {name!r} stands {names.count(name)} times; every bearing needs a name of its own")
    return faults
