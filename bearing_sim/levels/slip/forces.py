# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Level ``slip``: the cage's angle and speed, Z roller spins, everything radial quasi-static.

Rollers are locked to their pockets, so all orbit with the cage; each is held radially by Q_e = Q_i + F_c and the
inner ring by the load.  What is left of Deng 2017, eq. 14 to 16, is one angular momentum balance for cage and
rollers together and one spin equation per roller.  Left out: pocket play, radial vibration, cage whirl.

State: y = (theta_c, omega_c, w_1, ..., w_Z) in rad and rad/s; the Jacobian is an arrow, its border comes first.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.rosenbrock2 import rosenbrock2_step
from bearing_sim.kernels.arrow import ARROW, Arrow, factor_shifted, new_arrow, solve_factored
from bearing_sim.kernels.cage import FRICTION_SPIN, land_torque, pocket_friction
from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.contact import line_penetration
from bearing_sim.kernels.drag import churning_force
from bearing_sim.kernels.film import pump
from bearing_sim.kernels.lanes import LANES, new_rows
from bearing_sim.kernels.load_balance import LOAD, balance_ring
from bearing_sim.kernels.raceway import contour_at
from bearing_sim.kernels.traction import CONTACT, traction
from bearing_sim.levels.advance import advance_by
from bearing_sim.levels.growth import inner_growth
from bearing_sim.levels.inputs import Drive, load_at, shaft_speed_at
from bearing_sim.levels.mixture import mixture_torque
from bearing_sim.levels.observation import observe_course
from bearing_sim.levels.pitch import HALF_PITCH, pitch_step
from bearing_sim.levels.power import write_powers
from bearing_sim.levels.slip_power import slip_powers
from bearing_sim.levels.slip_pumping import push_rollers
from bearing_sim.params import Lubrication, Params
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT
from bearing_sim.sample import COLUMN, SCALARS

THETA, OMEGA, SPIN = 0, 1, 2
_PITCH_POSITIONS = 10  # cage angles over one roller pitch for the equivalent loads


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    loads: np.ndarray  # rows `bearing_sim.kernels.load_balance.LOAD`, shape (10, Z)
    ring: np.ndarray  # ring centre (y, z) [m], shape (2,); start of the next search
    contacts: np.ndarray  # rows `bearing_sim.kernels.traction.CONTACT`, those with the inner raceway first
    tangential: np.ndarray  # all forces along the orbit on each roller but the pocket's [N], shape (Z,)
    growth: np.ndarray  # of the inner raceway at present [m], shape (1,)
    pitch: np.ndarray  # rows cosine and sine of 2 pi j/Z, and the angle in intervals of the contour table, shape (3, Z)
    jacobian: Arrow
    factored: Arrow  # of I - gamma h J


class Model(NamedTuple):
    """What the right-hand side depends on besides time and state."""

    params: Params
    lubrication: Lubrication
    drive: Drive
    tolerance: float  # relative error allowed in a step


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    angles = 2 * math.pi * np.arange(count) / count
    return Work(
        loads=np.zeros((len(LOAD), count)),
        ring=np.zeros(2),
        contacts=np.concatenate([new_rows(len(CONTACT), count)] * 2),
        tangential=np.zeros(count),
        growth=np.zeros(1),
        pitch=np.array([np.cos(angles), np.sin(angles), params.raceways.contour.shape[0] * np.arange(count) / count]),
        jacobian=new_arrow(count),
        factored=new_arrow(count),
    )


def initial_state(params, work, shaft_speed, load_y, load_z):
    """Return the state of ideal rolling: the cage at omega_i (1 - gamma)/2, rollers rolling on the outer ring."""
    cage_speed = 0.5 * shaft_speed * (1 - params.raceways.diameter_ratio)
    state = np.zeros(params.rollers.count + 2)
    state[OMEGA] = cage_speed
    state[SPIN:] = cage_speed * params.raceways.pitch_radius / params.rollers.radius
    return state


