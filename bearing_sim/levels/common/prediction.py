# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the first guesses of levels ``planar`` and ``spatial`` share: how they iterate, and the inner ring in them.

All rollers take Newton steps together with the ring's centre until the ring has settled.  After that each roller goes on until it has settled
itself, so that a guess depends on no other roller that happens to stand in the same block, nor on the level.
"""

import math

from bearing_sim.levels.common.model import load_at
from bearing_sim.numerics.compilation import template

ITERATIONS = 4
SETTLED = 0.2  # of the position tolerance: what a step more would change is left to the iteration of the whole system (assumption)
UNSETTLED = math.inf  # last step [m] of what has not taken one


@template
def free_ring(t, model, support):
    """Return the load on the ring, y and z [N], at a time [s], and 1 where it is free in the plane, 0 where an elastic support holds it."""
    load_y, load_z = load_at(t, model.drive)
    return load_y, load_z, 0.0 if support.shape[0] > 0 else 1.0


@template
def goes_on_above(ring_step, enough):
    """Return the last step [m] above which a roller goes on: ``enough``, or any while the ring's last step was not below ``enough``."""
    return enough if ring_step < enough else -1.0


@template
def move_ring(known, shift, guess, border, ring_load, mass, rollers):
    """Take a Newton step of the ring's centre in ``guess``, with the rollers eliminated, and return it, y and z [m].

    The equations are m x'' = F - sum of Q_i e_r, with x'' = (x' - known x')/s and x' = (x - known x)/s.

    Parameters
    ----------
    known, shift, guess : of the stage, see `bearing_sim.numerics.time_stepping`; the ring's y and z are the first positions of the border.
    border : how many positions the border has; its speeds follow them.
    ring_load : what `free_ring` returns.
    mass : of the ring [kg].
    rollers : M_yy, M_yz, M_zz [N/m] and b_y, b_z [N] of the sum of Q_i e_r = M x - b, x the ring's step.
    """
    stiff_y, coupling, stiff_z, push_y, push_z = rollers
    per_shift = 1.0 / shift
    stiff_y += mass * per_shift * per_shift
    stiff_z += mass * per_shift * per_shift
    push_y += ring_load[0] - mass * per_shift * (guess[border] - known[border])
    push_z += ring_load[1] - mass * per_shift * (guess[border + 1] - known[border + 1])
    inverse = ring_load[2] / (stiff_y * stiff_z - coupling * coupling)
    y, z = (stiff_z * push_y - coupling * push_z) * inverse, (stiff_y * push_z - coupling * push_y) * inverse
    guess[0] += y
    guess[1] += z
    guess[border] += y * per_shift
    guess[border + 1] += z * per_shift
    return y, z
