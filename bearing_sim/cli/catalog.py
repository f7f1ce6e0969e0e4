# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim catalog`` and ``new``: bearings by designation, and scenes from them."""

import math
from collections.abc import Iterator

import click
from click import Choice

from bearing_sim.cli.options import Amount, AmountRange, json_option, level_type, option, picture_option
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import UsageError, command_line, note, print_rows, print_table
from bearing_sim.cli.results import Result, command

_COLUMNS = ("designation", "d", "D", "B", "C [kN]", "C_0 [kN]", "C_u [kN]", "limiting speed [rpm]", "ratings by")
_WORDS = ("designation", "ratings by")


_RANGE = AmountRange("m", "a length such as 50mm, or a range such as 50mm:80mm", fewest=1)


def _range_option(name: str, meaning: str):
    return option(name, f"{meaning}: a length such as 50mm, or a range such as 50mm:80mm.", _RANGE, metavar="LENGTH")


def _above_option(name: str, unit: str, meaning: str, example: str):
    return option(name, f"{meaning} of at least this, such as {example}.", Amount(unit), metavar="QUANTITY")


@command("catalog")
@click.argument("designation", required=False)
@option("--type", "types", "Type, such as NU; can be repeated.", multiple=True, metavar="TYPE")
@option("--series", "series", "Dimension series, such as 2 or 23; can be repeated.", multiple=True, metavar="SERIES")
@_range_option("--bore", "Bore diameter d")
@_range_option("--outside", "Outside diameter D")
@_range_option("--width", "Width B")
@_above_option("--dynamic-rating-above", "N", "Basic dynamic load rating C", "70kN")
@_above_option("--static-rating-above", "N", "Basic static load rating C_0", "70kN")
@_above_option("--limiting-speed-above", "rad/s", "Limiting speed", "6000rpm")
@picture_option("Draw the bearing")
@json_option
def catalog(designation, types, series, bore, outside, width, dynamic_rating_above, static_rating_above, limiting_speed_above, picture):
    """List the cylindrical roller bearings of the catalogue, or show the one of DESIGNATION, such as "NU 210 ECP/C3".

    Options choose from the list.  Wherever a scene names a bearing, a designation may stand.
    """
    bounds = {"bore": bore, "outside": outside, "width": width}
    least = {"dynamic_rating": dynamic_rating_above, "static_rating": static_rating_above, "limiting_speed": limiting_speed_above}
    chosen = any((types, series, *bounds.values())) or any(value is not None for value in least.values())
    if designation is None:
        if picture is not None:
            raise UsageError("--picture draws one bearing; give its designation, such as: bearing-sim catalog 'NU 210' --picture nu210.png")
        return _list(types, series, bounds, least)
    if chosen:
        raise UsageError("options that choose from the list do not go with a designation; give one or the other")
    return _show(designation, picture)


def _list(types, series, bounds, least) -> Result:
    from bearing_sim.scene.designation import SERIES, TYPES

    _check_words("--type", types, TYPES)
    _check_words("--series", series, SERIES)
    kinds = {each.upper() for each in types}
    found = [row for row in _rows(kinds, series, bounds) if all(low is None or (row[name] or 0.0) >= low for name, low in least.items())]

    def show():
        if found:
            print_rows(f"{len(found)} bearings, lengths in mm", _COLUMNS, [_cells(row) for row in found], _WORDS)
        else:
            note("no bearing of the catalogue is like that; see bearing-sim catalog --help")

    return Result({"bearings": found}, show)


def _check_words(option: str, given, known) -> None:
    for each in given:
        if each.upper() not in known:
            raise UsageError(f"{option} {each}: expected one of {', '.join(known)}")


def _rows(kinds, series, bounds) -> Iterator[dict]:
    """Yield what the list shows of each bearing [SI] within the bounds; ratings that no maker prints follow from the dimensions."""
    from bearing_sim.scene.designation import designations
    from bearing_sim.scene.internal_dimensions import section_of
    from bearing_sim.scene.ratings import ratings_by_standards

    for each in designations():
        named, boundary = each.designation, each.boundary
        if kinds and named.type not in kinds or series and named.series not in series:
            continue
        if not all(_lies_within(getattr(boundary, name), ends) for name, ends in bounds.items()):
            continue
        rated, printed = each.ratings, each.ratings.dynamic is not None
        if not printed:
            inside = section_of(named)
            pitch_diameter = inside.inner_raceway + inside.roller_diameter
            rated = ratings_by_standards(inside.count, inside.roller_diameter, inside.roller_length, pitch_diameter)
        yield {
            "designation": named.text,
            "bore": boundary.bore,
            "outside": boundary.outside,
            "width": boundary.width,
            "dynamic_rating": rated.dynamic,
            "static_rating": rated.static,
            "fatigue_limit": rated.fatigue_limit,
            "limiting_speed": each.ratings.limiting_speed,
            "ratings_by": each.maker if printed else "ISO 281, estimated",
        }


