# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Play the inputs of a recording to bearing_node and end with it: ``ros2 launch bearing_sim replay.launch.py log:=mission.mcap``."""

from launch import LaunchDescription
from launch.actions import OpaqueFunction, Shutdown
from launch_ros.actions import Node

from bearing_sim.ros.launching import Argument, bearing_node, declared, value

PLAYER = (
    Argument("log", "mission.mcap", "MCAP recording whose inputs are played; bearing-sim mission -o mission.mcap writes one"),
    Argument("rate", "1.0", "how many times as fast as recorded; the model keeps to the wall clock, so other rates are another run"),
    Argument("wait_limit", "600", "how long the player waits for the node, which compiles at its first start [s]"),
)


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(*PLAYER), OpaqueFunction(function=_start)])


def _start(context):
    words = ["--rate", value(context, "rate"), "--wait-limit", value(context, "wait_limit")]
    words += ["--input-type", value(context, "input_type"), "--joint", value(context, "joint")]
    player = Node(
        package="bearing_sim",
        executable="bearing_player",
        name="bearing_player",
        namespace=value(context, "namespace"),
        arguments=[*words, value(context, "log")],
        output="screen",
        on_exit=Shutdown(reason="the player has ended"),
    )
    return [bearing_node(context, on_exit=Shutdown(reason="the node has ended")), player]
