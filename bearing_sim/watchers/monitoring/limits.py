# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Watch whether the laws of a running model are used within their ranges (`bearing_sim.model.validity`).

Samples in, events out.  All times are those of the samples.  What an exceedance does is not computed while the model runs: a range from a source is a
warning, one that is an assumption is for the record.
"""

import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from bearing_sim.messages.events import Event, Level, validity_event
from bearing_sim.model.params import pack
from bearing_sim.model.validity import Conditions, Exceedance, Law, in_order, sample_laws, scene_exceedances, worst
from bearing_sim.scene.scene import Hold, Scene
from bearing_sim.watchers.estimation.two_states import laws_of_table
from bearing_sim.watchers.monitoring.monitor import Alarm
from bearing_sim.watchers.monitoring.watchers import Watcher

_EVERY = 0.1  # [s] least time between two samples that are judged: one costs about 0.2 ms
# A warning is raised at once, because an overload of an instant is enough to dent a raceway, and cleared late, so that it does not flicker.
_HOLD = Hold(hysteresis=0.02, raise_after=0.0, clear_after=5.0)


class _Range:
    """One law against both ends of its range, with hysteresis and hold times."""

    def __init__(self, law: Law, low: float, high: float):
        self.law, self.low, self.high = law, low, high
        # An alarm's hysteresis is a fraction of its limit.
        self._alarms = [Alarm(limit, _HOLD, below) for limit, below in ((low, True), (high, False)) if math.isfinite(limit)]
        self.holding: Exceedance | None = None  # the first, while the warning holds: its text stays

    @property
    def is_pending(self) -> bool:
        """Whether the warning holds, or may change with values inside the range."""
        return any(alarm.is_pending for alarm in self._alarms)

    def continuing(self, before: "_Range | None") -> "_Range":
        """Return the range as it stands after another one of the same law, if that has the same ends."""
        if before is not None and (before.low, before.high) == (self.low, self.high):
            self._alarms, self.holding = before._alarms, before.holding
        return self

    def judge(self, now: float, value: float) -> list[Event]:
        """Take the value at an instant [s] and return the event if the warning begins or ends."""
        raised, before = [alarm.judge(now, value) for alarm in self._alarms], self.holding
        if value < self.low or value > self.high:
            self.holding = before or self.law.exceeded(value, self.low, self.high)
        elif not any(raised):
            self.holding = None
        if (before is None) == (self.holding is None):
            return []
        if before is None:
            return [validity_event(now, self.holding)]
        return [Event(now, Level.OK, self.law.kind, self.law.name, "back within its range")]


class LimitsMonitor(Watcher):
    """Judges the samples of a run by the ranges of all laws of its scene.

    Limits that the scene exceeds by itself hold from the first sample to the end.

    Parameters
    ----------
    scene : of the run.
    laws : that replace those of the same name, as in `bearing_sim.model.validity.sample_laws`; by default those of the scene's table.

    Attributes
    ----------
    worst : dict
        The worst exceedance of each law so far, by its name; hysteresis and hold times have no part in it.
    worst_samples : dict
        The sample of each of them, by the law's name; of those that the scene exceeds by itself the one of the fastest shaft.
    """

    together = 400
    tells_changes = True

    def __init__(self, scene: Scene, laws: Iterable[Law] | None = None):
        super().__init__(scene)
        self._use(scene, laws)
        self.restart()

    def _use(self, scene: Scene, laws: Iterable[Law] | None = None) -> None:
        self.scene, self._params, self._laws = scene, pack(scene), tuple(laws_of_table(scene) if laws is None else laws)
        self._of_scene = scene_exceedances(scene)

    def restart(self, why: str = "") -> None:
        """Forget the run so far."""
        self._ranges = [_Range(*each) for each in sample_laws(self.scene, self._laws)]
        self._next = -math.inf
        self.worst: dict[str, Exceedance] = {}
        self.worst_samples: dict[str, np.void] = {}

    def follow(self, scene: Scene) -> None:
        """Judge by another setting of the same bearing from now on, such as another level.

        Warnings continue where both settings have the law with the same range; those of other laws of the setting before end without an event.
        The thresholds stay.

        Parameters
        ----------
        scene : that computes the samples from now on.
        """
        before = {each.law.name: each for each in self._ranges}
        self._use(replace(scene, thresholds=self.scene.thresholds))
        self._ranges = [_Range(*each).continuing(before.get(each[0].name)) for each in sample_laws(self.scene, self._laws)]
        if self._next > -math.inf:
            for each in self._of_scene:
                self._note_worst(each)

    def see(self, block: np.ndarray) -> list[Event]:
        """Judge samples, only one of those within 0.1 s, and return the warnings that begin or end, unless somebody reviews which hold.

        Parameters
        ----------
        block : samples in order, shape (n,), n at least 1; see `bearing_sim.model.sample`.
        """
        changes = []
        if self._next == -math.inf:
            self.worst = {each.law.name: each for each in self._of_scene}
            changes = [validity_event(float(block["time"][0]), each) for each in self._of_scene]
        if block["time"][-1] < self._next:
            return [] if self.run.is_reviewed else changes
        block = block[self._due(block["time"].tolist())]
        self._note_fastest(block)
        at, times = Conditions(self.scene, block, self._params), block["time"].tolist()
        for each in self._ranges:
            values = each.law.value(at)
            found = worst(each.law, each.low, each.high, values)
            for one in found:
                self._note_worst(one, block[np.flatnonzero(values == one.value)[0]])
            if found or each.is_pending:
                for time, value in zip(times, values.tolist()):
                    changes += each.judge(time, value)
        return [] if self.run.is_reviewed else sorted(changes, key=lambda event: event.time)

    def _note_fastest(self, block: np.ndarray) -> None:
        if not self._of_scene:
            return
        fastest, known = block[np.argmax(np.abs(block["shaft_speed"]))], self.worst_samples.get(self._of_scene[0].law.name)
        if known is None or abs(fastest["shaft_speed"]) > abs(known["shaft_speed"]):
            self.worst_samples |= dict.fromkeys((each.law.name for each in self._of_scene), fastest.copy())

    def _note_worst(self, found: Exceedance, sample: np.void | None = None) -> None:
        name = found.law.name
        if name in self.worst and self.worst[name].excess >= found.excess:
            return
        self.worst[name] = found
        if sample is not None:
            self.worst_samples[name] = sample.copy()

    def _due(self, times: list[float]) -> list[int]:
        """Return the places of the samples to judge."""
        chosen = []
        for place, time in enumerate(times):
            if time >= self._next:
                chosen.append(place)
                self._next = time + _EVERY * (1 - 1e-9)
        return chosen

    def events(self, now: float) -> list[Event]:
        """Return the events that hold, stamped ``now`` [s]."""
        if self._next == -math.inf:
            return []
        holding = [*self._of_scene, *(each.holding for each in self._ranges if each.holding is not None)]
        return [validity_event(now, each) for each in in_order(holding)]

    @property
    def exceedances(self) -> list[Exceedance]:
        """The worst exceedance of each law so far, in the order of the laws."""
        return in_order(self.worst.values())
