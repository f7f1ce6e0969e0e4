# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Import measured tables (CSV) as input logs.

A mapping, a YAML file, says which columns are time, shaft speed, radial load, oil temperature and cage speed, and in which units.
Nothing in it is evaluated: each input is one of a few fixed laws of columns.

A bad time costs its row, a bad cell the one message that needs it; both are reported by line number.  Nothing is filled in, sorted or
smoothed.
"""

import csv
import datetime
import hashlib
import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from decimal import Decimal, InvalidOperation
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from bearing_sim.inputs.gate import with_values
from bearing_sim.messages import topics
from bearing_sim.recording.provenance import git_hash, package_version
from bearing_sim.recording.writer import McapFile
from bearing_sim.scene.loader import SceneError, did_you_mean, invalid_fields, read_named, yaml_mapping
from bearing_sim.scene.quantity import check, conversion, quantity, record, to_si
from bearing_sim.simulation import Inputs

METADATA = "bearing_sim_import"
"""Name of the metadata record: mapping (YAML), file, sha256, package_version, git_hash."""

_LINES_KEPT = 5  # of each kind of error; all are counted
_USUAL_SPACINGS = 3.0  # median spacings above which there is a gap, if the mapping does not set longest_step

_LAWS = frozenset({"sum", "norm", "mass_times_acceleration", "gear_force"})


def _column(si_unit: str, meaning: str) -> type:
    """Return the record type of a column: value in SI = scale x cell + offset, or the cell in a named unit."""

    @record
    class Column:
        """A column: either ``unit``, or ``scale`` (SI per unit of the cell) and ``offset``."""

        column: str
        unit: str | None = None
        scale: quantity(si_unit, f"{meaning} for a cell of 1") | None = None
        offset: quantity(si_unit, f"{meaning} for a cell of 0") | None = None

        @check
        def _converts(self) -> list[str]:
            if (self.unit is None) == (self.scale is None):
                return ["expected either unit, or scale (and offset)"]
            if self.unit is not None and self.offset is not None:
                return ["offset does not go with unit; give scale and offset instead"]
            if self.scale is not None and not (math.isfinite(self.scale) and math.isfinite(self.offset or 0.0)):
                return ["expected a finite scale and offset"]
            self.line()  # a wrong unit is an error of the mapping, not of the data
            return []

        def line(self) -> tuple[float, float]:
            """Return (scale, offset) in SI."""
            return (self.scale, self.offset or 0.0) if self.unit is None else conversion(self.unit, si_unit)

    return Column


SpeedColumn = _column("rad/s", "shaft speed")
ForceColumn = _column("N", "force")
AccelerationColumn = _column("m/s^2", "acceleration")
TemperatureColumn = _column("K", "temperature of oil or of a ring")
PowerColumn = _column("W", "power")


@record
class TimeColumn:
    """The time of each row: numbers in a ``unit`` since ``epoch``, or timestamps in a ``format``."""

    column: str
    unit: str | None = None
    format: str | None = None  # "iso", or a format of strptime; a timestamp without a zone is UTC
    epoch: datetime.datetime | datetime.date | str | None = None
    longest_step: quantity("s", "spacing of rows above which there is a gap", 0.0) | None = None

    @check
    def _reads_one_way(self) -> list[str]:
        if (self.unit is None) == (self.format is None):
            return ["expected either unit (numbers), or format (timestamps)"]
        if self.format is not None and self.epoch is not None:
            return ["epoch does not go with format: timestamps contain their date"]
        if self.unit is not None:
            self.nanoseconds_per_unit()
            self.epoch_ns()
        return []

    def nanoseconds_per_unit(self) -> float:
        """Return the number of nanoseconds in one unit of the cell."""
        return to_si(f"1 {self.unit}", "s") * 1e9

    def epoch_ns(self) -> int:
        """Return the time of a cell of 0 [ns since 1970]."""
        if self.epoch is None:
            return 0
        try:
            return nanoseconds(datetime.datetime.fromisoformat(str(self.epoch)))
        except ValueError:
            raise ValueError("epoch: expected a date such as 2019-03-12 or 2019-03-12T06:00:00Z") from None


def nanoseconds(moment: datetime.datetime) -> int:
    """Return a moment in nanoseconds since 1970; UTC if it has no zone."""
    zoned = moment if moment.tzinfo is not None else moment.replace(tzinfo=datetime.UTC)
    return (zoned - datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)) // datetime.timedelta(microseconds=1) * 1000


@record
class SumLoad:
    """Load along +y: the sum of the columns."""

    law: Literal["sum"] = "sum"
    columns: tuple[ForceColumn, ...]


@record
class NormLoad:
    """Load along +y: the Euclidean norm of the columns."""

    law: Literal["norm"] = "norm"
    columns: tuple[ForceColumn, ...]


@record
class MassTimesAcceleration:
    """Load along +y: a supported mass times the Euclidean norm of the accelerations."""

    law: Literal["mass_times_acceleration"] = "mass_times_acceleration"
    mass: quantity("kg", "mass that the bearing supports", 1e-6, 1e6)
    accelerations: tuple[AccelerationColumn, ...]


@record
class GearForce:
    """Load along +y: tangential force of a gear on the shaft, F = 2 P/(efficiency omega d) with the row's shaft speed omega."""

    law: Literal["gear_force"] = "gear_force"
    power: PowerColumn
    efficiency: quantity("", "power out over power through the gear", 0.01, 1.0)
    pitch_diameter: quantity("m", "pitch diameter of the gear, d", 1e-3, 100.0, "mm")


