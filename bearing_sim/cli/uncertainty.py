# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim uncertainty``: bands of slip and life where nobody knows some fields, and which field they come from."""

import time
from pathlib import Path

import click

from bearing_sim.commands.reporting import (
    orderly_end,
    picture_option,
    print_json,
    print_table,
    require_levels,
    tell_compilation,
    told_as_bad_input,
    told_file_faults,
)
from bearing_sim.commands.sweeping import Points, executor_options

SEED = 2017


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene, or a range; may be repeated.")
@click.option(
    "--samples", default=256, show_default=True, type=click.IntRange(2, 65536), help="Of each of two samples; rounded up to a power of two."
)
@click.option("--seed", default=SEED, show_default=True, type=click.IntRange(0), help="Of the samples.")
@click.option("--level", metavar="LEVEL", help="Fidelity level [default: the cheapest that has all the scene asks for].")
@click.option("--log", type=click.Path(path_type=Path), metavar="IN.mcap", help="Bands over the course of speed and load in a log.")
@click.option("--stretches", default=24, show_default=True, type=click.IntRange(1, 10_000), help="Into how many the course of the log is cut.")
@executor_options
@click.option(
    "--csv",
    "table",
    type=click.Path(path_type=Path),
    metavar="PATH.csv",
    help="Write every point; beside it PATH.journal, from which it goes on after a kill.",
)
@picture_option("Draw bands and shares")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, overrides, samples, seed, level, log, stretches, workers, dask, table, picture, as_json):
    """Tell what slip and life of SCENE may be (5, 50 and 95 %), its uncertain fields drawn from the ranges in its block `uncertainty`.

    With N samples and d ranges the bearing is computed N (d + 2) times; Sobol' indices say which field the spread comes from.
    Other ranges: --set "uncertainty.lubricant.temperature=[90 degC, 130 degC]"; none for a field: --set uncertainty.FIELD=null.
    """
    from bearing_sim.scene_file import SceneError, load_scene
    from bearing_sim.sweep.journal import Journal, JournalInUse

    require_levels([level] if level is not None else ())
    with told_as_bad_input(SceneError):
        scene = load_scene(scene_name, overrides)
    scene, course = _course(log, scene, stretches) if log is not None else (scene, None)
    with told_file_faults(), orderly_end(), told_as_bad_input(JournalInUse):
        with Journal(table and table.with_suffix(".journal")) as journal:
            found, report = bands_of(scene, samples, seed, level, course, journal, workers, dask)
    with told_file_faults():
        if table is not None:
            _write(table, found)
        if picture is not None:
            from bearing_sim.studies.uncertainty_picture import draw

            ranges = f"{len(found.ranges)} uncertain fields, {found.design.base} samples, level {found.level}"
            draw(picture, f"{scene.name}{'' if log is None else f' under {log.name}'}: {ranges}", found, course and course.middles)
    if as_json:
        print_json({"scene": scene.name, "log": log and log.name, **report})
    else:
        print_bands(scene.name if log is None else f"{scene.name} under {log.name}", report)


def bands_of(scene, samples, seed=SEED, level=None, course=None, journal=None, workers=None, dask=None):
    """Return a study of a scene's uncertainty and its report as plain numbers; tells on stderr what it does.

    Parameters
    ----------
    scene : with ranges.
    samples : rounded up to a power of two.
    seed, level, journal, workers, dask : as of `bearing_sim.studies.uncertainty.study`.
    course : `bearing_sim.studies.course_stretches.Stretches`, or None.
    """
    tell_compilation()
    from bearing_sim.studies.uncertainty import UncertaintyError, study
    from bearing_sim.sweep.executor import ClusterError

    base = 1 << (samples - 1).bit_length()
    began, given = time.perf_counter(), (course.conditions, course.seconds) if course is not None else None
    with (
        Points(f"uncertainty of {scene.name}", base * (len(scene.uncertainty) + 2)) as points,
        told_as_bad_input(UncertaintyError, ClusterError, ValueError),
    ):
        found = study(scene, base, seed, level=level, course=given, journal=journal, workers=workers, dask=dask, tell=points.tell)
    return found, {**_report(found, seed, time.perf_counter() - began, course), "kept_from_before": points.kept}


def _course(log, scene, count):
    """Return the scene, without a range of what the log says itself, and the log's course in stretches."""
    import dataclasses
    import math

    import numpy as np

    from bearing_sim.input_course import judge
    from bearing_sim.input_log import InputLogError, read_input_log
    from bearing_sim.simulation import Inputs
    from bearing_sim.studies.course_stretches import stretches

    with told_as_bad_input(InputLogError), told_file_faults():
        course = judge(read_input_log(log), scene.input_limits, Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature))
    kelvin = math.nan  # the scene's own, which may be uncertain
    if "oil_temperature" in course.stamps and any(one.field == "lubricant.temperature" for one in scene.uncertainty):
        click.echo("the log says the oil temperature: its range in the scene goes unused", err=True)
        scene = dataclasses.replace(scene, uncertainty=tuple(one for one in scene.uncertainty if one.field != "lubricant.temperature"))
    in_gap = np.zeros(len(course.instants), bool)
    for begin, end in course.gaps:
        in_gap |= (course.instants > begin) & (course.instants <= end)
    return scene, stretches(course.instants * 1e-9, course.at(course.instants, kelvin), in_gap, count)


