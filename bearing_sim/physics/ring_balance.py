# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Quasi-static balance of rollers, a bending outer ring and the housing that backs it, for rollers that stand in even pitches.

The seat of the ring is looked at in M points, a whole number of them to a roller pitch.  With F(psi) the deflection of the ring at an angle psi from
a unit force and H(psi) that of the housing (`bearing_sim.physics.outer_ring`), roller forces Q and seat forces f deflect the ring by

    w(phi) = sum of F(phi - phi_j) Q_j - sum of F(phi - theta_i) f_i,

and the seat's points meet the housing where

    play + bore(theta_i) + sum of H(theta_i - theta_k) f_k - w(theta_i) - x.e(theta_i) >= 0,    f_i >= 0,    one of them zero,

x the motion of the ring in its housing, which follows from sum of f e = sum of Q e.  Everything is measured from the centre of the ring.

**Seat.** For given roller forces the seat forces are the solution of a linear complementarity problem with a positive definite matrix.  A change of
sides of a point is a principal pivot (A. W. Tucker, Principal pivotal transforms of square matrices, SIAM Review 5, 1963); as long as no point
changes, a solution is one product with the transformed matrix.  Where signs are wrong, what is wrong is taken away bit by bit and the point that
first reaches zero changes sides: the parametric method of R. W. Cottle (Monotone solutions of the parametric linear complementarity problem,
Mathematical Programming 3, 1972), which ends after finitely many changes, as many as there are wrong signs or a few more.

**Rollers.** Unknown are the forces q_j that press the ring outwards and the position y of the inner ring from the housing's centre:
q_j = Q_j(squeeze_j - w_j(q) - e_j.x(q) + e_j.y), sum of the inner loads = load.  These are the gradient of a convex potential of w + x.e and y.
A correction solves the same equations with rollers that are springs of the stiffness they have now, and still let go and close: one problem of
complementarity for rollers and seat.  Where that serves, the compliance of a moment ago and the rollers that carry now are enough.  A correction is
halved until what is left of the gradient does not push back by more than half of what it pushed forward.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.linear_algebra import back_substitute, decompose
from bearing_sim.physics.load_balance import LOAD, press_roller, squeezed_roller
from bearing_sim.physics.outer_ring import RingSection, ring_compliance
from bearing_sim.physics.raceway import contour_at, contour_table

_CENTRING_STIFFNESS = 1e3  # N/m, of rings that nothing holds, as in `bearing_sim.physics.load_balance` (assumption)
_ITERATIONS, _HALVINGS = 100, 12
_RELATIVE_RESIDUAL, _LEAST_RESIDUAL = 1e-6, 1e-3  # of the load, as for a rigid ring; N, of a light load
_HOLDING_STIFFNESS = 1e5  # N/m, towards where the outer ring was an iteration ago: none is left of it at the end (assumption)
_PIVOTS, _ROUNDS = 2000, 20  # changes of sides at most; solutions of a problem, each after the changes that the one before asked for
_WRONG_FORCE, _WRONG_GAP = 1e-7, 1e-12  # of all forces; m
_SERVES = 0.2  # of the residual before, that a compliance of a moment ago has to leave at most (assumption)
_CLOSING, _LEAST_CLOSING = 1e-6, 1e-3  # m, over which a roller that closes is a spring; least load that it has then [N] (assumptions)
_REFRESHED = 1000  # pivots after which rounding is removed (assumption)


class ElasticRing(NamedTuple):
    """The ring and its seat, for Z rollers in even pitches and M points of the seat; without any (M = 0) the ring is free."""

    between: np.ndarray  # F(psi) [m/N], periodic cubic table of `bearing_sim.physics.raceway`, shape (n, 4)
    rollers: np.ndarray  # F at multiples of the pitch [m/N], shape (Z,)
    turning: np.ndarray  # dF/dpsi there [m/(N rad)], shape (Z,)
    seat: np.ndarray  # F + H at multiples of 2 pi/M, and a part in one wave that makes it regular and moves x alone [m/N], shape (M,)
    directions: np.ndarray  # cosine and sine of the points' azimuths, shape (2, M)
    bore: np.ndarray  # how far the bore lies outside of its mean [m], shape (M,)
    play: float  # radial play of the ring in the bore, negative for an interference [m]; NaN: by the seat's pressure
    loose: float  # play by a pressure that would close it, and the equivalent interference by pressure [m/Pa]
    pressed: float
    shrunk: float  # deflection of the ring by that pressure, which the mean growth contains [m/Pa]


