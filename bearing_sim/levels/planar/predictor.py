# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""First guess of a stage's solution, so close that one Newton iteration is usually enough.

Almost all of a stage's nonlinearity is in the normal contacts, which open and close within a step.  With cage, orbit and spins extrapolated,
each roller's radial equation and those of the ring's centre x,

    r = known r + s r',   r' = known r' + s (r phi'^2 + (Q_i - Q_e)/m_r),
    x = known x + s x',   x' = known x' + s (F - sum of Q_i e_r)/m_i,

are scalar per roller but for the two unknowns of the ring that they share: a few Newton steps, from which the rollers are eliminated one by
one, cost a fraction of one iteration of the whole system (see `bearing_sim.levels.common.prediction`).  A ring on an elastic support keeps its
extrapolated place.
"""

from bearing_sim.levels.common.model import inner_growth
from bearing_sim.levels.common.prediction import ITERATIONS, SETTLED, UNSETTLED, free_ring, goes_on_above, move_ring
from bearing_sim.levels.common.rollers import follow_contour
from bearing_sim.levels.common.support import extrapolate_support
from bearing_sim.levels.planar.forces import normal_forces
from bearing_sim.levels.planar.state import BLOCK, BORDER, PHI, PHI_SPEED, R_SPEED, RING_Y, RING_Z, ROLLER, ROLLERS, R
from bearing_sim.numerics.compilation import fused
from bearing_sim.numerics.simd import (
    LANES,
    highest,
    larger,
    load,
    magnitude,
    spread,
    spread_run,
    square_root,
    store,
    store_run,
    total,
    where_positive,
)
from bearing_sim.physics.contact import CONTACT


@fused
def _extrapolate(known, shift, slope, count, guess):
    """Extrapolate speeds by their rates, and write the positions that belong to them."""
    for k in range(BORDER):
        guess[BORDER + k] = known[BORDER + k] + shift * slope[BORDER + k]
        guess[k] = known[k] + shift * guess[BORDER + k]
    for j in range(ROLLERS + 3 * count, ROLLERS + 5 * count):
        guess[j] = known[j] + shift * slope[j]
    for j in range(ROLLERS + count, ROLLERS + 2 * count):
        guess[j] = known[j] + shift * guess[j + 2 * count]
    extrapolate_support(known, shift, slope, ROLLERS + BLOCK * count, guess)


@fused
def _start(known, shift, guess, count, raceways, rows):
    """Write azimuths, the contour and the known terms of each radial equation; let the rollers follow the contour at first."""
    spread_run(guess, ROLLERS + PHI * count, count, rows, ROLLER.angle)
    spread_run(guess, ROLLERS + PHI_SPEED * count, count, rows, ROLLER.orbital_speed)
    spread_run(known, ROLLERS + R * count, count, rows, ROLLER.known_radius)
    spread_run(known, ROLLERS + R_SPEED * count, count, rows, ROLLER.known_speed)
    for block in range(rows.shape[0]):
        follow_contour(ROLLER, block, shift, raceways.contour, rows)
        store(rows, block, ROLLER.moved, UNSETTLED)


@fused
def _press(guess, shift, inner_radius, params, rows, contacts):
    """Write the normal forces of all rollers where the guess has them, and their derivatives."""
    roller_radius, blocks, per_shift = params.rollers.radius, rows.shape[0], 1.0 / shift
    for block in range(blocks):
        radius, cosine, sine = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        along, across = guess[RING_Y] * cosine + guess[RING_Z] * sine, guess[RING_Z] * cosine - guess[RING_Y] * sine
        speed = (radius - load(rows, block, ROLLER.known_radius)) * per_shift
        distance = square_root((radius - along) * (radius - along) + across * across)
        store(contacts, block, CONTACT.penetration, inner_radius + roller_radius - distance)
        store(contacts, block, CONTACT.rate, guess[BORDER + RING_Y] * cosine + guess[BORDER + RING_Z] * sine - speed)
        store(contacts, blocks + block, CONTACT.penetration, radius + roller_radius - load(rows, block, ROLLER.contour))
        rate = speed - load(rows, block, ROLLER.slope) * load(rows, block, ROLLER.orbital_speed)
        store(contacts, blocks + block, CONTACT.rate, rate)
    normal_forces(params, contacts)


@fused
def _eliminate(shift, params, rows, contacts):
    """Write by how much each roller moves in a Newton step, alone and with the ring, and return what all do to the ring.

    With f the residual of a roller's radial equation, a and -k its derivatives by the roller's radius and by the ring's displacement x along
    e_r, a Newton step of the roller is (k e_r.x - f)/a.  Put into Q_i, this leaves of the sum of Q_i e_r in the ring's equations M x - b.

    Returns
    -------
    M_yy, M_yz, M_zz [N/m], b_y, b_z [N]
    """
    mass, blocks, per_shift = params.rollers.mass, rows.shape[0], 1.0 / shift
    m_yy, m_yz, m_zz, b_y, b_z = spread(0.0), spread(0.0), spread(0.0), spread(0.0), spread(0.0)
    for block in range(blocks):
        outer = blocks + block
        radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        speed = (radius - load(rows, block, ROLLER.known_radius)) * per_shift
        pressed = load(contacts, block, CONTACT.load)
        by_ring = load(contacts, block, CONTACT.stiffness) + load(contacts, block, CONTACT.damping) * per_shift
        by_radius = by_ring + load(contacts, outer, CONTACT.stiffness) + load(contacts, outer, CONTACT.damping) * per_shift
        residual = load(contacts, outer, CONTACT.load) - pressed
        residual += mass * ((speed - load(rows, block, ROLLER.known_speed)) * per_shift - radius * orbital_speed * orbital_speed)
        inverse = 1.0 / (mass * per_shift * per_shift + by_radius)
        store(rows, block, ROLLER.moves_alone, -residual * inverse)
        follows = by_ring * inverse
        store(rows, block, ROLLER.follows_ring, follows)
        present, cosine, sine = load(rows, block, ROLLER.present), load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
        stiffness = present * (by_ring - by_ring * follows)
        pushed = present * (residual * follows + pressed)
        m_yy += stiffness * cosine * cosine
        m_yz += stiffness * cosine * sine
        m_zz += stiffness * sine * sine
        b_y -= pushed * cosine
        b_z -= pushed * sine
    return total(m_yy), total(m_yz), total(m_zz), total(b_y), total(b_z)


@fused
def _balance(known, shift, ring_load, ring_step, enough, guess, inner_radius, params, rows, contacts):
    """Take one Newton step of the equations of the docstring of the module.

    Parameters
    ----------
    ring_load : F, y and z [N], and whether the ring moves, see `bearing_sim.levels.common.prediction.free_ring`.
    ring_step : last step of the ring [m].
    enough : what has taken a step shorter than this [m] stays.

    Returns
    -------
    last step of the ring, largest last step of a roller [m]
    """
    _press(guess, shift, inner_radius, params, rows, contacts)
    sums = _eliminate(shift, params, rows, contacts)
    y, z, threshold = 0.0, 0.0, goes_on_above(ring_step, enough)
    if threshold < 0.0:
        y, z = move_ring(known, shift, guess, BORDER, ring_load, params.ring.mass, sums)
        ring_step = max(abs(y), abs(z))
    largest = spread(0.0)
    for block in range(rows.shape[0]):
        moved = load(rows, block, ROLLER.moved)
        along = y * load(rows, block, ROLLER.cosine) + z * load(rows, block, ROLLER.sine)
        change = load(rows, block, ROLLER.moves_alone) + load(rows, block, ROLLER.follows_ring) * along
        change = where_positive(moved - threshold, change, 0.0)
        store(rows, block, ROLLER.radius, load(rows, block, ROLLER.radius) + change)
        moved = where_positive(moved - threshold, magnitude(change), moved)
        store(rows, block, ROLLER.moved, moved)
        largest = larger(largest, moved)
    return ring_step, highest(largest)


@fused
def predict(t, known, shift, slope, model, work, guess):
    """Write a first guess of the solution of guess = known + shift f(t, guess).

    Parameters
    ----------
    t : time of the stage [s].
    known : what the stage builds on.
    shift : gamma h [s].
    slope : f a little earlier, or zeros.
    model, work : of the level.
    guess : takes the guess.
    """
    params, rows = model.params, work.rollers
    count = params.rollers.count
    inner_radius = params.raceways.inner_radius + inner_growth(model.drive.shaft_speed, model)  # where the inputs start: a guess needs no more
    _extrapolate(known, shift, slope, count, guess)
    _start(known, shift, guess, count, params.raceways, rows)
    enough, ring_load, ring_step = SETTLED * model.tolerances.position, free_ring(t, model, work.support), UNSETTLED
    for _ in range(ITERATIONS):
        ring_step, largest = _balance(known, shift, ring_load, ring_step, enough, guess, inner_radius, params, rows, work.contacts)
        if ring_step < enough and largest < enough:
            break
    per_shift, whole = 1.0 / shift, count // LANES
    for block in range(whole):
        radius, roller = load(rows, block, ROLLER.radius), ROLLERS + block * LANES
        store_run(guess, roller + R * count, radius)
        store_run(guess, roller + R_SPEED * count, (radius - load(rows, block, ROLLER.known_radius)) * per_shift)
    for j in range(whole * LANES, count):
        roller = ROLLERS + j
        guess[roller] = rows[whole, ROLLER.radius, j - whole * LANES]
        guess[roller + R_SPEED * count] = (guess[roller] - known[roller]) * per_shift
