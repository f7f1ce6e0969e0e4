# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the slices' loads at level ``spatial`` say: running means for a life (ISO/TS 16281, `bearing_sim.rating_life`), and pressures."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.lanes import highest, larger, load, spread, square_root, total
from bearing_sim.levels.spatial_slices import SLICED, slice_force
from bearing_sim.levels.spatial_state import ROLLER


@kernel
def average_slices(share, params, work):
    """Take the slices' loads of this instant, stress risers included, into their running means to the exponents of both rings.

    The means are those of `bearing_sim.rating_life.add_slice_powers`; the first instant starts them.

    Parameters
    ----------
    share : weight of this instant.
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    slices, contacts, means = params.slices, work.contacts, work.slice_means
    number, blocks = slices.places.shape[0], work.rollers.shape[0]
    part, damping = params.raceways.stiffness / number, params.ring.contact_damping
    started = 0.0
    for k in range(number):
        started += means[0, k] + means[1, k]
    weight = share if started > 0.0 else 1.0  # the end slices of a crowned roller may never be loaded
    for k in range(number):
        rotating, stationary = spread(0.0), spread(0.0)
        for block in range(blocks):
            present = load(work.rollers, block, ROLLER.present)
            inner = slices.risers[k] * _slice_load(block, k, contacts, slices, part, damping)
            outer = slices.risers[k] * _slice_load(blocks + block, k, contacts, slices, part, damping)
            rotating += present * (inner * inner) * (inner * inner)
            stationary += present * (outer * outer) * (outer * outer) * square_root(outer)
        count = params.rollers.count
        means[0, k] += weight * (total(rotating) / count - means[0, k])
        means[1, k] += weight * (total(stationary) / count - means[1, k])


@kernel
def _slice_load(block, k, contacts, slices, part, damping):
    """Return the normal force of slice k of a block of contacts [N]."""
    x = slices.places[k]
    depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - slices.crown[k]
    rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
    return slice_force(depth, rate, part, damping)[0]


@kernel
def _largest_slices(first, params, work):
    """Return the largest load of any slice on a raceway whose first block is ``first``, and of any end slice [N]."""
    slices, contacts = params.slices, work.contacts
    number, damping = slices.places.shape[0], params.ring.contact_damping
    part, anywhere, at_ends = params.raceways.stiffness / number, spread(0.0), spread(0.0)
    for block in range(work.rollers.shape[0]):
        present = load(work.rollers, block, ROLLER.present)
        for k in range(number):
            pressed = present * _slice_load(first + block, k, contacts, slices, part, damping)
            anywhere = larger(anywhere, pressed)
            if k == 0 or k == number - 1:
                at_ends = larger(at_ends, pressed)
    return highest(anywhere), highest(at_ends)


@kernel
def slice_pressures(params, work):
    """Return the largest pressure of any slice on inner and outer raceway, and of any end slice on both [Pa].

    Hertz's largest pressure of a line contact, sqrt(q E'/(2 pi R)), q the load per length; without the rise at a sharp edge.

    Parameters
    ----------
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    raceways = params.raceways
    per_load = params.slices.places.shape[0] / params.rollers.length * raceways.reduced_modulus / (2.0 * math.pi)
    inner, inner_edge = _largest_slices(0, params, work)
    outer, outer_edge = _largest_slices(work.rollers.shape[0], params, work)
    inner_scale, outer_scale = per_load / raceways.inner_curvature_radius, per_load / raceways.outer_curvature_radius
    return math.sqrt(inner_scale * inner), math.sqrt(outer_scale * outer), math.sqrt(inner_scale * inner_edge), math.sqrt(outer_scale * outer_edge)
