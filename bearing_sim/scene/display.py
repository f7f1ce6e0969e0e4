# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How quantities are shown to people: name, symbol, unit, digits and scale of each, in texts, tables, pages and pictures alike.

Files and inputs keep the spellings that programs read (``um``, ``degC``); people read µm, °C and ±.  Every text of a number comes from here.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

from bearing_sim.scene.bundled import catalog_table

RPM = 30.0 / math.pi  # 1/min over rad/s
ZERO_CELSIUS = 273.15  # [K]
LONGEST_LIFE = 1e9  # h; a longer life is that of a bearing without load
NO_NUMBER = "–"  # where a quantity is not known
_PLAIN_FROM, _PLAIN_TO = 1e-4, 1e12  # numbers outside have an exponent


class Shown(NamedTuple):
    """How one quantity is shown.

    Attributes
    ----------
    name : in words, as in a heading.
    unit : as shown; a force, power or pressure takes the larger unit of `_LARGER` where it is large.
    symbol : of the standards, or ``""``.
    scale, offset : the number shown is scale x the number in SI (lives: hours) + offset.
    digits : significant digits.
    is_logarithmic : whether pictures have it on a logarithmic scale.
    """

    name: str
    unit: str = ""
    symbol: str = ""
    scale: float = 1.0
    offset: float = 0.0
    digits: int = 4
    is_logarithmic: bool = False


SHOWN = {
    row["key"]: Shown(
        row["name"],
        row["unit"],
        row["symbol"],
        float(row["scale"] or 1.0),
        float(row["offset"] or 0.0),
        int(row["digits"]),
        row["logarithmic"] == "yes",
    )
    for row in catalog_table("tables/shown")
}
"""How results and inputs are shown, by the last part of their name (`bearing_sim.model.sample`, scene fields, columns of tables)."""

_LARGER = {"N": ("kN", 1e3, 1e3), "W": ("kW", 1e3, 1e4), "MPa": ("GPa", 1e3, 1e4), "N m": ("kN m", 1e3, 1e4)}
"""Larger unit, how many of the smaller make one, and from which number (in the smaller) it is used."""


def shown(name: str) -> Shown:
    """Return how a quantity is shown, by its name or the path of its field; one that is not listed by the words of its path, as ``roller length``."""
    block, _, last = name.rpartition(".")
    return SHOWN.get(last) or Shown(f"{block.rpartition('.')[2]} {last}".strip().replace("_", " "))


def number(value: float, digits: int = 4) -> str:
    """Return a number as people write it: so many significant digits, a comma between thousands, no exponent but for extremes.

    Parameters
    ----------
    value : any number; a dash stands for NaN.
    digits : significant ones; digits before the decimal point are never dropped, those beyond ``digits`` are rounded to 0.
    """
    if not math.isfinite(value):
        return NO_NUMBER if math.isnan(value) else "infinite" if value > 0.0 else "-infinite"
    rounded = float(f"{value:.{digits}g}")
    if rounded and not _PLAIN_FROM <= abs(rounded) < _PLAIN_TO:
        return f"{rounded:.{digits}g}"
    places = max(digits - 1 - math.floor(math.log10(abs(rounded))), 0) if rounded else 0
    text = f"{rounded:,.{places}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if text == "-0" else text


def force(newton: float, digits: int = 4) -> str:
    """Return a force with its unit, N below 1 kN."""
    return _in_unit(newton, "N", digits)


def power(watt: float, digits: int = 4) -> str:
    """Return a power with its unit, W below 10 kW."""
    return _in_unit(watt, "W", digits)


def hours(life: float, digits: int = 4) -> str:
    """Return a life [h] in words.  Above `LONGEST_LIFE`, where hardly anything loads the bearing, it is no figure to plan with."""
    if math.isnan(life):
        return "unknown"
    if life > LONGEST_LIFE:
        return "infinite" if math.isinf(life) else "above 1,000,000,000 h"
    return f"{number(life, digits)} h"


def quantity_text(name: str, value: float, digits: int | None = None) -> str:
    """Return a quantity with its unit.

    Parameters
    ----------
    name : of `SHOWN`.
    value : in SI; lives in hours.
    digits : significant ones, instead of its own.
    """
    each = shown(name)
    digits = each.digits if digits is None else digits
    if each.unit == "h":
        return hours(value, digits)
    return _in_unit(round(each.scale * value + each.offset, 9) if each.offset else each.scale * value, each.unit, digits)


def _in_unit(value: float, unit: str, digits: int) -> str:
    unit, factor = larger_unit(unit, [value])
    return f"{number(value / factor, digits)} {unit}".rstrip() if not math.isnan(value) else NO_NUMBER


def larger_unit(unit: str, values: Iterable[float]) -> tuple[str, float]:
    """Return the unit in which values are shown together, and by what they are divided: the larger one if the largest of them is large."""
    finite = [abs(value) for value in values if math.isfinite(value)]
    larger, factor, threshold = _LARGER.get(unit, ("", 1.0, math.inf))
    return (larger, factor) if finite and max(finite) >= threshold * (1.0 - 1e-12) else (unit, 1.0)


def with_sign(value: float, digits: int = 3) -> str:
    """Return a number with its sign; 0 without."""
    text = number(value, digits)
    return text if text.startswith("-") or text in ("0", NO_NUMBER) else f"+{text}"


SIGNS = {"um": "µm", "degC": "°C", "deg": "°", "1": "", "um/m": "µm/m", "N*m": "N m", "m^2/s": "m²/s", "mm^2/s": "mm²/s"}
"""Units as people read them, by the spelling of files."""


def unit_sign(unit: str) -> str:
    """Return a unit of a file as people read it."""
    return SIGNS.get(unit, unit)


def heading(name: str, unit: str | None = None) -> str:
    """Return name, symbol and unit of a quantity as in a heading or on an axis, such as ``low-point radius R_low [mm]``.

    Parameters
    ----------
    name : of `SHOWN`, or the path of a scene field.
    unit : in which the values are, in the spelling of files; None: its own.
    """
    each = shown(name)
    words = f"{each.name} {each.symbol}" if each.symbol else each.name
    sign = each.unit if unit is None else unit_sign(unit)
    return f"{words} [{sign}]" if sign else words
