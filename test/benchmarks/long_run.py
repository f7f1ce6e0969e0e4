# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a node for a day of simulated time and watch what it holds: ``python test/benchmarks/long_run.py``.

This process publishes speed, load and /clock, `--rate` times as fast as time passes, and never runs further ahead of what the node has published
than `_AHEAD`.  Each simulated quarter of an hour it notes what the node's process holds: memory, threads, open files, and the bytes of the state
file and its neighbours.  The table shows every hour; below it stands the drift of each, a straight line through the last three quarters of the
run, in units per day.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import click
import numpy as np
import rclpy
from measure import DOMAINS, START_LIMIT, end, log_tail
from rosgraph_msgs.msg import Clock

from bearing_sim.cli.reporting import print_rows
from bearing_sim.messages import topics
from bearing_sim.ros.messages import message, message_class
from bearing_sim.ros.qos import STATE_QOS
from bearing_sim.simulation import Inputs

_AHEAD = 4.0  # [s] of wall time, at the rate, between the clock and the newest output
_START_NS = 1_800_000_000_000_000_000
_PERIOD = 900.0  # [s] of simulated time between looks
_STUCK = 60.0  # [s] of wall time without an output
_MIB = 2.0**20


class Look(NamedTuple):
    """What the node holds at an instant."""

    hours: float  # simulated
    memory: float  # resident [MiB]
    threads: int
    handles: int
    state_files: int
    state_bytes: int


class Feed:
    """Publishes inputs and the clock and notes how far the outputs have come."""

    def __init__(self, frequency: float, speed: float, load: float):
        self._node = rclpy.create_node("long_run", start_parameter_services=False, enable_rosout=False)
        self._period, self._speed, self._load = 1.0 / frequency, speed, load
        self._publishers = {
            name: self._node.create_publisher(message_class(topics.INPUTS[name].ros_type), name, STATE_QOS) for name in ("shaft_speed", "radial_load")
        }
        self._clock = self._node.create_publisher(Clock, "/clock", STATE_QOS)
        joints = topics.OUTPUTS["bearing_joints"].ros_type
        self._joints = self._node.create_subscription(message_class(joints), "bearing_joints", lambda _: None, 1000)
        self._reports = self._node.create_subscription(message_class(topics.DIAGNOSTICS[1]), f"/{topics.DIAGNOSTICS[0]}", lambda _: None, 100)
        self.time, self.heard, self.outputs, self.report = 0.0, -math.inf, 0, None

    @property
    def is_matched(self) -> bool:
        """Whether the node listens to all inputs."""
        return all(publisher.get_subscription_count() for publisher in (*self._publishers.values(), self._clock))

    def advance(self) -> None:
        """Publish the next instant: two inputs and the clock."""
        self.time += self._period
        stamp_ns = _START_NS + round(self.time * 1e9)
        day = 2.0 * math.pi * self.time / 86400.0
        speed = 0.0 if self.time % 7200.0 < 300.0 else self._speed * (1.0 + 0.25 * math.sin(11.0 * day))  # it stands for five minutes every two hours
        inputs = Inputs(speed, self._load * (1.0 + 0.4 * math.cos(7.0 * day)), 0.05 * self._load * math.sin(5.0 * day), math.nan)
        for name, publisher in self._publishers.items():
            topic = topics.INPUTS[name]
            publisher.publish(message(topic.ros_type, topic.message(stamp_ns, inputs)))
        clock = Clock()
        clock.clock.sec, clock.clock.nanosec = divmod(stamp_ns, 1_000_000_000)
        self._clock.publish(clock)
        self.hear()

    def hear(self) -> None:
        """Take what has arrived."""
        for subscription in (self._joints, self._reports):
            with subscription.handle:
                while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
                    if subscription is self._reports:
                        self.report = taken[0]
                        continue
                    stamp = taken[0].header.stamp
                    self.heard = (stamp.sec * 1_000_000_000 + stamp.nanosec - _START_NS) * 1e-9
                    self.outputs += 1


