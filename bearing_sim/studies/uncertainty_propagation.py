# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Uncertainty of slip and life: bands, and Sobol' indices of the uncertain fields of a scene.

The design has two independent samples A and B of the d uncertain numbers and, for each number, A with that column taken from B:
N (d + 2) points for first-order and total indices (Saltelli et al., Comput. Phys. Commun. 181, 2010, 259).  Both samples come from
one scrambled Sobol' sequence in 2 d dimensions; bands use both.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError
from scipy import stats
from scipy.stats import qmc

from bearing_sim.levels.steady.table import empty_table
from bearing_sim.model.params import replenishment
from bearing_sim.scene import display, fidelity
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.fidelity import ENDLESS, WHIRLING
from bearing_sim.scene.mounting import clearance_limits, clearance_source, housing_interference
from bearing_sim.scene.outer_ring import ring_geometry
from bearing_sim.scene.scene import Integration, Scene
from bearing_sim.scene.uncertainty import Range, messages, number_at, quantities, ranges_of, ring_ranges, shown, with_values, without_dimensions
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.studies.batches import answers_at
from bearing_sim.sweep.pictures import new_figure, plain_numbers, save
from bearing_sim.sweep.ring_resonance import ring_resonance
from bearing_sim.sweep.states import states
from bearing_sim.sweep.tasks import IN_MEMORY, Execution
from bearing_sim.sweep.thermal import equilibrium_temperatures

PROBABILITIES = (0.05, 0.50, 0.95)  # below the low end, the middle and the high end of a band
CONFIDENCE = 0.95  # of intervals for the sampling error
_RESAMPLES = 400
_WARMER = 10.0  # K
# Of films and asperities, with their sources.
_MIXED_RANGES = (
    ("lubricant.mixed_friction.boundary_friction", 0.08, 0.15, "uniform", "boundary friction of steel with usual additives"),
    ("lubricant.mixed_friction.film_ratio_factor", 1 / 1.5, 3.0, "log_uniform", "published laws of asperities: 0.8 to 2.2 times"),
    ("lubricant.mixed_friction.skew", 1 / 6, 1.0, "uniform", "assumption: a third to twice the mean skew"),
)


class Design(NamedTuple):
    """Points at which to evaluate.

    Attributes
    ----------
    base : N, a power of two.
    points : in SI, shape ((d + 2) N, d): A, B, then A with each column in turn taken from B; for bands alone A and B, shape (2 N, d).
    """

    base: int
    points: np.ndarray


class Band(NamedTuple):
    """Quantiles of a value, each with a 95 % confidence interval (low, high) for its sampling error."""

    low: float  # 5 % lie below
    middle: float
    high: float  # 95 % lie below
    low_error: tuple[float, float]
    middle_error: tuple[float, float]
    high_error: tuple[float, float]


class Indices(NamedTuple):
    """Sobol' indices of one value, shape (d,), and 95 % confidence intervals of them, shape (d, 2); NaN if the value does not vary.

    first : fraction of the variance that would vanish if this number alone were known.
    total : fraction that would remain if all other numbers were known.
    """

    first: np.ndarray
    total: np.ndarray
    first_error: np.ndarray
    total_error: np.ndarray

    def bounded(self) -> "Indices":
        """Return the indices as they are shown: what no variance allows, 0 <= first <= total <= 1, is brought to the nearest that it does.

        NaN stands for what is not known from so few samples: its interval is wider than `_KNOWN`, or contradicts those bounds.
        """
        ends = np.clip(self.total_error, 0.0, 1.0), np.clip(self.first_error, 0.0, 1.0)
        total = np.clip(self.total, 0.0, 1.0)
        first = np.clip(self.first, 0.0, total)
        above = np.maximum(self.total_error[:, 0] - 1.0, self.first_error[:, 0] - self.total_error[:, 1])
        impossible = np.maximum(above, -self.first_error[:, 1]) > _NO_SHARE
        unknown = [impossible | (np.ptp(error, axis=1) > _KNOWN) for error in (self.first_error, self.total_error)]
        return Indices(np.where(unknown[0], np.nan, first), np.where(unknown[1], np.nan, total), ends[1], ends[0])


