# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read scenes: YAML, presets, command-line overrides.  All errors of a file are reported at once."""

import copy
import dataclasses
import functools
import json
import numbers
import re
import types
import typing
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from bearing_sim.files.limits import SCENE_FILE, FileError
from bearing_sim.files.outside import allowing_outside, why_outside
from bearing_sim.files.reading import NO_FILE, read_text, why_not_readable
from bearing_sim.files.yaml_text import values_of
from bearing_sim.scene.bearing import Bearing, drop_other_lands
from bearing_sim.scene.bundled import bundled_names, bundled_text
from bearing_sim.scene.contour import UNREAD, drop_other_forms, with_contour_text
from bearing_sim.scene.designation import DesignationError, is_designation
from bearing_sim.scene.diameters import ROUND_RACEWAY, diameters, forget_counterpart, gives_round_raceway, override_by_radius, with_radii
from bearing_sim.scene.errors import InvalidField, SceneError, did_you_mean
from bearing_sim.scene.fidelity import choose
from bearing_sim.scene.fields import FieldFacts, laws_with, records_at
from bearing_sim.scene.fields import blocks as all_blocks
from bearing_sim.scene.flanges import drop_absent_flanges
from bearing_sim.scene.internal_dimensions import CAGE_RULES, bearing_tree, with_cage_of_kind
from bearing_sim.scene.kept_front import KeptSetting, read_front
from bearing_sim.scene.lubricant_names import keep_one_lubricant, with_named_lubricants
from bearing_sim.scene.quantity import SPEED, Quantity, to_si
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.tree import at
from bearing_sim.scene.uncertainty import declared_in, drop_ranges, flattened, nearest, override_range, quantities, read_ranges, value_at, written
from bearing_sim.scene.wants import candidates, read_wants, reason_of, without_measurement

_UNION_TAGS = frozenset(
    {"oil_4109", "constant", "kragelskii", "eyring", "fitted", "custom", "double_exponential", "reference", "hyperbolic", "power"}
    | {"none", "film_ratio", "iso_log", "straight_arc", "table", "hydrodynamic", "constant_moment", "skf", "given", "network"}
    | {"oil_jet", "circulating", "oil_bath", "oil_air", "grease"}
)


_MATERIALS = (
    ("bearing", "material"),
    ("bearing", "cage", "material"),
    ("mounting", "shaft", "material"),
    ("mounting", "shaft", "sleeve", "material"),
    ("mounting", "housing", "material"),
)
# Blocks that a file may give by a name alone, and the field that the name stands for.
_OPENED = {
    ("bearing",): "preset",
    ("bearing", "cage"): "preset",
    ("lubricant", "oil"): "preset",
    ("lubricant", "grease"): "preset",
    ("lubricant", "supply"): "law",
    ("lubricant", "traction"): "law",
    ("lubricant", "rolling_resistance"): "law",
    ("lubricant", "starvation"): "law",
    ("lubricant", "mixed_friction"): "law",
    ("bearing", "roller", "crown"): "law",
    ("bearing", "seals"): "law",
}
_RACEWAY_RADII = tuple(f"outer_raceway.{name}" for name in ("low_radius", "diameter", "low_points", "high_points", "contour", "contour_file"))
# What older scenes say, and what says it now.
_RENAMED = {
    "bearing.inner_raceway.supported_mass": "the shaft's mass is support.shaft.mass",
    "bearing.roller.slices_per_traction": "every slice has its own traction; leave it out",
    "lubricant.pumping": "give lubricant.rolling_resistance: hydrodynamic, or none",
    "lubricant.rolling_resistance.replenishment": "K_rs is lubricant.starvation.constant",
    "bearing.flanges.boundary_friction": "the coefficient of asperities everywhere is lubricant.mixed_friction.boundary_friction",
    "bearing.ring_growth": "bearing.dimensions_at: cold computes rotation, mounting the fits, heat the temperatures",
}
_MISSING = {
    "bearing.cage": f"missing; give its block, or the kind of cage, from which it is estimated: {', '.join(CAGE_RULES)}",
}
_KINDS = {type(None): "empty", list: "a list", str: "a text", int: "a number", float: "a number"}  # of what a YAML file holds
_MOST_ERRORS = 50  # that are listed
_STAND_IN = "NU 210"  # for a bearing whose name is unknown, so that the rest of its scene can be checked
_WRITTEN = {"written": True}  # context of a validation: the values come from a file or an option, see `Quantity.read`


