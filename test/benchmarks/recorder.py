# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a recorder costs a run in real time, and what it loses: ``python test/benchmarks/recorder.py``.

Four ways to record all observables of a run take turns: the package's own recorder, its `McapSink` on a thread behind a queue, and the
writer of the mcap library on such a thread, with chunks of its default length (1 MiB) and of 64 KiB.  Each is fed by a process of its own, every
10 ms, as the solver feeds it; that process also lays out the newest sample for its topics, as the node does before it publishes.

How to read it: "latency" is the time from when a block is due until its newest sample is ready to be published; "core" is the processor time of
the feeding process and of whatever process writes for it, less that without a recorder; "longest write" is the longest call of the feeder while
the disk does not answer for 2 s (the writing process is stopped, or each write to the file waits); "lost" is the time between the last sample
handed over and the last one that `recover` finds after SIGKILL of the feeding process.
"""

import multiprocessing
import os
import queue
import resource
import signal
import tempfile
import threading
import time
from pathlib import Path

import click
import numpy as np

from bearing_sim.cli.options import json_option
from bearing_sim.cli.reporting import print_json, print_rows
from bearing_sim.messages.cdr import load_message_types, message_type
from bearing_sim.messages.sample_messages import SampleMessages, message_templates
from bearing_sim.messages.topics import recorded
from bearing_sim.model.sample import new_block
from bearing_sim.recording import append_file
from bearing_sim.recording.bag import QOS_TEXT, RecordingError
from bearing_sim.recording.reader import Recording
from bearing_sim.recording.recorder import Recorder
from bearing_sim.recording.recovery import contents, recover
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.loader import load_scene

TICK = 0.01  # [s]
STALL = 2.0  # [s]
_SETTLING = 1.0  # [s] before anything is counted
_TICKS_PER_SECOND = os.sysconf("SC_CLK_TCK")
_START = 1_700_000_000_000_000_000
_COLUMNS = ("latency_median_ms", "latency_999_ms", "latency_most_ms", "core_percent", "longest_write_ms", "lost_median_s", "lost_most_s")


class NoRecorder:
    """Nothing, for comparison."""

    pid = None

    def __init__(self, path, scene):
        self.stalled = False

    def write(self, block) -> None:
        """Do nothing."""

    close = write


class Package(NoRecorder):
    """The package's recorder."""

    def __init__(self, path, scene):
        self._recorder = Recorder()
        self._recording = self._recorder.open(path, scene, _START)
        self.pid = getattr(self._recorder, "pid", None)

    def write(self, block) -> None:
        self._recording.write(block)

    def close(self) -> None:
        self._recording.close(60.0)
        self._recorder.close(60.0)


class SinkThread(NoRecorder):
    """A `McapSink` on a thread."""

    def __init__(self, path, scene):
        self._open(path, scene)
        self._queue = queue.SimpleQueue()
        self._thread = threading.Thread(target=self._work)
        self._thread.start()

    def _open(self, path, scene) -> None:
        self._sink = McapSink(path, scene, _START)

    def write(self, block) -> None:
        self._queue.put(block)

    def close(self) -> None:
        self._queue.put(None)
        self._thread.join()

    def _work(self) -> None:
        while (block := self._queue.get()) is not None:
            self._record(block)
        self._sink.close()

    def _record(self, block) -> None:
        self._sink.write(block)


