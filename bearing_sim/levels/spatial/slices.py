# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Contact of rollers and raceways along the rollers: forces with their moments, means for a life by laminae, and pressures.

Deng 2017, eq. 3 to 8: a slice of width dx carries q dx = K/L delta^(10/9) dx, delta = delta_0 + lean x - C(x), damped as a whole contact is.  The
integral over the roller is a sum over *points*, each a whole contact with the load per length there that counts by its fraction of the roller's
length, and with its own traction: its sliding speed follows from how fast the axes skew against each other, the rolling speed is the same for all.

By default the points are those of a Gauss quadrature on the part of the roller that bears, so that no point is lost on ends without load.  The
substitution x = (3 s - s^3)/2 takes the root of the stiffness at both ends of that part away.  The ends follow from the profile's law; they have
to be continuous in penetration and lean, or implicit steps would not converge.  A table of a profile is cut into equal slices, and a
scene can ask for them: Deng's own sum.

Left out: sliding along the axis of a skewed roller, and the difference of circumference along a crowned one.
"""

import math

from bearing_sim.levels.spatial.state import D_DEPTH, D_RATE, DROP, FRACTION, INNER, OUTER, POSITION, ROLLER, SLICED, SLICED_ROWS
from bearing_sim.model.params import LOGARITHMIC, SLICED_EQUALLY, STRAIGHT
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import exponential, logarithm, ninth_root
from bearing_sim.numerics.simd import LANES, add, highest, larger, load, magnitude, smaller, spread, square_root, store, total, where_positive
from bearing_sim.physics.contact import CONTACT, TINY, damped_line_contact, damping_factor, elastic_line_contact, hertz_pressure
from bearing_sim.physics.film import resist_rolling_by_rows
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import ROLLER as RING

_NEWTON_STEPS = 2  # towards the ends of the part that bears: what is left is at most 4 % of it
_LEVEL = 1e-15  # m; a depth that changes by less over half a roller has no end
_NEAR_END = 1e-12  # least 1 - s^2: nearer to its end the logarithmic profile counts as no deeper
_LEAST_PART = 1e-6  # of a roller that bears, or does not
_SOFT_EDGE = 2e-8  # m; assumption, far below any film: until it is so deep a slice bears in part, so that the part does not jump
_LEAST_BEND, _LEAST_SLOPE = 0.2, 0.05  # bounds of the start and of the slope of Newton's method, from -1 to 1 of the roller


@fused
def touches(block, contacts, reach):
    """Return whether any point of a block of rollers may be loaded.

    Parameters
    ----------
    reach : farthest from the roller's middle that a point may be [m].
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
def _part_of_straight(depth, slope):
    """Return both ends of the part that bears of a roller without a profile; parameters and results as of `_loaded_part`."""
    end = -depth / where_positive(magnitude(slope) - _LEVEL, slope, _LEVEL)
    end = smaller(larger(end, -1.0), 1.0)
    return where_positive(depth - slope, -1.0, end), where_positive(depth + slope, 1.0, end)


@fused
def _part_of_logarithmic(depth, slope):
    """Return both ends of the part that bears of ISO's logarithmic profile; parameters and results as of `_loaded_part`, over the profile's scale.

    They are the roots of 1 - exp(-(depth + slope s)) - s^2, which is concave and regular up to s = 1.  Newton's method starts from
    the cubic that the depth follows at its largest, so that the ends are smooth in depth and slope.
    """
    top = slope / (1.0 + square_root(1.0 + slope * slope))  # where the depth is largest
    square = top * top
    rest = larger(1.0 - square, _NEAR_END)
    half = square_root(larger(depth + slope * top + logarithm(rest), 0.0) / (1.0 + square)) * rest
    bend = half * top * (2.0 + (2.0 / 3.0) * square) / (rest * (1.0 + square))
    left = larger(top - half / square_root(larger(1.0 - bend, _LEAST_BEND)), -1.0)
    right = smaller(top + half / square_root(larger(1.0 + bend, _LEAST_BEND)), 1.0)
    for _ in range(_NEWTON_STEPS):
        fading = exponential(-(depth + slope * left))
        left -= (1.0 - fading - left * left) / larger(slope * fading - 2.0 * left, _LEAST_SLOPE)
        left = larger(smaller(left, top), -1.0)
        fading = exponential(-(depth + slope * right))
        right -= (1.0 - fading - right * right) / smaller(slope * fading - 2.0 * right, -_LEAST_SLOPE)
        right = smaller(larger(right, top), 1.0)
    return left, right


