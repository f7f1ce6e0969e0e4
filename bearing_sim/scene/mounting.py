# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How a bearing is mounted: the fits of its rings on shaft and in housing, and the tables of the standards for them.

Limits and fits: ISO 286-1 and ISO 286-2:2010, for diameters of 3 to 500 mm.  Bore and outside diameter of bearings: ISO 492:2014, class Normal.
Radial internal clearance: ISO 5753-1:2009, cylindrical roller bearings with cylindrical bore, and groups of makers and of GOST.  The
tables are in ``catalog/tables`` and ``catalog/designations/clearances.csv``.
"""

import math
import re
from dataclasses import field
from typing import Annotated, NamedTuple

from bearing_sim.scene.bundled import catalog_table
from bearing_sim.scene.material import Material
from bearing_sim.scene.outer_ring import Backing, RigidBacking
from bearing_sim.scene.quantity import Quantity, check, record

_CLASS = re.compile(r"^(js|[fghjkmnprs])([45678])$", re.IGNORECASE)

_FLATTENED = 0.4  # of the roughness of both surfaces, see `smoothed`

CLEARANCE_GROUPS = ("C2", "CN", "C3", "C4", "C5")
"""Groups of ISO 5753-1."""
CLEARANCE_PARTS = tuple(f"{group}{part}" for group in CLEARANCE_GROUPS for part in "LMHP" if group + part != "C5P")
"""Parts of groups (SKF): L and H the lower and the upper half, M the middle, P the upper half and the lower half of the next group."""
OTHER_CLEARANCES = {row["group"]: row["meaning"] for row in catalog_table("designations/clearance_groups")}
"""Groups beside those of ISO 5753-1, and what they are for (``catalog/designations/clearance_groups.csv``)."""
LARGEST_BORE = 1.0  # for which ISO 5753-1 has clearances [m]


class Limits(NamedTuple):
    """Least and largest value [m]."""

    least: float
    largest: float

    @property
    def mean(self) -> float:
        """The middle [m]."""
        return 0.5 * (self.least + self.largest)


def _cell(table: str, column: str, diameter: float, what: str) -> str:
    """Return what a table has in a column for the range of a diameter [m]; raise ValueError where it has nothing."""
    millimetres = 1e3 * diameter
    rows = [row for row in catalog_table(table) if row[column]]
    for row in rows:
        if float(row.get("above", 0)) < millimetres - 1e-9 <= float(row["to"]):
            return row[column]
    first = rows[0].get("above", "0")
    above = "" if first == "0" else f" above {first}"
    raise ValueError(f"{what} is tabulated for diameters{above} up to {rows[-1]['to']} mm, found {millimetres:.6g} mm; give a number instead")


def clearance_source(group: str) -> str:
    """Return who publishes a group of clearance."""
    if group in CLEARANCE_GROUPS:
        return "ISO 5753-1"
    return f"part of {group[:-1]} of ISO 5753-1, SKF" if group in CLEARANCE_PARTS else OTHER_CLEARANCES[group]


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
    name, part = (group[:-1], group[-1]) if group in CLEARANCE_PARTS else (group, "")
    low, high = _clearance(name, bore)
    middle, quarter = 0.5 * (low + high), 0.25 * (high - low)
    if part == "P":
        low, high = middle, 0.5 * sum(_clearance(CLEARANCE_GROUPS[CLEARANCE_GROUPS.index(name) + 1], bore))
    elif part:
        low, high = {"L": (low, middle), "H": (middle, high), "M": (low + quarter, high - quarter)}[part]
    return Limits(1e-6 * low, 1e-6 * high)


def _clearance(group: str, bore: float) -> tuple[float, ...]:
    """Return least and largest clearance of a group that is no part of one [um]."""
    return tuple(map(float, _cell("designations/clearances", group, bore, f"clearance {group} ({clearance_source(group)})").split("-")))


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
    known = {name: _iso_286(name, diameter) for name in (f"IT{grade}", f"IT{max(grade - 1, 4)}")}
    width = known[f"IT{grade}"]
    if letter == "js":
        return Limits(-0.5e-6 * width, 0.5e-6 * width)
    if letter == "j":
        if grade not in ((6, 7) if is_hole else (5, 6, 7)):
            raise ValueError(f"{tolerance_class!r}: ISO 286 has {'J6 and J7' if is_hole else 'j5, j6 and j7'} only; use js or JS")
        low = _iso_286(match[0], diameter) - width * is_hole
    elif letter in "fgh":
        deviation = _iso_286(letter, diameter)
        low = -deviation if is_hole else deviation - width
    else:
        deviation = 0 if letter == "k" and grade == 8 else _iso_286(letter, diameter)
        low = _hole_limit(letter, grade, 1e3 * diameter, deviation, width - known[f"IT{max(grade - 1, 4)}"]) - width if is_hole else deviation
    return Limits(1e-6 * low, 1e-6 * (low + width))


def _iso_286(column: str, diameter: float) -> int:
    """Return a tolerance or a limit of ISO 286 [um]."""
    return int(_cell("tables/iso_286", column, diameter, "ISO 286"))


def _hole_limit(letter: str, grade: int, millimetres: float, deviation: int, step: int) -> int:
    """Return the upper limit of a hole K to S [um]: that of the shaft of the same letter mirrored, and raised by IT_n - IT_(n-1) (ISO 286-1)."""
    if grade == 4:
        raise ValueError(f"{letter.upper()}4: holes are tabulated for grades 5 to 8")
    if letter == "m" and grade == 6 and 250.0 < millimetres - 1e-9 <= 315.0:
        return -9  # the standard departs from its own rule here
    return -deviation + (step if millimetres - 1e-9 > 3.0 and (letter in "kmn" or grade <= 7) else 0)


@record
class Sleeve:
    """A sleeve between shaft and inner ring, as warm as the shaft."""

    bore_radius: Annotated[float, Quantity("m", "radius of its seat on the shaft", 1e-3, 2.0, "mm")]
    interference: Annotated[float, Quantity("m", "effective diametral interference on the shaft", 0.0, 1e-3, "um")]
    material: Material = field(default_factory=Material)


@record
class Shaft:
    """The shaft below the inner ring.  Without a fit or an interference it leaves the ring as it is."""

    fit: str | None = None  # class of the seat by ISO 286, such as k5; the mean interference is taken
    interference: (
        Annotated[float, Quantity("m", "diametral interference, before its surfaces are smoothed; negative: a gap", -1e-3, 1e-3, "um")] | None
    ) = None
    bore_radius: Annotated[float, Quantity("m", "bore radius of the shaft; 0 is a solid one", 0.0, 2.0, "mm")] = 0.0
    material: Material = field(default_factory=Material)
    sleeve: Sleeve | None = None  # between shaft and ring
    roughness: Annotated[float, Quantity("m", "mean roughness depth of the seat, R_z", 0.0, 1e-4, "um")] = 4e-6
    ring_roughness: Annotated[float, Quantity("m", "mean roughness depth of the ring's bore, R_z", 0.0, 1e-4, "um")] = 2.5e-6

    @check
    def _fit_is_given_once(self) -> list[str]:
        return _seat_errors(self, "shaft", "k5", False)


@record
class Housing:
    """The housing around the outer ring.

    Without a fit or an interference it leaves the ring as it is, and the ring is rigid unless ``backing`` says what it bends in.
    """

    fit: str | None = None  # class of the seat by ISO 286, such as H7; the mean interference is taken
    interference: (
        Annotated[float, Quantity("m", "diametral interference, before its surfaces are smoothed; negative: a gap", -1e-3, 1e-3, "um")] | None
    ) = None
    outside_radius: Annotated[float, Quantity("m", "outside radius of the housing; None: 1.5 times that of the ring", 1e-3, 10.0, "mm")] | None = None
    material: Material = field(default_factory=Material)
    roughness: Annotated[float, Quantity("m", "mean roughness depth of the seat, R_z", 0.0, 1e-4, "um")] = 6.3e-6
    ring_roughness: Annotated[float, Quantity("m", "mean roughness depth of the ring's outside, R_z", 0.0, 1e-4, "um")] = 2.5e-6
    backing: Backing = field(default_factory=RigidBacking)  # what the outer ring bends in, at levels `steady` and `slip`

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
    seat, ring = tolerance_limits(shaft.fit, bore), _iso_492("bore", bore)
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
    seat, ring = tolerance_limits(housing.fit, outside), _iso_492("outside", outside)
    return Limits(ring - seat.largest, -seat.least)


def _iso_492(surface: str, diameter: float) -> float:
    """Return the lower limit of the deviation of a bearing's bore or outside diameter of class Normal [m]; the upper one is 0."""
    return -1e-6 * float(_cell("tables/iso_492", surface, diameter, "ISO 492"))


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
