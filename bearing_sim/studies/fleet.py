# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A fleet: replay of many logs, one bearing each, on all cores or on a Dask cluster: a table with one row for each bearing.

A log that cannot be read or computed is a row that says why.  Results are kept in a journal by what they depend on: the contents of the log, how it
is read, the scene and this program.  Nothing that is in it is computed again.
"""

import fcntl
import math
import os
import warnings
from collections.abc import Callable, Sequence
from contextlib import contextmanager
from dataclasses import replace as with_fields
from functools import partial
from pathlib import Path

import numpy as np

from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.files.tally import PartlyUsedWarning
from bearing_sim.inputs.csv_text import TableError
from bearing_sim.inputs.log import InputLogError
from bearing_sim.inputs.profile import judge
from bearing_sim.levels.steady.table import Table as OperatingPoints
from bearing_sim.levels.steady.table_builder import obtain_table, table_path
from bearing_sim.model.plausibility import minimum_load
from bearing_sim.model.table_span import HEADROOM, Span, rounded_temperatures, span_of
from bearing_sim.model.validity import cell
from bearing_sim.runtime.replay import Replay, replay
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation
from bearing_sim.studies.columns import TABLES, columns_of
from bearing_sim.studies.fleet_logs import Bearing, Log, read_log
from bearing_sim.sweep.point import FAILED, OK, REFUSED
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.tasks import IN_MEMORY, UNAVAILABLE, Execution, Task, program_hash, task
from bearing_sim.watchers.estimation.response import ResponseModel, response_digest
from bearing_sim.watchers.estimation.two_states import laws_of_table

PARTLY = "partly used"
"""Status of a bearing of whose log only a part was used; the reason says how much, why, and what may help."""

STATUSES = (OK, PARTLY, FAILED, REFUSED, UNAVAILABLE)

_SOURCES = (
    "studies/fleet.py",
    "studies/fleet_logs.py",
    "sweep/tasks.py",
    "watchers/estimation/*.py",
    "inputs/*.py",
    "messages/*.py",
    "watchers/monitoring/*.py",
    "recording/*.py",
    "runtime/*.py",
)
_TABLES_KEPT = 4  # by a worker

# By the beginning of a column: name in `bearing_sim.runtime.replay.Replay.band_statistics`, and by what the column's unit is smaller than that there.
_BANDS = {
    "slip_mean": ("cage_slip", 100.0),
    "slip_maximum": ("largest_cage_slip", 100.0),
    "least_rating_life": ("least_rating_life", 1.0),
    "least_running_clearance": ("least_running_clearance", 1e6),
    "remaining_life": ("remaining_life", 1.0),
}

COLUMNS = columns_of("fleet")
_EMPTY = {each["name"]: math.nan if each["kind"] == "number" else "" for each in TABLES if each["table"] == "fleet"}


def replay_fleet(
    bearings: Sequence[Bearing],
    execution: Execution = IN_MEMORY,
    progress: Callable[[str, int, int], None] = lambda act, done, total: None,
    prepare: Callable[[Scene, tuple[float, float]], object] | None = None,
    respond: Callable[[Scene], ResponseModel] | None = None,
) -> Table:
    """Replay the log of each bearing; return the table of them, in their order.

    At level ``steady`` all bearings that are equal share one table of operating points, as wide as all of their logs need.

    Parameters
    ----------
    bearings : to replay.
    execution : see `bearing_sim.sweep.tasks.Execution`; workers of a cluster open the logs under the same paths.
    progress : called with what is under way (``reading``, ``replay``), the number of finished tasks and of all that are to be computed.
    prepare : called with a scene and its oil temperatures [K] before its table is needed, where workers are of this machine.
    respond : returns the response of a scene that asks for bands; called once for bearings that are equal.  None computes no bands.

    Raises
    ------
    ClusterError
        See `bearing_sim.sweep.tasks.run_tasks`.
    """
    rows: list[dict] = [_refused_row(bearing) for bearing in bearings]
    checksums = _checksums(bearings, rows)
    ready = [k for k, row in enumerate(rows) if not row]
    responses = _responses([bearings[k].scene for k in ready], respond)
    scenes = {k: bearings[k].scene for k in ready}
    temperatures: dict[int, tuple[float, float] | None] = dict.fromkeys(ready)

    def run(act, tasks):
        return execution._replace(progress=partial(progress, act)).run(tasks)

    steady = [k for k in ready if scenes[k].level == "steady"]
    surveys = dict(zip(steady, run("reading", [_task("survey", survey, bearings[k], checksums[k]) for k in steady]) if steady else ()))
    for k, found in surveys.items():
        if "status" in found:
            rows[k] = found
    for group in _alike([k for k in steady if not rows[k]], scenes):
        scene, ends = _spanning([scenes[k] for k in group], [surveys[k] for k in group])
        for k in group:
            scenes[k], temperatures[k] = with_fields(scenes[k], table=scene.table), ends
        if prepare is not None and execution.dask is None:
            prepare(scene, ends)
    ready = [k for k in ready if not rows[k]]
    wanted = {k: bearings[k]._replace(scene=scenes[k]) for k in ready}
    tasks = [_task(scenes[k].level, replay_bearing, wanted[k], checksums[k], temperatures[k]) for k in ready]
    tasks = [each._replace(arguments=(*each.arguments, responses.get(repr(bearings[k].scene)))) for k, each in zip(ready, tasks)]
    for k, found in zip(ready, run("replay", tasks)):
        rows[k] = found
    return Table(COLUMNS, [_complete(bearing, row) for bearing, row in zip(bearings, rows)], _about(bearings))


def _responses(scenes: Sequence[Scene], respond: Callable[[Scene], ResponseModel] | None) -> dict[str, ResponseModel]:
    """Return the responses of the scenes that ask for bands, by how these are written; bearings that differ in name alone share one."""
    found: dict[str, ResponseModel] = {}
    shared: dict[str, ResponseModel] = {}
    for scene in scenes if respond is not None else ():
        if not scene.estimation.is_asked or repr(scene) in found:
            continue
        digest = response_digest(scene)
        if digest not in shared:
            shared[digest] = respond(scene)
        found[repr(scene)] = shared[digest]
    return found


def _refused_row(bearing: Bearing) -> dict:
    if isinstance(bearing.scene, Scene):
        return {}
    return {"status": REFUSED, "reason": "; ".join(map(str, bearing.scene.errors))}


def _checksums(bearings: Sequence[Bearing], rows: list[dict]) -> list[str]:
    """Return the checksum of each log; enter into the rows which logs cannot be read."""
    known: dict[Log, str] = {}
    for bearing, row in zip(bearings, rows):
        if row:
            continue
        try:
            if bearing.log not in known:
                known[bearing.log] = bearing.log.contents()
        except (OSError, TableError) as error:
            row |= {"status": UNAVAILABLE, "reason": str(error)}
    return [known.get(bearing.log, "") for bearing in bearings]


def _task(kind: str, function: Callable[..., dict], bearing: Bearing, checksum: str, *more) -> Task:
    """Return a task whose key depends on the contents of a log, not on its path or on names."""
    scene = with_fields(bearing.scene, name="", description="")
    keyed = task(kind, function, program_hash(*_SOURCES), checksum, bearing.log.only, bearing.reading._replace(mapping_name=""), scene, *more)
    return keyed._replace(arguments=(bearing, *more))


def _alike(places: Sequence[int], scenes: dict[int, Scene]) -> list[list[int]]:
    """Return groups of places whose scenes have the same tables of operating points, if these span the same."""
    groups: dict[Path, list[int]] = {}
    paths: dict[str, Path] = {}
    for k in places:
        text = repr(scenes[k])
        if text not in paths:
            span = Span(1.0, 1.0, 300.0, 310.0, span_of(scenes[k]).reverse, *span_of(scenes[k])[5:])
            paths[text] = table_path(scenes[k], span)
        groups.setdefault(paths[text], []).append(k)
    return list(groups.values())


def _spanning(scenes: Sequence[Scene], surveys: Sequence[dict]) -> tuple[Scene, tuple[float, float]]:
    """Return a scene whose table spans all the speeds and loads that the scenes ask for, and the lowest and highest oil temperature [K]."""
    spans, fastest = [span_of(scene) for scene in scenes], max(found["fastest"] for found in surveys)
    speed = max(span.maximum_speed for span in spans)
    if fastest > speed:
        speed = float(f"{HEADROOM * fastest:.2g}")
        speed = speed if speed >= fastest else 1.1 * speed
    temperatures = rounded_temperatures(min(found["coldest"] for found in surveys), max(found["warmest"] for found in surveys))
    table = with_fields(scenes[0].table, maximum_speed=speed, maximum_load=max(span.maximum_load for span in spans))
    return with_fields(scenes[0], table=table), temperatures


def survey(bearing: Bearing) -> dict:
    """Return what a table of operating points has to span for a log, among the inputs that the scene accepts.

    Returns
    -------
    ``fastest`` [rad/s], ``coldest`` and ``warmest`` [K]; or ``status`` and ``reason`` if the log cannot be read.
    """
    return _caught(_survey, bearing)


def _survey(bearing: Bearing) -> dict:
    series, limits, usual = read_log(bearing.log, bearing.reading).series, bearing.scene.accepted_inputs, bearing.scene.lubricant.temperature
    speeds = np.abs(np.array(series["shaft_speed"].values, float)).ravel()
    speeds = speeds[speeds <= limits.maximum_speed]
    oil = np.array(series["oil_temperature"].values, float).ravel() if "oil_temperature" in series else np.full(1, usual)
    oil = oil[(oil >= limits.minimum_temperature) & (oil <= limits.maximum_temperature)]
    ends = (float(oil.min()), float(oil.max())) if len(oil) else (usual, usual)
    return {"fastest": float(speeds.max(initial=0.0)), "coldest": ends[0], "warmest": ends[1]}


def replay_bearing(bearing: Bearing, temperatures: tuple[float, float] | None, response: ResponseModel | None = None) -> dict:
    """Return the results of one bearing by the names of `COLUMNS`; those of a log that cannot be read have only ``status`` and ``reason``.

    Parameters
    ----------
    bearing : with its log.
    temperatures : lowest and highest oil temperature of the table of operating points [K]; None without a table.
    response : of a scene that asks for bands.
    """
    return _caught(_replay_bearing, bearing, temperatures, response)


def _caught(function: Callable[..., dict], *arguments) -> dict:
    """Return what a function returns, or status and reason of what it raises: one log never ends the run of all."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", PartlyUsedWarning)  # the row says it
            return function(*arguments)
    except (InputLogError, TableError, SceneError) as error:
        return {"status": REFUSED, "reason": " ".join(str(error).split())}
    except OSError as error:
        return {"status": UNAVAILABLE, "reason": str(error)}
    except Exception as error:  # an error of the program: it is tried again the next time
        return {"status": UNAVAILABLE, "reason": f"{type(error).__name__}: {error}"}


