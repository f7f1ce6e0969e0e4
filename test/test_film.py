# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil films: thickness against the published formulas, resistance to rolling against its energy, custom oils against ASTM D341."""

import math

import numpy as np
import pytest

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.model.oil import OilState, oil_at, walther_viscosity
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT
from bearing_sim.physics.film import (
    DOWSON_HIGGINSON,
    DOWSON_TOYODA,
    RollingResistance,
    films,
    resist_rolling,
    resistance_constants,
)
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml
from bearing_sim.scene.lubricant import CustomOil


def film(law, speed, material, load, slide_to_roll=0.0, thermal_load=1e-300):
    """Return h/R for U, G, W, S and L_t, of a contact that has 1 for everything else."""
    oil = OilState(
        temperature=1.0, viscosity=speed, density=1.0, pressure_viscosity=material, conductivity=1.0, temperature_viscosity=thermal_load / speed
    )
    return float(films(law, oil, 1.0, 1.0, 1.0, np.array(load), np.array(1.0), np.array(slide_to_roll)))


@pytest.mark.parametrize("speed", [3e-12, 1e-11, 5e-11])
@pytest.mark.parametrize("load", [2e-5, 5e-5])
def test_films_are_near_those_of_pan_and_hamrock(speed, load):
    # Pan and Hamrock 1989, an independent numerical solution and fit: 1.714 W^-0.128 U^0.694 G^0.568 least and 2.922 W^-0.166 U^0.692
    # G^0.470 in the middle.  Within the loads that they computed, fits of line contacts differ among each other by this much.
    material = 5000.0
    assert film(DOWSON_HIGGINSON, speed, material, load) == pytest.approx(1.714 * load**-0.128 * speed**0.694 * material**0.568, rel=0.1)
    assert film(DOWSON_TOYODA, speed, material, load) == pytest.approx(2.922 * load**-0.166 * speed**0.692 * material**0.470, rel=0.3)


def test_film_of_the_stock_bearing_is_a_third_of_a_micrometre():
    # by hand: eta 2.093 mPa s, u 73 m/s, alpha 6.808e-9, E' 226.4 GPa, R 3.11 mm, 1000 N on 7 mm
    modulus, radius = 2 / (2 * 0.91 / 2.06e11), 1 / (1 / 3.5e-3 + 1 / 27.875e-3)
    oil = oil_at(load_scene("deng2017_table1").lubricant.oil, 393.15)
    u, g, w = oil.viscosity * 73 / (modulus * radius), oil.pressure_viscosity * modulus, 1000 / 7e-3 / (modulus * radius)
    assert (u, g, w) == pytest.approx((2.17e-10, 1541, 2.03e-4), rel=5e-3)
    assert radius * film(DOWSON_HIGGINSON, u, g, w) == pytest.approx(3.11e-3 * 2.65 * 1.716e-7 * 52.6 * 3.02, rel=0.01)
    assert 0.2e-6 < radius * film(DOWSON_HIGGINSON, u, g, w) < radius * film(DOWSON_TOYODA, u, g, w) < 0.5e-6


@pytest.mark.parametrize("law", [DOWSON_HIGGINSON, DOWSON_TOYODA])
def test_a_cold_inlet_leaves_the_film_and_heating_thins_it(law):
    cold = film(law, 1e-11, 5000.0, 3e-5)
    assert film(law, 1e-11, 5000.0, 3e-5, 0.3) == pytest.approx(cold, rel=1e-12)
    assert film(law, 1e-11, 5000.0, 3e-5, 0.0, 1.0) == pytest.approx(cold / 1.1, rel=1e-9)
    assert film(law, 1e-11, 5000.0, 3e-5, -1.0, 1.0) == pytest.approx(cold / (1 + 0.1 * 15.8), rel=1e-9)
    assert film(law, 1e-11, 5000.0, 3e-5, 0.3, 0.04) == pytest.approx(cold / (1 + 0.1 * (1 + 14.8 * 0.3**0.83) * 0.04**0.64), rel=1e-9)


MINERAL = OilState(temperature=343.15, viscosity=0.0105, density=875.0, pressure_viscosity=1.8e-8, conductivity=0.14, temperature_viscosity=0.03)
MODULUS, RADII, LENGTH = 2.26e11, (4.6e-3, 6.5e-3), 11e-3  # of the contacts of a bearing of 50 mm bore


