# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Guess the mapping of a measured table from its headings and cells, with the reason of each guess and what was not understood.

A guess is a proposal for somebody to read, never an import: it writes a mapping file.  What may mean two things is not decided here but
asked for, with the option that decides.
"""

import datetime
import re
from collections.abc import Iterable, Sequence
from collections.abc import Mapping as AnyMapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import yaml
from pydantic import TypeAdapter

from bearing_sim.files.labview_text import start_of
from bearing_sim.inputs.csv_import import TimeColumn, time_reader
from bearing_sim.inputs.csv_text import (
    DELIMITERS,
    EXPECTED_ENCODINGS,
    HEADINGS,
    NAMES,
    QUANTITIES,
    Layout,
    Marks,
    TableError,
    cells_in,
    cells_of,
    find_header,
    first_look,
    is_comment,
    is_relative,
    is_unit_of,
    may_be_relative,
    number_marks,
    percentage_question,
    records,
    spelled,
    uncommented,
    unit_in,
)
from bearing_sim.scene.errors import did_you_mean, shortened

Cells = AnyMapping[str, Sequence[str]]
"""The first cells of a table, by heading."""


class Role(NamedTuple):
    """What a column may be: the field of a mapping, its SI unit, the words in a heading that say so, and those that say otherwise."""

    field: str
    si_unit: str
    words: str
    not_words: str = ""


ROLES = tuple(Role(**role) for role in HEADINGS["roles"])
_TIME_WORDS = re.compile(HEADINGS["time"]["words"], re.IGNORECASE)
_DATES, _CLOCKS = HEADINGS["time"]["dates"], HEADINGS["time"]["clocks"]
_SUFFIX = re.compile(r"(.+?)[ _.]+(?:in[ _]+)?([A-Za-z°%µ/0-9^-]+)$")
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_EPOCHS = ((1e8, 4e9, "s"), (1e11, 4e12, "ms"), (1e14, 4e15, "us"), (1e17, 4e18, "ns"))
"""Numbers that count from 1970, 1973 to 2096, by unit."""

_SPREADSHEET_DAYS = (30_000.0, 60_000.0)  # of dates from 1982 to 2064, counted from 1899-12-30
_SPREADSHEET_STEP = 0.01  # between rows: 14 minutes; that seconds of the same size stand so close is an assumption against them
_DAYS = ("day", "days", "d")
_ROWS_TRIED = 3  # for the formats that times may have
_CELLS_LOOKED_AT = 500
_LONGEST_LIST = 10_000  # characters of headings
_LONGEST_LABEL, _LONGEST_HEADING = 100, 300  # characters
_MOST_LABELS = 50  # different texts in a column that tells machines apart


@dataclass
class Guess:
    """A proposal for a mapping.

    Attributes
    ----------
    tree : the mapping; fields that were not understood are missing.
    layout : how the text is laid out.
    reasons : by field, why.
    questions : what has to be decided, with the option that decides; by field.
    left : headings of columns that are not used.
    """

    tree: dict
    layout: Layout
    reasons: dict[str, str] = field(default_factory=dict)
    questions: dict[str, str] = field(default_factory=dict)
    left: list[str] = field(default_factory=list)

    @property
    def text(self) -> str:
        """The mapping as YAML, with the reason of each guess beside it, and the questions as comments."""
        lines = [f"# Guessed by `bearing-sim import-csv --guess` from the headings of {self.tree['source']}. Check every line."]
        for name, value in self.tree.items():
            reason = f"  # {self.reasons[name]}" if name in self.reasons else ""
            dumped = yaml.safe_dump(value, default_flow_style=True, sort_keys=False, allow_unicode=True, width=1000)
            lines.append(f"{name}: {dumped.strip().removesuffix('...').strip()}{reason}")
        lines += [f"# {name}: TO DECIDE: {question}" for name, question in self.questions.items()]
        if self.left:
            lines.append(f"# columns that are not used: {shortened(', '.join(self.left), _LONGEST_LIST)}")
        return "\n".join(lines) + "\n"

    def enter(self, name: str, value: object, reason: str) -> None:
        """Enter a field of the mapping."""
        self.tree[name], self.reasons[name] = value, reason


class _Asked(Exception):
    """What has to be decided, with the option that decides."""


def guess(
    path: Path,
    columns: AnyMapping[str, str] | None = None,
    units: AnyMapping[str, str] | None = None,
    constants: AnyMapping[str, dict] | None = None,
    delimiter: str | None = None,
    decimal: str | None = None,
    time_format: str | None = None,
    only: AnyMapping[str, str] | None = None,
    sheet: str = "",
) -> Guess:
    """Return a proposal for the mapping of a table.

    Parameters
    ----------
    path : of the table.
    columns : by field, the heading of its column, where somebody has decided.
    units : by field, the unit of its column, likewise; of the time ``s``, ``ms`` and so on.
    constants : by field, what stands in the mapping instead of a column.
    delimiter, decimal : likewise.
    time_format : ``iso`` or a format of strptime, likewise.
    only : by heading, the text that its cells must have; other rows are left out.
    sheet : of a workbook.

    Raises
    ------
    TableError
        The file is no table, or a heading that was given is not in it.
    """
    columns, units, constants = dict(columns or {}), dict(units or {}), dict(constants or {})
    layout = first_look(path, sheet=sheet)
    _find_any_header(layout, delimiter)
    asked = [(f"--column {name}={heading}", heading) for name, heading in columns.items()]
    for option, heading in (*asked, *((f"--only {heading}", heading) for heading in only or {})):
        if heading not in layout.names:
            raise TableError(f"{path}, line {layout.header_line}: {option}: no such heading{did_you_mean(heading, layout.names)}")
    found = Guess({"name": re.sub(r"\W+", "_", path.stem).strip("_") or "table", "source": path.name}, layout)
    layout.marks = _marks(layout, found, decimal)
    if layout.delimiter != ",":
        known = NAMES.get(layout.delimiter, layout.delimiter)
        found.enter("delimiter", "tab" if layout.delimiter == "\t" else layout.delimiter, f"{known}, by the header")
    if layout.marks.decimal == "," or layout.marks.thousands:
        found.enter("decimal", layout.marks.decimal, "given" if decimal else "by the cells")
    if layout.marks.thousands:
        found.enter("thousands", layout.marks.thousands, "by the cells: all of a column have it")
    if layout.encoding not in EXPECTED_ENCODINGS:
        found.enter("encoding", layout.encoding, "the file is not UTF-8")
    if sheet:
        found.enter("sheet", sheet, "given")
    if only:
        found.enter("only", dict(only), "given")
    used = _guess_time(found, columns.pop("time", None), units.pop("time", None), time_format)
    named: dict[str, list[str]] = {}
    for heading in layout.names:
        if heading and heading not in used and (role := _role_of(heading, layout, columns)) is not None:
            named.setdefault(role.field, []).append(heading)
    _guess_channels(found, named, columns, units, constants)
    if "time" in found.tree and not only:
        _ask_for_rows(found)
    taken = used | {column for column in _headings_in(found.tree)}
    found.left = [heading for heading in layout.names if heading and heading not in taken]
    return found


def headed_columns(path: Path, known: Sequence[str], roles: Sequence[Role]) -> tuple[Layout, list[tuple[str, str]]]:
    """Return how a table is laid out, and what each of its columns is by its heading: (field, unit), the field empty where the heading says nothing.

    Parameters
    ----------
    path : of a table, CSV with any delimiter, decimal mark and encoding.
    known : fields that a heading may name itself, such as ``radial_load``.
    roles : what other headings may say, the first that fits counts.

    Raises
    ------
    TableError
        The file is no table, or its numbers may mean two things.
    """
    layout = first_look(path)
    _find_any_header(layout)
    try:
        layout.marks = number_marks(cells_in(layout, [name for name in dict.fromkeys(layout.names) if name]), layout.delimiter)
    except TableError as error:
        raise TableError(f"{path}, {str(error).partition('; say which')[0]}; write numbers without separators of thousands") from None
    columns = []
    for heading in layout.names:
        name, unit = _heading_unit(heading, layout)
        name = name if name in known else heading if heading in known else ""
        role = None if name else _role_of(heading, layout, {}, roles)
        unit = unit if name != heading and (name or role) else ""
        columns.append((role.field if role else name, spelled(unit)))
    return layout, columns


def _headings_in(tree) -> list[str]:
    """Return the headings that a mapping's tree uses."""
    if isinstance(tree, dict):
        own = [tree[name] for name in ("column", "time_of_day") if name in tree]
        return own + [each for value in tree.values() for each in _headings_in(value)]
    return [each for value in tree for each in _headings_in(value)] if isinstance(tree, list) else []


