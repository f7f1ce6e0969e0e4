# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The Jacobian of level ``spatial``; ``LANES`` rollers at a time (a block).

Derivatives through a roller (`bearing_sim.numerics.block_arrow`): those of its r'', phi'', tilt'', skew'', w' by its own nine variables and the
border's 18; those of the ring's four accelerations by its own nine and the ring's eight; those of the cage's five by its own nine and the cage's
ten.  The rows of a roller's accelerations collect forces, moments and the torque of the spin first, from contact to contact; at the end they
become accelerations.

**Inner contact.** It depends on four pairs: the roller's position a and inclination b relative to the ring, and their rates a', b' in a frame that
does not turn; each pair along the normal n and across it, along p.  v = a', h = 1/|a|, and n turns at h v_p as the roller passes by.  With delta =
R_i + R_w - |a|, lean = -b_n, delta' = -v_n and lean' = -(b_n' + h v_p b_p), a quantity X(delta, lean, delta', lean') changes by

    X_a = (h^2 v_p b_p X_lean' - X_delta,   X_lean' (h^2 b_p v_n + h^2 v_p b_n - h b_p') - X_delta' h v_p - X_lean h b_p),
    X_b = (-X_lean, -h v_p X_lean'),   X_a' = (-X_delta', -h b_p X_lean'),   X_b' = (-X_lean', 0);

a traction depends on the sliding speed and on how it changes along the axis as well (`_chain_row`).  The derivatives by a roller's own
variables follow as at level ``planar``.

**Pocket.** Force and moment depend on four quantities: how far the roller stands off the pocket's middle, how it is skewed there, and both
rates.  Their changes by the 18 variables of roller and cage are written once, in ``chain``; every row follows from them.
"""

from bearing_sim.levels.common.flanges import FLANGE
from bearing_sim.levels.common.support import FOLLOWING
from bearing_sim.levels.planar import state as planar
from bearing_sim.levels.planar.state import BORDER as PLANAR
from bearing_sim.levels.spatial.state import (
    AT_CAGE,
    AT_CAGE_SPEEDS,
    BORDER,
    CAGE_COLUMNS,
    CAGE_ROWS,
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    LOCAL,
    OMEGA,
    PHI,
    PHI_SPEED,
    R_SPEED,
    RING_COLUMNS,
    RING_ROWS,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    SKEW,
    SKEW_SPEED,
    SLICED,
    SPIN,
    THETA,
    TILT,
    TILT_SPEED,
    R,
)
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, add, load, magnitude, spread, store, where_positive

# Rows of forces outwards and along, of moments outwards and along, of the spin's torque; in this order.
_RADIAL, _ALONG, _TILTING, _SKEWING, _SPINNING = 0, LOCAL, 2 * LOCAL, 3 * LOCAL, 4 * LOCAL
_RESISTANCE = 154  # row of ``chain`` behind those of the pockets, which rely on what they never write
_SEEN = 8  # position, inclination, and their rates, of the roller against the ring: four pairs
_CHAIN = 40  # row of ``chain`` where this module's part begins
_OFFSET, _RATE, _INCLINATION, _SKEW_RATE, _LEVER, _LEAN, _KINDS = range(7)  # what depends on a variable: the last two are arms of the cage
_AT_Y, _AT_Z, _AT_TILT_Y, _AT_TILT_Z, _AT_THETA = range(9, 14)  # columns of the cage among the variables, its speeds are 5 further on
_VARIABLES = 19
_RATES = 170  # row of ``chain`` where this module's part begins: changes of the offset's rate and the lean's, by variable


@fused
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
    d_depth, d_lean = load(contacts, block, first), load(contacts, block, first + 1)
    d_rate, d_lean_rate = load(contacts, block, first + 3), load(contacts, block, first + 4)
    a_p = d_lean_rate * (b_p * v_n + v_p * b_n * inverse - turned_p) - d_rate * v_p - d_lean * b_p
    speed_p, lean_speed_p = -(d_lean_rate * b_p), spread(0.0)
    if along >= 0:
        d_sliding, d_sliding_lean = load(contacts, block, along), load(contacts, block, along + 1)
        a_p += d_sliding * v_n + d_sliding_lean * turned_n
        speed_p -= d_sliding
        lean_speed_p -= d_sliding_lean
    store(chain, 0, row, d_lean_rate * v_p * b_p - d_depth)
    store(chain, 0, row + 1, a_p)
    store(chain, 0, row + 2, -d_lean)
    store(chain, 0, row + 3, -(d_lean_rate * v_p))
    store(chain, 0, row + 4, -d_rate)
    store(chain, 0, row + 5, speed_p)
    store(chain, 0, row + 6, -d_lean_rate)
    store(chain, 0, row + 7, lean_speed_p)


@kernel
def _flange_row(block, row, by_u, by_skew, by_rate, rows, chain):
    """Add the change of a force or moment of the inner ring's flanges by what they see, as `_chain_row`.

    They see u = v_p - omega_i r_m, the skew b_p against the ring, and its rate b_p' - h v_p b_n.

    Parameters
    ----------
    row : of ``chain``, where the result is added.
    by_u, by_skew, by_rate : derivatives by these three (lanes).
    """
    inverse = load(rows, block, ROLLER.inverse_distance)
    v_n, v_p = load(rows, block, ROLLER.speed_normal) * inverse, load(rows, block, ROLLER.speed_tangent) * inverse
    b_n, b_p = load(rows, block, ROLLER.lean_normal) * inverse, load(rows, block, ROLLER.lean_tangent) * inverse
    turned_n = load(rows, block, ROLLER.lean_speed_normal) * inverse
    add(chain, 0, row, by_rate * v_p * b_n)
    add(chain, 0, row + 1, by_rate * (v_n * b_n - v_p * b_p - turned_n) - by_u * v_n - by_skew * b_n)
    add(chain, 0, row + 2, -(by_rate * v_p))
    add(chain, 0, row + 3, by_skew)
    add(chain, 0, row + 5, by_u - by_rate * b_n)
    add(chain, 0, row + 7, by_rate)


@kernel
def _skewing_slopes(block, first, face, viscosity, rows):
    """Return the derivatives of a flange's moment on the skew by skew and its rate; parameters as of `rub_on_face`."""
    lever = load(rows, block, first + FLANGE.lever)
    by_skew, by_rate = load(rows, block, first + FLANGE.load_by_skew), load(rows, block, first + FLANGE.load_by_rate)
    return -(lever * by_skew), -(lever * by_rate) - viscosity * face.squeeze


@kernel
def _flange_chain(block, params, viscosity, rows, chain):
    """Add the inner ring's flanges to the rows of `_inner_chain` along the normal and across, before they turn into the roller's frame."""
    first, inverse = ROLLER.inner_flange, load(rows, block, ROLLER.inverse_distance)
    uu, us = load(rows, block, first + FLANGE.uu), load(rows, block, first + FLANGE.us)
    by_skew, by_rate = load(rows, block, first + FLANGE.load_by_skew), load(rows, block, first + FLANGE.load_by_rate)
    force, moment = load(rows, block, first + FLANGE.force_by_load), load(rows, block, first + FLANGE.moment_by_load) * (1.0 / params.rollers.radius)
    d_skew, d_rate = _skewing_slopes(block, first, params.flanges.inner, viscosity, rows)
    b_n, b_p = load(rows, block, ROLLER.lean_normal) * inverse, load(rows, block, ROLLER.lean_tangent) * inverse
    skewing = load(rows, block, first + FLANGE.skewing) * inverse
    _flange_row(block, _SEEN, -uu, force * by_skew - d_skew * b_n, force * by_rate - d_rate * b_n, rows, chain)
    # the skew's direction turns with the roller's position, which gives its moment a lever
    add(chain, 0, _SEEN, skewing * b_n)
    add(chain, 0, _SEEN + 1, -(skewing * b_p))
    add(chain, 0, _SEEN + 2, -skewing)
    _flange_row(block, 3 * _SEEN, spread(0.0), d_skew, d_rate, rows, chain)
    _flange_row(block, 4 * _SEEN, -(us * (1.0 / params.rollers.radius)), moment * by_skew, moment * by_rate, rows, chain)


@fused
def _inner_chain(block, resistance, params, viscosity, rows, contacts, chain):
    """Write the changes of the inner contact's force (2), moment (2) and spin torque in the roller's frame by what it sees, 5 x 8."""
    n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
    b_n, b_p = load(rows, block, ROLLER.lean_normal), load(rows, block, ROLLER.lean_tangent) * inverse
    q, s = load(contacts, block, SLICED.load), load(contacts, block, SLICED.tilting)
    t, m = load(contacts, block, SLICED.force), load(contacts, block, SLICED.skewing)
    _chain_row(block, 0, SLICED.stiffness, -1, rows, contacts, chain)
    _chain_row(block, 2 * _SEEN, SLICED.stiffness + 1, -1, rows, contacts, chain)
    _chain_row(block, 4 * _SEEN, SLICED.of_force, SLICED.d_sliding, rows, contacts, chain)
    _chain_row(block, 3 * _SEEN, SLICED.of_skewing, SLICED.d_sliding + 1, rows, contacts, chain)
    # the normal forces' own lever, where points stand apart along the orbit
    for k in range(_SEEN):
        store(chain, 0, _SEEN + k, load(chain, 0, 4 * _SEEN + k) + load(chain, 0, 2 * _SEEN + k) * b_p)
    if resistance:
        push = 1.0 - 2.0 * params.raceways.diameter_ratio
        t += push * load(contacts, block, SLICED.resistance)
        _chain_row(block, _RESISTANCE, SLICED.of_resistance, -1, rows, contacts, chain)
        for k in range(_SEEN):
            resisted = load(chain, 0, _RESISTANCE + k)
            add(chain, 0, _SEEN + k, push * resisted)
            add(chain, 0, 4 * _SEEN + k, -resisted)
    if params.flanges.on:
        _flange_chain(block, params, viscosity, rows, chain)
        skewing = load(rows, block, ROLLER.inner_flange + FLANGE.skewing)
        t += load(rows, block, ROLLER.inner_flange + FLANGE.force) - skewing * b_n * inverse
        m += skewing
    add(chain, 0, _SEEN, -(s * b_p * inverse))
    add(chain, 0, _SEEN + 1, -(s * b_n * inverse * inverse))
    add(chain, 0, _SEEN + 3, s * inverse)
    # all directions turn with the roller's position
    add(chain, 0, 1, -((t + s * b_p) * inverse))
    add(chain, 0, _SEEN + 1, q * inverse)
    add(chain, 0, 2 * _SEEN + 1, -(m * inverse))
    add(chain, 0, 3 * _SEEN + 1, s * inverse)
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


@fused
def _inner_jacobian(block, y, inner_radius, resistance, params, viscosity, rows, contacts, chain, jacobian):
    """Write a roller's rows as far as the inner contact makes them."""
    _inner_chain(block, resistance, params, viscosity, rows, contacts, chain)
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
        d_angle = a_t * ring_r - a_r * ring_t + b_t * lean_r - b_r * lean_t + da_t * speed_r - da_r * speed_t + db_t * turn_r - db_r * turn_t
        store(jacobian, block, first + R, a_r + orbital_speed * da_t)
        store(jacobian, block, first + PHI, d_angle)
        store(jacobian, block, first + TILT, b_r + orbital_speed * db_t)
        store(jacobian, block, first + SKEW, b_t - orbital_speed * db_r)
        store(jacobian, block, first + R_SPEED, da_r)
        store(jacobian, block, first + PHI_SPEED, radius * da_t + tilt * db_t - skew * db_r)
        store(jacobian, block, first + TILT_SPEED, db_r)
        store(jacobian, block, first + SKEW_SPEED, db_t)
        store(jacobian, block, first + SPIN, 0.0)
        # a ring that moves is a roller that moves the other way
        for pair in range(4):
            d_r, d_t = load(chain, 0, row + 2 * pair), load(chain, 0, row + 2 * pair + 1)
            store(jacobian, block, first + 9 + 2 * pair, d_t * s - d_r * c)
            store(jacobian, block, first + 10 + 2 * pair, -(d_r * s + d_t * c))
    n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
    d_rolling, d_rolling_x = load(contacts, block, SLICED.d_rolling), load(contacts, block, SLICED.d_rolling + 1)
    d_sliding, d_sliding_x = load(contacts, block, SLICED.d_sliding), load(contacts, block, SLICED.d_sliding + 1)
    carried = 0.5 * (params.rollers.radius - inner_radius)
    for k in range(2):
        column = PHI_SPEED if k == 0 else SPIN
        force = d_rolling * carried if k == 0 else (0.5 * d_rolling - d_sliding) * params.rollers.radius
        moment = d_rolling_x * carried if k == 0 else (0.5 * d_rolling_x - d_sliding_x) * params.rollers.radius
        add(jacobian, block, _RADIAL + column, -(force * n_t))
        add(jacobian, block, _ALONG + column, force * n_r)
        add(jacobian, block, _TILTING + column, -(moment * n_t))
        add(jacobian, block, _SKEWING + column, moment * n_r)
        add(jacobian, block, _SPINNING + column, force)
        if resistance:
            push, rate = 1.0 - 2.0 * params.raceways.diameter_ratio, carried if k == 0 else 0.5 * params.rollers.radius
            resisted = rate * load(contacts, block, SLICED.resistance_d_rolling)
            add(jacobian, block, _RADIAL + column, -(push * resisted * n_t))
            add(jacobian, block, _ALONG + column, push * resisted * n_r)
            add(jacobian, block, _SPINNING + column, -resisted)
    if params.flanges.on:
        first = ROLLER.inner_flange
        us, ss = load(rows, block, first + FLANGE.us), load(rows, block, first + FLANGE.ss)
        add(jacobian, block, _RADIAL + SPIN, us * n_t)
        add(jacobian, block, _ALONG + SPIN, -(us * n_r))
        add(jacobian, block, _SPINNING + SPIN, -(ss * (1.0 / params.rollers.radius)))


@fused
def _ring_jacobian(block, resistance, params, rows, contacts, jacobian):
    """Write the rows of the ring from those of a roller, which hold nothing but the inner contact yet."""
    c, s, inverse = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine), load(rows, block, ROLLER.inverse_distance)
    n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
    q, tilting = load(contacts, block, SLICED.load), load(contacts, block, SLICED.tilting)
    across, skewing = load(contacts, block, SLICED.force), load(contacts, block, SLICED.skewing)
    across += tilting * load(rows, block, ROLLER.lean_tangent) * inverse
    if resistance:
        push = 1.0 - 2.0 * params.raceways.diameter_ratio
        across += push * load(contacts, block, SLICED.resistance)
    if params.flanges.on:
        moment = load(rows, block, ROLLER.inner_flange + FLANGE.skewing)
        across += load(rows, block, ROLLER.inner_flange + FLANGE.force) - moment * load(rows, block, ROLLER.lean_normal) * inverse
        skewing += moment
    present = load(rows, block, ROLLER.present)
    for pair in range(2):
        first = 2 * pair * LOCAL
        to = RING_ROWS + 2 * pair * RING_COLUMNS
        scale = present * (-1.0 / params.ring.mass if pair == 0 else -params.tilts.ring_free / params.tilts.ring_inertia)
        for k in range(RING_COLUMNS):
            d_r, d_t = load(jacobian, block, first + k), load(jacobian, block, first + LOCAL + k)
            store(jacobian, block, to + k, scale * (d_r * c - d_t * s))
            store(jacobian, block, to + RING_COLUMNS + k, scale * (d_r * s + d_t * c))
        normal, tangent = (q, across) if pair == 0 else (tilting, skewing)
        outwards, along = normal * n_r - tangent * n_t, normal * n_t + tangent * n_r
        add(jacobian, block, to + PHI, -(scale * (outwards * s + along * c)))
        add(jacobian, block, to + RING_COLUMNS + PHI, scale * (outwards * c - along * s))


@fused
def _outer_row(block, first, sign, sums, along, rows, contacts, params, jacobian):
    """Add a force or moment of the outer contact to a row; parameters as of `_chain_row`, and ``sign`` of what the roller feels."""
    outer = rows.shape[0] + block
    radius, orbital_speed, tilt = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.tilt)
    slope, curvature, roller_radius = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature), params.rollers.radius
    d_depth, d_lean = sign * load(contacts, outer, sums), sign * load(contacts, outer, sums + 1)
    d_rate, d_lean_rate = sign * load(contacts, outer, sums + 3), sign * load(contacts, outer, sums + 4)
    add(jacobian, block, first + R, d_depth)
    add(jacobian, block, first + PHI, -(d_depth * slope) - d_rate * curvature * orbital_speed)
    add(jacobian, block, first + TILT, d_lean)
    add(jacobian, block, first + R_SPEED, d_rate)
    add(jacobian, block, first + PHI_SPEED, -(d_rate * slope))
    add(jacobian, block, first + TILT_SPEED, d_lean_rate)
    if along < 0:
        return
    d_sliding, d_sliding_lean = sign * load(contacts, outer, along), sign * load(contacts, outer, along + 1)
    d_rolling = (0.5 * sign) * load(contacts, outer, along + 3)
    add(jacobian, block, first + R, (d_rolling - d_sliding) * orbital_speed)
    add(jacobian, block, first + TILT, -(d_sliding_lean * orbital_speed))
    add(jacobian, block, first + PHI_SPEED, d_rolling * (radius + 2.0 * roller_radius) - d_sliding * radius - d_sliding_lean * tilt)
    add(jacobian, block, first + SKEW_SPEED, -d_sliding_lean)
    add(jacobian, block, first + SPIN, (d_sliding + d_rolling) * roller_radius)


