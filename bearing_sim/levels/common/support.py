# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What carries the bearing at the dynamic levels: an outer ring on springs and dampers, a shaft behind a spring, an unbalance.

**Frame.** Ring, cage, rollers and shaft are described from the centre O of the outer ring, so that contacts, pockets and lands do not know
that it moves.  The frame accelerates at a_O, and every body in it at -a_O less than the forces on it say:

    m_O a_O   = R - k_O x_O - c_O v_O - f(x_O, v_O),     R = F - sum of m_b a_b,
    m_i x_i'' = ... + k (x_s - x_i) + c (v_s - v_i) - m_i a_O,
    m_s x_s'' = F + U - k (x_s - x_i) - c (v_s - v_i) - m_s a_O,

x_O the outer ring's displacement in space, f the force of a squeeze film, F the load, U the force of the unbalance; R is what the bearing
does to the outer ring: what the load F and the forces a_b of the bodies' own equations leave of it, because forces between bodies cancel.  So no
force is written down twice, momentum is conserved, and what the mixture brakes the outer ring's housing takes up.  Where the shaft is rigid on
the ring, F and U act on the ring and there is no x_s; where the outer ring is rigid in space, a_O = 0.

**State.** Behind the rollers' states stand x_O, x_s (y and z each) and their speeds: `TAIL` numbers.  Without a support there are none.

**Linear algebra.** With a_O = alpha held, (I - s J) x = b is the block arrow of the level and, for each direction, one scalar equation of the
shaft, eliminated into the ring's row in closed form.  alpha itself is linear in all states, alpha = V x: a correction of rank two (M. A. Woodbury,
Inverting modified matrices, Princeton, 1950),

    x = x_0 + W (I - V W)^-1 V x_0,    (I - s J_0) x_0 = b,    (I - s J_0) W = s U,

U what a unit of alpha does to every state's rate.  It costs two more solutions for each factorisation.
"""

import math

import numpy as np

from bearing_sim.levels.common.model import load_at, shaft_angle_at, shaft_speed_at
from bearing_sim.model.params import SUPPORT
from bearing_sim.model.sample import COLUMN
from bearing_sim.numerics.block_arrow import factor, solve
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.simd import LANES, add, load, spread, total
from bearing_sim.physics.squeeze_film import SqueezeFilm, squeeze_force

OUTER, SHAFT, SPEEDS = 0, 2, 4  # where the outer ring and the shaft begin in the tail of a state, y and z each, and where their speeds begin
TAIL = 8


# Rows of the memory, an array of shape (7, n), n the states of the level with the tail; two for y and z each.  It is one array, because every
# array and every number in a level's memory is passed to every kernel anew.
REACTION = 0  # V, derivatives of a_O by every state
FOLLOWING = 2  # U, derivatives of every state's rate by a_O
RESPONSE = 4  # W
_NUMBERS = 6  # numbers that are not of a state, at the columns below
_ROWS = 7
_FRAME = 0  # a_O, y and z [m/s^2]
_YIELDING = 2  # (I - V W)^-1, row by row
_SHIFT = 6  # s of the last factorisation
_CHAIN = 7  # by direction: k/m_i, c/m_i, k/m_s and c/m_s of the last Jacobian, then what a factorisation makes of them
_BY_RING, _DAMPED_RING, _BY_SHAFT, _DAMPED_SHAFT, _ON_RING, _ON_SHAFT, _CHAIN_NUMBERS = range(7)


def new_support(support, size: int) -> np.ndarray:
    """Return the memory for a support (see `bearing_sim.model.params.SUPPORT`) behind ``size`` states of the level; empty without one."""
    return np.zeros((_ROWS, size + TAIL) if support[SUPPORT.active] else (0, 0))


def tail_of(support) -> int:
    """Return how many states a support adds to a level's."""
    return TAIL if support[SUPPORT.active] else 0


