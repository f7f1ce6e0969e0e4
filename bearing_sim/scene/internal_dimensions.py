# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The inside of a bearing of the catalogue: what makers print of it, and rules for the rest, each with its error.

Makers print raceways, flanges and ratings, but neither the rollers nor the cage.  The rules below were fitted to the bearings whose rollers
follow from what is printed; ``python test/validation catalog`` fits them again, and states their errors on bearings
that are held back from the fit.  Every field that follows from a rule is listed in ``bearing.estimated`` with its range.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from bearing_sim.scene.bundled import catalog_table
from bearing_sim.scene.designation import Designation, DesignationError, MakersRow, makers_rows, parse_designation, roller_counts
from bearing_sim.scene.errors import InvalidField
from bearing_sim.scene.flanges import HEIGHT, estimated_clearance
from bearing_sim.scene.quantity import to_si
from bearing_sim.scene.ratings import Ratings
from bearing_sim.scene.tree import at, parts, without

STEEL_DENSITY = 7850.0
CAGE_DENSITIES = {"polyamide": 1320.0, "steel": 7850.0, "brass": 8400.0}  # kg/m^3, of the materials of the catalogue with these names


class DesignRules(NamedTuple):
    """Coefficients of the rules for one design of section (``python test/validation catalog`` prints them).

    Attributes
    ----------
    gap, gap_ratio : distance between neighbouring rollers along the chord of the pitch circle, s = gap + gap_ratio D_w; gap in m.
    outer_flange, inner_flange : heights of the flanges over D_w.
    count_error : 5 to 95 % range of Z about that rule.
    length_ratio : effective length of the rollers over the width of the bearing, where no maker prints a static rating.
    """

    gap: float
    gap_ratio: float
    outer_flange: float
    inner_flange: float
    count_error: int
    length_ratio: float


HIGH_CAPACITY = DesignRules(0.811e-3, 0.1516, 0.150, 0.194, 1, 0.624)
STANDARD = DesignRules(2.418e-3, 0.2049, 0.222, 0.200, 1, 0.551)
FULL_COMPLEMENT_LENGTH = 0.72  # effective length of the rollers over the width of a full-complement bearing
_LONGEST = 0.88  # effective length of the rollers at most, over the width; assumption: flanges and chamfers take the rest
# Full-complement bearings of which a flange is not printed (assumptions): D_w over D - d, how far the inner flange's edge lies below the outer
# raceway over D_w, for the estimate of that edge and for that of D_w by it, and the height of a flange over D_w.
_FULL_DIAMETER_RATIO, _FULL_INNER_FLANGE, _FULL_DEPTH, _FULL_FLANGE = 0.22, 0.8, 0.77, 0.2
_DIAMETER_RATIO = {"10": 0.235, "4": 0.24}  # D_w over D - d, where not even the flanges are printed
_OTHER_DIAMETER_RATIO = 0.27
_PARTNER = {"22": "2", "23": "3", "2": "22", "3": "23"}  # widths that share their raceways
_SAME = 1e-6  # m
_NOT_PRINTED = MakersRow("", "", Ratings(), None, None, None, None)


@dataclass(frozen=True)
class Section:
    """The inside of a bearing [m], and how each figure is known.

    Attributes
    ----------
    inner_raceway, outer_raceway : diameters F and E.
    roller_diameter, roller_length, count : D_w, effective length, Z.
    inner_flange, outer_flange : diameters d_1 and D_1 of flanges, where the rings have some.
    row : of the maker whose figures these are; without a maker's name where none of the tables prints the bearing.
    count_source : where Z is from.
    estimated : fields that follow from rules.
    """

    inner_raceway: float
    outer_raceway: float
    roller_diameter: float
    roller_length: float
    count: int
    inner_flange: float
    outer_flange: float
    row: MakersRow
    count_source: str
    estimated: tuple[dict, ...]


def is_high_capacity(row: MakersRow) -> bool:
    """Return whether a maker's row is of the high-capacity design (EC, E, R)."""
    return row.design.startswith(("E", "R"))


