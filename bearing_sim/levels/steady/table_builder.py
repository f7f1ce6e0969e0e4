# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tables of operating points: built by refinement until the interpolant agrees with the solver, and kept on disk.

Knots are added along one axis at a time: between two neighbours, where the interpolant in the middle is off by too much on any of some
randomly drawn lines of the grid.  The quality that is reported comes from points drawn anywhere in the table.

On disk each table stands under a hash of all that its numbers depend on; a file that cannot be read counts as none.

A table with an axis of growth answers for other clearances, too: more clearance is less growth.  It is built for a clearance in whole steps and
shifted along that axis, so that a change of clearance, of a group or by a wish, rebuilds nothing within a step.
"""

import dataclasses
import hashlib
import itertools
import math
import threading
import time
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple, Protocol

import numpy as np

from bearing_sim.files.cores import cores
from bearing_sim.files.kept import Damaged, cache_folder, kept_if_possible, packed, read_kept, unpacked, write_kept
from bearing_sim.files.limits import KEPT_TABLE_FILE
from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
from bearing_sim.levels.steady.model import look_up_conditions, new_work, solve_conditions
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table import AXES, Table, common_period, mirror_axis, monotone_slopes, new_look_up, symmetric_parts
from bearing_sim.model.params import Lubrication, Params, lubricate, pack
from bearing_sim.model.table_span import Span, span_of
from bearing_sim.model.temperatures import lubricate_scene
from bearing_sim.numerics.compilation import sources_hash
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.scene.scene import Scene

_SLIP_FLOOR = 2.5e-4  # absolute error of slip that is allowed besides
_FRACTION = 0.5  # of the error allowed in all, for one axis
_LAG_FLOOR, _LAG_LENIENCE = 2e-3, 10.0  # s, and times as much error: a lag shows only while the inputs change
_LINES = 24  # drawn for each interval
_ROUNDS = 7  # an interval is halved so many times at most
_MOST_NODES, _MOST_WARM_NODES = 60_000, 200_000  # without and with an axis of growth
_CHECKS = 400
_CHUNK = 16  # conditions solved in one go by a thread
_FIRST_SPEEDS, _FIRST_LOADS = (0.0, 0.08, 0.2, 0.4, 0.6, 0.8, 1.0), (0.0, 0.005, 0.03, 0.08, 0.15, 0.25, 0.5, 1.0)
_FIRST_TEMPERATURES, _FIRST_ANGLES, _FIRST_GROWTHS = 4, 6, 5
_NO_DRIVE = Drive(*(0.0,) * len(Drive._fields))  # of conditions, which bring their own
_CLEARANCE_STEP = 10e-6  # m, diametral; half a step moves slip by 0.0004 points and life by 0.03 % at most (measured on an NU 232)
_GROWTH_STEP = 2.5e-6  # m, to which the ends of the axis of growth are rounded, beyond half a step of the radial clearance
_OILS = 9  # temperatures at which the oil goes into the hash


class Quality(NamedTuple):
    """How a table came out, at points drawn anywhere in it."""

    nodes: int
    missing: int  # of them without an answer
    solved: int  # operating points solved for
    seconds: float
    tolerance: float
    within: float  # fraction of the points checked that keep the tolerance
    slip_error: float  # the largest, absolute
    slip_error_95: float  # 95th percentile
    life_error: float  # relative
    life_error_95: float
    correction_slip_error: float = 0.0  # of a correction, at points left out of it, root mean square; 0 without one
    correction_life_error: float = 0.0  # relative, likewise


class Corrects(Protocol):
    """What takes operating points of this level to what another one settles in (`bearing_sim.watchers.estimation.correction`)."""

    slip_error: float  # at points left out, root mean square
    life_error: float  # relative, likewise

    def applied(self, conditions: np.ndarray, answers: np.ndarray) -> np.ndarray:
        """Return corrected answers to conditions, shapes (n, 5) and (n, len(ANSWER))."""


class Solver:
    """Solves for operating points on several threads and remembers them."""

    def __init__(
        self,
        params: Params,
        lubrication: Callable[[float], Lubrication],
        workers: int | None,
        progress: Callable[[int, int], None],
        correction: Corrects | None = None,
    ):
        self._params, self._lubrication, self._progress, self._correction = params, lubrication, progress, correction
        self._lubrications: dict[float, Lubrication] = {}
        self._known: dict[tuple, np.ndarray] = {}
        self._local = threading.local()
        self._pool = ThreadPoolExecutor(workers or cores())

    def __enter__(self) -> "Solver":
        return self

    def __exit__(self, *_) -> None:
        self._pool.shutdown(cancel_futures=True)

    @property
    def solved(self) -> int:
        """Operating points solved for so far."""
        return len(self._known)

    def solve(self, conditions: np.ndarray) -> np.ndarray:
        """Return the answers to conditions (speed, load, temperature, angle, growth), shapes (n, 5) and (n, len(ANSWER))."""
        keys = [tuple(row) for row in conditions.tolist()]
        new = sorted({key for key in keys if key not in self._known}, key=lambda key: (key[2], key[4], key[1], key[3], key[0]))
        wanted = self.solved + len(new)
        chunks = []
        for _, same in itertools.groupby(new, key=lambda key: (key[2], key[4])):
            same = list(same)
            chunks += [same[begin : begin + _CHUNK] for begin in range(0, len(same), _CHUNK)]
        for temperature in {chunk[0][2] for chunk in chunks} - self._lubrications.keys():
            self._lubrications[temperature] = self._lubrication(temperature)
        for chunk, answers in zip(chunks, self._pool.map(self._solve_chunk, chunks)):
            if self._correction is not None:
                answers = self._correction.applied(np.array(chunk), answers)
            self._known.update(zip(chunk, answers))
            self._progress(self.solved, wanted)
        return np.array([self._known[key] for key in keys])

    def _solve_chunk(self, chunk: list[tuple]) -> np.ndarray:
        if not hasattr(self._local, "work"):
            self._local.work = new_work(self._params)
        model = Model(self._params, with_growth(self._lubrications[chunk[0][2]], chunk[0][4]), _NO_DRIVE, DEFAULT_TOLERANCES)
        answers = np.empty((len(chunk), len(ANSWER)))
        solve_conditions(np.ascontiguousarray([[key[0], key[1], key[3]] for key in chunk]), model, self._local.work, answers)
        return answers


def with_growth(lubrication: Lubrication, growth: float) -> Lubrication:
    """Return a lubrication whose inner raceway has grown by so much more [m]."""
    return lubrication._replace(growth=lubrication.growth._replace(heat=lubrication.growth.heat + growth))


def build_table(
    params: Params,
    lubrication: Callable[[float], Lubrication],
    span: Span,
    tolerance: float,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda solved, wanted: None,
    most_nodes: int | None = None,
    correction: Corrects | None = None,
) -> tuple[Table, Quality]:
    """Build a table.

    Parameters
    ----------
    params : of the bearing.
    lubrication : oil temperature [K] -> `bearing_sim.model.params.Lubrication`.
    span : what the table must cover.
    tolerance : relative error allowed in slip (besides 0.025 points) and in life.
    workers : threads; as many as the machine has cores where absent.
    progress : called now and then with the number of operating points solved for, and how many there will be after this round of refinement.
    most_nodes : refinement ends before a grid of more; 60,000, or 200,000 with an axis of growth, where absent.
    correction : of the operating points; they are those of this level where absent.

    Returns
    -------
    table, quality
    """
    began = time.perf_counter()
    with Solver(params, lubrication, workers, progress, correction) as solver:
        grid = _Grid(params, solver, span, tolerance)
        grid.refine(most_nodes or (_MOST_WARM_NODES if span.maximum_growth > span.minimum_growth else _MOST_NODES))
        table = grid.table()
        checks = grid.drawn(_CHECKS)
        exact, found = solver.solve(checks), look_up(table, checks)
        fractions = grid.fractions(exact, found)
        slip, life = np.abs(found - exact)[:, ANSWER.cage_slip], _life_errors(found, exact, params)
        nodes = table.nodes[..., 0, ANSWER.cage_slip]
        quality = Quality(
            nodes.size,
            int(np.isnan(nodes).sum()),
            solver.solved,
            time.perf_counter() - began,
            tolerance,
            float(np.mean(fractions <= 1.0)),
            *(float(np.nanquantile(error, q)) for error in (slip, life) for q in (1.0, 0.95)),
            *((0.0, 0.0) if correction is None else (correction.slip_error, correction.life_error)),
        )
    return table, quality


def look_up(table: Table, conditions: np.ndarray) -> np.ndarray:
    """Return the table's answers to conditions, NaN outside, shape (n, len(ANSWER)).

    Parameters
    ----------
    table : of operating points.
    conditions : speed, load, temperature and angle of each, and growth where it is not 0, shape (n, 4) or (n, 5).
    """
    answers = np.empty((len(conditions), len(ANSWER)))
    look_up_conditions(with_growths(conditions), table, new_look_up(), answers)
    return answers


def with_growths(conditions: np.ndarray) -> np.ndarray:
    """Return conditions with a column of growths, 0 where there was none, shape (n, 5)."""
    conditions = np.asarray(conditions, float)
    missing = np.zeros((len(conditions), len(AXES) - conditions.shape[1]))
    return np.ascontiguousarray(np.hstack([conditions, missing]))


def assembled(knots: list[np.ndarray], period: float, mirror: float, values: np.ndarray) -> Table:
    """Return the table of values on a grid of knots, shape (senses, *grid, len(ANSWER)), with slopes along all axes."""
    slopes = [monotone_slopes(knots[axis], values, axis + 1, period if axis == 3 else 0.0) for axis in range(len(AXES))]
    return Table(*knots, period, mirror, np.ascontiguousarray(np.stack([values, *slopes], axis=-2)))


def _lives(answers: np.ndarray, params: Params) -> np.ndarray:
    """Return the lives by roller loads that answers give [revolutions]: of whole rollers, by laminae, and that modified by oil, shape (n, 3)."""
    whole = answers[:, [ANSWER.inner_equivalent_load, ANSWER.outer_equivalent_load]].tolist()
    laminae = answers[:, [ANSWER.inner_lamina_load, ANSWER.outer_lamina_load]].tolist()
    lives = np.array([[rating_life_revolutions(*loads, params.life) for loads in pair] for pair in zip(whole, laminae)])
    return np.column_stack([lives, lives[:, 1] * answers[:, ANSWER.reference_modification_factor]])


def _life_errors(found: np.ndarray, exact: np.ndarray, params: Params) -> np.ndarray:
    """Return the largest of the relative errors of the lives of each answer, shape (n,)."""
    return np.abs(_lives(found, params) / _lives(exact, params) - 1.0).max(axis=1)


class _Grid:
    """The grid while it is refined."""

    def __init__(self, params: Params, solver: Solver, span: Span, tolerance: float):
        self._params, self._solver, self._tolerance = params, solver, tolerance
        parts = symmetric_parts(params)
        turn = common_period(*parts)
        self.period = turn or 2.0 * math.pi
        self.mirror = mirror_axis(*parts)
        self._senses = (1.0, -1.0) if span.reverse and math.isnan(self.mirror) else (1.0,)
        warm = span.maximum_temperature > span.minimum_temperature
        self.knots = [
            span.maximum_speed * np.array(_FIRST_SPEEDS),
            span.maximum_load * np.array(_FIRST_LOADS),
            np.linspace(span.minimum_temperature, span.maximum_temperature, _FIRST_TEMPERATURES if warm else 1),
            np.arange(_FIRST_ANGLES) * self.period / _FIRST_ANGLES if turn else np.zeros(1),
            np.linspace(span.minimum_growth, span.maximum_growth, _FIRST_GROWTHS) if span.maximum_growth > span.minimum_growth else np.zeros(1),
        ]
        self._random = np.random.default_rng(1)

    def values(self) -> np.ndarray:
        points = np.stack(np.meshgrid(*self.knots, indexing="ij"), axis=-1).reshape(-1, len(AXES))
        shape = (len(self._senses), *map(len, self.knots), len(ANSWER))
        return np.concatenate([self._solver.solve(points * [sense, 1.0, 1.0, 1.0, 1.0]) for sense in self._senses]).reshape(shape)

    def table(self) -> Table:
        return assembled(self.knots, self.period, self.mirror, self.values())

    def refine(self, most_nodes: int) -> None:
        """Halve intervals until none misses, each was halved often enough, or the grid would hold too many nodes."""
        for _ in range(_ROUNDS):
            table = self.table()
            missed = [self._missed(axis, table) for axis in range(len(AXES))]
            if not any(len(intervals) for intervals in missed):
                return
            for axis, intervals in enumerate(missed):
                nodes = math.prod(map(len, self.knots))
                if nodes // len(self.knots[axis]) * (len(self.knots[axis]) + len(intervals)) > most_nodes:
                    return
                self._halve(axis, intervals)

    def _ends(self, axis: int) -> np.ndarray:
        """Return the upper end of each interval of an axis."""
        knots = self.knots[axis]
        return np.append(knots[1:], knots[0] + self.period) if axis == 3 and len(knots) > 1 else knots[1:]

    def _missed(self, axis: int, table: Table) -> np.ndarray:
        """Return in which intervals of an axis the middle is off."""
        ends = self._ends(axis)
        middles = 0.5 * (self.knots[axis][: len(ends)] + ends)
        if not len(middles):
            return np.zeros(0, int)
        points = np.empty((len(middles), _LINES, len(AXES)))
        for other in range(len(AXES)):
            points[..., other] = self._random.choice(self.knots[other], (len(middles), _LINES))
        points[..., axis] = middles[:, None]
        points[..., 0] *= self._random.choice(self._senses, (len(middles), _LINES))
        points = points.reshape(-1, len(AXES))
        fractions = self.fractions(self._solver.solve(points), look_up(table, points)).reshape(len(middles), _LINES)
        return np.flatnonzero(np.nanmax(fractions, axis=1, initial=0.0) > _FRACTION)

    def _halve(self, axis: int, intervals: np.ndarray) -> None:
        middles = 0.5 * (self.knots[axis][intervals] + self._ends(axis)[intervals])
        self.knots[axis] = np.sort(np.concatenate((self.knots[axis], middles)))

    def fractions(self, exact: np.ndarray, found: np.ndarray) -> np.ndarray:
        """Return the largest fraction of what is allowed that the errors of each answer take; NaN where one is missing."""
        with np.errstate(invalid="ignore"):
            slip = np.abs(found - exact)[:, ANSWER.cage_slip] / (_SLIP_FLOOR + self._tolerance * np.abs(exact[:, ANSWER.cage_slip]))
            life = _life_errors(found, exact, self._params) / self._tolerance
            lag = np.abs(found - exact)[:, ANSWER.lag] / (_LAG_FLOOR + _LAG_LENIENCE * self._tolerance * exact[:, ANSWER.lag])
        return np.fmax(np.maximum(slip, life), lag)  # the lag of a stopped cage is not known

    def drawn(self, count: int) -> np.ndarray:
        """Return conditions drawn evenly in speed, temperature, direction and growth and in the square root of the load, shape (count, 5)."""
        low, high = (np.array([knots[end] for knots in self.knots]) for end in (0, -1))
        high[3] = self.period
        positions = self._random.random((count, len(AXES)))
        positions[:, 1] **= 2
        points = low + positions * (high - low)
        points[:, 0] *= self._random.choice(self._senses, count)
        return points


FOLDER = cache_folder() / "tables"
CORRECTION_VERSION = 6
"""Of how corrections are measured, fitted and kept (`bearing_sim.watchers.estimation.correction`); tables that others have corrected are built
again."""


class Reference(NamedTuple):
    """The scene and the span for which the table of another scene is built and kept."""

    scene: Scene
    span: Span
    offset: float  # growth at which the other scene has the same radial gaps, less that of this one [m]


def reference_of(scene: Scene, span: Span) -> Reference:
    """Return for what the table of a scene is built: itself; with an axis of growth, the bearing of the nearest clearance in whole steps."""
    bearing, outer = scene.bearing, scene.bearing.outer_raceway
    if span.maximum_growth <= span.minimum_growth or scene.table.correction != "none" or outer.contour is not None or outer.low_points:
        return Reference(scene, span, 0.0)
    clearance = 2.0 * bearing.radial_clearance_at_low_points
    offset = 0.5 * (clearance - _CLEARANCE_STEP * round(clearance / _CLEARANCE_STEP))
    outer = dataclasses.replace(outer, low_radius=outer.low_radius - offset)
    beyond = 0.25 * _CLEARANCE_STEP
    span = span._replace(
        minimum_growth=_GROWTH_STEP * math.floor((span.minimum_growth - beyond) / _GROWTH_STEP),
        maximum_growth=_GROWTH_STEP * math.ceil((span.maximum_growth + beyond) / _GROWTH_STEP),
    )
    bearing = dataclasses.replace(bearing, clearance=None, outer_raceway=outer)  # a range of the clearance that it no longer has is no number of it
    return Reference(dataclasses.replace(scene, bearing=bearing, uncertainty=()), span, offset)


def shifted(table: Table, offset: float) -> Table:
    """Return a table whose axis of growth is shifted [m]."""
    return table._replace(growths=table.growths + offset) if offset else table


def table_numbers(scene: Scene, span: Span) -> list[np.ndarray]:
    """Return the numbers that a table depends on: bearing, oil at the temperatures of the span, span and tolerance, always in the same order."""
    scene, span, _ = reference_of(scene, span)
    params = pack(scene)
    oils = [lubricate(scene.lubricant, params, float(kelvin)) for kelvin in np.linspace(span.minimum_temperature, span.maximum_temperature, _OILS)]
    life = params.life._replace(method=0, reliability_factor=1.0)  # which choose among lives, and change no operating point
    bearing = params.rollers, params.raceways, params.cage, params.mounted, params.variants, params.envelope, life
    return list(_numbers((bearing, params.outer_ring or (), oils, span, scene.table.tolerance)))


def corrected_by(scene: Scene) -> str:
    """Return what the correction of a scene's table depends on besides its numbers; empty for a table without one."""
    if scene.table.correction == "none":
        return ""
    return repr((scene.table.correction, CORRECTION_VERSION, scene.bearing, scene.support, scene.dynamics))  # a level with masses and a support


