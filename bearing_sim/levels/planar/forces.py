# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Equations of level ``planar``: forces on every roller, the cage and the inner ring; ``LANES`` rollers at a time (a block).

Deng 2017, eq. 14 to 16, with the exact directions about the displaced inner ring.  With n and p the normal and the tangent of the inner
contact, psi the angle from the pocket to the roller, f the force on the pocket's wall, mu its friction coefficient with the sign of the spin,
and the frame (r, t) of the roller,

    m_r (r'' - r phi'^2)       = (Q_i n + T_i' p)_r - Q_e - f (sin psi + mu cos psi),
    m_r (r phi'' + 2 r' phi')  = (Q_i n + T_i' p)_t + T_e' + Q_e R_e'/r - F_d - f (cos psi - mu sin psi),
    J_r w'                     = R_w (T_i - T_e - F_Ri - F_Re - mu |f|) + M_f,

F_d the drag of mixture and bath, F_R the resistance to rolling, of which the roller's centre receives T_i' = T_i + (1 - 2 gamma) F_Ri and
T_e' = T_e - (1 + 2 gamma) F_Re.  Where rings have flanges, these add forces to T_i' and T_e' and the torque M_f
(`bearing_sim.levels.common.flanges`).  The term Q_e R_e'/r is the lean of the outer normal (``contour_slope``).  Whatever a roller
receives from ring and cage acts back on them, so that momentum is conserved.

**Pockets that guide the cage.** Pockets with walls along the orbit alone do not hold a cage: rollers shift along the orbit with the pockets
of a cage that turns off its centre, nothing pulls it back, and its own centrifugal force carries it away.  A cage guided by its rollers
therefore has pockets that close around them.  Here a guiding pocket stops a roller outwards and inwards as every pocket does along the
orbit: by line contact where the clearance is used up, with the same film damping and the same friction; wall against wall, without the
corner between.  Within the clearance there is no spring: the one along the orbit (Deng 2017, eq. 10) stands for the oil between a roller and
the wall that it drives or that drives it, whereas outwards every lobe moves every roller, and metal meets metal only where the play ends (P.
K. Gupta, J. Lubr. Technol. 101 (1979)).  *Assumption*: the play is that along the orbit, as in a cylindrical pocket, unless the scene says
otherwise; its middle is where a roller on the outer raceway is in the mean.  A force f outwards on the wall is accompanied by mu f along the
orbit: what the other walls do, turned by a right angle.
"""

import math

from bearing_sim.levels.common.bending import give_way, place_at_ring, soften_contacts
from bearing_sim.levels.common.flanges import FLANGE, rub_on_flanges, total_load
from bearing_sim.levels.common.model import films_at, inner_growth, load_at, shaft_speed_at
from bearing_sim.levels.common.rollers import carry_normal_forces, drag, linear_churning, place_in_pockets, place_outwards, place_rollers
from bearing_sim.levels.common.support import carry, follow_frame, frame_of
from bearing_sim.levels.planar.jacobian import land_contact_jacobian, react_on_ring, roller_jacobian
from bearing_sim.levels.planar.state import (
    BORDER,
    CAGE_Y,
    CAGE_Z,
    LAYOUT,
    OMEGA,
    RING_Y,
    RING_Z,
    ROLLER,
    RUNS,
    THETA,
)
from bearing_sim.numerics.block_arrow import collect_rates, spread_state
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import cosine_sine
from bearing_sim.numerics.simd import add, load, magnitude, spread, store, total, where_positive
from bearing_sim.physics.contact import CONTACT, damped_line_contact
from bearing_sim.physics.drag import mixture_torque
from bearing_sim.physics.flange import axial_share
from bearing_sim.physics.land import Land, land_contact, land_film, land_friction
from bearing_sim.physics.pocket import pocket_friction_lanes, wall_force
from bearing_sim.physics.profile import damped_profile_contact
from bearing_sim.physics.ring_balance import deflect_elastic_ring, follow_rollers, press_outwards, typical_stiffness


@fused
def place_in_lands(y, shaft_speed, cage):
    """Return `Land` of a state.

    Parameters
    ----------
    y : state of level ``planar``, its border at least.
    shaft_speed : [rad/s].
    cage : `bearing_sim.model.params.CageBody`.
    """
    turning = cage.guidance.turning
    return Land(
        y[CAGE_Y] - turning * y[RING_Y],
        y[CAGE_Z] - turning * y[RING_Z],
        y[BORDER + CAGE_Y] - turning * y[BORDER + RING_Y],
        y[BORDER + CAGE_Z] - turning * y[BORDER + RING_Z],
        y[OMEGA],
        turning * shaft_speed,
    )


@fused
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, drive, own = model.params, model.drive, work.global_block
    cage, shaft_speed = params.cage, shaft_speed_at(t, drive)
    load_y, load_z = load_at(t, drive)
    rate[BORDER + RING_Y], rate[BORDER + RING_Z] = load_y / params.ring.mass, load_z / params.ring.mass
    drag, d_drag = mixture_torque(y[OMEGA], shaft_speed, params, model.lubrication)
    if cage.guidance.lands:
        _lands(place_in_lands(y, shaft_speed, cage), model, own, rate, with_jacobian)
    else:
        rate[BORDER + CAGE_Y], rate[BORDER + CAGE_Z], rate[OMEGA], own[THETA, OMEGA] = 0.0, 0.0, 0.0, 0.0
    rate[OMEGA] += drag / cage.inertia
    if with_jacobian:
        own[THETA, OMEGA] += d_drag / cage.inertia


@fused
def _lands(land, model, own, rate, with_jacobian):
    """Write what the lands do to the cage, and to the ring if they are the inner ring's."""
    params = model.params
    cage = params.cage
    film = land_film(land, params.variants.land_squeeze, cage, model.lubrication)
    contact, d_depth, d_rate, eccentricity, approach = land_contact(land, params)
    n_y, n_z = 0.0, 0.0
    friction, d_sliding = land_friction((land.cage_speed - land.ring_speed) * cage.guide_radius, cage.land_friction)
    if contact > 0.0:
        n_y, n_z = land.y / eccentricity, land.z / eccentricity
    # the inner ring touches the cage on the side that the cage has left, and there friction points the other way
    side = 1.0 - 2.0 * cage.guidance.turning
    across = side * friction
    d_y, d_z = -n_y + across * n_z, -n_z - across * n_y  # direction of the land's force on the cage
    rate[BORDER + CAGE_Y] = (film[0] + contact * d_y) / cage.mass
    rate[BORDER + CAGE_Z] = (film[1] + contact * d_z) / cage.mass
    rate[OMEGA] = (film[2] - friction * contact * cage.guide_radius) / cage.inertia
    if with_jacobian:
        for row in range(3):
            inertia = cage.mass if row < 2 else cage.inertia
            own[CAGE_Y + row, CAGE_Y], own[CAGE_Y + row, CAGE_Z] = film[3 + 5 * row] / inertia, film[4 + 5 * row] / inertia
            own[CAGE_Y + row, BORDER + CAGE_Y], own[CAGE_Y + row, BORDER + CAGE_Z] = film[5 + 5 * row] / inertia, film[6 + 5 * row] / inertia
            own[CAGE_Y + row, OMEGA] = film[7 + 5 * row] / inertia
        if contact > 0.0:
            d_friction = cage.guide_radius * d_sliding
            along_y, along_z = land.y_speed - approach * n_y, land.z_speed - approach * n_z
            land_contact_jacobian(contact, d_depth, d_rate, n_y, n_z, along_y, along_z, 1.0 / eccentricity, friction, d_friction, side, cage, own)
    if cage.guidance.turning > 0.0:
        react_on_ring(params, own, rate, with_jacobian)


@fused
def normal_forces(params, contacts):
    """Write the normal forces of all contacts and their derivatives."""
    if params.raceways.profile.crowned:
        _press_blocks(True, params.raceways, contacts)
    else:
        _press_blocks(False, params.raceways, contacts)


@kernel
def _press_blocks(crowned, raceways, contacts):
    """Write normal forces, see `normal_forces`; ``crowned`` is a constant to the compiler."""
    stiffness, damping = raceways.stiffness, raceways.damping
    for block in range(contacts.shape[0]):
        penetration, rate = load(contacts, block, CONTACT.penetration), load(contacts, block, CONTACT.rate)
        if crowned:
            force, d_penetration, d_rate = damped_profile_contact(penetration, rate, stiffness, damping, raceways.profile)
        else:
            force, d_penetration, d_rate = damped_line_contact(penetration, rate, stiffness, damping)
        store(contacts, block, CONTACT.load, force)
        store(contacts, block, CONTACT.stiffness, d_penetration)
        store(contacts, block, CONTACT.damping, d_rate)


@kernel
def _ring(y):
    """Return position and velocity of the inner ring, as `bearing_sim.levels.common.rollers` takes them."""
    return y[RING_Y], y[RING_Z], y[BORDER + RING_Y], y[BORDER + RING_Z]


@fused
def carry_forces(y, count, work):
    """Carry penetrations and normal forces along the last correction to ``y``, see `carry_normal_forces`."""
    carry_normal_forces(ROLLER, CONTACT, RUNS, y, _ring(y), work.evaluated_ring, count, work.rollers, work.contacts)


@kernel
def _cage(y):
    """Return position and velocity of the cage's centre and the cage's speed, as `bearing_sim.levels.common.rollers` takes them."""
    return y[CAGE_Y], y[CAGE_Z], y[BORDER + CAGE_Y], y[BORDER + CAGE_Z], y[OMEGA]


@fused
def _pocket_forces(y, coefficient, params, rows):
    """Write how all rollers lie in their pockets along the orbit, and what the pockets do to them; ``coefficient`` is that of friction."""
    cage, turn = params.cage, y[THETA] * (0.5 / math.pi)
    cage_cosine, cage_sine = cosine_sine(spread(turn - math.floor(turn)))
    for block in range(rows.shape[0]):
        offset, rate = place_in_pockets(ROLLER, block, _cage(y), cage_cosine, cage_sine, rows)
        force, d_offset, d_rate = wall_force(
            offset, rate, cage.pocket_clearance, cage.pocket_stiffness, cage.pocket_damping, params.raceways.stiffness, params.raceways.damping
        )
        friction, d_spin = pocket_friction_lanes(load(rows, block, ROLLER.spin), coefficient)
        store(rows, block, ROLLER.pocket_force, -force)
        store(rows, block, ROLLER.pocket_stiffness, d_offset)
        store(rows, block, ROLLER.pocket_damping, d_rate)
        store(rows, block, ROLLER.pocket_friction, friction)
        store(rows, block, ROLLER.pocket_friction_d_spin, d_spin)


@fused
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
        # Resistance to rolling acts on both surfaces and on the roller's centre: F_R (1 -/+ 2 gamma) along the orbit, F_R against its spin.
        resistance_i, resistance_e = load(contacts, block, CONTACT.resistance), load(contacts, outer, CONTACT.resistance)
        push_i = t_i + resistance_i * (1.0 - 2.0 * params.raceways.diameter_ratio)
        radial, along = q_i * n_r - push_i * n_t, q_i * n_t + push_i * n_r
        pitch_speed = params.raceways.pitch_radius * y[OMEGA]
        drag = churning[0] + churning[1] * (radius * orbital_speed - pitch_speed)
        drag = where_positive(drag * orbital_speed, drag, 0.0)  # extrapolated, it would push a roller that is far slower than the cage
        slope = params.variants.contour_slope * load(rows, block, ROLLER.slope)
        f_r = radial - q_e - force * (play_sine + friction * play_cosine)
        f_t = (
            along
            + t_e
            - resistance_e * (1.0 + 2.0 * params.raceways.diameter_ratio)
            + q_e * slope / radius
            - drag
            - force * (play_cosine - friction * play_sine)
        )
        store(rows, block, ROLLER.churning, drag)
        store(rows, block, ROLLER.radial_acceleration, radius * orbital_speed * orbital_speed + f_r * (1.0 / mass))
        store(rows, block, ROLLER.orbital_acceleration, (f_t * (1.0 / mass) - 2.0 * radial_speed * orbital_speed) / radius)
        spin_acceleration = (t_i - t_e - resistance_i - resistance_e - friction * magnitude(force)) * (roller_radius / params.rollers.inertia)
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
def _bend(y, outer_ring, model, work):
    """Let the outer ring give way to the rollers; return whether that was found.  ``outer_ring`` is that of the bearing, None where it is rigid."""
    if outer_ring is None:
        return True
    loads, bending, stiffness, profile = work.ring_loads, work.bending, model.params.raceways.stiffness, model.params.raceways.profile
    place_at_ring(ROLLER, CONTACT, y[THETA], y[OMEGA], profile.highest, work.rollers, work.contacts, loads, work.ring_rates, bending)
    law, typical, pressure = (stiffness, profile), typical_stiffness(stiffness, profile), model.lubrication.growth.housing_pressure
    if not deflect_elastic_ring(y[THETA], pressure, press_outwards, law, typical, outer_ring, loads, bending):
        return False
    follow_rollers(loads, work.ring_rates, bending)
    give_way(ROLLER, CONTACT, profile.highest, work.rollers, work.contacts, loads, work.ring_rates, bending)
    work.bent_at[0] = y[THETA]
    return True


@fused
def equations(t, y, model, work, rate, with_jacobian):
    """Write dy/dt into ``rate`` and, where asked, all derivatives into ``work``.

    See the docstring of the module.
    """
    params, rows, contacts = model.params, work.rollers, work.contacts
    shaft_speed = shaft_speed_at(t, model.drive)
    films, churning = films_at(t, shaft_speed, model), linear_churning(y[OMEGA], shaft_speed, model)
    spread_state(LAYOUT, y, params.rollers.count, rows)
    border_accelerations(t, y, model, work, rate, with_jacobian)
    for k in range(BORDER):
        rate[k] = y[BORDER + k]
    inner_radius = params.raceways.inner_radius + inner_growth(shaft_speed, model)
    ring = _ring(y)
    place_rollers(ROLLER, CONTACT, ring, shaft_speed, inner_radius, params, rows, contacts)
    for k in range(4):
        work.evaluated_ring[k] = ring[k]
    if not _bend(y, params.outer_ring, model, work):
        return False
    normal_forces(params, contacts)
    drag(params.raceways, model.lubrication, films, contacts)
    _pocket_forces(y, films.pocket_friction, params, rows)
    _accelerate(y, churning, model, rows, contacts, rate)
    if not params.cage.guidance.lands:
        guide_forces(y, params, rows)
        guide_accelerations(params, rows, rate)
    if params.flanges.on:
        flange_accelerations(shaft_speed, films.flange_friction, model, rows, contacts, rate)
    soften_contacts(CONTACT, rows.shape[0], contacts, work.bending)
    if with_jacobian:
        roller_jacobian(y, inner_radius, churning, model.lubrication.rolling_resistance.on, params, rows, contacts, work.jacobian)
    if work.support.shape[0] > 0:
        carry(LAYOUT, RUNS, ROLLER, t, y, model, work, rate, with_jacobian)
        for block in range(rows.shape[0]):
            follow_frame(ROLLER, block, frame_of(work.support), rows)
    collect_rates(LAYOUT, y, params.rollers.count, rows, rate)
    return True


@kernel
def guide_forces(y, params, rows):
    """Write how far rollers stand outwards in their pockets, and the force of that; `_pocket_forces` has been called.

    Parameters
    ----------
    y : state.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.planar.state.ROLLER`.
    """
    cage = params.cage
    for block in range(rows.shape[0]):
        offset, rate = place_outwards(ROLLER, block, _cage(y), cage.guidance, rows)
        force, d_offset, d_rate = wall_force(
            offset, rate, cage.guide_clearance, 0.0, cage.pocket_damping, params.raceways.stiffness, params.raceways.damping
        )
        store(rows, block, ROLLER.guide_force, -force)
        store(rows, block, ROLLER.guide_stiffness, d_offset)
        store(rows, block, ROLLER.guide_damping, d_rate)


@kernel
def guide_accelerations(params, rows, rate):
    """Add what guiding pockets do to the accelerations of rollers and cage; parameters as of `guide_forces`, ``rate`` as of a level."""
    cage, roller_radius = params.cage, params.rollers.radius
    per_mass, per_inertia = 1.0 / params.rollers.mass, roller_radius / params.rollers.inertia
    for block in range(rows.shape[0]):
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        force, friction, present = (
            -load(rows, block, ROLLER.guide_force),
            load(rows, block, ROLLER.pocket_friction),
            load(rows, block, ROLLER.present),
        )
        braking, lever = friction * magnitude(force), load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius
        add(rows, block, ROLLER.radial_acceleration, -(per_mass * force * (c - friction * s)))
        add(rows, block, ROLLER.orbital_acceleration, per_mass * force * (s + friction * c) / load(rows, block, ROLLER.radius))
        add(rows, block, ROLLER.spin_acceleration, -(per_inertia * braking))
        rate[BORDER + CAGE_Y] += total(present * force * (p_c + friction * p_s)) / cage.mass
        rate[BORDER + CAGE_Z] += total(present * force * (p_s - friction * p_c)) / cage.mass
        torque = force * (load(rows, block, ROLLER.pocket_offset) + friction * lever) + braking * roller_radius
        rate[OMEGA] -= total(present * torque) / cage.inertia


@kernel
def flange_accelerations(shaft_speed, friction, model, rows, contacts, rate):
    """Write what flanges do to the ends of all rollers, and add it to the accelerations of rollers and ring; ``friction`` is a coefficient."""
    params = model.params
    carried = total_load(ROLLER, CONTACT.load, rows, contacts)
    per_mass, per_inertia = 1.0 / params.rollers.mass, 1.0 / params.rollers.inertia
    for block in range(rows.shape[0]):
        pressed = friction * axial_share(load(contacts, block, CONTACT.load), carried, params.rollers.count, params.flanges)
        rub_on_flanges(ROLLER, block, shaft_speed, pressed, params.flanges, model.lubrication.viscosity, rows)
        n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
        inner, outer = load(rows, block, ROLLER.inner_flange + FLANGE.force), load(rows, block, ROLLER.outer_flange + FLANGE.force)
        moment = load(rows, block, ROLLER.inner_flange + FLANGE.moment) + load(rows, block, ROLLER.outer_flange + FLANGE.moment)
        radial, along = -(inner * n_t), inner * n_r
        add(rows, block, ROLLER.radial_acceleration, per_mass * radial)
        add(rows, block, ROLLER.orbital_acceleration, per_mass * (along + outer) / load(rows, block, ROLLER.radius))
        add(rows, block, ROLLER.spin_acceleration, per_inertia * moment)
        present, cosine, sine = load(rows, block, ROLLER.present), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        rate[BORDER + RING_Y] -= total(present * (radial * cosine - along * sine)) / params.ring.mass
        rate[BORDER + RING_Z] -= total(present * (radial * sine + along * cosine)) / params.ring.mass
