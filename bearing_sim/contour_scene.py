# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The outer raceway's contour in a scene's tree of mappings: which form counts, and where its file is read."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from bearing_sim.contour import UNREAD
from bearing_sim.scene_raceway import FORM_FIELDS

__all__ = ["UNREAD", "anchor_contour", "drop_other_forms", "with_contour_text"]
_POINT_FORMS = (("contour", "contour_file"), ("low_points", "high_points"))
_LARGEST_FILE = 4_000_000  # bytes


def drop_other_forms(raceway: dict, given: Iterable[str]) -> None:
    """Remove from a raceway's block what describes another form than the fields ``given`` over it: points say all of a contour."""
    for form in _POINT_FORMS:
        if any(name in form for name in given):
            kept = set(form) if form[0] == "low_points" else set(given)  # lows and highs come one after the other, a file brings its text
            for name in FORM_FIELDS:
                if name not in kept:
                    raceway.pop(name, None)


def _raceway(tree: Mapping):
    bearing = tree.get("bearing")
    raceway = bearing.get("outer_raceway") if isinstance(bearing, Mapping) else None
    return raceway if isinstance(raceway, Mapping) else {}


def anchor_contour(tree: Mapping, folder: Path) -> None:
    """Make a contour file that a scene file names relative to that file's folder."""
    raceway = _raceway(tree)
    if isinstance(raceway.get("contour_file"), str) and raceway.get("contour") is None:
        raceway["contour_file"] = str(folder / raceway["contour_file"])


def with_contour_text(tree: Mapping) -> tuple[dict, tuple[str, str] | None]:
    """Return the tree with the text of its contour file in it, and value and reason of the fault where it cannot be read.

    Of the file's path only the name is kept: a recording should not tell of the machine that it was made on.
    """
    tree, raceway = dict(tree), dict(_raceway(tree))
    path = raceway.get("contour_file")
    if not isinstance(path, str) or raceway.get("contour") is not None:
        return tree, None
    try:
        if Path(path).stat().st_size > _LARGEST_FILE:
            return tree, (repr(path), f"larger than {_LARGEST_FILE / 1e6:g} MB: no contour of one turn")
        raceway["contour"] = Path(path).read_text()
    except OSError as fault:
        return tree, (repr(path), (fault.strerror or "cannot be read").lower())
    except (UnicodeDecodeError, ValueError):
        return tree, (repr(path), "is no text")
    raceway["contour_file"] = Path(path).name
    tree["bearing"] = {**tree["bearing"], "outer_raceway": raceway}
    return tree, None