def preferred_diameter(diameter: float) -> float:
    """Return the nearest diameter of rollers that makers use [m]."""
    known = (float(row["diameter"]) for row in catalog_table("designations/roller_diameters"))
    return 1e-3 * min(known, key=lambda each: abs(each - 1e3 * diameter))


def count_by_gap(rules: DesignRules, roller_diameter: float, pitch_diameter: float) -> int:
    """Return the number of rollers that leaves the gap of a design between neighbours: round(pi / arcsin((D_w + s)/d_m))."""
    taken = (roller_diameter * (1.0 + rules.gap_ratio) + rules.gap) / pitch_diameter
    return round(math.pi / math.asin(min(1.0, taken)))


def full_count(roller_diameter: float, pitch_diameter: float) -> int:
    """Return the number of rollers that fill a pitch circle: the integer below pi / arcsin(D_w/d_m)."""
    return math.floor(math.pi / math.asin(roller_diameter / pitch_diameter) - 1e-9)


def length_by_static_rating(static: float, count: int, roller_diameter: float, pitch_diameter: float) -> float:
    """Return the effective length of the rollers [m] from C_0r = 44 (1 - gamma) Z L_we D_w (ISO 76), C_0r in N."""
    return 1e-6 * static / (44.0 * (1.0 - roller_diameter / pitch_diameter) * count * roller_diameter)


def section_of(designation: Designation) -> Section:
    """Return the inside of a bearing, printed where makers print it, else by the rules."""
    bore = round(1e3 * designation.bore_diameter)
    rows = makers_rows().get((designation.series, bore, designation.is_full_complement), ())
    if designation.high_capacity and any(map(is_high_capacity, rows)):
        rows = tuple(row for row in rows if is_high_capacity(row))
    row = next((each for each in rows if each.inner_raceway or each.outer_raceway), rows[0] if rows else _NOT_PRINTED)
    return _full_section(designation, row, rows) if designation.is_full_complement else _caged_section(designation, row, bore)


def printed_outer_raceway(series: str, bore: int, row: MakersRow) -> float | None:
    """Return the diameter E [m] of a row's section: its own, another maker's with the same F, or that of the width with the same F."""
    if row.outer_raceway is not None:
        return row.outer_raceway
    for of in (series, _PARTNER.get(series)):
        for other in makers_rows().get((of, bore, False), ()):
            same = None not in (row.inner_raceway, other.inner_raceway) and abs(other.inner_raceway - row.inner_raceway) < _SAME
            if same and other.outer_raceway is not None:
                return other.outer_raceway
    return None


def diameter_by_flange(rules: DesignRules, row: MakersRow) -> float | None:
    """Return D_w [m] by the flange of the outer ring, D_1 = F + 2 (1 - h) D_w, as the nearest preferred diameter; None where it is not printed."""
    if row.inner_raceway is None or row.outer_flange is None:
        return None
    return preferred_diameter((row.outer_flange - row.inner_raceway) / (2.0 * (1.0 - rules.outer_flange)))


def known_count(series: str, bore: float, inner_raceway: float, outer_raceway: float):
    """Return the `RollerCount` of a section with these raceways; None where the number of rollers is not known."""
    for each in roller_counts():
        if series in each.series and abs(each.bore - bore) < _SAME:
            if abs(each.inner_raceway - inner_raceway) < _SAME and abs(each.outer_raceway - outer_raceway) < _SAME:
                return each
    return None


