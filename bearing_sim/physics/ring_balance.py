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

**Seat.** For given roller forces the seat forces are the solution of a linear complementarity problem with a positive definite matrix.  A change of
sides of a point is a principal pivot (A. W. Tucker, Principal pivotal transforms of square matrices, SIAM Review 5, 1963); as long as no point
changes, a solution is one product with the transformed matrix.  With the signs of A. P. Dempster's sweep operator (Elements of Continuous
Multivariate Analysis, 1969) it stays symmetric.  It holds the equations of rollers and inner ring too, and so their compliance.  Where signs are
wrong, what is wrong is taken away bit by bit and the point that first reaches zero changes sides: the parametric method of R. W. Cottle (Monotone
solutions of the parametric linear complementarity problem, Mathematical Programming 3, 1972), which ends after finitely many changes, as many as
there are wrong signs or a few more.

**Rollers.** Unknown are the forces q_j that press the ring outwards and the position y of the inner ring from the housing's centre:
q_j = Q_j(squeeze_j - w_j(q) - e_j.x(q) + e_j.y), sum of the inner loads = load.  These are the gradient of a convex potential of w + x.e and y.
A correction solves the same equations with rollers that are springs of the stiffness they have now.  Mostly the points that touch and the rollers that
carry now are enough; else rollers and seat still let go and close: one problem of complementarity.  A correction is halved until what is left of the
gradient does not push back by more than half of what it pushed forward.
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
_SERVES = 0.2  # of the residual before, that a correction by what touches and carries now has to leave at most (assumption)
_CLOSING, _LEAST_CLOSING = 1e-6, 1e-3  # m, over which a roller that closes is a spring; least load that it has then [N] (assumptions)
_REFRESHED = 1000  # pivots after which rounding is removed (assumption)
_OPEN, _TOUCHING, _UNSIGNED = 0, 1, 2  # sides: where the gap may be anything from zero, where the force may; neither


class ElasticRing(NamedTuple):
    """The ring and its seat, for Z rollers in even pitches and M points of the seat, P to a pitch; without any the ring is free, and P = 1."""

    between: np.ndarray  # F at multiples of pitch/P [m/N], shape (P Z,)
    turning: np.ndarray  # dF/dpsi at k pitches less p parts of P in column Z + k of row p [m/(N rad)], shape (P, 2 Z)
    directions: np.ndarray  # cosine and sine of multiples of pitch/P, shape (2, P Z)
    seat: np.ndarray  # F + H at multiples of 2 pi/M, and a part in one wave that makes it regular and moves x alone [m/N], shape (M,)
    bore: np.ndarray  # how far the bore lies outside of its mean [m], periodic cubic table of `bearing_sim.physics.raceway`, shape (n, 4)
    play: float  # radial play of the ring in the bore, negative for an interference [m]; NaN: by the seat's pressure
    loose: float  # play by a pressure that would close it, and the equivalent interference by pressure [m/Pa]
    pressed: float
    shrunk: float  # deflection of the ring by that pressure, which the mean growth contains [m/Pa]


class Bending(NamedTuple):
    """Memory of the balance; see `new_bending`.

    Tableaus are transforms of N = M + Z + 4 equations by what touches: points, rollers, x, y; of the square the rows of the points end at the diagonal.
    Three rows follow: constants, solution, and what is added to it while sides change.
    """

    rollers: np.ndarray  # rows `ROLLER`, shape (len(ROLLER), Z)
    points: np.ndarray  # rows `POINT`, shape (len(POINT), M + 2); the last two columns belong to x, in axes that stand still
    tableau: np.ndarray  # where points touch and rollers press by forces that are given, shape (N + 3, N)
    sides: np.ndarray  # `_OPEN`, `_TOUCHING` or `_UNSIGNED`, and how many pivots there were, int64, shape (N + 1,)
    system: np.ndarray  # of a correction where rollers are springs, shape (N + 3, N)
    system_sides: np.ndarray  # int64, shape (N + 1,)
    matrix: np.ndarray  # of a correction by what touches and carries, shape (Z + 2, Z + 2)
    right: np.ndarray  # shape (Z + 2,)
    order: np.ndarray  # int64, shape (Z + 2,)
    held: np.ndarray  # x an iteration ago [m], shape (2,)
    scratch: np.ndarray  # shape (N,)


