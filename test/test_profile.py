# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about aligned rollers with a profile: the table against sums over slices, and the levels against those that slice the rollers."""

import functools
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.common.slice_balance import balance
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.model.params import lubricate, pack
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES, load, new_rows, store
from bearing_sim.physics.contact import CONTACT, ContactDamping, line_contact_stiffness
from bearing_sim.physics.lamina import ROLLER_ROW
from bearing_sim.physics.load_balance import LOAD, squeezed_roller
from bearing_sim.physics.mixed import FULL_FILMS
from bearing_sim.physics.profile import concentrate, damped_profile_contact, new_profile, profile_depth, profile_force, spread_tractions
from bearing_sim.physics.traction import traction
from bearing_sim.scene.crown import IsoLogCrown, NoCrown, StraightArcCrown, TableCrown, crown_drops

DIAMETER = LENGTH = 7e-3
STIFFNESS = line_contact_stiffness(LENGTH, 2.06e11, 0.3)
DAMPING = ContactDamping(0.104, 2.5e-6, 1e-7)
CROWNS = {
    "logarithmic": IsoLogCrown(),
    "straight, then arcs": StraightArcCrown(straight_length=3e-3, crown_radius=1.0),
    "measured, not symmetrical": TableCrown(positions=(-3.5e-3, -1e-3, 1.5e-3, 3.5e-3), drops=(9e-6, 1e-6, 1e-6, 6e-6)),
}
DEPTHS = st.floats(3e-8, 3e-5)


@functools.lru_cache
def profile(name):
    return new_profile(functools.partial(crown_drops, CROWNS[name], DIAMETER, LENGTH))


@functools.lru_cache
def drops(name, count=100_000):
    drop = crown_drops(CROWNS[name], DIAMETER, LENGTH, count)
    return drop - drop.min()


def plain(name, depth):
    """The force of a depth, as a sum over slices."""
    return STIFFNESS * float(np.mean(np.maximum(depth - drops(name), 0.0) ** (10 / 9)))


@kernel
def _press(rows, stiffness, damping, profile):
    force, d_penetration, d_rate = damped_profile_contact(load(rows, 0, 0), load(rows, 0, 1), stiffness, damping, profile)
    store(rows, 0, 2, force)
    store(rows, 0, 3, d_penetration)
    store(rows, 0, 4, d_rate)


def press(name, penetration, rate):
    """Force and its derivatives by penetration and rate, as the levels compute them."""
    rows = new_rows(5, LANES)
    rows[0, 0], rows[0, 1] = penetration, rate
    _press(rows, STIFFNESS, DAMPING, profile(name))
    return rows[0, 2:, 0].copy()


@pytest.mark.parametrize("name", CROWNS)
@given(DEPTHS)
@settings(max_examples=40, deadline=None)
def test_the_force_is_the_sum_over_slices(name, depth):
    assert profile_force(depth, STIFFNESS, profile(name))[0] == pytest.approx(plain(name, depth), rel=2e-3)


@pytest.mark.parametrize("name", CROWNS)
@given(DEPTHS)
@settings(max_examples=40, deadline=None)
def test_lanes_and_numbers_have_one_law_and_its_slope_is_the_difference(name, depth):
    force, slope = profile_force(depth, STIFFNESS, profile(name))
    lanes = press(name, depth + profile(name).highest, 0.0)
    assert lanes[:2] == pytest.approx([force, slope], rel=1e-12)
    step = 1e-5 * depth
    ahead, behind = (profile_force(depth + sign * step, STIFFNESS, profile(name))[0] for sign in (1.0, -1.0))
    assert slope == pytest.approx((ahead - behind) / (2 * step), rel=1e-4)


