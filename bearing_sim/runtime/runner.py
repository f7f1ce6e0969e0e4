# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a simulation on its own thread, tick by tick, paced against wall time.

The thread that solves does nothing else: inputs come in through a mailbox that holds the latest value, blocks of samples
go out through a bounded queue whose oldest entries give way.  Whatever the readers do, the solver never waits for them.
"""

import sys
import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from enum import Enum

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.runtime.blocks import joined
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.pacer import Pace, Pacer
from bearing_sim.runtime.threads import SOLVER, name_this_thread
from bearing_sim.simulation import Inputs, IntegrationError

_GIVE_WAY = 0.0005  # [s]


class Phase(Enum):
    """What the runner is doing."""

    READY = "ready"  # not started
    WAITING = "waiting for the first input"
    RUNNING = "running"
    PAUSED = "paused"
    STOPPED = "stopped"
    CRASHED = "crashed"  # a fault in the program; told by an event, everything else works on


class Runner:
    """Advances one simulation on a worker thread.

    **Time.**  Samples and events carry run time: seconds since the start of the run, at the pacer's rate.  It is simulated
    time plus whatever was skipped (waiting, pauses, lost time, the restart at a reset), so it never goes back.

    Parameters
    ----------
    simulation : the model (see `bearing_sim.simulation.Simulation`); touched by the worker thread only, from `start` on.
    pacer : decides when a tick is due.
    tick : simulated seconds of one call of ``simulation.advance``; over it the inputs go linearly to their newest values.
    samples : samples in the block of one tick.
    capacity : blocks and events that the output queue holds; when it is full the oldest goes and is counted.
    clock : wall clock [s], monotonic.
    governor : where given, changes the simulation for that of another level when the solver is too slow or fast enough; its wanted level
        is that of ``simulation``.
    advanced : called on the worker thread after every tick with the run time it has reached [s]; shall take no time.
    every : ticks from one sample that is kept to the next.
    """

    def __init__(
        self,
        simulation,
        pacer: Pacer,
        tick: float = 0.01,
        samples: int = 1,
        capacity: int = 512,
        clock: Callable[[], float] = time.monotonic,
        governor: Governor | None = None,
        advanced: Callable[[float], None] | None = None,
        every: int = 1,
    ):
        self._governor, self._advanced = governor, advanced
        self._simulation, self._pacer, self._clock = simulation, pacer, clock
        self.tick, self._samples, self._every = self._wanted = tick, samples, every
        self._ticks = 0  # since the last sample that is kept
        self._changed = threading.Condition()  # guards all that follows
        self._queue: deque[np.ndarray | Event] = deque()
        self._capacity = capacity
        self._dropped = 0
        self._governors: deque[Governor | None] = deque()  # that are to take over at the next tick
        self._latest: Inputs | None = None
        self._newest: np.void | None = None
        self._stopping = self._paused = self._reset_wanted = False
        self._resets = 0
        self._phase = Phase.READY
        self._failed_ticks = 0
        self._pace = pacer.pace
        self._thread = threading.Thread(target=self._work, name=SOLVER, daemon=True)
        self._origin = self._shift = 0.0  # run time = simulated time + shift; worker thread only

    def start(self, origin: float | None = None) -> None:
        """Start the thread.  Run time 0 is wall time ``origin`` (now where absent); simulated time waits for the first input."""
        # Solved without the interpreter's lock, a tick wants it back at its end: Python's 5 ms until a busy thread must give it up are too long.
        sys.setswitchinterval(min(sys.getswitchinterval(), _GIVE_WAY))
        self._origin = self._clock() if origin is None else origin
        self._phase = Phase.WAITING
        self._thread.start()

    def govern(self, governor: Governor | None) -> None:
        """Let a governor change the simulation from the next tick on; its wanted level is that of the present one.

        With None, nothing changes it any more, and the level that the last governor wanted goes on.
        """
        with self._changed:
            self._governors.append(governor)

    def tick_by(self, tick: float, samples: int, every: int = 1) -> None:
        """Let ticks be otherwise (see `Runner`) from the next sample on that is kept."""
        self._wanted = tick, samples, every  # whole, whoever reads it when

    def post(self, inputs: Inputs) -> None:
        """Set the inputs that the next tick shall reach.  The first ones start the model, in ideal rolling at these inputs."""
        self._latest = inputs  # whole, whoever reads it when
        if self._phase is Phase.WAITING:  # a thread that waits for its next tick to be due need not be woken for it
            with self._changed:
                self._changed.notify_all()

    def take(self) -> list[np.ndarray | Event]:
        """Return the blocks and events since the last call, oldest first."""
        with self._changed:
            taken, self._queue = list(self._queue), deque()
        return taken

    def pause(self, paused: bool = True) -> None:
        """Hold simulated time, or let it go on."""
        with self._changed:
            self._paused = paused
            self._changed.notify_all()

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start, in ideal rolling at the present inputs.

        Returns
        -------
        whether it was done within ``timeout`` [s]; if not, it will be done after the running tick.
        """
        with self._changed:
            if not self._thread.is_alive():
                return False
            wanted = self._resets + 1
            self._reset_wanted = True
            self._changed.notify_all()
            return self._changed.wait_for(lambda: self._resets >= wanted, timeout)

    def stop(self, timeout: float = 2.0) -> bool:
        """End the thread after the running tick.  Returns whether it ended within ``timeout`` [s]."""
        with self._changed:
            self._stopping = True
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    @property
    def phase(self) -> Phase:
        """What the runner is doing."""
        return self._phase

    @property
    def newest(self) -> np.void | None:
        """The newest sample, or None before the first."""
        return self._newest

    @property
    def dropped(self) -> int:
        """Blocks and events that gave way because nobody took them."""
        return self._dropped

    @property
    def pace(self) -> Pace:
        """Real-time factors and lost time."""
        return self._pace

    @property
    def failed_ticks(self) -> int:
        """Ticks in a row, up to now, that could not be integrated."""
        return self._failed_ticks

    def _work(self) -> None:
        name_this_thread(SOLVER)
        phase = Phase.STOPPED
        try:
            while self._wait_for_first_input() and not self._begin():
                pass
            while self._next_tick():
                pass
        except Exception:  # a fault of the program: say it where people look, and leave the last sample standing
            phase = Phase.CRASHED
            reason = traceback.format_exc(limit=-3).strip()
            text = f"the solver thread ended by a program fault, outputs are held: {reason}"
            self._put(Event(self._run_time(), Level.ERROR, "solver.crashed", text))
        with self._changed:
            self._phase = phase
            self._changed.notify_all()

    def _wait_for_first_input(self) -> bool:
        with self._changed:
            while self._latest is None and not self._stopping:
                if self._reset_wanted:  # nothing ran yet, so there is nothing to reset
                    self._reset_done()
                self._changed.wait(0.5)
            return not self._stopping

    def _begin(self) -> bool:
        """Start the model at the inputs; False when they are such that it cannot."""
        with self._changed:
            inputs = self._latest
        try:
            self._restart(inputs)
        except IntegrationError as error:
            self._fail(error)
            return False
        self._failed_ticks = 0
        self._anchor()
        self._put(self._start())
        self._phase = Phase.RUNNING
        return True

    def _start(self) -> np.ndarray:
        """Return the sample that the model starts from, as a block: what a recording begins with so that it can be repeated."""
        block = np.array([self._simulation.sample])
        block["time"] += self._shift
        return block

    def _next_tick(self) -> bool:
        """Obey requests, sleep until the tick is due, run it; False to end."""
        with self._changed:
            if self._paused and not self._stopping and not self._reset_wanted:
                self._phase = Phase.PAUSED
                self._changed.wait_for(lambda: self._stopping or self._reset_wanted or not self._paused)
                self._anchor()
            self._phase = Phase.PAUSED if self._paused else Phase.RUNNING
            if self._stopping:
                return False
            inputs, reset_wanted = self._latest, self._reset_wanted
            if self._ticks % self._every == 0:
                self.tick, self._samples, self._every = self._wanted
                self._ticks = 0
        if reset_wanted:
            self._reset(inputs)
            return True
        if self._sleep_until_due():
            with self._changed:
                inputs = self._latest
                governors, self._governors = self._governors, deque()
            for governor in governors:
                self._change_governor(governor)
            self._advance(inputs)
        return True

    def _sleep_until_due(self) -> bool:
        """Return whether the tick is due; False when a request came in between."""
        resyncs = self._pacer.pace.resyncs
        wall, end = self._clock(), self._simulation.time + self.tick
        delay = self._pacer.delay(wall, end)
        if self._pacer.pace.resyncs != resyncs:
            self._shift = self._run_time(wall) - end
        if delay <= 0.0:
            return True
        with self._changed:
            return not self._changed.wait_for(lambda: self._stopping or self._reset_wanted or self._paused, delay)

    def _advance(self, inputs: Inputs) -> None:
        began = self._clock()
        try:
            block = self._simulation.advance(self.tick, inputs, self._samples)
        except IntegrationError as error:
            self._fail(error)
            return
        ended = self._clock()
        self._pacer.worked(ended, self.tick, ended - began)
        self._pace = self._pacer.pace
        self._ticks += 1
        block = joined([block])  # a copy: the model may keep its own
        block["time"] += self._shift
        if self._failed_ticks:
            text = f"time advances again after {self._failed_ticks} failed ticks"
            self._put(Event(float(block["time"][-1]), Level.OK, "solver.recovered", text))
            self._failed_ticks = 0
        self._newest = block[-1]
        self._put(block)
        if self._advanced is not None:
            self._advanced(float(block["time"][-1]))
        self._govern(float(block["time"][-1]), ended - began)

    def _govern(self, now: float, spent: float) -> None:
        """Let the governor judge a tick that took ``spent`` [s of wall time]."""
        change = self._governor.consider(self.tick / self._pacer.rate, spent) if self._governor is not None else None
        if change is not None:
            self._simulation = change.simulation
            self._put(Event(now, Level.WARN if change.down else Level.OK, "governor.change", change.text))

    def _change_governor(self, governor: Governor | None) -> None:
        if governor is None and self._governor is not None:
            left = self._governor.level
            self._simulation = self._governor.leave()
            if left != self._governor.wanted:
                text = f"level {self._governor.wanted} goes on from {left}: the governor is switched off"
                self._put(Event(self._run_time(), Level.OK, "governor.change", text))
        self._governor = governor

    def _restart(self, inputs: Inputs) -> None:
        """Return the model to ideal rolling at inputs, at the wanted level."""
        if self._governor is not None:
            self._simulation = self._governor.restart()
        self._simulation.reset(inputs)

    def _fail(self, error: IntegrationError) -> None:
        """Say the first failure of a row, hold the state, and let this tick's wall time go by before the next try."""
        self._failed_ticks += 1
        if self._failed_ticks == 1:
            text = f"time could not be advanced ({error}); the last good state is held and the next inputs are tried"
            self._put(Event(self._run_time(), Level.ERROR, "solver.failed", text))
        with self._changed:
            self._changed.wait_for(lambda: self._stopping or self._reset_wanted, self.tick / self._pacer.rate)

    def _reset(self, inputs: Inputs) -> None:
        try:
            self._restart(inputs)
        except IntegrationError as error:
            self._fail(error)
        else:
            self._anchor()
            self._failed_ticks = 0
            sample = self._simulation.sample.copy()
            sample["time"] += self._shift
            self._newest = sample
            text = "state and damage returned to the start, in ideal rolling at the present inputs"
            self._put(Event(float(sample["time"]), Level.OK, "run.reset", text))
        with self._changed:
            self._reset_done()

    def _reset_done(self) -> None:
        self._reset_wanted = False
        self._resets += 1
        self._changed.notify_all()

    def _run_time(self, wall: float | None = None) -> float:
        return ((self._clock() if wall is None else wall) - self._origin) * self._pacer.rate

    def _anchor(self) -> None:
        wall = self._clock()
        self._pacer.anchor(wall, self._simulation.time)
        # Where the model is ahead by the rounding of a clock, run time stays; it may skip but not go back.
        floor = float(self._newest["time"]) - self._simulation.time if self._newest is not None else -np.inf
        self._shift = max(self._run_time(wall) - self._simulation.time, floor)

    def _put(self, item: np.ndarray | Event) -> None:
        with self._changed:
            if len(self._queue) >= self._capacity:
                self._queue.popleft()
                self._dropped += 1
            self._queue.append(item)
