# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How far the receiver's clock is ahead of the monotonic one, and whether it was set."""

import math
from collections.abc import Callable

_JUMP = 1.0  # [s] from one look to the next: a clock that is set, not one that is kept right
_LATE = 0.1  # [s] by which a reading may be old
_TRIES = 5  # to read two clocks at one moment


class WallClock:
    """Looks whether the receiver's clock jumps.

    A thread may stand still between its reading of one clock and of the other: on a busy machine, where many threads want the interpreter's
    lock, for a second and more.  So where a reading is out of step, both clocks are read again.

    Parameters
    ----------
    now_ns : the receiver's clock [ns since the epoch].
    monotonic : the monotonic clock [s].
    receiver : reads the receiver's clock [ns since the epoch]; where absent, every reading that is brought is taken to be of its moment.
    """

    def __init__(self, now_ns: int, monotonic: Callable[[], float], receiver: Callable[[], int] | None = None):
        self._monotonic, self._receiver = monotonic, receiver
        self._ahead = math.inf  # so that the first reading is out of step
        self.jump(now_ns)

    def jump(self, now_ns: int) -> float:
        """Return by how much the receiver's clock was set since the last look [s]; 0 where it goes on, or where that cannot be told now.

        Parameters
        ----------
        now_ns : a reading of it, of just now [ns since the epoch].
        """
        ahead = now_ns * 1e-9 - self._monotonic()
        if self._receiver is not None and abs(ahead - self._ahead) > _LATE:
            ahead = self._at_one_moment()
        if math.isnan(ahead):
            return 0.0
        jump, self._ahead = ahead - self._ahead, ahead
        return jump if _JUMP < abs(jump) < math.inf else 0.0

    def _at_one_moment(self) -> float:
        """Return how far the receiver's clock is ahead [s]; NaN where the two could not be read at one moment."""
        for _ in range(_TRIES):
            before, now_ns, after = self._monotonic(), self._receiver(), self._monotonic()
            if after - before < _LATE:
                return now_ns * 1e-9 - 0.5 * (before + after)
        return math.nan