class Library(SinkThread):
    """The writer of the mcap library on a thread, chunks of 1 MiB."""

    CHUNK = 1024 * 1024

    def _open(self, path, scene) -> None:
        from mcap.writer import Writer

        topics, rollers = tuple(recorded(scene).values()), scene.bearing.roller.count
        self._messages = SampleMessages(message_templates(topics, rollers))
        self._stream = _Stallable(path.with_name(path.name + ".active"))
        self._writer = Writer(self._stream, chunk_size=self.CHUNK)
        self._writer.start(profile="ros2", library="bearing_sim")
        with McapSink(path.with_name(f"scene_of_{path.name}"), scene, _START) as sink:
            sink.write(new_block(1, rollers))
        for name, record in contents(path.with_name(f"scene_of_{path.name}")).metadata.items():
            self._writer.add_metadata(name, record)
        self._channels = []
        for topic in topics:
            kind = message_type(topic.ros_type)
            schema = self._writer.register_schema(topic.ros_type, "ros2msg", kind.definition.encode())
            self._channels.append(self._writer.register_channel(f"/{topic.name}", "cdr", schema, {"offered_qos_profiles": QOS_TEXT}))
        self._sink = self._writer
        self._sink.close = self._writer.finish

    def _record(self, block) -> None:
        for sample in block:
            time_ns = _START + round(float(sample["time"]) * 1e9)
            self._messages.fill(time_ns, sample)
            for channel, part in zip(self._channels, self._messages.parts):
                self._writer.add_message(channel, time_ns, bytes(part), time_ns)


class LibrarySmall(Library):
    """The same, chunks of 64 KiB."""

    CHUNK = 64 * 1024


class _Stallable:
    """A file without a buffer, whose writes go the way of those of the package, so that both wait for the same disk."""

    def __init__(self, path):
        self._descriptor, self._at = os.open(path, os.O_RDWR | os.O_CREAT), 0

    def write(self, data: bytes) -> None:
        append_file._write_all(self._descriptor, data, self._at)
        self._at += len(data)

    def tell(self) -> int:
        return self._at


RECORDERS = {"none": NoRecorder, "package": Package, "sink on a thread": SinkThread, "mcap 1 MiB": Library, "mcap 64 KiB": LibrarySmall}


def _feed(name: str, path: Path, rate: float, seconds: float, stalls: bool, handed_over, results) -> None:
    """Feed a recorder in real time, and put what it cost into ``results``."""
    scene = load_scene("deng2017_table1")
    load_message_types()
    messages = SampleMessages(message_templates(tuple(recorded(scene).values()), scene.bearing.roller.count))
    recorder = RECORDERS[name](path, scene)
    count, noise = round(TICK * rate), np.random.default_rng(1)
    ticks, settling = round(seconds / TICK), round(_SETTLING / TICK)
    latency, longest, done, used = [], 0.0, 0, 0.0
    began = time.monotonic() + TICK
    for tick in range(ticks + settling):
        if tick == settling:
            used = _processor_time(recorder.pid)
            stalled = _stall(recorder.pid) if stalls else None
        block = new_block(count, scene.bearing.roller.count)
        block["time"] = (done + 1 + np.arange(count)) / rate
        block["inner_load"] = noise.normal(size=block["inner_load"].shape)  # incompressible
        due = began + tick * TICK
        time.sleep(max(0.0, due - time.monotonic()))
        before = time.monotonic()
        recorder.write(block)
        longest = max(longest, time.monotonic() - before) if tick >= settling else 0.0
        messages.fill(_START + round(float(block["time"][-1]) * 1e9), block[-1])
        latency += [time.monotonic() - due] if tick >= settling else []
        done += count
        handed_over.value = done
    used = _processor_time(recorder.pid) - used
    if stalls:
        stalled.join()
    results.put((latency, used / seconds, longest))
    recorder.close(None) if name == "none" else recorder.close()


def _processor_time(pid: int | None) -> float:
    own = resource.getrusage(resource.RUSAGE_SELF)
    other = 0.0
    if pid is not None:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
        other = (int(fields[11]) + int(fields[12])) / _TICKS_PER_SECOND
    return own.ru_utime + own.ru_stime + other


def _stall(pid: int | None) -> threading.Thread:
    """Let the disk not answer for a while: stop the process that writes, or let each write wait."""
    end, write = time.monotonic() + STALL, append_file._write_all

    def waiting(*arguments) -> None:
        time.sleep(max(0.0, end - time.monotonic()))
        write(*arguments)

    def work() -> None:
        if pid is None:
            append_file._write_all = waiting
        else:
            os.kill(pid, signal.SIGSTOP)
        time.sleep(STALL)
        if pid is not None:
            os.kill(pid, signal.SIGCONT)

    thread = threading.Thread(target=work)
    thread.start()
    return thread


