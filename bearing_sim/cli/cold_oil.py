# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study cold-oil``: slip and skid load of an idling bearing over load, temperature and supply of oil."""

from bearing_sim.cli.options import json_option, option, picture_option, scene_options
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    as_usage_error,
    print_rows,
    quantity_of,
    scene_of,
    warn_of_scene,
)
from bearing_sim.cli.results import Result, command, picture_into
from bearing_sim.scene.display import force, number


@command("cold-oil")
@scene_options
@option("--supply", "supplies", "Supply of oil; can be repeated  [default: oil_bath, circulating, oil_jet].", multiple=True)
@option("--temperature", "temperatures", "Oil temperature; can be repeated  [default: 0 to 80 °C].", multiple=True, metavar="VALUE")
@option("--load", "loads", "Radial load; can be repeated  [default: 0.08 to 3 times the minimum load].", multiple=True, metavar="VALUE")
@picture_option("Draw the map")
@json_option
def cold_oil(scene_name, overrides, supplies, temperatures, loads, picture):
    """Map the slip of SCENE over load and oil temperature, from ideal rolling and from a skid, by supply of oil.

    Says below which load a skid lasts, and where a skid depends on how fast the shaft runs up. All parts are as warm as the oil.
    """
    from bearing_sim.simulation import IntegrationError
    from bearing_sim.studies.cold_oil import SUPPLIES, TEMPERATURES, draw_map, run_ups, skid_map

    scene = scene_of(scene_name, overrides)
    if not scene.operating.shaft_speed:
        raise UsageError("operating.shaft_speed: 0; slip is mapped while the shaft turns: give a speed")
    warn_of_scene(scene, before_results=False)
    announce_compilation(scene, with_states=True)
    celsius = [round(quantity_of("--temperature", each, "K") - 273.15, 9) for each in temperatures] or TEMPERATURES
    newtons = [quantity_of("--load", each, "N") for each in loads]
    with as_usage_error(IntegrationError):
        found = skid_map(scene, supplies or SUPPLIES, celsius, newtons)
        run_up = run_ups(scene, found)
    parts = {"points": found.points, "skid_loads": found.skid_loads, "run_ups": run_up}
    report = {"scene": scene.name, "minimum_load": found.minimum_load}
    if picture is not None:
        picture_into(picture, lambda draft: draw_map(found, draft, f"{scene.name}: slip with cold oil"))
    return Result(
        report | {name: [one._asdict() for one in each] for name, each in parts.items()},
        lambda: _print(scene, found, run_up),
        remarks=[str(picture.path)] if picture else [],
    )


def _print(scene, found, run_up) -> None:
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