_NO_SHARE = 0.02  # of the variance, that nobody misses
_KNOWN = 0.4  # widest 95 % interval of an index that is shown as a number (assumption: an error of a fifth of the variance still orders fields)


def distribution(one: Range, own: float):
    """Return the distribution of a range; ``own``, the scene's value [SI], is the peak of a triangular one without a mode."""
    if one.distribution == "log_uniform":
        return stats.loguniform(one.low, one.high)
    width = one.high - one.low
    if one.distribution == "uniform":
        return stats.uniform(one.low, width)
    mode = one.mode if one.mode is not None else own if one.low <= own <= one.high else 0.5 * (one.low + one.high)
    return stats.triang((mode - one.low) / width, one.low, width)


def design(distributions: Sequence, base: int, seed: int) -> Design:
    """Return the points of a study.

    Parameters
    ----------
    distributions : of each number, with a method ``ppf`` (inverse of the distribution function).
    base : N.
    seed : of the scrambling; the same seed gives the same points.

    Raises
    ------
    ValueError
        ``base`` is not a power of two, which a balanced Sobol' sequence needs.
    """
    if base < 2 or base & (base - 1):
        raise ValueError(f"{base} samples: expected a power of two, 2 or more")
    count = len(distributions)
    uniform = qmc.Sobol(d=2 * count, scramble=True, seed=np.random.default_rng(seed)).random_base2(base.bit_length() - 1)
    drawn = np.stack([one.ppf(uniform[:, column::count]) for column, one in enumerate(distributions)], axis=-1)
    first, second = drawn[:, 0], drawn[:, 1]
    mixed = [np.where(np.arange(count) == column, second, first) for column in range(count)]
    return Design(base, np.concatenate([first, second, *mixed]))


def _design_of(scene: Scene, ranges: Sequence[Range], base: int, seed: int) -> Design:
    """Return the points of a study of ranges about the values of a scene."""
    return design([distribution(one, number_at(scene, one.field)) for one in ranges], base, seed)


def band(values: np.ndarray) -> Band:
    """Return the band of values at the points of a design or at any independent points.

    Sampling errors are those of order statistics of independent draws (binomial).  A Sobol' sequence is more even, so they are
    upper bounds.

    Parameters
    ----------
    values : shape (n,); NaN is ignored, infinite values count.
    """
    ordered = np.sort(values[~np.isnan(values)])
    if not len(ordered):
        return Band(*[np.nan] * 3, *[(np.nan, np.nan)] * 3)
    found = np.quantile(ordered, PROBABILITIES, method="inverted_cdf")
    errors = []
    for probability in PROBABILITIES:
        ranks = stats.binom.ppf([0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], len(ordered), probability).astype(int)
        errors.append(tuple(float(ordered[rank]) for rank in np.clip(ranks - [1, 0], 0, len(ordered) - 1)))
    return Band(*map(float, found), *errors)


def indices(values: np.ndarray, base: int, seed: int) -> Indices:
    """Return the Sobol' indices of a value, with bootstrap intervals.

    Parameters
    ----------
    values : at the points of a `design`, in its order, shape ((d + 2) base,).
    base : N.
    seed : of the bootstrap.

    Raises
    ------
    ValueError
        A value is not finite; without it the design is not balanced.
    """
    if not np.isfinite(values).all():
        raise ValueError(f"{np.count_nonzero(~np.isfinite(values))} of {len(values)} values are not finite; Sobol' indices need finite values")
    parts = values.reshape(-1, base)
    count = len(parts) - 2
    if np.ptp(values) <= 1e-12 * np.abs(values).max():
        return Indices(*[np.full(count, np.nan)] * 2, *[np.full((count, 2), np.nan)] * 2)
    found = _both(parts)
    resampled = stats.bootstrap(
        (np.arange(base),),
        lambda rows: _both(parts[:, rows]),
        vectorized=False,
        n_resamples=_RESAMPLES,
        confidence_level=CONFIDENCE,
        method="percentile",
        rng=np.random.default_rng(seed),
    )
    ends = np.stack(resampled.confidence_interval, axis=-1)
    return Indices(found[0], found[1], ends[0], ends[1])


