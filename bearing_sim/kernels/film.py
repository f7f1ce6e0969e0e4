# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil film of a line contact and what follows from it: thickness and the resistance to rolling.

U = eta_0 u/(E' R), G = alpha E', W = q/(E' R), all lengths in units of R; u is the mean speed of both surfaces relative to the
contact and q the load per length.
"""

import math
from typing import NamedTuple

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.contact_rows import CONTACT, ROLLING_SPEED_FLOOR
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.lanes import larger, load, store


class Powers(NamedTuple):
    """A thickness H = factor U^speed G^material W^load."""

    factor: float
    speed: float
    material: float
    load: float


DOWSON_HIGGINSON = Powers(2.65, 0.70, 0.54, -0.13)  # least thickness
DOWSON_TOYODA = Powers(3.06, 0.69, 0.56, -0.10)  # in the middle
SHEAR_FACTOR, SHEAR_EXPONENT, HEAT_FACTOR, HEAT_EXPONENT = 14.8, 0.83, 0.1, 0.64
_PUMPED = 0.71
_LOADED_FROM = 1.0  # N; an unloaded roller has no film to pump


class Pumping(NamedTuple):
    """ln F_R of fast contacts less 0.71 ln u, and whether it counts at all."""

    on: int
    inner: float
    outer: float


@kernel
def minimum_film(speed, material, load):
    """Return H_min = 2.65 U^0.70 G^0.54 W^-0.13 (Dowson and Higginson), isothermal.

    Parameters
    ----------
    speed, material, load : U, G, W.
    """
    law = DOWSON_HIGGINSON
    return law.factor * speed**law.speed * material**law.material * load**law.load


@kernel
def central_film(speed, material, load):
    """Return H_c = 3.06 U^0.69 G^0.56 W^-0.10 (Dowson and Toyoda), isothermal.

    Parameters
    ----------
    speed, material, load : U, G, W.
    """
    law = DOWSON_TOYODA
    return law.factor * speed**law.speed * material**law.material * load**law.load


@kernel
def thermal_factor(slide_to_roll, thermal_load):
    """Return the share of the isothermal thickness that heating of the inlet leaves: 1/(1 + 0.1 (1 + 14.8 S^0.83) L_t^0.64).

    Parameters
    ----------
    slide_to_roll : S = |du|/u.
    thermal_load : L_t = eta_0 beta u^2/k, beta the fall of ln eta_0 with temperature [1/K] and k the conductivity [W/(m K)].
    """
    return 1.0 / (1.0 + HEAT_FACTOR * (1.0 + SHEAR_FACTOR * slide_to_roll**SHEAR_EXPONENT) * thermal_load**HEAT_EXPONENT)


def pumping_constant(viscosity, reduced_modulus, curvature_radius, length):
    """Return the constant of `Pumping` of one contact.

    The oil that the inlet pumps back resists with F_R = 0.715 E' R L (eta_0 u/(2 E' R))^0.71 on each surface, against its motion
    through the contact, and presses the roller's centre along that motion by 2 F_R R/R_w = 2 F_R (1 -/+ gamma), which is
    1.43 (1 -/+ gamma) E' R L (...)^0.71; what the contact passes on in all is no force, and the power 2 F_R u.

    Parameters
    ----------
    viscosity : eta_0 [Pa s].
    reduced_modulus : E' [Pa].
    curvature_radius : effective radius R of the contact [m].
    length : L [m].
    """
    stiffness = reduced_modulus * curvature_radius
    return math.log(0.715 * stiffness * length) + _PUMPED * math.log(viscosity / (2 * stiffness))


@kernel
def _pump(contacts, first, end, constant):
    for block in range(first, end):
        rolling, force = load(contacts, block, CONTACT.rolling), larger(load(contacts, block, CONTACT.load), 0.0)
        square = rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR
        whole, share = exponential(constant + 0.5 * (_PUMPED - 1.0) * logarithm(square)), 1.0 / (force + _LOADED_FROM)
        strength = whole * (force * share)
        store(contacts, block, CONTACT.pumping, strength * rolling)
        store(contacts, block, CONTACT.pumping_by_load, whole * rolling * (_LOADED_FROM * share * share))
        store(contacts, block, CONTACT.pumping_by_rolling, strength * (1.0 + (_PUMPED - 1.0) * rolling * rolling / square))


@kernel
def pump(contacts, pumping):
    """Write the pumping resistance of all contacts; it fades out where a contact carries next to nothing.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; load and rolling go in.
    pumping : `Pumping`.
    """
    blocks = contacts.shape[0]
    _pump(contacts, 0, blocks // 2, pumping.inner)
    _pump(contacts, blocks // 2, blocks, pumping.outer)
