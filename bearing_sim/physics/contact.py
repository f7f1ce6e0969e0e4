# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Normal contact of rollers and raceways (Deng 2017, eq. 3 to 6), and the rows of a contacts array, which all laws of contacts share."""

import math
from typing import NamedTuple

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.elementary import ninth_root
from bearing_sim.numerics.simd import larger, where_positive

# Assumption: below these the powers of the fits diverge; both are far below anything that carries torque.
LOAD_FLOOR = 1e-3  # N
ROLLING_SPEED_FLOOR = 0.05  # m/s
EXPONENT = 10.0 / 9.0  # of Palmgren's line contact
TINY = 1e-15  # m; a penetration that carries nothing


class ContactRow(NamedTuple):
    """Indices of the rows of a contacts array (see `bearing_sim.numerics.simd.new_rows`): all blocks of inner contacts, then all of outer ones."""

    load: int = 0  # normal force Q [N]
    rolling: int = 1  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 2  # surface-speed difference du, raceway less roller [m/s]
    force: int = 3  # T on the roller, with the sign of du [N]
    d_sliding: int = 4  # dT/d(du) [N s/m]
    d_rolling: int = 5  # dT/du [N s/m]
    d_load: int = 6  # dT/dQ
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
    resistance: int = 18  # F_R, against the motion of each surface through the contact [N]
    resistance_d_rolling: int = 19  # its slopes [N s/m]
    resistance_d_load: int = 20
    whole_load: int = 21  # from here on of rollers with a profile, see `bearing_sim.physics.profile.concentrate`: Q [N]
    length: int = 22  # psi, fraction of the length that bears, for tractions
    d_length: int = 23  # its derivative by Q [1/N]
    part: int = 24  # a, fraction of the length that bears at all
    gap: int = 25  # g beside it [m]


CONTACT = ContactRow()


def line_contact_stiffness(length, youngs_modulus, poisson_ratio):
    """Return K of Q = K delta^(10/9) [N/m^(10/9)] for two bodies of one material.

    In N and mm: Q = (delta/A_1)^(10/9) L^(8/9), A_1 = 1.36 eta^0.9, eta the sum over both bodies of (1 - nu^2)/E (Deng 2017, eq. 3,
    with 10/9 where it prints 1.11): the fit of A. Palmgren, Ball and Roller Bearing Engineering, 3rd ed. 1959, to measured approaches.

    Parameters
    ----------
    length : effective contact length [m].
    youngs_modulus : E [Pa].
    poisson_ratio : nu.
    """
    eta = 2.0 * (1.0 - poisson_ratio**2) / (youngs_modulus * 1e-6)
    a_1 = 1.36 * eta**0.9
    per_millimetre = (length * 1e3) ** (8.0 / 9.0) / a_1**EXPONENT
    return per_millimetre * 1e3**EXPONENT


def iso_contact_stiffness(length):
    """Return K of one contact [N/m^(10/9)] by ISO/TS 16281:2008, for steel.

    The standard's c_L = 35948 L^(8/9) N/mm^(10/9) counts the approach of both rings, Q = c_L (delta_i + delta_e)^(10/9): two equal
    contacts in a row, so that each has K = 2^(10/9) c_L.

    Parameters
    ----------
    length : effective contact length [m].
    """
    return 35948.0 * (length * 1e3) ** (8.0 / 9.0) * 2e3**EXPONENT


class ContactDamping(NamedTuple):
    """Damping of normal contacts, see `damped_line_contact`."""

    hysteresis: float  # a of Hunt and Crossley [s/m]
    time: float  # tau: deep contacts are damped by tau times their stiffness [s]
    depth: float  # h, penetration at which half of that is left [m]


@kernel
def damping_factor(depth, damping):
    """Return d, the damping of a normal contact over its elastic force [s/m], and its derivative by the depth [s/m^2].

    Parameters
    ----------
    depth : penetration, not below 0 [m].
    damping : `ContactDamping`.
    """
    inverse = 1.0 / (depth + damping.depth)
    fading = EXPONENT * damping.time * inverse
    return damping.hysteresis + fading, -fading * inverse


@kernel
def damped_line_contact(penetration, rate, stiffness, damping):
    """Return Q = K delta^(10/9) (1 + d delta'), never below 0, and its derivatives; d = a + (10/9) tau/(delta + h).

    The first part of d is damping that vanishes with the load: K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440.  The second part is
    proportional to the stiffness, c = tau dQ/d(delta), as E. Kraemer (Dynamics of Rotors and Foundations, 1993) gives it for rolling bearings, and
    fades where the penetration is less than h.  Deng 2017 states no damping; values are assumptions, see the theory of contacts.

    Parameters
    ----------
    penetration : delta [m] (lanes).
    rate : d(delta)/dt [m/s] (lanes).
    stiffness : K [N/m^(10/9)].
    damping : `ContactDamping`.

    Returns
    -------
    load [N], d_penetration [N/m], d_rate [N s/m]
    """
    depth = larger(penetration, 0.0)
    root = stiffness * ninth_root(larger(penetration, TINY))
    elastic = root * depth
    per_rate, slope = damping_factor(depth, damping)
    factor = 1.0 + per_rate * rate
    pressed = where_positive(factor, where_positive(penetration, 1.0, 0.0), 0.0)
    return elastic * larger(factor, 0.0), pressed * root * (EXPONENT * factor + depth * slope * rate), pressed * elastic * per_rate


@kernel
def elastic_line_contact(penetration, stiffness):
    """Return K delta^(10/9) [N] (lanes), the conservative part of `damped_line_contact`; `elastic_force` is its form for numbers."""
    return stiffness * ninth_root(larger(penetration, TINY)) * larger(penetration, 0.0)


@kernel
def elastic_force(penetration, stiffness):
    """Return Palmgren's K delta^(10/9) [N], the conservative part of a normal force; 0 of bodies apart."""
    return stiffness * max(penetration, 0.0) ** EXPONENT


@kernel
def hertz_pressure(load, slices, length, curvature_radius, reduced_modulus):
    """Return the largest pressure of a slice in line contact, sqrt(q E'/(2 pi R)) [Pa] (Hertz), without the rise at a sharp edge.

    Parameters
    ----------
    load : of one slice [N]; q = N load/L.
    slices, length : N, and L of all slices together [m].
    curvature_radius : effective radius R [m].
    reduced_modulus : E' = 2/sum((1 - nu^2)/E) [Pa].
    """
    return math.sqrt(slices / length * reduced_modulus / (2.0 * math.pi) / curvature_radius * load)
