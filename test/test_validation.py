# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The report on validation: each check within its tolerance, the page in the documents up to date, and nothing that looks better than it is."""

import json
import math
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
import scipy.io
from click.testing import CliRunner
from support import measured_file
from synthetic_vibration import Machine, record
from validation.__main__ import main as validation
from validation.check import FAILS, HOLDS, IN_PART, NOT_RUN, Check, Comparison, compared, run
from validation.checks import CHECKS, all_checks
from validation.data_sets import DATA_SETS
from validation.page import NOT_VALIDATED, figures_text, html_page, markdown_page, read_figures
from validation.recorded_lines import RECORDINGS, recorded_checks
from validation.suite import TESTED, SuiteError, suite_results

from bearing_sim.cli.main import main
from bearing_sim.scene.loader import load_bearing
from bearing_sim.scene.quantity import to_si
from bearing_sim.simulation import IntegrationError

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "doc" / "validation.md"
FIGURES = ROOT / "test" / "validation" / "figures.csv"
QUICK = [check for check in CHECKS if not check.is_long]
# What the model does not meet, and the page says so.
MISSED = {
    "estimated_rollers": {IN_PART},  # 76 of 78 numbers of rollers
    "printed_ratings": {FAILS},  # SKF and NKE rate better steel than ISO 281 does
    "reference_heat": {IN_PART},  # the wide bearings of series 23
    "thermal_speeds": {FAILS},  # SKF prints higher speeds than its own model of friction gives
    "frictional_moments": {IN_PART},  # 9 of 160 against M_0 + M_1, most of them light and fast; 1 against SKF's model
    "tapered_bearings": {IN_PART, FAILS},  # rolling to a factor of 1.6 at 500 rpm; films of ribs are thicker than kappa says
    "recorded_ob600_2": {IN_PART},  # within three errors of the independent fit, not within one
}


def figures():
    """Return all figures of the documents."""
    return read_figures(FIGURES.read_text())


@pytest.mark.parametrize("check", QUICK, ids=lambda check: check.name)
def test_a_check_is_within_its_tolerance_and_the_documents_say_what_it_says(check):
    require_in_documents(check)


@pytest.mark.parametrize("name", [each.name for each in RECORDINGS])
def test_lines_of_recorded_bearings_agree_with_an_independent_fit_as_the_documents_say(name):
    folder = measured_file(f"jnu_roller_bearing/{name}.npz").parent
    require_in_documents(next(check for check in recorded_checks(folder) if check.name == f"recorded_{name}"))


def require_in_documents(check):
    """Require the verdicts of a check that are expected, and their lines on the page in the documents."""
    results = run([check])
    assert {each.verdict for each in results} - {HOLDS} == MISSED.get(check.name, set())
    kept = {each[:5] + each[7:9] for each in figures()}
    for each in results:
        assert each[:5] + each[7:9] in kept, (
            "write figures and page again: python test/validation report --figures test/validation/figures.csv -o doc/validation.md"
        )


def test_the_figures_have_run_every_check_with_a_command_and_a_date_for_each():
    found = figures()
    assert len(found) > 80 and {each.verdict for each in found} == {HOLDS, IN_PART, FAILS}
    for each in found:
        assert re.fullmatch(r"(bearing-sim|python test/validation|python examples/deng2017|pytest) .+", each.command), each
        assert re.fullmatch(r"20\d\d-\d\d-\d\d", each.date), each
    assert {check.shown_command for check in all_checks()} <= {each.command for each in found}


def test_the_page_is_that_of_the_figures_and_names_each_that_does_not_hold():
    page, found = PAGE.read_text(), figures()
    made_by = re.search(r"```text\n(python test/validation report .+)\n```", page)[1]
    assert page == markdown_page(found, made_by)
    missed = [each for each in found if each.verdict != HOLDS]
    shown = {line.split(" | ")[0][2:] for line in page[page.index("## What does not hold") :].splitlines() if line.startswith("| ")}
    assert len(missed) > 10 and {each.quantity.replace("<", "&lt;") for each in missed} <= shown


def test_figures_are_read_back_as_they_were_written():
    results = run([check for check in CHECKS if check.name == "contour"])
    odd = results[0]._replace(quantity='a, "b"', source="")
    assert read_figures(figures_text([*results, odd])) == [*results, odd]


def test_names_of_checks_are_unique_and_the_figures_have_each_group():
    names = [check.name for check in all_checks()]
    assert len(names) == len(set(names))
    assert {check.group for check in all_checks()} <= {each.group for each in figures()}


def test_the_page_begins_with_what_is_not_validated():
    results = run([check for check in CHECKS if check.name == "contour"])
    html = html_page(results, "a command")
    assert -1 < html.index(NOT_VALIDATED) < html.find("34860")
    for page in (markdown_page(results, "a command"), PAGE.read_text()):
        assert -1 < page.index(NOT_VALIDATED) < page.find("| Closed forms |")


