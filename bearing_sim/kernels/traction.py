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


class FilmRow(NamedTuple):
    """Rows of a film array, shape (len(FILM), 2 Z): all rollers' contacts with the inner, then with the outer raceway.

    One array instead of one each, because compiled code counts references to every array that it hands on.
    """

    rolling: int = 0  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 1  # surface-speed difference du, raceway less roller [m/s]
    load: int = 2  # normal force Q [N]
    force: int = 3  # T on the roller, with the sign of du [N]
    by_sliding: int = 4  # dT/d(du) [N s/m]
    by_rolling: int = 5  # dT/du [N s/m]
    by_load: int = 6  # dT/dQ
    log_load: int = 7  # from here on, steps of the computation
    log_speed: int = 8
    inverse_speed: int = 9
    slide_to_roll: int = 10
    d: int = 11
    b: int = 12
    c: int = 13
    decay: int = 14


FILM = FilmRow()


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
def traction(film, inner, outer):
    """Compute the tangential forces of all contacts.

    Parameters
    ----------
    film : array with rows `FILM`, the inner contacts of all rollers first; rolling, sliding and load go in, force and its
        slopes come out.
    inner, outer : `TractionConstants` of the raceways; they differ in the constants alone.
    """
    rollers = film.shape[1] // 2
    # Short loops with few operands each: only those does the compiler vectorise.
    for j in range(film.shape[1]):
        film[FILM.log_load, j] = logarithm(max(film[FILM.load, j], _LOAD_FLOOR))
    for j in range(film.shape[1]):
        speed = film[FILM.rolling, j]
        film[FILM.log_speed, j] = 0.5 * logarithm(speed * speed + _ROLLING_SPEED_FLOOR * _ROLLING_SPEED_FLOOR)
    for j in range(film.shape[1]):
        film[FILM.inverse_speed, j] = exponential(-film[FILM.log_speed, j])
    for j in range(film.shape[1]):
        constant = inner.d_constant if j < rollers else outer.d_constant
        film[FILM.d, j] = exponential(constant + inner.d_load * film[FILM.log_load, j] + inner.d_speed * film[FILM.log_speed, j])
    for j in range(film.shape[1]):
        constant = inner.b_constant if j < rollers else outer.b_constant
        film[FILM.b, j] = exponential(constant + inner.b_load * film[FILM.log_load, j] + inner.b_speed * film[FILM.log_speed, j])
    for j in range(film.shape[1]):
        constant = inner.c_constant if j < rollers else outer.c_constant
        film[FILM.c, j] = exponential(constant + inner.c_load * film[FILM.log_load, j] + inner.c_speed * film[FILM.log_speed, j])
    for j in range(film.shape[1]):
        film[FILM.slide_to_roll, j] = abs(film[FILM.sliding, j]) * film[FILM.inverse_speed, j]
    for j in range(film.shape[1]):
        film[FILM.decay, j] = exponential(-film[FILM.c, j] * film[FILM.slide_to_roll, j])
    for j in range(film.shape[1]):
        ratio, decay = film[FILM.slide_to_roll, j], film[FILM.decay, j]
        d, b, c = film[FILM.d, j], film[FILM.b, j], film[FILM.c, j]
        rest = d - b * ratio
        by_ratio = (b + c * rest) * decay
        by_log_speed = inner.d_speed * d * (1.0 - decay) + (inner.b_speed * b + inner.c_speed * c * rest) * ratio * decay - ratio * by_ratio
        by_log_load = inner.d_load * d * (1.0 - decay) + (inner.b_load * b + inner.c_load * c * rest) * ratio * decay
        coefficient = inner.scale * (d - rest * decay)
        force = inner.scale * film[FILM.load, j]
        signed_force = force if film[FILM.sliding, j] >= 0.0 else -force
        inverse_speed = film[FILM.inverse_speed, j]
        film[FILM.force, j] = signed_force * (d - rest * decay)
        film[FILM.by_load, j] = (1.0 if film[FILM.sliding, j] >= 0.0 else -1.0) * (coefficient + inner.scale * by_log_load)
        film[FILM.by_sliding, j] = force * by_ratio * inverse_speed
        film[FILM.by_rolling, j] = signed_force * by_log_speed * film[FILM.rolling, j] * inverse_speed * inverse_speed
