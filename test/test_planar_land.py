"""The guide land: its film against Reynolds' equation integrated by quadrature, its derivatives, its power."""

import math

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.planar_land import land_film
from bearing_sim.levels.planar_power import planar_powers
from bearing_sim.levels.planar_rollers import equations


def simulation(*overrides):
    return Simulation(load_scene("deng2017_table1", ["level=planar", *overrides]))


def cage_state(run, place, velocity, omega):
    state = run._state.copy()
    state[2:4], state[7:9], state[9] = place, velocity, omega
    return state


def film_of_reynolds(cage, viscosity, place, velocity, omega):
    """Force of two short lands: the pressure of Reynolds' equation without its term around the shaft, over the half that the wedge fills."""
    width, c = cage.guide_width / 2, cage.guide_clearance
    e = math.hypot(*place)
    n = np.array(place) / e
    t = np.array([-n[1], n[0]])
    eps, rate, whirl = e / c, velocity @ n / c, velocity @ t / e
    theta = np.linspace(0.0, math.pi, 20_001)  # from the thickest film on, with the rotation
    h = c * (1 + eps * np.cos(theta))
    # thickness h falls where the surface is carried into the wedge; the centre's motion presses where it approaches
    pressing = -(0.5 * (omega - 2 * whirl) * -c * eps * np.sin(theta) + c * rate * np.cos(theta))
    line = 12 * viscosity / h**3 * pressing * width**3 / 12  # pressure integrated over the width
    radius = cage.guide_radius
    # the thickest film lies opposite to the eccentricity; pressure pushes the cage off its surface
    outward = -np.cos(theta)[:, None] * n - np.sin(theta)[:, None] * t
    return 2 * -np.trapezoid(line[:, None] * outward, theta, axis=0) * radius


@pytest.mark.parametrize("eps", [0.05, 0.3, 0.6, 0.9])
@pytest.mark.parametrize("motion", [(0.0, 0.0), (0.0, 0.4), (0.03, 0.0), (-0.02, -0.1)])
def test_film_force_is_that_of_reynolds_equation_over_the_half_that_the_wedge_fills(eps, motion):
    run = simulation()
    cage, viscosity = run._params.cage, run._lubrication.viscosity
    n = np.array([0.6, -0.8])
    whirl_limit = 0.5 * 1900.0 * eps * cage.guide_clearance  # speed of a centre that whirls at half the cage's speed
    velocity = motion[0] * n + motion[1] * whirl_limit * np.array([0.8, 0.6])
    place = eps * cage.guide_clearance * n
    found = land_film(cage_state(run, place, velocity, 1900.0), run._params, viscosity)
    expected = film_of_reynolds(cage, viscosity, place, velocity, 1900.0)
    # the sides change smoothly: 10 rad/s of the wedge's eps 1900 rad/s
    assert np.array(found[:2]) == pytest.approx(expected, abs=2.0 * (10.0 / (eps * 1900.0)) ** 2 * np.abs(expected).max())


def test_film_has_no_wedge_in_a_whirl_at_half_the_cages_speed():
    run = simulation()
    place = np.array([0.1e-3, 0.0])
    film = land_film(cage_state(run, place, np.array([0.0, 0.5 * 1900.0 * 0.1e-3]), 1900.0), run._params, run._lubrication.viscosity)
    still = land_film(cage_state(run, place, np.zeros(2), 1900.0), run._params, run._lubrication.viscosity)
    assert math.hypot(*film[:2]) < 1e-9 < math.hypot(*still[:2])


def test_film_of_deng_is_that_of_a_centre_at_rest():
    moving, deng = simulation(), simulation("bearing.cage.land_squeeze=false")
    place, velocity = np.array([0.05e-3, 0.07e-3]), np.array([0.03, -0.02])
    found = land_film(cage_state(deng, place, velocity, 1900.0), deng._params, deng._lubrication.viscosity)
    rest = land_film(cage_state(moving, place, np.zeros(2), 1900.0), moving._params, moving._lubrication.viscosity)
    assert found[:3] == pytest.approx(rest[:3], rel=1e-12)


@pytest.mark.parametrize("overrides", [[], ["bearing.cage.land_squeeze=false"]])
@pytest.mark.parametrize("eps", [0.0, 0.4, 0.97, 0.995])
def test_slopes_of_the_film_are_those_of_differences(eps, overrides):
    run = simulation(*overrides)
    viscosity = run._lubrication.viscosity
    state = cage_state(run, eps * 0.15e-3 * np.array([0.28, 0.96]), np.array([0.02, 0.05]), 1850.0)
    film = np.array(land_film(state, run._params, viscosity))
    scale = np.abs(film[3:].reshape(3, 5)).max(0)
    for column, (index, step) in enumerate(((2, 1e-11), (3, 1e-11), (7, 1e-7), (8, 1e-7), (9, 1e-3))):
        if eps == 0.0 and index < 4:
            continue  # in the very centre the direction has no derivative
        up, down = state.copy(), state.copy()
        up[index] += step
        down[index] -= step
        difference = (np.array(land_film(up, run._params, viscosity)) - np.array(land_film(down, run._params, viscosity)))[:3] / (2 * step)
        assert film[3 + column :: 5][:3] == pytest.approx(difference, abs=1e-5 * scale[column])


@pytest.mark.parametrize("eccentricity", [0.1, 0.5, 0.9])
def test_power_of_the_land_is_what_its_film_takes_from_the_cage(eccentricity):
    run = simulation()
    state = cage_state(run, np.array([eccentricity * 0.15e-3, 0.0]), np.array([0.02, 0.03]), 1900.0)
    equations(0.0, state, run._model(run.inputs, 1.0), run._work, np.zeros_like(state), False)
    force_y, force_z, torque = land_film(state, run._params, run._lubrication.viscosity)[:3]
    drag = 2 * math.pi * run._lubrication.viscosity * 1900.0 * 33.5e-3**3 * 5e-3 / 0.15e-3 / math.sqrt(1 - eccentricity**2)
    assert -torque == pytest.approx(drag, rel=1e-9)
    power = planar_powers(state, 4700.0, run._model(run.inputs, 1.0), run._work).land
    assert power == pytest.approx(-(force_y * 0.02 + force_z * 0.03 + torque * 1900.0), rel=1e-9)
    assert power > 0.0


def test_cage_whirls_at_about_half_its_speed_and_not_at_many_times_it():
    run = simulation("bearing.outer_raceway.d_value=0 mm", "bearing.outer_raceway.low_radius=34.87 mm")
    run.advance(0.05)
    block = run.advance(0.02, samples=4000)
    whirl = np.diff(np.unwrap(np.arctan2(block["cage_z"], block["cage_y"]))).sum() / 0.02
    # pockets push it on a little; a film that knew no whirl would drive it to five times its speed
    assert abs(whirl) < 0.65 * block["cage_speed"].mean()
