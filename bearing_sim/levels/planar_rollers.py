"""What each roller feels and passes on, in the plane, with all derivatives."""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.drag import churning_force
from bearing_sim.kernels.traction import FILM
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.planar_algebra import AT_POSITIONS, AT_SPEEDS, BLOCK, BORDER, LOCAL
from bearing_sim.levels.planar_equations import (
    CAGE_Y,
    CAGE_Z,
    FRICTION_SPIN,
    OMEGA,
    PHI,
    PHI_SPEED,
    R_SPEED,
    RING_Y,
    RING_Z,
    ROLLER,
    SPIN,
    THETA,
    R,
    border_accelerations,
    normal_loads,
    place_rollers,
    pocket_force,
    tractions,
)  # fmt: skip

_TURN, _NORMAL, _TANGENT, _Q_I, _T_I, _RADIAL, _ALONG, _Q_E, _T_E, _FORCE, _OFFSET, _RATE = range(12)


@kernel
def _raceway_gradients(first, j, y, params, work):
    """Write the derivatives of the raceway forces on roller j by its 15 variables into ``work.gradient``."""
    rows, g, film, outer = work.rollers, work.gradient, work.film, work.rollers.shape[1] + j
    raceways, roller_radius, damping = params.raceways, params.rollers.radius, params.ring.contact_damping
    c, s, n_r, n_t = rows[ROLLER.cosine, j], rows[ROLLER.sine, j], rows[ROLLER.normal_r, j], rows[ROLLER.normal_t, j]
    distance, radius, phi_speed = rows[ROLLER.distance, j], y[first + R], y[first + PHI_SPEED]
    along, across = radius - distance * n_r, -distance * n_t
    ring_r = y[BORDER + RING_Y] * c + y[BORDER + RING_Z] * s
    ring_t = -y[BORDER + RING_Y] * s + y[BORDER + RING_Z] * c
    v_n, v_t = rows[ROLLER.speed_normal, j], rows[ROLLER.speed_tangent, j]
    for x in range(LOCAL):
        g[_TURN, x], g[_NORMAL, x], g[_TANGENT, x], g[_OFFSET, x] = 0.0, 0.0, 0.0, 0.0
    # distance in row _OFFSET for now; the direction's turn in its own
    g[_OFFSET, R], g[_TURN, R] = n_r, -n_t / distance
    g[_OFFSET, PHI], g[_TURN, PHI] = -n_r * across + n_t * along, (n_r * along + n_t * across) / distance
    g[_OFFSET, AT_POSITIONS + RING_Y], g[_TURN, AT_POSITIONS + RING_Y] = -n_r * c + n_t * s, (n_r * s + n_t * c) / distance
    g[_OFFSET, AT_POSITIONS + RING_Z], g[_TURN, AT_POSITIONS + RING_Z] = -n_r * s - n_t * c, (-n_r * c + n_t * s) / distance
    g[_NORMAL, R_SPEED], g[_TANGENT, R_SPEED] = n_r, -n_t
    g[_NORMAL, R], g[_TANGENT, R] = n_t * phi_speed, n_r * phi_speed
    g[_NORMAL, PHI_SPEED], g[_TANGENT, PHI_SPEED] = n_t * radius, n_r * radius
    g[_NORMAL, PHI], g[_TANGENT, PHI] = -n_r * ring_t + n_t * ring_r, n_r * ring_r + n_t * ring_t
    g[_NORMAL, AT_SPEEDS + RING_Y], g[_TANGENT, AT_SPEEDS + RING_Y] = -n_r * c + n_t * s, n_r * s + n_t * c
    g[_NORMAL, AT_SPEEDS + RING_Z], g[_TANGENT, AT_SPEEDS + RING_Z] = -n_r * s - n_t * c, -n_r * c + n_t * s
    inner_damping, outer_damping = 1.0 + damping * rows[ROLLER.inner_rate, j], 1.0 + damping * rows[ROLLER.outer_rate, j]
    by_depth, by_rate, outer_by_depth, outer_by_rate = 0.0, 0.0, 0.0, 0.0
    if rows[ROLLER.inner_penetration, j] > 0.0 and inner_damping > 0.0:
        root = raceways.stiffness * rows[ROLLER.inner_root, j]
        by_depth, by_rate = 10.0 / 9.0 * root * inner_damping, root * rows[ROLLER.inner_penetration, j] * damping
    if rows[ROLLER.outer_penetration, j] > 0.0 and outer_damping > 0.0:
        root = raceways.stiffness * rows[ROLLER.outer_root, j]
        outer_by_depth, outer_by_rate = 10.0 / 9.0 * root * outer_damping, root * rows[ROLLER.outer_penetration, j] * damping
    load, sliding = film[FILM.by_load, j], film[FILM.by_sliding, j]
    q_i, t_i = rows[ROLLER.inner_load, j], film[FILM.force, j]
    radial, tangential = q_i * n_r - t_i * n_t, q_i * n_t + t_i * n_r
    for x in range(LOCAL):
        normal = g[_NORMAL, x] + g[_TURN, x] * v_t
        tangent = g[_TANGENT, x] - g[_TURN, x] * v_n
        by_q = -by_depth * g[_OFFSET, x] - by_rate * normal
        by_t = load * by_q - sliding * tangent
        g[_Q_I, x], g[_T_I, x] = by_q, by_t
    g[_T_I, SPIN] += (0.5 * film[FILM.by_rolling, j] - sliding) * roller_radius
    g[_T_I, PHI_SPEED] += 0.5 * film[FILM.by_rolling, j] * (roller_radius - raceways.inner_radius)
    for x in range(LOCAL):
        g[_RADIAL, x] = g[_Q_I, x] * n_r - g[_T_I, x] * n_t - g[_TURN, x] * tangential
        g[_ALONG, x] = g[_Q_I, x] * n_t + g[_T_I, x] * n_r + g[_TURN, x] * radial
        g[_Q_E, x], g[_T_E, x] = 0.0, 0.0
    slope = rows[ROLLER.slope, j]
    load, sliding, rolling = film[FILM.by_load, outer], film[FILM.by_sliding, outer], film[FILM.by_rolling, outer]
    g[_Q_E, R], g[_Q_E, R_SPEED], g[_Q_E, PHI_SPEED] = outer_by_depth, outer_by_rate, -outer_by_rate * slope
    g[_Q_E, PHI] = -outer_by_depth * slope - outer_by_rate * rows[ROLLER.curvature, j] * phi_speed
    g[_T_E, R] = load * g[_Q_E, R] - sliding * phi_speed + 0.5 * rolling * phi_speed
    g[_T_E, PHI] = load * g[_Q_E, PHI]
    g[_T_E, R_SPEED] = load * g[_Q_E, R_SPEED]
    g[_T_E, PHI_SPEED] = load * g[_Q_E, PHI_SPEED] - sliding * radius + 0.5 * rolling * (radius + 2.0 * roller_radius)
    g[_T_E, SPIN] = (sliding + 0.5 * rolling) * roller_radius


