# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study``: studies of a bearing over loads, speeds, misalignments and extremes."""

import math

import click
from click import FloatRange, IntRange

from bearing_sim.cli.options import (
    PATH,
    SECONDS,
    Amount,
    allow_outside_option,
    csv_option,
    json_option,
    option,
    picture_option,
    scene_options,
    set_option,
)
from bearing_sim.cli.outputs import OutputJournal, OutputTable
from bearing_sim.cli.reporting import (
    FailedRun,
    Points,
    UsageError,
    announce_compilation,
    as_failed_run,
    as_usage_error,
    judged,
    print_points,
    print_rows,
    print_table,
    progress_bar,
    scene_of,
    scene_of_point,
    unknown_report,
    warn_of_scene,
)
from bearing_sim.cli.results import Result, command, signed
from bearing_sim.scene.display import force, number


@command("damage")
@click.argument("log", type=PATH, metavar="IN.mcap")
@allow_outside_option
@option("--scene", "scene_name", "Name of a bundled scene, or a scene file.", required=True, metavar="SCENE")
@set_option
@option("--windows", "Number of windows that level planar computes.", IntRange(1, 1000), default=10)
@option("--length", "Length of a window.", FloatRange(min=0.01), default=1.0, metavar="S")
@json_option
def damage(log, scene_name, overrides, windows, length):
    """Run the inputs in IN.mcap at levels steady and slip, and at level planar in windows spread evenly over them."""
    from bearing_sim.inputs.log import read_input_log

    scene = scene_of(scene_name, overrides, "steady")
    course = judged(read_input_log(log), scene)
    from bearing_sim.cli.table import build_with_progress
    from bearing_sim.studies.damage import damages

    announce_compilation(bends=scene.outer_ring_bends)
    kelvin = scene.lubricant.temperature
    table = build_with_progress(scene, None if "oil_temperature" in course.stamps else (kelvin, kelvin))[0]
    run = course.segment(None, kelvin)
    with progress_bar(f"running {log.name}", course.end * 1e-9) as show:
        found = damages(
            scene_name, overrides, run.instants * 1e-9, run.inputs, run.in_gap, table=table, windows=windows, length=length, progress=show
        )
    windows = [window._asdict() for window in found.windows]
    report = {"log": log.name, "scene": scene_name, **found._asdict(), "windows": windows, **unknown_report(course)}
    return Result(report, lambda: _print_damage(log, scene_name, found))


def _print_damage(log, name, found) -> None:
    rows = []
    sums = [sum(getattr(window, level) for window in found.windows) for level in ("steady", "slip", "planar")]
    for window in found.windows:
        numbers = [f"{1e6 * value:.4g}" for value in (window.steady, window.slip, window.planar)]
        where = f"{window.start:.1f}", f"{window.shaft_speed * 30 / math.pi:.0f}", f"{window.radial_load:.0f}"
        rows.append((*where, *numbers, f"{window.planar / window.slip:.3f}" if window.slip > 0.0 else ""))
    rows.append(("windows", "", "", *(f"{1e6 * value:.4g}" for value in sums), f"{sums[2] / sums[1]:.3f}" if sums[1] > 0.0 else ""))
    rows.append(("whole", "", "", f"{1e6 * found.steady:.6g}", f"{1e6 * found.slip:.6g}", "", ""))
    columns = ("from [s]", "speed [rpm]", "load [N]", "steady", "slip", "planar", "planar/slip")
    print_rows(f"{log.name}, {name}: damage in millionths of the life, by level", columns, rows)


