"""Level ``slip``: the cage's angle and speed, Z roller spins, everything radial quasi-static.

Rollers are locked to their pockets, so all orbit with the cage; each is held radially by Q_e = Q_i + F_c and the
inner ring by the load.  What is left of Deng 2017, eq. 14 to 16, is one angular momentum balance for cage and
rollers together and one spin equation per roller.  Left out: pocket play, radial vibration, cage whirl.

State: y = (theta_c, omega_c, w_1, ..., w_Z) in rad and rad/s; the border of the block-arrow Jacobian comes first.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.integrators.drive import drive
from bearing_sim.integrators.rosenbrock2 import rosenbrock2_step
from bearing_sim.integrators.status import OK
from bearing_sim.kernels.block_arrow import BlockArrow, factor_shifted, new_block_arrow, solve_factored
from bearing_sim.kernels.cage import land_torque
from bearing_sim.kernels.compilation import kernel
from bearing_sim.kernels.contact import line_penetration
from bearing_sim.kernels.drag import churning_force, cylinder_torque, end_face_torque
from bearing_sim.kernels.load_balance import balance_ring
from bearing_sim.kernels.raceway import contour_at
from bearing_sim.kernels.traction import traction
from bearing_sim.params import Lubrication, Params
from bearing_sim.rating_life import ROTATING_EXPONENT, STATIONARY_EXPONENT, rating_life_revolutions
from bearing_sim.sample import COLUMN, SCALARS

THETA, OMEGA, SPIN = 0, 1, 2
_FRICTION_SPIN = 10.0  # rad/s; pocket friction is proportional to spin well below this
_PITCH_POSITIONS = 6  # cage angles over one roller pitch for the equivalent loads
_SLIP_FLOOR = 1.0  # rad/s of ideal cage speed; slip of a bearing at rest is not defined


class RollerLoads(NamedTuple):
    """Radial balance of all rollers and the ring at one cage angle; arrays of shape (Z,)."""

    cosine: np.ndarray
    sine: np.ndarray
    squeeze: np.ndarray  # R_i + D_w - R_e [m]: the approach with the ring in the centre
    contour_slope: np.ndarray  # dR_e/dphi [m/rad]
    centrifugal: np.ndarray  # F_c [N]
    free: np.ndarray  # outer penetration under F_c alone [m]
    radius: np.ndarray  # distance of the roller from the outer-ring centre [m]
    outer_penetration: np.ndarray  # [m]
    inner: np.ndarray  # Q_i [N]
    outer: np.ndarray  # Q_e [N]
    ring: np.ndarray  # ring centre (y, z) [m], shape (2,); start of the next search


class Forces(NamedTuple):
    """Forces on each roller, arrays of shape (Z,)."""

    tangential: np.ndarray  # sum of all forces along the orbit but the pocket's [N]
    spin_torque: np.ndarray  # R_w (T_i - T_e) [N m]
    spin_torque_slope: np.ndarray  # by the roller's spin [N m s]


class Work(NamedTuple):
    """Memory that the level writes while it computes."""

    loads: RollerLoads
    forces: Forces
    pitch_cosine: np.ndarray  # of 2 pi j/Z, shape (Z,)
    pitch_sine: np.ndarray
    jacobian: BlockArrow
    factored: BlockArrow  # of I - gamma h J
    scratch: np.ndarray  # shape (2, 2)


class Drive(NamedTuple):
    """Inputs as straight lines in time."""

    start: float  # [s]
    shaft_speed: float  # at the start [rad/s]
    shaft_acceleration: float  # [rad/s^2]
    load_y: float  # [N]
    load_y_rate: float  # [N/s]
    load_z: float
    load_z_rate: float


class Model(NamedTuple):
    """What the right-hand side depends on besides time and state."""

    params: Params
    lubrication: Lubrication
    drive: Drive


def new_work(params):
    """Return the level's workspace for a bearing."""
    count = params.rollers.count
    angles = 2 * math.pi * np.arange(count) / count
    return Work(
        RollerLoads(*[np.zeros(count) for _ in range(10)], np.zeros(2)),
        Forces(*[np.zeros(count) for _ in range(3)]),
        np.cos(angles),
        np.sin(angles),
        new_block_arrow(count, 1, 2),
        new_block_arrow(count, 1, 2),
        np.zeros((2, 2)),
    )


