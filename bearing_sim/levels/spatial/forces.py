# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Equations of level ``spatial``: forces and moments on every roller, the cage and the inner ring; ``LANES`` rollers at a time (a block).

Deng 2017, eq. 3 to 16, with gyroscopic moments; the rollers' motion along their axes is left out.  Along a roller stand points (x, centre + x tilt):
each receives forces in its own plane, along the normal at the roller's centre, and the moments on a body are sums of forces times x.  So
power and momentum are conserved to the last term: a normal force on a point that a skewed axis has moved along the orbit has a lever about
the bearing's axis.

**Centre and spin** move as at level ``planar`` (`bearing_sim.levels.planar.forces`).  **The axis** of a roller, inclined by A = (tilt, skew) outwards
and along the orbit, follows I A'' = M + J w (A_t', -A_r') in a frame that does not turn, M the sums of forces times x.

**Flanges** act on straight rollers as at level ``planar``; flanges on both sides stop a roller that skews, and an axial load tilts it by its
lever between both rings' flanges (`press_axially`).

**Guide lands.** Each of the two lands carries half of what both together would carry at its position; the cage's tilt separates them, against
that of the ring if the lands are the inner ring's.  The law of a land is that of level ``planar``.

**Pockets** (Deng 2017, eq. 9 to 12).  A slice of the roller at x stands s + skew x off the middle of its pocket.  Within the clearance the film's
spring is linear, so its sums over slices are known in advance; slices that reach the wall add line contact.  Left out: the roller's crown against
the wall, and that slices on both walls rub on both (friction follows the force of all slices together).  In pockets that guide the cage a slice
stands ``guide_offset + pocket_lean x`` outwards from the middle.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.bending import give_way, place_at_ring
from bearing_sim.levels.common.flanges import FLANGE, rub_on_flanges, stop_skew_on_face, total_load
from bearing_sim.levels.common.model import films_at, inner_growth, shaft_speed_at
from bearing_sim.levels.common.rollers import carry_normal_forces, linear_churning, place_in_pockets, place_outwards, place_rollers
from bearing_sim.levels.common.support import carry, follow_frame, frame_of
from bearing_sim.levels.planar import state as planar
from bearing_sim.levels.planar.forces import border_accelerations as planar_accelerations
from bearing_sim.levels.planar.state import BORDER as PLANAR
from bearing_sim.levels.spatial.jacobian import follow_axes, land_cage_jacobian, land_ring_jacobian, roller_jacobian, turn_axes
from bearing_sim.levels.spatial.slices import deepest, press_outer_points, press_points, resist, soften_points, sum_tractions
from bearing_sim.levels.spatial.state import (
    BORDER,
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    LAYOUT,
    OMEGA,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    RUNS,
    SKEW,
    SLICED,
    THETA,
    TILT,
)
from bearing_sim.numerics.block_arrow import collect_rates, spread_state
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, add, larger, load, magnitude, spread, spread_run, store, total, where_positive
from bearing_sim.physics.contact import damped_line_contact
from bearing_sim.physics.flange import axial_share
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.pocket import pocket_friction_lanes
from bearing_sim.physics.ring_balance import deflect_elastic_ring, follow_rollers, typical_stiffness
from bearing_sim.physics.traction import traction_along


class LandWork(NamedTuple):
    """The part of the planar level's memory that a guide land needs."""

    global_block: np.ndarray  # shape (5, 10)


@fused
def place_land(y, position, land):
    """Write the state of a planar cage and ring that stand where their axes pass a land.

    Parameters
    ----------
    y : state.
    position : of the land along the axis [m].
    land : takes the planar border's positions and speeds, shape (10,) or longer.
    """
    for first, to in ((0, 0), (BORDER, PLANAR)):
        for axis in range(2):
            land[to + planar.RING_Y + axis] = y[first + RING_Y + axis] + position * y[first + RING_TILT_Y + axis]
            land[to + planar.CAGE_Y + axis] = y[first + CAGE_Y + axis] + position * y[first + CAGE_TILT_Y + axis]
        land[to + planar.THETA] = y[first + THETA]


