# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The planar level against a plain NumPy model: its forces, its derivatives, its course in time, its conservation laws."""

import math
from functools import partial

import numpy as np
import pytest
from cold_scenes import OTHERWISE, SCENES
from complex_step import assert_blocks_agree, complex_step_jacobian
from hypothesis import given, settings
from hypothesis import strategies as st
from reference_planar import Reference, State
from scipy.integrate import solve_ivp
from test_level_planar import dense_jacobian

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.planar.state import BORDER
from bearing_sim.scene.scene import tolerance_overrides

BORDER_STATES = 2 * BORDER  # ring y, z, cage y, z, angle, and their speeds


def simulation(*overrides):
    return Simulation(load_scene("deng2017_table1", ["level=planar", *overrides]))


def by_roller(state):
    """View of the rollers' part of a state vector: rows r, phi, r', phi', w, shape (5, Z)."""
    return state[BORDER_STATES:].reshape(5, -1)


def plain(state):
    """The state vector as the reference's record."""
    radius, phi, radius_speed, phi_speed, spin = by_roller(state)
    outward = np.array([np.cos(phi), np.sin(phi)])
    along = np.array([-np.sin(phi), np.cos(phi)])
    velocity = radius_speed * outward + radius * phi_speed * along
    return State(state[0:2], state[5:7], state[2:4], state[7:9], state[4], state[9], radius * outward, velocity, spin.copy())


def rate_of(reference, state, forces=None):
    """dy/dt of the state vector by the reference: its Cartesian accelerations in polar coordinates."""
    radius, phi, radius_speed, phi_speed, _ = by_roller(state)
    ring, cage, turning, rollers, spin = reference.accelerations(forces or reference.forces(plain(state)))
    outward, along = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
    rate = np.zeros_like(state)
    rate[:BORDER] = state[BORDER:BORDER_STATES]
    rate[5:7], rate[7:9], rate[9] = ring, cage, turning
    by_roller(rate)[:] = (
        radius_speed,
        phi_speed,
        (rollers * outward).sum(0) + radius * phi_speed**2,
        ((rollers * along).sum(0) - 2 * radius_speed * phi_speed) / radius,
        spin,
    )
    return rate


def rough_state(run, seed, scale=1.0):
    """Rollers pressed, parted and colliding, some against a pocket's wall, and the cage anywhere up to its land."""
    random = np.random.default_rng(seed)
    state = run._state.copy()
    eccentricity, azimuth = random.choice([random.uniform(0.0, 0.149e-3), 0.1485e-3]), random.uniform(0.0, 2 * math.pi)
    state[0:2] += random.normal(size=2) * 3e-6
    state[2:4] = run._params.cage.guidance.turning * state[0:2]
    state[2:4] += eccentricity * np.array([math.cos(azimuth), math.sin(azimuth)])
    state[4] = random.uniform(-10.0, 10.0)
    state[5:9] += random.normal(size=4) * 2e-2
    slowed = random.uniform(0.6, 1.05)
    state[9] *= slowed
    rollers = by_roller(state)
    rollers[1] += state[4]
    rollers[3] *= slowed
    rollers += random.normal(size=rollers.shape) * np.array([2e-6, 3e-3, 2e-2, 0.5, 200.0])[:, None] * scale
    return state


def kinds(count):
    """Which entries of a state vector are of one kind."""
    which = np.zeros(BORDER_STATES + 5 * count, int)
    which[:BORDER_STATES] = 0, 0, 1, 1, 2, 3, 3, 4, 4, 5
    by_roller(which)[:] = np.arange(6, 11)[:, None]
    return which


