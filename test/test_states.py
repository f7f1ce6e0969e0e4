# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Several states of one bearing under the same conditions: skids that last, and rings that vibrate."""

import math

import numpy as np
import pytest
from random_scenes import cold_start
from scipy.integrate import solve_ivp

from bearing_sim import load_scene, settle
from bearing_sim.sweep.point import run_until_settled
from bearing_sim.sweep.ring_resonance import _multiplier, ring_resonance
from bearing_sim.sweep.states import other_states, skid_start, state_rows, states


def test_a_cold_lightly_loaded_bearing_rolls_or_skids_and_both_are_told():
    scene = cold_start()
    rolling, skid = states(scene).found
    assert rolling.cage_slip < 0.01 < 0.2 < skid.cage_slip
    for start, own, other in ((None, rolling, skid), (skid_start(scene), skid, rolling)):
        outcome = run_until_settled(scene, start=start)
        assert outcome.slip == pytest.approx(own.cage_slip, abs=0.01)
        assert [state.cage_slip for state in other_states(scene, outcome).states] == pytest.approx([other.cage_slip])


def test_below_the_skid_load_a_skid_lasts_and_above_it_the_cage_comes_back():
    skid_load = states(cold_start()).skid_load
    for factor, lasts in ((0.9, True), (1.1, False)):
        scene = cold_start(load=factor * skid_load)
        assert (run_until_settled(scene, start=skid_start(scene)).slip > 0.05) == lasts
        assert run_until_settled(scene).slip < 0.05


def test_the_skid_load_does_not_fall_as_oil_cools():
    loads = [states(cold_start(warm)).skid_load for warm in (40, 20, 10, 0)]
    assert loads == sorted(loads) and loads[-1] > 0.0


def test_a_bearing_with_one_state_has_no_other_and_no_skid_load():
    scene = load_scene("nu215_rig", ["level=slip"])
    found = states(scene)
    assert len(found.found) == 1 and found.skid_load == 0.0
    settled = settle(scene)
    assert settled.others.states == () and "no other was found" in str(settled)


def test_a_shaft_at_rest_has_no_states():
    found = states(cold_start(speed=0.0))
    assert found.found == () and math.isnan(found.skid_load)


def test_a_start_that_is_neither_rolling_nor_skidding_is_refused():
    with pytest.raises(ValueError, match="expected 'rolling', 'skid'"):
        settle(cold_start(), start="sliding")


@pytest.mark.parametrize("ratio, grows", [(0.5, True), (0.7, False), (1.0, True), (1.3, False)])
def test_the_multiplier_of_a_ring_is_that_of_mathieus_equation(ratio, grows):
    """Compare with x'' + 2 d w x' + w^2 (1 + 0.5 cos p t) x = 0, integrated by SciPy over a period."""
    passage, count, modulation = 2.0 * math.pi, 400, 0.5
    square, damping = (ratio * passage) ** 2, 2.0 * 0.01 * ratio * passage
    times = (np.arange(count) + 0.5) / count
    changing = square * (1.0 + modulation * np.cos(passage * times))
    stiffness = np.stack([np.diag([each, 7.0 * square]) for each in changing])
    found = _multiplier(stiffness, np.stack([np.eye(2) * damping] * count), 1.0 / count)

    def motion(t, x):
        return [x[1], -damping * x[1] - square * (1.0 + modulation * math.cos(passage * t)) * x[0]]

    columns = [solve_ivp(motion, (0.0, 1.0), start, rtol=1e-9, atol=1e-12).y[:, -1] for start in ([1.0, 0.0], [0.0, 1.0])]
    expected = max(np.abs(np.linalg.eigvals(np.array(columns).T)).max(), math.exp(-0.5 * damping))
    assert found == pytest.approx(expected, rel=1e-3)
    assert (found > 1.0) == grows


def test_natural_frequencies_fall_with_the_square_root_of_the_moving_mass():
    light, heavy = (ring_resonance(load_scene("deng2017_table1", [f"support.shaft.mass={mass} kg"])) for mass in (0.15, 0.75))
    assert heavy.moving_mass == pytest.approx(4.0 * light.moving_mass)
    assert np.array(light.frequencies) == pytest.approx(2.0 * np.array(heavy.frequencies))


def test_a_ring_that_vibrates_and_one_that_does_not_are_both_told_with_the_reason():
    scene = load_scene("deng2017_table1", ["level=planar", "operating.shaft_speed=52500 rpm"])
    outcome = run_until_settled(scene)
    others = other_states(scene, outcome)
    assert outcome.slip == pytest.approx(0.097, abs=0.003) and [state.cage_slip for state in others.states] == pytest.approx([0.163], abs=0.005)
    assert others.states[0].rating_life > 5.0 * float(outcome.window["rating_life"].mean())
    rows = dict(state_rows(others, "rolling"))
    assert "0.55 kg" in rows["inner ring"] and "near 0.5" in rows["inner ring"] and "does not vibrate" in rows["also stays at"]


def test_a_ring_that_does_not_vibrate_from_a_skid_tells_of_the_one_that_does_from_rolling():
    settled = settle("deng2017_table1", "planar", shaft_speed="52500 rpm", start="skid")
    assert settled.cage_slip == pytest.approx(0.163, abs=0.005)
    assert [(state.start, pytest.approx(state.cage_slip, abs=0.003)) for state in settled.others.states] == [("from ideal rolling", 0.097)]


@pytest.mark.parametrize("mass, damping_time, vibrates", [(0.3, 2.5, True), (0.3, 10.0, False), (2.0, 2.5, False), (0.05, 2.5, False)])
def test_where_the_multiplier_is_above_one_level_planar_loses_most_of_its_life(mass, damping_time, vibrates):
    scene = load_scene(
        "deng2017_table1", ["level=planar", f"bearing.inner_raceway.ring_mass={mass} kg", f"bearing.contact.damping_time={damping_time} us"]
    )
    outcome = run_until_settled(scene)
    assert ring_resonance(scene, outcome.slip).excited == vibrates
    assert (float(outcome.window["rating_life"].mean()) < 200.0) == vibrates


def test_a_run_from_a_skid_at_a_level_with_whirl_begins_in_the_skid_of_level_slip():
    start, (_, skid) = skid_start(cold_start(level="planar")), states(cold_start()).found
    assert 0.2 < 1.0 - float(start["cage_speed"] / start["ideal_cage_speed"]) == pytest.approx(skid.cage_slip, abs=1e-3)
