# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Contact of a raceway with an aligned roller that has a profile: how much less it carries than a straight one, and on how much of its length.

A slice of the length dx carries q dx = K/L (delta - C(x))^(10/9) dx (ISO/TS 16281).  Level ``spatial`` sums it along each roller, because
rollers tilt there.  At the levels whose rollers stay aligned all that the profile does follows from the penetration; a bearing tabulates it once:

    Q = K delta^(10/9) G(delta),    G = mean over the length of x^(10/9),    x = max(0, 1 - C/delta),

with delta counted from where the profile is highest; and for what needs the load per length,

    psi = [G^3/(mean of x^(10/3))]^(1/2),   the fraction of the length that has the same sums of q and q^3 if it bears evenly,
    a,   the fraction of the length that bears,
    g,   the gap beside it; half of that part is closer to the raceway [m].

The table is even in t = sqrt(delta)/(sqrt(delta) + sqrt(delta_0)), in which G is smooth: near t = 0 the part that bears of a profile without a
straight part grows with the root of the penetration.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import ninth_root, power
from bearing_sim.numerics.simd import floor, gather, larger, load, smaller, square_root, store, where_positive
from bearing_sim.physics.contact import CONTACT, EXPONENT, TINY

_INTERVALS = 256
_SLICES = 8192
_STRAIGHT = 1e-12  # m; a profile that drops by less is straight
_ITERATIONS = 60
_LAST_CHANGE = 1e-5  # relative, of a depth; it leaves its square


class Profile(NamedTuple):
    """What the profile of an aligned roller does to its contacts."""

    crowned: bool  # False: straight, nothing of this is used
    highest: float  # drop where the profile is highest [m]
    root: float  # sqrt(delta_0) [m^0.5]
    table: np.ndarray  # by interval: cubic of G, highest power first; then value and rise of psi, a and g [m]; shape (n, 10)


class ProfileRow(NamedTuple):
    """Columns of `Profile.table`."""

    load: int = 0
    length: int = 4
    part: int = 6
    gap: int = 8


_COLUMN = ProfileRow()
STRAIGHT_PROFILE = Profile(False, 0.0, 1.0, np.zeros((1, 10)))


def new_profile(drops) -> Profile:
    """Return the `Profile` of a roller.

    Parameters
    ----------
    drops : number of slices -> drops of the profile at their middles [m], shape (slices,).
    """
    drop = np.asarray(drops(_SLICES), float)
    highest = float(drop.min())
    drop = drop - highest
    scale = float(drop.mean())
    if not scale > _STRAIGHT:
        return STRAIGHT_PROFILE
    t = np.linspace(0.0, 1.0, _INTERVALS + 1)
    nodes = np.array([_at_depth(drop, scale * (each / (1.0 - each)) ** 2, each) for each in t[1:-1]])
    spacing = t[1]
    # towards no depth G is that of the straight part, if there is one, and its slope that of the parabola through the first node; deep in, all bears
    flat = float(np.mean(drop <= _STRAIGHT))
    first = [flat, 2.0 * (nodes[0, 0] - flat) / spacing - nodes[0, 1], *nodes[0, 2:]]
    nodes = np.array([first, *nodes, [1.0, 0.0, 1.0, 1.0, 0.0]])
    # Hermite's cubics of values and slopes at both ends of each interval, of length 1
    value, slope = nodes[:, 0], nodes[:, 1] * spacing
    rise = np.diff(value)
    bend = slope[:-1] + slope[1:] - 2.0 * rise
    cubic = bend, rise - slope[:-1] - bend, slope[:-1], value[:-1]
    lines = [column for k in (2, 3, 4) for column in (nodes[:-1, k], np.diff(nodes[:, k]))]
    return Profile(True, highest, math.sqrt(scale), np.ascontiguousarray(np.stack([*cubic, *lines], axis=1)))


