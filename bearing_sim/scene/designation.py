# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Designations of single row cylindrical roller bearings, such as ``NU 210 ECP/C3``, and the tables of the bearings that they name.

The tables are in ``catalog/designations``: ``boundary.csv`` (ISO 15), ``ratings.csv`` (what makers print), ``rollers.csv`` (numbers of
rollers), ``types.csv``, ``suffixes.csv`` and ``gost.csv`` (what letters and digits mean), ``iso_numbers.csv`` (other bearings); each says where it
comes from.  Designations are those of makers and of GOST 3189 (types of GOST 8328).  `bearing_tree` turns a designation into the block that a preset
file would hold.
"""

import difflib
import math
import re
import types
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache

from bearing_sim.scene.bundled import catalog_table
from bearing_sim.scene.mounting import CLEARANCE_GROUPS, CLEARANCE_PARTS, OTHER_CLEARANCES, clearance_limits
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
_DESIGNS = {"EC": True, "EX": True, "EA": True, "E": True, "R": True, "C": False}  # of the inside, and whether it is the high-capacity one
_MAKERS = re.compile(
    r"\b(SKF|FAG|INA|SCHAEFFLER|NSK|NTN|SNR|NTN-SNR|TIMKEN|NKE|ZWZ|LYC|HRB|KOYO|JTEKT|NACHI|RHP|ZKL|ZVL|KINEX|URB|CRAFT|ISB|MRC|TORRINGTON|FAFNIR|"
    r"ROLLWAY|FBJ|DAS|RKB|CX|KBC|NBC|FERSA|EPK|GPZ|VBF|SPZ|MPZ|HARP|ЕПК|ГПЗ|ВБФ|СПЗ|МПЗ|ХАРП|BEARINGS?|LAGER|ПОДШИПНИК|CYLINDRICAL|ROLLER|X-LIFE)\b"
)
_LOOK_ALIKE = str.maketrans("АВЕКМНОРСТХУ", "ABEKMHOPCTXY")  # Cyrillic letters with the shape of Latin ones
_CYRILLIC = str.maketrans("ABEKMHOPCTXYLUDGJ", "АБЕКМНОРСТХУЛУДГЮ")  # Latin letters that stand for those of a suffix of GOST
_LETTERS = re.compile(r"^([A-Z]{1,4})[\s_.-]*(\d{2}/\d{3}|\d{1,7})(?!\d)(.*)$", re.DOTALL)
_INA = re.compile(r"^([RLZ]?SL)[\s-]*(\d\d)[\s-]*(\d{2}/\d{3}|\d{4})(?!\d)(.*)$", re.DOTALL)
_DIGITS = re.compile(r"^(?:(ГОСТ|GOST|GOCT)[\s-]*)?(?:(\d?[ABАВ]?[\dMМHН]{0,2}[0-8TТ])\s?-\s?)?(\d{3,7})(/\d+)?(?![\d_])[\s-]*([0-9A-ZА-Я/., -]*)$")
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
    notes : what the letters and digits were read as, one sentence each.
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
    notes: tuple[str, ...] = field(default=(), compare=False)

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
    for row in catalog_table("designations/boundary"):
        bore, outside, width, corner = (_metres(row[name]) for name in ("bore", "outside", "width", "corner"))
        found[row["series"], int(row["bore"])] = Boundary(bore, outside, width, corner, row["sources"])
    return types.MappingProxyType(found)


@cache
def makers_rows() -> Mapping[tuple[str, int, bool], tuple[MakersRow, ...]]:
    """Return what makers print by series, bore [mm] and whether the bearing has a full complement; the maker to prefer comes first."""
    found: dict[tuple[str, int, bool], list[MakersRow]] = {}
    rpm = math.pi / 30
    for row in catalog_table("designations/ratings"):
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
        for row in catalog_table("designations/rollers")
    )


@cache
def _suffixes() -> tuple[tuple[re.Pattern, str, str, str], ...]:
    """Return pattern, kind, value and meaning of the suffixes of ``suffixes.csv``."""
    return tuple((re.compile(rf"(?:{row['pattern']})$"), row["kind"], row["value"], row["meaning"]) for row in catalog_table("designations/suffixes"))


@cache
def _gost(*kinds: str) -> Mapping[str, tuple[str, str]]:
    """Return value and meaning of the signs of GOST 3189 of these kinds in ``gost.csv``."""
    rows = (row for row in catalog_table("designations/gost") if row["kind"] in kinds)
    return types.MappingProxyType({row["sign"]: (row["value"], row["meaning"]) for row in rows})


@cache
def _other_types() -> Mapping[str, tuple[str, str]]:
    """Return what bearings are whose type is not of `TYPES`, and the nearest of `TYPES`, by the letters of the type."""
    return types.MappingProxyType({row["type"]: (row["what"], row["nearest"]) for row in catalog_table("designations/types")})


def _plain(text: object) -> str:
    """Return a text in capitals without makers' names, with plain blanks, letters and hyphens; "" for what is no text."""
    if isinstance(text, bool) or not isinstance(text, (str, int)):
        return ""
    written = re.sub("[‐-―−]", "-", unicodedata.normalize("NFKC", str(text)).upper())
    written = re.sub(r"\b([CС])[ -](?=[2345N]\b)", r"\1", written)  # C 3, with a blank
    return re.sub(r"\s+", " ", _MAKERS.sub(" ", written)).strip(" -,;:()\"'")


