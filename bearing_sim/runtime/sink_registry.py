# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The sinks of a running model by name.  A sink that cannot write is closed and reported; the model continues."""

from collections.abc import Iterator
from typing import Protocol

from bearing_sim.messages.diagnostics import sink_subject
from bearing_sim.messages.events import FOR_KEEPING, Event, Level, Record


class Sink(Protocol):
    """A destination of records (see `bearing_sim.recording` and `bearing_sim.view`).

    One with an attribute ``keeps_all`` that is true gets starts, inputs and reports, too.
    """

    def write(self, record: Record) -> None: ...
    def close(self) -> None: ...


class SinkRegistry:
    """Sinks by name.

    Attributes
    ----------
    by_name, recorders : dict[str, Sink]
        All of them, and those that keep the start, inputs and reports too.
    """

    def __init__(self):
        self.by_name: dict[str, Sink] = {}
        self.recorders: dict[str, Sink] = {}
        self._failed: dict[str, Event] = {}

    def __contains__(self, name: str) -> bool:
        return name in self.by_name

    def attach(self, name: str, sink: Sink) -> None:
        """Add a sink.

        Raises
        ------
        ValueError
            There is a sink with this name.
        """
        if name in self.by_name:
            raise ValueError(f"there is a sink {name!r} already")
        self.by_name[name] = sink
        self._failed.pop(name, None)
        if getattr(sink, "keeps_all", False):
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

    def write(self, now: float, record: Record) -> None:
        """Write a record to all sinks that take it, at ``now`` [s]."""
        for name, sink in list((self.recorders if isinstance(record, FOR_KEEPING) else self.by_name).items()):
            try:
                sink.write(record)
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
