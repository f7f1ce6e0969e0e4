# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Commands that run many points: ``sweep``, its ``plot``, and the ``design`` of outer raceways."""

import math
from collections import Counter
from contextlib import suppress
from pathlib import Path

import click

from bearing_sim.cli.options import executor_options, json_option, picture_option, scene_argument, set_option, table_option
from bearing_sim.cli.reporting import (
    Points,
    UsageError,
    announce_compilation,
    as_file_error,
    as_usage_error,
    exit_on_sigterm,
    print_json,
    print_rows,
    seconds_of,
    warn,
    warn_of_scene,
)

_SHOWN = ("cage_slip", "rating_life", "inner_load_maximum", "outer_load_maximum", "shaft_power", "status")


@click.command("sweep")
@scene_argument
@click.option(
    "--vary",
    "axes",
    multiple=True,
    required=True,
    metavar="FIELD=START:STOP:N",
    help="Vary a field over N evenly spaced values, or over a list, FIELD=a,b,c; repeat the option for a grid.",
)
@set_option
@click.option("--level", metavar="LEVEL", help="Level of fidelity, instead of the scene's.")
@click.option("--duration", default="0.5 s", show_default=True, metavar="S", help="Simulated time per point; extended until the point has settled.")
@table_option("sweep.parquet", "Results; also written: PATH.csv and")
@executor_options
@picture_option("Draw the results")
@json_option
def sweep(scene_name, axes, overrides, level, duration, out, workers, dask, picture, as_json):
    """Run SCENE at every combination of values, on all cores, until each point has settled.

    Slip, lives, loads and powers are means over the last fifth of a run, largest loads are those of any instant in it.  An interrupted
    sweep resumes with the same command; points computed by an earlier sweep into the same file are not computed again.

    bearing-sim sweep deng2017_table1 --vary bearing.outer_raceway.low_radius=34.86mm:34.8675mm:7 --picture sweep.png
    """
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.sweep.grid import FieldError, read_axis
    from bearing_sim.sweep.tasks import ClusterError, Journal, JournalInUse

    seconds = seconds_of(duration)
    with as_usage_error(FieldError):
        varied = [read_axis(text) for text in axes]
    _check_sweep(varied, level)
    with suppress(SceneError):  # what varies may be what makes the scene valid
        warn_of_scene(load_scene(scene_name, overrides))
    announce_compilation()
    from bearing_sim.sweep.grid import sweep
    from bearing_sim.sweep.table import write_table

    overrides = [*overrides, *([f"level={level}"] if level else [])]
    points = Points("sweep", math.prod(len(axis.values) for axis in varied))
    with as_file_error(), exit_on_sigterm(), as_usage_error(SceneError, ClusterError, JournalInUse):
        with Journal(out.with_suffix(".journal")) as journal, points:
            table = sweep(scene_name, overrides, varied, journal, seconds, workers, dask, points.update)
        files = write_table(out, table)
        if picture is not None:
            from bearing_sim.sweep.table import NotDrawable, draw

            with as_usage_error(NotDrawable):
                draw(picture, table)
    report = _report_sweep(table, points, files, picture)
    if as_json:
        print_json(report | {"points": table.rows})
    else:
        _print_sweep(table, report)


def _check_sweep(axes, level) -> None:
    from bearing_sim.sweep.grid import MOST_POINTS

    paths = [axis.field.path for axis in axes]
    for path in set(paths):
        if paths.count(path) > 1:
            raise UsageError(f"--vary {path}: given {paths.count(path)} times; give all its values in one option")
    if level is not None and "level" in paths:
        raise UsageError("--level and --vary level= contradict each other; give one of them")
    points = math.prod(len(axis.values) for axis in axes)
    if points > MOST_POINTS:
        raise UsageError(f"--vary: {points} points; a sweep has at most {MOST_POINTS}")


def _report_sweep(table, points, files, picture) -> dict:
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
        "picture": picture and str(picture),
        "warnings": counted(row["warnings"] for row in table.rows),
    }


