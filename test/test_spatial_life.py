# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Life by slices at level spatial: what misalignment and crown do to it."""

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.physics.lamina_life import stress_risers


def last(*overrides):
    named = ["level=spatial", "operating.shaft_speed=15000 rpm", "operating.radial_load=2 kN", "bearing.roller.slices=30"]
    return Simulation(load_scene("deng2017_table1", [*named, *overrides])).advance(0.03, samples=30)[-1]


def test_misalignment_shortens_the_life_by_slices_and_a_crown_softens_that():
    flat, tilted = last(), last("operating.misalignment=1 mrad")
    crowned = last("bearing.roller.crown=iso_log", "operating.misalignment=1 mrad")
    assert tilted["l10r"] < 0.9 * flat["l10r"]
    assert crowned["l10r"] > tilted["l10r"]


def test_life_of_flat_rollers_without_misalignment_is_the_basic_one_less_what_the_edges_bear():
    sample = last()
    # equal slices: (sum over slices of f^4.5)/N to the power -8/9 times the basic life, whatever the load
    expected = np.mean(stress_risers(40) ** 4.5) ** (-8 / 9)
    assert sample["l10r"] / sample["rating_life"] == pytest.approx(expected, rel=0.05)


def test_damage_counts_the_life_by_slices_where_the_scene_wants_it():
    basic, lamina = last("operating.misalignment=1 mrad"), last("operating.misalignment=1 mrad", "life.method=iso16281")
    assert np.isfinite(lamina["modified_rating_life"])
    assert lamina["damage"] > basic["damage"]
    assert basic["modified_rating_life"] == pytest.approx(basic["rating_life"])
    assert lamina["modified_rating_life"] == pytest.approx(lamina["l10r"])


def test_life_by_slices_is_a_mean_over_a_cage_turn_also_where_the_end_slices_carry_nothing():
    overrides = ["level=spatial", "bearing.roller.crown=iso_log", "bearing.roller.slices=100", "operating.misalignment=1 mrad"]
    run = Simulation(load_scene("deng2017_table1", overrides))
    run.advance(0.02)
    lives = run.advance(0.004, samples=16)["l10r"]  # a cage turn takes 3 ms, a roller pitch a tenth of that
    assert np.ptp(lives) < 0.1 * lives.mean()