def _latin(plain: str) -> tuple[str, str, str] | None:
    """Return type, digits and suffixes of a designation that begins with letters; None if it is none."""
    text = re.sub("^НУП", "NUP", re.sub("^НУ(?! ?П)", "NU", plain)).translate(_LOOK_ALIKE)
    text = re.sub(r"^HC[ -]?(N[A-Z]*[ -]*\d+)", r"\1 HC", text)  # a prefix of FAG, as the suffix of SKF
    text = re.sub(r"^([LRN]) (?=N|(UP|U|J|F)[ \d])", r"\1", text)  # a separate ring, a bearing without it (SKF); N U 210
    text = re.sub(rf"^([A-Z]+[ .-]*(?:18[ -]*)?)({'|'.join(SERIES)})[ -](?=\d\d(?!\d))", r"\1\2", text)  # NU 22 10
    found = _INA.match(text) or _LETTERS.match(text)
    if found is None or len(found.groups()) == 3 and found[1] not in (*TYPES, *_other_types()):
        return None
    return (found[1], found[2] + " " + found[3], found[4]) if len(found.groups()) == 4 else (found[1], found[2], found[3])


def readable_designation(text) -> Designation | None:
    """Return what a designation says as by `parse_designation`; None where there is none, or one that cannot be read."""
    try:
        return parse_designation(text)
    except DesignationError:
        return None


def is_designation(text) -> bool:
    """Return whether a text or a whole number has the form of a bearing's designation: letters of a type and a number, or a number of ISO or GOST.

    Also those of bearings that the tables do not have: `parse_designation` says what they are.
    """
    plain = _plain(text)
    return _latin(plain) is not None or _DIGITS.match(plain) is not None


def parse_designation(text: str | int) -> Designation:
    """Return what a designation says; case, blanks, hyphens and the names of makers do not matter.

    Parameters
    ----------
    text : such as ``NU 210 ECP/C3``, ``nu210``, ``FAG NU210-E-XL-TVP2-C3``, ``NCF 2928 CV``, ``SL18 2210`` or, by GOST, ``76-42210Л``.

    Raises
    ------
    DesignationError
        It names no bearing of the tables, or has a suffix that is not known; the message says what it is and what is near.
    """
    plain = _plain(text)
    found = _latin(plain)
    if found is not None:
        return _parse_latin(*found)
    if (number := _DIGITS.match(plain)) is not None:
        return _parse_number(plain, *number.groups(default=""))
    raise DesignationError(
        f"{text!r} is no designation of a cylindrical roller bearing; expected {', '.join(TYPES[:-1])} or {TYPES[-1]}, then series and bore "
        "code, such as NU 210 ECP/C3"
    )


def _parse_latin(kind: str, digits: str, suffixes: str) -> Designation:
    notes = []
    if kind.endswith("SL") and " " in digits:
        family, number = digits.split()
        suffixes = re.sub(r"^[\s-]*[A-E](?=$|[\s-])", "", suffixes)
        if kind != "SL" or family != "18":
            raise DesignationError(f"{kind}{family}{number}: {_other_types()[kind][0]}{_nearest('NCF', *_series_and_bore_code(number))}")
        kind, digits, notes = "NCF", number, [f"SL18{number} (INA) is NCF {number} V"]
        suffixes = f"V {suffixes}"
    if kind not in TYPES:
        what, nearest = _other_types()[kind]
        near = "; choose by its dimensions: bearing-sim catalog --bore 50mm" if nearest == "-" else _nearest(nearest, *_series_and_bore_code(digits))
        raise DesignationError(f"{kind} {digits}{suffixes.rstrip()}: {what}{near}")
    if re.search(r"\+?\s*HJ\s*\d", suffixes):
        nearest = {"NU": "NJ", "NJ": "NUP"}.get(kind, kind)
        raise DesignationError(
            f"{kind} {digits}: with an angle ring HJ, which the tables do not have{_nearest(nearest, *_series_and_bore_code(digits))}"
        )
    if len(digits.split("/")[0]) < 3 and "/" not in digits:
        raise DesignationError(
            f"{kind} {digits}{suffixes}: expected series and bore code, at least three digits, such as {kind} {series_of_type(kind)[1]}10"
        )
    series, bore = _series_and_bore(kind, digits)
    return _designation(kind, series, bore, _read_suffixes(kind, f"{kind} {_digits(series, bore)}", suffixes), notes)


