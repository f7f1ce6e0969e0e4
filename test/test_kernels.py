# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Laws against closed forms, published values and limits."""

import functools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bearing_sim import load_scene
from bearing_sim.model.oil import oil_at
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.elementary import cosine_sine, exponential, logarithm, ninth_root
from bearing_sim.numerics.linear_algebra import ARROW, factor_shifted, new_arrow, solve_factored
from bearing_sim.numerics.simd import LANES, floor, larger, load, magnitude, smaller, spread, square_root, store, total, where_positive
from bearing_sim.physics.contact import CONTACT, line_contact_stiffness
from bearing_sim.physics.drag import churning_force, cylinder_torque, end_face_torque
from bearing_sim.physics.land import land_torque
from bearing_sim.physics.load_balance import LOAD, balance_ring, squeezed_roller
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.profile import STRAIGHT_PROFILE, profile_depth
from bearing_sim.physics.raceway import TABLE_INTERVALS, contour_at, tabulated
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.physics.traction import traction
from bearing_sim.scene.bearing import OuterRaceway
from bearing_sim.scene.contour import outer_contour

STIFFNESS = line_contact_stiffness(7e-3, 2.06e11, 0.3)


@kernel
def _elementary(x, exponentials, logarithms, roots):
    for i in range(x.shape[0]):
        exponentials[i] = exponential(x[i])
        logarithms[i] = logarithm(exponentials[i])
        roots[i] = ninth_root(exponentials[i])


def test_elementary_functions_are_accurate_over_their_range():
    x = np.linspace(-699.0, 699.0, 100_001)
    exponentials, logarithms, roots = np.zeros_like(x), np.zeros_like(x), np.zeros_like(x)
    _elementary(x, exponentials, logarithms, roots)
    np.testing.assert_allclose(exponentials, np.exp(x), rtol=1e-10)
    np.testing.assert_allclose(logarithms, x, rtol=0, atol=1e-10)
    np.testing.assert_allclose(roots, exponentials ** (1 / 9), rtol=1e-11)


@kernel
def _by_lanes(given, found):
    for block in range(given.shape[0]):
        x, y = load(given, block, 0), load(given, block, 1)
        store(found, block, 0, exponential(x))
        store(found, block, 1, logarithm(magnitude(x)))
        cosine, sine = cosine_sine(x - floor(x))
        store(found, block, 2, cosine)
        store(found, block, 3, sine)
        store(found, block, 4, where_positive(x - y, larger(x, y), -smaller(x, y)))
        store(found, block, 5, square_root(x * x + 2.0) / (1.0 - 0.5 * y * y * -1.0))
        store(found, block, 6, spread(total(x)))
        store(found, block, 7, ninth_root(magnitude(x)))


def test_laws_on_lanes_are_those_of_numbers():
    given = np.random.default_rng(3).normal(size=(5, 2, LANES))
    found = np.zeros((5, 8, LANES))
    _by_lanes(given, found)
    x, y = given[:, 0], given[:, 1]
    expected = [np.exp(x), np.log(abs(x)), np.cos(2 * np.pi * x), np.sin(2 * np.pi * x), np.maximum(x, y)]
    expected[4] = np.where(x > y, x, -x)
    expected += [np.sqrt(x**2 + 2) / (1 + y**2 / 2), np.repeat(x.sum(1, keepdims=True), LANES, axis=1), abs(x) ** (1 / 9)]
    np.testing.assert_allclose(found, np.stack(expected, axis=1), rtol=1e-10, atol=1e-10)


@given(st.floats(1e-9, 1e-3))
def test_penetration_is_that_of_palmgrens_force(penetration):
    assert profile_depth(STIFFNESS * penetration ** (10 / 9), STIFFNESS, STRAIGHT_PROFILE) == pytest.approx(penetration, rel=1e-9)
    assert profile_depth(-1.0, STIFFNESS, STRAIGHT_PROFILE) == 0.0


@given(st.floats(0.0, 2 * math.pi, exclude_max=True), st.integers(1, 6), st.floats(-3, 3))
@settings(max_examples=200)
def test_contour_table_is_the_cosine_of_deng_eq_2(azimuth, lobes, angle):
    raceway = OuterRaceway(low_radius=34.86e-3, d_value=0.098e-3, lobes=lobes, installation_angle=angle)
    table = tabulated(lambda at: outer_contour(raceway, at))
    assert len(table) == TABLE_INTERVALS
    radius, slope = contour_at(table, azimuth / (2 * math.pi) * TABLE_INTERVALS)
    phase = lobes * (azimuth - angle)
    assert radius == pytest.approx(34.86e-3 + 0.049e-3 * (1 - math.cos(phase)), abs=1e-11)
    assert slope == pytest.approx(lobes * 0.049e-3 * math.sin(phase), abs=1e-8)


