# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The response of a bearing: settled slip, lives, clearance and ring temperatures over the operating point and the uncertain fields of its scene.

At each of some hundred operating points the departures from the scene's own answers, over the width of their band there, are polynomials of
the fields; their coefficients and the logarithms of the widths are splines over the operating points.  A response is fitted once to settled
points of level ``steady`` and kept on disk (`bearing-sim table --bands`).  Evaluating it takes microseconds, so that thousands of values of
the uncertain fields can be tried at every sample of a live run.  What slip and oil do to lives is not fitted but computed
(`bearing_sim.watchers.estimation.lives`).

An uncertain field is counted by its standard-normal *score*: the value that a standard-normal number has the same probability to fall below
as the field has to fall below its value.  All scores are independent and alike, whatever the distributions of the fields.
"""

import hashlib
import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.kept import Damaged, packed, read_kept, unpacked, write_kept
from bearing_sim.files.limits import RESPONSE_FILE
from bearing_sim.levels.steady.table import common_period, mirror_axis, symmetric_parts
from bearing_sim.levels.steady.table_builder import FOLDER
from bearing_sim.model.params import pack
from bearing_sim.model.table_span import span_of
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import Range, number_at, ranges_of
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.splines import left_out, metric_of, metric_starts, searched, spline_functions, spline_weights

CONDITIONS = ("shaft_speed", "load", "oil_temperature", "load_angle")
"""Columns of conditions: [rad/s, N, K, rad]; the load counts by its magnitude."""

ANSWERS = (
    "cage_slip",
    "rating_life",
    "modified_rating_life",
    "running_clearance",
    "inner_ring_temperature",
    "outer_ring_temperature",
    "viscosity_ratio",
)
"""Columns of answers, by the names of the observables: [1, h, h, m, K, K, 1]; temperatures are NaN where the scene has no thermal network."""

PROBABILITIES = (0.05, 0.95)
"""Of lying below the ends of a band."""

VERSION = 7  # of the files
_FARTHEST = 4.5  # largest score; one draw in 300,000 lies beyond
_SLOWEST, _LIGHTEST = 0.03, 0.002  # of the largest speed and load: below, the response is that of these
_RIDGE, _PRODUCT_RIDGE = 1e-6, 1.0  # of polynomials of one field, and of two
_NARROWEST = np.array([1e-9, 1e-11, 1e-11, 1e-13, 1e-6, 1e-6, 1e-9])  # widths of bands on the scales of `transformed`, below which there is none
_RESOLVED = 1e-3  # of the width of a band; where less than that is left to fit at most operating points, it is the noise of the level
_CIRCLE = 0.6  # radius of the circle that stands for the angle, beside coordinates from -1 to 1
_SCALES = (0.5, 1.0, 2.0), (1.0, 2.0, 4.0), (0.35, 0.7, 1.4)  # of speed, load and temperature, from the best of which a search starts
_GOOD = 1e-3  # of the width of a band; where operating points left out are met to that no metric is searched for
_WIDEST = 50.0  # logarithm of a width that a spline may reach
_SMALL = 0.2  # of the width of a band; errors of smaller departures do not follow them (found by cross validation)
_NEIGHBOURS = 8  # operating points whose errors tell that between them (likewise)
SLIP_SCALE = 1e-3  # slip far above counts by its logarithm, far below as it is
_SLIP, _LIFE, _MODIFIED, _RATIO = (ANSWERS.index(name) for name in ("cage_slip", "rating_life", "modified_rating_life", "viscosity_ratio"))
_LOGARITHMIC = [_LIFE, _MODIFIED, _RATIO]
_SLIPS = np.concatenate([-np.geomspace(1.0, 1e-7, 2000), [0.0], np.geomspace(1e-7, 0.999, 4000), 1.0 + np.linspace(0.0, 0.0099, 200)])


def uncertain_ranges(scene: Scene) -> tuple[Range, ...]:
    """Return the ranges of the fields that a response varies: all of a scene's but those of its operating point, which is an input."""
    return tuple(one for one in ranges_of(scene) if not one.field.startswith("operating."))


