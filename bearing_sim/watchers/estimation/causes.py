# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What may have changed: modelled causes of a lasting departure from a calibrated prediction, with their evidence.

Each cause changes one number: an uncertain field, which may lie anywhere in its range afterwards; the oil's temperature or the load, which an
input may give wrongly; or the scale of the cage speed sensor.  The response says what each would do to slip at every operating point since the
change, and the probability of the measured departures, averaged over the sizes that the change may have, is the cause's evidence
(Bayes factors; Kass and Raftery, J. Am. Stat. Assoc. 90, 1995, 773).  All groups of causes are equally probable beforehand, and so are the
causes within one.  A cause that could explain anything explains nothing well: what none of them explains is one of the hypotheses.

At one operating point most causes can explain any departure, and their probabilities say little more than which needs the least unlikely
change.  They come apart as speed and load change.
"""

import math
from collections import Counter
from typing import NamedTuple

import numpy as np
from scipy.special import logsumexp, ndtri

from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities, value_at
from bearing_sim.watchers.estimation.posterior import SLIP, Posterior
from bearing_sim.watchers.estimation.response import ResponseModel, restored_slip, slip_scale

OIL_QUANTITY, OIL, TRACTION, CLEARANCE = "oil quantity", "viscosity or temperature of the oil", "traction of the oil", "clearance"
COOLING, CAGE, LOAD, SENSOR, NONE = "cooling", "cage and its guide", "load", "cage speed sensor", "none of the modelled causes"
_GROUPS = {  # by what the path of a field contains
    OIL_QUANTITY: ("mixture_fraction", "oil_flow", "lubricant.flow", "oil_level", "supply"),
    OIL: ("viscosity", "lubricant.temperature", "lubricant.oil"),
    TRACTION: ("traction",),
    CAGE: ("cage.",),
    CLEARANCE: ("clearance", "radius", "diameter", "interference", "d_value", "mounting"),
    COOLING: ("heat.",),
}
_NEEDED = {  # fields of which one that a scene has needs a range, so that the group is among the causes
    OIL_QUANTITY: ("lubricant.mixture_fraction",),
    TRACTION: ("lubricant.traction_scale",),
    CAGE: ("bearing.cage.guide_clearance", "bearing.cage.pocket_clearance"),
    CLEARANCE: ("bearing.clearance", "bearing.outer_raceway.low_radius"),
    COOLING: ("heat.convection_factor", "heat.oil_flow"),
}
_SIZES, _FINE = 41, 20  # sizes of a change at which its effect is computed, and parts of the way between two at which it is interpolated
_TEMPERATURE_CHANGE = 15.0  # K; standard deviation of an oil temperature given wrongly, or of a viscosity that corresponds to it (assumption)
_LOAD_CHANGE = 0.3  # of the logarithm of a load given wrongly (assumption)
_SCALE_CHANGE = 0.03  # of a sensor's scale (assumption)
_SENSITIVITY = 0.15  # relative; how far the fields that are not known may change what a cause does, alike at all points (assumption)
_UNEXPLAINED = 0.05  # slip; standard deviation of a departure without a modelled cause, independent from point to point (assumption)
_NEAR = (0.02, 0.1, 2.0)  # relative speed, relative load, and K, within which batches share an operating point
_LEAST_ERROR = 1e-4  # of the mean slip at a point; the response is not better
_MIDDLE = (0.05, 0.95)


class Evidence(NamedTuple):
    """Departures since a change, n batches.

    Attributes
    ----------
    conditions : `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).
    own : slip by the level, shape (n,).
    residual : measured minus own slip, shape (n,).
    variance : of the noise of the latter, shape (n,).
    """

    conditions: np.ndarray
    own: np.ndarray
    residual: np.ndarray
    variance: np.ndarray


class Cause(NamedTuple):
    """A cause that a change may have.

    Attributes
    ----------
    group : what has changed, in words.
    what : the number that has: a dotted path, or words.
    text : group, number and sizes in words.
    probability : given that one of the causes holds.
    before, after, low, high : of the number [SI], the latter two the ends that 5 and 95 % lie below; NaN for no modelled cause.
    evidence : natural logarithm of how much more probable it makes the departures than no change does.
    misfit : mean square of what it leaves of the departures, over their variance; about 1 for a cause that explains them.
    """

    group: str
    what: str
    text: str
    probability: float = 0.0
    before: float = math.nan
    after: float = math.nan
    low: float = math.nan
    high: float = math.nan
    evidence: float = -math.inf
    misfit: float = math.nan


def group_of(field: str) -> str:
    """Return the group of causes that a field belongs to, by its path; the path itself where it belongs to none."""
    return next((group for group, words in _GROUPS.items() if any(word in field for word in words)), field)


def gathered(evidence: Evidence) -> Evidence:
    """Return evidence by operating point: weighted means of the batches with nearly the same conditions."""
    speed, load, temperature, _ = evidence.conditions.T
    floor = max(float(load.max()) * _NEAR[1], 1.0)
    keys = np.round(np.stack([np.log(np.abs(speed) + 1e-9) / _NEAR[0], np.log(load + floor) / _NEAR[1], temperature / _NEAR[2]], axis=1))
    _, index = np.unique(keys, axis=0, return_inverse=True)
    index = index.ravel()
    weights = 1.0 / evidence.variance
    sums = np.bincount(index, weights)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(index, weights * values) / sums

    conditions = np.stack([mean(column) for column in evidence.conditions.T], axis=1)
    return Evidence(conditions, mean(evidence.own), mean(evidence.residual), 1.0 / sums + _LEAST_ERROR**2)


def not_modelled(scene: Scene, response: ResponseModel) -> dict[str, str]:
    """Return the groups of causes that cannot be named because no field of theirs has a range, each with the field to give one."""
    modelled = {group_of(name) for name in response.names}
    found = {}
    for group, fields in _NEEDED.items():
        own = [field for field in fields if value_at(scene, field) is not None]
        if own and group not in modelled:
            found[group] = own[0]
    return found


class _Departures:
    """Measured departures at m operating points, and what a cause would make of the prediction there."""

    def __init__(self, response: ResponseModel, before: Posterior, evidence: Evidence):
        self.response, self.evidence = response, gathered(evidence)
        found = self.evidence
        nominal = response.respond_scaled(found.conditions, response.basis_of(response.nominal[None]))[:, 0, 0]
        self._start = slip_scale(found.own) - nominal
        self._centre = before.scores.mean(axis=0)
        drawn = [before.predict(SLIP, each, float(own)) for each, own in zip(found.conditions, found.own)]
        spread = np.stack([departures for departures, _ in drawn], axis=1)
        self.usual = found.own + spread.mean(axis=0)
        self.covariance = np.atleast_2d(np.cov(spread.T)) + np.diag(found.variance + np.array([left for _, left in drawn]))
        self.residual = found.own + found.residual - self.usual
        self._at_centre = self.slip(self._centre[None])[0]

    def slip(self, scores: np.ndarray, conditions: np.ndarray | None = None) -> np.ndarray:
        """Return slip at scores of shape (k, d), shape (k, m); NaN outside of the response."""
        asked = self.evidence.conditions if conditions is None else conditions
        return restored_slip(self._start + self.response.respond_scaled(asked, self.response.basis_of(scores))[:, :, 0].T)

    def by_field(self, column: int, scores: np.ndarray) -> np.ndarray:
        """Return how slip changes if the score of a field becomes each of ``scores``, shape (k, m)."""
        changed = np.repeat(self._centre[None], len(scores), axis=0)
        changed[:, column] = scores
        return self.slip(changed) - self._at_centre

    def by_conditions(self, column: int, values: np.ndarray) -> np.ndarray:
        """Return how slip changes if a condition is each of ``values`` instead, of shape (k, m); shape (k, m)."""
        rows = []
        for row in values:
            conditions = self.evidence.conditions.copy()
            conditions[:, column] = row
            rows.append(self.slip(self._centre[None], conditions)[0] - self._at_centre)
        return np.array(rows)

    def log_likelihood(self, effects: np.ndarray, more: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """Return logarithms of the probability of the departures under effects, and the mean squares left; each at the sizes of `_finely`.

        Parameters
        ----------
        effects : of k sizes, shape (k, m).
        more : standard deviation of what is not explained besides.
        """
        covariance = self.covariance + more**2 * np.eye(len(self.residual))
        effects = _finely(effects)
        factor = np.linalg.cholesky(covariance)
        left = np.linalg.solve(factor, (self.residual - np.nan_to_num(effects)).T)
        scaled = np.linalg.solve(factor, _SENSITIVITY * np.nan_to_num(effects).T)
        more_variance = 1.0 + np.square(scaled).sum(axis=0)
        squares = np.square(left).sum(axis=0) - np.square((left * scaled).sum(axis=0)) / more_variance
        found = -0.5 * squares - np.log(np.diag(factor)).sum() - 0.5 * np.log(more_variance)
        found[np.isnan(effects).any(axis=1)] = -np.inf
        return found, squares / len(self.residual)


def _finely(values: np.ndarray) -> np.ndarray:
    """Return rows of shape (k, m) with others in between, on straight lines; departures may be known much better than effects are spaced."""
    fine = np.linspace(0.0, len(values) - 1.0, (len(values) - 1) * _FINE + 1)
    below = np.minimum(fine.astype(int), max(len(values) - 2, 0))
    above = np.minimum(below + 1, len(values) - 1)
    return values[below] + (fine - below)[:, None] * (values[above] - values[below])


def causes_of(scene: Scene, response: ResponseModel, before: Posterior, evidence: Evidence) -> tuple[Cause, ...]:
    """Return the causes of a change, the likeliest first; the probabilities of all that are modelled, and of none, sum to 1.

    Parameters
    ----------
    scene : of the bearing.
    response : of the scene.
    before : the posterior from before the change.
    evidence : departures since.
    """
    departures, known = _Departures(response, before, evidence), quantities(type(scene))
    sizes = ndtri((np.arange(_SIZES) + 0.5) / _SIZES)
    nothing = np.zeros((1, len(departures.residual)))
    quiet = departures.log_likelihood(nothing)[0][0]
    found = []
    centre, spread = before.scores.mean(axis=0), before.scores.var(axis=0)
    for column, field in enumerate(response.names):
        if spread[column] < 1e-6:  # an input
            continue
        states = np.repeat(centre[None], _SIZES + 1, axis=0)
        states[1:, column] = sizes
        values = response.fields.values_of(states)[:, column]
        show = known[field].show if field in known else "{:.4g}".format
        effects = departures.by_field(column, sizes)
        found.append(_cause(group_of(field), field, values[0], values[1:], departures.log_likelihood(effects), quiet, show))
    conditions = departures.evidence.conditions
    shift, factor, scale = _TEMPERATURE_CHANGE * sizes, np.exp(_LOAD_CHANGE * sizes), 1.0 + _SCALE_CHANGE * sizes
    by_temperature = departures.by_conditions(2, conditions[:, 2] + shift[:, None])
    by_load = departures.by_conditions(1, conditions[:, 1] * factor[:, None])
    by_scale = (1.0 - scale[:, None]) * (1.0 - departures.usual)
    for group, what, own, values, effects, show in (
        (OIL, "oil temperature against its input", 0.0, shift, by_temperature, "{:+.3g} K".format),
        (LOAD, "load over its input", 1.0, factor, by_load, "{:.3g}".format),
        (SENSOR, "sensor scale", 1.0, scale, by_scale, "{:.4g}".format),
    ):
        found.append(_cause(group, what, own, values, departures.log_likelihood(effects), quiet, show))
    logarithm, misfit = departures.log_likelihood(nothing, _UNEXPLAINED)
    found.append(Cause(NONE, NONE, NONE, evidence=float(logarithm[0] - quiet), misfit=float(misfit[0])))
    return _with_probabilities(found)


def _cause(group: str, what: str, before: float, values: np.ndarray, likelihood: tuple[np.ndarray, np.ndarray], quiet: float, show) -> Cause:
    """Return a cause from the probabilities of the sizes that it may have, all equally probable beforehand."""
    values = _finely(values[:, None])[:, 0]
    logarithms, misfits = likelihood
    total = float(logsumexp(logarithms))
    if not math.isfinite(total):
        return Cause(group, what, f"{group}: {what}", before=before)
    weights = np.exp(logarithms - total)
    order = np.argsort(values)
    low, after, high = np.interp((_MIDDLE[0], 0.5, _MIDDLE[1]), np.cumsum(weights[order]) - 0.5 * weights[order], values[order])
    text = f"{group}: {what} from {show(before)} to {show(float(after))} ({show(float(low))} to {show(float(high))})"
    evidence = total - math.log(len(values)) - quiet
    return Cause(group, what, text, 0.0, float(before), float(after), float(low), float(high), evidence, float(misfits.min()))


def _with_probabilities(found: list[Cause]) -> tuple[Cause, ...]:
    """Return causes with their probabilities, sorted by them; groups are equally probable beforehand."""
    sizes = Counter(one.group for one in found)
    logarithms = np.array([one.evidence - math.log(sizes[one.group]) for one in found])
    probabilities = np.exp(logarithms - logsumexp(logarithms))
    order = np.argsort(-probabilities)
    return tuple(found[k]._replace(probability=float(probabilities[k])) for k in order)
