# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Start bearing_node and record from the start: ``ros2 launch bearing_sim record.launch.py record:=run.mcap``."""

from launch import LaunchDescription
from launch.actions import LogInfo, OpaqueFunction

from bearing_sim.ros.launching import NAME, USE_SIM_TIME, bearing_node, declared, now, value


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(NAME, USE_SIM_TIME, record=f"recordings/{now()}.mcap"), OpaqueFunction(function=_start)])


def _start(context):
    record = value(context, "record")
    if not record:
        raise RuntimeError("record is empty: give the MCAP file to write, or use live.launch.py to run without a recording")
    return [LogInfo(msg=f"recording to {record}; press Ctrl-C to end the launch and complete the recording"), bearing_node(context)]
