# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is known of a bearing: dimensions, clearance, ratings, and which of them are estimated; and how it looks."""

import math
from pathlib import Path

import numpy as np

from bearing_sim.scene.bearing import Bearing
from bearing_sim.scene.display import force
from bearing_sim.scene.flanges import flange_geometry
from bearing_sim.scene.mounting import clearance_limits, clearance_source
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.uncertainty import value_at

GUIDES = {
    "outer_ring": "guided by the outer ring",
    "inner_ring": "guided by the inner ring",
    "roller": "guided by the rollers",
    "full_complement": "none: a full complement of rollers",
}
"""What guides a cage, in words."""


def facts(bearing: Bearing) -> dict:
    """Return what is known of a bearing, for JSON; lengths in mm, forces in N, speeds in rpm."""
    rated, ratings = rate(bearing), bearing.ratings
    limits = _clearance_limits(bearing)
    return {
        "designation": bearing.designation,
        "source": bearing.source,
        "bore_diameter_mm": 1e3 * bearing.bore_diameter,
        "outside_diameter_mm": 1e3 * bearing.outside_diameter,
        "width_mm": 1e3 * bearing.boundary_width,
        "inner_raceway_diameter_mm": 2e3 * bearing.inner_raceway.radius,
        "outer_raceway_diameter_mm": 2e3 * bearing.outer_raceway.low_radius,
        "rollers": bearing.roller.count,
        "roller_diameter_mm": 1e3 * bearing.roller.diameter,
        "roller_effective_length_mm": 1e3 * bearing.roller.length,
        "clearance_group": bearing.clearance if isinstance(bearing.clearance, str) else None,
        "clearance_um": limits and [1e6 * limits.least, 1e6 * limits.largest],
        "cage_guidance": bearing.cage.guidance,
        "cage_mass_g": 1e3 * bearing.cage.mass,
        "dynamic_rating": rated.dynamic,
        "static_rating": rated.static,
        "fatigue_limit": rated.fatigue_limit,
        "computed_dynamic_rating": rated.computed.dynamic,
        "computed_static_rating": rated.computed.static,
        "makers_dynamic_rating": ratings.dynamic,
        "reference_speed_rpm": _rpm(ratings.reference_speed),
        "limiting_speed_rpm": _rpm(ratings.limiting_speed),
        "estimated": [{"field": each.field, "value": value_at(bearing, each.field), "by": each.by} for each in bearing.estimated],
    }


def rows(bearing: Bearing) -> list[tuple[str, str]]:
    """Return the facts as rows of a table."""
    known = facts(bearing)

    def mm(name):
        return f"{known[name]:.5g} mm"

    estimated = {each.field for each in bearing.estimated}

    def marked(text, *fields):
        return f"{text} (estimated)" if estimated & set(fields) else text

    clearance, group = known["clearance_um"], known["clearance_group"]
    rating = "maker's" if known["makers_dynamic_rating"] is not None else "by ISO 281 and ISO 76 from the dimensions"
    speeds = [f"{word} {known[f'{word}_speed_rpm']:.0f} rpm" for word in ("reference", "limiting") if known[f"{word}_speed_rpm"] is not None]
    raceways = f"F {mm('inner_raceway_diameter_mm')}, E {mm('outer_raceway_diameter_mm')}"
    cage_mass = marked(f"{known['cage_mass_g']:.4g} g", "cage.mass")
    symbols = {"C": "dynamic_rating", "C_0": "static_rating", "C_u": "fatigue_limit"}
    ratings = ", ".join(f"{symbol} {force(known[name])}" for symbol, name in symbols.items())
    length = marked(mm("roller_effective_length_mm"), "roller.length")
    rollers = f"{marked(str(known['rollers']), 'roller.count')} of {marked(mm('roller_diameter_mm'), 'roller.diameter')}, effective length {length}"
    found = {
        "boundary dimensions": f"d {mm('bore_diameter_mm')}, D {mm('outside_diameter_mm')}, B {mm('width_mm')}",
        "raceways": marked(raceways, "inner_raceway.radius", "outer_raceway.low_radius"),
        "rollers": rollers,
        "clearance": clearance and f"{group}: {clearance[0]:.0f} to {clearance[1]:.0f} µm, diametral ({clearance_source(group)})",
        "cage": GUIDES[known["cage_guidance"]] + ("" if bearing.cage.is_absent else f", {cage_mass}"),
        "load ratings": f"{ratings}; {rating}; C by ISO 281 {force(known['computed_dynamic_rating'])}",
        "speeds": ", ".join(speeds),
        "source": bearing.source.strip(),
    }
    shown = [(name, text) for name, text in found.items() if text or name == "source"]
    return shown + [(f"estimated {each['field']}", each["by"]) for each in known["estimated"]]


