# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Solvers: each advances a simulation, step by step, on a thread that does nothing else.

`Solver` has what every run needs: pause, reset, stop, the queue of results and the report of a crash.  What is due, and when,
is the difference between a run in wall time (`WallTimeSolver`, ticks paced against a monotonic clock) and a run in simulated time
(`SimTimeSolver`, segments of an input profile as far as the messages and /clock allow).
"""

import sys
import time
import traceback
from collections import deque
from collections.abc import Callable, Collection, Iterator
from typing import NamedTuple

import numpy as np

from bearing_sim.inputs.profile import Arrival, OnlineInputProfile
from bearing_sim.messages.events import Event, Level
from bearing_sim.runtime.advance_segment import Begun, Output, ProfileRun
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.health import Phase
from bearing_sim.runtime.pacing import Pace, Pacer, TickSchedule
from bearing_sim.runtime.solver_threads import SolverThreads, Step
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, start_sample

_SWITCH_INTERVAL = 0.0005  # [s] the interpreter's 5 ms until a busy thread releases its lock are too long at the end of a tick


class Start(NamedTuple):
    """A profile begins: the times that follow are since its start."""

    start_ns: int  # [ns since the epoch]


Item = np.ndarray | Start | Begun | Arrival | Output | Event
Begin = Callable[[Simulation, Inputs], None]


class Solver:
    """A simulation that is advanced on a solver thread; base of `WallTimeSolver` and `SimTimeSolver`.

    The thread takes one step after the other: `_due` says which is next and when.

    Parameters
    ----------
    simulation : the model; used by the solver thread only, from `start` on.
    pacer : keeps account of the pace.
    clock : wall clock [s], monotonic.
    threads : shared with other solvers; a thread of its own where absent.
    begin : ``begin(simulation, inputs)`` resets the simulation to the start of the run, as warm as its bearing is.

    Attributes
    ----------
    newest : numpy.void or None
        The newest sample; None before the first.
    dropped : int
        Results that were dropped because they were not collected in time.
    failed_ticks : int
        Ticks, or stretches of a profile, in a row, up to now, that could not be integrated.
    """

    dropped = 0
    failed_ticks: int
    _is_running: bool  # whether the simulation has begun

    def __init__(
        self,
        simulation: Simulation,
        pacer: Pacer,
        clock: Callable[[], float],
        threads: SolverThreads | None = None,
        begin: Begin | None = None,
    ):
        self._simulation, self._pacer, self._clock = simulation, pacer, clock
        self._begin_at = begin or (lambda simulation, inputs: simulation.reset(inputs))
        self._threads = SolverThreads() if threads is None else threads
        self._changed = self._threads.changed  # guards the requests
        self._queue: deque[Item] = deque()
        self.newest: np.void | None = None
        self._started = self._stopping = self._paused = self._holding = self._reset_wanted = self._crashed = False
        self._resets = 0

    def start(self) -> None:
        """Begin to take steps."""
        sys.setswitchinterval(min(sys.getswitchinterval(), _SWITCH_INTERVAL))
        self._started = True
        self._threads.add(self)

    def pause(self, paused: bool = True) -> None:
        """Hold simulated time, or continue."""
        with self._changed:
            self._paused = paused
            self._threads.wake(self)

    @property
    def is_paused(self) -> bool:
        """Whether simulated time is to be held."""
        return self._paused

    def hold(self, timeout: float = 2.0) -> bool:
        """Pause, and wait until the running tick is over; return whether it was within ``timeout`` [s], or there is nothing to hold any more."""
        with self._changed:
            self._paused = True
            self._threads.wake(self)
            end = time.monotonic() + timeout
            while self._threads.is_running(self) and not self._holding and time.monotonic() < end:
                self._changed.wait(0.01)
            return self._holding or not self._threads.is_running(self)

    def continue_from(self, life_used: float) -> None:
        """Let the damage of samples continue from this life at the next reset, if it is this thread that adds it."""

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start, in ideal rolling at the present inputs.

        Returns
        -------
        Whether it was done within ``timeout`` [s]; if not, it will be done after the running tick.
        """
        with self._changed:
            if not self._threads.is_running(self) or self._crashed:
                return False
            wanted = self._resets + 1
            self._reset_wanted = True
            self._threads.wake(self)
            return self._changed.wait_for(lambda: self._resets >= wanted, timeout)

    def stop(self, timeout: float = 2.0) -> bool:
        """End after the running tick.  Returns whether it ended within ``timeout`` [s]."""
        with self._changed:
            self._stopping = True
            self._threads.wake(self)
            return self._changed.wait_for(lambda: not self._threads.is_running(self), timeout)

    def drain(self) -> list[Item]:
        """Return the results since the last call, oldest first."""
        return [self._queue.popleft() for _ in range(len(self._queue))]

    @property
    def phase(self) -> Phase:
        """What the solver is doing."""
        if self._crashed:
            return Phase.CRASHED
        if self._stopping:
            return Phase.STOPPED
        if not self._started:
            return Phase.READY
        if self._paused and self._holding:
            return Phase.PAUSED
        return Phase.RUNNING if self._is_running else Phase.WAITING

    @property
    def pace(self) -> Pace:
        """Real-time factors and lost time."""
        return self._pacer.pace

    @property
    def _reset_reason(self) -> str:
        return "state and damage returned to the start, in ideal rolling at the present inputs"

    def _due(self) -> tuple[Callable[[], None] | None, float | None]:
        """Return the next step, and how long to wait for it [s]; no step and None to wait for a change."""
        raise NotImplementedError

    def _resumed(self) -> None:
        """Continue after a pause."""

    def _restart(self) -> None:
        """Return the simulation to ideal rolling at the present inputs; may raise IntegrationError."""
        raise NotImplementedError

    def _now(self) -> float:
        """Return the run time of an event that happens now [s]."""
        raise NotImplementedError

    @property
    def is_ended(self) -> bool:
        """Whether it takes no further steps."""
        return self._stopping or self._crashed

    def take_step(self, step: Step) -> None:
        """Run a step on a solver thread; if it raises, report that and take no further steps."""
        try:
            step()
        except Exception:  # a programming error: report it where people look, and hold the last sample
            reason = f"the solver thread ended by a programming error: {traceback.format_exc(limit=-3).strip()}"
            self._queue.append(Event(self._now(), Level.ERROR, "solver.crashed", "", reason, "outputs are held"))
            with self._changed:
                self._crashed = True
                self._changed.notify_all()

    def next_step(self) -> tuple[Step | None, float | None]:
        """Return the next step and how long to wait for it [s], obeying requests; no step and None to wait for a change."""
        if self._reset_wanted:
            return self._reset, None
        if self._paused:
            self._holding = True
            return None, None
        if self._holding:
            self._holding = False
            self._resumed()
        return self._due()

    def _reset(self) -> None:
        if self._is_running:
            try:
                self._restart()
            except IntegrationError as error:
                self._queue.append(Event(self._now(), Level.ERROR, "solver.failed", "", f"the model could not be reset: {error}"))
            else:
                self._queue.append(Event(self._now(), Level.OK, "run.reset", "", self._reset_reason))
        self._reset_done()

    def _reset_done(self) -> None:
        with self._changed:
            self._reset_wanted = False
            self._resets += 1
            self._threads.wake(self)


