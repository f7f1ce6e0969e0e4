# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bands about what a run computes: how far cage slip, life and clearance may be off, by what is uncertain about the scene."""

import math
from collections.abc import Sequence

import numpy as np

from bearing_sim.scene.scene import Scene
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import (
    ANSWERS,
    PROBABILITIES,
    Domain,
    Interpolation,
    ResponseModel,
    add_slip_and_oil,
    prior_draws,
    restored,
    transformed,
)

QUANTITIES = ("cage_slip", "rating_life", "running_clearance", "remaining_life")
"""What has a band; units [1, h, m, h]."""

_QUANTILES = (*PROBABILITIES, 0.5)
_CELL = np.array([0.01, 0.01, 0.2, math.radians(0.5)])  # of speed and load, relative, temperature [K] and angle: operating points alike in bands
_CELLS_KEPT = 5_000
_AT_ONCE = 64  # operating points: so many fit the processor's cache
_HOUR = 3600.0
_ANSWERED = [ANSWERS.index(name) for name in ("cage_slip", "rating_life", "running_clearance")]
_SLIP, _MODIFIED = _ANSWERED[0], ANSWERS.index("modified_rating_life")
_BY_OIL = {_ANSWERED[1], ANSWERS.index("viscosity_ratio")}  # what changes by oil follow from


