# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The estimator against machines with known fields, whose slip is a closed form that only the response's polynomials have been fitted to."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.special import ndtri
from scipy.stats import qmc
from validation.estimator_command import estimator as study_estimator
from validation.estimator_study import CLEARANCE as STUDIED_CLEARANCE
from validation.estimator_study import PAUSE, TEMPERATURES, Machine, judge, machines, samples, wandering

from bearing_sim.scene.loader import load_scene
from bearing_sim.watchers.estimation.causes import CLEARANCE, LOAD, OIL, OIL_QUANTITY, SENSOR, TRACTION, Evidence, causes_of
from bearing_sim.watchers.estimation.estimator import Estimator, _Scatter
from bearing_sim.watchers.estimation.live import LiveEstimation
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import conditions_at, domain_of, fit_response, scene_fields, slip_scale

QUANTITY, SCALE, RADIUS = "lubricant.mixture_fraction", "lubricant.traction_scale", "bearing.outer_raceway.low_radius"
FIELDS = (QUANTITY, SCALE, RADIUS)
OTHERS = ("lubricant.temperature", "bearing.cage.guide_clearance", "bearing.cage.pocket_friction", "bearing.cage.land_friction")
NOISE = 0.002  # of a reading of slip
POINT = np.array([4712.0, 800.0, 393.15, 0.0])  # speed, load, oil temperature, direction of the load
COURSE = np.array([POINT, POINT * [0.6, 1.0, 1.0, 1.0], POINT * [1.0, 4.0, 1.0, 1.0], POINT * [0.7, 2.0, 1.03, 1.0], POINT * [1.1, 0.5, 0.98, 1.0]])


@pytest.fixture(scope="module")
def scene():
    ranges = [f"uncertainty.{path}=null" for path in OTHERS] + [f"uncertainty.{RADIUS}=[34.8600 mm, 34.8650 mm]"]
    return load_scene("deng2017_table1", ["level=steady", *ranges, f"estimation.calibrated=[{', '.join(FIELDS)}]"])


def slip_of(fields, scores, conditions):
    """Return the slip of a machine: oil and traction act as one at every condition, the clearance more, the lighter the load."""
    quantity, scale, radius = 4.0 * fields.fractions_of(np.asarray(scores)) - 2.0
    speed, load, kelvin = conditions[0] / 4712.0, conditions[1] / 800.0, (conditions[2] - 393.15) / 20.0
    free = 0.06 * speed * load**-0.6 * math.exp(0.3 * quantity - 0.2 * scale + 0.2 * radius * (1.0 - 0.4 * math.log(load)) - 0.1 * kelvin)
    return free / (1.0 + free)


@pytest.fixture(scope="module")
def response(scene):
    fields, domain = scene_fields(scene), domain_of(scene)
    points, draws = (qmc.Sobol(size, seed=np.random.default_rng(1)).random(128) for size in (4, 3))
    drawn = np.concatenate([fields.scores_of(fields.own)[None], ndtri(np.clip(draws[:31], 1e-5, 1.0 - 1e-5))])
    conditions, scores = np.repeat(conditions_at(points, domain), len(drawn), axis=0), np.tile(drawn, (len(points), 1))
    assert tuple(one.field for one in fields.ranges) == FIELDS
    return fit_response(fields, domain, conditions, scores, answers_of(fields, scores, conditions), SlipAndOil(scene))


def answers_of(fields, scores, conditions):
    """Return all answers of a machine, shape (n, 7): the raceway alone changes the clearance, the oil alone the temperatures of the rings."""
    answers, positions = np.empty((len(scores), 7)), 4.0 * fields.fractions_of(scores) - 2.0
    answers[:, 0] = [slip_of(fields, *each) for each in zip(scores, conditions)]
    answers[:, 1:3], answers[:, 3] = 300.0, 5e-6 * positions[:, 2]
    answers[:, 4:6], answers[:, 6] = 400.0 + 5.0 * positions[:, :1], 2.0
    return answers


