# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Derivatives of what pockets do to rollers and cage in space; ``LANES`` rollers at a time (a block).

Force and moment of a pocket depend on four numbers: how far the roller stands off its middle, how it is skewed there, and both
rates.  Their changes by the 18 variables of roller and cage are written down once, in ``chain``; every row follows from them.
"""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.lanes import load, magnitude, store, where_positive
from bearing_sim.levels.spatial_algebra import AT_CAGE, BORDER, CAGE_COLUMNS, CAGE_ROWS, LOCAL
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

CHAIN = 40  # row of ``chain`` where this module's part begins
OFFSET, _RATE, INCLINATION, _SKEW_RATE, LEVER, LEAN, KINDS = range(7)  # what depends on a variable: the last two are arms of the cage
_AT_Y, _AT_Z, _AT_TILT_Y, _AT_TILT_Z, _AT_THETA = range(9, 14)  # columns of the cage among the variables, its speeds are 5 further on
VARIABLES = 19


@template
def _put(chain, variable, kind, value):
    store(chain, 0, CHAIN + KINDS * variable + kind, value)


@kernel
def _variables(block, y, rows, chain):
    """Write how offset, skew, their rates and the arms of a block of rollers change by each variable; the rest of ``chain`` stays 0."""
    radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    tilt_speed, skew_speed = load(rows, block, ROLLER.tilt_speed), load(rows, block, ROLLER.skew_speed)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    omega = y[OMEGA]
    turning = load(rows, block, ROLLER.orbital_speed) - omega
    cage_r, cage_t = y[CAGE_Y] * p_c + y[CAGE_Z] * p_s, y[CAGE_Z] * p_c - y[CAGE_Y] * p_s
    lean_r, lean_t = y[CAGE_TILT_Y] * p_c + y[CAGE_TILT_Z] * p_s, y[CAGE_TILT_Z] * p_c - y[CAGE_TILT_Y] * p_s
    speed_r = y[BORDER + CAGE_Y] * p_c + y[BORDER + CAGE_Z] * p_s
    turn_r = y[BORDER + CAGE_TILT_Y] * p_c + y[BORDER + CAGE_TILT_Z] * p_s
    rise = radial_speed * c - radius * s * turning
    outwards, along = tilt * c - skew * s, tilt * s + skew * c
    inclining = tilt_speed * c - skew_speed * s - turning * along
    _put(chain, R, OFFSET, s)
    _put(chain, R, _RATE, c * turning)
    _put(chain, R, LEVER, c)
    _put(chain, PHI, OFFSET, radius * c)
    _put(chain, PHI, _RATE, rise)
    _put(chain, PHI, LEVER, -(radius * s))
    _put(chain, PHI, INCLINATION, outwards)
    _put(chain, PHI, _SKEW_RATE, inclining)
    _put(chain, PHI, LEAN, -along)
    _put(chain, TILT, INCLINATION, s)
    _put(chain, TILT, _SKEW_RATE, c * turning)
    _put(chain, TILT, LEAN, c)
    _put(chain, SKEW, INCLINATION, c)
    _put(chain, SKEW, _SKEW_RATE, -(s * turning))
    _put(chain, SKEW, LEAN, -s)
    _put(chain, R_SPEED, _RATE, s)
    _put(chain, PHI_SPEED, _RATE, radius * c)
    _put(chain, PHI_SPEED, _SKEW_RATE, outwards)
    _put(chain, TILT_SPEED, _SKEW_RATE, s)
    _put(chain, SKEW_SPEED, _SKEW_RATE, c)
    for tilted in range(2):
        y_column, z_column = (_AT_TILT_Y, _AT_TILT_Z) if tilted else (_AT_Y, _AT_Z)
        kind, arm = (INCLINATION, LEAN) if tilted else (OFFSET, LEVER)
        _put(chain, y_column, kind, p_s)
        _put(chain, z_column, kind, -p_c)
        _put(chain, y_column, kind + 1, omega * p_c)
        _put(chain, z_column, kind + 1, omega * p_s)
        _put(chain, y_column, arm, -p_c)
        _put(chain, z_column, arm, -p_s)
        _put(chain, y_column + 5, kind + 1, p_s)
        _put(chain, z_column + 5, kind + 1, -p_c)
    _put(chain, _AT_THETA, OFFSET, cage_r - radius * c)
    _put(chain, _AT_THETA, _RATE, speed_r + omega * cage_t - rise)
    _put(chain, _AT_THETA, LEVER, radius * s - cage_t)
    _put(chain, _AT_THETA, INCLINATION, lean_r - outwards)
    _put(chain, _AT_THETA, _SKEW_RATE, turn_r + omega * lean_t - inclining)
    _put(chain, _AT_THETA, LEAN, along - lean_t)
    _put(chain, _AT_THETA + 5, _RATE, cage_r - radius * c)
    _put(chain, _AT_THETA + 5, _SKEW_RATE, lean_r - outwards)


@template
def _add(block, slopes, row, value):
    store(slopes, block, row, load(slopes, block, row) + value)


@kernel
def _rows(block, y, params, rows, chain, slopes):
    """Add to a roller's rows of forces and moments, and write those of the cage."""
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    force, moment, friction = (
        -load(rows, block, ROLLER.pocket_force),
        -load(rows, block, ROLLER.pocket_moment),
        load(rows, block, ROLLER.pocket_friction),
    )
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    k_0, k_1, k_2 = (
        load(rows, block, ROLLER.pocket_stiffness),
        load(rows, block, ROLLER.pocket_stiffness + 1),
        load(rows, block, ROLLER.pocket_stiffness + 2),
    )
    d_0, d_1, d_2 = (
        load(rows, block, ROLLER.pocket_damping),
        load(rows, block, ROLLER.pocket_damping + 1),
        load(rows, block, ROLLER.pocket_damping + 2),
    )
    push_r, push_t, push_y, push_z = s + friction * c, c - friction * s, friction * p_c - p_s, p_c + friction * p_s
    reach = load(rows, block, ROLLER.radius) * c - (y[CAGE_Y] * p_c + y[CAGE_Z] * p_s)
    side = where_positive(force, params.rollers.radius, -params.rollers.radius)
    arm = reach - friction * (side + load(rows, block, ROLLER.pocket_offset))
    lean = load(rows, block, ROLLER.pocket_lean) - friction * load(rows, block, ROLLER.pocket_skew)
    braking = friction * where_positive(force, 1.0, -1.0)
    per_mass, per_tilt, per_turn = present * (1.0 / cage.mass), present * (1.0 / tilts.cage_inertia), present * (1.0 / cage.inertia)
    for k in range(VARIABLES):
        first = CHAIN + KINDS * k
        offset, rate = load(chain, 0, first + OFFSET), load(chain, 0, first + _RATE)
        skew, skew_rate = load(chain, 0, first + INCLINATION), load(chain, 0, first + _SKEW_RATE)
        lever, leaning = load(chain, 0, first + LEVER), load(chain, 0, first + LEAN)
        by_f = k_0 * offset + k_1 * skew + d_0 * rate + d_1 * skew_rate
        by_m = k_1 * offset + k_2 * skew + d_1 * rate + d_2 * skew_rate
        column = k
        if k > SPIN:
            column = AT_CAGE + k - _AT_Y
            for row in range(5):
                store(slopes, block, row * LOCAL + column, 0.0)
        _add(block, slopes, column, -(by_f * push_r))
        _add(block, slopes, LOCAL + column, -(by_f * push_t))
        _add(block, slopes, 2 * LOCAL + column, -(by_m * push_r))
        _add(block, slopes, 3 * LOCAL + column, -(by_m * push_t))
        _add(block, slopes, 4 * LOCAL + column, -(by_f * braking))
        store(slopes, block, CAGE_ROWS + k, per_mass * (by_f * push_y))
        store(slopes, block, CAGE_ROWS + CAGE_COLUMNS + k, per_mass * (by_f * push_z))
        store(slopes, block, CAGE_ROWS + 2 * CAGE_COLUMNS + k, per_tilt * (by_m * push_y))
        store(slopes, block, CAGE_ROWS + 3 * CAGE_COLUMNS + k, per_tilt * (by_m * push_z))
        turned = by_f * arm + by_m * lean + force * (lever - friction * offset) + moment * (leaning - friction * skew)
        store(slopes, block, CAGE_ROWS + 4 * CAGE_COLUMNS + k, per_turn * turned)


