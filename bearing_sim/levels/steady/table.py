# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A table of operating points of level ``steady`` over shaft speed, load, temperature, load direction and growth: symmetry and interpolant.

The symmetry of the outer raceway's contour saves directions of the load and the reverse sense of rotation.

Along each line of the grid the interpolant is the monotone cubic of Fritsch and Carlson (SIAM J. Numer. Anal. 17, 1980) with the
slopes of Fritsch and Butland (SIAM J. Sci. Stat. Comput. 5, 1984).  Within a cell the lines' departures from straight ones are
blended linearly from the cell's edges and added to the multilinear interpolant: of fourth order in the spacings, continuous,
and held between the least and the largest value at the cell's corners, so that nothing overshoots.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.numerics.compilation import kernel

_SYMMETRY_TOLERANCE = 1e-9  # m; tables of a contour are good to a fifth of it
_MOST_LOBES = 12
_PROBED = np.arange(997) * (2.0 * math.pi / 997)  # azimuths, a prime number of them: none falls together with its image
AXES = ("shaft_speed", "load", "oil_temperature", "load_angle", "growth")
_NODE = 1 + len(AXES)  # rows of a node: values, and slopes along each axis
_CORNERS = 2 ** len(AXES)
_SAME_GROWTH = 1e-9  # m; a table of one growth answers for growths so near


def radius_at(contour: np.ndarray, azimuths: np.ndarray) -> np.ndarray:
    """Return R_e [m] at azimuths [rad] from the periodic cubic table of `bearing_sim.physics.raceway`."""
    intervals = contour.shape[0]
    position = np.mod(azimuths / (2.0 * math.pi), 1.0) * intervals
    index = np.minimum(position.astype(int), intervals - 1)
    x = (position - index) * (2.0 * math.pi / intervals)
    a, b, c, d = contour[index].T
    return ((a * x + b) * x + c) * x + d


def symmetric_parts(params) -> tuple[np.ndarray, ...]:
    """Return what stands still and may be out of round, as periodic tables: the contour, and the bore round an outer ring that bends."""
    return (params.raceways.contour,) if params.outer_ring is None else (params.raceways.contour, params.outer_ring.bore)


def _varying(contours: Sequence[np.ndarray]) -> list[np.ndarray]:
    return [contour for contour in contours if np.ptp(radius_at(contour, _PROBED)) > _SYMMETRY_TOLERANCE]


def common_period(*contours: np.ndarray) -> float:
    """Return the smallest turn that leaves contours as they are, 2 pi over a whole number up to 12 [rad]; 0 where any turn does."""
    varying = _varying(contours)
    if not varying:
        return 0.0
    for lobes in range(_MOST_LOBES, 0, -1):
        period = 2.0 * math.pi / lobes
        if all(np.abs(radius_at(contour, _PROBED + period) - radius_at(contour, _PROBED)).max() <= _SYMMETRY_TOLERANCE for contour in varying):
            return period
    return 2.0 * math.pi


def mirror_axis(*contours: np.ndarray) -> float:
    """Return the azimuth of an axis about which all contours are their own mirror images [rad]; NaN where there is none."""
    varying = _varying(contours)
    if not varying:
        return 0.0
    waves = np.fft.rfft(radius_at(varying[0], _PROBED))
    waves[0] = 0.0
    strongest = int(np.abs(waves).argmax())
    # cos(n phi + a) is even about -a/n and every half wave further on
    for half in range(2 * strongest):
        axis = (half * math.pi - np.angle(waves[strongest])) / strongest
        if all(np.abs(radius_at(contour, axis + _PROBED) - radius_at(contour, axis - _PROBED)).max() <= _SYMMETRY_TOLERANCE for contour in varying):
            return float(axis)
    return math.nan