def place_support(params, state, ring, given) -> None:
    """Enter where load and springs hold the outer ring and the shaft into the tail of a state, in place.

    Parameters
    ----------
    ring : y, z of the inner ring from the outer ring's centre [m].
    given : load y, z [N].
    """
    support = params.support
    if not support[SUPPORT.active]:
        return
    tail = state[-TAIL:]
    for axis in range(2):
        outer, shaft = support[SUPPORT.outer_stiffness + axis], support[SUPPORT.shaft_stiffness + axis]
        tail[OUTER + axis] = given[axis] / outer if support[SUPPORT.outer_moves] else 0.0
        tail[SHAFT + axis] = ring[axis] + given[axis] / shaft if support[SUPPORT.shaft_bends] else 0.0


def resume_support(params, state, sample) -> None:
    """Enter where a sample has the outer ring and the shaft into the tail of a state, in place; they start at rest."""
    support = params.support
    if not support[SUPPORT.active]:
        return
    tail = state[-TAIL:]
    for axis, name in enumerate("yz"):
        outer = sample[f"outer_ring_{name}"] if support[SUPPORT.outer_moves] else 0.0
        tail[OUTER + axis] = outer
        tail[SHAFT + axis] = sample[f"shaft_{name}"] - outer if support[SUPPORT.shaft_bends] else 0.0


@kernel
def unbalance_at(t, model):
    """Return the force of the unbalance [N]: what its mass at the eccentricity (cos, sin) of the shaft's angle resists with.

    m e (w^2 cos + w' sin, w^2 sin - w' cos), w the shaft's speed.
    """
    drive, support = model.drive, model.params.support
    angle, speed, amount = shaft_angle_at(t, drive) + support[SUPPORT.unbalance_angle], shaft_speed_at(t, drive), support[SUPPORT.unbalance]
    cosine, sine = math.cos(angle), math.sin(angle)
    square, changing = speed * speed, drive.shaft_acceleration
    return amount * (square * cosine + changing * sine), amount * (square * sine - changing * cosine)


@kernel
def _chain(axis):
    """Return where the numbers of the chain in a direction begin and end."""
    first = _CHAIN + axis * _CHAIN_NUMBERS
    return first, first + _CHAIN_NUMBERS


@kernel
def frame_of(work):
    """Return a_O [m/s^2], y and z."""
    return work[_NUMBERS, _FRAME], work[_NUMBERS, _FRAME + 1]


@kernel
def _film_force(y, model):
    """Return `squeeze_force` of the film around the outer ring."""
    tail, support = y.shape[0] - TAIL, model.params.support
    film = SqueezeFilm(support[SUPPORT.film_geometry], support[SUPPORT.film_clearance])
    outer, speeds = tail + OUTER, tail + SPEEDS + OUTER
    return squeeze_force(y[outer], y[outer + 1], y[speeds], y[speeds + 1], model.lubrication.viscosity, film)


