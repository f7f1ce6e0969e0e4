# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured tables into input logs: every row that becomes a message, and by line number why the others do not.

A bad time loses its row; a bad cell loses the one message that needs it.  Nothing is filled in, sorted or smoothed.
"""

import csv
import hashlib
import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from bearing_sim import topics
from bearing_sim.csv_mapping import GearForce, Mapping, MassTimesAcceleration, NormLoad, nanoseconds
from bearing_sim.provenance import git_hash, package_version
from bearing_sim.scene_file import did_you_mean
from bearing_sim.simulation import Inputs
from bearing_sim.sinks.mcap_file import McapFile

METADATA = "bearing_sim_import"
"""Name of the metadata record: mapping (YAML), file, sha256, package_version, git_hash."""

_LINES_TOLD = 5  # of each kind of fault; all are counted
_USUAL_SPACINGS = 3.0  # rows further apart than this many median spacings leave a gap, where the mapping does not say


class TableError(ValueError):
    """A table that cannot become a log."""


class _BadCell(ValueError):
    """A cell that holds no usable number."""

    def __init__(self, code: str, text: str):
        self.code = code
        super().__init__(text)


@dataclass
class Table:
    """What was read from a table.

    Attributes
    ----------
    rows : rows of data, without the header and those that ``only`` leaves out (``left_out``).
    stamps : by channel [ns since 1970], rising.
    values : by channel, in SI; the load along +y.
    refused : by code, what could not be used: ``time.*`` a whole row, ``shaft_speed.*`` and so on one message.
    told : by code, the first few (line number, what is wrong).
    lines : by channel, the line number of each message.
    gaps : (channel, line number, seconds) of messages that come too long after the one before.
    longest_step : spacing [s] above which it is a gap.
    """

    rows: int = 0
    left_out: int = 0
    stamps: dict[str, list[int]] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=dict)
    refused: Counter = field(default_factory=Counter)
    told: dict[str, list[tuple[int, str]]] = field(default_factory=dict)
    lines: dict[str, list[int]] = field(default_factory=dict)
    gaps: list[tuple[str, int, float]] = field(default_factory=list)
    longest_step: float = math.nan

    def refuse(self, code: str, line: int, text: str) -> None:
        """Count a fault and remember it if it is among the first of its kind."""
        self.refused[code] += 1
        if len(told := self.told.setdefault(code, [])) < _LINES_TOLD:
            told.append((line, text))


def read_table(path: str | Path, mapping: Mapping) -> Table:
    """Read a table by a mapping.

    Raises
    ------
    TableError
        No such file, no text, no header, columns missing (all of them are named), or no row that can be used.
    """
    table = Table()
    path = Path(path)
    if not path.is_file():
        raise TableError(f"{path}: no such file")
    times: list[int] = []
    try:
        with open(path, newline="", encoding="utf-8-sig") as stream:
            records = csv.reader(stream, delimiter=mapping.delimiter, strict=True)
            row_reader = _RowReader(mapping, _header(path, records, mapping), table)
            for line, cells in _rows(records):
                if row_reader.take(line, cells):
                    times.append(row_reader.newest)
    except UnicodeDecodeError as fault:
        raise TableError(f"{path}: not readable as UTF-8 text ({fault.reason})") from None
    except csv.Error as fault:
        raise TableError(f"{path}, line {records.line_num}: {fault}") from None
    missing = [channel for channel in ("shaft_speed", "radial_load") if not table.stamps.get(channel)]
    if missing:
        why = ", ".join(f"{count} x {code}" for code, count in table.refused.items()) or "it has no rows" + " for `only`" * bool(mapping.only)
        raise TableError(f"{path}: nothing usable for {' and '.join(missing)}: {why}")
    _find_gaps(table, mapping, np.diff(times) * 1e-9)
    return table


def _header(path: Path, records: Iterator[list[str]], mapping: Mapping) -> dict[str, int]:
    names = [name.strip() for name in next(records, [])]
    faults = []
    for where, name in mapping.column_names():
        if names.count(name) == 0:
            faults.append(f"{where}: no column {name!r}{did_you_mean(name, names)}")
        elif names.count(name) > 1:
            faults.append(f"{where}: {names.count(name)} columns are called {name!r}")
    if faults:
        raise TableError("\n".join([f"{path}: the header has {', '.join(names) or 'nothing'}", *(f"  {fault}" for fault in faults)]))
    return {name: place for place, name in enumerate(names)}


def _rows(records) -> Iterator[tuple[int, list[str]]]:
    """Yield (line number, cells); the line that a row begins on."""
    before = records.line_num
    for cells in records:
        yield before + 1, cells
        before = records.line_num


class _RowReader:
    """Takes rows into a table by a mapping."""

    def __init__(self, mapping: Mapping, places: dict[str, int], table: Table):
        self._table, self._places, self._width = table, places, len(places)
        self._comma = mapping.decimal == ","
        self._only = [(places[name], text) for name, text in mapping.only.items()]
        self._time, self._time_place = _time_reader(mapping), places[mapping.time.column]
        self._speed = (places[mapping.shaft_speed.column], mapping.shaft_speed.column, *mapping.shaft_speed.line())
        self._load_columns = [(places[record.column], record.column, *record.line()) for record in mapping.load_columns()]
        self._load = _load_law(mapping)
        optional = {"oil_temperature": mapping.oil_temperature, topics.MEASURED: mapping.cage_speed}
        self._optional = {channel: (places[one.column], one.column, *one.line()) for channel, one in optional.items() if one}
        self.newest: int | None = None

    def take(self, line: int, cells: list[str]) -> bool:
        """Take one row; return whether its time was good."""
        if cells and len(cells) == self._width and any(cells[place].strip() != text for place, text in self._only):
            self._table.left_out += 1
            return False
        self._table.rows += 1
        time_ns = self._time_of(line, cells)
        if time_ns is None:
            return False
        self.newest = time_ns
        speed = self._number("shaft_speed", line, time_ns, lambda: self._cell(cells, *self._speed))
        self._number("radial_load", line, time_ns, lambda: self._load(speed, [self._cell(cells, *column) for column in self._load_columns]))
        for channel, column in self._optional.items():
            self._number(channel, line, time_ns, lambda column=column: self._cell(cells, *column))
        return True

    def _time_of(self, line: int, cells: list[str]) -> int | None:
        """Return the row's time if it can be used, else count why not."""
        refuse = self._table.refuse
        if len(cells) != self._width:
            refuse("time.cells" if cells else "time.empty_line", line, f"{len(cells)} cells, expected {self._width}")
            return None
        text = cells[self._time_place].strip()
        try:
            time_ns = self._time(text)
        except (ValueError, InvalidOperation, OverflowError):
            refuse("time.unreadable" if text else "time.empty_cell", line, f"{text!r} is no time" if text else "the time is empty")
            return None
        if self.newest is not None and time_ns <= self.newest:
            back = (self.newest - time_ns) * 1e-9
            if back:
                refuse("time.backwards", line, f"{text} lies {back:.6g} s before the row used last")
            else:
                refuse("time.repeated", line, f"{text} repeats the time of the row used last")
            return None
        return time_ns

    def _number(self, channel: str, line: int, time_ns: int, read: Callable[[], float]) -> float:
        """Keep one channel's value if it can be used, else count why not; returns it, or NaN."""
        try:
            value = read()
        except _BadCell as fault:
            self._table.refuse(f"{channel}.{fault.code}", line, str(fault))
            return math.nan
        self._table.stamps.setdefault(channel, []).append(time_ns)
        self._table.values.setdefault(channel, []).append(value)
        self._table.lines.setdefault(channel, []).append(line)
        return value

    def _cell(self, cells: list[str], place: int, name: str, scale: float, offset: float) -> float:
        text = cells[place].strip()
        if not text:
            raise _BadCell("empty_cell", f"{name} is empty")
        try:
            if "_" in text or (self._comma and "." in text):  # float() would read 1_000; and 1.000 is not 1 where a comma is the mark
                raise ValueError
            number = float(text.replace(",", ".") if self._comma else text)
        except ValueError:
            raise _BadCell("not_a_number", f"{name} = {text!r} is no number") from None
        if not math.isfinite(number):
            raise _BadCell("not_finite", f"{name} = {text} is not finite")
        return offset + scale * number