def measured(context, name: str, folder: Path, rate: float, seconds: float, stalls: bool) -> tuple[list[float], float, float]:
    """Return latencies [s], share of a core, and the longest call of the feeder [s]."""
    handed_over, results = context.Value("q", 0), context.Queue()
    path = folder / f"{name.replace(' ', '_')}_{rate:g}_{stalls}.mcap"
    feeder = context.Process(target=_feed, args=(name, path, rate, seconds, stalls, handed_over, results))
    feeder.start()
    found = results.get(timeout=60 + 3 * seconds)
    feeder.join()
    return found


def lost(context, name: str, folder: Path, rate: float, moment: float) -> float:
    """Kill the feeding process; return the time between the last sample handed over and the last one recovered [s]."""
    handed_over = context.Value("q", 0)
    path = folder / "killed.mcap"
    results = context.Queue()
    feeder = context.Process(target=_feed, args=(name, path, rate, 60.0, False, handed_over, results), daemon=True)
    feeder.start()
    while not handed_over.value:
        time.sleep(0.001)
        if feeder.exitcode is not None:
            raise RuntimeError(f"{name} ended with exit code {feeder.exitcode}")
    time.sleep(moment)
    feeder.kill()
    feeder.join()
    time.sleep(1.0)  # for a process of its own, which completes the file
    recovered, active = folder / "recovered.mcap", path.with_name(path.name + ".active")
    try:
        recover(path if path.exists() else active, recovered)
        last = round(Recording(recovered, allow_partial=True).last_time * rate)
    except RecordingError:
        last = 0
    for file in folder.glob("*"):
        file.unlink()
    return (handed_over.value - last) / rate


@click.command()
@click.option("--rate", "rates", multiple=True, type=float, default=(100.0, 1000.0), show_default=True, metavar="HZ", help="Samples per second.")
@click.option("--seconds", type=float, default=10.0, show_default=True, metavar="S", help="Length of each run.")
@click.option("--kills", type=int, default=10, show_default=True, metavar="N", help="Number of recordings to kill, of each recorder and rate.")
@json_option
def command(rates, seconds, kills, as_json):
    """Compare recorders: latency and processor time of a run, stalls of the disk, and what a kill loses."""
    context, report = multiprocessing.get_context("forkserver"), []
    context.set_forkserver_preload([__name__])
    with tempfile.TemporaryDirectory() as folder:
        for rate in rates:
            idle = 0.0
            for name in RECORDERS:
                click.echo(f"{rate:g} Hz, {name} ...", err=True)
                latency, core, _ = measured(context, name, Path(folder), rate, seconds, stalls=False)
                idle = core if name == "none" else idle
                figures = [1e3 * float(each) for each in (np.median(latency), np.quantile(latency, 0.999), max(latency))]
                figures.append(100 * (core - idle))
                if name == "none":
                    figures += [0.0, 0.0, 0.0]
                else:
                    figures.append(1e3 * measured(context, name, Path(folder), rate, 1.5 * STALL, stalls=True)[2])
                    moments = np.random.default_rng(1).uniform(0.5, 3.0, kills).tolist()
                    losses = [lost(context, name, Path(folder), rate, moment) for moment in moments]
                    figures += [float(np.median(losses)), max(losses)]
                report.append({"rate": rate, "recorder": name} | dict(zip(_COLUMNS, figures)))
    if as_json:
        print_json({"recorders": report})
        return
    rows = [(f"{row['rate']:g} Hz, {row['recorder']}", *(f"{row[column]:.3g}" for column in _COLUMNS)) for row in report]
    print_rows("recorders of all observables", ("recorder", *_COLUMNS), rows, words=("recorder",), width=170)


if __name__ == "__main__":
    command()
