# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause at level ``slip`` (see `bearing_sim.levels.common.power`).

Rollers are locked to their pockets and everything radial is quasi-static: nothing is damped, no land is eccentric, and the
kinetic energy of the balance is that of rotation: of the cage, the orbiting rollers and their spins.  The normal forces that lean, by the
contour's slope and the ring's displacement, exchange it with the elastic energy of the contacts and the work of the load, without loss.
"""

from bearing_sim.levels.common.power import Powers, rolling_power, seal_power, shaft_traction_power, sliding_power, windage_powers
from bearing_sim.levels.slip.state import OMEGA, POCKET, SPIN
from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.drag import roller_drag
from bearing_sim.physics.land import land_torque
from bearing_sim.physics.load_balance import LOAD


@kernel
def slip_powers(cage_speed, spins, shaft_speed, model, work):
    """Return `bearing_sim.levels.common.power.Powers` of a state.

    Parameters
    ----------
    cage_speed : [rad/s].
    spins : of the rollers [rad/s], shape (Z,).
    shaft_speed : [rad/s].
    model, work : of the level; the right-hand side at that state has been evaluated into ``work``.
    """
    params, lubrication, contacts, loads = model.params, model.lubrication, work.contacts, work.loads
    rollers, count, cage = params.rollers, params.rollers.count, params.cage
    guide_speed = cage.guidance.turning * shaft_speed
    land = land_torque(cage_speed, guide_speed, cage.assumed_eccentricity, lubrication, cage)[0]
    bore, windage = windage_powers(cage_speed, shaft_speed, params, lubrication)
    drag, seals = roller_drag(cage_speed, shaft_speed, params, lubrication)[0], seal_power(shaft_speed, params)
    blocks = contacts.shape[0] // 2
    churning, pocket, driven, rubbing = 0.0, 0.0, 0.0, 0.0
    if params.flanges.on:
        driven, rubbing = _flange_powers(cage_speed, spins, shaft_speed, params, work)
    for j in range(count):
        radius = loads[LOAD.radius, j]
        churning += drag * radius * cage_speed
        pocket += work.pockets[POCKET.brake, j] * rollers.radius * (spins[j] + params.variants.pocket_reaction * cage_speed)
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
def inertia_of_orbits(params, loads):
    """Return the inertia of the cage and of the rollers that orbit with it, about the bearing's axis [kg m^2]."""
    inertia = params.cage.inertia
    for j in range(params.rollers.count):
        inertia += params.rollers.mass * loads[LOAD.radius, j] * loads[LOAD.radius, j]
    return inertia


@kernel
def kinetic_power(y, rate, model, work):
    """Return the power that cage, orbits and spins take up at an instant [W]; ``rate`` is the derivative of ``y``, just evaluated into ``work``."""
    rollers = model.params.rollers
    power = inertia_of_orbits(model.params, work.loads) * y[OMEGA] * rate[OMEGA]
    for j in range(rollers.count):
        power += rollers.inertia * y[SPIN + j] * rate[SPIN + j]
    return power


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
