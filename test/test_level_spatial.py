# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The spatial level: its planar limit, its symmetries, gyroscopic moments, misalignment, rough courses."""

import math

import numpy as np
import pytest

from bearing_sim import Inputs, SceneError, Simulation, load_scene
from bearing_sim.levels.planar.predictor import predict as planar_predict
from bearing_sim.levels.planar.state import ROLLER as PLANAR_ROLLER
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial.predictor import predict as spatial_predict
from bearing_sim.levels.spatial.state import BLOCK, BORDER, ROLLER, SLICED
from bearing_sim.numerics.simd import by_roller as by_lane

Z = 18
FIXED = "integration.fixed_step=20 us"
MOMENT = ["operating.moment=2", FIXED]
INNER = ["bearing.cage.guidance=inner_ring", "bearing.cage.outer_radius=33.35 mm"]
ROLLER_GUIDED = ["bearing.cage.guidance=roller", "bearing.cage.outer_radius=33.35 mm"]
GUIDANCES = pytest.mark.parametrize("guidance", [[], INNER, ROLLER_GUIDED], ids=["outer ring", "inner ring", "roller"])


def simulation(*overrides, level="spatial", inputs=None):
    return Simulation(load_scene("deng2017_table1", [f"level={level}", *overrides]), inputs)


def border(state):
    """View of the border: rows positions and speeds, columns ring y, z, its tilts, cage y, z, its tilts, angle."""
    return state[: 2 * BORDER].reshape(2, BORDER)


def by_roller(state):
    """View of the rollers: rows r, phi, tilt, skew, their rates, w."""
    return state[2 * BORDER :].reshape(BLOCK, -1)


GROWTH = "bearing.dimensions_at=cold"


@pytest.mark.parametrize(
    ("at_both", "overrides"),
    [
        ([], []),
        ([], ["bearing.roller.slices=7"]),
        ([], ["operating.moment=0"]),
        (["lubricant.rolling_resistance=hydrodynamic"], []),
        ([GROWTH], []),
        (INNER, ["operating.moment=0"]),
        (ROLLER_GUIDED, ["operating.moment=0"]),
        (["lubricant.rolling_resistance=hydrodynamic", GROWTH, *INNER], []),
        (["lubricant.rolling_resistance=hydrodynamic", GROWTH], ["bearing.roller.slices=7", "operating.moment=0"]),
    ],
)
def test_an_aligned_bearing_without_crown_runs_as_at_level_planar(at_both, overrides):
    flat, full = simulation(FIXED, *at_both, level="planar"), simulation(FIXED, *at_both, *overrides)
    full._state[[6, 7]] = 0.0  # the trace of tilt with which a cage begins
    flat.advance(1e-3), full.advance(1e-3)
    planar, rollers = flat.state[10:].reshape(5, Z), by_roller(full.state)
    for row, expected in zip((0, 1, 4, 5, 8), planar):
        assert np.abs(rollers[row] - expected).max() <= 1e-9 * np.abs(expected).max()
    found, expected = border(full.state)[:, [0, 1, 4, 5, 8]], flat.state[:10].reshape(2, 5)
    for group in ([0, 1], [2, 3], [4]):
        for kind in range(2):
            assert np.abs(found[kind, group] - expected[kind, group]).max() <= 1e-9 * np.abs(expected[kind, group]).max()
    # tilts are the round-off of sums over slices
    assert np.abs(rollers[2:4]).max() < 1e-12 and np.abs(border(full.state)[0, [2, 3, 6, 7]]).max() < 1e-12
    for name in ("shaft_power", "inner_sliding_power", "outer_sliding_power", "pocket_power", "land_power", "inner_load", "pocket_force"):
        np.testing.assert_allclose(full.sample[name], flat.sample[name], rtol=1e-8, atol=1e-6, err_msg=name)


STARTS = {
    "crown": ["bearing.roller.crown=iso_log"],
    "misalignment": ["operating.misalignment=1 mrad", "operating.misalignment_angle=40 deg"],
    "moment": ["operating.moment=2", "operating.moment_angle=40 deg"],
    "crown, misalignment, a ring that has grown": [
        "bearing.roller.crown=iso_log",
        "operating.misalignment=1 mrad",
        "bearing.dimensions_at=cold",
        "bearing.reference_temperature=120 degC",  # the growth by heat comes with the first step
    ],
}


