# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Threads that run the steps of many solvers, each step when it is due.

Compiled code runs without the interpreter's lock, but every return from it needs the lock again.  With one thread per bearing some forty threads
queue for it, and the thread that receives messages with them: at 40 bearings none of their outputs was published any more.  Here one thread
runs the steps of all solvers one after the other, which also leaves the code of a level in the processor's caches from one bearing to the next.
Further threads, up to the number of cores, help while steps are late.
"""

import heapq
import itertools
import math
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol

from bearing_sim.files.cores import cores

THREAD_NAME = "bearing-solver"
"""Name of the solver threads in top -H and /proc; Linux keeps 15 letters."""

_LATE = 0.005  # [s] after which another thread helps
_FORGOTTEN = 1.0  # [s] after which the pace of one that takes no steps counts no longer
_BETWEEN_TURNS = 0.25  # [s] the memory of a governor
_LOOK = 0.02  # [s] from one look of a helping thread at what is late to the next

Step = Callable[[], None]


class Stepped(Protocol):
    """What takes steps; all methods but ``take_step`` are called with the lock held, and must not wait."""

    is_ended: bool  # whether it takes no further steps

    def next_step(self) -> tuple[Step | None, float | None]:
        """Return the next step and how long to wait for it [s]; no step and None to wait for `SolverThreads.wake`."""

    def take_step(self, step: Step) -> None:
        """Run a step; must not raise."""


class CommonPace:
    """How those that share threads keep up together: each alone may be fast enough while all of them are too slow.

    Times are [s], monotonic.
    """

    def __init__(self):
        self._shares: dict[object, tuple[float, float]] = {}  # of each: when it was noted, and the share
        self._next_turn = -math.inf

    def note(self, member: object, share: float, now: float) -> None:
        """Note the share of real time that a member recently needed to be done with its steps, waiting for the others included."""
        self._shares[member] = now, share

    def forget(self, member: object) -> None:
        """Drop what was noted of a member, which now computes something else."""
        self._shares.pop(member, None)

    def slowest(self, now: float) -> float:
        """Return the largest share that was noted within the last second; 0 if there is none."""
        return max((share for noted, share in list(self._shares.values()) if noted > now - _FORGOTTEN), default=0.0)

    def takes_turn(self, now: float) -> bool:
        """Return whether a member may change what it computes now: one after the other, so that the effect of each is seen before the next."""
        if now < self._next_turn:
            return False
        self._next_turn = now + _BETWEEN_TURNS
        return True


class _Turn(NamedTuple):
    """A step that waits for its turn; the order is that of its first field."""

    due: float  # monotonic [s]
    number: int  # tells apart those that are due at once
    stepped: Stepped
    step: Step | None


class SolverThreads:
    """Threads shared by solvers.

    Of steps that are late, the one that is expected to end first is run first, so that a solver that is too slow for real time delays itself
    rather than the others.

    Parameters
    ----------
    most : number of threads at most; as many as the process has cores where absent.

    Attributes
    ----------
    changed : threading.Condition
        Guards what `Stepped.next_step` reads; notified by `wake`.
    common_pace : CommonPace
        Of all that take steps.
    """

    def __init__(self, most: int | None = None):
        self.changed = threading.Condition()
        self.common_pace = CommonPace()
        self._most = most or cores()
        self._idle = threading.Condition(self.changed)  # helping threads wait here
        self._costs: dict[Stepped, float] = {}  # of its last step [s], for everything that takes steps
        self._busy: set[Stepped] = set()
        self._woken: set[Stepped] = set()
        self._turns: dict[Stepped, _Turn] = {}  # that are valid; those in the heaps may be outdated
        self._waiting: list[_Turn] = []  # heap by the instant at which they are due
        self._ready: list[_Turn] = []  # heap by the instant at which they are expected to end
        self._numbers = itertools.count()
        self._threads = 0
        self._is_watched = False  # whether a thread waits for the next instant at which something is due

    @property
    def are_shared(self) -> bool:
        """Whether they take the steps of more than one."""
        return len(self._costs) > 1

    def add(self, stepped: Stepped) -> None:
        """Take steps of this one from now on."""
        with self.changed:
            self._costs[stepped] = 0.0
            self.wake(stepped)
            if self._threads < min(self._most, len(self._costs)):
                self._threads += 1
                threading.Thread(target=self._work, name=THREAD_NAME, daemon=True).start()

    def wake(self, stepped: Stepped) -> None:
        """Ask for its next step again, because something has changed; to be called with the lock held."""
        self._woken.add(stepped)
        self.changed.notify_all()

    def is_running(self, stepped: Stepped) -> bool:
        """Return whether steps are taken; to be called with the lock held."""
        return stepped in self._costs

    def _work(self) -> None:
        name_this_thread(THREAD_NAME)
        helps, turn, cost = False, None, 0.0
        while True:
            with self.changed:
                if turn is not None:
                    self._finish(turn.stepped, cost)
                turn = self._next_turn(helps)
                while turn is None and self._costs:
                    helps = self._wait(helps)
                    turn = self._next_turn(helps)
                if turn is None:
                    self._threads -= 1
                    return
                self._busy.add(turn.stepped)
            helps, began = False, time.monotonic()
            turn.stepped.take_step(turn.step)
            cost = time.monotonic() - began

    def _finish(self, stepped: Stepped, cost: float) -> None:
        self._busy.discard(stepped)
        self._costs[stepped] = cost
        self._schedule(stepped, time.monotonic())

    def _schedule(self, stepped: Stepped, now: float) -> None:
        """Put the next step into the heap where it belongs."""
        self._woken.discard(stepped)
        self._turns.pop(stepped, None)
        if stepped.is_ended:
            self._costs.pop(stepped, None)
            self.changed.notify_all()
            self._idle.notify_all()
            return
        step, delay = stepped.next_step()
        if step is None and delay is None:
            return
        self._turns[stepped] = turn = _Turn(now + (delay or self._costs[stepped]), next(self._numbers), stepped, step)
        heapq.heappush(self._waiting if delay else self._ready, turn)

    def _next_turn(self, helps: bool) -> _Turn | None:
        """Return a step that is to be taken now; with ``helps`` only if it is late."""
        now = time.monotonic()
        for stepped in self._woken - self._busy:
            if stepped in self._costs:
                self._schedule(stepped, now)
        while self._waiting and self._waiting[0].due <= now:
            turn = heapq.heappop(self._waiting)
            if turn is not self._turns.get(turn.stepped):
                continue
            if turn.step is None:
                self._schedule(turn.stepped, now)
            else:
                heapq.heappush(self._ready, turn)
        while self._ready and self._ready[0] is not self._turns.get(self._ready[0].stepped):
            heapq.heappop(self._ready)
        if not self._ready or (helps and min(turn.due for turn in self._ready) > now - _LATE):
            return None
        turn = heapq.heappop(self._ready)
        del self._turns[turn.stepped]
        return turn

    def _wait(self, helps: bool) -> bool:
        """Wait until something may be due; return whether another thread does so already and this one only helps."""
        if self._is_watched or helps:
            self._idle.wait(_LOOK)
            return True
        self._is_watched = True
        self.changed.wait(max(self._waiting[0].due - time.monotonic(), 0.0) if self._waiting else None)
        self._is_watched = False
        return False


def name_this_thread(name: str) -> None:
    """Name the running thread for the system's tools: Python before 3.14 keeps thread names to itself."""
    try:
        Path(f"/proc/self/task/{threading.get_native_id()}/comm").write_text(name[:15])
    except OSError:  # not Linux
        pass