@functools.cache
def _reader(record: type) -> TypeAdapter:
    """Return what reads a record; it is built at the first use, which takes a twentieth of a second for a scene."""
    return TypeAdapter(record)


def scene_names() -> list[str]:
    """Return the names of the bundled scenes."""
    return bundled_names("scenes")


def catalog_names(kind: str) -> list[str]:
    """Return the names of the catalog entries of a kind: ``bearings``, ``oils``, ``greases``, ``materials`` or ``mappings``."""
    return bundled_names(f"catalog/{kind}")


def read_named(name: str | Path, folder: str, kind: str) -> tuple[str, Path | None]:
    """Return the text of a bundled file by its name, or of any file by its path and then also the folder that it is in.

    Parameters
    ----------
    name : of a bundled file, or path of a YAML file.
    folder : of the bundled files: ``scenes``, or ``catalog/mappings``.
    kind : what the file holds, for messages.

    Raises
    ------
    SceneError
        There is no such file, it is no regular file or not text, or is too large.
    """
    known, path = bundled_names(folder), Path(name)
    if str(name) in known:
        return bundled_text(folder, str(name)), None
    if why_not_readable(path) == NO_FILE:
        reason = f"no such file or bundled {kind}{did_you_mean(str(name), known)}; bundled: {', '.join(known)}"
        raise SceneError(str(name), [InvalidField(kind, "", reason)])
    try:
        return read_text(path, SCENE_FILE), path.parent
    except FileError as error:
        raise SceneError(str(name), [InvalidField(kind, "", error.reason)]) from None


def load_scene(
    scene: str | Path | Mapping[str, Any] | Scene, overrides: list[str] | tuple[str, ...] | Mapping[str, Any] = (), allow_outside: bool = False
) -> Scene:
    """Load a scene by bundled name or file path, or from nested mappings, or change any fields of a loaded one.

    Parameters
    ----------
    scene : the name of a bundled scene (see `scene_names`), the path of a YAML file, what such a file holds, or a scene.
    overrides : texts such as ``"bearing.outer_raceway.low_radius=34.865mm"``, applied in order over the file; or a mapping of dotted paths or nested
        blocks to values, in which a number is in SI.
    allow_outside : whether a file may name files of contour and crown outside of its own folder.

    Raises
    ------
    SceneError
        The file is absent, is not YAML, or has errors; all of them are listed.
    TypeError
        ``scene`` or ``overrides`` is none of these.
    """
    if not isinstance(scene, (str, Path, Mapping, Scene)):
        raise TypeError(f"scene = {scene!r}: expected the name of a bundled scene, the path of a file, what a file holds as a mapping, or a Scene")
    overrides = override_texts(overrides)
    if isinstance(scene, Scene):
        return scene_from_mapping(_overridden(_as_mapping(scene), overrides), origin=scene.name)
    if isinstance(scene, Mapping):
        return scene_from_mapping(_overridden(copy.deepcopy(dict(scene)), overrides), origin=str(scene.get("name", "scene")))
    text, folder = read_named(scene, "scenes", "scene")
    with allowing_outside(allow_outside):
        return scene_from_yaml(text, overrides, origin=str(scene), folder=folder)


def scene_fields(path: str = "") -> tuple[FieldFacts, ...]:
    """Return the fields of a scene with unit, default, range and meaning: the one at a dotted path and all below it; without a path all.

    Raises
    ------
    LookupError
        There is no such field.
    """
    plain = {fact: fact.path.replace("[]", "") for each in all_blocks(Scene) for fact in each.fields}
    found = tuple(fact for fact, bare in plain.items() if not path or f"{bare}.".startswith(f"{path}."))
    if not found:
        raise LookupError(f"{path}: no field of a scene{nearest(path, plain.values())}")
    return found


