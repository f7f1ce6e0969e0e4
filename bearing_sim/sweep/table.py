# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables of results, one row per point, as Parquet and CSV with units and meanings of the columns."""

import collections
import csv
import hashlib
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from bearing_sim.files.limits import RESULT_CELLS, RESULT_ROWS, RESULT_TEXT
from bearing_sim.files.outputs import FORCE, Output, RefusedOutput, replaced
from bearing_sim.files.reading import NO_FILE, read_text, why_not_readable
from bearing_sim.scene.quantity import conversion
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities
from bearing_sim.sweep.point import OTHER_STATE, RESULTS, Column
from bearing_sim.sweep.tasks import Journal

if TYPE_CHECKING:
    import pandas
    import xarray

_LONGEST_REASON = 300  # characters
_ABOUT = b"bearing_sim"
_CSV = b"bearing_sim_csv_sha256"
_POINTS = "csv_sha256"
_HEADED = re.compile(r"(.*?)(?: \[(.*)\])?")
_RESULTS = {each.name: each for each in (*RESULTS, *OTHER_STATE)}


class Table(NamedTuple):
    """Rows of a study.

    Attributes
    ----------
    columns : in order.
    rows : one per point, each with the names of all columns.
    about : contents and origin of the table; any value that JSON can hold.
    """

    columns: tuple[Column, ...]
    rows: list[dict[str, Any]]
    about: dict[str, Any]

    def __repr__(self) -> str:
        axes = [f"{axis['field']}{f' [{unit}]' if (unit := axis.get('unit')) else ''} x {len(axis['values'])}" for axis in self._varied]
        counts = collections.Counter(row["status"] for row in self.rows if "status" in row)
        found = ", ".join(f"{count} {status}" for status, count in counts.items())
        title = f"{self.about.get('kind', 'table')} of {self.about.get('scene', 'a scene')}: {len(self.rows)} points{f' ({found})' if found else ''}"
        return "\n".join([title, *(f"  over {each}" for each in axes), f"  {len(self.columns)} columns, see to_pandas()"])

    @property
    def _varied(self) -> list[dict]:
        return self.about.get("axes") or self.about.get("varied", [])

    def column(self, name: str) -> Column:
        """Return a column by name."""
        return next(column for column in self.columns if column.name == name)

    def values(self, name: str) -> list:
        """Return the values of a column."""
        return [row[name] for row in self.rows]

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table as a frame in SI, lives in hours, a row for each point.

        Varied fields are named by the last part of their path, where that tells them apart.  ``frame.attrs["units"]`` and ``["meanings"]`` hold
        those of all columns (unit ``"1"`` for a pure number, none for words).
        """
        import pandas

        columns = [self._in_si(column) for column in self.columns]
        frame = pandas.DataFrame({name: values for name, _, _, values in columns})
        frame.attrs["units"] = {name: unit for name, unit, _, _ in columns}
        frame.attrs["meanings"] = {name: meaning for name, _, meaning, _ in columns}
        return frame

    def to_xarray(self) -> "xarray.Dataset":
        """Return a sweep as a dataset in SI, lives in hours, with a dimension for each varied field, named as by `to_pandas`.

        Every variable carries the attributes ``units`` and ``long_name``, which xarray writes on the axes of its plots.

        Raises
        ------
        ValueError
            The table is not that of a sweep.
        """
        import xarray

        if "axes" not in self.about:
            raise ValueError(f"a table of {self.about.get('kind', 'another study')} has no axes; use to_pandas")
        columns = {column.name: self._in_si(column) for column in self.columns}
        varied = [axis["field"] for axis in self.about["axes"]]
        shape, names = [len(axis["values"]) for axis in self.about["axes"]], [columns[path][0] for path in varied]
        coordinates, variables = {}, {}
        for path, (name, unit, meaning, values) in columns.items():
            array, notes = np.array(values).reshape(shape), {"long_name": meaning} | ({"units": unit} if unit is not None else {})
            if path in varied:
                other = tuple(slice(None) if other == path else 0 for other in varied)
                coordinates[name] = (name, array[other], notes)
            else:
                variables[name] = (names, array, notes)
        return xarray.Dataset(variables, coordinates, {name: str(self.about[name]) for name in ("scene", "level", "version")})

    def _in_si(self, column: Column) -> tuple[str, str | None, str, list]:
        """Return short name, SI unit (None for words), meaning and values in SI of a column."""
        values, varied = self.values(column.name), [axis["field"] for axis in self._varied]
        last = column.name.rpartition(".")[2]
        name = last if [path.rpartition(".")[2] for path in varied].count(last) == 1 and column.name in varied else column.name
        if any(isinstance(value, str) for value in values):
            return name, None, column.meaning, values
        if column.name in _RESULTS:
            known = _RESULTS[column.name]
            return name, known.si_unit or "1", column.meaning, [value / known.factor for value in values]
        if column.name not in quantities(Scene):
            return name, column.unit or "1", column.meaning, values
        unit = quantities(Scene)[column.name].unit
        scale, offset = conversion(column.unit or "dimensionless", unit)
        return name, unit or "1", column.meaning, [scale * value + offset for value in values]


def write_table(path: Path, table: Table) -> tuple[Path, Path]:
    """Write a table as Parquet and CSV; existing files are replaced, each as a whole, when both are complete.

    Parquet holds units and meanings in the metadata of its fields, and ``about`` as JSON in the metadata of its schema under
    ``bearing_sim``.  CSV gives the unit in brackets after the column name.

    Parameters
    ----------
    path : of either file; the suffix is replaced.
    table : to write.

    Returns
    -------
    paths of the Parquet and of the CSV file.
    """
    import pyarrow.parquet

    parquet, text = path.with_suffix(".parquet"), path.with_suffix(".csv")
    path.parent.mkdir(parents=True, exist_ok=True)
    with replaced(text) as text_draft, replaced(parquet) as draft:
        text_draft.write_bytes(_csv(table))
        pyarrow.parquet.write_table(_arrow(table, _digest_of(text_draft)), draft)
    return parquet, text


def _csv(table: Table) -> bytes:
    """Return the contents of the CSV file of a table."""
    file = io.StringIO(newline="")
    writer = csv.writer(file)
    writer.writerow([headed(column) for column in table.columns])
    writer.writerows([row[column.name] for column in table.columns] for row in table.rows)
    return file.getvalue().encode()


def study_digest(*parts: object) -> str:
    """Return the digest of a study, which its tables hold as ``study`` in what they say of their origin.

    Parameters
    ----------
    parts : all that defines the study, with an exact `repr`: its kind, scenes, numbers, texts and tuples of these.
    """
    return hashlib.sha256("\n".join(map(repr, parts)).encode()).hexdigest()


def require_same_study(output: Output, study: str, parts: Sequence[str] = ("",)) -> None:
    """Raise `RefusedOutput` if tables exist where an output is to be written, unless they are of the same study, which is then completed.

    A table is of the same study if its Parquet file holds the digest of the study, and its CSV file is what was written beside that.

    Parameters
    ----------
    output : of the tables.
    study : see `study_digest`.
    parts : what is added to the name for each table.
    """
    for part in parts:
        parquet, text = (output.path.with_name(f"{output.path.stem}{part}{suffix}") for suffix in (".parquet", ".csv"))
        found, csv_digest = _origin_of(parquet)
        is_same = found == study
        is_its_text = is_same and text.is_file() and _digest_of(text) == csv_digest
        for path, may_replace in ((parquet, is_same), (text, is_its_text)):
            if path.is_file() and not (may_replace or output.force):
                raise RefusedOutput(f"{path} exists and was not written by this study; use {FORCE} to replace it, or name another file")
            Output(path, True, output.inputs).check()


def same_points(output: Output, study: str) -> Output:
    """Return the output of a CSV file of points, which may replace a file that this study has written, as the journal beside it says.

    Parameters
    ----------
    output : of the CSV file.
    study : see `study_digest`.

    Raises
    ------
    RefusedOutput
        There is another file, or an input.
    """
    exists = output.path.is_file()
    if exists and not output.force:
        beside, origin = output.path.with_suffix(".journal"), {}
        if beside.is_file():
            with Journal(beside) as journal:
                origin = journal[study] if study in journal else {}
        if origin.get(_POINTS) != _digest_of(output.path).decode():
            raise RefusedOutput(f"{output.path} exists and was not written by this study; use {FORCE} to replace it, or name another file")
    own = Output(output.path, output.force or exists, output.inputs)
    own.check()
    return own


def note_points(journal: Journal, study: str, path: Path) -> None:
    """Note in the journal of a study which CSV file of points it has written, for `same_points`."""
    journal.add(study, {_POINTS: _digest_of(path).decode()})


def _origin_of(parquet: Path) -> tuple[str | None, bytes | None]:
    """Return the digest of the study of a table and that of its CSV file; None for what its Parquet file does not say."""
    import pyarrow.parquet

    try:
        notes = pyarrow.parquet.read_schema(parquet).metadata if parquet.is_file() else None
        return (json.loads(notes[_ABOUT]).get("study"), notes.get(_CSV)) if notes else (None, None)
    except (OSError, pyarrow.ArrowException, ValueError, LookupError, AttributeError):
        return None, None


def _digest_of(path: Path) -> bytes:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest().encode()


def life_column(table: Table) -> str:
    """Return the column of the life that a table is about: the modified rating life where any point of it has a factor for oil or reliability."""
    basic, modified = "rating_life", "modified_rating_life"
    has_both = {basic, modified} <= {column.name for column in table.columns}
    return modified if has_both and any(row[basic] == row[basic] != row[modified] for row in table.rows) else basic


def headed(column: Column) -> str:
    """Return a column heading with its unit."""
    return f"{column.name} [{column.unit}]" if column.unit else column.name


def _arrow(table, csv_digest):
    """Return a table as one of Arrow, which also holds the digest of its CSV file."""
    import pyarrow

    arrays = [pyarrow.array(table.values(column.name)) for column in table.columns]
    fields = [
        pyarrow.field(column.name, array.type, metadata={"unit": column.unit, "meaning": column.meaning})
        for column, array in zip(table.columns, arrays)
    ]
    return pyarrow.Table.from_arrays(arrays, schema=pyarrow.schema(fields, metadata={_ABOUT: json.dumps(table.about), _CSV: csv_digest}))


def read_table(path: Path) -> Table:
    """Return a table from its Parquet file.

    Raises
    ------
    OSError
        The file cannot be opened.
    ValueError
        The file is not a table written by `write_table`.
    """
    import pyarrow.parquet

    if (reason := why_not_readable(path)) and reason != NO_FILE:
        raise ValueError(f"{path}: {reason}")
    try:
        with pyarrow.parquet.ParquetFile(path) as file:
            RESULT_ROWS.check(file.metadata.num_rows, str(path))
            RESULT_CELLS.check(file.metadata.num_rows * file.metadata.num_columns, str(path))
            found = file.read()
    except MemoryError:
        raise ValueError(f"{path}: it does not fit into the memory of this machine") from None
    except pyarrow.ArrowException as error:
        raise ValueError(f"{path}: not readable as Parquet: {' '.join(str(error).split())[:_LONGEST_REASON]}") from None
    about = (found.schema.metadata or {}).get(_ABOUT)
    if about is None:
        raise ValueError(f"{path}: a Parquet file, but not a table of bearing-sim")
    try:
        described = json.loads(about)
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: its description is not readable as JSON: {error}") from None
    with written_by_us(path):
        notes: list[Mapping] = [field.metadata or {} for field in found.schema]
        columns = [
            Column(field.name, note.get(b"unit", b"").decode(), note.get(b"meaning", b"").decode()) for field, note in zip(found.schema, notes)
        ]
        return Table(tuple(columns), found.to_pylist(), _checked(described))


@contextmanager
def written_by_us(path: Path) -> Iterator[None]:
    """Raise ValueError where the contents of a table, or what it says about itself, are not as this program writes them.

    Columns and description can hold anything in a file from somebody else; what reads them relies on what `write_table` writes.
    """
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, StopIteration, TypeError, UnicodeError) as error:
        found = " ".join(f"{type(error).__name__}: {error}".split())[:_LONGEST_REASON]
        raise ValueError(f"{path}: its columns or its description are not as bearing-sim writes them ({found}); make the table again") from None


def _checked(about: object) -> dict:
    """Return the description of a table; raise TypeError or LookupError if it is none."""
    if not isinstance(about, dict):
        raise TypeError(f"the description is no mapping but {type(about).__name__}")
    for axis in about.get("axes", ()):
        if not isinstance(axis["field"], str) or not isinstance(axis["values"], list):
            raise TypeError(f"axis of the field {axis['field']!r}")
    return about


def read_any_table(path: Path) -> Table:
    """Return a table from its Parquet file, from the one beside its CSV file, or from CSV alone, when nothing is known of its origin.

    Raises
    ------
    OSError, ValueError
        See `read_table`; or CSV is not a heading and lines with as many values.
    """
    kept = path.with_suffix(".parquet")
    if kept.is_file() or path.suffix.lower() == ".parquet":
        return read_table(kept)
    try:
        lines = list(csv.reader(io.StringIO(read_text(path, RESULT_TEXT))))
    except csv.Error as error:
        raise ValueError(f"{path}: cannot be read as a table: {error}") from None
    RESULT_ROWS.check(len(lines) - 1, str(path))
    if len(lines) < 2 or len({len(line) for line in lines}) > 1:
        raise ValueError(f"{path}: expected a heading and lines with as many values")
    columns = [Column(found[1], found[2] or "", "") for found in map(_HEADED.fullmatch, lines[0])]
    return Table(tuple(columns), [{column.name: _number(text) for column, text in zip(columns, line)} for line in lines[1:]], {})


def _number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text
