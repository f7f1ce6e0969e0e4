# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of a scene's statics: loads around the bearing, and along its rollers."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.statics import Statics

_INNER, _OUTER = "#b2451f", "#3c5f8a"


def draw(path: Path, title: str, found: Statics) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(13, 7.4), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.add_gridspec(2, 2, width_ratios=(1, 1.25))
    _draw_around(figure.add_subplot(grid[:, 0], projection="polar"), found)
    for row, (name, slices) in enumerate((("inner", found.inner_slices), ("outer", found.outer_slices))):
        _draw_along(figure, figure.add_subplot(grid[row, 1]), name, slices, found)
    tilt = f"tilt {1e3 * found.tilt[0]:.3g} mrad, " if found.tilt[0] > 1e-9 else ""
    figure.suptitle(f"{title}\n{tilt}life {_hours(found.rating_life)} by whole rollers, {_hours(found.lamina_life)} by slices")
    figure.savefig(path, dpi=130)


def _hours(life):
    return f"{life:.4g} h" if np.isfinite(life) else "endless"


def _draw_around(axes, found):
    """Draw the loads as bars on the azimuth, seen against the shaft: y to the right, z up."""
    width = 2 * np.pi / len(found.azimuths)
    axes.bar(found.azimuths, found.outer, width=0.8 * width, color=_OUTER, alpha=0.45, label="on the outer raceway")
    axes.bar(found.azimuths, found.inner, width=0.5 * width, color=_INNER, label="on the inner raceway")
    axes.set_ylim(0, 1.08 * max(found.outer.max(), 1.0))
    axes.set_title("roller loads [N] by azimuth", fontsize=10)
    axes.tick_params(labelsize=8)
    axes.set_rlabel_position(100)
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.16), frameon=False, fontsize=9, ncols=2)


def _draw_along(figure, axes, name, slices, found):
    """Draw load per length over position along the roller, one row for each roller that carries anything."""
    width = found.places[1] - found.places[0]
    edges = 1e3 * np.append(found.places - width / 2, found.places[-1] + width / 2)
    count = len(found.azimuths)
    # rollers in the order of their azimuth from the far side of the load line, which is then in the middle
    order = np.roll(np.arange(count), count // 2)
    shown = axes.pcolormesh(edges, np.arange(count + 1) - count // 2, 1e-3 * slices[order] / width, cmap="viridis", vmin=0.0)
    ticks = np.arange(-(count // 2), count - count // 2, max(count // 6, 1))
    axes.set_yticks(ticks + 0.5, [f"{place * 360 / count:.0f}°" for place in ticks])
    axes.set(ylabel="roller, from the load line", title=f"load per length on the {name} raceway")
    if name == "outer":
        axes.set_xlabel("along the roller, x [mm]")
    figure.colorbar(shown, ax=axes, label="N/mm")
