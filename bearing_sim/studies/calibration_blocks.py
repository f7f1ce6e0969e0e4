# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A measured cage speed cut into blocks in which the bearing has settled, and the operating points that blocks share.

Slip follows a change of conditions within a few tenths of a second; where conditions have changed by more than a little since shortly
before a block, what is measured there says as much of the change as of the bearing, and the block is left out.
"""

from collections import Counter
from typing import NamedTuple

import numpy as np

from bearing_sim.simulation import Inputs

SPEED_CHANGE, LOAD_CHANGE = 0.02, 0.25  # relative, over a block and what settles before it
_SETTLING = 0.5  # s; lags of settled cages are below a third of it
_SHORTEST, _LONGEST, _BLOCKS = 0.1, 1.0, 120  # s, and how many blocks a short recording should give
_FULL = 0.5  # of the usual number of messages: a block with less, or cut short by the end, is left out
_MOST_POINTS = 400
_NEAR = (0.01, 0.02, 0.02, 1.0)  # speed and loads, of the largest, and temperature [K]: so near, blocks share an operating point
_COARSER = 1.5


class Blocks(NamedTuple):
    """Blocks of measurement, n of them.

    Attributes
    ----------
    length : of a block [s].
    times : of their middles [s], shape (n,).
    slip : mean measured cage slip, shape (n,).
    scatter : standard deviation of the slips of single messages in a block, shape (n,).
    lead : shaft acceleration over shaft speed [1/s], shape (n,); times the cage's lag it is how much slip the lag adds.
    conditions : mean inputs at the times of the messages, columns as `bearing_sim.simulation.Inputs`, shape (n, 4); a temperature of NaN
        stands for the scene's.
    left_out : how many blocks were, by reason.
    """

    length: float
    times: np.ndarray
    slip: np.ndarray
    scatter: np.ndarray
    lead: np.ndarray
    conditions: np.ndarray
    left_out: Counter


class Points(NamedTuple):
    """Operating points that blocks share, m of them.

    Attributes
    ----------
    conditions : means over their blocks, shape (m, 4).
    place : of each block's point, shape (n,).
    """

    conditions: np.ndarray
    place: np.ndarray


class Measured(NamedTuple):
    """A measured course.

    Attributes
    ----------
    times : instants of the inputs [s], rising, shape (k,).
    inputs : conditions there, linear in between, shape (k, 4).
    gaps : (from, to) [s] without good inputs.
    cage_times, cage_speeds : of the measured cage [s], rising, and [rad/s], shape (q,).
    """

    times: np.ndarray
    inputs: np.ndarray
    gaps: list[tuple[float, float]]
    cage_times: np.ndarray
    cage_speeds: np.ndarray


def block_length(seconds: float) -> float:
    """Return how long blocks of a recording are [s]: a second, less in a short one."""
    return float(np.clip(seconds / _BLOCKS, _SHORTEST, _LONGEST))


def cut(measured: Measured, diameter_ratio: float, from_speed: float, length: float) -> Blocks:
    """Cut a measured course into blocks and keep those in which the bearing has settled.

    Parameters
    ----------
    measured : the course.
    diameter_ratio : gamma of the bearing.
    from_speed : shaft speed below which slip means nothing [rad/s].
    length : of a block [s].
    """
    begin, end = measured.times[0], measured.times[-1]
    inside = (measured.cage_times >= begin) & (measured.cage_times <= end)
    for first, last in measured.gaps:
        inside &= ~((measured.cage_times > first) & (measured.cage_times < last))
    times, speeds = measured.cage_times[inside], measured.cage_speeds[inside]
    inputs = np.stack([np.interp(times, measured.times, column) for column in measured.inputs.T], axis=-1)  # as the cage was measured, then
    with np.errstate(divide="ignore", invalid="ignore"):
        slips = 1.0 - speeds / (0.5 * inputs[:, 0] * (1.0 - diameter_ratio))
    numbers = np.floor((times - begin) / length).astype(int)
    usual = np.median(np.unique(numbers, return_counts=True)[1]) if len(numbers) else 0.0
    resets = [begin, *(last for _, last in measured.gaps)]
    kept, left_out = [], Counter()
    for number in np.unique(numbers):
        mine = numbers == number
        edges = begin + length * number, min(begin + length * (number + 1), end)
        part = edges[1] - edges[0] < _FULL * length or mine.sum() < _FULL * usual
        why = "with few messages" if part else _unsettled(measured, edges, from_speed, resets)
        if why:
            left_out[why] += 1
            continue
        kept.append((times[mine].mean(), slips[mine].mean(), slips[mine].std(), _lead(measured, edges), inputs[mine].mean(axis=0)))
    middles, slip, scatter, lead = (np.array([row[column] for row in kept]) for column in range(4))
    return Blocks(length, middles, slip, scatter, lead, np.array([row[4] for row in kept]).reshape(-1, len(Inputs._fields)), left_out)


def _within(measured: Measured, edges: tuple[float, float]) -> np.ndarray:
    """Return conditions between two times, both ends included."""
    first, last = np.searchsorted(measured.times, edges)
    times = np.concatenate([edges[:1], measured.times[first:last], edges[1:]])
    return np.stack([np.interp(times, measured.times, column) for column in measured.inputs.T], axis=-1)


def _unsettled(measured: Measured, edges: tuple[float, float], from_speed: float, resets: list[float]) -> str:
    before = edges[0] - _SETTLING
    if any(before < reset <= edges[1] for reset in resets):
        return "at the start or after a gap"
    seen = _within(measured, (before, edges[1]))
    speed, load = np.abs(seen[:, 0]), np.hypot(seen[:, 1], seen[:, 2])
    if speed.min() < from_speed:
        return "at rest"
    if np.ptp(seen[:, 0]) > SPEED_CHANGE * speed.mean():
        return "at a changing speed"
    if np.ptp(load) > LOAD_CHANGE * load.mean():
        return "at a changing load"
    return ""


def _lead(measured: Measured, edges: tuple[float, float]) -> float:
    """Return mean shaft acceleration over mean shaft speed [1/s]."""
    first, last = (np.interp(edge, measured.times, measured.inputs[:, 0]) for edge in edges)
    return 2.0 * (last - first) / (edges[1] - edges[0]) / (first + last)


def shared_points(conditions: np.ndarray) -> Points:
    """Return the operating points of blocks; of blocks whose conditions are nearly the same the means, which keeps errors of first order out.

    Parameters
    ----------
    conditions : as of `Blocks`.
    """
    known = np.nan_to_num(conditions)
    largest = np.maximum(np.abs(known).max(axis=0), 1e-9)
    load = max(np.hypot(known[:, 1], known[:, 2]).max(), 1e-9)
    near = np.array([_NEAR[0] * largest[0], _NEAR[1] * load, _NEAR[2] * load, _NEAR[3]])
    while True:
        _, place = np.unique(np.round(known / near), axis=0, return_inverse=True)
        place = place.ravel()
        count = place.max() + 1
        if count <= _MOST_POINTS:
            break
        near *= _COARSER
    sums = np.array([np.bincount(place, column, count) for column in conditions.T]).T
    return Points(sums / np.bincount(place, minlength=count)[:, None], place)
