# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Convergence of level ``spatial`` with the number of slices, beside its quadrature along the rollers, and the cost of both."""

import dataclasses
import math
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.scene import Scene
from bearing_sim.studies.statics import statics
from bearing_sim.sweep.settling import mean_life
from bearing_sim.sweep.thermal import simulation_in_equilibrium

SLICES = (None, 10, 20, 30, 50, 100, 200)
_RATE = 2000.0  # Hz, of samples
_PARTS = 6  # of a run, each timed separately


class Sliced(NamedTuple):
    """Results with one number of slices, or by the quadrature; means over the time after settling."""

    slices: int | None  # None: the quadrature
    slip: float  # mean cage slip
    inner_load: float  # mean of the largest load on the inner raceway [N]
    rating_life: float  # [h]
    l10r: float  # by laminae, whatever the number of slices [h]
    edge_pressure: float  # mean of the largest of the rollers' end laminae on the inner raceway [Pa]
    static_pressure: float  # largest Hertzian pressure of a slice in quasi-static balance [Pa]; NaN of the quadrature
    static_l10r: float  # by these slices [h]; likewise
    step_seconds: float  # processor time of a step
    real_time_factor: float


def by_slices(
    scene: Scene, settle: float, duration: float, counts: Sequence[int | None] = SLICES, progress: Callable[[int], None] = lambda done: None
) -> list[Sliced]:
    """Run a scene with each number of slices.

    Parameters
    ----------
    scene : of level ``spatial``.
    settle, duration : simulated time before and during the averaging [s].
    counts : numbers of slices; None is the quadrature.
    progress : called with the number of finished runs.
    """
    found = []
    for count in counts:
        roller = dataclasses.replace(scene.bearing.roller, slices=count)
        cut = dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, roller=roller))
        block, step_seconds, factor = _timed(simulation_in_equilibrium(cut), settle, duration)
        still = (math.nan, math.nan) if count is None else _in_balance(statics(cut, count))
        found.append(
            Sliced(
                count,
                float(block["cage_slip"].mean()),
                float(block["inner_load"].max(axis=1).mean()),
                *(mean_life(block[name]) for name in ("rating_life", "l10r")),
                float(block["inner_edge_pressure"].mean()),
                *still,
                step_seconds,
                factor,
            )
        )
        progress(len(found))
    return found


def _in_balance(found):
    """Return the largest pressure [Pa] and the life by slices [h] of a quasi-static balance."""
    return max(found.inner_pressure, found.outer_pressure), found.lives.l10r


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
