# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Calibration: scene fields fitted to a measured cage speed.

The measurement is cut into blocks in which the bearing has settled; blocks with nearly the same conditions share an operating point.
Slip follows a change of conditions within a few tenths of a second: a block is left out if conditions changed during it or shortly
before.  The fit is a least-squares fit of the settled slip; its intervals account for the autocorrelation of the residuals.
"""

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError
from scipy import optimize, stats

from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table_builder import solve_points
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import Range, messages, nearest, number_at, quantities, with_values
from bearing_sim.simulation import Inputs
from bearing_sim.sweep.pictures import new_figure, save

SPEED_CHANGE, LOAD_CHANGE = 0.02, 0.25  # relative, over a block and the settling time before it
_SETTLING = 0.5  # s; lags of settled cages are below a third of it
_SHORTEST, _LONGEST, _BLOCKS = 0.1, 1.0, 120  # s, and the number of blocks of a short recording
_FULL = 0.5  # of the usual number of messages; a block with fewer, or cut short by the end, is left out
_MOST_POINTS = 400
_NEAR = (0.01, 0.02, 0.02, 1.0)  # speed and loads, relative to the largest, and temperature [K], within which blocks share an operating point
_COARSER = 1.5


class Blocks(NamedTuple):
    """The n blocks of a measurement.

    Attributes
    ----------
    length : of a block [s].
    times : of the middles [s], shape (n,).
    slip : mean measured cage slip, shape (n,).
    scatter : standard deviation of the slip of single messages in a block, shape (n,).
    lead : shaft acceleration over shaft speed [1/s], shape (n,); times the cage's lag it gives the slip that the lag adds.
    conditions : mean inputs at the times of the messages, columns as `bearing_sim.simulation.Inputs`, shape (n, 6); NaN stands
        for the scene's oil temperature.
    left_out : number of blocks left out, by reason.
    """

    length: float
    times: np.ndarray
    slip: np.ndarray
    scatter: np.ndarray
    lead: np.ndarray
    conditions: np.ndarray
    left_out: Counter


class Points(NamedTuple):
    """The m operating points of the blocks.

    Attributes
    ----------
    conditions : means over the blocks of each point, shape (m, 6).
    index : of the operating point of each block, shape (n,).
    """

    conditions: np.ndarray
    index: np.ndarray


class Measured(NamedTuple):
    """A measured course.

    Attributes
    ----------
    times : instants of the inputs [s], increasing, shape (k,).
    inputs : conditions there, linear in between, shape (k, 6).
    gaps : (from, to) [s] without good inputs.
    cage_times, cage_speeds : of the measured cage [s], increasing, and [rad/s], shape (q,).
    """

    times: np.ndarray
    inputs: np.ndarray
    gaps: list[tuple[float, float]]
    cage_times: np.ndarray
    cage_speeds: np.ndarray

    def at(self, times: np.ndarray) -> np.ndarray:
        """Return the conditions at some times [s]."""
        return np.stack([np.interp(times, self.times, column) for column in self.inputs.T], axis=-1)


def block_length(seconds: float) -> float:
    """Return the length of the blocks of a recording [s]: one second, or less for a short recording."""
    return float(np.clip(seconds / _BLOCKS, _SHORTEST, _LONGEST))


def cut(measured: Measured, diameter_ratio: float, from_speed: float, length: float) -> Blocks:
    """Cut a measured course into blocks and keep those in which the bearing has settled.

    Parameters
    ----------
    measured : the course.
    diameter_ratio : gamma of the bearing.
    from_speed : shaft speed below which blocks are left out [rad/s].
    length : of a block [s].
    """
    begin, end = measured.times[0], measured.times[-1]
    inside = (measured.cage_times >= begin) & (measured.cage_times <= end)
    for first, last in measured.gaps:
        inside &= ~((measured.cage_times > first) & (measured.cage_times < last))
    times, speeds = measured.cage_times[inside], measured.cage_speeds[inside]
    inputs = measured.at(times)  # at the times of the cage's messages
    with np.errstate(divide="ignore", invalid="ignore"):
        slips = 1.0 - speeds / (0.5 * inputs[:, 0] * (1.0 - diameter_ratio))
    numbers = np.floor((times - begin) / length).astype(int)
    usual = np.median(np.unique(numbers, return_counts=True)[1]) if len(numbers) else 0.0
    resets = [begin, *(last for _, last in measured.gaps)]
    kept, left_out = [], Counter()
    for number in np.unique(numbers):
        mine = numbers == number
        edges = begin + length * number, min(begin + length * (number + 1), end)
        part = edges[1] - edges[0] < _FULL * length or mine.sum() < _FULL * usual
        why = "with few messages" if part else _unsettled(measured, edges, from_speed, resets)
        if why:
            left_out[why] += 1
            continue
        kept.append((times[mine].mean(), slips[mine].mean(), slips[mine].std(), _lead(measured, edges), inputs[mine].mean(axis=0)))
    middles, slip, scatter, lead = (np.array([row[column] for row in kept]) for column in range(4))
    return Blocks(length, middles, slip, scatter, lead, np.array([row[4] for row in kept]).reshape(-1, len(Inputs._fields)), left_out)


def _within(measured: Measured, edges: tuple[float, float]) -> np.ndarray:
    """Return conditions between two times, both ends included."""
    first, last = np.searchsorted(measured.times, edges)
    return measured.at(np.concatenate([edges[:1], measured.times[first:last], edges[1:]]))


def _unsettled(measured: Measured, edges: tuple[float, float], from_speed: float, resets: list[float]) -> str:
    before = edges[0] - _SETTLING
    if any(before < reset <= edges[1] for reset in resets):
        return "at the start or after a gap"
    seen = _within(measured, (before, edges[1]))
    speed, load = np.abs(seen[:, 0]), np.hypot(seen[:, 1], seen[:, 2])
    if speed.min() < from_speed:
        return "at rest"
    if np.ptp(seen[:, 0]) > SPEED_CHANGE * speed.mean():
        return "at a changing speed"
    if np.ptp(load) > LOAD_CHANGE * load.mean():
        return "at a changing load"
    return ""


def _lead(measured: Measured, edges: tuple[float, float]) -> float:
    """Return mean shaft acceleration over mean shaft speed [1/s]."""
    first, last = (np.interp(edge, measured.times, measured.inputs[:, 0]) for edge in edges)
    return 2.0 * (last - first) / (edges[1] - edges[0]) / (first + last)


def shared_points(conditions: np.ndarray) -> Points:
    """Return the operating points of blocks: means over blocks with nearly the same conditions, so that first-order errors cancel.

    Parameters
    ----------
    conditions : as of `Blocks`.
    """
    known = np.nan_to_num(conditions)
    largest = np.maximum(np.abs(known).max(axis=0), 1e-9)
    load = max(np.hypot(known[:, 1], known[:, 2]).max(), 1e-9)
    near = np.array([_NEAR[0] * largest[0], _NEAR[1] * load, _NEAR[2] * load, *np.full(known.shape[1] - 3, _NEAR[3])])
    while True:
        _, index = np.unique(np.round(known / near), axis=0, return_inverse=True)
        index = index.ravel()
        count = index.max() + 1
        if count <= _MOST_POINTS:
            break
        near *= _COARSER
    sums = np.array([np.bincount(index, column, count) for column in conditions.T]).T
    return Points(sums / np.bincount(index, minlength=count)[:, None], index)


_LEAST_BLOCKS, _BLOCKS_PER_FIELD = 10, 5
_NO_EFFECT = 1e-5  # change of slip over the whole range that is within the solver's error
_CONDITION = 100.0  # largest condition of the scaled Jacobian of the fit: two fields with a correlation of 0.9998
_CONDITION_BEFORE = 1e4  # at the start of the search, where slopes may differ
_ALIKE = 0.99  # cosine between the slopes of two fields above which a message names them
_BOUND = 2e-3  # of the range; a result nearer to its end counts as at the end
_NARROWED = 0.5  # largest interval, as a fraction of the range
_LEAST_INDEPENDENT = 5


class CalibrationError(ValueError):
    """A fit that the measurement does not determine, or that was asked for wrongly; the message says what is missing."""


def check_fields(scene: Scene, fields: Sequence[str], blocks: Blocks) -> list[Range]:
    """Return the ranges of fields; the last word of a path suffices if it is unique.

    Raises
    ------
    CalibrationError
        A field has no range or cannot be fitted, or there are too few blocks.
    """
    known, by_field = quantities(type(scene)), {one.field: one for one in scene.uncertainty}
    ranges = []
    for name in fields:
        matches = [path for path in by_field if path == name or path.rpartition(".")[2] == name]
        if name not in known and len(matches) != 1:
            hint = nearest(name, by_field) or nearest(name, known)
            raise CalibrationError(f"--fit {name}: unknown field{hint}; the scene has ranges for {', '.join(by_field) or 'no field'}")
        path = name if name in known else matches[0]
        if _is_measured(path, blocks) and len(blocks.slip) or path.startswith("operating."):
            raise CalibrationError(f"--fit {path}: the recording itself gives it; fit other fields")
        if path not in by_field:
            raise CalibrationError(f'--fit {path}: the scene gives no range to search; add --set "uncertainty.{path}=[LOW, HIGH]"')
        ranges.append(by_field[path])
    repeated = {one.field for one in ranges if ranges.count(one) > 1}
    if repeated or not ranges:
        raise CalibrationError(f"--fit: {', '.join(sorted(repeated))} is given twice" if repeated else "--fit: expected at least one field")
    _check_amount(len(ranges), blocks)
    return ranges


def _is_measured(path: str, blocks: Blocks) -> bool:
    """Return whether the recording gives a field."""
    return path.startswith("operating.") or path == "lubricant.temperature" and not np.isnan(blocks.conditions[:, 3]).any()


def _check_amount(fields: int, blocks: Blocks) -> None:
    needed = max(_LEAST_BLOCKS, _BLOCKS_PER_FIELD * fields)
    if len(blocks.slip) < needed:
        reasons = ", ".join(f"{count} {why}" for why, count in blocks.left_out.items()) or "none"
        raise CalibrationError(
            f"too little data: {len(blocks.slip)} settled blocks of {blocks.length:.3g} s for {fields} field{'s' * (fields > 1)}, "
            f"expected {needed} or more (left out: {reasons}); record longer at constant speed and load, or give a shorter --batch"
        )


def check_before(ranges: Sequence[Range], slopes: np.ndarray, points: Points) -> None:
    """Raise for fields without effect on slip, and for fields with the same effect; ``slopes`` at the start, shape (n, p)."""
    effects = np.abs(slopes).max(axis=0)
    for one, effect in zip(ranges, effects):
        if not effect >= _NO_EFFECT:
            raise CalibrationError(
                f"{one.field} cannot be identified: over its whole range it changes slip by no more than {100 * effect:.2g} points at "
                f"{_where(points)}; record where it matters, or fit another field"
            )
    _check_distinguishable(ranges, slopes, points, _CONDITION_BEFORE)


def _check_distinguishable(ranges: Sequence[Range], slopes: np.ndarray, points: Points, worst: float) -> None:
    scaled = slopes / np.linalg.norm(slopes, axis=0)
    strengths = np.linalg.svd(scaled, compute_uv=False)
    if len(ranges) <= len(points.conditions) and strengths[-1] * worst >= strengths[0]:
        return
    likeness = np.abs(scaled.T @ scaled) - np.eye(len(ranges))
    alike = sorted({k for pair in np.argwhere(likeness > _ALIKE) for k in pair}) or range(len(ranges))
    condition = strengths[0] / strengths[-1] if strengths[-1] > 0.0 else math.inf
    raise CalibrationError(
        f"{' and '.join(ranges[k].field for k in alike)} cannot be distinguished: at {_where(points)} they have the same effect on slip "
        f"(condition of the scaled Jacobian {condition:.3g}, expected below {worst:g}); record at other speeds and loads, or fit only one of them"
    )


def _where(points: Points) -> str:
    """Return a description of the operating points."""
    speed, load = np.abs(points.conditions[:, 0]) * 30 / math.pi, np.hypot(points.conditions[:, 1], points.conditions[:, 2])
    if len(speed) == 1:
        return f"the one operating point of this run ({speed[0]:.0f} rpm, {load[0]:.0f} N)"
    return f"the {len(speed)} operating points of this run ({speed.min():.0f} to {speed.max():.0f} rpm, {load.min():.0f} to {load.max():.0f} N)"


def check_fit(scene: Scene, ranges: Sequence[Range], found, slopes: np.ndarray, blocks: Blocks, after: np.ndarray, points: Points) -> None:
    """Raise if the search did not converge or ended at a bound, or if fields cannot be distinguished at its end."""
    _check_distinguishable(ranges, slopes, points, _CONDITION)
    if not found.success:
        raise CalibrationError(f"the search did not converge: {found.message}; narrow the ranges, or fit fewer fields")
    known = quantities(type(scene))
    for one, position in zip(ranges, found.x):
        if _BOUND < position < 1.0 - _BOUND:
            continue
        bound, declared = one.low if position <= _BOUND else one.high, known[one.field]
        raise CalibrationError(
            f"the best {one.field} lies at the bound of its range, {declared.show(bound)}, where the model slips by "
            f"{100 * after.mean():.3g} % on average and the measured cage by {100 * blocks.slip.mean():.3g} %; check other fields, the scene and "
            f"the sensor, or widen the range "
            f'(--set "uncertainty.{one.field}=[LOW, HIGH]")'
        )


def check_interval(ranges: Sequence[Range], ends: np.ndarray, confidence: float, blocks: Blocks, tau: float) -> None:
    """Raise if an interval is hardly narrower than the range; ``ends`` as positions in the ranges, shape (2, p)."""
    independent = len(blocks.slip) / tau
    if independent < _LEAST_INDEPENDENT + len(ranges):
        raise CalibrationError(
            f"too little data: residuals are correlated over {tau * blocks.length:.3g} s, so {len(blocks.slip)} blocks of "
            f"{blocks.length:.3g} s are worth {independent:.1f} independent ones, expected {_LEAST_INDEPENDENT + len(ranges)} or more; "
            "record longer"
        )
    for one, low, high in zip(ranges, *ends):
        if not high - low <= _NARROWED:
            raise CalibrationError(
                f"{one.field} cannot be identified: its {100 * confidence:g} % interval covers {100 * (high - low):.0f} % of its range in "
                f"the scene, expected {100 * _NARROWED:g} % or less; record longer, with a better sensor, or where slip "
                "depends on it more"
            )


_STEP = 0.02  # of the range, for the slopes; the solver's error of slip is 1e-5
_EDGE = 1e-3
_EVEN, _NEARBY = 1e-4, 0.01  # 1/s, below which the shaft speed counts as constant; relative step for the slope of slip over speed
_STARTS = (0.15, 0.5, 0.85)
_WINDOW = 3.0  # tau
_LEAST_LEFT = 0.2  # smallest divisor in the bias correction of tau


class Fitted(NamedTuple):
    """One field that was fitted, in SI."""

    range: Range
    value: float
    low: float  # of the confidence interval
    high: float
    before: float  # in the scene


class Calibration(NamedTuple):
    """Results of a calibration; n blocks, m operating points, p fields.

    Attributes
    ----------
    fitted : the fields.
    scene : with the fitted values, and their confidence intervals as ranges.
    confidence : of the intervals.
    correlation : of the fields' estimates, shape (p, p).
    blocks, points : of the measurement.
    before, after : predicted slip of each block with the original and the fitted scene, shape (n,).
    correlation_time : integrated autocorrelation time of the residuals, tau, in blocks.
    spare : degrees of freedom of the intervals.
    misfit : F ratio of the residuals' means at operating points to their scatter; NaN without spare points.
    misfit_chance : probability of such a misfit by scatter alone.
    depends : for each uncertain field that was not fitted, the fitted fields with that field at the low and the high end of its
        range, shape (2, p); to first order.
    """

    fitted: tuple[Fitted, ...]
    scene: Scene
    confidence: float
    correlation: np.ndarray
    blocks: Blocks
    points: Points
    before: np.ndarray
    after: np.ndarray
    correlation_time: float
    spare: float
    misfit: float
    misfit_chance: float
    depends: dict[str, np.ndarray]

    @property
    def effective(self) -> float:
        """Effective number of independent residuals."""
        return len(self.blocks.slip) / self.correlation_time


class _Scale(NamedTuple):
    """Map of a field's range to positions 0 to 1."""

    range: Range

    def value(self, position: float) -> float:
        low, high, position = self.range.low, self.range.high, float(position)
        return low * (high / low) ** position if self.range.distribution == "log_uniform" else low + position * (high - low)

    def position(self, value: float) -> float:
        """Return the position of a value, clipped to the range."""
        low, high = self.range.low, self.range.high
        value = min(max(value, low), high)
        return math.log(value / low) / math.log(high / low) if self.range.distribution == "log_uniform" else (value - low) / (high - low)


