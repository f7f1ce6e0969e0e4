# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A limit with hysteresis and hold times: one piece of news for one trouble, however much the value flickers.

Two stages.  With hysteresis, a value counts as beyond from its limit on, and as back only when it has come back by a share of the
limit.  With hold times, being beyond is told after it has lasted, and being over likewise.  A value that is not a number is back: of
what cannot be told nobody can say that it is too much.
"""

from bearing_sim.scene_monitoring import Hold


class Alarm:
    """Judges one value against one limit.

    Parameters
    ----------
    limit : that the value may not reach; None for none.
    hold : hysteresis and hold times.
    below : whether values below the limit are beyond it, not those from it on.

    Attributes
    ----------
    limit : float or None
    raised : bool
        Whether the trouble holds.
    since : float
        When the value went beyond the limit, of the trouble that holds [s].
    """

    def __init__(self, limit: float | None, hold: Hold, below: bool = False):
        self.limit, self._hold, self._below = limit, hold, below
        self.restart()

    def restart(self) -> None:
        """Forget everything."""
        self.raised, self.since = False, 0.0
        self._beyond, self._turned = False, 0.0

    @property
    def back_at(self) -> float:
        """The value at which it is back."""
        return self.limit * (1.0 + self._hold.hysteresis if self._below else 1.0 - self._hold.hysteresis)

    @property
    def is_alerted(self) -> bool:
        """Whether the value is beyond the limit, or was so lately that the trouble still holds."""
        return self.raised or self._beyond

    def reaches(self, value: float) -> bool:
        """Return whether a value is beyond the limit."""
        return self.limit is not None and (value < self.limit if self._below else value >= self.limit)

    def judge(self, now: float, value: float) -> bool:
        """Take in the value of an instant, which must not lie before the last one.  Returns whether the trouble holds.

        Parameters
        ----------
        now : [s].
        value : in the limit's unit.
        """
        if self.limit is None:
            return False
        beyond = self._is_beyond(value)
        if beyond != self._beyond:
            self._beyond, self._turned = beyond, now
        if beyond and not self.raised and now - self._turned >= self._hold.raise_after:
            self.raised, self.since = True, self._turned
        elif not beyond and self.raised and now - self._turned >= self._hold.clear_after:
            self.raised = False
        return self.raised

    def _is_beyond(self, value: float) -> bool:
        border = self.back_at if self._beyond else self.limit
        return value < border if self._below else value >= border
