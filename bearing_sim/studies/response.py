# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Settled points over operating points and uncertain fields, from which the response of a bearing is fitted, and against which it is held."""

import math
import time
from collections.abc import Callable

import numpy as np
from scipy.special import ndtri
from scipy.stats import qmc

from bearing_sim.estimation.response import (
    ANSWERS,
    ResponseModel,
    conditions_at,
    domain_of,
    fit_response,
    kept_response,
    response_path,
    scene_fields,
    write_response,
)
from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation
from bearing_sim.studies.uncertainty import UncertaintyError, varied
from bearing_sim.sweep.tasks import Journal, run_tasks, task

_POINTS = 8192  # that a response is fitted to, a power of two
_BATCH = 64  # points of a task
_LONG = 1e4  # s; longer than any lag of a cage; at level steady simulated time costs nothing
_EQUAL, _BALANCED = 0.02, 1e-3  # K, and of the shaft power; slip then errs by less than 0.01 points
_TEMPERATURE = "lubricant.temperature"


def settled_points(scene: Scene, fields: tuple[str, ...], points: tuple[tuple[float, ...], ...], conditions: tuple[tuple[float, ...], ...]) -> dict:
    """Return the settled answers of level ``steady``, lists of `bearing_sim.estimation.response.ANSWERS` under the key ``answers``.

    Parameters
    ----------
    scene : of any level.
    fields : dotted paths of uncertain fields.
    points : their values [SI] at each point.
    conditions : columns `bearing_sim.estimation.response.CONDITIONS`.  An uncertain oil temperature is an error of the one in the conditions:
        the value's difference from the scene's own is added to it.
    """
    answers, starts = [], {}
    for values, condition in zip(points, conditions):
        named = dict(zip(fields, values))
        speed, load, kelvin, angle = condition
        kelvin += named.pop(_TEMPERATURE, scene.lubricant.temperature) - scene.lubricant.temperature
        inputs = Inputs(speed, load * math.cos(angle), load * math.sin(angle), kelvin)
        try:
            answers.append(_settled(varied(scene, named), inputs, condition, starts).tolist())
        except (IntegrationError, UncertaintyError, ValueError):
            answers.append([math.nan] * len(ANSWERS))
    return {"answers": answers}


def _settled(scene: Scene, inputs: Inputs, condition: tuple[float, ...], starts: dict) -> np.ndarray:
    """Return the answers of one point; ``starts`` keeps temperatures of equilibrium by condition, from which the next search begins."""
    simulation = Simulation(scene, inputs, empty_table())
    if simulation.thermal is not None:
        found = thermal_equilibrium(scene, inputs, starts.get(condition), _EQUAL, _BALANCED)
        if not found.converged:
            raise IntegrationError(found.reason)
        starts[condition] = found.temperatures
        simulation.set_temperatures(found.temperatures)
    sample = simulation.advance(_LONG, samples=2)[-1]
    return np.array([float(sample[name]) for name in ANSWERS])


def at_points(
    scene: Scene, scores: np.ndarray, conditions: np.ndarray, journal: Journal | None = None, workers: int | None = None, dask: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> np.ndarray:  # fmt: skip
    """Return settled answers at points, shape (n, 6); NaN where there is none.

    Parameters
    ----------
    scene : of any level.
    scores : of its uncertain fields, shape (n, d).
    conditions : columns `bearing_sim.estimation.response.CONDITIONS`, shape (n, 4).
    journal, workers, dask : see `bearing_sim.sweep.tasks.run_tasks`.
    progress : called with the number of finished points and of all that are not in the journal.
    """
    scene, fields = scene.at_level("steady"), scene_fields(scene)
    names, values = tuple(one.field for one in fields.ranges), fields.values_of(scores)
    tasks = [
        task(
            "steady",
            settled_points,
            scene,
            names,
            tuple(map(tuple, values[first : first + _BATCH].tolist())),
            tuple(map(tuple, conditions[first : first + _BATCH].tolist())),
        )
        for first in range(0, len(scores), _BATCH)
    ]
    results = run_tasks(tasks, Journal() if journal is None else journal, workers, dask, lambda done, total: progress(_BATCH * done, _BATCH * total))
    nothing = [math.nan] * len(ANSWERS)
    return np.concatenate([result.get("answers", [nothing] * len(each.arguments[2])) for each, result in zip(tasks, results)])


def design(scene: Scene, count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return operating points, shape (count, 4), and scores of the fields, shape (count, d), evenly spread together; ``count`` a power of two."""
    fields = scene_fields(scene)
    uniform = qmc.Sobol(d=4 + len(fields), scramble=True, seed=np.random.default_rng(seed)).random_base2(count.bit_length() - 1)
    return conditions_at(uniform[:, :4], domain_of(scene)), ndtri(np.clip(uniform[:, 4:], 1e-6, 1.0 - 1e-6))


def obtain_response(
    scene: Scene, workers: int | None = None, dask: str | None = None, progress: Callable[[int, int], None] = lambda done, total: None,
    rebuild: bool = False, points: int = _POINTS,
) -> ResponseModel:  # fmt: skip
    """Return the response of a scene, from disk or built and kept there; an interrupted build resumes from its journal.

    Parameters
    ----------
    scene : its level does not matter.
    workers, dask : see `bearing_sim.sweep.tasks.run_tasks`.
    progress : called with the number of finished points and of all that are not in the journal.
    rebuild : whether to build it even if there is one.
    points : to fit it to, a power of two.

    Raises
    ------
    UncertaintyError
        The scene has no uncertain fields.
    ClusterError, JournalInUse
        See `bearing_sim.sweep.tasks`.
    """
    fields, path = scene_fields(scene), response_path(scene)
    if not len(fields):
        raise UncertaintyError(
            "the scene has no uncertain fields, so there is no band; give ranges in its block `uncertainty`, such as "
            '--set "uncertainty.lubricant.mixture_fraction=[0.015, 0.05]"'
        )
    found = None if rebuild else kept_response(scene)
    if found is None:
        began = time.perf_counter()
        conditions, scores = design(scene, points)
        with Journal(path.with_suffix(".journal")) as journal:
            answers = at_points(scene, scores, conditions, journal, workers, dask, progress)
        found = fit_response(fields, domain_of(scene), conditions, scores, answers, time.perf_counter() - began)
        write_response(path, found)
        path.with_suffix(".journal").unlink(missing_ok=True)
    return found