def _print_sweep(table, report) -> None:
    varied = [axis["field"] for axis in table.about["axes"]]
    columns = [table.column(name) for name in (*varied, *_SHOWN)]
    names = [column.name.rpartition(".")[2] + (f", {column.unit}" if column.unit else "") for column in columns]
    shown = table.rows if len(table.rows) <= 60 else table.rows[:50]
    rows = [
        [f"{row[name]:.{8 if name in varied else 5}g}" if isinstance(row[name], float) else str(row[name]) for name in (*varied, *_SHOWN)]
        for row in shown
    ]
    print_rows(f"{report['scene']} at level {report['level']}", names, rows, words=("status",))
    if len(shown) < len(table.rows):
        click.echo(f"... and {len(table.rows) - len(shown)} more points; all are in the files")
    reasons = Counter(f"{row['status']}: {row['reason']}" for row in table.rows if row["reason"])
    for reason, count in reasons.most_common(5):
        click.echo(f"{count} x {reason}")
    warn(report["warnings"])
    counts = f"{report['computed']} points computed, {report['kept_from_before']} kept from before"
    click.echo(f"{counts}; {', '.join(filter(None, (report['parquet'], report['csv'], report['picture'])))}")


@click.command("plot")
@click.argument("path", metavar="TABLE.parquet", type=click.Path(path_type=Path))
@picture_option("Draw the results")
@click.option("--quantity", "quantities", multiple=True, metavar="COLUMN", help="Draw this column; can be repeated [default: slip, life, loads].")
def plot(path, picture, quantities):
    """Draw a sweep: lines for one varied field, maps for two; into TABLE.png unless --picture is given."""
    from bearing_sim.sweep.table import QUANTITIES, NotDrawable, draw, read_table

    picture = picture or path.with_suffix(".png")
    with as_file_error(), as_usage_error(NotDrawable, ValueError):
        draw(picture, read_table(path), quantities or QUANTITIES)
    click.echo(str(picture))


@click.command("design")
@scene_argument
@click.option("--slip-below", required=True, metavar="SLIP", help="Largest cage slip, such as 10%.")
@click.option("--life-above", required=True, metavar="LIFE", help="Smallest life, such as 300h; the kind of life is chosen in the scene.")
@click.option("--speed-tolerance", default="2%", show_default=True, metavar="FRACTION", help="Tolerance of the speed, in both directions.")
@click.option("--load-tolerance", default="10%", show_default=True, metavar="FRACTION", help="Tolerance of the load, in both directions.")
@click.option("--low-radius", "radii", metavar="START:STOP:N", help="Radii at the low points [default: 16 values, -2.5 to +5 um about the scene's].")
@click.option("--d-value", "d_values", metavar="START:STOP:N", help="D values [default: 9 values, 80 to 120 % of the scene's].")
@set_option
@click.option("--level", metavar="LEVEL", help="Level of fidelity [default: steady if it supports the scene, otherwise the scene's].")
@table_option("design.parquet", "Map; also written: PATH.csv, PATH_borders.parquet and .csv, and")
@executor_options
@picture_option("Draw the results")
@json_option
def design(
    scene_name, slip_below, life_above, speed_tolerance, load_tolerance, radii, d_values, overrides, level, out, workers, dask, picture, as_json
):
    """Map which low-point radii and D values keep the slip of SCENE below a limit and its life above another.

    bearing-sim design deng2017_table1 --slip-below 10% --life-above 300h --picture design.png
    """
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.sweep.grid import FieldError, read_axis
    from bearing_sim.sweep.tasks import ClusterError, Journal, JournalInUse

    with as_usage_error(SceneError, FieldError):
        scene = load_scene(scene_name, overrides)
        level = level or _cheapest(scene)
        overrides = [*overrides, f"level={level}"]
        scene = load_scene(scene_name, overrides)
        _check_design(scene)
        warn_of_scene(scene)
        announce_compilation()
        from bearing_sim.studies import design as studied
        from bearing_sim.sweep.point import DURATION
        from bearing_sim.sweep.table import write_table

        axes = list(studied.default_axes(scene))
        for place, (path, text) in enumerate(((studied.LOW, radii), (studied.D_VALUE, d_values))):
            if text is not None:
                axes[place] = read_axis(f"{path}={text}")
    wanted = studied.Limits(*_limits(slip_below, life_above, speed_tolerance, load_tolerance))
    points = Points("raceways", 0)
    with as_file_error(), exit_on_sigterm(), as_usage_error(SceneError, ClusterError, JournalInUse):
        with Journal(out.with_suffix(".journal")) as journal, points:
            designed = studied.design(scene_name, overrides, wanted, *axes, journal, DURATION, workers, dask, points.update)
        files = [*write_table(out, designed.grid), *write_table(out.with_name(f"{out.stem}_borders.parquet"), designed.border_table)]
        beside = _beside(scene, wanted)
        if picture is not None:
            from bearing_sim.studies.design import draw

            draw(picture, designed, beside)
            files.append(picture)
    report = _report_design(scene, designed, beside, files)
    if as_json:
        print_json(report)
    else:
        _print_design(report)


