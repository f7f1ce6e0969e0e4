# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim spectrum``: the life under a load spectrum, from a table of operating points or from the classes of a long log."""

import math
import re

import click

from bearing_sim.cli.options import (
    PATH,
    SECONDS,
    executor_options,
    json_option,
    log_options,
    option,
    picture_option,
    scene_argument,
    set_option,
    table_option,
)
from bearing_sim.cli.reporting import (
    Points,
    UsageError,
    announce_compilation,
    judged,
    print_points,
    print_table,
    refuse_idle_temperature,
    scene_of,
    unknown_report,
    warn,
    warn_of_scene,
)
from bearing_sim.cli.results import Result, command, resumed, signed

_EQUILIBRIUM = "of thermal equilibrium at each point; while a bearing warms up, its oil is thicker and its life longer (bearing-sim replay)"
_MOST_CLASSES = 1000  # each that a log has time in is a run


def _counts(context, option, classes: str) -> tuple[int, int, int]:
    match = re.fullmatch(r"(\d{1,3})x(\d{1,3})(?:x(\d{1,3}))?", classes.strip().lower())
    counts = tuple(int(text or 1) for text in match.groups()) if match else (0, 0, 0)
    if not 1 <= math.prod(counts) <= _MOST_CLASSES:
        raise UsageError(
            f"--classes {classes}: expected numbers of classes of speed, load and oil temperature such as 8x8x2, {_MOST_CLASSES} at most"
        )
    return counts


@command("spectrum")
@scene_argument
@click.argument("data", type=PATH, metavar="TABLE.csv|LOG.mcap")
@set_option
@option("--level", "Level of fidelity, instead of the scene's.", metavar="LEVEL")
@option("--duration", "Shortest simulated time per point; extended until it has settled.", SECONDS, default="0.5 s")
@option("--classes", "Classes of speed, load and oil temperature of a log.", default="8x8x2", metavar="NxNxN", callback=_counts)
@log_options
@table_option("spectrum_life.parquet", "Points; also written: PATH.csv and")
@executor_options
@picture_option("Draw shares of time, loads and shares of damage")
@json_option
def spectrum(scene_name, data, overrides, level, duration, classes, reading, out, workers, dask):
    """Compute the life of SCENE under a load spectrum, with slip and share of damage at each point.

    TABLE.csv has a line for each operating point: its share of the time, or its hours, shaft speed and radial load and, optionally, axial
    load and temperatures of oil and, with heat.law given, of the rings; units in the headings, such as
    'Zeitanteil [%];Drehzahl [1/min];Radiallast [kN]'. Points at rest use no life.

    Instead of it, LOG.mcap is a recording as `bearing-sim replay` reads it, whose time is sorted into classes of speed, load and oil
    temperature; its options say what is where. Each point runs until it has settled, on all cores, so that a month takes no longer than a
    day; what happens between the points, and heat that builds up, only `bearing-sim replay` sees.

    Damage adds up by Palmgren and Miner. If a point has no result, no life is given. An interrupted command resumes.
    """
    from bearing_sim.studies import spectrum as studied
    from bearing_sim.studies.fleet_logs import is_text
    from bearing_sim.sweep.conditions import read_spectrum
    from bearing_sim.sweep.table import study_digest, write_table
    from bearing_sim.sweep.tasks import Execution

    profile = None
    scene = scene_of(scene_name, overrides, level)
    if is_text(data):
        if reading.is_given:
            raise UsageError(f"{data} is a table of operating points; --speed, --load and the other options of logs do not go with it")
        found = read_spectrum(data)
        if any(point.oil_temperature is not None for point in found.points):
            refuse_idle_temperature(scene, ["lubricant.temperature"])
    else:
        profile = judged(reading.read(data), scene, reading.longest_gap)
        found = studied.spectrum_of_log(profile, scene.lubricant.temperature, classes)
    warn_of_scene(scene)
    warn(found.notes)
    announce_compilation(scene)
    points, study = Points("spectrum", len(found.points)), study_digest("spectrum", scene, found, duration)
    with resumed(out, study, points) as journal:
        result = studied.evaluate(scene, found, duration, Execution(journal, workers, dask, points.update))
    result.table.about.update(signed(result.table, study).about, source=str(data))
    files = write_table(out.path, result.table)
    report = _report(scene, data, profile, result)
    return Result(
        report | {"points": result.table.rows},
        lambda: _print(scene, report, result),
        lambda draft: studied.plot_spectrum(draft, result.table),
        files=files,
        warnings=report["warnings"],
    )


