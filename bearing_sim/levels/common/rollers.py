# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What levels compute for every roller in the same way; ``LANES`` rollers at a time (a block).

A level passes the records of its rows, so that one text serves both: ``row`` are the rows of its rollers array (``ROLLER``), ``contact``
those of its contacts array (`CONTACT`, or ``SLICED`` at level ``spatial``).  They are constants to the compiler.

Frame of a roller: r outwards, t along the orbit.  The inner contact's normal n points from the centre of the displaced ring to the
roller's, the tangent p is a right angle ahead of it.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.elementary import cosine_sine
from bearing_sim.numerics.simd import LANES, add, floor, larger, load, new_rows, spread, spread_run, square_root, store, total
from bearing_sim.physics.drag import roller_drag
from bearing_sim.physics.film import resist_rolling
from bearing_sim.physics.profile import concentrate, spread_tractions
from bearing_sim.physics.raceway import contour_lanes
from bearing_sim.physics.traction import traction

_SOFTEST = 1e-3  # N/m; far below the stiffness of any contact that touches
_TOUCH = 1e-9  # m; assumption: bodies that barely touch, which carries some 0.1 N


class StateRuns(NamedTuple):
    """Where a level keeps what all levels with rollers of their own have: where the rollers' states begin, and which run of Z states is which."""

    first: int
    radius: int
    angle: int
    radial_speed: int
    orbital_speed: int
    spin: int


def new_rollers(row, rows, count):
    """Return zeroed ``rows`` for ``count`` rollers, but for who is present and where the pockets stand."""
    rollers = new_rows(rows, count)
    lanes = np.arange(rollers.shape[0] * LANES).reshape(-1, LANES)
    rollers[:, row.present] = lanes < count
    pitch = 2 * math.pi * np.minimum(lanes, count - 1) / count
    rollers[:, row.pitch_cosine], rollers[:, row.pitch_sine] = np.cos(pitch), np.sin(pitch)
    return rollers


@kernel
def look_up_contour(row, block, contour, rows):
    """Write cosine and sine of a block's azimuths and the contour's slope; return R_e [m] and its second derivative [m/rad^2]."""
    turn = load(rows, block, row.angle) * (0.5 / math.pi)
    turn -= floor(turn)
    cosine, sine = cosine_sine(turn)
    radius, slope, curvature = contour_lanes(contour, turn)
    store(rows, block, row.cosine, cosine)
    store(rows, block, row.sine, sine)
    store(rows, block, row.slope, slope)
    return radius, curvature


@kernel
def follow_contour(row, block, shift, contour, rows):
    """Let a block of rollers follow the contour for a time ``shift`` [s], as a predictor's first guess: r = known radius + shift R_e' phi'.

    Writes R_e as well; azimuths, orbital speeds and known radii have been written.
    """
    radius, _ = look_up_contour(row, block, contour, rows)
    store(rows, block, row.contour, radius)
    follows = load(rows, block, row.known_radius) + shift * load(rows, block, row.slope) * load(rows, block, row.orbital_speed)
    store(rows, block, row.radius, follows)