class Table(NamedTuple):
    """Answers on a grid; a table without knots answers nothing."""

    speeds: np.ndarray  # magnitudes of shaft speed from 0 on [rad/s]
    loads: np.ndarray  # from 0 on [N]
    temperatures: np.ndarray  # [K]; one of them answers for itself alone
    angles: np.ndarray  # of the load, from 0 to below the period [rad]
    growths: np.ndarray  # of the inner raceway beyond that of a bearing of one temperature [m]; 0 alone where temperatures are uniform
    period: float  # of the contour, 2 pi over a whole number [rad]
    mirror: float  # azimuth of an axis of symmetry of the contour [rad], NaN where there is none
    nodes: np.ndarray  # values and slopes by axis, shape (senses, speeds, loads, temperatures, angles, growths, 6, len(ANSWER))


class LookUp(NamedTuple):
    """Scratch of a look-up."""

    axes: np.ndarray  # by axis: positions of both knots, width, fraction of it, two cubics of that; shape (5, 6)
    weights: np.ndarray  # of a corner's value and slopes, shape (6,)
    bounds: np.ndarray  # least and largest value at the corners, shape (2, len(ANSWER))


def empty_table() -> Table:
    """Return a table that answers nothing."""
    nothing = np.zeros(0)
    return Table(nothing, nothing, nothing, nothing, nothing, 2.0 * math.pi, math.nan, np.zeros((0, 0, 0, 0, 0, 0, _NODE, len(ANSWER))))


def new_look_up() -> LookUp:
    """Return memory for a look-up."""
    return LookUp(np.zeros((len(AXES), 6)), np.zeros(_NODE), np.zeros((2, len(ANSWER))))


def monotone_slopes(knots: np.ndarray, values: np.ndarray, axis: int, period: float = 0.0) -> np.ndarray:
    """Return the slopes of the monotone cubic along an axis (Fritsch and Butland 1984), of the shape of ``values``.

    Parameters
    ----------
    knots : rising, shape (n,).
    values : any shape with n along ``axis``.
    axis : along which.
    period : of the knots, 0 where they do not close.
    """
    values = np.moveaxis(values, axis, 0)
    slopes = np.zeros_like(values)
    count = len(knots)
    if count > 1:
        widths = np.diff(knots, append=knots[0] + period) if period else np.diff(knots)
        shape = (-1,) + (1,) * (values.ndim - 1)
        rises = (np.diff(values, axis=0, append=values[:1]) if period else np.diff(values, axis=0)) / widths.reshape(shape)
        before, after = (np.roll(rises, 1, axis=0), rises) if period else (rises[:-1], rises[1:])
        w, v = (np.roll(widths, 1), widths) if period else (widths[:-1], widths[1:])
        w, v = w.reshape(shape), v.reshape(shape)
        with np.errstate(divide="ignore", invalid="ignore"):
            mean = 3.0 * (w + v) / ((w + 2.0 * v) / before + (2.0 * w + v) / after)
        inner = np.where(before * after > 0.0, mean, 0.0)
        if period:
            slopes = inner
        else:
            slopes[1:-1] = inner
            slopes[0], slopes[-1] = _end_slope(rises, widths, 0, 1), _end_slope(rises, widths, -1, -2)
    return np.moveaxis(slopes, 0, axis)


def _end_slope(rises, widths, end, inner):
    """Return the slope of the parabola through the three last knots, bounded so that the cubic stays monotone."""
    if len(widths) == 1:
        return rises[0]
    slope = ((2.0 * widths[end] + widths[inner]) * rises[end] - widths[end] * rises[inner]) / (widths[end] + widths[inner])
    slope = np.where(slope * rises[end] > 0.0, slope, 0.0)
    steep = (rises[end] * rises[inner] <= 0.0) & (np.abs(slope) > 3.0 * np.abs(rises[end]))
    return np.where(steep, 3.0 * rises[end], slope)


@kernel
def _locate(value, knots, period, row):
    """Write where a value lies between the knots of an axis."""
    last = knots.shape[0] - 1
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if value < knots[middle]:
            high = middle
        else:
            low = middle
    if period > 0.0 and last > 0 and value >= knots[last]:
        low, high = last, 0
        width = period - knots[last] + knots[0]
    else:
        width = knots[high] - knots[low]
    fraction = (value - knots[low]) / width if width > 0.0 else 0.0
    left = 1.0 - fraction
    row[0], row[1], row[2], row[3] = low, high, width, fraction
    row[4], row[5] = fraction * left * left, fraction * fraction * left


