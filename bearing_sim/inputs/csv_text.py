# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The text of a measured table: encoding, comment lines, header, delimiter, decimal mark, units in headings.

Files of data loggers differ in all of these.  What a mapping does not say is found in the file, if the file can mean one thing only, and
otherwise asked for; what was found is kept as text, so that nobody has to guess what was guessed.
"""

import codecs
import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, TextIO

from bearing_sim.files.limits import TABLE_COLUMNS, TABLE_FILE, TABLE_LINE, TABLE_ROWS, FileError, Limit, LimitError
from bearing_sim.files.reading import open_regular
from bearing_sim.scene.errors import did_you_mean, shortened
from bearing_sim.scene.quantity import conversion

DELIMITERS = (",", ";", "\t", "|")
NAMES = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar"}
"""Words for delimiters, for messages."""

_COMMENTS = ("#", "//")
_FIRST_LINES, _FIRST_CHARACTERS = 2000, 2_000_000  # of a file, in which header, delimiter and decimal mark are looked for
_LONGEST_HEADING = 300  # characters in which a unit is looked for
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")  # acts on a terminal, or ends a line of YAML
_SHOWN = 1000  # characters of a header in a message
_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
_BINARY = {
    b"PK\x03\x04": "a workbook of a spreadsheet or another archive; save the sheet as CSV",
    b"PAR1": "Parquet; write its mapping by hand, since there is no text to guess it from",
}
_NUMBER = re.compile(r"[-+]?(?:\d+(?:[.,]\d*)?|[.,]\d+|\d{1,3}(?:[.,]\d{3})+(?:[.,]\d*)?)(?:[eE][-+]?\d+)?")  # no date, such as 1.2.2026
_LIKE_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")
_UNIT_LIKE = re.compile(r"(?=.*[^\W\d_]|.*[%°-])(?:\D*|[^\d:]*\d[^\d:]*)")
_HEADED = (re.compile(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*"), re.compile(r"(.+?)\s*/\s*([^/\s]+(?:/[^/\s]+)?)"))
_SPELLED = {
    **dict.fromkeys(("°C", "℃", "C", "deg C", "Grad C", "Celsius", "deg_C", "degc", "DegC", "grdC"), "degC"),
    **dict.fromkeys(("°F", "℉", "F", "deg F"), "degF"),
    **dict.fromkeys(("RPM", "Rpm", "U/min", "U/Min", "Umdr./min", "min-1", "1/min", "r/min", "rev/min"), "rpm"),
    **dict.fromkeys(("Nm", "N m", "N·m", "N.m"), "N*m"),
    **dict.fromkeys(("kNm", "kN m", "kN·m", "kN.m"), "kN*m"),
    **dict.fromkeys(("m/s²", "m/s2"), "m/s^2"),
    **dict.fromkeys(("sec", "seconds", "Sek", "Sekunden", "Sec"), "s"),
    **dict.fromkeys(("msec", "millis"), "ms"),
    **dict.fromkeys(("KN",), "kN"),
    **dict.fromkeys(("KW", "Kw"), "kW"),
}
"""What people write in a heading, in the spelling of `bearing_sim.scene.quantity`."""


class TableError(ValueError):
    """A table that cannot be imported."""


@dataclass
class Layout:
    """How the text of a table is laid out.

    Attributes
    ----------
    encoding : of the file, as Python names it.
    delimiter : between cells.
    decimal : mark of numbers, ``.`` or ``,``.
    names : headings in order, without blanks around them.
    header_line : line number of the header.
    is_comment : whether the header is in a comment line.
    units : second line of the header, with units and no numbers; empty if there is none.
    comments : number of lines left out because they are comments, or stand before the header.
    found : what was found in the file and not given, in words.
    """

    encoding: str
    delimiter: str = ","
    decimal: str = "."
    names: tuple[str, ...] = ()
    header_line: int = 1
    is_comment: bool = False
    units: tuple[str, ...] = ()
    comments: int = 0
    found: list[str] = field(default_factory=list)


def encoding_of(path: Path, given: str | None = None) -> str:
    """Return the encoding of a text file: that of its byte-order mark, UTF-8 if it is that, otherwise Windows' Latin-1.

    Raises
    ------
    TableError
        The file is missing, is no text, or cannot be read in the encoding given.
    """
    with opened(path) as stream:
        begin = stream.read(4)
        for magic, what in _BINARY.items():
            if begin.startswith(magic):
                raise TableError(f"{path}: no CSV table but {what}")
        marked = next((name for mark, name in _MARKS if begin.startswith(mark)), None)
        if given is not None:
            return given
        if marked is not None:
            return marked
        stream.seek(0)
        decoder = codecs.getincrementaldecoder("utf-8")()
        is_utf8, lines = True, 0
        while piece := stream.read(1 << 20):
            if b"\0" in piece:
                raise TableError(f"{path}: no text, it has bytes of zero; expected a CSV table")
            lines += piece.count(b"\n")
            within(TABLE_ROWS, lines, path)
            if is_utf8:
                try:
                    decoder.decode(piece)
                except UnicodeDecodeError:
                    is_utf8 = False
    return "utf-8" if is_utf8 else "cp1252"


def opened(path: Path) -> BinaryIO:
    """Return a table's file, opened for reading bytes.

    Raises
    ------
    TableError
        It cannot be opened, or is too large.
    """
    try:
        return open_regular(path, TABLE_FILE)
    except FileError as error:
        raise TableError(str(error)) from None


def within(limit: Limit, found: int, where: str | Path) -> None:
    """Raise `TableError` if what was found exceeds a limit; ``where`` opens the message."""
    try:
        limit.check(found, str(where))
    except LimitError as error:
        raise TableError(str(error)) from None


@contextmanager
def opened_text(path: Path, encoding: str, errors: str = "strict") -> Iterator[TextIO]:
    """Open a table's file for reading text, with its line ends as they are.

    Raises
    ------
    TableError
        It cannot be opened, or the encoding is unknown or not one of texts.
    """
    try:
        found = codecs.lookup(encoding)
    except (LookupError, ValueError) as error:  # ValueError: a null character in the name
        raise TableError(f"{path}: encoding {encoding!r}: {error}") from None
    if not getattr(found, "_is_text_encoding", True):
        raise TableError(f"{path}: encoding {encoding!r}: no encoding of texts; expected such as utf-8 or latin-1")
    with opened(path) as stream, io.TextIOWrapper(stream, encoding=encoding, errors=errors, newline="") as text:
        yield text


def lines_of(stream: TextIO, path: Path) -> Iterator[str]:
    """Yield the lines of a text with their ends.

    Raises
    ------
    TableError
        A line is longer than the limit.
    """
    number, longest = 0, TABLE_LINE.value
    while line := stream.readline(longest + 1):
        number += 1
        if len(line) > longest:
            raise TableError(f"{path}, line {number}: {TABLE_LINE.refusal()}")
        yield line


def first_lines(path: Path, encoding: str) -> list[str]:
    """Return the first lines of a file, without their ends."""
    found: list[str] = []
    length = 0
    try:
        with opened_text(path, encoding, errors="replace") as stream:
            for line in lines_of(stream, path):
                found.append(line.rstrip("\r\n"))
                length += len(line)
                if len(found) == _FIRST_LINES or length > _FIRST_CHARACTERS:
                    break
    except (LookupError, UnicodeError) as error:
        raise TableError(f"{path}: encoding {encoding!r}: {error}") from None
    return found


def is_comment(line: str) -> bool:
    """Return whether a line is a comment."""
    return line.lstrip().startswith(_COMMENTS)


def uncommented(line: str) -> str:
    """Return a comment line without what makes it one."""
    return line.lstrip().lstrip("#/").strip(" ")


def cells_of(line: str, delimiter: str) -> list[str]:
    """Return the cells of a single line; one with an open quotation mark as far as it goes."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter), [])]
    except csv.Error:
        return [cell.strip() for cell in line.split(delimiter)]


