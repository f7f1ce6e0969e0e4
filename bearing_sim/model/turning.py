# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the shaft of a run turns, so that slip has a meaning."""

import numpy as np

_LEAST = 0.01  # of the largest speed of a run


def turns(speeds: np.ndarray, fastest: float | None = None) -> np.ndarray:
    """Return whether the shaft turns: at a hundredth of the largest speed of its run or faster.  Just above rest the slip may have any size.

    Parameters
    ----------
    speeds : of the shaft, in any unit, shape (n,); it does not turn where one is NaN.
    fastest : the largest speed of the run, if these are not all of its speeds.
    """
    speeds = np.abs(speeds)
    return (speeds > 0.0) & (speeds >= _LEAST * (np.nanmax(speeds, initial=0.0) if fastest is None else fastest))