@pytest.mark.parametrize("level", ["planar", "spatial"])
def test_the_first_guess_of_a_step_is_that_of_its_state_whatever_was_computed_before(level):
    # A spin left over from an attempt that went astray spoiled every attempt after it.
    run = simulation(*(["operating.misalignment=1 mrad", "dynamics.gyroscopic=true"] if level == "spatial" else []), level=level)
    run.advance(1e-4)
    state, model, slope = run.state, run._model(run.inputs, 1.0), np.zeros(len(run.state))
    expected, found = np.zeros(len(state)), np.zeros(len(state))
    predict, row = {"planar": (planar_predict, PLANAR_ROLLER), "spatial": (spatial_predict, ROLLER)}[level]
    predict(state, 1e-6, slope, model, run._work, expected)
    constant = [row.present, row.pitch_cosine, row.pitch_sine]
    kept = run._work.rollers[:, constant].copy()
    run._work.rollers[:], run._work.contacts[:] = math.nan, math.nan
    run._work.rollers[:, constant] = kept
    predict(state, 1e-6, slope, model, run._work, found)
    np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("speed", [5000, 45000])
def test_a_run_starts_in_balance_by_slices(start, speed):
    run = simulation(*STARTS[start], f"operating.shaft_speed={speed} rpm", "bearing.contact.damping_time=0 us")
    rate = np.zeros_like(run._state)
    spatial.rhs(0.0, run.state, run._model(run.inputs, 1.0), run._work, rate)
    rollers, params, load = by_roller(rate), run._params, run.sample["inner_load"].max()
    # what has no counterpart in the balance: the film of the pockets, the contour's curvature, gyroscopic moments; and slices for a quadrature
    assert np.abs(rollers[4]).max() * params.rollers.mass < 4e-3 * load
    assert np.abs(rollers[6]).max() * params.tilts.roller_inertia < 4e-3 * load * params.rollers.length / 2
    assert np.abs(border(rate)[1, :2]).max() * params.ring.mass < 2e-3 * load
    assert np.abs(border(rate)[1, 2:4]).max() * params.tilts.ring_inertia < 2e-3 * load * params.rollers.length / 2


def test_a_sample_tells_tilts_and_skews():
    run = simulation(*MOMENT)
    rough_start(run)
    sample = run.advance(1e-4)[0]
    np.testing.assert_array_equal(sample["roller_tilt"], by_roller(run.state)[2])
    np.testing.assert_array_equal(sample["roller_skew"], by_roller(run.state)[3])
    found = [sample[name] for name in ("ring_tilt_y", "ring_tilt_z", "cage_tilt_y", "cage_tilt_z")]
    np.testing.assert_array_equal(found, border(run.state)[0, [2, 3, 6, 7]])
    assert np.abs(found).min() > 0


def rough_start(run, seed=3):
    """Set tilts and skews in motion."""
    random = np.random.default_rng(seed)
    state = run._state
    border(state)[0, [2, 3, 6, 7]] += random.normal(size=4) * 3e-4
    border(state)[1, [2, 3, 6, 7]] += random.normal(size=4)
    by_roller(state)[2:4] += random.normal(size=(2, Z)) * np.array([[2e-4], [2e-3]])
    by_roller(state)[6:8] += random.normal(size=(2, Z)) * 2.0


def spread_of(run):
    """Sizes by which to judge states of each kind."""
    ideal = 2000.0
    border_sizes = np.array([[1e-5, 1e-5, 1e-3, 1e-3, 1e-4, 1e-4, 1e-3, 1e-3, 1.0], [1e-2, 1e-2, 1.0, 1.0, 1e-1, 1e-1, 1.0, 1.0, ideal]])
    roller_sizes = np.array([1e-5, 1.0, 1e-3, 1e-3, 1e-2, ideal, 1.0, 1.0, 4 * ideal])
    return np.concatenate([border_sizes.ravel(), np.repeat(roller_sizes, Z)])


@GUIDANCES
def test_turning_load_contour_moment_and_start_turns_the_solution_and_nothing_else(guidance):
    turn = math.radians(50.0)
    here = simulation(*MOMENT, *guidance)
    there = simulation(
        *MOMENT, *guidance, "operating.load_angle=50 deg", "operating.moment_angle=50 deg", "bearing.outer_raceway.installation_angle=50 deg"
    )
    rough_start(here)

    def turned(state):
        state = state.copy()
        rotation = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
        for first in range(0, 8, 2):
            border(state)[:, first : first + 2] = border(state)[:, first : first + 2] @ rotation.T
        border(state)[0, 8] += turn
        by_roller(state)[1] += turn
        return state

    there._state[:] = turned(here._state)
    here.advance(1e-3), there.advance(1e-3)
    assert (np.abs(there.state - turned(here.state)) / spread_of(here)).max() < 1e-8


