# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Pockets that guide the cage: what they do to rollers and cage outwards and inwards; ``LANES`` rollers at a time (a block).

Pockets with walls along the orbit alone do not hold a cage: rollers shift along the orbit with the pockets of a cage that turns off its
centre, nothing pulls it back, and its own centrifugal force carries it away.  A cage guided by its rollers therefore has pockets that
close around them.  Here a guiding pocket stops a roller outwards and inwards as every pocket does along the orbit, by line contact where
the clearance is used up, with the same film damping and the same friction; wall against wall, without the corner between.  Within the
clearance there is no spring: the one along the orbit (Deng 2017, eq. 10) stands for the oil between a roller and the wall that it drives
or that drives it, whereas outwards every lobe moves every roller, and metal meets metal only where the play ends (Gupta 1979).  The play
is that along the orbit, as in a cylindrical pocket, unless the scene says otherwise; its middle is where a roller on the outer raceway is
in the mean.

With mu the coefficient of friction that has the sign of the spin, a force f outwards on the wall is accompanied by mu f along the
orbit: what the other walls do, turned by a right angle.
"""

from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.contact import damped_line_contact, log_penetration
from bearing_sim.kernels.lanes import load, magnitude, spread, store, total, where_positive
from bearing_sim.levels.planar_algebra import AT_POSITIONS, AT_SPEEDS, BORDER, LOCAL
from bearing_sim.levels.planar_state import CAGE_Y, CAGE_Z, OMEGA, PHI, PHI_SPEED, R_SPEED, ROLLER, SPIN, THETA, R

_CAGE_ROWS = 3 * LOCAL + LOCAL * CAGE_Y  # where the rows of the cage's accelerations begin, see `planar_algebra.SLOPES`


@kernel
def guide_forces(y, params, rows):
    """Write how far rollers stand outwards in their pockets, and the force of that; they have been placed in them along the orbit.

    Parameters
    ----------
    y : state.
    params : of the bearing.
    rows : of the rollers, see `bearing_sim.levels.planar_state.ROLLER`.
    """
    cage = params.cage
    for block in range(rows.shape[0]):
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        radius, orbital_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.orbital_speed)
        cage_r = y[CAGE_Y] * p_c + y[CAGE_Z] * p_s
        speed_r = y[BORDER + CAGE_Y] * p_c + y[BORDER + CAGE_Z] * p_s
        offset = radius * c - cage_r - cage.guidance.pocket_radius
        rate = load(rows, block, ROLLER.radial_speed) * c - radius * s * orbital_speed - speed_r + y[OMEGA] * load(rows, block, ROLLER.pocket_offset)
        stiffness, damping = spread(0.0), spread(cage.pocket_damping)
        force = damping * rate
        excess = magnitude(offset) - cage.guide_clearance
        if total(where_positive(excess, 1.0, 0.0)) > 0.0:
            side = where_positive(offset, 1.0, -1.0)
            wall, stiffness, wall_damping = damped_line_contact(
                excess, log_penetration(excess), rate * side, params.raceways.stiffness, params.ring.contact_damping
            )
            force += side * wall
            damping += wall_damping
        store(rows, block, ROLLER.guide_offset, offset)
        store(rows, block, ROLLER.guide_rate, rate)
        store(rows, block, ROLLER.guide_force, -force)
        store(rows, block, ROLLER.guide_stiffness, stiffness)
        store(rows, block, ROLLER.guide_damping, damping)


@kernel
def guide_accelerations(params, rows, rate):
    """Add what guiding pockets do to the accelerations of rollers and cage; parameters as of `guide_forces`, ``rate`` as of a level."""
    cage, roller_radius = params.cage, params.rollers.radius
    per_mass, per_inertia = 1.0 / params.rollers.mass, roller_radius / params.rollers.inertia
    for block in range(rows.shape[0]):
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        force, friction, present = (
            -load(rows, block, ROLLER.guide_force),
            load(rows, block, ROLLER.pocket_friction),
            load(rows, block, ROLLER.present),
        )
        braking, lever = friction * magnitude(force), load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius
        _add(rows, block, ROLLER.radial_acceleration, -(per_mass * force * (c - friction * s)))
        _add(rows, block, ROLLER.orbital_acceleration, per_mass * force * (s + friction * c) / load(rows, block, ROLLER.radius))
        _add(rows, block, ROLLER.spin_acceleration, -(per_inertia * braking))
        rate[BORDER + CAGE_Y] += total(present * force * (p_c + friction * p_s)) / cage.mass
        rate[BORDER + CAGE_Z] += total(present * force * (p_s - friction * p_c)) / cage.mass
        torque = force * (load(rows, block, ROLLER.pocket_offset) + friction * lever) + braking * roller_radius
        rate[OMEGA] -= total(present * torque) / cage.inertia


@template
def _add(array, block, row, value):
    store(array, block, row, load(array, block, row) + value)


@kernel
def _by_variable(block, column, by_offset, by_rate, by_place, params, rows, slopes):
    """Add to all rows the change by one variable, as far as the directions stay.

    Parameters
    ----------
    column : of the variable.
    by_offset, by_rate : how the offset outwards and its rate change.
    by_place : how the offset along the orbit does.
    """
    cage, rollers, present = params.cage, params.rollers, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    force, friction = -load(rows, block, ROLLER.guide_force), load(rows, block, ROLLER.pocket_friction)
    change = load(rows, block, ROLLER.guide_stiffness) * by_offset + load(rows, block, ROLLER.guide_damping) * by_rate
    braking = friction * where_positive(force, rollers.radius, -rollers.radius)
    arm = load(rows, block, ROLLER.pocket_offset) + friction * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius) + braking
    per_mass = 1.0 / rollers.mass
    _add(slopes, block, column, -(per_mass * change * (c - friction * s)))
    _add(slopes, block, LOCAL + column, per_mass * change * (s + friction * c) / load(rows, block, ROLLER.radius))
    _add(slopes, block, 2 * LOCAL + column, -(change * braking * (1.0 / rollers.inertia)))
    _add(slopes, block, _CAGE_ROWS + column, present * change * (p_c + friction * p_s) * (1.0 / cage.mass))
    _add(slopes, block, _CAGE_ROWS + LOCAL + column, present * change * (p_s - friction * p_c) * (1.0 / cage.mass))
    turned = change * arm + force * (by_place + friction * by_offset)
    _add(slopes, block, _CAGE_ROWS + 2 * LOCAL + column, -(present * turned * (1.0 / cage.inertia)))


@kernel
def _directions(block, params, rows, slopes):
    """Add that the force turns with pocket and roller, and that friction goes with the spin."""
    cage, rollers, present = params.cage, params.rollers, load(rows, block, ROLLER.present)
    p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
    c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
    friction, bend = load(rows, block, ROLLER.pocket_friction), load(rows, block, ROLLER.pocket_friction_slope)
    force = -load(rows, block, ROLLER.guide_force)
    turned = force * (1.0 / rollers.mass)
    lever = turned / load(rows, block, ROLLER.radius)
    theta = AT_POSITIONS + THETA
    _add(slopes, block, PHI, turned * (s + friction * c))
    _add(slopes, block, theta, -(turned * (s + friction * c)))
    _add(slopes, block, SPIN, turned * s * bend)
    _add(slopes, block, LOCAL + PHI, lever * (c - friction * s))
    _add(slopes, block, LOCAL + theta, -(lever * (c - friction * s)))
    _add(slopes, block, LOCAL + SPIN, lever * c * bend)
    _add(slopes, block, 2 * LOCAL + SPIN, -(magnitude(force) * bend * (rollers.radius / rollers.inertia)))
    turned = present * force * (1.0 / cage.mass)
    _add(slopes, block, _CAGE_ROWS + theta, turned * (friction * p_c - p_s))
    _add(slopes, block, _CAGE_ROWS + SPIN, turned * p_s * bend)
    _add(slopes, block, _CAGE_ROWS + LOCAL + theta, turned * (p_c + friction * p_s))
    _add(slopes, block, _CAGE_ROWS + LOCAL + SPIN, -(turned * p_c * bend))
    slid = force * (load(rows, block, ROLLER.guide_offset) + cage.guidance.pocket_radius) + magnitude(force) * rollers.radius
    _add(slopes, block, _CAGE_ROWS + 2 * LOCAL + SPIN, -(present * slid * bend * (1.0 / cage.inertia)))


@kernel
def guide_slopes(y, params, rows, slopes):
    """Add the derivatives of `guide_accelerations` to those of everything else through the rollers.

    Parameters
    ----------
    y, params, rows : as of `guide_forces`.
    slopes : takes the derivatives, see `bearing_sim.levels.planar_algebra.SLOPES`.
    """
    omega = y[OMEGA]
    for block in range(rows.shape[0]):
        radius, radial_speed = load(rows, block, ROLLER.radius), load(rows, block, ROLLER.radial_speed)
        orbital_speed, offset = load(rows, block, ROLLER.orbital_speed), load(rows, block, ROLLER.pocket_offset)
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        speed_t = y[BORDER + CAGE_Z] * p_c - y[BORDER + CAGE_Y] * p_s
        turning, lever = orbital_speed - omega, load(rows, block, ROLLER.guide_offset) + params.cage.guidance.pocket_radius
        none = spread(0.0)
        rise = -(radial_speed * s + radius * c * turning)
        turned = radial_speed * s + radius * c * orbital_speed - speed_t - omega * lever
        _by_variable(block, R, c, -(s * turning), s, params, rows, slopes)
        _by_variable(block, PHI, -(radius * s), rise, radius * c, params, rows, slopes)
        _by_variable(block, R_SPEED, none, c, none, params, rows, slopes)
        _by_variable(block, PHI_SPEED, none, -(radius * s), none, params, rows, slopes)
        _by_variable(block, AT_POSITIONS + CAGE_Y, -p_c, omega * p_s, p_s, params, rows, slopes)
        _by_variable(block, AT_POSITIONS + CAGE_Z, -p_s, -(omega * p_c), -p_c, params, rows, slopes)
        _by_variable(block, AT_POSITIONS + THETA, offset, turned, -lever, params, rows, slopes)
        _by_variable(block, AT_SPEEDS + CAGE_Y, none, -p_c, none, params, rows, slopes)
        _by_variable(block, AT_SPEEDS + CAGE_Z, none, -p_s, none, params, rows, slopes)
        _by_variable(block, AT_SPEEDS + THETA, none, offset, none, params, rows, slopes)
        _directions(block, params, rows, slopes)
