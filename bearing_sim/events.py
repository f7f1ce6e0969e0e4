# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What happens in a run besides its samples: events, which a person should be told, and measurements of the cage."""

from enum import IntEnum
from typing import NamedTuple


class Level(IntEnum):
    """Severity, numbered as diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


class Event(NamedTuple):
    """One thing that happened.

    ``code`` is a stable word for filters and counters (``"input.not_finite"``); ``text`` says what is wrong,
    where, what was expected and what was done about it.
    """

    time: float  # [s] since the start of the run
    level: Level
    code: str
    text: str


class Measurement(NamedTuple):
    """A measured cage speed.

    Attributes
    ----------
    time : [s] since the start of the run.
    cage_speed : [rad/s].
    residual : measured less predicted cage slip, a fraction; NaN where there is nothing to compare with.
    """

    time: float
    cage_speed: float
    residual: float