def _replay_bearing(bearing: Bearing, temperatures: tuple[float, float] | None, response: ResponseModel | None) -> dict:
    scene, log = bearing.scene, read_log(bearing.log, bearing.reading)
    held = Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature)
    profile = judge(log, scene.accepted_inputs, held, bearing.reading.recordings.longest_gap, scene.heat.law)
    model, given = Simulation, {} if response is None else {"estimation": response}
    if temperatures is not None:
        model, given["validity"] = partial(Simulation, table=_operating_points(scene, temperatures)), laws_of_table(scene, temperatures)
    result = replay(scene, profile, model=model, given=given)
    status, reason = (FAILED, result.given_up) if result.given_up else (OK, "")
    if not (profile.tally.is_whole or reason):
        status, reason = PARTLY, "; ".join([profile.tally.text, *([profile.unknown_event.text] if profile.unknown_seconds else [])])
    return (
        {"status": status, "reason": reason}
        | _results(scene, result)
        | {
            "unknown_hours": profile.unknown_seconds / 3600.0,
            "inputs_refused": profile.tally.there - profile.tally.used,
            "life_and_damage": "at most, at least" if profile.verdict else "as given",
            "life_method": scene.life.method,
            "events": ", ".join(f"{count} x {kind}" for kind, count in sorted(result.events.items())),
            "warnings": cell(result.warnings),
        }
    )


