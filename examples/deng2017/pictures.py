# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Figures of Deng 2017 drawn from the tables of this code, and their captions."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.outputs import replaced
from bearing_sim.scene.display import heading
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.machining import Machined
from bearing_sim.sweep.pictures import COLOURS, MARKERS, map_of, new_figure, on_grid, plain_numbers
from bearing_sim.sweep.table import Table
from deng2017.study import ANGLE, D_VALUE, LOAD, LOW, LOW_RADII, MASS, MIXTURE, ROUNDNESS, SPEED

Tables = Mapping[tuple[str, str], Table]
_LOOKS = {"slip": {"ls": "-", "lw": 1.6}, "planar": {"ls": "--", "lw": 1.1}}
_DPI = 110
DENG_REGION = ((0.095, 0.105), (34.8625, 34.8650))  # mm: D and R_low that Deng recommends


class Pictured(NamedTuple):
    """One figure of the report."""

    file: str
    title: str
    caption: str
    tables: tuple[str, ...]  # of its data, by the stems of their files


def plot_contours(path: Path, rings: Mapping[float, Machined]) -> None:
    """Draw figures 3 and 10: contours made by pre-deformation machining, and their low and high points.

    Parameters
    ----------
    path : of the picture.
    rings : by the rotation of one arc [°].
    """
    figure = new_figure(11, 4.2)
    contours, points = figure.subplots(1, 2, width_ratios=(1.5, 1))
    for k, (turn, ring) in enumerate(rings.items()):
        contours.plot(np.degrees(ring.azimuths), 1e3 * ring.radii, color=COLOURS[k % len(COLOURS)], lw=1.3, label=f"{turn:g}°")
    contours.set(xlabel="azimuth [°]", ylabel="raceway radius [mm]", xlim=(0, 360), xticks=range(0, 361, 60))
    contours.legend(title="rotation of one arc", frameon=False, ncols=3, fontsize=8, loc="upper center", bbox_to_anchor=(0.5, 1.0))
    contours.set_ylim(top=contours.get_ylim()[1] + 0.035)
    turns = list(rings)
    for quantity, values, look in (
        ("D value", [1e6 * ring.d_value for ring in rings.values()], 0),
        ("roundness of the low points", [1e6 * ring.roundness for ring in rings.values()], 1),
        ("rise of the highest high point", [1e6 * (ring.highs[:, 1].max() - rings[turns[0]].highs[:, 1].max()) for ring in rings.values()], 2),
        ("rise of the lowest low point", [1e6 * (ring.lows[:, 1].min() - rings[turns[0]].lows[:, 1].min()) for ring in rings.values()], 3),
    ):
        points.plot(turns, values, color=COLOURS[look], marker=MARKERS[look], ms=5, label=quantity)
    points.set(xlabel="rotation of one arc [°]", ylabel="[µm]")
    points.legend(frameon=False, fontsize=8)
    _finish(figure, path, (contours, points))


def plot_lines(path: Path, tables: Tables, name: str, x: str, profiles: Sequence[tuple[str, dict]] = ()) -> None:
    """Draw slip and life over one variable at both levels and, if given, load distributions at level slip.

    Parameters
    ----------
    path : of the picture.
    tables : by sweep and level.
    name, x : the sweep, and the column of the varied field.
    profiles : value as text, and the result of `deng2017.study.load_profile`.
    """
    figure = new_figure(15 if profiles else 10, 4.2)
    axes = figure.subplots(1, 3 if profiles else 2)
    for each, quantity in zip(axes, ("cage_slip", "rating_life")):
        _draw_levels(each, tables, name, x, quantity)
    if profiles:
        _draw_profiles(axes[2], profiles)
    _finish(figure, path, axes)