def table_hash(scene: Scene, span: Span) -> str:
    """Return a hash of what a table's numbers depend on: those of `table_numbers`, the correction and this program."""
    digest = hashlib.sha256(sources_hash().encode())
    for number in table_numbers(scene, span):
        digest.update(number.tobytes())
    digest.update(corrected_by(scene).encode())
    return digest.hexdigest()[:24]


def _numbers(value) -> Iterable[np.ndarray]:
    if isinstance(value, (tuple, list)):
        for item in value:
            yield from _numbers(item)
    else:
        yield np.asarray(value, float)


def table_path(scene: Scene, span: Span) -> Path:
    """Return where the table of a scene is kept."""
    return FOLDER / f"{table_hash(scene, span)}.npz"


def read_table(path: Path) -> tuple[Table, Quality] | None:
    """Return a table from disk, or None where there is none, or none that is whole."""
    return read_kept(path, KEPT_TABLE_FILE, lambda data: table_of(unpacked(data, KEPT_TABLE_FILE)))


def table_of(arrays: Mapping[str, np.ndarray]) -> tuple[Table, Quality]:
    """Return the table in the arrays of its file, see `table_arrays`; raises any exception where they are those of none."""
    period, mirror = (float(number) for number in arrays["symmetry"])
    quality = Quality(*(kind(number) for kind, number in zip(Quality.__annotations__.values(), arrays["quality"].tolist())))
    knots = [np.ascontiguousarray(arrays[name], float) for name in ("speeds", "loads", "temperatures", "angles", "growths")]
    values = arrays["values"]
    if values.shape[1:] != (*map(len, knots), len(ANSWER)):
        raise Damaged("its arrays do not fit together")
    return assembled(knots, period, mirror, values), quality


