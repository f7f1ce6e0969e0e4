# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Time intervals that are already included in a bearing's totals, so that a recording fills what is missing once and only once."""

from bisect import bisect_left, bisect_right

import numpy as np

MOST = 256
"""Stretches that are kept; where there are more, the shortest gap between two of them counts as covered."""

_NO_GAP = 1_000_000  # [ns] between two stretches that are one: stamps are rounded
_WHOLE = 1e-9  # fraction of a sample's time that is round-off


class Covered:
    """Stretches of time, each after the one before, with gaps between them.

    Parameters
    ----------
    stretches : begin and end of each [ns since the epoch], in order of time.

    Raises
    ------
    ValueError
        They are not in order, or overlap.
    """

    def __init__(self, stretches=()):
        self._begins = [int(begin) for begin, _ in stretches]
        self._ends = [int(end) for _, end in stretches]
        edges = [edge for pair in zip(self._begins, self._ends) for edge in pair]
        if any(after < before for before, after in zip(edges, edges[1:])):
            raise ValueError("stretches of time that are covered must be in order and must not overlap")

    def __len__(self) -> int:
        return len(self._begins)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Covered) and self.stretches == other.stretches

    def __contains__(self, time_ns: int) -> bool:
        """Whether an instant [ns since the epoch] is covered."""
        place = bisect_right(self._begins, time_ns) - 1
        return place >= 0 and time_ns <= self._ends[place]

    @property
    def stretches(self) -> list[list[int]]:
        """Begin and end of each stretch [ns since the epoch]."""
        return [[begin, end] for begin, end in zip(self._begins, self._ends)]

    @property
    def seconds(self) -> float:
        """Their length together [s]."""
        return (sum(self._ends) - sum(self._begins)) * 1e-9

    def copy(self) -> "Covered":
        """Return independent stretches with the same times."""
        return Covered(self.stretches)

    def cover(self, begin: int, end: int) -> None:
        """Cover the time from ``begin`` to ``end`` [ns since the epoch] as well; nothing if it is empty."""
        if end <= begin:
            return
        first = bisect_left(self._ends, begin - _NO_GAP)
        after = bisect_right(self._begins, end + _NO_GAP)
        if first < after:  # stretches that it touches become one with it
            begin, end = min(begin, self._begins[first]), max(end, self._ends[after - 1])
        self._begins[first:after], self._ends[first:after] = [begin], [end]
        if len(self._begins) > MOST:
            gaps = [after - before for before, after in zip(self._ends, self._begins[1:])]
            shortest = gaps.index(min(gaps))
            del self._ends[shortest], self._begins[shortest + 1]

    def fractions(self, begins: np.ndarray, ends: np.ndarray) -> np.ndarray:
        """Return the fraction of each of some stretches that is covered, shape (n,).

        Parameters
        ----------
        begins, ends : of the stretches [ns since the epoch], shape (n,), int64, in order of time; n at least 1.
        """
        first, last = int(begins[0]), int(ends[-1])
        near = slice(bisect_right(self._ends, first), bisect_left(self._begins, last))
        inside = [edge for pair in zip(self._begins[near], self._ends[near]) for edge in pair]
        if not inside:
            return np.zeros(len(begins))
        # Relative to the first instant: seconds since the epoch have no room for nanoseconds in a double.
        edges = np.array([min(max(edge, first), last) - first for edge in inside], float)
        lengths = np.diff(edges) * (np.arange(len(edges) - 1) % 2 == 0)
        until = np.concatenate(([0.0], np.cumsum(lengths)))
        after, before = (np.interp((times - first).astype(float), edges, until) for times in (ends, begins))
        spans = np.maximum((ends - begins).astype(float), 1.0)
        fractions = (after - before) / spans
        fractions[fractions < _WHOLE] = 0.0
        fractions[fractions > 1.0 - _WHOLE] = 1.0
        return fractions
