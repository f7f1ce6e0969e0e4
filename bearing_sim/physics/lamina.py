# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Quasi-static balance of the whole bearing by slices: ring displacement and tilt, roller positions and tilts.

Every roller is cut into N slices, each an independent spring K/N delta^(10/9) on either raceway (the lamina model of
ISO/TS 16281).  Unknown are the position of
each roller (outer penetration and tilt) and that of the inner ring (two displacements, two tilts); all forces and moments
derive from one convex potential, so that Newton's method with a bounded, backtracked step converges from anywhere.

Tilts are counted as the displacement that they give a roller's end, so that all unknowns are lengths and all
residuals forces: tilt times L/2, and moment over L/2.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.contact import EXPONENT

_LARGEST_DAMPING = 1.0  # N/m; a ten-millionth of a contact's stiffness restrains what nothing else does
_LONGEST_STEP = 2e-5  # m, a few contact penetrations
_ITERATIONS = 400
_RELATIVE_RESIDUAL = 1e-9
_NOTHING = 1e-12  # N
_RING = 4  # unknowns of the ring


class Slices(NamedTuple):
    """The bearing as `balance_slices` sees it at one cage angle, and its memory; see `new_slices`."""

    position: np.ndarray  # of slice middles, 2 x_k/L, shape (N,)
    drop: np.ndarray  # C_k [m], shape (N,)
    half_length: float  # L/2 [m]
    stiffness: float  # K of the whole contact [N/m^(10/9)]
    roller: np.ndarray  # rows `ROLLER_ROW`, shape (len(ROLLER_ROW), Z)
    ring: np.ndarray  # y, z [m], tilts about y and z [rad]: start and result, shape (4,)
    reaction: np.ndarray  # force y, z [N], moment about y, z [N m] that the rollers take from the ring, shape (4,)
    inner: np.ndarray  # load of each slice on the inner raceway [N], shape (Z, N)
    outer: np.ndarray  # and on the outer raceway
    system: np.ndarray  # stiffness matrix of the ring, its right side, and the ring's trial, shape (4, 6)


class RollerRow(NamedTuple):
    """Rows of the roller array of `Slices`."""

    cosine: int = 0  # of the azimuth
    sine: int = 1
    squeeze: int = 2  # R_i + D_w - R_e [m]: the approach with the ring in the centre
    centrifugal: int = 3  # F_c [N]
    penetration: int = 4  # outer penetration of the middle, without its drop [m]; negative with play: start and result
    tilt: int = 5  # times L/2 [m]; positive tilts press the end at positive x on the outer raceway
    outer_load: int = 6  # Q_e [N]
    outer_moment: int = 7  # sum of q_e x over L/2 [N]
    inner_load: int = 8
    inner_moment: int = 9
    outer_stiffness: int = 10  # three rows: sums of the slices' derivatives [N/m] times position to the power 0, 1, 2
    inner_stiffness: int = 13
    step_penetration: int = 16  # [m]
    step_tilt: int = 17


ROLLER_ROW = RollerRow()
_ROWS = 18


def new_slices(rollers, drops, length, stiffness):
    """Return the memory of a balance, ring in the centre, rollers resting on the outer raceway.

    Parameters
    ----------
    rollers : their number, Z.
    drops : C_k of each slice [m], shape (N,).
    length : L [m].
    stiffness : K of a whole contact [N/m^(10/9)].
    """
    slices = len(drops)
    return Slices(
        position=(2.0 * np.arange(slices) + 1.0) / slices - 1.0,
        drop=np.ascontiguousarray(drops, np.float64),
        half_length=float(length) / 2.0,
        stiffness=float(stiffness),
        roller=np.zeros((_ROWS, rollers)),
        ring=np.zeros(_RING),
        reaction=np.zeros(_RING),
        inner=np.zeros((rollers, slices)),
        outer=np.zeros((rollers, slices)),
        system=np.zeros((_RING, _RING + 2)),
    )