def table_arrays(table: Table, quality: Quality) -> dict[str, np.ndarray]:
    """Return the arrays of a table's file, by name."""
    return {
        "speeds": table.speeds,
        "loads": table.loads,
        "temperatures": table.temperatures,
        "angles": table.angles,
        "growths": table.growths,
        "symmetry": np.array([table.period, table.mirror]),
        "values": np.ascontiguousarray(table.nodes[..., 0, :]),
        "quality": np.array(quality, float),
    }


def write_table(path: Path, table: Table, quality: Quality) -> None:
    """Write a table: a reader finds the old file or the new one, never a part.  Raises OSError, also if another process is writing it."""
    write_kept(path, packed(table_arrays(table, quality)))


def cached_table(scene: Scene, temperatures: tuple[float, float] | None = None) -> tuple[Table, Quality] | None:
    """Return the table of a scene that is on disk, or None."""
    span = span_of(scene, temperatures)
    found = read_table(table_path(scene, span))
    return None if found is None else (shifted(found[0], reference_of(scene, span).offset), found[1])


def obtain_table(
    scene: Scene,
    temperatures: tuple[float, float] | None = None,
    workers: int | None = None,
    progress: Callable[[int, int], None] = lambda solved, wanted: None,
    rebuild: bool = False,
    correction: Callable[[], Corrects] | None = None,
) -> tuple[Table, Quality]:
    """Return the table of a scene, from disk or built and kept there.

    Parameters
    ----------
    scene : its level does not matter.
    temperatures : as in `span_of`.
    workers : threads; as many as the machine has cores where absent.
    progress : as of `build_table`.
    rebuild : whether to build it even if there is one.
    correction : makes the correction that a scene with `table.correction` asks for, if a table has to be built.

    Raises
    ------
    ValueError
        The scene asks for a correction, no such table is on disk, and nothing is given to make one; or the play of an outer ring that bends varies
        with temperatures that no axis of the table has.
    """
    housing = scene.mounting.housing
    if scene.outer_ring_bends and housing.backing.law != "free" and housing.backing.play is None and scene.heat.law != "none":
        raise ValueError(
            f"{scene.name}: the outer ring bends, and with heat.law = {scene.heat.law} its play in the housing varies with the temperatures of ring "
            "and housing, of which a table has no axis; run without a table, give mounting.housing.backing.play, or set heat: none"
        )
    span = span_of(scene, temperatures)
    path = table_path(scene, span)
    found = None if rebuild else read_table(path)
    if found is None:
        if scene.table.correction != "none" and correction is None:
            raise ValueError(f"table.correction = {scene.table.correction}: there is no such table of {scene.name} yet; bearing-sim table builds it")
        made, reference = correction() if correction is not None else None, reference_of(scene, span)
        params, tolerance = pack(reference.scene), float(scene.table.tolerance)

        def lubrication(kelvin):
            return lubricate(scene.lubricant, params, kelvin)

        found = build_table(params, lubrication, reference.span, tolerance, workers, progress, correction=made)
        with kept_if_possible(path):  # else it is as good for this run
            write_table(path, *found)
    return shifted(found[0], reference_of(scene, span).offset), found[1]