@record
class Mapping:
    """How the columns of a table become the messages of a log."""

    name: str
    description: str = ""
    source: str = ""
    delimiter: Annotated[str, Field(min_length=1, max_length=1)] = ","
    decimal: Literal[".", ","] = "."
    only: dict[str, str] = Field(default_factory=dict)  # column: text that its cell must have; other rows are left out
    time: TimeColumn
    shaft_speed: SpeedColumn
    radial_load: Annotated[SumLoad | NormLoad | MassTimesAcceleration | GearForce, Field(discriminator="law")]
    oil_temperature: TemperatureColumn | None = None
    inner_ring_temperature: TemperatureColumn | None = None
    outer_ring_temperature: TemperatureColumn | None = None
    cage_speed: SpeedColumn | None = None  # measured; compared with the model, not an input of it

    @check
    def _is_complete(self) -> list[str]:
        if self.delimiter == self.decimal:
            return ["delimiter: expected a character other than the decimal mark"]
        return [] if self.load_columns() else [f"radial_load: the law {self.radial_load.law} needs at least one column"]

    def load_columns(self) -> tuple:
        """Return the columns that the load is computed from."""
        load = self.radial_load
        if isinstance(load, MassTimesAcceleration):
            return load.accelerations
        return (load.power,) if isinstance(load, GearForce) else load.columns

    def column_names(self) -> list[tuple[str, str]]:
        """Return (path in the mapping, name) of every column that is used."""
        named = [(f"only.{name}", name) for name in self.only]
        named += [("time.column", self.time.column), ("shaft_speed.column", self.shaft_speed.column)]
        named += [("radial_load", one.column) for one in self.load_columns()]
        optional = ((name, getattr(self, name)) for name in (*topics.TEMPERATURES, "cage_speed"))
        return named + [(f"{name}.column", one.column) for name, one in optional if one]


def load_mapping(mapping: str | Path) -> tuple[Mapping, str]:
    """Load a mapping by bundled name or file path.

    Returns
    -------
    The mapping and its text.

    Raises
    ------
    SceneError
        The file is missing, is not YAML, or has errors; all of them are listed.
    """
    text, _ = read_named(mapping, "catalog/mappings", "mapping")
    return mapping_from_yaml(text, str(mapping)), text


def mapping_from_yaml(text: str, origin: str = "mapping") -> Mapping:
    """Build a mapping from YAML text (see `load_mapping`)."""
    tree = yaml_mapping(text, origin, "time, shaft_speed, radial_load ...")
    try:
        return TypeAdapter(Mapping).validate_python(tree)
    except ValidationError as error:
        raise SceneError(origin, invalid_fields(error, Mapping, _LAWS)) from None


class TableError(ValueError):
    """A table that cannot be imported."""


class _BadCell(ValueError):
    """A cell without a usable number."""

    def __init__(self, kind: str, text: str):
        self.kind = kind
        super().__init__(text)


@dataclass
class Table:
    """What was read from a table.

    Attributes
    ----------
    rows : rows of data, without the header and those that ``only`` leaves out (``left_out``).
    stamps : by channel [ns since 1970], rising.
    values : by channel, in SI; the load along +y.
    refused : number of errors by kind: ``time.*`` costs a whole row, ``shaft_speed.*`` and so on one message.
    examples : by kind, the first few (line number, what is wrong).
    lines : by channel, the line number of each message.
    gaps : (channel, line number, seconds) of messages that come too long after the one before.
    longest_step : spacing [s] above which there is a gap.
    """

    rows: int = 0
    left_out: int = 0
    stamps: dict[str, list[int]] = field(default_factory=dict)
    values: dict[str, list[float]] = field(default_factory=dict)
    refused: Counter = field(default_factory=Counter)
    examples: dict[str, list[tuple[int, str]]] = field(default_factory=dict)
    lines: dict[str, list[int]] = field(default_factory=dict)
    gaps: list[tuple[str, int, float]] = field(default_factory=list)
    longest_step: float = math.nan

    def refuse(self, kind: str, line: int, text: str) -> None:
        """Count an error and keep it as an example if it is among the first of its kind."""
        self.refused[kind] += 1
        if len(examples := self.examples.setdefault(kind, [])) < _LINES_KEPT:
            examples.append((line, text))


