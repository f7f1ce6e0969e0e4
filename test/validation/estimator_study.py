# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How good the calibration of a running model is: runs of machines whose hidden fields are known, because the level itself plays the machine.

Each machine has fields drawn from the ranges of the scene, which wander, at settled points that the level itself solves for, never the response
that the estimator uses.  Its cage sensor has noise, drifts, now and then reads anything, and falls silent at times.  The estimator sees what a
live run would give it: samples of the scene with its own values, and the sensors.
"""

import math
import time
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from bearing_sim.messages.events import Event
from bearing_sim.model.params import pack
from bearing_sim.model.sample import new_block
from bearing_sim.scene.scene import Scene
from bearing_sim.studies.response_points import at_points
from bearing_sim.sweep.tasks import Execution, Journal
from bearing_sim.watchers.estimation.causes import LOAD, OIL, SENSOR, group_of
from bearing_sim.watchers.estimation.estimator import Estimator
from bearing_sim.watchers.estimation.response import ANSWERS, ResponseModel
from bearing_sim.watchers.monitoring.residual import CALIBRATED_SLIP, ResidualMonitor

RATE = 10.0  # Hz, of the sensor and of the samples
NOISE = 0.002  # of a reading of slip
_OUTLIERS = 0.01  # fraction of readings that are anything between a stopped cage and one at twice its ideal speed
_DRIFT = 0.003 / 3600.0  # 1/s, slip that the sensor drifts by
_SILENT, _SILENCE = 0.1, 5.0  # probability that a plateau has a silence of the sensor, and its length [s]
_PLATEAU = 60.0  # s
_BLOCK = 10  # samples
_SPEEDS, _LOADS, _TEMPERATURES = (0.45, 1.1), (0.4, 4.0), (-10.0, 20.0)  # of plateaus: of the scene's speed and load, and K from its oil temperature
_EARLY, _LATE = 1.0, 55.0  # s into a plateau at which predictions are judged: before anything was learned there, and after
_ENDS = (0.5, 0.05, 0.95)  # quantiles of a prediction
_HOUR = 3600.0
TEMPERATURES, CLEARANCE = "temperatures", "clearance"
"""What may be measured besides the cage."""
PAUSE = 1800.0
"""Seconds that pass unseen in the middle of a plateau where ring temperatures are measured: until they are settled."""
WANDERING = 1.0
"""Seconds within which hidden fields go straight: a batch of readings by default."""
WANDERING_OF_SLOW_POINTS = 10.0
"""The same where settled points take long to solve for: at level ``slip``, and with a thermal network."""
_RINGS = ("inner_ring_temperature", "outer_ring_temperature")
_CLEARANCE_EVERY = 10.0  # s
_WILD = 20.0  # of the noise; standard deviation of wild readings of temperature and clearance
# Sizes of hidden faults: scores to both sides, K, logarithm of a load, and of a sensor's scale.
_FAULT_SCORE, _FAULT_TEMPERATURE, _FAULT_LOAD, _FAULT_SCALE = 1.0, 15.0, 0.35, 0.03
_FAULT_POINTS, _FAULT_PLATEAU = 6, 30.0  # operating points before and after a fault, and their length [s]
_GIVEN_WRONGLY = {OIL: "oil temperature against its input", LOAD: "load over its input", SENSOR: "sensor scale"}
NO_ALARM = "no alarm"
RESIDUALS = {  # noise of the mean of a batch, and correlation of neighbours
    "the sensor's noise": (NOISE / math.sqrt(RATE), 0.0),
    "ten times the noise": (10.0 * NOISE / math.sqrt(RATE), 0.0),
    "ten times the noise, correlated over 10 s": (10.0 * NOISE / math.sqrt(RATE), 0.9),
}
"""Kinds of residuals in which nothing changes."""


class Machine(NamedTuple):
    """A machine on a course of plateaus.

    Attributes
    ----------
    conditions : of the p plateaus, as `bearing_sim.watchers.estimation.response.CONDITIONS`, shape (p, 4).
    scores : of its hidden fields at the end, shape (d,).
    own : columns `bearing_sim.watchers.estimation.response.ANSWERS` by the scene's own values, shape (p, 7).
    answers : of the machine at n equally spaced times of each plateau, the first and the last of them its start and its end, shape (p, n, 7).
    pause : seconds that pass in the middle of each plateau, unseen.
    """

    conditions: np.ndarray
    scores: np.ndarray
    own: np.ndarray
    answers: np.ndarray
    pause: float = 0.0

    def at(self, plateau: int, played: np.ndarray) -> np.ndarray:
        """Return the answers at times of a plateau that are played, shape (m, 7); they go straight between the times that they are known at.

        Parameters
        ----------
        plateau : its number.
        played : seconds since its start, without the pause, shape (m,).
        """
        known = self.answers[plateau]
        times = _passed(np.linspace(0.0, _PLATEAU, len(known)), self.pause)
        return np.stack([np.interp(_passed(played, self.pause), times, column) for column in known.T], axis=1)


def _passed(played: np.ndarray, pause: float) -> np.ndarray:
    """Return seconds since the start of a plateau with the pause in its middle, from those without it."""
    return played + pause * (played > 0.5 * _PLATEAU)


class Judgement(NamedTuple):
    """What the estimator made of a machine.

    Attributes
    ----------
    fields : whether the hidden value of each calibrated field lay in its 90 % interval at the end, shape (d,).
    widths : of the intervals, over those before any measurement, shape (d,).
    slips : whether the machine's slip lay in the 90 % interval of the prediction, early and late in each plateau, shape (p, 2).
    errors : of the prediction, shape (p, 2).
    stated : half the width of its interval, shape (p, 2).
    open_loop : errors of the scene's own values, shape (p, 2).
    chances : probability, by the prediction's own draws, that it is off by more than the scene's own values by more than is stated, shape (p, 2).
    alarms : events of a change.
    seconds : processor time of the estimator.
    """

    fields: np.ndarray
    widths: np.ndarray
    slips: np.ndarray
    errors: np.ndarray
    stated: np.ndarray
    open_loop: np.ndarray
    chances: np.ndarray
    alarms: int
    seconds: float


def plateaus(scene: Scene, count: int, random: np.random.Generator) -> np.ndarray:
    """Return operating points about that of a scene, shape (count, 4)."""
    operating, kelvin = scene.operating, scene.lubricant.temperature
    speed = operating.shaft_speed * random.uniform(*_SPEEDS, count)
    load = operating.radial_load * np.exp(random.uniform(*np.log(_LOADS), count))
    return np.stack([speed, load, kelvin + random.uniform(*_TEMPERATURES, count), np.full(count, operating.load_angle)], axis=1)


def wandering(scene: Scene, free: np.ndarray, nominal: np.ndarray, seconds: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Return scores of fields that wander as the scene's block ``estimation`` says; those that are not free keep theirs.

    Parameters
    ----------
    scene : says how fast.
    free : which fields wander, shape (d,).
    nominal : scores of the others, shape (d,).
    seconds : between one state and the next, shape (n,).
    random : what they are drawn from.

    Returns
    -------
    shape (n + 1, d).
    """
    rows = [random.normal(size=len(nominal))]
    for kept in np.exp(-0.5 * seconds / scene.estimation.drift.wander_time).tolist():
        rows.append(kept * rows[-1] + math.sqrt(1.0 - kept**2) * random.normal(size=len(nominal)))
    return np.where(free, rows, nominal)