def test_contour_is_continuous_with_its_slope_around_the_turn():
    raceway = OuterRaceway(low_radius=34.86e-3, d_value=0.098e-3, lobes=2, installation_angle=0.3)
    table = tabulated(lambda at: outer_contour(raceway, at))
    for knot in (0.0, 1.0, 400.0, TABLE_INTERVALS - 1.0):
        before, after = contour_at(table, knot - 1e-9 if knot else TABLE_INTERVALS - 1e-9), contour_at(table, knot)
        assert before == pytest.approx(after, abs=1e-11)


@functools.cache
def lubrication_with(overrides):
    scene = load_scene("deng2017_table1", overrides)
    return lubricate(scene.lubricant, pack(scene), 393.15)


def traction_coefficient(slide_to_roll, load=1000.0, rolling=73.0, contact="inner", overrides=()):
    lubrication = lubrication_with(tuple(overrides))
    contacts = np.zeros((2, len(CONTACT), LANES))
    contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding], contacts[:, CONTACT.load] = rolling, slide_to_roll * abs(rolling), load
    traction(contacts, lubrication.inner, lubrication.outer, FULL_FILMS)
    return contacts[0 if contact == "inner" else 1, :, 1]


def test_oil_4109_traction_is_the_published_product_of_powers():
    scene = load_scene("deng2017_table1")
    oil, modulus, radius = oil_at(scene.lubricant.oil, 393.15), 2 / (2 * 0.91 / 2.06e11), 1 / (1 / 3.5e-3 - 1 / 34.8625e-3)
    load, rolling, s = 450.0, 60.0, 0.03
    w, u = load / (modulus * radius**2), oil.viscosity * rolling / (modulus * radius)
    t = 0.0966 * 393.15 / (oil.viscosity * rolling**2)
    a = -696 * w**-0.163 * u**0.577 * t**0.308
    b = 5.19e6 * w**-0.373 * u * t**0.687
    c = 6.826e5 * w**-0.170 * u**0.578 * t**0.373
    expected = load * ((a + b * s) * math.exp(-c * s) - a)
    assert traction_coefficient(s, load, rolling, "outer")[CONTACT.force] == pytest.approx(expected, rel=1e-6)


def test_constant_traction_has_the_sample_maximum():
    law = ["lubricant.traction.law=constant"]
    coefficients = [traction_coefficient(s, overrides=law)[CONTACT.force] / 1000 for s in np.arange(0.005, 0.3, 0.005)]
    assert max(coefficients) == pytest.approx(0.0204, abs=1e-4)
    assert 0.005 * (1 + int(np.argmax(coefficients))) == pytest.approx(0.075, abs=0.011)


@given(st.floats(-2, 2), st.floats(-150, 150), st.floats(0, 2e4))
@settings(max_examples=300)
def test_traction_is_odd_bounded_and_smooth_in_the_sliding_speed(slide, rolling, load):
    ahead, back = traction_coefficient(slide, load, rolling), traction_coefficient(-slide, load, rolling)
    assert back[CONTACT.force] == pytest.approx(-ahead[CONTACT.force], rel=1e-12, abs=1e-12)
    assert abs(ahead[CONTACT.force]) <= 0.5 * load
    assert np.isfinite(ahead[[CONTACT.force, CONTACT.d_sliding, CONTACT.d_rolling]]).all()


def test_traction_slopes_are_finite_differences():
    def force(sliding, rolling):
        return traction_coefficient(sliding / rolling, 600.0, rolling)[CONTACT.force]

    found = traction_coefficient(2.0 / 50.0, 600.0, 50.0)
    assert found[CONTACT.d_sliding] == pytest.approx((force(2.001, 50) - force(1.999, 50)) / 0.002, rel=1e-5)
    assert found[CONTACT.d_rolling] == pytest.approx((force(2.0, 50.01) - force(2.0, 49.99)) / 0.02, rel=1e-4)


@given(st.floats(-1e-4, 3e-4), st.floats(0.0, 2000.0), st.floats(-1e-4, 1e-4))
@settings(max_examples=300)
def test_squeezed_roller_is_in_balance(approach, centrifugal, error):
    free = (centrifugal / STIFFNESS) ** 0.9
    outer, inner_load, slope, _ = squeezed_roller(approach, centrifugal, free * (1.0 + error), 0.0, STIFFNESS, STRAIGHT_PROFILE)
    if approach <= free * (1.0 - 1e-9):
        assert inner_load == 0.0 and outer == pytest.approx(free, rel=1.1e-4)
        return
    if approach <= free * (1.0 + 1e-9):
        return
    assert STIFFNESS * outer ** (10 / 9) == pytest.approx(inner_load + centrifugal, rel=1e-6, abs=1e-6)
    assert STIFFNESS * max(approach - outer, 0) ** (10 / 9) == pytest.approx(inner_load, rel=1e-6, abs=1e-6)
    assert slope >= 0