@fused
def _outer_jacobian(block, y, churning, params, rows, contacts, jacobian):
    """Add the outer contact and the drag of the mixture to a roller's rows."""
    outer = rows.shape[0] + block
    _outer_row(block, _RADIAL, -1.0, SLICED.stiffness, -1, rows, contacts, params, jacobian)
    _outer_row(block, _ALONG, 1.0, SLICED.of_force, SLICED.d_sliding, rows, contacts, params, jacobian)
    _outer_row(block, _TILTING, -1.0, SLICED.stiffness + 1, -1, rows, contacts, params, jacobian)
    _outer_row(block, _SKEWING, 1.0, SLICED.of_skewing, SLICED.d_sliding + 1, rows, contacts, params, jacobian)
    _outer_row(block, _SPINNING, -1.0, SLICED.of_force, SLICED.d_sliding, rows, contacts, params, jacobian)
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    q, s, skew = load(contacts, outer, SLICED.load), load(contacts, outer, SLICED.tilting), load(rows, block, ROLLER.skew)
    slope, curvature, inverse = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature), 1.0 / radius
    # what the contour's slope and the points' lever make of the normal forces
    lean = params.variants.contour_slope * slope * inverse
    lever = skew * inverse
    for k in range(9):
        if k == R or k == PHI or k == TILT or k == R_SPEED or k == PHI_SPEED or k == TILT_SPEED:
            at = k if k < R_SPEED else k - R_SPEED
            sums = SLICED.stiffness if k < R_SPEED else SLICED.damping
            d_q, d_s = load(contacts, outer, sums + (1 if at == TILT else 0)), load(contacts, outer, sums + (2 if at == TILT else 1))
            change = d_q * lean - d_s * lever
            if at == PHI:
                change = -(change * slope)
            add(jacobian, block, _ALONG + k, change)
    d_q, d_s = load(contacts, outer, SLICED.damping), load(contacts, outer, SLICED.damping + 1)
    add(jacobian, block, _ALONG + PHI, -(curvature * orbital_speed * (d_q * lean - d_s * lever)))
    add(jacobian, block, _ALONG + PHI, params.variants.contour_slope * q * curvature * inverse)
    add(jacobian, block, _ALONG + SKEW, -(s * inverse))
    add(jacobian, block, _ALONG + R, -((q * lean - s * lever) * inverse) - churning[1] * orbital_speed)
    add(jacobian, block, _ALONG + PHI_SPEED, -(churning[1] * radius))
    away = radius * orbital_speed - params.raceways.pitch_radius * y[OMEGA]
    add(jacobian, block, _ALONG + AT_CAGE_SPEEDS + 4, -(churning[2] * away))


