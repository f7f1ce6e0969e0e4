# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Waiting for what another process or thread does."""

import time


def wait_for(condition, seconds=60.0):
    """Return what a condition gives as soon as that is true; fail after so many seconds of wall time, which a busy machine may need."""
    limit = time.monotonic() + seconds
    while not (found := condition()) and time.monotonic() < limit:
        time.sleep(0.02)
    assert found, "waited in vain"
    return found
