# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured trade-offs: what `bearing-sim trade` found about a bearing, in a front file that a scene names, or kept in the user's cache folder.

A file holds the settings of all courses that were measured for one bearing in one lubricant.  It stands in this room because the loader reads it to
resolve ``level: auto``, and everything that runs a scene stands above the loader; writing is beside reading so that the format is in one place.
Nothing here imports the model.

What the errors depend on is the `digest_of` a scene: bearing, lubricant, mounting, support, heat, life, range and tolerance of the table and the
loads that are no inputs.  What a setting changes (level, integration, slices, whether the table is corrected) is not in it, nor are shaft speed,
radial load and oil temperature: a course says between which it was measured, and holds for scenes that operate there.  A front file fits every
scene of that digest, on any machine and with any version of the program.  Files in the cache are for one machine and version besides.
"""

import dataclasses
import hashlib
import math
import os
import platform
import time
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

from bearing_sim.files.kept import Damaged, cache_folder, checked_contents, read_kept, with_checksum
from bearing_sim.files.limits import JSON_FILE, FileError
from bearing_sim.files.outputs import BeingWritten, replaced
from bearing_sim.files.reading import read_bytes

VARIABLE = "BEARING_SIM_FRONTS"
"""Environment variable that names another folder for measured fronts than that in the user's cache."""
FOLDER = Path(os.environ.get(VARIABLE) or cache_folder() / "fronts")
_PACKAGE = Path(__file__).resolve().parents[1]
_SOURCES = ("numerics/*.py", "physics/*.py", "levels/**/*.py", "model/*.py", "simulation.py", "watchers/estimation/*.py")
_STUDIES = ("studies/trade.py", "studies/trade_course.py", "studies/correction_points.py")
_VERSION = 3  # of the files
_FIELDS = ("integration.", "bearing.roller.slices=", "table.correction=")  # that a setting changes, and nothing else
_SLACK = 1.25  # factor by which a scene may operate outside of what was measured in speed and load; assumption
_TEMPERATURE_SLACK = 10.0  # K, likewise
_PATIENCE, _PAUSE = 10.0, 0.05  # s, for another process that is writing
ERRORS = ("slip", "largest_slip", "load", "largest_load", "life", "window_life", "edge", "largest_edge")
"""Names of the errors of a setting, those of `bearing_sim.studies.trade.Errors`."""
_INPUTS = {"shaft_speed": "shaft speed", "radial_load": "radial load", "oil_temperature": "oil temperature"}


class Setting(NamedTuple):
    """One measured way to compute the bearing.

    Attributes
    ----------
    level : of fidelity.
    detail : tolerances, step or slices, in words.
    overrides : of a scene's fields, complete: tolerances, step and slices.
    real_time_factor : simulated over processor time on this machine.
    errors : by the names `ERRORS`: of slip in percentage points, others relative; NaN where they were not measured.
    """

    level: str
    detail: str
    overrides: tuple[str, ...]
    real_time_factor: float
    errors: Mapping[str, float]

    @property
    def name(self) -> str:
        """Name in messages."""
        return f"{self.level}, {self.detail}"

    @property
    def is_corrected(self) -> bool:
        """Whether the setting needs a corrected table, which a node does not build."""
        return any(each.startswith("table.correction=") and not each.endswith("=none") for each in self.overrides)


class MeasuredCourse(NamedTuple):
    """What was measured on one course.

    Attributes
    ----------
    name : of the course.
    reference : that errors are against, in words.
    own_errors : of the reference, as of `Setting`.
    extent : least and largest ``shaft_speed`` [rad/s, without sign], ``radial_load`` [N] and ``oil_temperature`` [K].
    settings : those that have a result.
    """

    name: str
    reference: str
    own_errors: Mapping[str, float]
    extent: Mapping[str, tuple[float, float]]
    settings: tuple[Setting, ...]

    def covers(self, scene) -> bool:
        """Return whether a scene operates where this course was measured, or nearly so; a shaft at rest is everywhere."""
        return self.covers_point(scene.operating.shaft_speed, scene.operating.radial_load, scene.lubricant.temperature)

    def covers_point(self, shaft_speed: float, radial_load: float, oil_temperature: float) -> bool:
        """Return whether this course was measured at a speed [rad/s], load [N] and oil temperature [K], or nearly so; see `covers`."""
        if shaft_speed == 0.0:
            return True
        (slow, fast), (low, high), (cold, warm) = (self.extent[name] for name in _INPUTS)
        is_warm = cold - _TEMPERATURE_SLACK <= oil_temperature <= warm + _TEMPERATURE_SLACK
        return is_warm and slow / _SLACK <= abs(shaft_speed) <= fast * _SLACK and low / _SLACK <= radial_load <= high * _SLACK


