# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Play the inputs of a recording to bearing_node, and end when either has ended: ``ros2 launch bearing_sim replay.launch.py log:=mission.mcap``."""

from launch import LaunchDescription
from launch.actions import OpaqueFunction
from launch_ros.actions import Node

from bearing_sim.ros.launching import NAME, Argument, bearing_node, declared, ends_with_node, number, value

PLAYER = (
    Argument("log", "mission.mcap", "MCAP recording with the inputs to play; bearing-sim mission -o mission.mcap writes one"),
    Argument("rate", "1.0", "playback speed relative to the recording, such as 0.1 to 20"),
    Argument(
        "clock",
        "100.0",
        "rate of /clock [Hz]; the node follows it, so that outputs do not depend on the speed; 0: no clock, wall time",
    ),
    Argument("start_paused", "false", "whether to start paused, until the service bearing_player/pause is called", ("false", "true")),
    Argument("loop", "false", "whether to start again at the end, each time with a new bearing and a new recording", ("false", "true")),
    Argument("wait_limit", "600", "time that the player waits for the node, which compiles at its first start [s]"),
    Argument("use_limit", "3600", "time that the player waits at the end until the node has computed everything [s]"),
)


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(*PLAYER, NAME), OpaqueFunction(function=_start)])


def _start(context):
    follows_clock = number(context, "clock") > 0.0
    words = [word for name in ("rate", "wait_limit") for word in (f"--{name.replace('_', '-')}", str(number(context, name)))]
    words += ["--input-type", value(context, "input_type")]
    words += ["--joint", value(context, "joint"), "--cage-joint", value(context, "cage_joint")]
    if follows_clock:
        words += ["--clock", str(number(context, "clock")), "--wait-until-used", str(number(context, "use_limit"))]
    words += [f"--{name.replace('_', '-')}" for name in ("start_paused", "loop") if value(context, name) == "true"]
    player = Node(
        package="bearing_sim",
        executable="bearing_player",
        name="bearing_player",
        namespace=value(context, "namespace"),
        arguments=[*words, value(context, "log")],
        output="screen",
        on_exit=ends_with_node("the player has ended"),
    )
    return [bearing_node(context, on_exit=ends_with_node("the node has ended"), sim_time=follows_clock), player]
