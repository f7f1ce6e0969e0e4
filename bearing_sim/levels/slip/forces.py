# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Equations of level ``slip``: loads in quasi-static balance, forces along the orbit, and what they accelerate.

With F_j the sum of all forces along the orbit on roller j but its pocket's, r_j its distance from the outer ring's centre, M_c the torque on
the cage body and S = J_c + sum m_r r_j^2,

    omega_c' = [M_c + sum r_j F_j - B]/S,    L_j = F_j - m_r r_j (M_c + sum r_j F_j)/S,
    J_r w_j' = R_w (T_i - T_e - F_Ri - F_Re) + M_f - R_w mu |P_j|,

L_j what a pocket without play would take from the roller, P_j what it takes (below), mu its coefficient of friction (Deng 2017, eq. 13),
B = R_w sum mu |P_j| the reaction of pocket friction on the cage (0 with ``pocket_reaction: false``), F_R the resistance to rolling, M_f the torque
of the flanges (0 without).  Deng 2017, eq. 14 to 16, are the equations of the free roller, ring and cage from which these follow.

**Play of the pockets.**  Under load the tractions are so stiff that rollers would have to creep against each other to keep in step with the cage: the
ring's displacement and the contour make one faster and the next slower.  What they are apart in a loaded zone is a few micrometres, which pockets
with play do not feel.  With the time T in which a roller gains or loses on the cage, the stiffness d of its tractions against its orbital speed, the
film's damping c and spring k and the play e of a pocket, a roller moves by x = |L_j| T/(d + c + k T) and its pocket feels of L_j the part

    rho_j = z/(z + d) + [1 - z/(z + d)] x/(x + e),    z = c + k T.