def _clearance_limits(bearing: Bearing):
    return clearance_limits(bearing.clearance, bearing.bore_diameter) if isinstance(bearing.clearance, str) else None


def _rpm(speed: float | None) -> float | None:
    return None if speed is None else speed * 30 / math.pi


_RING, _ROLLER, _CAGE, _LINE = "#c9d3de", "#f0d9b5", "#7a9a6b", "#444444"
_INK = {"edgecolor": _LINE, "linewidth": 0.8}


def plot_bearing(path: Path, bearing: Bearing) -> None:
    """Draw a bearing into a file; the suffix of ``path`` gives the format.  Estimated dimensions are marked with a tilde."""
    from bearing_sim.sweep.pictures import new_figure, save  # here, because facts are asked for without a picture, too

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


def _dimension(bearing: Bearing, symbol: str, metres: float, field: str = "") -> str:
    return f"{symbol} {_mark(bearing, field)}{1e3 * metres:.5g}"


def _draw_section(axes, bearing: Bearing) -> None:
    """Draw the upper half of the axial section, x along the shaft, in millimetres."""
    from matplotlib.patches import Rectangle

    inner, outer, roller, cage = bearing.inner_raceway, bearing.outer_raceway, bearing.roller, bearing.cage
    bore, outside, width = bearing.bore_diameter / 2, bearing.outside_diameter / 2, bearing.boundary_width
    middle = (inner.radius + outer.low_radius) / 2

    def block(low, high, wide, colour, middle=0.0, **more):
        corner = 1e3 * (middle - wide / 2), 1e3 * low
        axes.add_patch(Rectangle(corner, 1e3 * wide, 1e3 * (high - low), facecolor=colour, **(_INK | more)))

    block(bore, inner.radius, width, _RING)
    block(outer.low_radius, outside, width, _RING)
    block(cage.bore, cage.outside, min(cage.width, width), _CAGE, alpha=0.6)
    block(middle - roller.diameter / 2, middle + roller.diameter / 2, roller.length, _ROLLER)
    flange_width, size = (width - roller.length) / 2, flange_geometry(bearing)
    for ring, low, high in (("inner", inner.radius, size.inner_radius), ("outer", size.outer_radius, outer.low_radius)):
        for side in _flange_sides(bearing, ring):
            block(low, high, flange_width, _RING, middle=side * (roller.length + flange_width) / 2)

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
        axes.text(right + 0.13 * reach, 1e3 * radius, _dimension(bearing, f"⌀ {symbol}", 2 * radius, field), va="center", fontsize=9)
    _span(axes, -half, half, 1e3 * outside + 0.12 * reach, _dimension(bearing, "B", width, "width"))
    _span(axes, -5e2 * roller.length, 5e2 * roller.length, 1e3 * bore - 0.12 * reach, _dimension(bearing, "L", roller.length, "roller.length"))
    rollers = f"{_mark(bearing, 'roller.count')}{roller.count} rollers\n" + _dimension(bearing, "⌀", roller.diameter, "roller.diameter")
    axes.text(0, 1e3 * middle, rollers, ha="center", va="center", fontsize=9)
    height = 1e3 * bore - 0.3 * reach, 1e3 * outside + 0.3 * reach
    _frame(axes, (-half - 0.25 * reach, right + 0.75 * reach), height, "half of the axial section [mm]")


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
    ends = -1.05 * outside, 1.05 * outside
    _frame(axes, ends, ends, f"{_mark(bearing, 'cage')} cage: {GUIDES[cage.guidance]}".strip())


def _frame(axes, x: tuple[float, float], y: tuple[float, float], title: str) -> None:
    """Show a part of the plane to scale, without axes."""
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.set_axis_off()
    axes.set_title(title, fontsize=10)
