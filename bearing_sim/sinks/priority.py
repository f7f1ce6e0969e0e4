# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Processes of sinks let the solver have the processor first."""

import os
from contextlib import suppress
from pathlib import Path


def give_way(niceness: int) -> None:
    """Lower the priority of this process: a lower share of the processor where it is short, and no interruption of others on waking up.

    Where the system shares the processor by sessions (Linux's autogroups), one with a session of its own must say so, too.
    """
    os.nice(niceness)
    with suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    if hasattr(os, "getsid") and os.getsid(0) == os.getpid():
        with suppress(OSError):
            Path("/proc/self/autogroup").write_text(str(niceness))