def _lies_within(length: float, ends) -> bool:
    return ends is None or ends[0] - 1e-9 <= length <= ends[1] + 1e-9


def _cells(row) -> tuple[str, ...]:
    lengths = (f"{1e3 * row[name]:.5g}" for name in ("bore", "outside", "width"))
    forces = ("" if row[name] is None else f"{1e-3 * row[name]:.4g}" for name in ("dynamic_rating", "static_rating", "fatigue_limit"))
    speed = "" if row["limiting_speed"] is None else f"{row['limiting_speed'] * 30 / math.pi:.0f}"
    return row["designation"], *lengths, *forces, speed, row["ratings_by"]


def _show(designation: str, picture) -> Result:
    from bearing_sim.scene.loader import load_bearing
    from bearing_sim.studies.bearing_facts import draw, facts, rows

    bearing = load_bearing(designation)
    return Result(
        {**facts(bearing), "picture": None},
        lambda: print_table(bearing.designation or bearing.name, rows(bearing)),
        lambda draft: draw(draft, bearing),
        remarks=[] if picture else ["--picture bearing.png draws it; bearing-sim new writes a scene with it"],
    )


@command("new")
@click.argument("bearing", metavar="DESIGNATION")
@option("--oil", "Oil by name, such as 'ISO VG 68' or 'ISO VG 220 PAO'.", metavar="OIL")
@option("--grease", "Grease by name, instead of an oil.", metavar="GREASE")
@option("--supply", "How the lubricant gets in [default: oil_bath, or oil_jet where n d_m is 400,000 mm/min or more].", metavar="SUPPLY")
@option("--speed", "Shaft speed, such as 3000rpm.", required=True, metavar="QUANTITY")
@option("--load", "Radial load, such as 5kN.", required=True, metavar="QUANTITY")
@option("--temperature", "Temperature of bearing and oil, such as 70degC [default: computed from the losses].", metavar="QUANTITY")
@option("--level", "Level of fidelity.", level_type, default="slip")
@option(
    "--shaft",
    "What heats or cools the shaft behind the bearing [default: nothing does; a run says where that is unsafe].",
    Choice(["free", "motor", "gear", "cold"]),
)
@option("--mass", "Mass of shaft and rotor that moves with the inner ring [default: estimated].", metavar="QUANTITY")
@option("-o", "--out", "File to write [default: standard output].", OutputFile(), metavar="SCENE.yaml")
def new(bearing, oil, grease, supply, speed, load, temperature, level, shaft, mass, out):
    """Write the scene of a bearing by DESIGNATION in an oil or a grease, with a comment for every choice that was made for you.

    Then: bearing-sim run SCENE.yaml.
    """
    from bearing_sim.scene.errors import InvalidField, SceneError
    from bearing_sim.scene.new_scene import Wish, default_name, new_scene
    from bearing_sim.scene.quantity import Quantity

    if (oil is None) == (grease is None):
        raise UsageError("give --oil or --grease, such as --oil 'ISO VG 68'")
    if shaft is not None and temperature is not None:
        raise UsageError("--shaft is for temperatures that are computed; leave --temperature or --shaft out")
    lubricant = {"grease": grease} if oil is None else {"oil": oil}
    if supply is not None:
        lubricant["supply"] = {"law": supply}
    options, bare = (("--load", load, "N"), ("--temperature", temperature, "K"), ("--mass", mass, "kg")), []
    for name, given, unit in options:  # the loader asks for the unit of a speed
        if given is not None and (reason := Quantity(unit, "").why_unit_is_needed(given)):
            bare.append(InvalidField(name, "", reason))
    wish = Wish(bearing, lubricant, speed, load, temperature, level, mass, shaft)
    try:
        text, scene = new_scene(wish, default_name(out and out.path), command_line())
    except SceneError as error:
        raise SceneError(error.origin, (*bare, *error.errors)) from None
    if bare:
        raise SceneError("new scene", bare)
    if out is None:
        return Result({}, lambda: click.echo(text, nl=False))
    out.write_text(text)
    estimated = f"; {len(scene.bearing.estimated)} of its dimensions are estimated, see the comments" if scene.bearing.estimated else ""
    return Result({}, lambda: click.echo(f"{out} written{estimated}\nnext: bearing-sim run {out}"))
