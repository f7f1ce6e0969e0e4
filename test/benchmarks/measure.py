# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measure how many bearings a node monitors on this machine: ``python test/benchmarks/measure.py --bearings 40 --set level=steady``.

Two sides communicate over DDS on the loopback interface: a `bearing_node` with the wanted number of bearings, and this process, which sends
speed and load to each of them and listens to some of their outputs.  It does so with serialised messages and without an executor, so that most
of the processor time is the node's; its own share is stated, because both use the same cores.

How to read it: **outputs a second** counts the messages that arrived on the topic of a bearing that had the fewest.  **Lag** is the age of an
output on arrival by its stamp, which is the simulated instant that it belongs to.  **Latency** is the age, on arrival, of the input that an output
reflects: each speed sent differs from the previous one by a millionth, so that an output identifies its input.
"""

import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import IO, NamedTuple

import click

from bearing_sim.files.standard_streams import standard_streams
from bearing_sim.messages import topics
from bearing_sim.messages.cdr import STAMP_FIELDS, CdrLayout
from bearing_sim.messages.diagnostics import WHOLE
from bearing_sim.runtime.solver_threads import THREAD_NAME
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs

DOMAINS = range(60, 100)  # above the usual choices of users, below where ports collide with ephemeral ports
START_LIMIT = 600.0  # [s] for the first start, which compiles
_SETTLING = 3.0  # [s] between the first output of every bearing and the measurement
_STEP = 1e-6  # relative difference between successive speeds
_DISTINCT = 1000  # number of different speeds; an output is never that late
_TURNS = 10  # in which the bearings get their inputs within one period, so that messages are spread over time
_TAKEN_EVERY = 3  # periods of the inputs from one look at the outputs of a bearing to the next; the middleware stamps arrivals
_LINES_SHOWN = 10  # of the node's log, if it does not start
_NUMBER, _STAMP = struct.Struct("<d"), struct.Struct("<iI")


class Cost(NamedTuple):
    """The resources that a process has used so far."""

    by_thread: dict[str, float]  # thread's name -> [s] of a core
    memory: float  # resident [bytes]

    @property
    def total(self) -> float:
        """Processor time of all threads [s]."""
        return sum(self.by_thread.values())

    @property
    def solver(self) -> float:
        """Processor time of the threads that integrate [s]."""
        return sum(spent for name, spent in self.by_thread.items() if name.startswith(THREAD_NAME[:15]))


def cost_of(pid: int) -> Cost:
    """Return the resources used by a process, by thread name (Linux)."""
    ticks, spent = os.sysconf("SC_CLK_TCK"), {}
    for task in Path(f"/proc/{pid}/task").iterdir():
        try:
            fields = (task / "stat").read_text()
        except OSError:  # it has ended in the meantime
            continue
        name, numbers = fields[fields.index("(") + 1 : fields.rindex(")")], fields[fields.rindex(")") + 2 :].split()
        spent[name] = spent.get(name, 0.0) + (int(numbers[11]) + int(numbers[12])) / ticks
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return Cost(spent, float(pages * os.sysconf("SC_PAGE_SIZE")))


def processes_of(pid: int) -> list[int]:
    """Return a process and its descendants that run now (Linux)."""
    found = [pid]
    for process in found:
        try:
            for task in Path(f"/proc/{process}/task").iterdir():
                found += map(int, (task / "children").read_text().split())
        except OSError:  # it has ended in the meantime
            continue
    return found


def log_tail(log: IO[bytes]) -> str:
    """Return the last lines of a node's log."""
    log.seek(0)
    lines = log.read().decode(errors="replace").strip().splitlines()[-_LINES_SHOWN:]
    return "\n".join(["its log:", *(lines or ["empty"])])


class _Template:
    """A serialised input message whose stamp and numbers are replaced in place.

    Parameters
    ----------
    channel : see `bearing_sim.messages.topics.INPUTS`.
    inputs : the values of everything that is not replaced.
    field : path of the number to replace.
    """

    def __init__(self, channel: str, inputs: Inputs, field: str):
        from rclpy.serialization import serialize_message

        from bearing_sim.ros.messages import message

        topic = topics.INPUTS[channel]
        self._bytes = bytearray(serialize_message(message(topic.ros_type, topic.message(0, inputs))))
        layout = CdrLayout(topic.ros_type, bytes(self._bytes))
        self._stamp, self._number = layout.by_path[STAMP_FIELDS[0]].begin, layout.by_path[field].begin

    def filled(self, stamp_ns: int, number: float) -> bytes:
        """Return the message with a stamp [ns since the epoch] and a number."""
        _STAMP.pack_into(self._bytes, self._stamp, *divmod(stamp_ns, 1_000_000_000))
        _NUMBER.pack_into(self._bytes, self._number, number)
        return bytes(self._bytes)


