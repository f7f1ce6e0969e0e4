"""Tangential force of the oil film between roller and raceway (Deng 2017, eq. 7).

Every law here is written in one form, odd in the sliding speed and zero without sliding:

    mu(s) = D - (D - B s) exp(-C s),   s = |du| / u,

with B, C and D products of powers of load and rolling speed.  Two logarithms and four exponentials then
serve a contact, where the published form takes nine powers.
"""

import math
from typing import NamedTuple

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.lanes import larger, load, magnitude, store, where_positive

# Below these the powers of the fits run away; both are far below anything that carries torque.
_LOAD_FLOOR = 1e-3  # N
_ROLLING_SPEED_FLOOR = 0.05  # m/s


class TractionConstants(NamedTuple):
    """ln D, ln B, ln C of one contact as affine functions of ln Q and ln u (SI)."""

    scale: float
    d_constant: float
    d_load: float
    d_speed: float
    b_constant: float
    b_load: float
    b_speed: float
    c_constant: float
    c_load: float
    c_speed: float


class ContactRow(NamedTuple):
    """Rows of a contacts array (see `bearing_sim.kernels.lanes.new_rows`): all blocks of inner contacts, then all of outer ones."""

    load: int = 0  # normal force Q [N]
    rolling: int = 1  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 2  # surface-speed difference du, raceway less roller [m/s]
    force: int = 3  # T on the roller, with the sign of du [N]
    by_sliding: int = 4  # dT/d(du) [N s/m]
    by_rolling: int = 5  # dT/du [N s/m]
    by_load: int = 6  # dT/dQ
    log_load: int = 7  # from here on, steps of the computation
    log_speed: int = 8
    inverse_speed: int = 9
    d: int = 10
    b: int = 11
    c: int = 12
    decay: int = 13
    penetration: int = 14  # [m]; these five belong to the normal force
    rate: int = 15  # its time derivative [m/s]
    stiffness: int = 16  # dQ by penetration [N/m]
    damping: int = 17  # dQ by its rate [N s/m]
    log_penetration: int = 18


CONTACT = ContactRow()


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

    return TractionConstants(scale, *powers(696.0, -0.163, 0.577, 0.308), *powers(5.19e6, -0.373, 1.0, 0.687), *powers(6.826e5, -0.170, 0.578, 0.373))


def constant_constants(scale, b, c, d):
    """Return the constants of the law whose B, C, D do not depend on load and speed.

    A given A other than -D would be a jump at zero sliding; it is taken as -D, which changes mu only where it rises.
    """

    def logarithm(value):
        return math.log(value) if value > 0 else -600.0  # a factor that is nothing, and no infinity to multiply by zero

    return TractionConstants(scale, logarithm(d), 0.0, 0.0, logarithm(b), 0.0, 0.0, logarithm(c), 0.0, 0.0)


@kernel
def _powers(contacts, first, end, constants):
    """Write D, B, C and exp(-C s) of the contacts in some blocks."""
    for block in range(first, end):
        log_load, log_speed = load(contacts, block, CONTACT.log_load), load(contacts, block, CONTACT.log_speed)
        store(contacts, block, CONTACT.d, exponential(constants.d_constant + constants.d_load * log_load + constants.d_speed * log_speed))
        store(contacts, block, CONTACT.b, exponential(constants.b_constant + constants.b_load * log_load + constants.b_speed * log_speed))
        store(contacts, block, CONTACT.c, exponential(constants.c_constant + constants.c_load * log_load + constants.c_speed * log_speed))


@kernel
def traction(contacts, inner, outer):
    """Compute the tangential forces of all contacts.

    Parameters
    ----------
    contacts : array with rows `CONTACT`; load, rolling and sliding go in, force and its slopes come out.
    inner, outer : `TractionConstants` of the raceways; they differ in the constant factors alone.
    """
    blocks = contacts.shape[0]
    # Short loops: the processor works on several blocks at once where one long chain of operations would make it wait.
    for block in range(blocks):
        store(contacts, block, CONTACT.log_load, logarithm(larger(load(contacts, block, CONTACT.load), _LOAD_FLOOR)))
    for block in range(blocks):
        rolling = load(contacts, block, CONTACT.rolling)
        log_speed = 0.5 * logarithm(rolling * rolling + _ROLLING_SPEED_FLOOR * _ROLLING_SPEED_FLOOR)
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
