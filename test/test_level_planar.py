# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The planar level: its derivatives, its algebra, an independent calculation, its limit, rough courses."""

import math

import numpy as np
import pytest
from dense_arrow import dense_arrow
from validation.independent import INDEPENDENT

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.planar.forces import equations
from bearing_sim.levels.planar.state import BLOCK, BORDER, LAYOUT, ROLLERS, RollerRow
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import ContactRow
from bearing_sim.scene.loader import scene_from_yaml


def simulation(*overrides, inputs=None):
    return Simulation(load_scene("deng2017_table1", ["level=planar", *overrides]), inputs)


def rough_state(run):
    """A state with loaded, parted and colliding rollers, walls touched and the cage on its land."""
    random = np.random.default_rng(1)
    state = run._state.copy()
    state[2:4] = 0.148e-3, -0.01e-3
    state[5:9] += random.normal(size=4) * 1e-2
    state[9] *= 0.95
    rollers = state[ROLLERS:].reshape(BLOCK, -1).T
    rollers += random.normal(size=rollers.shape) * [2e-7, 3e-3, 1e-2, 0.2, 100.0]
    return state


def dense_jacobian(run, state):
    model, work, rate = run._model(run.inputs, 1.0), run._work, np.zeros_like(state)
    equations(0.0, state, model, work, rate, True)
    return dense_arrow(LAYOUT, work, run._params.rollers.count)


