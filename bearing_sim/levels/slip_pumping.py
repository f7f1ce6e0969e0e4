# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Resistance to rolling at level ``slip``: what the oil that the inlets pump back does to the rollers."""

from bearing_sim.kernels.arrow import ARROW
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.contact_rows import CONTACT
from bearing_sim.kernels.lanes import LANES
from bearing_sim.kernels.load_balance import LOAD


@kernel
def push_rollers(inner_radius, params, work, with_jacobian):
    """Add to forces and Jacobian of the rollers what the oil pumped back does; return the torque on the cage [N m] and its slope.

    A roller feels what both surfaces and its centre feel (`bearing_sim.kernels.film.pumping_constant`): F_R (1 - 2 gamma) inside,
    -F_R (1 + 2 gamma) outside along the orbit, and both brake its spin, for which the level's equations see to it.

    Parameters
    ----------
    inner_radius : R_i, grown [m].
    params, work : of the level; `bearing_sim.kernels.film.pump` has written into ``work.contacts``.
    with_jacobian : whether to add to the Jacobian.
    """
    contacts, jacobian, rollers, blocks = work.contacts, work.jacobian.rows, params.rollers, work.contacts.shape[0] // 2
    per_inertia, torque, torque_slope = rollers.radius / rollers.inertia, 0.0, 0.0
    for j in range(rollers.count):
        radius, block, lane = work.loads[LOAD.radius, j], j // LANES, j % LANES
        inner_push, outer_push = (inner_radius - rollers.radius) / radius, 1.0 + 2.0 * rollers.radius / radius  # 1 -/+ 2 gamma
        push = inner_push * contacts[block, CONTACT.pumping, lane] - outer_push * contacts[blocks + block, CONTACT.pumping, lane]
        inner, outer = 0.5 * contacts[block, CONTACT.pumping_by_rolling, lane], 0.5 * contacts[blocks + block, CONTACT.pumping_by_rolling, lane]
        inner_by_cage, outer_by_cage = (rollers.radius - inner_radius) * inner, (2.0 * rollers.radius + radius) * outer
        work.tangential[j] += push
        torque += radius * push
        torque_slope += radius * (inner_push * inner_by_cage - outer_push * outer_by_cage)
        if with_jacobian:
            jacobian[ARROW.row, j] += radius * rollers.radius * (inner_push * inner - outer_push * outer)
            jacobian[ARROW.column, j] -= per_inertia * (inner_by_cage + outer_by_cage)
            jacobian[ARROW.diagonal, j] -= per_inertia * rollers.radius * (inner + outer)
    return torque, torque_slope
