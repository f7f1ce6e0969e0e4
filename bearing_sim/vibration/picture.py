# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The picture of an analysis: the envelope spectrum over the shaft's orders, with the lines that were found."""

from pathlib import Path

import numpy as np

from bearing_sim.vibration.analysis import Analysis, Geometry
from bearing_sim.vibration.signal import Band, Spectrum, Vibration

_PER_TURN = 128


def draw(path: Path, vibration: Vibration, geometry: Geometry, found: Analysis) -> None:
    """Draw the envelope spectrum of a record; of the whole of its band where no line was found."""
    import matplotlib.figure

    spectrum = Spectrum(vibration.samples, vibration.rate).without_lines()
    envelope, rate = spectrum.envelope(found.band or Band(0.0, spectrum.highest))
    per_turn = min(_PER_TURN, rate / found.shaft.frequency)
    signal = found.shaft.resampled(envelope - envelope.mean(), rate, per_turn)
    window = np.hanning(len(signal))
    amplitudes = np.abs(np.fft.rfft(signal * window)) * 2.0 / window.sum()
    orders = np.fft.rfftfreq(len(signal), 1.0 / per_turn)
    shown = orders < min(3.2 * geometry.rollers * 0.65, per_turn / 2.0)
    figure = matplotlib.figure.Figure(figsize=(12, 5), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(orders[shown], amplitudes[shown], linewidth=0.6, color="0.3")
    for number, order in enumerate(found.lines):
        axes.axvline(order, color="tab:red", linewidth=0.8, alpha=0.5, label="" if number else f"lines that show {found.shows.replace('_', ' ')}")
    axes.set_xlabel("frequency over that of the shaft")
    axes.set_ylabel("amplitude of the envelope, relative")
    axes.set_xlim(0.0, orders[shown][-1])
    axes.set_ylim(bottom=0.0)
    title = f"cage over shaft {found.ratio:.5f} +- {found.ratio_error:.5f}" if found.found else "no line of this bearing"
    axes.set_title(f"{vibration.name}: {title}", parse_math=False)
    if found.lines:
        axes.legend(loc="upper right")
    figure.savefig(path, dpi=120)
