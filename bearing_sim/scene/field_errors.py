# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The errors that pydantic finds in a tree, with paths and messages for the author of the file."""

import dataclasses
import re
from collections.abc import Iterable, Mapping

from pydantic import ValidationError

from bearing_sim.scene.errors import InvalidField, did_you_mean
from bearing_sim.scene.fields import hints_of, laws_with, records_at, records_in, tags_of
from bearing_sim.scene.internal_dimensions import CAGE_RULES
from bearing_sim.scene.scene import Scene

# What older scenes say, and what says it now.
_RENAMED = {
    "bearing.inner_raceway.supported_mass": "the shaft's mass is support.shaft.mass",
    "bearing.roller.slices_per_traction": "every slice has its own traction; leave it out",
    "lubricant.pumping": "give lubricant.rolling_resistance: hydrodynamic, or none",
    "lubricant.rolling_resistance.replenishment": "K_rs is lubricant.starvation.constant",
    "bearing.flanges.boundary_friction": "the coefficient of asperities everywhere is lubricant.mixed_friction.boundary_friction",
    "bearing.ring_growth": "bearing.dimensions_at: cold computes rotation, mounting the fits, heat the temperatures",
}
_MISSING = {"bearing.cage": f"missing; give its block, or the kind of cage, from which it is estimated: {', '.join(CAGE_RULES)}"}
_MOST_ERRORS = 50  # that are listed


def invalid_fields(error: ValidationError, record: type) -> list[InvalidField]:
    """Return the errors that pydantic found in a tree, with messages for the author of the file.

    Parameters
    ----------
    error : as raised by pydantic.
    record : the record type of the whole tree.
    """
    problems = error.errors(include_url=False)
    found = [_invalid_field(problem, record) for problem in problems[:_MOST_ERRORS]]
    if len(problems) > _MOST_ERRORS:
        found.append(InvalidField("", "", f"and {len(problems) - _MOST_ERRORS} more errors"))
    return found


def _invalid_field(problem: Mapping, record: type) -> InvalidField:
    (path, _), kind, reason, value = _place(problem["loc"], record), problem["type"], problem["msg"], problem["input"]
    shown = "" if isinstance(value, Mapping) or dataclasses.is_dataclass(value) or type(value).__name__ == "ArgsKwargs" else repr(value)
    if kind == "missing":
        return InvalidField(path, "", _MISSING.get(path, "missing"))
    if kind == "union_tag_not_found":
        given = [name for name in value if isinstance(name, str)] if isinstance(value, Mapping) else []
        laws = [block.law for block in records_at(record, path) if block.law]
        fitting = [law for law in laws if all(law in laws_with(record, f"{path}.{name}") for name in given)]
        none = next((name for name in given if not laws_with(record, f"{path}.{name}")), None)
        which = f"of the laws with {' and '.join(given)}" if given and fitting else "of the laws"
        unknown = f"; none of them has {none}" if none else ""
        return InvalidField(f"{path}.law", "", f"missing; expected one {which}: {', '.join(fitting or laws)}{unknown}")
    if kind == "union_tag_invalid":
        tag, known = problem["ctx"]["tag"], problem["ctx"]["expected_tags"]
        return InvalidField(f"{path}.law", repr(tag), f"expected one of {known}{did_you_mean(str(tag), re.findall(r'[a-z_0-9]+', known))}")
    if kind == "unexpected_keyword_argument":
        return InvalidField(path, shown, _why_unexpected(path, problem["loc"], record))
    return InvalidField(path, shown, re.sub(r"^(Value error, |Input should be )", lambda m: "" if m[1].startswith("Value") else "expected ", reason))


def _why_unexpected(path: str, loc: tuple, record: type) -> str:
    if path in _RENAMED:
        return f"no longer a field; {_RENAMED[path]}"
    block, _, name = path.rpartition(".")
    if others := laws_with(record, path):
        return f"no field of this law; set {block}.law to {' or '.join(others)}, which {'has' if len(others) == 1 else 'have'} it"
    known = [field.name for kind in _place(loc[:-1], record)[1] for field in dataclasses.fields(kind)]
    more = f"; see: bearing-sim fields {block}".rstrip() if record is Scene else ""
    return f"unknown field{did_you_mean(name, known)}; known here: {', '.join(known)}{more}"


def _place(loc: Iterable[str | int], record: type) -> tuple[str, list[type]]:
    """Return the dotted path that the file has for a place in pydantic's words, and the record types there."""
    records, parts = [record], []
    for part in loc:
        if len(records) > 1:  # pydantic's next word is the law that selects one of them, which the file has inside the block
            records = [each for each in records if part in tags_of(each)]
            continue
        parts.append(str(part))
        if not isinstance(part, int):
            records = [each for kind in records[:1] for each in records_in(hints_of(kind).get(part))]
    return ".".join(parts), records