class RollerRow(NamedTuple):
    """Rows of ``Bending.rollers``."""

    deflection: int = 0  # w [m]
    slope: int = 1  # dw/dphi [m/rad]
    force: int = 2  # q, on the ring outwards [N]
    start_force: int = 3  # where an iteration began
    start_moved: int = 4  # w + x.e there [m]
    start_left: int = 5  # q less the load that it should be
    correction: int = 6  # of q [N]


ROLLER = RollerRow()


class PointRow(NamedTuple):
    """Rows of ``Bending.points``."""

    force: int = 0  # f [N]; x [m]
    gap: int = 1  # without forces [m]


POINT = PointRow()


_POINTS_A_PITCH = 4  # of the seat; lives err by 0.5 % against 8 of them
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
    apart = 2.0 * math.pi / count * (parts * np.arange(-rollers, rollers) - np.arange(parts)[:, None])
    turning = -np.sin(np.multiply.outer(apart, n)) @ (n * compliances)
    common = waves @ compliances, turning, np.stack([np.cos(azimuths), np.sin(azimuths)])
    if seat is None:
        return ElasticRing(*common, np.zeros(0), np.zeros((1, 4)), 0.0, 0.0, 0.0, 0.0)
    housing = seat.compliances(n) / (math.pi * seat.radius * seat.width)  # by a force at one point
    housing[0] *= 0.5
    if count % 2 == 0:
        housing[-1] *= 0.5  # the finest wave has one phase
    housing[1] += housing[2]  # makes the matrix regular; it moves x, which the balance of forces determines
    knots = 2.0 * math.pi / _BORE_INTERVALS * np.arange(_BORE_INTERVALS)
    bore = np.asarray(seat.bore(knots), float)
    slopes = (np.roll(bore, -1) - np.roll(bore, 1)) / (2.0 * knots[1])
    table = contour_table(bore, slopes) if np.ptp(bore) > 0.0 else np.array([[0.0, 0.0, 0.0, bore[0]]])
    return ElasticRing(*common, waves @ (compliances + housing), table, seat.play, seat.loose, seat.pressed, seat.shrunk)


def new_bending(elastic: ElasticRing) -> Bending:
    """Return the memory for a ring; the seat touches everywhere."""
    rollers, points = elastic.turning.shape[1] // 2, elastic.seat.shape[0]
    size, equations = rollers + 2, points + rollers + 4
    sides = np.full(equations + 1, _UNSIGNED)
    sides[:points], sides[-1] = _TOUCHING, _REFRESHED
    return Bending(
        rollers=np.zeros((len(ROLLER), rollers)),
        points=np.zeros((len(POINT), points + 2)),
        tableau=np.zeros((equations + 3, equations)),
        sides=sides,
        system=np.zeros((equations + 3, equations)),
        system_sides=sides.copy(),
        matrix=np.zeros((size, size)),
        right=np.zeros(size),
        order=np.zeros(size, np.int64),
        held=np.zeros(2),
        scratch=np.zeros(equations),
    )


@kernel
def _pivot(k, sense, points, column, tableau):
    """Exchange what is given and what is found at an index, forwards (``sense`` 1) or back (-1); ``column`` is scratch."""
    rows, size = tableau.shape
    inverse = 1.0 / tableau[k, k]
    complete = size if k >= points else k + 1
    for i in range(complete):
        column[i] = tableau[k, i]
    for i in range(complete, size):
        column[i] = tableau[i, k]
    for j in range(rows):
        part = inverse * (column[j] if j < size else tableau[j, k])
        if part != 0.0:
            for i in range(j + 1 if j < points else size):
                tableau[j, i] -= part * column[i]
            tableau[j, k] = sense * part
    for i in range(complete):
        tableau[k, i] = sense * inverse * column[i]
    tableau[k, k] = -inverse