@fused
def border_accelerations(t, y, model, work, rate, with_jacobian):
    """Write the accelerations of ring and cage, but for what the rollers add, into ``rate`` and their derivatives into ``work``."""
    params, tilts = model.params, model.params.tilts
    position, near, far = tilts.land_position, work.lands[2], work.lands[3]
    place_land(y, position, work.lands[0])
    place_land(y, -position, work.lands[1])
    planar_accelerations(t, work.lands[0], model, LandWork(work.land_own[0]), near, with_jacobian)
    planar_accelerations(t, work.lands[1], model, LandWork(work.land_own[1]), far, with_jacobian)
    for axis in range(2):
        ring, cage = PLANAR + planar.RING_Y + axis, PLANAR + planar.CAGE_Y + axis
        rate[BORDER + RING_Y + axis] = 0.5 * (near[ring] + far[ring])
        rate[BORDER + CAGE_Y + axis] = 0.5 * (near[cage] + far[cage])
    rate[OMEGA] = 0.5 * (near[planar.OMEGA] + far[planar.OMEGA])
    lever = 0.5 * position * params.cage.mass / tilts.cage_inertia
    # I x'' = M_y - J omega y', I y'' = M_z + J omega x' of an axis inclined by (x, y) that turns at omega
    cage_moment = params.variants.gyroscopic * params.cage.inertia / tilts.cage_inertia
    precession = cage_moment * y[OMEGA]
    apart_y = near[PLANAR + planar.CAGE_Y] - far[PLANAR + planar.CAGE_Y]
    apart_z = near[PLANAR + planar.CAGE_Z] - far[PLANAR + planar.CAGE_Z]
    rate[BORDER + CAGE_TILT_Y] = lever * apart_y - precession * y[BORDER + CAGE_TILT_Z]
    rate[BORDER + CAGE_TILT_Z] = lever * apart_z + precession * y[BORDER + CAGE_TILT_Y]
    free = tilts.ring_free / tilts.ring_inertia
    ring_precession = free * params.variants.gyroscopic * tilts.ring_polar_inertia * shaft_speed_at(t, model.drive)
    rate[BORDER + RING_TILT_Y] = free * tilts.moment_y - ring_precession * y[BORDER + RING_TILT_Z]
    rate[BORDER + RING_TILT_Z] = free * tilts.moment_z + ring_precession * y[BORDER + RING_TILT_Y]
    on_ring = params.cage.guidance.turning > 0.0
    ring_lever = 0.5 * position * params.ring.mass * free
    if on_ring:
        rate[BORDER + RING_TILT_Y] += ring_lever * (near[PLANAR + planar.RING_Y] - far[PLANAR + planar.RING_Y])
        rate[BORDER + RING_TILT_Z] += ring_lever * (near[PLANAR + planar.RING_Z] - far[PLANAR + planar.RING_Z])
    if not with_jacobian:
        return
    own = work.global_block
    land_cage_jacobian(position, lever, work.land_own, own)
    own[RING_TILT_Y, BORDER + RING_TILT_Z], own[RING_TILT_Z, BORDER + RING_TILT_Y] = 0.0, 0.0
    if on_ring:
        land_ring_jacobian(position, lever, ring_lever, work.land_own, own)
    own[CAGE_TILT_Y, BORDER + CAGE_TILT_Z] -= precession
    own[CAGE_TILT_Z, BORDER + CAGE_TILT_Y] += precession
    own[CAGE_TILT_Y, OMEGA] -= cage_moment * y[BORDER + CAGE_TILT_Z]
    own[CAGE_TILT_Z, OMEGA] += cage_moment * y[BORDER + CAGE_TILT_Y]
    own[RING_TILT_Y, BORDER + RING_TILT_Z] -= ring_precession
    own[RING_TILT_Z, BORDER + RING_TILT_Y] += ring_precession


@fused
def _lie_in_pockets(block, y, cage_cosine, cage_sine, rows):
    """Write how a block of rollers lies in its pockets.

    Parameters
    ----------
    y : state.
    cage_cosine, cage_sine : of the cage's angle.
    rows : of the rollers, see `bearing_sim.levels.spatial.state.ROLLER`.
    """
    place_in_pockets(ROLLER, block, _cage(y), cage_cosine, cage_sine, rows)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    play_cosine, play_sine = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    omega = y[OMEGA]
    turning = load(rows, block, ROLLER.orbital_speed) - omega
    # inclinations of the axes relate to tilting as positions relate to motion
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    outwards, along = tilt * play_cosine - skew * play_sine, tilt * play_sine + skew * play_cosine
    lean_r, lean_t = y[CAGE_TILT_Y] * p_c + y[CAGE_TILT_Z] * p_s, y[CAGE_TILT_Z] * p_c - y[CAGE_TILT_Y] * p_s
    lean_speed_t = y[BORDER + CAGE_TILT_Z] * p_c - y[BORDER + CAGE_TILT_Y] * p_s
    store(rows, block, ROLLER.pocket_lean, outwards - lean_r)
    store(rows, block, ROLLER.pocket_skew, along - lean_t)
    rate = load(rows, block, ROLLER.tilt_speed) * play_sine + load(rows, block, ROLLER.skew_speed) * play_cosine + turning * outwards
    store(rows, block, ROLLER.pocket_skew_rate, rate - lean_speed_t + omega * lean_r)


