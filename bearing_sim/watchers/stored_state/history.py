# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The history of a bearing: its totals by day, in a Parquet table beside the state file, or as CSV on a machine without pyarrow.

The node moves days that are over to the history by ``python -m bearing_sim.watchers.stored_state.history``, so that it never loads pyarrow itself.
Every move has a number, which the history keeps: a move that was interrupted by a kill is not made twice.
"""

import csv
import hashlib
import importlib.util
import io
import json
import operator
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, TextIO

from bearing_sim.files.limits import HISTORY_FILE
from bearing_sim.files.outputs import replaced
from bearing_sim.files.reading import open_regular, read_text
from bearing_sim.watchers.stored_state.state import StoredState
from bearing_sim.watchers.stored_state.totals import KAPPA_BOUNDS, LOAD_BOUNDS, SLIP_BOUNDS, Totals

MOST_DAYS = 20_000
"""Days that a history keeps, some 55 years; the oldest are dropped."""

_LAST_MOVE = b"bearing_sim_last_move"  # metadata of the Parquet file
_WITHIN = 120.0  # [s] for the process that moves days
_HOUR = 3600.0  # [s]
WITHOUT_PYARROW = 3
"""Exit code of a move that wrote CSV because there is no pyarrow."""


def _class_names(quantity: str, bounds: tuple[float, ...], unknown: str = "") -> list[str]:
    edges = [f"{bound:g}" for bound in bounds]
    names = [f"{quantity}_below_{edges[0]}", *(f"{quantity}_{low}_to_{high}" for low, high in zip(edges, edges[1:])), f"{quantity}_from_{edges[-1]}"]
    return [f"{name}_hours" for name in names] + ([f"{quantity}_{unknown}_hours"] if unknown else [])


CLASSES = {
    "slip_seconds": _class_names("slip", SLIP_BOUNDS, "unknown"),
    "lubrication_seconds": _class_names("kappa", KAPPA_BOUNDS, "unknown"),
    "load_seconds": _class_names("load_ratio", LOAD_BOUNDS),
}
"""Columns of the hours by regime, by field of the totals."""
_EXTREMES = {"largest_slip": max, "lowest_clearance": min}


def row_of(totals: Totals) -> dict[str, float | int | None]:
    """Return totals as a row of a table: hours and SI, extremes without their times."""
    row = {name: getattr(totals, name) for name in ("damage", "basic_damage", "revolutions", "starts")}
    row |= {f"{name}_hours": getattr(totals, f"{name}_seconds") / _HOUR for name in ("monitored", "running")}
    for name, columns in CLASSES.items():
        row |= {column: seconds / _HOUR for column, seconds in zip(columns, getattr(totals, name))}
    extremes = {name: getattr(totals, name) for name in _EXTREMES}
    return row | {name: None if extreme is None else extreme.value for name, extreme in extremes.items()}


def added(one: Mapping[str, object], other: Mapping[str, object]) -> dict[str, object]:
    """Return the row of two stretches of one day together."""
    together = dict(one)
    for name, value in other.items():
        if together.get(name) is None:
            together[name] = value
        elif value is not None and name != "day":
            together[name] = _EXTREMES.get(name, operator.add)(together[name], value)
    return together


def history_paths(path: Path) -> tuple[Path, Path]:
    """Return the Parquet and the CSV file of the history of a state file."""
    return path.with_name(f"{path.stem}.days.parquet"), path.with_name(f"{path.stem}.days.csv")


class Move(NamedTuple):
    """The last move of days to a history: its number, counted from 1, and its days."""

    number: int
    days: list[str]


_NO_MOVE = Move(0, [])


def read_history(path: Path) -> tuple[list[dict[str, object]], Move]:
    """Return the rows of the history of a state file in order of day, and its last move.

    Raises
    ------
    OSError, ValueError
        A file of the history cannot be read; ImportError where it is Parquet and there is no pyarrow.
    """
    parquet, table = history_paths(path)
    try:
        rows, last = _read_parquet(parquet) if parquet.exists() else ([], _NO_MOVE)
        later, move = _read_csv(table)
    except (OSError, ImportError):
        raise
    except Exception as error:  # whatever a damaged file makes its reader raise
        raise ValueError(f"the history of days of {path} is damaged: {type(error).__name__}: {error}") from None
    # A move into the other file that was interrupted before it removed this one: its days are there already.
    return (_with(rows, later), move) if move.number > last.number else (rows, last)


def all_days(path: Path, state: StoredState) -> list[dict[str, object]]:
    """Return the rows of all days of a state, those of its history and those that are not there yet; errors as of `read_history`."""
    rows, last = read_history(path)
    own = [{"day": day, **row_of(totals)} for day, totals in state.days.items()]
    return _with(rows, _not_moved(own, state.folds + 1, last)[0])


def _read_parquet(parquet: Path) -> tuple[list[dict[str, object]], Move]:
    from pyarrow import parquet as files

    open_regular(parquet, HISTORY_FILE).close()
    read = files.read_table(parquet)
    rows = read.to_pylist()
    return rows, _checked_move(read.schema.metadata[_LAST_MOVE], rows)


def _read_csv(table: Path) -> tuple[list[dict[str, object]], Move]:
    if not table.exists():
        return [], _NO_MOVE
    with io.StringIO(read_text(table, HISTORY_FILE)) as text:
        move = text.readline().partition(": ")[2]
        rows = [{name: _cell(name, value) for name, value in row.items()} for row in csv.DictReader(text)]
        return rows, _checked_move(move, rows)


def _move_text(move: Move, rows: list[dict[str, object]]) -> str:
    """Return the last move as a history keeps it: with a checksum of that and of the rows."""
    written = [{name: _cell(name, "" if row.get(name) is None else str(row[name])) for name in rows[0]} for row in rows]  # as they will be read
    return json.dumps([*move, hashlib.sha256(json.dumps([*move, written]).encode()).hexdigest()])


def _checked_move(text: str | bytes, rows: list[dict[str, object]]) -> Move:
    """Return the last move of a history; ValueError if rows or move are not those that were written.  Older versions wrote no checksum."""
    number, days, *checksum = json.loads(text)
    move = Move(number, days)
    if checksum and json.loads(_move_text(move, rows))[2:] != checksum:
        raise ValueError("its checksum does not fit its contents")
    return move


def _cell(name: str, text: str) -> object:
    if name == "day":
        return text
    return None if text == "" else int(text) if name == "starts" else float(text)


def move_days(path: Path, days: Mapping[str, Totals], number: int) -> bool:
    """Add days to the history of a state file, in a process of its own.

    Parameters
    ----------
    path : of the state file.
    days : totals by day.
    number : of this move, one more than of the last; a move that the history has already is not made again.

    Returns
    -------
    Whether the history is Parquet; False: CSV, for there is no pyarrow.

    Raises
    ------
    OSError
        It cannot be written.
    """
    rows = [{"day": day, **row_of(totals)} for day, totals in days.items()]
    command = [sys.executable, "-m", "bearing_sim.watchers.stored_state.history", os.fspath(path), str(number)]
    try:
        done = subprocess.run(command, input=json.dumps(rows), capture_output=True, text=True, timeout=_WITHIN, check=False)
    except subprocess.TimeoutExpired:
        raise OSError(f"the history of days of {path} was not written within {_WITHIN:g} s") from None
    if done.returncode not in (0, WITHOUT_PYARROW):
        last = (done.stderr.strip().splitlines() or ["no reason given"])[-1]
        raise OSError(f"the history of days of {path} cannot be written: {last}")
    return done.returncode == 0


def write_history(path: Path, new: list[dict[str, object]], number: int) -> bool:
    """Add rows to the history of a state file, in this process; arguments, result and errors as of `move_days`."""
    parquet, table = history_paths(path)
    if importlib.util.find_spec("pyarrow") is None:
        rows, last = _read_csv(table)
        new, move = _not_moved(new, number, last)
        _write_csv(table, _with(rows, new), move)
        return False
    rows, last = read_history(path)
    new, move = _not_moved(new, number, last)
    rows = _with(rows, new)
    with replaced(parquet) as draft:
        _write_parquet(draft, rows, {_LAST_MOVE: _move_text(move, rows).encode()})
    table.unlink(missing_ok=True)
    return True


def export_days(out: Path, rows: list[dict[str, object]], as_parquet: bool) -> None:
    """Write rows as Parquet or as CSV; ImportError where that needs pyarrow and there is none."""
    if as_parquet:
        _write_parquet(out, rows, {})
        return
    with open(out, "w", newline="") as text:
        _write_rows(text, rows)


def _write_parquet(path: Path, rows: list[dict[str, object]], metadata: dict[bytes, bytes]) -> None:
    import pyarrow
    from pyarrow import parquet

    kinds = {"day": pyarrow.string(), "starts": pyarrow.int64()}
    schema = pyarrow.schema([(name, kinds.get(name, pyarrow.float64())) for name in (rows[0] if rows else ["day"])], metadata)
    parquet.write_table(pyarrow.Table.from_pylist(rows, schema), path)


def _write_rows(text: TextIO, rows: list[dict[str, object]]) -> None:
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["day"])
    writer.writeheader()
    writer.writerows(rows)


def _not_moved(new: list[dict[str, object]], number: int, last: Move) -> tuple[list[dict[str, object]], Move]:
    """Return the rows that the last move has not brought already, and what the last move will be."""
    if number > last.number:
        return new, Move(number, [row["day"] for row in new])
    missing = [row for row in new if row["day"] not in last.days]  # it was interrupted, and other days are over since
    return missing, Move(last.number, last.days + [row["day"] for row in missing])


def _with(rows: list[dict[str, object]], new: list[dict[str, object]]) -> list[dict[str, object]]:
    by_day = {row["day"]: row for row in rows}
    for row in new:
        by_day[row["day"]] = added(by_day[row["day"]], row) if row["day"] in by_day else row
    return [by_day[day] for day in sorted(by_day)][-MOST_DAYS:]


def _write_csv(table: Path, rows: list[dict[str, object]], move: Move) -> None:
    with replaced(table) as draft, open(draft, "w", newline="") as text:
        text.write(f"# totals of a bearing by UTC day; last move: {_move_text(move, rows)}\n")
        _write_rows(text, rows)


def main(arguments: list[str]) -> int:
    """Add the rows on the standard input, as JSON, to the history of the state file that is named, by the move of that number."""
    path, number = arguments
    return 0 if write_history(Path(path), json.load(sys.stdin), int(number)) else WITHOUT_PYARROW


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
