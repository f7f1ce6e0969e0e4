# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings that are written in real time, by a process of their own (`bearing_sim.sinks.recorder_process`).

Laying out, indexing and compressing messages takes interpreter time, which a thread beside the solver would take from it between its
ticks.  Here a block is copied once and queued, and a thread hands on what has gathered ten times a second: one pickle of references, and
the blocks' own bytes, written to a pipe without the interpreter's lock.  Where nothing runs in real time, use
`bearing_sim.sinks.mcap_sink.McapSink` itself.

What is killed loses little: when the feeding process is, the recorder completes every file with all that had left that process; when the
recorder is, the files are what a killed writer leaves, and the feeding process is told by an OSError at its next write.
"""

import fcntl
import json
import logging
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
import time as wall
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.sample import flat
from bearing_sim.scene import Scene
from bearing_sim.sinks.limits import UNPARTED, Limits
from bearing_sim.sinks.priority import giving_way

_HAND_ON_EVERY = 0.1  # [s]; what a killed process loses of its own, and how often the solver may be disturbed
_PIPE = 1024 * 1024  # [byte] so that a late reader does not hold up the thread that hands on
_SMALL = 512  # [byte] about what an operation without a block takes
_OPEN_WITHIN = 30.0  # [s] a process that starts beside everything else on a busy machine
_CLOSE_WITHIN = 5.0  # [s]
_NICENESS = 5  # a file may be late by a part of a second, the solver may not
_log = logging.getLogger(__name__)


class Recorder:
    """A process that writes recordings; started once, it serves one after the other and many at a time.

    Parameters
    ----------
    capacity : bytes that may wait for the process [byte]; what comes beyond them is dropped and counted.
    """

    def __init__(self, capacity: int = 64 * 1024 * 1024):
        self._capacity = capacity
        self._line: _Line | None = None
        self._starting = threading.Lock()

    def start(self) -> None:
        """Start the process where there is none, so that the first recording need not wait for it; may be called from any thread."""
        self._living_line()

    @property
    def pid(self) -> int | None:
        """Number of the process; None where there is none."""
        return self._line.pid if self._line is not None and self._line.end is None else None

    def open(
        self,
        path: str | Path,
        scene: Scene,
        start_ns: int,
        limits: Limits = UNPARTED,
        advance: tuple[float, int] | None = None,
        replace: bool = False,
        wait: bool = True,
    ) -> "LiveRecording":
        """Begin a recording; the other parameters are those of `bearing_sim.sinks.mcap_sink.McapSink`.

        Parameters
        ----------
        wait : whether to wait until the file is open; else what is written meanwhile waits, and the first write after a fault raises it.

        Raises
        ------
        OSError
            The file cannot be made, or no process can.
        """
        options = {"limits": limits, "advance": advance, "replace": replace}
        recording = LiveRecording(self._living_line(), Path(path), scene, int(start_ns), options)
        if wait:
            recording.wait_until_open()
        return recording

    def close(self, timeout: float = _CLOSE_WITHIN) -> bool:
        """Complete what is being recorded and end the process; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s].  A process that is not done by then is left alone: it completes its files and ends by itself.

        Returns
        -------
        whether it ended.
        """
        with self._starting:
            line, self._line = self._line, None
        return line.close(timeout) if line is not None else True

    def __enter__(self) -> "Recorder":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _living_line(self) -> "_Line":
        with self._starting:
            if self._line is None or self._line.end is not None:
                self._line = _Line(self._capacity)
            return self._line


class LiveRecording:
    """One recording of a `Recorder`, with the methods of `bearing_sim.sinks.mcap_sink.McapSink`.

    None but `wait_until_open` and `close` waits for anything.

    Attributes
    ----------
    path : the finished file's path, or the bag's.
    dropped : blocks, inputs and reports dropped so far, because the process did not keep up.
    """

    def __init__(self, line: "_Line", path: Path, scene: Scene, start_ns: int, options: dict):
        self.path, self.start_ns, self.dropped = path, start_ns, 0
        self._line, self._told, self._closed = line, 0, False
        self._number, self._state = line.register()
        line.put(self._number, "open", (path.absolute(), scene, start_ns, options), urgent=True)

    @property
    def is_orphaned(self) -> bool:
        """Whether the process has ended before this recording was complete."""
        return self._line.end is not None

    def wait_until_open(self) -> None:
        """Wait until there is a file.

        Raises
        ------
        OSError
            It cannot be made, or is not within half a minute.
        """
        if not self._state.opened.wait(_OPEN_WITHIN):
            self._line.put(self._number, "close", (), urgent=True)
            raise OSError(f"{self.path} was not opened within {_OPEN_WITHIN:g} s by the process that records")
        if self._state.fault is not None:
            raise self._state.fault

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples.

        Raises
        ------
        OSError
            The recording could not go on, some time since the last call.
        ValueError
            It is closed.
        """
        if len(block):
            numbers = flat(np.array(block))
            self._offer("write", (numbers, block["roller_angle"].shape[1]), numbers.nbytes)

    def write_start(self, block: np.ndarray) -> None:
        """Write the state from which the run starts (see `bearing_sim.sinks.mcap_sink.McapSink.write_start`)."""
        self.write(block)

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = tuple(topics.INPUTS), origin: topics.Origin | None = None) -> None:
        """Write the inputs that arrived at ``time`` [s] (see `bearing_sim.sinks.mcap_sink.McapSink.write_inputs`)."""
        self._offer("write_inputs", (time, inputs._asdict(), tuple(channels), origin))  # by name: their class would bring the solver along

    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: topics.Origin | None = None) -> None:
        """Write a measured cage speed [rad/s] that came at ``time`` [s], and its residual slip."""
        self._offer("write_measurement", (time, cage_speed, residual, origin))

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self._offer("write_event", (event,))

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message."""
        self._offer("write_diagnostics", (time, list(events), None if values is None else dict(values)))

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, code, text) of what happened to the recording since the last call."""
        told = [self._state.news.popleft() for _ in range(len(self._state.news))]
        if self.dropped > self._told:
            self._told = self.dropped
            text = f"the recording {self.path} does not keep up: {self.dropped} blocks, inputs and reports are missing from it so far"
            told.append((Level.WARN, "recording.dropped", text))
        return told

    def close(self, timeout: float = _CLOSE_WITHIN) -> None:
        """Complete the recording and give it its name; a second call does nothing.

        Raises
        ------
        OSError
            It could not be completed, or not within ``timeout`` [s]; the process then goes on with it, even after the end of this one.
        """
        if self._closed:
            return
        self._closed = True
        earlier, self._state.fault = self._state.fault, None
        self._line.put(self._number, "close", (), urgent=True)
        if not self._state.closed.wait(timeout):
            raise OSError(f"{self.path} is not complete after {timeout:g} s; the process that records (number {self._line.pid}) goes on with it")
        if self._line.end is not None and earlier is not None:
            raise earlier
        if self._state.fault is not None:
            raise self._state.fault

    def __enter__(self) -> "LiveRecording":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _offer(self, name: str, arguments: tuple, size: int = 0) -> None:
        if self._closed:
            raise ValueError(f"{self.path} is closed")
        if self._state.fault is not None:
            raise self._state.fault
        if not self._line.put(self._number, name, arguments, size + _SMALL):
            self.dropped += 1


