# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""State files: one for each bearing, written so that neither a kill nor a loss of power leaves less than the state before.

A state is written to a draft beside the file and synchronised with the disk; the file becomes ``<name>.previous``, the draft becomes the file,
and the folder is synchronised.  A checksum tells a damaged file.  ``<name>.lock`` belongs to the process that uses the file; it stays where it
is when files are renamed, and holds the number of writes, which tells an older file in the place of a newer one.
"""

import fcntl
import os
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote, unquote

from bearing_sim.files.kept import Damaged, checked_contents, state_folder, with_checksum
from bearing_sim.files.limits import STATE_FILE, FileError, LimitError
from bearing_sim.files.outputs import replaced, synchronise
from bearing_sim.files.reading import NO_FILE, read_bytes, why_not_readable
from bearing_sim.messages.events import Level
from bearing_sim.watchers.stored_state.state import VERSION, StoredState, migrated, time_text

_LONGEST_SERIAL = 100


class StateError(OSError):
    """A state that cannot be used; the message says which, why, and what to do."""


class News(NamedTuple):
    """What happened to a state, for an `bearing_sim.messages.events.Event`."""

    level: Level
    kind: str
    text: str


def checked_serial(serial: str) -> str:
    """Return a serial number without blanks around it.

    Raises
    ------
    StateError
        It cannot be one.
    """
    serial = serial.strip()
    if len(serial) > _LONGEST_SERIAL or not serial.isprintable():
        raise StateError(f"serial = {serial[:_LONGEST_SERIAL]!r}: expected at most {_LONGEST_SERIAL} printable characters")
    return serial


def default_path(serial: str) -> Path:
    """Return the state file of a serial number, in the user's folder for state (``~/.local/state/bearing_sim`` on Linux)."""
    name = quote(serial, safe=" ")
    return state_folder() / f"{'%2E' + name[1:] if name.startswith('.') else name}.json"


def known_serials() -> list[str]:
    """Return the serial numbers that have a state in the user's folder for state."""
    folder = default_path("any").parent
    return sorted(unquote(path.stem) for path in folder.glob("*.json")) if folder.is_dir() else []


def previous_path(path: Path) -> Path:
    """Return the name of the last good state before the one in a file."""
    return path.with_name(f"{path.name}.previous")


def read_state(path: Path) -> tuple[StoredState, list[News]]:
    """Return the newest good state of a file, and what had to be done about it.

    Raises
    ------
    StateError
        There is no file, or neither it nor the one before is good.
    """
    found: dict[Path, StoredState] = {}
    faults: dict[Path, str] = {}
    for each in (path, previous_path(path)):
        try:
            found[each] = _parsed(each)
        except FileNotFoundError:
            continue
        except Damaged as error:
            faults[each] = str(error)
    if not found:
        if faults:
            causes = "; ".join(f"{each}: {fault}" for each, fault in faults.items())
            raise StateError(f"no good state is left: {causes}; put a copy in its place, or move the files away to begin at zero")
        raise FileNotFoundError(f"{path}: there is no state file")
    best = max(found, key=lambda each: (found[each].writes, each == path))
    state, news = found[best], []
    if path in faults:
        what = f"{path} is damaged ({faults[path]})"
        news.append(News(Level.WARN, "state.restored", f"{what}; the older state of {_shown(state)} is used"))
    elif best != path:
        what = f"{path} holds an older state than {best.name}" if path in found else f"{path} is missing"
        news.append(News(Level.WARN, "state.restored", f"{what}; the state of {_shown(state)} is used"))
    written = _writes_in_lock(path)
    if written > state.writes and not news:
        what = f"{path} holds write {state.writes}, although {written} have been made: an older copy was put in its place, or the disk lost some"
        news.append(News(Level.WARN, "state.restored", f"{what}; the older state of {_shown(state)} is used"))
    return state, news