@command("friction")
@scene_options
@option("--series", "Series of SCENE's bearing: 10, 2, 3, 4, 22, 23, or NCF 22, NCF 29, NCF 30 [default: by its designation].", metavar="SERIES")
@json_option
def friction(scene_name, overrides, series):
    """Compare the friction of SCENE at its operating point with makers' models.

    With heat.law network SCENE is in thermal equilibrium, as in `bearing-sim run`; where there is none, the command fails and says why.
    """
    from bearing_sim.scene.display import power
    from bearing_sim.studies.friction import SERIES, compare, series_of
    from bearing_sim.studies.sheet import temperatures, temperatures_text

    scene = scene_of_point(scene_name, overrides, before_results=False)
    announce_compilation(bends=scene.outer_ring_bends)
    series = " ".join(series.upper().split()) if series else series_of(scene.bearing.designation or scene.bearing.name)
    if series not in SERIES:
        named = scene.bearing.designation or scene.bearing.name
        raise UsageError(f"--series: makers publish constants for series {', '.join(SERIES)}; name that of {named!r}, or the nearest")
    with as_usage_error(ValueError):
        found = compare(scene, series)
    warm = temperatures(found.temperatures)
    rows = (
        ("model", found.model),
        ("model without hydrodynamic rolling resistance", found.without_resistance),
        ("M_0 + M_1 with f_0 and f_1", found.simple),
        ("SKF's friction model", found.skf),
        ("coefficient 0.0011", found.coefficient),
    )
    speed, load = abs(scene.operating.shaft_speed) * 30 / math.pi, scene.operating.radial_load
    warmth = [
        *(("temperatures", words) for words in [temperatures_text(warm)] if words),
        ("viscosity", f"{number(found.viscosity)} mm²/s in the contacts"),
    ]
    return Result(
        {"scene": scene.name, **found._replace(temperatures=warm)._asdict()},
        lambda: print_table(
            f"{scene.name}: friction at {number(speed, 6)} rpm and {force(load)}", [*((name, power(watts)) for name, watts in rows), *warmth]
        ),
    )


@command("clearance")
@scene_options
@option("--speed", "speeds", "Shaft speeds [default: 9 from 20 to 120 % of the scene's].", metavar="START:STOP:N")
@option("--load", "loads", "Radial loads, or one [default: 7 from 0.5 to 3.5 times the scene's].", metavar="START:STOP:N")
@option("--life-above", "Life below which it counts as lost.", Amount("h"), default="10 h")
@option("-o", "--out", "Also write the table, and PATH.csv.", OutputTable(), metavar="PATH.parquet")
@picture_option("Draw the map; lines with one load")
@json_option
def clearance(scene_name, overrides, speeds, loads, life_above, out):
    """Map the running clearance of SCENE over speed and load, in thermal equilibrium where it has a thermal network.

    Says at which speeds the clearance is gone, the fit of the shaft is lost, the life is too short, and above which heat closes the bearing
    faster than it leaves, so that there is no equilibrium. Every point is one of level steady.

    bearing-sim study clearance deng2017_table1_cold --speed 15000rpm:52000rpm:9 --load 800N:800N:1 --picture clearance.png
    """
    from pydantic_core import ValidationError

    from bearing_sim.sweep.grid import read_axis

    scene = scene_of(scene_name, overrides)
    warn_of_scene(scene)
    announce_compilation(bends=scene.outer_ring_bends)
    from bearing_sim.studies.clearance_map import LOAD, SPEED, in_words, map_clearance, plot_clearance_map
    from bearing_sim.sweep.table import require_same_study, study_digest, write_table

    operating = scene.operating
    defaults = (
        (SPEED, speeds or _from_to(operating.shaft_speed, 0.2, 1.2, 9, "rad/s")),
        (LOAD, loads or _from_to(operating.radial_load, 0.5, 3.5, 7, "N")),
    )
    with as_usage_error(ValueError):
        grid = [sorted(read_axis(f"{field}={text}", written=True).values) for field, text in defaults]
    files, study = [], study_digest("clearance", scene, grid, life_above)
    if out is not None:
        require_same_study(out, study)
    with progress_bar("points", math.prod(map(len, grid))) as show, as_usage_error(ValidationError):
        found = map_clearance(scene, *grid, life_above, show)
    if out is not None:
        require_same_study(out, study)
        files += write_table(out.path, signed(found.table, study))
    words, losses = in_words(found), [each._asdict() for each in found.losses]
    return Result(
        {"scene": scene.name, "heat": scene.heat.law, "found": words, "losses": losses, "points": found.table.rows},
        lambda: print_points(f"{scene.name}: running clearance, heat.law {scene.heat.law}", found.table, _CLEARANCE_SHOWN, keys=2),
        lambda draft: plot_clearance_map(draft, _title(scene, overrides), found),
        remarks=words,
        files=files,
    )