def override_texts(overrides: Iterable[str] | Mapping[str, Any]) -> list[str]:
    """Return overrides of a scene as texts; those of a mapping with a number as its SI value.  Raise `TypeError` where they are neither."""
    if isinstance(overrides, Mapping):
        known = quantities(Scene)
        return [f"{path}={_override_text(known.get(path), value)}" for path, value in flattened(overrides).items()]
    given = list(overrides) if isinstance(overrides, Iterable) and not isinstance(overrides, str) else [None]
    if not all(isinstance(each, str) for each in given):
        raise TypeError(f"overrides = {overrides!r}: expected a list of texts such as ['level=steady'], or a mapping such as {{'level': 'steady'}}")
    return given


def _override_text(declared: Quantity | None, value: object) -> str:
    if isinstance(value, numbers.Real) and not isinstance(value, bool):
        return str(value) if declared is None else declared.written(float(value))
    return value if isinstance(value, str) else json.dumps(value)


def scene_from_yaml(text: str, overrides: Iterable[str] = (), origin: str = "scene", folder: Path | None = None) -> Scene:
    """Build a scene from YAML text (see `load_scene`).

    Paths in the text are relative to ``folder`` and stay below it; without a folder, as in the scene of a recording, the text may name no file
    to be read.  Paths in overrides are relative to the current folder.
    """
    tree = yaml_mapping(text, origin, "bearing, lubricant, operating ...")
    refused = _anchor_files(tree, folder)
    tree = _overridden(tree, overrides)
    if errors := [error for error in refused if at(tree, error.path) is error.written]:
        raise SceneError(origin, [InvalidField(error.path, repr(error.written), error.reason) for error in errors])
    return scene_from_mapping(tree, origin)


class _RefusedFile(NamedTuple):
    """A file that a scene names and that is not read: the field, its value as it is written, and the reason."""

    path: str
    written: str
    reason: str


def _anchor_files(tree: dict, folder: Path | None) -> list[_RefusedFile]:
    """Resolve the paths of the files of contour and crown relative to the folder of the scene file, in place; return those that are refused."""
    refused = []
    for *blocks, name in (("bearing", "outer_raceway", "contour_file"), ("bearing", "roller", "crown", "file")):
        node = at(tree, ".".join(blocks))
        if not isinstance(node, dict) or not isinstance(node.get(name), str) or node.get("contour") is not None:
            continue  # with the text of the contour, the file is but a name
        reason = why_outside(node[name], folder) if folder is not None else "this scene is no file of its own, so it cannot name others"
        if reason:
            refused.append(_RefusedFile(".".join((*blocks, name)), node[name], reason))
        else:
            node[name] = str(folder / node[name])
    return refused


def scene_from_mapping(tree: Mapping, origin: str = "scene") -> Scene:
    """Build a scene from nested mappings, resolving presets from the catalog.

    Raises
    ------
    SceneError
        Listing every error with its path, value and the expected value.
    """
    halved, wrong_diameters = with_radii(tree, Scene)
    resolved, errors = _with_presets(halved)
    resolved, unread = with_contour_text(resolved)
    ranges, wrong = read_ranges(resolved.get("uncertainty"), Scene, _bore(resolved))
    resolved["uncertainty"] = ranges
    errors += [InvalidField(*error) for error in (*wrong_diameters, *wrong)]
    if isinstance(resolved.get("wants"), Mapping):
        resolved["wants"], most, unread_wants = read_wants(resolved["wants"])
        resolved["wanted_errors"] = [{"want": name, "error": error} for name, error in most.items()]
        errors += unread_wants
    if gives_round_raceway(tree) and _has_lobes(resolved):
        errors.append(InvalidField(ROUND_RACEWAY, "", "this raceway has lobes, and no one diameter; give low_diameter or low_radius"))
    without = {diameters(Scene)[path].radius for path, _, _ in wrong_diameters if path in diameters(Scene)}
    try:
        scene = _reader(Scene).validate_python(_with_level(resolved, origin), context=_WRITTEN)
    except ValidationError as error:
        found = invalid_fields(error, Scene, _UNION_TAGS)
        if any(each.path == "bearing.preset" for each in errors):  # what depends on the bearing that stands in is no error of the file
            found = [each for each in found if each.path.partition(".")[0] not in ("", "bearing", "mounting")]
        if any(each.path == "bearing.cage" for each in errors):
            found = [each for each in found if each.path != "bearing.cage"]
        errors += [each for each in found if not (unread and UNREAD in each.reason or each.path in without and each.reason == "missing")]
    if unread:
        errors.append(InvalidField("bearing.outer_raceway.contour_file", *unread))
    if errors:
        raise SceneError(origin, errors)
    return scene