INNER = ["bearing.cage.guidance=inner_ring", "bearing.cage.outer_radius=33.35 mm"]
ROLLER_GUIDED = ["bearing.cage.guidance=roller", "bearing.cage.outer_radius=33.35 mm"]
# A turning disc with a hole at its outer radius, the diameter of spinning rollers, and alpha by 100 K of inner ring, rollers and outer raceway
GROWN = 7850 * (45000 * math.pi / 30) ** 2 * 27.875e-3 / (4 * 2.06e11) * (0.7 * 27.875e-3**2 + 3.3 * 25.0135e-3**2)
GROWN += 2 * 0.7 * 7850 * (45000 * math.pi / 30 * (62.75 / 14 - 7 / 125.5)) ** 2 * 3.5e-3**3 / (4 * 2.06e11)
GROWN += 1.2e-5 * 100 * (27.875e-3 + 7e-3 - 34.9115e-3)
# and the cage, a ring from bore to outer surface, into the lands around it at half the speed less the rollers' share
CAGE_SPEED = 45000 * math.pi / 30 * (1 - 7 / 62.75) / 2
TIGHTER = 0.15e-3 - 7850 * CAGE_SPEED**2 * 33.35e-3 / (4 * 2.06e11) * (0.7 * 33.35e-3**2 + 3.3 * 29.6e-3**2)

VARIANTS = {
    "stock": ({}, []),
    "flat land and no friction": (
        {"contour_slope": False, "pocket_friction": 0.0, "land_friction": 0.0},
        ["bearing.outer_raceway.contour_slope=false", "bearing.cage.pocket_friction=0", "bearing.cage.land_friction=0"],
    ),
    "backwards, oblique load, loose": (
        {"shaft_speed": -1500.0, "load": (300.0, -400.0), "low_radius": 34.88e-3},
        [
            "operating.shaft_speed=-1500 rad/s",
            "operating.radial_load=500 N",
            "operating.load_angle=-0.9272952180016122",
            "bearing.outer_raceway.low_radius=34.88 mm",
        ],
    ),
    "a film that knows no whirl": ({"land_squeeze": False}, ["bearing.cage.land_squeeze=false"]),
    "guided on the inner ring": ({"guidance": "inner_ring"}, INNER),
    "guided on the inner ring, backwards, by a film that knows no whirl": (
        {"guidance": "inner_ring", "shaft_speed": -1500.0, "land_squeeze": False},
        [*INNER, "operating.shaft_speed=-1500 rad/s", "bearing.cage.land_squeeze=false"],
    ),
    "guided by rollers": ({"guidance": "roller"}, ROLLER_GUIDED),
    "guided by rollers, tight and backwards": (
        {"guidance": "roller", "shaft_speed": -1500.0, "pocket_radial_clearance": 0.06e-3},
        [*ROLLER_GUIDED, "operating.shaft_speed=-1500 rad/s", "bearing.cage.pocket_radial_clearance=0.06 mm"],
    ),
    "rolling resistance, and a raceway that grows": (
        {"rolling_resistance": True, "growth": GROWN, "guide_clearance": TIGHTER},
        ["lubricant.rolling_resistance=hydrodynamic", "bearing.dimensions_at=cold"],
    ),
    "nine rollers, damped": ({"rollers": 9, "contact_damping": 1.0}, ["bearing.roller.count=9", "bearing.contact.damping=1"]),
    "damped by the load alone": ({"damping_time": 0.0}, ["bearing.contact.damping_time=0 us"]),
    "damped ten times by the stiffness": (
        {"damping_time": 2.5e-5, "damping_depth": 1e-6},
        ["bearing.contact.damping_time=25 us", "bearing.contact.damping_depth=1 um"],
    ),
}


def pair(variant, **changes):
    """A run of a variant, or of a scene with starved inlets, asperities and vortices, and its plain model with some fields changed."""
    if variant in VARIANTS:
        fields, overrides = VARIANTS[variant]
        return simulation(*overrides), Reference(**fields)
    cold = SCENES[variant]
    run = Simulation(cold.scene("planar"))
    ring_mass = run.scene.bearing.inner_raceway.ring_mass + 0.5  # of the shaft
    return run, Reference(load=(cold.load, 0.0), ring_mass=ring_mass, **cold.fields(changes))


