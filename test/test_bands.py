# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about bands and the response that they follow from: against closed forms, the level itself and NumPy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from made_up_response import FACTOR, FIELD, asking_scene, made_up_response

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.levels.steady.table import empty_table
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.studies.response_points import design, obtain_response, settled_points
from bearing_sim.studies.uncertainty_propagation import UncertaintyError
from bearing_sim.watchers.estimation import response as kept
from bearing_sim.watchers.estimation.bands import QUANTITIES, BandEstimator, quantiles
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import (
    ANSWERS,
    conditions_at,
    domain_of,
    fit_response,
    prior_draws,
    read_response,
    scene_fields,
    write_response,
)

SCENE = asking_scene()
CLEARANCE_BAND = QUANTITIES.index("running_clearance")
SLIP, LIFE, CLEARANCE = (ANSWERS.index(name) for name in ("cage_slip", "rating_life", "running_clearance"))
POINT = np.array([[3000.0, 700.0, 390.0, 0.3]])


@pytest.fixture(scope="module")
def response():
    return made_up_response(SCENE)


@pytest.fixture(scope="module")
def effects():
    return SlipAndOil(SCENE)


def samples(count=1, **values):
    own = {"shaft_speed": 3000.0, "load_y": 700.0, "oil_temperature": 390.0, "cage_slip": 0.02, "rating_life": 400.0, "modified_rating_life": 400.0}
    names = ("time", "damage", "shaft_speed", "load_y", "load_z", "oil_temperature", *ANSWERS)
    block = np.zeros(count, [(name, float) for name in names])
    for name, value in (own | {"running_clearance": -25e-6, "viscosity_ratio": 1.0} | values).items():
        block[name] = value
    return block


def settled(scene, inputs):
    return Simulation(scene, inputs, empty_table()).advance(1e4, samples=2)[-1]


@pytest.mark.parametrize(("product", "within"), [(0.0, 1e-12), (0.4e-5, 2e-8)])
def test_what_is_quadratic_in_each_field_is_met_to_rounding_and_products_to_a_fiftieth(product, within):
    scene = load_scene(
        "deng2017_table1", ["uncertainty=null", f"uncertainty.{FIELD}=[0.02, 0.06]", "uncertainty.lubricant.traction_scale=[0.8, 1.2]"]
    )
    fields, (conditions, scores), effects = scene_fields(scene), design(scene, 2048), SlipAndOil(scene)

    def clearance(scores):
        first, second = fields.fractions_of(scores).T
        return 1e-5 * (1.0 + first - 0.7 * second - 0.3 * second**2) + product * first * second

    answers = np.full((len(scores), len(ANSWERS)), 0.01)
    answers[:, CLEARANCE] = clearance(scores)
    model = fit_response(fields, domain_of(scene), conditions, scores, answers, effects)
    drawn = prior_draws(2, 64, seed=5)
    assert model.respond(POINT, drawn, effects)[0, :, CLEARANCE] == pytest.approx(clearance(drawn), abs=within)


def test_slip_rises_with_a_field_that_raises_it_at_every_operating_point(response, effects):
    points = conditions_at(np.random.default_rng(3).random((40, 4)), response.domain)
    slips = response.respond(points, np.linspace(-2.0, 2.0, 21)[:, None], effects)[:, :, SLIP]
    assert (np.diff(slips, axis=1) > 0.0).all()


def test_answers_repeat_with_the_lobes_of_the_raceway_and_mirror_with_the_sense_of_rotation(response, effects):
    domain, scores = response.domain, np.array([[0.7]])
    turned, reversed_ = POINT.copy(), POINT.copy()
    turned[:, 3] += domain.period
    reversed_[:, 0], reversed_[:, 3] = -POINT[:, 0], 2.0 * domain.mirror - POINT[:, 3]
    there, *others = (response.respond(point, scores, effects)[0, 0, :4] for point in (POINT, turned, reversed_))
    assert domain.period == pytest.approx(2.0 * math.pi / 3.0)
    for other in others:
        assert other == pytest.approx(there, rel=1e-6)