def _from_to(value: float, low: float, high: float, count: int, unit: str) -> str:
    return f"{low * value!r} {unit}:{high * value!r} {unit}:{count}"


def _title(scene, overrides) -> str:
    warmth = {"none": "all parts as warm as the oil", "given": "at given temperatures", "network": "in thermal equilibrium"}[scene.heat.law]
    return f"{' '.join([scene.name, *overrides])}: {warmth}"


_CLEARANCE_SHOWN = (
    "operating.shaft_speed",
    "operating.radial_load",
    "running_clearance",
    "fit_clearance",
    "rotation_clearance",
    "heat_clearance",
    "shaft_temperature",
    "inner_ring_temperature",
    "roller_temperature",
    "outer_ring_temperature",
    "oil_outlet_temperature",
    "seat_pressure",
    "cage_slip",
    "life",
    "loss",
    "status",
)


@command("housing")
@scene_options
@option("--play", "plays", "Radial plays of the outer ring in its housing.", default="0 um:20 um:9", metavar="START:STOP:N")
@option(
    "--housing",
    "housings",
    "A material of the catalogue, as a massive housing; rigid_bore; scene, that of SCENE; rigid, a rigid ring; can be repeated  [default: scene, if "
    "elastic, aluminium, cast_iron, steel, rigid_bore, rigid].",
    multiple=True,
)
@option("--slip-below", "Limit of slip, of which the largest play is sought [default: thresholds.slip_error].", Amount("", 0.0, 1.0, "%"))
@option("--life-above", "Limit of life, of which the smallest play is sought.", Amount("h"))
@option("-o", "--out", "Also write the table, and PATH.csv.", OutputTable(), metavar="PATH.parquet")
@picture_option("Draw slip, life and contact arc over play")
@json_option
def housing(scene_name, overrides, plays, housings, slip_below, life_above, out):
    """Map what the housing does to SCENE when its outer ring bends: slip, life, loads and seat over play and housing.

    Says up to which play slip stays below its limit, and, if SCENE has a housing in which its ring bends, what ring and seat endure there. Every
    point is one of level steady.

    bearing-sim study housing deng2017_table1 --play 0um:20um:9 --picture housing.png
    """
    from pydantic_core import ValidationError

    from bearing_sim.sweep.grid import read_axis

    scene = scene_of(scene_name, overrides)
    _require_turning(scene)
    warn_of_scene(scene)
    announce_compilation(bends=True)
    from bearing_sim.studies.housing_map import PLAY, RIGID, facts_in_words, housings_of, in_words, map_housings, plot_housing_map
    from bearing_sim.sweep.table import require_same_study, study_digest, write_table

    with as_usage_error(ValueError):
        grid = sorted(read_axis(f"{PLAY}={plays}", written=True).values)
    housings = tuple(dict.fromkeys(housings)) or housings_of(scene)
    limits = scene.thresholds.slip_error if slip_below is None else slip_below, life_above
    files, study = [], study_digest("housing", scene, housings, grid, limits)
    if out is not None:
        require_same_study(out, study)
    points = sum(1 if each == RIGID else len(grid) for each in housings)
    with progress_bar("points", points) as show, as_usage_error(ValidationError, ValueError), as_failed_run(ArithmeticError):
        found = map_housings(scene, housings, grid, *limits, show)
    if out is not None:
        require_same_study(out, study)
        files += write_table(out.path, signed(found.table, study))
    words, ring = in_words(found), found.ring and found.ring._asdict()

    def show_all():
        print_points(f"{scene.name}: what the housing does", found.table, [column.name for column in found.table.columns[:-1]], keys=2)
        if found.ring is not None:
            print_table("ring and seat in the scene's housing", facts_in_words(found.ring))

    return Result(
        {"scene": scene.name, "found": words, "limits": [each._asdict() for each in found.limits], "ring": ring, "points": found.table.rows},
        show_all,
        lambda draft: plot_housing_map(draft, f"{scene.name}: slip, life and seat when its outer ring bends", found),
        remarks=words,
        files=files,
    )