def largest_errors(run, reference, state):
    """Largest difference of each kind of rate from the plain model's, over the largest rate of that kind."""
    rate, which = np.zeros_like(state), kinds(reference.rollers)
    assert planar.rhs(0.0, state, run._model(run.inputs, 1.0), run._work, rate)
    forces = reference.forces(plain(state))
    expected, pocket = rate_of(reference, state, forces), np.abs(forces.pocket).max()
    # what ring and cage feel is a sum over rollers: its terms, not what is left of them, say what round-off may be
    terms = {3: forces.inner.max() / reference.ring_mass, 4: pocket / reference.cage_mass}
    terms[5] = pocket * reference.pitch_radius / reference.cage_inertia
    largest = np.array([max(np.abs(expected[which == kind]).max(), terms.get(kind, 0.0)) for kind in range(11)])
    return np.array([np.abs(rate - expected)[which == kind].max() for kind in range(11)]) / largest


@pytest.mark.parametrize("variant", [*VARIANTS, *SCENES])
def test_right_hand_side_is_that_of_the_plain_numpy_model(variant):
    run, reference = pair(variant)

    @settings(max_examples=40)
    @given(st.integers(0, 2**32 - 1), st.sampled_from([0.03, 0.3, 1.0]))
    def follows(seed, scale):
        errors = largest_errors(run, reference, rough_state(run, seed, scale))
        assert errors.max() <= 1e-9, errors

    follows()


@pytest.mark.parametrize("part", OTHERWISE)
def test_the_plain_numpy_model_tells_what_films_and_asperities_do(part):
    variant, changes = OTHERWISE[part]
    run, reference = pair(variant, **changes)
    assert max(largest_errors(run, reference, rough_state(run, seed, 0.3)).max() for seed in range(3)) > 1e-5


@pytest.mark.parametrize("variant", [*VARIANTS, *SCENES])
@pytest.mark.parametrize("seed", range(3))
def test_jacobian_is_that_of_a_complex_step_through_the_plain_numpy_model(variant, seed):
    run, reference = pair(variant)
    state = rough_state(run, seed, 0.3)
    found, expected = dense_jacobian(run, state), complex_step_jacobian(partial(rate_of, reference), state)
    assert_blocks_agree(found, expected, kinds(run._params.rollers.count))


def test_drag_on_rollers_along_its_tangent_is_that_of_their_own_speed_while_they_keep_up_with_the_cage():
    run = simulation()
    run.advance(0.02)
    straight, exact = (rate_of(Reference(straight_churning=straight), run._state) for straight in (True, False))
    assert np.abs(by_roller(straight - exact)[3]).max() < 1e-3 * np.abs(by_roller(exact)[3]).max()


def scipy_run(rate, start, duration, extra=0, tolerance=1e-10):
    """The state after ``duration``, and integrals started at 0 behind it, by an explicit method of order 8."""
    absolute = np.zeros_like(start)
    absolute[:BORDER_STATES] = [1e-14] * 4 + [1e-12] + [1e-9] * 4 + [1e-8]
    by_roller(absolute)[:] = np.array([1e-14, 1e-12, 1e-9, 1e-8, 1e-6])[:, None]
    absolute = np.concatenate([absolute, np.full(extra, 1e-12)]) * tolerance / 1e-10
    # invalid: a trial step that is far too long, and refused
    with np.errstate(all="ignore"):
        beginning = np.concatenate([start, np.zeros(extra)])
        solution = solve_ivp(rate, (0.0, duration), beginning, "DOP853", rtol=tolerance, atol=absolute, first_step=1e-8)
    assert solution.success, solution.message
    return solution.y[:, -1]


