# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Import measured tables (CSV or Parquet) as input logs.

A mapping, a YAML file, says which columns are time, shaft speed, radial load, oil temperature and cage speed, and in which units.
Nothing in it is evaluated: each input is one of a few fixed laws of columns.

A bad time costs its row, a bad cell the one message that needs it; both are reported by line number.  Nothing is filled in, sorted or
smoothed.
"""

import datetime
import heapq
import itertools
import math
import re
import zoneinfo
from array import array
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from decimal import Decimal
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.files.tally import Tally
from bearing_sim.inputs.csv_text import (
    EXPECTED_ENCODINGS,
    QUANTITIES,
    Layout,
    Marks,
    TableError,
    cells_in,
    find_header,
    first_look,
    is_relative,
    is_unit_of,
    may_be_relative,
    number_marks,
    percentage_question,
    records,
    spelled,
    unit_in,
    unit_line,
)
from bearing_sim.inputs.gate import shown, value_refusal, with_values
from bearing_sim.inputs.log import InputLog, Series
from bearing_sim.inputs.parquet_table import checksum, is_parquet, parquet_layout, parquet_records
from bearing_sim.messages import topics
from bearing_sim.recording.writer import McapFile
from bearing_sim.scene.field_errors import invalid_fields
from bearing_sim.scene.loader import InvalidField, SceneError, read_named, yaml_mapping
from bearing_sim.scene.quantity import Quantity, check, record, to_si
from bearing_sim.scene.scene import InputLimits
from bearing_sim.simulation import Inputs

METADATA = "bearing_sim_import"
"""Name of the metadata record: mapping (YAML), file, sha256, package_version, git_hash."""

_LIMITS = InputLimits()  # of a scene that says nothing; those of speed and load depend on the bearing, and are not known here
# Assumption: what loggers and databases write where a sensor has no value; numbers of nines, and the least number of 16 bits.
_ERROR_CODES_FROM, _ERROR_CODE = -999.0, re.compile(r"-(9{3,}(\.9+)?|32768)")
_STUCK_ROWS, _STUCK_SPELLS = 100, 20.0  # a signal sticks if it repeats one value in so many rows, and so many times as long as usually
_LINES_KEPT = 5  # of each kind of error; all are counted
_ROWS_LOOKED_AT = 2000  # for times that are rounded
_ROUNDED = 0.2  # Assumption: of the rows repeat the time of the one before if times are rounded; of fewer, each is a fault
_LIKE_A_NUMBER = re.compile(r"\s*([-+.,\N{MINUS SIGN}]?\d|$)")
_USUAL_SPACINGS = 3.0  # median spacings above which there is a gap, if the mapping does not set longest_step

_LONGEST_FORMAT = 100  # characters
_TIMES_END = 2**31 * 1_000_000_000  # [ns since 1970], in the year 2038: stamps of ROS count seconds in 31 bits
_LONGEST_TIME = 10_000 * 366 * 86_400 * 1_000_000_000  # [ns] from any epoch that a date can name
_SHOWN = 60  # characters of a cell in a message

_RESULTS = {topics.MEASURED: "cage_speed", topics.MEASURED_CLEARANCE: "running_clearance"}
"""The field of a mapping for each channel of what the model predicts and somebody has measured."""


def _column(si_unit: str, meaning: str) -> type:
    """Return the record type of a column: value in SI = scale x cell + offset, or the cell in a named unit."""

    @record
    class Column:
        """A column in a ``unit``, which its heading may give, or with ``scale`` and ``offset``; or a ``constant`` where nothing was measured."""

        column: str = ""  # heading in the table
        # of the cells, such as rpm, kN, degC, or '% of 1500 rpm'; by default the one in the heading, as in Speed [rpm]
        unit: str | None = None
        scale: Annotated[float, Quantity(si_unit, f"{meaning} for a cell of 1, instead of a unit")] | None = None
        offset: Annotated[float, Quantity(si_unit, f"{meaning} for a cell of 0, with a scale")] | None = None
        constant: Annotated[float, Quantity(si_unit, f"{meaning} throughout, instead of a column")] | None = None

        @check
        def _converts(self) -> list[str]:
            if (not self.column) == (self.constant is None):
                return [f"expected either a column, or a constant such as {QUANTITIES[si_unit]['constant']}"]
            if self.constant is not None:
                return self._errors_of_constant()
            if self.unit is not None and self.scale is not None:
                return ["expected either unit, or scale (and offset)"]
            if self.unit is None and self.scale is None and not unit_in(self.column)[1]:
                return [f"expected either unit, or scale (and offset), since the heading {self.column!r} has no unit"]
            if self.unit is not None and is_relative(self.column) and not is_relative(self.unit):
                example = f"expected {percentage_question(self.unit, si_unit)}; or" if may_be_relative(si_unit) else "expected"
                return [f"unit = {self.unit!r}: the heading {self.column!r} is a percentage; {example}, if it is wrong, scale: 1 {self.unit}"]
            if self.scale is None and self.offset is not None:
                return ["offset does not go with unit; give scale and offset instead"]
            if self.scale is not None and not (math.isfinite(self.scale) and math.isfinite(self.offset or 0.0)):
                return ["expected a finite scale and offset"]
            self.line()  # a wrong unit is an error of the mapping, not of the data
            return []

        def _errors_of_constant(self) -> list[str]:
            given = [name for name in ("unit", "scale", "offset") if getattr(self, name) is not None]
            if given:
                return [f"{' and '.join(given)} do not go with a constant, which has its own unit"]
            return [] if math.isfinite(self.constant) else ["expected a finite constant"]

        def line(self) -> tuple[float, float]:
            """Return (scale, offset) in SI."""
            if self.scale is not None:
                return self.scale, self.offset or 0.0
            return unit_line(self.unit or unit_in(self.column)[1], si_unit)

        def contradiction(self, in_cells: str = "") -> str:
            """Return in words that heading or cells have another unit than the mapping; empty if they have not.

            Raises
            ------
            TableError
                The cells are percentages, and the mapping does not say of what.
            """
            given = self.unit or unit_in(self.column)[1]
            if self.scale is None and is_relative(in_cells) and not is_relative(given):
                raise TableError(
                    f"{self.column}: the cells are percentages ({in_cells}), not {given}; unit: expected {percentage_question(in_cells, si_unit)}"
                )
            own = spelled(in_cells or unit_in(self.column)[1])
            if not given or not is_unit_of(own, si_unit) or unit_line(own, si_unit) == self.line() or not (self.unit or in_cells):
                return ""
            return f"{'a cell of' if in_cells else 'the heading'} {self.column!r} says {own}, the mapping {given}; the mapping is followed"

    return Column


SpeedColumn = _column("rad/s", "shaft speed")
ForceColumn = _column("N", "force")
AccelerationColumn = _column("m/s^2", "acceleration")
TemperatureColumn = _column("K", "temperature of oil or of a ring")
PowerColumn = _column("W", "power")
TorqueColumn = _column("N*m", "torque")
ClearanceColumn = _column("m", "diametral clearance of the running bearing, negative is preload,")


@record
class TimeColumn:
    """The time of each row: numbers in a ``unit`` since ``epoch``, or timestamps in a ``format``."""

    column: str  # heading in the table
    time_of_day: str = ""  # heading of a second column, with the time of day, where the first has the date only
    unit: str | None = None  # of numbers: s, ms, min, h, day
    format: str | None = None  # of timestamps: iso, or a format of Python's strptime, such as %d.%m.%Y %H:%M:%S
    zone: str = "UTC"  # of timestamps that do not name theirs, such as Europe/Berlin or +01:00; of times told twice in autumn the rising one
    epoch: datetime.datetime | datetime.date | str | None = None  # date and time of the number 0 [1970-01-01]
    longest_step: Annotated[float, Quantity("s", "spacing of rows above which there is a gap", 0.0)] | None = None

    @check
    def _reads_one_way(self) -> list[str]:
        if (self.unit is None) == (self.format is None):
            return ["expected either unit (numbers), or format (timestamps)"]
        if self.format is not None and self.epoch is not None:
            return ["epoch does not go with format: timestamps contain their date"]
        if self.format is None and (self.time_of_day or self.zone != "UTC"):
            return ["time_of_day and zone go with format only; give the epoch with its zone, such as 2026-01-01T00:00:00+01:00"]
        self.zone_info()
        if self.format is not None and self.format != "iso":
            self._check_format()
        if self.unit is not None:
            self.nanoseconds_per_unit()
            self.epoch_ns()
        return []

    def _check_format(self) -> None:
        """Raise ValueError if Python's strptime does not know the format; it compiles the format only when it reads the first time."""
        if len(self.format) > _LONGEST_FORMAT:
            raise ValueError(f"format: {len(self.format)} characters; expected such as %d.%m.%Y %H:%M:%S, at most {_LONGEST_FORMAT}")
        try:
            datetime.datetime.strptime("", self.format)
        except re.error:
            raise ValueError(f"format = {self.format!r}: has a part twice; expected such as %d.%m.%Y %H:%M:%S") from None
        except (ValueError, LookupError) as error:
            if "does not match" not in str(error):  # an empty text matches no format
                raise ValueError(f"format = {self.format!r}: {error}; expected such as %d.%m.%Y %H:%M:%S") from None

    def nanoseconds_per_unit(self) -> float:
        """Return the number of nanoseconds in one unit of the cell."""
        factor = to_si(f"1 {spelled(self.unit)}", "s") * 1e9
        if not 0.0 < factor < _TIMES_END:
            raise ValueError(f"unit = {self.unit!r}: expected a unit of times such as s, ms, min, h or day")
        return factor

    def zone_info(self) -> datetime.tzinfo:
        """Return the zone of timestamps that do not name theirs."""
        if found := re.fullmatch(r"([-+])(\d{1,2}):?(\d{2})?", self.zone):
            minutes = 60 * int(found[2]) + int(found[3] or 0)
            if minutes >= 24 * 60:
                raise ValueError(f"zone = {self.zone!r}: expected an offset of less than 24 hours, such as +01:00")
            return datetime.timezone((-1 if found[1] == "-" else 1) * datetime.timedelta(minutes=minutes))
        try:
            return zoneinfo.ZoneInfo(self.zone)
        except (zoneinfo.ZoneInfoNotFoundError, ValueError, OSError, LookupError):
            raise ValueError(f"zone = {self.zone!r}: expected a name such as Europe/Berlin, UTC, or an offset such as +01:00") from None

    def epoch_ns(self) -> int:
        """Return the time of a cell of 0 [ns since 1970]."""
        if self.epoch is None:
            return 0
        try:
            return nanoseconds(datetime.datetime.fromisoformat(str(self.epoch)))
        except (ValueError, OverflowError):
            raise ValueError("epoch: expected a date such as 2019-03-12 or 2019-03-12T06:00:00Z") from None


