# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How many bearings one core holds: live models really run beside each other, each on its thread, as a node hosts them.

What ROS adds for each bearing is not in here (``python -m bearing_sim.ros.measure`` measures that).
"""

import math
import time
from typing import NamedTuple

from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.scene import Scene

_SAMPLE_RATE = 100.0  # Hz, the node's default
_INPUT_RATE = 100.0  # Hz
_REVIEWS = 20  # inputs from one review to the next: 5 Hz, as the node does
_SETTLING = 1.0  # [s] not counted: the start from ideal rolling costs more
_MAXIMUM_LAG = 0.2  # [s], the node's default
_LEAST_SHARE = 0.98  # of real time, below which it is lost
_FULL = 0.95  # of a core: the count that is tried first would take so much
_TRIES = 5


class FleetRun(NamedTuple):
    """What came of bearings that ran beside each other."""

    bearings: int
    core_seconds: float  # of the whole process, for each simulated second of a bearing [s]
    lost: float  # largest time that one of them has lost [s]
    real_time_factor: float  # least

    @property
    def holds(self) -> bool:
        """Whether all held real time."""
        return self.lost == 0.0 and self.real_time_factor > _LEAST_SHARE


def run_fleet(scene: Scene, bearings: int, seconds: float) -> FleetRun:
    """Run equal bearings in real time at their scene's operating conditions.

    Parameters
    ----------
    scene : of each.
    bearings : how many.
    seconds : how long, after a second that is not counted [s].
    """
    models = [LiveModel(scene, warmed_up(scene), time.time_ns(), _SAMPLE_RATE, _MAXIMUM_LAG) for _ in range(bearings)]
    try:
        _drive(models, _SETTLING)
        lost = [model.runner.pace.lost for model in models]
        times = [_simulated(model) for model in models]
        began, had = time.monotonic(), time.process_time()
        _drive(models, seconds)
        elapsed, spent = time.monotonic() - began, time.process_time() - had
        simulated = [_simulated(model) - before for model, before in zip(models, times)]
        given_up = max(model.runner.pace.lost - before for model, before in zip(models, lost))
        return FleetRun(bearings, spent / sum(simulated), given_up, min(simulated) / elapsed)
    finally:
        for model in models:
            model.close()


def most_bearings(scene: Scene, seconds: float) -> list[FleetRun]:
    """Return runs of one bearing, and of as many as that lets expect, fewer and fewer until all hold real time; the last is the answer.

    Parameters
    ----------
    scene : of each bearing.
    seconds : of each run [s].
    """
    runs = [run_fleet(scene, 1, seconds)]
    count = max(1, math.floor(_FULL / runs[0].core_seconds))
    for _ in range(_TRIES):
        if count <= 1:
            break
        runs.append(run_fleet(scene, count, seconds))
        if runs[-1].holds:
            return runs
        count = min(count - 1, math.floor(0.85 * count))
    return [*runs[1:], runs[0]]


def _simulated(model: LiveModel) -> float:
    """Return how far the model's shaft has turned, as time at its constant speed; what was given up is not in it."""
    sample = model.runner.newest
    return float(sample["shaft_angle"] / sample["shaft_speed"]) if sample is not None else 0.0


def _drive(models: list[LiveModel], seconds: float) -> None:
    """Send every model its constant inputs and review it, for a while."""
    start, beat = time.monotonic(), 0
    while time.monotonic() < start + seconds:
        for model in models:
            now_ns, inputs = time.time_ns(), model.gate.held
            model.offer("shaft_speed", (inputs.shaft_speed,), None, now_ns)
            model.offer("radial_load", (inputs.load_y, inputs.load_z), None, now_ns)
            if beat % _REVIEWS == 0:
                model.collect(now_ns)
        beat += 1
        time.sleep(max(0.0, start + beat / _INPUT_RATE - time.monotonic()))