def machines(
    scene: Scene, response: ResponseModel, runs: int, seed: int, *, count: int = 12, known: Sequence[str] = (), pause: float = 0.0,
    every: float = WANDERING, journal: Journal | None = None, workers: int | None = None, dask: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Machine]:  # fmt: skip
    """Return machines with hidden fields, solved for at the level of the scene, ``steady`` or ``slip``.

    Parameters
    ----------
    scene : its ranges are those of the hidden fields.
    response : of the scene; only names and scores of its fields are used.
    runs, seed : number of machines, and what they are drawn from.
    count : of plateaus.
    known : dotted paths of fields that have the scene's own values, because they are inputs.
    pause : seconds that pass in the middle of each plateau, unseen.
    every : seconds within which hidden fields go straight; the pause counts as one step.
    journal, workers, dask, progress : see `bearing_sim.studies.response_points.at_points`.
    """
    random, free = np.random.default_rng(seed), np.array([name not in known for name in response.names])
    course, steps = plateaus(scene, count, random), max(round(_PLATEAU / every), 2)
    durations = np.diff(_passed(np.linspace(0.0, _PLATEAU, steps + 1), pause))
    scores, conditions = [], []
    for _ in range(runs):
        conditions.append(course[random.permutation(count)])
        scores.append(wandering(scene, free, response.nominal, np.tile(durations, count), random))
    plateau = np.arange(count)[:, None] * steps + np.arange(steps + 1)  # the end of one is the start of the next
    asked_scores = np.concatenate([np.repeat(response.nominal[None], count, axis=0), *(each[plateau.ravel()] for each in scores)])
    asked_conditions = np.concatenate([course, *(np.repeat(each, steps + 1, axis=0) for each in conditions)])
    answers = at_points(scene, asked_scores, asked_conditions, Execution(journal, workers, dask, progress), scene.level)
    own = {tuple(row): each for row, each in zip(course, answers[:count])}
    return [
        Machine(each, score[-1], np.array([own[tuple(row)] for row in each]), found, pause)
        for each, score, found in zip(conditions, scores, answers[count:].reshape(runs, count, steps + 1, len(ANSWERS)))
        if np.isfinite(found[:, :, 0]).all() and np.isfinite(answers[:count, 0]).all()
    ]