class _Bearing:
    """Sends inputs to one bearing, and takes its outputs.

    Parameters
    ----------
    node : owner of publishers and subscriptions.
    prefix : before the names of its topics.
    listen : output topics to listen to; the first one is ``bearing_joints``.
    templates : of the two inputs.
    inputs : the values to send.
    """

    def __init__(self, node, prefix: str, listen: Sequence[str], templates: dict[str, _Template], inputs: Inputs):
        from rclpy.qos import qos_profile_sensor_data

        from bearing_sim.ros.messages import message_class

        self._templates, self._inputs = templates, inputs
        self._publishers = {
            channel: node.create_publisher(message_class(topics.INPUTS[channel].ros_type), f"{prefix}{channel}", qos_profile_sensor_data)
            for channel in templates
        }
        types = [message_class(topics.OUTPUTS[name].ros_type) for name in listen]
        self._subscriptions = [node.create_subscription(kind, f"{prefix}{name}", lambda _: None, 1000) for kind, name in zip(types, listen)]
        self._sent_ns = [0] * _DISTINCT
        self._place = 0
        self._positions: tuple[int, int] | None = None
        self.restart()

    def restart(self) -> None:
        """Count from zero from now on."""
        self.counts = [0] * len(self._subscriptions)
        self._first, self._last = [0] * len(self._subscriptions), [0] * len(self._subscriptions)
        self.lags: list[float] = []  # [s]
        self.latencies: list[float] = []  # [s]

    @property
    def is_matched(self) -> bool:
        """Whether the node subscribes to its inputs."""
        return all(publisher.get_subscription_count() for publisher in self._publishers.values())

    @property
    def lost(self) -> int:
        """Messages that were published and did not arrive, by their sequence numbers."""
        return sum(last - first + 1 - count for first, last, count in zip(self._first, self._last, self.counts) if count)

    def send(self) -> None:
        """Publish speed and load now."""
        self._place = (self._place + 1) % _DISTINCT
        now_ns = time.time_ns()
        self._sent_ns[self._place] = now_ns
        numbers = {"shaft_speed": self._inputs.shaft_speed * (1.0 + _STEP * self._place), "radial_load": self._inputs.load_y}
        for channel, publisher in self._publishers.items():
            publisher.publish(self._templates[channel].filled(now_ns, numbers[channel]))

    def receive(self) -> None:
        """Receive all outputs that have arrived."""
        for which, subscription in enumerate(self._subscriptions):
            for cdr, info in taken(subscription):
                if not self.counts[which]:
                    self._first[which] = info["publication_sequence_number"]
                self._last[which] = info["publication_sequence_number"]
                self.counts[which] += 1
                if which == 0:
                    self._read(cdr, info["received_timestamp"])

    def _read(self, joints: bytes, arrived_ns: int) -> None:
        """Take the stamp and the speed from a serialised bearing_joints message."""
        if self._positions is None:
            layout = CdrLayout(topics.OUTPUTS["bearing_joints"].ros_type, joints)
            self._positions = layout.by_path[STAMP_FIELDS[0]].begin, layout.by_path["velocity"].begin
        seconds, nanoseconds = _STAMP.unpack_from(joints, self._positions[0])
        (speed,) = _NUMBER.unpack_from(joints, self._positions[1])
        self.lags.append((arrived_ns - seconds * 1_000_000_000 - nanoseconds) * 1e-9)
        sent_ns = self._sent_ns[round((speed / self._inputs.shaft_speed - 1.0) / _STEP) % _DISTINCT]
        if sent_ns:
            self.latencies.append((arrived_ns - sent_ns) * 1e-9)


def taken(subscription, serialised: bool = True):
    """Yield all messages that a subscription has, each with what the middleware knows about it."""
    from bearing_sim.ros.rclpy_internals import taker

    with ExitStack() as borrowed:
        take = taker(subscription, borrowed, serialised)
        while (found := take()) is not None:
            yield found


