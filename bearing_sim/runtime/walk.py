# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The walk of a model along a course of inputs, leg by leg: what it does at each instant, and what comes of it.

Replays of recordings and runs that follow a clock are this same walk; it knows neither wall time nor sinks.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from bearing_sim.events import Event, Level
from bearing_sim.runtime.leg import Arrival, Leg
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, start_sample

_COURSE = 2000  # instants in one go, at a level that takes them so
_FAILURES_IN_A_ROW = 10  # then the walk is given up


class Output(NamedTuple):
    """Samples at instants where outputs are wanted, their times those of the course."""

    block: np.ndarray  # see `bearing_sim.sample`, shape (n,)
    weights: np.ndarray  # time that was simulated since the output before [s], shape (n,)


class Begun(NamedTuple):
    """The model stands at the first instant."""

    time: float  # [s] since the start of the course
    block: np.ndarray  # its sample there, shape (1,): what a recording begins with so that it can be repeated


class Walk:
    """A model under way.

    Parameters
    ----------
    begin : makes the simulation at the first inputs, or resets one.
    unseen : whether nobody wants to know of arrivals, so that a level that takes whole courses may say many outputs at once.

    Attributes
    ----------
    simulation : Simulation or None
        None before the first instant.
    reached : int
        The last instant that was walked over [ns since the start of the course]; -1 before the first.
    simulated, in_gaps : float
        Time that was simulated, and that lay in gaps [s].
    failures, failures_in_a_row : int
        Stretches that could not be integrated, in all and up to now.
    given_up : str
        Why the walk has ended, or ``""``.
    """

    def __init__(self, begin: Callable[[Inputs], Simulation], unseen: bool = False):
        self._begin, self._unseen = begin, unseen
        self.simulation: Simulation | None = None
        self.reached = -1
        self.simulated = self.in_gaps = 0.0
        self.failures = self.failures_in_a_row = 0
        self.given_up = ""
        self._unweighed = 0.0  # [s] simulated since the last output

    def over(self, leg: Leg) -> Iterator[Arrival | Begun | Output | Event]:
        """Advance over a leg, which follows on the last one, and yield what happens, in order of time; nothing once the walk is given up.

        A stretch that cannot be integrated is left out, told and counted; the next one is tried from the last good state.
        """
        place = 0
        if self.simulation is None and len(leg.instants):
            yield from leg.arrivals(0, 1)
            yield from self._start(leg)
            place = 1
        stretches = np.diff(leg.instants, prepend=self.reached) * 1e-9
        while place < len(leg.instants) and not self.given_up:
            done = place
            if getattr(self.simulation, "takes_courses", False):
                done = yield from self._go_along(leg, stretches, place)
            if done == place:
                yield from self._go(leg, float(stretches[place]), place)
                done = place + 1
            self.reached = int(leg.instants[done - 1])
            place = done
        if self.given_up and len(leg.instants):  # whoever revives it goes on with the next leg
            self.reached = int(leg.instants[-1])

    def _start(self, leg: Leg) -> Iterator[Begun | Event]:
        try:
            self.simulation = self._begin(Inputs(*leg.inputs[0].tolist()))
        except IntegrationError as error:
            yield self._give_up(float(leg.instants[0] * 1e-9), f"the model has no state at the first inputs: {error}")
        else:
            yield Begun(float(leg.instants[0] * 1e-9), start_sample(self.simulation))
        self.reached = int(leg.instants[0])

    def _go(self, leg: Leg, stretch: float, place: int) -> Iterator[Arrival | Output | Event]:
        """Advance to one instant."""
        moment = float(leg.instants[place] * 1e-9)
        yield from leg.arrivals(place, place + 1)
        if leg.in_gap[place]:
            self.in_gaps += stretch
            return
        try:
            block = self.simulation.advance(stretch, Inputs(*leg.inputs[place].tolist()))
        except IntegrationError as error:
            yield from self._fail(moment, error)
            return
        yield from self._recover(moment)
        self.simulated += stretch
        self._unweighed += stretch
        if leg.is_output[place]:
            yield self._output(block, moment)

    def _go_along(self, leg: Leg, stretches: np.ndarray, first: int) -> Iterator[Arrival | Output | Event]:
        """Advance over many instants at once; return the number of the one that comes next, ``first`` where it needs a closer look."""
        end = min(first + _COURSE, len(stretches))
        gaps = np.flatnonzero(leg.in_gap[first:end])
        end = first + int(gaps[0]) if len(gaps) else end
        if end == first:
            return first
        block = self.simulation.advance_course(stretches[first:end], leg.inputs[first:end])
        reached = len(block)
        if not reached:
            return first
        times, stretches = leg.instants[first : first + reached] * 1e-9, stretches[first : first + reached]
        yield from self._recover(float(times[0]))
        self.simulated += float(stretches.sum())
        if self._unseen:
            yield from self._whole_output(block, times, stretches, leg.is_output[first : first + reached])
            return first + reached
        for k in range(reached):
            yield from leg.arrivals(first + k, first + k + 1)
            self._unweighed += float(stretches[k])
            if leg.is_output[first + k]:
                yield self._output(block[k : k + 1], float(times[k]))
        return first + reached

    def _output(self, block: np.ndarray, moment: float) -> Output:
        block = block.copy()  # the model may keep its own
        block["time"] = moment  # the course's time: gaps and failed stretches count
        weights, self._unweighed = np.array([self._unweighed]), 0.0
        return Output(block, weights)

    def _whole_output(self, block: np.ndarray, times: np.ndarray, stretches: np.ndarray, is_output: np.ndarray) -> Iterator[Output]:
        waited = self._unweighed + np.cumsum(stretches)
        self._unweighed = float(waited[-1])
        if is_output.any():
            block, weights = block[is_output].copy(), np.diff(waited[is_output], prepend=0.0)
            block["time"] = times[is_output]
            self._unweighed -= float(waited[is_output][-1])
            yield Output(block, weights)

    def _fail(self, moment: float, error: IntegrationError) -> Iterator[Event]:
        self.failures += 1
        self.failures_in_a_row += 1
        if self.failures_in_a_row == 1:
            text = f"time could not be advanced ({error}); this stretch is left out, the last good state is held and the next inputs are tried"
            yield Event(moment, Level.ERROR, "solver.failed", text)
        if self.failures_in_a_row >= _FAILURES_IN_A_ROW:
            text = f"{self.failures_in_a_row} stretches in a row could not be integrated, the last one up to {moment:.3f} s: {error}"
            yield self._give_up(moment, text)

    def _recover(self, moment: float) -> Iterator[Event]:
        if self.failures_in_a_row:
            text = f"time advances again after {self.failures_in_a_row} failed stretches"
            self.failures_in_a_row = 0
            yield Event(moment, Level.OK, "solver.recovered", text)

    def _give_up(self, moment: float, reason: str) -> Event:
        self.given_up = reason
        return Event(moment, Level.ERROR, "run.given_up", reason)
