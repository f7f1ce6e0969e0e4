# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study damage``: the damage of a measured course by levels, side by side."""

from pathlib import Path

import click

from bearing_sim.commands.reporting import FailedRun, print_json, print_rows, progress_bar, tell_compilation, told_as_bad_input, told_file_faults


@click.command()
@click.argument("log", type=click.Path(path_type=Path), metavar="IN.mcap")
@click.option("--scene", "scene_name", required=True, metavar="SCENE", help="Name of a bundled scene, or a scene file.")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--windows", default=10, show_default=True, type=click.IntRange(1, 1000), help="How many windows level planar computes.")
@click.option("--length", default=1.0, show_default=True, type=click.FloatRange(min=0.01), metavar="S", help="Length of a window.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(log, scene_name, overrides, windows, length, as_json):
    """Run the course of inputs in IN.mcap at levels steady and slip, and at level planar in windows evenly spread over it."""
    import numpy as np

    from bearing_sim.input_course import judge
    from bearing_sim.input_log import InputLogError, read_input_log
    from bearing_sim.scene_file import SceneError, load_scene
    from bearing_sim.simulation import Inputs, IntegrationError

    with told_as_bad_input(SceneError, InputLogError), told_file_faults():
        scene = load_scene(scene_name, [*overrides, "level=steady"])
        course = judge(read_input_log(log), scene.input_limits, Inputs(0.0, 0.0, 0.0, scene.lubricant.temperature))
    from bearing_sim.commands.table import build_with_progress
    from bearing_sim.studies.damage import damages

    tell_compilation()
    kelvin = scene.lubricant.temperature
    table = build_with_progress(scene, None if "oil_temperature" in course.stamps else (kelvin, kelvin))[0]
    in_gap = np.zeros(len(course.instants), bool)
    for begin, end in course.gaps:
        in_gap |= (course.instants > begin) & (course.instants <= end)
    with progress_bar(f"running {log.name}", course.end * 1e-9) as show, told_as_bad_input(SceneError):
        try:
            found = damages(
                scene_name, overrides, course.instants * 1e-9, course.at(course.instants, kelvin), in_gap,
                table=table, windows=windows, length=length, progress=show,
            )  # fmt: skip
        except IntegrationError as fault:
            raise FailedRun(str(fault)) from None
    if as_json:
        print_json({"log": log.name, "scene": scene_name, **found._asdict(), "windows": [window._asdict() for window in found.windows]})
    else:
        _print(log, scene_name, found)


def _print(log, name, found) -> None:
    import math

    rows = []
    sums = [sum(getattr(window, level) for window in found.windows) for level in ("steady", "slip", "planar")]
    for window in found.windows:
        numbers = [f"{1e6 * value:.4g}" for value in (window.steady, window.slip, window.planar)]
        where = f"{window.start:.1f}", f"{window.shaft_speed * 30 / math.pi:.0f}", f"{window.radial_load:.0f}"
        rows.append((*where, *numbers, f"{window.planar / window.slip:.3f}" if window.slip > 0.0 else ""))
    rows.append(("windows", "", "", *(f"{1e6 * value:.4g}" for value in sums), f"{sums[2] / sums[1]:.3f}" if sums[1] > 0.0 else ""))
    rows.append(("whole", "", "", f"{1e6 * found.steady:.6g}", f"{1e6 * found.slip:.6g}", "", ""))
    columns = ("from, s", "rpm", "N", "steady", "slip", "planar", "planar/slip")
    print_rows(f"{log.name}, {name}: damage in millionths of the life, by level", columns, rows)
