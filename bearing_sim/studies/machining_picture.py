# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Picture of a machined raceway: its shape with departures magnified, and its radius over the turn."""

import math
from pathlib import Path

import numpy as np

from bearing_sim.studies.machining import Machined, Pressing, RingSection

_CONTOUR, _PRESSED, _ROUND = "#b2451f", "#c9d8ea", "#7a7a7a"
_DRAWN = 0.22  # of the radius: what D is drawn as


def draw(path: Path, section: RingSection, pressing: Pressing, machined: Machined) -> None:
    """Write the picture; the ending of ``path`` says its format."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 5.2), layout="constrained")
    FigureCanvasAgg(figure)
    shape, course = figure.subplots(1, 2, width_ratios=(1, 1.35))
    _draw_shape(shape, pressing, machined)
    _draw_course(course, pressing, machined)
    pressed = f"{pressing.arcs} arcs of {math.degrees(pressing.arc_width):g}°, {1e-6 * pressing.pressure:g} MPa"
    ring = f"ring R {1e3 * section.mean_radius:g} mm, thickness {1e3 * section.thickness:g} mm"
    made = f"D {1e6 * machined.d_value:.1f} µm, roundness {1e6 * machined.roundness:.1f} µm"
    figure.suptitle(f"{pressed}, arc turn {math.degrees(pressing.arc_turn):g}°, {ring}: {made}")
    figure.savefig(path, dpi=130)


def _edges(pressing):
    return [(centre - pressing.arc_width / 2, centre + pressing.arc_width / 2) for centre in pressing.centres]


def _draw_shape(axes, pressing, machined):
    """Draw the raceway as it is seen along the shaft, y to the right and z up."""
    span = float(np.ptp(machined.radii))
    factor = _DRAWN * machined.ground_radius / span if span > 0.0 else 1.0
    azimuths = np.append(machined.azimuths, 2 * math.pi)
    drawn = 1.0 + factor * (np.append(machined.radii, machined.radii[0]) / machined.ground_radius - 1.0)
    outside = 1.32
    for (start, end), pressure in zip(_edges(pressing), pressing.pressures):
        arc = np.linspace(start, end, 40)
        axes.plot(outside * np.cos(arc), outside * np.sin(arc), color="#6f93bd", lw=7, solid_capstyle="butt")
        middle = 0.5 * (start + end)
        inward = {"arrowstyle": "-|>", "color": "#3c5f8a", "lw": 1.5, "shrinkA": 0, "shrinkB": 0}
        for at in np.linspace(start, end, 5)[1:-1]:
            ends = [(radius * math.cos(at), radius * math.sin(at)) for radius in (outside - 0.03, outside - 0.19)]
            axes.annotate("", xy=ends[1], xytext=ends[0], arrowprops=inward)
        label = 1.53 * np.array([math.cos(middle), math.sin(middle)])
        axes.text(*label, f"{1e-6 * pressure:.2f}\nMPa", ha="center", va="center", fontsize=9, color="#3c5f8a")
    axes.plot(np.cos(azimuths), np.sin(azimuths), "--", color=_ROUND, lw=1, label="ground, under load")
    axes.plot(drawn * np.cos(azimuths), drawn * np.sin(azimuths), color=_CONTOUR, lw=2, label=f"released, departures ×{factor:.0f}")
    axes.set(aspect="equal", xlim=(-1.75, 1.75), ylim=(-1.75, 1.75))
    axes.axis("off")
    axes.legend(loc="center", frameon=False, fontsize=9)


def _draw_course(axes, pressing, machined):
    for edges in _edges(pressing):
        for shift in (-360.0, 0.0, 360.0):
            axes.axvspan(*(math.degrees(edge) + shift for edge in edges), color=_PRESSED, lw=0)
    azimuths, radii = np.append(np.degrees(machined.azimuths), 360.0), 1e3 * np.append(machined.radii, machined.radii[0])
    axes.axhline(1e3 * machined.ground_radius, color=_ROUND, ls="--", lw=1)
    axes.plot(azimuths, radii, color=_CONTOUR, lw=2)
    span = max(float(np.ptp(radii)), 1e-6)
    for points, side in ((machined.lows, -1), (machined.highs, 1)):
        for angle, radius in points:
            axes.plot(math.degrees(angle), 1e3 * radius, "o", color=_CONTOUR, ms=4)
            axes.annotate(
                f"{1e3 * radius:.4f}",
                (math.degrees(angle), 1e3 * radius),
                xytext=(0, 7 * side),
                textcoords="offset points",
                ha="left" if angle < 0.1 else "center",
                va="bottom" if side > 0 else "top",
                fontsize=9,
            )
    axes.set(xlim=(0, 360), ylim=(radii.min() - 0.14 * span, radii.max() + 0.14 * span), xlabel="azimuth [deg]", ylabel="raceway radius [mm]")
    axes.set_xticks(range(0, 361, 60))
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.set_title("pressed arcs shaded", fontsize=10, color=_ROUND)