def _both(parts: np.ndarray) -> np.ndarray:
    """Return first-order and total indices, shape (2, d)."""
    if len(parts) == 3:  # SciPy drops the axis of a single number, which explains all of the variance
        return np.ones((2, 1))
    found = stats.sobol_indices(func={"f_A": parts[:1], "f_B": parts[1:2], "f_AB": parts[2:, None]}, n=parts.shape[1])
    return np.array([np.ravel(found.first_order), np.ravel(found.total_order)])


class Stretches(NamedTuple):
    """Operating conditions of a course, averaged over stretches of time; stretches inside a gap are left out.

    Attributes
    ----------
    middles : mean time of each [s], shape (m,).
    seconds : duration of each without its gaps [s], shape (m,).
    conditions : means over each, columns as the course's, shape (m, 6).
    """

    middles: np.ndarray
    seconds: np.ndarray
    conditions: np.ndarray


def stretches(times: np.ndarray, inputs: np.ndarray, in_gap: np.ndarray, most: int) -> Stretches:
    """Cut a course into stretches of the same length.

    Parameters
    ----------
    times, inputs : instants [s], increasing, shape (n,), and the conditions there, linear in between, shape (n, 6).
    in_gap : whether the interval that ends at an instant is left out, shape (n,).
    most : largest number of stretches.
    """
    edges = np.linspace(times[0], times[-1], most + 1)
    every = np.union1d(times, edges)
    step, middle = np.diff(every), 0.5 * (every[1:] + every[:-1])
    step = np.where(in_gap[np.searchsorted(times, middle)], 0.0, step)
    stretch = np.clip(np.searchsorted(edges, middle) - 1, 0, most - 1)
    seconds = np.bincount(stretch, step, most)
    kept = seconds > 0.0

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(stretch, step * values, most)[kept] / seconds[kept]

    at_middle = [np.interp(middle, times, column) for column in inputs.T]
    return Stretches(mean(middle), seconds[kept], np.stack([mean(column) for column in at_middle], axis=-1))


VALUES = ("cage_slip", "life_hours")
_DURATION, _SAMPLES, _SETTLED = 0.5, 500, 0.2  # s and samples of a run (Deng 2017, 3.3), and the fraction at its end that is averaged
_BATCH = 64  # points of level steady per task, which take milliseconds each; at higher levels each point is a task
_LEAST_FRACTION = 0.01  # of the way to a draw of estimated numbers; below it the scene's own are taken
_ABSENT = 0.05  # largest fraction of points without an answer


class UncertaintyError(ValueError):
    """An uncertainty that cannot be computed; the message says why and what to do."""


class Study(NamedTuple):
    """Results of a study.

    Attributes
    ----------
    level, reason : level of all runs, and why it was chosen.
    ranges : of the d varied fields.
    design : the points of the runs.
    answers : by name (`VALUES`), at the points of the design, shape ((d + 2) N,); NaN without an answer.
    own : by name, the value of the scene itself at that level.
    bands : by name.
    indices : by name; None if a value is not finite at some point, or if none were asked for.
    seconds : of each stretch of the course, shape (m,); one stretch without a course.
    slips : at each point and stretch, shape ((d + 2) N, m).
    """

    level: str
    reason: str
    ranges: tuple[Range, ...]
    design: Design
    answers: dict[str, np.ndarray]
    own: dict[str, float]
    bands: dict[str, Band]
    indices: dict[str, Indices | None]
    seconds: np.ndarray
    slips: np.ndarray

    @property
    def absent(self) -> int:
        """Number of points without an answer."""
        return int(np.isnan(self.answers["cage_slip"]).sum())

    def slip_bands(self) -> list[Band]:
        """Return the band of slip in each stretch of the course, over both samples of the design."""
        return [band(column) for column in self.slips[: 2 * self.design.base].T]


