# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Quasi-static balance of rollers, a bending outer ring and the housing that backs it, for rollers that stand in even pitches.

The seat of the ring is looked at in M points, a whole number of them to a roller pitch, which turn with the cage: roller 0 is at point 0.  With
F(psi) the deflection of the ring at an angle psi from a unit force and H(psi) that of the housing (`bearing_sim.physics.outer_ring`), roller forces Q
and seat forces f deflect the ring by

    w(phi) = sum of F(phi - phi_j) Q_j - sum of F(phi - theta_i) f_i,

and the seat's points meet the housing where

    play + bore(theta_i) + sum of H(theta_i - theta_k) f_k - w(theta_i) - x.e(theta_i) >= 0,    f_i >= 0,    one of them zero,

x the motion of the ring in its housing, which follows from sum of f e = sum of Q e.  Everything is measured from the centre of the ring, in axes that
turn with the cage: so the equations are the same at all times but for the bore, the load and how far rollers are squeezed.

Rollers and inner ring obey the same kind of equations as long as a roller is a spring of the compliance s that presses from an approach o on,

    w(phi_j) + x.e(phi_j) + s (Q_j - F_c) + o_j - squeeze_j - y.e(phi_j) >= 0,    Q_j - F_c >= 0,    one of them zero,

y the position of the inner ring from the housing's centre, which follows from the load.

**Complementarity.** All of this is one linear complementarity problem with a positive definite matrix that never changes.  A change of sides of a
point or a roller is a principal pivot (A. W. Tucker, Principal pivotal transforms of square matrices, SIAM Review 5, 1963); as long as nothing
changes, a solution is one product with the transformed matrix.  With the signs of A. P. Dempster's sweep operator (Elements of Continuous
Multivariate Analysis, 1969) it stays symmetric.  Where signs are wrong, what is wrong is taken away bit by bit and what first reaches zero changes
sides: the parametric method of R. W. Cottle (Monotone solutions of the parametric linear complementarity problem, Mathematical Programming 3, 1972),
which ends after finitely many changes, as many as there are wrong signs or a few more.

**Rollers.** A solution is the answer where the law of the contacts has the spring's force at the same approach.  Newton's method moves each o to
where the spring meets the tangent of the law, with all that touches and carries now.  Where that does not serve, o is moved to where the spring meets
the law at the approach found: as springs are at least as stiff as contacts, the convex potential of the rollers lies below that of springs that touch
it there, so that each such step descends in it.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.linear_algebra import back_substitute, decompose
from bearing_sim.numerics.simd import load_run, new_blocks, store_run
from bearing_sim.numerics.vector_width import LANES
from bearing_sim.physics.load_balance import LOAD, press_roller
from bearing_sim.physics.outer_ring import RingSection, ring_compliance
from bearing_sim.physics.profile import profile_force
from bearing_sim.physics.raceway import contour_at, contour_table

_CENTRING_STIFFNESS = 1e3  # N/m, of rings that nothing holds, as in `bearing_sim.physics.load_balance` (assumption)
_ITERATIONS = 400
_RELATIVE_RESIDUAL, _LEAST_RESIDUAL = 1e-6, 1e-3  # of the load, as for a rigid ring; N, of a light load
_MOVING_RESIDUAL = 1e-5  # of all loads, where rollers move: less than a thousandth of what their iteration leaves (assumption)
_HOLDING_STIFFNESS = 1e5  # N/m, towards where the outer ring was an iteration ago: none is left of it at the end (assumption)
_LEAST_COMPLIANCE = 1e-10  # m/N, in one wave, of a bore that does not yield: from 1e-10 to 1e-8 loads differ by 1e-4
_PIVOTS, _ROUNDS = 2000, 20  # changes of sides at most; solutions of a problem, each after the changes that the one before asked for
_WRONG_FORCE, _WRONG_GAP = 1e-7, 1e-12  # of all forces; m
_TYPICAL, _STIFFER = 1e-5, 1.1  # m, penetration at which contacts are no stiffer than springs at first; by what factor these are stiffer
_REFRESHED = 4000  # pivots after which rounding is removed, some 1e-12 of the tableau
_GROUP = 4 * LANES  # columns of a product that are computed at once
_WAITING = 8  # pivots that the points' rows take at once
_OPEN, _TOUCHING, _UNSIGNED, _GIVEN = 0, 1, 2, 3  # sides of what has a gap, of what has a force, of x and y, which have neither, and of a given y
_ALIKE = 1.6  # stiffness of springs over that of contacts, up to which an iteration leaves less than half of the error before
_RATE_ITERATIONS = 6  # of speeds
_TANGENT_ITERATIONS = 3  # likewise, of tangents


