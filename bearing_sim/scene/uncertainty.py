# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Uncertainty of a scene: ranges of its fields, and access to fields by dotted path.

The block ``uncertainty`` of a file maps fields to ranges, by dotted path or in nested blocks:

    uncertainty:
      lubricant.mixture_fraction: [0.015, 0.05]
      lubricant.temperature: {low: 100 degC, high: 150 degC, distribution: triangular, source: where the range comes from}

A range gives the possible values; runs use the scene's own value.
"""

import dataclasses
import difflib
import itertools
import math
import types
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any, Literal

from pydantic import ValidationError
from pydantic_core import PydanticCustomError

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.errors import InvalidField
from bearing_sim.scene.fidelity import WHIRLING
from bearing_sim.scene.fields import declared_in, hints_of
from bearing_sim.scene.mounting import clearance_limits
from bearing_sim.scene.quantity import SPEED, Quantity, check, record

_MOST_ERRORS = 50  # that are listed
_LONGEST_PATH = 200  # characters of a path for which the nearest is looked for
BLOCKS = ("bearing", "lubricant", "operating", "mounting", "heat", "support")  # of a scene; their quantities may have ranges
_IN_WORDS = f"{', '.join(BLOCKS[:-1])} or {BLOCKS[-1]}"
_ENDS, _WORDS = ("low", "high", "mode"), ("distribution", "source")
_LOW_RADIUS = "outer_raceway.low_radius"
_CLEARANCE = "bearing.clearance"
# Lengths there decide the clearance.
_DIMENSIONS = (_CLEARANCE, "bearing.inner_raceway.", "bearing.outer_raceway.", "bearing.roller.", "mounting.")
_TRACTION_FACTOR = 1.5  # assumption
# Defaults of a scene that decide how an inner ring vibrates, with their ranges.
_RING_RANGES = (
    ("support.shaft.mass", 0.5, 0.05, 5.0, "how much of shaft and rotor moves with the inner ring (assumption: a factor of 10 to either side)"),
    ("bearing.contact.damping_time", 2.5e-6, 0.4e-6, 25e-6, "Kraemer: 2.5 to 25 us; below it an assumption"),
)
_MIDDLE = 0.9  # of the values of an estimated field lie within its range
_CLOSE_ENOUGH = 0.6  # of difflib's ratio


@record
class Range:
    """Range of one quantity of the scene, in its SI unit.

    Attributes
    ----------
    field : dotted path in the scene.
    low, high : the ends.
    distribution : ``uniform``; ``log_uniform``, uniform in the logarithm; ``triangular``, with its peak at the mode.
    mode : of a triangular distribution; None: the scene's own value, or the middle of the range if that lies outside.
    source : where the range comes from.
    """

    field: str  # path of the field
    low: float  # low end of its range, in the unit of the field
    high: float  # high end
    distribution: Literal["uniform", "log_uniform", "triangular"] = "uniform"  # how likely values are within the range
    mode: float | None = None  # most likely value of a triangular distribution
    source: str = ""  # where the range comes from

    @check
    def _is_a_range(self) -> list[str]:
        errors = []
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            errors.append(f"low: {self.low:g} is not below high, {self.high:g}")
        if self.distribution == "log_uniform" and self.low <= 0.0:
            errors.append(f"low: {self.low:g}; a log_uniform range lies above 0")
        if self.mode is not None and self.distribution != "triangular":
            errors.append(f"mode: only a triangular distribution has one, this one is {self.distribution}")
        elif self.mode is not None and not self.low <= self.mode <= self.high:
            errors.append(f"mode: {self.mode:g} lies outside {self.low:g} to {self.high:g}")
        return errors


@cache
def quantities(scene_type: type) -> Mapping[str, Quantity]:
    """Return the declarations of all quantities that may have a range, by dotted path, including those of alternative records."""
    hints = hints_of(scene_type)
    return types.MappingProxyType({path: found for name in BLOCKS for path, found in declared_in(name, hints[name])})


def nearest(path: str, known: Iterable[str]) -> str:
    """Return ``" (did you mean ...?)"`` for the nearest known path, compared as a whole and by its last word, or an empty text."""
    known, word = list(known), path.rpartition(".")[2]
    if len(path) > _LONGEST_PATH:  # comparing takes long
        return ""

    def likeness(other: str) -> float:
        compare = difflib.SequenceMatcher
        return compare(None, path, other).ratio() + compare(None, word, other.rpartition(".")[2]).ratio()

    best = max(known, key=likeness, default="")
    return f" (did you mean {best!r}?)" if best and likeness(best) > 2 * _CLOSE_ENOUGH else ""


def flattened(block: Mapping, path: str = "") -> dict[str, Any]:
    """Return a block ``uncertainty``, nested or not, by dotted paths."""
    flat = {}
    for key, value in block.items():
        inner = f"{path}.{key}" if path else str(key)
        if isinstance(value, Mapping) and not set(map(str, value)) & {*_ENDS, *_WORDS}:
            flat |= flattened(value, inner)
        else:
            flat[inner] = value
    return flat


def with_range(given, path: str, value) -> dict:
    """Return a block ``uncertainty``, as `flattened` has it, with what an override gives: a range, or one of its ends or words.

    Parameters
    ----------
    given : the block; what is none counts as empty.
    path : of a field, or of a field and a name such as ``low`` in its range.
    value : that it is given.
    """
    block = flattened(given) if isinstance(given, Mapping) else {}
    field, _, name = path.rpartition(".")
    if name in (*_ENDS, *_WORDS) and field in block:
        known = block[field]
        return block | {field: {**(dict(zip(_ENDS, known)) if isinstance(known, (list, tuple)) else known), name: value}}
    return block | flattened({path: value})


def read_ranges(given, known: Mapping[str, tuple[str, Quantity, float]], bore: float | None = None) -> tuple[list[dict], list[InvalidField]]:
    """Read a block ``uncertainty`` into records in SI.

    Parameters
    ----------
    given : the block in the file.
    known : by each path that a file may give: the field, the declaration of what is given, and the field over that, which is 1/2 of a diameter.
    bore : diameter of the bearing's bore [m], by which a group of clearance is read; None: not known.

    Returns
    -------
    ranges : the fields of each `Range`.
    errors : all of them.
    """
    if not isinstance(given, Mapping):
        return [], [
            InvalidField("uncertainty", repr(given), "expected a mapping of field to range, such as lubricant.mixture_fraction: [0.015, 0.05]")
        ]
    fields, ranges, errors = flattened(given), {}, []
    in_order = sorted(fields.items(), key=lambda item: known.get(item[0], item)[0] != item[0])  # diameters last
    for number, (path, value) in enumerate(in_order):
        if len(errors) > _MOST_ERRORS:
            errors.append(InvalidField("uncertainty", "", f"{len(fields) - number} more fields were not looked at"))
            break
        where = f"uncertainty.{path}"
        if value is None:  # --set uncertainty.FIELD=null removes a range
            continue
        if path not in known:
            fields_known = (each for each, (field, *_) in known.items() if each == field)
            errors.append(InvalidField(where, "", f"unknown field{nearest(path, fields_known)}; expected a quantity of {_IN_WORDS}"))
            continue
        field, declared, factor = known[path]
        if path != field and (field in ranges or fields.get(field) is not None):
            errors.append(InvalidField(where, "", f"{field} has a range, too; give one of the two"))
            continue
        entered, wrong = _entered(where, value, declared, factor, bore)
        if not wrong:
            try:
                Range(field=field, **entered)
                ranges[field] = {"field": field, **entered}
            except ValidationError as error:
                wrong = [
                    InvalidField(".".join([where, *map(str, each["loc"])]), "", each["msg"].removeprefix("Value error, ")) for each in error.errors()
                ]
        errors += wrong
    return list(ranges.values()), errors


def _entered(where: str, value, declared: Quantity, factor: float, bore: float | None) -> tuple[dict, list[InvalidField]]:
    """Return the fields of one range in SI, and its errors.  A group of clearance stands for its least value, its largest or, as mode, its middle."""
    if isinstance(value, (list, tuple)):
        if len(value) != 2:
            return {}, [InvalidField(where, repr(value), "expected [low, high]")]
        value = dict(zip(_ENDS, value))
    if not isinstance(value, Mapping):
        return {}, [InvalidField(where, repr(value), "expected [low, high], or a block with low, high and optionally distribution, mode, source")]
    names = (*_ENDS, *_WORDS)
    errors = [
        InvalidField(f"{where}.{name}", "", f"unknown field{nearest(str(name), names)}; known here: {', '.join(names)}")
        for name in value
        if name not in names
    ]
    errors += [InvalidField(f"{where}.{name}", "", "missing") for name in ("low", "high") if value.get(name) is None]
    entered = dict(value)
    for name in _ENDS:
        if value.get(name) is None:
            continue
        try:
            end = declared.read(value[name], written=True)
            if isinstance(end, str):
                if bore is None:
                    raise ValueError("the group follows from the bore, bearing.inner_raceway.bore_radius, which is not given; give a length")
                limits = clearance_limits(end, bore)
                end = {"low": limits.least, "high": limits.largest, "mode": limits.mean}[name]
            entered[name] = factor * end
        except PydanticCustomError as error:
            errors.append(InvalidField(f"{where}.{name}", repr(value[name]), error.message()))
        except ValueError as error:
            errors.append(InvalidField(f"{where}.{name}", repr(value[name]), str(error)))
    return entered, errors


def range_errors(scene) -> list[str]:
    """Return error messages for ranges of unknown or absent quantities, out of bounds, or given twice."""
    known, errors, seen = quantities(type(scene)), [], set()
    for one in scene.uncertainty:
        where, declared = f"uncertainty.{one.field}", known.get(one.field)
        if declared is None:
            errors.append(f"{where}: unknown field{nearest(one.field, known)}")
        elif value_at(scene, one.field) is None:
            errors.append(f"{where}: this scene has no {one.field}; leave its range out")
        elif not declared.minimum <= one.low <= one.high <= declared.maximum:
            bounds = f"{declared.show(declared.minimum)} to {declared.show(declared.maximum)}"
            errors.append(f"{where}: {declared.show(one.low)} to {declared.show(one.high)} goes beyond {bounds}")
        if one.field in seen:
            errors.append(f"{where}: given twice")
        seen.add(one.field)
    return errors


def without_range(scene, field: str):
    """Return a scene without the range of a field, such as one that a log gives."""
    return dataclasses.replace(scene, uncertainty=tuple(one for one in scene.uncertainty if one.field != field))


def ranges_of(scene) -> tuple[Range, ...]:
    """Return the ranges that a scene declares, and those of what it leaves to estimates that it declares none for: of the bearing and of the oil."""
    declared = {one.field for one in scene.uncertainty}
    assumed = itertools.chain(estimated_ranges(scene), lubricant_ranges(scene))
    return scene.uncertainty + tuple(one for one in assumed if one.field not in declared)


def estimated_ranges(scene) -> Iterator[Range]:
    """Yield the ranges of the estimated fields of a scene's bearing: uniform, with the given range as their middle 90 %; counts in whole numbers."""
    known = quantities(type(scene))
    for each in scene.bearing.estimated:
        path = f"bearing.{each.field}"
        own, declared = value_at(scene, path), known.get(path)
        if declared is None:  # a count
            low, high = each.low - 0.499, each.high + 0.499
        else:
            margin = own * (each.high - each.low) * (1.0 / _MIDDLE - 1.0) / 2.0
            low, high = max(own * each.low - margin, declared.minimum), min(own * each.high + margin, declared.maximum)
        if low < high:
            yield Range(field=path, low=low, high=high, source=each.by)