def lowest_level(scene: Scene, level: str | None = None) -> tuple[Scene, str]:
    """Return a scene at the given level or at the lowest level that has everything it asks for, and the reason.

    A scene whose inner ring may vibrate on its rollers stays at its own level: the lower ones have no such motion.

    Raises
    ------
    UncertaintyError
        The scene cannot be computed at that level.
    """
    found = fidelity.choose(replace(scene, integration=Integration()))  # a fixed step would need a level that takes steps
    chosen, reason = (level, "as requested") if level else (found.level or scene.level, found.reason)
    if level is None and scene.level in WHIRLING and chosen not in WHIRLING:
        resonance = ring_resonance(scene)
        if resonance is not None and resonance.may_vibrate:
            chosen, reason = scene.level, f"level {scene.level}, the scene's own: the inner ring may vibrate on its rollers"
    try:
        return scene.at_level(chosen), reason
    except SceneError as error:
        raise UncertaintyError(f"level {chosen}: {'; '.join(each.reason for each in error.errors)}") from None


def varied_ranges(scene: Scene) -> tuple[Range, ...]:
    """Return the ranges that a study at a scene's level varies.

    Those of `ranges_of`, of the ring's motion where the level has it, and of clearance, oil temperature and films where the scene declares none.
    """
    declared = {one.field for one in scene.uncertainty}
    return (*ranges_of(scene), *ring_ranges(scene), *(one for one in _assumed_ranges(scene) if one.field not in declared))


def _assumed_ranges(scene: Scene) -> Iterator[Range]:
    """Yield the ranges of what every bearing in service is uncertain about; none for a scene with full films alone, such as those of the paper."""
    bearing, lubricant = scene.bearing, scene.lubricant
    yield from _bending_ranges(scene)
    if lubricant.starvation.law == lubricant.mixed_friction.law == "none":
        return
    if isinstance(bearing.clearance, str):
        limits = clearance_limits(bearing.clearance, bearing.bore_diameter)
        source = f"group {bearing.clearance} ({clearance_source(bearing.clearance)})"
        yield Range(field="bearing.clearance", low=limits.least, high=limits.largest, source=source)
    if scene.heat.law != "network":
        kelvin = lubricant.temperature
        source = "assumption: the temperature of the oil is known to 10 K"
        yield Range(field="lubricant.temperature", low=kelvin - _WARMER, high=kelvin + _WARMER, source=source)
    constant = replenishment(lubricant, 0.5 * bearing.roller.diameter)
    if constant > 0.0:
        source = "assumption: SKF's constants of sparse and sparser supply are a factor of 2 apart"
        yield Range(
            field="lubricant.starvation.constant", low=0.5 * constant, high=min(2.0 * constant, 1e-6), distribution="log_uniform", source=source
        )
    for field, low, high, shape, source in _MIXED_RANGES if lubricant.mixed_friction.law != "none" else ():
        if low < number_at(scene, field) < high:  # otherwise somebody has chosen it
            yield Range(field=field, low=low, high=high, distribution=shape, source=source)


_UNSURE_PLAY = 2e-6  # m; assumption
_UNSURE_MODULUS = 0.1  # relative; assumption
_THICKNESSES = (0.9, 1.35)  # of the equivalent thickness by wall and ribs


def _bending_ranges(scene: Scene) -> Iterator[Range]:
    """Yield the ranges of what decides how an outer ring bends: play, the housing's modulus and the ring's stiffness; none of a rigid ring."""
    if not scene.outer_ring_bends:
        return
    housing, backing = scene.mounting.housing, scene.mounting.housing.backing
    if scene.bearing.outer_ring.equivalent_thickness is None:
        low, high = (factor * ring_geometry(scene.bearing).equivalent_thickness for factor in _THICKNESSES)
        source = "assumption: by wall and ribs; the ring of Deng 2017 has the D that was measured with 1.3 times as much"
        yield Range(field="bearing.outer_ring.equivalent_thickness", low=low, high=high, source=source)
    if backing.law == "elastic":
        modulus = housing.material.youngs_modulus
        low, high = (1.0 - _UNSURE_MODULUS) * modulus, (1.0 + _UNSURE_MODULUS) * modulus
        yield Range(field="mounting.housing.material.youngs_modulus", low=low, high=high, source="assumption: 10 % to either side")
    if backing.law == "free":
        return
    if backing.play is not None:
        low, high, source = backing.play - _UNSURE_PLAY, backing.play + _UNSURE_PLAY, "assumption: 2 um to either side"
        yield Range(field="mounting.housing.backing.play", low=low, high=high, source=source)
    elif housing.fit is not None:
        limits = housing_interference(housing, scene.bearing.outside_diameter)
        source = f"limits of {housing.fit} (ISO 286) and of the ring (ISO 492)"
        yield Range(field="mounting.housing.interference", low=limits.least, high=limits.largest, source=source)


