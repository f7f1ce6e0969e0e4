# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Advance a simulation along an input profile, segment by segment: what it does at each instant, and what results.

Replays of recordings and runs in simulated time share this module; it knows neither wall time nor sinks.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple, Protocol

import numpy as np

from bearing_sim.inputs.profile import Arrival, Segment
from bearing_sim.messages.events import Event, Level, ReceivedInputs, Record, Start
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, begin_at_temperatures, start_sample
from bearing_sim.watchers.monitoring.watchers import Run, Watchers

_COURSE = 2000  # instants advanced at once, at a level that supports it
_FAILURES_IN_A_ROW = 10  # then the run is given up


class Output(NamedTuple):
    """Samples at the instants of outputs; their times are those of the profile."""

    block: np.ndarray  # see `bearing_sim.model.sample`, shape (n,)
    weights: np.ndarray  # time simulated since the output before [s], shape (n,)


class Begun(NamedTuple):
    """The simulation is at the first instant."""

    time: float  # [s] since the start of the profile
    block: np.ndarray  # its sample there, shape (1,); a recording begins with it so that the run can be reproduced


class Follower(Protocol):
    """A run along a profile: one in simulated time, or a replay."""

    watchers: Watchers

    def write(self, record: Record, now: float) -> None:
        """Write a record to the sinks at run time ``now`` [s]."""

    def judge(self, block: np.ndarray) -> None:
        """Let the watchers see samples that have been written."""


def pass_on(item: Arrival | Begun | Output, run: Follower) -> None:
    """Pass what has happened along a profile on to sinks and watchers."""
    match item:
        case Begun(time, block):
            run.watchers.correct(block, np.zeros(len(block)))
            run.write(Start(block), time)
        case Output(block, weights):
            run.watchers.correct(block, weights)
            run.write(block, float(block["time"][-1]))
            run.judge(block)
        case Arrival():
            run.write(ReceivedInputs(*item), item.time)


def put_at_start(simulation: Simulation, inputs: Inputs, run: Run, is_there: bool = False) -> None:
    """Put a simulation at the start of a run, as warm as the bearing is remembered; on the thread that advances it.

    Parameters
    ----------
    is_there : whether the simulation is at the start that the scene says.
    """
    known = run.watchers.memory.temperatures(run.begins_at()) if simulation.thermal is not None else None
    if known is not None:
        begin_at_temperatures(simulation, inputs, *map(np.array, known))
    elif not is_there:
        simulation.reset(inputs)


