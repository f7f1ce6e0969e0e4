# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the shaft of a run turns, so that slip, and whatever else is divided by its speed, counts.

Just above rest a quotient by the speed may have any size: the cage coasts at a fraction of a revolution while the shaft has stopped, and the slip is
minus a billion per cent.  One rule therefore says for every command, monitor, picture and page from which speed on such numbers enter means, maxima,
quantiles, thresholds and axes: ``thresholds.slip_from_speed`` of the scene.  A recording holds its scene.

`Use` is what a run did to its bearing.  Its life and its hours are those of the time that was simulated: time in gaps of a log, in which nobody knows
what the bearing did, counts in neither.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.display import number
from bearing_sim.scene.scene import Thresholds

SLIP_FROM_SPEED = Thresholds().slip_from_speed
"""The speed [rad/s] of whoever has no scene: the one of scenes that name none."""

DIVIDED = ("cage_slip", "friction_moment", "rating_life", "modified_rating_life", "l10", "lnm", "l10r", "lnmr")
"""Observables that are divided by the shaft's speed."""


REST = 1e-3
"""[rad/s] assumption: below a hundredth of a revolution a minute a shaft stands, whatever the threshold; solvers leave 1e-14 behind."""


def turns(speeds: np.ndarray, slip_from_speed: float = SLIP_FROM_SPEED) -> np.ndarray:
    """Return whether the shaft turns, at ``slip_from_speed`` or faster in either sense.

    Parameters
    ----------
    speeds : of the shaft [rad/s], of any shape; it does not turn where one is NaN.
    slip_from_speed : ``thresholds.slip_from_speed`` of the scene [rad/s].
    """
    return np.abs(speeds) >= max(slip_from_speed, REST)


def stands_text(slip_from_speed: float) -> str:
    """Return in words that a shaft does not turn."""
    return f"the shaft is slower than {slip_from_speed * 30.0 / math.pi:.4g} rpm (thresholds.slip_from_speed)"


def slip_statistics(slip: np.ndarray, speed: np.ndarray, weight: np.ndarray, slip_from_speed: float = SLIP_FROM_SPEED) -> dict[str, float]:
    """Return mean, median, 95th and 99th percentile and maximum of the slip while the shaft turns, by name; NaN if it never does.

    Parameters
    ----------
    slip, speed, weight : of samples, shape (n,): slip, speed of the shaft [rad/s], and the time that each stands for [s].
    slip_from_speed : see `turns`.
    """
    slip, weight = np.asarray(slip, float), np.asarray(weight, float)
    counted = np.isfinite(slip) & turns(speed, slip_from_speed) & (weight > 0.0)
    if not counted.any():
        return dict.fromkeys(("mean", "median", "p95", "p99", "maximum"), math.nan)
    slip, weight = slip[counted], weight[counted]
    median, p95, p99 = np.percentile(slip, [50, 95, 99], weights=weight, method="inverted_cdf")
    statistics = {"mean": np.average(slip, weights=weight), "median": median, "p95": p95, "p99": p99, "maximum": slip.max()}
    return {name: float(value) for name, value in statistics.items()}


class Use(NamedTuple):
    """What a run did to its bearing, over the time that was simulated.

    Attributes
    ----------
    seconds : simulated.
    turning_seconds : of them, with the shaft turning (`turns`).
    skid_seconds : of those, under load with more slip than ``thresholds.slip_warning``.
    damage : fraction of the life used (Miner).
    """

    seconds: float
    turning_seconds: float
    skid_seconds: float
    damage: float

    @property
    def life_hours(self) -> float:
        """Life if the run were repeated: simulated time over damage [h]; infinite without damage."""
        return self.seconds / 3600.0 / self.damage if self.damage > 0.0 else math.inf

    def skid_text(self, thresholds: Thresholds) -> str:
        """Return in words for how long the cage skidded."""
        if not self.turning_seconds:
            return f"none: {stands_text(thresholds.slip_from_speed)}"
        share = f"{100.0 * self.skid_seconds / self.turning_seconds:.3g} % of the {span_text(self.turning_seconds)} that the shaft turns"
        return f"{span_text(self.skid_seconds)} with slip above {100.0 * thresholds.slip_warning:g} % under load, {share}"


def span_text(seconds: float) -> str:
    """Return a time in seconds up to two hours, in hours above."""
    return f"{number(seconds / 3600.0)} h" if seconds > 7200.0 else f"{number(seconds)} s"


def slipping_seconds(
    slip: np.ndarray, speed: np.ndarray, load: np.ndarray, weight: np.ndarray, above: float, slip_from_speed: float = SLIP_FROM_SPEED
) -> float:
    """Return for how long the shaft turned under a load with more slip than ``above`` [s]; without load a cage slips as it likes and harms nothing.

    Parameters
    ----------
    slip, speed, weight, slip_from_speed : see `slip_statistics`.
    load : radial [N], shape (n,).
    above : a slip.
    """
    counted = turns(np.asarray(speed, float), slip_from_speed) & (np.asarray(load) > 0.0) & (np.asarray(slip) > above)
    return float(np.asarray(weight, float)[counted].sum())


def use_of(
    slip: np.ndarray, speed: np.ndarray, load: np.ndarray, weight: np.ndarray, damage: float, thresholds: Thresholds, seconds: float | None = None
) -> Use:
    """Return what a run did to its bearing.

    Parameters
    ----------
    slip, speed, load, weight : of samples, see `slipping_seconds`; ``weight`` is the simulated time that each stands for [s].
    damage : of the run alone.
    thresholds : of the scene.
    seconds : simulated; the sum of the weights where absent.
    """
    weight = np.asarray(weight, float)
    turning = float(weight[turns(np.asarray(speed, float), thresholds.slip_from_speed)].sum())
    skid = slipping_seconds(slip, speed, load, weight, thresholds.slip_warning, thresholds.slip_from_speed)
    return Use(float(weight.sum()) if seconds is None else seconds, turning, skid, damage)