@kernel
def sliced_contact(penetration, tilt, slices, loads):
    """Press one roller on one raceway; write the slices' loads [N] into ``loads``, shape (N,).

    q_k = K/N delta_k^(10/9), delta_k = delta - C_k + tilt x_k (physics section 2); none where delta_k is negative.

    Parameters
    ----------
    penetration : delta of the middle [m].
    tilt : tilt between roller and raceway, times L/2 [m].
    slices : `Slices`; position, drop and stiffness are taken.

    Returns
    -------
    load [N], moment over L/2 [N], and the sums of the slices' derivatives [N/m] times position to the power 0, 1 and 2
    """
    stiffness = slices.stiffness / slices.position.shape[0]
    load, moment, stiffness_0, stiffness_1, stiffness_2 = 0.0, 0.0, 0.0, 0.0, 0.0
    for k in range(slices.position.shape[0]):
        position = slices.position[k]
        delta = penetration - slices.drop[k] + tilt * position
        if delta <= 0.0:
            loads[k] = 0.0
            continue
        root = stiffness * delta ** (1.0 / 9.0)
        d_depth = EXPONENT * root
        loads[k] = root * delta
        load += root * delta
        moment += root * delta * position
        stiffness_0 += d_depth
        stiffness_1 += d_depth * position
        stiffness_2 += d_depth * position * position
    return load, moment, stiffness_0, stiffness_1, stiffness_2


@kernel
def _press(y, z, end_y, end_z, step, slices):
    """Compute all contacts with the ring at a position and the rollers ``step`` times their steps further on.

    ``end_y``, ``end_z`` are the ring's tilts about y and z times L/2 [m].
    """
    roller, row = slices.roller, ROLLER_ROW
    for j in range(roller.shape[1]):
        cosine, sine = roller[row.cosine, j], roller[row.sine, j]
        penetration = roller[row.penetration, j] + step * roller[row.step_penetration, j]
        tilt = roller[row.tilt, j] + step * roller[row.step_tilt, j]
        approach = roller[row.squeeze, j] + y * cosine + z * sine
        ring_tilt = end_z * cosine - end_y * sine
        load, moment, stiffness_0, stiffness_1, stiffness_2 = sliced_contact(penetration, tilt, slices, slices.outer[j])
        roller[row.outer_load, j], roller[row.outer_moment, j] = load, moment
        roller[row.outer_stiffness, j], roller[row.outer_stiffness + 1, j], roller[row.outer_stiffness + 2, j] = stiffness_0, stiffness_1, stiffness_2
        load, moment, stiffness_0, stiffness_1, stiffness_2 = sliced_contact(approach - penetration, ring_tilt - tilt, slices, slices.inner[j])
        roller[row.inner_load, j], roller[row.inner_moment, j] = load, moment
        roller[row.inner_stiffness, j], roller[row.inner_stiffness + 1, j], roller[row.inner_stiffness + 2, j] = stiffness_0, stiffness_1, stiffness_2


@kernel
def _reactions(slices):
    """Sum the rollers' forces on the ring into ``slices.reaction``: y, z, and moments over L/2 about y and z [N]."""
    roller, row, reaction = slices.roller, ROLLER_ROW, slices.reaction
    reaction[:] = 0.0
    for j in range(roller.shape[1]):
        cosine, sine = roller[row.cosine, j], roller[row.sine, j]
        reaction[0] += roller[row.inner_load, j] * cosine
        reaction[1] += roller[row.inner_load, j] * sine
        reaction[2] -= roller[row.inner_moment, j] * sine
        reaction[3] += roller[row.inner_moment, j] * cosine


@kernel
def _roller_inverse(roller, j, damping):
    """Return the inverse of one roller's stiffness matrix: three numbers of a symmetric two by two."""
    row = ROLLER_ROW
    a = roller[row.outer_stiffness, j] + roller[row.inner_stiffness, j] + damping
    b = roller[row.outer_stiffness + 1, j] + roller[row.inner_stiffness + 1, j]
    d = roller[row.outer_stiffness + 2, j] + roller[row.inner_stiffness + 2, j] + damping
    determinant = a * d - b * b
    return d / determinant, -b / determinant, a / determinant


