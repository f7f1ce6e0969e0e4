# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Quasi-static radial balance: which roller carries what, and where the inner ring is.

For each roller Q_e(delta_e) = Q_i(delta_i) + F_c with delta_i + delta_e = approach, a monotone scalar equation of Palmgren contacts
(`bearing_sim.physics.contact`), softer where rollers have a profile (`bearing_sim.physics.profile`); for the ring sum Q_i (cos phi, sin phi)
= (F_y, F_z) (Deng 2017, eq. 16 at rest).  The potential of both is convex, so that Newton's method with a bounded, backtracked step always converges.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.physics.contact import EXPONENT
from bearing_sim.physics.profile import profile_force

# A ring that no roller holds (clearance, no load) has no position: this spring, a millionth of a contact's, gives it one.
_CENTRING_STIFFNESS = 1e3  # N/m; assumption
_FIRST_LONGEST_STEP = 2e-5  # m, a few contact penetrations; doubled with each good step, as across a wide play
_ITERATIONS = 400  # a ring in a wide play rolls from roller to roller before it has found its position
_RELATIVE_RESIDUAL = 1e-6
# A step that will leave less than the first of these, by the cube of the residual over the square of the one before (quadratic convergence), is taken
# to first order in all loads and ends the iteration without another evaluation; not where the residual is more than the second.
_LAST_LEAVES, _LAST_FROM = 1e-6, 0.02
_FREE_ERROR = 1e-3  # relative, an upper bound of that of a free penetration; within it the force decides whether an inner contact carries
_ROLLER_ITERATIONS = 40
_LEAST_DESCENT = 0.1  # of an inner penetration in one step
_LEAST_INNER = 1e-12  # of the approach: where Newton's method starts at least, because it comes to the root from above after its first step


def _outer_fractions(intervals):
    """Tabulate h(x) of h^(10/9) = (1 - h)^(10/9) + x^(10/9) on even x from 0 to 1.

    h is the outer contact's fraction of the approach and x = free penetration / approach: all squeezed rollers lie on this one curve,
    whatever their stiffness, speed and approach.  Newton's method starts from it.
    """
    fractions = np.empty(intervals + 1)
    for i, x in enumerate(np.linspace(0.0, 1.0, intervals + 1)):
        low, high = 0.5, 1.0
        for _ in range(60):
            middle = 0.5 * (low + high)
            if middle**EXPONENT - (1.0 - middle) ** EXPONENT < x**EXPONENT:
                low = middle
            else:
                high = middle
        fractions[i] = 0.5 * (low + high)
    return fractions


_OUTER_FRACTIONS = _outer_fractions(1024)


class LoadRow(NamedTuple):
    """Rows of a loads array, shape (len(LOAD), Z): the radial balance of all rollers at one cage angle."""

    cosine: int = 0  # of the roller's azimuth
    sine: int = 1
    squeeze: int = 2  # R_i + D_w - R_e, less what the profile drops where it is highest [m]: the approach with the ring in the centre
    contour_slope: int = 3  # dR_e/dphi [m/rad]
    centrifugal: int = 4  # F_c [N]
    free: int = 5  # outer penetration under F_c alone [m]
    radius: int = 6  # distance of the roller from the outer-ring centre [m]
    outer_penetration: int = 7  # [m]
    inner: int = 8  # Q_i [N]
    outer: int = 9  # Q_e [N]
    approach: int = 10  # of the two contacts at which the last three were found [m]
    share: int = 11  # of a further approach, which the inner contact takes
    slope: int = 12  # dQ_i by the approach [N/m]; 0 where the inner contact is open


LOAD = LoadRow()


@fused
def squeezed_roller(approach, centrifugal, free, guess, stiffness, profile):
    """Balance one roller between the raceways: Q_e = Q_i + F_c, delta_i + delta_e = approach.

    Parameters
    ----------
    approach : R_i + D_w - R_e + ring displacement towards the roller, less what its profile drops where it is highest [m]; negative with clearance.
    centrifugal : F_c [N], not negative.
    free : outer penetration under F_c alone [m], to 1e-4: an inner contact begins exactly where the outer one carries F_c at this approach.
    guess : inner penetration [m], such as of a position of the ring nearby; where it is not between 0 and the approach, the start is that of
        straight rollers.
    stiffness : K [N/m^(10/9)].
    profile : `bearing_sim.physics.profile.Profile`.

    Returns
    -------
    outer_penetration [m], inner_load [N], inner_slope [N/m] (dQ_i / d approach), share (d inner penetration / d approach)
    """
    if approach <= (1.0 - _FREE_ERROR) * free:
        return free, 0.0, 0.0, 0.0
    if approach <= (1.0 + _FREE_ERROR) * free and profile_force(approach, stiffness, profile)[0] <= centrifugal:
        return free, 0.0, 0.0, 0.0
    inner, inner_load, inner_slope, outer_slope, step = guess, 0.0, 0.0, 0.0, 0.0
    if not 0.0 < guess < approach:
        position = min(free / approach, 1.0) * (_OUTER_FRACTIONS.shape[0] - 1)
        index = min(int(position), _OUTER_FRACTIONS.shape[0] - 2)
        outer = approach * (_OUTER_FRACTIONS[index] + (position - index) * (_OUTER_FRACTIONS[index + 1] - _OUTER_FRACTIONS[index]))
        inner = max(approach - outer, _LEAST_INNER * approach)
    for _ in range(_ROLLER_ITERATIONS):
        outer_load, outer_slope = profile_force(approach - inner, stiffness, profile)
        inner_load, inner_slope = profile_force(inner, stiffness, profile)
        step = (outer_load - inner_load - centrifugal) / (outer_slope + inner_slope)
        if abs(step) <= 1e-5 * inner:
            break
        inner = max(inner + step, _LEAST_DESCENT * inner)
    # The step just found is applied to first order: what it leaves is its square.
    share = outer_slope / (outer_slope + inner_slope)
    return approach - inner - step, inner_load + inner_slope * step, inner_slope * share, share


