# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What each roller feels and passes on, in the plane; ``LANES`` rollers at a time (a block).

Deng 2017, eq. 14 to 16, with the exact directions about the displaced inner ring.
"""

import math

from bearing_sim.kernels.cage import FRICTION_SPIN
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.contact import damped_line_contact, log_penetration
from bearing_sim.kernels.drag import churning_force
from bearing_sim.kernels.elementary import cosine_sine
from bearing_sim.kernels.film import pump
from bearing_sim.kernels.lanes import floor, larger, load, magnitude, spread, square_root, store, total, where_positive
from bearing_sim.kernels.raceway import contour_lanes
from bearing_sim.kernels.traction import CONTACT, traction
from bearing_sim.levels.growth import inner_growth
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.planar_algebra import BORDER
from bearing_sim.levels.planar_border import border_accelerations
from bearing_sim.levels.planar_guide import guide_accelerations, guide_forces, guide_slopes
from bearing_sim.levels.planar_slopes import pumping_slopes, roller_slopes
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, RING_Y, RING_Z, ROLLER, THETA, collect_rates, spread_state


@kernel
def _place(y, shaft_speed, inner_radius, params, rows, contacts):
    """Write directions about the displaced ring, penetrations, rolling and sliding speeds of all rollers."""
    raceways, roller_radius = params.raceways, params.rollers.radius
    ring_y, ring_z, ring_y_speed, ring_z_speed = y[RING_Y], y[RING_Z], y[BORDER + RING_Y], y[BORDER + RING_Z]
    blocks = rows.shape[0]
    for block in range(blocks):
        turn = load(rows, block, ROLLER.angle) * (0.5 / math.pi)
        turn -= floor(turn)
        cosine, sine = cosine_sine(turn)
        contour, slope, curvature = contour_lanes(raceways.contour, turn)
        store(rows, block, ROLLER.cosine, cosine)
        store(rows, block, ROLLER.sine, sine)
        store(rows, block, ROLLER.slope, slope)
        store(rows, block, ROLLER.curvature, curvature)
        store(contacts, blocks + block, CONTACT.penetration, load(rows, block, ROLLER.radius) + roller_radius - contour)
    for block in range(blocks):
        cosine, sine, radius = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine), load(rows, block, ROLLER.radius)
        orbital_speed, radial_speed = load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.radial_speed)
        apart_r, apart_t = radius - (ring_y * cosine + ring_z * sine), ring_y * sine - ring_z * cosine
        distance = square_root(apart_r * apart_r + apart_t * apart_t)
        inverse = 1.0 / distance
        n_r, n_t = apart_r * inverse, apart_t * inverse
        speed_r = radial_speed - (ring_y_speed * cosine + ring_z_speed * sine)
        speed_t = radius * orbital_speed - (ring_z_speed * cosine - ring_y_speed * sine)
        speed_normal, speed_tangent = n_r * speed_r + n_t * speed_t, n_r * speed_t - n_t * speed_r
        surface = load(rows, block, ROLLER.spin) * roller_radius
        rolling = surface + orbital_speed * roller_radius
        store(rows, block, ROLLER.normal_r, n_r)
        store(rows, block, ROLLER.normal_t, n_t)
        store(rows, block, ROLLER.inverse_distance, inverse)
        store(rows, block, ROLLER.speed_normal, speed_normal)
        store(rows, block, ROLLER.speed_tangent, speed_tangent)
        store(contacts, block, CONTACT.penetration, inner_radius + roller_radius - distance)
        store(contacts, block, CONTACT.rate, -speed_normal)
        store(contacts, block, CONTACT.rolling, 0.5 * ((shaft_speed - orbital_speed) * inner_radius + rolling))
        store(contacts, block, CONTACT.sliding, shaft_speed * inner_radius - speed_tangent - surface)
        outer = blocks + block
        store(contacts, outer, CONTACT.rate, radial_speed - load(rows, block, ROLLER.slope) * orbital_speed)
        store(contacts, outer, CONTACT.rolling, 0.5 * (orbital_speed * (radius + roller_radius) + rolling))
        store(contacts, outer, CONTACT.sliding, surface - radius * orbital_speed)


@kernel
def normal_forces(params, contacts):
    """Write the normal forces of all contacts and their slopes."""
    stiffness, damping = params.raceways.stiffness, params.ring.contact_damping
    for block in range(contacts.shape[0]):
        store(contacts, block, CONTACT.log_penetration, log_penetration(load(contacts, block, CONTACT.penetration)))
    for block in range(contacts.shape[0]):
        penetration, rate = load(contacts, block, CONTACT.penetration), load(contacts, block, CONTACT.rate)
        log = load(contacts, block, CONTACT.log_penetration)
        force, by_penetration, by_rate = damped_line_contact(penetration, log, rate, stiffness, damping)
        store(contacts, block, CONTACT.load, force)
        store(contacts, block, CONTACT.stiffness, by_penetration)
        store(contacts, block, CONTACT.damping, by_rate)


@kernel
def _pocket_forces(y, cage_cosine, cage_sine, params, rows):
    """Write how a block of rollers lies in its pockets, and what the pockets do to it.

    The film's spring until the clearance is used up, then line contact on top of it (Deng 2017, eq. 10, made continuous).
    """
    for block in range(rows.shape[0]):
        cage = params.cage
        pitch_cosine, pitch_sine = load(rows, block, ROLLER.pitch_cosine), load(rows, block, ROLLER.pitch_sine)
        pocket_cosine, pocket_sine = cage_cosine * pitch_cosine - cage_sine * pitch_sine, cage_sine * pitch_cosine + cage_cosine * pitch_sine
        cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        play_cosine, play_sine = cosine * pocket_cosine + sine * pocket_sine, sine * pocket_cosine - cosine * pocket_sine
        radius, orbital_speed, spin = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.spin)
        omega = y[OMEGA]
        cage_r, cage_t = y[CAGE_Y] * pocket_cosine + y[CAGE_Z] * pocket_sine, y[CAGE_Z] * pocket_cosine - y[CAGE_Y] * pocket_sine
        speed_t = y[BORDER + CAGE_Z] * pocket_cosine - y[BORDER + CAGE_Y] * pocket_sine
        offset = radius * play_sine - cage_t
        rate = load(rows, block, ROLLER.radial_speed) * play_sine + radius * play_cosine * (orbital_speed - omega) - speed_t + omega * cage_r
        stiffness, damping = spread(cage.pocket_stiffness), spread(cage.pocket_damping)
        force = stiffness * offset + damping * rate
        excess = magnitude(offset) - cage.pocket_clearance
        if total(where_positive(excess, 1.0, 0.0)) > 0.0:
            side = where_positive(offset, 1.0, -1.0)
            wall, wall_stiffness, wall_damping = damped_line_contact(
                excess, log_penetration(excess), rate * side, params.raceways.stiffness, params.ring.contact_damping
            )
            force += side * (wall - cage.pocket_stiffness * larger(excess, 0.0))
            stiffness = where_positive(excess, wall_stiffness, stiffness)
            damping += wall_damping
        smooth = 1.0 / square_root(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
        store(rows, block, ROLLER.pocket_cosine, pocket_cosine)
        store(rows, block, ROLLER.pocket_sine, pocket_sine)
        store(rows, block, ROLLER.play_cosine, play_cosine)
        store(rows, block, ROLLER.play_sine, play_sine)
        store(rows, block, ROLLER.pocket_offset, offset)
        store(rows, block, ROLLER.pocket_rate, rate)
        store(rows, block, ROLLER.pocket_force, -force)
        store(rows, block, ROLLER.pocket_stiffness, stiffness)
        store(rows, block, ROLLER.pocket_damping, damping)
        store(rows, block, ROLLER.pocket_friction, cage.pocket_friction * spin * smooth)
        store(rows, block, ROLLER.pocket_friction_slope, (cage.pocket_friction * FRICTION_SPIN * FRICTION_SPIN) * smooth * smooth * smooth)


@kernel
def _accelerate(y, churning, model, rows, contacts, rate):
    """Write the accelerations of a block of rollers; add to those of ring and cage what the rollers do to them."""
    for block in range(rows.shape[0]):
        params = model.params
        cage, ring, mass, roller_radius = params.cage, params.ring, params.rollers.mass, params.rollers.radius
        radius, radial_speed, orbital_speed = (
            load(rows, block, ROLLER.radius),
            load(rows, block, ROLLER.radial_speed),
            load(rows, block, ROLLER.orbital_speed),
        )
        outer = rows.shape[0] + block
        n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
        q_i, q_e = load(contacts, block, CONTACT.load), load(contacts, outer, CONTACT.load)
        t_i, t_e = load(contacts, block, CONTACT.force), load(contacts, outer, CONTACT.force)
        force, friction = -load(rows, block, ROLLER.pocket_force), load(rows, block, ROLLER.pocket_friction)
        play_cosine, play_sine = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        # Of the oil pumped back a roller feels what both surfaces and its centre feel: F_R (1 -/+ 2 gamma) along, F_R against its spin.
        pumped_i, pumped_e = load(contacts, block, CONTACT.pumping), load(contacts, outer, CONTACT.pumping)
        push_i = t_i + pumped_i * (1.0 - 2.0 * params.raceways.diameter_ratio)
        radial, along = q_i * n_r - push_i * n_t, q_i * n_t + push_i * n_r
        pitch_speed = params.raceways.pitch_radius * y[OMEGA]
        drag = churning[0] + churning[1] * (radius * orbital_speed - pitch_speed)
        drag = where_positive(drag * orbital_speed, drag, 0.0)  # a line through it would push a roller far slower than the cage
        slope = params.raceways.slope_factor * load(rows, block, ROLLER.slope)
        f_r = radial - q_e - force * (play_sine + friction * play_cosine)
        f_t = (
            along
            + t_e
            - pumped_e * (1.0 + 2.0 * params.raceways.diameter_ratio)
            + q_e * slope / radius
            - drag
            - force * (play_cosine - friction * play_sine)
        )
        store(rows, block, ROLLER.churning, drag)
        store(rows, block, ROLLER.radial_acceleration, radius * orbital_speed * orbital_speed + f_r * (1.0 / mass))
        store(rows, block, ROLLER.orbital_acceleration, (f_t * (1.0 / mass) - 2.0 * radial_speed * orbital_speed) / radius)
        spin_acceleration = (t_i - t_e - pumped_i - pumped_e - friction * magnitude(force)) * (roller_radius / params.rollers.inertia)
        store(rows, block, ROLLER.spin_acceleration, spin_acceleration)
        present, cosine, sine = load(rows, block, ROLLER.present), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        pocket_cosine, pocket_sine = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        lever = radius * play_cosine - (y[CAGE_Y] * pocket_cosine + y[CAGE_Z] * pocket_sine)
        offset = load(rows, block, ROLLER.pocket_offset)
        torque = force * lever - friction * (magnitude(force) * roller_radius + offset * force)
        rate[BORDER + RING_Y] -= total(present * (radial * cosine - along * sine)) / ring.mass
        rate[BORDER + RING_Z] -= total(present * (radial * sine + along * cosine)) / ring.mass
        rate[BORDER + CAGE_Y] += total(present * force * (friction * pocket_cosine - pocket_sine)) / cage.mass
        rate[BORDER + CAGE_Z] += total(present * force * (pocket_cosine + friction * pocket_sine)) / cage.mass
        rate[OMEGA] += total(present * torque) / cage.inertia


@kernel
def _churning(y, model):
    """Drag of the mixture on a roller that orbits with the cage [N], its slope by the roller's speed, and the slope's by cage speed.

    Rollers' speeds differ little from the cage's: the drag is taken linear in the difference.
    """
    rollers, lubrication, pitch_radius = model.params.rollers, model.lubrication, model.params.raceways.pitch_radius
    speed = pitch_radius * y[OMEGA]
    force, slope = churning_force(speed, lubrication.mixture_density, lubrication.viscosity, 2.0 * rollers.radius, rollers.length)
    bend = slope * (slope / force - 1.0 / speed) * pitch_radius if force != 0.0 else 0.0  # of the local power of the speed
    return force, slope, bend


@kernel
def equations(t, y, model, work, rate, with_jacobian):
    """Write dy/dt into ``rate`` and, where asked, all derivatives into ``work``.

    Roller (Deng 2017, eq. 14): m (r'' - r phi'^2) and m (r phi'' + 2 r' phi') are the sums of both normal forces along their
    true directions, both tractions, the pocket's force and its friction, and the drag of the mixture; J w' = R_w (T_i - T_e)
    less pocket friction.  Whatever a roller feels from ring and cage acts back on them, so that momentum is kept.
    """
    params, rows, contacts = model.params, work.rollers, work.contacts
    shaft_speed, churning = shaft_speed_at(t, model.drive), _churning(y, model)
    spread_state(y, params.rollers.count, rows)
    border_accelerations(t, y, model, work, rate, with_jacobian)
    for k in range(BORDER):
        rate[k] = y[BORDER + k]
    cage_cosine, cage_sine = math.cos(y[THETA]), math.sin(y[THETA])
    inner_radius = params.raceways.inner_radius + inner_growth(shaft_speed, model)
    _place(y, shaft_speed, inner_radius, params, rows, contacts)
    normal_forces(params, contacts)
    traction(contacts, model.lubrication.inner, model.lubrication.outer)
    if model.lubrication.pumping.on:
        pump(contacts, model.lubrication.pumping)
    _pocket_forces(y, cage_cosine, cage_sine, params, rows)
    _accelerate(y, churning, model, rows, contacts, rate)
    pockets_guide = not params.cage.guidance.lands
    if pockets_guide:
        guide_forces(y, params, rows)
        guide_accelerations(params, rows, rate)
    if with_jacobian:
        roller_slopes(y, inner_radius, churning, params, rows, contacts, work.slopes)
        if model.lubrication.pumping.on:
            pumping_slopes(y, inner_radius, params, rows, contacts, work.slopes)
        if pockets_guide:
            guide_slopes(y, params, rows, work.slopes)
    collect_rates(y, params.rollers.count, rows, rate)
    return True
