# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Contact of sliced rollers and raceways: normal force and traction of every slice, summed with their moments.

Deng 2017, eq. 3 to 8: a slice of width L/N carries q = (K/N) delta_k^(10/9), delta_k = delta - C_k + lean x_k, damped as a whole
contact is.  Traction takes a piece of a few slices for a whole contact with the piece's mean load per length, and gives it its share
of that: equal slices add up to what `bearing_sim.kernels.traction` gives.  Pieces because traction goes almost with the load, and
costs three times what the load costs; a piece of one slice is Deng's own sum.  The sliding speed of a piece follows from how fast
the axes skew against each other; the rolling speed is the same for all.

Left out: sliding along the axis of a skewed roller, and the difference of circumference along a crowned one.
"""

from typing import NamedTuple

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.contact import EXPONENT, TINY
from bearing_sim.kernels.contact_rows import CONTACT
from bearing_sim.kernels.elementary import ninth_root
from bearing_sim.kernels.lanes import larger, load, magnitude, spread, store, total, where_positive

# rows of pieces behind those of a contact: slopes of a piece's normal force
_BY_DEPTH, _BY_LEAN, _BY_RATE, _BY_LEAN_RATE = range(len(CONTACT), len(CONTACT) + 4)
PIECE_ROWS = len(CONTACT) + 4


class SlicedRow(NamedTuple):
    """Rows of a sliced contacts array: all blocks of inner contacts, then all of outer ones.  Moments are sums of forces times x."""

    load: int = 0  # normal force Q [N]
    rolling: int = 1  # mean speed u of both surfaces relative to the contact [m/s]
    sliding: int = 2  # surface-speed difference du in the middle, raceway less roller [m/s]
    force: int = 3  # traction T on the roller, with the sign of du [N]
    tilting: int = 4  # moment of the normal forces [N m]
    skewing: int = 5  # moment of the tractions [N m]
    penetration: int = 6  # in the middle [m]
    rate: int = 7  # its time derivative [m/s]
    lean: int = 8  # slope of the penetration along the axis
    lean_rate: int = 9  # its time derivative [1/s]
    sliding_lean: int = 10  # slope of du along the axis [1/s]
    stiffness: int = 11  # from here on sums over slices of derivatives times 1, x and x^2: of q by penetration
    damping: int = 14  # of q by its rate
    of_force: int = 17  # slopes of the traction by penetration and lean, three rows on by their rates
    of_skewing: int = 22  # slopes of its moment by the same
    by_sliding: int = 27  # sums of dT/d(du) times 1, x and x^2
    by_rolling: int = 30  # of dT/du times 1 and x
    pumping: int = 32  # from here on written only where oil is pumped back: its resistance F_R [N]
    pumping_moment: int = 33  # its moment [N m]
    of_pumping: int = 34  # slopes by penetration and lean, three rows on by their rates
    of_pumping_moment: int = 39
    pumping_by_rolling: int = 44  # sums of dF_R/du times 1 and x


SLICED = SlicedRow()
SLICED_ROWS = 46


@template
def slice_force(depth, rate, stiffness, damping):
    """Return load of a slice [N], the root K delta^(1/9) [N/m], the damping factor, and 1 where they press (lanes).

    Parameters
    ----------
    depth, rate : penetration of the slice [m] and its time derivative [m/s].
    stiffness : K/N [N/m^(10/9)].
    damping : a [s/m].
    """
    root = stiffness * ninth_root(larger(depth, TINY))
    factor = 1.0 + damping * rate
    pressed = where_positive(factor, where_positive(depth, 1.0, 0.0), 0.0)
    return pressed * root * depth * factor, root, factor, pressed


@kernel
def touches(block, contacts, reach):
    """Return whether any slice of a block of rollers may be loaded.

    Parameters
    ----------
    reach : place of the last slice [m].
    """
    deepest = load(contacts, block, SLICED.penetration) + magnitude(load(contacts, block, SLICED.lean)) * reach
    return total(where_positive(deepest, 1.0, 0.0)) > 0.0


@kernel
def _clear(block, contacts, rows):
    """Write that nothing is loaded."""
    store(contacts, block, SLICED.load, 0.0)
    store(contacts, block, SLICED.force, 0.0)
    store(contacts, block, SLICED.tilting, 0.0)
    store(contacts, block, SLICED.skewing, 0.0)
    for row in range(SLICED.stiffness, rows):
        store(contacts, block, row, 0.0)


@kernel
def normal_slices(block, contacts, slices, stiffness, damping):
    """Write normal force, tilting moment and their slopes of a block of contacts, no traction.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration, lean and their rates go in.
    slices : `bearing_sim.params.Slices`.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and a [s/m].
    """
    count = slices.places.shape[0]
    if not touches(block, contacts, slices.places[count - 1]):
        _clear(block, contacts, SLICED.of_force)
        return
    penetration, rate = load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.rate)
    lean, lean_rate = load(contacts, block, SLICED.lean), load(contacts, block, SLICED.lean_rate)
    part = stiffness / count
    q_0, q_1 = spread(0.0), spread(0.0)
    k_0, k_1, k_2 = spread(0.0), spread(0.0), spread(0.0)
    d_0, d_1, d_2 = spread(0.0), spread(0.0), spread(0.0)
    for k in range(count):
        x, drop = slices.places[k], slices.crown[k]
        depth = penetration + lean * x - drop
        q, root, factor, pressed = slice_force(depth, rate + lean_rate * x, part, damping)
        by_depth, by_rate = pressed * root * factor, pressed * root * depth
        by_depth_x, by_rate_x = by_depth * x, by_rate * x
        q_0 += q
        q_1 += q * x
        k_0 += by_depth
        k_1 += by_depth_x
        k_2 += by_depth_x * x
        d_0 += by_rate
        d_1 += by_rate_x
        d_2 += by_rate_x * x
    store(contacts, block, SLICED.load, q_0)
    store(contacts, block, SLICED.tilting, q_1)
    store(contacts, block, SLICED.stiffness, EXPONENT * k_0)
    store(contacts, block, SLICED.stiffness + 1, EXPONENT * k_1)
    store(contacts, block, SLICED.stiffness + 2, EXPONENT * k_2)
    store(contacts, block, SLICED.damping, damping * d_0)
    store(contacts, block, SLICED.damping + 1, damping * d_1)
    store(contacts, block, SLICED.damping + 2, damping * d_2)


@kernel
def load_pieces(contacts, pieces, slices, stiffness, damping):
    """Write normal forces, tilting moments and their slopes of all contacts, and what traction needs to know of their pieces.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration, lean, rates and speeds go in.
    pieces : rows `bearing_sim.kernels.contact_rows.CONTACT` and, behind them, `_BY_DEPTH` and the like; those of a block of
        contacts follow each other.  A piece is a whole contact with the piece's load per length.
    slices : `bearing_sim.params.Slices`.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and a [s/m].
    """
    count, together, reach = slices.places.shape[0], slices.together, slices.places[slices.places.shape[0] - 1]
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
            q, by_depth, by_lean, by_rate, by_lean_rate = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
            if loaded:
                for k in range(first, end):
                    x = slices.places[k]
                    depth = penetration + lean * x - slices.crown[k]
                    load_k, root, factor, pressed = slice_force(depth, rate + lean_rate * x, part, damping)
                    stiff, damped = pressed * root * factor, pressed * root * depth
                    stiff_x, damped_x = stiff * x, damped * x
                    q += load_k
                    q_1 += load_k * x
                    by_depth += stiff
                    by_lean += stiff_x
                    k_2 += stiff_x * x
                    by_rate += damped
                    by_lean_rate += damped_x
                    d_2 += damped_x * x
            q_0 += q
            k_0 += by_depth
            k_1 += by_lean
            d_0 += by_rate
            d_1 += by_lean_rate
            store(pieces, piece, CONTACT.load, q * (count / (end - first)))
            store(pieces, piece, CONTACT.rolling, rolling)
            store(pieces, piece, CONTACT.sliding, sliding + sliding_lean * (0.5 * (slices.places[first] + slices.places[end - 1])))
            store(pieces, piece, _BY_DEPTH, EXPONENT * by_depth)
            store(pieces, piece, _BY_LEAN, EXPONENT * by_lean)
            store(pieces, piece, _BY_RATE, damping * by_rate)
            store(pieces, piece, _BY_LEAN_RATE, damping * by_lean_rate)
        store(contacts, block, SLICED.load, q_0)
        store(contacts, block, SLICED.tilting, q_1)
        _store_sums(block, contacts, SLICED.stiffness, EXPONENT, k_0, k_1, k_2)
        _store_sums(block, contacts, SLICED.damping, damping, d_0, d_1, d_2)


@kernel
def sum_tractions(contacts, pieces, slices):
    """Write tractions, skewing moments and their slopes of all contacts from those of the pieces; parameters as of `load_pieces`."""
    count, together, number = slices.places.shape[0], slices.together, pieces.shape[0] // contacts.shape[0]
    for block in range(contacts.shape[0]):
        t_0, t_1 = spread(0.0), spread(0.0)
        tk_0, tk_1, mk_0, mk_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        td_0, td_1, md_0, md_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        s_0, s_1, s_2, u_0, u_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        for which in range(number):
            first, piece = which * together, block * number + which
            end = min(first + together, count)
            share, place = (end - first) / count, 0.5 * (slices.places[first] + slices.places[end - 1])
            force, by_load = share * load(pieces, piece, CONTACT.force), load(pieces, piece, CONTACT.by_load)
            by_sliding, by_rolling = share * load(pieces, piece, CONTACT.by_sliding), share * load(pieces, piece, CONTACT.by_rolling)
            by_depth, by_lean = by_load * load(pieces, piece, _BY_DEPTH), by_load * load(pieces, piece, _BY_LEAN)
            by_rate, by_lean_rate = by_load * load(pieces, piece, _BY_RATE), by_load * load(pieces, piece, _BY_LEAN_RATE)
            t_0 += force
            t_1 += force * place
            tk_0 += by_depth
            tk_1 += by_lean
            td_0 += by_rate
            td_1 += by_lean_rate
            mk_0 += by_depth * place
            mk_1 += by_lean * place
            md_0 += by_rate * place
            md_1 += by_lean_rate * place
            s_0 += by_sliding
            s_1 += by_sliding * place
            s_2 += by_sliding * (place * place)
            u_0 += by_rolling
            u_1 += by_rolling * place
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
        _store_sums(block, contacts, SLICED.by_sliding, 1.0, s_0, s_1, s_2)
        store(contacts, block, SLICED.by_rolling, u_0)
        store(contacts, block, SLICED.by_rolling + 1, u_1)


@kernel
def sum_pumping(contacts, pieces, slices):
    """Write resistances of pumped oil, their moments and slopes of all contacts from those of the pieces, which have been written."""
    count, together, number = slices.places.shape[0], slices.together, pieces.shape[0] // contacts.shape[0]
    for block in range(contacts.shape[0]):
        for row in range(SLICED.pumping, SLICED_ROWS):
            store(contacts, block, row, 0.0)
        for which in range(number):
            first, piece = which * together, block * number + which
            end = min(first + together, count)
            share, place = (end - first) / count, 0.5 * (slices.places[first] + slices.places[end - 1])
            by_load = load(pieces, piece, CONTACT.pumping_by_load)
            force, by_rolling = share * load(pieces, piece, CONTACT.pumping), share * load(pieces, piece, CONTACT.pumping_by_rolling)
            _add_with_moment(block, contacts, SLICED.pumping, 1, force, place)
            _add_with_moment(block, contacts, SLICED.pumping_by_rolling, 1, by_rolling, place)
            _add_with_moment(block, contacts, SLICED.of_pumping, 5, by_load * load(pieces, piece, _BY_DEPTH), place)
            _add_with_moment(block, contacts, SLICED.of_pumping + 1, 5, by_load * load(pieces, piece, _BY_LEAN), place)
            _add_with_moment(block, contacts, SLICED.of_pumping + 3, 5, by_load * load(pieces, piece, _BY_RATE), place)
            _add_with_moment(block, contacts, SLICED.of_pumping + 4, 5, by_load * load(pieces, piece, _BY_LEAN_RATE), place)


@template
def _add_with_moment(block, contacts, row, apart, value, place):
    store(contacts, block, row, load(contacts, block, row) + value)
    store(contacts, block, row + apart, load(contacts, block, row + apart) + value * place)


@template
def _store_sums(block, contacts, row, scale, plain, first, second):
    store(contacts, block, row, scale * plain)
    store(contacts, block, row + 1, scale * first)
    store(contacts, block, row + 2, scale * second)
