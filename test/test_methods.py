# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Error control and fixed steps on the bearing: they agree with each other, keep to their budget, end with a reason."""

import pytest

from bearing_sim import SceneError, Simulation, load_scene
from bearing_sim.levels.common.model import DEFAULT_TOLERANCES
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.simulation import IntegrationError, tolerances_of


def simulation(level, tolerances=0.1, *overrides):
    return Simulation(load_scene("deng2017_table1", [f"level={level}", *tolerance_overrides(tolerances), *overrides]))


def settled(run):
    """Mean slip and ring position over 10 to 20 ms."""
    block = run.advance(0.02, samples=400)[200:]
    return block["cage_slip"].mean(), block["ring_y"].mean(), block["ring_z"].mean()


def test_planar_slip_and_ring_position_are_the_same_in_fixed_steps():
    accurate = settled(simulation("planar"))
    slip, ring_y, ring_z = settled(simulation("planar", 1.0, "integration.fixed_step=10 us"))
    # Contacts open and close chaotically: only means over a window compare.  A whole per cent of the slip is 0.07 points; the ring
    # stands 2.7 um off centre.
    assert slip == pytest.approx(accurate[0], rel=0.01)
    assert ring_y == pytest.approx(accurate[1], rel=0.05) and ring_z == pytest.approx(accurate[2], abs=0.1e-6)


def test_slip_is_the_same_in_fixed_steps():
    expected = simulation("slip", 0.01).advance(0.02)["cage_slip"][0]
    assert simulation("slip", 0.03, "integration.fixed_step=10 us").advance(0.02)["cage_slip"][0] == pytest.approx(expected, rel=0.01)


def test_fixed_steps_are_as_many_as_the_scene_says():
    run = simulation("slip", 1.0, "integration.fixed_step=20 us")
    run.advance(0.01)
    # one iteration for each of two stages of a step, and the slope at the beginning once
    assert run.counters == (500, 0, 0, 1001, 1000, 1000, 0, 0)
    run = simulation("planar", 1.0, "integration.fixed_step=20 us")
    run.advance(0.01)
    assert run.counters.steps == 500
    run.advance(0.01, samples=7)  # 71.4 steps a sample
    assert run.counters.steps == 500 + 7 * 72


def test_a_step_budget_ends_a_planar_run_with_a_reason_and_keeps_the_state():
    run = simulation("planar", 0.01, "integration.step_budget=50")
    before = run._state.copy()
    with pytest.raises(IntegrationError, match="step budget"):
        run.advance(0.1)
    assert run.time == 0.0 and (run._state == before).all()
    run.advance(1e-5)
    assert run.time == 1e-5


def test_a_level_without_steps_refuses_a_fixed_one_and_an_automatic_level_has_steps():
    with pytest.raises(SceneError, match="integration.fixed_step: needs level slip or planar or spatial, which take steps"):
        load_scene("deng2017_table1", ["level=steady", "integration.fixed_step=10 us"])
    assert load_scene("deng2017_table1", ["level=auto", "integration.fixed_step=10 us"]).level == "slip"


def test_operating_points_are_marched_with_the_default_tolerances_of_a_scene():
    assert DEFAULT_TOLERANCES == tolerances_of(load_scene("deng2017_table1").integration)