def nanoseconds(moment: datetime.datetime) -> int:
    """Return a moment in nanoseconds since 1970; UTC if it has no zone."""
    zoned = moment if moment.tzinfo is not None else moment.replace(tzinfo=datetime.UTC)
    return (zoned - datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)) // datetime.timedelta(microseconds=1) * 1000


@record
class SumLoad:
    """Load along +y: the sum of the columns."""

    law: Literal["sum"] = "sum"
    columns: tuple[ForceColumn, ...]  # of forces
    negative: Literal["refuse", "magnitude", "direction"] = "refuse"  # what a sum below 0 is: no load, one of that magnitude, or one along -y

    def load(self, speed: float, forces: Sequence[float]) -> float:
        """Return the load [N] at a shaft speed [rad/s] for the values of `columns` [N]; raise `_BadCell` where there is none."""
        load = math.fsum(forces)
        if load >= 0.0 or self.negative == "direction":
            return load
        if self.negative == "magnitude":
            return -load
        choice = "a radial load is a magnitude; --set radial_load.negative=magnitude takes it without its sign, =direction as a load along -y"
        raise _BadCell("negative", f"{load:.6g} N is negative: {choice}")


@record
class NormLoad:
    """Load along +y: the Euclidean norm of the columns."""

    law: Literal["norm"] = "norm"
    columns: tuple[ForceColumn, ...]  # of forces

    def load(self, speed: float, forces: Sequence[float]) -> float:
        """Return the load [N]; see `SumLoad.load`."""
        return math.hypot(*forces)


