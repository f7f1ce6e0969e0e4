# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Input profiles: the inputs as functions of time, from the messages that passed the gate.

`InputProfile` is that of a whole log, `OnlineInputProfile` grows while messages arrive.  Both are cut into segments (`Segment`), from instant to
instant, with the inputs at each of them: a whole log is one segment, a run that follows a clock takes many short ones.  Both kinds come from
the same functions, so the model sees the same instants and the same inputs either way.  Times are whole nanoseconds.
"""

import warnings
from bisect import bisect_left, bisect_right
from collections import Counter, deque
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import merge
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from bearing_sim.files.tally import PartlyUsedWarning, Tally
from bearing_sim.inputs.gate import OLD, REQUIRED, InputGate, covered, patience, unknown_inputs, unused_event
from bearing_sim.inputs.log import InputLog, InputLogError, ReadError, Series, usual_spacing
from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import INPUTS, MEASURED, MEASURED_CLEARANCE, RING_TEMPERATURES, TEMPERATURES
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

OIL = "oil_temperature"

_EVENTS_KEPT = 5  # of one kind and channel; all are counted
_SUBSTITUTE = "inputs are linear between good messages"

_GAP_IN_SPACINGS = 10
_JUMP = 10.0  # times as long a gap by stamps as by the clock of the recording is a jump of the stamps
_SPACINGS_KNOWN = 100  # of a channel, from which the median is taken
_FEW_SPACINGS = 3
_LONGEST_UNKNOWN = 3600.0  # [s] longest spacing that is no gap while there are only a few spacings to compare it with

_SEGMENT = 1_000_000_000  # [ns] longest segment of an online profile, so that requests are obeyed and the newest messages are used
_PRUNED = 10_000  # messages before the segment that are kept before they are dropped


class Arrival(NamedTuple):
    """Messages that have the same stamp."""

    time: float  # [s] since the start of the profile
    inputs: Inputs  # at that instant
    channels: list[str]


class Messages(NamedTuple):
    """The good messages of each channel.

    Attributes
    ----------
    stamps : by channel, [ns since the start of the profile], int64, rising; also before 0.
    values : by channel, shape (messages,) or, for the load, (messages, 2), SI.
    """

    stamps: Mapping[str, np.ndarray]
    values: Mapping[str, np.ndarray]


class Segment(NamedTuple):
    """A part of an input profile.

    Attributes
    ----------
    instants : the stamps of speed and load and the times of outputs [ns], int64, rising, shape (n,).
    inputs : at the instants, columns as `bearing_sim.simulation.Inputs`, shape (n, 6).
    is_output : whether each instant is an output, shape (n,).
    in_gap : whether the time before each instant is a gap, which is not simulated, shape (n,).
    arrived : stamps of messages of any input [ns], rising, shape (m,).
    arrived_inputs : at these, shape (m, 6).
    arrived_channels : by channel, whether it has a message with each of these stamps, shape (m,).
    """

    instants: np.ndarray
    inputs: np.ndarray
    is_output: np.ndarray
    in_gap: np.ndarray
    arrived: np.ndarray
    arrived_inputs: np.ndarray
    arrived_channels: Mapping[str, np.ndarray]

    def arrivals(self, index: int) -> Iterator[Arrival]:
        """Yield the messages stamped after instant ``index`` - 1, or the segment's start, up to instant ``index``."""
        first = 0 if index == 0 else int(np.searchsorted(self.arrived, self.instants[index - 1], "right"))
        last = int(np.searchsorted(self.arrived, self.instants[index], "right"))
        for k in range(first, last):
            channels = [channel for channel in INPUTS if channel in self.arrived_channels and self.arrived_channels[channel][k]]
            yield Arrival(float(self.arrived[k] * 1e-9), Inputs(*self.arrived_inputs[k].tolist()), channels)


