# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim trade``: what accuracy costs on a scene, on a built-in course or on a log."""

import math
from pathlib import Path

import click
from click import FloatRange, IntRange

from bearing_sim.cli.options import (
    csv_option,
    json_option,
    level_type,
    log_options,
    option,
    picture_option,
    quick_option,
    scene_options,
)
from bearing_sim.cli.outputs import OutputFile, OutputJournal
from bearing_sim.cli.reporting import (
    FailedRun,
    Points,
    UsageError,
    announce_compilation,
    as_usage_error,
    judged,
    note,
    print_rows,
    scene_of,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.quantity import in_digits

_COURSES = ("manoeuvre", "run_down", "start", "idle")
_ERRORS = {
    "slip": "slip_error_points",
    "largest_slip": "largest_slip_error_points",
    "load": "load_error",
    "largest_load": "largest_load_error",
    "life": "life_error",
    "window_life": "largest_window_life_error",
    "edge": "edge_error",
    "largest_edge": "largest_edge_error",
}
"""Column of each error by its name in `bearing_sim.studies.trade.Errors`."""
_FASTER, _CLOSER = (1.0, 3.0, 10.0, 100.0, 1000.0), (0.01, 0.1, 1.0)


@command("trade")
@scene_options
@option("--level", "levels", "Measure this level; can be repeated [default: all].", level_type, multiple=True)
@option("--against", "Level of the reference [default: planar, or the highest that can compute the scene].", level_type)
@option(
    "--course",
    "course_name",
    f"What to measure on: {', '.join(_COURSES)}, or a log: a recording as `replay` takes it, or a table with --mapping.",
    default=_COURSES[0],
    metavar="COURSE",
)
@option("--mapping", "mapping_name", "Of a table: which columns are what, as for import-csv.", metavar="MAPPING")
@option("--windows", "Windows of a log that are measured.", IntRange(1, 1000), default=12, metavar="K")
@option("--window-turns", "Cage turns of a window of a log.", FloatRange(6.0, 1e5), default=60.0, metavar="N")
@log_options
@option("--factor", "Recommend the most accurate setting at this multiple of real time.", FloatRange(min=0.0, min_open=True))
@option("--error", "Recommend the fastest setting with at most this error of slip [percentage points].", FloatRange(min=0.0, min_open=True))
@option("--journal", "File from which an interrupted trade resumes.", OutputJournal(), metavar="PATH")
@option("--workers", "Number of processes [default: all cores].", IntRange(1, 1024), metavar="N")
@option(
    "--keep/--no-keep",
    "Keep the settings for this bearing and machine, for `level: auto` and the node's governor; --quick keeps nothing.",
    default=True,
)
@option("--front", "Add what is measured to this front file, for `front: PATH` in a scene with level: auto.", OutputJournal(), metavar="PATH")
@option(
    "--chosen",
    "Write level, tolerances, step and slices of the recommended setting as fields of a scene file; without --factor and --error of the fastest "
    "that keeps the errors in wants.",
    OutputFile(".yaml", ".yml"),
    metavar="PATH",
)
@csv_option("Write all settings to a table.")
@picture_option("Draw error against speed")
@json_option
@quick_option
def trade(
    scene_name,
    overrides,
    levels,
    against,
    course_name,
    mapping_name,
    windows,
    window_turns,
    reading,
    factor,
    error,
    journal,
    workers,
    keep,
    front,
    chosen,
    quick,
):
    """Measure real-time factor and errors in slip, largest roller load and life of every level and tolerance or step on SCENE.

    All settings run the same course and are compared with a reference at tight tolerances. The built-in courses start from the scene's
    conditions: manoeuvre (the load is halved and restored, the shaft slowed by a fifth), run_down (to a tenth of the speed), start (from a
    creeping 3 % to full speed) and idle (light load halved and restored, the speed raised by a fifth). Of a log, windows of the same number of
    cage turns are measured, evenly spread over the time during which the shaft turns; the first third of each is ignored. Times are processor
    time of one core; other programs still slow down shared memory. --workers 1 disturbs them least.
    """
    from bearing_sim.simulation import IntegrationError

    overrides = [*overrides, "front=null"]  # a front that is to be written need not be there yet
    scene = scene_of(scene_name, overrides)  # fails before anything is compiled
    is_asked = factor is not None or error is not None
    _require_use(scene, front, chosen, is_asked, quick)
    from bearing_sim.studies.trade import able_levels, has_all, plot_trade, recommend, trade

    if front is not None and against and not has_all(against, able_levels(scene_name, overrides)[1]):
        raise UsageError(f"--front {front}: {_why_incomplete(against)}")
    course = _course(course_name, scene, mapping_name, reading, windows, window_turns, quick)
    announce_compilation()
    with Points("trade", 0) as points, as_usage_error(ValueError):
        try:
            found = trade(scene_name, overrides, levels, quick, points.update, against, course, journal and journal.path, workers)
        except IntegrationError as failure:
            raise FailedRun(f"the reference failed: {failure}") from None
    kept = _keep(scene, found) if keep and not quick else None
    best = recommend(found, factor, error) if is_asked else None
    written, remarks, ending = None, [], None
    try:
        if front is not None:
            written = _add_to_front(front.path, scene, found)
            remarks += [f"added to {front} ({_courses_in(written)})"]
        if chosen is not None:
            remarks += [_write_chosen(chosen, scene, scene_name, found, best, is_asked)]
    except FailedRun as failure:  # what was measured is printed nevertheless
        ending = failure

    def show():
        print_trade(scene_name, found)
        if kept is not None:
            click.echo(f"kept for this bearing and machine ({_courses_in(kept)}): {kept.path}")
        _print_advice(found, factor, error, best)

    report = _report(found) | {"recommended": best and best.setting.name, "kept": kept and str(kept.path), "front": written and str(front)}
    return Result(report, show, lambda draft: plot_trade(draft, scene_name, found), rows_of(found), remarks, ending=ending)


def _require_use(scene, front, chosen, is_asked, quick) -> None:
    """Refuse, before anything is measured, a front that cannot be written and a choice by nothing."""
    if front is not None and quick:
        raise UsageError("--front: --quick measures too little for a front; leave one of them out")
    if front is not None:
        from bearing_sim.scene.measured_tradeoffs import front_to_extend

        try:
            front_to_extend(front.path, scene)
        except ValueError as reason:
            raise UsageError(f"--front {front}: {reason}") from None
    if chosen is not None and not (is_asked or scene.wanted_errors):
        raise UsageError("--chosen: nothing says what to choose by; give --factor, --error, or errors in the scene's wants")


def _courses_in(front) -> str:
    return ", ".join(dict.fromkeys(course.name for course in front.courses))


def _why_incomplete(level: str) -> str:
    return f"errors against level {level} say nothing of what it leaves out; leave out --against, or give planar"


def _keep(scene, found):
    """Keep the settings of a trade for later; return what is kept for the bearing, or None where that cannot be or says nothing."""
    from bearing_sim.scene.measured_tradeoffs import keep
    from bearing_sim.studies.trade import measured_course

    if not found.is_complete:
        note(f"not kept: {_why_incomplete(found.reference_level)}")
        return None
    try:
        return keep(scene, measured_course(found))
    except OSError as failure:
        note(f"warning: the settings are not kept: {failure}")
        return None


def _add_to_front(path: Path, scene, found):
    """Add the settings of a trade to a front file; return what it holds then, or raise `FailedRun`."""
    from bearing_sim.scene.measured_tradeoffs import add_to_front
    from bearing_sim.studies.trade import measured_course

    try:
        return add_to_front(path, scene, measured_course(found))
    except (ValueError, OSError) as failure:
        raise FailedRun(f"{path} is not written: {failure}") from None


def _write_chosen(out, scene, name: str, found, best, is_asked: bool) -> str:
    """Write the fields of a scene file that choose the recommended setting, or the fastest that keeps the errors in wants; say so."""
    from bearing_sim.scene.loader import fields_to_yaml
    from bearing_sim.scene.measured_tradeoffs import Tradeoffs
    from bearing_sim.scene.overrides import read_override
    from bearing_sim.scene.requirements import candidates
    from bearing_sim.scene.tree import changed
    from bearing_sim.studies.trade import measured_course

    course = measured_course(found)
    if is_asked:
        fitting = [one for one in course.settings if best is not None and (one.level, one.detail) == best.setting[:2]]
    else:
        fitting = candidates(scene, {each.want: each.error for each in scene.wanted_errors}, Tradeoffs(out.path, (course,)))
    setting = next(iter(fitting), None)
    if setting is None:
        raise FailedRun(f"{out} is not written: no setting is that fast and that accurate")
    fields = {"level": setting.level}
    for override in setting.overrides:
        fields = changed(fields, *read_override(override))
    measured = f"slip {in_digits(setting.errors['slip'], 2)} points, life {in_digits(100 * setting.errors['life'], 2)} %"
    title = f"# {setting.name}, chosen for {name} by bearing-sim trade on {course.name}: errors against {course.reference}: {measured}.\n"
    note_of_use = "# Fields of a scene file; they replace level and these fields there.\n"
    out.write_text(title + note_of_use + fields_to_yaml(fields))
    return f"{out} has the fields of {setting.name}"


def _course(name, scene, mapping_name, reading, windows, window_turns, quick):
    """Return what `bearing_sim.studies.trade.trade` takes as the course: a name, or a function of the scene."""
    if name in _COURSES:
        if mapping_name or reading.is_given or reading.longest_gap:
            raise UsageError(f"--course {name} is built in; --mapping and options that say where a log holds what go with a log")
        return name
    path = Path(name)
    if not path.exists():
        from bearing_sim.scene.errors import did_you_mean

        raise UsageError(f"--course {name}: no such file or built-in course{did_you_mean(name, _COURSES)}; built in: {', '.join(_COURSES)}")
    profile = judged(_read(path, mapping_name, reading), scene, reading.longest_gap)
    segment = profile.segment(None, scene.lubricant.temperature)
    times = segment.instants * 1e-9

    def windows_in(scene):
        from bearing_sim.studies.trade_course import windows_of

        return windows_of(path.name, scene, times, segment.inputs, segment.in_gap, 1 if quick else windows, window_turns)

    with as_usage_error(ValueError):
        windows_in(scene)  # before anything is compiled
    return windows_in


def _read(path, mapping_name, reading):
    """Return the input log of a recording or, with a mapping, of a table."""
    from bearing_sim.inputs.csv_import import input_log, load_mapping, read_table

    if mapping_name:
        if reading.is_given:
            raise UsageError("--mapping says what the columns are; give constants there, and leave out the options for topics")
        return input_log(read_table(path, load_mapping(mapping_name)[0]), path)
    from bearing_sim.studies.fleet_logs import is_text

    if path.is_file() and is_text(path):
        hint = f"propose one with: bearing-sim import-csv --guess {path} -o mapping.yaml"
        raise UsageError(f"--course {path} is a table, which needs a mapping that says which columns are what (--mapping): {hint}")
    return reading.read(path)


def rows_of(found) -> list[dict]:
    """Return a row for each setting of a trade: level, setting, real-time factor, errors, whether it is on the front, and why it failed."""
    return [
        {"level": one.setting.level, "setting": one.setting.detail, "real_time_factor": one.real_time_factor}
        | {column: getattr(one.errors, name) for name, column in _ERRORS.items()}
        | {"on_front": k in found.front, "failure": one.failure}
        for k, one in enumerate(found.measured)
    ]


def _report(found) -> dict:
    course = found.course
    return {
        "reference": found.reference,
        "reference_error": {column: getattr(found.own_error, name) for name, column in _ERRORS.items()},
        "course": course.name,
        "windows": [{"begin_seconds": window.begin, "seconds": window.seconds, "ignored_seconds": window.settling} for window in course.windows],
        "simulated_seconds": found.simulated,
        "turning_seconds": course.turning,
        "log_seconds": course.log_seconds,
        "range": course.extent(),
        "left_out": found.left_out,
        "settings": rows_of(found),
    }


def measured_in_words(course) -> str:
    """Return how much of a course was measured."""
    if not course.is_log:
        return f"over {course.measured:.3g} s"
    ignored, lengths = sum(window.settling for window in course.windows), [window.seconds for window in course.windows]
    return (
        f"over {len(course.windows)} windows of {min(lengths):.3g} to {max(lengths):.3g} s: {course.measured:.3g} s of the {course.turning:.5g} s "
        f"({100 * course.measured / course.turning:.2g} %) during which the shaft turns, in a log of {course.log_seconds:.5g} s; {ignored:.3g} s "
        "of it ignored as settling"
    )


def print_trade(name, found) -> None:
    """Print all settings of a trade of a scene, the errors of the reference, and what was not measured."""
    rows, has_edges = [], any(not math.isnan(one.errors.edge) for one in found.measured)
    for row in sorted(rows_of(found), key=lambda row: (math.isnan(row["real_time_factor"]), -row["real_time_factor"])):  # failed ones last
        points = (_unless_nan(row[column], "{:.3f}".format) for column in ("slip_error_points", "largest_slip_error_points"))
        percents = ("load_error", "life_error", "largest_window_life_error", *(("edge_error",) if has_edges else ()))
        values = _unless_nan(row["real_time_factor"], in_digits, 3), *points, *(_unless_nan(100 * row[column], in_digits, 2) for column in percents)
        rows.append(("*" if row["on_front"] else "", row["level"], row["setting"], *values, row["failure"]))
    numbers = ["times real time", "slip error [points]", "largest slip error [points]", "load error [%]", "life error [%]"]
    numbers += ["largest life error of a window [%]", *(["edge load error [%]"] if has_edges else [])]
    columns, words = ("best", "level", "setting", *numbers, "failure"), ("best", "level", "setting", "failure")
    print_rows(f"{name}, {found.course.name}: errors against {found.reference}", columns, rows, words, keys=3)
    click.echo(measured_in_words(found.course))
    own = found.own_error
    click.echo(
        f"* no setting is both faster and more accurate in slip; error of the reference {own.slip:.2g} points, {100 * own.load:.2g} %, "
        f"{100 * own.life:.2g} %"
    )
    for level, reason in found.left_out.items():
        click.echo(f"not measured: {level} ({reason})")


def _unless_nan(value, written, *digits) -> str:
    return "-" if math.isnan(value) else written(value, *digits)


def _print_advice(found, factor, error, best) -> None:
    from bearing_sim.studies.trade import recommend

    if factor is not None or error is not None:
        click.echo(f"recommended: {_recommendation(best)}" if best else "no setting is that fast and that accurate")
        return
    for factor in _FASTER:
        click.echo(f"for {factor:g} x real time: {_recommendation(recommend(found, factor=factor))}")
    for error in _CLOSER:
        click.echo(f"for {error:g} points of slip: {_recommendation(recommend(found, error=error))}")


def _recommendation(one) -> str:
    if one is None:
        return "none"
    options = " ".join(f'--set "{item}"' for item in (f"level={one.setting.level}", *one.setting.overrides))
    return f"{one.setting.name} ({in_digits(one.real_time_factor, 3)} x real time, {one.errors.slip:.2g} points): {options}"