def _cheapest(scene) -> str:
    from bearing_sim.scene.fidelity import asked_for, levels_with

    return "steady" if "steady" in levels_with(asked_for(scene)) else scene.level


def _check_design(scene) -> None:
    raceway = scene.bearing.outer_raceway
    if not raceway.d_value or raceway.contour is not None or raceway.low_points:
        raise UsageError("bearing.outer_raceway: a design varies low_radius and d_value of even lobes; this raceway is round or given otherwise")
    if scene.operating.shaft_speed == 0.0:
        raise UsageError("operating.shaft_speed: 0; there is no slip at rest; give a speed")


def _limits(slip_below, life_above, speed_tolerance, load_tolerance) -> tuple[float, float, float, float]:
    from bearing_sim.scene.quantity import to_si

    found = []
    for name, text, unit, factor, most in (
        ("--slip-below", slip_below, "", 100.0, 100.0),
        ("--life-above", life_above, "h", 1.0, 1e9),
        ("--speed-tolerance", speed_tolerance, "", 1.0, 0.5),
        ("--load-tolerance", load_tolerance, "", 1.0, 0.9),
    ):
        try:
            value = factor * to_si(text, unit)
        except ValueError as error:
            raise UsageError(f"{name} {text}: {error}") from None
        if not 0.0 <= value <= most:
            raise UsageError(f"{name} {text}: expected 0 to {most / factor:g}{f' {unit}' if unit else ''}")
        found.append(value)
    return tuple(found)


def _beside(scene, wanted):
    from bearing_sim.studies.deng2017 import design as deng

    asked = scene.bearing.name, wanted.slip_below, wanted.life_above
    return deng.BESIDE if asked == (deng.SCENE, deng.SLIP_BELOW, deng.LIFE_ABOVE) else None


def _report_design(scene, designed, beside, files) -> dict:
    from bearing_sim.model.validity import counted
    from bearing_sim.studies.deng2017.design import radii_within
    from bearing_sim.studies.design import KINDS

    about = designed.grid.about
    report = {"scene": scene.name, "level": about["level"], **about["wanted"], "raceways": len(designed.grid.rows)}
    report["warnings"] = counted(row["warnings"] for row in designed.grid.rows)
    report["without_result"] = sum(row["status"] in ("failed", "refused") for row in designed.grid.rows)
    for kind in KINDS:
        borders = [border for border in designed.borders if border.kind == kind]
        report[kind] = [border._asdict() for border in borders]
        if beside is not None:
            found = radii_within(borders, beside[1])
            report[f"{kind}_within_deng"] = found and {"low_from": found[0], "low_to": found[1]}
    return report | {"deng2017": beside and {"d_value": beside[1], "low_radius": beside[2]}, "files": list(map(str, files))}


def _print_design(report) -> None:
    from bearing_sim.studies.design import NOMINAL, WORST

    spread = f"speed +-{100 * report['speed_tolerance']:g} %, load +-{100 * report['load_tolerance']:g} %"
    click.echo(f"{report['scene']} at level {report['level']}: slip below {report['slip_below']:g} %, life above {report['life_above']:g} h")
    if report["without_result"]:
        click.echo(f"{report['without_result']} of {report['raceways']} raceways have no result; the table has the reasons")
    for kind, condition in ((NOMINAL, "at the scene's speed and load"), (WORST, f"in the worst case of {spread}")):
        click.echo(f"{condition}:" if report[kind] else f"{condition}: no raceway in the map meets both limits")
        for border in report[kind]:
            ends = f"from {border['low_from']:.5f} (bound by {border['below_by']}) to {border['low_to']:.5f} mm (bound by {border['above_by']})"
            click.echo(f"  D = {border['d_value']:.4f} mm: R_low {ends}")
        if report["deng2017"]:
            found, (left, right), (low, high) = report[f"{kind}_within_deng"], report["deng2017"]["d_value"], report["deng2017"]["low_radius"]
            span = f"R_low {found['low_from']:.5f} to {found['low_to']:.5f} mm" if found else "none in the map"
            click.echo(f"  for every D from {left} to {right} mm: {span}; Deng 2017 has {low:.4f} to {high:.4f} mm")
    warn(report["warnings"])
    click.echo(", ".join(report["files"]))
