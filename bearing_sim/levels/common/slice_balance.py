# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The bearing of a scene in quasi-static balance by slices: where ring and rollers are and what every slice carries.

Rollers stand at even steps behind the cage and turn with it; of their motion only the centrifugal force matters.  This is the load
distribution of ISO/TS 16281 with both raceways kept apart, so that it holds at speed and with any contour, too.
"""

import math

import numpy as np

from bearing_sim.model.params import Params
from bearing_sim.numerics.compilation import kernel
from bearing_sim.physics.lamina import ROLLER_ROW, balance_slices, new_slices
from bearing_sim.physics.raceway import contour_at


@kernel
def place_rollers(cage_angle, cage_speed, growth, params, slices):
    """Write azimuths, approaches and centrifugal forces of all rollers into ``slices.roller``.

    Parameters
    ----------
    cage_angle, cage_speed : of the cage [rad, rad/s]; roller 0 stands at the cage's angle.
    growth : of the inner raceway's radius [m], see `bearing_sim.levels.common.model.inner_growth`.
    params : `bearing_sim.model.params.Params`.
    slices : `bearing_sim.physics.lamina.Slices`.
    """
    rollers, raceways, row = params.rollers, params.raceways, ROLLER_ROW
    for j in range(rollers.count):
        azimuth = cage_angle + 2.0 * math.pi * j / rollers.count
        turn = azimuth / (2.0 * math.pi)
        turn -= math.floor(turn)
        radius, _ = contour_at(raceways.contour, turn * raceways.contour.shape[0])
        slices.roller[row.cosine, j], slices.roller[row.sine, j] = math.cos(azimuth), math.sin(azimuth)
        slices.roller[row.squeeze, j] = raceways.inner_radius + growth + 2.0 * rollers.radius - radius
        slices.roller[row.centrifugal, j] = rollers.mass * (radius - rollers.radius) * cage_speed * cage_speed


def balance(
    params: Params,
    cage_angle: float,
    cage_speed: float,
    load: tuple[float, float],
    moment: tuple[float, float] = (0.0, 0.0),
    tilts: tuple[float, float] | None = None,
    slices=None,
    growth: float = 0.0,
    deflections: np.ndarray | None = None,
):
    """Return the bearing in balance, as `bearing_sim.physics.lamina.Slices`.

    Parameters
    ----------
    params : of the bearing; its crown table gives the slices.
    cage_angle, cage_speed : of the cage [rad, rad/s].
    load : radial load (y, z) on the inner ring [N].
    moment : moment about (y, z) on it [N m]; without effect where the tilts are given.
    tilts : the ring's tilts about (y, z) [rad]; None lets it tilt until the moments balance.
    slices : a balance nearby to start from, overwritten.
    growth : of the inner raceway's radius [m], see `bearing_sim.levels.common.model.inner_growth`.
    deflections : how far an outer ring that bends stands further outwards at the rollers [m], shape (Z,); None: it is rigid.

    Raises
    ------
    ArithmeticError
        No balance was found, or an input is not finite.
    """
    inputs = (cage_angle, cage_speed, *load, *moment, *(tilts or ()), growth)
    if not all(map(math.isfinite, inputs)):
        raise ArithmeticError(f"no balance by slices of inputs that are not finite: {inputs}")
    if slices is None:
        slices = new_slices(params.rollers.count, params.slices.crown, params.rollers.length, params.raceways.stiffness)
    if tilts is not None:
        slices.ring[2:] = tilts
    place_rollers(float(cage_angle), float(cage_speed), float(growth), params, slices)
    if deflections is not None:
        slices.roller[ROLLER_ROW.squeeze] -= deflections
    if not balance_slices(float(load[0]), float(load[1]), float(moment[0]), float(moment[1]), tilts is None, slices):
        raise ArithmeticError(f"the balance by slices did not converge at load {load} N, moment {moment} N m, cage {cage_speed:.6g} rad/s")
    return slices


def roller_tilts(slices) -> np.ndarray:
    """Return each roller's tilt in the plane of shaft and azimuth [rad], shape (Z,); positive presses the end at positive x outwards."""
    return slices.roller[ROLLER_ROW.tilt] / slices.half_length


def roller_loads(slices) -> tuple[np.ndarray, np.ndarray]:
    """Return the loads of all rollers on the inner and the outer raceway [N], shape (Z,) each."""
    return slices.inner.sum(axis=1), slices.outer.sum(axis=1)


def about_yz(amount: float, azimuth: float) -> tuple[float, float]:
    """Return a tilt or a moment about (y, z) that leans the ring's +x end towards an azimuth [rad]."""
    return -amount * math.sin(azimuth), amount * math.cos(azimuth)


def leaning(tilt_y: float, tilt_z: float) -> tuple[float, float]:
    """Return amount and azimuth [rad] of a tilt or a moment about y and z: the inverse of `about_yz`."""
    return math.hypot(tilt_y, tilt_z), math.atan2(-tilt_y, tilt_z)
