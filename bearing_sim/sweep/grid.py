# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Parameter sweeps: the scene fields that a sweep varies, its axes, and the table of all combinations of their values."""

import dataclasses
import itertools
import math
import re
import types
import typing
from collections.abc import Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any, NamedTuple, Protocol

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.scene.diameters import diameters
from bearing_sim.scene.fidelity import Level
from bearing_sim.scene.loader import SceneError, did_you_mean, load_scene, override_texts, scene_to_yaml
from bearing_sim.scene.quantity import Quantity, QuantityOrName, to_si, unit_registry
from bearing_sim.scene.scene import OPERATING_POINT, Scene
from bearing_sim.simulation import positive_seconds
from bearing_sim.sweep.point import DURATION, OTHER_STATE, REFUSED, RESULTS, TEXTS, Column, empty_row, point_row
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.tasks import Journal, Progress, Task, in_silence, run_tasks, task

_TYPES = {int: "a whole number", bool: "true or false", str: "a word"}


class FieldError(ValueError):
    """A field or values that a sweep cannot vary; the message says why."""


class Field(NamedTuple):
    """One field of a scene.

    Attributes
    ----------
    path : dotted path.
    quantity : its declaration; None for counts, words and switches.
    kinds : plain types that the field accepts besides the quantity.
    """

    path: str
    quantity: Quantity | None
    kinds: tuple[type, ...]

    @property
    def unit(self) -> str:
        """The display unit; empty for a pure number or a word."""
        return (self.quantity.shown_in or self.quantity.unit) if self.quantity is not None else ""

    @property
    def meaning(self) -> str:
        """Meaning of the field, in one line."""
        return self.quantity.meaning if self.quantity is not None else self.path.rpartition(".")[2].replace("_", " ")

    def shown(self, value: float | int | str) -> float | int | str:
        """Return a value [SI] in `unit`; words and counts are returned unchanged."""
        if self.quantity is None or isinstance(value, str):
            return value
        return in_unit(value, self.quantity.unit, self.unit)

    def words(self) -> str:
        """Return the accepted values, for error messages."""
        plain = [_TYPES.get(kind, kind.__name__) for kind in self.kinds]
        return " or ".join(([f"a quantity in {self.unit}" if self.unit else "a number"] if self.quantity is not None else []) + plain)


def in_unit(value: float, unit: str, shown_in: str) -> float:
    """Return a number in one unit converted to another, rounded to 11 digits."""
    if unit == shown_in:
        return value
    registry = unit_registry()
    return float(f"{registry.Quantity(value, registry.Unit(unit or 'dimensionless')).to(shown_in or 'dimensionless').magnitude:.11g}")


def field_of(path: str) -> Field:
    """Return the field of a scene at a path such as ``bearing.outer_raceway.low_radius``.

    Raises
    ------
    FieldError
        The field does not exist, or is a block.
    """
    if path in diameters(Scene):
        return Field(path, diameters(Scene)[path].quantity, ())
    options: list[Any] = [Scene]
    for depth, name in enumerate(path.split(".")):
        records = [option for option in options if isinstance(option, type) and dataclasses.is_dataclass(option)]
        known = {field: hint for record in records for field, hint in typing.get_type_hints(record, include_extras=True).items()}
        if name not in known:
            at = ".".join(path.split(".")[:depth])
            expected = f"known {f'in {at}' if at else 'here'}: {', '.join(known)}" if known else f"{at} is a value, not a block"
            raise FieldError(f"{path}: unknown field{did_you_mean(name, known)}; {expected}")
        options = [option for record in records for option in _options(typing.get_type_hints(record, include_extras=True).get(name, type(None)))]
    quantities = [option for option in options if isinstance(option, Quantity)]
    kinds = tuple(option for option in options if option in (int, float, bool, str))
    if float in kinds and not quantities:
        quantities = [Quantity("", path.rpartition(".")[2].replace("_", " "))]
    if not quantities and not kinds:
        if any(dataclasses.is_dataclass(option) and "law" in typing.get_type_hints(option) for option in options):
            return Field(path, None, (str,))  # a law, by name
        if path == "bearing":
            return Field(path, None, (str,))  # by designation
        raise FieldError(f"{path}: is a block or a list; expected a single value")
    return Field(path, quantities[0] if quantities else None, tuple(kind for kind in kinds if kind is not float))


def _options(hint) -> list:
    """Return the quantities, records and plain types that an annotation accepts."""
    origin = typing.get_origin(hint)
    if origin is Annotated:
        inner, *notes = typing.get_args(hint)
        return [note for note in notes if isinstance(note, Quantity)] or _options(inner)
    if origin in (typing.Union, types.UnionType):
        return [option for each in typing.get_args(hint) for option in _options(each)]
    if origin is typing.Literal:
        return [type(value) for value in typing.get_args(hint)[:1]]
    return [hint]