class _Model:
    """Slip of every block as a function of the positions of the fields in their ranges, with a cache of results."""

    def __init__(self, scene: Scene, fields: Sequence[Range], blocks: Blocks, points: Points, progress: Callable[[int], None]):
        self.scene, self.scales = scene, [_Scale(one) for one in fields]
        self._blocks, self._points, self._progress = blocks, points, progress
        self._known: dict[tuple, np.ndarray] = {}

    def values(self, positions: Sequence[float]) -> dict[str, float]:
        return {one.range.field: one.value(float(position)) for one, position in zip(self.scales, positions)}

    def __call__(self, positions: Sequence[float]) -> np.ndarray:
        key = tuple(round(float(position), 12) for position in positions)
        if key not in self._known:
            self._known[key] = self.slip(self.values(key))
            self._progress(len(self._known))
        return self._known[key]

    def slip(self, values: dict[str, float]) -> np.ndarray:
        """Return the slip of every block with other values [SI] of some fields."""
        try:
            scene = with_values(self.scene, values)
        except ValidationError as error:
            raise CalibrationError(f"numbers within the ranges contradict each other ({values}): {messages(error)}; narrow the ranges") from None
        inputs = self._points.conditions
        kelvin = np.where(np.isnan(inputs[:, 3]), scene.lubricant.temperature, inputs[:, 3])
        load, angle = np.hypot(inputs[:, 1], inputs[:, 2]), np.arctan2(inputs[:, 2], inputs[:, 1])
        asked = np.stack([inputs[:, 0], load, kelvin, angle], axis=-1)
        answers = solve_points(scene, asked)
        slip, lag = answers[:, ANSWER.cage_slip], np.nan_to_num(answers[:, ANSWER.lag])
        if np.isnan(slip).any():
            missing = asked[np.flatnonzero(np.isnan(slip))[0]]
            raise CalibrationError(f"no steady state was found at {30 / math.pi * missing[0]:.6g} rpm, {missing[1]:.6g} N with {values}")
        return slip[self._points.index] + self._slip_of_lag(scene, asked, slip, lag)

    def _slip_of_lag(self, scene: Scene, asked: np.ndarray, slip: np.ndarray, lag: np.ndarray) -> np.ndarray | float:
        """Return the slip that the lag adds under a changing shaft speed: lag times the rate of the settled cage speed, over ideal speed."""
        lead, index = self._blocks.lead, self._points.index
        if np.abs(lead).max() < _EVEN:
            return 0.0
        nearby = solve_points(scene, asked * [1.0 + _NEARBY, 1.0, 1.0, 1.0])[:, ANSWER.cage_slip]
        return (lag * (1.0 - slip - np.nan_to_num((nearby - slip) / _NEARBY)))[index] * lead

    def slopes(self, positions: np.ndarray) -> np.ndarray:
        """Return d slip/d position by differences within the ranges, shape (n, p)."""
        columns = []
        for k in range(len(positions)):
            low, high = positions.copy(), positions.copy()
            low[k], high[k] = max(positions[k] - _STEP, 0.0), min(positions[k] + _STEP, 1.0)
            columns.append((self(high) - self(low)) / (high[k] - low[k]))
        return np.stack(columns, axis=-1)