class Domain(NamedTuple):
    """The operating points that a response was fitted to, all directions of the load among them.

    Attributes
    ----------
    speeds : least and largest magnitude of the shaft speed [rad/s].
    loads : least and largest radial load [N].
    temperatures : lowest and highest oil temperature [K].
    period : of the raceway's contour [rad]; 0 where the direction of the load changes nothing.
    mirror : azimuth of an axis of symmetry of the contour, about which a reverse rotation is a forward one [rad]; NaN where there is none.
    """

    speeds: tuple[float, float]
    loads: tuple[float, float]
    temperatures: tuple[float, float]
    period: float
    mirror: float

    @property
    def varies_in_temperature(self) -> bool:
        """Whether there is more than one oil temperature."""
        return self.temperatures[1] > self.temperatures[0]


def domain_of(scene: Scene, temperatures: tuple[float, float] | None = None) -> Domain:
    """Return the operating points that the response of a scene must answer for: those of its table (block ``table``).

    Parameters
    ----------
    scene : of any level.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    """
    span, parts = span_of(scene, temperatures), symmetric_parts(pack(scene))
    period, mirror = common_period(*parts), mirror_axis(*parts)
    return Domain(
        (_SLOWEST * span.maximum_speed, span.maximum_speed),
        (_LIGHTEST * span.maximum_load, span.maximum_load),
        (span.minimum_temperature, span.maximum_temperature),
        float(period),
        float(mirror),
    )


def coordinates(conditions: np.ndarray, domain: Domain) -> np.ndarray:
    """Return operating points as numbers in [-1, 1], in which the response is smooth; the angle that the contour repeats with as a point on a circle.

    Speed and load count by their logarithms.  Slower and lighter points than the domain's are taken as its ends.  What does not vary is left out.

    Parameters
    ----------
    conditions : columns `CONDITIONS`, shape (n, 4).
    domain : of the response.

    Returns
    -------
    shape (n, c), c from 2 to 5.
    """
    speed, load, temperature, angle = np.asarray(conditions, float).T
    found = []
    for values, ends in ((np.abs(speed), domain.speeds), (load, domain.loads)):
        low, high = np.log(ends)
        found.append(2.0 * (np.log(np.clip(values, *ends)) - low) / (high - low) - 1.0)
    if domain.varies_in_temperature:
        low, high = domain.temperatures
        found.append(2.0 * (temperature - low) / (high - low) - 1.0)
    if domain.period:
        if math.isfinite(domain.mirror):
            angle = np.where(speed < 0.0, 2.0 * domain.mirror - angle, angle)
        turned = 2.0 * math.pi * angle / domain.period
        found += [_CIRCLE * np.cos(turned), _CIRCLE * np.sin(turned)]
    return np.stack(found, axis=1)


def conditions_at(positions: np.ndarray, domain: Domain) -> np.ndarray:
    """Return operating points at positions in [0, 1], evenly spread in the coordinates of a response, shape (n, 4)."""
    positions = np.asarray(positions, float)
    found = np.empty_like(positions)
    for column, (low, high) in enumerate((domain.speeds, domain.loads)):
        found[:, column] = low * (high / low) ** positions[:, column]
    low, high = domain.temperatures
    found[:, 2] = low + positions[:, 2] * (high - low)
    found[:, 3] = positions[:, 3] * (domain.period or 0.0)
    return found