@kernel
def support_accelerations(t, y, border, cage, momentum_y, momentum_z, model, rate, work):
    """Write the rates of the tail and a_O, and add what the support does to ring and cage; the rollers follow in the level.

    Parameters
    ----------
    border, cage : how many positions the border has, and which of them is the cage's y; the ring's y and z are the first.
    momentum_y, momentum_z : sum of m_b a_b of ring, cage and rollers by the level's equations, with the load on the ring [N].
    rate : the level's part is written; changed.
    work : memory of the support.
    """
    support = model.params.support
    bends, moves = support[SUPPORT.shaft_bends], support[SUPPORT.outer_moves]
    ring_mass, tail = model.params.ring.mass, y.shape[0] - TAIL
    given, momentum, unbalance = load_at(t, model.drive), (momentum_y, momentum_z), unbalance_at(t, model)
    pressed = _film_force(y, model)
    for axis in range(2):
        stiffness, damping = support[SUPPORT.shaft_stiffness + axis], support[SUPPORT.shaft_damping + axis]
        carried, damped = support[SUPPORT.outer_stiffness + axis], support[SUPPORT.outer_damping + axis]
        outer_speed, shaft_speed = y[tail + SPEEDS + OUTER + axis], y[tail + SPEEDS + SHAFT + axis]
        held = carried * y[tail + OUTER + axis] + damped * outer_speed + pressed[axis]
        frame = moves * (given[axis] - momentum[axis] - held) / support[SUPPORT.outer_mass]
        bent = stiffness * (y[tail + SHAFT + axis] - y[axis]) + damping * (shaft_speed - y[border + axis])
        rate[border + axis] += (bends * (bent - given[axis]) + (1.0 - bends) * unbalance[axis]) / ring_mass - frame
        rate[border + cage + axis] -= frame
        rate[tail + OUTER + axis], rate[tail + SHAFT + axis] = outer_speed, shaft_speed
        rate[tail + SPEEDS + OUTER + axis] = frame
        rate[tail + SPEEDS + SHAFT + axis] = bends * ((given[axis] + unbalance[axis] - bent) / support[SUPPORT.shaft_mass] - frame)
        work[_NUMBERS, _FRAME + axis] = frame


@kernel
def support_jacobian(y, border, cage, model, work):
    """Write V and U as far as ring, cage and tail make them; the rollers and their reactions follow in the level.

    Parameters as of `support_accelerations`, which has been called.
    """
    support, ring_mass, tail = model.params.support, model.params.ring.mass, y.shape[0] - TAIL
    shaft_mass, per_mass = support[SUPPORT.shaft_mass], support[SUPPORT.outer_moves] / support[SUPPORT.outer_mass]
    pressed = _film_force(y, model)
    for axis in range(2):
        stiffness, damping = support[SUPPORT.shaft_stiffness + axis], support[SUPPORT.shaft_damping + axis]
        carried, damped = support[SUPPORT.outer_stiffness + axis], support[SUPPORT.outer_damping + axis]
        first, end = _chain(axis)
        chain, reaction, following = work[_NUMBERS, first:end], work[REACTION + axis], work[FOLLOWING + axis]
        chain[_BY_RING], chain[_DAMPED_RING] = stiffness / ring_mass, damping / ring_mass
        chain[_BY_SHAFT], chain[_DAMPED_SHAFT] = stiffness / shaft_mass, damping / shaft_mass
        for i in range(y.shape[0]):
            reaction[i], following[i] = 0.0, 0.0
        for other in range(2):
            here = 1.0 if other == axis else 0.0
            reaction[tail + OUTER + other] = -per_mass * (pressed[2 + 4 * axis + other] + here * carried)
            reaction[tail + SPEEDS + OUTER + other] = -per_mass * (pressed[4 + 4 * axis + other] + here * damped)
        following[border + axis], following[border + cage + axis] = -1.0, -1.0
        following[tail + SPEEDS + OUTER + axis], following[tail + SPEEDS + SHAFT + axis] = 1.0, -support[SUPPORT.shaft_bends]


@kernel
def momentum_rate(row, params, rows):
    """Return the sum of the forces y, z on all rollers by their own accelerations [N].

    Parameters
    ----------
    row : rows of the rollers, of level ``planar`` or ``spatial``.
    params : of the bearing.
    rows : of the rollers, their accelerations written.
    """
    along_y, along_z = spread(0.0), spread(0.0)
    for block in range(rows.shape[0]):
        radius, orbital_speed = load(rows, block, row.radius), load(rows, block, row.orbital_speed)
        outwards = load(rows, block, row.radial_acceleration) - radius * orbital_speed * orbital_speed
        along = radius * load(rows, block, row.orbital_acceleration) + 2.0 * load(rows, block, row.radial_speed) * orbital_speed
        present, cosine, sine = load(rows, block, row.present), load(rows, block, row.cosine), load(rows, block, row.sine)
        along_y += present * (outwards * cosine - along * sine)
        along_z += present * (outwards * sine + along * cosine)
    return params.rollers.mass * total(along_y), params.rollers.mass * total(along_z)


