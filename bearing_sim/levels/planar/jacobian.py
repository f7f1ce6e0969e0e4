# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The Jacobian of level ``planar``; ``LANES`` rollers at a time (a block).

A roller depends on 15 variables: its own r, phi, r', phi', w, the border's five positions and their five speeds.  Its rows
(`bearing_sim.numerics.block_arrow`) are those of r'', phi'' and w', then those that the accelerations of ring and cage (the border) have
through the roller.  Lanes without a roller contribute nothing to the border.

**Inner contact.** Let a = (a_r, a_t) be the roller's centre relative to the ring's and v its velocity, n = a/|a|, p a right angle ahead of it,
v_n = n.v, v_p = p.v; k and d the derivatives of Q_i by penetration and by its rate, T_Q, T_s, T_u those of the traction by load, sliding and
rolling speed.  n turns by h_r da_r + h_t da_t with h_r = -n_t/|a|, h_t = n_r/|a|, and with delta = R_i + R_w - |a|, delta' = -v_n and
du = omega_i R_i - v_p - w R_w

    Q_ar = -(k n_r + d h_r v_p),  Q_at = -(k n_t + d h_t v_p),  Q_vr = -d n_r,              Q_vt = -d n_t,
    T_ar = T_Q Q_ar + T_s h_r v_n, T_at = T_Q Q_at + T_s h_t v_n, T_vr = T_Q Q_vr + T_s n_t, T_vt = T_Q Q_vt - T_s n_r

are the derivatives by a and v.  What resists rolling and what flanges do act along p as well, with other factors on the spin.  The force in the
roller's frame is F = Q n + T p, so that dF = dQ n + dT p + (h.da) (-F_t, F_r).  By the roller's own variables (c the ring's centre in the roller's
frame):

    d/dr = d/da_r + phi' d/dv_t,   d/dphi = c_r d/da_t - c_t d/da_r + c_r' d/dv_t - c_t' d/dv_r,   d/dr' = d/dv_r,   d/dphi' = r d/dv_t,

and, because the mean rolling speed depends on them, d/dphi' gains T_u (R_w - R_i)/2 and d/dw is (T_u/2 - T_s) R_w.  A ring that moves is
a roller that moves the other way.

**Outer contact.** delta_e = r + R_w - R_e(phi), delta_e' = r' - R_e' phi', du_e = w R_w - r phi':

    Q_r = k,  Q_phi = -k R_e' - d R_e'' phi',  Q_r' = d,  Q_phi' = -d R_e';   T likewise, with T_s and T_u.

**Pocket.** The force f on the wall depends on s and s' (`bearing_sim.levels.common.rollers.place_in_pockets`), its direction on psi.
"""

from bearing_sim.levels.common.flanges import FLANGE
from bearing_sim.levels.planar.state import (
    AT_CAGE,
    AT_RING,
    BLOCK,
    BORDER,
    CAGE,
    CAGE_COLUMNS,
    CAGE_ROWS,
    CAGE_Y,
    CAGE_Z,
    LOCAL,
    OMEGA,
    PHI,
    PHI_SPEED,
    R_SPEED,
    RING,
    RING_COLUMNS,
    RING_ROWS,
    RING_Y,
    RING_Z,
    ROLLER,
    SPIN,
    THETA,
    R,
)
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import add, load, magnitude, spread, store, where_positive
from bearing_sim.physics.contact import CONTACT

_RADIAL, _ORBITAL, _SPINNING = 0, LOCAL, 2 * LOCAL  # where the rows of r'', phi'' and w' begin
_AT_THETA, _AT_OMEGA = AT_CAGE + 2, AT_CAGE + CAGE + 2  # columns of the cage's angle and speed


@fused
def _d_roller(columns, d_orbit, y, cosine, sine, radius, orbital_speed):
    """Return the derivatives by r, phi, r', phi' from those by a and v (see the docstring of the module), and what the rolling speed adds by phi'."""
    d_apart_r, d_apart_t, d_speed_r, d_speed_t = columns
    ring_r, ring_t = y[RING_Y] * cosine + y[RING_Z] * sine, y[RING_Z] * cosine - y[RING_Y] * sine
    ring_speed_r = y[BORDER + RING_Y] * cosine + y[BORDER + RING_Z] * sine
    ring_speed_t = y[BORDER + RING_Z] * cosine - y[BORDER + RING_Y] * sine
    d_angle = d_apart_t * ring_r - d_apart_r * ring_t + d_speed_t * ring_speed_r - d_speed_r * ring_speed_t
    return d_apart_r + orbital_speed * d_speed_t, d_angle, d_speed_r, radius * d_speed_t + d_orbit