def _designation(kind: str, series: str, bore: int, read: "_Suffixes", notes: list[str]) -> Designation:
    size = f"/{bore}" if bore >= 500 else _CODES.get(bore, f"{bore // 5:02d}")
    written = read.written(f"{kind} {series}{size}")
    try:
        clearance_limits(read.clearance, 1e-3 * bore)
    except ValueError as error:
        raise DesignationError(f"{written}: {error}; take another group") from None
    remarks = (*notes, *read.notes)
    return Designation(written, kind, series, size, bore / 1e3, read.high_capacity, read.cage, read.clearance, tuple(read.unmodelled), remarks)


def _parse_number(plain: str, gost: str, before: str, digits: str, bore: str, after: str) -> Designation:
    """Return the bearing of a number by GOST 3189; raise `DesignationError` if it is another, or one of ISO by the same digits."""
    suffixes = after.strip(" -.,/")
    iso = next((row["what"] for row in catalog_table("designations/iso_numbers") if re.fullmatch(row["pattern"], digits)), None)
    is_roller = 4 <= len(digits) <= 6 and digits[-4] == "2"
    kind, other = _gost("type").get(digits[:-4].lstrip("0"), ("", "")) if is_roller else ("", "")
    is_gost = bool(gost or before or re.search("[Б-ДЖЗИЙЛПУФЦ-Я]", suffixes))
    series = _gost("series").get(digits[-3], ("",))[0]
    if iso is not None and not (kind and is_gost):
        size, name = int(digits[-2:]), f"{digits} {suffixes}".rstrip()
        if kind and not other and series:
            raise DesignationError(
                f"{name} is {iso} by ISO, and {kind} {series}{digits[-2:]} by GOST 8328; which one is meant? "
                f"Write {kind} {series}{digits[-2:]}, or GOST {digits}"
            )
        found = f" by ISO, {other} by GOST" if other else ", not a cylindrical roller bearing"
        raise DesignationError(f"{name}: {iso}{found}{_nearest('NU', '', _bore_of_code(size))}")
    if not kind:
        rows = len(digits) == 7 and digits[-4] == "2"
        reason = "by GOST of another width series, or in two rows" if rows else "no number of ISO or GOST that can be read"
        raise DesignationError(f"{plain}: {reason}; expected a designation such as NU 210 ECP/C3, or one by GOST such as 42210")
    if not series or bore:
        raise DesignationError(
            f"{plain}: the tables have no diameter series {digits[-3]} of GOST; they have {', '.join(_gost('series'))}"
            f"{_nearest(kind, '', _bore_of_code(int(digits[-2:])))}"
        )
    if other:
        raise DesignationError(f"{plain}: by GOST {other}{_nearest(kind, series, _bore_of_code(int(digits[-2:])))}")
    series, size = _series_and_bore(kind, series + digits[-2:])
    what = f"{plain}, by GOST {kind} {_digits(series, size)}"
    read = _read_gost(what, before, suffixes)
    limits = clearance_limits(read.clearance, 1e-3 * size)
    remarks = [f"{digits} is {kind} {_digits(series, size)} by GOST 8328"]
    remarks.append(f"clearance of GOST 24810: {1e6 * limits.least:.0f} to {1e6 * limits.largest:.0f} µm, group {read.clearance}")
    if not read.high_capacity:
        remarks.append("rollers and ratings are those of other makers; without the letter А GOST bearings may carry less: give bearing.ratings")
    return _designation(kind, series, size, read, remarks)