def load_bearing(name: str) -> Bearing:
    """Return a bearing by its designation, or by its name in the catalogue.

    Raises
    ------
    SceneError
        There is no such bearing, or the table's entry has errors; all of them are listed.
    """
    tree, errors = _with_presets({"bearing": name})
    if not errors:
        try:
            return _reader(Bearing).validate_python(tree["bearing"], context=_WRITTEN)
        except ValidationError as error:
            errors = invalid_fields(error, Bearing, _UNION_TAGS)
    raise SceneError(name, errors)


def _bore(tree: Mapping) -> float | None:
    """Return the diameter of the bore of a tree [m]; None if there is none, or it cannot be read."""
    try:
        return 2.0 * to_si(at(tree, "bearing.inner_raceway.bore_radius"), "m")
    except ValueError:
        return None


def _has_lobes(tree: Mapping) -> bool:
    """Whether the outer raceway of a tree has high points or a D value above zero; False for what cannot be read."""
    raceway = at(tree, "bearing.outer_raceway")
    if not isinstance(raceway, Mapping):
        return False
    try:
        return bool(raceway.get("high_points")) or to_si(raceway.get("d_value") or 0.0, "m") > 0.0
    except ValueError:
        return False


def _with_level(tree: Mapping, origin: str) -> Mapping:
    """Return a scene's tree with ``level: auto`` resolved to the lowest level that has everything the scene asks for.

    Where it wants largest errors, it gets the fastest setting whose measured errors keep them, with all its overrides; or the most accurate level
    where nothing is known to keep them (see `bearing_sim.scene.wants`).

    Raises
    ------
    ValidationError
        The scene has errors, or no level has everything it asks for.
    """
    if tree.get("level") != "auto":
        return tree
    highest = "slip" if at(tree, "bearing.cage.guidance") == "full_complement" else "spatial"  # the level with all other effects
    scene = _reader(Scene).validate_python({**tree, "level": highest}, context=_WRITTEN)
    found = choose(scene)
    if found.level is not None and scene.wanted_errors:
        errors = {each.want: each.error for each in scene.wanted_errors}
        kept = read_front(scene)
        for setting in candidates(scene, errors, kept):
            chosen = _with_setting(tree, setting)
            if _is_valid(chosen):
                return {**chosen, "level_reason": reason_of(setting, errors, kept.at(scene), origin)}
        found = without_measurement(scene, errors, kept, origin)
    if found.level is None:
        detail = {"type": PydanticCustomError("no_level", "{reason}", {"reason": found.reason}), "loc": ("level",), "input": "auto"}
        raise ValidationError.from_exception_data("Scene", [detail])
    return {**tree, "level": found.level, "level_reason": found.reason}


def _with_setting(tree: Mapping, setting: KeptSetting) -> dict:
    """Return a scene's tree at the level and with the overrides of a measured setting."""
    return _overridden(copy.deepcopy({**tree, "level": setting.level}), setting.overrides)


def _is_valid(tree: Mapping) -> bool:
    """Whether a tree is a valid scene; a measured fixed step may be too long at another speed."""
    try:
        _reader(Scene).validate_python(tree, context=_WRITTEN)
    except ValidationError:
        return False
    return True


def with_setting(scene: Scene, setting: KeptSetting) -> Scene:
    """Return a scene at the level and with the overrides of a measured setting.

    Raises
    ------
    SceneError
        The setting is none for this scene, such as a fixed step that is too long at its speed.
    """
    return load_scene(scene, [f"level={setting.level}", "level_reason=''", *setting.overrides])