@kernel
def _outer_resistance(block, params, rows, contacts, jacobian):
    """Add the outer contact's resistance to rolling to a roller's rows."""
    outer, push = rows.shape[0] + block, -(1.0 + 2.0 * params.raceways.diameter_ratio)
    _outer_row(block, _ALONG, push, SLICED.of_resistance, -1, rows, contacts, params, jacobian)
    _outer_row(block, _SPINNING, -1.0, SLICED.of_resistance, -1, rows, contacts, params, jacobian)
    radius, orbital_speed, roller_radius = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), params.rollers.radius
    for k in range(3):
        column, rate = (R, orbital_speed) if k == 0 else ((PHI_SPEED, radius + 2.0 * roller_radius) if k == 1 else (SPIN, spread(roller_radius)))
        resisted = 0.5 * rate * load(contacts, outer, SLICED.resistance_d_rolling)
        add(jacobian, block, _ALONG + column, push * resisted)
        add(jacobian, block, _SPINNING + column, -resisted)


@kernel
def _outer_flanges(block, params, viscosity, rows, jacobian):
    """Add the outer ring's flanges to a roller's rows."""
    first, per_spin = ROLLER.outer_flange, 1.0 / params.rollers.radius
    radius, orbital_speed, tilt = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.tilt)
    uu, us, ss = load(rows, block, first + FLANGE.uu), load(rows, block, first + FLANGE.us), load(rows, block, first + FLANGE.ss)
    by_skew, by_rate = load(rows, block, first + FLANGE.load_by_skew), load(rows, block, first + FLANGE.load_by_rate)
    force, moment = load(rows, block, first + FLANGE.force_by_load), load(rows, block, first + FLANGE.moment_by_load) * per_spin
    d_skew, d_rate = _skewing_slopes(block, first, params.flanges.outer, viscosity, rows)
    inverse, skewing = 1.0 / radius, load(rows, block, first + FLANGE.skewing)
    lever = tilt * inverse
    add(jacobian, block, _ALONG + R, skewing * lever * inverse - uu * orbital_speed)
    add(jacobian, block, _ALONG + TILT, -(skewing * inverse))
    add(jacobian, block, _ALONG + SKEW, force * by_skew - d_skew * lever)
    add(jacobian, block, _ALONG + PHI_SPEED, -(uu * radius))
    add(jacobian, block, _ALONG + SKEW_SPEED, force * by_rate - d_rate * lever)
    add(jacobian, block, _ALONG + SPIN, -us)
    add(jacobian, block, _SKEWING + SKEW, d_skew)
    add(jacobian, block, _SKEWING + SKEW_SPEED, d_rate)
    add(jacobian, block, _SPINNING + R, -(us * orbital_speed * per_spin))
    add(jacobian, block, _SPINNING + SKEW, moment * by_skew)
    add(jacobian, block, _SPINNING + PHI_SPEED, -(us * radius * per_spin))
    add(jacobian, block, _SPINNING + SKEW_SPEED, moment * by_rate)
    add(jacobian, block, _SPINNING + SPIN, -(ss * per_spin))


