# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The response of a bearing: settled slip, lives, clearance and ring temperatures over the operating point and the uncertain fields of its scene.

At each of some hundred operating points the departures from the scene's own answers, over the width of their band there, are polynomials of
the fields; their coefficients and the logarithms of the widths are splines over the operating points.  A response is fitted once to settled
points of level ``steady`` and kept on disk (`bearing-sim table --bands`).  Evaluating it takes microseconds, so that thousands of values of
the uncertain fields can be tried at every sample of a live run.

An uncertain field is counted by its standard-normal *score*: the value that a standard-normal number has the same probability to fall below
as the field has to fall below its value.  All scores are independent and alike, whatever the distributions of the fields.
"""

import hashlib
import io
import itertools
import json
import math
import os
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, ndtri

from bearing_sim.files.limits import RESPONSE_FILE
from bearing_sim.files.reading import read_bytes
from bearing_sim.levels.steady.table import contour_period, mirror_axis
from bearing_sim.levels.steady.table_builder import FOLDER, span_of
from bearing_sim.model.params import pack
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import Range, ranges_of, value_at

CONDITIONS = ("shaft_speed", "load", "oil_temperature", "load_angle")
"""Columns of conditions: [rad/s, N, K, rad]; the load counts by its magnitude."""

ANSWERS = ("cage_slip", "rating_life", "modified_rating_life", "running_clearance", "inner_ring_temperature", "outer_ring_temperature")
"""Columns of answers, by the names of the observables: [1, h, h, m, K, K]; temperatures are NaN where the scene has no thermal network."""

PROBABILITIES = (0.05, 0.95)
"""Of lying below the ends of a band."""

VERSION = 4  # of the files
_FARTHEST = 4.5  # largest score; one draw in 300,000 lies beyond
_SLOWEST, _LIGHTEST = 0.03, 0.002  # of the largest speed and load: below, the response is that of these
_RIDGE, _PRODUCT_RIDGE = 1e-6, 1.0  # of polynomials of one field, and of two
_NARROWEST = np.array([1e-9, 1e-11, 1e-11, 1e-13, 1e-6, 1e-6])  # widths of bands on the scales of `transformed`, below which there is none
_CIRCLE = 0.6  # radius of the circle that stands for the angle, beside coordinates from -1 to 1
_SPEED_SCALES, _LOAD_SCALES, _TEMPERATURE_SCALES = (0.5, 1.0, 2.0), (1.0, 2.0, 4.0), (0.35, 0.7, 1.4)  # that are tried
_WIDEST = 50.0  # logarithm of a width that a spline may reach
_SMALL = 0.2  # of the width of a band; errors of smaller departures do not follow them (found by cross validation)
_NEIGHBOURS = 8  # operating points whose errors tell that between them (likewise)
SLIP_SCALE = 1e-3  # slip far above counts by its logarithm, far below as it is
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


def domain_of(scene: Scene) -> Domain:
    """Return the operating points that the response of a scene must answer for: those of its table (block ``table``)."""
    span, contour = span_of(scene), pack(scene).raceways.contour
    period, mirror = contour_period(contour), mirror_axis(contour)
    return Domain(
        (_SLOWEST * span.maximum_speed, span.maximum_speed),
        (_LIGHTEST * span.maximum_load, span.maximum_load),
        (span.minimum_temperature, span.maximum_temperature),
        float(period),
        float(mirror),
    )


def coordinates(conditions: np.ndarray, domain: Domain) -> np.ndarray:
    """Return operating points as numbers in [-1, 1], in which the response is smooth, and the angle that the contour repeats with [rad].

    Speed and load count by their logarithms.  Slower and lighter points than the domain's are taken as its ends.

    Parameters
    ----------
    conditions : columns `CONDITIONS`, shape (n, 4).
    domain : of the response.

    Returns
    -------
    shape (n, 4).
    """
    speed, load, temperature, angle = np.asarray(conditions, float).T
    if math.isfinite(domain.mirror):
        angle = np.where(speed < 0.0, 2.0 * domain.mirror - angle, angle)
    found = np.empty((len(speed), 4))
    for column, (values, ends) in enumerate(((np.abs(speed), domain.speeds), (load, domain.loads))):
        low, high = np.log(ends)
        found[:, column] = 2.0 * (np.log(np.clip(values, *ends)) - low) / (high - low) - 1.0
    low, high = domain.temperatures
    found[:, 2] = 2.0 * (temperature - low) / (high - low) - 1.0 if high > low else 0.0
    found[:, 3] = 2.0 * math.pi * angle / domain.period if domain.period else 0.0
    return found


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
        self._mode = np.array([_mode(one, value) for one, value in zip(ranges, own)])  # of its width; NaN where it is not triangular

    def __len__(self) -> int:
        return len(self.ranges)

    def fractions_of(self, scores: np.ndarray) -> np.ndarray:
        """Return where in their ranges the fields are, 0 to 1 (a ``log_uniform`` one in its logarithm), for scores of shape (..., d)."""
        probability = ndtr(np.clip(scores, -_FARTHEST, _FARTHEST))
        mode = np.where(np.isnan(self._mode), 0.5, self._mode)
        rising = np.sqrt(probability * mode)
        falling = 1.0 - np.sqrt((1.0 - probability) * (1.0 - mode))
        return np.where(np.isnan(self._mode), probability, np.where(probability < mode, rising, falling))

    def values_of(self, scores: np.ndarray) -> np.ndarray:
        """Return the values of the fields [SI] for scores of shape (..., d)."""
        found = self._low + self._width * self.fractions_of(scores)
        return np.where(self._logarithmic, np.exp(np.where(self._logarithmic, found, 0.0)), found)

    def scores_of(self, values: np.ndarray) -> np.ndarray:
        """Return the scores of values [SI] of shape (..., d); one outside of its range has the largest or least score, +-4.5."""
        values = np.asarray(values, float)
        counted = np.where(self._logarithmic, np.log(np.where(self._logarithmic, values, 1.0)), values)
        fraction = np.clip((counted - self._low) / self._width, 0.0, 1.0)
        mode = np.where(np.isnan(self._mode), 0.5, self._mode)
        rising = fraction**2 / np.where(mode > 0.0, mode, 1.0)
        falling = 1.0 - (1.0 - fraction) ** 2 / np.where(mode < 1.0, 1.0 - mode, 1.0)
        probability = np.where(np.isnan(self._mode), fraction, np.where(fraction < mode, rising, falling))
        with np.errstate(divide="ignore"):
            return np.clip(ndtri(probability), -_FARTHEST, _FARTHEST)


def _mode(one: Range, own: float) -> float:
    """Return the peak of a triangular range as a fraction of its width (see `bearing_sim.scene.uncertainty.Range`); NaN for the others."""
    if one.distribution != "triangular":
        return math.nan
    mode = one.mode if one.mode is not None else own if one.low <= own <= one.high else 0.5 * (one.low + one.high)
    return (mode - one.low) / (one.high - one.low)


def transformed(answers: np.ndarray) -> np.ndarray:
    """Return answers on scales on which fields and operating points add up: lives by their logarithms, slip by `slip_scale`.

    Parameters
    ----------
    answers : columns `ANSWERS`, shape (..., 6).
    """
    found = np.array(answers, float)
    found[..., 0] = slip_scale(found[..., 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        found[..., 1:3] = np.log(found[..., 1:3])
    return found


def restored(scaled: np.ndarray) -> np.ndarray:
    """Return answers in their units again, the inverse of `transformed`."""
    found = np.array(scaled, float)
    found[..., 0] = _restored_slip(found[..., 0])
    found[..., 1:3] = np.exp(found[..., 1:3])
    return found


def _restored_slip(scaled: np.ndarray) -> np.ndarray:
    return np.interp(scaled, _SLIP_SCALES, _SLIPS)


def slip_scale(slip: np.ndarray) -> np.ndarray:
    """Return slip on a scale without ends.

    It is logarithmic from 0.1 % on, since what drives and brakes a cage are factors, and so is its distance from a stopped cage; it is linear
    about 0, where a cage may lead.
    """
    return np.arcsinh(slip / SLIP_SCALE) - np.log(1.01 - np.minimum(slip, 1.0099))


_SLIP_SCALES = slip_scale(_SLIPS)


class LivesBySlip(NamedTuple):
    """How lives follow slip while all else stays: a cage that lags presses its rollers outwards by less.

    The logarithm of a life is taken as a parabola of the square of the cage's speed over that without slip, to which centrifugal forces are
    proportional.  Both coefficients, over the square of the shaft speed and the inverse of the load, are interpolated linearly on a grid.

    Attributes
    ----------
    values : on knots evenly spread in the coordinates of the response, for rating life and modified rating life, shape
        (speeds, loads, temperatures, angles, 2, 2).
    exponents : of what coefficients are over, by the first two coordinates.
    """

    values: np.ndarray
    exponents: tuple[float, float]

    def coefficients(self, there: np.ndarray) -> np.ndarray:
        """Return the factors of (u - 1) and (u - 1)^2, with u = (1 - slip)^2, for both lives at `coordinates`, shape (n, 2, 2)."""
        lowest, fractions = [], []
        for column in range(3):
            last = self.values.shape[column] - 1
            position = np.clip(0.5 * (there[:, column] + 1.0), 0.0, 1.0) * last
            lowest.append(np.minimum(position.astype(int), max(last - 1, 0)))
            fractions.append(position - lowest[-1])
        angles = self.values.shape[3]
        position = np.mod(there[:, 3] / (2.0 * math.pi), 1.0) * angles
        lowest.append(position.astype(int))
        fractions.append(position - lowest[-1])
        found = np.zeros((len(there), 2, 2))
        for corner in itertools.product((0, 1), repeat=4):
            if any(side and size == 1 for side, size in zip(corner, self.values.shape)):
                continue
            weight = math.prod(fraction if side else 1.0 - fraction for side, fraction in zip(corner, fractions))
            places = tuple((low + side) % size for low, side, size in zip(lowest, corner, self.values.shape))
            found += np.asarray(weight)[:, None, None] * self.values[places]
        return found * np.exp(there[:, :2] @ self.exponents)[:, None, None]


class ResponseModel(NamedTuple):
    """The response of a bearing; see the module.

    Attributes
    ----------
    fields : of the d uncertain fields.
    domain : operating points that it answers for.
    centres : coordinates of the operating points that were solved for, shape (k, c).
    scales : by which coordinates count for each of `ANSWERS`, shape (6, c).
    score_terms : degrees of the polynomials of the fields, the first of them a constant, int, shape (j, d).
    own_basis : these polynomials at the scene's own values, shape (j,).
    weights : of the functions of the operating point, for each of `ANSWERS`: of its own value, the logarithm of the width of its band, and the
        coefficients of the polynomials but the first over that width; shape (k + c + 1, 6, j + 1).
    lives_by_slip : what slip does to lives, which is not in the polynomials.
    errors : by cross validation, of departures from the scene's own values, root mean square on the scales of `transformed`, shape (6,).
    relative_errors : the same at each centre, over the size of the departures there (see `error_scales`), shape (k, 6).
    points : settled points that it was fitted to.
    seconds : that building it took.
    """

    fields: Fields
    domain: Domain
    centres: np.ndarray
    scales: np.ndarray
    score_terms: np.ndarray
    own_basis: np.ndarray
    weights: np.ndarray
    lives_by_slip: LivesBySlip
    errors: np.ndarray
    relative_errors: np.ndarray
    points: int
    seconds: float

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted paths of the uncertain fields, shape (d,)."""
        return tuple(one.field for one in self.fields.ranges)

    @property
    def ranges(self) -> tuple[Range, ...]:
        """Ranges of the uncertain fields."""
        return self.fields.ranges

    @property
    def nominal(self) -> np.ndarray:
        """Scores of the scene's own values, shape (d,)."""
        return self.fields.scores_of(self.fields.own)

    def scores_of(self, values: np.ndarray) -> np.ndarray:
        """Return the scores of values [SI] of the fields, shape (..., d)."""
        return self.fields.scores_of(values)

    def values_of(self, scores: np.ndarray) -> np.ndarray:
        """Return the values of the fields [SI] for scores, shape (..., d)."""
        return self.fields.values_of(scores)

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

    def respond(self, conditions: np.ndarray, scores: np.ndarray) -> np.ndarray:
        """Return the answers at operating points, for each of several scores of the fields.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        scores : of the fields, shape (m, d).

        Returns
        -------
        columns `ANSWERS` in their units, shape (n, m, 6); NaN at points outside of the response (`outside`).
        """
        return restored(self.respond_scaled(conditions, self.basis_of(scores)))

    def basis_of(self, scores: np.ndarray) -> np.ndarray:
        """Return the polynomials of the fields at scores of shape (m, d), shape (m, j); worth keeping while the scores stay."""
        return _basis(self.fields, self.score_terms, scores)

    def respond_scaled(self, conditions: np.ndarray, basis: np.ndarray) -> np.ndarray:
        """Return the answers on the scales of `transformed`, shape (n, m, 6).

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        basis : `basis_of` scores, shape (m, j).
        """
        conditions = np.asarray(conditions, float)
        coefficients = self.condition_coefficients(conditions)
        found = np.swapaxes(coefficients @ basis.T, 1, 2)
        own = coefficients[:, 0] @ self.own_basis
        slips = _restored_slip(np.concatenate([own[:, None], found[:, :, 0]], axis=1))
        found[:, :, 1:3] += _by_slip(slips[:, 1:], slips[:, :1], self.lives_by_slip.coefficients(coordinates(conditions, self.domain)))
        return found

    def condition_coefficients(self, conditions: np.ndarray) -> np.ndarray:
        """Return the coefficients of the polynomials of the fields (`basis_of`) at operating points, on the scales of `transformed`.

        What slip does to lives is not in them.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).

        Returns
        -------
        for each of `ANSWERS`, shape (n, 6, j); NaN at points outside of the response.
        """
        conditions = np.asarray(conditions, float)
        there = _embedded(coordinates(conditions, self.domain), self.domain)
        found = np.empty((len(there), *self.weights.shape[1:]))
        for scale in np.unique(self.scales, axis=0):
            alike = np.flatnonzero((self.scales == scale).all(axis=1))
            weights = self.weights[:, alike].reshape(len(self.weights), -1)
            found[:, alike] = (_functions(there * scale, self.centres * scale) @ weights).reshape(len(there), len(alike), -1)
        departures = found[:, :, 2:] * np.exp(found[:, :, 1:2])
        coefficients = np.concatenate([found[:, :, :1] - departures @ self.own_basis[1:, None], departures], axis=2)
        coefficients[self.outside(conditions)] = math.nan
        return coefficients

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
        there = _embedded(coordinates(np.asarray(conditions, float), self.domain), self.domain) * self.scales[column]
        centres = self.centres * self.scales[column]
        distances = np.square(there[:, None] - centres).sum(axis=-1)
        near = np.argsort(distances, axis=1)[:, :_NEIGHBOURS]
        weights = 1.0 / (np.take_along_axis(distances, near, axis=1) + 1e-9)
        squares = np.square(self.relative_errors[near, column])
        proportions = np.sqrt((weights * squares).sum(axis=1) / weights.sum(axis=1))
        widths = np.exp(np.minimum(_functions(there, centres) @ self.weights[:, column, 1], _WIDEST))
        return proportions, proportions * _SMALL * widths


