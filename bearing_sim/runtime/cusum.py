# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A change told from noise: numbers made standard normal while nothing changes, and a two-sided CUSUM with a known false-alarm rate.

All numbers are batch means that come at even intervals, so that a run length is a time.
"""

import math

from scipy.special import ndtri, stdtr

_REFERENCE = 0.5  # k: half of the smallest change that matters, one standard deviation
_OVERSHOOT = 1.166  # of a sum of normal steps beyond its border, both ends together (Siegmund 1985)
_FARTHEST = 4.0  # standard deviations that one batch can count: a single wild reading is no change
_SCATTER_KNOWN = 20  # batches from which a wild one can be told
_MOST_CORRELATED = 0.98
_STEEPEST_TAIL = 8.0  # beyond it Student's distribution is only told apart from 1 by round-off


def run_length(threshold: float, reference: float = _REFERENCE) -> float:
    """Return the mean number of standard normal steps from 0 until a two-sided CUSUM passes its threshold.

    One side: (exp(2 k b) - 2 k b - 1)/(2 k^2) with b = h + 1.166 (Siegmund, Sequential Analysis, 1985; Montgomery 2009, eq. 9.6, for a drift of
    -k); both sides together half of it.

    Parameters
    ----------
    threshold : h, in standard deviations.
    reference : k, in standard deviations.
    """
    exponent = 2.0 * reference * (threshold + _OVERSHOOT)
    return 0.5 * (math.expm1(exponent) - exponent) / (2.0 * reference**2)


def threshold_for(length: float, reference: float = _REFERENCE) -> float:
    """Return the threshold h of a mean run length of ``length`` steps without change, the inverse of `run_length`.

    Parameters
    ----------
    length : more than that of h = 0, some 2 steps.
    reference : k.

    Raises
    ------
    ValueError
        The run length is that short.
    """
    if not length > run_length(0.0, reference):
        raise ValueError(f"a mean run of {length:g} steps between false alarms is too short; expected more than {run_length(0.0, reference):.3g}")
    low, high = 0.0, 1.0
    while run_length(high, reference) < length:
        high *= 2.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if run_length(middle, reference) < length else (low, middle)
    return high


class Whitener:
    """Turns batch means whose mean, scatter and correlation nobody knows into standard normal numbers, independent while nothing changes.

    Each is held against the mean and scatter of all before it, u = Phi^-1(F(t)) with Student's t of as many degrees of freedom, so
    that the false-alarm rate holds from early on although nothing is known beforehand (Hawkins, The Statistician 36, 1987, 299).
    Neighbours that resemble each other are told apart first: of each is taken what the one before lets expect, by the lag-1
    correlation of all so far (a first-order autoregression; Alwan and Roberts, J. Bus. Econ. Stat. 6, 1988, 87-95).

    Parameters
    ----------
    tolerance : lasting change that shall not count: scatter is taken for at least so much that it stays below the reference value.

    Attributes
    ----------
    count : batches from which mean and scatter are known.
    mean : of them.
    """

    def __init__(self, tolerance: float):
        self._tolerance = tolerance
        self.count, self.mean = 0, 0.0
        self._squares = self._products = self._surprises = 0.0
        self._pairs, self._surprised = 0, 0
        self._before = math.nan

    def interrupt(self) -> None:
        """Take the next batch for no neighbour of the last one."""
        self._before = math.nan

    @property
    def correlation(self) -> float:
        """Lag-1 correlation, 0 to 0.98, a standard error above the estimate: too little taken for granted would be false alarms.

        The estimate is what a short course hides above the plain one (Kendall, Biometrika 41, 1954, 403-404).
        """
        if self._pairs < 3 or self._squares <= 0.0:
            return 0.0
        found = self._products / self._pairs / (self._squares / self.count)
        likely = max(found + (1.0 + 3.0 * found) / self._pairs, 0.0)
        return min(likely + math.sqrt(max(1.0 - likely * likely, 0.0) / self._pairs), _MOST_CORRELATED)

    def take(self, value: float, learn: bool = True) -> float:
        """Return the number of a batch; NaN where there is nothing to hold it against.

        Parameters
        ----------
        value : mean of the batch.
        learn : whether mean and scatter shall know of it.
        """
        before, self._before = self._before, value
        if math.isnan(before) or self.count < 3:
            if learn:
                self._learn(value, math.nan, math.nan)
            return math.nan
        correlation = self.correlation
        surprise = (value - self.mean) - correlation * (before - self.mean)
        scatter = math.sqrt(self._surprises / self._surprised) if self._surprised else 0.0
        deviation = max(scatter, self._tolerance * (1.0 - correlation) / _REFERENCE)
        number = _normal(surprise / (deviation * math.sqrt(1.0 + 1.0 / self.count)), max(self._surprised, 1))
        # a wild reading shall not be what is usual, nor make the next one look wild
        farthest = _FARTHEST * deviation if self._surprised >= _SCATTER_KNOWN else math.inf
        kept = min(max(surprise, -farthest), farthest)
        self._before = value + kept - surprise
        if learn:
            self._learn(self._before, before, kept)
        return number

    def _learn(self, value: float, before: float, surprise: float) -> None:
        self.count += 1
        step = value - self.mean
        if not math.isnan(surprise):
            self._surprises += surprise * surprise * (self.count - 1) / self.count
            self._surprised += 1
        self.mean += step / self.count
        self._squares += step * (value - self.mean)
        if not math.isnan(before):
            self._pairs += 1
            self._products += (value - self.mean) * (before - self.mean)


class Cusum:
    """Two-sided cumulative sum of standard normal numbers (Page, Biometrika 41, 1954): S = max(0, S +- u - k), an alarm from h on.

    A sum grows no higher than a little above h, so that an alarm ends soon after its cause; it ends below h/2.

    Parameters
    ----------
    threshold : h.

    Attributes
    ----------
    up, down : float
        The two sums.
    side : int
        1 where the numbers have risen, -1 where they have fallen, else 0.
    rising_for, falling_for : int
        Steps since each sum was 0: for how long the change lasts.
    """

    def __init__(self, threshold: float):
        self.threshold = threshold
        self.restart()

    def restart(self) -> None:
        """Begin with nothing gathered."""
        self.up = self.down = 0.0
        self.side = self.rising_for = self.falling_for = 0

    @property
    def height(self) -> float:
        """The larger sum."""
        return max(self.up, self.down)

    def take(self, number: float) -> int:
        """Take in a number and return the side; what is not a number changes nothing."""
        if math.isnan(number):
            return self.side
        number = min(max(number, -_FARTHEST), _FARTHEST)
        ceiling = 1.25 * self.threshold + _FARTHEST
        self.up = min(max(self.up + number - _REFERENCE, 0.0), ceiling)
        self.down = min(max(self.down - number - _REFERENCE, 0.0), ceiling)
        self.rising_for = self.rising_for + 1 if self.up > 0.0 else 0
        self.falling_for = self.falling_for + 1 if self.down > 0.0 else 0
        if self.height >= self.threshold:
            self.side = 1 if self.up >= self.down else -1
        elif self.side and (self.up if self.side > 0 else self.down) < 0.5 * self.threshold:
            self.side = 0
        return self.side


def _normal(t: float, freedom: int) -> float:
    """Return the standard normal number that is as unlikely as Student's t of so many degrees of freedom."""
    size = min(abs(t), _STEEPEST_TAIL)
    return math.copysign(-float(ndtri(stdtr(freedom, -size))), t)
