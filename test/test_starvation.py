# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Starved inlets: SKF's exponent by hand, the closed inversion against a root search, where starvation counts, and what lives take of it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_films import load_rating, starved

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.levels.common.model import films_at
from bearing_sim.model.films import films_of
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import pack, replenishment
from bearing_sim.physics.starvation import (
    Starvation,
    loaded_fraction,
    starvation_exponent,
    starvation_rate,
    starved_film,
    starved_resistance,
)
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml

RPM = math.pi / 30


def motor(*overrides, bearing="NU 210", oil="ISO VG 150", celsius=30.0, rpm=3000, load=5000.0, level="slip"):
    """A catalogue bearing in oil, whose block has neither starvation nor mixed_friction."""
    operating = {"shaft_speed": f"{rpm} rpm", "radial_load": f"{load} N"}
    tree = {"name": "motor", "level": level, "bearing": bearing, "lubricant": {"oil": oil, "temperature": f"{celsius} degC"}, "operating": operating}
    return load_scene(tree, overrides)


@pytest.mark.parametrize(
    ("constant", "bore", "outside", "rpm", "viscosity", "expected"),
    [
        # NU 210 at 9000 rpm and 12 mm2/s: 3e-8 x 12 x 9000 x 140 sqrt(5.1/80)
        (3e-8, 50.0, 90.0, 9000, 12.0, 0.114528),
        # NU 232 in grease at 1500 rpm and 320 mm2/s: 6e-8 x 320 x 1500 x 450 sqrt(5.1/260)
        (6e-8, 160.0, 290.0, 1500, 320.0, 1.81513),
    ],
)
def test_the_exponent_of_two_bearings_is_that_of_skf_by_hand_whichever_way_the_shaft_turns(constant, bore, outside, rpm, viscosity, expected):
    starvation = Starvation(starvation_rate(constant, 1e-3 * bore, 1e-3 * outside), True)
    for way in (1, -1):
        assert starvation_exponent(way * rpm * RPM, 1e-6 * viscosity, starvation) == pytest.approx(expected, rel=1e-5)


@given(st.floats(1e-8, math.log(5.0)))
@settings(max_examples=300)
def test_the_film_is_that_of_a_root_search_of_the_published_equation(exponent):
    film, resistance = starved(exponent)
    # 1 - exp(-x) keeps 8 of 16 digits at 1e-8
    assert starved_film(exponent) == pytest.approx(film, abs=1e-12, rel=1e-12 + 1e-16 / exponent)
    assert starved_resistance(exponent) == pytest.approx(resistance, rel=1e-15)


def test_full_inlets_leave_film_and_resistance_exactly():
    assert starved_film(0.0) == 1.0 and starved_resistance(0.0) == 1.0
    # 30.3/S of the resistance is missing where the meniscus is far, and 1/(0.75 S) of the film
    assert (1.0 - starved_film(1e-6)) / 1e-6 == pytest.approx(1.0 / (0.75 * (193.1 - 162.8)), rel=1e-4)


def test_film_and_resistance_fall_with_the_exponent_the_resistance_faster_to_a_fifth():
    exponents = np.linspace(0.0, math.log(5.0), 400)
    film, resistance = (np.array([law(each) for each in exponents]) for law in (starved_film, starved_resistance))
    assert (np.diff(film) < 0.0).all() and (np.diff(resistance) < 0.0).all() and (film[1:] > resistance[1:]).all()
    assert resistance[-1] == pytest.approx(0.2) and film[-1] == pytest.approx(0.6, abs=1e-3)  # S = 2
    for beyond in (1.7, 5.0, 1e3, 1e300):
        assert starved_resistance(beyond) == resistance[-1] and starved_film(beyond) == film[-1]


@pytest.mark.parametrize("bearing", ["deng2017_table1", "NU 210", "NU 232"])
def test_a_bearing_counts_as_loaded_from_the_makers_minimum_load_on_and_wholly_from_half_as_much_more(bearing):
    scene = motor(bearing=bearing)
    minimum_load, speed = pack(scene).minimum_load, scene.operating.shaft_speed
    limits, pitch = scene.bearing.ratings, scene.bearing.pitch_diameter
    if limits.minimum_load_factor is None:
        least = 0.02 * load_rating(18, 3.5e-3, 7e-3, 7 / 62.75)  # Deng's bearing
    else:
        least = limits.minimum_load_factor * (6.0 + 4.0 * 3000 * RPM / limits.reference_speed) * (pitch / 0.1) ** 2
    for share, counts in ((0.0, 0.0), (0.5, 0.0), (1.0, 0.0), (1.1, 0.2), (1.25, 0.5), (1.5, 1.0), (7.0, 1.0)):
        for way in (1.0, -1.0):
            assert loaded_fraction(way * speed, share * least, minimum_load) == pytest.approx(counts, abs=1e-4)


def films_of_run(scene):
    run = Simulation(scene)
    return films_at(0.0, run.inputs.shaft_speed, run._model(run.inputs, 1.0))


