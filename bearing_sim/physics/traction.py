# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Tangential force of the oil film between roller and raceway (Deng 2017, eq. 7).

Every law here is odd in the sliding speed and zero without sliding.  All but one are written in one form,

    mu(s) = D - (D - B s) exp(-C s),   s = |du| / u,

with B, C and D products of powers of load and rolling speed.  Two logarithms and four exponentials then
serve a contact, where the published form takes nine powers.  The Eyring film is in `bearing_sim.kernels.eyring`.
"""

import math

import numpy as np

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.contact_rows import CONTACT, EYRING, FITTED, KRAGELSKII, LOAD_FLOOR, ROLLING_SPEED_FLOOR, SPECIAL, TractionConstants
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.eyring import eyring_constants, eyring_traction
from bearing_sim.kernels.lanes import larger, load, magnitude, store, where_positive

_STATIC, _DECAY, _RISE = 0, 1, 2  # places of Kragelskii's mu_0, C and the rate of rise in `TractionConstants.special`


def oil_4109_constants(scale, oil, curvature_radius, reduced_modulus):
    """Return the constants of Wang Yanshuang's fit for the 4109 aviation oil (Deng 2017, ref. 17).

    A = -696 W^-0.163 U^0.577 T^0.308, B = 5.19e6 W^-0.373 U T^0.687, C = 6.826e5 W^-0.170 U^0.578 T^0.373, D = -A;
    W = Q/(E' R^2), U = eta_0 u/(E' R), T = k T_0/(eta_0 u^2).

    Parameters
    ----------
    scale : factor on the coefficient of traction.
    oil : `bearing_sim.oil.OilState`.
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


def thermal_eyring_constants(scale, oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio):
    """Return the constants of the Eyring film; parameters as of `bearing_sim.kernels.eyring.eyring_constants`."""
    special = eyring_constants(oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio)
    return TractionConstants(scale, *(0.0,) * 9, EYRING, special)


@kernel
def _powers(contacts, first, end, constants):
    """Write D, B, C and exp(-C s) of the contacts in some blocks."""
    for block in range(first, end):
        log_load, log_speed = load(contacts, block, CONTACT.log_load), load(contacts, block, CONTACT.log_speed)
        store(contacts, block, CONTACT.d, exponential(constants.d_constant + constants.d_load * log_load + constants.d_speed * log_speed))
        store(contacts, block, CONTACT.b, exponential(constants.b_constant + constants.b_load * log_load + constants.b_speed * log_speed))
        store(contacts, block, CONTACT.c, exponential(constants.c_constant + constants.c_load * log_load + constants.c_speed * log_speed))


@kernel
def _static(contacts, first, end, scale, special):
    """Add Kragelskii's coefficient without sliding, from where it has risen until it has decayed."""
    static, decay, rise = special[_STATIC], special[_DECAY], special[_RISE]
    for block in range(first, end):
        normal, sliding = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.sliding)
        late, soon = exponential(-decay * magnitude(sliding)), exponential(-rise * magnitude(sliding))
        signed = where_positive(sliding, scale, -scale) * static * (late - soon)
        store(contacts, block, CONTACT.force, load(contacts, block, CONTACT.force) + signed * normal)
        store(contacts, block, CONTACT.by_load, load(contacts, block, CONTACT.by_load) + signed)
        by_sliding = scale * static * normal * (rise * soon - decay * late)
        store(contacts, block, CONTACT.by_sliding, load(contacts, block, CONTACT.by_sliding) + by_sliding)


@kernel
def traction(contacts, inner, outer):
    """Compute the tangential forces of all contacts.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; load, rolling and sliding go in, force and its slopes come out.
    inner, outer : `TractionConstants` of the raceways; they differ in the constant factors alone.
    """
    blocks = contacts.shape[0]
    if inner.law == EYRING:
        eyring_traction(contacts, 0, blocks // 2, inner.scale, inner.special)
        eyring_traction(contacts, blocks // 2, blocks, outer.scale, outer.special)
        return
    # Short loops: the processor works on several blocks at once where one long chain of operations would make it wait.
    for block in range(blocks):
        store(contacts, block, CONTACT.log_load, logarithm(larger(load(contacts, block, CONTACT.load), LOAD_FLOOR)))
    for block in range(blocks):
        rolling = load(contacts, block, CONTACT.rolling)
        log_speed = 0.5 * logarithm(rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR)
        store(contacts, block, CONTACT.log_speed, log_speed)
        store(contacts, block, CONTACT.inverse_speed, exponential(-log_speed))
    _powers(contacts, 0, blocks // 2, inner)
    _powers(contacts, blocks // 2, blocks, outer)
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
        by_ratio = (b + c * rest) * decay
        # d, b and c are powers of load and speed: each change is the exponent times the value
        settled, spent = d * (1.0 - decay), ratio * decay
        by_log_speed = inner.d_speed * settled + (inner.b_speed * b + inner.c_speed * c * rest) * spent - ratio * by_ratio
        by_log_load = inner.d_load * settled + (inner.b_load * b + inner.c_load * c * rest) * spent
        coefficient = d - rest * decay
        scale = where_positive(sliding, inner.scale, -inner.scale)
        force = scale * normal
        store(contacts, block, CONTACT.force, force * coefficient)
        store(contacts, block, CONTACT.by_load, scale * (coefficient + by_log_load))
        store(contacts, block, CONTACT.by_sliding, inner.scale * normal * by_ratio * inverse_speed)
        store(contacts, block, CONTACT.by_rolling, force * by_log_speed * rolling * inverse_speed * inverse_speed)
    if inner.law == KRAGELSKII:
        _static(contacts, 0, blocks, inner.scale, inner.special)
