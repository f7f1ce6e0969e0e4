# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The logs of a fleet: which there are in folders and data sets, and what each of them holds.

A log is a recording (MCAP, SQLite, a bag's folder) or a measured table (CSV, Parquet), or the rows of one machine in a table of many.
"""

import json
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from bearing_sim.inputs.csv_import import Mapping, input_log, mapping_from_yaml, read_table
from bearing_sim.inputs.csv_text import Layout as TextLayout
from bearing_sim.inputs.csv_text import TableError, encoding_of, find_header, first_lines, records
from bearing_sim.inputs.log import InputLog, Source, read_input_log
from bearing_sim.inputs.parquet_table import checksum, files_of, is_parquet, values_of
from bearing_sim.messages import topics

_TEXTS = (".csv", ".tsv", ".txt")
_RECORDINGS = (".mcap", ".db3", ".bag")


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
    sources : of recordings, by channel, where it is not called by its own name.
    joint, stamps : of recordings, see `bearing_sim.inputs.log.read_input_log`.
    constants : by channel, values in SI that were not measured.
    """

    mapping: str = ""
    mapping_overrides: tuple[str, ...] = ()
    mapping_name: str = ""
    sources: tuple[tuple[str, Source], ...] = ()
    joint: str = topics.SHAFT_JOINT
    stamps: str = "header"
    constants: tuple[tuple[str, float], ...] = ()


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
    layout = TextLayout(encoding_of(path))
    find_header(path, first_lines(path, layout.encoding), [("--by", by)], None, layout)
    column = layout.names.index(by)
    return sorted({cells[column].strip() for _, cells in records(path, layout) if column < len(cells)} - {""})


def read_log(log: Log, reading: Reading) -> InputLog:
    """Return what a log holds.

    Raises
    ------
    InputLogError, TableError, SceneError, OSError
        It cannot be read, or it is a table and there is no mapping.
    """
    if not log.is_table:
        return read_input_log(log.path, dict(reading.sources), reading.joint, reading.stamps, constants=dict(reading.constants))
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