@fused
def _right_end_of_arcs(depth, slope, straight, bend):
    """Return the right end of the part that bears of a straight line between two arcs; see `_loaded_part`.

    Parameters
    ----------
    straight : where the arcs begin, in units of half the roller's length.
    bend : half the second derivative of the drop along an arc, in those units [m]; the arc is taken as a parabola.
    """
    per_bend, inner, outer = 0.5 / bend, depth + slope * straight, depth - slope * straight
    on_right = straight + (slope + square_root(larger(slope * slope + 4.0 * bend * inner, 0.0))) * per_bend
    on_left = (slope + square_root(larger(slope * slope + 4.0 * bend * outer, 0.0))) * per_bend - straight
    between = -depth / where_positive(magnitude(slope) - _LEVEL, slope, _LEVEL)
    end = where_positive(inner, on_right, where_positive(slope, on_right, where_positive(outer, between, on_left)))
    return smaller(larger(end, -1.0), 1.0)


@fused
def _loaded_part(depth, slope, slices):
    """Return both ends of the part of a roller that bears, from -1 to 1 (lanes); equal where none does.

    Parameters
    ----------
    depth, slope : penetration in the roller's middle without its profile, and its change over half the roller's length [m].
    slices : `bearing_sim.model.params.Slices`.
    """
    if slices.profile == LOGARITHMIC:
        return _part_of_logarithmic(depth * (1.0 / slices.scale), slope * (1.0 / slices.scale))
    if slices.profile == STRAIGHT:
        return _part_of_straight(depth, slope)
    bend = 0.5 * slices.half_length * slices.half_length / slices.scale
    return -_right_end_of_arcs(depth, -slope, slices.straight, bend), _right_end_of_arcs(depth, slope, slices.straight, bend)


@fused
def _drop(place, slices):
    """Return the drop of the profile [m] at a place from -1 to 1 (lanes)."""
    if slices.profile == LOGARITHMIC:
        return -slices.scale * logarithm(larger(1.0 - place * place, _NEAR_END))
    if slices.profile == STRAIGHT:
        return spread(0.0)
    arc = larger(magnitude(place) - slices.straight, 0.0) * slices.half_length
    return arc * arc / (slices.scale + square_root(larger(slices.scale * slices.scale - arc * arc, 0.0)))


@fused
def deepest(block, contacts, slices):
    """Return how much deeper a block of contacts is where it is deepest than in the rollers' middles without their profile [m] (lanes)."""
    lean = load(contacts, block, SLICED.lean)
    if slices.profile == SLICED_EQUALLY:
        largest = lean * slices.positions[0] - slices.crown[0]
        for k in range(1, slices.positions.shape[0]):
            largest = larger(largest, lean * slices.positions[k] - slices.crown[k])
        return largest
    slope = magnitude(lean) * slices.half_length
    if slices.profile == LOGARITHMIC:
        slope = slope * (1.0 / slices.scale)
        top = slope / (1.0 + square_root(1.0 + slope * slope))
        return slices.scale * (slope * top + logarithm(larger(1.0 - top * top, _NEAR_END)))
    if slices.profile == STRAIGHT:
        return slope
    place = smaller(slices.straight + slope * (slices.scale / (slices.half_length * slices.half_length)), 1.0)
    return slope * place - _drop(place, slices)


