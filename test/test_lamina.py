# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Claims about the balance by slices: closed forms and symmetry; `test_validation` has the digits of independent lamina codes."""

import math

import numpy as np
import pytest
from validation.published_digits import round_bearing

from bearing_sim.levels.common.slice_balance import balance, roller_tilts
from bearing_sim.levels.slip import state as slip_state
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.model.params import pack
from bearing_sim.physics.contact import EXPONENT
from bearing_sim.physics.lamina import ROLLER_ROW, new_slices, sliced_contact
from bearing_sim.scene.loader import load_scene

AT_REST = (0.0, 0.0)


def deng(*overrides):
    return pack(load_scene("deng2017_table1", ["level=spatial", *overrides]))


def loads(slices):
    return slices.roller[ROLLER_ROW.inner_load], slices.roller[ROLLER_ROW.outer_load]


def test_rollers_that_stand_still_pass_their_loads_on_and_those_with_play_have_none():
    slices = balance(round_bearing(18, 7, 62.75, 7, 0.02), *AT_REST, (800.0, 0.0))
    inner, outer = loads(slices)
    assert inner[[1, 2]] == pytest.approx(inner[[17, 16]]) and not inner[3:16].any()
    np.testing.assert_allclose(outer, inner, atol=1e-6)


def test_a_roller_stands_half_way_between_the_raceways_where_nothing_but_them_holds_it():
    slices = balance(round_bearing(6, 9, 43.5, 13.6, 0.01, crown="iso_log"), *AT_REST, (1000.0, 0.0), (0.0, 1.0))
    assert roller_tilts(slices)[0] == pytest.approx(0.5 * slices.ring[3], rel=1e-6)


@pytest.mark.parametrize("count", [5, 20, 41])
def test_slices_without_tilt_and_crown_are_palmgrens_line_contact(count):
    params = deng(f"bearing.roller.slices={count}")
    slices, written = new_slices(18, params.slices.crown, params.rollers.length, params.raceways.stiffness), np.zeros(count)
    load, moment, slope, slope_1, _ = sliced_contact(5e-6, 0.0, slices, written)
    assert load == pytest.approx(params.raceways.stiffness * 5e-6**EXPONENT, rel=1e-13)
    assert slope == pytest.approx(EXPONENT * load / 5e-6, rel=1e-13)
    assert abs(moment) < 1e-12 * load and abs(slope_1) < 1e-12 * slope
    np.testing.assert_allclose(written, load / count, rtol=1e-13)


def test_slopes_of_a_sliced_contact_are_its_derivatives():
    params = deng("bearing.roller.crown=iso_log", "bearing.roller.slices=20")
    slices, written = new_slices(18, params.slices.crown, params.rollers.length, params.raceways.stiffness), np.zeros(20)
    step = 1e-11

    def around(by, axis):
        return sliced_contact(5e-6 + by * (axis == 0), 3e-6 + by * (axis == 1), slices, written)[:2]

    slopes = sliced_contact(5e-6, 3e-6, slices, written)[2:]
    for axis in (0, 1):
        found = (np.array(around(step, axis)) - np.array(around(-step, axis))) / (2 * step)
        np.testing.assert_allclose(found, slopes[axis : axis + 2], rtol=1e-4)


def test_without_crown_and_moment_it_is_the_balance_of_level_slip():
    params = deng()
    slices = balance(params, 0.3, 2000.0, (700.0, 300.0))
    work = slip_state.new_work(params)
    assert balance_loads(0.3, 2000.0, 700.0, 300.0, params, work)
    # that one uses a centring spring of 1e3 N/m, and balances the load to 1e-6
    spring, residual = 1e3 * math.hypot(*work.ring), 1e-6 * math.hypot(700.0, 300.0)
    np.testing.assert_allclose(loads(slices), (work.loads[8], work.loads[9]), rtol=0, atol=spring + residual)
    np.testing.assert_allclose(slices.ring[:2], work.ring, atol=2e-10)
    assert abs(slices.ring[2:]).max() < 1e-12 and abs(roller_tilts(slices)).max() < 1e-12


def test_a_mirrored_moment_mirrors_tilts_and_slices():
    params = deng("bearing.roller.crown=iso_log")
    one = balance(params, 0.1, 1500.0, (800.0, 100.0), (0.2, 1.0))
    other = balance(params, 0.1, 1500.0, (800.0, 100.0), (-0.2, -1.0))
    np.testing.assert_allclose(one.inner, other.inner[:, ::-1], atol=1e-5)
    np.testing.assert_allclose(one.ring[2:], -other.ring[2:], rtol=1e-6)
    assert abs(one.ring[3]) > 1e-5