def _results(scene: Scene, result: Replay) -> dict:
    slip = result.slip_statistics()
    below, turning = result.seconds_below(lambda speeds: minimum_load(scene, speeds)[0])

    def share(seconds):
        return 100.0 * seconds / turning if turning else math.nan

    return {
        "log_hours": result.log_seconds / 3600.0,
        "simulated_hours": result.sim_seconds / 3600.0,
        "running_hours": turning / 3600.0,
        "gap_hours": result.gap_seconds / 3600.0,
        "revolutions": result.revolutions,
        "largest_speed": float(np.abs(result.speed).max(initial=0.0)) * 30.0 / math.pi,
        "largest_load": float(max(result.load, default=0.0)),
        **{f"slip_{name}": 100.0 * value for name, value in slip.items()},
        "above_slip_warning": share(result.seconds_above(scene.thresholds.slip_warning)),
        "above_slip_error": share(result.seconds_above(scene.thresholds.slip_error)),
        "below_minimum_load": share(below),
        "damage": 100.0 * result.damage,
        "life": result.use(scene.thresholds).life_hours,
        "least_rating_life": result.least_rating_life,
        "failed_intervals": result.failed_ticks,
        "samples": result.samples,
        **_band_results(result),
    }


def _band_results(result: Replay) -> dict[str, float]:
    """Return the ends of the bands of a replay by the names of their columns; NaN without bands."""
    statistics, found = result.band_statistics(), {}
    for name, (statistic, scale) in _BANDS.items():
        low, high = statistics.get(statistic, (math.nan, math.nan))
        found |= {f"{name}_low": scale * low, f"{name}_high": scale * high}
    return found