def _caged_section(designation: Designation, row: MakersRow, bore: int) -> Section:
    boundary, estimated = designation.boundary, []
    rules = HIGH_CAPACITY if is_high_capacity(row) else STANDARD
    outer, inner = printed_outer_raceway(designation.series, bore, row), row.inner_raceway
    if inner is not None and outer is not None:
        diameter = (outer - inner) / 2.0
    else:
        diameter = diameter_by_flange(rules, row)
        by, low, high = "flange of the outer ring, to the next preferred diameter; within 8 % for 95 % of those printed", 0.92, 1.08
        if diameter is None:
            ratio = _DIAMETER_RATIO.get(designation.series, _OTHER_DIAMETER_RATIO)
            diameter = preferred_diameter(ratio * (boundary.outside - boundary.bore))
            by, low, high = f"{ratio:g} (D - d) of the series, to the next preferred diameter; within 10 %", 0.9, 1.1
        estimated.append(_estimate("roller.diameter", by, low, high))
        if inner is None:
            middle = 0.5 * (boundary.bore + boundary.outside)
            inner = middle - diameter
            estimated.append(_estimate("inner_raceway.radius", "raceways on both sides of (d + D)/2; within 2 %", 0.98, 1.02))
        outer = inner + 2.0 * diameter
    pitch = inner + diameter
    known = known_count(designation.series, boundary.bore, inner, outer)
    if known is not None:
        count = known.count
        deduced = "deduced from the static ratings of two widths with the same raceways"
        source = known.published or deduced + ("" if known.unique else ", and the distance between neighbours")
    else:
        count, source = count_by_gap(rules, diameter, pitch), "estimated"
        estimated.append(
            _estimate(
                "roller.count",
                f"{1e3 * rules.gap:.2f} mm + {rules.gap_ratio:.3f} D_w between neighbours; within {rules.count_error} on bearings held back",
                count - rules.count_error,
                count + rules.count_error,
            )
        )
    length = _length(row.ratings.static, count, diameter, pitch, rules.length_ratio * boundary.width, estimated, boundary.width)
    return Section(
        inner,
        outer,
        diameter,
        length,
        count,
        _printed(row.inner_flange, inner + 2.0 * rules.inner_flange * diameter, inner, outer),
        _printed(row.outer_flange, outer - 2.0 * rules.outer_flange * diameter, inner, outer),
        row,
        source,
        tuple(estimated),
    )


def _printed(value: float | None, otherwise: float, inner: float, outer: float) -> float:
    return value if value is not None and inner < value < outer else otherwise


def _length(static, count, diameter, pitch, otherwise, estimated, width) -> float:
    """Return the effective length of the rollers [m], and note how it is estimated."""
    if static is None:
        estimated.append(_estimate("roller.length", "a fraction of the width; within 15 %", 0.85, 1.15))
        return round(otherwise, 5)
    by = "static rating by ISO 76, C_0r = 44 (1 - gamma) Z L D_w; 5 % for the maker's own rounding and chamfers, more where Z is estimated"
    spread = 0.05 if not any(each["field"] in ("roller.count", "roller.diameter") for each in estimated) else 0.1
    estimated.append(_estimate("roller.length", by, 1.0 - spread, 1.0 + spread))
    return round(min(length_by_static_rating(static, count, diameter, pitch), _LONGEST * width), 5)


def _full_section(designation: Designation, row: MakersRow, rows: tuple[MakersRow, ...]) -> Section:
    """Return the inside of a full-complement bearing: E, d_1 and D_1 are printed, the flanges of both rings are taken as equally high."""
    outer = next((each.outer_raceway for each in rows if each.outer_raceway is not None), None)
    low = next((each.inner_flange for each in rows if each.inner_flange is not None), None)
    high = next((each.outer_flange for each in rows if each.outer_flange is not None), None)
    if outer is None:
        raise DesignationError(f"{designation.text}: no catalogue of the tables prints its raceway; give the dimensions in the scene")
    if low is None:
        low = outer - 2.0 * _FULL_INNER_FLANGE * _FULL_DIAMETER_RATIO * (designation.boundary.outside - designation.boundary.bore)
    height = (outer - high) / 2.0 if high is not None else None
    diameter = (outer - low) / 2.0 + height if height is not None else (outer - low) / (2.0 * _FULL_DEPTH)
    diameter = 0.5e-3 * round(diameter / 0.5e-3)
    estimated = [
        _estimate(
            "roller.diameter", "flanges of both rings equally high (E, d_1 and D_1 are printed); within 6 % on bearings with a cage", 0.94, 1.06
        )
    ]
    inner = outer - 2.0 * diameter
    pitch = inner + diameter
    count = full_count(diameter, pitch)
    estimated.append(_estimate("roller.count", "as many as fill the pitch circle, or one less", count - 1, count))
    width = designation.boundary.width
    length = _length(row.ratings.static, count, diameter, pitch, FULL_COMPLEMENT_LENGTH * width, estimated, width)
    inner_flange = low if inner < low < outer else inner + 2.0 * _FULL_FLANGE * diameter
    outer_flange = high if high is not None else outer - 2.0 * _FULL_FLANGE * diameter
    return Section(inner, outer, diameter, length, count, inner_flange, outer_flange, row, "estimated", tuple(estimated))


