# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A watcher: how many rollers the inner ring presses on, and whether none of them is, so that nothing drives the cage."""

import numpy as np

from bearing_sim.messages.events import Event, Level
from bearing_sim.model.turning import turns
from bearing_sim.watchers.monitoring.watchers import Watcher


class LoadedRollers(Watcher):
    """Counts the rollers under load; an event while the shaft turns and no roller has an inner load."""

    def __init__(self, scene):
        super().__init__(scene)
        self.restart("")

    def restart(self, why):
        """Forget what was seen."""
        self._loaded, self._fewest, self._turning = None, None, False

    def see(self, block):
        """Count the rollers with an inner load in each sample."""
        loaded = np.count_nonzero(block["inner_load"] > 0.0, axis=1)
        self._loaded = int(loaded[-1])
        self._fewest = int(loaded.min()) if self._fewest is None else min(self._fewest, int(loaded.min()))
        self._turning = bool(turns(block["shaft_speed"][-1:], self.scene.thresholds.slip_from_speed)[0])
        return ()

    def events(self, now):
        """Return the event of a cage that no roller drives."""
        if not self._turning or self._loaded:
            return ()
        return [Event(now, Level.WARN, "", "", "no roller is loaded between the rings: nothing drives the cage")]

    def values(self, now):
        """Return the newest number of loaded rollers, and the fewest so far."""
        return {} if self._loaded is None else {"rollers loaded": self._loaded, "fewest rollers loaded": self._fewest}
