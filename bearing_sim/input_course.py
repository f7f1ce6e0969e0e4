# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The course of the inputs over a run: the messages of a log that passed the gate, and what was wrong with the others."""

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from heapq import merge

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.input_log import REQUIRED, Fault, InputLog, InputLogError
from bearing_sim.runtime.input_gate import InputGate
from bearing_sim.scene import InputLimits
from bearing_sim.simulation import Inputs
from bearing_sim.topics import MEASURED

_EVENTS_TOLD = 5  # of one code and channel; all are counted
_GAP_IN_SPACINGS = 10


@dataclass(frozen=True)
class InputCourse:
    """Inputs as functions of time, linear between accepted messages.

    Time 0 is the first instant at which shaft speed and radial load are both known; the course ends with the first of them
    that ends.

    Attributes
    ----------
    start_ns : time 0 [ns since the epoch].
    stamps : by channel, the accepted stamps [ns since time 0], int64, rising; before 0 and after the end too.
    values : by channel, shape (messages,) or, for the load, (messages, 2).
    end : last instant [ns since time 0].
    gaps : (from, to) [ns since time 0] without a good message of speed or load; not to be simulated.
    events : what a person should be told, in order of time; of one kind only the first few.
    refused : messages refused, by event code.
    messages : messages offered.
    """

    start_ns: int
    stamps: dict[str, np.ndarray]
    values: dict[str, np.ndarray]
    end: int
    gaps: list[tuple[int, int]]
    events: list[Event]
    refused: Counter
    messages: int

    @property
    def instants(self) -> np.ndarray:
        """Stamps of speed and load from time 0 to the end [ns], each once, int64."""
        together = np.unique(np.concatenate([self.stamps[channel] for channel in REQUIRED]))
        return together[(together >= 0) & (together <= self.end)]

    def at(self, instants: np.ndarray, oil_temperature: float) -> np.ndarray:
        """Return the inputs at instants [ns since time 0], shape (instants, 4), columns as `bearing_sim.simulation.Inputs`.

        The oil temperature is held before its first and after its last message; ``oil_temperature`` [K] where there is none.
        """
        columns = np.empty((len(instants), 4))
        columns[:, 0] = np.interp(instants, self.stamps["shaft_speed"], self.values["shaft_speed"])
        for axis in range(2):
            columns[:, 1 + axis] = np.interp(instants, self.stamps["radial_load"], self.values["radial_load"][:, axis])
        temperatures = self.stamps.get("oil_temperature", ())
        columns[:, 3] = np.interp(instants, temperatures, self.values["oil_temperature"]) if len(temperatures) else oil_temperature
        return columns


def judge(log: InputLog, limits: InputLimits, held: Inputs, longest_gap: float | None = None) -> InputCourse:
    """Pass every message of a log through the gate, each channel in the order of recording.

    Parameters
    ----------
    log : the recording's messages.
    limits : what a message may be.
    held : inputs before the first message.
    longest_gap : spacing of good messages [s] above which the time between them counts as a gap; by default ten times the
        channel's median spacing, and no less than ``limits.stale_after``.

    Raises
    ------
    InputLogError
        No time is left in which good messages of both shaft speed and radial load are known.
    """
    gate = InputGate(limits, held)
    epoch = log.series["shaft_speed"].stamps[0]
    stamps: dict[str, list[int]] = {channel: [] for channel in log.series}
    values: dict[str, list] = {channel: [] for channel in log.series}
    events = _Events()
    newest = -np.inf
    messages = 0
    for channel, stamp, given in _in_order(log):
        messages += 1
        if isinstance(given, Fault):
            events.add(gate.refuse(channel, max(newest, 0.0), given.code, given.reason))
            continue
        time = (stamp - epoch) * 1e-9
        if time > newest:
            newest = time
            events.extend(gate.onsets(time))
        fault = gate.offer(channel, time, given)
        if fault is not None:
            events.add(fault)
            continue
        stamps[channel].append(stamp)
        values[channel].append(_accepted(gate, channel))
    start, end = _overlap(log, stamps, gate.refused)
    if log.unfinished:
        events.add(Event((end - epoch) * 1e-9, Level.WARN, "log.unfinished", log.unfinished))
    rising = {channel: np.array(times, np.int64) - start for channel, times in stamps.items()}
    gaps = []
    for channel in REQUIRED:
        for gap in _gaps(rising[channel], limits.stale_after, longest_gap):
            gaps.append(gap)
            text = f"{channel}: no good message for {(gap[1] - gap[0]) * 1e-9:.3g} s; this time is not simulated, the state is held"
            events.add(Event((gap[0] + start - epoch) * 1e-9, Level.WARN, "input.gap", text))
    shift = (epoch - start) * 1e-9
    told = sorted((event._replace(time=event.time + shift) for event in events.told()), key=lambda event: event.time)
    arrays = {channel: np.array(given, float) for channel, given in values.items()}
    return InputCourse(start, rising, arrays, end - start, gaps, told, gate.refused, messages)


