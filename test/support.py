# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What many tests need: a sink that keeps what it is given, waiting for others, measured files."""

import time
from pathlib import Path

import numpy as np
import pytest

import bearing_sim
from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, MeasuredClearance, Measurement, ReceivedInputs, Report, Start

FOLDER = Path(bearing_sim.__file__).resolve().parents[2] / "shared" / "data"
"""Measured files that are not redistributable, and so not in the repository."""


def measured_file(name: str) -> Path:
    """Return the path of a measured file; a test without it is skipped and says so."""
    path = FOLDER / name
    if not path.exists():
        pytest.skip(f"the measured data {name} are not redistributable and not here; expected in ../shared/data beside the repository")
    return path


def wait_for(condition, seconds=60.0):
    """Return what a condition gives as soon as that is true; fail after so many seconds of wall time, which a busy machine may need."""
    limit = time.monotonic() + seconds
    while not (found := condition()) and time.monotonic() < limit:
        time.sleep(0.02)
    assert found, "waited in vain"
    return found


class ListSink:
    """Keeps every record; a recorder unless told otherwise; fails on demand."""

    def __init__(self, start_ns=0, fails=False, keeps_all=True):
        self.start_ns, self.fails, self.keeps_all, self.records, self.closed = start_ns, fails, keeps_all, [], 0

    def write(self, record):
        if self.fails:
            raise OSError("no space left on device")
        self.records.append(record.copy() if isinstance(record, np.ndarray) else record)

    def close(self):
        self.closed += 1

    def of(self, kind):
        return [record for record in self.records if isinstance(record, kind)]

    @property
    def blocks(self):
        return self.of(np.ndarray)

    @property
    def with_start(self):
        """Blocks of samples, the state at the start among them."""
        return [record.block if isinstance(record, Start) else record for record in self.of((np.ndarray, Start))]

    @property
    def events(self):
        return self.of(Event)

    @property
    def bands(self):
        return self.of(Bands)

    @property
    def inputs(self):
        return [(time, inputs, tuple(channels)) for time, inputs, channels, _ in self.of(ReceivedInputs)]

    @property
    def measurements(self):
        return [record[:3] for record in self.of(Measurement)]

    @property
    def clearances(self):
        return [record[:3] for record in self.of(MeasuredClearance)]

    @property
    def diagnostics(self):
        return [(time, list(events), values) for time, events, values in self.of(Report)]
