# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Shared by the launch files: launch arguments from the node's table of parameters, and the action that starts the node.

Imported by ``launch_scripts/*.launch.py`` only: it needs launch and launch_ros from a ROS 2 installation, which are not on PyPI.
"""

import json
import os
import shlex
from collections.abc import Callable, Mapping
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from types import MappingProxyType
from typing import List, NamedTuple  # noqa: UP035

from launch.actions import DeclareLaunchArgument, LogInfo, OpaqueFunction, SetEnvironmentVariable, Shutdown
from launch.substitutions import LaunchConfiguration, TextSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

from bearing_sim.files.limits import FileError
from bearing_sim.files.yaml_text import values_of
from bearing_sim.ros.parameters import DECLARATIONS, SCENE_DECLARATIONS, Declaration, checked
from bearing_sim.scene.errors import did_you_mean

READY = b"ready: listening"  # logged by the node once its topics and the viewer's port are open
_DISCOVERY = ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY")  # the user's own settings


class Argument(NamedTuple):
    """An argument of a launch file that is not a parameter of the node."""

    name: str
    default: str
    meaning: str
    choices: tuple[str, ...] = ()


_FOLDER = Path(__file__).with_name("profiles")
PROFILES = ("", *sorted(path.stem for path in _FOLDER.glob("*.yaml")))
NAME = Argument("name", "bearing_node", "name of the node")
SHARED = (
    Argument("namespace", "", "namespace of the node and its topics"),
    Argument("remaps", "", "names to replace, each FROM:=TO, separated by blanks, such as 'shaft_speed:=/motor/joint_states'"),
    Argument("log_level", "info", "messages of the node that are shown: of this level and worse", ("debug", "info", "warn", "error", "fatal")),
    Argument("profile", "", "small_core: for one small core, level steady at low rates; arguments that are given count more; empty: none", PROFILES),
    Argument("parameters_file", "", "YAML file of parameters, which override these arguments; empty: none"),
    Argument(
        "discovery_range",
        "",
        "LOCALHOST: topics are visible on this machine only; SUBNET: in its network; empty: as the environment says, LOCALHOST if it says nothing",
        ("", "LOCALHOST", "SUBNET", "SYSTEM_DEFAULT", "OFF"),
    ),
)
USE_SIM_TIME = Argument("use_sim_time", "false", "whether the node follows /clock", ("true", "false"))


def declared(*arguments: Argument, leave_out: tuple[str, ...] = (), **defaults: str) -> list:
    """Return actions that declare all parameters of the node, the shared arguments and those of one launch file.

    Parameters
    ----------
    arguments : of one launch file.
    leave_out : parameters that the launch file sets itself.
    defaults : defaults that differ from the node's, by parameter name.
    """
    common = [
        *SHARED,
        *(Argument(row.name, defaults.get(row.name, _text(row.default)), row.meaning, row.choices) for row in DECLARATIONS),
        *(Argument(row.name, "", f"{row.meaning}; empty: as in the scene") for row in SCENE_DECLARATIONS),
    ]
    rows = [*arguments, *(row for row in common if row.name not in leave_out)]
    profile_first = sorted(rows, key=lambda row: row.name != "profile")

    def prepare(context) -> list:
        return [*_discovery(context), *_misspelt(context, [row.name for row in rows])]

    declarations = [
        DeclareLaunchArgument(row.name, default_value=row.default, description=row.meaning, **({"choices": list(row.choices)} if row.choices else {}))
        for row in profile_first
    ]
    return [declarations[0], OpaqueFunction(function=_take_profile), *declarations[1:], OpaqueFunction(function=prepare)]


def profile_parameters(name: str) -> dict:
    """Return the parameters of a profile, by name, from its file."""
    return values_of((_FOLDER / f"{name}.yaml").read_text())["/**"]["ros__parameters"]


def _take_profile(context) -> None:
    """Give the arguments that are not given the values of the profile; scene fields that are given come after those of the profile."""
    name = value(context, "profile")
    for parameter, of_profile in (profile_parameters(name) if name else {}).items():
        given = context.launch_configurations.get(parameter)
        if given is None or (parameter == "overrides" and not given.strip()):
            context.launch_configurations[parameter] = json.dumps(of_profile)
        elif parameter == "overrides":
            with suppress(FileError):  # which `checked` reports
                own = values_of(given)
                context.launch_configurations[parameter] = json.dumps([*of_profile, *own]) if isinstance(own, list) else given


def _discovery(context) -> list:
    chosen = value(context, "discovery_range")
    if not chosen and any(os.environ.get(name) for name in _DISCOVERY):
        return []
    return [SetEnvironmentVariable("ROS_AUTOMATIC_DISCOVERY_RANGE", chosen or "LOCALHOST")]


def _misspelt(context, names: list[str]) -> list:
    """Return warnings of arguments that resemble one of this file; launch itself would ignore them.  Others may belong to a file that includes it."""
    unknown = [name for name in context.launch_configurations if name not in names]
    hints = {name: hint for name in unknown if (hint := did_you_mean(name, names))}
    return [LogInfo(msg=f"warning: {name!r} is no argument of this launch file and is ignored{hint}") for name, hint in hints.items()]


def now() -> str:
    """Return date and time for the name of a recording, so that no launch replaces another's recording."""
    return f"{datetime.now():%Y-%m-%d_%H%M%S}"


def value(context, name: str) -> str:
    """Return the text of an argument."""
    return LaunchConfiguration(name).perform(context).strip()


def number(context, name: str, kind: type = float, low: float = 0.0):
    """Return the number that an argument gives.

    Raises
    ------
    RuntimeError
        It is no number, or below ``low``.
    """
    text = value(context, name)
    try:
        given = kind(text)
    except ValueError:
        given = None
    if given is None or not given >= low:
        raise RuntimeError(f"{name}:={text}: expected {'a whole number' if kind is int else 'a number'} of at least {low:g}")
    return given


def fails_with_node(event, context) -> None:
    """End the launch with an error if a process has ended with one; an ``on_exit`` of a node.

    Raises
    ------
    RuntimeError
        The process has ended with an error, and not because the launch ends.
    """
    if event.returncode and not context.is_shutdown:
        raise RuntimeError(f"{event.process_name} has ended with exit code {event.returncode}; its messages above say why")


def ends_with_node(reason: str) -> Callable:
    """Return an ``on_exit`` of a process that ends the launch, with an error if the process has ended with one."""

    def on_exit(event, context):
        fails_with_node(event, context)
        return None if context.is_shutdown else [Shutdown(reason=reason)]

    return on_exit


def fails_after_last(count: int) -> Callable:
    """Return the ``on_exit`` of ``count`` nodes: those that fail do not stop the others; once all have ended, the launch ends with an error."""
    ended: list[str] = []
    failed: list[str] = []

    def on_exit(event, context) -> None:
        ended.append(event.process_name)
        if event.returncode and not context.is_shutdown:
            failed.append(f"{event.process_name} (exit code {event.returncode})")
        if len(ended) == count and failed:
            raise RuntimeError(f"{len(failed)} of {count} nodes have ended with an error, their messages above say why: {', '.join(failed)}")

    return on_exit


def bearing_node(
    context,
    name: str | None = None,
    namespace: str | None = None,
    on_exit: Callable = fails_with_node,
    fleet: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
    sim_time: bool | None = None,
    **texts: str,
) -> Node:
    """Return the action that starts a bearing_node; the node's parameter ``autostart`` makes it configure and activate itself.

    Parameters
    ----------
    context : of the launch.
    name, namespace : of the node; override the launch arguments.
    on_exit : what to do when the process has ended.
    fleet : for several bearings in the node: the parameters of each bearing, by its name.
    sim_time : whether the node follows /clock; overrides the launch argument.
    texts : values that override the launch argument of the same name.

    Raises
    ------
    RuntimeError
        Arguments that cannot be used, with the form that was expected.
    """
    if fleet:
        texts["bearings"] = f"[{', '.join(fleet)}]"
    rows = {row.name: row for row in DECLARATIONS}
    parameters, errors = {}, []
    wanted = [(row.name, row, texts[row.name] if row.name in texts else value(context, row.name)) for row in DECLARATIONS]
    wanted += [(row.name, row, text) for row in SCENE_DECLARATIONS if (text := value(context, row.name))]
    wanted += [(f"{bearing}.{key}", rows[key], text) for bearing, own in fleet.items() for key, text in own.items()]
    for parameter, row, text in wanted:
        try:
            parameters[parameter] = _typed(row, parameter, text)
        except ValueError as error:
            errors.append(str(error))
    path = value(context, "parameters_file")
    if path and not Path(path).is_file():
        errors.append(f"parameters_file:={path}: no such file; expected a YAML file of parameters, seen from {Path.cwd()}")
    try:
        remappings = _remappings(value(context, "remaps"))
    except ValueError as error:
        errors.append(str(error))
    if errors:
        raise RuntimeError("; ".join(errors))
    if value(context, "use_sim_time") == "true" if sim_time is None else sim_time:
        parameters["use_sim_time"] = True
    return Node(
        package="bearing_sim",
        executable="bearing_node",
        name=value(context, "name") if name is None else name,
        namespace=value(context, "namespace") if namespace is None else namespace,
        parameters=[parameters, path] if path else [parameters],
        remappings=remappings,
        ros_arguments=["--log-level", value(context, "log_level")],
        output="screen",
        on_exit=on_exit,
    )


def _remappings(text: str) -> list[tuple[str, str]]:
    pairs = [word.partition(":=") for word in shlex.split(text)]
    for before, _, after in pairs:
        if not (before and after):
            raise ValueError(f"remaps:={text}: expected FROM:=TO, separated by blanks, such as 'shaft_speed:=/motor/joint_states'")
    return [(before, after) for before, _, after in pairs]


def _typed(row: Declaration, name: str, text: str) -> ParameterValue:
    """Return a parameter from its text; raises ValueError with the form that was expected."""
    kind, read = type(row.default), text
    if kind is not str:
        try:
            read = values_of(text) if text else row.default
        except FileError:
            read = text  # a quantity with its unit, or an error, which `checked` reports
    usable = checked(row, name, read)
    # Without a type launch parses the text as YAML: a scene named 1.50 would become a number.
    value_type = List[type(row.default[0])] if kind is list else kind  # noqa: UP006 - launch supports typing.List only
    return ParameterValue(TextSubstitution(text=usable if kind is str else json.dumps(usable)), value_type=value_type)


def _text(default: object) -> str:
    if isinstance(default, bool):
        return str(default).lower()
    return str(default)