@fused
def _accelerations(block, params, rows, jacobian):
    """Make accelerations of a roller's rows of forces, and add what the motion of its frame and its spin add to them."""
    tilts = params.tilts
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    acceleration, tilt, skew = load(rows, block, ROLLER.orbital_acceleration), load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    tilt_speed, skew_speed = load(rows, block, ROLLER.tilt_speed), load(rows, block, ROLLER.skew_speed)
    inverse, per_mass, per_inertia = 1.0 / radius, 1.0 / params.rollers.mass, 1.0 / tilts.roller_inertia
    per_lever = per_mass * inverse
    for k in range(LOCAL):
        store(jacobian, block, _RADIAL + k, per_mass * load(jacobian, block, _RADIAL + k))
        store(jacobian, block, _ALONG + k, per_lever * load(jacobian, block, _ALONG + k))
        store(jacobian, block, _SPINNING + k, (params.rollers.radius / params.rollers.inertia) * load(jacobian, block, _SPINNING + k))
    add(jacobian, block, _RADIAL + R, orbital_speed * orbital_speed)
    add(jacobian, block, _RADIAL + PHI_SPEED, 2.0 * radius * orbital_speed)
    add(jacobian, block, _ALONG + R, -(acceleration * inverse))
    add(jacobian, block, _ALONG + R_SPEED, -2.0 * orbital_speed * inverse)
    add(jacobian, block, _ALONG + PHI_SPEED, -2.0 * load(rows, block, ROLLER.radial_speed) * inverse)
    for k in range(LOCAL):
        turned = load(jacobian, block, _ALONG + k)
        store(jacobian, block, _TILTING + k, per_inertia * load(jacobian, block, _TILTING + k) + skew * turned)
        store(jacobian, block, _SKEWING + k, per_inertia * load(jacobian, block, _SKEWING + k) - tilt * turned)
    fraction = params.variants.gyroscopic * params.rollers.inertia * per_inertia
    gyroscopic = fraction * load(rows, block, ROLLER.spin)
    turning, carrying = gyroscopic + 2.0 * orbital_speed, (gyroscopic + orbital_speed) * orbital_speed
    add(jacobian, block, _TILTING + TILT, carrying)
    add(jacobian, block, _TILTING + SKEW, acceleration)
    add(jacobian, block, _TILTING + SKEW_SPEED, turning)
    add(jacobian, block, _TILTING + PHI_SPEED, 2.0 * skew_speed + turning * tilt)
    add(jacobian, block, _TILTING + SPIN, fraction * (skew_speed + orbital_speed * tilt))
    add(jacobian, block, _SKEWING + SKEW, carrying)
    add(jacobian, block, _SKEWING + TILT, -acceleration)
    add(jacobian, block, _SKEWING + TILT_SPEED, -turning)
    add(jacobian, block, _SKEWING + PHI_SPEED, turning * skew - 2.0 * tilt_speed)
    add(jacobian, block, _SKEWING + SPIN, fraction * (orbital_speed * skew - tilt_speed))


