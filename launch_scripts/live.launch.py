# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Start bearing_node, and optionally a rerun viewer: ``ros2 launch bearing_sim live.launch.py view:=true``."""

import shutil
import sys
from pathlib import Path

from launch import LaunchDescription
from launch.actions import ExecuteProcess, OpaqueFunction, RegisterEventHandler
from launch.event_handlers import OnProcessIO

from bearing_sim.recording.priority import in_idle_time
from bearing_sim.ros.launching import READY, Argument, bearing_node, declared, value

VIEW = Argument("view", "false", "whether to open a rerun viewer, on port 9876 if rerun_port is 0", ("true", "false"))


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(VIEW), OpaqueFunction(function=_start)])


def _start(context):
    if value(context, "view") != "true":
        return [bearing_node(context)]
    port = value(context, "rerun_port")
    port = "9876" if port == "0" else port
    node = bearing_node(context, rerun_port=port)
    return [_viewer_when_ready(node, port), node]


def _viewer_when_ready(node, port):
    """Return the handler that opens the viewer once the node is ready to serve it."""
    viewer = ExecuteProcess(cmd=in_idle_time([_rerun(), f"rerun+http://127.0.0.1:{port}/proxy"]), output="log")
    waiting = [viewer]

    def open_viewer(event):
        return waiting.pop() if READY in event.text and waiting else None

    return RegisterEventHandler(OnProcessIO(target_action=node, on_stdout=open_viewer, on_stderr=open_viewer))


def _rerun():
    beside = Path(sys.executable).with_name("rerun")
    found = str(beside) if beside.is_file() else shutil.which("rerun")
    if found is None:
        raise RuntimeError("view:=true needs the rerun viewer: pip install rerun-sdk==0.41.0")
    return found