@pytest.mark.parametrize(("column", "end"), [(0, "speeds"), (1, "loads"), (2, "temperatures")])
def test_a_response_says_where_it_has_no_answer(response, effects, column, end):
    beyond = POINT.copy()
    beyond[:, column] = 1.01 * getattr(response.domain, end)[1]
    assert response.outside(beyond).all() and not response.outside(POINT).any()
    assert np.isnan(response.respond(beyond, np.zeros((1, 1)), effects)[0, 0, :4]).all()
    block = samples(2)
    block[("shaft_speed", "load_y", "oil_temperature")[column]][1] = beyond[0, column]
    edges = BandEstimator(SCENE, response).estimate(block)
    assert np.isfinite(edges[0]).all() and np.isnan(edges[1, :3]).all()


def test_slip_changes_the_life_of_a_response_as_it_does_that_of_the_level(effects):
    inputs = Inputs(4000.0, 500.0, 150.0, 390.0)
    # tolerances at which the level doubles the angles of a pitch until they change its lives by less than 5e-5
    overrides = ["level=steady", *tolerance_overrides(0.01)]
    ends = [settled(load_scene("deng2017_table1", [f"{FIELD}={value}", *overrides]), inputs) for value in (0.02, 0.05)]
    slips, lives = (np.array([[float(end[name]) for end in ends]]) for name in ("cage_slip", "rating_life"))
    condition = np.array([[4000.0, math.hypot(500.0, 150.0), 390.0, math.atan2(150.0, 500.0)]])
    assert slips[0, 1] - slips[0, 0] > 0.01
    # the level takes means over a pitch in time and of a cage that ripples, the response over angles of an even one, fewer of them
    assert effects.by_slip(condition, slips)[0, 1] == pytest.approx(math.log(lives[0, 1] / lives[0, 0]), rel=5e-3)


@pytest.mark.parametrize(("method", "within"), [("iso281", 1e-9), ("iso16281", 2e-4)])
def test_oil_changes_the_life_of_a_response_as_it_does_that_of_the_level(method, within):
    scene = load_scene("deng2017_table1", ["level=steady", f"life.method={method}", "life.a_iso=bath_17_14"])
    ends = [settled(scene, Inputs(4000.0, 500.0, 0.0, kelvin)) for kelvin in (350.0, 400.0)]
    lives, ratios = (np.log([[float(end[name]) for end in ends]]) for name in ("rating_life", "viscosity_ratio"))
    modified = np.array([float(end["modified_rating_life"]) for end in ends])
    change = math.log(modified[1] / modified[0]) - (lives[0, 1] - lives[0, 0])
    found = SlipAndOil(scene).by_oil(np.array([[4000.0, 500.0, 350.0, 0.0]]), np.array([float(ends[0]["cage_slip"])]), lives, ratios)
    assert abs(change) > 0.1 and found[0] == pytest.approx([0.0, change], rel=within)


def test_a_written_response_is_read_as_it_was(response, effects, tmp_path):
    path = tmp_path / "response.bands.npz"
    write_response(path, response)
    write_response(path, response)  # over itself
    found, scores = read_response(path), prior_draws(1, 8)
    assert found.names == (FIELD,) and found.domain == response.domain
    assert found.respond(POINT, scores, effects) == pytest.approx(response.respond(POINT, scores, effects), rel=1e-7, nan_ok=True)
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("damage", [lambda data: b"", lambda data: data[:-7], lambda data: data[:99] + bytes([data[99] ^ 1]) + data[100:]])
def test_a_damaged_response_is_none(response, tmp_path, damage):
    path = tmp_path / "response.bands.npz"
    write_response(path, response)
    path.write_bytes(damage(path.read_bytes()))
    assert read_response(path) is None and read_response(tmp_path / "absent") is None


def test_a_response_is_kept_for_its_bearing_ranges_and_life_and_for_no_others(response, tmp_path, monkeypatch):
    monkeypatch.setattr(kept, "FOLDER", tmp_path)
    write_response(kept.response_path(SCENE), response)
    others = asking_scene(f"uncertainty.{FIELD}=[0.02, 0.07]"), asking_scene("bearing.roller.count=17"), asking_scene("life.reliability=0.95")
    assert kept.kept_response(asking_scene("operating.radial_load=300 N", "name=other")) is not None
    assert [kept.kept_response(other) for other in others] == [None] * 3


def test_the_response_of_the_demonstration_comes_with_the_package_and_is_that_of_this_code():
    assert read_response(kept.bundled_path(load_scene("deng2017_table1"))) is not None, "compiled code has changed: python test/bundle_response.py"


