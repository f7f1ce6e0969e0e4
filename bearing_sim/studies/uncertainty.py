# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Slip and life of a scene whose uncertain fields may be anything within their ranges, and which of them that comes from.

Fields are taken as independent of each other.  Every point of the design is computed anew at the cheapest level that has all
that the scene asks for: at level ``steady`` an operating point is solved for, dearer levels march until they have settled.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from pydantic import ValidationError

from bearing_sim import effects
from bearing_sim.levels.steady_table import empty_table
from bearing_sim.scene import Scene
from bearing_sim.scene_uncertainty import Range, quantities, value_at, with_values
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs
from bearing_sim.studies.sensitivity import Band, Design, Indices, band, design, distribution, indices
from bearing_sim.sweep.executor import run_tasks
from bearing_sim.sweep.journal import Journal
from bearing_sim.sweep.tasks import task

VALUES = ("cage_slip", "life_hours")
_MARCH, _SAMPLES, _SETTLED = 0.5, 500, 0.2  # s and samples of a march (Deng 2017, 3.3), and the share at its end that counts
_ENDLESS = 1e4  # s; longer than any lag of a cage at level steady, where time costs nothing
_LOT = 64  # points of level steady, milliseconds each, that go to a worker together; of dearer levels each goes alone
_ABSENT = 0.05  # share of points without an answer beyond which there are no bands


class UncertaintyError(ValueError):
    """Uncertainty that cannot be computed; the message says why and what to do."""