def _estimate(field: str, by: str, low: float, high: float) -> dict[str, Any]:
    return {"field": field, "by": by, "low": low, "high": high}


class CageRule(NamedTuple):
    """How a cage is made and guided (assumptions, with ranges in `_cage_estimates`).

    Attributes
    ----------
    material : of the catalogue.
    guidance : ``roller``, ``outer_ring`` or ``inner_ring``; ``flanges``: whichever ring has flanges on both sides, the outer one first.
    thickness : radial thickness over D_w of a cage that the rollers guide.
    filled : fraction of the volume between its surfaces and pockets that is solid.
    """

    material: str
    guidance: str
    thickness: float
    filled: float


# Kinds of cages by their suffixes, see `bearing_sim.scene.designation.CAGES`.
CAGE_RULES = {
    "P": CageRule("polyamide", "roller", 0.45, 1.0),
    "J": CageRule("steel", "roller", 0.35, 0.4),
    "M": CageRule("brass", "roller", 0.45, 1.0),
    "M1": CageRule("brass", "roller", 0.45, 1.0),
    "MA": CageRule("brass", "outer_ring", 0.45, 1.0),
    "MB": CageRule("brass", "inner_ring", 0.45, 1.0),
    "ML": CageRule("brass", "flanges", 0.45, 1.0),
}
_WIDTH = 0.9  # of the cage over that of the bearing
_POCKET_CLEARANCE = 0.02  # over D_w, on each side of a roller
_GUIDE_CLEARANCE = 0.0035  # radial, over the radius of the lands
_ROLLER_FRICTION = 0.1  # coefficient between neighbouring rollers of a full complement; assumption: mixed friction of steel on steel, 0.05 to 0.15
_HALF_THICKNESS = 0.2  # of a cage on lands, beyond the pitch circle on the side away from them, over D_w
OUTER_FLANGES = {"N": 0, "NF": 1, "NU": 2, "NJ": 2, "NUP": 2, "NCF": 1}
INNER_FLANGES = {"N": 2, "NF": 2, "NU": 0, "NJ": 1, "NUP": 2, "NCF": 2}


def cage_of(designation: Designation) -> str:
    """Return the cage of a designation: the one it names, else that of the maker's standard bearing.

    Raises
    ------
    DesignationError
        The cage is guided by flanges that the rings of this type do not have.
    """
    kind = designation.type
    if designation.cage:
        guidance = CAGE_RULES[designation.cage].guidance
        if guidance == "outer_ring" and not OUTER_FLANGES[kind]:
            reason = f"cage {designation.cage} is guided by the outer ring, which has no flanges in type {kind}; take M, P or J, or type NU"
            raise DesignationError(f"{designation.text}: {reason}")
        if guidance == "inner_ring" and not INNER_FLANGES[kind]:
            reason = f"cage {designation.cage} is guided by the inner ring, which has no flanges in type {kind}; take M, MA or P, or type N"
            raise DesignationError(f"{designation.text}: {reason}")
        return designation.cage
    rows = makers_rows().get((designation.series, round(1e3 * designation.bore_diameter), False), ())
    printed = next((row for row in rows if row.maker != "Koyo"), None)
    standard = _cage_of_design(printed.design) if printed is not None else "M"
    return "M" if CAGE_RULES[standard].guidance == "outer_ring" and not OUTER_FLANGES[kind] else standard


