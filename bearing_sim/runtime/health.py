# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a person should be told about a running model: events that hold now, and the numbers behind them.

Pure: it reads the newest sample, the input gate and the runner, and knows no ROS.
"""

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.runtime.clock_runner import ClockRunner
from bearing_sim.runtime.input_gate import CHANNELS, InputGate
from bearing_sim.runtime.runner import Phase, Runner

_LINGER = 2.0  # [s] a momentary event is shown this long: a report at 1 Hz cannot miss it


class Condition(NamedTuple):
    """The state of health at one instant."""

    events: list[Event]  # what holds now, the worst first
    values: dict[str, object]  # diagnostics numbers, the unit in each key

    @property
    def level(self) -> Level:
        """The level of the worst event."""
        return level_of(self.events)


class Health:
    """Collects momentary events and those that hold."""

    def __init__(self):
        self._momentary: dict[str, tuple[Event, int, float]] = {}
        self._holding: set[tuple[str, Level]] = set()
        self._seen = {"lost": 0.0, "dropped": 0}
        self._news: list[Event] = []

    def note(self, event: Event, at: float | None = None) -> None:
        """Take in a momentary event (a refused message, a failure); while one of its kind is shown it is only counted.

        Parameters
        ----------
        event : that has happened.
        at : when, by the clock of the people who shall see it [s]; the event's own time where absent.
        """
        kind = _kind(event)
        count = self._momentary[kind][1] if kind in self._momentary else 0
        self._momentary[kind] = (event, count + 1, event.time if at is None else at)
        if count == 0:
            self._news.append(event)

    def events(
        self, now: float, gate: InputGate, runner: Runner | ClockRunner, others: Iterable[Event] = (), flow: Iterable[Event] | None = None
    ) -> list[Event]:
        """Return what holds at ``now``, the worst first.

        Parameters
        ----------
        now : [s], of the clock by which events are noted.
        gate, runner : of the model.
        others : added to the events.
        flow : what is wrong with the flow of messages; what the gate says as of ``now`` where absent.
        """
        self._momentary = {kind: noted for kind, noted in self._momentary.items() if now - noted[2] < _LINGER}
        self._note_losses(now, runner)
        events = [_counted(event, count) for event, count, _ in self._momentary.values()]
        events += [*others, *(gate.check(now) if flow is None else flow), *run_events(now, runner)]
        known = {}
        for event in sorted(events, key=lambda event: -event.level):
            known.setdefault(_kind(event), event)
        return list(known.values())

    def news(self, events: Iterable[Event]) -> list[Event]:
        """Return, each trouble once, what was noted and which of the lasting ``events`` began since the last call."""
        lasting = {(_kind(event), event.level): event for event in events if _kind(event) not in self._momentary}
        begun = [event for kind, event in lasting.items() if kind not in self._holding]
        self._holding = set(lasting)
        noted, self._news = self._news, []
        return noted + begun

    def _note_losses(self, now: float, runner: Runner | ClockRunner) -> None:
        """Turn growing loss counters into momentary events."""
        pace = runner.pace
        if pace.lost > self._seen["lost"]:
            self._seen["lost"] = pace.lost
            text = (
                f"time was given up because the solver or the machine was too slow: {pace.lost:.3g} s so far; "
                f"{pace.real_time_factor:.3g} of real time is held, the solver alone would reach {pace.solver_factor:.3g}"
            )
            self.note(Event(now, Level.WARN, "pace.lost", text))
        if runner.dropped > self._seen["dropped"]:
            self._seen["dropped"] = runner.dropped
            self.note(Event(now, Level.WARN, "output.dropped", f"{runner.dropped} blocks of samples were dropped because nobody took them in time"))


def run_events(now: float, runner: Runner | ClockRunner) -> list[Event]:
    """Return what the runner's phase calls for."""
    if runner.phase is Phase.CRASHED:
        return [Event(now, Level.ERROR, "solver.crashed", "the solver thread ended by a program fault; outputs are held, restart the node")]
    if runner.failed_ticks:
        text = f"time could not be advanced for {runner.failed_ticks} ticks; the last good state is held, the next inputs are tried"
        return [Event(now, Level.ERROR, "solver.failed", text)]
    if runner.phase is Phase.WAITING:
        return [Event(now, Level.OK, "run.waiting", "waiting for the first shaft_speed; nothing is computed yet")]
    if runner.phase is Phase.PAUSED:
        return [Event(now, Level.OK, "run.paused", "paused: simulated time is held")]
    return []


def level_of(events: Sequence[Event]) -> Level:
    """Return the level of the worst of events, which is the first."""
    return events[0].level if events else Level.OK


def numbers(gate: InputGate, runner: Runner | ClockRunner) -> dict[str, object]:
    """Return the numbers that every diagnostics report has, the unit in each key."""
    pace = runner.pace
    found = topics.condition(runner.newest) if runner.newest is not None else {}
    found |= {
        "phase": runner.phase.value,
        "run time [s]": float(runner.newest["time"]) if runner.newest is not None else 0.0,
        "real-time factor held": pace.real_time_factor,
        "real-time factor possible": pace.solver_factor,
        "time lost [s]": pace.lost,
        "blocks dropped": runner.dropped,
        "messages refused": gate.refused.total(),
    }
    for channel, rate in ((channel, gate.rate(channel)) for channel in CHANNELS):
        if not math.isnan(rate):
            found[f"{channel} rate [Hz]"] = rate
    return found | {f"refused: {code}": count for code, count in sorted(gate.refused.items())}


def _counted(event: Event, count: int) -> Event:
    return event if count == 1 else event._replace(text=f"{event.text} ({count} times)")


def _kind(event: Event) -> str:
    """Two events are the same trouble when code and subject (the word before the colon) agree."""
    return f"{event.code} {event.text.partition(':')[0]}" if event.code.startswith("input.") else event.code