_tables: dict[tuple[str, tuple[float, float]], OperatingPoints] = {}


def _operating_points(scene: Scene, temperatures: tuple[float, float]) -> OperatingPoints:
    """Return a scene's table of operating points: this worker's, the one on disk, or newly built by one worker of this machine."""
    key = repr(scene), temperatures
    if key not in _tables:
        while len(_tables) >= _TABLES_KEPT:
            del _tables[next(iter(_tables))]
        with _alone(table_path(scene, span_of(scene, temperatures))):
            _tables[key] = obtain_table(scene, temperatures)[0]
    return _tables[key]


@contextmanager
def _alone(path: Path):
    """Hold a lock on a path against other processes of this machine, where its folder can be written."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        descriptor = os.open(path.with_suffix(".lock"), os.O_CREAT | os.O_RDWR, 0o600)
    except OSError:  # then each worker builds its own table
        yield
        return
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _complete(bearing: Bearing, row: dict) -> dict:
    """Return a row with all columns."""
    scene, only = bearing.scene, "".join(f", {column} = {text}" for column, text in bearing.log.only)
    known = isinstance(scene, Scene)
    names = {"bearing": bearing.name, "log": f"{bearing.log.path}{only}", "scene": scene.name if known else scene.origin}
    return _EMPTY | names | {"level": scene.level if known else ""} | row


def _about(bearings: Sequence[Bearing]) -> dict:
    scenes = sorted({bearing.scene.name for bearing in bearings if isinstance(bearing.scene, Scene)})
    return {"kind": "fleet", "scene": ", ".join(scenes) or "no scene", "version": package_version(), "commit": git_hash()}
