# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Operating points at level ``planar``, from which the correction of a table of level ``steady`` is fitted, and the tables that have it.

Points are spread evenly at first (a scrambled Sobol' sequence).  More are added where those that are there leave most in doubt: far from all of
them, in the neighbourhood of those that are missed most when they are left out; their number doubles each time.
"""

import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import qmc

from bearing_sim.files.kept import kept_if_possible
from bearing_sim.levels.steady.operating_point import ACCELERATIONS, ANSWER, CAGE_SLIPS
from bearing_sim.levels.steady.table import Table
from bearing_sim.levels.steady.table_builder import Quality, obtain_table, solve_points
from bearing_sim.model.params import Life, pack
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation
from bearing_sim.studies.batches import answers_at
from bearing_sim.studies.trade_course import cage_rate
from bearing_sim.sweep.settling import Outcome, advance_until_settled
from bearing_sim.sweep.tasks import Execution, Journal, Progress, in_silence
from bearing_sim.watchers.estimation.correction import (
    LIFE_EXPONENT,
    STATES_APART,
    Correction,
    correction_domain,
    correction_path,
    fit_correction,
    measured_scene,
    read_correction,
    write_correction,
)
from bearing_sim.watchers.estimation.response import CONDITIONS, Domain, conditions_at

FIRST_POINTS, ENOUGH_POINTS, MOST_POINTS = 256, 512, 1024
SLIP_GOAL, LIFE_GOAL = 5e-4, 0.01  # errors at points left out, root mean square, below which no more points are added
_BATCH = 8  # points of a task
_PAYS = 0.8  # of the error before, to which twice as many points must bring it, or no more than `ENOUGH_POINTS` are measured (assumption)
_CANDIDATES = 4096
_PURSUED = 10.0  # times the goals; larger errors, such as at a jump from one state to another, do not draw more points
_FINER = 0.3  # times the default tolerances: a table must not add its own error to theirs where rollers rattle
_ON_EDGES = 0.05  # of the points for each edge of the operating points; a spline errs most there
_SHORTEST, _LONGEST = 24.0, 120.0  # turns of an ideal cage; cages that skid under little load wander and never rest, their means count
_TELLING = 0.02  # slip from which on another state is looked for
_MORE = 2.0  # times the slip found, at which the search for another state begins
_FAR_BEHIND = 0.9  # slip at which a cage begins its way back
_QUARTER, _LONGEST_WAY, _AT_REST = 0.25, 30.0, 1e-3  # of a turn, over which slip is averaged on a way; turns; change of slip in a turn
_SAMPLES_OF_A_QUARTER = 8
_ON_THE_WAY, _ON_THE_WAY_BACK = 2, 10  # quarters after which spins have followed a cage that began in ideal rolling, and one that began skidding
_TOLD, _WIDEST = 0.02, 4  # change of slip that tells an acceleration, and quarters each way within which it is looked for
_LEAST_LAG = 1.0  # turns; a cage that comes back sooner is back before its acceleration shows
_MEANS = tuple(name for name in ANSWER._fields if name in {each.name for each in OBSERVABLES})
_LOADS = ("inner_equivalent_load", "outer_equivalent_load", "inner_lamina_load", "outer_lamina_load")


def measured_points(scene: Scene, conditions: tuple[tuple[float, ...], ...]) -> dict:
    """Return what levels ``steady`` and ``planar`` settle in at operating points, as lists.

    Parameters
    ----------
    scene : without a law of heat.
    conditions : columns `bearing_sim.watchers.estimation.response.CONDITIONS`.

    Returns
    -------
    ``steady``, ``planar`` : columns `bearing_sim.levels.steady.operating_point.ANSWER`, NaN where there is no answer.  How the
        cage goes to its speed is as of ``steady`` where its way was too short to tell.
    ``other_slip`` : in which ``planar`` settles from more slip; NaN where that was not tried.
    """
    steady, planar = solve_points(scene, np.array(conditions)), scene.at_level("planar")
    planar = replace(planar, integration=planar.integration.with_tolerances(_FINER))
    life, found, other = pack(planar).life, np.full((len(conditions), len(ANSWER)), math.nan), np.full(len(conditions), math.nan)
    for k, (speed, load, kelvin, angle) in enumerate(conditions):
        inputs = Inputs(speed, load * math.cos(angle), load * math.sin(angle), kelvin)
        try:
            run = Simulation(planar, inputs)
            rolling = run.sample.copy()
            on = _slips_on_the_way(run)[_ON_THE_WAY:]
            found[k] = _answers(_settled(run), life)
            slip = found[k, ANSWER.cage_slip]
            back = _slips_on_the_way(Simulation(planar, inputs, start=_slipping(rolling, _FAR_BEHIND, with_spins=True)))[_ON_THE_WAY_BACK:]
            found[k, ANSWER.lag : ACCELERATIONS.stop] = _way_to_balance(steady[k], slip, (on, back), _turn(run))
            if _TELLING <= slip < 0.5:
                other[k] = _settled(Simulation(planar, inputs, start=_slipping(rolling, _MORE * slip))).slip
        except IntegrationError:
            continue
    return {"steady": steady.tolist(), "planar": found.tolist(), "other_slip": other.tolist()}


def _turn(run: Simulation) -> float:
    """Return how long a cage without slip takes for a turn [s]."""
    return 1.0 / abs(cage_rate(run.scene, run.inputs.shaft_speed))


def _settled(run: Simulation) -> Outcome:
    return advance_until_settled(run, _SHORTEST * _turn(run), _LONGEST * _turn(run))


def _slips_on_the_way(run: Simulation) -> np.ndarray:
    """Return the mean slips of a run that has just begun, quarter by quarter of a cage turn, until its cage rests or is long on its way."""
    quarter = _QUARTER * _turn(run)
    in_turn, slips = round(1.0 / _QUARTER), []
    while len(slips) < _LONGEST_WAY * in_turn:
        slips.append(float(run.advance(quarter, samples=_SAMPLES_OF_A_QUARTER)["cage_slip"].mean()))
        if len(slips) > _ON_THE_WAY_BACK + in_turn and abs(slips[-1] - slips[-1 - in_turn]) < _AT_REST:
            break
    return np.array(slips)


def _change_at(slip: float, slips: np.ndarray) -> float:
    """Return by how much slip changes in a quarter of a turn where it passes a slip for the first time; NaN where it does not."""
    passed = np.flatnonzero((slips[1:-2] - slip) * (slips[2:-1] - slip) <= 0.0)
    if not len(passed):
        return math.nan
    k, reach = int(passed[0]) + 1, 1  # between this quarter and the next
    while abs(slips[k + 1] - slips[k]) * 2 * reach < _TOLD and reach < min(_WIDEST, k, len(slips) - 2 - k):
        reach += 1
    changes = [(slips[i + reach] - slips[i - reach]) / (2 * reach) for i in (k, k + 1)]
    return float(np.interp(slip, *zip(*sorted(zip(slips[k : k + 2], changes)))))


def _way_to_balance(steady: np.ndarray, slip: float, ways: tuple[np.ndarray, np.ndarray], turn: float) -> np.ndarray:
    """Return lag, inertia and delay of spins, and accelerations of the cage at level ``planar``.

    Where no way tells an acceleration, it differs from that of level ``steady`` as those between which it is, or the nearest one.

    Parameters
    ----------
    steady : answer of level ``steady``, columns `ANSWER`.
    slip : at which level ``planar`` settles.
    ways : slips of a cage from rolling, and of one from far behind, quarter by quarter of a turn.
    turn : of an ideal cage [s].
    """
    found, ideal = steady.copy(), 2.0 * math.pi / turn
    per_change = -ideal / (_QUARTER * turn)
    measured = np.array([per_change * _change_at(there, ways[int(there > slip)]) for there in CAGE_SLIPS.tolist()])
    measured[(np.abs(CAGE_SLIPS - slip) < _TOLD) | ~(measured * (CAGE_SLIPS - slip) > 0.0)] = math.nan
    more = measured - steady[ACCELERATIONS]
    if (known := np.isfinite(more)).any():
        found[ACCELERATIONS] += np.interp(CAGE_SLIPS, CAGE_SLIPS[known], more[known])
    near = [side * per_change * _change_at(slip + side * _TOLD, way) for side, way in zip((-1.0, 1.0), ways)]
    lags = [_TOLD * ideal / acceleration for acceleration in near if acceleration > 0.0]
    if steady[ANSWER.lag] > _LEAST_LAG * turn and lags:
        found[ANSWER.lag] = math.exp(float(np.mean(np.log(lags))))
    return found[ANSWER.lag : ACCELERATIONS.stop]


def _slipping(rolling: np.void, slip: float, with_spins: bool = False) -> np.void:
    """Return the sample of ideal rolling with a cage that slips, by 90 % at most, and rollers that go with it.

    They spin as they would without slip, or ``with_spins`` as they roll on the outer raceway: the others push the cage at first.
    """
    sample, slip = rolling.copy(), min(slip, 0.9)
    for name in ("cage_speed", "orbital_speed", *(["roller_spin"] if with_spins else [])):
        sample[name] *= 1.0 - slip
    return sample


def _answers(outcome: Outcome, life: Life) -> np.ndarray:
    """Return the means of a settled run as an answer of level ``steady``; its lags are NaN."""
    window, answers = outcome.window, np.full(len(ANSWER), math.nan)
    for name in _MEANS:
        answers[ANSWER._fields.index(name)] = float(window[name].mean())
    answers[ANSWER.cage_slip] = outcome.slip
    loads = [float(np.mean(window[name] ** LIFE_EXPONENT) ** (1.0 / LIFE_EXPONENT)) for name in _LOADS]
    with np.errstate(divide="ignore"):
        mean = 1.0 / float(np.mean(1.0 / window["l10r"]))  # damage adds up
    revolutions = mean * 3600.0 * abs(float(window["shaft_speed"][-1])) / (2.0 * math.pi)
    given = rating_life_revolutions(*loads[2:], life) if min(loads[2:]) > 0.0 else math.inf
    scale = (given / revolutions) ** (1.0 / LIFE_EXPONENT) if math.isfinite(given) and math.isfinite(revolutions) else 1.0
    answers[ANSWER.inner_equivalent_load : ANSWER.outer_lamina_load + 1] = np.array(loads) * scale
    return answers


def obtain_correction(
    scene: Scene, temperatures: tuple[float, float] | None = None, workers: int | None = None,
    progress: Progress = in_silence, rebuild: bool = False, most: int = MOST_POINTS,
) -> Correction:  # fmt: skip
    """Return the correction of a scene, from disk or measured and kept there; an interrupted measurement resumes from its journal.

    Parameters
    ----------
    scene : its level does not matter.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    workers : see `bearing_sim.sweep.tasks.run_tasks`.
    progress : called with the number of points measured and the most that there may be.
    rebuild : whether to measure it even if there is one.
    most : points.

    Raises
    ------
    SceneError
        Level ``planar`` cannot compute the scene.
    ValueError
        Too few points have answers.
    JournalInUse
        See `bearing_sim.sweep.tasks`.
    """
    domain = correction_domain(scene, temperatures)
    path = correction_path(scene, domain)
    found = None if rebuild else read_correction(path)
    if found is None:
        journal = path.with_suffix(".journal")
        found = _measured(scene, domain, journal, workers, progress, most)
        with kept_if_possible(path):
            write_correction(path, found)
            journal.unlink(missing_ok=True)
    return found


def _measured(scene, domain, path: Path, workers, progress, most) -> Correction:
    began, plain = time.perf_counter(), measured_scene(scene, "slip")
    spread = _spread(min(FIRST_POINTS, most), 1, domain)
    conditions, rows, before = np.zeros((0, 4)), [], None
    nothing = [math.nan] * len(ANSWER)
    with Journal(path, is_own=True) as journal:
        while True:
            done = len(conditions)
            rows.append(
                answers_at(
                    [spread],
                    measured_points,
                    (plain,),
                    {"steady": nothing, "planar": nothing, "other_slip": math.nan},
                    "planar",
                    _BATCH,
                    Execution(journal, workers, progress=lambda points, total, done=done: progress(done + points, most)),
                )
            )
            conditions = np.concatenate([conditions, spread])
            found = _fitted(domain, conditions, rows, time.perf_counter() - began)
            if len(conditions) >= most or (len(conditions) >= ENOUGH_POINTS and not _pays(before, found)) or not _missed(found):
                return found
            before = found
            spread = _doubtful(found, min(len(conditions), most - len(conditions)), len(conditions))


def _spread(count: int, seed: int, domain: Domain) -> np.ndarray:
    """Return so many operating points, evenly spread and on the edges of speed, load and temperature."""
    places = qmc.Sobol(d=len(CONDITIONS), scramble=True, seed=np.random.default_rng(seed)).random(count)
    bounded = [name != "load_angle" for name in CONDITIONS]
    places[:, bounded] = np.clip((places[:, bounded] - _ON_EDGES) / (1.0 - 2.0 * _ON_EDGES), 0.0, 1.0)
    return conditions_at(places, domain)


def _missed(found: Correction) -> list[str]:
    """Return which errors of a correction are above their goals."""
    return [name for name, goal in (("slip_error", SLIP_GOAL), ("life_error", LIFE_GOAL)) if getattr(found, name) > goal]


def _pays(before: Correction | None, found: Correction) -> bool:
    """Return whether the last points have lowered every error that is above its goal; at a jump between two states none does."""
    return before is None or all(getattr(found, name) <= _PAYS * getattr(before, name) for name in _missed(found))


def _fitted(domain, conditions, rows, seconds) -> Correction:
    steady, planar, other = (np.concatenate([row[name] for row in rows]) for name in ("steady", "planar", "other_slip"))
    two = np.abs(other - planar[:, ANSWER.cage_slip]) > STATES_APART
    states = np.column_stack([conditions[two], planar[two, ANSWER.cage_slip], other[two]])
    return fit_correction(domain, conditions, steady, planar, seconds)._replace(two_states=states)


def _doubtful(found: Correction, count: int, seed: int) -> np.ndarray:
    """Return conditions at which a correction is least sure, each a candidate that is far from the others."""
    candidates = _spread(_CANDIDATES, seed, found.domain)
    errors = found.errors_near(candidates) / [SLIP_GOAL, LIFE_GOAL]
    weights = np.sqrt(np.square(np.minimum(errors, _PURSUED)).sum(axis=1))
    there, chosen = (found.places(each) for each in (candidates, found.conditions))
    distances = np.sqrt(np.square(there[:, None] - chosen).sum(axis=-1).min(axis=1))
    picked = []
    for _ in range(count):
        best = int(np.argmax(weights * distances))
        picked.append(best)
        distances = np.minimum(distances, np.sqrt(np.square(there - there[best]).sum(axis=1)))
    return candidates[picked]


def obtain_corrected_table(scene: Scene, temperatures: tuple[float, float] | None = None, workers: int | None = None) -> tuple[Table, Quality]:
    """Return the table of a scene, corrected where its block ``table`` asks for that.

    Parameters and errors are those of `obtain_table` and `obtain_correction`.
    """
    if scene.table.correction == "none":
        return obtain_table(scene, temperatures, workers)
    return obtain_table(scene, temperatures, workers, correction=lambda: obtain_correction(scene, temperatures, workers))