@kernel
def covers(speed, load, temperature, growth, table):
    """Return whether the table answers for a condition; see `look_up`."""
    if table.nodes.shape[1] == 0:
        return False
    if speed < 0.0 and math.isnan(table.mirror) and table.nodes.shape[0] == 1:
        return False
    if abs(speed) > table.speeds[-1] or load > table.loads[-1]:
        return False
    if growth < table.growths[0] - _SAME_GROWTH or growth > table.growths[-1] + _SAME_GROWTH:
        return False
    return table.temperatures[0] <= temperature <= table.temperatures[-1]


@kernel
def look_up(speed, load, temperature, angle, growth, table, scratch, answer):
    """Interpolate between the table's nodes; the condition must be one that it `covers`.

    Parameters
    ----------
    speed : of the shaft, signed [rad/s].  Reverse rotation is that of the mirrored bearing, or has nodes of its own.
    load : magnitude [N].
    temperature : [K].
    angle : direction of the load [rad].
    growth : of the inner raceway beyond that of a bearing of one temperature [m].
    table : `Table`.
    scratch : memory of `new_look_up`.
    answer : result, shape (len(ANSWER),); NaN beside a node without an answer.
    """
    sense = 0
    if speed < 0.0:
        if math.isnan(table.mirror):
            sense = 1
        else:
            angle = 2.0 * table.mirror - angle
    angle -= table.period * math.floor(angle / table.period)
    axes, weights, bounds = scratch.axes, scratch.weights, scratch.bounds
    _locate(abs(speed), table.speeds, 0.0, axes[0])
    _locate(load, table.loads, 0.0, axes[1])
    _locate(temperature, table.temperatures, 0.0, axes[2])
    _locate(angle, table.angles, table.period, axes[3])
    _locate(min(max(growth, table.growths[0]), table.growths[-1]), table.growths, 0.0, axes[4])
    columns = answer.shape[0]
    for column in range(columns):
        answer[column] = 0.0
        bounds[0, column], bounds[1, column] = math.inf, -math.inf
    corners = _CORNERS if table.growths.shape[0] > 1 else _CORNERS // 2
    for corner in range(corners):
        straight, skip = 1.0, False
        for axis in range(5):
            upper = (corner >> axis) & 1
            straight *= axes[axis, 3] if upper else 1.0 - axes[axis, 3]
            skip = skip or (upper == 1 and axes[axis, 2] == 0.0)  # an axis of one knot
        if skip:
            continue
        weights[0] = straight
        for axis in range(5):
            upper, others = (corner >> axis) & 1, 1.0
            for other in range(5):
                if other != axis:
                    others *= axes[other, 3] if (corner >> other) & 1 else 1.0 - axes[other, 3]
            bend = axes[axis, 4] - axes[axis, 5]
            if axes[axis, 2] == 0.0:
                bend = 0.0
            weights[0] += others * (-bend if upper else bend)
            weights[1 + axis] = others * axes[axis, 2] * (-axes[axis, 5] if upper else axes[axis, 4])
        node = table.nodes[
            sense,
            int(axes[0, corner & 1]),
            int(axes[1, (corner >> 1) & 1]),
            int(axes[2, (corner >> 2) & 1]),
            int(axes[3, (corner >> 3) & 1]),
            int(axes[4, (corner >> 4) & 1]),
        ]
        for column in range(columns):
            value = node[0, column]
            answer[column] += (
                weights[0] * value
                + weights[1] * node[1, column]
                + weights[2] * node[2, column]
                + weights[3] * node[3, column]
                + weights[4] * node[4, column]
                + weights[5] * node[5, column]
            )
            bounds[0, column], bounds[1, column] = min(bounds[0, column], value), max(bounds[1, column], value)
    for column in range(columns):
        if answer[column] < bounds[0, column]:  # NaN goes through
            answer[column] = bounds[0, column]
        elif answer[column] > bounds[1, column]:
            answer[column] = bounds[1, column]
