# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim design``: the region of outer raceways that keep slip and life within limits."""

import click

from bearing_sim.commands.reporting import BadInput, orderly_end, picture_option, print_json, tell_compilation, told_as_bad_input, told_file_faults
from bearing_sim.commands.sweeping import Points, executor_options, table_option


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option("--slip-below", required=True, metavar="SLIP", help="Largest cage slip, such as 10%.")
@click.option("--life-above", required=True, metavar="LIFE", help="Least life, such as 300h; by the scene's choice of life.")
@click.option("--speed-tolerance", default="2%", show_default=True, metavar="SHARE", help="How far the speed may be off, either way.")
@click.option("--load-tolerance", default="10%", show_default=True, metavar="SHARE", help="How far the load may be off, either way.")
@click.option("--low-radius", "radii", metavar="START:STOP:N", help="Radii at the low points [default: -2.5 to +5 um about the scene's, 16].")
@click.option("--d-value", "d_values", metavar="START:STOP:N", help="D values [default: 80 to 120 % of the scene's, 9].")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--level", metavar="LEVEL", help="Fidelity level [default: steady where that has all that the scene asks for, or the scene's].")
@table_option("design.parquet", "The map; beside it PATH.csv, PATH_borders.parquet and .csv, and")
@executor_options
@picture_option("Draw the results")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(
    scene_name, slip_below, life_above, speed_tolerance, load_tolerance, radii, d_values, overrides, level, out, workers, dask, picture, as_json
):
    """Map which low-point radii and D values keep SCENE's slip below a limit and its life above another.

    bearing-sim design deng2017_table1 --slip-below 10% --life-above 300h --picture design.png
    """
    from bearing_sim.scene_file import SceneError, load_scene
    from bearing_sim.sweep.axis import read_axis
    from bearing_sim.sweep.executor import ClusterError
    from bearing_sim.sweep.fields import FieldError
    from bearing_sim.sweep.journal import Journal, JournalInUse

    with told_as_bad_input(SceneError, FieldError):
        scene = load_scene(scene_name, overrides)
        level = level or _cheapest(scene)
        overrides = [*overrides, f"level={level}"]
        scene = load_scene(scene_name, overrides)
        _check(scene)
        tell_compilation()
        from bearing_sim.studies import design as studied
        from bearing_sim.sweep.point import DURATION
        from bearing_sim.sweep.table import write_table

        axes = list(studied.default_axes(scene))
        for place, (path, text) in enumerate(((studied.LOW, radii), (studied.D_VALUE, d_values))):
            if text is not None:
                axes[place] = read_axis(f"{path}={text}")
    wanted = studied.Wanted(*_limits(slip_below, life_above, speed_tolerance, load_tolerance))
    points = Points("raceways", 0)
    with told_file_faults(), orderly_end(), told_as_bad_input(SceneError, ClusterError, JournalInUse):
        with Journal(out.with_suffix(".journal")) as journal, points:
            designed = studied.design(scene_name, overrides, wanted, *axes, journal, DURATION, workers, dask, points.tell)
        files = [*write_table(out, designed.grid), *write_table(out.with_name(f"{out.stem}_borders.parquet"), designed.border_table)]
        beside = _beside(scene, wanted)
        if picture is not None:
            from bearing_sim.studies.design_picture import draw

            draw(picture, designed, beside)
            files.append(picture)
    report = _report(scene, designed, beside, files)
    if as_json:
        print_json(report)
    else:
        _print(report)


def _cheapest(scene) -> str:
    from bearing_sim.effects import asked_for, levels_with

    return "steady" if "steady" in levels_with(asked_for(scene)) else scene.level


def _check(scene) -> None:
    raceway = scene.bearing.outer_raceway
    if not raceway.d_value or raceway.contour is not None or raceway.low_points:
        raise BadInput("bearing.outer_raceway: a design varies low_radius and d_value of even lobes; this contour is given otherwise or is round")
    if scene.operating.shaft_speed == 0.0:
        raise BadInput("operating.shaft_speed: 0; at rest nothing slips, give a speed")


def _limits(slip_below, life_above, speed_tolerance, load_tolerance) -> tuple[float, float, float, float]:
    from bearing_sim.quantity import to_si

    found = []
    for name, text, unit, factor, most in (
        ("--slip-below", slip_below, "", 100.0, 100.0),
        ("--life-above", life_above, "h", 1.0, 1e9),
        ("--speed-tolerance", speed_tolerance, "", 1.0, 0.5),
        ("--load-tolerance", load_tolerance, "", 1.0, 0.9),
    ):
        try:
            value = factor * to_si(text, unit)
        except ValueError as fault:
            raise BadInput(f"{name} {text}: {fault}") from None
        if not 0.0 <= value <= most:
            raise BadInput(f"{name} {text}: expected 0 to {most / factor:g}{f' {unit}' if unit else ''}")
        found.append(value)
    return tuple(found)


def _beside(scene, wanted):
    from bearing_sim.studies import deng2017_design as deng

    asked = scene.bearing.name, wanted.slip_below, wanted.life_above
    return deng.BESIDE if asked == (deng.SCENE, deng.SLIP_BELOW, deng.LIFE_ABOVE) else None


def _report(scene, designed, beside, files) -> dict:
    from bearing_sim.studies.deng2017_design import radii_within
    from bearing_sim.studies.design import KINDS

    about = designed.grid.about
    report = {"scene": scene.name, "level": about["level"], **about["wanted"], "raceways": len(designed.grid.rows)}
    report["without_result"] = sum(row["status"] in ("failed", "refused") for row in designed.grid.rows)
    for kind in KINDS:
        borders = [border for border in designed.borders if border.kind == kind]
        report[kind] = [border._asdict() for border in borders]
        if beside is not None:
            found = radii_within(borders, beside[1])
            report[f"{kind}_within_deng"] = found and {"low_from": found[0], "low_to": found[1]}
    return report | {"deng2017": beside and {"d_value": beside[1], "low_radius": beside[2]}, "files": list(map(str, files))}


def _print(report) -> None:
    from bearing_sim.studies.design import NOMINAL, WORST

    spread = f"speed +-{100 * report['speed_tolerance']:g} %, load +-{100 * report['load_tolerance']:g} %"
    click.echo(f"{report['scene']} at level {report['level']}: slip below {report['slip_below']:g} %, life above {report['life_above']:g} h")
    if report["without_result"]:
        click.echo(f"{report['without_result']} of {report['raceways']} raceways have no result; reasons are in the table")
    for kind, told in ((NOMINAL, "at the scene's speed and load"), (WORST, f"in the worst case of {spread}")):
        click.echo(f"{told}:" if report[kind] else f"{told}: no raceway of the map meets both limits")
        for border in report[kind]:
            ends = f"from {border['low_from']:.5f} (bound by {border['below_by']}) to {border['low_to']:.5f} mm (bound by {border['above_by']})"
            click.echo(f"  D = {border['d_value']:.4f} mm: R_low {ends}")
        if report["deng2017"]:
            found, (left, right), (low, high) = report[f"{kind}_within_deng"], report["deng2017"]["d_value"], report["deng2017"]["low_radius"]
            span = f"R_low {found['low_from']:.5f} to {found['low_to']:.5f} mm" if found else "none that the map shows"
            click.echo(f"  for every D from {left} to {right} mm: {span}; Deng 2017 has {low:.4f} to {high:.4f} mm")
    click.echo(", ".join(report["files"]))
