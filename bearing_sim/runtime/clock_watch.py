# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Watches a clock that somebody else keeps: whether it is there, stands still, jumps, and which of its readings is settled.

Pure: readings and wall times are brought along.
"""

from collections import deque
from enum import Enum

_SETTLING = 0.5  # [s of wall time] after which every message stamped before a reading is taken to have come
_OVERDUE = 2.0  # [s of wall time] after which a message that is not here is told: played fast, messages queue up for that long
_STANDING = 1.0  # [s of wall time]
_LEAP = 10.0  # times the step before, and seconds: a step further ahead than both is told


class Step(Enum):
    """What a reading of the clock is, after the one before."""

    FIRST = "first"
    FORWARD = "forward"
    LEAP = "leap"  # so far ahead that it is no pace
    BACK = "back"


class ClockWatch:
    """The readings of one clock.

    Attributes
    ----------
    now : int or None
        The newest reading [ns since the epoch]; None before the first.
    before : int or None
        The one before it.
    """

    def __init__(self):
        self.now: int | None = None
        self.before: int | None = None
        self._step = 0
        self._changed_at = 0.0
        self._unsettled: deque[tuple[float, int]] = deque()
        self._pending: deque[tuple[float, int]] = deque()
        self._settled = self._overdue = -1

    def read(self, clock: int, wall: float) -> Step | None:
        """Take in a reading [ns since the epoch] at a wall time [s]; None where the clock stands still."""
        if clock == self.now:
            return None
        self.before, self.now, self._changed_at = self.now, clock, wall
        if self.before is not None and clock < self.before:
            self._unsettled.clear()
            self._pending.clear()
            self._settled = self._overdue = -1
        self._unsettled.append((wall, clock))
        self._pending.append((wall, clock))
        if self.before is None:
            return Step.FIRST
        step, usual = clock - self.before, self._step
        self._step = max(step, 0)
        if step < 0:
            return Step.BACK
        return Step.LEAP if usual and step > _LEAP * max(usual, 1_000_000_000) else Step.FORWARD

    def settled(self, wall: float) -> int:
        """Return the newest reading that is half a second of wall time old or more [ns since the epoch]; -1 where there is none."""
        while self._unsettled and wall - self._unsettled[0][0] >= _SETTLING:
            self._settled = self._unsettled.popleft()[1]
        return self._settled

    def overdue(self, wall: float) -> int:
        """Return likewise the newest reading up to which a message that is not here is missing."""
        while self._pending and wall - self._pending[0][0] >= _OVERDUE:
            self._overdue = self._pending.popleft()[1]
        return self._overdue

    def stands_still(self, wall: float) -> bool:
        """Return whether there was a reading, and no other for a second of wall time."""
        return self.now is not None and wall - self._changed_at > _STANDING
