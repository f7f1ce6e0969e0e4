# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Thinning out of long runs: lowest, mean and highest values of buckets of time, and every row around what happened.

An hour at 1 kHz is 3.6 million rows of a hundred numbers: no viewer needs them, none opens them well.
"""

from typing import NamedTuple

import numpy as np

AROUND = 1.0  # [s] before and after an event that are kept in full
FULL_ROWS = 100_000  # a run of no more is kept in full
_BUCKETS = 8000  # of a run whose length is known: four for each pixel of a wide screen
_LEAST_ROWS = 8  # of a bucket: fewer are not worth it
_BUCKET_WITHOUT_END = 0.2  # [s], of a run of unknown length
_PIECE = 256  # rows that are worth sending: a viewer's memory and time go with the number of pieces
_ROWS_AROUND_EVENTS = 150_000  # kept in full at most; later events are seen in the buckets only


class Lines(NamedTuple):
    """Series over time.

    Attributes
    ----------
    times : [s], shape (n,).
    values : by entity path, each of shape (n,) or (n, k).
    """

    times: np.ndarray
    values: dict[str, np.ndarray]


class Thinned(NamedTuple):
    """What is left of series.

    Attributes
    ----------
    lines : every row where all is kept, and the means of buckets, at their middles, elsewhere; in order of time.
    ranges : lowest and highest value of each bucket of a single series, shape (buckets, 2), at the buckets' middles.
    """

    lines: Lines
    ranges: Lines


def bucket_for(interval: float, duration: float | None) -> float | None:
    """Return the length of a bucket [s] for rows every ``interval`` [s] over ``duration`` [s] (None: unknown); None where all is kept."""
    if duration is None:
        return max(_BUCKET_WITHOUT_END, 2 * _LEAST_ROWS * interval)
    if duration <= FULL_ROWS * interval:
        return None
    return max(duration / _BUCKETS, _LEAST_ROWS * interval)


class Overview:
    """Thins out the series of one run.

    Parameters
    ----------
    bucket : length of a bucket [s].
    full_rows : so many rows at the beginning are kept in full.
    """

    def __init__(self, bucket: float, full_rows: int = 0):
        self._bucket = bucket
        self._whole = full_rows  # rows still to be kept in full whatever happens
        self._allowed = _ROWS_AROUND_EVENTS
        self._marks: list[float] = []
        self._waiting: list[Lines] = []  # not decided yet: an event may follow
        self._decided: list[Thinned] = []  # not handed on yet: too few

    def mark(self, time: float) -> None:
        """Keep in full what lies around an event at ``time`` [s]."""
        self._marks.append(time)

    def add(self, lines: Lines) -> Thinned | None:
        """Take in rows that follow those before; return what is decided by now, once it is enough to be worth sending."""
        if self._whole > 0:
            self._whole -= len(lines.times)
            return Thinned(lines, Lines(lines.times[:0], {}))
        self._waiting.append(lines)
        newest, oldest = float(lines.times[-1]), float(self._waiting[0].times[0])
        limit = np.floor((newest - AROUND) / self._bucket) * self._bucket
        if limit - oldest > max(AROUND, 8 * self._bucket):
            self._decided.append(self._decide(limit))
        return self._handed_on() if sum(len(part.lines.times) for part in self._decided) >= _PIECE else None

    def finish(self) -> Thinned | None:
        """Return what is left of the rows that waited."""
        if self._waiting:
            self._decided.append(self._decide(np.inf))
        return self._handed_on() if self._decided else None

    def _handed_on(self) -> Thinned:
        parts, self._decided = self._decided, []
        ranges = [part.ranges for part in parts if len(part.ranges.times)]
        return Thinned(_joined([part.lines for part in parts]), _joined(ranges) if ranges else parts[0].ranges)

    def _decide(self, limit: float) -> Thinned:
        whole = _joined(self._waiting)
        count = int(np.searchsorted(whole.times, limit))
        decided, rest = _cut(whole, slice(0, count)), _cut(whole, slice(count, None))
        self._waiting = [rest] if len(rest.times) else []
        kept = self._around_events(decided.times)
        full, thin = _cut(decided, kept), _cut(decided, ~kept)
        if not len(thin.times):
            return Thinned(full, Lines(thin.times, {}))
        numbers = np.floor(thin.times / self._bucket)
        starts = np.flatnonzero(np.diff(numbers, prepend=np.nan) != 0)
        middles = (numbers[starts] + 0.5) * self._bucket
        middles = np.clip(middles, thin.times[starts], thin.times[np.append(starts[1:], len(thin.times)) - 1])  # of buckets that events cut
        means = {path: _bucket_means(values, starts) for path, values in thin.values.items()}
        ranges = {
            path: np.stack((np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)), axis=1)
            for path, values in thin.values.items()
            if values.ndim == 1
        }
        return Thinned(_in_order(full, Lines(middles, means)), Lines(middles, ranges))

    def _around_events(self, times: np.ndarray) -> np.ndarray:
        """Return which rows lie around an event, shape (n,)."""
        kept = np.zeros(len(times), bool)
        if not len(times):
            return kept
        for mark in self._marks:
            first, end = np.searchsorted(times, (mark - AROUND, mark + AROUND))
            if end - first <= self._allowed:
                self._allowed -= int(np.count_nonzero(~kept[first:end]))
                kept[first:end] = True
        self._marks = [mark for mark in self._marks if mark + AROUND > times[-1]]
        return kept


def _joined(parts: list[Lines]) -> Lines:
    return Lines(
        np.concatenate([part.times for part in parts]), {path: np.concatenate([part.values[path] for part in parts]) for path in parts[0].values}
    )


def _cut(lines: Lines, which) -> Lines:
    return Lines(lines.times[which], {path: values[which] for path, values in lines.values.items()})


def _in_order(one: Lines, other: Lines) -> Lines:
    if not len(one.times):
        return other
    both = _joined([one, other])
    return _cut(both, np.argsort(both.times, kind="stable"))


def _bucket_means(values: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the mean of the known values from each start to the next; NaN where none is known."""
    known = np.isfinite(values)
    sums = np.add.reduceat(np.where(known, values, 0.0), starts, axis=0, dtype=float)
    counts = np.add.reduceat(known, starts, axis=0, dtype=float)
    return np.divide(sums, counts, out=np.full(sums.shape, np.nan), where=counts > 0)