MOST_VALUES, MOST_POINTS = 100_000, 1_000_000
_RANGE = "15000 rpm:45000 rpm:4"
_NUMBER_ALONE = re.compile(r"\s*[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\s*")


class Axis(NamedTuple):
    """A field and its values: SI numbers, counts or words."""

    field: Field
    values: tuple[float | int | str, ...]

    @property
    def shown(self) -> list:
        """The values in the display unit."""
        return [self.field.shown(value) for value in self.values]

    @property
    def about(self) -> dict:
        """The axis as a table describes it."""
        return {"field": self.field.path, "unit": self.field.unit, "values": self.shown}

    def override(self, value: float | int | str) -> str:
        """Return the override that sets the field to a value (see `bearing_sim.scene.loader.load_scene`)."""
        declared = self.field.quantity
        written = value if isinstance(value, str) else repr(value) if declared is None else declared.written(value)
        return f"{self.field.path}={written}"


def axis(field: str, values: Iterable[float | str] | str) -> Axis:
    """Return an axis of values, without repetitions, in the given order.

    Parameters
    ----------
    field : dotted path in the scene, or a name of `bearing_sim.scene.scene.OPERATING_POINT`.
    values : numbers in SI, texts with a unit, or words; or a text as of `read_axis`, such as ``"15000 rpm:45000 rpm:4"``.

    Raises
    ------
    FieldError
        The field is unknown, there are no values, or one has the wrong type; the message says what was expected.
    """
    field = OPERATING_POINT.get(field, field)
    if isinstance(values, str):
        return read_axis(f"{field}={values}")
    known = field_of(field)
    if not isinstance(values, Iterable):
        raise FieldError(f"{field}: {values!r}; expected values such as [{values!r}], or a text such as {_RANGE!r}")
    if not (given := list(values)):
        raise FieldError(f"{field}: no values; expected at least one")
    return Axis(known, tuple(dict.fromkeys(_as_value(known, value) for value in given)))


def read_varied(varied: "Varied") -> tuple[list[Axis], list[tuple] | None]:
    """Return the axes of what `run_sweep` varies, and the combinations of their values where these are given point by point."""
    if hasattr(varied, "to_dict"):
        varied = varied.to_dict("records")
    if isinstance(varied, Mapping):
        return [axis(field, values) for field, values in varied.items()], None
    given = list(varied) if isinstance(varied, Iterable) and not isinstance(varied, str) else []
    if not given:
        raise FieldError(f"{varied!r}: expected a mapping of fields to values, or a list of points such as {{'radial_load': '1 kN'}}, at least one")
    if all(isinstance(each, Axis) for each in given):
        return given, None
    if len(given) > MOST_POINTS:
        raise FieldError(f"{len(given)} points; a sweep has at most {MOST_POINTS}")
    names = given[0] if isinstance(given[0], Mapping) else {}
    for number, point in enumerate(given):
        if not isinstance(point, Mapping) or not point or point.keys() != names.keys():
            raise FieldError(f"point {number} is {point!r}; expected a mapping of fields to values, the same fields {list(names)} for every point")
    fields = [field_of(OPERATING_POINT.get(name, name)) for name in names]
    points = [tuple(_as_value(field, point[name]) for field, name in zip(fields, names)) for point in given]
    return [Axis(field, tuple(dict.fromkeys(values))) for field, values in zip(fields, zip(*points))], points


def _as_value(field: Field, value: float | str) -> float | int | str:
    value = value.item() if hasattr(value, "item") else value  # a number of NumPy as one of Python
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if isinstance(value, str):
        return _value(f"{field.path}={value}", field, value.strip())
    if field.quantity is not None and is_number:
        return float(value)
    if int in field.kinds and is_number and math.isfinite(value) and value == int(value):
        return int(value)
    if bool in field.kinds and isinstance(value, bool):
        return str(value).lower()
    raise FieldError(f"{field.path} takes {field.words()}, got {value!r}")


def read_axis(text: str, written: bool = False) -> Axis:
    """Return the axis of a text such as ``operating.shaft_speed=15000rpm:52000rpm:8`` or ``bearing.roller.crown=none,iso_log``.

    Parameters
    ----------
    text : FIELD=VALUES.
    written : whether it is an option of a command line, on which a quantity needs its unit.

    Raises
    ------
    FieldError
        The field is unknown, or a value has the wrong type; the message says what was expected.
    """
    path, equals, given = (part.strip() for part in text.partition("="))
    if not equals or not path or not given:
        raise FieldError(f"{text!r}: expected FIELD=START:STOP:N or FIELD=a,b,c")
    field = field_of(path)
    if ":" in given:
        return Axis(field, _range(text, field, given, written))
    return Axis(field, tuple(dict.fromkeys(_value(text, field, part.strip(), written) for part in given.split(","))))


