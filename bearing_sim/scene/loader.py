# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Read scenes, in four steps none of which changes what it is given; all errors of a step are reported at once.

`yaml_mapping` reads a file, `overridden` gives fields of the command line over it, `bearing_sim.scene.names.expanded` puts what names, diameters and
files stand for in their place, and pydantic validates the records (`scene_from_mapping`).  Overrides come before names, so that a cage that is
estimated from its bearing, say, follows from the fields that are given.
"""

import dataclasses
import functools
import json
import numbers
import shlex
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml
from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticCustomError

from bearing_sim.files.limits import SCENE_FILE, FileError
from bearing_sim.files.outside import allowing_outside, why_outside
from bearing_sim.files.reading import NO_FILE, read_text, why_not_readable
from bearing_sim.files.yaml_text import values_of
from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.bundled import bundled_names, bundled_text
from bearing_sim.scene.diameters import override_by_radius
from bearing_sim.scene.errors import InvalidField, SceneError, did_you_mean
from bearing_sim.scene.fidelity import choose
from bearing_sim.scene.field_errors import invalid_fields
from bearing_sim.scene.fields import FieldFacts, declared_in, laws_with
from bearing_sim.scene.fields import blocks as all_blocks
from bearing_sim.scene.measured_tradeoffs import Setting, Tradeoffs, read_front, read_kept_tradeoffs
from bearing_sim.scene.names import NAMED_BY, consequences, expanded
from bearing_sim.scene.overrides import given_over, read_override, without_estimate
from bearing_sim.scene.quantity import SPEED, Quantity
from bearing_sim.scene.requirements import candidates, reason_of, without_measurement
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.tree import at, changed, parts, without
from bearing_sim.scene.uncertainty import flattened, nearest, quantities, value_at, written

_FILES = (("bearing", "outer_raceway", "contour_file"), ("bearing", "roller", "crown", "file"), ("front",))  # that a scene file may name
_KINDS = {type(None): "empty", list: "a list", str: "a text", int: "a number", float: "a number"}  # of what a YAML file holds
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
    with allowing_outside(allow_outside):
        return scene_from_mapping(*_given(scene, overrides))


def _given(scene: str | Path | Mapping[str, Any] | Scene, overrides: Iterable[str] | Mapping[str, Any]) -> tuple[Mapping, str]:
    """Return the tree of a scene that is given as to `load_scene`, with its overrides, and its name for messages."""
    overrides = override_texts(overrides)
    if isinstance(scene, Scene):
        return overridden(_as_mapping(scene), overrides), scene.name
    if isinstance(scene, Mapping):
        return overridden(scene, overrides), str(scene.get("name", "scene"))
    text, folder = read_named(scene, "scenes", "scene")
    return _tree(text, overrides, str(scene), folder), str(scene)


def measured_of(name: str, overrides: Iterable[str], allow_outside: bool, scene: Scene) -> Tradeoffs | None:
    """Return what was measured of a scene: by the front file that it names, also beside a level of its own, else what this machine has kept.

    Parameters
    ----------
    name, overrides, allow_outside : as of `load_scene`, which has made ``scene`` of them.

    Returns
    -------
    None where nothing is kept.

    Raises
    ------
    ValueError
        The front cannot be read.
    """
    with allowing_outside(allow_outside):
        tree, _ = _given(name, overrides)
    named = tree.get("front")
    return read_kept_tradeoffs(scene) if named is None else read_front(Path(named))


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
    return scene_from_mapping(_tree(text, overrides, origin, folder), origin)


def _tree(text: str, overrides: Iterable[str], origin: str, folder: Path | None) -> Mapping:
    """Return the tree of a scene's YAML text with overrides, see `scene_from_yaml`."""
    tree, refused = _with_files_in(yaml_mapping(text, origin, "bearing, lubricant, operating ..."), folder)
    tree = overridden(tree, overrides)
    if errors := [error for path, written, error in refused if at(tree, path) is written]:
        raise SceneError(origin, errors)
    return tree