class WallTimeSolver(Solver):
    """Advances a simulation tick by tick, paced against wall time, towards the newest inputs.

    The latest inputs come in by `post`; results go out through a bounded queue that drops its oldest entries.  The solver never waits for
    those who post or collect.

    **Time.**  Samples and events carry run time: seconds since the start of the run, at the pacer's rate.  It is simulated time plus what was
    skipped (waiting, pauses, lost time, resets), so it never goes back.

    Parameters
    ----------
    simulation : the model (see `bearing_sim.simulation.Simulation`); used by the solver thread only, from `start` on.
    pacer : decides when a tick is due.
    schedule : length of ticks, samples in each block, and ticks from one sample that sinks keep to the next.
    capacity : length of the queue in blocks and events.
    clock : wall clock [s], monotonic.
    governor : changes the simulation for one of another level when the solver is too slow or fast enough; its wanted level is that of
        ``simulation``.
    advanced : called on the solver thread after every tick with the run time reached [s]; must return at once.
    threads : see `Solver`.
    begin : see `Solver`.
    life_used : fraction of its life that the bearing has used before the run, which the damage of samples continues from, over resets too;
        None where every run begins at 0.

    Attributes
    ----------
    anchors : int
        How often simulated time was tied to wall time again: at the start, after a pause, after a reset.
    """

    def __init__(
        self,
        simulation: Simulation,
        pacer: Pacer,
        schedule: TickSchedule,
        capacity: int = 512,
        clock: Callable[[], float] = time.monotonic,
        governor: Governor | None = None,
        advanced: Callable[[float], None] | None = None,
        threads: SolverThreads | None = None,
        begin: Begin | None = None,
        life_used: float | None = None,
    ):
        super().__init__(simulation, pacer, clock, threads, begin)
        self._governor, self._advanced = governor, advanced
        self._could_begin: float | None = None  # when the next tick is due, or the last one has ended, whichever is later
        self._life_used, self._life_at_reset = life_used, None
        self._schedule = self._wanted = schedule
        self._ticks = 0  # since the last sample that sinks keep
        self._queue = deque(maxlen=capacity)
        self._governors: deque[Governor | None] = deque()  # to take over at the next tick
        self._latest: Inputs | None = None
        self._is_running = False
        self.failed_ticks, self._retry_at = 0, 0.0
        self.anchors = 0
        self._origin = self._shift = 0.0  # run time = simulated time + shift

    def start(self) -> None:
        """Start the thread.  Run time 0 is now; simulated time waits for the first inputs."""
        self._origin = self._clock()
        super().start()

    def post(self, inputs: Inputs) -> None:
        """Set the inputs to be reached by the next tick.  The first inputs start the model, in ideal rolling."""
        first, self._latest = self._latest is None, inputs  # one assignment, so readers see old or new inputs
        if first:  # later inputs need not wake the thread: it reads them when its tick is due
            with self._changed:
                self._threads.wake(self)

    def continue_from(self, life_used: float) -> None:
        """Let the damage of samples continue from this life at the next reset, or the start: it is another bearing's, or was not kept before."""
        self._life_at_reset = life_used

    def tick_by(self, schedule: TickSchedule) -> None:
        """Use another schedule from the next sample that sinks keep on."""
        self._wanted = schedule

    def govern(self, governor: Governor | None) -> None:
        """Use a governor from the next tick on; its wanted level is that of the present one.

        With None the level stays the one that the last governor wanted.
        """
        self._governors.append(governor)

    def _due(self) -> tuple[Callable[[], None] | None, float | None]:
        if self._latest is None:
            return None, None
        wall = self._clock()
        if self.failed_ticks and wall < self._retry_at:
            return None, self._retry_at - wall
        if not self._is_running:
            return self._begin, None
        if self._ticks % self._schedule.every == 0:
            self._schedule, self._ticks = self._wanted, 0
        end, resyncs = self._simulation.time + self._schedule.tick, self._pacer.resyncs
        delay = self._pacer.delay(wall, end)
        if self._pacer.resyncs != resyncs:
            wall = self._tick_instant(wall)
            self._pacer.anchor(wall, end)
            self._shift = self._run_time(wall) - end
        if self._could_begin is None:
            self._could_begin = wall + delay
        return self._tick, delay

    def _begin(self) -> None:
        """Start the model at the latest inputs."""
        if self._life_at_reset is not None:
            self._life_used, self._life_at_reset = self._life_at_reset, None
        try:
            self._to_start(self._latest, self._begin_at)
        except IntegrationError as error:
            self._fail(error)
            return
        self.failed_ticks, self._is_running = 0, True
        self._anchor()
        self._put(self._start_block())

    def _start_block(self) -> np.ndarray:
        """Return the sample at the start as a block; a recording begins with it so that the run can be reproduced."""
        block = start_sample(self._simulation)
        block["time"] += self._shift
        if self._life_used:
            block["damage"] += self._life_used
        return block

    def _tick(self) -> None:
        while self._governors:
            self._use_governor(self._governors.popleft())
        tick, samples, _ = self._schedule
        began = self._clock()
        could_begin, self._could_begin = self._could_begin or began, None
        try:
            block = self._simulation.advance(tick, self._latest, samples)
        except IntegrationError as error:
            self._fail(error)
            return
        ended = self._clock()
        self._pacer.worked(ended, tick, ended - began)
        self._ticks += 1
        block["time"] += self._shift  # in place: the block is not used by the simulation again
        if self._life_used:
            block["damage"] += self._life_used
        now = float(block["time"][-1])
        if self.failed_ticks:
            self._put(Event(now, Level.OK, "solver.recovered", "", f"time advances again after {self.failed_ticks} failed ticks"))
            self.failed_ticks = 0
        self.newest = block[-1]
        self._put(block)
        if self._advanced is not None:
            self._advanced(now)
        if self._governor is not None:
            common = self._threads.common_pace if self._threads.are_shared else None
            change = self._governor.consider(tick / self._pacer.rate, ended - began, began - could_begin, common, ended)
            if change is not None:
                self._simulation = change.simulation
                self._put(Event(now, Level.WARN if change.down else Level.OK, "governor.change", change.setting, change.text))

    def _use_governor(self, governor: Governor | None) -> None:
        if governor is None and self._governor is not None:
            left, was_at_wanted = self._governor.setting or self._governor.level, self._governor.is_at_wanted
            self._simulation = self._governor.leave()
            if not was_at_wanted:
                reason = f"the governor is switched off: level {self._governor.setting or self._governor.wanted} continues from {left}"
                self._put(Event(self._now(), Level.OK, "governor.change", self._governor.setting, reason))
        self._governor = governor

    def _to_start(self, inputs: Inputs, begin: Begin) -> None:
        """Return the model to ideal rolling at inputs, at the wanted level."""
        if self._governor is not None:
            self._simulation = self._governor.restart()
        begin(self._simulation, inputs)

    def _fail(self, error: IntegrationError) -> None:
        """Report the first failure in a row, hold the state, and try again after the duration of a tick."""
        self.failed_ticks += 1
        self._retry_at = self._clock() + self._schedule.tick / self._pacer.rate
        if self.failed_ticks == 1:
            action = "the last good state is held and the next inputs are tried"
            self._put(Event(self._now(), Level.ERROR, "solver.failed", "", f"time could not be advanced ({error})", action))

    def _restart(self) -> None:
        self._to_start(self._latest, lambda simulation, inputs: simulation.reset(inputs))
        if self._life_at_reset is not None:
            self._life_used, self._life_at_reset = self._life_at_reset, None
        elif self._life_used is not None and self.newest is not None:
            self._life_used = float(self.newest["damage"])
        self._anchor()
        self.failed_ticks = 0
        self.newest = self._start_block()[0]

    @property
    def _reset_reason(self) -> str:
        if self._life_used is None:
            return super()._reset_reason
        return "the model returned to ideal rolling at the present inputs; the totals of the bearing continue"

    def _resumed(self) -> None:
        if self._is_running:
            self._anchor()

    def _now(self) -> float:
        return self._run_time(self._clock()) if self.newest is None else max(self._run_time(self._clock()), float(self.newest["time"]))

    def _run_time(self, wall: float) -> float:
        return (wall - self._origin) * self._pacer.rate

    def _anchor(self) -> None:
        self._could_begin = None
        wall, time_ = self._tick_instant(self._clock()), self._simulation.time
        self._pacer.anchor(wall, time_)
        self.anchors += 1
        # Run time may skip but not go back, even if the model is ahead by the rounding of a clock.
        floor = float(self.newest["time"]) - time_ if self.newest is not None else -np.inf
        self._shift = max(self._run_time(wall) - time_, floor)

    def _tick_instant(self, wall: float) -> float:
        """Return the last instant at which solvers that share threads tick; of a solver with a thread of its own that is now.

        Ticks of many bearings that run one after the other find the code of their level in the processor's caches, and the thread wakes once
        for all of them.
        """
        return wall - wall % self._schedule.tick if self._threads.are_shared else wall

    def _put(self, item: Item) -> None:
        self.dropped += len(self._queue) == self._queue.maxlen  # the deque drops its oldest entry
        self._queue.append(item)