@fused
def _place_on_loaded_part(block, contacts, slices, points, first):
    """Write the points of a quadrature on the part that bears; parameters as of `place_points`."""
    left, right = _loaded_part(load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.lean) * slices.half_length, slices)
    middle, half = 0.5 * (left + right), 0.5 * (right - left)
    store(contacts, block, SLICED.left, left)
    store(contacts, block, SLICED.right, right)
    for k in range(slices.abscissae.shape[0]):
        place = middle + half * slices.abscissae[k]
        store(points, first + k, POSITION, place * slices.half_length)
        store(points, first + k, FRACTION, half * slices.weights[k])
        store(points, first + k, DROP, _drop(place, slices))


@kernel
def place_points(block, contacts, slices, points, first):
    """Write where along the roller a block of contacts is evaluated.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration and lean go in, ends of the part that bears come out.
    slices : `bearing_sim.model.params.Slices`.
    points : rows `bearing_sim.physics.contact.CONTACT` and, behind them, those of `bearing_sim.levels.spatial.state`; takes position, fraction of
        the roller's length and drop of the profile.
    first : of the block's points.
    """
    if slices.profile != SLICED_EQUALLY:
        _place_on_loaded_part(block, contacts, slices, points, first)
        return
    for k in range(slices.positions.shape[0]):
        store(points, first + k, POSITION, slices.positions[k])
        store(points, first + k, FRACTION, 1.0 / slices.positions.shape[0])
        store(points, first + k, DROP, slices.crown[k])


@kernel
def _press_points(block, contacts, points, first, count, stiffness, damping, with_traction):
    """Write normal force, tilting moment and their derivatives of a block of contacts, and what traction needs of its points.

    Parameters
    ----------
    contacts : rows `SLICED`; penetration, lean, rates and speeds go in.
    points, first : as of `place_points`.
    count : of points.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and `bearing_sim.physics.contact.ContactDamping`.
    with_traction : constant, whether anything is written into ``points``.
    """
    penetration, rate = load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.rate)
    lean, lean_rate = load(contacts, block, SLICED.lean), load(contacts, block, SLICED.lean_rate)
    sliding, sliding_lean = load(contacts, block, SLICED.sliding), load(contacts, block, SLICED.sliding_lean)
    rolling = load(contacts, block, SLICED.rolling)
    q_0, q_1 = spread(0.0), spread(0.0)
    k_0, k_1, k_2 = spread(0.0), spread(0.0), spread(0.0)
    d_0, d_1, d_2 = spread(0.0), spread(0.0), spread(0.0)
    for k in range(first, first + count):
        x, fraction = load(points, k, POSITION), load(points, k, FRACTION)
        depth = penetration + lean * x - load(points, k, DROP)
        whole, stiff, damped = damped_line_contact(depth, rate + lean_rate * x, stiffness, damping)
        q, stiff, damped = whole * fraction, stiff * fraction, damped * fraction
        q_x, stiff_x, damped_x = q * x, stiff * x, damped * x
        q_0 += q
        q_1 += q_x
        k_0 += stiff
        k_1 += stiff_x
        k_2 += stiff_x * x
        d_0 += damped
        d_1 += damped_x
        d_2 += damped_x * x
        if with_traction:
            store(points, k, CONTACT.load, whole)
            store(points, k, CONTACT.rolling, rolling)
            store(points, k, CONTACT.sliding, sliding + sliding_lean * x)
            store(points, k, D_DEPTH, stiff)
            store(points, k, D_RATE, damped)
    store(contacts, block, SLICED.load, q_0)
    store(contacts, block, SLICED.tilting, q_1)
    _store_sums(block, contacts, SLICED.stiffness, k_0, k_1, k_2)
    _store_sums(block, contacts, SLICED.damping, d_0, d_1, d_2)


@kernel
def press_normally(block, contacts, slices, points, stiffness, damping):
    """Write normal force, tilting moment and their derivatives of a block of contacts, no traction.

    Parameters
    ----------
    contacts, slices, points : as of `place_points`; every block of contacts has its points, whether it bears or not.
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and `bearing_sim.physics.contact.ContactDamping`.
    """
    if not touches(block, contacts, slices.half_length):
        _clear(block, contacts, SLICED.of_force)
        return
    first = block * slices.points
    place_points(block, contacts, slices, points, first)
    _press_points(block, contacts, points, first, slices.points, stiffness, damping, False)


