# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Measured tables as Parquet: a file, or the folder of a data set; their rows as cells of text, as those of a CSV table.

A mapping (`bearing_sim.inputs.csv_import`) is then the same for both formats, and so are the errors of single cells.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from bearing_sim.files.extras import what_is_missing
from bearing_sim.files.limits import TABLE_BYTES, TABLE_FILE, TABLE_ROWS, FileError
from bearing_sim.files.reading import open_regular
from bearing_sim.inputs.csv_text import Layout, Marks, TableError
from bearing_sim.scene.errors import did_you_mean, shortened

_MAGIC = b"PAR1"
_CHUNK = 1 << 20  # byte
_SHOWN = 500  # characters in a message


def is_parquet(path: Path) -> bool:
    """Return whether a path is a Parquet file, or a folder that holds some, at whatever depth."""
    if path.is_dir():
        return next(path.rglob("*.parquet"), None) is not None
    try:
        with open_regular(path) as stream:
            return stream.read(len(_MAGIC)) == _MAGIC
    except (FileError, OSError):
        return False


def parquet_layout(path: Path, wanted: Sequence[tuple[str, str]], marks: Marks) -> Layout:
    """Return the layout of a Parquet table, whose names are its columns.

    Parameters
    ----------
    path : a file, or the folder of a data set; folders such as ``turbine=T01`` are a column.
    wanted : (place in the mapping, name) of each column that is needed.
    marks : how numbers are written that are text.

    Raises
    ------
    TableError
        It cannot be read, or columns are missing; all of them are named.
    """
    names = _dataset(path).schema.names
    errors = [f"  {where}: no column {name!r}{did_you_mean(name, names)}" for where, name in wanted if name not in names]
    if errors:
        raise TableError("\n".join([f"{path}: the table has {', '.join(names) or 'no columns'}", *errors]))
    return Layout(path, "parquet", marks=marks, names=tuple(dict.fromkeys(name for _, name in wanted)))


def parquet_records(path: Path, layout: Layout, only: Mapping[str, str], time: str, takes_timestamps: bool) -> Iterator[tuple[int, list[str]]]:
    """Yield (number of the row among those that are read, cells) of a Parquet table; a missing value is an empty cell.

    The rows of a data set of several files are put in order of time, because its files have none.

    Parameters
    ----------
    path, layout : see `parquet_layout`.
    only : column: text that its cell must have; other rows are not read.
    time : column of times.
    takes_timestamps : whether times are read as ISO 8601, as those of a column of timestamps are written.

    Raises
    ------
    TableError
        The table cannot be read, or its times are of a type that the mapping does not expect.
    """
    import pyarrow

    dataset = _dataset(path)
    is_timestamp = pyarrow.types.is_timestamp(dataset.schema.field(time).type)
    if is_timestamp and not takes_timestamps:
        raise TableError(f"{path}: column {time} holds timestamps; expected time.format: iso in the mapping, and no time.unit or time_of_day")
    table = _read(path, dataset, list(layout.names), _filter(dataset.schema, only))
    is_number = pyarrow.types.is_integer(table.schema.field(time).type) or pyarrow.types.is_floating(table.schema.field(time).type)
    if len(dataset.files) > 1 and (is_timestamp or is_number):
        table = table.sort_by(time)
    columns = [_texts(table.column(name), layout.marks.decimal) for name in layout.names]
    for place, name in enumerate(layout.names):
        if name in only:  # as the mapping writes it, such as 3 for 3.0
            columns[place] = [only[name]] * len(table)
    yield from enumerate(map(list, zip(*columns)), 1)


def rows_of(path: Path) -> list[dict[str, str]]:
    """Return all rows of a small table as texts by column.

    Raises
    ------
    TableError
        It cannot be read.
    """
    dataset = _dataset(path)
    names = dataset.schema.names
    table = _read(path, dataset, names, None)
    return [dict(zip(names, row)) for row in zip(*(_texts(table.column(name), ".") for name in names))]


