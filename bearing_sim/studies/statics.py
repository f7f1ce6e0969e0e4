# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Statics of a scene: how the load spreads over rollers and slices at its constant conditions, and the lives that follow."""

import dataclasses
import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.slice_balance import about_yz, balance, leaning, roller_loads, roller_tilts
from bearing_sim.params import lubricate, pack
from bearing_sim.rating_life import (
    ROTATING_EXPONENT,
    STATIONARY_EXPONENT,
    add_slice_powers,
    contamination_factor,
    lamina_life_revolutions,
    modified_life_revolutions,
    rating_life_revolutions,
    stress_risers,
    viscosity_ratio,
)
from bearing_sim.scene import Scene

_PITCH_POSITIONS = 10  # cage angles over one roller pitch for the lives


class Statics(NamedTuple):
    """A scene in quasi-static balance, roller 0 on the load line; lengths along a roller count from its middle."""

    azimuths: np.ndarray  # of the rollers [rad], shape (Z,)
    inner: np.ndarray  # loads on the inner raceway [N], shape (Z,)
    outer: np.ndarray
    tilts: np.ndarray  # of the rollers, leaning the +x end outwards [rad], shape (Z,)
    places: np.ndarray  # slice middles [m], shape (N,)
    inner_slices: np.ndarray  # loads of the slices [N], shape (Z, N)
    outer_slices: np.ndarray
    inner_pressure: float  # largest Hertzian pressure on the inner raceway [Pa]
    outer_pressure: float
    ring: tuple[float, float]  # displacement y, z of the inner ring [m]
    tilt: tuple[float, float]  # of the inner ring: amount, and azimuth to which its +x end leans [rad]
    moment: tuple[float, float]  # on the inner ring: amount [N m], and azimuth to which it leans the +x end [rad]
    equivalent_loads: tuple[float, float]  # Q_ei, Q_ee [N], over one roller pitch
    rating_life: float  # L10 [h]; infinite at rest
    lamina_life: float  # L10r by slices with stress risers [h]
    modified_life: float  # L_nm by the scene's block `life` [h]
    viscosity_ratio: float  # kappa
    contamination_factor: float  # e_C; NaN where the scene names no cleanliness


def statics(scene: Scene, slices: int) -> Statics:
    """Return the statics of a scene at its constant conditions, the cage without slip.

    Parameters
    ----------
    scene : of any level.
    slices : into how many a roller is cut, instead of the scene's number.

    Raises
    ------
    ArithmeticError
        No balance was found.
    """
    roller = dataclasses.replace(scene.bearing.roller, slices=slices)
    scene = dataclasses.replace(scene, bearing=dataclasses.replace(scene.bearing, roller=roller))
    params, operating = pack(scene), scene.operating
    count, raceways, life = params.rollers.count, params.raceways, params.life
    cage_speed = 0.5 * operating.shaft_speed * (1.0 - raceways.diameter_ratio)
    load = (operating.radial_load * math.cos(operating.load_angle), operating.radial_load * math.sin(operating.load_angle))
    moment = about_yz(operating.moment or 0.0, operating.moment_angle)
    tilts = about_yz(operating.misalignment, operating.misalignment_angle) if operating.moment is None else None

    lubrication = lubricate(scene.lubricant, params, scene.lubricant.temperature)
    growth = lubrication.ring_growth + params.growth.by_square_speed * operating.shaft_speed**2

    inner_means, outer_means, risers = np.zeros(slices), np.zeros(slices), stress_risers(slices)
    rotating, stationary, at = 0.0, 0.0, None
    for position in reversed(range(_PITCH_POSITIONS)):  # the last one has roller 0 on the load line
        angle = operating.load_angle + 2 * math.pi * position / (_PITCH_POSITIONS * count)
        at = balance(params, angle, cage_speed, load, moment, tilts, at, growth)
        inner, outer = roller_loads(at)
        rotating += np.mean(inner**ROTATING_EXPONENT) / _PITCH_POSITIONS
        stationary += np.mean(outer**STATIONARY_EXPONENT) / _PITCH_POSITIONS
        add_slice_powers(at.inner, at.outer, risers, 1.0 / (_PITCH_POSITIONS - position), inner_means, outer_means)

    equivalent = float(rotating ** (1 / ROTATING_EXPONENT)), float(stationary ** (1 / STATIONARY_EXPONENT))
    whole, sliced = rating_life_revolutions(*equivalent, life), lamina_life_revolutions(inner_means, outer_means, life)
    pitch, speed = 2 * raceways.pitch_radius, abs(operating.shaft_speed)
    kappa = viscosity_ratio(lubrication.kinematic_viscosity, speed, pitch)
    hours = 2 * math.pi / (3600 * speed) if speed > 0.0 else math.inf
    width = params.rollers.length / slices
    return Statics(
        azimuths=operating.load_angle + 2 * math.pi * np.arange(count) / count,
        inner=inner,
        outer=outer,
        tilts=roller_tilts(at),
        places=at.place * at.half_length,
        inner_slices=at.inner.copy(),
        outer_slices=at.outer.copy(),
        inner_pressure=_pressure(at.inner.max() / width, raceways.inner_curvature_radius, raceways.reduced_modulus),
        outer_pressure=_pressure(at.outer.max() / width, raceways.outer_curvature_radius, raceways.reduced_modulus),
        ring=(float(at.ring[0]), float(at.ring[1])),
        tilt=leaning(float(at.ring[2]), float(at.ring[3])),
        moment=leaning(float(at.reaction[2]), float(at.reaction[3])),
        equivalent_loads=equivalent,
        rating_life=hours * whole,
        lamina_life=hours * sliced,
        modified_life=hours * modified_life_revolutions(sliced if life.lamina else whole, speed, lubrication.kinematic_viscosity, pitch, life),
        viscosity_ratio=kappa,
        contamination_factor=contamination_factor(kappa, life.cleanliness_slope, life.cleanliness_loss, pitch) if life.modified else math.nan,
    )


def _pressure(line_load, curvature_radius, reduced_modulus) -> float:
    """Return Hertz's largest pressure of a line contact [Pa]: sqrt(q E'/(2 pi R)), q the load per length [N/m]."""
    return float(math.sqrt(line_load * reduced_modulus / (2 * math.pi * curvature_radius)))
