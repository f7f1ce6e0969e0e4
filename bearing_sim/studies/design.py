# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Design study: the outer raceways, over low-point radius and D value, with slip below one limit and life above another.

Speed and load have tolerances: a raceway meets the limits in the worst case if it meets them at all nine combinations of nominal,
lowest and highest speed and load.  Bisection then locates the borders of the region to a few nanometres of radius.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.model.validity import merged
from bearing_sim.scene.loader import SceneError, load_scene
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import with_values
from bearing_sim.sweep.grid import Axis, axis, one_line, scene_at
from bearing_sim.sweep.point import OK, REFUSED, UNSETTLED, Column, point_row
from bearing_sim.sweep.table import Table, new_figure, on_grid
from bearing_sim.sweep.tasks import Journal, Task, run_tasks, task

LOW, D_VALUE = "bearing.outer_raceway.low_radius", "bearing.outer_raceway.d_value"
NOMINAL, WORST = "nominal", "worst"
KINDS = (NOMINAL, WORST)
_HALVINGS = 7
_BELOW, _ABOVE, _RADII = 2.5e-6, 5e-6, 16  # default range of radii about the scene's [m], and their number
_D_RANGE, _D_VALUES = 0.2, 9  # default range of D values, relative to the scene's, and their number
_NUMBERS = (
    Column("nominal_slip", "%", "cage slip at the scene's speed and load"),
    Column("nominal_life", "h", "rating life there, as chosen in the scene"),
    Column("worst_slip", "%", "largest cage slip within the tolerances of speed and load"),
    Column("worst_life", "h", "shortest rating life within the tolerances"),
)
COLUMNS = (
    Column(LOW, "mm", "radius at the low points, R_low"),
    Column(D_VALUE, "mm", "high-point radius minus low-point radius, D"),
    *_NUMBERS,
    Column("meets_nominal", "", "whether slip and life meet the limits at the scene's speed and load"),
    Column("meets_worst", "", "whether they meet the limits within the tolerances"),
    Column("status", "", "ok, unsettled, failed or refused"),
    Column("reason", "", "why the status is not ok"),
    Column("warnings", "", "laws used outside of their ranges within the tolerances, each with a value"),
)
BORDER_COLUMNS = (
    Column("kind", "", "nominal: at the scene's speed and load; worst: within the tolerances"),
    Column(D_VALUE, "mm", "high-point radius minus low-point radius, D"),
    Column("low_radius_from", "mm", "smallest low-point radius that meets the limits"),
    Column("low_radius_to", "mm", "largest low-point radius that meets the limits"),
    Column("bound_below_by", "", "what bounds the region at low_radius_from: slip, life, no result, or the searched range"),
    Column("bound_above_by", "", "what bounds it at low_radius_to"),
)


class Limits(NamedTuple):
    """Limits of a raceway, and tolerances of speed and load.

    Attributes
    ----------
    slip_below : limit of the cage slip [%].
    life_above : limit of the life [h].
    speed_tolerance, load_tolerance : relative, in both directions.
    """

    slip_below: float
    life_above: float
    speed_tolerance: float = 0.0
    load_tolerance: float = 0.0

    def met(self, row: dict, kind: str) -> bool:
        """Return whether slip and life of a row meet the limits; False without a result."""
        return row[f"{kind}_slip"] < self.slip_below and row[f"{kind}_life"] > self.life_above

    def broken_by(self, row: dict, kind: str) -> str:
        """Return which limit a row violates, or that it has no result."""
        slip, life = row[f"{kind}_slip"], row[f"{kind}_life"]
        if not math.isfinite(slip) or math.isnan(life):
            return "no result"
        return " and ".join(name for name, broken in (("slip", slip >= self.slip_below), ("life", life <= self.life_above)) if broken)


class Border(NamedTuple):
    """Ends of the region at one D value; lengths in mm."""

    kind: str
    d_value: float
    low_from: float
    low_to: float
    below_by: str
    above_by: str


class Designed(NamedTuple):
    """Results: all raceways of the grid, and the borders of the regions."""

    grid: Table
    borders: list[Border]

    @property
    def border_table(self) -> Table:
        """The borders as a table."""
        names = [column.name for column in BORDER_COLUMNS]
        return Table(BORDER_COLUMNS, [dict(zip(names, border)) for border in self.borders], self.grid.about | {"kind": "design borders"})


def default_axes(scene: Scene) -> tuple[Axis, Axis]:
    """Return the default radii and D values about those of a scene."""
    raceway = scene.bearing.outer_raceway
    radii = np.linspace(raceway.low_radius - _BELOW, raceway.low_radius + _ABOVE, _RADII)
    d_values = np.linspace(1 - _D_RANGE, 1 + _D_RANGE, _D_VALUES) * raceway.d_value
    return tuple(axis(path, [float(f"{value:.9g}") for value in values.tolist()]) for path, values in ((LOW, radii), (D_VALUE, d_values)))


