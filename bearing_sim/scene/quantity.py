# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Physical quantities of scene files: text with a unit in, SI numbers out; and the records that hold them.

The only module that knows units.  Inside the package every number is SI; here ``7.0 mm`` becomes
``0.007``, and a value outside its declared bounds raises one clear message.  The usual units stand in a table; the unit library (pint)
is imported for the first other one, because it takes half a second of a core to read its definitions.

Units of equal dimension may be of different kinds, such as 1/min and rad/s, or N m and J.  A text of another kind is converted where
it can mean one thing only, and refused elsewhere; it is never read as a number of the wanted unit.
"""

import dataclasses
import math
import numbers
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any, TypeVar, dataclass_transform

import pydantic.dataclasses
from pydantic import ConfigDict, model_validator
from pydantic_core import PydanticCustomError, core_schema

from bearing_sim.scene.bundled import catalog_table

Record = TypeVar("Record")
_NUMBER_THEN_UNIT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf(?:inity)?))\s*(.*?)\s*$", re.IGNORECASE)
_LONGEST_TEXT = 100  # characters of a number and its unit
_POWER = r"\s*(?:\*\*|\^)"
_PLAIN_EXPONENT = r"\s*[-+]?\d{1,2}(?:\.\d{1,2})?(?![\d.])"
_EXCESSIVE_POWER = re.compile(rf"{_POWER}(?!{_PLAIN_EXPONENT})|{_POWER}{_PLAIN_EXPONENT}{_POWER}|\){_POWER}.*\){_POWER}")
"""An exponent that is not a number of one or two digits, a power of a power, or a second power of a bracket."""


@cache
def unit_registry():
    """Return the unit registry (pint), created once."""
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=False)


def to_si(value: object, unit: str) -> float:
    """Convert a number or a text such as ``"7.0 mm"`` to SI.

    Parameters
    ----------
    value : number (already SI) or str (a number, optionally followed by a unit; a rotational speed needs one unless it is 0).
    unit : the SI unit that the result is in, in pint's spelling; ``""`` for a pure number, ``"delta_degC"`` for a temperature difference.

    Raises
    ------
    ValueError
        The text is not a quantity, its unit is unknown, has the wrong dimension or is of another kind, or there is none and a bare number
        could be misread.
    """
    if isinstance(value, bool) or not isinstance(value, (numbers.Real, str)):
        raise ValueError(f"expected {expected(unit)}, got {value!r}")
    if not isinstance(value, str):
        return _as_float(value, unit)
    if len(value) > _LONGEST_TEXT:
        raise ValueError(f"expected {expected(unit)}, got a text of {len(value)} characters, {value[:20]!r} ...")
    match = _NUMBER_THEN_UNIT.match(value)
    if match is None:
        raise ValueError(f"expected {expected(unit)}, got {value!r}")
    number, written_unit = float(match[1]), match[2]
    if not written_unit:
        if unit == SPEED and number:
            raise ValueError(_bare_speed(value))
        return number
    if _EXCESSIVE_POWER.search(written_unit):  # pint would compute 9**9**9**9
        raise ValueError(f"{value!r} has powers of powers in its unit; expected {expected(unit)}")
    written_unit = _MEANT.get(unit, {}).get("".join(written_unit.casefold().split()), written_unit)
    if written_unit in (factors := _USUAL.get(unit, {})):
        return number * factors[written_unit]
    if unit == "K" and written_unit in ("degC", "°C"):
        return number + _ZERO_CELSIUS
    import pint

    registry = unit_registry()
    try:
        written = registry.Unit(written_unit)
        converted = registry.Quantity(number, written).to(registry.Unit(unit or "dimensionless"))
    except pint.UndefinedUnitError:
        raise ValueError(f"unknown unit {written_unit!r} in {value!r}{_other_case(written_unit)}; expected {expected(unit)}") from None
    except pint.DimensionalityError:
        raise ValueError(f"{value!r} has the wrong dimension{_other_case(written_unit)}; expected {expected(unit)}") from None
    except Exception:  # pint's parser passes on any error of Python's tokenizer
        raise ValueError(f"cannot read the unit {written_unit!r} in {value!r}; expected {expected(unit)}") from None
    if reason := _other_kind(written, unit):
        raise ValueError(f"{value!r} is {reason}; expected {expected(unit)}")
    return float(converted.magnitude)


def _as_float(value: numbers.Real, unit: str) -> float:
    """Return a number as a float; one that is too large for that is refused."""
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"expected {expected(unit)}, got an integer above 1.8e308") from None


SPEED = "rad/s"
"""Unit of rotational speeds, which people write in turns as often as in angles."""

_MEANT: dict[str, dict[str, str]] = {}  # pint's spelling of what people write, by the unit that is expected
for _row in catalog_table("tables/spellings"):
    _MEANT.setdefault(_row["kind"], {})[_row["written"]] = _row["means"]
_ZERO_CELSIUS = 273.15  # [K]
_USUAL: dict[str, dict[str, float]] = {}  # SI over the usual units, by the unit that is expected
_PROPOSED: dict[str, list[str]] = {}  # those that a message proposes
for _row in catalog_table("tables/units"):
    _USUAL.setdefault(_row["kind"], {})[_row["unit"]] = float(_row["factor"])
    if _row["proposed"]:
        _PROPOSED.setdefault(_row["kind"], []).append(_row["unit"])
_FIRST_PROPOSED = {"m": "mm", "K": "degC", "rad": "deg", "Pa": "MPa"}
_MOST_PROPOSED = 3
_ANGLES = ("radian", "degree", "turn", "revolution", "cycle", "arcminute", "arcsecond", "grade", "revolutions_per_minute", "revolutions_per_second")
_SPELLINGS = "N kN MN Pa kPa MPa GPa m mm um kg g s ms K degC rpm Hz kHz N*m mPa*s rad deg".split()


def _bare_speed(value: object) -> str:
    """Return the reason why a rotational speed without a unit is refused."""
    return f"{value!r} has no unit; write {value} rpm (turns per minute), {value} Hz (turns per second) or {value} rad/s"


def _other_kind(written, unit: str) -> str:
    """Return what a unit of the right dimension is instead of the kind of quantity wanted; empty if it is of that kind."""
    names = list(written._units)
    has_angle = any(name.endswith(_ANGLES) for name in names)
    if unit in (SPEED, "rad") and not has_angle:
        return "no angle" if unit == "rad" else "neither turns nor an angle in a unit of time"
    if unit in ("", "Hz") and has_angle:
        return "an angle, not a pure number" if unit == "" else "a rotational speed, not a rate"
    if unit == "N*m" and any(unit_registry().Unit(name).dimensionality == written.dimensionality for name in names):
        return "an energy, not a moment"
    if unit == "K" and any(name.startswith("delta_") for name in names):
        return "a temperature difference, not a temperature"
    return ""


def _other_case(written_unit: str) -> str:
    """Return ``" (did you mean ...?)"`` if a unit is a known one but for its capitals, or an empty text."""
    known = next((spelling for spelling in _SPELLINGS if spelling != written_unit and spelling.casefold() == written_unit.casefold()), None)
    return f" (did you mean {known!r}?)" if known else ""


def conversion(written: str, unit: str) -> tuple[float, float]:
    """Return scale and offset of a unit: a number in SI = scale x the number in the unit ``written`` + offset.  Raises as `to_si`."""
    offset = to_si(f"0 {written}", unit)
    return to_si(f"1 {written}", unit) - offset, offset


_EXAMPLES = {
    "m": "a length such as '7.0 mm'",
    "rad": "an angle such as '60 deg'",
    SPEED: "a speed such as '45000 rpm', '750 Hz' or '4712 rad/s'",
    "delta_degC": "a temperature difference such as '5 K'",
    "N": "a force such as '800 N'",
    "K": "a temperature such as '120 degC'",
    "kg": "a mass such as '50 g'",
    "kg/m^3": "a density such as '7850 kg/m^3'",
    "Pa": "a pressure such as '206 GPa'",
    "Pa*s": "a viscosity such as '2.1 mPa*s'",
    "s": "a time such as '0.5 s'",
    "Hz": "a rate such as '50 Hz'",
    "h": "a time in hours such as '300 h'",
    "N*m": "a moment such as '1.5 N*m'",
    "kg*m^2": "an inertia such as '50 kg*mm^2'",
    "": "a pure number, or one in '%'",
}


def expected(unit: str) -> str:
    """Return what may stand for a quantity in this unit, with an example."""
    return _EXAMPLES.get(unit, f"a quantity in {unit}")


@dataclass(frozen=True)
class Quantity:
    """Declaration of one quantity: its unit, bounds and meaning.

    Used to check YAML, for ROS parameter descriptors and for the reference pages.

    Attributes
    ----------
    unit : SI unit of the stored number.
    meaning : what the quantity is, in one line.
    minimum, maximum : bounds, both included, in SI.
    shown_in : unit in messages and tables; defaults to ``unit``.
    """

    unit: str
    meaning: str
    minimum: float = -math.inf
    maximum: float = math.inf
    shown_in: str = ""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(lambda value, info: self.read(value, bool(info.context)))

    def read(self, value: object, written: bool = False) -> float:
        """Return ``value`` in SI, or raise an error with a message for the author of the scene file.

        Parameters
        ----------
        value : see `to_si`.
        written : whether somebody wrote it in a file or an option, so that a rotational speed needs a unit even as a plain number.
        """
        try:
            if written and self.unit == SPEED and type(value) in (int, float) and value:
                raise ValueError(_bare_speed(value))
            number = to_si(value, self.unit)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error)}) from None
        for bound in (self.minimum, self.maximum):
            if math.isclose(number, bound, rel_tol=1e-12):  # round-off must not put "10 um" outside a bound of 1e-5
                number = bound
        if not self.minimum <= number <= self.maximum:  # NaN fails here too
            bare = self.unit and is_bare(value)
            shown = f"{number:.6g} {self.unit}" if bare else self.show(number)
            meant = f"; a bare number is SI: write {found}?" if bare and (found := self.with_units(number)) else ""
            raise PydanticCustomError(
                "bound",
                "{shown} is outside {low} to {high}{meant}",
                {"shown": shown, "low": self.show(self.minimum), "high": self.show(self.maximum), "meant": meant},
            )
        return number

    def with_units(self, number: float) -> str:
        """Return a bare number with each usual unit in which it lies within the bounds, such as ``5 N or 5 kN``; empty if it does in none."""
        first = self.shown_in or _FIRST_PROPOSED.get(self.unit, self.unit)
        usual = dict.fromkeys((first, *_PROPOSED.get(self.unit, ()), *(("degC",) if self.unit == "K" else ())))
        written = [f"{number:.12g} {unit}" for unit in usual]
        fitting = [text for text in written if self.minimum <= to_si(text, self.unit) <= self.maximum]
        return " or ".join(fitting[:_MOST_PROPOSED])

    def why_unit_is_needed(self, value: object) -> str:
        """Return why an option or an override does not take this value: it is a bare number, in a unit that nobody wrote; empty if it is not.

        A pure number needs no unit, nor does a zero, which is the same in every unit but those of temperature.
        """
        if not self.unit or not is_bare(value) or not (number := float(value)) and self.unit != "K":
            return ""
        if self.unit == SPEED:
            return _bare_speed(value)
        found = self.with_units(number) or f"it with one, such as {expected(self.unit)}"
        return f"{value} has no unit; write {found}"

    def written(self, number: float) -> str:
        """Return ``number`` (SI) as a file has it, to the last digit: a rotational speed with its unit."""
        return f"{number!r} {SPEED}" if self.unit == SPEED else repr(number)

    def show(self, number: float) -> str:
        """Return ``number`` (SI) as text in the display unit."""
        unit = self.shown_in or self.unit
        if math.isfinite(number) and unit != self.unit and unit in (factors := _USUAL.get(self.unit, {})):
            number /= factors[unit]
        elif math.isfinite(number) and (self.unit, unit) == ("K", "degC"):
            number -= _ZERO_CELSIUS
        elif math.isfinite(number) and unit != self.unit:
            registry = unit_registry()
            number = registry.Quantity(number, registry.Unit(self.unit or "dimensionless")).to(unit).magnitude
        return f"{number:.6g} {unit}".rstrip()


@dataclass(frozen=True)
class QuantityOrName(Quantity):
    """A quantity for which a standard has names, too."""

    names: tuple[str, ...] = ()

    def read(self, value: object, written: bool = False) -> float | str:
        """Return ``value`` in SI, or the name as the standard writes it; see `Quantity.read`."""
        if isinstance(value, str) and value.strip().upper() in self.names:
            return value.strip().upper()
        try:
            return super().read(value, written)
        except PydanticCustomError as error:
            reason = f"{error.message()}; or one of {', '.join(self.names)}"
            raise PydanticCustomError("quantity", "{reason}", {"reason": reason}) from None


def is_bare(value: object) -> bool:
    """Whether a value is a number without a unit, as a number or as text."""
    if isinstance(value, str):
        return (match := _NUMBER_THEN_UNIT.match(value)) is not None and not match[2]
    return isinstance(value, numbers.Real) and not isinstance(value, bool)


def in_digits(value: float, digits: int) -> str:
    """Return a number as text, rounded to so many digits, without an exponent where it is large."""
    return f"{float(f'{value:.{digits}g}'):.12g}"


# A validator is built at its first use, not for each record that others contain and nobody makes on its own.
_CONFIG = ConfigDict(extra="forbid", str_strip_whitespace=True, defer_build=True)


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(dataclasses.field,))
def record(cls: type[Record]) -> type[Record]:
    """Decorate a record of a scene: frozen, keyword-only, and it refuses unknown fields."""
    return pydantic.dataclasses.dataclass(frozen=True, kw_only=True, config=_CONFIG)(cls)


def named_law(value: object) -> object:
    """Return the block of a record that was given by the name of its law alone; anything else as it is."""
    return {"law": value.strip()} if isinstance(value, str) else value


def check(errors_of: Callable[[Any], list[str]]):
    """Return the validator of a record that refuses it for all its errors at once, so that the author can correct the file in one go.

    Parameters
    ----------
    errors_of : the method of the record that returns its error messages.
    """

    def checked(self):
        if errors := errors_of(self):
            raise ValueError("; ".join(errors))
        return self

    return model_validator(mode="after")(checked)
