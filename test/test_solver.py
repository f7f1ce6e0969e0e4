# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The solver on its own thread: paced ticks, held inputs, bounded output, faults told and survived, prompt stop."""

import threading
import time

import numpy as np
import pytest
from fake_simulation import START, FakeSimulation

from bearing_sim.messages.events import Event, Level
from bearing_sim.runtime.health import Phase
from bearing_sim.runtime.pacing import Pacer, TickSchedule
from bearing_sim.runtime.solver import WallTimeSolver

SCHEDULE = TickSchedule(0.01, 1, 1)
FAST = START._replace(shaft_speed=300.0)


class Rig:
    """A solver on a fake simulation, stopped at the end of a test."""

    def __init__(self, simulation=None, **options):
        self.simulation = simulation or FakeSimulation()
        self.solver = WallTimeSolver(self.simulation, Pacer(options.pop("rate", 10.0)), options.pop("schedule", SCHEDULE), **options)
        self.items = []

    def start(self, inputs=START):
        self.solver.start()
        if inputs is not None:
            self.solver.post(inputs)
        return self

    def collect(self, until, seconds=10.0):
        """Take items until the condition holds; fail when it does not within that many seconds."""
        deadline = time.monotonic() + seconds
        while not until(self):
            assert time.monotonic() < deadline, f"waited {seconds} s in vain; phase {self.solver.phase}"
            self.items += self.solver.drain()
            time.sleep(0.005)
        self.items += self.solver.drain()

    @property
    def blocks(self):
        return [item for item in self.items if isinstance(item, np.ndarray)]

    @property
    def codes(self):
        return [item.kind for item in self.items if isinstance(item, Event)]

    @property
    def times(self):
        return np.concatenate([block["time"] for block in self.blocks]) if self.blocks else np.empty(0)


@pytest.fixture
def rig(request):
    rigs = []

    def make(*args, **options):
        rigs.append(Rig(*args, **options))
        return rigs[-1]

    yield make
    for one in rigs:
        if one.solver.phase is not Phase.READY:
            assert one.solver.stop(), "the thread did not end within two seconds"


def test_simulated_time_keeps_step_with_wall_time(rig):
    one = rig(rate=1.0).start()
    one.collect(lambda r: len(r.blocks) > 5)
    wall, sim = time.monotonic(), one.solver.newest["time"]
    time.sleep(1.0)
    one.collect(lambda r: abs(r.solver.newest["time"] - sim - (time.monotonic() - wall)) < 0.15)
    pace = one.solver.pace
    assert pace.real_time_factor < 1.2 and (pace.real_time_factor > 0.8 or pace.lost > 0.0), "what is not held must be told as lost"


def test_nothing_runs_before_the_first_input_and_the_model_starts_in_ideal_rolling_at_it(rig):
    one = rig().start(inputs=None)
    time.sleep(0.1)
    assert one.solver.phase is Phase.WAITING and one.solver.newest is None and not one.simulation.calls
    one.solver.post(FAST)
    one.collect(lambda r: len(r.blocks) > 3)
    assert one.simulation.resets[-1] == FAST
    assert one.times[0] > 0.5, "waiting at rate 10 for 0.1 s is part of the run time"


def test_over_a_tick_inputs_go_from_the_previous_to_the_latest_value(rig):
    one = rig(schedule=TickSchedule(0.01, 4, 1)).start()
    one.collect(lambda r: len(r.blocks) > 3)
    one.solver.post(FAST)
    one.collect(lambda r: r.blocks[-1]["shaft_speed"][-1] == 300.0)
    (ramp,) = [block for block in one.blocks if block["shaft_speed"][0] not in (100.0, 300.0)]
    assert ramp["shaft_speed"] == pytest.approx([150.0, 200.0, 250.0, 300.0])


def test_other_ticks_begin_after_a_whole_number_of_those_from_one_kept_sample_to_the_next(rig):
    ends = []

    def advanced(now):
        ends.append(one.simulation.time)
        if len(ends) == 3:
            one.solver.tick_by(TickSchedule(0.02, 2, 1))

    one = rig(schedule=TickSchedule(0.01, 1, 2), advanced=advanced).start()
    one.collect(lambda r: len(ends) >= 6)
    assert ends[:6] == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.06, 0.08])
    assert [len(block) for block in one.blocks[1:7]] == [1, 1, 1, 1, 2, 2]


def test_only_the_latest_of_many_inputs_counts_and_posting_never_waits_for_the_solver(rig):
    one = rig(rate=1.0)
    one.simulation.seconds_per_tick = 0.2
    one.start()
    for speed in range(20000):
        one.solver.post(START._replace(shaft_speed=float(speed)))
    assert len(one.simulation.calls) < 1000, "posting does not wait for ticks"
    one.collect(lambda r: r.blocks and r.blocks[-1]["shaft_speed"][-1] == 19999.0)
    assert len(one.blocks) < 1000


