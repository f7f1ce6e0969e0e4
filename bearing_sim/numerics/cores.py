# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How many cores there are for this process."""

import os


def cores() -> int:
    """Return how many cores this process may use, which are fewer than the machine has where it was given some of them only."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
