# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Events: what a person should be told, with level, code, reason and time."""

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
