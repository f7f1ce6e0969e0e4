# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What happens in a run besides its samples: events that a person should know about, measurements of the cage, and what else a sink may keep."""

import math
from collections.abc import Iterable, Mapping
from enum import IntEnum
from typing import Any, NamedTuple

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.topics import ALWAYS_KNOWN, Origin


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
    origin : the sender's stamp and frame; None if ``time`` is all that is known.
    """

    time: float
    cage_speed: float
    residual: float
    standard_error: float = math.nan
    origin: Origin | None = None


class MeasuredClearance(NamedTuple):
    """A measured diametral clearance of the running bearing.

    Attributes
    ----------
    time : [s] since the start of the run.
    clearance : [m], negative is preload.
    standard_error : of the clearance [m]; NaN where the sensor does not say.
    origin : as of `Measurement`.
    """

    time: float
    clearance: float
    standard_error: float = math.nan
    origin: Origin | None = None


class ReceivedInputs(NamedTuple):
    """Inputs that arrived.

    Attributes
    ----------
    time : when they were received [s] since the start of the run.
    inputs : the `bearing_sim.simulation.Inputs` of that instant.
    channels : which of them arrived; each channel may have stamps of its own.
    origin : as of `Measurement`.
    """

    time: float
    inputs: Any
    channels: Iterable[str] = ALWAYS_KNOWN
    origin: Origin | None = None


class Start(NamedTuple):
    """The state from which a run starts, a block of one sample, so that the run can be reproduced; it is not an output of the run."""

    block: np.ndarray


class Report(NamedTuple):
    """What holds at a time [s] since the start of the run: events, and values for diagnostics (see `bearing_sim.messages.diagnostics.report`)."""

    time: float
    events: Iterable[Event] = ()
    values: Mapping[str, object] = {}


class Received(NamedTuple):
    """A serialised message as it was recorded; times are [ns since the epoch]."""

    topic: str
    ros_type: str
    log_ns: int
    publish_ns: int
    data: bytes


FOR_KEEPING = Start, ReceivedInputs, Report
"""Records that are for recordings alone."""

Record = np.ndarray | Event | Measurement | MeasuredClearance | Bands | ReceivedInputs | Start | Report | Received
"""What a sink takes; an array is a block of samples (see `bearing_sim.model.sample`), which nobody may change afterwards."""
