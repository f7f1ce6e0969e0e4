# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model that listens and tells while a clock that somebody else keeps goes by: what `bearing_sim.runtime.live` is to wall time.

Inputs act at their stamps, as in a replay of a recording, and what comes out depends on nothing else: not on the pace of the clock, its
steps and stops, the order in which topics arrive, nor the speed of the machine.  Nothing is given up.

**The clock jumps back.**  With ``reset`` the model begins anew at the first messages after the jump.  With ``error`` the last good state is
held until the clock has passed where it was, or a reset is asked for (see `bearing_sim.runtime.stragglers` for messages around the jump).
"""

import dataclasses
import math
import time
from collections.abc import Callable

import numpy as np

from bearing_sim import topics
from bearing_sim.events import Event, Level
from bearing_sim.runtime.clock_report import clock_events, flow_events, progress, walk_events
from bearing_sim.runtime.clock_runner import ClockRunner, Start
from bearing_sim.runtime.clock_watch import ClockWatch, Step
from bearing_sim.runtime.comparison import Comparison
from bearing_sim.runtime.growing_course import OIL, GrowingCourse
from bearing_sim.runtime.health import Condition, Health, level_of, numbers
from bearing_sim.runtime.input_gate import UNITS, InputGate
from bearing_sim.runtime.leg import Arrival
from bearing_sim.runtime.live import Published
from bearing_sim.runtime.monitor import Monitor
from bearing_sim.runtime.outlets import Outlets, Sink
from bearing_sim.runtime.residual import ResidualMonitor
from bearing_sim.runtime.rivals import Rivals
from bearing_sim.runtime.stragglers import Message, Side, Stragglers
from bearing_sim.runtime.walk import Begun, Output
from bearing_sim.scene import Scene, Thresholds
from bearing_sim.simulation import Simulation


class SimTimeModel:
    """One bearing, driven by stamped messages, as far as a clock has come.

    All methods belong to one thread (the node's); the model itself runs on the runner's.

    Parameters
    ----------
    scene : what is simulated; its limits judge the messages, its thresholds the bearing.
    simulation : the warmed-up model of that scene.
    sample_rate : outputs for each simulated second that sinks get [Hz], counted from the first instant at which speed and load are known.
    publish_rate : how many of them are published for each simulated second [Hz].
    jump_back : ``"reset"`` or ``"error"``.
    wall : wall clock [s], monotonic; outputs do not depend on it.

    Attributes
    ----------
    start_ns : int
        Run time 0 [ns since the epoch]: where the course of inputs has begun; before that, where the clock was first.
    level : Level
        Of the worst that held when the health was last reviewed, by `collect`.
    """

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        sample_rate: float = 100.0,
        publish_rate: float = 50.0,
        jump_back: str = "reset",
        wall: Callable[[], float] = time.monotonic,
    ):
        self.scene, self.start_ns, self._publish_rate = scene, 0, publish_rate
        self._rate, self._jump_back, self._wall, self._wall_start = sample_rate, jump_back, wall, wall()
        self._first_inputs = simulation.inputs
        self.gate = InputGate(scene.input_limits, self._first_inputs)
        self.health, self.monitor = Health(), Monitor(scene)
        self.residual = ResidualMonitor(scene.thresholds.residual, scene.thresholds.slip_from_speed)
        self._comparison = Comparison(self.residual)
        self.level = Level.OK
        self._clock = ClockWatch()
        self._epoch: int | None = None  # of the gate's times
        self._held_until: int | None = None  # while a jump back is an error
        self._stragglers = Stragglers()
        self._newest: dict[str, int] = {}
        self._measured: list[tuple[int, float]] = []  # until the course begins
        self._started = self._expects_oil = False
        self._late = self._gaps = 0
        self._rivals = {channel: Rivals(channel, unit) for channel, unit in UNITS.items()}
        self._outlets = Outlets()
        self._openers: dict[str, Callable[[int], Sink]] = {}
        self._published: list[Published] = []
        self._residuals: list[tuple[int, float]] = []
        self.runner = ClockRunner(simulation, self._new_course(), wall=wall)
        self.runner.start()

    def run_time(self, now_ns: int) -> float:
        """Return the run time [s] of an instant of the clock."""
        return (now_ns - self.start_ns) * 1e-9

    def tick(self, clock_ns: int) -> None:
        """Take in a reading of the clock [ns since the epoch]; 0 says that there is none."""
        if clock_ns <= 0:
            return
        step = self._clock.read(clock_ns, self._wall())
        if self._epoch is None:
            self._epoch = clock_ns
        if step is Step.FIRST and not self._started:
            self.start_ns = clock_ns
        if step is Step.BACK:
            self._come_back()
        elif step is Step.LEAP:
            ahead = (clock_ns - self._clock.before) * 1e-9
            text = f"the clock leapt {ahead:.4g} s ahead; time between messages that is a gap is not simulated, the state is held over it"
            self._note(Event(self.run_time(clock_ns), Level.WARN, "clock.leapt_ahead", text))
        if self._held_until is not None and clock_ns >= self._held_until:
            self._held_until = None
            self._note(Event(self.run_time(clock_ns), Level.OK, "clock.passed", "the clock has passed where it was; the model goes on"))
        self._show_clock()

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int, frame_id: str = "") -> Event | None:
        """Take in one message (see `bearing_sim.runtime.input_gate.InputGate.offer`).

        Parameters
        ----------
        stamp_ns : the sender's stamp; the clock's newest reading stands in for the stamp of a message without one.
        now_ns : the clock.
        frame_id : the frame that the message names; recordings say the scene's.
        """
        self.tick(now_ns)
        stamp = self._clock.now if stamp_ns is None else stamp_ns
        if stamp is None:
            return self.refuse(channel, "input.not_stamped", "it has no stamp, and there is no clock yet whose time could stand in", now_ns)
        if self._epoch is None:
            self._epoch = stamp
        message = Message(channel, values, stamp)
        side = self._stragglers.sort(message, self._newest.get(channel), self._wall())
        if side is Side.BEYOND:
            self.gate.refused["input.leftover"] += 1
        return self._accept(message) if side is Side.HERE else None

    def note_senders(self, channel: str, count: int) -> None:
        """Take in how many publish a channel; more than one is told, and a first oil temperature is waited for where somebody does."""
        self._rivals[channel].senders = count
        if channel == OIL:
            self._expects_oil = count > 0

    def note_loss(self, text: str) -> None:
        """Take in that messages may have been, or were, lost on the way; ``text`` says of which channel."""
        self._note(Event(self.run_time(self._clock.now or self.start_ns), Level.WARN, "input.lost", text))

    def hold_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Let the oil have another temperature [K] from now on, where no message tells it."""
        self.offer(OIL, (temperature,), None, now_ns)

    def govern(self, governor) -> None:
        """Let the level stay: nothing is given up here, so there is nothing to govern."""

    def refuse(self, channel: str, code: str, reason: str, now_ns: int) -> Event:
        """Take in a message that could not even be read."""
        event = self.gate.refuse(channel, self.run_time(now_ns), code, reason)
        self._note(event)
        return event

    def adjust(self, thresholds: Thresholds) -> None:
        """Judge the bearing by other thresholds from now on; what the comparison with the measured cage has learned stays."""
        self.scene = dataclasses.replace(self.scene, thresholds=thresholds)
        self.monitor.adjust(thresholds)
        self.residual.adjust(thresholds.residual, thresholds.slip_from_speed)

    def open(self, name: str, open_sink: Callable[[int], Sink], anew: bool = False) -> None:
        """Let a sink have what comes from the start of the course on, or from now on.

        Parameters
        ----------
        name : of the sink.
        open_sink : makes it, told run time 0 [ns since the epoch].
        anew : whether to complete it and make another one where the course begins anew, since times would overlap in one.

        Raises
        ------
        OSError
            It cannot be made.
        """
        if self._started:
            self._outlets.attach(name, open_sink(self.start_ns))
        if anew or not self._started:
            self._openers[name] = open_sink

    def has(self, name: str) -> bool:
        """Return whether there is, or will be, a sink of that name."""
        return self._outlets.has(name) or name in self._openers

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it; None when there is none of that name (see `bearing_sim.runtime.outlets.Outlets.detach`)."""
        self._openers.pop(name, None)
        return self._outlets.detach(name)

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start; where a jump of the clock is held as an error, begin anew at the clock.

        Returns
        -------
        Whether it was done within ``timeout`` [s]; if not, it will be done after the running stretch.
        """
        if self._held_until is not None:
            self._held_until = None
            self._begin_anew()
            return True
        return self.runner.reset(timeout)

    def publish_at(self, rate: float) -> None:
        """Let so many outputs be published for each simulated second from now on [Hz]."""
        self._publish_rate = rate

    def published(self) -> list[Published]:
        """Return the outputs that are to be published since the last call."""
        published, self._published = self._published, []
        return published

    def residuals(self) -> list[tuple[int, float]]:
        """Return the residual slips since the last call, each with the stamp of its measurement [ns since the epoch]."""
        residuals, self._residuals = self._residuals, []
        return residuals

    def collect(self, now_ns: int) -> list[Event]:
        """Hand what has come of the walk to sinks and monitors and review the health.  Returns the events that are news."""
        self.tick(now_ns)
        self._show_clock()
        for message in self._stragglers.faulty(self._wall()):
            self._accept(message)
        for item in self.runner.take():
            self._handle(item)
        self._tell_compared(self._comparison.due())
        for event in self._outlets.news(self.run_time(now_ns)):
            self._note(event)
        now = self.run_time(now_ns)
        events = self._events(now)
        self.level = level_of(events)
        news = self.health.news(events)
        for event in news:
            self._outlets.to_all(now, lambda sink, event=event: sink.write_event(event._replace(time=max(event.time, 0.0))))
        return news

    def condition(self, now_ns: int) -> Condition:
        """Return what holds now, with the numbers behind it."""
        now, values = self.run_time(now_ns), {"level": self.scene.level}
        if self.runner.newest is not None:
            values |= topics.further_condition(self.scene, self.runner.newest)
        values |= self.monitor.values | self.residual.values(now) | self._outlets.values
        values |= progress(self._wall(), self._clock, self.runner) | {"late inputs": self._late, "gaps": self._gaps}
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
        for item in self.runner.take():
            self._handle(item)
        self._outlets.close(0.0)
        return stopped

    def _events(self, now: float) -> list[Event]:
        """Return what holds now [s], the worst first."""
        troubles = [*clock_events(now, self._wall(), self._clock, self._held_until), *walk_events(now, self._clock, self.runner)]
        troubles += [*self._outlets.troubles(now), *self.monitor.events(now), *self.residual.events(now)]
        troubles += [event for rivals in self._rivals.values() if (event := rivals.event(now)) is not None]
        return self.health.events(self._seen_at(), self.gate, self.runner, troubles, self._flow())

    def _accept(self, message: Message) -> Event | None:
        channel, values, stamp = message
        event = self.gate.offer(channel, (stamp - self._epoch) * 1e-9, values)
        if event is not None:
            self._note(event)
            return event
        self._newest[channel] = stamp
        self._rivals[channel].take(values)
        if channel == topics.MEASURED:
            if self._started:
                self._comparison.measure(self.run_time(stamp), self.gate.measured)
            else:
                self._measured.append((stamp, self.gate.measured))
            return None
        try:
            gap = self.runner.add(channel, stamp, self.gate.latest(channel))
        except ValueError as fault:
            self._late += 1
            self.gate.refused["input.late"] += 1
            event = Event(self.run_time(stamp), Level.WARN, "input.late", f"{channel}: {fault}; message refused, what was known before is held")
            self._note(event)
            return event
        if gap is not None:
            self._gaps += 1
            text = f"{channel}: no good message for {(gap[1] - gap[0]) * 1e-9:.4g} s; this time is not simulated, the state is held"
            self._note(Event(self.run_time(gap[0]), Level.WARN, "input.gap", text))
        return None

    def _come_back(self) -> None:
        """Act on a clock that has jumped back."""
        before, now = self._clock.before, self._clock.now
        back = f"the clock jumped back by {(before - now) * 1e-9:.4g} s to {now * 1e-9:.3f} s"
        if self._jump_back == "error":
            self._held_until = max(before, self._held_until or 0)
            return
        if (left := self.runner.unfinished) > 0.0:
            back += f", {left:.3g} s before that are left uncomputed"
        self._note(Event(self.run_time(now), Level.WARN, "clock.jumped_back", f"{back}; state and damage begin anew there"))
        self._begin_anew()

    def _begin_anew(self) -> None:
        """Leave the course and begin another one at the clock, with the messages that were set aside."""
        early = self._stragglers.jump(self._clock.now, self._newest)
        gate, self.gate = self.gate, InputGate(self.scene.input_limits, self._first_inputs)
        self.gate.refused = gate.refused
        self._newest, self._measured, self._started = {}, [], False
        self.runner.follow(self._new_course())
        for message in early:
            self._accept(message)
        self._show_clock()

    def _new_course(self) -> GrowingCourse:
        return GrowingCourse(self._rate, self.scene.input_limits, self.scene.lubricant.temperature)

    def _show_clock(self) -> None:
        """Tell the runner how far it may go."""
        if self._clock.now is not None and self._held_until is None:
            self._stragglers.pass_by(self._clock.now)
            self.runner.see(self._clock.now, self._clock.settled(self._wall()), self._expects_oil)

    def _handle(self, item) -> None:
        if isinstance(item, Start):
            self._start(item.start_ns)
        elif isinstance(item, Begun):
            self._outlets.to_recorders(item.time, lambda recorder: recorder.write_start(item.block))
        elif isinstance(item, Output):
            self._take(item.block)
        elif isinstance(item, Arrival):
            self._outlets.to_recorders(item.time, lambda recorder: recorder.write_inputs(*item))
        else:
            self._note(item)
            if item.code == "run.reset":
                self.monitor.restart()
                self.residual.interrupt(item.time)

    def _start(self, start_ns: int) -> None:
        """Begin a course: run time 0 is its start."""
        self.start_ns, self._started = start_ns, True
        self.monitor.restart()
        self.residual.interrupt(-math.inf)
        self._comparison.restart()
        measured, self._measured = self._measured, []
        for stamp, speed in measured:
            self._comparison.measure(self.run_time(stamp), speed)
        for name, open_sink in self._openers.items():
            self._outlets.guard(name, 0.0, lambda name=name: self._outlets.detach(name))
            self._outlets.guard(name, 0.0, lambda name=name, open_sink=open_sink: self._outlets.attach(name, open_sink(start_ns)))

    def _take(self, block: np.ndarray) -> None:
        """Judge, record and publish outputs."""
        now = float(block["time"][-1])
        self.monitor.take(block)
        self._outlets.to_all(now, lambda sink: sink.write(block))
        self._tell_compared(self._comparison.predict(block))
        share = min(self._publish_rate / self._rate, 1.0)
        for sample in block:
            number = round(float(sample["time"]) * self._rate)
            if math.floor(number * share + 1e-9) > math.floor((number - 1) * share + 1e-9):
                self._published.append(Published(self.start_ns + round(float(sample["time"]) * 1e9), sample))

    def _tell_compared(self, compared) -> None:
        for one in compared:
            self._outlets.to_all(one.time, lambda sink, one=one: sink.write_measurement(*one))
            self._residuals.append((self.start_ns + round(one.time * 1e9), one.residual))

    def _note(self, event: Event) -> None:
        self.health.note(event, self._seen_at())

    def _seen_at(self) -> float:
        return self._wall() - self._wall_start

    def _flow(self) -> list[Event]:
        """Return what is wrong with the flow of messages; of a clock that counts as an error nothing can be said."""
        overdue = self._clock.overdue(self._wall())
        if overdue < 0 or self._epoch is None or self._held_until is not None:
            return []
        return flow_events((overdue - self._epoch) * 1e-9, self.gate)