What all rollers together give the cage is not changed: P_j = rho_j L_j + (1 - rho_j) sum (1 - rho) L/sum (1 - rho).  *Assumption*: T = 1/(2 omega_c).
"""

import math

from bearing_sim.levels.common.model import films_at, load_at, shaft_speed_at, write_growth
from bearing_sim.levels.common.rollers import drag, slides_up_to_rolling
from bearing_sim.levels.slip.state import OMEGA, POCKET, SPIN, THETA
from bearing_sim.numerics.compilation import fused, kernel
from bearing_sim.numerics.linear_algebra import ARROW
from bearing_sim.numerics.simd import LANES
from bearing_sim.physics.contact import CONTACT, TINY
from bearing_sim.physics.drag import mixture_torque, roller_drag
from bearing_sim.physics.flange import axial_share, rub, shear
from bearing_sim.physics.lamina_life import MOMENTS, add_load_moments, equivalent_loads
from bearing_sim.physics.land import land_torque
from bearing_sim.physics.load_balance import LOAD, balance_ring
from bearing_sim.physics.pocket import FRICTION_SPIN, pocket_friction
from bearing_sim.physics.profile import profile_depth, profile_force
from bearing_sim.physics.raceway import contour_at
from bearing_sim.physics.ring_balance import ROLLER, balance_elastic_ring

_PITCH_POSITIONS, _MOST_PITCH_POSITIONS = 20, 320  # cage angles over one roller pitch for the equivalent loads, at first and at most
# Time in which a roller gains or loses on the cage, times the cage speed, and least such speed [rad/s] (assumptions).
_RELIEF_TIME, _SLOWEST = 0.5, 1e-3
_MOMENT_CHANGE = 0.01  # by which twice as many may change the fourth power of a load; a life then changes by a per cent


@fused
def balance_loads(cage_angle, cage_speed, load_y, load_z, params, work):
    """Find ring position and roller loads at a cage angle; results in ``work.loads``; False where it did not converge."""
    rollers, raceways, loads = params.rollers, params.raceways, work.loads
    inner_radius = raceways.inner_radius + work.growth[0]
    cosine, sine = math.cos(cage_angle), math.sin(cage_angle)
    profile = raceways.profile
    free_at_pitch = profile_depth(rollers.mass * raceways.pitch_radius * cage_speed * cage_speed, raceways.stiffness, profile)
    force, slope = profile_force(free_at_pitch, raceways.stiffness, profile)
    by_force = force / (slope * free_at_pitch) if slope > 0.0 else 0.0  # exponent of a penetration by its force
    intervals = raceways.contour.shape[0]
    turns = cage_angle / (2.0 * math.pi)
    start = (turns - math.floor(turns)) * intervals
    for j in range(rollers.count):
        loads[LOAD.cosine, j] = cosine * work.pitch[0, j] - sine * work.pitch[1, j]
        loads[LOAD.sine, j] = sine * work.pitch[0, j] + cosine * work.pitch[1, j]
        position = start + work.pitch[2, j]
        radius, slope = contour_at(raceways.contour, position - intervals if position >= intervals else position)
        loads[LOAD.contour_slope, j] = slope
        loads[LOAD.squeeze, j] = inner_radius + 2.0 * (rollers.radius - profile.highest) - radius
        # The penetration is a ten-thousandth of the radius: the centrifugal force is taken without it.
        loads[LOAD.radius, j] = radius - rollers.radius + profile.highest
        loads[LOAD.centrifugal, j] = rollers.mass * loads[LOAD.radius, j] * cage_speed * cage_speed
        loads[LOAD.free, j] = free_at_pitch * (1.0 + by_force * (loads[LOAD.radius, j] / raceways.pitch_radius - 1.0))
    converged = _balance_rollers(params.outer_ring, turns, load_y, load_z, params, work)
    for j in range(rollers.count):
        loads[LOAD.radius, j] += loads[LOAD.outer_penetration, j]
    return converged


@fused
def _balance_rollers(outer_ring, turns, load_y, load_z, params, work):
    """Balance rollers and ring, and where it bends the outer ring and its housing; return whether that converged.

    Parameters
    ----------
    outer_ring : ``params.outer_ring``; where it is None, numba compiles nothing of what bends.
    turns : azimuth of roller 0 [turns].
    load_y, load_z, params, work : as of `balance_loads`, which has written into ``work.loads`` how the rollers stand.
    """
    raceways, loads = params.raceways, work.loads
    if outer_ring is None:
        return balance_ring(load_y, load_z, raceways.stiffness, raceways.profile, loads, work.ring)
    pressure, bending = work.growth[1], work.bending
    if not balance_elastic_ring(load_y, load_z, turns, pressure, raceways.stiffness, raceways.profile, outer_ring, loads, work.ring, bending):
        return False
    for j in range(params.rollers.count):
        deflection = bending.rollers[ROLLER.deflection, j]
        loads[LOAD.squeeze, j] -= deflection
        loads[LOAD.radius, j] += deflection
        loads[LOAD.contour_slope, j] += bending.rollers[ROLLER.slope, j]
    return True


@fused
def _tractions(cage_speed, shaft_speed, films, y, model, work):
    """Compute the tangential forces in all contacts; results in ``work.contacts``."""
    rollers, inner_radius = model.params.rollers, model.params.raceways.inner_radius + work.growth[0]
    contacts, loads, count, profile = work.contacts, work.loads, model.params.rollers.count, model.params.raceways.profile
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
        if profile.crowned:
            outer = loads[LOAD.outer_penetration, j]
            inner = loads[LOAD.squeeze, j] + work.ring[0] * loads[LOAD.cosine, j] + work.ring[1] * loads[LOAD.sine, j] - outer
            contacts[block, CONTACT.penetration, lane] = inner + profile.highest
            contacts[blocks + block, CONTACT.penetration, lane] = outer + profile.highest
    drag(model.params.raceways, model.lubrication, films, contacts)


@fused
def _leaning_force(cage_speed, params, work):
    """Write into ``work.tangential`` the force along the orbit on each roller [N] that needs no oil.

    Both normal forces lean, the outer by the contour's slope and the inner by the ring's displacement, and a roller that
    follows the contour feels the Coriolis force.
    """
    y, z, loads = work.ring[0], work.ring[1], work.loads
    coriolis = 2.0 * params.rollers.mass * cage_speed * cage_speed
    for j in range(params.rollers.count):
        lean = loads[LOAD.outer, j] * loads[LOAD.contour_slope, j] + loads[LOAD.inner, j] * (y * loads[LOAD.sine, j] - z * loads[LOAD.cosine, j])
        work.tangential[j] = params.variants.contour_slope * (lean / loads[LOAD.radius, j] - coriolis * loads[LOAD.contour_slope, j])


@fused
def _cage_torque(cage_speed, shaft_speed, model):
    """Return the torque of guide lands and mixture on the cage body [N m] and its derivative by cage speed."""
    cage = model.params.cage
    lands, d_lands = land_torque(cage_speed, cage.guidance.turning * shaft_speed, cage.assumed_eccentricity, model.lubrication, cage)
    mixture, d_mixture = mixture_torque(cage_speed, shaft_speed, model.params, model.lubrication)
    return lands + mixture, d_lands + d_mixture


@fused
def equations(t, y, model, work, rate, with_jacobian):
    """Evaluate the right-hand side, and the Jacobian where asked; return False where the loads did not balance."""
    params, drive, loads, tangential, pockets = model.params, model.drive, work.loads, work.tangential, work.pockets
    rollers, cage = params.rollers, params.cage
    cage_speed, shaft_speed = y[OMEGA], shaft_speed_at(t, drive)
    films = films_at(t, shaft_speed, model)
    write_growth(shaft_speed, model.lubrication.growth, work.growth)
    inner_radius = params.raceways.inner_radius + work.growth[0]
    load_y, load_z = load_at(t, drive)
    if not balance_loads(y[THETA], cage_speed, load_y, load_z, params, work):
        return False
    torque, d_torque = _cage_torque(cage_speed, shaft_speed, model)
    churning, d_churning = roller_drag(cage_speed, shaft_speed, params, model.lubrication)
    _leaning_force(cage_speed, params, work)
    _tractions(cage_speed, shaft_speed, films, y, model, work)
    contacts, jacobian, border = work.contacts, work.jacobian.rows, work.jacobian.border
    inertia, roller_radius, blocks = cage.inertia, rollers.radius, contacts.shape[0] // 2
    for j in range(rollers.count):
        radius, block, lane = loads[LOAD.radius, j], j // LANES, j % LANES
        tangential[j] += contacts[block, CONTACT.force, lane] + contacts[blocks + block, CONTACT.force, lane] - churning
        torque += radius * tangential[j]
        inertia += rollers.mass * radius * radius
        if with_jacobian:
            inner_rolling, outer_rolling = 0.5 * contacts[block, CONTACT.d_rolling, lane], 0.5 * contacts[blocks + block, CONTACT.d_rolling, lane]
            inner_sliding, outer_sliding = contacts[block, CONTACT.d_sliding, lane], contacts[blocks + block, CONTACT.d_sliding, lane]
            inner_d_cage = (roller_radius - inner_radius) * inner_rolling - radius * inner_sliding
            outer_d_cage = (2.0 * roller_radius + radius) * outer_rolling - radius * outer_sliding
            inner_d_spin = roller_radius * (inner_rolling - inner_sliding)
            outer_d_spin = roller_radius * (outer_rolling + outer_sliding)
            d_torque += radius * (inner_d_cage + outer_d_cage - d_churning)
            jacobian[ARROW.row, j] = radius * (inner_d_spin + outer_d_spin)
            jacobian[ARROW.column, j] = roller_radius * (inner_d_cage - outer_d_cage) / rollers.inertia
            jacobian[ARROW.diagonal, j] = roller_radius * (inner_d_spin - outer_d_spin) / rollers.inertia
            pockets[POCKET.d_cage, j] = inner_d_cage + outer_d_cage - d_churning
    resistance = model.lubrication.rolling_resistance.on
    if resistance:
        resisted, d_resisted = _push_rollers(inner_radius, params, work, with_jacobian)
        torque, d_torque = torque + resisted, d_torque + d_resisted
    flanges = params.flanges.on
    if flanges:
        rubbed, d_rubbed = _rub_on_flanges(y, shaft_speed, films.flange_friction, model, work, with_jacobian)
        torque, d_torque = torque + rubbed, d_torque + d_rubbed
    cage_acceleration = torque / inertia
    shared = press_pockets(cage_speed, cage_acceleration, params, work)
    rate[THETA] = cage_speed
    reaction = 0.0
    for j in range(rollers.count):
        # The pocket supplies what keeps the roller with the cage, and its friction brakes the spin (Deng 2017, eq. 13).
        radius, spin, pressed = loads[LOAD.radius, j], y[SPIN + j], pockets[POCKET.force, j]
        pocket, friction = abs(pressed), pocket_friction(spin, films.pocket_friction)
        brake = pocket * friction
        pockets[POCKET.brake, j] = brake
        reaction += roller_radius * brake
        block, lane = j // LANES, j % LANES
        turning = contacts[block, CONTACT.force, lane] - contacts[blocks + block, CONTACT.force, lane]
        if resistance:
            turning -= contacts[block, CONTACT.resistance, lane] + contacts[blocks + block, CONTACT.resistance, lane]
        rate[SPIN + j] = roller_radius * (turning - brake) / rollers.inertia
        if flanges:
            rate[SPIN + j] += (work.flanges[1, j] + work.flanges[3, j]) / rollers.inertia
        if with_jacobian:
            smooth = math.sqrt(spin * spin + FRICTION_SPIN * FRICTION_SPIN)
            d_brake = films.pocket_friction * pocket * FRICTION_SPIN * FRICTION_SPIN / (smooth * smooth * smooth)
            # a pocket presses as its roller is driven, and as cage and rollers are accelerated
            felt, per_pressing = pockets[POCKET.felt_change, j], friction if pressed > 0.0 else -friction
            d_brake += per_pressing * felt * jacobian[ARROW.row, j] / radius
            pulled = (1.0 - felt) * shared - felt * rollers.mass * radius
            jacobian[ARROW.pulled, j] = -roller_radius * per_pressing * pulled / rollers.inertia
            jacobian[ARROW.column, j] -= roller_radius * per_pressing * felt * pockets[POCKET.d_cage, j] / rollers.inertia
            jacobian[ARROW.diagonal, j] -= roller_radius * d_brake / rollers.inertia
            jacobian[ARROW.row, j] = (jacobian[ARROW.row, j] - params.variants.pocket_reaction * roller_radius * d_brake) / inertia
    rate[OMEGA] = cage_acceleration - params.variants.pocket_reaction * reaction / inertia
    if with_jacobian:
        border[0] = 1.0
        border[1] = d_torque / inertia
    return True


@fused
def up_to_rolling(j, orbit, spin, contacts):
    """Return the fraction of a correction of a roller's speeds that leads from a flat part of a law of traction to pure rolling; 1 where it does not.

    Parameters
    ----------
    j : roller.
    orbit, spin : corrections of its orbital and its surface speed [m/s].
    contacts : of the state before the correction.
    """
    blocks, block, lane = contacts.shape[0] // 2, j // LANES, j % LANES
    inner = slides_up_to_rolling(CONTACT, contacts, block, lane, -orbit - spin)
    return min(inner, slides_up_to_rolling(CONTACT, contacts, blocks + block, lane, spin - orbit))


@kernel
def pitch_loads(cage_angle, cage_speed, load_y, load_z, oil, params, work):
    """Return the `bearing_sim.physics.lamina_life.EquivalentLoads`, means over all rollers and one roller pitch; their moments stay in ``work``.

    Cage angles are doubled until that changes no moment of the loads by more than `_MOMENT_CHANGE`, or there are `_MOST_PITCH_POSITIONS`.
    """
    moments, positions = work.load_moments, _PITCH_POSITIONS
    _average_pitch(0.0, positions, cage_angle, cage_speed, load_y, load_z, params, work, moments)
    while positions < _MOST_PITCH_POSITIONS:
        _average_pitch(0.5, positions, cage_angle, cage_speed, load_y, load_z, params, work, work.present_moments)
        positions, changed = 2 * positions, 0.0
        for ring in range(2):
            for k in range(MOMENTS):
                before = moments[ring, k]
                moments[ring, k] = 0.5 * (before + work.present_moments[ring, k])
                changed = max(changed, abs(moments[ring, k] - before) / max(before, 1e-300))
        if changed <= _MOMENT_CHANGE:
            break
    return equivalent_loads(moments, oil, params.life)


@kernel
def _average_pitch(offset, positions, cage_angle, cage_speed, load_y, load_z, params, work, moments):
    """Write the moments of the loads at so many cage angles of a pitch, shifted by ``offset`` of their distance."""
    count = params.rollers.count
    moments[:] = 0.0
    for position in range(positions):
        turned = 2.0 * math.pi * (position + offset) / (positions * count)
        balance_loads(cage_angle - turned, cage_speed, load_y, load_z, params, work)
        for j in range(count):
            add_load_moments(work.loads[LOAD.inner, j], work.loads[LOAD.outer, j], 1.0 / (positions * count), moments)


@fused
def press_pockets(cage_speed, acceleration, params, work):
    """Write what each pocket takes from its roller into ``work.pockets`` (see the module).

    Returns
    -------
    by how much what pockets share changes with the acceleration of the cage [N s^2/rad].
    """
    cage, rollers, contacts, loads, pockets = params.cage, params.rollers, work.contacts, work.loads, work.pockets
    blocks, time = contacts.shape[0] // 2, _RELIEF_TIME / max(abs(cage_speed), _SLOWEST)
    film, relieved, sharing = cage.pocket_damping + cage.pocket_stiffness * time, 0.0, 0.0
    for j in range(rollers.count):
        block, lane = j // LANES, j % LANES
        driven = work.tangential[j] - rollers.mass * loads[LOAD.radius, j] * acceleration
        inner, outer = max(contacts[block, CONTACT.d_sliding, lane], 0.0), max(contacts[blocks + block, CONTACT.d_sliding, lane], 0.0)
        stiffness = film + 4.0 * inner * outer / (inner + outer + TINY)  # of rollers whose spin follows
        soft, moved = film / stiffness, abs(driven) * time
        at_wall = moved / (moved + cage.pocket_clearance * stiffness + TINY)
        felt = soft + (1.0 - soft) * at_wall
        pockets[POCKET.force, j], pockets[POCKET.felt, j] = felt * driven, felt
        pockets[POCKET.felt_change, j] = soft + (1.0 - soft) * at_wall * (2.0 - at_wall)
        relieved += (1.0 - felt) * driven
        sharing += 1.0 - felt
    sharing += TINY
    for j in range(rollers.count):
        pockets[POCKET.force, j] += (1.0 - pockets[POCKET.felt, j]) * relieved / sharing
    # together they drive the cage, and the rollers that feel them
    radius = params.raceways.pitch_radius
    return (cage.inertia / radius + rollers.mass * radius * (rollers.count - sharing)) / sharing


@kernel
def _push_rollers(inner_radius, params, work, with_jacobian):
    """Add to forces and Jacobian of the rollers what resists rolling; return the torque on the cage [N m] and its derivative by cage speed.

    A roller feels what both surfaces and its centre feel (`bearing_sim.physics.film.resistance_constants`): F_R (1 - 2 gamma) inside,
    -F_R (1 + 2 gamma) outside along the orbit; both brake its spin, which `equations` takes into account.

    Parameters
    ----------
    inner_radius : R_i, grown [m].
    params, work : of the level; `bearing_sim.levels.common.rollers.drag` has written into ``work.contacts``.
    with_jacobian : whether to add to the Jacobian.
    """
    contacts, jacobian, rollers, blocks = work.contacts, work.jacobian.rows, params.rollers, work.contacts.shape[0] // 2
    per_inertia, torque, d_torque = rollers.radius / rollers.inertia, 0.0, 0.0
    for j in range(rollers.count):
        radius, block, lane = work.loads[LOAD.radius, j], j // LANES, j % LANES
        inner_push, outer_push = (inner_radius - rollers.radius) / radius, 1.0 + 2.0 * rollers.radius / radius  # 1 -/+ 2 gamma
        push = inner_push * contacts[block, CONTACT.resistance, lane] - outer_push * contacts[blocks + block, CONTACT.resistance, lane]
        inner, outer = 0.5 * contacts[block, CONTACT.resistance_d_rolling, lane], 0.5 * contacts[blocks + block, CONTACT.resistance_d_rolling, lane]
        inner_d_cage, outer_d_cage = (rollers.radius - inner_radius) * inner, (2.0 * rollers.radius + radius) * outer
        work.tangential[j] += push
        torque += radius * push
        d_torque += radius * (inner_push * inner_d_cage - outer_push * outer_d_cage)
        if with_jacobian:
            jacobian[ARROW.row, j] += radius * rollers.radius * (inner_push * inner - outer_push * outer)
            jacobian[ARROW.column, j] -= per_inertia * (inner_d_cage + outer_d_cage)
            jacobian[ARROW.diagonal, j] -= per_inertia * rollers.radius * (inner + outer)
    return torque, d_torque


@kernel
def _rub_on_flanges(y, shaft_speed, friction, model, work, with_jacobian):
    """Add to forces and Jacobian of the rollers what flanges do to their ends; return the torque on the cage [N m] and its derivative by cage speed.

    Parameters
    ----------
    y : state.
    shaft_speed : [rad/s].
    friction : coefficient.
    model, work : of the level; takes forces and torques in ``work.flanges``.
    with_jacobian : whether to add to the Jacobian.
    """
    params, lubrication, jacobian = model.params, model.lubrication, work.jacobian.rows
    flanges, cage_speed, torque, d_torque = params.flanges, y[OMEGA], 0.0, 0.0
    count, carried = params.rollers.count, 0.0
    for j in range(count):
        carried += work.loads[LOAD.inner, j]
    for ring in range(2):
        face, ring_speed = (flanges.inner, shaft_speed) if ring == 0 else (flanges.outer, 0.0)
        area, first, second = lubrication.viscosity * face.area, lubrication.viscosity * face.first, lubrication.viscosity * face.second
        coefficient = friction if face.area > 0.0 else 0.0
        for j in range(count):
            radius = work.loads[LOAD.radius, j]
            pressed = coefficient * axial_share(work.loads[LOAD.inner, j], carried, count, flanges)
            u, s = radius * cage_speed - ring_speed * flanges.pitch_radius, y[SPIN + j] + ring_speed
            sheared, turned, uu, us, ss = shear(area, first, second, u, s)
            rubbed, braked, rub_uu, rub_us, rub_ss, _, _ = rub(math.sqrt, pressed, face.offset, 0.0, u, s)
            force, moment = sheared + rubbed, turned + braked
            work.flanges[2 * ring, j], work.flanges[2 * ring + 1, j] = force, moment
            work.tangential[j] += force
            torque += radius * force
            d_torque -= radius * radius * (uu + rub_uu)
            if with_jacobian:
                jacobian[ARROW.row, j] -= radius * (us + rub_us)
                jacobian[ARROW.column, j] -= radius * (us + rub_us) / params.rollers.inertia
                jacobian[ARROW.diagonal, j] -= (ss + rub_ss) / params.rollers.inertia
    return torque, d_torque


@kernel
def largest_flange_load(params, loads):
    """Return the largest axial force of a roller on a flange [N]; ``loads`` as in `bearing_sim.levels.slip.state.Work`."""
    carried, highest = 0.0, 0.0
    for j in range(params.rollers.count):
        carried += loads[LOAD.inner, j]
        highest = max(highest, loads[LOAD.inner, j])
    return axial_share(highest, carried, params.rollers.count, params.flanges)