class Rig:
    """A machine with a noisy cage sensor, beside the samples of the scene's own values."""

    def __init__(self, scene, response, scores, seed=0):
        self.scene, self.response, self.scores, self.now = scene, response, np.array(scores, float), 0.0
        self.random = np.random.default_rng(seed)

    def run(self, estimator, seconds, conditions=POINT, offset=0.0, wild=0.0, noise=NOISE):
        """Advance by seconds of one condition, second by second; return when a change was told first."""
        told = math.nan
        slip, own = slip_of(self.response.fields, self.scores, conditions) + offset, slip_of(self.response.fields, self.response.nominal, conditions)
        for _ in range(round(seconds)):
            times = self.now + 0.1 * np.arange(1.0, 11.0)
            block = samples(self.scene, times, np.repeat(conditions[None], 10, axis=0), np.full(10, own))
            readings = slip + noise * self.random.normal(size=10)
            readings[self.random.random(10) < wild] = -0.8
            for time, reading, ideal in zip(times, readings, block["ideal_cage_speed"]):
                estimator.measure(float(time), float((1.0 - reading) * ideal))
            estimator.update(block)
            self.now += 1.0
            if math.isnan(told) and any(event.kind == "calibration.change" for event in estimator.events(self.now)):
                told = self.now
        return told

    def sample(self, conditions=POINT):
        own = slip_of(self.response.fields, self.response.nominal, conditions)
        return samples(self.scene, np.array([self.now]), conditions[None], np.array([own]))[0]


def test_a_measured_cage_moves_the_prediction_to_it_and_narrows_its_band(scene, response):
    rig, estimator = Rig(scene, response, [1.0, -0.5, 0.6]), Estimator(scene, response)
    truth = slip_of(response.fields, rig.scores, POINT)
    before = estimator.prediction(rig.sample())
    rig.run(estimator, 120)
    after = estimator.prediction(rig.sample())
    assert after.mean() == pytest.approx(truth, abs=5e-4) and before.std() > 0.01
    assert abs(after.mean() - truth) < 3.0 * after.std() < 0.1 * before.std()


def test_quantity_and_traction_of_the_oil_cannot_be_told_apart_and_that_is_said(scene, response):
    rig, estimator = Rig(scene, response, [1.0, -0.5, 0.0]), Estimator(scene, response)
    for conditions in COURSE:
        rig.run(estimator, 30, conditions)
    known = {one.field: one for one in estimator.estimates()}
    shrunk = widths(estimator)
    assert any({QUANTITY, SCALE} <= set(group) for group in estimator.unresolved())
    assert shrunk[QUANTITY] > 0.4 and shrunk[SCALE] > 0.6, "each alone is nearly as uncertain as before"
    assert all(one.low <= response.fields.values_of(rig.scores)[k] <= one.high for k, one in enumerate(known.values()))


def widths(estimator):
    """Return the widths of all intervals over those before any measurement, by field."""
    return {one.field: (one.high - one.low) / (one.prior_high - one.prior_low) for one in estimator.estimates()}


def test_a_ring_temperature_that_follows_the_quantity_of_oil_tells_it_from_the_traction(scene, response):
    rig, estimator = Rig(scene, response, [1.0, -0.5, 0.0]), Estimator(scene, response)
    rig.run(estimator, 60)
    before = widths(estimator)
    warm = 5.0 * (4.0 * response.fields.fractions_of(rig.scores)[0] - 2.0)
    usual = 5.0 * (4.0 * response.fields.fractions_of(response.nominal)[0] - 2.0)
    block = np.repeat(rig.sample()[None], 600, axis=0)
    block["time"] = rig.now + 0.1 * np.arange(1.0, 601.0)
    block["inner_ring_temperature_uncorrected"] = 380.0
    block["inner_ring_temperature_measured"] = 380.0 + warm - usual + 0.5 * rig.random.normal(size=600)
    for first in range(0, 600, 10):
        estimator.update(block[first : first + 10])
    after = widths(estimator)
    assert after[QUANTITY] < 0.5 * before[QUANTITY]
    for found, truth in zip(estimator.estimates(), response.fields.values_of(rig.scores)):
        assert found.low <= truth <= found.high


