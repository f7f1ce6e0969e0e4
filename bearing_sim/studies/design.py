# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Which outer raceways keep the cage's slip below a limit and the life above another, over low-point radius and D value.

Speed and load may be off by tolerances: a raceway meets the limits in the worst case where it does at all nine combinations of
the scene's speed and load and their ends.  Borders of the region are then narrowed by bisection, to a few nanometres of radius.
"""

import dataclasses
import itertools
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, load_scene
from bearing_sim.sweep.axis import Axis, axis
from bearing_sim.sweep.executor import run_tasks
from bearing_sim.sweep.journal import Journal
from bearing_sim.sweep.point import OK, REFUSED, UNSETTLED, Column, point_row
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.tasks import task

LOW, D_VALUE = "bearing.outer_raceway.low_radius", "bearing.outer_raceway.d_value"
NOMINAL, WORST = "nominal", "worst"
KINDS = (NOMINAL, WORST)
_HALVINGS = 7
_BELOW, _ABOVE, _RADII = 2.5e-6, 5e-6, 16  # of the default range of radii, about the scene's [m]
_SHARE, _D_VALUES = 0.2, 9
_NUMBERS = (
    Column("nominal_slip", "%", "cage slip at the scene's speed and load"),
    Column("nominal_life", "h", "rating life there, by the scene's choice"),
    Column("worst_slip", "%", "largest cage slip within the tolerances of speed and load"),
    Column("worst_life", "h", "shortest rating life within them"),
)
COLUMNS = (
    Column(LOW, "mm", "radius at the low points, R_low"),
    Column(D_VALUE, "mm", "high-point radius less low-point radius, D"),
    *_NUMBERS,
    Column("meets_nominal", "", "whether slip and life keep their limits at the scene's speed and load"),
    Column("meets_worst", "", "whether they do within the tolerances"),
    Column("status", "", "ok, unsettled, failed or refused"),
    Column("reason", "", "why, where it is not ok"),
)
BORDER_COLUMNS = (
    Column("kind", "", "nominal: at the scene's speed and load; worst: within the tolerances"),
    Column(D_VALUE, "mm", "high-point radius less low-point radius, D"),
    Column("low_radius_from", "mm", "least radius at the low points that meets the limits"),
    Column("low_radius_to", "mm", "largest one"),
    Column("bound_below_by", "", "what ends the region there: slip, life, no result, or the range that was searched"),
    Column("bound_above_by", "", "what ends it there"),
)


class Wanted(NamedTuple):
    """What a raceway shall meet, and how far speed and load may be off.

    Attributes
    ----------
    slip_below : largest cage slip [%].
    life_above : least life [h].
    speed_tolerance, load_tolerance : either way, as shares.
    """

    slip_below: float
    life_above: float
    speed_tolerance: float = 0.0
    load_tolerance: float = 0.0

    def met(self, row: dict, kind: str) -> bool:
        """Return whether a row's slip and life keep the limits; never where there is no result."""
        return row[f"{kind}_slip"] < self.slip_below and row[f"{kind}_life"] > self.life_above

    def broken_by(self, row: dict, kind: str) -> str:
        """Return which limit a row breaks, in words."""
        slip, life = row[f"{kind}_slip"], row[f"{kind}_life"]
        if not math.isfinite(slip) or math.isnan(life):
            return "no result"
        return " and ".join(name for name, broken in (("slip", slip >= self.slip_below), ("life", life <= self.life_above)) if broken)


class Border(NamedTuple):
    """Where the region begins and ends at one D value; lengths in mm."""

    kind: str
    d_value: float
    low_from: float
    low_to: float
    below_by: str
    above_by: str


class Designed(NamedTuple):
    """What was found: all raceways of the grid, and the borders of the regions."""

    grid: Table
    borders: list[Border]

    @property
    def border_table(self) -> Table:
        """The borders as a table."""
        names = [column.name for column in BORDER_COLUMNS]
        return Table(BORDER_COLUMNS, [dict(zip(names, border)) for border in self.borders], self.grid.about | {"kind": "design borders"})


def default_axes(scene: Scene) -> tuple[Axis, Axis]:
    """Return the radii and D values that are searched about a scene's own."""
    raceway = scene.bearing.outer_raceway
    radii = np.linspace(raceway.low_radius - _BELOW, raceway.low_radius + _ABOVE, _RADII)
    d_values = np.linspace(1 - _SHARE, 1 + _SHARE, _D_VALUES) * raceway.d_value
    return tuple(axis(path, [float(f"{value:.9g}") for value in values.tolist()]) for path, values in ((LOW, radii), (D_VALUE, d_values)))