class Fields:
    """The uncertain fields of a scene: their values, their scores, and their positions in the ranges.

    Parameters
    ----------
    ranges : of the d fields.
    own : the scene's own values [SI], shape (d,).
    """

    def __init__(self, ranges: Sequence[Range], own: Sequence[float]):
        self.ranges, self.own = tuple(ranges), np.array(own, float)
        self._logarithmic = np.array([one.distribution == "log_uniform" for one in ranges], bool)
        self._low = np.array([math.log(one.low) if one.distribution == "log_uniform" else one.low for one in ranges])
        self._width = np.array([math.log(one.high / one.low) if one.distribution == "log_uniform" else one.high - one.low for one in ranges])
        self._is_triangular = np.array([one.distribution == "triangular" for one in ranges], bool)
        self._mode = np.array([_mode(one, value) for one, value in zip(ranges, own)])  # of its width

    def __len__(self) -> int:
        return len(self.ranges)

    def fractions_of(self, scores: np.ndarray) -> np.ndarray:
        """Return where in their ranges the fields are, 0 to 1 (a ``log_uniform`` one in its logarithm), for scores of shape (..., d)."""
        from scipy.special import ndtr

        probability = ndtr(np.clip(scores, -_FARTHEST, _FARTHEST))
        rising = np.sqrt(probability * self._mode)
        falling = 1.0 - np.sqrt((1.0 - probability) * (1.0 - self._mode))
        return np.where(self._is_triangular, np.where(probability < self._mode, rising, falling), probability)

    def values_of(self, scores: np.ndarray) -> np.ndarray:
        """Return the values of the fields [SI] for scores of shape (..., d)."""
        found = self._low + self._width * self.fractions_of(scores)
        return np.where(self._logarithmic, np.exp(np.where(self._logarithmic, found, 0.0)), found)

    def scores_of(self, values: np.ndarray) -> np.ndarray:
        """Return the scores of values [SI] of shape (..., d); one outside of its range has the largest or least score, +-4.5."""
        from scipy.special import ndtri

        values = np.asarray(values, float)
        counted = np.where(self._logarithmic, np.log(np.where(self._logarithmic, values, 1.0)), values)
        fraction = np.clip((counted - self._low) / self._width, 0.0, 1.0)
        rising = fraction**2 / np.where(self._mode > 0.0, self._mode, 1.0)
        falling = 1.0 - (1.0 - fraction) ** 2 / np.where(self._mode < 1.0, 1.0 - self._mode, 1.0)
        probability = np.where(self._is_triangular, np.where(fraction < self._mode, rising, falling), fraction)
        with np.errstate(divide="ignore"):
            return np.clip(ndtri(probability), -_FARTHEST, _FARTHEST)


def _mode(one: Range, own: float) -> float:
    """Return the peak of a triangular range as a fraction of its width (see `bearing_sim.scene.uncertainty.Range`)."""
    mode = one.mode if one.mode is not None else own if one.low <= own <= one.high else 0.5 * (one.low + one.high)
    return (mode - one.low) / (one.high - one.low)


def prior_draws(fields: int, count: int = 256, seed: int = 1, least: float = 1e-6) -> np.ndarray:
    """Return scores of fields of which nothing is measured, evenly spread, shape (count, fields).

    Parameters
    ----------
    fields : number of them.
    count : of draws, a power of two.
    seed : of the sequence.
    least : probability to lie beyond the farthest scores on either side.
    """
    from scipy.special import ndtri
    from scipy.stats import qmc  # half a second to import, which no run without bands spends

    uniform = qmc.Sobol(d=max(fields, 1), scramble=True, seed=np.random.default_rng(seed)).random_base2(count.bit_length() - 1)
    return ndtri(np.clip(uniform, least, 1.0 - least))[:, :fields]


def transformed(answers: np.ndarray) -> np.ndarray:
    """Return answers on scales on which fields and operating points add up: slip by `slip_scale`, lives and viscosity ratio by their logarithms.

    Parameters
    ----------
    answers : columns `ANSWERS`, shape (..., 7).
    """
    found = np.array(answers, float)
    found[..., _SLIP] = slip_scale(found[..., _SLIP])
    with np.errstate(divide="ignore", invalid="ignore"):
        found[..., _LOGARITHMIC] = np.log(found[..., _LOGARITHMIC])
    return found


def restored(scaled: np.ndarray) -> np.ndarray:
    """Return answers in their units again, the inverse of `transformed`."""
    found = np.array(scaled, float)
    found[..., _SLIP] = restored_slip(found[..., _SLIP])
    found[..., _LOGARITHMIC] = np.exp(found[..., _LOGARITHMIC])
    return found


def add_slip_and_oil(scaled: np.ndarray, conditions: np.ndarray, effects: SlipAndOil) -> None:
    """Add to the lives of a response what slip and oil do to them.

    Parameters
    ----------
    scaled : answers of a response on the scales of `transformed`, those of the scene's own values first, shape (n, m, 7); changed in place.
    conditions : columns `CONDITIONS`, shape (n, 4).
    effects : of the scene's bearing.
    """
    if effects.follows_slip:
        scaled[:, :, _LIFE] += effects.by_slip(conditions, restored_slip(scaled[:, :, _SLIP]))
    scaled[:, :, _MODIFIED] += _changes_of_modified_life(scaled, conditions, effects)