def _range(text, field, given, written) -> tuple:
    parts = [part.strip() for part in given.split(":")]
    if len(parts) != 3 or not parts[2].isdigit() or not 1 <= int(parts[2]) <= MOST_VALUES:
        raise FieldError(f"{text!r}: expected FIELD=START:STOP:N with N from 1 to {MOST_VALUES}")
    bare = [part for part in parts[:2] if _NUMBER_ALONE.fullmatch(part) and float(part) != 0.0]
    if len(bare) == 1 and field.unit:
        raise FieldError(f"{text!r}: only one end has a unit; give both {parts[0]} and {parts[1]} a unit, such as {field.unit}")
    ends = [_value(text, field, part, written) for part in parts[:2]]
    if not all(isinstance(end, (int, float)) and not isinstance(end, bool) for end in ends):
        raise FieldError(f"{text!r}: a range needs numbers; list the values as FIELD=a,b,c")
    if field.quantity is None:
        values = np.linspace(*ends, int(parts[2]))
        if not np.allclose(values, np.rint(values)):
            raise FieldError(f"{text!r}: {field.path} takes whole numbers; {parts[2]} values from {parts[0]} to {parts[1]} are not all whole")
        return tuple(dict.fromkeys(np.rint(values).astype(int).tolist()))
    # Step in the display unit and convert the text back, so that a point equals, to the last digit, what a scene file would give.
    values = np.linspace(*map(field.shown, ends), int(parts[2])).tolist()
    return tuple(dict.fromkeys(to_si(f"{value:.11g} {field.unit}", field.quantity.unit) for value in values))


def _value(text, field, part, written=False) -> float | int | str:
    if bool in field.kinds and part.lower() in ("true", "false"):
        return part.lower()
    if int in field.kinds and re.fullmatch(r"[-+]?\d+", part):
        return int(part)
    if isinstance(field.quantity, QuantityOrName) and part.upper() in field.quantity.names:
        return part.upper()
    if field.quantity is not None:
        if written and (reason := field.quantity.why_unit_is_needed(part)):
            raise FieldError(f"{text!r}: {field.path}: {reason}")
        try:
            return to_si(part, field.quantity.unit)
        except ValueError as error:
            raise FieldError(f"{text!r}: {field.path}: {error}") from None
    if str in field.kinds and part:
        return part
    raise FieldError(f"{text!r}: {field.path} takes {field.words()}, got {part!r}")


def point_count(axes: Sequence[Axis]) -> int:
    """Return the number of combinations of values; raise `FieldError` where there are more than `MOST_POINTS`."""
    count = math.prod(len(axis.values) for axis in axes)
    if count > MOST_POINTS:
        raise FieldError(f"{count} points; a sweep has at most {MOST_POINTS}")
    return count


class Frame(Protocol):
    """A frame of pandas, whether or not its types are known."""

    def to_dict(self, orient: Any) -> Any: ...


Varied = Mapping[str, Iterable[float | str] | str] | Sequence[Axis] | Sequence[Mapping[str, Any]] | Frame


def run_sweep(
    scene: Scene | Mapping | str | Path,
    axes: "Varied",
    overrides: list[str] | tuple[str, ...] | Mapping[str, Any] = (),
    *,
    level: Level | None = None,
    duration: float | str = DURATION,
    journal: Journal | str | Path | None = None,
    workers: int | None = None,
    dask: str | None = None,
    progress: Progress = in_silence,
) -> Table:
    """Run a scene at every combination of values, or at every point of a list, on all cores, until each point has settled.

    Workers do not import the script that calls this, so that it needs no ``if __name__ == "__main__"``.

    Parameters
    ----------
    scene, overrides : as `bearing_sim.load_scene` takes them.
    axes : the varied fields with their values, see `axis`, such as ``{"shaft_speed": "15000 rpm:45000 rpm:4", "bearing.clearance": ["C3",
        "40 um"]}``; the first varies slowest.  Or points, each a mapping of the same fields to a value, or a row of a frame of pandas.
    level : of fidelity; the scene's own where absent.
    duration : of the shortest run of a point [s], see `bearing_sim.sweep.point.run_until_settled`.
    journal : of finished points, which are not computed again, or the path of its file; kept in memory where absent.
    workers, dask, progress : see `bearing_sim.sweep.tasks.run_tasks`.

    Returns
    -------
    one row per point, in the order given: the varied fields, then `RESULTS`, `OTHER_STATE` and `TEXTS` of `bearing_sim.sweep.point`; see
    `bearing_sim.sweep.table.Table.to_xarray`.

    Raises
    ------
    FieldError
        A field or a value cannot be varied, points have not the same fields, or there are none or too many.
    SceneError
        No point has a valid scene; the errors are those of the first point.
    ClusterError
        See `bearing_sim.sweep.tasks.run_tasks`.
    JournalInUse
        Another process is writing the journal.
    """
    varied, points = read_varied(axes)
    changed = [*override_texts(overrides), *([f"level={level}"] if level else [])]
    plan = plan_sweep(scene, changed, varied, positive_seconds("duration", duration), points=points)
    with nullcontext(journal) if isinstance(journal, Journal) else Journal(None if journal is None else Path(journal)) as kept:
        return plan.table(run_tasks(plan.tasks, kept, workers, dask, progress))