def _with_files_in(tree: dict, folder: Path | None) -> tuple[dict, list[tuple[tuple[str, ...], str, InvalidField]]]:
    """Return a tree whose files are those in the folder of the scene file, and path, value and error of each file that is not read."""
    refused = []
    for path in _FILES:
        written = at(tree, path)
        if not isinstance(written, str) or at(tree, (*path[:-1], "contour")) is not None:
            continue  # with the text of the contour, the file is but a name
        reason = why_outside(written, folder) if folder is not None else "this scene is no file of its own, so it cannot name others"
        if reason:
            refused.append((path, written, InvalidField(".".join(path), repr(written), reason)))
        else:
            tree = changed(tree, path, str(folder / written))
    return tree, refused


def overridden(tree: Mapping, overrides: Iterable[str]) -> Mapping:
    """Return a scene's tree with overrides applied in order (see `load_scene`).

    Raises
    ------
    SceneError
        Some are none, or set a field within a value; all of them are listed.
    """
    errors = []
    for override in overrides:
        try:
            path, value = read_override(override)
            dotted, value = override_by_radius(".".join(path), value, Scene)
            path = parts(dotted)
            tree = without_estimate(given_over(_with_blocks(tree, path), path, value), path)
        except SceneError as error:
            errors += error.errors
    if errors:
        raise SceneError("--set", errors)
    return tree


def _with_blocks(tree: Mapping, path: tuple[str, ...]) -> Mapping:
    """Return a tree that has a block where an override sets a field in one: for a name, and with its law where the scene leaves it to a default."""
    if path[0] == "uncertainty":
        return tree
    for depth in range(1, len(path)):
        place = path[:depth]
        block = at(tree, place)
        if isinstance(block, str) and place in NAMED_BY:
            block = {NAMED_BY[place]: block}
        elif block is None:
            block = _default_law(tree, place, path[depth])
        if not isinstance(block, Mapping):
            raise SceneError("--set", [InvalidField(".".join(place), repr(block), f"is a value, not a block; {'.'.join(path)} cannot be set")])
        tree = changed(tree, place, block)
    return tree


def _default_law(tree: Mapping, place: tuple[str, ...], field: str) -> dict:
    """Return the law that a block has by default in its scene, as a block, if that law has the field; else an empty one."""
    known = laws_with(Scene, ".".join((*place, field)))
    if not known or field == "law":
        return {}
    try:
        law = getattr(value_at(scene_from_mapping(tree, "scene"), ".".join(place)), "law", None)
    except SceneError:  # another override may mend it
        return {}
    return {"law": law} if law in known else {}


def scene_from_mapping(tree: Mapping, origin: str = "scene") -> Scene:
    """Build a scene from nested mappings, resolving presets from the catalog.

    Raises
    ------
    SceneError
        Listing every error with its path, value and the expected value.
    """
    tree, errors = expanded(tree)
    try:
        scene = _validated(_with_level(tree, origin))
    except ValidationError as error:
        said = consequences(errors)
        found = invalid_fields(error, Scene)
        if "bearing.preset" in said:  # what depends on the bearing that stands in is no error of the file
            found = [each for each in found if each.path.partition(".")[0] not in ("", "bearing", "mounting")]
        errors += [each for each in found if not said & {each.path, f"{each.path}.{each.reason.partition(':')[0]}"}]
    if errors:
        raise SceneError(origin, errors)
    return scene


def _validated(tree: Mapping) -> Scene:
    return _reader(Scene).validate_python(tree, context=_WRITTEN)


def load_bearing(name: str) -> Bearing:
    """Return a bearing by its designation, or by its name in the catalogue.

    Raises
    ------
    SceneError
        There is no such bearing, or the table's entry has errors; all of them are listed.
    """
    tree, errors = expanded({"bearing": name})
    if not errors:
        try:
            return _reader(Bearing).validate_python(tree["bearing"], context=_WRITTEN)
        except ValidationError as error:
            errors = invalid_fields(error, Bearing)
    raise SceneError(str(name), errors)


