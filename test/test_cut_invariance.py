# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whatever the pieces in which messages arrive, a course gives the same samples to the last bit: sums over time do not see the cuts."""

import random

import numpy as np
import pytest
from sim_time_bench import SCENE, START_NS, by_channels, course

from bearing_sim.inputs.profile import OnlineInputProfile
from bearing_sim.levels.steady import table_builder as store
from bearing_sim.levels.steady.table_builder import obtain_table
from bearing_sim.runtime.advance_segment import Output, ProfileRun
from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import Simulation

pytestmark = pytest.mark.timeout(300)
RATE = 250.0  # outputs per second; the messages have rates of their own
LENGTH = {"steady": 1.2, "slip": 0.3, "planar": 0.08, "spatial": 0.05}  # of the course [s]


def advanced(simulation, seconds, scheduler):
    """Return all samples of a course, their weights and the time simulated, when messages come and are taken as ``scheduler`` says.

    ``scheduler(seconds)`` gives the instants [s] at which the messages stamped so far arrive and the model advances as far as it can.
    """
    profile, walk = OnlineInputProfile(RATE, SCENE.accepted_inputs, SCENE.lubricant.temperature), None

    def begin(inputs):
        simulation.reset(inputs)
        return simulation

    walk, samples, weights = ProfileRun(begin), [], []
    left, shuffled = course(seconds, oil=False), random.Random(7)
    for now in scheduler(seconds):
        due = [message for message in left if message.stamp <= now]
        left = left[len(due) :]
        for message in by_channels(due, shuffled):
            value = message.values[0] if len(message.values) == 1 else message.values
            profile.add_message(message.channel, message.stamp_ns, value)
        clock = START_NS + round(now * 1e9)
        while (segment := profile.claim(profile.known_until(clock, clock, []))) is not None:
            for item in walk.advance_segment(segment):
                if isinstance(item, Output):
                    samples.append(item.block)
                    weights.append(item.weights)
    assert not walk.given_up and walk.failures == 0
    return np.concatenate(samples), np.concatenate(weights), walk.simulated_ns


def at_once(seconds):
    return [seconds + 1.0]


def cut_at_random(seed):
    def scheduler(seconds):
        cuts = random.Random(seed)
        return [*sorted(cuts.uniform(0.0, seconds) for _ in range(cuts.randint(1, 40))), seconds + 1.0]

    return scheduler


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    limits = ["maximum_speed=46000 rpm", "maximum_load=1.2 kN", "minimum_temperature=120 degC", "maximum_temperature=120 degC"]
    scene = load_scene("deng2017_table1", ["level=steady", *(f"table.{limit}" for limit in limits)])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "FOLDER", tmp_path_factory.mktemp("tables"))
        yield scene, obtain_table(scene, workers=1)[0]


def assert_cuts_change_nothing(make, seconds, seeds):
    expected, weights, simulated = advanced(make(), seconds, at_once)
    assert len(expected) > 1 and len(np.unique(expected["shaft_speed"])) == len(expected), "the inputs change"
    for seed in seeds:
        samples, its_weights, its_simulated = advanced(make(), seconds, cut_at_random(seed))
        assert samples.tobytes() == expected.tobytes(), f"cut by seed {seed}"
        assert its_weights.tobytes() == weights.tobytes() and its_simulated == simulated


@pytest.mark.parametrize("level, seeds", [("slip", range(6)), ("planar", range(3)), ("spatial", range(2))])
def test_random_cuts_of_a_course_change_no_bit_at_a_level_that_integrates(level, seeds):
    scene = load_scene("deng2017_table1", [f"level={level}"])
    assert_cuts_change_nothing(lambda: Simulation(scene), LENGTH[level], seeds)


def test_random_cuts_of_a_course_change_no_bit_at_level_steady_by_its_table(table):
    scene, points = table
    assert_cuts_change_nothing(lambda: Simulation(scene, table=points), LENGTH["steady"], range(10))


def test_random_cuts_of_a_course_change_no_bit_at_level_steady_by_solving(monkeypatch, tmp_path):
    monkeypatch.setattr(store, "FOLDER", tmp_path)  # no table
    scene = load_scene("deng2017_table1", ["level=steady"])
    assert_cuts_change_nothing(lambda: Simulation(scene), 0.3, range(4))