def raceway_row(scene: Scene, duration: float, speed_tolerance: float, load_tolerance: float) -> dict:
    """Return slip and life of a raceway, nominal and worst within tolerances.

    Parameters
    ----------
    scene : with the raceway.
    duration : see `bearing_sim.sweep.point.settle`.
    speed_tolerance, load_tolerance : either way, as shares.
    """
    shares = list(itertools.product(*(dict.fromkeys((0.0, -each, each)) for each in (speed_tolerance, load_tolerance))))
    rows = []
    for speed, load in shares:  # the nominal ones first
        operating = dataclasses.replace(
            scene.operating, shaft_speed=scene.operating.shaft_speed * (1 + speed), radial_load=scene.operating.radial_load * (1 + load)
        )
        rows.append(point_row(dataclasses.replace(scene, operating=operating), duration))
        if rows[-1]["status"] not in (OK, UNSETTLED):
            return dict.fromkeys((column.name for column in _NUMBERS), math.nan) | {name: rows[-1][name] for name in ("status", "reason")}
    unsettled = [row["reason"] for row in rows if row["status"] == UNSETTLED]
    return {
        "nominal_slip": rows[0]["cage_slip"],
        "nominal_life": rows[0]["modified_rating_life"],
        "worst_slip": max(row["cage_slip"] for row in rows),
        "worst_life": min(row["modified_rating_life"] for row in rows),
        "status": UNSETTLED if unsettled else OK,
        "reason": unsettled[0] if unsettled else "",
    }


def design(
    name: str,
    overrides: Sequence[str],
    wanted: Wanted,
    radii: Axis,
    d_values: Axis,
    journal: Journal,
    duration: float,
    workers: int | None = None,
    dask: str | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> Designed:
    """Map which raceways meet what is wanted.

    Parameters
    ----------
    name, overrides : of the scene, its level among them.
    wanted : limits and tolerances.
    radii, d_values : that are searched; the region is looked for between the least and the largest.
    journal : of finished raceways.
    duration, workers, dask, tell : see `bearing_sim.sweep.grid.sweep`.

    Raises
    ------
    SceneError
        No raceway of the grid can be: the faults are those of the first.
    """
    executor = workers, dask, tell
    places = list(itertools.product(sorted(radii.values), sorted(d_values.values)))
    scenes = {place: _scene_at(name, overrides, place) for place in places}
    grid = _computed(wanted, scenes, journal, duration, executor)
    if all(row["status"] == REFUSED for row in grid.values()):
        raise scenes[places[0]]
    thin = {place: _scene_at(name, overrides, place) for place in _within_gaps(wanted, scenes, grid, journal, duration, executor)}
    rows = grid | _computed(wanted, thin, journal, duration, executor)
    ends = [end for kind in KINDS for d_value in sorted(d_values.values) for end in _ends(kind, d_value, rows, wanted)]
    borders = _borders(ends, _narrowed(wanted, scenes | thin, [edge for end in ends for edge in end], journal, duration, executor))
    about = {
        "kind": "design",
        "scene": name,
        "overrides": list(overrides),
        "level": load_scene(name, overrides).level,
        "wanted": wanted._asdict(),
        "axes": [{"field": each.field.path, "unit": each.field.unit, "values": each.shown} for each in (radii, d_values)],
    }
    return Designed(Table(COLUMNS, [_told(place, row, wanted) for place, row in grid.items()], about), borders)


def _scene_at(name, overrides, place) -> Scene | SceneError:
    try:
        return load_scene(name, [*overrides, f"{LOW}={place[0]!r}", f"{D_VALUE}={place[1]!r}"])
    except SceneError as fault:
        return fault


def _computed(wanted, scenes, journal, duration, executor) -> dict[tuple, dict]:
    """Return the row of each place."""
    workers, dask, tell = executor
    possible = {place: scene for place, scene in scenes.items() if isinstance(scene, Scene)}
    spread = wanted.speed_tolerance, wanted.load_tolerance
    tasks = [task(scene.level, raceway_row, scene, duration, *spread) for scene in possible.values()]
    results = dict(zip(possible, run_tasks(tasks, journal, workers, dask, tell)))
    nothing = dict.fromkeys((column.name for column in _NUMBERS), math.nan)
    return {
        place: nothing | (results[place] if place in results else {"status": REFUSED, "reason": "; ".join(map(str, scene.faults))})
        for place, scene in scenes.items()
    }


def _narrowed(wanted, scenes, edges, journal, duration, executor) -> list[tuple[float, str]]:
    """Return radius and what breaks the limits beyond it, edge by edge."""
    workers, dask, tell = executor
    open_edges = [edge for edge in edges if edge.outside is not None]
    tasks = [task("edge", narrowed, scenes[edge.inside, edge.d_value], duration, wanted, edge.kind, edge.inside, edge.outside) for edge in open_edges]
    results = dict(zip(open_edges, run_tasks(tasks, journal, workers, dask, tell)))
    return [
        (results[edge].get("inside", edge.inside), results[edge].get("broken_by") or edge.broken_by)
        if edge in results
        else (edge.inside, edge.broken_by)
        for edge in edges
    ]


def _told(place, row, wanted) -> dict:
    lengths = {LOW: float(f"{1e3 * place[0]:.9g}"), D_VALUE: float(f"{1e3 * place[1]:.9g}")}
    texts = {name: row[name] for name in ("status", "reason")}
    return lengths | {column.name: row[column.name] for column in _NUMBERS} | {f"meets_{kind}": wanted.met(row, kind) for kind in KINDS} | texts


class _Edge(NamedTuple):
    """One end of the region at one D value: a radius that meets the limits, one next to it that does not (None at the end of the grid)."""

    kind: str
    d_value: float
    inside: float
    outside: float | None
    broken_by: str


def narrowed(scene: Scene, duration: float, wanted: Wanted, kind: str, inside: float, outside: float) -> dict:
    """Return the radius nearest to ``outside`` that was seen to meet the limits, and what breaks them beyond, by bisection.

    Parameters
    ----------
    scene : with the D value.
    duration : see `bearing_sim.sweep.point.settle`.
    wanted, kind : limits, and whether they are kept at the scene's speed and load or within tolerances.
    inside, outside : radii, of which the first meets the limits and the second does not [m].
    """
    broken_by, tolerances = "", (wanted.speed_tolerance, wanted.load_tolerance) if kind == WORST else (0.0, 0.0)
    for _ in range(_HALVINGS):
        middle = 0.5 * (inside + outside)
        raceway = dataclasses.replace(scene.bearing.outer_raceway, low_radius=middle)
        row = raceway_row(dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, outer_raceway=raceway)), duration, *tolerances)
        if wanted.met(row, kind):
            inside = middle
        else:
            outside, broken_by = middle, wanted.broken_by(row, kind)
    return {"inside": inside, "outside": outside, "broken_by": broken_by}