def initial_state(params, shaft_speed):
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
    cosine, sine = math.cos(cage_angle), math.sin(cage_angle)
    free_at_pitch = line_penetration(rollers.mass * raceways.pitch_radius * cage_speed * cage_speed, raceways.stiffness)
    for j in range(rollers.count):
        loads.cosine[j] = cosine * work.pitch_cosine[j] - sine * work.pitch_sine[j]
        loads.sine[j] = sine * work.pitch_cosine[j] + cosine * work.pitch_sine[j]
        radius, slope = contour_at(raceways.contour, cage_angle + 2.0 * math.pi * j / rollers.count)
        loads.contour_slope[j] = slope
        loads.squeeze[j] = raceways.inner_radius + 2.0 * rollers.radius - radius
        # The penetration is a ten-thousandth of the radius: the centrifugal force does not wait for it.
        loads.radius[j] = radius - rollers.radius
        loads.centrifugal[j] = rollers.mass * loads.radius[j] * cage_speed * cage_speed
        loads.free[j] = free_at_pitch * (1.0 + 0.9 * (loads.radius[j] / raceways.pitch_radius - 1.0))
    converged = balance_ring(load_y, load_z, rollers.count, raceways.stiffness, loads)
    for j in range(rollers.count):
        loads.radius[j] += loads.outer_penetration[j]
    return converged


@kernel
def _roller_forces(j, cage_speed, spin, shaft_speed, model, work):
    """Tangential force and spin torque of roller j, and their slopes, but for the churning that all rollers share.

    Returns tangential force [N], its slopes by cage speed and spin, spin torque [N m] and its slopes by cage speed and spin.
    """
    rollers, raceways, loads = model.params.rollers, model.params.raceways, work.loads
    lubrication = model.lubrication
    radius, roller_radius = loads.radius[j], rollers.radius
    outer_radius = radius + roller_radius
    orbital, surface = radius * cage_speed, spin * roller_radius
    inner, inner_sliding, inner_rolling = traction(
        loads.inner[j],
        0.5 * ((shaft_speed - cage_speed) * raceways.inner_radius + (spin + cage_speed) * roller_radius),
        shaft_speed * raceways.inner_radius - orbital - surface,
        lubrication.inner,
    )
    outer, outer_sliding, outer_rolling = traction(
        loads.outer[j],
        0.5 * (cage_speed * outer_radius + (spin + cage_speed) * roller_radius),
        surface - orbital,
        lubrication.outer,
    )
    inner_by_cage = -radius * inner_sliding + 0.5 * (roller_radius - raceways.inner_radius) * inner_rolling
    inner_by_spin = -roller_radius * inner_sliding + 0.5 * roller_radius * inner_rolling
    outer_by_cage = -radius * outer_sliding + 0.5 * (outer_radius + roller_radius) * outer_rolling
    outer_by_spin = roller_radius * outer_sliding + 0.5 * roller_radius * outer_rolling
    # Both normal forces lean: the outer by the contour's slope, the inner by the ring's displacement.
    lean = loads.outer[j] * loads.contour_slope[j] + loads.inner[j] * (loads.ring[1] * loads.cosine[j] - loads.ring[0] * loads.sine[j])
    coriolis = 2.0 * rollers.mass * loads.contour_slope[j] * cage_speed * cage_speed
    return (
        inner + outer + raceways.slope_factor * (lean / radius - coriolis),
        inner_by_cage + outer_by_cage,
        inner_by_spin + outer_by_spin,
        roller_radius * (inner - outer),
        roller_radius * (inner_by_cage - outer_by_cage),
        roller_radius * (inner_by_spin - outer_by_spin),
    )


@kernel
def _churning(cage_speed, model):
    """Drag of the mixture on one roller [N] and its slope by cage speed [N s]; all orbit at the pitch radius to 0.3 %."""
    rollers, lubrication, pitch_radius = model.params.rollers, model.lubrication, model.params.raceways.pitch_radius
    force, slope = churning_force(
        pitch_radius * cage_speed, lubrication.mixture_density, lubrication.viscosity, 2.0 * rollers.radius, rollers.length
    )
    return force, pitch_radius * slope


@kernel
def _cage_torque(cage_speed, shaft_speed, model):
    """Torque of guide lands and mixture on the cage body [N m] and its slope by cage speed."""
    params, lubrication = model.params, model.lubrication
    cage = params.cage
    density, viscosity = lubrication.mixture_density, lubrication.viscosity
    lands, lands_slope = land_torque(cage_speed, 0.0, 0.0, lubrication.viscosity, cage)
    outside, outside_slope = cylinder_torque(
        -cage_speed, cage.outer_radius, params.raceways.low_radius - cage.outer_radius, cage.width - cage.guide_width, density, viscosity
    )
    inside, inside_slope = cylinder_torque(
        shaft_speed - cage_speed, cage.inner_radius, cage.inner_radius - params.raceways.inner_radius, cage.width, density, viscosity
    )
    faces, faces_slope = end_face_torque(cage_speed, cage.outer_radius, cage.inner_radius, density, viscosity)
    return lands + outside + inside - faces, lands_slope - outside_slope - inside_slope - faces_slope