class SimTimeSolver(Solver):
    """Advances a simulation along online input profiles, as far as the messages and /clock allow.

    Nothing is dropped or skipped: a slow solver, or a slow reader of its results, makes the model lag behind the clock and catch up.  Results
    depend on the stamps of the messages only, not on the pace of the clock.

    Parameters
    ----------
    simulation : the model; used by the solver thread only.
    profile : the first profile.
    capacity : length of the queue; the solver waits while it is full.
    clock : wall clock [s], monotonic; used only to report the pace.
    begin : see `Solver`.
    """

    def __init__(
        self,
        simulation: Simulation,
        profile: OnlineInputProfile,
        capacity: int = 4096,
        clock: Callable[[], float] = time.monotonic,
        begin: Begin | None = None,
    ):
        super().__init__(simulation, Pacer(1.0), clock, begin=begin)
        self._capacity = capacity
        self._profile, self._run = profile, ProfileRun(self._begin)
        self._sim_clock = self._settled = -1  # readings of /clock [ns since the epoch]
        self._expected: Collection[str] = ()
        self._has_started = False
        self._items: Iterator[Item] | None = None  # of the segment that is under way
        self._busy_since: float | None = None

    def add_message(self, channel: str, stamp: int, value) -> tuple[int, int] | None:
        """Add a good message to the profile (see `bearing_sim.inputs.profile.OnlineInputProfile.add_message`)."""
        with self._changed:
            gap = self._profile.add_message(channel, stamp, value)
            self._threads.wake(self)
        return gap

    def set_oil_temperature(self, stamp: int, temperature: float) -> None:
        """Set the oil temperature (see `bearing_sim.inputs.profile.OnlineInputProfile.set_oil_temperature`)."""
        with self._changed:
            self._profile.set_oil_temperature(stamp, temperature)

    def see_clock(self, clock: int, settled: int, expected: Collection[str]) -> None:
        """Take a reading of the clock (see `bearing_sim.inputs.profile.OnlineInputProfile.known_until`)."""
        with self._changed:
            self._sim_clock, self._settled, self._expected = clock, settled, expected
            self._threads.wake(self)

    def follow(self, profile: OnlineInputProfile) -> None:
        """Leave the present profile and follow another one: state and damage return to the start."""
        with self._changed:
            self._profile, self._run, self._items = profile, ProfileRun(self._begin), None
            self._sim_clock = self._settled = -1
            self._has_started = False
            if self._reset_wanted:
                self._reset_done()
            self._threads.wake(self)

    def drain(self) -> list[Item]:
        """Return the results since the last call, oldest first, and make room for more."""
        with self._changed:
            drained = super().drain()
            self._threads.wake(self)
        return drained

    @property
    def failed_ticks(self) -> int:
        """See `Solver`."""
        return self._run.failures_in_a_row

    @property
    def given_up(self) -> str:
        """Why the model has stopped until a reset, or ``""``."""
        return self._run.given_up

    @property
    def reached(self) -> int | None:
        """The instant that the model has reached [ns since the epoch]; None before the start."""
        with self._changed:
            start, run = self._profile.start, self._run
            return None if start is None or run.reached < 0 else start + run.reached

    @property
    def busy_for(self) -> float:
        """How long the model has been catching up without a break [s of wall time]."""
        began = self._busy_since
        return 0.0 if began is None or self._paused else self._clock() - began

    @property
    def start_ns(self) -> int | None:
        """Where the profile starts [ns since the epoch]; None before its first instant."""
        return self._profile.start

    @property
    def is_idle(self) -> bool:
        """Whether everything that is known has been computed and collected."""
        with self._changed:
            return self._busy_since is None and not self._queue and (bool(self._run.given_up) or self._unclaimed <= 0)

    @property
    def unfinished(self) -> float:
        """Length of the profile that is known but not computed [s]."""
        with self._changed:
            claimed = self._profile.claimed - self._profile.start - self._run.reached if self._run.reached >= 0 else 0
            return max(self._unclaimed + claimed, 0) * 1e-9

    @property
    def _unclaimed(self) -> int:
        known = self._known_until()
        return known - max(self._profile.claimed, (self._profile.start or 0) - 1) if known >= 0 else 0

    def _known_until(self) -> int:
        return self._profile.known_until(self._sim_clock, self._settled, self._expected)

    def awaited(self) -> list[str]:
        """Return the channels whose messages the model is waiting for."""
        with self._changed:
            return self._profile.awaited(self._settled, self._expected)

    @property
    def waiting(self) -> int:
        """Messages that the model has not reached."""
        with self._changed:
            return self._profile.waiting

    @property
    def _is_running(self) -> bool:
        return self._run.simulation is not None

    def _due(self) -> tuple[Callable[[], None] | None, float | None]:
        if len(self._queue) >= self._capacity:
            return None, None
        if self._items is None:
            segment = None if self._run.given_up else self._profile.claim(self._known_until())
            if segment is None:
                self._busy_since = None
                return None, None
            if not self._has_started and len(segment.instants):
                self._has_started, self.newest = True, None
                self._queue.append(Start(self._profile.start))
            self._items = self._run.advance_segment(segment)
        if self._busy_since is None:
            self._busy_since = self._clock()
            self._pacer.anchor(self._busy_since, 0.0)
        run, items = self._run, self._items
        return lambda: self._advance(run, items), None

    def _advance(self, run: ProfileRun, items: Iterator[Item]) -> None:
        """Advance over a segment until it ends, its profile is left, the queue is full, or a request waits; then the next step goes on."""
        simulated, began = run.simulated_ns, self._clock()
        for item in items:
            ended = self._clock()
            self._pacer.worked(ended, (run.simulated_ns - simulated) * 1e-9, ended - began)
            with self._changed:
                if run is not self._run:
                    return
                self._queue.append(item)
                if isinstance(item, Output):
                    self.newest = item.block[-1]
                if self._paused or self._reset_wanted or self._stopping or len(self._queue) >= self._capacity:
                    return
            simulated, began = run.simulated_ns, self._clock()
        self._items = None

    def _begin(self, inputs: Inputs) -> Simulation:
        self._begin_at(self._simulation, inputs)
        return self._simulation

    def _resumed(self) -> None:
        self._busy_since = None

    def _restart(self) -> None:
        self._simulation.reset(self._simulation.inputs)
        self._run.given_up, self._run.failures_in_a_row = "", 0

    def _now(self) -> float:
        return max(self._run.reached, 0) * 1e-9