class Bending(NamedTuple):
    """Memory of the balance; see `new_bending`."""

    rollers: np.ndarray  # rows `ROLLER`, shape (len(ROLLER), Z)
    points: np.ndarray  # rows `POINT`, shape (len(POINT), M + 2); the last two columns belong to x
    by_roller: np.ndarray  # F and dF/dpsi from roller 0 to each point, twice around, shape (2, 2 M)
    tableau: np.ndarray  # transposed principal pivotal transform by the points that touch, and x, shape (M + 2, M + 2)
    touching: np.ndarray  # sides of its rows, see `_settle`, and how many pivots there were, int64, shape (M + 3,)
    compliance: np.ndarray  # w + x.e at the rollers by the forces at them, shape (Z, Z)
    system: np.ndarray  # transposed transform of all equations: seat, x, rollers, y; shape (M + Z + 4, M + Z + 4)
    sides: np.ndarray  # which of them have been pivoted, int64, shape (M + Z + 4,)
    vectors: np.ndarray  # given, found and scratch, shape (3, M + Z + 4)
    matrix: np.ndarray  # of a correction by the compliance, shape (Z + 2, Z + 2)
    right: np.ndarray  # shape (Z + 2,)
    order: np.ndarray  # int64, shape (Z + 2,)
    state: np.ndarray  # whether the compliance is known, and x an iteration ago [m], shape (3,)


class RollerRow(NamedTuple):
    """Rows of ``Bending.rollers``."""

    deflection: int = 0  # w [m]
    slope: int = 1  # dw/dphi [m/rad]
    force: int = 2  # q, on the ring outwards [N]
    start_force: int = 3  # where an iteration began
    start_deflection: int = 4
    start_left: int = 5  # q less the load that it should be
    correction: int = 6  # of q [N]


ROLLER = RollerRow()


class PointRow(NamedTuple):
    """Rows of ``Bending.points``."""

    force: int = 0  # f [N]; x and the rest of its equation [m]
    gap: int = 1  # without forces [m]
    pushed: int = 2  # w by the roller forces [m]; their sum y, z [N]
    given: int = 3  # scratch
    found: int = 4


POINT = PointRow()


_POINTS_A_PITCH = 4  # of the seat; lives err by 0.3 % against 8 of them
_TABLE_INTERVALS = 720


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