@kernel
def place_rollers(row, contact, ring, shaft_speed, inner_radius, params, rows, contacts):
    """Write directions about the displaced ring, penetrations, rolling and sliding speeds of all rollers.

    With a = (a_r, a_t) the roller's centre relative to the ring's and a' its velocity in a frame that does not turn,

        delta_i = R_i + R_w - |a|,   delta_i' = -n.a',   delta_e = r + R_w - R_e,   delta_e' = r' - R_e' phi',
        u_i = [(omega_i - phi') R_i + w R_w + phi' R_w]/2,   du_i = omega_i R_i - p.a' - w R_w,
        u_e = [phi' (r + R_w) + w R_w + phi' R_w]/2,         du_e = w R_w - r phi'.

    Parameters
    ----------
    ring : position y, z [m] and velocity y', z' [m/s] of the inner ring.
    shaft_speed : omega_i [rad/s].
    inner_radius : R_i, grown [m].
    params : of the bearing.
    rows, contacts : rows ``row`` and ``contact``; the rollers' states have been written.
    """
    raceways, roller_radius, blocks = params.raceways, params.rollers.radius, rows.shape[0]
    ring_y, ring_z, ring_y_speed, ring_z_speed = ring
    for block in range(blocks):
        radius, curvature = look_up_contour(row, block, raceways.contour, rows)
        store(rows, block, row.curvature, curvature)
        store(contacts, blocks + block, contact.penetration, load(rows, block, row.radius) + roller_radius - radius)
    for block in range(blocks):
        cosine, sine, radius = load(rows, block, row.cosine), load(rows, block, row.sine), load(rows, block, row.radius)
        orbital_speed, radial_speed = load(rows, block, row.orbital_speed), load(rows, block, row.radial_speed)
        apart_r, apart_t = radius - (ring_y * cosine + ring_z * sine), ring_y * sine - ring_z * cosine
        distance = square_root(apart_r * apart_r + apart_t * apart_t)
        inverse = 1.0 / distance
        n_r, n_t = apart_r * inverse, apart_t * inverse
        speed_r = radial_speed - (ring_y_speed * cosine + ring_z_speed * sine)
        speed_t = radius * orbital_speed - (ring_z_speed * cosine - ring_y_speed * sine)
        speed_normal, speed_tangent = n_r * speed_r + n_t * speed_t, n_r * speed_t - n_t * speed_r
        surface = load(rows, block, row.spin) * roller_radius
        rolling = surface + orbital_speed * roller_radius
        store(rows, block, row.normal_r, n_r)
        store(rows, block, row.normal_t, n_t)
        store(rows, block, row.inverse_distance, inverse)
        store(rows, block, row.speed_normal, speed_normal)
        store(rows, block, row.speed_tangent, speed_tangent)
        store(contacts, block, contact.penetration, inner_radius + roller_radius - distance)
        store(contacts, block, contact.rate, -speed_normal)
        store(contacts, block, contact.rolling, 0.5 * ((shaft_speed - orbital_speed) * inner_radius + rolling))
        store(contacts, block, contact.sliding, shaft_speed * inner_radius - speed_tangent - surface)
        outer = blocks + block
        store(contacts, outer, contact.rate, radial_speed - load(rows, block, row.slope) * orbital_speed)
        store(contacts, outer, contact.rolling, 0.5 * (orbital_speed * (radius + roller_radius) + rolling))
        store(contacts, outer, contact.sliding, surface - radius * orbital_speed)


@kernel
def carry_normal_forces(row, contact, runs, y, ring, evaluated_ring, count, rows, contacts):
    """Carry penetrations and normal forces from the state at which they were evaluated to ``y``, a correction of an iteration away, to first order.

    With d the changes of the ring's centre, the roller's radius and its azimuth, d delta_i = d_ring . n - dr and d delta_e = dr - R_e' dphi, where n
    is the direction outwards: that of the contact to a thousandth.

    Parameters
    ----------
    row, contact : rows of ``rows`` and ``contacts``, see the docstring of the module; rows of a prediction are overwritten.
    runs : `StateRuns` of the level.
    ring, evaluated_ring : position y, z [m] and velocity y', z' [m/s] of the inner ring in ``y`` and where forces were evaluated.
    count : of rollers.
    """
    spread_run(y, runs.first + runs.radius * count, count, rows, row.known_radius)
    spread_run(y, runs.first + runs.angle * count, count, rows, row.moved)
    spread_run(y, runs.first + runs.radial_speed * count, count, rows, row.known_speed)
    ring_y, ring_z = ring[0] - evaluated_ring[0], ring[1] - evaluated_ring[1]
    ring_y_speed, ring_z_speed = ring[2] - evaluated_ring[2], ring[3] - evaluated_ring[3]
    for block in range(rows.shape[0]):
        cosine, sine = load(rows, block, row.cosine), load(rows, block, row.sine)
        outwards = load(rows, block, row.known_radius) - load(rows, block, row.radius)
        faster = load(rows, block, row.known_speed) - load(rows, block, row.radial_speed)
        ahead = load(rows, block, row.moved) - load(rows, block, row.angle)
        deeper = ring_y * cosine + ring_z * sine - outwards
        _deepen(contact, block, deeper, ring_y_speed * cosine + ring_z_speed * sine - faster, contacts)
        _deepen(contact, rows.shape[0] + block, outwards - load(rows, block, row.slope) * ahead, faster, contacts)


