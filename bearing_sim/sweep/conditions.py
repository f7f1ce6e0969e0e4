# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Conditions in which a bearing must work: the operating points of a mission with their weights, and tolerances about them.

A file of points is CSV with the columns ``shaft_speed``, ``radial_load``, ``weight`` and, optionally, ``oil_temperature``.  Units stand
in brackets behind the names or with each value:

    shaft_speed [rpm], radial_load [N], weight, oil_temperature [degC]
    45000, 800, 70%, 120
    39000, 500, 30%, 115
"""

import csv
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from bearing_sim.files.limits import POINTS_FILE, POINTS_ROWS, FileError
from bearing_sim.files.reading import read_text
from bearing_sim.scene.errors import shortened
from bearing_sim.scene.quantity import to_si
from bearing_sim.scene.scene import OPERATING_POINT, Scene
from bearing_sim.scene.uncertainty import BLOCKS, messages, value_at, with_values
from bearing_sim.sweep.grid import Field, FieldError, field_of

SPEED, LOAD, TEMPERATURE = (OPERATING_POINT[name] for name in ("shaft_speed", "radial_load", "oil_temperature"))
_REQUIRED, _KNOWN = ("shaft_speed", "radial_load", "weight"), ("shaft_speed", "radial_load", "weight", "oil_temperature")
_HEADING = re.compile(r"\s*(\w+)\s*(?:\[\s*(.*?)\s*\])?\s*")
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
    oil_temperature : [K]; None: the scene's.
    """

    shaft_speed: float
    radial_load: float
    weight: float = 1.0
    oil_temperature: float | None = None


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
    if not len(_REQUIRED) <= len(parts) <= len(_KNOWN):
        raise PointError(f"{text!r}: {len(parts)} parts; {_EXPECTED}")
    return _point(repr(text), dict(zip(_KNOWN, parts)))


def read_points(path: Path) -> tuple[OperatingPoint, ...]:
    """Return the operating points of a CSV file (see the module).

    Raises
    ------
    PointError
        The file cannot be read, or is too long; a column is missing or unknown, a value is not the quantity expected, or there are no points.
    """
    try:
        text = read_text(path, POINTS_FILE)
        lines = [(number, row) for number, row in enumerate(csv.reader(text.splitlines()), 1) if any(cell.strip() for cell in row)]
        POINTS_ROWS.check(len(lines) - 1, str(path))
    except (FileError, csv.Error) as error:
        raise PointError(str(error) if isinstance(error, FileError) else f"{path}: cannot be read as a table: {error}") from None
    if len(lines) < 2:
        raise PointError(f"{path}: no operating points; expected a heading of {', '.join(_REQUIRED)} and a line for each point")
    (_, heading), *rows = lines
    matches = [_HEADING.fullmatch(" ".join(cell.split())) for cell in heading]
    names, units = [match[1] if match else cell for match, cell in zip(matches, heading)], [match[2] or "" if match else "" for match in matches]
    for name in names:
        if name not in _KNOWN or names.count(name) > 1:
            raise PointError(
                f"{path}: column {shortened(repr(name), 200)} is {'given twice' if name in _KNOWN else 'unknown'}; expected {', '.join(_KNOWN)}"
            )
    if missing := [name for name in _REQUIRED if name not in names]:
        raise PointError(f"{path}: no column {' and no column '.join(missing)}; expected {', '.join(_REQUIRED)}, each with its unit in brackets")
    points = []
    for number, row in rows:
        if len(row) != len(names):
            raise PointError(f"{path}, line {number}: {len(row)} values for {len(names)} columns")
        written = {name: f"{cell.strip()} {unit}".strip() for name, cell, unit in zip(names, row, units)}
        points.append(_point(f"{path}, line {number}", written))
    return tuple(points)


def _point(where: str, written: Mapping[str, str]) -> OperatingPoint:
    """Return a point from its texts by column; ``where`` opens the messages of errors."""
    numbers: dict[str, float] = {}
    for name, text in written.items():
        try:
            numbers[name] = to_si(text, "") if name == "weight" else field_of(OPERATING_POINT[name]).quantity.read(text, written=True)
        except ValueError as error:  # pydantic's error of a quantity is one, too
            raise PointError(f"{where}: {name}: {error}") from None
    if not (math.isfinite(numbers["weight"]) and numbers["weight"] > 0.0):
        raise PointError(f"{where}: weight: {written['weight']}; expected more than 0: the share of time at this point")
    if numbers["shaft_speed"] == 0.0:
        raise PointError(f"{where}: shaft_speed: 0; there is no slip at rest, and no life is used: leave the point out")
    return OperatingPoint(**numbers)


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
    if value_at(scene, path) is None:
        raise PointError(f"{text!r}: this scene gives no {path}; set it with --set {path}=...")
    relative = written.endswith("%") and bool(field.quantity.unit)
    try:
        amount = to_si(written, "" if relative else _unit_of_difference(field))
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
    if point.oil_temperature is not None:
        values[TEMPERATURE] = point.oil_temperature
    for tolerance, sign in zip(tolerances, signs):
        if sign:
            value = values[tolerance.field] if tolerance.field in values else value_at(scene, tolerance.field)
            values[tolerance.field] = value + sign * tolerance.amount * (abs(value) if tolerance.relative else 1.0)
    try:
        return with_values(scene, values)
    except ValueError as error:  # of pydantic
        raise PointError(f"off by its tolerances the scene cannot be: {messages(error)}") from None
