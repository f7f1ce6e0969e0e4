# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A sheet of a workbook (.xlsx) as the lines of a CSV table, so that headings, units, numbers and times are understood as those of any other table.

A number is written with a dot, a date as ISO 8601, and a cell with text as it is; the number of a line is that of the row.
"""

import csv
import io
import zipfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from bearing_sim.files.extras import what_is_missing
from bearing_sim.files.limits import TABLE_COLUMNS, WORKBOOK_BYTES, FileError
from bearing_sim.scene.errors import did_you_mean, shortened

_SHOWN = 300  # characters in a message
_MOST_ROWS = 2**20  # that a sheet can have


def sheet_lines(path: Path, sheet: str = "") -> Iterator[str]:
    """Yield the rows of a sheet as lines of CSV with commas.

    Parameters
    ----------
    path : of the workbook.
    sheet : its name; ``""`` for the only one.

    Raises
    ------
    FileError
        It is damaged, has no such sheet, or has several and none is named; it unpacks to more than the limit, or a row is too wide; or the package
        that reads it is missing.
    """
    try:
        from openpyxl import load_workbook
    except ModuleNotFoundError as error:
        raise FileError(f"{path}: a workbook; {what_is_missing(error)}, or save the sheet as CSV") from None
    try:
        with zipfile.ZipFile(path) as archive:
            WORKBOOK_BYTES.check(sum(member.file_size for member in archive.infolist()), str(path))
            if damaged := archive.testzip():  # it also has another length than it says
                raise FileError(f"{path}: damaged: the checksum of its part {damaged[:_SHOWN]!r} is wrong")
        with closing(load_workbook(path, read_only=True, data_only=True)) as book:
            yield from _lines(path, book, sheet)
    except FileError:
        raise
    except MemoryError:
        raise FileError(f"{path}: it does not fit into the memory of this machine; save the sheet as CSV") from None
    except Exception as error:  # a workbook of another program, or a damaged one, makes its reader raise exceptions of any kind
        why = shortened(" ".join(f"{type(error).__name__}: {error}".split()), _SHOWN)
        raise FileError(f"{path}: cannot be read as a workbook ({why}); open it and save the sheet as CSV") from None


def _lines(path: Path, book, sheet: str) -> Iterator[str]:
    names = [each.title for each in book.worksheets]
    if not sheet and len(names) > 1:
        raise FileError(f"{path}: it has the sheets {shortened(', '.join(names), _SHOWN)}; say which: sheet: NAME in the mapping, or --sheet")
    if sheet and sheet not in names:
        raise FileError(f"{path}: no sheet {sheet!r}{did_you_mean(sheet, names)}; it has {shortened(', '.join(names), _SHOWN)}")
    rows = book[sheet or names[0]]
    rows.reset_dimensions()  # those that it states may be wrong
    widest = 0
    for number, row in enumerate(rows.iter_rows(values_only=True), 1):
        TABLE_COLUMNS.check(len(row), f"{path}, row {number}")
        if number > _MOST_ROWS:
            raise FileError(f"{path}: row {number}: no sheet has more than {_MOST_ROWS:,} rows")
        line, widest = io.StringIO(), max(widest, len(row))
        csv.writer(line, lineterminator="\n").writerow([*map(_text, row), *[""] * (widest - len(row))])  # empty cells at the end are left out
        yield line.getvalue()


def _text(cell: object) -> str:
    """Return what a CSV table would have for the value of a cell."""
    if cell is None:
        return ""
    if hasattr(cell, "total_seconds"):  # a duration [s]
        return repr(cell.total_seconds())
    if hasattr(cell, "isoformat"):
        return cell.isoformat().removesuffix("T00:00:00")  # a sheet has no date without a time of day, which may stand in another column
    return " ".join(str(cell).split())