@fused
def _roller_columns(put, block, jacobian, first, scale, columns, d_spin):
    """Store or add (``put``) ``scale`` times the columns by r, phi, r', phi', and that by the spin."""
    put(jacobian, block, first + R, scale * columns[0])
    put(jacobian, block, first + PHI, scale * columns[1])
    put(jacobian, block, first + R_SPEED, scale * columns[2])
    put(jacobian, block, first + PHI_SPEED, scale * columns[3])
    put(jacobian, block, first + SPIN, d_spin)


@fused
def _ring_columns(block, jacobian, first, scale, columns, cosine, sine):
    """Write the columns by the ring's position and velocity, from those by a and v: a ring that moves is a roller that moves the other way."""
    store(jacobian, block, first + AT_RING + RING_Y, scale * (columns[1] * sine - columns[0] * cosine))
    store(jacobian, block, first + AT_RING + RING_Z, -scale * (columns[0] * sine + columns[1] * cosine))
    store(jacobian, block, first + AT_RING + RING + RING_Y, scale * (columns[3] * sine - columns[2] * cosine))
    store(jacobian, block, first + AT_RING + RING + RING_Z, -scale * (columns[2] * sine + columns[3] * cosine))


@fused
def _turned(columns_r, columns_t, c, s):
    """Return c times the first columns less s times the second."""
    return (
        columns_r[0] * c - columns_t[0] * s,
        columns_r[1] * c - columns_t[1] * s,
        columns_r[2] * c - columns_t[2] * s,
        columns_r[3] * c - columns_t[3] * s,
    )


@fused
def _inner_rows(block, y, params, rows, force, radial_columns, along_columns, spin_columns, d_orbit, d_spin, jacobian):
    """Write the rows of a block of rollers and of the ring, as far as the inner contact makes them.

    Parameters
    ----------
    force : outwards and along the orbit, on the roller [N].
    radial_columns, along_columns, spin_columns : derivatives by a and v of that force, and of the force that drives the spin.
    d_orbit, d_spin : what the rolling and sliding speeds add by phi' and w: outwards, along, and to the spin's force.
    """
    cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    per_mass, per_inertia = 1.0 / params.rollers.mass, params.rollers.radius / params.rollers.inertia
    per_lever = per_mass / radius
    radial = _d_roller(radial_columns, d_orbit[0], y, cosine, sine, radius, orbital_speed)
    along = _d_roller(along_columns, d_orbit[1], y, cosine, sine, radius, orbital_speed)
    spinning = _d_roller(spin_columns, d_orbit[2], y, cosine, sine, radius, orbital_speed)
    _roller_columns(store, block, jacobian, _RADIAL, per_mass, radial, per_mass * d_spin[0])
    _roller_columns(store, block, jacobian, _ORBITAL, per_lever, along, per_lever * d_spin[1])
    _roller_columns(store, block, jacobian, _SPINNING, per_inertia, spinning, per_inertia * d_spin[2])
    _ring_columns(block, jacobian, _RADIAL, per_mass, radial_columns, cosine, sine)
    _ring_columns(block, jacobian, _ORBITAL, per_lever, along_columns, cosine, sine)
    _ring_columns(block, jacobian, _SPINNING, per_inertia, spin_columns, cosine, sine)
    scale = load(rows, block, ROLLER.present) * (-1.0 / params.ring.mass)
    c, s = scale * cosine, scale * sine
    # the force's direction turns with the roller's azimuth
    radial, along = (radial[0], radial[1] - force[1], radial[2], radial[3]), (along[0], along[1] + force[0], along[2], along[3])
    ring_y, ring_z = RING_ROWS, RING_ROWS + RING_COLUMNS
    _roller_columns(store, block, jacobian, ring_y, 1.0, _turned(radial, along, c, s), d_spin[0] * c - d_spin[1] * s)
    _roller_columns(store, block, jacobian, ring_z, 1.0, _turned(radial, along, s, -c), d_spin[0] * s + d_spin[1] * c)
    _ring_columns(block, jacobian, ring_y, 1.0, _turned(radial_columns, along_columns, c, s), cosine, sine)
    _ring_columns(block, jacobian, ring_z, 1.0, _turned(radial_columns, along_columns, s, -c), cosine, sine)