@fused
def press_roller(j, approach, stiffness, profile, loads):
    """Balance a roller at an approach [m] and write what follows into ``loads``; return Q_i [N] and its slope [N/m], see `squeezed_roller`."""
    guess = 0.0
    if profile.crowned:  # a ring nearby tells more than straight rollers
        known, share = loads[LOAD.approach, j] - loads[LOAD.outer_penetration, j], loads[LOAD.share, j]
        guess = known + share * (approach - loads[LOAD.approach, j])
    outer, inner_load, slope, share = squeezed_roller(approach, loads[LOAD.centrifugal, j], loads[LOAD.free, j], guess, stiffness, profile)
    loads[LOAD.approach, j], loads[LOAD.share, j], loads[LOAD.slope, j] = approach, share, slope
    loads[LOAD.outer_penetration, j] = outer
    loads[LOAD.inner, j] = inner_load
    loads[LOAD.outer, j] = inner_load + loads[LOAD.centrifugal, j]
    return inner_load, slope


@fused
def _ring_forces(y, z, load_y, load_z, stiffness, profile, loads):
    """Balance all rollers at a ring position; return the ring's residual force and its stiffness matrix."""
    force_y, force_z = load_y - _CENTRING_STIFFNESS * y, load_z - _CENTRING_STIFFNESS * z
    k_yy, k_yz, k_zz = _CENTRING_STIFFNESS, 0.0, _CENTRING_STIFFNESS
    for j in range(loads.shape[1]):
        cosine, sine = loads[LOAD.cosine, j], loads[LOAD.sine, j]
        inner_load, slope = press_roller(j, loads[LOAD.squeeze, j] + y * cosine + z * sine, stiffness, profile, loads)
        if slope == 0.0:
            continue
        force_y -= inner_load * cosine
        force_z -= inner_load * sine
        k_yy += slope * cosine * cosine
        k_yz += slope * cosine * sine
        k_zz += slope * sine * sine
    return force_y, force_z, k_yy, k_yz, k_zz


@fused
def _deepen(y, z, loads):
    """Carry penetrations and loads along a displacement of the ring (y, z) [m], to first order."""
    for j in range(loads.shape[1]):
        if loads[LOAD.slope, j] == 0.0:
            continue
        deeper = y * loads[LOAD.cosine, j] + z * loads[LOAD.sine, j]
        loads[LOAD.approach, j] += deeper
        loads[LOAD.outer_penetration, j] += (1.0 - loads[LOAD.share, j]) * deeper
        loads[LOAD.inner, j] = max(loads[LOAD.inner, j] + loads[LOAD.slope, j] * deeper, 0.0)
        loads[LOAD.outer, j] = loads[LOAD.inner, j] + loads[LOAD.centrifugal, j]


@kernel
def balance_ring(load_y, load_z, stiffness, profile, loads, ring):
    """Find the ring position at which the roller loads carry the radial load.

    Parameters
    ----------
    load_y, load_z : radial load on the inner ring [N].
    stiffness : K [N/m^(10/9)].
    profile : `bearing_sim.physics.profile.Profile` of the rollers.
    loads : array with rows `LOAD`; cosine, sine, squeeze, centrifugal and free go in; outer_penetration, inner and outer
        come out.
    ring : ring centre (y, z) [m], start and result, shape (2,).

    Returns
    -------
    converged : bool
    """
    y, z = ring[0], ring[1]
    force_y, force_z, k_yy, k_yz, k_zz = _ring_forces(y, z, load_y, load_z, stiffness, profile, loads)
    scale_of_loads = math.hypot(load_y, load_z) + 1.0
    tolerance = _RELATIVE_RESIDUAL * scale_of_loads
    longest, before = _FIRST_LONGEST_STEP, 0.0  # no residual before the first
    for _ in range(_ITERATIONS):
        residual = math.hypot(force_y, force_z)
        if residual <= tolerance:
            ring[0], ring[1] = y, z
            return True
        determinant = k_yy * k_zz - k_yz * k_yz
        step_y = (k_zz * force_y - k_yz * force_z) / determinant
        step_z = (k_yy * force_z - k_yz * force_y) / determinant
        length = math.hypot(step_y, step_z)
        if residual**3 <= _LAST_LEAVES * scale_of_loads * before**2 and residual <= _LAST_FROM * scale_of_loads and length <= longest:
            _deepen(step_y, step_z, loads)
            ring[0], ring[1] = y + step_y, z + step_z
            return True
        before = residual
        scale = 1.0 if length <= longest else longest / length
        for _ in range(30):
            next_y, next_z = y + scale * step_y, z + scale * step_z
            next_force_y, next_force_z, next_yy, next_yz, next_zz = _ring_forces(next_y, next_z, load_y, load_z, stiffness, profile, loads)
            # Descent in the convex potential: the remaining force must not push back by more than half of what it pushed forward.
            if next_force_y * step_y + next_force_z * step_z >= -0.5 * (force_y * step_y + force_z * step_z):
                longest *= 2.0
                break
            scale *= 0.5
            longest = max(0.5 * longest, _FIRST_LONGEST_STEP)
        y, z = next_y, next_z
        force_y, force_z, k_yy, k_yz, k_zz = next_force_y, next_force_z, next_yy, next_yz, next_zz
    ring[0], ring[1] = y, z
    return math.hypot(force_y, force_z) <= 1e3 * tolerance
