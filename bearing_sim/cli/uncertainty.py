# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim uncertainty``: bands of slip and life where nobody knows some fields, and which field they come from."""

import time

from click import IntRange

from bearing_sim.cli.options import PATH, csv_option, executor_options, json_option, level_type, option, picture_option, scene_options
from bearing_sim.cli.outputs import OutputWithJournal
from bearing_sim.cli.reporting import (
    Points,
    announce_compilation,
    as_usage_error,
    attributes,
    judged,
    note,
    print_table,
    scene_of_point,
    unknown_report,
    write_csv,
)
from bearing_sim.cli.results import Result, command
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities, shown, without_dimensions, without_range

SEED = 2017


@command("uncertainty")
@scene_options
@option("--samples", "Size of each of the two samples; rounded up to a power of two.", IntRange(2, 65536), default=256)
@option("--seed", "Seed of the samples.", IntRange(0), default=SEED)
@option("--level", "Level of fidelity [default: the fastest that supports the scene].", level_type)
@option("--log", "Compute the ranges over time, for speed and load in a log.", PATH, metavar="IN.mcap")
@option("--stretches", "Number of intervals into which the log is divided.", IntRange(1, 10_000), default=24)
@executor_options
@csv_option("Write all points; also written: PATH.journal, from which an interrupted run resumes.", OutputWithJournal())
@picture_option("Draw ranges and shares")
@json_option
def uncertainty(scene_name, overrides, samples, seed, level, log, stretches, workers, dask, table):
    """Compute quantiles (5, 50 and 95 %) of slip and life of SCENE, with uncertain fields drawn from the ranges in its block `uncertainty`.

    With N samples and d ranges the bearing is computed N (d + 2) times; Sobol' indices show which fields the spread comes from.
    Fields of a catalogue bearing that are estimated take the ranges of their estimates, and what only an oil's name says takes that of its kind,
    unless the scene has another one for them.
    To change a range: --set "uncertainty.lubricant.temperature=[90 degC, 130 degC]"; to remove one: --set uncertainty.FIELD=null.
    """
    from bearing_sim.sweep.tasks import Journal

    scene = scene_of_point(scene_name, overrides, before_results=False)
    scene, course, unknown = _course(log, scene, stretches) if log is not None else (scene, None, {})
    from bearing_sim.studies.uncertainty_propagation import rounded_up
    from bearing_sim.sweep.table import note_points, same_points, study_digest

    conditions = course and (course.seconds.tolist(), course.conditions.tolist())
    digest = study_digest("uncertainty", scene, rounded_up(samples), seed, level, conditions)
    if table is not None:
        table = same_points(table, digest)
    with Journal(table and table.path.with_suffix(".journal")) as journal:
        found, report = bands_of(scene, samples, seed, level, course, journal, workers, dask)
        if table is not None:
            write_csv(table, _rows(found))
            note_points(journal, digest, table.path)
    name = scene.name if log is None else f"{scene.name} under {log.name}"

    def plot(draft):
        from bearing_sim.studies.run_plot import life_label
        from bearing_sim.studies.uncertainty_propagation import plot_uncertainty

        title = f"{name}: {len(found.ranges)} uncertain fields, {found.design.base} samples, level {found.level}"
        plot_uncertainty(draft, title, found, life_label([scene]), course and course.middles)

    return Result(
        {"scene": scene.name, "log": log and log.name, **report, **unknown},
        lambda: print_bands(name, report),
        plot,
        files=[table.path] if table is not None else [],
    )


def bands_of(scene, samples, seed=SEED, level=None, course=None, journal=None, workers=None, dask=None):
    """Return a study of a scene's uncertainty and its report as plain numbers; shows progress on stderr.

    Parameters
    ----------
    scene : a scene with ranges.
    samples : rounded up to a power of two.
    seed, level, journal, workers, dask : as for `bearing_sim.studies.uncertainty_propagation.study`.
    course : `bearing_sim.studies.uncertainty_propagation.Stretches`, or None.
    """
    announce_compilation(bends=scene.outer_ring_bends)
    from bearing_sim.studies.uncertainty_propagation import lowest_level, rounded_up, study, varied_ranges
    from bearing_sim.sweep.tasks import Execution

    base = rounded_up(samples)
    began, given = time.perf_counter(), (course.conditions, course.seconds) if course is not None else None
    fields = len(varied_ranges(lowest_level(scene, level)[0]))
    with Points(f"uncertainty of {scene.name}", base * (fields + 2)) as points, as_usage_error(ValueError):
        found = study(scene, base, seed, level=level, course=given, execution=Execution(journal, workers, dask, points.update))
    return found, {**_report(scene, found, seed, time.perf_counter() - began, course), "kept_from_before": points.kept}