def _without_slip_and_oil(scaled: np.ndarray, conditions: np.ndarray, effects: SlipAndOil) -> np.ndarray:
    """Return answers without what `add_slip_and_oil` adds; the parameters are its."""
    found = scaled.copy()
    found[:, :, _LIFE] -= effects.by_slip(conditions, restored_slip(scaled[:, :, _SLIP]))
    found[:, :, _MODIFIED] -= _changes_of_modified_life(scaled, conditions, effects)
    return found


def _changes_of_modified_life(scaled: np.ndarray, conditions: np.ndarray, effects: SlipAndOil) -> np.ndarray:
    lives = scaled[:, :, _LIFE]
    return lives - lives[:, :1] + effects.by_oil(conditions, restored_slip(scaled[:, 0, _SLIP]), lives, scaled[:, :, _RATIO])


def restored_slip(scaled: np.ndarray) -> np.ndarray:
    """Return slip from `slip_scale`."""
    return np.interp(scaled, _SLIP_SCALES, _SLIPS)


def slip_scale(slip: np.ndarray) -> np.ndarray:
    """Return slip on a scale without ends.

    It is logarithmic from 0.1 % on, since what drives and brakes a cage are factors, and so is its distance from a stopped cage; it is linear
    about 0, where a cage may lead.
    """
    return np.arcsinh(slip / SLIP_SCALE) - np.log(1.01 - np.minimum(slip, 1.0099))


_SLIP_SCALES = slip_scale(_SLIPS)


