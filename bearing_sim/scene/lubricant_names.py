# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oils and greases by name: what a scene's block ``lubricant`` says in names becomes blocks of `bearing_sim.scene.lubricant`.

An oil is a viscosity class (``ISO VG 68``, ``ISO VG 68 PAO``) or an entry of the catalogue (``MIL-PRF-23699``), a grease an entry of the
catalogue (``lithium NLGI 2``, ``SKF LGMT 2``).  Capitals, blanks and punctuation do not matter.  ``{preset: NAME, ...}`` changes single fields.
"""

import re
from collections.abc import Mapping

from bearing_sim.files.yaml_text import values_of
from bearing_sim.scene.bundled import bundled_names, bundled_text
from bearing_sim.scene.errors import InvalidField, did_you_mean
from bearing_sim.scene.viscosity_index import ISO_VISCOSITY_CLASSES

_BASE_WORDS = {"mineral": "mineral", "pao": "pao", "ester": "ester", "pag": "pag", "pg": "pag", "polyglycol": "pag"}
_CLASS_NAME = re.compile(r"^(?:iso)?[\s_-]*vg[\s_-]*(\d+)[\s_-]*([a-z]*)$", re.IGNORECASE)
_CLASS_SOURCE = "viscosity class of ISO 3448; what the class does not say follows from the kind of base oil, see the theory of oil"
# Other names of the catalogue's oils, without blanks and punctuation, and words that a grease's name may have or not.
_ALIASES = {"milprf7808": "mil_l_7808", "milprf23699": "mil_l_23699"}
_OPTIONAL_WORDS = {"grease", "mineral", "oil", "nlgi", "skf", "mobil", "and", "soap"}
_SAME_WORDS = {"sulphonate": "sulfonate", "urea": "polyurea", "diurea": "polyurea", "aluminum": "aluminium", "li": "lithium"}
_VISCOSITIES = ("viscosity_100", "viscosity_index")


def with_named_lubricants(lubricant: Mapping, path: str) -> tuple[dict, list[InvalidField]]:
    """Return a block ``lubricant`` whose oil and grease are blocks, and the errors in their names.

    An oil whose name is unknown is replaced by some oil, so that the rest of the block can be checked.

    Parameters
    ----------
    lubricant : as a user writes it.
    path : of the block.
    """
    block, errors = dict(lubricant), []
    if block.get("grease") is not None:
        block, errors = _with_grease(block, f"{path}.grease")
    if "oil" in block:
        block["oil"], found = _oil_block(block["oil"], f"{path}.oil")
        errors += found
    return block, errors


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
        return None, f"unknown kind of base oil {found[2]!r}{did_you_mean(word, _BASE_WORDS)}; known: mineral, PAO, ester, PAG"
    base = _BASE_WORDS.get(word, "mineral")
    label = f"ISO VG {number}" if base == "mineral" else f"ISO VG {number} {'ester' if base == 'ester' else base.upper()}"
    return {"law": "custom", "name": label, "source": _CLASS_SOURCE, "base": base, "viscosity_40": f"{ISO_VISCOSITY_CLASSES[number]} mm^2/s"}, ""


def _oil_block(given: object, path: str) -> tuple[dict, list[InvalidField]]:
    """Return the block of an oil that is named, or that has a preset, or that is a block already."""
    if isinstance(given, Mapping) and "preset" not in given:
        by_sheet = {"viscosity_40", "viscosity_index", "base"} & set(given) and "viscosity" not in given
        return {"law": "custom" if by_sheet else "fitted", **given}, []
    is_block = isinstance(given, Mapping)
    name, rest = (given["preset"], {key: value for key, value in given.items() if key != "preset"}) if is_block else (given, {})
    if isinstance(name, str):
        preset, reason = _named_oil(name)
    else:
        preset, reason = _some_oil(), "expected the name of an oil" if is_block else "expected the name of an oil, such as 'ISO VG 68', or a block"
    if set(_VISCOSITIES) & set(rest):
        preset = {key: value for key, value in preset.items() if key not in _VISCOSITIES}
    return {**preset, **rest}, [InvalidField(f"{path}.preset" if is_block else path, repr(name), reason)] if reason else []


def _named_oil(name: str) -> tuple[dict, str]:
    """Return the block of a named oil and an empty text, or some oil and the reason why there is none of that name."""
    block, reason = class_block(name)
    if block is not None or reason:
        return block or _some_oil(), reason
    known = bundled_names("catalog/oils")
    if name.strip() == "custom":
        return _some_oil(), "expected a block: law: custom, viscosity_40, viscosity_100 or viscosity_index, and what its data sheet says"
    key = _key(name)
    entry = next((each for each in known if _key(each) == _key(_ALIASES.get(key, key))), None)
    if entry is not None:
        return _entry(entry), ""
    written = [*known, *(f"ISO VG {number}" for number in ISO_VISCOSITY_CLASSES), "MIL-PRF-7808", "MIL-PRF-23699", "DEF STAN 91-101"]
    reason = (
        f"not in the catalog{did_you_mean(name, written)}; known: ISO VG 2 to 3200, alone or with mineral, PAO, ester or PAG behind it; "
        f"MIL-PRF-7808, MIL-PRF-23699, DEF STAN 91-101; {', '.join(known)}; or a block with viscosity_40 and what its data sheet says"
    )
    return _some_oil(), reason


def _entry(oil: str) -> dict:
    return {"law": "fitted", **values_of(bundled_text("catalog/oils", oil))}


def _some_oil() -> dict:
    return _entry(bundled_names("catalog/oils")[0])


def _key(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.casefold())


def _words(name: str) -> frozenset[str]:
    """Return the words of a grease's name that tell it from others."""
    found = re.findall(r"[a-z]+|\d+(?:\.\d+)?", name.casefold().replace("_", " "))
    return frozenset(_SAME_WORDS.get(word, word) for word in found) - _OPTIONAL_WORDS


