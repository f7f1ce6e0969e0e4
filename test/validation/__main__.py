# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Checks and studies of the code itself: ``python test/validation COMMAND``, from a checkout."""

import functools
import math
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "test"), str(ROOT / "examples")]

import click  # noqa: E402

from bearing_sim.cli.options import (  # noqa: E402
    SECONDS,
    allow_outside_option,
    csv_option,
    json_option,
    level_type,
    picture_option,
    scene_options,
    set_option,
)
from bearing_sim.cli.outputs import OutputFile, OutputJournal, default_output  # noqa: E402
from bearing_sim.cli.reporting import (  # noqa: E402
    FailedRun,
    Points,
    UsageError,
    announce_compilation,
    as_ending,
    as_failed_run,
    as_usage_error,
    command_line,
    print_json,
    print_rows,
    print_table,
    progress_bar,
    scene_of,
    write_csv,
)
from bearing_sim.cli.results import Command, Result, command  # noqa: E402
from bearing_sim.files.limits import FileError  # noqa: E402
from bearing_sim.scene.display import number as number_text  # noqa: E402
from bearing_sim.scene.errors import did_you_mean  # noqa: E402
from validation.estimator_command import estimator  # noqa: E402

_SHOWN = 12  # reasons per table
_HTML, _MARKDOWN = (".html", ".htm"), ".md"


@click.command("report", cls=Command)
@click.option("-o", "--out", type=OutputFile(), metavar="PATH", help="The page, .html or .md [default: validation.html].")
@click.option("--figures", type=OutputFile(), metavar="PATH", help="All figures as CSV.")
@click.option("--only", "names", multiple=True, metavar="CHECK", help="Run only this check; can be repeated.")
@click.option(
    "--tests", type=click.Path(path_type=Path), metavar="FILE.xml", help="What pytest wrote with --junitxml, of the claims of the test suite."
)
@click.option(
    "--recordings",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="Where the recorded vibration of Li and others (2013) lies, which is not redistributable.",
)
@click.option("--quick", is_flag=True, help="Leave out the checks that take minutes; the page says so.")
def report(out, figures, names, tests, recordings, quick):
    """Run every check of the model against something independent of it, and make a page of figures, tolerances and verdicts."""
    if out is not None and out.path.suffix.lower() not in (*_HTML, _MARKDOWN):
        raise UsageError(f"-o {out}: expected a name that ends in .html or .md")
    if names and tests:
        raise UsageError("--tests adds the claims of the test suite to the page of all checks, --only chooses single checks; give one of them")
    out = out or default_output(Path("validation.html"))
    announce_compilation()
    from bearing_sim.watchers.vibration.signal import VibrationError
    from validation.check import run
    from validation.checks import all_checks
    from validation.page import counted, figures_text, html_page, markdown_page
    from validation.suite import SuiteError, suite_results

    with as_usage_error(SuiteError, FileError, VibrationError):
        checks = all_checks(recordings)
        held_by_tests = [] if names else suite_results(tests)
    known = {check.name: check for check in checks}
    for name in names:
        if name not in known:
            raise UsageError(f"--only {name}: there is no such check{did_you_mean(name, list(known))}; expected one of {', '.join(known)}")
    chosen = [known[name] for name in dict.fromkeys(names)] or checks
    with progress_bar("checks", len(chosen)) as show:
        results = [*run(chosen, quick, show), *held_by_tests]
    page = (markdown_page if out.path.suffix.lower() == _MARKDOWN else html_page)(results, command_line())
    with as_ending():
        out.write_text(page)
        if figures is not None:
            figures.write_text(figures_text(results))
    for each in results:
        if each.verdict != "holds":
            click.echo(f"{each.verdict}: {each.quantity}: {each.found}")
    click.echo(f"{out}: {counted(results)}")


