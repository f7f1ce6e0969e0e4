# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim table``: the table of operating points of level ``steady``."""

import math

import click

from bearing_sim.commands.reporting import print_json, print_table, progress_bar, tell_compilation, told_as_bad_input


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--rebuild", is_flag=True, help="Build the table even if there is one.")
@click.option("--workers", type=click.IntRange(1, 256), metavar="N", help="Threads that build it [default: all cores].")
@click.option(
    "--at", "points", multiple=True, metavar="RPM,N[,DEGC[,DEG]]", help="Show this operating point, of the table and solved for; may be repeated."
)
@click.option(
    "--against-slip",
    type=click.IntRange(1, 10_000),
    metavar="N",
    help="Instead, compare the solver with level slip at N operating points drawn by lot.",
)
@click.option("--seed", default=2017, show_default=True, help="Of the lot.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, overrides, rebuild, workers, points, against_slip, seed, as_json):
    """Build the table of operating points for SCENE at level steady, or show the one that is kept.

    It spans what the scene's block `table` says (maximum_speed, maximum_load, minimum_temperature, maximum_temperature, tolerance),
    and all directions of the load.
    """
    from bearing_sim.scene_file import SceneError, load_scene

    with told_as_bad_input(SceneError):
        scene = load_scene(scene_name, [*overrides, "level=steady"])
    if against_slip is not None:
        _compare(scene, against_slip, seed, as_json)
        return
    asked = [_condition(text, scene) for text in points]
    tell_compilation()
    table, quality = build_with_progress(scene, None, workers, rebuild)
    report = _report(scene, table, quality, [_answers(scene, table, condition) for condition in asked])
    if as_json:
        print_json(report)
    else:
        _print(report)


def build_with_progress(scene, temperatures=None, workers=None, rebuild=False):
    """Return a scene's table and its quality, from disk or built; says on stderr that it is being built.

    Parameters
    ----------
    scene : what it is for.
    temperatures : lowest and highest oil temperature [K] instead of the scene's.
    workers : threads; all cores where absent.
    rebuild : whether to build it even if there is one.
    """
    from bearing_sim.tables.store import cached_table, obtain_table

    kept = None if rebuild else cached_table(scene, temperatures)
    if kept is not None:
        return kept
    click.echo(f"building the table of operating points for {scene.name}, once for this bearing and oil ...", err=True)
    # How many points it will take is not known before; what is known is how fast their share of a usual number grows.
    with progress_bar("operating points", 1.0) as show:
        return obtain_table(scene, temperatures, workers, lambda solved: show(1.0 - math.exp(-solved / 15_000)), rebuild)


def _condition(text, scene) -> tuple[float, float, float, float]:
    """Return shaft speed, load, oil temperature and direction of the load in SI from ``RPM,N[,DEGC[,DEG]]``."""
    from bearing_sim.commands.reporting import BadInput

    try:
        numbers = [float(part) for part in text.split(",")]
        if not 2 <= len(numbers) <= 4 or not all(map(math.isfinite, numbers)):
            raise ValueError
    except ValueError:
        raise BadInput(f"--at {text}: expected speed [rpm], load [N], and perhaps oil temperature [degC] and direction of the load [deg]") from None
    kelvin = numbers[2] + 273.15 if len(numbers) > 2 else scene.lubricant.temperature
    angle = math.radians(numbers[3]) if len(numbers) > 3 else scene.operating.load_angle
    return numbers[0] * math.pi / 30, numbers[1], kelvin, angle


def _answers(scene, table, condition) -> dict:
    from bearing_sim.levels.steady_point import ANSWER
    from bearing_sim.tables.grid import look_up
    from bearing_sim.tables.store import holds, solve_scene

    speed, load, kelvin, angle = condition
    solved, interpolated = solve_scene(scene, *condition), look_up(table, [condition])[0]
    named = {name: [float(interpolated[column]), float(solved[column])] for name, column in ANSWER._asdict().items()}
    rpm, degrees = speed * 30 / math.pi, math.degrees(angle)
    where = {"speed_rpm": rpm, "load": load, "oil_temperature_c": kelvin - 273.15, "load_angle_deg": degrees}
    return {**where, "held": holds(table, speed, load, kelvin), "table_and_solution": named}


def _look_up_times(table) -> tuple[float, float]:
    """Return what a look-up anywhere in the table takes, from compiled code and as a call from Python [us]; the best of a few tries."""
    import time

    import numpy as np

    from bearing_sim.tables.grid import look_up

    count, tries = 20_000, 5
    last = [table.speeds[-1], table.loads[-1], table.temperatures[-1] - table.temperatures[0], 2 * math.pi]
    conditions = np.random.default_rng(1).random((count, 4)) * last + [0.0, 0.0, table.temperatures[0], 0.0]
    compiled, called = math.inf, math.inf
    for _ in range(tries):
        began = time.perf_counter()
        look_up(table, conditions)
        middle = time.perf_counter()
        for condition in conditions[:200]:
            look_up(table, condition[None])
        compiled, called = min(compiled, (middle - began) / count), min(called, (time.perf_counter() - middle) / 200)
    return 1e6 * compiled, 1e6 * called


def _report(scene, table, quality, answers) -> dict:
    from bearing_sim.tables.store import span_of, table_path

    compiled, called = _look_up_times(table)
    return {
        "look_up_us": compiled,
        "look_up_from_python_us": called,
        "scene": scene.name,
        "file": str(table_path(scene, span_of(scene))),
        "megabytes": table.nodes.nbytes / 1e6,
        "speeds_rpm": [speed * 30 / math.pi for speed in table.speeds.tolist()],
        "loads": table.loads.tolist(),
        "oil_temperatures_c": [kelvin - 273.15 for kelvin in table.temperatures.tolist()],
        "load_angles_deg": [math.degrees(angle) for angle in table.angles.tolist()],
        "period_deg": math.degrees(table.period),
        "both_senses": not math.isnan(table.mirror) or table.nodes.shape[0] == 2,
        **quality._asdict(),
        "points": answers,
    }


def _compare(scene, count, seed, as_json) -> None:
    from bearing_sim.studies.steady_check import compare

    tell_compilation()
    rows = []
    with progress_bar(f"marching {scene.name}", count) as progress:
        for row in compare(scene, count, seed):
            rows.append(row._asdict() | {"agrees": row.agrees})
            progress(len(rows))
    if as_json:
        print_json({"scene": scene.name, "agreeing": sum(row["agrees"] for row in rows), "points": rows})
        return
    for row in rows:
        slip = f"slip {100 * row['marched_slip']:8.4f} % marched, {100 * row['solved_slip']:8.4f} % solved"
        life = f"life {row['marched_life']:9.4g} h, {100 * (row['solved_life'] / row['marched_life'] - 1):+.2f} %"
        where = f"{row['speed_rpm']:7.0f} rpm {row['load']:6.0f} N {row['load_angle_deg']:5.0f} deg {row['oil_temperature_c']:4.0f} degC"
        click.echo(f"{where}: {slip}; {life}{'' if row['agrees'] else '; differs'}")
    click.echo(f"{sum(row['agrees'] for row in rows)} of {count} agree: slip to 2 % of it or 0.05 points, and life to 2 %")


def _print(report) -> None:
    def spanned(values, unit):
        return f"{values[0]:.6g} to {values[-1]:.6g} {unit}, {len(values)} knots" if len(values) > 1 else f"{values[0]:.6g} {unit} alone"

    print_table(
        f"operating points of {report['scene']}",
        [
            ("shaft speed", spanned(report["speeds_rpm"], "rpm") + (", both senses" if report["both_senses"] else ", forwards alone")),
            ("radial load", spanned(report["loads"], "N")),
            ("oil temperature", spanned(report["oil_temperatures_c"], "degC")),
            ("load direction", f"all; {len(report['load_angles_deg'])} knots on {report['period_deg']:.6g} deg"),
            ("nodes", f"{report['nodes']}, {report['missing']} without an answer; {report['megabytes']:.3g} MB; {report['file']}"),
            ("built", f"from {report['solved']} operating points in {report['seconds']:.3g} s"),
            ("a look-up takes", f"{report['look_up_us']:.3g} us in compiled code, {report['look_up_from_python_us']:.3g} us from Python"),
            ("asked for", f"{100 * report['tolerance']:.3g} % of life, and of slip besides 0.025 points"),
            ("kept", f"at {100 * report['within']:.4g} % of points drawn anywhere in it"),
            ("error of slip", f"{100 * report['slip_error']:.3f} points at most, 95 % below {100 * report['slip_error_95']:.3f}"),
            ("error of life", f"{100 * report['life_error']:.2f} % at most, 95 % below {100 * report['life_error_95']:.2f}"),
        ],
    )
    for point in report["points"]:
        rows = [(name, f"{of_table:.6g} (solved: {solved:.6g})") for name, (of_table, solved) in point["table_and_solution"].items()]
        where = f"{point['speed_rpm']:.6g} rpm, {point['load']:.6g} N, {point['oil_temperature_c']:.6g} degC, {point['load_angle_deg']:.6g} deg"
        print_table(where + ("" if point["held"] else ": outside the table"), rows)
