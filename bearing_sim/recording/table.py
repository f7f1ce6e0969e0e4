# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A recording as one table: a row for each sample, and a column for each observable, or for each roller if the observable is one of rollers.

Columns are named after the observables of `bearing_sim.model.sample`, those of rollers with the roller's number after them
(``inner_load_07``).  Parquet keeps unit and meaning of each column in the schema; CSV has the unit in the header, such as
``shaft_speed [rad/s]``.  Besides ``time`` there is ``stamp``, the wall time.
"""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet

from bearing_sim.model.characteristic_frequencies import FREQUENCIES, characteristic_frequencies
from bearing_sim.model.sample import OBSERVABLES, Observable
from bearing_sim.recording.reader import Recording
from bearing_sim.scene.loader import did_you_mean

_FREQUENCIES = tuple(Observable(frequency.column, "Hz", f"{frequency.meaning} ({frequency.symbol})") for frequency in FREQUENCIES)
_COLUMNS = (*OBSERVABLES, *_FREQUENCIES)


class Excerpt(NamedTuple):
    """The part of a recording that goes into a table.

    Attributes
    ----------
    columns : names of observables and of characteristic frequencies; empty for all.
    rollers : whether to include observables of single rollers.
    every : keep one sample in this many.
    first, last : simulated times between which samples are kept [s].
    """

    columns: tuple[str, ...] = ()
    rollers: bool = True
    every: int = 1
    first: float = -np.inf
    last: float = np.inf


class TableError(ValueError):
    """An excerpt that names an unknown observable, or a time span without samples."""


def write_table(recording: Recording, path: Path, excerpt: Excerpt, progress: Callable[[float], None], kind: str) -> int:
    """Write a recording as a table and return the number of rows.

    Parameters
    ----------
    recording : of a run.
    path : the file; replaced if it exists.
    excerpt : the part to write.
    progress : called repeatedly with the time reached [s].
    kind : ``csv`` or ``parquet``; the latter has the scene in the file's metadata.

    Raises
    ------
    TableError
        The excerpt names an unknown observable, or contains no sample.
    """
    schema, rows, seen = _schema(recording, excerpt, units_in_names=kind == "csv"), 0, 0
    if kind == "csv":
        writer = pa.csv.CSVWriter(str(path), schema)
    else:
        metadata = {name: text for name, text in recording.metadata.items() if text}
        writer = pa.parquet.ParquetWriter(str(path), schema.with_metadata(metadata), compression="zstd")
    with writer:
        for block in recording:
            if not isinstance(block, np.ndarray):
                continue
            kept = block[-seen % excerpt.every :: excerpt.every]
            seen += len(block)
            kept = kept[(kept["time"] >= excerpt.first) & (kept["time"] <= excerpt.last)]
            if len(kept):
                writer.write_table(pa.Table.from_arrays(list(_arrays(recording, kept, excerpt)), schema=schema))
                rows += len(kept)
            progress(float(block["time"][-1]) - recording.first_time)
    if not rows:
        raise TableError(
            f"{recording.path}: no sample between {excerpt.first:g} and {excerpt.last:g} s; there are some from "
            f"{recording.first_time:g} to {recording.last_time:g} s"
        )
    return rows


def _observables(excerpt: Excerpt) -> list:
    known = {observable.name for observable in _COLUMNS}
    for name in excerpt.columns:
        if name not in known:
            raise TableError(f"no observable {name!r}{did_you_mean(name, known)}; bearing-sim observables lists them")
    wanted = {"time", *(excerpt.columns or known)}
    return [observable for observable in _COLUMNS if observable.name in wanted and (excerpt.rollers or not observable.per_roller)]


def _schema(recording: Recording, excerpt: Excerpt, units_in_names: bool) -> pa.Schema:
    digits = len(str(recording.scene.bearing.roller.count - 1))

    def field(name: str, unit: str, meaning: str) -> pa.Field:
        title = f"{name} [{unit}]" if units_in_names and unit else name
        return pa.field(title, pa.float64(), metadata={"unit": unit, "meaning": meaning})

    fields = []
    for observable in _observables(excerpt):
        rollers = [f"_{roller:0{digits}}" for roller in range(recording.scene.bearing.roller.count)] if observable.per_roller else [""]
        fields += [field(f"{observable.name}{roller}", observable.unit, observable.meaning) for roller in rollers]
    stamp = pa.field("stamp", pa.timestamp("ns", tz="UTC"), metadata={"unit": "ns", "meaning": "wall time of the sample"})
    return pa.schema([fields[0], stamp, *fields[1:]])


def _arrays(recording: Recording, block: np.ndarray, excerpt: Excerpt) -> Iterator[pa.Array]:
    frequencies = dict(zip((frequency.name for frequency in _FREQUENCIES), characteristic_frequencies(block).T))
    for observable in _observables(excerpt):
        numbers = frequencies[observable.name] if observable.name in frequencies else block[observable.name]
        for column in numbers.T if observable.per_roller else (numbers,):
            yield pa.array(np.ascontiguousarray(column))
        if observable.name == "time":
            stamps = recording.start_ns + np.rint(numbers * 1e9).astype(np.int64)
            yield pa.array(stamps, pa.timestamp("ns", tz="UTC"))
