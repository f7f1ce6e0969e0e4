# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Laws of traction beside the default one: Kragelskii from the properties of its course, the thermal Eyring film from its equations."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT, ROLLING_SPEED_FLOOR
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.traction import _MOST_CORRECTIONS, STEP, _shear, kragelskii_coefficients, traction

LAWS = {
    "kragelskii": ["lubricant.traction.law=kragelskii"],
    "kragelskii with mu_0": ["lubricant.traction={law: kragelskii, mu_0: 0.02}"],
    "kragelskii falling": ["lubricant.traction={law: kragelskii, mu_0: 0.04, mu_inf: 0.01}"],
    "eyring": ["lubricant.traction.law=eyring"],
    "eyring, thick oil": ["lubricant.traction.law=eyring", "lubricant.oil=mil_l_23699", "lubricant.temperature=20 degC"],
    "eyring, cold oil": ["lubricant.traction.law=eyring", "lubricant.oil=mil_l_23699", "lubricant.temperature=-30 degC"],
}


def lubricated(overrides):
    scene = load_scene("deng2017_table1", overrides)
    params = pack(scene)
    return scene, params, lubricate(scene.lubricant, params, scene.lubricant.temperature)


LUBRICATIONS = {name: lubricated(overrides) for name, overrides in LAWS.items()}


def contact(name, sliding, load=1000.0, rolling=73.0, ring=0, films=FULL_FILMS):
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding], contacts[:, CONTACT.load] = rolling, sliding, load
    lubrication = LUBRICATIONS[name][2]
    traction(contacts, lubrication.inner, lubrication.outer, films)
    return contacts[ring, :, 1]


@pytest.mark.parametrize(
    ("mu_0", "mu_max", "v_max", "mu_inf"), [(0.0, 0.05, 1.0, 0.036), (0.02, 0.08, 0.3, 0.07), (0.04, 0.05, 2.0, 0.01), (0.0, 0.1, 5.0, 0.0)]
)
def test_kragelskiis_course_has_the_four_properties_it_is_made_from(mu_0, mu_max, v_max, mu_inf):
    a, b, c, d = kragelskii_coefficients(mu_0, mu_max, v_max, mu_inf)
    v = np.linspace(0, 60 * v_max, 600_001)
    mu = (a + b * v) * np.exp(-c * v) + d
    assert mu[0] == pytest.approx(mu_0, abs=1e-12) and mu[-1] == pytest.approx(mu_inf, abs=1e-9)
    assert mu.max() == pytest.approx(mu_max, rel=1e-7) and v[mu.argmax()] == pytest.approx(v_max, abs=2e-4 * v_max)


@pytest.mark.parametrize("name", ["kragelskii", "kragelskii with mu_0", "kragelskii falling"])
@pytest.mark.parametrize(("sliding", "rolling"), [(0.2, 73.0), (1.0, 73.0), (1.0, 5.0), (-30.0, 73.0)])
def test_kragelskiis_law_goes_by_sliding_speed_alone(name, sliding, rolling):
    law = LUBRICATIONS[name][0].lubricant.traction
    a, b, c, d = kragelskii_coefficients(law.mu_0, law.mu_max, law.v_max, law.mu_inf)
    expected = math.copysign(1000 * ((a + b * abs(sliding)) * math.exp(-c * abs(sliding)) + d), sliding)
    assert contact(name, sliding, rolling=rolling)[CONTACT.force] == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("name", LAWS)
@given(st.floats(-100, 100), st.floats(-150, 150), st.floats(0, 2e4))
@settings(max_examples=200)
def test_every_law_is_odd_bounded_and_finite(name, sliding, rolling, load):
    ahead, back = contact(name, sliding, load, rolling), contact(name, -sliding, load, rolling)
    assert back[CONTACT.force] == pytest.approx(-ahead[CONTACT.force], rel=1e-12, abs=1e-12)
    assert abs(ahead[CONTACT.force]) <= 0.0751 * load
    assert np.isfinite(ahead[[CONTACT.force, CONTACT.d_sliding, CONTACT.d_rolling, CONTACT.d_load]]).all()