@kernel
def _assemble(force, slices, free_tilts, damping):
    """Write the ring's equations into ``slices.system``, all rollers eliminated; return the largest residual force [N]."""
    roller, row, system = slices.roller, ROLLER_ROW, slices.system
    _reactions(slices)
    largest = 0.0
    for i in range(_RING):
        for k in range(_RING):
            system[i, k] = 0.0
        system[i, i] = damping
        system[i, _RING] = force[i] - slices.reaction[i]
        if i < 2 or free_tilts:
            largest = max(largest, abs(system[i, _RING]))
    for j in range(roller.shape[1]):
        cosine, sine = roller[row.cosine, j], roller[row.sine, j]
        pull = roller[row.centrifugal, j] + roller[row.inner_load, j] - roller[row.outer_load, j]
        turn = roller[row.inner_moment, j] - roller[row.outer_moment, j]
        largest = max(largest, abs(pull), abs(turn))
        k_0, k_1, k_2 = roller[row.inner_stiffness, j], roller[row.inner_stiffness + 1, j], roller[row.inner_stiffness + 2, j]
        if k_0 == 0.0:
            continue
        a, b, d = _roller_inverse(roller, j, damping)
        # the roller yields: K - K (K + K_e)^-1 K, and its own residual reaches the ring through K (K + K_e)^-1
        p_0, p_1 = k_0 * a + k_1 * b, k_0 * b + k_1 * d
        p_2, p_3 = k_1 * a + k_2 * b, k_1 * b + k_2 * d
        s_0 = k_0 - (p_0 * k_0 + p_1 * k_1)
        s_1 = k_1 - (p_0 * k_1 + p_1 * k_2)
        s_2 = k_2 - (p_2 * k_1 + p_3 * k_2)
        force_change, moment_change = p_0 * pull + p_1 * turn, p_2 * pull + p_3 * turn
        for i in range(_RING):
            # what one unit of this unknown moves the middle and the end of the raceway towards the roller
            middle_i = cosine if i == 0 else (sine if i == 1 else 0.0)
            end_i = cosine if i == 3 else (-sine if i == 2 else 0.0)
            system[i, _RING] += middle_i * force_change + end_i * moment_change
            for k in range(_RING):
                middle_k = cosine if k == 0 else (sine if k == 1 else 0.0)
                end_k = cosine if k == 3 else (-sine if k == 2 else 0.0)
                system[i, k] += s_0 * middle_i * middle_k + s_1 * (middle_i * end_k + end_i * middle_k) + s_2 * end_i * end_k
    if not free_tilts:
        for i in range(2, _RING):
            for k in range(_RING):
                system[i, k] = 0.0
                system[k, i] = 0.0
            system[i, i], system[i, _RING] = 1.0, 0.0
    return largest


@kernel
def _solve_ring(system):
    """Replace the right side of the ring's equations (column 4) by their solution: elimination of a positive definite matrix."""
    for pivot in range(_RING):
        for i in range(pivot + 1, _RING):
            fraction = system[i, pivot] / system[pivot, pivot]
            for k in range(pivot, _RING + 1):
                system[i, k] -= fraction * system[pivot, k]
    for i in range(_RING - 1, -1, -1):
        for k in range(i + 1, _RING):
            system[i, _RING] -= system[i, k] * system[k, _RING]
        system[i, _RING] /= system[i, i]


@kernel
def _roller_steps(slices, damping):
    """Write each roller's step for the ring's step in column 4 of the system; return the longest step of any unknown [m]."""
    roller, row, system = slices.roller, ROLLER_ROW, slices.system
    y, z, end_y, end_z = system[0, _RING], system[1, _RING], system[2, _RING], system[3, _RING]
    longest = max(abs(y), abs(z), abs(end_y), abs(end_z))
    for j in range(roller.shape[1]):
        cosine, sine = roller[row.cosine, j], roller[row.sine, j]
        approach, ring_tilt = y * cosine + z * sine, end_z * cosine - end_y * sine
        k_0, k_1, k_2 = roller[row.inner_stiffness, j], roller[row.inner_stiffness + 1, j], roller[row.inner_stiffness + 2, j]
        pull = roller[row.centrifugal, j] + roller[row.inner_load, j] - roller[row.outer_load, j] + k_0 * approach + k_1 * ring_tilt
        turn = roller[row.inner_moment, j] - roller[row.outer_moment, j] + k_1 * approach + k_2 * ring_tilt
        a, b, d = _roller_inverse(roller, j, damping)
        penetration, tilt = a * pull + b * turn, b * pull + d * turn
        roller[row.step_penetration, j], roller[row.step_tilt, j] = penetration, tilt
        longest = max(longest, abs(penetration), abs(tilt))
    return longest