def met_between(scene: Scene, duration: float, wanted: Wanted, kind: str, left: float, right: float) -> dict:
    """Return a radius between two that meets the limits, or None, where one of the two breaks one limit and the other breaks the other.

    Parameters
    ----------
    scene, duration, wanted, kind : as of `narrowed`.
    left, right : radii [m]; the first breaks the life's limit alone, the second that of slip.
    """
    tolerances = (wanted.speed_tolerance, wanted.load_tolerance) if kind == WORST else (0.0, 0.0)
    for _ in range(_HALVINGS):
        middle = 0.5 * (left + right)
        raceway = dataclasses.replace(scene.bearing.outer_raceway, low_radius=middle)
        row = raceway_row(dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, outer_raceway=raceway)), duration, *tolerances)
        if wanted.met(row, kind):
            return {"inside": middle}
        broken_by = wanted.broken_by(row, kind)
        if broken_by == "life":
            left = middle
        elif broken_by == "slip":
            right = middle
        else:
            break
    return {"inside": None}


def _within_gaps(wanted, scenes, rows, journal, duration, executor) -> list[tuple]:
    """Return places between those of the grid that meet the limits where the region is thinner than the grid's steps."""
    gaps = []
    for kind, d_value in itertools.product(KINDS, sorted({place[1] for place in rows})):
        radii = sorted(radius for radius, d in rows if d == d_value)
        for left, right in itertools.pairwise(radii):
            breaks = [wanted.broken_by(rows[radius, d_value], kind) for radius in (left, right)]
            if breaks == ["life", "slip"]:
                gaps.append((kind, d_value, left, right))
    workers, dask, tell = executor
    tasks = [task("gap", met_between, scenes[left, d_value], duration, wanted, kind, left, right) for kind, d_value, left, right in gaps]
    results = run_tasks(tasks, journal, workers, dask, tell)
    return [(result["inside"], gap[1]) for gap, result in zip(gaps, results) if result.get("inside") is not None]


def _borders(ends, narrowed_edges) -> list[Border]:
    """Return the borders from the ends of the region's stretches and, in their order, radius and what breaks the limits beyond each edge."""
    found, borders = iter(narrowed_edges), []
    for low, _ in ends:
        (low_from, below_by), (low_to, above_by) = next(found), next(found)
        borders.append(Border(low.kind, float(f"{1e3 * low.d_value:.9g}"), round(1e3 * low_from, 6), round(1e3 * low_to, 6), below_by, above_by))
    return borders


def _ends(kind, d_value, rows, wanted) -> list[tuple[_Edge, _Edge]]:
    """Return the ends of every stretch of radii that meets the limits at a D value, as far as the rows tell them."""
    radii = sorted(radius for radius, d in rows if d == d_value)
    met = [wanted.met(rows[radius, d_value], kind) for radius in radii]
    found = []
    for is_met, stretch in itertools.groupby(range(len(radii)), key=lambda k: met[k]):
        if not is_met:
            continue
        stretch = list(stretch)
        edges = []
        for inside, outside in ((stretch[0], stretch[0] - 1), (stretch[-1], stretch[-1] + 1)):
            beyond = radii[outside] if 0 <= outside < len(radii) else None
            broken_by = "range" if beyond is None else wanted.broken_by(rows[beyond, d_value], kind)
            edges.append(_Edge(kind, d_value, radii[inside], beyond, broken_by))
        found.append(tuple(edges))
    return found