def test_a_measured_clearance_teaches_the_raceway(scene, response):
    rig, live = Rig(scene, response, [0.0, 0.0, 0.8]), LiveEstimation(scene, response)
    prior = Estimator(scene, response).estimates()[2]
    positions = [4.0 * response.fields.fractions_of(scores)[2] - 2.0 for scores in (rig.scores, response.nominal)]
    for _ in range(20):
        live.measure_clearance(rig.now + 0.05, 5e-6 * (positions[0] - positions[1]) + 2e-6 * rig.random.normal())
        block = np.repeat(rig.sample()[None], 1, axis=0)
        block["time"] = rig.now = rig.now + 0.1
        live.see(block)
    _, low, high = live.estimates[RADIUS]
    assert high - low < 0.6 * (prior.high - prior.low) and low <= response.fields.values_of(rig.scores)[2] <= high


@pytest.mark.parametrize(("sensor", "field", "pause"), [(TEMPERATURES, QUANTITY, PAUSE), (STUDIED_CLEARANCE, RADIUS, 0.0)])
def test_a_machine_of_the_study_with_another_sensor_teaches_what_its_cage_alone_does_not(scene, response, sensor, field, pause):
    scores, column = np.array([1.0, -0.5, 0.8]), FIELDS.index(field)
    own, answers = (answers_of(response.fields, each[None], COURSE[:1]) for each in (response.nominal, scores))
    machine = Machine(COURSE[:1], scores, own, np.stack([answers, answers], axis=1), pause)
    alone, both = (judge(scene, response, machine, 1, measured=measured) for measured in ((), (sensor,)))
    assert both.widths[column] < 0.6 * alone.widths[column] and both.fields.all() and both.alarms == 0


def test_hidden_fields_of_the_study_wander_as_the_scene_says_and_inputs_do_not(scene):
    free, seconds = np.arange(4000) > 0, np.array([1.0, 1800.0, 60.0])
    drifting = replace(scene, estimation=replace(scene.estimation, drift=replace(scene.estimation.drift, wander_time=7200.0)))
    rows = wandering(drifting, free, np.zeros(4000), seconds, np.random.default_rng(2))
    assert rows.shape == (4, 4000) and (rows[:, 0] == 0.0).all()
    assert rows[:, 1:].std(axis=1) == pytest.approx(1.0, abs=0.04), "they stay within their ranges"
    assert np.square(np.diff(rows, axis=0))[:, 1:].mean(axis=1) == pytest.approx(2.0 * (1.0 - np.exp(-seconds / 14400.0)), rel=0.1)


def test_a_machine_of_the_study_is_solved_for_within_its_plateaus_and_jumps_over_the_pause(scene, response):
    (machine,) = machines(scene, response, 1, 3, count=2, pause=PAUSE, every=20.0, workers=1)
    assert machine.answers.shape == (2, 4, 7) and machine.own.shape == (2, 7) and machine.scores.shape == (3,)
    slips = machine.at(0, np.array([1e-9, 20.0, 30.0, 30.1, 60.0]))[:, 0]
    start, before, after, end = machine.answers[0, :, 0]
    assert slips == pytest.approx([start, before, before + 10.0 / 1820.0 * (after - before), after - 9.9 / 1820.0 * (after - before), end], rel=1e-6)


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (TEMPERATURES, "--measure temperatures: deng2017_table1 computes no ring temperatures; give it heat.law: network"),
        (STUDIED_CLEARANCE, "--measure clearance: no uncertain field of deng2017_table1 changes its running clearance"),
    ],
)
def test_the_study_refuses_a_sensor_that_says_nothing_about_the_scene(monkeypatch, sensor, message):
    of_slip_alone = SimpleNamespace(varied_answers=lambda: [0])
    monkeypatch.setattr("bearing_sim.studies.response_points.obtain_response", lambda *_: of_slip_alone)
    result = CliRunner().invoke(study_estimator, ["deng2017_table1", "--measure", sensor])
    assert result.exit_code == 2 and message in " ".join(result.output.split())


