# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What decides about every input message: the gate, several publishers on one channel, and messages around a jump of the clock.

Values, counts and times in, events out; no clock and no ROS.  The node and the replay of recordings use the same gate, so a log is
judged exactly as it would have been live.
"""

import math
from collections import Counter, deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import NamedTuple

from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import (
    MEASURED,
    MEASURED_CHANNELS,
    MEASURED_CLEARANCE,
    RING_TEMPERATURES,
    TEMPERATURES,
    ZERO_CELSIUS,
    input_types,
)
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

CHANNELS = ("shaft_speed", "radial_load", *TEMPERATURES, *MEASURED_CHANNELS)  # the last are compared with the model, not inputs of it
REQUIRED = ("shaft_speed", "radial_load")
UNITS = {"shaft_speed": "rad/s", "radial_load": "N", **dict.fromkeys(TEMPERATURES, "K"), MEASURED: "rad/s", MEASURED_CLEARANCE: "m"}
"""SI unit of the values of each channel."""
TOPIC_UNITS = UNITS | dict.fromkeys(TEMPERATURES, "degC")
"""Unit of the values of each channel's topic; events name values in it."""

_SCALAR = "std_msgs/msg/Float64"
_OPTIONAL = (*TEMPERATURES, *MEASURED_CHANNELS)
_RATE_WINDOW = 1.0  # [s] a rate is the number of messages over at least this long
_RATE_TOLERANCE = 0.1  # relative, because timers jitter
# Oil and rings warm up in minutes, and the clearance changes with them: their messages may be rarer by this factor.
_SLOW_CHANNEL = dict.fromkeys((*TEMPERATURES, MEASURED_CLEARANCE), 10.0)
_LARGEST_CLEARANCE = 0.01  # [m] beyond that of any rolling bearing: a measured one in another unit than metres
_TIMELY = 0.5  # of its patience: a channel is late until a message follows another one within this, or ten come in time, so that jitter
_LATE_FOR = 10  # around the patience does not alternate
_SPACINGS_OF_RATE = 10.0  # of a log: over at least this many a rate is counted, so that one missing row is no change of rate
_SPACINGS_OF_SILENCE = 3.0  # of a log: a message may be late by this factor of its channel's usual spacing
_RISING_TO_FOLLOW = 3  # refused messages in a row with rising stamps after which the sender's clock counts as set

_REMEMBERED = 16  # values of a channel in which a conflict of publishers is looked for
_CONFLICT_TOLERANCE = 0.02  # of the largest value: publishers that differ by less measure the same quantity
_REVERSALS = 4  # large jumps against the jump before, among the values remembered: one or two are a manoeuvre

_FAR_AT_LEAST = 2.0  # [s] for which a stamp far from the clock is reported, so that reports at 1 Hz do not alternate where some stamps are good
_DISAGREE_AT_LEAST = 5.0  # [s] likewise for publishers that disagree: messages of two do not always alternate

_SET_ASIDE = 1.0  # [s of wall time] in which a jump of the clock may become known

# By kind of event and channel, the field of a scene that is the bound.
_BOUNDS = {
    ("input.too_large", "shaft_speed"): "input_limits.maximum_speed",
    ("input.too_large", "radial_load"): "input_limits.maximum_load",
    ("input.negative", "shaft_speed"): "input_limits.reverse_rotation",
    **{("input.too_large", channel): "input_limits.maximum_temperature" for channel in TEMPERATURES},
    **{("input.too_small", channel): "input_limits.minimum_temperature" for channel in TEMPERATURES},
}
_STANDS_IN = {
    "none": "it is not used",
    "given": "the temperature given in the scene stands in",
    "network": "the temperature of the thermal network stands in",
}
"""What is used where the temperature of a ring is not measured, by the law of heat."""
OLD = ("input.time_repeated", "input.time_backwards")
"""Refusals that leave nothing unknown at the stamp: a later message is known.  What a recording loses by them `bearing_sim.inputs.profile` counts."""

_SPANS_KEPT = 1000  # of unknown inputs; then old ones are summed up


@dataclass
class _Channel:
    """State of one channel: newest stamp, newest arrival, and the count of the open rate window."""

    least: float  # values from here ...
    largest: float  # ... to here are good
    is_force: bool
    patience: float  # age from which on it is stale [s]
    stamp: float = -math.inf
    arrival: float = -math.inf
    late: int = 0  # good messages that must come in time until the channel is not late any more
    returned: float = -math.inf  # the newest good message of a channel that is late
    is_rate_wrong: bool = False
    offset: float = math.nan  # of the newest stamp from the receiver's clock [s]
    far_offset: float = math.nan  # the newest offset beyond the tolerance [s]
    far_at: float = -math.inf  # when that message was received
    refused: float = -math.inf  # the newest refused message
    seen: bool = False
    received: float = -math.inf  # the newest message, good or not
    window_start: float = math.nan
    window_count: int = 0
    rate: float = math.nan
    earlier_stamp: float = -math.inf
    earlier_count: int = 0