class Tradeoffs(NamedTuple):
    """What was measured of a bearing.

    Attributes
    ----------
    path : of the file.
    courses : that were measured, the newest last.
    digest : of the scenes that it fits (see `digest_of`); empty: any.
    machine : that ran the settings.
    is_kept : whether the file is in the cache of this machine and no scene names it.
    """

    path: Path
    courses: tuple[MeasuredCourse, ...]
    digest: str = ""
    machine: str = ""
    is_kept: bool = True

    @property
    def name(self) -> str:
        """Name in messages, without the folder."""
        return f"kept front {self.path.name}" if self.is_kept else f"front {self.path.name}"

    def fits(self, scene) -> bool:
        """Return whether it was measured on the bearing, lubricant, mounting and range of tables of a scene."""
        return self.digest in ("", digest_of(scene))

    def at(self, scene) -> "Tradeoffs":
        """Return the courses that cover the operating point of a scene."""
        return self._replace(courses=tuple(course for course in self.courses if course.covers(scene)))

    def settings(self) -> list[Setting]:
        """Return the settings of all courses, each with its worst errors and its least real-time factor, the fastest first.

        Of several courses only settings that were measured on each of them count, because nothing is known of the others there.
        """
        found: dict[tuple[str, ...], list[Setting]] = {}
        for course in self.courses:
            for setting in course.settings:
                found.setdefault((setting.level, *setting.overrides), []).append(setting)
        together = [_worst(each) for each in found.values() if len(each) == len(self.courses)]
        return sorted(together, key=lambda setting: -setting.real_time_factor)

    def own_errors(self) -> dict[str, float]:
        """Return the largest errors of the references of all courses by name; NaN where none is known."""
        names = {name for course in self.courses for name in course.own_errors}
        known = {name: [each for course in self.courses if not math.isnan(each := course.own_errors.get(name, math.nan))] for name in names}
        return {name: max(values, default=math.nan) for name, values in known.items()}


def _worst(settings: list[Setting]) -> Setting:
    """Return one setting measured on several courses; an error that is not known on one of them is not known."""
    errors = {
        name: math.nan if any(math.isnan(one.errors[name]) for one in settings) else max(one.errors[name] for one in settings)
        for name in settings[0].errors
    }
    return settings[0]._replace(errors=errors, real_time_factor=min(one.real_time_factor for one in settings))


def extent_in_words(extent: Mapping[str, tuple[float, float]]) -> str:
    """Return a range of speed, load and temperature (see `MeasuredCourse`) in the units that people use."""
    (slow, fast), (low, high), (cold, warm) = (extent[name] for name in _INPUTS)
    turns = 30.0 / math.pi
    return f"{slow * turns:.5g} to {fast * turns:.5g} rpm, {low:.5g} to {high:.5g} N, {cold - 273.15:.3g} to {warm - 273.15:.3g} degC"


def complete_overrides(scene) -> tuple[str, ...]:
    """Return the overrides that give another scene the steps, tolerances and slices of this one, whatever its own are."""
    integration, absolute = scene.integration, scene.integration.absolute_tolerance
    if scene.level == "steady":
        return ("integration.fixed_step=null", f"table.correction={scene.table.correction}")
    fields = {f"absolute_tolerance.{name}": getattr(absolute, name) for name in ("position", "play", "speed")}
    fields |= {name: getattr(integration, name) for name in ("relative_tolerance", "maximum_step", "fixed_step")}
    written = tuple(f"integration.{name}={'null' if value is None else repr(float(value))}" for name, value in fields.items())
    return (*written, f"bearing.roller.slices={scene.bearing.roller.slices or 'null'}") if scene.level == "spatial" else written


