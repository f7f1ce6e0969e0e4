# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the quadrature of contacts along the rollers, against sums over 20,000 slices of the profile itself."""

import math

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.spatial.slices import press_points, sum_tractions
from bearing_sim.levels.spatial.state import DROP, FRACTION, POINT_ROWS, POSITION, SLICED, SLICED_ROWS
from bearing_sim.model.params import SLICED_EQUALLY, pack
from bearing_sim.numerics.simd import LANES, new_blocks
from bearing_sim.physics.contact import CONTACT
from bearing_sim.scene.crown import IsoLogCrown, NoCrown, StraightArcCrown, crown_drops, slice_middles

FINE, EXPONENT = 20_000, 10 / 9
ARC = '{law: straight_arc, straight_length: "4 mm", crown_radius: "1.5 m"}'
MEASURED = '{law: table, positions: ["-3.5 mm", "-2 mm", "0 mm", "1.6 mm", "3.5 mm"], drops: ["9 um", "1.5 um", "0 um", "1 um", "14 um"]}'


def params_of(crown, *overrides):
    return pack(load_scene("deng2017_table1", ["level=spatial", f"bearing.roller.crown={crown}", *overrides]))


def pressed(params, penetration, lean, rate=0.0, lean_rate=0.0):
    """Contacts of one block each with inner and outer raceway, their points, and the first point of each."""
    contacts, points, first = new_blocks(2, SLICED_ROWS), new_blocks(2 * params.slices.points, POINT_ROWS), np.zeros(2, np.int64)
    for row, value in ((SLICED.penetration, penetration), (SLICED.lean, lean), (SLICED.rate, rate), (SLICED.lean_rate, lean_rate)):
        contacts[:, row] = value
    contacts[:, SLICED.rolling] = 10.0
    middle, end = press_points(contacts, points, first, params.slices, params.raceways.stiffness, params.raceways.damping)
    assert (middle, end) == (len(points) // 2, len(points)) or (middle, end) == (0, 0)
    return contacts, points, first


def integrals(params, crown, penetration, lean, rate, lean_rate):
    """Load, its moment, and the derivatives of the load by depth and by its rate, each times 1, x and x^2."""
    length, damping, stiffness = params.rollers.length, params.raceways.damping, params.raceways.stiffness
    x, drops = slice_middles(length, FINE), crown_drops(crown, 2 * params.rollers.radius, length, FINE)
    depth, speed = penetration + lean * x - drops, rate + lean_rate * x
    per_rate = damping.hysteresis + EXPONENT * damping.time / (np.maximum(depth, 0.0) + damping.depth)
    slope, factor = -EXPONENT * damping.time / (np.maximum(depth, 0.0) + damping.depth) ** 2, 1 + per_rate * speed
    bears, root = (depth > 0) & (factor > 0), stiffness * np.maximum(depth, 1e-300) ** (1 / 9)
    each = root * depth * factor, root * (EXPONENT * factor + depth * slope * speed), per_rate * root * depth
    q, stiff, damped = (np.where(bears, one, 0.0) for one in each)
    return np.array([q.mean(), (q * x).mean(), *((stiff * x**k).mean() for k in range(3)), *((damped * x**k).mean() for k in range(3))])


# largest errors of load, and of stiffness and damping, in relation to the whole; a kink of the profile costs accuracy
CROWNS = {
    "none": (NoCrown(), 2e-4, 2e-3),
    "iso_log": (IsoLogCrown(), 1.5e-2, 3e-2),
    ARC: (StraightArcCrown(straight_length=4e-3, crown_radius=1.5), 6e-3, 1e-2),
}


@pytest.mark.parametrize("crown", CROWNS)
def test_load_moment_stiffness_and_damping_are_integrals_over_the_profile(crown):
    profile, of_load, of_stiffness = CROWNS[crown]
    params, random = params_of(crown), np.random.default_rng(3)
    half, errors = params.rollers.length / 2, []
    for _ in range(60):
        penetration, lean = random.uniform(1e-6, 15e-6, LANES), random.choice([0.0, 1.0]) * random.normal(0.0, 5e-4, LANES)
        rate, lean_rate = random.normal(0.0, 0.02, LANES), random.normal(0.0, 2.0, LANES)
        contacts, _, _ = pressed(params, penetration, lean, rate, lean_rate)
        for lane in range(LANES):
            expected = integrals(params, profile, penetration[lane], lean[lane], rate[lane], lean_rate[lane])
            rows = [SLICED.load, SLICED.tilting, *range(SLICED.stiffness, SLICED.stiffness + 3), *range(SLICED.damping, SLICED.damping + 3)]
            whole = np.array([*expected[[0, 0]], *3 * [expected[2]], *3 * [expected[5]]]) * half ** np.array([0, 1, 0, 1, 2, 0, 1, 2])
            for block in range(2):
                errors.append(np.abs(contacts[block, rows, lane] - expected) / whole)
    largest = np.max(errors, axis=0)
    assert largest[:2].max() < of_load and largest[2:].max() < of_stiffness
    mean = np.sqrt(np.mean(np.square(errors), axis=0))
    assert mean[:2].max() < of_load / 3 and mean[2:].max() < of_stiffness / 3


def test_points_of_a_straight_aligned_roller_carry_what_the_whole_contact_does():
    params = params_of("none")
    contacts, points, first = pressed(params, 5e-6, 0.0)
    whole = params.raceways.stiffness * 5e-6**EXPONENT
    assert contacts[:, SLICED.load] == pytest.approx(whole, rel=1e-10)  # roots are taken to 1e-11
    assert contacts[:, SLICED.stiffness] == pytest.approx(EXPONENT * whole / 5e-6, rel=1e-10)
    assert np.abs(contacts[:, SLICED.tilting]).max() < 1e-12 * whole * params.rollers.length
    half = params.rollers.length / 2
    assert contacts[:, SLICED.stiffness + 2] == pytest.approx(EXPONENT * whole / 5e-6 * half**2 / 3, rel=1e-10)
    assert points[:, CONTACT.load] == pytest.approx(whole, rel=1e-10)
    assert points[: params.slices.points, FRACTION].sum(0) == pytest.approx(1.0, rel=1e-13)
    points[:, CONTACT.force] = 7.0
    sum_tractions(contacts, points, first, params.slices.points)
    assert contacts[:, SLICED.force] == pytest.approx(7.0, rel=1e-13)


@pytest.mark.parametrize("crown", CROWNS)
@pytest.mark.parametrize("lean", [0.0, 4e-4, -9e-4, 5e-3])
def test_points_lie_on_the_part_of_a_roller_that_bears(crown, lean):
    params, profile = params_of(crown), CROWNS[crown][0]
    length, diameter = params.rollers.length, 2 * params.rollers.radius
    x, drops = slice_middles(length, 1_000_000), crown_drops(profile, diameter, length, 1_000_000)
    for penetration in (-1e-6, 0.3e-6, 2e-6, 8e-6):
        bears = x[penetration + lean * x - drops > 0]
        _, points, first = pressed(params, penetration, lean)
        if not len(bears):
            assert first[0] < 0 or not points[:, FRACTION].any()
            continue
        own = points[: params.slices.points, :, 0]
        assert own[:, FRACTION].sum() == pytest.approx(np.ptp(bears) / length, rel=0.03)
        margin = 0.03 * np.ptp(bears)
        assert own[:, POSITION].min() > bears[0] - margin and own[:, POSITION].max() < bears[-1] + margin
        assert own[:, DROP] == pytest.approx(np.interp(own[:, POSITION], x, drops), abs=1e-9)


@pytest.mark.parametrize("crown", CROWNS)
def test_loads_are_continuous_in_penetration_and_lean(crown):
    # A jump where a point or an end changes its place by rule keeps implicit steps from converging.
    params, whole = params_of(crown), {}
    for scan in ("penetration", "lean"):
        found, steps = [], 4000
        at = np.linspace(-2e-6, 4e-6, steps) if scan == "penetration" else np.linspace(-3e-3, 3e-3, steps)
        for first in range(0, steps, LANES):
            several = at[first : first + LANES]
            contacts, _, _ = pressed(params, several, 6e-4) if scan == "penetration" else pressed(params, 1e-6, several)
            found.append(contacts[0, [SLICED.load, SLICED.tilting]])
        load, moment = np.concatenate(found, axis=1)
        whole[scan] = load.max()
        for values in (load, moment):
            rises = np.abs(np.diff(values))
            nearby = np.maximum(rises[2:], rises[:-2])  # a jump stands out from the rises beside it
            assert (rises[1:-1] <= 1.5 * nearby + 1e-5 * np.abs(values).max()).all()
    assert min(whole.values()) > 100.0


def test_a_contact_that_is_apart_has_no_points_and_carries_nothing():
    contacts, _, first = pressed(params_of("iso_log"), -5e-6, 1e-4)
    assert (first == -1).all() and not contacts[:, SLICED.load].any() and not contacts[:, SLICED.stiffness :].any()


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf, 1e300])
def test_a_state_that_went_astray_spoils_no_other_lane(wrong):
    params, penetration = params_of("iso_log"), np.full(LANES, 5e-6)
    expected, _, _ = pressed(params, penetration, 3e-4)
    for row in ("penetration", "lean"):
        given = {"penetration": penetration.copy(), "lean": np.full(LANES, 3e-4)}
        given[row][1] = wrong
        contacts, _, _ = pressed(params, **given)
        np.testing.assert_array_equal(np.delete(contacts, 1, axis=2), np.delete(expected, 1, axis=2))