def calibrate(
    scene: Scene, fields: Sequence[str], blocks: Blocks, *,
    confidence: float = 0.95, progress: Callable[[int], None] = lambda evaluated: None,
) -> Calibration:  # fmt: skip
    """Fit fields of a scene to measured blocks.

    Parameters
    ----------
    scene : its ranges bound the fitted fields and give the other uncertain fields; all else is kept.
    fields : dotted paths.
    blocks : measured slip (see `bearing_sim.studies.calibration.cut`).
    confidence : of the intervals.
    progress : called with the number of evaluations of all operating points.

    Raises
    ------
    CalibrationError
        A field has no range or no influence, or the measurement does not determine it; the message says what is missing.
    """
    ranges = check_fields(scene, fields, blocks)
    points = shared_points(blocks.conditions)
    model = _Model(scene, ranges, blocks, points, progress)
    own = np.array([one.position(number_at(scene, one.range.field)) for one in model.scales])
    start = _start(model, np.clip(own, _EDGE, 1.0 - _EDGE), blocks.slip)
    check_before(ranges, model.slopes(start), points)
    found = optimize.least_squares(
        lambda positions: model(positions) - blocks.slip, start, model.slopes, bounds=(0.0, 1.0), xtol=1e-6, ftol=1e-9, max_nfev=40
    )
    positions, after = found.x, model(found.x)
    slopes = model.slopes(positions)
    check_fit(scene, ranges, found, slopes, blocks, after, points)
    residuals = blocks.slip - after
    tau, spare = correlation_time(residuals)
    spare = max(spare - len(ranges) + 1, 1.0)
    deviations, correlation = _spread(slopes, residuals, tau)
    reach = stats.t.ppf(0.5 + confidence / 2, spare) * deviations
    ends = np.array([positions - reach, positions + reach])
    check_interval(ranges, ends, confidence, blocks, tau)
    fitted = tuple(
        Fitted(one.range, one.value(positions[k]), one.value(ends[0, k]), one.value(ends[1, k]), number_at(scene, one.range.field))
        for k, one in enumerate(model.scales)
    )
    before = model.slip({})
    misfit, chance = _misfit(residuals, points.index, tau, len(ranges))
    depends = _dependence(model, positions, slopes, blocks)
    return Calibration(
        fitted, _fitted_scene(scene, fitted, confidence), confidence, correlation, blocks, points, before, after, tau, spare, misfit, chance, depends
    )


