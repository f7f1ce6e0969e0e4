# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Threads by name for the system's own tools (top -H, /proc): Python keeps names to itself before 3.14."""

import threading
from pathlib import Path

SOLVER = "bearing-solver"
_LONGEST = 15  # letters that Linux keeps


def name_this_thread(name: str) -> None:
    """Let the system know the running thread by a name; nothing happens where it does not take names this way."""
    try:
        Path(f"/proc/self/task/{threading.get_native_id()}/comm").write_text(name[:_LONGEST])
    except OSError:
        pass