def test_course_over_2_ms_is_that_of_an_explicit_method_of_order_8_and_comes_nearer_with_the_tolerance():
    run = simulation()
    model, work = run._model(run.inputs, 1.0), run._work

    def rate(t, y):
        out = np.zeros_like(y)
        assert planar.rhs(t, y, model, work, out)
        return out

    expected = scipy_run(rate, run._state.copy(), 2e-3)
    errors = []
    for tolerances in (1e-2, 3e-5):
        run = simulation(*tolerance_overrides(tolerances))
        run.advance(2e-3)
        errors.append(np.abs(run._state - expected))
    loose, tight = (np.array([error[kinds(18) == kind].max() for kind in range(11)]) for error in errors)
    # ring and cage [m], cage angle, their speeds; then r, phi, r', phi', w of the rollers
    allowed = [5e-11, 3e-10, 1e-8, 5e-6, 5e-7, 1e-5, 5e-10, 3e-8, 1e-4, 2e-4, 5e-3]
    assert (tight < allowed).all()
    assert np.median(loose / tight) > 20


@pytest.mark.parametrize("guidance", ["outer_ring", "inner_ring", "roller"])
@pytest.mark.parametrize("start", ["as it comes", "cage thrown against what guides it, rollers against their pockets"])
def test_energy_and_momentum_are_kept(start, guidance):
    reference, duration = Reference(guidance=guidance), 5e-5
    guided = [f"bearing.cage.guidance={guidance}", "bearing.cage.outer_radius=33.35 mm"]
    run = simulation(*tolerance_overrides(1e-4), *guided)
    run.advance(5e-3)
    state = run._state
    if start != "as it comes":
        duration = 4e-5
        turning, outward = run._params.cage.guidance.turning, state[2:4] / np.hypot(*state[2:4])
        reach = 0.0615e-3 if guidance == "roller" else 0.1475e-3  # where some pockets, or the lands, touch
        state[2:4], state[7:9] = turning * state[0:2] + reach * outward, 0.02 * outward
        pockets = state[4] + 2 * math.pi * np.arange(18) / 18
        across = state[3] * np.cos(pockets) - state[2] * np.sin(pockets)
        by_roller(state)[1] = pockets + (across + np.linspace(-1.02e-4, 1.02e-4, 18)) / reference.pitch_radius
    size = state.size
    causes = list(reference.powers(reference.forces(plain(state)))[1])

    def rate(t, y):
        forces = reference.forces(plain(y[:size]))
        work, heat = reference.powers(forces)
        force, moment = reference.impulses(forces)
        return np.concatenate([rate_of(reference, y[:size], forces), list(work.values()), list(heat.values()), force, [moment]])

    # Finer than the bound: contacts begin meanwhile, which costs a method its order, and which of them differs from processor to processor.
    end = scipy_run(rate, state, duration, 2 + len(causes) + 3, tolerance=1e-12)
    work, heat, impulse = end[size : size + 2].sum(), end[size + 2 : -3], end[-3:]
    before, after = (reference.forces(plain(y)) for y in (state, end[:size]))
    gained = reference.energy(after) - reference.energy(before)
    turned_over = abs(work) + np.abs(heat).sum()
    momentum = [np.array([*linear, angular]) for linear, angular in (reference.momentum(f.state) for f in (before, after))]
    touched = start != "as it comes"  # the cage touches its land in one of them only
    idle = {"inner rolling", "outer rolling"} | ({"guide land film"} if guidance == "roller" else set())
    assert set(np.array(causes)[heat == 0.0]) == idle | ({"guide land contact"} if guidance == "roller" or not touched else set())
    assert (heat >= 0).all()
    assert work - heat.sum() - gained == pytest.approx(0.0, abs=1e-9 * turned_over)
    np.testing.assert_allclose(momentum[1] - momentum[0], impulse, rtol=0, atol=1e-12)
    # and the level's own course ends with the same energy
    run.advance(duration)
    assert reference.energy(reference.forces(plain(run._state))) == pytest.approx(reference.energy(after), abs=1e-5 * turned_over)
