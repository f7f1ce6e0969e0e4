# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The contour R_e(phi) of the outer raceway: lobes, lobes whose points differ, and measured ones from a file.

Each form gives radius and slope at any azimuth; `bearing_sim.physics.raceway.tabulated` turns them all into the one table that
kernels use.
"""

import math
import re
from collections.abc import Mapping
from functools import lru_cache
from pathlib import Path

import numpy as np

from bearing_sim.files.limits import CONTOUR_FILE, CONTOUR_POINTS, FileError, LimitError
from bearing_sim.files.reading import read_text
from bearing_sim.scene.errors import InvalidField
from bearing_sim.scene.quantity import to_si

FORM_FIELDS = ("low_radius", "d_value", "lobes", "roundness", "low_points", "high_points", "contour", "contour_file")
POINT_FORMS = (("contour", "contour_file"), ("low_points", "high_points"))
UNREAD = "contour_file: its contents are missing; load_scene reads them"


def outer_contour(raceway, azimuth) -> tuple[np.ndarray, np.ndarray]:
    """Return R_e [m] and dR_e/dphi [m/rad] at azimuths [rad].

    Parameters
    ----------
    raceway : `bearing_sim.scene.bearing.OuterRaceway`.
    azimuth : array or number.
    """
    phi = np.asarray(azimuth, float) - raceway.installation_angle
    if raceway.contour is not None:
        spline = measured_spline(raceway.contour, raceway.contour_angle_unit, raceway.contour_radius_unit)
        return spline(phi), spline(phi, 1)
    if raceway.low_points:
        return half_cosines(phi, *_alternating(raceway.low_points, raceway.high_points))
    if raceway.roundness:
        return half_cosines(phi, *_uneven_lobes(raceway.low_radius, raceway.d_value, raceway.lobes, raceway.roundness))
    half, phase = raceway.d_value / 2, raceway.lobes * phi
    return raceway.low_radius + half * (1.0 - np.cos(phase)), raceway.lobes * half * np.sin(phase)


def half_cosines(phi, azimuths, radii) -> tuple[np.ndarray, np.ndarray]:
    """Return radius and slope of a contour that joins neighbouring turning points by half a cosine wave.

    Deng 2017 builds the non-ideal contour from six of them.  The slope is continuous, and zero at the turning points.

    Parameters
    ----------
    phi : azimuths at which to evaluate [rad].
    azimuths : of the turning points [rad], increasing, within one turn, shape (n,).
    radii : at the turning points [m], shape (n,).
    """
    knots, values = np.append(azimuths, azimuths[0] + _TURN), np.append(radii, radii[0])
    wrapped = knots[0] + np.mod(phi - knots[0], _TURN)
    k = np.clip(np.searchsorted(knots, wrapped, side="right") - 1, 0, len(azimuths) - 1)
    width, rise = np.diff(knots)[k], np.diff(values)[k]
    phase = math.pi * (wrapped - knots[k]) / width
    return values[k] + rise / 2 * (1.0 - np.cos(phase)), math.pi / width * rise / 2 * np.sin(phase)


def _alternating(low_points, high_points) -> tuple[np.ndarray, np.ndarray]:
    points = sorted((point.azimuth % _TURN, point.radius) for point in (*low_points, *high_points))
    return np.array([azimuth for azimuth, _ in points]), np.array([radius for _, radius in points])


def _uneven_lobes(low_radius, d_value, lobes, roundness) -> tuple[np.ndarray, np.ndarray]:
    """Return turning points whose lows spread evenly over ``roundness`` about ``low_radius``; the high point after a raised low point is lowered."""
    spread = roundness * (np.arange(lobes) / (lobes - 1) - 0.5)
    return math.pi / lobes * np.arange(2 * lobes), np.stack([low_radius + spread, low_radius + d_value - spread], axis=1).ravel()


def measured_extent(raceway) -> tuple[float, float, int]:
    """Return the lowest radius [m], the highest minus the lowest radius [m], and the number of lobes of a measured contour.

    The number of lobes is the strongest of the harmonics 2 to 12; the first harmonic is an offset of the whole contour.
    """
    radii = outer_contour(raceway, np.linspace(0.0, _TURN, 14_400, endpoint=False))[0]
    harmonics = np.abs(np.fft.rfft(radii))[2:13]
    return float(radii.min()), float(np.ptp(radii)), 2 + int(harmonics.argmax())


def form_errors(raceway) -> list[str]:
    """Return error messages for a contour whose form is incomplete or contradictory."""
    forms = {
        "contour": raceway.contour is not None or raceway.contour_file is not None,
        "low_points and high_points": bool(raceway.low_points or raceway.high_points),
        "roundness": raceway.roundness > 0.0,
    }
    given = [name for name, present in forms.items() if present]
    if len(given) > 1:
        return [f"{' and '.join(given)} exclude each other; give one"]
    if forms["contour"]:
        return _measured_errors(raceway)
    errors = [
        f"{name}: applies only to a contour from a file; leave it out"
        for name in ("contour_angle_unit", "contour_radius_unit")
        if getattr(raceway, name) is not None
    ]
    if given == ["low_points and high_points"]:
        return errors + _point_errors(raceway)
    if raceway.roundness and (raceway.lobes or 3) < 2:
        errors.append("roundness: needs two or more low points; expected lobes of at least 2")
    if raceway.roundness and raceway.roundness >= (raceway.d_value or 0.0):
        errors.append("roundness: expected less than d_value, or a low point would be no lower than its neighbours")
    return errors


def _measured_errors(raceway) -> list[str]:
    if raceway.contour is None:
        return [UNREAD]
    try:
        outer_contour(raceway, 0.0)
    except ValueError as error:
        name = f"contour ({raceway.contour_file})" if raceway.contour_file else "contour"
        return [f"{name}: {reason}" for reason in getattr(error, "reasons", [str(error)])]
    return []


def _point_errors(raceway) -> list[str]:
    lows, highs = raceway.low_points, raceway.high_points
    if not 1 <= len(lows) == len(highs) <= 12:
        return [f"low_points: {len(lows)} for {len(highs)} high_points; expected the same number, 1 to 12"]
    points = sorted([(p.azimuth % _TURN, "low", p.radius) for p in lows] + [(p.azimuth % _TURN, "high", p.radius) for p in highs])
    errors = []
    for a, b in zip(points, points[1:] + [(points[0][0] + _TURN, *points[0][1:])]):
        where = f"{math.degrees(a[0]):.6g} and {math.degrees(b[0] % _TURN):.6g} deg"
        if b[0] - a[0] < math.radians(2.0):
            errors.append(f"low_points, high_points: points at {where} are less than 2 deg apart")
        elif a[1] == b[1]:
            errors.append(f"{a[1]}_points: no {'high' if a[1] == 'low' else 'low'} point between {where}")
        elif (a[2] < b[2]) != (a[1] == "low"):
            errors.append(f"low_points, high_points: at {where} the low point is not lower than the high point")
    return errors


def settled_form(raceway) -> tuple[dict, list[str]]:
    """Return low radius, D and lobes of a form without `form_errors`, and error messages for given values that contradict it.

    They follow from a contour given by points: you need not give them, and given values must agree with the points.
    """
    if raceway.contour is not None:
        low, d, lobes = measured_extent(raceway)
    elif raceway.low_points:
        low = min(point.radius for point in raceway.low_points)
        d, lobes = max(point.radius for point in raceway.high_points) - low, len(raceway.low_points)
    else:
        return {"d_value": raceway.d_value or 0.0, "lobes": raceway.lobes or 3}, []
    settled, errors = {"low_radius": low, "d_value": d, "lobes": lobes}, []
    for name, value in settled.items():
        given = getattr(raceway, name)
        if given is not None and not math.isclose(given, value, rel_tol=1e-9, abs_tol=1e-12):
            shown = f"{value}" if name == "lobes" else f"{1e3 * value:.6g} mm"
            errors.append(f"{name}: follows from the points of the contour ({shown}); leave it out")
    return settled, errors


FEWEST_POINTS = 12
_WIDEST_GAP = 3.0  # times the median spacing
_OVERSHOOT = 0.1  # of the measured range; how far the spline may leave that range
_LONGEST_LINE = 1000  # characters
_COLUMN = re.compile(r"^\s*(angle|azimuth|phi|radius|r)\s*(?:[\[(_]\s*([^\])]*?)\s*[\])]?)?\s*$", re.IGNORECASE)
_ANGLES, _TURN = {"angle", "azimuth", "phi"}, 2.0 * math.pi


class ContourError(ValueError):
    """A contour that cannot be used; ``reasons`` lists all errors."""

    def __init__(self, reasons):
        self.reasons = tuple(reasons)
        super().__init__("; ".join(self.reasons))


@lru_cache(maxsize=16)
def read_contour(text: str, angle_unit: str | None = None, radius_unit: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return azimuths [rad], increasing, and radii [m] of one measured turn, as read-only arrays.

    A repeated first point at the end of the turn is dropped.

    Parameters
    ----------
    text : one line per point, columns separated by comma, semicolon, tab or blanks; ``#`` begins a comment.  The first line may
        name the columns and their units: ``angle [deg], radius [mm]`` or ``angle_deg,radius_mm``.
    angle_unit, radius_unit : units of columns if the header gives none.

    Raises
    ------
    ContourError
        Listing all errors in the text.
    """
    lines = _lines_of(text)
    if not lines:
        raise ContourError(["no points: the contour is empty"])
    order, units, lines = _header(lines)
    scales = _scales(units, angle_unit, radius_unit)
    numbers, errors = [], []
    for number, line in lines:
        fields = _fields(line)
        try:
            if len(fields) != 2:
                raise ValueError
            values = [float(field) for field in fields]
        except ValueError:
            errors.append(f"line {number}: expected an angle and a radius, got {line[:40]!r}")
            continue
        if not all(map(math.isfinite, values)):
            errors.append(f"line {number}: {line[:40]!r} is not finite")
            continue
        numbers.append((number, values[order[0]] * scales[0], values[order[1]] * scales[1]))
    errors = errors[:5] + ([f"and {len(errors) - 5} more lines like these"] if len(errors) > 5 else [])
    errors += _order_errors(numbers)
    if errors:
        raise ContourError(errors)
    angles, radii = np.array([n[1] for n in numbers]), np.array([n[2] for n in numbers])
    angles, radii = _one_turn(angles, radii)
    angles.flags.writeable = radii.flags.writeable = False
    return angles, radii


