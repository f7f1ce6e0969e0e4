# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Mappings: which columns of a measured table are time, shaft speed, radial load, oil temperature and cage speed, and in which units.

A mapping is a YAML file of these records.  Nothing in it is evaluated: each input is one of a few fixed laws of columns.
"""

import datetime
import math
from importlib import resources
from pathlib import Path
from typing import Annotated, Literal

from pydantic import Field, TypeAdapter, ValidationError, model_validator
from pydantic_core import PydanticCustomError

from bearing_sim.quantity import quantity, to_si
from bearing_sim.scene_file import Fault, SceneError, did_you_mean, faults_of, yaml_mapping
from bearing_sim.scene_record import record

_LAWS = frozenset({"sum", "norm", "mass_times_acceleration", "gear_force"})


class MappingError(SceneError):
    """A mapping that cannot be used; ``faults`` lists everything that is wrong with it."""


def _column(si_unit: str, meaning: str) -> type:
    """Return the record of a column of one kind: SI value = scale x cell + offset, or the cell in a named unit."""

    @record
    class Column:
        """One column: either ``unit``, or ``scale`` (SI per one in the cell) and ``offset``."""

        column: str
        unit: str | None = None
        scale: quantity(si_unit, f"{meaning} for one in the cell") | None = None
        offset: quantity(si_unit, f"{meaning} for zero in the cell") | None = None

        @model_validator(mode="after")
        def _converts(self):
            if (self.unit is None) == (self.scale is None):
                raise PydanticCustomError("conversion", "expected either unit, or scale (and offset)")
            if self.unit is not None and self.offset is not None:
                raise PydanticCustomError("conversion", "expected no offset beside unit; give scale and offset instead")
            if self.scale is not None and not (math.isfinite(self.scale) and math.isfinite(self.offset or 0.0)):
                raise PydanticCustomError("conversion", "expected a finite scale and offset")
            self.line()  # a unit that does not fit is a fault of the mapping, not of the data
            return self

        def line(self) -> tuple[float, float]:
            """Return (scale, offset) in SI."""
            if self.unit is None:
                return self.scale, self.offset or 0.0
            try:
                offset = to_si(f"0 {self.unit}", si_unit)
                return to_si(f"1 {self.unit}", si_unit) - offset, offset
            except ValueError as fault:
                raise PydanticCustomError("conversion", "{reason}", {"reason": str(fault)}) from None

    return Column


SpeedColumn = _column("rad/s", "shaft speed")
ForceColumn = _column("N", "force")
AccelerationColumn = _column("m/s^2", "acceleration")
TemperatureColumn = _column("K", "oil temperature")
PowerColumn = _column("W", "power")


@record
class TimeColumn:
    """The time of each row: numbers in a ``unit`` since ``epoch``, or timestamps in a ``format``."""

    column: str
    unit: str | None = None
    format: str | None = None  # "iso", or strptime's letters; a timestamp without zone is UTC
    epoch: datetime.datetime | datetime.date | str | None = None
    longest_step: quantity("s", "spacing of rows above which there is a gap", 0.0) | None = None

    @model_validator(mode="after")
    def _reads_one_way(self):
        if (self.unit is None) == (self.format is None):
            raise PydanticCustomError("time", "expected either unit (numbers), or format (timestamps)")
        if self.format is not None and self.epoch is not None:
            raise PydanticCustomError("time", "expected no epoch beside format: timestamps say their own date")
        if self.unit is not None:
            self.nanoseconds_per_unit()
            self.epoch_ns()
        return self

    def nanoseconds_per_unit(self) -> float:
        """Return how many nanoseconds one in the cell is."""
        try:
            return to_si(f"1 {self.unit}", "s") * 1e9
        except ValueError as fault:
            raise PydanticCustomError("time", "{reason}", {"reason": str(fault)}) from None

    def epoch_ns(self) -> int:
        """Return what a cell of zero means [ns since 1970]."""
        if self.epoch is None:
            return 0
        try:
            return nanoseconds(datetime.datetime.fromisoformat(str(self.epoch)))
        except ValueError:
            raise PydanticCustomError("time", "epoch: expected a date such as 2019-03-12 or 2019-03-12T06:00:00Z") from None


def nanoseconds(moment: datetime.datetime) -> int:
    """Return nanoseconds since 1970 of a moment; UTC where it names no zone."""
    zoned = moment if moment.tzinfo is not None else moment.replace(tzinfo=datetime.UTC)
    return (zoned - datetime.datetime(1970, 1, 1, tzinfo=datetime.UTC)) // datetime.timedelta(microseconds=1) * 1000


@record
class SumLoad:
    """Load along +y: the sum of the columns."""

    law: Literal["sum"] = "sum"
    columns: tuple[ForceColumn, ...]


@record
class NormLoad:
    """Load along +y: the length of the vector of the columns."""

    law: Literal["norm"] = "norm"
    columns: tuple[ForceColumn, ...]


@record
class MassTimesAcceleration:
    """Load along +y: a supported mass times the length of the vector of the accelerations."""

    law: Literal["mass_times_acceleration"] = "mass_times_acceleration"
    mass: quantity("kg", "mass that the bearing supports", 1e-6, 1e6)
    accelerations: tuple[AccelerationColumn, ...]


@record
class GearForce:
    """Load along +y: tangential force of a gear on the shaft, F = 2 P/(efficiency omega d), omega the row's shaft speed."""

    law: Literal["gear_force"] = "gear_force"
    power: PowerColumn
    efficiency: quantity("", "power out over power through the gear", 0.01, 1.0)
    pitch_diameter: quantity("m", "pitch diameter of the gear, d", 1e-3, 100.0, "mm")