@record
class MassTimesAcceleration:
    """Load along +y: a supported mass times the Euclidean norm of the accelerations."""

    law: Literal["mass_times_acceleration"] = "mass_times_acceleration"
    mass: Annotated[float, Quantity("kg", "mass that the bearing supports", 1e-6, 1e6)]
    accelerations: tuple[AccelerationColumn, ...]  # columns

    @property
    def columns(self) -> tuple:
        """The columns that the load is computed from."""
        return self.accelerations

    def load(self, speed: float, accelerations: Sequence[float]) -> float:
        """Return the load [N] for the values of `columns` [m/s^2]."""
        return self.mass * math.hypot(*accelerations)


@record
class GearForce:
    """Load along +y: a share of the force of a gear on its shaft, by the power or the torque that it transmits.

    The tangential force is F_t = 2 T/d, with T = P/(efficiency omega) and the row's shaft speed omega where the power is measured; the mesh
    force across the shaft is F_t sqrt(1 + (tan alpha_n/cos beta)^2) with the normal pressure angle alpha_n and the helix angle beta.  The
    bearing carries ``share`` of it and, at right angles to that, ``dead_weight``.
    """

    law: Literal["gear_force"] = "gear_force"
    power: PowerColumn | None = None  # column of the power that the gear transmits
    torque: TorqueColumn | None = None  # or column of the torque at the gear
    efficiency: Annotated[float, Quantity("", "power that is measured over power through the gear; with power only", 0.01, 1.0)] | None = None
    pitch_diameter: Annotated[float, Quantity("m", "pitch diameter of the gear, d", 1e-3, 100.0, "mm")]
    pressure_angle: Annotated[float, Quantity("rad", "normal pressure angle of the teeth, alpha_n", 0.0, 0.8, "deg")] = 0.0
    helix_angle: Annotated[float, Quantity("rad", "helix angle of the teeth, beta", -1.2, 1.2, "deg")] = 0.0
    share: Annotated[float, Quantity("", "part of the mesh force that this bearing carries", 0.0, 10.0)] = 1.0
    dead_weight: Annotated[float, Quantity("N", "weight on this bearing, across the mesh force", 0.0, 1e7)] = 0.0

    @check
    def _knows_its_torque(self) -> list[str]:
        if (self.power is None) == (self.torque is None):
            return ["expected either power, or torque"]
        if (self.power is None) != (self.efficiency is None):
            return ["efficiency: missing"] if self.torque is None else ["efficiency goes with power only; the torque is that at the gear"]
        return []

    def force(self, torque: float) -> float:
        """Return the load [N] at a torque [N m]."""
        across = math.hypot(1.0, math.tan(self.pressure_angle) / math.cos(self.helix_angle))
        return math.hypot(self.share * across * 2 * torque / self.pitch_diameter, self.dead_weight)

    @property
    def columns(self) -> tuple:
        """The columns that the load is computed from."""
        return (self.power or self.torque,)

    def load(self, speed: float, measured: Sequence[float]) -> float:
        """Return the load [N] at a shaft speed [rad/s] for a power [W] or a torque [N m]; raise `_BadCell` where there is none."""
        (number,) = measured
        if self.torque is not None or number == 0.0:
            return self.force(number)
        if not abs(speed) > 0.0:  # also NaN, where the row's speed could not be read
            raise _BadCell("no_speed", "power without a shaft speed other than zero gives no force")
        return self.force(number / (self.efficiency * abs(speed)))