def test_a_bundled_response_belongs_to_its_scene_and_code_whatever_the_version_of_the_compiler(monkeypatch):
    path = kept.bundled_path(SCENE)
    monkeypatch.setattr("numba.__version__", "0.0")
    assert kept.bundled_path(SCENE) == path != kept.bundled_path(asking_scene("bearing.roller.count=17"))
    monkeypatch.setattr("bearing_sim.numerics.compilation._SOURCES", ("numerics/*.py",))
    assert kept.bundled_path(SCENE) != path


def test_what_no_response_can_be_fitted_to_is_refused_with_its_cause(response, effects):
    conditions, scores = design(SCENE, 2048)
    answers = np.full((len(scores), len(ANSWERS)), 0.01)
    with pytest.raises(ValueError, match="the same scores at each operating point"):
        fit_response(response.fields, response.domain, conditions, scores[::-1], answers, effects)
    answers[64:] = math.nan
    with pytest.raises(ValueError, match="1 of 32 operating points have answers; expected"):
        fit_response(response.fields, response.domain, conditions, scores, answers, effects)
    with pytest.raises(UncertaintyError, match="no uncertain fields.*mixture_fraction"):
        obtain_response(load_scene("deng2017_table1", ["uncertainty=null"]))


def test_edges_are_the_quantiles_of_a_known_distribution(response):
    slip, life, clearance, remaining = BandEstimator(SCENE, response).estimate(samples(damage=0.0))[0]
    ends = np.array([0.05, 0.95]) - 0.5  # of the field's share; half of its range is its own value
    own = response.fields.fractions_of(response.nominal[None])[0, 0] - 0.5
    assert slip == pytest.approx(0.02 * FACTOR ** (ends - own), rel=0.02)
    assert life == pytest.approx(400.0 * FACTOR ** (-0.2 * (ends[::-1] - own)), rel=0.01)
    assert clearance == pytest.approx(-25e-6 + 4e-6 * (ends - own), abs=4e-8)
    assert remaining == pytest.approx(life, rel=1e-6)


def response_of_few_points(scene, nodes, draws):
    """Return the response of a scene solved at few operating points."""
    fields, conditions = scene_fields(scene), conditions_at(np.random.default_rng(4).random((nodes, 4)), domain_of(scene))
    scores = np.concatenate([fields.scores_of(fields.own)[None], prior_draws(len(fields), draws)])
    conditions, scores = np.repeat(conditions, len(scores), axis=0), np.tile(scores, (nodes, 1))
    points = tuple(map(tuple, fields.values_of(scores).tolist()))
    answers = settled_points(scene, tuple(one.field for one in fields.ranges), points, tuple(map(tuple, conditions.tolist())))["answers"]
    return fit_response(fields, domain_of(scene), conditions, scores, np.array(answers), SlipAndOil(scene))


def test_clearance_has_the_band_that_ranges_of_heat_and_fits_give_it():
    warm, press = (140.0, 160.0), (40e-6, 60e-6)
    scene = load_scene(
        "deng2017_table1_cold",
        [
            "level=steady",
            "mounting.shaft={bore_radius: 0, interference: 50 um}",
            "heat={law: given, inner_ring: 150 degC, outer_ring: 130 degC}",
            "uncertainty=null",
            f"uncertainty.heat.inner_ring=[{warm[0]} degC, {warm[1]} degC]",
            f"uncertainty.mounting.shaft.interference=[{press[0]} m, {press[1]} m]",
        ],
    )
    inputs = Inputs(2000.0, 600.0, 0.0, 393.15)
    sample = settled(scene, inputs)
    edges = BandEstimator(scene, response_of_few_points(scene, 24, 8)).estimate(sample[None])[0, CLEARANCE_BAND]
    # A solid shaft of the ring's steel presses the raceway out by bore over raceway of its interference (Lame); rollers are as warm as the mean
    # of both rings.
    bearing, expansion = scene.bearing, scene.bearing.material.expansion
    raceway = 2.0 * bearing.inner_raceway.radius
    by_heat = expansion * (raceway + bearing.roller.diameter) * (warm[1] - warm[0])
    by_fit = bearing.bore_diameter / raceway * (press[1] - press[0])
    # The sum of two even distributions of widths a and b lies within x of its end with the probability x^2/(2 a b), up to the lesser width.
    farthest, at_end = 0.5 * (by_heat + by_fit), math.sqrt(2.0 * 0.05 * by_heat * by_fit)
    assert at_end < min(by_heat, by_fit)
    middle, half = float(sample["running_clearance"]), farthest - at_end
    assert edges == pytest.approx([middle - half, middle + half], abs=0.02 * 2.0 * half)
    assert half > 5e-6


