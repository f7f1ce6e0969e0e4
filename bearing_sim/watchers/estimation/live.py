# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Live uncertainty bands and calibration results, for topics, recordings and diagnostics.

Samples and measurements in, bands, events and numbers out; all times are those of the samples.  A run has it where its scene asks for it (block
``estimation``).
"""

import math
from collections.abc import Collection, Mapping

import numpy as np

from bearing_sim.messages.bands import BANDS, EDGES, ESTIMATES, Bands
from bearing_sim.messages.events import Event
from bearing_sim.messages.topics import MEASURED, MEASURED_CLEARANCE
from bearing_sim.model.turning import turns
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.scene.uncertainty import quantities, ranges_of, without_dimensions
from bearing_sim.watchers.estimation.bands import PROBABILITIES, QUANTITIES, BandEstimator, quantiles
from bearing_sim.watchers.estimation.estimator import Estimator
from bearing_sim.watchers.estimation.response import ResponseModel, kept_response
from bearing_sim.watchers.monitoring.watchers import Watcher

UNITS = ("", "h", "m", "h")
"""Of `bearing_sim.watchers.estimation.bands.QUANTITIES`."""
_SLIP = QUANTITIES.index("cage_slip")
_TOGETHER = 100  # samples: those of many at once cost a fraction of single ones
_OIL = "lubricant.temperature"  # the field that an input replaces
_SHOWN_UNITS = {"": "fraction"}  # in diagnostics


class LiveEstimation(Watcher):
    """Estimates of one run.

    Before anything is measured, bands lie about what the level computes.  Once measurements have calibrated fields, values and bands are those of the
    calibrated model; the samples stay what the level computes.

    Parameters
    ----------
    scene : of the run.
    response : of the scene (`bearing-sim table SCENE --bands`).
    """

    def __init__(self, scene: Scene, response: ResponseModel):
        super().__init__(scene)
        self._response, self.together = response, 1 if scene.estimation.calibrated else _TOGETHER
        self._known: frozenset[str] = frozenset()
        self._period = 1.0 / scene.estimation.rate
        self._estimator = Estimator(scene, response) if scene.estimation.calibrated else None
        self.restart("")

    @classmethod
    def resource(cls, scene: Scene) -> ResponseModel | None:
        """Return the response of a scene (`bearing_sim.watchers.estimation.response.kept_response`)."""
        return kept_response(scene)

    def restart(self, why: str) -> None:
        """Begin another run; what measurements have taught is kept."""
        self._bands = BandEstimator(self.scene, self._response, sorted(self._known))
        self._last_period = self._next_estimates = -math.inf
        self._newest: Bands | None = None
        if self._estimator is not None:
            self._estimator.interrupt()
            self._use_posterior()

    def _know_what_is_heard(self) -> None:
        if self.run.heard is not None:
            self.know(self.run.heard)

    def know(self, channels: Collection[str]) -> None:
        """Take which input channels have messages: what is measured is not uncertain."""
        known = frozenset([_OIL] if "oil_temperature" in channels else [])
        if known == self._known:
            return
        self._known = known
        self._bands.know(sorted(known))
        if self._estimator is not None:
            learned = self._estimator.learned
            self._estimator = Estimator(self.scene, self._response, sorted(known))
            self._estimator.restore(learned)
            self._use_posterior()

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on; what was learned is kept."""
        super().adjust(thresholds)
        self._bands.adjust(thresholds.remaining_life_memory)

    @property
    def is_calibrated(self) -> bool:
        """Whether measurements have taught anything."""
        return self._estimator is not None and self._estimator.is_calibrated

    @property
    def learned(self) -> dict[str, object]:
        """What measurements have taught, as JSON has it (see `bearing_sim.watchers.estimation.estimator.Estimator.learned`)."""
        return {} if self._estimator is None else self._estimator.learned

    def recall(self, learned: Mapping[str, object], seconds: float = 0.0) -> None:
        """Continue from what was learned some time ago [s]; from nothing where it is empty, or of other ranges.

        Raises
        ------
        KeyError, TypeError, ValueError
            It is something else.
        """
        if self._estimator is not None:
            try:
                self._estimator.restore(learned, seconds)
            finally:
                self._use_posterior()

    def accept_change(self) -> bool:
        """Take the machine as it is since a change for the new normal; return whether there was a change."""
        if self._estimator is None or self._estimator.change is None:
            return False
        self._estimator.accept()
        self._use_posterior()
        return True

    @property
    def replaces(self) -> tuple[str, ...]:
        """Once calibrated, what the calibrated model does not explain is judged, instead of what the scene's own values do not."""
        return ("cage_slip",) if self.is_calibrated else ()

    def serve(self, service: str) -> tuple[bool, str] | None:
        """Accept a change."""
        if service != "accept_change" or not self.accept_change():
            return None
        return True, "the calibration continues from the changed machine; the change is reported no longer"

    @property
    def remark(self) -> str:
        """What is said about the estimates while there is nothing to report."""
        note = without_dimensions(one.field for one in ranges_of(self.scene)) if self.scene.estimation.bands else ""
        if self._estimator is None:
            return f"bands by the ranges of the scene{note}; nothing is calibrated"
        return f"{'calibrated by measurements' if self.is_calibrated else 'waiting for measurements to calibrate by'}{note}"

    def hear(self, channel: str, time: float, value: float, standard_error: float) -> None:
        """Take a measurement, where it belongs to a prediction and has not taught anything in an earlier run."""
        measure = {MEASURED: self.measure, MEASURED_CLEARANCE: self.measure_clearance}.get(channel)
        if measure is None or not self.run.is_predicted or (self.run.acts_on_arrival and self.run.newest is None):
            return
        self._know_what_is_heard()
        if not self.run.watchers.memory.contained(self.run.stamp(time)):
            measure(time, value, standard_error)

    def is_calm(self, block: np.ndarray) -> bool:
        """Return whether nothing that is measured acts from sample to sample."""
        return self._estimator is None

    def measure(self, time: float, cage_speed: float, standard_error: float = math.nan) -> None:
        """Take a measured cage speed and its standard error [rad/s], NaN where it is not known; ``time`` [s] may be later than the newest sample."""
        if self._estimator is not None:
            self._estimator.measure(time, cage_speed, standard_error)

    def measure_clearance(self, time: float, clearance: float, standard_error: float = math.nan) -> None:
        """Take a measured diametral running clearance and its standard error [m], parameters as of `measure`."""
        if self._estimator is not None:
            self._estimator.measure_clearance(time, clearance, standard_error)

    def see(self, block: np.ndarray) -> list[Bands]:
        """Return the bands of the samples that follow, at most ``estimation.rate`` a simulated second, and the estimates every ``interval``.

        Parameters
        ----------
        block : samples in order, shape (n,), n at least 1, see `bearing_sim.model.sample`.
        """
        found = []
        self._know_what_is_heard()
        if self._estimator is not None:
            if self._estimator.update(block):
                self._use_posterior()
            now = float(block["time"][-1])
            if now >= self._next_estimates:
                self._next_estimates = now + self.scene.estimation.interval * (1.0 - 1e-9)
                found.append(self._estimates(now))
        if self.scene.estimation.bands:
            found += self._bands_of(block)
        return found

    def _bands_of(self, block: np.ndarray) -> list[Bands]:
        periods = np.floor(block["time"] / self._period + 1e-6)
        chosen = np.flatnonzero(np.diff(periods, prepend=self._last_period))
        if not len(chosen):
            return []
        self._last_period = float(periods[-1])
        samples = block[chosen]
        edges = self._bands.estimate(samples)
        if self.is_calibrated:
            numbers = np.concatenate([self._bands.medians[:, :, None], edges], axis=2)
            turning = np.isfinite(numbers[:, _SLIP]).all(axis=1) & turns(samples["shaft_speed"], self.scene.thresholds.slip_from_speed)
            if turning.any():
                numbers[turning, _SLIP] = self._calibrated_slip(samples[turning])
        else:
            own = np.stack([samples["cage_slip"], samples["rating_life"], samples["running_clearance"], self._bands.remaining_life], axis=1)
            numbers = np.concatenate([own[:, :, None], edges], axis=2)
        self._newest = Bands(BANDS, QUANTITIES, UNITS, samples["time"].copy(), numbers)
        return [self._newest]

    def _calibrated_slip(self, samples: np.ndarray) -> np.ndarray:
        """Return median, 5 and 95 % quantile of the slip by the calibrated model with its own error, shape (n, 3)."""
        drawn = np.stack([self._estimator.prediction(sample) for sample in samples])
        return quantiles(drawn, (0.5, *PROBABILITIES))

    def _use_posterior(self) -> None:
        """Let bands follow from what measurements have taught."""
        if self._estimator.is_calibrated:
            self._bands.use(self._estimator.posterior.scores)

    def _estimates(self, now: float) -> Bands:
        """Return the calibrated fields with their bands at ``now`` [s]."""
        fields = [one for one in self._estimator.estimates() if one.field in self.scene.estimation.calibrated]
        declared = quantities(type(self.scene))
        units = tuple(declared[one.field].unit if one.field in declared else "" for one in fields)
        numbers = np.array([[(one.value, one.low, one.high) for one in fields]])
        return Bands(ESTIMATES, tuple(one.field for one in fields), units, np.array([now]), numbers)

    @property
    def estimates(self) -> dict[str, tuple[float, float, float]]:
        """Value, 5 and 95 % quantile of the calibrated fields [SI], by path; empty before anything is measured."""
        if not self.is_calibrated:
            return {}
        return {one.field: (one.value, one.low, one.high) for one in self._estimator.estimates() if one.field in self.scene.estimation.calibrated}

    def events(self, now: float) -> list[Event]:
        """Return the events that hold, stamped ``now`` [s] (see `bearing_sim.watchers.estimation.estimator.Estimator.events`)."""
        return [] if self._estimator is None else self._estimator.events(now)

    @property
    def newest(self) -> dict[str, tuple[float, float]]:
        """The newest band of each of `bearing_sim.watchers.estimation.bands.QUANTITIES`, 5 and 95 % quantile; empty before the first."""
        if self._newest is None:
            return {}
        return {name: (float(low), float(high)) for name, (_, low, high) in zip(QUANTITIES, self._newest.numbers[-1])}

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values at ``now`` [s], the unit in each key: the newest bands, and what measurements have taught."""
        units = dict(zip(QUANTITIES, UNITS))
        bands = {
            f"{name.replace('_', ' ')} {edge} [{_SHOWN_UNITS.get(units[name], units[name])}]": number
            for name, pair in self.newest.items()
            for edge, number in zip(EDGES, pair)
        }
        taught = {} if self._estimator is None else self._estimator.values(now)
        return bands | {f"estimate: {key}": value for key, value in taught.items()}
