# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A roller in its pocket, sliced (Deng 2017, eq. 9 to 12); ``LANES`` rollers at a time (a block).

A slice at x stands s + skew x off the middle of its pocket.  Within the clearance the film's spring is linear, so that its sums
over slices are known beforehand; slices that reach the wall add line contact.  Left out: the roller's crown against the wall, and
that slices on both walls rub on both (friction goes with the force of all slices together).
"""

from bearing_sim.kernels.cage import FRICTION_SPIN
from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.contact import EXPONENT
from bearing_sim.kernels.lanes import larger, load, magnitude, spread, square_root, store, total, where_positive
from bearing_sim.levels.spatial_algebra import BORDER
from bearing_sim.levels.spatial_slices import slice_force
from bearing_sim.levels.spatial_state import CAGE_TILT_Y, CAGE_TILT_Z, CAGE_Y, CAGE_Z, OMEGA, ROLLER


@kernel
def place_in_pockets(block, y, cage_cosine, cage_sine, rows):
    """Write how a block of rollers lies in its pockets.

    Parameters
    ----------
    y : state.
    cage_cosine, cage_sine : of the cage's angle.
    rows : of the rollers, see `bearing_sim.levels.spatial_state.ROLLER`.
    """
    pitch_cosine, pitch_sine = load(rows, block, ROLLER.pitch_cosine), load(rows, block, ROLLER.pitch_sine)
    p_c, p_s = cage_cosine * pitch_cosine - cage_sine * pitch_sine, cage_sine * pitch_cosine + cage_cosine * pitch_sine
    cosine, sine = load(rows, block, ROLLER.cosine), load(rows, block, ROLLER.sine)
    play_cosine, play_sine = cosine * p_c + sine * p_s, sine * p_c - cosine * p_s
    radius, omega = load(rows, block, ROLLER.radius), y[OMEGA]
    turning = load(rows, block, ROLLER.orbital_speed) - omega
    cage_r, cage_t = y[CAGE_Y] * p_c + y[CAGE_Z] * p_s, y[CAGE_Z] * p_c - y[CAGE_Y] * p_s
    speed_t = y[BORDER + CAGE_Z] * p_c - y[BORDER + CAGE_Y] * p_s
    store(rows, block, ROLLER.pocket_cosine, p_c)
    store(rows, block, ROLLER.pocket_sine, p_s)
    store(rows, block, ROLLER.play_cosine, play_cosine)
    store(rows, block, ROLLER.play_sine, play_sine)
    store(rows, block, ROLLER.pocket_offset, radius * play_sine - cage_t)
    rate = load(rows, block, ROLLER.radial_speed) * play_sine + radius * play_cosine * turning - speed_t + omega * cage_r
    store(rows, block, ROLLER.pocket_rate, rate)
    # the axes' inclinations are to the bodies' tilting what places are to their moving
    tilt, skew = load(rows, block, ROLLER.tilt), load(rows, block, ROLLER.skew)
    outwards, along = tilt * play_cosine - skew * play_sine, tilt * play_sine + skew * play_cosine
    lean_r, lean_t = y[CAGE_TILT_Y] * p_c + y[CAGE_TILT_Z] * p_s, y[CAGE_TILT_Z] * p_c - y[CAGE_TILT_Y] * p_s
    lean_speed_t = y[BORDER + CAGE_TILT_Z] * p_c - y[BORDER + CAGE_TILT_Y] * p_s
    store(rows, block, ROLLER.pocket_lean, outwards - lean_r)
    store(rows, block, ROLLER.pocket_skew, along - lean_t)
    rate = load(rows, block, ROLLER.tilt_speed) * play_sine + load(rows, block, ROLLER.skew_speed) * play_cosine + turning * outwards
    store(rows, block, ROLLER.pocket_skew_rate, rate - lean_speed_t + omega * lean_r)


@template
def hold_slices(offset, rate, skew, skew_rate, clearance, stiffness, params):
    """Return force and moment of two opposite walls, then sums over slices of the force's slopes by offset and by rate, each times 1, x, x^2.

    Parameters
    ----------
    offset, rate : of the roller's middle from the middle between the walls [m], and its time derivative (lanes).
    skew, skew_rate : inclination of the roller between them, and its time derivative (lanes).
    clearance : to either wall [m].
    stiffness : of the film within it [N/m].
    params : of the bearing.
    """
    places, damping = params.slices.places, params.cage.pocket_damping
    count = places.shape[0]
    width = 2.0 * places[count - 1] / (count - 1) if count > 1 else 0.0
    square = width * width * (count * count - 1) / 12.0  # mean of x^2 over slices
    k_0, k_1, k_2 = spread(stiffness), spread(0.0), spread(stiffness * square)
    d_0, d_1, d_2 = spread(damping), spread(0.0), spread(damping * square)
    force, moment = stiffness * offset + damping * rate, square * (stiffness * skew + damping * skew_rate)
    excess = magnitude(offset) + magnitude(skew) * places[count - 1] - clearance
    if total(where_positive(excess, 1.0, 0.0)) > 0.0:
        part, film = params.raceways.stiffness / count, stiffness / count
        for k in range(count):
            x = places[k]
            place = offset + skew * x
            side, excess = where_positive(place, 1.0, -1.0), magnitude(place) - clearance
            wall, root, factor, pressed = slice_force(excess, (rate + skew_rate * x) * side, part, params.ring.contact_damping)
            more = side * (wall - film * larger(excess, 0.0))
            stiffer = EXPONENT * pressed * root * factor - where_positive(excess, film, 0.0)
            damped = params.ring.contact_damping * pressed * root * excess
            force += more
            moment += more * x
            k_0 += stiffer
            k_1 += stiffer * x
            k_2 += stiffer * x * x
            d_0 += damped
            d_1 += damped * x
            d_2 += damped * x * x
    return force, moment, k_0, k_1, k_2, d_0, d_1, d_2


@kernel
def pocket_forces(block, params, rows):
    """Write what the pockets do to a block of rollers that has been placed in them.

    Parameters
    ----------
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.spatial_state.ROLLER`.
    """
    cage, spin = params.cage, load(rows, block, ROLLER.spin)
    offset, rate = load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_rate)
    skew, skew_rate = load(rows, block, ROLLER.pocket_skew), load(rows, block, ROLLER.pocket_skew_rate)
    force, moment, k_0, k_1, k_2, d_0, d_1, d_2 = hold_slices(offset, rate, skew, skew_rate, cage.pocket_clearance, cage.pocket_stiffness, params)
    smooth = 1.0 / square_root(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
    store(rows, block, ROLLER.pocket_force, -force)
    store(rows, block, ROLLER.pocket_moment, -moment)
    store(rows, block, ROLLER.pocket_stiffness, k_0)
    store(rows, block, ROLLER.pocket_stiffness + 1, k_1)
    store(rows, block, ROLLER.pocket_stiffness + 2, k_2)
    store(rows, block, ROLLER.pocket_damping, d_0)
    store(rows, block, ROLLER.pocket_damping + 1, d_1)
    store(rows, block, ROLLER.pocket_damping + 2, d_2)
    store(rows, block, ROLLER.pocket_friction, cage.pocket_friction * spin * smooth)
    store(rows, block, ROLLER.pocket_friction_slope, (cage.pocket_friction * FRICTION_SPIN * FRICTION_SPIN) * smooth * smooth * smooth)