def find_header(path: Path, lines: Sequence[str], wanted: Sequence[tuple[str, str]], delimiter: str | None, layout: Layout) -> None:
    """Enter where the header is, and its delimiter, into a layout: the first line that has all columns wanted.

    Parameters
    ----------
    path, lines : of the file.
    wanted : (place in the mapping, name) of each column.
    delimiter : of the mapping; None to find it.
    layout : is completed.

    Raises
    ------
    TableError
        No line has all columns; the message takes the one with most of them for the header, and names all columns that it lacks.
    """
    names = {name for _, name in wanted}
    best, most = (1, []), (-1, False, 0)
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        commented = is_comment(line)
        for candidate in DELIMITERS if delimiter is None else (delimiter,):
            cells = cells_of(uncommented(line) if commented else line, candidate)
            known = len(names.intersection(cells))
            if known == len(names):
                _enter_header(path, wanted, layout, candidate, cells, number, commented, delimiter is None)
                layout.units = _second_line(lines[number:], layout)
                return
            likeness = (known, not commented, min(len(cells), 2))
            if likeness > most:
                best, most = (number, cells), likeness
    number, cells = best
    errors = [f"{where}: no column {name!r}{did_you_mean(name, cells)}" for where, name in wanted if name not in cells]
    shown = f"the header has {_shown(cells)}"
    if len(cells) == 1:
        shown += f", one column only (delimiter: expected {', '.join(NAMES[each] for each in DELIMITERS)}, or what the mapping says)"
    raise TableError("\n".join([f"{path}, line {number}: {shown}", *(f"  {error}" for error in errors)]))


