# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bands of a recorded run, computed again from its samples and measurements, and how far they are from those that it recorded.

Bands follow from the samples at their instants.  Calibrated ones follow from every measurement since the start as well, in the order in which the
run took them; what a recording does not contain is a call of ``~/accept_change``, after which they differ.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from bearing_sim.messages.bands import ESTIMATES, Bands
from bearing_sim.messages.topics import INPUTS, MEASURED_CHANNELS
from bearing_sim.model.turning import turns
from bearing_sim.recording.reader import Received, Recording, measured_numbers
from bearing_sim.watchers.monitoring.watchers import Run

_NEAR = 0.1  # of the width of a band


@dataclass
class BandDifference:
    """How the bands of one quantity differ from the recorded ones.

    Attributes
    ----------
    compared : instants that both have; of results those at which the shaft turns (`thresholds.slip_from_speed`), because near rest slip may be
        anything.
    near : those of them at which value and both quantiles are within a tenth of the width of the recorded band.
    missing, further : instants of the recording only, and of the reproduction only.
    largest : largest difference of value, 5 or 95 % quantile over the width of the recorded band there; infinite where only one of two is finite.
    at : time of that [s].
    """

    compared: int = 0
    near: int = 0
    missing: int = 0
    further: int = 0
    largest: float = 0.0
    at: float = 0.0


def first_bands(recording: Recording) -> float | None:
    """Return the time of the first bands of a recording [s]; None where it has none."""
    return next((float(bands.times[0]) for bands in recording.bands()), None)


class ReproducedBands:
    """Computes the bands of a run again.

    Parameters
    ----------
    run : that is computed again; its watchers estimate.
    first : time of the first bands of the recording [s]: what comes before was not estimated.
    together : samples that a call of the run returned, which were estimated together.

    Attributes
    ----------
    differences : by quantity or calibrated field.
    """

    def __init__(self, run: Run, first: float, together: int):
        self._run, self._first, self._together = run, first, together
        self._slowest = run.scene.thresholds.slip_from_speed
        self._waiting: tuple[dict, dict] = {}, {}  # bands of recording and reproduction by topic and time [ns], until the other one comes
        self.differences: dict[str, BandDifference] = {}

    def receive(self, item: Received) -> None:
        """Take a message of an input or a measurement."""
        name = item.topic[1:]
        if name in MEASURED_CHANNELS:
            self._run.watchers.hear(name, (item.log_ns - self._run.start_ns) * 1e-9, *measured_numbers(item))
        elif name in INPUTS:
            self._run.heard.add(name)

    def note_recorded(self, bands: Bands) -> None:
        """Take bands of the recording."""
        self._enter(0, bands)

    def see(self, block: np.ndarray, restarts: Collection[float] = ()) -> list[Bands]:
        """Return the bands of samples that were computed again, in order of time.

        Parameters
        ----------
        block : shape (n,), see `bearing_sim.model.sample`.
        restarts : times of those with which the run began anew [s].
        """
        found = []
        block = block[block["time"] >= self._first - 1e-9]
        cuts = np.union1d(np.arange(0, len(block), self._together), np.searchsorted(block["time"], sorted(restarts)))
        for part in np.split(block, cuts.astype(int)):
            if len(part):
                if float(part["time"][0]) in restarts:
                    self._run.watchers.restart("the recorded run was reset")
                found += self._run.watchers.see(part)
        turning = dict(zip(block["time"].tolist(), turns(block["shaft_speed"], self._slowest).tolist()))
        for bands in found:
            self._enter(1, bands, [bands.topic == ESTIMATES or turning[time] for time in bands.times.tolist()])
        return found

    def finish(self) -> None:
        """Count what only one of both has."""
        for side, waiting in enumerate(self._waiting):
            for names, *_ in waiting.values():
                for name in names:
                    difference = self.differences.setdefault(name, BandDifference())
                    if side:
                        difference.further += 1
                    else:
                        difference.missing += 1
            waiting.clear()

    def _enter(self, side: int, bands: Bands, counts: Sequence[bool] | None = None) -> None:
        """Compare bands with those of the other side where they are here already; ``counts`` says of computed ones which instants count."""
        for time, numbers, does_count in zip(bands.times.tolist(), bands.numbers, counts or [True] * len(bands.times)):
            key, own = (bands.topic, round(time * 1e9)), (bands.names, numbers, does_count)
            other = self._waiting[1 - side].pop(key, None)
            if other is None:
                self._waiting[side][key] = own
            elif own[2] and other[2]:
                self._compare(time, *((own, other) if side == 0 else (other, own)))

    def _compare(self, time: float, recorded: tuple, computed: tuple) -> None:
        again = dict(zip(*computed[:2]))
        for name, own in zip(*recorded[:2]):
            difference = self.differences.setdefault(name, BandDifference())
            if name not in again:
                difference.missing += 1
                continue
            difference.compared += 1
            with np.errstate(invalid="ignore"):
                width = own[2] - own[1]
                gaps = np.where((own == again[name]) | (np.isnan(own) & np.isnan(again[name])), 0.0, np.abs(own - again[name]))
            if not (np.isfinite(width) and width > 0.0):
                width = abs(own[0]) if np.isfinite(own[0]) and own[0] else 1.0
            gap = np.where(np.isnan(gaps), np.inf, gaps).max() / width
            difference.near += bool(gap <= _NEAR)
            if gap > difference.largest:
                difference.largest, difference.at = float(gap), time
