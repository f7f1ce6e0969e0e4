# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Page of the study of Deng 2017: claims, figures, settings and versions."""

import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from bearing_sim.files.limits import JSON_FILE
from bearing_sim.files.reading import NO_FILE, read_bytes, read_text, why_not_readable
from bearing_sim.studies.page import NoResults, document, folded, pairs, picture
from bearing_sim.sweep.table import written_by_us
from deng2017.run import STUDY_FILE

_CLASSES = {"holds": "holds", "holds in part": "part", "does not hold": "fails"}


def study_page(folder: Path) -> str:
    """Return the page of a study.

    Parameters
    ----------
    folder : written by `deng2017.run.run_study`.

    Raises
    ------
    NoResults
        The folder has no finished study, or a figure is missing.
    """
    file = folder / STUDY_FILE
    try:
        about = json.loads(read_text(file, JSON_FILE))
    except (ValueError, RecursionError) as error:
        raise NoResults(f"{file}: not readable as JSON: {error}") from None
    try:
        with written_by_us(file):
            return document(
                about["title"],
                _opening(about),
                {
                    "Claims": f"{_counts(about['claims'])}{_claims(about['claims'])}",
                    "Figures": "".join(_figure(folder, each) for each in about["figures"]),
                    "Settings": _settings(about),
                    "Versions": pairs(about["versions"]),
                },
            )
    except ValueError as error:
        raise NoResults(str(error)) from None


def _opening(about) -> str:
    warning = "This is a quick run with few points and short simulations, for testing only; its verdicts are not those of the full study."
    quick = f"<p><b>{warning}</b></p>" if about["quick"] else ""
    levels = "; ".join(f"<b>{escape(level)}</b> {escape(text)}" for level, text in about["levels"].items())
    doi = escape(about["doi"], quote=True)
    statuses = ", ".join(f"{escape(str(count))} {escape(status)}" for status, count in about["statuses"].items())
    return (
        f"{quick}<p>All figures use the parameters of the bundled scenes; nothing is tuned. Every sweep ran at two levels of "
        f'fidelity: {levels}.</p><p class="soft">{escape(str(about["points"]))} runs; points of sweeps: {statuses}. '
        f"Made by <code>{escape(about['command'])}</code>. "
        f'The paper: <a href="https://doi.org/{doi}">doi {doi}</a>.</p>'
    )


def _counts(claims: Sequence[Mapping]) -> str:
    levels = dict.fromkeys(each["level"] for each in claims)
    counts = []
    for level in levels:
        verdicts = [each["verdict"] for each in claims if each["level"] == level]
        counted = ", ".join(f'<b class="{name}">{verdicts.count(verdict)}</b> {verdict}' for verdict, name in _CLASSES.items())
        counts.append(f"<div>{escape(level)}: {counted}</div>")
    return f'<div class="counts">{"".join(counts)}</div>'


def _claims(claims: Sequence[Mapping]) -> str:
    rows, before = [], None
    for each in claims:
        first = each["claim"] != before
        before = each["claim"]
        figures = f'<br><span class="soft">figure{"s" * ("," in each["figures"])} {escape(each["figures"])}</span>'
        says = f"{escape(each['says'])}{figures}" if first else ""
        off = f'<p class="off">{escape(each["off"])}</p>' if each["off"] else ""
        why = f'<p class="soft">Reason: {escape(each["why"])}</p>' if each["why"] else ""
        opening = '<tr class="first"><td>' + escape(str(each["claim"] or "")) if first else "<tr><td>"
        verdict = f'<td class="verdict {_CLASSES[each["verdict"]]}">{escape(each["verdict"])}</td>'
        rows.append(f"{opening}</td><td>{says}</td><td>{escape(each['level'])}</td>{verdict}<td>{escape(each['gives'])}</td><td>{off}{why}</td></tr>")
    head = "<thead><tr><th></th><th>Deng 2017 says</th><th>level</th><th>verdict</th><th>this code</th><th>deviation, and reason</th></tr></thead>"
    return f'<table class="claims">{head}<tbody>{"".join(rows)}</tbody></table>'


def _figure(folder: Path, each: Mapping) -> str:
    if Path(each["file"]).name != each["file"]:  # of another folder: whoever reads the page is not meant to see that file
        raise NoResults(f"{folder / STUDY_FILE}: figure {each['file']!r}: expected the name of a file in the folder figures")
    path = folder / "figures" / each["file"]
    tables = ", ".join(f"<code>tables/{escape(name)}.csv</code>" for name in each["tables"])
    if why_not_readable(path) == NO_FILE:
        raise NoResults(f"{path}: figure missing; run the study again")
    data = read_bytes(path, JSON_FILE)
    return picture(data, each["title"], f'{escape(each["caption"])} <span class="soft">Numbers: {tables}.</span>')


def _settings(about) -> str:
    rows = []
    for each in about["sweeps"]:
        options = [*(f"--set {item}" for item in each["set"]), *(f"--vary {item}" for item in each["vary"])]
        shown = "<br>".join(map(escape, options))
        cells = "".join(f"<td>{escape(each[name])}</td>" for name in ("figures", "title", "scene"))
        rows.append(f"<tr>{cells}<td><code>{shown}</code></td></tr>")
    head = "<thead><tr><th>figures</th><th>varied</th><th>scene</th><th>as options of <code>bearing-sim sweep</code></th></tr></thead>"
    scenes = "".join(folded(f"scene {name}, all values in SI", text) for name, text in about["scenes"].items())
    return (
        f"<p>Each point starts from ideal rolling and runs for {about['duration']:g} s, or longer until slip has settled; "
        f"results are means over the last fifth.</p><table>{head}<tbody>{''.join(rows)}</tbody></table>{scenes}"
    )
