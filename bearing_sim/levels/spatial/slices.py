# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Contact of sliced rollers and raceways: forces of every slice summed with their moments, means for a life by slices, and pressures.

Deng 2017, eq. 3 to 8: a slice of width L/N carries q = (K/N) delta_k^(10/9), delta_k = delta - C_k + lean x_k, damped as a whole contact is.
Traction treats a piece of a few slices as a whole contact with the piece's mean load per length, and takes the piece's fraction of the
result: equal slices add up to what `bearing_sim.physics.traction` gives.  Pieces are used because traction is nearly proportional to the load
and costs three times what the load costs; a piece of one slice is Deng's own sum.  The sliding speed of a piece follows from how fast the
axes skew against each other; the rolling speed is the same for all.

Left out: sliding along the axis of a skewed roller, and the difference of circumference along a crowned one.
"""

from bearing_sim.levels.spatial.state import D_DEPTH, D_LEAN, D_LEAN_RATE, D_RATE, ROLLER, SLICED, SLICED_ROWS
from bearing_sim.numerics.compilation import fused, kernel, template
from bearing_sim.numerics.simd import highest, larger, load, magnitude, spread, square_root, store, total, where_positive
from bearing_sim.physics.contact import CONTACT, EXPONENT, damped_slice, hertz_pressure


@fused
def touches(block, contacts, reach):
    """Return whether any slice of a block of rollers may be loaded.

    Parameters
    ----------
    reach : position of the last slice [m].
    """
    deepest = load(contacts, block, SLICED.penetration) + magnitude(load(contacts, block, SLICED.lean)) * reach
    return total(where_positive(deepest, 1.0, 0.0)) > 0.0


@kernel
def _clear(block, contacts, rows):
    """Write a block of contacts that carries nothing."""
    store(contacts, block, SLICED.load, 0.0)
    store(contacts, block, SLICED.force, 0.0)
    store(contacts, block, SLICED.tilting, 0.0)
    store(contacts, block, SLICED.skewing, 0.0)
    for row in range(SLICED.stiffness, rows):
        store(contacts, block, row, 0.0)


@fused
def normal_slices(block, contacts, slices, stiffness, damping):
    """Write normal force, tilting moment and their derivatives of a block of contacts, no traction.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration, lean and their rates go in.
    slices : `bearing_sim.model.params.Slices`.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and a [s/m].
    """
    count = slices.positions.shape[0]
    if not touches(block, contacts, slices.positions[count - 1]):
        _clear(block, contacts, SLICED.of_force)
        return
    penetration, rate = load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.rate)
    lean, lean_rate = load(contacts, block, SLICED.lean), load(contacts, block, SLICED.lean_rate)
    part = stiffness / count
    q_0, q_1 = spread(0.0), spread(0.0)
    k_0, k_1, k_2 = spread(0.0), spread(0.0), spread(0.0)
    d_0, d_1, d_2 = spread(0.0), spread(0.0), spread(0.0)
    for k in range(count):
        x, drop = slices.positions[k], slices.crown[k]
        depth = penetration + lean * x - drop
        q, root, factor, pressed = damped_slice(depth, rate + lean_rate * x, part, damping)
        d_depth, d_rate = pressed * root * factor, pressed * root * depth
        d_depth_x, d_rate_x = d_depth * x, d_rate * x
        q_0 += q
        q_1 += q * x
        k_0 += d_depth
        k_1 += d_depth_x
        k_2 += d_depth_x * x
        d_0 += d_rate
        d_1 += d_rate_x
        d_2 += d_rate_x * x
    store(contacts, block, SLICED.load, q_0)
    store(contacts, block, SLICED.tilting, q_1)
    store(contacts, block, SLICED.stiffness, EXPONENT * k_0)
    store(contacts, block, SLICED.stiffness + 1, EXPONENT * k_1)
    store(contacts, block, SLICED.stiffness + 2, EXPONENT * k_2)
    store(contacts, block, SLICED.damping, damping * d_0)
    store(contacts, block, SLICED.damping + 1, damping * d_1)
    store(contacts, block, SLICED.damping + 2, damping * d_2)


@fused
def load_pieces(contacts, pieces, slices, stiffness, damping):
    """Write normal forces, tilting moments and their derivatives of all contacts, and what traction needs of their pieces.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration, lean, rates and speeds go in.
    pieces : rows `bearing_sim.physics.contact.CONTACT` and, behind them, `D_DEPTH` and the like; those of a block of
        contacts follow each other.  A piece is a whole contact with the piece's load per length.
    slices : `bearing_sim.model.params.Slices`.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and a [s/m].
    """
    count, together, reach = slices.positions.shape[0], slices.together, slices.positions[slices.positions.shape[0] - 1]
    part, number = stiffness / count, pieces.shape[0] // contacts.shape[0]
    for block in range(contacts.shape[0]):
        penetration, rate = load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.rate)
        lean, lean_rate = load(contacts, block, SLICED.lean), load(contacts, block, SLICED.lean_rate)
        sliding, sliding_lean, rolling = (
            load(contacts, block, SLICED.sliding),
            load(contacts, block, SLICED.sliding_lean),
            load(contacts, block, SLICED.rolling),
        )
        loaded = touches(block, contacts, reach)
        q_0, q_1 = spread(0.0), spread(0.0)
        k_0, k_1, k_2 = spread(0.0), spread(0.0), spread(0.0)
        d_0, d_1, d_2 = spread(0.0), spread(0.0), spread(0.0)
        for which in range(number):
            first, piece = which * together, block * number + which
            end = min(first + together, count)
            q, d_depth, d_lean, d_rate, d_lean_rate = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            if loaded:
                for k in range(first, end):
                    x = slices.positions[k]
                    depth = penetration + lean * x - slices.crown[k]
                    load_k, root, factor, pressed = damped_slice(depth, rate + lean_rate * x, part, damping)
                    stiff, damped = pressed * root * factor, pressed * root * depth
                    stiff_x, damped_x = stiff * x, damped * x
                    q += load_k
                    q_1 += load_k * x
                    d_depth += stiff
                    d_lean += stiff_x
                    k_2 += stiff_x * x
                    d_rate += damped
                    d_lean_rate += damped_x
                    d_2 += damped_x * x
            q_0 += q
            k_0 += d_depth
            k_1 += d_lean
            d_0 += d_rate
            d_1 += d_lean_rate
            store(pieces, piece, CONTACT.load, q * (count / (end - first)))
            store(pieces, piece, CONTACT.rolling, rolling)
            store(pieces, piece, CONTACT.sliding, sliding + sliding_lean * (0.5 * (slices.positions[first] + slices.positions[end - 1])))
            store(pieces, piece, D_DEPTH, EXPONENT * d_depth)
            store(pieces, piece, D_LEAN, EXPONENT * d_lean)
            store(pieces, piece, D_RATE, damping * d_rate)
            store(pieces, piece, D_LEAN_RATE, damping * d_lean_rate)
        store(contacts, block, SLICED.load, q_0)
        store(contacts, block, SLICED.tilting, q_1)
        _store_sums(block, contacts, SLICED.stiffness, EXPONENT, k_0, k_1, k_2)
        _store_sums(block, contacts, SLICED.damping, damping, d_0, d_1, d_2)


@fused
def sum_tractions(contacts, pieces, slices):
    """Write tractions, skewing moments and their derivatives of all contacts from those of the pieces; parameters as of `load_pieces`."""
    count, together, number = slices.positions.shape[0], slices.together, pieces.shape[0] // contacts.shape[0]
    for block in range(contacts.shape[0]):
        t_0, t_1 = spread(0.0), spread(0.0)
        tk_0, tk_1, mk_0, mk_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        td_0, td_1, md_0, md_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        s_0, s_1, s_2, u_0, u_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        for which in range(number):
            first, piece = which * together, block * number + which
            end = min(first + together, count)
            fraction, position = (end - first) / count, 0.5 * (slices.positions[first] + slices.positions[end - 1])
            force, d_load = fraction * load(pieces, piece, CONTACT.force), load(pieces, piece, CONTACT.d_load)
            d_sliding, d_rolling = fraction * load(pieces, piece, CONTACT.d_sliding), fraction * load(pieces, piece, CONTACT.d_rolling)
            d_depth, d_lean = d_load * load(pieces, piece, D_DEPTH), d_load * load(pieces, piece, D_LEAN)
            d_rate, d_lean_rate = d_load * load(pieces, piece, D_RATE), d_load * load(pieces, piece, D_LEAN_RATE)
            t_0 += force
            t_1 += force * position
            tk_0 += d_depth
            tk_1 += d_lean
            td_0 += d_rate
            td_1 += d_lean_rate
            mk_0 += d_depth * position
            mk_1 += d_lean * position
            md_0 += d_rate * position
            md_1 += d_lean_rate * position
            s_0 += d_sliding
            s_1 += d_sliding * position
            s_2 += d_sliding * (position * position)
            u_0 += d_rolling
            u_1 += d_rolling * position
        store(contacts, block, SLICED.force, t_0)
        store(contacts, block, SLICED.skewing, t_1)
        store(contacts, block, SLICED.of_force, tk_0)
        store(contacts, block, SLICED.of_force + 1, tk_1)
        store(contacts, block, SLICED.of_force + 3, td_0)
        store(contacts, block, SLICED.of_force + 4, td_1)
        store(contacts, block, SLICED.of_skewing, mk_0)
        store(contacts, block, SLICED.of_skewing + 1, mk_1)
        store(contacts, block, SLICED.of_skewing + 3, md_0)
        store(contacts, block, SLICED.of_skewing + 4, md_1)
        _store_sums(block, contacts, SLICED.d_sliding, 1.0, s_0, s_1, s_2)
        store(contacts, block, SLICED.d_rolling, u_0)
        store(contacts, block, SLICED.d_rolling + 1, u_1)


@kernel
def sum_resistance(contacts, pieces, slices):
    """Write resistances to rolling, their moments and derivatives of all contacts from those of the pieces, which have been written."""
    count, together, number = slices.positions.shape[0], slices.together, pieces.shape[0] // contacts.shape[0]
    for block in range(contacts.shape[0]):
        for row in range(SLICED.resistance, SLICED_ROWS):
            store(contacts, block, row, 0.0)
        for which in range(number):
            first, piece = which * together, block * number + which
            end = min(first + together, count)
            fraction, position = (end - first) / count, 0.5 * (slices.positions[first] + slices.positions[end - 1])
            d_load = load(pieces, piece, CONTACT.resistance_d_load)
            force, d_rolling = fraction * load(pieces, piece, CONTACT.resistance), fraction * load(pieces, piece, CONTACT.resistance_d_rolling)
            _add_with_moment(block, contacts, SLICED.resistance, 1, force, position)
            _add_with_moment(block, contacts, SLICED.resistance_d_rolling, 1, d_rolling, position)
            _add_with_moment(block, contacts, SLICED.of_resistance, 5, d_load * load(pieces, piece, D_DEPTH), position)
            _add_with_moment(block, contacts, SLICED.of_resistance + 1, 5, d_load * load(pieces, piece, D_LEAN), position)
            _add_with_moment(block, contacts, SLICED.of_resistance + 3, 5, d_load * load(pieces, piece, D_RATE), position)
            _add_with_moment(block, contacts, SLICED.of_resistance + 4, 5, d_load * load(pieces, piece, D_LEAN_RATE), position)


@template
def _add_with_moment(block, contacts, row, apart, value, position):
    store(contacts, block, row, load(contacts, block, row) + value)
    store(contacts, block, row + apart, load(contacts, block, row + apart) + value * position)


@template
def _store_sums(block, contacts, row, scale, plain, first, second):
    store(contacts, block, row, scale * plain)
    store(contacts, block, row + 1, scale * first)
    store(contacts, block, row + 2, scale * second)


@fused
def average_laminae(fraction, params, work):
    """Include the laminae's loads of this instant, with stress risers, in their running means to the exponents of both rings (ISO/TS 16281).

    The means are those of `bearing_sim.physics.lamina_life.add_lamina_powers`; the first instant starts them.  Laminae are as many as the scene
    wants for its life, whatever the number of slices that carry the roller: their loads follow from its penetration and lean.

    Parameters
    ----------
    fraction : weight of this instant.
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    laminae, contacts, means = params.life.laminae, work.contacts, work.lamina_means
    number, blocks, reach = laminae.crown.shape[0], work.rollers.shape[0], laminae.positions[laminae.crown.shape[0] - 1]
    part, damping = params.raceways.stiffness / number, params.ring.contact_damping
    started = 0.0
    for k in range(number):
        started += means[0, k] + means[1, k]
    weight = fraction if started > 0.0 else 1.0  # the end laminae of a crowned roller may never be loaded
    for k in range(number):
        means[0, k] -= weight * means[0, k]
        means[1, k] -= weight * means[1, k]
    share = weight / params.rollers.count
    for block in range(blocks):
        present = load(work.rollers, block, ROLLER.present)
        if touches(block, contacts, reach):
            for k in range(number):
                inner = laminae.risers[k] * _lamina_load(block, k, contacts, laminae, part, damping)
                means[0, k] += share * total(present * (inner * inner) * (inner * inner))
        if touches(blocks + block, contacts, reach):
            for k in range(number):
                outer = laminae.risers[k] * _lamina_load(blocks + block, k, contacts, laminae, part, damping)
                means[1, k] += share * total(present * (outer * outer) * (outer * outer) * square_root(outer))