@fused
def _inner_jacobian(y, inner_radius, resists, params, rows, contacts, jacobian):
    """Write all rows of ring and rollers as far as inner contact and inner flanges make them."""
    roller_radius, push = params.rollers.radius, 1.0 - 2.0 * params.raceways.diameter_ratio
    for block in range(rows.shape[0]):
        n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
        v_n, v_t = load(rows, block, ROLLER.speed_normal), load(rows, block, ROLLER.speed_tangent)
        pressed, across = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.force)
        stiffness, damping = load(contacts, block, CONTACT.stiffness), load(contacts, block, CONTACT.damping)
        # what acts along p on the roller's centre, and what drives its spin: their derivatives by load, by the speed along p, by phi' and by w
        d_load, d_sliding = load(contacts, block, CONTACT.d_load), load(contacts, block, CONTACT.d_sliding)
        d_rolling, carried = 0.5 * load(contacts, block, CONTACT.d_rolling), roller_radius - inner_radius
        d_orbit, d_spin = d_rolling * carried, (d_rolling - d_sliding) * roller_radius
        spin_load, spin_sliding, spin_orbit, spin_spin = d_load, d_sliding, d_orbit, d_spin
        if resists:
            resisted, rolling = load(contacts, block, CONTACT.resistance_d_load), 0.5 * load(contacts, block, CONTACT.resistance_d_rolling)
            across += push * load(contacts, block, CONTACT.resistance)
            d_load, spin_load = d_load + push * resisted, d_load - resisted
            d_orbit, spin_orbit = d_orbit + push * rolling * carried, d_orbit - rolling * carried
            d_spin, spin_spin = d_spin + push * rolling * roller_radius, d_spin - rolling * roller_radius
        if params.flanges.on:
            first, per_radius = ROLLER.inner_flange, 1.0 / roller_radius
            us = load(rows, block, first + FLANGE.us)
            across += load(rows, block, first + FLANGE.force)
            d_sliding, spin_sliding = d_sliding + load(rows, block, first + FLANGE.uu), d_sliding + us * per_radius
            d_spin, spin_spin = d_spin - us, spin_spin - load(rows, block, first + FLANGE.ss) * per_radius
        radial, along = pressed * n_r - across * n_t, pressed * n_t + across * n_r
        turn_r, turn_t = -n_t * inverse, n_r * inverse
        normal = -(stiffness * n_r + damping * turn_r * v_t), -(stiffness * n_t + damping * turn_t * v_t), -(damping * n_r), -(damping * n_t)
        passing = -(turn_r * v_n), -(turn_t * v_n), -n_t, n_r  # of the roller along p; sliding is the other way
        tangent, driving = _turned(normal, passing, d_load, d_sliding), _turned(normal, passing, spin_load, spin_sliding)
        by_r, by_t = _turned(normal, tangent, n_r, n_t), _turned(normal, tangent, n_t, -n_r)
        by_r = by_r[0] - turn_r * along, by_r[1] - turn_t * along, by_r[2], by_r[3]
        by_t = by_t[0] + turn_r * radial, by_t[1] + turn_t * radial, by_t[2], by_t[3]
        by_orbit, by_spin = (-(d_orbit * n_t), d_orbit * n_r, spin_orbit), (-(d_spin * n_t), d_spin * n_r, spin_spin)
        _inner_rows(block, y, params, rows, (radial, along), by_r, by_t, driving, by_orbit, by_spin, jacobian)


