# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What carries the bearing: against bodies in coordinates that do not move, closed forms, and the books of energy."""

import math

import numpy as np
import pytest
import test_planar_reference as planar_test
import test_spatial_reference as spatial_test
from complex_step import complex_step_jacobian
from reference_planar import Reference
from reference_spatial import SpatialReference
from reference_support import Carried
from response_over_speed.responses import plot_responses, relative_damage, respond
from scipy.integrate import quad, solve_ivp

from bearing_sim import Inputs, Simulation, load_scene
from bearing_sim.levels.common.support import TAIL
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.planar.power import planar_powers
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial.power import spatial_powers
from bearing_sim.model.params import SUPPORT
from bearing_sim.physics.squeeze_film import new_squeeze_film, squeeze_force
from bearing_sim.scene.loader import SceneError
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.scene.support import settled_support

MODELS = {"planar": planar, "spatial": spatial}
POWERS = {"planar": planar_powers, "spatial": spatial_powers}
FILM = (40e-3, 12e-3, 90e-6)
SHAFT = {"shaft_mass": 0.5, "shaft_stiffness": (2e7, 3e7), "shaft_damping": (300.0, 200.0)}
OUTER = {"outer_mass": 0.2, "outer_stiffness": (4e7, 2e7), "outer_damping": (100.0, 700.0)}
SHAFT_SET = ["support.shaft={stiffness: 2e7, stiffness_z: 3e7, damping: 300, damping_z: 200}"]
_OUTER = "mass: 0.2, stiffness: 4e7, stiffness_z: 2e7, damping: 100, damping_z: 700"
FILM_SET = [f"support.outer_ring={{{_OUTER}, squeeze_film: {{radius: 40 mm, length: 12 mm, clearance: 90 um}}}}"]
UNBALANCE_SET = ["support.unbalance={amount: 5 g*mm, angle: 40 deg}"]
UNBALANCE = {"unbalance": 5e-6, "unbalance_angle": math.radians(40)}
VARIANTS = {
    "shaft and outer ring": (SHAFT | OUTER | {"film": FILM} | UNBALANCE, [*SHAFT_SET, *FILM_SET, *UNBALANCE_SET]),
    "shaft": (SHAFT, SHAFT_SET),
    "outer ring": (OUTER, [f"support.outer_ring={{{_OUTER}}}"]),
    "unbalance alone": (UNBALANCE, UNBALANCE_SET),
}


def simulation(level, *overrides, inputs=None):
    return Simulation(load_scene("deng2017_table1", [f"level={level}", *overrides]), inputs)


def carried(level, variant, guidance="outer_ring"):
    """The plain model and the simulation of a variant."""
    fields, overrides = VARIANTS[variant]
    ring_mass = 0.05 if "shaft_mass" in fields else 0.55
    reference = Reference(ring_mass=ring_mass, guidance=guidance)
    guided = [] if guidance == "outer_ring" else planar_test.INNER
    if level == "planar":
        return Carried(reference, planar_test.plain, planar_test.rate_of, reference, **fields), simulation("planar", *guided, *overrides)
    held = ["bearing.roller.slices=6", "operating.misalignment=1 mrad"]
    bearing = SpatialReference(reference, ring_free=False)
    return Carried(bearing, spatial_test.plain, spatial_test.rate_of, reference, **fields), simulation("spatial", *held, *guided, *overrides)


class _Inside:
    """A simulation without the tail of its state, for the tests of bearings without a support."""

    def __init__(self, run):
        self._state, self._params = run._state[:-TAIL], run._params


def rough_state(level, run, seed):
    inside = (planar_test if level == "planar" else spatial_test).rough_state(_Inside(run), seed, 0.3)
    random, support = np.random.default_rng(seed), run._params.support
    tail = np.array([*random.normal(size=2) * 2e-5, *random.normal(size=2) * 3e-5, *random.normal(size=4) * 0.05])
    tail[[0, 1, 4, 5]] *= support[SUPPORT.outer_moves]
    tail[[2, 3, 6, 7]] *= support[SUPPORT.shaft_bends]
    return np.concatenate([inside, tail])


