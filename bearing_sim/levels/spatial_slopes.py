# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Derivatives of what a roller feels and passes on in space; ``LANES`` rollers at a time (a block).

Rows and columns as `bearing_sim.levels.spatial_algebra` says.  The rows of a roller's accelerations gather forces, moments and the
torque of the spin first, from contact to contact; at the end they become accelerations.
"""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.lanes import load, spread, store
from bearing_sim.levels.spatial_algebra import AT_CAGE_SPEEDS, BORDER, LOCAL, RING_COLUMNS, RING_ROWS
from bearing_sim.levels.spatial_guide import guide_slopes
from bearing_sim.levels.spatial_pocket_slopes import pocket_slopes
from bearing_sim.levels.spatial_slices import SLICED
from bearing_sim.levels.spatial_state import (
    OMEGA,
    PHI,
    PHI_SPEED,
    R_SPEED,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    SKEW,
    SKEW_SPEED,
    SPIN,
    TILT,
    TILT_SPEED,
    R,
)

# Rows of forces outwards and along, of moments outwards and along, of the spin's torque; in this order.
_RADIAL, _ALONG, _TILTING, _SKEWING, _SPINNING = 0, LOCAL, 2 * LOCAL, 3 * LOCAL, 4 * LOCAL
_PUMPED = 154  # row of ``chain`` behind those of the pockets, which rely on what they never write
_SEEN = 8  # place, inclination, and their rates, of the roller against the ring: four pairs


@template
def _add(block, slopes, row, value):
    store(slopes, block, row, load(slopes, block, row) + value)


@kernel
def _chain_row(block, row, first, along, rows, contacts, chain):
    """Write the change of a force or moment by what the inner contact sees, in pairs along the normal and across.

    Parameters
    ----------
    row : of ``chain``, where the result begins.
    first : row of the derivative by penetration; that by lean comes next, and three rows on those by their rates.
    along : the derivatives by sliding, or -1 for a normal force.
    """
    inverse = load(rows, block, ROLLER.inverse_distance)
    v_n, v_p = load(rows, block, ROLLER.speed_normal) * inverse, load(rows, block, ROLLER.speed_tangent) * inverse
    b_n, b_p = load(rows, block, ROLLER.lean_normal), load(rows, block, ROLLER.lean_tangent) * inverse
    turned_n, turned_p = load(rows, block, ROLLER.lean_speed_normal) * inverse, load(rows, block, ROLLER.lean_speed_tangent) * inverse
    by_depth, by_lean = load(contacts, block, first), load(contacts, block, first + 1)
    by_rate, by_lean_rate = load(contacts, block, first + 3), load(contacts, block, first + 4)
    a_p = by_lean_rate * (b_p * v_n + v_p * b_n * inverse - turned_p) - by_rate * v_p - by_lean * b_p
    speed_p, lean_speed_p = -(by_lean_rate * b_p), spread(0.0)
    if along >= 0:
        by_sliding, by_sliding_lean = load(contacts, block, along), load(contacts, block, along + 1)
        a_p += by_sliding * v_n + by_sliding_lean * turned_n
        speed_p -= by_sliding
        lean_speed_p -= by_sliding_lean
    store(chain, 0, row, by_lean_rate * v_p * b_p - by_depth)
    store(chain, 0, row + 1, a_p)
    store(chain, 0, row + 2, -by_lean)
    store(chain, 0, row + 3, -(by_lean_rate * v_p))
    store(chain, 0, row + 4, -by_rate)
    store(chain, 0, row + 5, speed_p)
    store(chain, 0, row + 6, -by_lean_rate)
    store(chain, 0, row + 7, lean_speed_p)


@kernel
def _inner_chain(block, pumping, params, rows, contacts, chain):
    """Write the changes of the inner contact's force (2), moment (2) and spin torque in the roller's frame by what it sees, 5 x 8."""
    n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
    b_n, b_p = load(rows, block, ROLLER.lean_normal), load(rows, block, ROLLER.lean_tangent) * inverse
    q, s = load(contacts, block, SLICED.load), load(contacts, block, SLICED.tilting)
    t, m = load(contacts, block, SLICED.force), load(contacts, block, SLICED.skewing)
    _chain_row(block, 0, SLICED.stiffness, -1, rows, contacts, chain)
    _chain_row(block, 2 * _SEEN, SLICED.stiffness + 1, -1, rows, contacts, chain)
    _chain_row(block, 4 * _SEEN, SLICED.of_force, SLICED.by_sliding, rows, contacts, chain)
    _chain_row(block, 3 * _SEEN, SLICED.of_skewing, SLICED.by_sliding + 1, rows, contacts, chain)
    # the normal forces' own lever, where slices stand apart along the orbit
    for k in range(_SEEN):
        store(chain, 0, _SEEN + k, load(chain, 0, 4 * _SEEN + k) + load(chain, 0, 2 * _SEEN + k) * b_p)
    if pumping:
        push = 1.0 - 2.0 * params.raceways.diameter_ratio
        t += push * load(contacts, block, SLICED.pumping)
        m += push * load(contacts, block, SLICED.pumping_moment)
        _chain_row(block, _PUMPED, SLICED.of_pumping, -1, rows, contacts, chain)
        _chain_row(block, _PUMPED + _SEEN, SLICED.of_pumping_moment, -1, rows, contacts, chain)
        for k in range(_SEEN):
            pumped, turned = load(chain, 0, _PUMPED + k), load(chain, 0, _PUMPED + _SEEN + k)
            _add(0, chain, _SEEN + k, push * pumped)
            _add(0, chain, 3 * _SEEN + k, push * turned)
            _add(0, chain, 4 * _SEEN + k, -pumped)
    _add(0, chain, _SEEN, -(s * b_p * inverse))
    _add(0, chain, _SEEN + 1, -(s * b_n * inverse * inverse))
    _add(0, chain, _SEEN + 3, s * inverse)
    # all directions turn with the roller's place
    _add(0, chain, 1, -((t + s * b_p) * inverse))
    _add(0, chain, _SEEN + 1, q * inverse)
    _add(0, chain, 2 * _SEEN + 1, -(m * inverse))
    _add(0, chain, 3 * _SEEN + 1, s * inverse)
    for row in range(0, 5 * _SEEN, 2):
        normal, across = load(chain, 0, row), load(chain, 0, row + 1)
        store(chain, 0, row, normal * n_r - across * n_t)
        store(chain, 0, row + 1, normal * n_t + across * n_r)
    for pair in range(2):
        for k in range(_SEEN):
            row = 2 * pair * _SEEN + k
            normal, across = load(chain, 0, row), load(chain, 0, row + _SEEN)
            store(chain, 0, row, normal * n_r - across * n_t)
            store(chain, 0, row + _SEEN, normal * n_t + across * n_r)


@kernel
def _inner_slopes(block, y, inner_radius, pumping, params, rows, contacts, chain, slopes):
    """Write a roller's rows as far as the inner contact makes them."""
    _inner_chain(block, pumping, params, rows, contacts, chain)
    c, s = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    ring_r, ring_t = y[RING_Y] * c + y[RING_Z] * s, y[RING_Z] * c - y[RING_Y] * s
    lean_r, lean_t = y[RING_TILT_Y] * c + y[RING_TILT_Z] * s, y[RING_TILT_Z] * c - y[RING_TILT_Y] * s
    speed_r, speed_t = y[BORDER + RING_Y] * c + y[BORDER + RING_Z] * s, y[BORDER + RING_Z] * c - y[BORDER + RING_Y] * s
    turn_r = y[BORDER + RING_TILT_Y] * c + y[BORDER + RING_TILT_Z] * s
    turn_t = y[BORDER + RING_TILT_Z] * c - y[BORDER + RING_TILT_Y] * s
    for k in range(5):
        row, first = k * _SEEN, k * LOCAL
        a_r, a_t, b_r, b_t = load(chain, 0, row), load(chain, 0, row + 1), load(chain, 0, row + 2), load(chain, 0, row + 3)
        da_r, da_t, db_r, db_t = load(chain, 0, row + 4), load(chain, 0, row + 5), load(chain, 0, row + 6), load(chain, 0, row + 7)
        by_angle = a_t * ring_r - a_r * ring_t + b_t * lean_r - b_r * lean_t + da_t * speed_r - da_r * speed_t + db_t * turn_r - db_r * turn_t
        store(slopes, block, first + R, a_r + orbital_speed * da_t)
        store(slopes, block, first + PHI, by_angle)
        store(slopes, block, first + TILT, b_r + orbital_speed * db_t)
        store(slopes, block, first + SKEW, b_t - orbital_speed * db_r)
        store(slopes, block, first + R_SPEED, da_r)
        store(slopes, block, first + PHI_SPEED, radius * da_t + tilt * db_t - skew * db_r)
        store(slopes, block, first + TILT_SPEED, db_r)
        store(slopes, block, first + SKEW_SPEED, db_t)
        store(slopes, block, first + SPIN, 0.0)
        # a ring that moves is a roller that moves the other way
        for pair in range(4):
            by_r, by_t = load(chain, 0, row + 2 * pair), load(chain, 0, row + 2 * pair + 1)
            store(slopes, block, first + 9 + 2 * pair, by_t * s - by_r * c)
            store(slopes, block, first + 10 + 2 * pair, -(by_r * s + by_t * c))
    n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
    by_rolling, by_rolling_x = load(contacts, block, SLICED.by_rolling), load(contacts, block, SLICED.by_rolling + 1)
    by_sliding, by_sliding_x = load(contacts, block, SLICED.by_sliding), load(contacts, block, SLICED.by_sliding + 1)
    carried = 0.5 * (params.rollers.radius - inner_radius)
    for k in range(2):
        column = PHI_SPEED if k == 0 else SPIN
        force = by_rolling * carried if k == 0 else (0.5 * by_rolling - by_sliding) * params.rollers.radius
        moment = by_rolling_x * carried if k == 0 else (0.5 * by_rolling_x - by_sliding_x) * params.rollers.radius
        _add(block, slopes, _RADIAL + column, -(force * n_t))
        _add(block, slopes, _ALONG + column, force * n_r)
        _add(block, slopes, _TILTING + column, -(moment * n_t))
        _add(block, slopes, _SKEWING + column, moment * n_r)
        _add(block, slopes, _SPINNING + column, force)
        if pumping:
            push, rate = 1.0 - 2.0 * params.raceways.diameter_ratio, carried if k == 0 else 0.5 * params.rollers.radius
            pumped, turned = rate * load(contacts, block, SLICED.pumping_by_rolling), rate * load(contacts, block, SLICED.pumping_by_rolling + 1)
            _add(block, slopes, _RADIAL + column, -(push * pumped * n_t))
            _add(block, slopes, _ALONG + column, push * pumped * n_r)
            _add(block, slopes, _TILTING + column, -(push * turned * n_t))
            _add(block, slopes, _SKEWING + column, push * turned * n_r)
            _add(block, slopes, _SPINNING + column, -pumped)