class Coverage:
    """The time for which inputs are unknown, because their messages were refused, unless only for an old stamp.

    It lasts, on each channel, from the last good message before a refused one, or the refused one if there is none, to the next good one.
    Times of several channels are counted once where they overlap; after a thousand of them, a channel that has been silent since is not
    waited for.

    Attributes
    ----------
    bounds : the fields of a scene that changed the verdict, such as ``input_limits.maximum_load``.
    is_overloaded : whether a speed or load was refused because it is too large, so that damage is at least, and life at most, what is computed.
    """

    def __init__(self):
        self._good: dict[str, float] = {}
        self._unknown: dict[str, float] = {}  # since when, of the channels that are unknown now
        self._spans: list[tuple[float, float]] = []  # (from, to), which may overlap
        self._seconds, self._settled = 0.0, -math.inf  # sum of older spans, and up to when they are summed up
        self.bounds: list[str] = []
        self.is_overloaded = False

    def note_good(self, channel: str, time: float) -> None:
        """Note a good message of a channel."""
        self._good[channel] = time
        if channel in self._unknown:
            self._spans.append((self._unknown.pop(channel), time))
            if len(self._spans) > _SPANS_KEPT:
                self._settle(max(min(*self._good.values(), *self._unknown.values()), self._spans[_SPANS_KEPT // 2][1]))

    def note_refused(self, channel: str, time: float, kind: str) -> None:
        """Note a refused message of a channel; ``kind`` is that of its event."""
        if kind in OLD or channel in MEASURED_CHANNELS or channel in RING_TEMPERATURES:  # the model predicts what these measure
            return
        self._unknown.setdefault(channel, max(self._good.get(channel, time), self._settled))
        self.is_overloaded = self.is_overloaded or (kind == "input.too_large" and channel in REQUIRED)
        bound = _BOUNDS.get((kind, channel))
        if bound is not None and bound not in self.bounds:
            self.bounds.append(bound)

    def is_unknown(self, channel: str) -> bool:
        """Whether a channel has had no good message since one was refused."""
        return channel in self._unknown

    def unknown_until(self, now: float, since: float = -math.inf) -> float:
        """Return the time for which inputs were unknown up to ``now`` [s], from ``since`` [s] on."""
        spans = [*self._spans, *((begin, now) for begin in self._unknown.values())]
        return self._seconds + covered((max(begin, since), min(end, now)) for begin, end in spans)

    def _settle(self, limit: float) -> None:
        """Sum up the spans as far as ``limit`` [s]."""
        self._seconds += covered((begin, min(end, limit)) for begin, end in self._spans if begin < limit)
        self._settled = limit
        self._spans = [(max(begin, limit), end) for begin, end in self._spans if end > limit]

    @property
    def verdict(self) -> str:
        """What this means for lives and damage, and which fields are the bounds; empty if nothing was refused as too large."""
        return f"the life is at most, and the damage at least, the value given (bound: {', '.join(self.bounds)})" if self.is_overloaded else ""


def covered(spans: Iterable[tuple[float, float]]) -> float:
    """Return the length of the union of spans (from, to)."""
    seconds, reached = 0.0, -math.inf
    for begin, end in sorted(spans):
        seconds += max(0.0, end - max(begin, reached))
        reached = max(reached, end)
    return seconds


class InputGate:
    """Judges input messages against the scene's limits and holds the last good values.

    Parameters
    ----------
    limits : what a message may contain (see `bearing_sim.scene.scene.InputLimits`).
    held : the inputs before the first message.
    substitute : what the model uses while good messages are missing, for the texts of events; by default the held value.
    heat_law : the scene's; what stands in for a ring's temperature that is not measured depends on it.
    spacings : by channel, the usual spacing of the messages of a log [s]: its silence and its rate are judged by its own rate where this is
        outside of what the limits expect.  Empty for a live run.
    waits_for : the channels without whose first good message nothing is computed, for the texts of events.
    stamp_tolerance : how far a stamp may be from the receiver's clock before that is reported [s].

    Attributes
    ----------
    held : Inputs
        The last good values.
    refused, accepted : collections.Counter
        Messages refused by kind of event, and accepted by channel.
    coverage : Coverage
        For how long inputs were unknown.
    """

    def __init__(
        self,
        limits: InputLimits,
        held: Inputs,
        substitute: str = "",
        heat_law: str = "none",
        spacings: Mapping[str, float] = MappingProxyType({}),
        waits_for: Sequence[str] = ("shaft_speed",),
        stamp_tolerance: float = math.inf,
    ):
        self._stamp_tolerance = stamp_tolerance
        self._spacings, self._waits_for = spacings, waits_for
        self.limits, self.held, self._substitute, self._stands_in = limits, held, substitute, _STANDS_IN[heat_law]
        self._measured: dict[str, tuple[float, float]] = dict.fromkeys(MEASURED_CHANNELS, (math.nan, math.nan))
        self.refused: Counter[str] = Counter()
        self.accepted: Counter[str] = Counter()
        self.coverage = Coverage()
        self._channels = {
            name: _Channel(*_good_from_to(name, limits), name == "radial_load", patience(limits, name, spacings.get(name, 0.0))) for name in CHANNELS
        }
        self._reported: set[tuple[str, str]] = set()
        self._began = math.nan  # when the first message of any channel was received
        self._expired: set[str] = set()
        self._returned: list[Event] = []

    def offer(self, channel: str, stamp: float, values: tuple[float, ...], arrival: float | None = None) -> Event | None:
        """Judge one message; take its values into ``held`` if they are good.

        Parameters
        ----------
        channel : one of `CHANNELS`.
        stamp : the sender's time [s since the start]; must rise from message to message of a channel.
        values : ``(speed,)`` [rad/s], of shaft or cage; of the cage also ``(speed, standard error)``, NaN where that is not known; of a clearance
            [m] likewise;
            ``(force_y, force_z)`` [N], or ``(force,)`` [N] for a magnitude along +y, which cannot be negative; ``(temperature,)`` [K].
        arrival : the receiver's time [s since the start], from which age and rate are computed; ``stamp`` by default, as in a replay.
            If it is given, a sender whose clock was set back is followed after a few messages, otherwise never.

        Returns
        -------
        None if accepted, otherwise the event that says what is wrong, what was expected and what is used instead.

        Raises
        ------
        KeyError
            No such channel.
        """
        state = self._channels[channel]
        received = stamp if arrival is None else arrival
        if math.isfinite(received):
            state.seen = True
            if math.isnan(self._began):
                self._began = received
            if received - state.received > state.patience and self._flowed(channel, state):
                state.window_start = math.nan  # the silence says nothing about the rate
            state.received = max(state.received, received)
            if arrival is not None and math.isfinite(stamp):
                state.offset = stamp - arrival
                if abs(state.offset) > self._stamp_tolerance:
                    state.far_offset, state.far_at = state.offset, arrival
            elapsed = received - state.window_start
            if elapsed >= 0.0:
                state.window_count += 1
                if elapsed >= max(_RATE_WINDOW, _SPACINGS_OF_RATE * self._spacings.get(channel, 0.0)):
                    state.rate = state.window_count / elapsed
                    state.window_start, state.window_count = received, 0
            else:  # the first message (NaN), or the receiver's clock was set back
                state.window_start, state.window_count = received, 0
        error = None
        if not _are_good(channel, values, state):
            error = _value_error(channel, values, state)
        if error is None and not state.stamp < stamp < math.inf:
            error = _stamp_error(state, stamp)
            if arrival is not None and _follows_new_clock(state, stamp):
                error = None
        if error is not None:
            return self.refuse(channel, received, *error)
        state.stamp, state.earlier_count = stamp, 0
        gap = received - state.arrival
        if state.patience < gap < math.inf:
            state.late = _LATE_FOR
        elif state.late:
            state.late = state.late - 1 if gap > _TIMELY * state.patience else 0
        if state.late:
            state.returned = received
        state.arrival = max(state.arrival, received)
        self.accepted[channel] += 1
        self.coverage.note_good(channel, received)
        if channel in MEASURED_CHANNELS:
            self._measured[channel] = (float(values[0]), float(values[1]) if len(values) == 2 else math.nan)
            return None
        if channel in self._expired:
            self._expired.remove(channel)
            state.returned, state.late = -math.inf, 0  # it is used from the first message on
            state.window_start, state.window_count, state.rate = received, 0, math.nan  # the silence says nothing about its rate
            self._returned.append(Event(received, Level.OK, "input.returned", channel, "it is measured again", "the measured temperature is used"))
        self.held = with_values(self.held, channel, values)
        return None

    @property
    def measured(self) -> float:
        """The last good cage speed [rad/s]; NaN before the first."""
        return self._measured[MEASURED][0]

    @property
    def standard_error(self) -> float:
        """That of `measured` [rad/s]; NaN where the sensor does not say."""
        return self._measured[MEASURED][1]

    def expire(self, now: float) -> bool:
        """Give up measured temperatures of rings whose last good message is too old at ``now`` [s]; return whether ``held`` has changed.

        Other inputs are held however old they are, because nothing else tells what they are; `check` reports both alike.
        """
        stale = [name for name in RING_TEMPERATURES if self.accepted[name] and name not in self._expired and self._is_stale(name, now)]
        self._expired.update(stale)
        self.held = self.held._replace(**dict.fromkeys(stale, math.nan))
        return bool(stale)

    def drain_returned(self) -> list[Event]:
        """Return the events since the last call of temperatures that are measured again after `expire` gave them up."""
        returned, self._returned = self._returned, []
        return returned

    def hold_oil_temperature(self, temperature: float) -> None:
        """Hold another oil temperature [K] that did not come as a message."""
        self.held = self.held._replace(oil_temperature=float(temperature))

    def refuse(self, channel: str, time: float, kind: str, reason: str, level: Level = Level.ERROR) -> Event:
        """Count a refused message and return its event; for errors that only the caller can see, such as a missing joint."""
        self.refused[kind] += 1
        self._channels[channel].refused = time
        self.coverage.note_refused(channel, time, kind)
        return Event(time, level, kind, channel, reason, f"message refused, {self._used_instead(channel)}")

    def latest(self, channel: str) -> float | tuple[float, float]:
        """Return the last good value of a channel in SI; of the load both forces, of `MEASURED_CHANNELS` value and standard error (or NaN)."""
        if channel in MEASURED_CHANNELS:
            return self._measured[channel]
        if channel == "radial_load":
            return (self.held.load_y, self.held.load_z)
        return getattr(self.held, channel)

    def check(self, now: float) -> list[Event]:
        """Return what is wrong at ``now`` [s since the start] with the flow of messages, for as long as it is wrong.

        Kinds ``input.stale`` (no good message for ``limits.stale_after``), ``input.rate`` (outside ``minimum_rate`` to ``maximum_rate``, with a
        tolerance of a tenth until it is) and ``input.stamp_offset``.  The texts stay the same as long as the trouble does: `numbers` has what
        changes.  Nothing is judged before the first message of any channel, because a machine may be switched on later than its monitor, and an
        optional channel only after its own first message.
        """
        events = []
        for channel, state in self._channels.items():
            flow = self._stale_event(channel, state, now) or self._rate_event(channel, state, now)
            events += [event for event in (flow, self._stamp_event(channel, state, now)) if event is not None]
        return events

    def numbers(self, now: float) -> dict[str, float]:
        """Return what is known at ``now`` [s] of the flow of messages, for diagnostics: rates, age of the last good message, offset of stamps."""
        found = {}
        for channel, state in self._channels.items():
            numbers = {"rate [Hz]": state.rate, "last good message [s ago]": now - state.arrival, "stamp offset [s]": state.offset}
            found |= {f"{channel} {name}": number for name, number in numbers.items() if math.isfinite(number)}
        return found

    def onsets(self, now: float) -> list[Event]:
        """Return those events of `check` that did not hold at the last call of ``onsets``: each trouble once, for logs."""
        holding = {event.key: event for event in self.check(now)}
        fresh = [event for key, event in holding.items() if key not in self._reported]
        self._reported = set(holding)
        return fresh

    def rate(self, channel: str) -> float:
        """Return the last measured message rate of a channel [Hz]; NaN until a window of messages is full."""
        return self._channels[channel].rate

    def is_heard(self, channel: str) -> bool:
        """Whether a message of a channel has come, good or not."""
        state = self._channels[channel]
        return state.seen or state.refused > -math.inf

    def is_refusing(self, channel: str) -> bool:
        """Whether messages of a channel have been refused since the last good one."""
        state = self._channels[channel]
        return state.refused > state.arrival

    def absent(self, channel: str, now: float, waited: float, expected: float) -> Event | None:
        """Return the event that a channel has had no good message at all within the time in which one is expected.

        Parameters
        ----------
        now : time of the event [s].
        waited : for how long messages could have come [s].
        expected : time within which one is expected [s]; ten times as long for temperatures.
        """
        expected *= _SLOW_CHANNEL.get(channel, 1.0)
        if self.accepted[channel] or waited <= expected:
            return None
        reason = f"no good message within {expected:g} s"
        return Event(now, Level.WARN, "input.absent", channel, reason, self._used_instead(channel, in_words=True))

    def state(self, channel: str) -> str:
        """Return what is used of a channel now, in words that change with that alone."""
        if not self._channels[channel].seen:
            return f"no message so far, {self._used_instead(channel)}"
        if not self.accepted[channel] or channel in self._expired:
            return self._used_instead(channel)
        return "its messages are used"

    def _stale_event(self, channel: str, state: _Channel, now: float) -> Event | None:
        if math.isnan(self._began) or (channel in _OPTIONAL and not state.seen):
            return None
        # One message after a silence is no flow: it must be followed by another one as it should.
        if now - max(state.arrival, self._began) <= state.patience and not 0.0 <= now - state.returned <= state.patience:
            return None
        if state.arrival > -math.inf:
            reason = f"no good message for longer than {state.patience:.3g} s"
        else:
            reason = f"no good message yet, expected one within {state.patience:.3g} s of the first input"
        return Event(now, Level.WARN, "input.stale", channel, reason, self._used_instead(channel, in_words=True))

    def _stamp_event(self, channel: str, state: _Channel, now: float) -> Event | None:
        if math.isnan(state.far_offset) or (state.offset != state.far_offset and now - state.far_at > _FAR_AT_LEAST):
            return None
        side = "ahead of" if state.far_offset > 0.0 else "behind"
        reason = f"stamps are more than {self._stamp_tolerance:g} s {side} this machine's clock"
        return Event(
            now, Level.WARN, "input.stamp_offset", channel, reason, "values are used as they arrive; set both machines' clocks by one source"
        )

    def _is_stale(self, channel: str, now: float) -> bool:
        state = self._channels[channel]
        return now - state.arrival > state.patience

    def _used_instead(self, channel: str, in_words: bool = False) -> str:
        """Return what is used without a good message, with its value or, for a text that lasts, in words."""
        if channel in RING_TEMPERATURES and math.isnan(getattr(self.held, channel)):
            return self._stands_in
        if self._substitute:
            return self._substitute
        if self.accepted[channel]:
            return "the last good value is held" if in_words else f"holding {self._shown(channel)}"
        if channel in self._waits_for:
            return "nothing is computed before the first good one"
        if channel in MEASURED_CHANNELS:
            return "nothing is compared" if channel == MEASURED else "nothing is calibrated by it"
        return f"the scene's value is used, {self._shown(channel)}"

    def _shown(self, channel: str) -> str:
        latest = self._measured[channel][0] if channel in MEASURED_CHANNELS else self.latest(channel)
        return shown(channel, latest if isinstance(latest, tuple) else (latest,))

    def _flowed(self, channel: str, state: _Channel) -> bool:
        """Whether messages of a channel came as they should before it fell silent; rare ones are no silence each."""
        return bool(self._spacings.get(channel)) or state.window_count > 1 or self._is_rate_good(channel, state.rate)

    def _rates(self, channel: str) -> tuple[float, float]:
        """Return the lowest and the highest rate of a channel that is expected [Hz]."""
        slowest = self.limits.minimum_rate / _SLOW_CHANNEL.get(channel, 1.0)
        fastest = self.limits.maximum_rate
        if spacing := self._spacings.get(channel):
            slowest = min(slowest, 1.0 / (_SPACINGS_OF_SILENCE * spacing))
            fastest = max(fastest, _SPACINGS_OF_SILENCE / spacing)
        return slowest, fastest

    def _is_rate_good(self, channel: str, rate: float, tolerance: float = _RATE_TOLERANCE) -> bool:
        slowest, fastest = self._rates(channel)
        return slowest * (1 - tolerance) <= rate <= fastest * (1 + tolerance)

    def _rate_event(self, channel: str, state: _Channel, now: float) -> Event | None:
        state.is_rate_wrong = not math.isnan(state.rate) and not self._is_rate_good(
            channel, state.rate, 0.0 if state.is_rate_wrong else _RATE_TOLERANCE
        )
        if not state.is_rate_wrong:
            return None
        slowest, fastest = self._rates(channel)
        reason = f"messages arrive at less than {slowest:.3g} Hz" if state.rate < fastest else f"messages arrive at more than {fastest:.3g} Hz"
        return Event(now, Level.WARN, "input.rate", channel, reason, "values are used as they arrive")


def patience(limits: InputLimits, channel: str, spacing: float = 0.0) -> float:
    """Return the age from which on a channel is stale [s].

    It is ``limits.stale_after``, ten times as long for a temperature.  A log with fewer than two messages in that time was made at another
    rate, and three times its usual spacing counts instead, so that a table with a row every ten minutes is not stale from row to row.

    Parameters
    ----------
    limits : of the scene.
    channel : one of `CHANNELS`.
    spacing : usual spacing of the channel's messages in a log [s]; 0 for a live run.
    """
    expected = limits.stale_after * _SLOW_CHANNEL.get(channel, 1.0)
    return expected if 2.0 * spacing <= expected else _SPACINGS_OF_SILENCE * spacing


def with_values(held: Inputs, channel: str, values: tuple[float, ...]) -> Inputs:
    """Return inputs in which the values of one channel replace the held ones."""
    speed, load_y, load_z, *temperatures = held
    if channel == "shaft_speed":
        return Inputs(float(values[0]), load_y, load_z, *temperatures)
    if channel == "radial_load":
        return Inputs(speed, float(values[0]), float(values[1]) if len(values) == 2 else 0.0, *temperatures)
    return held._replace(**{channel: float(values[0])})


def value_refusal(channel: str, values: tuple[float, ...], limits: InputLimits) -> tuple[str, str] | None:
    """Return kind and reason of what is wrong with the values of a message; None if they are good.

    Parameters
    ----------
    channel : one of `CHANNELS`.
    values : as of `InputGate.offer`.
    limits : what a message may contain.
    """
    least, largest = _good_from_to(channel, limits)
    state = _Channel(least, largest, channel == "radial_load", math.inf)
    return None if _are_good(channel, values, state) else _value_error(channel, values, state)


def _are_good(channel: str, values: tuple[float, ...], state: _Channel) -> bool:
    if len(values) == 1:
        return state.least <= values[0] <= state.largest
    if channel in MEASURED_CHANNELS:
        return len(values) == 2 and state.least <= values[0] <= state.largest and (math.isnan(values[1]) or 0.0 < values[1] < math.inf)
    return len(values) == 2 and state.is_force and math.hypot(*values) <= state.largest


def _good_from_to(channel: str, limits: InputLimits) -> tuple[float, float]:
    """Return the least and the largest good value of a message with one value; of a force with two components, the largest magnitude.

    A limit that is None allows everything.
    """
    largest_speed, largest_load = (math.inf if bound is None else bound for bound in (limits.maximum_speed, limits.maximum_load))
    if channel in TEMPERATURES:
        return limits.minimum_temperature, limits.maximum_temperature
    if channel == MEASURED_CLEARANCE:
        return -_LARGEST_CLEARANCE, _LARGEST_CLEARANCE
    if channel == "radial_load":
        return 0.0, largest_load
    return -largest_speed if limits.reverse_rotation else 0.0, largest_speed


def shown(channel: str, values: Iterable[float]) -> str:
    """Return values of a channel [SI] in the unit of its topic, for people."""
    offset = ZERO_CELSIUS if channel in TEMPERATURES else 0.0
    numbers = [f"{value - offset + 0.0:.6g}" for value in values]  # adding 0 makes 0 of -0
    return f"{numbers[0] if len(numbers) == 1 else '(' + ', '.join(numbers) + ')'} {TOPIC_UNITS[channel]}"


def _value_error(channel: str, values: tuple[float, ...], state: _Channel) -> tuple[str, str]:
    """Return kind and reason of what is wrong with values that are not good."""
    may_have_two = channel == "radial_load" or channel in MEASURED_CHANNELS
    if len(values) != 1 and (len(values) != 2 or not may_have_two):
        return "input.malformed", f"{len(values)} values, expected {'1 or 2' if may_have_two else '1'}"
    if channel in MEASURED_CHANNELS and state.least <= values[0] <= state.largest:
        expected = "expected a positive number, NaN, or no joint for it where it is not known"
        return "input.standard_error", f"a standard error of {shown(channel, values[1:])}, {expected}"
    if channel in MEASURED_CHANNELS:
        values = values[:1]
    unit, given = TOPIC_UNITS[channel], shown(channel, values)
    magnitude = math.hypot(*values)
    if not math.isfinite(magnitude) and not all(map(math.isfinite, values)):
        return "input.not_finite", f"{given} is not finite"
    if channel in TEMPERATURES:
        kind = "input.too_small" if values[0] < state.least else "input.too_large"
        least, largest = shown(channel, (state.least,)), shown(channel, (state.largest,))
        return kind, f"{given} is outside {least} to {largest} ({_BOUNDS[kind, channel]})"
    if channel == MEASURED_CLEARANCE:
        return "input.too_large", f"{given} is more than any bearing has, expected metres, and at most {state.largest:g} of them"
    if len(values) == 1 and state.least == 0.0 > values[0]:
        hint = "" if state.is_force else " (input_limits.reverse_rotation is off)"
        return "input.negative", f"{given} is negative, expected zero or more{hint}"
    bound = _BOUNDS.get(("input.too_large", channel), "input_limits.maximum_speed")  # that of the shaft holds for a measured cage, too
    return "input.too_large", f"{magnitude:.6g} {unit} is above the largest accepted, {state.largest:.6g} {unit} ({bound})"


def _stamp_error(state: _Channel, stamp: float) -> tuple[str, str, Level]:
    """Return kind, reason and level of what is wrong with a stamp that is not later than the last one, or not finite."""
    if not math.isfinite(stamp):
        return "input.stamp_not_finite", f"stamp {stamp} s is not finite", Level.ERROR
    if stamp == state.stamp:
        return "input.time_repeated", f"stamp {stamp:.6f} s repeats the last one, expected a later one", Level.WARN
    back = state.stamp - stamp
    return "input.time_backwards", f"stamp {stamp:.6f} s lies {back:.6g} s before the last one, expected a later one", Level.ERROR


def _follows_new_clock(state: _Channel, stamp: float) -> bool:
    """Return whether enough refused messages in a row have rising stamps: then their sender's clock was set and is followed."""
    state.earlier_count = state.earlier_count + 1 if stamp > state.earlier_stamp and state.earlier_count else 1
    state.earlier_stamp = stamp
    return math.isfinite(stamp) and state.earlier_count > _RISING_TO_FOLLOW


class PublisherConflict:
    """Reports several publishers on one input channel, and as an error if their values disagree.

    Parameters
    ----------
    channel : its name.

    Attributes
    ----------
    publishers : int
        How many there are.
    """

    def __init__(self, channel: str):
        self._channel = channel
        self._values: deque[tuple[float, ...]] = deque(maxlen=_REMEMBERED)
        self._disagreed_at = -math.inf
        self.publishers = 1

    def receive(self, values: tuple[float, ...]) -> None:
        """Receive the values of an accepted message; of a force its components."""
        self._values.append(values)

    @property
    def disagreement(self) -> tuple[float, float] | None:
        """Least and largest of the newest values if these jump to and fro by more than the tolerance; else None."""
        if len(self._values) < _REMEMBERED:
            return None
        return next(((min(series), max(series)) for series in zip(*self._values) if _jumps_to_and_fro(series)), None)

    def event(self, now: float) -> Event | None:
        """Return the event that holds at ``now`` [s]; None for a single publisher."""
        if self.publishers < 2:
            return None
        reason = f"{self.publishers} publishers, expected one"
        if self.disagreement is not None:
            self._disagreed_at = now
        if not 0.0 <= now - self._disagreed_at <= _DISAGREE_AT_LEAST:
            return Event(now, Level.WARN, "input.publishers", self._channel, reason, "the newest value of any of them is used")
        reason = f"{reason}, and they disagree"
        return Event(now, Level.ERROR, "input.publishers", self._channel, reason, "the newest value is used, which is wrong for one of them")

    @property
    def values(self) -> dict[str, str]:
        """The values between which publishers jump, for diagnostics; empty while they do not."""
        extremes = self.disagreement if self.publishers > 1 else None
        return {} if extremes is None else {f"{self._channel} jumps between": " and ".join(shown(self._channel, (each,)) for each in extremes)}


class Sources(NamedTuple):
    """What is known of the topic of a channel: who could send its messages.

    Attributes
    ----------
    topic, ros_type : its full name, and the type that is listened to.
    publishers : publishers of this type whose quality of service fits.
    other_types : types of the other publishers of the topic.
    misfits : why the quality of service of publishers does not fit.
    alternatives : other topics of this type that somebody publishes, the likeliest first.
    """

    topic: str
    ros_type: str
    publishers: int
    other_types: tuple[str, ...] = ()
    misfits: tuple[str, ...] = ()
    alternatives: tuple[str, ...] = ()

    def events(self, channel: str, now: float) -> list[Event]:
        """Return the events of publishers that cannot be heard, which hold at ``now`` [s]."""
        events = []
        if self.other_types:
            reason = f"{self.topic} has a publisher of {' and '.join(self.other_types)}, expected {self.ros_type}"
            scalar = self.ros_type != _SCALAR and _SCALAR in self.other_types and _SCALAR in input_types(channel)
            action = "it cannot be heard: publish the expected type, or remap the topic" + ", or set input_type to scalar" * scalar
            events.append(Event(now, Level.WARN, "input.type", channel, reason, action))
        if self.misfits:
            reason = f"{self.topic} has a publisher whose quality of service does not fit: {'; '.join(self.misfits)}"
            events.append(Event(now, Level.WARN, "input.qos", channel, reason, "it cannot be heard: change the quality of service of one of the two"))
        return events

    def explained(self, event: Event, has_been_good: bool, is_refusing: bool) -> Event:
        """Return an event of a channel that lacks good messages, with the likely cause and what to do about it.

        Parameters
        ----------
        has_been_good : whether a good message has come.
        is_refusing : whether messages have been refused since the last good one.
        """
        if self.publishers and is_refusing:
            cause, advice = f"messages come on {self.topic}, and are refused", ""
        elif self.publishers:
            sends = "sends too rarely, or no more" if has_been_good else "sends nothing"
            cause, advice = f"{self.topic} has a publisher that {sends}", f"look at ros2 topic echo {self.topic}"
        else:
            cause, advice = f"nobody publishes {self.topic} ({self.ros_type})", "start its publisher, or remap the topic"
            if self.alternatives:
                advice += f": the type is published on {', '.join(self.alternatives)}"
        return event._replace(reason=f"{event.reason}: {cause}", action="; ".join(filter(None, (event.action, advice))))


def _jumps_to_and_fro(values: tuple[float, ...]) -> bool:
    least = _CONFLICT_TOLERANCE * max(map(abs, values))
    jumps = [after - before for before, after in zip(values, values[1:]) if abs(after - before) > least]
    return sum(first * second < 0.0 for first, second in zip(jumps, jumps[1:])) >= _REVERSALS


class Message(NamedTuple):
    """One input message."""

    channel: str
    values: tuple[float, ...]  # SI
    stamp: int  # [ns since the epoch]


class Verdict(Enum):
    """What `ClockJumpFilter` decides about a message."""

    ACCEPT = "belongs to the present run of the clock"
    SET_ASIDE = "stamped before the newest: from after a jump that is not known yet, or wrong"
    LEFTOVER = "from before the last jump"


class ClockJumpFilter:
    """Sorts messages that arrive on the wrong side of a backward jump of the clock.

    Messages and clock arrive on different topics: messages from after the jump may arrive before the jump is known, and messages from
    before it afterwards.  A message stamped before the newest of its channel is set aside for a second of wall time, in which the jump
    may become known.  After the jump, messages stamped beyond the newest one from before it are left out, until their channel has
    jumped back too or the clock has reached them.
    """

    def __init__(self):
        self._aside: deque[tuple[float, Message]] = deque()
        self._left: dict[str, int] = {}

    def sort(self, message: Message, newest: int | None, wall: float) -> Verdict:
        """Judge a message, and keep it if it is set aside.

        Parameters
        ----------
        message : the message.
        newest : stamp of the newest good message of its channel since the jump [ns since the epoch]; None for none.
        wall : wall time [s].
        """
        if message.stamp > self._left.get(message.channel, message.stamp):
            return Verdict.LEFTOVER
        if newest is not None and message.stamp < newest:
            self._aside.append((wall, message))
            return Verdict.SET_ASIDE
        self._left.pop(message.channel, None)
        return Verdict.ACCEPT

    def jump(self, clock: int, newest: Mapping[str, int]) -> list[Message]:
        """Take a backward jump and return the messages from after it that have arrived already.

        Of the messages set aside these are the ones stamped nearer to the clock than to the newest; the others were wrong before the jump.

        Parameters
        ----------
        clock : the reading after the jump [ns since the epoch].
        newest : the newest stamp of each channel from before the jump [ns since the epoch].
        """
        self._left = {channel: stamp for channel, stamp in newest.items() if stamp > clock}
        aside, self._aside = self._aside, deque()
        middle = 0.5 * (clock + max(newest.values(), default=clock))
        return [message for _, message in aside if message.stamp <= middle]

    def reach(self, clock: int) -> None:
        """Take a reading of the clock [ns since the epoch]."""
        self._left = {channel: stamp for channel, stamp in self._left.items() if stamp > clock}

    def expired(self, wall: float) -> list[Message]:
        """Return the messages that were set aside without a jump becoming known, at wall time [s]."""
        found = []
        while self._aside and wall - self._aside[0][0] > _SET_ASIDE:
            found.append(self._aside.popleft()[1])
        return found


def unused_event(time: float, channel: str) -> Event:
    """Return the event that the measured temperature of a ring is there, but not used."""
    reason = "heat.law is none, so that the model does not know the temperatures of the rings"
    return Event(time, Level.WARN, "input.unused", channel, reason, "its messages are not read; set heat.law to given or network to use them")


def unknown_inputs(time: float, unknown: float, total: float, verdict: str) -> Event:
    """Return the event that inputs were unknown for ``unknown`` of ``total`` [s]; ``verdict`` as of `Coverage`."""
    reason = f"inputs were refused for {unknown:.4g} s of {total:.4g} s ({100 * unknown / max(total, unknown):.3g} %)"
    return Event(time, Level.WARN, "input.unknown", "", reason, verdict or "the last good values, or lines between them, stand in")
