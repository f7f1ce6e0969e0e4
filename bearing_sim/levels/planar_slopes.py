# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Derivatives of what a roller feels and passes on, by the 15 variables that it sees; ``LANES`` rollers at a time (a block).

Rows of `bearing_sim.levels.planar_algebra.SLOPES`: those of r'', phi'' and w' first, then those that the border's accelerations
have through the roller.  Lanes without a roller pass nothing on.
"""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.lanes import load, magnitude, store, where_positive
from bearing_sim.kernels.traction import CONTACT
from bearing_sim.levels.planar_algebra import AT_POSITIONS, AT_SPEEDS, BORDER, LOCAL
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, PHI, PHI_SPEED, R_SPEED, RING_Y, RING_Z, ROLLER, SPIN, THETA, R

_RADIAL, _ORBITAL, _SPINNING = 0, LOCAL, 2 * LOCAL  # where the rows of r'', phi'' and w' begin
_PASSED = 3 * LOCAL  # where those of the border begin


@template
def _in_frame(force, traction, turn, n_r, n_t, radial, along):
    """Return the change of a contact's force in the roller's frame, of changes of its parts and a turn of its direction."""
    return force * n_r - traction * n_t - turn * along, force * n_t + traction * n_r + turn * radial


@template
def _by_own(by_apart_r, by_apart_t, by_speed_r, by_speed_t, y, cosine, sine, radius, orbital_speed):
    """Return columns by r, phi, r', phi' from those by place and speed of the roller seen from the ring, in its frame."""
    ring_r, ring_t = y[RING_Y] * cosine + y[RING_Z] * sine, y[RING_Z] * cosine - y[RING_Y] * sine
    ring_speed_r = y[BORDER + RING_Y] * cosine + y[BORDER + RING_Z] * sine
    ring_speed_t = y[BORDER + RING_Z] * cosine - y[BORDER + RING_Y] * sine
    by_angle = by_apart_t * ring_r - by_apart_r * ring_t + by_speed_t * ring_speed_r - by_speed_r * ring_speed_t
    return by_apart_r + orbital_speed * by_speed_t, by_angle, by_speed_r, radius * by_speed_t


@template
def _store_own(block, slopes, first, scale, columns, by_spin):
    """Write the columns by a roller's own variables."""
    store(slopes, block, first + R, scale * columns[0])
    store(slopes, block, first + PHI, scale * columns[1])
    store(slopes, block, first + R_SPEED, scale * columns[2])
    store(slopes, block, first + PHI_SPEED, scale * columns[3])
    store(slopes, block, first + SPIN, scale * by_spin)


@template
def _store_ring(block, slopes, first, scale, by_apart_r, by_apart_t, by_speed_r, by_speed_t, cosine, sine):
    """Write the columns by the ring's position and speed: a ring that moves is a roller that moves the other way."""
    store(slopes, block, first + AT_POSITIONS + RING_Y, scale * (by_apart_t * sine - by_apart_r * cosine))
    store(slopes, block, first + AT_POSITIONS + RING_Z, -scale * (by_apart_r * sine + by_apart_t * cosine))
    store(slopes, block, first + AT_SPEEDS + RING_Y, scale * (by_speed_t * sine - by_speed_r * cosine))
    store(slopes, block, first + AT_SPEEDS + RING_Z, -scale * (by_speed_r * sine + by_speed_t * cosine))