@kernel
def _shaft_speed(t, drive):
    return drive.shaft_speed + drive.shaft_acceleration * (t - drive.start)


@kernel
def _equations(t, y, model, work, rate, with_jacobian):
    """Evaluate the right-hand side, and the Jacobian where asked; return False where the loads did not balance."""
    params, drive, forces, loads, jacobian = model.params, model.drive, work.forces, work.loads, work.jacobian
    rollers, cage = params.rollers, params.cage
    cage_speed, shaft_speed = y[OMEGA], _shaft_speed(t, drive)
    elapsed = t - drive.start
    load_y, load_z = drive.load_y + drive.load_y_rate * elapsed, drive.load_z + drive.load_z_rate * elapsed
    if not balance_loads(y[THETA], cage_speed, load_y, load_z, params, work):
        return False
    torque, torque_slope = _cage_torque(cage_speed, shaft_speed, model)
    churning, churning_slope = _churning(cage_speed, model)
    inertia = cage.inertia
    for j in range(rollers.count):
        radius = loads.radius[j]
        force, by_cage, by_spin, spin_torque, spin_by_cage, spin_by_spin = _roller_forces(
            j, cage_speed, y[SPIN + j], shaft_speed, model, work
        )
        force -= churning
        torque += radius * force
        torque_slope += radius * (by_cage - churning_slope)
        inertia += rollers.mass * radius * radius
        forces.tangential[j] = force
        forces.spin_torque[j] = spin_torque
        forces.spin_torque_slope[j] = spin_by_spin
        if with_jacobian:
            jacobian.below[j, OMEGA, 0] = radius * by_spin
            jacobian.right[j, 0, OMEGA] = spin_by_cage / rollers.inertia
    cage_acceleration = torque / inertia
    rate[THETA] = cage_speed
    rate[OMEGA] = cage_acceleration
    for j in range(rollers.count):
        # The pocket supplies what the roller lacks to go with the cage, and its friction brakes the spin (Deng 2017, eq. 13).
        pocket = abs(forces.tangential[j] - rollers.mass * loads.radius[j] * cage_acceleration)
        spin = y[SPIN + j]
        smooth = math.sqrt(spin * spin + _FRICTION_SPIN * _FRICTION_SPIN)
        brake = cage.pocket_friction * pocket * rollers.radius
        rate[SPIN + j] = (forces.spin_torque[j] - brake * spin / smooth) / rollers.inertia
        if with_jacobian:
            brake_slope = brake * _FRICTION_SPIN * _FRICTION_SPIN / (smooth * smooth * smooth)
            jacobian.blocks[j, 0, 0] = (forces.spin_torque_slope[j] - brake_slope) / rollers.inertia
            jacobian.below[j, OMEGA, 0] /= inertia
    if with_jacobian:
        jacobian.corner[THETA, OMEGA] = 1.0
        jacobian.corner[OMEGA, OMEGA] = torque_slope / inertia
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


