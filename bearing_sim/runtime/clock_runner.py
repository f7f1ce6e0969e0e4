# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Run a simulation on its own thread along a course of messages, as far as a clock that somebody else keeps has come.

Nothing is ever given up: where the solver or whoever takes the outputs is too slow, the model runs behind the clock and catches up.
The pace of the clock, its steps and its stops do not matter to what is computed, only the stamps of the messages do.
"""

import threading
import time
import traceback
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.runtime.growing_course import GrowingCourse
from bearing_sim.runtime.leg import Arrival, Leg
from bearing_sim.runtime.pacer import Pace, Pacer
from bearing_sim.runtime.runner import Phase
from bearing_sim.runtime.walk import Begun, Output, Walk
from bearing_sim.simulation import Inputs, IntegrationError, Simulation


class Start(NamedTuple):
    """A course begins: times that follow are since its start."""

    start_ns: int  # [ns since the epoch]


Item = Start | Begun | Arrival | Output | Event


class ClockRunner:
    """Walks one simulation along growing courses on a worker thread.

    Parameters
    ----------
    simulation : the model; touched by the worker thread only, from `start` on.
    course : the first course.
    capacity : items of the output queue; the worker waits where it is full.
    wall : wall clock [s], monotonic; only for what is told about the pace.
    """

    dropped = 0  # nothing is

    def __init__(self, simulation: Simulation, course: GrowingCourse, capacity: int = 4096, wall: Callable[[], float] = time.monotonic):
        self._simulation, self._capacity, self._wall = simulation, capacity, wall
        self._changed = threading.Condition()  # guards all that follows
        self._course, self._walk = course, Walk(self._begin)
        self._clock = self._settled = -1
        self._expects_oil = False
        self._queue: deque[Item] = deque()
        self._newest: np.void | None = None
        self._start_ns = 0
        self._stopping = self._paused = self._reset_wanted = self._crashed = self._started = False
        self._resets = 0
        self._busy_since: float | None = None
        self._pacer = Pacer(1.0)
        self._thread = threading.Thread(target=self._work, name="bearing-solver", daemon=True)

    def start(self) -> None:
        """Start the thread."""
        self._thread.start()

    def add(self, channel: str, stamp: int, value) -> tuple[int, int] | None:
        """Take in a good message (see `bearing_sim.runtime.growing_course.GrowingCourse.add`)."""
        with self._changed:
            gap = self._course.add(channel, stamp, value)
            self._changed.notify_all()
        return gap

    def see(self, clock: int, settled: int, expects_oil: bool) -> None:
        """Take in the clock (see `bearing_sim.runtime.growing_course.GrowingCourse.known_until`)."""
        with self._changed:
            self._clock, self._settled, self._expects_oil = clock, settled, expects_oil
            self._changed.notify_all()

    def follow(self, course: GrowingCourse) -> None:
        """Leave the present course and begin another one: state and damage start anew."""
        with self._changed:
            self._course, self._walk = course, Walk(self._begin)
            self._clock = self._settled = -1
            self._started = self._reset_wanted = False
            self._changed.notify_all()

    def take(self) -> list[Item]:
        """Return what has come of the walk since the last call, oldest first."""
        with self._changed:
            taken, self._queue = list(self._queue), deque()
            self._changed.notify_all()
        return taken

    def pause(self, paused: bool = True) -> None:
        """Hold the model, or let it catch up with the clock."""
        with self._changed:
            self._paused = paused
            self._changed.notify_all()

    def reset(self, timeout: float = 2.0) -> bool:
        """Return state and damage to the start, in ideal rolling at the present inputs; whether it was done within ``timeout`` [s]."""
        with self._changed:
            if not self._thread.is_alive() or self._crashed:
                return False
            wanted = self._resets + 1
            self._reset_wanted = True
            self._changed.notify_all()
            return self._changed.wait_for(lambda: self._resets >= wanted or not self._reset_wanted, timeout)

    def stop(self, timeout: float = 2.0) -> bool:
        """End the thread after the running stretch.  Returns whether it ended within ``timeout`` [s]."""
        with self._changed:
            self._stopping = True
            self._changed.notify_all()
        if self._thread.is_alive():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    @property
    def phase(self) -> Phase:
        """What the runner is doing."""
        if self._crashed:
            return Phase.CRASHED
        if self._stopping:
            return Phase.STOPPED
        if self._paused:
            return Phase.PAUSED
        return Phase.RUNNING if self._walk.simulation is not None else Phase.WAITING

    @property
    def newest(self) -> np.void | None:
        """The newest output, or None before the first of this course."""
        return self._newest

    @property
    def pace(self) -> Pace:
        """Simulated over wall seconds; nothing is lost."""
        return self._pacer.pace

    @property
    def failed_ticks(self) -> int:
        """Stretches in a row, up to now, that could not be integrated."""
        return self._walk.failures_in_a_row

    @property
    def given_up(self) -> str:
        """Why the model has stopped for good, or ``""``."""
        return self._walk.given_up

    @property
    def reached(self) -> int | None:
        """Up to where the model has come [ns since the epoch]; None before the start."""
        with self._changed:
            start, walk = self._course.start, self._walk
            return None if start is None or walk.reached < 0 else start + walk.reached

    @property
    def busy_for(self) -> float:
        """For how long the model has had something to catch up with, without a pause [s of wall time]."""
        began = self._busy_since
        return 0.0 if began is None else self._wall() - began

    @property
    def is_idle(self) -> bool:
        """Whether everything that is known is computed and taken."""
        with self._changed:
            return self._busy_since is None and not self._queue and (bool(self._walk.given_up) or self._unclaimed <= 0)

    @property
    def unfinished(self) -> float:
        """How much of the course is known and not computed [s]."""
        with self._changed:
            passed_over = self._course.claimed - self._course.start - self._walk.reached if self._walk.reached >= 0 else 0
            return max(self._unclaimed + passed_over, 0) * 1e-9

    @property
    def _unclaimed(self) -> int:
        known = self._course.known_until(self._clock, self._settled, self._expects_oil)
        return known - max(self._course.claimed, (self._course.start or 0) - 1) if known >= 0 else 0

    def awaited(self) -> list[str]:
        """Return the channels whose messages hold the model back."""
        with self._changed:
            return self._course.awaited(self._settled, self._expects_oil)

    @property
    def waiting(self) -> int:
        """Messages that the model has not come to."""
        with self._changed:
            return self._course.waiting

    def _work(self) -> None:
        try:
            while (job := self._next()) is not None:
                course, walk, part = job
                self._advance(course, walk, part)
        except Exception:  # a fault of the program: say it where people look, and leave the last output standing
            text = f"the solver thread ended by a program fault, outputs are held: {traceback.format_exc(limit=-3).strip()}"
            with self._changed:
                self._crashed = True
                self._queue.append(Event(self._moment(), Level.ERROR, "solver.crashed", text))
                self._changed.notify_all()

    def _next(self) -> tuple[GrowingCourse, Walk, Leg] | None:
        """Wait for a leg, obeying requests; None to end."""
        with self._changed:
            while not self._stopping:
                if self._reset_wanted:
                    self._reset()
                part = None
                if not self._paused and not self._walk.given_up:
                    part = self._course.take(self._course.known_until(self._clock, self._settled, self._expects_oil))
                if part is not None:
                    if self._busy_since is None:
                        self._busy_since = self._wall()
                        self._pacer.anchor(self._busy_since, 0.0)
                    return self._course, self._walk, part
                self._busy_since = None
                self._changed.wait()
        return None

    def _advance(self, course: GrowingCourse, walk: Walk, part: Leg) -> None:
        if not self._started and len(part.instants):
            self._started, self._start_ns, self._newest = True, course.start, None
            self._put(course, Start(course.start))
        simulated, began = walk.simulated, self._wall()
        for item in walk.over(part):
            ended = self._wall()
            self._pacer.worked(ended, walk.simulated - simulated, ended - began)
            if not self._put(course, item):
                return
            if isinstance(item, Output):
                self._newest = item.block[-1]
            simulated, began = walk.simulated, self._wall()

    def _put(self, course: GrowingCourse, item: Item) -> bool:
        """Queue an item, when there is room; False when its course is over, or the run."""
        with self._changed:
            while not (self._stopping or self._course is not course):
                if self._reset_wanted:
                    self._reset()
                if not self._paused and len(self._queue) < self._capacity:
                    self._queue.append(item)
                    return True
                self._changed.wait()
            return False

    def _begin(self, inputs: Inputs) -> Simulation:
        self._simulation.reset(inputs)
        return self._simulation

    def _reset(self) -> None:
        if self._walk.simulation is not None:
            try:
                self._simulation.reset(self._simulation.inputs)
            except IntegrationError as error:
                self._queue.append(Event(self._moment(), Level.ERROR, "solver.failed", f"the model could not be reset: {error}"))
            else:
                self._walk.given_up, self._walk.failures_in_a_row = "", 0
                text = "state and damage returned to the start, in ideal rolling at the present inputs"
                self._queue.append(Event(self._moment(), Level.OK, "run.reset", text))
        self._reset_wanted = False
        self._resets += 1
        self._changed.notify_all()

    def _moment(self) -> float:
        """Return where the walk is [s since the start of the course]."""
        return max(self._walk.reached, 0) * 1e-9