def scene_to_yaml(scene: Scene) -> str:
    """Return the whole scene as YAML in SI, rotational speeds with their unit; `scene_from_yaml` reads it back equal."""
    return yaml.dump(_as_mapping(scene), Dumper=_LineDumper, sort_keys=False, allow_unicode=True)


def _as_mapping(scene: Scene) -> dict:
    """Return the whole scene as nested mappings in SI, rotational speeds as texts with their unit; `scene_from_mapping` reads it back equal."""
    tree = _plain(dataclasses.asdict(scene))
    for path, declared in declared_in("", Scene):
        *blocks, last = path.split(".")[1:]
        if declared.unit == SPEED and (block := functools.reduce(dict.get, blocks, tree))[last] is not None:
            block[last] = declared.written(block[last])
    if most := {each["want"]: each["error"] for each in tree.pop("wanted_errors")}:
        tree["wants"] = {name: most.get(name) for name in tree["wants"]}
    return {**tree, "uncertainty": written(tree["uncertainty"], Scene)}


class _LineDumper(yaml.SafeDumper):
    """SafeDumper that writes multi-line texts, such as contours, as blocks."""


_LineDumper.add_representer(str, lambda dumper, text: dumper.represent_scalar("tag:yaml.org,2002:str", text, style="|" if "\n" in text else None))


def _plain(value):
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item) for item in value]
    return value


def yaml_mapping(text: str, origin: str, expected: str) -> dict:
    """Return the mapping in a YAML text; ``expected`` names some of its keys for the error message.

    Raises
    ------
    SceneError
        The text is not YAML, is not a mapping, has a repeated key, or exceeds a limit (see `bearing_sim.files.yaml_text`).
    """
    try:
        tree = values_of(text)
    except FileError as error:
        raise SceneError(origin, [InvalidField("", "", str(error))]) from None
    if not isinstance(tree, dict):
        raise SceneError(origin, [InvalidField("", "", f"{_KINDS.get(type(tree), 'a value')}, expected a mapping with {expected}")])
    return tree


def _overridden(tree: dict, overrides: Iterable[str]) -> dict:
    """Apply overrides (see `load_scene`) in order to a scene's tree, in place, and return it."""
    for override in overrides:
        _apply_override(tree, override)
    return tree


def require_units(overrides: Iterable[str], record: type = Scene) -> None:
    """Raise an error for overrides that give a quantity as a bare number, such as ``operating.radial_load=5``: on a command line 5 may mean 5 kN.

    Parameters
    ----------
    overrides : as of `load_scene`.
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
    for keys, value in map(_read_override, overrides):
        in_range = record is Scene and keys[0] == "uncertainty"
        for path, number in _numbers_in(".".join(keys[in_range:]), value):
            field = path.removesuffix(f".{path.rpartition('.')[2]}") if in_range and path not in known else path
            if field in known and (reason := known[field].why_unit_is_needed(number)):
                errors.append(InvalidField(f"uncertainty.{path}" if in_range else path, "", reason))
    if errors:
        raise SceneError("--set", errors)


def _numbers_in(path: str, value) -> Iterator[tuple[str, object]]:
    """Yield the values in a value, each with its path."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from _numbers_in(f"{path}.{name}", inner)
    elif isinstance(value, list):
        for inner in value:
            yield from _numbers_in(path, inner)
    else:
        yield path, value


def _read_override(override: str) -> tuple[list[str], object]:
    """Return the path of an override, in parts, and its value."""
    path, equals, text = override.partition("=")
    keys = path.strip().split(".")
    if not equals or not all(keys):
        raise SceneError("--set", [InvalidField(path, "", "expected FIELD=VALUE, such as bearing.outer_raceway.low_radius=34.865mm")])
    try:
        return keys, values_of(text)
    except FileError:
        return keys, text.strip()


def _law_kept(tree: Mapping, block: list[str], field: str) -> dict:
    """Return the law that the block of an override has where its scene leaves it to a default, so that the block keeps it; if it has that field."""
    path = ".".join(block)
    known = laws_with(Scene, f"{path}.{field}")
    if not known or field == "law":
        return {}
    try:
        law = getattr(value_at(scene_from_mapping(tree, "scene"), path), "law", None)
    except SceneError:  # another override may mend it
        return {}
    return {"law": law} if law in known else {}


