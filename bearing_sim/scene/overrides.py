# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Fields that are given over a scene: by an override such as ``lubricant.oil=ISO VG 68``, or by a file over the preset that it names.

A field makes void what says the same in another way, and what belonged to what it replaces: a diameter the radius, an oil the grease, another
law of heat the fields of the law before.  `_voided` is the only place that knows.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import cache

from bearing_sim.files.limits import FileError
from bearing_sim.files.yaml_text import values_of
from bearing_sim.scene.bearing import LAND_FIELDS
from bearing_sim.scene.contour import FORM_FIELDS, POINT_FORMS
from bearing_sim.scene.diameters import diameters
from bearing_sim.scene.errors import InvalidField, SceneError
from bearing_sim.scene.fields import declared_in
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.tree import Path, at, changed, leaves, parts, without
from bearing_sim.scene.uncertainty import flattened, with_range

_RACEWAY = ("bearing", "outer_raceway")
_RADII = tuple((*_RACEWAY, name) for name in ("low_radius", "low_diameter", "diameter", "low_points", "high_points", "contour", "contour_file"))
_LOW_RADIUS, _CLEARANCE = _RADII[0], ("bearing", "clearance")
_WITHOUT_CAGE = ("mass", "width", "inner_radius", "outer_radius", "pocket_clearance")
_OF_FLANGES = ("end_clearance", "corner_radius", "end_radius")
_RANGES = "uncertainty"  # begins what is void of ranges: those of all fields whose path has the beginning behind it


def read_override(override: str) -> tuple[Path, object]:
    """Return path and value of an override; raises `SceneError`."""
    path, equals, text = override.partition("=")
    path = path.strip()
    if not equals or not all(parts(path)):
        raise SceneError("--set", [InvalidField(path, "", "expected FIELD=VALUE, such as bearing.outer_raceway.low_radius=34.865mm")])
    try:
        return parts(path), values_of(text)
    except FileError:
        return parts(path), text.strip()


def given_over(tree: Mapping, path: Path, value, given: Mapping | None = None) -> Mapping:
    """Return a scene's tree with a field given over it, and without what that makes void.

    Parameters
    ----------
    tree : of a scene, or of what a file says of one.
    path : of the field.
    value : that it is given.
    given : tree of all that is given with it, of which nothing is void.
    """
    if path[0] == _RANGES and path[1:]:
        return {**tree, _RANGES: with_range(tree.get(_RANGES), ".".join(path[1:]), value)}
    for place in _voided(tree, path, value, given or {}):
        if place[0] == _RANGES:
            tree = _without_ranges(tree, place[1])
        elif given is None or at(given, place) is None:
            tree = without(tree, place)
    return changed(tree, path, value)


def merged(preset: Mapping, given: Mapping) -> Mapping:
    """Return the tree of a preset with all that a file gives over it."""
    tree = preset
    for path, value in leaves(given, preset):
        if value is not None or ".".join(path) not in diameters(Scene):  # a diameter that is null is not given
            tree = given_over(tree, path, value, given)
    return tree


def without_estimate(tree: Mapping, path: Path) -> Mapping:
    """Return a tree without the marks of estimated fields at or below a path in ``bearing``: what is given is no estimate any more."""
    marks, field = at(tree, ("bearing", "estimated")), ".".join(path[1:])
    if path[0] != "bearing" or not field or field == "estimated" or not isinstance(marks, list):
        return tree
    return changed(tree, ("bearing", "estimated"), [each for each in marks if not _is_below(each, field)])


def _is_below(estimate, field: str) -> bool:
    return isinstance(estimate, Mapping) and f"{estimate.get('field')}.".startswith(f"{field}.")


def _without_ranges(tree: Mapping, beginning: str) -> Mapping:
    """Return a tree without the ranges of fields whose path has this beginning."""
    given = tree.get(_RANGES)
    if not isinstance(given, Mapping):
        return tree
    return {**tree, _RANGES: {path: value for path, value in flattened(given).items() if not path.startswith(beginning)}}


