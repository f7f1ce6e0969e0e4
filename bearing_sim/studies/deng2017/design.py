# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The design question of Deng 2017: outer raceways with slip below 10 % and life above 300 h, compared with the paper's answer."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bearing_sim.files.outputs import replaced
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.deng2017.pictures import DENG_REGION, Pictured
from bearing_sim.studies.design import D_VALUE, LOW, NOMINAL, WORST, Border, Designed, Limits, default_axes, design, draw
from bearing_sim.sweep.conditions import Conditions
from bearing_sim.sweep.grid import Axis, axis
from bearing_sim.sweep.point import DURATION
from bearing_sim.sweep.table import write_table
from bearing_sim.sweep.tasks import Journal

SCENE, LOBES = "deng2017_table1", 3
SLIP_BELOW, LIFE_ABOVE = 10.0, 300.0  # %, h: at 45,000 rpm and 800 N
D_VALUES, RADII = DENG_REGION
BESIDE = ("recommended by Deng 2017", D_VALUES, RADII)
_LIMITS = Limits(SLIP_BELOW, LIFE_ABOVE, Conditions(speed_tolerance=0.02, load_tolerance=0.10))
_QUICK = ((LOW, (34.860e-3, 34.862e-3, 34.864e-3, 34.866e-3)), (D_VALUE, (0.09e-3, 0.1e-3, 0.11e-3)))


def answer(journal: Journal, quick: bool, workers: int | None = None, dask: str | None = None, overrides: Sequence[str] = ()) -> Designed:
    """Return the map of raceways at level steady.

    Parameters
    ----------
    journal : of finished raceways, which are not computed again.
    quick : use a coarse grid, for testing.
    workers, dask : see `bearing_sim.sweep.tasks.run_tasks`.
    overrides : of the scene.
    """
    overrides = [*overrides, "level=steady"]
    axes: Sequence[Axis] = [axis(*each) for each in _QUICK] if quick else default_axes(load_scene(SCENE, overrides))
    return design(SCENE, overrides, _LIMITS, *axes, journal, DURATION, workers, dask)


def radii_within(borders: Sequence[Border], d_values: tuple[float, float] = D_VALUES) -> tuple[float, float] | None:
    """Return the range of radii [mm] that meet the limits at every D value between two, interpolated linearly.

    None if there are none, or if the map has several regions at a D value or does not cover the D values.

    Parameters
    ----------
    borders : of one kind.
    d_values : the smallest and the largest D value [mm].
    """
    left, right = d_values
    ours = sorted(borders, key=lambda border: border.d_value)
    known = [border.d_value for border in ours]
    if not ours or len(set(known)) < len(known) or known[0] > left + 1e-9 or known[-1] < right - 1e-9:
        return None
    covered = [left, right, *(d for d in known if left < d < right)]
    low, high = (np.interp(covered, known, [getattr(border, end) for border in ours]) for end in ("low_from", "low_to"))
    return (round(float(low.max()), 6), round(float(high.min()), 6)) if low.max() <= high.min() else None


def write_answer(folder: Path, designed: Designed) -> Pictured:
    """Write the tables and the figure of an answer into the folders ``tables`` and ``figures``, and return the figure's entry."""
    write_table(folder / "tables" / "design", designed.grid)
    write_table(folder / "tables" / "design_borders", designed.border_table)
    with replaced(folder / "figures" / "design.png") as draft:
        draw(draft, designed, BESIDE)
    ranges = []
    for kind, when in ((NOMINAL, "at nominal speed and load"), (WORST, "with speeds within 2 % and loads within 10 %")):
        found = radii_within([border for border in designed.borders if border.kind == kind])
        ranges.append(f"{f'R_low = {found[0]:.4f} to {found[1]:.4f} mm' if found else 'no radius of the map'} {when}")
    (left, right), (low, high) = D_VALUES, RADII
    caption = f"Level steady, 45,000 rpm and 800 N. At every D from {left} to {right} mm, slip is below {SLIP_BELOW:g} % and "
    caption += f"life above {LIFE_ABOVE:g} h for {' and '.join(ranges)}. Black: Deng's answer, {low:.4f} to {high:.4f} mm."
    return Pictured("design.png", "The design question: slip below 10 % and life above 300 h", caption, ("design", "design_borders"))
