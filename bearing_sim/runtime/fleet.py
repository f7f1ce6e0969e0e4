# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How many bearings one core can run: live models side by side on one solver thread, as in a node.

The overhead of ROS is not included (``python test/benchmarks/node_overhead.py`` measures that).
"""

import math
import time
from typing import NamedTuple

from bearing_sim.runtime.live import LiveModel, warmed_up
from bearing_sim.runtime.solver_threads import SolverThreads
from bearing_sim.scene.scene import Scene

_SAMPLE_RATE = 100.0  # Hz, the node's default
_INPUT_RATE = 100.0  # Hz
_REVIEWS = 20  # inputs from one review to the next: 5 Hz, as in the node
_SETTLING = 1.0  # [s] not counted, because the start from ideal rolling costs more
_MAXIMUM_LAG = 0.2  # [s], the node's default
_LEAST_FRACTION = 0.995  # of real time, below which a lag grows: a few ticks of a run
_FULL = 0.95  # of a core: expected load of the count that is tried next
_NO_MORE_THAN_NOISE = 1.04  # ratio of counts: the largest count varies by this much from run to run
_TRIES = 10


class FleetRun(NamedTuple):
    """The result of bearings running side by side."""

    bearings: int
    core_seconds: float  # of the whole process, per simulated second of a bearing [s]
    lost: float  # largest time lost by one of them [s]
    real_time_factor: float  # smallest
    input_rate: float  # of speed and load messages to each [Hz]

    @property
    def holds(self) -> bool:
        """Whether all kept real time at the intended input rate."""
        return self.lost == 0.0 and min(self.real_time_factor, self.input_rate / _INPUT_RATE) > _LEAST_FRACTION


def run_fleet(scene: Scene, bearings: int, seconds: float) -> FleetRun:
    """Run identical bearings in real time at their scene's operating conditions.

    Parameters
    ----------
    scene : of each.
    bearings : how many.
    seconds : duration, after a second that is not counted [s].
    """
    threads = SolverThreads(most=1)
    models = [LiveModel(scene, warmed_up(scene), time.time_ns(), _SAMPLE_RATE, _MAXIMUM_LAG, threads=threads) for _ in range(bearings)]
    try:
        _drive(models, _SETTLING)
        lost = [model.solver.pace.lost for model in models]
        times = [_simulated(model) for model in models]
        began, had = time.monotonic(), time.process_time()
        beats = _drive(models, seconds)
        elapsed, spent = time.monotonic() - began, time.process_time() - had
        simulated = [_simulated(model) - before for model, before in zip(models, times)]
        given_up = max(model.solver.pace.lost - before for model, before in zip(models, lost))
        return FleetRun(bearings, spent / sum(simulated) if any(simulated) else math.inf, given_up, min(simulated) / elapsed, beats / elapsed)
    finally:
        for model in models:
            model.close()


def most_bearings(scene: Scene, seconds: float) -> list[FleetRun]:
    """Return runs of one bearing and of more; the last is the largest count that kept real time.

    The load per bearing falls with their number, because they share code and tables in the caches, so only runs of many show how many fit.
    Each count is what the last successful run predicts; a run that fails is followed by the geometric mean of its count and the largest
    successful one.  If not even one bearing keeps real time, its run is the last.

    Parameters
    ----------
    scene : of each bearing.
    seconds : of each run [s].
    """
    runs = [run_fleet(scene, 1, seconds)]
    most, too_many = runs[0], math.inf
    for _ in range(_TRIES):
        count = max(1, math.floor(_FULL / most.core_seconds))
        if count >= too_many:
            count = math.isqrt(most.bearings * too_many)
        if count <= _NO_MORE_THAN_NOISE * most.bearings:
            break
        runs.append(run_fleet(scene, count, seconds))
        if runs[-1].holds:
            most = runs[-1]
        else:
            too_many = count
    return [*(run for run in runs if run is not most), most]


def _simulated(model: LiveModel) -> float:
    """Return how far the model's shaft has turned, as time at its constant speed; skipped time is not included."""
    sample = model.solver.newest
    return float(sample["shaft_angle"] / sample["shaft_speed"]) if sample is not None else 0.0


def _drive(models: list[LiveModel], seconds: float) -> int:
    """Send constant inputs to every model and review it, for a while; return the number of messages per channel."""
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
    return beat
