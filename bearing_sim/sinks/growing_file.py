# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A file that grows by whole records, written behind the back of whoever fills it, and that survives what happens to files."""

import errno
import os
import shutil
import time
from collections import deque
from pathlib import Path
from threading import Condition, Lock

from bearing_sim.events import Level

_LONGEST_BACKLOG = 64 * 1024 * 1024  # [byte] waiting for the disk
_LONGEST_WAIT = 10.0  # [s] for a disk that takes nothing
_COPY = 1024 * 1024  # [byte]


class GrowingFile:
    """A file being written.

    ``write`` only puts data down; ``drain``, usually called by another thread, hands it to the operating system, without the
    interpreter's lock.  When that fails the file is cut back to the last record that is whole, and what could not be written
    is kept for another try at the end.  A file deleted or replaced meanwhile is written anew from its open descriptor.

    Parameters
    ----------
    path : must not exist.
    keep_free : free space that the disk shall keep [byte]; below it writing stops, with the room to complete the file left.

    Raises
    ------
    OSError
        It cannot be made.
    """

    def __init__(self, path: Path, keep_free: float = 0.0):
        self.path, self._keep_free = path, keep_free
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0), 0o644)
        self._changed = Condition()
        self._at_disk = Lock()  # whoever writes and restores: one at a time, or something would be written twice
        self._waiting: deque[bytes] = deque()
        self._backlog = 0
        self._length = self._safe = 0
        self.fault: OSError | None = None
        self.news: deque[tuple[Level, str, str]] = deque()

    def write(self, data: bytes) -> int:
        """Take whole records in; waits where the disk is far behind."""
        with self._changed:
            if self._backlog > _LONGEST_BACKLOG and not self._changed.wait_for(lambda: self._backlog <= _LONGEST_BACKLOG, _LONGEST_WAIT):
                self._stop(OSError(errno.EIO, f"the disk of {self.path} has taken nothing for {_LONGEST_WAIT:g} s"))
            self._waiting.append(data)
            self._backlog += len(data)
            self._length += len(data)
        return len(data)

    def tell(self) -> int:
        """Return the length of all that was taken in [byte]."""
        return self._length

    def flush(self) -> None:
        """Do nothing: `drain` does it."""

    @property
    def backlog(self) -> int:
        """Bytes that wait for the disk."""
        return self._backlog

    @property
    def saved(self) -> int:
        """Bytes that the operating system has."""
        return self._safe

    def watch(self) -> None:
        """Look after the file: restore it where it was deleted, stop where the disk is nearly full."""
        if self.fault is not None:
            return
        try:
            with self._at_disk:
                self._restore_if_gone()
            free = shutil.disk_usage(self.path.parent).free
        except OSError as fault:
            self._stop(OSError(fault.errno, f"{self.path} was deleted under the writer and cannot be written anew: {fault.strerror}"))
            return
        if free < self._keep_free:
            told = f"{free / 1e6:.3g} MB are free on the disk of {self.path}, less than the {self._keep_free / 1e6:.4g} MB to be kept"
            self._stop(OSError(errno.ENOSPC, f"{told}; recording has stopped, what was written is complete"))

    def drain(self, despite_fault: bool = False) -> None:
        """Hand what waits to the operating system; a fault is kept in ``fault``."""
        with self._at_disk:
            if self.fault is None or despite_fault:
                self._drain()

    def _drain(self) -> None:
        while self._waiting:
            data = self._waiting[0]
            try:
                self._put(data)
            except OSError as fault:
                self._cut_back()
                told = f"{self.path} could not be written: {fault.strerror}; the first {self._safe / 1e6:.4g} MB are in it"
                self._stop(OSError(fault.errno, told))
                return
            with self._changed:
                self._waiting.popleft()
                self._backlog -= len(data)
                self._changed.notify_all()

    def close(self) -> None:
        """Close the descriptor; what still waits is lost."""
        os.close(self._descriptor)
        with self._changed:
            self._waiting.clear()
            self._backlog = 0

    def _put(self, data: bytes) -> None:
        _write_all(self._descriptor, data, self._safe)
        self._safe += len(data)

    def _cut_back(self) -> None:
        try:
            os.ftruncate(self._descriptor, self._safe)
        except OSError:
            pass  # readers stop at half a record anyway

    def _stop(self, fault: OSError) -> None:
        if self.fault is None:
            self.fault = fault

    def _restore_if_gone(self) -> None:
        own = os.fstat(self._descriptor)
        try:
            there = os.stat(self.path)
        except FileNotFoundError:
            there = None
        if there is not None and (there.st_dev, there.st_ino) == (own.st_dev, own.st_ino):
            return
        path = self.path if there is None else self.path.with_name(f"{time.time_ns()}_{self.path.name}")
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = os.open(path, os.O_RDWR | os.O_CREAT | os.O_EXCL | getattr(os, "O_CLOEXEC", 0), 0o644)
        for place in range(0, self._safe, _COPY):
            data = os.pread(self._descriptor, min(_COPY, self._safe - place), place)
            _write_all(fresh, data, place)
        os.close(self._descriptor)
        self._descriptor = fresh
        happened = "deleted" if there is None else "replaced by another file"
        text = f"{self.path} was {happened} while it was being written; all {self._safe / 1e6:.4g} MB of it are in {path}, where writing goes on"
        self.path = path
        self.news.append((Level.WARN, "recording.restored", text))


def _write_all(descriptor: int, data: bytes, place: int) -> None:
    left = memoryview(data)
    while left:
        written = os.pwrite(descriptor, left, place)
        left, place = left[written:], place + written