def _accepted(gate: InputGate, channel: str) -> float | tuple[float, float]:
    """Return what a channel's last good message said."""
    if channel == MEASURED:
        return gate.measured
    held = gate.held
    return held.shaft_speed if channel == "shaft_speed" else (held.load_y, held.load_z) if channel == "radial_load" else held.oil_temperature


def _in_order(log: InputLog) -> Iterator[tuple[str, int, tuple | Fault]]:
    """Yield (channel, stamp, values or fault): each channel in the order of recording, all together by the newest stamp so far.

    Log times do not order the channels among each other: a sender may lag behind.
    """

    def messages(channel):
        series = log.series[channel]
        good = zip(series.log_times, series.stamps, series.values)
        bad = ((fault.log_ns, None, fault) for fault in series.faults)
        newest = series.stamps[0] if series.stamps else 0
        for _, stamp, given in merge(good, bad, key=lambda message: message[0]):
            newest = max(newest, stamp or newest)
            yield newest, channel, stamp, given

    for _, channel, stamp, given in merge(*map(messages, log.series), key=lambda message: message[0]):
        yield channel, stamp, given


class _Events:
    """The first few events of each code and channel, and how many more there were."""

    def __init__(self):
        self._told: list[Event] = []
        self._counts: Counter[tuple[str, str]] = Counter()
        self._last: dict[tuple[str, str], Event] = {}

    def add(self, event: Event) -> None:
        # The gate speaks of live inputs, which are held; those of a log are known before and after.
        event = event._replace(text=re.sub(r"([,;]) holding .*$", r"\1 inputs go linearly between good messages", event.text))
        kind = (event.code, event.text.partition(":")[0])
        self._counts[kind] += 1
        self._last[kind] = event
        if self._counts[kind] <= _EVENTS_TOLD:
            self._told.append(event)

    def extend(self, events: list[Event]) -> None:
        for event in events:
            self.add(event)

    def told(self) -> list[Event]:
        more = [
            self._last[kind]._replace(text=f"{kind[1]}: {count - _EVENTS_TOLD} more of {kind[0]}, the last one: {self._last[kind].text}")
            for kind, count in self._counts.items()
            if count > _EVENTS_TOLD
        ]
        return self._told + more


def _overlap(log: InputLog, stamps: dict[str, list[int]], refused: Counter) -> tuple[int, int]:
    empty = [channel for channel in REQUIRED if not stamps[channel]]
    if empty:
        raise InputLogError(f"{log.path}: every message of {' and '.join(empty)} was refused: {_counted(refused)}")
    start, end = max(stamps[channel][0] for channel in REQUIRED), min(stamps[channel][-1] for channel in REQUIRED)
    if end <= start:
        spans = "; ".join(
            f"{channel} from {stamps[channel][0] * 1e-9:.3f} to {stamps[channel][-1] * 1e-9:.3f} s by {log.series[channel].stamped_by}"
            for channel in REQUIRED
        )
        hint = "log times may agree better than header stamps"
        raise InputLogError(f"{log.path}: shaft speed and radial load are never known together ({spans}); {hint}")
    return start, end


def _counted(refused: Counter) -> str:
    return ", ".join(f"{count} x {code}" for code, count in sorted(refused.items())) or "no reason given"


def _gaps(stamps: np.ndarray, stale_after: float, longest_gap: float | None) -> list[tuple[int, int]]:
    spacings = np.diff(stamps)
    if len(spacings) == 0:
        return []
    longest = 1e9 * longest_gap if longest_gap is not None else max(1e9 * stale_after, _GAP_IN_SPACINGS * float(np.median(spacings)))
    return [(int(stamps[place]), int(stamps[place + 1])) for place in np.flatnonzero(spacings > longest)]