def samples(scene: Scene, times: np.ndarray, conditions: np.ndarray, own: np.ndarray) -> np.ndarray:
    """Return samples of a settled run, shape (n,); what the estimator does not read is 0.

    Parameters
    ----------
    times : [s], shape (n,).
    conditions : shape (n, 4), as `bearing_sim.watchers.estimation.response.CONDITIONS`.
    own : slip, shape (n,).
    """
    params = pack(scene)
    block = new_block(len(times), params.rollers.count)
    block["time"], block["shaft_speed"], block["oil_temperature"] = times, conditions[:, 0], conditions[:, 2]
    block["load_y"], block["load_z"] = conditions[:, 1] * np.cos(conditions[:, 3]), conditions[:, 1] * np.sin(conditions[:, 3])
    block["ideal_cage_speed"] = 0.5 * conditions[:, 0] * (1.0 - params.raceways.diameter_ratio)
    block["cage_slip"] = own
    for name in _RINGS:
        block[f"{name}_measured"] = math.nan
    return block


def judge(
    scene: Scene, response: ResponseModel, machine: Machine, seed: int, known: Sequence[str] = (), measured: Collection[str] = ()
) -> Judgement:  # fmt: skip
    """Let an estimator learn a machine from its sensors, and judge its intervals and predictions.

    Parameters
    ----------
    scene, response, known : as of `bearing_sim.watchers.estimation.estimator.Estimator`.
    machine : see `machines`.
    seed : of the noise.
    measured : of `TEMPERATURES` and `CLEARANCE`, besides the cage.
    """
    random, estimator = np.random.default_rng(seed), Estimator(scene, response, known)
    count, per_plateau = len(machine.own), round(_PLATEAU * RATE)
    found = np.zeros((4, count, 2))  # predicted median and ends of its interval, truth
    chances, seconds, own_slip = np.zeros((count, 2)), 0.0, machine.own[:, ANSWERS.index("cage_slip")]

    def predict(k: int, late: int, sample: np.void, truth: float) -> None:
        drawn = estimator.prediction(sample)
        middle, low, high = np.quantile(drawn, _ENDS)
        found[:, k, late] = middle, low, high, truth
        chances[k, late] = np.mean(np.abs(middle - drawn) > np.abs(own_slip[k] - drawn) + 0.5 * (high - low))

    alarms, holding = 0, False
    for k in range(count):
        played = (np.arange(per_plateau) + 1.0) / RATE
        times, answers = k * (_PLATEAU + machine.pause) + _passed(played, machine.pause), machine.at(k, played)
        slips = answers[:, ANSWERS.index("cage_slip")]
        block = samples(scene, times, np.repeat(machine.conditions[k : k + 1], per_plateau, axis=0), np.full(per_plateau, own_slip[k]))
        if TEMPERATURES in measured:
            for name in _RINGS:
                column = ANSWERS.index(name)
                block[f"{name}_uncorrected"] = machine.own[k, column]
                noisy = _noisy(answers[:, column], scene.estimation.noise.temperature, random)
                block[f"{name}_measured"] = np.where(played > 0.5 * _PLATEAU, noisy, math.nan)
        if CLEARANCE in measured:
            clearances = _noisy(answers[:, ANSWERS.index("running_clearance")], scene.estimation.noise.clearance, random)
            block["running_clearance"] = machine.own[k, ANSWERS.index("running_clearance")]
            for each in range(per_plateau)[:: round(_CLEARANCE_EVERY * RATE)]:
                estimator.measure_clearance(float(times[each]), float(clearances[each]))
        readings = slips + _DRIFT * (k * _PLATEAU + played) + NOISE * random.normal(size=per_plateau)
        wild = random.random(per_plateau) < _OUTLIERS
        readings[wild] = random.uniform(-1.0, 1.0, int(wild.sum()))
        silent = random.random() < _SILENT
        quiet_from = random.uniform(0.0, _PLATEAU - _SILENCE)
        for first in range(0, per_plateau, _BLOCK):
            part = slice(first, first + _BLOCK)
            for when, since, reading, ideal in zip(times[part], played[part], readings[part], block["ideal_cage_speed"][part]):
                if not (silent and quiet_from <= since < quiet_from + _SILENCE):
                    estimator.measure(float(when), float((1.0 - reading) * ideal))
            if first == 0:
                predict(k, 0, block[first], slips[first])
            began = time.process_time()
            estimator.update(block[part])
            seconds += time.process_time() - began
            if first == round(_LATE * RATE):
                predict(k, 1, block[first], slips[first])
            changed = bool(_changes(estimator, float(times[part][-1])))
            alarms, holding = alarms + (changed and not holding), changed
    fields = [pair for pair in zip(estimator.estimates(), response.fields.values_of(machine.scores)) if pair[0].calibrated]
    errors = found[0] - found[3]
    return Judgement(
        np.array([one.low <= value <= one.high for one, value in fields]),
        np.array([(one.high - one.low) / (one.prior_high - one.prior_low) for one, _ in fields]),
        (found[1] <= found[3]) & (found[3] <= found[2]),
        errors,
        0.5 * (found[2] - found[1]),
        own_slip[:, None] - found[3],
        chances,
        alarms,
        seconds,
    )