@record
class ConstantLoad:
    """Load along +y: one value throughout, where no load was measured."""

    law: Literal["constant"] = "constant"
    value: Annotated[float, Quantity("N", "radial load throughout", 0.0, 1e8)]

    @property
    def columns(self) -> tuple:
        """There are none."""
        return ()

    def load(self, speed: float, measured: Sequence[float]) -> float:
        """Return the load [N]."""
        return self.value


@record
class Mapping:
    """How the columns of a table become the messages of a log."""

    name: str  # name of the mapping
    description: str = ""  # what the table is, in a sentence
    source: str = ""  # where it comes from
    delimiter: str | None = None  # between cells: one character, or tab; by default found in the header
    decimal: Literal[".", ","] | None = None  # mark of numbers; by default found in the cells, and asked for where they may mean both
    thousands: Literal[".", ",", "apostrophe", "space"] | None = None  # between groups of three digits; by default found in the cells, likewise
    sheet: str = ""  # of a workbook; by default the only one
    encoding: str | None = None  # of the file, such as utf-8 or latin-1; by default that of its byte-order mark, UTF-8, or Latin-1
    only: dict[str, str] = field(default_factory=dict)  # column: text that its cell must have; other rows are left out
    time: TimeColumn  # of each row
    shaft_speed: SpeedColumn  # column, or constant
    # columns and the law by which they give the load along +y, or a constant
    radial_load: Annotated[SumLoad | NormLoad | MassTimesAcceleration | GearForce | ConstantLoad, Field(discriminator="law")]
    oil_temperature: TemperatureColumn | None = None  # column, or constant
    inner_ring_temperature: TemperatureColumn | None = None  # as measured
    outer_ring_temperature: TemperatureColumn | None = None  # as measured
    cage_speed: SpeedColumn | None = None  # as measured; compared with the model, not an input of it
    running_clearance: ClearanceColumn | None = None  # as measured, diametral; likewise

    @check
    def _is_complete(self) -> list[str]:
        if self.delimiter is not None and self.delimiter != "tab" and len(self.delimiter) != 1:
            return [f"delimiter = {self.delimiter!r}: expected one character, such as ';', or tab"]
        if self.delimiter is not None and self.delimiter == self.decimal:
            return ["delimiter: expected a character other than the decimal mark"]
        if self.thousands is not None and self.thousands == (self.decimal or "."):
            return [f"thousands = {self.thousands!r}: expected another mark than the decimal one, decimal: {self.decimal or '.'!r}"]
        if self.shaft_speed.constant is not None and isinstance(self.radial_load, ConstantLoad):
            return ["shaft_speed and radial_load are constants, so that nothing is left of the table; `bearing-sim run` takes them"]
        for name in _RESULTS.values():
            if getattr(self, name) is not None and getattr(self, name).constant is not None:
                return [f"{name}: expected a column; a constant is no measurement"]
        if any(one.constant is not None for one in self.radial_load.columns):
            return ["radial_load: expected columns; a load that was not measured has law: constant and a value"]
        if isinstance(self.radial_load, ConstantLoad) or self.radial_load.columns:
            return []
        return [f"radial_load: the law {self.radial_load.law} needs at least one column"]

    def columns(self) -> list[tuple[str, object]]:
        """Return (path in the mapping, record) of every column of numbers."""
        named = [("shaft_speed", self.shaft_speed), *(("radial_load", one) for one in self.radial_load.columns)]
        named += [(name, getattr(self, name)) for name in (*topics.TEMPERATURES, *_RESULTS.values())]
        return [(where, one) for where, one in named if one is not None and one.constant is None]

    def column_names(self) -> list[tuple[str, str]]:
        """Return (path in the mapping, name) of every column that is used."""
        named = [(f"only.{name}", name) for name in self.only] + [("time.column", self.time.column)]
        named += [("time.time_of_day", self.time.time_of_day)] * bool(self.time.time_of_day)
        return named + [(where if where == "radial_load" else f"{where}.column", one.column) for where, one in self.columns()]


def load_mapping(mapping: str | Path, overrides: Iterable[str] = ()) -> tuple[Mapping, str]:
    """Load a mapping by bundled name or file path.

    Parameters
    ----------
    mapping : name or path.
    overrides : texts such as ``"radial_load={law: constant, value: 800 N}"``, applied in order over the file.

    Returns
    -------
    The mapping and its text, to which overrides are added as comments.

    Raises
    ------
    SceneError
        The file is missing, is not YAML, or has errors; all of them are listed.
    """
    text, _ = read_named(mapping, "catalog/mappings", "mapping")
    overrides = list(overrides)
    noted = "".join(f"# overridden: {override}\n" for override in overrides)
    return mapping_from_yaml(text, str(mapping), overrides), f"{text}{noted}" if text.endswith("\n") or not noted else f"{text}\n{noted}"


def mapping_from_yaml(text: str, origin: str = "mapping", overrides: Iterable[str] = ()) -> Mapping:
    """Build a mapping from YAML text (see `load_mapping`)."""
    tree = yaml_mapping(text, origin, "time, shaft_speed, radial_load ...")
    for override in overrides:
        _apply_override(tree, override)
    try:
        return TypeAdapter(Mapping).validate_python(tree, context={"written": True})
    except ValidationError as error:
        raise SceneError(origin, invalid_fields(error, Mapping)) from None


