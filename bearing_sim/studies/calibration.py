# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fit fields of a scene to a measured cage speed by least squares, and say how well the measurement knows them.

The model is level ``steady``: at each operating point the slip that the bearing settles in, and behind a changing shaft speed what
the cage's lag adds.  Each field is scaled to its range in the scene, 0 to 1, by the logarithm where the range is log-uniform.

Residuals of neighbouring blocks resemble each other: sensors drift, and so do conditions that nobody measured.  n residuals are
worth n/tau independent ones, tau their integrated autocorrelation time, summed over a window of W steps and corrected for its bias
(Wolff, Comput. Phys. Commun. 156, 2004, 143, eqs. 35, 42, 49):

    cov = tau s^2 (J^T J)^-1,   s^2 = RSS/(n - p),   nu = n/(2 W + 1),

nu the degrees of freedom of Student's t: as well as tau is known itself, whose relative variance is 2/nu.

An interval knows of scatter alone.  What else is uncertain in the scene and was not fitted shifts the result: `Calibration.depends`.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError
from scipy import optimize, stats

from bearing_sim.levels.steady_point import ANSWER
from bearing_sim.scene import Scene
from bearing_sim.scene_uncertainty import Range, quantities, value_at, with_values
from bearing_sim.studies.calibration_blocks import Blocks, Points, shared_points
from bearing_sim.studies.calibration_faults import CalibrationError, check_before, check_fields, check_fit, check_interval
from bearing_sim.tables.store import solve_points

_STEP = 0.02  # of the range, for the slopes; the solver's own error of slip is 1e-5 of it
_EDGE = 1e-3
_EVEN, _NEARBY = 1e-4, 0.01  # 1/s, below which a shaft's speed does not change; relative, how far to look for the slope of slip by it
_STARTS = (0.15, 0.5, 0.85)
_WINDOW = 3.0  # tau
_LEAST_LEFT = 0.2  # of tau that the correction of its bias may leave


class Fitted(NamedTuple):
    """One field that was fitted, in SI."""

    range: Range
    value: float
    low: float  # of the confidence interval
    high: float
    before: float  # in the scene


class Calibration(NamedTuple):
    """What came of a calibration; n blocks, m operating points, p fields.

    Attributes
    ----------
    fitted : the fields.
    scene : with the fitted values, the ranges of the fields now their confidence intervals.
    confidence : of the intervals.
    correlation : of the fields' estimates, shape (p, p).
    blocks, points : what was fitted to.
    before, after : predicted slip of each block with the scene as it was and as fitted, shape (n,).
    resemblance : tau, how many neighbouring residuals are worth one.
    spare : degrees of freedom of the intervals.
    misfit : mean square of the residuals' means at operating points, over what their scatter alone would leave; NaN with no spare points.
    misfit_chance : of a misfit so large by scatter alone.
    depends : by field that was not fitted, what each fitted field would be with that one at the low and the high end of its range,
        shape (2, p); to first order.
    """

    fitted: tuple[Fitted, ...]
    scene: Scene
    confidence: float
    correlation: np.ndarray
    blocks: Blocks
    points: Points
    before: np.ndarray
    after: np.ndarray
    resemblance: float
    spare: float
    misfit: float
    misfit_chance: float
    depends: dict[str, np.ndarray]

    @property
    def effective(self) -> float:
        """How many independent residuals the blocks are worth."""
        return len(self.blocks.slip) / self.resemblance


class _Scale(NamedTuple):
    """A field's range as 0 to 1."""

    range: Range

    def value(self, place: float) -> float:
        low, high, place = self.range.low, self.range.high, float(place)
        return low * (high / low) ** place if self.range.distribution == "log_uniform" else low + place * (high - low)

    def place(self, value: float) -> float:
        """Return where a value lies; one outside lies at the end."""
        low, high = self.range.low, self.range.high
        value = min(max(value, low), high)
        return math.log(value / low) / math.log(high / low) if self.range.distribution == "log_uniform" else (value - low) / (high - low)


