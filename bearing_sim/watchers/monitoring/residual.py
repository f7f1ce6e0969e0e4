# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Residuals: measured minus predicted cage slip and ring temperatures, their fading statistics, and whether they have changed.

A model that is slightly wrong gives a residual that is not zero; a machine that changes gives a residual that changes.  So the usual
residual is learned, and a change detector looks for lasting departures from it: batch means of the residual are made standard normal and
independent (`Whitener`), and a two-sided cumulative sum with a known false-alarm rate judges them (`Cusum`).  Batches come at even
intervals, so a run length is a time.  Rest, start-up and changes of speed are left out, because slip is undefined or depends on which of
two sensors was read first; temperatures follow a change late.
"""

import math
from bisect import bisect_left, bisect_right, insort
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Event, Level, Measurement, Record
from bearing_sim.messages.topics import MEASURED, RING_TEMPERATURES
from bearing_sim.scene.scene import ResidualDetection, Scene, TemperatureResidualDetection, Thresholds
from bearing_sim.watchers.monitoring.watchers import Watcher

_HOUR = 3600.0  # [s]
_SPEED_CHANGE = 0.02  # relative change beyond which the shaft counts as being at another speed
_GAP = 5.0  # batches without a measurement after which the bearing has to settle again
_SILENT = 2.0  # [s] without a measurement after which there is no verdict, at least
_SAMPLES = 10  # of a batch that a residual of temperatures is made of

_REFERENCE = 0.5  # k: half of the smallest change to detect, which is one standard deviation
_OVERSHOOT = 1.166  # mean overshoot of a sum of normal steps beyond its border, both ends together (Siegmund 1985)
_LARGEST_THRESHOLD = 1e3  # bracket of the root; the run length of h = 1000 is beyond any time
_FARTHEST = 4.0  # standard deviations that one batch can count, so that a single wild reading is no change
_SCATTER_KNOWN = 20  # batches from which on a wild reading can be recognised
_MOST_CORRELATED = 0.98
_STEEPEST_TAIL = 8.0  # beyond it, Student's distribution differs from 1 by round-off only

_KEPT = 2000  # outputs: a measurement may arrive this many outputs after its time
_COMPARED = ("shaft_speed", "ideal_cage_speed", "cage_slip")


class Comparand(NamedTuple):
    """What is compared, in words for people.

    Attributes
    ----------
    what : the residual; the subject of its event and the first words of its diagnostics.
    whose : the part that is measured.
    unit, factor : unit shown in texts, and the factor from SI to that unit.
    si_unit : unit of the numbers in diagnostics, as the topics have them.
    verdicts : by the side to which the residual has changed: 0 for none, 1 up, -1 down.
    unjudged : the verdict where nothing can be said.
    """

    what: str
    whose: str
    unit: str
    factor: float
    si_unit: str
    verdicts: dict[int, str]
    unjudged: str


SLIP = Comparand(
    "residual slip",
    "the cage",
    "points",
    100.0,
    "fraction",
    {0: "as predicted", 1: "slips more than predicted", -1: "slips less than predicted"},
    "not judged: at rest, at a changing speed, or predicted by another level",
)

CALIBRATED_SLIP = SLIP._replace(
    what="calibrated residual slip",
    verdicts={0: "as calibrated", 1: "slips more than the calibrated model explains", -1: "slips less than the calibrated model explains"},
    unjudged="not judged: at rest, at a changing speed, or not calibrated yet",
)


def temperature_of(ring: str) -> Comparand:
    """Return the words for the temperature of a ring, inner or outer."""
    verdicts = {0: "as predicted", 1: "is warmer than predicted", -1: "is colder than predicted"}
    return Comparand(
        f"residual temperature of the {ring} ring", f"the {ring} ring", "K", 1.0, "K", verdicts, "not judged: not measured, or at a changing speed"
    )


def run_length(threshold: float, reference: float = _REFERENCE) -> float:
    """Return the mean number of standard normal steps from 0 until a two-sided CUSUM reaches its threshold.

    One side: (exp(2 k b) - 2 k b - 1)/(2 k^2) with b = h + 1.166 (Siegmund, Sequential Analysis, 1985; Montgomery 2009, eq. 9.6, for a
    drift of -k); both sides together half of it.

    Parameters
    ----------
    threshold : h, in standard deviations.
    reference : k, in standard deviations.
    """
    exponent = 2.0 * reference * (threshold + _OVERSHOOT)
    return 0.5 * (math.expm1(exponent) - exponent) / (2.0 * reference**2)


def threshold_for(length: float, reference: float = _REFERENCE) -> float:
    """Return the threshold h whose mean run length without a change is ``length`` steps, the inverse of `run_length`.

    Parameters
    ----------
    length : more than the run length of h = 0, some 2 steps.
    reference : k.

    Raises
    ------
    ValueError
        ``length`` is too short.
    """
    shortest = run_length(0.0, reference)
    if not length > shortest:
        raise ValueError(f"a mean run of {length:g} steps between false alarms is too short; expected more than {shortest:.3g}")
    low, high = 0.0, min(_LARGEST_THRESHOLD, 300.0 / reference)  # exp(2 k h) must stay finite
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if run_length(middle, reference) < length else (low, middle)
    return high


_OF_BATCHES = ("count", "mean", "_squares", "_products", "_surprises", "_pairs", "_surprised")
_OF_CHANGES = ("up", "down", "side", "rising_for", "falling_for")


class Whitener:
    """Turns batch means of unknown mean, scatter and correlation into numbers that are standard normal and independent without a change.

    Each batch is compared with the mean and scatter of all batches before it, u = Phi^-1(F(t)) with Student's t of as many degrees of
    freedom, so that the false-alarm rate holds early on although nothing is known beforehand (Hawkins, The Statistician 36, 1987, 299).
    Correlated neighbours are decorrelated first: what the batch before predicts by the lag-1 correlation is subtracted (first-order
    autoregression; Alwan and Roberts, J. Bus. Econ. Stat. 6, 1988, 87-95).

    Parameters
    ----------
    tolerance : lasting change that must not count; the scatter is at least so large that this change stays below the reference value.

    Attributes
    ----------
    count : batches that mean and scatter are computed from.
    mean : their mean.
    """

    def __init__(self, tolerance: float):
        self._tolerance = tolerance
        self.count, self.mean = 0, 0.0
        self._squares = self._products = self._surprises = 0.0
        self._pairs, self._surprised = 0, 0
        self._before = math.nan

    def interrupt(self) -> None:
        """Treat the next batch as no neighbour of the last one."""
        self._before = math.nan

    @property
    def learned(self) -> dict[str, float]:
        """What is known about batches, as `restore` takes it."""
        return {name.lstrip("_"): getattr(self, name) for name in _OF_BATCHES}

    def restore(self, learned: Mapping[str, float]) -> None:
        """Continue from what was known about batches; the next one is no neighbour of the last."""
        for name in _OF_BATCHES:
            setattr(self, name, type(getattr(self, name))(learned[name.lstrip("_")]))
        self.interrupt()

    @property
    def correlation(self) -> float:
        """Lag-1 correlation, 0 to 0.98, one standard error above the estimate: too low a value would cause false alarms.

        The estimate from n pairs is too low by about (1 + 3 r)/n, which is added (Kendall, Biometrika 41, 1954, 403-404).
        """
        if self._pairs < 3 or self._squares <= 0.0:
            return 0.0
        found = self._products / self._pairs / (self._squares / self.count)
        likely = max(found + (1.0 + 3.0 * found) / self._pairs, 0.0)
        return min(likely + math.sqrt(max(1.0 - likely * likely, 0.0) / self._pairs), _MOST_CORRELATED)

    def whiten(self, value: float, learn: bool = True) -> float:
        """Return the standard normal number of a batch; NaN where there is nothing to compare it with.

        Parameters
        ----------
        value : mean of the batch.
        learn : whether the batch counts for mean and scatter.
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
        # A wild reading must neither become usual nor make the next reading look wild.
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
    """Two-sided cumulative sum of standard normal numbers (Page, Biometrika 41, 1954): S = max(0, S +- u - k), an alarm from S = h on.

    A sum grows no higher than slightly above h, so that an alarm ends soon after its cause; it ends below h/2.

    Parameters
    ----------
    threshold : h.

    Attributes
    ----------
    up, down : float
        The two sums.
    side : int
        1 if the numbers have risen, -1 if they have fallen, else 0.
    rising_for, falling_for : int
        Steps since each sum was 0: the duration of the change.
    """

    def __init__(self, threshold: float):
        self.threshold = threshold
        self.up = self.down = 0.0
        self.side = self.rising_for = self.falling_for = 0

    @property
    def learned(self) -> dict[str, float]:
        """The sums and what they have led to, as `restore` takes them."""
        return {name: getattr(self, name) for name in _OF_CHANGES}

    def restore(self, learned: Mapping[str, float]) -> None:
        """Continue from sums and what they have led to."""
        for name in _OF_CHANGES:
            setattr(self, name, type(getattr(self, name))(learned[name]))

    @property
    def height(self) -> float:
        """The larger sum."""
        return max(self.up, self.down)

    def accumulate(self, number: float) -> int:
        """Add a number and return the side; NaN changes nothing."""
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
    """Return the standard normal number that is as unlikely as Student's t with these degrees of freedom."""
    from scipy.special import ndtri, stdtr  # here, because only a measurement needs them

    size = min(abs(t), _STEEPEST_TAIL)
    return math.copysign(-float(ndtri(stdtr(freedom, -size))), t)