class ElasticRing(NamedTuple):
    """The ring and its seat, for Z rollers in even pitches and M points of the seat, P to a pitch; without any the ring is free, and P = 1."""

    between: np.ndarray  # F at multiples of pitch/P [m/N], shape (P Z,)
    turning: np.ndarray  # dF/dpsi at k pitches less p/P of one in column Z + k of row p [m/(N rad)], shape (P, 2 Z + `_GROUP`)
    directions: np.ndarray  # cosine and sine of multiples of pitch/P, shape (2, P Z)
    seat: np.ndarray  # F + H at multiples of 2 pi/M, and a part in one wave that makes it regular and moves x alone [m/N], shape (M,)
    bore: np.ndarray  # how far the bore lies outside of its mean [m], periodic cubic table of `bearing_sim.physics.raceway`, shape (n, 4)
    radial: float  # compliance of the housing against a force, by which the seat moves as a whole, less that part of ``seat`` [m/N]
    play: float  # radial play of the ring in the bore, negative for an interference [m]; NaN: by the seat's pressure
    loose: float  # play by a pressure that would close it, and the equivalent interference by pressure [m/Pa]
    pressed: float
    shrunk: float  # deflection of the ring by that pressure, which the mean growth contains [m/Pa]


class Bending(NamedTuple):
    """Memory of the balance; see `new_bending`.

    The tableau is the transform of N = M + Z + 4 equations by what touches: points, rollers, x, y; of the square the rows of the points end at the
    diagonal.  Three rows follow: constants by the gaps, solution, and what is added to it while sides change.  Columns are filled up to a multiple C
    of `_GROUP`.  Only a later pivot looks at the rows of the points, so their changes wait and are made together.
    """

    rollers: np.ndarray  # rows `ROLLER`, shape (len(ROLLER), Z)
    points: np.ndarray  # rows `POINT`, shape (len(POINT), M + 2); the last two columns belong to x
    tableau: np.ndarray  # shape (N + 3, C)
    waiting: np.ndarray  # a row u for each pivot whose change factor u u' the points' rows lack, shape (`_WAITING`, C)
    factors: np.ndarray  # of those, and scratch, shape (2, `_WAITING`)
    pivots: np.ndarray  # since the tableau was written, and how many of them wait, int64, shape (2,)
    sides: np.ndarray  # `_OPEN`, `_TOUCHING`, `_UNSIGNED` or `_GIVEN`, int64, shape (N,)
    matrix: np.ndarray  # of Newton's method, shape (Z, Z)
    right: np.ndarray  # shape (Z,)
    order: np.ndarray  # int64, shape (Z,)
    softer: np.ndarray  # compliance of contacts less that of springs [m/N], shape (Z,)
    held: np.ndarray  # x an iteration ago [m]; compliance of the springs [m/N]; shape (3,)
    given: np.ndarray  # to rollers, x and y, shape (Z + 4,)
    scratch: np.ndarray  # shape (C,)


class RollerRow(NamedTuple):
    """Rows of ``Bending.rollers``."""

    deflection: int = 0  # w [m]
    slope: int = 1  # dw/dphi [m/rad]
    force: int = 2  # q, on the ring outwards [N]
    opens: int = 3  # o less the approach at which an inner contact begins [m]
    moved: int = 4  # from here on, of `deflect_elastic_ring`: w + x.e [m]
    rate: int = 5  # its derivative by time, along the roller's way [m/s]
    share: int = 6  # of a further approach, which the contact takes while all other rollers stay where they are


ROLLER = RollerRow()


class PointRow(NamedTuple):
    """Rows of ``Bending.points``."""

    force: int = 0  # f at the points, which turn with the cage [N]; x, in axes that stand still [m]
    gap: int = 1  # without forces [m]; where x begins, which contains a part of the seat's in one wave


POINT = PointRow()


_POINTS_A_PITCH = 4  # of the seat; lives err by 1 % against 16 of them, with shear by 4 % (``test/benchmarks/bending_front.py``)
_BORE_INTERVALS = 720


class Seat(NamedTuple):
    """What backs the ring: a housing around all of its seat, or nothing."""

    radius: float  # of the seat, R_s [m]
    width: float  # [m]
    compliances: Callable  # numbers of waves n -> h_n [m/Pa] of the housing, 0 for n = 1; see `bearing_sim.physics.outer_ring`
    bore: Callable  # azimuths [rad] -> how far the bore lies outside of its mean [m]
    play: float  # radial [m], see `ElasticRing`
    loose: float = 0.0
    pressed: float = 0.0
    shrunk: float = 0.0
    radial: float = 0.0  # compliance against a force, by which the seat moves as a whole [m/N]


