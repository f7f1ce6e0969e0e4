# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bench measures every level with error control and with a fixed step, and its report can be read by a program."""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from level_speed import SPEEDS, _print_levels, level_integrators, quantile_error
from validation.__main__ import main as validation

from bearing_sim.cli.bench import one_core
from bearing_sim.cli.main import _MOVED, main
from bearing_sim.cli.reporting import print_rows

# level spatial goes the same way, but takes minutes to compile
MEASURED = ("slip", "planar")
ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="module")
def report():
    found = subprocess.run(
        [sys.executable, "test/benchmarks/level_speed.py", "--quick", "--json", *(f"--level={level}" for level in MEASURED)],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=ROOT,
        check=True,
    )
    return json.loads(found.stdout)


@pytest.mark.long
def test_cases_cover_each_level_with_error_control_and_with_a_fixed_step_at_both_speeds(report):
    assert {level: len(level_integrators(level)) for level in (*MEASURED, "steady")} == {"slip": 2, "planar": 2, "steady": 1}
    measured = [(case["level"], case["integrator"], case["speed_rpm"]) for case in report["cases"]]
    assert sorted(measured) == sorted((level, name, speed) for level in MEASURED for name in level_integrators(level) for speed in SPEEDS)


def test_what_a_case_says_is_finite_and_positive_where_it_must_be(report):
    for case in report["cases"]:
        assert case["failure"] == "", case
        for name in ("real_time_factor", "step_us", "steps", "right_hand_sides"):
            assert case[name] > 0 and math.isfinite(case[name]), (name, case)
        for name in ("slip_error", "load_error", "orbit_error", "pocket_error"):
            assert case[name] >= 0 and math.isfinite(case[name]), (name, case)


def test_a_fixed_step_of_ten_microseconds_takes_a_hundred_steps_a_millisecond(report):
    for case in report["cases"]:
        if "fixed step" in case["integrator"]:
            assert case["steps"] == pytest.approx(1e5 * case["simulated_seconds"], rel=0.02)


def test_the_tables_name_every_level_and_integrator(report, capsys):
    _print_levels(report)
    told = capsys.readouterr().out
    for name in {*MEASURED, *(name for level in MEASURED for name in level_integrators(level))}:
        assert name in told


@pytest.mark.parametrize("foreign", ["--cold", "--seconds=3"])
def test_a_benchmark_refuses_the_options_of_another(foreign):
    refused = CliRunner().invoke(main, ["bench", "fleet", "--quick", foreign])
    assert refused.exit_code == 2 and "No such option" in refused.output and foreign.partition("=")[0] in refused.output


def test_the_benchmarks_are_listed_and_an_unknown_level_is_refused():
    listed = CliRunner().invoke(main, ["bench", "--help"])
    assert listed.exit_code == 0 and "fleet" in listed.output
    assert CliRunner().invoke(main, ["bench"]).output == listed.output, "alone it measures nothing"
    refused = CliRunner().invoke(main, ["bench", "fleet", "--level", "cheap"])
    assert refused.exit_code == 2 and "'cheap' is not one of 'steady', 'slip', 'planar', 'spatial'" in refused.output


@pytest.mark.parametrize(
    ("removed", "successor"),
    [
        (("bench", "levels"), "bearing-sim trade SCENE"),
        (("study", "misalignment"), "python examples/misalignment"),
        (("study", "support"), "python examples/response_over_speed"),
        (("study", "resonances"), "python examples/resonances"),
        (("study", "scenes"), "python test/validation scenes"),
    ],
)
def test_a_command_that_left_the_program_names_what_to_run_instead(removed, successor):
    refused = CliRunner().invoke(main, [*removed, "deng2017_table1"])
    assert refused.exit_code == 2 and successor in refused.output


def test_every_successor_of_a_command_that_left_the_program_is_there():
    assert not [name for name in _MOVED if name.split()[1] in main.get_command(None, name.split()[0]).list_commands(None)]
    for successor in _MOVED.values():
        path, *words = re.search(r"python (.+)", successor)[1].split()
        place = ROOT / path
        assert place.is_file() or (place / "__main__.py").is_file(), successor
        assert path != "test/validation" or words[0] in validation.commands, successor


def test_a_table_shows_the_units_of_its_headings(capsys):
    print_rows("times", ("while", "late [ms]"), [("[absent]", "1.5")], words=("while",))
    told = capsys.readouterr().out
    assert "late [ms]" in told and "[absent]" in told, "brackets are no mark-up"


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
