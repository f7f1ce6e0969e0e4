# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""First guess of a stage's solution, as at level ``planar`` (see `bearing_sim.levels.planar.predictor`).

With ring, cage, orbit and skew extrapolated, each roller's position and tilt follow from two scalar equations of its
own normal contacts: a few Newton iterations of all rollers at once.
"""

import math

from bearing_sim.levels.common.bending import predict_bending
from bearing_sim.levels.common.dynamic import extrapolate, write_guess
from bearing_sim.levels.common.model import inner_growth
from bearing_sim.levels.common.rollers import follow_contour
from bearing_sim.levels.spatial.forces import press_axially
from bearing_sim.levels.spatial.slices import press_normally
from bearing_sim.levels.spatial.state import (
    BORDER,
    LAYOUT,
    PHI,
    PHI_SPEED,
    R_SPEED,
    RING_TILT_Y,
    RING_TILT_Z,
    RING_Y,
    RING_Z,
    ROLLER,
    ROLLERS,
    SKEW,
    SKEW_SPEED,
    SLICED,
    SPIN,
    THETA,
    TILT,
    TILT_SPEED,
    R,
)
from bearing_sim.numerics.compilation import fused
from bearing_sim.numerics.simd import highest, larger, load, magnitude, spread_run, square_root, store, where_positive

_ITERATIONS = 4
_SETTLED = 0.2  # of the position tolerance: what one iteration more would change is left to the iteration of the whole system


@fused
def _start(known, shift, guess, count, raceways, rows):
    """Write azimuths, the contour and the known terms of each equation; let the rollers follow the contour at first."""
    spread_run(guess, ROLLERS + PHI * count, count, rows, ROLLER.angle)
    spread_run(guess, ROLLERS + PHI_SPEED * count, count, rows, ROLLER.orbital_speed)
    spread_run(guess, ROLLERS + SPIN * count, count, rows, ROLLER.spin)
    spread_run(guess, ROLLERS + TILT * count, count, rows, ROLLER.tilt)
    spread_run(guess, ROLLERS + SKEW * count, count, rows, ROLLER.skew)
    spread_run(guess, ROLLERS + SKEW_SPEED * count, count, rows, ROLLER.skew_speed)
    spread_run(known, ROLLERS + R * count, count, rows, ROLLER.known_radius)
    spread_run(known, ROLLERS + R_SPEED * count, count, rows, ROLLER.known_speed)
    spread_run(known, ROLLERS + TILT * count, count, rows, ROLLER.known_tilt)
    spread_run(known, ROLLERS + TILT_SPEED * count, count, rows, ROLLER.known_tilt_speed)
    for block in range(rows.shape[0]):
        follow_contour(ROLLER, block, shift, raceways.contour, rows)
        store(rows, block, ROLLER.moved, math.inf)


@fused
def _place(block, guess, shift, inner_radius, params, rows, contacts):
    """Write penetrations, leans and their rates of a block of rollers."""
    roller_radius, outer = params.rollers.radius, rows.shape[0] + block
    per_shift = 1.0 / shift
    cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    radius, tilt = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.tilt)
    along, across = guess[RING_Y] * cosine + guess[RING_Z] * sine, guess[RING_Z] * cosine - guess[RING_Y] * sine
    speed = (radius - load(rows, block, ROLLER.known_radius)) * per_shift
    tilt_speed = (tilt - load(rows, block, ROLLER.known_tilt)) * per_shift
    distance = square_root((radius - along) * (radius - along) + across * across)
    store(contacts, block, SLICED.penetration, inner_radius + roller_radius - distance)
    store(contacts, block, SLICED.rate, guess[BORDER + RING_Y] * cosine + guess[BORDER + RING_Z] * sine - speed)
    store(contacts, block, SLICED.lean, guess[RING_TILT_Y] * cosine + guess[RING_TILT_Z] * sine - tilt)
    turning = load(rows, block, ROLLER.orbital_speed) * (guess[RING_TILT_Z] * cosine - guess[RING_TILT_Y] * sine)
    leaning = guess[BORDER + RING_TILT_Y] * cosine + guess[BORDER + RING_TILT_Z] * sine + turning
    store(contacts, block, SLICED.lean_rate, leaning - tilt_speed)
    store(contacts, outer, SLICED.penetration, radius + roller_radius - load(rows, block, ROLLER.contour))
    store(contacts, outer, SLICED.rate, speed - load(rows, block, ROLLER.slope) * load(rows, block, ROLLER.orbital_speed))
    store(contacts, outer, SLICED.lean, tilt)
    store(contacts, outer, SLICED.lean_rate, tilt_speed)


@fused
def _balance(block, shift, enough, params, rows, contacts):
    """Take one Newton step of those rollers whose last one moved them or their ends by ``enough`` [m], and return the largest last step [m].

    r'' and tilt'' are those of the normal forces, orbit and spin are as they are.
    """
    mass, inertia, outer, per_shift = params.rollers.mass, params.tilts.roller_inertia, rows.shape[0] + block, 1.0 / shift
    radius, tilt, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.orbital_speed)
    speed = (radius - load(rows, block, ROLLER.known_radius)) * per_shift
    tilt_speed = (tilt - load(rows, block, ROLLER.known_tilt)) * per_shift
    force = load(contacts, outer, SLICED.load) - load(contacts, block, SLICED.load)
    force += mass * ((speed - load(rows, block, ROLLER.known_speed)) * per_shift - radius * orbital_speed * orbital_speed)
    gyroscopic = params.variants.gyroscopic * params.rollers.inertia * load(rows, block, ROLLER.spin)
    moment = load(contacts, outer, SLICED.tilting) - load(contacts, block, SLICED.tilting)
    moment += inertia * (tilt_speed - load(rows, block, ROLLER.known_tilt_speed)) * per_shift
    moment -= (gyroscopic + 2.0 * inertia * orbital_speed) * load(rows, block, ROLLER.skew_speed)
    moment -= (gyroscopic + inertia * orbital_speed) * orbital_speed * tilt
    a = mass * per_shift * per_shift + load(contacts, outer, SLICED.stiffness) + load(contacts, block, SLICED.stiffness)
    a += per_shift * (load(contacts, outer, SLICED.damping) + load(contacts, block, SLICED.damping))
    b = load(contacts, outer, SLICED.stiffness + 1) + load(contacts, block, SLICED.stiffness + 1)
    b += per_shift * (load(contacts, outer, SLICED.damping + 1) + load(contacts, block, SLICED.damping + 1))
    d = inertia * per_shift * per_shift + load(contacts, outer, SLICED.stiffness + 2) + load(contacts, block, SLICED.stiffness + 2)
    d += per_shift * (load(contacts, outer, SLICED.damping + 2) + load(contacts, block, SLICED.damping + 2))
    inverse = 1.0 / (a * d - b * b)
    outwards, tilting = (d * force - b * moment) * inverse, (a * moment - b * force) * inverse
    moved = load(rows, block, ROLLER.moved)
    goes_on = moved - enough  # each roller by itself: a guess depends on no other roller that happens to stand in the same block
    store(rows, block, ROLLER.radius, radius - where_positive(goes_on, outwards, 0.0))
    store(rows, block, ROLLER.tilt, tilt - where_positive(goes_on, tilting, 0.0))
    moved = where_positive(goes_on, larger(magnitude(outwards), magnitude(tilting) * (0.5 * params.rollers.length)), moved)
    store(rows, block, ROLLER.moved, moved)
    return highest(moved)


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
    params, rows, contacts = model.params, work.rollers, work.contacts
    count, blocks = params.rollers.count, work.rollers.shape[0]
    inner_radius = params.raceways.inner_radius + inner_growth(model.drive.shaft_speed, model)  # as at level `planar`
    enough = _SETTLED * model.tolerances.position
    extrapolate(LAYOUT, known, shift, slope, count, guess)
    _start(known, shift, guess, count, params.raceways, rows)
    predict_bending(ROLLER, guess[THETA], guess[BORDER + THETA], work.bent_at[0], rows, work.bending)
    for _ in range(_ITERATIONS):
        settled = True
        for block in range(blocks):
            if highest(load(rows, block, ROLLER.moved)) < enough:
                continue
            _place(block, guess, shift, inner_radius, params, rows, contacts)
            press_normally(block, contacts, params.slices, work.points, params.raceways.stiffness, params.raceways.damping)
            press_normally(blocks + block, contacts, params.slices, work.points, params.raceways.stiffness, params.raceways.damping)
        if params.flanges.load > 0.0:
            press_axially(params, rows, contacts)
        for block in range(blocks):
            if not highest(load(rows, block, ROLLER.moved)) < enough:
                settled = _balance(block, shift, enough, params, rows, contacts) < enough and settled
        if settled:
            break
    write_guess(LAYOUT, R, ROLLER.radius, ROLLER.known_radius, known, shift, count, rows, guess)
    write_guess(LAYOUT, TILT, ROLLER.tilt, ROLLER.known_tilt, known, shift, count, rows, guess)
