# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The picture of an analysis: the envelope spectrum over the shaft's orders, with the lines that were found."""

from pathlib import Path

import numpy as np

from bearing_sim.watchers.vibration.analysis import PARTS, Analysis, Geometry
from bearing_sim.watchers.vibration.signal import Band, Spectrum, Vibration

_PER_TURN = 128
_NEAR = 0.02  # of an order, within which the peak of a line is looked for


def plot_vibration(path: Path, vibration: Vibration, geometry: Geometry, found: Analysis) -> None:
    """Draw the envelope spectrum of a record; of the whole of its band where no line was found."""
    import matplotlib.figure
    from matplotlib.transforms import ScaledTranslation

    spectrum = Spectrum(vibration.samples, vibration.rate).without_lines()
    envelope, rate = spectrum.envelope(found.band or Band(0.0, spectrum.highest))
    per_turn = min(_PER_TURN, rate / found.shaft.frequency)
    signal = found.shaft.resampled(envelope - envelope.mean(), rate, per_turn)
    window = np.hanning(len(signal))
    amplitudes = np.abs(np.fft.rfft(signal * window)) * 2.0 / window.sum() / envelope.mean()
    orders = np.fft.rfftfreq(len(signal), 1.0 / per_turn)
    shown = orders < min(3.2 * geometry.rollers * 0.65, per_turn / 2.0)
    figure = matplotlib.figure.Figure(figsize=(12, 5), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(orders[shown], amplitudes[shown], linewidth=0.6, color="0.3")
    lines = [order for order in found.lines if order <= orders[shown][-1]]
    peaks = [amplitudes[np.abs(orders - order) <= _NEAR].max() for order in lines]
    if lines:  # marks stand above the peaks, so that these are seen
        above = axes.transData + ScaledTranslation(0.0, 6.0 / 72.0, figure.dpi_scale_trans)
        axes.plot(lines, peaks, "v", color="tab:red", markersize=5, transform=above, label=f"lines that show {PARTS.get(found.shows, found.shows)}")
    axes.set_xlabel("frequency over that of the shaft")
    axes.set_ylabel("amplitude of the envelope over its mean")
    axes.set_xlim(0.0, orders[shown][-1])
    axes.set_ylim(0.0, 1.08 * amplitudes[shown].max())
    title = f"cage over shaft {found.ratio:.5f} ± {found.ratio_error:.5f}" if found.found else "no line of this bearing"
    axes.set_title(f"{vibration.name}: {title}", parse_math=False)
    if lines:
        axes.legend(loc="upper right")
    figure.savefig(path, dpi=120)
