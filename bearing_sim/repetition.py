# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Repeat a recorded run from its recording alone: the scene, the start, the inputs as the model had them, sample by sample.

Every sample of a recording says which inputs the model had at that instant, so a run in real time can be computed again
although its inputs came late, were held, or were refused.  How much time was simulated from one sample to the next is told by
the shaft's angle, which is the integral of its speed; so time that a live run gave up or spent paused is not simulated here
either.
"""

import dataclasses
import math
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bearing_sim.effects import NUMBERS
from bearing_sim.events import Event, Level
from bearing_sim.recording_reader import Received, Recording
from bearing_sim.simulation import Inputs, IntegrationError, Simulation

_SKIPPED = 0.25  # share of a spacing by which angle and stamps may disagree before time counts as skipped
_LEVELS = {number: name for name, number in NUMBERS.items()}


@dataclass
class Repetition:
    """What came of a repetition.

    Attributes
    ----------
    samples : computed and written; ``received`` messages of inputs copied.
    sim_seconds, wall_seconds : simulated time, and what it took.
    starts : how it began and began anew after a reset: ``"ideal rolling"`` or ``"sample"`` (in the middle of a run).
    level_changes : of a governor.
    skipped_seconds : time of the recording that its run did not simulate.
    failed : samples that could not be computed; the run goes on from what was recorded.
    steps, rejected_steps : the integrator's work.
    """

    samples: int = 0
    received: int = 0
    sim_seconds: float = 0.0
    wall_seconds: float = 0.0
    starts: list[str] = dataclasses.field(default_factory=list)
    level_changes: int = 0
    skipped_seconds: float = 0.0
    failed: int = 0
    steps: int = 0
    rejected_steps: int = 0


def repeat(recording: Recording, sink, progress: Callable[[float], None] = lambda seconds: None) -> Repetition:
    """Compute a recorded run again.

    Parameters
    ----------
    recording : of a run, with all observables.
    sink : a `bearing_sim.sinks.mcap_sink.McapSink`, or alike; gets samples at the recorded times, and the received inputs as they are.
    progress : called now and then with the time that has been reached [s].

    Raises
    ------
    ValueError
        The recording is from before the inputs of every sample were recorded.
    """
    run = _Run(recording, sink)
    began = time.perf_counter()
    for item in recording.with_received():
        if isinstance(item, Received):
            sink.write_received(item.topic, item.ros_type, item.log_ns, item.data, item.publish_ns)
            run.result.received += 1
        elif isinstance(item, np.ndarray):
            sink.write(run.block(item))
            progress(float(item["time"][-1]) - recording.first_time)
    run.finish()
    run.result.wall_seconds = time.perf_counter() - began
    return run.result


class _Run:
    """One repetition under way."""

    def __init__(self, recording: Recording, sink):
        self.result = Repetition()
        self._scene, self._sink = recording.scene, sink
        self._interval = recording.duration / max(recording.samples - 1, 1)
        self._simulation: Simulation | None = None
        self._last: np.void | None = None

    def block(self, recorded: np.ndarray) -> np.ndarray:
        """Return the samples of a block, computed again."""
        computed = recorded.copy()
        for k, sample in enumerate(recorded):
            computed[k] = self._advance_to(sample)
            computed[k]["time"] = sample["time"]
            self._last = sample.copy()
        self.result.samples += len(recorded)
        return computed

    def finish(self) -> None:
        """Count the work of the last simulation."""
        if self._simulation is not None:
            self.result.steps += self._simulation.counters.steps
            self.result.rejected_steps += self._simulation.counters.rejected_steps

    def _advance_to(self, sample: np.void) -> np.void:
        """Return the sample at a recorded one's instant and inputs."""
        inputs = Inputs(*(float(sample[name]) for name in Inputs._fields))
        if not all(map(math.isfinite, inputs)):
            raise ValueError("the recording does not say which inputs the model had at every sample; replay its inputs with --scene instead")
        if self._simulation is None or sample["damage"] < self._last["damage"]:  # damage falls at nothing but a reset
            lead = self._begin(sample, inputs)
        else:
            lead = self._simulated(sample)
        self._follow_level(sample)
        if lead <= 0.0:
            return self._simulation.sample
        try:
            computed = self._simulation.advance(lead, inputs)[-1]
        except IntegrationError as fault:
            self.result.failed += 1
            self._sink.write_event(Event(float(sample["time"]), Level.ERROR, "repetition.failed", f"{fault}; going on from the recorded sample"))
            self._simulation.resume(sample)
            return self._simulation.sample
        self.result.sim_seconds += lead
        return computed

    def _begin(self, sample: np.void, inputs: Inputs) -> float:
        """Start at the run's own start, if it is no more than an interval or two before the sample; return the time to it [s]."""
        self.finish()
        self._simulation = Simulation(self._scene, inputs)
        angle, speed = float(sample["shaft_angle"]), inputs.shaft_speed
        if angle == 0.0:
            self.result.starts.append("ideal rolling")
            return 0.0
        since = angle / speed if speed else math.inf
        if 0.0 < since <= 2.5 * self._interval:
            self.result.starts.append("ideal rolling")
            return since
        self._simulation.resume(sample)
        self.result.starts.append("sample")
        return 0.0

    def _simulated(self, sample: np.void) -> float:
        """Return the time that was simulated since the sample before [s]."""
        stamped = float(sample["time"]) - float(self._last["time"])
        stamped = round(stamped * 1e9) * 1e-9  # stamps are whole nanoseconds
        speeds = float(sample["shaft_speed"]) + float(self._last["shaft_speed"])
        turned = float(sample["shaft_angle"]) - float(self._last["shaft_angle"])
        by_angle = 2.0 * turned / speeds if speeds else stamped
        if abs(by_angle - stamped) <= _SKIPPED * stamped:
            return stamped
        self.result.skipped_seconds += stamped - by_angle
        return max(by_angle, 0.0)

    def _follow_level(self, sample: np.void) -> None:
        level = _LEVELS.get(int(sample["level"]), self._simulation.scene.level)
        if level == self._simulation.scene.level:
            return
        self.result.level_changes += 1
        own = self._scene.integration if level == self._scene.level else dataclasses.replace(self._scene.integration, method=None, fixed_step=None)
        self.finish()
        other = Simulation(dataclasses.replace(self._scene, level=level, integration=own), self._simulation.inputs)
        other.take_over(self._simulation)
        self._simulation = other
