# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Conditions in which a bearing must work: the operating points of a mission or a load spectrum with their weights, and tolerances about them.

A file of points is CSV with the columns ``shaft_speed``, ``radial_load``, ``weight`` and, optionally, ``axial_load`` and temperatures.  Units stand
in brackets behind the names or with each value; delimiter, decimal mark and encoding are found in the file:

    shaft_speed [rpm], radial_load [N], weight, oil_temperature [degC]
    45000, 800, 70%, 120
    39000, 500, 30%, 115

Other headings are read as `import-csv --guess` reads them: ``Drehzahl [1/min];Radiallast [kN];Zeitanteil [%]``.
"""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from bearing_sim.files.limits import POINTS_FILE, POINTS_ROWS, FileError, LimitError
from bearing_sim.scene.errors import shortened
from bearing_sim.scene.quantity import Quantity, to_si
from bearing_sim.scene.scene import OPERATING_POINT, Scene
from bearing_sim.scene.uncertainty import BLOCKS, messages, number_at, with_values
from bearing_sim.sweep.grid import Field, FieldError, field_of

SPEED, LOAD, TEMPERATURE = (OPERATING_POINT[name] for name in ("shaft_speed", "radial_load", "oil_temperature"))
_FIELDS = OPERATING_POINT | {
    "axial_load": "operating.axial_load",
    "inner_ring_temperature": "heat.inner_ring",
    "outer_ring_temperature": "heat.outer_ring",
}
_REQUIRED, _OPTIONAL = ("shaft_speed", "radial_load", "weight"), ("oil_temperature", "axial_load", "inner_ring_temperature", "outer_ring_temperature")
_KNOWN = _REQUIRED + _OPTIONAL
_AXIAL, _WEIGHT = r"axial|^f_?a\b", r"weight|share|fraction|portion|anteil|time|hours|zeit|dauer|duration|stunden|^[qth]_?i?$"
_NUMBER = re.compile(r"([-+\N{MINUS SIGN}]?[\d.,]+)(.*)")
_EXPECTED = "expected speed, load, weight and, optionally, oil temperature, such as '45000 rpm, 800 N, 0.7' or '45000 rpm, 800 N, 70%, 120 degC'"


class PointError(ValueError):
    """An operating point or a tolerance that cannot be used; the message says why and what to write."""


class OperatingPoint(NamedTuple):
    """One condition of a mission.

    Attributes
    ----------
    shaft_speed : [rad/s].
    radial_load : [N].
    weight : time at this point, relative to that at the others.
    oil_temperature : [K]; None: the scene's.  So are the axial load [N] and the temperatures of the rings [K], which need ``heat.law: given``.
    """

    shaft_speed: float
    radial_load: float
    weight: float = 1.0
    oil_temperature: float | None = None
    axial_load: float | None = None
    inner_ring_temperature: float | None = None
    outer_ring_temperature: float | None = None


class Spectrum(NamedTuple):
    """A load spectrum.

    Attributes
    ----------
    points : with the share of time of each, or its hours.
    hours : that the weights add up to, where they are times; None where they are shares.
    resting : weight of the time at rest.
    notes : what was found odd, in words.
    """

    points: tuple[OperatingPoint, ...]
    hours: float | None = None
    resting: float = 0.0
    notes: tuple[str, ...] = ()


class Tolerance(NamedTuple):
    """By how much a field of a scene may be off, in both directions.

    Attributes
    ----------
    field : dotted path.
    amount : in the SI unit of the field, or a fraction of its value.
    relative : whether it is a fraction.
    """

    field: str
    amount: float
    relative: bool = False

    @property
    def text(self) -> str:
        """The tolerance as people write it, in the unit in which the field is shown."""
        if self.relative:
            return f"{self.field} ±{100 * self.amount:g} %"
        field = field_of(self.field)
        unit = _unit_of_difference(field)
        return f"{self.field} ±{self.amount:g} K" if unit == "delta_degC" else f"{self.field} ±{field.shown(self.amount):g} {field.unit}".rstrip()


class Conditions(NamedTuple):
    """Operating points, and tolerances about them.

    Attributes
    ----------
    speed_tolerance, load_tolerance : relative, in both directions.
    tolerances : of other fields, such as dimensions.
    points : of the mission; none: the scene's speed and load.
    """

    speed_tolerance: float = 0.0
    load_tolerance: float = 0.0
    tolerances: tuple[Tolerance, ...] = ()
    points: tuple[OperatingPoint, ...] = ()

    @property
    def nominal(self) -> "Conditions":
        """The same without tolerances."""
        return Conditions(points=self.points)

    @property
    def spread(self) -> str:
        """The tolerances in words."""
        relative = (("speed", self.speed_tolerance), ("load", self.load_tolerance))
        return ", ".join([*(f"{name} ±{100 * amount:g} %" for name, amount in relative), *(each.text for each in self.tolerances)])

    def as_json(self) -> dict:
        """Return the conditions in units that people read, as values that JSON can hold."""
        return {
            "speed_tolerance": self.speed_tolerance,
            "load_tolerance": self.load_tolerance,
            "tolerances": [each.text for each in self.tolerances],
            "spread": self.spread,
            "points": [
                {"share": round(share, 6), "shaft_speed_rpm": field_of(SPEED).shown(each.shaft_speed), "radial_load": each.radial_load}
                | ({} if each.oil_temperature is None else {"oil_temperature_degC": field_of(TEMPERATURE).shown(each.oil_temperature)})
                for share, each in zip(shares(self.points), self.points)
            ],
        }


def read_point(text: str) -> OperatingPoint:
    """Return the operating point of a text such as ``45000 rpm, 800 N, 70%, 120 degC``.

    Raises
    ------
    PointError
        A part is missing, or is not the quantity expected.
    """
    parts = [part.strip() for part in text.split(",")]
    if not len(_REQUIRED) <= len(parts) <= len(_REQUIRED) + 1:
        raise PointError(f"{text!r}: {len(parts)} parts; {_EXPECTED}")
    point = _point(repr(text), dict(zip(_KNOWN, parts)))
    if point.shaft_speed == 0.0:
        raise PointError(f"{text!r}: shaft_speed: 0; {_AT_REST}")
    return point


def read_points(path: Path) -> tuple[OperatingPoint, ...]:
    """Return the operating points of a file, none of them at rest; errors as of `read_spectrum`."""
    spectrum = read_spectrum(path)
    if spectrum.resting:
        raise PointError(f"{path}: shaft_speed: 0; {_AT_REST}")
    return spectrum.points


def read_spectrum(path: Path) -> Spectrum:
    """Return the load spectrum of a CSV file (see the module).

    Raises
    ------
    PointError
        The file cannot be read, or is too long; a column is missing or unknown, a value is not the quantity expected, or there are no points.
    """
    from bearing_sim.inputs.csv_guess import ROLES, Role, headed_columns  # takes a while
    from bearing_sim.inputs.csv_text import first_look, is_unit_of, records

    roles = (Role("axial_load", "N", _AXIAL, r"clearance|spiel"), *(role for role in ROLES if role.field in _KNOWN), Role("weight", "", _WEIGHT))
    try:
        lines = first_look(path).lines
        POINTS_FILE.check(path.stat().st_size, str(path))
        if not any(line.strip() for line in lines[1:]):
            raise PointError(f"{path}: no operating points; expected a heading of {', '.join(_REQUIRED)} and a line for each point")
        layout, columns = headed_columns(path, _KNOWN, roles)
        rows = [(number, cells) for number, cells in records(layout) if any(cell.strip() for cell in cells)]
        POINTS_ROWS.check(len(rows), str(path))
    except LimitError as error:
        raise PointError(f"{error}; {_OVER_TIME}") from None
    except FileError as error:
        raise PointError(str(error)) from None
    names = [name for name, _ in columns]
    for name, heading in zip(names, layout.names):
        if not name or names.count(name) > 1:
            what = f"is {name}, which is given twice" if name else f"is unknown; expected {', '.join(_KNOWN)}"
            raise PointError(f"{path}: column {shortened(repr(heading), 200)} {what}")
    if missing := [name for name in _REQUIRED if name not in names]:
        raise PointError(f"{path}: no column {' and no column '.join(missing)}; expected {', '.join(_REQUIRED)}, each with its unit in brackets")
    points = []
    for number, row in rows:
        if len(row) != len(names):
            raise PointError(f"{path}, line {number}: {len(row)} values for {len(names)} columns")
        written = {}
        for (name, unit), cell in zip(columns, row):
            found = _NUMBER.fullmatch(cell.strip())
            try:
                behind = found[2] if found and found[2].strip() != unit else ""  # a unit may stand behind every number of its column, too
                text = f"{layout.marks.plain(found[1])}{behind}" if found else cell.strip()
            except ValueError:
                text = cell.strip()
            if text or name in _REQUIRED:
                written[name] = f"{text} {unit}".strip()
        points.append(_point(f"{path}, line {number}", written))
    whole, turning = math.fsum(point.weight for point in points), tuple(point for point in points if point.shaft_speed)
    if not turning:
        raise PointError(f"{path}: the shaft stands at every point; {_AT_REST}")
    unit, notes = columns[names.index("weight")][1], []
    if unit == "%" and abs(whole - 1.0) > _SHARES_OFF:
        notes.append(f"the shares of time add up to {100.0 * whole:.4g} %; each counts as a part of that")
    return Spectrum(turning, whole if is_unit_of(unit, "s") else None, whole - math.fsum(point.weight for point in turning), tuple(notes))


_AT_REST = "there is no slip at rest, and no life is used: leave the point out"
_OVER_TIME = "a table of measurements over time becomes a log with: bearing-sim import-csv --guess"
_SHARES_OFF = 2e-3  # of rounded shares


def _point(where: str, written: Mapping[str, str]) -> OperatingPoint:
    """Return a point from its texts by column; ``where`` opens the messages of errors."""
    numbers: dict[str, float] = {}
    for name, text in written.items():
        try:
            numbers[name] = _weight(text) if name == "weight" else field_of(_FIELDS[name]).quantity.read(text, written=True)
        except ValueError as error:  # pydantic's error of a quantity is one, too
            raise PointError(f"{where}: {name}: {error}") from None
    if not (math.isfinite(numbers["weight"]) and numbers["weight"] > 0.0):
        raise PointError(f"{where}: weight: {written['weight']}; expected more than 0: the share of time at this point")
    return OperatingPoint(**numbers)


def _weight(text: str) -> float:
    """Return a share of time, or a time [h]."""
    for unit in ("", "h"):
        with suppress(ValueError):
            return to_si(text, unit)
    raise ValueError(f"{shortened(text, 60)!r} is neither a share of time such as 0.7 or 70 %, nor a time such as 1200 h; {_OVER_TIME}")


def shares(points: Sequence[OperatingPoint]) -> list[float]:
    """Return the share of time of each point; they add up to 1."""
    whole = math.fsum(point.weight for point in points)
    return [point.weight / whole for point in points]


def combined_life(lives: Iterable[float], points: Sequence[OperatingPoint]) -> float:
    """Return the life of a mission from the lives at its points, all in hours: 1/L = sum of w_i/L_i (Palmgren and Miner).

    The weights w_i are shares of time, so the damage rate 1/L of the mission is the mean of the rates at its points.
    """
    rate = math.fsum(share / life for share, life in zip(shares(points), lives))
    return 1.0 / rate if rate != 0.0 else math.inf


def _unit_of_difference(field: Field) -> str:
    """Return the unit of a difference of a field's values."""
    return "delta_degC" if field.quantity.unit == "K" else field.quantity.unit