def test_a_profile_given_by_a_table_is_cut_into_slices():
    slices = params_of(MEASURED).slices
    assert slices.profile == SLICED_EQUALLY and slices.points == len(slices.positions) == 30


def test_a_number_of_slices_in_the_scene_replaces_the_quadrature():
    slices = params_of("iso_log", "bearing.roller.slices=30").slices
    assert slices.profile == SLICED_EQUALLY and slices.points == len(slices.positions) == len(slices.walls) == 30


@pytest.mark.parametrize("crown", ["none", "iso_log"])
def test_a_misaligned_bearing_runs_as_with_many_slices(crown):
    scene = [
        "level=spatial",
        f"bearing.roller.crown={crown}",
        "operating.misalignment=1 mrad",
        "operating.radial_load=3kN",
        "integration.fixed_step=10 us",
    ]
    coarse, fine = (Simulation(load_scene("deng2017_table1", [*scene, *more])) for more in ([], ["bearing.roller.slices=200"]))
    found, expected = coarse.advance(4e-3, samples=200)[100:], fine.advance(4e-3, samples=200)[100:]
    for name in ("inner_edge_pressure", "outer_edge_pressure", "inner_pressure"):
        assert found[name].mean() == pytest.approx(expected[name].mean(), rel=0.01)
    assert found["l10r"][-1] == pytest.approx(expected["l10r"][-1], rel=0.01)
    off, whole = (np.sqrt(np.mean(np.square(tilts))) for tilts in (found["roller_tilt"] - expected["roller_tilt"], expected["roller_tilt"]))
    assert off < 0.05 * whole  # light rollers tilt freely, and steps differ
