# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Trees of nested mappings, as scene files are before their records are made; nothing here changes one in place.

A path is a tuple of names.  People write it with dots, as in ``bearing.roller.length``; `parts` splits that.
"""

from collections.abc import Iterator, Mapping
from functools import lru_cache

Path = tuple[str, ...]
"""Names of the blocks around a field, and its own."""


@lru_cache(maxsize=4096)
def parts(dotted: str) -> Path:
    """Return the path that somebody writes with dots."""
    return tuple(dotted.split("."))


def at(tree, path: Path):
    """Return what a tree has at a path; None if there is nothing, or no mapping on the way."""
    for name in path:
        tree = tree.get(name) if isinstance(tree, Mapping) else None
    return tree


def changed(tree, path: Path, value):
    """Return a tree with a value at a path; what is no mapping on the way there becomes one."""
    if not path:
        return value
    name, *rest = path
    block = tree if isinstance(tree, Mapping) else {}
    return {**block, name: changed(block.get(name), rest, value)}


def without(tree, path: Path):
    """Return a tree without what it has at a path."""
    name, *rest = path
    if not isinstance(tree, Mapping) or name not in tree:
        return tree
    return {**tree, name: without(tree[name], rest)} if rest else {key: value for key, value in tree.items() if key != name}


def leaves(tree: Mapping, beside: Mapping | None = None, path: Path = ()) -> Iterator[tuple[Path, object]]:
    """Yield path and value of all that is no mapping in a tree; with ``beside``, also mappings where that tree has none."""
    for name, value in tree.items():
        other = None if beside is None else beside.get(name)
        if isinstance(value, Mapping) and (beside is None or isinstance(other, Mapping)):
            yield from leaves(value, other, (*path, str(name)))
        else:
            yield (*path, str(name)), value
