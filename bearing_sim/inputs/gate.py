# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The door for input messages: what is not a usable value is refused, named and counted, and the last good value is held.

Pure arithmetic on numbers and times that the caller brings along; no clock, no ROS.  The node and the replay of
recordings use the same gate, so a log is judged exactly as it would have been live.
"""

import math
from collections import Counter
from dataclasses import dataclass

from bearing_sim.events import Event, Level
from bearing_sim.scene import InputLimits
from bearing_sim.simulation import Inputs
from bearing_sim.topics import MEASURED

CHANNELS = ("shaft_speed", "radial_load", "oil_temperature", MEASURED)  # the last is held against the model, no input of it
_OPTIONAL = ("oil_temperature", MEASURED)
_RATE_WINDOW = 1.0  # [s] a rate is the count of messages over at least this long
_RATE_TOLERANCE = 0.1  # relative: timers jitter
_SLOW_CHANNEL = {"oil_temperature": 10.0}  # oil warms up in minutes: its messages may be that much rarer
_RISING_TO_FOLLOW = 3  # this many refused messages in a row with rising stamps: the sender's clock has been set anew


@dataclass
class _Channel:
    """What is remembered of one input: the newest stamp, the newest arrival, and the count of the running rate window."""

    stamp: float = -math.inf
    arrival: float = -math.inf
    seen: bool = False
    window_start: float = math.nan
    window_count: int = 0
    rate: float = math.nan
    earlier_stamp: float = -math.inf
    earlier_count: int = 0
    least: float = 0.0  # what is from here ...
    largest: float = 0.0  # ... to here is good, as nearly all is; why something else is not takes a closer look
    is_force: bool = False


class InputGate:
    """Judges input messages against the scene's limits and holds the last good values.

    Parameters
    ----------
    limits : what a message may be (see `bearing_sim.scene.InputLimits`).
    held : the inputs before the first message.

    Attributes
    ----------
    held : Inputs
        The last good values.
    measured : float
        The last good cage speed [rad/s]; NaN before the first.
    refused, accepted : collections.Counter
        Messages refused by event code, and accepted by channel.
    """

    def __init__(self, limits: InputLimits, held: Inputs):
        self.limits = limits
        self.held = held
        self.measured = math.nan
        self.refused: Counter[str] = Counter()
        self.accepted: Counter[str] = Counter()
        self._channels = {name: _Channel() for name in CHANNELS}
        for name, state in self._channels.items():
            state.least, state.largest, state.is_force = *_good_from_to(name, limits), name == "radial_load"
        self._reported: set[tuple[str, str]] = set()

    def offer(self, channel: str, stamp: float, values: tuple[float, ...], arrival: float | None = None) -> Event | None:
        """Judge one message; take its values over into ``held`` if they are good.

        Parameters
        ----------
        channel : one of `CHANNELS`.
        stamp : the sender's time [s since the start]; must rise from message to message of a channel.
        values : ``(speed,)`` [rad/s], of shaft or cage; ``(force_y, force_z)`` [N], or ``(force,)`` [N] for a magnitude along +y, which cannot
            be negative; ``(temperature,)`` [K].
        arrival : the receiver's time [s since the start], by which age and rate are judged; ``stamp`` where absent (replay).
            Where it is given, a sender whose clock was set back is followed after a few messages, else never.

        Returns
        -------
        None if accepted, otherwise the event that says what is wrong, what was expected and what is held instead.

        Raises
        ------
        KeyError
            No such channel.
        """
        state = self._channels[channel]
        received = stamp if arrival is None else arrival
        if math.isfinite(received):
            self._count_rate(state, received)
        fault = None
        if len(values) == 1:
            is_good = state.least <= values[0] <= state.largest
        else:
            is_good = len(values) == 2 and state.is_force and math.hypot(*values) <= state.largest
        if not is_good:
            fault = _value_fault(channel, values, state)
        if fault is None and not state.stamp < stamp < math.inf:
            fault = _stamp_fault(state, stamp)
            if fault and arrival is not None and _clock_set_anew(state, stamp):
                fault = None
        if fault is not None:
            return self.refuse(channel, received, *fault)
        state.stamp, state.earlier_count = stamp, 0
        state.arrival = max(state.arrival, received)
        self.accepted[channel] += 1
        if channel == MEASURED:
            self.measured = float(values[0])
        else:
            self.held = _with_values(self.held, channel, values)
        return None

    def hold_oil_temperature(self, temperature: float) -> None:
        """Hold another oil temperature [K], which has come by another way than a message."""
        self.held = self.held._replace(oil_temperature=float(temperature))

    def refuse(self, channel: str, time: float, code: str, reason: str, level: Level = Level.ERROR) -> Event:
        """Count a refused message and return its event; for faults that only the caller can see, such as a missing joint."""
        self.refused[code] += 1
        return Event(time, level, code, f"{channel}: {reason}; message refused, holding {self._held_text(channel)}")

    def latest(self, channel: str) -> float | tuple[float, float]:
        """Return the last good value of a channel, of the load both forces, in SI."""
        if channel == MEASURED:
            return self.measured
        if channel == "radial_load":
            return (self.held.load_y, self.held.load_z)
        return getattr(self.held, channel)

    def check(self, now: float) -> list[Event]:
        """Return what is wrong at ``now`` [s since the start] with the flow of messages, as long as it is wrong.

        Codes ``input.stale`` (no good message for ``limits.stale_after``) and ``input.rate`` (outside ``minimum_rate`` to
        ``maximum_rate``, with a tenth of tolerance).  An optional channel is judged only once a message of it came.
        """
        events = []
        for channel, state in self._channels.items():
            event = self._stale_event(channel, state, now) or self._rate_event(channel, state, now)
            if event is not None:
                events.append(event)
        return events

    def onsets(self, now: float) -> list[Event]:
        """Return those events of `check` that did not hold at the last call of ``onsets``: each trouble once, for logs."""
        holding = {(event.code, event.text.partition(":")[0]): event for event in self.check(now)}
        fresh = [event for key, event in holding.items() if key not in self._reported]
        self._reported = set(holding)
        return fresh

    def rate(self, channel: str) -> float:
        """Return the last measured message rate of a channel [Hz]; NaN until a window of messages is full."""
        return self._channels[channel].rate

    def _count_rate(self, state: _Channel, received: float) -> None:
        state.seen = True
        elapsed = received - state.window_start
        if not 0.0 <= elapsed:  # the first message, or the receiver's clock went back
            state.window_start, state.window_count = received, 0
            return
        state.window_count += 1
        if elapsed >= _RATE_WINDOW:
            state.rate = state.window_count / elapsed
            state.window_start, state.window_count = received, 0

    def _stale_event(self, channel: str, state: _Channel, now: float) -> Event | None:
        patience = self.limits.stale_after * _SLOW_CHANNEL.get(channel, 1.0)
        age = now - max(state.arrival, 0.0)
        if age <= patience or (channel in _OPTIONAL and not state.seen):
            return None
        since = f"no good message for {age:.3g} s" if state.arrival > -math.inf else f"no good message since the start {age:.3g} s ago"
        text = f"{channel}: {since}, expected one within {patience:.3g} s; holding {self._held_text(channel)}"
        return Event(now, Level.WARN, "input.stale", text)

    def _held_text(self, channel: str) -> str:
        held = self.held
        if channel == MEASURED:
            return f"{self.measured:.6g} rad/s"
        if channel == "shaft_speed":
            return f"{held.shaft_speed:.6g} rad/s"
        if channel == "radial_load":
            return f"({held.load_y:.6g}, {held.load_z:.6g}) N"
        return f"{held.oil_temperature:.6g} K"

    def _rate_event(self, channel: str, state: _Channel, now: float) -> Event | None:
        slowest = self.limits.minimum_rate / _SLOW_CHANNEL.get(channel, 1.0)
        fastest = self.limits.maximum_rate
        if slowest * (1 - _RATE_TOLERANCE) <= state.rate <= fastest * (1 + _RATE_TOLERANCE) or math.isnan(state.rate):
            return None
        text = f"{channel}: messages come at {state.rate:.3g} Hz, expected {slowest:.3g} to {fastest:.3g} Hz; values are used as they come"
        return Event(now, Level.WARN, "input.rate", text)


def _good_from_to(channel: str, limits: InputLimits) -> tuple[float, float]:
    """Return the least and the largest value of a good message of one value; of a force in two parts, the largest magnitude."""
    if channel == "oil_temperature":
        return limits.minimum_temperature, limits.maximum_temperature
    if channel == "radial_load":
        return 0.0, limits.maximum_load
    return -limits.maximum_speed if limits.reverse_rotation else 0.0, limits.maximum_speed


def _value_fault(channel: str, values: tuple[float, ...], state: _Channel) -> tuple[str, str] | None:
    """Return code and reason of what is wrong with the values, or None."""
    if len(values) != 1 and (len(values) != 2 or channel != "radial_load"):
        return "input.malformed", f"{len(values)} values, expected {'1 or 2' if channel == 'radial_load' else '1'}"
    unit = UNITS[channel]
    magnitude = math.hypot(*values)
    if not math.isfinite(magnitude) and not all(map(math.isfinite, values)):
        return "input.not_finite", f"{_shown(values)} {unit} is not finite"
    if channel == "oil_temperature":
        if not state.least <= values[0] <= state.largest:
            code = "input.too_small" if values[0] < state.least else "input.too_large"
            return code, f"{_shown(values)} K is outside {state.least:.6g} to {state.largest:.6g} K"
        return None
    if len(values) == 1 and state.least == 0.0 > values[0]:
        hint = "" if state.is_force else " (input_limits.reverse_rotation is off)"
        return "input.negative", f"{_shown(values)} {unit} is negative, expected zero or more{hint}"
    if magnitude > state.largest:
        return "input.too_large", f"{magnitude:.6g} {unit} is above the largest accepted, {state.largest:.6g} {unit}"
    return None


def _shown(values: tuple[float, ...]) -> str:
    return ", ".join(f"{value:.6g}" for value in values)


def _stamp_fault(state: _Channel, stamp: float) -> tuple[str, str, Level] | None:
    """Return code, reason and level of what is wrong with the stamp, or None."""
    if not math.isfinite(stamp):
        return "input.stamp_not_finite", f"stamp {stamp} s is not finite", Level.ERROR
    if stamp == state.stamp:
        return "input.time_repeated", f"stamp {stamp:.6f} s repeats the last one, expected a later one", Level.WARN
    if stamp < state.stamp:
        back = state.stamp - stamp
        return "input.time_backwards", f"stamp {stamp:.6f} s lies {back:.6g} s before the last one, expected a later one", Level.ERROR
    return None


def _clock_set_anew(state: _Channel, stamp: float) -> bool:
    """Return whether enough refused messages in a row rise among themselves: then their sender's clock is the one to follow."""
    state.earlier_count = state.earlier_count + 1 if stamp > state.earlier_stamp and state.earlier_count else 1
    state.earlier_stamp = stamp
    return math.isfinite(stamp) and state.earlier_count > _RISING_TO_FOLLOW


UNITS = {"shaft_speed": "rad/s", "radial_load": "N", "oil_temperature": "K", MEASURED: "rad/s"}
"""In which SI unit the values of a channel are."""


def _with_values(held: Inputs, channel: str, values: tuple[float, ...]) -> Inputs:
    speed, load_y, load_z, temperature = held
    if channel == "shaft_speed":
        return Inputs(float(values[0]), load_y, load_z, temperature)
    if channel == "radial_load":
        return Inputs(speed, float(values[0]), float(values[1]) if len(values) == 2 else 0.0, temperature)
    return Inputs(speed, load_y, load_z, float(values[0]))
