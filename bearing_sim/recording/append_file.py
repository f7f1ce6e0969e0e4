# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A file to which whole records are appended, and which stays readable when the disk is full or somebody deletes it."""

import errno
import fcntl
import itertools
import os
import shutil
import time
from contextlib import suppress
from pathlib import Path

from bearing_sim.files.outputs import rename_without_replacing
from bearing_sim.messages.events import Level

_COPY = 1024 * 1024  # [byte] copied at once


class AppendFile:
    """A file being written.

    `write` hands data to the operating system at once and never raises.  When a write fails, the file is cut back to the last whole record,
    `error` says why, and this record and later ones are kept for another try (`retry`).  A file that is deleted or replaced while it is being
    written is restored from its open descriptor.  One thread at a time may use it.

    Parameters
    ----------
    path : must not exist.
    keep_free : free space to leave on the disk [byte]; below it `check` reports an error, which leaves the room to complete the file.

    Attributes
    ----------
    path : of the file; another one after it was replaced.
    error : why writing stopped; None while all is well.
    news : (level, kind, text) of what happened to the file.

    Raises
    ------
    OSError
        It cannot be made.
    """

    def __init__(self, path: Path, keep_free: float = 0.0):
        self.path, self._keep_free = path, keep_free
        self._descriptor = _created(path)
        self._written = 0  # [byte] of whole records in the file
        self._unwritten: list[bytes] = []
        self.error: OSError | None = None
        self.news: list[tuple[Level, str, str]] = []

    def write(self, data: bytes) -> None:
        """Append whole records."""
        self._unwritten.append(data)
        if self.error is None:
            self.retry()

    def tell(self) -> int:
        """Return the length of all records so far [byte], whether they are in the file or not."""
        return self._written + sum(map(len, self._unwritten))

    def retry(self) -> bool:
        """Append the records that could not be written yet; return whether all of them are in the file."""
        while self._unwritten:
            try:
                _write_all(self._descriptor, self._unwritten[0], self._written)
            except OSError as error:
                self._cut_back()
                self._stop(error.errno, f"{self.path} could not be written: {error.strerror}; its first {self._written / 1e6:.4g} MB are whole")
                return False
            self._written += len(self._unwritten.pop(0))
        return True

    def check(self) -> None:
        """Restore the file if somebody deleted it, and stop writing if the disk is nearly full."""
        if self.error is not None:
            return
        try:
            self._restore_if_gone()
            free = shutil.disk_usage(self.path.parent).free
        except OSError as error:
            self._stop(error.errno, f"{self.path} was deleted while it was being written and cannot be restored: {error.strerror}")
            return
        if free < self._keep_free:
            reason = f"{free / 1e6:.3g} MB are free on the disk of {self.path}, less than the {self._keep_free / 1e6:.4g} MB to be kept"
            self._stop(errno.ENOSPC, f"{reason}; recording has stopped, what was written is complete")

    def close(self) -> None:
        """Close the file; records that could not be written are lost."""
        os.close(self._descriptor)
        self._unwritten.clear()

    def _cut_back(self) -> None:
        try:
            os.ftruncate(self._descriptor, self._written)
        except OSError:
            pass  # readers stop at half a record anyway

    def _stop(self, number: int | None, text: str) -> None:
        if self.error is None:
            self.error = OSError(number, text)

    def _restore_if_gone(self) -> None:
        own = os.fstat(self._descriptor)
        try:
            found = os.stat(self.path)
        except FileNotFoundError:
            found = None
        if found is not None and (found.st_dev, found.st_ino) == (own.st_dev, own.st_ino):
            return
        path = self.path if found is None else self.path.with_name(f"{time.time_ns()}_{self.path.name}")
        path.parent.mkdir(parents=True, exist_ok=True)
        restored = _created(path)
        for begin in range(0, self._written, _COPY):
            _write_all(restored, os.pread(self._descriptor, min(_COPY, self._written - begin), begin), begin)
        os.close(self._descriptor)
        self._descriptor = restored
        what = "deleted" if found is None else "replaced by another file"
        text = f"{self.path} was {what} while it was being written; all {self._written / 1e6:.4g} MB of it are in {path}, where writing continues"
        self.path = path
        self.news.append((Level.WARN, "recording.restored", text))


def set_aside(path: Path) -> Path | None:
    """Give the unfinished file of a killed process another name, so that it blocks nobody, and return that; None if a process is writing it.

    Parameters
    ----------
    path : of the unfinished file, such as ``run.mcap.active``, which becomes ``run_killed_1.mcap.active``.
    """
    name, _, suffixes = path.name.partition(".")
    descriptor = os.open(path, os.O_RDWR | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        for number in itertools.count(1):
            other = path.with_name(f"{name}_killed_{number}.{suffixes}")
            with suppress(FileExistsError):
                rename_without_replacing(path, other)
                return other
    except OSError:  # it is locked by its writer, or the file system has no locks
        return None
    finally:
        os.close(descriptor)


def _created(path: Path) -> int:
    """Return the descriptor of a new file, locked, which tells it from what a killed process has left."""
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o644)
    with suppress(OSError):  # a file system without locks
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    return descriptor


def _write_all(descriptor: int, data: bytes, begin: int) -> None:
    left = memoryview(data)
    while left:
        written = os.pwrite(descriptor, left, begin)
        left, begin = left[written:], begin + written