def lubricant_ranges(scene) -> Iterator[Range]:
    """Yield the ranges of what the kind of base oil or the viscosity class alone says about a scene's lubricant."""
    lubricant = scene.lubricant
    law, oil, scale = lubricant.traction, lubricant.oil, lubricant.traction_scale
    if law.law == "eyring" and law.eyring_stress is law.limiting_ratio is law.pressure_index is None and oil.base != "aviation" and scale > 0.0:
        source = "traction by the kind of base oil is good to a factor of 1.5 (assumption)"
        low, high = scale / _TRACTION_FACTOR, min(scale * _TRACTION_FACTOR, 100.0)
        yield Range(field="lubricant.traction_scale", low=low, high=high, distribution="log_uniform", source=source)
    if oil.law == "custom" and oil.viscosity_100 is None and oil.name.startswith("ISO VG"):
        source = "a viscosity class reaches 10 % to either side (ISO 3448)"
        yield Range(field="lubricant.oil.viscosity_40", low=0.9 * oil.viscosity_40, high=1.1 * oil.viscosity_40, source=source)


def ring_ranges(scene) -> Iterator[Range]:
    """Yield the ranges of what decides how an inner ring vibrates on its rollers, at levels that compute it, where a scene has its defaults."""
    declared = {one.field for one in scene.uncertainty}
    if scene.level in WHIRLING:
        for field, default, low, high, source in _RING_RANGES:
            if value_at(scene, field) == default and field not in declared:
                yield Range(field=field, low=low, high=high, distribution="log_uniform", source=source)