def _find_any_header(layout: Layout, delimiter: str | None = None) -> None:
    """Enter the header into a layout: the first line with as many cells as most lines, and without numbers."""
    path, lines, best = layout.path, layout.lines, (0, ",")
    for candidate in DELIMITERS if delimiter is None else ("\t" if delimiter == "tab" else delimiter,):
        widths = [len(cells_of(line, candidate)) for line in lines[:_CELLS_LOOKED_AT] if line.strip() and not is_comment(line)]
        usual = max(set(widths), key=lambda width: (widths.count(width), width), default=1)
        likeness = widths.count(usual) if usual > 1 else 0
        if (likeness, usual) > (best[0], 1) and likeness > best[0]:
            best = (likeness, candidate)
    if not best[0]:
        raise TableError(f"{path}: no table: no line has two cells, separated by {', '.join(NAMES.values())}")
    for number, line in enumerate(lines, 1):
        cells = cells_of(uncommented(line) if is_comment(line) else line, best[1])
        words = [cell for cell in cells if cell and not re.match(r"[-+]?[.,]?\d", cell)]
        if len(words) >= 2 and len(words) >= sum(map(bool, cells)) - 1 and _is_followed_by_data(lines[number:], best[1], len(cells)):
            find_header(layout, [("column", words[0])], best[1], number)
            return
    raise TableError(f"{path}: no header: no line of headings stands above the numbers; add one, such as time;speed [rpm];load [kN]")


