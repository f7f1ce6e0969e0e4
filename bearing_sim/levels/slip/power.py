# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause at level ``slip`` (see `bearing_sim.levels.common.power`).

Rollers are locked to their pockets and everything radial is quasi-static: nothing is damped, no land is eccentric, and the
kinetic energy of the balance is that of rotation: of the cage, the orbiting rollers and their spins.  The normal forces that lean, by the
contour's slope and the ring's displacement, exchange it with the elastic energy of the contacts and the work of the load, without loss.

**The shaft's power.**  Spins follow stiff tractions.  A spin that is off by the little that the tolerances allow turns the tractions of both
raceways against each other: the shaft's power P errs by as much as the power J_r w w' that the spin takes up, while the losses hardly
change.  A sample therefore has P - E' + (E - E_0)/(t - t_0), E the energy of all spins and E_0 that of the sample before: the same balance, with what
spins took up in the mean since that sample in place of what they seem to take up at the instant.
"""

import math

from bearing_sim.levels.common.power import Powers, rolling_power, seal_power, shaft_traction_power, sliding_power, windage_powers
from bearing_sim.levels.slip.state import SPIN
from bearing_sim.model.sample import COLUMN, SCALARS
from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.drag import roller_drag
from bearing_sim.physics.land import land_torque
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.pocket import pocket_friction


@kernel
def slip_powers(cage_speed, cage_acceleration, spins, shaft_speed, model, work):
    """Return `bearing_sim.levels.common.power.Powers` of a state.

    Parameters
    ----------
    cage_speed, cage_acceleration : [rad/s, rad/s^2].
    spins : of the rollers [rad/s], shape (Z,).
    shaft_speed : [rad/s].
    model, work : of the level; the right-hand side at that state has been evaluated into ``work``.
    """
    params, lubrication, contacts, loads = model.params, model.lubrication, work.contacts, work.loads
    rollers, count, cage = params.rollers, params.rollers.count, params.cage
    guide_speed = cage.guidance.turning * shaft_speed
    land = land_torque(cage_speed, guide_speed, cage.assumed_eccentricity, lubrication.viscosity, cage)[0]
    bore, windage = windage_powers(cage_speed, shaft_speed, params, lubrication)
    drag, seals = roller_drag(cage_speed, shaft_speed, params, lubrication)[0], seal_power(shaft_speed, params)
    blocks = contacts.shape[0] // 2
    churning, pocket, driven, rubbing = 0.0, 0.0, 0.0, 0.0
    if params.flanges.on:
        driven, rubbing = _flange_powers(cage_speed, spins, shaft_speed, params, work)
    for j in range(count):
        radius = loads[LOAD.radius, j]
        churning += drag * radius * cage_speed
        force = abs(rollers.mass * radius * cage_acceleration - work.tangential[j])
        pocket += force * pocket_friction(spins[j], cage.pocket_friction) * rollers.radius * (spins[j] + params.variants.pocket_reaction * cage_speed)
    return Powers(
        shaft_traction_power(contacts, count, shaft_speed, params.raceways.inner_radius + work.growth[0])
        + bore
        + land * guide_speed
        + seals
        + driven,
        sliding_power(contacts, 0, count),
        sliding_power(contacts, blocks, count),
        rolling_power(contacts, 0, count),
        rolling_power(contacts, blocks, count),
        churning,
        windage,
        land * (guide_speed - cage_speed),
        pocket,
        0.0,
        seals,
        rubbing,
        0.0,
    )


@kernel
def spin_power(y, rate, params):
    """Return the power that the spins take up at an instant, the sum of J_r w w' [W]; ``y`` and ``rate`` are the state and its derivative."""
    power = 0.0
    for j in range(params.rollers.count):
        power += params.rollers.inertia * y[SPIN + j] * rate[SPIN + j]
    return power


@kernel
def surplus_spin_power(y, rate, interval, previous, params):
    """Return by how much more power the spins take up at an instant than they did in the mean since the sample before [W].

    Parameters
    ----------
    y, rate : state, and its derivative.
    interval : time since the previous sample [s].
    previous : flat sample, see `bearing_sim.model.sample.flat`.

    Returns
    -------
    power : 0 where no time has passed, or the sample before has no spins.
    """
    if not interval > 0.0:
        return 0.0
    gained, first = 0.0, SCALARS + COLUMN.roller_spin * params.rollers.count
    for j in range(params.rollers.count):
        gained += 0.5 * params.rollers.inertia * (y[SPIN + j] * y[SPIN + j] - previous[first + j] * previous[first + j])
    power = spin_power(y, rate, params) - gained / interval
    return 0.0 if math.isnan(power) else power


@kernel
def _flange_powers(cage_speed, spins, shaft_speed, params, work):
    """Return what the shaft puts in through its flanges and what is lost on those of both rings [W]; parameters as of `slip_powers`."""
    driven, lost, pitch_radius = 0.0, 0.0, params.flanges.pitch_radius
    for j in range(params.rollers.count):
        inner, inner_torque, outer, outer_torque = work.flanges[0, j], work.flanges[1, j], work.flanges[2, j], work.flanges[3, j]
        orbital = work.loads[LOAD.radius, j] * cage_speed
        shaft = (inner * pitch_radius - inner_torque) * shaft_speed
        driven += shaft
        lost += shaft - (inner + outer) * orbital - (inner_torque + outer_torque) * spins[j]
    return driven, lost