@kernel
def follow_frame(row, block, frame, rows):
    """Add to the accelerations of a block of rollers that their frame accelerates; see `momentum_rate`, ``frame`` as of `frame_of`."""
    cosine, sine = load(rows, block, row.cosine), load(rows, block, row.sine)
    outwards, along = frame[0] * cosine + frame[1] * sine, frame[1] * cosine - frame[0] * sine
    add(rows, block, row.radial_acceleration, -outwards)
    add(rows, block, row.orbital_acceleration, -(along / load(rows, block, row.radius)))


@kernel
def turn_frame(layout, runs, row, block, frame, rows, jacobian):
    """Add to a block's rows of r'' and phi'' how the frame's acceleration turns with a roller's azimuth; parameters as of `react_by_rollers`."""
    r, phi, local = runs.radius, runs.angle, layout.local
    cosine, sine, inverse = load(rows, block, row.cosine), load(rows, block, row.sine), 1.0 / load(rows, block, row.radius)
    outwards, along = frame[0] * cosine + frame[1] * sine, frame[1] * cosine - frame[0] * sine
    add(jacobian, block, phi, -along)
    add(jacobian, block, local + phi, outwards * inverse)
    add(jacobian, block, local + r, along * inverse * inverse)


@kernel
def _react_by_rollers(layout, runs, row, count, per_mass, rows, jacobian, work):
    """Add to V what the rollers' own states do to the outer ring through the rollers, and write the rollers' part of U.

    Parameters
    ----------
    layout, runs, row : as of `react_on_support`.
    count : of rollers.
    per_mass : m_r over the outer ring's mass; 0 where that is held.
    rows : of the rollers; accelerations and Jacobian as they are without the frame's acceleration.
    jacobian : derivatives through each roller.
    work : memory of the support.
    """
    r, phi, r_speed, phi_speed, first = runs.radius, runs.angle, runs.radial_speed, runs.orbital_speed, runs.first
    for j in range(count):
        block, lane = j // LANES, j % LANES
        cosine, sine, radius = rows[block, row.cosine, lane], rows[block, row.sine, lane], rows[block, row.radius, lane]
        radial_speed, orbital_speed = rows[block, row.radial_speed, lane], rows[block, row.orbital_speed, lane]
        turning = rows[block, row.orbital_acceleration, lane]
        outwards = rows[block, row.radial_acceleration, lane] - radius * orbital_speed * orbital_speed
        along = radius * turning + 2.0 * radial_speed * orbital_speed
        for k in range(layout.block):
            d_outwards, d_along = jacobian[block, k, lane], radius * jacobian[block, layout.local + k, lane]
            if k == r:
                d_outwards -= orbital_speed * orbital_speed
                d_along += turning
            elif k == r_speed:
                d_along += 2.0 * orbital_speed
            elif k == phi_speed:
                d_outwards -= 2.0 * radius * orbital_speed
                d_along += 2.0 * radial_speed
            elif k == phi:  # the direction of the force turns
                d_outwards, d_along = d_outwards - along, d_along + outwards
            work[REACTION, first + k * count + j] -= per_mass * (cosine * d_outwards - sine * d_along)
            work[REACTION + 1, first + k * count + j] -= per_mass * (sine * d_outwards + cosine * d_along)
        work[FOLLOWING, first + r_speed * count + j], work[FOLLOWING + 1, first + r_speed * count + j] = -cosine, -sine
        work[FOLLOWING, first + phi_speed * count + j], work[FOLLOWING + 1, first + phi_speed * count + j] = sine / radius, -cosine / radius