def _read_gost(what: str, before: str, suffixes: str) -> "_Suffixes":
    """Return what stands before and after the number of a bearing of GOST: precision class, group of clearance, moment, category; and letters."""
    read = _Suffixes(group_is_given=True)
    marks = re.fullmatch(r"(?:\d?[ABАВ])?(?:[\dMМ])??([\dHН]?)([0-8TТ])", before) if before else None
    if before and marks is None:
        raise DesignationError(
            f"{what}: {before}- is none of the marks of GOST 3189; expected digits of clearance group and precision class, such as 76-"
        )
    group, precision = marks.groups() if marks is not None else ("", "")
    if group not in _gost("clearance"):
        raise DesignationError(f"{what}: clearance group {group} is not one of GOST 24810; give bearing.clearance in the scene")
    read.clearance = _gost("clearance")[group][0]
    if precision in ("2", "4", "5", "6"):
        read.unmodelled.append(f"P{precision}")
        read.notes.append(f"precision class {precision}, without effect here")
    refused, unknown = [], []
    for letter, number in re.findall(r"([^\d\s.,/-])(\d*)", suffixes.translate(_CYRILLIC)):
        cage, meaning = _gost("suffix", "refused").get(letter, ("", ""))
        if not meaning:
            unknown.append(letter + number)
        elif letter in _gost("refused"):
            refused.append(f"{letter}: {meaning}")
        elif cage and read.cage:
            raise DesignationError(f"{what}: two cages, {read.cage} and {cage}; give one")
        else:
            read.cage, read.design = cage or read.cage, read.design + cage
            read.notes.append(f"{letter}{number}: {meaning}")
        if letter == "А":
            read.high_capacity, read.design = True, "E" + read.design
    _refuse(what, read.written(what.rsplit(" GOST ")[-1]), refused, unknown)
    return read


def _bore_of_code(code: int) -> int:
    """Return the bore of a two-digit code [mm]."""
    return {0: 10, 1: 12, 2: 15, 3: 17}.get(code, 5 * code)


def _series_and_bore_code(digits: str) -> tuple[str, int]:
    """Return series and bore [mm] that digits spell, whether or not the tables have them."""
    if "/" in digits:
        return digits.split("/")[0], int(digits.split("/")[1])
    return digits[:-2], _bore_of_code(int(digits[-2:] or 0))


def _nearest(kind: str, series: str, bore: int) -> str:
    """Return the end of a message: the bearing of a type and series with that bore, or all of the type with it; "" if there is none."""
    kind = kind or "NU"
    found = [of for of in series_of_type(kind) if (of, bore) in boundaries() and _exists(kind, of, bore)]
    if series in found:
        return f"; the nearest of the tables is {kind} {_digits(series, bore)}"
    return f"; with a bore of {bore} mm the tables have {', '.join(f'{kind} {_digits(of, bore)}' for of in found)}" if found else ""


def _series_and_bore(kind: str, digits: str) -> tuple[str, int]:
    """Return series and bore [mm] of the digits of a designation; raise `DesignationError` if the tables do not have them."""
    series, bore = _series_and_bore_code(digits)
    what, offered = f"{kind} {digits}", series_of_type(kind)
    if series not in offered:
        if series not in SERIES:
            reason = f"no dimension series {series!r} in the tables"
        else:
            reason = f"series {series} is " + (
                "of full-complement bearings (NCF)" if series in ("29", "30") else "not one of full-complement bearings"
            )
        raise DesignationError(f"{what}: {reason}; {kind} has {', '.join(offered)}{_nearest(kind, series, bore)}")
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


@dataclass
class _Suffixes:
    """Suffixes as they are read."""

    design: str = ""
    high_capacity: bool = False
    cage: str = ""
    clearance: str = "CN"
    group_is_given: bool = False
    unmodelled: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def written(self, basic: str) -> str:
        """Return a basic designation such as NU 210 with these suffixes."""
        return "/".join([f"{basic} {self.design}".rstrip(), *self.unmodelled, *([self.clearance] if self.group_is_given else [])])


_CLEARANCE_NAMES = frozenset(("C0", *CLEARANCE_GROUPS, *CLEARANCE_PARTS, *OTHER_CLEARANCES))
_WITH_PRECISION = re.compile(r"^(P[0-6]|PN)([2345])$")  # such as P63: precision P6 and clearance C3


def _meaning(piece: str) -> tuple[str, str, str] | None:
    """Return kind, value and meaning of one suffix; None if it is not known."""
    if piece in _CLEARANCE_NAMES:
        return "clearance", "CN" if piece == "C0" else piece, ""
    if found := _WITH_PRECISION.match(piece):
        return "clearance", f"C{found[2]}", found[1]
    return next((each for pattern, *each in _suffixes() if pattern.match(piece)), None)


