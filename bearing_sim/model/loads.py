# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The largest loads of rollers, whatever the interval of the samples."""

import numpy as np


def largest_loads(samples: np.ndarray, ring: str) -> np.ndarray:
    """Return the largest normal force between any roller and a raceway since the sample before [N], shape (n,).

    A sample's own loads are those of an instant: at constant speed samples meet the rollers at places that wander slowly, and their largest load
    swings although the bearing's does not.  They are the answer only where a recording of an earlier version holds nothing else.

    Parameters
    ----------
    samples : shape (n,), see `bearing_sim.model.sample`.
    ring : ``inner`` or ``outer``.
    """
    return np.fmax(samples[f"{ring}_load_maximum"], samples[f"{ring}_load"].max(axis=-1))
