# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The clearance of the running bearing: rotating rings and shrink fits in closed form, tables of the standards, and what they do to a bearing."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from bearing_sim import Inputs, SceneError, Simulation, load_scene
from bearing_sim.model.params import lubricate, pack
from bearing_sim.model.running_clearance import largest_hoop_stress, mounted, sleeve_pressure, uniform
from bearing_sim.physics.growth import Temperatures, clearance_at, growth_at, total_growth
from bearing_sim.physics.layers import Layer, State, contact_pressures, displacement, hoop_stress, spinning_roller_growth
from bearing_sim.scene import mounting
from bearing_sim.scene.bundled import catalog_table
from bearing_sim.scene.loader import scene_from_yaml, scene_to_yaml
from bearing_sim.scene.mounting import (
    Housing,
    Mounting,
    Shaft,
    clearance_limits,
    housing_interference,
    shaft_interference,
    smoothed,
    tolerance_limits,
)

COLD = "bearing.dimensions_at=cold"
STEEL = (2.06e11, 0.3, 7850.0, 1.2e-5)
RING, SOLID, TUBE = Layer(25e-3, 27.875e-3, *STEEL), Layer(0.0, 25e-3, *STEEL), Layer(15e-3, 25e-3, *STEEL)


def ring_on_shaft(interference, core, ring):
    """Pressure between two rings of one material over Young's modulus, as handbooks give it (Poisson's ratio cancels)."""
    a, b, c = core.inner_radius, core.outer_radius, ring.outer_radius
    return interference / (2 * b) / ((b * b + a * a) / (b * b - a * a) + (c * c + b * b) / (c * c - b * b))


def test_a_solid_disc_that_turns_grows_by_the_closed_form():
    omega, (modulus, nu, density, _) = 4712.0, STEEL
    grown = displacement(SOLID, 25e-3, State(square_speed=omega**2))
    assert grown == pytest.approx((1 - nu) * density * omega**2 * 25e-3**3 / (4 * modulus), rel=1e-12)
    assert hoop_stress(SOLID, 1e-9, State(square_speed=omega**2)) == pytest.approx((3 + nu) / 8 * density * omega**2 * 25e-3**2, rel=1e-10)
    assert spinning_roller_growth(SOLID, omega**2) == grown


def test_a_thin_ring_that_turns_grows_by_its_hoop_stress():
    thin = Layer(26.4e-3, 26.4e-3 * (1 + 1e-7), *STEEL)
    grown = displacement(thin, 26.4e-3, State(square_speed=4712.0**2))
    assert grown == pytest.approx(7850 * 4712.0**2 * 26.4e-3**3 / 2.06e11, rel=1e-6)


def test_stress_at_the_bore_of_a_disc_with_a_hole_is_the_closed_form():
    a, b, (_, nu, density, _) = 15e-3, 25e-3, STEEL
    expected = density * 4712.0**2 / 4 * ((3 + nu) * b * b + (1 - nu) * a * a)
    assert hoop_stress(TUBE, a, State(square_speed=4712.0**2)) == pytest.approx(expected, rel=1e-12)


def test_a_fit_of_two_rings_has_the_handbooks_pressure():
    for core in (SOLID, TUBE):
        pressure = contact_pressures((core, RING), (20e-6,), (0.0, 0.0), (0.0, 0.0))[0]
        assert pressure == pytest.approx(2.06e11 * ring_on_shaft(20e-6, core, RING), rel=1e-10)


def test_three_rings_pressed_together_one_after_the_other_superpose():
    outer = Layer(27.875e-3, 40e-3, *STEEL)
    both = contact_pressures((TUBE, RING, outer), (20e-6, 15e-6), (0.0,) * 3, (0.0,) * 3)
    # Pressing the outer ring on adds to the inner seat the pressure that a solid body of both has there under it.
    first = 2.06e11 * ring_on_shaft(20e-6, TUBE, RING)
    second = 2.06e11 * ring_on_shaft(15e-6, Layer(15e-3, 27.875e-3, *STEEL), outer)
    spread = Layer(25e-3, 40e-3, *STEEL)
    first_of_three = 2.06e11 * ring_on_shaft(20e-6, TUBE, spread)
    a, b, c = 15e-3, 25e-3, 27.875e-3
    radial_at_seat = second * c * c / (c * c - a * a) * (1 - a * a / (b * b))
    assert both[0] == pytest.approx(first_of_three + radial_at_seat, rel=1e-10)
    assert both[0] > first and both[1] > second