def _draw_levels(axes, tables, name, x, quantity) -> None:
    """Draw a quantity of a sweep over one variable, a line for each level."""
    for k, level in enumerate(level for sweep, level in tables if sweep == name):
        rows = tables[name, level].rows
        axes.plot(*_pair(rows, x, quantity), color=COLOURS[k], marker=MARKERS[k], ms=4, label=f"level {level}", **_LOOKS[level])
    table = tables[name, "slip"]
    axes.set(xlabel=heading(x, table.column(x).unit), ylabel=heading(quantity, table.column(quantity).unit))
    _from_zero(axes)
    axes.legend(frameon=False)


def _draw_profiles(axes, profiles) -> None:
    for k, (value, profile) in enumerate(profiles):
        azimuths = np.array(profile["azimuth"])
        order = np.argsort(np.mod(azimuths + 180.0, 360.0))  # the load line in the middle
        shown = np.mod(azimuths[order] + 180.0, 360.0) - 180.0
        axes.plot(shown, np.array(profile["inner_load"])[order], color=COLOURS[k], lw=1.4, label=f"{value}: inner")
        axes.plot(shown, np.array(profile["outer_load"])[order], color=COLOURS[k], lw=0.9, ls=":", label="outer")
    axes.set(xlabel="azimuth from the load line [°]", ylabel="mean roller load, level slip [N]", xlim=(-180, 180), xticks=range(-180, 181, 60))
    axes.set_ylim(0, axes.get_ylim()[1] * 1.3)
    axes.legend(frameon=False, fontsize=8, ncols=2)


def plot_families(path: Path, tables: Tables, name: str, x: str, quantities: Sequence[str]) -> None:
    """Draw quantities over one variable for the four low-point radii; solid at level slip, dashed at level planar.

    Parameters
    ----------
    path : of the picture.
    tables : by sweep and level.
    name, x : the sweep, and the column of the varied field.
    quantities : columns, each on its own axes.
    """
    figure = new_figure(5.1 * len(quantities), 4.4)
    axes = figure.subplots(1, len(quantities), squeeze=False)[0]
    for each, quantity in zip(axes, quantities):
        for k, low in enumerate(LOW_RADII):
            for level in ("planar", "slip"):
                rows = [row for row in tables[name, level].rows if abs(row[LOW] - low) < 1e-6]
                named = {"label": f"R_low {low:.4f} mm"} if level == "slip" else {}
                marked = {"marker": MARKERS[k], "ms": 4 if level == "slip" else 3}
                each.plot(*_pair(rows, x, quantity), color=COLOURS[k], alpha=1.0 if level == "slip" else 0.6, **marked, **named, **_LOOKS[level])
        table = tables[name, "slip"]
        each.set(xlabel=heading(x, table.column(x).unit), ylabel=heading(quantity, table.column(quantity).unit))
        if quantity == "rating_life":
            each.set_yscale("log")
        else:
            _from_zero(each)
    axes[0].legend(frameon=False, fontsize=8, title="solid: slip, dashed: planar", title_fontsize=8)
    _finish(figure, path, axes)


def _pair(rows, x, y):
    rows = sorted(rows, key=lambda row: row[x])
    return [row[x] for row in rows], [row[y] for row in rows]


def plot_map(path: Path, tables: Tables, slip_below: float = 10.0, life_above: float = 300.0) -> None:
    """Draw figure 21: slip and life over D and R_low at both levels, the limits of the design, and the region recommended by Deng.

    Parameters
    ----------
    path : of the picture.
    tables : by sweep and level.
    slip_below, life_above : limits [%], [h].
    """
    levels = [level for sweep, level in tables if sweep == "map"]
    figure = new_figure(11, 4.3 * len(levels))
    axes = figure.subplots(len(levels), 2, squeeze=False)
    for row, level in zip(axes, levels):
        table = tables["map", level]
        for each, quantity, limit in zip(row, ("cage_slip", "rating_life"), (slip_below, life_above)):
            across, up, field = on_grid(table, D_VALUE, LOW, quantity)
            map_of(each, table, D_VALUE, LOW, quantity, is_smooth=True)
            border = each.contour(across, up, field, [limit], colors="#d55e00", linewidths=2.2)
            each.clabel(border, fontsize=9, fmt={limit: f"{limit:g} {table.column(quantity).unit}"})
            (left, right), (low, high) = DENG_REGION
            each.plot([left, right, right, left, left], [low, low, high, high, low], color="black", lw=1.6, label="recommended by Deng 2017")
            each.set_title(f"level {level}")
    axes[0, 0].legend(loc="upper left", fontsize=8)
    with replaced(path) as draft:
        figure.savefig(draft, dpi=_DPI)


