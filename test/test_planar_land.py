# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The guide land: its film against Reynolds' equation integrated by quadrature, its derivatives, its power."""

import math

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.planar.forces import equations, place_in_lands
from bearing_sim.levels.planar.power import planar_powers
from bearing_sim.physics.land import land_film


def simulation(*overrides):
    return Simulation(load_scene("deng2017_table1", ["level=planar", *overrides]))


def cage_state(run, place, velocity, omega):
    state = run._state.copy()
    state[2:4], state[7:9], state[9] = place, velocity, omega
    return state


SHAFT_SPEED = 4700.0
INNER = ["bearing.cage.guidance=inner_ring", "bearing.cage.outer_radius=33.35 mm"]
GUIDANCES = pytest.mark.parametrize("guidance", [[], INNER], ids=["outer ring", "inner ring"])


def film_at(run, state):
    """Force and torque of the film, and their slopes, at a state."""
    cage = run._params.cage
    return land_film(place_in_lands(state, SHAFT_SPEED, cage), run._params.variants.land_squeeze, cage, run._lubrication)


def film_of_reynolds(cage, viscosity, place, velocity, omega):
    """Force of two short lands: the pressure of Reynolds' equation without its term around the shaft, over the half that the wedge fills.

    Lands of the outer ring lie around the cage, those of the inner ring, which turns, in its bore.  Place and velocity are those of the
    cage's centre seen from the ring's.
    """
    width, c, inner = cage.guide_width / 2, cage.guide_clearance, cage.guidance.turning == 1.0
    side, speeds = (1.0, omega + SHAFT_SPEED) if inner else (-1.0, omega)
    azimuth = math.atan2(place[1], place[0])
    thickest = azimuth if inner else azimuth + math.pi
    theta = np.linspace(thickest, thickest + math.pi, 20_001)  # the film grows thinner, with the rotation
    u, along = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
    h = c + side * place @ u
    pressing = -(0.5 * speeds * side * place @ along + side * velocity @ u)  # surfaces that carry oil into the wedge, or approach
    line = viscosity * width**3 / h**3 * pressing  # pressure integrated over the width
    return 2 * side * np.trapezoid(line * u, theta, axis=1) * cage.guide_radius