def blocks(level):
    """Which entries of a state are of one kind, the tail's behind those of the level."""
    kinds = (planar_test if level == "planar" else spatial_test).kinds(18)
    return np.concatenate([kinds, kinds.max() + np.array([1, 1, 2, 2, 3, 3, 4, 4])])


@pytest.mark.parametrize("guidance", ["outer_ring", "inner_ring"])
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("level", MODELS)
def test_right_hand_side_is_that_of_bodies_in_coordinates_that_do_not_move(level, variant, guidance):
    reference, run = carried(level, variant, guidance)
    model, rate, kinds = run._model(run.inputs, 1.0), np.zeros_like(run._state), blocks(level)
    for seed in range(6):
        state = rough_state(level, run, seed)
        assert MODELS[level].rhs(0.0, state, model, run._work, rate)
        expected, _, _, internal = reference.whole(state)
        terms = np.abs(internal).max()  # what round-off of the forces inside the bearing may be
        for kind in np.unique(kinds):
            largest = np.abs(expected[kinds == kind]).max() + 1e-3 * terms
            assert np.abs(rate - expected)[kinds == kind].max() <= 1e-9 * largest, kind


@pytest.mark.parametrize("guidance", ["outer_ring", "inner_ring"])
@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("level", MODELS)
def test_implicit_step_solves_with_the_jacobian_of_a_complex_step(level, variant, guidance):
    reference, run = carried(level, variant, guidance)
    model, rate, shift = run._model(run.inputs, 1.0), np.zeros_like(run._state), 2e-5
    state = rough_state(level, run, 1)
    matrix = np.eye(state.size) - shift * complex_step_jacobian(reference.rate, state)
    assert MODELS[level].KERNELS.rhs_and_jacobian(0.0, state, model, run._work, rate)
    own = run._work.global_block.copy()
    assert MODELS[level].KERNELS.factor(shift, run._work)
    assert (run._work.global_block == own).all()  # a factorisation with another step begins with the same derivatives
    for right in np.random.default_rng(2).normal(size=(3, state.size)):
        x = right.copy()
        MODELS[level].KERNELS.solve(run._work, x)
        expected = np.linalg.solve(matrix, right)
        for kind in np.unique(blocks(level)):
            of = blocks(level) == kind
            assert np.abs(x - expected)[of].max() <= 1e-7 * np.abs(expected[of]).max() + 1e-12 * np.abs(expected).max(), kind


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("level", MODELS)
def test_books_of_energy_close_with_the_support(level, variant):
    reference, run = carried(level, variant)
    for seed in range(3):
        run._begin(rough_state(level, run, seed), np.array([run.sample]), float(run.sample["cage_speed"]))
        state, sample, model = run._state, run.sample, run._model(run.inputs, 1.0)
        MODELS[level].rhs(0.0, state, model, run._work, np.zeros_like(state))
        powers = POWERS[level](0.0, state, run.inputs.shaft_speed, model, run._work)
        assert all(sample[f"{name}_power"] == power for name, power in powers._asdict().items() if name != "shaft")
        rate, heat, (by_load, by_unbalance), _ = reference.whole(state)
        assert sample["support_power"] == pytest.approx(heat, rel=1e-9, abs=1e-12)
        assert reference.outer_mass == 0.0 or heat > 0.0

        def difference(h):
            return (reference.stored(state + h * rate) - reference.stored(state - h * rate)) / (2 * h)

        stored = (4 * difference(2e-9) - difference(4e-9)) / 3
        lost = powers[1:]
        gap = powers.shaft + by_load - sum(lost) - stored
        assert abs(gap) < 1e-8 * max(*np.abs(lost), abs(stored))
        free = run.scene.support.unbalance.amount == 0.0
        assert free == (by_unbalance == 0.0)


