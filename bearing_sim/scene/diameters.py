# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Diameters in scene files: drawings and catalogues give them, records hold radii.

Wherever a record has a ``radius`` or a ``..._radius``, a file may give ``diameter`` or ``..._diameter`` instead.  The radius of a crown is
no exception worth a rule: it is the curvature of an arc, of which nobody gives a diameter.  ``outer_raceway.diameter`` is the raceway's
diameter, E, of a raceway without lobes.
"""

import types
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

from pydantic_core import PydanticCustomError

from bearing_sim.scene.errors import InvalidField
from bearing_sim.scene.quantity import Quantity, to_si
from bearing_sim.scene.tree import at, changed, parts, without
from bearing_sim.scene.uncertainty import quantities

ROUND_RACEWAY = "bearing.outer_raceway.diameter"
"""Path of the diameter of a raceway without lobes, E."""
_LOW_RADIUS = "bearing.outer_raceway.low_radius"
_NO_DIAMETER = ("crown_radius",)


class Diameter(NamedTuple):
    """What a file may give instead of a radius.

    Attributes
    ----------
    radius : dotted path of the field that holds half of it.
    quantity : unit, bounds and meaning of the diameter.
    """

    radius: str
    quantity: Quantity


@cache
def diameters(scene_type: type) -> Mapping[str, Diameter]:
    """Return all diameters that a file of a scene may give, by their dotted paths."""
    known, found = quantities(scene_type), {}
    for path, radius in known.items():
        block, _, name = path.rpartition(".")
        word = name.removesuffix("radius")
        diameter = f"{block}.{word}diameter"
        if name.endswith("radius") and name not in _NO_DIAMETER and diameter not in known:
            meaning = f"twice {name}, which is the {radius.meaning}"
            found[diameter] = Diameter(path, Quantity("m", meaning, 2 * radius.minimum, 2 * radius.maximum, radius.shown_in))
    found[ROUND_RACEWAY] = Diameter(_LOW_RADIUS, found["bearing.outer_raceway.low_diameter"].quantity)
    return types.MappingProxyType(found)


def with_radii(tree: Mapping, scene_type: type) -> tuple[Mapping, list[InvalidField]]:
    """Return a scene's tree with radii instead of diameters, and the errors; a diameter in error is left out, so that its radius is missing."""
    errors = []
    for path, (radius, quantity) in diameters(scene_type).items():
        given, known = at(tree, parts(path)), at(tree, parts(radius))
        tree = without(tree, parts(path))
        if given is None:
            continue
        if known is not None:
            reason = f"{parts(radius)[-1]} is given, too ({known!r}); give one of the two, and leave the other out (null)"
            errors.append(InvalidField(path, repr(given), reason))
            continue
        if path == ROUND_RACEWAY and _has_lobes(at(tree, parts(path)[:-1])):
            errors.append(InvalidField(path, "", "this raceway has lobes, and no one diameter; give low_diameter or low_radius"))
        try:
            tree = changed(tree, parts(radius), quantity.read(given, written=True) / 2)
        except PydanticCustomError as error:
            errors.append(InvalidField(path, repr(given), error.message()))
    return tree, errors


def _has_lobes(raceway: Mapping) -> bool:
    """Whether a block ``outer_raceway`` has high points or a D value above zero; False for what cannot be read."""
    try:
        return bool(raceway.get("high_points")) or to_si(raceway.get("d_value") or 0.0, "m") > 0.0
    except ValueError:
        return False


@cache
def ranged(scene_type: type) -> Mapping[str, tuple[str, Quantity, float]]:
    """Return what may have a range in a file, as `bearing_sim.scene.uncertainty.read_ranges` takes it."""
    given = {path: (found.radius, found.quantity, 0.5) for path, found in diameters(scene_type).items()}
    return given | {path: (path, declared, 1.0) for path, declared in quantities(scene_type).items()}


def override_by_radius(path: str, value, scene_type: type) -> tuple[str, object]:
    """Return path and value [m] of the radius that an override of a diameter sets; those of the override if it sets none, or cannot be read."""
    found = diameters(scene_type).get(path)
    if found is None or value is None or path == ROUND_RACEWAY:  # whether that raceway is round is not known before presets are read
        return path, value
    try:
        return found.radius, found.quantity.read(value, written=True) / 2
    except PydanticCustomError:
        return path, value
