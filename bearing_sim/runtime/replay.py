# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Replay: the model driven by the inputs of a log, from stamp to stamp, as fast as possible."""

import math
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import NamedTuple

import numpy as np

from bearing_sim.inputs.profile import InputProfile
from bearing_sim.messages import topics
from bearing_sim.messages.bands import BANDS, Bands
from bearing_sim.messages.diagnostics import condition, further_condition
from bearing_sim.messages.events import Event, MeasuredClearance, Measurement, ReceivedInputs, Record, Report, Start
from bearing_sim.model.sample import joined
from bearing_sim.model.turning import SLIP_FROM_SPEED, Use, slip_statistics, slipping_seconds, turns, use_of
from bearing_sim.model.validity import Exceedance, Law
from bearing_sim.runtime.advance_segment import Begun, Output, ProfileRun
from bearing_sim.runtime.health import Changes
from bearing_sim.runtime.remembering import note, recall, warm_start
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.simulation import Inputs, Simulation
from bearing_sim.watchers.estimation.response import ResponseModel
from bearing_sim.watchers.monitoring.limits import LimitsMonitor
from bearing_sim.watchers.monitoring.monitor import Monitor
from bearing_sim.watchers.monitoring.residual import Comparison, ResidualMonitor
from bearing_sim.watchers.monitoring.watchers import Watchers
from bearing_sim.watchers.stored_state.keeper import StateKeeper