@kernel
def balance_loads(cage_angle, cage_speed, load_y, load_z, params, work):
    """Find ring position and roller loads at a cage angle; results in ``work.loads``; False where it did not converge."""
    rollers, raceways, loads = params.rollers, params.raceways, work.loads
    inner_radius = raceways.inner_radius + work.growth[0]
    cosine, sine = math.cos(cage_angle), math.sin(cage_angle)
    free_at_pitch = line_penetration(rollers.mass * raceways.pitch_radius * cage_speed * cage_speed, raceways.stiffness)
    intervals = raceways.contour.shape[0]
    turns = cage_angle / (2.0 * math.pi)
    start = (turns - math.floor(turns)) * intervals
    for j in range(rollers.count):
        loads[LOAD.cosine, j] = cosine * work.pitch[0, j] - sine * work.pitch[1, j]
        loads[LOAD.sine, j] = sine * work.pitch[0, j] + cosine * work.pitch[1, j]
        position = start + work.pitch[2, j]
        radius, slope = contour_at(raceways.contour, position - intervals if position >= intervals else position)
        loads[LOAD.contour_slope, j] = slope
        loads[LOAD.squeeze, j] = inner_radius + 2.0 * rollers.radius - radius
        # The penetration is a ten-thousandth of the radius: the centrifugal force does not wait for it.
        loads[LOAD.radius, j] = radius - rollers.radius
        loads[LOAD.centrifugal, j] = rollers.mass * loads[LOAD.radius, j] * cage_speed * cage_speed
        loads[LOAD.free, j] = free_at_pitch * (1.0 + 0.9 * (loads[LOAD.radius, j] / raceways.pitch_radius - 1.0))
    converged = balance_ring(load_y, load_z, raceways.stiffness, loads, work.ring)
    for j in range(rollers.count):
        loads[LOAD.radius, j] += loads[LOAD.outer_penetration, j]
    return converged


@kernel
def _tractions(cage_speed, shaft_speed, y, model, work):
    """Compute the tangential forces in all contacts; results in ``work.contacts``."""
    rollers, inner_radius = model.params.rollers, model.params.raceways.inner_radius + work.growth[0]
    contacts, loads, count = work.contacts, work.loads, model.params.rollers.count
    blocks = contacts.shape[0] // 2
    for j in range(count):
        radius, block, lane = loads[LOAD.radius, j], j // LANES, j % LANES
        orbital, surface = radius * cage_speed, y[SPIN + j] * rollers.radius
        roller_rolling = surface + cage_speed * rollers.radius
        contacts[block, CONTACT.rolling, lane] = 0.5 * ((shaft_speed - cage_speed) * inner_radius + roller_rolling)
        contacts[block, CONTACT.sliding, lane] = shaft_speed * inner_radius - orbital - surface
        contacts[block, CONTACT.load, lane] = loads[LOAD.inner, j]
        contacts[blocks + block, CONTACT.rolling, lane] = 0.5 * (cage_speed * (radius + rollers.radius) + roller_rolling)
        contacts[blocks + block, CONTACT.sliding, lane] = surface - orbital
        contacts[blocks + block, CONTACT.load, lane] = loads[LOAD.outer, j]
    traction(contacts, model.lubrication.inner, model.lubrication.outer)
    if model.lubrication.pumping.on:
        pump(contacts, model.lubrication.pumping)


@kernel
def _leaning_force(cage_speed, params, work):
    """Write into ``work.tangential`` the force along the orbit on each roller [N] that comes without oil.

    Both normal forces lean, the outer by the contour's slope and the inner by the ring's displacement, and a roller that
    follows the contour feels the Coriolis force.
    """
    y, z, loads = work.ring[0], work.ring[1], work.loads
    coriolis = 2.0 * params.rollers.mass * cage_speed * cage_speed
    for j in range(params.rollers.count):
        lean = loads[LOAD.outer, j] * loads[LOAD.contour_slope, j] + loads[LOAD.inner, j] * (y * loads[LOAD.sine, j] - z * loads[LOAD.cosine, j])
        work.tangential[j] = params.raceways.slope_factor * (lean / loads[LOAD.radius, j] - coriolis * loads[LOAD.contour_slope, j])


@kernel
def _churning(cage_speed, model):
    """Drag of the mixture on one roller [N] and its slope by cage speed [N s]; all orbit at the pitch radius to 0.3 %."""
    rollers, lubrication, pitch_radius = model.params.rollers, model.lubrication, model.params.raceways.pitch_radius
    force, slope = churning_force(pitch_radius * cage_speed, lubrication.mixture_density, lubrication.viscosity, 2.0 * rollers.radius, rollers.length)
    return force, pitch_radius * slope


@kernel
def _cage_torque(cage_speed, shaft_speed, model):
    """Torque of guide lands and mixture on the cage body [N m] and its slope by cage speed."""
    cage = model.params.cage
    lands, lands_slope = land_torque(cage_speed, cage.guidance.turning * shaft_speed, cage.assumed_eccentricity, model.lubrication.viscosity, cage)
    mixture, mixture_slope = mixture_torque(cage_speed, shaft_speed, model.params, model.lubrication)
    return lands + mixture, lands_slope + mixture_slope