@pytest.mark.parametrize("name", CROWNS)
@given(DEPTHS, st.floats(-0.05, 0.05))
@settings(max_examples=40, deadline=None)
def test_damping_is_that_of_slices_and_its_derivatives_are_differences(name, depth, rate):
    penetration, step = depth + profile(name).highest, 1e-6 * depth
    force, d_penetration, d_rate = press(name, penetration, rate)
    elastic, slope = profile_force(depth, STIFFNESS, profile(name))
    expected = elastic * (1 + DAMPING.hysteresis * rate) + DAMPING.time * slope * rate * depth / (depth + DAMPING.depth)
    assert force == pytest.approx(max(expected, 0.0), rel=1e-9, abs=1e-12)
    if expected < 1e-3 * elastic:
        return  # at the bend where a contact lets go there is no derivative
    found = (press(name, penetration + step, rate)[0] - press(name, penetration - step, rate)[0]) / (2 * step)
    assert d_penetration == pytest.approx(found, rel=2e-3)  # the second derivative of the table jumps at its knots
    assert d_rate == pytest.approx((press(name, penetration, rate + 1e-6)[0] - press(name, penetration, rate - 1e-6)[0]) / 2e-6, rel=1e-5)


@pytest.mark.parametrize("name", CROWNS)
@given(st.floats(1e-2, 1e5))
@settings(max_examples=40, deadline=None)
def test_the_depth_of_a_force_carries_it(name, force):
    depth = profile_depth(force, STIFFNESS, profile(name))
    assert profile_force(depth, STIFFNESS, profile(name))[0] == pytest.approx(force, rel=1e-7)
    assert depth >= (force / STIFFNESS) ** 0.9 * (1 - 1e-9)  # a profile makes a contact softer


@pytest.mark.parametrize("name", CROWNS)
@given(st.floats(-1e-5, 6e-5), st.floats(0.0, 2000.0), st.floats(-1e-5, 7e-5) | st.just(math.nan))
@settings(max_examples=100, deadline=None)
def test_a_squeezed_roller_with_a_profile_is_in_balance_from_any_guess(name, approach, centrifugal, guess):
    shape = profile(name)
    free = profile_depth(centrifugal, STIFFNESS, shape)
    outer, inner_load, slope, share = squeezed_roller(approach, centrifugal, free, guess, STIFFNESS, shape)
    if approach <= free:
        assert inner_load <= 1e-3 * centrifugal
        return
    assert profile_force(outer, STIFFNESS, shape)[0] == pytest.approx(inner_load + centrifugal, rel=1e-5, abs=1e-5)
    assert profile_force(approach - outer, STIFFNESS, shape)[0] == pytest.approx(inner_load, rel=1e-4, abs=1e-4) and slope >= 0.0
    if approach - free < 1e-7:
        return  # the slope changes within the step of a finite difference
    deeper = squeezed_roller(approach + 1e-9, centrifugal, free, 0.0, STIFFNESS, shape)
    assert deeper[1] - inner_load == pytest.approx(1e-9 * slope, rel=0.02, abs=2e-3)
    assert 1e-9 - (deeper[0] - outer) == pytest.approx(1e-9 * share, rel=0.02, abs=1e-11)


def test_a_profile_without_drops_is_straight_and_a_deep_contact_forgets_its_profile():
    assert not new_profile(functools.partial(crown_drops, NoCrown(), DIAMETER, LENGTH)).crowned
    assert profile_force(3e-3, STIFFNESS, profile("logarithmic"))[0] == pytest.approx(STIFFNESS * 3e-3 ** (10 / 9), rel=2e-3)


