# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The page of all checks: as HTML with each figure, or as Markdown with counts and what does not hold, beside a table of all figures in CSV."""

import csv
import io
from collections import Counter
from collections.abc import Sequence
from html import escape

from bearing_sim.files.provenance import git_hash, package_version, versions
from bearing_sim.studies.page import command as command_block
from bearing_sim.studies.page import document, pairs, paragraph
from validation.check import FAILS, HOLDS, IN_PART, NOT_RUN, Result
from validation.data_sets import DATA_SETS

TITLE = "Validation"
NOT_VALIDATED = (
    "What is not validated: cage slip over speed and load. We found no readable measurement of it for a cylindrical roller bearing whose dimensions "
    "are known, so no slip on this page is held to a test rig. Slip is compared with a published model, with independent calculations of the same "
    "bearing, and with published findings that have a direction but no digits. The lines of recorded vibration are ratios of frequencies: neither "
    "load nor diameters of those bearings are known, so no slip follows from them. Nor is there a measurement behind the bands of slip under unknown "
    "parameters and their calibration, forces on the cage, skew of rollers, temperatures inside a bearing, and lives against failures of real "
    "bearings."
)
_CLASSES = {HOLDS: "holds", IN_PART: "part", FAILS: "fails", NOT_RUN: "soft"}
_MISSED_HEADINGS = ("what", "compared with", "expected", "found", "deviation", "verdict", "command")
_HEADINGS = ("what", "compared with", "expected", "found", "deviation", "tolerance", "verdict", "command", "date")
_MEANING = (
    "Every figure was computed by the command in its line on the day in its line. A tolerance is the most by which a figure may deviate. Where a "
    f"verdict is '{IN_PART}' or '{FAILS}', the line says by how much the model is off."
)
_FIGURES = (
    "[All figures](../test/validation/figures.csv) stand in a table beside their commands: what is compared, with what, both numbers, their "
    "deviation, the tolerance, the command that computes the figure and the day on which it did. This page counts them and names what does not hold."
)
_SOURCES_SHOWN = 3
_NOT_RUN_HERE = (
    "Open recordings of bearings that would show the slip of a cage, with speeds and mostly loads beside the vibration. None of them was run here. "
    "The commands are written for the forms of files that public readers of these data rely on."
)
_DETAILS = (
    ("deng2017", "the results of Deng et al. (2017), its design question, the bearing as it runs"),
    ("friction_and_heat", "heat, friction and catalogue bearings, table by table"),
    ("trends", "published trends"),
    ("independent_models", "plain NumPy models, complex steps and other references in the test suite"),
    ("uncertainty", "unknown parameters, and a measured flight"),
    ("vibration", "cage speed out of vibration: recorded bearings by quarters, errors of synthetic records"),
    ("robustness", "extreme scenes, damaged recordings, outputs, files from others"),
)


def html_page(results: Sequence[Result], made_by: str) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    results : of all checks.
    made_by : the command line that made it.
    """
    opening = f"<p><b>{escape(NOT_VALIDATED)}</b></p>{paragraph(_MEANING)}{_counts(results)}{command_block(made_by)}"
    sections = {group: _table(_HEADINGS, [_html_cells(each) for each in results if each.group == group]) for group in _groups(results)}
    sections["Open data that would validate slip"] = paragraph(_NOT_RUN_HERE) + _table(
        _DATA_HEADINGS, ["".join(f"<td>{escape(text)}</td>" for text in row) for row in _data_rows()]
    )
    sections["Provenance"] = pairs({"version": package_version(), "commit": git_hash()} | versions())
    return document(f"bearing_sim: {TITLE.lower()}", opening, sections)


def markdown_page(results: Sequence[Result], made_by: str) -> str:
    """Return the page as Markdown, for the documents: figures by group, and those that do not hold; parameters as of `html_page`."""
    missed = [each for each in results if each.verdict != HOLDS]
    off = [[*each[2:7], each.verdict, f"`{each.command}`"] for each in missed]
    parts = [f"# {TITLE}", f"**{NOT_VALIDATED}**", _FIGURES, f"```text\n{made_by}\n```", f"{counted(results)}."]
    parts += [_markdown_table(("compared with what", "figures", "hold", "in part", "do not", "sources, among others"), _group_rows(results))]
    parts += [
        "## What does not hold, or in part",
        _markdown_table(_MISSED_HEADINGS, off),
    ]
    parts += ["## Open data that would validate slip", _NOT_RUN_HERE, _markdown_table(_DATA_HEADINGS, _data_rows(code="`"))]
    parts += ["## Details", "\n".join(f"- [{name.replace('_', ' ')}](validation/{name}.md): {text}" for name, text in _DETAILS)]
    return "\n\n".join(parts) + "\n"


def _group_rows(results: Sequence[Result]) -> list[list[str]]:
    rows = []
    for group in _groups(results):
        ours = [each for each in results if each.group == group]
        counts = Counter(each.verdict for each in ours)
        sources = Counter(each.source for each in ours).most_common(_SOURCES_SHOWN)
        numbers = [str(counts[verdict] or "-") for verdict in (HOLDS, IN_PART, FAILS)]
        rows.append([group, str(len(ours)), *numbers, "; ".join(source for source, _ in sources)])
    return rows


def figures_text(results: Sequence[Result]) -> str:
    """Return all figures as CSV with the columns of `Result`."""
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerows([Result._fields, *results])
    return text.getvalue()


def read_figures(text: str) -> list[Result]:
    """Return the figures of `figures_text`."""
    rows = csv.reader(io.StringIO(text))
    assert tuple(next(rows)) == Result._fields
    return [Result(*row) for row in rows]


def _groups(results: Sequence[Result]) -> list[str]:
    return list(dict.fromkeys(each.group for each in results))


def counted(results: Sequence[Result]) -> str:
    """Return how many results have each verdict, in words."""
    counts = Counter(each.verdict for each in results)
    return ", ".join(f"{verdict}: {counts[verdict]}" for verdict in _CLASSES if counts[verdict])


def _counts(results: Sequence[Result]) -> str:
    counts = Counter(each.verdict for each in results)
    shown = "".join(f'<div><b class="{name}">{counts[verdict]}</b> {verdict}</div>' for verdict, name in _CLASSES.items() if counts[verdict])
    return f'<div class="counts">{shown}</div>'


def _html_cells(each: Result) -> str:
    texts = (each.quantity, each.source, each.expected, each.found, each.deviation, each.tolerance)
    cells = "".join(f"<td>{escape(text)}</td>" for text in texts)
    verdict = f'<td class="verdict {_CLASSES[each.verdict]}">{escape(each.verdict)}</td>'
    return f'{cells}{verdict}<td><code>{escape(each.command)}</code></td><td class="day">{escape(each.date)}</td>'


def _table(headings: Sequence[str], rows: Sequence[str]) -> str:
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


_DATA_HEADINGS = ("data", "bearings", "varied", "files", "where", "command (not run here)", "what else it takes")


def _data_rows(code: str = "") -> list[list[str]]:
    return [[*each[:5], "; ".join(f"{code}{text}{code}" for text in each.commands), each.missing] for each in DATA_SETS]


def _markdown_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join("| " + " | ".join(_escaped(text) for text in line) + " |" for line in lines)


def _escaped(text: str) -> str:
    """Return a text for a cell of a Markdown table."""
    return text.replace("|", "\\|").replace("<", "&lt;").replace("\n", " ")