def resisting(rolling, load, left=1.0, heated=True):
    """Rows of the contact of one roller with the inner raceway; ``left`` is what a starved inlet leaves."""
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.rolling], contacts[:, CONTACT.load] = rolling, load
    constants = (resistance_constants(MINERAL, MODULUS, radius, LENGTH, heated) for radius in RADII)
    resist_rolling(contacts, RollingResistance(1, 1.0, *constants), FULL_FILMS._replace(resistance=left), False)
    return contacts[0, :, 0]


def test_a_loaded_contact_resists_rolling_by_goksem_and_hargreaves():
    # by hand: U 1.616e-10, G 4068, W 8.75e-5, L 0.576 at 16 m/s and 1 kN
    stiffness, u = MODULUS * RADII[0], 16.0
    speed, load, material = MINERAL.viscosity * u / stiffness, 1e3 / (stiffness * LENGTH), MINERAL.pressure_viscosity * MODULUS
    heat = MINERAL.viscosity * MINERAL.temperature_viscosity * u**2 / MINERAL.conductivity
    assert (speed, material, load, heat) == pytest.approx((1.616e-10, 4068, 8.75e-5, 0.576), rel=2e-3)
    cold = 4.318 / MINERAL.pressure_viscosity * RADII[0] * LENGTH * (material * speed) ** 0.658 * load**0.0126
    assert resisting(u, 1e3, heated=False)[CONTACT.resistance] == pytest.approx(
        cold, rel=3e-3
    )  # a thousandth is the load's fade-out, two the rigid regime's
    assert resisting(u, 1e3)[CONTACT.resistance] == pytest.approx(cold / (1 + 0.411483 * heat**0.707071), rel=3e-3)
    assert resisting(u, 1e3, left=0.4)[CONTACT.resistance] == pytest.approx(0.4 * resisting(u, 1e3)[CONTACT.resistance], rel=1e-12)
    assert resisting(-u, 500.0)[CONTACT.resistance] == -resisting(u, 500.0)[CONTACT.resistance]
    assert resisting(u, 0.0)[CONTACT.resistance] == 0.0 == resisting(0.0, 500.0)[CONTACT.resistance]


def test_the_regimes_of_rolling_resistance_are_those_of_biboulet_and_houpert():
    # Their fit of both regimes, eq. 42, with 1.47 U^0.75 of their own for the elastic one (their U is twice ours); Goksem and Hargreaves is
    # within a factor of 1.5 of it in all of its range, and equal to the light-load asymptote 1.42 sqrt(U W).
    stiffness = MODULUS * RADII[0]
    for u in (0.5, 3.0, 16.0):
        for load in (5.0, 50.0, 500.0, 5e3):
            twice, dimensionless = 2 * MINERAL.viscosity * u / stiffness, load / (stiffness * LENGTH)
            theirs = stiffness * LENGTH * ((1.47 * twice**0.75) ** -10 + (1.42 * math.sqrt(twice * dimensionless)) ** -10) ** -0.1
            ours = resisting(u, load, heated=False)[CONTACT.resistance] * (load + 1.0) / load
            assert 1 / 1.5 < ours / theirs < 1.5
    assert resisting(16.0, 20.0, heated=False)[CONTACT.resistance] * 21 / 20 == pytest.approx(
        stiffness * LENGTH * 1.42 * math.sqrt(2 * MINERAL.viscosity * 16.0 / stiffness * 20.0 / (stiffness * LENGTH)), rel=0.01
    )


@pytest.mark.parametrize("rolling", [0.01, 1.0, 16.0])
@pytest.mark.parametrize("load", [2.0, 60.0, 300.0])
def test_slopes_of_the_rolling_resistance_are_finite_differences(rolling, load):
    step = 1e-4
    by_speed = resisting(rolling * (1 + step), load, 0.8) - resisting(rolling * (1 - step), load, 0.8)
    by_load = resisting(rolling, load * (1 + step), 0.8) - resisting(rolling, load * (1 - step), 0.8)
    found = resisting(rolling, load, 0.8)
    assert found[CONTACT.resistance_d_rolling] == pytest.approx(by_speed[CONTACT.resistance] / (2 * step * rolling), rel=1e-5)
    assert found[CONTACT.resistance_d_load] == pytest.approx(by_load[CONTACT.resistance] / (2 * step * load), rel=1e-5)