def _apply_override(tree: dict, override: str) -> None:
    """Set a field of a mapping's tree, ``path=value`` with a YAML value; a block that is replaced by a constant loses its other fields."""
    path, equals, text = override.partition("=")
    *blocks, name = (key.strip() for key in path.split("."))
    if not equals or not name or not all(blocks):
        raise SceneError("--set", [InvalidField(path, "", "expected FIELD=VALUE, such as radial_load.pitch_diameter=400mm")])
    for block in blocks:
        inner = tree.get(block) or {}
        if not isinstance(inner, dict):
            raise SceneError("--set", [InvalidField(path, repr(inner), f"{block} is a value, not a block")])
        tree[block] = tree = dict(inner)
    try:
        tree[name] = yaml_mapping(f"value: {text}", "--set", "FIELD=VALUE")["value"]
    except SceneError:
        tree[name] = text.strip()


class _TimeOutOfRange(ValueError):
    """A time that no stamp can hold."""


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
    tally : rows of data, without the header and those that ``only`` leaves out (``left_out``); one is used if nothing that is in it was refused.
        Reasons are ``time.*``, which cost a whole row, and ``shaft_speed.*`` and so on, which cost one message.  An empty cell is counted and costs
        its message, but nothing was there that could be used.
    stamps : by channel [ns since 1970], rising.
    values : by channel, in SI; the load along +y.
    examples : by kind, the first few (line number, what is wrong).
    lines : by channel, the line number of each message.
    gaps : (channel, line number, seconds) of messages that come too long after the one before.
    longest_step : spacing [s] above which there is a gap.
    spacing : usual spacing of rows, the median [s].
    notes : what was found in the file and is not in the mapping, and what contradicts it, in words.
    faulty_line : number of the last line with an error.
    """

    tally: Tally = field(default_factory=lambda: Tally("rows"))
    left_out: int = 0
    stamps: dict[str, Sequence[int]] = field(default_factory=dict)
    values: dict[str, Sequence[float]] = field(default_factory=dict)
    examples: dict[str, list[tuple[int, str]]] = field(default_factory=dict)
    lines: dict[str, Sequence[int]] = field(default_factory=dict)
    gaps: list[tuple[str, int, float]] = field(default_factory=list)
    longest_step: float = math.nan
    spacing: float = math.nan
    notes: list[str] = field(default_factory=list)
    faulty_line: int = -1

    def refuse(self, kind: str, line: int, text: str) -> None:
        """Count an error and keep it as an example if it is among the first of its kind."""
        self.tally.refused[kind] += 1
        if not _was_never_there(kind):
            self.faulty_line = line
        if len(examples := self.examples.setdefault(kind, [])) < _LINES_KEPT:
            examples.append((line, text))


def read_table(path: str | Path, mapping: Mapping) -> Table:
    """Read a table as a mapping describes it.

    Parameters
    ----------
    path : a CSV file, a Parquet file, or the folder of a Parquet data set.
    mapping : which of its columns are what.

    Raises
    ------
    TableError
        The file is missing, not text, or has no header; columns are missing (all of them are named); a number may mean two things; or no row
        can be used.
    """
    table, path, times = Table(), Path(path), []
    layout, rows = _rows_of(path, mapping)
    rows = iter(rows)
    first = list(itertools.islice(rows, _ROWS_LOOKED_AT))
    row_reader = _RowReader(mapping, layout, table)
    row_reader.has_rounded_times = row_reader.repeat_their_times(first)
    lines = array("q")
    for line, cells in itertools.chain(first, rows):
        if cells and row_reader.accept(line, cells):  # an empty line is no row
            times.append(row_reader.newest)
            lines.append(line)
            table.tally.used += table.faulty_line != line
    if row_reader.has_rounded_times and len(set(times)) > 2:
        times = _spread(np.array(times)).tolist()
        stamps = dict(zip(lines, times))
        table.stamps = {channel: array("q", map(stamps.__getitem__, own)) for channel, own in table.lines.items()}
        table.notes.append(
            f"times are rounded, several rows have the same; a row every {(times[-1] - times[0]) * 1e-9 / (len(times) - 1):.4g} s by their mean"
        )
    refused = table.tally.refused
    table.notes += [*layout.found, *filter(None, (one.contradiction(layout.cell_units.get(one.column, "")) for _, one in mapping.columns()))]
    if layout.comments:
        table.notes.append(f"{layout.comments} line{'s' * (layout.comments > 1)} before the header or of comments left out")
    missing = [channel for channel in ("shaft_speed", "radial_load") if not table.stamps.get(channel)]
    if missing:
        why = ", ".join(_with_example(table, kind) for kind in refused) or "it has no rows" + " that match `only`" * bool(mapping.only)
        raise TableError(f"{path}: nothing usable for {' and '.join(missing)}: {why}")
    if refused["time.backwards"] >= len(times) > 0:
        why = f"{len(times)} rows rise in time, {refused['time.backwards']} go back; sort them by time, or choose one machine (only, --only)"
        raise TableError(f"{path}, line {table.examples['time.backwards'][0][0]}: {why}")
    _find_gaps(table, mapping, np.diff(times) * 1e-9)
    table.notes += filter(None, (_stuck(table, channel) for channel in table.values))
    return table


def _spread(times: np.ndarray) -> np.ndarray:
    """Return times for rows whose own are rounded, so that several have the same [ns, shape (n,)]: evenly between those at which they change.

    Rows are even where that stays within the step to which times are rounded.  A step of twice that is a gap.
    """
    begins = np.flatnonzero(np.diff(times)) + 1  # rows with a new time
    steps, counts = np.diff(times[begins]), np.diff(begins)
    resolution = np.median(steps)
    whole = steps < 1.5 * resolution
    spacing = steps[whole].sum() / max(counts[whole].sum(), 1)
    found = np.empty(len(times))
    for rows in np.split(np.arange(len(times)), np.flatnonzero(np.diff(times) > 1.5 * resolution) + 1):
        known = begins[(begins > rows[0]) & (begins <= rows[-1])]
        if len(known) < 2:
            found[rows] = times[rows[-1]] + (rows - (known[0] if len(known) else rows[0])) * spacing
            continue
        even = np.interp(rows, known[[0, -1]], times[known[[0, -1]]])
        if np.abs(even - times[rows])[(rows >= known[0]) & (rows <= known[-1])].max() > resolution:
            even = np.interp(rows, known, times[known])
        even += np.minimum(rows - known[0], 0) * spacing + np.maximum(rows - known[-1], 0) * spacing
        found[rows] = even
    order = np.arange(len(times))
    rising = np.maximum.accumulate(np.rint(found).astype(np.int64) - order) + order
    return rising + max(0, -int(rising[0]))


def _stuck(table: Table, channel: str) -> str:
    """Return in words for how long a signal that otherwise changes repeats one value, as that of a sensor that sticks; empty if it never does.

    It is told, and not left out: a controlled speed may be as constant.  A value of 0 is one of a machine at rest.
    """
    values = np.asarray(table.values[channel])
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    rows = np.diff(starts, append=len(values))
    moving = values[starts] != 0.0
    usual = float(np.median(rows[moving])) if moving.any() else math.inf
    stuck = np.flatnonzero(moving & (rows >= max(_STUCK_ROWS, _STUCK_SPELLS * usual)))
    if not len(stuck):
        return ""
    first = starts[stuck[0]]
    last = first + rows[stuck[0]] - 1
    seconds = (table.stamps[channel][last] - table.stamps[channel][first]) * 1e-9
    more = f", and {len(stuck) - 1} more time{'s' * (len(stuck) > 2)}" if len(stuck) > 1 else ""
    value = shown(channel, (values[first],))
    where = f"from line {table.lines[channel][first]} on for {seconds:.6g} s{more}"
    return f"{channel} is {value} {where}: constant conditions, or a sensor that sticks; its values are used"


def _rows_of(path: Path, mapping: Mapping) -> tuple[Layout, Iterable[tuple[int, list[str]]]]:
    """Return how a table is laid out and its rows, (number, cells)."""
    if not is_parquet(path):
        layout = layout_of(path, mapping)
        return layout, records(layout)
    layout = parquet_layout(path, mapping.column_names(), Marks(mapping.decimal or ".", mapping.thousands or ""))
    takes_timestamps = mapping.time.format == "iso" and not mapping.time.time_of_day
    return layout, parquet_records(path, layout, mapping.only, mapping.time.column, takes_timestamps)


def input_log(table: Table, path: Path) -> InputLog:
    """Return a table as an input log, as if it had been written by `write_log` and read again."""
    series = {}
    for channel, stamps in table.stamps.items():
        values = [(value,) for value in table.values[channel]]
        series[channel] = Series(path.name, "column of a table", "header", list(stamps), list(stamps), values)
    lost = Counter({kind: count for kind, count in table.tally.refused.items() if not _was_never_there(kind)})
    lost = Tally(there=lost.total(), refused=lost)
    return InputLog(path, series, lost)


def _was_never_there(kind: str) -> bool:
    """Return whether a reason means that a channel has no value in a row, which is no fault of what was read."""
    return kind.endswith(".empty_cell") and not kind.startswith("time.")


def _with_example(table: Table, kind: str) -> str:
    """Return how often an error occurred, and the first of its kind."""
    line, text = table.examples[kind][0]
    return f"{table.tally.refused[kind]} x {kind} (line {line}: {text})"


def layout_of(path: Path, mapping: Mapping) -> Layout:
    """Return how a table is laid out, as the mapping says and, where it does not, as the file has it.

    Raises
    ------
    TableError
        See `read_table`.
    """
    layout = first_look(path, mapping.encoding, mapping.sheet)
    if mapping.encoding is None and layout.encoding not in EXPECTED_ENCODINGS:
        layout.found.append(f"encoding: {layout.encoding}, since it is not UTF-8")
    find_header(layout, mapping.column_names(), "\t" if mapping.delimiter == "tab" else mapping.delimiter)
    numbers = [one.column for _, one in mapping.columns()] + [mapping.time.column] * (mapping.time.format is None)
    try:
        for _, one in mapping.columns():
            one.contradiction(layout.cell_units.get(one.column, ""))
        layout.marks = number_marks(cells_in(layout, numbers), layout.delimiter, mapping.decimal, mapping.thousands)
    except TableError as error:
        raise TableError(f"{path}, {error}") from None
    layout.found += layout.marks._replace(
        decimal="." if mapping.decimal else layout.marks.decimal, thousands="" if mapping.thousands else layout.marks.thousands
    ).described
    return layout


class _RowReader:
    """Adds rows to a table as a mapping describes them."""

    def __init__(self, mapping: Mapping, layout: Layout, table: Table):
        columns = {name: column for column, name in enumerate(layout.names)}
        self._table, self._width = table, len(layout.names)
        self._marks = layout.marks
        self._only = [(columns[name], text) for name, text in mapping.only.items()]
        self._time = time_reader(mapping.time, self._marks)
        self._units = {columns[name]: unit for name, unit in layout.cell_units.items()}
        self._time_columns = [columns[name] for name in (mapping.time.column, mapping.time.time_of_day) if name]
        self._load_columns = [(columns[one.column], one.column, *one.line()) for one in mapping.radial_load.columns]
        self._load = mapping.radial_load.load
        self._speed = self._value_reader(mapping.shaft_speed, columns)
        optional = {channel: getattr(mapping, name) for channel, name in (*zip(topics.TEMPERATURES, topics.TEMPERATURES), *_RESULTS.items())}
        self._optional = {channel: self._value_reader(one, columns) for channel, one in optional.items() if one}
        self.newest: int | None = None
        self.has_rounded_times = False

    def _value_reader(self, one, columns: dict[str, int]) -> Callable[[list[str]], float]:
        """Return the function that reads a channel's value from the cells of a row."""
        if one.constant is not None:
            return lambda cells: one.constant
        place = (columns[one.column], one.column, *one.line())
        return lambda cells: self._cell(cells, *place)

    def repeat_their_times(self, rows: Iterable[tuple[int, list[str]]]) -> bool:
        """Return whether so many rows repeat the time of the row before that times are rounded, and it is not another machine's row."""
        own = [cells for _, cells in rows if len(cells) == self._width and self._is_wanted(cells)]
        pairs = [pair for pair in itertools.pairwise(own) if all(pair[0][column] == pair[1][column] for column in self._time_columns)]
        others = sum(any(one != two and not _LIKE_A_NUMBER.match(one) for one, two in zip(*pair)) for pair in pairs)
        return len(pairs) > _ROUNDED * len(own) and 2 * others <= len(pairs)

    def _is_wanted(self, cells: list[str]) -> bool:
        return all(cells[column].strip() == text for column, text in self._only)

    def accept(self, line: int, cells: list[str]) -> bool:
        """Add one row; return whether its time is good."""
        if len(cells) == self._width and not self._is_wanted(cells):
            self._table.left_out += 1
            return False
        self._table.tally.there += 1
        time_ns = self._time_of(line, cells)
        if time_ns is None:
            return False
        self.newest = time_ns
        speed = self._number("shaft_speed", line, time_ns, lambda: self._speed(cells))
        self._number("radial_load", line, time_ns, lambda: self._load(speed, [self._cell(cells, *column) for column in self._load_columns]))
        for channel, read in self._optional.items():
            self._number(channel, line, time_ns, lambda read=read: read(cells))
        return True

    def _time_of(self, line: int, cells: list[str]) -> int | None:
        """Return the row's time if it can be used, otherwise count the error."""
        refuse = self._table.refuse
        if len(cells) != self._width:
            refuse("time.cells", line, f"{len(cells)} cells, expected {self._width}")
            return None
        text = " ".join(cells[column].strip().removesuffix(self._units.get(column, "")).rstrip() for column in self._time_columns).strip()
        try:
            time_ns = self._time(text, self.newest)
        except _TimeOutOfRange:
            refuse("time.out_of_range", line, f"{text[:_SHOWN]!r} is not within 1970 to 2038, which stamps can hold; see epoch in the mapping")
            return None
        except (ValueError, ArithmeticError):
            refuse("time.unreadable" if text else "time.empty_cell", line, f"{text[:_SHOWN]!r} is not a time" if text else "the time is empty")
            return None
        if self.newest is not None and time_ns <= self.newest and not (self.has_rounded_times and time_ns == self.newest):
            back = (self.newest - time_ns) * 1e-9
            if back:
                refuse("time.backwards", line, f"{text[:_SHOWN]} lies {back:.6g} s before the last row used")
            else:
                refuse("time.repeated", line, f"{text[:_SHOWN]} repeats the time of the last row used")
            return None
        return time_ns

    def _number(self, channel: str, line: int, time_ns: int, read: Callable[[], float]) -> float:
        """Return one channel's value and keep it if it can be used, otherwise count the error and return NaN."""
        try:
            value = read()
        except _BadCell as error:
            self._table.refuse(f"{channel}.{error.kind}", line, str(error))
            return math.nan
        except OverflowError:
            value = math.inf
        if not math.isfinite(value):  # as the sum of cells that are
            self._table.refuse(f"{channel}.not_finite", line, f"{channel} is not finite in SI")
            return math.nan
        # A force may point along -y; what else a replay of any bearing refuses is no value either.
        if refusal := value_refusal(channel, (abs(value) if channel == "radial_load" else value,), _LIMITS):
            kind, reason = refusal
            self._table.refuse(f"{channel}.{kind.removeprefix('input.')}", line, reason)
            return math.nan
        self._table.stamps.setdefault(channel, array("q")).append(time_ns)
        self._table.values.setdefault(channel, array("d")).append(value)
        self._table.lines.setdefault(channel, array("q")).append(line)
        return value

    def _cell(self, cells: list[str], column: int, name: str, scale: float, offset: float) -> float:
        text = cells[column].strip()
        if not text:
            raise _BadCell("empty_cell", f"{name} is empty")
        try:
            number = float(self._marks.plain(text.removesuffix(self._units.get(column, "")).rstrip()))
        except ValueError:
            raise _BadCell("not_a_number", f"{name} = {text[:_SHOWN]!r} is not a number") from None
        if not math.isfinite(number):
            raise _BadCell("not_finite", f"{name} = {text[:_SHOWN]} is not finite")
        if number <= _ERROR_CODES_FROM and _ERROR_CODE.fullmatch(f"{number:.12g}"):
            raise _BadCell("error_code", f"{name} = {text[:_SHOWN]}, by which loggers say that there is no value")
        value = offset + scale * number
        if not math.isfinite(value):
            raise _BadCell("not_finite", f"{name} = {text[:_SHOWN]} is not finite in SI")
        return value


