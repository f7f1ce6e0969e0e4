# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keep real time by reducing fidelity: change to a lower level when the solver is too slow, and back when it is fast enough.

The criterion is the recent cost of ticks, simulated over wall seconds.  The ratio of costs between a level and the one above was measured when
the upper one last ran, so the cost of the present level predicts whether the upper one would keep real time.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from bearing_sim.simulation import Simulation

_TOO_SLOW = 1.05  # times real time: below this the lag grows, or soon will
_FAST_ENOUGH = 1.4  # predicted for the level above before it is used: well over _TOO_SLOW, so that it is not left again at once
_MEMORY = 0.25  # [s] over which the factor is a mean: short, so that a change comes before the lag that can be caught up is used up
_LONGEST_WAIT = 300.0  # [s]


class Change(NamedTuple):
    """A change of level."""

    simulation: Simulation  # that continues the run
    down: bool
    text: str


class Governor:
    """Chooses the level that a running model computes at.

    If a level has to be left sooner than the wait before it, the next wait is twice as long.

    Parameters
    ----------
    ladder : simulations of one bearing at its levels, compiled, the wanted one first, each of lower fidelity than the one before.
    patience : time for which the level above must be predicted to be fast enough before it is tried again [s].
    """

    def __init__(self, ladder: Sequence[Simulation], patience: float = 5.0):
        self._ladder, self._patience = list(ladder), patience
        self._cost_ratios = [math.nan] * len(self._ladder)  # cost of a level over that of the one below
        self._begin(0)
        self._wait, self._came_up = patience, False

    @property
    def level(self) -> str:
        """The level that runs."""
        return self._ladder[self._rung].scene.level

    @property
    def wanted(self) -> str:
        """The level that runs if the machine is fast enough."""
        return self._ladder[0].scene.level

    @property
    def factor(self) -> float:
        """Simulated over wall seconds, recently; NaN before the first tick of this level."""
        return self._simulated / self._spent if self._spent > 0.0 else math.nan

    def restart(self) -> Simulation:
        """Return to the wanted level for a run that starts again; the caller resets the simulation."""
        self._begin(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def leave(self) -> Simulation:
        """Return to the wanted level, from the same cage angle and speed, for a run that continues without a governor."""
        if self._rung:
            self._change(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def consider(self, simulated: float, spent: float) -> Change | None:
        """Take one tick and return the change that it calls for, or None.

        Parameters
        ----------
        simulated : length of the tick [s].
        spent : wall time that computing it took [s].
        """
        elapsed = max(simulated, spent)
        kept = math.exp(-elapsed / _MEMORY)
        self._simulated, self._spent = self._simulated * kept + simulated, self._spent * kept + spent
        self._stayed += elapsed
        if self._stayed < _MEMORY:  # the first ticks of a level are not typical
            return None
        if not math.isnan(self._left_at):
            self._cost_ratios[self._rung - 1] = max(self.factor / self._left_at, 1.0)
            self._left_at = math.nan
        factor = self.factor
        if factor < _TOO_SLOW and self._rung + 1 < len(self._ladder):
            return self._go_down()
        if self._rung == 0:
            return None
        promised = factor / self._cost_ratios[self._rung - 1]
        self._promising = self._promising + elapsed if promised > _FAST_ENOUGH else 0.0
        return self._go_up(promised) if self._promising >= self._wait else None

    def _go_down(self) -> Change:
        if self._came_up:
            self._wait = min(2.0 * self._wait, _LONGEST_WAIT) if self._stayed < self._wait else self._patience
        factor, below = self.factor, self._ladder[self._rung + 1].scene.level
        text = f"level {self.level} reaches {factor:.3g} of real time on this machine: {below} continues from the same cage angle and speed"
        simulation = self._change(self._rung + 1)
        self._left_at, self._came_up = factor, False
        return Change(simulation, True, text)

    def _go_up(self, promised: float) -> Change:
        above = self._ladder[self._rung - 1].scene.level
        text = f"level {above}, expected to reach {promised:.3g} of real time, continues from the same cage angle and speed"
        simulation = self._change(self._rung - 1)
        self._came_up = True
        return Change(simulation, False, text)

    def _change(self, rung: int) -> Simulation:
        before, after = self._ladder[self._rung], self._ladder[rung]
        after.take_over(before)
        self._begin(rung)
        return after

    def _begin(self, rung: int) -> None:
        self._rung = rung
        self._simulated = self._spent = self._stayed = self._promising = 0.0
        self._left_at = math.nan
