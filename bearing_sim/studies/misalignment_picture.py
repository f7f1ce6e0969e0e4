# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of the study of misalignment: pressures, lives, slip, tilts and skews over it, and the load along the heaviest roller."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.misalignment import Misaligned

_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00")  # Okabe and Ito: told apart by the colour-blind
_MARKERS = ("o", "s", "^", "D", "v")


def draw(path: Path, title: str, found: list[Misaligned]) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 8), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(2, 3)
    _over_misalignment(axes[0, 0], found, lambda one: 1e-6 * one.inner_edge_pressure, lambda one: 1e-6 * _edge_pressure(one))
    axes[0, 0].set(ylabel="pressure of the end slices, inner raceway [MPa]", ylim=(0, None))
    _over_misalignment(axes[0, 1], found, lambda one: one.lamina_life, lambda one: one.still.lamina_life)
    axes[0, 1].set(ylabel="life by slices [h]", ylim=(0, None))
    _over_misalignment(axes[0, 2], found, lambda one: 100 * one.slip)
    axes[0, 2].set(ylabel="cage slip [%]", ylim=(0, None))
    _over_misalignment(axes[1, 0], found, lambda one: 1e3 * one.tilt, lambda one: 1e3 * np.abs(one.still.tilts).max())
    axes[1, 0].set(ylabel="largest tilt of a roller [mrad]", ylim=(0, None))
    _over_misalignment(axes[1, 1], found, lambda one: 1e3 * one.skew)
    axes[1, 1].set(ylabel="largest skew of a roller [mrad]", ylim=(0, None))
    _along(axes[1, 2], found)
    for each in axes.flat[:5]:
        each.set_xlabel("misalignment of the inner ring [mrad]")
        each.grid(alpha=0.3)
    handles, told = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, told, loc="outside lower center", ncols=len(told), frameon=False)
    figure.suptitle(title)
    figure.savefig(path, dpi=130)


def _edge_pressure(one):
    """Return the pressure of the end slices in quasi-static balance [Pa]: it goes with the root of the slice's load."""
    still = one.still
    return still.inner_pressure * np.sqrt(still.inner_slices[:, [0, -1]].max() / still.inner_slices.max())


def _over_misalignment(axes, found, moving, still=None):
    for crown, colour, marker in zip(dict.fromkeys(one.crown for one in found), _COLOURS, _MARKERS):
        mine = [one for one in found if one.crown == crown]
        places = [1e3 * one.misalignment for one in mine]
        axes.plot(places, [moving(one) for one in mine], marker=marker, ms=5, color=colour, label=f"crown {crown}")
        if still is not None:
            axes.plot(places, [still(one) for one in mine], "--", color=colour, lw=1, label=f"crown {crown}, quasi-static, no slip")


def _along(axes, found):
    """Draw load per length along the heaviest roller, for the misalignment in the middle of those studied."""
    amounts = sorted({one.misalignment for one in found})
    shown = amounts[len(amounts) // 3]
    for one, colour, marker in zip([one for one in found if one.misalignment == shown], _COLOURS, _MARKERS):
        still = one.still
        width = still.places[1] - still.places[0]
        heaviest = still.inner_slices[np.argmax(still.inner)]
        axes.plot(1e3 * still.places, 1e-3 * heaviest / width, marker=marker, ms=3, color=colour)
    title = f"heaviest roller at {1e3 * shown:g} mrad, quasi-static"
    axes.set(xlabel="along the roller, x [mm]", ylabel="load per length, inner raceway [N/mm]", title=title, ylim=(0, None))
    axes.grid(alpha=0.3)