def new_elastic_ring(section: RingSection, seat: Seat | None, rollers: int, points: int = _POINTS_A_PITCH) -> ElasticRing:
    """Return an elastic ring.

    Parameters
    ----------
    section : of the ring.
    seat : what backs it; None: nothing but a pressure like the cosine of the angle from the load, in which the ring keeps its shape.
    rollers : their number Z.
    points : of the seat to a pitch; the ring bends in as many waves as two points resolve, Z points/2.
    """
    count = points * rollers
    n = np.arange(count // 2 + 1)
    compliances = ring_compliance(n, section)
    grid, pitches = (2.0 * math.pi / steps * np.arange(steps) for steps in (_TABLE_INTERVALS, rollers))
    table = contour_table(np.cos(np.outer(grid, n)) @ compliances, -np.sin(np.outer(grid, n)) @ (n * compliances))
    among, turning = np.cos(np.outer(pitches, n)) @ compliances, -np.sin(np.outer(pitches, n)) @ (n * compliances)
    if seat is None:
        none = np.zeros(0)
        return ElasticRing(table, among, turning, none, np.zeros((2, 0)), none, 0.0, 0.0, 0.0, 0.0)
    azimuths = 2.0 * math.pi / count * np.arange(count)
    housing = seat.compliances(n) / (math.pi * seat.radius * seat.width)  # by a force at one point
    housing[0] *= 0.5
    if count % 2 == 0:
        housing[-1] *= 0.5  # the finest wave has one phase
    housing[1] += housing[2]  # makes the matrix regular; it moves x, which the balance of forces determines
    return ElasticRing(
        table,
        among,
        turning,
        np.cos(np.outer(azimuths, n)) @ (compliances + housing),
        np.stack([np.cos(azimuths), np.sin(azimuths)]),
        np.asarray(seat.bore(azimuths), float),
        seat.play,
        seat.loose,
        seat.pressed,
        seat.shrunk,
    )


def new_bending(elastic: ElasticRing) -> Bending:
    """Return the memory for a ring; the seat touches everywhere."""
    rollers, points = elastic.rollers.shape[0], elastic.seat.shape[0]
    size = rollers + 2
    bending = Bending(
        rollers=np.zeros((len(ROLLER), rollers)),
        points=np.zeros((len(POINT), points + 2)),
        by_roller=np.zeros((2, 2 * points)),
        tableau=np.zeros((points + 2, points + 2)),
        touching=np.zeros(points + 3, np.int64),
        compliance=np.zeros((rollers, rollers)),
        system=np.zeros((size + points + 2, size + points + 2)),
        sides=np.zeros(size + points + 2, np.int64),
        vectors=np.zeros((3, size + points + 2)),
        matrix=np.zeros((size, size)),
        right=np.zeros(size),
        order=np.zeros(size, np.int64),
        state=np.zeros(3),
    )
    bending.touching[:-1], bending.touching[points : points + 2], bending.touching[-1] = 1, 2, _REFRESHED
    return bending


@kernel
def _pivot(k, tableau):
    """Exchange what is given and what is found at an index."""
    size = tableau.shape[0]
    inverse = 1.0 / tableau[k, k]
    for j in range(size):
        if j != k:
            part = tableau[j, k] * inverse
            for i in range(size):
                tableau[j, i] -= part * tableau[k, i]
            tableau[j, k] = -part
    for i in range(size):
        tableau[k, i] *= inverse
    tableau[k, k] = inverse


@kernel
def _refresh(elastic, bending):
    """Write the tableau anew for the points that touch."""
    points, tableau = elastic.seat.shape[0], bending.tableau
    for i in range(points):
        for k in range(points):
            tableau[k, i] = elastic.seat[abs(i - k)]
        for axis in range(2):
            tableau[points + axis, i], tableau[i, points + axis] = -elastic.directions[axis, i], elastic.directions[axis, i]
    for axis in range(2):
        tableau[points + axis, points + axis], tableau[points + axis, points + 1 - axis] = _HOLDING_STIFFNESS, 0.0
    for i in range(points + 2):
        if bending.touching[i] > 0:
            _pivot(i, tableau)
    bending.touching[points + 2] = 0


@kernel
def _apply(given, found, tableau):
    """Write the product of the tableau with ``given`` into ``found``."""
    size = tableau.shape[0]
    for i in range(size):
        found[i] = 0.0
    for k in range(size):
        value = given[k]
        if value != 0.0:
            for i in range(size):
                found[i] += value * tableau[k, i]


@kernel
def _settle(allowed, tableau, sides, values, offsets):
    """Change sides until no force pulls and no gap is negative; return how many did, -1 where there was no end.

    Parameters
    ----------
    allowed : force that counts as none [N].
    tableau : transposed transform.
    sides : 0 of what is open, 1 of what touches, 2 of what has no sign, which stays.
    values : gaps of what is open [m], forces of what touches [N]; changed.
    offsets : scratch.
    """
    size, wrong = tableau.shape[0], 0
    for i in range(size):
        offsets[i] = 0.0
        if sides[i] < 2 and values[i] < -(allowed if sides[i] == 1 else _WRONG_GAP):
            offsets[i] = -values[i] * (1.0 + 1e-3 * ((i * 37) % 101))  # no two alike, so that no two reach zero together
            wrong += 1
        elif sides[i] < 2:
            values[i] = max(values[i], 0.0)
    if wrong == 0:
        return 0
    for change in range(_PIVOTS):
        first, highest = -1, 0.0
        for i in range(size):
            if sides[i] < 2 and offsets[i] > 0.0 and values[i] < 0.0:
                reached = -values[i] / offsets[i]
                if reached > highest:
                    first, highest = i, reached
        if first < 0:
            return change
        inverse = 1.0 / tableau[first, first]
        value, offset = values[first] * inverse, offsets[first] * inverse
        for i in range(size):
            values[i] -= tableau[first, i] * value
            offsets[i] -= tableau[first, i] * offset
        values[first], offsets[first] = -value, -offset
        _pivot(first, tableau)
        sides[first] = 1 - sides[first]
    return -1


@kernel
def _press_seat(elastic, bending):
    """Find the forces of the seat for the pushes of the rollers in ``bending.points``; return whether they were found."""
    points, touching, rows = elastic.seat.shape[0], bending.touching, bending.points
    given, found = rows[POINT.given], rows[POINT.found]
    allowed = _WRONG_FORCE * (abs(rows[POINT.pushed, points]) + abs(rows[POINT.pushed, points + 1]) + 1.0)
    if touching[points + 2] >= _REFRESHED:
        _refresh(elastic, bending)
    for _ in range(_ROUNDS):
        for i in range(points):
            given[i] = rows[POINT.pushed, i] - rows[POINT.gap, i] if touching[i] == 1 else 0.0
        given[points], given[points + 1] = rows[POINT.pushed, points], rows[POINT.pushed, points + 1]
        _apply(given, found, bending.tableau)
        for i in range(points + 2):
            rows[POINT.force, i] = found[i] if touching[i] > 0 else 0.0
        for i in range(points):
            if touching[i] == 0:
                found[i] += rows[POINT.gap, i] - rows[POINT.pushed, i]
        changes = _settle(allowed, bending.tableau, touching, found, given)
        if changes <= 0:
            return changes == 0
        touching[points + 2] += changes
    return False


@kernel
def _between(among, j, k):
    """Return F(phi_j - phi_k) or its derivative, from its values at multiples of the pitch."""
    return among[j - k if j >= k else j - k + among.shape[0]]


@kernel
def _deflect(among, to_points, row, elastic, bending):
    """Write w, or its slope, at the rollers into a row of ``bending.rollers``; ``among`` and ``to_points`` are F or its derivative."""
    rollers, points = elastic.rollers.shape[0], elastic.seat.shape[0]
    per_pitch, forces, pressed = points // rollers, bending.rollers[ROLLER.force], bending.points[POINT.force]
    for j in range(rollers):
        start, value = points - per_pitch * j, 0.0
        for k in range(rollers):
            value += _between(among, j, k) * forces[k]
        first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
        for i in range(0, points - 3, 4):
            first += to_points[start + i] * pressed[i]
            second += to_points[start + i + 1] * pressed[i + 1]
            third += to_points[start + i + 2] * pressed[i + 2]
            fourth += to_points[start + i + 3] * pressed[i + 3]
        for i in range(points - points % 4, points):
            first += to_points[start + i] * pressed[i]
        bending.rollers[row, j] = value - (first + second + third + fourth)


@kernel
def _look_from_rollers(turn, elastic, bending):
    """Write F and its slope from roller 0, at ``turn`` turns, to each point."""
    points, intervals = elastic.seat.shape[0], elastic.between.shape[0]
    for i in range(points):
        apart = turn - i / points
        value, slope = contour_at(elastic.between, (apart - math.floor(apart)) * intervals)
        bending.by_roller[0, i], bending.by_roller[0, i + points] = value, value
        bending.by_roller[1, i], bending.by_roller[1, i + points] = slope, slope


@kernel
def _respond(shrunk, elastic, loads, bending):
    """Write the deflections by the forces in ``bending.rollers``; return whether the seat's forces were found."""
    rollers, points, rows = elastic.rollers.shape[0], elastic.seat.shape[0], bending.points
    if points > 0:
        per_pitch, pushed = points // rollers, rows[POINT.pushed]
        for i in range(points + 2):
            pushed[i] = 0.0
        for j in range(rollers):
            force, start = bending.rollers[ROLLER.force, j], points - per_pitch * j
            pushed[points] += force * loads[LOAD.cosine, j]
            pushed[points + 1] += force * loads[LOAD.sine, j]
            for i in range(points):
                pushed[i] += force * bending.by_roller[0, start + i]
        pushed[points] += _HOLDING_STIFFNESS * bending.state[1]
        pushed[points + 1] += _HOLDING_STIFFNESS * bending.state[2]
        if not _press_seat(elastic, bending):
            return False
    _deflect(elastic.rollers, bending.by_roller[0], ROLLER.deflection, elastic, bending)
    for j in range(rollers):
        bending.rollers[ROLLER.deflection, j] += shrunk
    return True


@kernel
def _write_system(elastic, loads, bending):
    """Write the transform of all equations for the points that touch, and the compliance of the rollers."""
    rollers, points, tableau, system = elastic.rollers.shape[0], elastic.seat.shape[0], bending.tableau, bending.system
    first, size, per_pitch = points + 2, points + rollers + 4, points // rollers
    given, found = bending.points[POINT.given], bending.points[POINT.found]
    for k in range(first):
        bending.sides[k] = bending.touching[k]
        for i in range(first):
            system[k, i] = tableau[k, i]
        for i in range(first, size):
            system[k, i] = 0.0
    for k in range(first, size):
        bending.sides[k] = 0
        for i in range(size):
            system[k, i] = 0.0
    for j in range(rollers):
        start, column = points - per_pitch * j, first + j
        for i in range(points):
            given[i] = bending.by_roller[0, start + i]
        given[points], given[points + 1] = loads[LOAD.cosine, j], loads[LOAD.sine, j]
        for i in range(first):
            system[column, i] = 0.0 if bending.touching[i] > 0 else -given[i]
        for i in range(first):
            if bending.touching[i] == 0:
                given[i] = 0.0
        _apply(given, found, tableau)
        for i in range(first):
            system[column, i] += found[i]
            # the equations are symmetric but for the signs of x and y, and a pivot turns a sign
            same = (bending.touching[i] == 0) == (i < points)
            system[i, column] = system[column, i] if same else -system[column, i]
    for j in range(rollers):
        start, row = points - per_pitch * j, first + j
        for k in range(rollers):
            value = _between(elastic.rollers, j, k)
            for i in range(points):
                if bending.touching[i] == 1:
                    value -= bending.by_roller[0, start + i] * system[first + k, i]
            value += loads[LOAD.cosine, j] * system[first + k, points] + loads[LOAD.sine, j] * system[first + k, points + 1]
            bending.compliance[j, k] = value
            system[first + k, row] = value
        for axis in range(2):
            direction = loads[LOAD.cosine + axis, j]
            system[size - 2 + axis, row], system[row, size - 2 + axis] = -direction, direction
    for axis in range(2):
        system[size - 2 + axis, size - 2 + axis] = _CENTRING_STIFFNESS
    bending.state[0] = 1.0


@kernel
def _correct_all(load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending):
    """Write the correction by all equations with rollers as springs; return whether it was found, and the inner ring's position y, z [m].

    Parameters
    ----------
    load_y, load_z : radial load on the inner ring [N].
    shrunk, stiffness, profile, elastic, loads, bending : as of `balance_elastic_ring`.
    """
    _write_system(elastic, loads, bending)
    rollers, points, system, sides = elastic.rollers.shape[0], elastic.seat.shape[0], bending.system, bending.sides
    first, size, per_pitch = points + 2, points + rollers + 4, points // rollers
    given, found, right = bending.vectors[0], bending.vectors[1], bending.right
    for i in range(size):
        given[i] = 0.0
    for i in range(points):
        given[i] = -bending.points[POINT.gap, i]
    for j in range(rollers):
        carried, start = loads[LOAD.centrifugal, j], points - per_pitch * j
        given[points] += carried * loads[LOAD.cosine, j]
        given[points + 1] += carried * loads[LOAD.sine, j]
        for i in range(points):
            given[i] += carried * bending.by_roller[0, start + i]
        if loads[LOAD.slope, j] > 0.0:
            slope = loads[LOAD.slope, j]
            opens = loads[LOAD.approach, j] - loads[LOAD.inner, j] / slope
        else:
            opens = loads[LOAD.free, j]
            _, pressed, _, _ = squeezed_roller(opens + _CLOSING, carried, opens, 0.0, stiffness, profile)
            slope = max(pressed, _LEAST_CLOSING) / _CLOSING
        system[first + j, first + j] += 1.0 / slope
        right[j] = loads[LOAD.squeeze, j] - shrunk - opens
    for j in range(rollers):
        for k in range(rollers):
            right[j] -= _between(elastic.rollers, j, k) * loads[LOAD.centrifugal, k]
        given[first + j] = right[j]
    given[points] += _HOLDING_STIFFNESS * bending.state[1]
    given[points + 1] += _HOLDING_STIFFNESS * bending.state[2]
    given[size - 2], given[size - 1] = load_y, load_z
    for j in range(rollers):
        if loads[LOAD.slope, j] > 0.0:
            _pivot(first + j, system)
            sides[first + j] = 1
    for axis in range(2):
        _pivot(size - 2 + axis, system)
        sides[size - 2 + axis] = 2
    allowed, basic = _WRONG_FORCE * (abs(load_y) + abs(load_z) + 1.0), bending.vectors[2]
    for _ in range(_ROUNDS):
        for i in range(size):
            basic[i] = given[i] if sides[i] > 0 else 0.0
        _apply(basic, found, system)
        for j in range(rollers):
            pressed = found[first + j] if sides[first + j] == 1 else 0.0
            bending.rollers[ROLLER.correction, j] = pressed + loads[LOAD.centrifugal, j] - bending.rollers[ROLLER.start_force, j]
        y, z = found[size - 2], found[size - 1]
        for i in range(size):
            if sides[i] == 0:
                found[i] -= given[i]
        changes = _settle(allowed, system, sides, found, basic)
        if changes <= 0:
            return changes == 0, y, z
    return False, 0.0, 0.0


@kernel
def _correct_carrying(force_y, force_z, elastic, loads, bending):
    """Write the correction by the compliance and the rollers that carry now; return whether it was found, and the inner ring's step y, z [m].

    Parameters
    ----------
    force_y, force_z : what the load leaves of the rollers' forces on the inner ring [N].
    elastic, loads, bending : as of `balance_elastic_ring`.
    """
    rollers, matrix, right = elastic.rollers.shape[0], bending.matrix, bending.right
    count = 0
    for j in range(rollers):
        if loads[LOAD.slope, j] != 0.0:
            count += 1
    last_y, last_z, row = count, count + 1, 0
    for column in range(count + 2):
        matrix[last_y, column], matrix[last_z, column] = 0.0, 0.0
    matrix[last_y, last_y], matrix[last_z, last_z] = _CENTRING_STIFFNESS, _CENTRING_STIFFNESS
    right[last_y], right[last_z] = force_y, force_z
    for j in range(rollers):
        if loads[LOAD.slope, j] == 0.0:
            continue
        slope, cosine, sine, column = loads[LOAD.slope, j], loads[LOAD.cosine, j], loads[LOAD.sine, j], 0
        for k in range(rollers):
            if loads[LOAD.slope, k] == 0.0:
                continue
            part = slope * bending.compliance[j, k]
            matrix[row, column] = part + (1.0 if j == k else 0.0)
            matrix[last_y, column] -= part * cosine
            matrix[last_z, column] -= part * sine
            column += 1
        matrix[row, last_y], matrix[row, last_z] = -slope * cosine, -slope * sine
        matrix[last_y, last_y] += slope * cosine * cosine
        matrix[last_y, last_z] += slope * cosine * sine
        matrix[last_z, last_y] += slope * cosine * sine
        matrix[last_z, last_z] += slope * sine * sine
        right[row] = -bending.rollers[ROLLER.start_left, j]
        row += 1
    if not decompose(count + 2, matrix, bending.order):
        return False, 0.0, 0.0
    back_substitute(count + 2, matrix, bending.order, right)
    row = 0
    for j in range(rollers):
        carries = loads[LOAD.slope, j] != 0.0
        bending.rollers[ROLLER.correction, j] = right[row] if carries else -bending.rollers[ROLLER.start_left, j]
        row += 1 if carries else 0
    return True, right[last_y], right[last_z]


@kernel
def _squeeze_rollers(y, z, stiffness, profile, loads, bending):
    """Balance all rollers at a position of the inner ring from the outer's centre and the deflections; return the sum of inner loads y, z."""
    sum_y, sum_z = 0.0, 0.0
    for j in range(loads.shape[1]):
        cosine, sine = loads[LOAD.cosine, j], loads[LOAD.sine, j]
        approach = loads[LOAD.squeeze, j] - bending.rollers[ROLLER.deflection, j] + y * cosine + z * sine
        inner_load, _ = press_roller(j, approach, stiffness, profile, loads)
        sum_y += inner_load * cosine
        sum_z += inner_load * sine
    return sum_y, sum_z


@kernel
def seat_gap(pressure, elastic):
    """Return the play of the ring in its bore [m], and how far the raceway's mean growth has moved it inwards already [m].

    Parameters
    ----------
    pressure : of the seat by fit and temperatures [Pa]; negative: what a gap lacks to close.
    elastic : `ElasticRing`.
    """
    if not math.isnan(elastic.play):
        return elastic.play, 0.0
    if pressure > 0.0:
        return -pressure * elastic.pressed, pressure * elastic.shrunk
    return -pressure * elastic.loose, 0.0


@kernel
def _evaluate(y, z, load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending):
    """Evaluate ring, seat and rollers; return whether that was possible, what the load leaves y, z [N], and the largest residual force [N]."""
    if not _respond(shrunk, elastic, loads, bending):
        return False, 0.0, 0.0, 0.0
    points = elastic.seat.shape[0]
    x_y, x_z = bending.points[POINT.force, points], bending.points[POINT.force, points + 1]
    sum_y, sum_z = _squeeze_rollers(y - x_y, z - x_z, stiffness, profile, loads, bending)
    force_y, force_z = load_y - sum_y - _CENTRING_STIFFNESS * y, load_z - sum_z - _CENTRING_STIFFNESS * z
    residual = max(abs(force_y), abs(force_z))
    for j in range(elastic.rollers.shape[0]):
        residual = max(residual, abs(bending.rollers[ROLLER.force, j] - loads[LOAD.outer, j]))
    return True, force_y, force_z, residual


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
    bending : `Bending`, start and result: the deflection w and its slope at the rollers, the forces of the seat.

    Returns
    -------
    converged : bool
    """
    rollers, points, rows = elastic.rollers.shape[0], elastic.seat.shape[0], bending.rollers
    play, shrunk = seat_gap(pressure, elastic)
    for i in range(points):
        bending.points[POINT.gap, i] = play + elastic.bore[i]
    _look_from_rollers(turn, elastic, bending)
    y, z = ring[0] + bending.points[POINT.force, points], ring[1] + bending.points[POINT.force, points + 1]
    before = math.inf
    allowed = _RELATIVE_RESIDUAL * math.hypot(load_y, load_z) + _LEAST_RESIDUAL
    fine, force_y, force_z, residual = _evaluate(y, z, load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
    for _ in range(_ITERATIONS):
        start_x_y, start_x_z = bending.points[POINT.force, points], bending.points[POINT.force, points + 1]
        if not fine:
            return False
        moved = max(abs(start_x_y - bending.state[1]), abs(start_x_z - bending.state[2]))
        if residual <= allowed and _HOLDING_STIFFNESS * moved <= allowed:
            ring[0], ring[1] = y - start_x_y, z - start_x_z
            _deflect(elastic.turning, bending.by_roller[1], ROLLER.slope, elastic, bending)
            return True
        bending.state[1], bending.state[2] = start_x_y, start_x_z
        for j in range(rollers):
            rows[ROLLER.start_force, j], rows[ROLLER.start_deflection, j] = rows[ROLLER.force, j], rows[ROLLER.deflection, j]
            rows[ROLLER.start_left, j] = rows[ROLLER.force, j] - loads[LOAD.outer, j]
        serves = bending.state[0] > 0.0 and residual <= _SERVES * before
        if serves:
            fine, step_y, step_z = _correct_carrying(force_y, force_z, elastic, loads, bending)
        else:
            fine, step_y, step_z = _correct_all(load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
            step_y, step_z = step_y - y, step_z - z
        if not fine:
            return False
        before = residual
        start_y, start_z, scale = y, z, 1.0
        for _ in range(_HALVINGS):
            for j in range(rollers):
                rows[ROLLER.force, j] = rows[ROLLER.start_force, j] + scale * rows[ROLLER.correction, j]
            y, z = start_y + scale * step_y, start_z + scale * step_z
            fine, next_y, next_z, residual = _evaluate(y, z, load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
            if not fine:
                break
            x_y, x_z = bending.points[POINT.force, points] - start_x_y, bending.points[POINT.force, points + 1] - start_x_z
            forward, back = -force_y * (y - start_y) - force_z * (z - start_z), -next_y * (y - start_y) - next_z * (z - start_z)
            for j in range(rollers):
                moved = rows[ROLLER.deflection, j] - rows[ROLLER.start_deflection, j]
                moved += loads[LOAD.cosine, j] * x_y + loads[LOAD.sine, j] * x_z
                forward += rows[ROLLER.start_left, j] * moved
                back += (rows[ROLLER.force, j] - loads[LOAD.outer, j]) * moved
            if back <= 0.5 * abs(forward) or residual <= allowed or scale == 0.0:
                break
            if serves:  # not so well: begin again with all equations
                scale, bending.state[0] = 0.0, 0.0
            else:
                scale *= 0.5
        force_y, force_z = next_y, next_z
    return False