def differences(run, state):
    model, work, size = run._model(run.inputs, 1.0), run._work, state.size
    steps = np.concatenate([np.full(4, 1e-10), [3e-9], np.full(4, 1e-5), [1e-3], np.repeat([1e-10, 3e-9, 1e-5, 1e-4, 1e-2], (size - 10) // 5)])
    matrix = np.zeros((size, size))
    for i, step in enumerate(steps):
        above, below, up, down = state.copy(), state.copy(), np.zeros(size), np.zeros(size)
        above[i] += step
        below[i] -= step
        equations(0.0, above, model, work, up, False)
        equations(0.0, below, model, work, down, False)
        matrix[:, i] = (up - down) / (2 * step)
    return matrix


def test_jacobian_is_that_of_finite_differences():
    run = simulation()
    state = rough_state(run)
    found, expected = dense_jacobian(run, state), differences(run, state)
    scale = np.abs(expected) + 1e-5 * np.sqrt(np.abs(expected).max(0)[None, :] * np.abs(expected).max(1)[:, None])
    scale += 1e-9 * np.abs(expected).max(1)[:, None] + 1e-300
    error = (np.abs(found - expected) / scale).max(0)
    speeds = np.concatenate([np.arange(BORDER, 2 * BORDER), np.arange(ROLLERS + 2 * run._params.rollers.count, state.size)])
    positions = np.setdiff1d(np.arange(state.size), speeds)
    assert error[speeds].max() < 1e-6
    # Forces of kilonewtons over differences of tenths of nanometres: the differences themselves are good to 3e-4.
    assert error[positions].max() < 1e-3


def test_block_arrow_solution_is_that_of_the_dense_matrix():
    run = simulation()
    state, shift = rough_state(run), 2e-5
    matrix = np.eye(state.size) - shift * dense_jacobian(run, state)
    right = np.random.default_rng(2).normal(size=state.size)
    x = right.copy()
    assert planar.KERNELS.factor(shift, run._work)
    planar.KERNELS.solve(run._work, x)
    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(x, expected, rtol=0, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize(("low_radius", "slip_percent"), [(34.8600, 5.2), (34.8625, 7.05), (34.8650, 11.0), (34.8675, 24.8)])
def test_slip_is_that_of_an_independent_calculation_with_its_settings(low_radius, slip_percent):
    run = simulation(f"bearing.outer_raceway.low_radius={low_radius} mm", *INDEPENDENT)
    settled = run.advance(0.4, samples=400)[300:]
    assert 100 * settled["cage_slip"].mean() == pytest.approx(slip_percent, rel=0.1)
    # the cage whirls close to its land
    assert np.hypot(settled["cage_y"], settled["cage_z"]).mean() == pytest.approx(0.15e-3, rel=0.05)


def test_planar_becomes_slip_when_pockets_are_tight_and_the_cage_light_and_free():
    free = ["bearing.cage.pocket_friction=0", "bearing.cage.land_friction=0", "bearing.cage.guide_land_width=1 um"]
    tight = ["bearing.cage.pocket_clearance=5 um", "bearing.cage.mass=5 g", "bearing.cage.polar_inertia=4.9e-5"]
    slow = simulation(*free, *tight).advance(0.15, samples=150)["cage_slip"][100:].mean()
    quick = Simulation(load_scene("deng2017_table1", [*free, *tight])).advance(0.15, samples=150)["cage_slip"][100:].mean()
    assert slow == pytest.approx(quick, rel=0.05)


def test_normal_forces_carry_the_load_in_the_mean():
    block = simulation().advance(0.02, samples=400)[100:]
    azimuth, inner = block["roller_angle"], block["inner_load"]
    assert (inner * np.cos(azimuth)).sum(1).mean() == pytest.approx(800.0, rel=0.05)
    assert abs((inner * np.sin(azimuth)).sum(1).mean()) < 60.0


@pytest.mark.parametrize(
    ("start", "end"),
    [
        (Inputs(0.0, 100.0, 0.0, 393.15), Inputs(4712.0, 800.0, 0.0, 393.15)),  # from rest
        (Inputs(4712.0, 0.0, 0.0, 393.15), Inputs(4712.0, 5000.0, 0.0, 393.15)),  # load step
        (Inputs(1000.0, 100.0, 0.0, 393.15), Inputs(-1000.0, 0.0, 100.0, 393.15)),  # reversal
    ],
)
@pytest.mark.parametrize("low_radius", ["34.8625 mm", "34.89 mm"])  # squeezed; loose
def test_rough_courses_stay_finite(start, end, low_radius):
    run = simulation(f"bearing.outer_raceway.low_radius={low_radius}", inputs=start)
    for target in (end, end):
        block = run.advance(0.02, target, samples=20)
        for name in ("cage_speed", "cage_y", "roller_spin", "inner_load", "outer_load", "pocket_force", "damage"):
            assert np.isfinite(block[name]).all(), name
        assert (block["inner_load"] >= 0).all() and (block["outer_load"] >= 0).all()
        assert math.hypot(block["cage_y"][-1], block["cage_z"][-1]) < 0.16e-3


def finite(block):
    return all(np.isfinite(block[name]).all() for name in ("cage_speed", "ring_y", "cage_y", "roller_spin", "inner_load", "pocket_force"))


def test_a_ramp_from_rest_to_45000_rpm_in_a_fifth_of_a_second_brings_the_cage_along():
    run = simulation(inputs=Inputs(0.0, 800.0, 0.0, 393.15))
    block = run.advance(0.2, Inputs(4712.4, 800.0, 0.0, 393.15), samples=200)
    assert finite(block) and (np.diff(block["cage_speed"]) > -20.0).all()
    assert block["cage_slip"][-1] < 0.2


def test_a_cage_at_rest_in_a_turning_bearing_is_driven_up():
    run = simulation()
    run._state[9] = 0.0
    block = run.advance(0.05, samples=100)
    assert finite(block) and block["cage_speed"][-1] > 1500.0


def test_equivalent_loads_are_means_over_the_rollers_and_about_the_last_cage_turn_of_the_loads_to_the_powers_of_the_standard():
    run = simulation(inputs=Inputs(4712.4, 800.0, 0.0, 393.15))
    run.advance(1e-4, run.inputs._replace(load_y=3000.0))
    block = run.advance(0.02, samples=4000)  # seven cage turns
    weights = np.exp((block["cage_angle"] - block["cage_angle"][-1]) / (2 * math.pi))
    for ring, exponent in (("inner", 4.0), ("outer", 4.5)):
        means = (block[f"{ring}_load"] ** exponent).mean(axis=1)
        expected = np.average(means, weights=weights) ** (1 / exponent)
        assert block[f"{ring}_equivalent_load"][-1] == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("speed", [0.0, 1000.0])
def test_loose_rollers_without_load_lie_or_fly_on_the_outer_raceway(speed):
    run = simulation("bearing.outer_raceway.low_radius=34.9 mm", inputs=Inputs(speed, 0.0, 0.0, 393.15))
    block = run.advance(0.03, samples=30)
    assert finite(block) and block["inner_load"][-10:].mean() < 1.0
    centrifugal = 2.11e-3 * 31.4e-3 * block["orbital_speed"][-1] ** 2
    assert block["outer_load"][-10:].mean() == pytest.approx(centrifugal.mean(), rel=0.1, abs=1e-3)


@pytest.mark.parametrize("speed", [0.0, 4712.4])
def test_full_preload_presses_three_groups_of_rollers_alike(speed):
    run = simulation("bearing.outer_raceway.low_radius=34.85 mm", inputs=Inputs(speed, 0.0, 0.0, 393.15))
    block = run.advance(0.02, samples=200)
    thirds = block["inner_load"][100:].mean(0).reshape(3, 6).sum(1)
    assert finite(block) and thirds == pytest.approx(thirds.mean(), rel=0.05)
    # 25 um of squeeze shared by two equal contacts, less where the centrifugal force lifts rollers off the ring
    at_rest = 4.535e5 * 0.0125 ** (10 / 9)
    assert block["inner_load"].max() == pytest.approx(at_rest, rel=0.1)


@pytest.mark.parametrize("level", ["planar", "spatial"])
def test_an_attempt_that_failed_leaves_nothing_behind_in_lanes_without_a_roller(level):
    """With 17 rollers the last block has an empty lane; a NaN there once failed every shorter attempt, too."""
    simulation = Simulation(load_scene("deng2017_table1", [f"level={level}", "bearing.roller.count=17"]))
    simulation.advance(1e-3)
    other = Simulation(simulation.scene)
    other.advance(1e-3)
    simulation._work.factored.right[-1, :, 17 % LANES :] = math.nan
    assert (simulation.advance(1e-3)["cage_slip"] == other.advance(1e-3)["cage_slip"]).all()


def work_of_nu_210(speed, load, span):
    """Return steps and iterations of an NU 210/C3 over a span [s] after as long a settling."""
    text = f"""
        name: catalogue bearing
        level: planar
        bearing: {{preset: NU 210/C3}}
        lubricant: {{oil: ISO VG 68, supply: oil_bath, temperature: 40 degC}}
        operating: {{shaft_speed: {speed}, radial_load: {load}}}
    """
    run = Simulation(scene_from_yaml(text))
    run.advance(span)
    before = run.counters
    run.advance(span)
    return run.counters.steps - before.steps, run.counters.jacobians - before.jacobians


def test_steps_do_not_collapse_where_a_catalogue_bearing_creeps_under_a_heavy_load():
    """A first guess that moved the ring without the tractions on it took twenty times the steps here, though it saved some on the paper's bearing."""
    steps, iterations = work_of_nu_210("90 rpm", "20 kN", 0.3)
    assert steps < 200 and iterations < 12 * steps


def test_heavy_loads_at_speed_take_hardly_more_iterations_than_light_ones():
    """The traction of single rollers bends within a step; an iteration that overshot the bend alternated, and took two to three times as many."""
    (_, heavy), (_, light) = (work_of_nu_210("6000 rpm", load, 0.05) for load in ("5 kN", "1 kN"))
    assert heavy < 1.6 * light


def corrected(run, roller, **states):
    """Return state and correction after `planar.KERNELS.restrain` of a correction of one roller, and where its states stand: r, phi, r', phi', w."""
    model, work, y = run._model(run.inputs, 1.0), run._work, run._state.copy()
    equations(0.0, y, model, work, np.zeros_like(y), False)
    own = ROLLERS + roller + run._params.rollers.count * np.arange(BLOCK)
    change = np.zeros_like(y)
    for name, value in states.items():
        change[own[RollerRow._fields.index(name)]] = value
    before = y.copy()
    y += change
    planar.KERNELS.restrain(y, change, model, work)
    assert np.allclose(y - before, change, rtol=0.0, atol=1e-9), "state and correction change together"
    return y, change, own


def contact_of(run, y, roller, raceway):
    """Return the row of a contact, by name."""
    work = run._work
    equations(0.0, y, run._model(run.inputs, 1.0), work, np.zeros_like(y), False)
    return ContactRow(*work.contacts[raceway * work.rollers.shape[0] + roller // LANES, :, roller % LANES])


def test_a_correction_from_a_flat_part_of_the_traction_across_pure_rolling_ends_there():
    run = simulation("operating.radial_load=5 kN", "operating.shaft_speed=5000 rpm")
    run.advance(0.02)
    roller = int(np.argmax(run.sample["inner_load"]))
    run._state[ROLLERS + 4 * run._params.rollers.count + roller] += 400.0  # the spin: far beyond the maximum of the traction
    before = np.array([contact_of(run, run._state, roller, raceway).sliding for raceway in range(2)])
    y, change, own = corrected(run, roller, spin=2.5 * before[0] / run._params.rollers.radius)
    after = np.array([contact_of(run, y, roller, raceway).sliding for raceway in range(2)])
    assert np.all(after / before > -1e-9) and np.min(after / before) < 1e-6, "one contact rolls, and the other one has not passed that point"


def test_a_correction_that_stays_on_its_side_or_begins_where_the_traction_is_steep_is_kept():
    run = simulation("operating.radial_load=5 kN", "operating.shaft_speed=5000 rpm")
    run.advance(0.02)
    roller = int(np.argmax(run.sample["inner_load"]))
    run._state[ROLLERS + 4 * run._params.rollers.count + roller] += contact_of(run, run._state, roller, 0).sliding / run._params.rollers.radius + 0.05
    steep = contact_of(run, run._state, roller, 0)
    assert abs(steep.force) == pytest.approx(steep.d_sliding * abs(steep.sliding), rel=0.2), "the roller nearly rolls on the inner ring"
    across = 2.5 * steep.sliding / run._params.rollers.radius
    _, change, own = corrected(run, roller, spin=across)
    assert change[own[4]] == across


def test_a_correction_that_opens_or_closes_an_outer_contact_ends_where_it_barely_touches():
    run = simulation()
    run.advance(0.01)
    roller = int(np.argmin(run.sample["inner_load"]))
    depth = contact_of(run, run._state, roller, 1).penetration
    assert depth > 1e-8, "the roller lies on the outer raceway"
    y, change, own = corrected(run, roller, radius=-3.0 * depth, radial_speed=-1.0)
    assert contact_of(run, y, roller, 1).penetration == pytest.approx(1e-9, abs=1e-12)
    assert change[own[2]] == pytest.approx(-(depth - 1e-9) / (3.0 * depth), rel=1e-6), "speed and position of an implicit step change together"
    run._state[own[0]] -= 3.0 * depth
    y, _, _ = corrected(run, roller, radius=5.0 * depth)
    assert contact_of(run, y, roller, 1).penetration == pytest.approx(1e-9, abs=1e-12)
