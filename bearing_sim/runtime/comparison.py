# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured cage speeds held against predicted ones at the stamps of the measurements, whichever comes first."""

import math
from bisect import bisect_left, bisect_right, insort

import numpy as np

from bearing_sim.events import Measurement
from bearing_sim.runtime.residual import ResidualMonitor

_KEPT = 2000  # outputs: a measurement may come so many after its time
_PREDICTED = ("time", "shaft_speed", "ideal_cage_speed", "cage_slip")


class Comparison:
    """Feeds a `bearing_sim.runtime.residual.ResidualMonitor`, each measurement with the prediction at its own stamp.

    Between outputs the prediction is linear.  A measurement waits for the output after it; one older than all outputs that are kept
    is compared with nothing.

    Parameters
    ----------
    residual : what judges.
    """

    def __init__(self, residual: ResidualMonitor):
        self.residual = residual
        self.restart()

    def restart(self) -> None:
        """Forget outputs and measurements; what is usual stays with ``residual``."""
        self._times: list[float] = []
        self._rows: list[tuple[float, ...]] = []
        self._waiting: list[tuple[float, float]] = []
        self.compared: Measurement | None = None

    def measure(self, time: float, cage_speed: float) -> None:
        """Take in a measurement [s, rad/s]."""
        insort(self._waiting, (time, cage_speed))

    def predict(self, block: np.ndarray) -> list[Measurement]:
        """Take in outputs (see `bearing_sim.sample`), in order of time, and return the comparisons that they allow."""
        rows = list(zip(*(block[name].tolist() for name in _PREDICTED)))
        self._times += [row[0] for row in rows]
        self._rows += rows
        found = self.due()
        if len(self._times) > 2 * _KEPT:
            del self._times[:-_KEPT], self._rows[:-_KEPT]
        return found

    def due(self) -> list[Measurement]:
        """Return the comparisons that measurements since the last call allow."""
        if not self._times or not self._waiting:
            return []
        ready = bisect_right(self._waiting, (self._times[-1], math.inf))
        taken, self._waiting = self._waiting[:ready], self._waiting[ready:]
        return [self._compare(time, speed) for time, speed in taken]

    def _compare(self, time: float, cage_speed: float) -> Measurement:
        _, shaft_speed, ideal, predicted = self._at(time)
        measured = 1.0 - cage_speed / ideal if ideal else math.nan
        self.residual.take(time, shaft_speed, measured, predicted)
        self.compared = Measurement(time, cage_speed, measured - predicted)
        return self.compared

    def _at(self, time: float) -> tuple[float, ...]:
        place = bisect_left(self._times, time)
        after = self._rows[place]
        if after[0] == time:
            return after
        if place == 0:
            return (time, after[1], math.nan, math.nan)
        before = self._rows[place - 1]
        share = (time - before[0]) / (after[0] - before[0])
        return tuple(old + share * (new - old) for old, new in zip(before, after))
