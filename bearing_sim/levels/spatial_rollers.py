# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What each roller feels and passes on in space, but for its way along its axis; ``LANES`` rollers at a time (a block).

Deng 2017, eq. 3 to 16, with gyroscopic moments.  Slices are places (x, centre + x tilt): each feels forces in its own plane, along
the normal at the roller's centre, and a body's moments are sums of forces times x.  So power and momentum are kept to the last term:
a normal force that acts where a skewed axis has taken a slice along the orbit has a lever about the bearing's axis.
"""

import math

from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.drag import churning_force
from bearing_sim.kernels.elementary import cosine_sine
from bearing_sim.kernels.film import pump
from bearing_sim.kernels.lanes import floor, load, magnitude, square_root, store, total, where_positive
from bearing_sim.kernels.raceway import contour_lanes
from bearing_sim.kernels.traction import traction
from bearing_sim.levels.growth import inner_growth
from bearing_sim.levels.inputs import shaft_speed_at
from bearing_sim.levels.spatial_algebra import BORDER
from bearing_sim.levels.spatial_border import border_accelerations
from bearing_sim.levels.spatial_guide import guide_accelerations, guide_forces
from bearing_sim.levels.spatial_pockets import place_in_pockets, pocket_forces
from bearing_sim.levels.spatial_slices import SLICED, load_pieces, sum_pumping, sum_tractions
from bearing_sim.levels.spatial_slopes import roller_slopes
from bearing_sim.levels.spatial_state import (
    CAGE_TILT_Y,
    CAGE_TILT_Z,
    CAGE_Y,
    CAGE_Z,
    OMEGA,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    THETA,
    collect_rates,
    spread_state,
)


@kernel
def place_rollers(y, shaft_speed, inner_radius, params, rows, contacts):
    """Write directions about the displaced ring, penetrations, rolling and sliding speeds of all rollers and how they lean.

    Parameters
    ----------
    y : state, spread over ``rows`` (see `bearing_sim.levels.spatial_state.ROLLER`).
    shaft_speed : [rad/s].
    inner_radius : R_i, grown [m].
    contacts : rows `bearing_sim.levels.spatial_slices.SLICED`; takes what goes into the forces.
    """
    raceways, roller_radius, blocks = params.raceways, params.rollers.radius, rows.shape[0]
    for block in range(blocks):
        turn = load(rows, block, ROLLER.angle) * (0.5 / math.pi)
        turn -= floor(turn)
        cosine, sine = cosine_sine(turn)
        contour, slope, curvature = contour_lanes(raceways.contour, turn)
        store(rows, block, ROLLER.cosine, cosine)
        store(rows, block, ROLLER.sine, sine)
        store(rows, block, ROLLER.slope, slope)
        store(rows, block, ROLLER.curvature, curvature)
        store(contacts, blocks + block, SLICED.penetration, load(rows, block, ROLLER.radius) + roller_radius - contour)
    for block in range(blocks):
        cosine, sine, radius = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine), load(rows, block, ROLLER.radius)
        orbital_speed, radial_speed = load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.radial_speed)
        apart_r, apart_t = radius - (y[RING_Y] * cosine + y[RING_Z] * sine), y[RING_Y] * sine - y[RING_Z] * cosine
        distance = square_root(apart_r * apart_r + apart_t * apart_t)
        inverse = 1.0 / distance
        n_r, n_t = apart_r * inverse, apart_t * inverse
        speed_r = radial_speed - (y[BORDER + RING_Y] * cosine + y[BORDER + RING_Z] * sine)
        speed_t = radius * orbital_speed - (y[BORDER + RING_Z] * cosine - y[BORDER + RING_Y] * sine)
        speed_normal, speed_tangent = n_r * speed_r + n_t * speed_t, n_r * speed_t - n_t * speed_r
        surface = load(rows, block, ROLLER.spin) * roller_radius
        rolling = surface + orbital_speed * roller_radius
        store(rows, block, ROLLER.normal_r, n_r)
        store(rows, block, ROLLER.normal_t, n_t)
        store(rows, block, ROLLER.inverse_distance, inverse)
        store(rows, block, ROLLER.speed_normal, speed_normal)
        store(rows, block, ROLLER.speed_tangent, speed_tangent)
        store(contacts, block, SLICED.penetration, inner_radius + roller_radius - distance)
        store(contacts, block, SLICED.rate, -speed_normal)
        store(contacts, block, SLICED.rolling, 0.5 * ((shaft_speed - orbital_speed) * inner_radius + rolling))
        store(contacts, block, SLICED.sliding, shaft_speed * inner_radius - speed_tangent - surface)
        outer = blocks + block
        store(contacts, outer, SLICED.rate, radial_speed - load(rows, block, ROLLER.slope) * orbital_speed)
        store(contacts, outer, SLICED.rolling, 0.5 * (orbital_speed * (radius + roller_radius) + rolling))
        store(contacts, outer, SLICED.sliding, surface - radius * orbital_speed)
    for block in range(blocks):
        _lean(block, y, rows, contacts)


@kernel
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


@kernel
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
    # the oil pumped back, as at level `planar`
    pumped_i, pumped_e = load(contacts, block, SLICED.pumping), load(contacts, outer, SLICED.pumping)
    push_i, push_e = 1.0 - 2.0 * params.raceways.diameter_ratio, 1.0 + 2.0 * params.raceways.diameter_ratio
    m_i += push_i * load(contacts, block, SLICED.pumping_moment)
    m_e -= push_e * load(contacts, outer, SLICED.pumping_moment)
    force, moment = -load(rows, block, ROLLER.pocket_force), -load(rows, block, ROLLER.pocket_moment)
    friction = load(rows, block, ROLLER.pocket_friction)
    play_cosine, play_sine = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    push_r, push_t = play_sine + friction * play_cosine, play_cosine - friction * play_sine
    across = t_i + pumped_i * push_i + s_i * load(rows, block, ROLLER.lean_tangent) * load(rows, block, ROLLER.inverse_distance)
    radial, along = q_i * n_r - across * n_t, q_i * n_t + across * n_r
    tilting, skewing = s_i * n_r - m_i * n_t, s_i * n_t + m_i * n_r
    drag = churning[0] + churning[1] * (radius * orbital_speed - params.raceways.pitch_radius * y[OMEGA])
    drag = where_positive(drag * orbital_speed, drag, 0.0)  # a line through it would push a roller far slower than the cage
    slope = params.raceways.slope_factor * load(rows, block, ROLLER.slope)
    f_r = radial - q_e - force * push_r
    f_t = along + t_e - pumped_e * push_e + (q_e * slope - s_e * skew) / radius - drag - force * push_t
    m_r, m_t = tilting - s_e - moment * push_r, skewing + m_e - moment * push_t
    orbital_acceleration = (f_t * (1.0 / mass) - 2.0 * radial_speed * orbital_speed) / radius
    store(rows, block, ROLLER.churning, drag)
    store(rows, block, ROLLER.radial_acceleration, radius * orbital_speed * orbital_speed + f_r * (1.0 / mass))
    store(rows, block, ROLLER.orbital_acceleration, orbital_acceleration)
    # A roller spins backwards, at -w; its axis is described in a frame that turns with the orbit.
    gyroscopic = spin * (tilts.gyroscopic * params.rollers.inertia / tilts.roller_inertia)
    turning, carrying = gyroscopic + 2.0 * orbital_speed, (gyroscopic + orbital_speed) * orbital_speed
    bend = turning * load(rows, block, ROLLER.skew_speed) + carrying * tilt + orbital_acceleration * skew
    store(rows, block, ROLLER.tilt_acceleration, m_r * (1.0 / tilts.roller_inertia) + bend)
    bend = carrying * skew - turning * load(rows, block, ROLLER.tilt_speed) - orbital_acceleration * tilt
    store(rows, block, ROLLER.skew_acceleration, m_t * (1.0 / tilts.roller_inertia) + bend)
    spin_acceleration = (t_i - t_e - pumped_i - pumped_e - friction * magnitude(force)) * (roller_radius / params.rollers.inertia)
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
def _churning(y, model):
    """Drag of the mixture on a roller, linear about the cage's speed, as in `bearing_sim.levels.planar_rollers`."""
    rollers, lubrication, pitch_radius = model.params.rollers, model.lubrication, model.params.raceways.pitch_radius
    speed = pitch_radius * y[OMEGA]
    force, slope = churning_force(speed, lubrication.mixture_density, lubrication.viscosity, 2.0 * rollers.radius, rollers.length)
    bend = slope * (slope / force - 1.0 / speed) * pitch_radius if force != 0.0 else 0.0
    return force, slope, bend


