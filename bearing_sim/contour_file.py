# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured contours as text: azimuth and radius in two columns, one turn; every fault of a file at once.

The text of the file is what a scene keeps, so that a recording says what was measured, comments and all.
"""

import math
import re
from functools import lru_cache

import numpy as np

from bearing_sim.quantity import to_si

FEWEST_POINTS = 12
_WIDEST_GAP = 3.0  # times the median spacing
_OVERSHOOT = 0.1  # of the measured range: a curve through the points that leaves it further was not measured
_COLUMN = re.compile(r"^\s*(angle|azimuth|phi|radius|r)\s*(?:[\[(_]\s*([^\])]*?)\s*[\])]?)?\s*$", re.IGNORECASE)
_ANGLES, _TURN = {"angle", "azimuth", "phi"}, 2.0 * math.pi


class ContourFault(ValueError):
    """A contour that cannot be used; ``reasons`` lists everything that is wrong with it."""

    def __init__(self, reasons):
        self.reasons = tuple(reasons)
        super().__init__("; ".join(self.reasons))


@lru_cache(maxsize=16)
def read_contour(text: str, angle_unit: str | None = None, radius_unit: str | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return azimuths [rad], rising from the first, and radii [m] of one measured turn; not to be written to.

    A turn closed by repeating its first point loses the repetition.

    Parameters
    ----------
    text : a line for each point, columns parted by comma, semicolon, tab or blanks; ``#`` begins a comment.  The first line may
        name the columns and their units: ``angle [deg], radius [mm]`` or ``angle_deg,radius_mm``.
    angle_unit, radius_unit : units of columns whose header has none.

    Raises
    ------
    ContourFault
        With all reasons.
    """
    lines = [(number, line.split("#")[0].strip()) for number, line in enumerate(text.splitlines(), 1)]
    lines = [(number, line) for number, line in lines if line]
    if not lines:
        raise ContourFault(["no points: the contour is empty"])
    order, units, lines = _header(lines)
    scales = _scales(units, angle_unit, radius_unit)
    numbers, faults = [], []
    for number, line in lines:
        fields = _fields(line)
        try:
            if len(fields) != 2:
                raise ValueError
            values = [float(field) for field in fields]
        except ValueError:
            faults.append(f"line {number}: expected an angle and a radius, got {line[:40]!r}")
            continue
        if not all(map(math.isfinite, values)):
            faults.append(f"line {number}: {line[:40]!r} is not finite")
            continue
        numbers.append((number, values[order[0]] * scales[0], values[order[1]] * scales[1]))
    faults = faults[:5] + ([f"and {len(faults) - 5} more lines like these"] if len(faults) > 5 else [])
    faults += _order_faults(numbers)
    if faults:
        raise ContourFault(faults)
    angles, radii = np.array([n[1] for n in numbers]), np.array([n[2] for n in numbers])
    angles, radii = _one_turn(angles, radii)
    angles.flags.writeable = radii.flags.writeable = False
    return angles, radii


def _fields(line: str) -> list[str]:
    if ";" in line:
        return [field.strip().replace(",", ".") for field in line.split(";")]  # as spreadsheets write it where commas are decimal
    return [field.strip() for field in line.split(",")] if "," in line else line.split()


def _header(lines):
    """Return the order of the columns, their units and the lines after the header."""
    first = lines[0][1]
    names = [_COLUMN.match(field) for field in re.split(r"[;,\t]|\s+(?=[A-Za-z])", first)]
    names = [name for name in names if name]
    if len(names) != 2:
        if re.match(r"^[A-Za-z]", first) and not re.match(r"^(nan|inf)", first, re.IGNORECASE):
            raise ContourFault([f"line {lines[0][0]}: expected the header 'angle [deg], radius [mm]' or its like, got {first[:60]!r}"])
        return (0, 1), (None, None), lines
    is_angle = [name[1].lower() in _ANGLES for name in names]
    if sum(is_angle) != 1:
        raise ContourFault([f"line {lines[0][0]}: expected one angle and one radius in the header, got {first[:60]!r}"])
    order = (is_angle.index(True), is_angle.index(False))
    return order, tuple(names[column][2] or None for column in order), lines[1:]


