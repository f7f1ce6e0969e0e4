# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim sweep``: a scene at every combination of values of its fields, as a table."""

import math

import click

from bearing_sim.commands.reporting import (
    BadInput,
    orderly_end,
    picture_option,
    print_json,
    print_rows,
    tell_compilation,
    told_as_bad_input,
    told_file_faults,
)
from bearing_sim.commands.sweeping import Points, executor_options, table_option

_SHOWN = ("cage_slip", "rating_life", "inner_load_maximum", "outer_load_maximum", "shaft_power", "status")


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option(
    "--vary",
    "axes",
    multiple=True,
    required=True,
    metavar="FIELD=START:STOP:N",
    help="Vary a field over N even values, or over a list, FIELD=a,b,c; repeat it for a grid.",
)
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--level", metavar="LEVEL", help="Fidelity level instead of the scene's.")
@click.option("--duration", default="0.5 s", show_default=True, metavar="S", help="Simulated time of a point that settles in it.")
@table_option("sweep.parquet", "The table; beside it PATH.csv and")
@executor_options
@picture_option("Draw the results")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, axes, overrides, level, duration, out, workers, dask, picture, as_json):
    """Run SCENE at every combination of values, on all cores, until each point has settled.

    Slip, lives, loads and powers are means over the last fifth of a run, largest loads those of any instant of it.  The same command goes
    on where a kill stopped it; points that an earlier sweep into the same file has computed are not computed again.

    bearing-sim sweep deng2017_table1 --vary bearing.outer_raceway.low_radius=34.86mm:34.8675mm:7 --picture sweep.png
    """
    from bearing_sim.quantity import to_si
    from bearing_sim.scene_file import SceneError
    from bearing_sim.sweep.axis import read_axis
    from bearing_sim.sweep.executor import ClusterError
    from bearing_sim.sweep.fields import FieldError
    from bearing_sim.sweep.journal import Journal, JournalInUse

    with told_as_bad_input(ValueError):
        seconds = to_si(duration, "s")
    if not 0.0 < seconds <= 1e6:
        raise BadInput(f"--duration {duration}: expected more than 0 and at most 1e6 s")
    with told_as_bad_input(FieldError):
        varied = [read_axis(text) for text in axes]
    _check(varied, level)
    tell_compilation()
    from bearing_sim.sweep.grid import sweep
    from bearing_sim.sweep.table import write_table

    overrides = [*overrides, *([f"level={level}"] if level else [])]
    points = Points("sweep", math.prod(len(axis.values) for axis in varied))
    with told_file_faults(), orderly_end(), told_as_bad_input(SceneError, ClusterError, JournalInUse):
        with Journal(out.with_suffix(".journal")) as journal, points:
            table = sweep(scene_name, overrides, varied, journal, seconds, workers, dask, points.tell)
        files = write_table(out, table)
        if picture is not None:
            from bearing_sim.sweep.picture import NotDrawable, draw

            with told_as_bad_input(NotDrawable):
                draw(picture, table)
    report = _report(table, points, files, picture)
    if as_json:
        print_json(report | {"points": table.rows})
    else:
        _print(table, report)


def _check(axes, level) -> None:
    from bearing_sim.sweep.grid import MOST_POINTS

    paths = [axis.field.path for axis in axes]
    for path in set(paths):
        if paths.count(path) > 1:
            raise BadInput(f"--vary {path}: given {paths.count(path)} times; list all its values in one")
    if level is not None and "level" in paths:
        raise BadInput("--level and --vary level= contradict each other; give one")
    points = math.prod(len(axis.values) for axis in axes)
    if points > MOST_POINTS:
        raise BadInput(f"--vary: {points} points; at most {MOST_POINTS} go into one sweep")


def _report(table, points, files, picture) -> dict:
    statuses = table.values("status")
    return {
        "scene": table.about["scene"],
        "level": table.about["level"],
        "computed": points.computed,
        "kept_from_before": points.kept,
        **{f"{status}_points": statuses.count(status) for status in ("ok", "unsettled", "failed", "refused")},
        "parquet": str(files[0]),
        "csv": str(files[1]),
        "picture": picture and str(picture),
    }


def _print(table, report) -> None:
    varied = [axis["field"] for axis in table.about["axes"]]
    columns = [table.column(name) for name in (*varied, *_SHOWN)]
    names = [column.name.rpartition(".")[2] + (f", {column.unit}" if column.unit else "") for column in columns]
    shown = table.rows if len(table.rows) <= 60 else table.rows[:50]
    rows = [
        [f"{value:.{8 if name in varied else 5}g}" if isinstance(value, float) else str(value) for name, value in _picked(row, columns)]
        for row in shown
    ]
    print_rows(f"{report['scene']} at level {report['level']}", names, rows, words=("status",))
    if len(shown) < len(table.rows):
        click.echo(f"... and {len(table.rows) - len(shown)} points more, all in the files")
    for reason, count in _reasons(table).items():
        click.echo(f"{count} x {reason}")
    told = f"{report['computed']} points computed, {report['kept_from_before']} kept from before"
    click.echo(f"{told}; {', '.join(filter(None, (report['parquet'], report['csv'], report['picture'])))}")


def _picked(row, columns):
    return [(column.name, row[column.name]) for column in columns]


def _reasons(table) -> dict:
    counts: dict = {}
    for row in table.rows:
        if row["reason"]:
            told = f"{row['status']}: {row['reason']}"
            counts[told] = counts.get(told, 0) + 1
    return dict(sorted(counts.items(), key=lambda item: -item[1])[:5])
