# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""From the damage of a run to the life that its bearing has used: what was used before is added, and no time is counted twice."""

import numpy as np

from bearing_sim.watchers.stored_state.covered import Covered


class LifeCounter:
    """Writes the life used by the bearing in place of the damage of a run.

    The sum is D = D_before + (D_run - D_twice), with D_twice the damage of times that the bearing's totals contain already.  It does not depend
    on how the samples are divided into blocks, so that a recorded run repeats to the last digit.

    Parameters
    ----------
    used : fraction of life used before the run, D_before.
    covered : times that are not counted again, of a log that is replayed; None for a bearing that is running now, of which all time counts.
    """

    def __init__(self, used: float, covered: Covered | None = None):
        self._covered = covered
        self.restart(used)

    def restart(self, used: float) -> None:
        """Begin another run, whose damage begins at 0, after ``used`` of the life."""
        self._before, self._run, self._twice = used, 0.0, 0.0

    def count(self, block: np.ndarray, times_ns: np.ndarray, seconds: np.ndarray) -> np.ndarray | None:
        """Write the life used into samples, and return the fraction of their time that counts, shape (n,); None where all of it does.

        Parameters
        ----------
        block : samples in order with the damage of the run, shape (n,); see `bearing_sim.model.sample`.
        times_ns : of the samples [ns since the epoch], shape (n,), int64.
        seconds : simulated time that each stands for [s], shape (n,).
        """
        run, counted = block["damage"].copy(), None
        if self._covered is not None and len(self._covered) and len(block):
            twice = self._covered.fractions(times_ns - np.rint(1e9 * seconds).astype(np.int64), times_ns)
            if twice.any():
                counted = 1.0 - twice
                used_twice = twice * np.maximum(np.diff(run, prepend=self._run), 0.0)
                twice_used = np.cumsum(np.concatenate(([self._twice], used_twice)))[1:]  # one after the other, however blocks are divided
                self._twice = float(twice_used[-1])
                block["damage"] = self._before + (run - twice_used)
        if len(block):
            self._run = float(run[-1])
        if counted is None:
            block["damage"] = self._before + (run - self._twice)
        return counted
