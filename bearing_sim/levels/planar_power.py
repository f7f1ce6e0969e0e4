"""Power by cause at level ``planar`` (see `bearing_sim.levels.power`), with the forces of `planar_equations` and `planar_rollers`.

What gives back what it takes, so is no loss: Palmgren's part of every normal force, the spring of the pockets' films, and the
contour's slope, by which an outer load pushes along the orbit what it is pressed in.  Without that slope (``contour_slope:
false``, Deng's form) nothing pays for the contour's squeeze, and the books are open by the sum of Q_e R_e' phi'.

The film of the guide land pushes the cage across its eccentricity, and so feeds the whirl out of a rotation that pays no
torque for it; ``land_power`` is net of that, what the land takes from the cage altogether.
"""

import math

from bearing_sim.kernels.cage import pocket_friction
from bearing_sim.kernels.compilation import kernel, template
from bearing_sim.kernels.drag import churning_force
from bearing_sim.levels.planar_algebra import BLOCK, BORDER
from bearing_sim.levels.planar_equations import _LAND_SLIDING, CAGE_Y, CAGE_Z, OMEGA, PHI_SPEED, R_SPEED, ROLLER, SPIN, R, _land, _land_contact
from bearing_sim.levels.power import Powers, elastic_force, shaft_traction_power, sliding_power, windage_powers


@template
def _roller_state(y, j):
    """Return r, r', phi' and w of roller j: the one place here that knows how the state is laid out."""
    first = 2 * BORDER + BLOCK * j
    return y[first + R], y[first + R_SPEED], y[first + PHI_SPEED], y[first + SPIN]


@kernel
def _raceway_damping(params, work):
    """Return the power lost by damping between rollers and raceways [W]."""
    rows, stiffness, lost = work.rollers, params.raceways.stiffness, 0.0
    for j in range(rows.shape[1]):
        lost += (rows[ROLLER.inner_load, j] - elastic_force(rows[ROLLER.inner_penetration, j], stiffness)) * rows[ROLLER.inner_rate, j]
        lost += (rows[ROLLER.outer_load, j] - elastic_force(rows[ROLLER.outer_penetration, j], stiffness)) * rows[ROLLER.outer_rate, j]
    return lost


@kernel
def _churning(y, model, rollers):
    """Return the power of the mixture's drag on all rollers [W]; the drag is linear about the pitch circle's speed."""
    params, lubrication = model.params, model.lubrication
    pitch_speed = params.raceways.pitch_radius * y[OMEGA]
    drag, slope = churning_force(pitch_speed, lubrication.mixture_density, lubrication.viscosity, 2.0 * params.rollers.radius, params.rollers.length)
    lost = 0.0
    for j in range(rollers):
        radius, _, phi_speed, _ = _roller_state(y, j)
        speed = radius * phi_speed
        lost += (drag + slope * (speed - pitch_speed)) * speed
    return lost


@kernel
def _pockets(y, params, work):
    """Return the power lost to pocket friction and film damping, and to damping of the walls' contact [W].

    Friction acts where a roller's surface meets the wall, against what that surface slides along the wall: by the roller's spin,
    by its motion in the pocket and by the cage's rotation.
    """
    rows, cage, omega = work.rollers, params.cage, y[OMEGA]
    lost, damped = 0.0, 0.0
    for j in range(rows.shape[1]):
        radius, radius_speed, phi_speed, spin = _roller_state(y, j)
        c, s, play_c, play_s = rows[ROLLER.cosine, j], rows[ROLLER.sine, j], rows[ROLLER.pocket_cosine, j], rows[ROLLER.pocket_sine, j]
        pocket_c, pocket_s = c * play_c + s * play_s, s * play_c - c * play_s
        cage_r = y[CAGE_Y] * pocket_c + y[CAGE_Z] * pocket_s
        speed_r = y[BORDER + CAGE_Y] * pocket_c + y[BORDER + CAGE_Z] * pocket_s
        speed_t = -y[BORDER + CAGE_Y] * pocket_s + y[BORDER + CAGE_Z] * pocket_c
        offset, force = rows[ROLLER.pocket_offset, j], -rows[ROLLER.pocket_force, j]
        rate = radius_speed * play_s + radius * play_c * (phi_speed - omega) - speed_t + omega * cage_r
        side = params.rollers.radius if force >= 0.0 else -params.rollers.radius
        sliding = radius_speed * play_c - radius * phi_speed * play_s + spin * side - (speed_r - omega * (offset + side))
        film = cage.pocket_damping * rate
        spring = cage.pocket_stiffness * min(max(offset, -cage.pocket_clearance), cage.pocket_clearance)
        wall = math.copysign(elastic_force(abs(offset) - cage.pocket_clearance, params.raceways.stiffness), offset)
        lost += force * pocket_friction(spin, cage.pocket_friction) * sliding + film * rate
        damped += (force - film - spring - wall) * rate
    return lost, damped


@kernel
def _land_powers(y, model):
    """Return the power that film and friction of the guide land take from the cage, and what damping takes where it touches [W]."""
    cage = model.params.cage
    omega, y_speed, z_speed = y[OMEGA], y[BORDER + CAGE_Y], y[BORDER + CAGE_Z]
    film = _land(y, model.params, model.lubrication.viscosity)
    lost = -(film[0] * y_speed + film[1] * z_speed + film[2] * omega)
    touching = _land_contact(y, model.params)
    contact, eccentricity = touching[0], touching[3]
    depth = eccentricity - (cage.guide_clearance - cage.land_film)
    if depth <= 0.0:
        return lost, 0.0
    n_y, n_z = y[CAGE_Y] / eccentricity, y[CAGE_Z] / eccentricity
    approach = n_y * y_speed + n_z * z_speed
    surface = omega * cage.guide_radius
    friction = cage.land_friction * surface / math.sqrt(surface * surface + _LAND_SLIDING * _LAND_SLIDING)
    lost += friction * contact * (surface + n_y * z_speed - n_z * y_speed)
    return lost, (contact - elastic_force(depth, model.params.raceways.stiffness)) * approach


@kernel
def planar_powers(y, shaft_speed, model, work):
    """Return `bearing_sim.levels.power.Powers` of a state.

    Parameters
    ----------
    y : the state.
    shaft_speed : [rad/s].
    model, work : of the level; the right-hand side at ``y`` has been evaluated into ``work``.
    """
    params, film, count = model.params, work.film, work.rollers.shape[1]
    bore, windage = windage_powers(y[OMEGA], shaft_speed, params, model.lubrication)
    pocket, walls = _pockets(y, params, work)
    land, touching = _land_powers(y, model)
    return Powers(
        shaft_traction_power(film, count, shaft_speed, params.raceways.inner_radius) + bore,
        sliding_power(film, 0, count),
        sliding_power(film, count, 2 * count),
        _churning(y, model, count),
        windage,
        land,
        pocket,
        _raceway_damping(params, work) + walls + touching,
    )
