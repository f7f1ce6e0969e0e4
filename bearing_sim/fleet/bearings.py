# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Which bearing has which log: one scene for all logs, or a table with a row for each bearing.

A table (CSV or Parquet) has the column ``log`` and, where bearings differ, ``serial``, ``scene``, ``mapping``, fields of the scene such as
``lubricant.temperature``, and fields of the mapping such as ``mapping.radial_load.pitch_diameter``.  An empty cell changes nothing.
"""

import csv
from collections import Counter
from collections.abc import Sequence
from itertools import chain, islice
from pathlib import Path

from bearing_sim.files.limits import BEARINGS_ROWS
from bearing_sim.fleet.logs import Log, Reading, mapping_of
from bearing_sim.fleet.replay import Bearing
from bearing_sim.inputs.csv_text import DELIMITERS, TableError, encoding_of, lines_of, opened_text, within
from bearing_sim.inputs.parquet_table import is_parquet, rows_of
from bearing_sim.scene.errors import InvalidField, SceneError, did_you_mean, shortened
from bearing_sim.scene.loader import load_scene, read_named
from bearing_sim.scene.scene import Scene

_HEADINGS = ("log", "serial", "scene", "mapping")
_OF_MAPPING = "mapping."


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
        with opened_text(path, encoding_of(path)) as file:
            first = next(lines_of(file, path), "")
            delimiter = max(DELIMITERS, key=first.count)
            rows = csv.reader(chain([first], lines_of(file, path)), delimiter=delimiter)
            lines = [line for line in islice(rows, BEARINGS_ROWS.value + 2) if any(cell.strip() for cell in line)]
    except (csv.Error, UnicodeDecodeError) as error:
        raise TableError(f"{path}: cannot be read as a table: {error}") from None
    within(BEARINGS_ROWS, len(lines) - 1, path)
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
