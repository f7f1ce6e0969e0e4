# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Long runs without a stop: what drifts?"""

import math
import time
from typing import NamedTuple

import numpy as np

from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.studies.stock_bearing import BEARING

# Simulated seconds at 15,000 rpm; a level that is not named runs as long as the cheapest.
_SECONDS = {"slip": 1000.0, "planar": 100.0, "spatial": 10.0}
_SPEED = 15_000.0  # rpm
_SAMPLES_PER_SECOND, _BLOCK = 200, 100
_WINDOWS = 10  # of the run that are compared
_LARGEST_DRIFT = {"shaft_angle_error": 1e-9, "slip_drift": 1e-3, "damage_drift": 0.01, "energy_drift": 0.01, "cage_angle_error": 1e-3}


class LongRun(NamedTuple):
    """What a long run at constant conditions did.

    Each drift is the last tenth of the run against its second one, after settling: slip in absolute numbers, damage per time and
    losses less input relative.  Angles: the shaft's against speed times time, the cage's against the mean of its sampled speed.
    """

    level: str
    speed_rpm: float
    simulated: float
    core_seconds: float
    real_time_factor: float
    steps: int
    rejected_steps: int
    cage_slip: float
    slip_drift: float
    damage_drift: float
    energy_drift: float
    shaft_angle_error: float
    cage_angle_error: float
    fault: str


def long_runs(level: str) -> list[tuple[str, float]]:
    """Return level and simulated seconds of the long runs of a level."""
    return [(level, _SECONDS.get(level, max(_SECONDS.values())))]


def long_run(run: tuple[str, float]) -> LongRun:
    """Run one.

    Parameters
    ----------
    run : level and simulated seconds.
    """
    level, seconds = run
    simulation = Simulation(load_scene(BEARING, [f"level={level}", f"operating.shaft_speed={_SPEED} rpm"]))
    windows, fault = [], ""
    began = time.process_time()
    for _ in range(_WINDOWS):
        try:
            windows.append(_window(simulation, seconds / _WINDOWS))
        except IntegrationError as error:
            fault = str(error)
            break
    core, counters = time.process_time() - began, simulation.counters
    if fault:
        nothing = (math.nan,) * 6
        done = (core, simulation.time / core, counters.steps, counters.rejected_steps)
        return LongRun(level, _SPEED, simulation.time, *done, *nothing, fault)
    means = np.array(windows)
    early, late, last = means[1], means[-1], simulation.sample
    slip, damage, surplus = (late - early)[:3] / (1.0, early[1], early[3])
    turned = float(means[:, 4].sum())
    drifts = {
        "slip_drift": float(slip),
        "damage_drift": float(damage),
        "energy_drift": float(surplus),
        "shaft_angle_error": float(last["shaft_angle"] / (_SPEED * math.pi / 30 * seconds) - 1.0),
        "cage_angle_error": float(last["cage_angle"] / turned - 1.0),
    }
    beyond = [f"{name} {value:.3g}" for name, value in drifts.items() if not abs(value) <= _LARGEST_DRIFT[name]]
    return LongRun(
        level, _SPEED, simulation.time, core, seconds / core, counters.steps, counters.rejected_steps, float(late[0]), **drifts,
        fault=f"drift: {', '.join(beyond)}" if beyond else "",
    )  # fmt: skip


def _window(simulation: Simulation, seconds: float) -> tuple[float, ...]:
    """Advance and return mean slip, damage [1/s], input less losses [W], input [W], and the cage's turn by its sampled speed [rad]."""
    samples = round(seconds * _SAMPLES_PER_SECOND)
    damage, slip, surplus, shaft, turn = float(simulation.sample["damage"]), 0.0, 0.0, 0.0, 0.0
    for first in range(0, samples, _BLOCK):
        count = min(_BLOCK, samples - first)
        block = simulation.advance(count / _SAMPLES_PER_SECOND, samples=count)
        losses = sum(block[name] for name in block.dtype.names if name.endswith("_power") and name != "shaft_power")
        slip += float(block["cage_slip"].sum()) / samples
        shaft += float(block["shaft_power"].sum()) / samples
        surplus += float((block["shaft_power"] - losses).sum()) / samples
        turn += float(block["cage_speed"].sum()) / _SAMPLES_PER_SECOND
    return slip, (float(simulation.sample["damage"]) - damage) / seconds, surplus, shaft, turn