def _with_level(tree: Mapping, origin: str) -> Mapping:
    """Return a scene's tree with ``level: auto`` resolved to the lowest level that has everything the scene asks for.

    Where it wants largest errors, it gets the fastest setting whose measured errors keep them, with all its overrides; or the most accurate level
    where nothing is known to keep them (see `bearing_sim.scene.requirements`).  What was measured is in the front file that the scene names, else in
    the cache of this machine.  The resolved tree names no front, so that a recorded scene means the same without it.

    Raises
    ------
    ValidationError
        The scene has errors, its front cannot be used, or no level has everything it asks for.
    """
    tree, named = without(tree, ("front",)), tree.get("front")
    if tree.get("level") != "auto":
        return {**tree, "front": None if isinstance(named, str) else named}
    scene = _validated({**tree, "level": _highest_level(tree), "front": named})
    found = choose(scene)
    if named is not None and not scene.wanted_errors:
        raise _refused("front", named, "nothing is wanted with an error; give wants with errors, such as wants: {slip: 0.3 %}, or leave it out")
    if found.level is not None and scene.wanted_errors:
        errors = {each.want: each.error for each in scene.wanted_errors}
        front = read_kept_tradeoffs(scene) if named is None else _front(named, origin)
        for setting in candidates(scene, errors, front):
            chosen = overridden({**tree, "level": setting.level}, setting.overrides)
            if _is_valid(chosen):
                return {**chosen, "level_reason": reason_of(setting, errors, front.at(scene), origin)}
        found = without_measurement(scene, errors, front, origin)
    if found.level is None:
        raise _refused("level", "auto", found.reason)
    return {**tree, "level": found.level, "level_reason": found.reason}


def _highest_level(tree: Mapping) -> str:
    """Return the highest level that can have what only lower levels have, as a tree names it, and all other effects."""
    backing = at(tree, ("mounting", "housing", "backing"))
    law = backing.get("law") if isinstance(backing, Mapping) else backing
    if law == "free" or at(tree, ("bearing", "cage", "guidance")) == "full_complement":
        return "slip"
    return "spatial"


def _front(named: str, origin: str) -> Tradeoffs:
    try:
        return read_front(Path(named))
    except ValueError as error:
        command = f"bearing-sim trade {shlex.quote(origin)} --front {shlex.quote(Path(named).name)}"
        raise _refused("front", Path(named).name, f"{error}; write it with: {command}, or leave it out") from None


def _refused(field: str, value: object, reason: str) -> ValidationError:
    detail = {"type": PydanticCustomError("refused", "{reason}", {"reason": reason}), "loc": (field,), "input": value}
    return ValidationError.from_exception_data("Scene", [detail])


def _is_valid(tree: Mapping) -> bool:
    """Whether a tree is a valid scene; a measured fixed step may be too long at another speed."""
    try:
        _validated(tree)
    except ValidationError:
        return False
    return True


def with_setting(scene: Scene, setting: Setting) -> Scene:
    """Return a scene at the level and with the overrides of a measured setting.

    Raises
    ------
    SceneError
        The setting is none for this scene, such as a fixed step that is too long at its speed.
    """
    return load_scene(scene, [f"level={setting.level}", "level_reason=''", *setting.overrides])


def scene_to_yaml(scene: Scene) -> str:
    """Return the whole scene as YAML in SI, rotational speeds with their unit; `scene_from_yaml` reads it back equal."""
    return fields_to_yaml(_as_mapping(scene))


def fields_to_yaml(tree: Mapping) -> str:
    """Return blocks and fields of a scene file as YAML, in their order."""
    return yaml.dump(tree, Dumper=_LineDumper, sort_keys=False, allow_unicode=True)


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