@kernel
def _cage(y):
    """Return position and velocity of the cage's centre and the cage's speed, as `bearing_sim.levels.common.rollers` takes them."""
    return y[CAGE_Y], y[CAGE_Z], y[BORDER + CAGE_Y], y[BORDER + CAGE_Z], y[OMEGA]


@kernel
def hold_slices(offset, rate, skew, skew_rate, clearance, stiffness, params):
    """Return force and moment of two opposite walls, then sums over slices of the force's derivatives by offset and by rate, each times 1, x, x^2.

    Parameters
    ----------
    offset, rate : of the roller's middle from the middle between the walls [m], and its time derivative (lanes).
    skew, skew_rate : inclination of the roller between them, and its time derivative (lanes).
    clearance : to either wall [m].
    stiffness : of the film within it [N/m].
    params : of the bearing.
    """
    positions, damping = params.slices.walls, params.cage.pocket_damping
    count = positions.shape[0]
    width = 2.0 * positions[count - 1] / (count - 1) if count > 1 else 0.0
    square = width * width * (count * count - 1) / 12.0  # mean of x^2 over slices
    k_0, k_1, k_2 = spread(stiffness), spread(0.0), spread(stiffness * square)
    d_0, d_1, d_2 = spread(damping), spread(0.0), spread(damping * square)
    force, moment = stiffness * offset + damping * rate, square * (stiffness * skew + damping * skew_rate)
    excess = magnitude(offset) + magnitude(skew) * positions[count - 1] - clearance
    if total(where_positive(excess, 1.0, 0.0)) > 0.0:
        part, film = params.raceways.stiffness / count, stiffness / count
        for k in range(count):
            x = positions[k]
            position = offset + skew * x
            side, excess = where_positive(position, 1.0, -1.0), magnitude(position) - clearance
            wall, stiffer, damped = damped_line_contact(excess, (rate + skew_rate * x) * side, part, params.raceways.damping)
            more = side * (wall - film * larger(excess, 0.0))
            stiffer -= where_positive(excess, film, 0.0)
            force += more
            moment += more * x
            k_0 += stiffer
            k_1 += stiffer * x
            k_2 += stiffer * x * x
            d_0 += damped
            d_1 += damped * x
            d_2 += damped * x * x
    return force, moment, k_0, k_1, k_2, d_0, d_1, d_2


@fused
def pocket_forces(block, coefficient, params, rows):
    """Write what the pockets do to a block of rollers that has been placed in them.

    Parameters
    ----------
    coefficient : of friction.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.spatial.state.ROLLER`.
    """
    cage, spin = params.cage, load(rows, block, ROLLER.spin)
    offset, rate = load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_rate)
    skew, skew_rate = load(rows, block, ROLLER.pocket_skew), load(rows, block, ROLLER.pocket_skew_rate)
    force, moment, k_0, k_1, k_2, d_0, d_1, d_2 = hold_slices(offset, rate, skew, skew_rate, cage.pocket_clearance, cage.pocket_stiffness, params)
    friction, d_spin = pocket_friction_lanes(spin, coefficient)
    store(rows, block, ROLLER.pocket_force, -force)
    store(rows, block, ROLLER.pocket_moment, -moment)
    store(rows, block, ROLLER.pocket_stiffness, k_0)
    store(rows, block, ROLLER.pocket_stiffness + 1, k_1)
    store(rows, block, ROLLER.pocket_stiffness + 2, k_2)
    store(rows, block, ROLLER.pocket_damping, d_0)
    store(rows, block, ROLLER.pocket_damping + 1, d_1)
    store(rows, block, ROLLER.pocket_damping + 2, d_2)
    store(rows, block, ROLLER.pocket_friction, friction)
    store(rows, block, ROLLER.pocket_friction_d_spin, d_spin)


@fused
def _place_rollers(y, shaft_speed, inner_radius, params, rows, contacts):
    """Write directions about the displaced ring, penetrations, rolling and sliding speeds of all rollers and how they lean.

    Parameters
    ----------
    y : state, spread over ``rows`` (see `bearing_sim.levels.spatial.state.ROLLER`).
    shaft_speed : [rad/s].
    inner_radius : R_i, grown [m].
    contacts : rows `bearing_sim.levels.spatial.state.SLICED`; takes what goes into the forces.
    """
    place_rollers(ROLLER, SLICED, _ring(y)[:4], shaft_speed, inner_radius, params, rows, contacts)
    for block in range(rows.shape[0]):
        _lean(block, y, rows, contacts)


