"""Tangential force of the oil film between roller and raceway (Deng 2017, eq. 7).

Every law here is written in one form, odd in the sliding speed and zero without sliding:

    mu(s) = D - (D - B s) exp(-C s),   s = |du| / u,

with B, C and D products of powers of load and rolling speed.  Two logarithms and four exponentials then
serve a contact, where the published form takes nine powers.
"""

import math
from typing import NamedTuple

from bearing_sim.kernels.compilation import kernel

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

    return TractionConstants(
        scale, *powers(696.0, -0.163, 0.577, 0.308), *powers(5.19e6, -0.373, 1.0, 0.687), *powers(6.826e5, -0.170, 0.578, 0.373)
    )


def constant_constants(scale, b, c, d):
    """Return the constants of the law whose B, C, D do not depend on load and speed.

    A given A other than -D would be a jump at zero sliding; it is taken as -D, which changes mu only where it rises.
    """

    def logarithm(value):
        return math.log(value) if value > 0 else -math.inf

    return TractionConstants(scale, logarithm(d), 0.0, 0.0, logarithm(b), 0.0, 0.0, logarithm(c), 0.0, 0.0)


@kernel
def traction(load, rolling_speed, sliding_speed, constants):
    """Return the tangential force [N] on the slower surface's side and its slopes.

    Parameters
    ----------
    load : normal force Q [N].
    rolling_speed : mean speed u of both surfaces relative to the contact [m/s].
    sliding_speed : surface-speed difference du [m/s]; the force has its sign.
    constants : `TractionConstants` of the contact.

    Returns
    -------
    force : T [N]
    by_sliding : dT/d(du) [N s/m]
    by_rolling : dT/du [N s/m]
    """
    if load <= 0.0:
        return 0.0, 0.0, 0.0
    squared_speed = rolling_speed * rolling_speed + _ROLLING_SPEED_FLOOR * _ROLLING_SPEED_FLOOR
    log_speed = 0.5 * math.log(squared_speed)
    log_load = math.log(max(load, _LOAD_FLOOR))
    d = math.exp(constants.d_constant + constants.d_load * log_load + constants.d_speed * log_speed)
    b = math.exp(constants.b_constant + constants.b_load * log_load + constants.b_speed * log_speed)
    c = math.exp(constants.c_constant + constants.c_load * log_load + constants.c_speed * log_speed)
    inverse_speed = 1.0 / math.sqrt(squared_speed)
    slide_to_roll = abs(sliding_speed) * inverse_speed
    decay = math.exp(-c * slide_to_roll)
    rest = d - b * slide_to_roll
    coefficient = d - rest * decay
    by_ratio = (b + c * rest) * decay
    by_log_speed = (
        constants.d_speed * d * (1.0 - decay)
        + constants.b_speed * b * slide_to_roll * decay
        + constants.c_speed * c * slide_to_roll * rest * decay
        - slide_to_roll * by_ratio
    )
    force = constants.scale * load
    sign = 1.0 if sliding_speed >= 0.0 else -1.0
    return (
        sign * force * coefficient,
        force * by_ratio * inverse_speed,
        sign * force * by_log_speed * rolling_speed / squared_speed,
    )
