# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause at level ``planar`` (see `bearing_sim.levels.common.power`), with the forces of `bearing_sim.levels.planar.forces`.

Conservative, hence no loss: Palmgren's part of every normal force, the spring of the pockets' films, and the
contour's slope, by which an outer load pushes a roller along the orbit.  Without that slope (``contour_slope:
false``, Deng's form) nothing pays for the contour's squeeze, and the balance is off by the sum of Q_e R_e' phi'.

The film of the guide land pushes the cage across its eccentricity, and so feeds the whirl from a rotation that has no torque
for it; ``land_power`` is net of that: what the land takes from the cage in all.  Lands of the inner ring turn with the
shaft, which pays for what they take and for what they give the cage.
"""

import math

from bearing_sim.levels.common.bending import ring_rate
from bearing_sim.levels.common.flanges import flange_powers
from bearing_sim.levels.common.model import inner_growth
from bearing_sim.levels.common.power import Powers, rolling_power, seal_power, shaft_traction_power, sliding_power, windage_powers
from bearing_sim.levels.common.support import support_powers
from bearing_sim.levels.planar.forces import place_in_lands
from bearing_sim.levels.planar.state import BORDER, CAGE_Y, CAGE_Z, OMEGA, ROLLER
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT, elastic_force
from bearing_sim.physics.land import land_contact, land_film, land_friction
from bearing_sim.physics.profile import profile_force


@kernel
def _raceway_damping(cage_speed, params, work):
    """Return the power lost by damping between rollers and raceways, and in an outer ring that moves under it [W]."""
    contacts, stiffness, profile, lost = work.contacts, params.raceways.stiffness, params.raceways.profile, 0.0
    for raceway in range(2):
        for j in range(params.rollers.count):
            block, lane = raceway * work.rollers.shape[0] + j // LANES, j % LANES
            elastic, _ = profile_force(contacts[block, CONTACT.penetration, lane] - profile.highest, stiffness, profile)
            damped = contacts[block, CONTACT.load, lane] - elastic
            rate = contacts[block, CONTACT.rate, lane]
            lost += damped * (rate + ring_rate(work.bending, j, cage_speed) if raceway == 1 else rate)
    return lost


@kernel
def _churning(rows, count):
    """Return the power of the drag of mixture and bath on all rollers [W]."""
    lost = 0.0
    for j in range(count):
        block, lane = j // LANES, j % LANES
        lost += rows[block, ROLLER.churning, lane] * rows[block, ROLLER.radius, lane] * rows[block, ROLLER.orbital_speed, lane]
    return lost


@kernel
def _pockets(y, params, rows):
    """Return the power lost to pocket friction and film damping, and to damping of the walls' contact [W].

    Friction acts where a roller's surface meets the wall, against what that surface slides along the wall: by the roller's spin,
    by its motion in the pocket and by the cage's rotation.
    """
    cage, omega = params.cage, y[OMEGA]
    lost, damped = 0.0, 0.0
    for j in range(params.rollers.count):
        block, lane = j // LANES, j % LANES
        spin, radius = rows[block, ROLLER.spin, lane], rows[block, ROLLER.radius, lane]
        radial_speed, orbital_speed = rows[block, ROLLER.radial_speed, lane], rows[block, ROLLER.orbital_speed, lane]
        speed_r = y[BORDER + CAGE_Y] * rows[block, ROLLER.pocket_cosine, lane] + y[BORDER + CAGE_Z] * rows[block, ROLLER.pocket_sine, lane]
        offset, rate, force = rows[block, ROLLER.pocket_offset, lane], rows[block, ROLLER.pocket_rate, lane], -rows[block, ROLLER.pocket_force, lane]
        side = params.rollers.radius if force >= 0.0 else -params.rollers.radius
        slides = radial_speed * rows[block, ROLLER.play_cosine, lane] - radius * orbital_speed * rows[block, ROLLER.play_sine, lane]
        sliding = slides + spin * side - (speed_r - omega * (offset + side))
        film = cage.pocket_damping * rate
        spring = cage.pocket_stiffness * min(max(offset, -cage.pocket_clearance), cage.pocket_clearance)
        wall = math.copysign(elastic_force(abs(offset) - cage.pocket_clearance, params.raceways.stiffness), offset)
        lost += force * rows[block, ROLLER.pocket_friction, lane] * sliding + film * rate
        damped += (force - film - spring - wall) * rate
    return lost, damped


@kernel
def _guiding_pockets(y, params, rows):
    """Return what pockets that guide the cage lose outwards and inwards, as `_pockets` does along the orbit [W]."""
    cage, omega = params.cage, y[OMEGA]
    lost, damped = 0.0, 0.0
    for j in range(params.rollers.count):
        block, lane = j // LANES, j % LANES
        offset, rate, force = rows[block, ROLLER.guide_offset, lane], rows[block, ROLLER.guide_rate, lane], -rows[block, ROLLER.guide_force, lane]
        side = params.rollers.radius if force >= 0.0 else -params.rollers.radius
        # the wall's own sliding speed is counted against the orbit
        sliding = rows[block, ROLLER.spin, lane] * side + omega * side - rows[block, ROLLER.pocket_rate, lane]
        film = cage.pocket_damping * rate
        wall = math.copysign(elastic_force(abs(offset) - cage.guide_clearance, params.raceways.stiffness), offset)
        lost += force * rows[block, ROLLER.pocket_friction, lane] * sliding + film * rate
        damped += (force - film - wall) * rate
    return lost, damped


@kernel
def land_powers(y, shaft_speed, model):
    """Return powers of the guide lands [W]: in by the shaft where they turn with it, lost by film and friction, taken by damping.

    Force and torque on the cage have their reaction on the ring's surface, so that the ring's torque about its own centre is that on
    the cage and the force's moment across the eccentricity, the other way.
    """
    params = model.params
    cage = params.cage
    land = place_in_lands(y, shaft_speed, cage)
    film = land_film(land, params.variants.land_squeeze, cage, model.lubrication)
    against_ring = film[2] + land.y * film[1] - land.z * film[0]
    driven = against_ring * land.ring_speed
    lost = driven - (film[0] * land.y_speed + film[1] * land.z_speed + film[2] * land.cage_speed)
    contact, _, _, eccentricity, _ = land_contact(land, params)
    depth = eccentricity - (cage.guide_clearance - cage.land_film)
    if depth <= 0.0:
        return driven, lost, 0.0
    n_y, n_z = land.y / eccentricity, land.z / eccentricity
    approach, along = n_y * land.y_speed + n_z * land.z_speed, n_y * land.z_speed - n_z * land.y_speed
    side, surface = 1.0 - 2.0 * cage.guidance.turning, (land.cage_speed - land.ring_speed) * cage.guide_radius
    rubbing = contact * land_friction(surface, cage.land_friction)[0]
    driven -= rubbing * (cage.guide_radius + side * eccentricity) * land.ring_speed
    lost += rubbing * (surface + side * (along - eccentricity * land.ring_speed))
    return driven, lost, (contact - elastic_force(depth, params.raceways.stiffness)) * approach


@kernel
def planar_powers(t, y, shaft_speed, model, work):
    """Return `bearing_sim.levels.common.power.Powers` of a state.

    Parameters
    ----------
    t : time [s].
    y : the state.
    shaft_speed : [rad/s].
    model, work : of the level; the right-hand side at ``y`` has been evaluated into ``work``.
    """
    params, contacts, count = model.params, work.contacts, model.params.rollers.count
    bore, windage = windage_powers(y[OMEGA], shaft_speed, params, model.lubrication)
    pocket, walls = _pockets(y, params, work.rollers)
    driven, land, touching = 0.0, 0.0, 0.0
    if params.cage.guidance.lands:
        driven, land, touching = land_powers(y, shaft_speed, model)
    else:
        guided, touching = _guiding_pockets(y, params, work.rollers)
        pocket += guided
    blocks, seals = work.rollers.shape[0], seal_power(shaft_speed, params)
    driven_unbalance, support = 0.0, 0.0
    if work.support.shape[0] > 0:
        driven_unbalance, support = support_powers(t, y, BORDER, model)
    driven_flanges, rubbing = 0.0, 0.0
    if params.flanges.on:
        driven_flanges, rubbing = flange_powers(ROLLER, shaft_speed, params.flanges, work.rollers)
    inner_radius = params.raceways.inner_radius + inner_growth(shaft_speed, model)
    return Powers(
        shaft_traction_power(contacts, count, shaft_speed, inner_radius) + bore + driven + driven_unbalance + seals + driven_flanges,
        sliding_power(contacts, 0, count),
        sliding_power(contacts, blocks, count),
        rolling_power(contacts, 0, count),
        rolling_power(contacts, blocks, count),
        _churning(work.rollers, count),
        windage,
        land,
        pocket,
        _raceway_damping(y[OMEGA], params, work) + walls + touching,
        seals,
        rubbing,
        support,
    )
