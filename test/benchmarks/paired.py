# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tell a small cost from the noise of a machine that others use too: short stretches with and without, in turn, and pairs of equals beside.

Every stretch with what is measured stands between two without; what it is of their mean is one value.  Between them stand stretches that
are treated alike but are without it, too: their values say what the same arithmetic finds where there is nothing to find.
"""

import os
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import binom

WITHOUT, WITH, CONTROL = "without", "with", "control"
_CONFIDENCE = 0.95


class Spread(NamedTuple):
    """What pairs have found.

    Attributes
    ----------
    median : of the pairs.
    low, high : the interval that holds the true median with at least 95 % confidence, whatever the distribution; the extremes where there are
        fewer than six pairs.
    pairs : how many.
    """

    median: float
    low: float
    high: float
    pairs: int


def order(pairs: int) -> list[str]:
    """Return the kinds of stretches, one after the other, that give so many pairs with and so many controls."""
    return [WITHOUT, *(kind for _ in range(pairs) for kind in (WITH, WITHOUT, CONTROL, WITHOUT))]


def ratios(kinds: Sequence[str], values: Sequence[float], kind: str) -> Spread:
    """Return what stretches of one kind are of the mean of the stretches before and after them."""
    return spread(each_ratio(kinds, values, kind))


def each_ratio(kinds: Sequence[str], values: Sequence[float], kind: str) -> list[float]:
    """Return what each stretch of one kind is of the mean of the stretches before and after it."""
    return [values[k] / (0.5 * (values[k - 1] + values[k + 1])) for k, one in enumerate(kinds) if one == kind]


def differences(kinds: Sequence[str], values: Sequence[float], kind: str) -> Spread:
    """Return what stretches of one kind are beyond the mean of the stretches before and after them."""
    return spread(values[k] - 0.5 * (values[k - 1] + values[k + 1]) for k, one in enumerate(kinds) if one == kind)


def spread(values: Iterable[float]) -> Spread:
    """Return the median of some values and its interval, from the binomial distribution of how many lie below it."""
    ordered = np.sort(np.fromiter(values, float))
    count = len(ordered)
    outside = max(int(binom.ppf((1 - _CONFIDENCE) / 2, count, 0.5)) - 1, 0)
    return Spread(float(np.median(ordered)), float(ordered[outside]), float(ordered[count - 1 - outside]), count)


class ThreadBooks:
    """What the kernel has booked for the thread that made this: to be read by that thread only."""

    def __init__(self):
        try:
            self._books = os.open("/proc/thread-self/schedstat", os.O_RDONLY)
        except OSError:  # a system without such books
            self._books = None

    def waited(self) -> float:
        """Return the time [s] for which the thread has been ready to run and waited for a core; 0 where the kernel keeps no books."""
        return 1e-9 * int(os.pread(self._books, 64, 0).split()[1]) if self._books is not None else 0.0

    def close(self) -> None:
        """Let them go."""
        if self._books is not None:
            os.close(self._books)


def stolen_share() -> tuple[float, float]:
    """Return the processor time that the host has given to others, and all of it, since the system started [ticks]; zeros where not told."""
    try:
        with open("/proc/stat", encoding="ascii") as books:
            numbers = [float(number) for number in books.readline().split()[1:9]]
    except OSError:
        return 0.0, 0.0
    return numbers[7], sum(numbers)