@kernel
def _ring_slopes(block, pumping, params, rows, contacts, slopes):
    """Write the rows of the ring from those of a roller, which hold nothing but the inner contact yet."""
    c, s, inverse = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine), load(rows, block, ROLLER.inverse_distance)
    n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
    q, tilting = load(contacts, block, SLICED.load), load(contacts, block, SLICED.tilting)
    across, skewing = load(contacts, block, SLICED.force), load(contacts, block, SLICED.skewing)
    across += tilting * load(rows, block, ROLLER.lean_tangent) * inverse
    if pumping:
        push = 1.0 - 2.0 * params.raceways.diameter_ratio
        across += push * load(contacts, block, SLICED.pumping)
        skewing += push * load(contacts, block, SLICED.pumping_moment)
    present = load(rows, block, ROLLER.present)
    for pair in range(2):
        first = 2 * pair * LOCAL
        to = RING_ROWS + 2 * pair * RING_COLUMNS
        scale = present * (-1.0 / params.ring.mass if pair == 0 else -params.tilts.ring_free / params.tilts.ring_inertia)
        for k in range(RING_COLUMNS):
            by_r, by_t = load(slopes, block, first + k), load(slopes, block, first + LOCAL + k)
            store(slopes, block, to + k, scale * (by_r * c - by_t * s))
            store(slopes, block, to + RING_COLUMNS + k, scale * (by_r * s + by_t * c))
        normal, tangent = (q, across) if pair == 0 else (tilting, skewing)
        outwards, along = normal * n_r - tangent * n_t, normal * n_t + tangent * n_r
        _add(block, slopes, to + PHI, -(scale * (outwards * s + along * c)))
        _add(block, slopes, to + RING_COLUMNS + PHI, scale * (outwards * c - along * s))


