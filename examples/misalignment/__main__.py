# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Edge pressure, tilt, skew and life against misalignment of the inner ring: ``python examples/misalignment``, from a checkout."""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "examples")]

from click import FloatRange, IntRange  # noqa: E402
from points import over_points, scene_or_paper, varied_scene  # noqa: E402

from bearing_sim.cli.options import option  # noqa: E402
from bearing_sim.cli.reporting import announce_compilation, as_usage_error, progress_bar  # noqa: E402
from bearing_sim.cli.results import command  # noqa: E402


@command("misalignment")
@scene_or_paper
@option("--largest", "Largest misalignment.", FloatRange(0.0, 20.0), default=3.0, metavar="MRAD")
@option("--points", "Number of misalignments, starting at 0.", IntRange(2, 1000), default=7)
@option("--crown", "crowns", "Value of bearing.roller.crown; can be repeated [default: none, iso_log].", multiple=True, metavar="LAW")
@option("--slices", "Laminae per roller for life and pressures (ISO/TS 16281: at least 30).", IntRange(5, 400), default=30)
@varied_scene
def misalignment(scene_name, overrides, largest, points, crowns, slices):
    """Run SCENE at level spatial with its inner ring held at increasing misalignments, with and without a crown."""
    import numpy as np

    announce_compilation()
    from misalignment.misaligned_rings import CROWNS, misalign, plot_misalignment

    crowns = crowns or CROWNS
    amounts = [round(float(each), 9) for each in 1e-3 * np.linspace(0.0, largest, points)]
    with progress_bar("points", points * len(crowns)) as show, as_usage_error(ValueError):
        found = misalign(scene_name, overrides, amounts, crowns, slices, progress=show)
    title = f"{' '.join([scene_name, *overrides])}: misalignment of the inner ring, {slices} laminae"
    return over_points(
        f"{scene_name}: misalignment of the inner ring, level spatial",
        ("crown", "misalignment [mrad]", "slip [%]", "largest [MPa]", "inner edge [MPa]", "outer edge [MPa]")
        + ("tilt [mrad]", "skew [mrad]", "life [h]", "L10r [h]", "L10r, no slip, h"),
        list(map(_row, found)),
        lambda draft: plot_misalignment(draft, title, found),
        {"scene": scene_name, "slices": slices},
        remarks=["pressures, tilt and skew: time average of the largest value at each instant; no slip: life by slices in quasi-static equilibrium"],
    )


def _row(one) -> dict:
    return {
        "crown": one.crown,
        "misalignment_mrad": 1e3 * one.misalignment,
        "slip_percent": 100 * one.slip,
        "inner_pressure_mpa": 1e-6 * one.inner_pressure,
        "inner_edge_pressure_mpa": 1e-6 * one.inner_edge_pressure,
        "outer_edge_pressure_mpa": 1e-6 * one.outer_edge_pressure,
        "tilt_mrad": 1e3 * one.tilt,
        "skew_mrad": 1e3 * one.skew,
        "life_hours": one.rating_life,
        "l10r_hours": one.l10r,
        "static_l10r_hours": one.still.lives.l10r,
    }


if __name__ == "__main__":
    misalignment()