class ProfileRun:
    """A simulation on its way along an input profile.

    Parameters
    ----------
    begin : makes the simulation at the first inputs, or resets one.
    outputs_only : whether arrivals are of no interest, so that a level that takes whole courses of inputs may return many outputs at once.

    Attributes
    ----------
    simulation : Simulation or None
        None before the first instant.
    reached : int
        The last instant that was reached [ns since the start of the profile]; -1 before the first.
    simulated_ns, in_gaps_ns : int
        Time that was simulated, and time in gaps [ns]; whole numbers, whose sums do not depend on how a profile is cut into segments.
    failures, failures_in_a_row : int
        Stretches that could not be integrated, in total and up to now.
    given_up : str
        Why the run has ended, or ``""``.
    """

    def __init__(self, begin: Callable[[Inputs], Simulation], outputs_only: bool = False):
        self._begin, self._outputs_only = begin, outputs_only
        self.simulation: Simulation | None = None
        self.reached = -1
        self.simulated_ns = self.in_gaps_ns = 0
        self.failures = self.failures_in_a_row = 0
        self.given_up = ""
        self._since_output_ns = 0  # simulated since the last output

    def advance_segment(self, segment: Segment) -> Iterator[Arrival | Begun | Output | Event]:
        """Advance over the next segment and yield what happens, in order of time; nothing once the run is given up.

        A stretch that cannot be integrated is skipped, reported and counted; the next one is tried from the last good state.
        """
        index = 0
        if self.simulation is None and len(segment.instants):
            yield from segment.arrivals(0)
            yield from self._start(segment)
            index = 1
        stretches = np.diff(segment.instants, prepend=self.reached)
        while index < len(segment.instants) and not self.given_up:
            done = index
            if getattr(self.simulation, "takes_profiles", False):
                done = yield from self._advance_profile(segment, stretches, index)
            if done == index:
                yield from self._advance_to(segment, int(stretches[index]), index)
                done = index + 1
            self.reached = int(segment.instants[done - 1])
            index = done
        if self.given_up and len(segment.instants):  # after a reset, the run continues with the next segment
            self.reached = int(segment.instants[-1])

    def _start(self, segment: Segment) -> Iterator[Begun | Event]:
        moment = float(segment.instants[0] * 1e-9)
        try:
            self.simulation = self._begin(Inputs(*segment.inputs[0].tolist()))
        except IntegrationError as error:
            yield self._give_up(moment, f"the model has no state at the first inputs: {error}")
        else:
            yield Begun(moment, start_sample(self.simulation))
        self.reached = int(segment.instants[0])

    def _advance_to(self, segment: Segment, stretch: int, index: int) -> Iterator[Arrival | Output | Event]:
        """Advance by ``stretch`` [ns] to one instant."""
        moment = float(segment.instants[index] * 1e-9)
        yield from segment.arrivals(index)
        if segment.in_gap[index]:
            self.in_gaps_ns += stretch
            return
        try:
            block = self.simulation.advance(stretch * 1e-9, Inputs(*segment.inputs[index].tolist()))
        except IntegrationError as error:
            yield from self._fail(moment, error)
            return
        yield from self._recover(moment)
        self.simulated_ns += stretch
        self._since_output_ns += stretch
        if segment.is_output[index]:
            yield self._output(block, moment)

    def _advance_profile(self, segment: Segment, stretches: np.ndarray, first: int) -> Iterator[Arrival | Output | Event]:
        """Advance by ``stretches`` [ns] over many instants at once; return the index of the next one, ``first`` if that needs `_advance_to`."""
        end = min(first + _COURSE, len(stretches))
        gaps = np.flatnonzero(segment.in_gap[first:end])
        end = first + int(gaps[0]) if len(gaps) else end
        if end == first:
            return first
        block = self.simulation.advance_profile(stretches[first:end] * 1e-9, segment.inputs[first:end])
        reached = len(block)
        if not reached:
            return first
        times, stretches = segment.instants[first : first + reached] * 1e-9, stretches[first : first + reached]
        yield from self._recover(float(times[0]))
        self.simulated_ns += int(stretches.sum())
        if self._outputs_only:
            yield from self._all_outputs(block, times, stretches, segment.is_output[first : first + reached])
            return first + reached
        for k in range(reached):
            yield from segment.arrivals(first + k)
            self._since_output_ns += int(stretches[k])
            if segment.is_output[first + k]:
                yield self._output(block[k : k + 1], float(times[k]))
        return first + reached

    def _output(self, block: np.ndarray, moment: float) -> Output:
        block["time"] = moment  # the profile's time, which includes gaps and failed stretches
        weights, self._since_output_ns = np.array([self._since_output_ns * 1e-9]), 0
        return Output(block, weights)

    def _all_outputs(self, block: np.ndarray, times: np.ndarray, stretches: np.ndarray, is_output: np.ndarray) -> Iterator[Output]:
        waited = self._since_output_ns + np.cumsum(stretches)
        self._since_output_ns = int(waited[-1])
        if is_output.any():
            block, weights = block[is_output], np.diff(waited[is_output], prepend=0) * 1e-9
            block["time"] = times[is_output]
            self._since_output_ns -= int(waited[is_output][-1])
            yield Output(block, weights)

    def _fail(self, moment: float, error: IntegrationError) -> Iterator[Event]:
        self.failures += 1
        self.failures_in_a_row += 1
        if self.failures_in_a_row == 1:
            action = "this stretch is skipped, the last good state is held and the next inputs are tried"
            yield Event(moment, Level.ERROR, "solver.failed", "", f"time could not be advanced ({error})", action)
        if self.failures_in_a_row >= _FAILURES_IN_A_ROW:
            reason = f"{self.failures_in_a_row} stretches in a row could not be integrated, the last one up to {moment:.3f} s: {error}"
            yield self._give_up(moment, reason)

    def _recover(self, moment: float) -> Iterator[Event]:
        if self.failures_in_a_row:
            reason = f"time advances again after {self.failures_in_a_row} failed stretches"
            self.failures_in_a_row = 0
            yield Event(moment, Level.OK, "solver.recovered", "", reason)

    def _give_up(self, moment: float, reason: str) -> Event:
        self.given_up = reason
        return Event(moment, Level.ERROR, "run.given_up", "", reason)
