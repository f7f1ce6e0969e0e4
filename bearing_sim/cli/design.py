# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim design``: outer raceways with slip and life within limits, verified at a level of higher fidelity."""

import click

from bearing_sim.cli.options import PATH, Amount, executor_options, json_option, option, picture_option, scene_argument, set_option, table_option
from bearing_sim.cli.reporting import (
    Points,
    UsageError,
    announce_compilation,
    note,
    print_rows,
    refuse_idle_temperature,
    warn,
)
from bearing_sim.cli.results import Result, command, resumed, signed

_NONE = "none"


@command("design")
@scene_argument
@option("--slip-below", "Largest cage slip, such as 10%.", Amount("", 0.0, 1.0, "%"), required=True)
@option("--life-above", "Smallest life, such as 300h; the kind of life is chosen in the scene.", Amount("h", 0.0, 1e9), required=True)
@option("--speed-tolerance", "Tolerance of the speed, in both directions.", Amount("", 0.0, 0.5, "%"), default="2%")
@option("--load-tolerance", "Tolerance of the load, in both directions.", Amount("", 0.0, 0.9, "%"), default="10%")
@option(
    "--tolerance",
    "tolerances",
    "Tolerance of another field, in both directions, such as bearing.roller.diameter=1um; can be repeated.",
    multiple=True,
    metavar="FIELD=AMOUNT",
)
@option(
    "--point",
    "points",
    "Operating point of a mission with its share of time, such as '45000 rpm, 800 N, 70%'; an oil temperature may follow; repeat it.",
    multiple=True,
    metavar="SPEED,LOAD,WEIGHT",
)
@option(
    "--points",
    "points_file",
    "Operating points, one a line: shaft_speed [rpm], radial_load [N], weight and, optionally, oil_temperature [degC].",
    PATH,
    metavar="POINTS.csv",
)
@option("--low-radius", "radii", "Radii at the low points [default: 16 values, -2.5 to +5 um about the scene's].", metavar="START:STOP:N")
@option("--d-value", "d_values", "D values [default: 9 values, 80 to 120 % of the scene's].", metavar="START:STOP:N")
@set_option
@option("--level", "Level of fidelity [default: steady if it supports the scene, otherwise the scene's].", metavar="LEVEL")
@option("--verify-level", "Level that verifies edges and centre of each interval, or none [default: planar; of planar, spatial].", metavar="LEVEL")
@table_option("design.parquet", "Map; also written: PATH.csv, PATH_borders and PATH_checks (.parquet, .csv), and", "_borders", "_checks")
@executor_options
@picture_option("Draw the results")
@json_option
def design(
    scene_name,
    slip_below,
    life_above,
    speed_tolerance,
    load_tolerance,
    tolerances,
    points,
    points_file,
    radii,
    d_values,
    overrides,
    level,
    verify_level,
    out,
    workers,
    dask,
):
    """Map which low-point radii and D values keep the slip of SCENE below a limit and its life above another, and verify them.

    With operating points, slip must stay below its limit at each, and the life is that of the mission. In the worst case of the tolerances,
    speed and load take all nine combinations of nominal, lowest and highest; each other field is off alone in both directions, then all
    are off together in the directions that are worst. Edges and centre of each interval of radii are computed again at a level of higher
    fidelity, and what it refuses is narrowed or withdrawn. `bearing-sim report` makes a page of the results.

    bearing-sim design deng2017_table1 --slip-below 10% --life-above 300h --picture design.png
    """
    from bearing_sim.model.plausibility import plausibility
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.sweep.grid import read_axis

    scene = load_scene(scene_name, overrides)
    level = level or _cheapest(scene)
    overrides = [*overrides, f"level={level}"]
    scene = load_scene(scene_name, overrides)
    _check_design(scene, points or points_file)
    warn(plausibility(scene))
    announce_compilation(scene)
    from bearing_sim.studies import design as studied
    from bearing_sim.sweep.point import DURATION
    from bearing_sim.sweep.table import study_digest
    from bearing_sim.sweep.tasks import Execution

    axes = list(studied.default_axes(scene))
    for place, (path, text) in enumerate(((studied.LOW, radii), (studied.D_VALUE, d_values))):
        if text is not None:
            axes[place] = read_axis(f"{path}={text}", written=True)
    limits = _limits(scene, slip_below, life_above, speed_tolerance, load_tolerance, tolerances, points, points_file)
    verify_level = _verify_level(verify_level, scene)
    raceways = Points("raceways", 0)
    study = study_digest("design", scene, limits, [(axis.field.path, axis.values) for axis in axes], DURATION, verify_level)
    with resumed(out, study, raceways, parts=studied.TABLES) as journal:
        designed = studied.design(scene_name, overrides, limits, *axes, DURATION, Execution(journal, workers, dask, raceways.update), verify_level)
    designed.grid.about.update(signed(designed.grid, study).about)
    report = _report_design(scene, designed)
    return Result(
        report,
        lambda: _print_design(report),
        lambda draft: studied.plot_design(draft, designed),
        files=studied.write_design(out.path, designed),
        warnings=report["warnings"],
    )