class Study(NamedTuple):
    """What came of a study.

    Attributes
    ----------
    level, reason : at which everything was computed, and why.
    ranges : of the fields that were varied, d of them.
    design : where it was computed.
    answers : by name (`VALUES`), at the points of the design, shape ((d + 2) N,); NaN where there is none.
    own : by name, the value of the scene itself, at that level.
    bands : by name.
    indices : by name; None where a value is not finite at all points.
    seconds : of each stretch of the course, shape (m,); one stretch where there is no course.
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
        """Points without an answer."""
        return int(np.isnan(self.answers["cage_slip"]).sum())

    def slip_bands(self) -> list[Band]:
        """Return the band of slip in each stretch of the course, over both samples of the design."""
        return [band(column) for column in self.slips[: 2 * self.design.base].T]


def cheapest_level(scene: Scene, level: str | None = None) -> tuple[Scene, str]:
    """Return a scene at the cheapest level that has all it asks for, or at a level asked for, and why.

    Raises
    ------
    UncertaintyError
        The scene cannot be at that level.
    """
    found = effects.choose(scene)
    chosen, reason = (level, "as asked for") if level else (found.level or scene.level, found.reason)
    if chosen == scene.level:
        return scene, reason
    try:
        # What says how the scene's own level is integrated means nothing at another.
        own = {name: getattr(scene, name) for name in scene.__dataclass_fields__} | {"level": chosen, "level_reason": ""}
        return Scene(**own | {"integration": type(scene.integration)()}), reason
    except ValidationError as error:
        raise UncertaintyError(f"level {chosen}: {_told(error)}") from None


def study(
    scene: Scene, base: int, seed: int, *,
    level: str | None = None, course: tuple[np.ndarray, np.ndarray] | None = None, journal: Journal | None = None,
    workers: int | None = None, dask: str | None = None, tell: Callable[[int, int], None] = lambda done, pending: None,
) -> Study:  # fmt: skip
    """Return bands and Sobol' indices of slip and life.

    Parameters
    ----------
    scene : with ranges in its block ``uncertainty``.
    base : N, a power of two; the bearing is computed at N (d + 2) points.
    seed : of the design.
    level : instead of the cheapest that will do.
    course : conditions one after the other, columns as `Inputs`, shape (m, 4), an oil temperature of NaN standing for the scene's,
        and how long each lasts [s], shape (m,); the scene's own conditions where absent.  Slip is then the mean over time, life that
        under the repeated course.
    journal : of finished points, which are not computed again; in memory where absent.
    workers, dask : see `bearing_sim.sweep.executor.run_tasks`.
    tell : takes how many of the points that are not in the journal are done, and how many there are.

    Raises
    ------
    UncertaintyError
        The scene has no ranges, one of them leaves out the scene's own value, numbers in their ranges do not fit together, or too many
        points have no answer.
    ClusterError
        See `bearing_sim.sweep.executor.run_tasks`.
    """
    scene, reason = cheapest_level(scene, level)
    ranges = scene.uncertainty
    _check(scene, course is not None)
    conditions, seconds = course if course is not None else (None, np.ones(1))
    lots = design([distribution(one, value_at(scene, one.field)) for one in ranges], base, seed)
    own = settled(_varied(scene, {}), conditions)
    kept = Journal() if journal is None else journal
    found = _at_points(scene, [one.field for one in ranges], lots.points, conditions, len(seconds), kept, workers, dask, tell)
    answers = dict(zip(VALUES, _over_course(found, seconds)))
    absent = int(np.isnan(answers["cage_slip"]).sum())
    if absent > _ABSENT * len(found):
        raise UncertaintyError(f"{absent} of {len(found)} points have no answer at level {scene.level}; narrow the ranges, or ask for another level")
    both = slice(0, 2 * base)
    return Study(
        scene.level,
        reason,
        ranges,
        lots,
        answers,
        {name: float(value[0]) for name, value in zip(VALUES, _over_course(own[None], seconds))},
        {name: band(answers[name][both]) for name in VALUES},
        {name: indices(answers[name], base, seed) if np.isfinite(answers[name]).all() else None for name in VALUES},
        seconds,
        found[:, 0],
    )


def _at_points(scene, fields, points, conditions, stretches, journal, workers, dask, tell) -> np.ndarray:
    """Return what `settled` says at each point, shape (points, 2, stretches)."""
    size = _LOT if scene.level == "steady" else 1
    asked = None if conditions is None else tuple(map(tuple, conditions.tolist()))
    parts = [points[first : first + size] for first in range(0, len(points), size)]
    tasks = [task(scene.level, settled_lot, scene, tuple(fields), tuple(map(tuple, part.tolist())), asked) for part in parts]
    results = run_tasks(tasks, journal, workers, dask, lambda done, pending: tell(*(min(size * lots, len(points)) for lots in (done, pending))))
    nothing = [[math.nan] * stretches] * 2
    return np.concatenate([result.get("settled", [nothing] * len(part)) for part, result in zip(parts, results)])


def settled_lot(
    scene: Scene, fields: tuple[str, ...], points: tuple[tuple[float, ...], ...], conditions: tuple[tuple[float, ...], ...] | None
) -> dict:
    """Return under ``settled`` what `settled` says of a scene with other numbers, as lists.

    Parameters
    ----------
    scene, conditions : see `settled`.
    fields : dotted paths.
    points : their numbers [SI], point by point.
    """
    asked = None if conditions is None else np.array(conditions)
    return {"settled": [settled(_varied(scene, dict(zip(fields, point))), asked).tolist() for point in points]}


def _check(scene: Scene, on_course: bool) -> None:
    if not scene.uncertainty:
        raise UncertaintyError(
            "the scene says nothing of what is uncertain; give its block `uncertainty` ranges, such as "
            '--set "uncertainty.lubricant.mixture_fraction=[0.015, 0.05]"'
        )
    for one in scene.uncertainty:
        own, declared = value_at(scene, one.field), quantities(type(scene))[one.field]
        if on_course and one.field.startswith("operating."):
            raise UncertaintyError(
                f"uncertainty.{one.field}: speed and load come from the log; take the range away (--set uncertainty.{one.field}=null)"
            )
        if not one.low <= own <= one.high:
            wider = f"[{declared.show(min(own, one.low))}, {declared.show(max(own, one.high))}]"
            raise UncertaintyError(
                f"uncertainty.{one.field}: {declared.show(one.low)} to {declared.show(one.high)} leaves out the scene's own {declared.show(own)}; "
                f'give another range, such as --set "uncertainty.{one.field}={wider}"'
            )


def _varied(scene: Scene, values: dict[str, float]) -> Scene:
    try:
        return with_values(scene, values)
    except ValidationError as error:
        told = ", ".join(f"{path} = {quantities(type(scene))[path].show(value)}" for path, value in values.items())
        raise UncertaintyError(f"numbers within the ranges do not fit together ({told}): {_told(error)}; narrow the ranges") from None


def _told(error: ValidationError) -> str:
    return "; ".join(fault["msg"].removeprefix("Value error, ") for fault in error.errors())


def settled(scene: Scene, conditions: np.ndarray | None = None) -> np.ndarray:
    """Return cage slip and life [h] where the bearing has settled, shape (2, m); NaN where it could not be computed.

    Parameters
    ----------
    scene : with its level.
    conditions : columns as `Inputs`, shape (m, 4); the scene's own where absent.
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
            found[:, k] = _settled_at(simulation)
        except IntegrationError:
            continue
    return found


def _settled_at(simulation: Simulation) -> tuple[float, float]:
    steady = simulation.scene.level == "steady"
    length, samples = (_ENDLESS, 2) if steady else (_MARCH, _SAMPLES)
    block = simulation.advance(length, samples=samples)
    first = 0 if steady else round((1 - _SETTLED) * samples) - 1
    damage, elapsed = float(block["damage"][-1] - block["damage"][first]), float(block["time"][-1] - block["time"][first])
    return float(block["cage_slip"][first + 1 :].mean()), elapsed / 3600 / damage if damage > 0.0 else math.inf


def _over_course(found: np.ndarray, seconds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean slip over time, and the life under the course (Palmgren, Miner), from what each stretch has."""
    shares = seconds / seconds.sum()
    with np.errstate(divide="ignore"):
        return found[:, 0] @ shares, 1.0 / ((1.0 / found[:, 1]) @ shares)