def test_rolling_resistance_makes_the_cage_slip_more():
    def slip(*overrides):
        return Simulation(load_scene("deng2017_table1", overrides)).advance(0.1)["cage_slip"][0]

    assert slip("lubricant.rolling_resistance=hydrodynamic") > slip() + 0.005


def test_rolling_resistance_makes_the_cage_slip_more_at_level_planar():
    slips = [
        Simulation(load_scene("deng2017_table1", ["level=planar", f"lubricant.rolling_resistance={law}"])).advance(0.05, samples=50)["cage_slip"]
        for law in ("none", "hydrodynamic")
    ]
    assert slips[1][40:].mean() > slips[0][40:].mean() + 0.002


def test_rolling_resistance_is_on_unless_a_scene_switches_it_off():
    scene = load_scene("deng2017_table1", ["lubricant={oil: mil_l_7808}"])
    assert scene.lubricant.rolling_resistance.law == "hydrodynamic" and load_scene("deng2017_table1").lubricant.rolling_resistance.law == "none"
    with pytest.raises(SceneError, match="lubricant.pumping.*no longer a field; give lubricant.rolling_resistance"):
        load_scene("deng2017_table1", ["lubricant.pumping=true"])


def test_viscosities_of_a_data_sheet_come_back_and_their_course_is_walthers():
    # ISO VG 32 of viscosity index 100: 32 and 5.36 mm2/s
    def at(celsius):
        return 1e6 * walther_viscosity(celsius + 273.15, 32e-6, 5.36e-6)

    assert (at(40), at(100)) == pytest.approx((32, 5.36), rel=1e-9)
    x = [math.log10(celsius + 273.15) for celsius in (0, 40, 150)]
    y = [math.log10(math.log10(at(celsius) + 0.7 + math.exp(-1.47 - 1.84 * at(celsius) - 0.51 * at(celsius) ** 2))) for celsius in (0, 40, 150)]
    assert (y[2] - y[1]) / (x[2] - x[1]) == pytest.approx((y[1] - y[0]) / (x[1] - x[0]), rel=1e-9)


def test_a_custom_oil_with_the_viscosities_of_mil_l_7808_is_like_it():
    stock = load_scene("deng2017_table1").lubricant.oil
    states = {celsius: oil_at(stock, celsius + 273.15) for celsius in (40, 70, 100, 150)}
    custom = CustomOil(
        viscosity_40=states[40].viscosity / states[40].density,
        viscosity_100=states[100].viscosity / states[100].density,
        density=972.0,
        expansion=7.5e-4,
        pressure_viscosity=1e-8,
    )
    for celsius, state in states.items():
        found = oil_at(custom, celsius + 273.15)
        assert found.viscosity == pytest.approx(state.viscosity, rel=0.05) and found.density == pytest.approx(state.density, rel=0.01)
        assert found.temperature_viscosity == pytest.approx(state.temperature_viscosity, rel=0.15)


def test_scenes_with_a_custom_oil_and_old_ones_without_a_law_are_read():
    oil = "lubricant.oil={law: custom, viscosity_40: 13 mm^2/s, viscosity_100: 3.2 mm^2/s, density: 940 kg/m^3, pressure_viscosity: 8 1/GPa}"
    scene = load_scene("deng2017_table1", [oil])
    assert scene.lubricant.oil.pressure_viscosity == pytest.approx(8e-9)
    assert scene_from_yaml(scene_to_yaml(scene)) == scene
    assert Simulation(scene).advance(1e-3)["cage_slip"][0] > 0
    stock = load_scene("deng2017_table1")
    assert scene_from_yaml(scene_to_yaml(stock).replace("    law: fitted\n", "")) == stock


def test_fall_of_viscosity_with_temperature_is_a_derivative():
    oil = load_scene("deng2017_table1").lubricant.oil
    viscosities = [oil_at(oil, 393.15 + side).viscosity for side in (-1, 1)]
    assert oil_at(oil, 393.15).temperature_viscosity == pytest.approx(math.log(viscosities[0] / viscosities[1]) / 2, rel=1e-3)