@kernel
def _refresh(elastic, bending):
    """Write the tableau anew for the points that touch."""
    points, rollers, tableau = elastic.seat.shape[0], elastic.turning.shape[1] // 2, bending.tableau
    parts, x, size = elastic.turning.shape[0], points + rollers, points + rollers + 4
    for j in range(size + 3):
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
            tableau[row, points + k] = elastic.between[parts * abs(j - k)]
    for axis in range(2):
        for i in range(points):
            tableau[x + axis, i] = -elastic.directions[axis, i]
        for j in range(rollers):
            direction = elastic.directions[axis, parts * j]
            if points > 0:  # a free ring stays where it is
                tableau[x + axis, points + j] = tableau[points + j, x + axis] = direction
            tableau[x + 2 + axis, points + j] = tableau[points + j, x + 2 + axis] = -direction
        tableau[x + axis, x + axis], tableau[x + 2 + axis, x + 2 + axis] = -_HOLDING_STIFFNESS, -_CENTRING_STIFFNESS
    for i in range(points):
        if bending.sides[i] == _TOUCHING:
            _pivot(i, 1.0, points, bending.scratch, tableau)
    for axis in range(2):
        _pivot(x + axis, 1.0, points, bending.scratch, tableau)
    bending.sides[size] = 0


@kernel
def _settle(allowed, points, column, tableau, sides):
    """Change sides until no force pulls and no gap is negative in the solution; return how many did, -1 where there was no end.

    Parameters
    ----------
    allowed : force that counts as none [N].
    points, column, tableau : as of `_pivot`.
    sides : of the equations; how many changed is added to the last.
    """
    size, wrong = tableau.shape[1], False
    values, offsets = tableau[size + 1], tableau[size + 2]  # of what touches: negative
    for i in range(size):
        wrong = wrong or (sides[i] == _OPEN and values[i] < -_WRONG_GAP) or (sides[i] == _TOUCHING and values[i] > allowed)
    if not wrong:
        return 0
    for i in range(size):
        offsets[i] = 0.0
        if (sides[i] == _OPEN and values[i] < -_WRONG_GAP) or (sides[i] == _TOUCHING and values[i] > allowed):
            offsets[i] = -values[i] * (1.0 + 1e-3 * ((i * 37) % 101))  # no two alike, so that no two reach zero together
        elif sides[i] == _OPEN:
            values[i] = max(values[i], 0.0)
        elif sides[i] == _TOUCHING:
            values[i] = min(values[i], 0.0)
    for change in range(_PIVOTS):
        first, highest = -1, 0.0
        for i in range(size):
            if (sides[i] == _OPEN and values[i] < 0.0 and offsets[i] > 0.0) or (sides[i] == _TOUCHING and values[i] > 0.0 and offsets[i] < 0.0):
                reached = -values[i] / offsets[i]
                if reached > highest:
                    first, highest = i, reached
        if first < 0:
            sides[size] += change
            return change
        _pivot(first, 1.0 if sides[first] == _OPEN else -1.0, points, column, tableau)
        sides[first] = _TOUCHING if sides[first] == _OPEN else _OPEN
    return -1


@kernel
def _look_at_bore(turn, play, elastic, bending):
    """Write the gaps of the seat's points at a cage angle [turns], and what they change in the tableau's constants."""
    points, intervals, tableau, size = elastic.seat.shape[0], elastic.bore.shape[0], bending.tableau, bending.tableau.shape[1]
    changes, constants, changed = bending.scratch, tableau[size], False
    for i in range(points):
        at = turn + i / points
        gap = play + contour_at(elastic.bore, (at - math.floor(at)) * intervals)[0]
        changes[i] = gap - bending.points[POINT.gap, i]
        changed = changed or changes[i] != 0.0
        bending.points[POINT.gap, i] = gap
    if not changed or bending.sides[size] >= _REFRESHED:
        return
    for i in range(points):
        if bending.sides[i] == _OPEN:
            constants[i] += changes[i]
            changes[i] = 0.0
    for i in range(size):
        complete, first, second, third, fourth = min(i, points), 0.0, 0.0, 0.0, 0.0
        if i < points:
            for k in range(i + 1):
                constants[k] -= tableau[i, k] * changes[i]
        for k in range(0, complete - 3, 4):
            first += tableau[i, k] * changes[k]
            second += tableau[i, k + 1] * changes[k + 1]
            third += tableau[i, k + 2] * changes[k + 2]
            fourth += tableau[i, k + 3] * changes[k + 3]
        for k in range(complete - complete % 4, complete):
            first += tableau[i, k] * changes[k]
        constants[i] -= first + second + third + fourth