@fused
def _outer_columns(block, d_load, d_sliding, d_rolling, roller_radius, rows, normal):
    """Return the derivatives by r, phi, r', phi' of a force along the orbit, from those by load, by sliding and by half the rolling speed.

    ``normal`` are those of the load.
    """
    radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
    d_orbit = d_rolling * (radius + 2.0 * roller_radius) - d_sliding * radius
    return d_load * normal[0] + (d_rolling - d_sliding) * orbital_speed, d_load * normal[1], d_load * normal[2], d_load * normal[3] + d_orbit


@fused
def _outer_jacobian(y, churning, resists, params, rows, contacts, jacobian):
    """Add outer contact and outer flanges, the drag of the mixture and the frame's own rotation to the rows of the rollers."""
    roller_radius, push = params.rollers.radius, 1.0 + 2.0 * params.raceways.diameter_ratio
    per_mass, per_inertia = 1.0 / params.rollers.mass, -roller_radius / params.rollers.inertia
    for block in range(rows.shape[0]):
        outer = rows.shape[0] + block
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        orbital_speed, q_e = load(rows, block, ROLLER.orbital_speed), load(contacts, outer, CONTACT.load)
        slope, curvature = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature)
        stiffness, damping = load(contacts, outer, CONTACT.stiffness), load(contacts, outer, CONTACT.damping)
        d_load, d_sliding = load(contacts, outer, CONTACT.d_load), load(contacts, outer, CONTACT.d_sliding)
        d_rolling = 0.5 * load(contacts, outer, CONTACT.d_rolling)
        d_spin = (d_sliding + d_rolling) * roller_radius
        spin_load, spin_sliding, spin_rolling, spin_spin = d_load, d_sliding, d_rolling, d_spin
        if resists:
            resisted, rolling = load(contacts, outer, CONTACT.resistance_d_load), 0.5 * load(contacts, outer, CONTACT.resistance_d_rolling)
            d_load, spin_load = d_load - push * resisted, d_load + resisted
            d_rolling, spin_rolling = d_rolling - push * rolling, d_rolling + rolling
            d_spin, spin_spin = d_spin - push * rolling * roller_radius, d_spin + rolling * roller_radius
        if params.flanges.on:
            first, per_roller = ROLLER.outer_flange, 1.0 / roller_radius
            us = load(rows, block, first + FLANGE.us)
            d_sliding, spin_sliding = d_sliding + load(rows, block, first + FLANGE.uu), d_sliding - us * per_roller
            d_spin, spin_spin = d_spin - us, spin_spin + load(rows, block, first + FLANGE.ss) * per_roller
        per_radius = 1.0 / radius
        lean, per_lever = params.variants.contour_slope * slope * per_radius, per_mass * per_radius
        normal = stiffness, -(stiffness * slope) - damping * curvature * orbital_speed, damping, -(damping * slope)
        none = spread(0.0)
        _roller_columns(add, block, jacobian, _RADIAL, -per_mass, normal, none)
        along = _outer_columns(block, d_load + lean, d_sliding, d_rolling, roller_radius, rows, normal)  # the contour leans the load along the orbit
        _roller_columns(add, block, jacobian, _ORBITAL, per_lever, along, per_lever * d_spin)
        driving = _outer_columns(block, spin_load, spin_sliding, spin_rolling, roller_radius, rows, normal)
        _roller_columns(add, block, jacobian, _SPINNING, per_inertia, driving, per_inertia * spin_spin)
        add(jacobian, block, _RADIAL + R, orbital_speed * orbital_speed)
        add(jacobian, block, _RADIAL + PHI_SPEED, 2.0 * radius * orbital_speed)
        arm = q_e * lean * per_radius + churning[1] * orbital_speed
        add(jacobian, block, _ORBITAL + R, -(per_lever * arm) - load(rows, block, ROLLER.orbital_acceleration) * per_radius)
        add(jacobian, block, _ORBITAL + PHI, per_lever * (params.variants.contour_slope * q_e * curvature * per_radius))
        add(jacobian, block, _ORBITAL + R_SPEED, -2.0 * orbital_speed * per_radius)
        add(jacobian, block, _ORBITAL + PHI_SPEED, -2.0 * radial_speed * per_radius - churning[1] * per_mass)
        away = radius * orbital_speed - params.raceways.pitch_radius * y[OMEGA]
        store(jacobian, block, _ORBITAL + _AT_OMEGA, per_lever * (-churning[2] * away))