def _noisy(values: np.ndarray, deviation: float, random: np.random.Generator) -> np.ndarray:
    """Return values with noise, some of them wild."""
    wild = random.random(len(values)) < _OUTLIERS
    return values + deviation * np.where(wild, _WILD, 1.0) * random.normal(size=len(values))


def _changes(estimator: Estimator, now: float) -> list[Event]:
    return [event for event in estimator.events(now) if event.kind == "calibration.change"]


class Detection(NamedTuple):
    """How a sudden change was found.

    Attributes
    ----------
    seconds : from the change to its alarm; NaN where there was none.
    rank : of the true group of causes among all, 1 for the likeliest; 0 where none was named.
    told_apart : whether no other group was a third as probable as the likeliest.
    """

    seconds: float
    rank: int
    told_apart: bool


def detections(
    scene: Scene, response: ResponseModel, field: str, values: tuple[float, float], runs: int, seed: int, *, known: Sequence[str] = (),
    seconds: float = 60.0, workers: int | None = None,
) -> list[Detection]:  # fmt: skip
    """Return how a step of a field is found at the scene's operating point, in machines whose other fields are hidden.

    Parameters
    ----------
    scene, response, known : as of `judge`.
    field : dotted path of the field.
    values : before and after the step [SI].
    runs, seed : number of machines, and what they are drawn from.
    seconds : to wait for an alarm.
    workers : see `bearing_sim.studies.response_points.at_points`.
    """
    random, column = np.random.default_rng(seed), response.names.index(field)
    free = np.array([name not in known for name in response.names])
    scores = np.where(free, random.normal(size=(runs, len(free))), response.nominal)
    both = np.repeat(scores, 2, axis=0)
    both[:, column] = np.tile(
        [response.fields.scores_of(np.where(np.arange(len(free)) == column, value, response.fields.own))[column] for value in values], runs
    )
    operating = scene.operating
    there = np.array([operating.shaft_speed, operating.radial_load, scene.lubricant.temperature, operating.load_angle])
    asked = np.concatenate([response.nominal[None], both])
    slips = at_points(scene, asked, np.repeat(there[None], len(asked), axis=0), Execution(None, workers), scene.level)[:, ANSWERS.index("cage_slip")]
    own, pairs = float(slips[0]), slips[1:].reshape(runs, 2)
    return [_detected(scene, response, there, own, pair, field, known, random, seconds) for pair in pairs if np.isfinite(pair).all()]


