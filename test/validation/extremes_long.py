# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Long runs under constant conditions: what drifts in them, and whether the books of energy close."""

import math
import time
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.studies.extreme_run import energy_gap
from bearing_sim.sweep.settling import cage_turn
from validation.extremes_cases import BEARING

LONG_RUNS = {
    "steady": ((15_000.0, 86_400.0),),
    "slip": ((15_000.0, 600.0),),
    "planar": ((5_000.0, 60.0), (15_000.0, 60.0), (30_000.0, 60.0), (45_000.0, 60.0)),
    "spatial": ((15_000.0, 10.0),),
}
"""Shaft speed [rpm] and simulated time [s] of the long runs, by level."""
_SAMPLES_PER_SECOND, _BLOCK = 200, 100
_WINDOWS = 10  # of the run that are compared
_BOOK_TURNS, _BOOK_SAMPLES = 20.0, 4001  # of the books of energy at the end
_LARGEST = {"shaft_angle_error": 1e-9, "slip_drift": 1e-3, "damage_drift": 0.01, "energy_drift": 0.01, "cage_angle_error": 1e-3, "books": 0.01}


class LongRun(NamedTuple):
    """Results of a long run at constant conditions.

    Each drift compares the last tenth of the run with the second one, after settling: slip in absolute numbers, damage rate and
    power balance relative.  Angles: of the shaft against speed times time, of the cage against its mean sampled speed.  Books: energy
    that the shaft and the load put in, less what is lost and stored, over the former, in twenty cage turns at the end.
    """

    level: str
    speed_rpm: float
    simulated: float = 0.0
    core_seconds: float = 0.0
    real_time_factor: float = math.nan
    steps: int = 0
    rejected_steps: int = 0
    cage_slip: float = math.nan
    slip_drift: float = math.nan
    damage_drift: float = math.nan
    energy_drift: float = math.nan
    shaft_angle_error: float = math.nan
    cage_angle_error: float = math.nan
    books: float = math.nan
    failure: str = ""  # empty if the run was good


def long_run_result(level: str, speed: float, seconds: float) -> dict:
    """Return the fields of `long_run`."""
    return long_run(level, speed, seconds)._asdict()


def long_run(level: str, speed: float, seconds: float) -> LongRun:
    """Make one long run of ``seconds`` of simulated time at a shaft speed [rpm]."""
    simulation = Simulation(load_scene(BEARING, [f"level={level}", f"operating.shaft_speed={speed} rpm"]))
    windows, failure = [], ""
    began = time.process_time()
    for _ in range(_WINDOWS):
        try:
            windows.append(_window(simulation, seconds / _WINDOWS))
        except IntegrationError as error:
            failure = str(error)
            break
    core, counters = time.process_time() - began, simulation.counters
    if failure:
        done = (core, simulation.time / core, counters.steps, counters.rejected_steps)
        return LongRun(level, speed, simulation.time, *done, failure=failure)
    means = np.array(windows)
    early, late, last = means[1], means[-1], simulation.sample.copy()
    slip, damage, surplus = (late - early)[:3] / (1.0, early[1], early[3])
    turned = float(means[:, 4].sum())
    drifts = {
        "slip_drift": float(slip),
        "damage_drift": float(damage),
        "energy_drift": float(surplus),
        "shaft_angle_error": float(last["shaft_angle"] / (speed * math.pi / 30 * seconds) - 1.0),
        "cage_angle_error": float(last["cage_angle"] / turned - 1.0),
        "books": energy_gap(simulation.advance(_BOOK_TURNS * cage_turn(simulation.scene), samples=_BOOK_SAMPLES), simulation)[0],
    }
    beyond = [f"{name} {value:.3g}" for name, value in drifts.items() if not abs(value) <= _LARGEST[name]]
    return LongRun(
        level, speed, float(last["time"]), core, seconds / core, counters.steps, counters.rejected_steps, float(late[0]), **drifts,
        failure=f"drift: {', '.join(beyond)}" if beyond else "",
    )  # fmt: skip


def _window(simulation: Simulation, seconds: float) -> tuple[float, ...]:
    """Advance; return mean slip, damage rate [1/s], input minus losses [W], input [W], and the cage's rotation from its sampled speed [rad]."""
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
