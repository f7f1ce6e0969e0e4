# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model that takes messages and gives samples and events while time passes: gate, solver, monitors and sinks, free of ROS.

`Model` is what a run in wall time (`LiveModel`) and a run in simulated time (`bearing_sim.runtime.sim_time.SimTimeModel`) have in common.
The node is a thin front end; another one (a socket, a test) would use the same methods.
"""

import dataclasses
import math
import time
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from bearing_sim.inputs.gate import CHANNELS, REQUIRED, Coverage, InputGate, PublisherConflict, Sources, unused_event, with_values
from bearing_sim.levels.steady.table_builder import cached_table
from bearing_sim.messages import topics
from bearing_sim.messages.bands import BANDS, Bands
from bearing_sim.messages.diagnostics import SETTING_ERRORS, further_condition, sink_subject
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, ReceivedInputs, Report
from bearing_sim.model.plausibility import plausibility
from bearing_sim.model.sample import RING_TEMPERATURES, joined
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition, Health, Phase, level_of, numbers, remarks
from bearing_sim.runtime.pacing import LONGEST_TICK, Decimator, OutputCount, Pacer, WallClock, tick_schedule
from bearing_sim.runtime.remembering import note, recall, recall_estimates, warm_start
from bearing_sim.runtime.sink_registry import Sink, SinkRegistry
from bearing_sim.runtime.solver import Solver, WallTimeSolver
from bearing_sim.runtime.solver_threads import SolverThreads
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.fidelity import lower_levels
from bearing_sim.scene.loader import with_setting
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.watchers.estimation.two_states import laws_of_table
from bearing_sim.watchers.monitoring.limits import LimitsMonitor
from bearing_sim.watchers.monitoring.monitor import Monitor
from bearing_sim.watchers.monitoring.residual import ResidualMonitor
from bearing_sim.watchers.monitoring.watchers import Watchers
from bearing_sim.watchers.stored_state.keeper import StateKeeper

if TYPE_CHECKING:
    from bearing_sim.watchers.estimation.live import LiveEstimation
    from bearing_sim.watchers.estimation.response import ResponseModel
    from bearing_sim.watchers.vibration.meter import CageSpeedMeter
    from bearing_sim.watchers.vibration.reading import Block

_REPLACED_WITHIN = 10.0  # [s] for the reset of a model that is held
_CLOCKS = 3  # times 0 by clocks before the present one under which a recording may have its stamps
_SLACK = 4.0  # [s] how long blocks wait to be collected before the oldest are dropped


class Published(NamedTuple):
    """An output to be published."""

    stamp_ns: int  # [ns since the epoch]
    sample: np.void


def warmed_up(scene: Scene) -> Simulation:
    """Return a simulation whose code is compiled or loaded, so that its first tick takes no longer than the others.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed.
    """
    simulation = Simulation(scene)
    simulation.advance(LONGEST_TICK, simulation.inputs)
    return simulation


def governor_of(simulation: Simulation, settings: Sequence[Setting] = (), courses: Sequence[MeasuredCourse] = ()) -> Governor | None:
    """Return a governor over a simulation's settings, or its level and the levels of lower fidelity that support its scene; None if there are none.

    Their code is compiled or loaded here.  Without measured settings lower levels use the scene's tolerances, and level ``steady`` a plain table
    where the scene's corrected one is not on disk.

    Parameters
    ----------
    simulation : at the wanted setting.
    settings : from that of the simulation to the fastest (see `bearing_sim.runtime.governor.settings_to_fall`); empty where nothing was measured.
    courses : that they were measured on.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed at one of them.
    """
    if settings:
        ladder, chosen = [simulation], list(settings[:1])
        for setting in settings[1:]:
            try:
                ladder.append(warmed_up(with_setting(simulation.scene, setting)))
            except (IntegrationError, SceneError):  # it was measured at other conditions than the scene's own
                continue
            chosen.append(setting)
        if len(ladder) > 1:
            return Governor(ladder, settings=chosen, courses=courses)
    scene = dataclasses.replace(simulation.scene, integration=dataclasses.replace(simulation.scene.integration, fixed_step=None))
    lower = [warmed_up(_at_lower_level(scene, level)) for level in lower_levels(scene)]
    return Governor([simulation, *lower]) if lower else None


def _at_lower_level(scene: Scene, level: str) -> Scene:
    """Return a scene at a lower level, whose table is a plain one where the corrected one that it asks for is not on disk."""
    lower = dataclasses.replace(scene, level=level)
    if level != "steady" or lower.table.correction == "none" or cached_table(lower) is not None:
        return lower
    return dataclasses.replace(lower, table=dataclasses.replace(lower.table, correction="none"))


class Model:
    """One bearing under way; base of `LiveModel` and `bearing_sim.runtime.sim_time.SimTimeModel`.

    All methods belong to one thread (the node's); the simulation runs on the solver's.

    Parameters
    ----------
    scene : what is simulated; its limits judge the messages, its thresholds the bearing.
    gate : judges the messages.
    solver : the thread that advances the simulation.
    start_ns : run time 0 [ns since the epoch].
    keeper : of the bearing's state; None where nothing is remembered.
    response : of the scene, for what its block ``estimation`` asks for; without one nothing is estimated, which is reported.
    inputs_expected_within : time from the start within which a good message of speed and of load is expected [s], and of any channel that
        somebody publishes.

    Attributes
    ----------
    level : Level
        The worst level that held when `collect` last reviewed the health.
    """

    def __init__(
        self,
        scene: Scene,
        gate: InputGate,
        solver: Solver,
        start_ns: int,
        keeper: StateKeeper | None = None,
        response: "ResponseModel | None" = None,
        inputs_expected_within: float = 10.0,
    ):
        self.keeper = keeper
        self._inputs_expected_within = inputs_expected_within
        self._sources: dict[str, Sources] = {}
        self._estimation = _estimation(scene, response) if response is not None and scene.estimation.is_asked else None
        self._bands: list[Bands] = []
        self._slip_band = math.nan  # upper end of the newest band of slip
        self._counted: np.void | None = None  # the newest sample that is in the bearing's state
        self.scene, self.gate, self.solver, self.start_ns = scene, gate, solver, start_ns
        self.health, self.monitor, self.limits = Health(), Monitor(scene), LimitsMonitor(scene, laws_of_table(scene))
        self.residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self.sinks, self.watchers = SinkRegistry(), Watchers(scene)
        self.level = Level.OK
        self._conflicts = {channel: PublisherConflict(channel) for channel in CHANNELS}
        self._unused: set[str] = set()
        self._residuals: list[tuple[int, float]] = []
        for finding in plausibility(scene):
            field, _, reason = finding.partition(": ")
            self.health.note(Event(0.0, Level.WARN, "scene.implausible", field, reason))
        self._recall()

    def run_time(self, now_ns: int) -> float:
        """Return the run time [s] of an instant of the clock."""
        return (now_ns - self.start_ns) * 1e-9

    def stamp(self, run_time: float) -> int:
        """Return the instant of the clock [ns since the epoch] of a run time [s]."""
        return self.start_ns + round(run_time * 1e9)

    def tick(self, now_ns: int) -> None:
        """Take a reading of the clock [ns since the epoch]."""
        raise NotImplementedError

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int, frame_id: str = "") -> Event | None:
        """Take one message (see `bearing_sim.inputs.gate.InputGate.offer`); returns the event if it is refused.

        Parameters
        ----------
        stamp_ns : the sender's stamp; None for a message without one.
        now_ns : the clock.
        frame_id : the frame that the message names.
        """
        raise NotImplementedError

    def set_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Set the oil temperature [K] from now on, in place of the scene's.  Messages of the topic replace it."""
        raise NotImplementedError

    def publish_at(self, rate: float) -> None:
        """Change the rate of published outputs [Hz]."""
        raise NotImplementedError

    def published(self) -> list[Published]:
        """Return the outputs to be published since the last call."""
        raise NotImplementedError

    def refuse(self, channel: str, kind: str, reason: str, now_ns: int) -> Event:
        """Take a message that could not be read."""
        event = self.gate.refuse(channel, self.run_time(now_ns), kind, reason)
        self._note(event)
        return event

    def note_publishers(self, channel: str, count: int) -> None:
        """Take the number of publishers of a channel; more than one is reported, and any one of a channel that the scene does not use."""
        self._conflicts[channel].publishers = count
        if channel in RING_TEMPERATURES and not self.scene.uses_ring_temperatures:
            self._unused = self._unused | {channel} if count else self._unused - {channel}

    def note_sources(self, channel: str, sources: Sources) -> None:
        """Take what is known of the topic of a channel."""
        self._sources[channel] = sources
        self.note_publishers(channel, sources.publishers)

    def adjust(self, thresholds: Thresholds) -> None:
        """Use other thresholds from now on; what was learned about the measured cage is kept."""
        self.scene = dataclasses.replace(self.scene, thresholds=thresholds)
        self.monitor.adjust(thresholds)
        self.limits.adjust(thresholds)
        self.residual.adjust(thresholds.residual, thresholds.slip_from_speed)
        if self._estimation is not None:
            self._estimation.adjust(thresholds)
        if self.keeper is not None:
            self.keeper.adjust(self.scene)

    def replace_bearing(self, change: Callable[[], StateKeeper]) -> None:
        """Continue with another bearing of the same scene, in ideal rolling at the present inputs.

        Parameters
        ----------
        change : ends the state of the present bearing, which by then contains all its samples, and returns the keeper of the other one's.

        Raises
        ------
        OSError
            As ``change``, or the model did not stop within two seconds; nothing is changed.
        """
        was_paused = self.solver.is_paused
        try:
            if not self.solver.hold():
                raise OSError("the model is busy and did not stop within two seconds; call the service again")
            self._take(self.solver.take(), 0.0 if self._counted is None else float(self._counted["time"]))
            self.keeper = change()
            self._counted = None
            self.solver.continue_from(self.keeper.used)
            self.solver.reset(_REPLACED_WITHIN)
            self._recall()
        finally:
            self.solver.pause(was_paused)

    def _recall(self) -> None:
        """Let the monitors continue from what the bearing's state remembers."""
        if self.keeper is None:
            return
        self.keeper.restart()
        recall(self.keeper, self.residual, self.monitor, self._estimation, self.start_ns)

    def _keep_state(self) -> None:
        """Write the bearing's state from time to time."""
        keeper, newest = self.keeper, self._counted
        keeper.release(self._published_until)
        if keeper.is_due and newest is not None:
            self._note_condition()
            keeper.hold(float(newest["time"]))

    def _note_condition(self) -> None:
        """Put temperatures and what the monitors have learned into the bearing's state."""
        if self._counted is not None:
            note(self.keeper, self.residual, self.monitor, self._estimation, self._counted, self.stamp(float(self._counted["time"])))

    @property
    def _published_until(self) -> float:
        """Time of the newest sample that is surely published [s]."""
        return math.inf

    def open(self, name: str, open_sink: Callable[[int], Sink], reopen: bool = False) -> None:
        """Add a sink that gets samples and events from now on.

        Parameters
        ----------
        name : of the sink.
        open_sink : makes the sink from run time 0 [ns since the epoch].
        reopen : whether to complete it and make another one each time the run starts again at another run time 0, because times in one
            sink would overlap; this happens in simulated time only.

        Raises
        ------
        OSError
            It cannot be made.
        """
        self.sinks.attach(name, open_sink(self.start_ns))

    def has(self, name: str) -> bool:
        """Return whether there is a sink with this name."""
        return name in self.sinks

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None if there is none with this name (see `bearing_sim.runtime.sink_registry.SinkRegistry.detach`)."""
        return self.sinks.detach(name)

    @property
    def has_residuals(self) -> bool:
        """Whether there are residual slips to be published."""
        return bool(self._residuals)

    def residuals(self) -> list[tuple[int, float]]:
        """Return the residual slips since the last call that are to be published, each with its stamp [ns since the epoch]."""
        residuals, self._residuals = self._residuals, []
        return residuals

    def estimate_by(self, response: "ResponseModel") -> None:
        """Estimate from now on what the scene asks for, by its response, which has been built while the run goes on."""
        self._estimation = _estimation(self.scene, response)
        if self.keeper is not None:
            recall_estimates(self.keeper, self._estimation, self.start_ns)

    def accept_change(self) -> bool:
        """Take the machine as it is since a change for the new normal; return whether there was a change to accept."""
        return self._estimation is not None and self._estimation.accept_change()

    def bands(self) -> list[Bands]:
        """Return the bands since the last call, which are to be published."""
        bands, self._bands = self._bands, []
        return bands

    def _watch(self, blocks: Sequence[np.ndarray], now: float) -> None:
        """Let the optional watchers see samples, at run time ``now`` [s]."""
        if blocks and self.scene.watchers:
            for record in self.watchers.see(joined(blocks)):
                self.sinks.write(now, record)

    def _estimate(self, block: np.ndarray, now: float) -> None:
        """Estimate at samples in order, shape (n,), at run time ``now`` [s]."""
        if self._estimation is None:
            return
        self._estimation.know([channel for channel, count in self.gate.accepted.items() if count])
        for bands in self._estimation.take(block):
            self.sinks.write(now, bands)
            self._bands.append(bands)
            if bands.topic == BANDS:
                self._slip_band = float(bands.numbers[-1, bands.names.index("cage_slip"), 2])

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start (see `bearing_sim.runtime.solver.Solver.reset`)."""
        return self.solver.reset(timeout)

    def pause(self, paused: bool = True) -> None:
        """Hold simulated time, or continue."""
        self.solver.pause(paused)

    def collect(self, now_ns: int) -> list[Event]:
        """Pass results of the solver to sinks and monitors and review the health.  Returns the events that are new."""
        self.tick(now_ns)
        now = self.run_time(now_ns)
        self._take(self.solver.take(), now)
        for event in self.sinks.news(now):
            self._note(event)
        if self.keeper is not None:
            self._keep_state()
            for event in self.keeper.news(now):
                self._note(event)
        events = self._events(now)
        self.level = level_of(events)
        news = self.health.news(events)
        for event in news:
            self.sinks.write(event.time, event if event.time >= 0.0 else event._replace(time=0.0))
        return news

    def condition(self, now_ns: int) -> Condition:
        """Return the health now, with the numbers behind it."""
        now, newest = self.run_time(now_ns), self.solver.newest
        further = further_condition(self.scene, newest) if newest is not None else {}
        values = numbers(self.gate, self.solver) | {"level": self._running_level} | self._setting_values() | further
        values["inputs unknown [s]"] = self.gate.coverage.unknown_until(now)
        values |= self._flow_numbers(now)
        for conflict in self._conflicts.values():
            values |= conflict.values
        values |= self.monitor.values | self.residual.values(now) | self.sinks.values | self._values() | self.watchers.values(now)
        values |= self.keeper.values if self.keeper is not None else {}
        values |= self._estimation.values(now) if self._estimation is not None else {}
        said = remarks(self.gate, self.solver, self._running_setting or self._running_level) | self.sinks.remarks
        if self._estimation is not None:
            said["estimate"] = self._estimation.remark
        if self.keeper is not None:
            said["state"] = str(self.keeper.path)
        unused = self._idle_subjects()
        return Condition(self._events(now), values, said | self._remarks() | unused, unused=frozenset(unused))

    def _idle_subjects(self) -> dict[str, str]:
        """Return the subjects of diagnostics that this run does without, and why."""
        published = {channel for channel, sources in self._sources.items() if sources.publishers}
        idle = (channel for channel in CHANNELS if channel not in REQUIRED and channel not in published and not self.gate.is_heard(channel))
        unused = {channel: self.gate.state(channel) for channel in idle}
        if "view" not in map(sink_subject, self.sinks.by_name):
            unused["view"] = "no view"
        if self._estimation is None:
            unused["estimate"] = "the scene does not ask for it"
        if self.keeper is None:
            unused["state"] = "nothing is remembered"
        if not self.scene.watchers:
            unused["watchers"] = "the scene names none"
        if topics.MEASURED in unused and not self.scene.uses_ring_temperatures:
            unused["residual"] = "nothing is measured that could be compared"
        if self.scene.thresholds.pocket_force_warning is None and self.scene.thresholds.pocket_force_error is None:
            unused["pocket_force"] = "not judged: it has no threshold"
        return unused | {"vibration": "not listened to: the scene does not ask for it, or the run has simulated time"}

    def record_diagnostics(self, condition: Condition, now_ns: int) -> None:
        """Write a diagnostics report to the recorders."""
        now = self.run_time(now_ns)
        self.sinks.write(now, Report(now, condition.events, condition.values))

    def close(self, timeout: float = 2.0) -> bool:
        """Stop the solver, pass on its last results and complete the sinks.

        Returns
        -------
        Whether the solver's thread ended within ``timeout`` [s].
        """
        stopped = self.solver.stop(timeout)
        self._take(self.solver.take(), 0.0)
        if self.keeper is not None:
            self._note_condition()
            self.keeper.save()
        self.watchers.close()
        self.sinks.close(0.0)
        return stopped

    @property
    def _running_level(self) -> str:
        return self.scene.level

    @property
    def _running_setting(self) -> str:
        """The measured setting that runs, in words; empty where none is known."""
        return ""

    def _setting_values(self) -> dict[str, object]:
        """Return the setting that runs and its measured errors for diagnostics; NaN where they were not measured, as at other speeds or loads."""
        return {"setting": self._running_setting or "not measured", **dict.fromkeys(SETTING_ERRORS, math.nan)}

    def _take(self, items: Iterable, now: float) -> None:
        """Pass results of the solver on at run time ``now`` [s]."""
        raise NotImplementedError

    def _review_time(self, now: float) -> float:
        """Return the time by which events age [s] at run time ``now`` [s]."""
        return now

    def _further_events(self, now: float) -> list[Event]:
        """Return the events of the kind of run that hold at ``now`` [s]."""
        raise NotImplementedError

    def _flow_numbers(self, now: float) -> dict[str, float]:
        """Return the numbers behind the flow of messages (see `bearing_sim.inputs.gate.InputGate.numbers`)."""
        return self.gate.numbers(now)

    def _explained(self, flow: Sequence[Event], now: float, waited: float) -> list[Event]:
        """Return what is wrong with the flow of messages with the likely causes, and which channels have had no good message at all.

        Parameters
        ----------
        flow : events of the gate.
        now : [s].
        waited : for how long messages could have come [s].
        """
        explained = []
        for channel in CHANNELS:
            sources, own = self._sources.get(channel), [event for event in flow if event.subject == channel]
            unheard = sources.events(channel, now) if sources is not None else []
            if not own and not unheard and (channel in REQUIRED or sources is not None and sources.publishers):
                absent = self.gate.absent(channel, now, waited, self._inputs_expected_within)
                own = [] if absent is None else [absent]
            if sources is not None and not unheard:
                known = self.gate.accepted[channel] > 0, self.gate.is_refusing(channel)
                own = [sources.explained(event, *known) if event.kind in ("input.stale", "input.absent") else event for event in own]
            explained += unheard + own
        return explained

    def _values(self) -> dict[str, object]:
        """Return the diagnostics values of the kind of run."""
        return {}

    def _remarks(self) -> dict[str, str]:
        """Return what the kind of run says about subjects without events, by name."""
        return {}

    def _events(self, now: float) -> list[Event]:
        """Return the events that hold at ``now`` [s], the worst first."""
        conflicts = [event for conflict in self._conflicts.values() if (event := conflict.event(now)) is not None]
        conflicts += [unused_event(now, channel) for channel in sorted(self._unused)]
        judged = [*self.monitor.events(now), *self.limits.events(now), *self.watchers.events(now)]
        if self._estimation is not None:
            judged += self._estimation.events(now)
        if self._estimation is None or not self._estimation.is_calibrated:  # else what the calibrated model does not explain is judged
            judged += self.residual.events(now)
        kept = self.keeper.events(now) if self.keeper is not None else []
        kept += [_no_response(now)] if self._estimation is None and self.scene.estimation.is_asked else []
        events = [*self.sinks.events(now), *kept, *judged, *self._further_events(now), *conflicts]
        coverage = self.gate.coverage
        if coverage.is_overloaded:
            events.append(Event(now, Level.WARN, "input.unknown", "", "inputs were refused because they were too large", coverage.verdict))
        return self.health.events(self._review_time(now), events, self.solver)

    def _note(self, event: Event) -> None:
        self.health.note(event, self._review_time(event.time))

    def _note_solver_event(self, event: Event, now: float) -> None:
        """Note an event of the solver that is seen at ``now`` [s]; after a reset, judge the bearing from the start."""
        if event.kind == "governor.change":  # keeps its own time: the samples after it are of another setting
            self.health.note(event, self._review_time(now))
            return
        self._note(event._replace(time=now))
        if event.kind == "run.reset":
            self.gate.coverage = Coverage()
            self.monitor.restart()
            self.limits.restart()
            self.watchers.restart(event.reason)
            self.residual.interrupt(event.time)
            if self._estimation is not None:
                self._estimation.restart()
            if self.keeper is not None:
                self.keeper.restart()


# Imported where a scene asks for them, because they take as long as all the rest.
def _estimation(scene: Scene, response: "ResponseModel") -> "LiveEstimation":
    from bearing_sim.watchers.estimation.live import LiveEstimation

    return LiveEstimation(scene, response)


def _meter(scene: Scene) -> "CageSpeedMeter":
    from bearing_sim.watchers.vibration.meter import CageSpeedMeter

    return CageSpeedMeter(scene)


def _no_response(now: float) -> Event:
    """Return the event of a scene that asks for estimates, and for which nothing is kept that they could come from."""
    reason = "the scene asks for bands or a calibration, and no response of the bearing to its uncertain fields is kept here; nothing is estimated"
    return Event(now, Level.WARN, "estimate.absent", "", reason, "build it with bearing-sim table SCENE --bands, with the same --set")


class LiveModel(Model):
    """One bearing in real time: messages act as they arrive.

    Parameters
    ----------
    scene : what is simulated.
    simulation : the warmed-up simulation of the scene.
    start_ns : the receiver's clock at run time 0 [ns since the epoch].
    sample_rate : samples that sinks get for each simulated second [Hz].
    maximum_lag : lag behind wall time that is caught up [s]; a larger one is skipped and counted.
    clock : wall clock of the solver [s], monotonic.
    governor : see `governor_of`; without one the level stays, and time is skipped where it is too slow.
    publish_rate : outputs to be published in each second [Hz].
    due : called on the solver's thread when an output is to be published; must return at once.
    receiver : reads the receiver's clock [ns since the epoch] (see `bearing_sim.runtime.pacing.WallClock`).
    threads : shared with the solvers of other bearings; a thread of its own where absent.
    keeper : of the bearing's state, which all time of the run counts for; None where nothing is remembered.
    response, inputs_expected_within : see `Model`.
    stamp_tolerance : how far stamps may be from the receiver's clock before that is reported [s]; messages act as they arrive all the same.

    Attributes
    ----------
    schedule : TickSchedule
        Ticks that samples are made of now.
    """

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        start_ns: int,
        sample_rate: float = 100.0,
        maximum_lag: float = 0.2,
        clock: Callable[[], float] = time.monotonic,
        governor: Governor | None = None,
        publish_rate: float = 50.0,
        due: Callable[[], None] | None = None,
        receiver: Callable[[], int] | None = None,
        threads: SolverThreads | None = None,
        keeper: StateKeeper | None = None,
        response: "ResponseModel | None" = None,
        inputs_expected_within: float = 10.0,
        stamp_tolerance: float = 2.0,
    ):
        self._governor, self._fallen = governor, None
        self._sample_rate, self.schedule = sample_rate, tick_schedule(sample_rate, publish_rate)
        pacer, capacity = Pacer(1.0, maximum_lag), round(_SLACK / tick_schedule(sample_rate, math.inf).tick)
        begin, used = (None, None) if keeper is None else (warm_start(keeper, lambda: self.stamp(clock() - began)), keeper.used)
        began = clock()
        solver = WallTimeSolver(simulation, pacer, self.schedule, capacity, clock, governor, self._advanced, threads, begin, used)
        held = simulation.inputs._replace(**dict.fromkeys(RING_TEMPERATURES, math.nan))  # measured in this run or not at all
        gate = InputGate(scene.accepted_inputs, held, heat_law=scene.heat.law, stamp_tolerance=stamp_tolerance)
        super().__init__(scene, gate, solver, start_ns, keeper, response, inputs_expected_within)
        self._starts_ns = [start_ns]  # by the clock now, and before it was set
        self._sample_decimator, self._publish_decimator, self._due = Decimator(sample_rate), Decimator(publish_rate), due
        self._wall_clock = WallClock(start_ns, clock, receiver)
        self._published_time = -math.inf
        self._anchors, self._output_count = 0, OutputCount()
        self._meter = _meter(scene) if scene.vibration.is_asked else None
        self.solver.start()

    def tick(self, now_ns: int) -> None:
        """Take a reading of the receiver's clock; if the clock was set, its stamps count from another start so that run time continues."""
        if jump := self._wall_clock.jump(now_ns):
            self.start_ns += round(jump * 1e9)
            self._starts_ns = [self.start_ns, *self._starts_ns[-_CLOCKS:]]
            action = "the run and its recording continue by the clock from before"
            self._note(Event(self.run_time(now_ns), Level.WARN, "clock.jumped", "", f"the clock was set by {jump:+.6g} s", action))

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int, frame_id: str = "") -> Event | None:
        """Take one message (see `Model.offer`); recorders get it as it is, even if it is refused."""
        self.tick(now_ns)
        now = self.run_time(now_ns)
        if channel not in topics.MEASURED_CHANNELS and self.sinks.recorders:
            inputs = with_values(self.gate.held, channel, values)
            self.sinks.write(now, ReceivedInputs(now, inputs, [channel], topics.Origin(stamp_ns, frame_id)))
        event = self.gate.offer(channel, now if stamp_ns is None else self.run_time(stamp_ns), values, now)
        if event is not None:
            self._note(event)
            return event
        for returned in self.gate.take_returned():
            self._note(returned)
        self._conflicts[channel].take(values[:1] if channel in topics.MEASURED_CHANNELS else values)
        if channel == topics.MEASURED:
            self._compare(now, topics.Origin(stamp_ns, frame_id))
        elif channel == topics.MEASURED_CLEARANCE:
            self._take_clearance(now, topics.Origin(stamp_ns, frame_id))
        # Speed starts the model: the scene has sensible values of load and temperature, but a wrong speed would be a false jolt.
        elif self.gate.accepted["shaft_speed"]:
            self.solver.post(self.gate.held)
        return None

    def offer_vibration(self, block: "Block | str", now_ns: int) -> None:
        """Take a block of vibration, or why a message cannot be read as one; nothing is done where the scene does not ask for it."""
        if self._meter is None:
            return
        self.tick(now_ns)
        now = self.run_time(now_ns)
        speed = self.gate.held.shaft_speed if self.gate.accepted["shaft_speed"] else math.nan
        newest = self.solver.newest
        possible = max(filter(math.isfinite, (self._slip_band, math.nan if newest is None else float(newest["cage_slip"]))), default=0.0)
        events = [self._meter.refuse(block, now)] if isinstance(block, str) else self._meter.take(block, now, speed, possible)
        for event in events:
            self._note(event)

    def set_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Set the oil temperature [K] (see `Model.set_oil_temperature`)."""
        self.gate.hold_oil_temperature(temperature)
        if self.gate.accepted["shaft_speed"]:
            self.solver.post(self.gate.held)
        now = self.run_time(now_ns)
        self.sinks.write(now, ReceivedInputs(now, self.gate.held, ["oil_temperature"], topics.Origin(None, "")))

    def collect(self, now_ns: int) -> list[Event]:
        """Pass results of the solver on and review the health (see `Model.collect`)."""
        if self.gate.expire(self.run_time(now_ns)) and self.gate.accepted["shaft_speed"]:
            self.solver.post(self.gate.held)
        if self._meter is not None:
            for reading in self._meter.readings(self.gate.held.shaft_speed):
                self.offer(topics.MEASURED, reading, None, now_ns)
        self._output_count.take(self.run_time(now_ns), self._publish_decimator.picked, self._publish_decimator.left_out)
        return super().collect(now_ns)

    def publish_at(self, rate: float) -> None:
        """Change the rate of published outputs [Hz]."""
        self._publish_decimator.rate, self.schedule = rate, tick_schedule(self._sample_rate, rate)
        self.solver.tick_by(self.schedule)

    def published(self) -> list[Published]:
        """Return the newest sample if it was not returned before."""
        sample = self.solver.newest
        if sample is None or sample["time"] <= self._published_time:
            return []
        self._published_time = float(sample["time"])
        return [Published(self.stamp(self._published_time), sample)]

    def govern(self, governor: Governor | None) -> None:
        """Let a governor change levels from now on; None returns to the scene's level (see `bearing_sim.runtime.solver.WallTimeSolver.govern`)."""
        self._governor = governor
        self.solver.govern(governor)

    @property
    def _running_level(self) -> str:
        return self._governor.level if self._governor is not None else self.scene.level

    @property
    def _running_setting(self) -> str:
        return self._governor.setting if self._governor is not None else ""

    def _follow_setting(self) -> None:
        """Let limits of validity be those of the setting that runs now, which a governor may have changed."""
        fallen = None if self._governor is None or self._governor.is_at_wanted else self._governor.scene
        if fallen is not self._fallen:
            self._fallen = fallen
            scene = self.scene if fallen is None else fallen
            self.limits.follow(scene, laws_of_table(scene))

    def _setting_values(self) -> dict[str, object]:
        newest = self.solver.newest
        if self._governor is None or newest is not None and not self._governor.is_measured_at(newest):
            return super()._setting_values()
        return super()._setting_values() | dict(zip(SETTING_ERRORS, (self._governor.slip_error, self._governor.life_error)))

    @property
    def setting(self) -> str:
        """Name of the measured setting that runs; empty where none is known."""
        return self._running_setting

    def _take(self, items: Iterable, now: float) -> None:
        blocks, judged = [], 0
        for item in items:
            if isinstance(item, Event):
                self.monitor.take_all(blocks[judged:])
                self._watch(blocks[judged:], now)
                judged = len(blocks)
                self._note_solver_event(item, now)
            else:
                blocks.append(item)
        self.monitor.take_all(blocks[judged:])
        self._follow_setting()
        if blocks[judged:]:
            self.limits.take(blocks[-1])
        self._watch(blocks[judged:], now)
        if blocks and self._estimation is not None:
            self._estimate(joined(blocks), now)
        if blocks and self.keeper is not None:
            self.keeper.count_live(joined(blocks), tuple(self._starts_ns), self.schedule.tick / self.schedule.samples)
            self._counted = blocks[-1][-1]
        kept = [block for block in blocks if self._sample_decimator.is_due(float(block["time"][-1]))]  # the first is the state at the start
        if kept and self.sinks.by_name:  # all at once: many samples together hold the interpreter's lock far shorter
            self.sinks.write(now, kept[0] if len(kept) == 1 else joined(kept))

    @property
    def _published_until(self) -> float:
        return self._published_time

    def _values(self) -> dict[str, object]:
        left_out = {"outputs_left_out": self._publish_decimator.left_out, "outputs_left_out in the last five seconds": self._output_count.recent}
        return left_out if self._meter is None else left_out | self._meter.values

    def _remarks(self) -> dict[str, str]:
        return {} if self._meter is None else {"vibration": "its blocks are analysed"}

    def _idle_subjects(self) -> dict[str, str]:
        unused = super()._idle_subjects() | {"clock": "the run follows the clock of the machine"}
        if self._meter is not None:
            del unused["vibration"]
        return unused

    def close(self, timeout: float = 2.0) -> bool:
        """End the run (see `Model.close`)."""
        if self._meter is not None:
            self._meter.close()
        return super().close(timeout)

    def _further_events(self, now: float) -> list[Event]:
        flow = self._explained(self.gate.check(now), now, now)
        if self._output_count.is_raised:
            reason = "in each of the last five seconds outputs were left out"
            flow = [*flow, Event(now, Level.WARN, "pace.outputs", "", reason, "use more processes or cores, a lower level or a lower publish_rate")]
        if self._governor is None or self._governor.is_at_wanted:
            return flow
        running, wanted = self._running_setting or self._running_level, self._governor.wanted_setting or self.scene.level
        reason = f"computing at level {running} instead of {wanted}, for which this machine is too slow"
        return [Event(now, Level.WARN, "governor.level", "", reason), *flow]

    def _advanced(self, now: float) -> None:
        """Report that an output is due; on the solver's thread."""
        if self._anchors != self.solver.anchors:  # what was due during a pause is not missing
            self._anchors = self.solver.anchors
            self._publish_decimator.interrupt()
        if self._publish_decimator.is_due(now) and self._due is not None:
            self._due()

    def _compare(self, now: float, origin: topics.Origin) -> None:
        """Compare the measured cage speed with the newest sample, which is at most a tick old."""
        sample, residual = self.solver.newest, math.nan
        if sample is not None and self.solver.phase is Phase.RUNNING:
            ideal = float(sample["ideal_cage_speed"])
            measured = 1.0 - self.gate.measured / ideal if ideal else math.nan
            own = self._is_at_own_level
            predicted = float(sample["cage_slip"]) if own else math.nan
            before = self.residual.time
            self.residual.take(float(sample["time"]), float(sample["shaft_speed"]), measured, predicted)
            if self._estimation is not None and own:
                self._estimation.measure(now, self.gate.measured, self.gate.standard_error)
            residual = measured - predicted
            if self.residual.time != before and not math.isnan(self.residual.time):
                self._residuals = [(self.stamp(self.residual.time), self.residual.residual)]  # only the newest is published
        self.watchers.hear(topics.MEASURED, now, self.gate.measured, self.gate.standard_error)
        self.sinks.write(now, Measurement(now, self.gate.measured, residual, self.gate.standard_error, origin))

    def _take_clearance(self, now: float, origin: topics.Origin) -> None:
        """Let a measured clearance calibrate, while there is a sample that it belongs to."""
        reading = self.gate.latest(topics.MEASURED_CLEARANCE)
        if self._estimation is not None and self.solver.newest is not None and self.solver.phase is Phase.RUNNING and self._is_at_own_level:
            self._estimation.measure_clearance(now, *reading)
        self.watchers.hear(topics.MEASURED_CLEARANCE, now, *reading)
        self.sinks.write(now, MeasuredClearance(now, *reading, origin))

    @property
    def _is_at_own_level(self) -> bool:
        """Whether the scene's level is computed: levels predict slips that are points apart, so what is usual at one says nothing about another."""
        return self._governor is None or self._governor.level == self._governor.wanted