def test_a_shrunken_and_turning_ring_solves_the_elastic_equations():
    # u'' + u'/r - u/r^2 = -rho w^2 r (1 - nu^2)/E (plane stress), equal pressures and the interference at the fit, free elsewhere
    nu, omega2 = 0.3, 4000.0**2
    force = 7850.0 * omega2 * (1 - nu**2) / 2.06e11

    def body(inside, outside, pressure_inside, pressure_outside, turning):
        def rate(r, u):
            return np.array([u[1], -u[1] / r + u[0] / r**2 - turning * force * r])

        def ends(a, b):
            stress = [u[1] + nu * u[0] / r for u, r in ((a, inside), (b, outside))]  # radial, by E/(1 - nu^2)
            return np.array([stress[0] + pressure_inside * (1 - nu**2), stress[1] + pressure_outside * (1 - nu**2)])

        r = np.linspace(inside, outside, 60)
        return solve_bvp(rate, ends, r, np.zeros((2, 60)), tol=1e-10, max_nodes=20000).sol

    ring, core = body(25e-3, 27.875e-3, 1.0, 0.0, 0), body(15e-3, 25e-3, 0.0, 1.0, 0)
    free_ring, free_core = body(25e-3, 27.875e-3, 0.0, 0.0, 1), body(15e-3, 25e-3, 0.0, 0.0, 1)
    pressure = (15e-6 + free_core(25e-3)[0] - free_ring(25e-3)[0]) / (ring(25e-3)[0] - core(25e-3)[0])
    found = contact_pressures((TUBE, RING), (30e-6,), (omega2, omega2), (0.0, 0.0))[0]
    assert found == pytest.approx(2.06e11 * pressure, rel=1e-6)
    grown = displacement(RING, 27.875e-3, State(inner_pressure=found, square_speed=omega2))
    assert grown == pytest.approx(pressure * ring(27.875e-3)[0] + free_ring(27.875e-3)[0], rel=1e-6)


def lift_off_speed(growth):
    """Return the shaft speed at which the pressure of a fit vanishes [rad/s]."""
    return math.sqrt(growth.pressure / -growth.pressure_by_square_speed)


def test_a_seat_lets_go_at_the_speed_at_which_free_rings_part():
    scene = load_scene("deng2017_table1", [COLD, "mounting.shaft={interference: 20 um, roughness: 0 um, ring_roughness: 0 um}"])
    growth = growth_at(mounted(scene.bearing, scene.mounting), uniform(293.15))
    lift_off = lift_off_speed(growth)
    shaft, ring = Layer(0.0, 25.0135e-3, *STEEL), Layer(25.0135e-3, 27.875e-3, *STEEL)
    parted = displacement(ring, 25.0135e-3, State(square_speed=1.0)) - displacement(shaft, 25.0135e-3, State(square_speed=1.0))
    assert lift_off == pytest.approx(math.sqrt(10e-6 / parted), rel=1e-10)
    assert abs(growth.pressure + growth.pressure_by_square_speed * lift_off**2) < 1e-10 * growth.pressure
    for speed in (0.9 * lift_off, 1.1 * lift_off):
        square = speed * speed
        pressure = contact_pressures((shaft, ring), (20e-6,), (square, square), (0.0, 0.0))[0]
        assert (pressure > 0.0) == (speed < lift_off)
        rollers = 2 * spinning_roller_growth(Layer(0.0, 3.5e-3, *STEEL), (speed * 0.5 * (1 / GAMMA - GAMMA)) ** 2)
        expected = displacement(ring, 27.875e-3, State(inner_pressure=pressure, square_speed=square)) + rollers
        assert total_growth(speed, growth) == pytest.approx(expected, rel=1e-10)


GAMMA = 7.0 / 62.75