def _cheapest(scene) -> str:
    from bearing_sim.scene.fidelity import asked_for, levels_with

    return "steady" if "steady" in levels_with(asked_for(scene)) else scene.level


def _check_design(scene, has_points) -> None:
    raceway = scene.bearing.outer_raceway
    if not raceway.d_value or raceway.contour is not None or raceway.low_points:
        raise UsageError("bearing.outer_raceway: a design varies low_radius and d_value of even lobes; this raceway is round or given otherwise")
    if scene.operating.shaft_speed == 0.0 and not has_points:
        raise UsageError("operating.shaft_speed: 0; there is no slip at rest; give a speed")


def _limits(scene, slip_below, life_above, speed_tolerance, load_tolerance, tolerances, points, points_file):
    from bearing_sim.studies.design import Limits
    from bearing_sim.sweep.conditions import Conditions, read_point, read_points, read_tolerance

    if points and points_file:
        raise UsageError("--point and --points contradict each other; give one of them")
    mission = read_points(points_file) if points_file else tuple(map(read_point, points))
    if any(point.oil_temperature is not None for point in mission):
        refuse_idle_temperature(scene, ["lubricant.temperature"])
    off = tuple(read_tolerance(text, scene) for text in tolerances)
    for name in {each.field for each in off}:
        if sum(each.field == name for each in off) > 1:
            raise UsageError(f"--tolerance {name}: given more than once; give the largest")
    return Limits(100.0 * slip_below, life_above, Conditions(speed_tolerance, load_tolerance, off, mission))


def _verify_level(asked, scene) -> str | None:
    """Return the level that verifies; None if none does."""
    from bearing_sim.scene.fidelity import LEVELS
    from bearing_sim.studies.design import ALIKE, VERIFIED_BY

    if asked == _NONE:
        return None
    higher = LEVELS[LEVELS.index(scene.level) + 1 :]
    if asked is not None and asked not in higher:
        raise UsageError(f"--verify-level {asked}: expected {', '.join([*higher, _NONE])}; the design is at level {scene.level}")
    found = asked or VERIFIED_BY.get(scene.level)
    if found is None:
        note(f"no level is of higher fidelity than {scene.level}: nothing is verified")
    elif (scene.level, found) in ALIKE:
        note(ALIKE[scene.level, found])
    return found


def _report_design(scene, designed) -> dict:
    from bearing_sim.model.validity import counted
    from bearing_sim.studies.design import KINDS, STATE

    about = designed.grid.about
    report = {name: about[name] for name in ("level", "verify_level", "life")} | about["wanted"]
    report = {"scene": scene.name} | report | {"state": STATE, "raceways": len(designed.grid.rows)}
    report["warnings"] = counted(row["warnings"] for row in designed.grid.rows)
    report["without_result"] = sum(row["status"] in ("failed", "refused") for row in designed.grid.rows)
    report["unsettled"] = sum(row["status"] == "unsettled" for row in designed.grid.rows)
    report["unsettled_checks"] = sum(check.status == "unsettled" for check in designed.checks)
    report["beyond_the_map"] = {kind: designed.open_ends(kind) for kind in KINDS}
    for kind in KINDS:
        bands = [band for band in designed.bands if band.found.kind == kind]
        report[kind] = [band.found._asdict() | {"verdict": band.verdict, "verified": band.verified and band.verified._asdict()} for band in bands]
    report["widest"] = designed.widest and designed.widest._asdict()
    report["checks"] = [check._asdict() for check in designed.checks]
    return report | {"files": None}


