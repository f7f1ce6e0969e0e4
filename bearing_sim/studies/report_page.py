# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Self-contained HTML page of a study: claims, figures, settings and versions, with embedded pictures and without network access."""

import base64
import json
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path

from bearing_sim.studies.deng2017.run import STUDY_FILE

_STYLE = """
:root { color-scheme: light; --ink: #1c2430; --soft: #5b6675; --line: #d9dee5; --shade: #f5f7f9; --good: #00703c; --part: #9a5b00; --bad: #a3231f; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 2rem 1.5rem 4rem; font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: #fff; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.25rem; margin: 2.6rem 0 .6rem; border-bottom: 1px solid var(--line); padding-bottom: .25rem; }
p { max-width: 62rem; }
.soft { color: var(--soft); }
nav a { margin-right: 1.2rem; }
table { border-collapse: collapse; width: 100%; font-size: .9rem; }
th, td { text-align: left; vertical-align: top; padding: .45rem .6rem; border-bottom: 1px solid var(--line); }
th { background: var(--shade); font-weight: 600; }
tr.first td { border-top: 2px solid #b8c0cb; }
td p { margin: 0 0 .4rem; }
td:nth-child(2) { width: 21%; } td:nth-child(5) { width: 31%; } td:nth-child(6) { width: 31%; }
table.plain td { width: auto; }
code { overflow-wrap: anywhere; }
td.verdict { white-space: nowrap; font-weight: 600; }
.holds { color: var(--good); } .part { color: var(--part); } .fails { color: var(--bad); }
.counts { display: flex; gap: 2rem; flex-wrap: wrap; margin: 1rem 0; }
.counts b { font-size: 1.5rem; }
figure { margin: 1.8rem 0; }
figcaption { max-width: 62rem; }
figcaption b { display: block; }
img { max-width: 100%; height: auto; border: 1px solid var(--line); }
code, pre { font: .85em/1.45 ui-monospace, monospace; }
pre { background: var(--shade); padding: .8rem; overflow-x: auto; }
@media (max-width: 50rem) {
  table, tbody, tr, td { display: block; width: auto !important; } thead { display: none; }
  td { border: 0; padding: .15rem 0; } tr { padding: .6rem 0; border-bottom: 1px solid var(--line); }
}
@media print { body { max-width: none; padding: 0; } figure, tr { break-inside: avoid; } }
"""
_CLASSES = {"holds": "holds", "holds in part": "part", "does not hold": "fails"}


class NoStudy(ValueError):
    """A folder without a finished study; the message says what to do."""


def write_page(folder: Path, out: Path) -> None:
    """Write the page of a study.

    Parameters
    ----------
    folder : written by a study such as `bearing_sim.studies.deng2017.run.run_study`.
    out : the HTML file.

    Raises
    ------
    NoStudy
        The folder has no finished study, or a figure is missing.
    """
    try:
        about = json.loads((folder / STUDY_FILE).read_text())
    except FileNotFoundError:
        raise NoStudy(f"{folder}: no finished study ({STUDY_FILE} is missing); run: bearing-sim study deng2017 -o {folder}") from None
    except ValueError as error:
        raise NoStudy(f"{folder / STUDY_FILE}: not readable as JSON: {error}") from None
    out.write_text(_page(folder, about))


def _page(folder: Path, about: Mapping) -> str:
    title = escape(about["title"])
    parts = [
        f"<h1>{title}</h1>",
        _opening(about),
        '<nav><a href="#claims">Claims</a><a href="#figures">Figures</a><a href="#settings">Settings</a><a href="#versions">Versions</a></nav>',
        f'<h2 id="claims">Claims</h2>{_counts(about["claims"])}{_claims(about["claims"])}',
        f'<h2 id="figures">Figures</h2>{"".join(_figure(folder, each) for each in about["figures"])}',
        f'<h2 id="settings">Settings</h2>{_settings(about)}',
        f'<h2 id="versions">Versions</h2>{_pairs(about["versions"])}',
    ]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1"><title>{title}</title><style>{_STYLE}</style>'
    body = "\n".join(parts)
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def _opening(about) -> str:
    warning = "This is a quick run with few points and short simulations, for testing only; its verdicts are not those of the full study."
    quick = f"<p><b>{warning}</b></p>" if about["quick"] else ""
    levels = "; ".join(f"<b>{escape(level)}</b> {escape(text)}" for level, text in about["levels"].items())
    doi = escape(about["doi"], quote=True)
    statuses = ", ".join(f"{count} {escape(status)}" for status, count in about["statuses"].items())
    return (
        f"{quick}<p>All figures use the parameters of the bundled scenes; nothing is tuned. Every sweep ran at two levels of "
        f'fidelity: {levels}.</p><p class="soft">{about["points"]} runs; points of sweeps: {statuses}. '
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
    return f"<table>{head}<tbody>{''.join(rows)}</tbody></table>"


def _figure(folder: Path, each: Mapping) -> str:
    path = folder / "figures" / each["file"]
    try:
        data = base64.b64encode(path.read_bytes()).decode()
    except FileNotFoundError:
        raise NoStudy(f"{path}: figure missing; run the study again") from None
    tables = ", ".join(f"<code>tables/{escape(name)}.csv</code>" for name in each["tables"])
    title = escape(each["title"], quote=True)
    caption = f'<figcaption><b>{title}</b>{escape(each["caption"])} <span class="soft">Numbers: {tables}.</span></figcaption>'
    return f'<figure><img alt="{title}" src="data:image/png;base64,{data}">{caption}</figure>\n'


def _settings(about) -> str:
    rows = []
    for each in about["sweeps"]:
        options = [*(f"--set {item}" for item in each["set"]), *(f"--vary {item}" for item in each["vary"])]
        shown = "<br>".join(map(escape, options))
        cells = "".join(f"<td>{escape(each[name])}</td>" for name in ("figures", "title", "scene"))
        rows.append(f"<tr>{cells}<td><code>{shown}</code></td></tr>")
    head = "<thead><tr><th>figures</th><th>varied</th><th>scene</th><th>as options of <code>bearing-sim sweep</code></th></tr></thead>"
    scenes = "".join(
        f"<details><summary>scene <code>{escape(name)}</code>, all values in SI</summary><pre>{escape(text)}</pre></details>"
        for name, text in about["scenes"].items()
    )
    return (
        f"<p>Each point starts from ideal rolling and runs for {about['duration']:g} s, or longer until slip has settled; "
        f'results are means over the last fifth.</p><table class="plain">{head}<tbody>{"".join(rows)}</tbody></table>{scenes}'
    )


def _pairs(values: Mapping) -> str:
    rows = "".join(f"<tr><td>{escape(str(name))}</td><td>{escape(str(value)) or chr(8211)}</td></tr>" for name, value in values.items())
    return f'<table class="plain"><tbody>{rows}</tbody></table>'
