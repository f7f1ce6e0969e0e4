# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a settled run is judged by: trajectories with impacts part in phase, means and quantiles do not."""

from typing import NamedTuple

import numpy as np

from bearing_sim.scene import Scene
from bearing_sim.simulation import Simulation

QUANTILES = (0.5, 0.9, 0.99)
_BLOCKS = 10
_RATE = 5000.0  # Hz; oftener would shorten the steps, seldom would leave quantiles to chance


class Settled(NamedTuple):
    """Means and quantiles over the window after settling, each with one standard error from the means of ten blocks of it."""

    slip: float  # mean cage slip [%]
    slip_spread: float
    loads: np.ndarray  # quantiles of inner and outer roller loads [N], shape (2, 3)
    loads_spread: np.ndarray
    orbit: float  # mean distance of the cage's centre from the axis [m]
    pocket: np.ndarray  # quantiles of the size of pocket forces [N], shape (3,)


def settle(scene: Scene, start: float, end: float) -> Settled:
    """Run a scene from ideal rolling and return its means and quantiles from ``start`` to ``end`` [s]."""
    samples = max(round((end - start) * _RATE), _BLOCKS)
    run = Simulation(scene)
    run.advance(start, samples=max(round(start * _RATE), 1))
    block = run.advance(end - start, samples=samples)
    slips, slip_spread = _with_spread(100.0 * block["cage_slip"], np.mean)
    loads = [_with_spread(block[name], _quantiles) for name in ("inner_load", "outer_load")]
    return Settled(
        float(slips),
        float(slip_spread),
        np.array([value for value, _ in loads]),
        np.array([spread for _, spread in loads]),
        float(np.hypot(block["cage_y"], block["cage_z"]).mean()),
        _quantiles(np.abs(block["pocket_force"])),
    )


def _quantiles(values):
    return np.quantile(values, QUANTILES)


def _with_spread(values, statistic):
    """Return a statistic and its standard error from blocks, which impacts far apart make independent."""
    blocks = np.array([statistic(part) for part in np.array_split(values, _BLOCKS)])
    return statistic(values), blocks.std(axis=0, ddof=1) / np.sqrt(_BLOCKS)


def slip_error(found: Settled, reference: Settled) -> float:
    """Return the error of the mean slip [percentage points]."""
    return abs(found.slip - reference.slip)


def quantile_error(found: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest relative error of quantiles in rows of rising probability.

    An unloaded half of the rollers has a median of 0: nothing is measured against less than a hundredth of the highest quantile.
    """
    scale = np.maximum(reference, 0.01 * reference[..., -1:])
    return float(np.max(np.abs(found - reference) / np.where(scale > 0.0, scale, 1.0)))


def orbit_error(found: Settled, reference: Settled) -> float:
    """Return the relative error of the cage's orbit; 0 at a level whose cage has none."""
    return abs(found.orbit - reference.orbit) / reference.orbit if reference.orbit > 0.0 else 0.0


def described(settled: Settled) -> dict:
    """Return a settled run in plain numbers and plot units."""
    return {
        "slip_percent": settled.slip,
        "slip_standard_error": settled.slip_spread,
        "inner_load_quantiles": settled.loads[0].tolist(),
        "outer_load_quantiles": settled.loads[1].tolist(),
        "load_quantile_standard_error": quantile_error(settled.loads + settled.loads_spread, settled.loads),
        "orbit_radius_um": 1e6 * settled.orbit,
        "pocket_force_quantiles": settled.pocket.tolist(),
    }
