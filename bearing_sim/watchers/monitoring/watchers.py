# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What watches a run: a watcher hears what is measured, sees every sample, and says what holds.  Nothing else in the run knows what it is.

A run in wall time, one in simulated time and a replay have the watchers that the scene names (``watchers: [loaded_rollers]``); each is
imported only then.  ``doc/contributing/extend.md`` writes one.
"""

import importlib
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bearing_sim.messages.events import Event, Level, Record
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.watchers import place_of


class Watcher:
    """Base of watchers; each act may be left out.  Times are those of the samples [s].

    Parameters
    ----------
    scene : of the run.
    """

    def __init__(self, scene: Scene):
        self.scene = scene

    def hear(self, channel: str, time: float, value: float, standard_error: float) -> None:
        """Take a measurement of one of `bearing_sim.messages.topics.MEASURED_CHANNELS` [SI]."""

    def see(self, block: np.ndarray) -> Sequence[Record]:
        """Take samples in order, none twice, shape (n,), n at least 1; return what sinks are to keep."""
        return ()

    def events(self, now: float) -> Sequence[Event]:
        """Return the events that hold."""
        return ()

    def values(self, now: float) -> Mapping[str, object]:
        """Return numbers for diagnostics, with the unit in each key."""
        return {}

    def restart(self, why: str) -> None:
        """Forget the run so far: state and damage have returned to the start, or another bearing runs."""

    def close(self) -> None:
        """End with the run."""


class Watchers:
    """The optional watchers of a run.  One that raises is named in an event and sees nothing more; the run continues.

    Parameters
    ----------
    scene : names them.
    """

    def __init__(self, scene: Scene):
        self._watchers: dict[str, Watcher] = {}
        self._failed: list[Event] = []
        for name in scene.watchers:
            module, _, kind = place_of(name).partition(":")
            try:
                self._watchers[name] = getattr(importlib.import_module(module), kind)(scene)
            except Exception as error:  # of code that is not the run's, as all below
                self._fail(name, 0.0, error)

    def _fail(self, name: str, now: float, error: Exception) -> None:
        self._watchers.pop(name, None)
        reason = f"failed: {type(error).__name__}: {error}"
        self._failed.append(Event(now, Level.ERROR, f"watcher.{name}", name, reason, "it sees nothing more; the run continues"))

    def _each(self, now: float, act: str, *arguments) -> Iterator[tuple[str, object]]:
        for name, watcher in list(self._watchers.items()):
            try:
                found = getattr(watcher, act)(*arguments)
            except Exception as error:
                self._fail(name, now, error)
            else:
                yield name, found

    def hear(self, channel: str, time: float, value: float, standard_error: float) -> None:
        """Pass a measurement on."""
        for _ in self._each(time, "hear", channel, time, value, standard_error):
            pass

    def see(self, block: np.ndarray) -> list[Record]:
        """Pass samples on and return what sinks are to keep."""
        return [record for _, records in self._each(float(block["time"][-1]), "see", block) for record in records] if self._watchers else []

    def events(self, now: float) -> list[Event]:
        """Return the events that hold, those of watchers that have failed among them."""
        said = [event._replace(kind=f"watcher.{name}") for name, events in self._each(now, "events", now) for event in events]
        return [*self._failed, *said]

    def values(self, now: float) -> dict[str, object]:
        """Return the numbers of all, each key begun by ``watcher`` and the name, so that the status of watchers shows them."""
        return {f"watcher {name}: {key}": value for name, values in self._each(now, "values", now) for key, value in values.items()}

    def restart(self, why: str) -> None:
        """Let all begin again."""
        for _ in self._each(0.0, "restart", why):
            pass

    def close(self) -> None:
        """End all."""
        for _ in self._each(0.0, "close"):
            pass
