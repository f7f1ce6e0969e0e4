# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the launch files share: arguments made from the node's own table of parameters, and the node as launch starts it.

Only ``launch_scripts/*.launch.py`` import this: it needs launch and launch_ros of a ROS 2 installation, which pip does not have.
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

READY = b"ready: listening"  # as the node logs it once its topics and its viewers' port are open


class Argument(NamedTuple):
    """One argument of a launch file that is no parameter of the node."""

    name: str
    default: str
    meaning: str
    choices: tuple[str, ...] = ()


SHARED = (
    Argument("namespace", "", "namespace of the node and its topics"),
    Argument("parameters_file", "", "YAML file of parameters; what it says counts more than these arguments; empty for none"),
    Argument("discovery_range", "LOCALHOST", "LOCALHOST: only this machine sees the topics; SUBNET: its network does", ("LOCALHOST", "SUBNET")),
)


def declared(*arguments: Argument, leave_out: tuple[str, ...] = (), **defaults: str) -> list:
    """Return actions that declare every parameter of the node, the shared arguments and more ones.

    Parameters
    ----------
    arguments : those of one launch file alone.
    leave_out : parameters that the launch file sets by itself.
    defaults : other defaults than the node's, by the parameter's name.
    """
    parameters = [
        Argument(row.name, defaults.get(row.name, _text(row.default)), row.meaning, row.choices) for row in DECLARATIONS if row.name not in leave_out
    ]
    return [
        DeclareLaunchArgument(row.name, default_value=row.default, description=row.meaning, **({"choices": list(row.choices)} if row.choices else {}))
        for row in (*arguments, *SHARED, *parameters)
    ] + [SetEnvironmentVariable("ROS_AUTOMATIC_DISCOVERY_RANGE", LaunchConfiguration("discovery_range"))]


def now() -> str:
    """Return this moment for the name of a recording, so that no launch replaces what another has recorded."""
    return f"{datetime.now():%Y-%m-%d_%H%M%S}"


def value(context, name: str) -> str:
    """Return an argument's text."""
    return LaunchConfiguration(name).perform(context).strip()


def bearing_node(
    context,
    name: str = "bearing_node",
    namespace: str | None = None,
    on_exit=None,
    fleet: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    **texts: str,
) -> Node:
    """Return the action that starts one bearing_node, which by the node's own parameter ``autostart`` configures and activates itself.

    Parameters
    ----------
    context : of the launch.
    name : of the node.
    namespace : where it is not the argument's.
    on_exit : action when the process has ended.
    fleet : where the node hosts several: their names, and of each the parameters that are its own.
    texts : parameters that take another value than the argument of their name.
    """
    if fleet:
        texts["bearings"] = f"[{', '.join(fleet)}]"
    rows = {row.name: row for row in DECLARATIONS}
    parameters = [{row.name: _typed(row, texts.get(row.name)) for row in DECLARATIONS}]
    parameters[0] |= {f"{bearing}.{key}": _typed(rows[key], text) for bearing, own in fleet.items() for key, text in own.items()}
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
    # Without its type launch reads a text as YAML: a scene that is called 1.50 would become a number.
    kind = type(row.default)
    kind = List[type(row.default[0])] if kind is list else kind  # noqa: UP006 - launch knows typing's lists alone
    source = LaunchConfiguration(row.name) if text is None else TextSubstitution(text=text)
    return ParameterValue(source, value_type=kind)


def _text(default: object) -> str:
    if isinstance(default, bool):
        return str(default).lower()
    return str(default)