def is_coarser(overrides: Iterable[str], than: Iterable[str]) -> bool:
    """Return whether a setting is coarser in some of its steps, tolerances and slices than another of its level, and finer in none, hence faster.

    One with a fixed step and one without do not compare.

    Parameters
    ----------
    overrides, than : of the settings, see `complete_overrides`.
    """
    ours, theirs = _coarseness(overrides), _coarseness(than)
    return ours != theirs and ours.keys() == theirs.keys() and all(ours[name] >= theirs[name] for name in ours)


def _coarseness(overrides: Iterable[str]) -> dict[str, float]:
    """Return numbers by name that are the larger the coarser a setting is; what is no number becomes part of the name."""
    found = {}
    for each in overrides:
        name, _, text = each.partition("=")
        try:
            found[name] = -float(text) if name == "bearing.roller.slices" else float(text)
        except ValueError:
            found[each] = 0.0
    return found


@cache
def machine() -> str:
    """Return the name of this machine and the model of its processor."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            processor = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), platform.machine())
    except OSError:
        processor = platform.machine()
    return f"{platform.node()}, {processor}"


@cache
def _program() -> str:
    """Return a hash of the sources that measured errors and times depend on; without importing the compiler."""
    digest = hashlib.sha256()
    for name in ("numba", "numpy"):
        try:
            digest.update(version(name).encode())
        except PackageNotFoundError:
            pass
    for pattern in (*_SOURCES, *_STUDIES):
        for path in sorted(_PACKAGE.glob(pattern)):
            digest.update(path.relative_to(_PACKAGE).as_posix().encode() + path.read_bytes())
    return digest.hexdigest()


def digest_of(scene) -> str:
    """Return a hash of what the errors of settings depend on in a scene; of numbers the first nine digits count, since machines differ beyond."""
    bearing = dataclasses.asdict(scene.bearing)
    for name in ("name", "source", "designation", "estimated"):
        bearing.pop(name, None)
    bearing["roller"].pop("slices", None)
    lubricant = dataclasses.asdict(scene.lubricant)
    lubricant.pop("temperature", None)
    operating = dataclasses.asdict(scene.operating)
    held = {name: value for name, value in operating.items() if name not in ("shaft_speed", "radial_load", "load_angle")}
    table = dataclasses.asdict(scene.table)
    table.pop("correction")
    blocks = [dataclasses.asdict(getattr(scene, name)) for name in ("mounting", "support", "heat", "dynamics", "life")]
    return hashlib.sha256(repr(_rounded([bearing, lubricant, held, table, *blocks])).encode()).hexdigest()[:24]


def _rounded(value):
    """Return a value with every number in it as a text of nine digits."""
    if isinstance(value, Mapping):
        return {name: _rounded(inner) for name, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_rounded(inner) for inner in value]
    return f"{value:.9g}" if isinstance(value, float) else value


def kept_path(scene) -> Path:
    """Return where the measured settings of a scene's bearing are kept for this machine and program."""
    digest = hashlib.sha256("\n".join((_program(), machine(), digest_of(scene))).encode())
    return FOLDER / f"{digest.hexdigest()[:24]}.json"


def read_kept_tradeoffs(scene) -> Tradeoffs | None:
    """Return what is kept for a scene's bearing on this machine, or None where there is nothing, or nothing that is whole."""
    path = kept_path(scene)
    return read_kept(path, JSON_FILE, lambda data: _parsed(path, data, is_kept=True))


def read_front(path: Path) -> Tradeoffs:
    """Return what a front file holds.

    Raises
    ------
    ValueError
        There is no such file, or it cannot be read, or is damaged; the message says why.
    """
    try:
        return _parsed(path, read_bytes(path, JSON_FILE), is_kept=False)
    except FileError as error:
        raise ValueError(error.reason) from None


def _parsed(path: Path, data: bytes, is_kept: bool) -> Tradeoffs:
    version, stored = checked_contents(data, "front")
    if version != _VERSION:
        raise Damaged(f"it is of version {version}; this program reads version {_VERSION}")
    try:
        courses = tuple(map(_course, stored["courses"]))
        return Tradeoffs(path, courses, str(stored["digest"]), str(stored["machine"]), is_kept)
    except (KeyError, TypeError, IndexError, AttributeError) as error:
        raise Damaged(f"it holds something else than a front ({type(error).__name__}: {error})") from None