class ResponseModel(NamedTuple):
    """The response of a bearing; see the module.

    Attributes
    ----------
    fields : of the d uncertain fields.
    domain : operating points that it answers for.
    centres : coordinates of the operating points that were solved for, shape (k, c).
    metrics : by which coordinates are multiplied (from the right) before their distances count for each of `ANSWERS`, shape (7, c, c).
    score_terms : degrees of the polynomials of the fields, the first of them a constant, int, shape (j, d).
    own_basis : these polynomials at the scene's own values, shape (j,).
    weights : of the functions of the operating point, for each of `ANSWERS`: of its own value, the logarithm of the width of its band, and the
        coefficients of the polynomials but the first over that width; shape (k + c + 1, 7, j + 1).
    errors : by cross validation, of departures from the scene's own values, root mean square on the scales of `transformed`, shape (7,).
    relative_errors : the same at each centre, over the size of the departures there (see `error_scales`), shape (k, 7).
    points : settled points that it was fitted to.
    seconds : that building it took.
    """

    fields: Fields
    domain: Domain
    centres: np.ndarray
    metrics: np.ndarray
    score_terms: np.ndarray
    own_basis: np.ndarray
    weights: np.ndarray
    errors: np.ndarray
    relative_errors: np.ndarray
    points: int
    seconds: float

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted paths of the uncertain fields, shape (d,)."""
        return tuple(one.field for one in self.fields.ranges)

    @property
    def nominal(self) -> np.ndarray:
        """Scores of the scene's own values, shape (d,)."""
        return self.fields.scores_of(self.fields.own)

    def outside(self, conditions: np.ndarray) -> np.ndarray:
        """Return whether operating points lie outside of what the response was fitted to, shape (n,).

        Speeds and loads near 0 do not count: the response there is that of the least ones.
        """
        speed, load, temperature, _ = np.asarray(conditions, float).T
        low, high = self.domain.temperatures
        inside = (np.abs(speed) <= self.domain.speeds[1]) & (load <= self.domain.loads[1]) & (temperature >= low) & (temperature <= high)
        if not math.isfinite(self.domain.mirror):
            inside &= speed >= 0.0
        return ~inside

    def respond(self, conditions: np.ndarray, scores: np.ndarray, effects: SlipAndOil) -> np.ndarray:
        """Return the answers at operating points, for each of several scores of the fields.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        scores : of the fields, shape (m, d).
        effects : of the same scene.

        Returns
        -------
        columns `ANSWERS` in their units, shape (n, m, 7); NaN at points outside of the response (`outside`).
        """
        scaled = self.respond_scaled(conditions, np.concatenate([self.own_basis[None], self.basis_of(scores)]))
        add_slip_and_oil(scaled, conditions, effects)
        return restored(scaled[:, 1:])

    def basis_of(self, scores: np.ndarray) -> np.ndarray:
        """Return the polynomials of the fields at scores of shape (m, d), shape (m, j); worth keeping while the scores stay."""
        return _basis(self.fields, self.score_terms, scores)

    def respond_scaled(self, conditions: np.ndarray, basis: np.ndarray) -> np.ndarray:
        """Return the answers on the scales of `transformed`, lives without what slip and oil do to them (`add_slip_and_oil`), shape (n, m, 7).

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        basis : `basis_of` scores, shape (m, j).
        """
        return np.swapaxes(self.condition_coefficients(conditions) @ basis.T, 1, 2)

    def condition_coefficients(self, conditions: np.ndarray) -> np.ndarray:
        """Return the coefficients of the polynomials of the fields (`basis_of`) at operating points, on the scales of `transformed`.

        What slip and oil do to lives is not in them.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).

        Returns
        -------
        for each of `ANSWERS`, shape (n, 7, j); NaN at points outside of the response.
        """
        return Interpolation(self, range(len(ANSWERS))).coefficients(conditions)

    def error_scales(self, conditions: np.ndarray, column: int) -> tuple[np.ndarray, np.ndarray]:
        """Return what departures from the scene's own answers are off by at operating points: in proportion to them, and at least.

        Errors grow with departures and differ between operating points: where slip changes steeply they are ten times those elsewhere.  The
        standard deviation of the error of a departure x is hypot(proportion x, least), on the scales of `transformed`.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        column : of the answer among `ANSWERS`.

        Returns
        -------
        proportions and least errors, each of shape (n,).
        """
        there = coordinates(conditions, self.domain) @ self.metrics[column]
        centres = self.centres @ self.metrics[column]
        distances = np.square(there[:, None] - centres).sum(axis=-1)
        near = np.argsort(distances, axis=1)[:, :_NEIGHBOURS]
        weights = 1.0 / (np.take_along_axis(distances, near, axis=1) + 1e-9)
        squares = np.square(self.relative_errors[near, column])
        proportions = np.sqrt((weights * squares).sum(axis=1) / weights.sum(axis=1))
        widths = np.exp(np.minimum(spline_functions(there, centres) @ self.weights[:, column, 1], _WIDEST))
        return proportions, proportions * _SMALL * widths

    def varied_answers(self) -> list[int]:
        """Return which of `ANSWERS` the fields change at all."""
        return np.flatnonzero(np.any(np.nan_to_num(self.weights[:, :, 2:]) != 0.0, axis=(0, 2))).tolist()


class Interpolation:
    """A response prepared for some of its answers, for those who ask often.

    Parameters
    ----------
    model : the response.
    answers : columns of `ANSWERS`.
    """

    def __init__(self, model: ResponseModel, answers: Sequence[int]):
        self._model, self._answers = model, list(answers)
        self._metrics = model.metrics[self._answers]
        self._centres = model.centres @ self._metrics
        self._weights = np.ascontiguousarray(np.moveaxis(model.weights[:, self._answers], 1, 0))

    def coefficients(self, conditions: np.ndarray) -> np.ndarray:
        """Return what `ResponseModel.condition_coefficients` does; zeros for all other answers."""
        model = self._model
        there = coordinates(conditions, model.domain) @ self._metrics
        found = np.moveaxis(spline_functions(there, self._centres) @ self._weights, 0, 1)
        departures = found[:, :, 2:] * np.exp(found[:, :, 1:2])
        coefficients = np.zeros((len(conditions), len(ANSWERS), found.shape[2] - 1))
        coefficients[:, self._answers, 0] = found[:, :, 0] - departures @ model.own_basis[1:]
        coefficients[:, self._answers, 1:] = departures
        coefficients[model.outside(conditions)] = math.nan
        return coefficients


