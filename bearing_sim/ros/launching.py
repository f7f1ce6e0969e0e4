# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Shared by the launch files: launch arguments from the node's table of parameters, and the action that starts the node.

Imported by ``launch_scripts/*.launch.py`` only: it needs launch and launch_ros from a ROS 2 installation, which are not on PyPI.
"""

from collections.abc import Mapping
from datetime import datetime
from types import MappingProxyType
from typing import List, NamedTuple  # noqa: UP035

from launch.actions import DeclareLaunchArgument, SetEnvironmentVariable
from launch.substitutions import LaunchConfiguration, TextSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from bearing_sim.ros.parameters import DECLARATIONS, Declaration

READY = b"ready: listening"  # logged by the node once its topics and the viewer's port are open


class Argument(NamedTuple):
    """An argument of a launch file that is not a parameter of the node."""

    name: str
    default: str
    meaning: str
    choices: tuple[str, ...] = ()


SHARED = (
    Argument("namespace", "", "namespace of the node and its topics"),
    Argument("parameters_file", "", "YAML file of parameters, which override these arguments; empty: none"),
    Argument("discovery_range", "LOCALHOST", "LOCALHOST: topics are visible on this machine only; SUBNET: in its network", ("LOCALHOST", "SUBNET")),
)


def declared(*arguments: Argument, leave_out: tuple[str, ...] = (), **defaults: str) -> list:
    """Return actions that declare all parameters of the node, the shared arguments and those of one launch file.

    Parameters
    ----------
    arguments : of one launch file.
    leave_out : parameters that the launch file sets itself.
    defaults : defaults that differ from the node's, by parameter name.
    """
    parameters = [
        Argument(row.name, defaults.get(row.name, _text(row.default)), row.meaning, row.choices) for row in DECLARATIONS if row.name not in leave_out
    ]
    return [
        DeclareLaunchArgument(row.name, default_value=row.default, description=row.meaning, **({"choices": list(row.choices)} if row.choices else {}))
        for row in (*arguments, *SHARED, *parameters)
    ] + [SetEnvironmentVariable("ROS_AUTOMATIC_DISCOVERY_RANGE", LaunchConfiguration("discovery_range"))]


def now() -> str:
    """Return date and time for the name of a recording, so that no launch replaces another's recording."""
    return f"{datetime.now():%Y-%m-%d_%H%M%S}"


def value(context, name: str) -> str:
    """Return the text of an argument."""
    return LaunchConfiguration(name).perform(context).strip()


def bearing_node(
    context,
    name: str = "bearing_node",
    namespace: str | None = None,
    on_exit=None,
    fleet: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    sim_time: bool = False,
    **texts: str,
) -> Node:
    """Return the action that starts a bearing_node; the node's parameter ``autostart`` makes it configure and activate itself.

    Parameters
    ----------
    context : of the launch.
    name : of the node.
    namespace : overrides the launch argument.
    on_exit : action to take when the process has ended.
    fleet : for several bearings in the node: the parameters of each bearing, by its name.
    sim_time : whether the node follows /clock.
    texts : values that override the launch argument of the same name.
    """
    if fleet:
        texts["bearings"] = f"[{', '.join(fleet)}]"
    rows = {row.name: row for row in DECLARATIONS}
    parameters = [{row.name: _typed(row, texts.get(row.name)) for row in DECLARATIONS}]
    parameters[0] |= {f"{bearing}.{key}": _typed(rows[key], text) for bearing, own in fleet.items() for key, text in own.items()}
    if sim_time:
        parameters.append({"use_sim_time": True})
    if path := value(context, "parameters_file"):
        parameters.append(path)
    return Node(
        package="bearing_sim",
        executable="bearing_node",
        name=name,
        namespace=value(context, "namespace") if namespace is None else namespace,
        parameters=parameters,
        output="screen",
        **({"on_exit": on_exit} if on_exit else {}),
    )


def _typed(row: Declaration, text: str | None) -> ParameterValue:
    # Without a type launch parses the text as YAML: a scene named 1.50 would become a number.
    kind = type(row.default)
    kind = List[type(row.default[0])] if kind is list else kind  # noqa: UP006 - launch supports typing.List only
    source = LaunchConfiguration(row.name) if text is None else TextSubstitution(text=text)
    return ParameterValue(source, value_type=kind)


def _text(default: object) -> str:
    if isinstance(default, bool):
        return str(default).lower()
    return str(default)