def read_tolerance(text: str, scene: Scene) -> Tolerance:
    """Return the tolerance of a text such as ``bearing.roller.diameter=1um`` or ``bearing.outer_raceway.d_value=2%``.

    An amount in per cent is a fraction of the field's value, except for a field that is a pure number, whose own unit it is.

    Raises
    ------
    PointError
        The field is unknown, no quantity, not given in the scene, or has an option of its own; or the amount is no difference of its values.
    """
    path, equals, written = (part.strip() for part in text.partition("="))
    if not equals or not path or not written:
        raise PointError(f"{text!r}: expected FIELD=AMOUNT, such as bearing.roller.diameter=1um")
    try:
        field = field_of(path)
    except FieldError as error:
        raise PointError(str(error)) from None
    if field.quantity is None or path.partition(".")[0] not in BLOCKS:
        raise PointError(f"{text!r}: a tolerance needs a quantity of {', '.join(BLOCKS)}; {path} is none")
    if path in (SPEED, LOAD):
        raise PointError(f"{text!r}: give it by {'--speed-tolerance' if path == SPEED else '--load-tolerance'}")
    if number_at(scene, path) is None:
        raise PointError(f"{text!r}: this scene gives no {path}; set it with --set {path}=...")
    relative = written.endswith("%") and bool(field.quantity.unit)
    unit = "" if relative else _unit_of_difference(field)
    try:
        if reason := Quantity(unit, "", shown_in=field.unit if unit == field.quantity.unit else "").why_unit_is_needed(written):
            raise ValueError(reason)
        amount = to_si(written, unit)
    except ValueError as error:
        raise PointError(f"{text!r}: {error}; the amount is a difference of {path}") from None
    if not (math.isfinite(amount) and amount > 0.0):
        raise PointError(f"{text!r}: expected an amount above 0; it applies in both directions")
    return Tolerance(path, amount, relative)


