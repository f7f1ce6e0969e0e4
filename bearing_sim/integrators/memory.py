# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What one-step methods write in a step; nothing in it outlives one."""

from typing import NamedTuple

import numpy as np


class Memory(NamedTuple):
    """Memory of a one-step method; that of a method with a past is `bearing_sim.integrators.history.History`."""

    scratch: np.ndarray  # shape (9, n)


def new_memory(size: int) -> Memory:
    """Return memory for ``size`` states."""
    return Memory(np.zeros((9, size)))