@kernel
def _equations(t, y, model, work, rate, with_jacobian):
    """Evaluate the right-hand side, and the Jacobian where asked; return False where the loads did not balance."""
    params, drive, loads, tangential = model.params, model.drive, work.loads, work.tangential
    rollers, cage = params.rollers, params.cage
    cage_speed, shaft_speed = y[OMEGA], shaft_speed_at(t, drive)
    work.growth[0] = inner_growth(shaft_speed, model)
    inner_radius = params.raceways.inner_radius + work.growth[0]
    load_y, load_z = load_at(t, drive)
    if not balance_loads(y[THETA], cage_speed, load_y, load_z, params, work):
        return False
    torque, torque_slope = _cage_torque(cage_speed, shaft_speed, model)
    churning, churning_slope = _churning(cage_speed, model)
    _leaning_force(cage_speed, params, work)
    _tractions(cage_speed, shaft_speed, y, model, work)
    contacts, jacobian, border = work.contacts, work.jacobian.rows, work.jacobian.border
    inertia, roller_radius, blocks = cage.inertia, rollers.radius, contacts.shape[0] // 2
    for j in range(rollers.count):
        radius, block, lane = loads[LOAD.radius, j], j // LANES, j % LANES
        tangential[j] += contacts[block, CONTACT.force, lane] + contacts[blocks + block, CONTACT.force, lane] - churning
        torque += radius * tangential[j]
        inertia += rollers.mass * radius * radius
        if with_jacobian:
            inner_rolling, outer_rolling = 0.5 * contacts[block, CONTACT.by_rolling, lane], 0.5 * contacts[blocks + block, CONTACT.by_rolling, lane]
            inner_sliding, outer_sliding = contacts[block, CONTACT.by_sliding, lane], contacts[blocks + block, CONTACT.by_sliding, lane]
            inner_by_cage = (roller_radius - inner_radius) * inner_rolling - radius * inner_sliding
            outer_by_cage = (2.0 * roller_radius + radius) * outer_rolling - radius * outer_sliding
            inner_by_spin = roller_radius * (inner_rolling - inner_sliding)
            outer_by_spin = roller_radius * (outer_rolling + outer_sliding)
            torque_slope += radius * (inner_by_cage + outer_by_cage - churning_slope)
            jacobian[ARROW.row, j] = radius * (inner_by_spin + outer_by_spin)
            jacobian[ARROW.column, j] = roller_radius * (inner_by_cage - outer_by_cage) / rollers.inertia
            jacobian[ARROW.diagonal, j] = roller_radius * (inner_by_spin - outer_by_spin) / rollers.inertia
    pumping = model.lubrication.pumping.on
    if pumping:
        pumped, pumped_slope = push_rollers(inner_radius, params, work, with_jacobian)
        torque, torque_slope = torque + pumped, torque_slope + pumped_slope
    cage_acceleration = torque / inertia
    rate[THETA] = cage_speed
    reaction = 0.0
    for j in range(rollers.count):
        # The pocket supplies what the roller lacks to go with the cage, and its friction brakes the spin (Deng 2017, eq. 13).
        pocket = abs(tangential[j] - rollers.mass * loads[LOAD.radius, j] * cage_acceleration)
        spin = y[SPIN + j]
        brake = pocket * pocket_friction(spin, cage.pocket_friction)
        reaction += roller_radius * brake
        block, lane = j // LANES, j % LANES
        turning = contacts[block, CONTACT.force, lane] - contacts[blocks + block, CONTACT.force, lane]
        if pumping:
            turning -= contacts[block, CONTACT.pumping, lane] + contacts[blocks + block, CONTACT.pumping, lane]
        rate[SPIN + j] = roller_radius * (turning - brake) / rollers.inertia
        if with_jacobian:
            smooth = math.sqrt(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
            brake_slope = cage.pocket_friction * pocket * FRICTION_SPIN * FRICTION_SPIN / (smooth * smooth * smooth)
            jacobian[ARROW.diagonal, j] -= roller_radius * brake_slope / rollers.inertia
            jacobian[ARROW.row, j] /= inertia
    rate[OMEGA] = cage_acceleration - cage.pocket_reaction * reaction / inertia
    if with_jacobian:
        border[0] = 1.0
        border[1] = torque_slope / inertia
    return True


@kernel
def rhs(t, y, model, work, rate):
    """Write dy/dt into ``rate``; return False where the loads did not balance."""
    return _equations(t, y, model, work, rate, False)


@kernel
def rhs_and_jacobian(t, y, model, work, rate):
    """Write dy/dt into ``rate`` and its Jacobian by y into ``work.jacobian``.

    The change of loads with cage angle and speed is left out: it is slow, and the integrator's order does not need it.
    """
    return _equations(t, y, model, work, rate, True)


@template
def error_norm(t, y, change, relative_tolerance, model):
    """Return the largest share of its tolerance that any state's error takes.

    Speeds are measured against ideal rolling, or against 10 rad/s where the bearing hardly turns; the cage angle is not
    measured, because nothing restores it.
    """
    raceways, rollers = model.params.raceways, model.params.rollers
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(y[OMEGA]))
    scale = 1.0 / (relative_tolerance * max(ideal, 10.0))
    largest = abs(change[OMEGA]) * scale
    spin_scale = scale * rollers.radius / raceways.pitch_radius
    for j in range(rollers.count):
        share = abs(change[SPIN + j]) * spin_scale
        if not share <= largest:  # NaN goes through
            largest = share
    return largest