@GUIDANCES
def test_a_moment_the_other_way_and_a_mirrored_start_mirror_the_tilts_and_nothing_else(guidance):
    here, there = simulation(*MOMENT, *guidance), simulation(*MOMENT, *guidance, "operating.moment_angle=180 deg")
    rough_start(here)

    def mirrored(state):
        state = state.copy()
        border(state)[:, [2, 3, 6, 7]] *= -1.0
        by_roller(state)[[2, 3, 6, 7]] *= -1.0
        return state

    there._state[:] = mirrored(here._state)
    here.advance(1e-3), there.advance(1e-3)
    assert (np.abs(there.state - mirrored(here.state)) / spread_of(here)).max() < 1e-8


@GUIDANCES
def test_running_backwards_mirrors_the_bearing_in_the_plane_of_load_and_shaft(guidance):
    here, there = simulation(*MOMENT, *guidance), simulation(*MOMENT, *guidance, "operating.shaft_speed=-45000 rpm")
    rough_start(here)
    other = -np.arange(Z) % Z

    def mirrored(state):
        state = state.copy()
        border(state)[:, [1, 3, 5, 7, 8]] *= -1.0
        rollers = by_roller(state)
        rollers[:] = rollers[:, other]
        rollers[[1, 3, 5, 7, 8]] *= -1.0
        rollers[1, 1:] += 2 * math.pi
        return state

    there._state[:] = mirrored(here._state)
    here.advance(5e-4), there.advance(5e-4)
    assert (np.abs(there.state - mirrored(here.state)) / spread_of(here)).max() < 1e-8


def test_gyroscopic_moments_are_spin_momentum_times_the_axis_s_turning():
    run, plain = simulation(*MOMENT), simulation(*MOMENT, "dynamics.gyroscopic=false")
    rough_start(run)
    state, rates = run.state, []
    for which in (run, plain):
        rate = np.zeros_like(state)
        spatial.rhs(0.0, state, which._model(which.inputs, 1.0), which._work, rate)
        rates.append(rate)
    change, params = rates[0] - rates[1], run._params
    _, _, tilt, skew, _, orbit, tilting, skewing, spin = by_roller(state)
    ratio = params.rollers.inertia / params.tilts.roller_inertia
    assert ratio == pytest.approx(6.0 / 7.0)  # of a cylinder as long as thick
    # a roller spins at -w about its axis, which inclines at (tilt' - phi' skew, skew' + phi' tilt) in space
    np.testing.assert_allclose(by_roller(change)[6], ratio * spin * (skewing + orbit * tilt), rtol=1e-6)
    np.testing.assert_allclose(by_roller(change)[7], -ratio * spin * (tilting - orbit * skew), rtol=1e-6)
    leaning = border(state)[1]
    for first, momentum in ((2, 2.0 * run.inputs.shaft_speed), (6, 2.0 * leaning[8])):  # diametral inertias are half the polar ones
        found = border(change)[1, first : first + 2]
        np.testing.assert_allclose(found, [-momentum * leaning[first + 1], momentum * leaning[first]], rtol=1e-6)
    assert np.abs(border(change)[1, [0, 1, 4, 5, 8]]).max() == 0.0


def test_a_misaligned_ring_presses_one_end_of_the_rollers_and_tilts_them_halfway():
    run = simulation("operating.misalignment=0.5 mrad", "operating.shaft_speed=5000 rpm", "bearing.outer_raceway.d_value=0")
    run.advance(0.02)
    rollers, blocks = by_roller(run.state), run._work.rollers.shape[0]
    rows = {"load": SLICED.load, "tilting": SLICED.tilting}
    inner, outer = ({name: by_lane(run._work.contacts[k * blocks : (k + 1) * blocks], row, Z) for name, row in rows.items()} for k in range(2))
    cosine = np.cos(rollers[1])
    steep = np.abs(cosine) > 0.3
    assert (inner["load"] > 0).all()  # a round raceway at this radius is preloaded
    # where the ring's +x end leans outwards it presses the rollers' +x end, which leans outwards half as far
    assert (inner["tilting"] * cosine > 0)[steep].all() and (outer["tilting"] * cosine > 0)[steep].all()
    np.testing.assert_allclose(rollers[2], 0.25e-3 * cosine, rtol=0.3, atol=3e-5)
    straight = simulation("operating.shaft_speed=5000 rpm", "bearing.outer_raceway.d_value=0").advance(0.02)
    assert run.sample["inner_load"].sum() == pytest.approx(straight[-1]["inner_load"].sum(), rel=0.1)