@kernel
def _push(force, slices, free_tilts):
    """Return the work that what is out of balance would do per unit of the whole step [N m]."""
    roller, row, system = slices.roller, ROLLER_ROW, slices.system
    _reactions(slices)
    work = 0.0
    for i in range(_RING if free_tilts else 2):
        work += (force[i] - slices.reaction[i]) * system[i, _RING]
    for j in range(roller.shape[1]):
        pull = roller[row.centrifugal, j] + roller[row.inner_load, j] - roller[row.outer_load, j]
        turn = roller[row.inner_moment, j] - roller[row.outer_moment, j]
        work += pull * roller[row.step_penetration, j] + turn * roller[row.step_tilt, j]
    return work


@kernel
def balance_slices(load_y, load_z, moment_y, moment_z, free_tilts, slices):
    """Find ring and rollers at which the slices carry the load.

    The rows cosine, sine, squeeze and centrifugal of ``slices.roller`` go in; the search starts from the penetrations and
    tilts found there and from ``slices.ring``, and leaves its result in them, the slices' loads in ``slices.inner`` and
    ``slices.outer``, and what the rollers take from the ring in ``slices.reaction``.

    Parameters
    ----------
    load_y, load_z : radial load on the inner ring [N].
    moment_y, moment_z : moment on the inner ring about y and z [N m]; a positive moment about z presses the ends at positive
        x of rollers on the +y side.
    free_tilts : whether the ring tilts until the moments balance; False keeps the tilts that ``slices.ring`` has.

    Returns
    -------
    converged : bool
    """
    half, ring, roller, system, row = slices.half_length, slices.ring, slices.roller, slices.system, ROLLER_ROW
    force = (load_y, load_z, moment_y / half, moment_z / half)
    scale = abs(load_y) + abs(load_z) + abs(force[2]) + abs(force[3])
    for j in range(roller.shape[1]):
        scale += abs(roller[row.centrifugal, j])
        roller[row.step_penetration, j], roller[row.step_tilt, j] = 0.0, 0.0
    y, z, end_y, end_z = ring[0], ring[1], half * ring[2], half * ring[3]
    _press(y, z, end_y, end_z, 0.0, slices)
    largest = 0.0
    for j in range(roller.shape[1]):
        largest = max(largest, roller[row.inner_load, j], roller[row.outer_load, j])
    converged, damping = False, min(_LARGEST_DAMPING, (scale + largest) / _LONGEST_STEP)
    for _ in range(_ITERATIONS):
        residual = _assemble(force, slices, free_tilts, damping)
        tolerance = _RELATIVE_RESIDUAL * (scale + largest) + _NOTHING
        if residual <= tolerance:
            converged = True
            break
        if not residual < math.inf:
            break
        _solve_ring(system)
        longest = _roller_steps(slices, damping)
        before = _push(force, slices, free_tilts)
        step = min(1.0, _LONGEST_STEP / longest) if longest > 0.0 else 1.0
        for _ in range(40):
            _press(y + step * system[0, 4], z + step * system[1, 4], end_y + step * system[2, 4], end_z + step * system[3, 4], step, slices)
            # Descent in the convex potential: the residual must not push back by more than half of what it pushed forward.
            if _push(force, slices, free_tilts) >= -0.5 * before:
                break
            step *= 0.5
        y, z, end_y, end_z = y + step * system[0, 4], z + step * system[1, 4], end_y + step * system[2, 4], end_z + step * system[3, 4]
        largest = 0.0
        for j in range(roller.shape[1]):
            roller[row.penetration, j] += step * roller[row.step_penetration, j]
            roller[row.tilt, j] += step * roller[row.step_tilt, j]
            largest = max(largest, roller[row.inner_load, j], roller[row.outer_load, j])
    _reactions(slices)
    slices.reaction[2] *= half
    slices.reaction[3] *= half
    ring[0], ring[1], ring[2], ring[3] = y, z, end_y / half, end_z / half
    return converged
