# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Trees of nested mappings, as scene files are before their records are made."""

from collections.abc import Mapping


def at(tree, path: str):
    """Return what a tree has at a dotted path; None if there is nothing, or no mapping on the way."""
    for name in path.split("."):
        tree = tree.get(name) if isinstance(tree, Mapping) else None
    return tree