@pytest.mark.parametrize(
    ("found", "tolerance", "verdict"),
    [
        ([1.009, 2.0], {"relative": 0.01}, HOLDS),
        ([1.011, 2.0], {"relative": 0.01}, FAILS),
        ([0.989, 2.0], {"relative": 0.01}, FAILS),
        ([1.0, 2.09], {"absolute": 0.1}, HOLDS),
        ([1.0, 1.89], {"absolute": 0.1}, FAILS),
        ([1.9, 1.1], {"factor": 2.0}, HOLDS),
        ([0.4, 2.0], {"factor": 2.0}, FAILS),
        ([1.0, math.nan], {"relative": 0.5}, FAILS),
        ([1.0, math.nan], {"absolute": 0.5}, FAILS),
        ([1.0, math.nan], {"factor": 9.0}, FAILS),
        ([1.0, math.inf], {"factor": 9.0}, FAILS),
    ],
)
def test_numbers_hold_only_if_all_of_them_are_within_the_tolerance_and_known(found, tolerance, verdict):
    assert compared("x", "y", [1.0, 2.0], found, **tolerance).verdict == verdict


def test_a_comparison_shows_numbers_units_and_the_largest_deviation():
    few = compared("life", "by hand", [100.0, 200.0], [101.0, 200.0], unit="h", relative=0.02)
    assert few[2:6] == ("100, 200 h", "101, 200 h", "1 %", "2 %")
    assert compared("x", "y", range(10), np.arange(10.0) + 0.25, unit="mm", absolute=1.0)[2:6] == (
        *("10 numbers from 0 to 9 mm", "10 numbers from 0.25 to 9.25 mm"),
        *("0.25 mm", "1 mm"),
    )
    assert compared("x", "y", 3.0, 3.0 + 1e-15, relative=1e-9)[4:6] == ("0", "1.0e-09")
    with pytest.raises(ValueError, match="3 numbers expected and 2 found"):
        compared("x", "y", [1.0, 2.0, 3.0], [1.0, 2.0], relative=0.1)


def test_a_check_that_cannot_be_computed_does_not_hold_and_leaves_the_others():
    def fail():
        raise IntegrationError("no step converges")

    good = Comparison("x", "y", "1", "1", "0", "1 %", HOLDS)
    checks = Check("broken", "group", fail), Check("sound", "group", lambda: [good]), Check("slow", "group", lambda: [good], is_long=True)
    broken, sound, slow = run(checks, quick=True)
    assert broken.verdict == FAILS and "no step converges" in broken.found
    assert sound.verdict == HOLDS and sound.command == "python test/validation report --only sound"
    assert slow.verdict == NOT_RUN and slow.date == ""


def test_a_recording_that_is_not_there_or_cannot_be_read_is_refused_before_anything_is_computed(tmp_path):
    assert {each.verdict for each in run(recorded_checks(None))} == {NOT_RUN}
    for expected in ("ob600_2.npz: no such file", "ob600_2.npz: cannot be read as NPZ"):
        result = invoke("--recordings", tmp_path, "-o", tmp_path / "page.md")
        assert result.exit_code == 2 and expected in result.output and not (tmp_path / "page.md").exists()
        (tmp_path / "ob600_2.npz").write_text("no archive")


def test_a_recording_that_shows_another_ring_or_nothing_does_not_hold(tmp_path):
    for name, shows, speed in (("ob600_2", "inner_ring", 62.8), ("ib800_2", "", 83.8)):
        synthetic = record(Machine(shows, 13, 0.19, 0.08, speed, signal_to_noise=10.0, interfering=0), 20_000.0, 8.0, np.random.default_rng(1))
        np.savez(tmp_path / f"{name}.npz", acceleration=synthetic.vibration.samples, fs_hz=20_000.0)
    inner, nothing = run(recorded_checks(tmp_path))
    assert inner.verdict == nothing.verdict == FAILS and inner.found == "a line of the inner ring"
    assert nothing.found.startswith("no line of this bearing")


