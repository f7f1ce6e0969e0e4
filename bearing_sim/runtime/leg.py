# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Legs: parts of a course of inputs, from instant to instant, with what acts at each of them.

The whole of a recording is one leg, a run that follows a clock takes many short ones; both are made here, so that the model sees the
same instants and the same inputs either way.  Times are whole nanoseconds since the start of the course.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene import InputLimits
from bearing_sim.simulation import Inputs
from bearing_sim.topics import INPUTS

REQUIRED = ("shaft_speed", "radial_load")
_GAP_IN_SPACINGS = 10
_SPACINGS_KNOWN = 100  # of a channel, of which the median is taken
_FEW_SPACINGS = 3
_LONGEST_UNKNOWN = 3600.0  # [s] a spacing that nothing is known to compare with is a gap beyond this
_SILENT_OIL = 10.0  # times the age at which an input is stale: oil warms up in minutes, its messages are rare


class Arrival(NamedTuple):
    """Messages that came at one instant."""

    time: float  # [s] since the start of the course
    inputs: Inputs  # of that instant
    channels: list[str]


class Messages(NamedTuple):
    """The good messages of each channel.

    Attributes
    ----------
    stamps : by channel, [ns since the start of the course], int64, rising; before 0 too.
    values : by channel, shape (messages,) or, for the load, (messages, 2), SI.
    """

    stamps: Mapping[str, np.ndarray]
    values: Mapping[str, np.ndarray]


class Leg(NamedTuple):
    """A part of a course.

    Attributes
    ----------
    instants : the stamps of speed and load and the times of outputs [ns], int64, rising, shape (n,).
    inputs : at the instants, columns as `bearing_sim.simulation.Inputs`, shape (n, 4).
    is_output : whether an output is wanted at each instant, shape (n,).
    in_gap : whether the time before each instant is not to be simulated, shape (n,).
    arrived : stamps of messages of any input [ns], rising, shape (m,).
    arrived_inputs : at these, shape (m, 4).
    arrived_channels : by channel, whether a message of it has each stamp, shape (m,).
    """

    instants: np.ndarray
    inputs: np.ndarray
    is_output: np.ndarray
    in_gap: np.ndarray
    arrived: np.ndarray
    arrived_inputs: np.ndarray
    arrived_channels: Mapping[str, np.ndarray]

    def arrivals(self, begin: int, end: int) -> Iterator[Arrival]:
        """Yield what came after instant number ``begin`` - 1 until instant number ``end`` - 1, as of the leg's start or end where there is none."""
        first = 0 if begin == 0 else int(np.searchsorted(self.arrived, self.instants[begin - 1], "right"))
        last = int(np.searchsorted(self.arrived, self.instants[end - 1], "right"))
        for place in range(first, last):
            channels = [channel for channel in INPUTS if channel in self.arrived_channels and self.arrived_channels[channel][place]]
            yield Arrival(float(self.arrived[place] * 1e-9), Inputs(*self.arrived_inputs[place].tolist()), channels)


def inputs_at(instants: np.ndarray, messages: Messages, limits: InputLimits, temperature: float) -> np.ndarray:
    """Return the inputs at instants [ns], shape (n, 4): speed and load linear between their messages, the oil temperature held.

    The temperature is held, not drawn linear, because a run under way cannot know the next one; before its first message it is that of
    the first where this comes soon, else ``temperature``.

    Parameters
    ----------
    instants : [ns since the start of the course], shape (n,).
    messages : those of speed and load must enclose the instants.
    limits : its ``stale_after``, ten times over, is how soon a first temperature must come.
    temperature : of the scene [K].
    """
    stamps, values = messages
    columns = np.empty((len(instants), 4))
    columns[:, 0] = np.interp(instants, stamps["shaft_speed"], values["shaft_speed"])
    for axis in range(2):
        columns[:, 1 + axis] = np.interp(instants, stamps["radial_load"], values["radial_load"][:, axis])
    columns[:, 3] = temperature
    known = stamps.get("oil_temperature", ())
    if len(known):
        place = np.searchsorted(known, instants, "right") - 1
        told = (place >= 0) | (known[0] <= oil_patience_ns(limits))
        columns[told, 3] = np.asarray(values["oil_temperature"])[np.maximum(place, 0)][told]
    return columns


def oil_patience_ns(limits: InputLimits) -> int:
    """Return how long after the start a first oil temperature still counts for the start [ns]."""
    return round(_SILENT_OIL * limits.stale_after * 1e9)


def is_gap(spacings: Sequence[int], limits: InputLimits, longest_gap: float | None = None) -> bool:
    """Return whether the last of a channel's spacings [ns] is a gap, of which the inputs say nothing.

    Parameters
    ----------
    spacings : between good messages, the last hundred or all of them.
    limits : no spacing up to ``stale_after`` is a gap.
    longest_gap : spacing that is none [s]; by default ten times the median of those so far, and of three or fewer an hour at most.
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
    long = np.flatnonzero(spacings > 1e9 * (limits.stale_after if longest_gap is None else longest_gap))
    return [
        (int(stamps[place]), int(stamps[place + 1]))
        for place in long.tolist()
        if is_gap(spacings[max(0, place + 1 - _SPACINGS_KNOWN) : place + 1].tolist(), limits, longest_gap)
    ]


def leg(
    messages: Messages, gaps: Sequence[tuple[int, int]], after: int, until: int, rate: float | None, limits: InputLimits, temperature: float
) -> Leg:
    """Return the leg of a course from ``after``, left out, to ``until``.

    Parameters
    ----------
    messages : see `inputs_at`.
    gaps : (from, to) [ns].
    after, until : [ns]; -1 for a leg that begins with the course.
    rate : outputs per simulated second [Hz], counted from the start of the course; None for one at each stamp of speed or load.
    limits, temperature : see `inputs_at`.
    """
    stamps = {channel: _within(messages.stamps[channel], after, until) for channel in INPUTS if channel in messages.stamps}
    stops = np.unique(np.concatenate([stamps[channel] for channel in REQUIRED]))
    wanted = stops if rate is None else _outputs(rate, after, until, gaps)
    instants = np.union1d(stops, wanted)
    in_gap = np.zeros(len(instants), bool)
    for begin, end in gaps:
        in_gap |= (instants > begin) & (instants <= end)
    arrived = np.unique(np.concatenate(list(stamps.values())))
    return Leg(
        instants,
        inputs_at(instants, messages, limits, temperature),
        np.isin(instants, wanted),
        in_gap,
        arrived,
        inputs_at(arrived, messages, limits, temperature),
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