@kernel
def _directions(block, params, rows, slopes):
    """Add that forces and moments turn with pocket and roller, and that friction goes with the spin."""
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_slope)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_r, push_t, push_y, push_z = s + friction * c, c - friction * s, friction * p_c - p_s, p_c + friction * p_s
    force, moment = -load(rows, block, ROLLER.pocket_force), -load(rows, block, ROLLER.pocket_moment)
    theta = AT_CAGE + 4
    for kind in range(2):
        push = force if kind == 0 else moment
        per = present * (1.0 / cage.mass if kind == 0 else 1.0 / tilts.cage_inertia)
        first, to = 2 * kind * LOCAL, CAGE_ROWS + 2 * kind * CAGE_COLUMNS
        _add(block, slopes, first + PHI, -(push * push_t))
        _add(block, slopes, first + theta, push * push_t)
        _add(block, slopes, first + LOCAL + PHI, push * push_r)
        _add(block, slopes, first + LOCAL + theta, -(push * push_r))
        _add(block, slopes, first + SPIN, -(push * c * bend))
        _add(block, slopes, first + LOCAL + SPIN, push * s * bend)
        _add(block, slopes, to + _AT_THETA, -(per * push * push_z))
        _add(block, slopes, to + CAGE_COLUMNS + _AT_THETA, per * push * push_y)
        _add(block, slopes, to + SPIN, per * push * p_c * bend)
        _add(block, slopes, to + CAGE_COLUMNS + SPIN, per * push * p_s * bend)
    size = magnitude(force)
    _add(block, slopes, 4 * LOCAL + SPIN, -(size * bend))
    slid = size * params.rollers.radius + load(rows, block, ROLLER.pocket_offset) * force + load(rows, block, ROLLER.pocket_skew) * moment
    _add(block, slopes, CAGE_ROWS + 4 * CAGE_COLUMNS + SPIN, -(present * (1.0 / cage.inertia) * slid * bend))


@kernel
def pocket_slopes(block, y, params, rows, chain, slopes):
    """Add the pockets to the rows of a block of rollers and write those of the cage; parameters as of `spatial_slopes.roller_slopes`."""
    _variables(block, y, rows, chain)
    _rows(block, y, params, rows, chain, slopes)
    _directions(block, params, rows, slopes)