def read_table(path: str | Path, mapping: Mapping) -> Table:
    """Read a table as a mapping describes it.

    Raises
    ------
    TableError
        The file is missing, not text, or has no header; columns are missing (all of them are named); or no row can be used.
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
    except UnicodeDecodeError as error:
        raise TableError(f"{path}: not readable as UTF-8 text ({error.reason})") from None
    except csv.Error as error:
        raise TableError(f"{path}, line {records.line_num}: {error}") from None
    missing = [channel for channel in ("shaft_speed", "radial_load") if not table.stamps.get(channel)]
    if missing:
        why = ", ".join(f"{count} x {kind}" for kind, count in table.refused.items()) or "it has no rows" + " that match `only`" * bool(mapping.only)
        raise TableError(f"{path}: nothing usable for {' and '.join(missing)}: {why}")
    _find_gaps(table, mapping, np.diff(times) * 1e-9)
    return table


def _header(path: Path, records: Iterator[list[str]], mapping: Mapping) -> dict[str, int]:
    names = [name.strip() for name in next(records, [])]
    errors = []
    for where, name in mapping.column_names():
        if names.count(name) == 0:
            errors.append(f"{where}: no column {name!r}{did_you_mean(name, names)}")
        elif names.count(name) > 1:
            errors.append(f"{where}: {names.count(name)} columns are called {name!r}")
    if errors:
        raise TableError("\n".join([f"{path}: the header has {', '.join(names) or 'nothing'}", *(f"  {error}" for error in errors)]))
    return {name: column for column, name in enumerate(names)}


def _rows(records) -> Iterator[tuple[int, list[str]]]:
    """Yield (number of the line that the row begins on, cells)."""
    before = records.line_num
    for cells in records:
        yield before + 1, cells
        before = records.line_num


class _RowReader:
    """Adds rows to a table as a mapping describes them."""

    def __init__(self, mapping: Mapping, columns: dict[str, int], table: Table):
        self._table, self._width = table, len(columns)
        self._comma = mapping.decimal == ","
        self._only = [(columns[name], text) for name, text in mapping.only.items()]
        self._time, self._time_column = _time_reader(mapping), columns[mapping.time.column]
        self._speed = (columns[mapping.shaft_speed.column], mapping.shaft_speed.column, *mapping.shaft_speed.line())
        self._load_columns = [(columns[one.column], one.column, *one.line()) for one in mapping.load_columns()]
        self._load = _load_law(mapping)
        optional = {channel: getattr(mapping, channel) for channel in topics.TEMPERATURES} | {topics.MEASURED: mapping.cage_speed}
        self._optional = {channel: (columns[one.column], one.column, *one.line()) for channel, one in optional.items() if one}
        self.newest: int | None = None

    def take(self, line: int, cells: list[str]) -> bool:
        """Add one row; return whether its time is good."""
        if cells and len(cells) == self._width and any(cells[column].strip() != text for column, text in self._only):
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
        """Return the row's time if it can be used, otherwise count the error."""
        refuse = self._table.refuse
        if len(cells) != self._width:
            refuse("time.cells" if cells else "time.empty_line", line, f"{len(cells)} cells, expected {self._width}")
            return None
        text = cells[self._time_column].strip()
        try:
            time_ns = self._time(text)
        except (ValueError, InvalidOperation, OverflowError):
            refuse("time.unreadable" if text else "time.empty_cell", line, f"{text!r} is not a time" if text else "the time is empty")
            return None
        if self.newest is not None and time_ns <= self.newest:
            back = (self.newest - time_ns) * 1e-9
            if back:
                refuse("time.backwards", line, f"{text} lies {back:.6g} s before the last row used")
            else:
                refuse("time.repeated", line, f"{text} repeats the time of the last row used")
            return None
        return time_ns

    def _number(self, channel: str, line: int, time_ns: int, read: Callable[[], float]) -> float:
        """Return one channel's value and keep it if it can be used, otherwise count the error and return NaN."""
        try:
            value = read()
        except _BadCell as error:
            self._table.refuse(f"{channel}.{error.kind}", line, str(error))
            return math.nan
        self._table.stamps.setdefault(channel, []).append(time_ns)
        self._table.values.setdefault(channel, []).append(value)
        self._table.lines.setdefault(channel, []).append(line)
        return value

    def _cell(self, cells: list[str], column: int, name: str, scale: float, offset: float) -> float:
        text = cells[column].strip()
        if not text:
            raise _BadCell("empty_cell", f"{name} is empty")
        try:
            number = float(_with_point(text, self._comma))
        except ValueError:
            raise _BadCell("not_a_number", f"{name} = {text!r} is not a number") from None
        if not math.isfinite(number):
            raise _BadCell("not_finite", f"{name} = {text} is not finite")
        return offset + scale * number


