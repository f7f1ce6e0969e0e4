# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The health of a running model: the events that hold now, and the numbers behind them.

It reads the newest sample, the input gate and the solver, and knows no ROS.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum
from types import MappingProxyType
from typing import NamedTuple, Protocol

from bearing_sim.inputs.gate import CHANNELS, REQUIRED, InputGate
from bearing_sim.messages.diagnostics import JUDGED, SUBJECTS, condition
from bearing_sim.messages.events import Event, Level

_NUMBER = re.compile(r"[-+]?(\d[\d.]*(e[-+]?\d+)?|\bnan\b|\binf\b)")
_LINGER = 2.0  # [s] how long a momentary event is shown, so that a report at 1 Hz cannot miss it
_REMEMBERED = 16  # different texts of an event
_RECURS = 10.0  # [s] as long as that if it comes again within this time, so that a trouble that comes and goes is one and not many


class Phase(Enum):
    """What the solver is doing."""

    READY = "ready"  # not started
    WAITING = "waiting for the first input"
    RUNNING = "running"
    PAUSED = "paused"
    STOPPED = "stopped"
    CRASHED = "crashed"  # by a programming error, which an event reports; everything else keeps working


class SolverState(Protocol):
    """What the health reads from the thread that advances the model (`bearing_sim.runtime.solver.Solver`)."""

    phase: Phase
    failed_ticks: int
    dropped: int
    newest: object
    pace: object


class Condition(NamedTuple):
    """The health at one instant."""

    events: list[Event]  # that hold now, the worst first
    values: Mapping[str, object]  # for diagnostics, the unit in each key
    remarks: Mapping[str, str] = MappingProxyType({})  # what is said of subjects without events, by name
    otherwise: str = "OK"  # what is said of the other subjects without events
    unused: frozenset[str] = frozenset()  # subjects that nothing is to be said of, because the run does without them

    @property
    def level(self) -> Level:
        """The level of the worst event."""
        return level_of(self.events)


class Health:
    """Collects momentary events, and tells which lasting events are new."""

    def __init__(self):
        self._momentary: dict[tuple[str, str], Event] = {}
        self._seen_at: dict[tuple[str, str], float] = {}
        self._shown_for: dict[tuple[str, str], float] = {}
        self._said: dict[tuple[str, str], dict[str, float]] = {}  # when each text, without its numbers, came last while its event is shown
        self._lasting = Changes()
        self._lost, self._dropped = 0.0, 0
        self._news: list[Event] = []

    def note(self, event: Event, at: float | None = None) -> None:
        """Take a momentary event (a refused message, a failure); while one with the same key is shown it is only counted.

        What has merely happened, of level OK, is news and nothing that holds: it changes no status.

        Parameters
        ----------
        event : what has happened.
        at : when, by the clock of those who read the events [s]; the event's own time by default.
        """
        before, at = self._momentary.get(event.key), event.time if at is None else at
        words, said = _words(event), self._said.setdefault(event.key, {})
        if before is None:
            said.clear()
        elif words != _words(before):
            # Troubles that alternate share the text of the newest of them, until that is over.
            if at - said[_words(before)] >= _LINGER or words not in said and len(said) < _REMEMBERED:
                before = before._replace(reason=event.reason, action=event.action)
        if before is None or words in said or len(said) < _REMEMBERED:
            said[words] = at
        self._momentary[event.key] = event if before is None else before._replace(time=event.time, count=before.count + 1)
        if before is None:
            self._shown_for[event.key] = _RECURS if at - self._seen_at.get(event.key, -math.inf) < _RECURS else _LINGER
            self._news.append(event)
        self._seen_at[event.key] = at

    def events(self, now: float, others: Iterable[Event], solver: SolverState) -> list[Event]:
        """Return the events that hold at ``now``, the worst first, at most one for each key.

        Parameters
        ----------
        now : [s], by the clock of those who read the events.
        others : lasting events that hold, of sinks, monitors and the flow of messages.
        solver : whose phase and losses are reported.
        """
        self._momentary = {key: event for key, event in self._momentary.items() if now - self._seen_at[key] < self._shown_for[key]}
        self._note_losses(now, solver)
        known, shown = {}, [event for event in self._momentary.values() if event.level > Level.OK]
        for event in sorted([*shown, *others, *solver_events(now, solver)], key=lambda event: -event.level):
            known.setdefault(event.key, event)
        return list(known.values())

    def news(self, events: Iterable[Event]) -> list[Event]:
        """Return the events noted since the last call, and those lasting ``events`` that did not hold then."""
        noted, self._news = self._news, []
        return noted + self._lasting.begun(event for event in events if event.key not in self._momentary)

    def _note_losses(self, now: float, solver: SolverState) -> None:
        """Turn growing loss counters into momentary events."""
        pace = solver.pace
        if pace.lost > self._lost:
            self._lost = pace.lost
            reason = (
                f"the solver or the machine is too slow: {pace.lost:.3g} s were skipped so far; "
                f"the model runs at {pace.real_time_factor:.3g} of real time, the solver alone would reach {pace.solver_factor:.3g}"
            )
            self.note(Event(now, Level.OK, "pace.lost", "", reason))  # a busy machine does that now and then; lasting losses are judged elsewhere
        if solver.dropped > self._dropped:
            self._dropped = solver.dropped
            reason = "blocks of samples were dropped because they were not collected in time"
            self.note(Event(now, Level.WARN, "output.dropped", "", reason))