@fused
def roller_jacobian(y, inner_radius, churning, resistance, params, viscosity, rows, contacts, chain, jacobian):
    """Write all derivatives through the rollers; their forces have been written.

    Parameters
    ----------
    y : state.
    inner_radius : R_i, grown [m].
    churning : drag of the mixture on a roller, its slope by the roller's speed and the slope's by cage speed.
    resistance : whether the contacts resist rolling.
    params : of the bearing.
    viscosity : of the oil [Pa s].
    rows : of the rollers, see `bearing_sim.levels.spatial.state.ROLLER`.
    contacts : see `bearing_sim.levels.spatial.state.SLICED`.
    chain : scratch, see `bearing_sim.levels.spatial.state.Work`.
    jacobian : takes the derivatives.
    """
    for block in range(rows.shape[0]):
        _inner_jacobian(block, y, inner_radius, resistance, params, viscosity, rows, contacts, chain, jacobian)
        _ring_jacobian(block, resistance, params, rows, contacts, jacobian)
        _pocket_jacobian(block, y, params, rows, chain, jacobian)
        if not params.cage.guidance.lands:
            _guide_jacobian(block, y, params, rows, chain, jacobian)
        _outer_jacobian(block, y, churning, params, rows, contacts, jacobian)
        if resistance:
            _outer_resistance(block, params, rows, contacts, jacobian)
        if params.flanges.on:
            _outer_flanges(block, params, viscosity, rows, jacobian)
        _accelerations(block, params, rows, jacobian)


@kernel
def _put(chain, variable, kind, value):
    store(chain, 0, _CHAIN + _KINDS * variable + kind, value)


