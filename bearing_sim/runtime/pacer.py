# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keep simulated time in step with wall time, without ever chasing it.

Pure arithmetic: the caller brings every clock reading along and does the sleeping.
"""

import math
from typing import NamedTuple


class Pace(NamedTuple):
    """How the run keeps time."""

    real_time_factor: float  # simulated over wall seconds, lately; NaN before the first tick
    solver_factor: float  # simulated seconds over seconds spent in the solver, lately: how fast it could go
    lost: float  # [s] wall time given up since the start because the solver was too slow
    resyncs: int  # how often time was given up


class Pacer:
    """Says when simulated time is due.

    The pair (wall, sim) of an anchor and the rate define when each simulated instant is due.  A run that is late by up to
    ``maximum_lag`` catches up by not sleeping; later than that, the lag is counted as lost and the anchor moves to now.

    Parameters
    ----------
    rate : simulated seconds per wall second; 1 is real time.
    maximum_lag : largest lag that is caught up [s of wall time].
    memory : the factors are means over about this long [s of wall time].

    Raises
    ------
    ValueError
        A parameter is not a positive finite number.
    """

    def __init__(self, rate: float = 1.0, maximum_lag: float = 0.1, memory: float = 1.0):
        for name, value in (("rate", rate), ("maximum_lag", maximum_lag), ("memory", memory)):
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} = {value}: expected a positive number")
        self.rate, self.maximum_lag, self._memory = rate, maximum_lag, memory
        self._anchor = (0.0, 0.0)
        self._last_wall = math.nan
        self._wall_sum = self._sim_sum = self._solver_sum = 0.0
        self._lost, self._resyncs = 0.0, 0

    @property
    def pace(self) -> Pace:
        """The factors and the loss so far."""
        held = self._sim_sum / self._wall_sum if self._wall_sum > 0.0 else math.nan
        possible = self._sim_sum / self._solver_sum if self._solver_sum > 0.0 else math.nan
        return Pace(held, possible, self._lost, self._resyncs)

    def anchor(self, wall: float, sim: float) -> None:
        """Let simulated time ``sim`` be due at ``wall``: at the start, after a pause, after a reset.  Nothing counts as lost."""
        self._anchor = (wall, sim)
        self._last_wall = wall

    def lag(self, wall: float, sim: float) -> float:
        """Return how late ``sim`` is at ``wall`` [s of wall time]; negative when it is not due yet."""
        anchor_wall, anchor_sim = self._anchor
        return wall - anchor_wall - (sim - anchor_sim) / self.rate

    def delay(self, wall: float, sim: float) -> float:
        """Return how long to sleep before ``sim`` is due [s]; 0 when it is late.

        Later than ``maximum_lag``, the lag is given up: it is added to the loss and ``sim`` becomes due now.
        """
        lag = self.lag(wall, sim)
        if lag > self.maximum_lag:
            self._lost += lag
            self._resyncs += 1
            self._anchor = (wall, sim)
            return 0.0
        return max(0.0, -lag)

    def worked(self, wall: float, simulated: float, solver_seconds: float) -> None:
        """Account for one tick that ended at ``wall``: ``simulated`` seconds of model time in ``solver_seconds`` of wall time."""
        elapsed = wall - self._last_wall
        self._last_wall = wall
        if not elapsed >= 0.0:  # no anchor yet
            return
        kept = math.exp(-elapsed / self._memory)
        self._wall_sum = self._wall_sum * kept + elapsed
        self._sim_sum = self._sim_sum * kept + simulated
        self._solver_sum = self._solver_sum * kept + solver_seconds
