# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim machine``: the contour that pre-deformation machining leaves."""

import math
from pathlib import Path

import click

from bearing_sim.commands.reporting import BadInput, picture_option, print_json, print_table, told_as_bad_input, told_file_faults


def _quantity(unit, meaning, minimum, maximum, shown_in):
    """Return a click callback that reads a text with a unit."""

    def read(context, option, text):
        from pydantic_core import PydanticCustomError

        from bearing_sim.quantity import Quantity

        if text is None:
            return None
        try:
            return Quantity(unit, meaning, minimum, maximum, shown_in).read(text)
        except PydanticCustomError as fault:
            raise BadInput(f"--{option.name.replace('_', '-')} {text}: {fault.message()}") from None

    return read


def _option(name, default, unit, meaning, minimum, maximum, shown_in):
    shown = {"default": default, "show_default": True} if default else {}
    read = _quantity(unit, meaning, minimum, maximum, shown_in)
    return click.option(f"--{name}", metavar="QUANTITY", callback=read, help=f"{meaning[0].upper()}{meaning[1:]}.", **shown)


@click.command()
@_option("pressure", "2.0 MPa", "Pa", "mean pressure on the arcs", 1e3, 1e9, "MPa")
@_option("arc-turn", "0 deg", "rad", "how far one arc is turned from its even place, phi_f", -math.pi / 2, math.pi / 2, "deg")
@_option("arc-width", "60 deg", "rad", "width of each pressed arc", 1e-3, math.pi, "deg")
@click.option("--arcs", default=3, show_default=True, type=click.IntRange(2, 12), help="Number of pressed arcs, one for each lobe.")
@_option("mean-radius", "35.8 mm", "m", "mean radius of the ring blank", 1e-3, 2.0, "mm")
@_option("width", "12 mm", "m", "width of the ring", 1e-4, 1.0, "mm")
@_option("pressed-width", None, "m", "width that the pressure acts on [default: the ring's]", 1e-4, 1.0, "mm")
@_option("thickness", "3.4 mm", "m", "equivalent thickness of the ring's section, ribs and all", 1e-5, 0.5, "mm")
@_option("modulus", "206 GPa", "Pa", "Young's modulus", 1e9, 1e12, "GPa")
@_option("low-radius", None, "m", "lowest radius of the finished raceway [default: 34.8625 mm, without --ground-radius]", 1e-3, 2.0, "mm")
@_option("ground-radius", None, "m", "radius that the pressed ring is ground to", 1e-3, 2.0, "mm")
@click.option("-o", "--out", type=click.Path(path_type=Path), metavar="CONTOUR.csv", help="Contour file for bearing.outer_raceway.contour_file.")
@picture_option("Draw the contour")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(
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
    picture,
    as_json,
):
    """Press a ring blank over even arcs, grind its raceway round, release it: what contour is left?

    The ring is a thin elastic one, computed by the Fourier series of the pressure.  Where it was pressed are the high points;
    without arc turn a low point is at 0 deg.  Turned pressures are rescaled until their resultant vanishes.
    """
    from bearing_sim.studies.machining import Pressing, RingSection, contour_text, machine

    if low_radius is not None and ground_radius is not None:
        raise BadInput("--low-radius and --ground-radius say the same thing twice; give one")
    if arcs * arc_width + abs(arc_turn) > 2 * math.pi:
        raise BadInput(f"--arc-width {math.degrees(arc_width):g} deg, {arcs} times and turned by {math.degrees(arc_turn):g} deg: the arcs overlap")
    if ground_radius is None and low_radius is None:
        low_radius = 34.8625e-3
    section, pressing = RingSection(mean_radius, width, thickness, modulus), Pressing(pressure, arc_turn, arc_width, arcs, pressed_width)
    with told_as_bad_input(ValueError):
        machined = machine(section, pressing, ground_radius=ground_radius, low_radius=low_radius)
    report = _report(section, pressing, machined)
    with told_file_faults():
        if out is not None:
            out.write_text(contour_text(machined, _about(section, pressing)))
        if picture is not None:
            from bearing_sim.studies.machining_picture import draw

            draw(picture, section, pressing, machined)
    if as_json:
        print_json({**report, "out": out and str(out), "picture": picture and str(picture)})
    else:
        _print(report, machined)
    if len(machined.lows) != arcs:
        click.echo(f"note: {len(machined.lows)} low points from {arcs} arcs: the turned arc has swallowed a lobe", err=True)


def _about(section, pressing) -> str:
    pressed = f"{pressing.arcs} arcs of {math.degrees(pressing.arc_width):g} deg at {1e-6 * pressing.pressure:g} MPa"
    ring = f"mean radius {1e3 * section.mean_radius:g} mm, equivalent thickness {1e3 * section.thickness:g} mm"
    return (
        f"raceway by pre-deformation machining: {pressed}, one turned by {math.degrees(pressing.arc_turn):g} deg\n"
        f"ring of {ring}, modulus {1e-9 * section.modulus:g} GPa"
    )


def _report(section, pressing, machined) -> dict:
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


def _print(report, machined) -> None:
    def points(kind):
        return ", ".join(f"{point['radius_mm']:.4f} mm at {point['angle_deg']:.1f} deg" for point in report[f"{kind}_points"])

    print_table(
        "raceway after release",
        [
            ("D-value, mean of highs less mean of lows", f"{report['d_value_mm']:.4f} mm"),
            ("roundness of the low points", f"{report['roundness_um']:.2f} um"),
            ("low points", points("low")),
            ("high points", points("high")),
            ("ground to", f"{report['ground_radius_mm']:.4f} mm under load"),
            ("pressures", ", ".join(f"{pressure:.4f}" for pressure in report["pressures_mpa"]) + " MPa"),
        ],
    )