@fused
def _lamina_load(block, k, contacts, laminae, part, damping):
    """Return the normal force of lamina k of a block of contacts [N]."""
    x = laminae.positions[k]
    depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - (laminae.crown[k] + laminae.highest)
    rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
    return damped_slice(depth, rate, part, damping)[0]


@fused
def _slice_load(block, k, contacts, slices, part, damping):
    """Return the normal force of slice k of a block of contacts [N]."""
    x = slices.positions[k]
    depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - slices.crown[k]
    rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
    return damped_slice(depth, rate, part, damping)[0]


@kernel
def _largest_slices(first, params, work):
    """Return the largest load of any slice on a raceway whose first block is ``first``, and of any end slice [N]."""
    slices, contacts = params.slices, work.contacts
    number, damping = slices.positions.shape[0], params.ring.contact_damping
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

    Parameters
    ----------
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    raceways, slices, length = params.raceways, params.slices.positions.shape[0], params.rollers.length
    inner_radius, outer_radius, modulus = raceways.inner_curvature_radius, raceways.outer_curvature_radius, raceways.reduced_modulus
    inner, inner_edge = _largest_slices(0, params, work)
    outer, outer_edge = _largest_slices(work.rollers.shape[0], params, work)
    return (
        hertz_pressure(inner, slices, length, inner_radius, modulus),
        hertz_pressure(outer, slices, length, outer_radius, modulus),
        hertz_pressure(inner_edge, slices, length, inner_radius, modulus),
        hertz_pressure(outer_edge, slices, length, outer_radius, modulus),
    )
