# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""An append-only journal of finished tasks: after a kill, at whatever instant, nothing that stands in it is computed again.

One line of JSON a task.  A line that a kill cut short is no result, and is cut off before the next one is written.
"""

import fcntl
import json
import os
import time
from pathlib import Path

_SYNC = 1.0  # s between writes forced to the disk; a kill of the process needs none, a power cut loses that much


class JournalInUse(RuntimeError):
    """Another process is writing this journal."""


class Journal:
    """Results by the keys of their tasks, on disk where a path is given; a context manager.

    Parameters
    ----------
    path : of the journal, made where absent; None keeps results in memory only.

    Raises
    ------
    JournalInUse
        Another process is writing it.
    """

    def __init__(self, path: Path | None = None):
        self.path, self._file, self._synced = path, None, 0.0
        self._results: dict[str, dict] = {}
        if path is not None:
            self._open(path)

    def _open(self, path):
        path.parent.mkdir(parents=True, exist_ok=True)
        file = open(path, "a+b")
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            file.close()
            raise JournalInUse(f"{path}: another process is writing it; wait for its end, or give another output") from None
        file.seek(0)
        whole = 0
        for line in file:
            if not line.endswith(b"\n"):
                break
            whole += len(line)
            try:
                entry = json.loads(line)
                self._results[entry["key"]] = entry["result"]
            except (ValueError, KeyError, TypeError):
                continue  # a line that no journal wrote says nothing, and its task is computed anew
        file.truncate(whole)
        self._file = file

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __contains__(self, key: str) -> bool:
        return key in self._results

    def __getitem__(self, key: str) -> dict:
        return self._results[key]

    def __len__(self) -> int:
        return len(self._results)

    def add(self, key: str, result: dict) -> None:
        """Keep the result of a task; it has survived a kill once this returns."""
        self._results[key] = result
        if self._file is None:
            return
        self._file.write(json.dumps({"key": key, "result": result}).encode() + b"\n")
        self._file.flush()
        if time.monotonic() - self._synced > _SYNC:
            os.fsync(self._file.fileno())
            self._synced = time.monotonic()

    def close(self) -> None:
        """Write to the disk what is not there yet, and let others have the file."""
        if self._file is not None:
            self._file.flush()
            os.fsync(self._file.fileno())
            self._file.close()
            self._file = None