@pytest.mark.parametrize(
    ("name", "diameter", "least", "largest"),  # ISO 286-2, as makers' catalogues print it
    [
        ("k5", 50e-3, 2, 13), ("k6", 80e-3, 2, 21), ("m6", 100e-3, 13, 35), ("n6", 140e-3, 27, 52), ("p6", 200e-3, 50, 79),
        ("r6", 150e-3, 65, 90), ("s6", 60e-3, 53, 72), ("j5", 50e-3, -5, 6), ("j6", 110e-3, -9, 13), ("js5", 50e-3, -5.5, 5.5),
        ("h6", 50e-3, -16, 0), ("g6", 50e-3, -25, -9), ("f6", 50e-3, -41, -25),
        ("H7", 90e-3, 0, 35), ("H6", 72e-3, 0, 19), ("J7", 90e-3, -13, 22), ("JS7", 90e-3, -17.5, 17.5), ("K7", 72e-3, -21, 9),
        ("K6", 72e-3, -15, 4), ("M7", 72e-3, -30, 0), ("M6", 72e-3, -24, -5), ("M6", 300e-3, -41, -9), ("N7", 72e-3, -39, -9),
        ("P7", 72e-3, -51, -21), ("G7", 90e-3, 12, 47), ("F7", 90e-3, 36, 71), ("N8", 100e-3, -58, -4),
    ],
)  # fmt: skip
def test_limits_of_a_class_are_those_that_the_standard_prints(name, diameter, least, largest):
    assert np.allclose(tolerance_limits(name, diameter), (1e-6 * least, 1e-6 * largest), atol=1e-12)


def test_interference_of_a_class_counts_the_bearings_own_tolerance():
    # 50 k5: +2 to +13 um; bore 0 to -12 um; 90 H7: 0 to +35 um; outside diameter 0 to -15 um
    assert np.allclose(shaft_interference(Shaft(fit="k5"), 50e-3), (2e-6, 25e-6))
    assert np.allclose(housing_interference(Housing(fit="H7"), 90e-3), (-50e-6, 0.0))
    assert shaft_interference(Shaft(), 50e-3) is None
    assert smoothed(20e-6, Shaft(roughness=4e-6, ring_roughness=2.5e-6)) == pytest.approx(20e-6 - 0.4 * 6.5e-6)
    assert smoothed(-20e-6, Housing()) == -20e-6 and smoothed(1e-6, Shaft()) == 0.0


def test_clearance_by_group_is_the_middle_of_the_standards_limits():
    assert np.allclose(clearance_limits("CN", 50e-3), (30e-6, 60e-6)) and np.allclose(clearance_limits("C3", 160e-3), (115e-6, 165e-6))
    scene = load_scene("deng2017_table1", ["bearing.clearance=C3"])
    assert scene.bearing.outer_raceway.low_radius == pytest.approx(27.875e-3 + 7e-3 + 75e-6 / 2)  # bore 50.027 mm: 60 to 90 um
    assert scene_from_yaml(scene_to_yaml(scene)) == scene


def test_the_last_word_on_the_clearance_counts():
    low = "bearing.outer_raceway.low_radius=34.9mm"
    assert load_scene("deng2017_table1", ["bearing.clearance=30 um", low]).bearing.clearance is None
    assert load_scene("deng2017_table1", [low, "bearing.clearance=30 um"]).bearing.outer_raceway.low_radius == pytest.approx(34.89e-3)
    thinner = load_scene("deng2017_table1", ["bearing.clearance=30 um", "bearing.roller.diameter=6.9mm"])
    assert thinner.bearing.radial_clearance_at_low_points == pytest.approx(15e-6)


def parts(*overrides, temperatures=None, oil=393.15):
    scene = load_scene("deng2017_table1", overrides)
    params = pack(scene)
    lubrication = lubricate(scene.lubricant, params, oil, temperatures)
    return clearance_at(scene.operating.shaft_speed, lubrication.growth, params)