@kernel
def equations(t, y, model, work, rate, with_jacobian):
    """Write dy/dt into ``rate`` and, where asked, all derivatives into ``work``.

    A roller's centre and spin move as in `bearing_sim.levels.planar_rollers`.  Its axis, inclined by (tilt, skew) outwards and
    along the orbit, follows I A'' = M + J w (A_t', -A_r') in a frame that does not turn, with M the sums of forces times x.
    """
    params, rows, contacts = model.params, work.rollers, work.contacts
    shaft_speed, churning = shaft_speed_at(t, model.drive), _churning(y, model)
    inner_radius, pumping = params.raceways.inner_radius + inner_growth(shaft_speed, model), model.lubrication.pumping.on
    spread_state(y, params.rollers.count, rows)
    border_accelerations(t, y, model, work, rate, with_jacobian)
    for k in range(BORDER):
        rate[k] = y[BORDER + k]
    cage_cosine, cage_sine = math.cos(y[THETA]), math.sin(y[THETA])
    place_rollers(y, shaft_speed, inner_radius, params, rows, contacts)
    load_pieces(contacts, work.pieces, params.slices, params.raceways.stiffness, params.ring.contact_damping)
    traction(work.pieces, model.lubrication.inner, model.lubrication.outer)
    sum_tractions(contacts, work.pieces, params.slices)
    if pumping:
        pump(work.pieces, model.lubrication.pumping)
        sum_pumping(contacts, work.pieces, params.slices)
    for block in range(rows.shape[0]):
        place_in_pockets(block, y, cage_cosine, cage_sine, rows)
        pocket_forces(block, params, rows)
    for block in range(rows.shape[0]):
        _accelerate(block, y, churning, model, rows, contacts, rate)
    if not params.cage.guidance.lands:
        for block in range(rows.shape[0]):
            guide_forces(block, y, params, rows)
            guide_accelerations(block, params, rows, rate)
    if with_jacobian:
        roller_slopes(y, inner_radius, churning, pumping, params, rows, contacts, work.chain, work.slopes)
    collect_rates(y, params.rollers.count, rows, rate)
    return True
