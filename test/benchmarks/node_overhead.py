# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measure a running bearing_node from outside: ``python test/benchmarks/node_overhead.py``.

Two processes communicate over DDS on the loopback interface: the node, and this one, which publishes speed and load and subscribes to the
outputs.  Each speed differs from the previous one by a millionth, so that an output identifies the input it reflects; the shaft's angle shows how
much time was simulated, independently of what the node reports.

How to read it: **latency** is the age, on arrival, of the newest input that an output reflects.  The node publishes at its own ticks; inputs at
exactly the same rate would all have the age of whatever phase the start happened to give.  Inputs are therefore sent at `DETUNING` of the
rate: every phase occurs equally often within a second or two, and the median does not depend on the start.  **CPU without solver** is the node's
overhead: everything but the thread that integrates.
"""

import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import IO, NamedTuple

import click
from measure import DOMAINS, START_LIMIT, Cost, cost_of, end, log_tail, taken

from bearing_sim.cli.reporting import print_rows

_SETTLING = 10.0  # [s] after which memory should not grow
_STEP = 1e-6  # relative difference between successive speeds
_DISTINCT = 1000  # number of different speeds; an output is never that late
ALL = "all"
DETUNING = 0.97  # input rate over output rate


class Received(NamedTuple):
    """A bearing_joints message."""

    arrival: float  # monotonic [s]
    speed: float  # of the shaft [rad/s]
    angle: float  # of the shaft [rad]


class Driver:
    """Publishes inputs at a rate and takes outputs, without an executor, whose cost would disturb the measurement.

    Parameters
    ----------
    speed : of the shaft [rad/s].
    load : [N].
    subscribed : names of the output topics to subscribe to, in addition to bearing_joints.
    """

    def __init__(self, speed: float, load: float, subscribed: list[str]):
        import rclpy
        from rclpy.qos import qos_profile_sensor_data

        from bearing_sim.messages import topics
        from bearing_sim.ros.messages import message, message_class
        from bearing_sim.simulation import Inputs

        self._node = rclpy.create_node("bearing_measure", start_parameter_services=False, enable_rosout=False)
        self._speed, self._message, self._topics = speed, message, topics
        self._inputs = Inputs(shaft_speed=speed, load_y=load, load_z=0.0, oil_temperature=393.15)
        self._publishers = {
            name: self._node.create_publisher(message_class(topics.INPUTS[name].ros_type), name, qos_profile_sensor_data)
            for name in ("shaft_speed", "radial_load")
        }
        self._joints = self._node.create_subscription(
            message_class(topics.OUTPUTS["bearing_joints"].ros_type), "bearing_joints", lambda _: None, 1000
        )
        self._others = [
            self._node.create_subscription(message_class(topics.OUTPUTS[name].ros_type), name, lambda _: None, 1000) for name in subscribed
        ]
        self._reports = self._node.create_subscription(message_class(topics.DIAGNOSTICS[1]), f"/{topics.DIAGNOSTICS[0]}", lambda _: None, 100)
        self.sent: list[float] = []
        self.received: list[Received] = []
        self.values: dict[str, str] = {}

    def close(self) -> None:
        """Destroy the node."""
        self._node.destroy_node()

    @property
    def is_matched(self) -> bool:
        """Whether the node subscribes to all inputs."""
        return all(publisher.get_subscription_count() for publisher in self._publishers.values())

    def send(self) -> None:
        """Publish both inputs now."""
        place = len(self.sent) % _DISTINCT
        inputs = self._inputs._replace(shaft_speed=self._speed * (1.0 + _STEP * place))
        stamp_ns = self._node.get_clock().now().nanoseconds
        for name, publisher in self._publishers.items():
            topic = self._topics.INPUTS[name]
            filled = self._message(topic.ros_type, topic.message(stamp_ns, inputs))
            if name == "shaft_speed":
                self.sent.append(time.monotonic())
            publisher.publish(filled)

    def receive(self) -> None:
        """Receive all messages that have arrived."""
        for joints, _ in taken(self._joints, serialised=False):
            self.received.append(Received(time.monotonic(), joints.velocity[0], joints.position[0]))
        for report, _ in taken(self._reports, serialised=False):
            self.values = {pair.key: pair.value for pair in report.status[0].values}
        for subscription in self._others:
            for _ in taken(subscription):
                pass

    def drive(self, seconds: float, rate: float) -> None:
        """Publish at a rate [Hz] and take outputs, for a while."""
        start = due = time.monotonic()
        while (now := time.monotonic()) < start + seconds:
            if now >= due:
                self.send()
                due = max(due + 1.0 / rate, now - 1.0 / rate)
            self.receive()
            time.sleep(min(1e-3, max(0.0, due - time.monotonic())))

    def latencies(self, since: float) -> list[float]:
        """Return the age, on arrival, of the input that each output after an instant reflects [s]."""
        found = []
        for output in self.received:
            place = round((output.speed / self._speed - 1.0) / _STEP) % _DISTINCT
            sent = [self.sent[k] for k in range(place, len(self.sent), _DISTINCT) if self.sent[k] <= output.arrival]
            if output.arrival >= since and sent:
                found.append(output.arrival - sent[-1])
        return found


def measure(level: str, speed_rpm: float, duration: float, rate: float, listen: str = ALL, record: bool = False) -> dict:
    """Measure a node and return its figures.

    Parameters
    ----------
    level : level of the model; bearing deng2017_table1 at 800 N.
    speed_rpm : shaft speed [rpm].
    duration : of the measurement after the start [s], longer than the first ten seconds.
    rate : of the node's output topics [Hz]; inputs are sent at `DETUNING` times this rate.
    listen : output topics with a reliable subscriber, separated by commas, or `ALL`; bearing_joints always has one.
    record : whether the node records to a temporary file.

    Raises
    ------
    ValueError
        An unknown topic.
    RuntimeError
        The node does not start, or ends early; with its last log lines.
    """
    from bearing_sim.messages import topics
    from bearing_sim.scene.loader import load_scene

    overrides = [f"level={level}", f"operating.shaft_speed={speed_rpm} rpm"]
    names = _subscribed_topics(listen, list(topics.outputs(load_scene("deng2017_table1", overrides))))
    words = {"overrides": str(overrides), "publish_rate": str(float(rate)), "governor": "false"}
    with tempfile.TemporaryFile() as log, tempfile.TemporaryDirectory(prefix="bearing_sim_measure_") as folder:
        recording = Path(folder) / "run.mcap"
        if record:
            words["record"] = str(recording)
        parameters = [word for key, value in words.items() for word in ("-p", f"{key}:={value}")]
        command = [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", *parameters]
        node = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        driver = Driver(speed_rpm * math.pi / 30, 800.0, names)
        try:
            _wait_until_running(driver, node, log)
            driver.drive(2.0, DETUNING * rate)
            began, first = time.monotonic(), cost_of(node.pid)
            driver.drive(min(_SETTLING, duration / 2), DETUNING * rate)
            settled = cost_of(node.pid)
            driver.drive(duration - (time.monotonic() - began), DETUNING * rate)
            if node.poll() is not None:
                raise RuntimeError(f"the node ended during the measurement; {log_tail(log)}")
            ended, last = time.monotonic(), cost_of(node.pid)
        finally:
            driver.close()
            ending = end(node)
        recorded = recording.stat().st_size if recording.exists() else 0
    found = _figures(driver, began, ended, rate) | _costs(first, settled, last, ended - began)
    asked = {"level": level, "speed_rpm": speed_rpm, "rate_hz": rate, "input_rate_hz": DETUNING * rate, "topics_subscribed": len(names) + 1}
    return {**asked, "exit_code": node.returncode, "ending_s": ending, "recorded_mb": recorded / 1e6, **found}


def _subscribed_topics(listen: str, known: list[str]) -> list[str]:
    wanted = known if listen == ALL else [name.strip() for name in listen.split(",")]
    if unknown := sorted(set(wanted) - set(known)):
        raise ValueError(f"unknown output topic {', '.join(map(repr, unknown))}; the topics are {', '.join(known)}, or {ALL!r}")
    return [name for name in known if name in wanted and name != "bearing_joints"]


def _wait_until_running(driver: Driver, node: subprocess.Popen, log: IO[bytes]) -> None:
    end = time.monotonic() + START_LIMIT
    while not (driver.is_matched and driver.received):
        if node.poll() is not None or time.monotonic() > end:
            raise RuntimeError(f"the node did not start; {log_tail(log)}")
        if driver.is_matched:
            driver.send()
        driver.receive()
        time.sleep(0.02)


def _figures(driver: Driver, began: float, ended: float, rate: float) -> dict:
    outputs = [message for message in driver.received if message.arrival >= began]
    span = outputs[-1].arrival - outputs[0].arrival
    latencies = sorted(driver.latencies(began))
    speed = sum(message.speed for message in outputs) / len(outputs)
    values = driver.values
    return {
        "seconds": ended - began,
        "messages": len(outputs),
        "period_ms": 1e3 * span / (len(outputs) - 1),
        "period_error_percent": 100 * (span / (len(outputs) - 1) * rate - 1.0),
        "latency_p50_ms": 1e3 * latencies[len(latencies) // 2],
        "latency_p99_ms": 1e3 * latencies[int(0.99 * (len(latencies) - 1))],
        "real_time_factor": (outputs[-1].angle - outputs[0].angle) / (speed * span),
        "time_lost_s": float(values.get("time lost [s]", "nan")),
        "solver_factor": float(values.get("real-time factor possible", "nan")),
    }


def _costs(first: Cost, settled: Cost, last: Cost, seconds: float) -> dict:
    spent = {name: last.by_thread[name] - first.by_thread.get(name, 0.0) for name in last.by_thread}
    solver = last.solver - first.solver
    return {
        "memory_at_10_s_mb": settled.memory / 1e6,
        "memory_at_end_mb": last.memory / 1e6,
        "cpu_solver_percent": 100 * solver / seconds,
        "cpu_without_solver_percent": 100 * (sum(spent.values()) - solver) / seconds,
        "cpu_by_thread_percent": {name: round(100 * cost / seconds, 3) for name, cost in sorted(spent.items()) if cost > 0.0},
    }


_COLUMNS = {
    "level": "level",
    "topics_subscribed": "topics",
    "input_rate_hz": "inputs [Hz]",
    "period_ms": "period [ms]",
    "period_error_percent": "off [%]",
    "latency_p50_ms": "latency p50 [ms]",
    "latency_p99_ms": "p99 [ms]",
    "real_time_factor": "real-time factor",
    "time_lost_s": "skipped [s]",
    "memory_at_10_s_mb": "memory at 10 s [MB]",
    "memory_at_end_mb": "at the end [MB]",
    "cpu_without_solver_percent": "CPU without solver [%]",
    "cpu_solver_percent": "solver [%]",
    "ending_s": "ended in [s]",
}


def _print_table(cases: list[dict]) -> None:
    rows = [[value if isinstance(value := case[name], str) else f"{value:.5g}" for name in _COLUMNS] for case in cases]
    print_rows("bearing_node, from another process", list(_COLUMNS.values()), rows, words={"level"}, width=170)
    click.echo(f"inputs at {100 * DETUNING:.0f} % of the output rate, so that every phase occurs; latency: age of the newest input in an output")


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--level", "levels", multiple=True, default=("slip", "planar"), show_default=True, help="Level; can be repeated.")
@click.option("--speed", "speed_rpm", default=15_000.0, show_default=True, help="Shaft speed [rpm].")
@click.option("--duration", default=60.0, type=click.FloatRange(1.0), show_default=True, help="Duration per level [s].")
@click.option(
    "--rate", default=100.0, type=click.FloatRange(1.0, 200.0), show_default=True, help="Rate of the outputs [Hz]; inputs are sent at 97 % of it."
)
@click.option(
    "--listen",
    default=ALL,
    show_default=True,
    help="Output topics with a (reliable) subscriber, separated by commas; bearing_joints always has one.",
)
@click.option("--record", is_flag=True, help="Let the node record to a temporary file.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON list.")
def command(levels, speed_rpm, duration, rate, listen, record, as_json):
    """Measure period, latency, real-time factor, memory and CPU time of a bearing_node from another process."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.SystemRandom().choice(DOMAINS)))
    import rclpy

    rclpy.init(args=[])
    try:
        cases = [measure(level, speed_rpm, duration, rate, listen, record) for level in levels]
    except (RuntimeError, ValueError) as error:
        raise click.ClickException(str(error)) from error
    finally:
        rclpy.try_shutdown()
    if as_json:
        click.echo(json.dumps(cases, indent=1))
    else:
        _print_table(cases)


if __name__ == "__main__":
    command()
