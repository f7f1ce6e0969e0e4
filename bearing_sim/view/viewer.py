# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Rerun's native viewer and the servers of views: for programs on this machine only.

The viewer listens by itself, by default to everyone in the network and at the port 9876, which another viewer or a view may have.
"""

import shutil
import socket
import sys
from pathlib import Path

HOST = "127.0.0.1"


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