@record
class Mapping:
    """How a table becomes a log."""

    name: str
    description: str = ""
    source: str = ""
    delimiter: Annotated[str, Field(min_length=1, max_length=1)] = ","
    decimal: Literal[".", ","] = "."
    only: dict[str, str] = Field(default_factory=dict)  # column: text that the cell must have; other rows are left out
    time: TimeColumn
    shaft_speed: SpeedColumn
    radial_load: Annotated[SumLoad | NormLoad | MassTimesAcceleration | GearForce, Field(discriminator="law")]
    oil_temperature: TemperatureColumn | None = None
    cage_speed: SpeedColumn | None = None  # as measured; no input of the model, but what it is held against

    @model_validator(mode="after")
    def _is_complete(self):
        if self.delimiter == self.decimal:
            raise ValueError("delimiter: expected another character than the decimal mark")
        if not self.load_columns():
            raise ValueError(f"radial_load: the law {self.radial_load.law} needs at least one column")
        return self

    def load_columns(self) -> tuple:
        """Return the column records that the load is made of."""
        load = self.radial_load
        if isinstance(load, MassTimesAcceleration):
            return load.accelerations
        return (load.power,) if isinstance(load, GearForce) else load.columns

    def column_names(self) -> list[tuple[str, str]]:
        """Return (path in the mapping, name) of every column that is used."""
        named = [(f"only.{name}", name) for name in self.only]
        named += [("time.column", self.time.column), ("shaft_speed.column", self.shaft_speed.column)]
        named += [("radial_load", record.column) for record in self.load_columns()]
        optional = {"oil_temperature": self.oil_temperature, "cage_speed": self.cage_speed}
        return named + [(f"{name}.column", record.column) for name, record in optional.items() if record]


def mapping_names() -> list[str]:
    """Return the names of the bundled mappings."""
    folder = resources.files("bearing_sim").joinpath("catalog", "mappings")
    return sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))


def load_mapping(mapping: str | Path) -> tuple[Mapping, str]:
    """Load a mapping by bundled name or file path.

    Returns
    -------
    The mapping and its text.

    Raises
    ------
    MappingError
        The file is absent, is no YAML, or holds faults; all of them are listed.
    """
    if str(mapping) in mapping_names():
        text = resources.files("bearing_sim").joinpath("catalog", "mappings", f"{mapping}.yaml").read_text(encoding="utf-8")
    else:
        path = Path(mapping)
        if not path.is_file():
            known = mapping_names()
            reason = f"no such file, and no bundled mapping of that name{did_you_mean(str(mapping), known)}; bundled: {', '.join(known)}"
            raise MappingError(str(mapping), [Fault("mapping", "", reason)])
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError as fault:
            raise MappingError(str(mapping), [Fault("mapping", "", f"not readable as UTF-8 text: {fault.reason}")]) from None
    return mapping_from_yaml(text, str(mapping)), text


def mapping_from_yaml(text: str, origin: str = "mapping") -> Mapping:
    """Build a mapping from YAML text (see `load_mapping`)."""
    try:
        tree = yaml_mapping(text, origin, "time, shaft_speed, radial_load ...")
    except SceneError as fault:
        raise MappingError(origin, fault.faults) from None
    try:
        return TypeAdapter(Mapping).validate_python(tree)
    except ValidationError as error:
        raise MappingError(origin, faults_of(error, Mapping, _LAWS)) from None