def _pieces(token: str, begins: bool = True) -> list[str] | None:
    """Return the suffixes that are written together in a token; None if there is something else in it.

    Single letters stand at its beginning, or after a design such as E: they are cages.
    """
    if not token:
        return []
    for end in range(len(token), 0, -1):
        found = _meaning(token[:end])
        if found is None or end == 1 and not (begins and (found[0] == "cage" or token[:1] in "KN")):
            continue
        rest = _pieces(token[end:], begins and token[:end] in ("K", "N", "NR"))
        if rest is not None and not (found[0] == "clearance" and any((_meaning(each) or [""])[0] == "clearance" for each in rest)):
            return [token[:end], *rest]
    return None


def _read_suffixes(kind: str, what: str, text: str) -> _Suffixes:
    read, refused, unknown = _Suffixes(), [], []
    for token in filter(None, re.split(r"[\s/.,;:+_()\[\]-]+", text)):
        if _meaning(token) is not None:
            design, pieces = "", [token]
        else:
            split = ((design, _pieces(token[len(design) :])) for design in (*_DESIGNS, "") if token.startswith(design))
            known = [(design, found) for design, found in split if found is not None and (design != "C" or not found)]
            design, pieces = min(known, key=lambda each: any(_meaning(one)[0] == "refused" for one in each[1]), default=("", None))
        if pieces is None:
            if re.match(r"^C[\dN]+$", token):
                raise DesignationError(f"{what}: no clearance group {token}; expected {', '.join(CLEARANCE_GROUPS)} (ISO 5753-1), CM or CT")
            unknown.append(token)
            continue
        if design:
            read.design, read.high_capacity = read.design + design, read.high_capacity or _DESIGNS[design]
            read.notes.append(f"{design}: {'high-capacity design' if _DESIGNS[design] else 'a design of its maker'}")
        for piece in pieces:
            _read_piece(read, kind, what, piece, refused)
    if kind == "NCF" and read.cage:
        raise DesignationError(f"{what}: a full-complement bearing has no cage, found cage {read.cage}; leave it out, or take another type")
    _refuse(what, read.written(what), refused, unknown)
    return read


def _read_piece(read: _Suffixes, kind: str, what: str, piece: str, refused: list[str]) -> None:
    """Enter one known suffix into what is read."""
    group, value, meaning = _meaning(piece)
    if group == "clearance":
        if read.group_is_given:
            raise DesignationError(f"{what}: two clearance groups, {read.clearance} and {value}; give one")
        read.clearance, read.group_is_given = value, True
        read.unmodelled += [meaning] if meaning else []
        if value in OTHER_CLEARANCES:
            read.notes.append(f"{value}: clearance of {OTHER_CLEARANCES[value]}")
    elif group == "refused":
        refused.append(f"{piece}: {meaning}")
    elif group == "none":
        read.unmodelled.append(piece)
        read.notes.append(f"{piece}: {meaning}, without effect here")
    elif not value:
        if kind != "NCF":
            raise DesignationError(f"{what}: suffix {piece} is that of a full complement of rollers; the tables have it as type NCF")
        read.design += piece
    else:
        if read.cage:
            raise DesignationError(f"{what}: two cages, {read.cage} and {value}; give one")
        read.design, read.cage = read.design + piece, value
        read.notes.append(f"{piece}: {meaning}")


def _refuse(what: str, without: str, refused: list[str], unknown: list[str]) -> None:
    """Raise `DesignationError` if there are suffixes that the model does not have, or that are not known."""
    reasons = list(refused)
    if unknown:  # never left out: a letter that is not known may be a cage or a clearance
        known = ["E", "EC", *(f"EC{cage}" for cage in CAGES), *CLEARANCE_GROUPS]
        close = difflib.get_close_matches(unknown[0], known, n=1) if len(unknown) == 1 else []
        proposal = f" (did you mean {close[0]}?)" if close else ""
        letters = ", ".join(repr(each) for each in unknown)
        reasons.append(f"unknown suffix {letters}{proposal}: nothing here says what it changes")
    if reasons:
        raise DesignationError(f"{what}: {'; '.join(reasons)}. The nearest that can be read is {without}")


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
            designation = _designation(each, of, size, _read_suffixes(each, "", ""), [])
            yield CatalogueBearing(designation, designation.boundary, rows[0].ratings if rows else Ratings(), rows[0].maker if rows else "")
