# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a run says about how sure it is: the bands of its results, sample by sample, for topics, recordings, views and diagnostics.

Samples in, bands and numbers out; all times are those of the samples.  A run has it where its scene asks for it (block ``estimation``).
"""

import math
from collections.abc import Collection

import numpy as np

from bearing_sim.estimation.bands import QUANTITIES, BandEstimator
from bearing_sim.estimation.response import ResponseModel
from bearing_sim.messages.bands import BANDS, EDGES, Bands
from bearing_sim.scene.scene import Scene

UNITS = ("", "h", "m", "h")
"""Of `bearing_sim.estimation.bands.QUANTITIES`."""
_OIL = "lubricant.temperature"  # the field that an input replaces
_SHOWN_UNITS = {"": "fraction"}  # in diagnostics


class LiveEstimation:
    """Estimates of one run.

    Parameters
    ----------
    scene : of the run.
    response : of the scene (`bearing-sim table SCENE --bands`).
    """

    def __init__(self, scene: Scene, response: ResponseModel):
        self._scene, self._response = scene, response
        self._known: frozenset[str] = frozenset()
        self._period = 1.0 / scene.estimation.rate
        self.restart()

    def restart(self) -> None:
        """Forget the run so far."""
        self._bands = BandEstimator(self._scene, self._response, sorted(self._known))
        self._last_period = -math.inf
        self._newest: Bands | None = None

    def know(self, channels: Collection[str]) -> None:
        """Take which input channels have messages: what is measured is not uncertain."""
        known = frozenset([_OIL] if "oil_temperature" in channels else [])
        if known != self._known:
            self._known = known
            self._bands.know(sorted(known))

    def take(self, block: np.ndarray) -> list[Bands]:
        """Return the bands of the samples that follow, at most ``estimation.rate`` a simulated second.

        Parameters
        ----------
        block : samples in order, shape (n,), see `bearing_sim.model.sample`.
        """
        if not self._scene.estimation.bands:
            return []
        periods = np.floor(block["time"] / self._period + 1e-6)
        chosen = np.flatnonzero(np.diff(periods, prepend=self._last_period))
        if not len(chosen):
            return []
        self._last_period = float(periods[-1])
        samples = block[chosen]
        edges = self._bands.take(samples)
        own = np.stack([samples["cage_slip"], samples["rating_life"], samples["running_clearance"], self._bands.remaining_life], axis=1)
        self._newest = Bands(BANDS, QUANTITIES, UNITS, samples["time"].copy(), np.concatenate([own[:, :, None], edges], axis=2))
        return [self._newest]

    @property
    def newest(self) -> dict[str, tuple[float, float]]:
        """The newest band of each of `bearing_sim.estimation.bands.QUANTITIES`, 5 and 95 % quantile; empty before the first."""
        if self._newest is None:
            return {}
        return {name: (float(low), float(high)) for name, (_, low, high) in zip(QUANTITIES, self._newest.numbers[-1])}

    @property
    def values(self) -> dict[str, float]:
        """Diagnostics values, the unit in each key: the newest band of each quantity; empty before the first."""
        units = dict(zip(QUANTITIES, UNITS))
        return {
            f"{name.replace('_', ' ')} {edge} [{_SHOWN_UNITS.get(units[name], units[name])}]": number
            for name, pair in self.newest.items()
            for edge, number in zip(EDGES, pair)
        }
