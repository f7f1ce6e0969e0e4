# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tidy tables on disk: one row a point, Parquet and CSV, a unit and a meaning to each column."""

import csv
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import pyarrow
import pyarrow.parquet

from bearing_sim.sweep.point import Column

_ABOUT = b"bearing_sim"


class Table(NamedTuple):
    """Rows of a study.

    Attributes
    ----------
    columns : by their names, in order.
    rows : one a point; the names of all columns in each.
    about : what the table is of and what made it; texts, numbers, lists and mappings of these.
    """

    columns: tuple[Column, ...]
    rows: list[dict]
    about: dict

    def column(self, name: str) -> Column:
        """Return the column of that name."""
        return next(column for column in self.columns if column.name == name)

    def values(self, name: str) -> list:
        """Return a column's values."""
        return [row[name] for row in self.rows]


def write_table(path: Path, table: Table) -> tuple[Path, Path]:
    """Write a table as Parquet and, beside it, as CSV; a reader finds the old files or the new ones, never a part.

    Units and meanings are in the metadata of Parquet's fields, what the table is of in that of its schema, as JSON under
    ``bearing_sim``.  In CSV a unit stands in brackets behind its column's name.

    Parameters
    ----------
    path : of either; the ending is replaced.
    table : what to write.

    Returns
    -------
    paths of the Parquet and of the CSV file.
    """
    parquet, text = path.with_suffix(".parquet"), path.with_suffix(".csv")
    path.parent.mkdir(parents=True, exist_ok=True)
    _replace(parquet, lambda part: pyarrow.parquet.write_table(_arrow(table), part))

    def write_csv(part):
        with open(part, "w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow([headed(column) for column in table.columns])
            writer.writerows([row[column.name] for column in table.columns] for row in table.rows)

    _replace(text, write_csv)
    return parquet, text


def headed(column: Column) -> str:
    """Return a column's name and unit as a heading."""
    return f"{column.name} [{column.unit}]" if column.unit else column.name


def _replace(path, write) -> None:
    part = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        write(part)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _arrow(table) -> pyarrow.Table:
    arrays = [pyarrow.array(table.values(column.name)) for column in table.columns]
    fields = [
        pyarrow.field(column.name, array.type, metadata={"unit": column.unit, "meaning": column.meaning})
        for column, array in zip(table.columns, arrays)
    ]
    return pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, metadata={_ABOUT: json.dumps(table.about)}))


def read_table(path: Path) -> Table:
    """Return a table from its Parquet file.

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        It is no table that this program wrote.
    """
    try:
        found = pyarrow.parquet.read_table(path)
    except pyarrow.ArrowInvalid as fault:
        raise ValueError(f"{path}: not readable as Parquet: {fault}") from None
    about = (found.schema.metadata or {}).get(_ABOUT)
    if about is None:
        raise ValueError(f"{path}: a Parquet file, but no table of bearing-sim")
    notes: list[Mapping] = [field.metadata or {} for field in found.schema]
    columns = [Column(field.name, note.get(b"unit", b"").decode(), note.get(b"meaning", b"").decode()) for field, note in zip(found.schema, notes)]
    return Table(tuple(columns), found.to_pylist(), json.loads(about))


def select(rows: Sequence[dict], **wanted) -> list[dict]:
    """Return the rows whose columns have the wanted values; numbers to 9 digits."""

    def same(value, other):
        return abs(value - other) <= 1e-9 * abs(other) if isinstance(other, float) else value == other

    return [row for row in rows if all(same(row[name], value) for name, value in wanted.items())]