def plot_trajectories(path: Path, found: Mapping[float, dict], guide_clearance: float) -> None:
    """Draw the orbit of the cage centre and the spin of a roller over its azimuth.

    Parameters
    ----------
    path : of the picture.
    found : results of `deng2017.study.trajectory` by low-point radius [mm].
    guide_clearance : radial clearance of the cage in its guide [um].
    """
    figure = new_figure(3.6 * len(found), 7)
    axes = figure.subplots(2, len(found), squeeze=False)
    spins = [value for one in found.values() for value in one["spin_ratio"]]
    for k, (low, one) in enumerate(found.items()):
        orbit, spin = axes[0, k], axes[1, k]
        orbit.plot(one["cage_y"], one["cage_z"], color=COLOURS[k], lw=0.7, marker=".", ms=4)
        around = np.linspace(0, 2 * np.pi, 200)
        orbit.plot(guide_clearance * np.cos(around), guide_clearance * np.sin(around), ":", color="black", lw=0.8)
        orbit.set(aspect="equal", title=f"R_low = {low:.4f} mm", xlabel="cage centre y [µm]", ylabel="cage centre z [µm]")
        spin.plot(one["roller_angle"], one["spin_ratio"], ".", color=COLOURS[k], ms=2)
        spin.set(xlabel="azimuth of the roller [°]", ylabel="spin / spin of pure rolling", xlim=(0, 360), xticks=range(0, 361, 90))
        spin.set_ylim(min(spins) - 0.02, max(spins) + 0.02)
    limit = 1.08 * guide_clearance
    for each in axes[0]:
        each.set(xlim=(-limit, limit), ylim=(-limit, limit))
    _finish(figure, path, axes.flat)


def plot_reasons(path: Path, tables: Tables) -> None:
    """Draw slip over parameters that Deng does not give: mixture fraction and mass supported by the inner ring."""
    figure = new_figure(10, 4.0)
    axes = figure.subplots(1, 2)
    for each, (name, x) in zip(axes, (("mixture", MIXTURE), ("supported_mass", MASS))):
        _draw_levels(each, tables, name, x, "cage_slip")
    axes[0].set_title("R_low = 34.8650 mm, D = 0.105 mm", fontsize=10)
    axes[1].set_title("R_low = 34.8675 mm, D = 0.098 mm", fontsize=10)
    _finish(figure, path, axes)


def _from_zero(axes) -> None:
    axes.set_ylim(0, 1.15 * axes.dataLim.y1)


def _finish(figure, path, axes) -> None:
    from matplotlib.ticker import MaxNLocator

    for each in axes:
        each.grid(alpha=0.3)
        if each.get_yscale() == "linear" and each.get_xscale() == "linear":
            plain_numbers(each.xaxis, each.yaxis)
            if "[°]" not in each.get_xlabel():  # long tick labels of radii and speeds would overlap
                each.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    with replaced(path) as draft:
        figure.savefig(draft, dpi=_DPI)