@fused
def _pocket_variables(block, y, rows, chain):
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
    _put(chain, R, _OFFSET, s)
    _put(chain, R, _RATE, c * turning)
    _put(chain, R, _LEVER, c)
    _put(chain, PHI, _OFFSET, radius * c)
    _put(chain, PHI, _RATE, rise)
    _put(chain, PHI, _LEVER, -(radius * s))
    _put(chain, PHI, _INCLINATION, outwards)
    _put(chain, PHI, _SKEW_RATE, inclining)
    _put(chain, PHI, _LEAN, -along)
    _put(chain, TILT, _INCLINATION, s)
    _put(chain, TILT, _SKEW_RATE, c * turning)
    _put(chain, TILT, _LEAN, c)
    _put(chain, SKEW, _INCLINATION, c)
    _put(chain, SKEW, _SKEW_RATE, -(s * turning))
    _put(chain, SKEW, _LEAN, -s)
    _put(chain, R_SPEED, _RATE, s)
    _put(chain, PHI_SPEED, _RATE, radius * c)
    _put(chain, PHI_SPEED, _SKEW_RATE, outwards)
    _put(chain, TILT_SPEED, _SKEW_RATE, s)
    _put(chain, SKEW_SPEED, _SKEW_RATE, c)
    for tilted in range(2):
        y_column, z_column = (_AT_TILT_Y, _AT_TILT_Z) if tilted else (_AT_Y, _AT_Z)
        kind, arm = (_INCLINATION, _LEAN) if tilted else (_OFFSET, _LEVER)
        _put(chain, y_column, kind, p_s)
        _put(chain, z_column, kind, -p_c)
        _put(chain, y_column, kind + 1, omega * p_c)
        _put(chain, z_column, kind + 1, omega * p_s)
        _put(chain, y_column, arm, -p_c)
        _put(chain, z_column, arm, -p_s)
        _put(chain, y_column + 5, kind + 1, p_s)
        _put(chain, z_column + 5, kind + 1, -p_c)
    _put(chain, _AT_THETA, _OFFSET, cage_r - radius * c)
    _put(chain, _AT_THETA, _RATE, speed_r + omega * cage_t - rise)
    _put(chain, _AT_THETA, _LEVER, radius * s - cage_t)
    _put(chain, _AT_THETA, _INCLINATION, lean_r - outwards)
    _put(chain, _AT_THETA, _SKEW_RATE, turn_r + omega * lean_t - inclining)
    _put(chain, _AT_THETA, _LEAN, along - lean_t)
    _put(chain, _AT_THETA + 5, _RATE, cage_r - radius * c)
    _put(chain, _AT_THETA + 5, _SKEW_RATE, lean_r - outwards)


@kernel
def _wall_columns(put, block, column, d_f, d_m, push, braking, jacobian):
    """Put the change by one variable into the rows of a roller's forces and moments."""
    put(jacobian, block, column, -(d_f * push[0]))
    put(jacobian, block, LOCAL + column, -(d_f * push[1]))
    put(jacobian, block, 2 * LOCAL + column, -(d_m * push[0]))
    put(jacobian, block, 3 * LOCAL + column, -(d_m * push[1]))
    put(jacobian, block, 4 * LOCAL + column, -(d_f * braking))


@kernel
def _wall_rows(put, block, force, moment, sums, push, arms, between, across, sign, rates, params, rows, chain, jacobian):
    """Write what two opposite walls of the pockets do, to the rows of a roller's forces and moments and of the cage, as far as directions stay.

    Parameters
    ----------
    put : `store` where nothing has written what the cage does yet, else `add`.
    force, moment : of a block of rollers on the walls.
    sums : rows of the sums over slices of the force's derivatives by the offset between the walls, and by its rate.
    push : directions of the force on a roller outwards and along the orbit, on the cage along y and z, with friction (lanes).
    arms : of force and moment about the bearing's axis (lanes).
    between : kinds, in ``chain``, of offset and inclination between the walls; ``across`` of those along them, which change the arms with a ``sign``.
    rates : where the rate of the offset stands in ``chain`` for the first variable, from variable to variable, and to that of the inclination.
    """
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    k, d = sums
    k_0, k_1, k_2 = load(rows, block, k), load(rows, block, k + 1), load(rows, block, k + 2)
    d_0, d_1, d_2 = load(rows, block, d), load(rows, block, d + 1), load(rows, block, d + 2)
    friction = load(rows, block, ROLLER.pocket_friction)
    braking = friction * where_positive(force, 1.0, -1.0)
    per_mass, per_tilt, per_turn = present * (1.0 / cage.mass), present * (1.0 / tilts.cage_inertia), present * (1.0 / cage.inertia)
    for k in range(_VARIABLES):
        first, rate_row = _CHAIN + _KINDS * k, rates[0] + rates[1] * k
        offset, inclination = load(chain, 0, first + between[0]), load(chain, 0, first + between[1])
        lever, leaning = sign * load(chain, 0, first + across[0]), sign * load(chain, 0, first + across[1])
        rate, inclining = load(chain, 0, rate_row), load(chain, 0, rate_row + rates[2])
        d_f = k_0 * offset + k_1 * inclination + d_0 * rate + d_1 * inclining
        d_m = k_1 * offset + k_2 * inclination + d_1 * rate + d_2 * inclining
        if k > SPIN:
            _wall_columns(put, block, AT_CAGE + k - _AT_Y, d_f, d_m, push, braking, jacobian)
        else:
            _wall_columns(add, block, k, d_f, d_m, push, braking, jacobian)
        put(jacobian, block, CAGE_ROWS + k, per_mass * (d_f * push[2]))
        put(jacobian, block, CAGE_ROWS + CAGE_COLUMNS + k, per_mass * (d_f * push[3]))
        put(jacobian, block, CAGE_ROWS + 2 * CAGE_COLUMNS + k, per_tilt * (d_m * push[2]))
        put(jacobian, block, CAGE_ROWS + 3 * CAGE_COLUMNS + k, per_tilt * (d_m * push[3]))
        turned = d_f * arms[0] + d_m * arms[1] + force * (lever - friction * offset) + moment * (leaning - friction * inclination)
        put(jacobian, block, CAGE_ROWS + 4 * CAGE_COLUMNS + k, per_turn * turned)