def _apply_override(tree: dict, override: str) -> None:
    keys, value = _read_override(override)
    if keys[0] == "uncertainty" and len(keys) > 1:
        override_range(tree, keys, value)
        return
    path, value = override_by_radius(".".join(keys), value, Scene)
    keys, node = path.split("."), tree
    for depth, key in enumerate(keys[:-1]):
        child = node.get(key)
        if isinstance(child, str) and (opened := _OPENED.get(tuple(keys[: depth + 1]))):
            child = {opened: child}
        if child is None:
            child = _law_kept(tree, keys[: depth + 1], keys[depth + 1])
        if not isinstance(child, dict):
            raise SceneError("--set", [InvalidField(".".join(keys[: depth + 1]), repr(child), f"is a value, not a block; {path} cannot be set")])
        node[key] = dict(child)
        node = node[key]
    if keys == ["heat", "law"] and node.get("law") not in (None, value):  # each law has fields of its own
        node.clear()
        drop_ranges(tree, "heat.")
    if keys == ["bearing", "cage", "guidance"]:
        drop_other_lands(node, {"guidance": value})
    node[keys[-1]] = value
    forget_counterpart(node, path, Scene)
    if keys[:-1] == ["lubricant"]:
        keep_one_lubricant(node, keys[-1], value)
    if keys[:-1] == ["bearing", "outer_raceway"]:
        drop_other_forms(node, ("low_radius" if path == ROUND_RACEWAY else keys[-1],))
    if keys == ["bearing"]:  # another bearing, for which no range was meant
        drop_ranges(tree, "bearing.")
    elif keys[0] == "bearing":
        _keep_one_clearance(tree["bearing"], ".".join(keys[1:]))
        _forget_estimate(tree["bearing"], ".".join(keys[1:]))
        if ".".join(keys[1:]) in _RACEWAY_RADII:
            drop_ranges(tree, "bearing.clearance")
    if keys == ["bearing", "cage", "guidance"] and value in ("roller", "full_complement"):
        drop_ranges(tree, "bearing.cage.guide_")


def _forget_estimate(bearing, given: str) -> None:
    """Remove the mark of an estimated field from a block ``bearing``, in place, after the field or a block around it was given."""
    if isinstance(bearing, dict) and isinstance(bearing.get("estimated"), list) and given != "estimated":
        bearing["estimated"] = [
            each
            for each in bearing["estimated"]
            if not (isinstance(each, Mapping) and (each.get("field") == given or str(each.get("field")).startswith(f"{given}.")))
        ]


def _keep_one_clearance(bearing: dict, given: str) -> None:
    """Remove from a block ``bearing`` what says the same as a field that was just given: the clearance, or the radius that follows from it."""
    raceway = bearing.get("outer_raceway")
    if given in _RACEWAY_RADII:
        bearing.pop("clearance", None)
    elif isinstance(raceway, dict) and (given == "clearance" or given in ("inner_raceway.radius", "roller.diameter") and "clearance" in bearing):
        bearing["outer_raceway"] = {name: value for name, value in raceway.items() if name != "low_radius"}


def _from_catalog(kind: str, name: str, path: str) -> tuple[dict, list[InvalidField]]:
    names = catalog_names(kind)
    if name not in names:
        return {}, [InvalidField(path, repr(name), f"not in the catalog{did_you_mean(str(name), names)}; known: {', '.join(names)}")]
    return _catalog_entry(kind, name), []


def _catalog_entry(kind: str, name: str) -> dict:
    return values_of(bundled_text(f"catalog/{kind}", name))


def _bearing_preset(name) -> tuple[dict, list[InvalidField]]:
    """Return the block of a bearing by its designation, or by its name in the catalog."""
    if name in catalog_names("bearings"):
        return _from_catalog("bearings", name, "bearing.preset")
    if is_designation(name):
        try:
            return bearing_tree(name), []
        except DesignationError as error:
            return {}, [InvalidField("bearing.preset", repr(name), str(error))]
    known = catalog_names("bearings")
    reason = f"not in the catalog{did_you_mean(str(name), known)}; expected a designation such as NU 210 ECP/C3, or {' or '.join(known)}"
    return {}, [InvalidField("bearing.preset", repr(name), reason)]


