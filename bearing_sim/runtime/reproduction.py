# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Reproduce a recorded run from its recording alone: the scene, the start, and the inputs of the model sample by sample.

Every sample of a recording contains the inputs that the model had at that instant, so a run in real time can be computed again although
its inputs arrived late, were held, or were refused.  The shaft's angle is the integral of its speed and shows how much time was simulated
from one sample to the next; time that a live run skipped or spent paused is not simulated here either.

Impacts of rollers on their pockets amplify the smallest difference a millionfold within milliseconds.  So the model is advanced by the same
calls as in the recorded run, if the recording contains their duration: then the same machine computes the same bits while inputs do not
change.
"""

import bisect
import dataclasses
import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, Level
from bearing_sim.model.sample import RING_TEMPERATURES, new_block
from bearing_sim.recording.reader import Received, Recording
from bearing_sim.runtime.governor import RECORD as GOVERNOR_RECORD
from bearing_sim.runtime.governor import recorded_settings
from bearing_sim.runtime.reproduced_bands import BandDifference, ReproducedBands, first_bands
from bearing_sim.scene.fidelity import NUMBERS
from bearing_sim.scene.loader import with_setting
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, begin_at_temperatures, inputs_of, start_sample, thermal_nodes
from bearing_sim.watchers.monitoring.watchers import NOTHING, Run, Watchers
from bearing_sim.watchers.monitoring.watchers import recorded as recorded_watchers

_SKIPPED = 0.25  # fraction of a spacing by which angle and stamps may disagree before time counts as skipped
_ROUND_OFF = 1e-6  # of an angle, relative
_INSTANT = 1e-7  # s within which two instants are the same
_LEVELS = {number: name for name, number in NUMBERS.items()}


@dataclass
class Reproduction:
    """The result of a reproduction.

    Attributes
    ----------
    samples, received : samples computed and written, and messages of inputs copied.
    sim_seconds, wall_seconds : simulated time, and how long that took.
    starts : how the run began, first and after each reset: ``"ideal rolling"`` or ``"sample"`` (in the middle of a run).
    level_changes : changes of level, or of the setting, by a governor.
    skipped_seconds : time of the recording that its run did not simulate.
    failed : samples that could not be computed; the run continues from the recorded ones.
    steps, rejected_steps : the integrator's work.
    bands : how bands and calibrated fields differ from those recorded, by name; empty where none were computed again.
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
    bands: dict[str, BandDifference] = dataclasses.field(default_factory=dict)


def reproduce(
    recording: Recording, sink, progress: Callable[[float], None] = lambda seconds: None, given: Mapping[str, object] = NOTHING
) -> Reproduction:
    """Compute a recorded run again.

    Parameters
    ----------
    recording : of a run, with all observables.
    sink : a `bearing_sim.recording.writer.McapSink` or similar; gets samples at the recorded times, and the received inputs unchanged.
    progress : called repeatedly with the time reached [s].
    given : what watchers are given that a scene cannot name, by their names: those watch again, and their bands are compared with the recorded ones.

    Raises
    ------
    ValueError
        The recording does not contain the inputs of every sample.
    """
    run, first = _Run(recording, sink, given), first_bands(recording) if given else None
    bands = ReproducedBands(run, first, run.together) if first is not None else None
    began = time.perf_counter()
    for item in recording.with_received():
        if isinstance(item, Received):
            sink.write(item)
            run.result.received += 1
            if bands is not None:
                bands.receive(item)
        elif isinstance(item, Bands):
            if bands is not None:
                bands.note_recorded(item)
        elif isinstance(item, np.ndarray):
            _write(run.compute(item), run, sink, bands)
            progress(float(item["time"][-1]) - recording.first_time)
    _write(run.rest(), run, sink, bands)
    run.finish()
    if bands is not None:
        bands.finish()
        run.result.bands = bands.differences
    run.result.wall_seconds = time.perf_counter() - began
    return run.result


def _write(block: np.ndarray, run: "_Run", sink, bands: ReproducedBands | None) -> None:
    """Write samples that were computed again, and their bands."""
    sink.write(block)
    if bands is not None and len(block):
        for each in bands.see(block, run.restarts):
            sink.write(each)
    run.restarts.clear()