@pytest.mark.parametrize("oil", ["MIL-PRF-23699", "ISO VG 68"])
@pytest.mark.parametrize("force", [30.0, 300.0, 3000.0])
def test_traction_is_that_of_all_slices(oil, force):
    scene = load_scene("deng2017_table1", [f"lubricant.oil={oil}", "bearing.roller.crown=iso_log"])
    params = pack(scene)
    films = lubricate(scene.lubricant, params, 353.15)

    def rub(loads, slide):
        contacts = new_rows(len(CONTACT), 2 * LANES * -(-len(loads) // LANES))
        half = contacts[: contacts.shape[0] // 2]
        half[:, CONTACT.load] = np.resize(loads, (half.shape[0], LANES))
        contacts[:, CONTACT.rolling], contacts[:, CONTACT.sliding] = 20.0, slide
        return contacts, half

    shape = params.raceways.profile
    depth = profile_depth(force, STIFFNESS, shape)
    slices = STIFFNESS * np.maximum(depth - drops("logarithmic", 4000), 0.0) ** (10 / 9)
    for slide in (0.02, 0.2, 4.0):
        contacts, each = rub(slices, slide)
        traction(contacts, films.inner, films.outer, FULL_FILMS)
        expected = float(each[:, CONTACT.force].ravel()[: len(slices)].mean())
        found = []
        for changed in (force, force * 1.001, force * 0.999):
            contacts, whole = rub([changed], slide)
            whole[:, CONTACT.penetration] = profile_depth(changed, STIFFNESS, shape)
            concentrate(STIFFNESS, shape, contacts)
            traction(contacts, films.inner, films.outer, FULL_FILMS)
            spread_tractions(contacts)
            assert whole[0, CONTACT.load, 0] == changed
            found.append(whole[0, [CONTACT.force, CONTACT.d_load], 0].copy())
        assert found[0][0] == pytest.approx(expected, rel=0.08)
        assert found[0][1] == pytest.approx((found[1][0] - found[2][0]) / (0.002 * force), rel=0.02)


@pytest.mark.parametrize("crown", ["iso_log", "{law: straight_arc, straight_length: 4 mm, crown_radius: 1 m}"])
def test_the_balance_of_level_slip_is_that_of_400_slices(crown):
    params = pack(load_scene("deng2017_table1", ["level=spatial", f"bearing.roller.crown={crown}", "bearing.roller.slices=400"]))
    for pulled in ((300.0, 100.0), (3000.0, -500.0)):
        slices, work = balance(params, 0.3, 2000.0, pulled), slip_state.new_work(params)
        assert balance_loads(0.3, 2000.0, *pulled, params, work)
        largest = slices.roller[ROLLER_ROW.inner_load].max()
        np.testing.assert_allclose(work.loads[LOAD.inner], slices.roller[ROLLER_ROW.inner_load], atol=2e-3 * largest)
        np.testing.assert_allclose(work.loads[LOAD.outer], slices.roller[ROLLER_ROW.outer_load], atol=2e-3 * largest)
        np.testing.assert_allclose(work.ring, slices.ring[:2], atol=5e-9)


def test_a_profile_that_is_lower_everywhere_stands_for_a_thinner_roller():
    """Drops of at least 2 um on both contacts are 4 um less of the diameter."""

    def loads(*overrides):
        params = pack(load_scene("deng2017_table1", overrides))
        work = slip_state.new_work(params)
        assert balance_loads(0.1, 2000.0, 800.0, 0.0, params, work)
        return work.loads[LOAD.inner].copy()

    def table(lowered):
        return f"bearing.roller.crown={{law: table, positions: [-3.5 mm, 0 mm, 3.5 mm], drops: [{5 + lowered} um, {lowered} um, {5 + lowered} um]}}"

    # what a roller's mass changes by is below the tolerance
    np.testing.assert_allclose(loads(table(2)), loads(table(0), "bearing.roller.diameter=6.996 mm"), atol=2.0)


@pytest.fixture(scope="module")
def idling():
    """Slip, rolling power, largest load and life of the catalogue's NU 210 far below its minimum load, by level and profile."""
    given = {"name": "idling", "bearing": {"preset": "NU 210"}, "lubricant": {"oil": "ISO VG 68", "temperature": "60 degC"}, "heat": {"law": "none"}}
    given |= {"operating": {"shaft_speed": "3000 rpm", "radial_load": "150 N"}}
    found = {}
    for kind in ("planar", "spatial", "planar, straight"):
        level, *straight = kind.split(", ")
        run = Simulation(load_scene(given, [f"level={level}", *(["bearing.roller.crown=none"] if straight else [])]))
        run.advance(0.2)
        samples = run.advance(0.1, samples=50)
        found[kind] = {name: float(np.mean(samples[name])) for name in ("cage_slip", "inner_rolling_power", "outer_rolling_power", "rating_life")}
        found[kind]["load"] = float(np.mean(samples["inner_load"].max(axis=1)))
    return found


def test_levels_with_and_without_slices_agree_on_the_default_profile(idling):
    planar, spatial = idling["planar"], idling["spatial"]
    for name, within in (("load", 0.01), ("rating_life", 0.02), ("inner_rolling_power", 0.03), ("outer_rolling_power", 0.03)):
        assert planar[name] == pytest.approx(spatial[name], rel=within), name
    # what is left is tilting cages and rollers; straight rollers slip twice as much
    assert abs(planar["cage_slip"] - spatial["cage_slip"]) < 0.25 * abs(idling["planar, straight"]["cage_slip"] - spatial["cage_slip"])
