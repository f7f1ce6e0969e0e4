# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One axis of a sweep: a field of the scene and the values it takes, read from ``FIELD=START:STOP:N`` or ``FIELD=a,b,c``."""

import re
from typing import NamedTuple

import numpy as np

from bearing_sim.quantity import to_si
from bearing_sim.sweep.fields import Field, FieldError, field_of

MOST_VALUES = 100_000
_NUMBER_ALONE = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*")


class Axis(NamedTuple):
    """A field and its values: SI numbers, counts or words."""

    field: Field
    values: tuple[float | int | str, ...]

    @property
    def shown(self) -> list:
        """The values in the unit that people read."""
        return [self.field.shown(value) for value in self.values]

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return not any(isinstance(value, (str, bool)) for value in self.values)

    def override(self, value: float | int | str) -> str:
        """Return what sets the field to one of the values, as `bearing_sim.scene_file.load_scene` takes it."""
        return f"{self.field.path}={value if isinstance(value, str) else repr(value)}"


def axis(field: str, values) -> Axis:
    """Return an axis of values in SI, each once and in their order.

    Parameters
    ----------
    field : path of a scene's field.
    values : numbers in SI, or words.
    """
    return Axis(field_of(field), tuple(dict.fromkeys(values)))


def read_axis(text: str) -> Axis:
    """Return the axis that a text such as ``operating.shaft_speed=15000rpm:52000rpm:8`` or ``bearing.roller.crown=none,iso_log`` says.

    Raises
    ------
    FieldError
        The field is unknown, or the values are none of its kind; the message says what was expected.
    """
    path, equals, given = (part.strip() for part in text.partition("="))
    if not equals or not path or not given:
        raise FieldError(f"{text!r}: expected FIELD=START:STOP:N or FIELD=a,b,c")
    field = field_of(path)
    if ":" in given:
        return Axis(field, _range(text, field, given))
    return Axis(field, tuple(dict.fromkeys(_value(text, field, part.strip()) for part in given.split(","))))


def _range(text, field, given) -> tuple:
    parts = [part.strip() for part in given.split(":")]
    if len(parts) != 3 or not parts[2].isdigit() or not 1 <= int(parts[2]) <= MOST_VALUES:
        raise FieldError(f"{text!r}: expected FIELD=START:STOP:N, N a number of values from 1 to {MOST_VALUES}")
    bare = [part for part in parts[:2] if _NUMBER_ALONE.fullmatch(part) and float(part) != 0.0]
    if len(bare) == 1 and field.unit:
        raise FieldError(f"{text!r}: one end has a unit and the other has none; give both, such as {parts[0]} and {parts[1]} in {field.unit}")
    ends = [_value(text, field, part) for part in parts[:2]]
    if not all(isinstance(end, (int, float)) and not isinstance(end, bool) for end in ends):
        raise FieldError(f"{text!r}: only numbers have a range; list values as FIELD=a,b,c")
    if field.quantity is None:
        values = np.linspace(*ends, int(parts[2]))
        if not np.allclose(values, np.rint(values)):
            raise FieldError(f"{text!r}: {field.path} takes whole numbers, and {parts[2]} even steps from {parts[0]} to {parts[1]} are none")
        return tuple(dict.fromkeys(np.rint(values).astype(int).tolist()))
    # Stepped in the unit that people read and read back from what they would write: to the last digit the point that a scene file says.
    values = np.linspace(*map(field.shown, ends), int(parts[2])).tolist()
    return tuple(dict.fromkeys(to_si(f"{value:.11g} {field.unit}", field.quantity.unit) for value in values))


def _value(text, field, part) -> float | int | str:
    if bool in field.kinds and part.lower() in ("true", "false"):
        return part.lower()
    if int in field.kinds and re.fullmatch(r"[-+]?\d+", part):
        return int(part)
    if field.quantity is not None:
        try:
            return to_si(part, field.quantity.unit)
        except ValueError as fault:
            raise FieldError(f"{text!r}: {field.path}: {fault}") from None
    if str in field.kinds and part:
        return part
    raise FieldError(f"{text!r}: {field.path} takes {field.words()}, got {part!r}")