@kernel
def _wall_directions(block, force, moment, push, bends, slid, params, rows, jacobian):
    """Add that forces and moments turn with pocket and roller, and that friction goes with the spin.

    Parameters
    ----------
    bends : derivatives of ``push`` by the coefficient of friction.
    slid : by what the torque on the cage falls with it.
    """
    cage, tilts, present = params.cage, params.tilts, load(rows, block, ROLLER.present)
    bend, theta = load(rows, block, ROLLER.pocket_friction_d_spin), AT_CAGE + _AT_THETA - _AT_Y
    for kind in range(2):
        pressed = force if kind == 0 else moment
        per = present * (1.0 / cage.mass if kind == 0 else 1.0 / tilts.cage_inertia)
        first, to = 2 * kind * LOCAL, CAGE_ROWS + 2 * kind * CAGE_COLUMNS
        add(jacobian, block, first + PHI, -(pressed * push[1]))
        add(jacobian, block, first + theta, pressed * push[1])
        add(jacobian, block, first + LOCAL + PHI, pressed * push[0])
        add(jacobian, block, first + LOCAL + theta, -(pressed * push[0]))
        add(jacobian, block, first + SPIN, -(pressed * bends[0] * bend))
        add(jacobian, block, first + LOCAL + SPIN, -(pressed * bends[1] * bend))
        add(jacobian, block, to + _AT_THETA, -(per * pressed * push[3]))
        add(jacobian, block, to + CAGE_COLUMNS + _AT_THETA, per * pressed * push[2])
        add(jacobian, block, to + SPIN, per * pressed * bends[2] * bend)
        add(jacobian, block, to + CAGE_COLUMNS + SPIN, per * pressed * bends[3] * bend)
    add(jacobian, block, 4 * LOCAL + SPIN, -(magnitude(force) * bend))
    add(jacobian, block, CAGE_ROWS + 4 * CAGE_COLUMNS + SPIN, -(present * (1.0 / cage.inertia) * slid * bend))


@kernel
def _frames(block, rows):
    """Return cosine and sine of the pocket's azimuth and of the angle from the pocket to the roller, and the coefficient of friction."""
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    return p_c, p_s, load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine), load(rows, block, ROLLER.pocket_friction)


@fused
def _pocket_jacobian(block, y, params, rows, chain, jacobian):
    """Add the pockets to the rows of a block of rollers and write those of the cage; parameters as of `roller_jacobian`."""
    _pocket_variables(block, y, rows, chain)
    p_c, p_s, c, s, friction = _frames(block, rows)
    force, moment = -load(rows, block, ROLLER.pocket_force), -load(rows, block, ROLLER.pocket_moment)
    offset, skew, radius = load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_skew), params.rollers.radius
    push = s + friction * c, c - friction * s, friction * p_c - p_s, p_c + friction * p_s
    reach = load(rows, block, ROLLER.radius) * c - (y[CAGE_Y] * p_c + y[CAGE_Z] * p_s)
    arms = (
        reach - friction * (where_positive(force, radius, -radius) + offset),
        load(rows, block, ROLLER.pocket_lean) - friction * skew,
    )
    sums, rates = (ROLLER.pocket_stiffness, ROLLER.pocket_damping), (_CHAIN + _RATE, _KINDS, _SKEW_RATE - _RATE)
    between, across = (_OFFSET, _INCLINATION), (_LEVER, _LEAN)
    _wall_rows(store, block, force, moment, sums, push, arms, between, across, 1.0, rates, params, rows, chain, jacobian)
    slid = magnitude(force) * radius + offset * force + skew * moment
    _wall_directions(block, force, moment, push, (c, -s, p_c, p_s), slid, params, rows, jacobian)


@kernel
def _put_rates(chain, variable, offset_rate, lean_rate):
    store(chain, 0, _RATES + 2 * variable, offset_rate)
    store(chain, 0, _RATES + 2 * variable + 1, lean_rate)


@kernel
def _guide_rates(block, y, params, rows, chain):
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
    _put_rates(chain, R, -(s * turning), 0.0)
    _put_rates(chain, PHI, -(rise + radius * c * turning), -(inclining + turning * outwards))
    _put_rates(chain, TILT, 0.0, -(s * turning))
    _put_rates(chain, SKEW, 0.0, -(c * turning))
    _put_rates(chain, R_SPEED, c, 0.0)
    _put_rates(chain, PHI_SPEED, -(radius * s), -along)
    _put_rates(chain, TILT_SPEED, 0.0, c)
    _put_rates(chain, SKEW_SPEED, 0.0, -s)
    _put_rates(chain, _AT_Y, omega * p_s, 0.0)
    _put_rates(chain, _AT_Y + 1, -(omega * p_c), 0.0)
    _put_rates(chain, _AT_TILT_Y, 0.0, omega * p_s)
    _put_rates(chain, _AT_TILT_Y + 1, 0.0, -(omega * p_c))
    _put_rates(chain, _AT_Y + 5, -p_c, 0.0)
    _put_rates(chain, _AT_Y + 6, -p_s, 0.0)
    _put_rates(chain, _AT_TILT_Y + 5, 0.0, -p_c)
    _put_rates(chain, _AT_TILT_Y + 6, 0.0, -p_s)
    moved = rise + radius * c * orbital_speed - speed_t - omega * lever
    _put_rates(chain, _AT_THETA, moved, inclining + orbital_speed * outwards - turn_t - omega * lean)
    _put_rates(chain, _AT_THETA + 5, load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_skew))