@kernel
def _inner_slopes(y, inner_radius, params, rows, contacts, slopes):
    """Write all rows of ring and rollers as far as the inner contact makes them."""
    for block in range(rows.shape[0]):
        cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
        v_n, v_t = load(rows, block, ROLLER.speed_normal), load(rows, block, ROLLER.speed_tangent)
        q_i, t_i = load(contacts, block, CONTACT.load), load(contacts, block, CONTACT.force)
        stiffness, damping = load(contacts, block, CONTACT.stiffness), load(contacts, block, CONTACT.damping)
        by_load, by_sliding = load(contacts, block, CONTACT.by_load), load(contacts, block, CONTACT.by_sliding)
        by_rolling = load(contacts, block, CONTACT.by_rolling)
        radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        radial, along = q_i * n_r - t_i * n_t, q_i * n_t + t_i * n_r
        turn_1, turn_2 = -n_t * inverse, n_r * inverse
        q_1, q_2 = -(stiffness * n_r + damping * turn_1 * v_t), -(stiffness * n_t + damping * turn_2 * v_t)
        q_3, q_4 = -(damping * n_r), -(damping * n_t)
        t_1, t_2 = by_load * q_1 + by_sliding * turn_1 * v_n, by_load * q_2 + by_sliding * turn_2 * v_n
        t_3, t_4 = by_load * q_3 + by_sliding * n_t, by_load * q_4 - by_sliding * n_r
        f_r1, f_t1 = _in_frame(q_1, t_1, turn_1, n_r, n_t, radial, along)
        f_r2, f_t2 = _in_frame(q_2, t_2, turn_2, n_r, n_t, radial, along)
        f_r3, f_t3 = q_3 * n_r - t_3 * n_t, q_3 * n_t + t_3 * n_r
        f_r4, f_t4 = q_4 * n_r - t_4 * n_t, q_4 * n_t + t_4 * n_r
        t_rolling = 0.5 * by_rolling * (params.rollers.radius - inner_radius)
        t_spin = (0.5 * by_rolling - by_sliding) * params.rollers.radius
        r_0, r_1, r_2, r_3 = _by_own(f_r1, f_r2, f_r3, f_r4, y, cosine, sine, radius, orbital_speed)
        a_0, a_1, a_2, a_3 = _by_own(f_t1, f_t2, f_t3, f_t4, y, cosine, sine, radius, orbital_speed)
        s_0, s_1, s_2, s_3 = _by_own(t_1, t_2, t_3, t_4, y, cosine, sine, radius, orbital_speed)
        r_3, a_3, s_3 = r_3 - t_rolling * n_t, a_3 + t_rolling * n_r, s_3 + t_rolling
        r_4, a_4 = -(t_spin * n_t), t_spin * n_r
        per_mass, per_inertia = 1.0 / params.rollers.mass, params.rollers.radius / params.rollers.inertia
        per_lever = per_mass / radius
        _store_own(block, slopes, _RADIAL, per_mass, (r_0, r_1, r_2, r_3), r_4)
        _store_own(block, slopes, _ORBITAL, per_lever, (a_0, a_1, a_2, a_3), a_4)
        _store_own(block, slopes, _SPINNING, per_inertia, (s_0, s_1, s_2, s_3), t_spin)
        _store_ring(block, slopes, _RADIAL, per_mass, f_r1, f_r2, f_r3, f_r4, cosine, sine)
        _store_ring(block, slopes, _ORBITAL, per_lever, f_t1, f_t2, f_t3, f_t4, cosine, sine)
        _store_ring(block, slopes, _SPINNING, per_inertia, t_1, t_2, t_3, t_4, cosine, sine)
        scale = load(rows, block, ROLLER.present) * (-1.0 / params.ring.mass)
        c, s = scale * cosine, scale * sine
        r_1, a_1 = r_1 - along, a_1 + radial
        ring_y, ring_z = _PASSED + LOCAL * RING_Y, _PASSED + LOCAL * RING_Z
        _store_own(block, slopes, ring_y, 1.0, (r_0 * c - a_0 * s, r_1 * c - a_1 * s, r_2 * c - a_2 * s, r_3 * c - a_3 * s), r_4 * c - a_4 * s)
        _store_own(block, slopes, ring_z, 1.0, (r_0 * s + a_0 * c, r_1 * s + a_1 * c, r_2 * s + a_2 * c, r_3 * s + a_3 * c), r_4 * s + a_4 * c)
        _store_ring(block, slopes, ring_y, 1.0, f_r1 * c - f_t1 * s, f_r2 * c - f_t2 * s, f_r3 * c - f_t3 * s, f_r4 * c - f_t4 * s, cosine, sine)
        _store_ring(block, slopes, ring_z, 1.0, f_r1 * s + f_t1 * c, f_r2 * s + f_t2 * c, f_r3 * s + f_t3 * c, f_r4 * s + f_t4 * c, cosine, sine)