def without_dimensions(fields: Iterable[str]) -> str:
    """Return the note `` (no dimension is uncertain)`` for a band of life whose uncertain fields contain no dimension that decides the clearance.

    Such dimensions are the lengths of raceways and rollers, the clearance, and the fits of shaft and housing.

    Parameters
    ----------
    fields : the uncertain ones, by dotted path.
    """
    from bearing_sim.scene.scene import Scene  # here, because a scene is made of ranges

    known = quantities(Scene)
    lengths = (path for path in fields if path.startswith(_DIMENSIONS) and path in known and known[path].unit == "m")
    return "" if any(lengths) else " (no dimension is uncertain)"


def shown(known: Mapping[str, Quantity], path: str, value: float) -> str:
    """Return a value of a field as text: with its unit for a quantity, as a whole number for a count."""
    return known[path].show(value) if path in known else f"{value:.0f}"


def written(ranges: Iterable[Mapping], scene_type: type) -> dict[str, dict]:
    """Return ranges as a file has them, without fields at their defaults."""
    plain, known = {}, quantities(scene_type)
    for one in ranges:
        kept = {
            name: value for name, value in one.items() if name != "field" and value not in (None, "") and (name, value) != ("distribution", "uniform")
        }
        if known[one["field"]].unit == SPEED:
            kept |= {name: known[one["field"]].written(kept[name]) for name in _ENDS if name in kept}
        plain[one["field"]] = kept
    return plain