def test_a_queue_that_nobody_empties_loses_the_oldest_and_counts_them(rig):
    one = rig(rate=50.0, capacity=10).start()
    deadline = time.monotonic() + 10.0
    while len(one.simulation.calls) < 60 and time.monotonic() < deadline:
        time.sleep(0.01)
    one.solver.pause()
    time.sleep(0.1)
    blocks = one.solver.drain()
    assert len(blocks) == 10
    assert one.solver.dropped == 1 + len(one.simulation.calls) - 10  # the first block is the state at the start
    assert blocks[-1]["time"][-1] == one.solver.newest["time"]


def test_a_failed_integration_is_told_once_state_is_held_and_the_run_goes_on(rig):
    one = rig()
    one.simulation.fails_at = lambda now, inputs: inputs.shaft_speed == 300.0
    one.start()
    one.collect(lambda r: len(r.blocks) > 3)
    one.solver.post(FAST)
    one.collect(lambda r: "solver.failed" in r.codes)
    held = one.solver.newest.copy()
    one.collect(lambda r: r.solver.failed_ticks > 5)
    assert one.codes.count("solver.failed") == 1
    assert one.solver.newest.tobytes() == held.tobytes(), "the last good sample stands"
    event = next(item for item in one.items if isinstance(item, Event))
    assert event.level is Level.ERROR and "step size went to zero" in event.text
    one.solver.post(START)
    one.collect(lambda r: "solver.recovered" in r.codes)
    one.collect(lambda r: r.blocks[-1]["time"][-1] > held["time"] + 0.1)
    assert (np.diff(one.times) > 0).all()
    assert one.solver.failed_ticks == 0


def test_a_program_fault_in_the_model_is_told_and_the_rest_lives_on(rig):
    one = rig()
    one.simulation.breaks_at = lambda now: now > 0.05
    one.start()
    one.collect(lambda r: r.solver.phase is Phase.CRASHED)
    crashed = [item for item in one.items if isinstance(item, Event)][-1]
    assert crashed.kind == "solver.crashed" and "ZeroDivisionError" in crashed.text
    assert one.solver.newest["time"] > 0.0
    assert one.solver.reset(timeout=0.2) is False


def test_a_slow_solver_is_not_chased_and_run_time_keeps_up_by_skipping(rig):
    one = rig(rate=1.0)
    one.simulation.seconds_per_tick = 0.03
    one.start()
    one.collect(lambda r: r.solver.pace.resyncs >= 3)
    pace = one.solver.pace
    assert 0.0 < pace.real_time_factor < 0.5 and 0.0 < pace.solver_factor < 0.5
    assert pace.lost >= 0.3
    skipped = one.times[-1] - one.times[0] - 0.01 * (len(one.times) - 1)
    assert skipped == pytest.approx(pace.lost, abs=0.35)
    assert (np.diff(one.times) > 0).all()


def test_pause_holds_time_without_loss_and_resume_goes_on(rig):
    one = rig().start()
    one.collect(lambda r: len(r.blocks) > 5)
    one.solver.pause()
    one.collect(lambda r: r.solver.phase is Phase.PAUSED)
    calls = len(one.simulation.calls)
    time.sleep(0.3)
    assert len(one.simulation.calls) == calls
    one.solver.pause(False)
    one.collect(lambda r: len(r.simulation.calls) > calls + 5)
    assert one.solver.pace.lost < 2.0, "the pause is none of it"
    assert (np.diff(one.times) > 0).all()
    assert np.diff(one.times).max() > 1.0, "0.3 s of pause at rate 10 are skipped in run time"


def test_reset_returns_damage_to_zero_at_the_present_inputs_and_time_never_goes_back(rig):
    one = rig().start()
    one.solver.post(FAST)
    one.collect(lambda r: r.blocks and r.blocks[-1]["damage"][-1] > 1e-8)
    before = one.solver.newest["damage"]
    assert one.solver.reset()
    assert one.simulation.resets[-1] == FAST
    assert one.solver.newest["damage"] < before
    one.collect(lambda r: "run.reset" in r.codes and len(r.blocks) > 10)
    assert (np.diff(one.times) > 0).all()


def test_reset_works_while_paused_and_while_waiting(rig):
    waiting = rig().start(inputs=None)
    assert waiting.solver.reset() and waiting.solver.phase is Phase.WAITING
    paused = rig().start()
    paused.collect(lambda r: len(r.blocks) > 5)
    paused.solver.pause()
    assert paused.solver.reset()
    assert paused.solver.newest["damage"] == 0.0
    paused.collect(lambda r: r.solver.phase is Phase.PAUSED)


@pytest.mark.parametrize("state", ["waiting", "running", "paused", "failing"])
def test_stop_ends_the_thread_in_every_state(state):
    one = Rig()
    if state == "failing":
        one.simulation.fails_at = lambda now, inputs: True
    one.start(inputs=None if state == "waiting" else START)
    if state == "paused":
        one.solver.pause()
    time.sleep(0.05)
    assert one.solver.stop(timeout=2.0)
    assert one.solver.phase is Phase.STOPPED
    assert not any(thread.name == "bearing-solver" and thread.is_alive() for thread in threading.enumerate())


def test_stopping_a_solver_that_never_started_is_harmless():
    assert WallTimeSolver(FakeSimulation(), Pacer(), SCHEDULE).stop()