@kernel
def _outer_row(block, first, sign, sums, along, rows, contacts, params, slopes):
    """Add a force or moment of the outer contact to a row; parameters as of `_chain_row`, and ``sign`` of what the roller feels."""
    outer = rows.shape[0] + block
    radius, orbital_speed, tilt = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.tilt)
    slope, curvature, roller_radius = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature), params.rollers.radius
    by_depth, by_lean = sign * load(contacts, outer, sums), sign * load(contacts, outer, sums + 1)
    by_rate, by_lean_rate = sign * load(contacts, outer, sums + 3), sign * load(contacts, outer, sums + 4)
    _add(block, slopes, first + R, by_depth)
    _add(block, slopes, first + PHI, -(by_depth * slope) - by_rate * curvature * orbital_speed)
    _add(block, slopes, first + TILT, by_lean)
    _add(block, slopes, first + R_SPEED, by_rate)
    _add(block, slopes, first + PHI_SPEED, -(by_rate * slope))
    _add(block, slopes, first + TILT_SPEED, by_lean_rate)
    if along < 0:
        return
    by_sliding, by_sliding_lean = sign * load(contacts, outer, along), sign * load(contacts, outer, along + 1)
    by_rolling = (0.5 * sign) * load(contacts, outer, along + 3)
    _add(block, slopes, first + R, (by_rolling - by_sliding) * orbital_speed)
    _add(block, slopes, first + TILT, -(by_sliding_lean * orbital_speed))
    _add(block, slopes, first + PHI_SPEED, by_rolling * (radius + 2.0 * roller_radius) - by_sliding * radius - by_sliding_lean * tilt)
    _add(block, slopes, first + SKEW_SPEED, -by_sliding_lean)
    _add(block, slopes, first + SPIN, (by_sliding + by_rolling) * roller_radius)


