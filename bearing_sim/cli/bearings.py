# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim scenes``, ``loads`` and ``machine``: what is bundled, static load distributions, and machined raceways."""

import math

from click import IntRange

from bearing_sim.cli.options import Amount, json_option, option, picture_option, scene_options, verbose_option
from bearing_sim.cli.outputs import OutputFile
from bearing_sim.cli.reporting import (
    UsageError,
    announce_compilation,
    as_failed_run,
    as_usage_error,
    note,
    print_table,
    scene_of_point,
    warn_of_limits,
    warnings_report,
)
from bearing_sim.cli.results import Result, command


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
    announce_compilation()
    from bearing_sim.model.validity import outside
    from bearing_sim.studies.statics import statics
    from bearing_sim.sweep.grading import graded

    slices = slices or scene.life.laminae
    with as_failed_run(ArithmeticError):
        found = statics(scene, slices)
    warnings = graded(scene, outside(scene, found.sample), found.sample[0])

    def draw(draft):
        from bearing_sim.scene.display import quantity_text
        from bearing_sim.studies.statics import draw

        operating = (quantity_text(name, getattr(scene.operating, name)) for name in ("radial_load", "shaft_speed"))
        draw(draft, f"{scene.name}: {' at '.join(operating)}", found)

    return Result(
        {**_report_loads(scene, slices, found), **warnings_report(scene, warnings), "picture": None},
        lambda: _print_loads(scene, slices, found),
        draw,
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
    from bearing_sim.studies.sheet import CLEARANCES, clearance_of

    at = found.clearance
    return clearance_of(scene, dict(zip(CLEARANCES, (at.running, at.initial, at.fits, at.rotation, at.heat, at.contour))))


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
    return option(f"--{name}", f"{meaning}.", Amount(unit, minimum, maximum, shown_in), default=default, metavar="QUANTITY")


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
    out,
):
    """Compute the contour left by pressing a ring blank over even arcs, grinding its raceway round and releasing it.

    The ring is thin and elastic, computed by the Fourier series of the pressure.  The high points are where it was pressed; without
    --arc-turn a low point is at 0 deg.  Pressures of turned arcs are rescaled until their resultant vanishes.
    """
    from bearing_sim.studies.machining import Pressing, RingSection, contour_text, draw, machine

    if low_radius is not None and ground_radius is not None:
        raise UsageError("--low-radius and --ground-radius determine the same radius; give one of them")
    if arcs * arc_width + abs(arc_turn) > 2 * math.pi * (1.0 - 1e-9):  # without a gap the pressure is even, and no lobe is left
        widths = f"--arc-width {math.degrees(arc_width):g} deg, {arcs} times and turned by {math.degrees(arc_turn):g} deg"
        raise UsageError(f"{widths}: the arcs overlap, or leave no gap")
    if ground_radius is None and low_radius is None:
        low_radius = 34.8625e-3
    section, pressing = RingSection(mean_radius, width, thickness, modulus), Pressing(pressure, arc_turn, arc_width, arcs, pressed_width)
    with as_usage_error(ValueError):
        machined = machine(section, pressing, ground_radius=ground_radius, low_radius=low_radius)
    report = _report_machine(section, pressing, machined)
    if out is not None:
        out.write_text(contour_text(machined, _about(section, pressing)))
    lobes = f"note: {arcs} arcs give {len(machined.lows)} low points: the turned arc has removed a lobe"
    return Result(
        {**report, "out": out and str(out), "picture": None},
        lambda: _print_machine(report),
        lambda draft: draw(draft, section, pressing, machined),
        files=[out.path] if out is not None else [],
        after=(lambda: note(lobes)) if len(machined.lows) != arcs else None,
    )


def _about(section, pressing) -> str:
    pressed = f"{pressing.arcs} arcs of {math.degrees(pressing.arc_width):g} deg at {1e-6 * pressing.pressure:g} MPa"
    ring = f"mean radius {1e3 * section.mean_radius:g} mm, equivalent thickness {1e3 * section.thickness:g} mm"
    return (
        f"raceway by pre-deformation machining: {pressed}, one turned by {math.degrees(pressing.arc_turn):g} deg\n"
        f"ring of {ring}, modulus {1e-9 * section.modulus:g} GPa"
    )


def _report_machine(section, pressing, machined) -> dict:
    return {
        "pressures_mpa": [1e-6 * float(pressure) for pressure in pressing.pressures],
        "arc_centres_deg": [math.degrees(centre) for centre in pressing.centres],
        "mean_radius_mm": 1e3 * section.mean_radius,
        "thickness_mm": 1e3 * section.thickness,
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
