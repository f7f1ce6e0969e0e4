# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Every method that a scene may name, on the bearing: they agree with each other, keep their history, end with a reason."""

import numpy as np
import pytest

from bearing_sim import Inputs, SceneError, Simulation, load_scene
from bearing_sim.levels.common.model import DEFAULT_TOLERANCES
from bearing_sim.levels.level import LEVELS
from bearing_sim.numerics.time_stepping import CONTROL
from bearing_sim.scene.fidelity import FIXED_STEP, METHODS
from bearing_sim.scene.scene import tolerance_overrides
from bearing_sim.simulation import IntegrationError, tolerances_of


def simulation(level, method, tolerances=0.1, *overrides, scene="deng2017_table1"):
    named = [f"level={level}", f"integration.method={method}", *tolerance_overrides(tolerances)]
    return Simulation(load_scene(scene, [*named, *overrides]))


def settled(run):
    """Mean slip and ring position over 10 to 20 ms."""
    block = run.advance(0.02, samples=400)[200:]
    return block["cage_slip"].mean(), block["ring_y"].mean(), block["ring_z"].mean()


@pytest.fixture(scope="module")
def accurate():
    return settled(simulation("planar", "sdirk2"))


@pytest.mark.parametrize(
    ("method", "tolerances", "overrides"),
    [("bdf", 1e-3, []), ("sdirk2", 1.0, ["integration.fixed_step=10 us"])],
)
def test_planar_slip_and_ring_position_do_not_hang_on_the_method(method, tolerances, overrides, accurate):
    slip, ring_y, ring_z = settled(simulation("planar", method, tolerances, *overrides))
    # Contacts open and close chaotically: only means over a window compare.  A whole per cent of the slip is 0.07 points; the ring
    # stands 2.7 um off centre.
    assert slip == pytest.approx(accurate[0], rel=0.01)
    assert ring_y == pytest.approx(accurate[1], rel=0.05) and ring_z == pytest.approx(accurate[2], abs=0.1e-6)


def test_first_milliseconds_of_planar_by_bdf_are_those_of_a_tight_tolerance():
    names, course = ("cage_speed", "cage_y", "ring_y"), []
    for tolerances in (1e-4, 1e-7):
        block = simulation("planar", "bdf", tolerances).advance(5e-4, samples=10)
        course.append(np.array([block[name] for name in names]))
    scale = np.abs(course[1]).max(1)
    assert (np.abs(course[0] - course[1]).max(1) / scale < [1e-4, 1e-3, 0.02]).all()


@pytest.mark.parametrize(("method", "overrides"), [("bdf", []), ("rosenbrock2", ["integration.fixed_step=10 us"])])
def test_slip_level_does_not_hang_on_the_method(method, overrides):
    expected = simulation("slip", "rosenbrock2", 0.01).advance(0.02)["cage_slip"][0]
    assert simulation("slip", method, 0.03, *overrides).advance(0.02)["cage_slip"][0] == pytest.approx(expected, rel=0.01)


def test_settings_of_deng_are_a_scene_that_runs():
    scene = load_scene("deng2017_gear")
    assert (scene.level, scene.integration.method) == ("planar", "bdf")
    assert scene.integration.first_step == pytest.approx(1e-5)
    run = Simulation(scene)
    assert 0.01 < run.advance(5e-3)["cage_slip"][0] < 0.05
    counters = run.counters
    assert 0 < counters.jacobians < counters.factorisations < counters.steps < counters.right_hand_sides


def test_ticks_go_on_from_the_history():
    whole, ticked = simulation("slip", "bdf"), simulation("slip", "bdf")
    whole.advance(0.2)
    for _ in range(20):
        ticked.advance(0.01)
    assert ticked._memory.control[CONTROL.time] == pytest.approx(0.2)
    # two shortened steps at the end of each tick; a start at order 1 would cost ten
    assert ticked.counters.steps < whole.counters.steps + 20 * 5
    assert ticked.sample["cage_speed"] == pytest.approx(whole.sample["cage_speed"], rel=2e-3)


def test_fixed_steps_are_as_many_as_the_scene_says():
    run = simulation("slip", "rosenbrock2", 1.0, "integration.fixed_step=20 us")
    run.advance(0.01)
    assert run.counters == (500, 0, 0, 1000, 500, 500, 0, 0)
    run = simulation("planar", "sdirk2", 1.0, "integration.fixed_step=20 us")
    run.advance(0.01)
    assert run.counters.steps == 500
    run.advance(0.01, samples=7)  # 71.4 steps a sample
    assert run.counters.steps == 500 + 7 * 72


@pytest.mark.parametrize("level", ["slip", "planar"])
def test_bdf_survives_a_load_step_and_a_reversal(level):
    run = simulation(level, "bdf", 0.01, "operating.shaft_speed=10000 rpm")
    for target in (Inputs(1000.0, 5000.0, 0.0, 393.15), Inputs(-1000.0, 0.0, 0.0, 393.15)):
        block = run.advance(0.01, target, samples=10)
        assert np.isfinite(block["cage_speed"]).all() and np.isfinite(block["inner_load"]).all()


@pytest.mark.parametrize("method", ["bdf", "sdirk2"])
def test_a_step_budget_ends_a_planar_run_with_a_reason_and_keeps_the_state(method):
    run = simulation("planar", method, 0.01, "integration.step_budget=50")
    before = run._state.copy()
    with pytest.raises(IntegrationError, match="step budget"):
        run.advance(0.1)
    assert run.time == 0.0 and (run._state == before).all()
    run.advance(1e-5)
    assert run.time == 1e-5


def test_every_level_binds_the_methods_that_a_scene_may_name():
    for name, level in LEVELS.items():
        assert tuple(level.methods) == METHODS[name]
        for method, bound in level.methods.items():
            assert (bound.advance_fixed is not None) == (method in FIXED_STEP)
    assert set(LEVELS) == set(METHODS)


@pytest.mark.parametrize(
    ("overrides", "reported"),
    [
        (["level=slip", "integration.method=sdirk2"], "level slip is integrated by rosenbrock2 or bdf, not by sdirk2"),
        (["level=planar", "integration.method=gear"], "level planar is integrated by sdirk2 or bdf, not by gear"),
        (["integration.method=bdf", "integration.fixed_step=10 us"], "fixed_step: bdf needs adaptive steps; use rosenbrock2 or sdirk2"),
    ],
)
def test_a_wrong_method_is_reported_with_the_right_ones(overrides, reported):
    with pytest.raises(SceneError, match=reported):
        load_scene("deng2017_table1", overrides)


def test_only_the_method_used_is_compiled():
    import subprocess
    import sys
    from pathlib import Path

    code = (
        "from bearing_sim import Simulation, load_scene; from bearing_sim.levels.level import LEVELS;"
        "Simulation(load_scene('deng2017_table1', ['integration.method=bdf'])).advance(1e-4);"
        "print([n for n, m in LEVELS['slip'].methods.items() if m.advance.signatures])"
    )
    found = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=300, cwd=Path(__file__).resolve().parents[1], check=True
    )
    assert found.stdout.strip() == "['bdf']"


def test_operating_points_are_marched_with_the_default_tolerances_of_a_scene():
    assert DEFAULT_TOLERANCES == tolerances_of(load_scene("deng2017_table1").integration)