def _is_followed_by_data(lines: Sequence[str], delimiter: str, width: int) -> bool:
    """Return whether one of the next two lines that are no comments, three if units come first, has numbers and about as many cells."""
    following = [cells_of(line, delimiter) for line in lines[:50] if line.strip() and not is_comment(line)]
    units = [_is_a_unit(spelled(cell.strip("[]() "))) for cell in (following or [[]])[0] if cell]
    following = following[: 3 if 2 * sum(units) > len(units) else 2]
    return any(abs(len(cells) - width) <= 1 and any(re.match(r"[-+]?[.,]?\d", cell) for cell in cells) for cells in following)


def _marks(layout: Layout, found: Guess, decimal: str | None) -> Marks:
    """Return how numbers are written in the columns whose headings say what they are or, if none does, in all."""
    named = [name for name in dict.fromkeys(layout.names) if name]
    useful = [name for name in named if _TIME_WORDS.search(name) or _role_of(name, layout, {}) is not None] or named
    try:
        return number_marks(cells_in(layout, useful), layout.delimiter, decimal)
    except TableError as error:
        found.questions["decimal"] = str(error)
        return Marks()


def _first_cells(layout: Layout) -> Cells:
    """Return the first cells of each column that are not empty, by heading, without a second line of the header."""
    named = list(dict.fromkeys(layout.names))
    found: dict[str, list[str]] = {name: [] for name in named}
    for _, name, text in cells_in(layout, named):
        found[name].append(text.strip())
    return {name: [cell for cell in cells[layout.words :] if cell][:_CELLS_LOOKED_AT] for name, cells in found.items()}


def _number(text: str, marks: Marks) -> float:
    try:
        return float(marks.plain(text))
    except ValueError:
        return float("nan")


def _guess_time(found: Guess, given: str | None, unit: str | None, format_: str | None) -> set[str]:
    """Enter the time into a guess; return the headings of its columns."""
    layout = found.layout
    cells = _first_cells(layout)
    likely = [given] if given else [name for name in layout.names if name and _TIME_WORDS.search(name) and _is_time(cells, layout, name)]
    if not likely:
        likely = [name for name in layout.names[:1] if name and _is_time(cells, layout, name)]
    if not likely:
        found.questions["time"] = "no column looks like a time; name it: --column time=HEADING"
        return set()
    pair = _date_and_clock(cells, likely)
    heading = pair[0] if pair else likely[0]
    others = [name for name in likely if name not in (pair or (heading,))]
    values = cells[heading]
    if pair:
        values = [f"{date} {clock}" for date, clock in zip(values, cells[pair[1]])]
    tree = {"column": heading} | ({"time_of_day": pair[1]} if pair else {})
    reason = f"of {', '.join(likely)} the first" if others else "by its heading" if _TIME_WORDS.search(heading) else "the first column rises"
    try:
        how, why = _time_of(values, layout, heading, unit, format_)
        found.enter("time", tree | how, "; ".join(filter(None, (reason, why, _zone_note(values, how)))))
    except _Asked as question:
        found.questions["time"] = str(question)
    return set(likely)


