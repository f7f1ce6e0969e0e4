# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run the study of Deng 2017 into a folder: tables, figures, claims, and a file with settings and versions."""

import json
import platform
import shlex
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from importlib import metadata
from pathlib import Path

from bearing_sim.files.outputs import FORCE, Output, RefusedOutput, replaced
from bearing_sim.files.provenance import git_hash, package_version
from bearing_sim.levels.level import LEVELS as ALL_LEVELS
from bearing_sim.scene.loader import load_scene, scene_to_yaml
from bearing_sim.sweep.point import Column
from bearing_sim.sweep.table import Table, write_table
from bearing_sim.sweep.tasks import Journal, run_tasks
from deng2017.claims import Finding, contour_finding, judge, machined_rings, machining_table
from deng2017.design import answer, write_answer
from deng2017.pictures import plot_study
from deng2017.study import LEVELS, STUDIES, plan_study

STUDY_FILE = "study.json"
_JOURNAL = "study.journal"
_PACKAGES = ("numba", "numpy", "scipy", "pyarrow", "matplotlib")
_FINDING_MEANINGS = {
    "claim": "number; 0: the machined contours",
    "figures": "of the paper",
    "says": "what Deng 2017 claims",
    "level": "of this code",
    "verdict": "holds, holds in part, does not hold",
    "gives": "result of this code",
    "off": "deviation from the claim",
    "why": "reason for the deviation, if the numbers show it",
}


def run_study(
    folder: Path,
    quick: bool = False,
    workers: int | None = None,
    dask: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
    overrides: Sequence[str] = (),
) -> list[Finding]:
    """Compute the study into a folder, reusing finished points, and return the claims.

    Parameters
    ----------
    folder : created if absent; its journal holds every finished point.
    quick : few points and short runs, for testing.
    workers, dask, progress : see `bearing_sim.sweep.tasks.run_tasks`.
    overrides : of every scene of the study, such as ``support.elastic=true``.

    Raises
    ------
    SceneError
        A scene with the overrides is invalid.
    ClusterError
        See `bearing_sim.sweep.tasks.run_tasks`.
    JournalInUse
        Another process is writing to this folder.
    """
    began = time.monotonic()
    for part in (folder / "tables", folder / "figures"):
        part.mkdir(parents=True, exist_ok=True)
    planned, counts = plan_study(quick, overrides), [0, 0]

    def counted(done, total):
        counts[:] = done, total
        progress(done, total)

    with Journal(folder / _JOURNAL) as journal:
        results = iter(run_tasks(planned.tasks, journal, workers, dask, counted))
        designed = answer(journal, quick, workers, dask, overrides)
    tables = {key: plan.table([next(results) for _ in plan.tasks]) for key, plan in planned.sweeps.items()}
    profiles = {key: next(results) for key in planned.profiles}
    trajectories = {low: next(results) for low in planned.trajectories}
    rings = machined_rings()
    findings = [contour_finding(rings), *judge(tables, LEVELS)]
    _write_tables(folder / "tables", tables, profiles, trajectories, rings, findings)
    pictured = [*plot_study(folder / "figures", tables, profiles, trajectories, rings), write_answer(folder, designed)]
    about = {
        "title": "Deng et al. 2017, Cage slip characteristics of a cylindrical roller bearing with a trilobe-raceway: the results with bearing_sim",
        "doi": "10.1016/j.cja.2017.07.001",
        "command": shlex.join(["python", "examples/deng2017", "-o", folder.name, *(["--quick"] if quick else []), *_as_options(overrides)]),
        "quick": quick,
        "overrides": list(overrides),
        "points": len(planned.tasks),
        "computed": counts[0],
        "seconds": round(time.monotonic() - began, 1),
        "duration": planned.duration,
        "levels": {level: f"leaves out {ALL_LEVELS[level].leaves_out}" for level in LEVELS},
        "sweeps": [
            {
                "name": each.name,
                "figures": each.figures,
                "title": each.title,
                "scene": each.scene,
                "set": [*overrides, *each.overrides],
                "vary": list(each.quick_axes if quick else each.axes),
            }
            for each in STUDIES
        ],
        "scenes": {name: scene_to_yaml(load_scene(name, overrides)) for name in dict.fromkeys(each.scene for each in STUDIES)},
        "versions": {"bearing_sim": package_version(), "commit": git_hash(), "python": platform.python_version()}
        | {name: metadata.version(name) for name in _PACKAGES},
        "statuses": Counter(status for table in tables.values() for status in table.values("status")),
        "claims": [finding._asdict() for finding in findings],
        "figures": [each._asdict() for each in pictured],
    }
    with replaced(folder / STUDY_FILE) as draft:
        draft.write_text(json.dumps(about, indent=2))
    return findings


