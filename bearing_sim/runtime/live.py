# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model that listens and tells while time goes by: gate, runner, health and sinks put together, free of ROS.

The node is a thin door to this; another door (a socket, a test) would use it the same way.
"""

import dataclasses
import math
import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim import topics
from bearing_sim.effects import cheaper_levels
from bearing_sim.events import Event, Level
from bearing_sim.runtime.beat import Beat
from bearing_sim.runtime.blocks import joined
from bearing_sim.runtime.cadence import LONGEST_TICK, cadence
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Condition, Health, level_of, numbers
from bearing_sim.runtime.input_gate import UNITS, InputGate
from bearing_sim.runtime.monitor import Monitor
from bearing_sim.runtime.outlets import Outlets, Sink
from bearing_sim.runtime.pacer import Pacer
from bearing_sim.runtime.residual import ResidualMonitor
from bearing_sim.runtime.rivals import Rivals
from bearing_sim.runtime.runner import Phase, Runner
from bearing_sim.runtime.wall_clock import WallClock
from bearing_sim.scene import Scene, Thresholds
from bearing_sim.simulation import Inputs, Simulation

_SLACK = 4.0  # [s] how long blocks wait to be collected before the oldest are dropped


class Published(NamedTuple):
    """An output to be published."""

    stamp_ns: int  # [ns since the epoch]
    sample: np.void


def warmed_up(scene: Scene) -> Simulation:
    """Return a simulation whose code is compiled or loaded, so that its first tick costs no more than the others.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed.
    """
    simulation = Simulation(scene)
    simulation.advance(LONGEST_TICK, simulation.inputs)
    return simulation


def governor_of(simulation: Simulation) -> Governor | None:
    """Return a governor over a simulation's level and the cheaper ones that have all its scene asks for; None where there are none.

    Their code is compiled or loaded here.  Lower levels take their own methods, with the scene's tolerance.

    Raises
    ------
    IntegrationError
        The scene's own operating conditions cannot be computed at one of them.
    """
    scene, own = simulation.scene, dataclasses.replace(simulation.scene.integration, method=None, fixed_step=None)
    below = [warmed_up(dataclasses.replace(scene, level=level, integration=own)) for level in cheaper_levels(scene)]
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
    publish_rate : outputs that are due to be published in each second [Hz].
    due : called on the runner's thread when a sample has come that is due; shall take no time.
    receiver : reads the receiver's clock [ns since the epoch] (see `bearing_sim.runtime.wall_clock.WallClock`).

    Attributes
    ----------
    level : Level
        Of the worst that held when the health was last reviewed, by `collect`.
    cadence : Cadence
        Of what ticks samples are made now (see `bearing_sim.runtime.cadence`).
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
    ):
        self._governor = governor
        self.scene, self.start_ns = scene, start_ns
        self.gate = InputGate(scene.input_limits, simulation.inputs)
        self.health, self.monitor = Health(), Monitor(scene)
        self.residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self._rivals = {channel: Rivals(channel, unit) for channel, unit in UNITS.items()}
        self._sample_rate, self.cadence = sample_rate, cadence(sample_rate, publish_rate)
        pacer, capacity = Pacer(1.0, maximum_lag), round(_SLACK / cadence(sample_rate, math.inf).tick)
        tick, samples, every = self.cadence
        self.runner = Runner(simulation, pacer, tick, samples, capacity, clock, governor, self._advanced, every)
        self._sample_beat, self._publish_beat, self._due = Beat(sample_rate), Beat(publish_rate), due
        self._wall_clock = WallClock(start_ns, clock, receiver)
        self._outlets = Outlets()
        self._published_time = self._residual_time = -math.inf
        self.level = Level.OK
        self.runner.start()

    def run_time(self, now_ns: int) -> float:
        """Return the run time [s] of an instant of the receiver's clock."""
        return (now_ns - self.start_ns) * 1e-9

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int, frame_id: str = "") -> Event | None:
        """Take in one message (see `bearing_sim.runtime.input_gate.InputGate.offer`); recorders get it as it came, refused or not.

        Parameters
        ----------
        stamp_ns : the sender's stamp, or None for a message without one.
        now_ns : the receiver's clock.
        frame_id : the frame that the message names.
        """
        self._follow_clock(now_ns)
        start_ns = self.start_ns
        now = (now_ns - start_ns) * 1e-9
        if channel != topics.MEASURED and self._outlets.keep_inputs:
            received, origin = _as_received(self.gate.held, channel, values), topics.Origin(stamp_ns, frame_id)
            self._outlets.to_recorders(now, lambda recorder: recorder.write_inputs(now, received, [channel], origin))
        event = self.gate.offer(channel, now if stamp_ns is None else (stamp_ns - start_ns) * 1e-9, values, now)
        if event is not None:
            self.health.note(event)
            return event
        self._rivals[channel].take(values)
        if channel == topics.MEASURED:
            self._compare(now, topics.Origin(stamp_ns, frame_id))
            return None
        self._inputs_changed()
        return None

    def adjust(self, thresholds: Thresholds) -> None:
        """Judge the bearing by other thresholds from now on; what the comparison with the measured cage has learned stays."""
        self.scene = dataclasses.replace(self.scene, thresholds=thresholds)
        self.monitor.adjust(thresholds)
        self.residual.adjust(thresholds.residual, thresholds.slip_from_speed)

    def hold_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Let the oil have another temperature [K] than the scene's, where no message tells it."""
        self.gate.hold_oil_temperature(temperature)
        now = self.run_time(now_ns)
        self._inputs_changed()
        self._outlets.to_recorders(now, lambda recorder: recorder.write_inputs(now, self.gate.held, ["oil_temperature"], topics.Origin(None, "")))

    def refuse(self, channel: str, code: str, reason: str, now_ns: int) -> Event:
        """Take in a message that could not even be read."""
        event = self.gate.refuse(channel, self.run_time(now_ns), code, reason)
        self.health.note(event)
        return event

    def note_senders(self, channel: str, count: int) -> None:
        """Take in how many send a channel's messages; more than one is told."""
        self._rivals[channel].senders = count

    def open(self, name: str, open_sink: Callable[[int], Sink], anew: bool = False) -> None:
        """Let a sink have the samples and events from now on (see `bearing_sim.runtime.outlets.Outlets.attach`).

        Parameters
        ----------
        name : of the sink.
        open_sink : makes it, told run time 0 [ns since the epoch].
        anew : what to do where time begins anew, which it does not here.

        Raises
        ------
        OSError
            It cannot be made.
        """
        self.attach(name, open_sink(self.start_ns))

    def attach(self, name: str, sink: Sink) -> None:
        """Let a sink have the samples and events from now on (see `bearing_sim.runtime.outlets.Outlets.attach`)."""
        self._outlets.attach(name, sink)

    def publish_at(self, rate: float) -> None:
        """Let outputs be due so often from now on [Hz]."""
        self._publish_beat.rate, self.cadence = rate, cadence(self._sample_rate, rate)
        self.runner.tick_by(*self.cadence)

    def published(self) -> list[Published]:
        """Return the newest sample, where it was not returned before."""
        sample = self.runner.newest
        if sample is None or sample["time"] <= self._published_time:
            return []
        self._published_time = float(sample["time"])
        return [Published(self.start_ns + round(self._published_time * 1e9), sample)]

    def residuals(self) -> list[tuple[int, float]]:
        """Return the newest residual slip with its stamp [ns since the epoch], where it was not returned before."""
        if not self.residual.time > self._residual_time:
            return []
        self._residual_time = self.residual.time
        return [(self.start_ns + round(self._residual_time * 1e9), self.residual.residual)]

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start (see `bearing_sim.runtime.runner.Runner.reset`)."""
        return self.runner.reset(timeout)

    def govern(self, governor: Governor | None) -> None:
        """Let a governor change levels from now on; its wanted level is that of the simulation that runs.  None: the level stays the scene's."""
        self._governor = governor
        self.runner.govern(governor)

    def has(self, name: str) -> bool:
        """Return whether there is a sink of that name."""
        return self._outlets.has(name)

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None when there is none of that name (see `bearing_sim.runtime.outlets.Outlets.detach`)."""
        return self._outlets.detach(name)

    def collect(self, now_ns: int) -> list[Event]:
        """Hand blocks and events to the sinks and review the health.  Returns the events that are news."""
        self._follow_clock(now_ns)
        now, blocks, judged = self.run_time(now_ns), [], 0
        for item in self.runner.take():
            if isinstance(item, Event):
                self.monitor.take_all(blocks[judged:])
                judged = len(blocks)
                self.health.note(item._replace(time=now))
                if item.code == "run.reset":
                    self.monitor.restart()
                    self.residual.interrupt(item.time)
            else:
                blocks.append(item)
        self.monitor.take_all(blocks[judged:])
        self._write(now, blocks)
        for event in self._outlets.news(now):
            self.health.note(event)
        events = self._events(now)
        self.level = level_of(events)
        news = self.health.news(events)
        for event in news:
            self._outlets.to_all(now, lambda sink, event=event: sink.write_event(event))
        return news

    def condition(self, now_ns: int) -> Condition:
        """Return what holds now, with the numbers behind it."""
        now, values = self.run_time(now_ns), {"level": self._running_level}
        if self.runner.newest is not None:
            values |= topics.further_condition(self.scene, self.runner.newest)
        values |= self.monitor.values | self.residual.values(now) | self._outlets.values
        return Condition(self._events(now), numbers(self.gate, self.runner) | values)

    def record_diagnostics(self, condition: Condition, now_ns: int) -> None:
        """Let the recorders keep a diagnostics report."""
        now = self.run_time(now_ns)
        self._outlets.to_recorders(now, lambda recorder: recorder.write_diagnostics(now, condition.events, condition.values))

    def close(self, timeout: float = 2.0) -> bool:
        """Stop the runner, empty its queue into the sinks and complete them.

        Returns
        -------
        whether the solver's thread ended within ``timeout`` [s].
        """
        stopped = self.runner.stop(timeout)
        self._write(0.0, [item for item in self.runner.take() if not isinstance(item, Event)])
        self._outlets.close(0.0)
        return stopped

    @property
    def _running_level(self) -> str:
        return self._governor.level if self._governor is not None else self.scene.level

    def _events(self, now: float) -> list[Event]:
        """Return what holds now [s], the worst first."""
        troubles = [*self._outlets.troubles(now), *self.monitor.events(now), *self.residual.events(now)]
        if self._running_level != self.scene.level:
            text = f"computing at level {self._running_level} instead of {self.scene.level}, which this machine is too slow for"
            troubles.append(Event(now, Level.WARN, "governor.level", text))
        troubles += [event for rivals in self._rivals.values() if (event := rivals.event(now)) is not None]
        return self.health.events(now, self.gate, self.runner, troubles)

    def _advanced(self, time: float) -> None:
        """Tell that a sample is due, on the runner's thread."""
        if self._publish_beat.is_due(time) and self._due is not None:
            self._due()

    def _inputs_changed(self) -> None:
        # Speed starts the model: load and temperature have sensible values in the scene, a wrong speed would be a false jolt.
        if self.gate.accepted["shaft_speed"]:
            self.runner.post(self.gate.held)

    def _compare(self, now: float, origin: topics.Origin) -> None:
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
        self._outlets.to_all(now, lambda sink: sink.write_measurement(now, self.gate.measured, residual, origin))

    def _follow_clock(self, now_ns: int) -> None:
        """Let run time go on evenly where the receiver's clock jumps, as when it is set: its stamps count from another start then."""
        jump = self._wall_clock.jump(now_ns)
        if jump:
            self.start_ns += round(jump * 1e9)
            text = f"the clock jumped by {jump:+.6g} s; the run and its recording go on evenly, by the clock from before"
            self.health.note(Event(self.run_time(now_ns), Level.WARN, "clock.jumped", text))

    def _write(self, now: float, blocks: list[np.ndarray]) -> None:
        """Hand blocks to the sinks, all at once: for many samples together they hold the interpreter's lock far shorter."""
        kept = [block for block in blocks if self._sample_beat.is_due(float(block["time"][-1]))]  # the first is the state at the start
        if kept and self._outlets:
            together = joined(kept)
            self._outlets.to_all(now, lambda sink: sink.write(together))


def _as_received(held: Inputs, channel: str, values: tuple[float, ...]) -> Inputs:
    """Return the inputs that a message states, for those of other channels the held ones."""
    if channel == "radial_load":
        load_y, load_z = (*values, 0.0)[:2]
        return held._replace(load_y=load_y, load_z=load_z)
    return held._replace(**{"shaft_speed" if channel == "shaft_speed" else "oil_temperature": values[0]})