def plot_study(folder: Path, tables: Tables, profiles: Mapping, trajectories: Mapping, rings: Mapping[float, Machined]) -> list[Pictured]:
    """Draw all figures into a folder and return their entries.

    Parameters
    ----------
    folder : for the pictures.
    tables : of sweeps, by name and level.
    profiles : load distributions by sweep, value and level.
    trajectories : by low-point radius [mm].
    rings : machined raceways by the rotation of one arc [°].
    """
    both = "Solid: level slip; dashed: level planar."

    def distributions(name):
        return [(value, one) for (sweep, value, level), one in profiles.items() if (sweep, level) == (name, "slip") and one["status"] == "ok"]

    plot_contours(folder / "fig03_10.png", rings)
    plot_lines(folder / "fig11_12.png", tables, "low_radius", LOW, distributions("low_radius"))
    plot_lines(folder / "fig13_14.png", tables, "d_value", D_VALUE, distributions("d_value"))
    plot_families(folder / "fig15_16.png", tables, "speed", SPEED, ("cage_slip", "inner_load_maximum", "outer_load_maximum"))
    plot_families(folder / "fig17_18.png", tables, "load", LOAD, ("cage_slip", "rating_life", "inner_load_maximum"))
    plot_lines(folder / "fig19_20.png", tables, "angle", ANGLE, distributions("angle"))
    plot_map(folder / "fig21.png", tables)
    plot_lines(folder / "fig22.png", tables, "roundness", ROUNDNESS)
    plot_lines(folder / "fig23.png", tables, "table2", SPEED)
    moving = {low: one for low, one in trajectories.items() if one["status"] == "ok"}
    if moving:
        cage = load_scene("deng2017_table1").bearing.cage
        plot_trajectories(folder / "trajectories.png", moving, 1e6 * cage.guide_clearance)
    plot_reasons(folder / "reasons.png", tables)
    conditions = "45,000 rpm, 800 N, D = 0.098 mm unless varied"
    shown = [
        Pictured(
            "fig03_10.png",
            "Figures 3, 10: contour by pre-deformation machining",
            "Blank pressed over three arcs at 2.0 MPa, one of them rotated; ground to the same radius under load; thin elastic ring.",
            ("machining",),
        ),
        Pictured(
            "fig11_12.png",
            "Figures 11, 12: low-point radius",
            f"Slip, life and load distribution; {conditions}.",
            ("low_radius_slip", "low_radius_planar", "load_distributions"),
        ),
        Pictured(
            "fig13_14.png", "Figures 13, 14: D value", f"R_low = 34.8625 mm; {conditions}.", ("d_value_slip", "d_value_planar", "load_distributions")
        ),
        Pictured(
            "fig15_16.png",
            "Figures 15, 16: shaft speed",
            f"Slip, largest loads. {both} The inner ring vibrates (planar) around 25,000 rpm, and above 42,000 where R_low is large.",
            ("speed_slip", "speed_planar"),
        ),
        Pictured(
            "fig17_18.png", "Figures 17, 18: radial load", f"Slip, life and largest roller load, inner raceway. {both}", ("load_slip", "load_planar")
        ),
        Pictured(
            "fig19_20.png",
            "Figures 19, 20: installation angle",
            f"R_low = 34.8625 mm; {conditions}.",
            ("angle_slip", "angle_planar", "load_distributions"),
        ),
        Pictured(
            "fig21.png",
            "Figure 21: slip and life over D and R_low",
            "Orange: 10 % slip and 300 h. Black: the region recommended by Deng.",
            ("map_slip", "map_planar"),
        ),
        Pictured("fig22.png", "Figure 22: roundness of the low points", "R_low = 34.8625 mm, D = 0.095 mm.", ("roundness_slip", "roundness_planar")),
        Pictured("fig23.png", "Figure 23: bearing of Table 2", "R_low = 34.824 mm, D = 0.06 mm, 800 N.", ("table2_slip", "table2_planar")),
        Pictured(
            "trajectories.png",
            "Trajectories: cage centre and roller spin",
            "Twelve cage turns at level planar, 45,000 rpm, 800 N. Dotted: clearance of the guide; a single dot is a cage centre at rest.",
            ("trajectories",),
        ),
        Pictured(
            "reasons.png",
            "Parameters that the paper does not give",
            "Oil fraction of the oil-air mixture, and mass of the shaft that moves with the inner ring. Nothing is tuned with them.",
            ("mixture_slip", "mixture_planar", "supported_mass_slip", "supported_mass_planar"),
        ),
    ]
    return [each for each in shown if (folder / each.file).exists()]
