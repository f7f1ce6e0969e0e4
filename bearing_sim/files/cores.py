# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The number of cores that this process may use."""

import os


def cores() -> int:
    """Return the number of cores that this process may use: fewer than the machine has where its affinity is restricted."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
