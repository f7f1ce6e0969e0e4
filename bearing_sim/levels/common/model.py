# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What the equations of every level depend on: parameters, oil, inputs in time; and the longest sensible step."""

import math
from typing import NamedTuple

from bearing_sim.model.params import Lubrication, Params
from bearing_sim.numerics.compilation import template
from bearing_sim.physics.growth import total_growth

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # golden section: the number that ratios of integers approximate worst
HALF_PITCH = 1.0 / (2.0 + 1.0 / (3.0 + GOLDEN))  # 0.4393
FIFTH_PITCH = 1.0 / (4.0 + GOLDEN)  # 0.2165
POSITION_WEIGHT = 0.25  # of positions in the norm of a correction (assumption): contacts leave less of a correction than tractions do


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


@template
def shaft_speed_at(t, drive):
    """Return the shaft speed [rad/s] at a time [s]."""
    return drive.shaft_speed + drive.shaft_acceleration * (t - drive.start)


@template
def shaft_angle_at(t, drive):
    """Return the shaft's angle [rad] at a time [s]."""
    elapsed = t - drive.start
    return drive.shaft_angle + (drive.shaft_speed + 0.5 * drive.shaft_acceleration * elapsed) * elapsed


@template
def load_at(t, drive):
    """Return the radial load (y, z) [N] at a time [s]."""
    elapsed = t - drive.start
    return drive.load_y + drive.load_y_rate * elapsed, drive.load_z + drive.load_z_rate * elapsed


@template
def inner_growth(shaft_speed, model):
    """Return the growth of the inner raceway's radius [m] by fits, rotation and heat (see `bearing_sim.physics.growth`).

    Parameters
    ----------
    shaft_speed : [rad/s].
    model : `bearing_sim.levels.common.model.Model`.
    """
    return total_growth(shaft_speed, model.lubrication.growth)


@template
def pitch_step(cage_speed, rollers, fraction):
    """Return the longest sensible step [s], a fraction of a roller pitch of cage rotation, so that no lobe is jumped over.

    The rollers together repeat themselves each pitch: a step of half a pitch would sample the same two instants of it again and again and
    take them for the mean.  A fraction that no small denominator approximates samples all instants alike.  *Assumption*: the fractions.

    Parameters
    ----------
    cage_speed : [rad/s]; a cage at rest counts as 1e-3 rad/s.
    rollers : number of rollers, Z.
    fraction : of a pitch, such as `HALF_PITCH`.
    """
    return fraction * 2.0 * math.pi / (rollers * max(abs(cage_speed), 1e-3))


class Tolerances(NamedTuple):
    """Error allowed in a step, see `bearing_sim.scene.scene.Integration`."""

    position: float  # of rollers and inner ring [m]
    play: float  # of rollers in their pockets, and of the cage [m]
    speed: float  # of a surface or a centre along the orbit [m/s]
    relative: float  # of the speed of ideal rolling, in addition


# The defaults of `bearing_sim.scene.scene.Integration`: tables and operating points do not depend on how a scene integrates.
DEFAULT_TOLERANCES = Tolerances(position=2.5e-6, play=5e-6, speed=1e-2, relative=0.03)


class Model(NamedTuple):
    """What the right-hand side depends on besides time and state."""

    params: Params
    lubrication: Lubrication
    drive: Drive
    tolerances: Tolerances


@template
def orbital_speed_tolerance(t, cage_speed, model):
    """Return the error allowed in an orbital speed [rad/s]: absolute + relative x ideal rolling.

    Where the cage is faster than ideal rolling, as after the shaft has stopped, its own speed is the scale.
    """
    raceways, allowed = model.params.raceways, model.tolerances
    ideal = max(0.5 * abs(shaft_speed_at(t, model.drive)) * (1.0 - raceways.diameter_ratio), abs(cage_speed))
    return allowed.speed / raceways.pitch_radius + allowed.relative * ideal
