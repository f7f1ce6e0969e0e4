# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A sink that keeps what it is given."""

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, MeasuredClearance, Measurement, ReceivedInputs, Report, Start


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
