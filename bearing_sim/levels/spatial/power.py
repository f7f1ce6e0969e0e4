# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Power by cause at level ``spatial`` (see `bearing_sim.levels.common.power` and `bearing_sim.levels.planar.power`), summed along the rollers.

Speeds are straight lines along the axis, so that most sums are a force times a speed and a moment times how it changes.
What a moment on the inner ring puts in stands beside the radial load's power: neither is among the losses.
"""

from bearing_sim.levels.common.bending import ring_rate
from bearing_sim.levels.common.flanges import FLANGE, flange_powers
from bearing_sim.levels.common.model import inner_growth
from bearing_sim.levels.common.power import Powers, seal_power, windage_powers
from bearing_sim.levels.common.support import support_powers
from bearing_sim.levels.planar.power import land_powers
from bearing_sim.levels.spatial.forces import place_land
from bearing_sim.levels.spatial.slices import damped_power
from bearing_sim.levels.spatial.state import BORDER, CAGE_TILT_Y, CAGE_TILT_Z, CAGE_Y, CAGE_Z, OMEGA, ROLLER, SLICED
from bearing_sim.numerics.compilation import kernel
from bearing_sim.numerics.simd import LANES, larger, load, magnitude, spread, store, total, where_positive
from bearing_sim.physics.contact import elastic_line_contact


@kernel
def _ring_rates(block, bending, cage_speed, rows):
    """Return how fast the outer ring moves outwards where a block of rollers is [m/s] (lanes); zeros of a rigid ring, whose ``bending`` is None."""
    if bending is None:
        return spread(0.0)
    store(rows, block, ROLLER.moved, spread(0.0))
    for j in range(block * LANES, min((block + 1) * LANES, bending.rollers.shape[1])):
        rows[block, ROLLER.moved, j % LANES] = ring_rate(bending, j, cage_speed)
    return load(rows, block, ROLLER.moved)


@kernel
def _contact_powers(first, y, params, work):
    """Return the power lost between one raceway and all rollers by sliding, rolling and damping [W], and what drives the raceway [N]."""
    contacts, count = work.contacts, params.slices.points
    sliding, rolling, damped, force = 0.0, 0.0, 0.0, 0.0
    for block in range(work.rollers.shape[0]):
        at, present = first + block, load(work.rollers, block, ROLLER.present)
        traction = load(contacts, at, SLICED.force)
        slid = traction * load(contacts, at, SLICED.sliding) + load(contacts, at, SLICED.skewing) * load(contacts, at, SLICED.sliding_lean)
        resistance = load(contacts, at, SLICED.resistance)
        moving = _ring_rates(block, work.bending, y[OMEGA], work.rollers) if first > 0 else spread(0.0)
        lost = damped_power(at, moving, contacts, work.points, work.first_points, count, params.raceways.stiffness, params.raceways.damping)
        sliding += total(present * slid)
        rolling += total(present * 2.0 * resistance * load(contacts, at, SLICED.rolling))
        damped += total(present * lost)
        force += total(present * (traction + resistance))
    return sliding, rolling, damped, force


@kernel
def _kept_d_walls(offset, rate, skew, skew_rate, clearance, stiffness, params):
    """Return the power that the film of two opposite walls damps and the power that film and walls keep [W]; parameters as of `hold_slices`."""
    positions = params.slices.walls
    count = positions.shape[0]
    film, kept = spread(0.0), spread(0.0)
    for k in range(count):
        position, speed = offset + skew * positions[k], rate + skew_rate * positions[k]
        side, excess = where_positive(position, 1.0, -1.0), magnitude(position) - clearance
        wall = elastic_line_contact(excess, params.raceways.stiffness / count)
        spring = stiffness / count * (magnitude(position) - larger(excess, 0.0)) + wall
        film += params.cage.pocket_damping / count * speed * speed
        kept += side * spring * speed
    return film, kept


@kernel
def _pocket_powers(y, params, rows):
    """Return the power lost to pocket friction and film damping, and to damping of the walls' contact [W]."""
    cage, omega = params.cage, y[OMEGA]
    lost, damped = 0.0, 0.0
    for block in range(rows.shape[0]):
        present, spin, orbital_speed = load(rows, block, ROLLER.present), load(rows, block, ROLLER.spin), load(rows, block, ROLLER.orbital_speed)
        p_c, p_s = load(rows, block, ROLLER.pocket_cosine), load(rows, block, ROLLER.pocket_sine)
        c, s = load(rows, block, ROLLER.play_cosine), load(rows, block, ROLLER.play_sine)
        force, moment = -load(rows, block, ROLLER.pocket_force), -load(rows, block, ROLLER.pocket_moment)
        offset, rate = load(rows, block, ROLLER.pocket_offset), load(rows, block, ROLLER.pocket_rate)
        skew, skew_rate = load(rows, block, ROLLER.pocket_skew), load(rows, block, ROLLER.pocket_skew_rate)
        slides = load(rows, block, ROLLER.radial_speed) * c - load(rows, block, ROLLER.radius) * orbital_speed * s + omega * offset
        slides -= y[BORDER + CAGE_Y] * p_c + y[BORDER + CAGE_Z] * p_s
        leans = (load(rows, block, ROLLER.tilt_speed) - orbital_speed * load(rows, block, ROLLER.skew)) * c + omega * skew
        leans -= (load(rows, block, ROLLER.skew_speed) + orbital_speed * load(rows, block, ROLLER.tilt)) * s
        leans -= y[BORDER + CAGE_TILT_Y] * p_c + y[BORDER + CAGE_TILT_Z] * p_s
        rubbed = force * slides + moment * leans + magnitude(force) * (spin + omega) * params.rollers.radius
        film, kept = _kept_d_walls(offset, rate, skew, skew_rate, cage.pocket_clearance, cage.pocket_stiffness, params)
        lost += total(present * (load(rows, block, ROLLER.pocket_friction) * rubbed + film))
        damped += total(present * (force * rate + moment * skew_rate - film - kept))
    return lost, damped