class StateFile:
    """A state file that no other process may use meanwhile.

    Parameters
    ----------
    path : of the file; its folder is made if absent.

    Attributes
    ----------
    has_lock : whether other processes are kept away; some file systems cannot.

    Raises
    ------
    StateError
        Another process or another bearing uses it, or the folder cannot be made or written.
    """

    def __init__(self, path: str | Path):
        self.path = Path(path).expanduser().absolute()
        self.lock_path = self.path.with_name(f"{self.path.name}.lock")
        if self.path.is_dir():
            raise StateError(f"{self.path} is a folder; expected the name of a state file")
        try:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(self.lock_path, os.O_RDWR | os.O_CREAT, 0o644)
        except OSError as error:
            raise StateError(f"the state file {self.path} cannot be used: {error.strerror}; choose a folder that can be written") from None
        self.has_lock = True
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            owner = _lock_contents(self.lock_path).get("pid", "unknown")
            os.close(self._lock)
            raise StateError(
                f"the state file {self.path} is in use by process {owner}; a bearing has one state: end that process, or choose another serial "
                "number or state file"
            ) from None
        except OSError:
            self.has_lock = False
        self._note_owner(_writes_in_lock(self.path))

    def read(self) -> tuple[StoredState | None, list[News]]:
        """Return the state, None where there is no file yet, and what had to be done about it.  A damaged file is kept as ``<name>.damaged``.

        Raises
        ------
        StateError
            There is no good state.
        """
        try:
            state, news = read_state(self.path)
        except FileNotFoundError:
            return None, []
        if any(each.kind == "state.restored" for each in news):
            with suppress(OSError, Damaged):
                try:
                    _parsed(self.path)
                except Damaged:
                    os.replace(self.path, self.path.with_name(f"{self.path.name}.damaged"))
        return state, news

    def write(self, state: StoredState) -> None:
        """Write a state so that it, or the one before, survives whatever happens.

        Raises
        ------
        OSError
            It cannot be written; the files are as they were.
        """
        with replaced(self.path) as draft:
            draft.write_bytes(serialised(state))
            synchronise(draft)
            if self.path.exists():
                _link_or_rename(self.path, previous_path(self.path))
        self._note_owner(state.writes)

    def archive(self, serial: str, time_ns: int) -> Path:
        """Move the file of a bearing that was taken out to a name with its serial number and time, and return that."""
        when = f"{datetime.fromtimestamp(time_ns // 1_000_000_000, UTC):%Y%m%dT%H%M%SZ}"
        number = f"{quote(serial, safe=' ') or 'without_serial'}.{when}"
        archived = self.path.with_name(f"{self.path.stem}.{number}{self.path.suffix or '.json'}")
        previous_path(self.path).unlink(missing_ok=True)
        os.replace(self.path, archived)
        for history in self.path.parent.glob(f"{self.path.stem}.days.*"):
            os.replace(history, history.with_name(f"{self.path.stem}.{number}.days{history.suffix}"))
        synchronise(self.path.parent)
        self._note_owner(0)
        return archived

    def close(self) -> None:
        """Let others use the file; a second call does nothing."""
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _note_owner(self, writes: int) -> None:
        with suppress(OSError):  # a full disk: the lock holds all the same
            data = with_checksum("lock", 1, {"pid": os.getpid(), "writes": writes})
            os.pwrite(self._lock, data, 0)
            os.ftruncate(self._lock, len(data))


def serialised(state: StoredState) -> bytes:
    """Return the contents of a state file."""
    return with_checksum("state", VERSION, state.as_mapping())


def parsed(data: bytes) -> StoredState:
    """Return the state in the contents of a file, of whatever version.

    Raises
    ------
    Damaged
        There is none.
    StateError
        It was written by a newer version of this program.
    """
    version, contents = checked_contents(data, "state")  # version 0 is written by hand
    if version > VERSION:
        raise StateError(f"the state is of version {version}, written by a newer bearing_sim; this one knows versions up to {VERSION}: update it")
    return StoredState.from_mapping(migrated(version, contents))


def _parsed(path: Path) -> StoredState:
    reason = why_not_readable(path)
    if reason == NO_FILE:
        raise FileNotFoundError(path)
    if reason:
        raise StateError(f"the state file {path} cannot be read: {reason}")
    try:
        return parsed(read_bytes(path, STATE_FILE))
    except LimitError as error:
        raise Damaged(error.reason) from None
    except FileError as error:
        raise StateError(f"the state file {path} cannot be read: {error.reason}") from None
    except StateError as error:
        raise StateError(f"{path}: {error}") from None


def _shown(state: StoredState) -> str:
    when = time_text(state.written_ns) if state.written_ns else "an unknown time"
    return f"{when} (write {state.writes}, {100.0 * state.totals.damage:.6g} % of life used)"


def _lock_contents(path: Path) -> dict:
    try:
        return checked_contents(path.read_bytes(), "lock")[1]
    except (OSError, Damaged):
        return {}


def _writes_in_lock(path: Path) -> int:
    writes = _lock_contents(path.with_name(f"{path.name}.lock")).get("writes", 0)
    return writes if isinstance(writes, int) else 0


def _link_or_rename(path: Path, previous: Path) -> None:
    """Let ``previous`` be the file at ``path``, which stays there where the file system has links."""
    linked = previous.with_name(f"{previous.name}.new")
    try:
        linked.unlink(missing_ok=True)
        os.link(path, linked)
    except OSError:
        os.replace(path, previous)
    else:
        os.replace(linked, previous)