@kernel
def equations(t, y, model, work, rate, with_jacobian):
    """Write dy/dt into ``rate`` and, where asked, all derivatives into ``work``; return True.

    Roller (Deng 2017, eq. 14): m (r'' - r phi'^2) and m (r phi'' + 2 r' phi') are the sums of both normal forces along their
    true directions, both tractions, the pocket's force and its friction, and the drag of the mixture; J w' = R_w (T_i - T_e)
    less pocket friction.  Whatever a roller feels from ring and cage acts back on them, so that momentum is kept.
    """
    params = model.params
    rows, g, film, cage = work.rollers, work.gradient, work.film, params.cage
    mass, spin_inertia, roller_radius = params.rollers.mass, params.rollers.inertia, params.rollers.radius
    shaft_speed = shaft_speed_at(t, model.drive)
    place_rollers(y, params, work)
    normal_loads(params, work)
    tractions(shaft_speed, y, model, work)
    border_accelerations(t, y, model, work, rate, with_jacobian)
    for k in range(BORDER):
        rate[k] = y[BORDER + k]
    cage_y, cage_z, cage_y_speed, cage_z_speed, omega = y[CAGE_Y], y[CAGE_Z], y[BORDER + CAGE_Y], y[BORDER + CAGE_Z], y[OMEGA]
    pitch_speed = params.raceways.pitch_radius * omega
    churning, churning_slope = churning_force(
        pitch_speed, model.lubrication.mixture_density, model.lubrication.viscosity, 2.0 * roller_radius, params.rollers.length
    )
    churning_bend = 0.0  # the slope's own slope by cage speed, of the local power of the speed
    if churning != 0.0:
        churning_bend = churning_slope * (churning_slope / churning - 1.0 / pitch_speed) * params.raceways.pitch_radius
    for j in range(rows.shape[1]):
        first = 2 * BORDER + BLOCK * j
        radius, radius_speed, phi_speed, spin = y[first + R], y[first + R_SPEED], y[first + PHI_SPEED], y[first + SPIN]
        c, s, play_c, play_s = rows[ROLLER.cosine, j], rows[ROLLER.sine, j], rows[ROLLER.pocket_cosine, j], rows[ROLLER.pocket_sine, j]
        pocket_c, pocket_s = c * play_c + s * play_s, s * play_c - c * play_s
        cage_r, cage_t = cage_y * pocket_c + cage_z * pocket_s, -cage_y * pocket_s + cage_z * pocket_c
        speed_r, speed_t = cage_y_speed * pocket_c + cage_z_speed * pocket_s, -cage_y_speed * pocket_s + cage_z_speed * pocket_c
        offset, lever = radius * play_s - cage_t, radius * play_c - cage_r
        offset_rate = radius_speed * play_s + radius * play_c * (phi_speed - omega) - speed_t + omega * cage_r
        force, by_offset, by_rate = pocket_force(offset, offset_rate, cage, params.raceways.stiffness, params.ring.contact_damping)
        smooth = math.sqrt(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
        friction = cage.pocket_friction * spin / smooth
        size = abs(force)
        rows[ROLLER.pocket_force, j] = -force
        rows[ROLLER.pocket_offset, j] = offset
        q_i, q_e, t_i, t_e = rows[ROLLER.inner_load, j], rows[ROLLER.outer_load, j], film[FILM.force, j], film[FILM.force, rows.shape[1] + j]
        n_r, n_t, slope = rows[ROLLER.normal_r, j], rows[ROLLER.normal_t, j], rows[ROLLER.slope, j] * params.raceways.slope_factor
        radial, along = q_i * n_r - t_i * n_t, q_i * n_t + t_i * n_r
        drag = churning + churning_slope * (radius * phi_speed - pitch_speed)
        f_r = radial - q_e - force * (play_s + friction * play_c)
        f_t = along + t_e + q_e * slope / radius - drag - force * (play_c - friction * play_s)
        phi_acceleration = (f_t / mass - 2.0 * radius_speed * phi_speed) / radius
        rate[first + R], rate[first + PHI] = radius_speed, phi_speed
        rate[first + R_SPEED] = radius * phi_speed * phi_speed + f_r / mass
        rate[first + PHI_SPEED] = phi_acceleration
        rate[first + SPIN] = roller_radius * (t_i - t_e - friction * size) / spin_inertia
        rate[BORDER + RING_Y] -= (radial * c - along * s) / params.ring.mass
        rate[BORDER + RING_Z] -= (radial * s + along * c) / params.ring.mass
        rate[BORDER + CAGE_Y] += force * (friction * pocket_c - pocket_s) / cage.mass
        rate[BORDER + CAGE_Z] += force * (pocket_c + friction * pocket_s) / cage.mass
        rate[OMEGA] += (force * lever - friction * (size * roller_radius + offset * force)) / cage.inertia
        if not with_jacobian:
            continue
        _raceway_gradients(first, j, y, params, work)
        for x in range(LOCAL):
            g[_OFFSET, x], g[_RATE, x] = 0.0, 0.0
        g[_OFFSET, R], g[_OFFSET, PHI], g[_OFFSET, AT_POSITIONS + THETA] = play_s, radius * play_c, -lever
        g[_OFFSET, AT_POSITIONS + CAGE_Y], g[_OFFSET, AT_POSITIONS + CAGE_Z] = pocket_s, -pocket_c
        turning = phi_speed - omega
        g[_RATE, R], g[_RATE, R_SPEED], g[_RATE, PHI_SPEED] = play_c * turning, play_s, radius * play_c
        g[_RATE, PHI] = radius_speed * play_c - radius * play_s * turning
        g[_RATE, AT_POSITIONS + THETA] = -g[_RATE, PHI] + speed_r + omega * cage_t
        g[_RATE, AT_SPEEDS + THETA], g[_RATE, AT_SPEEDS + CAGE_Y], g[_RATE, AT_SPEEDS + CAGE_Z] = -lever, pocket_s, -pocket_c
        g[_RATE, AT_POSITIONS + CAGE_Y], g[_RATE, AT_POSITIONS + CAGE_Z] = omega * pocket_c, omega * pocket_s
        sign = 1.0 if force >= 0.0 else -1.0
        own, passed = work.roller_rows, work.border_rows
        push_r, push_t = play_s + friction * play_c, play_c - friction * play_s
        push_y, push_z = friction * pocket_c - pocket_s, pocket_c + friction * pocket_s
        arm = lever - friction * (sign * roller_radius + offset)
        for x in range(LOCAL):
            f_x = by_offset * g[_OFFSET, x] + by_rate * g[_RATE, x]
            g[_FORCE, x] = f_x
            own[j, 0, x] = (g[_RADIAL, x] - g[_Q_E, x] - f_x * push_r) / mass
            own[j, 1, x] = (g[_ALONG, x] + g[_T_E, x] + g[_Q_E, x] * slope / radius - f_x * push_t) / (mass * radius)
            own[j, 2, x] = roller_radius * (g[_T_I, x] - g[_T_E, x] - friction * sign * f_x) / spin_inertia
            passed[j, RING_Y, x] = -(g[_RADIAL, x] * c - g[_ALONG, x] * s) / params.ring.mass
            passed[j, RING_Z, x] = -(g[_RADIAL, x] * s + g[_ALONG, x] * c) / params.ring.mass
            passed[j, CAGE_Y, x] = f_x * push_y / cage.mass
            passed[j, CAGE_Z, x] = f_x * push_z / cage.mass
            passed[j, THETA, x] = (f_x * arm - force * friction * g[_OFFSET, x]) / cage.inertia
        bend = force * (play_c - friction * play_s)
        own[j, 0, PHI] -= bend / mass
        own[j, 0, AT_POSITIONS + THETA] += bend / mass
        own[j, 0, R] += phi_speed * phi_speed
        own[j, 0, PHI_SPEED] += 2.0 * radius * phi_speed
        bend = force * (play_s + friction * play_c)
        curve = q_e * rows[ROLLER.curvature, j] * params.raceways.slope_factor / radius
        own[j, 1, PHI] += (bend + curve) / (mass * radius)
        own[j, 1, AT_POSITIONS + THETA] -= bend / (mass * radius)
        own[j, 1, R] -= (q_e * slope / (radius * radius) + churning_slope * phi_speed) / (mass * radius) + phi_acceleration / radius
        own[j, 1, R_SPEED] -= 2.0 * phi_speed / radius
        own[j, 1, PHI_SPEED] -= 2.0 * radius_speed / radius + churning_slope / mass
        own[j, 1, AT_SPEEDS + THETA] -= churning_bend * (radius * phi_speed - pitch_speed) / (mass * radius)
        spin_slope = cage.pocket_friction * FRICTION_SPIN * FRICTION_SPIN / (smooth * smooth * smooth)
        own[j, 0, SPIN] -= force * play_c * spin_slope / mass
        own[j, 1, SPIN] += force * play_s * spin_slope / (mass * radius)
        own[j, 2, SPIN] -= roller_radius * size * spin_slope / spin_inertia
        passed[j, RING_Y, PHI] += (radial * s + along * c) / params.ring.mass
        passed[j, RING_Z, PHI] -= (radial * c - along * s) / params.ring.mass
        passed[j, CAGE_Y, SPIN] = force * pocket_c * spin_slope / cage.mass
        passed[j, CAGE_Z, SPIN] = force * pocket_s * spin_slope / cage.mass
        passed[j, THETA, SPIN] -= (size * roller_radius + offset * force) * spin_slope / cage.inertia
        passed[j, CAGE_Y, AT_POSITIONS + THETA] -= force * (pocket_c + friction * pocket_s) / cage.mass
        passed[j, CAGE_Z, AT_POSITIONS + THETA] += force * (friction * pocket_c - pocket_s) / cage.mass
        passed[j, THETA, R] += force * play_c / cage.inertia
        passed[j, THETA, PHI] -= force * radius * play_s / cage.inertia
        passed[j, THETA, AT_POSITIONS + THETA] += force * (radius * play_s - cage_t) / cage.inertia
        passed[j, THETA, AT_POSITIONS + CAGE_Y] -= force * pocket_c / cage.inertia
        passed[j, THETA, AT_POSITIONS + CAGE_Z] -= force * pocket_s / cage.inertia
    return True
