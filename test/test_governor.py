# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The governor: when it steps down and up, and that a change of level carries the bearing on without a jump."""

import dataclasses
import math

import numpy as np
import pytest
from fake_simulation import FakeSimulation
from test_live import Bench

from bearing_sim import Simulation, load_scene
from bearing_sim.messages.events import Level
from bearing_sim.runtime.governor import Governor
from bearing_sim.runtime.live import governor_of
from bearing_sim.runtime.solver_threads import CommonPace

TICK = 0.005


class Machine:
    """A machine on which a level costs so many wall seconds for a simulated one."""

    def __init__(self, **costs):
        self.costs = costs
        self.rungs = {level: FakeLevel(level) for level in costs}
        self.governor = Governor(list(self.rungs.values()), patience=2.0)
        self.now, self.changes = 0.0, []

    def run(self, seconds):
        end = self.now + seconds
        while self.now < end:
            spent = TICK * self.costs[self.governor.level]
            self.now += max(TICK, spent)
            change = self.governor.consider(TICK, spent)
            if change is not None:
                self.changes.append((self.now, self.governor.level))
        return self.governor.level


class SharedMachine:
    """Several bearings whose ticks one thread computes one after the other, always in the same order."""

    def __init__(self, bearings, **costs):
        self.costs, self.common, self.now, self.lost = costs, CommonPace(), 0.0, 0.0
        self.governors = [Governor([FakeLevel(level) for level in costs], patience=2.0) for _ in range(bearings)]
        self.texts = []

    def run(self, seconds):
        end, free, done = self.now + seconds, self.now, {governor: self.now for governor in self.governors}
        while self.now < end:
            due = self.now
            for governor in self.governors:
                could_begin, began = max(due, done[governor]), max(due, free)
                spent = TICK * self.costs[governor.level]
                free = done[governor] = began + spent
                change = governor.consider(TICK, spent, began - could_begin, self.common, free)
                if change is not None:
                    self.texts.append(change.text)
            self.now = due + TICK
            if free - self.now > 0.2:  # [s] more is not caught up
                self.lost += free - self.now
                self.now = free
        return [governor.level for governor in self.governors].count(next(iter(self.costs)))


class FakeLevel(FakeSimulation):
    """A stand-in at a level; takes over time and angle."""

    def __init__(self, level):
        super().__init__()
        self.scene = dataclasses.replace(load_scene("deng2017_table1"), level=level)

    def take_over(self, other):
        self.time, self.angle, self.inputs = other.time, other.angle, other.inputs


def test_a_level_that_holds_real_time_stays():
    machine = Machine(planar=0.9, slip=0.1)
    assert machine.run(20.0) == "planar"
    assert machine.changes == []


def test_a_governor_that_is_switched_off_leaves_the_wanted_level_going_on_from_where_the_cheaper_one_was():
    machine = Machine(planar=1.5, slip=0.1)
    assert machine.run(1.0) == "slip"
    machine.rungs["slip"].time, machine.rungs["slip"].angle = 12.5, 3.25
    left = machine.governor.leave()
    assert left is machine.rungs["planar"] and (left.time, left.angle) == (12.5, 3.25) and machine.governor.level == "planar"


def test_a_level_that_is_too_slow_gives_way_before_the_lag_is_given_up():
    machine = Machine(planar=1.5, slip=0.1)
    machine.run(1.0)
    (when, level), *_ = machine.changes
    assert level == "slip"
    assert when < 0.3  # 0.2 s of simulated time, 0.1 s of lag


def test_it_goes_down_as_far_as_it_must_and_no_further():
    assert Machine(spatial=5.0, planar=2.0, slip=0.1).run(5.0) == "slip"
    assert Machine(spatial=5.0, planar=0.9, slip=0.1).run(1.5) == "planar"


def test_it_comes_back_when_the_machine_is_free_again_and_not_before():
    machine = Machine(planar=1.5, slip=0.2)
    assert machine.run(10.0) == "slip"
    assert len(machine.changes) == 1  # what it measured on the way down tells that planar would not hold
    machine.costs = {"planar": 0.5, "slip": 0.2 / 3}
    assert machine.run(1.5) == "slip"
    assert machine.run(1.5) == "planar"


def test_a_level_that_falls_again_is_waited_for_longer_each_time():
    machine = Machine(planar=0.5, slip=0.1)
    for _ in range(60):  # a machine that is free whenever planar does not run
        machine.costs = {"planar": 1.5, "slip": 0.02} if machine.governor.level == "planar" else {"planar": 0.3, "slip": 0.02}
        machine.costs["planar"] = 1.5
        machine.run(1.0)
        machine.governor._cost_ratios = [1.0, math.nan]  # it believes the best each time
    came_up = [when for when, level in machine.changes if level == "planar"]
    waits = np.diff([0.0, *came_up])
    assert len(waits) >= 3
    assert np.all(waits[1:] > 1.5 * waits[:-1])


def test_of_bearings_that_are_too_slow_together_as_many_fall_as_must_and_the_text_says_why():
    machine = SharedMachine(20, slip=0.11, steady=0.01)
    assert 5 <= machine.run(10.0) <= 8, "8 at slip and 12 at steady take the whole thread"
    assert all("the bearings that share a process reach" in text for text in machine.texts[:5])
    lost = machine.lost
    wanted = machine.run(30.0)
    assert 5 <= wanted <= 8 and machine.lost == lost, "once they keep up, nothing is lost any more"


