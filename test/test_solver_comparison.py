# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The comparison with other solvers: they follow the same course, kernels make up a step, and bearings are scaled as described."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from level_speed import SPEEDS, bench_scene, level_integrators
from solver_comparison import STOCK_ROLLERS, bare_problem, print_report, relative_error, scaled_scene, solve_with, state_scales

# The others go the same way, but their loops take long to compile.
MEASURED = ("slip",)
ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def report():
    found = subprocess.run(
        [sys.executable, "test/benchmarks/solver_comparison.py", "--quick", "--json", *(f"--level={level}" for level in MEASURED)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        check=True,
    )
    return json.loads(found.stdout)


@pytest.mark.long
def test_every_integrator_is_compared_with_lsoda_at_both_speeds(report):
    compared = [(case["level"], case["integrator"], case["speed_rpm"]) for case in report["cases"]]
    assert sorted(compared) == sorted((level, name, speed) for level in MEASURED for name in level_integrators(level) for speed in SPEEDS)
    for case in report["cases"]:
        assert case["lsoda_ratio"] > 0 and 0 < case["trajectory_error"] < 1


@pytest.mark.long
def test_other_solvers_are_on_the_same_course(report):
    named = {run["solver"] for run in report["others"]}
    assert named >= {"LSODA", "CVODE"}
    for run in report["others"]:
        assert run["failure"] or run["trajectory_error"] < 0.02, run
    for reference in report["references"]:
        assert reference["trajectory_own_error"] < 1e-6


@pytest.mark.long
def test_kernels_and_the_rest_make_up_a_step(report):
    for bound in report["bound"]:
        assert all(spent > 0 for name, spent in bound["kernel_us"].items() if name != "jacobian"), bound
        assert sum(bound["fraction"].values()) == pytest.approx(1.0)


@pytest.mark.long
def test_every_level_is_measured_with_more_rollers_and_fewer(report):
    assert [level["level"] for level in report["scaling"]] == list(MEASURED)
    for level in report["scaling"]:
        assert min(level["rollers"]) < STOCK_ROLLERS < max(level["rollers"])
        assert all(spent > 0 for spent in level["core_seconds_per_second"]) and np.isfinite(level["exponent"])


@pytest.mark.long
def test_the_tables_name_every_level_integrator_and_solver(report, capsys):
    print_report(report)
    told = capsys.readouterr().out
    for name in {*MEASURED, *(name for level in MEASURED for name in level_integrators(level)), "LSODA", "CVODE"}:
        assert name in told


@pytest.mark.parametrize("rollers", [9, 36, 144])
def test_scaled_bearings_keep_rollers_clearances_spacing_and_surface_speeds(rollers):
    stock, scaled = bench_scene("planar", 45_000), scaled_scene("planar", 45_000, rollers)
    assert scaled.bearing.roller.count == rollers
    for measure in (
        lambda scene: scene.bearing.roller.diameter,
        lambda scene: scene.bearing.radial_clearance_at_low_points,
        lambda scene: scene.bearing.outer_raceway.low_radius - scene.bearing.cage.guide_radius,
        lambda scene: scene.bearing.cage.inner_radius - scene.bearing.inner_raceway.radius,
        lambda scene: scene.bearing.pitch_radius / scene.bearing.roller.count,
        lambda scene: scene.bearing.pitch_radius * scene.operating.shaft_speed,
        lambda scene: scene.operating.radial_load / scene.bearing.roller.count,
        lambda scene: scene.bearing.cage.mass / scene.bearing.roller.count,
    ):
        assert measure(scaled) == pytest.approx(measure(stock), rel=1e-9, abs=1e-12)


def test_a_state_off_by_its_scale_is_off_by_one():
    problem = bare_problem(bench_scene("planar", 45_000))
    scales = state_scales(problem)
    for i in (0, 2, 4, 9, 12):
        off = problem.start.copy()
        off[i] += 0.25 * scales[i]
        share = relative_error(problem, off, problem.start)
        assert share == pytest.approx(0.25, rel=1e-6) or (scales[i] == 1.0 and share == 0.0)


def test_a_solver_that_is_out_of_patience_says_so():
    run = solve_with("LSODA", bare_problem(bench_scene("slip", 45_000)), np.array([1e-4]), 1e-6, patience=0.0)
    assert run.states is None and "gave up" in run.failure


def test_without_scikit_sundae_its_absence_is_reported(monkeypatch):
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    run = solve_with("CVODE", bare_problem(bench_scene("slip", 45_000)), np.array([1e-4]), 1e-6)
    assert run.states is None and "scikit-sundae" in run.failure
