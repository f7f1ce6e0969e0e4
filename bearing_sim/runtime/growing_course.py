# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A course of inputs that grows while messages come, and says up to when everything is known.

Topics have no common order: a load may come before or after a speed of the same stamp.  Speed and load are linear between their
messages, so an instant is known once each of the two has a message stamped at or after it, in whatever order they came; neither can be
late.  The oil temperature is held, so of it an instant is known once a later message is here or the clock has passed the instant long
enough ago for its messages to have come; one that comes later than that is late, and refused.
"""

from bisect import bisect_left, bisect_right
from collections import deque

import numpy as np

from bearing_sim.runtime.leg import REQUIRED, Leg, Messages, is_gap, leg, oil_patience_ns
from bearing_sim.scene import InputLimits
from bearing_sim.topics import INPUTS

_LEG = 1_000_000_000  # [ns] a leg is no longer, so that requests are obeyed and the newest messages are seen
_PRUNED = 10_000  # messages that are over before they are forgotten
_SPACINGS = 100
OIL = "oil_temperature"


class GrowingCourse:
    """Good messages as they come, and the legs that they allow.

    Parameters
    ----------
    rate : outputs per simulated second [Hz].
    limits : of the scene.
    temperature : of the scene's oil [K].

    Attributes
    ----------
    start : int or None
        Stamp at which speed and load are both known first [ns since the epoch]; None before.
    claimed : int
        Up to when legs have been given out [ns since the epoch].
    late : int
        Messages that came after their time was claimed.
    gaps : int
        Gaps found.
    """

    def __init__(self, rate: float, limits: InputLimits, temperature: float):
        self._rate, self._limits, self._temperature = rate, limits, temperature
        self._stamps: dict[str, list[int]] = {channel: [] for channel in INPUTS}
        self._values: dict[str, list] = {channel: [] for channel in INPUTS}
        self._spacings = {channel: deque(maxlen=_SPACINGS) for channel in REQUIRED}
        self._gaps: list[tuple[int, int]] = []
        self.start: int | None = None
        self.claimed = self._reached = -1
        self.late = self.gaps = 0

    def add(self, channel: str, stamp: int, value) -> tuple[int, int] | None:
        """Take in a good message, stamped [ns since the epoch] later than the last one of its channel, with its value in SI.

        Returns
        -------
        The gap that it ends [ns since the epoch], or None.

        Raises
        ------
        ValueError
            The model has passed its stamp already; it is counted as late and changes nothing.
        """
        stamps = self._stamps[channel]
        if stamp <= self.claimed:
            self.late += 1
            raise ValueError(f"stamped {stamp * 1e-9:.6f} s, which the model has passed by {(self.claimed - stamp) * 1e-9:.3g} s")
        gap = None
        if channel in REQUIRED and stamps:
            self._spacings[channel].append(stamp - stamps[-1])
            if is_gap(self._spacings[channel], self._limits):
                gap = (stamps[-1], stamp)
                self._gaps.append(gap)
                self.gaps += 1
        stamps.append(stamp)
        self._values[channel].append(value)
        if self.start is None and all(self._stamps[required] for required in REQUIRED):
            self.start = max(self._stamps[required][0] for required in REQUIRED)
        return gap

    def awaited(self, settled: int, expects_oil: bool) -> list[str]:
        """Return the channels that an advance to the instant ``settled`` waits for (see `known_until`)."""
        if unheard := [channel for channel in REQUIRED if not self._stamps[channel]]:
            return unheard
        last = min(REQUIRED, key=lambda channel: self._stamps[channel][-1])
        if self._stamps[last][-1] < settled:
            return [last]
        return [OIL] if expects_oil and self._oil_until(settled) < settled else []

    def known_until(self, clock: int, settled: int, expects_oil: bool) -> int:
        """Return the last instant of which everything is known [ns since the epoch]; -1 for none.

        Parameters
        ----------
        clock : now [ns since the epoch]; nothing acts before its time.
        settled : an earlier reading of the clock, long enough ago for every message stamped before it to have come [ns since the epoch].
        expects_oil : whether somebody publishes the oil temperature.
        """
        if self.start is None:
            return -1
        known = min(clock, *(self._stamps[channel][-1] for channel in REQUIRED))
        if expects_oil or self._stamps[OIL]:
            known = min(known, self._oil_until(settled))
        elif settled < self.start:  # whoever publishes it may not have been found yet
            return -1
        return known if known >= self.start else -1

    def _oil_until(self, settled: int) -> int:
        stamps = self._stamps[OIL]
        if stamps:
            return max(stamps[-1], settled)
        return settled if self.start is not None and settled > self.start + oil_patience_ns(self._limits) else -1

    def take(self, known_until: int) -> Leg | None:
        """Return the next leg, up to ``known_until`` [ns since the epoch] or a second further, or None when there is none yet."""
        if known_until <= self.claimed or known_until < 0:
            return None
        first = self.claimed < 0
        after = self.start - 1 if first else self._reached
        until = min(known_until, self._end_of_gap(max(after, self.start) + _LEG, after))
        start = self.start
        part = leg(
            self._messages(after, until),
            [(begin - start, end - start) for begin, end in self._gaps],
            after - start,
            until - start,
            self._rate,
            self._limits,
            self._temperature,
        )
        self.claimed = until
        if len(part.instants):
            self._reached = start + int(part.instants[-1])
            self._forget()
        return part

    def _end_of_gap(self, until: int, after: int) -> int:
        """Return ``until``, or the end of a gap in which it lies or that it would cut."""
        return max([until, *(end for begin, end in self._gaps if begin <= after or begin < until < end)])

    def _messages(self, after: int, until: int) -> Messages:
        """Return the messages that say what the inputs are from ``after`` to ``until``, relative to the start."""
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
        """Messages that the model has not come to."""
        return sum(len(own) - bisect_right(own, self.claimed) for own in self._stamps.values())