def _lines_of(text: str) -> list[tuple[int, str]]:
    """Return number and text of the lines that are not empty, without comments."""
    lines = [(number, line.split("#")[0].strip()) for number, line in enumerate(text.splitlines(), 1)]
    lines = [(number, line) for number, line in lines if line]
    long = next((number for number, line in lines if len(line) > _LONGEST_LINE), None)
    if long is not None:
        raise ContourError([f"line {long}: longer than {_LONGEST_LINE} characters; expected an angle and a radius"])
    try:
        CONTOUR_POINTS.check(len(lines), "its points")
    except LimitError as error:
        raise ContourError([error.reason]) from None
    return lines


def _fields(line: str) -> list[str]:
    if ";" in line:
        return [field.strip().replace(",", ".") for field in line.split(";")]  # as written by spreadsheets with decimal commas
    return [field.strip() for field in line.split(",")] if "," in line else line.split()


def _header(lines):
    """Return the column order, the units and the lines after the header."""
    first = lines[0][1]
    names = [_COLUMN.match(" ".join(field.split())) for field in re.split(r"[;,\t]|\s+(?=[A-Za-z])", first)]
    names = [name for name in names if name]
    if len(names) != 2:
        if re.match(r"^[A-Za-z]", first) and not re.match(r"^(nan|inf)", first, re.IGNORECASE):
            raise ContourError([f"line {lines[0][0]}: expected a header such as 'angle [deg], radius [mm]', got {first[:60]!r}"])
        return (0, 1), (None, None), lines
    is_angle = [name[1].lower() in _ANGLES for name in names]
    if sum(is_angle) != 1:
        raise ContourError([f"line {lines[0][0]}: expected one angle and one radius in the header, got {first[:60]!r}"])
    order = (is_angle.index(True), is_angle.index(False))
    return order, tuple(names[column][2] or None for column in order), lines[1:]