@kernel
def _outer_slopes(block, y, churning, params, rows, contacts, slopes):
    """Add the outer contact and the drag of the mixture to a roller's rows."""
    outer = rows.shape[0] + block
    _outer_row(block, _RADIAL, -1.0, SLICED.stiffness, -1, rows, contacts, params, slopes)
    _outer_row(block, _ALONG, 1.0, SLICED.of_force, SLICED.by_sliding, rows, contacts, params, slopes)
    _outer_row(block, _TILTING, -1.0, SLICED.stiffness + 1, -1, rows, contacts, params, slopes)
    _outer_row(block, _SKEWING, 1.0, SLICED.of_skewing, SLICED.by_sliding + 1, rows, contacts, params, slopes)
    _outer_row(block, _SPINNING, -1.0, SLICED.of_force, SLICED.by_sliding, rows, contacts, params, slopes)
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    q, s, skew = load(contacts, outer, SLICED.load), load(contacts, outer, SLICED.tilting), load(rows, block, ROLLER.skew)
    slope, curvature, inverse = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature), 1.0 / radius
    # what the contour's slope and the slices' lever make of the normal forces
    lean = params.raceways.slope_factor * slope * inverse
    lever = skew * inverse
    for k in range(9):
        if k == R or k == PHI or k == TILT or k == R_SPEED or k == PHI_SPEED or k == TILT_SPEED:
            at = k if k < R_SPEED else k - R_SPEED
            sums = SLICED.stiffness if k < R_SPEED else SLICED.damping
            by_q, by_s = load(contacts, outer, sums + (1 if at == TILT else 0)), load(contacts, outer, sums + (2 if at == TILT else 1))
            change = by_q * lean - by_s * lever
            if at == PHI:
                change = -(change * slope)
            _add(block, slopes, _ALONG + k, change)
    by_q, by_s = load(contacts, outer, SLICED.damping), load(contacts, outer, SLICED.damping + 1)
    _add(block, slopes, _ALONG + PHI, -(curvature * orbital_speed * (by_q * lean - by_s * lever)))
    _add(block, slopes, _ALONG + PHI, params.raceways.slope_factor * q * curvature * inverse)
    _add(block, slopes, _ALONG + SKEW, -(s * inverse))
    _add(block, slopes, _ALONG + R, -((q * lean - s * lever) * inverse) - churning[1] * orbital_speed)
    _add(block, slopes, _ALONG + PHI_SPEED, -(churning[1] * radius))
    away = radius * orbital_speed - params.raceways.pitch_radius * y[OMEGA]
    _add(block, slopes, _ALONG + AT_CAGE_SPEEDS + 4, -(churning[2] * away))


@kernel
def _outer_pumping(block, params, rows, contacts, slopes):
    """Add the oil that the outer contact pumps back to a roller's rows."""
    outer, push = rows.shape[0] + block, -(1.0 + 2.0 * params.raceways.diameter_ratio)
    _outer_row(block, _ALONG, push, SLICED.of_pumping, -1, rows, contacts, params, slopes)
    _outer_row(block, _SKEWING, push, SLICED.of_pumping_moment, -1, rows, contacts, params, slopes)
    _outer_row(block, _SPINNING, -1.0, SLICED.of_pumping, -1, rows, contacts, params, slopes)
    radius, orbital_speed, roller_radius = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), params.rollers.radius
    for k in range(3):
        column, rate = (R, orbital_speed) if k == 0 else ((PHI_SPEED, radius + 2.0 * roller_radius) if k == 1 else (SPIN, spread(roller_radius)))
        pumped = 0.5 * rate * load(contacts, outer, SLICED.pumping_by_rolling)
        _add(block, slopes, _ALONG + column, push * pumped)
        _add(block, slopes, _SKEWING + column, push * 0.5 * rate * load(contacts, outer, SLICED.pumping_by_rolling + 1))
        _add(block, slopes, _SPINNING + column, -pumped)