def filled_in(scene: Scene) -> Scene:
    """Return a scene with numbers where it has names or nothing, for fields of `varied_ranges`.

    The mean of a clearance group and of a housing's fit, the supply's K_rs, the equivalent thickness of an outer ring.
    """
    values, (bearing, law) = {}, (scene.bearing, scene.lubricant.starvation)
    if scene.outer_ring_bends and bearing.outer_ring.equivalent_thickness is None:
        values["bearing.outer_ring.equivalent_thickness"] = ring_geometry(bearing).equivalent_thickness
    if scene.outer_ring_bends and scene.mounting.housing.fit is not None:
        mean = housing_interference(scene.mounting.housing, bearing.outside_diameter).mean
        values |= {"mounting.housing.fit": None, "mounting.housing.interference": mean}
    if isinstance(bearing.clearance, str):
        values["bearing.clearance"] = clearance_limits(bearing.clearance, bearing.bore_diameter).mean
    if law.law != "none" and law.constant is None:
        values["lubricant.starvation.constant"] = replenishment(scene.lubricant, 0.5 * bearing.roller.diameter)
    return with_values(scene, values) if values else scene


def rounded_up(samples: int) -> int:
    """Return the size of a sample of a study, a power of two, for a number of samples that somebody asks for."""
    return 1 << max(samples - 1, 1).bit_length()


def study(
    scene: Scene, base: int, seed: int, *, shares: bool = True,
    level: str | None = None, course: tuple[np.ndarray, np.ndarray] | None = None, execution: Execution = IN_MEMORY,
) -> Study:  # fmt: skip
    """Return bands and Sobol' indices of slip and life.

    Parameters
    ----------
    scene : with ranges in its block ``uncertainty``, or with a bearing that has estimated fields.
    base : N, a power of two; the study computes N (d + 2) points.
    seed : of the design.
    shares : whether to compute the indices; bands alone take 2 N points.
    level : to use instead of the lowest possible one.
    course : successive conditions, columns as `Inputs`, shape (m, 6), with NaN for the scene's own oil temperature, and the duration
        of each [s], shape (m,); None: the scene's own conditions.  With a course, slip is the mean over time and life that under the
        repeated course.
    execution : see `bearing_sim.sweep.tasks.Execution`.

    Raises
    ------
    UncertaintyError
        The scene has no ranges, a range excludes the scene's own value, numbers within the ranges contradict each other, or too many
        points have no answer.
    ClusterError
        See `bearing_sim.sweep.tasks.run_tasks`.
    """
    scene, reason = lowest_level(scene, level)
    ranges, scene = varied_ranges(scene), filled_in(scene)
    _check(scene, ranges, course is not None)
    conditions, seconds = course if course is not None else (None, np.ones(1))
    designed = _design_of(scene, ranges, base, seed)
    if not shares:
        designed = designed._replace(points=designed.points[: 2 * base])
    own = settled(varied(scene, {}), conditions)
    found = answers_at(
        [designed.points],
        settled_batch,
        (scene, tuple(one.field for one in ranges), None if conditions is None else tuple(map(tuple, conditions.tolist()))),
        {"settled": [[math.nan] * len(seconds)] * 2},
        scene.level,
        _BATCH if scene.level == "steady" else 1,
        execution,
    )["settled"]
    answers = dict(zip(VALUES, _over_course(found, seconds)))
    absent = int(np.isnan(answers["cage_slip"]).sum())
    if absent > _ABSENT * len(found):
        raise UncertaintyError(f"{absent} of {len(found)} points have no answer at level {scene.level}; narrow the ranges, or choose another level")
    both = slice(0, 2 * base)
    return Study(
        scene.level,
        reason,
        ranges,
        designed,
        answers,
        {name: float(value[0]) for name, value in zip(VALUES, _over_course(own[None], seconds))},
        {name: band(answers[name][both]) for name in VALUES},
        {name: indices(answers[name], base, seed) if shares and np.isfinite(answers[name]).all() else None for name in VALUES},
        seconds,
        found[:, 0],
    )


