# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tangential force of the oil film between roller and raceway, T = mu Q (Deng 2017, eq. 7): four laws of traction.

Q is the normal force [N], u the mean rolling speed of both surfaces relative to the contact, du = raceway less roller the sliding speed
[m/s], T the force on the roller with the sign of du.  Every law is odd in du, bounded, and zero and smooth at du = 0.

**Fitted form.** The laws ``oil_4109``, ``constant`` and ``kragelskii`` read

    mu(s) = (A + B s) exp(-C s) + D = D - (D - B s) exp(-C s),   s = |du|/u,   A = -D,

with B, C and D products of powers of Q and u, so that two logarithms, a root and four exponentials serve a contact where the published form takes
nine powers.  With mu_x = d mu/dx and e_b, e_c, e_d the exponents of one variable x in B, C, D:

    d mu/ds    = [B + C (D - B s)] exp(-C s),
    d mu/d ln x = e_d D (1 - exp(-C s)) + [e_b B + e_c C (D - B s)] s exp(-C s)   with s held;   s itself falls as 1/u.

**Thermal Eyring film** (``eyring``).  Film thickness h by Dowson and Toyoda, thinned by its heated inlet (`bearing_sim.physics.film`);
viscosity eta in the contact by C. J. A. Roelands (thesis, Delft 1966) at the mean Hertz pressure p,

    ln eta = ln eta_0 + (ln eta_0 + 9.67) [(1 + 5.1e-9 p)^Z - 1],   Z = alpha/[5.1e-9 (ln eta_0 + 9.67)] or the oil's own;

shear stress tau = tau_E asinh(eta du_f/(h tau_E)) (H. Eyring's fluid, as K. L. Johnson and J. L. Tevaarwerk, Proc. R. Soc. A 356 (1977) use
it), with eta thinned by the oil's own heat, by tau du h/(12 k) in the mean over the film; mu = Lambda tanh(tau/(Lambda p)), an *assumption*
for how the limiting stress Lambda p is approached.