def _scales(units, *declared) -> tuple[float, float]:
    scales, errors = [], []
    for name, written, given, si in zip(("angle", "radius"), units, declared, ("rad", "m")):
        unit = written or given
        if unit is None:
            errors.append(f"the {name} has no unit; give it in the header (angle [deg], radius [mm]) or as contour_{name}_unit")
            continue
        if written and given and to_si(f"1 {written}", si) != to_si(f"1 {given}", si):
            errors.append(f"the header says {written} for the {name}, the scene {given}")
        try:
            scales.append(to_si(f"1 {unit}", si))
        except ValueError as error:
            errors.append(f"{name} unit: {error}")
    if errors:
        raise ContourError(errors)
    return tuple(scales)


def _order_errors(numbers) -> list[str]:
    errors = []
    for (_, before, _), (number, angle, _) in zip(numbers, numbers[1:]):
        if angle == before:
            errors.append(f"line {number}: the angle {math.degrees(angle):.6g} deg is repeated")
        elif angle < before:
            errors.append(
                f"line {number}: the angle decreases from {math.degrees(before):.6g} to {math.degrees(angle):.6g} deg; expected increasing angles"
            )
    bad = [number for number, _, radius in numbers if not 1e-3 <= radius <= 2.0]
    if bad:
        errors.append(f"line {bad[0]}: radius outside 1 mm to 2 m" + (f", and {len(bad) - 1} more" if len(bad) > 1 else "") + "; check the unit")
    return errors[:5]