class ResidualMonitor:
    """Compares a measured with a predicted quantity, such as cage slip.

    Parameters
    ----------
    detection : settings, see `bearing_sim.scene.scene.ResidualDetection`.
    from_speed : shaft speed from which on the residual is judged [rad/s].
    of : what is compared.

    Attributes
    ----------
    residual, mean, deviation : float
        The newest residual, measured minus predicted, its fading mean and its fading standard deviation, in SI; NaN before the first
        measurement.
    """

    def __init__(self, detection: ResidualDetection | TemperatureResidualDetection, from_speed: float, of: Comparand = SLIP):
        self._detection, self._from_speed, self._of = detection, from_speed, of
        self.restart()

    def adjust(self, detection: ResidualDetection | TemperatureResidualDetection, from_speed: float) -> None:
        """Use other settings from now on; the usual residual is learned again if batch length or tolerance have changed."""
        before, self._detection, self._from_speed = self._detection, detection, from_speed
        if (before.batch, before.tolerance) != (detection.batch, detection.tolerance):
            self.restart()
        self._cusum.threshold = self._threshold()

    def restart(self) -> None:
        """Forget everything, the usual residual included: another machine, or the same one after a repair."""
        self.residual = self.mean = self.deviation = math.nan
        self._variance = 0.0
        self._time = self._measured_at = self._newest_mean = math.nan
        self._settled_from = -math.inf
        self._speed = 0.0  # at which the shaft has settled
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0
        self._whitener, self._cusum = Whitener(self._detection.tolerance), Cusum(self._threshold())

    @property
    def learned(self) -> dict[str, object]:
        """What was learned about the usual residual, as numbers and nested mappings that JSON has; empty before the first measurement."""
        if math.isnan(self.mean):
            return {}
        newest = None if math.isnan(self._newest_mean) else self._newest_mean
        fading = {"mean": self.mean, "variance": self._variance, "residual": self.residual, "newest_batch": newest}
        settings = {"batch": self._detection.batch, "tolerance": self._detection.tolerance}
        return {**settings, **fading, "batches": self._whitener.learned, "changes": self._cusum.learned}

    def restore(self, learned: Mapping[str, object]) -> None:
        """Continue from what was learned in an earlier run; nothing if it was learned with another length of batches or tolerance.

        Parameters
        ----------
        learned : see `learned`.

        Raises
        ------
        KeyError, TypeError, ValueError
            It is something else.
        """
        self.restart()
        if not learned or (learned["batch"], learned["tolerance"]) != (self._detection.batch, self._detection.tolerance):
            return
        self._whitener.restore(learned["batches"])
        self._cusum.restore(learned["changes"])
        self.residual, self.mean, self._variance = float(learned["residual"]), float(learned["mean"]), float(learned["variance"])
        self.deviation = math.sqrt(self._variance)
        self._newest_mean = math.nan if learned["newest_batch"] is None else float(learned["newest_batch"])

    def _threshold(self) -> float:
        return threshold_for(self._detection.false_alarm_time / self._detection.batch)

    def compare(self, now: float, shaft_speed: float, measured: float, predicted: float) -> None:
        """Compare a measurement with its prediction.

        Parameters
        ----------
        now : its time [s]; a measurement that is not later than the last one is left out.
        shaft_speed : [rad/s].
        measured, predicted : in SI; NaN where there is nothing to compare, as the slip at rest.
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
        """Leave out measurements from ``now`` [s] until the bearing has settled, because the prediction has been reset.

        The next measurement may be earlier than the last one: a run that starts again counts its time from 0.
        """
        if not math.isnan(self._time):
            self._time = -math.inf
        self._disturb(now, self._speed)

    @property
    def time(self) -> float:
        """When measured and predicted were last compared [s]; NaN before that."""
        return self._measured_at

    @property
    def is_quiet(self) -> bool:
        """Whether nothing speaks for a change: neither one that holds nor one that may come to hold."""
        return self._cusum.side == 0 and self._cusum.height < 0.5 * self._cusum.threshold

    @property
    def side(self) -> int:
        """1 where the residual has risen, -1 where it has fallen, else 0."""
        return self._cusum.side

    @property
    def changing_for(self) -> float:
        """How long the larger of both sums has been above 0 [s of measurement]: since when a change may hold."""
        steps = self._cusum.rising_for if self._cusum.up >= self._cusum.down else self._cusum.falling_for
        return steps * self._detection.batch

    def events(self, now: float) -> list[Event]:
        """Return the event of a change that holds, stamped ``now`` [s]."""
        side, of = self._cusum.side, self._of
        if not side:
            return []
        rarity = self._detection.false_alarm_time / _HOUR
        reason = f"{of.whose} {of.verdicts[side]}, usually {of.factor * self._whitener.mean:+.3g} {of.unit} (one false alarm in {rarity:.4g} h)"
        return [Event(now, Level.WARN, "residual.shift", of.what, reason)]

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values and the verdict at ``now`` [s], with the unit in each key; empty before the first measurement."""
        if math.isnan(self._time):
            return {}
        what, unit = self._of.what, self._of.si_unit
        return {
            f"{what} [{unit}]": self.residual,
            f"{what}, mean [{unit}]": self.mean,
            f"{what}, deviation [{unit}]": self.deviation,
            f"{what}, usual mean [{unit}]": self._whitener.mean if self._whitener.count else math.nan,
            f"{what}, CUSUM of its threshold [%]": 100 * self._cusum.height / self._cusum.threshold,
            f"{what}, newest batch [{unit}]": self._newest_mean,
            f"{what}, changed for [s of measurement]": self.changing_for if self._cusum.side else 0.0,
            f"{what}, verdict": self.verdict(now),
        }

    def verdict(self, now: float) -> str:
        """Return the result of the comparison at ``now`` [s] in a few words."""
        if math.isnan(self._time) or now - self._time > max(_GAP * self._detection.batch, _SILENT):
            return "no measurement"
        if self._cusum.side:
            return self._of.verdicts[self._cusum.side]
        if self._time != self._measured_at or self._time < self._settled_from:
            return self._of.unjudged
        known = self._whitener.count * self._detection.batch
        if known < self._detection.learning:
            return f"learning what is usual: {known:.3g} of {self._detection.learning:.3g} s"
        return self._of.verdicts[0]

    def _fade(self, elapsed: float, residual: float) -> None:
        """Update mean and variance, whose weights fade by exp(-t/memory) (West, Comm. ACM 22, 1979)."""
        self.residual = residual
        if math.isnan(self.mean):
            self.mean, self.deviation = residual, 0.0
            return
        weight = 1.0 - math.exp(-min(elapsed, self._detection.batch) / self._detection.memory)
        step = residual - self.mean
        self.mean += weight * step
        self._variance = (1.0 - weight) * (self._variance + weight * step * step)
        self.deviation = math.sqrt(self._variance)

    def _disturb(self, now: float, speed: float) -> None:
        """Drop the open batch and wait until the bearing has settled at a speed."""
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0
        self._whitener.interrupt()
        self._speed, self._settled_from = speed, now + self._detection.settling

    def _close_batch(self) -> None:
        """Judge the batch that is complete."""
        quiet = self.is_quiet  # a possible change must not become usual
        learned = self._whitener.count * self._detection.batch >= self._detection.learning
        self._newest_mean = self._batch_total / self._batch_count
        number = self._whitener.whiten(self._newest_mean, learn=quiet)
        if learned:
            self._cusum.accumulate(number)
        self._batch_start, self._batch_count, self._batch_total = math.nan, 0, 0.0