@pytest.mark.parametrize("command", [command for each in DATA_SETS for command in each.commands], ids=lambda command: command.split()[2])
def test_the_command_for_an_open_data_set_works_on_a_file_of_its_documented_form(command, tmp_path):
    for symbol, size in (("Z", "10"), ("D_W", "9mm"), ("D_M", "40mm")):
        command = re.sub(rf"\b{symbol}\b", size, command)
    _, _, name, *words = shlex.split(command)
    options = dict(zip(words[::2], words[1::2]))
    bearing = load_bearing(options["--bearing"]) if "--bearing" in options else None
    rollers, size = (bearing.roller.count, bearing.roller.diameter / bearing.pitch_diameter) if bearing else (10, 9.0 / 40.0)
    speed, shows = to_si(options["--speed"], "rad/s"), "outer_ring" if "_OR_" in name else "inner_ring"
    machine = Machine(shows, rollers, size, 0.08, speed, signal_to_noise=10.0, interfering=0)
    synthetic = record(machine, to_si(options["--rate"], "Hz"), 100.0 * 2.0 * math.pi / speed, np.random.default_rng(1))
    samples = synthetic.vibration.samples
    if name.endswith(".csv"):
        rows = "".join(f"{value:.5f},0.{number % 10},1e-3\n" for number, value in enumerate(samples))
        (tmp_path / name).write_text(f"Mod1/ai0,Mod1/ai1,Mod1/ai2\n{rows}")
    elif options["--channel"] == "Data":
        scipy.io.savemat(tmp_path / name, {"Data": samples[:, None], "S": np.ones((129, 2000)), "F": np.ones((129, 1)), "T": np.ones((1, 2000))})
    else:
        scipy.io.savemat(tmp_path / name, {name.removesuffix(".mat"): np.stack([samples] * 6, 1)})
    result = CliRunner().invoke(main, ["vibration", str(tmp_path / name), *words, "--json"])
    found = json.loads(result.output)
    assert found["shows"] == shows and abs(found["cage_to_shaft"] - synthetic.ratio) < 5.0 * found["cage_to_shaft_standard_error"] < 0.01


def test_texts_from_a_file_cannot_act_as_markup():
    hostile = Comparison("<script>alert(1)</script>|x", "y", "1", "1", "0", "1 %", FAILS)
    results = run([Check("hostile", "group", lambda: [hostile])])
    assert "<script" not in html_page(results, "a < b") and "<script" not in markdown_page(results, "a")
    assert "\\|x" in markdown_page(results, "a")


def write_suite(path, *cases):
    body = "".join(f'<testcase classname="test.{name}" name="a">{inner}</testcase>' for name, inner in cases)
    path.write_text(f'<testsuites><testsuite name="pytest" timestamp="2026-03-04T05:06:07+00:00">{body}</testsuite></testsuites>')
    return path


def test_claims_of_the_test_suite_hold_only_where_all_of_their_tests_ran_and_passed(tmp_path):
    passed = [(name, "") for each in TESTED for name in each.files]
    held = suite_results(write_suite(tmp_path / "all.xml", *passed, ("test_power", "<skipped/>")))
    assert {each.verdict for each in held} == {HOLDS} and {each.date for each in held} == {"2026-03-04"}
    failed = {each.command: each for each in suite_results(write_suite(tmp_path / "one.xml", *passed, ("test_power", "<failure>x</failure>")))}
    assert [each.found for each in failed.values() if each.verdict != HOLDS] == ["1 of 2 passed"]
    without = [each for each in passed if each[0] != "test_spatial_reference"]
    missing = suite_results(write_suite(tmp_path / "missing.xml", *without))
    assert [each.verdict for each in missing].count(NOT_RUN) == 1 and "not in the report" in {each.found for each in missing}
    assert {each.verdict for each in suite_results(None)} == {NOT_RUN}
    assert {name for each in TESTED for name in each.files} <= {path.stem for path in (ROOT / "test").glob("test_*.py")}


@pytest.mark.parametrize("content", ["", "{}", "<a/>", "<testsuite></testsuite>"])
def test_a_file_that_is_no_report_of_tests_is_refused_with_what_was_expected(tmp_path, content):
    path = tmp_path / "tests.xml"
    path.write_text(content)
    with pytest.raises(SuiteError, match="expected what pytest writes with --junitxml"):
        suite_results(path)


def invoke(*arguments):
    return CliRunner().invoke(validation, ["report", *map(str, arguments)])


def test_the_command_writes_the_page_of_chosen_checks(tmp_path):
    for name in ("page.html", "page.md"):
        result = invoke("-o", tmp_path / name, "--only", "contour", "--only", "published_findings", "--quick")
        assert result.exit_code == 0 and "holds: 1, not run: 1" in result.output
    assert (tmp_path / "page.html").read_text().startswith("<!doctype html>") and (tmp_path / "page.md").read_text().startswith("# Validation")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--only", "contuor"], "--only contuor: there is no such check (did you mean 'contour'?); expected one of contour,"),
        (["--recordings", "nowhere"], "nowhere: no such folder; --recordings expects one with ob600_2.npz, ib800_2.npz"),
        (["--only", "contour", "--tests", "tests.xml"], "--only chooses single checks; give one of them"),
        (["--tests", "nowhere.xml"], "nowhere.xml: no such file"),
    ],
)
def test_what_cannot_be_reported_says_why(tmp_path, arguments, expected):
    result = invoke(*arguments, "-o", tmp_path / "page.html")
    assert result.exit_code == 2 and expected in result.output and not list(tmp_path.iterdir())
