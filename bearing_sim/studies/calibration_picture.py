# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of a calibration: measured and predicted slip over time and against each other, and what is left."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.calibration import Calibration

_MEASURED, _BEFORE, _AFTER = "0.45", "#d55e00", "#0072b2"  # Okabe and Ito: told apart by the colour-blind


def draw(path: Path, title: str, found: Calibration) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(12, 8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplot_mosaic([["time", "time"], ["against", "left"]])
    blocks = found.blocks
    axes["time"].plot(blocks.times, 100 * blocks.slip, ".", ms=4, color=_MEASURED, label=f"measured, means over {blocks.length:.3g} s")
    axes["time"].plot(blocks.times, 100 * found.before, ".", ms=3, color=_BEFORE, label="model, the scene as it was")
    axes["time"].plot(blocks.times, 100 * found.after, ".", ms=3, color=_AFTER, label="model, calibrated")
    axes["time"].set(xlabel="time [s]", ylabel="cage slip [%]")
    axes["time"].legend(fontsize=9)
    _against(axes["against"], found)
    _left(axes["left"], found)
    figure.suptitle(title)
    figure.savefig(path, dpi=130)


def _against(axes, found) -> None:
    """Draw measured over predicted slip, means of operating points, with what their scatter leaves of them."""
    place = found.points.place
    sizes = np.bincount(place)

    def mean(values):
        return 100 * np.bincount(place, values) / sizes

    measured = mean(found.blocks.slip)
    spread = np.sqrt(np.maximum(mean(found.blocks.slip**2) / 100 - (measured / 100) ** 2, 0.0))
    error = 196 * spread * np.sqrt(found.resemblance / sizes)
    for values, colour, label in ((found.before, _BEFORE, "the scene as it was"), (found.after, _AFTER, "calibrated")):
        axes.errorbar(mean(values), measured, yerr=error, fmt="o", ms=4, lw=1, color=colour, label=label)
    ends = [min(axes.get_xlim()[0], axes.get_ylim()[0]), max(axes.get_xlim()[1], axes.get_ylim()[1])]
    axes.plot(ends, ends, "k:", lw=1)
    axes.set(xlabel="predicted slip [%]", ylabel="measured slip [%]", title="means of operating points, 95 % of their scatter")
    axes.title.set_fontsize(10)
    axes.legend(fontsize=9)


def _left(axes, found) -> None:
    left = 100 * (found.blocks.slip - found.after)
    axes.plot(found.blocks.times, left, ".", ms=4, color=_AFTER)
    axes.axhline(0.0, color="black", lw=0.8)
    axes.set(xlabel="time [s]", ylabel="measured less predicted [points]")
    axes.set_title(f"residuals; {found.resemblance:.2g} neighbours are worth one", fontsize=10)