def test_a_field_that_is_not_calibrated_keeps_its_range(scene, response):
    rig, estimator = Rig(scene, response, [1.0, 1.0, 0.0]), Estimator(load_at(scene, QUANTITY), response)
    rig.run(estimator, 60)
    by_field = {one.field: one for one in estimator.estimates()}
    for path in (SCALE, RADIUS):
        one = by_field[path]
        assert not one.calibrated and one.low == one.prior_low and one.high == one.prior_high


def load_at(scene, *calibrated):
    """Return the scene with other calibrated fields."""
    return replace(scene, estimation=replace(scene.estimation, calibrated=calibrated))


def test_one_wild_reading_in_five_leaves_the_prediction_where_the_others_are(scene, response):
    rig, estimator = Rig(scene, response, [0.5, 0.5, 0.5]), Estimator(scene, response)
    told = rig.run(estimator, 200, wild=0.2)
    assert estimator.prediction(rig.sample()).mean() == pytest.approx(slip_of(response.fields, rig.scores, POINT), abs=1.5e-3)
    assert math.isnan(told)


def test_two_readings_between_which_the_machine_changes_have_a_mean():
    """Their median lies far from both; a mean of nothing, NaN, was learned for good and no change told any more."""
    scatter = _Scatter(5e-4)
    mean, variance = scatter.mean(np.array([0.06, 0.10]))
    assert mean == pytest.approx(0.08) and 0.0 < variance < 1e-6 and all(map(math.isfinite, scatter.learned))


def test_a_silent_sensor_changes_nothing_and_time_widens_what_is_known(scene, response):
    rig, estimator = Rig(scene, response, [1.0, 0.0, 0.0]), Estimator(scene, response)
    rig.run(estimator, 60)
    known = estimator.prediction(rig.sample())
    estimator.posterior.wait(0.2 * scene.estimation.drift.wander_time)
    later = estimator.prediction(rig.sample())
    assert later.mean() == pytest.approx(known.mean(), abs=2e-3) and later.std() > 2.0 * known.std()


def test_readings_from_before_a_pause_say_nothing_about_what_has_wandered_in_it(scene, response):
    wandering_fast = replace(scene, estimation=replace(scene.estimation, drift=replace(scene.estimation.drift, wander_time=7200.0)))
    rig, estimator = Rig(wandering_fast, response, [0.0, 0.0, 0.0]), Estimator(wandering_fast, response)
    rig.run(estimator, 150)
    rig.now, rig.scores = rig.now + 1800.0, rig.scores + [0.7, 0.0, 0.0]
    told = rig.run(estimator, 5)
    assert math.isnan(told) and estimator.change is None
    assert estimator.prediction(rig.sample()).mean() == pytest.approx(slip_of(response.fields, rig.scores, POINT), abs=2e-3)


def test_a_step_of_the_mixture_fraction_from_003_to_004_is_told_within_30_s_with_its_cause_among_those_named(scene, response):
    start, end = (response.fields.scores_of(np.array([quantity, 1.0, 34.8625e-3]))[0] for quantity in (0.03, 0.04))
    rig, estimator = Rig(scene, response, [start, 0.0, 0.0]), Estimator(scene, response)
    assert math.isnan(rig.run(estimator, 200))
    began, rig.scores[0] = rig.now, end
    told = rig.run(estimator, 40)
    assert told - began <= 30.0
    likeliest = estimator.change.causes[0]
    assert OIL_QUANTITY in {cause.group for cause in estimator.change.causes if cause.probability > likeliest.probability / 3.0}
    assert estimator.prediction(rig.sample()).mean() == pytest.approx(slip_of(response.fields, rig.scores, POINT), abs=2e-3)
    event = next(event for event in estimator.events(rig.now) if event.kind == "calibration.change")
    assert "likeliest cause" in event.reason
    explained = estimator.values(rig.now)["likeliest cause of the change"]
    assert "cannot be named without a range: cage and its guide (give uncertainty.bearing.cage.guide_clearance)" in explained