def _detected(scene, response, there, own, slips, field, known, random, seconds) -> Detection:
    learning = 1.5 * scene.thresholds.residual.learning
    estimator, told, changed = Estimator(scene, response, known), math.nan, math.ceil(learning)
    for start, length, slip in ((0.0, changed, slips[0]), (changed, seconds, slips[1])):
        for now in _played(estimator, scene, start, length, there, own, float(slip), random):
            if start and math.isnan(told) and _changes(estimator, now):
                told = now - start
    causes = estimator.change.causes if estimator.change is not None else ()
    groups = list(dict.fromkeys(cause.group for cause in causes))
    rank = groups.index(group_of(field)) + 1 if group_of(field) in groups else 0
    others = [cause.probability for cause in causes if cause.group != causes[0].group]
    return Detection(told, rank, bool(causes) and max(others, default=0.0) < causes[0].probability / 3.0)


def false_alarms(scene: Scene, hours: float, noise: float, correlation: float, seed: int) -> int:
    """Return how many alarms the change detector gives in hours of residuals in which nothing changes, one each batch.

    Parameters
    ----------
    scene : its block ``thresholds.residual`` says what is promised.
    hours : of residuals.
    noise : standard deviation of a batch's mean, in slip.
    correlation : of neighbouring batches.
    seed : of the noise.
    """
    detection, random = scene.thresholds.residual, np.random.default_rng(seed)
    monitor, alarms, before = ResidualMonitor(detection, 0.0, CALIBRATED_SLIP), 0, 0
    now, state, left = 0.0, 0.0, math.sqrt(1.0 - correlation**2)
    for _ in range(math.ceil(hours)):
        values = noise * random.normal(size=round(_HOUR / detection.batch))
        if correlation:
            values, last = lfilter([left], [1.0, -correlation], values, zi=[state])
            state = float(last[0])
        for value in values.tolist():
            monitor.compare(now, 1.0, value, 0.0)
            now += detection.batch
            side = monitor.side
            alarms, before = alarms + (side != 0 and before == 0), side
    return alarms


class Fault(NamedTuple):
    """A hidden fault: what changes in a machine at once.

    Attributes
    ----------
    group : of `bearing_sim.watchers.estimation.causes`.
    what : dotted path of a field, or the words of the cause.
    sign : whether it grows or falls.
    """

    group: str
    what: str
    sign: float


class Verdict(NamedTuple):
    """What the estimator made of a fault.

    Attributes
    ----------
    fault : what it was.
    size : root mean square of what it changes about measured slip.
    named : the group of the likeliest cause, or `NO_ALARM`.
    told_apart : whether no other group was a third as probable.
    probability : of the true group.
    evidence : natural logarithm of how much more probable the true cause makes the measurements than no change does; NaN without an alarm.
    """

    fault: Fault
    size: float
    named: str
    told_apart: bool
    probability: float
    evidence: float


