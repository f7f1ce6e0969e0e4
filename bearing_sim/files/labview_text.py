# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""LabVIEW measurement files (``.lvm``) as plain tables: one heading of names and units, one column of times, headers as comments.

The format is National Instruments' "Specification for the LabVIEW Measurement File (.lvm)": a header, then segments, each with a header of
its own.  Times count from the start of their segment; ``X_Columns`` says whether they stand in one column, in none, or in one for each channel.
"""

import datetime
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress

_FIRST = "LabVIEW Measurement"
_SECONDS_FROM_1904 = 1e9  # times above count from 1904 (Time_Pref Absolute), whatever their segment says

Header = Mapping[str, Sequence[str]]
"""The cells behind each name of a header."""


def plain_lines(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines of a LabVIEW measurement file as those of a plain table, as many as there are; those of another text as they are."""
    rest = iter(lines)
    first = next(rest, "")
    if not first.startswith(_FIRST):
        yield from filter(None, (first,))
        yield from rest
        return
    separator = "," if first[len(_FIRST) :].startswith(",") else "\t"
    header: dict[str, list[str]] = {}
    names, in_header, begins, offset, row = [], True, None, 0.0, 0
    yield _comment([first])
    for line in rest:
        cells = [cell.strip() for cell in line.rstrip("\r\n").split(separator)]
        in_header = (in_header or cells[0] == "Channels") and cells[0] != "X_Value"
        if cells[0] == "X_Value":
            start = _start(header)
            begins = begins or start
            offset, row = (start - begins).total_seconds() if start and begins else 0.0, 0
            is_first, names = not names, names or _names(cells, header)
            yield separator.join(names) + "\n" if is_first else _comment(cells)
        elif in_header or not any(cells):
            header[cells[0]] = cells[1:]
            yield _comment(cells)
        else:
            cells[0] = _time(cells[0], header, row, offset)
            yield separator.join(cells[: len(names)]) + "\n"
            row += 1


def start_of(lines: Iterable[str]) -> str:
    """Return what the times of a converted LabVIEW measurement file count from, in ISO 8601; ``""`` if its header does not say."""
    header: dict[str, list[str]] = {}
    for line in itertools.takewhile(lambda line: line.startswith("#"), lines):
        name, *cells = line.removeprefix("#").split() or [""]
        header |= {name: cells} if name in ("Date", "Time") else {}
    start = _start(header)
    return start.isoformat() if start else ""


def _comment(cells: Sequence[str]) -> str:
    """Return a line of a header, without separators, so that no reader takes it for that of the table."""
    return f"# {' '.join(cells)}".strip() + "\n"


def _start(header: Header) -> datetime.datetime | None:
    with suppress(LookupError, ValueError):
        return datetime.datetime.fromisoformat(f"{header['Date'][0].replace('/', '-')} {header['Time'][0].replace(',', '.')[:15]}")
    return None


def _names(cells: Sequence[str], header: Header) -> list[str]:
    """Return the headings of the columns, with units; the last one, of comments, has none."""
    units, found = iter(header.get("Y_Unit_Label", ())), []
    for cell in cells[: cells.index("Comment") if "Comment" in cells else len(cells)]:
        if cell == "X_Value":
            unit = "s" if header.get("X_Dimension", ["Time"])[0] == "Time" else ""
            cell = f"X_Value {len(found)}" if found else cell
        else:
            unit = next(units, "")
        found.append(f"{cell} [{unit}]" if unit else cell)
    return found


def _number(text: str) -> float | None:
    with suppress(ValueError):
        return float(text.replace(",", "."))
    return None


def _time(text: str, header: Header, row: int, offset: float) -> str:
    """Return the time of a row [s] from the start of the file; the text itself where it is that already, or nothing says it."""
    value = _number(text)
    if not text:
        first, step = (_number(header.get(name, [""])[0]) for name in ("X0", "Delta_X"))
        value = None if first is None or step is None else first + row * step
    elif not offset or value is None or value > _SECONDS_FROM_1904:
        return text
    found = "" if value is None else f"{value + offset:.9f}"
    return found.replace(".", ",") if header.get("Decimal_Separator", ["."])[0] == "," else found
