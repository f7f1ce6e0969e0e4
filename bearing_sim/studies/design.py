# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Design study: the outer raceways, over low-point radius and D value, with slip below one limit and life above another.

At several operating points slip must stay below its limit at each, and life is that of the mission.  Speed, load and dimensions have
tolerances: a raceway meets the limits in the worst case if it meets them at all nine combinations of nominal, lowest and highest speed
and load, with every dimension off alone in both directions, and with all of them off together in the directions that are worst.
Bisection locates the borders of the region to a few nanometres of radius.  A level of higher fidelity then verifies edges and centre of
each interval of radii, and narrows or withdraws what it refuses.
"""

import itertools
import math
import textwrap
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.model.validity import merged
from bearing_sim.scene.display import hours, number
from bearing_sim.scene.loader import SceneError, load_scene, scene_to_yaml
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import with_values
from bearing_sim.studies.columns import columns_of
from bearing_sim.studies.sheet import loads_text
from bearing_sim.sweep.conditions import Conditions, OperatingPoint, PointError, combined_life, scene_at_point
from bearing_sim.sweep.grid import Axis, axis, one_line, scene_at
from bearing_sim.sweep.pictures import legend_below, new_figure, on_grid, plain_numbers, save, with_gaps
from bearing_sim.sweep.point import OK, REFUSED, UNSETTLED, point_row
from bearing_sim.sweep.table import Table, read_table, write_table
from bearing_sim.sweep.tasks import IN_MEMORY, Execution, Task, task

LOW, D_VALUE = "bearing.outer_raceway.low_radius", "bearing.outer_raceway.d_value"
NOMINAL, WORST = "nominal", "worst"
KINDS = (NOMINAL, WORST)
VERIFIED_BY = {"steady": "planar", "slip": "planar", "planar": "spatial"}  # the next level that includes what the level leaves out
# What a level does not verify of another, because it leaves out the same.
ALIKE = {
    (
        "steady",
        "slip",
    ): "level slip integrates the equations whose periodic state level steady solves; pocket play, radial vibration and cage whirl are "
    "not verified (--verify-level planar)",
    ("planar", "spatial"): "level spatial adds tilt and skew only; without a moment or misalignment it agrees with level planar",
}
CONFIRMED, NARROWED, WITHDRAWN, NOT_VERIFIED = "confirmed", "narrowed", "withdrawn", "not verified"
END_OF_MAP = "end of the map"  # bounds an interval whose last raceway of the map meets the limits
STATE = "each raceway in the state that its cage comes to from ideal rolling"
_HALVINGS = 7
_ROUNDS = 4  # of narrowing an interval until its edges and its centre meet the limits at the level that verifies
_BELOW, _ABOVE, _RADII = 2.5e-6, 5e-6, 16  # default range of radii about the scene's [m], and their number
_D_RANGE, _D_VALUES = 0.2, 9  # default range of D values, relative to the scene's, and their number
COLUMNS, BORDER_COLUMNS, CHECK_COLUMNS = (columns_of(f"design{part}") for part in ("", " borders", " checks"))
_NUMBERS = [column.name for column in COLUMNS if column.unit in ("%", "h")]
_NOTHING = dict.fromkeys(_NUMBERS, math.nan)


class Limits(NamedTuple):
    """Limits of a raceway, and the conditions in which it must meet them.

    Attributes
    ----------
    slip_below : limit of the cage slip [%].
    life_above : limit of the life [h].
    conditions : operating points and tolerances.
    """

    slip_below: float
    life_above: float
    conditions: Conditions = Conditions()

    def conditions_of(self, kind: str) -> Conditions:
        """Return the conditions of one kind of result: the nominal ones have no tolerances."""
        return self.conditions if kind == WORST else self.conditions.nominal

    def met(self, row: dict, kind: str) -> bool:
        """Return whether slip and life of a row meet the limits; False without a result."""
        return not self.broken_by(row, kind)

    def broken_by(self, row: dict, kind: str) -> str:
        """Return which limit a row violates, or that it has no result."""
        slip, life = row[f"{kind}_slip"], row[f"{kind}_life"]
        if not math.isfinite(slip) or math.isnan(life):
            return "no result"
        return " and ".join(name for name, broken in (("slip", slip >= self.slip_below), ("life", life <= self.life_above)) if broken)


class Border(NamedTuple):
    """Radii that meet the limits at one D value, from ``low_from`` to ``low_to``, and what bounds them; lengths in mm in results."""

    kind: str
    d_value: float
    low_from: float
    low_to: float
    below_by: str
    above_by: str

    @property
    def in_millimetres(self) -> "Border":
        """The same of an interval in metres."""
        return self._replace(d_value=_millimetres(self.d_value), low_from=_nanometres(self.low_from), low_to=_nanometres(self.low_to))

    @property
    def places(self) -> dict[float, str]:
        """The names of the radii that show what an interval is."""
        return {self.low_to: "upper edge", 0.5 * (self.low_from + self.low_to): "centre", self.low_from: "lower edge"}


def _millimetres(length: float) -> float:
    return float(f"{1e3 * length:.9g}")


def _nanometres(length: float) -> float:
    """Return a radius in mm, rounded to a nanometre."""
    return round(1e3 * length, 6)


class Band(NamedTuple):
    """An interval of radii at one D value, before and after verification.

    Attributes
    ----------
    found : at the level of the design.
    verified : what the level that verifies leaves of it; None if that is nothing, or if nothing was verified.
    verdict : `CONFIRMED`, `NARROWED`, `WITHDRAWN` or `NOT_VERIFIED`.
    """

    found: Border
    verified: Border | None = None
    verdict: str = NOT_VERIFIED

    @property
    def recommended(self) -> Border | None:
        """The interval that the design recommends."""
        return self.found if self.verdict == NOT_VERIFIED else self.verified


class Check(NamedTuple):
    """A raceway at both levels, see `CHECK_COLUMNS`; lengths in mm."""

    kind: str
    d_value: float
    place: str
    low_radius: float
    slip: float
    life: float
    meets: bool
    verified_slip: float
    verified_life: float
    verified_meets: bool
    status: str
    reason: str
    warnings: str


class Designed(NamedTuple):
    """Results: all raceways of the grid, the intervals that meet the limits, and the raceways that were verified."""

    grid: Table
    bands: list[Band]
    checks: list[Check]

    @property
    def borders(self) -> list[Border]:
        """The intervals as they were found at the level of the design."""
        return [band.found for band in self.bands]

    def recommended(self, kind: str) -> list[Border]:
        """Return the intervals of one kind that the design recommends."""
        return [band.recommended for band in self.bands if band.found.kind == kind and band.recommended is not None]

    @property
    def widest(self) -> Border | None:
        """The widest recommended interval: in the worst case, or at nominal conditions if none is left in the worst case."""
        found = self.recommended(WORST) or self.recommended(NOMINAL)
        return max(found, key=lambda border: border.low_to - border.low_from, default=None)

    def open_ends(self, kind: str) -> str:
        """Return where the map ends at raceways that meet the limits, so that the limit lies beyond it; empty if it does nowhere."""
        borders, d_values = [border for border in self.borders if border.kind == kind], self.grid.values(D_VALUE)
        d_ends = {border.d_value for border in borders} & {min(d_values), max(d_values)}
        radii = {end for border in borders for end, by in (border[2::2], border[3::2]) if by == END_OF_MAP}
        shown = (("D", d_ends, 4), ("R_low", radii, 5))
        ends = [f"{name} = {' and '.join(f'{value:.{digits}f}' for value in sorted(values))} mm" for name, values, digits in shown if values]
        return f"the map ends at {', and at '.join(ends)}, where raceways meet both limits: the region continues beyond it" if ends else ""

    @property
    def border_table(self) -> Table:
        """The intervals as a table."""
        nothing = (math.nan, math.nan, "", "")
        rows = [(*band.found, band.verdict, *(band.verified[2:] if band.verified else nothing)) for band in self.bands]
        return self._table(BORDER_COLUMNS, rows, "design borders")

    @property
    def check_table(self) -> Table:
        """The verified raceways as a table."""
        return self._table(CHECK_COLUMNS, self.checks, "design checks")

    def _table(self, columns, rows, kind) -> Table:
        names = [column.name for column in columns]
        return Table(columns, [dict(zip(names, row)) for row in rows], self.grid.about | {"kind": kind})


TABLES = ("", "_borders", "_checks")
"""What the names of the tables of a design add to the name of its map."""


def write_design(path: Path, designed: Designed) -> list[Path]:
    """Write the tables of a design: PATH.parquet, PATH_borders.parquet, PATH_checks.parquet, and CSV of each; return the paths."""
    tables = zip(TABLES, (designed.grid, designed.border_table, designed.check_table))
    return [file for suffix, table in tables for file in write_table(path.with_name(f"{path.stem}{suffix}.parquet"), table)]


def read_design(path: Path) -> Designed:
    """Return a design from the path given to `write_design`; raises as `bearing_sim.sweep.table.read_table`."""
    grid, borders, checks = (read_table(path.with_name(f"{path.stem}{suffix}.parquet")) for suffix in TABLES)
    bands = []
    for *found, verdict, low_from, low_to, below_by, above_by in (row.values() for row in borders.rows):
        verified = Border(*found[:2], low_from, low_to, below_by, above_by) if verdict in (CONFIRMED, NARROWED) else None
        bands.append(Band(Border(*found), verified, verdict))
    return Designed(grid, bands, [Check(*row.values()) for row in checks.rows])


def life_name(scene: Scene) -> str:
    """Return the name of the life that a scene chooses, which a design keeps above its limit."""
    life = scene.life
    name = f"{life.symbols[0 if life.is_basic else 1]}, by {loads_text(scene)}"
    return name if life.is_basic else f"{name}; reliability {100 * life.reliability:g} %, cleanliness {life.a_iso}"


def default_axes(scene: Scene) -> tuple[Axis, Axis]:
    """Return the default radii and D values about those of a scene."""
    raceway = scene.bearing.outer_raceway
    radii = np.linspace(raceway.low_radius - _BELOW, raceway.low_radius + _ABOVE, _RADII)
    d_values = np.linspace(1 - _D_RANGE, 1 + _D_RANGE, _D_VALUES) * raceway.d_value
    return tuple(axis(path, [float(f"{value:.9g}") for value in values.tolist()]) for path, values in ((LOW, radii), (D_VALUE, d_values)))


class _NoResult(Exception):
    """A run without a result: its status and its reason."""


def raceway_row(scene: Scene, duration: float, conditions: Conditions) -> dict:
    """Return slip and life of a raceway, nominal and in the worst case within the tolerances.

    Tolerances of speed and load are combined, nine runs at each operating point.  Those of other fields are taken one at a time in both
    directions, at nominal speed and load, and then all at once in the directions that are worst for slip, and in those that are worst for
    life, together with the worst speed and load of each point.  All of them change the clearance or the friction of one and the same
    bearing, so that the effect of each has the same sign whatever the others are; 3^n combinations would find the same corner.

    Parameters
    ----------
    scene : with the raceway.
    duration : see `bearing_sim.sweep.point.run_until_settled`.
    conditions : operating points and tolerances.
    """
    points = conditions.points or (OperatingPoint(scene.operating.shaft_speed, scene.operating.radial_load),)
    tolerances, exact = conditions.tolerances, (0,) * len(conditions.tolerances)
    found: dict[tuple, dict] = {}

    def result(point, deviation, signs) -> dict:
        key = point, deviation, signs
        if key not in found:
            try:
                row = point_row(scene_at_point(scene, point, *deviation, tolerances, signs), duration)
            except PointError as error:
                raise _NoResult(REFUSED, str(error)) from None
            if row["status"] not in (OK, UNSETTLED):
                raise _NoResult(row["status"], row["reason"])
            found[key] = row
        return found[key]

    def mission(deviations, signs) -> tuple[float, float]:
        """Return slip and life of all points, each with its deviation of speed and load."""
        rows = [result(point, deviation, signs) for point, deviation in zip(points, deviations)]
        return max(row["cage_slip"] for row in rows), combined_life([row["modified_rating_life"] for row in rows], points)

    def worst(choose, name, place) -> list[tuple[float, float]]:
        """Return slip and life where one of them is worst: with the tolerances off in the worst directions, and with speed and load alone."""
        deviations = [choose(operating, key=lambda each: result(point, each, exact)[name]) for point in points]
        signs = tuple(choose((0, -1, 1), key=lambda sign: alone[k, sign][place]) for k in range(len(tolerances)))
        return [mission(deviations, signs), mission(deviations, exact)]

    both = (dict.fromkeys((0.0, -each, each)) for each in (conditions.speed_tolerance, conditions.load_tolerance))
    operating, at_nominal = list(itertools.product(*both)), [(0.0, 0.0)] * len(points)
    try:
        nominal = mission(at_nominal, exact)
        for point, deviation in itertools.product(points, operating):
            result(point, deviation, exact)
        alone = {
            (k, sign): mission(at_nominal, tuple(sign * (other == k) for other in range(len(tolerances))))
            for k, sign in itertools.product(range(len(tolerances)), (-1, 0, 1))
        }
        slips, lives = zip(*alone.values(), *worst(max, "cage_slip", 0), *worst(min, "modified_rating_life", 1))
    except _NoResult as error:
        return _NOTHING | dict(zip(("status", "reason", "warnings"), (*error.args, "")))
    unsettled = [row["reason"] for row in found.values() if row["status"] == UNSETTLED]
    return {
        "nominal_slip": nominal[0],
        "nominal_life": nominal[1],
        "worst_slip": max(slips),
        "worst_life": min(lives),
        "status": UNSETTLED if unsettled else OK,
        "reason": unsettled[0] if unsettled else "",
        "warnings": merged(row["warnings"] for row in found.values()),
    }


def design(
    name: str,
    overrides: Sequence[str],
    limits: Limits,
    radii: Axis,
    d_values: Axis,
    duration: float,
    execution: Execution = IN_MEMORY,
    verify_level: str | None = None,
) -> Designed:
    """Map which raceways meet the limits, and verify what is found at a level of higher fidelity.

    Parameters
    ----------
    name, overrides : of the scene, its level among them.
    limits : to meet.
    radii, d_values : of the grid; the region is searched between the smallest and the largest.
    duration : see `bearing_sim.sweep.grid.run_sweep`.
    execution : see `bearing_sim.sweep.tasks.Execution`.
    verify_level : that verifies edges and centre of each interval, see `verified`; None: nothing is verified.

    Raises
    ------
    SceneError
        No raceway of the grid has a valid scene, or the level that verifies cannot compute it; the errors are those of the first.
    """
    study = _Study(limits, duration, execution.run)

    def scenes_at(points, *more):
        return {point: scene_at(name, [*overrides, *more], (radii, d_values), point) for point in points}

    scenes = scenes_at(itertools.product(sorted(radii.values), sorted(d_values.values)))
    if all(isinstance(scene, SceneError) for scene in scenes.values()):
        raise next(iter(scenes.values()))
    grid = study.rows(scenes)
    thin = scenes_at(study.points_in_gaps(scenes, grid))
    intervals = study.intervals(scenes | thin, grid | study.rows(thin))
    bands, checks = [Band(interval.in_millimetres) for interval in intervals], []
    if verify_level is not None:
        at = [(interval.low_from, interval.d_value) for interval in intervals]
        own, higher = ([found[point] for point in at] for found in (scenes_at(at), scenes_at(at, f"level={verify_level}")))
        if errors := [scene for scene in higher if isinstance(scene, SceneError)]:
            raise errors[0]
        bands, checks = study.verified_bands(intervals, own, higher)
    scene = load_scene(name, overrides)
    about = {
        "kind": "design",
        "scene": name,
        "name": scene.name,
        "overrides": list(overrides),
        "level": scene.level,
        "verify_level": verify_level,
        "life": life_name(scene),
        "wanted": {"slip_below": limits.slip_below, "life_above": limits.life_above} | limits.conditions.as_json(),
        "axes": [radii.about, d_values.about],
        "duration": duration,
        "version": package_version(),
        "commit": git_hash(),
        "scene_yaml": scene_to_yaml(scene),
    }
    return Designed(Table(COLUMNS, [_table_row(point, row, limits) for point, row in grid.items()], about), bands, checks)


class _Study(NamedTuple):
    """What all tasks of one study share, and how they run."""

    limits: Limits
    duration: float
    run: Callable[[Sequence[Task]], list[dict]]

    def rows(self, scenes: dict[tuple, Scene | SceneError]) -> dict[tuple, dict]:
        """Return the row of each point (radius, D value)."""
        valid = {point: scene for point, scene in scenes.items() if isinstance(scene, Scene)}
        results = dict(
            zip(valid, self.run([task(scene.level, raceway_row, scene, self.duration, self.limits.conditions) for scene in valid.values()]))
        )
        return {
            point: _NOTHING | (results[point] if point in results else {"status": REFUSED, "reason": one_line(scene), "warnings": ""})
            for point, scene in scenes.items()
        }

    def points_in_gaps(self, scenes: dict[tuple, Scene | SceneError], rows: dict[tuple, dict]) -> list[tuple]:
        """Return points between those of the grid that meet the limits, where the region is thinner than the steps of the grid."""
        gaps = [
            (kind, left, right)
            for kind, points in _lines_of(rows)
            for left, right in itertools.pairwise(points)
            if [self.limits.broken_by(rows[point], kind) for point in (left, right)] == ["life", "slip"]
        ]
        results = self.run([self._search("gap", scenes[left], kind, "met_between", left[0], right[0]) for kind, left, right in gaps])
        return [(result["inside"], left[1]) for (_, left, _), result in zip(gaps, results) if result.get("inside") is not None]

    def intervals(self, scenes: dict[tuple, Scene], rows: dict[tuple, dict]) -> list[Border]:
        """Return the intervals of radii that meet the limits [m], with edges narrowed between a point inside and its neighbour outside."""
        ends = []
        for kind, points in _lines_of(rows):
            for run in _runs([self.limits.met(rows[point], kind) for point in points]):
                for inside, outside in zip(run, (run[0] - 1, run[1] + 1)):
                    ends.append((kind, points[inside], points[outside] if 0 <= outside < len(points) else None))
        tasks = [self._search("edge", scenes[inside], kind, "narrowed", inside[0], outside[0]) for kind, inside, outside in ends if outside]
        results, found = iter(self.run(tasks)), []
        for kind, inside, outside in ends:
            result = next(results) if outside else {"broken_by": END_OF_MAP}
            found.append((kind, *inside[::-1], result.get("broken_by") or self.limits.broken_by(rows[outside], kind), result.get("inside")))
        edges = [(kind, d_value, radius if narrowed is None else narrowed, by) for kind, d_value, radius, by, narrowed in found]
        return [Border(*low[:3], high[2], low[3], high[3]) for low, high in zip(edges[::2], edges[1::2])]

    def verified_bands(self, intervals: Sequence[Border], own: Sequence[Scene], higher: Sequence[Scene]) -> tuple[list[Band], list[Check]]:
        """Return each interval with what the level that verifies leaves of it, and the raceways that show the difference.

        Parameters
        ----------
        intervals : as found.
        own, higher : a scene with the D value of each interval, at the level of the design and at the one that verifies.
        """
        tasks = [self._search(f"verify {scene.level}", scene, each.kind, "verified", *each[2:4]) for each, scene in zip(intervals, higher)]
        results, bands, shown = self.run(tasks), [], []
        for interval, scene, result in zip(intervals, own, results):
            verdict, after = _judged(interval, result)
            bands.append(Band(interval.in_millimetres, after and after.in_millimetres, verdict))
            places = {radius: f"verified {place}" for radius, place in after.places.items()} if after else {}
            shown += [(interval, scene, result, place, radius) for radius, place in sorted((places | interval.places).items())]
        lower = self.run(
            [
                task("check", raceway_row, with_values(scene, {LOW: radius}), self.duration, self.limits.conditions_of(interval.kind))
                for interval, scene, _, _, radius in shown
            ]
        )
        return bands, [self._check(*each, row) for each, row in zip(shown, lower)]

    def _search(self, name: str, scene: Scene, kind: str, search: str, first: float, second: float) -> Task:
        return task(name, searched, scene, self.duration, self.limits, kind, search, first, second)

    def _check(self, interval: Border, scene: Scene, result: dict, place: str, radius: float, row: dict) -> Check:
        """Return a raceway at both levels from the result of verification and from its row at the level of the design."""
        higher = dict(zip(result.get("radii", ()), result.get("rows", ()))).get(radius, result)  # a lost worker has left its reason only
        numbers = []
        for one in (row, higher):
            one = _NOTHING | one
            numbers += [one[f"{interval.kind}_slip"], one[f"{interval.kind}_life"], self.limits.met(one, interval.kind)]
        lengths = _millimetres(interval.d_value), place, _nanometres(radius)
        return Check(interval.kind, *lengths, *numbers, higher["status"], higher["reason"], higher.get("warnings", ""))


def _judged(interval: Border, result: dict) -> tuple[str, Border | None]:
    """Return the verdict on an interval, and what is left of it."""
    if result.get("low_from") is None:
        return WITHDRAWN, None
    after = interval._replace(**{name: result[name] or getattr(interval, name) for name in Border._fields[2:]})
    return (CONFIRMED if after[:4] == interval[:4] else NARROWED), after


def _table_row(point, row, limits) -> dict:
    lengths = {LOW: _millimetres(point[0]), D_VALUE: _millimetres(point[1])}
    texts = {"status": row["status"], "reason": row["reason"], "warnings": row.get("warnings", "")}  # a lost worker's has none
    return lengths | {name: row[name] for name in _NUMBERS} | {f"meets_{kind}": limits.met(row, kind) for kind in KINDS} | texts


class _Raceways:
    """Raceways of one D value along the low-point radius; each is computed once.

    Parameters
    ----------
    scene : with the D value, of any level.
    duration : see `bearing_sim.sweep.point.run_until_settled`.
    limits, kind : limits, and whether they apply at nominal conditions or within the tolerances.
    """

    def __init__(self, scene: Scene, duration: float, limits: Limits, kind: str):
        self._scene, self._duration, self._limits, self._kind = scene, duration, limits, kind
        self._rows: dict[float, dict] = {}

    def row(self, radius: float) -> dict:
        """Return the row of the raceway with a low-point radius [m]; with the tolerances only for the worst case."""
        if radius not in self._rows:
            self._rows[radius] = raceway_row(with_values(self._scene, {LOW: radius}), self._duration, self._limits.conditions_of(self._kind))
        return self._rows[radius]

    def met(self, radius: float) -> bool:
        """Return whether the raceway with a radius meets the limits."""
        return self._limits.met(self.row(radius), self._kind)

    def broken_by(self, radius: float) -> str:
        """Return which limit the raceway with a radius violates, see `Limits.broken_by`."""
        return self._limits.broken_by(self.row(radius), self._kind)

    def narrowed(self, inside: float, outside: float) -> dict:
        """Return, by bisection, the radius nearest to ``outside`` that meets the limits, and what breaks them beyond.

        The limits are two conditions on results that may be absent, not one continuous function; hence no root finder.

        Parameters
        ----------
        inside, outside : radii [m]; the first meets the limits, the second does not.
        """
        for _ in range(_HALVINGS):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if self.met(middle) else (inside, middle)
        return {"inside": inside, "broken_by": self.broken_by(outside)}

    def met_between(self, left: float, right: float) -> dict:
        """Return a radius between two others that meets the limits, or None if none was found.

        Parameters
        ----------
        left, right : radii [m]; the first violates only the limit of life, the second only that of slip.
        """
        for _ in range(_HALVINGS):
            middle = 0.5 * (left + right)
            broken_by = self.broken_by(middle)
            if not broken_by:
                return {"inside": middle}
            if broken_by == "life":
                left = middle
            elif broken_by == "slip":
                right = middle
            else:
                break
        return {"inside": None}

    def verified(self, low: float, high: float) -> dict:
        """Return what is left of an interval of radii that a level of lower fidelity has found.

        Both edges and the centre must meet the limits.  Where they do not, the widest part of those that do is narrowed by bisection
        towards its inside, and its centre is verified in turn; where none does, a part is searched between neighbours of which one
        breaks only the life and the other only the slip.  What lies between the verified radii is taken to be like them, and nothing
        outside the interval is tried, because the other level refuses it.

        Parameters
        ----------
        low, high : ends of the interval [m].

        Returns
        -------
        low_from, low_to : of the part that is left [m]; None if there is none.
        below_by, above_by : what bounds it; empty where the end has not moved.
        radii, rows : what was computed.
        """
        left: dict = {"low_from": None}
        below_by, above_by = "", ""
        for _ in range(_ROUNDS):
            radii = sorted({low, 0.5 * (low + high), high})
            if all(map(self.met, radii)):
                left = {"low_from": low, "low_to": high, "below_by": below_by, "above_by": above_by}
                break
            if not any(map(self.met, radii)):
                gaps = [pair for pair in itertools.pairwise(radii) if tuple(map(self.broken_by, pair)) == ("life", "slip")]
                radii = sorted([*radii, *(found for gap in gaps if (found := self.met_between(*gap)["inside"]) is not None)])
            parts = [
                [
                    tuple(self.narrowed(radii[inside], radii[outside]).values()) if 0 <= outside < len(radii) else (radii[inside], by)
                    for inside, outside, by in ((first, first - 1, below_by), (last, last + 1, above_by))
                ]
                for first, last in _runs([self.met(radius) for radius in radii])
            ]
            if not parts:
                break
            (low, below_by), (high, above_by) = max(parts, key=lambda part: part[1][0] - part[0][0])
        return left | {"radii": list(self._rows), "rows": list(self._rows.values())}


def searched(scene: Scene, duration: float, limits: Limits, kind: str, search: str, first: float, second: float) -> dict:
    """Return what a search along the low-point radius has found.

    Parameters
    ----------
    scene, duration, limits, kind : see `_Raceways`.
    search : name of its method: ``narrowed``, ``met_between`` or ``verified``.
    first, second : the radii that the method takes [m].
    """
    return getattr(_Raceways(scene, duration, limits, kind), search)(first, second)


def _runs(met: Sequence[bool]) -> Iterator[tuple[int, int]]:
    """Yield the first and the last index of every run of true values."""
    for is_met, run in itertools.groupby(range(len(met)), key=lambda k: met[k]):
        if is_met:
            run = list(run)
            yield run[0], run[-1]


def _lines_of(rows: dict[tuple, dict]) -> Iterator[tuple[str, list[tuple]]]:
    """Yield the points (radius, D value) of each D value in order of their radii, for each kind of result."""
    for kind, d_value in itertools.product(KINDS, sorted({d_value for _, d_value in rows})):
        yield kind, sorted(point for point in rows if point[1] == d_value)


_SLIP, _LIFE, _REFUSED = "#b2451f", "#0072b2", "#c1121f"
_REGIONS = {NOMINAL: {"facecolor": "#cfe8d8", "edgecolor": "#3d8b5e"}, WORST: {"facecolor": "#7fc49b", "edgecolor": "#1d5c39"}}


def condition_name(kind: str, wanted: Mapping) -> str:
    """Return in words in which conditions a kind of result meets the limits.

    Parameters
    ----------
    kind : one of `KINDS`.
    wanted : the limits and conditions of a design, as they stand in its table.
    """
    if kind == WORST:
        return f"in the worst case of {wanted['spread']}"
    return "at nominal speeds and loads" if wanted["points"] else "at nominal speed and load"


def plot_design(path: Path | BinaryIO, designed: Designed, beside: tuple[str, tuple[float, float], tuple[float, float]] | None = None) -> None:
    """Draw the regions and isolines of slip and life into a file.

    The region of the worst case and the nominal one each stand under their own name, also where there is none.  After verification the region
    that is left is filled, and the one before is outlined.

    Parameters
    ----------
    path : its suffix gives the format: .png, .svg or .pdf; or a stream, for .png.
    designed : the results.
    beside : another answer to show: its label, and its ranges of D values and radii [mm].
    """
    figure = new_figure(9, 6.8)
    axes = figure.subplots()
    about, d_values = designed.grid.about, sorted(set(designed.grid.values(D_VALUE)))
    verify_level, limits = about["verify_level"], about["wanted"]
    at = f"{about['level']} and {verify_level}" if verify_level else about["level"]
    absent, beyond = [], {}
    for kind, look in _REGIONS.items():
        condition, borders = condition_name(kind, limits), designed.recommended(kind)
        _fill(axes, borders, d_values, look | {"label": f"{condition}: meets both limits at {at}"})
        found = [border for border in designed.borders if border.kind == kind]
        if verify_level:
            _outline(axes, found, d_values, {"color": look["edgecolor"], "label": f"{condition}: meets both limits at {about['level']}"})
        if not borders:
            absent.append(f"{condition}: no raceway of the map meets both limits at {at}")
        if ends := designed.open_ends(kind):
            beyond.setdefault(ends, []).append(condition)
    if absent:
        box = {"facecolor": "white", "edgecolor": _REFUSED, "boxstyle": "round"}
        axes.text(0.5, 0.97, "\n".join(absent), transform=axes.transAxes, ha="center", va="top", fontsize=10, color=_REFUSED, bbox=box, zorder=5)
    refused = [check for check in designed.checks if not check.verified_meets]
    if refused:
        places = [check.d_value for check in refused], [check.low_radius for check in refused]
        axes.plot(*places, "x", color=_REFUSED, ms=7, mew=1.8, label=f"refused at {verify_level}")
    for quantity, colour, limit, unit in (("nominal_slip", _SLIP, limits["slip_below"], "%"), ("nominal_life", _LIFE, limits["life_above"], "h")):
        _isolines(axes, designed, quantity, colour, limit, unit)
    if beside is not None:
        name, (left, right), (low, high) = beside
        axes.plot([left, right, right, left, left], [low, low, high, high, low], color="black", lw=1.8, label=name)
    axes.plot([], [], color=_SLIP, label=f"cage slip at {about['level']} [%]")
    axes.plot([], [], color=_LIFE, label=f"life at {about['level']} [h]")
    axes.set(xlabel="D value [mm]", ylabel="low-point radius R_low [mm]")
    plain_numbers(axes.xaxis, axes.yaxis)
    legend_below(figure, axes, ncols=2, fontsize=9)
    verified = f", verified at {verify_level}" if verify_level else ""
    points = f"{len(limits['points'])} operating points, " if limits["points"] else ""
    title = f"{about['name']} at level {about['level']}{verified}: slip below {limits['slip_below']:g} %, life above {hours(limits['life_above'])}"
    if beyond:
        texts = [ends if len(conditions) == len(KINDS) else f"{conditions[0]} {ends}" for ends, conditions in beyond.items()]
        axes.set_title("\n".join(line for text in texts for line in textwrap.wrap(text, 140)), fontsize=8)
    save(figure, path, "\n".join([title, *textwrap.wrap(f"{about['life']}; {points}{STATE}", 120)]), 10)


def _lines(borders: Sequence[Border], d_values: Sequence[float]) -> tuple[list[float], list[float]] | None:
    """Return the lower and the upper ends over all D values, NaN where there is no interval; None if there are several at one."""
    found = {border.d_value: border for border in borders}
    if len(found) < len(borders):
        return None
    return tuple([getattr(found[d], end) if d in found else math.nan for d in d_values] for end in ("low_from", "low_to"))


def _fill(axes, borders, d_values, look) -> None:
    """Fill the region between neighbouring D values, and draw each interval, so that one without neighbours is seen."""
    lines = _lines(borders, d_values)
    if lines is not None and borders:
        axes.fill_between(d_values, *lines, lw=1.6, **look)
    for k, border in enumerate(borders):
        label = look["label"] if lines is None and k == 0 else None
        axes.plot([border.d_value] * 2, [border.low_from, border.low_to], color=look["edgecolor"], lw=2, solid_capstyle="butt", label=label)


def _outline(axes, borders, d_values, look) -> None:
    """Draw the ends of the intervals, joined between neighbouring D values where there is one at each."""
    if not borders:
        return
    lines = _lines(borders, d_values)
    along, style = (d_values, {"ls": "--", "lw": 1.2}) if lines else ([border.d_value for border in borders], {"ls": "", "ms": 9})
    ends = lines or [[getattr(border, end) for border in borders] for end in ("low_from", "low_to")]
    for values, label in zip(ends, (look["label"], None)):
        axes.plot(along, values, marker="_", **style | look | {"label": label})


def _isolines(axes, designed, quantity, colour, limit, unit) -> None:
    across, up, field = on_grid(designed.grid, D_VALUE, LOW, quantity)
    field = with_gaps(field)
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
            axes.clabel(lines, inside, fontsize=9, fmt={level: f"{number(level)} {unit}" for level in inside}, manual=positions)
