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
        "one_process", "false", "true: one node, bearing_node, hosts all bearings; same topics, services ~/NAME/reset and so on", ("true", "false")
    ),
    Argument("serials", "", "NAME=NUMBER of each bearing whose state is kept over restarts, by its serial number; empty: none"),
    Argument("record_folder", "", "folder for a recording of each bearing, named after it and the start time; empty: none"),
    Argument("first_rerun_port", "0", "port on 127.0.0.1 for viewers of the first bearing; the others use the ports after it; 0: none"),
    Argument("first_rerun_web_port", "0", "port on 127.0.0.1 for browsers, likewise"),
)
SET_FOR_EACH = ("bearings", "scene", "record", "rrd", "rerun_port", "rerun_web_port", "serial", "state_file")


def generate_launch_description():
    """Return the launch description."""
    return LaunchDescription([*declared(*FLEET, USE_SIM_TIME, leave_out=SET_FOR_EACH), OpaqueFunction(function=_start)])


def _start(context):
    folder, start = value(context, "record_folder"), now()
    scenes = _by_name(value(context, "bearings"), "bearings", "NAME=SCENE, such as front=a.yaml")
    if not scenes:
        raise RuntimeError("bearings is empty: give NAME=SCENE for each bearing")
    serials = _by_name(value(context, "serials"), "serials", "NAME=NUMBER, such as front=A17")
    if unknown := set(serials) - set(scenes):
        raise RuntimeError(f"serials: {', '.join(sorted(unknown))}: no such bearing; bearings has {', '.join(scenes)}")
    ports = {key: number(context, f"first_{key}", int) for key in ("rerun_port", "rerun_web_port")}
    own = {
        name: {
            "scene": scene,
            "record": str(Path(folder) / f"{name}_{start}.mcap") if folder else "",
            "rrd": "",
            "serial": serials.get(name, ""),
            "state_file": "",
            **{key: str(first + index if first else 0) for key, first in ports.items()},
        }
        for index, (name, scene) in enumerate(scenes.items())
    }
    if value(context, "one_process") == "true":
        of_each = {key: "0" if key in ports else "" for key in SET_FOR_EACH if key != "bearings"}
        of_each["scene"] = next(iter(scenes.values()))
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


def _by_name(text, argument, form):
    """Return what an argument gives to each bearing, by the bearings' names."""
    given = {}
    for word in shlex.split(text):
        name, _, own = word.partition("=")
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name) or not own:
            raise RuntimeError(f"{argument}: {word!r} is not {form}; a NAME has lower-case letters, digits and underscores")
        if name in given:
            raise RuntimeError(f"{argument}: {name!r} is given twice; every bearing needs its own name")
        given[name] = own
    return given
