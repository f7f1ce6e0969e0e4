# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Replay: the model driven by the inputs of a log, from stamp to stamp, as fast as it can."""

import math
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.input_course import InputCourse
from bearing_sim.runtime.health import bearing_events, bearing_states
from bearing_sim.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, start_sample
from bearing_sim.topics import INPUTS, condition, further_condition

_REPORT_EVERY = 1.0  # [s] of simulated time between diagnostics
_PROGRESS_EVERY = 50  # ticks
_COURSE = 2000  # instants in one go, at a level that takes them so
_WATCHED_BLOCK = 100  # samples: views take long blocks far more cheaply than single samples
_FAILURES_IN_A_ROW = 10  # then the run is given up
_TURNING = 0.01  # of the largest speed of the run: slip means nothing on a shaft that hardly turns


@dataclass
class Replay:
    """What came of a replay.

    Attributes
    ----------
    log_seconds, sim_seconds, wall_seconds : length of the log's course, what of it was simulated, and what that took.
    cpu_seconds : processor time that it took, of all threads; less than ``wall_seconds`` where others had the processor.
    samples : outputs written.
    steps, rejected_steps, non_finite_steps : the integrator's work.
    failed_ticks, gap_seconds : ticks that could not be integrated, and time in gaps of the log; neither is simulated.
    slip : cage slip at each output; ``speed`` [rad/s], ``life`` [h] likewise; ``weight`` the time that each stands for [s].
    damage : fraction of life used.
    events : occurrences by code.
    given_up : why the run ended before the log did, or ``""``.
    """

    log_seconds: float
    sim_seconds: float = 0.0
    wall_seconds: float = 0.0
    cpu_seconds: float = 0.0
    samples: int = 0
    steps: int = 0
    rejected_steps: int = 0
    non_finite_steps: int = 0
    failed_ticks: int = 0
    gap_seconds: float = 0.0
    damage: float = 0.0
    slip: list[float] = field(default_factory=list)
    speed: list[float] = field(default_factory=list)
    life: list[float] = field(default_factory=list)
    weight: list[float] = field(default_factory=list)
    events: Counter = field(default_factory=Counter)
    given_up: str = ""

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second."""
        return self.sim_seconds / self.wall_seconds if self.wall_seconds > 0 else math.nan

    @property
    def life_hours(self) -> float:
        """Life under the repeated course of this run, simulated time over damage [h]; infinite without damage."""
        return self.sim_seconds / 3600 / self.damage if self.damage > 0 else math.inf

    def slip_figures(self) -> dict[str, float]:
        """Return mean, median, 95th and 99th percentile and maximum of the slip, by time, while the shaft turns.

        It turns above a hundredth of the largest speed of the run; NaN where it never does.
        """
        slip, speed, weight = np.array(self.slip), np.abs(self.speed), np.array(self.weight)
        turning = np.isfinite(slip) & (speed > 0) & (speed >= _TURNING * speed.max(initial=0.0))
        if not turning.any():
            return dict.fromkeys(("mean", "median", "p95", "p99", "maximum"), math.nan)
        slip, weight = slip[turning], weight[turning]
        median, p95, p99 = np.percentile(slip, [50, 95, 99], weights=weight, method="inverted_cdf")
        figures = {"mean": np.average(slip, weights=weight), "median": median, "p95": p95, "p99": p99, "maximum": slip.max()}
        return {name: float(value) for name, value in figures.items()}

    @property
    def least_rating_life(self) -> float:
        """The shortest rating life of all outputs [h]."""
        return min((life for life in self.life if not math.isnan(life)), default=math.nan)


def replay(
    scene: Scene,
    course: InputCourse,
    recording=None,
    watchers: Iterable = (),
    rate: float | None = None,
    progress: Callable[[float], None] = lambda seconds: None,
    model: Callable[[Scene, Inputs], Simulation] = Simulation,
) -> Replay:
    """Run the model over a course of inputs and write inputs, outputs and events.

    Parameters
    ----------
    scene : what to simulate; the operating block counts only for an oil temperature that the log does not hold.
    course : the inputs (see `bearing_sim.input_course.judge`); linear between their stamps.
    recording : a `bearing_sim.sinks.mcap_sink.McapSink`, or alike; None writes nothing.
    watchers : further sinks, which get samples and events.
    rate : outputs per simulated second [Hz]; by default one at each stamp of speed or load.
    progress : called now and then with the time that has been reached [s].
    model : what makes the simulation.

    Returns
    -------
    What came of it.  A stretch that cannot be integrated is left out, told by an event, counted, and the next one is tried
    from the last good state; after ten in a row the run is given up.
    """
    return _Run(scene, course, recording, tuple(watchers), rate, progress).run(model)


class _Nowhere:
    """A recording that is none."""

    def write(self, block) -> None:
        """Drop samples."""

    def write_inputs(self, time, inputs, channels) -> None:
        """Drop inputs."""

    def write_event(self, event) -> None:
        """Drop an event."""

    def write_diagnostics(self, time, events, values) -> None:
        """Drop diagnostics."""


class _Run:
    """One replay under way."""

    def __init__(self, scene: Scene, course: InputCourse, recording, watchers: tuple, rate: float | None, progress: Callable):
        self._scene, self._course, self._watchers, self._progress = scene, course, watchers, progress
        self._recording = recording if recording is not None else _Nowhere()
        self._unseen = recording is None and not watchers
        stamps = course.instants
        wanted = stamps if rate is None else np.round(np.arange(int(course.end * 1e-9 * rate * (1 + 1e-12)) + 1) * (1e9 / rate)).astype(np.int64)
        self._grid = np.unique(np.concatenate((stamps, wanted[wanted <= course.end])))
        self._is_output = np.isin(self._grid, wanted)
        self._in_gap = np.zeros(len(self._grid), bool)  # of the stretch that ends at each instant
        for begin, end in course.gaps:
            self._in_gap |= (self._grid > begin) & (self._grid <= end)
        self._arrivals = {channel: np.isin(self._grid, stamps) for channel, stamps in course.stamps.items()}
        self._result = Replay(log_seconds=course.end * 1e-9)
        self._pending_events = list(course.events)
        self._holding: dict[str, Event] = {}
        self._watched: list[np.ndarray] = []
        self._next_report = 0.0
        self._failures = 0
        self._unweighed = 0.0  # [s] simulated since the last output

    def run(self, model: Callable[[Scene, Inputs], Simulation]) -> Replay:
        began, began_cpu = time.perf_counter(), time.process_time()
        inputs = self._course.at(self._grid, self._scene.lubricant.temperature)
        self._write_inputs(0, Inputs(*inputs[0]))
        try:
            simulation = model(self._scene, Inputs(*inputs[0]))
        except IntegrationError as error:
            self._give_up(0.0, f"the model has no state at the first inputs: {error}")
        else:
            if hasattr(self._recording, "write_start"):
                self._recording.write_start(start_sample(simulation))
            self._advance_over_grid(simulation, inputs)
            self._result.steps, self._result.rejected_steps, self._result.non_finite_steps = simulation.counters[:3]
        self._tell_events_until(math.inf)
        self._show_watchers()
        self._result.wall_seconds, self._result.cpu_seconds = time.perf_counter() - began, time.process_time() - began_cpu
        return self._result

    def _advance_over_grid(self, simulation: Simulation, inputs: np.ndarray) -> None:
        times = self._grid * 1e-9
        takes_courses = getattr(simulation, "takes_courses", False)
        done = 1  # instants before this one are
        for place in range(1, len(times)):
            if takes_courses and place >= done:
                done = place + self._advance_course(simulation, times, inputs, place)
            if place < done:
                continue
            moment, stretch = float(times[place]), float(times[place] - times[place - 1])
            reached = Inputs(*inputs[place].tolist())
            self._tell_events_until(moment)
            self._write_inputs(place, reached)
            if place % _PROGRESS_EVERY == 0:
                self._progress(moment)
            if self._in_gap[place]:
                self._result.gap_seconds += stretch
                continue
            try:
                block = simulation.advance(stretch, reached)
            except IntegrationError as error:
                if self._fail(moment, error):
                    return
                continue
            self._recover(moment)
            self._result.sim_seconds += stretch
            self._unweighed += stretch
            if self._is_output[place]:
                self._take(block, moment)
        self._progress(float(times[-1]))

    def _advance_course(self, simulation: Simulation, times: np.ndarray, inputs: np.ndarray, first: int) -> int:
        """Advance over many instants at once; return how many, none where the next one needs a closer look."""
        end = min(first + _COURSE, len(times))
        gaps = np.flatnonzero(self._in_gap[first:end])
        end = first + int(gaps[0]) if len(gaps) else end
        if end == first:
            return 0
        stretches = np.diff(times[first - 1 : end])
        block = simulation.advance_course(stretches, inputs[first:end])
        reached = len(block)
        if not reached:
            return 0
        self._recover(float(times[first]))
        self._result.sim_seconds += float(stretches[:reached].sum())
        if self._unseen:
            self._take_unseen(block, times[first : first + reached], stretches[:reached], self._is_output[first : first + reached])
        else:
            for k in range(reached):
                moment = float(times[first + k])
                self._tell_events_until(moment)
                self._write_inputs(first + k, Inputs(*inputs[first + k].tolist()))
                self._unweighed += float(stretches[k])
                if self._is_output[first + k]:
                    self._take(block[k : k + 1], moment)
        self._progress(float(times[first + reached - 1]))
        return reached

    def _take_unseen(self, block: np.ndarray, moments: np.ndarray, stretches: np.ndarray, is_output: np.ndarray) -> None:
        """Take many outputs that nobody wants to see one by one."""
        self._tell_events_until(float(moments[-1]))
        waited = self._unweighed + np.cumsum(stretches)
        block, moments, waited, total = block[is_output], moments[is_output], waited[is_output], float(waited[-1])
        self._unweighed = total - float(waited[-1]) if len(waited) else total
        if not len(block):
            return
        result = self._result
        result.samples += len(block)
        result.weight += np.diff(waited, prepend=0.0).tolist()
        for kept, name in ((result.slip, "cage_slip"), (result.speed, "shaft_speed"), (result.life, "rating_life")):
            kept += block[name].tolist()
        result.damage = float(block["damage"][-1])
        states = bearing_states(block, self._scene.thresholds)
        for k in np.flatnonzero(np.diff(states, prepend=-1)).tolist():  # the first of them, too: what held before it is not known here
            sample = block[k : k + 1].copy()
            sample["time"] = moments[k]
            self._report(sample[0], float(moments[k]))

    def _take(self, block: np.ndarray, moment: float) -> None:
        """Write one output."""
        block = block.copy()
        block["time"] = moment  # the log's time: gaps and failed stretches count
        sample, result = block[-1], self._result
        result.samples += 1
        result.slip.append(float(sample["cage_slip"]))
        result.speed.append(float(sample["shaft_speed"]))
        result.life.append(float(sample["rating_life"]))
        result.weight.append(self._unweighed)
        result.damage = float(sample["damage"])
        self._unweighed = 0.0
        self._recording.write(block)
        if self._watchers:
            self._watched.append(block)
            if len(self._watched) >= _WATCHED_BLOCK:
                self._show_watchers()
        self._report(sample, moment)

    def _report(self, sample, moment: float) -> None:
        """Tell a change of the bearing's condition at once, and the condition once a second."""
        now = {event.code: event for event in bearing_events(sample, self._scene.thresholds)}
        for code, event in now.items():
            if code not in self._holding or self._holding[code].level != event.level:
                self._tell(event)
        for code in self._holding.keys() - now.keys():
            self._tell(Event(moment, Level.OK, code, "back within its limits"))
        self._holding = now
        if moment >= self._next_report:
            # A hundredth early, so that reports keep to whole seconds where stamps jitter.
            self._next_report = (math.floor(moment / _REPORT_EVERY + 0.01) + 0.99) * _REPORT_EVERY
            worst_first = sorted(now.values(), key=lambda event: -event.level)
            self._recording.write_diagnostics(moment, worst_first, condition(sample) | further_condition(self._scene, sample))

    def _show_watchers(self) -> None:
        if self._watched:
            block = np.concatenate(self._watched)
            self._watched = []
            for watcher in self._watchers:
                watcher.write(block)

    def _tell(self, event: Event) -> None:
        self._result.events[event.code] += 1
        self._recording.write_event(event)
        for watcher in self._watchers:
            watcher.write_event(event)

    def _tell_events_until(self, moment: float) -> None:
        while self._pending_events and self._pending_events[0].time <= moment:
            self._tell(self._pending_events.pop(0))

    def _write_inputs(self, place: int, inputs: Inputs) -> None:
        arrived = [channel for channel in INPUTS if channel in self._arrivals and self._arrivals[channel][place]]
        if arrived:
            self._recording.write_inputs(float(self._grid[place] * 1e-9), inputs, arrived)

    def _fail(self, moment: float, error: IntegrationError) -> bool:
        """Tell a stretch that could not be integrated; return whether the run is to be given up."""
        self._failures += 1
        self._result.failed_ticks += 1
        if self._failures == 1:
            text = f"time could not be advanced ({error}); this stretch is left out, the last good state is held and the next inputs are tried"
            self._tell(Event(moment, Level.ERROR, "solver.failed", text))
        if self._failures < _FAILURES_IN_A_ROW:
            return False
        self._give_up(moment, f"{self._failures} stretches in a row could not be integrated, the last one up to {moment:.3f} s: {error}")
        return True

    def _recover(self, moment: float) -> None:
        if self._failures:
            text = f"time advances again after {self._failures} failed stretches"
            self._failures = 0
            self._tell(Event(moment, Level.OK, "solver.recovered", text))

    def _give_up(self, moment: float, reason: str) -> None:
        self._result.given_up = reason
        self._tell(Event(moment, Level.ERROR, "run.given_up", reason))