def _time_reader(mapping: Mapping) -> Callable[[str], int]:
    """Return what turns a time cell into nanoseconds since 1970."""
    time = mapping.time
    if time.format == "iso":
        return lambda text: nanoseconds(datetime.fromisoformat(text))
    if time.format is not None:
        return lambda text: nanoseconds(datetime.strptime(text, time.format))
    # Decimal keeps every digit of a time; a float would not keep nanoseconds.
    factor, epoch, comma = Decimal(repr(time.nanoseconds_per_unit())), time.epoch_ns(), mapping.decimal == ","

    def read(text: str) -> int:
        if "_" in text or (comma and "." in text):
            raise ValueError(text)
        return epoch + round(Decimal(text.replace(",", ".") if comma else text) * factor)

    return read


def _load_law(mapping: Mapping) -> Callable[[float, list[float]], float]:
    """Return load(speed, column values) in SI."""
    law = mapping.radial_load
    if isinstance(law, MassTimesAcceleration):
        return lambda speed, values: law.mass * math.hypot(*values)
    if isinstance(law, NormLoad):
        return lambda speed, values: math.hypot(*values)
    if isinstance(law, GearForce):
        return lambda speed, values: _gear_force(law, speed, values[0])
    return lambda speed, values: math.fsum(values)


def _gear_force(law: GearForce, speed: float, power: float) -> float:
    if not abs(speed) > 0.0:  # NaN too: the row's speed could not be read
        raise _BadCell("no_speed", "power without a shaft speed above zero gives no force")
    return 2 * power / (law.efficiency * abs(speed) * law.pitch_diameter)


