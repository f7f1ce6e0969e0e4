# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the equations of every level depend on: parameters, oil, inputs in time; and the longest sensible step."""

import math
from typing import NamedTuple

from bearing_sim.model.params import Lubrication, Params
from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.growth import total_growth
from bearing_sim.physics.mixed import film_state

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # golden section: the number that ratios of integers approximate worst
HALF_PITCH = 1.0 / (2.0 + 1.0 / (3.0 + GOLDEN))  # 0.4393
QUARTER_PITCH = 1.0 / (3.0 + GOLDEN)  # 0.2764
FIFTH_PITCH = 1.0 / (4.0 + GOLDEN)  # 0.2165
POSITION_WEIGHT = 0.25  # of positions in the norm of a correction (assumption): contacts leave less of a correction than tractions do
# Weight of play in the norm of a correction at rest, and speed of the pockets where it has half of it [m/s] (assumptions).
_PLAY_WEIGHT, _PLAY_SPEED = 10.0, 0.8
_RING_DEPTH, _LEAST_RING_ERROR = 0.7, 0.01  # see `ring_weight`; the second of the tolerance of positions (assumptions)
_SLOWEST = 1e-3  # rad/s; what a cage at rest counts as (assumption)
# The raceways' stiffness changes with every passing roller, which excites the ring where it oscillates n/2 times in a passing, n = 1 to 6.  Each
# entry has (n/2)^2, the relative difference of squared frequencies within which the longest step is shorter, and the shortest step as a part of
# `FIFTH_PITCH`: where the ring takes two passings for an oscillation, it need not be as short.  Assumptions, chosen so that lives near a
# resonance are within two per cent (``test/benchmarks/resonance.py``).
_RESONANCES = ((0.25, 0.2, 0.7), (1.0, 0.4, 0.5), (2.25, 0.15, 0.5), (4.0, 0.12, 0.5), (6.25, 0.12, 0.45), (9.0, 0.25, 0.4))


class Drive(NamedTuple):
    """Inputs as linear functions of time, from one call of ``advance`` to its end."""

    start: float  # [s]
    shaft_speed: float  # at the start [rad/s]
    shaft_acceleration: float  # [rad/s^2]
    load_y: float  # [N]
    load_y_rate: float  # [N/s]
    load_z: float
    load_z_rate: float
    shaft_angle: float  # at the start [rad]


@kernel
def shaft_speed_at(t, drive):
    """Return the shaft speed [rad/s] at a time [s]."""
    return drive.shaft_speed + drive.shaft_acceleration * (t - drive.start)


@kernel
def shaft_angle_at(t, drive):
    """Return the shaft's angle [rad] at a time [s]."""
    elapsed = t - drive.start
    return drive.shaft_angle + (drive.shaft_speed + 0.5 * drive.shaft_acceleration * elapsed) * elapsed


@kernel
def load_at(t, drive):
    """Return the radial load (y, z) [N] at a time [s]."""
    elapsed = t - drive.start
    return drive.load_y + drive.load_y_rate * elapsed, drive.load_z + drive.load_z_rate * elapsed


@kernel
def films_at(t, shaft_speed, model):
    """Return the `bearing_sim.physics.mixed.FilmState` at a time [s], when the shaft turns at ``shaft_speed`` [rad/s]."""
    params, (load_y, load_z) = model.params, load_at(t, model.drive)
    return film_state(
        shaft_speed,
        math.sqrt(load_y * load_y + load_z * load_z),
        model.lubrication.kinematic_viscosity,
        params.cage.pocket_friction,
        params.flanges.film_friction,
        params.minimum_load,
        params.starvation,
        params.mixed,
    )


@kernel
def inner_growth(shaft_speed, model):
    """Return the growth of the inner raceway's radius [m] by fits, rotation and heat (see `bearing_sim.physics.growth`).

    Parameters
    ----------
    shaft_speed : [rad/s].
    model : `bearing_sim.levels.common.model.Model`.
    """
    return total_growth(shaft_speed, model.lubrication.growth)


@kernel
def write_growth(shaft_speed, growth, present):
    """Write a `bearing_sim.physics.growth.Growth` at a shaft speed [rad/s]: the growth [m], and the pressure of the outer ring's seat [Pa]."""
    present[0], present[1] = total_growth(shaft_speed, growth), growth.housing_pressure


@kernel
def pitch_step(cage_speed, rollers, fraction):
    """Return the longest sensible step [s], a fraction of a roller pitch of cage rotation, so that no lobe is jumped over.

    The rollers together repeat themselves each pitch: a step of half a pitch would sample the same two instants of it again and again and
    take them for the mean.  A fraction that no small denominator approximates samples all instants alike.  *Assumption*: the fractions.

    Parameters
    ----------
    cage_speed : [rad/s]; a cage at rest counts as `_SLOWEST`.
    rollers : number of rollers, Z.
    fraction : of a pitch, such as `HALF_PITCH`.
    """
    return fraction * 2.0 * math.pi / (rollers * max(abs(cage_speed), _SLOWEST))


