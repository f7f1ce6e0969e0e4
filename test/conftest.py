# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What all tests share: hypothesis without deadlines (the first call compiles) and the same examples every time; a strict rerun."""

import pytest
from hypothesis import settings

settings.register_profile("bearing_sim", deadline=None, derandomize=True)
settings.load_profile("bearing_sim")


@pytest.fixture
def strict_rerun():
    """Let rerun raise where it would only log what it cannot use, and lose it."""
    import rerun as rr

    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)