def _by_slip(slip: np.ndarray, own: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Return by how much the logarithms of both lives differ from those at the own slip, shape (n, m, 2); see `LivesBySlip`."""
    there, before = np.square(1.0 - slip) - 1.0, np.square(1.0 - own) - 1.0
    powers = np.stack([there - before, np.square(there) - np.square(before)], axis=-1)
    return powers @ np.swapaxes(coefficients, 1, 2)


def _embedded(there: np.ndarray, domain: Domain) -> np.ndarray:
    """Return coordinates with the angle as a point on a circle, without those that do not vary, shape (n, c)."""
    columns = [there[:, 0], there[:, 1]]
    if domain.temperatures[1] > domain.temperatures[0]:
        columns.append(there[:, 2])
    if domain.period:
        columns += [_CIRCLE * np.cos(there[:, 3]), _CIRCLE * np.sin(there[:, 3])]
    return np.stack(columns, axis=1)


def _functions(there: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Return the functions of the operating point: thin-plate splines about the centres (J. Duchon 1977), and planes; shape (n, k + c + 1)."""
    square = np.sum(np.square(there), axis=1)[:, None] + np.sum(np.square(centres), axis=1) - 2.0 * there @ centres.T
    square = np.maximum(square, 1e-30)
    return np.concatenate([0.5 * square * np.log(square), np.ones((len(there), 1)), there], axis=1)


def _spline_matrix(centres: np.ndarray) -> np.ndarray:
    """Return the matrix of the splines through values at centres, shape (k + c + 1, k + c + 1)."""
    square = _functions(centres, centres)
    planes = square[:, len(centres) :]
    return np.block([[square[:, : len(centres)], planes], [planes.T, np.zeros((planes.shape[1],) * 2)]])


def _spline_weights(centres: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the weights of `_functions` that pass through values at the centres, shapes (k, v) and (k + c + 1, v)."""
    padded = np.concatenate([values, np.zeros((centres.shape[1] + 1, values.shape[1]))])
    return np.linalg.solve(_spline_matrix(centres), padded)


def _left_out(centres: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return by how much the spline through all centres but one misses the values there, shape (k, v).

    S. Rippa, Adv. Comput. Math. 11 (1999) 193: the weight over the diagonal of the inverse.
    """
    inverse = np.linalg.inv(_spline_matrix(centres))[: len(centres), : len(centres)]
    return inverse @ values / np.diagonal(inverse)[:, None]


def _legendre(positions: np.ndarray, degree: int) -> np.ndarray:
    """Return Legendre polynomials of unit variance up to a degree, shape (*positions.shape, degree + 1)."""
    found = np.empty((*positions.shape, degree + 1))
    found[..., 0] = 1.0
    if degree:
        found[..., 1] = positions
    for k in range(1, degree):
        found[..., k + 1] = ((2 * k + 1) * positions * found[..., k] - k * found[..., k - 1]) / (k + 1)
    return found * np.sqrt(2.0 * np.arange(degree + 1) + 1.0)


def _products(table: np.ndarray, terms: np.ndarray) -> np.ndarray:
    """Return products over columns of polynomials, shape (n, terms), from polynomials of shape (n, columns, degrees)."""
    found = np.ones((len(table), len(terms)))
    for column in range(terms.shape[1]):
        found *= table[:, column, terms[:, column]]
    return found


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
    seconds: float = 0.0,
    lives_by_slip: LivesBySlip | None = None,
) -> ResponseModel:
    """Return the response fitted to settled points: the same m scores at each of k operating points.

    Parameters
    ----------
    fields, domain : of the scene.
    conditions : columns `CONDITIONS` of each point, those of one operating point in a row, shape (k m, 4).
    scores : of the fields at each point, shape (k m, d); the first at each operating point are those of the scene's own values.
    answers : columns `ANSWERS`, shape (k m, 6); an operating point at which one of the first four is NaN is left out.
    seconds : that the points took.
    lives_by_slip : what is known about lives by slip; None: nothing, it is left to the polynomials.

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
    there = coordinates(nodes[kept], domain)
    centres = _embedded(there, domain)
    if len(centres) < 4 * (centres.shape[1] + 1):
        raise ValueError(f"{len(centres)} of {len(nodes)} operating points have answers; expected {4 * (centres.shape[1] + 1)} or more")
    lives_by_slip = LivesBySlip(np.zeros((1, 1, 1, 1, 2, 2)), (0.0, 0.0)) if lives_by_slip is None else lives_by_slip
    departures = scaled[kept, 1:] - scaled[kept, :1]
    slips = answers.reshape(scaled.shape)[kept, :, 0]
    departures[:, :, 1:3] -= _by_slip(slips[:, 1:], slips[:, :1], lives_by_slip.coefficients(there))
    terms = _score_terms(len(fields))
    basis = _basis(fields, terms, drawn[0])
    is_product = np.count_nonzero(terms[1:], axis=1) > 1
    values = _node_values(np.nan_to_num(scaled[kept, 0]), np.nan_to_num(departures), basis, is_product)
    change = basis[1:, 1:] - basis[0, 1:]
    scales = _best_scales(centres, domain, values, change, departures)
    weights = np.stack([_spline_weights(centres * scale, values[:, column]) for column, scale in enumerate(scales)], axis=1)
    left = [
        _departures_left_out(centres * scale, values[:, [column]], change, departures[:, :, [column]])[:, :, 0] for column, scale in enumerate(scales)
    ]
    if np.isnan(scaled[kept][:, :, 4:]).any():
        weights[:, 4:] = math.nan
    errors = np.sqrt(np.mean(np.square(left), axis=(1, 2)))
    sizes = np.hypot(np.nan_to_num(departures), _SMALL * np.exp(values[:, None, :, 1]))
    relative_errors = np.sqrt(np.mean(np.square(np.moveaxis(left, 0, -1) / sizes), axis=1))
    points = int(np.isfinite(scaled[:, :, 0]).sum())
    return ResponseModel(fields, domain, centres, scales, terms, basis[0], weights, lives_by_slip, errors, relative_errors, points, seconds)


def _basis(fields: Fields, terms: np.ndarray, scores: np.ndarray) -> np.ndarray:
    return _products(_legendre(2.0 * fields.fractions_of(scores) - 1.0, 2), terms)


def _node_values(own: np.ndarray, departures: np.ndarray, basis: np.ndarray, is_product: np.ndarray) -> np.ndarray:
    """Return at each operating point the own answers, the logarithms of widths, and coefficients over these, shape (k, 6, j + 1).

    Parameters
    ----------
    own : answers at the scene's own values, shape (k, 6).
    departures : from them, shape (k, m - 1, 6).
    basis : polynomials at the m scores, shape (m, j).
    is_product : whether each polynomial but the first is of two fields, shape (j - 1,); these are held back by a ridge, so that there may be more
        of them than draws.
    """
    low, high = np.quantile(departures, PROBABILITIES, axis=1)
    widths = np.maximum(high - low, _NARROWEST)
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
    found = values - _left_out(centres, values.reshape(len(values), -1)).reshape(values.shape)
    return np.einsum("mj,kaj->kma", change, found[:, :, 2:] * np.exp(np.minimum(found[:, :, 1:2], _WIDEST))) - departures


def _best_scales(centres: np.ndarray, domain: Domain, values: np.ndarray, change: np.ndarray, departures: np.ndarray) -> np.ndarray:
    """Return by which scales of the coordinates each answer is met best at operating points that were left out, shape (6, c)."""
    warm = domain.temperatures[1] > domain.temperatures[0]
    axes = [_SPEED_SCALES, _LOAD_SCALES, *[_TEMPERATURE_SCALES] * warm]
    best, scales = np.full(len(ANSWERS), math.inf), np.ones((len(ANSWERS), centres.shape[1]))
    widths = np.exp(values[:, None, :, 1])
    for chosen in itertools.product(*axes):
        scale = np.array([*chosen, *[1.0] * (centres.shape[1] - len(chosen))])
        errors = np.abs(_departures_left_out(centres * scale, values, change, departures)) / widths
        missed = np.minimum(errors, 1.0).mean(axis=(0, 1))
        better = missed < best
        best[better], scales[better] = missed[better], scale
    return scales


def response_digest(scene: Scene) -> str:
    """Return a hash of what a response depends on: bearing, mounting, oil, heat and life of the scene, ranges, operating points, this program."""
    parts = (scene.bearing, scene.mounting, scene.lubricant, scene.heat, scene.life, uncertain_ranges(scene), domain_of(scene), VERSION)
    return hashlib.sha256("\n".join([sources_hash(), *map(repr, parts)]).encode()).hexdigest()[:24]


def response_path(scene: Scene) -> Path:
    """Return where the response of a scene is kept: among the tables of operating points."""
    return FOLDER / f"{response_digest(scene)}.bands.npz"


_ARRAYS = ("centres", "scales", "score_terms", "own_basis", "weights", "errors", "relative_errors")


def write_response(path: Path, model: ResponseModel) -> None:
    """Write a response atomically: a reader finds the old file or the new one, never a part."""
    written = {
        "ranges": [asdict(one) for one in model.fields.ranges],
        "domain": model.domain._asdict(),
        "exponents": model.lives_by_slip.exponents,
        "points": model.points,
        "seconds": model.seconds,
    }
    arrays = {name: getattr(model, name) for name in _ARRAYS} | {"lives_by_slip": model.lives_by_slip.values}
    buffer = io.BytesIO()
    np.savez_compressed(buffer, written=np.frombuffer(json.dumps(written).encode(), np.uint8), own=model.fields.own, **arrays)
    data = buffer.getvalue()
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, prefix=path.stem, delete=False) as file:
        file.write(data + hashlib.sha256(data).digest())
    os.replace(file.name, path)


def read_response(path: Path) -> ResponseModel | None:
    """Return a response from disk, or None where there is none, or none that is whole."""
    try:
        data = read_bytes(path, RESPONSE_FILE)
        if hashlib.sha256(data[:-32]).digest() != data[-32:]:
            return None
        with zipfile.ZipFile(io.BytesIO(data[:-32])) as archive:
            RESPONSE_FILE.check(sum(member.file_size for member in archive.infolist()), str(path))
        with np.load(io.BytesIO(data[:-32]), allow_pickle=False) as file:
            written: Mapping = json.loads(file["written"].tobytes())
            fields = Fields([Range(**one) for one in written["ranges"]], file["own"])
            domain = Domain(*(tuple(value) if isinstance(value, list) else value for value in written["domain"].values()))
            arrays = {name: file[name] for name in _ARRAYS}
            lives = LivesBySlip(file["lives_by_slip"], tuple(map(float, written["exponents"])))
            found = ResponseModel(fields, domain, **arrays, lives_by_slip=lives, points=int(written["points"]), seconds=float(written["seconds"]))
            return found if _fits_together(found) else None
    except Exception:  # whatever a broken file makes its reader raise, the response is built again
        return None


def _fits_together(model: ResponseModel) -> bool:
    """Return whether the arrays of a response have the shapes that belong to each other, and numbers where each answer needs one."""
    (centres, coordinate_count), term_count, answers = model.centres.shape, len(model.score_terms), len(ANSWERS)
    shapes = {
        "scales": (answers, coordinate_count),
        "score_terms": (term_count, len(model.fields)),
        "own_basis": (term_count,),
        "weights": (centres + coordinate_count + 1, answers, term_count + 1),
        "errors": (answers,),
        "relative_errors": (centres, answers),
    }
    if any(getattr(model, name).shape != shape for name, shape in shapes.items()) or model.fields.own.shape != (len(model.fields),):
        return False
    lives = model.lives_by_slip
    if lives.values.ndim != 6 or lives.values.shape[4:] != (2, 2) or not lives.values.size or len(lives.exponents) != 2:
        return False
    numbers = (
        model.centres,
        model.scales,
        model.own_basis,
        model.weights[:, :4],
        model.relative_errors[:, :4],
        lives.values,
        lives.exponents,
        model.fields.own,
    )
    return bool(np.array_equal(model.score_terms, _score_terms(len(model.fields)))) and all(np.isfinite(each).all() for each in numbers)


def kept_response(scene: Scene) -> ResponseModel | None:
    """Return the response of a scene that is on disk, or None: `bearing-sim table SCENE --bands` builds it."""
    found = read_response(response_path(scene))
    belongs = found is not None and repr((found.ranges, found.domain)) == repr((uncertain_ranges(scene), domain_of(scene)))
    return found if belongs else None


def scene_fields(scene: Scene) -> Fields:
    """Return the uncertain fields of a scene."""
    ranges = uncertain_ranges(scene)
    return Fields(ranges, [value_at(scene, one.field) for one in ranges])