@kernel
def _guiding_pocket_powers(y, params, rows):
    """Return what pockets that guide the cage lose outwards and inwards, as `_pocket_powers` does along the orbit [W]."""
    cage, omega = params.cage, y[OMEGA]
    lost, damped = 0.0, 0.0
    for block in range(rows.shape[0]):
        present, friction = load(rows, block, ROLLER.present), load(rows, block, ROLLER.pocket_friction)
        force, moment = -load(rows, block, ROLLER.guide_force), -load(rows, block, ROLLER.guide_moment)
        offset, rate = load(rows, block, ROLLER.guide_offset), load(rows, block, ROLLER.guide_rate)
        lean, lean_rate = load(rows, block, ROLLER.pocket_lean), load(rows, block, ROLLER.guide_lean_rate)
        rubbed = magnitude(force) * (load(rows, block, ROLLER.spin) + omega) * params.rollers.radius
        rubbed -= force * load(rows, block, ROLLER.pocket_rate) + moment * load(rows, block, ROLLER.pocket_skew_rate)
        film, kept = _kept_d_walls(offset, rate, lean, lean_rate, cage.guide_clearance, 0.0, params)
        lost += total(present * (friction * rubbed + film))
        damped += total(present * (force * rate + moment * lean_rate - film - kept))
    return lost, damped


@kernel
def _land_powers(y, shaft_speed, model, lands):
    """Return `bearing_sim.levels.planar.power.land_powers` of both guide lands together; each carries half."""
    place_land(y, model.params.tilts.land_position, lands[0])
    place_land(y, -model.params.tilts.land_position, lands[1])
    near_driven, near, near_touching = land_powers(lands[0], shaft_speed, model)
    far_driven, far, far_touching = land_powers(lands[1], shaft_speed, model)
    return 0.5 * (near_driven + far_driven), 0.5 * (near + far), 0.5 * (near_touching + far_touching)


@kernel
def _skew_powers(viscosity, flanges, rows):
    """Return what the oil between ends and flanges loses to skewing, and the damping of corners that stop it [W]."""
    squeezed, damped = spread(0.0), spread(0.0)
    for block in range(rows.shape[0]):
        present = load(rows, block, ROLLER.present)
        for ring in range(2):
            first, squeeze = (ROLLER.inner_flange, flanges.inner.squeeze) if ring == 0 else (ROLLER.outer_flange, flanges.outer.squeeze)
            rate = load(rows, block, first + FLANGE.skew_rate)
            squeezed += present * (viscosity * squeeze * rate * rate)
            damped += present * (load(rows, block, first + FLANGE.damped) * load(rows, block, first + FLANGE.lever) * rate)
    return total(squeezed), total(damped)


@kernel
def spatial_powers(t, y, shaft_speed, model, work):
    """Return `bearing_sim.levels.common.power.Powers` of a state.

    Parameters
    ----------
    t : time [s].
    y : the state.
    shaft_speed : [rad/s].
    model, work : of the level; the right-hand side at ``y`` has been evaluated into ``work``.
    """
    params, rows = model.params, work.rollers
    bore, windage = windage_powers(y[OMEGA], shaft_speed, params, model.lubrication)
    inner, inner_rolling, inner_damped, driving = _contact_powers(0, y, params, work)
    outer, outer_rolling, outer_damped, _ = _contact_powers(rows.shape[0], y, params, work)
    pocket, walls = _pocket_powers(y, params, rows)
    driven, land, touching = 0.0, 0.0, 0.0
    if params.cage.guidance.lands:
        driven, land, touching = _land_powers(y, shaft_speed, model, work.lands)
    else:
        guided, touching = _guiding_pocket_powers(y, params, rows)
        pocket += guided
    churning = 0.0
    for block in range(rows.shape[0]):
        drag = load(rows, block, ROLLER.present) * load(rows, block, ROLLER.churning)
        churning += total(drag * load(rows, block, ROLLER.radius) * load(rows, block, ROLLER.orbital_speed))
    seals = seal_power(shaft_speed, params)
    driven_unbalance, support = 0.0, 0.0
    if work.support.shape[0] > 0:
        driven_unbalance, support = support_powers(t, y, BORDER, model)
    driven_flanges, rubbing, cornered = 0.0, 0.0, 0.0
    if params.flanges.on:
        driven_flanges, rubbing = flange_powers(ROLLER, shaft_speed, params.flanges, rows)
        squeezed, cornered = _skew_powers(model.lubrication.viscosity, params.flanges, rows)
        rubbing += squeezed
    inner_radius = params.raceways.inner_radius + inner_growth(shaft_speed, model)
    return Powers(
        driving * inner_radius * shaft_speed + bore + driven + driven_unbalance + seals + driven_flanges,
        inner,
        outer,
        inner_rolling,
        outer_rolling,
        churning,
        windage,
        land,
        pocket,
        inner_damped + outer_damped + walls + touching + cornered,
        seals,
        rubbing,
        support,
    )