def time_reader(time: TimeColumn, marks: Marks) -> Callable[[str, int | None], int]:
    """Return a function that converts a time cell to nanoseconds since 1970; it also takes the time of the row before, or None.

    In the hour that is told twice when the clocks are set back, a time that would not rise is the later one.

    Parameters
    ----------
    time : how times are written.
    marks : how numbers are written.
    """
    if time.format is not None:
        zone, is_iso = time.zone_info(), time.format == "iso"

        def of_timestamp(text: str, newest: int | None) -> int:
            moment = datetime.datetime.fromisoformat(text) if is_iso else datetime.datetime.strptime(text, time.format)
            if moment.tzinfo is not None:
                return _stamp(nanoseconds(moment))
            told = nanoseconds(moment.replace(tzinfo=zone))
            return _stamp(told if newest is None or told > newest else nanoseconds(moment.replace(tzinfo=zone, fold=1)))

        return of_timestamp
    # Decimal keeps every digit of a time; a float would lose nanoseconds.
    factor, epoch = Decimal(repr(time.nanoseconds_per_unit())), time.epoch_ns()

    def of_number(text: str, newest: int | None) -> int:
        since_epoch = Decimal(marks.plain(text)) * factor
        if since_epoch.is_finite() and abs(since_epoch) >= _LONGEST_TIME:  # before it becomes an integer of 990,000 digits
            raise _TimeOutOfRange
        return _stamp(epoch + round(since_epoch))

    return of_number