def inputs_at(
    instants: np.ndarray, messages: Messages, limits: InputLimits, temperature: float, spacings: Mapping[str, float] = MappingProxyType({})
) -> np.ndarray:
    """Return the inputs at instants [ns], shape (n, 6): speed and load linear between their messages, temperatures held.

    Temperatures are held, not interpolated, because a run under way cannot know the next one.  Before the first message a temperature is that
    of the first if this comes soon; otherwise that of the oil is ``temperature``, and that of a ring is not measured, NaN.  Nor is it where the
    newest message is too old, so that the model's own temperature stands in for a sensor that has died.

    Parameters
    ----------
    instants : [ns since the start of the profile], shape (n,).
    messages : those of speed and load must enclose the instants.
    limits : see `patience_ns`.
    temperature : of the oil, of the scene [K].
    spacings : by channel, the usual spacing of a log's messages [s]; empty while a run is under way.
    """
    stamps, values = messages
    columns = np.empty((len(instants), len(Inputs._fields)))
    columns[:, 0] = np.interp(instants, stamps["shaft_speed"], values["shaft_speed"])
    for axis in range(2):
        columns[:, 1 + axis] = np.interp(instants, stamps["radial_load"], values["radial_load"][:, axis])
    for column, channel in enumerate(TEMPERATURES, start=Inputs._fields.index(OIL)):
        columns[:, column] = temperature if channel == OIL else np.nan
        known = stamps.get(channel, ())
        if len(known):
            newest = np.searchsorted(known, instants, "right") - 1
            is_known = (newest >= 0) | (known[0] <= patience_ns(limits))
            if channel in RING_TEMPERATURES:
                is_known &= instants - known[np.maximum(newest, 0)] <= patience_ns(limits, spacings.get(channel, 0.0))
            columns[is_known, column] = np.asarray(values[channel])[np.maximum(newest, 0)][is_known]
    return columns


def patience_ns(limits: InputLimits, spacing: float = 0.0) -> int:
    """Return the time [ns] for which a temperature counts: after the start for a first one, and after its stamp for that of a ring.

    See `bearing_sim.inputs.gate.patience`.
    """
    return round(patience(limits, OIL, spacing) * 1e9)