def _find_gaps(table: Table, mapping: Mapping, row_spacings: np.ndarray) -> None:
    usual = _USUAL_SPACINGS * float(np.median(row_spacings)) if len(row_spacings) else math.nan
    table.longest_step = mapping.time.longest_step if mapping.time.longest_step is not None else usual
    for channel, stamps in table.stamps.items():
        spacings = np.diff(stamps) * 1e-9
        # A nanosecond of slack: times are rounded to nanoseconds.
        for place in np.flatnonzero(spacings > table.longest_step + 1e-9):
            table.gaps.append((channel, table.lines[channel][place + 1], float(spacings[place])))


def write_log(table: Table, mapping_text: str, source: str | Path, out: str | Path, progress: Callable[[float], None] = lambda done: None) -> None:
    """Write a table as an input log, each channel at its own stamps, all in order of time.

    Parameters
    ----------
    table : what `read_table` returned.
    mapping_text : the mapping, for the file's metadata.
    source : the table's file; its name and checksum go into the metadata.
    out : the recording to write.
    progress : called now and then with the number of messages written.
    """
    origin = {"package_version": package_version(), "git_hash": git_hash()}
    checksum = hashlib.sha256(Path(source).read_bytes()).hexdigest()
    record = {"mapping": mapping_text, "file": Path(source).name, "sha256": checksum, **origin}
    messages = sorted((stamp, channel, place) for channel, stamps in table.stamps.items() for place, stamp in enumerate(stamps))
    with McapFile(out, {METADATA: record}, {"generator": "bearing_sim", **origin}, replace=True) as recording:
        for done, (stamp, channel, place) in enumerate(messages):
            topic, value = (topics.INPUTS | topics.MEASUREMENTS)[channel], table.values[channel][place]
            # An input's message takes its own channel out of the inputs; the others do not matter.
            source = value if channel == topics.MEASURED else Inputs(value, value, 0.0, value)
            recording.write(f"/{topic.name}", topic.ros_type, stamp, topic.message(stamp, source))
            if done % 1000 == 0:
                progress(done)
