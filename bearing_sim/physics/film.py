# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Oil film of a line contact and what follows from it: its thickness and the resistance to rolling.

Symbols: R effective radius of the contact [m], E' = 2/sum((1 - nu^2)/E) reduced modulus [Pa], L length [m], Q load [N], u mean speed of
both surfaces relative to the contact [m/s], du their difference [m/s], eta_0 viscosity at the inlet [Pa s], alpha its pressure coefficient
[1/Pa], beta = -d ln eta_0/dT [1/K], k conductivity [W/(m K)].  Dimensionless: U = eta_0 u/(E' R), G = alpha E', W = Q/(E' R L), S = |du|/u.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.elementary import exponential, logarithm
from bearing_sim.numerics.simd import larger, load, smaller, square_root, store, where_positive
from bearing_sim.physics.contact import CONTACT, LOAD_FLOOR, ROLLING_SPEED_FLOOR


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
# Resistance to rolling, see `resistance_constants`.
_ELASTIC, _ELASTIC_SPEED, _ELASTIC_LOAD = 4.318, 0.658, 0.0126
_RIGID = 1.42
_SHARPNESS = 10.0  # of the passage between both regimes
_MARTIN = 4.9  # Q h/(eta_0 u R L_c) of rigid cylinders that roll in an oil of one viscosity
_INLET_HEAT, _INLET_HEAT_EXPONENT = 0.411483, 0.707071
_LOADED_FROM = 1.0  # N; assumption: a contact that carries less has no film to roll through
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


@kernel
def film_thickness(exponential, law, constants, log_speed, log_load, log_ratio):
    """Return the thickness of a film thinned by its heated inlet, and its changes.

    h = R factor U^speed G^material W^load / [1 + 0.1 (1 + 14.8 S^0.83) L_t^0.64], L_t = eta_0 beta u^2/k.

    The isothermal thickness is that of the `FilmLaw`.  The form of the thermal factor is that of L. E. Murch, W. R. D. Wilson, J. Lubr.
    Technol. 97 (1975) 212, the term in S that of W. R. D. Wilson, S. Sheu, J. Lubr. Technol. 105 (1983) 187, both as secondary literature
    gives them; the originals have not been compared, so take its four numbers for an *assumption*.  Range: fully flooded line contacts in
    the elastic, piezoviscous regime (U 1e-13 to 1e-10, W 1e-5 to 1e-3); starved inlets: `bearing_sim.physics.starvation`.

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


class RollingResistance(NamedTuple):
    """Resistance to rolling of both kinds of contact; see `resistance_constants`."""

    on: int  # whether anything resists
    hydrodynamic: float  # factor on the resistance of the oil that inlets pump back, 0 or 1
    inner: "ResistanceConstants"
    outer: "ResistanceConstants"


class ResistanceConstants(NamedTuple):
    """What the resistance of one contact depends on besides speed and load; logarithms of numbers in SI units."""

    elastic: float  # ln F_E without its powers of u and Q
    rigid: float  # ln F_I likewise
    heating: float  # ln of what multiplies u^(2 x 0.707071) in the thermal factor; -inf without heating
    film: float  # ln h [m] in the middle without its powers of u and Q, see `DOWSON_TOYODA`
    rigid_film: float  # likewise of rigid bodies, 4.9 eta_0 u R L_c/Q (Martin 1916)
    hysteresis: float  # F_R over Q^(3/2) of rolling hysteresis [N^-0.5], see `bearing_sim.physics.mixed`; no logarithm


def resistance_constants(oil, reduced_modulus, curvature_radius, length, heated=True, hysteresis=0.0):
    """Return the `ResistanceConstants` of one contact.

    The oil that the inlet pumps back resists each surface's motion through the contact with

        F_R = s [F_I^-10 + F_E^-10]^(-1/10)/(1 + 0.411483 L^0.707071),   L = eta_0 beta u^2/k_oil,
        F_E = 4.318 E' R L_c (G U)^0.658 W^0.0126/G,   F_I = 1.42 E' R L_c (2 U)^(1/2) W^(1/2),   U = eta_0 u/(E' R), L_c the length,

    and presses the roller's centre along that motion by 2 F_R R/R_w = 2 F_R (1 -/+ gamma), gamma = D_w/d_m.  The contact passes on no net
    force, and loses the power 2 F_R u.  s is what is left of it where little oil flows back (`bearing_sim.physics.starvation`).

    F_E, the elastic and piezoviscous regime, and the factor for the heat of the inlet: P. K. Goksem, R. A. Hargreaves, The effect of viscous shear
    heating on both film thickness and rolling traction in an EHL line contact, J. Lubr. Technol. 100 (1978) 346-352, whose factor is
    multiplied by a power of the load between 0.97 and 1.08 that is left out here.  F_I, the isoviscous and rigid regime, and the passage between
    both: N. Biboulet, L. Houpert, Hydrodynamic force and moment in pure rolling lubricated contacts, part 1: line contacts, Proc. IMechE
    J 224 (2010) 765-775, eq. 32 (twice the force on the centre), 40, 42 and 45 (power).  Their own elastic asymptote, 1.47 E' R L_c (2 U)^(3/4),
    is equal to F_E at 2 U = 1e-11 and 1.2 times as large at 1e-10.  Range of both: 2 U from 6e-13 to 1.6e-10, W from 1.6e-7 to 2.5e-3.

    Parameters
    ----------
    oil : `bearing_sim.model.oil.OilState`.
    reduced_modulus : E' [Pa].
    curvature_radius : effective radius R of the contact [m].
    length : L_c [m].
    heated : whether the inlet heats itself.
    hysteresis : as of `ResistanceConstants`.
    """
    stiffness = reduced_modulus * curvature_radius
    scale, speed, load = math.log(stiffness * length), math.log(oil.viscosity / stiffness), -math.log(stiffness * length)
    material = math.log(oil.pressure_viscosity * reduced_modulus)
    heat = math.log(_INLET_HEAT) + _INLET_HEAT_EXPONENT * math.log(oil.viscosity * oil.temperature_viscosity / oil.conductivity)
    return ResistanceConstants(
        elastic=math.log(_ELASTIC) + scale + _ELASTIC_SPEED * (speed + material) + _ELASTIC_LOAD * load - material,
        rigid=math.log(_RIGID) + scale + 0.5 * (math.log(2.0) + speed + load),
        heating=heat if heated else -math.inf,
        film=film_constants(DOWSON_TOYODA, oil, curvature_radius, reduced_modulus, length).thickness,
        rigid_film=math.log(_MARTIN * oil.viscosity * curvature_radius * length),
        hysteresis=hysteresis,
    )


@kernel
def _partly_loaded(part, gap, log_speed, log_load, ratio, log_less, constants):
    """Return the resistance of a contact that bears on a part of its length, over that of one that bears on all of it, and its exponents.

    The part that bears resists as a shorter contact, a F_R(Q/a).  Beside it the film resists as between rigid bodies, with 4.45 eta_0 u (R/h)^(1/2)
    per length, which is F_I at the load 4.9 eta_0 u R/h that such a film carries (Martin 1916).  Its thickness h there is that in the middle, the
    larger one of Dowson and Toyoda's and Martin's, and the gap.  F_R grows with less than the first power of the load, so that of all contacts with
    one load the one that bears evenly resists most (Jensen's inequality).

    Parameters
    ----------
    part, gap : a, and g [m], see `bearing_sim.physics.profile`.
    log_speed, log_load : ln u [m/s], ln Q [N].
    ratio, log_less : r = (F_I/F_E)^10 of a contact that bears on all of its length, and ln(1 + r)/10.
    constants : `ResistanceConstants`.

    Returns
    -------
    fraction, d_speed, d_load : and d ln(fraction) by ln u and by ln Q with part and gap held.
    """
    speed, load, log_part = 0.5 - _ELASTIC_SPEED, 0.5 - _ELASTIC_LOAD, logarithm(part)
    shorter = ratio * exponential(-_SHARPNESS * load * log_part)  # r at the load Q/a
    rigid_film = exponential(constants.rigid_film + log_speed - log_load)
    elastic_film = exponential(constants.film + DOWSON_TOYODA.speed * log_speed + DOWSON_TOYODA.load * log_load)
    film, stiff = larger(elastic_film, rigid_film), where_positive(elastic_film - rigid_film, 1.0, 0.0)
    inverse = 1.0 / (film + gap)
    bearing = exponential(0.5 * log_part + log_less - logarithm(1.0 + shorter) / _SHARPNESS)
    beside = (1.0 - part) * exponential(log_less) * square_root(rigid_film * inverse)
    both = bearing + beside
    share, inside = 0.5 * film * inverse, where_positive(1.0 - both, 1.0 / both, 0.0)
    elastic, turning = ratio / (1.0 + ratio), ratio / (1.0 + ratio) - shorter / (1.0 + shorter)
    beside_speed = elastic * speed + 0.5 - share * (1.0 + stiff * (DOWSON_TOYODA.speed - 1.0))
    beside_load = elastic * load - 0.5 + share * (1.0 - stiff * (1.0 + DOWSON_TOYODA.load))
    d_speed = inside * (beside * beside_speed + bearing * turning * speed)
    d_load = inside * (beside * beside_load + bearing * turning * load)
    return smaller(both, 1.0), d_speed, d_load


@kernel
def resist_rolling_by_rows(row, contacts, middle, crowned, resistance, films):
    """Write the resistance to rolling F_R of all contacts and its derivatives: of the oil, of skew and of hysteresis.

    As Q/(Q + 1 N) that of the oil fades out where a contact carries next to nothing, and all are smooth through u = 0.

    Parameters
    ----------
    row : rows of ``contacts``: load and rolling go in, resistance, resistance_d_rolling and resistance_d_load come out; constant to the compiler.
    contacts : array with these rows, those with the inner raceway first.
    middle : block where the contacts with the outer raceway begin.
    crowned : whether contacts may bear on a part of their length; then the rows part and gap go in, too, whose
        changes are left out of derivatives.
    resistance : `RollingResistance`.
    films : `bearing_sim.physics.mixed.FilmState`.
    """
    left = resistance.hydrodynamic * films.resistance
    # Short loops: the processor works on several blocks at once.  What they pass on stands where the results come to stand.
    for block in range(contacts.shape[0]):
        rolling = load(contacts, block, row.rolling)
        square = rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR
        store(contacts, block, row.resistance, 0.5 * logarithm(square))
        store(contacts, block, row.resistance_d_load, logarithm(larger(load(contacts, block, row.load), LOAD_FLOOR)))
    for block in range(contacts.shape[0]):
        constants = resistance.inner if block < middle else resistance.outer
        log_speed, log_load = load(contacts, block, row.resistance), load(contacts, block, row.resistance_d_load)
        rigid = constants.rigid + 0.5 * (log_speed + log_load)
        # with r = (F_I/F_E)^10, F = F_I (1 + r)^(-1/10), and its exponents are those of F_E in the proportion r/(1 + r)
        ratio = exponential(_SHARPNESS * (rigid - constants.elastic - _ELASTIC_SPEED * log_speed - _ELASTIC_LOAD * log_load))
        store(contacts, block, row.resistance_d_rolling, ratio)
    for block in range(contacts.shape[0]):
        constants = resistance.inner if block < middle else resistance.outer
        rolling, force = load(contacts, block, row.rolling), larger(load(contacts, block, row.load), 0.0)
        square = rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR
        log_speed, log_load = load(contacts, block, row.resistance), load(contacts, block, row.resistance_d_load)
        rigid, ratio = constants.rigid + 0.5 * (log_speed + log_load), load(contacts, block, row.resistance_d_rolling)
        elastic, log_less = ratio / (1.0 + ratio), logarithm(1.0 + ratio) / _SHARPNESS
        heat = exponential(constants.heating + 2.0 * _INLET_HEAT_EXPONENT * log_speed)
        cooler = 1.0 / (1.0 + heat)
        whole = exponential(rigid - log_less - log_speed) * (cooler * left)
        by_load = 0.5 + (_ELASTIC_LOAD - 0.5) * elastic
        by_speed = 0.5 + (_ELASTIC_SPEED - 0.5) * elastic - 2.0 * _INLET_HEAT_EXPONENT * heat * cooler - 1.0
        if crowned:
            part, gap = load(contacts, block, row.part), load(contacts, block, row.gap)
            fraction, d_speed, d_load = _partly_loaded(part, gap, log_speed, log_load, ratio, log_less, constants)
            whole, by_speed, by_load = whole * fraction, by_speed + d_speed, by_load + d_load
        loaded = 1.0 / (force + _LOADED_FROM)
        strength = whole * (force * loaded)
        store(contacts, block, row.resistance, strength * rolling)
        store(contacts, block, row.resistance_d_load, whole * rolling * loaded * (by_load + _LOADED_FROM * loaded))
        store(contacts, block, row.resistance_d_rolling, strength * (1.0 + by_speed * rolling * rolling / square))
    if films.skew_resistance > 0.0 or resistance.inner.hysteresis > 0.0:
        for block in range(contacts.shape[0]):
            constants = resistance.inner if block < middle else resistance.outer
            rolling, force = load(contacts, block, row.rolling), larger(load(contacts, block, row.load), 0.0)
            inverse = 1.0 / square_root(rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR)
            askew, lossy, forwards = films.skew_resistance, constants.hysteresis * square_root(force), rolling * inverse
            bend = (ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR) * inverse * inverse * inverse
            solid = force * (askew + lossy)
            store(contacts, block, row.resistance, load(contacts, block, row.resistance) + solid * forwards)
            store(contacts, block, row.resistance_d_load, load(contacts, block, row.resistance_d_load) + (askew + 1.5 * lossy) * forwards)
            store(contacts, block, row.resistance_d_rolling, load(contacts, block, row.resistance_d_rolling) + solid * bend)


@kernel
def resist_rolling(contacts, resistance, films, crowned):
    """Write the resistance to rolling F_R of all contacts, rows `CONTACT`, half of them with each raceway; see `resist_rolling_by_rows`."""
    if crowned:
        resist_rolling_by_rows(CONTACT, contacts, contacts.shape[0] // 2, True, resistance, films)
    else:
        resist_rolling_by_rows(CONTACT, contacts, contacts.shape[0] // 2, False, resistance, films)