def _with_presets(tree: Mapping) -> tuple[dict, list[InvalidField]]:
    tree, errors = dict(tree), []
    bearing = tree.get("bearing")
    if isinstance(bearing, (str, int, float)):
        bearing = {"preset": bearing}
    if isinstance(bearing, Mapping) and "preset" in bearing:
        preset, unknown = _bearing_preset(bearing["preset"])
        errors += unknown
        raceway = bearing.get("outer_raceway")
        if isinstance(raceway, Mapping) and "outer_raceway" in preset:
            drop_other_forms(preset["outer_raceway"], raceway)
            if any(f"outer_raceway.{name}" in _RACEWAY_RADII for name in raceway):
                preset.pop("clearance", None)
        if "clearance" in bearing and "outer_raceway" in preset:
            preset["outer_raceway"].pop("low_radius", None)
        cage = bearing.get("cage")
        if isinstance(cage, Mapping) and "preset" in cage:  # another kind of cage has nothing of this one
            preset.pop("cage", None)
        elif isinstance(cage, Mapping) and "cage" in preset:
            drop_other_lands(preset["cage"], cage)
        flanges = bearing.get("flanges")
        if isinstance(flanges, Mapping) and "flanges" in preset:
            drop_absent_flanges(preset["flanges"], flanges)
        given = {key: value for key, value in bearing.items() if key != "preset"}
        tree["bearing"] = _merged(preset, given)
        if "estimated" in preset and "estimated" not in given:
            tree["bearing"]["estimated"] = [
                each for each in preset["estimated"] if at(given, each["field"]) is None and at(tree["bearing"], each["field"]) is not None
            ]
        if unknown:
            tree["bearing"] = bearing_tree(_STAND_IN)
    if isinstance(tree.get("bearing"), Mapping):
        tree["bearing"], reason = with_cage_of_kind(tree["bearing"])
        errors += [InvalidField("bearing.cage", "", reason)] if reason else []
    for path in _MATERIALS:
        tree, unknown = _with_material(tree, path)
        errors += unknown
    if isinstance(tree.get("lubricant"), Mapping):
        tree["lubricant"], unknown = with_named_lubricants(tree["lubricant"], catalog_names, _catalog_entry)
        errors += [InvalidField(*error) for error in unknown]
    return tree, errors


def _with_material(tree: Mapping, path: Sequence[str], walked: str = "") -> tuple[dict, list[InvalidField]]:
    """Return a block with the material at a path below it, if that is a name, replaced by the entry of the catalog."""
    block, rest = dict(tree), path[1:]
    here, child = f"{walked}{path[0]}", block.get(path[0])
    if rest:
        if not isinstance(child, Mapping):
            return block, []
        block[path[0]], unknown = _with_material(child, rest, f"{here}.")
        return block, unknown
    if not isinstance(child, str):
        return block, []
    material, unknown = _from_catalog("materials", child, here)
    return {**block, path[0]: material}, unknown


def _merged(base: dict, over: Mapping) -> dict:
    merged = dict(base)
    for key, value in over.items():
        both_blocks = isinstance(value, Mapping) and isinstance(merged.get(key), dict)
        merged[key] = _merged(merged[key], value) if both_blocks else value
    return merged


def invalid_fields(error: ValidationError, record: type, laws: frozenset[str]) -> list[InvalidField]:
    """Return the errors that pydantic found in a tree, with messages for the author of the file.

    Parameters
    ----------
    error : as raised by pydantic.
    record : the record type of the whole tree.
    laws : values of the field ``law``, which selects the record of a union; pydantic includes them in its paths.
    """
    problems = error.errors(include_url=False)
    found = [_invalid_field(problem, record, laws) for problem in problems[:_MOST_ERRORS]]
    if len(problems) > _MOST_ERRORS:
        found.append(InvalidField("", "", f"and {len(problems) - _MOST_ERRORS} more errors"))
    return found