@pytest.mark.long
def test_course_over_half_a_millisecond_is_that_of_bodies_in_coordinates_that_do_not_move():
    reference, run = carried("planar", "shaft and outer ring")
    speed = reference.planar.shaft_speed

    def rate(t, y):
        reference.unbalance_angle = UNBALANCE["unbalance_angle"] + speed * t
        return reference.rate(y)

    size = run._state.size
    absolute = np.full(size, 1e-12)
    with np.errstate(all="ignore"):
        expected = solve_ivp(rate, (0.0, 5e-4), run._state.copy(), "DOP853", rtol=1e-9, atol=absolute, first_step=1e-8).y[:, -1]
    fine = simulation("planar", *VARIANTS["shaft and outer ring"][1], *tolerance_overrides(1e-3))
    fine.advance(5e-4)
    error = np.abs(fine._state - expected)
    assert error[-8:-4].max() < 5e-10 and error[-4:].max() < 2e-5 and error[0:2].max() < 1e-9
    moved = np.abs(expected - run._state)
    assert moved[-8:-4].min() > 1e-8  # all of them move


def test_squeeze_film_force_is_that_of_the_pressure_of_a_short_bearing():
    """Reynolds' equation h^3 p'' = 12 eta h' along the axis: p = 6 eta h'/h^3 (x^2 - L^2/4), integrated over the surface by quadrature."""
    radius, length, clearance = FILM
    viscosity = 3e-3
    for y, z, y_speed, z_speed in ((30e-6, 20e-6, 0.03, -0.05), (-60e-6, 10e-6, 0.02, 0.0), (1e-9, 0.0, 0.01, 0.02)):

        def push(direction):
            def around(phi):
                gap = clearance - y * math.cos(phi) - z * math.sin(phi)
                closing = -(y_speed * math.cos(phi) + z_speed * math.sin(phi))
                return -viscosity * closing / gap**3 * length**3 * radius * direction(phi)

            return quad(around, 0.0, 2 * math.pi, epsabs=1e-12, epsrel=1e-12)[0]

        found = squeeze_force(y, z, y_speed, z_speed, viscosity, new_squeeze_film(*FILM, False))
        np.testing.assert_allclose(found[:2], [push(math.cos), push(math.sin)], rtol=1e-10)
        half = squeeze_force(y, z, y_speed, z_speed, viscosity, new_squeeze_film(*FILM, True))
        np.testing.assert_allclose(half, 0.5 * np.array(found), rtol=1e-14)
    centred = squeeze_force(0.0, 0.0, 1.0, 0.0, viscosity, new_squeeze_film(*FILM, False))[0]
    assert centred == pytest.approx(math.pi * viscosity * radius * (length / clearance) ** 3, rel=1e-14)


@pytest.mark.parametrize("place", [(30e-6, 20e-6), (-50e-6, 60e-6), (0.0, 0.0), (100e-6, 20e-6)])  # the last one beyond the thinnest film
def test_derivatives_of_the_squeeze_film_are_those_of_differences(place):
    film, at = new_squeeze_film(*FILM, False), np.array([*place, 0.03, -0.05])
    found = np.array(squeeze_force(*at, 3e-3, film)[2:]).reshape(2, 4)
    for k, step in enumerate((1e-10, 1e-10, 1e-6, 1e-6)):
        shift = np.eye(4)[k] * step
        above, below = (np.array(squeeze_force(*(at + sign * shift), 3e-3, film)[:2]) for sign in (1, -1))
        np.testing.assert_allclose(found[:, k], (above - below) / (2 * step), rtol=1e-6, atol=1e-6 * np.abs(found).max())


# A bearing that is stiff against what carries it: round, preloaded, with a cage that weighs nothing to speak of.
STIFF = [
    "bearing.outer_raceway.d_value=0",
    "bearing.outer_raceway.low_radius=34.86 mm",
    "bearing.cage.mass=1e-5 kg",
    "bearing.cage.polar_inertia=1e-8",
    "operating.radial_load=0 N",
]


def full_jacobian(run):
    """Return d rate/d state by the solution of (I - s J) x = b for all unit vectors b."""
    state, rate, shift = run._state, np.zeros_like(run._state), 1e-3
    assert planar.KERNELS.rhs_and_jacobian(run.time, state, run._model(run.inputs, 1.0), run._work, rate)
    assert planar.KERNELS.factor(shift, run._work)
    inverse = np.eye(state.size)
    for row in inverse:
        planar.KERNELS.solve(run._work, row)
    return (np.eye(state.size) - np.linalg.inv(inverse.T)) / shift