@kernel
def ring_step(cage_speed, params, stiffness):
    """Return the longest sensible step [s] where the inner ring vibrates: less near a resonance of the ring.

    A step gives an oscillation a slightly wrong period and some damping of its own, and the nearer the ring is to a resonance with the passing
    rollers, the more its amplitude depends on both.  Which oscillations a stiffness that changes periodically excites: A. H. Nayfeh, D. T. Mook,
    Nonlinear Oscillations (1979), chapter 5.  Where the ring is faster than the passing rollers and near no resonance, it follows them, and a
    quarter of a pitch is enough; elsewhere it takes a fifth, or less.

    Parameters
    ----------
    cage_speed : [rad/s].
    params : of the bearing.
    stiffness : of the raceways, see `bearing_sim.levels.common.rollers.average_stiffness`.
    """
    passing = params.rollers.count * max(abs(cage_speed), _SLOWEST)
    per = 1.0 / (params.ring.mass * passing * passing)
    middle, half = 0.5 * (stiffness[0] + stiffness[2]) * per, math.hypot(0.5 * (stiffness[0] - stiffness[2]), stiffness[1]) * per
    part = 1.0
    for square, reach, shortest in _RESONANCES:
        distance = min(abs(1.0 - (middle + half) / square), abs(1.0 - (middle - half) / square)) / reach
        if distance < 1.0:
            part = min(part, max(math.sqrt(distance), shortest))
    if part == 1.0 and middle - half > 1.0:
        return pitch_step(cage_speed, params.rollers.count, QUARTER_PITCH)
    steps = 1.0 / FIFTH_PITCH  # in a pitch; whole ones are added, so that they still sample all its instants alike
    steps += math.floor(steps * (1.0 / part - 1.0) + 0.5)
    return pitch_step(cage_speed, params.rollers.count, 1.0 / steps)


@kernel
def ring_weight(t, model):
    """Return the weight of the inner ring's position in the norm of an error: the tolerance of positions over what is allowed to the ring.

    A ring that vibrates by a part of the depth to which its load presses the rollers changes their loads by the same part, and lives by four times as
    much.  So the error allowed to it is `_RING_DEPTH` of that depth of the most heavily loaded roller, (4.1 F/(Z K))^0.9 (R. Stribeck's load of a
    bearing without clearance), where that is less than the tolerance.

    Parameters
    ----------
    t : time [s].
    model : `Model`.
    """
    load_y, load_z = load_at(t, model.drive)
    params, allowed = model.params, model.tolerances.position
    depth = (4.1 * math.sqrt(load_y * load_y + load_z * load_z) / (params.rollers.count * params.raceways.stiffness)) ** 0.9
    return max(allowed / max(_RING_DEPTH * depth, _LEAST_RING_ERROR * allowed), 1.0)


@kernel
def play_weight(cage_speed, pitch_radius):
    """Return the weight of play in the norm of a correction.

    The film of a pocket is a spring: what an iteration leaves of a roller's play is a force, and friction with it, that nothing else needs.  The
    faster pockets and rollers go round, the larger are the forces between them, and the less it counts.

    Parameters
    ----------
    cage_speed : [rad/s].
    pitch_radius : [m].
    """
    return _PLAY_WEIGHT / (1.0 + abs(cage_speed) * pitch_radius / _PLAY_SPEED)


class Tolerances(NamedTuple):
    """Error allowed in a step, see `bearing_sim.scene.scene.Integration`."""

    position: float  # of rollers and inner ring [m]
    play: float  # of rollers in their pockets, and of the cage [m]
    speed: float  # of a surface or a centre along the orbit [m/s]
    relative: float  # of the speed of ideal rolling, in addition


# The defaults of `bearing_sim.scene.scene.Integration`: tables and operating points do not depend on how a scene integrates.
DEFAULT_TOLERANCES = Tolerances(position=2.5e-6, play=5e-6, speed=1e-2, relative=0.01)


class Model(NamedTuple):
    """What the right-hand side depends on besides time and state."""

    params: Params
    lubrication: Lubrication
    drive: Drive
    tolerances: Tolerances


@kernel
def orbital_speed_tolerance(t, cage_speed, model):
    """Return the error allowed in an orbital speed [rad/s]: absolute + relative x ideal rolling.

    Where the cage is faster than ideal rolling, as after the shaft has stopped, its own speed is the scale.
    """
    raceways, allowed = model.params.raceways, model.tolerances
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(cage_speed))
    return allowed.speed / raceways.pitch_radius + allowed.relative * ideal