def _invalid_field(problem: Mapping, record: type, laws: frozenset[str]) -> InvalidField:
    path = _written_path(problem["loc"], record, laws)
    kind, reason, value = problem["type"], problem["msg"], problem["input"]
    shown = "" if isinstance(value, Mapping) or dataclasses.is_dataclass(value) or type(value).__name__ == "ArgsKwargs" else repr(value)
    if kind == "missing":
        return InvalidField(path, "", _MISSING.get(path, "missing"))
    if kind == "union_tag_not_found":
        given = [name for name in problem["input"] if isinstance(name, str)] if isinstance(problem["input"], Mapping) else []
        fitting = [law for law in _laws_of(record, path) if all(law in laws_with(record, f"{path}.{name}") for name in given)]
        none = next((name for name in given if not laws_with(record, f"{path}.{name}")), None)
        which = f"of the laws with {' and '.join(given)}" if given and fitting else "of the laws"
        unknown = f"; none of them has {none}" if none else ""
        return InvalidField(f"{path}.law", "", f"missing; expected one {which}: {', '.join(fitting or _laws_of(record, path))}{unknown}")
    if kind == "union_tag_invalid":
        tag, known = problem["ctx"]["tag"], problem["ctx"]["expected_tags"]
        return InvalidField(f"{path}.law", repr(tag), f"expected one of {known}{did_you_mean(str(tag), re.findall(r'[a-z_0-9]+', known))}")
    if kind == "unexpected_keyword_argument":
        if path in _RENAMED:
            return InvalidField(path, shown, f"no longer a field; {_RENAMED[path]}")
        known, block = _field_names(problem["loc"][:-1], record, laws), path.rpartition(".")[0]
        if others := laws_with(record, path):
            return InvalidField(
                path, shown, f"no field of this law; set {block}.law to {' or '.join(others)}, which {'has' if len(others) == 1 else 'have'} it"
            )
        more = f"; see: bearing-sim fields {block}".rstrip() if record is Scene else ""
        return InvalidField(path, shown, f"unknown field{did_you_mean(str(problem['loc'][-1]), known)}; known here: {', '.join(known)}{more}")
    return InvalidField(path, shown, re.sub(r"^(Value error, |Input should be )", lambda m: "" if m[1].startswith("Value") else "expected ", reason))


def _laws_of(record: type, path: str) -> list[str]:
    return [block.law for block in records_at(record, path) if block.law]


def _written_path(loc: Iterable, record: type, laws: frozenset[str]) -> str:
    """Return the dotted path that the file has for a place in pydantic's words, which contain the laws that select records of unions."""
    kind, parts = record, []
    for part in loc:
        selects = not dataclasses.is_dataclass(kind) and part in laws  # a field may be called like a law
        kind = _inner_kind(kind, part, laws)
        if not selects:
            parts.append(str(part))
    return ".".join(parts)


def _field_names(loc: Iterable, record: type, laws: frozenset[str]) -> list[str]:
    kind = record
    for part in loc:
        kind = _inner_kind(kind, part, laws)
    return [field.name for field in dataclasses.fields(kind)] if dataclasses.is_dataclass(kind) else []


def _inner_kind(kind, part: str | int, laws: frozenset[str]):
    """Return the record type or union of types that a type has at a part of pydantic's path; None where there is none."""
    if isinstance(part, int):  # index into a tuple of records
        return _unwrapped(next(iter(typing.get_args(kind)), None))
    if dataclasses.is_dataclass(kind):
        return _unwrapped(typing.get_type_hints(kind, include_extras=True).get(part))
    if part in laws:
        return next((option for option in typing.get_args(kind) if getattr(option, "law", None) == part), None)
    return None


def _unwrapped(hint):
    """Return the record type, or the union of record types, inside an annotation."""
    if typing.get_origin(hint) is typing.Annotated:
        hint = typing.get_args(hint)[0]
    if isinstance(hint, types.UnionType) or typing.get_origin(hint) is typing.Union:
        records = [kind for kind in map(_unwrapped, typing.get_args(hint)) if dataclasses.is_dataclass(kind) or isinstance(kind, types.UnionType)]
        return hint if len(records) > 1 else records[0] if records else float
    return hint