def values_of(path: Path, column: str) -> list[str]:
    """Return the different texts of a column in order, without empty ones.

    Raises
    ------
    TableError
        See `parquet_layout`.
    """
    layout = parquet_layout(path, [("--by", column)], Marks())
    return sorted({text for text in _texts(_read(path, _dataset(path), list(layout.names), None).column(column), ".") if text.strip()})


def files_of(path: Path, only: Mapping[str, str]) -> list[Path]:
    """Return the files of a Parquet table that may hold rows with these texts in their columns, in order."""
    dataset = _dataset(path)
    return sorted({Path(fragment.path) for fragment in dataset.get_fragments(_filter(dataset.schema, only))})


def checksum(files: Sequence[Path]) -> str:
    """Return the SHA-256 of the contents of files, one after the other.

    Raises
    ------
    OSError
        One cannot be read.
    """
    digest = hashlib.sha256()
    for file in files:
        with open(file, "rb") as stream:
            while piece := stream.read(_CHUNK):
                digest.update(piece)
    return digest.hexdigest()


def _dataset(path: Path):
    try:
        import pyarrow
        import pyarrow.dataset
    except ModuleNotFoundError as error:
        raise TableError(f"{path}: {what_is_missing(error)}") from None
    try:
        files = sorted(map(str, path.rglob("*.parquet"))) if path.is_dir() else [str(path)]
        for file in files:
            open_regular(file, TABLE_FILE).close()
        files = files if path.is_dir() else files[0]
        return pyarrow.dataset.dataset(files, format="parquet", partitioning=pyarrow.dataset.partitioning(flavor="hive"))
    except (pyarrow.ArrowException, OSError) as error:
        raise TableError(f"{path}: cannot be read as Parquet: {_reason(error)}") from None


def _read(path: Path, dataset, columns: Sequence[str], condition):
    """Return columns of a data set, those rows that meet a condition, or all if it is None."""
    import pyarrow

    try:
        TABLE_ROWS.check(dataset.count_rows(filter=condition), str(path))
        table = dataset.to_table(columns=columns, filter=condition)
    except MemoryError:
        raise TableError(f"{path}: its columns {shortened(', '.join(columns), _SHOWN)} do not fit into the memory of this machine") from None
    except (pyarrow.ArrowException, OSError) as error:
        raise TableError(f"{path}: cannot be read as Parquet: {_reason(error)}") from None
    TABLE_BYTES.check(table.nbytes, str(path))
    return table


def _reason(error: Exception) -> str:
    """Return why Parquet cannot be read, on one line."""
    return shortened(" ".join(str(error).split()), _SHOWN)


def _filter(schema, only: Mapping[str, str]):
    """Return the filter of a data set for rows with these texts, or None for all rows."""
    import pyarrow
    import pyarrow.dataset

    condition = None
    for name, text in only.items():
        try:
            value = pyarrow.scalar(text).cast(schema.field(name).type)
        except pyarrow.ArrowException as error:
            raise TableError(f"only: {name} = {text!r}: not a value of a column of type {schema.field(name).type} ({error})") from None
        one = pyarrow.dataset.field(name) == value
        condition = one if condition is None else condition & one
    return condition


def _texts(column, decimal: str) -> list[str]:
    """Return the values of a column as texts that a CSV table would have."""
    import pyarrow

    kind = column.type
    if pyarrow.types.is_timestamp(kind):
        # to microseconds, which is as fine as Python's own times are
        column = column.cast(pyarrow.timestamp("us", kind.tz), safe=False)
        return ["" if value is None else value.isoformat() for value in column.to_pylist()]
    if pyarrow.types.is_floating(kind):
        return ["" if value is None or value != value else repr(value).replace(".", decimal) for value in column.to_pylist()]
    return ["" if value is None else str(value) for value in column.to_pylist()]