@pytest.mark.parametrize("error", [-1e-4, 0.0, 1e-4])
def test_an_inner_contact_begins_without_a_jump_although_the_free_penetration_is_not_exact(error):
    # With a jump of 0.6 N no ring position carries a load of a newton or two.
    centrifugal = 1200.0
    free = (centrifugal / STIFFNESS) ** 0.9
    approaches = free * (1.0 + np.linspace(-3e-4, 3e-4, 1201))
    inner = np.array([squeezed_roller(approach, centrifugal, free * (1.0 + error), 0.0, STIFFNESS, STRAIGHT_PROFILE)[1] for approach in approaches])
    assert (np.diff(inner) >= 0.0).all() and inner[-1] > 0.1
    assert np.diff(inner).max() < 0.002 * inner[-1]


@given(st.floats(0, 5e4), st.floats(0, 2 * math.pi), st.floats(-60e-6, 300e-6), st.integers(3, 40), st.floats(0, 600), st.floats(0, 1.0))
@settings(max_examples=300, deadline=None)
def test_ring_balance_is_found_at_any_load_clearance_and_speed(load, angle, clearance, rollers, centrifugal, turn):
    azimuth = turn + 2 * math.pi * np.arange(rollers) / rollers
    loads = np.zeros((len(LOAD), rollers))
    loads[LOAD.cosine], loads[LOAD.sine] = np.cos(azimuth), np.sin(azimuth)
    loads[LOAD.squeeze], loads[LOAD.centrifugal] = -clearance, centrifugal
    loads[LOAD.free] = (centrifugal / STIFFNESS) ** 0.9
    ring = np.zeros(2)
    assert balance_ring(load * math.cos(angle), load * math.sin(angle), STIFFNESS, STRAIGHT_PROFILE, loads, ring)
    spring = 1e3 * ring  # what holds a ring that no roller touches
    tolerance = 1e-4 * (load + 1)
    assert loads[LOAD.inner] @ loads[LOAD.cosine] + spring[0] == pytest.approx(load * math.cos(angle), abs=tolerance)
    assert loads[LOAD.inner] @ loads[LOAD.sine] + spring[1] == pytest.approx(load * math.sin(angle), abs=tolerance)


def test_land_torque_is_petroffs_when_the_cage_is_central():
    cage, lubrication = pack(load_scene("deng2017_table1")).cage, lubrication_with(())._replace(viscosity=2e-3)
    torque, slope = land_torque(2000.0, 0.0, 0.0, lubrication, cage)
    assert torque == pytest.approx(-2 * math.pi * 2e-3 * 2000 * 33.5e-3**3 * 5e-3 / 0.15e-3, rel=1e-12)
    assert slope == pytest.approx(torque / 2000)
    assert land_torque(2000.0, 0.0, 0.8, lubrication, cage)[0] == pytest.approx(torque / 0.6)


@pytest.mark.parametrize(("speed", "regime"), [(50.0, "laminar"), (600.0, "vortices"), (2000.0, "turbulence")])
@pytest.mark.parametrize("ring_speed", [0.0, 5000.0])
def test_vortices_and_turbulence_multiply_the_torque_of_lands_that_are_full_of_oil(speed, regime, ring_speed):
    cage = pack(load_scene("deng2017_table1", ["bearing.cage.land_vortices=true"])).cage
    lubrication = lubrication_with(())
    reynolds = lubrication.density * speed * 33.5e-3 * 0.15e-3 / lubrication.viscosity
    factors = {
        "laminar": 1.0,
        "vortices": 1.3 * (reynolds * math.sqrt(0.15 / 33.5) / 41) ** 0.539,
        "turbulence": 3.0 * (reynolds / 2500) ** 0.856,
    }
    assert max(factors, key=factors.get) == regime and lubrication.density == pytest.approx(893, abs=1)
    for side in (1, -1):
        cage_speed, step = ring_speed + side * speed, 1e-4 * speed
        torque, slope = land_torque(cage_speed, ring_speed, 0.6, lubrication, cage)
        laminar, _ = land_torque(cage_speed, ring_speed, 0.6, lubrication, cage._replace(land_vortices=False))
        assert torque == pytest.approx(laminar * factors[regime], rel=1e-9) and torque * side < 0.0
        ends = (land_torque(cage_speed + end * step, ring_speed, 0.6, lubrication, cage)[0] for end in (1, -1))
        assert slope == pytest.approx((next(ends) - next(ends)) / (2 * step), rel=1e-6)