class Fleet:
    """The side that measures: sends inputs to all bearings and takes their outputs.

    Parameters
    ----------
    names : of the bearings.
    inputs : the values to send to each.
    listen : output topics to listen to; ``bearing_joints`` first.
    """

    def __init__(self, names: Sequence[str], inputs: Inputs, listen: Sequence[str]):
        import rclpy

        from bearing_sim.ros.messages import message_class
        from bearing_sim.ros.network import close_other_interfaces

        self._node = rclpy.create_node("bearing_measure", start_parameter_services=False, enable_rosout=False)
        close_other_interfaces(self._node)
        templates = {"shaft_speed": _Template("shaft_speed", inputs, "velocity"), "radial_load": _Template("radial_load", inputs, "wrench.force.y")}
        self.bearings = [_Bearing(self._node, f"{name}/", listen, templates, inputs) for name in names]
        self._reports_type = message_class(topics.DIAGNOSTICS[1])
        self._reports = self._node.create_subscription(self._reports_type, f"/{topics.DIAGNOSTICS[0]}", lambda _: None, 1000)
        self._reported: list[bytes] = []

    def close(self) -> None:
        """Destroy the ROS node."""
        self._node.destroy_node()

    def wait(self, node: subprocess.Popen, log: IO[bytes]) -> None:
        """Wait until every bearing publishes.

        Raises
        ------
        RuntimeError
            The node ends, or has not started after ten minutes; with its last log lines.
        """
        end = time.monotonic() + START_LIMIT
        while not all(bearing.lags for bearing in self.bearings):
            if node.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"the node did not start; {log_tail(log)}")
            for bearing in self.bearings:
                if bearing.is_matched:
                    bearing.send()
                bearing.receive()
            time.sleep(0.2)

    def drive(self, seconds: float, rate: float) -> int:
        """Publish inputs at a rate [Hz] and take outputs for a while; return the number of inputs for each bearing."""
        turns, start = 0, time.monotonic()
        while (due := start + turns / (rate * _TURNS)) < start + seconds:
            time.sleep(max(0.0, due - time.monotonic()))
            period, turn = divmod(turns, _TURNS)
            for bearing in self.bearings[turn::_TURNS]:
                bearing.send()
            if period % _TAKEN_EVERY == 0:
                for bearing in self.bearings[turn::_TURNS]:
                    bearing.receive()
            if turn == 0:
                self._reported += [cdr for cdr, _ in taken(self._reports)]
            turns += 1
        return turns // _TURNS

    def restart(self) -> None:
        """Count from zero from now on."""
        self._reported.clear()
        for bearing in self.bearings:
            bearing.receive()
            bearing.restart()

    def reports(self) -> list:
        """Return the messages of /diagnostics that have come since the last restart."""
        from rclpy.serialization import deserialize_message

        return [deserialize_message(cdr, self._reports_type) for cdr in self._reported]


