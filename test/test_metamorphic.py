# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Relations that hold on any bearing, on random scenes of the catalogue; `benchmarks/metamorphic.py` has many more, at all levels."""

import pytest
from metamorphic import (
    Answer,
    differs,
    equal_scenes,
    missing_power,
    settled_answer,
    steady_against_slip,
    violations_of_cutting,
    violations_of_solved_symmetry,
    violations_of_symmetry,
)
from random_scenes import cold_start, random_scenes

from bearing_sim.scene.loader import load_scene
from bearing_sim.sweep.settling import cage_turn
from bearing_sim.sweep.states import SKID

SEED = 42


@pytest.mark.parametrize("cold", [False, True], ids=["usual loads", "cold and lightly loaded"])
def test_level_steady_gives_one_answer_for_one_physical_scene(cold):
    assert [each for scene in random_scenes(SEED, 16, "steady", cold) for each in violations_of_solved_symmetry(scene)] == []


@pytest.mark.parametrize("cold", [False, True], ids=["usual loads", "cold and lightly loaded"])
def test_level_slip_gives_one_answer_for_one_physical_scene(cold):
    assert [each for scene in random_scenes(SEED, 4, "slip", cold) for each in violations_of_symmetry(scene)] == []


def test_pieces_and_samples_of_a_run_change_neither_slip_nor_damage_nor_power():
    scenes = random_scenes(SEED, 8, "slip")
    assert [each for scene in scenes for each in violations_of_cutting(scene, 10.0 * cage_turn(scene))] == []


@pytest.mark.parametrize("level", ["steady", "slip"])
def test_what_the_shaft_puts_in_is_what_is_lost(level):
    assert max(missing_power(scene) for scene in random_scenes(SEED, 5, level)) < 0.01


def test_level_steady_agrees_with_level_slip():
    pairs = filter(None, (steady_against_slip(scene) for scene in random_scenes(SEED, 8, "steady")))
    assert [pair for pair in pairs if differs(*pair, slip=5e-4)] == []


def test_a_skid_is_the_same_whichever_way_the_shaft_turns():
    scene = cold_start().at(load_angle="-70 deg")
    mirrored = scene.at(shaft_speed=-scene.operating.shaft_speed, load_angle=-scene.operating.load_angle)
    forwards, backwards = (settled_answer(each, SKID) for each in (scene, mirrored))
    assert forwards.cage_slip > 0.05 and not differs(forwards, backwards)


def test_a_relation_that_is_false_is_seen():
    """The load turned by half a lobe is another scene, and so is half of the load."""
    scene = load_scene("deng2017_table1", ["level=steady"])
    names = [name for name, _ in equal_scenes(scene)]
    assert any("lobes" in name for name in names) and "reversed" not in names
    first, other = (settled_answer(each) for each in (scene, scene.at(load_angle="60 deg", radial_load="1200 N")))
    assert differs(first, other)
    assert differs(Answer(0.1, 100.0, 10.0), Answer(0.1, 100.0, 10.5)) and not differs(Answer(0.1, 100.0, 10.0), Answer(0.1005, 103.0, 10.3))
