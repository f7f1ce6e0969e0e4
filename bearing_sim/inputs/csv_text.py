# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The text of a measured table: encoding, comment lines, header, delimiter, decimal mark, units in headings.

Files of data loggers differ in all of these.  What a mapping does not say is found in the file, if the file can mean one thing only, and
otherwise asked for; what was found is kept as text, so that nobody has to guess what was guessed.
"""

import codecs
import csv
import io
import itertools
import math
import re
import tomllib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import NamedTuple, TextIO

from bearing_sim.files.labview_text import plain_lines
from bearing_sim.files.limits import TABLE_COLUMNS, TABLE_FILE, TABLE_LINE, TABLE_ROWS, FileError
from bearing_sim.files.reading import open_regular
from bearing_sim.inputs.workbook import sheet_lines
from bearing_sim.scene.errors import did_you_mean, shortened
from bearing_sim.scene.quantity import conversion, to_si

DELIMITERS = (",", ";", "\t", "|")
NAMES = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar"}
"""Words for delimiters, for messages."""

EXPECTED_ENCODINGS = ("utf-8", "utf-8-sig", "workbook")
"""Those that nobody needs to be told of."""

_WORKBOOK = b"PK\x03\x04"
_COMMENTS = ("#", "//")
_FIRST_LINES, _FIRST_CHARACTERS = 2000, 2_000_000  # of a file, in which header, delimiter and decimal mark are looked for
_LONGEST_HEADING = 300  # characters in which a unit is looked for
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff]")  # acts on a terminal, or ends a line of YAML
_SHOWN = 1000  # characters of a header in a message
_MARKS = ((codecs.BOM_UTF8, "utf-8-sig"), (codecs.BOM_UTF16_LE, "utf-16"), (codecs.BOM_UTF16_BE, "utf-16"))
_BINARY = {
    b"\xd0\xcf\x11\xe0": "a workbook of an old spreadsheet, or one with a password; save the sheet as CSV",
    b"PAR1": "Parquet; write its mapping by hand, since there is no text to guess it from",
}
_SPACES = " \N{NO-BREAK SPACE}\N{NARROW NO-BREAK SPACE}\N{THIN SPACE}\N{FIGURE SPACE}"
_SEPARATORS = {"": "", ".": ".", ",": ",", "apostrophe": "'\N{RIGHT SINGLE QUOTATION MARK}", "space": _SPACES}
"""The characters of each separator of thousands, by its name in a mapping."""
_MINUS = "\N{MINUS SIGN}"
_UNIT_LIKE = re.compile(r"(?=.*[^\W\d_]|.*[%°-])(?:\D*|[^\d:]*\d[^\d:]*)")
_WITH_UNIT = re.compile(r"[-+\N{MINUS SIGN}]?\d[\d.,' ]*\s?([^\W\d_]{1,5}(?:/[^\W\d_]{1,3})?|[%\N{PER MILLE SIGN}]|[°][CF])")
_HEADED = (re.compile(r"(.*?)\s*[\[(]\s*([^\])]*?)\s*[\])]\s*"), re.compile(r"(.+?)\s*/\s*([^/\s]+(?:/[^/\s]+)?)"))
HEADINGS = tomllib.loads(Path(__file__).with_name("headings.toml").read_text("utf-8"))
"""What people write in headings: what columns are, times, and units (see there)."""
QUANTITIES = HEADINGS["quantities"]
_SPELLED = {written: unit for unit, texts in HEADINGS["spelled"].items() for written in texts}
"""What people write in a heading, in the spelling of `bearing_sim.scene.quantity`."""

_PER_CENT, _PER_MILLE = r"%|per ?cent|pct|prozent", r"\N{PER MILLE SIGN}|per ?mille?|promille|permil"
_RELATIVE = re.compile(rf"(?:({_PER_CENT})|({_PER_MILLE}))\s*(?:(?:of|von)\s+)?(.*)", re.IGNORECASE)
_OF_SOMETHING = re.compile(rf".*(?:{_PER_CENT}|{_PER_MILLE})\s+(?:of|von)\b.*", re.IGNORECASE)
_ENDS_RELATIVE = re.compile(rf"(?:{_PER_CENT}|{_PER_MILLE})\W*", re.IGNORECASE)


TableError = FileError
"""A table that cannot be imported: a file that cannot be read, or that exceeds a limit."""


class Marks(NamedTuple):
    """How numbers are written.

    Attributes
    ----------
    decimal : mark before the decimals, ``.`` or ``,``.
    thousands : between groups of three digits: ``.``, ``,``, ``apostrophe``, ``space`` of any width, or ``""`` for nothing.
    """

    decimal: str = "."
    thousands: str = ""

    def plain(self, text: str) -> str:
        """Return a number as Python writes it; raise `ValueError` if its separators are not where these marks have them."""
        if text[:1] == _MINUS:
            text = f"-{text[1:]}"
        if self.thousands and any(separator in text for separator in _SEPARATORS[self.thousands]):
            if not _grouped(self).fullmatch(text):
                raise ValueError(text)
            for separator in _SEPARATORS[self.thousands]:
                text = text.replace(separator, "")
        if "_" in text or (self.decimal == "," and "." in text):  # float() accepts 1_000, and 1.000 where a comma is the mark
            raise ValueError(text)
        return text.replace(",", ".") if self.decimal == "," else text

    @property
    def described(self) -> list[str]:
        """What is not usual, in words."""
        words = {".": "dot", ",": "comma"}
        found = [f"decimal mark: {words[self.decimal]}"] if self.decimal == "," else []
        return found + ([f"separator of thousands: {words.get(self.thousands, self.thousands)}"] if self.thousands else [])


_READINGS = tuple(Marks(decimal, thousands) for thousands in _SEPARATORS for decimal in ".," if decimal != thousands)
"""All ways of writing numbers, the usual ones first."""


@cache
def _grouped(marks: Marks) -> re.Pattern:
    """Return the pattern of a number that is written in one way, whether it has separators or not."""
    separators, decimal = re.escape(_SEPARATORS[marks.thousands]), re.escape(marks.decimal)
    # by thousands, or as in India: 12,34,567
    whole = rf"(?:[1-9]\d{{0,2}}(?:[{separators}]\d{{3}})+|[1-9]\d?(?:[{separators}]\d{{2}})+[{separators}]\d{{3}}|\d+)" if separators else r"\d+"
    return re.compile(rf"[-+{_MINUS}]?(?:{whole}(?:{decimal}\d*)?|{decimal}\d+)(?:[eE][-+]?\d+)?")


@dataclass
class Layout:
    """How the text of a table is laid out.

    Attributes
    ----------
    path : of the file.
    encoding : of its text, as Python names it; ``workbook`` for a sheet of one, ``parquet``.
    sheet : of a workbook; empty for the only one.
    lines : its first lines, without their ends.
    delimiter : between cells.
    marks : how its numbers are written.
    names : headings in order, without blanks around them.
    header_line : line number of the header.
    is_comment : whether the header is in a comment line.
    units : second line of the header, with units and no numbers; empty if there is none.
    words : how many lines below the header have words and no numbers: units, and perhaps how values were sampled.
    cell_units : by heading, the unit that stands behind every number of the column, as it is written.
    comments : number of lines left out because they are comments, or stand before the header.
    found : what was found in the file and not given, in words.
    """

    path: Path
    encoding: str
    sheet: str = ""
    lines: list[str] = field(default_factory=list)
    delimiter: str = ","
    marks: Marks = Marks()
    names: tuple[str, ...] = ()
    header_line: int = 1
    is_comment: bool = False
    units: tuple[str, ...] = ()
    words: int = 0
    cell_units: dict[str, str] = field(default_factory=dict)
    comments: int = 0
    found: list[str] = field(default_factory=list)


def encoding_of(path: Path, given: str | None = None) -> str:
    """Return the encoding of a text file: that of its byte-order mark, UTF-8 if it is that, otherwise Windows' Latin-1; ``workbook`` for one.

    Raises
    ------
    TableError
        The file is missing, is no text, or cannot be read in the encoding given.
    """
    with open_regular(path, TABLE_FILE) as stream:
        begin = stream.read(4)
        if begin == _WORKBOOK:
            return "workbook"
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
            TABLE_ROWS.check(lines, str(path))
            if is_utf8:
                try:
                    decoder.decode(piece)
                except UnicodeDecodeError:
                    is_utf8 = False
    return "utf-8" if is_utf8 else "cp1252"


def table_lines(path: Path, encoding: str, sheet: str = "", errors: str = "strict") -> Iterator[str]:
    """Yield the lines of a text with their ends, those of a LabVIEW measurement file as a plain table, those of a sheet of a workbook as CSV.

    Raises
    ------
    TableError
        It cannot be opened, the encoding is unknown or not one of texts, or a line is longer than the limit.
    """
    if encoding == "workbook":
        yield from sheet_lines(path, sheet)
        return
    if sheet:
        raise TableError(f"{path}: sheet {sheet!r}: it is no workbook")
    try:
        found = codecs.lookup(encoding)
    except (LookupError, ValueError) as error:  # ValueError: a null character in the name
        raise TableError(f"{path}: encoding {encoding!r}: {error}") from None
    if not getattr(found, "_is_text_encoding", True):
        raise TableError(f"{path}: encoding {encoding!r}: no encoding of texts; expected such as utf-8 or latin-1")
    with open_regular(path, TABLE_FILE) as stream, io.TextIOWrapper(stream, encoding=encoding, errors=errors, newline="") as text:
        yield from plain_lines(_within_limit(text, path))


def _within_limit(text: TextIO, path: Path) -> Iterator[str]:
    longest, number = TABLE_LINE.value, 0
    while line := text.readline(longest + 1):
        number += 1
        if len(line) > longest:
            raise TableError(f"{path}, line {number}: {TABLE_LINE.refusal()}")
        yield line


def first_look(path: Path, encoding: str | None = None, sheet: str = "") -> Layout:
    """Return a layout with the encoding, which may be given, and the first lines of a file; errors as of `encoding_of` and `table_lines`."""
    layout, length = Layout(path, encoding_of(path, encoding), sheet), 0
    try:
        for line in table_lines(path, layout.encoding, sheet, errors="replace"):
            layout.lines.append(line.rstrip("\r\n"))
            length += len(line)
            if len(layout.lines) == _FIRST_LINES or length > _FIRST_CHARACTERS:
                break
    except (LookupError, UnicodeError) as error:
        raise TableError(f"{path}: encoding {layout.encoding!r}: {error}") from None
    return layout


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


def find_header(layout: Layout, wanted: Sequence[tuple[str, str]], delimiter: str | None = None, begin: int = 1) -> None:
    """Enter where the header is, and its delimiter, into a layout: the first line that has all columns wanted.

    Parameters
    ----------
    layout : is completed.
    wanted : (place in the mapping, name) of each column.
    delimiter : of the mapping; None to find it.
    begin : number of the first line that may be the header.

    Raises
    ------
    TableError
        No line has all columns; the message takes the one with most of them for the header, and names all columns that it lacks.
    """
    names = {name for _, name in wanted}
    best, most = (1, []), (-1, False, 0)
    for number, line in enumerate(layout.lines[begin - 1 :], begin):
        if not line.strip():
            continue
        commented = is_comment(line)
        for candidate in DELIMITERS if delimiter is None else (delimiter,):
            cells = cells_of(uncommented(line) if commented else line, candidate)
            known = len(names.intersection(cells))
            if known == len(names):
                _enter_header(wanted, layout, candidate, cells, number, commented, delimiter is None)
                layout.units = lines_below(layout)
                return
            likeness = (known, not commented, min(len(cells), 2))
            if likeness > most:
                best, most = (number, cells), likeness
    number, cells = best
    errors = [f"{where}: no column {name!r}{did_you_mean(name, cells)}" for where, name in wanted if name not in cells]
    shown = f"the header has {_shown(cells)}"
    if len(cells) == 1:
        shown += f", one column only (delimiter: expected {', '.join(NAMES[each] for each in DELIMITERS)}, or what the mapping says)"
    raise TableError("\n".join([f"{layout.path}, line {number}: {shown}", *(f"  {error}" for error in errors)]))


def _shown(cells: Sequence[str]) -> str:
    """Return headings for a message: what would act on a terminal is escaped, and the middle of many left out."""
    texts = [cell if cell.isprintable() else repr(cell) for cell in cells]
    return shortened(", ".join(texts), _SHOWN) or "nothing"


def _enter_header(wanted, layout, delimiter, cells, number, commented, was_searched) -> None:
    errors = [f"  {where}: {cells.count(name)} columns are called {name!r}" for where, name in wanted if cells.count(name) > 1]
    if errors:
        raise TableError("\n".join([f"{layout.path}, line {number}: the header has {_shown(cells)}", *errors]))
    TABLE_COLUMNS.check(len(cells), f"{layout.path}, line {number}")
    if odd := next((cell for cell in cells if _CONTROL.search(cell)), None):
        raise TableError(f"{layout.path}, line {number}: the heading {odd[:_SHOWN]!r} has control characters; expected text")
    layout.delimiter, layout.names, layout.header_line, layout.is_comment = delimiter, tuple(cells), number, commented
    if was_searched and delimiter != ",":
        layout.found.append(f"delimiter: {NAMES[delimiter]}")
    if number > 1 or commented:
        layout.found.append(f"header in line {number}" + ", a comment" * commented)


def lines_below(layout: Layout) -> tuple[str, ...]:
    """Return the units below the header: cells that are words with at most one digit, as in 1/min; empty if the line holds data.

    One more such line, as loggers write it (``Smp``, ``Avg``), is counted in the layout; so are units that stand in the cells themselves.
    """
    lines = (each for each in layout.lines[layout.header_line :] if each.strip() and not is_comment(each))
    below = [cells_of(each, layout.delimiter) for each in itertools.islice(lines, 2)]
    words = list(itertools.takewhile(lambda cells: sum(map(bool, cells)) >= 2 and all(_UNIT_LIKE.fullmatch(cell) for cell in cells if cell), below))
    layout.words = len(words)
    layout.found += [f"second line of the header: {_shown(words[0])}"] if words else []
    layout.found += [f"third line of the header: {_shown(words[1])}; it is not used"] if words[1:] else []
    texts: dict[str, list[str]] = {}
    for _, name, text in cells_in(layout, [name for name in dict.fromkeys(layout.names) if name]):
        texts.setdefault(name, []).append(text)
    for name, column in texts.items():
        behind = {found[1] if (found := _WITH_UNIT.fullmatch(text)) else "" for text in column[layout.words :] if text}
        if len(behind) == 1 and any(behind):
            layout.cell_units[name] = behind.pop()
    return tuple(words[0]) if words else ()


def cells_in(layout: Layout, columns: Sequence[str]) -> Iterator[tuple[int, str, str]]:
    """Yield (line number, heading, text without its unit) of the cells of some columns in the first lines of a file."""
    places = [(layout.names.index(name), name, layout.cell_units.get(name, "")) for name in columns]
    for number, line in enumerate(layout.lines[layout.header_line :], layout.header_line + 1):
        if is_comment(line):
            continue
        cells = cells_of(line, layout.delimiter)
        yield from ((number, name, cells[place].removesuffix(unit).rstrip()) for place, name, unit in places if place < len(cells))


def number_marks(cells: Iterable[tuple[int, str, str]], delimiter: str = "", decimal: str | None = None, thousands: str | None = None) -> Marks:
    """Return how the numbers in cells are written, by all of them together; as Python writes them where nothing says otherwise.

    Parameters
    ----------
    cells : (line number, heading, text).
    delimiter : between cells.
    decimal, thousands : where somebody has decided.

    Raises
    ------
    TableError
        No way of writing numbers fits all of them, or several do and give other values.  The message names line and column and asks for ``decimal``.
    """
    readings = [marks for marks in _READINGS if decimal in (None, marks.decimal) and thousands in (None, marks.thousands)]
    if not readings:
        raise TableError(f"decimal and thousands are both {decimal!r}; expected two different marks")
    if decimal is not None and thousands is not None:
        return readings[0]
    ask = "say which is the decimal mark: decimal: ',' or '.' in the mapping, or --decimal"
    fitting, told, first = readings, [], None
    for line, name, text in cells:
        text = text.strip()
        if text.isdigit():
            told.append((line, name, text))
            continue
        fits = [marks for marks in _READINGS if _grouped(marks).fullmatch(text)]
        if not fits:
            continue  # no number
        told.append((line, name, text))
        left = [marks for marks in fitting if marks in fits]
        if not left and decimal is not None:
            return Marks(decimal)  # each cell that does not fit is refused by itself
        if not left:
            raise TableError(f"line {line}: {name} = {text!r} is not written as {first[1]} = {first[2]!r} in line {first[0]}; {ask}")
        first = (line, name, text) if first is None or len(left) < len(fitting) else first
        fitting = left
    if delimiter == "," and not any("," in text for _, _, text in told):
        fitting = [marks for marks in fitting if marks.decimal == "."] or fitting
    for line, name, text in told if len(fitting) > 1 else ():
        values = sorted({float(marks.plain(text)) for marks in fitting})
        if len(values) > 1:
            raise TableError(f"line {line}: {name} = {text!r} is {values[0]:.10g} or, with a separator of thousands, {values[-1]:.10g}; {ask}")
    return fitting[0]


def records(layout: Layout) -> Iterator[tuple[int, list[str]]]:
    """Yield (number of the line that a row begins on, cells) below the header; comment lines are left out and counted in the layout.

    Cells that are empty at the end of a row, beyond the header, are dropped, and one that only lacks cells of columns without a heading is
    completed: loggers end lines with a delimiter, or do not.

    Raises
    ------
    TableError
        A quotation mark is out of place, a byte has no meaning in the encoding, or there are more or longer rows than the limits allow.
    """
    path, width, lines, most_rows = layout.path, len(layout.names), _Lines(layout), TABLE_ROWS.value
    named = max((k for k, name in enumerate(layout.names) if name), default=-1) + 1
    rows = csv.reader(lines, delimiter=layout.delimiter, strict=True)
    skipped = 0
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
        if skipped < layout.words and cells:
            skipped += 1
            continue
        while len(cells) > width and not cells[-1].strip():
            cells.pop()
        if lines.began - layout.header_line > most_rows:
            TABLE_ROWS.check(lines.began - layout.header_line, str(path))
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
        self._lines = enumerate(table_lines(layout.path, layout.encoding, layout.sheet), 1)
        self.at_start, self.began, self.number = True, 0, 0
        self._length = 0  # of the row so far

    def __iter__(self):
        return self

    def __next__(self) -> str:
        for number, line in self._lines:
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
                TABLE_LINE.check(self._length, f"the row that begins in line {self.began}")
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


def is_relative(text: str) -> bool:
    """Return whether a unit is per cent or per mille of something, named or not, or a heading ends in one."""
    last = re.split(r"[\s_.(\[]", text.strip().rstrip(")] "))[-1]
    return _RELATIVE.match(text.strip()) is not None or _OF_SOMETHING.fullmatch(text) is not None or _ENDS_RELATIVE.fullmatch(last) is not None


def percentage_question(unit: str, si_unit: str) -> str:
    """Return what to say instead of a unit that is a percentage of nothing that is named."""
    found, quantity = _RELATIVE.match(unit.strip()), QUANTITIES[si_unit]
    return f"the {quantity['name']} at 100 %, such as '{'%' if found is None or found[1] else chr(0x2030)} of {quantity['full_scale']}'"


def may_be_relative(si_unit: str) -> bool:
    """Return whether something in a unit may be a percentage; a temperature is none."""
    return "full_scale" in QUANTITIES.get(si_unit, ())


def unit_line(unit: str, si_unit: str) -> tuple[float, float]:
    """Return scale and offset of a unit: value in SI = scale x number + offset.

    Parameters
    ----------
    unit : such as ``rpm``, or a percentage of a quantity, ``% of 1500 rpm``.
    si_unit : that it converts to.

    Raises
    ------
    ValueError
        It is no unit of that quantity, or a percentage of nothing that is named.
    """
    found = _RELATIVE.fullmatch(unit.strip())
    if found is None:
        return conversion(spelled(unit), si_unit)
    if not may_be_relative(si_unit):
        raise ValueError(f"unit = {unit!r}: expected a unit of this quantity, which is no percentage")
    try:
        reference = to_si(found[3], si_unit)
    except ValueError:
        reference = math.nan
    if not 0.0 < reference < math.inf:
        raise ValueError(f"unit = {unit!r}: of what? Expected {percentage_question(unit, si_unit)}")
    return (0.01 if found[1] else 0.001) * reference, 0.0


def is_unit_of(unit: str, si_unit: str) -> bool:
    """Return whether a text is a unit that converts to an SI unit."""
    if not unit or re.match(r"[-+.]?\d", unit) and not re.match(r"1/", unit):
        return False
    try:
        return all(map(math.isfinite, unit_line(unit, si_unit)))
    except ValueError:
        return False