def is_gap(spacings: Sequence[int], limits: InputLimits, longest_gap: float | None = None) -> bool:
    """Return whether the last of a channel's spacings [ns] is a gap, in which the inputs are unknown.

    Parameters
    ----------
    spacings : between good messages, the last hundred or all of them.
    limits : no spacing up to ``stale_after`` is a gap.
    longest_gap : largest spacing that is not a gap [s]; by default ten times the median of those so far, and an hour if there are at most
        three.
    """
    last = int(spacings[-1])
    if longest_gap is not None:
        return last > 1e9 * longest_gap
    if last <= 1e9 * limits.stale_after:
        return False
    if len(spacings) <= _FEW_SPACINGS and last > 1e9 * _LONGEST_UNKNOWN:
        return True
    known = sorted(list(spacings)[-_SPACINGS_KNOWN:])
    return last > _GAP_IN_SPACINGS * known[(len(known) - 1) // 2]


def gaps_of(stamps: np.ndarray, limits: InputLimits, longest_gap: float | None = None) -> list[tuple[int, int]]:
    """Return the gaps (from, to) [ns] between a channel's stamps (see `is_gap`)."""
    spacings = np.diff(stamps)
    long = spacings > 1e9 * (limits.stale_after if longest_gap is None else longest_gap)
    if longest_gap is None and len(spacings) > _FEW_SPACINGS:  # no median lies below the least of all: few are left to be compared with theirs
        long[_FEW_SPACINGS:] &= spacings[_FEW_SPACINGS:] > _GAP_IN_SPACINGS * spacings.min()
    long = np.flatnonzero(long)
    return [
        (int(stamps[k]), int(stamps[k + 1]))
        for k in long.tolist()
        if is_gap(spacings[max(0, k + 1 - _SPACINGS_KNOWN) : k + 1].tolist(), limits, longest_gap)
    ]


def segment(
    messages: Messages,
    gaps: Sequence[tuple[int, int]],
    after: int,
    until: int,
    rate: float | None,
    limits: InputLimits,
    temperature: float,
    spacings: Mapping[str, float] = MappingProxyType({}),
) -> Segment:
    """Return the segment of a profile from ``after``, exclusive, to ``until``, inclusive.

    Parameters
    ----------
    messages : see `inputs_at`.
    gaps : (from, to) [ns].
    after, until : [ns]; ``after`` is -1 for a segment at the start of the profile.
    rate : outputs per simulated second [Hz], counted from the start of the profile; None for one at each stamp of speed or load.
    limits, temperature, spacings : see `inputs_at`.
    """
    stamps = {channel: _within(messages.stamps[channel], after, until) for channel in INPUTS if channel in messages.stamps}
    stops = np.unique(np.concatenate([stamps[channel] for channel in REQUIRED]))
    wanted = stops if rate is None else _outputs(rate, after, until, gaps)
    instants = np.union1d(stops, wanted)
    in_gap = np.zeros(len(instants), bool)
    for begin, end in gaps:
        in_gap |= (instants > begin) & (instants <= end)
    arrived = np.unique(np.concatenate(list(stamps.values())))
    return Segment(
        instants,
        inputs_at(instants, messages, limits, temperature, spacings),
        np.isin(instants, wanted),
        in_gap,
        arrived,
        inputs_at(arrived, messages, limits, temperature, spacings),
        {channel: np.isin(arrived, own) for channel, own in stamps.items()},
    )


def _within(stamps: np.ndarray, after: int, until: int) -> np.ndarray:
    return stamps[np.searchsorted(stamps, after, "right") : np.searchsorted(stamps, until, "right")]


def _outputs(rate: float, after: int, until: int, gaps: Sequence[tuple[int, int]]) -> np.ndarray:
    """Return the times of outputs outside of gaps, which may be years long."""
    spans, begin = [], after
    for gap_begin, gap_end in sorted(gaps):
        if gap_end > begin:
            spans.append((begin, min(gap_begin, until)))
            begin = gap_end
    spans.append((begin, until))
    found = [np.zeros(0, np.int64)]
    for begin, end in spans:
        if end > begin:
            numbers = np.arange(int(max(begin, 0) * 1e-9 * rate * (1 - 1e-12)), int(end * 1e-9 * rate * (1 + 1e-12)) + 2)
            times = np.round(numbers * (1e9 / rate)).astype(np.int64)
            found.append(times[(times > begin) & (times <= end)])
    return np.concatenate(found)


@dataclass(frozen=True)
class InputProfile:
    """Inputs as functions of time, speed and load linear between accepted messages, temperatures held (see `inputs_at`).

    Time 0 is the first instant at which shaft speed and radial load are both known; the profile ends where the first of them ends.

    Attributes
    ----------
    start_ns : time 0 [ns since the epoch].
    stamps : by channel, the accepted stamps [ns since time 0], int64, rising; before 0 and after the end too.
    values : by channel, shape (messages,) or, for the load, (messages, 2).
    end : last instant [ns since time 0].
    gaps : (from, to) [ns since time 0] without a good message of speed or load; these are not simulated.
    events : in order of time; of one kind and channel only the first few, and one that counts the rest.
    tally : the messages of all channels: how many there were, were used, and were not and why.
    limits : that they were judged by.
    log_seconds : for how long the log has messages of both speed and load, whether good or refused.
    unknown_seconds : for how long of that inputs are unknown, because their messages were refused.
    dropped_seconds : for how long of that, by the clock of the recording, stamps were not later than the last one; it is not simulated.
    verdict : what that means for lives and damage (see `bearing_sim.inputs.gate.Coverage`).
    spacings : by channel, the usual spacing of the log's messages [s].
    """

    start_ns: int
    stamps: dict[str, np.ndarray]
    values: dict[str, np.ndarray]
    end: int
    gaps: list[tuple[int, int]]
    events: list[Event]
    tally: Tally
    limits: InputLimits
    log_seconds: float
    unknown_seconds: float
    dropped_seconds: float
    verdict: str
    spacings: Mapping[str, float]

    @property
    def unknown_event(self) -> Event:
        """The event at the end that says for how long inputs are unknown, and what that means."""
        event = unknown_inputs(self.end * 1e-9, self.unknown_seconds, self.log_seconds, self.verdict)
        if not self.dropped_seconds:
            return event
        action = f"{self.dropped_seconds:.4g} s of that are not simulated, because their stamps are not later than the last one"
        return event._replace(action=f"{action}; {event.action}" if self.unknown_seconds > self.dropped_seconds else action)

    @property
    def instants(self) -> np.ndarray:
        """Stamps of speed and load from time 0 to the end [ns], each once, int64."""
        together = np.unique(np.concatenate([self.stamps[channel] for channel in REQUIRED]))
        return together[(together >= 0) & (together <= self.end)]

    def at(self, instants: np.ndarray, oil_temperature: float) -> np.ndarray:
        """Return the inputs at instants [ns since time 0] (`inputs_at`); ``oil_temperature`` [K] where none is known."""
        return inputs_at(instants, Messages(self.stamps, self.values), self.limits, oil_temperature, self.spacings)

    def segment(self, rate: float | None, oil_temperature: float) -> Segment:
        """Return the whole profile as one segment (see `segment`), with ``rate`` outputs per second [Hz]."""
        messages = Messages(self.stamps, self.values)
        return segment(messages, self.gaps, -1, self.end, rate, self.limits, oil_temperature, self.spacings)

    @property
    def measured(self) -> list[tuple[float, float, float]]:
        """Times [s] of measured cage speeds, the speeds, and their standard errors (NaN where they are not known) [rad/s], in order."""
        return self._readings(MEASURED)

    @property
    def measured_clearance(self) -> list[tuple[float, float, float]]:
        """Times [s] of measured clearances, the clearances, and their standard errors (NaN where they are not known) [m], in order."""
        return self._readings(MEASURED_CLEARANCE)

    def _readings(self, channel: str) -> list[tuple[float, float, float]]:
        if channel not in self.stamps:
            return []
        values, errors = self.values[channel].reshape(-1, 2).T.tolist()
        return list(zip((self.stamps[channel] * 1e-9).tolist(), values, errors))


def judge(log: InputLog, limits: InputLimits, held: Inputs, longest_gap: float | None = None, heat_law: str = "none") -> InputProfile:
    """Pass every message of a log through the gate, each channel in the order of recording.

    Silence and rate of a channel are judged by the log's own rate, which nobody chose for this scene: a table with a row every ten minutes
    is as good as one with ten a second.

    Parameters
    ----------
    log : the recording's messages.
    limits : what a message may be.
    held : inputs before the first message.
    longest_gap : spacing of good messages [s] above which the time between them is a gap; by default ten times the channel's median
        spacing so far, and at least ``limits.stale_after`` (`is_gap`).
    heat_law : the scene's; with ``none``, measured temperatures of rings are left out, which an event says.

    Warns
    -----
    PartlyUsedWarning
        Messages were refused or could not be read; ``tally`` of the result counts them.

    Raises
    ------
    InputLogError
        There is no time for which good messages of both shaft speed and radial load are known.
    """
    spacings = {channel: usual_spacing(series.stamps) * 1e-9 for channel, series in log.series.items()}
    gate = InputGate(limits, held, _SUBSTITUTE, heat_law, spacings)
    epoch = log.series["shaft_speed"].stamps[0]
    unused = [channel for channel in RING_TEMPERATURES if channel in log.series and heat_law == "none"]
    used = {channel: series for channel, series in log.series.items() if channel not in unused}
    stamps: dict[str, list[int]] = {channel: [] for channel in used}
    values: dict[str, list] = {channel: [] for channel in used}
    events = _Events()
    for channel in unused:
        events.add(unused_event(0.0, channel))
    seen: dict[str, tuple[float, float]] = {}  # first and last time of messages that are good, or refused for their values
    newest, old = -np.inf, _OldStamps()
    for channel, stamp, log_ns, given in _in_order(used):
        if isinstance(given, ReadError):
            events.add(gate.refuse(channel, max(newest, 0.0), given.kind, given.reason))
            continue
        time = (stamp - epoch) * 1e-9
        if time > newest:
            newest = time
            gate.expire(time)
            for event in gate.onsets(time):
                events.add(event)
        refusal = gate.offer(channel, time, given)
        old.receive(channel, stamp, log_ns, "" if refusal is None else refusal.kind)
        for event in gate.drain_returned():
            events.add(event)
        if refusal is None or gate.coverage.is_unknown(channel):
            first, last = seen.get(channel, (time, time))
            seen[channel] = min(first, time), max(last, time)
        if refusal is not None:
            events.add(refusal)
            continue
        stamps[channel].append(stamp)
        values[channel].append(gate.latest(channel))
    start, end = _overlap(log, stamps, gate.refused)
    if log.unfinished:
        events.add(Event((end - epoch) * 1e-9, Level.WARN, "log.unfinished", "", log.unfinished))
    tally = Tally(there=gate.accepted.total() + gate.refused.total(), used=gate.accepted.total(), refused=gate.refused.copy())
    tally.add([log.lost])
    rising = {channel: np.array(times, np.int64) - start for channel, times in stamps.items()}
    gaps = []
    ill_stamped = old.channels | {name for name, series in used.items() if any(error.kind == "input.not_stamped" for error in series.errors)}
    for channel in REQUIRED:
        own = gaps_of(rising[channel], limits, longest_gap)
        gaps += own
        for gap in own:
            events.add(gap_event((gap[0] + start - epoch) * 1e-9, channel, gap))
        if jumps := _jumps_of_stamps(channel, log.series[channel], [(gap[0] + start, gap[1] + start) for gap in own]):
            tally.notes += jumps
            ill_stamped.add(channel)
        _count_alone(tally, channel, rising, end - start, limits, spacings)
    shift = (epoch - start) * 1e-9
    kept = sorted((event._replace(time=event.time + shift) for event in events.kept()), key=lambda event: event.time)
    arrays = {channel: np.array(given, float) for channel, given in values.items()}
    begun, ended = max(seen[channel][0] for channel in REQUIRED), min(seen[channel][1] for channel in REQUIRED)
    if ill_stamped and all(_has_clock(log.series[channel]) for channel in ill_stamped):
        tally.remedies.append("--stamps log takes the times of recording instead of the stamps in the headers")
    if not tally.is_whole:
        warnings.warn(f"{log.path}: {tally.text}", PartlyUsedWarning, stacklevel=2)
    dropped = old.seconds()
    seconds = max(ended - begun, _logged_seconds(log)) if dropped else ended - begun
    unknown = min(gate.coverage.unknown_until(ended, begun) + dropped, seconds)
    return InputProfile(start, rising, arrays, end - start, gaps, kept, tally, limits, seconds, unknown, dropped, gate.coverage.verdict, spacings)


class _OldStamps:
    """For how long, by the clock of the recording, messages of speed or load were refused for their stamps and no later stamp makes up for it.

    A message out of order costs no time, nor do stamps that stand still for a while and then go on where the clock is.

    Attributes
    ----------
    channels : that had such messages.
    """

    def __init__(self):
        self.channels: set[str] = set()
        self._good: dict[str, tuple[int, int]] = {}  # by channel, stamp and log time of the last good message [ns]
        self._runs: dict[str, list[int]] = {}  # by channel, of the refused messages since then: first and last log time [ns], number
        self._spans: list[tuple[int, int]] = []

    def receive(self, channel: str, stamp: int, log_ns: int, refusal: str) -> None:
        """Receive a message with its stamp and log time [ns]; ``refusal`` is the kind of its event, ``""`` if it is good."""
        if refusal in OLD:
            self.channels.add(channel)
            run = self._runs.setdefault(channel, [log_ns, log_ns, 0])
            run[1], run[2] = log_ns, run[2] + 1
        elif not refusal:
            if channel in self._runs:
                before = self._good[channel]
                self._close(channel, (log_ns - before[1]) - (stamp - before[0]))
            self._good[channel] = stamp, log_ns

    def _close(self, channel: str, most: float = np.inf) -> None:
        first, last, count = self._runs.pop(channel)
        seconds = min((last - first) * count / max(count - 1, 1), most)  # with the time up to the next one
        if channel in REQUIRED and seconds > 0:
            self._spans.append((first, first + seconds))

    def seconds(self) -> float:
        """Return for how long [s], once both channels have ended."""
        for channel in list(self._runs):
            self._close(channel)
        return covered(self._spans) * 1e-9


def _has_clock(series: Series) -> bool:
    """Whether the times of recording can stand in for stamps: most of them differ, unlike those of a converted file."""
    return series.stamped_by == "header" and 2 * len(set(series.log_times)) > len(series.log_times)


def _logged_seconds(log: InputLog) -> float:
    """Return for how long the log has messages of both speed and load by the clock of the recording."""
    times = [log.series[channel].log_times for channel in REQUIRED if log.series[channel].topic]
    return (min(each[-1] for each in times) - max(each[0] for each in times)) * 1e-9


def _jumps_of_stamps(channel: str, series: Series, gaps: Sequence[tuple[int, int]]) -> list[str]:
    """Return in words which gaps [ns since the epoch] are there by the stamps only, but not by the clock of the recording."""
    if not gaps or not _has_clock(series):
        return []
    logged = dict(zip(series.stamps, series.log_times))
    jumps = [(end - begin, logged[end] - logged[begin]) for begin, end in gaps if end - begin > _JUMP * (logged[end] - logged[begin])]
    if not jumps:
        return []
    stamps, clock = (1e-9 * each for each in max(jumps))
    return [f"{channel}: stamps jump by {stamps:.4g} s within {clock:.3g} s of recording; --stamps log takes the times of recording"]


def _count_alone(tally: Tally, channel: str, stamps: Mapping[str, np.ndarray], end: int, limits: InputLimits, spacings: Mapping[str, float]) -> None:
    """Count good messages of speed or load as not used that are far from any of the other channel, which has not begun or has ended."""
    (other,) = (each for each in REQUIRED if each != channel)
    near = round(patience(limits, other, spacings[other]) * 1e9)
    alone = int((stamps[channel] < -near).sum() + (stamps[channel] > end + near).sum())
    if alone:
        tally.used -= alone
        tally.refused[f"no {other} at that time"] += alone


def gap_event(time: float, channel: str, gap: tuple[int, int]) -> Event:
    """Return the event of a gap (from, to) [ns] between a channel's good messages."""
    reason = f"no good message for {(gap[1] - gap[0]) * 1e-9:.4g} s"
    return Event(time, Level.WARN, "input.gap", channel, reason, "this time is not simulated, the state is held")


def _in_order(found: Mapping[str, Series]) -> Iterator[tuple[str, int, int, tuple | ReadError]]:
    """Yield (channel, stamp, log time, values or error): each channel in the order of recording, all channels merged by the newest stamp so far.

    Log times do not order the channels among each other, because a sender may lag behind.
    """

    def messages(channel):
        series = found[channel]
        good = zip(series.log_times, series.stamps, series.values)
        bad = ((error.log_ns, None, error) for error in series.errors)
        newest = series.stamps[0] if series.stamps else 0
        for log_ns, stamp, given in merge(good, bad, key=lambda message: message[0]):
            newest = max(newest, stamp or newest)
            yield newest, channel, stamp, log_ns, given

    for _, *message in merge(*map(messages, found), key=lambda message: message[0]):
        yield message


class _Events:
    """The first few events of each kind and channel, and how many more there were."""

    def __init__(self):
        self._kept: list[Event] = []
        self._counts: Counter[tuple[str, str]] = Counter()
        self._last: dict[tuple[str, str], Event] = {}

    def add(self, event: Event) -> None:
        self._counts[event.key] += 1
        self._last[event.key] = event
        if self._counts[event.key] <= _EVENTS_KEPT:
            self._kept.append(event)

    def kept(self) -> list[Event]:
        more = [(self._last[key], count - _EVENTS_KEPT) for key, count in self._counts.items() if count > _EVENTS_KEPT]
        return self._kept + [last._replace(reason=f"{count} more of {last.kind}, the last one: {last.reason}", count=1) for last, count in more]


def _overlap(log: InputLog, stamps: dict[str, list[int]], refused: Counter) -> tuple[int, int]:
    empty = [channel for channel in REQUIRED if not stamps[channel]]
    if empty:
        counts = ", ".join(f"{count} x {kind}" for kind, count in sorted(refused.items())) or "no reason given"
        raise InputLogError(f"{log.path}: every message of {' and '.join(empty)} was refused: {counts}")
    start, end = max(stamps[channel][0] for channel in REQUIRED), min(stamps[channel][-1] for channel in REQUIRED)
    if end <= start:
        spans = "; ".join(
            f"{channel} from {stamps[channel][0] * 1e-9:.3f} to {stamps[channel][-1] * 1e-9:.3f} s by {log.series[channel].stamped_by}"
            for channel in REQUIRED
        )
        hint = "the times of recording may agree better than the stamps in the headers: --stamps log"
        raise InputLogError(f"{log.path}: there is no time at which both shaft speed and radial load are known ({spans}); {hint}")
    return start, end


class OnlineInputProfile:
    """An input profile that grows while messages arrive, and the segments that it allows.

    Topics have no common order: a load may arrive before or after a speed with the same stamp.  Speed and load are linear between their
    messages, so an instant is known once each of the two has a message stamped at or after it, in whatever order they arrived; neither can be
    late.  Temperatures are held, so each is known at an instant once a later message has arrived, or the clock passed the instant long
    enough ago for its messages to have arrived; a message that arrives later than that is late, and refused.

    Parameters
    ----------
    rate : outputs per simulated second [Hz].
    limits : of the scene.
    temperature : of the oil before the first message or set [K].
    channels : the inputs that messages may carry.

    Attributes
    ----------
    start : int or None
        Stamp at which speed and load are both known first [ns since the epoch]; None before.
    claimed : int
        End of the last segment that was taken [ns since the epoch].
    """

    def __init__(self, rate: float, limits: InputLimits, temperature: float, channels: Collection[str] = (*REQUIRED, OIL)):
        self._rate, self._limits, self._temperature = rate, limits, temperature
        self._stamps: dict[str, list[int]] = {channel: [] for channel in channels}
        self._values: dict[str, list] = {channel: [] for channel in channels}
        self._held = [channel for channel in channels if channel in TEMPERATURES]
        self._newest: dict[str, int] = {}  # stamps of the newest messages of temperatures; sets are in _stamps too
        self._spacings = {channel: deque(maxlen=_SPACINGS_KNOWN) for channel in REQUIRED}
        self._gaps: list[tuple[int, int]] = []
        self.start: int | None = None
        self.claimed = self._reached = -1

    def add_message(self, channel: str, stamp: int, value) -> tuple[int, int] | None:
        """Add a good message, stamped [ns since the epoch] later than the last one of its channel, with its value in SI.

        Returns
        -------
        The gap that it ends [ns since the epoch], or None.

        Raises
        ------
        ValueError
            The model has already passed its stamp; the message changes nothing.
        """
        stamps = self._stamps[channel]
        if stamp <= self.claimed:
            raise ValueError(f"stamped {stamp * 1e-9:.6f} s, which the model has passed by {(self.claimed - stamp) * 1e-9:.3g} s")
        gap = None
        if channel in REQUIRED and stamps:
            self._spacings[channel].append(stamp - stamps[-1])
            if is_gap(self._spacings[channel], self._limits):
                gap = (stamps[-1], stamp)
                self._gaps.append(gap)
        if channel in self._held:
            self._newest[channel] = stamp
        self._insert(channel, stamp, value)
        if self.start is None and all(self._stamps[required] for required in REQUIRED):
            self.start = max(self._stamps[required][0] for required in REQUIRED)
        return gap

    def set_oil_temperature(self, stamp: int | None, temperature: float) -> None:
        """Set the oil temperature [K] from ``stamp`` on [ns since the epoch], or from where the model is if it has passed that already.

        It is no message: the model neither waits for more of them nor treats the temperature as known before ``stamp``.  A replay of the
        recorded inputs gives the same temperatures: the one before the first set is recorded just before it.

        Parameters
        ----------
        stamp : None for a set before there is a clock, which counts from the start.
        temperature : [K].
        """
        if stamp is None:
            self._temperature = temperature
            return
        stamp = max(stamp, self.claimed + 1)
        if not self._stamps[OIL]:
            self._insert(OIL, stamp, self._temperature)
            stamp += 1
        self._insert(OIL, stamp, temperature)

    def _insert(self, channel: str, stamp: int, value) -> None:
        stamps = self._stamps[channel]
        k = bisect_right(stamps, stamp)
        if k and stamps[k - 1] == stamp:  # a set at the clock's reading, and another one or a message with the same stamp
            self._values[channel][k - 1] = value
            return
        stamps.insert(k, stamp)
        self._values[channel].insert(k, value)

    def awaited(self, settled: int, expected: Collection[str]) -> list[str]:
        """Return the channels that an advance to the instant ``settled`` waits for (see `known_until`)."""
        if missing := [channel for channel in REQUIRED if not self._stamps[channel]]:
            return missing
        last = min(REQUIRED, key=lambda channel: self._stamps[channel][-1])
        if self._stamps[last][-1] < settled:
            return [last]
        return [channel for channel in self._held if channel in expected and self._held_until(channel, settled) < settled]

    def known_until(self, clock: int, settled: int, expected: Collection[str]) -> int:
        """Return the last instant at which everything is known [ns since the epoch]; -1 if there is none.

        Parameters
        ----------
        clock : now [ns since the epoch]; nothing acts before its time.
        settled : an earlier reading of the clock, old enough for every message stamped before it to have arrived [ns since the epoch].
        expected : the temperatures that have a publisher.
        """
        if self.start is None:
            return -1
        known = min(clock, *(self._stamps[channel][-1] for channel in REQUIRED))
        for channel in self._held:
            if channel in expected or channel in self._newest:
                known = min(known, self._held_until(channel, settled))
            elif settled < self.start:  # a publisher of it may not have been discovered yet
                return -1
        return known if known >= self.start else -1

    def _held_until(self, channel: str, settled: int) -> int:
        if channel in self._newest:
            return max(self._newest[channel], settled)
        return settled if self.start is not None and settled > self.start + patience_ns(self._limits) else -1

    def claim(self, known_until: int) -> Segment | None:
        """Return the next segment, up to ``known_until`` [ns since the epoch] or a second long, or None if there is none yet."""
        if known_until <= self.claimed or known_until < 0:
            return None
        start = self.start
        after = start - 1 if self.claimed < 0 else self._reached
        until = min(known_until, self._end_of_gap(max(after, start) + _SEGMENT, after))
        gaps = [(begin - start, end - start) for begin, end in self._gaps]
        found = segment(self._messages(after, until), gaps, after - start, until - start, self._rate, self._limits, self._temperature)
        self.claimed = until
        if len(found.instants):
            self._reached = start + int(found.instants[-1])
            self._forget()
        return found

    def _end_of_gap(self, until: int, after: int) -> int:
        """Return ``until``, or the end of a gap that contains it or that it would cut."""
        return max([until, *(end for begin, end in self._gaps if begin <= after or begin < until < end)])

    def _messages(self, after: int, until: int) -> Messages:
        """Return the messages that determine the inputs from ``after`` to ``until``, relative to the start."""
        stamps, values = {}, {}
        for channel, own in self._stamps.items():
            if not own:
                continue
            begin, end = max(bisect_right(own, after) - 1, 0), bisect_left(own, until) + 1
            stamps[channel] = np.array(own[begin:end], np.int64) - self.start
            values[channel] = np.array(self._values[channel][begin:end], float)
        return Messages(stamps, values)

    def _forget(self) -> None:
        self._gaps = [gap for gap in self._gaps if gap[1] > self._reached]
        for channel, own in self._stamps.items():
            over = bisect_right(own, self._reached) - 1
            if over > _PRUNED:
                del own[:over], self._values[channel][:over]

    @property
    def waiting(self) -> int:
        """Messages that the model has not reached."""
        return sum(len(own) - bisect_right(own, self.claimed) for own in self._stamps.values())
