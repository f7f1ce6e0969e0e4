# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bearings of a fleet and their logs: which logs there are in folders and data sets, what each holds, and of which bearing it is.

A log is a recording (MCAP, SQLite, a bag's folder) or a measured table (CSV, Parquet), or the rows of one machine in a table of many.
One scene is for all logs, or a table (CSV or Parquet) has a row for each bearing, with the column ``log`` and, where bearings differ, ``serial``,
``scene``, ``mapping``, fields of the scene such as ``lubricant.temperature``, and fields of the mapping such as
``mapping.radial_load.pitch_diameter``.  An empty cell changes nothing.
"""

import csv
import json
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import NamedTuple

from bearing_sim.files.limits import BEARINGS_ROWS
from bearing_sim.inputs.csv_import import Mapping, input_log, mapping_from_yaml, read_table
from bearing_sim.inputs.csv_text import DELIMITERS, TableError, encoding_of, find_header, first_look, records, table_lines
from bearing_sim.inputs.log import InputLog, LogReading
from bearing_sim.inputs.parquet_table import checksum, files_of, is_parquet, rows_of, values_of
from bearing_sim.scene.errors import InvalidField, SceneError, did_you_mean, shortened
from bearing_sim.scene.loader import load_scene, read_named
from bearing_sim.scene.scene import Scene

_TEXTS = (".csv", ".tsv", ".txt", ".xlsx")
_RECORDINGS = (".mcap", ".db3", ".bag")
_HEADINGS = ("log", "serial", "scene", "mapping")
_OF_MAPPING = "mapping."


class NoLogs(ValueError):
    """Nothing that can be replayed; the message says where it was looked for."""


class Log(NamedTuple):
    """One log.

    Attributes
    ----------
    name : by which reports and the table of bearings call it.
    path : of a file, or of the folder of a bag or of a data set.
    only : (column, text) of the rows that belong to it; empty for all.
    """

    name: str
    path: Path
    only: tuple[tuple[str, str], ...] = ()

    @property
    def is_table(self) -> bool:
        """Whether a mapping is needed to read it."""
        return self.path.suffix.lower() in _TEXTS or is_parquet(self.path)

    def contents(self) -> str:
        """Return the checksum of all files that it is read from.

        Raises
        ------
        OSError, TableError
            One of them cannot be read.
        """
        if is_parquet(self.path):
            return checksum(files_of(self.path, dict(self.only)))
        return checksum(sorted(file for file in self.path.rglob("*") if file.is_file()) if self.path.is_dir() else [self.path])


class Reading(NamedTuple):
    """How logs are read.

    Attributes
    ----------
    mapping, mapping_overrides : of tables, the text of the mapping and texts that change it; ``""`` where there is none.
    mapping_name : for messages.
    recordings : how those are read; its longest gap counts for tables, too.
    """

    mapping: str
    mapping_overrides: tuple[str, ...]
    mapping_name: str
    recordings: LogReading


def find_logs(paths: Sequence[Path], by: str | None = None, leave_out: Collection[Path] = ()) -> list[Log]:
    """Return the logs at some paths, in order of their names.

    Parameters
    ----------
    paths : of logs, or of folders that are searched for logs at whatever depth.
    by : column of tables that tells machines apart, each of which has a log of its own.
    leave_out : files that are no logs, such as results.

    Raises
    ------
    NoLogs
        A path does not exist, or there is no log.
    TableError
        ``by`` is no column of a table.
    """
    found: list[tuple[str, Path, tuple]] = []
    kept = {path.resolve() for path in leave_out}
    for path in paths:
        if not path.exists():
            raise NoLogs(f"{path}: no such file or folder")
        for each in _under(path, by):
            if each.resolve() in kept:
                continue
            name = each.stem if each == path else str(each.relative_to(path).with_suffix(""))
            if by is None or not Log(name, each).is_table:
                found.append((name, each, ()))
            else:
                found += [(value, each, ((by, value),)) for value in _machines(each, by)]
    if not found:
        raise NoLogs(f"{', '.join(map(str, paths))}: no logs; expected files {', '.join((*_TEXTS, '.parquet', *_RECORDINGS))}, or folders of bags")
    times = Counter(name for name, _, _ in found)
    logs = [Log(name if times[name] == 1 else f"{path.with_suffix('')}{f'/{name}' if only else ''}", path, only) for name, path, only in found]
    return sorted(logs, key=lambda log: log.name)


def _under(path: Path, by: str | None) -> Iterator[Path]:
    """Yield the files and folders below a path that are logs."""
    if path.is_file() or is_bag(path) or (by is not None and is_parquet(path) and not any(map(is_text, path.rglob("*")))):
        yield path
        return
    for each in sorted(path.iterdir()):
        if each.name.startswith((".", "_")):
            continue
        if each.is_dir():
            yield from _under(each, by)
        elif is_text(each) or each.suffix.lower() in (*_RECORDINGS, ".parquet") or each.name.endswith(".mcap.active"):
            yield each


def is_bag(folder: Path) -> bool:
    """Return whether a folder is one recording."""
    return (folder / "metadata.yaml").is_file() or next(folder.glob("*.db3"), None) is not None


def is_text(path: Path) -> bool:
    """Return whether a path is that of a table as text."""
    return path.suffix.lower() in _TEXTS


def _machines(path: Path, by: str) -> list[str]:
    if is_parquet(path):
        return values_of(path, by)
    layout = first_look(path)
    find_header(layout, [("--by", by)])
    column = layout.names.index(by)
    return sorted({cells[column].strip() for _, cells in records(layout) if column < len(cells)} - {""})


def read_log(log: Log, reading: Reading) -> InputLog:
    """Return what a log holds.

    Raises
    ------
    InputLogError, TableError, SceneError, OSError
        It cannot be read, or it is a table and there is no mapping.
    """
    if not log.is_table:
        return reading.recordings.read(log.path)
    if not reading.mapping:
        hint = f"bearing-sim import-csv --guess {log.path} -o mapping.yaml" if is_text(log.path) else "see `bearing-sim import-csv --help`"
        raise TableError(f"{log.path}: a table needs a mapping that says which columns are what (--mapping): {hint}")
    mapping = mapping_of(reading)
    if log.only:
        mapping = mapping_of(reading, (f"only={json.dumps(mapping.only | dict(log.only), ensure_ascii=False)}",))
    return input_log(read_table(log.path, mapping), log.path)


def mapping_of(reading: Reading, more: Sequence[str] = ()) -> Mapping:
    """Return the mapping of tables, with ``more`` overrides; raise `SceneError` if it is invalid."""
    return mapping_from_yaml(reading.mapping, reading.mapping_name, (*reading.mapping_overrides, *more))


class Bearing(NamedTuple):
    """One bearing of a fleet.

    Attributes
    ----------
    name : serial number, or the name of its log.
    log, reading : what it has been through, and how that is read.
    scene : what it is; or why it is not known.
    """

    name: str
    log: Log
    reading: Reading
    scene: Scene | SceneError


def bearings_of(
    logs: Sequence[Log], rows: Sequence[dict[str, str]], scene: str | None, overrides: Sequence[str], reading: Reading, origin: str = ""
) -> list[Bearing]:
    """Return the bearings of logs; one that has no valid scene has the error in its place.

    Parameters
    ----------
    logs : all logs; one that no row names has the scene of all.
    rows : of the table of bearings (see `read_bearings`); a log may stand in several.
    scene : of bearings whose row has none; a bundled name or a file.
    overrides : texts that change every scene, before those of a row.
    reading : how logs are read, where a row says nothing else.
    origin : of the rows, for messages.
    """
    loaded: dict[tuple, Scene | SceneError] = {}
    readings: dict[tuple, Reading | SceneError] = {}
    named = {key: log for log in logs for key in (log.name, str(log.path)) if key == log.name or not log.only}

    def bearing(log: Log, row: dict[str, str]) -> Bearing:
        chosen, own = row.get("scene") or scene, _overrides(row)
        key = chosen, tuple(own)
        if key not in loaded:
            loaded[key] = _loaded(chosen, [*overrides, *own], log, origin)
        changed = tuple(f"{name.removeprefix(_OF_MAPPING)}={text}" for name, text in row.items() if name.startswith(_OF_MAPPING) and text)
        how = row.get("mapping", ""), changed
        if how not in readings:
            readings[how] = _reading(reading, *how)
        found, read = loaded[key], readings[how]
        if isinstance(read, SceneError):
            found, read = read, reading
        return Bearing(row.get("serial") or log.name, log, read, found)

    found, of_rows = [], set()
    for number, row in enumerate(rows, 2):
        log = named.get(row["log"])
        if log is None:
            error = InvalidField("log", repr(row["log"]), f"no such log{did_you_mean(row['log'], [each.name for each in logs])}")
            absent = Log(row["log"], Path(row["log"]))
            found.append(Bearing(row.get("serial") or row["log"], absent, reading, SceneError(f"{origin}, line {number}", [error])))
        else:
            of_rows.add(log)
            found.append(bearing(log, row))
    found += [bearing(log, {}) for log in logs if log not in of_rows]
    times = Counter(each.name for each in found)
    return [each if times[each.name] == 1 else each._replace(name=f"{each.name} ({each.log.name})") for each in found]


def _overrides(row: dict[str, str]) -> list[str]:
    return [f"{name}={text}" for name, text in row.items() if name not in _HEADINGS and not name.startswith(_OF_MAPPING) and text]


def _loaded(scene: str | None, overrides: Sequence[str], log: Log, origin: str) -> Scene | SceneError:
    if scene is None:
        expected = f"expected a row of {origin} that names this log and its scene, or --scene" if origin else "expected --scene"
        return SceneError(log.name, [InvalidField("scene", "", expected)])
    try:
        return load_scene(scene, overrides)
    except SceneError as error:
        return error


def _reading(reading: Reading, mapping: str, overrides: Sequence[str]) -> Reading | SceneError:
    """Return how a log is read whose row has a mapping or changes fields of it."""
    if not mapping and not overrides:
        return reading
    try:
        if mapping:
            reading = reading._replace(mapping=read_named(mapping, "catalog/mappings", "mapping")[0], mapping_name=mapping)
        reading = reading._replace(mapping_overrides=(*reading.mapping_overrides, *overrides))
        mapping_of(reading)
        return reading
    except SceneError as error:
        return error


def read_bearings(path: Path) -> list[dict[str, str]]:
    """Return the rows of a table of bearings as texts by heading.

    Raises
    ------
    TableError
        It cannot be read, has no column ``log``, or has one that nobody knows.
    """
    rows = [{name: text.strip() for name, text in row.items()} for row in rows_of(path)] if is_parquet(path) else _text_rows(path)
    names = list(rows[0]) if rows else []
    if "log" not in names:
        raise TableError(f"{path}: the table of bearings has no column 'log'{did_you_mean('log', names)}; it has {', '.join(names) or 'no rows'}")
    blocks = tuple(Scene.__dataclass_fields__)
    known = [*_HEADINGS, *blocks]
    for name in names:
        if name not in _HEADINGS and not name.startswith(_OF_MAPPING) and name.partition(".")[0] not in blocks:
            expected = f"expected {', '.join(_HEADINGS)}, a field of the scene such as lubricant.temperature, or mapping.FIELD"
            raise TableError(f"{path}: unknown column {shortened(repr(name), 200)}{did_you_mean(name.partition('.')[0], known)}; {expected}")
    empty = [number for number, row in enumerate(rows, 2) if not row["log"]]
    if empty:
        raise TableError(f"{path}, line {empty[0]}: no log")
    return rows


def _text_rows(path: Path) -> list[dict[str, str]]:
    try:
        text = table_lines(path, encoding_of(path))
        first = next(text, "")
        rows = csv.reader(chain([first], text), delimiter=max(DELIMITERS, key=first.count))
        lines = [line for line in islice(rows, BEARINGS_ROWS.value + 2) if any(cell.strip() for cell in line)]
    except (csv.Error, UnicodeDecodeError) as error:
        raise TableError(f"{path}: cannot be read as a table: {error}") from None
    BEARINGS_ROWS.check(len(lines) - 1, str(path))
    if len(lines) < 2:
        raise TableError(f"{path}: expected a heading and a line for each bearing")
    names = [name.strip() for name in lines[0]]
    twice = [name for name, times in Counter(names).items() if times > 1]
    if twice:
        raise TableError(f"{path}: {', '.join(map(repr, twice))} is the heading of several columns")
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(names):
            raise TableError(f"{path}, row {number}: {len(line)} cells, expected {len(names)} ({', '.join(names)})")
    return [dict(zip(names, (cell.strip() for cell in line))) for line in lines[1:]]