@kernel
def _guide_jacobian(block, y, params, rows, chain, jacobian):
    """Add the derivatives of what guiding pockets do, after `_pocket_jacobian`: its walls turned by a right angle."""
    _guide_rates(block, y, params, rows, chain)
    p_c, p_s, c, s, friction = _frames(block, rows)
    force, moment = -load(rows, block, ROLLER.guide_force), -load(rows, block, ROLLER.guide_moment)
    lean, radius = load(rows, block, ROLLER.pocket_lean), params.rollers.radius
    push = c - friction * s, -(s + friction * c), p_c + friction * p_s, p_s - friction * p_c
    reach = load(rows, block, ROLLER.guide_offset) + params.cage.guidance.pocket_radius
    arm = load(rows, block, ROLLER.pocket_offset) + friction * where_positive(force, 1.0, -1.0) * radius
    arms = -(arm + friction * reach), -(load(rows, block, ROLLER.pocket_skew) + friction * lean)
    sums, rates = (ROLLER.guide_stiffness, ROLLER.guide_damping), (_RATES, 2, 1)
    between, across = (_LEVER, _LEAN), (_OFFSET, _INCLINATION)
    _wall_rows(add, block, force, moment, sums, push, arms, between, across, -1.0, rates, params, rows, chain, jacobian)
    slid = force * reach + magnitude(force) * radius + moment * lean
    _wall_directions(block, force, moment, push, (-s, -c, p_s, -p_c), slid, params, rows, jacobian)


@fused
def land_cage_jacobian(position, lever, lands, own):
    """Write the derivatives of the cage's accelerations by its positions and speeds from those of both lands."""
    for which in range(2):
        first, planar_first = which * BORDER, which * PLANAR
        for row in range(3):
            planar_row = planar.CAGE_Y + row
            for column in range(3):
                near, far = lands[0, planar_row, planar_first + 2 + column], lands[1, planar_row, planar_first + 2 + column]
                mean, apart = 0.5 * (near + far), near - far
                to = first + (THETA if column == 2 else CAGE_Y + column)
                if row == 2:
                    own[THETA, to] = mean
                    if column < 2:
                        own[THETA, first + CAGE_TILT_Y + column] = 0.5 * position * apart
                    continue
                own[CAGE_Y + row, to] = mean
                own[CAGE_TILT_Y + row, to] = lever * apart
                if column < 2:
                    own[CAGE_Y + row, first + CAGE_TILT_Y + column] = 0.5 * position * apart
                    own[CAGE_TILT_Y + row, first + CAGE_TILT_Y + column] = 2.0 * lever * position * mean


@kernel
def land_ring_jacobian(position, lever, ring_lever, lands, own):
    """Write what the inner ring's motion does to the cage in its lands, and what both motions do to the ring."""
    for which in range(2):
        first, planar_first = which * BORDER, which * PLANAR
        for axis in range(2):
            for other in range(2):
                to_ring, to_cage = first + RING_Y + other, first + CAGE_Y + other
                by_ring, by_cage = planar_first + planar.RING_Y + other, planar_first + planar.CAGE_Y + other
                _land_pair(CAGE_Y + axis, planar.CAGE_Y + axis, lever, to_ring, by_ring, position, lands, own)
                _land_pair(RING_Y + axis, planar.RING_Y + axis, ring_lever, to_ring, by_ring, position, lands, own)
                _land_pair(RING_Y + axis, planar.RING_Y + axis, ring_lever, to_cage, by_cage, position, lands, own)
            near, far = lands[0, planar.THETA, planar_first + axis], lands[1, planar.THETA, planar_first + axis]
            own[THETA, first + RING_Y + axis] = 0.5 * (near + far)
            own[THETA, first + RING_TILT_Y + axis] = 0.5 * position * (near - far)
            near = lands[0, planar.RING_Y + axis, planar_first + planar.THETA]
            far = lands[1, planar.RING_Y + axis, planar_first + planar.THETA]
            own[RING_Y + axis, first + THETA] = 0.5 * (near + far)
            own[RING_TILT_Y + axis, first + THETA] = ring_lever * (near - far)


@kernel
def _land_pair(row, planar_row, lever, column, planar_column, position, lands, own):
    """Write the derivatives of a body's acceleration and tilting by a body's position and tilt, two rows and columns on, from those of both lands."""
    near, far = lands[0, planar_row, planar_column], lands[1, planar_row, planar_column]
    own[row, column] = 0.5 * (near + far)
    own[row, column + 2] = 0.5 * position * (near - far)
    own[row + 2, column] = lever * (near - far)
    own[row + 2, column + 2] = lever * position * (near + far)


@kernel
def follow_axes(count, rows, support):
    """Write what a unit of a_O does to the axes of the rollers, which are described in the frame that turns with the orbit."""
    for j in range(count):
        block, lane = j // LANES, j % LANES
        tilt, skew = rows[block, ROLLER.tilt, lane], rows[block, ROLLER.skew, lane]
        for axis in range(2):
            turned = support[FOLLOWING + axis, ROLLERS + PHI_SPEED * count + j]
            support[FOLLOWING + axis, ROLLERS + TILT_SPEED * count + j] = turned * skew
            support[FOLLOWING + axis, ROLLERS + SKEW_SPEED * count + j] = -(turned * tilt)


@kernel
def turn_axes(block, frame, rows, jacobian):
    """Add to a block's rows of tilt'' and skew'' how the frame's acceleration turns with a roller's azimuth."""
    cosine, sine, inverse = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine), 1.0 / load(rows, block, ROLLER.radius)
    outwards, along = frame[0] * cosine + frame[1] * sine, frame[1] * cosine - frame[0] * sine
    tilt, skew, turned = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew), -(along * inverse)
    add(jacobian, block, _TILTING + SKEW, turned)
    add(jacobian, block, _TILTING + PHI, skew * outwards * inverse)
    add(jacobian, block, _TILTING + R, -(skew * turned * inverse))
    add(jacobian, block, _SKEWING + TILT, -turned)
    add(jacobian, block, _SKEWING + PHI, -(tilt * outwards * inverse))
    add(jacobian, block, _SKEWING + R, tilt * turned * inverse)