@kernel
def _deepen(contact, block, deeper, faster, contacts):
    """Change penetrations [m] and their rates [m/s] of a block of contacts, and their normal forces to first order."""
    force = load(contacts, block, contact.load)
    force += load(contacts, block, contact.stiffness) * deeper + load(contacts, block, contact.damping) * faster
    store(contacts, block, contact.load, larger(force, 0.0))
    add(contacts, block, contact.penetration, deeper)
    add(contacts, block, contact.rate, faster)


@fused
def drag(raceways, lubrication, films, contacts):
    """Write tractions and resistances to rolling of aligned rollers and their derivatives; rows `bearing_sim.physics.contact.CONTACT`.

    Parameters
    ----------
    raceways : `bearing_sim.model.params.Raceways`.
    lubrication : `bearing_sim.model.params.Lubrication`.
    films : `bearing_sim.physics.mixed.FilmState`.
    contacts : load, rolling and sliding go in, and the penetration where rollers have a profile.
    """
    crowned = raceways.profile.crowned
    if crowned:
        concentrate(raceways.stiffness, raceways.profile, contacts)
    traction(contacts, lubrication.inner, lubrication.outer, films)
    if crowned:
        spread_tractions(contacts)
    if lubrication.rolling_resistance.on:
        resist_rolling(contacts, lubrication.rolling_resistance, films, crowned)


@kernel
def place_in_pockets(row, block, cage, cage_cosine, cage_sine, rows):
    """Write how a block of rollers lies in its pockets along the orbit; return s [m] and s' [m/s].

    With psi the angle from the pocket, at theta_c + 2 pi j/Z, to the roller and (c_r, c_t) the cage's centre in the pocket's frame,

        s = r sin psi - c_t,   s' = r' sin psi + r (phi' - omega_c) cos psi - c_t',   where c_t' = (velocity of the centre)_t - omega_c c_r.

    Parameters
    ----------
    cage : position y, z [m] and velocity y', z' [m/s] of the cage's centre, and omega_c [rad/s].
    cage_cosine, cage_sine : of the cage's angle theta_c.
    rows : rows ``row``; the rollers' states and azimuths have been written.
    """
    cage_y, cage_z, cage_y_speed, cage_z_speed, omega = cage
    pitch_cosine, pitch_sine = load(rows, block, row.pitch_cosine), load(rows, block, row.pitch_sine)
    pocket_cosine, pocket_sine = cage_cosine * pitch_cosine - cage_sine * pitch_sine, cage_sine * pitch_cosine + cage_cosine * pitch_sine
    cosine, sine = load(rows, block, row.cosine), load(rows, block, row.sine)
    play_cosine, play_sine = cosine * pocket_cosine + sine * pocket_sine, sine * pocket_cosine - cosine * pocket_sine
    radius, orbital_speed = load(rows, block, row.radius), load(rows, block, row.orbital_speed)
    cage_r, cage_t = cage_y * pocket_cosine + cage_z * pocket_sine, cage_z * pocket_cosine - cage_y * pocket_sine
    speed_t = cage_z_speed * pocket_cosine - cage_y_speed * pocket_sine
    offset = radius * play_sine - cage_t
    rate = load(rows, block, row.radial_speed) * play_sine + radius * play_cosine * (orbital_speed - omega) - speed_t + omega * cage_r
    store(rows, block, row.pocket_cosine, pocket_cosine)
    store(rows, block, row.pocket_sine, pocket_sine)
    store(rows, block, row.play_cosine, play_cosine)
    store(rows, block, row.play_sine, play_sine)
    store(rows, block, row.pocket_offset, offset)
    store(rows, block, row.pocket_rate, rate)
    return offset, rate


