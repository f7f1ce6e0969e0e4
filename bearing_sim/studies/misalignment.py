# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a misaligned inner ring does to edges, tilts, skews and life, with and without a crown.

Each point is a run of level ``spatial`` after settling; the quasi-static balance by slices stands beside it.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import Simulation
from bearing_sim.studies.statics import Statics, statics

CROWNS = ("none", "iso_log")
_SAMPLES_PER_TURN = 20


class Misaligned(NamedTuple):
    """One crown at one misalignment: means over the time after settling, of the largest value at an instant where there are many."""

    crown: str
    misalignment: float  # [rad]
    slip: float
    inner_pressure: float  # largest of any slice [Pa]
    inner_edge_pressure: float  # largest of the rollers' end slices [Pa]
    outer_edge_pressure: float
    tilt: float  # largest inclination of a roller outwards [rad]
    skew: float  # largest along the orbit [rad]
    rating_life: float  # [h]
    lamina_life: float  # [h]
    still: Statics  # the same without motion of rollers against the cage


def misalign(
    name: str,
    overrides: Sequence[str],
    misalignments: Sequence[float],
    crowns: Sequence[str] = CROWNS,
    slices: int = 30,
    turns: tuple[float, float] = (50.0, 20.0),
    tell: Callable[[str], None] = print,
) -> list[Misaligned]:
    """Run a scene with each crown at each misalignment.

    Parameters
    ----------
    name, overrides : of the scene, as `bearing_sim.scene_file.load_scene` takes them.
    misalignments : tilts at which the inner ring is held, towards the scene's misalignment angle [rad].
    crowns : as the scene's ``bearing.roller.crown``.
    slices : of a roller.
    turns : of the cage before, and while, results are taken.
    tell : takes a line of progress.

    Raises
    ------
    SceneError
        The scene is faulty, or cannot be at level ``spatial``.
    ValueError
        The scene's shaft is at rest.
    IntegrationError
        A run did not come to its end.
    """
    found = []
    for crown in crowns:
        for misalignment in misalignments:
            tell(f"crown {crown}, {1e3 * misalignment:g} mrad")
            own = ("level=spatial", f"bearing.roller.crown={crown}", f"bearing.roller.slices={slices}", f"operating.misalignment={misalignment!r}")
            found.append(_run(load_scene(name, [*overrides, *own]), crown, misalignment, slices, turns))
    return found


def _run(scene, crown, misalignment, slices, turns):
    speed = 0.5 * abs(scene.operating.shaft_speed) * (1.0 - scene.bearing.diameter_ratio)
    if speed == 0.0:
        raise ValueError("operating.shaft_speed: 0; nothing tilts or skews at rest but by balance, which `bearing-sim loads` shows")
    run, turn = Simulation(scene), 2 * np.pi / speed
    run.advance(turns[0] * turn)
    block = run.advance(turns[1] * turn, samples=max(round(turns[1] * _SAMPLES_PER_TURN), 1))
    return Misaligned(
        crown,
        misalignment,
        *(float(block[name].mean()) for name in ("cage_slip", "inner_pressure", "inner_edge_pressure", "outer_edge_pressure")),
        *(float(np.abs(block[name]).max(axis=1).mean()) for name in ("roller_tilt", "roller_skew")),
        *(float(1.0 / np.mean(1.0 / block[name])) for name in ("rating_life", "lamina_life")),  # as damage adds up
        statics(scene, slices),
    )