def test_turning_load_moment_and_cage_turns_the_answer():
    params = deng("bearing.outer_raceway.d_value=0 mm", "bearing.roller.crown=iso_log")
    angle = 0.7
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    load, moment = np.array([800.0, 100.0]), np.array([0.1, 0.6])
    one = balance(params, 0.2, 1500.0, tuple(load), tuple(moment))
    other = balance(params, 0.2 + angle, 1500.0, tuple(turn @ load), tuple(turn @ moment))
    np.testing.assert_allclose(other.inner, one.inner, atol=1e-5)
    np.testing.assert_allclose(other.ring[:2], turn @ one.ring[:2], atol=1e-13)
    np.testing.assert_allclose(other.ring[2:], turn @ one.ring[2:], atol=1e-11)


def test_slices_carry_load_moment_and_centrifugal_force():
    params = deng("bearing.roller.crown=iso_log")
    slices = balance(params, 0.4, 2100.0, (800.0, -200.0), (0.3, 0.5))
    np.testing.assert_allclose(slices.reaction, (800.0, -200.0, 0.3, 0.5), rtol=1e-6)
    x = slices.position * slices.half_length
    cosine, sine = slices.roller[ROLLER_ROW.cosine], slices.roller[ROLLER_ROW.sine]
    assert slices.inner.sum(axis=1) @ cosine == pytest.approx(800.0, rel=1e-6)
    assert (slices.inner @ x) @ cosine == pytest.approx(0.5, rel=1e-6)
    assert -(slices.inner @ x) @ sine == pytest.approx(0.3, rel=1e-6)
    np.testing.assert_allclose((slices.outer - slices.inner).sum(axis=1), slices.roller[ROLLER_ROW.centrifugal], rtol=1e-6)
    np.testing.assert_allclose((slices.outer - slices.inner) @ x, 0.0, atol=1e-6)


def test_given_tilts_are_kept_and_their_moment_is_told():
    params = deng("bearing.roller.crown=iso_log")
    free = balance(params, 0.0, 1500.0, (800.0, 0.0), (0.0, 0.7))
    held = balance(params, 0.0, 1500.0, (800.0, 0.0), tilts=tuple(free.ring[2:]))
    np.testing.assert_allclose(held.ring, free.ring, atol=1e-11)
    assert held.reaction[3] == pytest.approx(0.7, rel=1e-5)


@pytest.mark.parametrize("speed", [0.0, 2100.0])
@pytest.mark.parametrize("load", [0.0, 1e-6, 1.0, 800.0, 5e4])
@pytest.mark.parametrize("low_radius", ["34.80 mm", "34.8625 mm", "34.875 mm", "34.90 mm"])
@pytest.mark.parametrize("moment", [0.0, 1.0])
def test_any_load_any_play_at_rest_and_at_speed_is_balanced(speed, load, low_radius, moment):
    if moment and load < 800.0 and low_radius >= "34.875 mm":
        return  # with play and without load nothing holds a moment
    params = deng(f"bearing.outer_raceway.low_radius={low_radius}", "bearing.roller.crown=iso_log")
    slices = balance(params, 0.05, speed, (load, 0.0), (0.0, moment))
    for field in slices:
        assert np.isfinite(field).all()
    assert (slices.inner >= 0).all() and (slices.outer >= 0).all()
    largest = loads(slices)[1].max()
    assert slices.reaction[0] == pytest.approx(load, abs=1e-7 * (largest + load + 1e-2))


def test_a_round_bearing_with_play_and_without_load_stays_where_it_is():
    slices = balance(round_bearing(18, 7, 62.75, 7, 0.02), *AT_REST, (0.0, 0.0))
    assert not slices.ring.any() and not slices.inner.any() and not slices.outer.any()


def test_what_is_not_finite_is_told():
    with pytest.raises(ArithmeticError, match="not finite"):
        balance(deng(), *AT_REST, (math.nan, 0.0))


def test_misalignment_loads_the_edges_and_a_crown_softens_them():
    def edge(crown, milliradians):
        slices = balance(deng(f"bearing.roller.crown={crown}"), 0.0, 2000.0, (800.0, 0.0), tilts=(0.0, 1e-3 * milliradians))
        return slices.inner.max()

    straight = [edge("none", tilt) for tilt in (0, 1, 2, 3)]
    assert all(b > a for a, b in zip(straight, straight[1:]))
    assert edge("iso_log", 0) > straight[0] and edge("iso_log", 3) < straight[3]