@kernel
def _cage_columns(block, jacobian, first, scale, d_position, d_speed):
    """Write the columns by the cage's position and speed, which begin at ``first``."""
    for k in range(CAGE):
        store(jacobian, block, first + k, scale * d_position[k])
        store(jacobian, block, first + CAGE + k, scale * d_speed[k])


@fused
def _pocket_jacobian(y, params, rows, jacobian):
    """Add the pockets to the rows of the rollers, write those of the cage."""
    for block in range(rows.shape[0]):
        mass = params.rollers.mass
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        stiffness, damping = load(rows, block, ROLLER.pocket_stiffness), load(rows, block, ROLLER.pocket_damping)
        force = -load(rows, block, ROLLER.pocket_force)
        friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_d_spin)
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        play_c, play_s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        omega = y[OMEGA]
        cage_r, cage_t = y[CAGE_Y] * p_c + y[CAGE_Z] * p_s, y[CAGE_Z] * p_c - y[CAGE_Y] * p_s
        speed_r = y[BORDER + CAGE_Y] * p_c + y[BORDER + CAGE_Z] * p_s
        turning, reach = load(rows, block, ROLLER.orbital_speed) - omega, radius * play_c
        lever, rise = reach - cage_r, radial_speed * play_c - radius * play_s * turning
        own = (stiffness * play_s + damping * play_c * turning, stiffness * reach + damping * rise, damping * play_s, damping * reach)
        at = (
            stiffness * p_s + damping * (omega * p_c),
            damping * (omega * p_s) - stiffness * p_c,
            damping * (speed_r + omega * cage_t - rise) - stiffness * lever,
        )
        with_speed = (damping * p_s, -(damping * p_c), -(damping * lever))
        push_r, push_t = play_s + friction * play_c, play_c - friction * play_s
        size, side = magnitude(force), where_positive(force, 1.0, -1.0)
        per_mass, per_lever = -1.0 / mass, (-1.0 / mass) / radius
        per_inertia = (-params.rollers.radius / params.rollers.inertia) * friction * side
        _roller_columns(add, block, jacobian, _RADIAL, per_mass * push_r, own, per_mass * (force * play_c * bend))
        _roller_columns(add, block, jacobian, _ORBITAL, per_lever * push_t, own, -(per_lever * (force * play_s * bend)))
        _roller_columns(add, block, jacobian, _SPINNING, per_inertia, own, (-params.rollers.radius / params.rollers.inertia) * size * bend)
        _cage_columns(block, jacobian, _RADIAL + AT_CAGE, per_mass * push_r, at, with_speed)
        churned = load(jacobian, block, _ORBITAL + _AT_OMEGA)
        _cage_columns(block, jacobian, _ORBITAL + AT_CAGE, per_lever * push_t, at, with_speed)
        add(jacobian, block, _ORBITAL + _AT_OMEGA, churned)
        _cage_columns(block, jacobian, _SPINNING + AT_CAGE, per_inertia, at, with_speed)
        # the force's direction turns with the roller's azimuth and with the pocket
        add(jacobian, block, _RADIAL + PHI, per_mass * (force * push_t))
        add(jacobian, block, _RADIAL + _AT_THETA, -per_mass * (force * push_t))
        add(jacobian, block, _ORBITAL + PHI, -(per_lever * (force * push_r)))
        add(jacobian, block, _ORBITAL + _AT_THETA, per_lever * (force * push_r))
        _cage_jacobian(block, params, rows, jacobian, own, at, with_speed, cage_t, lever)