def _zone_note(values: Sequence[str], how: AnyMapping) -> str:
    if "format" not in how or re.search(r"(Z|[+-]\d\d:?\d\d)$", values[0]):
        return ""
    return "no time zone is given, so UTC is assumed; set another one like zone: Europe/Berlin"


def _is_time(cells: Cells, layout: Layout, heading: str) -> bool:
    values, unit = cells[heading], spelled(_heading_unit(heading, layout)[1])
    if not values or (_is_a_unit(unit) and not is_unit_of(unit, "s")):
        return False
    numbers = [_number(value, layout.marks) for value in values]
    if all(number == number for number in numbers):
        rises = all(later >= earlier for earlier, later in zip(numbers, numbers[1:])) and numbers[-1] > numbers[0]
        return rises or _TIME_WORDS.search(heading) is not None
    return _is_iso(values[0]) or re.search(r"\d", values[0]) is not None and re.search(r"[:./-]", values[0]) is not None


def _date_and_clock(cells: Cells, likely: Sequence[str]) -> tuple[str, str] | None:
    """Return the headings of a date and of a time of day, if the table has them in two columns."""
    dates, clocks = ([name for name in likely if _formats_of(cells[name][:1], formats)] for formats in (_DATES, _CLOCKS))
    return (dates[0], clocks[0]) if dates and clocks else None


def _time_of(values: Sequence[str], layout: Layout, heading: str, unit: str | None, format_: str | None) -> tuple[dict, str]:
    """Return the fields of the time, and why; raise `_Asked` if it may mean several things."""
    if format_ is not None:
        return {"format": format_}, "its format was given"
    if not values:
        raise _Asked(f"the column {heading!r} is empty; name another: --column time=HEADING")
    numbers = [_number(value, layout.marks) for value in values]
    if all(number == number for number in numbers):
        return _time_of_numbers(numbers, layout, heading, unit)
    if all(_is_iso(value) for value in values):
        return {"format": "iso"}, f"ISO 8601, as in {values[0]}"
    formats = _formats_of(values, [*_DATES, *(f"{date}{between}{clock}" for date in _DATES for between in " T" for clock in _CLOCKS)])
    if len(formats) > 1:
        raise _Asked(f"{values[0]!r} has the day or the month first; say which: " + " or ".join(f"--time-format '{each}'" for each in formats))
    if formats:
        return {"format": formats[0]}, f"as in {values[0]}"
    raise _Asked(f"the times in {heading!r} are not understood, such as {values[0]!r}; say how they are written: --time-format '%d.%m.%Y %H:%M:%S'")


def _formats_of(texts: Sequence[str], formats: Iterable[str]) -> list[str]:
    """Return the formats of strptime that fit the most of some texts, as far as they fit one of the first."""
    likely = [format_ for format_ in formats if any(_is_written(text, format_) for text in texts[:_ROWS_TRIED])]
    counts = [sum(_is_written(text, format_) for text in texts) for format_ in likely]
    return [format_ for format_, count in zip(likely, counts) if count == max(counts)]


def _is_written(text: str, format_: str) -> bool:
    try:
        datetime.datetime.strptime(text, format_)
    except ValueError:
        return False
    return True


def _is_iso(text: str) -> bool:
    try:
        datetime.datetime.fromisoformat(text)
    except ValueError:
        return False
    return re.match(r"\d{4}-?\d\d-?\d\d", text) is not None


