# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The sinks of a running model: a sink that cannot write is given up and named, the model goes on."""

from collections.abc import Callable, Iterable
from typing import Protocol

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.simulation import Inputs
from bearing_sim.topics import Origin


class Sink(Protocol):
    """Where samples, events and measured cage speeds go (see `bearing_sim.sinks`)."""

    def write(self, block: np.ndarray) -> None: ...
    def write_event(self, event: Event) -> None: ...
    def write_measurement(self, time: float, cage_speed: float, residual: float, origin: Origin | None = None) -> None: ...
    def close(self) -> None: ...


class Recorder(Sink, Protocol):
    """A sink that also keeps the start, the inputs and the diagnostics."""

    def write_start(self, block: np.ndarray) -> None: ...
    def write_inputs(self, time: float, inputs: Inputs, channels, origin: Origin | None = None) -> None: ...
    def write_diagnostics(self, time: float, events, values) -> None: ...


class Outlets:
    """Sinks by name."""

    def __init__(self):
        self._sinks: dict[str, Sink] = {}
        self._recorders: dict[str, Recorder] = {}
        self._given_up: dict[str, Event] = {}

    def __bool__(self) -> bool:
        return bool(self._sinks)

    @property
    def keep_inputs(self) -> bool:
        """Whether there is a sink that keeps inputs."""
        return bool(self._recorders)

    def attach(self, name: str, sink: Sink) -> None:
        """Let a sink have what comes from now on; one with ``write_inputs`` gets the inputs and diagnostics too.

        Raises
        ------
        ValueError
            There is a sink of that name.
        """
        if name in self._sinks:
            raise ValueError(f"there is a sink {name!r} already")
        self._sinks[name] = sink
        self._given_up.pop(name, None)
        if hasattr(sink, "write_inputs"):
            self._recorders[name] = sink

    def has(self, name: str) -> bool:
        """Return whether there is a sink of that name."""
        return name in self._sinks

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None when there is none of that name.

        Raises
        ------
        OSError
            It could not be completed; it is detached all the same.
        """
        sink = self._sinks.pop(name, None)
        self._recorders.pop(name, None)
        if sink is not None:
            sink.close()
        return sink

    def to_all(self, now: float, action: Callable[[Sink], object]) -> None:
        """Do something with every sink, as of ``now`` [s]."""
        for name, sink in list(self._sinks.items()):
            self.guard(name, now, lambda: action(sink))

    def to_recorders(self, now: float, action: Callable[[Recorder], object]) -> None:
        """Do something with every sink that keeps inputs, as of ``now`` [s]."""
        for name, recorder in list(self._recorders.items()):
            self.guard(name, now, lambda: action(recorder))

    def guard(self, name: str, now: float, action: Callable[[], object]) -> None:
        """Do something for a sink; where it fails (a full disk), the sink is given up and named."""
        try:
            action()
        except (OSError, ValueError) as fault:
            self._given_up[name] = Event(now, Level.ERROR, f"sink.failed.{name}", f"{name} failed and is given up: {fault}")
            try:
                self.detach(name)
            except (OSError, ValueError):
                pass  # the same fault once more: it is on record already

    def troubles(self, now: float) -> Iterable[Event]:
        """Yield what is wrong with sinks, as of ``now`` [s]."""
        yield from self._given_up.values()
        for name, sink in self._sinks.items():
            if getattr(sink, "fault", None):
                yield Event(now, Level.WARN, f"sink.failed.{name}", f"{name} has stopped: {sink.fault}")

    def news(self, now: float) -> list[Event]:
        """Return what has happened to sinks since the last call, as of ``now`` [s]."""
        told = [one for sink in self._sinks.values() if hasattr(sink, "news") for one in sink.news()]
        return [Event(now, level, code, text) for level, code, text in told]

    @property
    def values(self) -> dict[str, int]:
        """What sinks have dropped, by a key that names the sink."""
        return {f"{name}: blocks dropped": sink.dropped for name, sink in self._sinks.items() if hasattr(sink, "dropped")}

    def close(self, now: float) -> None:
        """Complete all sinks, recordings first: a view may take its time."""
        for name in sorted(self._sinks, key=lambda name: name not in self._recorders):
            self.guard(name, now, lambda: self.detach(name))
