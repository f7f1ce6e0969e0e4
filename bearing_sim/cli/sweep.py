# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim sweep``: a scene at every combination of values."""

from contextlib import suppress

from bearing_sim.cli.options import SECONDS, executor_options, json_option, option, picture_option, scene_argument, set_option, table_option
from bearing_sim.cli.reporting import (
    Points,
    UsageError,
    announce_compilation,
    print_points,
    refuse_idle_temperature,
    scene_of,
    warn,
)
from bearing_sim.cli.results import Result, command, resumed, signed


@command("sweep")
@scene_argument
@option(
    "--vary",
    "axes",
    "Vary a field over N evenly spaced values, or over a list, FIELD=a,b,c; repeat the option for a grid.",
    multiple=True,
    required=True,
    metavar="FIELD=START:STOP:N",
)
@set_option
@option("--level", "Level of fidelity, instead of the scene's.", metavar="LEVEL")
@option("--duration", "Shortest simulated time per point; extended until it has settled.", SECONDS, default="0.5 s")
@table_option("sweep.parquet", "Results; also written: PATH.csv and")
@executor_options
@picture_option("Draw the results")
@json_option
def sweep(scene_name, axes, overrides, level, duration, out, workers, dask, picture):
    """Run SCENE at every combination of values, on all cores, until each point has settled.

    Slip, lives, loads and powers are means over the last fifth of a run, largest loads are those over the roller pitch of cage rotation
    that follows.  An interrupted sweep resumes with the same command; points computed by an earlier sweep into the same file are not
    computed again.

    bearing-sim sweep deng2017_table1 --vary bearing.outer_raceway.low_radius=34.86mm:34.8675mm:7 --picture sweep.png
    """
    from bearing_sim.model.plausibility import plausibility
    from bearing_sim.scene.loader import SceneError
    from bearing_sim.sweep.grid import plan_sweep, point_count, read_axis
    from bearing_sim.sweep.tasks import run_tasks

    varied = [read_axis(text, written=True) for text in axes]
    count = point_count(varied)
    _check_sweep(varied, level)
    from bearing_sim.sweep.pictures import plot_table, require_drawable

    require_drawable([axis.values for axis in varied]) if picture is not None else None
    with suppress(SceneError):  # what varies may be what makes the scene valid
        warn(plausibility(scene_of(scene_name, overrides)))
    announce_compilation()
    from bearing_sim.sweep.table import study_digest, write_table

    points = Points("sweep", count)
    plan = plan_sweep(scene_name, [*overrides, *([f"level={level}"] if level else [])], varied, duration)
    first = next(each for each in plan.scenes if not isinstance(each, SceneError))
    refuse_idle_temperature(first, [*overrides, *(axis.field.path for axis in varied)])
    study = study_digest("sweep", [(axis.field.path, axis.values) for axis in plan.axes], plan.duration, list(map(_defined, plan.scenes)))
    with resumed(out, study, points) as journal:
        table = plan.table(run_tasks(plan.tasks, journal, workers, dask, points.update))
    files = write_table(out.path, signed(table, study))
    report = _report_sweep(table, points, files)
    return Result(
        report | {"points": table.rows},
        lambda: _print_sweep(table, report),
        lambda draft: plot_table(draft, table),
        remarks=[f"{points.computed} points computed, {points.kept} kept from before"],
        files=files,
        warnings=report["warnings"],
    )


def _defined(scene):
    """Return what defines a point: its scene, or the text of the error of an invalid one."""
    return str(scene) if isinstance(scene, ValueError) else scene


def _check_sweep(axes, level) -> None:
    paths = [axis.field.path for axis in axes]
    for path in set(paths):
        if paths.count(path) > 1:
            raise UsageError(f"--vary {path}: given {paths.count(path)} times; give all its values in one option")
    if level is not None and "level" in paths:
        raise UsageError("--level and --vary level= contradict each other; give one of them")


def _report_sweep(table, points, files) -> dict:
    from bearing_sim.model.validity import counted

    statuses = table.values("status")
    return {
        "scene": table.about["scene"],
        "level": table.about["level"],
        "computed": points.computed,
        "kept_from_before": points.kept,
        **{f"{status}_points": statuses.count(status) for status in ("ok", "unsettled", "failed", "refused")},
        "parquet": str(files[0]),
        "csv": str(files[1]),
        "picture": None,
        "warnings": counted(row["warnings"] for row in table.rows),
    }


def _print_sweep(table, report) -> None:
    from bearing_sim.sweep.pictures import default_quantities

    varied = [axis["field"] for axis in table.about["axes"]]
    title = f"{report['scene']} at level {report['level']}"
    print_points(title, table, [*varied, *default_quantities(table), "shaft_power", "status"], keys=len(varied))
