# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oils and greases by name: what a scene's block ``lubricant`` says in names becomes blocks of `bearing_sim.scene.lubricant`.

An oil is a viscosity class (``ISO VG 68``, ``ISO VG 68 PAO``) or an entry of the catalogue (``MIL-PRF-23699``), a grease an entry of the
catalogue (``lithium NLGI 2``, ``SKF LGMT 2``).  Capitals, blanks and punctuation do not matter.  ``{preset: NAME, ...}`` changes single fields.
"""

import difflib
import re
from collections.abc import Callable, Iterable, Mapping

from bearing_sim.scene.viscosity_index import ISO_VISCOSITY_CLASSES

_BASE_WORDS = {"mineral": "mineral", "pao": "pao", "ester": "ester", "pag": "pag", "pg": "pag", "polyglycol": "pag"}
_CLASS_NAME = re.compile(r"^(?:iso)?[\s_-]*vg[\s_-]*(\d+)[\s_-]*([a-z]*)$", re.IGNORECASE)
_CLASS_SOURCE = "viscosity class of ISO 3448; what the class does not say follows from the kind of base oil, see the theory of oil"
# Other names of the catalogue's oils, without blanks and punctuation, and words that a grease's name may have or not.
_ALIASES = {"milprf7808": "mil_l_7808", "milprf23699": "mil_l_23699"}
_OPTIONAL_WORDS = {"grease", "mineral", "oil", "nlgi", "skf", "mobil", "and", "soap"}
_SAME_WORDS = {"sulphonate": "sulfonate", "urea": "polyurea", "diurea": "polyurea", "aluminum": "aluminium", "li": "lithium"}
_VISCOSITIES = ("viscosity_100", "viscosity_index")
Error = tuple[str, str, str]
"""Path, value and reason."""


def with_named_lubricants(lubricant: Mapping, names: Callable[[str], list[str]], read: Callable[[str, str], dict]) -> tuple[dict, list[Error]]:
    """Return a block ``lubricant`` whose oil and grease are blocks, and the errors in their names.

    An oil whose name is unknown is replaced by some oil, so that the rest of the block can be checked.

    Parameters
    ----------
    lubricant : as a user writes it.
    names : returns the names of a kind of catalogue entries, ``oils`` or ``greases``.
    read : returns an entry by its kind and name.
    """
    block, errors = dict(lubricant), []
    if block.get("grease") is not None:
        errors += _resolve_grease(block, names, read)
    if "oil" in block:
        block["oil"], found = _oil_block(block["oil"], "lubricant.oil", names, read)
        errors += found
    return block, errors


def keep_one_lubricant(lubricant: dict, given: str, value: object) -> None:
    """Remove from a block ``lubricant`` what an override of its oil, its grease or its supply makes void, in place.

    Parameters
    ----------
    lubricant : with the override applied.
    given : name of the field that was given, ``oil``, ``grease`` or ``supply``.
    value : that it was given.
    """
    supply = lubricant.get("supply")
    law = supply.get("law") if isinstance(supply, Mapping) else supply
    if given == "oil":
        lubricant.pop("grease", None)
        if law == "grease":
            lubricant.pop("supply")
    elif given == "grease" and value is not None:
        if isinstance(value, str) or isinstance(value, Mapping) and {"preset", "base_oil"} & set(value):
            lubricant.pop("oil", None)
        if law != "grease":
            lubricant.pop("supply", None)
    elif given == "supply" and law != "grease":
        lubricant.pop("grease", None)


def class_block(name: str) -> tuple[dict | None, str]:
    """Return the block of an oil such as ``ISO VG 68`` or ``iso_vg_68_pao``, and the reason why there is none.

    Neither block nor reason: the name does not speak of a viscosity class.

    Parameters
    ----------
    name : as a user writes it.
    """
    found = _CLASS_NAME.match(name.strip())
    if found is None:
        return None, ""
    number, word = int(found[1]), found[2].casefold()
    if number not in ISO_VISCOSITY_CLASSES:
        nearest = min(ISO_VISCOSITY_CLASSES, key=lambda each: abs(each - number))
        return None, f"ISO 3448 has no class {number}; the nearest is ISO VG {nearest}; all: {', '.join(map(str, ISO_VISCOSITY_CLASSES))}"
    if word and word not in _BASE_WORDS:
        return None, f"unknown kind of base oil {found[2]!r}{nearest_word(word, _BASE_WORDS)}; known: mineral, PAO, ester, PAG"
    base = _BASE_WORDS.get(word, "mineral")
    label = f"ISO VG {number}" if base == "mineral" else f"ISO VG {number} {'ester' if base == 'ester' else base.upper()}"
    return {"law": "custom", "name": label, "source": _CLASS_SOURCE, "base": base, "viscosity_40": f"{ISO_VISCOSITY_CLASSES[number]} mm^2/s"}, ""


def nearest_word(word: str, known: Iterable[str]) -> str:
    """Return ``" (did you mean ...?)"`` for the nearest known word, whatever its capitals, or an empty text."""
    by_fold = {each.casefold(): each for each in known}
    close = difflib.get_close_matches(word.casefold(), list(by_fold), n=1)
    return f" (did you mean {by_fold[close[0]]!r}?)" if close else ""


def _oil_block(given: object, path: str, names, read) -> tuple[dict, list[Error]]:
    """Return the block of an oil that is named, or that has a preset, or that is a block already."""
    if not isinstance(given, str | Mapping):
        return _some_oil(names, read), [(path, repr(given), "expected the name of an oil, such as 'ISO VG 68', or a block")]
    if isinstance(given, str):
        preset, reason = _named_oil(given, names, read)
        return preset, [(path, repr(given), reason)] if reason else []
    if "preset" in given:
        name, rest = given["preset"], {key: value for key, value in given.items() if key != "preset"}
        preset, reason = _named_oil(name, names, read) if isinstance(name, str) else (_some_oil(names, read), "expected the name of an oil")
        if set(_VISCOSITIES) & set(rest):
            preset = {key: value for key, value in preset.items() if key not in _VISCOSITIES}
        return {**preset, **rest}, [(f"{path}.preset", repr(name), reason)] if reason else []
    if "law" in given:
        return dict(given), []
    return {"law": "custom" if {"viscosity_40", "viscosity_index", "base"} & set(given) and "viscosity" not in given else "fitted", **given}, []


def _named_oil(name: str, names, read) -> tuple[dict, str]:
    """Return the block of a named oil and an empty text, or some oil and the reason why there is none of that name."""
    block, reason = class_block(name)
    if block is not None or reason:
        return block or _some_oil(names, read), reason
    known = names("oils")
    if name.strip() == "custom":
        return _some_oil(names, read), "expected a block: law: custom, viscosity_40, viscosity_100 or viscosity_index, and what its data sheet says"
    key = _key(name)
    entry = next((each for each in known if _key(each) == _key(_ALIASES.get(key, key))), None)
    if entry is not None:
        return {"law": "fitted", **read("oils", entry)}, ""
    written = [*known, *(f"ISO VG {number}" for number in ISO_VISCOSITY_CLASSES), "MIL-PRF-7808", "MIL-PRF-23699", "DEF STAN 91-101"]
    reason = (
        f"not in the catalog{nearest_word(name, written)}; known: ISO VG 2 to 3200, alone or with mineral, PAO, ester or PAG behind it; "
        f"MIL-PRF-7808, MIL-PRF-23699, DEF STAN 91-101; {', '.join(known)}; or a block with viscosity_40 and what its data sheet says"
    )
    return _some_oil(names, read), reason


def _some_oil(names, read) -> dict:
    return {"law": "fitted", **read("oils", names("oils")[0])}


def _key(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.casefold())


def _words(name: str) -> frozenset[str]:
    """Return the words of a grease's name that tell it from others."""
    found = re.findall(r"[a-z]+|\d+(?:\.\d+)?", name.casefold().replace("_", " "))
    return frozenset(_SAME_WORDS.get(word, word) for word in found) - _OPTIONAL_WORDS