def hidden_faults(scene: Scene, response: ResponseModel, known: Sequence[str] = ()) -> list[Fault]:
    """Return a fault of each kind that the scene's ranges allow, up and down: of the fields of a group, the one that moves slip most."""
    operating = scene.operating
    there = np.array([[operating.shaft_speed, operating.radial_load, scene.lubricant.temperature, operating.load_angle]])
    slopes, moving = response.condition_coefficients(there)[0, ANSWERS.index("cage_slip")], {}
    for column, name in enumerate(response.names):
        scores = np.repeat(response.nominal[None], 2, axis=0)
        scores[:, column] = -1.0, 1.0
        moved = abs(float(np.diff(response.basis_of(scores) @ slopes)[0]))
        if name not in known and moved > moving.get(group_of(name), (-1.0, ""))[0]:
            moving[group_of(name)] = moved, name
    kinds = [(group, name) for group, (_, name) in moving.items()] + [(group, what) for group, what in _GIVEN_WRONGLY.items()]
    return [Fault(group, what, sign) for group, what in kinds for sign in (1.0, -1.0)]


def verdicts(
    scene: Scene, response: ResponseModel, repeats: int, seed: int, *, known: Sequence[str] = (), workers: int | None = None, dask: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Verdict]:  # fmt: skip
    """Return what the estimator makes of hidden faults: six operating points before each and the same six after it, other fields hidden.

    Parameters
    ----------
    scene, response, known : as of `judge`.
    repeats : of each fault (`hidden_faults`), each in another machine.
    seed : of the machines, the operating points and the noise.
    workers, dask : see `bearing_sim.studies.response_points.at_points`.
    progress : called with the number of finished runs and of all.
    """
    random, free = np.random.default_rng(seed), np.array([name not in known for name in response.names])
    cases = [(fault, plateaus(scene, _FAULT_POINTS, random)) for fault in hidden_faults(scene, response, known) for _ in range(repeats)]
    asked_scores, asked_conditions = [], []
    for fault, course in cases:
        before = np.where(free, random.normal(size=len(free)), response.nominal)
        after, actual = before.copy(), course.copy()
        if fault.group == LOAD:
            actual[:, 1] *= math.exp(fault.sign * _FAULT_LOAD)
        elif fault.what in response.names:
            column = response.names.index(fault.what)
            before[column], after[column] = -fault.sign * _FAULT_SCORE, fault.sign * _FAULT_SCORE
        elif fault.group == OIL:
            actual[:, 2] += fault.sign * _FAULT_TEMPERATURE
        asked_scores += [np.repeat(each[None], _FAULT_POINTS, axis=0) for each in (response.nominal, before, after)]
        asked_conditions += [course, course, actual]
    slips = at_points(scene, np.concatenate(asked_scores), np.concatenate(asked_conditions), Execution(None, workers, dask), scene.level)
    slips = slips[:, ANSWERS.index("cage_slip")].reshape(len(cases), 3, _FAULT_POINTS)
    found = []
    for number, ((fault, course), each) in enumerate(zip(cases, slips)):
        if np.isfinite(each).all():
            found.append(_verdict(scene, response, fault, course, each, known, random))
        progress(number + 1, len(cases))
    return found


def _verdict(scene, response, fault, course, slips, known, random) -> Verdict:
    estimator, scale = Estimator(scene, response, known), 1.0 + fault.sign * _FAULT_SCALE * (fault.group == SENSOR)
    measured = np.concatenate([slips[1], 1.0 - scale * (1.0 - slips[2])])
    for k, slip in enumerate(measured.tolist()):
        there, own = course[k % _FAULT_POINTS], float(slips[0, k % _FAULT_POINTS])
        for _ in _played(estimator, scene, k * _FAULT_PLATEAU, _FAULT_PLATEAU, there, own, slip, random):
            pass
    size = float(np.sqrt(np.mean(np.square(measured[_FAULT_POINTS:] - measured[:_FAULT_POINTS]))))
    causes = estimator.change.causes if estimator.change is not None else ()
    if not causes:
        return Verdict(fault, size, NO_ALARM, False, 0.0, math.nan)
    likeliest = causes[0]
    rivals = [cause.probability for cause in causes if cause.group != likeliest.group]
    true = [cause for cause in causes if cause.group == fault.group]
    evidence = max((cause.evidence for cause in true), default=math.nan)
    told_apart = max(rivals, default=0.0) < likeliest.probability / 3.0
    return Verdict(fault, size, likeliest.group, told_apart, sum(cause.probability for cause in true), evidence)