def test_a_moment_tilts_the_ring_its_own_way_and_the_rollers_hold_it():
    run = simulation("operating.moment=1", "operating.shaft_speed=5000 rpm", "bearing.outer_raceway.d_value=0")
    run.advance(0.02)
    course = []
    for _ in range(20):
        run.advance(1e-3)
        course.append(border(run.state)[0, 2:4].copy())
    tilt = np.mean(course, axis=0)
    assert 1e-5 < tilt[0] < 5e-3 and abs(tilt[1]) < 0.3 * tilt[0]


@pytest.mark.parametrize(
    ("start", "end"),
    [
        (Inputs(0.0, 100.0, 0.0, 393.15), Inputs(4712.0, 800.0, 0.0, 393.15)),  # from rest
        (Inputs(4712.0, 0.0, 0.0, 393.15), Inputs(4712.0, 5000.0, 0.0, 393.15)),  # load step
        (Inputs(1000.0, 100.0, 0.0, 393.15), Inputs(-1000.0, 0.0, 100.0, 393.15)),  # reversal
    ],
)
@pytest.mark.parametrize("tilted", ["operating.misalignment=3 mrad", "operating.moment=3"])
def test_rough_courses_stay_finite(start, end, tilted):
    run = simulation(tilted, "bearing.roller.slices=10", inputs=start)
    for target in (end, end):
        block = run.advance(0.02, target, samples=20)
        for name in ("cage_speed", "cage_y", "roller_spin", "inner_load", "outer_load", "pocket_force", "damage"):
            assert np.isfinite(block[name]).all(), name
        assert (block["inner_load"] >= 0).all() and (block["outer_load"] >= 0).all()
        assert math.hypot(block["cage_y"][-1], block["cage_z"][-1]) < 0.16e-3


def test_a_moment_and_a_misalignment_together_are_refused():
    with pytest.raises(SceneError, match="give the moment or the misalignment"):
        simulation("operating.moment=1", "operating.misalignment=1 mrad")


def test_a_held_ring_is_inclined_from_the_start_even_where_no_balance_is_found(monkeypatch):
    def lost(*arguments):
        raise ArithmeticError

    monkeypatch.setattr("bearing_sim.levels.spatial.model.balance", lost)
    run = Simulation(load_scene("deng2017_table1", ["level=spatial", "operating.misalignment=1 mrad", "operating.misalignment_angle=90 deg"]))
    assert run.sample["ring_tilt_z"] == pytest.approx(1e-3)


@pytest.mark.parametrize(("speed", "tilts"), [(45000, True), (30000, False)])
def test_a_run_shows_whether_a_cage_tilts_by_itself(speed, tilts):
    """From the trace of tilt with which it begins, to where the lands end it; elsewhere the trace fades."""
    run = simulation(f"operating.shaft_speed={speed} rpm")
    first = np.abs(run.sample["cage_tilt_y"])
    run.advance(0.25)
    tilt = np.abs(run.advance(0.05, samples=200)["cage_tilt_y"]).max()
    assert (5e-3 < tilt < 0.02) if tilts else tilt < 0.1 * first


def test_a_cage_from_a_level_without_tilts_has_a_trace_of_tilt_and_one_that_tilts_keeps_its_own():
    flat = simulation(level="planar")
    flat.advance(1e-3)
    assert Simulation(simulation().scene, start=flat.sample).state[6] == pytest.approx(1e-6)
    tilted = flat.sample.copy()
    tilted["cage_tilt_z"] = 1e-9
    np.testing.assert_array_equal(Simulation(simulation().scene, start=tilted).state[[6, 7]], [0.0, 1e-9])


@pytest.mark.parametrize("speed", [5000, 15000, 45000])
def test_laminae_count_for_life_as_the_loads_of_whole_rollers_do_though_not_at_every_short_step(speed):
    """Aligned rollers without crown carry the same along their length, so that both means are the same but for the instants that count."""
    run = Simulation(load_scene("deng2017_table1", ["level=spatial", f"operating.shaft_speed={speed} rpm", "operating.radial_load=3 kN"]))
    laminae, turn = run._params.life.laminae, 2.0 * np.pi / (0.43 * run.inputs.shaft_speed)
    number = len(laminae.risers)
    run.advance(10.0 * turn)
    ratios = []
    for _ in range(10):
        run.advance(turn)
        loads = [run._work.lamina_means[raceway] * (number / laminae.risers) ** (4.0, 4.5)[raceway] for raceway in range(2)]
        ratios.append([loads[raceway] / run._work.load_moments[raceway, 0] for raceway in range(2)])
    np.testing.assert_allclose(ratios, 1.0, atol=0.03)
    np.testing.assert_allclose(np.mean(ratios, axis=0), 1.0, atol=0.005)