def _shown(cells: Sequence[str]) -> str:
    """Return headings for a message: what would act on a terminal is escaped, and the middle of many left out."""
    texts = [cell if cell.isprintable() else repr(cell) for cell in cells]
    return shortened(", ".join(texts), _SHOWN) or "nothing"


def _enter_header(path, wanted, layout, delimiter, cells, number, commented, was_searched) -> None:
    errors = [f"  {where}: {cells.count(name)} columns are called {name!r}" for where, name in wanted if cells.count(name) > 1]
    if errors:
        raise TableError("\n".join([f"{path}, line {number}: the header has {_shown(cells)}", *errors]))
    within(TABLE_COLUMNS, len(cells), f"{path}, line {number}")
    if odd := next((cell for cell in cells if _CONTROL.search(cell)), None):
        raise TableError(f"{path}, line {number}: the heading {odd[:_SHOWN]!r} has control characters; expected text")
    layout.delimiter, layout.names, layout.header_line, layout.is_comment = delimiter, tuple(cells), number, commented
    if was_searched and delimiter != ",":
        layout.found.append(f"delimiter: {NAMES[delimiter]}")
    if number > 1 or commented:
        layout.found.append(f"header in line {number}" + ", a comment" * commented)


def _second_line(lines: Sequence[str], layout: Layout) -> tuple[str, ...]:
    """Return the units below the header: cells that are words with at most one digit, as in 1/min; empty if the line holds data."""
    line = next((each for each in lines if each.strip() and not is_comment(each)), "")
    cells = cells_of(line, layout.delimiter)
    filled = [cell for cell in cells if cell]
    if len(filled) < 2 or not all(_UNIT_LIKE.fullmatch(cell) for cell in filled):
        return ()
    layout.found.append(f"second line of the header: {_shown(cells)}")
    return tuple(cells)


def cells_in(lines: Sequence[str], layout: Layout, columns: Sequence[str]) -> Iterator[tuple[int, str, str]]:
    """Yield (line number, heading, text) of the cells of some columns in the first lines of a file."""
    places = [(layout.names.index(name), name) for name in columns]
    for number, line in enumerate(lines[layout.header_line :], layout.header_line + 1):
        if is_comment(line):
            continue
        cells = cells_of(line, layout.delimiter)
        yield from ((number, name, cells[place]) for place, name in places if place < len(cells))


def decimal_mark(cells: Iterable[tuple[int, str, str]]) -> str:
    """Return the decimal mark of number cells, ``.`` where none has any.

    Parameters
    ----------
    cells : (line number, heading, text).

    Raises
    ------
    TableError
        Both marks occur, or all commas may as well separate thousands.  The message names line and column and asks for ``decimal``.
    """
    comma = point = thousands = None
    for line, name, text in cells:
        text = text.strip()
        if not _NUMBER.fullmatch(text):
            continue
        if "," in text and "." in text:
            return "," if text.rindex(",") > text.rindex(".") else "."
        if "," in text:
            place = (line, name, text)
            if _LIKE_THOUSANDS.fullmatch(text):
                thousands = thousands or place
            else:
                comma = comma or place
        elif "." in text:
            point = point or (line, name, text)
    comma_like, ask = comma or thousands, "say which is the decimal mark: decimal: ',' or '.' in the mapping, or --decimal"
    if comma_like and point:
        cells = f"{comma_like[1]} = {comma_like[2]!r} has a comma, {point[1]} = {point[2]!r} in line {point[0]} a point"
        raise TableError(f"line {comma_like[0]}: {cells}; {ask}")
    if thousands and not comma:
        raise TableError(f"line {thousands[0]}: {thousands[1]} = {thousands[2]!r} has a decimal comma or a separator of thousands; {ask}")
    return "," if comma else "."


