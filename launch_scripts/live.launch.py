# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Start bearing_node, and optionally a rerun viewer: ``ros2 launch bearing_sim live.launch.py view:=true``."""

from launch import LaunchDescription
from launch.actions import ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessIO

from bearing_sim.recording.priority import in_idle_time
from bearing_sim.ros.launching import NAME, READY, USE_SIM_TIME, Argument, bearing_node, declared, number, value
from bearing_sim.view.viewer import free_port, stream_url, viewer_command

VIEW = Argument("view", "false", "whether to open a rerun viewer, at a free port if rerun_port is 0", ("true", "false"))


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(VIEW, NAME, USE_SIM_TIME), OpaqueFunction(function=_start)])


def _start(context):
    if value(context, "view") != "true":
        return [bearing_node(context)]
    port = number(context, "rerun_port", int) or free_port()
    command = viewer_command(stream_url(port))
    if command is None:
        raise RuntimeError("view:=true needs the rerun viewer: pip install 'bearing_sim[view]'")
    node = bearing_node(context, rerun_port=str(port))
    return [_viewer_when_ready(node, command), node]


def _viewer_when_ready(node, command):
    """Return the handler that opens the viewer once the node is ready to serve it."""
    waiting = [ExecuteProcess(cmd=in_idle_time(command), output="log")]

    def open_viewer(event):
        return waiting.pop() if READY in event.text and waiting else None

    return RegisterEventHandler(OnProcessIO(target_action=node, on_stdout=open_viewer, on_stderr=open_viewer))
