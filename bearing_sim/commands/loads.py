# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""``bearing-sim loads``: how a scene's load spreads over its rollers and along them."""

import math

import click

from bearing_sim.commands.reporting import FailedRun, picture_option, print_json, print_table, tell_compilation, told_as_bad_input, told_file_faults


@click.command()
@click.argument("scene_name", metavar="SCENE")
@click.option("--set", "overrides", multiple=True, metavar="FIELD=VALUE", help="Override a field of the scene; may be repeated.")
@click.option(
    "--slices", default=40, show_default=True, type=click.IntRange(5, 400), metavar="N", help="Slices of a roller (ISO/TS 16281: 30 or more)."
)
@picture_option("Draw the loads")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
def command(scene_name, overrides, slices, picture, as_json):
    """Show the quasi-static load distribution of SCENE at its constant conditions, the cage without slip, roller 0 on the load line.

    A crown, a moment or a misalignment needs --set level=spatial, or that level in the scene.
    """
    from bearing_sim.scene_file import SceneError, load_scene

    with told_as_bad_input(SceneError):
        scene = load_scene(scene_name, overrides)
    tell_compilation()
    from bearing_sim.studies.statics import statics

    try:
        found = statics(scene, slices)
    except ArithmeticError as fault:
        raise FailedRun(str(fault)) from None
    if picture is not None:
        from bearing_sim.studies.statics_picture import draw

        operating = scene.operating
        with told_file_faults():
            draw(picture, f"{scene.name}: {operating.radial_load:g} N, {operating.shaft_speed * 30 / math.pi:.6g} rpm", found)
    if as_json:
        print_json({**_report(scene, slices, found), "picture": picture and str(picture)})
    else:
        _print(scene, slices, found)


def _report(scene, slices, found) -> dict:
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
        "life_hours": found.rating_life,
        "lamina_life_hours": found.lamina_life,
        "modified_life_hours": found.modified_life,
        "viscosity_ratio": found.viscosity_ratio,
        "contamination_factor": found.contamination_factor,
        "azimuths_deg": [math.degrees(azimuth) for azimuth in found.azimuths],
        "inner_loads": found.inner.tolist(),
        "outer_loads": found.outer.tolist(),
        "roller_tilts_mrad": [1e3 * tilt for tilt in found.tilts.tolist()],
        "slice_middles_mm": [1e3 * place for place in found.places.tolist()],
        "inner_slice_loads": found.inner_slices.tolist(),
        "outer_slice_loads": found.outer_slices.tolist(),
    }


def _print(scene, slices, found) -> None:
    import numpy as np

    def lean(amount, azimuth, unit):
        return f"{amount:.6g} {unit}, +x end towards {round(math.degrees(azimuth), 1) + 0.0:g} deg" if amount > 1e-9 else "none"

    operating = scene.operating
    oil = f"kappa {found.viscosity_ratio:.3g}"
    if not math.isnan(found.contamination_factor):
        oil += f", e_C {found.contamination_factor:.3g} ({scene.life.a_iso})"
    held = "free" if operating.moment is not None else "held"
    print_table(
        f"{scene.name}: {operating.radial_load:g} N at {operating.shaft_speed * 30 / math.pi:.6g} rpm, {slices} slices",
        [
            ("loaded rollers", f"{int((found.inner > 0).sum())} of {len(found.inner)}"),
            ("largest roller load", f"inner {found.inner.max():.6g} N, outer {found.outer.max():.6g} N"),
            ("largest pressure of a slice", f"inner {1e-6 * found.inner_pressure:.4g} MPa, outer {1e-6 * found.outer_pressure:.4g} MPa"),
            ("ring displacement", "y {:.6g} um, z {:.6g} um".format(*(round(1e6 * place, 6) + 0.0 for place in found.ring))),
            (f"ring tilt ({held})", lean(1e3 * found.tilt[0], found.tilt[1], "mrad")),
            ("moment on the ring", lean(found.moment[0], found.moment[1], "N m")),
            ("basic rating life, whole rollers", _hours(found.rating_life)),
            ("lamina life, with stress risers", _hours(found.lamina_life)),
            (f"modified life, {100 * scene.life.reliability:g} % reliable", f"{_hours(found.modified_life)}; {oil}"),
        ],
    )
    rows = []
    for j in np.flatnonzero(found.inner > 0):
        along, tilt = found.inner_slices[j], round(1e3 * found.tilts[j], 6) + 0.0
        carried = f"inner {found.inner[j]:.6g} N (slices {along.min():.4g} to {along.max():.4g} N), outer {found.outer[j]:.6g} N"
        rows.append((f"{j}: {math.degrees(found.azimuths[j]):.0f} deg", f"{carried}, tilt {tilt:.3g} mrad"))
    print_table("rollers between both rings", rows)


def _hours(life) -> str:
    return f"{life:.4g} h" if math.isfinite(life) else "endless"
