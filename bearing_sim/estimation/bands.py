# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bands about what a run computes: how far cage slip, life and clearance may be off, by what is uncertain about the scene."""

import math
from collections.abc import Sequence

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from bearing_sim.estimation.response import ANSWERS, PROBABILITIES, Domain, ResponseModel, restored, transformed
from bearing_sim.scene.scene import Scene

QUANTITIES = ("cage_slip", "rating_life", "running_clearance", "remaining_life")
"""What has a band; units [1, h, m, h]."""

_QUANTILES = (*PROBABILITIES, 0.5)
_DRAWS = 256  # of the scores before anything is measured, a power of two
_CELL = np.array([0.01, 0.01, 0.2, math.radians(0.5)])  # of speed and load, relative, temperature [K] and angle: operating points alike in bands
_CELLS_KEPT = 20_000
_AT_ONCE = 64  # operating points: so many fit the processor's cache
_HOUR = 3600.0
_SLIP, _LIFE, _MODIFIED, _CLEARANCE = (ANSWERS.index(name) for name in ("cage_slip", "rating_life", "modified_rating_life", "running_clearance"))


class BandEstimator:
    """Bands for the samples of a run, of any level.

    The response says by how much a quantity differs between the scene's own values and others that the uncertain fields may have, and its
    quantiles are added to the level's own value.  Differences are those of slip on a scale without ends, of the logarithms of lives and of
    clearance as it is: on these scales the fields act alike at every level and operating point, so a level above ``steady`` keeps its own
    value within its band, and no band of slip or life reaches beyond what can be.

    Parameters
    ----------
    scene : of the run.
    response : of the scene.
    known : dotted paths of fields that are measured in this run, such as ``lubricant.temperature`` where an oil temperature comes in; they have
        the scene's own values in all draws.

    Attributes
    ----------
    remaining_life : of the samples that were taken last, by the lives that they have themselves [h], shape (n,).
    medians : of the quantities, of the samples that were taken last, shape (n, 4).
    """

    def __init__(self, scene: Scene, response: ResponseModel, known: Sequence[str] = ()):
        self.response, self._memory = response, scene.thresholds.remaining_life_memory
        self._own = response.basis_of(response.nominal[None])
        self._time, self._rates = math.nan, np.full(4, math.nan)
        self.remaining_life, self.medians = np.empty(0), np.empty((0, len(QUANTITIES)))
        self._drawn = prior_draws(len(response.fields))
        self.know(known)

    def know(self, known: Sequence[str]) -> None:
        """Take which fields are measured from now on (see the parameter)."""
        self._known = np.array([name in known for name in self.response.names], bool)
        self.use(*self._drawn)

    def use(self, scores: np.ndarray, weights: np.ndarray) -> None:
        """Take draws of the uncertain fields, such as those of a posterior, for all samples from now on.

        Parameters
        ----------
        scores : shape (m, d).
        weights : of the draws, of any sum, shape (m,).
        """
        self._drawn = scores, weights
        self.scores = np.where(self._known, self.response.nominal, scores)
        self.weights = np.asarray(weights, float) / np.sum(weights)
        self._basis = np.concatenate([self._own, self.response.basis_of(self.scores)])
        self._kept: dict[bytes, np.ndarray] = {}  # changes by operating point, see `_changes`

    def adjust(self, remaining_life_memory: float) -> None:
        """Take another time constant of the mean damage rate [s] from now on."""
        self._memory = remaining_life_memory

    def take(self, block: np.ndarray) -> np.ndarray:
        """Return the bands of the samples that follow.

        Parameters
        ----------
        block : samples, shape (n,), see `bearing_sim.model.sample`.

        Returns
        -------
        by quantity (`QUANTITIES`) the values that 5 and 95 % lie below, shape (n, 4, 2); NaN at rest (slip) and where the operating point is
        outside of the response.
        """
        changes = self._changes(block)
        own = np.stack([block["cage_slip"], block["rating_life"], block["modified_rating_life"], block["running_clearance"]], axis=1)
        own = transformed(np.concatenate([own, np.zeros((len(block), 2))], axis=1))
        ends = restored(own[:, None] + changes)
        found = np.empty((len(block), len(QUANTITIES), len(_QUANTILES)))
        for column, answer in enumerate((_SLIP, _LIFE, _CLEARANCE)):
            found[:, column] = ends[:, :, answer]
        remaining = self._remaining_lives(block, np.exp(-changes[:, :, _MODIFIED]))
        self.remaining_life, found[:, 3] = remaining[:, 0], remaining[:, 1:]
        self.medians = found[:, :, -1]
        return found[:, :, :-1]

    def _changes(self, block: np.ndarray) -> np.ndarray:
        """Return the quantiles of the differences from the scene's own values on the scales of `transformed`, shape (n, 3, 6).

        They are those at the `cells` of the operating points; those of cells that come again are kept.
        """
        load = np.hypot(block["load_y"], block["load_z"])
        conditions = np.stack([block["shaft_speed"], load, block["oil_temperature"], np.arctan2(block["load_z"], block["load_y"])], axis=1)
        there, indices = np.unique(cells(conditions, self.response.domain), axis=0, return_inverse=True)
        keys = [row.tobytes() for row in there]
        new = [k for k, key in enumerate(keys) if key not in self._kept]
        if len(self._kept) + len(new) > _CELLS_KEPT:
            self._kept, new = {}, list(range(len(keys)))
        for begin in range(0, len(new), _AT_ONCE):
            chosen = new[begin : begin + _AT_ONCE]
            scaled = self.response.respond_scaled(there[chosen], self._basis)
            changes = weighted_quantiles(scaled[:, 1:] - scaled[:, :1], self.weights, _QUANTILES)
            self._kept.update(zip((keys[k] for k in chosen), changes))
        return np.stack([self._kept[key] for key in keys])[indices.ravel()]

    def _remaining_lives(self, block: np.ndarray, factors: np.ndarray) -> np.ndarray:
        """Return the remaining life [h], its band and its median: (1 - D)/(dD/dt) with dD/dt the fading mean of the damage rate, as in `Monitor`.

        The fields have been what they are for as long as the bearing runs: what was off by a factor in the rate was off by it in the damage.

        Parameters
        ----------
        block : samples, shape (n,).
        factors : of the rates of damage at both ends of the band and at its median, shape (n, 3).

        Returns
        -------
        shape (n, 4).
        """
        factors = np.concatenate([np.ones((len(block), 1)), factors], axis=1)
        rates = factors / (_HOUR * block["modified_rating_life"][:, None])
        found = np.empty_like(rates)
        for k, (time, damage) in enumerate(zip(block["time"].tolist(), block["damage"].tolist())):
            elapsed = time - self._time
            weight = 1.0 - math.exp(-elapsed / self._memory) if elapsed >= 0.0 else 1.0
            self._rates = np.where(np.isnan(self._rates), rates[k], self._rates + weight * (rates[k] - self._rates))
            self._time = time
            left = np.clip(1.0 - damage * factors[k], 0.0, 1.0)
            with np.errstate(divide="ignore", invalid="ignore"):
                found[k] = np.where(left > 0.0, left / (_HOUR * self._rates), 0.0 * left)
        return found