@kernel
def _cage_jacobian(block, params, rows, jacobian, own, at, with_speed, cage_t, lever):
    """Write the rows of the cage's accelerations as far as the pockets make them."""
    cage, present, roller_radius = params.cage, load(rows, block, ROLLER.present), params.rollers.radius
    radius, offset = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.pocket_offset)
    force = -load(rows, block, ROLLER.pocket_force)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_d_spin)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    play_c, play_s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_y, push_z = friction * p_c - p_s, p_c + friction * p_s
    arm = lever - friction * (where_positive(force, roller_radius, -roller_radius) + offset)
    per_mass, per_inertia = present * (1.0 / cage.mass), present * (1.0 / cage.inertia)
    cage_y, cage_z, theta = CAGE_ROWS, CAGE_ROWS + CAGE_COLUMNS, CAGE_ROWS + 2 * CAGE_COLUMNS
    _roller_columns(store, block, jacobian, cage_y, per_mass * push_y, own, 0.0)
    _roller_columns(store, block, jacobian, cage_z, per_mass * push_z, own, 0.0)
    store(jacobian, block, cage_y + SPIN, per_mass * (force * p_c * bend))
    store(jacobian, block, cage_z + SPIN, per_mass * (force * p_s * bend))
    _cage_columns(block, jacobian, cage_y + BLOCK, per_mass * push_y, at, with_speed)
    _cage_columns(block, jacobian, cage_z + BLOCK, per_mass * push_z, at, with_speed)
    add(jacobian, block, cage_y + BLOCK + 2, -(per_mass * (force * push_z)))
    add(jacobian, block, cage_z + BLOCK + 2, per_mass * (force * push_y))
    braked = force * friction
    turned = (own[0] * arm - braked * play_s + force * play_c, own[1] * arm - (braked * play_c + force * play_s) * radius, own[2] * arm, own[3] * arm)
    _roller_columns(store, block, jacobian, theta, per_inertia, turned, per_inertia * (-((magnitude(force) * roller_radius + offset * force) * bend)))
    moved = (
        at[0] * arm - braked * p_s - force * p_c,
        at[1] * arm + braked * p_c - force * p_s,
        at[2] * arm + braked * lever + force * (radius * play_s - cage_t),
    )
    _cage_columns(block, jacobian, theta + BLOCK, per_inertia, moved, (with_speed[0] * arm, with_speed[1] * arm, with_speed[2] * arm))


@kernel
def _guide_by_variable(block, column, d_offset, d_rate, d_place, params, rows, jacobian):
    """Add to all rows the change by one variable, as far as the directions stay.

    Parameters
    ----------
    column : of the variable.
    d_offset, d_rate : how the offset outwards and its rate change.
    d_place : how the offset along the orbit does.
    """
    cage, rollers, present = params.cage, params.rollers, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    force, friction = -load(rows, block, ROLLER.guide_force), load(rows, block, ROLLER.pocket_friction)
    change = load(rows, block, ROLLER.guide_stiffness) * d_offset + load(rows, block, ROLLER.guide_damping) * d_rate
    braking = friction * where_positive(force, rollers.radius, -rollers.radius)
    arm = load(rows, block, ROLLER.pocket_offset) + friction * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius) + braking
    per_mass, of_cage = 1.0 / rollers.mass, CAGE_ROWS + (column if column < BLOCK else column - 2 * RING)
    add(jacobian, block, column, -(per_mass * change * (c - friction * s)))
    add(jacobian, block, LOCAL + column, per_mass * change * (s + friction * c) / load(rows, block, ROLLER.radius))
    add(jacobian, block, 2 * LOCAL + column, -(change * braking * (1.0 / rollers.inertia)))
    add(jacobian, block, of_cage, present * change * (p_c + friction * p_s) * (1.0 / cage.mass))
    add(jacobian, block, of_cage + CAGE_COLUMNS, present * change * (p_s - friction * p_c) * (1.0 / cage.mass))
    turned = change * arm + force * (d_place + friction * d_offset)
    add(jacobian, block, of_cage + 2 * CAGE_COLUMNS, -(present * turned * (1.0 / cage.inertia)))


