# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil film of a line contact and what follows from it: its thickness and the resistance to rolling.

Symbols: R effective radius of the contact [m], E' = 2/sum((1 - nu^2)/E) reduced modulus [Pa], L length [m], Q load [N], u mean speed of
both surfaces relative to the contact [m/s], du their difference [m/s], eta_0 viscosity at the inlet [Pa s], alpha its pressure coefficient
[1/Pa], beta = -d ln eta_0/dT [1/K], k conductivity [W/(m K)].  Dimensionless: U = eta_0 u/(E' R), G = alpha E', W = Q/(E' R L), S = |du|/u.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel, template
from bearing_sim.numerics.elementary import exponential, logarithm
from bearing_sim.numerics.simd import larger, load, store
from bearing_sim.physics.contact import CONTACT, ROLLING_SPEED_FLOOR


class FilmLaw(NamedTuple):
    """An isothermal thickness H = h/R = factor U^speed G^material W^load."""

    factor: float
    speed: float
    material: float
    load: float


# Least thickness: D. Dowson, G. R. Higginson, Elasto-Hydrodynamic Lubrication, Pergamon 1966 and its second edition of 1977.
DOWSON_HIGGINSON = FilmLaw(2.65, 0.70, 0.54, -0.13)
# Thickness in the middle: D. Dowson, A. Toyoda, A central film thickness formula for elastohydrodynamic line contacts, Proc. 5th
# Leeds-Lyon Symposium on Tribology, 1978.
DOWSON_TOYODA = FilmLaw(3.06, 0.69, 0.56, -0.10)
# Heating of the inlet, see `film_thickness`.
_HEAT_FACTOR, _HEAT_EXPONENT, _SHEAR_FACTOR, _SHEAR_EXPONENT = 0.1, 0.64, 14.8, 0.83
_PUMPED = 0.71  # exponent of the pumping resistance, see `pumping_constant`
_LOADED_FROM = 1.0  # N; assumption: a contact that carries less has no film to pump
_LEAST_RATIO = 1e-30  # of sliding to rolling speed, for its logarithm


class FilmConstants(NamedTuple):
    """What a film depends on besides speeds and load."""

    thickness: float  # ln h [m], without its powers of u and Q
    inlet: float  # ln(0.1 L_t^0.64), without its power of u


def film_constants(law, oil, curvature_radius, reduced_modulus, length):
    """Return the `FilmConstants` of one contact.

    Parameters
    ----------
    law : `FilmLaw`.
    oil : `bearing_sim.model.oil.OilState`.
    curvature_radius : R [m].
    reduced_modulus : E' [Pa].
    length : L [m].
    """
    stiffness = reduced_modulus * curvature_radius
    thickness = (
        math.log(law.factor * curvature_radius)
        + law.speed * (math.log(oil.viscosity) - math.log(stiffness))
        + law.material * math.log(oil.pressure_viscosity * reduced_modulus)
        - law.load * math.log(stiffness * length)
    )
    inlet = math.log(_HEAT_FACTOR) + _HEAT_EXPONENT * math.log(oil.viscosity * oil.temperature_viscosity / oil.conductivity)
    return FilmConstants(thickness, inlet)


@template
def film_thickness(exponential, law, constants, log_speed, log_load, log_ratio):
    """Return the thickness of a film thinned by its heated inlet, and its changes.

    h = R factor U^speed G^material W^load / [1 + 0.1 (1 + 14.8 S^0.83) L_t^0.64], L_t = eta_0 beta u^2/k.

    The isothermal thickness is that of the `FilmLaw`.  The form of the thermal factor is that of L. E. Murch, W. R. D. Wilson, J. Lubr.
    Technol. 97 (1975) 212, the term in S that of W. R. D. Wilson, S. Sheu, J. Lubr. Technol. 105 (1983) 187, both as secondary literature
    gives them; the originals have not been compared, so take its four numbers for an *assumption*.  Range: fully flooded line contacts in
    the elastic, piezoviscous regime (U 1e-13 to 1e-10, W 1e-5 to 1e-3); a starved inlet is not modelled.

    Parameters
    ----------
    exponential : function of a number, of lanes or of an array, as the arguments are.
    law, constants : `FilmLaw`, and `film_constants` of it.
    log_speed, log_load : ln u [m/s] and ln Q [N].
    log_ratio : ln S.

    Returns
    -------
    thickness : h [m].
    d_ratio : d ln h/d ln S.
    d_speed : d ln h/d ln u with S held.
    """
    inlet = exponential(constants.inlet + 2.0 * _HEAT_EXPONENT * log_speed)
    sheared = _SHEAR_FACTOR * exponential(_SHEAR_EXPONENT * log_ratio)
    left = 1.0 / (1.0 + inlet * (1.0 + sheared))
    thickness = exponential(constants.thickness + law.speed * log_speed + law.load * log_load) * left
    return thickness, -_SHEAR_EXPONENT * inlet * sheared * left, law.speed - 2.0 * _HEAT_EXPONENT * inlet * (1.0 + sheared) * left


def films(law, oil, curvature_radius, reduced_modulus, length, load, rolling, sliding):
    """Return the film thicknesses of many contacts of one kind [m], by `film_thickness`, in NumPy.

    Parameters
    ----------
    law, oil, curvature_radius, reduced_modulus, length : as of `film_constants`.
    load : Q [N], positive.
    rolling : u [m/s], positive.
    sliding : du [m/s]; these three of one shape.
    """
    uncompiled = getattr(film_thickness, "py_func", film_thickness)
    ratio = np.maximum(np.abs(sliding) / rolling, _LEAST_RATIO)
    constants = film_constants(law, oil, curvature_radius, reduced_modulus, length)
    return uncompiled(np.exp, law, constants, np.log(rolling), np.log(load), np.log(ratio))[0]


class Pumping(NamedTuple):
    """ln F_R of fast contacts less 0.71 ln u, and whether it counts at all."""

    on: int
    inner: float
    outer: float


def pumping_constant(viscosity, reduced_modulus, curvature_radius, length):
    """Return the constant of `Pumping` of one contact.

    The oil that the inlet pumps back resists each surface's motion through the contact with

        F_R = 0.715 E' R L (eta_0 u/(2 E' R))^0.71,

    and presses the roller's centre along that motion by 2 F_R R/R_w = 2 F_R (1 -/+ gamma), gamma = D_w/d_m, which is
    1.43 (1 -/+ gamma) E' R L (...)^0.71.  The contact passes on no net force, and loses the power 2 F_R u.  *Assumption*: the two numbers
    are common in dynamic models of roller bearings; their first source has not been found.  Fully flooded, isothermal.

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
        whole, fraction = exponential(constant + 0.5 * (_PUMPED - 1.0) * logarithm(square)), 1.0 / (force + _LOADED_FROM)
        strength = whole * (force * fraction)
        store(contacts, block, CONTACT.pumping, strength * rolling)
        store(contacts, block, CONTACT.pumping_d_load, whole * rolling * (_LOADED_FROM * fraction * fraction))
        store(contacts, block, CONTACT.pumping_d_rolling, strength * (1.0 + (_PUMPED - 1.0) * rolling * rolling / square))


@kernel
def pump(contacts, pumping):
    """Write the pumping resistance F_R of all contacts and its derivatives.

    As Q/(Q + 1 N) it fades out where a contact carries next to nothing, and it is smooth through u = 0.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; load and rolling go in.
    pumping : `Pumping`.
    """
    blocks = contacts.shape[0]
    _pump(contacts, 0, blocks // 2, pumping.inner)
    _pump(contacts, blocks // 2, blocks, pumping.outer)
