# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The runner on its own thread: paced ticks, held inputs, bounded output, faults told and survived, prompt stop."""

import threading
import time

import numpy as np
import pytest
from fake_simulation import START, FakeSimulation

from bearing_sim.events import Event, Level
from bearing_sim.runtime.pacer import Pacer
from bearing_sim.runtime.runner import Phase, Runner

FAST = START._replace(shaft_speed=300.0)


class Rig:
    """A runner on a fake simulation, stopped at the end of a test."""

    def __init__(self, simulation=None, **options):
        self.simulation = simulation or FakeSimulation()
        self.runner = Runner(self.simulation, Pacer(options.pop("rate", 10.0)), **options)
        self.items = []

    def start(self, inputs=START):
        self.runner.start()
        if inputs is not None:
            self.runner.post(inputs)
        return self

    def collect(self, until, seconds=10.0):
        """Take items until the condition holds; fail when it does not within that many seconds."""
        deadline = time.monotonic() + seconds
        while not until(self):
            assert time.monotonic() < deadline, f"waited {seconds} s in vain; phase {self.runner.phase}"
            self.items += self.runner.take()
            time.sleep(0.005)
        self.items += self.runner.take()

    @property
    def blocks(self):
        return [item for item in self.items if isinstance(item, np.ndarray)]

    @property
    def codes(self):
        return [item.code for item in self.items if isinstance(item, Event)]

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
        if one.runner.phase is not Phase.READY:
            assert one.runner.stop(), "the thread did not end within two seconds"


def test_simulated_time_keeps_step_with_wall_time(rig):
    one = rig(rate=1.0).start()
    one.collect(lambda r: len(r.blocks) > 5)
    wall, sim = time.monotonic(), one.runner.newest["time"]
    time.sleep(1.0)
    one.collect(lambda r: abs(r.runner.newest["time"] - sim - (time.monotonic() - wall)) < 0.15)
    pace = one.runner.pace
    assert pace.real_time_factor < 1.2 and (pace.real_time_factor > 0.8 or pace.lost > 0.0), "what is not held must be told as lost"


def test_nothing_runs_before_the_first_input_and_the_model_starts_in_ideal_rolling_at_it(rig):
    one = rig().start(inputs=None)
    time.sleep(0.1)
    assert one.runner.phase is Phase.WAITING and one.runner.newest is None and not one.simulation.calls
    one.runner.post(FAST)
    one.collect(lambda r: len(r.blocks) > 3)
    assert one.simulation.resets[-1] == FAST
    assert one.times[0] > 0.5, "waiting at rate 10 for 0.1 s is part of the run time"


def test_over_a_tick_inputs_go_from_the_previous_to_the_latest_value(rig):
    one = rig(samples=4).start()
    one.collect(lambda r: len(r.blocks) > 3)
    one.runner.post(FAST)
    one.collect(lambda r: r.blocks[-1]["shaft_speed"][-1] == 300.0)
    (ramp,) = [block for block in one.blocks if block["shaft_speed"][0] not in (100.0, 300.0)]
    assert ramp["shaft_speed"] == pytest.approx([150.0, 200.0, 250.0, 300.0])


def test_other_ticks_begin_after_a_whole_number_of_those_from_one_kept_sample_to_the_next(rig):
    ends = []

    def advanced(now):
        ends.append(one.simulation.time)
        if len(ends) == 3:
            one.runner.tick_by(0.02, 2, 1)

    one = rig(tick=0.01, samples=1, every=2, advanced=advanced).start()
    one.collect(lambda r: len(ends) >= 6)
    assert ends[:6] == pytest.approx([0.01, 0.02, 0.03, 0.04, 0.06, 0.08])
    assert [len(block) for block in one.blocks[1:7]] == [1, 1, 1, 1, 2, 2]


def test_only_the_latest_of_many_inputs_counts_and_posting_never_waits_for_the_solver(rig):
    one = rig(rate=1.0)
    one.simulation.seconds_per_tick = 0.2
    one.start()
    began = time.monotonic()
    for speed in range(20000):
        one.runner.post(START._replace(shaft_speed=float(speed)))
    assert time.monotonic() - began < 3.0
    one.collect(lambda r: r.blocks and r.blocks[-1]["shaft_speed"][-1] == 19999.0)
    assert len(one.blocks) < 30


def test_a_queue_that_nobody_empties_loses_the_oldest_and_counts_them(rig):
    one = rig(rate=50.0, capacity=10).start()
    deadline = time.monotonic() + 10.0
    while len(one.simulation.calls) < 60 and time.monotonic() < deadline:
        time.sleep(0.01)
    one.runner.pause()
    time.sleep(0.1)
    blocks = one.runner.take()
    assert len(blocks) == 10
    assert one.runner.dropped == 1 + len(one.simulation.calls) - 10  # the first block is the state at the start
    assert blocks[-1]["time"][-1] == one.runner.newest["time"]


