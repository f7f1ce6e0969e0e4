# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Which of many samples are due: as many a second as asked for, without drift, whatever the samples' own rate."""

import math

_SLACK = 1e-6  # [s] by which a sample may come early: run time is rounded


class Beat:
    """Picks samples out of a run as they come.

    The first is due, then each that is the first at or after a multiple of the period since.  Where run time has skipped more than a
    period, multiples count from there.

    Parameters
    ----------
    rate : samples that are due in each second of run time [Hz]; may be changed at any time, from any thread.
    """

    def __init__(self, rate: float):
        self.rate = rate
        self._last = -math.inf  # multiple that was due last [s]

    def is_due(self, time: float) -> bool:
        """Return whether the sample of a run time [s] is due; asked once for each, in their order."""
        period = 1.0 / self.rate
        late = time - self._last - period
        if late < -_SLACK:
            return False
        self._last = self._last + period if late < period else time
        return True