def cells(conditions: np.ndarray, domain: Domain) -> np.ndarray:
    """Return operating points rounded to the middle of cells within which bands about what is computed hardly differ.

    Cells are 1 % of speed and load wide, 0.2 K of the oil temperature and half a degree of the load's direction.  Widths of bands follow speed and
    load by powers of about one, so that edges are off by a percent of the width or so, where a tenth is asked for.  A point within the domain of
    a response stays in it.

    Parameters
    ----------
    conditions : columns `bearing_sim.estimation.response.CONDITIONS`, shape (n, 4).
    domain : of the response.

    Returns
    -------
    shape (n, 4).
    """
    found = np.array(conditions, float)
    for column, (least, largest) in enumerate((domain.speeds, domain.loads)):
        magnitude = np.maximum(np.abs(found[:, column]), least)  # below, the response is that of the least
        rounded = np.exp(_CELL[column] * np.round(np.log(magnitude) / _CELL[column]))
        rounded = np.where(magnitude <= largest, np.clip(rounded, least, largest), magnitude)
        found[:, column] = np.copysign(rounded, found[:, column])
    low, high = domain.temperatures
    rounded = _CELL[2] * np.round(found[:, 2] / _CELL[2])
    found[:, 2] = np.where((found[:, 2] >= low) & (found[:, 2] <= high), np.clip(rounded, low, high), found[:, 2])
    found[:, 3] = _CELL[3] * np.round(found[:, 3] / _CELL[3]) if domain.period else 0.0
    return found


def prior_draws(fields: int, count: int = _DRAWS, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return scores of fields of which nothing is measured, evenly spread, shape (count, fields), and their weights, shape (count,)."""
    uniform = qmc.Sobol(d=max(fields, 1), scramble=True, seed=np.random.default_rng(seed)).random_base2(count.bit_length() - 1)
    return ndtri(np.clip(uniform, 1e-6, 1.0 - 1e-6))[:, :fields], np.full(count, 1.0 / count)


def weighted_quantiles(values: np.ndarray, weights: np.ndarray, probabilities: Sequence[float]) -> np.ndarray:
    """Return quantiles along the second axis, linear between the middles of the steps of the distribution.

    Parameters
    ----------
    values : shape (n, m, q).
    weights : of the m values, their sum 1, shape (m,).
    probabilities : of the k quantiles.

    Returns
    -------
    shape (n, k, q); NaN where a value is.
    """
    order = np.argsort(values, axis=1)
    ordered = np.take_along_axis(values, order, axis=1)
    steps = weights[order]
    below = np.cumsum(steps, axis=1) - 0.5 * steps
    found = np.empty((values.shape[0], len(probabilities), values.shape[2]))
    for k, probability in enumerate(probabilities):
        upper = np.clip(np.sum(below < probability, axis=1), 1, values.shape[1] - 1)[:, None]
        low, high = (np.take_along_axis(below, at, axis=1)[:, 0] for at in (upper - 1, upper))
        first, last = (np.take_along_axis(ordered, at, axis=1)[:, 0] for at in (upper - 1, upper))
        with np.errstate(divide="ignore", invalid="ignore"):
            fraction = np.clip(np.where(high > low, (probability - low) / (high - low), 0.0), 0.0, 1.0)
        found[:, k] = first + fraction * (last - first)
    return found