@cache
def _always_void() -> Mapping[Path, list[Path]]:
    """Return what each field makes void whatever its value."""
    void = {("bearing",): [(_RANGES, "bearing.")], _CLEARANCE: [_LOW_RADIUS], ("lubricant", "oil"): [("lubricant", "grease")]}
    for diameter, found in diameters(Scene).items():
        for one, other in ((diameter, found.radius), (found.radius, diameter)):
            void.setdefault(parts(one), []).append(parts(other))
    for form in POINT_FORMS:
        for name in form:
            others = set(FORM_FIELDS) - ({name} if form[0] == "contour" else set(form))
            void.setdefault((*_RACEWAY, name), []).extend((*_RACEWAY, other) for other in others)
    for path in _RADII:
        void.setdefault(path, []).extend((_CLEARANCE, (_RANGES, "bearing.clearance")))
    return void


def _voided(tree: Mapping, path: Path, value, given: Mapping) -> Iterator[Path]:
    """Yield what a field makes void: paths, and ``uncertainty`` with the beginning of the paths of ranges; arguments as of `given_over`."""
    yield from _always_void().get(path, ())
    before = at(tree, path)
    match path:
        case ("bearing", "inner_raceway", "radius") | ("bearing", "roller", "diameter"):
            if at(tree, _CLEARANCE) is not None:
                yield _LOW_RADIUS
        case ("heat", "law"):
            if before not in (None, value):  # each law has fields of its own
                yield from (("heat", field) for field in tree["heat"])
                yield _RANGES, "heat."
        case ("bearing", "cage", "guidance"):
            has_lands = value not in ("roller", "full_complement")
            if value != (before or "outer_ring"):  # a cage that moves to the other ring keeps its body, and clearance and width of its lands
                gone = ("guide_radius",) if has_lands else LAND_FIELDS
                yield from (("bearing", "cage", field) for field in (*gone, *(_WITHOUT_CAGE if value == "full_complement" else ())))
            if not has_lands:
                yield _RANGES, "bearing.cage.guide_"
        case ("bearing", "flanges", "inner" | "outer" as ring) if value == "none":
            opposite = ("bearing", "flanges", "outer" if ring == "inner" else "inner")
            other = at(given, opposite) or at(tree, opposite)
            gone = (f"{ring}_radius", *(_OF_FLANGES if other in (None, "none") else ()))
            yield from (("bearing", "flanges", field) for field in gone)
        case ("lubricant", "oil" | "grease" | "supply" as name):
            yield from (("lubricant", field) for field in _voided_of_lubricant(at(tree, path[:1]), name, value))


def _voided_of_lubricant(lubricant: Mapping, name: str, value) -> Iterator[str]:
    """Yield what an oil, a grease or a supply makes void: grease is supplied as grease, oil otherwise."""
    supply = value if name == "supply" else lubricant.get("supply")
    is_grease = (supply.get("law") if isinstance(supply, Mapping) else supply) == "grease"
    if name == "oil" and is_grease:
        yield "supply"
    elif name == "grease" and value is not None:
        if isinstance(value, str) or isinstance(value, Mapping) and {"preset", "base_oil"} & set(value):
            yield "oil"
        if not is_grease:
            yield "supply"
    elif name == "supply" and not is_grease:
        yield "grease"


def require_units(overrides: Iterable[str], record: type = Scene) -> None:
    """Raise an error for overrides that give a quantity as a bare number, such as ``operating.radial_load=5``: on a command line 5 may mean 5 kN.

    Parameters
    ----------
    overrides : as of `bearing_sim.load_scene`.
    record : type of what they change.

    Raises
    ------
    SceneError
        Listing every such value with the units that it may have.
    """
    known = {
        **{path.lstrip("."): declared for path, declared in declared_in("", record)},
        **{path: each.quantity for path, each in diameters(Scene).items()},
    }
    errors = []
    for path, value in map(read_override, overrides):
        in_range = record is Scene and path[0] == _RANGES
        for place, inner in leaves({".".join(path[in_range:]): value}):
            place = ".".join(place)
            field = place.rpartition(".")[0] if in_range and place not in known else place
            for number in inner if isinstance(inner, list) else [inner]:
                if field in known and (reason := known[field].why_unit_is_needed(number)):
                    errors.append(InvalidField(f"{_RANGES}.{place}" if in_range else place, "", reason))
    if errors:
        raise SceneError("--set", errors)