def _cage_of_design(design: str) -> str:
    """Return the cage in a maker's suffix such as ECP, E-TVP3 or MA; J where it names none."""
    name = parse_designation(f"NU 210 {design}").cage
    return name or "J"


class CageSpace(NamedTuple):
    """Where a cage has to fit: dimensions of a bearing [m], and the number of its rollers.

    Attributes
    ----------
    inner_raceway : diameter F.
    roller_diameter, roller_length, count : D_w, effective length, Z.
    width : B.
    inner_flange, outer_flange : diameters d_1 and D_1 of the flanges, whose faces are the lands of a cage that a ring guides.
    """

    inner_raceway: float
    roller_diameter: float
    roller_length: float
    count: int
    width: float
    inner_flange: float
    outer_flange: float


def cage_tree(name: str, space: CageSpace, guiding_ring: str = "outer_ring") -> tuple[dict[str, Any], list[dict]]:
    """Return the block of a cage of a kind, and its estimated fields.

    Parameters
    ----------
    name : one of `CAGE_RULES`.
    space : where it has to fit.
    guiding_ring : guidance of a cage that either ring may guide, ``outer_ring`` or ``inner_ring``.
    """
    rule, width, roller = CAGE_RULES[name], _WIDTH * space.width, space.roller_diameter
    guidance = guiding_ring if rule.guidance == "flanges" else rule.guidance
    middle = (space.inner_raceway + roller) / 2.0
    tree: dict[str, Any] = {"guidance": guidance, "material": rule.material, "width": round(width, 6)}
    if guidance == "roller":
        inner, outer = middle - rule.thickness * roller / 2.0, middle + rule.thickness * roller / 2.0
        tree |= {"inner_radius": round(inner, 5), "outer_radius": round(outer, 5)}
    else:
        radius = (space.outer_flange if guidance == "outer_ring" else space.inner_flange) / 2.0
        clearance = round(_GUIDE_CLEARANCE * radius, 6)
        if guidance == "outer_ring":
            inner, outer = middle - _HALF_THICKNESS * roller, radius - clearance
            tree["inner_radius"] = round(inner, 5)
        else:
            inner, outer = radius + clearance, middle + _HALF_THICKNESS * roller
            tree["outer_radius"] = round(outer, 5)
        land = max(0.02 * width, 0.5 * (width - 1.04 * space.roller_length))
        tree |= {"guide_radius": round(radius, 6), "guide_clearance": clearance, "guide_land_width": round(land, 5)}
    thickness = outer - inner
    solid = math.pi * (outer**2 - inner**2) * width - space.count * thickness * roller * space.roller_length
    tree["mass"] = float(f"{rule.filled * CAGE_DENSITIES[rule.material] * solid:.4g}")
    tree["pocket_clearance"] = round(_POCKET_CLEARANCE * roller, 7)
    return tree, list(_cage_estimates(tree, rule))