def holds(table: Table, shaft_speed: float, load: float, oil_temperature: float, growth: float = 0.0) -> bool:
    """Return whether a table answers for magnitudes of speed [rad/s] and load [N], an oil temperature [K] and a growth [m]."""
    if not len(table.speeds) or not math.isfinite(shaft_speed + load + oil_temperature):
        return False
    return (
        abs(shaft_speed) <= table.speeds[-1]
        and load <= table.loads[-1]
        and table.temperatures[0] <= oil_temperature <= table.temperatures[-1]
        and table.growths[0] <= growth <= table.growths[-1]
        and (shaft_speed >= 0.0 or not math.isnan(table.mirror) or table.nodes.shape[0] == 2)
    )


def solve_scene(scene: Scene, shaft_speed: float, load: float, oil_temperature: float, load_angle: float) -> np.ndarray:
    """Return the answer to one operating point of a scene's bearing, solved for; NaN where none was found, shape (len(ANSWER),).

    Parameters
    ----------
    scene : its level does not matter.
    shaft_speed, load, oil_temperature, load_angle : [rad/s, N, K, rad].
    """
    return solve_points(scene, np.array([[shaft_speed, load, oil_temperature, load_angle]], float))[0]


def solve_points(scene: Scene, conditions: np.ndarray) -> np.ndarray:
    """Return the answers to operating points of a scene's bearing, solved for; NaN where none was found, shape (n, len(ANSWER)).

    Parameters
    ----------
    scene : its level does not matter.
    conditions : shaft speed [rad/s], load [N], oil temperature [K] and direction of the load [rad] of each, and growth [m], shape (n, 4) or (n, 5).
    """
    params, answers = pack(scene), np.empty((len(conditions), len(ANSWER)))
    work = new_work(params)
    conditions = with_growths(conditions)
    for temperature, growth in np.unique(conditions[:, [2, 4]], axis=0):
        same = np.flatnonzero((conditions[:, 2] == temperature) & (conditions[:, 4] == growth))
        lubrication = with_growth(lubricate_scene(scene, params, float(temperature)), float(growth))
        model = Model(params, lubrication, _NO_DRIVE, DEFAULT_TOLERANCES)
        found = np.empty((len(same), len(ANSWER)))
        solve_conditions(np.ascontiguousarray(conditions[same][:, [0, 1, 3]], float), model, work, found)
        answers[same] = found
    return answers