@kernel
def error_norm(t, y, change, relative_tolerance, model):
    """Return the largest share of its tolerance that any state's error takes.

    Speeds are measured against ideal rolling, or against 10 rad/s where the bearing hardly turns; the cage angle is not
    measured, because nothing restores it.
    """
    raceways, rollers = model.params.raceways, model.params.rollers
    ideal = max(0.5 * abs(_shaft_speed(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(y[OMEGA]))
    scale = 1.0 / (relative_tolerance * max(ideal, 10.0))
    largest = abs(change[OMEGA]) * scale
    spin_scale = scale * rollers.radius / raceways.pitch_radius
    for j in range(rollers.count):
        share = abs(change[SPIN + j]) * spin_scale
        if not share <= largest:  # NaN goes through
            largest = share
    return largest


@kernel
def step_limit(t, y, model):
    """Return the longest sensible step [s]: half a roller pitch of cage rotation, so that no lobe is jumped over."""
    return math.pi / (model.params.rollers.count * max(abs(y[OMEGA]), 1e-3))


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
            inner += work.loads.inner[j] ** ROTATING_EXPONENT
            outer += work.loads.outer[j] ** STATIONARY_EXPONENT
    samples = _PITCH_POSITIONS * count
    return (inner / samples) ** (1.0 / ROTATING_EXPONENT), (outer / samples) ** (1.0 / STATIONARY_EXPONENT)


@kernel
def observe(t, y, model, work, interval, previous, row):
    """Write the sample of state ``y``.

    Parameters
    ----------
    interval : time since the previous sample [s]; damage and angles accumulate over it.
    previous, row : flat samples, shape (SCALARS + runs * Z,); see `bearing_sim.sample.flat`.
    """
    params, drive, loads = model.params, model.drive, work.loads
    count = params.rollers.count
    shaft_speed, cage_speed = _shaft_speed(t, drive), y[OMEGA]
    elapsed = t - drive.start
    load_y, load_z = drive.load_y + drive.load_y_rate * elapsed, drive.load_z + drive.load_z_rate * elapsed
    ideal = 0.5 * shaft_speed * (1.0 - params.raceways.diameter_ratio)
    rotation = 0.5 * (shaft_speed + previous[COLUMN.shaft_speed]) * interval
    row[COLUMN.time] = t
    row[COLUMN.shaft_speed] = shaft_speed
    row[COLUMN.shaft_angle] = previous[COLUMN.shaft_angle] + rotation
    row[COLUMN.load_y] = load_y
    row[COLUMN.load_z] = load_z
    row[COLUMN.oil_temperature] = model.lubrication.temperature
    row[COLUMN.cage_angle] = y[THETA]
    row[COLUMN.cage_speed] = cage_speed
    row[COLUMN.ideal_cage_angle] = previous[COLUMN.ideal_cage_angle] + 0.5 * rotation * (1.0 - params.raceways.diameter_ratio)
    row[COLUMN.ideal_cage_speed] = ideal
    row[COLUMN.cage_slip] = 1.0 - cage_speed / ideal if abs(ideal) >= _SLIP_FLOOR else math.nan
    inner_equivalent, outer_equivalent = equivalent_loads(y[THETA], cage_speed, load_y, load_z, params, work)
    balance_loads(y[THETA], cage_speed, load_y, load_z, params, work)
    revolutions = rating_life_revolutions(inner_equivalent, outer_equivalent, params.life)
    row[COLUMN.rating_life] = 2.0 * math.pi * revolutions / (3600.0 * abs(shaft_speed))
    row[COLUMN.damage] = previous[COLUMN.damage] + abs(rotation) / (2.0 * math.pi * revolutions)
    row[COLUMN.inner_equivalent_load] = inner_equivalent
    row[COLUMN.outer_equivalent_load] = outer_equivalent
    row[COLUMN.ring_y] = loads.ring[0]
    row[COLUMN.ring_z] = loads.ring[1]
    torque, churning = _cage_torque(cage_speed, shaft_speed, model)[0], _churning(cage_speed, model)[0]
    for j in range(count):
        torque += loads.radius[j] * (_roller_forces(j, cage_speed, y[SPIN + j], shaft_speed, model, work)[0] - churning)
        first = SCALARS + j
        row[first + COLUMN.roller_angle * count] = y[THETA] + 2.0 * math.pi * j / count
        row[first + COLUMN.roller_radius * count] = loads.radius[j]
        row[first + COLUMN.roller_spin * count] = y[SPIN + j]
        before = first + COLUMN.roller_rotation * count
        spin_before = previous[first + COLUMN.roller_spin * count]
        row[before] = previous[before] + 0.5 * (spin_before + y[SPIN + j]) * interval
        row[first + COLUMN.inner_load * count] = loads.inner[j]
        row[first + COLUMN.outer_load * count] = loads.outer[j]
    row[COLUMN.cage_torque] = torque


@kernel
def factor(shift, work):
    """Factor I - shift J; return False where it is singular."""
    return factor_shifted(work.jacobian, shift, work.scratch, work.factored)


@kernel
def solve(work, x):
    """Replace the right side ``x`` by the solution with the last factorisation."""
    solve_factored(work.factored, x, work.scratch)


@kernel
def _step(t, y, rate, h, model, work, stages, next_y, error):
    return rosenbrock2_step(rhs, factor, solve, t, y, rate, h, model, work, stages, next_y, error)


@kernel
def _drive(t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts):
    return drive(
        rhs_and_jacobian, _step, error_norm, step_limit, 2, t, end, y, h, tolerance, maximum_step, budget, model, work, scratch, counts
    )


@kernel
def advance(t, duration, y, h, tolerance, maximum_step, budget, model, work, scratch, counts, previous, rows):
    """Advance ``y`` in place by ``duration`` [s] and write evenly spaced samples into ``rows``, the last at the end.

    Parameters as in `bearing_sim.integrators.drive.drive` and `observe`; ``budget`` is for the whole call.

    Returns
    -------
    status, next step to try [s]
    """
    samples = rows.shape[0]
    interval = duration / samples
    before = previous
    taken = counts[0] + counts[1]
    for k in range(samples):
        start, end = t + k * interval, t + (k + 1) * interval
        left = budget - (counts[0] + counts[1] - taken)
        status, h = _drive(start, end, y, h, tolerance, maximum_step, left, model, work, scratch, counts)
        if status != OK:
            return status, h
        observe(end, y, model, work, interval, before, rows[k])
        before = rows[k]
    return OK, h
