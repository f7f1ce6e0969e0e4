# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a scene file says by a name, a diameter or a file becomes what it stands for: one table of places and what resolves them, `RESOLVERS`."""

from collections.abc import Callable, Mapping
from functools import partial

from bearing_sim.files.yaml_text import values_of
from bearing_sim.scene.bundled import bundled_names, bundled_text
from bearing_sim.scene.contour import with_contour_text
from bearing_sim.scene.designation import DesignationError, is_designation
from bearing_sim.scene.diameters import diameters, ranged, with_radii
from bearing_sim.scene.errors import InvalidField, did_you_mean
from bearing_sim.scene.internal_dimensions import bearing_tree, with_cage_of_kind
from bearing_sim.scene.lubricant_names import with_named_lubricants
from bearing_sim.scene.overrides import merged
from bearing_sim.scene.quantity import to_si
from bearing_sim.scene.requirements import read_requirements
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.tree import Path, at, changed, parts, without
from bearing_sim.scene.uncertainty import read_ranges

NAMED_BY: Mapping[Path, str] = {
    **dict.fromkeys((("bearing",), ("bearing", "cage"), ("lubricant", "oil"), ("lubricant", "grease")), "preset"),
    **{("lubricant", name): "law" for name in ("supply", "traction", "rolling_resistance", "starvation", "mixed_friction")},
    **{("bearing", "roller", "crown"): "law", ("bearing", "seals"): "law"},
}
"""Blocks that a file may give by a name alone, and the field that the name stands for."""
_STAND_IN = "NU 210"  # for a bearing whose name is unknown, so that the rest of its scene can be checked

Resolved = tuple[object, list[InvalidField]]
"""What stands at a place after it is resolved, and the errors."""


def expanded(tree: Mapping) -> tuple[Mapping, list[InvalidField]]:
    """Return a scene's tree as its records hold it, and the errors of what cannot be resolved, in whose place something stands or nothing."""
    errors = []
    for path, kinds, resolve in RESOLVERS:
        if isinstance(given := at(tree, path), kinds):
            resolved, wrong = resolve(given, ".".join(path))
            tree, errors = changed(tree, path, resolved), errors + wrong
    return tree, errors


def consequences(errors: list[InvalidField]) -> set[str]:
    """Return the paths of fields that are in error, or missing, because of the errors of `expanded`."""
    wrong = {error.path for error in errors}
    return wrong | {found.radius for path, found in diameters(Scene).items() if path in wrong}


def _catalog_entry(kind: str, name: str, where: str) -> Resolved:
    names = bundled_names(f"catalog/{kind}")
    if name not in names:
        return {}, [InvalidField(where, repr(name), f"not in the catalog{did_you_mean(str(name), names)}; known: {', '.join(names)}")]
    return values_of(bundled_text(f"catalog/{kind}", name)), []


def _with_preset(given, where: str) -> Resolved:
    """Return a block ``bearing`` over the bearing of the catalogue that it names, by a designation or by the name of an entry."""
    if not isinstance(given, Mapping):
        given = {"preset": given}
    elif "preset" not in given:
        return given, []
    name, known = given["preset"], bundled_names("catalog/bearings")
    try:
        if name not in known and not is_designation(name):
            raise DesignationError(
                f"not in the catalog{did_you_mean(str(name), known)}; expected a designation such as NU 210 ECP/C3, or {' or '.join(known)}"
            )
        preset = _catalog_entry("bearings", name, where)[0] if name in known else bearing_tree(name)
    except DesignationError as error:
        return bearing_tree(_STAND_IN), [InvalidField(f"{where}.preset", repr(name), str(error))]
    if at(given, ("cage", "preset")) is not None:  # another kind of cage has nothing of this one
        preset = without(preset, ("cage",))
    own = without(given, ("preset",))
    bearing = merged({"bearing": preset}, {"bearing": own})["bearing"]
    if "estimated" in preset and "estimated" not in own:
        paths = {each["field"]: parts(each["field"]) for each in preset["estimated"]}
        left = [each for each in preset["estimated"] if at(own, paths[each["field"]]) is None and at(bearing, paths[each["field"]]) is not None]
        bearing = {**bearing, "estimated": left}
    return bearing, []


def _with_ranges(tree: Mapping, where: str) -> Resolved:
    ranges, errors = read_ranges({} if tree.get("uncertainty") is None else tree["uncertainty"], ranged(Scene), _bore(tree))
    return {**tree, "uncertainty": ranges}, errors


def _bore(tree: Mapping) -> float | None:
    """Return the diameter of the bore of a tree [m]; None if there is none, or it cannot be read."""
    try:
        return 2.0 * to_si(at(tree, ("bearing", "inner_raceway", "bore_radius")), "m")
    except ValueError:
        return None


def _with_requirements(tree: Mapping, where: str) -> Resolved:
    if not isinstance(tree.get("wants"), Mapping):
        return tree, []
    names, most, errors = read_requirements(tree["wants"])
    return {**tree, "wants": names, "wanted_errors": [{"want": name, "error": error} for name, error in most.items()]}, errors


_material = partial(_catalog_entry, "materials")
RESOLVERS: tuple[tuple[Path, tuple[type, ...], Callable[[object, str], Resolved]], ...] = (
    (("bearing",), (str, int, float, Mapping), _with_preset),
    ((), (Mapping,), lambda tree, where: with_radii(tree, Scene)),
    (("bearing",), (Mapping,), with_cage_of_kind),
    (("bearing", "outer_raceway"), (Mapping,), with_contour_text),
    (("bearing", "material"), (str,), _material),
    (("bearing", "cage", "material"), (str,), _material),
    (("mounting", "shaft", "material"), (str,), _material),
    (("mounting", "shaft", "sleeve", "material"), (str,), _material),
    (("mounting", "housing", "material"), (str,), _material),
    (("lubricant",), (Mapping,), with_named_lubricants),
    ((), (Mapping,), _with_ranges),
    ((), (Mapping,), _with_requirements),
)
"""Places in a tree, in the order in which they are resolved; the kinds of what stands there that is resolved; and what resolves it, given it and its
dotted path."""