class _State:
    """What is known here of a recording over there."""

    def __init__(self):
        self.opened, self.closed = threading.Event(), threading.Event()
        self.fault: OSError | None = None
        self.news: deque[tuple[Level, str, str]] = deque()


class _Line:
    """A process and the way to it and back, for as long as it lives.

    Attributes
    ----------
    pid : its number.
    end : how it ended, or None.
    """

    def __init__(self, capacity: int):
        self._capacity, self._waiting, self._queue = capacity, 0, deque()  # the first two in bytes
        self._changed, self._urgent = threading.Condition(), threading.Event()
        self._ended = False
        self._states: dict[int, _State] = {}
        self._registered = 0
        self.end: str | None = None
        # A session of its own: neither Ctrl-C nor the end of a terminal nor a signal to the whole group reaches it, before Python could even
        # say that it wants none.  The end of its input does.  And whatever runs in the solver's session, the recorder has a share of its own: in
        # idle time, or nicer in the same session, it would fall behind beside two busy processes there, and what falls behind is lost.
        self._process = subprocess.Popen(
            giving_way([sys.executable, "-m", "bearing_sim.sinks.recorder_process"], _NICENESS),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=dict(os.environ, PYTHONPATH=os.pathsep.join(place for place in sys.path if place)),
            start_new_session=True,
        )
        self.pid = self._process.pid
        _widen(self._process.stdin.fileno())
        self._feeder = threading.Thread(target=self._feed, name="recorder-feeder", daemon=True)
        self._listener = threading.Thread(target=self._listen, name="recorder-listener", daemon=True)
        self._feeder.start()
        self._listener.start()

    def register(self) -> tuple[int, _State]:
        """Return the number and the state of a new recording."""
        with self._changed:
            number, self._registered = self._registered, self._registered + 1
            state = self._states[number] = _State()
            if self.end is not None:
                self._give_up(state)
        return number, state

    def put(self, number: int, name: str, arguments: tuple, size: int = 0, urgent: bool = False) -> bool:
        """Queue an operation; whether there was room, which there always is for one without a size."""
        with self._changed:
            if size and self._waiting + size > self._capacity:
                return False
            self._queue.append((number, name, arguments, size))
            self._waiting += size
            self._changed.notify()
        if urgent:
            self._urgent.set()
        return True

    def close(self, timeout: float) -> bool:
        """End the input and wait for the process to end; one that never got anything to do is not waited for."""
        deadline = wall.monotonic() + timeout
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._urgent.set()
        if not self._registered:
            self._process.kill()
        self._feeder.join(timeout)
        self._listener.join(max(0.0, deadline - wall.monotonic()))
        return not self._listener.is_alive()

    def _feed(self) -> None:
        pipe = self._process.stdin
        try:
            while (gathered := self._gathered()) is not None:
                operations = [operation for *operation, _ in gathered]
                buffers: list[pickle.PickleBuffer] = []
                head = pickle.dumps(operations, protocol=5, buffer_callback=buffers.append)
                parts = [memoryview(head), *(buffer.raw() for buffer in buffers)]
                pipe.write(struct.pack(f"<I{len(parts)}Q", len(parts), *(part.nbytes for part in parts)))
                for part in parts:
                    pipe.write(part)
                pipe.flush()
                with self._changed:
                    self._waiting -= sum(size for *_, size in gathered)
        except OSError:  # the process is gone; the listener says why
            pass
        finally:  # also at a fault of the program: the process completes its files then
            with suppress(OSError):
                pipe.close()

    def _gathered(self) -> list | None:
        """Return what has gathered for a while; None when nothing will come any more."""
        with self._changed:
            self._changed.wait_for(lambda: self._queue or self._ended)
        self._urgent.wait(_HAND_ON_EVERY)
        with self._changed:
            self._urgent.clear()
            if self._ended:
                self._urgent.set()  # no more pauses
            gathered, self._queue = list(self._queue), deque()
        return gathered or (None if self._ended else [])

    def _listen(self) -> None:
        """Take in what the process reports, a line of JSON each time, until it ends."""
        for line in self._process.stdout:
            report = json.loads(line)
            state = self._states[report["recording"]]
            state.news += [(Level[level], code, text) for level, code, text in report.get("news", ())]
            if "fault" in report:
                number, text = report["fault"]
                state.fault = OSError(text) if number is None else OSError(number, text)
            if "closed" in report:
                state.closed.set()
                with self._changed:
                    del self._states[report["recording"]]
            if report.keys() & {"opened", "fault"}:
                state.opened.set()
        code = self._process.wait()
        self._process.stdout.close()
        with self._changed:
            self.end = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended by itself with exit code {code}"
            lost = list(self._states.values())
            for state in lost:
                self._give_up(state)
        if lost:
            _log.error("the process that records %s, number %d; the run goes on without it", self.end, self.pid)

    def _give_up(self, state: _State) -> None:
        if state.fault is None:
            text = f"the process that records {self.end}; what is on the disk is in the unfinished file (.active), bearing-sim recover completes it"
            state.fault = OSError(text)
        state.opened.set()
        state.closed.set()


def _widen(pipe: int) -> None:
    """Let a pipe hold more, where the system has a way and a right to it."""
    with suppress(AttributeError, OSError):
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE)
