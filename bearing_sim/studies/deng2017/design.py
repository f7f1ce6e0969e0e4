# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The design question of Deng 2017: which outer raceways keep slip below 10 % and life above 300 h, beside the paper's own answer."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.studies.deng2017_pictures import DENG_REGION, Pictured
from bearing_sim.studies.design import D_VALUE, LOW, NOMINAL, WORST, Border, Designed, Wanted, default_axes, design
from bearing_sim.studies.design_picture import draw
from bearing_sim.sweep.axis import Axis, axis
from bearing_sim.sweep.journal import Journal
from bearing_sim.sweep.point import DURATION
from bearing_sim.sweep.table import write_table

SCENE = "deng2017_table1"
SLIP_BELOW, LIFE_ABOVE = 10.0, 300.0  # %, h: at 45,000 rpm and 800 N
D_VALUES, RADII = DENG_REGION
BESIDE = ("recommended by Deng 2017", D_VALUES, RADII)
_WANTED = Wanted(SLIP_BELOW, LIFE_ABOVE, speed_tolerance=0.02, load_tolerance=0.10)
_QUICK = ((LOW, (34.860e-3, 34.862e-3, 34.864e-3, 34.866e-3)), (D_VALUE, (0.09e-3, 0.1e-3, 0.11e-3)))


def answer(journal: Journal, quick: bool, workers: int | None = None, dask: str | None = None) -> Designed:
    """Return the map of raceways at level steady.

    Parameters
    ----------
    journal : of finished raceways.
    quick : a coarse grid, to see that everything works.
    workers, dask : see `bearing_sim.sweep.executor.run_tasks`.
    """
    overrides = ["level=steady"]
    axes: Sequence[Axis] = [axis(*each) for each in _QUICK] if quick else default_axes(load_scene(SCENE, overrides))
    return design(SCENE, overrides, _WANTED, *axes, journal, DURATION, workers, dask)


def radii_within(borders: Sequence[Border], d_values: tuple[float, float] = D_VALUES) -> tuple[float, float] | None:
    """Return which radii meet the limits at every D value between two, linearly between those of the map, [mm].

    None where none do, or where the map has several stretches at a D value or does not reach so far.

    Parameters
    ----------
    borders : of one kind.
    d_values : the least and the largest D value [mm].
    """
    left, right = d_values
    ours = sorted(borders, key=lambda border: border.d_value)
    known = [border.d_value for border in ours]
    if not ours or len(set(known)) < len(known) or known[0] > left + 1e-9 or known[-1] < right - 1e-9:
        return None
    places = [left, right, *(d for d in known if left < d < right)]
    low, high = (np.interp(places, known, [getattr(border, end) for border in ours]) for end in ("low_from", "low_to"))
    return (round(float(low.max()), 6), round(float(high.min()), 6)) if low.max() <= high.min() else None


def write_answer(folder: Path, designed: Designed) -> Pictured:
    """Write the tables and the picture of an answer into the folders ``tables`` and ``figures``, and return what it shows."""
    write_table(folder / "tables" / "design", designed.grid)
    write_table(folder / "tables" / "design_borders", designed.border_table)
    draw(folder / "figures" / "design.png", designed, BESIDE)
    told = []
    for kind, when in ((NOMINAL, "at the scene's speed and load"), (WORST, "with speeds off by 2 % and loads by 10 %, either way,")):
        found = radii_within([border for border in designed.borders if border.kind == kind])
        told.append(f"{when} {f'R_low = {found[0]:.4f} to {found[1]:.4f} mm' if found else 'no radius of the map'}")
    (left, right), (low, high) = D_VALUES, RADII
    caption = f"Level steady, 45,000 rpm and 800 N. At every D from {left} to {right} mm, {' and '.join(told)} keeps slip below {SLIP_BELOW:g} % and "
    caption += f"life above {LIFE_ABOVE:g} h. Black: Deng's answer, {low:.4f} to {high:.4f} mm."
    return Pictured("design.png", "The design question: slip below 10 % and life above 300 h", caption, ("design", "design_borders"))
