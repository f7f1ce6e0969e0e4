# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Messages that come on the wrong side of a clock's jump back.

Messages and clock come on different topics: those from after the jump may come before it is known, those from before it afterwards.  A
message stamped before the newest of its channel is set aside for a second of wall time, in which the jump may become known; after the
jump, messages stamped beyond the newest from before it are left out, until their channel has come back too or the clock has been there.
"""

from collections import deque
from collections.abc import Mapping
from enum import Enum
from typing import NamedTuple

_SET_ASIDE = 1.0  # [s of wall time]


class Message(NamedTuple):
    """One message of an input."""

    channel: str
    values: tuple[float, ...]  # SI
    stamp: int  # [ns since the epoch]


class Side(Enum):
    """On which side of a jump a message is."""

    HERE = "to be judged like any other"
    ASIDE = "from after a jump that is not known yet, or faulty"
    BEYOND = "left over from before the jump"


class Stragglers:
    """Sorts the messages of one model."""

    def __init__(self):
        self._aside: deque[tuple[float, Message]] = deque()
        self._left: dict[str, int] = {}

    def sort(self, message: Message, newest: int | None, wall: float) -> Side:
        """Return on which side a message is, and keep it where it is to be set aside.

        Parameters
        ----------
        message : that has come.
        newest : stamp of the newest good message of its channel on this side of the jump [ns since the epoch]; None for none.
        wall : wall time [s].
        """
        if message.stamp > self._left.get(message.channel, message.stamp):
            return Side.BEYOND
        if newest is not None and message.stamp < newest:
            self._aside.append((wall, message))
            return Side.ASIDE
        self._left.pop(message.channel, None)
        return Side.HERE

    def jump(self, clock: int, newest: Mapping[str, int]) -> list[Message]:
        """Take in a jump back and return the messages from after it that have come already.

        Of those aside it is the ones stamped nearer to the clock than to the newest: the others were faulty before the jump.

        Parameters
        ----------
        clock : where it has jumped to [ns since the epoch].
        newest : of each channel the newest stamp from before the jump [ns since the epoch].
        """
        self._left = {channel: stamp for channel, stamp in newest.items() if stamp > clock}
        aside, self._aside = self._aside, deque()
        middle = 0.5 * (clock + max(newest.values(), default=clock))
        return [message for _, message in aside if message.stamp <= middle]

    def pass_by(self, clock: int) -> None:
        """Take in that the clock has come to ``clock`` [ns since the epoch]."""
        self._left = {channel: stamp for channel, stamp in self._left.items() if stamp > clock}

    def faulty(self, wall: float) -> list[Message]:
        """Return the messages that were set aside although no jump became known, as of the wall time [s]."""
        found = []
        while self._aside and wall - self._aside[0][0] > _SET_ASIDE:
            found.append(self._aside.popleft()[1])
        return found
