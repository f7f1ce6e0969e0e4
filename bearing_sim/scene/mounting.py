# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How a bearing is mounted: the fits of its rings on shaft and in housing, and the tables of the standards for them.

Limits and fits: ISO 286-1 and ISO 286-2:2010, for diameters of 3 to 500 mm.  Bore and outside diameter of bearings: ISO 492:2014, class Normal.
Radial internal clearance: ISO 5753-1:2009, cylindrical roller bearings with cylindrical bore, and groups of makers and of GOST.  Lengths in the
tables are in micrometres, diameters in millimetres.
"""

import bisect
import csv
import math
import re
from collections.abc import Mapping
from dataclasses import field
from functools import cache
from importlib import resources
from types import MappingProxyType
from typing import NamedTuple

from bearing_sim.scene.material import Material
from bearing_sim.scene.quantity import check, quantity, record

# Upper ends of the ranges of diameter [mm], the lower end excluded (ISO 286-1, tables 1 to 3).
_RANGES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
_GRADES = {  # standard tolerances IT [um]
    4: (3, 4, 4, 5, 6, 7, 8, 10, 12, 14, 16, 18, 20),
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97),
}
_DEVIATIONS = {  # fundamental deviation of shafts [um]: the upper limit of f, g, h; the lower one of the others
    "f": (-6, -10, -13, -16, -20, -25, -30, -36, -43, -50, -56, -62, -68),
    "g": (-2, -4, -5, -6, -7, -9, -10, -12, -14, -15, -17, -18, -20),
    "h": (0,) * 13,
    "k": (0, 1, 1, 1, 2, 2, 2, 3, 3, 4, 4, 4, 5),
    "m": (2, 4, 6, 7, 8, 9, 11, 13, 15, 17, 20, 21, 23),
    "n": (4, 8, 10, 12, 15, 17, 20, 23, 27, 31, 34, 37, 40),
    "p": (6, 12, 15, 18, 22, 26, 32, 37, 43, 50, 56, 62, 68),
}
_J_SHAFT = {  # lower limit of j5, j6 and j7 [um]
    5: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    6: (-2, -2, -2, -3, -4, -5, -7, -9, -11, -13, -16, -18, -20),
    7: (-4, -4, -5, -6, -8, -10, -12, -15, -18, -21, -26, -28, -32),
}
_J_HOLE = {  # upper limit of J6 and J7 [um]
    6: (2, 5, 5, 6, 8, 10, 13, 16, 18, 22, 25, 29, 33),
    7: (4, 6, 8, 10, 12, 14, 18, 22, 26, 30, 36, 39, 43),
}
# r and s change within the ranges above.
_FINE_RANGES = (3, 6, 10, 18, 30, 50, 65, 80, 100, 120, 140, 160, 180, 200, 225, 250, 280, 315, 355, 400, 450, 500)
_FINE_DEVIATIONS = {
    "r": (10, 15, 19, 23, 28, 34, 41, 43, 51, 54, 63, 65, 68, 77, 80, 84, 94, 98, 108, 114, 126, 132),
    "s": (14, 19, 23, 28, 35, 43, 53, 59, 71, 79, 92, 100, 108, 122, 130, 140, 158, 170, 190, 208, 232, 252),
}
_CLASS = re.compile(r"^(js|[fghjkmnprs])([45678])$", re.IGNORECASE)

# Bore and outside diameter of a bearing of class Normal lie below the nominal one by up to (ISO 492:2014, tables 2 and 3) [um].
_BORE_RANGES = (10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)
_BORE_TOLERANCES = (8, 8, 10, 12, 15, 20, 25, 30, 35, 40, 45)
_OUTSIDE_RANGES = (18, 30, 50, 80, 120, 150, 180, 250, 315, 400, 500, 630)
_OUTSIDE_TOLERANCES = (8, 9, 11, 13, 15, 18, 25, 30, 35, 40, 45, 50)

_FLATTENED = 0.4  # of the roughness of both surfaces, see `smoothed`

CLEARANCE_GROUPS = ("C2", "CN", "C3", "C4", "C5")
"""Groups of ISO 5753-1."""
CLEARANCE_PARTS = tuple(f"{group}{part}" for group in CLEARANCE_GROUPS for part in "LMHP" if group + part != "C5P")
"""Parts of groups (SKF): L and H the lower and the upper half, M the middle, P the upper half and the lower half of the next group."""
OTHER_CLEARANCES = {
    **{"CT": "electric motors, interchangeable rings; NSK", "CM": "electric motors, matched rings; NSK, NTN"},
    **{name: "matched rings; NSK, GOST 24810" for name in ("CC1", "CC2", "CC", "CC3", "CC4", "CC5")},
    **{name: "interchangeable rings; GOST 24810" for name in ("GOST1", "GOST6", "GOST2", "GOST3", "GOST4")},
}
"""Groups beside those of ISO 5753-1, and what they are for (``catalog/designations/clearances.csv``)."""
_CLEARANCE_RANGES = (
    24,
    30,
    40,
    50,
    65,
    80,
    100,
    120,
    140,
    160,
    180,
    200,
    225,
    250,
    280,
    315,
    355,
    400,
    450,
    500,
    560,
    630,
    710,
    800,
    900,
    1000,
)  # bore [mm]
_CLEARANCES = (  # least and largest clearance of the groups [um] (ISO 5753-1:2009, table for cylindrical roller bearings)
    ((0, 25), (20, 45), (35, 60), (50, 75), (65, 90)),
    ((0, 25), (20, 45), (35, 60), (50, 75), (70, 95)),
    ((5, 30), (25, 50), (45, 70), (60, 85), (80, 105)),
    ((5, 35), (30, 60), (50, 80), (70, 100), (95, 125)),
    ((10, 40), (40, 70), (60, 90), (80, 110), (110, 140)),
    ((10, 45), (40, 75), (65, 100), (90, 125), (130, 165)),
    ((15, 50), (50, 85), (75, 110), (105, 140), (155, 190)),
    ((15, 55), (50, 90), (85, 125), (125, 165), (180, 220)),
    ((15, 60), (60, 105), (100, 145), (145, 190), (200, 245)),
    ((20, 70), (70, 120), (115, 165), (165, 215), (225, 275)),
    ((25, 75), (75, 125), (120, 170), (170, 220), (250, 300)),
    ((35, 90), (90, 145), (140, 195), (195, 250), (275, 330)),
    ((45, 105), (105, 165), (160, 220), (220, 280), (305, 365)),
    ((45, 110), (110, 175), (170, 235), (235, 300), (330, 395)),
    ((55, 125), (125, 195), (190, 260), (260, 330), (370, 440)),
    ((55, 130), (130, 205), (200, 275), (275, 350), (410, 485)),
    ((65, 145), (145, 225), (225, 305), (305, 385), (455, 535)),
    ((100, 190), (190, 280), (280, 370), (370, 460), (510, 600)),
    ((110, 210), (210, 310), (310, 410), (410, 510), (565, 665)),
    ((110, 220), (220, 330), (330, 440), (440, 550), (625, 735)),
    ((120, 240), (240, 360), (360, 480), (480, 600), (690, 810)),
    ((140, 260), (260, 380), (380, 500), (500, 620), (780, 900)),
    ((145, 285), (285, 425), (425, 565), (565, 705), (865, 1005)),
    ((150, 310), (310, 470), (470, 630), (630, 790), (975, 1135)),
    ((180, 350), (350, 520), (520, 690), (690, 860), (1095, 1265)),
    ((200, 390), (390, 580), (580, 770), (770, 960), (1215, 1405)),
)


LARGEST_BORE = 1e-3 * _CLEARANCE_RANGES[-1]  # for which ISO 5753-1 has clearances [m]


class Limits(NamedTuple):
    """Least and largest value [m]."""

    least: float
    largest: float

    @property
    def mean(self) -> float:
        """The middle [m]."""
        return 0.5 * (self.least + self.largest)


def _row(ranges: tuple[int, ...], diameter: float, what: str) -> int:
    millimetres = 1e3 * diameter
    row = bisect.bisect_left(ranges, millimetres - 1e-9)
    if row == len(ranges):
        raise ValueError(f"{what} is tabulated for diameters up to {ranges[-1]} mm, found {millimetres:.6g} mm; give a number instead")
    return row


def clearance_source(group: str) -> str:
    """Return who publishes a group of clearance."""
    if group in CLEARANCE_GROUPS:
        return "ISO 5753-1"
    return f"part of {group[:-1]} of ISO 5753-1, SKF" if group in CLEARANCE_PARTS else OTHER_CLEARANCES[group]


@cache
def _other_clearances() -> Mapping[str, tuple[tuple[int, int, Limits], ...]]:
    """Return bores, above and up to [mm], and limits [m] of the groups of `OTHER_CLEARANCES`."""
    text = resources.files("bearing_sim.scene").joinpath("catalog/designations/clearances.csv").read_text(encoding="utf-8")
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    found = {
        group: tuple((int(row["above"]), int(row["to"]), Limits(*(1e-6 * float(end) for end in row[group].split("-")))) for row in rows if row[group])
        for group in OTHER_CLEARANCES
    }
    return MappingProxyType(found)


def clearance_limits(group: str, bore: float) -> Limits:
    """Return the limits of the radial internal clearance of a group, diametral [m].

    Parameters
    ----------
    group : of `CLEARANCE_GROUPS`, `CLEARANCE_PARTS` or `OTHER_CLEARANCES`.
    bore : bore diameter [m].

    Raises
    ------
    ValueError
        The table does not have that bore.
    """
    if group in OTHER_CLEARANCES:
        rows = _other_clearances()[group]
        for above, to, limits in rows:
            if above < 1e3 * bore - 1e-9 <= to:
                return limits
        raise ValueError(f"clearance {group} ({OTHER_CLEARANCES[group]}) is published for bores above {rows[0][0]} to {rows[-1][1]} mm")
    name, part = (group[:-1], group[-1]) if group in CLEARANCE_PARTS else (group, "")
    row = _CLEARANCES[_row(_CLEARANCE_RANGES, bore, "ISO 5753-1")]
    index = CLEARANCE_GROUPS.index(name)
    low, high = row[index]
    middle, quarter = 0.5 * (low + high), 0.25 * (high - low)
    if part == "P":
        return Limits(1e-6 * middle, 0.5e-6 * sum(row[index + 1]))
    low, high = {"": (low, high), "L": (low, middle), "H": (middle, high), "M": (low + quarter, high - quarter)}[part]
    return Limits(1e-6 * low, 1e-6 * high)


def tolerance_limits(tolerance_class: str, diameter: float) -> Limits:
    """Return the limits of deviation from a nominal diameter by ISO 286 [m].

    Parameters
    ----------
    tolerance_class : such as ``k5`` for a shaft or ``H7`` for a hole: f to s (f, g, h, j, js, k, m, n, p, r, s), grades 4 to 8.
    diameter : nominal [m], 3 to 500 mm.

    Raises
    ------
    ValueError
        The class is not one of these, or the table does not have the diameter.
    """
    match = _CLASS.match(tolerance_class.strip())
    if match is None or not (match[1].islower() or match[1].isupper()):
        raise ValueError(
            f"{tolerance_class!r} is no class that is tabulated; expected f, g, h, j, js, k, m, n, p, r or s (a hole in capitals), 4 to 8"
        )
    letter, grade, is_hole = match[1].lower(), int(match[2]), match[1].isupper()
    row = _row(_RANGES, diameter, "ISO 286")
    width = _GRADES[grade][row]
    if letter == "js":
        return Limits(-0.5e-6 * width, 0.5e-6 * width)
    if letter == "j":
        table = _J_HOLE if is_hole else _J_SHAFT
        if grade not in table:
            raise ValueError(f"{tolerance_class!r}: ISO 286 has {'J6 and J7' if is_hole else 'j5, j6 and j7'} only; use js or JS")
        low = table[grade][row] - width if is_hole else table[grade][row]
        return Limits(1e-6 * low, 1e-6 * (low + width))
    if letter in _FINE_DEVIATIONS:
        deviation = _FINE_DEVIATIONS[letter][_row(_FINE_RANGES, diameter, "ISO 286")]
    else:
        deviation = 0 if letter == "k" and grade == 8 else _DEVIATIONS[letter][row]
    if letter in "fgh":
        low = -deviation if is_hole else deviation - width
        return Limits(1e-6 * low, 1e-6 * (low + width))
    if not is_hole:
        return Limits(1e-6 * deviation, 1e-6 * (deviation + width))
    high = _hole_limit(letter, grade, row, deviation)
    return Limits(1e-6 * (high - width), 1e-6 * high)


def _hole_limit(letter: str, grade: int, row: int, deviation: int) -> int:
    """Return the upper limit of a hole K to S [um]: that of the shaft of the same letter mirrored, and raised by IT_n - IT_(n-1) (ISO 286-1)."""
    if grade == 4:
        raise ValueError(f"{letter.upper()}4: holes are tabulated for grades 5 to 8")
    raised = _GRADES[grade][row] - _GRADES[grade - 1][row] if _RANGES[row] > 3 and (letter in "kmn" or grade <= 7) else 0
    if letter == "m" and grade == 6 and _RANGES[row] == 315:
        return -9  # the standard departs from its own rule here
    return -deviation + raised


@record
class Sleeve:
    """A sleeve between shaft and inner ring, as warm as the shaft."""

    bore_radius: quantity("m", "radius of its seat on the shaft", 1e-3, 2.0, "mm")
    interference: quantity("m", "effective diametral interference on the shaft", 0.0, 1e-3, "um")
    material: Material = field(default_factory=Material)


@record
class Shaft:
    """The shaft below the inner ring.  Without a fit or an interference it leaves the ring as it is."""

    fit: str | None = None  # class of the seat by ISO 286, such as k5; the mean interference is taken
    interference: quantity("m", "diametral interference, before its surfaces are smoothed; negative: a gap", -1e-3, 1e-3, "um") | None = None
    bore_radius: quantity("m", "bore radius of the shaft; 0 is a solid one", 0.0, 2.0, "mm") = 0.0
    material: Material = field(default_factory=Material)
    sleeve: Sleeve | None = None  # between shaft and ring
    roughness: quantity("m", "mean roughness depth of the seat, R_z", 0.0, 1e-4, "um") = 4e-6
    ring_roughness: quantity("m", "mean roughness depth of the ring's bore, R_z", 0.0, 1e-4, "um") = 2.5e-6

    @check
    def _fit_is_given_once(self) -> list[str]:
        return _seat_errors(self, "shaft", "k5", False)


@record
class Housing:
    """The housing around the outer ring.  Without a fit or an interference it leaves the ring as it is."""

    fit: str | None = None  # class of the seat by ISO 286, such as H7; the mean interference is taken
    interference: quantity("m", "diametral interference, before its surfaces are smoothed; negative: a gap", -1e-3, 1e-3, "um") | None = None
    outside_radius: quantity("m", "outside radius of the housing; None: 1.5 times that of the ring", 1e-3, 10.0, "mm") | None = None
    material: Material = field(default_factory=Material)
    roughness: quantity("m", "mean roughness depth of the seat, R_z", 0.0, 1e-4, "um") = 6.3e-6
    ring_roughness: quantity("m", "mean roughness depth of the ring's outside, R_z", 0.0, 1e-4, "um") = 2.5e-6

    @check
    def _fit_is_given_once(self) -> list[str]:
        return _seat_errors(self, "housing", "H7", True)


def _seat_errors(seat, name: str, example: str, is_hole: bool) -> list[str]:
    if seat.fit is not None and seat.interference is not None:
        return ["fit and interference exclude each other; give one"]
    if seat.fit is None:
        return []
    match = _CLASS.match(seat.fit.strip())
    if match is None or not (match[1].isupper() if is_hole else match[1].islower()):
        letters = "F, G, H, J, JS, K, M, N, P, R or S" if is_hole else "f, g, h, j, js, k, m, n, p, r or s"
        return [f"fit: {seat.fit!r}; expected a class of ISO 286 for a {name}, {letters} with a grade of 4 to 8, such as {example}"]
    return []


@record
class Mounting:
    """Shaft and housing, for a bearing whose dimensions are `cold`."""

    shaft: Shaft = field(default_factory=Shaft)
    housing: Housing = field(default_factory=Housing)

    @property
    def has_fits(self) -> bool:
        """Whether shaft or housing changes the clearance."""
        return any(value is not None for seat in (self.shaft, self.housing) for value in (seat.fit, seat.interference))


def shaft_interference(shaft: Shaft, bore: float) -> Limits | None:
    """Return the limits of the diametral interference of shaft and inner ring before smoothing [m]; None where there is no fit.

    Parameters
    ----------
    shaft : of the scene.
    bore : bore diameter of the ring [m].

    Raises
    ------
    ValueError
        A table does not have that diameter.
    """
    if shaft.fit is None:
        return None if shaft.interference is None else Limits(shaft.interference, shaft.interference)
    seat, ring = tolerance_limits(shaft.fit, bore), -1e-6 * _BORE_TOLERANCES[_row(_BORE_RANGES, bore, "ISO 492")]
    return Limits(seat.least, seat.largest - ring)


def housing_interference(housing: Housing, outside: float) -> Limits | None:
    """Return the limits of the diametral interference of housing and outer ring before smoothing [m]; None where there is no fit.

    Parameters
    ----------
    housing : of the scene.
    outside : outside diameter of the ring [m].

    Raises
    ------
    ValueError
        A table does not have that diameter.
    """
    if housing.fit is None:
        return None if housing.interference is None else Limits(housing.interference, housing.interference)
    seat, ring = tolerance_limits(housing.fit, outside), -1e-6 * _OUTSIDE_TOLERANCES[_row(_OUTSIDE_RANGES, outside, "ISO 492")]
    return Limits(ring - seat.largest, -seat.least)


def smoothed(interference: float, seat) -> float:
    """Return the interference that is left when the peaks of both surfaces are flattened: 0.4 (R_zA + R_zI) are lost.

    The factor is that of DIN 7190-1:2017 as the manual of a bearing program states it (MESYS, surface roughness of shaft and housing); earlier
    editions had 0.8.  A gap stays what it is.

    Parameters
    ----------
    interference : diametral [m].
    seat : `Shaft` or `Housing`.
    """
    if interference <= 0.0:
        return interference
    return max(0.0, interference - _FLATTENED * (seat.roughness + seat.ring_roughness))


def mounting_errors(bearing, mounting: Mounting) -> list[str]:
    """Return error messages for fits that a bearing does not need, cannot have, or lacks dimensions for."""
    inner, outer, shaft, housing = bearing.inner_raceway, bearing.outer_raceway, mounting.shaft, mounting.housing
    if bearing.dimensions_at == "running":
        if not mounting.has_fits:
            return []
        return [
            "mounting: the dimensions are those of the running bearing, which fits no longer change; set bearing.dimensions_at: cold, or leave it out"
        ]
    if inner.bore_radius is None:
        return [
            "bearing.inner_raceway.bore_radius: missing; an inner ring whose dimensions are cold grows by rotation (else set "
            "bearing.dimensions_at: running)"
        ]
    errors = []
    if not shaft.bore_radius < inner.bore_radius < inner.radius:
        errors.append(
            f"bearing.inner_raceway.bore_radius: {1e3 * inner.bore_radius:.6g} mm; expected between the shaft's bore "
            f"({1e3 * shaft.bore_radius:.6g} mm) and the raceway ({1e3 * inner.radius:.6g} mm)"
        )
    if shaft.sleeve is not None and not shaft.bore_radius < shaft.sleeve.bore_radius < inner.bore_radius:
        errors.append(
            f"mounting.shaft.sleeve.bore_radius: {1e3 * shaft.sleeve.bore_radius:.6g} mm; expected between the shaft's bore and the ring's "
            f"({1e3 * inner.bore_radius:.6g} mm)"
        )
    errors += _refused("mounting.shaft.fit", lambda: shaft_interference(shaft, 2 * inner.bore_radius))
    if housing.fit is None and housing.interference is None:
        return errors
    if outer.outside_radius is None:
        return [*errors, "bearing.outer_raceway.outside_radius: missing; the fit of the housing needs it"]
    high, around = outer.low_radius + outer.d_value, housing.outside_radius
    if not high < outer.outside_radius < (math.inf if around is None else around):
        errors.append(
            f"bearing.outer_raceway.outside_radius: {1e3 * outer.outside_radius:.6g} mm; expected between the raceway ({1e3 * high:.6g} mm) and the "
            f"housing's outside{'' if around is None else f' ({1e3 * around:.6g} mm)'}"
        )
    return errors + _refused("mounting.housing.fit", lambda: housing_interference(housing, 2 * outer.outside_radius))


def _refused(field_name: str, interference) -> list[str]:
    try:
        interference()
    except ValueError as error:
        return [f"{field_name}: {error}"]
    return []
