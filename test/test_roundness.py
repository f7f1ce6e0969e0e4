# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Roundness of the low points and life (Deng 2017, Fig. 22): what a free inner ring makes of it, and what a held one would."""

from dataclasses import dataclass

import numpy as np
import pytest
from reference_slip import Reference
from scipy.optimize import brentq

from bearing_sim import Simulation, load_scene
from bearing_sim.physics.rating_life import ring_ratings


@dataclass
class Rough(Reference):
    """The plain model with six half cosine waves, written from the definition: lows e (-1/2, 0, 1/2), highs e (1/2, 0, -1/2)."""

    d_value: float = 0.095e-3
    roundness: float = 0.0

    def contour(self, azimuth):
        spread = self.roundness * np.array([-0.5, 0.5, 0.0, 0.0, 0.5, -0.5])
        points = self.low_radius + spread + self.d_value * np.array([0, 1, 0, 1, 0, 1])
        place = np.mod(azimuth, 2 * np.pi) / (np.pi / 3)
        wave = np.floor(place).astype(int) % 6
        before, rise, phase = points[wave], points[(wave + 1) % 6] - points[wave], np.pi * (place - np.floor(place))
        return before + rise * (1 - np.cos(phase)) / 2, 3 * rise * np.sin(phase) / 2

    def held_loads(self, theta, cage_speed):
        """Inner and outer loads where the ring can move along the load only."""
        azimuth = theta + self.pitch_angles
        contour, _ = self.contour(azimuth)
        centrifugal = self.mass * (contour - self.roller_radius) * cage_speed**2

        def inner(place):
            approach = self.inner_radius + 2 * self.roller_radius - contour + 1e-6 * place * np.cos(azimuth)
            return np.array([self.roller_balance(a, c)[0] for a, c in zip(approach, centrifugal)])

        found = inner(brentq(lambda place: inner(place) @ np.cos(azimuth) - self.load, -60, 60))
        return found, found + centrifugal

    def life(self, held):
        cage_speed = 0.94 * self.shaft_speed * (1 - self.roller_radius / self.pitch_radius) / 2
        places = [
            self.held_loads(a, cage_speed) if held else self.loads(a, cage_speed)[:2] for a in np.linspace(0, 2 * np.pi / 18, 10, endpoint=False)
        ]
        inner, outer = (np.concatenate([loads[ring] for loads in places]) for ring in (0, 1))
        inner_rating, outer_rating = ring_ratings(30.2e3, 18, 7 / 62.75)
        parts = (inner_rating / np.mean(inner**4) ** (1 / 4)) ** -4.5 + (outer_rating / np.mean(outer**4.5) ** (1 / 4.5)) ** -4.5
        return parts ** (-8 / 9) * 1e6 / (60 * 45000)


def test_a_free_ring_gives_way_to_low_points_that_differ_and_life_hardly_falls():
    # Three low points leave a round ring that moves in the plane nothing to complain of: it moves until they are alike.
    def life(roundness):
        run = Simulation(load_scene("deng2017_table1", ["bearing.outer_raceway.d_value=0.095 mm", f"bearing.outer_raceway.roundness={roundness}"]))
        return run.advance(0.05, samples=50)["rating_life"][25:].mean()

    for roundness in (0.0, 10e-6):
        assert life(roundness) == pytest.approx(Rough(roundness=roundness).life(held=False), rel=0.01)
    assert 0.98 * life(0.0) < life(10e-6) < life(0.0)


@pytest.mark.parametrize(("roundness", "hours"), [(0.0, 389), (4e-6, 380), (6e-6, 370), (10e-6, 343)])
def test_a_ring_held_on_the_load_line_would_lose_the_life_that_another_calculation_found(roundness, hours):
    # life, as Deng 2017, Fig. 22 has it fall with roundness, and as an independent calculation gives it
    assert Rough(roundness=roundness).life(held=True) == pytest.approx(hours, rel=0.015)