@pytest.mark.parametrize("name", LAWS)
def test_every_law_vanishes_without_sliding_and_without_load(name):
    assert contact(name, 0.0)[CONTACT.force] == 0.0 and contact(name, 1.0, load=0.0)[CONTACT.force] == 0.0
    near, nearer = contact(name, 1e-7), contact(name, 1e-9)
    assert near[CONTACT.force] == pytest.approx(1e-7 * near[CONTACT.d_sliding], rel=1e-3)
    assert nearer[CONTACT.d_sliding] == pytest.approx(near[CONTACT.d_sliding], rel=1e-3)


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(
    ("sliding", "load", "rolling", "ring"), [(0.3, 600.0, 50.0, 0), (-2.0, 1500.0, 70.0, 1), (20.0, 300.0, 60.0, 0), (1e-3, 40.0, -20.0, 1)]
)
def test_slopes_of_every_law_are_finite_differences(name, sliding, load, rolling, ring):
    def slope(by, step):
        values = {"sliding": sliding, "load": load, "rolling": rolling}
        ahead, back = (contact(name, **{**values, by: values[by] + side * step}, ring=ring)[CONTACT.force] for side in (1, -1))
        return (ahead - back) / (2 * step)

    found = contact(name, sliding, load, rolling, ring)
    assert found[CONTACT.d_sliding] == pytest.approx(slope("sliding", 1e-4 * abs(sliding)), rel=1e-5, abs=1e-7)
    assert found[CONTACT.d_load] == pytest.approx(slope("load", 1e-3 * load), rel=1e-5, abs=1e-8)
    assert found[CONTACT.d_rolling] == pytest.approx(slope("rolling", 1e-3 * rolling), rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("name", ["eyring", "eyring, thick oil", "eyring, cold oil"])
@pytest.mark.parametrize("ring", [0, 1])
@pytest.mark.parametrize("left", [1.0, 0.6])  # of the film, by a starved inlet
@pytest.mark.parametrize(
    ("sliding", "load", "rolling"),
    [(0.05, 1e3, 73.0), (1.0, 1e3, 73.0), (20.0, 300.0, 60.0), (5.0, 2e3, 10.0), (60.0, 20.0, 90.0), (4e-3, 9e4, 1.0), (2e-4, 5e4, 0.01)],
)
def test_eyring_traction_solves_its_equations(name, ring, left, sliding, load, rolling):
    scene, params, _ = LUBRICATIONS[name]
    oil = oil_at(scene.lubricant.oil, scene.lubricant.temperature)
    raceways, length = params.raceways, params.rollers.length
    radius, modulus = (raceways.inner_curvature_radius, raceways.outer_curvature_radius)[ring], raceways.reduced_modulus
    eta, alpha, beta, k = oil.viscosity, oil.pressure_viscosity, oil.temperature_viscosity, oil.conductivity
    half_width = math.sqrt(8 * load / length * radius / (math.pi * modulus))
    pressure, rolled = load / (2 * half_width * length), math.hypot(rolling, ROLLING_SPEED_FLOOR)
    film = radius * 3.06 * (eta * rolled / (modulus * radius)) ** 0.69 * (alpha * modulus) ** 0.56 * (load / (modulus * radius * length)) ** -0.10
    film *= left / (1 + 0.1 * (1 + 14.8 * math.hypot(sliding / rolled, 0.01) ** 0.83) * (eta * beta * rolled**2 / k) ** 0.64)
    z = alpha / (5.1e-9 * (math.log(eta) + 9.67))
    steep = (1 + 5.1e-9 * pressure) ** z  # by which Roelands' law makes both ln eta and its fall with temperature grow
    log_thick = math.log(eta) + (math.log(eta) + 9.67) * (steep - 1)

    def residual(stress):
        heated = beta * steep * stress * sliding * film / (12 * k)
        sheared = sliding - 8 * stress / (math.pi * modulus) * rolled  # what the surfaces' elastic creep leaves to the film
        return stress / 5e6 - math.asinh(sheared / (film * 5e6) * math.exp(log_thick - heated))

    stress = brentq(residual, 0, math.pi * modulus * sliding / (8 * rolled), xtol=1e-9, rtol=1e-14)
    expected = 0.075 * math.tanh(stress / (0.075 * pressure)) * load
    films = FULL_FILMS._replace(log_film=math.log(left))
    assert contact(name, sliding, load, rolling, ring, films)[CONTACT.force] == pytest.approx(expected, rel=1e-7)


def test_the_shear_stress_of_a_film_is_found_by_few_corrections_whatever_heats_it_and_creeps():
    random, most = np.random.default_rng(1), 0
    for _ in range(20_000):
        contacts = np.zeros((1, len(CONTACT), LANES))
        slide, thick = 10 ** random.uniform(-8, 2, LANES), 10 ** random.uniform(0, 12, LANES)
        heated, creep = 10 ** random.uniform(-8, 2.5, LANES), 10 ** random.uniform(-8, 8, LANES) / thick
        contacts[0, CONTACT.sliding], contacts[0, STEP.thick], contacts[0, STEP.heated], contacts[0, STEP.creep] = slide, thick, heated, creep
        most = max(most, _shear(contacts, 0, 1))
        y = contacts[0, STEP.stress]
        missed = np.sinh(y) * np.exp(heated * y) / thick + creep * y - slide
        assert (np.abs(missed) <= 1e-7 * slide * (1 + (1 + heated) * y)).all()
    assert most <= 6 < _MOST_CORRECTIONS


@pytest.mark.parametrize("name", ["kragelskii", "kragelskii with mu_0", "eyring"])
def test_a_run_with_each_law_settles(name):
    run = Simulation(load_scene("deng2017_table1", LAWS[name]))
    slips = run.advance(0.4, samples=400)["cage_slip"][300:]
    # with a traction at rest (mu_0) rollers roll by the radii at their contacts, which let the cage lead an ideal one by 1e-4 at any tolerance
    least = -2e-4 if name == "kragelskii with mu_0" else 0.0
    assert least < slips.mean() < 0.4 and np.ptp(slips) < 0.01


@pytest.mark.parametrize(
    ("override", "expected"),
    [
        ("lubricant.traction={law: kragelski}", "did you mean 'kragelskii'"),
        ("lubricant.traction={law: kragelskii, mu_inf: 0.06}", "mu_inf: expected less than mu_max"),
        ("lubricant.traction={law: kragelskii, mu_0: 0.01, rise_speed: 0.5}", "rise_speed: expected at most a tenth of v_max"),
        ("lubricant.traction={law: eyring, eyring_stres: 5 MPa}", "did you mean 'eyring_stress'"),
        ("lubricant.oil=custom", "expected a block: law: custom"),
        (
            "lubricant.oil={law: custom, viscosity_40: 3 mm^2/s, viscosity_100: 4 mm^2/s, density: 900, pressure_viscosity: 10 1/GPa}",
            "less than viscosity_40",
        ),
    ],
)
def test_laws_that_cannot_be_say_why(override, expected):
    with pytest.raises(SceneError, match=expected):
        load_scene("deng2017_table1", [override])
