# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Replay: the model driven by the inputs of a log, from stamp to stamp, as fast as possible."""

import heapq
import math
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np

from bearing_sim.inputs.profile import InputProfile
from bearing_sim.messages.bands import BANDS, Bands
from bearing_sim.messages.diagnostics import condition, further_condition
from bearing_sim.messages.events import FOR_KEEPING, Event, Record, Report
from bearing_sim.messages.topics import MEASURED, MEASURED_CLEARANCE
from bearing_sim.model.sample import joined
from bearing_sim.model.turning import SLIP_FROM_SPEED, Use, slip_statistics, slipping_seconds, turns, use_of
from bearing_sim.model.validity import Exceedance, in_order
from bearing_sim.runtime.advance_segment import Begun, Output, ProfileRun, pass_on, put_at_start
from bearing_sim.runtime.health import Changes
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.simulation import Inputs, Simulation
from bearing_sim.watchers.monitoring.watchers import NOTHING, Run, Watchers

_REPORT_EVERY = 1.0  # [s] of simulated time between diagnostics
_PROGRESS_EVERY = 50  # items
_JUDGED = 400  # outputs judged at once if none of them can raise or clear an alarm
_ENDLESS = 1e7  # [h]; longer lives are those of a shaft that hardly turns
_TOGETHER = 100  # outputs of a level that takes courses, written and judged at once: singly they take ten times as long as their computation
_WATCHED_BLOCK = 100  # samples: views take one long block far faster than single samples
# Assumptions on what a line through the outputs still shows: a point of slip is what people read, a fifth of a run's slip what they see.
_COARSE_CHANGE, _COARSE_SHARE = 0.01, 0.2


class Jump(NamedTuple):
    """The largest change of cage slip from one output to the next: how much (a fraction), when it ends [s], and how long it took [s]."""

    slip: float
    time: float
    interval: float