@command("against-slip")
@scene_options
@click.option("--points", "count", default=25, show_default=True, type=click.IntRange(1, 10_000), metavar="N", help="Random operating points.")
@click.option("--seed", default=2017, show_default=True, help="Seed of the random points.")
@json_option
def against_slip(scene_name, overrides, count, seed):
    """Compare the solver of level steady with settled runs of level slip at random operating points of SCENE."""
    from validation.steady_and_slip import compare

    scene = scene_of(scene_name, overrides, "steady")
    announce_compilation(scene)
    rows = []
    with progress_bar(f"simulating {scene.name}", count) as progress:
        for row in compare(scene, count, seed):
            rows.append(row._asdict() | {"agrees": row.agrees})
            progress(len(rows))
    agreeing = sum(row["agrees"] for row in rows)
    remark = f"{agreeing} of {count} agree: slip within 2 % or 0.05 points, and life within 2 %"
    return Result({"scene": scene.name, "agreeing": agreeing, "points": rows}, lambda: _print_comparison(rows), remarks=[remark])


@command("cold-oil")
@scene_options
@json_option
def cold_oil(scene_name, overrides):
    """Say which published trends of cages in cold oil the map of `bearing-sim study cold-oil` has for SCENE."""
    from bearing_sim.simulation import IntegrationError
    from bearing_sim.studies.cold_oil import SUPPLIES, TEMPERATURES, skid_map
    from validation.cold_oil_trends import trends

    scene = scene_of(scene_name, overrides)
    announce_compilation(scene, with_states=True)
    with as_usage_error(IntegrationError):
        found = trends(skid_map(scene, SUPPLIES, TEMPERATURES, ()))
    verdicts = {True: "holds", False: "does not hold", None: "no case on the map"}
    rows = [(verdicts[each.holds], each.claim, each.figures) for each in found]
    show = functools.partial(
        print_rows, f"{scene.name}: published trends with cold oil", ("verdict", "trend", "figures"), rows, words=("verdict", "trend", "figures")
    )
    return Result({"scene": scene.name, "trends": [each._asdict() for each in found]}, show)


def _print_comparison(rows) -> None:
    for row in rows:
        slip = f"slip {100 * row['marched_slip']:8.4f} % simulated, {100 * row['solved_slip']:8.4f} % solved"
        life = f"life {row['marched_life']:9.4g} h, {100 * (row['solved_life'] / row['marched_life'] - 1):+.2f} %"
        where = f"{row['speed_rpm']:7.0f} rpm {row['load']:6.0f} N {row['load_angle_deg']:5.0f} deg {row['oil_temperature_c']:4.0f} °C"
        click.echo(f"{where}: {slip}; {life}{'' if row['agrees'] else '; differs'}")


