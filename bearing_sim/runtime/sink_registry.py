# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The sinks of a running model by name.  A sink that cannot write is closed and reported; the model continues."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Protocol

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.diagnostics import sink_subject
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import Origin
from bearing_sim.simulation import Inputs


class Sink(Protocol):
    """A destination of samples, events, measured cage speeds and clearances, and bands (see `bearing_sim.recording` and `bearing_sim.view`).

    A block of samples must not be changed, and is not changed by its sender afterwards.
    """

    def write(self, block: np.ndarray) -> None: ...
    def write_event(self, event: Event) -> None: ...
    def write_measurement(self, time: float, cage_speed: float, residual: float, standard_error: float, origin: Origin | None = None) -> None: ...
    def write_clearance(self, time: float, clearance: float, standard_error: float, origin: Origin | None = None) -> None: ...
    def write_bands(self, bands: Bands) -> None: ...
    def close(self) -> None: ...


class Recorder(Sink, Protocol):
    """A sink that also keeps the start, the inputs and the diagnostics."""

    def write_start(self, block: np.ndarray) -> None: ...
    def write_inputs(self, time: float, inputs: Inputs, channels, origin: Origin | None = None) -> None: ...
    def write_diagnostics(self, time: float, events, values) -> None: ...


class SinkRegistry:
    """Sinks by name.

    Attributes
    ----------
    by_name, recorders : dict[str, Sink], dict[str, Recorder]
        All of them, and those that keep inputs and diagnostics too.
    """

    def __init__(self):
        self.by_name: dict[str, Sink] = {}
        self.recorders: dict[str, Recorder] = {}
        self._failed: dict[str, Event] = {}

    def __contains__(self, name: str) -> bool:
        return name in self.by_name

    def attach(self, name: str, sink: Sink) -> None:
        """Add a sink; one with ``write_inputs`` gets inputs and diagnostics too.

        Raises
        ------
        ValueError
            There is a sink with this name.
        """
        if name in self.by_name:
            raise ValueError(f"there is a sink {name!r} already")
        self.by_name[name] = sink
        self._failed.pop(name, None)
        if hasattr(sink, "write_inputs"):
            self.recorders[name] = sink

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None if there is no sink with this name.  That one has failed is reported no longer.

        Raises
        ------
        OSError
            It could not be completed; it is removed all the same.
        """
        self._failed.pop(name, None)
        sink = self.by_name.pop(name, None)
        self.recorders.pop(name, None)
        if sink is not None:
            sink.close()
        return sink

    def write(self, now: float, block: np.ndarray) -> None:
        """Write a block of samples to all sinks, at ``now`` [s]."""
        self._each(self.by_name, now, "write", block)

    def write_event(self, event: Event) -> None:
        """Write an event to all sinks."""
        self._each(self.by_name, event.time, "write_event", event)

    def write_measurement(self, time: float, cage_speed: float, residual: float, standard_error: float, *origin: Origin) -> None:
        """Write a measured cage speed and its standard error [rad/s] to all sinks."""
        self._each(self.by_name, time, "write_measurement", time, cage_speed, residual, standard_error, *origin)

    def write_clearance(self, time: float, clearance: float, standard_error: float, *origin: Origin) -> None:
        """Write a measured clearance and its standard error [m] to all sinks."""
        self._each(self.by_name, time, "write_clearance", time, clearance, standard_error, *origin)

    def write_bands(self, now: float, bands: Bands) -> None:
        """Write quantities with their bands to all sinks, at ``now`` [s]."""
        self._each(self.by_name, now, "write_bands", bands)

    def write_start(self, time: float, block: np.ndarray) -> None:
        """Write the state at the start to all recorders."""
        self._each(self.recorders, time, "write_start", block)

    def write_inputs(self, time: float, inputs: Inputs, channels: Iterable[str], *origin: Origin) -> None:
        """Write inputs that arrived at ``time`` [s] to all recorders."""
        self._each(self.recorders, time, "write_inputs", time, inputs, channels, *origin)

    def write_diagnostics(self, time: float, events: Iterable[Event], values: Mapping[str, object]) -> None:
        """Write a diagnostics report to all recorders."""
        self._each(self.recorders, time, "write_diagnostics", time, events, values)

    def _each(self, sinks: Mapping[str, Sink], now: float, method: str, *arguments) -> None:
        for name, sink in list(sinks.items()):
            try:
                getattr(sink, method)(*arguments)
            except (OSError, ValueError) as error:
                self.fail(name, now, error)

    def fail(self, name: str, now: float, error: Exception) -> None:
        """Close a sink that has failed at ``now`` [s], for example because the disk is full, and report it."""
        try:
            self.detach(name)
        except (OSError, ValueError):
            pass  # the same error again
        self._failed[name] = Event(now, Level.ERROR, "sink.failed", name, f"failed: {error}", "it is closed and gets nothing more")

    def lack(self, name: str, reason: str) -> None:
        """Report a sink that cannot be made because something is not installed."""
        self._failed[name] = Event(0.0, Level.WARN, "sink.failed", name, f"does not start: {reason}", "the model runs without it")

    def events(self, now: float) -> Iterator[Event]:
        """Yield what is wrong with sinks at ``now`` [s], for as long as it is wrong."""
        yield from self._failed.values()
        for name, sink in self.by_name.items():
            if getattr(sink, "failure", None):
                yield Event(now, Level.WARN, "sink.failed", name, f"has stopped: {sink.failure}")

    def news(self, now: float) -> list[Event]:
        """Return what has happened to sinks since the last call, stamped ``now`` [s]."""
        reports = [(name, report) for name, sink in self.by_name.items() if hasattr(sink, "news") for report in sink.news()]
        return [Event(now, level, kind, name, reason) for name, (level, kind, reason) in reports]

    @property
    def values(self) -> dict[str, int]:
        """Blocks that sinks have dropped, by a key that names the sink."""
        return {f"{name}: blocks dropped": sink.dropped for name, sink in self.by_name.items() if hasattr(sink, "dropped")}

    @property
    def remarks(self) -> dict[str, str]:
        """What is said in diagnostics of recording and view while there is no event of them, by subject."""
        said = {"recording": "no recording", "view": "no view"}
        return said | {sink_subject(name): str(getattr(sink, "path", "open")) for name, sink in self.by_name.items()}

    def close(self, now: float) -> None:
        """Complete all sinks, recordings first, because a view may take its time."""
        for name in sorted(self.by_name, key=lambda name: name not in self.recorders):
            try:
                self.detach(name)
            except (OSError, ValueError) as error:
                self.fail(name, now, error)
