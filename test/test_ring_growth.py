# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Growth of the rings by rotation, fits and heat: closed forms, and what it does to the bearing."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from bearing_sim import Inputs, SceneError, Simulation, load_scene
from bearing_sim.model.params import lubricate, pack
from bearing_sim.model.ring_growth import centrifugal_growth, inner_fit_growth, outer_fit_shrinkage

GROWTH = "bearing.ring_growth"


def test_centrifugal_growth_of_a_thin_ring_is_that_of_its_hoop_stress():
    # hoop stress rho (omega R)^2, strain sigma/E, radial growth strain times R: 2 rho R^3 omega^2/E on the diameter
    radius, omega = 26.4e-3, 4712.4
    assert omega**2 * centrifugal_growth(radius, 7850.0, 2.06e11) == pytest.approx(7850 * (omega * radius) ** 2 / 2.06e11 * radius)
    assert 3e-6 < omega**2 * centrifugal_growth(radius, 7850.0, 2.06e11) < 16e-6


def test_a_ring_on_a_solid_shaft_of_the_same_steel_grows_by_the_ratio_of_bore_to_raceway():
    assert inner_fit_growth(10e-6, 0.0, 25e-3, 27.875e-3) == pytest.approx(5e-6 * 25 / 27.875)
    assert inner_fit_growth(10e-6, 15e-3, 25e-3, 27.875e-3) < inner_fit_growth(10e-6, 0.0, 25e-3, 27.875e-3)


def test_a_ring_in_an_endless_housing_shrinks_by_the_ratio_of_raceway_to_outside():
    assert outer_fit_shrinkage(10e-6, 34.9e-3, 36.7e-3, 1e3) == pytest.approx(5e-6 * 34.9 / 36.7, rel=1e-3)
    assert outer_fit_shrinkage(10e-6, 34.9e-3, 36.7e-3, 40e-3) < 0.7 * outer_fit_shrinkage(10e-6, 34.9e-3, 36.7e-3, 1e3)


def test_fit_growth_is_that_of_the_elastic_equations_solved_numerically():
    # u'' + u'/r - u/r^2 = 0 in both bodies (plane stress), equal pressures and the interference at the fit, free elsewhere
    shaft, bore, raceway, interference, nu = 12e-3, 25e-3, 27.875e-3, 10e-6, 0.3

    def body(inside, outside, pressure_inside, pressure_outside):
        def rate(r, u):
            return np.array([u[1], -u[1] / r + u[0] / r**2])

        def ends(a, b):
            stress = [u[1] + nu * u[0] / r for u, r in ((a, inside), (b, outside))]  # radial, by E/(1 - nu^2)
            return np.array([stress[0] + pressure_inside * (1 - nu**2), stress[1] + pressure_outside * (1 - nu**2)])

        r = np.linspace(inside, outside, 50)
        return solve_bvp(rate, ends, r, np.zeros((2, 50)), tol=1e-8).sol

    ring, core = body(bore, raceway, 1.0, 0.0), body(shaft, bore, 0.0, 1.0)
    pressure = interference / 2 / (ring(bore)[0] - core(bore)[0])
    assert inner_fit_growth(interference, shaft, bore, raceway) == pytest.approx(pressure * ring(raceway)[0], rel=1e-5)


def radii(*overrides, temperature=393.15):
    scene = load_scene("deng2017_table1", overrides)
    params = pack(scene)
    return params, lubricate(scene.lubricant, params, temperature)


def test_nothing_grows_by_default():
    params, lubrication = radii()
    assert tuple(params.growth) == (0.0, 0.0, 0.0) and lubrication.ring_growth == 0.0


def test_fits_move_the_raceways_and_their_curvature_not_at_all():
    stock, _ = radii()
    fitted, _ = radii(f"{GROWTH}={{shaft_interference: 8 um, housing_interference: 6 um, housing_radius: 45 mm}}")
    assert 3e-6 < fitted.raceways.inner_radius - stock.raceways.inner_radius < 4e-6
    moved = fitted.raceways.contour - stock.raceways.contour
    assert (moved[:, :3] == 0).all() and np.ptp(moved[:, 3]) < 1e-15 and -3e-6 < moved[0, 3] < -1e-6
    assert fitted.raceways.low_radius - stock.raceways.low_radius == pytest.approx(moved[0, 3])


def test_heat_alike_in_all_parts_scales_the_play_and_no_more():
    _, lubrication = radii(f"{GROWTH}.thermal=true")
    play = 34.8625e-3 + 49e-6 - 27.875e-3 - 7e-3
    assert lubrication.ring_growth == pytest.approx(-1.2e-5 * 100 * play)


