# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Check of level ``steady``: its solver against settled runs of level ``slip`` at random operating points."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.levels.steady.table_builder import solve_scene
from bearing_sim.model.params import pack
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation

_TIGHTER = 0.1  # times the scene's tolerances in the settled run; the default ones give slip to 0.02 points
_SPEEDS, _LOADS, _TEMPERATURES = (2000.0, 55_000.0), (10.0, 10_000.0), (313.15, 473.15)  # rpm, N, K
_SETTLED = 2e-5  # between the means of two windows
_WINDOWS = 40


class Compared(NamedTuple):
    """One operating point by both methods."""

    speed_rpm: float
    load: float  # [N]
    load_angle_deg: float
    oil_temperature_c: float
    marched_slip: float
    solved_slip: float
    marched_life: float  # [h]
    solved_life: float  # [h]

    @property
    def agrees(self) -> bool:
        """Whether slips agree within 2 % or 0.05 points, and lives within 2 %."""
        off = abs(self.solved_slip - self.marched_slip)
        return off <= max(0.02 * abs(self.marched_slip), 5e-4) and abs(self.solved_life / self.marched_life - 1.0) <= 0.02


def marched(scene: Scene, inputs: Inputs, lag: float) -> tuple[float, float]:
    """Return mean slip and life [h] of level slip, run from ideal rolling until two windows agree.

    Parameters
    ----------
    scene : its level is replaced, its tolerances tightened.
    inputs : held constant.
    lag : time constant of the cage [s], from which the length of the windows follows.
    """
    run = Simulation(replace(scene, level="slip", integration=scene.integration.with_tolerances(_TIGHTER)), inputs)
    run.advance(8 * lag + 0.02)
    before = math.nan
    for _ in range(_WINDOWS):
        block = run.advance(max(0.05, 2 * lag), samples=500)
        mean = float(block["cage_slip"].mean())
        if abs(mean - before) < _SETTLED:
            break
        before = mean
    return mean, float(block["rating_life"].mean())


def solved(scene: Scene, inputs: Inputs) -> tuple[float, float, float]:
    """Return slip, life [h] and lag [s] of an operating point from the solver of level steady."""
    load, angle = math.hypot(inputs.load_y, inputs.load_z), math.atan2(inputs.load_z, inputs.load_y)
    answer = solve_scene(scene, inputs.shaft_speed, load, inputs.oil_temperature, angle)
    loads = float(answer[ANSWER.inner_equivalent_load]), float(answer[ANSWER.outer_equivalent_load])
    life = rating_life_revolutions(*loads, pack(scene).life) * 2 * math.pi / (3600 * abs(inputs.shaft_speed))
    return float(answer[ANSWER.cage_slip]), float(life), float(answer[ANSWER.lag])


def compare(scene: Scene, count: int, seed: int) -> Iterator[Compared]:
    """Yield comparisons at random operating points: uniform in speed (both directions), temperature, load angle and logarithm of the load."""
    random = np.random.default_rng(seed)
    for _ in range(count):
        rpm, kelvin = random.uniform(*_SPEEDS) * random.choice([-1.0, 1.0]), random.uniform(*_TEMPERATURES)
        load, angle = math.exp(random.uniform(*np.log(_LOADS))), random.uniform(-math.pi, math.pi)
        inputs = Inputs(rpm * math.pi / 30, load * math.cos(angle), load * math.sin(angle), kelvin)
        slip, life, lag = solved(scene, inputs)
        marched_slip, marched_life = marched(scene, inputs, lag if math.isfinite(lag) else 0.1)
        yield Compared(rpm, load, math.degrees(angle), kelvin - 273.15, marched_slip, slip, marched_life, life)
