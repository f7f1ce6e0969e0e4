# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Totals of a bearing's running: damage, revolutions, hours, starts, hours by regime, and extremes; of all its time, or of one day.

A regime is a class of slip, of lubrication or of load.  The bounds stay as they are, so that hours of years can be added up:

- slip: `SLIP_BOUNDS`, the defaults of the thresholds for a warning and an error (Deng et al. 2017 allow 10 %);
- lubrication: `KAPPA_BOUNDS` of the viscosity ratio kappa, at which ISO 281:2007 changes its formula for a_ISO and beyond which it has none;
- load: `LOAD_BOUNDS` of P/C: the minimum load of roller bearings by SKF, 0.1 (*assumption*: a usual load), and the limit of ISO 281, 0.5.
"""

import dataclasses
import math
from dataclasses import dataclass, field
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, FiniteFloat

from bearing_sim.model.turning import turns
from bearing_sim.scene.ratings import rate
from bearing_sim.scene.scene import Scene

SLIP_BOUNDS = (0.05, 0.1)
KAPPA_BOUNDS = (0.1, 0.4, 1.0, 4.0)
LOAD_BOUNDS = (0.02, 0.1, 0.5)
_LEAST_OF_OPERATING = 0.01  # of the operating speed: a shaft that is made to turn slower than slip counts runs from here on
_STOPPED = 0.5  # of the speed from which on the shaft runs: below, it has stopped, and the next running is a start
_HOUR = 3600.0  # [s]


def _number(value: object) -> object:
    if isinstance(value, (bool, str)):
        raise ValueError("expected a number")
    return value


Amount = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
"""A sum in a state file."""
Instant = Annotated[int, BeforeValidator(_number), Field(ge=0, lt=2**63)]
"""A time [ns since the epoch] or a count in a state file."""


class Extreme(NamedTuple):
    """The largest or the lowest value of a quantity so far."""

    value: FiniteFloat
    time_ns: Instant


class Criteria(NamedTuple):
    """What the samples of a scene are classed by.

    Attributes
    ----------
    fastest : the speed of the scene's operating conditions [rad/s].
    slip_from_speed : speed from which on the shaft turns, and its slip counts [rad/s] (`bearing_sim.model.turning`).
    dynamic_rating : C [N].
    """

    fastest: float
    slip_from_speed: float
    dynamic_rating: float

    @property
    def runs_from(self) -> float:
        """Speed from which on the shaft runs [rad/s]: it also does where it is made to turn slower than slip counts."""
        return min(self.slip_from_speed, _LEAST_OF_OPERATING * self.fastest or self.slip_from_speed)


def criteria(scene: Scene) -> Criteria:
    """Return what the samples of a scene are classed by."""
    return Criteria(abs(scene.operating.shaft_speed), scene.thresholds.slip_from_speed, rate(scene.bearing).dynamic)


def _zeros(classes: int):
    return field(default_factory=lambda: [0.0] * classes)


def _amounts(classes: int):
    return Annotated[list[Amount], Field(min_length=classes, max_length=classes)]


@dataclass
class Totals:
    """Sums and extremes over a time.

    Attributes
    ----------
    damage : fraction of the rating life used, by the life that the scene counts (Miner).
    basic_damage : the same by the basic rating life of the scene's method, without reliability and oil.
    revolutions : of the shaft.
    monitored_seconds, running_seconds : time that was simulated, and how much of it the shaft ran [s].
    starts : how often the shaft began to run after a stop.
    slip_seconds, lubrication_seconds, load_seconds : running time by regime [s], one more than there are bounds; the last of slip and of
        lubrication is for samples without a slip that counts or without a viscosity ratio.
    largest_slip : from the scene's ``thresholds.slip_from_speed`` on; a fraction.  None before the first.
    lowest_clearance : the lowest running clearance [m], likewise.
    """

    damage: Amount = 0.0
    basic_damage: Amount = 0.0
    revolutions: Amount = 0.0
    monitored_seconds: Amount = 0.0
    running_seconds: Amount = 0.0
    starts: Instant = 0
    slip_seconds: _amounts(len(SLIP_BOUNDS) + 2) = _zeros(len(SLIP_BOUNDS) + 2)
    lubrication_seconds: _amounts(len(KAPPA_BOUNDS) + 2) = _zeros(len(KAPPA_BOUNDS) + 2)
    load_seconds: _amounts(len(LOAD_BOUNDS) + 1) = _zeros(len(LOAD_BOUNDS) + 1)
    largest_slip: Extreme | None = None
    lowest_clearance: Extreme | None = None

    def add(self, other: "Totals") -> None:
        """Add the sums of another time, and take its extremes where they are more extreme."""
        for name in _NUMBERS:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        for name in _CLASSES:
            setattr(self, name, [own + theirs for own, theirs in zip(getattr(self, name), getattr(other, name))])
        self.largest_slip = _further(self.largest_slip, other.largest_slip, 1.0)
        self.lowest_clearance = _further(self.lowest_clearance, other.lowest_clearance, -1.0)

    def subtract(self, other: "Totals") -> None:
        """Subtract the sums of a part of the time; extremes stay."""
        for name in _NUMBERS:
            setattr(self, name, max(getattr(self, name) - getattr(other, name), 0))
        for name in _CLASSES:
            setattr(self, name, [max(own - theirs, 0.0) for own, theirs in zip(getattr(self, name), getattr(other, name))])


_CLASSES = ("slip_seconds", "lubrication_seconds", "load_seconds")
_NUMBERS = tuple(each.name for each in dataclasses.fields(Totals) if each.name not in (*_CLASSES, "largest_slip", "lowest_clearance"))


def _further(own: Extreme | None, other: Extreme | None, sign: float) -> Extreme | None:
    if own is None or other is None:
        return own or other
    return other if sign * other.value > sign * own.value else own


def totals_of(block: np.ndarray, times_ns: np.ndarray, seconds: np.ndarray, used: np.ndarray, by: Criteria, was_turning: bool) -> tuple[Totals, bool]:
    """Return the totals of samples, and whether the shaft turns at their end.

    Parameters
    ----------
    block : samples in order, shape (n,), n at least 1; see `bearing_sim.model.sample`.
    times_ns : of the samples [ns since the epoch], shape (n,).
    seconds : simulated time that each sample stands for, which ends at it [s], shape (n,); 0 where it does not count.
    used : fraction of life used in that time, shape (n,).
    by : what the samples are classed by.
    was_turning : whether the shaft turned before.
    """
    speeds = np.abs(block["shaft_speed"])
    runs = turns(speeds, by.runs_from)
    running = np.where(runs, seconds, 0.0)
    phases = runs.astype(int) - (~runs & ~turns(speeds / _STOPPED, by.runs_from)) * 1  # 1 runs, -1 stands, 0 neither
    slips = np.where(turns(speeds, by.slip_from_speed), np.abs(block["cage_slip"]), np.nan)
    phases = np.concatenate(([1 if was_turning else -1], phases[(phases != 0) & (seconds > 0.0)]))
    lives = block["rating_life"]
    rates = np.where(lives > 0.0, 1.0 / np.where(lives > 0.0, lives, 1.0), 0.0) / _HOUR
    totals = Totals(
        damage=float(used.sum()),
        basic_damage=float((seconds * rates).sum()),
        revolutions=float((speeds * seconds).sum()) / (2.0 * math.pi),
        monitored_seconds=float(seconds.sum()),
        running_seconds=float(running.sum()),
        starts=int(((phases[1:] == 1) & (phases[:-1] == -1)).sum()),
        slip_seconds=_by_class(slips, running, SLIP_BOUNDS, has_unknown=True),
        lubrication_seconds=_by_class(block["viscosity_ratio"], running, KAPPA_BOUNDS, has_unknown=True),
        load_seconds=_by_class(np.hypot(block["load_y"], block["load_z"]) / by.dynamic_rating, running, LOAD_BOUNDS),
        largest_slip=_extreme(slips, times_ns, seconds, np.nanargmax),
        lowest_clearance=_extreme(block["running_clearance"], times_ns, seconds, np.nanargmin),
    )
    return totals, bool(phases[-1] == 1)


def _by_class(values: np.ndarray, seconds: np.ndarray, bounds: tuple[float, ...], has_unknown: bool = False) -> list[float]:
    classes = np.digitize(values, bounds)
    if has_unknown:
        classes = np.where(np.isnan(values), len(bounds) + 1, classes)
    return np.bincount(classes, seconds, len(bounds) + 1 + has_unknown).tolist()


def _extreme(values: np.ndarray, times_ns: np.ndarray, seconds: np.ndarray, place_of) -> Extreme | None:
    values = np.where(seconds > 0.0, values, np.nan)
    if not np.isfinite(values).any():
        return None
    place = int(place_of(np.where(np.isfinite(values), values, np.nan)))
    return Extreme(float(values[place]), int(times_ns[place]))