def settled_batch(
    scene: Scene, fields: tuple[str, ...], conditions: tuple[tuple[float, ...], ...] | None, points: tuple[tuple[float, ...], ...]
) -> dict:
    """Return `settled` of a scene at several points, as lists under the key ``settled``.

    Parameters
    ----------
    scene, conditions : see `settled`.
    fields : dotted paths.
    points : numbers of the fields [SI], one tuple per point.
    """
    asked = None if conditions is None else np.array(conditions)
    return {"settled": [settled(varied(scene, dict(zip(fields, point))), asked).tolist() for point in points]}


def _check(scene: Scene, ranges: Sequence[Range], on_course: bool) -> None:
    if not ranges:
        raise UncertaintyError(
            "the scene has no uncertain fields; give ranges in its block `uncertainty`, such as "
            '--set "uncertainty.lubricant.mixture_fraction=[0.015, 0.05]"'
        )
    for one in scene.uncertainty:
        own, declared = number_at(scene, one.field), quantities(type(scene))[one.field]
        if on_course and one.field.startswith("operating."):
            raise UncertaintyError(
                f"uncertainty.{one.field}: speed and load come from the log; remove the range (--set uncertainty.{one.field}=null)"
            )
        if not one.low <= own <= one.high:
            wider = f"[{declared.show(min(own, one.low))}, {declared.show(max(own, one.high))}]"
            raise UncertaintyError(
                f"uncertainty.{one.field}: {declared.show(one.low)} to {declared.show(one.high)} excludes the scene's own value, "
                f"{declared.show(own)}; "
                f'give another range, such as --set "uncertainty.{one.field}={wider}"'
            )


def varied(scene: Scene, values: dict[str, float]) -> Scene:
    """Return a scene with other numbers; estimated ones whose parts do not fit together are drawn towards the scene's own until they do.

    The rollers' length follows a draw of their number and diameter so that the static rating stays, from which it was estimated.
    """
    declared = {one.field for one in scene.uncertainty}
    own = {path: number_at(scene, path) for path in values if path not in declared}
    fraction = 1.0
    while True:
        tried = {path: value if path in declared else own[path] + fraction * (value - own[path]) for path, value in values.items()}
        try:
            return with_values(scene, _with_kept_rating(scene, tried, own))
        except ValidationError as error:
            fraction = 0.5 * fraction if fraction > _LEAST_FRACTION else 0.0
            if not own or tried == {**values, **own}:
                known = quantities(type(scene))
                numbers = ", ".join(f"{path} = {shown(known, path, value)}" for path, value in values.items())
                raise UncertaintyError(f"numbers within the ranges contradict each other ({numbers}): {messages(error)}; narrow the ranges") from None


def _with_kept_rating(scene: Scene, values: dict[str, float], estimated: dict[str, float]) -> dict[str, float]:
    """Return values with a whole number of rollers, and with lengths for which Z L D_w (1 - gamma) stays where these are all estimated."""
    roller, pitch = scene.bearing.roller, scene.bearing.pitch_diameter
    count, diameter, length = (f"bearing.roller.{name}" for name in ("count", "diameter", "length"))
    values = {path: round(value) if path == count else value for path, value in values.items()}
    if length not in estimated or not {count, diameter} & estimated.keys():
        return values
    inner = pitch - roller.diameter
    width = values.get(diameter, roller.diameter)
    before = roller.count * roller.diameter * (1.0 - roller.diameter / pitch)
    after = values.get(count, roller.count) * width * (1.0 - width / (inner + width))
    return {**values, length: values[length] * before / after}