def test_a_scene_may_say_that_contacts_are_starved_below_the_minimum_load_too():
    light, starved_too = [], "lubricant.starvation={law: skf, under_minimum_load: starved}"
    for load in (100.0, 5000.0):
        plain, told = films_of_run(motor(load=load)), films_of_run(motor(starved_too, load=load))
        light.append(plain.resistance)
        assert told.resistance == pytest.approx(films_of_run(motor(load=5000.0)).resistance, rel=1e-12)
    assert light[0] == 1.0 > light[1] + 0.05


def test_contacts_without_starvation_are_full_under_any_load():
    for load in (100.0, 5000.0):
        films = films_of_run(motor("lubricant.starvation=none", load=load))
        assert (films.log_film, films.resistance) == (0.0, 1.0)


@pytest.mark.parametrize("level", ["slip", "planar", "steady"])
@pytest.mark.parametrize("bearing", ["NU 210", "NU 2308"])
def test_kappa_of_lives_is_that_of_starved_films_whatever_the_load(bearing, level):
    found = {}
    for load in (100.0, 20e3):
        for law in ("none", "skf"):
            run = Simulation(motor(f"lubricant.starvation={law}", "heat.law=none", bearing=bearing, load=load, level=level))
            found[load, law] = float(run.advance(2e-3)["viscosity_ratio"][0])
    oil, bearing = oil_at(run.scene.lubricant.oil, 303.15), run.scene.bearing
    nu, d_m = 1e6 * oil.viscosity / oil.density, 1e3 * bearing.pitch_diameter
    bore, outside = 1e3 * bearing.bore_diameter, 1e3 * bearing.outside_diameter
    exponent = 3e-8 * nu * 3000 * (bore + outside) * math.sqrt(5.1 / (2 * (outside - bore)))
    assert exponent > 0.5
    for load in (100.0, 20e3):
        assert found[load, "none"] == pytest.approx(nu / (4500 / math.sqrt(3000 * d_m)), rel=1e-6)
        assert found[load, "skf"] == pytest.approx(found[load, "none"] * starved(min(exponent, math.log(5)))[0] ** 1.3, rel=1e-6)


def test_films_are_told_as_lives_take_them_and_as_drag_takes_them():
    light, heavy = (films_of(scene := motor(load=load), Simulation(scene).sample) for load in (100.0, 5000.0))
    assert light.left == heavy.left < 0.95 and light.drag_left == 1.0 and heavy.drag_left == pytest.approx(heavy.left)
    assert "on the safe side below the minimum load" in light.text and "on the safe side" not in heavy.text


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ([], 3e-8),
        (["lubricant.supply=oil_air"], 6e-8),
        (["lubricant.grease=lithium NLGI 2"], 6e-8),
        (["lubricant.supply=oil_bath"], 3e-8),
        (["lubricant.supply={law: oil_bath, level: 6 mm}"], 0.0),  # above half a roller of 11 mm
        (["lubricant.supply={law: oil_bath, level: 6 mm}", "lubricant.starvation.constant=1e-8"], 1e-8),
        (["lubricant.starvation={constant: 0}"], 0.0),
        (["lubricant.starvation=none"], 0.0),
    ],
)
def test_the_constant_is_the_scenes_or_that_of_its_supply(overrides, expected):
    scene = motor(*overrides)
    assert replenishment(scene.lubricant, 5.5e-3) == expected
    assert pack(scene).starvation.rate == pytest.approx(starvation_rate(expected, 0.05, 0.09), rel=1e-12)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


def test_the_minimum_load_is_that_of_the_makers_rule_by_hand():
    # NU 210: 0.15 kN (6 + 4 x 3000/8500) (70.5/100)^2
    limit = pack(motor()).minimum_load
    assert limit.at_rest + limit.by_speed * 3000 * RPM == pytest.approx(552.6, abs=0.1)


@pytest.mark.parametrize(
    ("overrides", "told"),
    [
        (
            ["lubricant.rolling_resistance={law: hydrodynamic, replenishment: 3e-8}"],
            "lubricant.rolling_resistance.replenishment.*no longer a field; K_rs is lubricant.starvation.constant",
        ),
        (["lubricant.starvation=skff"], "skf"),
        (["lubricant.starvation={constant: 1e-5}"], "lubricant.starvation.constant"),
        (["lubricant.starvation.under_minimum_load=dry"], "'flooded' or 'starved'"),
    ],
)
def test_what_cannot_be_is_refused_with_what_to_say_instead(overrides, told):
    with pytest.raises(SceneError, match=told):
        motor(*overrides)


def test_less_oil_between_rollers_lets_the_cage_slip_less_where_the_bearing_is_loaded():
    slips = [
        Simulation(motor(f"lubricant.starvation={law}", "lubricant.mixed_friction=none", load=1500.0)).advance(0.3)["cage_slip"][0]
        for law in ("none", "skf")
    ]
    assert 0.0 < slips[1] < slips[0]
