# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The response of a bearing: settled slip, lives, clearance and ring temperatures over the operating point and the uncertain fields of its scene.

A response is a sum of products of polynomials, fitted once to settled points of level ``steady`` and kept on disk (`bearing-sim table
--bands`).  Evaluating it takes microseconds, so that thousands of values of the uncertain fields can be tried at every sample of a live run.

An uncertain field is counted by its standard-normal *score*: the value that a standard-normal number has the same probability to fall below
as the field has to fall below its value.  All scores are independent and alike, whatever the distributions of the fields.
"""

import hashlib
import io
import json
import math
import os
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import NamedTuple

import numpy as np
import platformdirs
from scipy.special import ndtr, ndtri

from bearing_sim.levels.steady.table import contour_period, mirror_axis
from bearing_sim.levels.steady.table_builder import span_of
from bearing_sim.model.params import pack
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import Range, ranges_of, value_at

CONDITIONS = ("shaft_speed", "load", "oil_temperature", "load_angle")
"""Columns of conditions: [rad/s, N, K, rad]; the load counts by its magnitude."""

ANSWERS = ("cage_slip", "rating_life", "modified_rating_life", "running_clearance", "inner_ring_temperature", "outer_ring_temperature")
"""Columns of answers, by the names of the observables: [1, h, h, m, K, K]; temperatures are NaN where the scene has no thermal network."""

FOLDER = Path(platformdirs.user_cache_dir("bearing_sim")) / "tables"
VERSION = 1  # of the files
_FARTHEST = 4.5  # largest score; one draw in 300,000 lies beyond
_SLOWEST, _LIGHTEST = 0.03, 0.002  # of the largest speed and load: below, the response is that of these
_DEGREE, _SCORE_DEGREE = 5, 3  # of polynomials together, and in the scores alone
_RIDGE = 1e-9
_FOLDS = 5  # of the cross validation
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
    found[..., 0] = np.interp(found[..., 0], _SLIP_SCALES, _SLIPS)
    found[..., 1:3] = np.exp(found[..., 1:3])
    return found


def slip_scale(slip: np.ndarray) -> np.ndarray:
    """Return slip on a scale without ends: logarithmic from 0.1 % on, since what drives and brakes a cage are factors; its distance from a
    stopped cage by its logarithm, too; and linear about 0, where a cage may lead.
    """  # noqa: D205
    return np.arcsinh(slip / SLIP_SCALE) - np.log(1.01 - np.minimum(slip, 1.0099))


_SLIP_SCALES = slip_scale(_SLIPS)


class ResponseModel(NamedTuple):
    """The response of a bearing; see the module.

    Attributes
    ----------
    fields : of the d uncertain fields.
    domain : operating points that it answers for.
    condition_terms : degrees of the polynomials of the operating point, int, shape (i, 4).
    score_terms : degrees of those of the fields, int, shape (j, d).
    coefficients : of the products of both, for each of `ANSWERS`, shape (6, i, j).
    errors : by cross validation, root mean square on the scales of `transformed`, shape (6,).
    points : settled points that it was fitted to.
    seconds : that building it took.
    """

    fields: Fields
    domain: Domain
    condition_terms: np.ndarray
    score_terms: np.ndarray
    coefficients: np.ndarray
    errors: np.ndarray
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
        return _products(_legendre(2.0 * self.fields.fractions_of(scores) - 1.0, self.score_terms.max(initial=0)), self.score_terms)

    def respond_scaled(self, conditions: np.ndarray, basis: np.ndarray) -> np.ndarray:
        """Return the answers on the scales of `transformed`, shape (n, m, 6).

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).
        basis : `basis_of` scores, shape (m, j).
        """
        return np.swapaxes(self.condition_coefficients(conditions) @ basis.T, 1, 2)

    def condition_coefficients(self, conditions: np.ndarray) -> np.ndarray:
        """Return the coefficients of the polynomials of the fields (`basis_of`) at operating points, on the scales of `transformed`.

        Parameters
        ----------
        conditions : columns `CONDITIONS`, shape (n, 4).

        Returns
        -------
        for each of `ANSWERS`, shape (n, 6, j); NaN at points outside of the response.
        """
        conditions = np.asarray(conditions, float)
        outside = self.outside(conditions)
        there = _condition_basis(coordinates(np.where(outside[:, None], 1.0, conditions), self.domain), self.condition_terms)
        found = np.einsum("ni,qij->nqj", there, self.coefficients, optimize=True)
        found[outside] = math.nan
        return found


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


def _condition_basis(there: np.ndarray, terms: np.ndarray) -> np.ndarray:
    """Return the functions of the operating point: polynomials of the first three coordinates, waves of the angle; shape (n, i)."""
    degree = terms[:, :3].max(initial=0)
    smooth = _products(_legendre(there[:, :3], degree), terms[:, :3])
    waves = [np.ones(len(there))]
    for order in range(1, (terms[:, 3].max(initial=0) + 1) // 2 + 1):
        waves += [math.sqrt(2.0) * np.cos(order * there[:, 3]), math.sqrt(2.0) * np.sin(order * there[:, 3])]
    return smooth * np.stack(waves, axis=1)[:, terms[:, 3]]


def _terms(domain: Domain, count: int) -> np.ndarray:
    """Return the degrees of all products, in the operating point and in ``count`` fields, int, shape (k, 4 + count)."""
    warm, turning = domain.temperatures[1] > domain.temperatures[0], domain.period > 0.0
    found = []
    for scores in _multi_indices(count, _SCORE_DEGREE):
        for point in _multi_indices(3, _DEGREE - sum(scores)):
            if point[2] and not warm:
                continue
            left = _DEGREE - sum(scores) - sum(point)
            waves = range(5 if turning and left >= 2 else 3 if turning and left else 1)
            found += [(*point, wave, *scores) for wave in waves]
    return np.array(found, int)


def _multi_indices(columns: int, degree: int) -> list[tuple[int, ...]]:
    """Return all tuples of degrees whose sum is at most a degree."""
    found = [()]
    for _ in range(columns):
        found = [(*one, more) for one in found for more in range(degree - sum(one) + 1)]
    return found


def fit_response(
    fields: Fields, domain: Domain, conditions: np.ndarray, scores: np.ndarray, answers: np.ndarray, seconds: float = 0.0
) -> ResponseModel:
    """Return the response fitted to settled points.

    Parameters
    ----------
    fields, domain : of the scene.
    conditions : columns `CONDITIONS`, shape (n, 4).
    scores : of the fields at each point, shape (n, d).
    answers : columns `ANSWERS`, shape (n, 6); points with NaN in the first four are left out.
    seconds : that the points took.
    """
    kept = np.isfinite(transformed(answers)[:, :4]).all(axis=1)
    scaled = np.nan_to_num(transformed(answers[kept]))
    terms = _terms(domain, len(fields))
    condition_terms, first = np.unique(terms[:, :4], axis=0, return_inverse=True)
    score_terms, second = np.unique(terms[:, 4:], axis=0, return_inverse=True)
    basis = _products(_legendre(2.0 * fields.fractions_of(scores[kept]) - 1.0, score_terms.max(initial=0)), score_terms)[:, second]
    basis *= _condition_basis(coordinates(conditions[kept], domain), condition_terms)[:, first]
    found = _least_squares(basis, scaled)
    order = np.random.default_rng(1).permutation(len(scaled))
    left = np.empty_like(scaled)
    for part in np.array_split(order, _FOLDS):
        others = np.setdiff1d(order, part)
        left[part] = basis[part] @ _least_squares(basis[others], scaled[others]) - scaled[part]
    coefficients = np.zeros((len(ANSWERS), len(condition_terms), len(score_terms)))
    coefficients[:, first, second] = found.T
    if np.isnan(answers[kept][:, 4:]).all():
        coefficients[4:] = math.nan
    return ResponseModel(
        fields, domain, condition_terms, score_terms, coefficients, np.sqrt(np.mean(left**2, axis=0)), int(np.count_nonzero(kept)), seconds
    )


def _least_squares(basis: np.ndarray, values: np.ndarray) -> np.ndarray:
    square = basis.T @ basis
    square[np.diag_indices_from(square)] += _RIDGE * len(basis)
    return np.linalg.solve(square, basis.T @ values)


def response_digest(scene: Scene) -> str:
    """Return a hash of what a response depends on: bearing, mounting, oil, heat and life of the scene, ranges, operating points, this program."""
    parts = (scene.bearing, scene.mounting, scene.lubricant, scene.heat, scene.life, uncertain_ranges(scene), domain_of(scene), VERSION)
    return hashlib.sha256("\n".join([sources_hash(), *map(repr, parts)]).encode()).hexdigest()[:24]


def response_path(scene: Scene) -> Path:
    """Return where the response of a scene is kept: among the tables of operating points."""
    return FOLDER / f"{response_digest(scene)}.bands.npz"


def write_response(path: Path, model: ResponseModel) -> None:
    """Write a response atomically: a reader finds the old file or the new one, never a part."""
    written = {
        "ranges": [asdict(one) for one in model.fields.ranges],
        "domain": model.domain._asdict(),
        "points": model.points,
        "seconds": model.seconds,
    }
    arrays = {name: getattr(model, name) for name in ("condition_terms", "score_terms", "coefficients", "errors")}
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
        data = path.read_bytes()
        if hashlib.sha256(data[:-32]).digest() != data[-32:]:
            return None
        with np.load(io.BytesIO(data[:-32]), allow_pickle=False) as file:
            written: Mapping = json.loads(file["written"].tobytes())
            fields = Fields([Range(**one) for one in written["ranges"]], file["own"])
            domain = Domain(*(tuple(value) if isinstance(value, list) else value for value in written["domain"].values()))
            arrays = [file[name] for name in ("condition_terms", "score_terms", "coefficients", "errors")]
            return ResponseModel(fields, domain, *arrays, written["points"], written["seconds"])
    except Exception:  # whatever a broken file makes its reader raise, the response is built again
        return None


def kept_response(scene: Scene) -> ResponseModel | None:
    """Return the response of a scene that is on disk, or None: `bearing-sim table SCENE --bands` builds it."""
    return read_response(response_path(scene))


def scene_fields(scene: Scene) -> Fields:
    """Return the uncertain fields of a scene."""
    ranges = uncertain_ranges(scene)
    return Fields(ranges, [value_at(scene, one.field) for one in ranges])
