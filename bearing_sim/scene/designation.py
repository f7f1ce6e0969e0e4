# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Designations of single row cylindrical roller bearings, such as ``NU 210 ECP/C3``, and the tables of the bearings that they name.

The tables are in ``catalog/designations``: ``boundary.csv`` (ISO 15), ``ratings.csv`` (what makers print) and ``rollers.csv`` (numbers of
rollers); each says where its figures come from.  `bearing_tree` turns a designation into the block that a preset file would hold.
"""

import csv
import difflib
import math
import re
import types
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib import resources

from bearing_sim.scene.mounting import CLEARANCE_GROUPS
from bearing_sim.scene.ratings import Ratings

TYPES = ("N", "NU", "NJ", "NUP", "NF", "NCF")
"""Types, by their flanges: N (inner ring), NU (outer ring), NJ and NUP (outer ring, and one or two on the inner), NF, NCF (inner ring, and one on the
outer; NCF without a cage)."""
SERIES = ("10", "2", "22", "3", "23", "4", "29", "30")
"""Dimension series in the order of their outside diameters and widths."""
_FULL_SERIES = ("22", "29", "30")  # of NCF; 29 and 30 are its own
CAGES = ("P", "J", "M", "MA", "MB", "ML", "M1")
"""Cages: P polyamide, J pressed steel, M brass of two pieces (M1 with integral rivets), guided by the rollers; MA, MB brass, guided by the outer or
the inner ring; ML brass of one piece, guided by a ring with flanges."""
_SYNONYMS = {  # suffixes of makers for these cages
    **{name: "P" for name in ("P", "PH", "TVP", "TVP2", "TVP3", "TN9", "T", "G15", "G")},
    **{name: "J" for name in ("J", "JP", "JP1", "JP3", "W")},
    **{name: "M" for name in ("M", "M6")},
    **{name: "MA" for name in ("MA", "MA6", "MAS", "M1A", "PHA")},
    **{name: "MB" for name in ("MB", "MBS", "M1B")},
    **{name: "ML" for name in ("ML", "MP", "MPA")},
    "M1": "M1",
}
_DESIGNS = ("EC", "ET", "EW", "EM", "E", "C", "R", "")  # high-capacity designs; what follows names the cage
_WITHOUT_EFFECT = re.compile(r"^(X|XL|N|NR|S[0-4N]|V|VH|CV|HA\d?|HB\d?|L[457]B|P[56]|V[ACELQ]\d{2,4})$")
_GROUP = re.compile(r"^C[2345N]$")
_FORM = re.compile(r"^\s*([A-Za-z]{1,4})[\s_-]*(\d{2}/\d{3}|\d{1,5})(?!\d)(.*)$", re.DOTALL)
_CODES = {15: "02", 17: "03"}  # of bores that are no multiple of 5 mm, or below 20 mm
_CLOSE = 3  # designations that a message proposes


class DesignationError(ValueError):
    """A designation of no bearing of the tables; the message says what is wrong and what is near."""


@dataclass(frozen=True)
class Boundary:
    """Boundary dimensions of a series and bore [m], and the catalogues that print them."""

    bore: float
    outside: float
    width: float
    corner: float | None  # least chamfer dimension r_s
    sources: str


@dataclass(frozen=True)
class Designation:
    """What a designation says.

    Attributes
    ----------
    text : as makers write it, such as ``NU 210 ECP/C3``.
    type : of `TYPES`.
    series : of `SERIES`.
    size : bore code, such as ``10``; ``/500`` for a bore of 500 mm.
    bore_diameter : d [m].
    high_capacity : whether a suffix such as E or EC asks for the high-capacity design.
    cage : of `CAGES`, or "" where the text names none; ``NCF`` has none.
    clearance : group by ISO 5753-1.
    unmodelled : suffixes that change nothing in this model, such as S1 or P6.
    """

    text: str
    type: str
    series: str
    size: str
    bore_diameter: float
    high_capacity: bool
    cage: str
    clearance: str
    unmodelled: tuple[str, ...]

    @property
    def boundary(self) -> Boundary:
        """Boundary dimensions by ISO 15."""
        return boundaries()[self.series, _millimetres(self.bore_diameter)]

    @property
    def is_full_complement(self) -> bool:
        """Whether the bearing has no cage."""
        return self.type == "NCF"


@dataclass(frozen=True)
class MakersRow:
    """What one maker prints for a section [SI]; None where it prints nothing.

    Attributes
    ----------
    maker, design : name of the maker, and its suffix of the standard bearing.
    ratings : load ratings, minimum load factor and speeds.
    inner_raceway, outer_raceway : diameters F and E.
    inner_flange, outer_flange : diameters d_1 and D_1 of the flanges.
    """

    maker: str
    design: str
    ratings: Ratings
    inner_raceway: float | None
    outer_raceway: float | None
    inner_flange: float | None
    outer_flange: float | None


@dataclass(frozen=True)
class RollerCount:
    """Number of rollers of sections with one pair of raceways, deduced from the static ratings of two widths.

    Attributes
    ----------
    series : of both widths.
    bore, inner_raceway, outer_raceway : d, F and E [m].
    high_capacity : whether it is the high-capacity design.
    count : Z.
    lengths : effective lengths of the rollers in both widths [m].
    unique : whether the ratings alone give Z; else they leave two, between which the distance of neighbours decides.
    published : where the number of rollers is also published; "" if nowhere.
    """

    series: tuple[str, str]
    bore: float
    inner_raceway: float
    outer_raceway: float
    high_capacity: bool
    count: int
    lengths: tuple[float, float]
    unique: bool
    published: str


@dataclass(frozen=True)
class CatalogueBearing:
    """A bearing of the tables: its designation without suffixes, dimensions, and ratings with the maker who prints them ("" if none does)."""

    designation: Designation
    boundary: Boundary
    ratings: Ratings
    maker: str


def _table(name: str) -> list[dict[str, str]]:
    text = resources.files("bearing_sim.scene").joinpath("catalog/designations", f"{name}.csv").read_text(encoding="utf-8")
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def _millimetres(diameter: float) -> int:
    return round(1e3 * diameter)


def _metres(cell: str) -> float | None:
    return float(cell) / 1e3 if cell else None


def _scaled(cell: str, scale: float) -> float | None:
    return float(cell) * scale if cell else None


@cache
def boundaries() -> Mapping[tuple[str, int], Boundary]:
    """Return boundary dimensions by series and bore [mm]."""
    found = {}
    for row in _table("boundary"):
        bore, outside, width, corner = (_metres(row[name]) for name in ("bore", "outside", "width", "corner"))
        found[row["series"], int(row["bore"])] = Boundary(bore, outside, width, corner, row["sources"])
    return types.MappingProxyType(found)


@cache
def makers_rows() -> Mapping[tuple[str, int, bool], tuple[MakersRow, ...]]:
    """Return what makers print by series, bore [mm] and whether the bearing has a full complement; the maker to prefer comes first."""
    found: dict[tuple[str, int, bool], list[MakersRow]] = {}
    rpm = math.pi / 30
    for row in _table("ratings"):
        ratings = Ratings(
            dynamic=_scaled(row["dynamic"], 1e3),
            static=_scaled(row["static"], 1e3),
            fatigue_limit=_scaled(row["fatigue_limit"], 1e3),
            minimum_load_factor=_scaled(row["minimum_load_factor"], 1e3),
            reference_speed=_scaled(row["reference_speed"], rpm),
            limiting_speed=_scaled(row["limiting_speed"], rpm),
        )
        diameters = [_metres(row[name]) for name in ("raceway_inner", "raceway_outer", "flange_inner", "flange_outer")]
        key = row["series"], int(row["bore"]), row["complement"] == "full"
        found.setdefault(key, []).append(MakersRow(row["maker"], row["design"], ratings, *diameters))
    return types.MappingProxyType({key: tuple(rows) for key, rows in found.items()})


@cache
def roller_counts() -> tuple[RollerCount, ...]:
    """Return the numbers of rollers that are known."""
    return tuple(
        RollerCount(
            (row["narrow"], row["wide"]),
            _metres(row["bore"]),
            _metres(row["raceway_inner"]),
            _metres(row["raceway_outer"]),
            row["design"] == "E",
            int(row["count"]),
            (_metres(row["narrow_length"]), _metres(row["wide_length"])),
            row["basis"] == "unique",
            row["published"],
        )
        for row in _table("rollers")
    )


def is_designation(text) -> bool:
    """Return whether a text has the form of a designation: one of `TYPES`, then a number."""
    found = _FORM.match(text) if isinstance(text, str) else None
    return found is not None and found[1].upper() in TYPES


def parse_designation(text: str) -> Designation:
    """Return what a designation says; case, blanks and hyphens between its parts do not matter.

    Parameters
    ----------
    text : such as ``NU 210 ECP/C3``, ``nu210`` or ``NCF 2928 CV``.

    Raises
    ------
    DesignationError
        It names no bearing of the tables, or has a suffix that is not known.
    """
    found = _FORM.match(text) if isinstance(text, str) else None
    if found is None or found[1].upper() not in TYPES:
        raise DesignationError(
            f"{text!r} is no designation of a cylindrical roller bearing; expected {', '.join(TYPES[:-1])} or {TYPES[-1]}, then series and bore "
            "code, such as NU 210 ECP/C3"
        )
    kind, series, bore = found[1].upper(), *_series_and_bore(found[1].upper(), found[2])
    read = _read_suffixes(kind, found[2], found[3])
    size = f"/{bore}" if bore >= 500 else _CODES.get(bore, f"{bore // 5:02d}")
    return Designation(
        _normalised(kind, series, size, read), kind, series, size, bore / 1e3, read.high_capacity, read.cage, read.clearance, tuple(read.unmodelled)
    )


def _normalised(kind: str, series: str, size: str, read: "_Suffixes") -> str:
    written = f"{kind} {series}{size}"
    if read.design:
        written += f" {read.design}"
    tail = [*read.unmodelled, *([read.clearance] if read.group_is_given else [])]
    return "/".join([written, *tail])


def _series_and_bore(kind: str, digits: str) -> tuple[str, int]:
    """Return series and bore [mm] of the digits of a designation; raise `DesignationError` if the tables do not have them."""
    if "/" in digits:
        series, bore = digits.split("/")[0], int(digits.split("/")[1])
    else:
        series, code = digits[:-2], digits[-2:]
        bore = {"00": 10, "01": 12, "02": 15, "03": 17}.get(code, 5 * int(code or 0))
    what = f"{kind} {digits}"
    offered = series_of_type(kind)
    if series not in SERIES:
        raise DesignationError(f"{what}: no dimension series {series!r}; {kind} has {', '.join(offered)}{_near(kind, digits)}")
    if series not in offered:
        reason = "of full-complement bearings (NCF)" if series in ("29", "30") else "not one of full-complement bearings"
        raise DesignationError(f"{what}: series {series} is {reason}; {kind} has {', '.join(offered)}{_near(kind, digits)}")
    bores = [each for of, each in boundaries() if of == series and _exists(kind, of, each)]
    if bore not in bores:
        nearest = min(bores, key=lambda each: abs(each - bore))
        raise DesignationError(
            f"{what}: series {series} of the tables has no bore of {bore} mm; it has bores of {bores[0]} to {bores[-1]} mm, the nearest is "
            f"{kind} {_digits(series, nearest)}"
        )
    return series, bore


def series_of_type(kind: str) -> tuple[str, ...]:
    """Return the dimension series of a type."""
    return _FULL_SERIES if kind == "NCF" else tuple(series for series in SERIES if series not in ("29", "30"))


def _exists(kind: str, series: str, bore: int) -> bool:
    return kind != "NCF" or series != "22" or (series, bore, True) in makers_rows()


def _digits(series: str, bore: int) -> str:
    return f"{series}/{bore}" if bore >= 500 else series + _CODES.get(bore, f"{bore // 5:02d}")


def _near(kind: str, digits: str) -> str:
    known = [f"{kind} {_digits(series, bore)}" for series, bore in boundaries() if series in series_of_type(kind) and _exists(kind, series, bore)]
    close = difflib.get_close_matches(f"{kind} {digits}", known, n=_CLOSE)
    return f"; near: {', '.join(close)}" if close else ""


@dataclass
class _Suffixes:
    """Suffixes as they are read."""

    design: str = ""
    high_capacity: bool = False
    cage: str = ""
    clearance: str = "CN"
    group_is_given: bool = False
    unmodelled: list[str] = field(default_factory=list)


def _read_suffixes(kind: str, digits: str, text: str) -> _Suffixes:
    read = _Suffixes()
    what = f"{kind} {digits}"
    for token in re.split(r"[\s/.,+_-]+", text.strip().upper()):
        if not token:
            continue
        if not _WITHOUT_EFFECT.match(token) and (glued := re.match(r"^(.+)(C[2345N])$", token)) and _design_and_cage(glued[1]) is not None:
            tokens = [glued[1], glued[2]]
        else:
            tokens = [token]
        for each in tokens:
            _read_suffix(read, kind, what, each)
    if kind == "NCF" and read.cage:
        raise DesignationError(f"{what}: a full-complement bearing has no cage, found cage {read.cage}; leave it out, or take another type")
    return read


def _read_suffix(read: _Suffixes, kind: str, what: str, token: str) -> None:
    if _GROUP.match(token) or token == "C0":
        if read.group_is_given:
            raise DesignationError(f"{what}: two clearance groups, {read.clearance} and {token}; give one")
        read.clearance, read.group_is_given = ("CN" if token == "C0" else token), True
    elif re.match(r"^C[\dN]+$", token):
        raise DesignationError(f"{what}: no clearance group {token}; expected {', '.join(CLEARANCE_GROUPS)} (ISO 5753-1)")
    elif _WITHOUT_EFFECT.match(token):
        if token in ("V", "VH", "CV") and kind != "NCF":
            raise DesignationError(f"{what}: suffix {token} is that of a full complement of rollers; this table has it as type NCF")
        if kind == "NCF" and token in ("V", "CV"):
            read.design = token
        else:
            read.unmodelled.append(token)
    elif (found := _design_and_cage(token)) is not None:
        design, cage = found
        if cage and read.cage:
            raise DesignationError(f"{what}: two cages, {read.cage} and {cage}; give one")
        read.design += token
        read.high_capacity, read.cage = read.high_capacity or design, cage or read.cage
    else:
        _refuse(what, token)


def _refuse(what: str, token: str) -> None:
    if token in ("K", "K30"):
        raise DesignationError(f"{what}: suffix {token} is a tapered bore, which this model does not have; leave it out")
    known = ["E", "EC", *_SYNONYMS, *(f"EC{cage}" for cage in CAGES), *CLEARANCE_GROUPS]
    close = difflib.get_close_matches(token, known, n=1)
    proposal = f" (did you mean {close[0]}?)" if close else ""
    raise DesignationError(
        f"{what}: unknown suffix {token!r}{proposal}; known: E and EC (high capacity), cages {', '.join(CAGES)}, "
        f"clearance {', '.join(CLEARANCE_GROUPS)}, and without effect here S0 to S4, P5, P6, XL, VA..."
    )


def _design_and_cage(token: str) -> tuple[bool, str] | None:
    """Return whether a suffix names the high-capacity design, and its cage; None if it is not such a suffix."""
    for design in _DESIGNS:
        rest = token.removeprefix(design) if token.startswith(design) else None
        if rest is None:
            continue
        if design in ("ET", "EW", "EM"):
            if rest == "":
                return True, _SYNONYMS[design[1]]
        elif rest == "" and design:
            return design != "C", ""
        elif rest in _SYNONYMS:
            return design in ("EC", "E", "R"), _SYNONYMS[rest]
    return None


def designations(*, kind: str | None = None, series: str | None = None, bore: float | None = None) -> Iterator[CatalogueBearing]:
    """Iterate over the bearings of the tables, by type, series and bore.

    Parameters
    ----------
    kind : one of `TYPES`; None: all.
    series : one of `SERIES`; None: all.
    bore : bore diameter [m]; None: all.
    """
    for each in TYPES if kind is None else (kind,):
        for of, size in sorted(boundaries(), key=lambda key: (SERIES.index(key[0]), key[1])):
            if series not in (None, of) or bore is not None and abs(1e-3 * size - bore) > 1e-6:
                continue
            if of not in series_of_type(each) or not _exists(each, of, size):
                continue
            rows = makers_rows().get((of, size, each == "NCF"), ())
            designation = parse_designation(f"{each} {_digits(of, size)}")
            yield CatalogueBearing(designation, designation.boundary, rows[0].ratings if rows else Ratings(), rows[0].maker if rows else "")
