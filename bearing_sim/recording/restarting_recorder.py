# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A live recording that continues in a new file after the process that writes it was killed."""

import time as wall
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from bearing_sim.messages import topics
from bearing_sim.messages.events import Event, Level
from bearing_sim.recording.recorder import LiveRecording

MOST_RESTARTS = 3
"""How often a recording restarts within `WITHIN`; if its process is killed more often, it is given up."""

WITHIN = 60.0
"""[s]"""

_CLOSE_WITHIN = 5.0  # [s]


class RestartingRecorder:
    """A `bearing_sim.recording.recorder.LiveRecording`, replaced by another one when its process has ended; with the same methods.

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

    def write(self, block: np.ndarray) -> None:
        """Write a block of samples, which must not be changed afterwards.

        Raises
        ------
        OSError
            The recording has failed since the last call: its file cannot be written, or its process was killed too often.
        ValueError
            It is closed.
        """
        self._do("write", block)

    write_start = write
    """Write the state from which the run starts (see `bearing_sim.recording.writer.McapSink.write_start`)."""

    def write_inputs(self, time: float, inputs, channels: Iterable[str] = tuple(topics.INPUTS), origin: topics.Origin | None = None) -> None:
        """Write the inputs that arrived at ``time`` [s] (see `bearing_sim.recording.writer.McapSink.write_inputs`)."""
        self._do("write_inputs", time, inputs, tuple(channels), origin)

    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: topics.Origin | None = None) -> None:
        """Write a measured cage speed [rad/s] that arrived at ``time`` [s], and its residual slip."""
        self._do("write_measurement", time, cage_speed, residual, origin)

    def write_event(self, event: Event) -> None:
        """Write one event as diagnostics."""
        self._do("write_event", event)

    def write_diagnostics(self, time: float, events: Iterable[Event] = (), values: Mapping[str, object] | None = None) -> None:
        """Write a diagnostics message."""
        self._do("write_diagnostics", time, list(events), values)

    def news(self) -> list[tuple[Level, str, str]]:
        """Return (level, kind, text) of what happened to the recording since the last call."""
        news, self._news = [*self._news, *self._current.news()], []
        return news

    def close(self, timeout: float = _CLOSE_WITHIN) -> None:
        """Complete the recording (see `bearing_sim.recording.recorder.LiveRecording.close`)."""
        self._current.close(timeout)

    def __enter__(self) -> "RestartingRecorder":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def _do(self, method: str, *arguments) -> None:
        try:
            getattr(self._current, method)(*arguments)
        except OSError as error:
            if not self._current.is_orphaned:
                raise
            self._restart(error)
            getattr(self._current, method)(*arguments)

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
