# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A file to which whole records are appended, and which can be completed when the disk is full and stays readable when somebody deletes it."""

import errno
import fcntl
import itertools
import os
import shutil
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from bearing_sim.files.outputs import rename_without_replacing
from bearing_sim.messages.events import Level

NO_SPACE = (errno.ENOSPC, errno.EDQUOT)
"""Numbers of the errors of a full disk."""
_COPY = 1024 * 1024  # [byte] copied at once
# [byte] reserved for the end of a file: half of it for the chunk in progress, schemas, channels and the metadata of a bag, which take 0.1 MB with all
# topics; the other half, and more as the file grows, for its index: 0.4 kB for a chunk of some 40 kB.
_END, _END_PER_BYTE = 256 * 1024, 1 / 32


class AppendFile:
    """A file being written.

    `write` hands data to the operating system at once and never raises.  When a write fails, the file is cut back to the last whole record,
    `error` says why, and this record and later ones are kept for another try (`retry`).  Space on the disk is reserved for the end of the file, so
    that `complete` succeeds on a full disk.  A file that is deleted or replaced while it is being written is restored from its open descriptor.
    One thread at a time may use it.

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
        It cannot be made, or there is no space for its end.
    """

    def __init__(self, path: Path, keep_free: float = 0.0):
        self.path, self._keep_free = path, keep_free
        self._descriptor = _created(path)
        try:
            self._reserve = _Reserve(path.parent)
        except OSError as error:
            os.close(self._descriptor)
            path.unlink(missing_ok=True)
            raise OSError(error.errno, f"{path} cannot be begun: {error.strerror}") from None
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
        if self.error is None:
            try:
                self._reserve.hold(_END // 2 + round(self._written * _END_PER_BYTE))
            except OSError as error:
                written = f"{self._written / 1e6:.4g} MB"
                self._stop(error.errno, f"{self.path} could not be continued: {error.strerror}; there is space to complete its {written}")
        return True

    def complete(self) -> bool:
        """Append the records that could not be written yet, in the space that was reserved; return whether all of them are in the file."""
        self._reserve.release()
        return self.retry()

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
        self._reserve.release()
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


class _Reserve:
    """Space on a disk that nobody else can take: a file without a name, of which nothing is left when the process ends.

    Without effect where the system or the file system cannot reserve space.

    Parameters
    ----------
    folder : on that disk.

    Raises
    ------
    OSError
        There is not enough space.
    """

    def __init__(self, folder: Path):
        self._file, self._held = None, 0
        if hasattr(os, "posix_fallocate"):
            self._file = tempfile.TemporaryFile(dir=folder, buffering=0)
        try:
            self.hold(_END)
        except OSError:
            self.release()
            raise

    def hold(self, size: int) -> None:
        """Reserve so many bytes; a little more is reserved at once so that this is rarely done."""
        if self._file is None or size <= self._held:
            return
        wanted = max(size, self._held + _END) if self._held else size
        try:
            os.posix_fallocate(self._file.fileno(), 0, wanted)
        except OSError as error:
            if error.errno in NO_SPACE:
                raise
            self.release()
        self._held = wanted

    def release(self) -> None:
        """Give the space back."""
        if self._file is not None:
            self._file.close()
            self._file = None


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