class _Model:
    """Slip of every block by the places of the fields in their ranges; what was computed once is kept."""

    def __init__(self, scene: Scene, fields: Sequence[Range], blocks: Blocks, points: Points, progress: Callable[[int], None]):
        self.scene, self.scales = scene, [_Scale(one) for one in fields]
        self._blocks, self._points, self._progress = blocks, points, progress
        self._known: dict[tuple, np.ndarray] = {}

    def values(self, places: Sequence[float]) -> dict[str, float]:
        return {one.range.field: one.value(float(place)) for one, place in zip(self.scales, places)}

    def __call__(self, places: Sequence[float]) -> np.ndarray:
        key = tuple(round(float(place), 12) for place in places)
        if key not in self._known:
            self._known[key] = self.slip(self.values(key))
            self._progress(len(self._known))
        return self._known[key]

    def slip(self, values: dict[str, float]) -> np.ndarray:
        """Return the slip of every block with numbers [SI] in place of some of the scene's."""
        try:
            scene = with_values(self.scene, values)
        except ValidationError as error:
            told = "; ".join(fault["msg"].removeprefix("Value error, ") for fault in error.errors())
            raise CalibrationError(f"numbers within the ranges do not fit together ({values}): {told}; narrow the ranges") from None
        inputs = self._points.conditions
        kelvin = np.where(np.isnan(inputs[:, 3]), scene.lubricant.temperature, inputs[:, 3])
        load, angle = np.hypot(inputs[:, 1], inputs[:, 2]), np.arctan2(inputs[:, 2], inputs[:, 1])
        asked = np.stack([inputs[:, 0], load, kelvin, angle], axis=-1)
        answers = solve_points(scene, asked)
        slip, lag = answers[:, ANSWER.cage_slip], np.nan_to_num(answers[:, ANSWER.lag])
        if np.isnan(slip).any():
            missing = asked[np.flatnonzero(np.isnan(slip))[0]]
            raise CalibrationError(f"no steady state was found at {30 / math.pi * missing[0]:.6g} rpm, {missing[1]:.6g} N with {values}")
        return slip[self._points.place] + self._behind(scene, asked, slip, lag)

    def _behind(self, scene: Scene, asked: np.ndarray, slip: np.ndarray, lag: np.ndarray) -> np.ndarray | float:
        """Return what the lag adds to slip where the shaft's speed changes: lag times the rate of the settled cage speed, over ideal speed."""
        lead, place = self._blocks.lead, self._points.place
        if np.abs(lead).max() < _EVEN:
            return 0.0
        nearby = solve_points(scene, asked * [1.0 + _NEARBY, 1.0, 1.0, 1.0])[:, ANSWER.cage_slip]
        return (lag * (1.0 - slip - np.nan_to_num((nearby - slip) / _NEARBY)))[place] * lead

    def slopes(self, places: np.ndarray) -> np.ndarray:
        """Return d slip/d place by differences within the ranges, shape (n, p)."""
        columns = []
        for k in range(len(places)):
            low, high = places.copy(), places.copy()
            low[k], high[k] = max(places[k] - _STEP, 0.0), min(places[k] + _STEP, 1.0)
            columns.append((self(high) - self(low)) / (high[k] - low[k]))
        return np.stack(columns, axis=-1)


def calibrate(
    scene: Scene, fields: Sequence[str], blocks: Blocks, *,
    confidence: float = 0.95, progress: Callable[[int], None] = lambda evaluated: None,
) -> Calibration:  # fmt: skip
    """Fit fields of a scene to measured blocks.

    Parameters
    ----------
    scene : the rest of which is taken as it is; its ranges bound the fields and say what else is uncertain.
    fields : dotted paths.
    blocks : measured slip (see `bearing_sim.studies.calibration_blocks.cut`).
    confidence : of the intervals.
    progress : called with the number of times that all operating points were computed.

    Raises
    ------
    CalibrationError
        A field has no range or no influence, or the measurement cannot tell what was asked for; the message says what is missing.
    """
    ranges = check_fields(scene, fields, blocks)
    points = shared_points(blocks.conditions)
    model = _Model(scene, ranges, blocks, points, progress)
    own = np.array([one.place(value_at(scene, one.range.field)) for one in model.scales])
    start = _start(model, np.clip(own, _EDGE, 1.0 - _EDGE), blocks.slip)
    check_before(scene, ranges, model.slopes(start), blocks, points)
    found = optimize.least_squares(
        lambda places: model(places) - blocks.slip, start, lambda places: model.slopes(places), bounds=(0.0, 1.0), xtol=1e-6, ftol=1e-9, max_nfev=40
    )
    places, after = found.x, model(found.x)
    slopes = model.slopes(places)
    check_fit(scene, ranges, found, slopes, blocks, after, points)
    residuals = blocks.slip - after
    tau, spare = resemblance(residuals)
    spare = max(spare - len(ranges) + 1, 1.0)
    deviations, correlation = _spread(slopes, residuals, tau)
    reach = stats.t.ppf(0.5 + confidence / 2, spare) * deviations
    ends = np.array([places - reach, places + reach])
    check_interval(scene, ranges, ends, confidence, blocks, tau)
    fitted = tuple(
        Fitted(one.range, one.value(places[k]), one.value(ends[0, k]), one.value(ends[1, k]), value_at(scene, one.range.field))
        for k, one in enumerate(model.scales)
    )
    before = model.slip({})
    misfit, chance = _misfit(residuals, points.place, tau, len(ranges))
    depends = _dependence(model, places, slopes, blocks)
    return Calibration(
        fitted, _fitted_scene(scene, fitted, confidence), confidence, correlation, blocks, points, before, after, tau, spare, misfit, chance, depends
    )


