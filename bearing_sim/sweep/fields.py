# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fields of a scene that a sweep varies: found by their path, read and shown in units."""

import dataclasses
import types
import typing
from typing import Annotated, Any, NamedTuple

from bearing_sim.quantity import Quantity, unit_registry
from bearing_sim.scene import Scene
from bearing_sim.scene_file import did_you_mean

_TYPES = {int: "a whole number", bool: "true or false", str: "a word"}


class FieldError(ValueError):
    """A field, or values of one, that cannot be varied; the message says why."""


class Field(NamedTuple):
    """One field of a scene.

    Attributes
    ----------
    path : as an author writes it, with points.
    quantity : its declaration; None where it is a count, a word or a switch.
    kinds : what it may be besides.
    """

    path: str
    quantity: Quantity | None
    kinds: tuple[type, ...]

    @property
    def unit(self) -> str:
        """The unit that people read it in; empty for a pure number or a word."""
        return (self.quantity.shown_in or self.quantity.unit) if self.quantity is not None else ""

    @property
    def meaning(self) -> str:
        """What it is, in words."""
        return self.quantity.meaning if self.quantity is not None else self.path.rpartition(".")[2].replace("_", " ")

    def shown(self, value: float | int | str) -> float | int | str:
        """Return a value (SI) in `unit`; words and counts as they are."""
        if self.quantity is None or isinstance(value, str):
            return value
        return in_unit(value, self.quantity.unit, self.unit)

    def words(self) -> str:
        """Return what it takes, in words."""
        told = [_TYPES.get(kind, kind.__name__) for kind in self.kinds]
        return " or ".join(([f"a quantity in {self.unit}" if self.unit else "a number"] if self.quantity is not None else []) + told)


def in_unit(value: float, unit: str, shown_in: str) -> float:
    """Return a number in one unit converted to another, rounded to the 11 digits that survive it."""
    if unit == shown_in:
        return value
    registry = unit_registry()
    return float(f"{registry.Quantity(value, registry.Unit(unit or 'dimensionless')).to(shown_in or 'dimensionless').magnitude:.11g}")


def field_of(path: str) -> Field:
    """Return the field of a scene at a path such as ``bearing.outer_raceway.low_radius``.

    Raises
    ------
    FieldError
        There is no such field, or it is a block.
    """
    options: list[Any] = [Scene]
    for depth, name in enumerate(path.split(".")):
        records = [option for option in options if isinstance(option, type) and dataclasses.is_dataclass(option)]
        known = {field: hint for record in records for field, hint in typing.get_type_hints(record, include_extras=True).items()}
        if name not in known:
            at = ".".join(path.split(".")[:depth])
            told = f"known {f'in {at}' if at else 'here'}: {', '.join(known)}" if known else f"{at} is a value, not a block"
            raise FieldError(f"{path}: unknown field{did_you_mean(name, known)}; {told}")
        options = [option for record in records for option in _options(typing.get_type_hints(record, include_extras=True).get(name, type(None)))]
    quantities = [option for option in options if isinstance(option, Quantity)]
    kinds = tuple(option for option in options if option in (int, float, bool, str))
    if float in kinds and not quantities:
        quantities = [Quantity("", path.rpartition(".")[2].replace("_", " "))]
    if not quantities and not kinds:
        if any(dataclasses.is_dataclass(option) and "law" in typing.get_type_hints(option) for option in options):
            return Field(path, None, (str,))  # a law by its name
        raise FieldError(f"{path}: a block or a list, not a value that can be varied")
    return Field(path, quantities[0] if quantities else None, tuple(kind for kind in kinds if kind is not float))


def _options(hint) -> list:
    """Return quantities, records and plain types that an annotation admits."""
    origin = typing.get_origin(hint)
    if origin is Annotated:
        inner, *notes = typing.get_args(hint)
        return [note for note in notes if isinstance(note, Quantity)] or _options(inner)
    if origin in (typing.Union, types.UnionType):
        return [option for each in typing.get_args(hint) for option in _options(each)]
    if origin is typing.Literal:
        return [type(value) for value in typing.get_args(hint)[:1]]
    return [hint]