_LOAD = Amount("N", 1e-6, 1e8)


def _require_turning(scene) -> None:
    if not scene.operating.shaft_speed:
        raise UsageError("operating.shaft_speed: 0; slip is studied while the shaft turns: give a speed")


def _prepare_turning(scene) -> None:
    """Print what is implausible about a scene and compile what it needs; raise `UsageError` if its shaft does not turn."""
    _require_turning(scene)
    warn_of_scene(scene, before_results=False)
    announce_compilation(scene, with_states=True)


@command("cold-oil")
@scene_options
@option("--supply", "supplies", "Supply of oil; can be repeated  [default: oil_bath, circulating, oil_jet].", multiple=True)
@option("--temperature", "temperatures", "Oil temperature; can be repeated  [default: 0 to 80 °C].", Amount("K"), multiple=True)
@option("--load", "loads", "Radial load; can be repeated  [default: 0.08 to 3 times the minimum load].", Amount("N"), multiple=True)
@picture_option("Draw the map")
@json_option
def cold_oil(scene_name, overrides, supplies, temperatures, loads):
    """Map the slip of SCENE over load and oil temperature, from ideal rolling and from a skid, by supply of oil.

    Says below which load a skid lasts, and where a skid depends on how fast the shaft runs up. All parts are as warm as the oil.
    """
    from bearing_sim.simulation import IntegrationError
    from bearing_sim.studies.cold_oil import SUPPLIES, TEMPERATURES, plot_skid_map, run_ups, skid_map

    scene = scene_of(scene_name, overrides)
    _prepare_turning(scene)
    celsius = [round(each - 273.15, 9) for each in temperatures] or TEMPERATURES
    with as_usage_error(IntegrationError):
        found = skid_map(scene, supplies or SUPPLIES, celsius, loads)
        run_up = run_ups(scene, found)
    parts = {"points": found.points, "skid_loads": found.skid_loads, "run_ups": run_up}
    return Result(
        {"scene": scene.name, "minimum_load": found.minimum_load, **{name: [one._asdict() for one in each] for name, each in parts.items()}},
        lambda: _print_skids(scene, found, run_up),
        lambda draft: plot_skid_map(found, draft, f"{scene.name}: slip with cold oil"),
    )


def _print_skids(scene, found, run_up) -> None:
    for supply in dict.fromkeys(point.supply for point in found.points):
        columns = [point.celsius for point in found.skid_loads if point.supply == supply]
        rows = [
            (force(load), *(_slips(point) for point in found.points if (point.supply, point.load) == (supply, load)))
            for load in dict.fromkeys(point.load for point in found.points)
        ]
        rows.append(("skid load", *(force(each.load) for each in found.skid_loads if each.supply == supply)))
        title = f"{scene.name}, {supply}: cage slip [%], and from a skid where that differs; minimum load {force(found.minimum_load)}"
        print_rows(title, ("load", *(f"{number(each)} °C" for each in columns)), rows)
    if run_up:
        rows = [
            (each.supply, force(each.load), f"{number(each.celsius)} °C", f"{number(each.seconds)} s", f"{number(100 * each.slip, 3)} %")
            for each in run_up
        ]
        print_rows("slip after a run-up from rest", ("supply", "load", "oil", "run-up", "cage slip"), rows, words=("supply",))