def new_elastic_ring(section: RingSection, seat: Seat | None, rollers: int, points: int = _POINTS_A_PITCH) -> ElasticRing:
    """Return an elastic ring.

    Parameters
    ----------
    section : of the ring.
    seat : what backs it; None: nothing but a pressure like the cosine of the angle from the load, in which the ring keeps its shape.
    rollers : their number Z.
    points : of the seat to a pitch; the ring bends in as many waves as two points resolve, Z points/2.
    """
    n = np.arange(points * rollers // 2 + 1)
    parts = points if seat else 1
    count = parts * rollers
    azimuths = 2.0 * math.pi / count * np.arange(count)
    waves, compliances = np.cos(np.outer(azimuths, n)), ring_compliance(n, section)
    apart = 2.0 * math.pi / count * (parts * np.arange(-rollers, rollers + _GROUP) - np.arange(parts)[:, None])
    turning = -np.sin(np.multiply.outer(apart, n)) @ (n * compliances)
    common = waves @ compliances, turning, np.stack([np.cos(azimuths), np.sin(azimuths)])
    if seat is None:
        return ElasticRing(*common, np.zeros(0), np.zeros((1, 4)), 0.0, 0.0, 0.0, 0.0, 0.0)
    housing = seat.compliances(n) / (math.pi * seat.radius * seat.width)  # by a force at one point
    housing[0] *= 0.5
    if count % 2 == 0:
        housing[-1] *= 0.5  # the finest wave has one phase
    regular = max(housing[2], _LEAST_COMPLIANCE)
    housing[1] += regular  # makes the matrix regular; it moves x, which the balance of forces determines, and is taken from the rollers
    knots = 2.0 * math.pi / _BORE_INTERVALS * np.arange(_BORE_INTERVALS)
    bore = np.asarray(seat.bore(knots), float)
    slopes = (np.roll(bore, -1) - np.roll(bore, 1)) / (2.0 * knots[1])
    table = contour_table(bore, slopes) if np.ptp(bore) > 0.0 else np.array([[0.0, 0.0, 0.0, bore[0]]])
    return ElasticRing(*common, waves @ (compliances + housing), table, seat.radial - regular, seat.play, seat.loose, seat.pressed, seat.shrunk)


def new_bending(elastic: ElasticRing, rollers_move: bool = False) -> Bending:
    """Return the memory for a ring; the seat touches everywhere.

    Parameters
    ----------
    elastic : the ring.
    rollers_move : whether it is for `deflect_elastic_ring`, which knows where the rollers are.
    """
    rollers, points = (elastic.turning.shape[1] - _GROUP) // 2, elastic.seat.shape[0]
    equations = points + rollers + 4
    groups = -(-equations // _GROUP)
    sides = np.full(equations, _UNSIGNED)
    sides[: points + rollers] = _TOUCHING
    if rollers_move:
        sides[-2:] = _GIVEN
    return Bending(
        rollers=np.zeros((len(ROLLER), rollers)),
        points=np.zeros((len(POINT), points + 2)),
        tableau=new_blocks(4, (equations + 3) * groups).reshape(equations + 3, -1),
        waiting=new_blocks(4, _WAITING * groups).reshape(_WAITING, -1),
        factors=np.zeros((2, _WAITING)),
        pivots=np.array([_REFRESHED, 0]),
        sides=sides,
        matrix=np.zeros((rollers, rollers)),
        right=np.zeros(rollers),
        order=np.zeros(rollers, np.int64),
        softer=np.zeros(rollers),
        held=np.zeros(3),
        given=np.zeros(rollers + 4),
        scratch=np.zeros(_GROUP * groups),
    )


@fused
def _combine(values, factors, rows, count, found):
    """Write ``count`` values plus rows times a factor for each row; or a few more values that fill up a `_GROUP`."""
    for i in range(0, count, _GROUP):
        one, two = load_run(values, i), load_run(values, i + LANES)
        three, four = load_run(values, i + 2 * LANES), load_run(values, i + 3 * LANES)
        for k in range(rows.shape[0]):
            factor, row = factors[k], rows[k]
            one += factor * load_run(row, i)
            two += factor * load_run(row, i + LANES)
            three += factor * load_run(row, i + 2 * LANES)
            four += factor * load_run(row, i + 3 * LANES)
        store_run(found, i, one)
        store_run(found, i + LANES, two)
        store_run(found, i + 2 * LANES, three)
        store_run(found, i + 3 * LANES, four)


@fused
def _add(factor, row, first, count, values):
    """Add a multiple of a row, from an index on, to ``count`` values, or a few more that fill up a `_GROUP`."""
    for start in range(0, count, _GROUP):
        for i in range(start, start + _GROUP, LANES):
            store_run(values, i, load_run(values, i) + factor * load_run(row, first + i))


@fused
def _take_changes(k, row, width, count, waiting, factors):
    """Change row k of a point by what waits."""
    for other in range(count):
        factors[1, other] = factors[0, other] * waiting[other, k]
    _combine(row, factors[1], waiting[:count], width, row)


@kernel
def _pivot(k, sense, points, pivots, tableau, waiting, factors):
    """Exchange what is given and what is found at an index, forwards (``sense`` 1) or back (-1).

    With u row k of the tableau T, of which u_k is the pivot, T loses its row and column k and u u'/pivot, in which u_k counts as -``sense``.
    """
    count, size = pivots[1], tableau.shape[0] - 3
    row, complete = waiting[count], size if k >= points else k + 1
    for i in range(complete):
        row[i], tableau[k, i] = tableau[k, i], 0.0
    if k < points:
        for i in range(k + 1, points):
            row[i], tableau[i, k] = tableau[i, k], 0.0
        _take_changes(k, row, points, count, waiting, factors)
        for other in range(count):
            waiting[other, k] = 0.0
        for i in range(points, size):
            row[i] = tableau[i, k]
    factors[0, count], row[k], pivots[1] = -1.0 / row[k], -sense, count + 1
    for j in range(points, size + 3):
        part, tableau[j, k] = row[j] if j < size else tableau[j, k], 0.0
        _add(factors[0, count] * part, row, 0, size, tableau[j])
    if pivots[1] == _WAITING:
        _complete_points(points, pivots, tableau, waiting, factors)


@kernel
def _complete_points(points, pivots, tableau, waiting, factors):
    """Change the points' rows by what waits."""
    for j in range(points):
        _take_changes(j, tableau[j], j + 1, pivots[1], waiting, factors)
    pivots[1] = 0


@kernel
def _refresh(elastic, bending):
    """Write the tableau anew for the points that touch."""
    points, rollers, tableau = elastic.seat.shape[0], (elastic.turning.shape[1] - _GROUP) // 2, bending.tableau
    parts, x, size = elastic.turning.shape[0], points + rollers, points + rollers + 4
    bending.pivots[1] = 0
    for j in range(size + 1):
        for i in range(size):
            tableau[j, i] = 0.0
    for i in range(points):
        for k in range(i + 1):
            tableau[i, k] = elastic.seat[i - k]
        tableau[size, i] = bending.points[POINT.gap, i]
    for j in range(rollers):
        row = points + j
        for i in range(points):
            tableau[row, i] = -elastic.between[abs(parts * j - i)]
        for k in range(rollers):
            tableau[row, points + k] = elastic.between[parts * abs(j - k)] + elastic.radial * elastic.directions[0, parts * abs(j - k)]
        tableau[row, row] += bending.held[2]
    for axis in range(2):
        for i in range(points):
            tableau[x + axis, i] = -elastic.directions[axis, i]
        for j in range(rollers):
            direction = elastic.directions[axis, parts * j]
            if points > 0:  # a free ring stays where it is
                tableau[x + axis, points + j] = tableau[points + j, x + axis] = direction
            tableau[x + 2 + axis, points + j] = tableau[points + j, x + 2 + axis] = -direction
        tableau[x + axis, x + axis], tableau[x + 2 + axis, x + 2 + axis] = -_HOLDING_STIFFNESS, -_CENTRING_STIFFNESS
    for i in range(size):
        if bending.sides[i] == _TOUCHING or bending.sides[i] == _UNSIGNED:
            _pivot(i, 1.0, points, bending.pivots, tableau, bending.waiting, bending.factors)
    bending.pivots[0] = 0


@kernel
def _settle(allowed, points, bending):
    """Change sides until no force pulls and no gap is negative in the solution; return how many did, -1 where there was no end.

    Parameters
    ----------
    allowed : force that counts as none [N].
    points : their number.
    """
    tableau, sides, size, wrong = bending.tableau, bending.sides, bending.sides.shape[0], False
    values, offsets = tableau[size + 1], tableau[size + 2]  # of what touches: negative
    for i in range(size):  # without branches: numba makes vectors of it
        wrong |= ((sides[i] == _OPEN) & (values[i] < -_WRONG_GAP)) | ((sides[i] == _TOUCHING) & (values[i] > allowed))
    if not wrong:
        return 0
    spread = 1
    for i in range(size):
        right, allowed_here = (1.0, _WRONG_GAP) if sides[i] == _OPEN else (-1.0, allowed)
        if sides[i] != _UNSIGNED and -allowed_here <= right * values[i] < 0.0:
            values[i] = 0.0
        offsets[i] = right * max(right * offsets[i], 1e-3 * spread * abs(values[i])) - values[i]
        spread = spread + 37 if spread < 65 else spread - 64  # no two alike, so that no two reach zero together
    for change in range(_PIVOTS):
        first, highest = -1, 0.0
        for i in range(size):
            right = 1.0 if sides[i] == _OPEN else -1.0 if sides[i] == _TOUCHING else 0.0
            lacking, added = -right * values[i], right * offsets[i]
            if added > 0.0 and lacking > highest * added:
                first, highest = i, lacking / added
        if first < 0:
            return change
        _pivot(first, 1.0 if sides[first] == _OPEN else -1.0, points, bending.pivots, tableau, bending.waiting, bending.factors)
        sides[first] = _TOUCHING if sides[first] == _OPEN else _OPEN
        bending.pivots[0] += 1
    return -1


@kernel
def _look_at_bore(turn, play, elastic, bending):
    """Write the gaps of the seat's points at a cage angle [turns], and what they change in the tableau's constants."""
    points, intervals, changes, gaps, changed = elastic.seat.shape[0], elastic.bore.shape[0], bending.scratch, bending.points[POINT.gap], False
    for i in range(points):
        at = turn + i / points
        gap = play + (contour_at(elastic.bore, (at - math.floor(at)) * intervals)[0] if intervals > 1 else elastic.bore[0, 3])
        changes[i], gaps[i] = gap - gaps[i], gap
        changed = changed or changes[i] != 0.0
    if changed and bending.pivots[0] < _REFRESHED:
        _complete_points(points, bending.pivots, bending.tableau, bending.waiting, bending.factors)
        _change_gaps(points, changes, bending.sides, bending.tableau)


@kernel
def _change_gaps(points, changes, sides, tableau):
    """Change the tableau's constants by changes of the points' gaps [m], which are lost."""
    size, constants = sides.shape[0], tableau[sides.shape[0]]
    for i in range(points):
        if sides[i] == _OPEN:
            constants[i] += changes[i]
            changes[i] = 0.0
    for i in range(size):
        before, first, second, third, fourth = min(i, points), 0.0, 0.0, 0.0, 0.0
        if i < points:
            for k in range(i + 1):
                constants[k] -= tableau[i, k] * changes[i]
        for k in range(0, before - 3, 4):
            first += tableau[i, k] * changes[k]
            second += tableau[i, k + 1] * changes[k + 1]
            third += tableau[i, k + 2] * changes[k + 2]
            fourth += tableau[i, k + 3] * changes[k + 3]
        for k in range(before - before % 4, before):
            first += tableau[i, k] * changes[k]
        constants[i] -= first + second + third + fourth


@kernel
def _solve(load_y, load_z, shrunk, elastic, loads, bending):
    """Write the solution for the springs as they are; return whether there is one."""
    points, rollers, parts, size = elastic.seat.shape[0], loads.shape[1], elastic.turning.shape[0], bending.sides.shape[0]
    tableau, sides, values, compliance = bending.tableau, bending.sides, bending.tableau[size + 1], bending.held[2]
    given, own = bending.given, bending.right
    allowed = abs(load_y) + abs(load_z) + 1.0
    for j in range(rollers):
        carried = loads[LOAD.centrifugal, j]
        allowed += carried
        load_y += carried * elastic.directions[0, parts * j]
        load_z += carried * elastic.directions[1, parts * j]
    given[rollers], given[rollers + 1] = -_HOLDING_STIFFNESS * bending.held[0], -_HOLDING_STIFFNESS * bending.held[1]
    given[rollers + 2], given[rollers + 3] = -load_y, -load_z
    for _ in range(_ROUNDS):
        for i in range(size):
            tableau[size + 2, i] = values[i]
        for j in range(rollers):
            carried = loads[LOAD.centrifugal, j]
            gap = bending.rollers[ROLLER.opens, j] + loads[LOAD.free, j] + shrunk - loads[LOAD.squeeze, j] - compliance * carried
            touches = sides[points + j] == _TOUCHING
            given[j], own[j] = (-gap, carried) if touches else (carried, gap)
        _combine(tableau[size], given, tableau[points:size], size, values)
        for j in range(rollers):
            values[points + j] += own[j]
        changes = _settle(_WRONG_FORCE * allowed, points, bending)
        if changes <= 0:
            return changes == 0
    return False


@kernel
def press_between_raceways(law, approaches, loads):
    """Balance all rollers between both raceways.

    Parameters
    ----------
    law : stiffness and profile of a contact.
    approaches : of the rollers [m], shape (Z,).
    loads : takes what follows.
    """
    for j in range(loads.shape[1]):
        press_roller(j, approaches[j], law[0], law[1], loads)


@kernel
def press_outwards(law, approaches, loads):
    """Write the elastic forces of all rollers on the outer raceway alone; parameters as of `press_between_raceways`."""
    for j in range(loads.shape[1]):
        approach = approaches[j]
        force, slope = profile_force(approach, law[0], law[1]) if approach > 0.0 else (0.0, 0.0)
        loads[LOAD.approach, j], loads[LOAD.slope, j], loads[LOAD.inner, j], loads[LOAD.outer, j] = approach, slope, force, force


@kernel
def _press_rollers(press, law, elastic, loads, bending):
    """Press all rollers at the approaches of the solution; return the largest force that it misses [N], of a roller or of the inner ring."""
    points, parts, sides, rows = elastic.seat.shape[0], elastic.turning.shape[0], bending.sides, bending.rollers
    values, force_y, force_z, residual = bending.tableau[bending.sides.shape[0] + 1], 0.0, 0.0, 0.0
    approaches = bending.right
    for j in range(loads.shape[1]):
        approach, pressed, value = loads[LOAD.free, j] + rows[ROLLER.opens, j], 0.0, values[points + j]
        if sides[points + j] == _TOUCHING:
            pressed = -value
            approach += bending.held[2] * pressed
        else:
            approach -= value
        rows[ROLLER.force, j], approaches[j] = loads[LOAD.centrifugal, j] + pressed, approach
    press(law, approaches, loads)
    for j in range(loads.shape[1]):
        missed = loads[LOAD.outer, j] - rows[ROLLER.force, j]
        force_y += missed * elastic.directions[0, parts * j]
        force_z += missed * elastic.directions[1, parts * j]
        residual = max(residual, abs(missed))
    return max(residual, abs(force_y), abs(force_z))


@kernel
def seat_gap(pressure, elastic):
    """Return the play of the ring in its bore [m], and how far the raceway's mean growth has moved it inwards already [m].

    Parameters
    ----------
    pressure : of the seat by fit and temperatures [Pa]; negative: what a gap lacks to close.
    elastic : `ElasticRing`.
    """
    if not math.isnan(elastic.play):
        return elastic.play, max(-elastic.play, 0.0) * elastic.shrunk / elastic.pressed if elastic.pressed > 0.0 else 0.0
    if pressure > 0.0:
        return -pressure * elastic.pressed, pressure * elastic.shrunk
    return -pressure * elastic.loose, 0.0


@kernel
def _unpressed(j, loads):
    """Return where a spring begins whose roller is not pressed: where contacts begin, or where this one is if it is deeper by rounding."""
    return max(loads[LOAD.approach, j] - loads[LOAD.free, j], 0.0)


@kernel
def _move_springs(newton, points, loads, bending):
    """Move the springs to the tangents of the rollers' laws, by Newton's method, or to the laws themselves; return whether that was possible."""
    rollers, opens, compliance, sides = loads.shape[1], bending.rollers[ROLLER.opens], bending.held[2], bending.sides
    matrix, right, count = bending.matrix, bending.right, 0
    for j in range(rollers):
        missed, slope, touches = bending.rollers[ROLLER.force, j] - loads[LOAD.outer, j], loads[LOAD.slope, j], sides[points + j] == _TOUCHING
        if slope > 0.0 and not (newton and touches):
            opens[j] = loads[LOAD.approach, j] - loads[LOAD.free, j] - compliance * loads[LOAD.inner, j]
        elif not (newton and touches):
            opens[j] = _unpressed(j, loads)
        else:
            softer, column = 1.0 / slope - compliance if slope > 0.0 else 0.0, 0
            for k in range(rollers):
                if sides[points + k] == _TOUCHING:
                    matrix[count, column] = -softer * bending.tableau[points + j, points + k]
                    column += 1
            matrix[count, count] += 1.0
            right[count] = missed / slope if slope > 0.0 else _unpressed(j, loads) - opens[j]
            count += 1
    if not decompose(count, matrix, bending.order):
        return False
    back_substitute(count, matrix, bending.order, right)
    count = 0
    for j in range(rollers):
        if newton and sides[points + j] == _TOUCHING:
            opens[j] += right[count]
            count += 1
    return True


@kernel
def _are_alike(points, loads, bending):
    """Return whether all contacts that press are almost as stiff as the springs, so that simple iterations end soon."""
    for j in range(loads.shape[1]):
        if bending.sides[points + j] == _TOUCHING and loads[LOAD.slope, j] * bending.held[2] * _ALIKE < 1.0:
            return False
    return True


@kernel
def _approach_tangents(points, loads, bending):
    """Move the springs almost to the tangents of the laws, as `_move_springs`, by Jacobi's iteration: of springs that are about as stiff as contacts.

    With B the springs' response and e = 1/S - s, the change c of the springs obeys c + e B c = missed/S.
    """
    rollers, tableau, sides, opens = loads.shape[1], bending.tableau, bending.sides, bending.rollers[ROLLER.opens]
    changes, softer, driven, right = bending.given, bending.softer, bending.scratch, bending.right
    for j in range(rollers):
        slope, changes[j], softer[j], right[j] = loads[LOAD.slope, j], 0.0, 0.0, _unpressed(j, loads) - opens[j]
        touches = sides[points + j] == _TOUCHING
        if slope > 0.0:
            softer[j], right[j] = 1.0 / slope - bending.held[2], (bending.rollers[ROLLER.force, j] - loads[LOAD.outer, j]) / slope
        if touches:
            changes[j] = right[j] / (1.0 - softer[j] * tableau[points + j, points + j])
        elif slope > 0.0:
            opens[j] = loads[LOAD.approach, j] - loads[LOAD.free, j] - bending.held[2] * loads[LOAD.inner, j]
        else:
            opens[j] = _unpressed(j, loads)
    for _ in range(_TANGENT_ITERATIONS):
        for j in range(rollers):
            driven[j] = 0.0
        for k in range(rollers):
            _add(-changes[k], tableau[points + k], points, rollers, driven)
        for j in range(rollers):
            if sides[points + j] == _TOUCHING:
                own = -tableau[points + j, points + j]
                changes[j] = (right[j] - softer[j] * (driven[j] - own * changes[j])) / (1.0 + softer[j] * own)
    for j in range(rollers):
        opens[j] += changes[j]


@kernel
def _conclude(y, z, elastic, loads, bending):
    """Write what follows from a solution: forces of the seat, deflections at the rollers and their slopes; y, z is the position of the inner ring."""
    points, rollers, parts = elastic.seat.shape[0], loads.shape[1], elastic.turning.shape[0]
    rows, pressed, values = bending.rollers, bending.points[POINT.force], bending.tableau[bending.sides.shape[0] + 1]
    slopes = bending.scratch
    for j in range(rollers):
        slopes[j] = 0.0
        moved = y * elastic.directions[0, parts * j] + z * elastic.directions[1, parts * j]
        rows[ROLLER.deflection, j] = loads[LOAD.squeeze, j] - loads[LOAD.approach, j] + moved
    for i in range(points):
        pressed[i] = -values[i] if bending.sides[i] == _TOUCHING else 0.0
    for k in range(rollers):
        for part in range(parts):
            force = rows[ROLLER.force, k] if part == 0 else 0.0
            if points > 0:
                force -= pressed[k * parts + part]
            if force != 0.0:
                _add(force, elastic.turning[part], rollers - k, rollers, slopes)
    for j in range(rollers):
        rows[ROLLER.slope, j] = slopes[j]


@kernel
def _turned(y, z, cosine, sine):
    """Return a vector in axes that are turned by an angle of that cosine and sine."""
    return y * cosine + z * sine, z * cosine - y * sine


@kernel
def _find_balance(load_y, load_z, allowed, shrunk, moving, press, law, typical, elastic, loads, bending):
    """Solve all equations, in axes that turn with the cage; return whether that converged.

    Parameters
    ----------
    allowed : residual force that counts as none [N].
    shrunk : see `seat_gap`.
    moving : whether the places of the rollers are given, so that each is pressed by the outer ring alone.
    press, law : kernel ``(law, approaches, loads)`` that presses rollers, as `press_between_raceways` does, and what it needs.
    typical : stiffness of rollers, from which springs start [N/m].
    load_y, load_z, elastic, loads, bending : as of `balance_elastic_ring`.
    """
    points, size, held = elastic.seat.shape[0], bending.sides.shape[0], bending.held
    values = bending.tableau[size + 1]
    before, descents, patience, stiffest = math.inf, 0, 1, typical if held[2] == 0.0 else 0.0
    for _ in range(_ITERATIONS):
        for j in range(loads.shape[1]):
            stiffest = max(stiffest, loads[LOAD.slope, j])
        if held[2] == 0.0 or stiffest * held[2] > 1.0:
            held[2], bending.pivots[0] = 1.0 / (_STIFFER * stiffest), _REFRESHED
        if bending.pivots[0] >= _REFRESHED:
            _refresh(elastic, bending)
        if not _solve(load_y, load_z, shrunk, elastic, loads, bending):
            break
        residual = _press_rollers(press, law, elastic, loads, bending)
        x_y, x_z = -values[size - 4], -values[size - 3]
        moved = max(abs(x_y - held[0]), abs(x_z - held[1]))
        held[0], held[1] = x_y, x_z
        if residual <= allowed and _HOLDING_STIFFNESS * moved <= allowed:
            return True
        if descents > 0:
            descents -= 1
        elif residual > before:  # Newton's method does not serve: longer and longer without it
            descents, patience = patience, 2 * patience
        before = residual if descents == 0 else math.inf
        if moving and descents == 0 and _are_alike(points, loads, bending):
            _approach_tangents(points, loads, bending)
        elif not _move_springs(descents == 0, points, loads, bending):
            break
    bending.pivots[0] = _REFRESHED  # nothing of a failure is left for the next call
    for i in range(size):
        values[i] = 0.0
    for j in range(loads.shape[1]):
        bending.rollers[ROLLER.opens, j] = 0.0
    return False


@kernel
def balance_elastic_ring(load_y, load_z, turn, pressure, stiffness, profile, elastic, loads, ring, bending):
    """Find the ring position and the deflections of the outer ring at which the roller loads carry the radial load.

    Parameters
    ----------
    load_y, load_z : radial load on the inner ring [N].
    turn : azimuth of roller 0 [turns].
    pressure : of the seat by fit and temperatures [Pa], see `seat_gap`.
    stiffness, profile, loads, ring : as of `bearing_sim.physics.load_balance.balance_ring`; the squeeze is that of a rigid ring.
    elastic : `ElasticRing`.
    bending : `Bending` of this ring, start and result: the deflection w and its slope at the rollers, the forces of the seat.

    Returns
    -------
    converged : bool
    """
    size = bending.sides.shape[0]
    cosine, sine = loads[LOAD.cosine, 0], loads[LOAD.sine, 0]
    shrunk = _turn_seat(turn, cosine, sine, pressure, elastic, bending)
    load_y, load_z = _turned(load_y, load_z, cosine, sine)
    allowed = _RELATIVE_RESIDUAL * math.hypot(load_y, load_z) + _LEAST_RESIDUAL
    law, typical = (stiffness, profile), 0.5 * typical_stiffness(stiffness, profile)  # two contacts in series are half as stiff
    if not _find_balance(load_y, load_z, allowed, shrunk, False, press_between_raceways, law, typical, elastic, loads, bending):
        return False
    values = bending.tableau[size + 1]
    x_y, x_z = _place_in_housing(cosine, sine, elastic, bending)
    y, z = -values[size - 2] - x_y, -values[size - 1] - x_z
    _conclude(y, z, elastic, loads, bending)
    ring[0], ring[1] = _turned(y, z, cosine, -sine)
    return True


@kernel
def _place_in_housing(cosine, sine, elastic, bending):
    """Write where the ring is in its housing, and return it in axes that turn with the cage, of an angle of that cosine and sine [m]."""
    points, parts, rows, held = elastic.seat.shape[0], elastic.turning.shape[0], bending.rollers, bending.held
    y, z, places = held[0], held[1], bending.points
    for j in range(rows.shape[1]):
        y += elastic.radial * rows[ROLLER.force, j] * elastic.directions[0, parts * j]
        z += elastic.radial * rows[ROLLER.force, j] * elastic.directions[1, parts * j]
    places[POINT.gap, points], places[POINT.gap, points + 1] = _turned(held[0], held[1], cosine, -sine)
    places[POINT.force, points], places[POINT.force, points + 1] = _turned(y, z, cosine, -sine)
    return y, z


@kernel
def typical_stiffness(stiffness, profile):
    """Return the stiffness of a contact from which springs start [N/m]."""
    return profile_force(_TYPICAL, stiffness, profile)[1]


@kernel
def _turn_seat(turn, cosine, sine, pressure, elastic, bending):
    """Turn the axes of the seat to a cage angle; parameters as of `deflect_elastic_ring`; return what the ring has shrunk, see `seat_gap`."""
    points = elastic.seat.shape[0]
    play, shrunk = seat_gap(pressure, elastic)
    _look_at_bore(turn, play, elastic, bending)
    x_y, x_z = bending.points[POINT.gap, points], bending.points[POINT.gap, points + 1]
    bending.held[0], bending.held[1] = _turned(x_y, x_z, cosine, sine)
    return shrunk


@kernel
def deflect_elastic_ring(angle, pressure, press, law, typical, elastic, loads, bending):
    """Find the deflections of the outer ring under rollers whose places are known.

    Parameters
    ----------
    angle : azimuth of the pocket of roller 0 [rad]; rollers count as if they stood in the middles of their pockets.
    pressure, elastic : as of `balance_elastic_ring`.
    press, law : kernel ``(law, approaches, loads)`` that presses rollers outwards, as `press_outwards` does, and what it needs.
    typical : stiffness of a contact [N/m], see `typical_stiffness`.
    loads : array with rows `LOAD`; the squeeze goes in, of a roller against a rigid ring [m], and as ``free`` the approach at which its contact
        begins [m]; centrifugal is zero.
    bending : `Bending`, start and result: rows `ROLLER`.

    Returns
    -------
    converged : bool
    """
    rollers, parts, rows = loads.shape[1], elastic.turning.shape[0], bending.rollers
    cosine, sine, allowed = math.cos(angle), math.sin(angle), _LEAST_RESIDUAL
    shrunk = _turn_seat(angle / (2.0 * math.pi), cosine, sine, pressure, elastic, bending)
    for j in range(rollers):
        allowed += _MOVING_RESIDUAL * loads[LOAD.outer, j]
    if not _find_balance(0.0, 0.0, allowed, shrunk, True, press, law, typical, elastic, loads, bending):
        return False
    y, z = _place_in_housing(cosine, sine, elastic, bending)
    _conclude(-y, -z, elastic, loads, bending)
    for j in range(rollers):
        along = z * elastic.directions[0, parts * j] - y * elastic.directions[1, parts * j]
        rows[ROLLER.moved, j] = loads[LOAD.squeeze, j] - loads[LOAD.approach, j]
        rows[ROLLER.slope, j] += along
    return True


@kernel
def follow_rollers(loads, rates, bending):
    """Write how fast the ring that `deflect_elastic_ring` has found follows the rollers, and which share of a further approach is the contact's.

    With B the springs' response of forces to approaches, S the contacts' stiffness and s the springs' compliance, forces change by
    q' = B (rate - (1/S - s) q').

    Parameters
    ----------
    loads, bending : as of `deflect_elastic_ring`.
    rates : derivatives by time of the squeeze [m/s], shape (Z,), and of whatever else changes a force, as a squeeze that changes it as much.
    """
    points, rollers, tableau, sides, rows = bending.points.shape[1] - 2, loads.shape[1], bending.tableau, bending.sides, bending.rollers
    changes, softer, driven, alike = bending.given, bending.softer, bending.scratch, _are_alike(points, loads, bending)
    for j in range(rollers):
        slope = loads[LOAD.slope, j]
        presses, own = slope > 0.0 and sides[points + j] == _TOUCHING, tableau[points + j, points + j]
        softer[j] = 1.0 / slope - bending.held[2] if presses else 0.0
        changes[j] = slope * rates[j] if presses else 0.0
        yields = -1.0 / own if presses else own - bending.held[2] + 1.0 / slope if slope > 0.0 else 0.0
        rows[ROLLER.share, j] = 1.0 / ((yields + softer[j]) * slope) if slope > 0.0 else 1.0
    for _ in range(_RATE_ITERATIONS if alike else 0):
        for j in range(rollers):
            driven[j] = 0.0
        for k in range(rollers):
            if sides[points + k] == _TOUCHING:
                _add(softer[k] * changes[k] - rates[k], tableau[points + k], points, rollers, driven)
        for j in range(rollers):
            changes[j] = driven[j] if loads[LOAD.slope, j] > 0.0 and sides[points + j] == _TOUCHING else 0.0
    if not alike:
        _solve_rates(points, rates, loads, bending)
    for j in range(rollers):
        slope = loads[LOAD.slope, j]
        rows[ROLLER.rate, j] = rates[j] - changes[j] / slope if slope > 0.0 and sides[points + j] == _TOUCHING else 0.0


@kernel
def _solve_rates(points, rates, loads, bending):
    """Write the changes of forces of `follow_rollers` into ``bending.given``, by elimination; B is positive definite, so that this succeeds."""
    rollers, tableau, matrix, right, count = loads.shape[1], bending.tableau, bending.matrix, bending.right, 0
    for j in range(rollers):
        if loads[LOAD.slope, j] > 0.0 and bending.sides[points + j] == _TOUCHING:
            column, right[count] = 0, 0.0
            for k in range(rollers):
                if loads[LOAD.slope, k] > 0.0 and bending.sides[points + k] == _TOUCHING:
                    matrix[count, column] = -tableau[points + j, points + k] * bending.softer[k]
                    right[count] -= tableau[points + j, points + k] * rates[k]
                    column += 1
            matrix[count, count] += 1.0
            count += 1
    if not decompose(count, matrix, bending.order):
        return
    back_substitute(count, matrix, bending.order, right)
    count = 0
    for j in range(rollers):
        if loads[LOAD.slope, j] > 0.0 and bending.sides[points + j] == _TOUCHING:
            bending.given[j] = right[count]
            count += 1
