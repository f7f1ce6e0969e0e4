# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Convergence of level ``spatial`` with the number of slices, and their cost."""

import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation
from bearing_sim.studies.statics import statics, with_slices
from bearing_sim.sweep.point import mean_life

SLICES = (10, 20, 30, 50, 100, 200)
_RATE = 2000.0  # Hz, of samples
_PARTS = 6  # of a run, each timed separately


class Sliced(NamedTuple):
    """Results with one number of slices; means over the time after settling."""

    slices: int
    slip: float  # mean cage slip
    inner_load: float  # mean of the largest load on the inner raceway [N]
    rating_life: float  # [h]
    l10r: float  # by laminae, whatever the number of slices [h]
    static_pressure: float  # largest Hertzian pressure of a slice in quasi-static balance [Pa]
    static_l10r: float  # by these slices [h]
    step_seconds: float  # processor time of a step
    real_time_factor: float


def by_slices(scene: Scene, settle: float, duration: float, counts: Sequence[int] = SLICES, progress: Callable[[str], None] = print) -> list[Sliced]:
    """Run a scene with each number of slices.

    Parameters
    ----------
    scene : of level ``spatial``.
    settle, duration : simulated time before and during the averaging [s].
    counts : numbers of slices.
    progress : called with a line of text for each run.
    """
    found = []
    for count in counts:
        progress(f"{count} slices")
        cut = with_slices(scene, count)
        block, step_seconds, factor = _timed(Simulation(cut), settle, duration)
        still = statics(cut, count)
        found.append(
            Sliced(
                count,
                float(block["cage_slip"].mean()),
                float(block["inner_load"].max(axis=1).mean()),
                *(mean_life(block[name]) for name in ("rating_life", "l10r")),
                max(still.inner_pressure, still.outer_pressure),
                still.lives.l10r,
                step_seconds,
                factor,
            )
        )
    return found


def _timed(run, settle, duration):
    """Return samples after settling, the processor time of a step (minimum over parts of the run), and the real-time factor."""
    run.advance(settle)
    blocks, costs = [], []
    for _ in range(_PARTS):
        steps, start = run.counters.steps, time.process_time()
        blocks.append(run.advance(duration / _PARTS, samples=max(round(_RATE * duration / _PARTS), 1)))
        costs.append((time.process_time() - start) / (run.counters.steps - steps))
        mean_step = duration / _PARTS / (run.counters.steps - steps)
    return np.concatenate(blocks), min(costs), mean_step / min(costs)
