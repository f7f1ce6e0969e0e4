# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim replay-fleet``: run the model on many logs, one bearing each, into one table."""

from collections import Counter
from pathlib import Path

import click

from bearing_sim.cli.options import (
    PATH,
    allow_outside_option,
    executor_options,
    json_option,
    log_options,
    option,
    set_option,
    table_option,
)
from bearing_sim.cli.reporting import (
    FailedRun,
    PartlyUsed,
    Points,
    UsageError,
    announce_compilation,
    print_points,
)
from bearing_sim.cli.results import Result, command, resumed, signed

_SHOWN = ("bearing", "running_hours", "revolutions", "slip_mean", "slip_p95", "slip_maximum", "above_slip_warning", "damage", "life", "status")


@command("replay-fleet")
@click.argument("paths", type=PATH, nargs=-1, metavar="[LOGS]...")
@allow_outside_option
@option("--scene", "scene_name", "Bundled scene or YAML file of every bearing that --bearings does not give another.", metavar="SCENE")
@set_option
@option("--bearings", "bearings_path", "Which log is of which bearing, see above.", PATH, metavar="TABLE.csv")
@option("--mapping", "mapping_name", "Which columns of tables are what, as for import-csv.", metavar="MAPPING")
@option("--by", "Tables hold several machines, which differ in this column.", metavar="COLUMN")
@log_options
@table_option("fleet.parquet", "Results; also written: PATH.csv and")
@executor_options
@json_option
def replay_fleet(paths, scene_name, overrides, bearings_path, mapping_name, by, reading, out, workers, dask):
    """Run the model on many LOGS at once, one bearing each, and write one table: hours, revolutions, slip, life used, warnings.

    LOGS are recordings (MCAP, SQLite, bags) and measured tables (CSV, Parquet), or folders that are searched for them. Tables need a
    --mapping. One table or Parquet data set of many machines is divided by a column with --by.

    --bearings is a table (CSV or Parquet) with the column log, by name or path, and, where bearings differ, serial, scene, mapping, fields of the
    scene such as lubricant.temperature, and fields of the mapping such as mapping.radial_load.pitch_diameter. Without LOGS, its logs are paths
    relative to it.

    A log that cannot be used is a row that says why; the others are computed. An interrupted run resumes with the same command; what was
    computed by an earlier one into the same table is not computed again. The exit code is 1 if some logs have no result, and 3 if
    only a part of some was used.

    bearing-sim replay-fleet scada/ --mapping scada.yaml --scene high_speed_shaft.yaml -o fleet.parquet
    """
    from bearing_sim.cli.estimation import response_with_progress
    from bearing_sim.cli.table import build_with_progress
    from bearing_sim.studies.fleet import OK, PARTLY, replay_fleet
    from bearing_sim.studies.fleet_logs import bearings_of, find_logs, read_bearings
    from bearing_sim.sweep.table import study_digest, write_table
    from bearing_sim.sweep.tasks import Execution

    if not paths and bearings_path is None:
        raise UsageError("no logs; give files or folders, or --bearings TABLE.csv")
    if scene_name is None and bearings_path is None:
        raise UsageError("no bearing; give --scene, or --bearings TABLE.csv with a column scene")
    reading = _reading(mapping_name, reading)
    asked = [str(path.absolute()) for path in (*paths, *([bearings_path] if bearings_path is not None else []))]
    rows = read_bearings(bearings_path) if bearings_path is not None else []
    if not paths:
        rows = [row | {"log": str(bearings_path.parent / row["log"])} for row in rows]
        paths = list(dict.fromkeys(path for row in rows if (path := Path(row["log"])).exists()))
    results = tuple(out.path.with_suffix(suffix) for suffix in (".parquet", ".csv", ".journal"))
    known = (*results, *([bearings_path] if bearings_path is not None else []))
    logs = find_logs([path.absolute() for path in paths], by, known) if paths else []
    rows = [row | {"log": str(Path(row["log"]).absolute()) if Path(row["log"]).exists() else row["log"]} for row in rows]
    bearings = bearings_of(logs, rows, scene_name, overrides, reading, str(bearings_path or ""))
    _require_a_scene(bearings)
    study = study_digest("fleet", asked, sorted({repr(bearing.scene) for bearing in bearings}), by, reading)
    announce_compilation()
    reading_bar, replay_bar = Points("reading", len(bearings)), Points("replay", len(bearings))
    bars = {"reading": reading_bar, "replay": replay_bar}
    with resumed(out, study, reading_bar, replay_bar) as journal:
        table = replay_fleet(
            bearings,
            Execution(journal, workers, dask),
            lambda act, *counts: bars[act].update(*counts),
            build_with_progress,
            response_with_progress,
        )
    files = write_table(out.path, signed(table, study))
    report, ending = _report(table, replay_bar, files), None
    if without := [row for row in table.rows if row["status"] not in (OK, PARTLY)]:
        ending = FailedRun(f"{len(without)} of {len(table.rows)} bearings have no complete result; {files[1]} says why (columns status, reason)")
    elif partly := report["partly_used_bearings"]:
        ending = PartlyUsed(f"of the logs of {partly} bearings only a part was used; {files[1]} says why (columns status, reason)")
    return Result(
        report | {"bearings": table.rows},
        lambda: _print(table),
        remarks=[f"{replay_bar.computed} replays computed, {replay_bar.kept} kept from before"],
        files=files,
        warnings=report["warnings"],
        ending=ending,
    )


def _reading(mapping_name, given):
    """Return how logs are read, from the options; raise `UsageError` if the mapping is invalid."""
    from bearing_sim.scene.loader import read_named
    from bearing_sim.studies.fleet_logs import Reading, mapping_of

    overrides = tuple(f"{name}={_constant_field(name, value)}" for name, value in given.constants.items())
    text = read_named(mapping_name, "catalog/mappings", "mapping")[0] if mapping_name else ""
    reading = Reading(text, overrides, mapping_name or "", given)
    if mapping_name:
        mapping_of(reading)
    return reading


def _constant_field(channel: str, value: float) -> str:
    """Return what stands in a mapping for a channel that is constant [SI], as YAML."""
    if channel == "radial_load":
        return f"{{law: constant, value: {value!r} N}}"
    return f"{{constant: {value!r} {'rad/s' if channel == 'shaft_speed' else 'K'}}}"


def _require_a_scene(bearings) -> None:
    """Raise `UsageError` if no bearing at all has a valid scene and mapping: then it is no matter of single logs."""
    if all(isinstance(bearing.scene, ValueError) for bearing in bearings):
        raise UsageError(str(bearings[0].scene))


def _report(table, points, files) -> dict:
    from bearing_sim.model.validity import counted
    from bearing_sim.studies.fleet import STATUSES

    statuses = Counter(table.values("status"))
    return {
        "computed": points.computed,
        "kept_from_before": points.kept,
        **{f"{status.replace(' ', '_')}_bearings": statuses[status] for status in STATUSES},
        "running_hours": sum(hours for hours in table.values("running_hours") if hours == hours),
        "parquet": str(files[0]),
        "csv": str(files[1]),
        "warnings": counted(row["warnings"] for row in table.rows),
    }


def _print(table) -> None:
    worst_first = sorted(table.rows, key=lambda row: (row["status"] == "ok", -row["damage"] if row["damage"] == row["damage"] else 0.0))
    print_points(f"{len(table.rows)} bearings, most life used first", table, _SHOWN, worst_first)