def _score_terms(count: int) -> np.ndarray:
    """Return the degrees of the polynomials of ``count`` fields: a constant, each field, its square, and products of two; int, shape (j, count)."""
    each = np.eye(count, dtype=int)
    pairs = [one + other for one, other in itertools.combinations(each, 2)]
    return np.concatenate([np.zeros((1, count), int), each, 2 * each, np.array(pairs, int).reshape(-1, count)])


def fit_response(
    fields: Fields,
    domain: Domain,
    conditions: np.ndarray,
    scores: np.ndarray,
    answers: np.ndarray,
    effects: SlipAndOil,
    seconds: float = 0.0,
) -> ResponseModel:
    """Return the response fitted to settled points: the same m scores at each of k operating points.

    Parameters
    ----------
    fields, domain : of the scene.
    conditions : columns `CONDITIONS` of each point, those of one operating point in a row, shape (k m, 4).
    scores : of the fields at each point, shape (k m, d); the first at each operating point are those of the scene's own values.
    answers : columns `ANSWERS`, shape (k m, 7); an operating point at which one of the first four is NaN is left out.
    effects : what slip and oil do to the lives of the scene's bearing, which is not fitted.
    seconds : that the points took.

    Raises
    ------
    ValueError
        The scores differ between operating points, do not begin with the scene's own, or too few operating points have answers.
    """
    nodes = conditions[np.concatenate([[True], np.any(np.diff(conditions, axis=0) != 0.0, axis=1)])]
    drawn = scores.reshape(len(nodes), -1, len(fields))
    if not np.allclose(drawn, drawn[0]) or not np.allclose(drawn[0, 0], fields.scores_of(fields.own)):
        raise ValueError("expected the same scores at each operating point, the scene's own values first")
    scaled = transformed(answers).reshape(len(nodes), -1, len(ANSWERS))
    kept = np.isfinite(scaled[:, :, :4]).all(axis=(1, 2))
    centres = coordinates(nodes[kept], domain)
    if len(centres) < 4 * (centres.shape[1] + 1):
        raise ValueError(f"{len(centres)} of {len(nodes)} operating points have answers; expected {4 * (centres.shape[1] + 1)} or more")
    widths = _widths(np.nan_to_num(scaled[kept, 1:] - scaled[kept, :1]))
    fitted = _without_slip_and_oil(scaled[kept], nodes[kept], effects)
    departures = fitted[:, 1:] - fitted[:, :1]
    terms = _score_terms(len(fields))
    basis = _basis(fields, terms, drawn[0])
    is_product = np.count_nonzero(terms[1:], axis=1) > 1
    values = _node_values(np.nan_to_num(scaled[kept, 0]), np.nan_to_num(departures), widths, basis, is_product)
    change = basis[1:, 1:] - basis[0, 1:]
    metrics = _best_metrics(centres, domain, values, change, departures)
    weights = np.stack([spline_weights(centres @ metric, values[:, column]) for column, metric in enumerate(metrics)], axis=1)
    left = [
        _departures_left_out(centres @ metric, values[:, [column]], change, departures[:, :, [column]])[:, :, 0]
        for column, metric in enumerate(metrics)
    ]
    if np.isnan(scaled[kept][:, :, 4:]).any():
        weights[:, 4:6] = math.nan
    errors = np.sqrt(np.mean(np.square(left), axis=(1, 2)))
    sizes = np.hypot(np.nan_to_num(departures), _SMALL * np.exp(values[:, None, :, 1]))
    relative_errors = np.sqrt(np.mean(np.square(np.moveaxis(left, 0, -1) / sizes), axis=1))
    points = int(np.isfinite(scaled[:, :, 0]).sum())
    return ResponseModel(fields, domain, centres, metrics, terms, basis[0], weights, errors, relative_errors, points, seconds)


def _basis(fields: Fields, terms: np.ndarray, scores: np.ndarray) -> np.ndarray:
    """Return products of Legendre polynomials of unit variance of the fields, of these degrees, shape (m, j)."""
    positions = 2.0 * fields.fractions_of(scores) - 1.0
    table = np.stack([np.ones_like(positions), positions, (3.0 * positions * positions - 1.0) / 2.0], axis=-1) * np.sqrt([1.0, 3.0, 5.0])
    found = np.ones((len(scores), len(terms)))
    for column, degrees in enumerate(terms.T):
        found *= table[:, column, degrees]
    return found


