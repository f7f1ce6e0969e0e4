# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pockets that guide the cage in space (see `bearing_sim.levels.planar_guide`), sliced; ``LANES`` rollers at a time (a block).

A slice at x stands ``guide_offset + pocket_lean x`` outwards from the middle of its pocket.
"""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.lanes import load, magnitude, store, total, where_positive
from bearing_sim.levels.spatial_algebra import AT_CAGE, BORDER, CAGE_COLUMNS, CAGE_ROWS, LOCAL
from bearing_sim.levels.spatial_pocket_slopes import CHAIN, INCLINATION, KINDS, LEAN, LEVER, OFFSET, VARIABLES
from bearing_sim.levels.spatial_pockets import hold_slices
from bearing_sim.levels.spatial_state import (
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    OMEGA,
    PHI,
    PHI_SPEED,
    R_SPEED,
    ROLLER,
    SKEW,
    SKEW_SPEED,
    SPIN,
    TILT,
    TILT_SPEED,
    R,
)

_RATES = 170  # row of ``chain`` where this module's part begins: changes of the offset's rate and the lean's, by variable
_AT_Y, _AT_TILT_Y, _AT_THETA = 9, 11, 13  # columns of the cage among the variables, its speeds are 5 further on


@template
def _add(array, block, row, value):
    store(array, block, row, load(array, block, row) + value)


@kernel
def guide_forces(block, y, params, rows):
    """Write how a block of rollers stands outwards in its pockets, and what these do to it; it has been placed in them along the orbit.

    Parameters
    ----------
    y : state.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.spatial_state.ROLLER`.
    """
    cage, orbital_speed = params.cage, load(rows, block, ROLLER.orbital_speed)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    radius, tilt, skew = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    offset = radius * c - (y[CAGE_Y] * p_c + y[CAGE_Z] * p_s) - cage.guidance.pocket_radius
    rate = load(rows, block, ROLLER.radial_speed) * c - radius * s * orbital_speed + y[OMEGA] * load(rows, block, ROLLER.pocket_offset)
    rate -= y[BORDER + CAGE_Y] * p_c + y[BORDER + CAGE_Z] * p_s
    lean_rate = load(rows, block, ROLLER.tilt_speed) * c - load(rows, block, ROLLER.skew_speed) * s - orbital_speed * (tilt * s + skew * c)
    lean_rate += y[OMEGA] * load(rows, block, ROLLER.pocket_skew) - (y[BORDER + CAGE_TILT_Y] * p_c + y[BORDER + CAGE_TILT_Z] * p_s)
    lean = load(rows, block, ROLLER.pocket_lean)
    force, moment, k_0, k_1, k_2, d_0, d_1, d_2 = hold_slices(offset, rate, lean, lean_rate, cage.guide_clearance, 0.0, params)
    store(rows, block, ROLLER.guide_offset, offset)
    store(rows, block, ROLLER.guide_rate, rate)
    store(rows, block, ROLLER.guide_lean_rate, lean_rate)
    store(rows, block, ROLLER.guide_force, -force)
    store(rows, block, ROLLER.guide_moment, -moment)
    store(rows, block, ROLLER.guide_stiffness, k_0)
    store(rows, block, ROLLER.guide_stiffness + 1, k_1)
    store(rows, block, ROLLER.guide_stiffness + 2, k_2)
    store(rows, block, ROLLER.guide_damping, d_0)
    store(rows, block, ROLLER.guide_damping + 1, d_1)
    store(rows, block, ROLLER.guide_damping + 2, d_2)


@kernel
def guide_accelerations(block, params, rows, rate):
    """Add what guiding pockets do to the accelerations of a block of rollers and of the cage; parameters as of `guide_forces`."""
    cage, tilts, rollers, present = params.cage, params.tilts, params.rollers, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    force, moment, friction = (
        -load(rows, block, ROLLER.guide_force),
        -load(rows, block, ROLLER.guide_moment),
        load(rows, block, ROLLER.pocket_friction),
    )
    push_r, push_t = c - friction * s, s + friction * c
    turned = force * push_t * (1.0 / rollers.mass) / load(rows, block, ROLLER.radius)
    _add(rows, block, ROLLER.radial_acceleration, -(force * push_r * (1.0 / rollers.mass)))
    _add(rows, block, ROLLER.orbital_acceleration, turned)
    # a roller's axis is described in the frame that turns with the orbit
    per_inertia = 1.0 / tilts.roller_inertia
    _add(rows, block, ROLLER.tilt_acceleration, turned * load(rows, block, ROLLER.skew) - moment * push_r * per_inertia)
    _add(rows, block, ROLLER.skew_acceleration, moment * push_t * per_inertia - turned * load(rows, block, ROLLER.tilt))
    braking = friction * magnitude(force) * rollers.radius
    _add(rows, block, ROLLER.spin_acceleration, -(braking * (1.0 / rollers.inertia)))
    push_y, push_z = present * (p_c + friction * p_s), present * (p_s - friction * p_c)
    rate[BORDER + CAGE_Y] += total(force * push_y) / cage.mass
    rate[BORDER + CAGE_Z] += total(force * push_z) / cage.mass
    rate[BORDER + CAGE_TILT_Y] += total(moment * push_y) / tilts.cage_inertia
    rate[BORDER + CAGE_TILT_Z] += total(moment * push_z) / tilts.cage_inertia
    lever = load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius
    torque = force * (load(rows, block, ROLLER.pocket_offset) + friction * lever) + braking
    torque += moment * (load(rows, block, ROLLER.pocket_skew) + friction * load(rows, block, ROLLER.pocket_lean))
    rate[OMEGA] -= total(present * torque) / cage.inertia


@template
def _put(chain, variable, offset_rate, lean_rate):
    store(chain, 0, _RATES + 2 * variable, offset_rate)
    store(chain, 0, _RATES + 2 * variable + 1, lean_rate)


@kernel
def _rates(block, y, params, rows, chain):
    """Write how the rates of offset and lean change by each variable; the rest of ``chain`` stays 0."""
    radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    tilt_speed, skew_speed = load(rows, block, ROLLER.tilt_speed), load(rows, block, ROLLER.skew_speed)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    omega, orbital_speed = y[OMEGA], load(rows, block, ROLLER.orbital_speed)
    turning = orbital_speed - omega
    outwards, along = tilt * c - skew * s, tilt * s + skew * c
    rise, inclining = radial_speed * s, tilt_speed * s + skew_speed * c
    speed_t = y[BORDER + CAGE_Z] * p_c - y[BORDER + CAGE_Y] * p_s
    turn_t = y[BORDER + CAGE_TILT_Z] * p_c - y[BORDER + CAGE_TILT_Y] * p_s
    lever, lean = load(rows, block, ROLLER.guide_offset) + params.cage.guidance.pocket_radius, load(rows, block, ROLLER.pocket_lean)
    _put(chain, R, -(s * turning), 0.0)
    _put(chain, PHI, -(rise + radius * c * turning), -(inclining + turning * outwards))
    _put(chain, TILT, 0.0, -(s * turning))
    _put(chain, SKEW, 0.0, -(c * turning))
    _put(chain, R_SPEED, c, 0.0)
    _put(chain, PHI_SPEED, -(radius * s), -along)
    _put(chain, TILT_SPEED, 0.0, c)
    _put(chain, SKEW_SPEED, 0.0, -s)
    _put(chain, _AT_Y, omega * p_s, 0.0)
    _put(chain, _AT_Y + 1, -(omega * p_c), 0.0)
    _put(chain, _AT_TILT_Y, 0.0, omega * p_s)
    _put(chain, _AT_TILT_Y + 1, 0.0, -(omega * p_c))
    _put(chain, _AT_Y + 5, -p_c, 0.0)
    _put(chain, _AT_Y + 6, -p_s, 0.0)
    _put(chain, _AT_TILT_Y + 5, 0.0, -p_c)
    _put(chain, _AT_TILT_Y + 6, 0.0, -p_s)
    moved = rise + radius * c * orbital_speed - speed_t - omega * lever
    _put(chain, _AT_THETA, moved, inclining + orbital_speed * outwards - turn_t - omega * lean)
    _put(chain, _AT_THETA + 5, load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_skew))


@kernel
def _rows(block, params, rows, chain, slopes):
    """Add to the rows of a roller's forces and moments and to those of the cage, as far as the directions stay."""
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    force, moment, friction = (
        -load(rows, block, ROLLER.guide_force),
        -load(rows, block, ROLLER.guide_moment),
        load(rows, block, ROLLER.pocket_friction),
    )
    k, d = ROLLER.guide_stiffness, ROLLER.guide_damping
    k_0, k_1, k_2 = load(rows, block, k), load(rows, block, k + 1), load(rows, block, k + 2)
    d_0, d_1, d_2 = load(rows, block, d), load(rows, block, d + 1), load(rows, block, d + 2)
    push_r, push_t = c - friction * s, s + friction * c
    push_y, push_z = p_c + friction * p_s, p_s - friction * p_c
    braking = friction * where_positive(force, 1.0, -1.0)
    arm = load(rows, block, ROLLER.pocket_offset) + braking * params.rollers.radius
    arm += friction * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius)
    skewed = load(rows, block, ROLLER.pocket_skew) + friction * load(rows, block, ROLLER.pocket_lean)
    per_mass, per_tilt, per_turn = present * (1.0 / cage.mass), present * (1.0 / tilts.cage_inertia), present * (1.0 / cage.inertia)
    for k in range(VARIABLES):
        first, rates = CHAIN + KINDS * k, _RATES + 2 * k
        place, skew = load(chain, 0, first + OFFSET), load(chain, 0, first + INCLINATION)
        outwards, lean = load(chain, 0, first + LEVER), load(chain, 0, first + LEAN)
        rate, lean_rate = load(chain, 0, rates), load(chain, 0, rates + 1)
        by_f = k_0 * outwards + k_1 * lean + d_0 * rate + d_1 * lean_rate
        by_m = k_1 * outwards + k_2 * lean + d_1 * rate + d_2 * lean_rate
        column = k if k <= SPIN else AT_CAGE + k - _AT_Y
        _add(slopes, block, column, -(by_f * push_r))
        _add(slopes, block, LOCAL + column, by_f * push_t)
        _add(slopes, block, 2 * LOCAL + column, -(by_m * push_r))
        _add(slopes, block, 3 * LOCAL + column, by_m * push_t)
        _add(slopes, block, 4 * LOCAL + column, -(by_f * braking))
        _add(slopes, block, CAGE_ROWS + k, per_mass * (by_f * push_y))
        _add(slopes, block, CAGE_ROWS + CAGE_COLUMNS + k, per_mass * (by_f * push_z))
        _add(slopes, block, CAGE_ROWS + 2 * CAGE_COLUMNS + k, per_tilt * (by_m * push_y))
        _add(slopes, block, CAGE_ROWS + 3 * CAGE_COLUMNS + k, per_tilt * (by_m * push_z))
        turned = by_f * arm + by_m * skewed + force * (place + friction * outwards) + moment * (skew + friction * lean)
        _add(slopes, block, CAGE_ROWS + 4 * CAGE_COLUMNS + k, -(per_turn * turned))


@kernel
def _directions(block, params, rows, slopes):
    """Add that forces and moments turn with pocket and roller, and that friction goes with the spin."""
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_slope)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_r, push_t = c - friction * s, s + friction * c
    force, moment = -load(rows, block, ROLLER.guide_force), -load(rows, block, ROLLER.guide_moment)
    theta = AT_CAGE + _AT_THETA - _AT_Y
    for kind in range(2):
        push = force if kind == 0 else moment
        per = present * (1.0 / cage.mass if kind == 0 else 1.0 / tilts.cage_inertia)
        first, to = 2 * kind * LOCAL, CAGE_ROWS + 2 * kind * CAGE_COLUMNS
        _add(slopes, block, first + PHI, push * push_t)
        _add(slopes, block, first + theta, -(push * push_t))
        _add(slopes, block, first + SPIN, push * s * bend)
        _add(slopes, block, first + LOCAL + PHI, push * push_r)
        _add(slopes, block, first + LOCAL + theta, -(push * push_r))
        _add(slopes, block, first + LOCAL + SPIN, push * c * bend)
        _add(slopes, block, to + _AT_THETA, per * push * (friction * p_c - p_s))
        _add(slopes, block, to + SPIN, per * push * p_s * bend)
        _add(slopes, block, to + CAGE_COLUMNS + _AT_THETA, per * push * (p_c + friction * p_s))
        _add(slopes, block, to + CAGE_COLUMNS + SPIN, -(per * push * p_c * bend))
    _add(slopes, block, 4 * LOCAL + SPIN, -(magnitude(force) * bend))
    slid = force * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius) + magnitude(force) * params.rollers.radius
    slid += moment * load(rows, block, ROLLER.pocket_lean)
    _add(slopes, block, CAGE_ROWS + 4 * CAGE_COLUMNS + SPIN, -(present * (1.0 / cage.inertia) * slid * bend))


@kernel
def guide_slopes(block, y, params, rows, chain, slopes):
    """Add the derivatives of what guiding pockets do, after `pocket_slopes`; parameters as of `spatial_slopes.roller_slopes`."""
    _rates(block, y, params, rows, chain)
    _rows(block, params, rows, chain, slopes)
    _directions(block, params, rows, slopes)