def _played(estimator, scene, start, seconds, there, own, slip, random):
    """Let the estimator see a machine with a slip at an operating point; yield the time [s] after each second."""
    ideal = float(samples(scene, np.zeros(1), there[None], np.array([own]))["ideal_cage_speed"][0])
    for second in range(round(seconds)):
        times = start + second + (np.arange(RATE) + 1.0) / RATE
        for when in times:
            estimator.measure(float(when), (1.0 - slip - NOISE * random.normal()) * ideal)
        estimator.update(samples(scene, times, np.repeat(there[None], len(times), axis=0), np.full(len(times), own)))
        yield float(times[-1])


def confusion(found: Sequence[Verdict]) -> dict[str, Counter]:
    """Return how often each cause was named, by the group of the fault that it was."""
    table: dict[str, Counter] = {}
    for one in found:
        table.setdefault(one.fault.group, Counter())[one.named] += 1
    return table


class Findings(NamedTuple):
    """What a study of the estimator found; fractions, slip and seconds.

    Attributes
    ----------
    runs : machines.
    field_coverage : of the 90 % intervals of calibrated fields, over all fields and runs.
    slip_coverage : of the 90 % intervals of slip, early and late in a plateau.
    error, stated, open_loop : root mean square error of the prediction early and late, half the mean width of its interval, and root mean square
        error of the scene's own values.
    worse_runs : machines in which the prediction's root mean square error was larger than that of the scene's own values by more than is stated.
    worse_instants : number of single predictions that were off by more than the scene's own values by more than is stated.
    worse_expected : the number of these to be expected of predictions that are exactly as sure as they say: where the scene's own values happen to be
        right, one in ten lies outside of its 90 % interval.
    instants : number of single predictions.
    alarms : in all runs, in which nothing changes but slowly.
    hours : of all runs.
    core : fraction of a processor's core that the estimator takes beside a sensor of `RATE`.
    by_field : coverage, and mean width over that before any measurement, by path.
    """

    runs: int
    field_coverage: float
    slip_coverage: tuple[float, float]
    error: tuple[float, float]
    stated: tuple[float, float]
    open_loop: tuple[float, float]
    worse_runs: int
    worse_instants: int
    worse_expected: float
    instants: int
    alarms: int
    hours: float
    core: float
    by_field: dict[str, tuple[float, float]]


def findings(response: ResponseModel, judged: Sequence[Judgement], calibrated: Sequence[str]) -> Findings:
    """Return what judgements of several machines amount to.

    Parameters
    ----------
    response : of the scene.
    judged : of each machine.
    calibrated : paths of the calibrated fields.
    """
    names = [name for name in response.names if name in calibrated]
    fields, widths = (np.array([getattr(one, name) for one in judged]) for name in ("fields", "widths"))
    slips, errors, stated, own = (np.array([getattr(one, name) for one in judged]) for name in ("slips", "errors", "stated", "open_loop"))

    def mean_square(values: np.ndarray, axis: tuple[int, ...]) -> np.ndarray:
        return np.sqrt(np.mean(values**2, axis=axis))

    worse = mean_square(errors, (1, 2)) > mean_square(own, (1, 2)) + stated.mean(axis=(1, 2))
    return Findings(
        len(judged),
        float(fields.mean()),
        tuple(map(float, slips.mean(axis=(0, 1)))),
        tuple(map(float, mean_square(errors, (0, 1)))),
        tuple(map(float, stated.mean(axis=(0, 1)))),
        tuple(map(float, mean_square(own, (0, 1)))),
        int(worse.sum()),
        int(np.sum(np.abs(errors) > np.abs(own) + stated)),
        float(sum(one.chances.sum() for one in judged)),
        errors.size,
        int(sum(one.alarms for one in judged)),
        len(judged) * errors.shape[1] * _PLATEAU / _HOUR,
        sum(one.seconds for one in judged) / (len(judged) * errors.shape[1] * _PLATEAU),
        {name: (float(fields[:, k].mean()), float(widths[:, k].mean())) for k, name in enumerate(names)},
    )