def _start(model: _Model, own: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Return from where to search: the scene's own place, or along the diagonal of the ranges, whichever is nearest to the measured slip."""
    tried = [own, *(np.full(len(own), place) for place in _STARTS)]
    return min(tried, key=lambda places: float(((model(places) - measured) ** 2).sum()))


def resemblance(residuals: np.ndarray) -> tuple[float, float]:
    """Return the integrated autocorrelation time of residuals, in steps, no less than 1, and the degrees of freedom it is known with."""
    count = len(residuals)
    waves = np.fft.rfft(residuals - residuals.mean(), 2 * count)
    products = np.fft.irfft(np.abs(waves) ** 2)[:count]
    if products[0] <= 0.0:
        return 1.0, count / (2 * _WINDOW + 1)
    times = 1.0 + 2.0 * np.cumsum(products[1:] / products[0])
    wide_enough = np.flatnonzero(np.arange(1, count) >= _WINDOW * times)
    window = int(wide_enough[0]) + 1 if len(wide_enough) else count - 1
    known = (2 * window + 1) / count
    return float(max(times[window - 1], 1.0) / max(1.0 - known, _LEAST_LEFT)), 1.0 / known


def _spread(slopes: np.ndarray, residuals: np.ndarray, tau: float) -> tuple[np.ndarray, np.ndarray]:
    """Return standard deviations of the places, and their correlation."""
    variance = float(residuals @ residuals) / (len(residuals) - slopes.shape[1])
    covariance = tau * variance * np.linalg.inv(slopes.T @ slopes)
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.nan_to_num(covariance / np.outer(deviations, deviations))
    np.fill_diagonal(correlation, 1.0)
    return deviations, correlation


def _misfit(residuals: np.ndarray, place: np.ndarray, tau: float, fields: int) -> tuple[float, float]:
    """Return how much more the residuals' means at operating points differ from zero than by scatter, and the chance of that (F test)."""
    sizes = np.bincount(place)
    means = np.bincount(place, residuals) / sizes
    spare, within = len(sizes) - fields, (len(residuals) - len(sizes)) / tau
    if spare < 1 or within < 1:
        return math.nan, math.nan
    inner = float(((residuals - means[place]) ** 2).sum()) / (len(residuals) - len(sizes))
    if inner <= 0.0:
        return math.nan, math.nan
    own, _ = resemblance(residuals - means[place])
    ratio = float((sizes * means**2).sum()) / spare / (own * inner)
    return ratio, float(stats.f.sf(ratio, spare, max(within, 1.0)))


def _dependence(model: _Model, places: np.ndarray, slopes: np.ndarray, blocks: Blocks) -> dict[str, np.ndarray]:
    """Return what the fitted fields would be with each other uncertain field at the ends of its range, to first order."""
    fitted, inverse = model.values(places), np.linalg.pinv(slopes)
    from_log = not np.isnan(blocks.conditions[:, 3]).any()
    depends = {}
    for one in model.scene.uncertainty:
        if one.field in fitted or one.field.startswith("operating.") or (from_log and one.field == "lubricant.temperature"):
            continue
        shifted = [places + inverse @ (blocks.slip - model.slip(fitted | {one.field: end})) for end in (one.low, one.high)]
        depends[one.field] = np.array([[scale.value(place) for scale, place in zip(model.scales, row)] for row in shifted])
    return depends


def _fitted_scene(scene: Scene, fitted: Sequence[Fitted], confidence: float) -> Scene:
    """Return the scene with the fitted values and, as their ranges, what the measurement leaves of them."""
    known = quantities(type(scene))
    source = f"calibrated; {100 * confidence:g} % confidence interval of the scatter alone"
    narrowed = {
        one.range.field: Range(
            field=one.range.field,
            low=max(one.low, known[one.range.field].minimum),
            high=min(one.high, known[one.range.field].maximum),
            source=source,
        )
        for one in fitted
    }
    scene = with_values(scene, {one.range.field: one.value for one in fitted})
    return type(scene)(**_fields(scene) | {"uncertainty": tuple(narrowed.get(one.field, one) for one in scene.uncertainty)})


def _fields(scene: Scene) -> dict:
    return {name: getattr(scene, name) for name in scene.__dataclass_fields__}