def with_cage_of_kind(bearing: Mapping, where: str) -> tuple[Mapping, list[InvalidField]]:
    """Return a block ``bearing`` whose cage, given by its kind, is a block with estimates, and why it cannot be; as it is if no kind is given.

    Parameters
    ----------
    bearing : as a file has it, with radii; its ``cage`` is a kind, such as ``P``, or a block with a ``preset`` and what differs.
    where : dotted path of the block.
    """
    given = at(bearing, ("cage",))
    if given is None:
        return without(bearing, ("cage",)), []
    own = without(given, ("preset",))
    if isinstance(given, Mapping) and own is given:
        return bearing, []
    kind, own = (given["preset"], own) if isinstance(given, Mapping) else (given, {})
    reason = ""
    if not isinstance(kind, str) or kind.strip().upper() not in CAGE_RULES:
        reason = f"{kind!r} is no kind of cage; expected one of {', '.join(CAGE_RULES)}, or a block"
    else:
        try:
            space = _space_of(bearing)
        except ValueError as error:
            reason = f"a cage of kind {kind} is estimated from rollers and raceway, but {error}"
    if reason:
        return bearing, [InvalidField(f"{where}.cage", "", reason)]
    on_inner_ring = at(bearing, ("flanges", "inner")) not in (None, "none") and at(bearing, ("flanges", "outer")) in (None, "none")
    cage, estimates = cage_tree(kind.strip().upper(), space, "inner_ring" if on_inner_ring else "outer_ring")
    marks, known = [each for each in estimates if each["field"].removeprefix("cage.") not in own], bearing.get("estimated")
    estimated = [*known, *marks] if isinstance(known, (list, tuple)) else marks if known is None else known
    return {**bearing, "cage": {**cage, **own}, "estimated": estimated}, []


def _space_of(bearing: Mapping) -> CageSpace:
    """Return where a cage has to fit in a bearing that a file gives; raise ValueError where a dimension is missing or is none."""

    def length(path: str, otherwise: float | None = None) -> float:
        given = at(bearing, parts(path))
        if given is None and otherwise is not None:
            return otherwise
        if given is None:
            raise ValueError(f"{path} is missing")
        try:
            return to_si(given, "" if path == "roller.count" else "m")
        except ValueError as error:
            raise ValueError(f"{path}: {error}") from None

    count, roller, width = int(length("roller.count")), length("roller.diameter"), length("roller.length")
    inner = length("inner_raceway.radius")
    inner_flange = length("flanges.inner_radius", inner + HEIGHT * roller)
    outer_flange = length("flanges.outer_radius", inner + roller - HEIGHT * roller)
    return CageSpace(2 * inner, roller, width, count, length("width", width / STANDARD.length_ratio), 2 * inner_flange, 2 * outer_flange)


def _cage_estimates(tree: dict, rule: CageRule) -> Iterator[dict]:
    yield _estimate("cage.mass", "volume between its surfaces less the pockets; assumption", *((0.6, 1.6) if rule.filled < 1.0 else (0.75, 1.25)))
    yield _estimate("cage.width", f"{_WIDTH:g} of the width of the bearing; assumption", 0.9, 1.06)
    for name in ("inner_radius", "outer_radius"):
        if name in tree:
            yield _estimate(f"cage.{name}", "a thickness in proportion to D_w about the pitch circle; assumption", 0.985, 1.015)
    yield _estimate("cage.pocket_clearance", f"{_POCKET_CLEARANCE:g} D_w; assumption", 0.4, 2.0)
    if "guide_clearance" in tree:
        yield _estimate("cage.guide_clearance", f"{_GUIDE_CLEARANCE:g} of the radius of the lands; assumption", 0.5, 2.0)
        yield _estimate("cage.guide_land_width", "what the cage overlaps with the flanges; assumption", 0.6, 1.2)