_REPORT_EVERY = 1.0  # [s] of simulated time between diagnostics
_PROGRESS_EVERY = 50  # items
_JUDGED = 400  # outputs judged at once if none of them can raise or clear an alarm
_ENDLESS = 1e7  # [h]; longer lives are those of a shaft that hardly turns
_ESTIMATED = 100  # outputs that bands are computed for at once
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
    keeper: StateKeeper | None = None,
    response: ResponseModel | None = None,
    laws: Sequence[Law] = (),
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
    keeper : of the state of the bearing whose log it is; times that the state contains are not counted again.  None counts nothing.
    response : of the scene, for what its block ``estimation`` asks for; None estimates nothing.
    laws : that replace those of the same name (see `bearing_sim.watchers.monitoring.limits.LimitsMonitor`).

    Returns
    -------
    The result.  A stretch that cannot be integrated is skipped, reported by an event and counted, and the next one is tried from the last
    good state; after ten in a row the run is given up.
    """
    return _Run(scene, profile, recording, tuple(views), rate, progress, keeper, response, laws).run(model)


class _Run:
    """One replay under way."""

    def __init__(
        self,
        scene: Scene,
        profile: InputProfile,
        recording,
        views: tuple,
        rate: float | None,
        progress: Callable,
        keeper: StateKeeper | None,
        response: ResponseModel | None,
        laws: Sequence[Law],
    ):
        self._keeper = keeper
        self._estimation = None
        if response is not None and scene.estimation.is_asked:
            from bearing_sim.watchers.estimation.live import LiveEstimation

            self._estimation = LiveEstimation(scene, response)
            self._estimation.know([channel for channel, stamps in profile.stamps.items() if len(stamps)])
        self._newest: np.void | None = None  # that the keeper has counted
        self._scene, self._profile, self._views, self._progress, self._rate = scene, profile, views, progress, rate
        self._recordings = (recording,) if recording is not None else ()
        self._result = Replay(profile.log_seconds, slip_from_speed=scene.thresholds.slip_from_speed)
        self._pending_events = list(profile.events)
        self._pending_clearances = deque(profile.measured_clearance)
        self._changes = Changes()
        self._watched: list[np.ndarray] = []
        self._untaken: list[Output] = []
        self._next_report = 0.0
        self._monitor, self._limits, self._watchers = Monitor(scene), LimitsMonitor(scene, laws), Watchers(scene)
        self._unjudged: list[np.ndarray] = []
        self._unestimated: list[np.ndarray] = []
        self._comparison = Comparison(ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed))
        if keeper is not None:
            keeper.restart()
            recall(keeper, self._comparison.residual, self._monitor, self._estimation, profile.start_ns)
        for time_, speed, error in profile.measured:
            self._comparison.measure(time_, speed, error)
            if self._may_teach(time_):
                self._estimation.measure(time_, speed, error)
        for time_, clearance, error in profile.measured_clearance:
            if self._may_teach(time_):
                self._estimation.measure_clearance(time_, clearance, error)

    def _may_teach(self, moment: float) -> bool:
        """Whether a measurement at a time [s] calibrates: not where the bearing's state contains what it taught."""
        contained = self._keeper is not None and self._keeper.contained(self._profile.start_ns + round(1e9 * moment))
        return self._estimation is not None and not contained

    def run(self, model: Callable[[Scene, Inputs], Simulation]) -> Replay:
        began, began_cpu = time.perf_counter(), time.process_time()
        result, outputs_only = self._result, not self._recordings and not self._views and not self._scene.estimation.calibrated
        run = ProfileRun(partial(self._begin, model), outputs_only)
        segment = self._profile.segment(self._rate, self._scene.lubricant.temperature)
        together = 1
        for k, item in enumerate(run.advance_segment(segment)):
            moment = float(item.block["time"][-1]) if isinstance(item, Output) else item.time
            self._write_events_until(moment)
            if isinstance(item, Output):
                self._untaken.append(item)
                if len(self._untaken) >= together or len(item.block) > 1:
                    self._take_outputs()
            else:
                if isinstance(item, Event):
                    self._take_outputs()  # they come first
                    self._write_event(item)
                elif isinstance(item, Begun):
                    if self._keeper is not None:
                        self._keeper.count(item.block, self._profile.start_ns, np.zeros(len(item.block)))
                    for recording in self._recordings:
                        recording.write(Start(item.block))
                    # Not where outputs take long, so that a recording that is cut short has them; nor where a measurement acts on the next output.
                    is_fast = getattr(run.simulation, "takes_profiles", False) and not self._scene.estimation.calibrated
                    together = _TOGETHER if is_fast else 1
                else:
                    for recording in self._recordings:
                        recording.write(ReceivedInputs(*item))
            if k % _PROGRESS_EVERY == 0:
                self._progress(moment)
        if not run.given_up:
            self._progress(self._profile.end * 1e-9)
        self._take_outputs()
        self._judge_limits()
        self._estimate()
        self._write_events_until(math.inf)
        if self._profile.unknown_seconds:
            self._write_event(self._profile.unknown_event)
        self._watchers.close()
        self._write_to_views()
        if self._newest is not None:
            self._note_condition()
        if run.simulation is not None:
            result.steps, result.rejected_steps, result.non_finite_steps = run.simulation.counters[:3]
        result.sim_seconds, result.gap_seconds = run.simulated_ns * 1e-9, run.in_gaps_ns * 1e-9
        result.failed_ticks, result.given_up = run.failures, run.given_up
        result.warnings, result.worst_samples = self._limits.exceedances, self._limits.worst_samples
        result.wall_seconds, result.cpu_seconds = time.perf_counter() - began, time.process_time() - began_cpu
        return result

    def _begin(self, model: Callable[[Scene, Inputs], Simulation], inputs: Inputs) -> Simulation:
        simulation = model(self._scene, inputs)
        if self._keeper is not None:
            warm_start(self._keeper, lambda: self._profile.start_ns)(simulation, inputs)
        return simulation

    def _count(self, output: Output) -> None:
        """Count outputs for the bearing's state, and have it written from time to time."""
        keeper, start_ns = self._keeper, self._profile.start_ns
        keeper.count(output.block, start_ns, output.weights)
        self._newest = output.block[-1]
        if keeper.is_due:
            self._note_condition()
            keeper.hold(0.0)
            keeper.release(math.inf)

    def _note_condition(self) -> None:
        """Put temperatures and what the monitors have learned into the bearing's state."""
        newest = self._newest
        time_ns = self._profile.start_ns + round(1e9 * float(newest["time"]))
        note(self._keeper, self._comparison.residual, self._monitor, self._estimation, newest, time_ns)

    def _take_outputs(self) -> None:
        """Write and judge the outputs since the last call."""
        outputs, self._untaken = self._untaken, []
        if outputs:
            self._take(Output(joined([each.block for each in outputs]), np.concatenate([each.weights for each in outputs])))

    def _take(self, output: Output) -> None:
        """Write outputs and judge them."""
        block, result = output.block, self._result
        result.samples += len(block)
        result.weight += output.weights.tolist()
        for kept, name in ((result.time, "time"), (result.slip, "cage_slip"), (result.speed, "shaft_speed"), (result.life, "rating_life")):
            kept += block[name].tolist()
        result.load += np.hypot(block["load_y"], block["load_z"]).tolist()
        result.damage = float(block["damage"][-1])  # of this run alone
        if self._keeper is not None:
            self._count(output)
        for recording in self._recordings:
            recording.write(block)
        if self._views:
            self._watched.append(block)
            if sum(map(len, self._watched)) >= _WATCHED_BLOCK:
                self._write_to_views()
        if self._estimation is not None:
            self._unestimated.append(block)
            if self._scene.estimation.calibrated or sum(map(len, self._unestimated)) >= _ESTIMATED:  # measurements act from output to output
                self._estimate()
        for begin in range(0, len(block), _JUDGED):
            part = block[begin : begin + _JUDGED]
            self._unjudged.append(part)
            if sum(map(len, self._unjudged)) >= _JUDGED:
                self._judge_limits()
            self._judge_until_reports(part)

    def _estimate(self) -> None:
        """Write the bands of the outputs since the last call: those of many at once cost a fraction of single ones."""
        blocks, self._unestimated = self._unestimated, []
        if blocks:
            whole = joined(blocks)
            for bands in self._estimation.take(whole):
                self._write_bands(bands, whole)

    def _judge_limits(self) -> None:
        """Write which limits of validity the outputs since the last call began or ceased to exceed: many at once cost little more than one."""
        blocks, self._unjudged = self._unjudged, []
        if blocks:
            for event in self._limits.take(joined(blocks)):
                self._write_event(event)

    def _judge_until_reports(self, block: np.ndarray) -> None:
        """Judge outputs in parts, each of which ends where the bearing's condition is to be written."""
        while len(block):
            due = int(np.searchsorted(block["time"], self._next_report)) if self._recordings else len(block)
            self._judge(block[: due + 1])
            block = block[due + 1 :]

    def _judge(self, block: np.ndarray) -> None:
        """Judge outputs one by one, or all at once if none of them can raise or clear an alarm."""
        if len(block) > 1 and not self._changes.holding and not self._scene.watchers and self._monitor.is_calm(block):
            self._monitor.take_calm(block[:-1])
            for compared in self._comparison.predict(block[:-1]):
                self._write_measured(compared)
            block = block[-1:]
        for k in range(len(block)):
            self._monitor.take(block[k : k + 1])
            for record in self._watchers.see(block[k : k + 1]):
                self._write(record)
            for compared in self._comparison.predict(block[k : k + 1]):
                self._write_measured(compared)
            self._report(block[k], float(block["time"][k]))

    def _write_bands(self, bands: Bands, block: np.ndarray) -> None:
        if bands.topic == BANDS:
            numbers, speeds = bands.numbers.copy(), block["shaft_speed"][np.searchsorted(block["time"], bands.times)]
            numbers[~turns(speeds, self._result.slip_from_speed), bands.names.index("cage_slip")] = math.nan
            self._result.bands.append(bands._replace(numbers=numbers))
        self._write(bands)

    def _write_measured(self, compared: Measurement) -> None:
        self._watchers.hear(topics.MEASURED, compared.time, compared.cage_speed, compared.standard_error)
        self._write(compared)

    def _report(self, sample, moment: float) -> None:
        """Write a change of the bearing's condition at once, and the condition once a second."""
        residual = self._comparison.residual
        judged = residual.events(moment)
        if self._estimation is not None:  # what the calibrated model does not explain, instead of what the scene's own values do not
            judged = self._estimation.events(moment) if self._estimation.is_calibrated else [*judged, *self._estimation.events(moment)]
        changes = self._changes.take(moment, (*self._monitor.events(moment), *self._watchers.events(moment), *judged))
        if changes or moment >= self._next_report:
            self._judge_limits()  # their events come first
            self._estimate()
        for event in changes:
            self._write_event(event)
        if moment >= self._next_report:
            # A hundredth early, so that reports stay at whole seconds although stamps jitter.
            self._next_report = (math.floor(moment / _REPORT_EVERY + 0.01) + 0.99) * _REPORT_EVERY
            if not self._recordings:
                return
            holding = [*self._changes.holding.values(), *self._limits.events(moment)]
            worst_first = sorted(holding, key=lambda event: -event.level)
            values = condition(sample) | further_condition(self._scene, sample) | self._monitor.values | residual.values(moment)
            values |= self._estimation.values(moment) if self._estimation is not None else {}
            values |= self._watchers.values(moment)
            for recording in self._recordings:
                recording.write(Report(moment, worst_first, values))

    def _write_to_views(self) -> None:
        if self._watched:
            block = np.concatenate(self._watched)
            self._watched = []
            for view in self._views:
                view.write(block)

    def _write_event(self, event: Event) -> None:
        self._result.events[event.kind] += 1
        self._write(event)

    def _write(self, record: Record) -> None:
        for sink in (*self._recordings, *self._views):
            sink.write(record)

    def _write_events_until(self, moment: float) -> None:
        """Write the events and the measured clearances of the log up to a time [s]."""
        while self._pending_clearances and self._pending_clearances[0][0] <= moment:
            reading = MeasuredClearance(*self._pending_clearances[0])
            self._watchers.hear(topics.MEASURED_CLEARANCE, *reading[:3])
            self._write(reading)
            self._pending_clearances.popleft()
        while self._pending_events and self._pending_events[0].time <= moment:
            self._take_outputs()  # they come first
            self._write_event(self._pending_events.pop(0))
