# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How results of level ``spatial`` settle as rollers are cut into more slices, and what the slices cost."""

import dataclasses
import time
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene import Scene
from bearing_sim.simulation import Simulation
from bearing_sim.studies.bench_problem import scaled_scene
from bearing_sim.studies.statics import statics

SLICES = (10, 20, 30, 50, 100, 200)
ROLLERS = (18, 36, 72, 144)
_RATE = 2000.0  # Hz, of samples
_PARTS = 6  # of a run, each timed by itself


class Sliced(NamedTuple):
    """Results with one number of slices; means over the time after settling."""

    slices: int
    slip: float  # mean cage slip
    inner_load: float  # mean of the largest load on the inner raceway [N]
    rating_life: float  # [h]
    lamina_life: float
    static_pressure: float  # largest Hertzian pressure of a slice in quasi-static balance [Pa]
    static_lamina_life: float  # [h]
    step_seconds: float  # processor time of a step
    real_time_factor: float


class Cost(NamedTuple):
    """Processor time of a step as a straight line over what there is more of."""

    counts: tuple[int, ...]
    step_seconds: tuple[float, ...]
    fixed: float  # [s]
    each: float  # [s]
    misfit: float  # largest departure from the line, relative


def by_slices(scene: Scene, settle: float, duration: float, counts: Sequence[int] = SLICES, tell: Callable[[str], None] = print) -> list[Sliced]:
    """Run a scene with each number of slices.

    Parameters
    ----------
    scene : of level ``spatial``.
    settle, duration : simulated before, and while, results are taken [s].
    counts : numbers of slices.
    tell : takes a line of progress.
    """
    found = []
    for count in counts:
        tell(f"{count} slices")
        cut = _cut(scene, count)
        block, step_seconds, factor = _timed(Simulation(cut), settle, duration)
        still = statics(cut, count)
        found.append(
            Sliced(
                count,
                float(block["cage_slip"].mean()),
                float(block["inner_load"].max(axis=1).mean()),
                *(float(1.0 / np.mean(1.0 / block[name])) for name in ("rating_life", "lamina_life")),  # as damage adds up
                max(still.inner_pressure, still.outer_pressure),
                still.lamina_life,
                step_seconds,
                factor,
            )
        )
    return found


def by_rollers(speed_rpm: float, settle: float, duration: float, counts: Sequence[int] = ROLLERS, tell: Callable[[str], None] = print) -> Cost:
    """Return what a step costs on bearings scaled to other numbers of rollers (see `bearing_sim.studies.bench_problem.scaled_scene`)."""
    seconds = []
    for count in counts:
        tell(f"{count} rollers")
        seconds.append(_timed(Simulation(scaled_scene("spatial", speed_rpm, count)), settle, duration)[1])
    return line(counts, seconds)


def line(counts: Sequence[int], seconds: Sequence[float]) -> Cost:
    """Fit a straight line with equal weights to relative departures."""
    matrix = np.stack([np.ones(len(counts)), np.asarray(counts, float)], axis=1) / np.asarray(seconds)[:, None]
    fixed, each = np.linalg.lstsq(matrix, np.ones(len(counts)), rcond=None)[0]
    misfit = np.abs(matrix @ (fixed, each) - 1.0).max()
    return Cost(tuple(counts), tuple(seconds), float(fixed), float(each), float(misfit))


def _cut(scene, count):
    roller = dataclasses.replace(scene.bearing.roller, slices=count)
    return dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, roller=roller))


def _timed(run, settle, duration):
    """Return samples after settling, processor time of a step, the best of some parts, and the real-time factor at that cost."""
    run.advance(settle)
    blocks, costs = [], []
    for _ in range(_PARTS):
        steps, start = run.counters.steps, time.process_time()
        blocks.append(run.advance(duration / _PARTS, samples=max(round(_RATE * duration / _PARTS), 1)))
        costs.append((time.process_time() - start) / (run.counters.steps - steps))
        mean_step = duration / _PARTS / (run.counters.steps - steps)
    return np.concatenate(blocks), min(costs), mean_step / min(costs)
