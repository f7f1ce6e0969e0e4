# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the inner ring is near a resonance with the passing rollers, the longest step is shorter, by the mean stiffness of the raceways."""

import numpy as np
import pytest

from bearing_sim import Simulation, load_scene
from bearing_sim.levels.common.model import ring_step
from bearing_sim.levels.planar import forces as planar_forces
from bearing_sim.levels.planar import model as planar
from bearing_sim.levels.spatial import forces as spatial_forces
from bearing_sim.levels.spatial import model as spatial
from bearing_sim.levels.spatial.state import SLICED
from bearing_sim.physics.contact import CONTACT

LEVELS = {"planar": (planar, planar_forces.equations, CONTACT), "spatial": (spatial, spatial_forces.equations, SLICED)}


def simulation(level):
    return Simulation(load_scene("deng2017_table1", [f"level={level}", "operating.shaft_speed=15000 rpm", "operating.radial_load=5 kN"]))


@pytest.mark.parametrize("level", LEVELS)
def test_the_mean_stiffness_of_the_raceways_is_that_of_springs_in_series_along_the_azimuths_of_the_rollers(level):
    model_of_level, equations, contact = LEVELS[level]
    run = simulation(level)
    run.advance(0.02)
    work, count = run._work, run._params.rollers.count

    def lanes(rows):
        return rows.reshape(-1)[:count]

    def stiffness(state):
        equations(0.0, state, run._model(run.inputs, 1.0), work, np.zeros_like(state), False)
        blocks = work.rollers.shape[0]
        each = [lanes(part[:, contact.stiffness]) for part in (work.contacts[:blocks], work.contacts[blocks:])]
        pressed = (each[0] > 0.0) & (each[1] > 0.0)
        series = 1.0 / (1.0 / each[0][pressed] + 1.0 / each[1][pressed])
        azimuths = run.sample["roller_angle"][pressed]
        directions = np.column_stack([np.cos(azimuths), np.sin(azimuths)])
        return (directions.T * series) @ directions

    expected = stiffness(run._state)
    work.ring_stiffness[:] = 0.0
    model_of_level.sum_up(0.0, 1e-12, run._state, run._model(run.inputs, 1.0), work)  # the first instant counts as a whole
    np.testing.assert_allclose(work.ring_stiffness, [expected[0, 0], expected[0, 1], expected[1, 1]], rtol=1e-6, atol=1e-9 * expected.max())
    turn = 2.0 * np.pi / run.sample["cage_speed"]
    work.ring_stiffness[:] = 0.0, 0.0, 1.0
    model_of_level.sum_up(0.0, turn, run._state, run._model(run.inputs, 1.0), work)
    assert work.ring_stiffness[0] == pytest.approx((1.0 - np.exp(-1.0)) * expected[0, 0], rel=1e-6), "a mean over a cage turn"


REACHES = {0.25: (0.2, 0.7), 1.0: (0.4, 0.5), 2.25: (0.15, 0.5), 4.0: (0.12, 0.5), 6.25: (0.12, 0.45), 9.0: (0.25, 0.4)}


@pytest.mark.parametrize("ratio", [0.0, 0.25, 0.28, 0.36, 0.7, 1.0, 1.2, 1.51, 2.25, 3.2, 4.0, 4.3, 5.2, 6.3, 6.7, 9.0, 12.0])
def test_steps_are_shorter_by_whole_steps_a_pitch_where_the_ring_is_slow_or_near_a_resonance(ratio):
    """With the ring's squared frequency as a ratio to that of passing; written out from doc/theory/integrators.md."""
    params, cage_speed = simulation("planar")._params, 700.0
    golden, passing = 0.5 * (np.sqrt(5.0) - 1.0), params.rollers.count * cage_speed
    stiff, soft = ratio * params.ring.mass * passing**2, 20.0 * params.ring.mass * passing**2
    parts = [max(np.sqrt(min(1.0, abs(1.0 - ratio / square) / reach)), least) for square, (reach, least) in REACHES.items()]
    fifths = 4.0 + golden
    expected = fifths + round(fifths / min(parts) - fifths) if ratio < 1.0 or min(parts) < 1.0 else 3.0 + golden
    step = ring_step(cage_speed, params, np.array([stiff, 0.0, soft]))
    assert 2.0 * np.pi / (passing * step) == pytest.approx(expected, rel=1e-12)
    tilted = np.array([0.5 * (stiff + soft), 0.5 * (stiff - soft), 0.5 * (stiff + soft)])  # the same, turned by 45 degrees
    assert ring_step(cage_speed, params, tilted) == pytest.approx(step, rel=1e-9)
    assert (expected == 3.0 + golden) == (ratio in (1.51, 3.2, 5.2, 12.0)), "far above any resonance, a quarter of a pitch"
    assert (expected == fifths) == (ratio in (0.0, 0.36)), "where the ring is slower than the passing rollers, a fifth"
