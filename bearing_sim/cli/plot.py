# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim plot`` and ``report``: pictures of recorded runs and of the tables of sweeps without a viewer, and pages of any result."""

import math
from pathlib import Path

import click
from click import Choice, IntRange

from bearing_sim.cli.options import PATH, option, picture_option
from bearing_sim.cli.outputs import OutputFile, default_output
from bearing_sim.cli.reporting import Points, UsageError, as_usage_error, note, progress_bar, tell_use
from bearing_sim.cli.results import Result, command

_TABLES = (".parquet", ".csv")


@command("plot")
@click.argument("paths", type=PATH, metavar="RESULT...", nargs=-1, required=True)
@picture_option("The picture", "-o", "--out")
@option("--over", "Draw over this [default: time for recordings, what was varied for sweeps].", Choice(["time", "load"]))
@option("--panel", "panels", "Draw this panel of a recording over time; can be repeated [default: six].", multiple=True, metavar="NAME")
@option("--band", "Compute the range of the slip of a recording from N samples of the uncertain fields.", IntRange(8, 4096), metavar="N")
@option("--quantity", "quantities", "Draw this column of a sweep; can be repeated [default: slip, life, loads].", multiple=True, metavar="COLUMN")
def plot(paths, picture, over, panels, band, quantities):
    """Draw recorded runs or a sweep into a picture; beside RESULT, with the suffix .png, unless -o is given.

    A recording of `run`, `replay` or the node (.mcap, or a bag's folder) is drawn over time: speed, load, slip, life, temperatures and
    running clearance; further panels are damage and power. Slip and clearance are shaded by the bands that the run published, where its
    scene asked for them. Several recordings are compared, each from its own start. With --band the slip
    has its 5 to 95 % range, by the ranges in the scene's block `uncertainty`, as `uncertainty --log` computes it; no range is made up.
    --over load shows slip and life over the radial load with the minimum load of the maker's formula.

    The table of a sweep (.parquet, or the .csv beside it) has lines for one varied field, maps for two; --over load wants the load varied.
    """
    tables = [path for path in paths if path.suffix.lower() in _TABLES and not path.is_dir()]
    picture = picture or default_output(paths[0].with_suffix(".png"))
    if tables and len(paths) > 1:
        raise UsageError(f"{tables[0]}: a table is drawn alone; only recordings are compared")
    if tables:
        if panels or band:
            raise UsageError("--panel and --band are for recordings; a table has --quantity")
        if over == "time":
            raise UsageError("--over time is for recordings; a sweep is drawn over what was varied, or --over load")
        write = _of_table(tables[0], over, quantities)
    else:
        if quantities:
            raise UsageError("--quantity is for tables of sweeps; a recording has --panel")
        if over == "load" and (panels or band):
            raise UsageError("--panel and --band go with a picture over time")
        write = _of_recordings(paths, over, panels, band)
    with picture.draft() as draft:
        write(draft)
    return Result({}, files=[picture.path])


def _of_recordings(paths, over, panels, band):
    """Return what draws recordings into a file."""
    from bearing_sim.recording.reader import Recording
    from bearing_sim.scene.loader import did_you_mean
    from bearing_sim.studies.run_plot import DEFAULT_PANELS, PANELS, SlipBand, plot_over_load, plot_over_time, read_course

    for panel in panels:
        if panel not in PANELS:
            raise UsageError(f"--panel {panel}: no such panel{did_you_mean(panel, PANELS)}; there are {', '.join(PANELS)}")
    courses = []
    for path in paths:
        recording = Recording(path, allow_partial=True)
        with progress_bar(f"reading {path.name}", max(recording.last_time, 1e-9)) as progress:
            course = read_course(recording, path.name, panels or DEFAULT_PANELS, progress)
        tell_use(recording.tally, path)
        if band:
            course.band = SlipBand(*_band_of(course, band))
        courses.append(course)
    simulated: dict[str, list[str]] = {}
    for course in courses:
        simulated.setdefault(f"{course.scene.name} at level {course.scene.level}", []).append(course.name)
    title = "; ".join(f"{scene}: {', '.join(names)}" for scene, names in simulated.items())
    return lambda draft: (plot_over_load if over == "load" else plot_over_time)(draft, courses, title)