def value_at(scene, path: str):
    """Return the value of a scene at a dotted path; None if there is none."""
    for name in path.split("."):
        scene = getattr(scene, name, None)
    return scene


def number_at(scene, path: str):
    """Return the value of a scene at a dotted path; that of a clearance given by its group is the middle of the group."""
    value = value_at(scene, path)
    return 2.0 * scene.bearing.radial_clearance_at_low_points if path == _CLEARANCE and isinstance(value, str) else value


def messages(error: ValidationError) -> str:
    """Return the messages of all checks that failed, in one line, each with the path of its field."""
    return "; ".join(": ".join(filter(None, (".".join(map(str, each["loc"])), each["msg"].removeprefix("Value error, ")))) for each in error.errors())


def with_values(scene, values: Mapping[str, float | str | None]):
    """Return a scene, or a record of one, with other numbers [SI], or names for them, at dotted paths; all checks run again.

    Raises
    ------
    pydantic.ValidationError
        The numbers contradict each other, one is out of bounds, or a record has no such field.
    """
    if isinstance(scene, Bearing) and scene.clearance is not None:
        values = _with_one_clearance(scene, values)
    changed: dict[str, dict[str, float | str | None]] = {}
    for path, value in values.items():
        name, _, rest = path.partition(".")
        changed.setdefault(name, {})[rest] = value if value is None or isinstance(value, str) else float(value)
    return dataclasses.replace(
        scene, **{name: inner[""] if "" in inner else with_values(getattr(scene, name), inner) for name, inner in changed.items()}
    )


def _with_one_clearance(bearing: Bearing, values: Mapping[str, float | str | None]) -> Mapping[str, float | str | None]:
    """Return values for a bearing that has a clearance, so that it follows from a radius that is given, and otherwise the radius from it."""
    if _LOW_RADIUS in values:
        inner = values.get("inner_raceway.radius", bearing.inner_raceway.radius)
        return {**values, "clearance": 2.0 * (values[_LOW_RADIUS] - inner - values.get("roller.diameter", bearing.roller.diameter))}
    if any(path in values for path in ("clearance", "inner_raceway.radius", "roller.diameter")):
        return {**values, _LOW_RADIUS: None}
    return values