@template
def _add(block, slopes, row, value):
    store(slopes, block, row, load(slopes, block, row) + value)


@kernel
def _outer_slopes(y, churning, params, rows, contacts, slopes):
    """Add the outer contact, the drag of the mixture and the frame's own rotation to the rows of the rollers."""
    for block in range(rows.shape[0]):
        outer = rows.shape[0] + block
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        orbital_speed, q_e = load(rows, block, ROLLER.orbital_speed), load(contacts, outer, CONTACT.load)
        slope, curvature = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature)
        stiffness, damping = load(contacts, outer, CONTACT.stiffness), load(contacts, outer, CONTACT.damping)
        by_load, by_sliding = load(contacts, outer, CONTACT.by_load), load(contacts, outer, CONTACT.by_sliding)
        by_rolling, roller_radius = 0.5 * load(contacts, outer, CONTACT.by_rolling), params.rollers.radius
        q_1, q_2, q_3 = -(stiffness * slope) - damping * curvature * orbital_speed, damping, -(damping * slope)
        t_0 = by_load * stiffness + (by_rolling - by_sliding) * orbital_speed
        t_1, t_2 = by_load * q_1, by_load * q_2
        t_3 = by_load * q_3 - by_sliding * radius + by_rolling * (radius + 2.0 * roller_radius)
        t_4 = (by_sliding + by_rolling) * roller_radius
        per_mass, per_inertia = 1.0 / params.rollers.mass, -roller_radius / params.rollers.inertia
        per_radius = 1.0 / radius
        lean, per_lever = params.raceways.slope_factor * slope * per_radius, per_mass * per_radius
        _add(block, slopes, _RADIAL + R, orbital_speed * orbital_speed - per_mass * stiffness)
        _add(block, slopes, _RADIAL + PHI, -per_mass * q_1)
        _add(block, slopes, _RADIAL + R_SPEED, -per_mass * q_2)
        _add(block, slopes, _RADIAL + PHI_SPEED, 2.0 * radius * orbital_speed - per_mass * q_3)
        arm = q_e * lean * per_radius + churning[1] * orbital_speed
        acceleration = load(rows, block, ROLLER.orbital_acceleration)
        _add(block, slopes, _ORBITAL + R, per_lever * (t_0 + stiffness * lean - arm) - acceleration * per_radius)
        bend = params.raceways.slope_factor * q_e * curvature * per_radius
        _add(block, slopes, _ORBITAL + PHI, per_lever * (t_1 + q_1 * lean + bend))
        _add(block, slopes, _ORBITAL + R_SPEED, per_lever * (t_2 + q_2 * lean) - 2.0 * orbital_speed * per_radius)
        _add(block, slopes, _ORBITAL + PHI_SPEED, per_lever * (t_3 + q_3 * lean) - 2.0 * radial_speed * per_radius - churning[1] * per_mass)
        _add(block, slopes, _ORBITAL + SPIN, per_lever * t_4)
        pitch_speed = params.raceways.pitch_radius * y[OMEGA]
        store(slopes, block, _ORBITAL + AT_SPEEDS + THETA, per_lever * (-churning[2] * (radius * orbital_speed - pitch_speed)))
        _add(block, slopes, _SPINNING + R, per_inertia * t_0)
        _add(block, slopes, _SPINNING + PHI, per_inertia * t_1)
        _add(block, slopes, _SPINNING + R_SPEED, per_inertia * t_2)
        _add(block, slopes, _SPINNING + PHI_SPEED, per_inertia * t_3)
        _add(block, slopes, _SPINNING + SPIN, per_inertia * t_4)


@template
def _store_cage(block, slopes, first, scale, by_position, by_speed):
    """Write the columns by the cage's position and speed."""
    store(slopes, block, first + AT_POSITIONS + CAGE_Y, scale * by_position[0])
    store(slopes, block, first + AT_POSITIONS + CAGE_Z, scale * by_position[1])
    store(slopes, block, first + AT_POSITIONS + THETA, scale * by_position[2])
    store(slopes, block, first + AT_SPEEDS + CAGE_Y, scale * by_speed[0])
    store(slopes, block, first + AT_SPEEDS + CAGE_Z, scale * by_speed[1])
    store(slopes, block, first + AT_SPEEDS + THETA, scale * by_speed[2])


