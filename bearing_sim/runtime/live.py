# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model that listens and tells while time goes by: gate, runner, health and sinks put together, free of ROS.

The node is a thin door to this; another door (a socket, a test) would use it the same way.
"""

import dataclasses
import math
import time
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from bearing_sim import topics
from bearing_sim.effects import cheaper_levels
from bearing_sim.events import Event, Level
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition, Health
from bearing_sim.runtime.input_gate import UNITS, InputGate
from bearing_sim.runtime.monitor import Monitor
from bearing_sim.runtime.pacer import Pacer
from bearing_sim.runtime.residual import ResidualMonitor
from bearing_sim.runtime.rivals import Rivals
from bearing_sim.runtime.runner import Phase, Runner
from bearing_sim.scene import Scene, Thresholds
from bearing_sim.simulation import Inputs, Simulation

LONGEST_TICK = 0.005  # [s] inputs act this late at most; outputs can be published at 200 Hz
_SLACK = 4.0  # [s] how long blocks wait to be collected before the oldest are dropped


class Sink(Protocol):
    """Where samples, events and measured cage speeds go (see `bearing_sim.sinks`)."""

    def write(self, block: np.ndarray) -> None: ...
    def write_event(self, event: Event) -> None: ...
    def write_measurement(self, time: float, cage_speed: float, residual: float) -> None: ...
    def close(self) -> None: ...


class Recorder(Sink, Protocol):
    """A sink that also keeps the inputs and the diagnostics."""

    def write_inputs(self, time: float, inputs: Inputs, channels) -> None: ...
    def write_diagnostics(self, time: float, events, values) -> None: ...


class Cadence(NamedTuple):
    """How a sample rate is made of ticks."""

    tick: float  # [s]
    samples: int  # in the block of one tick
    every: int  # blocks from one that goes to the sinks to the next


def cadence(sample_rate: float) -> Cadence:
    """Return ticks no longer than `LONGEST_TICK` that give a sample rate [Hz] exactly."""
    samples = max(1, math.floor(sample_rate * LONGEST_TICK * (1 + 1e-9)))
    every = max(1, math.ceil(1 / (sample_rate * LONGEST_TICK) * (1 - 1e-9)))
    return Cadence(samples / (sample_rate * every), samples, every)


def warmed_up(scene: Scene, sample_rate: float) -> Simulation:
    """Return a simulation whose code is compiled or loaded, so that its first tick costs no more than the others.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed.
    """
    simulation = Simulation(scene)
    beat = cadence(sample_rate)
    simulation.advance(beat.tick, simulation.inputs, beat.samples)
    return simulation


def governor_of(simulation: Simulation, sample_rate: float) -> Governor | None:
    """Return a governor over a simulation's level and the cheaper ones that have all its scene asks for; None where there are none.

    Their code is compiled or loaded here.  Lower levels take their own methods, with the scene's tolerance.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed at one of them.
    """
    scene, own = simulation.scene, dataclasses.replace(simulation.scene.integration, method=None, fixed_step=None)
    below = [warmed_up(dataclasses.replace(scene, level=level, integration=own), sample_rate) for level in cheaper_levels(scene)]
    return Governor([simulation, *below]) if below else None


class LiveModel:
    """One bearing, driven by messages as they come, in real time.

    All methods belong to one thread (the node's); the model itself runs on the runner's.

    Parameters
    ----------
    scene : what is simulated; its limits judge the messages, its thresholds the bearing.
    simulation : the warmed-up model of that scene.
    start_ns : the receiver's clock at run time 0 [ns since the epoch].
    sample_rate : samples for each simulated second that sinks get [Hz].
    maximum_lag : lag behind wall time that is caught up [s]; more is given up and counted.
    clock : wall clock of the runner [s], monotonic.
    governor : see `governor_of`; without one the level stays, and time is given up where it is too slow.
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
    ):
        self._governor = governor
        self.scene, self.start_ns = scene, start_ns
        self.gate = InputGate(scene.input_limits, simulation.inputs)
        self.health, self.monitor = Health(), Monitor(scene)
        self.residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self._rivals = {channel: Rivals(channel, unit) for channel, unit in UNITS.items()}
        beat = cadence(sample_rate)
        pacer, capacity = Pacer(1.0, maximum_lag), round(_SLACK / beat.tick)
        self.runner = Runner(simulation, pacer, beat.tick, beat.samples, capacity, clock, governor)
        self._every, self._blocks = beat.every, 0
        self._sinks: dict[str, Sink] = {}
        self._recorders: dict[str, Recorder] = {}
        self._given_up: dict[str, Event] = {}
        self.runner.start()

    def run_time(self, now_ns: int) -> float:
        """Return the run time [s] of an instant of the receiver's clock."""
        return (now_ns - self.start_ns) * 1e-9

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int) -> Event | None:
        """Take in one message (see `bearing_sim.runtime.input_gate.InputGate.offer`).

        Parameters
        ----------
        stamp_ns : the sender's stamp, or None for a message without one.
        now_ns : the receiver's clock.
        """
        now = self.run_time(now_ns)
        event = self.gate.offer(channel, now if stamp_ns is None else self.run_time(stamp_ns), values, arrival=now)
        if event is not None:
            self.health.note(event)
            return event
        self._rivals[channel].take(values)
        if channel == topics.MEASURED:
            self._compare(now)
            return None
        self._inputs_changed(channel, now)
        return None

    def adjust(self, thresholds: Thresholds) -> None:
        """Judge the bearing by other thresholds from now on; what the comparison with the measured cage has learned stays."""
        self.scene = dataclasses.replace(self.scene, thresholds=thresholds)
        self.monitor.adjust(thresholds)
        self.residual.adjust(thresholds.residual, thresholds.slip_from_speed)

    def hold_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Let the oil have another temperature [K] than the scene's, where no message tells it."""
        self.gate.hold_oil_temperature(temperature)
        self._inputs_changed("oil_temperature", self.run_time(now_ns))

    def refuse(self, channel: str, code: str, reason: str, now_ns: int) -> Event:
        """Take in a message that could not even be read."""
        event = self.gate.refuse(channel, self.run_time(now_ns), code, reason)
        self.health.note(event)
        return event

    def note_senders(self, channel: str, count: int) -> None:
        """Take in how many send a channel's messages; more than one is told."""
        self._rivals[channel].senders = count

    def attach(self, name: str, sink: Sink) -> None:
        """Let a sink have the samples and events from now on; one with ``write_inputs`` gets the inputs and diagnostics too.

        Raises
        ------
        ValueError
            There is a sink of that name.
        """
        if name in self._sinks:
            raise ValueError(f"there is a sink {name!r} already")
        self._sinks[name] = sink
        self._given_up.pop(name, None)
        if hasattr(sink, "write_inputs"):
            self._recorders[name] = sink

    def govern(self, governor: Governor | None) -> None:
        """Let a governor change levels from now on; its wanted level is that of the simulation that runs.  None: the level stays the scene's."""
        self._governor = governor
        self.runner.govern(governor)

    def has(self, name: str) -> bool:
        """Return whether there is a sink of that name."""
        return name in self._sinks

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None when there is none of that name.

        Raises
        ------
        OSError
            It could not be completed; it is detached all the same.
        """
        sink = self._sinks.pop(name, None)
        self._recorders.pop(name, None)
        if sink is not None:
            sink.close()
        return sink

    def collect(self, now_ns: int) -> list[Event]:
        """Hand blocks and events to the sinks and review the health.  Returns the events that are news."""
        now = self.run_time(now_ns)
        for item in self.runner.take():
            if isinstance(item, Event):
                self.health.note(item._replace(time=now))
                if item.code == "run.reset":
                    self.monitor.restart()
                    self.residual.interrupt(item.time)
            else:
                self.monitor.take(item)
                self._write(now, item)
        news = self.health.news(self.condition(now_ns).events)
        for event in news:
            self._to_sinks(now, lambda sink, event=event: sink.write_event(event))
        return news

    def condition(self, now_ns: int) -> Condition:
        """Return what holds now, with the numbers behind it."""
        now, troubles = self.run_time(now_ns), list(self._given_up.values())
        running = self._governor.level if self._governor is not None else self.scene.level
        values = {"level": running}
        if running != self.scene.level:
            text = f"computing at level {running} instead of {self.scene.level}, which this machine is too slow for"
            troubles.append(Event(now, Level.WARN, "governor.level", text))
        if self.runner.newest is not None:
            values |= topics.further_condition(self.scene, self.runner.newest)
        values |= self.monitor.values | self.residual.values(now)
        troubles += [*self.monitor.events(now), *self.residual.events(now)]
        troubles += [event for rivals in self._rivals.values() if (event := rivals.event(now)) is not None]
        for name, sink in self._sinks.items():
            if getattr(sink, "fault", None):
                troubles.append(Event(now, Level.WARN, f"sink.failed.{name}", f"{name} has stopped: {sink.fault}"))
            if hasattr(sink, "dropped"):
                values[f"{name}: blocks dropped"] = sink.dropped
        return self.health.review(now, self.gate, self.runner, troubles, values)

    def record_diagnostics(self, condition: Condition, now_ns: int) -> None:
        """Let the recorders keep a diagnostics report."""
        now = self.run_time(now_ns)
        for name, recorder in list(self._recorders.items()):
            self._guarded(name, now, lambda: recorder.write_diagnostics(now, condition.events, condition.values))

    def close(self, timeout: float = 2.0) -> bool:
        """Stop the runner, empty its queue into the sinks and complete them.

        Returns
        -------
        whether the solver's thread ended within ``timeout`` [s].
        """
        stopped = self.runner.stop(timeout)
        for item in self.runner.take():
            if not isinstance(item, Event):
                self._write(0.0, item)
        for name in sorted(self._sinks, key=lambda name: name not in self._recorders):  # recordings first: a view may take its time
            self._guarded(name, 0.0, lambda: self.detach(name))
        return stopped

    def _inputs_changed(self, channel: str, now: float) -> None:
        # Speed starts the model: load and temperature have sensible values in the scene, a wrong speed would be a false jolt.
        if self.gate.accepted["shaft_speed"]:
            self.runner.post(self.gate.held)
        for name, recorder in list(self._recorders.items()):
            self._guarded(name, now, lambda: recorder.write_inputs(now, self.gate.held, [channel]))

    def _compare(self, now: float) -> None:
        """Hold the measured cage speed against the newest sample, which is a tick old at most."""
        sample, residual = self.runner.newest, math.nan
        if sample is not None and self.runner.phase is Phase.RUNNING:
            ideal = float(sample["ideal_cage_speed"])
            measured = 1.0 - self.gate.measured / ideal if ideal else math.nan
            # Levels predict slips that are points apart: what is usual at one says nothing about another.
            own = self._governor is None or self._governor.level == self._governor.wanted
            predicted = float(sample["cage_slip"]) if own else math.nan
            self.residual.take(float(sample["time"]), float(sample["shaft_speed"]), measured, predicted)
            residual = measured - predicted
        self._to_sinks(now, lambda sink: sink.write_measurement(now, self.gate.measured, residual))

    def _write(self, now: float, block: np.ndarray) -> None:
        self._blocks += 1
        if self._blocks % self._every == 0:
            self._to_sinks(now, lambda sink: sink.write(block))

    def _to_sinks(self, now: float, action: Callable[[Sink], None]) -> None:
        for name, sink in list(self._sinks.items()):
            self._guarded(name, now, lambda: action(sink))

    def _guarded(self, name: str, now: float, action: Callable[[], object]) -> None:
        """Do something with a sink; a sink that cannot write (a full disk) is given up and named, the model goes on."""
        try:
            action()
        except (OSError, ValueError) as fault:
            self._given_up[name] = Event(now, Level.ERROR, f"sink.failed.{name}", f"{name} failed and is given up: {fault}")
            try:
                self.detach(name)
            except (OSError, ValueError):
                pass  # the same fault once more: it is on record already
