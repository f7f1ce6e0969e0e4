# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Stands in for launch and launch_ros, which pip does not have: the few names of them that launch files here may use.

Written from their documentation. It keeps what it is given, declares arguments and performs substitutions as launch
does, and refuses what launch refuses: unknown keywords, undeclared arguments, values outside choices, parameters of a
type that it does not know.
"""

import os
import sys
import typing
from types import ModuleType

PARAMETER_TYPES = (str, int, float, bool, *(typing.List[kind] for kind in (str, int, float, bool)))  # noqa: UP006 - list[str] is refused


class LaunchContext:
    """Values of the arguments, and the environment that processes get."""

    def __init__(self, **given: str):
        self.launch_configurations, self.environment, self.is_shutdown = dict(given), {}, False


class LaunchDescription:
    """Entities in order."""

    def __init__(self, entities):
        self.entities = list(entities)


class LaunchConfiguration:
    """The value of an argument."""

    def __init__(self, variable_name):
        self.variable_name = variable_name

    def perform(self, context):
        return context.launch_configurations[self.variable_name]


class TextSubstitution:
    """A text."""

    def __init__(self, *, text):
        assert isinstance(text, str)
        self.text = text

    def perform(self, context):
        return self.text


class DeclareLaunchArgument:
    """Gives an argument its default."""

    def __init__(self, name, *, default_value, description, choices=None):
        assert choices is None or isinstance(choices, list) and all(isinstance(choice, str) for choice in choices)
        self.name, self.default_value, self.description, self.choices = name, default_value, description, choices

    def execute(self, context):
        value = context.launch_configurations.setdefault(self.name, self.default_value)
        assert self.choices is None or value in self.choices, f"{self.name}:={value} is not one of {self.choices}"


class SetEnvironmentVariable:
    """Sets a variable for the processes that follow."""

    def __init__(self, name, value):
        self.name, self.value = name, value

    def execute(self, context):
        context.environment[self.name] = self.value


class OpaqueFunction:
    """Calls a function with the context; it returns actions."""

    def __init__(self, *, function):
        self.function = function

    def execute(self, context):
        return self.function(context)


class Shutdown:
    """Ends the launch."""

    def __init__(self, *, reason=""):
        self.reason = reason


class LogInfo:
    """Says something."""

    def __init__(self, *, msg):
        self.msg = msg


class ExecuteProcess:
    """Starts a process."""

    def __init__(self, *, cmd, output="log", on_exit=None):
        assert all(isinstance(word, str) for word in cmd)
        self.cmd, self.output, self.on_exit = cmd, output, on_exit


class OnProcessIO:
    """Hears what a process prints."""

    def __init__(self, *, target_action=None, on_stdout=None, on_stderr=None):
        self.target_action, self.on_stdout, self.on_stderr = target_action, on_stdout, on_stderr


class RegisterEventHandler:
    """Makes a handler heard."""

    def __init__(self, event_handler):
        self.event_handler = event_handler


class ParameterValue:
    """A parameter's value with its type."""

    def __init__(self, value, *, value_type):
        assert value_type in PARAMETER_TYPES, f"{value_type} is no type of a parameter"
        self.value, self.value_type = value, value_type


class Node:
    """Starts a ROS node."""

    def __init__(self, *, package, executable, name=None, namespace=None, parameters=(), remappings=(), ros_arguments=(), arguments=(),
                 output="log", on_exit=None):  # fmt: skip
        assert all(isinstance(word, str) for word in (package, executable, name, namespace, *ros_arguments, *arguments))
        assert all(isinstance(name, str) for pair in remappings for name in pair) and (on_exit is None or callable(on_exit))
        self.package, self.executable, self.name, self.namespace = package, executable, name, namespace
        self.parameters, self.remappings, self.ros_arguments = list(parameters), list(remappings), list(ros_arguments)
        self.arguments, self.output, self.on_exit = list(arguments), output, on_exit


MODULES = {
    "launch": (LaunchDescription, LaunchContext),
    "launch.actions": (
        DeclareLaunchArgument,
        ExecuteProcess,
        LogInfo,
        OpaqueFunction,
        RegisterEventHandler,
        SetEnvironmentVariable,
        Shutdown,
    ),
    "launch.event_handlers": (OnProcessIO,),
    "launch.substitutions": (LaunchConfiguration, TextSubstitution),
    "launch_ros": (),
    "launch_ros.actions": (Node,),
    "launch_ros.parameter_descriptions": (ParameterValue,),
}


def install(monkeypatch) -> None:
    """Let imports of launch find the stand-in until the test ends; what imported it is forgotten then."""
    for name, members in MODULES.items():
        module = ModuleType(name)
        for member in members:
            setattr(module, member.__name__, member)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.delitem(sys.modules, "bearing_sim.ros.launching", raising=False)
    monkeypatch.setitem(os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