def look(pid: int, hours: float, folder: Path) -> Look:
    """Return what a process holds, and the size of the files in a folder."""
    process = Path(f"/proc/{pid}")
    memory = int((process / "statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / _MIB
    sizes = [file.stat().st_size for file in folder.rglob("*") if file.is_file()]
    return Look(hours, memory, len(list((process / "task").iterdir())), len(list((process / "fd").iterdir())), len(sizes), sum(sizes))


def drift(looks: list[Look]) -> dict[str, float]:
    """Return the slope of each quantity over the last three quarters of the run [units per simulated day]."""
    kept = [each for each in looks if each.hours >= looks[-1].hours / 4.0]
    days = np.array([each.hours for each in kept]) / 24.0
    return {name: float(np.polyfit(days, [getattr(each, name) for each in kept], 1)[0]) for name in Look._fields[1:]}


def watched(feed: Feed, pid: int, hours: float, rate: float, folder: Path, log: Callable[[], str]) -> tuple[list[Look], float]:
    """Feed a node for some simulated hours; return what it held, and the rate that was reached."""
    looks, began, progress, progressed = [], time.monotonic(), -math.inf, time.monotonic()
    while feed.time < hours * 3600.0:
        ahead = feed.time - (time.monotonic() - began) * rate
        if ahead > 0.0:
            time.sleep(ahead / rate)
        if feed.heard > progress:
            progress, progressed = feed.heard, time.monotonic()
        if feed.time - max(feed.heard, 0.0) > _AHEAD * rate:  # the node is behind: let it come
            if time.monotonic() - progressed > _STUCK:
                raise click.ClickException(f"no output for {_STUCK:.0f} s at {feed.time:.0f} s; {log()}")
            time.sleep(0.002)
            feed.hear()
            continue
        feed.advance()
        if feed.time >= len(looks) * _PERIOD:
            looks.append(look(pid, feed.time / 3600.0, folder))
            print(looks[-1], file=sys.stderr, flush=True)
    return looks, feed.time / (time.monotonic() - began)


def run(hours: float, rate: float, feed_of: Callable[[], Feed], parameters: dict[str, str]) -> tuple[list[Look], float, int]:
    """Run a node under sim time and return what it held, the rate that was reached, and the number of outputs."""
    environment = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_DOMAIN_ID": str(random.choice(DOMAINS))}
    os.environ.update(environment)
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryFile() as log:
        state = Path(folder) / "state"
        state.mkdir()
        parameters = {"use_sim_time": "true", "publish_rate": "5.0", "sample_rate": "5.0", **parameters}
        if "state_file" in parameters:
            parameters["state_file"] = str(state / parameters["state_file"])
        words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
        node = subprocess.Popen(
            [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", *words], stdout=log, stderr=subprocess.STDOUT, cwd=folder
        )
        try:
            rclpy.init()
            feed = feed_of()
            deadline = time.monotonic() + START_LIMIT
            while not feed.is_matched:
                if node.poll() is not None or time.monotonic() > deadline:
                    raise click.ClickException(f"the node does not listen; {log_tail(log)}")
                time.sleep(0.05)
            looks, reached = watched(feed, node.pid, hours, rate, state, lambda: log_tail(log))
        finally:
            end(node)
            rclpy.try_shutdown()
        print(log_tail(log), file=sys.stderr)
        if node.returncode:
            raise click.ClickException(f"the node ended with code {node.returncode}")
        return looks, reached, feed.outputs


@click.command()
@click.option("--hours", default=24.0, show_default=True, help="Simulated time.")
@click.option("--rate", default=200.0, show_default=True, help="Simulated over wall time.")
@click.option("--frequency", default=2.0, show_default=True, help="Inputs and readings of the clock per simulated second.")
@click.option("--speed", default=2000.0, show_default=True, help="Mean speed of the shaft [rad/s].")
@click.option("--load", default=800.0, show_default=True, help="Mean radial load [N].")
@click.option("--parameter", "-p", multiple=True, help="A parameter of the node, NAME:=VALUE; state_file is taken below a folder of its own.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def main(hours: float, rate: float, frequency: float, speed: float, load: float, parameter: tuple[str, ...], as_json: bool) -> None:
    """Watch a node for a day of simulated time."""
    parameters = {"scene": "deng2017_table1", "overrides": "[level=steady]"} | dict(each.split(":=", 1) for each in parameter)
    looks, reached, outputs = run(hours, rate, lambda: Feed(frequency, speed, load), parameters)
    drifts = drift(looks)
    if as_json:
        print(json.dumps({"rate": reached, "outputs": outputs, "looks": [each._asdict() for each in looks], "drift_per_day": drifts}))
        return
    names = ("hours", "memory [MiB]", "threads", "handles", "state files", "state [byte]")
    shown = [each for each in looks if abs(each.hours - round(each.hours)) < 1e-3]
    print_rows("What the node holds", names, [(f"{each.hours:.2f}", f"{each.memory:.1f}", *map(str, each[2:])) for each in shown])
    print(f"{looks[-1].hours:.1f} h simulated {reached:.0f} times as fast as time passes, {outputs} outputs")
    print("drift per day: " + ", ".join(f"{name} {value:.3g}" for name, value in zip(names[1:], drifts.values())))


if __name__ == "__main__":
    main()
