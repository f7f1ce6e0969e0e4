# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Settled points over operating points and uncertain fields, from which the response of a bearing is fitted, and against which it is held."""

import math
import time

import numpy as np
from scipy.stats import qmc

from bearing_sim.files.kept import kept_if_possible
from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.physics.thermal_network import NODES
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation
from bearing_sim.studies.batches import answers_at
from bearing_sim.studies.uncertainty_propagation import UncertaintyError, varied
from bearing_sim.sweep.tasks import IN_MEMORY, Execution, Journal
from bearing_sim.watchers.estimation.bands import prior_draws
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import (
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

DRAWS = 64  # of the fields' scores at each operating point, the scene's own values among them
_POINTS = 16_384  # that a response is fitted to, a power of two
_BATCH = 64  # points of a task
_LONG = 1e4  # s; longer than any lag of a cage; at level steady simulated time costs nothing
_NEAR = 0.05  # K: where the search of the level's equilibrium ends, and rounds go on
_EQUAL, _EQUAL_PART = 2e-3, 0.01  # K, and of the range of temperatures: losses of one operating point scatter by about that with its temperatures
_ROUNDS, _FARTHEST = 12, 60.0  # of losses and temperatures in turn, and K of one
_TELLING, _DECISIVE = 10.0, 0.1  # times that, the least step that teaches how temperatures feed back; least part of it that the update must see
_STRETCH, _STRETCHES, _SAME_SLIP = 0.5, 40, 1e-4  # s, largest number, and difference of successive mean slips of a level that moves
_SPARE = 4  # points more than coefficients from which on equilibria are expected by a fit
_FITTED = 96  # points at most of that fit
_OIL_TEMPERATURE = "lubricant.temperature"


def settled_points(scene: Scene, fields: tuple[str, ...], points: tuple[tuple[float, ...], ...], conditions: tuple[tuple[float, ...], ...]) -> dict:
    """Return the settled answers of level ``steady``, lists of `bearing_sim.watchers.estimation.response.ANSWERS` under the key ``answers``.

    Parameters
    ----------
    scene : its level is that of slip; all else is of level ``steady``.
    fields : dotted paths of uncertain fields.
    points : their values [SI] at each point.
    conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`.  An uncertain oil temperature is an error of the one in the
        conditions: the value's difference from the scene's own is added to it.
    """
    answers: list[list[float]] = []
    equilibria: dict[tuple[float, ...], _Equilibria] = {}
    for values, condition in zip(points, conditions):
        named = dict(zip(fields, values))
        speed, load, kelvin, angle = condition
        kelvin += named.pop(_OIL_TEMPERATURE, scene.lubricant.temperature) - scene.lubricant.temperature
        inputs = Inputs(speed, load * math.cos(angle), load * math.sin(angle), kelvin)
        nearby = equilibria.setdefault(condition, _Equilibria())
        try:
            answers.append(_settled(varied(scene, named), inputs, values, nearby).tolist())
        except (IntegrationError, UncertaintyError, ValueError):
            answers.append([math.nan] * len(ANSWERS))
    return {"answers": answers}


class _Equilibria:
    """Equilibrium temperatures at one operating point for several values of the uncertain fields, and where to look for the next."""

    def __init__(self):
        self._values: list[tuple[float, ...]] = []
        self._nodes: list[np.ndarray] = []
        self.forget_feedback()

    def add(self, values: tuple[float, ...], nodes: np.ndarray) -> None:
        """Add the temperatures of the nodes [K] at values of the fields."""
        if len(self._nodes) < _FITTED:
            self._values.append(values)
            self._nodes.append(nodes)

    def expected(self, values: tuple[float, ...]) -> np.ndarray | None:
        """Return the temperatures expected at values: a fit linear in them, with their squares where enough points are known; None where none is."""
        if not self._nodes:
            return None
        if len(self._nodes) < len(values) + _SPARE:
            return self._nodes[0]
        known, nodes = np.array(self._values), np.array(self._nodes)
        centre, spread = known.mean(axis=0), known.std(axis=0)
        spread[spread == 0.0] = 1.0
        terms = (np.concatenate([known, [values]]) - centre) / spread
        if len(self._nodes) >= 2 * len(values) + _SPARE:
            terms = np.concatenate([terms, np.square(terms)], axis=1)
        terms = np.concatenate([np.ones((len(terms), 1)), terms], axis=1)
        return terms[-1] @ np.linalg.lstsq(terms[:-1], nodes)[0]

    def forget_feedback(self) -> None:
        """Take temperatures to change no losses, until `learn` tells more."""
        self._inverse = np.eye(NODES)

    def step(self, change: np.ndarray) -> np.ndarray:
        """Return by how much temperatures are off [K] that lead to losses whose temperatures differ by a change [K], to first order."""
        return self._inverse @ change

    def learn(self, step: np.ndarray, closed: np.ndarray) -> None:
        """Take that a step of the temperatures [K] has lessened the change by ``closed`` [K] (C. G. Broyden, Math. Comput. 19 (1965) 577)."""
        expected = self._inverse @ closed
        seen = float(step @ expected)
        if seen > _DECISIVE * float(step @ step):
            self._inverse = self._inverse + np.outer(step - expected, step @ self._inverse) / seen


def _settled(scene: Scene, inputs: Inputs, values: tuple[float, ...], nearby: _Equilibria) -> np.ndarray:
    """Return the answers of one point, and add its equilibrium to those ``nearby``, from which the search for it begins."""
    steady = scene.at_level("steady")
    if scene.heat.law == "network":
        start = nearby.expected(values)
        simulation = Simulation(steady, inputs, empty_table(), nodes=start)
        sample = _in_equilibrium(simulation, start, nearby)
        nearby.add(values, simulation.thermal.temperatures.copy())
    else:
        simulation = Simulation(steady, inputs, empty_table())
        sample = simulation.advance(_LONG, samples=2)[-1]
    answers = np.array([float(sample[name]) for name in ANSWERS])
    if scene.level != "steady":
        answers[ANSWERS.index("cage_slip")] = _moving_slip(scene, inputs, simulation)
    return answers


def _moving_slip(scene: Scene, inputs: Inputs, settled: Simulation) -> float:
    """Return the mean slip of a level that moves, at the temperatures of a settled run, once two means in a row agree."""
    moving, before = Simulation(scene, inputs, empty_table()), math.nan
    for _ in range(_STRETCHES):
        if settled.thermal is not None:
            moving.set_temperatures(settled.thermal.temperatures)
        mean = float(moving.advance(_STRETCH, samples=51)["cage_slip"][1:].mean())
        if abs(mean - before) < _SAME_SLIP:
            return mean
        before = mean
    return math.nan


def _in_equilibrium(simulation: Simulation, start: np.ndarray | None, nearby: _Equilibria) -> np.void:
    """Bring a simulation that has begun at a guess of the temperatures to its thermal equilibrium and return its sample there.

    The search is that of `_refined`; where there is no guess, or it does not end, that of `bearing_sim.levels.steady.equilibrium` comes first,
    whose operating points are finer and take five times as long.
    """
    simulation.thermal.held = True
    if start is not None and (sample := _refined(simulation, nearby)) is not None:
        return sample
    found = thermal_equilibrium(simulation.scene, simulation.inputs, start, _NEAR)
    if not found.converged:
        raise IntegrationError(found.reason)
    simulation.set_temperatures(found.temperatures)
    if (sample := _refined(simulation, nearby)) is not None:
        return sample
    simulation.set_temperatures(found.temperatures)
    return simulation.advance(_LONG, samples=2)[-1]


def _refined(simulation: Simulation, nearby: _Equilibria) -> np.void | None:
    """Return the sample in the thermal equilibrium close to the present temperatures, or None where none is found.

    Losses and temperatures are found in turn.  How losses follow temperatures is nearly the same for all values of the fields at an operating
    point: each round teaches it, so that most points are solved for twice.
    """
    thermal, inlet, step, before = simulation.thermal, simulation.inputs.oil_temperature, None, None
    for _ in range(_ROUNDS):
        sample = simulation.advance(_LONG, samples=2)[-1:]
        change, equal = thermal.rest(sample, inlet) - thermal.temperatures, _EQUAL + _EQUAL_PART * np.ptp(thermal.temperatures)
        if step is not None and np.abs(step).max() > _TELLING * equal:
            nearby.learn(step, before - change)
        step, before = nearby.step(change), change
        if not np.isfinite(step).all() or np.abs(step).max() > _FARTHEST:
            break
        if np.abs(step).max() < equal:
            return sample[0]
        simulation.set_temperatures(thermal.temperatures + step)
    nearby.forget_feedback()
    return None


def at_points(scene: Scene, scores: np.ndarray, conditions: np.ndarray, execution: Execution = IN_MEMORY, level: str = "steady") -> np.ndarray:
    """Return settled answers at points, shape (n, 7); NaN where there is none.

    Parameters
    ----------
    scene : of any level.
    scores : of its uncertain fields, shape (n, d).
    conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (n, 4).
    execution : see `bearing_sim.sweep.tasks.Execution`.
    level : that slip is of; all else is of level ``steady``.
    """
    scene, fields = scene.at_level(level), scene_fields(scene)
    names, values = tuple(one.field for one in fields.ranges), fields.values_of(scores)
    return answers_at(
        [values, conditions],
        settled_points,
        (scene, names),
        {"answers": [math.nan] * len(ANSWERS)},
        level,
        _BATCH,
        execution,
    )["answers"]


def design(scene: Scene, count: int, seed: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Return the points that a response is fitted to: the same scores, the scene's own first, at each of ``count / 64`` operating points.

    Both are points of scrambled Sobol' sequences; operating points are evenly spread in the coordinates of the response.

    Parameters
    ----------
    scene : of any level.
    count : number of points, a power of two, 1024 or more.
    seed : of the scrambling.

    Returns
    -------
    conditions, scores : shapes (count, 4) and (count, d).
    """
    fields, nodes = scene_fields(scene), count // DRAWS
    scores = np.concatenate([fields.scores_of(fields.own)[None], prior_draws(len(fields), DRAWS, seed)[1:]])
    positions = qmc.Sobol(d=4, scramble=True, seed=np.random.default_rng(seed)).random_base2(nodes.bit_length() - 1)
    return np.repeat(conditions_at(positions, domain_of(scene)), DRAWS, axis=0), np.tile(scores, (nodes, 1))


def obtain_response(scene: Scene, execution: Execution = IN_MEMORY, rebuild: bool = False, points: int = _POINTS) -> ResponseModel:
    """Return the response of a scene, from disk or built and kept there; an interrupted build resumes from its journal.

    Parameters
    ----------
    scene : its level does not matter.
    execution : see `bearing_sim.sweep.tasks.Execution`; the journal is its own.
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
        with Journal(path.with_suffix(".journal"), is_own=True) as journal:
            answers = at_points(scene, scores, conditions, execution._replace(journal=journal))
        try:
            found = fit_response(fields, domain_of(scene), conditions, scores, answers, SlipAndOil(scene), time.perf_counter() - began)
        except ValueError as error:
            raise UncertaintyError(f"no response of {scene.name}: {error}; narrow its ranges, or its block `table`") from None
        with kept_if_possible(path):
            write_response(path, found)
            path.with_suffix(".journal").unlink(missing_ok=True)
    return found
