# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Starved inlets of line contacts: what is left of film and resistance to rolling where little oil flows back between two rollers.

One number says how starved the contacts of a bearing are: the exponent x of SKF's replenishment factor exp(-x), which is what is left of the
resistance to rolling.  It follows from the supply by SKF's constant alone and is fitted to nothing.  The film follows from it: where the inlet
begins to be full, the gap is S times the least film of a full inlet, and a contact whose inlet begins at S resists by the factor exp(-x)
(N. Biboulet, L. Houpert, Hydrodynamic force and moment in pure rolling lubricated contacts, part 1: line contacts, Proc. IMechE J 224 (2010)
765-775, eq. 44),

    exp(-x) = (S^2 + 162.8 S)/(S^2 + 193.1 S + 1257),

and Grubin's inlet, in which the pressure that solidifies the oil has been built up from the meniscus on, gives

    h/h_full = 1/(1 + 1/(0.75 S)).

*Assumptions*: the inlet's integral beyond S falls as 1/S, with 0.75 for the least over the middle thickness of a full film; x counts up to that of
S = 2, below which eq. 44 was not computed, so that a starved contact resists a fifth of a full one at least.

**Below the minimum load** of the makers a cage may skid, and the safe side of the resistance to rolling is the other one: SKF's factor was
measured on loaded bearings.  There contacts resist as full ones, and have it all from 1.5 times that load on, linearly between (*assumption*).
The kappa of lives is always that of starved contacts.  For the same reason asperities drive no cage there (`bearing_sim.physics.mixed`).
"""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel

_SHAPE = 5.1  # K_Z of cylindrical roller bearings with a cage
_LINEAR, _LINEAR_BELOW, _CONSTANT_BELOW = 162.8, 193.1, 1257.0  # of eq. 44
_LARGEST = math.log(5.0)  # about the x of S = 2
_MEAN_FILM = 0.75
_WHOLE_FROM = 1.5  # of the minimum load


class Starvation(NamedTuple):
    """How starved the contacts of a bearing are."""

    rate: float  # x over speed of the shaft and viscosity, x/(omega nu) [s^2/(rad m^2)]; 0 where inlets are full
    flooded: bool  # whether contacts resist as full ones below the minimum load


class MinimumLoad(NamedTuple):
    """Load below which makers expect slip, see `bearing_sim.scene.ratings.minimum_load_law`."""

    at_rest: float  # [N]
    by_speed: float  # by how much it grows with the speed of the shaft [N s/rad]


def starvation_rate(constant: float, bore_diameter: float, outside_diameter: float) -> float:
    """Return x over the speed of the shaft and the kinematic viscosity [s^2/(rad m^2)].

    x = K_rs nu n (d + D) sqrt(K_Z/(2 (D - d))) [mm^2/s, rpm, mm] with K_Z = 5.1 of cylindrical roller bearings with a cage (SKF, The SKF model for
    calculating the frictional moment).

    Parameters
    ----------
    constant : K_rs; SKF: 3e-8 for oil jet and a low level of a bath, 6e-8 for grease and oil-air, 0 where contacts are flooded.
    bore_diameter, outside_diameter : d and D of the bearing [m].
    """
    root = math.sqrt(_SHAPE / (2e3 * (outside_diameter - bore_diameter)))
    return constant * 1e6 * (30.0 / math.pi) * 1e3 * (bore_diameter + outside_diameter) * root


@kernel
def starved_film(exponent):
    """Return the thickness of a starved film over that of a full one; 1 where the exponent x is 0."""
    left = math.exp(-min(exponent, _LARGEST))
    b, missing = _LINEAR - _LINEAR_BELOW * left, 1.0 - left
    root = math.sqrt(b * b + 4.0 * missing * _CONSTANT_BELOW * left)
    inverse = 2.0 * missing / (root - b) if b < 0.0 else (b + root) / (2.0 * _CONSTANT_BELOW * left)  # 1/S
    return 1.0 / (1.0 + inverse / _MEAN_FILM)


@kernel
def starved_resistance(exponent):
    """Return the resistance to rolling of a starved contact over that of a full one."""
    return math.exp(-min(exponent, _LARGEST))


@kernel
def starvation_exponent(shaft_speed, viscosity, starvation):
    """Return x.

    Parameters
    ----------
    shaft_speed : [rad/s].
    viscosity : kinematic, nu in the films [m^2/s].
    starvation : `Starvation`.
    """
    return starvation.rate * viscosity * abs(shaft_speed)


@kernel
def loaded_fraction(shaft_speed, load, minimum_load):
    """Return how far a bearing counts as loaded: 0 up to the minimum load, 1 from 1.5 times it on, linear between.

    Parameters
    ----------
    shaft_speed : [rad/s].
    load : radial load on the bearing [N].
    minimum_load : `MinimumLoad`.
    """
    least = minimum_load.at_rest + minimum_load.by_speed * abs(shaft_speed)
    return min(max((load - least) / ((_WHOLE_FROM - 1.0) * least), 0.0), 1.0)