@kernel
def _ring(y):
    """Return position y, z, velocity y', z' and tilts of the inner ring."""
    return y[RING_Y], y[RING_Z], y[BORDER + RING_Y], y[BORDER + RING_Z], y[RING_TILT_Y], y[RING_TILT_Z]


@fused
def carry_forces(y, count, work):
    """Carry penetrations, leans and normal forces along the last correction to ``y``, see `carry_normal_forces`."""
    rows, contacts, ring, evaluated = work.rollers, work.contacts, _ring(y), work.evaluated_ring
    carry_normal_forces(ROLLER, SLICED, RUNS, y, ring, evaluated, count, rows, contacts)
    spread_run(y, ROLLERS + TILT * count, count, rows, ROLLER.known_tilt)
    spread_run(y, ROLLERS + SKEW * count, count, rows, ROLLER.known_tilt_speed)
    ring_y, ring_z = ring[4] - evaluated[4], ring[5] - evaluated[5]
    for block in range(rows.shape[0]):
        cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        tilting = load(rows, block, ROLLER.known_tilt) - load(rows, block, ROLLER.tilt)
        skewing = load(rows, block, ROLLER.known_tilt_speed) - load(rows, block, ROLLER.skew)
        lean_r, lean_t = tilting - (ring_y * cosine + ring_z * sine), skewing - (ring_z * cosine - ring_y * sine)
        along = load(rows, block, ROLLER.normal_r) * lean_r + load(rows, block, ROLLER.normal_t) * lean_t
        _lean_further(block, -along, contacts)
        _lean_further(rows.shape[0] + block, tilting, contacts)


@kernel
def _lean_further(block, further, contacts):
    """Change the leans of a block of contacts, and their normal forces to first order."""
    force = load(contacts, block, SLICED.load) + load(contacts, block, SLICED.stiffness + 1) * further
    store(contacts, block, SLICED.load, larger(force, 0.0))
    add(contacts, block, SLICED.lean, further)


@fused
def _lean(block, y, rows, contacts):
    """Write how a block of rollers leans against both raceways: inclinations, and their rates in a frame that does not turn."""
    cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    n_r, n_t, outer = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), rows.shape[0] + block
    tilt, skew, orbital_speed = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew), load(rows, block, ROLLER.orbital_speed)
    tilt_speed = load(rows, block, ROLLER.tilt_speed)
    skewing = load(rows, block, ROLLER.skew_speed) + orbital_speed * tilt
    lean_r = tilt - (y[RING_TILT_Y] * cosine + y[RING_TILT_Z] * sine)
    lean_t = skew - (y[RING_TILT_Z] * cosine - y[RING_TILT_Y] * sine)
    speed_r = tilt_speed - orbital_speed * skew - (y[BORDER + RING_TILT_Y] * cosine + y[BORDER + RING_TILT_Z] * sine)
    speed_t = skewing - (y[BORDER + RING_TILT_Z] * cosine - y[BORDER + RING_TILT_Y] * sine)
    lean_n, lean_p = n_r * lean_r + n_t * lean_t, n_r * lean_t - n_t * lean_r
    speed_n, speed_p = n_r * speed_r + n_t * speed_t, n_r * speed_t - n_t * speed_r
    store(rows, block, ROLLER.lean_normal, lean_n)
    store(rows, block, ROLLER.lean_tangent, lean_p)
    store(rows, block, ROLLER.lean_speed_normal, speed_n)
    store(rows, block, ROLLER.lean_speed_tangent, speed_p)
    # the normal itself turns while the roller passes the ring
    turning = load(rows, block, ROLLER.speed_tangent) * load(rows, block, ROLLER.inverse_distance)
    store(contacts, block, SLICED.lean, -lean_n)
    store(contacts, block, SLICED.lean_rate, -(speed_n + turning * lean_p))
    store(contacts, block, SLICED.sliding_lean, -speed_p)
    store(contacts, outer, SLICED.lean, tilt)
    store(contacts, outer, SLICED.lean_rate, tilt_speed)
    store(contacts, outer, SLICED.sliding_lean, -skewing)


