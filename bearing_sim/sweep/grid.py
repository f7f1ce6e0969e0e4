# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A sweep: all combinations of the values of its axes, each a run of a scene, as one table."""

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

from bearing_sim.provenance import git_hash, package_version
from bearing_sim.scene import Scene
from bearing_sim.scene_file import SceneError, load_scene, scene_to_yaml
from bearing_sim.sweep.axis import Axis
from bearing_sim.sweep.executor import run_tasks
from bearing_sim.sweep.journal import Journal
from bearing_sim.sweep.point import DURATION, REFUSED, RESULTS, TEXTS, Column, empty_row, point_row
from bearing_sim.sweep.table import Table
from bearing_sim.sweep.tasks import Task, task

MOST_POINTS = 1_000_000


def sweep(
    name: str,
    overrides: Sequence[str],
    axes: Sequence[Axis],
    journal: Journal,
    duration: float = DURATION,
    workers: int | None = None,
    dask: str | None = None,
    tell: Callable[[int, int], None] = lambda done, total: None,
) -> Table:
    """Run a scene at every combination of values.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene_file.load_scene` takes them.
    axes : what is varied; the first varies slowest.
    journal : of finished points.
    duration : of a run, see `bearing_sim.sweep.point.settle` [s].
    workers, dask, tell : see `bearing_sim.sweep.executor.run_tasks`.

    Returns
    -------
    one row a point: the varied fields, then `bearing_sim.sweep.point.RESULTS` and `TEXTS`.

    Raises
    ------
    SceneError
        No point can be: the faults are those of the first.
    ClusterError
        See `bearing_sim.sweep.executor.run_tasks`.
    """
    plan = plan_sweep(name, overrides, axes, duration)
    return plan.table(run_tasks(plan.tasks, journal, workers, dask, tell))


class Plan(NamedTuple):
    """A sweep before it is computed: what each combination of values means.

    Attributes
    ----------
    name, overrides, axes, duration : see `sweep`.
    places : the combinations, one value of each axis.
    scenes : what is run at each of them, or why there is no such scene.
    """

    name: str
    overrides: tuple[str, ...]
    axes: tuple[Axis, ...]
    duration: float
    places: tuple[tuple, ...]
    scenes: tuple[Scene | SceneError, ...]

    @property
    def tasks(self) -> list[Task]:
        """What there is to compute: a task for each point that can be."""
        return [point_task(scene, self.duration) for scene in self.scenes if isinstance(scene, Scene)]

    def table(self, results: Iterable[dict]) -> Table:
        """Return the table of all points from the results of `tasks`."""
        results, rows = iter(results), []
        for place, scene in zip(self.places, self.scenes):
            shown = {axis.field.path: axis.field.shown(value) for axis, value in zip(self.axes, place)}
            rows.append(shown | (_complete(next(results)) if isinstance(scene, Scene) else empty_row(REFUSED, _one_line(scene))))
        columns = tuple(Column(axis.field.path, axis.field.unit, axis.field.meaning) for axis in self.axes) + RESULTS + TEXTS
        return Table(columns, rows, self._about())

    def _about(self) -> dict:
        scene = next(scene for scene in self.scenes if isinstance(scene, Scene))
        return {
            "kind": "sweep",
            "scene": self.name,
            "overrides": list(self.overrides),
            "level": scene.level if all(axis.field.path != "level" for axis in self.axes) else "varied",
            "axes": [{"field": axis.field.path, "unit": axis.field.unit, "values": axis.shown} for axis in self.axes],
            "duration": self.duration,
            "version": package_version(),
            "commit": git_hash(),
            "scene_of_first_point": scene_to_yaml(scene),
        }


def plan_sweep(name: str, overrides: Sequence[str], axes: Sequence[Axis], duration: float = DURATION) -> Plan:
    """Return what a sweep will compute; parameters and faults as of `sweep`."""
    places = tuple(itertools.product(*(axis.values for axis in axes)))
    scenes = tuple(_scene_at(name, overrides, axes, place) for place in places)
    if not any(isinstance(scene, Scene) for scene in scenes):
        raise scenes[0]
    return Plan(name, tuple(overrides), tuple(axes), float(duration), places, scenes)


def point_task(scene: Scene, duration: float = DURATION) -> Task:
    """Return the task that makes the row of one point."""
    return task(scene.level, point_row, scene, float(duration))


def _scene_at(name, overrides, axes, place) -> Scene | SceneError:
    try:
        return load_scene(name, [*overrides, *(axis.override(value) for axis, value in zip(axes, place))])
    except SceneError as fault:
        return fault


def _complete(result: dict) -> dict:
    """Return a result with all columns: a worker that died left none but status and reason."""
    return result if len(result) > len(TEXTS) else empty_row(result["status"], result["reason"])


def _one_line(fault: SceneError) -> str:
    return "; ".join(map(str, fault.faults))