@kernel
def _solve(forces, row, held, tableau):
    """Write the solution of a tableau for roller forces [N], the first of which belongs to a row, and x an iteration ago."""
    size = tableau.shape[1]
    constants, values = tableau[size], tableau[size + 1]
    first, second = tableau[size - 4], tableau[size - 3]
    held_y, held_z = _HOLDING_STIFFNESS * held[0], _HOLDING_STIFFNESS * held[1]
    for i in range(size):
        values[i] = constants[i] - held_y * first[i] - held_z * second[i]
    for j in range(forces.shape[0]):
        force, pushed = forces[j], tableau[row + j]
        for i in range(size):
            values[i] += force * pushed[i]


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
    points, rollers, parts = elastic.seat.shape[0], loads.shape[1], elastic.turning.shape[0]
    forces, tableau = bending.rollers[ROLLER.force], bending.tableau
    values, allowed, changes = tableau[tableau.shape[1] + 1], 1.0, 1
    for j in range(rollers):
        allowed += abs(forces[j])
    for _ in range(_ROUNDS):
        _solve(forces, points, bending.held, tableau)
        changes = _settle(_WRONG_FORCE * allowed, points, bending.scratch, tableau, bending.sides)
        if changes <= 0:
            break
    if changes != 0:
        return False, 0.0, 0.0, 0.0
    force_y, force_z, residual = load_y - _CENTRING_STIFFNESS * y, load_z - _CENTRING_STIFFNESS * z, 0.0
    for j in range(rollers):
        cosine, sine = elastic.directions[0, parts * j], elastic.directions[1, parts * j]
        approach = loads[LOAD.squeeze, j] - shrunk - values[points + j] + y * cosine + z * sine
        inner_load, _ = press_roller(j, approach, stiffness, profile, loads)
        force_y -= inner_load * cosine
        force_z -= inner_load * sine
        residual = max(residual, abs(forces[j] - loads[LOAD.outer, j]))
    return True, force_y, force_z, max(residual, abs(force_y), abs(force_z))


@kernel
def _correct_all(load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending):
    """Write the correction by all equations with rollers as springs; return whether it was found, and the inner ring's position y, z [m].

    Parameters
    ----------
    load_y, load_z : radial load on the inner ring [N].
    shrunk, stiffness, profile, elastic, loads, bending : as of `balance_elastic_ring`.
    """
    points, rollers, size = elastic.seat.shape[0], loads.shape[1], bending.tableau.shape[1]
    system, sides, scratch = bending.system, bending.system_sides, bending.scratch
    constants, values = system[size], system[size + 1]
    _solve(loads[LOAD.centrifugal], points, bending.held, bending.tableau)
    for j in range(size):
        sides[j] = bending.sides[j]
        constants[j] = bending.tableau[size + 1, j]
        for i in range(size):
            system[j, i] = bending.tableau[j, i]
    constants[size - 2], constants[size - 1] = load_y, load_z
    for j in range(rollers):
        row, slope = points + j, loads[LOAD.slope, j]
        if slope > 0.0:
            opens = loads[LOAD.approach, j] - loads[LOAD.inner, j] / slope
        else:
            opens = loads[LOAD.free, j]
            _, pressed, _, _ = squeezed_roller(opens + _CLOSING, loads[LOAD.centrifugal, j], opens, 0.0, stiffness, profile)
            slope = max(pressed, _LEAST_CLOSING) / _CLOSING
        system[row, row] += 1.0 / slope
        constants[row] += opens + shrunk - loads[LOAD.squeeze, j]
        sides[row] = _OPEN
    for j in range(rollers):
        if loads[LOAD.slope, j] > 0.0:
            _pivot(points + j, 1.0, points, scratch, system)
            sides[points + j] = _TOUCHING
    for axis in range(2):
        _pivot(size - 2 + axis, 1.0, points, scratch, system)
    allowed, changes = _WRONG_FORCE * (abs(load_y) + abs(load_z) + 1.0), 1
    for _ in range(_ROUNDS):
        for i in range(size):
            values[i] = constants[i]
        changes = _settle(allowed, points, scratch, system, sides)
        if changes <= 0:
            break
    for j in range(rollers):
        pressed = -values[points + j] if sides[points + j] == _TOUCHING else 0.0
        bending.rollers[ROLLER.correction, j] = pressed + loads[LOAD.centrifugal, j] - bending.rollers[ROLLER.start_force, j]
    return changes == 0, -values[size - 2], -values[size - 1]