def _at_depth(drop, depth, t):
    """Return G, dG/dt, psi, a and g [m] of a profile at a penetration [m]."""
    bears = drop < depth
    inside = 1.0 - drop[bears] / depth
    load = float(np.sum(inside**EXPONENT)) / len(drop)
    slope = 2.0 * EXPONENT / (t * (1.0 - t)) * float(np.sum(inside ** (EXPONENT - 1.0) * (1.0 - inside))) / len(drop)
    cube = float(np.sum(inside ** (3.0 * EXPONENT))) / len(drop)
    beside = 0.0 if bears.all() else float(np.median(drop[~bears])) - depth
    return load, slope, math.sqrt(load**3 / cube), float(bears.mean()), beside


@kernel
def _place(depth, profile):
    """Return interval, place in it from 0 to 1, and t (1 - t)/2, the factor from d/dt to depth d/d(depth), of a depth [m] (a number)."""
    root = math.sqrt(max(depth, TINY))
    t = root / (root + profile.root)
    index = min(int(t * _INTERVALS), _INTERVALS - 1)
    return index, t * _INTERVALS - index, 0.5 * t * (1.0 - t)


@kernel
def _place_lanes(depth, profile):
    """Return the same as `_place`, of several depths (lanes)."""
    root = square_root(larger(depth, TINY))
    t = root / (root + profile.root)
    position = t * float(_INTERVALS)
    index = smaller(floor(position), _INTERVALS - 1.0)
    return index, position - index, 0.5 * t * (1.0 - t)


@kernel
def _cubic_lanes(table, index, x):
    """Return G, its first and second derivative by t, in intervals of the table and places in them (lanes)."""
    a, b, c = gather(table, index, _COLUMN.load), gather(table, index, _COLUMN.load + 1), gather(table, index, _COLUMN.load + 2)
    fraction = ((a * x + b) * x + c) * x + gather(table, index, _COLUMN.load + 3)
    return fraction, ((3.0 * a * x + 2.0 * b) * x + c) * float(_INTERVALS), (6.0 * a * x + 2.0 * b) * float(_INTERVALS * _INTERVALS)


@kernel
def _line_lanes(table, index, x, column):
    """Return one of psi, a and g, likewise, and its derivative by t."""
    rise = gather(table, index, column + 1)
    return gather(table, index, column) + rise * x, rise * float(_INTERVALS)


@fused
def profile_force(depth, stiffness, profile):
    """Return Q [N] of a depth below the profile's highest line, and its derivative [N/m]; a straight profile counts as one, too.

    Parameters
    ----------
    depth : [m]; nothing is carried below 0.
    stiffness : K of the whole length [N/m^(10/9)].
    profile : `Profile`.
    """
    if depth <= 0.0:
        return 0.0, 0.0
    root = stiffness * ninth_root(max(depth, TINY))
    if not profile.crowned:
        return root * depth, EXPONENT * root
    i, x, by_depth = _place(depth, profile)
    table = profile.table
    a, b, c = table[i, 0], table[i, 1], table[i, 2]
    fraction = ((a * x + b) * x + c) * x + table[i, 3]
    slope = ((3.0 * a * x + 2.0 * b) * x + c) * _INTERVALS
    return root * depth * fraction, root * (EXPONENT * fraction + by_depth * slope)


@kernel
def profile_depth(force, stiffness, profile):
    """Return the depth [m] that carries a force [N], to 1e-9 of itself: the inverse of `profile_force`."""
    if force <= 0.0:
        return 0.0
    depth = (force / stiffness) ** (1.0 / EXPONENT)
    if not profile.crowned or depth < TINY:
        return depth
    for _ in range(_ITERATIONS):
        found, slope = profile_force(depth, stiffness, profile)
        # in logarithms the law is all but a straight line
        change = power(force / found, found / (depth * slope))
        depth *= change
        if abs(change - 1.0) < _LAST_CHANGE:
            break
    return depth