class TemperatureResiduals(Watcher):
    """Compares the measured temperatures of the rings with those of the thermal network alone, sample by sample: a sample holds both.

    The network that measured temperatures correct follows them within seconds; what it would be without them tells what has changed.

    Parameters
    ----------
    scene : nothing is compared where its `heat.law` is not network, for then nothing predicts what is measured.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene)
        detection = scene.thresholds.temperature_residual
        rings = RING_TEMPERATURES if scene.heat.law == "network" else ()
        self._monitors = {name: ResidualMonitor(detection, 0.0, temperature_of(name.partition("_")[0])) for name in rings}
        self._interval, self._next = detection.batch / _SAMPLES, -math.inf

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on (see `ResidualMonitor.adjust`)."""
        super().adjust(thresholds)
        detection = thresholds.temperature_residual
        self._interval = detection.batch / _SAMPLES
        for monitor in self._monitors.values():
            monitor.adjust(detection, 0.0)

    def restart(self, why: str = "") -> None:
        """Wait until the network has settled after a reset; what is usual is kept."""
        self._next = -math.inf
        for monitor in self._monitors.values():
            monitor.interrupt(-math.inf)

    @property
    def learned(self) -> dict[str, dict]:
        """What was learned about each ring that has been measured (see `ResidualMonitor.learned`)."""
        return {name: learned for name, monitor in self._monitors.items() if (learned := monitor.learned)}

    def recall(self, learned: Mapping[str, Mapping], seconds: float = 0.0) -> None:
        """Continue from what was learned in an earlier run (see `ResidualMonitor.restore`)."""
        for name, monitor in self._monitors.items():
            monitor.restore(learned.get(name, {}))

    def is_calm(self, block: np.ndarray) -> bool:
        """Return True: a change of temperatures is seen at the end of the block."""
        return True

    def see(self, block: np.ndarray) -> Sequence[Record]:
        """Take samples in order, shape (n,) (see `bearing_sim.model.sample`)."""
        times, place = block["time"], 0
        while (place := place + int(np.searchsorted(times[place:], self._next))) < len(block):
            sample = block[place]
            now, speed = float(sample["time"]), float(sample["shaft_speed"])
            self._next = now + self._interval * (1 - 1e-9)
            for name, monitor in self._monitors.items():
                if not math.isnan(measured := float(sample[f"{name}_measured"])):
                    monitor.compare(now, speed, measured, float(sample[f"{name}_uncorrected"]))
        return ()

    def events(self, now: float) -> list[Event]:
        """Return the events of changes that hold, stamped ``now`` [s]."""
        return [event for monitor in self._monitors.values() for event in monitor.events(now)]

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values and verdicts at ``now`` [s] of the rings that have been measured."""
        return {key: value for monitor in self._monitors.values() for key, value in monitor.values(now).items()}


class Course:
    """Numbers of the newest samples of a run, which are linear in between.

    Parameters
    ----------
    names : of the observables.
    """

    def __init__(self, names: Sequence[str]):
        self._names = ("time", *names)
        self.restart()

    def restart(self) -> None:
        """Forget all samples."""
        self._times: list[float] = []
        self._rows: list[tuple[float, ...]] = []

    @property
    def newest(self) -> float:
        """Time of the newest sample [s]; minus infinity before the first."""
        return self._times[-1] if self._times else -math.inf

    def append(self, block: np.ndarray) -> None:
        """Append samples in order of time (see `bearing_sim.model.sample`)."""
        rows = list(zip(*(block[name].tolist() for name in self._names)))
        self._times += [row[0] for row in rows]
        self._rows += [row[1:] for row in rows]
        if len(self._times) > 2 * _KEPT:
            del self._times[:-_KEPT], self._rows[:-_KEPT]

    def at(self, time: float) -> tuple[float, ...]:
        """Return the numbers at a time that is not later than the newest; NaN at one before all samples kept."""
        position = bisect_left(self._times, time)
        after = self._rows[position]
        if self._times[position] == time:
            return after
        if position == 0:
            return (math.nan,) * len(after)
        before, start = self._rows[position - 1], self._times[position - 1]
        fraction = (time - start) / (self._times[position] - start)
        return tuple(old + fraction * (new - old) for old, new in zip(before, after))


class SlipResidual(Watcher):
    """Compares each measured cage speed with the prediction at its own stamp, whichever arrives first.

    Predictions are linear between samples.  A measurement waits for the next sample after it; one that is older than all samples kept is compared
    with NaN.  Where messages act as they arrive, it is compared with the newest sample, which is at most a tick old.

    Attributes
    ----------
    monitor : ResidualMonitor
        That judges.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene)
        self.monitor = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self._course, self._waiting = Course(_COMPARED), []

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on; what was learned about the measured cage is kept."""
        self.monitor.adjust(thresholds.residual, thresholds.slip_from_speed)

    def restart(self, why: str) -> None:
        """Wait until the prediction has settled; with a run that counts its time from 0 again, forget samples and measurements."""
        self.monitor.interrupt(self.run.reset_at)
        if self.run.reset_at == -math.inf:
            self._waiting = []
            self._course.restart()

    @property
    def learned(self) -> dict[str, object]:
        """See `ResidualMonitor.learned`."""
        return self.monitor.learned

    def recall(self, learned: Mapping[str, object], seconds: float = 0.0) -> None:
        """Continue from what was learned in an earlier run (see `ResidualMonitor.restore`)."""
        self.monitor.restore(learned)

    def hear(self, channel: str, time: float, value: float, standard_error: float) -> list[Measurement]:
        """Take a measurement; return the comparisons that it completes."""
        if channel != MEASURED:
            return []
        if not self.run.acts_on_arrival:
            insort(self._waiting, (time, value, standard_error))
            return self._due()
        sample = self.run.newest
        if sample is None:
            return [Measurement(time, value, math.nan, standard_error)]
        sampled, *there = (float(sample[name]) for name in ("time", *_COMPARED))
        if not self.run.is_predicted:
            there[-1] = math.nan
        return [self._compared(time, value, standard_error, sampled, *there)]

    def is_calm(self, block: np.ndarray) -> bool:
        """Return True: a change is seen at the end of the block."""
        return True

    def see(self, block: np.ndarray) -> list[Measurement]:
        """Take samples in order of time (see `bearing_sim.model.sample`) and return the comparisons that they complete."""
        if self.run.acts_on_arrival:
            return []
        self._course.append(block)
        return self._due()

    def events(self, now: float) -> list[Event]:
        """See `ResidualMonitor.events`."""
        return self.monitor.events(now)

    def values(self, now: float) -> dict[str, object]:
        """See `ResidualMonitor.values`."""
        return self.monitor.values(now)

    def _due(self) -> list[Measurement]:
        if not self._waiting:
            return []
        ready = bisect_right(self._waiting, (self._course.newest, math.inf))
        taken, self._waiting = self._waiting[:ready], self._waiting[ready:]
        return [self._compared(*each, each[0], *self._course.at(each[0])) for each in taken]

    def _compared(
        self, time: float, cage_speed: float, standard_error: float, sampled: float, shaft_speed: float, ideal: float, predicted: float
    ) -> Measurement:
        """Return a measurement compared with a prediction at an instant ``sampled`` [s]."""
        measured = 1.0 - cage_speed / ideal if ideal else math.nan
        self.monitor.compare(sampled, shaft_speed, measured, predicted)
        return Measurement(time, cage_speed, measured - predicted, standard_error)
