# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Normal contact of rollers and raceways: Palmgren's line contact (Deng 2017, eq. 3 to 5)."""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.elementary import exponential, logarithm
from bearing_sim.kernels.lanes import larger, where_positive

EXPONENT = 10.0 / 9.0
TINY = 1e-15  # m; a penetration that carries nothing


def line_contact_stiffness(length, youngs_modulus, poisson_ratio):
    """Return K of Q = K delta^(10/9) [N/m^(10/9)] for two bodies of one material.

    Palmgren's fit in N and mm: Q = (delta/A_1)^(10/9) L^(8/9), A_1 = 1.36 eta^0.9, eta the sum over both
    bodies of (1 - nu^2)/E (Deng 2017, eq. 3, with 10/9 where it prints 1.11).

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
    """Return K of one contact [N/m^(10/9)] by ISO/TS 16281, for steel.

    Its c_L = 35948 L^(8/9) N/mm^(10/9) counts the approach of both rings, Q = c_L (delta_i + delta_e)^(10/9): two equal
    contacts in a row, so that each has K = 2^(10/9) c_L.

    Parameters
    ----------
    length : effective contact length [m].
    """
    return 35948.0 * (length * 1e3) ** (8.0 / 9.0) * 2e3**EXPONENT


@kernel
def line_penetration(force, stiffness):
    """Return the penetration [m] that carries a normal force [N]: Palmgren's law the other way round."""
    if force <= 0.0:
        return 0.0
    return (force / stiffness) ** 0.9


@template
def log_penetration(penetration):
    """Return ln(penetration), finite where there is none (lanes)."""
    return logarithm(larger(penetration, TINY))


@template
def damped_line_contact(penetration, log, rate, stiffness, damping):
    """Return Q = K delta^(10/9) (1 + a d(delta)/dt), never pulling, and its slopes (Hunt and Crossley 1975).

    Parameters
    ----------
    penetration, log : delta [m] and `log_penetration` of it (lanes).
    rate : d(delta)/dt [m/s] (lanes).
    stiffness : K [N/m^(10/9)].
    damping : a [s/m].

    Returns
    -------
    load [N], by_penetration [N/m], by_rate [N s/m]
    """
    root = stiffness * exponential(log * (1.0 / 9.0))
    elastic = root * larger(penetration, 0.0)
    factor = 1.0 + damping * rate
    pressed = where_positive(factor, where_positive(penetration, 1.0, 0.0), 0.0)
    return elastic * larger(factor, 0.0), pressed * EXPONENT * root * factor, pressed * elastic * damping