class _Run(Run):
    """One reproduction under way: a run whose clock is the recorded samples."""

    is_reviewed = True

    def __init__(self, recording: Recording, sink, given: Mapping[str, object]):
        self.result = Reproduction()
        self.scene, self._sink, self.start_ns, self.heard = recording.scene, sink, recording.start_ns, set()
        self.watchers = Watchers(self.scene, self, {**given, **recorded_watchers(self.scene, recording.records)}, only_given=True)
        self.watchers.begin()
        self._is_remembered = self.watchers.memory.life_used is not None  # damage then continues over resets
        self._interval = recording.duration / max(recording.samples - 1, 1)
        self._duration = float(recording.metadata.get("advance_seconds") or 0.0)  # of one call of the recorded run
        self.together = int(recording.metadata.get("advance_samples") or 1)  # samples that it returned
        self._next_together = self.together
        self.restarts: set[float] = set()  # times of the samples with which the run began anew [s], since somebody has cleared them
        self._simulation: Simulation | None = None
        self._is_counted = False  # whether the simulation's damage is that of the run, to which the life used before is to be added
        self._settings, self._setting, self._reset_at = _Settings(recording), "", -math.inf
        self._last: np.void | None = None
        self._waiting = new_block(0, recording.scene.bearing.roller.count)

    def compute(self, recorded: np.ndarray) -> np.ndarray:
        """Return samples computed again; samples of a call that is not complete yet wait."""
        rows, done, computed = np.concatenate((self._waiting, recorded)), 0, []
        while done < len(rows):
            begins = self._simulation is None or self._is_reset(rows[done])
            size = 1 if begins else self._next_together
            if done + size > len(rows):
                break
            group = rows[done : done + size]
            if not begins:
                self._follow_setting(group[0])
            computed += [self._call(group)] if not begins and self._is_call(group) else [self._one(sample) for sample in group]
            done += size
            # A sample that is not the state at a start is the first of its call.
            self._next_together = self.together - 1 if begins and group["shaft_angle"][0] and self.together > 1 else self.together
        self._waiting = rows[done:].copy()
        return self._written(rows[:done], computed)

    def rest(self) -> np.ndarray:
        """Return the last samples, computed one by one."""
        rows, self._waiting = self._waiting, self._waiting[:0]
        return self._written(rows, [self._one(sample) for sample in rows])

    def _written(self, recorded: np.ndarray, computed: list[np.ndarray]) -> np.ndarray:
        self.result.samples += len(recorded)
        block = np.concatenate(computed) if computed else recorded.copy()
        block["time"] = recorded["time"]
        return block

    def _is_call(self, group: np.ndarray) -> bool:
        """Return whether these samples come from one call of the recorded run."""
        if not self._duration or (group["level"] != NUMBERS[self._simulation.scene.level]).any() or (np.diff(group["damage"]) < 0.0).any():
            return False
        rows = np.concatenate((np.array([self._last]), group))
        return abs(sum(map(self._lead, rows[:-1], rows[1:])) - self._duration) <= 0.01 * self._duration

    def _call(self, group: np.ndarray) -> np.ndarray:
        inputs = _inputs(group[-1])
        stamped = float(group["time"][-1]) - float(self._last["time"])
        if stamped > (1.0 + _SKIPPED) * self._duration:
            self.result.skipped_seconds += stamped - self._duration
        try:
            block = self._simulation.advance(self._duration, inputs, len(group))
        except IntegrationError as error:
            return self._give_up(group[-1], error, group)
        self.result.sim_seconds += self._duration
        self._last = group[-1].copy()
        return self._counted(block, group, self._duration / len(group))

    def _give_up(self, sample: np.void, error: IntegrationError, recorded: np.ndarray) -> np.ndarray:
        """Report what could not be computed, return what was recorded there, and continue from it."""
        self.result.failed += len(recorded)
        self._sink.write(
            Event(float(sample["time"]), Level.ERROR, "reproduction.failed", "", str(error), "the run continues from the recorded sample")
        )
        self._simulation.resume(sample)
        self._is_counted = False
        self._last = sample.copy()
        return recorded.copy()

    def finish(self) -> None:
        """Add the work of the last simulation."""
        if self._simulation is not None:
            self.result.steps += self._simulation.counters.steps
            self.result.rejected_steps += self._simulation.counters.rejected_steps

    def _one(self, sample: np.void) -> np.ndarray:
        """Return the sample at a recorded one's instant and inputs, as a block."""
        inputs = _inputs(sample)
        first, begins = self._simulation is None, self._simulation is None or self._is_reset(sample)
        if begins:
            if not first:
                self.restarts.add(float(sample["time"]))
                self._reset_at = float(sample["time"])
            lead = self._begin(sample, inputs)
        else:
            lead = self._lead(self._last, sample)
            self.result.skipped_seconds += float(sample["time"]) - float(self._last["time"]) - lead
        self._follow_level(sample)
        self._last = sample.copy()
        if lead <= 0.0:
            block = start_sample(self._simulation)
        else:
            try:
                block = self._simulation.advance(lead, inputs)
            except IntegrationError as error:
                return self._give_up(sample, error, np.array([sample]))
            self.result.sim_seconds += lead
        if begins and not first:  # totals continue over a reset
            self.watchers.memory.continue_from(float(sample["damage"]) - float(block["damage"][-1]))
        return self._counted(block, np.array([sample]), max(lead, 0.0))

    def _counted(self, block: np.ndarray, recorded: np.ndarray, seconds: float) -> np.ndarray:
        """Return samples with the life used by the bearing, as the recorded run had it; each stands for so many seconds."""
        if self._is_counted:
            block["time"] = recorded["time"]
            self.watchers.correct(block, np.full(len(block), seconds))
        return block

    def _is_reset(self, sample: np.void) -> bool:
        """Return whether the run was reset since the last sample.

        A reset decreases the damage.  Where it continues, because the recorded run had a stored state, the angle of the shaft tells: it changes
        by no more than the speeds allow.
        """
        last = self._last
        if sample["damage"] < last["damage"]:
            return True
        if not self._is_remembered:
            return False
        elapsed, speeds = float(sample["time"]) - float(last["time"]), (float(last["shaft_speed"]), float(sample["shaft_speed"]), 0.0)
        change, slack = float(sample["shaft_angle"]) - float(last["shaft_angle"]), _ROUND_OFF * (1.0 + abs(float(last["shaft_angle"])))
        return not min(speeds) * elapsed - slack <= change <= max(speeds) * elapsed + slack

    def _begin(self, sample: np.void, inputs: Inputs) -> float:
        """Start at the run's own start if that is at most two intervals or so before the sample; return the time to the sample [s]."""
        self.finish()
        self._simulation, self._setting = Simulation(self.scene, inputs), ""
        if self._simulation.thermal is not None:  # a run may start from temperatures that its scene does not name
            nodes, rings = thermal_nodes(sample), np.array([float(sample[f"{name}_uncorrected"]) for name in RING_TEMPERATURES])
            begin_at_temperatures(self._simulation, inputs, nodes, rings)
        self._is_counted = True
        angle, speed = float(sample["shaft_angle"]), inputs.shaft_speed
        if angle == 0.0:
            self.result.starts.append("ideal rolling")
            return 0.0
        since = angle / speed if speed else math.inf
        if 0.0 < since <= 2.5 * self._interval:
            self.result.starts.append("ideal rolling")
            return since
        self._simulation.resume(sample)
        self._is_counted = False
        self.result.starts.append("sample")
        return 0.0

    @staticmethod
    def _lead(before: np.void, sample: np.void) -> float:
        """Return the time that was simulated from one sample to the next [s]."""
        stamped = float(sample["time"]) - float(before["time"])
        speeds = float(sample["shaft_speed"]) + float(before["shaft_speed"])
        by_angle = 2.0 * (float(sample["shaft_angle"]) - float(before["shaft_angle"])) / speeds if speeds else stamped
        return stamped if abs(by_angle - stamped) <= _SKIPPED * stamped else max(by_angle, 0.0)

    def _follow_setting(self, sample: np.void) -> None:
        """Change to the setting with which the governor computed a sample, where the recording names settings."""
        name = self._settings.at(float(sample["time"]), self._reset_at)
        if name == self._setting:
            return
        self._setting = name
        self.result.level_changes += 1
        self._continue_with(self._settings.scene(name))

    def _continue_with(self, scene: Scene) -> None:
        self.finish()
        other = Simulation(scene, self._simulation.inputs)
        other.take_over(self._simulation)
        self._simulation = other

    def _follow_level(self, sample: np.void) -> None:
        self._follow_setting(sample)
        level = _LEVELS.get(int(sample["level"]), self._simulation.scene.level)
        if level == self._simulation.scene.level:
            return
        self.result.level_changes += 1
        own = self.scene.integration if level == self.scene.level else dataclasses.replace(self.scene.integration, fixed_step=None)
        self._continue_with(dataclasses.replace(self.scene, level=level, integration=own))