def _course(stored: Mapping) -> MeasuredCourse:
    extent = {name: (_finite(stored["extent"][name][0]), _finite(stored["extent"][name][1])) for name in _INPUTS}
    return MeasuredCourse(
        str(stored["name"]), str(stored["reference"]), _errors(stored["own_errors"]), extent, tuple(map(_setting, stored["settings"]))
    )


def _setting(stored: Mapping) -> Setting:
    overrides = tuple(map(str, stored["overrides"]))
    if foreign := [each for each in overrides if not each.startswith(_FIELDS)]:  # a front from a stranger changes nothing else of a scene
        raise Damaged(f"a setting changes {foreign[0].partition('=')[0]!r}, which is no setting")
    errors = _errors({name: stored["errors"][name] for name in ERRORS})
    return Setting(str(stored["level"]), str(stored["detail"]), overrides, _finite(stored["real_time_factor"]), errors)


def _finite(value) -> float:
    if not 0.0 <= value < math.inf:  # NaN fails here, too
        raise Damaged(f"it has {value!r} where a number that is not negative belongs")
    return float(value)


def _errors(stored: Mapping) -> dict[str, float]:
    return {str(name): math.nan if value is None else _finite(value) for name, value in stored.items()}


def keep(scene, course: MeasuredCourse) -> Tradeoffs:
    """Add what was measured on a course to what is kept for a scene's bearing on this machine, and return that; see `add_to_front`.

    A damaged file counts as missing.
    """
    path = kept_path(scene)
    path.parent.mkdir(parents=True, exist_ok=True)
    return _add(path, scene, course, lambda: read_kept_tradeoffs(scene), machine(), is_kept=True)


def add_to_front(path: Path, scene, course: MeasuredCourse) -> Tradeoffs:
    """Add what was measured on a course to a front file that fits a scene, or write a new one; return what it holds then.

    A course of the same name, extent and reference gets the new settings beside those of its old ones that were not measured again; of another
    reference it is replaced.  A reader finds the old file or the new one, never a part.

    Raises
    ------
    ValueError
        There is a file which is no front of this scene (see `front_to_extend`).
    OSError
        It cannot be written, also if another process keeps writing it for ten seconds.
    """
    return _add(path, scene, course, lambda: front_to_extend(path, scene), machine().partition(", ")[2], is_kept=False)


def front_to_extend(path: Path, scene) -> Tradeoffs | None:
    """Return a front file to which more of a scene's bearing can be added, or None where there is no file.

    Raises
    ------
    ValueError
        It cannot be read, is damaged, or was measured on something else.
    """
    if not os.path.lexists(path):
        return None
    front = read_front(path)
    if not front.fits(scene):
        raise ValueError("it was measured on another bearing, lubricant, mounting or range of tables; give another file")
    return front


def _add(path: Path, scene, course: MeasuredCourse, before: Callable[[], Tradeoffs | None], machine_name: str, is_kept: bool) -> Tradeoffs:
    end = time.monotonic() + _PATIENCE
    while True:
        try:
            with replaced(path) as draft:  # alone among writers from here on
                known = before()
                found = Tradeoffs(path, tuple(_merged(known.courses if known else (), course)), digest_of(scene), machine_name, is_kept)
                stored = {"digest": found.digest, "machine": found.machine, "bearing": scene.bearing.name}
                draft.write_bytes(with_checksum("front", _VERSION, stored | {"courses": [_stored(each) for each in found.courses]}))
            return found
        except BeingWritten:
            if time.monotonic() > end:
                raise
            time.sleep(_PAUSE)


def _merged(before: Iterable[MeasuredCourse], course: MeasuredCourse) -> list[MeasuredCourse]:
    others = []
    for old in before:
        if (old.name, dict(old.extent)) != (course.name, dict(course.extent)):
            others.append(old)
        elif old.reference == course.reference:
            new = {(one.level, one.detail) for one in course.settings}
            course = course._replace(settings=(*(one for one in old.settings if (one.level, one.detail) not in new), *course.settings))
    return [*others, course]


def _stored(course: MeasuredCourse) -> dict:
    def finite(errors):
        return {name: value if math.isfinite(value) else None for name, value in errors.items()}

    settings = [one._asdict() | {"errors": finite(one.errors)} for one in course.settings]
    return course._asdict() | {"own_errors": finite(course.own_errors), "settings": settings}
