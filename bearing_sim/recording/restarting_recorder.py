# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A live recording that goes on in a fresh file where the process that writes it is killed."""

import time as wall
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.sinks.recorder import LiveRecording

MOST_RESTARTS = 3
"""How often a recording goes on within `WITHIN`; a process that is killed more often is left alone."""

WITHIN = 60.0
"""[s]"""

_CLOSE_WITHIN = 5.0  # [s]


class LastingRecording:
    """A `bearing_sim.sinks.recorder.LiveRecording` with the same methods, and another one in its place when its process has ended.

    What the killed process had not written yet, half a second or so, is lost; all that comes after its end was noticed, at the next call,
    goes into the next file.  A fault of the file itself, as a full disk, is raised as it is: another file would not be better off.

    Parameters
    ----------
    begin : begins a recording and returns it, in a file that none has; told whether to wait until that is open.
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
        self._dropped = 0  # by recordings before
        self._restarts: deque[float] = deque()
        self._news: list[tuple[Level, str, str]] = []

    @property
    def path(self) -> Path:
        """The present file's path, or the bag's, once it is finished."""
        return self._current.path

    @property
    def dropped(self) -> int:
        """Blocks, inputs and reports dropped so far, because the process did not keep up."""
        return self._dropped + self._current.dropped

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples.

        Raises
        ------
        OSError
            The recording could not go on, some time since the last call: by a fault of the file, or too many ends of the process.
        ValueError
            It is closed.
        """
        self._do(lambda recording: recording.write(block))

    def write_start(self, block: np.ndarray) -> None:
        """Write the state from which the run starts (see `bearing_sim.sinks.mcap_sink.McapSink.write_start`)."""
        self._do(lambda recording: recording.write_start(block))

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = tuple(topics.INPUTS), origin: topics.Origin | None = None) -> None:
        """Write the inputs that arrived at ``time`` [s] (see `bearing_sim.sinks.mcap_sink.McapSink.write_inputs`)."""
        channels = tuple(channels)
        self._do(lambda recording: recording.write_inputs(time, inputs, channels, origin))

    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: topics.Origin | None = None) -> None:
        """Write a measured cage speed [rad/s] that came at ``time`` [s], and its residual slip."""
        self._do(lambda recording: recording.write_measurement(time, cage_speed, residual, origin))

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self._do(lambda recording: recording.write_event(event))

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message."""
        events = list(events)
        self._do(lambda recording: recording.write_diagnostics(time, events, values))

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, code, text) of what happened to the recording since the last call."""
        told, self._news = [*self._news, *self._current.news()], []
        return told

    def close(self, timeout: float = _CLOSE_WITHIN) -> None:
        """Complete the recording (see `bearing_sim.sinks.recorder.LiveRecording.close`)."""
        self._current.close(timeout)

    def __enter__(self) -> "LastingRecording":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _do(self, action: Callable[[LiveRecording], None]) -> None:
        try:
            action(self._current)
        except OSError as fault:
            if not self._current.is_orphaned:
                raise
            self._go_on(fault)
            action(self._current)

    def _go_on(self, fault: OSError) -> None:
        now = self._clock()
        while self._restarts and now - self._restarts[0] > WITHIN:
            self._restarts.popleft()
        if len(self._restarts) == MOST_RESTARTS:
            raise OSError(f"{fault}; that was the {MOST_RESTARTS + 1}th process within {WITHIN:g} s, no other is started") from None
        self._restarts.append(now)
        ended = self._current
        self._current = self._begin(False)
        self._dropped += ended.dropped
        text = f"{ended.path} ends early and up to a second before this is lost: {fault}; the recording goes on in {self._current.path}"
        self._news += [*ended.news(), (Level.WARN, "recording.restarted", text)]