def _print_design(report) -> None:
    from bearing_sim.studies.design import KINDS, condition_name

    verify_level = report["verify_level"]
    verified = f", verified at level {verify_level}" if verify_level else ", not verified at a higher level"
    wanted = f"slip below {report['slip_below']:g} %, life above {report['life_above']:g} h ({report['life']})"
    click.echo(f"{report['scene']} at level {report['level']}{verified}: {wanted}; {report['state']}")
    for point in report["points"]:
        oil = f", oil {point['oil_temperature_degC']:g} degC" if "oil_temperature_degC" in point else ""
        click.echo(f"  {100 * point['share']:.4g} % of the time {point['shaft_speed_rpm']:g} rpm, {point['radial_load']:g} N{oil}")
    if report["without_result"]:
        click.echo(f"{report['without_result']} of {report['raceways']} raceways have no result; the table has the reasons")
    for name, what, count in (("unsettled", "raceways", report["raceways"]), ("unsettled_checks", "verified raceways", len(report["checks"]))):
        if report[name]:
            click.echo(f"{report[name]} of {count} {what} had not settled in some of their runs; the table has the reasons")
    for kind in KINDS:
        condition = condition_name(kind, report)
        if not report[kind]:
            click.echo(f"{condition}: no raceway in the map meets both limits")
            continue
        _print_bands(condition, report[kind], report["level"], verify_level)
        if report["beyond_the_map"][kind]:
            click.echo(f"  {report['beyond_the_map'][kind]}")
    _print_checks(report)


def _print_bands(condition, bands, level, verify_level) -> None:
    columns = ["D [mm]", f"R_low at {level} [mm]", "bound by"]
    rows = []
    for band in bands:
        row = [f"{band['d_value']:.4f}", f"{band['low_from']:.5f} to {band['low_to']:.5f}", f"{band['below_by']}, {band['above_by']}"]
        if verify_level:
            kept = band["verified"]
            row += [f"{kept['low_from']:.5f} to {kept['low_to']:.5f}", f"{kept['below_by']}, {kept['above_by']}"] if kept else ["none", ""]
            row.append(band["verdict"])
        rows.append(row)
    if verify_level:
        columns += [f"verified at {verify_level} [mm]", "bound by", "verdict"]
    print_rows(condition, columns, rows, words=("bound by", "verdict"))


def _print_checks(report) -> None:
    """Print both levels' results at the D value with the widest interval; at the last one if nothing is left."""
    from bearing_sim.sweep.point import OK

    widest = report["widest"]
    if report["verify_level"] is None:
        return
    if widest is None:
        click.echo("nothing is recommended: no raceway of the map meets both limits at both levels")
    else:
        centre, half = 0.5 * (widest["low_from"] + widest["low_to"]), 0.5e3 * (widest["low_to"] - widest["low_from"])
        where = "in the worst case" if widest["kind"] == "worst" else "at nominal conditions, none in the worst case"
        click.echo(f"widest interval {where}: D = {widest['d_value']:.4f} mm, R_low = {centre:.5f} mm +-{half:.2f} um")
    if not report["checks"]:
        return
    kind, d_value = (widest["kind"], widest["d_value"]) if widest else (report["checks"][-1]["kind"], report["checks"][-1]["d_value"])
    level, verify_level = report["level"], report["verify_level"]
    rows = [
        (
            check["place"],
            f"{check['low_radius']:.5f}",
            *(f"{check[name]:.4g}" for name in ("slip", "verified_slip", "life", "verified_life")),
            ("meets both limits" if check["verified_meets"] else f"refused at {verify_level}")
            + ("" if check["status"] == OK else f", {check['status']}"),
        )
        for check in report["checks"]
        if (check["kind"], check["d_value"]) == (kind, d_value)
    ]
    columns = ("raceway", "R_low [mm]", f"slip at {level} [%]", f"at {verify_level}", f"life at {level} [h]", f"at {verify_level} ", "verdict")
    print_rows(f"both levels at D = {d_value:.4f} mm, {kind} (the others are in the table of checks)", columns, rows, words=("raceway", "verdict"))