def largest_slip(scene: Scene, inputs: Inputs, draws: int = 8, seed: int = 1) -> float:
    """Return the largest slip of the cage in any state of a bearing, its own and those of draws of its uncertain fields, by level steady.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions.
    draws : number of them, a power of two.
    seed : of the draws.

    Raises
    ------
    IntegrationError
        No state was found.
    """
    scene = scene.at_level("steady")
    ranges, scene = varied_ranges(scene), filled_in(scene)
    points = _design_of(scene, ranges, draws, seed).points[:draws] if ranges else ()
    scenes = [scene, *(varied(scene, dict(zip([one.field for one in ranges], point))) for point in points)]
    found = [state.cage_slip for each in scenes for state in states(each, inputs, skid_load=False).found]
    if not found:
        raise IntegrationError("no state of the bearing was found under these conditions")
    return max(found)


def settled(scene: Scene, conditions: np.ndarray | None = None) -> np.ndarray:
    """Return settled cage slip and life [h], shape (2, m); NaN where a run failed, or where there is no thermal equilibrium.

    With a thermal network the bearing has the temperatures of its equilibrium at level steady.

    Parameters
    ----------
    scene : at its own level.
    conditions : columns as `Inputs`, shape (m, 6); None: the scene's own.
    """
    kelvin = scene.lubricant.temperature
    asked = [scene_inputs(scene)] if conditions is None else [Inputs(*row) for row in conditions.tolist()]
    simulation, found = None, np.full((2, len(asked)), math.nan)
    for k, inputs in enumerate(asked):
        inputs = inputs if math.isfinite(inputs.oil_temperature) else inputs._replace(oil_temperature=kelvin)
        try:
            if simulation is None:
                simulation = Simulation(scene, inputs, empty_table() if scene.level == "steady" else None)
            else:
                simulation.reset(inputs)
            if simulation.thermal is not None:
                simulation.set_temperatures(equilibrium_temperatures(scene, inputs))
            found[:, k] = _settled_at(simulation)
        except IntegrationError:
            continue
    return found


def _settled_at(simulation: Simulation) -> tuple[float, float]:
    steady = simulation.scene.level == "steady"
    length, samples = (ENDLESS, 2) if steady else (_DURATION, _SAMPLES)
    block = simulation.advance(length, samples=samples)
    first = 0 if steady else round((1 - _SETTLED) * samples) - 1
    damage, elapsed = float(block["damage"][-1] - block["damage"][first]), float(block["time"][-1] - block["time"][first])
    return float(block["cage_slip"][first + 1 :].mean()), elapsed / 3600 / damage if damage > 0.0 else math.inf


