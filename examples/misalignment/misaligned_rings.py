# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Misalignment study: edge pressure, tilt, skew and life under a misaligned inner ring, with and without a crown.

Each point is a settled run of level ``spatial``, shown with the quasi-static balance by slices.
"""

import itertools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.statics import Statics, statics
from bearing_sim.sweep.pictures import COLOURS, legend_below, look_of, new_figure, plain_numbers, save
from bearing_sim.sweep.settling import mean_life
from bearing_sim.sweep.thermal import simulation_in_equilibrium

CROWNS = ("none", "iso_log")
_SAMPLES_PER_TURN = 20


class Misaligned(NamedTuple):
    """Results of one crown at one misalignment: means over the time after settling, of the largest value at each instant for arrays."""

    crown: str
    misalignment: float  # [rad]
    slip: float
    inner_pressure: float  # largest of any lamina [Pa]
    inner_edge_pressure: float  # largest of the rollers' end laminae [Pa]
    outer_edge_pressure: float
    tilt: float  # largest inclination of a roller outwards [rad]
    skew: float  # largest along the orbit [rad]
    rating_life: float  # [h]
    l10r: float  # [h]
    still: Statics  # quasi-static balance without slip


def misalign(
    name: str,
    overrides: Sequence[str],
    misalignments: Sequence[float],
    crowns: Sequence[str] = CROWNS,
    slices: int = 30,
    turns: tuple[float, float] = (50.0, 20.0),
    progress: Callable[[int], None] = lambda done: None,
) -> list[Misaligned]:
    """Run a scene with each crown at each misalignment.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene.loader.load_scene` takes them.
    misalignments : tilts of the inner ring towards the scene's misalignment angle [rad].
    crowns : values of ``bearing.roller.crown``.
    slices : per roller of the quasi-static balance; laminae of the life and pressures in motion.
    turns : of the cage, before and during the averaging.
    progress : called with the number of finished points.

    Raises
    ------
    SceneError
        The scene is invalid, or cannot be computed at level ``spatial``.
    ValueError
        The shaft of the scene is at rest.
    IntegrationError
        A run stopped early.
    """
    found = []
    for crown, misalignment in itertools.product(crowns, misalignments):
        own = ("level=spatial", f"bearing.roller.crown={crown}", f"life.laminae={slices}", f"operating.misalignment={misalignment!r}")
        found.append(_run(load_scene(name, [*overrides, *own]), crown, misalignment, slices, turns))
        progress(len(found))
    return found


def _run(scene, crown, misalignment, slices, turns):
    speed = 0.5 * abs(scene.operating.shaft_speed) * (1.0 - scene.bearing.diameter_ratio)
    if speed == 0.0:
        raise ValueError("operating.shaft_speed: 0; this study needs a rotating shaft, for the balance at rest use `bearing-sim loads`")
    run, turn = simulation_in_equilibrium(scene), 2 * np.pi / speed
    run.advance(turns[0] * turn)
    block = run.advance(turns[1] * turn, samples=max(round(turns[1] * _SAMPLES_PER_TURN), 1))
    return Misaligned(
        crown,
        misalignment,
        *(float(block[name].mean()) for name in ("cage_slip", "inner_pressure", "inner_edge_pressure", "outer_edge_pressure")),
        *(float(np.abs(block[name]).max(axis=1).mean()) for name in ("roller_tilt", "roller_skew")),
        *(mean_life(block[name]) for name in ("rating_life", "l10r")),
        statics(scene, slices),
    )


def plot_misalignment(path: Path, title: str, found: list[Misaligned]) -> None:
    """Draw the results into a file; the suffix of ``path`` gives the format."""
    figure = new_figure(14, 8)
    axes = figure.subplots(2, 3).ravel()
    panels = (
        ("pressure of the end laminae, inner raceway [MPa]", lambda one: 1e-6 * one.inner_edge_pressure, lambda one: 1e-6 * _edge_pressure(one)),
        ("basic reference rating life L10r [h]", lambda one: one.l10r, lambda one: one.still.lives.l10r),
        ("cage slip [%]", lambda one: 100 * one.slip, None),
        ("largest tilt of a roller [mrad]", lambda one: 1e3 * one.tilt, lambda one: 1e3 * np.abs(one.still.tilts).max()),
        ("largest skew of a roller [mrad]", lambda one: 1e3 * one.skew, None),
    )
    for each, (label, moving, still) in zip(axes, panels):
        _over_misalignment(each, found, moving, still)
        each.set(xlabel="misalignment of the inner ring [mrad]", ylabel=label)
        each.set_ylim(-0.02 * each.dataLim.y1, 1.05 * each.dataLim.y1)  # marks at 0 are whole
        plain_numbers(each.yaxis)
        each.grid(alpha=0.3)
    _along(axes[-1], found)
    legend_below(figure, axes[0])
    save(figure, path, title)


def _edge_pressure(one):
    """Return the pressure of the end laminae in quasi-static balance [Pa], proportional to the square root of the slice load."""
    still = one.still
    return still.inner_pressure * np.sqrt(still.inner_slices[:, [0, -1]].max() / still.inner_slices.max())


def _over_misalignment(axes, found, moving, still):
    for k, crown in enumerate(dict.fromkeys(one.crown for one in found)):
        mine = [one for one in found if one.crown == crown]
        amounts = [1e3 * one.misalignment for one in mine]
        axes.plot(amounts, [moving(one) for one in mine], **look_of(k, ms=5, label=f"crown {crown}"))
        if still is not None:
            axes.plot(amounts, [still(one) for one in mine], "--", color=COLOURS[k], lw=1, label=f"crown {crown}, quasi-static, no slip")


def _along(axes, found):
    """Draw load per length along the most heavily loaded roller, at a medium misalignment."""
    amounts = sorted({one.misalignment for one in found})
    shown = amounts[len(amounts) // 3]
    for k, one in enumerate(one for one in found if one.misalignment == shown):
        still = one.still
        width = still.slice_middles[1] - still.slice_middles[0]
        heaviest = still.inner_slices[np.argmax(still.inner)]
        axes.plot(1e3 * still.slice_middles, 1e-3 * heaviest / width, **look_of(k, ms=3))
    title = f"most loaded roller, {1e3 * shown:g} mrad, quasi-static"
    axes.set(xlabel="along the roller, x [mm]", ylabel="load per length, inner raceway [N/mm]", title=title, ylim=(0, None))
    axes.grid(alpha=0.3)