def bearing_tree(designation: Designation | str | int) -> dict[str, Any]:
    """Return the block ``bearing`` that a preset file of this bearing would hold: lengths and masses in SI, the clearance as its group.

    Raises
    ------
    DesignationError
        See `parse_designation` and `cage_of`.
    """
    if not isinstance(designation, Designation):
        designation = parse_designation(designation)
    section, boundary = section_of(designation), designation.boundary
    if designation.is_full_complement:
        cage, estimates, made = _full_complement_tree()
    else:
        name = cage_of(designation)
        space = CageSpace(
            section.inner_raceway,
            section.roller_diameter,
            section.roller_length,
            section.count,
            boundary.width,
            section.inner_flange,
            section.outer_flange,
        )
        cage, estimates = cage_tree(name, space, "outer_ring" if OUTER_FLANGES[designation.type] else "inner_ring")
        guide = "rollers" if cage["guidance"] == "roller" else cage["guidance"].replace("_", " ")
        made = f"cage {name}, {cage['material']}, guided by the {guide}"
    estimated = [
        *section.estimated,
        _estimate("inner_raceway.ring_mass", "solid ring with its flanges; within 8 %", 0.92, 1.08),
        _estimate("flanges.end_clearance", "15 um and 0.003 of the rollers' length; assumption", 0.5, 2.0),
        *estimates,
    ]
    tree: dict[str, Any] = {
        "name": designation.text,
        "designation": designation.text,
        "source": _source(section, boundary, made, designation),
        "clearance": designation.clearance,
        "width": boundary.width,
        "outer_raceway": {"d_value": 0.0, "lobes": 1, "outside_radius": boundary.outside / 2.0},
        "inner_raceway": {
            "radius": section.inner_raceway / 2.0,
            "bore_radius": boundary.bore / 2.0,
            "ring_mass": _inner_ring_mass(designation, section),
        },
        "roller": {"count": section.count, "diameter": round(section.roller_diameter, 7), "length": section.roller_length},
        "cage": cage,
        "flanges": _flanges_tree(designation, section),
        "estimated": estimated,
    }
    if section.row.maker:
        names = ("dynamic", "static", "fatigue_limit", "minimum_load_factor", "reference_speed", "limiting_speed")
        found = {name: value for name in names if (value := getattr(section.row.ratings, name)) is not None}
        tree["ratings"] = {name: f"{value * 30 / math.pi:.6g} rpm" if name.endswith("speed") else value for name, value in found.items()}
    return tree


def _flanges_tree(designation: Designation, section: Section) -> dict[str, Any]:
    sides = ("none", "one", "both")
    inner, outer = INNER_FLANGES[designation.type], OUTER_FLANGES[designation.type]
    tree: dict[str, Any] = {"inner": sides[inner], "outer": sides[outer]}
    if inner:
        tree["inner_radius"] = round(section.inner_flange / 2.0, 6)
    if outer:
        tree["outer_radius"] = round(section.outer_flange / 2.0, 6)
    tree["end_clearance"] = round(estimated_clearance(section.roller_length), 7)
    return tree


def _inner_ring_mass(designation: Designation, section: Section) -> float:
    boundary = designation.boundary
    volume = math.pi / 4.0 * (section.inner_raceway**2 - boundary.bore**2) * boundary.width
    flange_width = max(0.0, 0.5 * (boundary.width - section.roller_length))
    volume += INNER_FLANGES[designation.type] * math.pi / 4.0 * max(0.0, section.inner_flange**2 - section.inner_raceway**2) * flange_width
    return float(f"{STEEL_DENSITY * volume:.4g}")


def _source(section: Section, boundary, made: str, designation: Designation) -> str:
    row = section.row
    dimensions = f"d, D, B: ISO 15, as printed by {boundary.sources.replace(' ', ', ')}"
    if not row.maker:
        printed = "no maker of the tables prints its ratings; C, C_0 and C_u by ISO 281 and ISO 76"
    else:
        printed = (
            f"raceways and ratings: {row.maker} General Catalogue, {designation.type} {designation.series}{designation.size} {row.design}".rstrip()
        )
    parts = [dimensions, printed]
    if section.count_source != "estimated":
        parts.append(f"number of rollers: {section.count_source}")
    estimates = [each["field"] for each in section.estimated] + ["cage"] * (not designation.is_full_complement)
    read = f" Read: {'; '.join(designation.notes)}." if designation.notes else ""
    return "; ".join([*parts, made]) + f". Estimates: {', '.join(estimates)}.{read}"


def _full_complement_tree() -> tuple[dict, list[dict], str]:
    """Return the block of a cage that is not there, its estimated fields, and what it is."""
    friction = _estimate("cage.pocket_friction", "between neighbouring rollers, whose surfaces slide against each other; assumption", 0.5, 1.5)
    return {"guidance": "full_complement", "pocket_friction": _ROLLER_FRICTION}, [friction], "full complement of rollers, no cage"