def _scales(units, *declared) -> tuple[float, float]:
    scales, faults = [], []
    for name, written, given, si in zip(("angle", "radius"), units, declared, ("rad", "m")):
        unit = written or given
        if unit is None:
            faults.append(f"the {name} has no unit: write it into the header (angle [deg], radius [mm]) or declare contour_{name}_unit")
            continue
        if written and given and to_si(f"1 {written}", si) != to_si(f"1 {given}", si):
            faults.append(f"the header says {written} for the {name}, the scene {given}")
        try:
            scales.append(to_si(f"1 {unit}", si))
        except ValueError as fault:
            faults.append(f"{name} unit: {fault}")
    if faults:
        raise ContourFault(faults)
    return tuple(scales)


def _order_faults(numbers) -> list[str]:
    faults = []
    for (_, before, _), (number, angle, _) in zip(numbers, numbers[1:]):
        if angle == before:
            faults.append(f"line {number}: the angle {math.degrees(angle):.6g} deg is there twice")
        elif angle < before:
            faults.append(f"line {number}: the angle falls from {math.degrees(before):.6g} to {math.degrees(angle):.6g} deg; expected rising ones")
    bad = [number for number, _, radius in numbers if not 1e-3 <= radius <= 2.0]
    if bad:
        faults.append(
            f"line {bad[0]}: a radius outside 1 mm to 2 m" + (f", and {len(bad) - 1} more" if len(bad) > 1 else "") + "; is the unit right?"
        )
    return faults[:5]


def _one_turn(angles, radii) -> tuple[np.ndarray, np.ndarray]:
    covered = angles[-1] - angles[0] if len(angles) else 0.0
    if covered > _TURN * (1 + 1e-9):
        raise ContourFault([f"the angles cover {math.degrees(covered):.6g} deg; expected one turn"])
    if len(angles) > 1 and math.isclose(covered, _TURN, rel_tol=1e-9):
        miss, allowed = abs(radii[-1] - radii[0]), 0.02 * np.ptp(radii)
        if miss > allowed:
            raise ContourFault([f"the turn does not close: its ends differ by {1e6 * miss:.3g} um, {100 * miss / np.ptp(radii):.3g} % of the range"])
        angles, radii = angles[:-1], radii[:-1]
    if len(angles) < FEWEST_POINTS:
        raise ContourFault([f"{len(angles)} points; expected at least {FEWEST_POINTS}"])
    spacings = np.diff(np.append(angles, angles[0] + _TURN))
    widest, usual = int(spacings.argmax()), float(np.median(spacings))
    if spacings[widest] > _WIDEST_GAP * usual:
        reason = (
            f"a gap of {math.degrees(spacings[widest]):.4g} deg after {math.degrees(angles[widest]):.6g} deg where {math.degrees(usual):.4g} is usual"
        )
        raise ContourFault([reason + ("; the turn is not complete" if widest == len(angles) - 1 else "")])
    return angles, radii


@lru_cache(maxsize=16)
def measured_spline(text: str, angle_unit: str | None = None, radius_unit: str | None = None):
    """Return R_e(azimuth) as a periodic cubic spline through the points of `read_contour`, a callable of scipy.

    Raises
    ------
    ContourFault
        As `read_contour`; or the points are too coarse for what they show: the curve through them leaves their range by far.
    """
    from scipy.interpolate import CubicSpline  # a third of a second that a run without a measured contour need not pay

    angles, radii = read_contour(text, angle_unit, radius_unit)
    spline = CubicSpline(np.append(angles, angles[0] + _TURN), np.append(radii, radii[0]), bc_type="periodic")
    fine = spline(angles[0] + np.linspace(0.0, _TURN, 16 * len(angles), endpoint=False))
    beyond, span = max(fine.max() - radii.max(), radii.min() - fine.min()), np.ptp(radii)
    if beyond > _OVERSHOOT * span and beyond > 1e-8:
        raise ContourFault(
            [
                f"{len(radii)} points are too few for this contour: a smooth curve through them leaves the measured radii by {1e6 * beyond:.3g} um "
                f"of {1e6 * span:.3g} um; measure more points"
            ]
        )
    return spline