def _report(scene, data, profile, result) -> dict:
    from bearing_sim.inputs.gate import covered
    from bearing_sim.model.validity import counted
    from bearing_sim.studies.design import life_name

    about = {} if profile is None else {**unknown_report(profile), "gap_seconds": covered(profile.gaps) * 1e-9}
    rows = result.table.rows
    return {
        "scene": scene.name,
        "level": scene.level,
        "spectrum": str(data),
        **about,
        "hours": result.hours,
        "life_name": life_name(scene),
        "life_hours": result.life,
        **{f"{name}_hours": result.lives[name] for name in ("l10", "lnm", "l10r", "lnmr")},
        "damage": result.hours / result.life if result.hours is not None else None,
        "mean_speed_rpm": result.mean_speed * 30.0 / math.pi,
        "mean_equivalent_load": result.mean_load,
        "static_safety": result.static_safety,
        "share_at_rest": result.resting,
        "share_of_skid": result.skid,
        "share_without_result": result.missing,
        "files": None,
        "warnings": counted(row["warnings"] for row in rows),
    }


def _print(scene, report, result) -> None:
    from bearing_sim.model.turning import span_text
    from bearing_sim.scene.display import force, hours, number
    from bearing_sim.studies.spectrum import by_damage

    rows = by_damage(result.table)
    axial = ["axial_load"] if any(row["axial_load"] for row in rows) else []
    names = ("share", "shaft_speed", "radial_load", *axial, "oil_temperature", "cage_slip", "modified_rating_life", "damage_share", "static_safety")
    print_points(f"{scene.name} at level {scene.level}: points, the most harmful first", result.table, (*names, "status"), rows, most=20)

    def lasting(share):
        """Return a share of the time in words, with its hours where the spectrum has any."""
        return f"{number(100.0 * share, 3)} % of the time" + (f", {span_text(3600.0 * share * result.hours)}" if result.hours is not None else "")

    if result.missing:
        life = f"not given: points without a result take {lasting(result.missing)}"
        further = []
    else:
        life = f"{hours(result.life)}: {report['life_name']}, by Palmgren and Miner"
        used = [("life used", f"{number(100.0 * report['damage'], 4)} % in {span_text(3600.0 * result.hours)}")] if result.hours is not None else []
        further = [
            *used,
            ("by ISO 281", f"L10 {hours(result.lives['l10'])}, L_nm {hours(result.lives['lnm'])}"),
            ("by ISO/TS 16281", f"L10r {hours(result.lives['l10r'])}, L_nmr {hours(result.lives['lnmr'])}"),
            (
                "mean values of ISO 281",
                f"P_m {force(result.mean_load)} at n_m {number(report['mean_speed_rpm'], 5)} rpm, exponent 10/3 over revolutions",
            ),
            ("least static safety", f"S_0 {number(result.static_safety, 3)}"),
        ]
    skid = f"slip above {number(100.0 * scene.thresholds.slip_warning, 3)} % under load"
    log = []
    if "gap_seconds" in report:
        log.append(("not known", f"{span_text(report['unknown_seconds'])} refused, {span_text(report['gap_seconds'])} in gaps"))
    print_table(
        f"load spectrum {report['spectrum']}",
        [
            ("life", life),
            *further,
            ("skid", f"{skid}: {lasting(result.skid)}" if result.skid else f"none: no {skid}"),
            ("at rest", lasting(result.resting)),
            *([("temperatures", _EQUILIBRIUM)] if scene.heat.law == "network" else []),
            *log,
        ],
    )