@kernel
def place_outwards(row, block, cage, guidance, rows):
    """Write how a block of rollers stands outwards in pockets that guide the cage; return that offset [m] and its rate [m/s].

    r cos psi - c_r less the radius of the pocket's middle; parameters as of `place_in_pockets`, which has been called, and ``guidance``
    as in `bearing_sim.model.params.Guidance`.
    """
    cage_y, cage_z, cage_y_speed, cage_z_speed, omega = cage
    p_c, p_s = load(rows, block, row.pocket_cosine), load(rows, block, row.pocket_sine)
    c, s = load(rows, block, row.play_cosine), load(rows, block, row.play_sine)
    radius, orbital_speed = load(rows, block, row.radius), load(rows, block, row.orbital_speed)
    cage_r = cage_y * p_c + cage_z * p_s
    speed_r = cage_y_speed * p_c + cage_z_speed * p_s
    offset = radius * c - cage_r - guidance.pocket_radius
    rate = load(rows, block, row.radial_speed) * c - radius * s * orbital_speed - speed_r + omega * load(rows, block, row.pocket_offset)
    store(rows, block, row.guide_offset, offset)
    store(rows, block, row.guide_rate, rate)
    return offset, rate


@fused
def linear_churning(cage_speed, shaft_speed, model):
    """Return the drag of mixture and bath on a roller, linearised about the cage's speed.

    Rollers orbit about as fast as the cage, so F(v) = F(v_c) + F'(v_c) (v - v_c), v_c = r_m omega_c, costs one evaluation for all of them.

    Returns
    -------
    F(v_c) [N], F'(v_c) [N s/m], and the derivative of F'(v_c) by cage speed [N s^2/(m rad)], taking F for the local power of v
    """
    pitch_radius = model.params.raceways.pitch_radius
    force, d_cage_speed = roller_drag(cage_speed, shaft_speed, model.params, model.lubrication)
    d_speed, speed = d_cage_speed / pitch_radius, pitch_radius * cage_speed
    bend = d_speed * (d_speed / force - 1.0 / speed) * pitch_radius if force != 0.0 else 0.0
    return force, d_speed, bend


@kernel
def observe_rollers(row, load_row, count, interval, rows, contacts, previous, sample):
    """Write the rollers' part of a flat sample, as far as both levels have it.

    Parameters
    ----------
    row, load_row : rows of the rollers, and the contacts' row of the normal force.
    interval : time since the previous sample [s].
    previous, sample : flat samples, see `bearing_sim.model.sample.flat`.
    """
    for j in range(count):
        first, block, lane = SCALARS + j, j // LANES, j % LANES
        spin = rows[block, row.spin, lane]
        sample[first + COLUMN.roller_angle * count] = rows[block, row.angle, lane]
        sample[first + COLUMN.roller_radius * count] = rows[block, row.radius, lane]
        sample[first + COLUMN.roller_spin * count] = spin
        rotation = first + COLUMN.roller_rotation * count
        sample[rotation] = previous[rotation] + 0.5 * (previous[first + COLUMN.roller_spin * count] + spin) * interval
        sample[first + COLUMN.inner_load * count] = contacts[block, load_row, lane]
        sample[first + COLUMN.outer_load * count] = contacts[rows.shape[0] + block, load_row, lane]
        sample[first + COLUMN.orbital_speed * count] = rows[block, row.orbital_speed, lane]
        sample[first + COLUMN.pocket_force * count] = rows[block, row.pocket_force, lane]


@kernel
def land_eccentricity(ring_y, ring_z, cage_y, cage_z, cage):
    """Return the eccentricity of the cage in what guides it, over its clearance; ``cage`` as in `bearing_sim.model.params.CageBody`."""
    turning = cage.guidance.turning
    return math.hypot(cage_y - turning * ring_y, cage_z - turning * ring_z) / cage.guide_clearance


