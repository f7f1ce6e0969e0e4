# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How the memory of long-lived processes grows: ``python test/benchmarks/memory.py hour``, ``cycles``, ``view`` and ``reader``.

``hour`` runs a node in real time for an hour, with a live view, and with a recording that is started and stopped by turns.  Every quarter of a
minute it reads the resident memory of the node's process and of those that the node has started.  Below the table stands the slope of each, a
straight line through the last three quarters of the run.

``cycles`` configures and cleans up a node again and again, as a lifecycle manager may, and reads the resident memory of its process.  With
``--empty-cache`` no earlier process has compiled the model, as after an installation.

``view`` shows samples at 100 Hz to a live view and reads the resident memory of its process.  The view's clock follows the samples instead of
wall time: it draws the same 20 pictures for each second of the run, and the run passes as fast as pictures are drawn.  What the process
keeps, it keeps by picture and sample, not by time.

``reader`` writes a recording of an hour and reads it in three ways, each in a process of its own: as samples, as `to-csv` does; message by
message, as `view` and `replay` read a bag from another source; and with all checksums, as `info` does.
"""

import multiprocessing
import os
import random
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import click
import numpy as np
from measure import processes_of

from bearing_sim.cli.reporting import print_rows

_DOMAINS = range(60, 100)  # above the usual choices of users, below where ports collide with ephemeral ports
_PATIENCE = 60.0  # [s] for an answer of the node
_SAMPLE_RATE, _BLOCK = 100, 5  # [Hz], samples
_LOOK_EVERY = 15.0  # [s] in a run of an hour
_FLUSH_EVERY = 5  # blocks: four times a second, as `bearing_sim.view.worker` does


def resident_memory(pid: int | str) -> float:
    """Return the resident memory of a process [MB] (Linux)."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return 1e-6 * pages * os.sysconf("SC_PAGE_SIZE")


@click.group()
def main():
    """Measure the growth of memory."""


@main.command("cycles")
@click.option("--count", default=103, show_default=True, help="Cycles of configure and cleanup.")
@click.option("--stay", default=1.0, show_default=True, help="Time in state inactive [s]; a shorter one than the model takes to load ends it early.")
@click.option("--activate", is_flag=True, help="Activate and deactivate in each cycle.")
@click.option("--empty-cache", is_flag=True, help="Compile the model, as the first start after an installation does.")
@click.option("--parameter", "parameters", multiple=True, metavar="NAME:=VALUE", help="Parameter of the node; may be repeated.")
def cycles(count: int, stay: float, activate: bool, empty_cache: bool, parameters: tuple[str, ...]):
    """Configure and clean up a node again and again."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.SystemRandom().choice(_DOMAINS)))
    labels = ("configure", "activate", "deactivate", "cleanup") if activate else ("configure", "cleanup")
    with tempfile.TemporaryDirectory() as folder:
        environment = os.environ | ({"XDG_CACHE_HOME": folder} if empty_cache else {})
        settings = [word for text in ("autostart:=false", *parameters) for word in ("-p", text)]
        command = [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", "--log-level", "error", *settings]
        node = subprocess.Popen(command, env=environment, cwd=folder)
        try:
            rows = list(_cycled(node.pid, count, labels, stay))
        finally:
            node.terminate()
            node.wait(_PATIENCE)
    print_rows(f"{' and '.join(labels)}, {stay:g} s in between", ("cycle", "memory [MB]", "threads", "open files"), rows)


def _cycled(pid: int, count: int, labels: tuple[str, ...], stay: float):
    """Yield a row of the table before the first cycle and after some of them."""
    import rclpy
    from lifecycle_msgs.msg import Transition
    from lifecycle_msgs.srv import ChangeState

    rclpy.init(args=[])
    try:
        caller = rclpy.create_node("memory_benchmark")
        service = caller.create_client(ChangeState, "bearing_node/change_state")
        if not service.wait_for_service(_PATIENCE):
            raise click.ClickException("the node did not start; see its messages above")
        yield _row(pid, 0)
        for cycle in range(1, count + 1):
            for label in labels:
                answer = service.call_async(ChangeState.Request(transition=Transition(label=label)))
                rclpy.spin_until_future_complete(caller, answer, timeout_sec=_PATIENCE)
                if not (answer.done() and answer.result().success):
                    raise click.ClickException(f"{label} of cycle {cycle} failed; see the node's messages above")
                if label in ("configure", "activate"):
                    time.sleep(stay)
            if cycle in (1, 3, 10, count) or cycle % 20 == 0:
                yield _row(pid, cycle)
    finally:
        rclpy.try_shutdown()


def _row(pid: int, cycle: int) -> tuple[str, ...]:
    counts = (len(os.listdir(f"/proc/{pid}/{kind}")) for kind in ("task", "fd"))
    return (str(cycle), f"{resident_memory(pid):.0f}", *map(str, counts))


@main.command("hour")
@click.option("--minutes", default=60.0, show_default=True, help="Duration of the run, in real time.")
@click.option("--level", default="slip", show_default=True, help="Level of fidelity.")
@click.option("--rate", default=10.0, show_default=True, help="Inputs, samples and outputs per second [Hz].")
@click.option("--recording", default=5.0, show_default=True, help="Minutes of recording, and of none, by turns.")
@click.option("--port", default=9899, show_default=True, help="Port of the view on 127.0.0.1.")
def hour(minutes: float, level: str, rate: float, recording: float, port: int):
    """Run a node with a live view in real time, recording off and on."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.setdefault("ROS_DOMAIN_ID", str(random.SystemRandom().choice(_DOMAINS)))
    parameters = {"overrides": f"[level={level}]", "publish_rate": rate, "sample_rate": rate, "rerun_port": port, "governor": "false"}
    words = [word for name, value in parameters.items() for word in ("-p", f"{name}:={value}")]
    memory = defaultdict(list)  # of each kind of process: (minute, resident memory [MB])
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "bearing_sim.ros.node", "--ros-args", "--log-level", "warn", *words]
        node = subprocess.Popen(command, cwd=folder)
        try:
            for minute in _fed(node, minutes, rate, recording):
                for kind, megabytes in _memory_by_kind(node.pid).items():
                    memory[kind].append((minute, megabytes))
                    print(f"{minute:.2f} {kind} {megabytes:.2f}", file=sys.stderr, flush=True)
        finally:
            node.terminate()
            node.wait(_PATIENCE)
        recorded = sorted(file.stat().st_size for file in Path(folder).rglob("*.mcap"))
    rows = [_growth(kind, np.array(looks), minutes) for kind, looks in memory.items()]
    names = ("process", "looks", "first [MB]", "at a quarter [MB]", "last [MB]", "slope [MB/h]")
    print_rows(f"level {level}, {rate:g} samples a second, {minutes:g} minutes, {len(recorded)} recordings of {sum(recorded)} bytes", names, rows)