def _time_of_numbers(numbers: Sequence[float], layout: Layout, heading: str, unit: str | None) -> tuple[dict, str]:
    headed = spelled(_heading_unit(heading, layout)[1])
    unit = unit or (headed if is_unit_of(headed, "s") else None)
    since_1970 = next((each for low, high, each in _EPOCHS if all(low < abs(number) < high for number in numbers)), None)
    if unit is None and since_1970 is not None:
        return {"unit": since_1970}, f"numbers of this size count {since_1970} from 1970 ({_date(numbers[0], since_1970)})"
    may_be_days = all(_SPREADSHEET_DAYS[0] < number < _SPREADSHEET_DAYS[1] for number in numbers)
    if unit is None and may_be_days:
        steps = [later - earlier for earlier, later in zip(numbers, numbers[1:]) if later > earlier]
        if not steps or max(steps) > _SPREADSHEET_STEP:
            days = f"days of a spreadsheet ({_spreadsheet_date(numbers[0])}), or seconds"
            raise _Asked(f"numbers such as {numbers[0]:g} may be {days}; say which: --unit time=day or --unit time=s")
        unit = "day"
    if unit is None:
        raise _Asked(f"{heading!r} has numbers without a unit, such as {numbers[0]:g}; say which: --unit time=s, ms, min or h")
    if unit in _DAYS and may_be_days:
        other = "in its system of 1904 (old files of Macs) the epoch is 1904-01-01"
        return {"unit": "day", "epoch": "1899-12-30"}, f"days of a spreadsheet, {numbers[0]:g} is {_spreadsheet_date(numbers[0])}; {other}"
    why = f"{unit}, {'by its heading' if headed == unit else 'as given'}"
    if begins := start_of(layout.lines):
        return {"unit": unit, "epoch": begins}, f"{why}; LabVIEW's header has the epoch"
    return {"unit": unit}, why if since_1970 else f"{why}; the date of 0 is not known, so 1970-01-01 stands for it (epoch)"


def _spreadsheet_date(number: float) -> str:
    return f"{datetime.datetime(1899, 12, 30) + datetime.timedelta(days=number):%Y-%m-%d %H:%M}"