def _report(found, seed, seconds, course) -> dict:
    fields = [one.field for one in found.ranges]
    report = {
        "level": found.level,
        "level_reason": found.reason,
        "samples": found.design.base,
        "seed": seed,
        "evaluations": len(found.design.points),
        "without_answer": found.absent,
        "wall_seconds": seconds,
        "ranges": {
            one.field: {"low": one.low, "high": one.high, "distribution": one.distribution, "mode": one.mode, "source": one.source}
            for one in found.ranges
        },
    }
    for name, band in found.bands.items():
        shares = found.indices[name]
        report[name] = {
            "own": found.own[name],
            "p05": band.low,
            "p50": band.middle,
            "p95": band.high,
            "p05_interval": band.low_error,
            "p50_interval": band.middle_error,
            "p95_interval": band.high_error,
            "shares": shares
            and {
                field: {
                    "first_order": float(shares.first[k]),
                    "first_order_interval": shares.first_error[k].tolist(),
                    "total": float(shares.total[k]),
                    "total_interval": shares.total_error[k].tolist(),
                }
                for k, field in enumerate(fields)
            },
        }
    if course is not None:
        report["course"] = [
            {"time": moment, "seconds": length, "p05": band.low, "p50": band.middle, "p95": band.high}
            for moment, length, band in zip(course.middles.tolist(), course.seconds.tolist(), found.slip_bands())
        ]
    return report


def band_rows(report) -> list[tuple[str, str]]:
    """Return rows of a table: the bands, with their sampling errors, and the fields they come from, the most important first."""
    rows = []
    for name, label, scale, unit in (("cage_slip", "cage slip", 100.0, "%"), ("life_hours", "life", 1.0, "h")):
        one = report[name]

        def told(key, one=one, scale=scale):
            low, high = (scale * end for end in one[f"{key}_interval"])
            return f"{scale * one[key]:.4g} ({low:.4g} to {high:.4g})"

        rows.append(
            (f"{label}: 5, 50, 95 % below", f"{told('p05')}, {told('p50')}, {told('p95')} {unit}; at the scene's own values {scale * one['own']:.4g}")
        )
        rows.append((f"{label} varies by", _shares(one["shares"])))
    return rows


def _shares(shares) -> str:
    import math

    if shares is None:
        return "not known: it is not finite at every point"
    known = [item for item in shares.items() if math.isfinite(item[1]["total"])]
    if not known:
        return "nothing: it is the same at every point"
    known.sort(key=lambda item: -item[1]["total"])
    return "\n".join(
        f"{field}: {_percent(one['first_order'])} % by itself ({' to '.join(map(_percent, one['first_order_interval']))}), "
        f"{_percent(one['total'])} % in all ({' to '.join(map(_percent, one['total_interval']))})"
        for field, one in known
    )


def _percent(share: float) -> str:
    return str(round(100 * share))


def print_bands(name, report) -> None:
    """Print a report as a table."""
    from bearing_sim.scene import Scene
    from bearing_sim.scene_uncertainty import quantities

    known = quantities(Scene)
    ranges = [
        f"{field}: {known[field].show(one['low'])} to {known[field].show(one['high'])}, {one['distribution']}"
        + (f" ({one['source']})" if one["source"] else "")
        for field, one in report["ranges"].items()
    ]
    kept = f", {report['kept_from_before']} of them kept from before" if report["kept_from_before"] else ""
    print_table(
        f"what {name} may do",
        [
            ("uncertain", "\n".join(ranges)),
            *band_rows(report),
            ("in parentheses", "95 % intervals of the sampling error; more --samples narrow them"),
            (
                "computed",
                f"{report['evaluations']} times ({report['samples']} samples, seed {report['seed']}) in {report['wall_seconds']:.3g} s{kept}",
            ),
            ("without an answer", str(report["without_answer"])),
            ("level", report["level_reason"]),
        ],
    )


def _write(path, found) -> None:
    import csv

    from bearing_sim.scene import Scene
    from bearing_sim.scene_uncertainty import quantities

    known = quantities(Scene)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([f"{one.field} [{known[one.field].unit or '1'}]" for one in found.ranges] + ["cage_slip [1]", "life [h]"])
        for point, slip, life in zip(found.design.points.tolist(), found.answers["cage_slip"].tolist(), found.answers["life_hours"].tolist()):
            writer.writerow([*point, slip, life])
