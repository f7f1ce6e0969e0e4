# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Traction of a thermal Eyring film with a limiting shear stress.

Film by Dowson and Toyoda, thinned by its heated inlet (`bearing_sim.kernels.film`); viscosity in the contact by Roelands at the
mean Hertz pressure p; shear stress tau = tau_E asinh(eta |du|/(h tau_E)), the oil heated by its own shear, tau |du| h/(12 k) in
the mean over the film; mu = Lambda tanh(tau/(Lambda p)).

The surfaces creep elastically, in series with the film: of the slide-to-roll ratio 8 tau/(pi E') is theirs, Carter's law of the
rolling line contact (F. W. Carter, Proc. R. Soc. A 112 (1926)) while little of it slips, and |du| above is what they leave to the
film (K. L. Johnson, J. L. Tevaarwerk, Proc. R. Soc. A 356 (1977), whose fluid is elastic in this way).  Without it a film that
pressure has turned solid would drag with all its strength at any sliding at all, which no step of time could follow.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.contact_rows import CONTACT, LOAD_FLOOR, ROLLING_SPEED_FLOOR, SPECIAL
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.film import DOWSON_TOYODA, HEAT_EXPONENT, HEAT_FACTOR, SHEAR_EXPONENT, SHEAR_FACTOR
from bearing_sim.kernels.lanes import larger, load, magnitude, smaller, spread, square_root, store, where_positive

_ROELANDS_PRESSURE, _ROELANDS_LOG = 5.1e-9, 9.67  # 1/Pa, of the pole of Roelands' viscosity
_SMALL_RATIO = 0.01  # slide-to-roll ratio below which the inlet's heating stays as it is: the law is smooth through no sliding
_NEWTON_STEPS = 7
_SERIES_STEPS = 5  # with the creep; where it matters, the film alone is a bound from above
_LARGEST_SINH = 1e150  # its square is still a number
_LEAST_SPAN = 0.1  # of ln eta_0 + 9.67: Roelands' law ends where an oil is as thin as 6.3e-5 Pa s


class EyringRow(NamedTuple):
    """Places in `TractionConstants.special`."""

    film: int = 0  # ln h less its powers of u and Q [m]
    inlet: int = 1  # ln of 0.1 L_t^0.64, less its power of u
    pressure: int = 2  # ln p less 0.5 ln Q
    exponent: int = 3  # Roelands' Z
    span: int = 4  # ln eta_0 + 9.67
    fluidity: int = 5  # ln (eta_0/tau_E)
    heating: int = 6  # beta tau_E/(12 k): fall of ln eta_0 by du and h [s/m^2]
    limit: int = 7  # tau_E/Lambda [Pa]
    limiting: int = 8  # Lambda
    creep: int = 9  # 8 tau_E/(pi E'): slide-to-roll ratio that the surfaces take for tau = tau_E


ROW = EyringRow()


def eyring_constants(oil, curvature_radius, reduced_modulus, length, eyring_stress, limiting_ratio):
    """Return the special constants of one contact, shape (SPECIAL,).

    Parameters
    ----------
    oil : `bearing_sim.oil.OilState`.
    curvature_radius : effective radius R [m].
    reduced_modulus : E' [Pa].
    length : L [m].
    eyring_stress : tau_E [Pa].
    limiting_ratio : Lambda, limiting shear stress over pressure.
    """
    stiffness, law = reduced_modulus * curvature_radius, DOWSON_TOYODA
    special, log_viscosity = np.zeros(SPECIAL), math.log(oil.viscosity)
    special[ROW.film] = (
        math.log(law.factor * curvature_radius)
        + law.speed * (log_viscosity - math.log(stiffness))
        + law.material * math.log(oil.pressure_viscosity * reduced_modulus)
        - law.load * math.log(stiffness * length)
    )
    special[ROW.inlet] = math.log(HEAT_FACTOR) + HEAT_EXPONENT * math.log(oil.viscosity * oil.temperature_viscosity / oil.conductivity)
    special[ROW.pressure] = 0.5 * math.log(math.pi * reduced_modulus / (32 * curvature_radius * length))
    span = max(log_viscosity + _ROELANDS_LOG, _LEAST_SPAN)
    special[ROW.exponent] = oil.pressure_viscosity / (_ROELANDS_PRESSURE * span)
    special[ROW.span] = span
    special[ROW.fluidity] = log_viscosity - math.log(eyring_stress)
    special[ROW.heating] = oil.temperature_viscosity * eyring_stress / (12 * oil.conductivity)
    special[ROW.limit] = eyring_stress / limiting_ratio
    special[ROW.limiting] = limiting_ratio
    special[ROW.creep] = 8 * eyring_stress / (math.pi * reduced_modulus)
    return special


@template
def _hyperbolic(y):
    """Return sinh and cosh of lanes from 0 on, sinh to full relative accuracy where it is small."""
    square = y * y
    rising = exponential(smaller(y, 300.0))
    falling = 1.0 / rising
    series = y * (1.0 + square * (1.0 / 6.0) * (1.0 + square * (1.0 / 20.0) * (1.0 + square * (1.0 / 42.0) * (1.0 + square * (1.0 / 72.0)))))
    return where_positive(1.0 - y, series, 0.5 * (rising - falling)), 0.5 * (rising + falling)


@kernel
def eyring_traction(contacts, first, end, scale, special):
    """Compute the tangential forces of the contacts in some blocks and their slopes.

    Parameters
    ----------
    contacts : array with rows `CONTACT`.
    first, end : blocks.
    scale : factor on the coefficient.
    special : see `eyring_constants`.
    """
    law, exponent, span, limiting = DOWSON_TOYODA, special[ROW.exponent], special[ROW.span], special[ROW.limiting]
    for block in range(first, end):
        normal, rolling, sliding = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.rolling), load(contacts, block, CONTACT.sliding)
        log_load = logarithm(larger(normal, LOAD_FLOOR))
        log_speed = 0.5 * logarithm(rolling * rolling + ROLLING_SPEED_FLOOR * ROLLING_SPEED_FLOOR)
        inverse_speed, slide = exponential(-log_speed), magnitude(sliding)
        # film, and its changes with ln |du|, ln u and ln Q
        ratio = slide * inverse_speed
        square = ratio * ratio + _SMALL_RATIO * _SMALL_RATIO
        inlet = exponential(special[ROW.inlet] + 2.0 * HEAT_EXPONENT * log_speed)
        sheared = SHEAR_FACTOR * exponential(0.5 * SHEAR_EXPONENT * logarithm(square))
        left = 1.0 / (1.0 + inlet * (1.0 + sheared))
        film = exponential(special[ROW.film] + law.speed * log_speed + law.load * log_load) * left
        h_slide = -SHEAR_EXPONENT * inlet * sheared * left * (ratio * ratio / square)
        h_speed = law.speed - 2.0 * HEAT_EXPONENT * inlet * (1.0 + sheared) * left - h_slide
        # viscosity at the mean pressure
        pressure = exponential(special[ROW.pressure] + 0.5 * log_load)
        piled = 1.0 + _ROELANDS_PRESSURE * pressure
        power = exponential(exponent * logarithm(piled))
        power_load = 0.5 * exponent * (piled - 1.0) / piled
        thick = exponential(special[ROW.fluidity] + span * (power - 1.0)) / film  # eta/(h tau_E)
        # sinh(y) = a exp(-k y): from no stress Newton's method comes up to the root and never passes it
        a, k = thick * slide, special[ROW.heating] * slide * film * power
        y = spread(0.0)
        for _ in range(_NEWTON_STEPS):
            sinh = smaller(a * exponential(-(k * y)), _LARGEST_SINH)
            cosh = square_root(1.0 + sinh * sinh)
            y -= (y - logarithm(sinh + cosh)) / (1.0 + k * sinh / cosh)
        # sinh(y) exp(k y)/thick + creep y = |du|, which rises ever faster: from above Newton's method comes down to the root
        creep = special[ROW.creep] / inverse_speed
        y = smaller(y, slide / creep)
        for _ in range(_SERIES_STEPS):
            sinh, cosh = _hyperbolic(y)
            opened = exponential(smaller(k * y, 300.0)) / thick
            y = larger(y - (sinh * opened + creep * y - slide) / ((cosh + k * sinh) * opened + creep), 0.0)
        sinh, cosh = _hyperbolic(y)
        opened = exponential(smaller(k * y, 300.0)) / thick
        sheared_slide = sinh * opened  # the film's share of |du|
        stiff = 1.0 / ((cosh + k * sinh) * opened + creep)
        film_share = sheared_slide / larger(slide, 1e-300)
        y_slide = stiff * (1.0 - film_share * (h_slide + k * y * (1.0 + h_slide)))
        y_speed = -(stiff * (sheared_slide * h_speed * (1.0 + k * y) + creep * y))
        y_load = stiff * sheared_slide * (span * power * power_load - law.load - k * y * (law.load + power_load))
        # limiting shear stress
        limit = special[ROW.limit] / pressure
        fade = exponential(-2.0 * (limit * y))
        level = (1.0 - fade) / (1.0 + fade)
        slope = limiting * (1.0 - level * level) * limit
        sign = where_positive(sliding, scale, -scale)
        store(contacts, block, CONTACT.force, sign * normal * limiting * level)
        store(contacts, block, CONTACT.by_load, sign * (limiting * level + slope * (y_load - 0.5 * y)))
        store(contacts, block, CONTACT.by_sliding, scale * normal * slope * y_slide)
        store(contacts, block, CONTACT.by_rolling, sign * normal * slope * y_speed * rolling * inverse_speed * inverse_speed)
