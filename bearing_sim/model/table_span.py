# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a table of operating points of level ``steady`` spans: speeds, loads, temperatures, and how far the inner raceway grows."""

import math
from dataclasses import replace
from typing import NamedTuple

from bearing_sim.model.running_clearance import mounted
from bearing_sim.physics.growth import Temperatures, excess_growth, growth_at
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene

_LOAD_FRACTION = 0.5  # of the dynamic load rating: what ISO/TS 16281 is for
_SPEED_FRACTION = 1.2  # of the operating speed
HEADROOM = 1.02
"""Highest speed of a table over that of the course that it is for."""
_ROUNDED = 5.0  # K, to which oil temperatures are


class Span(NamedTuple):
    """What a table spans."""

    maximum_speed: float  # [rad/s]
    maximum_load: float  # [N]
    minimum_temperature: float  # [K]
    maximum_temperature: float  # [K]
    reverse: bool  # whether reverse rotation is wanted, too
    minimum_growth: float = 0.0  # of the inner raceway beyond that of a bearing of one temperature [m]
    maximum_growth: float = 0.0


def span_of(scene: Scene, temperatures: tuple[float, float] | None = None) -> Span:
    """Return what the table of a scene spans.

    Parameters
    ----------
    scene : its block ``table`` says it, or leaves it to operating speed and load rating.
    temperatures : lowest and highest oil temperature [K], instead of the scene's.
    """
    wanted, bearing, limits = scene.table, scene.bearing, scene.accepted_inputs
    speed = wanted.maximum_speed or min(_SPEED_FRACTION * abs(scene.operating.shaft_speed) or limits.maximum_speed, limits.maximum_speed)
    low, high = temperatures or (wanted.minimum_temperature, wanted.maximum_temperature)
    if scene.heat.law != "none":  # its films are warmer than the oil that comes in
        low, high = min(low, wanted.minimum_temperature), max(high, wanted.maximum_temperature)
    reverse = limits.reverse_rotation or scene.operating.shaft_speed < 0.0
    return Span(
        float(speed), float(wanted.maximum_load or _LOAD_FRACTION * rate(bearing).dynamic), float(low), float(high), bool(reverse), *_growths(scene)
    )


def _growths(scene: Scene) -> tuple[float, float]:
    """Return the least and the largest growth that a table covers [m]: by the differences of temperature that the scene names."""
    if scene.heat.law == "none" or scene.bearing.dimensions_at == "running":
        return 0.0, 0.0
    parts, ends = mounted(scene.bearing, scene.mounting), []
    for warmer in (scene.table.minimum_difference, scene.table.maximum_difference):
        middle = parts.expansion.reference
        solids = Temperatures(middle + warmer, middle + warmer, middle + 0.5 * warmer, middle, middle)
        ends.append(float(excess_growth(0.0, middle, growth_at(parts, solids), parts)))
    return min(ends), max(ends)


def spanning(scene: Scene, fastest: float) -> Scene:
    """Return a scene whose table covers a shaft speed [rad/s], unless its block ``table`` says up to which it goes."""
    if scene.table.maximum_speed is not None or fastest <= span_of(scene).maximum_speed:
        return scene
    return replace(scene, table=replace(scene.table, maximum_speed=HEADROOM * fastest))


def rounded_temperatures(low: float, high: float) -> tuple[float, float]:
    """Return between which oil temperatures a table is [K], from the lowest and highest of a course; rounded, so that courses share tables."""
    return (low, high) if low == high else (_ROUNDED * math.floor(low / _ROUNDED), _ROUNDED * math.ceil(high / _ROUNDED))