def test_load_and_resistance_of_a_rigid_film_are_those_of_reynolds_equation():
    # in units of the film h in the middle: x = sqrt(2 R h) t, pressure 12 eta u sqrt(2 R h)/h^2 P, with (H^3 P')' = H' up to where film and slope end
    t = np.linspace(-40.0, 2.0, 400_001)
    gap, step = 1 + t**2, t[1] - t[0]

    def pressure(end):
        slope = np.where(t <= end, (gap - (1 + end**2)) / gap**3, 0.0)
        return np.concatenate([[0.0], np.cumsum(0.5 * (slope[1:] + slope[:-1]) * step)])

    low, high = 0.1, 1.5
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if pressure(middle)[-1] > 0.0 else (low, middle)
    p = pressure(low)
    carried = 12 * 2 * np.sum(p) * step  # times eta u R/h
    assert carried == pytest.approx(4.9, rel=3e-3)
    # dissipation h^3 p'^2/(12 eta) = 2 F_R u
    slope = np.where(t <= low, (gap - (1 + low**2)) / gap**3, 0.0)
    resisted = 12 / 2 * np.sqrt(2.0) * np.sum(gap**3 * slope**2) * step  # times eta u sqrt(R/h)
    assert resisted == pytest.approx(1.42 * math.sqrt(2 * 4.9), rel=0.02)


def part_resists(rolling, load, part, gap):
    """Rows of an inner contact that bears on a part of its length."""
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.rolling], contacts[:, CONTACT.load], contacts[:, CONTACT.part], contacts[:, CONTACT.gap] = rolling, load, part, gap
    constants = (resistance_constants(MINERAL, MODULUS, radius, LENGTH) for radius in RADII)
    resist_rolling(contacts, RollingResistance(1, 1.0, *constants), FULL_FILMS._replace(resistance=0.8), True)
    return contacts[0, :, 0]


@pytest.mark.parametrize("rolling", [0.3, 3.0, 16.0])
@pytest.mark.parametrize("load", [2.0, 60.0, 1000.0])
def test_the_film_beside_the_part_that_bears_resists_between_nothing_and_a_whole_contact(rolling, load):
    whole = resisting(rolling, load, 0.8)[CONTACT.resistance]
    assert part_resists(rolling, load, 1.0, 0.0)[CONTACT.resistance] == pytest.approx(whole, rel=1e-12)
    assert part_resists(rolling, load, 0.5, 0.0)[CONTACT.resistance] == pytest.approx(whole, rel=0.3)
    far = part_resists(rolling, load, 0.5, 1e6)[CONTACT.resistance]  # a thousand kilometres away no film resists
    alone = resisting(rolling, load / 0.5, 0.8)[CONTACT.resistance] * 0.5
    assert far == pytest.approx(alone * (1 + 0.5 / load) / (1 + 1 / load), rel=1e-3)
    gaps = [part_resists(rolling, load, 0.5, gap)[CONTACT.resistance] for gap in (0.0, 1e-6, 3e-6, 1e-5, 1.0)]
    assert all(b <= a for a, b in zip(gaps, gaps[1:])) and gaps[0] <= whole * (1 + 1e-12)


@pytest.mark.parametrize("rolling", [1.0, 16.0])
@pytest.mark.parametrize(("load", "part", "gap"), [(2.0, 0.2, 3e-6), (60.0, 0.4, 3e-6), (300.0, 0.6, 2e-6)])
def test_slopes_of_a_partly_loaded_contact_are_finite_differences(rolling, load, part, gap):
    step = 1e-4
    by_speed = part_resists(rolling * (1 + step), load, part, gap) - part_resists(rolling * (1 - step), load, part, gap)
    by_load = part_resists(rolling, load * (1 + step), part, gap) - part_resists(rolling, load * (1 - step), part, gap)
    found = part_resists(rolling, load, part, gap)
    assert found[CONTACT.resistance_d_rolling] == pytest.approx(by_speed[CONTACT.resistance] / (2 * step * rolling), rel=1e-4)
    assert found[CONTACT.resistance_d_load] == pytest.approx(by_load[CONTACT.resistance] / (2 * step * load), rel=1e-4)