def test_a_hotter_inner_ring_grows_by_alpha_r_dt_and_hotter_oil_brings_it_along():
    override = f"{GROWTH}={{thermal: true, inner_excess: 10 K}}"
    cold, hot = radii(override, temperature=313.15)[1].ring_growth, radii(override, temperature=413.15)[1].ring_growth
    assert cold == pytest.approx(1.2e-5 * 27.875e-3 * 10, rel=0.02) and hot == pytest.approx(cold, rel=0.05)


def test_growth_by_speed_is_the_same_squeeze_as_a_larger_raceway():
    omega = 3000.0
    by_speed = radii(f"{GROWTH}.centrifugal=true")[0].growth.by_square_speed * omega**2
    inputs = Inputs(omega, 800.0, 0.0, 393.15)
    grown = Simulation(load_scene("deng2017_table1", [f"{GROWTH}.centrifugal=true"]), inputs).advance(0.05, samples=10)
    larger = Simulation(load_scene("deng2017_table1", [f"bearing.inner_raceway.radius={27.875e-3 + by_speed}"]), inputs).advance(0.05, samples=10)
    # all else that hangs on the radius (pitch, ratio of speeds) changes by 2e-4
    np.testing.assert_allclose(grown["inner_load"][0].max(), larger["inner_load"][0].max(), rtol=5e-3)
    np.testing.assert_allclose(grown["rating_life"], larger["rating_life"], rtol=0.02)


def test_a_bearing_that_speeds_up_is_squeezed_and_slips_less():
    def slip(*overrides):
        return Simulation(load_scene("deng2017_table1", overrides)).advance(0.2)["cage_slip"][0]

    assert slip(f"{GROWTH}.centrifugal=true") < 0.6 * slip()


def test_growth_follows_a_changing_speed():
    run = Simulation(load_scene("deng2017_table1", [f"{GROWTH}.centrifugal=true"]), Inputs(500.0, 800.0, 0.0, 393.15))
    block = run.advance(0.2, Inputs(4712.0, 800.0, 0.0, 393.15), samples=20)
    assert np.isfinite(block["inner_load"]).all()
    assert run._work.growth[0] == pytest.approx(run._params.growth.by_square_speed * 4712.0**2, rel=1e-9)
    assert block["rating_life"][-1] < 0.05 * block["rating_life"][0]


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        ([f"{GROWTH}.housing_interference=5 um"], "ring_growth.housing_radius: missing"),
        ([f"{GROWTH}={{shaft_interference: 5 um, shaft_bore_radius: 26 mm}}"], "bore_radius: expected between the shaft's bore and the raceway"),
        ([f"{GROWTH}={{housing_interference: 5 um, housing_radius: 30 mm}}"], "outside_radius: expected between the raceway and the housing"),
        ([f"{GROWTH}.centrifugal=true", "bearing.inner_raceway.bore_radius=null"], "bore_radius: missing; ring_growth needs it"),
        ([f"{GROWTH}.centrifugl=true"], "did you mean 'centrifugal'"),
    ],
)
def test_growth_that_lacks_its_measures_says_which(overrides, expected):
    with pytest.raises(SceneError, match=expected):
        load_scene("deng2017_table1", overrides)


def test_a_fit_of_one_micrometre_costs_life_at_any_level():
    lives = [
        Simulation(load_scene("deng2017_table1", overrides)).advance(0.01)["rating_life"][0]
        for overrides in ([], [f"{GROWTH}.shaft_interference=4 um"])
    ]
    assert lives[1] < lives[0] and math.isfinite(lives[1])


@pytest.mark.parametrize("level", ["slip", "planar"])
def test_growth_by_heat_is_the_same_squeeze_as_a_larger_raceway(level):
    inputs = Inputs(3000.0, 800.0, 0.0, 393.15)
    growth = f"{GROWTH}={{thermal: true, inner_excess: 15 K}}"
    by_heat = radii(growth)[1].ring_growth
    overrides = [growth], [f"bearing.inner_raceway.radius={27.875e-3 + by_heat}"]
    grown, larger = (Simulation(load_scene("deng2017_table1", [f"level={level}", *o]), inputs).advance(0.02, samples=100) for o in overrides)
    np.testing.assert_allclose(grown["inner_load"][50:].mean(0), larger["inner_load"][50:].mean(0), rtol=0.02, atol=5.0)


def test_pumping_makes_the_cage_slip_more_at_level_planar():
    slips = [
        Simulation(load_scene("deng2017_table1", ["level=planar", f"lubricant.pumping={pumping}"])).advance(0.05, samples=50)["cage_slip"][40:].mean()
        for pumping in ("false", "true")
    ]
    assert slips[1] > slips[0] + 0.002