def _resolve_grease(block: dict, names, read) -> list[Error]:
    """Replace a block's grease by its record's fields, and put its base oil where the block's oil stands, in place."""
    given, errors = block["grease"], []
    if not isinstance(given, str | Mapping):
        errors.append(("lubricant.grease", repr(given), "expected the name of a grease, such as 'lithium NLGI 2', or a block"))
        del block["grease"]
        block.setdefault("oil", _some_oil(names, read))
        return errors
    path = "lubricant.grease" if isinstance(given, str) else "lubricant.grease.preset"
    fields = {"preset": given} if isinstance(given, str) else dict(given)
    if "preset" in fields:
        name, known = fields.pop("preset"), names("greases")
        entry = next((each for each in known if isinstance(name, str) and _words(each) == _words(name)), None)
        if entry is None:
            told = nearest_word(name, [each.replace("_", " ") for each in known]) if isinstance(name, str) else ""
            hint = "or a block with thickener, nlgi and base_oil"
            errors.append((path, repr(name), f"not a known grease{told}; known: {', '.join(known)}; {hint}"))
            block.setdefault("oil", _some_oil(names, read))
        else:
            preset = read("greases", entry)
            if "oil" in block or "base_oil" in fields:
                preset.pop("base_oil", None)
            fields = {**preset, **fields}
    base_oil = fields.pop("base_oil", None)
    if base_oil is not None and "oil" in block:
        errors.append(("lubricant.grease.base_oil", "", "lubricant.oil is the grease's base oil; give one of them"))
    elif base_oil is not None:
        block["oil"] = base_oil
    if "oil" not in block:
        errors.append(("lubricant.oil", "", "missing; give the base oil of the grease, such as oil: ISO VG 100"))
        block["oil"] = _some_oil(names, read)
    block["grease"] = fields
    return errors
