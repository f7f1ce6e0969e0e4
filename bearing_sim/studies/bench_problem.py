# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the bench measures on: scenes by level, method, speed and number of rollers, and a level's kernels laid bare."""

import functools
import sys
import typing
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numba
import numpy as np

from bearing_sim.levels.inputs import Drive
from bearing_sim.levels.level import LEVELS
from bearing_sim.levels.slip import Model
from bearing_sim.params import lubricate, pack
from bearing_sim.scene import Integration, Scene
from bearing_sim.scene_file import load_scene
from bearing_sim.simulation import Simulation, scene_inputs
from bearing_sim.studies.stock_bearing import BEARING, takes

LOAD = 800.0  # N
STOCK_ROLLERS = 18
FIXED_STEP = "integration.fixed_step=10 us"


class Kernels(NamedTuple):
    """A level's compiled functions by their names there; None where it has none of that name."""

    rhs: Callable | None
    rhs_and_jacobian: Callable | None
    factor: Callable | None
    solve: Callable | None
    error_norm: Callable | None


class Problem(NamedTuple):
    """One level at one condition as a differential equation dy/dt = f(t, y) from y(0) = start on."""

    kernels: Kernels
    model: Model
    work: tuple
    start: np.ndarray  # shape (n,)


def level_kernels(level: str) -> Kernels:
    """Return the kernels that stand beside the level's initial state."""
    module = sys.modules[LEVELS[level].initial_state.__module__]
    return Kernels(*(getattr(module, name, None) for name in Kernels._fields))


def level_methods(level: str) -> dict[str, list[str]]:
    """Return the overrides of a scene for each integration method that a level offers, by name, its own first.

    A method that can keep to a fixed step comes once more with one of 10 us; a level with nothing to choose has one, without a name.
    """
    methods, found = getattr(LEVELS[level], "methods", None), {}
    if methods is None:
        choices = typing.get_args(typing.get_type_hints(Integration)["method"])
        return {name: [] for choice in choices for name in typing.get_args(choice) if takes(level, f"integration.method={name}")} or {"": []}
    for name in methods:
        found[name] = [f"integration.method={name}"]
        if getattr(methods[name], "advance_fixed", None) is not None:
            found[f"{name}, fixed step"] = [*found[name], FIXED_STEP]
    return found


def scaled_scene(level: str, speed_rpm: float, rollers: int = STOCK_ROLLERS, overrides: Sequence[str] = (), tolerance: float | None = None) -> Scene:
    """Return the scene of the bench, with other numbers of rollers scaled.

    The rollers, their spacing, all clearances and both lobes' heights stay.  So the radius of the pitch circle is proportional
    to Z and all other radii move with it; masses of cage, ring and shaft and the load are proportional to Z; the shaft
    speed goes with 1/Z, so that surfaces move as fast and as many rollers pass a point in a second as in the stock bearing.

    Parameters
    ----------
    level : name.
    speed_rpm : shaft speed of the stock bearing that this one is scaled from.
    rollers : Z.
    overrides : further ones, such as those of a method.
    tolerance : relative tolerance of a step; the level's default where absent.
    """
    ratio = rollers / STOCK_ROLLERS
    overrides = [*overrides, f"level={level}", f"operating.shaft_speed={speed_rpm / ratio} rpm", f"operating.radial_load={LOAD * ratio} N"]
    if tolerance is not None:
        overrides.append(f"integration.relative_tolerance={tolerance}")
    if rollers != STOCK_ROLLERS:
        bearing = load_scene(BEARING).bearing
        outward = bearing.pitch_radius * (ratio - 1.0)
        inner, cage = bearing.inner_raceway, bearing.cage
        overrides += [
            f"bearing.roller.count={rollers}",
            f"bearing.inner_raceway.radius={inner.radius + outward}",
            f"bearing.outer_raceway.low_radius={bearing.outer_raceway.low_radius + outward}",
            f"bearing.cage.inner_radius={cage.inner_radius + outward}",
            f"bearing.cage.guide_radius={cage.guide_radius + outward}",
            f"bearing.cage.mass={cage.mass * ratio}",
            f"bearing.inner_raceway.ring_mass={inner.ring_mass * ratio}",
            f"bearing.inner_raceway.supported_mass={inner.supported_mass * ratio}",
        ]
    return load_scene(BEARING, overrides)


def bare_problem(scene: Scene) -> Problem | None:
    """Return a scene's differential equation, or None where its level has no right-hand side."""
    kernels = level_kernels(scene.level)
    if kernels.rhs is None:
        return None
    params, inputs = pack(scene), scene_inputs(scene)
    lubrication = lubricate(scene.lubricant, params, inputs.oil_temperature)
    drive = Drive(0.0, inputs.shaft_speed, 0.0, inputs.load_y, 0.0, inputs.load_z, 0.0)
    model = Model(params, lubrication, drive, float(scene.integration.relative_tolerance))
    return Problem(kernels, model, LEVELS[scene.level].new_work(params), Simulation(scene).state)


def error_share(problem: Problem, state: np.ndarray, reference: np.ndarray) -> float:
    """Return how far a state is off in the level's own measure of error, the one that the relative tolerance bounds in a step."""
    reference = np.ascontiguousarray(reference)  # a column of a course would be another type, and compiled for once more
    return float(_norm(problem.kernels.error_norm)(0.0, reference, state - reference, 1.0, problem.model))


def state_scales(problem: Problem) -> np.ndarray:
    """Return what an error of each state is measured against: the level's own measure, 1 (SI) where it has none, shape (n,)."""
    scales, norm = np.ones_like(problem.start), _norm(problem.kernels.error_norm)
    for i in range(scales.size):
        change = np.zeros_like(problem.start)
        change[i] = 1.0
        share = norm(0.0, problem.start, change, 1.0, problem.model)
        if share > 0.0:
            scales[i] = 1.0 / share
    return scales


@functools.cache
def _norm(error_norm):
    # A template is bound in a kernel here as anywhere else.
    return numba.njit(error_model="numpy")(lambda t, y, change, tolerance, model: error_norm(t, y, change, tolerance, model))