def _words(event: Event) -> str:
    """Return the text of an event without its numbers, which must not make another text of it."""
    return _NUMBER.sub("", f"{event.reason}; {event.action}")


class Changes:
    """Tells changes of the events that hold: each that begins or changes its level, and each that is over, once."""

    def __init__(self):
        self.holding: dict[tuple[str, str], Event] = {}

    def begun(self, events: Iterable[Event]) -> list[Event]:
        """Return those of all events that hold now that did not at the last call, or with another level."""
        before, self.holding = self.holding, {event.key: event for event in events}
        return [event for key, event in self.holding.items() if key not in before or before[key].level != event.level]

    def update(self, now: float, events: Iterable[Event]) -> list[Event]:
        """Return the changes since the last call; ``events`` are all that hold at ``now`` [s]."""
        before, begun = self.holding, self.begun(events)
        over = sorted(before.keys() - self.holding.keys())
        return begun + [Event(now, Level.OK, kind, subject, "back within its limits") for kind, subject in over]


def solver_events(now: float, solver: SolverState) -> list[Event]:
    """Return the event that the solver's phase calls for, if any."""
    if solver.phase is Phase.CRASHED:
        return [Event(now, Level.ERROR, "solver.crashed", "", "the solver thread ended by a programming error", "outputs are held; restart the node")]
    if solver.failed_ticks:
        reason, action = "time cannot be advanced", "the last good state is held and the next inputs are tried"
        return [Event(now, Level.ERROR, "solver.failed", "", reason, action)]
    if solver.phase is Phase.WAITING:
        return [Event(now, Level.OK, "run.waiting", "", "waiting for the first shaft_speed; nothing is computed yet")]
    if solver.phase is Phase.PAUSED:
        return [Event(now, Level.OK, "run.paused", "", "paused: simulated time is held")]
    return []


def level_of(events: Sequence[Event]) -> Level:
    """Return the level of the worst of the events, which is the first."""
    return events[0].level if events else Level.OK


_ALWAYS_USED = (*REQUIRED, "run", "inputs", "pace", "governor", "slip", "life", "film", "validity", "scene", "recording")
_NOT_ALWAYS_USED = frozenset(subject.name for subject in SUBJECTS) - frozenset(_ALWAYS_USED)


def not_running(event: Event) -> Condition:
    """Return the condition of a bearing whose model does not run, for the reason that ``event`` states."""
    return Condition([event], {}, otherwise="not judged: the model does not run", unused=_NOT_ALWAYS_USED)


def remarks(gate: InputGate, solver: SolverState, level: str) -> dict[str, str]:
    """Return what is said of subjects without events while the model runs, by name.

    Parameters
    ----------
    gate : provides the inputs.
    solver : whether there are samples to judge.
    level : the level of fidelity that is computed.
    """
    said = {channel: gate.state(channel) for channel in CHANNELS} | {"run": solver.phase.value, "governor": f"level {level}"}
    return said if solver.newest is not None else dict.fromkeys(JUDGED, "not judged: there is no sample yet") | said


def numbers(gate: InputGate, solver: SolverState) -> dict[str, object]:
    """Return the numbers that every diagnostics report has, with the unit in each key."""
    pace, newest = solver.pace, solver.newest
    found = condition(newest) if newest is not None else {}
    found |= {
        "phase": solver.phase.value,
        "run time [s]": float(newest["time"]) if newest is not None else 0.0,
        "real-time factor held": pace.real_time_factor,
        "real-time factor possible": pace.solver_factor,
        "time lost [s]": pace.lost,
        "blocks dropped": solver.dropped,
        "failed ticks": solver.failed_ticks,
        "messages refused": gate.refused.total(),
    }
    return found | {f"refused: {kind}": count for kind, count in sorted(gate.refused.items())}