@kernel
def _guide_directions(block, params, rows, jacobian):
    """Add what the turning of the force with pocket and roller contributes, and what friction does by the spin."""
    cage, rollers, present = params.cage, params.rollers, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_d_spin)
    force = -load(rows, block, ROLLER.guide_force)
    turned = force * (1.0 / rollers.mass)
    lever = turned / load(rows, block, ROLLER.radius)
    add(jacobian, block, PHI, turned * (s + friction * c))
    add(jacobian, block, _AT_THETA, -(turned * (s + friction * c)))
    add(jacobian, block, SPIN, turned * s * bend)
    add(jacobian, block, LOCAL + PHI, lever * (c - friction * s))
    add(jacobian, block, LOCAL + _AT_THETA, -(lever * (c - friction * s)))
    add(jacobian, block, LOCAL + SPIN, lever * c * bend)
    add(jacobian, block, 2 * LOCAL + SPIN, -(magnitude(force) * bend * (rollers.radius / rollers.inertia)))
    turned = present * force * (1.0 / cage.mass)
    add(jacobian, block, CAGE_ROWS + BLOCK + 2, turned * (friction * p_c - p_s))
    add(jacobian, block, CAGE_ROWS + SPIN, turned * p_s * bend)
    add(jacobian, block, CAGE_ROWS + CAGE_COLUMNS + BLOCK + 2, turned * (p_c + friction * p_s))
    add(jacobian, block, CAGE_ROWS + CAGE_COLUMNS + SPIN, -(turned * p_c * bend))
    slid = force * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius) + magnitude(force) * rollers.radius
    add(jacobian, block, CAGE_ROWS + 2 * CAGE_COLUMNS + SPIN, -(present * slid * bend * (1.0 / cage.inertia)))


@kernel
def _guide_jacobian(y, params, rows, jacobian):
    """Add the derivatives of `guide_accelerations` to those of everything else through the rollers.

    Parameters
    ----------
    y, params, rows : as of `guide_forces`.
    jacobian : takes the derivatives, see `bearing_sim.numerics.block_arrow`.
    """
    omega = y[OMEGA]
    for block in range(rows.shape[0]):
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        orbital_speed, offset = load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.pocket_offset)
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        speed_t = y[BORDER + CAGE_Z] * p_c - y[BORDER + CAGE_Y] * p_s
        turning, lever = orbital_speed - omega, load(rows, block, ROLLER.guide_offset) + params.cage.guidance.pocket_radius
        none = spread(0.0)
        rise = -(radial_speed * s + radius * c * turning)
        turned = radial_speed * s + radius * c * orbital_speed - speed_t - omega * lever
        _guide_by_variable(block, R, c, -(s * turning), s, params, rows, jacobian)
        _guide_by_variable(block, PHI, -(radius * s), rise, radius * c, params, rows, jacobian)
        _guide_by_variable(block, R_SPEED, none, c, none, params, rows, jacobian)
        _guide_by_variable(block, PHI_SPEED, none, -(radius * s), none, params, rows, jacobian)
        _guide_by_variable(block, AT_CAGE, -p_c, omega * p_s, p_s, params, rows, jacobian)
        _guide_by_variable(block, AT_CAGE + 1, -p_s, -(omega * p_c), -p_c, params, rows, jacobian)
        _guide_by_variable(block, _AT_THETA, offset, turned, -lever, params, rows, jacobian)
        _guide_by_variable(block, AT_CAGE + CAGE, none, -p_c, none, params, rows, jacobian)
        _guide_by_variable(block, AT_CAGE + CAGE + 1, none, -p_s, none, params, rows, jacobian)
        _guide_by_variable(block, _AT_OMEGA, none, offset, none, params, rows, jacobian)
        _guide_directions(block, params, rows, jacobian)