def _with_grease(lubricant: Mapping, path: str) -> tuple[dict, list[InvalidField]]:
    """Return a block ``lubricant`` with the fields of its grease's record, and with the grease's base oil as its oil; and the errors."""
    given, errors, block = lubricant["grease"], [], {name: value for name, value in lubricant.items() if name != "grease"}
    if not isinstance(given, str | Mapping):
        error = InvalidField(path, repr(given), "expected the name of a grease, such as 'lithium NLGI 2', or a block")
        return {"oil": _some_oil(), **block}, [error]
    fields = {"preset": given} if isinstance(given, str) else dict(given)
    if "preset" in fields:
        name, known = fields.pop("preset"), bundled_names("catalog/greases")
        entry = next((each for each in known if isinstance(name, str) and _words(each) == _words(name)), None)
        if entry is None:
            near = did_you_mean(name, [each.replace("_", " ") for each in known]) if isinstance(name, str) else ""
            reason = f"not a known grease{near}; known: {', '.join(known)}; or a block with thickener, nlgi and base_oil"
            errors.append(InvalidField(path if isinstance(given, str) else f"{path}.preset", repr(name), reason))
            block.setdefault("oil", _some_oil())
        else:
            preset = values_of(bundled_text("catalog/greases", entry))
            if "oil" in block:
                preset.pop("base_oil", None)
            fields = {**preset, **fields}
    base_oil = fields.pop("base_oil", None)
    if base_oil is not None and "oil" in block:
        errors.append(InvalidField(f"{path}.base_oil", "", "lubricant.oil is the grease's base oil; give one of them"))
    elif base_oil is not None:
        block["oil"] = base_oil
    if "oil" not in block:
        errors.append(InvalidField("lubricant.oil", "", "missing; give the base oil of the grease, such as oil: ISO VG 100"))
        block["oil"] = _some_oil()
    return {**block, "grease": fields}, errors