def test_the_papers_bearing_has_the_clearance_of_its_table():
    clearance = parts()
    assert clearance.initial == pytest.approx(-25e-6) and clearance.running == pytest.approx(-25e-6)
    assert clearance[1:5] == (0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("rpm", [45000, 15000])  # the shaft's fit is lost, and holds
def test_parts_of_the_clearance_sum_to_it_and_agree_with_the_elastic_rings(rpm):
    fits = "mounting={shaft: {interference: 20 um}, housing: {interference: 12 um, outside_radius: 60 mm, material: aluminium}}"
    hot = Temperatures(shaft=383.15, inner_ring=403.15, rollers=398.15, outer_ring=388.15, housing=363.15)
    clearance = parts(COLD, fits, f"operating.shaft_speed={rpm} rpm", temperatures=hot)
    square = (rpm * math.pi / 30) ** 2
    shaft, ring = Layer(0.0, 25.0135e-3, *STEEL), Layer(25.0135e-3, 27.875e-3, *STEEL)
    outer, housing = Layer(34.9115e-3, 36.7e-3, *STEEL), Layer(36.7e-3, 60e-3, 73e9, 0.33, 2650.0, 2.1e-5)

    def play(square_speed, warmed):
        inside = contact_pressures((shaft, ring), (20e-6 - 2.6e-6,), (square_speed,) * 2, warmed[:2])[0]
        outside = contact_pressures((outer, housing), (12e-6 - 0.4 * 8.8e-6,), (0.0, 0.0), warmed[3:])[0]
        inner = displacement(ring, 27.875e-3, State(inner_pressure=inside, square_speed=square_speed, warming=warmed[1]))
        rollers = 7e-3 * 1.2e-5 * warmed[2] + 2 * spinning_roller_growth(Layer(0.0, 3.5e-3, *STEEL), square_speed * (0.5 * (1 / GAMMA - GAMMA)) ** 2)
        return 2 * (displacement(outer, 34.9115e-3, State(outer_pressure=outside, warming=warmed[3])) - inner - rollers)

    cold, warm = (0.0,) * 5, [temperature - 293.15 for temperature in hot]
    assert clearance.fits == pytest.approx(play(0.0, cold), rel=1e-10)
    assert clearance.rotation == pytest.approx(play(square, cold) - play(0.0, cold), rel=1e-10)
    assert clearance.heat == pytest.approx(play(square, warm) - play(square, cold), rel=1e-9)
    assert clearance.running == pytest.approx(sum(clearance[:5]), rel=1e-12)


def test_a_sleeve_is_a_third_ring_under_the_raceway():
    sleeve = "sleeve: {bore_radius: 22 mm, interference: 30 um, material: steel}"
    clearance = parts(COLD, f"mounting.shaft={{interference: 40 um, bore_radius: 12 mm, {sleeve}}}", "operating.shaft_speed=20000 rpm", oil=293.15)
    layers = Layer(12e-3, 22e-3, *STEEL), Layer(22e-3, 25.0135e-3, 210e9, 0.3, 7850.0, 1.15e-5), Layer(25.0135e-3, 27.875e-3, *STEEL)

    def grown(square):
        pressure = contact_pressures(layers, (30e-6, 40e-6 - 2.6e-6), (square,) * 3, (0.0,) * 3)[1]
        return displacement(layers[2], 27.875e-3, State(inner_pressure=pressure, square_speed=square))

    square = (20000 * math.pi / 30) ** 2
    rollers = 2 * spinning_roller_growth(Layer(0.0, 3.5e-3, *STEEL), square * (0.5 * (1 / GAMMA - GAMMA)) ** 2)
    assert clearance.fits == pytest.approx(-2 * grown(0.0), rel=1e-10)
    assert clearance.rotation == pytest.approx(-2 * (grown(square) - grown(0.0) + rollers), rel=1e-9)


def test_points_below_the_low_radius_take_from_the_clearance():
    assert parts("bearing.outer_raceway.roundness=6um").contour == pytest.approx(-6e-6, rel=1e-3)


def test_heat_alike_in_all_parts_scales_the_play_and_no_more():
    play = 34.8625e-3 + 49e-6 - 27.875e-3 - 7e-3
    assert parts(COLD).heat == pytest.approx(2 * 1.2e-5 * 100 * play)


def test_growth_by_speed_is_the_same_squeeze_as_a_larger_raceway():
    omega = 3000.0
    inputs = Inputs(omega, 800.0, 0.0, 293.15)
    by_speed = -parts(COLD, f"operating.shaft_speed={omega} rad/s", oil=293.15).rotation / 2
    grown = Simulation(load_scene("deng2017_table1", [COLD]), inputs).advance(0.05, samples=10)
    larger = Simulation(load_scene("deng2017_table1", [f"bearing.inner_raceway.radius={27.875e-3 + by_speed}"]), inputs).advance(0.05, samples=10)
    # all else that hangs on the radius (pitch, ratio of speeds) changes by 2e-4
    np.testing.assert_allclose(grown["inner_load"][0].max(), larger["inner_load"][0].max(), rtol=5e-3)
    np.testing.assert_allclose(grown["rating_life"], larger["rating_life"], rtol=0.02)


def test_a_bearing_that_speeds_up_is_squeezed_and_slips_less():
    def slip(*overrides):
        return Simulation(load_scene("deng2017_table1", overrides)).advance(0.2)["cage_slip"][0]

    assert slip(COLD) < 0.6 * slip()


def test_samples_follow_the_clearance_of_a_changing_speed():
    run = Simulation(load_scene("deng2017_table1", [COLD, "mounting.shaft.interference=10um"]), Inputs(500.0, 800.0, 0.0, 393.15))
    block = run.advance(0.2, Inputs(4712.0, 800.0, 0.0, 393.15), samples=20)
    names = ("initial_clearance", "fit_clearance", "rotation_clearance", "heat_clearance", "contour_clearance")
    np.testing.assert_allclose(sum(block[name] for name in names), block["running_clearance"], rtol=1e-12)
    assert (np.diff(block["running_clearance"]) < 0.0).all() and np.ptp(block["fit_clearance"]) == 0.0
    assert block["rating_life"][-1] < 0.05 * block["rating_life"][0]


@pytest.mark.parametrize("level", ["slip", "planar"])
def test_a_fit_is_the_same_squeeze_as_a_larger_raceway(level):
    inputs = Inputs(500.0, 800.0, 0.0, 293.15)
    by_fit = -parts(COLD, "mounting.shaft.interference=30um", oil=293.15).fits / 2
    overrides = [COLD, "mounting.shaft.interference=30um"], [COLD, f"bearing.inner_raceway.radius={27.875e-3 + by_fit}"]
    grown, larger = (Simulation(load_scene("deng2017_table1", [f"level={level}", *o]), inputs).advance(0.02, samples=100) for o in overrides)
    assert by_fit > 5e-6
    # at this speed rotation makes a difference of 0.1 um between a ring on its shaft and a free one
    np.testing.assert_allclose(grown["inner_load"][50:].mean(), larger["inner_load"][50:].mean(), rtol=0.02)


def test_a_cage_that_turns_grows_into_the_lands_around_it_as_a_ring_does():
    run = pack(load_scene("deng2017_table1", [COLD]))
    cage_speed = 0.5 * 45000 * math.pi / 30 * (1 - GAMMA)
    grown = displacement(Layer(29.6e-3, 33.35e-3, *STEEL), 33.35e-3, State(square_speed=cage_speed**2))
    assert run.cage.guide_clearance == pytest.approx(0.15e-3 - grown, rel=1e-12) and grown > 4e-6
    assert pack(load_scene("deng2017_table1")).cage.guide_clearance == 0.15e-3
    inner = ["bearing.cage.guidance=inner_ring", "bearing.cage.guide_radius=29.45 mm", "bearing.cage.outer_radius=33.35 mm"]
    inner += ["bearing.cage.inner_radius=null"]
    opened = pack(load_scene("deng2017_table1", [COLD, *inner, "bearing.cage.guide_clearance=0.15 mm"])).cage.guide_clearance
    assert 0.13e-3 < opened < 0.15e-3  # the ring turns twice as fast as the cage


@pytest.mark.parametrize(
    ("overrides", "expected"),
    [
        (["bearing.ring_growth.centrifugal=true"], "bearing.ring_growth: no longer a field; bearing.dimensions_at: cold"),
        (["mounting.shaft.fit=k5"], "running bearing, which fits no longer change"),
        (["heat={law: given, shaft: 160 degC}"], "heat.shaft: the dimensions are those of the running bearing, which the temperature of the shaft"),
        ([COLD, "bearing.inner_raceway.bore_radius=null"], "bore_radius: missing; an inner ring whose dimensions are cold"),
        ([COLD, "mounting.shaft={interference: 5 um, bore_radius: 26 mm}"], "bore_radius: 25.0135 mm; expected between the shaft's bore"),
        ([COLD, "mounting.housing={interference: 5 um, outside_radius: 30 mm}"], "expected between the raceway"),
        ([COLD, "mounting.shaft={fit: k5, sleeve: {bore_radius: 26 mm, interference: 1 um}}"], "sleeve.bore_radius: 26 mm; expected between"),
        ([COLD, "mounting.shaft={fit: k5, interference: 5 um}"], "fit and interference exclude each other"),
        ([COLD, "mounting.shaft.fit=H7"], "expected a class of ISO 286 for a shaft"),
        ([COLD, "mounting.housing.fit=k5"], "expected a class of ISO 286 for a housing"),
        ([COLD, "mounting.housing.material=aluminum"], "did you mean 'aluminium'"),
        (["bearing.clearance=C7"], "or one of C2, CN, C3, C4, C5"),
        (["bearing.clearance=C3", "bearing.inner_raceway.bore_radius=null"], "bore_radius: missing; the clearance of group C3"),
        (["bearing.outer_raceway.low_radius=null"], "low_radius: missing; give it, or bearing.clearance"),
    ],
)  # fmt: skip
def test_a_mounting_that_cannot_be_says_why(overrides, expected):
    with pytest.raises(SceneError, match=expected):
        load_scene("deng2017_table1", overrides)


def test_the_stress_at_the_bore_is_that_of_fit_and_rotation():
    scene = load_scene("deng2017_table1", [COLD, "mounting.shaft={interference: 30 um, roughness: 0 um, ring_roughness: 0 um}"])
    parts = mounted(scene.bearing, scene.mounting)
    at_rest = largest_hoop_stress(scene.bearing, parts, 0.0)
    b, c = 25.0135e-3, 27.875e-3
    pressure = 2.06e11 * ring_on_shaft(30e-6, Layer(0.0, b, *STEEL), Layer(b, c, *STEEL))
    assert at_rest == pytest.approx(pressure * (c * c + b * b) / (c * c - b * b), rel=1e-10)
    turning = largest_hoop_stress(scene.bearing, parts, 6000.0)
    free = largest_hoop_stress(scene.bearing, mounted(scene.bearing, load_scene("deng2017_table1", [COLD]).mounting), 6000.0)
    assert at_rest < turning < at_rest + free, "the fit loosens while the ring grows"


def test_tables_of_fits_and_clearances_are_to_the_digit_those_that_were_compared_with_printed_ones():
    """Sums of the standards' tables [um], over all ranges of diameter, of copies other than the one that the package was written from."""
    fine = catalog_table("tables/iso_286")
    coarse = [row for row in fine if int(row["to"]) in (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)]
    clearances = catalog_table("designations/clearances")

    def summed(rows, columns):
        return [sum(int(row[column]) for row in rows) for column in columns]

    sums = {
        "IT4 to IT8 (ISO 286-1)": (summed(coarse, ("IT4", "IT5", "IT6", "IT7", "IT8")), [127, 184, 266, 424, 655]),
        "f to p (ISO 286-2)": (summed(coarse, "fghkmnp"), [-435, -139, 0, 32, 156, 278, 447]),
        "j5 to j7 (ISO 286-2)": (summed(coarse, ("j5", "j6", "j7")), [-112, -112, -189]),
        "J6, J7 (ISO 286-2)": (summed(coarse, ("J6", "J7")), [192, 268]),
        "r, s (ISO 286-2)": (summed(fine, "rs"), [1427, 2326]),
    }
    for k, (which, printed) in enumerate((("least", [1675, 3640, 5525, 7455, 11025]), ("largest", [3670, 5635, 7520, 9450, 13020]))):
        found = [sum(int(row[group].split("-")[k]) for row in clearances) for group in mounting.CLEARANCE_GROUPS]
        sums[f"{which} clearance, C2 to C5 (ISO 5753-1)"] = found, printed
    for name, (found, printed) in sums.items():
        assert found == printed, name
    for row, wider in zip(fine, fine[1:]):  # within a range of the other letters the rows are equal
        if row not in coarse:
            assert {**row, "to": "", "r": "", "s": ""} == {**wider, "to": "", "r": "", "s": ""}


def test_a_sleeve_loses_pressure_with_the_square_of_the_speed():
    scene = load_scene("deng2017_table1", ["bearing.dimensions_at=cold", f"mounting.shaft={{interference: 30 um, {SLEEVE}}}"])
    still, slow, fast = (sleeve_pressure(scene.bearing, scene.mounting, speed) for speed in (0.0, 2000.0, 4000.0))
    assert 0.0 < fast < slow < still and still - fast == pytest.approx(4.0 * (still - slow))
    assert sleeve_pressure(scene.bearing, Mounting(), 2000.0) == math.inf, "there is none"


SLEEVE = "sleeve: {bore_radius: 22 mm, interference: 20 um}"