def test_what_is_measured_has_no_band(response):
    edges = BandEstimator(SCENE, response, known=[FIELD]).estimate(samples(damage=0.3))[0]
    assert edges[:3] == pytest.approx(np.array([[0.02] * 2, [400.0] * 2, [-25e-6] * 2]), rel=1e-5)
    assert edges[3] == pytest.approx([0.7 * 400.0] * 2)


def test_remaining_life_is_that_of_each_draw_with_its_own_damage(response):
    memory = 100.0
    scene = replace(SCENE, thresholds=replace(SCENE.thresholds, remaining_life_memory=memory))
    block = samples(4, time=np.array([0.0, 50.0, 150.0, 400.0]), modified_rating_life=np.array([400.0, 100.0, 900.0, 300.0]))
    block["damage"] = [0.2, 0.3, 0.35, 0.5]
    found = BandEstimator(scene, response)
    edges = found.estimate(block)[:, QUANTITIES.index("remaining_life")]
    fraction = response.fields.fractions_of(prior_draws(1)) - response.fields.fractions_of(response.nominal[None])
    factor = FACTOR ** (0.2 * fraction[:, 0])  # of a draw's rate of damage: the same at all points
    mean = 1.0 / block["modified_rating_life"][0]
    for k in range(4):
        weight = 1.0 - math.exp(-(block["time"][k] - block["time"][max(k - 1, 0)]) / memory)
        mean += weight * (1.0 / block["modified_rating_life"][k] - mean)
        exact = np.clip(1.0 - block["damage"][k] * factor, 0.0, 1.0) / (mean * factor)
        assert edges[k] == pytest.approx(np.quantile(exact, (0.05, 0.95), method="hazen"), rel=2e-3)
        assert found.remaining_life[k] == pytest.approx((1.0 - block["damage"][k]) / mean)


def test_the_remaining_life_of_the_level_itself_goes_on_when_the_draws_change(response):
    block = samples(2, time=np.array([0.0, 10.0]), modified_rating_life=np.array([400.0, 100.0]))
    once, twice = BandEstimator(SCENE, response), BandEstimator(SCENE, response)
    once.estimate(block)
    twice.estimate(block[:1])
    twice.use(np.full((512, 1), 0.5))
    twice.estimate(block[1:])
    assert twice.remaining_life[0] == pytest.approx(once.remaining_life[1], rel=1e-12)


def test_an_unloaded_bearing_lives_for_ever_within_its_band(response):
    edges = BandEstimator(SCENE, response).estimate(samples(load_y=0.0, rating_life=math.inf, modified_rating_life=math.inf, damage=0.1))[0]
    assert np.isinf(edges[[1, 3]]).all() and np.isfinite(edges[[0, 2]]).all()


def test_samples_taken_together_have_the_bands_that_they_have_one_by_one(response):
    block = samples(5, time=np.arange(5.0), shaft_speed=np.array([3000.0, 3000.0, 2000.0, -2500.0, 0.0]), damage=0.1)
    single = BandEstimator(SCENE, response)
    apart = np.concatenate([single.estimate(block[k : k + 1]) for k in range(5)])
    assert BandEstimator(SCENE, response).estimate(block) == pytest.approx(apart, rel=1e-7, nan_ok=True)


def test_quantiles_are_numpys_and_unknown_where_a_value_is():
    values = np.random.default_rng(1).normal(size=(3, 64, 2))
    assert quantiles(values, (0.05, 0.5, 0.95)) == pytest.approx(np.moveaxis(np.quantile(values, (0.05, 0.5, 0.95), axis=1, method="hazen"), 0, 1))
    values[1, 7, 0] = math.nan
    assert np.isnan(quantiles(values, (0.5,))[:, 0]).tolist() == [[False, False], [True, False], [False, False]]