class _Settings:
    """The measured settings that a governor chose in a recorded run, over time.

    Parameters
    ----------
    recording : if it has no record of settings, its setting is ``""`` throughout.
    """

    def __init__(self, recording: Recording):
        self._scene, self._times, self._names = recording.scene, [], [""]
        record = recording.records.get(GOVERNOR_RECORD)
        if record is None:
            return
        self._known, running = recorded_settings(record)
        self._wanted = next(iter(self._known), "")
        changes = [item for item in recording if isinstance(item, Event) and item.kind == "governor.change" and item.subject in self._known]
        self._names = [self._of(running), *(self._of(change.subject) for change in changes)]
        self._times = [change.time for change in changes]

    def _of(self, name: str) -> str:
        """Return the name of a setting; empty for the wanted one, which is that of the scene."""
        return "" if name == self._wanted else name

    def at(self, time: float, reset: float) -> str:
        """Return the name of the setting of a sample [s]; a change holds from behind its own instant on.

        Parameters
        ----------
        time : of the sample [s].
        reset : when the run was reset to the wanted setting [s]; minus infinity if it was not.
        """
        number = bisect.bisect_left(self._times, time - _INSTANT)
        changed = self._times[number - 1] if number else -math.inf
        return "" if changed < reset else self._names[number]

    def scene(self, name: str) -> Scene:
        """Return the scene at a setting."""
        return with_setting(self._scene, self._known[name]) if name else self._scene


def _inputs(sample: np.void) -> Inputs:
    inputs = inputs_of(sample)
    if not all(map(math.isfinite, inputs[: -len(RING_TEMPERATURES)])):
        raise ValueError("the recording does not contain the inputs of every sample; replay its inputs with --scene instead")
    return inputs
