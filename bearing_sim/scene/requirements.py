# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a scene wants, with the largest errors that it accepts, and the fastest setting whose measured errors are below them.

``wants`` is a list of names, or a mapping of names to errors.  An error counts only where `bearing-sim trade` has measured it on the scene's
bearing: in the front file that the scene names, else on this machine (`bearing_sim.scene.measured_tradeoffs`).  Without that nothing is claimed, and
the most accurate level is taken.
"""

import math
import shlex
from collections.abc import Mapping
from typing import NamedTuple

from bearing_sim.scene.errors import InvalidField, did_you_mean
from bearing_sim.scene.fidelity import LEVELS, WANTS, WHIRLING, Choice, asked_for, choose, levels_with
from bearing_sim.scene.measured_tradeoffs import Setting, Tradeoffs, extent_in_words
from bearing_sim.scene.quantity import in_digits, to_si

_ROUNDED = 1.0 + 1e-9  # an error in points and the same one as a fraction are equal
_LARGEST = 3.0  # times a wanted error that the largest error of any bin or window may be


class _Measured(NamedTuple):
    """How a trade measures the error of something wanted.

    Attributes
    ----------
    error, largest : names of the errors of a `bearing_sim.scene.measured_tradeoffs.Setting`: over the course, and the largest of it.
    scale : of these numbers to those that a scene has.
    unit : of an error times 100, in messages.
    """

    error: str
    largest: str
    scale: float
    unit: str


MEASURED = {
    "slip": _Measured("slip", "largest_slip", 0.01, "points"),
    "life": _Measured("life", "window_life", 1.0, "%"),
    "roller_loads": _Measured("load", "largest_load", 1.0, "%"),
    "edge_loads": _Measured("edge", "largest_edge", 1.0, "%"),
}
"""The entries of `wants` whose errors are measured."""


def read_requirements(given) -> tuple[object, dict[str, float], list[InvalidField]]:
    """Read a block ``wants``.

    Parameters
    ----------
    given : a list of names, or a mapping of names to largest errors such as ``0.3 %``, or nothing where any error will do.

    Returns
    -------
    names : to be validated by the record of the scene.
    errors : the largest errors by name; slip as a fraction, 0.003 for 0.3 percentage points, others relative.
    wrong : what cannot be read.
    """
    if not isinstance(given, Mapping):
        return given, {}, []
    errors, wrong = {}, []
    for name, value in given.items():
        path = f"wants.{name}"
        if name not in WANTS:
            wrong.append(InvalidField(path, "", f"unknown{did_you_mean(str(name), WANTS)}; known: {', '.join(WANTS)}"))
        elif value is not None and name not in MEASURED:
            reason = f"`bearing-sim trade` measures no error of it, only of {', '.join(MEASURED)}; leave the error out: {{{name}: }}"
            wrong.append(InvalidField(path, repr(value), reason))
        elif value is not None:
            try:
                errors[name] = to_si(value, "")
                if not 0.0 < errors[name] <= 1.0:
                    raise ValueError("expected an error above 0 and up to 100 %, such as 0.3 %, which for slip are percentage points")
            except ValueError as error:
                wrong.append(InvalidField(path, repr(value), str(error)))
    return [name for name in given if name in WANTS], errors if not wrong else {}, wrong


def within(setting: Setting, errors: Mapping[str, float], own: Mapping[str, float]) -> bool:
    """Return whether a setting keeps wanted errors: none is larger over the course, and none three times as large anywhere in it.

    An error below that of the reference counts as the reference's own; one that was not measured keeps nothing.

    Parameters
    ----------
    setting : as measured.
    errors : by names of `MEASURED`, as `read_requirements` returns them.
    own : errors of the reference, by names of errors.
    """
    for name, most in errors.items():
        how = MEASURED[name]
        reference = own.get(how.error, math.nan)
        error = max(setting.errors[how.error], reference) if reference == reference else setting.errors[how.error]
        most *= _ROUNDED
        if not (how.scale * error <= most and how.scale * setting.errors[how.largest] <= _LARGEST * most):  # NaN fails here
            return False
    return True


def candidates(scene, errors: Mapping[str, float], front: Tradeoffs | None) -> list[Setting]:
    """Return the measured settings that keep wanted errors at the operating point of a scene, the fastest first.

    Parameters
    ----------
    scene : valid at some level.
    errors : by name, see `read_requirements`.
    front : what was measured, or None.
    """
    if front is None or not front.fits(scene) or not (here := front.at(scene)).courses:
        return []
    able, own = able_levels(scene), here.own_errors()
    return [setting for setting in here.settings() if setting.level in able and within(setting, errors, own)]


def able_levels(scene) -> list[str]:
    """Return the levels that have everything a scene asks for, whatever its steps."""
    return levels_with([effect for effect in asked_for(scene) if effect.field != "integration.fixed_step"])


def reason_of(setting: Setting, errors: Mapping[str, float], front: Tradeoffs, origin: str) -> str:
    """Return in one line why a setting was chosen: its measured errors beside those wanted, its speed, and on which courses.

    Parameters
    ----------
    setting, errors : see `within`.
    front : of the courses that count.
    origin : name of the scene for the command that builds a corrected table.
    """
    courses = ", ".join(dict.fromkeys(course.name for course in front.courses))
    found = ", ".join(_beside(name, most, setting) for name, most in errors.items())
    factor = setting.real_time_factor
    spare = f"{in_digits(100.0 * (1.0 - 1.0 / factor), 2)} % of a core to spare" if factor > 1.0 else "too slow to follow a live bearing"
    table = f"; a node needs its table: bearing-sim table {shlex.quote(origin)}, with the same --set, if any" if setting.is_corrected else ""
    where = "this bearing and machine" if front.is_kept else f"this bearing by {front.machine or 'another machine'}"
    return (
        f"level {setting.level} chosen with {setting.detail}, the fastest setting whose measured errors keep the wants: {found}; measured on {where} "
        f"({courses}; {front.name}) at {in_digits(factor, 3)} times real time, {spare}{table}"
    )


def _beside(name: str, most: float, setting: Setting) -> str:
    how = MEASURED[name]
    error, largest = (100.0 * how.scale * setting.errors[each] for each in (how.error, how.largest))
    return f"{name} {in_digits(error, 2)} of {100.0 * most:.3g} {how.unit} (largest {in_digits(largest, 2)})"


def without_measurement(scene, errors: Mapping[str, float], front: Tradeoffs | None, origin: str) -> Choice:
    """Return the most accurate level for a scene whose wanted errors no measured setting keeps, and why in one line.

    Parameters
    ----------
    scene, errors, front : see `candidates`.
    origin : name of the scene for the command that measures.
    """
    found = choose(scene)
    if found.level is None:
        return found
    able = levels_with(asked_for(scene))
    level = found.level if found.level in WHIRLING else "planar" if "planar" in able else [each for each in LEVELS if each in able][-1]
    asked = ", ".join(f"{name} {100.0 * most:.3g} {MEASURED[name].unit}" for name, most in errors.items())
    own_file = front is not None and not front.is_kept
    into = "" if not own_file else f" --front {shlex.quote(front.path.name)}" if front.fits(scene) else " --front FILE"
    command = f"bearing-sim trade {shlex.quote(origin)}{into}, with the same --set, if any"
    if front is None or not front.courses:
        why = f"no error was measured of this bearing with its oil, mounting and range of tables on this machine; measure with: {command}"
    elif not front.fits(scene):
        why = (
            f"{front.name} was measured on another bearing, lubricant, mounting or range of tables, and says nothing here; measure into another file "
            f"with: {command}"
        )
    elif not (here := front.at(scene)).courses:
        extents = "; ".join(f"{course.name}: {extent_in_words(course.extent)}" for course in front.courses)
        why = f"in {front.name} errors were measured elsewhere than where the scene operates ({extents}); measure there with: {command}"
    else:
        names = ", ".join(dict.fromkeys(course.name for course in here.courses))
        why = f"no setting measured on {names} ({front.name}) keeps them; measure others with: {command}"
    return Choice(level, f"level {level} chosen, the most accurate, and its errors are not known to be within {asked}: {why}")
