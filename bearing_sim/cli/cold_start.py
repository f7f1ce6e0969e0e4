# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim study cold-start``: a cold start over time, idling and then loaded."""

import math

import click

from bearing_sim.cli.options import allow_outside_option, json_option, option, picture_option, set_option
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    print_rows,
    progress_bar,
    quantity_of,
    seconds_of,
    warn_of_scene,
)
from bearing_sim.cli.results import Result, command, picture_into
from bearing_sim.scene.display import force, number


@command("cold-start")
@allow_outside_option
@click.argument("scene_name", metavar="[SCENE]", required=False)
@set_option
@option("--load", "loads", "Load while idling; can be repeated  [default: 5 and 30 % of the minimum load].", multiple=True, metavar="VALUE")
@option("--loaded", "Load afterwards  [default: 0.1 of the dynamic load rating].", metavar="VALUE")
@option("--idling", "Time under the first load.", default="1 h", metavar="S")
@option("--temperature", "Of all parts, the oil and the air at the start.", default="0 degC", metavar="VALUE")
@option("--rise", "Time in which the load rises, at most 10 s.", default="1 s", metavar="S")
@picture_option("Draw the courses", "-o", "--out")
@json_option
def cold_start(scene_name, overrides, loads, loaded, idling, temperature, rise, picture):
    """Follow SCENE from a cold start: it idles, its losses warm it, then the load comes, until it is near thermal equilibrium.

    Once from ideal rolling and once from a skid.  A second table says what the load does to the cage if it comes earlier, and to a warm machine that
    idles again: the largest sliding power of a contact, before and while the load rises.  Without SCENE: the NU 232 of a wind gearbox, in a bath.
    """
    from bearing_sim.scene.loader import load_scene
    from bearing_sim.studies.cold_start import DEFAULT_OVERRIDES, DEFAULT_SCENE, SHARES, cold_scene, draw_courses
    from bearing_sim.studies.cold_start import cold_start as follow

    kelvin, seconds = quantity_of("--temperature", temperature, "K"), seconds_of(idling, "--idling")
    rising = seconds_of(rise, "--rise")
    if not 1e-3 <= rising <= 10.0:
        raise UsageError(f"--rise {rise}: expected 1 ms to 10 s")
    newtons = [quantity_of("--load", each, "N") for each in loads]
    afterwards = None if loaded is None else quantity_of("--loaded", loaded, "N")
    for name, value in (*(("--load", each) for each in newtons), ("--loaded", afterwards)):
        if value is not None and not 0.0 < value <= 1e8:
            raise UsageError(f"{name} {value:g} N: expected more than 0 and at most 1e8 N")
    scene = load_scene(scene_name or DEFAULT_SCENE, [*(() if scene_name else DEFAULT_OVERRIDES), *overrides])
    scene = cold_scene(scene, kelvin)
    if not scene.operating.shaft_speed:
        raise UsageError("operating.shaft_speed: 0; a cold start is followed while the shaft turns: give a speed")
    warn_of_scene(scene, before_results=False)
    announce_compilation(scene, with_states=True)
    with progress_bar("cold start", len(newtons or SHARES)) as show:
        found = follow(scene, newtons, afterwards, seconds, kelvin, rising, show)
    if picture is not None:
        picture_into(picture, lambda draft: draw_courses(found, draft, f"{scene.name}: cold start from {kelvin - 273.15:g} °C"))
    return Result(
        _report(scene, found),
        lambda: [_print_course(scene, found, load) for load in dict.fromkeys(course.load for course in found.courses)],
        remarks=[str(picture.path)] if picture else [],
    )


def _report(scene, found) -> dict:
    from bearing_sim.model.sample import NODE_OBSERVABLES

    courses = [
        {
            **course._asdict(),
            "instants": [each._asdict() | {"temperatures": dict(zip(NODE_OBSERVABLES, each.temperatures))} for each in course.instants],
        }
        for course in found.courses
    ]
    return {"scene": scene.name, **found._asdict(), "courses": courses, "loadings": [each._asdict() for each in found.loadings]}


_SHOWN = 12  # instants of a course


def _print_course(scene, found, load) -> None:
    from bearing_sim.studies.cold_start import ROLLING, SKID

    share = f"{number(100 * load / found.minimum_load, 3)} % of the minimum load"
    title = f"{scene.name}: idling under {force(load)}, {share}, then {force(found.loaded)}"
    pair = {course.start: course for course in found.courses if course.load == load}
    skid, rolling = pair[SKID], pair[ROLLING]
    marked = {round(k * (len(skid.instants) - 1) / (_SHOWN - 1)) for k in range(_SHOWN)}
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