def _fed(node: subprocess.Popen, minutes: float, rate: float, recording: float) -> Iterator[float]:
    """Feed a node in real time, start and stop recordings; yield the minutes since the first output when it is time to look."""
    import rclpy
    from rclpy.qos import qos_profile_sensor_data
    from std_srvs.srv import Trigger

    from bearing_sim.messages import topics
    from bearing_sim.ros.messages import message, message_class
    from bearing_sim.simulation import Inputs

    rclpy.init(args=[])
    try:
        client = rclpy.create_node("memory_benchmark")
        inputs = {name: topics.INPUTS[name] for name in ("shaft_speed", "radial_load")}
        publishers = {name: client.create_publisher(message_class(topic.ros_type), name, qos_profile_sensor_data) for name, topic in inputs.items()}
        services = [client.create_client(Trigger, f"bearing_node/{name}_recording") for name in ("start", "stop")]
        output = topics.OUTPUTS["bearing_joints"]
        heard: list[float] = []  # when the first output arrived
        client.create_subscription(
            message_class(output.ros_type), "bearing_joints", lambda _: heard or heard.append(time.monotonic()), qos_profile_sensor_data
        )
        started = due = time.monotonic()
        next_look, recordings, answer = 0.0, 0, None
        while True:
            now = time.monotonic()
            if node.poll() is not None:
                raise click.ClickException(f"the node ended with code {node.returncode}; see its messages above")
            if not heard and now - started > 10.0 * _PATIENCE:
                raise click.ClickException("the node publishes nothing; see its messages above")
            minute = (now - heard[0]) / 60.0 if heard else 0.0
            if minute >= minutes:
                return
            if heard and minute >= next_look:
                yield minute
                next_look += _LOOK_EVERY / 60.0
            if minute >= (recordings + 1) * recording:  # the first turn is without a recording
                if answer is not None and not (answer.done() and answer.result().success):
                    raise click.ClickException("a recording did not start or stop; see the node's messages above")
                answer = services[recordings % 2].call_async(Trigger.Request())
                recordings += 1
            day = 2.0 * np.pi * (now - started) / 600.0
            values = Inputs(2000.0 * (1.0 + 0.25 * np.sin(day)), 800.0 * (1.0 + 0.4 * np.cos(7.0 * day)), 40.0 * np.sin(5.0 * day), np.nan)
            stamp = client.get_clock().now().nanoseconds
            for name, topic in inputs.items():
                publishers[name].publish(message(topic.ros_type, topic.message(stamp, values)))
            due = max(due + 1.0 / rate, time.monotonic())
            while (rest := due - time.monotonic()) > 0.0:
                rclpy.spin_once(client, timeout_sec=rest)
    finally:
        rclpy.try_shutdown()


def _memory_by_kind(pid: int) -> dict[str, float]:
    """Return the resident memory of a process and its descendants [MB], by the module that each runs."""
    memory: dict[str, float] = defaultdict(float)
    for each in processes_of(pid):
        try:
            words = Path(f"/proc/{each}/cmdline").read_text().split("\0")
            kind = words[words.index("-m") + 1] if "-m" in words[:-1] else words[0]
            memory[kind] += resident_memory(each)
        except OSError:  # it has ended in the meantime
            continue
    return dict(memory)


