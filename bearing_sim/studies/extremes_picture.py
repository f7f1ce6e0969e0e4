# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of the stability map: what became of the sampled scenes, level by level, in four views of the space they fill."""

from collections.abc import Sequence
from pathlib import Path

from bearing_sim.studies.extremes_run import CLAMPED, FAILED, FINISHED, REFUSED, Outcome

# Okabe and Ito's colours, which the colour-blind tell apart; the markers say the same without colour.
_LOOKS = {
    FINISHED: {"color": "#0072B2", "marker": "o", "s": 9, "alpha": 0.6, "linewidths": 0},
    CLAMPED: {"color": "#E69F00", "marker": "s", "s": 14, "alpha": 0.85, "linewidths": 0},
    REFUSED: {"color": "#7a7a7a", "marker": "x", "s": 16, "alpha": 0.9, "linewidths": 0.9},
    FAILED: {"color": "#D55E00", "marker": "*", "s": 130, "edgecolors": "black", "linewidths": 0.6, "zorder": 5},
}
# x, factor, label, scale; y, factor, label, scale
_VIEWS = (
    (("shaft_speed_rpm", 1e-3, "shaft speed [1000 rpm]", "linear"), ("radial_load", 1e-3, "radial load [kN]", "symlog")),
    (("clearance", 1e6, "clearance at low points [µm]", "symlog"), ("rollers", 1.0, "rollers", "linear")),
    (("pocket_clearance", 1e6, "pocket clearance [µm]", "log"), ("guide_clearance", 1e6, "guide clearance [µm]", "log")),
    (("tolerance", 1.0, "tolerance", "log"), ("step", 1e6, "longest or fixed step [µs]", "log")),
)
_LINEAR_TO = {"radial_load": 0.1, "clearance": 10.0}  # of a symlog axis, in its unit


def draw(path: Path, outcomes: Sequence[Outcome]) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    levels = list(dict.fromkeys(outcome.case.level for outcome in outcomes))
    figure = Figure(figsize=(15, 0.9 + 3.5 * len(levels)), layout="constrained")
    FigureCanvasAgg(figure)
    grid = figure.subplots(len(levels), len(_VIEWS), squeeze=False)
    for row, level in zip(grid, levels):
        ours = [outcome for outcome in outcomes if outcome.case.level == level]
        sampled = [outcome for outcome in ours if "shaft_speed_rpm" in outcome.case.place]
        for axes, (x, y) in zip(row, _VIEWS):
            _draw_view(axes, sampled, x, y)
        row[0].set_title(f"level {level}: {_told(sampled)}\ncorners: {_told([o for o in ours if o not in sampled])}", loc="left", fontsize=10)
    handles, labels = grid[0][0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper right", ncols=len(labels), frameon=False, markerscale=1.3)
    figure.suptitle("Stability map: scenes at the extremes by Latin hypercube", x=0.01, ha="left")
    figure.savefig(path, dpi=110)


def _told(outcomes: Sequence[Outcome]) -> str:
    return ", ".join(f"{sum(outcome.status == status for outcome in outcomes)} {status}" for status in _LOOKS)


def _draw_view(axes, outcomes, x, y) -> None:
    for status, look in _LOOKS.items():
        places = [outcome.case.place for outcome in outcomes if outcome.status == status]
        axes.scatter([x[1] * place[x[0]] for place in places], [y[1] * place[y[0]] for place in places], label=status, **look)
    for name, (field, _, label, scale) in (("x", x), ("y", y)):
        options = {"linthresh": _LINEAR_TO[field]} if scale == "symlog" else {}
        axes.set(**{f"{name}label": label})
        getattr(axes, f"set_{name}scale")(scale, **options)
    axes.tick_params(labelsize=9)
    axes.grid(color="#e6e6e6", lw=0.6)
    axes.set_axisbelow(True)