def _widths(departures: np.ndarray) -> np.ndarray:
    """Return the widths of the bands of departures of shape (k, m, 7), shape (k, 7)."""
    low, high = np.quantile(departures, PROBABILITIES, axis=1)
    return high - low


def _node_values(own: np.ndarray, departures: np.ndarray, widths: np.ndarray, basis: np.ndarray, is_product: np.ndarray) -> np.ndarray:
    """Return at each operating point the own answers, the logarithms of widths, and coefficients over these, shape (k, 7, j + 1).

    Parameters
    ----------
    own : answers at the scene's own values, shape (k, 7).
    departures : from them, without what is not fitted, shape (k, m - 1, 7).
    widths : of the bands with what is not fitted, shape (k, 7).
    basis : polynomials at the m scores, shape (m, j).
    is_product : whether each polynomial but the first is of two fields, shape (j - 1,); these are held back by a ridge, so that there may be more
        of them than draws.
    """
    left = _widths(departures)
    departures = np.where(np.median(left - _RESOLVED * widths, axis=0) <= 0.0, 0.0, departures)
    widths = np.maximum(np.maximum(left, _RESOLVED * widths), _NARROWEST)
    change = basis[1:, 1:] - basis[0, 1:]
    inverse = np.linalg.solve(change.T @ change + np.diag(np.where(is_product, _PRODUCT_RIDGE, _RIDGE)), change.T)
    coefficients = np.einsum("jm,kmq->kqj", inverse, departures / widths[:, None])
    return np.concatenate([own[:, :, None], np.log(widths)[:, :, None], coefficients], axis=2)


def _departures_left_out(centres: np.ndarray, values: np.ndarray, change: np.ndarray, departures: np.ndarray) -> np.ndarray:
    """Return the errors of departures at operating points that were left out of the splines, shape (k, m - 1, a).

    Parameters
    ----------
    centres : scaled, shape (k, c).
    values : of `_node_values` for some answers, shape (k, a, j + 1).
    change : of the polynomials from the scene's own values, shape (m - 1, j - 1).
    departures : shape (k, m - 1, a).
    """
    found = values - left_out(centres, values.reshape(len(values), -1)).reshape(values.shape)
    coefficients = found[:, :, 2:] * np.exp(np.minimum(found[:, :, 1:2], _WIDEST))
    return np.swapaxes(coefficients @ change.T, 1, 2) - departures


def _best_metrics(centres: np.ndarray, domain: Domain, values: np.ndarray, change: np.ndarray, departures: np.ndarray) -> np.ndarray:
    """Return by which metric of the coordinates each answer is met best at operating points that were left out, shape (7, c, c).

    Slip changes steeply across lines on which the load follows speed and temperature, such as where rollers begin to slide.  A metric that lets
    distances along these lines count for less takes a sum of speed, load and temperature, not only each by its own scale.  The parameters are
    those of `_departures_left_out` for all answers.
    """
    starts, size = metric_starts(_SCALES[: 2 + domain.varies_in_temperature]), centres.shape[1]

    def missed(parameters: np.ndarray, one: Sequence[int]) -> np.ndarray:
        """Return the mean error of departures at operating points left out over the widths of bands there, each counted as 1 at most."""
        errors = _departures_left_out(centres @ metric_of(parameters, size), values[:, one], change, departures[:, :, one])
        return np.minimum(np.abs(errors) / np.exp(values[:, None, one, 1]), 1.0).mean(axis=(0, 1))

    every = list(range(values.shape[1]))
    at_starts, metrics = [missed(start, every) for start in starts], []
    for answer, best in enumerate(np.argmin(at_starts, axis=0)):
        start = starts[best]
        if at_starts[best][answer] > _GOOD:
            start = searched(start, lambda parameters: missed(parameters, [answer])[0])
        metrics.append(metric_of(start, size))
    return np.array(metrics)


def response_digest(scene: Scene) -> str:
    """Return a hash of what a response depends on: bearing, mounting, oil, heat and life of the scene, ranges, operating points, this program."""
    return _digest(sources_hash(), scene)


