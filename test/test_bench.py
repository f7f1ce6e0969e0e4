# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench measures every level by every method, and its report can be read by a program."""

import json
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from bearing_sim.cli.main import main
from bearing_sim.cli.reporting import print_rows
from bearing_sim.studies.bench import (
    SPEEDS,
    STOCK_ROLLERS,
    bare_problem,
    level_methods,
    one_core,
    quantile_error,
    relative_error,
    scaled_scene,
    solve_with,
    state_scales,
)

# level spatial goes the same way, but all its methods together take minutes to compile
MEASURED = ("slip", "planar")
ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def report():
    found = subprocess.run(
        [sys.executable, "-m", "bearing_sim.cli", "bench", "levels", "--quick", "--json", *(f"--level={level}" for level in MEASURED)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=ROOT,
        check=True,
    )
    return json.loads(found.stdout)


def test_cases_cover_each_level_by_each_method_at_both_speeds(report):
    stock = [(case["level"], case["integrator"], case["speed_rpm"]) for case in report["cases"] if case["rollers"] == STOCK_ROLLERS]
    assert sorted(stock) == sorted((level, method, speed) for level in MEASURED for method in level_methods(level) for speed in SPEEDS)
    assert {case["rollers"] for case in report["cases"]} > {STOCK_ROLLERS}


def test_what_a_case_says_is_finite_and_positive_where_it_must_be(report):
    for case in report["cases"]:
        assert case["failure"] == "", case
        for name in ("real_time_factor", "step_us", "steps", "right_hand_sides"):
            assert case[name] > 0 and math.isfinite(case[name]), (name, case)
        for name in ("slip_error", "load_error", "orbit_error", "pocket_error"):
            assert case[name] >= 0 and math.isfinite(case[name]), (name, case)
        if case["rollers"] == STOCK_ROLLERS:
            assert case["lsoda_ratio"] > 0 and 0 < case["trajectory_error"] < 1


def test_other_solvers_are_on_the_same_course(report):
    named = {run["solver"] for run in report["others"]}
    assert named >= {"LSODA", "CVODE"}
    for run in report["others"]:
        assert run["failure"] or run["trajectory_error"] < 0.02, run
    for reference in report["references"]:
        assert reference["trajectory_own_error"] < 1e-6


def test_kernels_and_the_rest_make_up_a_step(report):
    for bound in report["bound"]:
        assert all(spent > 0 for name, spent in bound["kernel_us"].items() if name != "jacobian"), bound
        assert sum(bound["fraction"].values()) == pytest.approx(1.0)


def test_the_tables_name_every_level_method_and_solver(report, capsys):
    from bearing_sim.cli import bench

    bench._print_levels(report)
    told = capsys.readouterr().out
    for name in {*MEASURED, *(method for level in MEASURED for method in level_methods(level)), "LSODA", "CVODE"}:
        assert name in told


@pytest.mark.parametrize(
    ("name", "foreign"),
    [("levels", "--rounds=1"), ("levels", "--repetitions=1"), ("fleet", "--cold"), ("fleet", "--seconds=3")],
)
def test_a_benchmark_refuses_the_options_of_another(name, foreign):
    refused = CliRunner().invoke(main, ["bench", name, "--quick", foreign])
    assert refused.exit_code == 2 and "No such option" in refused.output and foreign.partition("=")[0] in refused.output


def test_the_benchmarks_are_listed_and_an_unknown_level_is_refused_by_each_that_takes_one():
    listed = CliRunner().invoke(main, ["bench", "--help"])
    assert listed.exit_code == 0 and all(name in listed.output for name in ("levels", "fleet"))
    assert CliRunner().invoke(main, ["bench"]).output == listed.output, "alone it measures nothing"
    for name in ("levels", "fleet"):
        refused = CliRunner().invoke(main, ["bench", name, "--level", "cheap"])
        assert refused.exit_code == 2 and "expected one of steady, slip, planar, spatial" in refused.output


def test_a_table_shows_the_units_of_its_headings(capsys):
    print_rows("times", ("while", "late [ms]"), [("[absent]", "1.5")], words=("while",))
    told = capsys.readouterr().out
    assert "late [ms]" in told and "[absent]" in told, "brackets are no mark-up"


@pytest.mark.parametrize("rollers", [9, 36, 144])
def test_scaled_bearings_keep_rollers_clearances_spacing_and_surface_speeds(rollers):
    stock, scaled = scaled_scene("planar", 45_000), scaled_scene("planar", 45_000, rollers)
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
    problem = bare_problem(scaled_scene("planar", 45_000))
    scales = state_scales(problem)
    for i in (0, 2, 4, 9, 12):
        off = problem.start.copy()
        off[i] += 0.25 * scales[i]
        share = relative_error(problem, off, problem.start)
        assert share == pytest.approx(0.25, rel=1e-6) or (scales[i] == 1.0 and share == 0.0)


def test_a_solver_that_is_out_of_patience_says_so():
    run = solve_with("LSODA", bare_problem(scaled_scene("slip", 45_000)), np.array([1e-4]), 1e-6, patience=0.0)
    assert run.states is None and "gave up" in run.failure


def test_without_scikit_sundae_its_absence_is_reported(monkeypatch):
    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    run = solve_with("CVODE", bare_problem(scaled_scene("slip", 45_000)), np.array([1e-4]), 1e-6)
    assert run.states is None and "scikit-sundae" in run.failure


def test_quantiles_are_compared_with_themselves_but_not_with_nothing():
    reference = np.array([[0.0, 100.0, 200.0], [50.0, 100.0, 400.0]])
    assert quantile_error(reference, reference) == 0.0
    assert quantile_error(reference + [[0.0, 0.0, 0.0], [5.0, 0.0, 0.0]], reference) == pytest.approx(0.1)
    assert quantile_error(reference + [[0.2, 0.0, 0.0], [0.0, 0.0, 0.0]], reference) == pytest.approx(0.1)


def test_the_process_may_use_all_its_cores_again_after_the_bench():
    import os

    before = os.sched_getaffinity(0)
    with one_core() as core:
        assert os.sched_getaffinity(0) == {core}
    assert os.sched_getaffinity(0) == before