def _growth(kind: str, looks: np.ndarray, minutes: float) -> tuple[str, ...]:
    """Return a row of the table: how the memory of one kind of process went."""
    late = looks[looks[:, 0] >= 0.25 * minutes]
    slope = 60.0 * np.polyfit(*late.T, 1)[0] if len(late) > 2 else np.nan
    late = late if len(late) else looks
    return (kind, str(len(looks)), f"{looks[0, 1]:.1f}", f"{late[0, 1]:.1f}", f"{looks[-1, 1]:.1f}", f"{slope:.2f}")


@main.command("reader")
@click.option("--minutes", default=60.0, show_default=True, help="Length of the recording.")
@click.option("--rate", default=100, show_default=True, help="Samples per second.")
def reader(minutes: float, rate: int):
    """Read a recording."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.mcap"
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            pool.submit(_write_run, path, minutes, rate).result()
        rows = []
        for way in ("samples", "messages", "checksums"):
            with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
                looks = pool.submit(_read_run, path, way).result()
            done, megabytes = looks.T
            late = done > 0.25
            slope = np.polyfit(done[late] * minutes, megabytes[late], 1)[0]
            rows.append((way, f"{megabytes[0]:.0f}", f"{megabytes[late][0]:.0f}", f"{megabytes[-1]:.0f}", f"{megabytes.max():.0f}", f"{slope:+.3f}"))
        size = path.stat().st_size
    columns = ("way", "before [MB]", "at a quarter", "at the end", "largest", "MB per minute of the recording")
    print_rows(f"A recording of {minutes:g} min at {rate} Hz, {size / 1e6:.0f} MB", columns, rows, words=("way",))


def _write_run(path: Path, minutes: float, rate: int) -> None:
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from synthetic_run import synthetic_block

    from bearing_sim.recording.writer import McapSink
    from bearing_sim.scene.loader import load_scene

    scene = load_scene("deng2017_table1")
    block = synthetic_block(scene, np.arange(1, 1001) / rate)
    with McapSink(path, scene, 1_700_000_000_000_000_000) as sink:
        for _ in range(max(round(minutes * 60 * rate / len(block)), 1)):
            sink.write(block)
            block["time"] += len(block) / rate


def _read_run(path: Path, way: str) -> np.ndarray:
    """Return (fraction that was read, resident memory [MB]) while a recording is read."""
    from bearing_sim.recording.bag_reader import BagReader, BagTopic
    from bearing_sim.recording.reader import Recording
    from bearing_sim.recording.recovery import contents

    looks = [(0.0, resident_memory("self"))]

    def look(done: float) -> None:
        if done - looks[-1][0] >= 0.01:
            looks.append((done, resident_memory("self")))

    if way == "samples":
        recording = Recording(path)
        for item in recording:
            if isinstance(item, np.ndarray):
                look((float(item["time"][-1]) - recording.first_time) / recording.duration)
    elif way == "messages":
        run = Recording(path)
        first, last = run.start_ns, run.start_ns + run.last_time * 1e9
        for found in BagReader(path):
            if not isinstance(found, BagTopic):
                look((found[1] - first) / (last - first))
    else:
        contents(path, look)
    return np.array([*looks, (1.0, resident_memory("self"))])


@main.command("view")
@click.option("--minutes", default=22.0, show_default=True, help="Duration of the run.")
@click.option("--level", default="slip", show_default=True, help="Level of fidelity.")
@click.option("--port", default=9899, show_default=True, help="Port of the view on 127.0.0.1.")
def view(minutes: float, level: str, port: int):
    """Show a run to a live view."""
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:  # so that this process holds no compiled code
        scene, samples = pool.submit(_one_second, level).result()
    from bearing_sim.view import run_view

    passed = 0.0  # [s] of the run
    run_view.LiveFrames = partial(run_view.LiveFrames, clock=lambda: passed)
    shown = run_view.RunView(scene, None, port, run_view.ViewOptions(time.time_ns(), real_time=True))
    rows, next_row = [], 0.0
    for number in range(round(60 * minutes * _SAMPLE_RATE / _BLOCK)):
        first = number * _BLOCK
        block = samples[first % _SAMPLE_RATE : first % _SAMPLE_RATE + _BLOCK].copy()
        block["time"] = (first + np.arange(_BLOCK)) / _SAMPLE_RATE
        shown.write(block)
        passed = float(block["time"][-1])
        if number % _FLUSH_EVERY == 0:
            shown.flush()
        if passed >= next_row:
            rows.append((f"{passed / 60:.1f}", f"{resident_memory('self'):.0f}"))
            next_row += 30.0 if passed < 300.0 else 120.0
    rows.append((f"{passed / 60:.1f}", f"{resident_memory('self'):.0f}"))
    print_rows(f"live view of level {level}, no viewer connected", ("minute", "memory [MB]"), rows)
    sys.stdout.flush()
    os._exit(0)  # the server would wait for viewers


def _one_second(level: str):
    """Return a scene and a second of its samples."""
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.simulation import Simulation

    scene = load_scene("deng2017_table1", [f"level={level}"])
    return scene, Simulation(scene).advance(1.0, samples=_SAMPLE_RATE)


if __name__ == "__main__":
    main()