@dataclass
class Replay:
    """The result of a replay.

    Attributes
    ----------
    log_seconds, sim_seconds, wall_seconds : length of the log, how much of it was simulated, and how long that took.
    cpu_seconds : processor time of all threads; less than ``wall_seconds`` if other processes used the processor.
    samples : outputs written.
    steps, rejected_steps, non_finite_steps : the integrator's work.
    failed_ticks, gap_seconds : stretches that could not be integrated, and time in gaps of the log; neither is simulated.
    time : of each output [s]; ``slip``, the cage slip there, ``speed`` [rad/s], ``load`` [N] and ``life`` [h] likewise; ``weight`` the time that
        each represents [s].
    damage : fraction of life used.
    events : number of events by kind.
    given_up : why the run ended before the log did, or ``""``.
    warnings : laws used outside of their ranges, each with its worst value.
    bands : 5 and 95 % quantiles of the results (`bearing_sim.watchers.estimation.bands.QUANTITIES`), where the scene asks for them; NaN for the slip
        while the shaft does not turn.
    slip_from_speed : speed from which on the shaft turns [rad/s] (`bearing_sim.model.turning`).
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
    time: list[float] = field(default_factory=list)
    slip: list[float] = field(default_factory=list)
    speed: list[float] = field(default_factory=list)
    load: list[float] = field(default_factory=list)
    life: list[float] = field(default_factory=list)
    weight: list[float] = field(default_factory=list)
    events: Counter = field(default_factory=Counter)
    given_up: str = ""
    warnings: list[Exceedance] = field(default_factory=list)
    worst_samples: dict[str, np.void] = field(default_factory=dict)
    bands: list[Bands] = field(default_factory=list)
    slip_from_speed: float = SLIP_FROM_SPEED

    @property
    def real_time_factor(self) -> float:
        """Simulated seconds per second."""
        return self.sim_seconds / self.wall_seconds if self.wall_seconds > 0 else math.nan

    def use(self, thresholds: Thresholds) -> Use:
        """Return what the run did to its bearing: life, damage and times (`bearing_sim.model.turning.use_of`)."""
        return use_of(np.array(self.slip), np.array(self.speed), np.array(self.load), self.weight, self.damage, thresholds, self.sim_seconds)

    def slip_statistics(self) -> dict[str, float]:
        """Return mean, median, 95th and 99th percentile and maximum of the slip, weighted by time, while the shaft turns; NaN if it never does."""
        return slip_statistics(np.array(self.slip), np.array(self.speed), np.array(self.weight), self.slip_from_speed)

    def _turning(self) -> np.ndarray:
        return turns(np.array(self.speed), self.slip_from_speed)

    def jump(self) -> Jump | None:
        """Return the largest change of slip between neighbouring outputs while the shaft turns, if it hides how the slip moved; else None.

        It does from one point on, if it is a fifth of the whole range of the slip: whatever happened in between is drawn as a straight line.
        """
        time, slip = np.array(self.time), np.where(self._turning(), self.slip, np.nan)
        if len(time) < 2 or not np.isfinite(slip).any():
            return None
        intervals, changes = np.diff(time), np.abs(np.diff(slip))
        changes[intervals > 1.5 * np.array(self.weight)[1:]] = np.nan  # a gap, in which nothing was simulated
        if not np.isfinite(changes).any():
            return None
        k = int(np.nanargmax(changes))
        if changes[k] < max(_COARSE_CHANGE, _COARSE_SHARE * (np.nanmax(slip) - np.nanmin(slip))):
            return None
        return Jump(float(changes[k]), float(time[k + 1]), float(intervals[k]))

    @property
    def revolutions(self) -> float:
        """Turns of the shaft in either sense."""
        return float(np.abs(np.array(self.speed)) @ np.array(self.weight)) / (2.0 * math.pi)

    def seconds_above(self, slip: float) -> float:
        """Return for how long the shaft turned under a load with more slip than that [s]."""
        return slipping_seconds(np.array(self.slip), np.array(self.speed), np.array(self.load), self.weight, slip, self.slip_from_speed)

    def seconds_below(self, minimum_load: Callable[[np.ndarray], np.ndarray]) -> tuple[float, float]:
        """Return for how long the load was below a minimum while the shaft turned, and for how long it turned [s].

        Parameters
        ----------
        minimum_load : of the shaft's speeds [rad/s], shape (n,), the minimum load [N], shape (n,).
        """
        speed, load, weight = np.array(self.speed), np.array(self.load), np.array(self.weight)
        turning = self._turning()
        below = turning & (load < minimum_load(speed))
        return float(weight[below].sum()), float(weight[turning].sum())

    def band_statistics(self) -> dict[str, tuple[float, float]]:
        """Return the 5 and 95 % quantiles of the results while the shaft turns; empty without bands.

        Returns
        -------
        by name: ``cage_slip``, the means over time of both quantiles; ``largest_cage_slip``, ``least_rating_life`` [h] and
        ``least_running_clearance`` [m], the largest and least of each; ``remaining_life`` [h], those at the end.
        """
        if not self.bands:
            return {}
        times, edges = np.concatenate([bands.times for bands in self.bands]), np.concatenate([bands.numbers for bands in self.bands])[:, :, 1:]
        slip, life, clearance, remaining = np.moveaxis(edges, 1, 0)
        known = np.isfinite(slip).all(axis=1) & (life[:, 0] < _ENDLESS)
        if not known.any():
            return {}
        weight = np.diff(times, prepend=2.0 * times[0] - times[1] if len(times) > 1 else times[0] - 1.0)[known]
        pairs = {
            "cage_slip": np.average(slip[known], axis=0, weights=weight),
            "largest_cage_slip": slip[known].max(axis=0),
            "least_rating_life": life[known].min(axis=0),
            "least_running_clearance": clearance[known].min(axis=0),
            "remaining_life": remaining[known][-1],
        }
        return {name: (float(low), float(high)) for name, (low, high) in pairs.items()}

    @property
    def least_rating_life(self) -> float:
        """The shortest rating life of all outputs [h]."""
        return min((life for life in self.life if not math.isnan(life)), default=math.nan)


def replay(
    scene: Scene,
    profile: InputProfile,
    recording=None,
    views: Iterable = (),
    rate: float | None = None,
    progress: Callable[[float], None] = lambda seconds: None,
    model: Callable[[Scene, Inputs], Simulation] = Simulation,
    given: Mapping[str, object] = NOTHING,
) -> Replay:
    """Run the model over an input profile and write inputs, outputs and events.

    Parameters
    ----------
    scene : what to simulate; of its operating conditions only the oil temperature is used, if the log has none.
    profile : the inputs (see `bearing_sim.inputs.profile.judge`).
    recording : a `bearing_sim.recording.writer.McapSink` or similar; None writes nothing.
    views : further sinks, which get samples, measurements and events.
    rate : outputs per simulated second [Hz]; by default one at each stamp of speed or load.
    progress : called repeatedly with the time reached [s].
    model : makes the simulation.
    given : what watchers are given that a scene cannot name, by their names (see `bearing_sim.watchers.monitoring.watchers.Watchers`), such as the
        stored state of the bearing whose log it is.

    Returns
    -------
    The result.  A stretch that cannot be integrated is skipped, reported by an event and counted, and the next one is tried from the last
    good state; after ten in a row the run is given up.
    """
    return _Run(scene, profile, recording, tuple(views), rate, progress, given).run(model)


class _Run(Run):
    """One replay under way: a run whose clock is the log."""

    def __init__(
        self, scene: Scene, profile: InputProfile, recording, views: tuple, rate: float | None, progress: Callable, given: Mapping[str, object]
    ):
        self._scene, self._profile, self._views, self._progress, self._rate = scene, profile, views, progress, rate
        self.start_ns, self.heard = profile.start_ns, [channel for channel, stamps in profile.stamps.items() if len(stamps)]
        self._recordings = (recording,) if recording is not None else ()
        self._result = Replay(profile.log_seconds, slip_from_speed=scene.thresholds.slip_from_speed)
        self._pending_events = deque(profile.events)
        measured = [(MEASURED, *each) for each in profile.measured], [(MEASURED_CLEARANCE, *each) for each in profile.measured_clearance]
        self._pending_measurements = deque(heapq.merge(*measured, key=lambda each: each[1]))
        self._changes = Changes()
        self._watched: list[np.ndarray] = []
        self._unwritten: list[Output] = []
        self._next_report = 0.0
        self.watchers = Watchers(scene, self, given)
        self.watchers.begin()

    def run(self, model: Callable[[Scene, Inputs], Simulation]) -> Replay:
        began, began_cpu = time.perf_counter(), time.process_time()
        result, outputs_only = self._result, not self._recordings and not self._views and not self._scene.estimation.calibrated
        run = ProfileRun(partial(self._begin, model), outputs_only)
        segment = self._profile.segment(self._rate, self._scene.lubricant.temperature)
        together = 1
        for k, item in enumerate(run.advance_segment(segment)):
            moment = float(item.block["time"][-1]) if isinstance(item, Output) else item.time
            self._follow_log(moment)
            if isinstance(item, Output):
                self._unwritten.append(item)
                if len(self._unwritten) >= together or len(item.block) > 1:
                    self._write_outputs()
            elif isinstance(item, Event):
                self._write_outputs()  # they come first
                self.write(item, moment)
            else:
                pass_on(item, self)
                if isinstance(item, Begun):
                    # Not where outputs take long, so that a recording that is cut short has them; nor where a measurement acts on the next output.
                    is_fast = getattr(run.simulation, "takes_profiles", False) and not self._scene.estimation.calibrated
                    together = _TOGETHER if is_fast else 1
            if k % _PROGRESS_EVERY == 0:
                self._progress(moment)
        if not run.given_up:
            self._progress(self._profile.end * 1e-9)
        self._write_outputs()
        self._flush(self._profile.end * 1e-9)
        self._follow_log(math.inf)
        if self._profile.unknown_seconds:
            self.write(self._profile.unknown_event, self._profile.end * 1e-9)
        self.watchers.close()
        self._write_to_views()
        if run.simulation is not None:
            result.steps, result.rejected_steps, result.non_finite_steps = run.simulation.counters[:3]
        result.sim_seconds, result.gap_seconds = run.simulated_ns * 1e-9, run.in_gaps_ns * 1e-9
        result.failed_ticks, result.given_up = run.failures, run.given_up
        result.bands = _while_turning(result)
        result.warnings, result.worst_samples = in_order(self.watchers.exceedances), self.watchers.worst_samples
        result.wall_seconds, result.cpu_seconds = time.perf_counter() - began, time.process_time() - began_cpu
        return result

    def _begin(self, model: Callable[[Scene, Inputs], Simulation], inputs: Inputs) -> Simulation:
        simulation = model(self._scene, inputs)
        put_at_start(simulation, inputs, self, is_there=True)
        return simulation

    def _write_outputs(self) -> None:
        """Write and judge the outputs since the last call."""
        outputs, self._unwritten = self._unwritten, []
        if not outputs:
            return
        block, weights, result = joined([each.block for each in outputs]), np.concatenate([each.weights for each in outputs]), self._result
        result.samples += len(block)
        result.weight += weights.tolist()
        for kept, name in ((result.time, "time"), (result.slip, "cage_slip"), (result.speed, "shaft_speed"), (result.life, "rating_life")):
            kept += block[name].tolist()
        result.load += np.hypot(block["load_y"], block["load_z"]).tolist()
        result.damage = float(block["damage"][-1])  # of this run alone
        pass_on(Output(block, weights), self)

    def judge(self, block: np.ndarray) -> None:
        """Judge outputs in parts, each of which ends where the bearing's condition is to be written."""
        for begin in range(0, len(block), _JUDGED):
            part = block[begin : begin + _JUDGED]
            while len(part):
                due = int(np.searchsorted(part["time"], self._next_report)) if self._recordings else len(part)
                self._judge(part[: due + 1])
                part = part[due + 1 :]

    def _judge(self, block: np.ndarray) -> None:
        """Judge outputs one by one, or all at once if none of them can raise or clear an alarm."""
        is_calm = len(block) > 1 and not self._changes.holding and self.watchers.are_calm(block)
        for part in (block,) if is_calm else (block[k : k + 1] for k in range(len(block))):
            moment = float(part["time"][-1])
            for record in self.watchers.see(part):
                self.write(record, moment)
            self._report(part[-1], moment)

    def _flush(self, moment: float) -> None:
        for record in self.watchers.flush():
            self.write(record, moment)

    def _report(self, sample, moment: float) -> None:
        """Write a change of the bearing's condition at once, and the condition once a second."""
        changes = self._changes.update(moment, self.watchers.events(moment, told=False))
        if changes or moment >= self._next_report:
            self._flush(moment)  # their events come first
        for event in changes:
            self.write(event, moment)
        if moment >= self._next_report:
            # A hundredth early, so that reports stay at whole seconds although stamps jitter.
            self._next_report = (math.floor(moment / _REPORT_EVERY + 0.01) + 0.99) * _REPORT_EVERY
            if not self._recordings:
                return
            worst_first = sorted(self.watchers.events(moment), key=lambda event: -event.level)
            values = condition(sample) | further_condition(self._scene, sample) | self.watchers.values(moment)
            self.write(Report(moment, worst_first, values), moment)

    def write(self, record: Record, now: float) -> None:
        """Write a record; views get samples in long blocks, and no inputs and reports."""
        if isinstance(record, Event):
            self._result.events[record.kind] += 1
        elif isinstance(record, Bands) and record.topic == BANDS:
            self._result.bands.append(record)
        for recording in self._recordings:
            recording.write(record)
        if isinstance(record, np.ndarray) and self._views:
            self._watched.append(record)
            if sum(map(len, self._watched)) >= _WATCHED_BLOCK:
                self._write_to_views()
        elif not isinstance(record, (np.ndarray, *FOR_KEEPING)):
            for view in self._views:
                view.write(record)

    def _write_to_views(self) -> None:
        if self._watched:
            block = np.concatenate(self._watched)
            self._watched = []
            for view in self._views:
                view.write(block)

    def _follow_log(self, moment: float) -> None:
        """Write the events of the log and let the watchers hear its measurements up to a time [s]."""
        measurements, events = self._pending_measurements, self._pending_events
        while measurements and measurements[0][1] <= moment:
            channel, *reading = measurements.popleft()
            for record in self.watchers.hear(channel, *reading):
                self.write(record, moment)
        while events and events[0].time <= moment:
            self._write_outputs()  # they come first
            self.write(events.popleft(), moment)


def _while_turning(result: Replay) -> list[Bands]:
    """Return the bands of a run without those of the slip while the shaft does not turn."""
    times, turning, found = np.array(result.time), turns(np.array(result.speed), result.slip_from_speed), []
    for bands in result.bands:
        numbers = bands.numbers.copy()
        numbers[~turning[np.searchsorted(times, bands.times)], bands.names.index("cage_slip")] = math.nan
        found.append(bands._replace(numbers=numbers))
    return found