@click.command("slices")
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@set_option
@click.option("--settle", default=0.15, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated time before measuring.")
@click.option("--duration", default=0.06, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated time measured.")
@json_option
def slices(scene_name, overrides, settle, duration, as_json):
    """Run SCENE at level spatial by quadrature and with 10 to 200 slices, and measure results and the cost of a step."""
    from bearing_sim.scene.loader import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError

    with as_usage_error(SceneError):
        scene = load_scene(scene_name, [*overrides, "level=spatial"])
    announce_compilation()
    from validation.slices import SLICES, by_slices

    with progress_bar("runs", len(SLICES)) as show, as_failed_run(IntegrationError):
        found = by_slices(scene, settle, duration, progress=show)
    if as_json:
        print_json({"scene": scene_name, "runs": [one._asdict() for one in found]})
    else:
        _print_slices(scene_name, found)


def _print_slices(name, found) -> None:
    columns = (
        "slices",
        "slip [%]",
        "largest load [N]",
        "life [h]",
        "L10r [h]",
        "edge [MPa]",
        "static pressure [MPa]",
        "L10r [h]",
        "time per step [µs]",
        "x real time",
    )
    rows = []
    for one in found:
        lives = [number_text(value) for value in (one.inner_load, one.rating_life, one.l10r, 1e-6 * one.edge_pressure)]
        still = ("-", "-") if one.slices is None else (f"{1e-6 * one.static_pressure:.5g}", f"{one.static_l10r:.4g}")
        rows.append(
            (str(one.slices or "quadrature"), f"{100 * one.slip:.4g}", *lives, *still, f"{1e6 * one.step_seconds:.3g}", f"{one.real_time_factor:.3g}")
        )
    print_rows(f"{name}: results by number of slices", columns, rows)


@click.command("scenes", cls=Command)
@click.option("--count", default=500, show_default=True, type=click.IntRange(1, 1_000_000), help="Random scenes.")
@click.option("--level", type=level_type, default="slip", show_default=True, help="Level of fidelity.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the scenes.")
@click.option("--at-most", type=SECONDS, default="100 s", show_default=True, metavar="S", help="Longest simulated time of a scene.")
@click.option("--journal", type=OutputJournal(), metavar="PATH", help="File from which an interrupted study resumes.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
def scenes(count, level, seed, at_most, journal, workers, as_json):
    """Run random scenes of catalogue bearings until they settle: designation, oil, 0.1 to 1.2 of the limiting speed, 0 to 0.5 C.

    Lists those that do not settle, with what they do.
    """
    from validation.catalogue_scenes import run_scenes

    announce_compilation()
    with Points(f"{count} scenes at level {level}", count) as points:
        report = run_scenes(count, level, seed, at_most, journal and journal.path, workers, points.update)
    if as_json:
        print_json(
            {"level": level, "settled": report.settled, "counts": report.counts, "others": [[one._asdict(), *why] for one, *why in report.others]}
        )
        return
    print_table(f"{count} random scenes at level {level}", [(status, str(number)) for status, number in sorted(report.counts.items())])
    if report.others:
        columns = ("designation", "oil", "supply", "temperature [°C]", "speed [rpm]", "load [N]", "status", "what it does")
        print_rows("scenes that did not settle", columns, [[*map(str, one), status, why] for one, status, why in report.others], words=columns)


@click.command("findings")
@click.option("--level", type=click.Choice(["slip", "planar"]), default="slip", show_default=True, help="Level of fidelity.")
@json_option
def findings(level, as_json):
    """Say which published findings about slip the model reproduces: an NU 215 on a rig, and an NU 232 in a wind gearbox.

    They have a direction, no digits that a model could be held to.
    """
    announce_compilation()
    from validation.published_findings import findings as found

    results = found(level)
    if as_json:
        print_json({"level": level, "findings": [one._asdict() for one in results]})
        return
    rows = [(one.claim, one.source, one.figures, "yes" if one.holds else "no") for one in results]
    columns = ("finding", "source", "the model's cage slip", "holds")
    print_rows(f"published findings at level {level}", columns, rows, words=columns)


@click.command("catalog")
@json_option
def catalog_rules(as_json):
    """Fit the rules for the inside of catalogue bearings again, and state their errors on bearings held back from the fit.

    The first table has every fourth section held back, and each section left out in turn; the second has ISO 281's C_r with known rollers
    over the rating that a maker prints.
    """
    from validation.catalog_rules import report

    found = report()
    if as_json:
        print_json(found)
        return
    for design, words in (("high_capacity", "high-capacity design (E, EC)"), ("standard", "standard design")):
        one = found[design]
        rules, flange = one["rules"], one["diameter_by_flange"]
        line = f"s = {1e3 * rules['gap']:.3f} mm + {rules['gap_ratio']:.4f} D_w, from {rules['sections']} sections of two widths"
        heights = f"{rules['outer_flange']:.3f} (outer), {rules['inner_flange']:.3f} (inner) of D_w"
        rows = [("gap between rollers", line), ("height of flanges", heights), ("length of rollers", f"{rules['length_ratio']:.3f} B, without a C_0")]
        rows.append(("D_w by outer flange", f"exact for {100 * flange['exact']:.0f} % of {flange['number']}; {_errors(flange)}"))
        for name, said in (("held_back", "every fourth held back"), ("left_out", "each left out in turn")):
            errors = one[name]
            count = errors["count"]
            text = f"Z exact for {100 * count['exact']:.0f} %, at most {count['largest']:.0f} off\nD_w {_errors(errors['diameter'])}\n"
            text += f"effective length {_errors(errors['length'])}\nC_r against the maker's {_errors(errors['dynamic_rating'])}"
            rows.append((f"{said}, {errors['bearings']} bearings", text))
        print_table(words, rows)
    rows = [
        (maker, f"{one['median']:.3f} in the median, {one['least']:.3f} to {one['largest']:.3f}, of {one['number']} bearings")
        for maker, one in found["computed_over_printed"].items()
    ]
    print_table("C_r by ISO 281 over the maker's C, with known numbers of rollers", rows)


def _errors(one) -> str:
    if not one["number"]:
        return "not printed"
    one = {name: 0.0 if value < 1e-9 else value for name, value in one.items()}  # round-off
    return f"off by {100 * one['median']:.2g} % in the median, {100 * one['p95']:.2g} % at 95 %, {100 * one['largest']:.2g} % at most"


@click.command("nightly", cls=Command)
@click.option("--level", "levels", multiple=True, type=level_type, help="Run this level; can be repeated [default: all].")
@click.option(
    "--samples",
    type=click.IntRange(0, 1_000_000),
    help="Scenes of the Latin hypercube per level [default: 2000 at steady and slip, 500 at planar, 200 at spatial].",
)
@click.option("--first", type=click.IntRange(0), metavar="N", help="Run only the first N of these scenes [default: all].")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the Latin hypercube.")
@click.option("--corners/--no-corners", default=True, show_default=True, help="Also run the named corner cases.")
@click.option("--long/--no-long", default=True, show_default=True, help="Also make the long runs: 60 s at planar, 10 min at slip, 24 h at steady.")
@click.option("--journal", type=OutputJournal(), metavar="PATH", help="File from which an interrupted night resumes.")
@csv_option("Write all runs, one per line, with seed and hash of the program.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
def nightly(levels, samples, first, seed, corners, long, journal, table, workers, as_json):
    """Run extreme scenes at stock settings, corners and long runs, and report outcomes and books of energy in one table.

    Every scene runs for at least 50 turns of its cage, or until it settles.  Takes hours.  Exit code 1 if any run fails.
    """
    from bearing_sim.sweep.tasks import JournalInUse
    from validation.nightly import SAMPLES, run_nightly

    announce_compilation()
    wanted = {level: SAMPLES[level] if samples is None else samples for level in levels or SAMPLES}
    with as_ending(), as_usage_error(JournalInUse), Points("nightly", 0) as points:
        report = run_nightly(wanted, seed, corners, long, journal and journal.path, workers, points.update, first)
        if table is not None:
            write_csv(table, report.cases)
    if as_json:
        rows = [row._asdict() | {"books": row.books and row.books._asdict()} for row in report.rows]
        print_json({"seed": report.seed, "program": report.program, "failed": report.failed, "rows": rows})
    else:
        _print_nightly(report)
    if report.failed:
        raise FailedRun(f"{report.failed} of {sum(sum(row.counts.values()) for row in report.rows)} runs failed")


def _print_nightly(report) -> None:
    rows = []
    for row in report.rows:
        books = ("", "", "", "") if row.books is None else (*(f"{100 * off:.2g}" for off in row.books[1:4]), row.books.worst)
        rows.append((row.level, row.runs, *map(str, row.counts.values()), *books, f"{row.core_seconds:.0f}"))
    counts = ("finished", "step-limited", "refused", "failed")
    books = ("books off by, %: median", "95 %", "largest", "in")
    print_rows(
        f"seed {report.seed}, program {report.program[:12]}",
        ("level", "runs", *counts, *books, "core [s]"),
        rows,
        words=("level", "runs", "in"),
        width=190,
    )
    for row in report.rows:
        for status, reasons in row.reasons.items():
            for reason, count in list(reasons.items())[:_SHOWN]:
                click.echo(f"{row.level}, {row.runs}: {count} {status.replace('_', '-')}: {reason}")
        for name, reason in row.failures[:_SHOWN]:
            click.echo(f"{row.level}, {row.runs}: {name} failed: {reason}")


@click.command("friction", cls=Command)
@set_option
@csv_option("Write all operating points to a table.")
@json_option
def friction(overrides, table, as_json):
    """Compare frictional moments of catalogue bearings with makers' models, in an oil bath under the conditions of ISO 15312.

    From 0.02 to 0.2 C_0 and from 500 rpm to the reference speed; a second table has the speeds at which friction reaches the standard's heat
    flow, against those that makers print, and a third one rolling and sliding against SKF's friction model, from mixed friction to thick films.
    """
    from validation.catalogue_friction import FILM_BEARINGS, film_rows, moment_table, part_ratios, thermal_speeds

    announce_compilation()

    found, speeds = moment_table(overrides=overrides), thermal_speeds(overrides=overrides)
    rows = [{**one._asdict(), "simple": one.simple, "ratio": one.ratio} for one in found]
    if table is not None:
        with as_ending():
            write_csv(table, rows)
    with progress_bar("film ratios", len(FILM_BEARINGS)) as show:
        ratios = part_ratios(lambda name: show(FILM_BEARINGS.index(name)), overrides, FILM_BEARINGS)
    films, medians = film_rows(ratios), _medians(found, speeds)
    if as_json:
        tables = {"moments": rows, "thermal_speeds": [one._asdict() for one in speeds], "part_ratios": [one._asdict() for one in ratios]}
        spreads = ("whole", "rolling", "sliding", "slip")
        by_films = [{**one._asdict(), **{name: getattr(one, name)._asdict() for name in spreads}} for one in films]
        print_json({**tables, "films": by_films, "medians": medians})
        return
    _print_moments(found)
    _print_thermal_speeds(speeds)
    _print_films(films)
    print_table("medians", [(name, f"{value:.2f}") for name, value in medians.items()])


def _medians(found, speeds) -> dict[str, float]:
    import numpy as np

    return {
        "moment over M_0 + M_1": float(np.median([one.ratio for one in found])),
        "moment over SKF's friction model": float(np.median([one.model / one.skf for one in found])),
        "thermal speed over NKE's": float(np.nanmedian([one.model / one.nke for one in speeds])),
        "thermal speed over SKF's": float(np.median([one.model / one.skf for one in speeds])),
        "thermal speed over that of SKF's friction model": float(np.median([one.model / one.skf_model for one in speeds])),
    }


def _print_moments(found) -> None:
    rows = [
        (
            one.bearing,
            f"{one.load:.2f}",
            *(
                f"{value:.4g}"
                for value in (one.speed, one.model, one.rolling, one.sliding, one.drag, one.pocket, one.flange, one.viscous, one.by_load, one.skf)
            ),
            f"{one.ratio:.2f}",
        )
        for one in found
    ]
    columns = ("bearing", "P/C_0", "rpm", "model, N mm", "rolling", "sliding", "drag", "pockets", "flanges", "M_0", "M_1", "SKF", "ratio")
    print_rows("frictional moment, and its ratio to M_0 + M_1", columns, rows, words=("bearing",))


def _print_thermal_speeds(speeds) -> None:
    def shown(value):
        return "" if math.isnan(value) else f"{value:.4g}"

    rows = [
        (one.bearing, *(shown(value) for value in (one.model, one.simple, one.skf_model, one.nke, one.skf, one.model / one.nke, one.model / one.skf)))
        for one in speeds
    ]
    columns = ("bearing", "model", "M_0 + M_1", "SKF's friction model", "NKE prints", "SKF prints", "model/NKE", "model/SKF")
    print_rows("thermal reference speed, rpm (ISO 15312)", columns, rows, words=("bearing",))


def _print_films(films) -> None:
    def shown(spread, scale=1.0, digits=".2f"):
        return f"{scale * spread.median:{digits}} ({scale * spread.low:{digits}} to {scale * spread.high:{digits}})"

    rows = [(f"{one.kappa:g}", *(shown(each) for each in (one.whole, one.rolling, one.sliding)), shown(one.slip, 100.0, ".2g")) for one in films]
    title = f"friction over SKF's friction model by film ratio: median (5 to 95 %) of {films[0].count} points, loads from 0.02 to 0.3 C"
    print_rows(title, ("kappa", "whole moment", "rolling over M_rr", "sliding over M_sl", "cage slip [%]"), rows)


@click.command("extremes", cls=Command)
@click.option("--samples", default=500, show_default=True, type=click.IntRange(0, 1_000_000), help="Scenes of the Latin hypercube per level.")
@click.option("--level", "levels", multiple=True, type=level_type, help="Study this level; can be repeated [default: all].")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed of the Latin hypercube.")
@click.option("--long/--no-long", default=True, show_default=True, help="Also make the long continuous runs.")
@click.option("--workers", type=click.IntRange(1, 1024), metavar="N", help="Number of processes [default: all cores].")
@json_option
@picture_option("Draw the map")
@csv_option("Write all cases, one per line.")
def extremes(samples, levels, seed, long, workers, as_json, picture, table):
    """Run scenes at the extremes of all parameters and report which finish, are step-limited, are refused or fail.

    Speed, load, play, lobes, rollers, pockets, lands, oil, slices, tolerances and steps from a Latin hypercube, and named corner
    cases, on all cores available to this process.  Scenes that their own settings limit run again at stock settings.  Exit code 1 if any case fails.
    """
    from validation.extremes import plot_extremes, run_extremes, table_rows

    with progress_bar("extremes", 1.0) as progress:
        report, outcomes = run_extremes(samples, levels, seed, long, lambda text: click.echo(f"{text} ...", err=True), progress, workers)
    with as_ending():
        if table is not None:
            write_csv(table, table_rows(outcomes))
        if picture is not None:
            with picture.draft() as draft:
                plot_extremes(draft, outcomes)
    if as_json:
        print_json(report)
    else:
        for level, results in report["levels"].items():
            _print_extremes(level, results)
    if report["failed_at_stock"]:
        raise FailedRun(f"{report['failed_at_stock']} step-limited cases failed at stock settings")
    if report["failed"]:
        raise FailedRun(f"{report['failed']} of {sum(report[name] for name in ('finished', 'step_limited', 'refused', 'failed'))} cases failed")


def _print_extremes(level, results) -> None:
    rows = [(name.replace("_", "-"), str(results[name])) for name in ("finished", "step_limited", "refused", "failed")]
    rows += [(f"step-limited by {reason}", str(count)) for reason, count in list(results["step_limited_by"].items())[:_SHOWN]]
    rows += [
        (f"step-limited, at stock settings {status.replace('_', '-')}", str(count)) for status, count in results["step_limited_at_stock"].items()
    ]
    rows += [(f"refused for {reason}", str(count)) for reason, count in list(results["refused_by"].items())[:_SHOWN]]
    rows += [(f"failed: {failure['case']}", failure["reason"]) for failure in results["failures"][:_SHOWN]]
    rows += [(f"failed at stock settings: {failure['case']}", failure["reason"]) for failure in results["failures_at_stock"][:_SHOWN]]
    worst = {
        "steps_per_ms": "most steps per simulated ms",
        "right_hand_sides_per_ms": "most right-hand sides per simulated ms",
        "core_ms_per_ms": "most core time per simulated ms [ms]",
        "step_us": "longest step [us of core time]",
    }
    for kind, scope in (("worst_by_the_model", ""), ("worst", ", including settings that request small steps")):
        rows += [
            (text + scope, f"{results[kind][name]['value']:.4g} ({results[kind][name]['case']})")
            for name, text in worst.items()
            if name in results[kind]
        ]
    rows += [
        (
            f"{run['simulated']:g} s at {run['speed_rpm']:g} rpm",
            run["failure"]
            or f"{run['real_time_factor']:.3g} times real time; drift of slip {run['slip_drift']:.1e}, damage rate {run['damage_drift']:.1e}, energy "
            f"{run['energy_drift']:.1e}; books of energy off by {100 * run['books']:.2g} %; "
            f"angle errors {run['shaft_angle_error']:.1e} shaft, {run['cage_angle_error']:.1e} cage",
        )
        for run in results["long_runs"]
    ]
    print_table(f"extremes at level {level}, {results['core_seconds']:.0f} s of core time", rows)


@click.group(commands=[report, scenes, findings, slices, catalog_rules, extremes, nightly, estimator, friction, against_slip, cold_oil])
def main():
    """Check and study the model itself, against what is independent of it."""


if __name__ == "__main__":
    main()
