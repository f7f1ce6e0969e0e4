# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""When things are due: ticks of a run in real time, outputs out of many samples, and jumps of the receiver's clock.

Arithmetic only: the caller brings clock readings along and does the sleeping.
"""

import math
from collections import deque
from collections.abc import Callable
from typing import NamedTuple

SHORTEST_LIMIT, LONGEST_TICK = 0.005, 0.010  # [s] outputs up to 200 Hz are possible; inputs act at most the longest tick late
_WHOLE = 1e-6  # distance from a whole number of ticks that still counts as whole
_EARLY = 1e-6  # [s] by which a sample may come early, because run time is rounded

_SECONDS = 5  # for which outputs must be left out, or none, until that is told
_MANY, _FEW = 0.02, 0.01  # fractions of the outputs of a second, to raise and to clear the warning

_JUMP = 1.0  # [s] between two readings: the clock was set, not disciplined
_LATE = 0.1  # [s] by which a reading may be old
_TRIES = 5  # to read two clocks at the same moment


class TickSchedule(NamedTuple):
    """How ticks make up a sample rate."""

    tick: float  # [s]
    samples: int  # in the block of one tick
    every: int  # blocks from one that goes to the sinks to the next


def tick_limit(publish_rate: float) -> float:
    """Return the longest tick [s]: half a period of outputs published at this rate [Hz], between `SHORTEST_LIMIT` and `LONGEST_TICK`."""
    return min(max(0.5 / publish_rate, SHORTEST_LIMIT), LONGEST_TICK)


def tick_schedule(sample_rate: float, publish_rate: float) -> TickSchedule:
    """Return the longest ticks that give a sample rate exactly.

    Most of a tick's cost at low-fidelity levels does not depend on its length, so ticks are as long as the outputs allow: `tick_limit` if a
    period of the outputs is a whole number of such ticks, so that outputs are evenly spaced, otherwise `SHORTEST_LIMIT`.

    Parameters
    ----------
    sample_rate : samples that sinks get for each simulated second [Hz].
    publish_rate : outputs to be published in each second [Hz].
    """
    long = _schedule(sample_rate, tick_limit(publish_rate))
    ticks = 1.0 / (publish_rate * long.tick)
    return long if abs(ticks - round(ticks)) < _WHOLE else _schedule(sample_rate, SHORTEST_LIMIT)


def _schedule(sample_rate: float, longest: float) -> TickSchedule:
    samples = max(1, math.floor(sample_rate * longest * (1 + 1e-9)))
    every = max(1, math.ceil(1 / (sample_rate * longest) * (1 - 1e-9)))
    return TickSchedule(samples / (sample_rate * every), samples, every)


class Pace(NamedTuple):
    """How a run keeps up with time."""

    real_time_factor: float  # simulated over wall seconds, recently; NaN before the first tick
    solver_factor: float  # simulated seconds over seconds spent in the solver, recently: how fast the run could be
    lost: float  # [s] wall time skipped since the start because the solver was too slow
    resyncs: int  # how often time was skipped


class Pacer:
    """Says when simulated time is due, in step with wall time.

    An anchor, a pair of wall time and simulated time, and the rate define when each simulated instant is due.  A run that is late by up to
    ``maximum_lag`` catches up by not sleeping; a larger lag is counted as lost and the anchor moves to now.

    Parameters
    ----------
    rate : simulated seconds per wall second; 1 is real time.
    maximum_lag : largest lag that is caught up [s of wall time].
    memory : time over which the factors are means [s of wall time].

    Attributes
    ----------
    resyncs : int
        How often time was skipped.

    Raises
    ------
    ValueError
        A parameter is not a positive finite number.
    """

    def __init__(self, rate: float = 1.0, maximum_lag: float = 0.1, memory: float = 1.0):
        for name, value in (("rate", rate), ("maximum_lag", maximum_lag), ("memory", memory)):
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(f"{name} = {value}: expected a positive number")
        self.rate, self.maximum_lag, self._memory = rate, maximum_lag, memory
        self._wall, self._sim = 0.0, 0.0  # the anchor
        self._last_wall = math.nan
        self._wall_sum = self._sim_sum = self._solver_sum = 0.0
        self._lost, self.resyncs = 0.0, 0

    @property
    def pace(self) -> Pace:
        """The factors and the loss so far."""
        held = self._sim_sum / self._wall_sum if self._wall_sum > 0.0 else math.nan
        possible = self._sim_sum / self._solver_sum if self._solver_sum > 0.0 else math.nan
        return Pace(held, possible, self._lost, self.resyncs)

    def anchor(self, wall: float, sim: float) -> None:
        """Make simulated time ``sim`` due at ``wall``: at the start, after a pause, after a reset.  Nothing counts as lost."""
        self._wall, self._sim = wall, sim
        self._last_wall = wall

    def delay(self, wall: float, sim: float) -> float:
        """Return how long to sleep until ``sim`` is due [s]; 0 if it is late.

        A lag of more than ``maximum_lag`` is added to the loss, and ``sim`` becomes due now.
        """
        lag = wall - self._wall - (sim - self._sim) / self.rate
        if lag > self.maximum_lag:
            self._lost += lag
            self.resyncs += 1
            self._wall, self._sim = wall, sim
            return 0.0
        return max(0.0, -lag)

    def worked(self, wall: float, simulated: float, solver_seconds: float) -> None:
        """Account for a tick that ended at ``wall``: ``simulated`` seconds of model time in ``solver_seconds`` of wall time."""
        elapsed = wall - self._last_wall
        self._last_wall = wall
        if not elapsed >= 0.0:  # there was no anchor yet
            return
        kept = math.exp(-elapsed / self._memory)
        self._wall_sum = self._wall_sum * kept + elapsed
        self._sim_sum = self._sim_sum * kept + simulated
        self._solver_sum = self._solver_sum * kept + solver_seconds


class Decimator:
    """Picks samples at a given rate out of a run, without drift, whatever the rate of the samples.

    The first sample is due, then each that is the first at or after a multiple of the period since then.  If run time skips more than a
    period, multiples count from there.

    Parameters
    ----------
    rate : samples to pick per second of run time [Hz]; may be changed at any time, from any thread.

    Attributes
    ----------
    picked, left_out : int
        Samples picked, and multiples of the period at which there was none, since the start.
    """

    def __init__(self, rate: float):
        self.rate = rate
        self.picked = self.left_out = 0
        self._last = -math.inf  # multiple that was due last [s]

    def is_due(self, time: float) -> bool:
        """Return whether the sample at a run time [s] is due; call it once for each sample, in order."""
        period = 1.0 / self.rate
        late = time - self._last - period
        if late < -_EARLY:
            return False
        if period <= late < math.inf:
            self.left_out += int((late + _EARLY) / period)
        self.picked += 1
        self._last = self._last + period if late < period else time
        return True

    def interrupt(self) -> None:
        """Take the next sample as the first one: what would have been due until then was not to be picked."""
        self._last = -math.inf


class OutputCount:
    """Tells whether outputs are left out for long, from how many were published and left out so far.

    A machine that is busy for a moment leaves out some outputs and catches up; nobody can do anything about it.  The warning is therefore raised
    only after every one of five seconds has lacked more than a fiftieth of its outputs, and cleared after five that lacked less than a hundredth.

    Attributes
    ----------
    is_raised : bool
        Whether the warning holds.
    """

    def __init__(self):
        self._began, self._before = math.nan, (0, 0)
        self._seconds: deque[tuple[int, int]] = deque(maxlen=_SECONDS)  # left out and due in each of the last
        self.is_raised = False

    def update(self, now: float, published: int, left_out: int) -> None:
        """Count with the numbers since the start at an instant [s]; to be called several times a second."""
        if not now - self._began < 1.0:
            if not math.isnan(self._began):
                left = left_out - self._before[1]
                self._seconds.append((left, left + published - self._before[0]))
            self._began, self._before = now, (published, left_out)
        lacking = [left / due if due else 0.0 for left, due in self._seconds]
        if len(lacking) == _SECONDS:
            self.is_raised = max(lacking) >= _FEW if self.is_raised else min(lacking) > _MANY

    @property
    def recent(self) -> int:
        """Outputs left out in the last five seconds."""
        return sum(left for left, _ in self._seconds)


class WallClock:
    """Detects when the receiver's clock is set, by comparing it with the monotonic clock.

    A thread may be suspended between reading one clock and the other, on a busy machine for a second and more.  So if a reading is out of
    step, both clocks are read again.

    Parameters
    ----------
    now_ns : the receiver's clock [ns since the epoch].
    monotonic : reads the monotonic clock [s].
    receiver : reads the receiver's clock [ns since the epoch]; without it, every reading passed to `jump` is taken as current.
    """

    def __init__(self, now_ns: int, monotonic: Callable[[], float], receiver: Callable[[], int] | None = None):
        self._monotonic, self._receiver = monotonic, receiver
        self._ahead = math.inf  # so that the first reading is out of step
        self.jump(now_ns)

    def jump(self, now_ns: int) -> float:
        """Return by how much the receiver's clock was set since the last call [s]; 0 if it was not, or if that cannot be decided now.

        Parameters
        ----------
        now_ns : a current reading of it [ns since the epoch].
        """
        ahead = now_ns * 1e-9 - self._monotonic()
        if abs(ahead - self._ahead) <= _LATE:
            self._ahead = ahead
            return 0.0
        if self._receiver is not None:
            ahead = self._at_one_moment()
        if math.isnan(ahead):
            return 0.0
        jump, self._ahead = ahead - self._ahead, ahead
        return jump if _JUMP < abs(jump) < math.inf else 0.0

    def _at_one_moment(self) -> float:
        """Return how far the receiver's clock is ahead [s]; NaN if the two could not be read at the same moment."""
        for _ in range(_TRIES):
            before, now_ns, after = self._monotonic(), self._receiver(), self._monotonic()
            if after - before < _LATE:
                return now_ns * 1e-9 - 0.5 * (before + after)
        return math.nan