@kernel
def restrain_rollers(row, contact, runs, y, change, params, rows, contacts):
    """Shorten an iteration's correction where it carries a roller across a bend that linear equations do not see.

    **Sliding.** Every law of traction is steep at pure rolling and flat far from it.  An iteration that starts in a flat part sees no more than that,
    overshoots to the flat part on the other side and comes back.  So a correction from a flat part across pure rolling ends at pure rolling, from
    where the next one finds the solution.  A law is flat where its slope is less than half of that of the chord from pure rolling (assumption).

    **Touching.** An open contact has no stiffness, so a correction that closes it overshoots to loads a hundred times too large; one that opens
    it leaves a free roller.  A correction across either way ends where roller and outer raceway barely touch.

    Parameters
    ----------
    row, contact : rows of ``rows`` and ``contacts``, see the docstring of the module.
    runs : `StateRuns` of the level.
    y, change : state after the correction, and the correction; changed.
    params : of the bearing.
    rows, contacts : of the state before the correction.
    """
    count = params.rollers.count
    radii, angles = runs.first + runs.radius * count, runs.first + runs.angle * count
    radial_speeds, orbits = runs.first + runs.radial_speed * count, runs.first + runs.orbital_speed * count
    spins = runs.first + runs.spin * count
    for j in range(count):
        block, lane = j // LANES, j % LANES
        orbit, spin = y[radii + j] * change[orbits + j], params.rollers.radius * change[spins + j]
        outer = contacts.shape[0] // 2 + block
        depth = contacts[outer, contact.penetration, lane]
        touching = _up_to_touching(depth, change[radii + j] - rows[block, row.slope, lane] * change[angles + j])
        rolling = min(
            slides_up_to_rolling(contact, contacts, block, lane, -orbit - spin),
            slides_up_to_rolling(contact, contacts, outer, lane, spin - orbit),
        )
        if touching < 1.0:
            _shorten(y, change, radii + j, touching)
            _shorten(y, change, radial_speeds + j, touching)
        if rolling < 1.0:
            _shorten(y, change, angles + j, rolling)
            _shorten(y, change, orbits + j, rolling)
            _shorten(y, change, spins + j, rolling)


@kernel
def average_stiffness(row, contact, fraction, rows, contacts, stiffness):
    """Include the stiffness at this instant of the raceways against a displacement of the inner ring in its running mean.

    The two contacts of a roller act in series; an open contact has no stiffness.

    Parameters
    ----------
    row, contact : rows of ``rows`` and ``contacts``, see the docstring of the module.
    fraction : weight of this instant; the first one counts as a whole.
    rows, contacts : of the rollers.
    stiffness : yy, yz and zz [N/m], zeros at first; changed in place.
    """
    blocks = rows.shape[0]
    yy, yz, zz = spread(0.0), spread(0.0), spread(0.0)
    for block in range(blocks):
        inner, outer = load(contacts, block, contact.stiffness), load(contacts, blocks + block, contact.stiffness)
        series = load(rows, block, row.present) * inner * outer / (inner + outer + _SOFTEST)
        cosine, sine = load(rows, block, row.cosine), load(rows, block, row.sine)
        yy += series * cosine * cosine
        yz += series * cosine * sine
        zz += series * sine * sine
    weight = fraction if stiffness[0] + stiffness[2] > 0.0 else 1.0
    stiffness[0] += weight * (total(yy) - stiffness[0])
    stiffness[1] += weight * (total(yz) - stiffness[1])
    stiffness[2] += weight * (total(zz) - stiffness[2])


@kernel
def _up_to_touching(depth, deepens):
    """Return the fraction of a change of a penetration [m] that leads to where bodies barely touch; 1 where it leads nowhere else."""
    if depth * (depth + deepens) >= 0.0 or abs(depth) <= _TOUCH or abs(depth + deepens) <= _TOUCH:
        return 1.0
    return (_TOUCH - depth) / deepens


@kernel
def slides_up_to_rolling(contact, contacts, block, lane, slides):
    """Return the fraction of a change of a sliding speed [m/s] that leads from a flat part of the law to pure rolling; 1 where it does not."""
    sliding = contacts[block, contact.sliding, lane]
    if sliding * (sliding + slides) >= 0.0:
        return 1.0
    if abs(contacts[block, contact.force, lane]) <= 2.0 * contacts[block, contact.d_sliding, lane] * abs(sliding):
        return 1.0
    return -sliding / slides


@kernel
def _shorten(y, change, i, fraction):
    """Take a fraction of the change of one state."""
    y[i] -= (1.0 - fraction) * change[i]
    change[i] *= fraction