def chain_matrices(shaft, outer, bearing_mass, shaft_mass):
    """M, C, K of a shaft on a spring on a rigid bearing on a spring, in one direction; each spring with its damper: (k, c)."""
    (k_s, c_s), (k_o, c_o) = shaft, outer
    mass = np.diag([shaft_mass, bearing_mass])
    return mass, np.array([[c_s, -c_s], [-c_s, c_s + c_o]]), np.array([[k_s, -k_s], [-k_s, k_s + k_o]])


def test_slow_modes_are_those_of_a_chain_of_springs_and_masses():
    shaft, outer = (3e4, 2.0), (1e5, 8.0)
    springs = [
        f"support.shaft={{mass: 0.5, stiffness: {shaft[0]}, damping: {shaft[1]}}}",
        f"support.outer_ring={{mass: 0.2, stiffness: {outer[0]}, damping: {outer[1]}}}",
    ]
    run = simulation("planar", *STIFF, *springs, "operating.shaft_speed=100 rad/s")
    run.advance(0.01)
    params = run._params
    mass, damping, stiffness = chain_matrices(shaft, outer, 0.2 + 0.05 + params.cage.mass + 18 * params.rollers.mass, 0.5)
    inverse = np.linalg.inv(mass)
    chain = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ stiffness, -inverse @ damping]]))
    found = np.linalg.eigvals(full_jacobian(run))
    for expected in chain:
        nearest = found[np.argsort(np.abs(found - expected))[:2]]  # y and z
        assert np.abs(nearest.imag - expected.imag).max() < 3e-3 * abs(expected.imag)
        assert np.abs(nearest.real - expected.real).max() < 0.02 * abs(expected.real)


def test_unbalance_response_is_that_of_the_linear_chain():
    """Synchronous amplitude of shaft and outer ring, (K + i w C - w^2 M) x = m e w^2."""
    shaft, outer, speed, amount = (2e6, 200.0), (5e6, 600.0), 1500.0, 2e-5
    springs = [
        f"support.shaft={{mass: 0.5, stiffness: {shaft[0]}, damping: {shaft[1]}}}",
        f"support.outer_ring={{mass: 0.2, stiffness: {outer[0]}, damping: {outer[1]}}}",
        f"support.unbalance={{amount: {amount}, angle: 0.4}}",
    ]
    run = simulation("planar", *STIFF, *springs, f"operating.shaft_speed={speed} rad/s")
    run.advance(0.05)
    block = run.advance(20 * 2 * math.pi / speed, samples=20 * 60)
    params = run._params
    mass, damping, stiffness = chain_matrices(shaft, outer, 0.2 + 0.05 + params.cage.mass + 18 * params.rollers.mass, 0.5)
    expected = np.linalg.solve(stiffness + 1j * speed * damping - speed**2 * mass, [amount * speed**2, 0.0])
    turning = np.exp(1j * (block["shaft_angle"] + 0.4))
    for name, amplitude in zip(("shaft", "outer_ring"), expected):
        found = 2 * (block[f"{name}_y"] / turning).mean()
        across = 2 * (block[f"{name}_z"] / turning).mean()
        assert abs(found - amplitude) < 0.02 * abs(amplitude)  # the bearing yields a little: 2e6 N/m against 3e8
        assert abs(across + 1j * amplitude) < 0.02 * abs(amplitude)


def test_support_transmits_the_static_load_in_full():
    block = simulation("planar", *VARIANTS["shaft and outer ring"][1][:2], "operating.load_angle=50 deg").advance(0.06, samples=600)[200:]
    load = 800.0 * np.array([math.cos(math.radians(50)), math.sin(math.radians(50))])
    outer = np.array([block[f"outer_ring_{axis}"].mean() for axis in "yz"])
    shaft = np.array([(block[f"shaft_{axis}"] - block[f"ring_{axis}"] - block[f"outer_ring_{axis}"]).mean() for axis in "yz"])
    np.testing.assert_allclose(outer * [4e7, 2e7], load, rtol=0.01)
    np.testing.assert_allclose(shaft * [2e7, 3e7], load, rtol=0.01)


