# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bearings and scenes: ``scenes``, ``catalog``, ``new``, ``fields``, ``observables``, ``loads`` and ``machine``.

What is bundled, bearings by designation and scenes from them, what a scene and a sample hold, static load distributions, and machined raceways.
"""

import math
from collections.abc import Iterator

import click
from click import Choice, IntRange
from click.core import ParameterSource

from bearing_sim.cli.options import (
    Amount,
    AmountRange,
    allow_outside_option,
    json_option,
    level_type,
    option,
    picture_option,
    scene_options,
    verbose_option,
)
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    as_failed_run,
    as_usage_error,
    command_line,
    note,
    print_rows,
    print_table,
    scene_of,
    scene_of_point,
    warn_of_limits,
    warnings_report,
)
from bearing_sim.cli.results import Result, command

_COLUMNS = ("designation", "d", "D", "B", "C [kN]", "C_0 [kN]", "C_u [kN]", "limiting speed [rpm]", "ratings by")
_WORDS = ("designation", "ratings by")


_RANGE = AmountRange("m", "a length such as 50mm, or a range such as 50mm:80mm", fewest=1)


def _range_option(name: str, meaning: str):
    return option(name, f"{meaning}: a length such as 50mm, or a range such as 50mm:80mm.", _RANGE)


def _above_option(name: str, unit: str, meaning: str, example: str):
    return option(name, f"{meaning} of at least this, such as {example}.", Amount(unit))


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
            note("no bearing in the catalogue matches; see bearing-sim catalog --help")

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
    from bearing_sim.studies.bearing_facts import facts, plot_bearing, rows

    bearing = load_bearing(designation)
    return Result(
        {**facts(bearing), "picture": None},
        lambda: print_table(bearing.designation or bearing.name, rows(bearing)),
        lambda draft: plot_bearing(draft, bearing),
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


_FIELD_COLUMNS = ("field", "unit or kind", "default", "range", "meaning")


@command("fields")
@click.argument("path", required=False, default="", metavar="[PATH]")
@json_option
def fields(path):
    """Show the fields of a scene below PATH, such as lubricant or bearing.cage; without PATH the blocks of a scene.

    For each: the unit in which messages show it, or what else may stand there; its default; its range; what it means.  A file and --set take any
    unit of the kind.
    """
    from bearing_sim.scene.diameters import diameters
    from bearing_sim.scene.fields import blocks
    from bearing_sim.scene.scene import Scene
    from bearing_sim.scene.uncertainty import nearest

    path = path.strip().strip(".")
    everything = blocks(Scene)
    found = [each for each in everything if _place(each) == path or path and _place(each).startswith(f"{path}.")]
    if not found:  # a single field
        held = [each._replace(fields=tuple(fact for fact in each.fields if _bare(fact.path) == path)) for each in everything]
        found = [each for each in held if each.fields]
    if not found and (half := diameters(Scene).get(path)):
        raise UsageError(f"{path} is {half.quantity.meaning}; see: bearing-sim fields {half.radius}")
    if not found:
        known = dict.fromkeys(_bare(fact.path) for each in everything for fact in each.fields)
        raise UsageError(f"{path}: no field of a scene{nearest(path, known)}; bearing-sim fields lists the blocks")
    plain = [{"law": each.law or None, **_plain(fact._asdict())} for each in found for fact in each.fields]
    more = "bearing-sim fields BLOCK shows the fields of a block and of those within it, such as: bearing-sim fields lubricant.supply"
    return Result({"fields": plain}, lambda: list(map(_print_block, found if path else found[:1])), remarks=[] if path else [more])


@command("observables")
@click.argument("words", required=False, default="", metavar="[WORDS]")
@json_option
def observables(words):
    """List the observables that a sample holds, those whose name or meaning contains WORDS, or all: unit and meaning."""
    from bearing_sim.model.sample import OBSERVABLES

    found = [each for each in OBSERVABLES if words.casefold() in f"{each.name} {each.meaning}".casefold()]
    if not found:
        raise UsageError(f"no observable has {words!r} in its name or meaning; bearing-sim observables lists all")
    rows = [(each.name, each.unit or "1", f"{each.meaning}{'; of each roller' if each.per_roller else ''}") for each in found]
    columns = ("name", "unit", "meaning")
    return Result({"observables": [each._asdict() for each in found]}, lambda: print_rows("observables", columns, rows, words=columns))


def _bare(path: str) -> str:
    return path.replace("[]", "")


def _place(block) -> str:
    return _bare(block.path)


def _plain(fact: dict) -> dict:
    return {name: text.replace("`", "") for name, text in fact.items()}


def _print_block(block) -> None:
    """Print the fields of one block; texts of files stand between backticks in the documents, and without them here."""
    title = f"{block.path or 'scene'}" + (f" with law: {block.law}" if block.law else "")
    rows = [tuple(_plain(fact._replace(path=fact.path.rpartition(".")[2])._asdict()).values()) for fact in block.fields]
    if not rows:
        click.echo(f"{title}: no other fields\n")
        return
    print_rows(title, _FIELD_COLUMNS, rows, words=_FIELD_COLUMNS, keys=1)


@command("scenes")
@json_option
def scenes():
    """List the bundled scenes, bearings, oils, greases and CSV mappings."""
    from bearing_sim.scene.loader import catalog_names, load_scene, scene_names

    found = {"scenes": {name: load_scene(name).description for name in scene_names()}}
    found |= {kind: catalog_names(kind) for kind in ("bearings", "oils", "greases", "mappings")}

    def show():
        print_table("scenes", found["scenes"].items())
        print_table("catalog", [(kind, ", ".join(found[kind])) for kind in ("bearings", "oils", "greases", "mappings")])

    return Result(
        found, show, remarks=["any designation, such as NU 210 ECP/C3, is a bearing, too (bearing-sim catalog), and ISO VG 2 to 3200 are oils"]
    )


@command("loads")
@scene_options
@option("--slices", "Slices per roller, for their loads and the life [default: life.laminae of the scene].", IntRange(5, 400), metavar="N")
@picture_option("Draw the loads")
@verbose_option
@json_option
def loads(scene_name, overrides, slices, verbose):
    """Show the quasi-static load distribution of SCENE under its constant conditions, without cage slip and with roller 0 on the load line.

    With heat.law network the bearing is in thermal equilibrium, as in `bearing-sim run`; where there is none, the command fails and says why.
    A moment or a misalignment requires level spatial, in the scene or by --set level=spatial.
    """
    scene = scene_of_point(scene_name, overrides)
    announce_compilation(bends=scene.outer_ring_bends)
    from bearing_sim.model.validity import outside
    from bearing_sim.studies.statics import statics
    from bearing_sim.sweep.grading import graded

    slices = slices or scene.life.laminae
    with as_failed_run(ArithmeticError):
        found = statics(scene, slices)
    warnings = graded(scene, outside(scene, found.sample), found.sample[0])

    def plot(draft):
        from bearing_sim.scene.display import quantity_text
        from bearing_sim.studies.statics import plot_statics

        operating = (quantity_text(name, getattr(scene.operating, name)) for name in ("radial_load", "shaft_speed"))
        plot_statics(draft, f"{scene.name}: {' at '.join(operating)}", found)

    return Result(
        {**_report_loads(scene, slices, found), **warnings_report(scene, warnings), "picture": None},
        lambda: _print_loads(scene, slices, found),
        plot,
        after=lambda: warn_of_limits(scene, warnings, verbose),
    )


def _report_loads(scene, slices, found) -> dict:
    from bearing_sim.studies.sheet import temperatures

    return {
        "scene": scene.name,
        "slices": slices,
        "ring_displacement_um": [1e6 * place for place in found.ring],
        "ring_tilt_mrad": 1e3 * found.tilt[0],
        "ring_tilt_angle_deg": math.degrees(found.tilt[1]),
        "moment": found.moment[0],
        "moment_angle_deg": math.degrees(found.moment[1]),
        "loaded_rollers": int((found.inner > 0).sum()),
        "inner_load_maximum": float(found.inner.max()),
        "outer_load_maximum": float(found.outer.max()),
        "inner_pressure_maximum_mpa": 1e-6 * found.inner_pressure,
        "outer_pressure_maximum_mpa": 1e-6 * found.outer_pressure,
        "equivalent_loads": list(found.equivalent_loads),
        **_clearance(scene, found),
        **temperatures(found.sample[0]),
        **_lives(scene, slices, found),
        "azimuths_deg": [math.degrees(azimuth) for azimuth in found.azimuths],
        "inner_loads": found.inner.tolist(),
        "outer_loads": found.outer.tolist(),
        "roller_tilts_mrad": [1e3 * tilt for tilt in found.tilts.tolist()],
        "slice_middles_mm": [1e3 * middle for middle in found.slice_middles.tolist()],
        "inner_slice_loads": found.inner_slices.tolist(),
        "outer_slice_loads": found.outer_slices.tolist(),
    }


def _lives(scene, slices, found) -> dict:
    from bearing_sim.studies.sheet import report_of

    renamed = {"rating_life": found.lives.basic, "modified_rating_life": found.lives.modified}
    return report_of(scene, found.lives._asdict() | renamed, found.film) | {"laminae": slices}


def _clearance(scene, found) -> dict:
    from bearing_sim.studies.sheet import clearance_report

    return clearance_report(scene, found.sample)


def _print_loads(scene, slices, found) -> None:
    import numpy as np

    from bearing_sim.scene.display import force, number
    from bearing_sim.studies.sheet import axial_rows, clearance_text, life_rows, temperatures, temperatures_text

    def lean(amount, azimuth, unit):
        return f"{number(amount)} {unit}, +x end towards {number(round(math.degrees(azimuth), 1))}°" if amount > 1e-9 else "none"

    operating, pressures = scene.operating, (found.inner_pressure, found.outer_pressure)
    lives = _lives(scene, slices, found)
    held = "free" if operating.moment is not None else "held"
    print_table(
        f"{scene.name}: {force(operating.radial_load)} at {number(operating.shaft_speed * 30 / math.pi, 6)} rpm, {slices} slices",
        [
            ("loaded rollers", f"{int((found.inner > 0).sum())} of {len(found.inner)}"),
            ("largest roller load", f"inner raceway {force(found.inner.max())}, outer raceway {force(found.outer.max())}"),
            ("largest slice pressure", "inner raceway {} MPa, outer raceway {} MPa".format(*(number(1e-6 * each) for each in pressures))),
            ("ring displacement", "y {} µm, z {} µm".format(*(number(round(1e6 * place, 6)) for place in found.ring))),
            (f"ring tilt ({held})", lean(1e3 * found.tilt[0], found.tilt[1], "mrad")),
            ("moment on the ring", lean(found.moment[0], found.moment[1], "N m")),
            ("running clearance", clearance_text(scene, _clearance(scene, found))),
            *([("temperatures", warmth)] if (warmth := temperatures_text(temperatures(found.sample[0]))) else []),
            *life_rows(scene, lives),
            *axial_rows(scene, lives | {"axial_load": operating.axial_load, "radial_load": operating.radial_load}),
            ("static safety", f"S_0 {number(lives['static_safety'], 3)}"),
            ("lubrication", f"kappa {number(lives['viscosity_ratio'], 3)}, least film {number(lives['film_um'], 3)} µm"),
        ],
    )
    rows = []
    for j in np.flatnonzero(found.inner > 0):
        along, tilt = found.inner_slices[j], round(1e3 * found.tilts[j], 6) + 0.0
        carried = f"inner {force(found.inner[j])} (slices {number(along.min(), 3)} to {number(along.max(), 3)} N), outer {force(found.outer[j])}"
        rows.append((f"{j}: {math.degrees(found.azimuths[j]):.0f}°", f"{carried}, tilt {number(tilt, 3)} mrad"))
    print_table("rollers between both rings", rows)


def _option(name, default, unit, meaning, minimum, maximum, shown_in):
    return option(f"--{name}", f"{meaning}.", Amount(unit, minimum, maximum, shown_in), default=default)


@command("machine")
@_option("pressure", "2.0 MPa", "Pa", "Mean pressure on the arcs", 1e3, 1e9, "MPa")
@_option("arc-turn", "0 deg", "rad", "Angle by which one arc is turned from its even position, phi_f", -math.pi / 2, math.pi / 2, "deg")
@_option("arc-width", "60 deg", "rad", "Width of each pressed arc", 1e-3, math.pi, "deg")
@option("--arcs", "Number of pressed arcs, one per lobe.", IntRange(2, 12), default=3)
@_option("mean-radius", "35.8 mm", "m", "Mean radius of the ring blank", 1e-3, 2.0, "mm")
@_option("width", "12 mm", "m", "Width of the ring", 1e-4, 1.0, "mm")
@_option("pressed-width", None, "m", "Width that the pressure acts on [default: the ring's]", 1e-4, 1.0, "mm")
@_option("thickness", "3.4 mm", "m", "Equivalent thickness of the ring's section, including ribs", 1e-5, 0.5, "mm")
@_option("modulus", "206 GPa", "Pa", "Young's modulus", 1e9, 1e12, "GPa")
@_option("low-radius", None, "m", "Smallest radius of the finished raceway [default: 34.8625 mm unless --ground-radius is given]", 1e-3, 2.0, "mm")
@_option("ground-radius", None, "m", "Radius to which the pressed ring is ground", 1e-3, 2.0, "mm")
@option("--scene", "scene_name", "Scene whose outer ring is machined: its section and modulus, unless they are given.", metavar="SCENE")
@allow_outside_option
@option("-o", "--out", "Contour file for bearing.outer_raceway.contour_file.", OutputFile(), metavar="CONTOUR.csv")
@picture_option("Draw the contour")
@json_option
def machine(
    pressure,
    arc_turn,
    arc_width,
    arcs,
    mean_radius,
    width,
    pressed_width,
    thickness,
    modulus,
    low_radius,
    ground_radius,
    scene_name,
    out,
):
    """Compute the contour left by pressing a ring blank over even arcs, grinding its raceway round and releasing it.

    The ring is thin and elastic, computed by the Fourier series of the pressure.  The high points are where it was pressed; without
    --arc-turn a low point is at 0 deg.  Pressures of turned arcs are rescaled until their resultant vanishes.
    """
    from bearing_sim.studies.machining import Blank, Pressing, contour_text, machine, plot_machined

    if low_radius is not None and ground_radius is not None:
        raise UsageError("--low-radius and --ground-radius determine the same radius; give one of them")
    if arcs * arc_width + abs(arc_turn) > 2 * math.pi * (1.0 - 1e-9):  # without a gap the pressure is even, and no lobe is left
        widths = f"--arc-width {math.degrees(arc_width):g} deg, {arcs} times and turned by {math.degrees(arc_turn):g} deg"
        raise UsageError(f"{widths}: the arcs overlap, or leave no gap")
    if ground_radius is None and low_radius is None:
        low_radius = 34.8625e-3
    given = {"mean_radius": mean_radius, "width": width, "thickness": thickness, "modulus": modulus}
    blank = Blank(**given | ({} if scene_name is None else _section_of(scene_name)))
    pressing = Pressing(pressure, arc_turn, arc_width, arcs, pressed_width)
    with as_usage_error(ValueError):
        machined = machine(blank, pressing, ground_radius=ground_radius, low_radius=low_radius)
    report = _report_machine(blank, pressing, machined)
    if out is not None:
        out.write_text(contour_text(machined, _about(blank, pressing)))
    lobes = f"note: {arcs} arcs give {len(machined.lows)} low points: the turned arc has removed a lobe"
    return Result(
        {**report, "out": out and str(out), "picture": None},
        lambda: _print_machine(report),
        lambda draft: plot_machined(draft, blank, pressing, machined),
        files=[out.path] if out is not None else [],
        after=(lambda: note(lobes)) if len(machined.lows) != arcs else None,
    )


def _section_of(scene_name: str) -> dict[str, float]:
    """Return what a scene says of the ring to be machined, but for what the command line gives."""
    from bearing_sim.scene.outer_ring import ring_geometry

    bearing, context = scene_of(scene_name, ()).bearing, click.get_current_context()
    section = ring_geometry(bearing)
    known = {"mean_radius": section.radius, "width": section.width, "thickness": section.equivalent_thickness}
    known["modulus"] = bearing.material.youngs_modulus
    return {name: value for name, value in known.items() if context.get_parameter_source(name) is ParameterSource.DEFAULT}


def _about(blank, pressing) -> str:
    pressed = f"{pressing.arcs} arcs of {math.degrees(pressing.arc_width):g} deg at {1e-6 * pressing.pressure:g} MPa"
    ring = f"mean radius {1e3 * blank.mean_radius:g} mm, equivalent thickness {1e3 * blank.thickness:g} mm"
    return (
        f"raceway by pre-deformation machining: {pressed}, one turned by {math.degrees(pressing.arc_turn):g} deg\n"
        f"ring of {ring}, modulus {1e-9 * blank.modulus:g} GPa"
    )


def _report_machine(blank, pressing, machined) -> dict:
    return {
        "pressures_mpa": [1e-6 * float(pressure) for pressure in pressing.pressures],
        "arc_centres_deg": [math.degrees(centre) for centre in pressing.centres],
        "mean_radius_mm": 1e3 * blank.mean_radius,
        "thickness_mm": 1e3 * blank.thickness,
        "ground_radius_mm": 1e3 * machined.ground_radius,
        "low_radius_mm": 1e3 * float(machined.lows[:, 1].min()),
        "d_value_mm": 1e3 * machined.d_value,
        "roundness_um": 1e6 * machined.roundness,
        **{
            f"{kind}_points": [{"angle_deg": math.degrees(angle), "radius_mm": 1e3 * float(radius)} for angle, radius in points]
            for kind, points in (("low", machined.lows), ("high", machined.highs))
        },
    }


def _print_machine(report) -> None:
    def points(kind):
        return ", ".join(f"{point['radius_mm']:.4f} mm at {point['angle_deg']:.1f}°" for point in report[f"{kind}_points"])

    print_table(
        "raceway after release",
        [
            ("D value, mean of highs minus mean of lows", f"{report['d_value_mm']:.4f} mm"),
            ("roundness of the low points", f"{report['roundness_um']:.2f} µm"),
            ("low points", points("low")),
            ("high points", points("high")),
            ("ground to", f"{report['ground_radius_mm']:.4f} mm under load"),
            ("pressures", ", ".join(f"{pressure:.4f}" for pressure in report["pressures_mpa"]) + " MPa"),
        ],
    )
