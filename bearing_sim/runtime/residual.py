# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Residual slip: what a measured cage slips more than the model says, its fading statistics, and whether it has changed.

A model that is a little wrong gives a residual that is not zero; a machine that changes gives one that changes.  So the usual
residual is learned, and the change detector (`bearing_sim.runtime.cusum`) looks for lasting departures from it.  Residuals are
averaged over batches first, which takes out what resembles its neighbours within a batch; what batches still resemble each other is
taken out by the detector.  Rest, start-up and changes of speed are left out: there slip is undefined, or a matter of who was
measured first.
"""

import math

from bearing_sim.events import Event, Level
from bearing_sim.runtime.cusum import Cusum, Whitener, threshold_for
from bearing_sim.scene_monitoring import ResidualDetection

_SPEED_CHANGE = 0.02  # relative: beyond that the shaft is at another speed
_GAP = 5.0  # batches; where measurements come more rarely than batches each of them is one
_SILENT = 2.0  # [s]
_HOUR = 3600.0  # [s]
_SIDES = {0: "as predicted", 1: "slips more than predicted", -1: "slips less than predicted"}


class ResidualMonitor:
    """Compares measured with predicted cage slip.

    Parameters
    ----------
    detection : how; `bearing_sim.scene_monitoring.ResidualDetection`.
    from_speed : shaft speed from which slip is judged [rad/s].

    Attributes
    ----------
    residual, mean, deviation : float
        The newest residual, measured less predicted slip, its fading mean and its fading standard deviation, as fractions; NaN
        before the first.
    """

    def __init__(self, detection: ResidualDetection, from_speed: float):
        self._detection, self._from_speed = detection, from_speed
        self.restart()

    def adjust(self, detection: ResidualDetection, from_speed: float) -> None:
        """Judge by other settings from now on; what is usual is learned anew where batches or tolerance have changed."""
        before, self._detection, self._from_speed = self._detection, detection, from_speed
        if (before.batch, before.tolerance) != (detection.batch, detection.tolerance):
            self.restart()
        self._cusum.threshold = self._threshold()

    def restart(self) -> None:
        """Forget everything, what is usual too: another machine, or the same one repaired."""
        self.residual = self.mean = self.deviation = math.nan
        self._variance = 0.0
        self._time = self._measured_at = self._newest_mean = math.nan
        self._settled_from = -math.inf
        self._speed = 0.0  # at which the shaft has settled
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0
        self._whitener, self._cusum = Whitener(self._detection.tolerance), Cusum(self._threshold())

    def _threshold(self) -> float:
        return threshold_for(self._detection.false_alarm_time / self._detection.batch)

    def take(self, now: float, shaft_speed: float, measured: float, predicted: float) -> None:
        """Take in a measurement.

        Parameters
        ----------
        now : its time [s]; one that does not lie after the last one's is left out.
        shaft_speed : [rad/s].
        measured, predicted : cage slip as fractions; NaN at rest, or where there is nothing to compare.
        """
        if now <= self._time:
            return
        elapsed, self._time = now - self._time, now
        residual, speed = float(measured - predicted), abs(shaft_speed)
        if not math.isfinite(residual) or speed < self._from_speed:
            self._disturb(now, 0.0)
            return
        self._measured_at = now
        self._fade(elapsed, residual)
        if abs(speed - self._speed) > _SPEED_CHANGE * self._speed or elapsed > _GAP * self._detection.batch:
            self._disturb(now, speed)
        if now < self._settled_from:
            return
        if now - self._batch_start >= self._detection.batch:
            self._close_batch()
        if not self._batch_count:
            self._batch_start = now
        self._batch_count, self._batch_total = self._batch_count + 1, self._batch_total + residual

    def interrupt(self, now: float) -> None:
        """Leave out what follows ``now`` [s] until the bearing has settled: the prediction has begun anew."""
        self._disturb(now, self._speed)

    @property
    def time(self) -> float:
        """When slip was compared last [s]; NaN before that."""
        return self._measured_at

    def events(self, now: float) -> list[Event]:
        """Return the change that holds, as of ``now`` [s]."""
        side = self._cusum.side
        if not side:
            return []
        steps, height = (self._cusum.rising_for, self._cusum.up) if side > 0 else (self._cusum.falling_for, self._cusum.down)
        lasted, rarity = steps * self._detection.batch, self._detection.false_alarm_time / _HOUR
        text = (
            f"residual slip: the cage {_SIDES[side]} for about {lasted:.3g} s of measurement: now {100 * self._newest_mean:+.3g} points, "
            f"usually {100 * self._whitener.mean:+.3g} (CUSUM {height:.3g} over {self._cusum.threshold:.3g}, one false alarm in {rarity:.4g} h)"
        )
        return [Event(now, Level.WARN, "residual.shift", text)]

    def values(self, now: float) -> dict[str, object]:
        """Return the numbers and the verdict as of ``now`` [s], the unit in each key; empty before the first measurement."""
        if math.isnan(self._time):
            return {}
        return {
            "residual slip [points]": 100 * self.residual,
            "residual slip, mean [points]": 100 * self.mean,
            "residual slip, deviation [points]": 100 * self.deviation,
            "residual slip, usual mean [points]": 100 * self._whitener.mean if self._whitener.count else math.nan,
            "residual slip, CUSUM of its threshold [%]": 100 * self._cusum.height / self._cusum.threshold,
            "residual slip, verdict": self.verdict(now),
        }

    def verdict(self, now: float) -> str:
        """Return in a few words what the comparison says as of ``now`` [s]."""
        if math.isnan(self._time) or now - self._time > max(_GAP * self._detection.batch, _SILENT):
            return "no measurement"
        if self._cusum.side:
            return _SIDES[self._cusum.side]
        if self._time != self._measured_at or self._time < self._settled_from:
            return "not judged: at rest, at a changing speed, or predicted by another level"
        known = self._whitener.count * self._detection.batch
        if known < self._detection.learning:
            return f"learning what is usual: {known:.3g} of {self._detection.learning:.3g} s"
        return _SIDES[0]

    def _fade(self, elapsed: float, residual: float) -> None:
        """Keep mean and variance that forget by exp(-t/memory) (West, Comm. ACM 22, 1979, weights that fade)."""
        self.residual = residual
        if math.isnan(self.mean):
            self.mean, self.deviation = residual, 0.0
            return
        share = 1.0 - math.exp(-min(elapsed, self._detection.batch) / self._detection.memory)
        step = residual - self.mean
        self.mean += share * step
        self._variance = (1.0 - share) * (self._variance + share * step * step)
        self.deviation = math.sqrt(self._variance)

    def _disturb(self, now: float, speed: float) -> None:
        """Wait until the bearing has settled at a speed."""
        self._abandon_batch()
        self._speed, self._settled_from = speed, now + self._detection.settling

    def _abandon_batch(self) -> None:
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0
        self._whitener.interrupt()

    def _close_batch(self) -> None:
        """Judge the batch that is full."""
        quiet = self._cusum.side == 0 and self._cusum.height < 0.5 * self._cusum.threshold  # what may be a change is not usual
        learned = self._whitener.count * self._detection.batch >= self._detection.learning
        self._newest_mean = self._batch_total / self._batch_count
        number = self._whitener.take(self._newest_mean, learn=quiet)
        if learned:
            self._cusum.take(number)
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0