The surfaces creep elastically, in series with the film: they take 8 tau/(pi E') of the slide-to-roll ratio, Carter's law of the rolling
line contact while little of it slips (F. W. Carter, Proc. R. Soc. A 112 (1926)), and leave du_f = |du| - 8 tau u/(pi E') to the film.
Without creep a film that pressure has solidified would drag with its full strength at any sliding, which no time step could follow.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import exponential, logarithm
from bearing_sim.numerics.simd import highest, larger, load, magnitude, smaller, spread, square_root, store, where_positive
from bearing_sim.physics.contact import CONTACT, LOAD_FLOOR, ROLLING_SPEED_FLOOR
from bearing_sim.physics.film import DOWSON_TOYODA, FilmConstants, film_constants, film_thickness
from bearing_sim.physics.mixed import share_with_asperities

FITTED, KRAGELSKII, EYRING = 0, 1, 2  # what `TractionConstants.law` may be
SPECIAL = 14  # constants of a law that is more than the fitted form
_STATIC, _DECAY, _RISE = 0, 1, 2  # positions of Kragelskii's mu_0, C and the rate of rise in `TractionConstants.special`
_ROELANDS_PRESSURE, _ROELANDS_LOG = 5.1e-9, 9.67  # 1/Pa, and -ln of the viscosity 6.3e-5 Pa s: the pole of Roelands' law
_SMALL_RATIO = 0.01  # assumption: slide-to-roll ratio below which sliding no longer changes the heating of the inlet, for smoothness
_MOST_CORRECTIONS = 12  # of the shear stress; twice as many as any contact was found to need
_LAST_CORRECTION = 1e-4  # relative; it leaves its cube
_LARGEST_EXPONENT = 300.0
_LARGEST_SINH = 1e150  # its square is still a number
_LEAST_SPAN = 0.1  # of ln eta_0 + 9.67: Roelands' law ends where an oil is as thin as 6.3e-5 Pa s


class TractionConstants(NamedTuple):
    """ln D, ln B, ln C of one contact as affine functions of ln Q and ln u (SI), and what a law has besides."""

    scale: float
    log_d: float
    d_load_exponent: float
    d_speed_exponent: float
    log_b: float
    b_load_exponent: float
    b_speed_exponent: float
    log_c: float
    c_load_exponent: float
    c_speed_exponent: float
    law: int
    special: np.ndarray  # shape (SPECIAL,); zeros of a law that is of the fitted form alone


def oil_4109_constants(scale, oil, curvature_radius, reduced_modulus):
    """Return the constants of Wang Yanshuang's fit to traction measured with the Chinese aviation oil 4109 (Deng 2017, ref. 17).

    A = -696 W^-0.163 U^0.577 T^0.308, B = 5.19e6 W^-0.373 U T^0.687, C = 6.826e5 W^-0.170 U^0.578 T^0.373, D = -A;
    W = Q/(E' R^2), U = eta_0 u/(E' R), T = k T_0/(eta_0 u^2), T_0 in kelvin.  The fit stems
    from one oil on a disc machine: its use for another oil by that oil's eta_0 is an *assumption*.

    Parameters
    ----------
    scale : factor on the coefficient of traction.
    oil : `bearing_sim.model.oil.OilState`.
    curvature_radius : effective radius R of the contact [m].
    reduced_modulus : E' [Pa].
    """
    log_w = -math.log(reduced_modulus * curvature_radius**2)
    log_u = math.log(oil.viscosity / (reduced_modulus * curvature_radius))
    log_t = math.log(oil.conductivity * oil.temperature / oil.viscosity)

    def powers(factor, w, u, t):
        return math.log(factor) + w * log_w + u * log_u + t * log_t, w, u - 2 * t

    a, b, c = powers(696.0, -0.163, 0.577, 0.308), powers(5.19e6, -0.373, 1.0, 0.687), powers(6.826e5, -0.170, 0.578, 0.373)
    return TractionConstants(scale, *a, *b, *c, FITTED, np.zeros(SPECIAL))


def constant_constants(scale, b, c, d):
    """Return the constants of the law whose B, C, D do not depend on load and speed.

    A given A other than -D would be a jump at zero sliding; it is taken as -D, which changes mu only where it rises.
    """
    return TractionConstants(scale, _log(d), 0.0, 0.0, _log(b), 0.0, 0.0, _log(c), 0.0, 0.0, FITTED, np.zeros(SPECIAL))


def _log(value):
    return math.log(value) if value > 0 else -600.0  # a factor that is nothing, and no infinity to multiply by zero


def kragelskii_coefficients(mu_0, mu_max, v_max, mu_inf):
    """Return A, B, C, D of mu(v) = (A + B v) exp(-C v) + D (Kragelskii, as Gupta gives it) from four properties of its course.

    A = mu_0 - mu_inf and D = mu_inf; the maximum at v_max asks for (C v_max - 1) exp(C v_max) = (mu_inf - mu_0)/(mu_max - mu_inf).

    Parameters
    ----------
    mu_0 : coefficient without sliding.
    mu_max, v_max : largest coefficient, above mu_0 and mu_inf, and the sliding speed where it is [m/s].
    mu_inf : coefficient at high sliding speed.
    """
    from scipy.special import lambertw

    decay = 1.0 + float(lambertw((mu_inf - mu_0) / (math.e * (mu_max - mu_inf))).real)
    return mu_0 - mu_inf, (mu_max - mu_inf) * decay / v_max * math.exp(decay), decay / v_max, mu_inf


def kragelskii_constants(scale, mu_0, mu_max, v_max, mu_inf, rise_speed):
    """Return the constants of Kragelskii's law, by sliding speed: B and C are those of the form above times u.

    A coefficient mu_0 without sliding would be a jump: it is reached over the sliding speed ``rise_speed`` [m/s].  Other
    parameters as of `kragelskii_coefficients`.
    """
    _, b, c, d = kragelskii_coefficients(mu_0, mu_max, v_max, mu_inf)
    special = np.zeros(SPECIAL)
    special[_STATIC], special[_DECAY], special[_RISE] = mu_0, c, 1.0 / rise_speed
    return TractionConstants(scale, _log(d), 0.0, 0.0, _log(b), 0.0, 1.0, _log(c), 0.0, 1.0, KRAGELSKII if mu_0 > 0 else FITTED, special)


def thermal_eyring_constants(scale, oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio, pressure_index=None):
    """Return the constants of the Eyring film; parameters as of `bearing_sim.physics.traction.eyring_constants`."""
    special = eyring_constants(oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio, pressure_index)
    return TractionConstants(scale, *(0.0,) * 9, EYRING, special)


@fused
def _powers(contacts, first, end, constants):
    """Write D, B, C and exp(-C s) of the contacts in some blocks."""
    for block in range(first, end):
        log_load, log_speed = load(contacts, block, CONTACT.log_load), load(contacts, block, CONTACT.log_speed)
        store(
            contacts, block, CONTACT.d, exponential(constants.log_d + constants.d_load_exponent * log_load + constants.d_speed_exponent * log_speed)
        )
        store(
            contacts, block, CONTACT.b, exponential(constants.log_b + constants.b_load_exponent * log_load + constants.b_speed_exponent * log_speed)
        )
        store(
            contacts, block, CONTACT.c, exponential(constants.log_c + constants.c_load_exponent * log_load + constants.c_speed_exponent * log_speed)
        )


@kernel
def _static(contacts, first, end, scale, special):
    """Add Kragelskii's coefficient without sliding, from where it has risen until it has decayed."""
    static, decay, rise = special[_STATIC], special[_DECAY], special[_RISE]
    for block in range(first, end):
        normal, sliding = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.sliding)
        late, soon = exponential(-decay * magnitude(sliding)), exponential(-rise * magnitude(sliding))
        signed = where_positive(sliding, scale, -scale) * static * (late - soon)
        store(contacts, block, CONTACT.force, load(contacts, block, CONTACT.force) + signed * normal)
        store(contacts, block, CONTACT.d_load, load(contacts, block, CONTACT.d_load) + signed)
        d_sliding = scale * static * normal * (rise * soon - decay * late)
        store(contacts, block, CONTACT.d_sliding, load(contacts, block, CONTACT.d_sliding) + d_sliding)


@fused
def traction(contacts, inner, outer, films):
    """Compute the tangential forces of all contacts, half of them with each raceway; parameters as of `traction_along`."""
    traction_along(contacts, contacts.shape[0] // 2, 1, inner, outer, films)


@kernel
def _take_logarithms(contacts, together):
    """Write ln Q, ln u and 1/u of all contacts; ``together`` as of `traction_along`."""
    # Short loops, here and in the laws: the processor works on several blocks at once where one long chain of operations would make it wait.
    for block in range(contacts.shape[0]):
        store(contacts, block, CONTACT.log_load, logarithm(larger(load(contacts, block, CONTACT.load), LOAD_FLOOR)))
    for first in range(0, contacts.shape[0], together):
        rolling = load(contacts, first, CONTACT.rolling)
        square = rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR
        log_speed, inverse_speed = 0.5 * logarithm(square), 1.0 / square_root(square)
        for block in range(first, first + together):
            store(contacts, block, CONTACT.log_speed, log_speed)
            store(contacts, block, CONTACT.inverse_speed, inverse_speed)


@fused
def traction_along(contacts, middle, together, inner, outer, films):
    """Compute the tangential forces of all contacts, those what asperities add included.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; load, rolling and sliding go in, force and its derivatives come out.
    middle : block where the contacts with the outer raceway begin.
    together : number of blocks that follow each other with one rolling speed.
    inner, outer : `TractionConstants` of the raceways; they differ in the constant factors alone.
    films : `bearing_sim.physics.mixed.FilmState`.
    """
    _film_traction(contacts, middle, together, inner, outer, films.log_film)
    if films.raceway_share > 0.0:
        share_with_asperities(contacts, films)


@fused
def _film_traction(contacts, middle, together, inner, outer, log_film):
    """Compute the tangential forces of the oil in all contacts; parameters as of `traction_along`, ``log_film`` of its films."""
    blocks = contacts.shape[0]
    if inner.law == EYRING:
        _take_logarithms(contacts, together)
        eyring_traction(contacts, 0, middle, inner.scale, log_film, inner.special)
        eyring_traction(contacts, middle, blocks, outer.scale, log_film, outer.special)
        return
    _take_logarithms(contacts, together)  # here and not above: what lies between slows the fitted form by 3 %
    _powers(contacts, 0, middle, inner)
    _powers(contacts, middle, blocks, outer)
    for block in range(blocks):
        ratio = magnitude(load(contacts, block, CONTACT.sliding)) * load(contacts, block, CONTACT.inverse_speed)
        store(contacts, block, CONTACT.decay, exponential(-(load(contacts, block, CONTACT.c) * ratio)))
    for block in range(blocks):
        sliding, inverse_speed, decay = (
            load(contacts, block, CONTACT.sliding),
            load(contacts, block, CONTACT.inverse_speed),
            load(contacts, block, CONTACT.decay),
        )
        d, b, c = load(contacts, block, CONTACT.d), load(contacts, block, CONTACT.b), load(contacts, block, CONTACT.c)
        normal, rolling = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.rolling)
        ratio = magnitude(sliding) * inverse_speed
        rest = d - b * ratio
        d_ratio = (b + c * rest) * decay
        # d, b and c are powers of load and speed: each change is the exponent times the value
        settled, spent = d * (1.0 - decay), ratio * decay
        d_log_speed = inner.d_speed_exponent * settled + (inner.b_speed_exponent * b + inner.c_speed_exponent * c * rest) * spent - ratio * d_ratio
        d_log_load = inner.d_load_exponent * settled + (inner.b_load_exponent * b + inner.c_load_exponent * c * rest) * spent
        coefficient = d - rest * decay
        scale = where_positive(sliding, inner.scale, -inner.scale)
        force = scale * normal
        store(contacts, block, CONTACT.force, force * coefficient)
        store(contacts, block, CONTACT.d_load, scale * (coefficient + d_log_load))
        store(contacts, block, CONTACT.d_sliding, inner.scale * normal * d_ratio * inverse_speed)
        store(contacts, block, CONTACT.d_rolling, force * d_log_speed * rolling * inverse_speed * inverse_speed)
    if inner.law == KRAGELSKII:
        _static(contacts, 0, blocks, inner.scale, inner.special)


class EyringRow(NamedTuple):
    """Positions in `TractionConstants.special` of the Eyring film."""

    film: int = 0  # ln h less its powers of u and Q [m]
    inlet: int = 1  # ln of 0.1 L_t^0.64, less its power of u
    pressure: int = 2  # p over the root of Q [Pa/N^0.5]
    exponent: int = 3  # Roelands' Z
    span: int = 4  # ln eta_0 + 9.67
    fluidity: int = 5  # ln (eta_0/tau_E)
    heating: int = 6  # beta tau_E/(12 k): fall of ln eta_0 by du and h [s/m^2]
    limit: int = 7  # tau_E/Lambda [Pa]
    limiting: int = 8  # Lambda
    creep: int = 9  # 8 tau_E/(pi E'): slide-to-roll ratio that the surfaces take for tau = tau_E


ROW = EyringRow()


def eyring_constants(oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio, pressure_index=None):
    """Return the special constants of one contact, shape (SPECIAL,).

    Parameters
    ----------
    oil : `bearing_sim.model.oil.OilState`.
    curvature_radius : effective radius R [m].
    reduced_modulus : E' [Pa].
    length : L [m].
    eyring_stress : tau_E [Pa].
    limiting_ratio : Lambda, limiting shear stress over pressure.
    pressure_index : Roelands' Z; None: by the oil's alpha, the slope at no pressure, which falls short at the pressure of a contact.
    """
    special, log_viscosity = np.zeros(SPECIAL), math.log(oil.viscosity)
    special[ROW.film], special[ROW.inlet] = film_constants(DOWSON_TOYODA, oil, curvature_radius, reduced_modulus, length)
    special[ROW.pressure] = math.sqrt(math.pi * reduced_modulus / (32 * curvature_radius * length))
    span = max(log_viscosity + _ROELANDS_LOG, _LEAST_SPAN)
    special[ROW.exponent] = oil.pressure_viscosity / (_ROELANDS_PRESSURE * span) if pressure_index is None else pressure_index
    special[ROW.span] = span
    special[ROW.fluidity] = log_viscosity - math.log(eyring_stress)
    special[ROW.heating] = oil.temperature_viscosity * eyring_stress / (12 * oil.conductivity)
    special[ROW.limit] = eyring_stress / limiting_ratio
    special[ROW.limiting] = limiting_ratio
    special[ROW.creep] = 8 * eyring_stress / (math.pi * reduced_modulus)
    return special


class EyringStep(NamedTuple):
    """Rows of a contacts array that hold the steps of the Eyring film; those of the results are free until these are written."""

    film: int = CONTACT.b  # h [m]
    film_by_slide: int = CONTACT.c  # d ln h/d ln |du|
    film_by_speed: int = CONTACT.decay  # d ln h/d ln u
    power: int = CONTACT.d  # P of Roelands' law
    thick: int = CONTACT.d_sliding  # eta/(h tau_E) [s/m]
    heated: int = CONTACT.d_rolling  # k: fall of ln eta by the oil's own heat, over y
    creep: int = CONTACT.d_load  # speed that the surfaces take for tau = tau_E [m/s]
    stress: int = CONTACT.force  # y = tau/tau_E


STEP = EyringStep()


@kernel
def _hyperbolic(y):
    """Return sinh and cosh of lanes from 0 on, sinh to full relative accuracy where it is small."""
    square = y * y
    rising = exponential(smaller(y, _LARGEST_EXPONENT))
    falling = 1.0 / rising
    series = y * (1.0 + square * (1.0 / 6.0) * (1.0 + square * (1.0 / 20.0) * (1.0 + square * (1.0 / 42.0) * (1.0 + square * (1.0 / 72.0)))))
    return where_positive(1.0 - y, series, 0.5 * (rising - falling)), 0.5 * (rising + falling)


@kernel
def eyring_traction(contacts, first, end, scale, log_film, special):
    """Compute the tangential forces of the contacts in some blocks, and their derivatives; equations in the docstring of the module.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; `traction_along` has written ln Q, ln u and 1/u.
    first, end : blocks.
    scale : factor on the coefficient.
    log_film : ln of the film's thickness over that of a full inlet.
    special : see `eyring_constants`.
    """
    _film(contacts, first, end, log_film, special)
    _thicken(contacts, first, end, special)
    _shear(contacts, first, end)
    _limit_stress(contacts, first, end, scale, special)


@kernel
def _film(contacts, first, end, log_film, special):
    """Write the thickness of the films and its changes with ln |du| and ln u."""
    constants = FilmConstants(special[ROW.film] + log_film, special[ROW.inlet])
    for block in range(first, end):
        ratio = load(contacts, block, CONTACT.sliding) * load(contacts, block, CONTACT.inverse_speed)
        square = ratio * ratio + _SMALL_RATIO * _SMALL_RATIO
        log_load, log_speed = load(contacts, block, CONTACT.log_load), load(contacts, block, CONTACT.log_speed)
        film, d_ratio, d_speed = film_thickness(exponential, DOWSON_TOYODA, constants, log_speed, log_load, 0.5 * logarithm(square))
        by_slide = d_ratio * (ratio * ratio / square)
        store(contacts, block, STEP.film, film)
        store(contacts, block, STEP.film_by_slide, by_slide)
        store(contacts, block, STEP.film_by_speed, d_speed - by_slide)


@kernel
def _piled(normal, special):
    """Return 1 + 5.1e-9 p at the mean Hertz pressure p of a normal force [N], and tau_E/(Lambda p)."""
    pressure = special[ROW.pressure] * square_root(larger(normal, LOAD_FLOOR))
    return 1.0 + _ROELANDS_PRESSURE * pressure, special[ROW.limit] / pressure


@kernel
def _thicken(contacts, first, end, special):
    """Write what stands before sinh(y) exp(k y) and y in the speed of the film and that of the surfaces' creep, and k."""
    for block in range(first, end):
        piled, _ = _piled(load(contacts, block, CONTACT.load), special)
        store(contacts, block, STEP.power, exponential(special[ROW.exponent] * logarithm(piled)))
    for block in range(first, end):
        film, power = load(contacts, block, STEP.film), load(contacts, block, STEP.power)
        thick = exponential(special[ROW.fluidity] + special[ROW.span] * (power - 1.0)) / film
        store(contacts, block, STEP.thick, thick)
        store(contacts, block, STEP.heated, special[ROW.heating] * magnitude(load(contacts, block, CONTACT.sliding)) * film * power)
        store(contacts, block, STEP.creep, special[ROW.creep] / load(contacts, block, CONTACT.inverse_speed))


@kernel
def _stretched(y, thick, heated):
    """Return sinh(y), cosh(y) and exp(k y)/thick [m/s]."""
    sinh, cosh = _hyperbolic(y)
    return sinh, cosh, exponential(smaller(heated * y, _LARGEST_EXPONENT)) / thick


@kernel
def _shear(contacts, first, end):
    """Write the root y of sinh(y) exp(k y)/thick + creep y = |du|; return by how many corrections.

    Halley's method, from where Newton's first step in the logarithm ends without creep, or from |du|/creep where that is less.  The left side
    rises ever faster and its first part is log-concave: the denominator of a correction is at least 1/2 above the root and at least 1 below it.
    """
    for block in range(first, end):
        thick, slide = load(contacts, block, STEP.thick), magnitude(load(contacts, block, CONTACT.sliding))
        sinh = smaller(thick * slide, _LARGEST_SINH)
        cosh = square_root(1.0 + sinh * sinh)
        film_alone = logarithm(sinh + cosh) / (1.0 + load(contacts, block, STEP.heated) * sinh / cosh)  # Newton's step from y = 0 in the logarithm
        store(contacts, block, STEP.stress, smaller(film_alone, slide / load(contacts, block, STEP.creep)))
    corrections, left = 0, spread(1.0)
    while highest(left) > 0.0 and corrections < _MOST_CORRECTIONS:
        corrections, left = corrections + 1, spread(0.0)
        for block in range(first, end):
            y, thick, heated = load(contacts, block, STEP.stress), load(contacts, block, STEP.thick), load(contacts, block, STEP.heated)
            creep, slide = load(contacts, block, STEP.creep), magnitude(load(contacts, block, CONTACT.sliding))
            sinh, cosh, opened = _stretched(y, thick, heated)
            slope = 1.0 / ((cosh + heated * sinh) * opened + creep)
            newton = (sinh * opened + creep * y - slide) * slope
            step = newton / (1.0 - 0.5 * newton * ((1.0 + heated * heated) * sinh + 2.0 * heated * cosh) * opened * slope)
            store(contacts, block, STEP.stress, smaller(larger(y - step, 0.0), slide / creep))
            left = larger(left, magnitude(step) - _LAST_CORRECTION * y)
    return corrections


@kernel
def _limit_stress(contacts, first, end, scale, special):
    """Write the tangential forces and their derivatives, from the shear stresses of the films."""
    span, limiting = special[ROW.span], special[ROW.limiting]
    for block in range(first, end):
        normal, rolling, sliding = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.rolling), load(contacts, block, CONTACT.sliding)
        y, creep, power = load(contacts, block, STEP.stress), load(contacts, block, STEP.creep), load(contacts, block, STEP.power)
        inverse_speed = load(contacts, block, CONTACT.inverse_speed)
        heated, thick, slide = load(contacts, block, STEP.heated), load(contacts, block, STEP.thick), magnitude(sliding)
        by_slide, by_speed = load(contacts, block, STEP.film_by_slide), load(contacts, block, STEP.film_by_speed)
        piled, limit = _piled(normal, special)
        power_load = 0.5 * special[ROW.exponent] * (piled - 1.0) / piled
        sinh, cosh, opened = _stretched(y, thick, heated)
        sheared_slide = sinh * opened  # the film's part of |du|
        stiff = 1.0 / ((cosh + heated * sinh) * opened + creep)
        y_slide = stiff * (1.0 - sheared_slide / larger(slide, 1e-300) * (by_slide + heated * y * (1.0 + by_slide)))
        y_speed = -(stiff * (sheared_slide * by_speed * (1.0 + heated * y) + creep * y))
        film_load = DOWSON_TOYODA.load
        y_load = stiff * sheared_slide * (span * power * power_load - film_load - heated * y * (film_load + power_load))
        # limiting shear stress
        fade = exponential(-2.0 * (limit * y))
        level = (1.0 - fade) / (1.0 + fade)
        slope = limiting * (1.0 - level * level) * limit
        sign = where_positive(sliding, scale, -scale)
        store(contacts, block, CONTACT.force, sign * normal * limiting * level)
        store(contacts, block, CONTACT.d_load, sign * (limiting * level + slope * (y_load - 0.5 * y)))
        store(contacts, block, CONTACT.d_sliding, scale * normal * slope * y_slide)
        store(contacts, block, CONTACT.d_rolling, sign * normal * slope * y_speed * rolling * inverse_speed * inverse_speed)
