# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a person should be told about a run that follows a clock: the clock itself, and how far behind it the model is.

Pure: it reads the clock's watch, the runner and the gate.
"""

import math
import re

from bearing_sim.events import Event, Level
from bearing_sim.runtime.clock_runner import ClockRunner
from bearing_sim.runtime.clock_watch import ClockWatch
from bearing_sim.runtime.input_gate import InputGate

CAUGHT_UP = "all known is computed and passed on"
"""Key of whether the model has come as far as the clock and the messages allow, and everybody has been told."""
_BEHIND = 2.0  # [s of wall time] of catching up without a pause from which on it is told


def clock_events(now: float, wall: float, clock: ClockWatch, held_until: int | None) -> list[Event]:
    """Return what holds of the clock.

    Parameters
    ----------
    now : run time of the events [s].
    wall : wall time [s].
    clock : its readings.
    held_until : [ns since the epoch] where a jump back is held as an error.
    """
    if clock.now is None:
        text = "no /clock: use_sim_time is set, and nothing is computed before its first message; publish it, or set use_sim_time to false"
        return [Event(0.0, Level.WARN, "clock.absent", text)]
    if held_until is not None:
        text = (
            f"the clock jumped back to {clock.now * 1e-9:.3f} s and clock_jump_back is error: the last good state is held until it has "
            f"passed {held_until * 1e-9:.3f} s again, or until ~/reset begins anew"
        )
        return [Event(now, Level.ERROR, "clock.jumped_back", text)]
    if clock.stands_still(wall):
        return [Event(now, Level.OK, "clock.stands_still", f"paused: the clock stands still at {clock.now * 1e-9:.3f} s")]
    return []


def walk_events(now: float, clock: ClockWatch, runner: ClockRunner) -> list[Event]:
    """Return what holds of the model on its way, as of run time ``now`` [s]."""
    events = []
    if runner.given_up:
        text = f"the model is given up until ~/reset or a jump back of the clock: {runner.given_up}"
        events.append(Event(now, Level.ERROR, "run.given_up", text))
    reached = runner.reached
    if reached is None:
        text = f"waiting for the first {' and '.join(runner.awaited()) or 'instant'}; nothing is computed yet"
        events.append(Event(now, Level.OK, "run.waiting", text))
    elif runner.busy_for > _BEHIND and clock.now is not None:
        behind = (clock.now - reached) * 1e-9
        text = f"the model is {behind:.3g} s behind the clock and catches up; nothing is lost"
        if not math.isnan(pace := runner.pace.solver_factor):
            text += f" (the solver alone reaches {pace:.3g} of real time)"
        events.append(Event(now, Level.WARN, "run.behind", text))
    return events


def flow_events(now: float, gate: InputGate) -> list[Event]:
    """Return what is wrong with the flow of messages, as of the gate's time ``now`` [s], by when they have had time to come."""
    return [event._replace(text=re.sub(r"holding .*$", "the model waits where it is", event.text)) for event in gate.check(now)]


def progress(wall: float, clock: ClockWatch, runner: ClockRunner) -> dict[str, object]:
    """Return the numbers that only a run by a clock has, as of a wall time [s], the unit in each key."""
    reached = runner.reached
    numbers: dict[str, object] = {"clock [s]": clock.now * 1e-9 if clock.now is not None else math.nan}
    if reached is not None and clock.now is not None:
        numbers["behind the clock [s]"] = (clock.now - reached) * 1e-9
    caught_up = clock.now is not None and clock.settled(wall) == clock.now and runner.is_idle
    return numbers | {CAUGHT_UP: caught_up, "waits for": ", ".join(runner.awaited()) or "nothing", "messages waiting": runner.waiting}