@fused
def _accelerate(block, y, churning, model, rows, contacts, rate):
    """Write the accelerations of a block of rollers; add to those of ring and cage what the rollers do to them."""
    params, tilts = model.params, model.params.tilts
    cage, ring, mass, roller_radius = params.cage, params.ring, params.rollers.mass, params.rollers.radius
    radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
    orbital_speed, spin = load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.spin)
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    outer = rows.shape[0] + block
    n_r, n_t = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t)
    q_i, q_e = load(contacts, block, SLICED.load), load(contacts, outer, SLICED.load)
    t_i, t_e = load(contacts, block, SLICED.force), load(contacts, outer, SLICED.force)
    s_i, s_e = load(contacts, block, SLICED.tilting), load(contacts, outer, SLICED.tilting)
    m_i, m_e = load(contacts, block, SLICED.skewing), load(contacts, outer, SLICED.skewing)
    # the resistance to rolling, as at level `planar`
    resistance_i, resistance_e = load(contacts, block, SLICED.resistance), load(contacts, outer, SLICED.resistance)
    push_i, push_e = 1.0 - 2.0 * params.raceways.diameter_ratio, 1.0 + 2.0 * params.raceways.diameter_ratio
    force, moment = -load(rows, block, ROLLER.pocket_force), -load(rows, block, ROLLER.pocket_moment)
    friction = load(rows, block, ROLLER.pocket_friction)
    play_cosine, play_sine = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_r, push_t = play_sine + friction * play_cosine, play_cosine - friction * play_sine
    across = t_i + resistance_i * push_i + s_i * load(rows, block, ROLLER.lean_tangent) * load(rows, block, ROLLER.inverse_distance)
    radial, along = q_i * n_r - across * n_t, q_i * n_t + across * n_r
    tilting, skewing = s_i * n_r - m_i * n_t, s_i * n_t + m_i * n_r
    drag = churning[0] + churning[1] * (radius * orbital_speed - params.raceways.pitch_radius * y[OMEGA])
    drag = where_positive(drag * orbital_speed, drag, 0.0)  # extrapolated, it would push a roller that is far slower than the cage
    slope = params.variants.contour_slope * load(rows, block, ROLLER.slope)
    f_r = radial - q_e - force * push_r
    f_t = along + t_e - resistance_e * push_e + (q_e * slope - s_e * skew) / radius - drag - force * push_t
    m_r, m_t = tilting - s_e - moment * push_r, skewing + m_e - moment * push_t
    orbital_acceleration = (f_t * (1.0 / mass) - 2.0 * radial_speed * orbital_speed) / radius
    store(rows, block, ROLLER.churning, drag)
    store(rows, block, ROLLER.radial_acceleration, radius * orbital_speed * orbital_speed + f_r * (1.0 / mass))
    store(rows, block, ROLLER.orbital_acceleration, orbital_acceleration)
    # A roller spins backwards, at -w; its axis is described in a frame that turns with the orbit.
    gyroscopic = spin * (params.variants.gyroscopic * params.rollers.inertia / tilts.roller_inertia)
    turning, carrying = gyroscopic + 2.0 * orbital_speed, (gyroscopic + orbital_speed) * orbital_speed
    bend = turning * load(rows, block, ROLLER.skew_speed) + carrying * tilt + orbital_acceleration * skew
    store(rows, block, ROLLER.tilt_acceleration, m_r * (1.0 / tilts.roller_inertia) + bend)
    bend = carrying * skew - turning * load(rows, block, ROLLER.tilt_speed) - orbital_acceleration * tilt
    store(rows, block, ROLLER.skew_acceleration, m_t * (1.0 / tilts.roller_inertia) + bend)
    spin_acceleration = (t_i - t_e - resistance_i - resistance_e - friction * magnitude(force)) * (roller_radius / params.rollers.inertia)
    store(rows, block, ROLLER.spin_acceleration, spin_acceleration)
    present, cosine, sine = load(rows, block, ROLLER.present), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    lever = radius * play_cosine - (y[CAGE_Y] * p_c + y[CAGE_Z] * p_s)
    torque = force * lever - friction * (magnitude(force) * roller_radius + load(rows, block, ROLLER.pocket_offset) * force)
    torque += moment * (load(rows, block, ROLLER.pocket_lean) - friction * load(rows, block, ROLLER.pocket_skew))
    free = tilts.ring_free / tilts.ring_inertia
    rate[BORDER + RING_Y] -= total(present * (radial * cosine - along * sine)) / ring.mass
    rate[BORDER + RING_Z] -= total(present * (radial * sine + along * cosine)) / ring.mass
    rate[BORDER + RING_TILT_Y] -= total(present * (tilting * cosine - skewing * sine)) * free
    rate[BORDER + RING_TILT_Z] -= total(present * (tilting * sine + skewing * cosine)) * free
    push_y, push_z = present * (friction * p_c - p_s), present * (p_c + friction * p_s)
    rate[BORDER + CAGE_Y] += total(force * push_y) / cage.mass
    rate[BORDER + CAGE_Z] += total(force * push_z) / cage.mass
    rate[BORDER + CAGE_TILT_Y] += total(moment * push_y) / tilts.cage_inertia
    rate[BORDER + CAGE_TILT_Z] += total(moment * push_z) / tilts.cage_inertia
    rate[OMEGA] += total(present * torque) / cage.inertia