class Plan(NamedTuple):
    """A sweep before it is computed.

    Attributes
    ----------
    name : of the scene.
    overrides, axes, duration : see `run_sweep`.
    combinations : of the values, one of each axis.
    scenes : the scene of each combination, or the error of an invalid one.
    longest : of the longest run of a point [s], see `bearing_sim.sweep.point.run_until_settled`; None for its default.
    is_grid : whether the combinations are all that there are.
    """

    name: str
    overrides: tuple[str, ...]
    axes: tuple[Axis, ...]
    duration: float
    combinations: tuple[tuple, ...]
    scenes: tuple[Scene | SceneError, ...]
    longest: float | None = None
    is_grid: bool = True

    @property
    def tasks(self) -> list[Task]:
        """One task for each valid point."""
        return [task(scene.level, point_row, scene, self.duration, self.longest) for scene in self.scenes if isinstance(scene, Scene)]

    def table(self, results: Iterable[dict]) -> Table:
        """Return the table of all points from the results of `tasks`."""
        results, rows = iter(results), []
        for combination, scene in zip(self.combinations, self.scenes):
            shown = {axis.field.path: axis.field.shown(value) for axis, value in zip(self.axes, combination)}
            rows.append(shown | (_complete(next(results)) if isinstance(scene, Scene) else empty_row(REFUSED, one_line(scene))))
        columns = tuple(Column(axis.field.path, axis.field.unit, axis.field.meaning) for axis in self.axes) + RESULTS + OTHER_STATE + TEXTS
        return Table(columns, rows, self._about())

    def _about(self) -> dict:
        scene = next(scene for scene in self.scenes if isinstance(scene, Scene))
        return {
            "kind": "sweep" if self.is_grid else "points",
            "scene": self.name,
            "overrides": list(self.overrides),
            "level": scene.level if all(axis.field.path != "level" for axis in self.axes) else "varied",
            "axes" if self.is_grid else "varied": [each.about for each in self.axes],
            "duration": self.duration,
            "version": package_version(),
            "commit": git_hash(),
            "scene_of_first_point": scene_to_yaml(scene),
        }


def plan_sweep(
    scene: Scene | Mapping | str | Path,
    overrides: Sequence[str],
    axes: Sequence[Axis],
    duration: float = DURATION,
    longest: float | None = None,
    points: Sequence[tuple] | None = None,
) -> Plan:
    """Return the plan of a sweep; ``longest`` as of `Plan`, ``points`` as of `read_varied`, the other parameters and errors as for `run_sweep`."""
    if points is None:
        point_count(axes)
    combinations = tuple(itertools.product(*(axis.values for axis in axes)) if points is None else points)
    scenes = tuple(scene_at(scene, overrides, axes, combination) for combination in combinations)
    if not any(isinstance(each, Scene) for each in scenes):
        raise scenes[0]
    name = scene.name if isinstance(scene, Scene) else str(scene.get("name", "scene") if isinstance(scene, Mapping) else scene)
    return Plan(name, tuple(overrides), tuple(axes), float(duration), combinations, scenes, longest, points is None)


def scene_at(scene: Scene | Mapping | str | Path, overrides: Sequence[str], axes: Sequence[Axis], combination: Sequence) -> Scene | SceneError:
    """Return the scene at one value of each axis, or the error if it is invalid; the other parameters as for `run_sweep`."""
    try:
        return load_scene(scene, [*overrides, *(axis.override(value) for axis, value in zip(axes, combination))])
    except SceneError as error:
        return error


def _complete(result: dict) -> dict:
    """Return a result with all columns; that of a lost worker has only status and reason."""
    return result if len(result) > len(TEXTS) else empty_row(result["status"], result["reason"])


def one_line(error: SceneError) -> str:
    """Return all errors of a scene in one line."""
    return "; ".join(map(str, error.errors))