def measure(
    scene: str,
    overrides: Sequence[str],
    bearings: int,
    duration: float,
    input_rate: float,
    rate: float,
    listen: Sequence[str],
    parameters: dict[str, object],
) -> dict:
    """Measure a node with a number of bearings and return its figures.

    Parameters
    ----------
    scene, overrides : of every bearing, which gets the scene's speed and load.
    bearings : how many.
    duration : of the measurement, after the start [s].
    input_rate : of speed and load for each bearing [Hz].
    rate : of the node's output topics [Hz].
    listen : output topics with a reliable subscriber; ``bearing_joints`` is one of them.
    parameters : further parameters of the node.

    Raises
    ------
    SceneError
        The scene cannot be used.
    ValueError
        An unknown output topic.
    RuntimeError
        The node does not start, or ends early; with its last log lines.
    """
    loaded = load_scene(scene, overrides, parameters.get("allow_outside") is True)
    listen = _listened(loaded, listen)
    names = [f"bearing_{k:0{len(str(bearings))}}" for k in range(1, bearings + 1)]
    chosen = {"bearings": names, "scene": scene, "overrides": list(overrides) or [""], "publish_rate": float(rate), "governor": False} | parameters
    with tempfile.TemporaryDirectory(prefix="bearing_sim_measure_") as folder, tempfile.TemporaryFile() as log:
        path = Path(folder) / "parameters.yaml"
        path.write_text(json.dumps({"/**": {"ros__parameters": chosen}}))  # JSON is YAML, too
        command = [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", "--params-file", str(path)]
        node = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        operating = loaded.operating
        inputs = Inputs(operating.shaft_speed, operating.radial_load, 0.0, loaded.lubricant.temperature)
        fleet = Fleet(names, inputs, listen)
        try:
            fleet.wait(node, log)
            fleet.drive(_SETTLING, input_rate)
            fleet.restart()
            processes = processes_of(node.pid)
            began, had, first = time.monotonic(), time.process_time(), [cost_of(process) for process in processes]
            sent = fleet.drive(duration, input_rate)
            if node.poll() is not None:
                raise RuntimeError(f"the node ended during the measurement; {log_tail(log)}")
            seconds, spent = time.monotonic() - began, time.process_time() - had
            last = [cost_of(process) for process in processes]
            for bearing in fleet.bearings:
                bearing.receive()
            reports = fleet.reports()
        finally:
            fleet.close()
            end(node)
    asked = {"scene": scene, "overrides": list(overrides), "level": loaded.level, "bearings": bearings, "rate_hz": rate, "listen": listen}
    sides = {
        "seconds": seconds,
        "input_rate_hz": sent / seconds,
        "cpu_measuring_percent": 100 * spent / seconds,
        "load_average": os.getloadavg()[0],
        "processes": [_share(before, after, seconds) for before, after in zip(first, last)],
    }
    return asked | sides | _outputs(fleet, seconds) | _reported(reports)


def end(node: subprocess.Popen) -> float:
    """End a node with SIGTERM and return how long that took [s]."""
    began = time.monotonic()
    node.terminate()
    try:
        node.wait(10.0)
    except subprocess.TimeoutExpired:
        node.kill()
        node.wait()
    return time.monotonic() - began


def _listened(scene: Scene, names: Sequence[str]) -> list[str]:
    known = topics.outputs(scene)
    if unknown := sorted(set(names) - set(known)):
        raise ValueError(f"unknown output topic {', '.join(map(repr, unknown))}; the topics are {', '.join(known)}")
    return ["bearing_joints", *(name for name in known if name in names and name != "bearing_joints")]


def _share(before: Cost, after: Cost, seconds: float) -> dict:
    solver = after.solver - before.solver
    return {
        "cpu_percent": 100 * (after.total - before.total) / seconds,
        "cpu_solver_percent": 100 * solver / seconds,
        "cpu_without_solver_percent": 100 * (after.total - before.total - solver) / seconds,
        "memory_mb": after.memory / 1e6,
        "cpu_by_thread_percent": {
            name: round(100 * (spent - before.by_thread.get(name, 0.0)) / seconds, 2)
            for name, spent in sorted(after.by_thread.items())
            if spent > before.by_thread.get(name, 0.0)
        },
    }


def _outputs(fleet: Fleet, seconds: float) -> dict:
    rates = sorted(min(bearing.counts) / seconds for bearing in fleet.bearings)
    lags = sorted(1e3 * lag for bearing in fleet.bearings for lag in bearing.lags)
    latencies = sorted(1e3 * latency for bearing in fleet.bearings for latency in bearing.latencies)
    return {
        "outputs_per_second_median": rates[len(rates) // 2],
        "outputs_per_second_worst": rates[0],
        "messages_lost": sum(bearing.lost for bearing in fleet.bearings),
        **{f"lag_{name}_ms": _quantile(lags, share) for name, share in _QUANTILES.items()},
        **{f"latency_{name}_ms": _quantile(latencies, share) for name, share in _QUANTILES.items()},
    }


_QUANTILES = {"p50": 0.5, "p99": 0.99, "worst": 1.0}


def _quantile(ordered: list[float], share: float) -> float:
    return ordered[int(share * (len(ordered) - 1))] if ordered else math.nan


def _reported(reports: list) -> dict:
    """Return what /diagnostics said: the newest numbers of each bearing, summed, and how often each warning stood there."""
    values: dict[str, dict[str, str]] = {}
    said: Counter[str] = Counter()
    for report in reports:
        for status in report.status:
            if status.values:
                values.setdefault(status.name, {}).update((pair.key, pair.value) for pair in status.values)
            if status.level != b"\0":
                said[f"{('OK', 'WARN', 'ERROR', 'STALE')[status.level[0]]} {status.name.rpartition(': ')[2]}"] += 1

    wholes = [found for name, found in values.items() if name.endswith(f": {WHOLE}")]

    def total(key: str) -> float:
        return sum(float(found[key]) for found in wholes if key in found)

    return {
        "outputs_left_out": total("outputs_left_out"),
        "time_lost_s": total("time lost [s]"),
        "reported": dict(said),
    }


_ROWS = {
    "outputs_per_second_median": "outputs a second, median bearing",
    "outputs_per_second_worst": "outputs a second, worst bearing",
    "lag_p50_ms": "lag, median [ms]",
    "lag_p99_ms": "lag, 99 % [ms]",
    "lag_worst_ms": "lag, worst [ms]",
    "latency_p50_ms": "latency, median [ms]",
    "latency_p99_ms": "latency, 99 % [ms]",
    "outputs_left_out": "outputs left out (since the start, by /diagnostics)",
    "time_lost_s": "time skipped, all bearings (since the start) [s]",
    "messages_lost": "outputs lost on the way",
    "input_rate_hz": "inputs a second for each bearing",
}


def table(case: dict) -> str:
    """Return the figures of a measurement as lines of text."""
    heard = f"{len(case['listen'])} topics of each heard at {case['rate_hz']:g} Hz"
    head = f"{case['bearings']} bearings at level {case['level']}, {heard}, {case['seconds']:.0f} s"
    lines = [head, *(f"  {meaning:<56}{case[key]:>10.2f}" for key, meaning in _ROWS.items())]
    for number, process in enumerate(case["processes"], 1):
        share = f"{process['cpu_percent']:.0f} % of a core (solver {process['cpu_solver_percent']:.0f} %), {process['memory_mb']:.0f} MB"
        lines.append(f"  process {number} of the node: {share}")
    lines.append(f"  this process: {case['cpu_measuring_percent']:.0f} % of a core; load average {case['load_average']:.1f}")
    said = ", ".join(f"{text} ({count} times)" for text, count in case["reported"].items())
    return "\n".join([*lines, f"  reported on /diagnostics: {said or 'nothing above OK'}"])


def _parameter(_, __, words: tuple[str, ...]) -> dict[str, object]:
    return {name: _value(text) for name, _, text in (word.partition("=") for word in words)}


def _value(text: str) -> object:
    """Return the number, truth value or list that a text stands for; the text itself where it is none of them."""
    try:
        return json.loads(text)
    except json.JSONDecodeError:
        return text


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.option("--bearings", "counts", multiple=True, type=click.IntRange(1, 999), default=(1,), show_default=True, help="How many; can be repeated.")
@click.option("--scene", default="deng2017_table1", show_default=True, help="Scene of every bearing, with the speed and load to send.")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Scene field to change, such as level=steady; can be repeated.")
@click.option("--parameter", "parameters", multiple=True, metavar="NAME=VALUE", callback=_parameter, help="Parameter of the node; can be repeated.")
@click.option("--duration", default=20.0, type=click.FloatRange(1.0), show_default=True, help="Duration of the measurement [s].")
@click.option("--input-rate", default=100.0, type=click.FloatRange(1.0, 1000.0), show_default=True, help="Inputs a second for each bearing.")
@click.option("--rate", default=50.0, type=click.FloatRange(1.0, 200.0), show_default=True, help="Rate of the outputs [Hz].")
@click.option(
    "--listen",
    default="bearing_joints,cage_slip,modified_rating_life",
    show_default=True,
    help="Output topics with a (reliable) subscriber, separated by commas; bearing_joints always has one.",
)
@click.option("--json", "as_json", is_flag=True, help="Print one JSON list.")
def command(counts, scene, overrides, parameters, duration, input_rate, rate, listen, as_json):
    """Measure outputs, lag, latency and processor time of a bearing_node with one bearing or many."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.SystemRandom().choice(DOMAINS)))
    import rclpy

    from bearing_sim.ros.network import use_loopback
    from bearing_sim.ros.shared_memory import remove_unfinished_ports

    use_loopback()
    rclpy.init(args=[])
    for warning in remove_unfinished_ports():
        click.echo(warning, err=True)
    names = [name.strip() for name in listen.split(",") if name.strip()]
    cases = []
    try:
        for bearings in counts:
            cases.append(measure(scene, overrides, bearings, duration, input_rate, rate, names, parameters))
            if not as_json:
                click.echo(table(cases[-1]))
    except (RuntimeError, ValueError, SceneError) as error:
        raise click.ClickException(str(error)) from error
    finally:
        rclpy.try_shutdown()
    if as_json:
        click.echo(json.dumps(cases, indent=1))


if __name__ == "__main__":
    with standard_streams():
        command()
