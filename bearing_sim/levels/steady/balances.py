# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All states in which a cage stays under the same inputs, and the load below which it stays in a skid.

Thick oil brakes a cage that is slow beside its rollers more than a light load drives it.  A cage that rolls then goes on rolling, and one that skids,
as after a start with cold oil or while the load was low, goes on skidding.  The scan of an operating point (`bearing_sim.levels.steady.operating_point`)
sees where the mean drive of a cage changes from braking to driving: each such slip is a state of its own.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import Drive, Model
from bearing_sim.levels.steady.model import Work, forget, solve_condition
from bearing_sim.levels.steady.operating_point import ANSWER, CREEP, SCANNED, at_angles, basin, between, first_angles, goes_on_skidding, scan, stable_balances

_LEAST, _MOST = 1e-4, 0.5  # loads between which a skid load is sought, over the static load rating
_STEP, _WITHIN = 2.0, 1.02  # ratios of loads that are looked at: of the first ones, and of both ends of what is left at last


class Balance(NamedTuple):
    """A state in which a cage stays."""

    answer: np.ndarray  # columns `bearing_sim.levels.steady.operating_point.ANSWER`
    basin: tuple[float, float]  # slips between which a cage comes to it

    @property
    def slip(self) -> float:
        """The cage's slip."""
        return float(self.answer[ANSWER.cage_slip])


def balances(shaft_speed: float, load_y: float, load_z: float, model, work: Work) -> list[Balance]:
    """Return all states in which a cage stays, the one to which it comes from ideal rolling first.

    Parameters
    ----------
    shaft_speed, load_y, load_z : [rad/s, N].
    model : of the level, its lubrication that of the condition; its drive goes unused.
    work : of the level; its last answer is that from ideal rolling.
    """
    found = []
    if not solve_condition(shaft_speed, load_y, load_z, model, work, to_standstill=True):
        return found
    rolling, scanned = Balance(work.solved.copy(), tuple(work.basin.tolist())), work.orbit.scanned.copy()
    for low, high in stable_balances(scanned):
        reached = basin(low, high, scanned)
        if reached == rolling.basin:
            continue
        start = 1.0 if high == len(SCANNED) else float(SCANNED[high])
        if solve_condition(shaft_speed, load_y, load_z, model, work, start):
            found.append(Balance(work.solved.copy(), reached))
    solve_condition(shaft_speed, load_y, load_z, model, work)
    return [rolling, *found]


def skid_load(shaft_speed: float, load_angle: float, slip: float, rating: float, model, work: Work) -> float:
    """Return the load [N] below which a skid lasts: a cage that skids goes on skidding, although one that rolls goes on rolling.

    Parameters
    ----------
    shaft_speed : [rad/s].
    load_angle : direction of the load [rad].
    slip : above which a cage counts as skidding.
    rating : static load rating of the bearing [N].
    model, work : as of `balances`.

    Returns
    -------
    load : 0 where no skid lasts: the cage comes back from it under every load that lets it roll.
    """
    speed = shaft_speed if abs(shaft_speed) > CREEP else math.copysign(CREEP, shaft_speed)
    count = model.params.rollers.count
    orbit = at_angles(first_angles(count), count, work.orbit)

    def at(load: float):
        drive = Drive(0.0, speed, 0.0, load * math.cos(load_angle), 0.0, load * math.sin(load_angle), 0.0, 0.0)
        return Model(model.params, model.lubrication, drive, model.tolerances)

    def lasts(load: float) -> bool:
        return goes_on_skidding(slip, at(load), work.bearing, orbit)

    above = rating * _LEAST
    while lasts(above):
        above *= _STEP
        if above > rating * _MOST:
            return math.inf
    below = above / _STEP
    while above / below > _WITHIN:
        middle = math.sqrt(above * below)
        below, above = (middle, above) if lasts(middle) else (below, middle)
    scan(False, at(below), work.bearing, orbit)
    forget(work)
    low, high = between(0.0, orbit.scanned)
    return below if 0 <= low and high < len(SCANNED) and SCANNED[high] <= slip else 0.0