@kernel
def _pocket_slopes(y, params, rows, slopes):
    """Add the pockets to the rows of the rollers, write those of the cage."""
    for block in range(rows.shape[0]):
        mass = params.rollers.mass
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        stiffness, damping = load(rows, block, ROLLER.pocket_stiffness), load(rows, block, ROLLER.pocket_damping)
        force = -load(rows, block, ROLLER.pocket_force)
        friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_slope)
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
        _add_own(block, slopes, _RADIAL, per_mass * push_r, own, per_mass * (force * play_c * bend))
        _add_own(block, slopes, _ORBITAL, per_lever * push_t, own, -(per_lever * (force * play_s * bend)))
        _add_own(block, slopes, _SPINNING, per_inertia, own, (-params.rollers.radius / params.rollers.inertia) * size * bend)
        _store_cage(block, slopes, _RADIAL, per_mass * push_r, at, with_speed)
        churned = load(slopes, block, _ORBITAL + AT_SPEEDS + THETA)
        _store_cage(block, slopes, _ORBITAL, per_lever * push_t, at, with_speed)
        _add(block, slopes, _ORBITAL + AT_SPEEDS + THETA, churned)
        _store_cage(block, slopes, _SPINNING, per_inertia, at, with_speed)
        # the force's own direction turns with the pocket
        _add(block, slopes, _RADIAL + PHI, per_mass * (force * push_t))
        _add(block, slopes, _RADIAL + AT_POSITIONS + THETA, -per_mass * (force * push_t))
        _add(block, slopes, _ORBITAL + PHI, -(per_lever * (force * push_r)))
        _add(block, slopes, _ORBITAL + AT_POSITIONS + THETA, per_lever * (force * push_r))
        _cage_slopes(block, params, rows, slopes, own, at, with_speed, cage_t, lever)


@template
def _add_own(block, slopes, first, scale, columns, by_spin):
    """Add to the columns by a roller's own variables."""
    _add(block, slopes, first + R, scale * columns[0])
    _add(block, slopes, first + PHI, scale * columns[1])
    _add(block, slopes, first + R_SPEED, scale * columns[2])
    _add(block, slopes, first + PHI_SPEED, scale * columns[3])
    _add(block, slopes, first + SPIN, by_spin)


@template
def _cage_slopes(block, params, rows, slopes, own, at, with_speed, cage_t, lever):
    """Write the rows of the cage's accelerations."""
    cage, present, roller_radius = params.cage, load(rows, block, ROLLER.present), params.rollers.radius
    radius, offset = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.pocket_offset)
    force = -load(rows, block, ROLLER.pocket_force)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_slope)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    play_c, play_s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_y, push_z = friction * p_c - p_s, p_c + friction * p_s
    arm = lever - friction * (where_positive(force, roller_radius, -roller_radius) + offset)
    per_mass, per_inertia = present * (1.0 / cage.mass), present * (1.0 / cage.inertia)
    cage_y, cage_z, theta = _PASSED + LOCAL * CAGE_Y, _PASSED + LOCAL * CAGE_Z, _PASSED + LOCAL * THETA
    _store_own(block, slopes, cage_y, per_mass * push_y, own, 0.0)
    _store_own(block, slopes, cage_z, per_mass * push_z, own, 0.0)
    store(slopes, block, cage_y + SPIN, per_mass * (force * p_c * bend))
    store(slopes, block, cage_z + SPIN, per_mass * (force * p_s * bend))
    _store_cage(block, slopes, cage_y, per_mass * push_y, at, with_speed)
    _store_cage(block, slopes, cage_z, per_mass * push_z, at, with_speed)
    _add(block, slopes, cage_y + AT_POSITIONS + THETA, -(per_mass * (force * push_z)))
    _add(block, slopes, cage_z + AT_POSITIONS + THETA, per_mass * (force * push_y))
    braked = force * friction
    turned = (own[0] * arm - braked * play_s + force * play_c, own[1] * arm - (braked * play_c + force * play_s) * radius, own[2] * arm, own[3] * arm)
    _store_own(block, slopes, theta, per_inertia, turned, -((magnitude(force) * roller_radius + offset * force) * bend))
    moved = (
        at[0] * arm - braked * p_s - force * p_c,
        at[1] * arm + braked * p_c - force * p_s,
        at[2] * arm + braked * lever + force * (radius * play_s - cage_t),
    )
    _store_cage(block, slopes, theta, per_inertia, moved, (with_speed[0] * arm, with_speed[1] * arm, with_speed[2] * arm))