def test_levels_in_quasi_static_balance_do_not_see_a_support():
    bare, elastic = (simulation("slip", f"support.elastic={on}").advance(0.02, samples=20) for on in ("false", "true"))
    assert bare.tobytes() == elastic.tobytes()


def test_state_passes_from_level_to_level_with_the_support():
    elastic = ["support.elastic=true"]
    slip, flat, deep = simulation("slip", *elastic), simulation("planar", *elastic), simulation("spatial", *elastic)
    slip.advance(0.01)
    flat.take_over(slip)
    settled = settled_support(flat.scene.support, flat.scene.bearing)
    assert flat.sample["outer_ring_y"] == pytest.approx(800.0 / settled.outer_ring.stiffness)
    assert flat.sample["shaft_y"] - flat.sample["outer_ring_y"] - flat.sample["ring_y"] == pytest.approx(800.0 / settled.shaft.stiffness)
    flat.advance(0.002)
    deep.take_over(flat)
    resumed = simulation("planar", *elastic)
    resumed.resume(flat.sample)
    for run in (deep, resumed):
        for name in ("outer_ring_y", "outer_ring_z", "shaft_y", "shaft_z", "ring_y", "shaft_angle"):
            assert run.sample[name] == pytest.approx(flat.sample[name], abs=1e-15), name
    before = flat.sample.copy()
    deep.advance(1e-4)
    assert abs(deep.sample["shaft_y"] - before["shaft_y"]) < 2e-6


def test_unbalance_goes_on_at_the_shafts_angle_however_the_run_is_cut():
    overrides = [*VARIANTS["unbalance alone"][1], "integration.fixed_step=5 us"]
    whole, cut = simulation("planar", *overrides), simulation("planar", *overrides)
    end = Inputs(4000.0, 800.0, 0.0, 393.15)
    whole.advance(2e-3, end)
    half = Inputs(0.5 * (4712.38898038469 + 4000.0), 800.0, 0.0, 393.15)
    cut.advance(1e-3, half)
    cut.advance(1e-3, end)
    np.testing.assert_allclose(cut._state, whole._state, rtol=1e-7, atol=1e-11)


def test_support_with_damping_ends_the_resonance_of_the_ring_on_its_contacts(tmp_path):
    found = respond("deng2017_table1", [], [25000 * math.pi / 30])
    still, held, carried = found
    damage = relative_damage(found)
    assert carried.ring_swing < 0.4 * held.ring_swing and carried.largest_load < 0.75 * held.largest_load
    assert damage[still.model, still.shaft_speed] == 1.0 < 1.2 < damage[held.model, held.shaft_speed]
    assert damage[carried.model, carried.shaft_speed] == pytest.approx(1.0, abs=0.03)
    assert still.support_power == held.support_power == 0.0 < carried.support_power and held.outer_swing == 0.0 < carried.outer_swing
    plot_responses(tmp_path / "response.png", "response", found)
    assert (tmp_path / "response.png").stat().st_size > 1000


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("bearing.inner_raceway.supported_mass=0.5", "support.shaft.mass"),
        ("support.shaft.damping=5", "give stiffness"),
        ("support.shaft={mass: 0 kg, stiffness: 1e7}", "0 kg behind a stiffness"),
        ("support={elastic: true, shaft: {mass: 0 kg}}", "on an elastic shaft"),
        ("support.unbalance.amount=1 g*mm", "needs level planar or spatial"),
        ("support.outer_ring={stiffness: 1e7, squeeze_film: {radius: 40 mm, length: 12 mm, clearance: 50 um}}", "carries no static load"),
    ],
)
def test_support_that_cannot_be_is_refused(override, message):
    with pytest.raises(SceneError, match=message):
        load_scene("deng2017_table1", [override])