def _course(log, scene, count):
    """Return the scene, without ranges of fields that the log gives, the log's inputs in intervals, and for how long they are unknown."""
    import math

    from bearing_sim.inputs.log import read_input_log
    from bearing_sim.studies.uncertainty_propagation import stretches

    course = judged(read_input_log(log), scene)
    kelvin = math.nan  # the scene's own, which may be uncertain
    if "oil_temperature" in course.stamps and any(one.field == "lubricant.temperature" for one in scene.uncertainty):
        note("the log gives the oil temperature: its range in the scene is not used")
        scene = without_range(scene, "lubricant.temperature")
    run = course.segment(None, kelvin)
    return scene, stretches(run.instants * 1e-9, run.inputs, run.in_gap, count), unknown_report(course)


def _report(scene, found, seed, seconds, course) -> dict:
    from bearing_sim.model.plausibility import left_out

    fields = [one.field for one in found.ranges]
    report = {
        "level": found.level,
        "level_reason": found.reason,
        "left_out": left_out(scene),
        "samples": found.design.base,
        "seed": seed,
        "evaluations": len(found.design.points),
        "without_answer": found.absent,
        "wall_seconds": seconds,
        "ranges": {one.field: attributes(one, "low", "high", "distribution", "mode", "source") for one in found.ranges},
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
    """Return table rows: the quantiles with their sampling errors, and the fields they depend on, most important first."""
    from bearing_sim.scene.display import number

    rows, note = [], without_dimensions(report["ranges"])
    for name, label, scale, unit in (("cage_slip", "cage slip", 100.0, "%"), ("life_hours", "life", 1.0, "h")):
        one = report[name]

        def quantile(key, one=one, scale=scale):
            low, high = (scale * end for end in one[f"{key}_interval"])
            return f"{number(scale * one[key])} ({number(low)} to {number(high)})"

        rows.append(
            (
                f"{label}: 5, 50, 95 % quantile",
                f"{quantile('p05')}, {quantile('p50')}, {quantile('p95')} {unit}{note if unit == 'h' else ''}; "
                f"scene's own values: {number(scale * one['own'])}",
            )
        )
        rows.append((f"{label} depends on", _shares(one["shares"], report["samples"])))
    return rows


def _shares(shares, samples) -> str:
    import math

    import numpy as np

    from bearing_sim.studies.uncertainty_propagation import Indices

    if shares is None:
        return "unknown: it is not finite at every point"
    known = [item for item in shares.items() if math.isfinite(item[1]["total"])]
    if not known:
        return "no field: it is the same at every point"
    known.sort(key=lambda item: -item[1]["total"])
    names = "first_order", "total", "first_order_interval", "total_interval"
    found = Indices(*(np.array([one[name] for _, one in known]) for name in names)).bounded()
    lines = zip((field for field, _ in known), found.first, found.first_error, found.total, found.total_error)
    return "\n".join(
        f"{field}: {_share(first, ends, samples)} alone, {_share(total, total_ends, samples)} including interactions"
        for field, first, ends, total, total_ends in lines
    )


def _share(share: float, interval, samples: int) -> str:
    import math

    low, high = (round(100 * end) for end in interval)
    return f"not known from {samples} samples ({low} to {high} %)" if math.isnan(share) else f"{round(100 * share)} % ({low} to {high} %)"


def print_bands(name, report) -> None:
    """Print a report as a table."""
    known = quantities(Scene)
    ranges = [
        f"{field}: {shown(known, field, one['low'])} to {shown(known, field, one['high'])}, {one['distribution']}"
        + (f" ({one['source']})" if one["source"] else "")
        for field, one in report["ranges"].items()
    ]
    kept = f", {report['kept_from_before']} of which kept from before" if report["kept_from_before"] else ""
    print_table(
        f"uncertainty of {name}",
        [
            ("uncertain fields", "\n".join(ranges)),
            *band_rows(report),
            ("in parentheses", "95 % intervals of the sampling error; increase --samples to narrow them"),
            (
                "computed",
                f"{report['evaluations']} evaluations ({report['samples']} samples, seed {report['seed']}) in {report['wall_seconds']:.3g} s{kept}",
            ),
            ("without a result", str(report["without_answer"])),
            ("level", report["level_reason"]),
            *(("left out", text) for text in report["left_out"]),
        ],
    )


def _rows(found) -> list[dict]:
    known = quantities(Scene)
    columns = [f"{one.field} [{known[one.field].unit if one.field in known and known[one.field].unit else '1'}]" for one in found.ranges]
    answers = zip(found.answers["cage_slip"].tolist(), found.answers["life_hours"].tolist())
    return [
        dict(zip(columns, point)) | {"cage_slip [1]": slip, "life [h]": life} for point, (slip, life) in zip(found.design.points.tolist(), answers)
    ]