def _time_reader(mapping: Mapping) -> Callable[[str], int]:
    """Return a function that converts a time cell to nanoseconds since 1970."""
    time = mapping.time
    if time.format == "iso":
        return lambda text: nanoseconds(datetime.datetime.fromisoformat(text))
    if time.format is not None:
        return lambda text: nanoseconds(datetime.datetime.strptime(text, time.format))
    # Decimal keeps every digit of a time; a float would lose nanoseconds.
    factor, epoch, comma = Decimal(repr(time.nanoseconds_per_unit())), time.epoch_ns(), mapping.decimal == ","
    return lambda text: epoch + round(Decimal(_with_point(text, comma)) * factor)


def _with_point(text: str, comma: bool) -> str:
    """Return a number with a decimal point; ``comma`` says that its decimal mark is a comma."""
    if "_" in text or (comma and "." in text):  # float() accepts 1_000, and 1.000 where a comma is the mark
        raise ValueError(text)
    return text.replace(",", ".") if comma else text


def _load_law(mapping: Mapping) -> Callable[[float, list[float]], float]:
    """Return the function load(speed, column values), in SI."""
    law = mapping.radial_load
    if isinstance(law, MassTimesAcceleration):
        return lambda speed, values: law.mass * math.hypot(*values)
    if isinstance(law, NormLoad):
        return lambda speed, values: math.hypot(*values)
    if isinstance(law, GearForce):
        return lambda speed, values: _gear_force(law, speed, values[0])
    return lambda speed, values: math.fsum(values)


def _gear_force(law: GearForce, speed: float, power: float) -> float:
    if not abs(speed) > 0.0:  # also NaN, where the row's speed could not be read
        raise _BadCell("no_speed", "power without a shaft speed other than zero gives no force")
    return 2 * power / (law.efficiency * abs(speed) * law.pitch_diameter)


def _find_gaps(table: Table, mapping: Mapping, row_spacings: np.ndarray) -> None:
    usual = _USUAL_SPACINGS * float(np.median(row_spacings)) if len(row_spacings) else math.nan
    table.longest_step = mapping.time.longest_step if mapping.time.longest_step is not None else usual
    for channel, stamps in table.stamps.items():
        spacings = np.diff(stamps) * 1e-9
        # A nanosecond of slack: times are rounded to nanoseconds.
        for k in np.flatnonzero(spacings > table.longest_step + 1e-9):
            table.gaps.append((channel, table.lines[channel][k + 1], float(spacings[k])))


def write_log(table: Table, mapping_text: str, source: str | Path, out: str | Path, progress: Callable[[float], None] = lambda done: None) -> None:
    """Write a table as an input log, each channel at its own stamps, in order of time.

    Parameters
    ----------
    table : see `read_table`.
    mapping_text : the mapping's YAML, for the metadata.
    source : the table's file; its name and checksum go into the metadata.
    out : the recording to write.
    progress : called now and then with the number of messages written.
    """
    origin = {"package_version": package_version(), "git_hash": git_hash()}
    checksum = hashlib.sha256(Path(source).read_bytes()).hexdigest()
    metadata = {"mapping": mapping_text, "file": Path(source).name, "sha256": checksum, **origin}
    messages = sorted((stamp, channel, k) for channel, stamps in table.stamps.items() for k, stamp in enumerate(stamps))
    with McapFile(out, {METADATA: metadata}, {"generator": "bearing_sim", **origin}, replace=True) as recording:
        for done, (stamp, channel, k) in enumerate(messages):
            topic, value = (topics.INPUTS | topics.MEASUREMENTS)[channel], table.values[channel][k]
            content = value if channel == topics.MEASURED else with_values(Inputs(0.0, 0.0, 0.0, 0.0), channel, (value,))
            recording.write(f"/{topic.name}", topic.ros_type, stamp, topic.message(stamp, content))
            if done % 1000 == 0:
                progress(done)
