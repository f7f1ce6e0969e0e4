# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Calibration while a model runs: measured cage speeds, ring temperatures and clearances teach what is uncertain about its scene.

Measurements are averaged over short intervals in which conditions hold (`_Batch`), and compared with what the level itself computed, moved by
the response of the uncertain fields (`bearing_sim.watchers.estimation.response`); `bearing_sim.watchers.estimation.posterior` learns from the
difference.

**Changes.** A slow change is what the posterior expects: fields wander.  A sudden one it takes for wild measurements at first.  The calibrated
residual, measured minus predicted slip before the measurement is learned from, goes through the change detector of
`bearing_sim.watchers.monitoring.residual`; while that suspects a change, measurements are kept aside.  They are learned from later if nothing comes
of it.  Once it is sure, there are two posteriors: the one from before, to which the residual refers, so that the alarm holds for as long as the
change does; and another, which allows for a change of any field since then and makes the predictions.  `bearing_sim.watchers.estimation.causes` says
what may have changed.  If the residual returns, the posterior from before is back in force; `Estimator.accept` makes the other one the new normal.
"""

import math
from bisect import bisect_right, insort
from collections import deque
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.messages.events import Event, Level
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities
from bearing_sim.watchers.estimation.causes import Cause, Evidence, causes_of, not_modelled
from bearing_sim.watchers.estimation.posterior import CLEARANCE, INNER, OUTER, SLIP, Posterior, prior_scores
from bearing_sim.watchers.estimation.response import ResponseModel
from bearing_sim.watchers.monitoring.residual import CALIBRATED_SLIP, Course, ResidualMonitor

_OBSERVED = ("shaft_speed", "load_y", "load_z", "oil_temperature", "ideal_cage_speed", "cage_slip", "running_clearance")
_SPEED_CHANGE, _LOAD_CHANGE = 0.02, 0.25  # relative; larger ones within a batch or shortly before it make it unsettled, as in `calibrate`
_SETTLING = 0.5  # s; lags of settled cages are below a third of it
_WARMING = 300.0  # s; time constant by which the conditions of rings are averaged (assumption)
_WARM = 0.05  # relative difference of speed and load to their averages up to which rings count as settled
_TEMPERATURES_EVERY = 10.0  # s
_SYSTEMATIC = 0.25  # of the noise of a reading; standard deviation of what the cage sensor is off by all the time (assumption)
_WIDE = 0.3  # slip; standard deviation of wild readings (assumption)
_TOO_FEW = 5  # readings of a batch, below which their scatter is not known
_SCATTER_WEIGHT = 20.0  # readings that the scene's noise counts for
_SCATTER_MEMORY = 2000.0  # readings
_FARTHEST = 3.0  # standard deviations from the median up to which a reading counts in the mean of a batch
_NORMAL = 1.4826  # standard deviation of a normal distribution over its median absolute deviation
_LARGEST_CORRELATION = 0.95
_HELD = 300  # batches that are kept aside while a change is suspected, and that are remembered since one
_EXPLAIN_EVERY = 10  # batches
_NAMED_FROM = 5  # batches since a change, from which on causes are named
_CONTRADICTED = 0.5  # of the newest batches wild: the ranges do not contain what is measured
_CONTRADICTION = 60  # batches
_ENDS = (0.5, 0.05, 0.95)  # quantiles of an estimate
_LEARNED = 0.5  # standard deviation of a combination of scores below which it counts as learned
_WORSE = 2.0  # times as uncertain is a field alone that is known only in a combination
_TAKES_PART = 0.3  # coefficient of a field in a learned combination, of a unit vector


class Reading(NamedTuple):
    """A measured cage speed with what the model had at its time.

    Attributes
    ----------
    time : [s].
    conditions : shaft speed [rad/s], radial load [N], oil temperature [K] and load angle [rad].
    own : slip by the level.
    residual : measured minus own slip.
    error : standard error of the measured slip; NaN where it is not known.
    """

    time: float
    conditions: tuple[float, float, float, float]
    own: float
    residual: float
    error: float


class Batch(NamedTuple):
    """Readings of an interval in which conditions hold; ``residual`` is their robust mean, of that ``variance``, ``count`` how many there are."""

    time: float
    conditions: np.ndarray
    own: float
    residual: float
    variance: float
    count: int


class Estimate(NamedTuple):
    """What is known about a field.

    Attributes
    ----------
    field : dotted path.
    value, low, high : median, and the ends that 5 and 95 % lie below [SI].
    prior_low, prior_high : the same before any measurement.
    calibrated : whether measurements may change it.
    """

    field: str
    value: float
    low: float
    high: float
    prior_low: float
    prior_high: float
    calibrated: bool


class Change(NamedTuple):
    """A sudden change: since when [s], and its causes, the likeliest first."""

    since: float
    causes: tuple[Cause, ...]


class _Scatter:
    """The noise of readings: its standard deviation and the correlation of neighbours, learned with a fading memory."""

    def __init__(self, deviation: float):
        self._squares, self._count = _SCATTER_WEIGHT * deviation**2, _SCATTER_WEIGHT
        self._products, self._pairs, self._usual = 0.0, _SCATTER_WEIGHT, math.nan

    @property
    def deviation(self) -> float:
        return math.sqrt(self._squares / self._count)

    @property
    def correlation(self) -> float:
        return min(max(self._products / self._pairs / (self._squares / self._count), 0.0), _LARGEST_CORRELATION)

    @property
    def learned(self) -> list[float]:
        return [self._squares, self._count, self._products, self._pairs]

    def restore(self, learned: Sequence[float]) -> None:
        numbers = [float(each) for each in learned]
        if len(numbers) != 4 or not all(math.isfinite(each) for each in numbers) or numbers[0] <= 0.0 or numbers[1] <= 0.0 or numbers[3] <= 0.0:
            raise ValueError("the noise of a sensor is four finite numbers")
        self._squares, self._count, self._products, self._pairs = numbers

    def mean(self, values: np.ndarray) -> tuple[float, float]:
        """Return the robust mean of readings and its variance, and learn their scatter."""
        count, middle = len(values), float(np.median(values))
        deviation = max(self.deviation, _NORMAL * float(np.median(np.abs(values - middle)))) if count >= _TOO_FEW else self.deviation
        near = values[np.abs(values - middle) <= _FARTHEST * deviation]
        near = near if len(near) else values  # as of two readings, one before and one after a sudden change: their median is far from both
        middle, deviation = float(near.mean()), self.deviation
        usual = middle if math.isnan(self._usual) or abs(middle - self._usual) > _FARTHEST * deviation else self._usual
        away = np.clip(values - usual, -3.0 * deviation, 3.0 * deviation)
        self._usual = usual + 0.1 * (middle - usual)
        if count >= _TOO_FEW:
            self._fade(count)
            self._squares += float(np.square(near - middle).sum()) * count / max(len(near) - 1, 1)
            self._count += count
        self._products += float(away[1:] @ away[:-1])
        self._pairs += count - 1
        correlation = self.correlation
        return middle, min(self.deviation**2 / count * (1.0 + correlation) / (1.0 - correlation), self.deviation**2)

    def _fade(self, count: int) -> None:
        kept = math.exp(-count / _SCATTER_MEMORY)
        self._squares, self._count, self._products, self._pairs = (kept * each for each in (self._squares, self._count, self._products, self._pairs))


def _weighted_mean(values: np.ndarray, errors: np.ndarray) -> tuple[float, float]:
    """Return the mean of readings that bring their standard errors, and its variance; readings far from their median are left out."""
    squares = np.maximum(errors, 1e-9) ** 2
    near = np.abs(values - np.median(values)) <= _FARTHEST * np.sqrt(squares + np.median(squares))
    weights = (near if near.any() else np.ones_like(squares)) / squares
    return float(weights @ values / weights.sum()), float(1.0 / weights.sum())


class Estimator:
    """Learns the uncertain fields of a scene from measurements.

    Parameters
    ----------
    scene : of the run; its block ``estimation`` says what is calibrated, and how well the model and the sensors are known.
    response : of the scene (`bearing_sim.watchers.estimation.response.kept_response`).
    known : dotted paths of fields that are inputs of this run, such as ``lubricant.temperature`` where an oil temperature comes in.

    Attributes
    ----------
    change : `Change` or None
        The sudden change that holds.
    """

    def __init__(self, scene: Scene, response: ResponseModel, known: Sequence[str] = ()):
        self._scene, self._response, self._settings = scene, response, scene.estimation
        settings = self._settings
        self._known = np.array([name in known for name in response.names], bool)
        self._calibrated = np.array([name in settings.calibrated for name in response.names], bool) & ~self._known
        self._prior = np.quantile(response.fields.values_of(prior_scores(response, self._known)), _ENDS[1:], axis=0)
        self._residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed, CALIBRATED_SLIP)
        self._course = Course(_OBSERVED)
        self.restart()

    def restart(self) -> None:
        """Return to the ranges of the scene and forget all measurements."""
        self._before = Posterior(self._scene, self._response, self._calibrated, self._known)
        self._since_change: Posterior | None = None
        self.change: Change | None = None
        self._scatter = _Scatter(self._settings.noise.cage_speed)
        self._residual.restart()
        self._updates, self._wild = 0, deque(maxlen=_CONTRADICTION)
        self.interrupt()

    def interrupt(self) -> None:
        """Continue with what is known, at times that need not follow the last ones: a run that starts again counts its time from 0."""
        self._course.restart()
        self._waiting: list[tuple[float, float, float, float]] = []
        self._readings: list[Reading] = []
        self._held: deque[Batch] = deque(maxlen=_HELD)
        self._batches: deque[Batch] = deque(maxlen=_HELD)
        self._time = math.nan
        self._reference = (math.nan, math.nan)
        self._settled_from, self._temperatures_at = -math.inf, -math.inf
        self._average: np.ndarray | None = None
        self._newest: np.ndarray | None = None
        self._residual.interrupt(-math.inf)

    @property
    def posterior(self) -> Posterior:
        """What predictions are made by."""
        return self._before if self._since_change is None else self._since_change

    @property
    def is_calibrated(self) -> bool:
        """Whether any measurement was learned from."""
        return self._updates > 0

    @property
    def _ranges(self) -> list[list]:
        return [[one.field, one.low, one.high, one.distribution, one.mode] for one in self._response.fields.ranges]

    @property
    def learned(self) -> dict[str, object]:
        """What was learned, as numbers, texts and nested mappings that JSON has, as `restore` takes it; empty before the first measurement."""
        if not self._updates:
            return {}
        learned = {"ranges": self._ranges, "measured": self._before.learned, "noise": self._scatter.learned, "updates": self._updates}
        learned |= {"residual": self._residual.learned}
        if self._since_change is not None:
            learned |= {"changed": self._since_change.learned, "since": self.change.since}
        return learned

    def restore(self, learned: Mapping[str, object], seconds: float = 0.0) -> None:
        """Continue from what was learned in an earlier run; from nothing where the ranges of the scene were others.

        Parameters
        ----------
        learned : see `learned`.
        seconds : how long ago that was.

        Raises
        ------
        KeyError, TypeError, ValueError
            It is something else.
        """
        self.restart()
        if not learned or learned["ranges"] != self._ranges:
            return
        try:
            self._before.restore(learned["measured"])
            self._scatter.restore(learned["noise"])
            self._residual.restore(learned["residual"])
            self._updates = int(learned["updates"])
            if "changed" in learned:
                self._since_change = self._before.copy()
                self._since_change.restore(learned["changed"])
                self.change = Change(float(learned["since"]), ())
        except (KeyError, TypeError, ValueError):
            self.restart()
            raise
        for posterior in self._posteriors():
            posterior.wait(seconds)
            posterior.restore(posterior.learned)  # so that the draws follow
        self.interrupt()

    def accept(self) -> None:
        """Take the machine as it is since the change for the new normal: the alarm ends, and the residual is learned again."""
        if self._since_change is not None:
            self._before, self._since_change, self.change = self._since_change, None, None
        self._residual.restart()
        self._held.clear()

    def measure(self, time: float, cage_speed: float, standard_error: float = math.nan) -> None:
        """Take a measured cage speed.

        Parameters
        ----------
        time : [s]; it may be later than the newest sample.
        cage_speed : [rad/s].
        standard_error : of it [rad/s]; NaN where the sensor does not say.
        """
        if math.isfinite(time) and math.isfinite(cage_speed):
            insort(self._waiting, (time, 0.0, cage_speed, standard_error))

    def measure_clearance(self, time: float, clearance: float, standard_error: float = math.nan) -> None:
        """Take a measured diametral running clearance [m]; parameters as of `measure`."""
        if math.isfinite(time) and math.isfinite(clearance):
            insort(self._waiting, (time, 1.0, clearance, standard_error))

    def update(self, block: np.ndarray) -> bool:
        """Take samples in order of time (see `bearing_sim.model.sample`); return whether anything was learned."""
        if len(block) and not float(block["time"][0]) > self._course.newest - 1e-9:
            self.interrupt()
        self._course.append(block)
        self._close_before(float(block["time"][0]))  # before time passes: it says nothing about what has changed since
        self._watch_conditions(block)
        before = self._updates
        self._learn_from_temperatures(block[-1])
        ready = bisect_right(self._waiting, (self._course.newest, math.inf))
        due, self._waiting = self._waiting[:ready], self._waiting[ready:]
        for time, kind, value, error in due:
            self._learn_from_reading(time, value, error) if kind == 0.0 else self._learn_from_clearance(time, value, error)
        return self._updates != before

    def _posteriors(self) -> list[Posterior]:
        return [self._before] + [self._since_change] * (self._since_change is not None)

    def _watch_conditions(self, block: np.ndarray) -> None:
        """Note when speed or load has left what it was."""
        speed, load = np.abs(block["shaft_speed"]), np.hypot(block["load_y"], block["load_z"])
        end, usual_speed, usual_load = float(block["time"][-1]), *self._reference
        if not (
            np.abs(speed - usual_speed).max() <= _SPEED_CHANGE * usual_speed
            and np.abs(load - usual_load).max() <= _LOAD_CHANGE * max(usual_load, 1.0)
        ):
            self._reference = float(speed[-1]), float(load[-1])
            self._settled_from = end + _SETTLING
            self._readings.clear()
        elapsed = end - self._time if math.isfinite(self._time) else 0.0
        newest = np.array([float(speed[-1]), float(load[-1]), float(block["oil_temperature"][-1])])
        weight = 1.0 - math.exp(-max(elapsed, 0.0) / _WARMING)
        self._average = newest if self._average is None else self._average + weight * (newest - self._average)
        for posterior in self._posteriors():
            posterior.wait(elapsed)
        self._time = end

    def _conditions(self, row: Sequence[float]) -> np.ndarray:
        speed, load_y, load_z, temperature = row[:4]
        return np.array([speed, math.hypot(load_y, load_z), temperature, math.atan2(load_z, load_y)])

    def _learn_from_reading(self, time: float, cage_speed: float, error: float) -> None:
        row = self._course.at(time)
        conditions, (ideal, own) = self._conditions(row), row[4:6]
        usable = math.isfinite(own) and abs(conditions[0]) >= self._scene.thresholds.slip_from_speed and time >= self._settled_from
        if not usable or self._response.outside(conditions[None])[0]:
            return
        reading = Reading(time, tuple(conditions), own, 1.0 - cage_speed / ideal - own, abs(error / ideal))
        self._close_before(time)
        self._readings.append(reading)

    def _close_before(self, time: float) -> None:
        """Average the readings so far and learn from them, if a time [s] is no more of their interval."""
        readings = self._readings
        if not readings or time - readings[0].time < self._settings.interval * (1.0 - 1e-9):
            return
        self._readings = []
        residuals, errors = (np.array([getattr(each, name) for each in readings]) for name in ("residual", "error"))
        stated = np.isfinite(errors)
        if stated.all():
            mean, variance = _weighted_mean(residuals, errors)
        else:
            mean, variance = self._scatter.mean(residuals[~stated])
        conditions = np.mean([each.conditions for each in readings], axis=0)
        batch = Batch(readings[-1].time, conditions, float(np.mean([each.own for each in readings])), mean, variance, len(readings))
        self._judge(batch)

    def _judge(self, batch: Batch) -> None:
        """Compare a batch with the prediction from before a change, and learn from it unless a change is suspected."""
        departures, left = self._before.predict(SLIP, batch.conditions, batch.own)
        expected, deviation = float(departures.mean()), math.sqrt(float(departures.var()) + left)
        if deviation <= max(self._scene.thresholds.residual.tolerance, math.sqrt(batch.variance)):
            self._residual.compare(batch.time, float(batch.conditions[0]), batch.residual, expected)
        if self._since_change is not None and not self._residual.side:
            self._return_to_before()
        if self._residual.is_quiet and self._since_change is None:
            for held in (*self._held, batch):
                self._learn(self._before, held)
            self._held.clear()
            return
        self._held.append(batch)
        if self._residual.side:
            self._follow_change(batch)

    def _follow_change(self, batch: Batch) -> None:
        """Learn a changed machine, in a belief of its own."""
        if self._since_change is None:
            since = batch.time - self._residual.changing_for
            self._batches = deque((each for each in self._held if each.time >= since - 1e-9), maxlen=_HELD)
            self.change = Change(since, ())
            self._since_change = self._before.copy()
            self._since_change.forget()
            for held in self._batches:
                self._learn(self._since_change, held)
        else:
            self._batches.append(batch)
            self._learn(self._since_change, batch)
        count = len(self._batches)
        if count == _NAMED_FROM or (count > _NAMED_FROM and self._updates % _EXPLAIN_EVERY == 0) or (count >= _NAMED_FROM and not self.change.causes):
            self.change = self.change._replace(causes=causes_of(self._scene, self._response, self._before, self._evidence()))

    def _return_to_before(self) -> None:
        self._since_change, self.change = None, None
        self._batches.clear()
        self._held.clear()

    def _evidence(self) -> Evidence:
        """Return the batches since a change, as departures from what the belief from before predicts."""
        rows = list(self._batches)
        conditions = np.array([each.conditions for each in rows])
        own = np.array([each.own for each in rows])
        return Evidence(conditions, own, np.array([each.residual for each in rows]), np.array([each.variance for each in rows]))

    def _learn(self, posterior: Posterior, batch: Batch) -> None:
        wild = self._settings.noise.outliers, _WIDE
        outcome = posterior.learn(SLIP, batch.conditions, batch.own, batch.residual, batch.variance, wild, batch.count)
        self._updates += 1
        self._wild.append(outcome.wild > 0.5)

    def _learn_from_clearance(self, time: float, clearance: float, error: float) -> None:
        row = self._course.at(time)
        conditions, own = self._conditions(row), row[6]
        if not math.isfinite(own) or self._response.outside(conditions[None])[0]:
            return
        deviation = error if math.isfinite(error) else self._settings.noise.clearance
        self._learn_other(CLEARANCE, conditions, own, clearance - own, deviation)

    def _learn_from_temperatures(self, sample: np.void) -> None:
        """Learn from measured ring temperatures, while conditions are near what has warmed the rings."""
        now, speed = float(sample["time"]), abs(float(sample["shaft_speed"]))
        if now < self._temperatures_at or speed < self._scene.thresholds.slip_from_speed:
            return
        self._temperatures_at = now + _TEMPERATURES_EVERY
        load = math.hypot(float(sample["load_y"]), float(sample["load_z"]))
        usual = self._average
        if abs(speed - usual[0]) > _WARM * usual[0] or abs(load - usual[1]) > _WARM * max(usual[1], 1.0):
            return
        conditions = np.array([float(sample["shaft_speed"]), load, float(sample["oil_temperature"]), math.atan2(sample["load_z"], sample["load_y"])])
        if self._response.outside(conditions[None])[0]:
            return
        for name in (INNER, OUTER):
            own = float(sample[f"{name}_uncorrected"])
            departure = float(sample[f"{name}_measured"]) - own
            if math.isfinite(departure):
                self._learn_other(name, conditions, own, departure, self._settings.noise.temperature)

    def _learn_other(self, quantity: str, conditions: np.ndarray, own: float, departure: float, deviation: float) -> None:
        for posterior in self._posteriors():
            posterior.learn(quantity, conditions, own, departure, deviation**2, (self._settings.noise.outliers, 20.0 * deviation))
        self._updates += 1

    def prediction(self, sample: np.void) -> np.ndarray:
        """Return draws of the slip that the calibrated model predicts, from a sample of the level; shape (m,), NaN outside of the response."""
        row = [float(sample[name]) for name in _OBSERVED]
        conditions, own = self._conditions(row), row[5]
        return own + self.posterior.drawn(SLIP, conditions, own, _SYSTEMATIC * self._settings.noise.cage_speed)

    def estimates(self) -> tuple[Estimate, ...]:
        """Return what is known about each uncertain field, in the order of the response."""
        values = np.quantile(self._response.fields.values_of(self.posterior.scores), _ENDS, axis=0)
        prior = self._prior
        return tuple(
            Estimate(name, *map(float, values[:, k]), *map(float, prior[:, k]), bool(self._calibrated[k]))
            for k, name in enumerate(self._response.names)
        )

    def unresolved(self) -> tuple[tuple[str, ...], ...]:
        """Return groups of fields of which a combination is known much better than each of them alone.

        A combination counts as known where its standard deviation, in scores, is below a half, and a field belongs to it that is twice as
        uncertain by itself.
        """
        where = np.flatnonzero(self._calibrated)
        if not len(where):
            return ()
        covariance = np.atleast_2d(np.cov(self.posterior.scores[:, where].T))
        values, vectors = np.linalg.eigh(covariance)
        alone = np.diag(covariance)
        groups = []
        for value, vector in zip(values, vectors.T):
            part = np.flatnonzero((np.abs(vector) > _TAKES_PART) & (alone > _WORSE**2 * value))
            if value < _LEARNED**2 and len(part) > 1:
                groups.append(tuple(self._response.names[where[k]] for k in part))
        return tuple(dict.fromkeys(groups))

    def events(self, now: float) -> list[Event]:
        """Return the events that hold, stamped ``now`` [s]: a change with its likeliest cause, and measurements that the ranges do not explain."""
        events = []
        for event in self._residual.events(now):
            named = f"; likeliest cause: {self.change.causes[0].group}" if self.change is not None and self.change.causes else ""
            events.append(event._replace(kind="calibration.change", reason=event.reason + named))
        if len(self._wild) == _CONTRADICTION and sum(self._wild) > _CONTRADICTED * _CONTRADICTION:
            reason = (
                f"more than {_CONTRADICTED:.0%} of the last {_CONTRADICTION} measurements cannot be explained by any values in the ranges of the "
                "scene; check the sensor's scale and the scene, or give wider ranges"
            )
            events.append(Event(now, Level.WARN, "calibration.contradicted", "measured cage", reason))
        return events

    def _explained_change(self) -> str:
        return explained(self.change.causes, not_modelled(self._scene, self._response))

    def values(self, now: float) -> dict[str, object]:
        """Return diagnostics values at ``now`` [s], with the unit in each key; empty before the first measurement."""
        if not self._updates:
            return {}
        known, found = quantities(type(self._scene)), {}
        for one in self.estimates():
            if one.calibrated:
                shown = [known[one.field].show(each) if one.field in known else f"{each:.4g}" for each in (one.value, one.low, one.high)]
                found[f"{one.field}, calibrated"] = f"{shown[0]} ({shown[1]} to {shown[2]})"
        groups = self.unresolved()
        if groups:
            found["known only together"] = "; ".join(" and ".join(group) for group in groups)
        if self.change is not None and self.change.causes:
            found["likeliest cause of the change"] = self._explained_change()
        return found | self._residual.values(now)


def explained(causes: Sequence[Cause], missing: Mapping[str, str]) -> str:
    """Return causes in a sentence: the likeliest, its size and evidence, those that cannot be told from it, and those that cannot be named.

    Parameters
    ----------
    causes : the likeliest first.
    missing : see `bearing_sim.watchers.estimation.causes.not_modelled`.
    """
    first, *others = causes
    rivals = [each for each in others if each.probability > first.probability / 3.0]
    text = f"likeliest cause: {first.text} (probability {100 * first.probability:.0f} %)"
    if rivals:
        text += "; also possible: " + ", ".join(f"{each.text} ({100 * each.probability:.0f} %)" for each in rivals)
    if missing:
        wanted = ", ".join(f"{group} (give uncertainty.{field})" for group, field in missing.items())
        text += f"; cannot be named without a range: {wanted}"
    return text
