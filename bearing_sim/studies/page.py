# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Parts of a self-contained HTML page: text, tables and embedded pictures, without scripts and network access."""

import base64
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from html import escape

from bearing_sim.scene.display import heading, hours, number
from bearing_sim.sweep.point import Column

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
.claims td:nth-child(2) { width: 21%; } .claims td:nth-child(5) { width: 31%; } .claims td:nth-child(6) { width: 31%; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
td.pair { width: 24%; }
td.day { white-space: nowrap; }
.wide { overflow-x: auto; }
.warnings { border-left: 4px solid var(--part); background: #fdf6ec; padding: .6rem 1rem; margin: 1rem 0; }
.warnings ul { margin: .3rem 0 0; padding-left: 1.2rem; }
summary { cursor: pointer; margin: .6rem 0; }
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
pre.command { white-space: pre-wrap; overflow-wrap: anywhere; }
@media (max-width: 50rem) {
  table, tbody, tr, td { display: block; width: auto !important; } thead { display: none; }
  td { border: 0; padding: .15rem 0; } tr { padding: .6rem 0; border-bottom: 1px solid var(--line); }
}
@media print { body { max-width: none; padding: 0; } figure, tr { break-inside: avoid; } }
"""


class NoResults(ValueError):
    """A path without results of which a page could be made; the message says what to do."""


def document(title: str, opening: str, sections: Mapping[str, str]) -> str:
    """Return a page.

    Parameters
    ----------
    title : plain text.
    opening : HTML between the title and the first section.
    sections : HTML by heading, in order; empty ones are left out.
    """
    shown = {heading: text for heading, text in sections.items() if text}
    names = {heading: re.sub(r"[^a-z0-9]+", "-", heading.lower()).strip("-") for heading in shown}
    links = "".join(f'<a href="#{name}">{escape(heading)}</a>' for heading, name in names.items())
    parts = [f"<h1>{escape(title)}</h1>", opening, f"<nav>{links}</nav>"]
    parts += [f'<h2 id="{names[heading]}">{escape(heading)}</h2>{text}' for heading, text in shown.items()]
    viewport = '<meta name="viewport" content="width=device-width, initial-scale=1">'
    head = f'<meta charset="utf-8">{viewport}<title>{escape(title)}</title><style>{_STYLE}</style>'
    body = "\n".join(parts)
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>\n{body}\n</body></html>\n'


def paragraph(text: str) -> str:
    """Return plain text as a paragraph."""
    return f"<p>{escape(text)}</p>"


def command(text: str) -> str:
    """Return a command line as a block of code."""
    return f'<pre class="command">{escape(text)}</pre>'


def folded(summary: str, text: str) -> str:
    """Return a long plain text that opens at a click on its summary."""
    return f"<details><summary>{escape(summary)}</summary><pre>{escape(text)}</pre></details>"


def warnings(texts: Sequence[str]) -> str:
    """Return a box of warnings; nothing without any."""
    if not texts:
        return ""
    items = "".join(f"<li>{escape(text)}</li>" for text in texts)
    return f'<div class="warnings"><b>{len(texts)} warning{"s" * (len(texts) > 1)}</b><ul>{items}</ul></div>'


def pairs(values: Mapping) -> str:
    """Return a table of names and values."""
    rows = "".join(
        f'<tr><td class="pair">{escape(str(name))}</td><td>{escape(_shown(value, "")) or chr(8211)}</td></tr>' for name, value in values.items()
    )
    return f"<table><tbody>{rows}</tbody></table>"


def rows_table(columns: Sequence[Column], rows: Iterable[Mapping], summary: str = "") -> str:
    """Return a table of rows with the units of its columns and, as a tooltip, their meanings.

    Long texts that a page says once above, warnings and reasons, are left out.  Of a table with more columns than a page is wide, those that people
    look at first are open, and all of them open at a click.

    Parameters
    ----------
    columns : to show, in order.
    rows : with the names of the columns.
    summary : of a table that opens at a click; empty: it is open.
    """
    rows = list(rows)
    columns = [column for column in columns if column.name not in _SAID_ABOVE]
    if not summary and len(columns) > _MOST_COLUMNS:
        first = [column for column in columns if "." in column.name or column.name in _FIRST] or columns[:_MOST_COLUMNS]
        return _rows_table(first[:_MOST_COLUMNS], rows) + rows_table(columns, rows, f"all {len(columns)} columns")
    whole = _rows_table(columns, rows)
    return f"<details><summary>{escape(summary)}</summary>{whole}</details>" if summary else whole


_MOST_COLUMNS = 9  # that fit side by side
_SAID_ABOVE = ("warnings", "reason")
_FIRST = ("cage_slip", "rating_life", "modified_rating_life", "inner_load_maximum", "running_clearance", "shaft_power", "status")


def _rows_table(columns: Sequence[Column], rows: Sequence[Mapping]) -> str:
    numeric = [
        bool(rows) and all(isinstance(row[column.name], (int, float)) and not isinstance(row[column.name], bool) for row in rows)
        for column in columns
    ]
    classes = [' class="number"' if is_number else "" for is_number in numeric]
    heads = (
        f'<th{kind} title="{escape(column.meaning, quote=True)}">{escape(heading(column.name, column.unit))}</th>'
        for column, kind in zip(columns, classes)
    )
    lines = [
        "".join(f"<td{kind}>{escape(_shown(row[column.name], column.unit)) or chr(8211)}</td>" for column, kind in zip(columns, classes))
        for row in rows
    ]
    head, body = "".join(heads), "".join(f"<tr>{line}</tr>" for line in lines)
    return f'<div class="wide"><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def _shown(value, unit: str) -> str:
    """Return a value as text: lengths with the digits that matter to a raceway, other numbers with five."""
    if value is None or isinstance(value, float) and math.isnan(value):
        return ""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return hours(value, 5).removesuffix(" h") if unit == "h" else number(value, 8 if unit == "mm" else 5)
    return str(value)


def picture(data: bytes, title: str, caption: str = "") -> str:
    """Return an embedded picture.

    Parameters
    ----------
    data : of a PNG file.
    title : plain text.
    caption : HTML.
    """
    shown = escape(title, quote=True)
    source = base64.b64encode(data).decode()
    return f'<figure><img alt="{shown}" src="data:image/png;base64,{source}"><figcaption><b>{shown}</b>{caption}</figcaption></figure>\n'