def _slips(point) -> str:
    rolling, skid = number(100 * point.rolling, 3), number(100 * point.skid, 3)
    return rolling if rolling == skid else f"{rolling} / {skid}"


@command("cold-start")
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", required=False)
@set_option
@option("--load", "loads", "Load while idling; can be repeated  [default: 5 and 30 % of the minimum load].", _LOAD, multiple=True)
@option("--loaded", "Load afterwards  [default: 0.1 of the dynamic load rating].", _LOAD)
@option("--idling", "Time under the first load.", SECONDS, default="1 h")
@option("--temperature", "Of all parts, the oil and the air at the start.", Amount("K"), default="0 degC")
@option("--rise", "Time in which the load rises, at most 10 s.", Amount("s", 1e-3, 10.0), default="1 s")
@picture_option("Draw the courses", "-o", "--out")
@json_option
def cold_start(scene_name, overrides, loads, loaded, idling, temperature, rise):
    """Follow SCENE from a cold start: it idles, its losses warm it, then the load comes, until it is near thermal equilibrium.

    Once from ideal rolling and once from a skid.  A second table says what the load does to the cage if it comes earlier, and to a warm machine that
    idles again: the largest sliding power of a contact, before and while the load rises.  Without SCENE: the NU 232 of a wind gearbox, in a bath.
    """
    from bearing_sim.studies.cold_start import DEFAULT_OVERRIDES, DEFAULT_SCENE, SHARES, cold_scene, plot_cold_start
    from bearing_sim.studies.cold_start import cold_start as follow

    scene = scene_of(scene_name or DEFAULT_SCENE, [*(() if scene_name else DEFAULT_OVERRIDES), *overrides])
    scene = cold_scene(scene, temperature)
    _prepare_turning(scene)
    with progress_bar("cold start", len(loads or SHARES)) as show:
        found = follow(scene, loads, loaded, idling, temperature, rise, show)
    return Result(
        _courses_report(scene, found),
        lambda: [_print_course(scene, found, load) for load in dict.fromkeys(course.load for course in found.courses)],
        lambda draft: plot_cold_start(found, draft, f"{scene.name}: cold start from {temperature - 273.15:g} °C"),
    )


def _courses_report(scene, found) -> dict:
    from bearing_sim.model.sample import NODE_OBSERVABLES

    courses = [
        {
            **course._asdict(),
            "instants": [each._asdict() | {"temperatures": dict(zip(NODE_OBSERVABLES, each.temperatures))} for each in course.instants],
        }
        for course in found.courses
    ]
    return {"scene": scene.name, **found._asdict(), "courses": courses, "loadings": [each._asdict() for each in found.loadings]}


_INSTANTS = 12  # of a course that are printed


