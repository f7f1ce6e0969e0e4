# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Where the shaft of a run turns, so that slip, and whatever else is divided by its speed, counts.

Just above rest a quotient by the speed may have any size: the cage coasts at a fraction of a revolution while the shaft has stopped, and the slip is
minus a billion per cent.  One rule therefore says for every command, monitor, picture and page from which speed on such numbers enter means, maxima,
quantiles, thresholds and axes: ``thresholds.slip_from_speed`` of the scene.  A recording holds its scene.
"""

import math

import numpy as np

from bearing_sim.scene.scene import Thresholds

SLIP_FROM_SPEED = Thresholds().slip_from_speed
"""The speed [rad/s] of whoever has no scene: the one of scenes that name none."""

DIVIDED = ("cage_slip", "friction_moment", "rating_life", "modified_rating_life", "l10", "lnm", "l10r", "lnmr")
"""Observables that are divided by the shaft's speed."""

_REST = 1e-3  # [rad/s] assumption: below a hundredth of a revolution a minute a shaft stands, whatever the threshold; solvers leave 1e-14 behind


def turns(speeds: np.ndarray, slip_from_speed: float = SLIP_FROM_SPEED) -> np.ndarray:
    """Return whether the shaft turns, at ``slip_from_speed`` or faster in either sense.

    Parameters
    ----------
    speeds : of the shaft [rad/s], of any shape; it does not turn where one is NaN.
    slip_from_speed : ``thresholds.slip_from_speed`` of the scene [rad/s].
    """
    return np.abs(speeds) >= max(slip_from_speed, _REST)


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
