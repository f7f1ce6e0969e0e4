# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Files that come with the package: scenes, entries of the catalogue, and its tables (``catalog/tables``, ``catalog/designations``)."""

import csv
from functools import cache
from pathlib import Path

_FOLDER = Path(__file__).resolve().parent


def bundled_names(folder: str) -> list[str]:
    """Return the names of the YAML files of a folder, such as ``scenes`` or ``catalog/oils``."""
    return sorted(path.stem for path in (_FOLDER / folder).glob("*.yaml"))


def bundled_text(folder: str, name: str) -> str:
    """Return the text of a YAML file by the name of its folder and its own."""
    return (_FOLDER / folder / f"{name}.yaml").read_text(encoding="utf-8")


@cache
def catalog_table(name: str) -> tuple[dict[str, str], ...]:
    """Return the rows of a CSV table of the catalogue, such as ``tables/iso_286``; lines that begin with ``#`` are comments."""
    with (_FOLDER / "catalog" / f"{name}.csv").open(encoding="utf-8", newline="") as lines:
        return tuple(csv.DictReader(line for line in lines if not line.startswith("#")))