def test_bearings_that_keep_up_together_stay_and_those_that_fell_come_back_when_the_machine_is_free():
    machine = SharedMachine(8, slip=0.11, steady=0.01)
    assert machine.run(20.0) == 8 and machine.texts == []
    machine.costs["slip"] = 0.3
    assert machine.run(10.0) <= 3
    machine.costs.update(slip=0.05, steady=0.005)
    assert machine.run(60.0) == 8


def test_a_level_that_turns_out_to_be_no_faster_is_left_at_once_and_for_good():
    machine = Machine(planar=1.5, steady=4.0, slip=0.2)
    machine.run(1.0)
    assert [level for _, level in machine.changes] == ["steady", "planar", "slip"]
    assert machine.changes[1][0] - machine.changes[0][0] < 2.0
    machine.costs["planar"] = 0.1
    machine.run(10.0)
    machine.costs["planar"] = 1.5
    machine.run(10.0)
    assert "steady" not in [level for _, level in machine.changes[1:]]
    alone = SharedMachine(4, slip=0.4, steady=1.2)
    assert alone.run(5.0) == 4 and "bearing-sim table builds" in alone.texts[-1] and len(alone.texts) == 8


def test_a_machine_that_holds_no_level_stays_at_the_cheapest():
    machine = Machine(planar=9.0, slip=3.0)
    assert machine.run(10.0) == "slip"
    assert len(machine.changes) == 1


def test_a_reset_returns_to_the_wanted_level():
    machine = Machine(planar=2.0, slip=0.1)
    machine.run(1.0)
    assert machine.governor.restart() is machine.rungs["planar"]
    assert machine.governor.level == "planar"


@pytest.mark.parametrize(("first", "second"), [("slip", "planar"), ("planar", "slip"), ("planar", "spatial"), ("spatial", "slip")])
def test_another_level_goes_on_with_the_same_cage_damage_and_angles(first, second):
    before, after = (Simulation(load_scene("deng2017_table1", [f"level={level}"])) for level in (first, second))
    before.advance(0.02, samples=4)
    after.take_over(before)
    for name in ("time", "cage_angle", "cage_speed", "shaft_angle", "ideal_cage_angle", "damage", "roller_spin", "roller_rotation", "load_y"):
        np.testing.assert_array_equal(after.sample[name], before.sample[name], err_msg=name)
    block = after.advance(0.001, samples=10)
    assert after.time == before.time + 0.001
    assert np.abs(block["cage_speed"] / before.sample["cage_speed"] - 1).max() < 0.01
    assert np.all(np.diff(block["damage"], prepend=before.sample["damage"]) > 0)
    turned = block["cage_angle"][-1] - before.sample["cage_angle"]
    assert turned == pytest.approx(0.001 * before.sample["cage_speed"], rel=0.01)


def test_planar_finds_its_own_slip_again_after_a_while_at_slip():
    run, other = (Simulation(load_scene("deng2017_table1", [f"level={level}"])) for level in ("planar", "slip"))
    run.advance(0.2)
    settled = run.advance(0.02, samples=50)["cage_slip"].mean()
    other.take_over(run)
    other.advance(0.05)
    run.take_over(other)
    run.advance(0.15)
    assert run.advance(0.02, samples=50)["cage_slip"].mean() == pytest.approx(settled, abs=5e-4)


def test_a_bearing_with_other_rollers_cannot_go_on():
    one, other = Simulation(load_scene("deng2017_table1")), Simulation(load_scene("deng2017_table1", ["bearing.roller.count=17"]))
    with pytest.raises(ValueError, match="18 rollers with one of 17"):
        other.take_over(one)


def test_a_scene_that_needs_its_level_has_no_governor():
    crowned = load_scene("deng2017_table1", ["level=spatial", "operating.misalignment=1 mrad", "bearing.roller.slices=5"])
    assert governor_of(Simulation(crowned)) is None


def test_a_governor_falls_to_a_plain_table_where_the_corrected_one_that_a_scene_asks_for_was_never_built():
    scene = load_scene("deng2017_table1", ["level=slip", "table.correction=planar", "table.maximum_speed=45678 rpm"])
    made = governor_of(Simulation(scene))
    assert [rung.scene.level for rung in made._ladder] == ["slip", "steady"]
    assert made._ladder[1].scene.table.correction == "none"


def test_live_model_tells_the_change_and_keeps_telling_the_level():
    wanted, cheaper = FakeLevel("planar"), FakeLevel("slip")
    wanted.seconds_per_tick = 3 * TICK
    bench = Bench(simulation=wanted, governor=Governor([wanted, cheaper]))
    bench.live.scene = wanted.scene
    bench.run(1.0)
    condition = bench.live.condition(bench.now_ns)
    bench.live.close()
    assert condition.values["level"] == "slip"
    (lasting,) = [event for event in condition.events if event.kind == "governor.level"]
    assert lasting.level is Level.WARN
    assert "instead of planar" in lasting.text
    (change,) = [event for event in bench.news if event.kind == "governor.change"]
    assert "planar reaches" in change.text
    assert "slip continues" in change.text
