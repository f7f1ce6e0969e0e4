# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far a recording may go; apart from what writes it, so that asking for one needs no MCAP library."""

import math
from typing import NamedTuple


class Limits(NamedTuple):
    """How far a recording may go.

    Attributes
    ----------
    part_size : length of a file [byte] beyond which the next one begins.
    part_duration : time between its first and last message [s] beyond which the next one begins.
    keep_free : free space that the disk shall keep [byte]; below it the recording stops.
    """

    part_size: float = math.inf
    part_duration: float = math.inf
    keep_free: float = 100e6


UNPARTED = Limits()
