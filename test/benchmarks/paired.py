# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Separate a small cost from the noise of a shared machine: short stretches with and without, in turn, and pairs of equals as controls.

Every stretch with what is measured stands between two without; its ratio to their mean is one value.  Between them stand control stretches, which
are treated alike but run without it, too: their ratios show what the same arithmetic finds where there is no effect.
"""

import os
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import binom

WITHOUT, WITH, CONTROL = "without", "with", "control"
_CONFIDENCE = 0.95


class Spread(NamedTuple):
    """The result of pairs.

    Attributes
    ----------
    median : of the pairs.
    low, high : interval that contains the true median with at least 95 % confidence, for any distribution; the extremes if there are fewer
        than six pairs.
    pairs : number of pairs.
    """

    median: float
    low: float
    high: float
    pairs: int


def order(pairs: int) -> list[str]:
    """Return the kinds of successive stretches that make up this number of pairs and of controls."""
    return [WITHOUT, *(kind for _ in range(pairs) for kind in (WITH, WITHOUT, CONTROL, WITHOUT))]


def ratios(kinds: Sequence[str], values: Sequence[float], kind: str) -> Spread:
    """Return the ratios of stretches of one kind to the mean of the stretches before and after them."""
    return spread(each_ratio(kinds, values, kind))


def each_ratio(kinds: Sequence[str], values: Sequence[float], kind: str) -> list[float]:
    """Return the ratio of each stretch of one kind to the mean of the stretches before and after it."""
    return [values[k] / (0.5 * (values[k - 1] + values[k + 1])) for k, one in enumerate(kinds) if one == kind]


def differences(kinds: Sequence[str], values: Sequence[float], kind: str) -> Spread:
    """Return the differences of stretches of one kind from the mean of the stretches before and after them."""
    return spread(values[k] - 0.5 * (values[k - 1] + values[k + 1]) for k, one in enumerate(kinds) if one == kind)


def spread(values: Iterable[float]) -> Spread:
    """Return the median of values and its interval, from the binomial distribution of the number of values below it."""
    ordered = np.sort(np.fromiter(values, float))
    count = len(ordered)
    outside = max(int(binom.ppf((1 - _CONFIDENCE) / 2, count, 0.5)) - 1, 0)
    return Spread(float(np.median(ordered)), float(ordered[outside]), float(ordered[count - 1 - outside]), count)


class ThreadStatistics:
    """Scheduler statistics of the thread that created this object; to be read by that thread only."""

    def __init__(self):
        try:
            self._file = os.open("/proc/thread-self/schedstat", os.O_RDONLY)
        except OSError:  # not provided by this system
            self._file = None

    def waited(self) -> float:
        """Return the time [s] for which the thread was ready to run and waited for a core; 0 if the kernel does not record it."""
        return 1e-9 * int(os.pread(self._file, 64, 0).split()[1]) if self._file is not None else 0.0

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            os.close(self._file)


def stolen_share() -> tuple[float, float]:
    """Return the processor time stolen by the host, and the total, since the system started [ticks]; zeros if unknown."""
    try:
        with open("/proc/stat", encoding="ascii") as file:
            numbers = [float(number) for number in file.readline().split()[1:9]]
    except OSError:
        return 0.0, 0.0
    return numbers[7], sum(numbers)