class BandEstimator:
    """Bands for the samples of a run, of any level.

    The response says by how much a quantity differs between the scene's own values and others that the uncertain fields may have, and the
    quantiles of these differences are added to the level's own value.  They are those of slip on a scale without ends, of the logarithms of lives
    and of clearance as it is: on these scales the fields act alike at every level and operating point, so a level above ``steady`` keeps its own
    value within its band, and no band of slip or life reaches beyond what can be.

    Parameters
    ----------
    scene : of the run.
    response : of the scene.
    known : dotted paths of fields that are measured in this run, such as ``lubricant.temperature`` where an oil temperature comes in; they have
        the scene's own values in all draws.

    Attributes
    ----------
    remaining_life : of the newest samples, by the lives that they have themselves [h], shape (n,).
    medians : of the quantities, of the newest samples, shape (n, 4).
    """

    def __init__(self, scene: Scene, response: ResponseModel, known: Sequence[str] = ()):
        self.response, self._memory = response, scene.thresholds.remaining_life_memory
        self._effects = SlipAndOil(scene)
        varied = set(response.varied_answers()) & {*_ANSWERED, _MODIFIED}
        self._interpolation = Interpolation(response, sorted(varied | {_SLIP} | (_BY_OIL if self._effects.follows_oil else set())))
        self._time, self._damage = math.nan, 0.0
        self._rates = self._spent = np.full(1, math.nan)
        self.remaining_life, self.medians = np.empty(0), np.empty((0, len(QUANTITIES)))
        self._drawn = prior_draws(len(response.fields))
        self.know(known)

    def know(self, known: Sequence[str]) -> None:
        """Take which fields are measured from now on (see the parameter)."""
        self._known = np.array([name in known for name in self.response.names], bool)
        self.use(self._drawn)

    def use(self, scores: np.ndarray) -> None:
        """Take equally probable draws of the uncertain fields, such as those of a posterior, shape (m, d), for all samples from now on."""
        self._drawn = scores
        self.scores = np.where(self._known, self.response.nominal, scores)
        self._basis = np.concatenate([self.response.own_basis[None], self.response.basis_of(self.scores)])
        nothing = [math.nan] * len(scores)
        self._rates, self._spent = (np.append(before[0], nothing) for before in (self._rates, self._spent))  # those of the level itself go on
        self._kept: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}  # changes by operating point, see `_changes`

    def adjust(self, remaining_life_memory: float) -> None:
        """Take another time constant of the mean damage rate [s] from now on."""
        self._memory = remaining_life_memory

    def estimate(self, block: np.ndarray) -> np.ndarray:
        """Return the bands of the samples that follow.

        Parameters
        ----------
        block : samples, shape (n,), see `bearing_sim.model.sample`.

        Returns
        -------
        by quantity (`QUANTITIES`) the values that 5 and 95 % lie below, shape (n, 4, 2); NaN at rest (slip) and where the operating point is
        outside of the response.
        """
        changes, wear = self._changes(block)
        own = np.zeros((len(block), 1, len(ANSWERS)))
        for answer in _ANSWERED:
            own[:, 0, answer] = block[ANSWERS[answer]]
        ends = transformed(own)
        ends = np.repeat(ends, len(_QUANTILES), axis=1)
        ends[:, :, _ANSWERED] += changes
        found = np.empty((len(block), len(QUANTITIES), len(_QUANTILES)))
        found[:, :3] = np.swapaxes(restored(ends)[:, :, _ANSWERED], 1, 2)
        remaining = self._remaining_lives(block, wear)
        self.remaining_life, found[:, 3] = remaining[:, 0], quantiles(remaining[:, 1:], _QUANTILES)
        self.medians = found[:, :, -1]
        return found[:, :, :-1]

    def _changes(self, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return the quantiles of the differences from the scene's own values on the scales of `transformed`, and the draws' rates of damage.

        They are those at the `cells` of the operating points; those of cells that come again are kept.  The quantiles are in the order of
        `_ANSWERED`, shape (n, 3, 3); the rates are factors of the level's own, shape (n, m).
        """
        load = np.hypot(block["load_y"], block["load_z"])
        conditions = np.stack([block["shaft_speed"], load, block["oil_temperature"], np.arctan2(block["load_z"], block["load_y"])], axis=1)
        there = cells(conditions, self.response.domain)
        keys = [row.tobytes() for row in there]
        new = {key: k for k, key in enumerate(keys) if key not in self._kept}
        if len(self._kept) + len(new) > _CELLS_KEPT:
            self._kept, new = {}, {key: k for k, key in enumerate(keys)}
        rows, names = list(new.values()), list(new)
        for begin in range(0, len(new), _AT_ONCE):
            chosen = there[rows[begin : begin + _AT_ONCE]]
            scaled = np.swapaxes(self._interpolation.coefficients(chosen) @ self._basis.T, 1, 2)
            add_slip_and_oil(scaled, chosen, self._effects)
            changes = scaled[:, 1:] - scaled[:, :1]
            wear = (-changes[:, :, _MODIFIED]).astype(np.float32)
            self._kept.update(zip(names[begin : begin + _AT_ONCE], zip(quantiles(changes[:, :, _ANSWERED], _QUANTILES), wear)))
        kept = [self._kept[key] for key in keys]
        return np.stack([edges for edges, _ in kept]), np.exp(np.stack([wear for _, wear in kept], dtype=float))

    def _remaining_lives(self, block: np.ndarray, factors: np.ndarray) -> np.ndarray:
        """Return the remaining life [h] of the level itself and of each draw: (1 - D)/(dD/dt) with dD/dt the fading mean of the damage rate.

        Damage is summed for each draw by its own rate at each operating point, as `Monitor` does for the level.  What was spent before the first
        sample is off by the factor of that sample.

        Parameters
        ----------
        block : samples, shape (n,).
        factors : of the rates of damage of the draws, shape (n, m).

        Returns
        -------
        shape (n, m + 1).
        """
        factors = np.concatenate([np.ones((len(block), 1)), factors], axis=1)
        rates = factors / (_HOUR * block["modified_rating_life"][:, None])
        spent, means = np.empty_like(rates), np.empty_like(rates)
        for k, (time, damage) in enumerate(zip(block["time"].tolist(), block["damage"].tolist())):
            elapsed, grown = time - self._time, damage - self._damage
            weight = 1.0 - math.exp(-elapsed / self._memory) if elapsed >= 0.0 else 1.0
            before = self._rates if math.isfinite(self._rates[0]) else rates[k, :1]
            mean = before + weight * (rates[k] - before)
            self._rates = means[k] = np.where(np.isfinite(mean), mean, mean[0] * factors[k])
            total = self._spent + grown * factors[k]
            self._spent = spent[k] = np.where(np.isfinite(total) & (grown >= 0.0), total, damage * factors[k])
            self._time, self._damage = time, damage
        left = np.clip(1.0 - spent, 0.0, 1.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(left > 0.0, left / (_HOUR * means), 0.0 * left)


def cells(conditions: np.ndarray, domain: Domain) -> np.ndarray:
    """Return operating points rounded to the middle of cells within which bands about what is computed hardly differ.

    Cells are 1 % of speed and load wide, 0.2 K of the oil temperature and half a degree of the load's direction.  Widths of bands follow speed and
    load by powers of about one, so that edges are off by a percent of the width or so, where a tenth is asked for.  A point within the domain of
    a response stays in it.

    Parameters
    ----------
    conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).
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


def quantiles(values: np.ndarray, probabilities: Sequence[float]) -> np.ndarray:
    """Return quantiles along the second axis, linear between the middles of the steps of the distribution.

    Parameters
    ----------
    values : equally probable, shape (n, m, ...).
    probabilities : of the k quantiles.

    Returns
    -------
    shape (n, k, ...); NaN where a value is.
    """
    ordered = np.sort(values, axis=1)
    places = np.clip(np.asarray(probabilities) * values.shape[1] - 0.5, 0.0, values.shape[1] - 1.0)
    low = np.minimum(places.astype(int), values.shape[1] - 2)
    fraction = (places - low).reshape(-1, *[1] * (values.ndim - 2))
    below, above = ordered[:, low], ordered[:, low + 1]
    with np.errstate(invalid="ignore"):
        found = np.where(above == below, below, below + fraction * (above - below))  # also where both are infinite
    return np.where(np.isnan(ordered[:, -1:]), math.nan, found)