@template
def step_limit(t, y, model):
    """Return the longest sensible step [s] (see `bearing_sim.levels.pitch.pitch_step`)."""
    return pitch_step(y[OMEGA], model.params.rollers.count, HALF_PITCH)


@kernel
def equivalent_loads(cage_angle, cage_speed, load_y, load_z, params, work):
    """Return the dynamic equivalent roller loads Q_ei, Q_ee [N]: power means over all rollers and one roller pitch.

    Exponents 4 for the rotating inner and 4.5 for the stationary outer ring (ISO/TS 16281).
    """
    count = params.rollers.count
    inner, outer = 0.0, 0.0
    for position in range(_PITCH_POSITIONS):
        balance_loads(cage_angle - 2.0 * math.pi * position / (_PITCH_POSITIONS * count), cage_speed, load_y, load_z, params, work)
        for j in range(count):
            inner += work.loads[LOAD.inner, j] ** ROTATING_EXPONENT
            outer += work.loads[LOAD.outer, j] ** STATIONARY_EXPONENT
    samples = _PITCH_POSITIONS * count
    return (inner / samples) ** (1.0 / ROTATING_EXPONENT), (outer / samples) ** (1.0 / STATIONARY_EXPONENT)


@kernel
def observe(t, y, model, work, interval, previous, row, rate):
    """Write the sample of state ``y``.

    Parameters
    ----------
    interval : time since the previous sample [s]; damage and angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.sample.flat`.
    rate : scratch, shape (Z + 2,).
    """
    params, loads = model.params, work.loads
    count, cage_speed = params.rollers.count, y[OMEGA]
    load_y, load_z = load_at(t, model.drive)
    work.growth[0] = inner_growth(shaft_speed_at(t, model.drive), model)
    inner_equivalent, outer_equivalent = equivalent_loads(y[THETA], cage_speed, load_y, load_z, params, work)
    observe_course(t, y[THETA], cage_speed, inner_equivalent, outer_equivalent, model, interval, previous, row)
    rhs(t, y, model, work, rate)
    write_powers(slip_powers(cage_speed, rate[OMEGA], y[SPIN:], shaft_speed_at(t, model.drive), model, work), row)
    row[COLUMN.ring_y] = work.ring[0]
    row[COLUMN.ring_z] = work.ring[1]
    for j in range(count):
        first = SCALARS + j
        row[first + COLUMN.roller_angle * count] = y[THETA] + 2.0 * math.pi * j / count
        row[first + COLUMN.roller_radius * count] = loads[LOAD.radius, j]
        row[first + COLUMN.roller_spin * count] = y[SPIN + j]
        before = first + COLUMN.roller_rotation * count
        spin_before = previous[first + COLUMN.roller_spin * count]
        row[before] = previous[before] + 0.5 * (spin_before + y[SPIN + j]) * interval
        row[first + COLUMN.inner_load * count] = loads[LOAD.inner, j]
        row[first + COLUMN.outer_load * count] = loads[LOAD.outer, j]
        row[first + COLUMN.orbital_speed * count] = cage_speed
        drive_force = params.rollers.mass * loads[LOAD.radius, j] * rate[OMEGA]
        row[first + COLUMN.pocket_force * count] = drive_force - work.tangential[j]


@template
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return factor_shifted(work.jacobian, shift, work.factored)


@template
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    solve_factored(work.factored, x)


@template
def rosenbrock2(t, y, rate, h, model, work, stages, next_y, error):
    """Take one step of the level's own method (see `bearing_sim.integrators.rosenbrock2`)."""
    return rosenbrock2_step(rhs, factor, solve, t, y, rate, h, model, work, stages, next_y, error)


@kernel
def keep_nothing(h, y, model, work):
    """Keep nothing from step to step."""


@kernel
def _drive(t, end, stop, y, h, tolerance, maximum_step, budget, model, work, memory, counts):
    return drive(
        rhs_and_jacobian, rosenbrock2, error_norm, step_limit, keep_nothing, 2,
        t, end, y, h, tolerance, maximum_step, budget, model, work, memory.scratch, counts,
    )  # fmt: skip


@kernel
def advance(t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows):
    """Advance by the level's own method, adaptive; parameters and results as in `advance_by`."""
    return advance_by(_drive, observe, t, duration, y, h, maximum_step, budget, model, work, memory, counts, previous, rows)