def test_a_failed_integration_is_told_once_state_is_held_and_the_run_goes_on(rig):
    one = rig()
    one.simulation.fails_at = lambda now, inputs: inputs.shaft_speed == 300.0
    one.start()
    one.collect(lambda r: len(r.blocks) > 3)
    one.runner.post(FAST)
    one.collect(lambda r: "solver.failed" in r.codes)
    held = one.runner.newest.copy()
    one.collect(lambda r: r.runner.failed_ticks > 5)
    assert one.codes.count("solver.failed") == 1
    assert one.runner.newest == held, "the last good sample stands"
    event = next(item for item in one.items if isinstance(item, Event))
    assert event.level is Level.ERROR and "step size went to zero" in event.text
    one.runner.post(START)
    one.collect(lambda r: "solver.recovered" in r.codes)
    one.collect(lambda r: r.blocks[-1]["time"][-1] > held["time"] + 0.1)
    assert (np.diff(one.times) > 0).all()
    assert one.runner.failed_ticks == 0


def test_a_program_fault_in_the_model_is_told_and_the_rest_lives_on(rig):
    one = rig()
    one.simulation.breaks_at = lambda now: now > 0.05
    one.start()
    one.collect(lambda r: r.runner.phase is Phase.CRASHED)
    crashed = [item for item in one.items if isinstance(item, Event)][-1]
    assert crashed.code == "solver.crashed" and "ZeroDivisionError" in crashed.text
    assert one.runner.newest["time"] > 0.0
    assert one.runner.reset(timeout=0.2) is False


def test_a_slow_solver_is_not_chased_and_run_time_keeps_up_by_skipping(rig):
    one = rig(rate=1.0)
    one.simulation.seconds_per_tick = 0.03
    one.start()
    one.collect(lambda r: r.runner.pace.resyncs >= 3)
    pace = one.runner.pace
    assert 0.0 < pace.real_time_factor < 0.5 and 0.0 < pace.solver_factor < 0.5
    assert pace.lost >= 0.3
    skipped = one.times[-1] - one.times[0] - 0.01 * (len(one.times) - 1)
    assert skipped == pytest.approx(pace.lost, abs=0.35)
    assert (np.diff(one.times) > 0).all()


def test_pause_holds_time_without_loss_and_resume_goes_on(rig):
    one = rig().start()
    one.collect(lambda r: len(r.blocks) > 5)
    one.runner.pause()
    one.collect(lambda r: r.runner.phase is Phase.PAUSED)
    calls = len(one.simulation.calls)
    time.sleep(0.3)
    assert len(one.simulation.calls) == calls
    one.runner.pause(False)
    one.collect(lambda r: len(r.simulation.calls) > calls + 5)
    assert one.runner.pace.lost < 2.0, "the pause is none of it"
    assert (np.diff(one.times) > 0).all()
    assert np.diff(one.times).max() > 1.0, "0.3 s of pause at rate 10 are skipped in run time"


def test_reset_returns_damage_to_zero_at_the_present_inputs_and_time_never_goes_back(rig):
    one = rig().start()
    one.runner.post(FAST)
    one.collect(lambda r: r.blocks and r.blocks[-1]["damage"][-1] > 1e-8)
    before = one.runner.newest["damage"]
    assert one.runner.reset()
    assert one.simulation.resets[-1] == FAST
    assert one.runner.newest["damage"] < before
    one.collect(lambda r: "run.reset" in r.codes and len(r.blocks) > 10)
    assert (np.diff(one.times) > 0).all()


def test_reset_works_while_paused_and_while_waiting(rig):
    waiting = rig().start(inputs=None)
    assert waiting.runner.reset() and waiting.runner.phase is Phase.WAITING
    paused = rig().start()
    paused.collect(lambda r: len(r.blocks) > 5)
    paused.runner.pause()
    assert paused.runner.reset()
    assert paused.runner.newest["damage"] == 0.0
    paused.collect(lambda r: r.runner.phase is Phase.PAUSED)


@pytest.mark.parametrize("state", ["waiting", "running", "paused", "failing"])
def test_stop_ends_the_thread_in_every_state(state):
    one = Rig()
    if state == "failing":
        one.simulation.fails_at = lambda now, inputs: True
    one.start(inputs=None if state == "waiting" else START)
    if state == "paused":
        one.runner.pause()
    time.sleep(0.05)
    assert one.runner.stop(timeout=2.0)
    assert one.runner.phase is Phase.STOPPED
    assert not any(thread.name == "bearing-solver" and thread.is_alive() for thread in threading.enumerate())


def test_stopping_a_runner_that_never_started_is_harmless():
    assert Runner(FakeSimulation(), Pacer()).stop()
