# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study slices``: how results settle with the number of slices, and what slices and rollers cost."""

import click

from bearing_sim.commands.reporting import FailedRun, print_json, print_rows, progress_bar, tell_compilation, told_as_bad_input


@click.command()
@click.argument("scene_name", metavar="[SCENE]", default="deng2017_table1")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option("--settle", default=0.15, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated before results are taken.")
@click.option("--duration", default=0.06, show_default=True, type=click.FloatRange(min=1e-6), metavar="S", help="Simulated while they are.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, overrides, settle, duration, as_json):
    """Run SCENE at level spatial with 10 to 200 slices, and bearings of 18 to 144 rollers, and measure what a step costs."""
    import math

    from bearing_sim.scene_file import SceneError, load_scene
    from bearing_sim.simulation import IntegrationError

    with told_as_bad_input(SceneError):
        scene = load_scene(scene_name, [*overrides, "level=spatial"])
    tell_compilation()
    from bearing_sim.studies.slices import ROLLERS, SLICES, by_rollers, by_slices, line

    runs = len(SLICES) + len(ROLLERS)
    done = iter(range(runs + 1))
    with progress_bar("runs", runs) as show:
        try:
            found = by_slices(scene, settle, duration, tell=lambda name: show(next(done)))
            rpm = abs(scene.operating.shaft_speed) * 30 / math.pi
            rollers = by_rollers(rpm, settle / 10, duration / 3, tell=lambda name: show(next(done)))
        except IntegrationError as fault:
            raise FailedRun(str(fault)) from None
    costs = {"slices": line([one.slices for one in found], [one.step_seconds for one in found]), "rollers": rollers}
    if as_json:
        print_json({"scene": scene_name, "runs": [one._asdict() for one in found], "cost": {name: cost._asdict() for name, cost in costs.items()}})
    else:
        _print(scene_name, found, costs)


def _print(name, found, costs) -> None:
    columns = ("slices", "slip, %", "largest load, N", "life, h", "by slices, h", "static: MPa", "by slices, h", "us a step", "x real time")
    rows = []
    for one in found:
        lives = [format(value, ".4g") for value in (one.inner_load, one.rating_life, one.lamina_life)]
        still = f"{1e-6 * one.static_pressure:.5g}", f"{one.static_lamina_life:.4g}"
        rows.append((str(one.slices), f"{100 * one.slip:.4g}", *lives, *still, f"{1e6 * one.step_seconds:.3g}", f"{one.real_time_factor:.3g}"))
    print_rows(f"{name}: results by number of slices", columns, rows)
    for what, cost in costs.items():
        steps = ", ".join(f"{count}: {1e6 * seconds:.3g}" for count, seconds in zip(cost.counts, cost.step_seconds))
        told = f"{1e6 * cost.fixed:.3g} + {1e6 * cost.each:.3g} a piece, within {100 * cost.misfit:.2g} %"
        click.echo(f"us a step by {what}: {steps}; a straight line {told}")