def records(path: Path, layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """Yield (number of the line that a row begins on, cells) below the header; comment lines are left out and counted in the layout.

    Cells that are empty at the end of a row, beyond the header, are dropped, and one that only lacks cells of columns without a heading is
    completed: loggers end lines with a delimiter, or do not.

    Raises
    ------
    TableError
        A quotation mark is out of place, a byte has no meaning in the encoding, or there are more or longer rows than the limits allow.
    """
    width, lines, most_rows = len(layout.names), _Lines(layout), TABLE_ROWS.value
    named = max((k for k, name in enumerate(layout.names) if name), default=-1) + 1
    with opened_text(path, layout.encoding) as stream:
        lines.stream = enumerate(lines_of(stream, path), 1)
        rows = csv.reader(lines, delimiter=layout.delimiter, strict=True)
        skipped_units = not layout.units
        while True:
            lines.at_start = True
            try:
                cells = next(rows)
            except StopIteration:
                return
            except csv.Error as error:
                if "unexpected end" in str(error):
                    raise TableError(f"{path}, line {lines.began}: a quotation mark is opened and not closed") from None
                raise TableError(f"{path}, line {lines.number}: {error}") from None
            except UnicodeDecodeError as error:
                raise TableError(f"{path}: not readable as {layout.encoding} text ({error.reason}); say which encoding it has") from None
            if not skipped_units and cells:
                skipped_units = True
                continue
            while len(cells) > width and not cells[-1].strip():
                cells.pop()
            if lines.began - layout.header_line > most_rows:
                within(TABLE_ROWS, lines.began - layout.header_line, path)
            if named <= len(cells) < width:
                cells += [""] * (width - len(cells))
            yield lines.began, cells


class _Lines:
    """The lines below a header, without comments between rows; inside of quotation marks nothing is a comment.

    Attributes
    ----------
    at_start : whether the next line begins a row.
    began : line number at which the last row began.
    number : of the last line.

    Raises
    ------
    TableError
        A row that goes on over many lines, within quotation marks, has more characters than a line may have.
    """

    def __init__(self, layout: Layout):
        self._layout = layout
        self.stream: Iterator[tuple[int, str]] = iter(())
        self.at_start, self.began, self.number = True, 0, 0
        self._length = 0  # of the row so far

    def __iter__(self):
        return self

    def __next__(self) -> str:
        for number, line in self.stream:
            self.number = number
            if number <= self._layout.header_line:
                continue
            if self.at_start:
                if is_comment(line):
                    self._layout.comments += 1
                    continue
                self.at_start, self.began, self._length = False, number, 0
            self._length += len(line)
            if self._length > len(line):
                within(TABLE_LINE, self._length, f"the row that begins in line {self.began}")
            return line
        raise StopIteration


def unit_in(heading: str) -> tuple[str, str]:
    """Return what a heading names and the text of its unit: ``Speed [rpm]``, ``Load (kN)``, ``T_oil/°C``; the unit is empty if there is none."""
    for pattern in _HEADED if len(heading) <= _LONGEST_HEADING else ():
        found = pattern.fullmatch(heading.strip())
        if found is not None and found[1]:
            return found[1], found[2]
    return heading.strip(), ""


def spelled(unit: str) -> str:
    """Return a unit as the scene files spell it: ``°C`` is ``degC``, ``U/min`` is ``rpm``."""
    unit = " ".join(unit.replace("\N{GREEK SMALL LETTER MU}", "u").replace("\N{MICRO SIGN}", "u").split())
    return _SPELLED.get(unit, unit)


def is_unit_of(unit: str, si_unit: str) -> bool:
    """Return whether a text is a unit that converts to an SI unit."""
    if not unit or re.match(r"[-+.]?\d", unit) and not re.match(r"1/", unit):
        return False
    try:
        return all(map(math.isfinite, conversion(unit, si_unit)))
    except ValueError:
        return False