def test_what_no_field_explains_at_a_new_operating_point_is_learned_within_seconds(scene, response):
    rig, estimator = Rig(scene, response, [0.0, 0.0, 0.0]), Estimator(scene, response)
    rig.run(estimator, 20)
    there = COURSE[1]
    rig.run(estimator, 3, there, offset=0.012)
    assert estimator.prediction(rig.sample(there)).mean() == pytest.approx(slip_of(response.fields, rig.scores, there) + 0.012, abs=1.5e-3)


def test_measurements_far_from_all_that_the_ranges_allow_teach_nothing_and_are_told_until_they_end(scene, response):
    rig, estimator, there = Rig(scene, response, [0.0, 0.0, 0.0]), Estimator(scene, response), COURSE[2]
    rig.run(estimator, 70)
    before = estimator.prediction(rig.sample(there))
    offset = 15.0 * float(before.std())
    rig.run(estimator, 40, there, offset=offset)
    (event,) = estimator.events(rig.now)
    assert event.kind == "calibration.contradicted" and "measurements cannot be explained by any values in the ranges" in event.reason
    after = estimator.prediction(rig.sample(there))
    assert after.mean() == pytest.approx(before.mean(), abs=before.std()) and after.std() == pytest.approx(before.std(), rel=0.2)
    rig.run(estimator, 40, there)
    assert estimator.events(rig.now) == []
    assert estimator.prediction(rig.sample(there)).mean() == pytest.approx(slip_of(response.fields, rig.scores, there), abs=1.5e-3)


def test_the_stated_error_of_a_known_point_is_that_of_a_scalar_filter_and_a_quarter_of_the_noise_each_once(scene, response):
    wandering_fast = replace(scene, estimation=replace(scene.estimation, drift=replace(scene.estimation.drift, wander_time=7200.0)))
    rig, estimator = Rig(wandering_fast, response, [0.5, 0.5, 0.5]), Estimator(wandering_fast, response)
    rig.run(estimator, 100)
    drawn = ndtri(np.random.default_rng(4).uniform(size=(2000, 3)))
    prior = np.var([slip_of(response.fields, each, POINT) for each in drawn]) + scene.estimation.model_error.slip**2
    walk, noise = prior / 7200.0, NOISE**2 / 10.0  # variances: of a second of wandering, and of a mean of ten readings
    expected = 0.5 * (walk + math.sqrt(walk**2 + 4.0 * walk * noise))  # Riccati's equation of the scalar filter, before a measurement
    stated = math.hypot(math.sqrt(expected * noise / (expected + noise)), 0.25 * NOISE)
    assert estimator.prediction(rig.sample()).std() == pytest.approx(stated, rel=0.08)


def test_a_response_says_that_it_errs_in_proportion_to_the_departure_and_by_how_much_where(response):
    random = np.random.default_rng(3)
    points, scores = conditions_at(random.random((40, 4)), response.domain), ndtri(random.uniform(0.01, 0.99, (64, 3)))
    proportions, least = response.error_scales(points, 0)
    assert proportions.shape == least.shape == (len(points),) and (proportions > 0.0).all() and (least > 0.0).all()
    found = response.respond_scaled(points, response.basis_of(np.concatenate([response.nominal[None], scores])))[:, :, 0]
    truth = slip_scale(np.array([[slip_of(response.fields, each, conditions) for each in (response.nominal, *scores)] for conditions in points]))
    departures = truth[:, 1:] - truth[:, :1]
    errors = (found[:, 1:] - found[:, :1] - departures) / np.hypot(proportions[:, None] * departures, least[:, None])
    sizes = np.sqrt(np.mean(errors**2, axis=1))
    assert 0.5 < np.sqrt(np.mean(sizes**2)) < 1.5 and np.mean((sizes > 0.2) & (sizes < 2.0)) > 0.9