@kernel
def _react_by_border(state, column, layout, row, count, per_mass, rows, jacobian, work):
    """Add to V what one state of the border does to the outer ring through all rollers.

    Parameters
    ----------
    state : the state.
    column : of a roller's derivatives by it; for the other parameters see `_react_by_rollers`.
    """
    along_y, along_z = 0.0, 0.0
    for j in range(count):
        block, lane = j // LANES, j % LANES
        cosine, sine = rows[block, row.cosine, lane], rows[block, row.sine, lane]
        d_outwards, d_along = jacobian[block, column, lane], rows[block, row.radius, lane] * jacobian[block, layout.local + column, lane]
        along_y += cosine * d_outwards - sine * d_along
        along_z += sine * d_outwards + cosine * d_along
    work[REACTION, state] -= per_mass * along_y
    work[REACTION + 1, state] -= per_mass * along_z


@kernel
def react_on_support(layout, runs, row, params, rows, own, jacobian, work):
    """Write what all bodies do to the outer ring, and add to the rows of r'' and phi'' how the frame's acceleration turns with a roller's azimuth.

    Parameters
    ----------
    layout : of the level, a `bearing_sim.numerics.block_arrow.Layout`; its first body is the ring, its second the cage, y and z the first positions.
    runs : `bearing_sim.levels.common.rollers.StateRuns` of the level.
    row : rows of the rollers.
    params : of the bearing.
    rows : of the rollers; accelerations and derivatives as they are without the frame's acceleration.
    own : derivatives of the border's accelerations by border positions and speeds.
    jacobian : derivatives through each roller; changed.
    work : memory of the support; changed.
    """
    count, border, per_mass = params.rollers.count, layout.border, params.support[SUPPORT.outer_moves] / params.support[SUPPORT.outer_mass]
    per_roller = per_mass * params.rollers.mass
    _react_by_rollers(layout, runs, row, count, per_roller, rows, jacobian, work)
    for m in range(border):
        _react_by_border(m, layout.column[m], layout, row, count, per_roller, rows, jacobian, work)
        _react_by_border(border + m, layout.column[m] + layout.size[m], layout, row, count, per_roller, rows, jacobian, work)
    for k in range(border):
        axis = layout.own_column[k] - layout.block
        if axis > 1:
            continue
        mass, reaction, first = per_mass * (params.ring.mass if layout.body[k] == 0 else params.cage.mass), work[REACTION + axis], layout.row[k]
        for m in range(2 * border):
            reaction[m] -= mass * own[k, m]
        for j in range(count):
            block, lane = j // LANES, j % LANES
            for m in range(layout.block):
                reaction[runs.first + m * count + j] -= mass * jacobian[block, first + m, lane]
            for m in range(border):
                if layout.body[m] == layout.body[k]:
                    column = first + layout.own_column[m]
                    reaction[m] -= mass * jacobian[block, column, lane]
                    reaction[border + m] -= mass * jacobian[block, column + layout.size[m], lane]
    for block in range(rows.shape[0]):
        turn_frame(layout, runs, row, block, frame_of(work), rows, jacobian)


@kernel
def carry(layout, runs, row, t, y, model, work, rate, with_jacobian):
    """Let the support move the outer ring and the shaft, and ring and cage with them; the rollers follow in the level.

    Parameters
    ----------
    layout, runs, row : as of `react_on_support`.
    rate : the level's part is written; changed.
    """
    params, rows, support, border, cage = model.params, work.rollers, work.support, layout.border, layout.size[0]
    momentum_y, momentum_z = momentum_rate(row, params, rows)
    momentum_y += params.ring.mass * rate[border] + params.cage.mass * rate[border + cage]
    momentum_z += params.ring.mass * rate[border + 1] + params.cage.mass * rate[border + cage + 1]
    support_accelerations(t, y, border, cage, momentum_y, momentum_z, model, rate, support)
    if with_jacobian:
        support_jacobian(y, border, cage, model, support)
        react_on_support(layout, runs, row, params, rows, work.global_block, work.jacobian, support)