def scene_at_point(
    scene: Scene, point: OperatingPoint, speed: float = 0.0, load: float = 0.0, tolerances: Sequence[Tolerance] = (), signs: Sequence[int] = ()
) -> Scene:
    """Return a scene at an operating point, off by its tolerances.

    Parameters
    ----------
    scene, point : the point's speed, load and oil temperature replace the scene's.
    speed, load : relative deviations of both from the point's.
    tolerances, signs : deviations of other fields, each in the direction of its sign: -1, 0 or 1.

    Raises
    ------
    PointError
        The deviations lead out of what a scene can be.
    """
    values = {SPEED: point.shaft_speed * (1 + speed), LOAD: point.radial_load * (1 + load)}
    values |= {_FIELDS[name]: value for name in _OPTIONAL if (value := getattr(point, name)) is not None}
    for tolerance, sign in zip(tolerances, signs):
        if sign:
            value = values[tolerance.field] if tolerance.field in values else number_at(scene, tolerance.field)
            values[tolerance.field] = value + sign * tolerance.amount * (abs(value) if tolerance.relative else 1.0)
    try:
        return with_values(scene, values)
    except ValueError as error:  # of pydantic
        raise PointError(f"{'off by its tolerances' if signs else 'at this point'} the scene cannot be: {messages(error)}") from None
