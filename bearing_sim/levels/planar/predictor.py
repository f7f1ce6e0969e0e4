# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""First guess of a stage's solution, so close that one Newton iteration is usually enough.

Almost all of a stage's nonlinearity is in the normal contacts of each roller, which open and close within a step.  With ring and orbit
extrapolated, each roller's radial equation

    r = known r + s r',   r' = known r' + s (r phi'^2 + (Q_i - Q_e)/m_r)

is scalar and rises monotonically: a few Newton iterations for all rollers at once cost a fraction of one iteration of the whole system.
"""

import math

from bearing_sim.levels.common.bending import predict_bending
from bearing_sim.levels.common.dynamic import extrapolate, write_guess
from bearing_sim.levels.common.model import inner_growth
from bearing_sim.levels.common.rollers import follow_contour
from bearing_sim.levels.planar.forces import normal_forces
from bearing_sim.levels.planar.state import BORDER, LAYOUT, PHI, PHI_SPEED, R_SPEED, RING_Y, RING_Z, ROLLER, ROLLERS, THETA, R
from bearing_sim.numerics.compilation import fused
from bearing_sim.numerics.simd import highest, larger, load, magnitude, spread, spread_run, square_root, store, where_positive
from bearing_sim.physics.contact import CONTACT

_ITERATIONS = 4
_SETTLED = 0.2  # of the position tolerance: what one iteration more would change is left to the iteration of the whole system


@fused
def _start(known, shift, guess, count, raceways, rows):
    """Write azimuths, the contour and the known terms of each radial equation; let the rollers follow the contour at first."""
    spread_run(guess, ROLLERS + PHI * count, count, rows, ROLLER.angle)
    spread_run(guess, ROLLERS + PHI_SPEED * count, count, rows, ROLLER.orbital_speed)
    spread_run(known, ROLLERS + R * count, count, rows, ROLLER.known_radius)
    spread_run(known, ROLLERS + R_SPEED * count, count, rows, ROLLER.known_speed)
    for block in range(rows.shape[0]):
        follow_contour(ROLLER, block, shift, raceways.contour, rows)
        store(rows, block, ROLLER.moved, math.inf)


@fused
def _balance(guess, shift, enough, inner_radius, params, rows, contacts):
    """Take one Newton step of the radial equations of those rollers whose last one was ``enough`` [m], and return the largest last step [m].

    The equation is that of the docstring of the module.
    """
    roller_radius, mass, blocks = params.rollers.radius, params.rollers.mass, rows.shape[0]
    per_shift = 1.0 / shift
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
    largest = spread(0.0)
    for block in range(blocks):
        outer = blocks + block
        radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        speed = (radius - load(rows, block, ROLLER.known_radius)) * per_shift
        stiffness = load(contacts, block, CONTACT.stiffness) + load(contacts, outer, CONTACT.stiffness)
        damping = load(contacts, block, CONTACT.damping) + load(contacts, outer, CONTACT.damping)
        force = load(contacts, outer, CONTACT.load) - load(contacts, block, CONTACT.load)
        force += mass * ((speed - load(rows, block, ROLLER.known_speed)) * per_shift - radius * orbital_speed * orbital_speed)
        change = force / (mass * per_shift * per_shift + damping * per_shift + stiffness)
        moved = load(rows, block, ROLLER.moved)
        goes_on = moved - enough  # each roller by itself: a guess depends on no other roller
        store(rows, block, ROLLER.radius, radius - where_positive(goes_on, change, 0.0))
        moved = where_positive(goes_on, magnitude(change), moved)
        store(rows, block, ROLLER.moved, moved)
        largest = larger(largest, moved)
    return highest(largest)


@fused
def predict(known, shift, slope, model, work, guess):
    """Write a first guess of the solution of guess = known + shift f(guess).

    Parameters
    ----------
    known : what the stage builds on.
    shift : gamma h [s].
    slope : f a little earlier, or zeros.
    model, work : of the level.
    guess : takes the guess.
    """
    params, rows = model.params, work.rollers
    count = params.rollers.count
    inner_radius = params.raceways.inner_radius + inner_growth(model.drive.shaft_speed, model)  # where the inputs start: a guess needs no more
    extrapolate(LAYOUT, known, shift, slope, count, guess)
    _start(known, shift, guess, count, params.raceways, rows)
    predict_bending(ROLLER, guess[THETA], guess[BORDER + THETA], work.bent_at[0], rows, work.bending)
    enough = _SETTLED * model.tolerances.position
    for _ in range(_ITERATIONS):
        if _balance(guess, shift, enough, inner_radius, params, rows, work.contacts) < enough:
            break
    write_guess(LAYOUT, R, ROLLER.radius, ROLLER.known_radius, known, shift, count, rows, guess)
