# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model that takes messages and gives samples and events while time passes: gate, solver, monitors and sinks, free of ROS.

`Model` is what a run in wall time (`LiveModel`) and a run in simulated time (`bearing_sim.runtime.sim_time.SimTimeModel`) have in common.
The node is a thin front end; another one (a socket, a test) would use the same methods.
"""

import dataclasses
import math
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from bearing_sim.inputs.gate import CHANNELS, REQUIRED, Coverage, InputGate, PublisherConflict, Sources, unused_event, with_values
from bearing_sim.levels.steady.table_builder import cached_table
from bearing_sim.messages import topics
from bearing_sim.messages.bands import BANDS, Bands
from bearing_sim.messages.diagnostics import SETTING_ERRORS, further_condition, sink_subject
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, ReceivedInputs, Record, Report
from bearing_sim.model.plausibility import plausibility
from bearing_sim.model.sample import RING_TEMPERATURES, joined
from bearing_sim.runtime.advance_segment import put_at_start
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition, Health, Phase, level_of, numbers, remarks
from bearing_sim.runtime.pacing import LONGEST_TICK, Decimator, OutputCount, Pacer, WallClock, tick_schedule
from bearing_sim.runtime.sink_registry import Sink, SinkRegistry
from bearing_sim.runtime.solver import Solver, WallTimeSolver
from bearing_sim.runtime.solver_threads import SolverThreads
from bearing_sim.scene.errors import SceneError
from bearing_sim.scene.fidelity import lower_levels
from bearing_sim.scene.loader import with_setting
from bearing_sim.scene.measured_tradeoffs import MeasuredCourse, Setting
from bearing_sim.scene.scene import Scene, Thresholds
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.watchers.monitoring.watchers import MEMORY, NOTHING, Run, Watcher, Watchers

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


class Model(Run):
    """One bearing under way; base of `LiveModel` and `bearing_sim.runtime.sim_time.SimTimeModel`.

    All methods belong to one thread (the node's); the simulation runs on the solver's.

    Parameters
    ----------
    scene : what is simulated; its limits judge the messages, its thresholds the bearing.
    gate : judges the messages.
    start_ns : run time 0 [ns since the epoch].
    given : what watchers are given that a scene cannot name, by their names (see `bearing_sim.watchers.monitoring.watchers.Watchers`): what is
        asked for and not there is reported.
    inputs_expected_within : time from the start within which a good message of speed and of load is expected [s], and of any channel that
        somebody publishes.

    Attributes
    ----------
    solver : Solver
        The thread that advances the simulation, which a subclass makes.
    level : Level
        The worst level that held when `collect` last reviewed the health.
    """

    is_reviewed = True
    solver: Solver

    def __init__(
        self,
        scene: Scene,
        gate: InputGate,
        start_ns: int,
        given: Mapping[str, object] = NOTHING,
        inputs_expected_within: float = 10.0,
    ):
        self._inputs_expected_within = inputs_expected_within
        self._sources: dict[str, Sources] = {}
        self._bands: list[Bands] = []
        self.scene, self.gate, self.start_ns = scene, gate, start_ns
        self.health, self.sinks, self.watchers = Health(), SinkRegistry(), Watchers(scene, self, given)
        self.level = Level.OK
        self._conflicts = {channel: PublisherConflict(channel) for channel in CHANNELS}
        self._unused: set[str] = set()
        self._residuals: list[tuple[int, float]] = []
        for finding in plausibility(scene):
            field, _, reason = finding.partition(": ")
            self.health.note(Event(0.0, Level.WARN, "scene.implausible", field, reason))
        self.watchers.begin()

    @property
    def heard(self) -> list[str]:
        """Input channels with good messages."""
        return [channel for channel, count in self.gate.accepted.items() if count]

    @property
    def shaft_speed(self) -> float:
        """The newest measured shaft speed [rad/s]; NaN before the first."""
        return self.gate.held.shaft_speed if self.gate.accepted["shaft_speed"] else math.nan

    def run_time(self, now_ns: int) -> float:
        """Return the run time [s] of an instant of the clock."""
        return (now_ns - self.start_ns) * 1e-9

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
        self.watchers.adjust(thresholds)

    def replace_bearing(self, change: Callable[[], Watcher]) -> None:
        """Continue with another bearing of the same scene, in ideal rolling at the present inputs.

        Parameters
        ----------
        change : ends the watcher that remembers the present bearing, which by then has seen all its samples, and returns that of the other one.

        Raises
        ------
        OSError
            As ``change``, or the model did not stop within two seconds; nothing is changed.
        """
        was_paused = self.solver.is_paused
        try:
            if not self.solver.hold():
                raise OSError("the model is busy and did not stop within two seconds; call the service again")
            self._pass_on(self.solver.drain(), 0.0 if self.solver.newest is None else float(self.solver.newest["time"]))
            self.watchers.replace(MEMORY, change())
            self.solver.continue_from(self.watchers.memory.life_used)
            self.solver.reset(_REPLACED_WITHIN)
            self.watchers.begin()
        finally:
            self.solver.pause(was_paused)

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

    def bands(self) -> list[Bands]:
        """Return the bands since the last call, which are to be published."""
        bands, self._bands = self._bands, []
        return bands

    def write(self, record: Record, now: float) -> None:
        """Write a record to the sinks at run time ``now`` [s]; bands and residual slips are to be published, too."""
        self.sinks.write(now, record)
        if isinstance(record, Bands):
            self._bands.append(record)
            if record.topic == BANDS:
                self.newest_bands = record
        elif isinstance(record, Measurement) and not math.isnan(record.residual):
            self._note_residual(record)

    def _note_residual(self, compared: Measurement) -> None:
        """Note a measurement with a residual slip that is to be published."""
        self._residuals.append((self.stamp(compared.time), compared.residual))

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
        self._pass_on(self.solver.drain(), now)
        for event in (*self.sinks.news(now), *self.watchers.news(now)):
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
        values |= self.watchers.values(now) | self.sinks.values | self._values()
        said = remarks(self.gate, self.solver, self._running_setting or self._running_level) | self.sinks.remarks | self.watchers.remarks
        unused = self._idle_subjects()
        return Condition(self._events(now), values, said | unused, unused=frozenset(unused))

    def _idle_subjects(self) -> dict[str, str]:
        """Return the subjects of diagnostics that this run does without, and why."""
        published = {channel for channel, sources in self._sources.items() if sources.publishers}
        idle = (channel for channel in CHANNELS if channel not in REQUIRED and channel not in published and not self.gate.is_heard(channel))
        unused = {channel: self.gate.state(channel) for channel in idle}
        if "view" not in map(sink_subject, self.sinks.by_name):
            unused["view"] = "no view"
        if topics.MEASURED in unused and not self.scene.uses_ring_temperatures:
            unused["residual"] = "nothing is measured that could be compared"
        if self.scene.thresholds.pocket_force_warning is None and self.scene.thresholds.pocket_force_error is None:
            unused["pocket_force"] = "not judged: it has no threshold"
        return unused | self.watchers.unused

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
        self._pass_on(self.solver.drain(), 0.0)
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

    def _pass_on(self, items: Iterable, now: float) -> None:
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

    def _events(self, now: float) -> list[Event]:
        """Return the events that hold at ``now`` [s], the worst first."""
        conflicts = [event for conflict in self._conflicts.values() if (event := conflict.event(now)) is not None]
        conflicts += [unused_event(now, channel) for channel in sorted(self._unused)]
        judged = [*self.watchers.absent(now), *self.watchers.events(now)]
        events = [*self.sinks.events(now), *judged, *self._further_events(now), *conflicts]
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
            self.gate.coverage, self.reset_at = Coverage(), event.time
            self.watchers.restart(event.reason)


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
    given, inputs_expected_within : see `Model`.
    stamp_tolerance : how far stamps may be from the receiver's clock before that is reported [s]; messages act as they arrive all the same.

    Attributes
    ----------
    schedule : TickSchedule
        Ticks that samples are made of now.
    """

    acts_on_arrival = True

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
        given: Mapping[str, object] = NOTHING,
        inputs_expected_within: float = 10.0,
        stamp_tolerance: float = 2.0,
    ):
        self._governor, self._fallen = governor, None
        self._sample_rate, self.schedule = sample_rate, tick_schedule(sample_rate, publish_rate)
        self._clock, self._began = clock, clock()
        held = simulation.inputs._replace(**dict.fromkeys(RING_TEMPERATURES, math.nan))  # measured in this run or not at all
        gate = InputGate(scene.accepted_inputs, held, heat_law=scene.heat.law, stamp_tolerance=stamp_tolerance)
        super().__init__(scene, gate, start_ns, given, inputs_expected_within)
        pacer, capacity = Pacer(1.0, maximum_lag), round(_SLACK / tick_schedule(sample_rate, math.inf).tick)
        ways = governor, self._advanced, threads, partial(put_at_start, run=self), self.watchers.memory.life_used
        self.solver = WallTimeSolver(simulation, pacer, self.schedule, capacity, clock, *ways)
        self._starts_ns = [start_ns]  # by the clock now, and before it was set
        self._sample_decimator, self._publish_decimator, self._due = Decimator(sample_rate), Decimator(publish_rate), due
        self._wall_clock = WallClock(start_ns, clock, receiver)
        self._published_time = -math.inf
        self._anchors, self._output_count = 0, OutputCount()
        self._compared_at = -math.inf  # time of the sample that was compared last
        self.solver.start()

    @property
    def starts_ns(self) -> tuple[int, ...]:
        """Run time 0 by the clock now, and by the clock before it was set [ns since the epoch]."""
        return tuple(self._starts_ns)

    @property
    def interval(self) -> float:
        """Time between two samples where none is skipped [s]."""
        return self.schedule.tick / self.schedule.samples

    @property
    def newest(self) -> np.void | None:
        """The newest sample while the run goes on."""
        return self.solver.newest if self.solver.phase is Phase.RUNNING else None

    @property
    def published_until(self) -> float:
        """Time of the newest sample that is published [s]."""
        return self._published_time

    def begins_at(self) -> int:
        """Return the instant of the clock now [ns since the epoch]."""
        return self.stamp(self._clock() - self._began)

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
        for returned in self.gate.drain_returned():
            self._note(returned)
        self._conflicts[channel].receive(values[:1] if channel in topics.MEASURED_CHANNELS else values)
        if channel in topics.MEASURED_CHANNELS:
            reading, origin = self.gate.latest(channel), topics.Origin(stamp_ns, frame_id)
            for record in self.watchers.hear(channel, now, *reading):
                self.write(record._replace(origin=origin) if isinstance(record, (Measurement, MeasuredClearance)) else record, now)
        # Speed starts the model: the scene has sensible values of load and temperature, but a wrong speed would be a false jolt.
        elif self.gate.accepted["shaft_speed"]:
            self.solver.post(self.gate.held)
        return None

    def hear(self, channel: str, message: object, now_ns: int) -> None:
        """Let the watchers hear a message that is no input and no measurement, such as a block of vibration; a text says why it cannot be read."""
        self.tick(now_ns)
        now = self.run_time(now_ns)
        for record in self.watchers.hear(channel, now, message, math.nan):
            self.write(record, now)

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
        for channel, values in self.watchers.measured():
            self.offer(channel, values, None, now_ns)
        self._output_count.update(self.run_time(now_ns), self._publish_decimator.picked, self._publish_decimator.left_out)
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
            self.watchers.follow(self.scene if fallen is None else fallen)

    def _setting_values(self) -> dict[str, object]:
        newest = self.solver.newest
        if self._governor is None or newest is not None and not self._governor.is_measured_at(newest):
            return super()._setting_values()
        return super()._setting_values() | dict(zip(SETTING_ERRORS, (self._governor.slip_error, self._governor.life_error)))

    @property
    def setting(self) -> str:
        """Name of the measured setting that runs; empty where none is known."""
        return self._running_setting

    def _pass_on(self, items: Iterable, now: float) -> None:
        blocks, seen = [], 0
        for item in items:
            if isinstance(item, Event):
                self._show(blocks[seen:], now)
                seen = len(blocks)
                self._note_solver_event(item, now)
            else:
                blocks.append(item)
        self._follow_setting()
        self._show(blocks[seen:], now)
        kept = [block for block in blocks if self._sample_decimator.is_due(float(block["time"][-1]))]  # the first is the state at the start
        if kept and self.sinks.by_name:  # all at once: many samples together hold the interpreter's lock far shorter
            self.sinks.write(now, kept[0] if len(kept) == 1 else joined(kept))

    def _show(self, blocks: Sequence[np.ndarray], now: float) -> None:
        """Let the watchers see blocks at run time ``now`` [s], all at once, which costs far less than each."""
        if not blocks:
            return
        block = joined(blocks)
        self.watchers.correct(block, np.full(len(block), self.interval))
        for record in self.watchers.see(block):
            self.write(record, now)

    def _values(self) -> dict[str, object]:
        return {"outputs_left_out": self._publish_decimator.left_out, "outputs_left_out in the last five seconds": self._output_count.recent}

    def _idle_subjects(self) -> dict[str, str]:
        return super()._idle_subjects() | {"clock": "the run follows the clock of the machine"}

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

    def _note_residual(self, compared: Measurement) -> None:
        """Note the newest residual alone, at the time of the sample that it was found with; none near rest."""
        time, speed = float(self.solver.newest["time"]), abs(float(self.solver.newest["shaft_speed"]))
        if time > self._compared_at and speed >= self.scene.thresholds.slip_from_speed:
            self._compared_at, self._residuals = time, [(self.stamp(time), compared.residual)]

    @property
    def is_predicted(self) -> bool:
        """Whether the scene's level is computed: levels predict slips that are points apart, so what is usual at one says nothing about another."""
        return self._governor is None or self._governor.level == self._governor.wanted
