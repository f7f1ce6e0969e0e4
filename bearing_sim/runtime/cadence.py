# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How long the ticks of a run in real time are: short enough for its outputs, and no shorter.

At cheap levels most of what a tick costs does not depend on its length.
"""

import math
from typing import NamedTuple

SHORTEST_LIMIT, LONGEST_TICK = 0.005, 0.010  # [s] outputs can be published at 200 Hz; inputs act the longest tick late at most
_WHOLE = 1e-6  # how near a number of ticks is to a whole one that counts as one


class Cadence(NamedTuple):
    """How a sample rate is made of ticks."""

    tick: float  # [s]
    samples: int  # in the block of one tick
    every: int  # blocks from one that goes to the sinks to the next


def tick_limit(publish_rate: float) -> float:
    """Return how long a tick may be [s]: half a period of outputs that are published so often [Hz], within the bounds of this module."""
    return min(max(0.5 / publish_rate, SHORTEST_LIMIT), LONGEST_TICK)


def cadence(sample_rate: float, publish_rate: float) -> Cadence:
    """Return ticks that give a sample rate exactly.

    They are no longer than `tick_limit` where a period of the outputs is a whole number of them, so that outputs come evenly, else no
    longer than `SHORTEST_LIMIT`.

    Parameters
    ----------
    sample_rate : samples for each simulated second that sinks get [Hz].
    publish_rate : outputs that are due to be published in each second [Hz].
    """
    long = _cadence(sample_rate, tick_limit(publish_rate))
    ticks = 1.0 / (publish_rate * long.tick)
    return long if abs(ticks - round(ticks)) < _WHOLE else _cadence(sample_rate, SHORTEST_LIMIT)


def _cadence(sample_rate: float, longest: float) -> Cadence:
    samples = max(1, math.floor(sample_rate * longest * (1 + 1e-9)))
    every = max(1, math.ceil(1 / (sample_rate * longest) * (1 - 1e-9)))
    return Cadence(samples / (sample_rate * every), samples, every)
