# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Forces between a roller and its cage pocket: film spring, wall and friction (Deng 2017, section 3.1.2)."""

import math

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import larger, magnitude, spread, square_root, total, where_positive
from bearing_sim.physics.contact import damped_line_contact

FRICTION_SPIN = 10.0  # rad/s; assumption: pocket friction is proportional to spin well below this


@kernel
def wall_force(offset, rate, clearance, film_stiffness, film_damping, stiffness, damping):
    """Return the force of two opposite pocket walls, with its derivatives by offset and by its rate (lanes).

    With s the offset of the roller from the middle between the walls and C_p the clearance to either of them,

        F = K_c s + d s'                                          for |s| <= C_p,
        F = sign(s) [K_c C_p + Q(|s| - C_p)] + d s'               beyond,

    Q the damped line contact of `bearing_sim.physics.contact.damped_line_contact`.  Deng 2017, eq. 10, has K_c = 67 N/C_p and lets the force
    jump from 67 N to 0 where the clearance is used up; here it continues from there.  Film damping d is an *assumption*.

    Parameters
    ----------
    offset, rate : s [m] and s' [m/s].
    clearance : C_p [m].
    film_stiffness, film_damping : K_c [N/m] and d [N s/m].
    stiffness, damping : of the line contact, K [N/m^(10/9)] and a [s/m].

    Returns
    -------
    force [N], on the wall along the offset; d_offset [N/m], d_rate [N s/m]
    """
    d_offset, d_rate = spread(film_stiffness), spread(film_damping)
    force = d_offset * offset + d_rate * rate
    excess = magnitude(offset) - clearance
    if total(where_positive(excess, 1.0, 0.0)) > 0.0:
        side = where_positive(offset, 1.0, -1.0)
        wall, d_excess, d_wall_rate = damped_line_contact(excess, rate * side, stiffness, damping)
        force += side * (wall - film_stiffness * larger(excess, 0.0))
        d_offset = where_positive(excess, d_excess, d_offset)
        d_rate += d_wall_rate
    return force, d_offset, d_rate


@kernel
def pocket_friction(spin, coefficient):
    """Return the friction coefficient of a pocket with the sign of the roller's spin: mu_c w/sqrt(w^2 + w_0^2), w_0 = 10 rad/s.

    Deng 2017, eq. 13, made smooth through no spin; the value of mu_c is an *assumption* (published 0.02 to 0.1).

    Parameters
    ----------
    spin : w of the roller [rad/s].
    coefficient : mu_c, of a roller that turns fast.
    """
    return coefficient * spin / math.sqrt(spin * spin + FRICTION_SPIN * FRICTION_SPIN)


@kernel
def pocket_friction_lanes(spin, coefficient):
    """Return `pocket_friction` of several rollers at once, and its derivative by spin [s/rad] (lanes)."""
    smooth = 1.0 / square_root(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
    return coefficient * spin * smooth, (coefficient * FRICTION_SPIN * FRICTION_SPIN) * smooth * smooth * smooth
