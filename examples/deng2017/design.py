# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The design question of Deng 2017: outer raceways with slip below 10 % and life above 300 h, compared with the paper's answer."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.files.outputs import replaced
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.design import (
    D_VALUE,
    END_OF_MAP,
    KINDS,
    LOW,
    STATE,
    Border,
    Designed,
    Limits,
    condition_name,
    default_axes,
    design,
    plot_design,
)
from bearing_sim.sweep.conditions import Conditions
from bearing_sim.sweep.grid import Axis, axis
from bearing_sim.sweep.point import DURATION
from bearing_sim.sweep.table import write_table
from bearing_sim.sweep.tasks import Execution, Journal
from deng2017.pictures import DENG_REGION, Pictured

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
    return design(SCENE, overrides, _LIMITS, *axes, DURATION, Execution(journal, workers, dask))


class Within(NamedTuple):
    """The radii that meet the limits at every D value between two.

    Attributes
    ----------
    low_from, low_to : the ends [mm]; None where there are none.
    text : them in words, or why there are none; says where the map ends before the limit does.
    """

    low_from: float | None
    low_to: float | None
    text: str


def radii_within(borders: Sequence[Border], mapped: Sequence[float], d_values: tuple[float, float] = D_VALUES) -> Within:
    """Return the range of radii [mm] that meet the limits at every D value between two, interpolated linearly.

    Parameters
    ----------
    borders : of one kind.
    mapped : all D values of the map [mm].
    d_values : the smallest and the largest D value [mm].
    """
    (left, right), known = d_values, sorted(set(mapped))
    if known[0] > left + 1e-9 or known[-1] < right - 1e-9:
        return Within(None, None, f"unknown, because the map ends at D = {known[0]:.4f} and {known[-1]:.4f} mm: the limit may lie beyond it")
    first, last = (max(d for d in known if d <= left + 1e-9), min(d for d in known if d >= right - 1e-9))
    needed, by_d_value = [d for d in known if first <= d <= last], {}
    for border in borders:
        by_d_value.setdefault(border.d_value, []).append(border)
    if missing := [f"{d:.4f}" for d in needed if d not in by_d_value]:
        return Within(None, None, f"none in the map, because no raceway meets both limits at D = {', '.join(missing)} mm")
    if several := [f"{d:.4f}" for d in needed if len(by_d_value[d]) > 1]:
        return Within(None, None, f"several intervals at D = {', '.join(several)} mm, see the table")
    ours, covered = [by_d_value[d][0] for d in needed], [left, right, *(d for d in needed if left < d < right)]

    def ends(end: str, by: str) -> tuple[np.ndarray, np.ndarray]:
        """Return an end of the interval at each D value, and whether the map ends there."""
        at = np.interp(covered, needed, [getattr(border, end) for border in ours])
        return at, np.interp(covered, needed, [getattr(border, by) == END_OF_MAP for border in ours]) > 0.0

    (lows, opens_below), (highs, opens_above) = ends("low_from", "below_by"), ends("low_to", "above_by")
    low, high = round(float(lows.max()), 6), round(float(highs.min()), 6)
    is_open = [f"{radius:.5f} mm" for radius, opens in ((low, opens_below[lows.argmax()]), (high, opens_above[highs.argmin()])) if opens]
    beyond = f"; the map ends at R_low = {' and '.join(is_open)}, where raceways meet both limits: the limit lies beyond it" if is_open else ""
    if low > high:
        return Within(None, None, f"none in the map{beyond}")
    return Within(low, high, f"R_low {low:.5f} to {high:.5f} mm{beyond}")


def write_answer(folder: Path, designed: Designed) -> Pictured:
    """Write the tables and the figure of an answer into the folders ``tables`` and ``figures``, and return the figure's entry."""
    write_table(folder / "tables" / "design", designed.grid)
    write_table(folder / "tables" / "design_borders", designed.border_table)
    with replaced(folder / "figures" / "design.png") as draft:
        plot_design(draft, designed, BESIDE)
    ranges, mapped = [], designed.grid.values(D_VALUE)
    for kind in KINDS:
        found = radii_within([border for border in designed.borders if border.kind == kind], mapped)
        ranges.append(f"{condition_name(kind, designed.grid.about['wanted'])}: {found.text}")
    (left, right), (low, high) = D_VALUES, RADII
    caption = f"Level steady, 45,000 rpm and 800 N, {STATE}. Radii with slip below {SLIP_BELOW:g} % and "
    caption += f"life above {LIFE_ABOVE:g} h at every D from {left} to {right} mm: {'; '.join(ranges)}. Black: Deng's answer, "
    caption += f"{low:.4f} to {high:.4f} mm."
    return Pictured("design.png", "The design question: slip below 10 % and life above 300 h", caption, ("design", "design_borders"))