@kernel
def press_outer_points(law, approaches, loads):
    """Write the elastic forces of all rollers on the outer raceway, as `bearing_sim.physics.ring_balance.press_outwards` does.

    Parameters
    ----------
    law : contacts, points, slices, stiffness and damping, as of `press_points`; rates of the outer contacts are zeros.
    approaches : penetrations in the middles of the rollers [m], shape (Z,).
    loads : takes what follows.
    """
    contacts, points, slices, stiffness, damping = law
    blocks = contacts.shape[0] // 2
    for j in range(loads.shape[1]):
        contacts[blocks + j // LANES, SLICED.penetration, j % LANES] = approaches[j]
    for block in range(blocks, 2 * blocks):
        press_normally(block, contacts, slices, points, stiffness, damping)
    for j in range(loads.shape[1]):
        block, lane = blocks + j // LANES, j % LANES
        force = contacts[block, SLICED.load, lane]
        loads[LOAD.approach, j], loads[LOAD.slope, j] = approaches[j], contacts[block, SLICED.stiffness, lane]
        loads[LOAD.inner, j], loads[LOAD.outer, j] = force, force


@kernel
def soften_points(blocks, resists, contacts, bending):
    """Let the derivatives of the outer contacts be those of a ring that gives way; ``bending`` is None of a rigid ring.

    Of a further penetration the contact takes its share, and of a further lean the ring gives way by what the lean presses it; see also
    `bearing_sim.levels.common.bending.soften_contacts`.

    Parameters
    ----------
    blocks : of rollers.
    resists : whether contacts resist rolling.
    contacts : all have been pressed, and have their tractions.
    """
    if bending is None:
        return
    for j in range(bending.rollers.shape[1]):
        block, lane, share = blocks + j // LANES, j % LANES, bending.rollers[RING.share, j]
        stiffness = contacts[block, SLICED.stiffness, lane]
        if share == 1.0 or stiffness == 0.0:
            continue
        by_lean = (1.0 - share) * contacts[block, SLICED.stiffness + 1, lane] / stiffness
        for first in (SLICED.stiffness, SLICED.damping):
            contacts[block, first + 2, lane] -= by_lean * contacts[block, first + 1, lane]
            contacts[block, first + 1, lane] *= share
            contacts[block, first, lane] *= share
        for first in (SLICED.of_force, SLICED.of_skewing, SLICED.of_resistance):
            if first != SLICED.of_resistance or resists:
                for by in (first, first + 3):
                    contacts[block, by + 1, lane] -= by_lean * contacts[block, by, lane]
                    contacts[block, by, lane] *= share


@fused
def press_points(contacts, points, first_points, slices, stiffness, damping):
    """Write normal forces, tilting moments and their derivatives of all contacts, and what traction needs of the points that may bear.

    Parameters
    ----------
    contacts, slices : as of `place_points`; rates and speeds go in, too.
    points : those of contacts that may bear follow each other, those with the inner raceway first.
    first_points : takes the first point of each block of contacts, -1 where it bears nothing, int64, shape (blocks,).
    stiffness, damping : of the whole contact, K [N/m^(10/9)] and `bearing_sim.physics.contact.ContactDamping`.

    Returns
    -------
    middle, end : of the points, where those of the outer raceway begin and where they end.
    """
    blocks, count, end, middle = contacts.shape[0], slices.points, 0, 0
    for block in range(blocks):
        if touches(block, contacts, slices.half_length):
            first_points[block] = end
            place_points(block, contacts, slices, points, end)
            _press_points(block, contacts, points, end, count, stiffness, damping, True)
            end += count
        else:
            first_points[block] = -1
            _clear(block, contacts, SLICED_ROWS)
        if block == blocks // 2 - 1:
            middle = end
    return middle, end


@fused
def sum_tractions(contacts, points, first_points, count):
    """Write tractions, skewing moments and their derivatives of all contacts from those of their points; parameters as of `press_points`."""
    for block in range(contacts.shape[0]):
        first = first_points[block]
        if first < 0:
            continue
        t_0, t_1 = spread(0.0), spread(0.0)
        k_0, k_1, k_2 = spread(0.0), spread(0.0), spread(0.0)
        d_0, d_1, d_2 = spread(0.0), spread(0.0), spread(0.0)
        s_0, s_1, s_2, u_0, u_1 = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
        for k in range(first, first + count):
            x, fraction, d_load = load(points, k, POSITION), load(points, k, FRACTION), load(points, k, CONTACT.d_load)
            force, d_depth, d_rate = fraction * load(points, k, CONTACT.force), d_load * load(points, k, D_DEPTH), d_load * load(points, k, D_RATE)
            d_sliding, d_rolling = fraction * load(points, k, CONTACT.d_sliding), fraction * load(points, k, CONTACT.d_rolling)
            d_depth_x, d_rate_x, d_sliding_x = d_depth * x, d_rate * x, d_sliding * x
            t_0 += force
            t_1 += force * x
            k_0 += d_depth
            k_1 += d_depth_x
            k_2 += d_depth_x * x
            d_0 += d_rate
            d_1 += d_rate_x
            d_2 += d_rate_x * x
            s_0 += d_sliding
            s_1 += d_sliding_x
            s_2 += d_sliding_x * x
            u_0 += d_rolling
            u_1 += d_rolling * x
        store(contacts, block, SLICED.force, t_0)
        store(contacts, block, SLICED.skewing, t_1)
        _store_changes(block, contacts, SLICED.of_force, k_0, k_1, d_0, d_1)
        _store_changes(block, contacts, SLICED.of_skewing, k_1, k_2, d_1, d_2)
        _store_sums(block, contacts, SLICED.d_sliding, s_0, s_1, s_2)
        store(contacts, block, SLICED.d_rolling, u_0)
        store(contacts, block, SLICED.d_rolling + 1, u_1)


@fused
def _find_part(block, contacts, slices):
    """Write which part of the rollers of a block of contacts bears, and the gap beside it."""
    depth, lean = load(contacts, block, SLICED.penetration), load(contacts, block, SLICED.lean)
    off = spread(0.0)
    if slices.profile == SLICED_EQUALLY:
        count, bears = slices.positions.shape[0], spread(0.0)
        for k in range(count):
            there = depth + lean * slices.positions[k] - slices.crown[k]
            pressed = larger(there, 0.0)
            bears += smaller(pressed * (1.0 / _SOFT_EDGE), 1.0)
            off += pressed - there
        store(contacts, block, SLICED.part, larger(bears * (1.0 / count), _LEAST_PART))
        store(contacts, block, SLICED.gap, off / larger(count - bears, 1.0))
        return
    left, right, slope = load(contacts, block, SLICED.left), load(contacts, block, SLICED.right), lean * slices.half_length
    before, behind = 0.5 * (left - 1.0), 0.5 * (right + 1.0)  # middles of the parts that do not bear
    off += (1.0 + left) * (_drop(before, slices) - depth - slope * before) + (1.0 - right) * (_drop(behind, slices) - depth - slope * behind)
    part = 0.5 * (right - left)
    beside = 1.0 - part
    store(contacts, block, SLICED.part, larger(part, _LEAST_PART))
    store(contacts, block, SLICED.gap, where_positive(beside - _LEAST_PART, larger(off, 0.0) / (2.0 * larger(beside, _LEAST_PART)), 0.0))


@kernel
def resist(contacts, slices, resistance, films):
    """Write resistances to rolling of all contacts and their derivatives; they have been pressed on their points.

    A contact resists on all its length, with what the film beside the part that bears adds (`bearing_sim.physics.film`), so evenly that its moment is
    left out.

    Parameters
    ----------
    contacts, slices : as of `place_points`.
    resistance : `bearing_sim.physics.film.RollingResistance`.
    films : `bearing_sim.physics.mixed.FilmState`.
    """
    for block in range(contacts.shape[0]):
        _find_part(block, contacts, slices)
    resist_rolling_by_rows(SLICED, contacts, contacts.shape[0] // 2, True, resistance, films)
    for block in range(contacts.shape[0]):
        d_load = load(contacts, block, SLICED.resistance_d_load)
        k_0, k_1 = d_load * load(contacts, block, SLICED.stiffness), d_load * load(contacts, block, SLICED.stiffness + 1)
        d_0, d_1 = d_load * load(contacts, block, SLICED.damping), d_load * load(contacts, block, SLICED.damping + 1)
        _store_changes(block, contacts, SLICED.of_resistance, k_0, k_1, d_0, d_1)


@kernel
def _store_sums(block, contacts, row, plain, first, second):
    store(contacts, block, row, plain)
    store(contacts, block, row + 1, first)
    store(contacts, block, row + 2, second)


@kernel
def _store_changes(block, contacts, row, by_depth, by_lean, by_rate, by_lean_rate):
    store(contacts, block, row, by_depth)
    store(contacts, block, row + 1, by_lean)
    store(contacts, block, row + 3, by_rate)
    store(contacts, block, row + 4, by_lean_rate)


@kernel
def damped_power(block, moving, contacts, points, first_points, count, stiffness, damping):
    """Return the power that the damping of a block of contacts takes [W] (lanes).

    Parameters
    ----------
    moving : speed of the raceway outwards, against which it works as well [m/s] (lanes).
    block, contacts, points, first_points, count, stiffness, damping : as of `press_points`, which has been called.
    """
    lost, first = spread(0.0), first_points[block]
    for k in range(max(first, 0), first + count if first >= 0 else 0):
        x = load(points, k, POSITION)
        depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - load(points, k, DROP)
        rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
        whole, _, _ = damped_line_contact(depth, rate, stiffness, damping)
        lost += load(points, k, FRACTION) * ((whole - elastic_line_contact(depth, stiffness)) * (rate + moving))
    return lost


@fused
def average_laminae(turned, interval, params, work):
    """Include the laminae's loads, with stress risers, in their running means to the exponents of both rings (ISO/TS 16281).

    The means are those of `bearing_sim.physics.lamina_life.add_lamina_powers`, each the sum over the lanes of ``work.lamina_powers``.  The
    end of a step counts if the cage has turned by ``interval`` since the last one that did, because all short steps would cost too much.  That
    angle counts by the mean of the powers at both its ends, see `bearing_sim.levels.common.observation.average_moments`. Laminae are as many as the
    scene wants for its life, whatever the number of slices that carry the
    roller: their loads follow from its penetration and lean.

    Parameters
    ----------
    turned : by which the cage turned in this step [rad], not negative.
    interval : least angle between two instants that count [rad].
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    powers, now, last = work.lamina_powers, work.lamina_now, work.lamina_last
    number = powers.shape[1]
    work.lamina_turn[0] += turned
    if not work.lamina_turn[0] >= interval:
        return
    weight = 1.0 - math.exp(-work.lamina_turn[0] / (2.0 * math.pi))
    work.lamina_turn[0] = 0.0
    _write_lamina_powers(params, work)
    for ring in (INNER, OUTER):
        for k in range(number):
            mean, present = load(powers, ring, k), load(now, ring, k)
            store(powers, ring, k, mean + weight * (0.5 * (load(last, ring, k) + present) - mean))
            store(last, ring, k, present)


@fused
def _write_lamina_powers(params, work):
    """Write the powers of the laminae's loads at this instant into ``work.lamina_now``, means over the rollers as sums over the lanes."""
    laminae, contacts, powers = params.life.laminae, work.contacts, work.lamina_now
    number, blocks, reach = laminae.crown.shape[0], work.rollers.shape[0], laminae.positions[laminae.crown.shape[0] - 1]
    for k in range(number):
        store(powers, INNER, k, spread(0.0))
        store(powers, OUTER, k, spread(0.0))
    part, damping, share = params.raceways.stiffness / number, params.raceways.damping, 1.0 / params.rollers.count
    for block in range(blocks):
        present = load(work.rollers, block, ROLLER.present) * share
        if touches(block, contacts, reach):
            for k in range(number):
                depth, factor = _lamina_depth(block, k, contacts, laminae, damping)
                # q^4 = (K/N)^4 delta^4 delta^(4/9)
                inner, root = depth * factor * (laminae.risers[k] * part), ninth_root(larger(depth, TINY))
                inner, root = inner * inner, root * root
                add(powers, INNER, k, present * (inner * inner) * (root * root))
        if touches(blocks + block, contacts, reach):
            for k in range(number):
                depth, factor = _lamina_depth(blocks + block, k, contacts, laminae, damping)
                # q^(9/2) = (K/N)^(9/2) delta^5
                stiffness, square, factor_square = laminae.risers[k] * part, depth * depth, factor * factor
                scale = (stiffness * stiffness) * (stiffness * stiffness) * math.sqrt(stiffness)
                outer = square * square * depth * (factor_square * factor_square) * square_root(factor)
                add(powers, OUTER, k, present * outer * scale)


@kernel
def sum_lamina_powers(work):
    """Write the means of `average_laminae` into ``work.lamina_means``."""
    for k in range(work.lamina_means.shape[1]):
        work.lamina_means[INNER, k] = total(load(work.lamina_powers, INNER, k))
        work.lamina_means[OUTER, k] = total(load(work.lamina_powers, OUTER, k))


@kernel
def _lamina_depth(block, k, contacts, laminae, damping):
    """Return the depth of lamina k of a block of contacts [m] and the factor of its damping, neither below 0."""
    x = laminae.positions[k]
    depth = load(contacts, block, SLICED.penetration) + load(contacts, block, SLICED.lean) * x - (laminae.crown[k] + laminae.highest)
    rate = load(contacts, block, SLICED.rate) + load(contacts, block, SLICED.lean_rate) * x
    depth = larger(depth, 0.0)
    per_rate, _ = damping_factor(depth, damping)
    return depth, larger(1.0 + per_rate * rate, 0.0)


@kernel
def _largest_laminae(first, params, work):
    """Return the largest load of any lamina on a raceway whose first block is ``first``, and of any end lamina [N]."""
    laminae, contacts = params.life.laminae, work.contacts
    number, damping = laminae.crown.shape[0], params.raceways.damping
    part, anywhere, at_ends = params.raceways.stiffness / number, spread(0.0), spread(0.0)
    for block in range(work.rollers.shape[0]):
        present = load(work.rollers, block, ROLLER.present)
        for k in range(number):
            depth, factor = _lamina_depth(first + block, k, contacts, laminae, damping)
            pressed = present * (part * factor * depth * ninth_root(larger(depth, TINY)))
            anywhere = larger(anywhere, pressed)
            if k == 0 or k == number - 1:
                at_ends = larger(at_ends, pressed)
    return highest(anywhere), highest(at_ends)


@kernel
def lamina_pressures(params, work):
    """Return the largest pressure of any lamina on inner and outer raceway, and of any end lamina on both [Pa].

    Laminae are those of the life (`bearing_sim.physics.lamina_life.Laminae`), whatever the number of slices that carry the roller.

    Parameters
    ----------
    params, work : of the level; the right-hand side has been evaluated into ``work``.
    """
    raceways, laminae, length = params.raceways, params.life.laminae.crown.shape[0], params.rollers.length
    inner_radius, outer_radius, modulus = raceways.inner_curvature_radius, raceways.outer_curvature_radius, raceways.reduced_modulus
    inner, inner_edge = _largest_laminae(0, params, work)
    outer, outer_edge = _largest_laminae(work.rollers.shape[0], params, work)
    return (
        hertz_pressure(inner, laminae, length, inner_radius, modulus),
        hertz_pressure(outer, laminae, length, outer_radius, modulus),
        hertz_pressure(inner_edge, laminae, length, inner_radius, modulus),
        hertz_pressure(outer_edge, laminae, length, outer_radius, modulus),
    )