def _stamp(time_ns: int) -> int:
    """Return a time [ns since 1970] that a stamp can hold; raise `_TimeOutOfRange` for another."""
    if not 0 <= time_ns < _TIMES_END:
        raise _TimeOutOfRange
    return time_ns


def _find_gaps(table: Table, mapping: Mapping, row_spacings: np.ndarray) -> None:
    table.spacing = float(np.median(row_spacings)) if len(row_spacings) else math.nan
    usual = _USUAL_SPACINGS * table.spacing
    table.longest_step = mapping.time.longest_step if mapping.time.longest_step is not None else usual
    for channel, stamps in table.stamps.items():
        spacings = np.diff(stamps) * 1e-9
        # A nanosecond of slack: times are rounded to nanoseconds.
        for k in np.flatnonzero(spacings > table.longest_step + 1e-9):
            table.gaps.append((channel, table.lines[channel][k + 1], float(spacings[k])))


def _messages(channel: str, stamps: Sequence[int]) -> Iterator[tuple[int, str, int]]:
    """Yield (stamp, channel, position) of the messages of a channel."""
    for position, stamp in enumerate(stamps):
        yield stamp, channel, position


def write_log(
    table: Table,
    mapping_text: str,
    source: str | Path,
    out: str | Path,
    progress: Callable[[float], None] = lambda done: None,
    replace: bool = True,
) -> None:
    """Write a table as an input log, each channel at its own stamps, in order of time.

    Parameters
    ----------
    table : see `read_table`.
    mapping_text : the mapping's YAML, for the metadata.
    source : the table's file; its name and checksum go into the metadata.
    out : the recording to write.
    progress : called now and then with the number of messages written.
    replace : whether an existing recording is replaced.
    """
    origin = {"package_version": package_version(), "git_hash": git_hash()}
    files = sorted(Path(source).rglob("*.parquet")) if Path(source).is_dir() else [Path(source)]
    metadata = {"mapping": mapping_text, "file": Path(source).name, "sha256": checksum(files), **origin}
    messages = heapq.merge(*(_messages(channel, stamps) for channel, stamps in table.stamps.items()))  # each rises
    with McapFile(out, {METADATA: metadata}, {"generator": "bearing_sim", **origin}, replace=replace) as recording:
        for done, (stamp, channel, k) in enumerate(messages):
            topic, value = (topics.INPUTS | topics.MEASUREMENTS)[channel], table.values[channel][k]
            content = (value,) if channel in _RESULTS else with_values(Inputs(0.0, 0.0, 0.0, 0.0), channel, (value,))
            recording.write(f"/{topic.name}", topic.ros_type, stamp, topic.message(stamp, content))
            if done % 1000 == 0:
                progress(done)