@kernel
def _stiffen_ring(shift, border, own, work):
    """Eliminate the shaft: keep what `_bend_shaft` and `_follow_shaft` need, and take what it does to the ring into the border's derivatives.

    Within a step the shaft's speed is (b_s + g/m_s v_i)/D with D = 1 + g/m_s, g = s c + s^2 k, so that the ring feels g/D.
    """
    work[_NUMBERS, _SHIFT] = shift
    for axis in range(2):
        first, end = _chain(axis)
        chain = work[_NUMBERS, first:end]
        on_shaft = shift * (chain[_DAMPED_SHAFT] + shift * chain[_BY_SHAFT])
        chain[_ON_RING] = shift * (chain[_DAMPED_RING] + shift * chain[_BY_RING]) / (1.0 + on_shaft)
        chain[_ON_SHAFT] = on_shaft
        own[axis, border + axis] -= chain[_ON_RING] / shift


@kernel
def _bend_shaft(border, x, work):
    """Take the shaft out of a right side ``x`` before the level solves it with alpha held."""
    s, tail = work[_NUMBERS, _SHIFT], x.shape[0] - TAIL
    for axis in range(2):
        first, end = _chain(axis)
        chain = work[_NUMBERS, first:end]
        bent = x[tail + SHAFT + axis] - x[axis]
        x[tail + SPEEDS + SHAFT + axis] -= s * chain[_BY_SHAFT] * bent
        x[border + axis] += s * chain[_BY_RING] * bent + chain[_ON_RING] * x[tail + SPEEDS + SHAFT + axis]


@kernel
def _follow_shaft(border, x, work):
    """Complete the tail of a solution ``x`` that the level has found with alpha held."""
    s, tail = work[_NUMBERS, _SHIFT], x.shape[0] - TAIL
    for axis in range(2):
        first, _ = _chain(axis)
        on_shaft, at = work[_NUMBERS, first + _ON_SHAFT], tail + SPEEDS + SHAFT + axis
        x[at] = (x[at] + on_shaft * x[border + axis]) / (1.0 + on_shaft)
    for k in range(SPEEDS):
        x[tail + k] += s * x[tail + SPEEDS + k]


@kernel
def _reaction_to(x, axis, work):
    """Return a component of V x."""
    through, reaction = 0.0, work[REACTION + axis]
    for i in range(x.shape[0]):
        through += reaction[i] * x[i]
    return through


@kernel
def _invert_yielding(work):
    """Invert I - V W; return False where it is singular."""
    a, b = 1.0 - _reaction_to(work[RESPONSE], 0, work), -_reaction_to(work[RESPONSE + 1], 0, work)
    c, d = -_reaction_to(work[RESPONSE], 1, work), 1.0 - _reaction_to(work[RESPONSE + 1], 1, work)
    determinant = a * d - b * c
    inverse = 1.0 / determinant
    yielding = work[_NUMBERS, _YIELDING : _YIELDING + 4]
    yielding[0], yielding[1], yielding[2], yielding[3] = d * inverse, -b * inverse, -c * inverse, a * inverse
    return abs(determinant) > 0.0


@kernel
def _yield_frame(x, work):
    """Complete a solution ``x`` with alpha held by what alpha does."""
    through_y, through_z = _reaction_to(x, 0, work), _reaction_to(x, 1, work)
    yielding, by_y, by_z = work[_NUMBERS, _YIELDING : _YIELDING + 4], work[RESPONSE], work[RESPONSE + 1]
    frame_y = yielding[0] * through_y + yielding[1] * through_z
    frame_z = yielding[2] * through_y + yielding[3] * through_z
    for i in range(x.shape[0]):
        x[i] += frame_y * by_y[i] + frame_z * by_z[i]


@kernel
def _solve_held(layout, work, x):
    """Solve with a_O held."""
    support = work.support
    _bend_shaft(layout.border, x, support)
    solve(layout, work.jacobian, work.factored, x[: x.shape[0] - TAIL])
    _follow_shaft(layout.border, x, support)