@kernel
def roller_slopes(y, inner_radius, churning, params, rows, contacts, slopes):
    """Write all derivatives through the rollers; their forces have been written.

    Parameters
    ----------
    y : state.
    inner_radius : R_i, grown [m].
    churning : drag of the mixture on a roller, its slope by the roller's speed and the slope's by cage speed.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.planar_state.ROLLER`.
    contacts : see `bearing_sim.kernels.traction.CONTACT`.
    slopes : takes the derivatives.
    """
    _inner_slopes(y, inner_radius, params, rows, contacts, slopes)
    _outer_slopes(y, churning, params, rows, contacts, slopes)
    _pocket_slopes(y, params, rows, slopes)


@template
def _add_ring(block, slopes, first, scale, by_apart_r, by_apart_t, by_speed_r, by_speed_t, cosine, sine):
    """Add to the columns by the ring's position and speed; see `_store_ring`."""
    _add(block, slopes, first + AT_POSITIONS + RING_Y, scale * (by_apart_t * sine - by_apart_r * cosine))
    _add(block, slopes, first + AT_POSITIONS + RING_Z, -scale * (by_apart_r * sine + by_apart_t * cosine))
    _add(block, slopes, first + AT_SPEEDS + RING_Y, scale * (by_speed_t * sine - by_speed_r * cosine))
    _add(block, slopes, first + AT_SPEEDS + RING_Z, -scale * (by_speed_r * sine + by_speed_t * cosine))