def _print_course(scene, found, load) -> None:
    from bearing_sim.studies.cold_start import ROLLING, SKID

    share = f"{number(100 * load / found.minimum_load, 3)} % of the minimum load"
    title = f"{scene.name}: idling under {force(load)}, {share}, then {force(found.loaded)}"
    pair = {course.start: course for course in found.courses if course.load == load}
    skid, rolling = pair[SKID], pair[ROLLING]
    marked = {round(k * (len(skid.instants) - 1) / (_INSTANTS - 1)) for k in range(_INSTANTS)}
    rows = []
    for k in sorted(marked):
        at, beside = skid.instants[k], min(rolling.instants, key=lambda each: abs(each.time - skid.instants[k].time))
        warmth = [f"{each - 273.15:.0f}" for each in at.temperatures]
        asperities = "" if math.isnan(at.asperity_share) else f"{100 * round(at.asperity_share, 6):.2g}"
        films = f"{1e6 * at.film:.3g}", f"{100 * at.film_left:.3g}", asperities
        slips = f"{100 * at.cage_slip:.3g}", f"{100 * beside.cage_slip:.3g}"
        rows.append((f"{at.time / 60:.3g}", *slips, *films, f"{at.sliding_power:.3g}", *warmth))
    parts = ("shaft", "inner", "rollers", "outer", "housing", "oil")
    columns = ("time [min]", "slip [%]", "slip from rolling [%]", "film [µm]", "film left [%]", "asperities [%]", "sliding [W]", *parts)
    print_rows(f"{title}; temperatures in °C", columns, rows)
    rows = [
        (
            f"{each.time / 60:.3g}",
            "skid" if each.start == SKID else "rolling",
            f"{100 * each.cage_slip:.3g}",
            f"{each.idling_power:.3g}",
            f"{each.contact_power:.3g}",
            f"{1e-6 * each.intensity:.3g}",
            f"{each.energy:.3g}",
            "never" if math.isinf(each.rolls_after) else f"{each.rolls_after:.3g}",
        )
        for each in found.loadings
        if each.load == load
    ]
    columns = (
        *("time [min]", "from", "slip [%]", "worst contact idling [W]", "as the load comes [W]", "intensity [W/mm²]", "energy [J]"),
        "rolls after [s]",
    )
    print_rows("if the load comes at that time; the last lines: if a warm machine has idled again", columns, rows, words=("from",))


@command("extremes")
@scene_options
@option("--samples", "Number of variants.", IntRange(1, 1_000_000), default=100)
@option("--seed", "Seed of the variants.", IntRange(0), default=0)
@option("--journal", "File from which an interrupted study resumes.", OutputJournal(), metavar="PATH")
@option("--workers", "Number of processes [default: all cores].", IntRange(1, 1024), metavar="N")
@json_option
@picture_option("Draw the map")
@csv_option("Write all runs, one per line.")
def extremes(scene_name, overrides, samples, seed, journal, workers):
    """Run variants of SCENE at its extremes, and report which finish, are step-limited, are refused or fail.

    Up to twice the speed in both directions and five times the load, from -40 to 150 degC of oil, tight and loose, with light and heavy
    cages, narrow and wide pockets and lands, under steady inputs, starts, stops, reversals, steps and ripples. Every variant runs for at
    least 50 turns of its cage, or until it settles; then its books of energy are checked. Exit code 1 if any run fails.
    """
    from bearing_sim.studies.extremes import counts, plot_extremes, run_extremes, table_rows, variants
    from bearing_sim.sweep.tasks import Execution, Journal

    announce_compilation()
    cases = variants(scene_name, overrides, samples, seed)
    with Points("variants", samples) as points, Journal(journal and journal.path) as kept:
        outcomes = run_extremes(cases, Execution(kept, workers, progress=points.update))
    found, title = counts(outcomes), f"{scene_name}: {samples} variants at its extremes"
    others = [one for one in outcomes if one.status != "finished"]
    worst = max((one for one in outcomes if math.isfinite(one.books)), key=lambda one: abs(one.books), default=None)

    def show():
        rows = [(status.replace("_", "-"), str(count)) for status, count in found.items()]
        if worst is not None:
            rows.append(("books of energy", f"off by at most {100 * abs(worst.books):.2g} % ({worst.case.name})"))
        print_table(title, rows)
        if others:
            columns = "variant", "outcome", "reason"
            print_rows("not finished", columns, [(one.case.name, one.status, one.reason) for one in others], words=columns[1:])

    cases = [{"case": one.case.name, "status": one.status, "reason": one.reason, "overrides": list(one.case.overrides)} for one in others]
    return Result(
        {"scene": scene_name, **found, "books": worst and {"case": worst.case.name, "off": worst.books}, "others": cases},
        show,
        lambda draft: plot_extremes(draft, title, outcomes),
        table_rows(outcomes),
        ending=FailedRun(f"{found['failed']} of {samples} variants failed") if found["failed"] else None,
    )
