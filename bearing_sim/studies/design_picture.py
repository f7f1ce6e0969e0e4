# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of a design: the region of raceways that meet the limits, nominal and in the worst case, over slip and life."""

from pathlib import Path

import numpy as np

from bearing_sim.studies.design import D_VALUE, LOW, NOMINAL, WORST, Designed
from bearing_sim.sweep.picture import new_figure, on_grid

_SLIP, _LIFE = "#b2451f", "#0072b2"
_REGIONS = {NOMINAL: {"facecolor": "#cfe8d8", "edgecolor": "#3d8b5e", "label": "meets both limits"}}
_REGIONS[WORST] = {"facecolor": "#7fc49b", "edgecolor": "#1d5c39", "label": "meets them within the tolerances"}


def draw(path: Path, designed: Designed, beside: tuple[str, tuple[float, float], tuple[float, float]] | None = None) -> None:
    """Write the picture; the ending of ``path`` says its format.

    Parameters
    ----------
    path : .png, .svg or .pdf.
    designed : what was found.
    beside : another answer to compare with: whose, D values and radii between which it lies [mm].
    """
    figure = new_figure(9, 6.2)
    axes = figure.subplots()
    for kind, look in _REGIONS.items():
        _fill(axes, [border for border in designed.borders if border.kind == kind], look)
    wanted = designed.grid.about["wanted"]
    for quantity, colour, limit, unit in (("nominal_slip", _SLIP, wanted["slip_below"], "%"), ("nominal_life", _LIFE, wanted["life_above"], "h")):
        _isolines(axes, designed, quantity, colour, limit, unit)
    if beside is not None:
        name, (left, right), (low, high) = beside
        axes.plot([left, right, right, left, left], [low, low, high, high, low], color="black", lw=1.8, label=name)
    axes.plot([], [], color=_SLIP, label="cage slip [%]")
    axes.plot([], [], color=_LIFE, label="life [h]")
    axes.set(xlabel="D value [mm]", ylabel="low-point radius R_low [mm]")
    axes.ticklabel_format(useOffset=False)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    spread = f"speed ±{100 * wanted['speed_tolerance']:g} %, load ±{100 * wanted['load_tolerance']:g} %"
    about = designed.grid.about
    asked = f"slip below {wanted['slip_below']:g} %, life above {wanted['life_above']:g} h"
    figure.suptitle(f"{about['scene']} at level {about['level']}: {asked}; tolerances {spread}", fontsize=10)
    figure.savefig(path, dpi=130)


def _fill(axes, borders, look) -> None:
    """Fill the region; where it has several stretches at a D value, each is drawn by itself."""
    d_values = sorted({border.d_value for border in borders})
    stretches = {d: sorted((border.low_from, border.low_to) for border in borders if border.d_value == d) for d in d_values}
    if d_values and all(len(each) == 1 for each in stretches.values()):
        low, high = ([stretches[d][0][end] for d in d_values] for end in (0, 1))
        axes.fill_between(d_values, low, high, lw=1.6, **look)
        return
    for k, (d_value, each) in enumerate(stretches.items()):
        for low, high in each:
            axes.plot([d_value, d_value], [low, high], color=look["edgecolor"], lw=6, solid_capstyle="butt", label=look["label"] if k == 0 else None)


def _isolines(axes, designed, quantity, colour, limit, unit) -> None:
    across, up, field = on_grid(designed.grid, D_VALUE, LOW, quantity)
    finite = field[np.isfinite(field)]
    if min(field.shape) < 2 or not finite.size or not np.ptp(finite) > 0:
        return
    levels = sorted({float(f"{level:.2g}") for level in np.quantile(finite, (0.15, 0.3, 0.45, 0.6, 0.75, 0.9))} - {limit})
    column = 1 if unit == "%" else -2  # labels of slip to the left, those of life to the right: they do not meet
    for each, width in ((levels, 0.7), ([limit], 2.0)):
        lines = axes.contour(across, up, field, each, colors=colour, linewidths=width)
        order = np.argsort(field[:, column])
        inside = [level for level in each if np.nanmin(field[:, column]) < level < np.nanmax(field[:, column])]
        places = [(across[column], np.interp(level, field[order, column], up[order])) for level in inside]
        if places:
            axes.clabel(lines, inside, fontsize=9, fmt={level: f"{level:g} {unit}" for level in inside}, manual=places)