def _over_course(found: np.ndarray, seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return mean slip over time and life under the course (Palmgren, Miner) from slip and life in each stretch."""
    weights = seconds / seconds.sum()
    with np.errstate(divide="ignore"):
        return found[:, 0] @ weights, 1.0 / ((1.0 / found[:, 1]) @ weights)


_SLIP, _LIFE, _FIRST, _TOTAL = "#0072b2", "#009e73", "#56b4e9", "#0072b2"  # Okabe and Ito: safe for colour-blind readers
_FEWEST_BINS, _MOST_BINS = 8, 40


def plot_uncertainty(path: Path, title: str, found: Study, life: str, times: np.ndarray | None = None) -> None:
    """Draw distributions, indices and the slip over a course into a file.  Shares of the variance are those of `Indices.bounded`.

    Parameters
    ----------
    path : its suffix gives the format.
    title : of the picture.
    found : the study.
    life : name of the life, such as ``modified rating life L_nmr``.
    times : of the stretches of its course [s], shape (m,); None without a course.
    """
    layout, heights = [["slip", "life"], ["slip indices", "life indices"]], [4.4, max(1.4 + 0.34 * len(found.ranges), 3.0)]
    slip, over = "cage slip [%]", ""
    if times is not None:
        layout, heights, slip, over = [*layout, ["course", "course"]], [*heights, 4.0], f"mean {slip}", " under the course"
    figure = new_figure(13, sum(heights))
    axes = figure.subplot_mosaic(layout, height_ratios=heights)
    life = f"{life}{over} [h]{without_dimensions(one.field for one in found.ranges)}"
    for short, name, scale, label, colour in (("slip", "cage_slip", 100.0, slip, _SLIP), ("life", "life_hours", 1.0, life, _LIFE)):
        _draw_distribution(axes[short], found, name, scale, label, colour)
        _draw_indices(axes[f"{short} indices"], found, name, short)
    if times is not None:
        _draw_course(axes["course"], found, times)
    save(figure, path, title)


def _draw_distribution(axes, found, name, scale, label, colour) -> None:
    from matplotlib.ticker import MaxNLocator

    values, band, own = scale * found.answers[name][: 2 * found.design.base], found.bands[name], scale * found.own[name]
    values = values[np.isfinite(values)]
    bins, weights = int(np.clip(1.5 * np.sqrt(len(values)), _FEWEST_BINS, _MOST_BINS)), np.full(len(values), 100.0 / max(len(values), 1))
    axes.hist(values, bins=bins, weights=weights, color=colour, alpha=0.6)
    axes.axvspan(scale * band.low, scale * band.high, color=colour, alpha=0.12, lw=0)
    for end, text in ((band.low, "5 %"), (band.middle, "50 %"), (band.high, "95 %")):
        axes.axvline(scale * end, color=colour, lw=1.5, ls="-" if text == "50 %" else "--", label=f"{text} below {display.number(scale * end)}")
    axes.axvline(own, color="black", lw=1, ls=":", label=f"the scene's own values: {display.number(own)}")
    axes.set(xlabel=label, ylabel="share of the samples [%]")
    axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 2.5, 5, 10]))
    plain_numbers(axes.xaxis, axes.yaxis)
    axes.legend(fontsize=9, frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _draw_indices(axes, found, name, varied) -> None:
    raw = found.indices[name]
    if raw is None or np.isnan(raw.total).all():
        axes.text(0.5, 0.5, "does not vary" if raw is not None else "not finite everywhere", ha="center", transform=axes.transAxes)
        axes.axis("off")
        return
    order = np.argsort(raw.total)
    sobol, positions = raw.bounded(), np.arange(len(order))
    for offset, value, error, colour, text in (
        (0.2, sobol.first, sobol.first_error, _FIRST, "alone (first order)"),
        (-0.2, sobol.total, sobol.total_error, _TOTAL, "with its interactions (total)"),
    ):
        value, error = 100.0 * value[order], 100.0 * error[order]
        axes.barh(positions + offset, np.nan_to_num(value), height=0.36, color=colour, label=text)
        middle = error.mean(axis=1)
        axes.errorbar(middle, positions + offset, xerr=middle - error[:, 0], fmt="none", ecolor="0.3", capsize=2, lw=1.2)
        for place in np.flatnonzero(np.isnan(value)):
            axes.text(102.0, positions[place] + offset, "?", va="center", fontsize=8, color="0.3")
    axes.set_yticks(positions, [display.shown(found.ranges[k].field).name for k in order])
    unknown = f"\n?: not known from {found.design.base} samples" if np.isnan([sobol.first, sobol.total]).any() else ""
    axes.set(xlabel=f"share of the variance of {varied} [%], with 95 % intervals{unknown}", xlim=(-2.0, 107.0), xticks=range(0, 101, 20))
    axes.axvline(0.0, color="0.3", lw=0.8)
    axes.legend(frameon=False, fontsize=9, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)


def _draw_course(axes, found, times) -> None:
    low, middle, high = 100.0 * np.array([one[:3] for one in found.slip_bands()]).T
    axes.fill_between(times, low, high, color=_SLIP, alpha=0.25, label="5 to 95 %")
    axes.plot(times, middle, color=_SLIP, label="50 %")
    axes.set(xlabel="time [s]", ylabel="cage slip [%]", ylim=(0, None))
    axes.legend(frameon=False, fontsize=9)
