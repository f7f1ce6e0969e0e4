# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A model in simulated time: it follows /clock, as `bearing_sim.runtime.live.LiveModel` follows wall time.

Inputs act at their stamps, as in a replay of a recording.  Results depend on nothing else: not on the pace of the clock, its steps and stops,
the order in which topics arrive, or the speed of the machine.  Nothing is dropped.

**The clock jumps back.**  With ``reset`` the model starts again at the first messages after the jump.  With ``error`` the last good state is
held until the clock has passed its old reading, or until a reset (see `bearing_sim.inputs.gate.ClockJumpFilter` for messages around the jump).
"""

import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from enum import Enum
from functools import partial

import numpy as np

from bearing_sim.inputs.gate import REQUIRED, ClockJumpFilter, InputGate, Message, Verdict
from bearing_sim.inputs.profile import OnlineInputProfile, gap_event
from bearing_sim.messages import topics
from bearing_sim.messages.events import Event, Level
from bearing_sim.runtime.advance_segment import pass_on, put_at_start
from bearing_sim.runtime.live import Model, Published
from bearing_sim.runtime.sink_registry import Sink
from bearing_sim.runtime.solver import SimTimeSolver, Start
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Simulation
from bearing_sim.watchers.monitoring.watchers import NOTHING

CAUGHT_UP = "all known is computed and passed on"
"""Diagnostics key: whether the model has come as far as clock and messages allow, and all its results are collected."""

_SETTLING = 0.5  # [s of wall time] after which every message stamped before a reading of the clock has arrived
_OVERDUE = 2.0  # [s of wall time] after which a message counts as missing: during fast playback, messages queue up for that long
_STANDING = 1.0  # [s of wall time] without a new reading after which the clock stands still
_LEAP = 10.0  # a step is a leap if it is longer than this many seconds and this many times the step before
_BEHIND = 2.0  # [s of wall time] of uninterrupted catching up after which it is reported


class Step(Enum):
    """What a reading of the clock is, compared with the one before."""

    FIRST = "first"
    FORWARD = "forward"
    LEAP = "leap"  # too far ahead to be a pace
    BACK = "back"


class SimClock:
    """Readings of /clock: whether it is there, stands still or jumps, and which of its readings is settled.

    Parameters
    ----------
    tolerance : a reading less than this before the latest one [s] is none: it came late, or two programs publish the clock.

    Attributes
    ----------
    now : int or None
        The newest reading [ns since the epoch]; None before the first.
    before : int or None
        The one before it.
    ignored : int
        Readings that were none, because they were a little earlier.
    """

    def __init__(self, tolerance: float = 0.1):
        self._tolerance_ns, self.ignored, self._newest_ignored = round(tolerance * 1e9), 0, -1
        self.now: int | None = None
        self.before: int | None = None
        self._step = 0
        self._changed_at = 0.0
        self._unsettled: deque[tuple[float, int]] = deque()
        self._pending: deque[tuple[float, int]] = deque()
        self._settled = self._overdue = -1

    def read(self, clock: int, wall: float) -> Step | None:
        """Take a reading [ns since the epoch] at a wall time [s]; None if the clock stands still."""
        if clock == self.now:
            return None
        if self.now is not None and 0 < self.now - clock < self._tolerance_ns:
            if clock != self._newest_ignored:
                self.ignored, self._newest_ignored, self._changed_at = self.ignored + 1, clock, wall
            return None
        self.before, self.now, self._changed_at = self.now, clock, wall
        if self.before is not None and clock < self.before:
            self._unsettled.clear()
            self._pending.clear()
            self._settled = self._overdue = -1
        self._unsettled.append((wall, clock))
        self._pending.append((wall, clock))
        if self.before is None:
            return Step.FIRST
        step, usual = clock - self.before, self._step
        self._step = max(step, 0)
        if step < 0:
            return Step.BACK
        return Step.LEAP if usual and step > _LEAP * max(usual, 1_000_000_000) else Step.FORWARD

    def settled(self, wall: float) -> int:
        """Return the newest reading that is at least half a second of wall time old [ns since the epoch]; -1 if there is none."""
        while self._unsettled and wall - self._unsettled[0][0] >= _SETTLING:
            self._settled = self._unsettled.popleft()[1]
        return self._settled

    def overdue(self, wall: float) -> int:
        """Return the newest reading before which a message that has not arrived is missing [ns since the epoch]; -1 if there is none."""
        while self._pending and wall - self._pending[0][0] >= _OVERDUE:
            self._overdue = self._pending.popleft()[1]
        return self._overdue

    def stands_still(self, wall: float) -> bool:
        """Return whether there was a reading, but no other one for a second of wall time."""
        return self.now is not None and wall - self._changed_at > _STANDING


class SimTimeModel(Model):
    """One bearing, driven by stamped messages, as far as /clock has come.

    Parameters
    ----------
    scene : what is simulated.
    simulation : the warmed-up simulation of the scene.
    sample_rate : outputs that sinks get for each simulated second [Hz], counted from the first instant at which speed and load are known.
    publish_rate : how many of them are published for each simulated second [Hz].
    jump_back : ``"reset"`` or ``"error"``.
    wall : wall clock [s], monotonic; outputs do not depend on it.
    given, inputs_expected_within : see `bearing_sim.runtime.live.Model`; within this wall time.
    clock_tolerance : see `SimClock`.

    Attributes
    ----------
    start_ns : int
        Run time 0 [ns since the epoch]: the start of the input profile; before that, the first reading of the clock.
    """

    def __init__(
        self,
        scene: Scene,
        simulation: Simulation,
        sample_rate: float = 100.0,
        publish_rate: float = 50.0,
        jump_back: str = "reset",
        wall: Callable[[], float] = time.monotonic,
        given: Mapping[str, object] = NOTHING,
        inputs_expected_within: float = 10.0,
        clock_tolerance: float = 0.1,
    ):
        self._rate, self._publish_rate = sample_rate, publish_rate
        self._jump_back, self._wall, self._wall_start = jump_back, wall, wall()
        self._first_inputs = simulation.inputs
        self._oil_temperature = scene.lubricant.temperature  # without messages of it
        self._clock, self._jump_filter = SimClock(clock_tolerance), ClockJumpFilter()
        self._expecting_since: float | None = None  # a first message [s of wall time]
        self._epoch: int | None = None  # of the gate's times
        self._held_until: int | None = None  # while a jump back is an error
        self._newest: dict[str, int] = {}
        self._measured: list[tuple[str, int, tuple[float, float]]] = []  # until the profile starts
        self._started = False
        self._expected: tuple[str, ...] = ()  # the temperatures that have a publisher
        self._late = self._gaps = 0
        self._openers: dict[str, Callable[[int], Sink]] = {}
        self._published: list[Published] = []
        self.solver = SimTimeSolver(simulation, self._new_profile(scene), clock=wall, begin=partial(put_at_start, run=self))
        super().__init__(scene, self._new_gate(scene), 0, given, inputs_expected_within)
        self.solver.start()

    def begins_at(self) -> int:
        """Return the start of the profile [ns since the epoch]."""
        return self.solver.start_ns or 0

    def tick(self, now_ns: int) -> None:
        """Take a reading of /clock [ns since the epoch]; 0 means that there is none."""
        if now_ns > 0:
            step = self._clock.read(now_ns, self._wall())
            if self._expecting_since is None:
                self._expecting_since = self._wall()
            if self._epoch is None:
                self._epoch = now_ns
            if step is Step.FIRST and not self._started:
                self.start_ns = now_ns
            elif step is Step.BACK:
                self._come_back()
            elif step is Step.LEAP:
                reason = f"the clock leapt {(now_ns - self._clock.before) * 1e-9:.4g} s ahead"
                action = "gaps between messages are not simulated, the state is held over them"
                self._note(Event(self.run_time(now_ns), Level.WARN, "clock.leapt_ahead", "", reason, action))
            if self._held_until is not None and now_ns >= self._held_until:
                self._held_until = None
                self._note(Event(self.run_time(now_ns), Level.OK, "clock.passed", "", "the clock has passed its old reading", "the model continues"))
        self._show_clock()

    def offer(self, channel: str, values: tuple[float, ...], stamp_ns: int | None, now_ns: int, frame_id: str = "") -> Event | None:
        """Take one message (see `Model.offer`).

        The clock's newest reading replaces the stamp of a message without one.  Recordings name the scene's frame.
        """
        self.tick(now_ns)
        stamp = self._clock.now if stamp_ns is None else stamp_ns
        if stamp is None:
            return self.refuse(channel, "input.not_stamped", "it has no stamp, and there is no clock yet whose time could replace it", now_ns)
        if self._epoch is None:
            self._epoch = stamp
        message = Message(channel, values, stamp)
        verdict = self._jump_filter.sort(message, self._newest.get(channel), self._wall())
        if verdict is Verdict.LEFTOVER:
            self.gate.refused["input.leftover"] += 1
        return self._accept(message) if verdict is Verdict.ACCEPT else None

    def set_oil_temperature(self, temperature: float, now_ns: int) -> None:
        """Set the oil temperature [K] (see `Model.set_oil_temperature`); before the first reading of the clock, for the whole run."""
        self.tick(now_ns)
        self._oil_temperature = float(temperature)
        self.gate.hold_oil_temperature(temperature)
        self._first_inputs = self._first_inputs._replace(oil_temperature=self._oil_temperature)
        self.solver.set_oil_temperature(self._clock.now, self._oil_temperature)

    def note_publishers(self, channel: str, count: int) -> None:
        """Take the number of publishers of a channel; if there is one of a temperature, the model waits for a first message."""
        super().note_publishers(channel, count)
        if channel in topics.TEMPERATURES:
            others = tuple(name for name in self._expected if name != channel)
            self._expected = (*others, channel) if count > 0 else others

    def note_loss(self, reason: str) -> None:
        """Take a report that messages were lost, or may have been; ``reason`` names the channel."""
        self._note(Event(self.run_time(self._clock.now or self.start_ns), Level.WARN, "input.lost", "", reason))

    def open(self, name: str, open_sink: Callable[[int], Sink], reopen: bool = False) -> None:
        """Add a sink that gets samples and events from the start of the profile, or from now on (see `Model.open`)."""
        if self._started:
            super().open(name, open_sink)
        if reopen or not self._started:
            self._openers[name] = open_sink

    def has(self, name: str) -> bool:
        """Return whether there is a sink with this name, or will be when the profile starts."""
        return super().has(name) or (name in self._openers and not self._started)

    def detach(self, name: str) -> Sink | None:
        """Close a sink and return it (see `Model.detach`); it is not opened again."""
        self._openers.pop(name, None)
        return super().detach(name)

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start (see `Model.reset`); if a jump of the clock is held as an error, start again at the clock."""
        if self._held_until is None:
            return super().reset(timeout)
        self._held_until = None
        self._start_again()
        return True

    def publish_at(self, rate: float) -> None:
        """Change the rate of published outputs, for each simulated second [Hz]."""
        self._publish_rate = rate

    def published(self) -> list[Published]:
        """Return the outputs to be published since the last call."""
        published, self._published = self._published, []
        return published

    def collect(self, now_ns: int) -> list[Event]:
        """Pass results of the solver on and review the health (see `Model.collect`)."""
        self.tick(now_ns)
        for message in self._jump_filter.expired(self._wall()):
            self._accept(message)
        overdue = self._clock.overdue(self._wall())
        if overdue >= 0 and self._epoch is not None and self._held_until is None:
            self.gate.expire((overdue - self._epoch) * 1e-9)
        return super().collect(now_ns)

    def _values(self) -> dict[str, object]:
        reached, clock = self.solver.reached, self._clock.now
        values: dict[str, object] = {"clock [s]": clock * 1e-9 if clock is not None else math.nan}
        if reached is not None and clock is not None:
            values["behind the clock [s]"] = (clock - reached) * 1e-9
        caught_up = clock is not None and self._clock.settled(self._wall()) == clock and self.solver.is_idle
        values |= {CAUGHT_UP: caught_up, "waits for": ", ".join(self.solver.awaited()) or "nothing", "messages waiting": self.solver.waiting}
        return values | {"late inputs": self._late, "gaps": self._gaps, "clock: readings a little earlier than the latest": self._clock.ignored}

    def _further_events(self, now: float) -> list[Event]:
        events, solver, clock = self._clock_events(now), self.solver, self._clock
        if solver.given_up:
            action = "the model has stopped until ~/reset or a jump back of the clock"
            events.append(Event(now, Level.ERROR, "run.given_up", "", solver.given_up, action))
        reached = solver.reached
        if reached is None:
            reason = f"waiting for the first {' and '.join(solver.awaited()) or 'instant'}; nothing is computed yet"
            events.append(Event(now, Level.OK, "run.waiting", "", reason))
        elif solver.busy_for > _BEHIND and clock.now is not None:
            events.append(Event(now, Level.WARN, "run.behind", "", "the model is behind the clock and catches up; nothing is lost"))
        return events + self._flow_events(now)

    def _clock_events(self, now: float) -> list[Event]:
        clock, wall = self._clock, self._wall()
        if clock.now is None:
            reason = "no /clock: use_sim_time is set, and nothing is computed before its first message; publish it, or set use_sim_time to false"
            return [Event(0.0, Level.WARN, "clock.absent", "", reason)]
        if self._held_until is not None:
            reason = "the clock jumped back and clock_jump_back is error"
            action = f"the last good state is held until the clock has passed {self._held_until * 1e-9:.3f} s again, or until ~/reset"
            return [Event(now, Level.ERROR, "clock.jumped_back", "", reason, action)]
        if clock.stands_still(wall):
            return [Event(now, Level.OK, "clock.stands_still", "", "paused: the clock stands still")]
        return []

    def _flow_events(self, now: float) -> list[Event]:
        """Return what is wrong with the flow of messages; nothing can be said while the clock stands, or a jump of it is held as an error."""
        wall = self._wall()
        overdue = self._clock.overdue(wall)
        if self._held_until is not None:
            return []
        events = [] if overdue < 0 or self._epoch is None else self.gate.check((overdue - self._epoch) * 1e-9)
        events = [event._replace(action="the model waits where it is") if event.subject in REQUIRED else event for event in events]
        is_waiting = self._expecting_since is not None and not self._clock.stands_still(wall)
        return self._explained(events, now, wall - self._expecting_since if is_waiting else 0.0)

    def _flow_numbers(self, now: float) -> dict[str, float]:
        return {} if self._clock.now is None or self._epoch is None else self.gate.numbers((self._clock.now - self._epoch) * 1e-9)

    def _new_gate(self, scene: Scene) -> InputGate:
        return InputGate(scene.accepted_inputs, self._first_inputs, heat_law=scene.heat.law, waits_for=REQUIRED)

    def _new_profile(self, scene: Scene) -> OnlineInputProfile:
        return OnlineInputProfile(self._rate, scene.accepted_inputs, self._oil_temperature, tuple(topics.inputs(scene)))

    def _accept(self, message: Message) -> Event | None:
        """Pass a message through the gate into the profile."""
        channel, values, stamp = message
        event = self.gate.offer(channel, (stamp - self._epoch) * 1e-9, values)
        if event is not None:
            self._note(event)
            return event
        for returned in self.gate.drain_returned():
            self._note(returned)
        self._newest[channel] = stamp
        self._conflicts[channel].receive(values[:1] if channel in topics.MEASURED_CHANNELS else values)
        if channel in topics.MEASURED_CHANNELS:
            if self._started:
                self._measure(channel, self.run_time(stamp), *self.gate.latest(channel))
            else:
                self._measured.append((channel, stamp, self.gate.latest(channel)))
            return None
        try:
            gap = self.solver.add_message(channel, stamp, self.gate.latest(channel))
        except ValueError as error:
            self._late += 1
            self.gate.refused["input.late"] += 1
            event = Event(self.run_time(stamp), Level.WARN, "input.late", channel, str(error), "message refused, the earlier values are kept")
            self._note(event)
            return event
        if gap is not None:
            self._gaps += 1
            self._note(gap_event(self.run_time(gap[0]), channel, gap))
        return None

    def _come_back(self) -> None:
        """Act on a clock that has jumped back."""
        before, now = self._clock.before, self._clock.now
        if self._jump_back == "error":
            self._held_until = max(before, self._held_until or 0)
            return
        reason = f"the clock jumped back by {(before - now) * 1e-9:.4g} s to {now * 1e-9:.3f} s"
        if (left := self.solver.unfinished) > 0.0:
            reason += f"; {left:.3g} s before that stay uncomputed"
        self._note(Event(self.run_time(now), Level.WARN, "clock.jumped_back", "", reason, "state and damage start again there"))
        self._start_again()

    def _start_again(self) -> None:
        """Leave the profile and begin another one at the clock, with the messages that were set aside."""
        self._expecting_since = self._wall()
        early = self._jump_filter.jump(self._clock.now, self._newest)
        refused, self.gate = self.gate.refused, self._new_gate(self.scene)
        self.gate.refused = refused
        self._newest, self._measured, self._started = {}, [], False
        self.solver.follow(self._new_profile(self.scene))
        for message in early:
            self._accept(message)
        self._show_clock()

    def _show_clock(self) -> None:
        """Tell the solver how far it may advance."""
        if self._clock.now is not None and self._held_until is None:
            self._jump_filter.reach(self._clock.now)
            self.solver.see_clock(self._clock.now, self._clock.settled(self._wall()), self._expected)

    def _pass_on(self, items: Iterable, now: float) -> None:
        for item in items:
            if isinstance(item, Start):
                self._start(item.start_ns)
            elif isinstance(item, Event):
                self._note_solver_event(item, item.time)
            else:
                pass_on(item, self)

    def _start(self, start_ns: int) -> None:
        """Start a profile at run time 0."""
        self.start_ns, self._started, self.reset_at = start_ns, True, -math.inf
        self.watchers.restart("the run starts")
        for name, open_sink in self._openers.items():
            try:
                self.sinks.detach(name)
                self.sinks.attach(name, open_sink(start_ns))
            except (OSError, ValueError) as error:
                self.sinks.fail(name, 0.0, error)
        measured, self._measured = self._measured, []
        for channel, stamp, reading in measured:
            self._measure(channel, self.run_time(stamp), *reading)

    def _measure(self, channel: str, time: float, value: float, standard_error: float) -> None:
        """Take a measurement of one of `bearing_sim.messages.topics.MEASURED_CHANNELS` and its standard error [SI] of a run time [s]."""
        for record in self.watchers.hear(channel, time, value, standard_error):
            self.write(record, time)

    def judge(self, block: np.ndarray) -> None:
        """Let the watchers see outputs, and publish those that are due."""
        for record in self.watchers.see(block):
            self.write(record, float(block["time"][-1]))
        fraction = min(self._publish_rate / self._rate, 1.0)
        for sample in block:
            number = round(float(sample["time"]) * self._rate)
            if math.floor(number * fraction + 1e-9) > math.floor((number - 1) * fraction + 1e-9):
                self._published.append(Published(self.stamp(float(sample["time"])), sample))

    def _review_time(self, now: float) -> float:
        return self._wall() - self._wall_start