def _digest(code: str, scene: Scene) -> str:
    return digest_of(code, scene.bearing, scene.mounting, scene.lubricant, scene.heat, scene.life, uncertain_ranges(scene), domain_of(scene), VERSION)


def digest_of(code: str, *parts: object) -> str:
    """Return a hash of the code and of all else that something kept depends on."""
    return hashlib.sha256("\n".join([code, *map(repr, parts)]).encode()).hexdigest()[:24]


def response_path(scene: Scene) -> Path:
    """Return where the response of a scene is kept: among the tables of operating points."""
    return FOLDER / f"{response_digest(scene)}.bands.npz"


def bundled_path(scene: Scene) -> Path:
    """Return where the package has the response of a bundled scene; only `test/bundle_response.py` writes there.

    Unlike the name of `response_path` this one does not depend on the version of the compiler.
    """
    return _BUNDLED / f"{_digest(sources_hash(with_compiler=False), scene)}.bands.npz"


_BUNDLED = Path(__file__).resolve().parents[2] / "scene" / "scenes"
_ARRAYS = ("centres", "metrics", "score_terms", "own_basis", "weights", "errors", "relative_errors")


def write_response(path: Path, model: ResponseModel) -> None:
    """Write a response: a reader finds the old file or the new one, never a part.  Raises OSError, also if another process is writing it."""
    written = {
        "ranges": [asdict(one) for one in model.fields.ranges],
        "domain": model.domain._asdict(),
        "points": model.points,
        "seconds": model.seconds,
    }
    arrays = {name: getattr(model, name) for name in _ARRAYS}
    write_kept(path, packed({"written": np.frombuffer(json.dumps(written).encode(), np.uint8), "own": model.fields.own, **arrays}))


def read_response(path: Path) -> ResponseModel | None:
    """Return a response from disk, or None where there is none, or none that is whole."""
    return read_kept(path, RESPONSE_FILE, _response)


def _response(data: bytes) -> ResponseModel:
    file = unpacked(data, RESPONSE_FILE)
    written: Mapping = json.loads(file["written"].tobytes())
    fields = Fields([Range(**one) for one in written["ranges"]], file["own"])
    domain = Domain(*(tuple(value) if isinstance(value, list) else value for value in written["domain"].values()))
    arrays = {name: file[name] for name in _ARRAYS}
    found = ResponseModel(fields, domain, **arrays, points=int(written["points"]), seconds=float(written["seconds"]))
    if not _fits_together(found):
        raise Damaged("its arrays do not fit together")
    return found


def _fits_together(model: ResponseModel) -> bool:
    """Return whether the arrays of a response have the shapes that belong to each other, and numbers where each answer needs one."""
    (centres, coordinate_count), term_count, answers = model.centres.shape, len(model.score_terms), len(ANSWERS)
    shapes = {
        "metrics": (answers, coordinate_count, coordinate_count),
        "score_terms": (term_count, len(model.fields)),
        "own_basis": (term_count,),
        "weights": (centres + coordinate_count + 1, answers, term_count + 1),
        "errors": (answers,),
        "relative_errors": (centres, answers),
    }
    if any(getattr(model, name).shape != shape for name, shape in shapes.items()) or model.fields.own.shape != (len(model.fields),):
        return False
    finite = [0, 1, 2, 3, _RATIO]
    numbers = (model.centres, model.metrics, model.own_basis, model.weights[:, finite], model.relative_errors[:, finite], model.fields.own)
    return bool(np.array_equal(model.score_terms, _score_terms(len(model.fields)))) and all(np.isfinite(each).all() for each in numbers)


def kept_response(scene: Scene) -> ResponseModel | None:
    """Return the response of a scene that is on disk or comes with the package, or None: `bearing-sim table SCENE --bands` builds it."""
    belonging = repr((uncertain_ranges(scene), domain_of(scene)))
    found = filter(None, (read_response(path_of(scene)) for path_of in (response_path, bundled_path)))
    return next((each for each in found if repr((each.fields.ranges, each.domain)) == belonging), None)


def scene_fields(scene: Scene) -> Fields:
    """Return the uncertain fields of a scene."""
    ranges = uncertain_ranges(scene)
    return Fields(ranges, [number_at(scene, one.field) for one in ranges])