def raceway_row(scene: Scene, duration: float, speed_tolerance: float, load_tolerance: float) -> dict:
    """Return slip and life of a raceway, nominal and worst case within the tolerances.

    Parameters
    ----------
    scene : with the raceway.
    duration : see `bearing_sim.sweep.point.settle`.
    speed_tolerance, load_tolerance : relative, in both directions.
    """
    deviations = list(itertools.product(*(dict.fromkeys((0.0, -each, each)) for each in (speed_tolerance, load_tolerance))))
    rows = []
    for speed, load in deviations:  # the nominal point first
        operating = dataclasses.replace(
            scene.operating, shaft_speed=scene.operating.shaft_speed * (1 + speed), radial_load=scene.operating.radial_load * (1 + load)
        )
        rows.append(point_row(dataclasses.replace(scene, operating=operating), duration))
        if rows[-1]["status"] not in (OK, UNSETTLED):
            return dict.fromkeys((column.name for column in _NUMBERS), math.nan) | {name: rows[-1][name] for name in ("status", "reason", "warnings")}
    unsettled = [row["reason"] for row in rows if row["status"] == UNSETTLED]
    return {
        "nominal_slip": rows[0]["cage_slip"],
        "nominal_life": rows[0]["modified_rating_life"],
        "worst_slip": max(row["cage_slip"] for row in rows),
        "worst_life": min(row["modified_rating_life"] for row in rows),
        "status": UNSETTLED if unsettled else OK,
        "reason": unsettled[0] if unsettled else "",
        "warnings": merged(row["warnings"] for row in rows),
    }


