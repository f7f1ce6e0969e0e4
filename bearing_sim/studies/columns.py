# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The columns of the tables of studies, from ``columns.csv``; those of a sweep are in `bearing_sim.sweep.point`."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from bearing_sim.sweep.point import Column

with open(Path(__file__).with_name("columns.csv"), encoding="utf-8", newline="") as _file:
    TABLES: Sequence[Mapping[str, str]] = list(csv.DictReader(_file))
"""The columns of all tables: ``table``, ``name``, ``unit``, ``kind`` and ``meaning`` of each."""


def columns_of(table: str) -> tuple[Column, ...]:
    """Return the columns of a table of `TABLES`."""
    return tuple(Column(each["name"], each["unit"], each["meaning"]) for each in TABLES if each["table"] == table)