@fused
def roller_jacobian(y, inner_radius, churning, resists, params, rows, contacts, jacobian):
    """Write all derivatives through the rollers; their forces have been written.

    How the rollers share an axial load is taken as constant.

    Parameters
    ----------
    y : state.
    inner_radius : R_i, grown [m].
    churning : see `bearing_sim.levels.common.rollers.linear_churning`.
    resists : whether contacts resist rolling.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.planar.state.ROLLER`.
    contacts : see `bearing_sim.physics.contact.CONTACT`.
    jacobian : takes the derivatives.
    """
    _inner_jacobian(y, inner_radius, resists, params, rows, contacts, jacobian)
    _outer_jacobian(y, churning, resists, params, rows, contacts, jacobian)
    _pocket_jacobian(y, params, rows, jacobian)
    if not params.cage.guidance.lands:
        _guide_jacobian(y, params, rows, jacobian)


@kernel
def land_contact_jacobian(contact, d_depth, d_rate, n_y, n_z, along_y, along_z, turn, friction, d_friction, side, cage, own):
    """Add the derivatives of the land's contact: its direction turns with the cage's centre, the depth's rate with its velocity."""
    across = side * friction
    towards_y, towards_z = -n_y + across * n_z, -n_z - across * n_y
    d_y, d_z = d_depth * n_y + d_rate * along_y * turn, d_depth * n_z + d_rate * along_z * turn
    n_yy, n_yz, n_zz = n_z * n_z * turn, -n_y * n_z * turn, n_y * n_y * turn
    own[CAGE_Y, CAGE_Y] += (d_y * towards_y + contact * (-n_yy + across * n_yz)) / cage.mass
    own[CAGE_Y, CAGE_Z] += (d_z * towards_y + contact * (-n_yz + across * n_zz)) / cage.mass
    own[CAGE_Z, CAGE_Y] += (d_y * towards_z + contact * (-n_yz - across * n_yy)) / cage.mass
    own[CAGE_Z, CAGE_Z] += (d_z * towards_z + contact * (-n_zz - across * n_yz)) / cage.mass
    lever = -friction * cage.guide_radius / cage.inertia
    own[THETA, CAGE_Y] += lever * d_y
    own[THETA, CAGE_Z] += lever * d_z
    own[CAGE_Y, OMEGA] += side * contact * d_friction * n_z / cage.mass
    own[CAGE_Z, OMEGA] -= side * contact * d_friction * n_y / cage.mass
    own[THETA, OMEGA] -= d_friction * contact * cage.guide_radius / cage.inertia
    own[CAGE_Y, BORDER + CAGE_Y] += d_rate * n_y * towards_y / cage.mass
    own[CAGE_Y, BORDER + CAGE_Z] += d_rate * n_z * towards_y / cage.mass
    own[CAGE_Z, BORDER + CAGE_Y] += d_rate * n_y * towards_z / cage.mass
    own[CAGE_Z, BORDER + CAGE_Z] += d_rate * n_z * towards_z / cage.mass
    own[THETA, BORDER + CAGE_Y] += lever * d_rate * n_y
    own[THETA, BORDER + CAGE_Z] += lever * d_rate * n_z


@kernel
def react_on_ring(params, own, rate, with_jacobian):
    """Apply the reaction of its lands to the inner ring; a ring that moves is a cage that moves the other way."""
    fraction = -params.cage.mass / params.ring.mass
    for axis in range(2):
        rate[BORDER + RING_Y + axis] += fraction * rate[BORDER + CAGE_Y + axis]
    if not with_jacobian:
        return
    for axis in range(2):
        for row in range(3):
            own[CAGE_Y + row, RING_Y + axis] = -own[CAGE_Y + row, CAGE_Y + axis]
            own[CAGE_Y + row, BORDER + RING_Y + axis] = -own[CAGE_Y + row, BORDER + CAGE_Y + axis]
    for axis in range(2):
        for column in range(2 * BORDER):
            own[RING_Y + axis, column] = fraction * own[CAGE_Y + axis, column]
