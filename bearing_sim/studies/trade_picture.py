# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of the trade: errors of slip, load and life over the real-time factor."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.trade import Trade

# Okabe and Ito's colours, which the colour-blind tell apart, and a marker of its own for each level besides
_LEVELS = {"steady": ("#009e73", "D"), "slip": ("#0072b2", "o"), "planar": ("#d55e00", "s"), "spatial": ("#cc79a7", "^")}
_OTHER = ("#000000", "x")
_FLOORS = (1e-4, 1e-4, 1e-4)  # of the axes: an error of 0 has no logarithm


def draw(path: Path, title: str, found: Trade) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(14, 5.6), layout="constrained")
    FigureCanvasAgg(figure)
    names = ("slip_error", "load_error", "life_error")
    labels = ("error of cage slip [percentage points]", "error of the largest roller load", "error of the life")
    own_errors = found.own_error[0], *found.own_error[2:]
    for axes, name, label, own, floor in zip(figure.subplots(1, 3, sharex=True), names, labels, own_errors, _FLOORS):
        _draw_errors(axes, found, name, floor)
        axes.axhspan(floor / 2, max(own, floor), color="0.88", zorder=0, label="the reference's own")
        axes.set(xscale="log", yscale="log", xlabel="times real time, one core", ylabel=label)
        axes.set_ylim(bottom=floor / 2)
        axes.axvline(1.0, color="0.6", lw=0.8)
        axes.grid(alpha=0.25)
    _draw_front(figure.axes[0], found)
    handles, told = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, told, loc="outside lower center", ncols=len(told), frameon=False)
    figure.suptitle(f"{title}\nagainst {found.reference}, over {found.simulated:.3g} s")
    figure.savefig(path, dpi=130)


def _draw_errors(axes, found, name, floor):
    for level in dict.fromkeys(one.setting.level for one in found.measured):
        mine = [one for one in found.measured if one.setting.level == level and not one.fault]
        colour, marker = _LEVELS.get(level, _OTHER)
        errors = np.maximum([getattr(one, name) for one in mine], floor)
        axes.plot([one.real_time_factor for one in mine], errors, marker, color=colour, ms=6, alpha=0.8, label=level)


def _draw_front(axes, found):
    """Join the settings of the front, and name the first and last of each level."""
    front = [found.measured[k] for k in found.front]
    factors, errors = [one.real_time_factor for one in front], np.maximum([one.slip_error for one in front], _FLOORS[0])
    axes.step(factors, errors, where="post", color="0.3", lw=1.0, label="front", zorder=1)
    for level in dict.fromkeys(one.setting.level for one in front):
        best = next(one for one in front if one.setting.level == level)
        words = f"{best.setting.method} {best.setting.detail}".strip()
        axes.annotate(words, (best.real_time_factor, max(best.slip_error, _FLOORS[0])), (-4, 9), textcoords="offset points", fontsize=8, ha="right")