def test_an_alarm_ends_when_the_machine_is_as_before_or_when_the_change_is_accepted(scene, response):
    rig, estimator = Rig(scene, response, [0.0, 0.0, 0.0]), Estimator(scene, response)
    rig.run(estimator, 150)
    rig.run(estimator, 15, offset=0.03)
    assert estimator.change is not None
    rig.run(estimator, 60)
    assert estimator.change is None and estimator.events(rig.now) == []
    rig.run(estimator, 15, offset=0.03)
    estimator.accept()
    assert estimator.change is None and math.isnan(rig.run(estimator, 60, offset=0.03))


@pytest.mark.parametrize(
    ("group", "change"),
    [
        (CLEARANCE, lambda scores, conditions: (scores + [0.0, 0.0, 1.6], conditions, 1.0)),
        (LOAD, lambda scores, conditions: (scores, conditions * [1.0, 0.6, 1.0, 1.0], 1.0)),
        (SENSOR, lambda scores, conditions: (scores, conditions, 0.97)),
        (OIL_QUANTITY, lambda scores, conditions: (scores + [1.3, 0.0, 0.0], conditions, 1.0)),
    ],
    ids=["clearance", "load", "sensor", "quantity"],
)
def test_a_change_at_several_operating_points_is_named_after_its_cause_or_after_one_that_acts_alike(scene, response, group, change):
    estimator = Estimator(scene, response)
    rig = Rig(scene, response, [0.0, 0.0, -0.5])
    for conditions in COURSE:
        rig.run(estimator, 20, conditions)
    before = estimator.posterior
    rows = []
    for conditions in COURSE:
        scores, actual, scale = change(rig.scores, conditions)
        own, slip = slip_of(response.fields, response.nominal, conditions), slip_of(response.fields, scores, actual)
        rows.append((conditions, own, 1.0 - scale * (1.0 - slip) - own, 4e-7))
    evidence = Evidence(*(np.array(column) for column in zip(*rows)))
    causes = causes_of(scene, response, before, evidence)
    assert sum(cause.probability for cause in causes) == pytest.approx(1.0)
    factors = {OIL_QUANTITY, TRACTION, OIL, LOAD}  # slip grows by a factor that is nearly the same at all conditions
    assert causes[0].group in (factors if group in factors else {group})


def test_what_was_learned_survives_a_restart_as_json(scene, response):
    rig, estimator = Rig(scene, response, [1.0, -0.5, 0.6]), Estimator(scene, response)
    for conditions in COURSE[:2]:
        rig.run(estimator, 70, conditions)
    other = Estimator(scene, response)
    other.restore(json.loads(json.dumps(estimator.learned)))
    now, then = (each.prediction(rig.sample(COURSE[1])) for each in (estimator, other))
    assert then.mean() == pytest.approx(now.mean(), abs=2e-4) and then.std() == pytest.approx(now.std(), rel=0.3)
    assert other.is_calibrated and Estimator(scene, response).learned == {}


@pytest.mark.parametrize(
    "broken", [{"ranges": 1}, {"measured": [["cage_slip", 1.0]]}, {"measured": [["x", *[1.0] * 8]]}, {"noise": [0, 1, 2, 3]}, {"updates": "x"}]
)
def test_a_broken_posterior_is_refused_and_leaves_the_ranges_of_the_scene(scene, response, broken):
    rig, estimator = Rig(scene, response, [1.0, 0.0, 0.0]), Estimator(scene, response)
    rig.run(estimator, 20)
    other = Estimator(scene, response)
    if "ranges" in broken:
        other.restore({**estimator.learned, **broken})
    else:
        with pytest.raises((KeyError, TypeError, ValueError)):
            other.restore({**estimator.learned, **broken})
    assert not other.is_calibrated
