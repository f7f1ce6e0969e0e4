# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Draw speed, temperatures, running clearance with its parts, and slip of a recording over time: ``python draw_heat.py RUN.mcap PICTURE.png``."""

import sys
from pathlib import Path

import numpy as np

from bearing_sim.recording.reader import Recording
from bearing_sim.sweep.pictures import new_figure

TEMPERATURES = ("shaft", "inner_ring", "roller", "outer_ring", "housing", "oil_outlet")
CLEARANCES = ("running", "initial", "fit", "rotation", "heat")


def plot_heat(recording: Path, picture: Path) -> None:
    """Draw a recording of a scene with a law of heat."""
    samples = np.concatenate([block for block in Recording(recording) if isinstance(block, np.ndarray)])
    minutes = samples["time"] / 60.0
    figure = new_figure(11, 11)
    speed, warm, clearance, slip = figure.subplots(4, 1, sharex=True)
    speed.plot(minutes, samples["shaft_speed"] * 30 / np.pi / 1000)
    speed.set_ylabel("shaft speed [1000 rpm]")
    for name in TEMPERATURES:
        warm.plot(minutes, samples[f"{name}_temperature"] - 273.15, label=name.replace("_", " "))
    warm.set_ylabel("temperature [degC]")
    for name in CLEARANCES:
        clearance.plot(minutes, 1e6 * samples[f"{name}_clearance"], label=name)
    clearance.set_ylabel("diametral clearance [um]")
    slip.plot(minutes, 100 * samples["cage_slip"])
    slip.set_ylabel("cage slip [%]")
    slip.set_xlabel("time [min]")
    for axes in (warm, clearance):
        axes.legend(ncol=6, fontsize=8)
    figure.savefig(picture, dpi=90)


if __name__ == "__main__":
    plot_heat(*map(Path, sys.argv[1:3]))
