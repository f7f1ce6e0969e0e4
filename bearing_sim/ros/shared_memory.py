# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Remove ports of Fast DDS in shared memory that a killed program has left unfinished: who opens one waits for ever.

A program makes a file in /dev/shm for each port that it receives on.  If it is killed while it does so, the file is never marked as
initialised.  The next program with the same port then waits in C++ for the mark: it prints nothing, and no signal but SIGKILL ends it.
"""

import sys
import time
from pathlib import Path

SHARED_MEMORY = Path("/dev/shm")
_PORTS = "fastrtps_port*"  # of Fast DDS 2 and 3
_LOCKS = ("_el", "_sl")  # empty files beside those of the ports
_INITIALISED = (2).to_bytes(4, sys.byteorder)  # InitializedSegment, the first word of a file (Boost.Interprocess, managed_open_or_create_impl.hpp)
_PATIENCE = 5.0  # [s] for what takes a running program microseconds


def remove_unfinished_ports(folder: Path = SHARED_MEMORY, patience: float = _PATIENCE) -> list[str]:
    """Remove ports that nobody has finished for some time; to be called before the first node is made.

    Parameters
    ----------
    folder : where shared memory has its files; without it there is nothing to do.
    patience : how long a port may take to be made [s].  The call lasts as long at most, and no time at all where every port is finished.

    Returns
    -------
    What to tell the user: a sentence for each port found.
    """
    end = time.monotonic() + patience
    unfinished = [path for path in sorted(folder.glob(_PORTS)) if _is_unfinished(path)]
    while time.monotonic() < end and any(_age(path) <= patience for path in unfinished):
        time.sleep(0.05)
        unfinished = [path for path in unfinished if _is_unfinished(path)]  # a port that is begun meanwhile is not one that was left
    return [_remove(path) for path in unfinished]


def _is_unfinished(path: Path) -> bool:
    if path.name.endswith(_LOCKS):
        return False
    try:
        with open(path, "rb") as file:
            return file.read(len(_INITIALISED)) != _INITIALISED
    except OSError:  # gone in the meantime, or another user's, whose ports cannot be opened anyway
        return False


def _age(path: Path) -> float:
    try:
        return time.time() - path.stat().st_mtime
    except FileNotFoundError:
        return 0.0


def _remove(path: Path) -> str:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        return f"{path}: a program was killed while making this port, for which others wait for ever; its owner must remove it ({error.strerror})"
    return f"{path}: removed a port that a program was killed while making; others would have waited for it for ever"
