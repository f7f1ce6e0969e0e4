# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One point of a sweep: a scene run until its slip has settled, and its row in the table."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.table import empty_table
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.model.validity import cell, outside
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation

DURATION = 0.5  # s, as Deng 2017 simulates
_WINDOW = 0.2  # of the duration, over which results are averaged; two more windows before it show whether they still change
_SAMPLES = 200
_MOST_DURATIONS = 8
_DRIFT, _RELATIVE_DRIFT = 1e-3, 0.01  # remaining change of the mean slip that counts as settled
_SLOWEST = 0.98  # largest ratio of successive changes of slip that is taken as converging
OK, UNSETTLED, FAILED, REFUSED = "ok", "unsettled", "failed", "refused"


class Column(NamedTuple):
    """One column of results."""

    name: str
    unit: str
    meaning: str
    factor: float = 1.0  # from SI to the unit


_LIVES = ("rating_life", "modified_rating_life", "l10", "lnm", "l10r", "lnmr")
_MEANS = ("inner_equivalent_load", "outer_equivalent_load", "land_eccentricity")
_POWERS = tuple(each.name for each in OBSERVABLES if each.name.endswith("_power"))
_OBSERVED = {each.name: each for each in OBSERVABLES}


def _observed(names) -> list[Column]:
    return [Column(name, _OBSERVED[name].unit, f"{_OBSERVED[name].meaning}; mean") for name in names]


RESULTS = (
    Column("cage_slip", "%", "cage slip, 1 - cage speed / ideal cage speed (Deng 2017, eq. 17), mean", 100.0),
    Column("cage_slip_minimum", "%", "least cage slip at an instant", 100.0),
    Column("cage_slip_maximum", "%", "largest cage slip at an instant", 100.0),
    *_observed(_LIVES),
    Column("inner_load_maximum", "N", "largest normal force between a roller and the inner raceway at an instant"),
    Column("outer_load_maximum", "N", "largest normal force between a roller and the outer raceway at an instant"),
    Column("loaded_rollers", "", "rollers between both raceways at an instant, mean"),
    *_observed(_MEANS),
    *_observed(_POWERS),
    Column("simulated", "s", "simulated time; results are of its end"),
)
TEXTS = (
    Column("status", "", "ok; unsettled: slip was still changing at the end; failed: the run stopped early; refused: the scene is invalid"),
    Column("reason", "", "why the status is not ok"),
    Column("warnings", "", "laws used outside of their ranges, each with its worst value"),
)


def settle(scene: Scene, duration: float = DURATION) -> tuple[np.ndarray, float, str]:
    """Run a scene under its constant conditions from ideal rolling until its slip has settled.

    The run ends with three windows, each a fifth of the duration.  Their mean slips give the remaining change of an exponential
    approach to the settled state; while that exceeds 0.1 points and 1 %, the run is extended by the same duration, up to eight times.

    Parameters
    ----------
    scene : of any level; level ``steady`` solves for its operating point without a table.
    duration : of the run if it settles without extension [s].

    Returns
    -------
    window : samples of the last fifth, see `bearing_sim.model.sample`.
    simulated : simulated time [s].
    reason : why it has not settled; empty if it has.

    Raises
    ------
    IntegrationError
        The run stopped early.
    """
    run = Simulation(scene, table=empty_table() if scene.level == "steady" else None)
    for _ in range(_MOST_DURATIONS):
        run.advance((1 - 3 * _WINDOW) * duration)
        windows = [run.advance(_WINDOW * duration, samples=_SAMPLES) for _ in range(3)]
        window, means = windows[-1], [float(each["cage_slip"].mean()) for each in windows]
        remaining = _remaining(*means)
        if not abs(remaining) > max(_DRIFT, _RELATIVE_DRIFT * abs(means[-1])):  # slip is NaN at rest, where nothing changes
            break
    else:
        return window, run.time, f"after {run.time:.3g} s slip is still {100 * remaining:+.2g} points from its limit; give a longer duration"
    if run.counters.unsettled_points:
        return window, run.time, "no steady state was found at this operating point"
    return window, run.time, ""


def _remaining(first: float, second: float, third: float) -> float:
    """Return the remaining change of three successive means if their changes keep shrinking by the same ratio."""
    change, before = third - second, second - first
    ratio = min(abs(change / before), _SLOWEST) if before != 0.0 else 0.0
    return change * max(ratio / (1.0 - ratio), 1.0)


def point_row(scene: Scene, duration: float = DURATION) -> dict:
    """Return the results of a scene by the names of `RESULTS` and `TEXTS`, in their units; NaN if the run failed.

    Parameters
    ----------
    scene, duration : see `settle`.
    """
    try:
        window, simulated, reason = settle(scene, duration)
    except IntegrationError as error:
        return empty_row(FAILED, str(error))
    slip = window["cage_slip"]
    found = {"cage_slip": slip.mean(), "cage_slip_minimum": slip.min(), "cage_slip_maximum": slip.max(), "simulated": round(simulated, 9)}
    for ring in ("inner", "outer"):
        found[f"{ring}_load_maximum"] = window[f"{ring}_load"].max()
    found["loaded_rollers"] = (window["inner_load"] > 0.0).sum(axis=1).mean()
    with np.errstate(divide="ignore"):
        found |= {name: 1.0 / np.mean(1.0 / window[name]) for name in _LIVES}  # damage adds up, so average the rates
    found |= {name: window[name].mean() for name in (*_MEANS, *_POWERS)}
    row = {column.name: column.factor * float(found[column.name]) for column in RESULTS}
    return row | {"status": UNSETTLED if reason else OK, "reason": reason, "warnings": cell(outside(scene, window))}


def empty_row(status: str, reason: str) -> dict:
    """Return the row of a point without results."""
    return {column.name: math.nan for column in RESULTS} | {"status": status, "reason": reason, "warnings": ""}
