# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings in real time, written by a process of their own (`bearing_sim.recording.recorder_server`).

Laying out, indexing and compressing messages takes interpreter time; a thread beside the solver would take it from the solver between its
ticks.  Here a block is queued as it is, and a thread sends what has gathered to the other process ten times a second: one pickle of references,
followed by the blocks' own bytes, written to a pipe without the interpreter's lock.  If nothing runs in real time, use
`bearing_sim.recording.writer.McapSink` directly.

What a kill loses, by construction: if the feeding process is killed, the recorder completes every file with all that had been sent (see
`Recorder.backlog`).  If the recorder is killed, its files contain all that it had flushed, which `bearing_sim.recording.recovery` recovers, and the
next write of the feeding process raises an OSError.  Sending happens every 0.1 s and flushing every 0.5 s as long as both processes get the
processor; `test/benchmarks/recording_kills.py` measures what is lost in fact, also under load.
"""

import fcntl
import json
import logging
import math
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
import time as wall
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, suppress
from pathlib import Path

import numpy as np

from bearing_sim.messages import topics
from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, Level
from bearing_sim.model.sample import flat
from bearing_sim.recording.bag import UNLIMITED, Limits
from bearing_sim.recording.priority import with_low_priority
from bearing_sim.scene.scene import Scene

_SEND_EVERY = 0.1  # [s] how often the solver may be disturbed; a killed process loses what it has not sent
_PIPE = 1024 * 1024  # [byte] so that a late reader does not hold up the sending thread
_SMALL = 512  # [byte] approximate size of an operation without a block
_OPEN_WITHIN = 30.0  # [s] for a process that starts on a busy machine
_CLOSE_WITHIN = 5.0  # [s]
_NICENESS = 5  # a file may be a fraction of a second late, the solver may not
MOST_RESTARTS = 3
"""How often a recording restarts within `WITHIN`; if its process is killed more often, it is given up."""

WITHIN = 60.0
"""[s]"""

_log = logging.getLogger(__name__)


class Recorder(AbstractContextManager):
    """A process that writes recordings, one after the other and several at a time.

    Parameters
    ----------
    capacity : how much may wait for the process [byte]; anything beyond is dropped and counted.
    """

    def __init__(self, capacity: int = 64 * 1024 * 1024):
        self._capacity = capacity
        self._client: RecorderClient | None = None
        self._starting = threading.Lock()

    def start(self) -> None:
        """Start the process if there is none, so that the first recording need not wait for it; may be called from any thread."""
        self._living_client()

    @property
    def pid(self) -> int | None:
        """Id of the process; None if there is none."""
        return self._client.pid if self._client is not None and self._client.end is None else None

    @property
    def backlog(self) -> int:
        """How much waits to be sent to the process [byte]; 0 once everything written so far would survive the end of this process."""
        return 0 if self._client is None else self._client.backlog

    def open(
        self,
        path: str | Path,
        scene: Scene,
        start_ns: int,
        limits: Limits = UNLIMITED,
        advance: tuple[float, int] | None = None,
        wait: bool = True,
        frame: str = topics.FRAME,
        metadata: Mapping[str, Mapping[str, str]] | None = None,
        names: topics.Names = topics.OWN_NAMES,
    ) -> "LiveRecording":
        """Begin a recording; the other parameters are those of `bearing_sim.recording.writer.McapSink`.

        Parameters
        ----------
        wait : whether to wait until the file is open; otherwise writes are queued meanwhile, and the first one after an error raises it.

        Raises
        ------
        OSError
            The file cannot be made, or no process can be started.
        """
        options = {"limits": limits, "advance": advance, "frame": frame, "metadata": metadata, "names": names}
        recording = LiveRecording(self._living_client(), Path(path), scene, int(start_ns), options)
        if wait:
            recording.wait_until_open()
        return recording

    def close(self, timeout: float = _CLOSE_WITHIN) -> bool:
        """Complete all recordings and end the process; a second call does nothing.

        Parameters
        ----------
        timeout : longest wait [s].  A process that needs longer completes its files and ends by itself.

        Returns
        -------
        whether it ended.
        """
        with self._starting:
            client, self._client = self._client, None
        return client.close(timeout) if client is not None else True

    def __exit__(self, *_) -> None:
        self.close()

    def _living_client(self) -> "RecorderClient":
        with self._starting:
            if self._client is None or self._client.end is not None:
                self._client = RecorderClient(self._capacity)
            return self._client


class _Recording(AbstractContextManager):
    """The methods of `bearing_sim.recording.writer.McapSink`, each of which offers its arguments to the process that writes."""

    def offer(self, name: str, arguments: tuple, size: int = 0) -> None:
        """Take an operation with arguments of about this size [byte]."""
        raise NotImplementedError

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples, which must not be changed afterwards.

        Raises
        ------
        OSError
            The recording has failed since the last call: its file cannot be written, or its process was killed too often.
        ValueError
            It is closed.
        """
        if len(block):
            numbers = flat(np.ascontiguousarray(block))
            self.offer("write", (numbers, block["roller_angle"].shape[1]), numbers.nbytes)

    write_start = write
    """Write the state from which the run starts (see `bearing_sim.recording.writer.McapSink.write_start`)."""

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = topics.ALWAYS_KNOWN, origin: topics.Origin | None = None) -> None:
        """Write the inputs that arrived at ``time`` [s] (see `bearing_sim.recording.writer.McapSink.write_inputs`)."""
        self.offer("write_inputs", (time, inputs._asdict(), tuple(channels), origin))  # by name: their class would load the solver over there

    def write_measurement(
        self, time: float, cage_speed: float, residual: float, standard_error: float = math.nan, origin: topics.Origin | None = None
    ) -> None:
        """Write a measured cage speed and its standard error [rad/s] that arrived at ``time`` [s], and its residual slip."""
        self.offer("write_measurement", (time, cage_speed, residual, standard_error, origin))

    def write_clearance(self, time: float, clearance: float, standard_error: float = math.nan, origin: topics.Origin | None = None) -> None:
        """Write a measured clearance and its standard error [m] that arrived at ``time`` [s]."""
        self.offer("write_clearance", (time, clearance, standard_error, origin))

    def write_bands(self, bands: Bands) -> None:
        """Write quantities with their bands."""
        self.offer("write_bands", (bands,), bands.numbers.nbytes)

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self.offer("write_event", (event,))

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message."""
        self.offer("write_diagnostics", (time, list(events), None if values is None else dict(values)))

    def __exit__(self, *_) -> None:
        self.close()


class LiveRecording(_Recording):
    """One recording of a `Recorder`, with the methods of `bearing_sim.recording.writer.McapSink`.

    Only `wait_until_open` and `close` wait.

    Attributes
    ----------
    path : the finished file's path, or the bag's.
    dropped : blocks, inputs and reports dropped so far because the process did not keep up.
    """

    def __init__(self, client: "RecorderClient", path: Path, scene: Scene, start_ns: int, options: dict):
        self.path, self.start_ns, self.dropped = path, start_ns, 0
        self._client, self._reported, self._closed = client, 0, False
        self._number, self._state = client.register()
        client.put(self._number, "open", (path.absolute(), scene, start_ns, options), urgent=True)

    @property
    def is_orphaned(self) -> bool:
        """Whether the process has ended before this recording was complete."""
        return self._client.end is not None

    def wait_until_open(self) -> None:
        """Wait until there is a file.

        Raises
        ------
        OSError
            It cannot be made, or not within 30 s.
        """
        if not self._state.opened.wait(_OPEN_WITHIN):
            self._client.put(self._number, "close", (), urgent=True)
            raise OSError(f"{self.path} was not opened within {_OPEN_WITHIN:g} s by the recorder process")
        if self._state.error is not None:
            raise self._state.error

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the recording since the last call."""
        news = [self._state.news.popleft() for _ in range(len(self._state.news))]
        if self.dropped > self._reported:
            self._reported = self.dropped
            text = f"the recording {self.path} does not keep up: {self.dropped} blocks, inputs and reports are missing from it so far"
            news.append((Level.WARN, "recording.dropped", text))
        return news

    def close(self, timeout: float = _CLOSE_WITHIN) -> None:
        """Complete the recording and give it its name; a second call does nothing.

        Raises
        ------
        OSError
            It could not be completed, or not within ``timeout`` [s]; the recorder process then continues, even after the end of this one.
        """
        if self._closed:
            return
        self._closed = True
        earlier, self._state.error = self._state.error, None
        self._client.put(self._number, "close", (), urgent=True)
        if not self._state.closed.wait(timeout):
            raise OSError(f"{self.path} is not complete after {timeout:g} s; the recorder process (id {self._client.pid}) is still completing it")
        if self._client.end is not None and earlier is not None:
            raise earlier
        if self._state.error is not None:
            raise self._state.error

    def offer(self, name: str, arguments: tuple, size: int = 0) -> None:
        """Queue an operation for the process, or drop it and count that if there is no room."""
        if self._closed:
            raise ValueError(f"{self.path} is closed")
        if self._state.error is not None:
            raise self._state.error
        if not self._client.put(self._number, name, arguments, size + _SMALL):
            self.dropped += 1