@GUIDANCES
@pytest.mark.parametrize("eps", [0.05, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("motion", [(0.0, 0.0), (0.0, 0.4), (0.03, 0.0), (-0.02, -0.1)])
def test_film_force_is_that_of_reynolds_equation_over_the_half_that_the_wedge_fills(eps, motion, guidance):
    run = simulation(*guidance)
    cage, viscosity = run._params.cage, run._lubrication.viscosity
    speeds = 1900.0 + cage.guidance.turning * SHAFT_SPEED
    n = np.array([0.6, -0.8])
    whirl_limit = 0.5 * speeds * eps * cage.guide_clearance  # speed of a centre that whirls at the mean speed of both surfaces
    velocity = motion[0] * n + motion[1] * whirl_limit * np.array([0.8, 0.6])
    place = eps * cage.guide_clearance * n
    state = cage_state(run, place, velocity, 1900.0)
    state[0:2] = state[5:7] = 0.0
    expected = film_of_reynolds(cage, viscosity, place, velocity, 1900.0)
    # the sides change smoothly: 10 rad/s of the wedge's eps 1900 rad/s
    assert np.array(film_at(run, state)[:2]) == pytest.approx(expected, abs=2.0 * (10.0 / (eps * speeds)) ** 2 * np.abs(expected).max())


def test_film_of_the_inner_ring_goes_with_the_ring():
    run = simulation(*INNER)
    state = cage_state(run, np.array([5e-5, 3e-5]), np.array([0.02, -0.01]), 1900.0)
    moved = state.copy()
    for first, way in ((0, [2e-5, -1e-5]), (5, [0.03, 0.01])):
        moved[first : first + 2] += way
        moved[first + 2 : first + 4] += way
    np.testing.assert_allclose(film_at(run, moved), film_at(run, state), rtol=1e-9)


def test_lands_of_the_inner_ring_drive_a_cage_that_is_slower_and_brake_one_that_is_faster_than_the_shaft():
    run = simulation(*INNER)
    for speed, drives in ((1900.0, True), (SHAFT_SPEED, None), (5000.0, False)):
        torque = film_at(run, cage_state(run, np.array([5e-5, 3e-5]), np.zeros(2), speed))[2]
        assert torque == pytest.approx(0.0, abs=1e-12) if drives is None else (torque > 0.0) == drives


@GUIDANCES
def test_film_has_no_wedge_in_a_whirl_at_the_mean_speed_of_both_surfaces(guidance):
    run = simulation(*guidance)
    place, mean = np.array([0.1e-3, 0.0]), 0.5 * (1900.0 + run._params.cage.guidance.turning * SHAFT_SPEED)
    states = [cage_state(run, place, np.array([0.0, whirl * 0.1e-3]), 1900.0) for whirl in (mean, 0.0)]
    for state in states:
        state[0:2] = state[5:7] = 0.0
    film, still = (film_at(run, state) for state in states)
    assert math.hypot(*film[:2]) < 1e-9 < math.hypot(*still[:2])


@GUIDANCES
def test_film_of_deng_is_that_of_a_centre_at_rest(guidance):
    moving, deng = simulation(*guidance), simulation("bearing.cage.land_squeeze=false", *guidance)
    place, velocity = np.array([0.05e-3, 0.07e-3]), np.array([0.03, -0.02])
    found = film_at(deng, cage_state(deng, place, velocity, 1900.0))
    rest = film_at(moving, cage_state(moving, place, np.zeros(2), 1900.0))
    assert found[:3] == pytest.approx(rest[:3], rel=1e-12)


@GUIDANCES
@pytest.mark.parametrize("overrides", [[], ["bearing.cage.land_squeeze=false"], ["bearing.cage.land_vortices=true"]])
@pytest.mark.parametrize("eps", [0.0, 0.4, 0.97, 0.995])
def test_slopes_of_the_film_are_those_of_differences(eps, overrides, guidance):
    run = simulation(*overrides, *guidance)
    state = cage_state(run, eps * 0.15e-3 * np.array([0.28, 0.96]), np.array([0.02, 0.05]), 1850.0)
    state[0:2] = state[5:7] = 0.0
    film = np.array(film_at(run, state))
    scale = np.abs(film[3:].reshape(3, 5)).max(0)
    for column, (index, step) in enumerate(((2, 1e-11), (3, 1e-11), (7, 1e-7), (8, 1e-7), (9, 1e-3))):
        if eps == 0.0 and index < 4:
            continue  # in the very centre the direction has no derivative
        up, down = state.copy(), state.copy()
        up[index] += step
        down[index] -= step
        difference = (np.array(film_at(run, up)) - np.array(film_at(run, down)))[:3] / (2 * step)
        assert film[3 + column :: 5][:3] == pytest.approx(difference, abs=1e-5 * scale[column])


@GUIDANCES
@pytest.mark.parametrize("speed", [600.0, 1850.0])
def test_vortices_multiply_the_torque_of_the_film_alone_by_that_of_a_concentric_land(speed, guidance):
    laminar, whirling = simulation(*guidance), simulation("bearing.cage.land_vortices=true", *guidance)
    cage, oil = whirling._params.cage, whirling._lubrication
    turning = abs(cage.guidance.turning * SHAFT_SPEED - speed)
    reynolds = oil.density * turning * cage.guide_radius * 0.15e-3 / oil.viscosity
    factor = max(1.0, 1.3 * (reynolds * math.sqrt(0.15e-3 / cage.guide_radius) / 41) ** 0.539, 3.0 * (reynolds / 2500) ** 0.856)
    films = [film_at(run, cage_state(run, np.array([0.05e-3, 0.07e-3]), np.array([0.03, -0.02]), speed)) for run in (laminar, whirling)]
    assert factor > 1.5 and films[1][2] == pytest.approx(factor * films[0][2], rel=1e-9)
    assert films[1][:2] == films[0][:2]


def power_at(run, state):
    """Books of level ``planar`` at a state, the shaft at `SHAFT_SPEED`."""
    model = run._model(run.inputs, 1.0)
    model = model._replace(drive=model.drive._replace(shaft_speed=SHAFT_SPEED))
    equations(0.0, state, model, run._work, np.zeros_like(state), False)
    return planar_powers(0.0, state, SHAFT_SPEED, model, run._work)


@pytest.mark.parametrize("eccentricity", [0.1, 0.5, 0.9])
def test_power_of_the_land_is_what_its_film_takes_from_the_cage(eccentricity):
    run = simulation()
    state = cage_state(run, np.array([eccentricity * 0.15e-3, 0.0]), np.array([0.02, 0.03]), 1900.0)
    force_y, force_z, torque = film_at(run, state)[:3]
    drag = 2 * math.pi * run._lubrication.viscosity * 1900.0 * 33.5e-3**3 * 5e-3 / 0.15e-3 / math.sqrt(1 - eccentricity**2)
    assert -torque == pytest.approx(drag, rel=1e-9)
    power = power_at(run, state).land
    assert power == pytest.approx(-(force_y * 0.02 + force_z * 0.03 + torque * 1900.0), rel=1e-9)
    assert power > 0.0


def test_shaft_pays_for_what_its_lands_give_the_cage_and_for_what_they_lose():
    run, none = simulation(*INNER), simulation(*INNER, "lubricant.mixture_fraction=0", "lubricant.traction_scale=0")
    none._state[0:2] = -1e-4  # no roller loaded, nothing else that the shaft could drive
    state = cage_state(none, none._state[0:2] + np.array([0.5 * 0.15e-3, 0.0]), np.zeros(2), 1900.0)
    state[5:7] = 0.0
    drag = 2 * math.pi * run._lubrication.viscosity * 29.45e-3**3 * 5e-3 / 0.15e-3 / math.sqrt(1 - 0.5**2)
    powers = power_at(none, state)
    force_z = film_at(none, state)[1]
    # the force across the eccentricity has its moment on the ring
    assert powers.shaft == pytest.approx((drag * (SHAFT_SPEED - 1900.0) + 0.5 * 0.15e-3 * force_z) * SHAFT_SPEED, rel=1e-9)
    assert powers.land == pytest.approx(drag * (SHAFT_SPEED - 1900.0) ** 2 + 0.5 * 0.15e-3 * force_z * SHAFT_SPEED, rel=1e-9)
    assert 0.0 < 0.5 * 0.15e-3 * force_z < 0.01 * drag * SHAFT_SPEED


def test_cage_whirls_at_about_half_its_speed_and_not_at_many_times_it():
    run = simulation("bearing.outer_raceway.d_value=0 mm", "bearing.outer_raceway.low_radius=34.87 mm")
    run.advance(0.05)
    block = run.advance(0.02, samples=4000)
    whirl = np.diff(np.unwrap(np.arctan2(block["cage_z"], block["cage_y"]))).sum() / 0.02
    # pockets push it on a little; a film that knew no whirl would drive it to five times its speed
    assert abs(whirl) < 0.65 * block["cage_speed"].mean()