def _date(number: float, unit: str) -> str:
    seconds = number * {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[unit]
    return f"{datetime.datetime.fromtimestamp(seconds, datetime.UTC):%Y-%m-%d %H:%M}"


def _ask_for_rows(found: Guess) -> None:
    """Ask which rows are meant where the times go back, because the table holds several machines one below the other or in turn."""
    layout, before, line_of_return = found.layout, None, 0
    time = TypeAdapter(TimeColumn).validate_python(found.tree["time"])
    read, places = time_reader(time, layout.marks), [layout.names.index(name) for name in (time.column, time.time_of_day) if name]
    labels: dict[int, set[str]] = {k: set() for k, name in enumerate(layout.names) if name and k not in places}
    for number, cells in records(replace(layout)):
        if len(cells) != len(layout.names):
            continue
        for k in list(labels):
            labels[k].add(cells[k].strip()[:_LONGEST_LABEL])
            if not cells[k].isprintable() or len(labels[k]) > _MOST_LABELS or re.fullmatch(r"[-+]?[.,]?\d.*|", cells[k].strip()):
                del labels[k]
        try:
            now = read(" ".join(cells[k] for k in places).strip(), None)
        except (ValueError, ArithmeticError):
            continue
        line_of_return = line_of_return or (number if before is not None and now < before else 0)
        before = now
    choices = [(layout.names[k], sorted(texts)) for k, texts in labels.items() if len(texts) > 1]
    if line_of_return and choices:
        options = " or ".join(f"--only {name}={text}" for name, texts in choices for text in texts[:3])
        found.questions["only"] = f"times go back in line {line_of_return}; if the table holds several machines, choose one: {options}"


def _heading_unit(heading: str, layout: Layout) -> tuple[str, str]:
    """Return the name and the unit in a heading, in the second line of the header, in all cells, or behind an underscore."""
    name, unit = unit_in(heading)
    place, in_cells = layout.names.index(heading), layout.cell_units.get(heading, "")
    if not unit and place < len(layout.units):
        unit = layout.units[place].strip("[]() ")
    if is_relative(in_cells) or not unit:
        unit = "%" if is_relative(heading) and not unit else in_cells
    if not unit and len(heading) <= _LONGEST_HEADING and (found := _SUFFIX.fullmatch(heading)):
        name, unit = found[1], found[2]
    return name, unit


def _role_of(heading: str, layout: Layout, columns: AnyMapping[str, str], roles: Sequence[Role] = ROLES) -> Role | None:
    """Return what a heading says that its column is; None if it says nothing that is needed."""
    if heading in columns.values() or len(heading) > _LONGEST_HEADING:
        return None
    name, unit = _heading_unit(heading, layout)
    words = _CAMEL.sub(" ", f"{name} {unit}").replace("_", " ")
    texts = (words.lower(), heading.lower())
    unit = spelled(unit)
    for role in roles:
        says = any(re.search(role.words, text) for text in texts)
        denies = bool(role.not_words) and any(re.search(role.not_words, text) for text in texts)
        may_be = not role.si_unit or is_unit_of(unit, role.si_unit) or not _is_a_unit(unit) or is_relative(unit) and may_be_relative(role.si_unit)
        if says and not denies and may_be:
            return role
    return None


def _is_a_unit(unit: str) -> bool:
    """Return whether a text is a unit of anything that a table may hold."""
    return is_relative(unit) or any(
        is_unit_of(unit, si) for si in ("rad/s", "N", "K", "W", "N*m", "s", "m", "m/s", "m/s^2", "Pa", "rad", "A", "V", "Hz")
    )


def _guess_channels(found: Guess, named: AnyMapping[str, list[str]], columns, units, constants) -> None:
    """Enter speed, load, temperatures, and what is measured of the results, into a guess."""
    temperatures = ("oil_temperature", "inner_ring_temperature", "outer_ring_temperature")
    for name in ("shaft_speed", "radial_load", *temperatures, "cage_speed", "running_clearance"):
        if name in constants:
            found.enter(name, constants[name], "given")
            continue
        try:
            column, reason = _column_of(found.layout, name, named.get(name, []), columns, units)
        except _Asked as question:
            found.questions[name] = str(question)
            continue
        if column is not None:
            found.enter(name, {"law": "sum", "columns": [column]} if name == "radial_load" else column, reason)
    if "shaft_speed" not in found.tree and "shaft_speed" not in found.questions:
        found.questions["shaft_speed"] = "no heading names a speed; name its column: --column shaft_speed=HEADING, or give --speed 1500rpm"
    if "radial_load" not in found.tree and "radial_load" not in found.questions:
        found.questions["radial_load"] = _load_question(named)


def _load_question(named: AnyMapping[str, list[str]]) -> str:
    text = "no heading names a force; name its column: --column radial_load=HEADING, or give --load 800N"
    for name, what in (("power", "efficiency: 0.95, "), ("torque", "")):
        if named.get(name):
            place = f"{name}: {{column: {named[name][0]}, unit: ...}}"
            return f"{text}; from {named[name][0]!r} of a gear: {{law: gear_force, {place}, {what}pitch_diameter: 400 mm}}"
    return text


def _column_of(layout: Layout, name: str, headings: list[str], columns, units) -> tuple[dict | None, str]:
    """Return the column of a field and why; None if there is none.  Raise `_Asked` if something has to be decided."""
    role = next(each for each in ROLES if each.field == name)
    given = columns.get(name)
    absolute = [heading for heading in headings if not is_relative(_heading_unit(heading, layout)[1])]
    headings = [given] if given is not None else absolute or headings
    if not headings:
        return None, ""
    heading = headings[0]
    if len(set(headings)) < len(headings) or given is not None and layout.names.count(given) > 1:
        raise _Asked(f"{layout.names.count(heading)} columns are called {heading!r}; rename one in the header")
    if len(headings) > 1:
        raise _Asked(f"{len(headings)} headings fit; choose: " + " or ".join(f"--column {name}={each!r}" for each in headings))
    headed, example = spelled(_heading_unit(heading, layout)[1]), QUANTITIES[role.si_unit]["unit"]
    unit = units.get(name) or (headed if is_unit_of(headed, role.si_unit) else None)
    if unit is None and re.search(r"rpm", heading, re.IGNORECASE):
        unit = "rpm"
    if is_relative(headed) and not is_relative(unit or ""):
        if not may_be_relative(role.si_unit):
            raise _Asked(f"{heading!r} is a percentage, which no {QUANTITIES[role.si_unit]['name']} is; name another column: --column {name}=HEADING")
        relative = percentage_question(headed, role.si_unit).replace(", such as ", f": --unit {name}=")
        raise _Asked(f"{heading!r} is a percentage; give {relative}")
    if unit is None:
        raise _Asked(f"the heading {heading!r} has no unit; give it: --unit {name}={example}")
    if not is_unit_of(unit, role.si_unit):
        raise _Asked(f"--unit {name}={unit}: no unit of this quantity; expected for example {example}")
    reason = ("as given" if given else "by its heading") + f", in {unit} " + ("as given" if name in units else "as it says")
    return {"column": heading, "unit": unit}, reason
