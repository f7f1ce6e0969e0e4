# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Keep real time by giving up fidelity: step down to a cheaper level when the solver is too slow, and up again when it is fast enough.

It judges by what ticks cost: simulated over wall seconds, lately.  How many times dearer the level above is was measured when it last
ran; so the cost of the level that runs now says whether that one would hold.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

from bearing_sim.simulation import Simulation

_TOO_SLOW = 1.05  # times real time: below this the lag grows, or is about to
_FAST_ENOUGH = 1.4  # what the level above must promise: well over _TOO_SLOW, so that it does not come back only to fall again
_MEMORY = 0.25  # s over which the factor is a mean: a lag that can be caught up must not be used up before it is noticed
_LONGEST_WAIT = 300.0  # s


class Change(NamedTuple):
    """A change of level."""

    simulation: Simulation  # that goes on
    down: bool
    text: str


class Governor:
    """Chooses the level that a running model computes at.

    A level that falls again sooner than it was waited for is waited for twice as long the next time.

    Parameters
    ----------
    ladder : simulations of one bearing at its levels, the wanted one first, each cheaper than the one before, compiled.
    patience : time for which the level above must promise enough before it is tried again [s].
    """

    def __init__(self, ladder: Sequence[Simulation], patience: float = 5.0):
        self._ladder, self._patience = list(ladder), patience
        self._dearer = [math.nan] * len(self._ladder)  # how many times a level's cost is that of the one below
        self._begin(0)
        self._wait, self._came_up = patience, False

    @property
    def level(self) -> str:
        """The level that runs."""
        return self._ladder[self._rung].scene.level

    @property
    def wanted(self) -> str:
        """The level that runs on a fast enough machine."""
        return self._ladder[0].scene.level

    @property
    def factor(self) -> float:
        """Simulated over wall seconds, lately; NaN before the first tick of this level."""
        return self._simulated / self._spent if self._spent > 0.0 else math.nan

    def restart(self) -> Simulation:
        """Return to the wanted level for a run that starts anew; the caller resets the simulation."""
        self._begin(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def leave(self) -> Simulation:
        """Return to the wanted level, from the same cage angle and speed, for a run that goes on without a governor."""
        if self._rung:
            self._change(0)
        self._wait, self._came_up = self._patience, False
        return self._ladder[0]

    def consider(self, simulated: float, spent: float) -> Change | None:
        """Take in one tick and return the change that it calls for, or None.

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
            self._dearer[self._rung - 1] = max(self.factor / self._left_at, 1.0)
            self._left_at = math.nan
        if self.factor < _TOO_SLOW and self._rung + 1 < len(self._ladder):
            return self._go_down()
        if self._rung == 0:
            return None
        promised = self.factor / self._dearer[self._rung - 1]
        self._promising = self._promising + elapsed if promised > _FAST_ENOUGH else 0.0
        return self._go_up(promised) if self._promising >= self._wait else None

    def _go_down(self) -> Change:
        if self._came_up:
            self._wait = min(2.0 * self._wait, _LONGEST_WAIT) if self._stayed < self._wait else self._patience
        factor, below = self.factor, self._ladder[self._rung + 1].scene.level
        text = f"level {self.level} holds {factor:.3g} of real time on this machine: {below} goes on, from the same cage angle and speed"
        simulation = self._change(self._rung + 1)
        self._left_at, self._came_up = factor, False
        return Change(simulation, True, text)

    def _go_up(self, promised: float) -> Change:
        above = self._ladder[self._rung - 1].scene.level
        text = f"level {above} goes on, for which {promised:.3g} of real time is expected, from the same cage angle and speed"
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
