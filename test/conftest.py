# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What all tests share: hypothesis without deadlines (the first call compiles) and the same examples every time."""

from hypothesis import settings

settings.register_profile("bearing_sim", deadline=None, derandomize=True)
settings.load_profile("bearing_sim")
