# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Physical quantities of scene files: text with a unit in, SI numbers out; and the records that hold them.

The only module that knows units.  Inside the package every number is SI; here ``7.0 mm`` becomes
``0.007``, and a value outside its declared bounds raises one clear message.  The unit library (pint)
is imported at first use, because importing it takes a quarter of a second, which ``--help`` does not need.
"""

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any

import pydantic.dataclasses
from pydantic import ConfigDict, model_validator
from pydantic_core import PydanticCustomError, core_schema

_NUMBER_THEN_UNIT = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[-+]?(?:nan|inf(?:inity)?))\s*(.*?)\s*$", re.IGNORECASE)


@cache
def unit_registry():
    """Return the unit registry (pint), created once."""
    import pint

    return pint.UnitRegistry(autoconvert_offset_to_baseunit=False)


def to_si(value: object, unit: str) -> float:
    """Convert a number or a text such as ``"7.0 mm"`` to SI.

    Parameters
    ----------
    value : number (already SI) or str (a number, optionally followed by a unit).
    unit : the SI unit that the result is in, in pint's spelling; ``""`` for a pure number.

    Raises
    ------
    ValueError
        The text is not a quantity, or its unit is unknown or has the wrong dimension.
    """
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        raise ValueError(f"expected {_expected(unit)}, got {value!r}")
    if not isinstance(value, str):
        return float(value)
    match = _NUMBER_THEN_UNIT.match(value)
    if match is None:
        raise ValueError(f"expected {_expected(unit)}, got {value!r}")
    number, written_unit = float(match[1]), match[2]
    if not written_unit:
        return number
    import pint

    registry = unit_registry()
    try:
        return float(registry.Quantity(number, written_unit).to(registry.Unit(unit or "dimensionless")).magnitude)
    except pint.UndefinedUnitError:
        raise ValueError(f"unknown unit {written_unit!r} in {value!r}; expected {_expected(unit)}") from None
    except pint.DimensionalityError:
        raise ValueError(f"{value!r} has the wrong dimension; expected {_expected(unit)}") from None
    except Exception:  # pint's parser passes on any error of Python's tokenizer
        raise ValueError(f"cannot read the unit {written_unit!r} in {value!r}; expected {_expected(unit)}") from None


def conversion(written: str, unit: str) -> tuple[float, float]:
    """Return scale and offset of a unit: a number in SI = scale x the number in the unit ``written`` + offset.  Raises as `to_si`."""
    offset = to_si(f"0 {written}", unit)
    return to_si(f"1 {written}", unit) - offset, offset


_EXAMPLES = {
    "m": "a length such as '7.0 mm'",
    "rad": "an angle such as '60 deg'",
    "rad/s": "a speed such as '45000 rpm'",
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


def _expected(unit: str) -> str:
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
        return core_schema.no_info_plain_validator_function(self.read)

    def read(self, value: object) -> float:
        """Return ``value`` in SI, or raise an error with a message for the author of the scene file."""
        try:
            number = to_si(value, self.unit)
        except ValueError as error:
            raise PydanticCustomError("quantity", "{reason}", {"reason": str(error)}) from None
        for bound in (self.minimum, self.maximum):
            if math.isclose(number, bound, rel_tol=1e-12):  # round-off must not put "10 um" outside a bound of 1e-5
                number = bound
        if not self.minimum <= number <= self.maximum:  # NaN fails here too
            raise PydanticCustomError(
                "bound",
                "{shown} is outside {low} to {high}",
                {"shown": self.show(number), "low": self.show(self.minimum), "high": self.show(self.maximum)},
            )
        return number

    def show(self, number: float) -> str:
        """Return ``number`` (SI) as text in the display unit."""
        unit = self.shown_in or self.unit
        if math.isfinite(number) and unit != self.unit:
            registry = unit_registry()
            number = registry.Quantity(number, registry.Unit(self.unit or "dimensionless")).to(unit).magnitude
        return f"{number:.6g} {unit}".rstrip()


def quantity(unit: str, meaning: str, minimum: float = -math.inf, maximum: float = math.inf, shown_in: str = ""):
    """Return the annotated float type of a scene field (see `Quantity`)."""
    return Annotated[float, Quantity(unit, meaning, minimum, maximum, shown_in)]


record = pydantic.dataclasses.dataclass(frozen=True, kw_only=True, config=ConfigDict(extra="forbid", str_strip_whitespace=True))
"""Decorator of every record of a scene: frozen, keyword-only, and it refuses unknown fields."""


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
