# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Draw a bearing to scale: half of its axial section with dimensions, and its side."""

import math
from pathlib import Path

import numpy as np

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.flanges import flange_geometry
from bearing_sim.studies.bearing_facts import GUIDES
from bearing_sim.sweep.pictures import new_figure, save

_RING, _ROLLER, _CAGE, _LINE = "#c9d3de", "#f0d9b5", "#7a9a6b", "#444444"
_INK = {"edgecolor": _LINE, "linewidth": 0.8}


def draw(path: Path, bearing: Bearing) -> None:
    """Draw a bearing into a file; the suffix of ``path`` gives the format.  Estimated dimensions are marked with a tilde."""
    figure = new_figure(12, 6.4)
    section, side = figure.subplots(1, 2, width_ratios=(1.25, 1.0))
    _draw_section(section, bearing)
    _draw_side(side, bearing)
    figure.suptitle(bearing.designation or bearing.name)
    if bearing.estimated:
        figure.supxlabel("~ estimated: no source prints it", fontsize=8, color=_LINE)
    save(figure, path)


def _mark(bearing: Bearing, field: str) -> str:
    """Return the mark of a field that is estimated, or of a part with such a field; ``""`` if a source prints it."""
    return "~" if any(each.field == field or each.field.startswith(f"{field}.") for each in bearing.estimated) else ""


def _shown(bearing: Bearing, symbol: str, metres: float, field: str = "") -> str:
    return f"{symbol} {_mark(bearing, field)}{1e3 * metres:.5g}"


def _draw_section(axes, bearing: Bearing) -> None:
    """Draw the upper half of the axial section, x along the shaft, in millimetres."""
    from matplotlib.patches import Rectangle

    inner, outer, roller, cage = bearing.inner_raceway, bearing.outer_raceway, bearing.roller, bearing.cage
    bore, outside, width = bearing.bore_diameter / 2, bearing.outside_diameter / 2, bearing.boundary_width
    middle = (inner.radius + outer.low_radius) / 2

    def block(low, high, wide, colour, **more):
        axes.add_patch(Rectangle((-5e2 * wide, 1e3 * low), 1e3 * wide, 1e3 * (high - low), facecolor=colour, **(_INK | more)))

    block(bore, inner.radius, width, _RING)
    block(outer.low_radius, outside, width, _RING)
    block(cage.bore, cage.outside, min(cage.width, width), _CAGE, alpha=0.6)
    block(middle - roller.diameter / 2, middle + roller.diameter / 2, roller.length, _ROLLER)
    flange_width, size = (width - roller.length) / 2, flange_geometry(bearing)
    edges = (("inner", inner.radius, size.inner_radius), ("outer", size.outer_radius, outer.low_radius))
    for ring, low, high in edges:
        for side in _flange_sides(bearing, ring):
            left = side * (roller.length + flange_width) / 2 - flange_width / 2
            corner = 1e3 * left, 1e3 * low
            axes.add_patch(Rectangle(corner, 1e3 * flange_width, 1e3 * (high - low), facecolor=_RING, **_INK))

    half, reach = 5e2 * width, 1e3 * (outside - bore)
    right = half + 0.12 * reach
    radial = (
        ("d", bore, "inner_raceway.bore_radius"),
        ("F", inner.radius, "inner_raceway.radius"),
        ("E", outer.low_radius, "outer_raceway.low_radius"),
        ("D", outside, "outer_raceway.outside_radius"),
    )
    for symbol, radius, field in radial:
        axes.plot([half, right + 0.1 * reach], [1e3 * radius] * 2, color=_LINE, linewidth=0.5)
        axes.text(right + 0.13 * reach, 1e3 * radius, _shown(bearing, f"⌀ {symbol}", 2 * radius, field), va="center", fontsize=9)
    _span(axes, -half, half, 1e3 * outside + 0.12 * reach, _shown(bearing, "B", width, "width"))
    _span(axes, -5e2 * roller.length, 5e2 * roller.length, 1e3 * bore - 0.12 * reach, _shown(bearing, "L", roller.length, "roller.length"))
    rollers = f"{_mark(bearing, 'roller.count')}{roller.count} rollers\n" + _shown(bearing, "⌀", roller.diameter, "roller.diameter")
    axes.text(0, 1e3 * middle, rollers, ha="center", va="center", fontsize=9)
    axes.set_xlim(-half - 0.25 * reach, right + 0.75 * reach)
    axes.set_ylim(1e3 * bore - 0.3 * reach, 1e3 * outside + 0.3 * reach)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("half of the axial section [mm]", fontsize=10)


def _flange_sides(bearing: Bearing, ring: str) -> tuple[int, ...]:
    """Return on which sides a ring has flanges, -1 and 1 along x; see `bearing_sim.scene.flanges` for the side of a single one."""
    single = (-1,) if ring == "inner" else (1,)
    return {"none": (), "one": single, "both": (-1, 1)}[getattr(bearing.flanges, ring)]


def _span(axes, left: float, right: float, height: float, text: str) -> None:
    axes.annotate("", (left, height), (right, height), arrowprops={"arrowstyle": "<->", "color": _LINE, "linewidth": 0.7})
    axes.text((left + right) / 2, height, f" {text} ", ha="center", va="center", fontsize=9, backgroundcolor="white")


def _draw_side(axes, bearing: Bearing) -> None:
    """Draw rings, rollers and cage as they look along the shaft."""
    from matplotlib.patches import Annulus, Circle

    inner, outer, roller, cage = bearing.inner_raceway, bearing.outer_raceway, bearing.roller, bearing.cage
    bore, outside = 5e2 * bearing.bore_diameter, 5e2 * bearing.outside_diameter
    for low, high, colour, more in (
        (bore, 1e3 * inner.radius, _RING, {}),
        (1e3 * outer.low_radius, outside, _RING, {}),
        (1e3 * cage.bore, 1e3 * cage.outside, _CAGE, {"alpha": 0.6}),
    ):
        axes.add_patch(Annulus((0, 0), high, high - low, facecolor=colour, **_INK, **more))
    for azimuth in 2 * math.pi * np.arange(roller.count) / roller.count:
        centre = 1e3 * bearing.pitch_radius * np.array([math.cos(azimuth), math.sin(azimuth)])
        axes.add_patch(Circle(centre, 5e2 * roller.diameter, facecolor=_ROLLER, **_INK))
    axes.set_xlim(-1.05 * outside, 1.05 * outside)
    axes.set_ylim(-1.05 * outside, 1.05 * outside)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(f"{_mark(bearing, 'cage')} cage: {GUIDES[cage.guidance]}".strip(), fontsize=10)
