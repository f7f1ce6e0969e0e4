# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Diameters in scene files: drawings and catalogues give them, records hold radii.

Wherever a record has a ``radius`` or a ``..._radius``, a file may give ``diameter`` or ``..._diameter`` instead.  The radius of a crown is
no exception worth a rule: it is the curvature of an arc, of which nobody gives a diameter.  ``outer_raceway.diameter`` is the raceway's
diameter, E, of a raceway without lobes.
"""

import copy
import types
from collections.abc import Iterator, Mapping
from functools import cache
from typing import NamedTuple

from pydantic_core import PydanticCustomError

from bearing_sim.scene.quantity import Quantity
from bearing_sim.scene.tree import at
from bearing_sim.scene.uncertainty import flattened, quantities

ROUND_RACEWAY = "bearing.outer_raceway.diameter"
"""Path of the diameter of a raceway without lobes, E."""
_LOW_RADIUS = "bearing.outer_raceway.low_radius"
_NO_DIAMETER = ("crown_radius",)
_ENDS = ("low", "high", "mode")  # of a range


class Diameter(NamedTuple):
    """What a file may give instead of a radius.

    Attributes
    ----------
    radius : dotted path of the field that holds half of it.
    quantity : unit, bounds and meaning of the diameter.
    """

    radius: str
    quantity: Quantity

    def halved(self, value) -> float:
        """Return half of a written diameter [m]; raises as `Quantity.read`."""
        return self.quantity.read(value, written=True) / 2


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


def with_radii(tree: Mapping, scene_type: type) -> tuple[dict, list[tuple[str, str, str]]]:
    """Return a scene's tree with radii instead of diameters, also in the block ``uncertainty``, and (path, value, reason) of each error.

    A diameter in error is left out, so that its radius is missing.
    """
    if not any(_diameters_in(tree, scene_type)) and not _ranges_in(tree, scene_type):
        return dict(tree), []
    tree, errors = copy.deepcopy(dict(tree)), []
    for path, block in _diameters_in(tree, scene_type):
        found, given = diameters(scene_type)[path], block.pop(path.rpartition(".")[2])
        name = found.radius.rpartition(".")[2]
        if given is None:
            continue
        if block.get(name) is not None:
            errors.append((path, repr(given), f"{name} is given, too ({block[name]!r}); give one of the two, and leave the other out (null)"))
            continue
        try:
            block[name] = found.halved(given)
        except PydanticCustomError as error:
            errors.append((path, repr(given), error.message()))
    return tree, errors + _convert_ranges(tree, scene_type)


def gives_round_raceway(tree: Mapping) -> bool:
    """Whether a tree gives the outer raceway by one diameter, which a raceway with lobes has not."""
    return at(tree, ROUND_RACEWAY) is not None


def override_by_radius(path: str, value, scene_type: type) -> tuple[str, object]:
    """Return path and value [m] of the radius that an override of a diameter sets; those of the override if it sets none, or cannot be read."""
    found = diameters(scene_type).get(path)
    if found is None or value is None or path == ROUND_RACEWAY:  # whether that raceway is round is not known before presets are read
        return path, value
    try:
        return found.radius, found.halved(value)
    except PydanticCustomError:
        return path, value


def forget_counterpart(block: dict, path: str, scene_type: type) -> None:
    """Remove from a block the diameter of a radius that an override sets, or the radius of a diameter, in place."""
    for diameter, found in diameters(scene_type).items():
        if path in (diameter, found.radius):
            for other in {diameter, found.radius} - {path}:
                block.pop(other.rpartition(".")[2], None)


def _diameters_in(tree: Mapping, scene_type: type) -> Iterator[tuple[str, Mapping]]:
    """Yield path and block of every diameter in a tree."""
    for path in diameters(scene_type):
        place, _, name = path.rpartition(".")
        block = at(tree, place)
        if isinstance(block, Mapping) and name in block:
            yield path, block


def _ranges_in(tree: Mapping, scene_type: type) -> list[str]:
    given = tree.get("uncertainty")
    return [path for path in flattened(given) if path in diameters(scene_type)] if isinstance(given, Mapping) else []


def _convert_ranges(tree: dict, scene_type: type) -> list[tuple[str, str, str]]:
    """Replace ranges of diameters by those of radii, in place; return the errors."""
    errors, ranges = [], flattened(tree["uncertainty"]) if _ranges_in(tree, scene_type) else {}
    for path in [path for path in ranges if path in diameters(scene_type)]:
        found, value = diameters(scene_type)[path], ranges.pop(path)
        if found.radius in ranges:
            errors.append((f"uncertainty.{path}", "", f"{found.radius} has a range, too; give one of the two"))
        elif value is not None:
            ranges[found.radius], wrong = _halved_range(f"uncertainty.{path}", value, found)
            errors += wrong
    if ranges:
        tree["uncertainty"] = ranges
    return errors


def _halved_range(where: str, value, found: Diameter) -> tuple[object, list[tuple[str, str, str]]]:
    """Return a range as the file gives it, each end halved, and the errors of its ends; null if an end is in error."""
    ends = dict(zip(_ENDS, value)) if isinstance(value, (list, tuple)) else dict(value) if isinstance(value, Mapping) else {}
    errors = []
    for name, given in ends.items():
        if given is None or isinstance(value, Mapping) and name not in _ENDS:
            continue
        try:
            ends[name] = found.halved(given)
        except PydanticCustomError as error:
            errors.append((f"{where}.{name}", repr(given), error.message()))
    if errors:
        return None, errors
    return (list(ends.values()) if isinstance(value, (list, tuple)) else ends or value), []
