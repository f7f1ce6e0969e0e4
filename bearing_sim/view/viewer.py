# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rerun's native viewer, the servers of views, for programs on this machine only, and whether a file for rerun is complete.

The viewer listens by itself, by default to everyone in the network and at the port 9876, which another viewer or a view may have.
"""

import errno
import os
import shutil
import socket
import sys
from pathlib import Path

HOST = "127.0.0.1"
_END_MARK, _END_LENGTH = b"RRF2FOOT", 12  # [byte]: the mark and the number of footers, in files of rerun 0.39 to 0.41


def free_port() -> int:
    """Return a port on 127.0.0.1 that nobody uses."""
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return probe.getsockname()[1]


def stream_url(port: int) -> str:
    """Return where viewers find a view that is served at a port on 127.0.0.1."""
    return f"rerun+http://{HOST}:{port}/proxy"


def viewer_command(shown: str) -> list[str] | None:
    """Return the command that opens a recording or the URL of a view; None if the viewer is not installed."""
    beside = Path(sys.executable).with_name("rerun")
    found = shutil.which("rerun") or (str(beside) if beside.is_file() else None)
    return None if found is None else [found, "--bind", HOST, "--port", "auto", shown]


def is_complete(path: str | Path) -> bool:
    """Return whether a file for rerun has its end, which is missing after a failed write: rerun itself only logs that."""
    with open(path, "rb") as file:
        file.seek(0, os.SEEK_END)
        file.seek(max(0, file.tell() - _END_LENGTH))
        return file.read().startswith(_END_MARK)


def incomplete(reason: str | None) -> OSError:
    """Return the error of a file for rerun that is not complete; ``reason`` is that of rerun, if it gave one."""
    return OSError(errno.EIO, f"the file for rerun could not be written completely ({reason or 'it has no end'}); is the disk full?")
