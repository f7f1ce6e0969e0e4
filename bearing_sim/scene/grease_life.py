# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How long a grease serves: the relubrication interval of a cylindrical roller bearing."""

import math
from typing import NamedTuple

from bearing_sim.scene.designation import readable_designation

_TYPE_FACTOR = 5.0  # of cylindrical roller bearings in the empirical interval; 10 of deep groove ball bearings, 1 of spherical roller bearings
_AT = 343.15  # [K] for which the interval holds
_HALVED_BY = 15.0  # K above that, by which it is halved (SKF, Rolling bearings: adjustments of relubrication intervals)
_MOST_GAIN = 2.0  # of a colder bearing (SKF); a full complement gains nothing
_LONGEST = 30_000.0  # h, beyond which SKF advises against any interval
_HALVING_CAGES = ("J", "MA", "MB")  # pressed steel, and brass guided by rings: half the interval (SKF)


class GreaseInterval(NamedTuple):
    """The relubrication interval of a grease, after which 99 of 100 bearings are still lubricated."""

    hours: float  # 0 where the grease does not serve at this speed
    temperature: float  # of the outer ring, for which it holds [K]


def relubrication_interval(scene, speed: float, temperature: float) -> GreaseInterval:
    """Return the interval of a scene's grease: 5 (14e6/(n sqrt(d)) - 4 d) h at 70 degC, n in rpm, d in mm, halved for every 15 K more.

    The formula is that of lubrication handbooks, for a good lithium grease in a stationary machine with a horizontal shaft and little dirt; SKF's
    adjustments for temperature and cages.  *Assumption*: within a factor of 2 of a maker's own diagram.

    Parameters
    ----------
    scene : with a grease.
    speed : of the shaft [rad/s].
    temperature : of the outer ring [K].
    """
    bearing, rpm = scene.bearing, abs(speed) * 30.0 / math.pi
    if rpm == 0.0:
        return GreaseInterval(_LONGEST, temperature)
    bore = 1e3 * bearing.bore_diameter
    at_70 = max(_TYPE_FACTOR * (14e6 / (rpm * math.sqrt(bore)) - 4.0 * bore), 0.0)
    gain = min(2.0 ** ((_AT - temperature) / _HALVED_BY), 1.0 if bearing.cage.is_absent else _MOST_GAIN)
    found = readable_designation(bearing.designation)
    halved = found is not None and found.cage in _HALVING_CAGES
    return GreaseInterval(min(at_70 * gain * (0.5 if halved else 1.0), _LONGEST), temperature)