@kernel
def damped_profile_contact(penetration, rate, stiffness, damping, profile):
    """Return the normal force of an aligned roller with a profile [N], and its derivatives (lanes).

    With M = 10/9 G + delta dG/d(delta), so that the stiffness is K delta^(1/9) M, damping by stiffness is tau times that, as of slices of which
    each is damped by itself (`bearing_sim.physics.contact.damped_line_contact`), but that the depth at which it begins is that in the middle:

        Q = K delta^(10/9) max(0, G (1 + a delta') + M tau delta'/(delta + h)).

    Parameters and results as of `bearing_sim.physics.contact.damped_line_contact`, and the `Profile`.
    """
    raw = penetration - profile.highest
    depth = larger(raw, 0.0)
    root = stiffness * ninth_root(larger(raw, TINY))
    elastic = root * depth
    index, x, by_depth = _place_lanes(depth, profile)
    fraction, first, second = _cubic_lanes(profile.table, index, x)
    steep = EXPONENT * fraction + by_depth * first
    # delta dM/d(delta), with (t (1 - t)/2)' = (1 - 2 t)/2 and (1 - 2 t)^2 = 1 - 8 t (1 - t)/2
    t = (index + x) * (1.0 / _INTERVALS)
    steeper = by_depth * (EXPONENT * first + (0.5 - t) * first + by_depth * second)
    inverse = 1.0 / (depth + damping.depth)
    quick = damping.time * inverse * rate
    slow = 1.0 + damping.hysteresis * rate
    factor = fraction * slow + steep * quick
    touches = where_positive(factor, where_positive(raw, 1.0, 0.0), 0.0)
    by_penetration = root * (steep * slow + quick * ((EXPONENT - depth * inverse) * steep + steeper))
    by_rate = elastic * (fraction * damping.hysteresis + steep * (damping.time * inverse))
    return elastic * larger(factor, 0.0), touches * by_penetration, touches * by_rate


@fused
def concentrate(stiffness, profile, contacts):
    """Write into ``contacts`` on which part of its length each contact bears, and the load that a whole one with its load per length would have.

    The rows ``load``, which it replaces, and ``penetration`` go in; `spread_tractions` brings the load back.

    Parameters
    ----------
    stiffness : K of the whole length [N/m^(10/9)].
    profile : `Profile`, crowned.
    contacts : rows `bearing_sim.physics.contact.CONTACT`.
    """
    for block in range(contacts.shape[0]):
        depth = larger(load(contacts, block, CONTACT.penetration) - profile.highest, TINY)
        index, x, by_depth = _place_lanes(depth, profile)
        fraction, first, _ = _cubic_lanes(profile.table, index, x)
        length, rises = _line_lanes(profile.table, index, x, _COLUMN.length)
        part, _ = _line_lanes(profile.table, index, x, _COLUMN.part)
        gap, _ = _line_lanes(profile.table, index, x, _COLUMN.gap)
        d_length = by_depth * rises / (stiffness * ninth_root(depth) * depth * (EXPONENT * fraction + by_depth * first))
        whole = load(contacts, block, CONTACT.load)
        store(contacts, block, CONTACT.whole_load, whole)
        store(contacts, block, CONTACT.load, whole / length)
        store(contacts, block, CONTACT.length, length)
        store(contacts, block, CONTACT.d_length, d_length)
        store(contacts, block, CONTACT.part, part)
        store(contacts, block, CONTACT.gap, gap)


@fused
def spread_tractions(contacts):
    """Make the tractions of whole contacts those of the parts that bear: T = psi T_1(Q/psi); `concentrate` has been called before them.

    dT/dQ = T_1' + (T_1 - T_1' Q/psi) dpsi/dQ.
    """
    for block in range(contacts.shape[0]):
        length, force, d_load = load(contacts, block, CONTACT.length), load(contacts, block, CONTACT.force), load(contacts, block, CONTACT.d_load)
        rest = force - d_load * load(contacts, block, CONTACT.load)
        store(contacts, block, CONTACT.d_load, d_load + rest * load(contacts, block, CONTACT.d_length))
        store(contacts, block, CONTACT.force, length * force)
        store(contacts, block, CONTACT.d_sliding, length * load(contacts, block, CONTACT.d_sliding))
        store(contacts, block, CONTACT.d_rolling, length * load(contacts, block, CONTACT.d_rolling))
        store(contacts, block, CONTACT.load, load(contacts, block, CONTACT.whole_load))