def require_same_study(output: Output, quick: bool, overrides: Sequence[str]) -> None:
    """Raise `RefusedOutput` if a folder is in use for anything but the same study, which is then completed or written again.

    Parameters
    ----------
    output : the folder; by force, anything there may be replaced.
    quick, overrides : of the study that is going to be written, see `run_study`.
    """
    folder = output.path
    if output.force or not folder.is_dir() or not any(folder.iterdir()):
        return
    if not (folder / _JOURNAL).is_file():
        raise RefusedOutput(f"{folder} holds other files; name a new folder, or replace what is in the way with {FORCE}")
    try:
        about = json.loads((folder / STUDY_FILE).read_text())
        same = about["quick"] == quick and about["overrides"] == list(overrides)
    except FileNotFoundError:
        return  # interrupted before its end
    except (ValueError, LookupError, TypeError):
        same = False
    if not same:
        raise RefusedOutput(f"{folder} holds a study with other settings (see {STUDY_FILE}); name a new folder, or replace it with {FORCE}")


def _as_options(overrides: Sequence[str]) -> list[str]:
    return [part for text in overrides for part in ("--set", text)]


def _write_tables(folder, tables, profiles, trajectories, rings, findings) -> None:
    for (name, level), table in tables.items():
        write_table(folder / f"{name}_{level}", table)
    columns = Column("sweep", "", "which field is varied"), Column("value", "", "of that field"), Column("level", "", "of fidelity")
    measured = (
        Column("azimuth", "deg", "from the load line"),
        Column("inner_load", "N", "inner load, mean at that azimuth"),
        Column("outer_load", "N", "outer load, mean at that azimuth"),
    )
    write_table(folder / "load_distributions", _table_of_lists(profiles, columns, measured, "load distributions"))
    units = {"time": "s", "cage_y": "um", "cage_z": "um", "roller_angle": "deg", "spin_ratio": ""}
    measured = tuple(Column(name, unit, name.replace("_", " ")) for name, unit in units.items())
    moving = {(low,): one for low, one in trajectories.items()}
    write_table(folder / "trajectories", _table_of_lists(moving, (Column("low_radius", "mm", "R_low"),), measured, "trajectories"))
    write_table(folder / "machining", machining_table(rings))
    columns = tuple(Column(name, "", meaning) for name, meaning in _FINDING_MEANINGS.items())
    write_table(folder / "claims", Table(columns, [finding._asdict() for finding in findings], {"kind": "claims"}))


def _table_of_lists(results: Mapping[tuple, dict], columns: tuple[Column, ...], measured: tuple[Column, ...], kind: str) -> Table:
    """Return the lists in results as a table: in each row the key of its result, then one element of each list."""
    names = [column.name for column in (*columns, *measured)]
    rows = [
        dict(zip(names, (*key, *numbers)))
        for key, one in results.items()
        if one["status"] == "ok"
        for numbers in zip(*(one[column.name] for column in measured))
    ]
    return Table((*columns, *measured), rows, {"kind": kind})
