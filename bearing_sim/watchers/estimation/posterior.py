# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bayesian calibration of the uncertain fields of a scene: a posterior that is updated measurement by measurement.

**What is kept of the measurements.** Where the bearing has been, at operating points apart from each other (`Row`), how far the measured
quantity departs from the level's own prediction: a mean and a variance, updated by every measurement there (a scalar Kalman filter) and widening
with time, because fields wander.  These few numbers are all that the posterior depends on; nothing is linearised, so no early measurement
leaves a mistake behind.

**The model errs.** With all fields right it would still depart from the machine, by an error that is a Gaussian process over operating points
(Kennedy and O'Hagan, J. R. Stat. Soc. B 63, 2001, 425).  So a long measurement at one point is no proof of the fields: only what changes from
point to point tells them apart.  The response errs besides, by a fraction of the departure that it predicts (`ResponseModel.error_scales`).

**Draws.** The posterior is represented by m equally probable draws of the fields' scores (`bearing_sim.watchers.estimation.response`).  Whenever the
rows have changed enough they take steps of Markov chains whose stationary distribution is the posterior: differences of other draws
(differential evolution; ter Braak, Stat. Comput. 16, 2006, 239) and autoregressive steps that keep the prior (Cotter, Roberts, Stuart and White,
Stat. Sci. 28, 2013, 424); after a surprise, through tempered posteriors.  A field that is not calibrated keeps its prior draws, and the others
follow given these: what is not to be learned stays as uncertain as it was (a cut posterior; Plummer, Stat. Comput. 25, 2015, 37).
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.special import ndtri

from bearing_sim.scene.scene import Scene
from bearing_sim.watchers.estimation.response import ANSWERS, SLIP_SCALE, ResponseModel, prior_draws, restored_slip, slip_scale

SLIP, INNER, OUTER, CLEARANCE = MEASURED = ("cage_slip", "inner_ring_temperature", "outer_ring_temperature", "running_clearance")
"""What may be measured, by the names of the answers of a response."""
DRAWS = 512
_DISTANCES = (0.5, 0.7, 25.0)  # over which errors of the model forget each other: logarithms of speed and of load, and temperature [K] (assumption)
_LOAD_FLOOR = 0.05  # of the scene's load; loads below it count as the same condition (assumption)
_RESPONSE_DISTANCES = 0.5  # of those, over which errors of the response forget each other (as its errors by cross validation do)
_SAME, _ALIKE = 0.97, 0.5  # correlation of errors from which on points share a row, and, where there are many rows, may share one
_MOST_ROWS = 32  # of each measured quantity
_NOTICED = 0.15  # change of a row, over its standard deviation, after which draws move
_REMEMBERED = 64  # operating points whose coefficients are kept
_MOVES, _ANNEALED = 30, 24  # steps after a change, and after a surprise
_AT_ONCE = 3  # of the former; the others are taken with the next measurements
_SURPRISE = 2.0  # mean square of standardised departures from which on the posterior is approached through tempered ones
_AUTOREGRESSION = (0.02, 0.5)  # step of it
_BY_DIFFERENCE, _SCATTER = 0.7, 0.01  # fraction of steps by differences, and what is added to them
_DIFFERENCE = (0.2, 1.2)  # of the length of a difference that is best for a normal distribution, 2.38/(2 d)^(1/2)


class Outcome(NamedTuple):
    """What a measurement was to the posterior before it: its innovation, the standard deviation of that, and the probability that it was wild."""

    innovation: float
    deviation: float
    wild: float


@dataclass(frozen=True)
class Row:
    """What was measured at an operating point.

    Attributes
    ----------
    quantity : of `MEASURED`.
    conditions : the operating point, as `bearing_sim.watchers.estimation.response.CONDITIONS`.
    own : the level's prediction there.
    departure, variance : measured minus own: mean, and variance of what is not known about it.
    prior : variance of the departure by the ranges of the fields alone.
    """

    quantity: str
    conditions: tuple[float, float, float, float]
    own: float
    departure: float
    variance: float
    prior: float


def prior_scores(response: ResponseModel, known: np.ndarray, count: int = DRAWS) -> np.ndarray:
    """Return draws of scores of which nothing is measured, those of known fields at the scene's own values, shape (count, d)."""
    return np.where(known, response.nominal, prior_draws(len(known), count, seed=0, least=1e-4))


class Posterior:
    """Draws of the uncertain fields, given what was measured.

    Parameters
    ----------
    scene : its block ``estimation`` says how far the model errs, and how fast fields wander.
    response : of the scene.
    calibrated : which fields measurements may change, shape (d,) of bool.
    known : which fields are inputs of the run and have the scene's own values, shape (d,) of bool.

    Attributes
    ----------
    scores : the draws, shape (m, d).
    rows : what was measured.
    """

    def __init__(self, scene: Scene, response: ResponseModel, calibrated: np.ndarray, known: np.ndarray):
        self._scene, self._response = scene, response
        self._columns, self._known = np.flatnonzero(calibrated & ~known), known
        self._own_basis = response.basis_of(response.nominal[None])
        self._kept: dict[tuple, tuple[np.ndarray, float, float]] = {}
        self.restart()

    def restart(self) -> None:
        """Return to the ranges of the scene."""
        self._random = np.random.default_rng(0)
        self.scores = prior_scores(self._response, self._known)
        self._noise = self._random.permutation(ndtri((np.arange(DRAWS) + 0.5) / DRAWS))  # of what the draws do not explain
        self._basis = self._response.basis_of(self.scores)
        self.rows: list[Row] = []
        self._due = 0
        self._arrange()

    def copy(self) -> "Posterior":
        """Return another posterior of the same content, which learns by itself from now on."""
        other = object.__new__(Posterior)
        other.__dict__ |= {name: value.copy() if isinstance(value, np.ndarray | list) else value for name, value in self.__dict__.items()}
        other._random = np.random.default_rng(1)
        return other

    @property
    def learned(self) -> list[list]:
        """What was measured, as lists of numbers and names, as `restore` takes it."""
        return [[row.quantity, *row.conditions, row.own, row.departure, row.variance, row.prior] for row in self.rows]

    def restore(self, learned: Sequence[Sequence]) -> None:
        """Continue from what was measured earlier.

        Raises
        ------
        TypeError, ValueError
            It is something else.
        """
        self.restart()
        rows = []
        for quantity, *numbers in learned:
            speed, load, kelvin, angle, own, departure, variance, prior = (float(each) for each in numbers)
            row = Row(quantity, (speed, load, kelvin, angle), own, departure, variance, prior)
            if quantity not in MEASURED or not np.isfinite(numbers).all() or not (variance > 0.0 and prior >= 0.0):
                raise ValueError(f"expected a measured quantity and eight finite numbers with variances above 0; found {[quantity, *numbers]}")
            if not self._response.outside(np.array([row.conditions]))[0]:
                rows.append(row)
        self.rows = rows
        for _ in range(2):  # the response's errors follow from the draws
            self._arrange()
            self._approach()

    def wait(self, seconds: float) -> None:
        """Let time pass in which fields wander, so that what was measured says less and less, and draws take the steps that are still due."""
        if seconds > 0.0 and self.rows:
            fraction = seconds / self._scene.estimation.drift.wander_time
            self.rows = [replace(row, variance=row.variance + fraction * more) for row, more in zip(self.rows, self._wander)]
            self._diagonal += fraction * self._wander
            self._go_on()

    def forget(self) -> None:
        """Allow for a sudden change: a field may now lie anywhere in its range."""
        self.rows = [replace(row, variance=row.variance + more) for row, more in zip(self.rows, self._wander)]
        self._arrange()
        self._approach()

    def predict(self, quantity: str, conditions: np.ndarray, own: float) -> tuple[np.ndarray, float]:
        """Return the departure of a quantity from the level's own prediction by each draw, shape (m,), and the variance that none explains."""
        departures = self._departures(quantity, conditions, own, self._basis)
        errors = self._errors_at(quantity, conditions, own)
        variance = float(errors @ errors)
        same = self._rows_of(quantity)
        if not same:
            return departures, variance
        beside, places = np.zeros(len(self.rows)), self._places(self.rows[k] for k in same)
        beside[same] = _shared(errors[None], self._errors[same], self._scaled(conditions)[None], places)[0]
        factor = cho_factor(self._covariance(), lower=True)
        gain = cho_solve(factor, beside)
        return departures + (self._measured - self._predicted) @ gain, max(variance - float(beside @ gain), 0.0)

    def drawn(self, quantity: str, conditions: np.ndarray, own: float, systematic: float = 0.0) -> np.ndarray:
        """Return draws of the departure of a quantity, shape (m,): the model's error included, and a systematic one of what was measured."""
        departures, left = self.predict(quantity, conditions, own)
        return departures + math.hypot(math.sqrt(left), systematic if self.rows else 0.0) * self._noise

    def learn(
        self, quantity: str, conditions: np.ndarray, own: float, departure: float, variance: float, wild: tuple[float, float], readings: int = 1
    ) -> Outcome:
        """Learn from a measurement.

        Parameters
        ----------
        quantity : of `MEASURED`.
        conditions : the operating point, shape (4,).
        own : the level's prediction.
        departure : measured minus own.
        variance : of its noise.
        wild : fraction of readings that say nothing, and the standard deviation of such.
        readings : of which the measurement is a robust mean.  Where next to nothing is known about the operating point, it counts as wild by the
            probability that most of them are; where much is, by that of one, since a departure is a sudden change of the machine then, which
            waits for the change detector.
        """
        expected, left = self.predict(quantity, conditions, own)
        place = self._place(quantity, conditions)
        if place is None or self.rows[place].variance > self._model[place, place]:
            wild = wild[0] ** ((readings + 1) // 2), wild[1]
        outcome = _judged(departure - expected, left + variance, *wild)
        variance /= max(1.0 - outcome.wild, 1e-9)
        if place is None:
            scores = prior_scores(self._response, self._known, DRAWS // 4)
            prior = float(self._departures(quantity, conditions, own, self._response.basis_of(scores)).var())
            self.rows.append(Row(quantity, tuple(map(float, conditions)), float(own), float(departure), float(variance), prior))
            if math.isfinite(prior):
                self._arrange()
                self._approach()
            else:
                self.rows.pop()
            return outcome
        row = self.rows[place]
        gain = row.variance / (row.variance + variance)
        self.rows[place] = replace(
            row,
            own=row.own + gain * (own - row.own),
            departure=row.departure + gain * (departure - row.departure),
            variance=max((1.0 - gain) * row.variance, 1e-12),
        )
        self._update(place)
        return outcome

    def _place(self, quantity: str, conditions: np.ndarray) -> int | None:
        """Return the row that a measurement belongs to; None where it needs a new one."""
        same = self._rows_of(quantity)
        if not same:
            return None
        correlation = _correlation(self._scaled(conditions)[None], self._places(self.rows[k] for k in same))[0]
        best = int(correlation.argmax())
        if correlation[best] > (_SAME if len(same) < _MOST_ROWS else _ALIKE):
            return same[best]
        if len(same) >= _MOST_ROWS:  # the least known gives way
            del self.rows[max(same, key=lambda k: self.rows[k].variance)]
        return None

    def _arrange(self) -> None:
        """Compute what follows from the rows."""
        rows, self._centre = self.rows, self._basis.mean(axis=0)
        self._errors = np.array([self._errors_at(row.quantity, row.conditions, row.own) for row in rows]).reshape(-1, 2)
        places = self._places(rows)
        alike = np.array([[one.quantity == other.quantity for other in rows] for one in rows]).reshape(len(rows), len(rows))
        self._model = _shared(self._errors, self._errors, places, places) * alike
        self._diagonal = np.array([row.variance for row in rows])
        self._wander = np.array([row.prior for row in rows]) + self._model.diagonal()
        self._measured = np.array([row.departure for row in rows])
        slopes = [self._response_at(row.quantity, row.conditions)[0] for row in rows]
        self._slopes = np.array(slopes).reshape(len(rows), self._basis.shape[1] + 1)
        self._predicted = self._at_rows(self._basis)
        self._seen = self._measured.copy(), self._model.diagonal() + self._diagonal

    def _update(self, place: int) -> None:
        """Take over a row that has changed, and let draws move if it has changed by enough since they did."""
        self._measured[place], self._diagonal[place] = self.rows[place].departure, self.rows[place].variance
        measured, total = self._seen
        now = self._model[place, place] + self._diagonal[place]
        moved = abs(self._measured[place] - measured[place]) / math.sqrt(now)
        if moved > _NOTICED or abs(math.log(now / total[place])) > _NOTICED:
            self._arrange()
            self._approach()
        else:
            self._go_on()

    def _covariance(self) -> np.ndarray:
        return self._model + np.diag(self._diagonal)

    def _errors_at(self, quantity: str, conditions: np.ndarray, own: float) -> np.ndarray:
        """Return what the prediction errs by where all fields are right: standard deviations of the model's error and of the response's, shape (2,).

        The latter has the sign of the departure, in proportion to which the response errs; the departure is that of the draws' mean when rows were
        arranged last, so that errors at one operating point are the same from there on.
        """
        errors = self._scene.estimation.model_error
        slopes, proportion, least = self._response_at(quantity, conditions)
        change, rising = float(slopes[:-1] @ self._centre + slopes[-1]), 1.0
        if quantity == SLIP:
            slip = own + float(slip_departures(np.array([own]), np.array([[change]]))[0, 0])
            rising, model = 1.0 / math.hypot(slip, SLIP_SCALE) + 1.0 / max(1.01 - slip, 0.01), errors.slip
        else:
            model = errors.clearance if quantity == CLEARANCE else errors.temperature
        return np.array([max(model, 1e-9), math.copysign(math.hypot(proportion * change, least) / rising, change)])

    def _response_at(self, quantity: str, conditions: Sequence[float]) -> tuple[np.ndarray, float, float]:
        """Return what the response says at an operating point, from what is kept of the newest ones.

        Returns
        -------
        coefficients of the polynomials of the fields, the last of them that of the scene's own values; by what part of a departure, and by how
        much at least, the response errs.
        """
        key = (quantity, *map(float, conditions))
        if key not in self._kept:
            if len(self._kept) >= _REMEMBERED:
                self._kept.clear()
            there, column = np.array([key[1:]]), ANSWERS.index(quantity)
            rows = self._response.condition_coefficients(there)[0, column]
            proportion, least = self._response.error_scales(there, column)
            self._kept[key] = np.append(rows, -rows @ self._own_basis[0]), float(proportion[0]), float(least[0])
        return self._kept[key]

    def _at_rows(self, basis: np.ndarray) -> np.ndarray:
        """Return departures at all rows for draws with a basis of shape (m, j), shape (m, rows)."""
        changes = basis @ self._slopes[:, :-1].T + self._slopes[:, -1]
        slips = self._rows_of(SLIP)
        changes[:, slips] = slip_departures(np.array([self.rows[k].own for k in slips]), changes[:, slips])
        return changes

    def _departures(self, quantity: str, conditions: np.ndarray, own: float, basis: np.ndarray) -> np.ndarray:
        slopes = self._response_at(quantity, conditions)[0]
        changes = basis @ slopes[:-1] + slopes[-1]
        return slip_departures(np.array([own]), changes[:, None])[:, 0] if quantity == SLIP else changes

    def _log_likelihood(self, predicted: np.ndarray) -> np.ndarray:
        left = np.linalg.solve(self._factor, (self._measured - predicted).T)
        return -0.5 * np.square(left).sum(axis=0)

    def _approach(self) -> None:
        """Let the draws begin to approach the posterior of the rows as they are now; further measurements go on with it (`_go_on`)."""
        self._due = _MOVES
        self._go_on(tempers=True)

    def _go_on(self, tempers: bool = False) -> None:
        """Let the draws take a few of the steps that are due since the rows have changed, after a surprise through tempered posteriors first."""
        if not self._due or not len(self._columns) or not self.rows:
            return
        self._factor = np.linalg.cholesky(self._covariance())
        logarithms = self._log_likelihood(self._predicted)
        surprise = -2.0 * float(np.median(logarithms)) / len(self.rows)
        powers = [1.0] * min(_AT_ONCE, self._due)
        if tempers and surprise > _SURPRISE:
            powers = [*np.geomspace(min(2.0 / surprise, 0.5), 1.0, _ANNEALED), *powers]
        for power in powers:
            logarithms = self._move(logarithms, power)
        self._due = max(self._due - _AT_ONCE, 0)

    def _move(self, logarithms: np.ndarray, power: float) -> np.ndarray:
        """Let every draw take a step of one kind or the other towards a posterior whose likelihood has a power; return log-likelihoods."""
        half = DRAWS // 2
        best = 2.38 / math.sqrt(2.0 * len(self._columns))
        for mine, others in ((slice(0, half), slice(half, None)), (slice(half, None), slice(0, half))):
            states, pool = self.scores[mine][:, self._columns], self.scores[others][:, self._columns]
            pairs, noise = self._random.integers(0, half, (2, half)), self._random.normal(size=states.shape)
            length = best * self._random.uniform(*_DIFFERENCE, (half, 1))
            differed = states + length * (pool[pairs[0]] - pool[pairs[1]]) + _SCATTER * noise
            step = np.exp(self._random.uniform(*np.log(_AUTOREGRESSION), (half, 1)))
            by_difference = self._random.random(half) < _BY_DIFFERENCE
            proposed = self.scores[mine].copy()
            proposed[:, self._columns] = np.where(by_difference[:, None], differed, np.sqrt(1.0 - step**2) * states + step * noise)
            prior = np.where(by_difference, 0.5 * (np.square(states) - np.square(differed)).sum(axis=1), 0.0)
            logarithms[mine] = self._decide(mine, proposed, logarithms[mine], power, prior)
        return logarithms

    def _decide(self, mine: slice, proposed: np.ndarray, logarithms: np.ndarray, power: float, prior: np.ndarray) -> np.ndarray:
        """Accept proposals with the probability of Metropolis and Hastings; return logarithms of the likelihoods of the draws there are then."""
        basis = self._response.basis_of(proposed)
        predicted = self._at_rows(basis)
        found = self._log_likelihood(predicted)
        accepted = np.log(self._random.random(len(found))) < power * (found - logarithms) + prior
        self.scores[mine] = np.where(accepted[:, None], proposed, self.scores[mine])
        self._basis[mine] = np.where(accepted[:, None], basis, self._basis[mine])
        self._predicted[mine] = np.where(accepted[:, None], predicted, self._predicted[mine])
        return np.where(accepted, found, logarithms)

    def _rows_of(self, quantity: str) -> list[int]:
        return [k for k, row in enumerate(self.rows) if row.quantity == quantity]

    def _places(self, rows: Iterable[Row]) -> np.ndarray:
        return np.array([self._scaled(row.conditions) for row in rows]).reshape(-1, len(_DISTANCES))

    def _scaled(self, conditions: Sequence[float]) -> np.ndarray:
        floor = max(_LOAD_FLOOR * self._scene.operating.radial_load, 1.0)
        speed, load, temperature = conditions[:3]
        return np.array([math.log(max(abs(speed), 1e-3)), math.log(max(load, 0.0) + floor), temperature]) / _DISTANCES


def slip_departures(own: np.ndarray, changes: np.ndarray) -> np.ndarray:
    """Return how far slip departs from its own values, shape (k,), by changes on the scale of the response, shape (m, k)."""
    return restored_slip(slip_scale(own) + changes) - own


def _correlation(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the correlation of the model's errors at scaled conditions, shape (n, m): Matern's with a smoothness of 3/2."""
    distance = math.sqrt(3.0) * np.linalg.norm(one[:, None] - other[None], axis=-1)
    return (1.0 + distance) * np.exp(-distance)


def _shared(one: np.ndarray, other: np.ndarray, there: np.ndarray, elsewhere: np.ndarray) -> np.ndarray:
    """Return the covariance of errors at scaled conditions of shapes (n, 3) and (m, 3), shape (n, m); see `Posterior._errors_at`."""
    model = one[:, :1] * other[:, 0] * _correlation(there, elsewhere)
    return model + one[:, 1:] * other[:, 1] * _correlation(there / _RESPONSE_DISTANCES, elsewhere / _RESPONSE_DISTANCES)


def _judged(innovations: np.ndarray, variance: float, fraction: float, width: float) -> Outcome:
    """Return the probability that a measurement is wild, of which there is a fraction with that standard deviation.

    Parameters
    ----------
    innovations : by each draw, shape (m,).
    variance : of what none of them explains.
    """
    spread = float(innovations.var())
    mean, wide = float(innovations.mean()), variance + spread + width**2
    good = (1.0 - fraction) * float(np.exp(-0.5 * np.square(innovations) / variance).mean()) / math.sqrt(variance)
    bad = fraction * math.exp(-0.5 * mean**2 / wide) / math.sqrt(wide)
    return Outcome(mean, math.sqrt(variance + spread), bad / (good + bad) if good + bad > 0.0 else 1.0)