def _start(model: _Model, own: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Return the start of the search: the scene's own position or one along the diagonal of the ranges, whichever fits best."""
    tried = [own, *(np.full(len(own), position) for position in _STARTS)]
    return min(tried, key=lambda positions: float(((model(positions) - measured) ** 2).sum()))


def correlation_time(residuals: np.ndarray) -> tuple[float, float]:
    """Return the integrated autocorrelation time of residuals, in steps and at least 1, and its degrees of freedom."""
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
    """Return standard deviations of the positions, and their correlation."""
    variance = float(residuals @ residuals) / (len(residuals) - slopes.shape[1])
    covariance = tau * variance * np.linalg.inv(slopes.T @ slopes)
    deviations = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.nan_to_num(covariance / np.outer(deviations, deviations))
    np.fill_diagonal(correlation, 1.0)
    return deviations, correlation


def _misfit(residuals: np.ndarray, index: np.ndarray, tau: float, fields: int) -> tuple[float, float]:
    """Return the F ratio of the residuals' means at operating points to their scatter, and its probability."""
    sizes = np.bincount(index)
    means = np.bincount(index, residuals) / sizes
    spare, within = len(sizes) - fields, (len(residuals) - len(sizes)) / tau
    if spare < 1 or within < 1:
        return math.nan, math.nan
    inner = float(((residuals - means[index]) ** 2).sum()) / (len(residuals) - len(sizes))
    if inner <= 0.0:
        return math.nan, math.nan
    own, _ = correlation_time(residuals - means[index])
    ratio = float((sizes * means**2).sum()) / spare / (own * inner)
    return ratio, float(stats.f.sf(ratio, spare, max(within, 1.0)))


def _dependence(model: _Model, positions: np.ndarray, slopes: np.ndarray, blocks: Blocks) -> dict[str, np.ndarray]:
    """Return the fitted fields with each other uncertain field at the ends of its range, to first order."""
    fitted, inverse = model.values(positions), np.linalg.pinv(slopes)
    depends = {}
    for one in model.scene.uncertainty:
        if one.field in fitted or _is_measured(one.field, blocks):
            continue
        shifted = [positions + inverse @ (blocks.slip - model.slip(fitted | {one.field: end})) for end in (one.low, one.high)]
        depends[one.field] = np.array([[scale.value(position) for scale, position in zip(model.scales, row)] for row in shifted])
    return depends


def _fitted_scene(scene: Scene, fitted: Sequence[Fitted], confidence: float) -> Scene:
    """Return the scene with the fitted values, and their confidence intervals as ranges."""
    known = quantities(type(scene))
    source = f"calibrated; {100 * confidence:g} % confidence interval of the scatter alone"
    narrowed = {}
    for field, one in ((one.range.field, one) for one in fitted):
        low, high = max(one.low, known[field].minimum), min(one.high, known[field].maximum)
        narrowed[field] = Range(field=field, low=low, high=high, source=source)
    scene = with_values(scene, {one.range.field: one.value for one in fitted})
    return replace(scene, uncertainty=tuple(narrowed.get(one.field, one) for one in scene.uncertainty))


_MEASURED, _BEFORE, _AFTER = "0.45", "#d55e00", "#0072b2"  # Okabe and Ito: safe for colour-blind readers


def plot_calibration(path: Path, title: str, found: Calibration) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(12, 8)
    axes = figure.subplot_mosaic([["time", "time"], ["against", "left"]])
    blocks = found.blocks
    for slips, size, colour, label in (
        (blocks.slip, 4, _MEASURED, f"measured, means over {blocks.length:.3g} s"),
        (found.before, 3, _BEFORE, "model, original scene"),
        (found.after, 3, _AFTER, "model, calibrated"),
    ):
        axes["time"].plot(blocks.times, 100 * slips, ".", ms=size, color=colour, label=label)
    axes["time"].set(xlabel="time [s]", ylabel="cage slip [%]")
    axes["time"].legend(fontsize=9)
    _draw_comparison(axes["against"], found)
    _draw_residuals(axes["left"], found)
    save(figure, path, title)


def _draw_comparison(axes, found) -> None:
    """Draw measured over predicted slip as means of operating points, with error bars from their scatter."""
    index = found.points.index
    sizes = np.bincount(index)

    def mean(values):
        return 100 * np.bincount(index, values) / sizes

    measured = mean(found.blocks.slip)
    spread = np.sqrt(np.maximum(mean(found.blocks.slip**2) / 100 - (measured / 100) ** 2, 0.0))
    error = 196 * spread * np.sqrt(found.correlation_time / sizes)
    for values, colour, label in ((found.before, _BEFORE, "original scene"), (found.after, _AFTER, "calibrated")):
        axes.errorbar(mean(values), measured, yerr=error, fmt="o", ms=4, lw=1, color=colour, label=label)
    ends = [min(axes.get_xlim()[0], axes.get_ylim()[0]), max(axes.get_xlim()[1], axes.get_ylim()[1])]
    axes.plot(ends, ends, "k:", lw=1)
    axes.set(xlabel="predicted slip [%]", ylabel="measured slip [%]", title="means of operating points, with 95 % intervals")
    axes.title.set_fontsize(10)
    axes.legend(fontsize=9)


def _draw_residuals(axes, found) -> None:
    residuals = 100 * (found.blocks.slip - found.after)
    axes.plot(found.blocks.times, residuals, ".", ms=4, color=_AFTER)
    axes.axhline(0.0, color="black", lw=0.8)
    axes.set(xlabel="time [s]", ylabel="measured minus predicted [points]")
    axes.set_title(f"residuals; autocorrelation time {found.correlation_time:.2g} blocks", fontsize=10)