def test_churning_of_a_roller_at_45000_rpm_is_half_rho_cd_area_speed_squared():
    density, viscosity, speed = 0.03 * 893.08, 2.0928e-3, 65.68
    reynolds = density * speed * 7e-3 / viscosity
    coefficient = 1.2 ** (math.log(reynolds / 1e3) / math.log(10))  # between 1.0 at 1e3 and 1.2 at 1e4
    force, slope = churning_force(speed, density, viscosity, 7e-3, 7e-3)
    assert force == pytest.approx(0.5 * density * coefficient * 49e-6 * speed**2, rel=1e-3)
    assert slope == pytest.approx((churning_force(speed + 0.01, density, viscosity, 7e-3, 7e-3)[0] - force) / 0.01, rel=1e-3)


@pytest.mark.parametrize("reynolds", [0.01, 0.1, 0.99, 1.01, 9.99e3, 1.01e4, 2e5, 9.99e5, 1.01e6, 1e8])
def test_churning_is_continuous_over_the_table(reynolds):
    force, slope = churning_force(reynolds, 1.0, 1.0, 1.0, 1.0)
    nearby = churning_force(reynolds * 1.0001, 1.0, 1.0, 1.0, 1.0)[0]
    assert nearby == pytest.approx(force, rel=1e-3) and force > 0
    assert churning_force(-reynolds, 1.0, 1.0, 1.0, 1.0)[0] == -force


def test_couette_torque_is_laminar_when_slow_and_never_jumps():
    def torque(speed):
        return cylinder_torque(speed, 33e-3, 1.5e-3, 10e-3, 27.0, 2e-3)[0]

    assert torque(0.1) == pytest.approx(2 * math.pi * 2e-3 * 33e-3**3 * 0.1 * 10e-3 / 1.5e-3, rel=1e-9)
    speeds = np.geomspace(0.1, 1e5, 4000)
    torques = np.array([torque(s) for s in speeds])
    assert (np.diff(np.log(torques)) < 2 * np.diff(np.log(speeds))[0]).all() and (np.diff(torques) > 0).all()


def test_end_face_torque_is_laminar_below_and_turbulent_above_transition():
    def torque(reynolds):
        return end_face_torque(reynolds, 1.0, 0.5, 1.0, 1.0)[0]

    assert torque(1e5) == pytest.approx(0.5 * 1e10 * (1 - 0.5**5) * 3.87e0 / math.sqrt(1e5))
    assert torque(1e6) == pytest.approx(0.5 * 1e12 * (1 - 0.5**5) * 0.146 * 1e6**-0.2)
    assert torque(2.5e5 * 1.0001) == pytest.approx(torque(2.5e5), rel=1e-3)


@pytest.mark.parametrize("count", [3, 18, 60])
def test_arrow_solution_is_that_of_the_dense_matrix(count):
    random = np.random.default_rng(3)
    jacobian, factored, shift = new_arrow(count), new_arrow(count), 0.3
    jacobian.border[:], jacobian.rows[:] = random.normal(size=2), random.normal(size=(4, count))
    dense = np.zeros((count + 2, count + 2))
    dense[0, 1], dense[1, 1] = jacobian.border
    dense[1, 2:], dense[2:, 1] = jacobian.rows[ARROW.row], jacobian.rows[ARROW.column]
    dense[2:, 2:] = np.diag(jacobian.rows[ARROW.diagonal])
    dense[2:] += np.outer(jacobian.rows[ARROW.pulled], dense[1])  # what follows the derivative of the speed
    right = random.normal(size=count + 2)
    x = right.copy()
    assert factor_shifted(jacobian, shift, factored)
    solve_factored(factored, x)
    np.testing.assert_allclose((np.eye(count + 2) - shift * dense) @ x, right, atol=1e-12)


def test_a_singular_or_nan_arrow_is_told():
    jacobian, factored = new_arrow(3), new_arrow(3)
    jacobian.rows[ARROW.diagonal] = 1.0
    assert not factor_shifted(jacobian, 1.0, factored)
    jacobian.rows[ARROW.diagonal] = math.nan
    assert not factor_shifted(jacobian, 1.0, factored)


def test_rating_life_falls_with_the_load_to_the_fourth_power():
    life = pack(load_scene("deng2017_table1")).life
    assert rating_life_revolutions(life.inner_rating, 0.0, life) == pytest.approx(1e6)
    once, twice = rating_life_revolutions(900.0, 1100.0, life), rating_life_revolutions(1800.0, 2200.0, life)
    assert once / twice == pytest.approx(2.0**4, rel=1e-12)