@kernel
def _bend(y, outer_ring, model, work):
    """Let the outer ring give way to the rollers; return whether that was found.  ``outer_ring`` is that of the bearing, None where it is rigid.

    The ring bends alike at both of its ends.  A roller that leans more presses it as one that approaches it by as much as raises the force so.
    """
    if outer_ring is None:
        return True
    params, rows, contacts, loads, bending, rates = model.params, work.rollers, work.contacts, work.ring_loads, work.bending, work.ring_rates
    raceways, slices, blocks = params.raceways, params.slices, work.rollers.shape[0]
    place_at_ring(ROLLER, SLICED, y[THETA], y[OMEGA], 0.0, rows, contacts, loads, rates, bending)
    for block in range(blocks):
        store(contacts, blocks + block, SLICED.rate, spread(0.0))
        store(contacts, blocks + block, SLICED.lean_rate, spread(0.0))
        store(rows, block, ROLLER.moved, -deepest(blocks + block, contacts, slices))
    for j in range(params.rollers.count):
        loads[LOAD.free, j] = rows[j // LANES, ROLLER.moved, j % LANES]
    law, pressure = (contacts, work.points, slices, raceways.stiffness, raceways.damping), model.lubrication.growth.housing_pressure
    typical = typical_stiffness(raceways.stiffness, raceways.profile)
    if not deflect_elastic_ring(y[THETA], pressure, press_outer_points, law, typical, outer_ring, loads, bending):
        return False
    for block in range(blocks):
        store(contacts, blocks + block, SLICED.lean_rate, load(rows, block, ROLLER.tilt_speed))
    for j in range(params.rollers.count):
        rates[j] += _by_lean(blocks, j, contacts, loads) * rows[j // LANES, ROLLER.tilt_speed, j % LANES]
    follow_rollers(loads, rates, bending)
    for j in range(params.rollers.count):
        rates[j] -= _by_lean(blocks, j, contacts, loads) * rows[j // LANES, ROLLER.tilt_speed, j % LANES]
    give_way(ROLLER, SLICED, 0.0, rows, contacts, loads, rates, bending)
    work.bent_at[0] = y[THETA]
    return True


@kernel
def _by_lean(blocks, j, contacts, loads):
    """Return the approach of a roller to the outer raceway that changes its force as much as a unit of lean does [m]."""
    slope = loads[LOAD.slope, j]
    return contacts[blocks + j // LANES, SLICED.stiffness + 1, j % LANES] / slope if slope > 0.0 else 0.0


@fused
def equations(t, y, model, work, rate, with_jacobian):
    """Write dy/dt into ``rate`` and, where asked, all derivatives into ``work``.

    See the docstring of the module.
    """
    params, rows, contacts = model.params, work.rollers, work.contacts
    shaft_speed = shaft_speed_at(t, model.drive)
    films, churning = films_at(t, shaft_speed, model), linear_churning(y[OMEGA], shaft_speed, model)
    inner_radius, resistance = params.raceways.inner_radius + inner_growth(shaft_speed, model), model.lubrication.rolling_resistance.on
    spread_state(LAYOUT, y, params.rollers.count, rows)
    border_accelerations(t, y, model, work, rate, with_jacobian)
    for k in range(BORDER):
        rate[k] = y[BORDER + k]
    cage_cosine, cage_sine = math.cos(y[THETA]), math.sin(y[THETA])
    _place_rollers(y, shaft_speed, inner_radius, params, rows, contacts)
    ring = _ring(y)
    for k in range(6):
        work.evaluated_ring[k] = ring[k]
    if not _bend(y, params.outer_ring, model, work):
        return False
    points, first_points, count = work.points, work.first_points, params.slices.points
    middle, end = press_points(contacts, points, first_points, params.slices, params.raceways.stiffness, params.raceways.damping)
    traction_along(points[:end], middle, count, model.lubrication.inner, model.lubrication.outer, films)
    sum_tractions(contacts, points, first_points, count)
    if resistance:
        resist(contacts, params.slices, model.lubrication.rolling_resistance, films)
    if params.flanges.load > 0.0:
        press_axially(params, rows, contacts)
    for block in range(rows.shape[0]):
        _lie_in_pockets(block, y, cage_cosine, cage_sine, rows)
        pocket_forces(block, films.pocket_friction, params, rows)
    for block in range(rows.shape[0]):
        _accelerate(block, y, churning, model, rows, contacts, rate)
    if not params.cage.guidance.lands:
        for block in range(rows.shape[0]):
            guide_forces(block, y, params, rows)
            guide_accelerations(block, params, rows, rate)
    if params.flanges.on:
        flange_accelerations(shaft_speed, films.flange_friction, model, rows, contacts, rate)
    soften_points(rows.shape[0], resistance, contacts, work.bending)
    if with_jacobian:
        roller_jacobian(y, inner_radius, churning, resistance, params, model.lubrication.viscosity, rows, contacts, work.chain, work.jacobian)
    if work.support.shape[0] > 0:
        _carry(t, y, model, work, rate, with_jacobian)
    collect_rates(LAYOUT, y, params.rollers.count, rows, rate)
    return True


@kernel
def _carry(t, y, model, work, rate, with_jacobian):
    """Let the support move everything, see `bearing_sim.levels.common.support`."""
    rows, support = work.rollers, work.support
    carry(LAYOUT, RUNS, ROLLER, t, y, model, work, rate, with_jacobian)
    if with_jacobian:
        follow_axes(model.params.rollers.count, rows, support)
    for block in range(rows.shape[0]):
        if with_jacobian:
            turn_axes(block, frame_of(support), rows, work.jacobian)
        turned = load(rows, block, ROLLER.orbital_acceleration)
        follow_frame(ROLLER, block, frame_of(support), rows)
        turned = load(rows, block, ROLLER.orbital_acceleration) - turned
        # a roller's axis is described in the frame that turns with the orbit
        add(rows, block, ROLLER.tilt_acceleration, turned * load(rows, block, ROLLER.skew))
        add(rows, block, ROLLER.skew_acceleration, -(turned * load(rows, block, ROLLER.tilt)))


@kernel
def guide_forces(block, y, params, rows):
    """Write how a block of rollers stands outwards in its pockets, and what these do to it; it has been placed in them along the orbit.

    Parameters
    ----------
    y : state.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.spatial.state.ROLLER`.
    """
    cage, orbital_speed = params.cage, load(rows, block, ROLLER.orbital_speed)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    offset, rate = place_outwards(ROLLER, block, _cage(y), cage.guidance, rows)
    lean_rate = load(rows, block, ROLLER.tilt_speed) * c - load(rows, block, ROLLER.skew_speed) * s - orbital_speed * (tilt * s + skew * c)
    lean_rate += y[OMEGA] * load(rows, block, ROLLER.pocket_skew) - (y[BORDER + CAGE_TILT_Y] * p_c + y[BORDER + CAGE_TILT_Z] * p_s)
    lean = load(rows, block, ROLLER.pocket_lean)
    force, moment, k_0, k_1, k_2, d_0, d_1, d_2 = hold_slices(offset, rate, lean, lean_rate, cage.guide_clearance, 0.0, params)
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
    add(rows, block, ROLLER.radial_acceleration, -(force * push_r * (1.0 / rollers.mass)))
    add(rows, block, ROLLER.orbital_acceleration, turned)
    # a roller's axis is described in the frame that turns with the orbit
    per_inertia = 1.0 / tilts.roller_inertia
    add(rows, block, ROLLER.tilt_acceleration, turned * load(rows, block, ROLLER.skew) - moment * push_r * per_inertia)
    add(rows, block, ROLLER.skew_acceleration, moment * push_t * per_inertia - turned * load(rows, block, ROLLER.tilt))
    braking = friction * magnitude(force) * rollers.radius
    add(rows, block, ROLLER.spin_acceleration, -(braking * (1.0 / rollers.inertia)))
    push_y, push_z = present * (p_c + friction * p_s), present * (p_s - friction * p_c)
    rate[BORDER + CAGE_Y] += total(force * push_y) / cage.mass
    rate[BORDER + CAGE_Z] += total(force * push_z) / cage.mass
    rate[BORDER + CAGE_TILT_Y] += total(moment * push_y) / tilts.cage_inertia
    rate[BORDER + CAGE_TILT_Z] += total(moment * push_z) / tilts.cage_inertia
    lever = load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius
    torque = force * (load(rows, block, ROLLER.pocket_offset) + friction * lever) + braking
    torque += moment * (load(rows, block, ROLLER.pocket_skew) + friction * load(rows, block, ROLLER.pocket_lean))
    rate[OMEGA] -= total(present * torque) / cage.inertia


@kernel
def press_axially(params, rows, contacts):
    """Add the couple of an axial load to the moments that tilt the rollers; those of the raceways have been written.

    The inner ring's flange presses an end at one side, the outer ring's the other end at the other side of the roller's axis.  *Assumptions*: the
    axial load's lever about the bearing's axis does not tilt the ring, and a force that guides rollers (``guiding_load``) has no couple.
    """
    blocks, flanges = rows.shape[0], params.flanges
    carried = total_load(ROLLER, SLICED.load, rows, contacts)
    for block in range(blocks):
        share = axial_share(load(contacts, block, SLICED.load), carried, params.rollers.count, flanges)
        force = flanges.couple * (share - flanges.guiding * load(contacts, block, SLICED.load))
        add(contacts, block, SLICED.tilting, -(force * flanges.inner.offset))
        add(contacts, blocks + block, SLICED.tilting, -(force * flanges.outer.offset))


@kernel
def _write_flanges(block, shaft_speed, friction, pressed, model, rows):
    """Write what flanges do to the ends of a block of rollers; the rollers have been placed."""
    viscosity, flanges = model.lubrication.viscosity, model.params.flanges
    rub_on_flanges(ROLLER, block, shaft_speed, pressed, flanges, viscosity, rows)
    spin, v_p = load(rows, block, ROLLER.spin), load(rows, block, ROLLER.speed_tangent)
    turning = v_p * load(rows, block, ROLLER.inverse_distance)
    skew, rate = (
        load(rows, block, ROLLER.lean_tangent),
        load(rows, block, ROLLER.lean_speed_tangent) - turning * load(rows, block, ROLLER.lean_normal),
    )
    u, s = v_p - shaft_speed * flanges.pitch_radius, spin + shaft_speed
    stop_skew_on_face(block, ROLLER.inner_flange, flanges.inner, flanges, friction, viscosity, skew, rate, u, s, rows)
    skew, rate = load(rows, block, ROLLER.skew), load(rows, block, ROLLER.skew_speed)
    u = load(rows, block, ROLLER.radius) * load(rows, block, ROLLER.orbital_speed)
    stop_skew_on_face(block, ROLLER.outer_flange, flanges.outer, flanges, friction, viscosity, skew, rate, u, spin, rows)


@kernel
def flange_accelerations(shaft_speed, friction, model, rows, contacts, rate):
    """Write what flanges do to the ends of all rollers, and add it to the accelerations of rollers and ring; ``friction`` is a coefficient.

    A moment on the skew has a lever along the orbit where the roller is tilted as well, as the points' forces have: the direction of the skew
    turns with the roller's position.
    """
    params, tilts = model.params, model.params.tilts
    carried = total_load(ROLLER, SLICED.load, rows, contacts)
    free, per_mass, per_tilt = tilts.ring_free / tilts.ring_inertia, 1.0 / params.rollers.mass, 1.0 / tilts.roller_inertia
    for block in range(rows.shape[0]):
        pressed = friction * axial_share(load(contacts, block, SLICED.load), carried, params.rollers.count, params.flanges)
        _write_flanges(block, shaft_speed, friction, pressed, model, rows)
        n_r, n_t, inverse = load(rows, block, ROLLER.normal_r), load(rows, block, ROLLER.normal_t), load(rows, block, ROLLER.inverse_distance)
        tilt, skew, per_radius = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew), 1.0 / load(rows, block, ROLLER.radius)
        inner_skewing, outer_skewing = (
            load(rows, block, ROLLER.inner_flange + FLANGE.skewing),
            load(rows, block, ROLLER.outer_flange + FLANGE.skewing),
        )
        across = load(rows, block, ROLLER.inner_flange + FLANGE.force) - inner_skewing * load(rows, block, ROLLER.lean_normal) * inverse
        outer = load(rows, block, ROLLER.outer_flange + FLANGE.force) - outer_skewing * tilt * per_radius
        moment = load(rows, block, ROLLER.inner_flange + FLANGE.moment) + load(rows, block, ROLLER.outer_flange + FLANGE.moment)
        radial, along, tilting, skewing = -(across * n_t), across * n_r, -(inner_skewing * n_t), inner_skewing * n_r
        turned = per_mass * (along + outer) * per_radius
        add(rows, block, ROLLER.radial_acceleration, per_mass * radial)
        add(rows, block, ROLLER.orbital_acceleration, turned)
        # a roller's axis is described in the frame that turns with the orbit
        add(rows, block, ROLLER.tilt_acceleration, per_tilt * tilting + turned * skew)
        add(rows, block, ROLLER.skew_acceleration, per_tilt * (skewing + outer_skewing) - turned * tilt)
        add(rows, block, ROLLER.spin_acceleration, moment * (1.0 / params.rollers.inertia))
        present, cosine, sine = load(rows, block, ROLLER.present), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        rate[BORDER + RING_Y] -= total(present * (radial * cosine - along * sine)) / params.ring.mass
        rate[BORDER + RING_Z] -= total(present * (radial * sine + along * cosine)) / params.ring.mass
        rate[BORDER + RING_TILT_Y] -= total(present * (tilting * cosine - skewing * sine)) * free
        rate[BORDER + RING_TILT_Z] -= total(present * (tilting * sine + skewing * cosine)) * free