@kernel
def _accelerations(block, params, rows, slopes):
    """Make accelerations of a roller's rows of forces, and add what the motion of its frame and its spin add to them."""
    tilts = params.tilts
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    acceleration, tilt, skew = load(rows, block, ROLLER.orbital_acceleration), load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    tilt_speed, skew_speed = load(rows, block, ROLLER.tilt_speed), load(rows, block, ROLLER.skew_speed)
    inverse, per_mass, per_inertia = 1.0 / radius, 1.0 / params.rollers.mass, 1.0 / tilts.roller_inertia
    per_lever = per_mass * inverse
    for k in range(LOCAL):
        store(slopes, block, _RADIAL + k, per_mass * load(slopes, block, _RADIAL + k))
        store(slopes, block, _ALONG + k, per_lever * load(slopes, block, _ALONG + k))
        store(slopes, block, _SPINNING + k, (params.rollers.radius / params.rollers.inertia) * load(slopes, block, _SPINNING + k))
    _add(block, slopes, _RADIAL + R, orbital_speed * orbital_speed)
    _add(block, slopes, _RADIAL + PHI_SPEED, 2.0 * radius * orbital_speed)
    _add(block, slopes, _ALONG + R, -(acceleration * inverse))
    _add(block, slopes, _ALONG + R_SPEED, -2.0 * orbital_speed * inverse)
    _add(block, slopes, _ALONG + PHI_SPEED, -2.0 * load(rows, block, ROLLER.radial_speed) * inverse)
    for k in range(LOCAL):
        turned = load(slopes, block, _ALONG + k)
        store(slopes, block, _TILTING + k, per_inertia * load(slopes, block, _TILTING + k) + skew * turned)
        store(slopes, block, _SKEWING + k, per_inertia * load(slopes, block, _SKEWING + k) - tilt * turned)
    share = tilts.gyroscopic * params.rollers.inertia * per_inertia
    gyroscopic = share * load(rows, block, ROLLER.spin)
    turning, carrying = gyroscopic + 2.0 * orbital_speed, (gyroscopic + orbital_speed) * orbital_speed
    _add(block, slopes, _TILTING + TILT, carrying)
    _add(block, slopes, _TILTING + SKEW, acceleration)
    _add(block, slopes, _TILTING + SKEW_SPEED, turning)
    _add(block, slopes, _TILTING + PHI_SPEED, 2.0 * skew_speed + turning * tilt)
    _add(block, slopes, _TILTING + SPIN, share * (skew_speed + orbital_speed * tilt))
    _add(block, slopes, _SKEWING + SKEW, carrying)
    _add(block, slopes, _SKEWING + TILT, -acceleration)
    _add(block, slopes, _SKEWING + TILT_SPEED, -turning)
    _add(block, slopes, _SKEWING + PHI_SPEED, turning * skew - 2.0 * tilt_speed)
    _add(block, slopes, _SKEWING + SPIN, share * (orbital_speed * skew - tilt_speed))


@kernel
def roller_slopes(y, inner_radius, churning, pumping, params, rows, contacts, chain, slopes):
    """Write all derivatives through the rollers; their forces have been written.

    Parameters
    ----------
    y : state.
    inner_radius : R_i, grown [m].
    churning : drag of the mixture on a roller, its slope by the roller's speed and the slope's by cage speed.
    pumping : whether the contacts pump oil back.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.spatial_state.ROLLER`.
    contacts : see `bearing_sim.levels.spatial_slices.SLICED`.
    chain : scratch, see `bearing_sim.levels.spatial_state.Work`.
    slopes : takes the derivatives.
    """
    for block in range(rows.shape[0]):
        _inner_slopes(block, y, inner_radius, pumping, params, rows, contacts, chain, slopes)
        _ring_slopes(block, pumping, params, rows, contacts, slopes)
        pocket_slopes(block, y, params, rows, chain, slopes)
        if not params.cage.guidance.lands:
            guide_slopes(block, y, params, rows, chain, slopes)
        _outer_slopes(block, y, churning, params, rows, contacts, slopes)
        if pumping:
            _outer_pumping(block, params, rows, contacts, slopes)
        _accelerations(block, params, rows, slopes)
