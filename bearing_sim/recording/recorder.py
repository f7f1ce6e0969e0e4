# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Recordings in real time: each is written by a thread of its own, so that a run never waits for a disk.

Laying out, indexing and compressing a sample of all topics takes some 0.1 ms of a core, most of it without the interpreter's lock.  Records are
queued as they are; ten times a second the thread takes what has gathered, and adjacent blocks of samples at once.  If nothing runs in real time, use
`bearing_sim.recording.writer.McapSink` directly.

If the process is killed, its files contain all that was flushed (see `bearing_sim.recording.writer.McapFile`), which
`bearing_sim.recording.recovery` recovers: what is lost was written in the last 0.6 s, as long as the disk keeps up.
`test/benchmarks/recording_kills.py` measures what is lost in fact; `test/benchmarks/recorder.py` compares the cost with that of other ways.
"""

import logging
import threading
import time as wall
from contextlib import AbstractContextManager, suppress
from itertools import groupby
from pathlib import Path

import numpy as np

from bearing_sim.messages.events import Level, Record
from bearing_sim.model.sample import joined
from bearing_sim.recording.append_file import NO_SPACE
from bearing_sim.recording.writer import McapSink
from bearing_sim.scene.scene import Scene

_GATHER = 0.1  # [s] how often the solver may be disturbed
_SMALL = 512  # [byte] approximate size of a record that is no block
_CLOSE_WITHIN = 5.0  # [s]
_RETRY_EVERY = 2.0  # [s] to complete a recording once there is space again; the last try is when the recorder is closed
_log = logging.getLogger(__name__)


class Recorder(AbstractContextManager):
    """Writes recordings in real time, one after the other and several at a time.

    Parameters
    ----------
    capacity : how much may wait to be written to each [byte]; anything beyond is dropped and counted.
    """

    def __init__(self, capacity: int = 64 * 1024 * 1024):
        self._capacity = capacity
        self._recordings: list[LiveRecording] = []
        self._ending = threading.Event()

    def open(self, path: str | Path, scene: Scene, start_ns: int, **options) -> "LiveRecording":
        """Begin a recording; parameters and errors are those of `bearing_sim.recording.writer.McapSink`."""
        recording = LiveRecording(McapSink(path, scene, start_ns, **options), self._capacity, self._ending)
        self._recordings = [*(each for each in self._recordings if each.is_working), recording]
        return recording

    def close(self, timeout: float = _CLOSE_WITHIN) -> bool:
        """Complete all recordings within ``timeout`` [s]; return whether none is being written any more."""
        until = wall.monotonic() + timeout
        self._ending.set()
        for recording in self._recordings:
            with suppress(OSError):  # whoever closes the recording itself is told
                recording.close(max(until - wall.monotonic(), 0.0))
            recording.join(max(until - wall.monotonic(), 0.0))
        self._recordings = [recording for recording in self._recordings if recording.is_working]
        return not self._recordings

    def __exit__(self, *_) -> None:
        self.close()


class LiveRecording(AbstractContextManager):
    """A sink whose records are written by a thread; only `close` waits.

    Parameters
    ----------
    sink : writes the records.
    capacity : how much may wait to be written [byte].
    ending : set when the last try to complete the recording is due.

    Attributes
    ----------
    path : the finished file's path, or the bag's.
    start_ns : time 0 of the samples [ns since the epoch].
    dropped : records dropped so far because the disk did not keep up.
    """

    keeps_all = True

    def __init__(self, sink: McapSink, capacity: int, ending: threading.Event):
        self.path, self.start_ns, self.dropped = sink.path, sink.start_ns, 0
        self._sink, self._capacity, self._ending = sink, capacity, ending
        self._queue: list[Record] = []
        self._backlog, self._reported = 0, 0
        self._changed, self._closing, self._completed = threading.Condition(), threading.Event(), threading.Event()
        self._error: OSError | None = None  # in writing
        self._failure: OSError | None = None  # in completing
        self._thread = threading.Thread(target=self._work, name="recorder", daemon=True)
        self._thread.start()

    @property
    def is_working(self) -> bool:
        """Whether its thread has something to do, or may get it."""
        return self._thread.is_alive()

    def write(self, record: Record) -> None:
        """Queue a record, or drop it and count that if there is no room.  A block of samples must not be changed afterwards.

        Raises
        ------
        OSError
            The recording has failed since the last call: its file cannot be written.
        ValueError
            It is closed.
        """
        if self._closing.is_set():
            raise ValueError(f"{self.path} is closed")
        if self._error is not None:
            raise self._error
        size = _size(record)
        with self._changed:
            if self._backlog + size > self._capacity:
                self.dropped += 1
                return
            self._queue.append(record)
            self._backlog += size
            self._changed.notify()

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the recording since the last call."""
        news = self._sink.news()
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
            It could not be completed, or not within ``timeout`` [s]; its thread then continues while the process runs.
        """
        if self._closing.is_set():
            return
        self._closing.set()
        with self._changed:
            self._changed.notify()
        if not self._completed.wait(timeout):
            text = f"{self.path} is not complete after {timeout:g} s; it is being completed while this process runs"
            raise OSError(f"{text}, and if that ends before, bearing-sim recover completes what was written")
        if self._failure is not None:
            raise self._failure

    def join(self, timeout: float) -> None:
        """Wait at most so long [s] for the end of the thread."""
        self._thread.join(timeout)

    def __exit__(self, *_) -> None:
        self.close()

    def _work(self) -> None:
        try:
            while gathered := self._gathered():
                for row, run in groupby(gathered, key=lambda record: record.itemsize if isinstance(record, np.ndarray) else 0):
                    for record in [joined([np.ascontiguousarray(block) for block in run])] if row else run:
                        self._sink.write(record)
                with self._changed:
                    self._backlog -= sum(map(_size, gathered))
        except (OSError, ValueError) as error:
            self._error = error if isinstance(error, OSError) else OSError(str(error))
        except Exception as error:  # even a programming error must leave a complete file, and be reported
            _log.exception("the recording %s ends early", self.path)
            self._error = OSError(f"{self.path} ends early, programming error: {error!r}")
        self._complete()

    def _gathered(self) -> list[Record]:
        """Return what has gathered for a while; nothing once it is closed and all is written."""
        with self._changed:
            self._changed.wait_for(lambda: self._queue or self._closing.is_set())
        self._closing.wait(_GATHER)
        with self._changed:
            gathered, self._queue = self._queue, []
        return gathered

    def _complete(self) -> None:
        """Complete the file, again and again while the disk is full."""
        is_last = False
        while True:
            try:
                self._sink.close()
                self._failure = None
                return
            except OSError as error:
                self._failure = error
                if is_last or error.errno not in NO_SPACE:
                    return
            finally:
                self._completed.set()
            is_last = self._ending.wait(_RETRY_EVERY)


def _size(record: Record) -> int:
    return _SMALL + (record.nbytes if isinstance(record, np.ndarray) else 0)