@kernel
def _correct_carrying(force_y, force_z, elastic, loads, bending):
    """Write the correction by what touches and carries now; return whether it was found, and the inner ring's step y, z [m].

    Parameters
    ----------
    force_y, force_z : what the load leaves of the rollers' forces on the inner ring [N].
    elastic, loads, bending : as of `balance_elastic_ring`.
    """
    points, rollers, parts = elastic.seat.shape[0], loads.shape[1], elastic.turning.shape[0]
    matrix, right, left, correction = bending.matrix, bending.right, bending.rollers[ROLLER.start_left], bending.rollers[ROLLER.correction]
    count = 0
    for j in range(rollers):
        count += 1 if loads[LOAD.slope, j] > 0.0 else 0
    row = 0
    right[count], right[count + 1] = -force_y, -force_z
    for j in range(rollers):
        correction[j] = -left[j]
        if loads[LOAD.slope, j] == 0.0:
            continue
        compliance, column = bending.tableau[points + j], 0
        right[row] = -left[j] / loads[LOAD.slope, j]
        for k in range(rollers):
            if loads[LOAD.slope, k] > 0.0:
                matrix[row, column] = compliance[points + k]
                column += 1
            else:
                right[row] += compliance[points + k] * left[k]
        matrix[row, row] += 1.0 / loads[LOAD.slope, j]
        for axis in range(2):
            direction = elastic.directions[axis, parts * j]
            matrix[row, count + axis] = matrix[count + axis, row] = -direction
            right[count + axis] += direction * left[j]
        row += 1
    for axis in range(2):
        matrix[count + axis, count + axis], matrix[count + axis, count + 1 - axis] = -_CENTRING_STIFFNESS, 0.0
    if not decompose(count + 2, matrix, bending.order):
        return False, 0.0, 0.0
    back_substitute(count + 2, matrix, bending.order, right)
    row = 0
    for j in range(rollers):
        if loads[LOAD.slope, j] > 0.0:
            correction[j] = right[row]
            row += 1
    return True, right[count], right[count + 1]


@kernel
def _conclude(shrunk, elastic, loads, bending):
    """Write what follows from a solution: forces of the seat, deflections at the rollers and their slopes."""
    points, rollers, parts = elastic.seat.shape[0], loads.shape[1], elastic.turning.shape[0]
    rows, pressed, values = bending.rollers, bending.points[POINT.force], bending.tableau[bending.tableau.shape[1] + 1]
    slopes, x_y, x_z = rows[ROLLER.slope], -values[points + rollers], -values[points + rollers + 1]
    for j in range(rollers):
        slopes[j] = 0.0
        moved = x_y * elastic.directions[0, parts * j] + x_z * elastic.directions[1, parts * j]
        rows[ROLLER.deflection, j] = values[points + j] - moved + shrunk
    for i in range(points):
        pressed[i] = -values[i] if bending.sides[i] == _TOUCHING else 0.0
    for k in range(rollers):
        for part in range(parts):
            force = rows[ROLLER.force, k] if part == 0 else 0.0
            if points > 0:
                force -= pressed[k * parts + part]
            if force != 0.0:
                start = rollers - k
                for j in range(rollers):
                    slopes[j] += force * elastic.turning[part, start + j]
    pressed[points], pressed[points + 1] = _turned(x_y, x_z, loads[LOAD.cosine, 0], -loads[LOAD.sine, 0])