def _one_turn(angles, radii) -> tuple[np.ndarray, np.ndarray]:
    covered = angles[-1] - angles[0] if len(angles) else 0.0
    if covered > _TURN * (1 + 1e-9):
        raise ContourError([f"the angles cover {math.degrees(covered):.6g} deg; expected one turn"])
    if len(angles) > 1 and math.isclose(covered, _TURN, rel_tol=1e-9):
        miss, allowed = abs(radii[-1] - radii[0]), 0.02 * np.ptp(radii)
        if miss > allowed:
            raise ContourError([f"the turn does not close: its ends differ by {1e6 * miss:.3g} um, {100 * miss / np.ptp(radii):.3g} % of the range"])
        angles, radii = angles[:-1], radii[:-1]
    if len(angles) < FEWEST_POINTS:
        raise ContourError([f"{len(angles)} points; expected at least {FEWEST_POINTS}"])
    spacings = np.diff(np.append(angles, angles[0] + _TURN))
    widest, usual = int(spacings.argmax()), float(np.median(spacings))
    if spacings[widest] > _WIDEST_GAP * usual:
        gap, after = math.degrees(spacings[widest]), math.degrees(angles[widest])
        reason = f"a gap of {gap:.4g} deg after {after:.6g} deg; the usual spacing is {math.degrees(usual):.4g} deg"
        raise ContourError([reason + ("; the turn is not complete" if widest == len(angles) - 1 else "")])
    return angles, radii


@lru_cache(maxsize=16)
def measured_spline(text: str, angle_unit: str | None = None, radius_unit: str | None = None):
    """Return R_e(azimuth) as a periodic cubic spline through the points of `read_contour`, a SciPy callable.

    Raises
    ------
    ContourError
        As `read_contour`; or the points are too coarse: the spline through them leaves the measured range by far.
    """
    from scipy.interpolate import CubicSpline  # takes a third of a second to import, needed for measured contours only

    angles, radii = read_contour(text, angle_unit, radius_unit)
    spline = CubicSpline(np.append(angles, angles[0] + _TURN), np.append(radii, radii[0]), bc_type="periodic")
    fine = spline(angles[0] + np.linspace(0.0, _TURN, 16 * len(angles), endpoint=False))
    beyond, span = max(fine.max() - radii.max(), radii.min() - fine.min()), np.ptp(radii)
    if beyond > _OVERSHOOT * span and beyond > 1e-8:
        raise ContourError(
            [
                f"{len(radii)} points are too few for this contour: a smooth curve through them leaves the measured radii by {1e6 * beyond:.3g} um "
                f"of {1e6 * span:.3g} um; measure more points"
            ]
        )
    return spline


def with_contour_text(raceway: Mapping, path: str) -> tuple[Mapping, list[InvalidField]]:
    """Return a block ``outer_raceway`` with the text of its contour file, and the error if that cannot be read.

    Only the name of the file is kept, not its path, so that recordings do not reveal the paths of the machine.
    """
    file = raceway.get("contour_file")
    if not isinstance(file, str):
        return raceway, []
    text = raceway.get("contour")
    if text is None:
        try:
            text = read_text(file, CONTOUR_FILE)
        except FileError as error:
            return raceway, [InvalidField(f"{path}.contour_file", repr(file), error.reason)]
    return {**raceway, "contour": text, "contour_file": Path(file).name}, []
