# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Start several bearings, each in its own process or all in one: ``ros2 launch bearing_sim fleet.launch.py bearings:="front=a.yaml rear=b.yaml"``."""

import re
import shlex
from pathlib import Path

from launch import LaunchDescription
from launch.actions import OpaqueFunction

from bearing_sim.ros.launching import USE_SIM_TIME, Argument, bearing_node, declared, fails_after_last, now, number, value

FLEET = (
    Argument(
        "bearings",
        "front=deng2017_table1 rear=deng2017_table2",
        "NAME=SCENE of each bearing; its topics are NAME/cage_slip and so on, its node is NAME/bearing_NAME",
    ),
    Argument(
        "one_process", "false", "true: one node, bearing_node, hosts all bearings; same topics, services NAME/reset and so on", ("true", "false")
    ),
    Argument("record_folder", "", "folder for a recording of each bearing, named after it and the start time; empty: none"),
    Argument("first_rerun_port", "0", "port on 127.0.0.1 for viewers of the first bearing; the others use the ports after it; 0: none"),
    Argument("first_rerun_web_port", "0", "port on 127.0.0.1 for browsers, likewise"),
)
SET_FOR_EACH = ("bearings", "scene", "record", "rrd", "rerun_port", "rerun_web_port")


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(*FLEET, USE_SIM_TIME, leave_out=SET_FOR_EACH), OpaqueFunction(function=_start)])


def _start(context):
    folder, start = value(context, "record_folder"), now()
    ports = {key: number(context, f"first_{key}", int) for key in ("rerun_port", "rerun_web_port")}
    own = {
        name: {
            "scene": scene,
            "record": str(Path(folder) / f"{name}_{start}.mcap") if folder else "",
            "rrd": "",
            **{key: str(first + index if first else 0) for key, first in ports.items()},
        }
        for index, (name, scene) in enumerate(_bearings(value(context, "bearings")).items())
    }
    if value(context, "one_process") == "true":
        of_each = {"scene": next(iter(own.values()))["scene"], "record": "", "rrd": "", "rerun_port": "0", "rerun_web_port": "0"}
        return [bearing_node(context, name="bearing_node", fleet=own, **of_each)]
    on_exit = fails_after_last(len(own))
    return [
        bearing_node(
            context,
            on_exit=on_exit,
            # The nodes need different names: /diagnostics is shared and identifies bearings by the name of the node.
            name=f"bearing_{name}",
            namespace="/".join(part for part in (value(context, "namespace").rstrip("/"), name) if part),
            bearings="['']",
            **texts,
        )
        for name, texts in own.items()
    ]


def _bearings(text):
    """Return scenes by the bearings' names."""
    scenes = {}
    for word in shlex.split(text):
        name, _, scene = word.partition("=")
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or not scene:
            raise RuntimeError(f"bearings: {word!r} is not NAME=SCENE, such as front=a.yaml; a NAME has lower-case letters, digits and underscores")
        if name in scenes:
            raise RuntimeError(f"bearings: {name!r} is given twice; every bearing needs its own name")
        scenes[name] = scene
    if not scenes:
        raise RuntimeError("bearings is empty: give NAME=SCENE for each bearing")
    return scenes
