# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the test suite holds against independent models, read from the report that pytest writes (``--junitxml``).

The models that the levels are compared with are part of the tests, not of the package.
"""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

from bearing_sim.files.limits import JSON_FILE
from bearing_sim.files.reading import read_bytes
from validation.check import FAILS, HOLDS, NOT_RUN, Result

GROUP = "Held by the test suite"
_REPORT = "tests.xml"
_TOLERANCE = "as each test states"


class SuiteError(ValueError):
    """A file that is no report of pytest; the message says what was expected."""


class Tested(NamedTuple):
    """A claim, what it is compared with, and the files of tests that hold it."""

    claim: str
    reference: str
    files: tuple[str, ...]


TESTED = (
    Tested("level slip: cage slip over time", "a plain NumPy model", ("test_level_slip",)),
    Tested(
        "levels planar and spatial: forces, powers and Jacobian for each variant of cage guidance, law and crown",
        "plain NumPy models, and a complex step through them",
        ("test_planar_reference", "test_spatial_reference"),
    ),
    Tested("level planar: its limits, symmetries and rough inputs", "level slip, independent calculation", ("test_level_planar",)),
    Tested("level spatial: its planar limit, gyroscopic moments, misalignment", "level planar, closed forms", ("test_level_spatial",)),
    Tested("level steady: periodic states, and how a cage goes to them", "level slip, marched", ("test_level_steady",)),
    Tested("energy: work less heat is what is stored", "conservation", ("test_power",)),
    Tested("integrators: order, stiff problems, tolerance", "closed forms, SciPy", ("test_integrators",)),
    Tested("sums over time do not depend on how a run is cut", "the same run in one call", ("test_cut_invariance",)),
    Tested("settled means settled", "approaches and oscillations of known form", ("test_settling",)),
    Tested("running clearance: fits, rotation, heat", "closed forms, boundary value problems, standards", ("test_running_clearance",)),
    Tested("heat: conductances, network, filter", "units, differential equations, closed forms", ("test_heat", "test_thermal_network")),
    Tested(
        "traction and films: derivatives, limits, signs", "finite differences, published fits", ("test_kernels", "test_film", "test_traction_laws")
    ),
    Tested("profiles of aligned rollers: force, tractions, damping", "sums over strips, finite differences", ("test_profile",)),
    Tested("slices: load, moment, symmetry", "equilibrium, symmetry", ("test_lamina", "test_life", "test_misalignment")),
    Tested("alarms: false-alarm rates, faults found", "probability theory, simulated faults", ("test_cusum", "test_residual")),
    Tested("bands and sensitivities: coverage", "closed forms", ("test_uncertainty", "test_calibrate")),
    Tested("published trends, on a few points", "Dawoud 2022, Guo and Keller 2020, Li 2013", ("test_published_findings", "test_measured_vibration")),
)


def command(tested: Sequence[Tested] = TESTED) -> str:
    """Return the command that runs the tests of claims and writes the report."""
    files = dict.fromkeys(f"test/{name}.py" for each in tested for name in each.files)
    return f"pytest --junitxml={_REPORT} {' '.join(files)}"


def suite_results(report: Path | None) -> list[Result]:
    """Return a line for each claim of `TESTED`: how many of its tests passed, and on which day.

    Parameters
    ----------
    report : that pytest wrote; None: all claims are lines that were not run.

    Raises
    ------
    SuiteError
        The file is no report of pytest.
    FileError
        It cannot be read.
    """
    outcomes, day = ({}, "") if report is None else _read(report)
    found = []
    for each in TESTED:
        counts = sum((outcomes.get(name, Counter()) for name in each.files), Counter())
        missing = [name for name in each.files if name not in outcomes]
        ran = counts["passed"] + counts["failed"]
        verdict = NOT_RUN if missing or not ran else FAILS if counts["failed"] else HOLDS
        skipped = f", {counts['skipped']} skipped" if counts["skipped"] else ""
        shown = f"{counts['passed']} of {ran} passed{skipped}" if verdict != NOT_RUN else "not in the report"
        texts = ("all pass", shown, f"{counts['failed']} failed" if counts["failed"] else "", _TOLERANCE, verdict)
        found.append(Result(GROUP, "", each.claim, each.reference, *texts, command([each]), day if verdict != NOT_RUN else ""))
    return found


def _read(report: Path) -> tuple[dict[str, Counter], str]:
    """Return the counts of outcomes by file of tests, and the day of the report."""
    try:
        root = ElementTree.fromstring(read_bytes(report, JSON_FILE))
    except ElementTree.ParseError as error:
        raise SuiteError(f"{report}: not readable as XML: {error}; expected what pytest writes with --junitxml") from None
    cases = list(root.iter("testcase"))
    suite = next(root.iter("testsuite"), None)
    if suite is None or not cases:
        raise SuiteError(f"{report}: no tests in it; expected what pytest writes with --junitxml (run: {command()})")
    outcomes: dict[str, Counter] = {}
    for case in cases:
        name = case.get("classname", "").split(".")
        file = next((part for part in name if part.startswith("test_")), name[-1])
        tags = {child.tag for child in case}
        outcome = "failed" if tags & {"failure", "error"} else "skipped" if "skipped" in tags else "passed"
        outcomes.setdefault(file, Counter())[outcome] += 1
    return outcomes, suite.get("timestamp", "")[:10]