class RestartingRecorder(_Recording):
    """A `LiveRecording` that is replaced by another one, in a new file, when its process has ended.

    What the killed process had not flushed is lost; the call that notices its end, and all later ones, go to the next file.  Errors of the
    file itself, such as a full disk, are raised as they are, because another file would fare no better.

    Parameters
    ----------
    begin : ``begin(wait)`` begins and returns a recording in a new file, and waits until it is open if ``wait``.
    clock : [s], monotonic.

    Attributes
    ----------
    start_ns : time 0 of the samples [ns since the epoch].

    Raises
    ------
    OSError
        The first recording cannot be begun.
    """

    def __init__(self, begin: Callable[[bool], LiveRecording], clock: Callable[[], float] = wall.monotonic):
        self._begin, self._clock = begin, clock
        self._current = begin(True)
        self.start_ns = self._current.start_ns
        self._dropped = 0  # by earlier recordings
        self._restarts: deque[float] = deque()
        self._news: list[tuple[Level, str, str]] = []

    @property
    def path(self) -> Path:
        """Path of the present file, or bag, once it is finished."""
        return self._current.path

    @property
    def dropped(self) -> int:
        """Blocks, inputs and reports dropped so far because the process did not keep up."""
        return self._dropped + self._current.dropped

    def offer(self, name: str, arguments: tuple, size: int = 0) -> None:
        """Offer an operation to the present recording, or to another one if the process of the present one has ended."""
        try:
            self._current.offer(name, arguments, size)
        except OSError as error:
            if not self._current.is_orphaned:
                raise
            self._restart(error)
            self._current.offer(name, arguments, size)

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the recording since the last call."""
        news, self._news = [*self._news, *self._current.news()], []
        return news

    def close(self, timeout: float = _CLOSE_WITHIN) -> None:
        """Complete the recording (see `LiveRecording.close`)."""
        self._current.close(timeout)

    def _restart(self, error: OSError) -> None:
        now = self._clock()
        while self._restarts and now - self._restarts[0] > WITHIN:
            self._restarts.popleft()
        if len(self._restarts) == MOST_RESTARTS:
            raise OSError(f"{error}; it was the {MOST_RESTARTS + 1}th process within {WITHIN:g} s, so no other is started") from None
        self._restarts.append(now)
        ended = self._current
        self._current = self._begin(False)
        self._dropped += ended.dropped
        text = f"{ended.path} ends early, and what was not flushed is lost: {error}; the recording continues in {self._current.path}"
        self._news += [*ended.news(), (Level.WARN, "recording.restarted", text)]


class _State:
    """What this process knows about a recording of the other one."""

    def __init__(self):
        self.opened, self.closed = threading.Event(), threading.Event()
        self.error: OSError | None = None
        self.news: deque[tuple[Level, str, str]] = deque()


class RecorderClient:
    """One recorder process, the queue of operations for it, and its reports.

    Attributes
    ----------
    pid : id of the process.
    backlog : size of the operations not sent yet [byte].
    end : how the process ended, or None.
    """

    def __init__(self, capacity: int):
        self._capacity, self.backlog, self._queue = capacity, 0, deque()
        self._changed, self._urgent = threading.Condition(), threading.Event()
        self._ended = False
        self._states: dict[int, _State] = {}
        self._registered = 0
        self.end: str | None = None
        # A session of its own: neither Ctrl-C nor the end of a terminal nor a signal to the whole group reaches the process, not even before
        # Python could ignore it; the end of its input does.  It also gives the recorder a share of the processor of its own: in idle time, or
        # with more niceness in the solver's session, it would fall behind beside two busy processes, and what falls behind is lost.
        self._process = subprocess.Popen(
            with_low_priority([sys.executable, "-m", "bearing_sim.recording.recorder_server"], _NICENESS),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=dict(os.environ, PYTHONPATH=os.pathsep.join(place for place in sys.path if place)),
            start_new_session=True,
        )
        self.pid = self._process.pid
        _widen(self._process.stdin.fileno())
        self._sender = threading.Thread(target=self._send, name="recorder-sender", daemon=True)
        self._listener = threading.Thread(target=self._listen, name="recorder-listener", daemon=True)
        self._sender.start()
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
        """Queue an operation; return whether there was room, which there always is for one without a size."""
        with self._changed:
            if size and self.backlog + size > self._capacity:
                return False
            self._queue.append((number, name, arguments, size))
            self.backlog += size
            self._changed.notify()
        if urgent:
            self._urgent.set()
        return True

    def close(self, timeout: float) -> bool:
        """End the input and wait for the process to end, without waiting for one that never got anything to do."""
        deadline = wall.monotonic() + timeout
        with self._changed:
            self._ended = True
            self._changed.notify()
        self._urgent.set()
        if not self._registered:
            self._process.kill()
        self._sender.join(timeout)
        self._listener.join(max(0.0, deadline - wall.monotonic()))
        return not self._listener.is_alive()

    def _send(self) -> None:
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
                    self.backlog -= sum(size for *_, size in gathered)
        except OSError:  # the process is gone; the listener says why
            pass
        finally:  # also after a programming error, so that the process completes its files
            with suppress(OSError):
                pipe.close()

    def _gathered(self) -> list | None:
        """Return what has gathered for a while; None when nothing more will come."""
        with self._changed:
            self._changed.wait_for(lambda: self._queue or self._ended)
        self._urgent.wait(_SEND_EVERY)
        with self._changed:
            self._urgent.clear()
            if self._ended:
                self._urgent.set()  # no more pauses
            gathered, self._queue = list(self._queue), deque()
        return gathered or (None if self._ended else [])

    def _listen(self) -> None:
        """Read the reports of the process, one line of JSON each, until it ends."""
        for line in self._process.stdout:
            report = json.loads(line)
            state = self._states[report["recording"]]
            state.news += [(Level[level], kind, text) for level, kind, text in report.get("news", ())]
            if "error" in report:
                number, text = report["error"]
                state.error = OSError(text) if number is None else OSError(number, text)
            if "closed" in report:
                state.closed.set()
                with self._changed:
                    del self._states[report["recording"]]
            if report.keys() & {"opened", "error"}:
                state.opened.set()
        code = self._process.wait()
        self._process.stdout.close()
        with self._changed:
            self.end = f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended by itself with exit code {code}"
            lost = list(self._states.values())
            for state in lost:
                self._give_up(state)
        if lost:
            _log.error("the recorder process %s (id %d); the run continues without it", self.end, self.pid)

    def _give_up(self, state: _State) -> None:
        if state.error is None:
            text = f"the recorder process {self.end}; what it had flushed is in the unfinished file (.active), which bearing-sim recover completes"
            state.error = OSError(text)
        state.opened.set()
        state.closed.set()


def _widen(pipe: int) -> None:
    """Let a pipe buffer more, if the system can and allows it."""
    with suppress(AttributeError, OSError):
        fcntl.fcntl(pipe, fcntl.F_SETPIPE_SZ, _PIPE)
