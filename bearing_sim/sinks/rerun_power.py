# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause as bars: what the shaft puts in, and where it is lost."""

import numpy as np
import rerun as rr

from bearing_sim.sinks import colours, section
from bearing_sim.sinks.rerun_scene import labels

ROOT = "/power_now"
SAMPLES = 20  # that the bars are means of
CAUSES = {
    "shaft": ("in: shaft", colours.WHITE),
    "inner_sliding": ("inner sliding", colours.BLUE),
    "outer_sliding": ("outer sliding", colours.VERMILION),
    "churning": ("churning", colours.GREEN),
    "windage": ("cage windage", colours.GREY),
    "land": ("guide land", colours.ORANGE),
    "pocket": ("pockets", colours.PURPLE),
    "damping": ("damping", colours.YELLOW),
}
"""Causes with their names and colours, in the order of the bars."""

_WIDTH, _PITCH = 100.0, 12.0  # drawn length of the scale, and distance of two bars


class PowerDrawing:
    """Bars of one run, each on a line of its own with its name and its watts; all on one scale, which fits the longest.

    Means of the newest `SAMPLES`: at an instant the shaft's power is in part stored, in motion and elastic contacts, or given back.

    Parameters
    ----------
    recording : rerun.RecordingStream to draw into; its time is set by the caller.
    """

    def __init__(self, recording: rr.RecordingStream):
        self._recording = recording
        self._scale = 1.0  # [W]
        self._newest = np.empty((0, len(CAUSES)))
        self._levels = _PITCH * np.arange(len(CAUSES))

    def draw_still_parts(self) -> None:
        """Write the names, and what the bars keep."""
        names = np.stack((np.full(len(CAUSES), -0.28 * _WIDTH), self._levels - 0.42 * _PITCH), axis=1)
        self._recording.log(f"{ROOT}/names", labels(names, [name for name, _ in CAUSES.values()]), static=True)
        style = rr.LineStrips2D.from_fields(colors=[colour for _, colour in CAUSES.values()])
        self._recording.log(f"{ROOT}/bars", style, static=True)

    def add(self, block: np.ndarray) -> None:
        """Enter the samples of a block, drawn or not."""
        rows = np.stack([block[f"{cause}_power"][-SAMPLES:] for cause in CAUSES], axis=1)
        self._newest = np.concatenate((self._newest, rows))[-SAMPLES:]

    def draw(self) -> None:
        """Draw the bars at the recording's present time."""
        powers = self._newest.mean(axis=0)
        known = np.nan_to_num(powers)
        largest = float(np.abs(known).max())
        if largest > 0.0 and not 0.25 * self._scale < largest <= self._scale:
            self._scale = section.round_up(largest)
        ends = _WIDTH * known / self._scale
        radii = np.minimum(0.3 * _PITCH, 0.45 * np.abs(ends))  # the ends of lines are round and stand out by this
        left, right = np.minimum(ends, 0.0) + radii, np.maximum(ends, 0.0) - radii
        bars = np.stack((np.stack((left, self._levels), axis=1), np.stack((right, self._levels), axis=1)), axis=1)
        self._recording.log(f"{ROOT}/bars", rr.LineStrips2D.from_fields(strips=bars, radii=radii))
        places = np.stack((np.full(len(ends), 1.28 * _WIDTH), self._levels - 0.42 * _PITCH), axis=1)
        texts = [f"{power:,.0f} W" if np.isfinite(power) else "unknown" for power in powers]
        self._recording.log(f"{ROOT}/watts", labels(places, texts))


def bounds() -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the horizontal and vertical range of the bars with their texts."""
    return (-0.56 * _WIDTH, 1.46 * _WIDTH), (-0.8 * _PITCH, (len(CAUSES) - 0.1) * _PITCH)