@kernel
def _turned(y, z, cosine, sine):
    """Return a vector in axes that are turned by an angle of that cosine and sine."""
    return y * cosine + z * sine, z * cosine - y * sine


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
    points, rollers, rows, held = elastic.seat.shape[0], loads.shape[1], bending.rollers, bending.held
    values, x = bending.tableau[bending.tableau.shape[1] + 1], points + rollers
    cosine, sine = loads[LOAD.cosine, 0], loads[LOAD.sine, 0]
    play, shrunk = seat_gap(pressure, elastic)
    _look_at_bore(turn, play, elastic, bending)
    held[0], held[1] = _turned(bending.points[POINT.force, points], bending.points[POINT.force, points + 1], cosine, sine)
    load_y, load_z = _turned(load_y, load_z, cosine, sine)
    y, z = _turned(ring[0], ring[1], cosine, sine)
    y, z, before = y + held[0], z + held[1], math.inf
    allowed = _RELATIVE_RESIDUAL * math.hypot(load_y, load_z) + _LEAST_RESIDUAL
    if bending.sides[bending.tableau.shape[1]] >= _REFRESHED:
        _refresh(elastic, bending)
    fine, force_y, force_z, residual = _evaluate(y, z, load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
    for _ in range(_ITERATIONS):
        if not fine:
            return False
        x_y, x_z = -values[x], -values[x + 1]
        moved = max(abs(x_y - held[0]), abs(x_z - held[1]))
        if residual <= allowed and _HOLDING_STIFFNESS * moved <= allowed:
            ring[0], ring[1] = _turned(y - x_y, z - x_z, cosine, -sine)
            _conclude(shrunk, elastic, loads, bending)
            return True
        held[0], held[1] = x_y, x_z
        for j in range(rollers):
            rows[ROLLER.start_force, j], rows[ROLLER.start_moved, j] = rows[ROLLER.force, j], values[points + j]
            rows[ROLLER.start_left, j] = rows[ROLLER.force, j] - loads[LOAD.outer, j]
        serves = residual <= _SERVES * before
        if serves:
            fine, step_y, step_z = _correct_carrying(force_y, force_z, elastic, loads, bending)
        else:
            fine, step_y, step_z = _correct_all(load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
            step_y, step_z = step_y - y, step_z - z
        if not fine:
            return False
        before, start_y, start_z, scale = residual, y, z, 1.0
        for _ in range(_HALVINGS):
            for j in range(rollers):
                rows[ROLLER.force, j] = rows[ROLLER.start_force, j] + scale * rows[ROLLER.correction, j]
            y, z = start_y + scale * step_y, start_z + scale * step_z
            fine, next_y, next_z, residual = _evaluate(y, z, load_y, load_z, shrunk, stiffness, profile, elastic, loads, bending)
            if not fine:
                break
            forward, back = -force_y * (y - start_y) - force_z * (z - start_z), -next_y * (y - start_y) - next_z * (z - start_z)
            for j in range(rollers):
                moved = values[points + j] - rows[ROLLER.start_moved, j]
                forward += rows[ROLLER.start_left, j] * moved
                back += (rows[ROLLER.force, j] - loads[LOAD.outer, j]) * moved
            if back <= 0.5 * abs(forward) or residual <= allowed or scale == 0.0:
                break
            if serves:  # not so well: begin again with all equations
                scale, before = 0.0, 0.0
            else:
                scale *= 0.5
        force_y, force_z = next_y, next_z
    return False