@fused
def factor_level(layout, shift, work):
    """Factor I - s J of a level with or without a support; return False where it is singular.

    Parameters
    ----------
    layout : of the level, a `bearing_sim.numerics.block_arrow.Layout`.
    shift : s [s].
    work : of the level.
    """
    if work.support.shape[0] > 0:
        return _factor_supported(layout, shift, work)
    return factor(layout, work.jacobian, work.global_block, shift, work.factored)


@kernel
def _factor_supported(layout, shift, work):
    support, own, border = work.support, work.global_block, layout.border
    along_y, along_z = own[0, border], own[1, border + 1]
    _stiffen_ring(shift, border, own, support)
    regular = factor(layout, work.jacobian, own, shift, work.factored)
    own[0, border], own[1, border + 1] = along_y, along_z
    for axis in range(2):
        response = support[RESPONSE + axis]
        for i in range(response.shape[0]):
            response[i] = shift * support[FOLLOWING + axis, i]
        _solve_held(layout, work, response)
    return _invert_yielding(support) and regular


@fused
def solve_level(layout, work, x):
    """Replace the right side ``x`` by the solution with the last `factor_level`; parameters as there."""
    if work.support.shape[0] > 0:
        _solve_held(layout, work, x)
        _yield_frame(x, work.support)
    else:
        solve(layout, work.jacobian, work.factored, x)


@kernel
def support_powers(t, y, border, model):
    """Return the power of the unbalance, which the shaft puts in, and what the dampers of shaft and outer ring lose [W].

    Parameters
    ----------
    border : how many positions the level's border has; the ring's y and z are the first.
    """
    support, tail = model.params.support, y.shape[0] - TAIL
    unbalance, apart = unbalance_at(t, model), support[SUPPORT.shaft_bends]
    pressed = _film_force(y, model)
    driven, lost = 0.0, 0.0
    for axis in range(2):
        outer_speed = y[tail + SPEEDS + OUTER + axis]
        shaft_speed = apart * y[tail + SPEEDS + SHAFT + axis] + (1.0 - apart) * y[border + axis]
        bending = shaft_speed - y[border + axis]
        driven += unbalance[axis] * (outer_speed + shaft_speed)
        lost += support[SUPPORT.shaft_damping + axis] * bending * bending
        lost += (support[SUPPORT.outer_damping + axis] * outer_speed + pressed[axis]) * outer_speed
    return driven, lost


@kernel
def support_change(change):
    """Return the largest change of a position in the tail of ``change`` [m]."""
    tail = change.shape[0] - TAIL
    largest = max(abs(change[tail + OUTER]), abs(change[tail + OUTER + 1]))
    return max(largest, abs(change[tail + SHAFT]), abs(change[tail + SHAFT + 1]))


@kernel
def extrapolate_support(known, shift, slope, tail, guess):
    """Extrapolate the tail of a state that begins at ``tail``: speeds by their rates, positions by the new speeds."""
    for k in range(tail + SPEEDS, known.shape[0]):
        guess[k] = known[k] + shift * slope[k]
        guess[k - SPEEDS] = known[k - SPEEDS] + shift * guess[k]


@kernel
def observe_support(y, ring_y, ring_z, support, row):
    """Write where outer ring and shaft are; ``ring_y`` and ``ring_z`` are the inner ring's."""
    row[COLUMN.shaft_y], row[COLUMN.shaft_z] = ring_y, ring_z
    if support[SUPPORT.active]:
        tail = y.shape[0] - TAIL
        outer_y, outer_z = y[tail + OUTER], y[tail + OUTER + 1]
        row[COLUMN.outer_ring_y], row[COLUMN.outer_ring_z] = outer_y, outer_z
        bent = support[SUPPORT.shaft_bends]
        row[COLUMN.shaft_y] = outer_y + ring_y + bent * (y[tail + SHAFT] - ring_y)
        row[COLUMN.shaft_z] = outer_z + ring_z + bent * (y[tail + SHAFT + 1] - ring_z)