def _band_of(course, samples):
    """Return instants, low and high ends of the settled slip's range under the inputs of a run, where the shaft turns."""
    import numpy as np

    from bearing_sim.cli.uncertainty import SEED
    from bearing_sim.model.turning import stands_text, turns
    from bearing_sim.scene.uncertainty import without_range
    from bearing_sim.studies.uncertainty_propagation import rounded_up, study
    from bearing_sim.sweep.tasks import Execution

    times, conditions, scene = course.conditions[:, 0], course.conditions[:, 1:], course.scene
    turning = turns(conditions[:, 0], scene.thresholds.slip_from_speed)
    if not turning.any():
        raise UsageError(f"{course.name}: {stands_text(scene.thresholds.slip_from_speed)}, so there is no range of its slip; leave out --band")
    times, conditions = times[turning], conditions[turning]
    if np.all(conditions[:, 3] == scene.lubricant.temperature):
        conditions[:, 3] = math.nan  # the scene's own, which may be uncertain
    else:
        scene = without_range(scene, "lubricant.temperature")
    _, first, which = np.unique(np.nan_to_num(conditions, nan=-1.0), axis=0, return_index=True, return_inverse=True)
    different = conditions[first]
    base = rounded_up(samples)
    with Points(f"range of the slip of {course.name}", 2 * base) as points:
        given = different, np.ones(len(different))
        bands = study(scene, base, SEED, shares=False, course=given, execution=Execution(progress=points.update)).slip_bands()
    low, high = (np.array([getattr(each, end) for each in bands])[which.ravel()] for end in ("low", "high"))
    return times, low, high


def _of_table(path, over, quantities):
    """Return what draws a table into a file."""
    from bearing_sim.sweep.pictures import plot_table
    from bearing_sim.sweep.table import read_any_table, written_by_us

    with as_usage_error(ValueError), written_by_us(path):
        table = read_any_table(path)
        if over == "load":
            if quantities:
                raise UsageError("--quantity does not go with --over load, which draws slip and life")
            return _over_load(path, table)
    if not table.about:
        raise UsageError(f"{path}: there is no .parquet beside it, so what was varied is not known; give --over load, or the .parquet")
    if "axes" not in table.about:
        kind = table.about.get("kind", "unknown")
        raise UsageError(f"{path}: the table of another study ({kind}), not of a sweep; `bearing-sim report` shows it")

    def plot_sweep(draft):
        with as_usage_error(ValueError), written_by_us(path):
            plot_table(draft, table, quantities)

    return plot_sweep


_LOAD, _SPEED = "operating.radial_load", "operating.shaft_speed"


def _over_load(path, table):
    """Return what draws slip and life of a table over its column of loads into a file."""
    from bearing_sim.scene.display import heading
    from bearing_sim.scene.loader import SceneError, scene_from_yaml
    from bearing_sim.studies.run_plot import plot_table_over_load
    from bearing_sim.sweep.pictures import condition_title, value_text
    from bearing_sim.sweep.table import life_column

    columns, life = {column.name: column for column in table.columns}, life_column(table)
    missing = [name for name in (_LOAD, "cage_slip", "rating_life") if name not in columns]
    if missing:
        raise UsageError(f"{path}: no column {missing[0]}; vary the load with --vary {_LOAD}=0.5kN:20kN:9")
    scene, text = None, table.about.get("scene_of_first_point", "")
    try:
        scene = scene_from_yaml(text) if text else None
    except SceneError as error:
        note(f"{path}: its scene is of another version, so there is no minimum load: {str(error).splitlines()[0]}")
    if not text:
        note(f"{path}: a CSV table has no scene, so there is no minimum load; draw the .parquet")
    operating = scene.operating.shaft_speed * 30 / math.pi if scene is not None else math.nan
    results = {"cage_slip", life}
    varied = [axis["field"] for axis in table.about.get("axes", ()) if axis["field"] != _LOAD and len(axis["values"]) > 1]
    if not table.about:
        varied = [name for name in columns if "." in name and name != _LOAD and name not in results]
    points = [
        {
            "load": float(row[_LOAD]) * (1e3 if columns[_LOAD].unit == "kN" else 1.0),
            "slip": float(row["cage_slip"]),
            "life": float(row[life]),
            "speed": float(row.get(_SPEED, operating)),
            "family": ", ".join(value_text(name, columns[name].unit, row[name]) for name in varied),
        }
        for row in table.rows
        if all(isinstance(row[name], (int, float)) for name in (_LOAD, "cage_slip", life))
    ]
    about = table.about
    where = condition_title(about) if "scene" in about else path.name
    return lambda draft: plot_table_over_load(draft, points, scene, where, heading(life))


@command("report")
@click.argument("source", metavar="RESULT")
@option("-o", "--out", "The page [default: RESULT.html, or report.html in a folder].", OutputFile(".html", ".htm"), metavar="PATH.html")
def report(source, out):
    """Make one page of RESULT: scene and bearing, tables, pictures, warnings, where it comes from, and the command that made it.

    RESULT is a table written by `sweep`, `design` or `study` (.parquet, or the .csv beside it), a recording written by `run` or `replay`
    (.mcap, or a bag's folder), or a folder of such files. The page is self-contained: it
    needs no network and no other file.
    """
    from bearing_sim.studies.report_page import page_of

    result = Path(source)
    if source == "validation" and not result.exists():
        raise UsageError("report validation is no longer part of the program; from a checkout of the repository: python test/validation report")
    out = out or default_output(result / "report.html" if result.is_dir() else result.with_suffix(".html"))
    page = page_of(result, tell_use)
    out.write_text(page)
    return Result({}, remarks=[f"{out}: {len(page.encode()) / 1e6:.1f} MB"])