def design(
    name: str,
    overrides: Sequence[str],
    limits: Limits,
    radii: Axis,
    d_values: Axis,
    journal: Journal,
    duration: float,
    workers: int | None = None,
    dask: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Designed:
    """Map which raceways meet the limits.

    Parameters
    ----------
    name, overrides : of the scene, its level among them.
    limits : to meet.
    radii, d_values : of the grid; the region is searched between the smallest and the largest.
    journal : of finished raceways, which are not computed again.
    duration, workers, dask, progress : see `bearing_sim.sweep.grid.sweep`.

    Raises
    ------
    SceneError
        No raceway of the grid has a valid scene; the errors are those of the first.
    """
    study = _Study(limits, duration, partial(run_tasks, journal=journal, workers=workers, dask=dask, progress=progress))
    points = list(itertools.product(sorted(radii.values), sorted(d_values.values)))
    scenes = {point: scene_at(name, overrides, (radii, d_values), point) for point in points}
    grid = study.rows(scenes)
    if all(row["status"] == REFUSED for row in grid.values()):
        raise scenes[points[0]]
    thin = {point: scene_at(name, overrides, (radii, d_values), point) for point in study.points_in_gaps(scenes, grid)}
    rows = grid | study.rows(thin)
    ends = [end for kind in KINDS for d_value in sorted(d_values.values) for end in _ends(kind, d_value, rows, limits)]
    borders = _borders(ends, study.narrowed_edges(scenes | thin, [edge for end in ends for edge in end]))
    about = {
        "kind": "design",
        "scene": name,
        "overrides": list(overrides),
        "level": load_scene(name, overrides).level,
        "wanted": limits._asdict(),
        "axes": [{"field": each.field.path, "unit": each.field.unit, "values": each.shown} for each in (radii, d_values)],
    }
    return Designed(Table(COLUMNS, [_table_row(point, row, limits) for point, row in grid.items()], about), borders)


class _Study(NamedTuple):
    """What all tasks of one study share, and how they run."""

    limits: Limits
    duration: float
    run: Callable[[Sequence[Task]], list[dict]]

    def rows(self, scenes: dict[tuple, Scene | SceneError]) -> dict[tuple, dict]:
        """Return the row of each point (radius, D value)."""
        valid = {point: scene for point, scene in scenes.items() if isinstance(scene, Scene)}
        tolerances = self.limits.speed_tolerance, self.limits.load_tolerance
        results = dict(zip(valid, self.run([task(scene.level, raceway_row, scene, self.duration, *tolerances) for scene in valid.values()])))
        nothing = dict.fromkeys((column.name for column in _NUMBERS), math.nan)
        return {
            point: nothing | (results[point] if point in results else {"status": REFUSED, "reason": one_line(scene), "warnings": ""})
            for point, scene in scenes.items()
        }

    def points_in_gaps(self, scenes: dict[tuple, Scene | SceneError], rows: dict[tuple, dict]) -> list[tuple]:
        """Return points between those of the grid that meet the limits, where the region is thinner than the steps of the grid."""
        gaps = []
        for kind, d_value in itertools.product(KINDS, sorted({point[1] for point in rows})):
            radii = sorted(radius for radius, d in rows if d == d_value)
            for left, right in itertools.pairwise(radii):
                if [self.limits.broken_by(rows[radius, d_value], kind) for radius in (left, right)] == ["life", "slip"]:
                    gaps.append((kind, d_value, left, right))
        fixed = self.duration, self.limits
        results = self.run([task("gap", met_between, scenes[left, d_value], *fixed, kind, left, right) for kind, d_value, left, right in gaps])
        return [(result["inside"], gap[1]) for gap, result in zip(gaps, results) if result.get("inside") is not None]

    def narrowed_edges(self, scenes: dict[tuple, Scene], edges: list["_Edge"]) -> list[tuple[float, str]]:
        """Return the radius of each edge, and what breaks the limits beyond it."""
        found = {edge: (edge.inside, edge.broken_by) for edge in edges}
        between = [edge for edge in edges if edge.outside is not None]
        tasks = [
            task("edge", narrowed, scenes[edge.inside, edge.d_value], self.duration, self.limits, edge.kind, edge.inside, edge.outside)
            for edge in between
        ]
        for edge, result in zip(between, self.run(tasks)):
            found[edge] = result.get("inside", edge.inside), result.get("broken_by") or edge.broken_by
        return [found[edge] for edge in edges]


def _table_row(point, row, limits) -> dict:
    lengths = {LOW: float(f"{1e3 * point[0]:.9g}"), D_VALUE: float(f"{1e3 * point[1]:.9g}")}
    texts = {"status": row["status"], "reason": row["reason"], "warnings": row.get("warnings", "")}  # a lost worker's has none
    return lengths | {column.name: row[column.name] for column in _NUMBERS} | {f"meets_{kind}": limits.met(row, kind) for kind in KINDS} | texts


class _Edge(NamedTuple):
    """One end of the region at one D value: a radius that meets the limits and its neighbour that does not (None at the end of the grid)."""

    kind: str
    d_value: float
    inside: float
    outside: float | None
    broken_by: str


def _row_at_radius(scene: Scene, duration: float, limits: Limits, kind: str, radius: float) -> dict:
    """Return the row of a scene with another low-point radius [m]; with the tolerances only for the worst case."""
    tolerances = (limits.speed_tolerance, limits.load_tolerance) if kind == WORST else (0.0, 0.0)
    return raceway_row(with_values(scene, {LOW: radius}), duration, *tolerances)


def narrowed(scene: Scene, duration: float, limits: Limits, kind: str, inside: float, outside: float) -> dict:
    """Return, by bisection, the radius nearest to ``outside`` that meets the limits, and what breaks them beyond.

    The limits are two conditions on results that may be absent, not one continuous function; hence no root finder.

    Parameters
    ----------
    scene : with the D value.
    duration : see `bearing_sim.sweep.point.settle`.
    limits, kind : limits, and whether they apply at the scene's speed and load or within the tolerances.
    inside, outside : radii [m]; the first meets the limits, the second does not.
    """
    broken_by = ""
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        row = _row_at_radius(scene, duration, limits, kind, middle)
        if limits.met(row, kind):
            inside = middle
        else:
            outside, broken_by = middle, limits.broken_by(row, kind)
    return {"inside": inside, "outside": outside, "broken_by": broken_by}


def met_between(scene: Scene, duration: float, limits: Limits, kind: str, left: float, right: float) -> dict:
    """Return a radius between two others that meets the limits, or None if none was found.

    Parameters
    ----------
    scene, duration, limits, kind : as for `narrowed`.
    left, right : radii [m]; the first violates only the limit of life, the second only that of slip.
    """
    for _ in range(_HALVINGS):
        middle = 0.5 * (left + right)
        row = _row_at_radius(scene, duration, limits, kind, middle)
        if limits.met(row, kind):
            return {"inside": middle}
        broken_by = limits.broken_by(row, kind)
        if broken_by == "life":
            left = middle
        elif broken_by == "slip":
            right = middle
        else:
            break
    return {"inside": None}


def _borders(ends, narrowed_edges) -> list[Border]:
    """Return the borders from the ends of the region and, in the same order, radius and violated limit of each edge."""
    found, borders = iter(narrowed_edges), []
    for low, _ in ends:
        (low_from, below_by), (low_to, above_by) = next(found), next(found)
        borders.append(Border(low.kind, float(f"{1e3 * low.d_value:.9g}"), round(1e3 * low_from, 6), round(1e3 * low_to, 6), below_by, above_by))
    return borders


def _ends(kind, d_value, rows, limits) -> list[tuple[_Edge, _Edge]]:
    """Return both ends of every interval of radii whose rows meet the limits at a D value."""
    radii = sorted(radius for radius, d in rows if d == d_value)
    met = [limits.met(rows[radius, d_value], kind) for radius in radii]
    found = []
    for is_met, interval in itertools.groupby(range(len(radii)), key=lambda k: met[k]):
        if not is_met:
            continue
        interval = list(interval)
        edges = []
        for inside, outside in ((interval[0], interval[0] - 1), (interval[-1], interval[-1] + 1)):
            beyond = radii[outside] if 0 <= outside < len(radii) else None
            broken_by = "range" if beyond is None else limits.broken_by(rows[beyond, d_value], kind)
            edges.append(_Edge(kind, d_value, radii[inside], beyond, broken_by))
        found.append(tuple(edges))
    return found


_SLIP, _LIFE = "#b2451f", "#0072b2"
_REGIONS = {NOMINAL: {"facecolor": "#cfe8d8", "edgecolor": "#3d8b5e", "label": "meets both limits"}}
_REGIONS[WORST] = {"facecolor": "#7fc49b", "edgecolor": "#1d5c39", "label": "meets both limits within the tolerances"}


def draw(path: Path, designed: Designed, beside: tuple[str, tuple[float, float], tuple[float, float]] | None = None) -> None:
    """Draw the regions and isolines of slip and life into a file.

    Parameters
    ----------
    path : its suffix gives the format: .png, .svg or .pdf.
    designed : the results.
    beside : another answer to show: its label, and its ranges of D values and radii [mm].
    """
    figure = new_figure(9, 6.2)
    axes = figure.subplots()
    for kind, look in _REGIONS.items():
        _fill(axes, [border for border in designed.borders if border.kind == kind], look)
    limits = designed.grid.about["wanted"]
    for quantity, colour, limit, unit in (("nominal_slip", _SLIP, limits["slip_below"], "%"), ("nominal_life", _LIFE, limits["life_above"], "h")):
        _isolines(axes, designed, quantity, colour, limit, unit)
    if beside is not None:
        name, (left, right), (low, high) = beside
        axes.plot([left, right, right, left, left], [low, low, high, high, low], color="black", lw=1.8, label=name)
    axes.plot([], [], color=_SLIP, label="cage slip [%]")
    axes.plot([], [], color=_LIFE, label="life [h]")
    axes.set(xlabel="D value [mm]", ylabel="low-point radius R_low [mm]")
    axes.ticklabel_format(useOffset=False)
    figure.legend(*axes.get_legend_handles_labels(), loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    tolerances = f"speed ±{100 * limits['speed_tolerance']:g} %, load ±{100 * limits['load_tolerance']:g} %"
    about = designed.grid.about
    wanted = f"slip below {limits['slip_below']:g} %, life above {limits['life_above']:g} h"
    figure.suptitle(f"{about['scene']} at level {about['level']}: {wanted}; tolerances {tolerances}", fontsize=10)
    figure.savefig(path, dpi=130)


def _fill(axes, borders, look) -> None:
    """Fill the region; if it has several intervals at a D value, draw each one."""
    d_values = sorted({border.d_value for border in borders})
    intervals = {d: sorted((border.low_from, border.low_to) for border in borders if border.d_value == d) for d in d_values}
    if d_values and all(len(each) == 1 for each in intervals.values()):
        low, high = ([intervals[d][0][end] for d in d_values] for end in (0, 1))
        axes.fill_between(d_values, low, high, lw=1.6, **look)
        return
    for k, (d_value, each) in enumerate(intervals.items()):
        for low, high in each:
            axes.plot([d_value, d_value], [low, high], color=look["edgecolor"], lw=6, solid_capstyle="butt", label=look["label"] if k == 0 else None)


def _isolines(axes, designed, quantity, colour, limit, unit) -> None:
    across, up, field = on_grid(designed.grid, D_VALUE, LOW, quantity)
    finite = field[np.isfinite(field)]
    if min(field.shape) < 2 or not finite.size or not np.ptp(finite) > 0:
        return
    levels = sorted({float(f"{level:.2g}") for level in np.quantile(finite, (0.15, 0.3, 0.45, 0.6, 0.75, 0.9))} - {limit})
    column = 1 if unit == "%" else -2  # label slip on the left and life on the right, so that labels do not overlap
    for each, width in ((levels, 0.7), ([limit], 2.0)):
        lines = axes.contour(across, up, field, each, colors=colour, linewidths=width)
        order = np.argsort(field[:, column])
        inside = [level for level in each if np.nanmin(field[:, column]) < level < np.nanmax(field[:, column])]
        positions = [(across[column], np.interp(level, field[order, column], up[order])) for level in inside]
        if positions:
            axes.clabel(lines, inside, fontsize=9, fmt={level: f"{level:g} {unit}" for level in inside}, manual=positions)
