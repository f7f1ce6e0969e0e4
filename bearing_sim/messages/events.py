# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What happens in a run besides its samples: events that a person should know about, and measurements of the cage."""

import math
from enum import IntEnum
from typing import NamedTuple


class Level(IntEnum):
    """Severity, numbered as diagnostic_msgs/DiagnosticStatus."""

    OK = 0
    WARN = 1
    ERROR = 2


class Event(NamedTuple):
    """An event of a run.  Programs read its fields; only people read `text`.

    Attributes
    ----------
    time : [s] since the start of the run.
    level : severity.
    kind : stable identifier for filters and counters, such as ``"input.not_finite"``.
    subject : what the event is about, such as an input channel or a sink; ``""`` for the run as a whole.
    reason : what is wrong, where, and what was expected.
    action : what was done about it; ``""`` for nothing.
    count : how many events of this kind and subject this one stands for.
    """

    time: float
    level: Level
    kind: str
    subject: str
    reason: str
    action: str = ""
    count: int = 1

    @property
    def key(self) -> tuple[str, str]:
        """Kind and subject: events with the same key report the same trouble."""
        return self.kind, self.subject

    @property
    def text(self) -> str:
        """The event as a sentence: ``subject: reason; action (count times)``, without the parts that are empty."""
        text = f"{self.subject}: {self.reason}" if self.subject else self.reason
        if self.action:
            text = f"{text}; {self.action}"
        return text if self.count == 1 else f"{text} ({self.count} times)"


def validity_event(time: float, exceedance) -> Event:
    """Return the event of a law that is used outside of its range: a warning, or for the record alone where it has no effect or is an assumption.

    Parameters
    ----------
    time : [s] since the start of the run.
    exceedance : `bearing_sim.model.validity.Exceedance`.
    """
    law, level = exceedance.law, Level.WARN if exceedance.grade == "warning" else Level.OK
    return Event(time, level, law.kind, law.name, f"{law.law}: {exceedance.finding}; {exceedance.grade}: {exceedance.said_effect}", law.instead)


class Measurement(NamedTuple):
    """A measured cage speed.

    Attributes
    ----------
    time : [s] since the start of the run.
    cage_speed : [rad/s].
    residual : measured minus predicted cage slip, a fraction; NaN where there is no prediction to compare with.
    standard_error : of the cage speed [rad/s]; NaN where the sensor does not say.
    """

    time: float
    cage_speed: float
    residual: float
    standard_error: float = math.nan


class MeasuredClearance(NamedTuple):
    """A measured diametral clearance of the running bearing.

    Attributes
    ----------
    time : [s] since the start of the run.
    clearance : [m], negative is preload.
    standard_error : of the clearance [m]; NaN where the sensor does not say.
    """

    time: float
    clearance: float
    standard_error: float = math.nan
