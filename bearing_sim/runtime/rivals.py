# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Several senders on one input: told as such, and worse where their values jump to and fro, because then they disagree.

Pure: values and counts in, events out.
"""

from collections import deque

from bearing_sim.events import Event, Level

_REMEMBERED = 16  # messages of a channel
_TOLERANCE = 0.02  # of the largest value: senders that differ by less measure the same thing
_TURNS = 4  # large jumps against the jump before, among the remembered: one or two are a manoeuvre


class Rivals:
    """Watches one input channel.

    Parameters
    ----------
    channel : its name.
    unit : of its values, for the text.
    """

    def __init__(self, channel: str, unit: str):
        self._channel, self._unit = channel, unit
        self._values: deque[tuple[float, ...]] = deque(maxlen=_REMEMBERED)
        self.senders = 1

    def take(self, values: tuple[float, ...]) -> None:
        """Take in the values of an accepted message; of a force its components."""
        self._values.append(values)

    @property
    def disagreement(self) -> tuple[float, float] | None:
        """The least and the largest of the newest values where these jump to and fro by more than senders of the same thing would; else None."""
        if len(self._values) < _REMEMBERED:
            return None
        return next(((min(series), max(series)) for series in zip(*self._values) if _jumps_to_and_fro(series)), None)

    def event(self, now: float) -> Event | None:
        """Return what is to be told as of ``now`` [s]; None where there is one sender."""
        if self.senders < 2:
            return None
        text = f"{self._channel}: {self.senders} publishers, expected one; "
        if extremes := self.disagreement:
            low, high = extremes
            text += f"they disagree, values jump between {low:.6g} and {high:.6g} {self._unit}; the newest is used, which is wrong for one of them"
            return Event(now, Level.ERROR, "input.publishers", text)
        return Event(now, Level.WARN, "input.publishers", f"{text}the newest value of any is used")


def _jumps_to_and_fro(values: tuple[float, ...]) -> bool:
    least = _TOLERANCE * max(map(abs, values))
    jumps = [after - before for before, after in zip(values, values[1:]) if abs(after - before) > least]
    return sum(first * second < 0.0 for first, second in zip(jumps, jumps[1:])) >= _TURNS