@kernel
def _inner_pumping(y, inner_radius, params, rows, contacts, slopes):
    """Add what the inner contacts pump to the rows of ring and rollers."""
    push, per_mass = 1.0 - 2.0 * params.raceways.diameter_ratio, 1.0 / params.rollers.mass
    per_inertia = -params.rollers.radius / params.rollers.inertia
    for block in range(rows.shape[0]):
        cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
        radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        by_load, by_rolling = load(contacts, block, CONTACT.pumping_by_load), 0.5 * load(contacts, block, CONTACT.pumping_by_rolling)
        stiffness, damping = by_load * load(contacts, block, CONTACT.stiffness), by_load * load(contacts, block, CONTACT.damping)
        passing = damping * load(rows, block, ROLLER.speed_tangent)
        turn_1, turn_2 = -n_t * inverse, n_r * inverse
        p_1, p_2 = -(stiffness * n_r + turn_1 * passing), -(stiffness * n_t + turn_2 * passing)
        p_3, p_4 = -(damping * n_r), -(damping * n_t)
        pushed = push * load(contacts, block, CONTACT.pumping)
        radial, along = -(pushed * n_t), pushed * n_r
        f_r1, f_t1 = -(push * p_1 * n_t) - turn_1 * along, push * p_1 * n_r + turn_1 * radial
        f_r2, f_t2 = -(push * p_2 * n_t) - turn_2 * along, push * p_2 * n_r + turn_2 * radial
        f_r3, f_t3, f_r4, f_t4 = -(push * p_3 * n_t), push * p_3 * n_r, -(push * p_4 * n_t), push * p_4 * n_r
        by_orbit, by_spin = by_rolling * (params.rollers.radius - inner_radius), by_rolling * params.rollers.radius
        r_0, r_1, r_2, r_3 = _by_own(f_r1, f_r2, f_r3, f_r4, y, cosine, sine, radius, orbital_speed)
        a_0, a_1, a_2, a_3 = _by_own(f_t1, f_t2, f_t3, f_t4, y, cosine, sine, radius, orbital_speed)
        s_0, s_1, s_2, s_3 = _by_own(p_1, p_2, p_3, p_4, y, cosine, sine, radius, orbital_speed)
        r_3, a_3 = r_3 - push * by_orbit * n_t, a_3 + push * by_orbit * n_r
        r_4, a_4 = -(push * by_spin * n_t), push * by_spin * n_r
        per_lever = per_mass / radius
        _add_own(block, slopes, _RADIAL, per_mass, (r_0, r_1, r_2, r_3), per_mass * r_4)
        _add_own(block, slopes, _ORBITAL, per_lever, (a_0, a_1, a_2, a_3), per_lever * a_4)
        _add_own(block, slopes, _SPINNING, per_inertia, (s_0, s_1, s_2, s_3 + by_orbit), per_inertia * by_spin)
        _add_ring(block, slopes, _RADIAL, per_mass, f_r1, f_r2, f_r3, f_r4, cosine, sine)
        _add_ring(block, slopes, _ORBITAL, per_lever, f_t1, f_t2, f_t3, f_t4, cosine, sine)
        _add_ring(block, slopes, _SPINNING, per_inertia, p_1, p_2, p_3, p_4, cosine, sine)
        scale = load(rows, block, ROLLER.present) * (-1.0 / params.ring.mass)
        c, s = scale * cosine, scale * sine
        r_1, a_1 = r_1 - along, a_1 + radial
        ring_y, ring_z = _PASSED + LOCAL * RING_Y, _PASSED + LOCAL * RING_Z
        _add_own(block, slopes, ring_y, 1.0, (r_0 * c - a_0 * s, r_1 * c - a_1 * s, r_2 * c - a_2 * s, r_3 * c - a_3 * s), r_4 * c - a_4 * s)
        _add_own(block, slopes, ring_z, 1.0, (r_0 * s + a_0 * c, r_1 * s + a_1 * c, r_2 * s + a_2 * c, r_3 * s + a_3 * c), r_4 * s + a_4 * c)
        _add_ring(block, slopes, ring_y, 1.0, f_r1 * c - f_t1 * s, f_r2 * c - f_t2 * s, f_r3 * c - f_t3 * s, f_r4 * c - f_t4 * s, cosine, sine)
        _add_ring(block, slopes, ring_z, 1.0, f_r1 * s + f_t1 * c, f_r2 * s + f_t2 * c, f_r3 * s + f_t3 * c, f_r4 * s + f_t4 * c, cosine, sine)


@kernel
def _outer_pumping(params, rows, contacts, slopes):
    """Add what the outer contacts pump to the rows of the rollers."""
    push, roller_radius = 1.0 + 2.0 * params.raceways.diameter_ratio, params.rollers.radius
    per_mass, per_inertia = -push / params.rollers.mass, -roller_radius / params.rollers.inertia
    for block in range(rows.shape[0]):
        outer, radius, orbital_speed = rows.shape[0] + block, load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        by_load, by_rolling = load(contacts, outer, CONTACT.pumping_by_load), 0.5 * load(contacts, outer, CONTACT.pumping_by_rolling)
        stiffness, damping = by_load * load(contacts, outer, CONTACT.stiffness), by_load * load(contacts, outer, CONTACT.damping)
        slope, curvature = load(rows, block, ROLLER.slope), load(rows, block, ROLLER.curvature)
        by_angle, by_orbit = -(stiffness * slope) - damping * curvature * orbital_speed, by_rolling * (radius + 2.0 * roller_radius)
        columns = (stiffness + by_rolling * orbital_speed, by_angle, damping, by_orbit - damping * slope)
        per_lever, by_spin = per_mass / radius, by_rolling * roller_radius
        _add_own(block, slopes, _ORBITAL, per_lever, columns, per_lever * by_spin)
        _add_own(block, slopes, _SPINNING, per_inertia, columns, per_inertia * by_spin)


@kernel
def pumping_slopes(y, inner_radius, params, rows, contacts, slopes):
    """Add what the oil pumped back does to the derivatives of `roller_slopes`, which have been written; parameters as there."""
    _inner_pumping(y, inner_radius, params, rows, contacts, slopes)
    _outer_pumping(params, rows, contacts, slopes)
