# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""One point of a sweep: a scene run until it has settled, and its row in the table."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.steady.table import empty_table
from bearing_sim.model.losses import power_loss
from bearing_sim.model.sample import OBSERVABLES
from bearing_sim.model.validity import below_minimum_load, cell, outside
from bearing_sim.scene.axial_load import results_without_rule
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import IntegrationError, Simulation
from bearing_sim.sweep.settling import Outcome, advance_until_settled, longest_run, mean_life, shortest_run
from bearing_sim.sweep.states import other_states
from bearing_sim.sweep.thermal import begin_in_equilibrium

DURATION = 0.5  # s of the shortest run, as Deng 2017 simulates
OK, UNSETTLED, FAILED, REFUSED = "ok", "unsettled", "failed", "refused"


_SI_UNITS = {"%": "", "um": "m"}


class Column(NamedTuple):
    """One column of results."""

    name: str
    unit: str
    meaning: str
    factor: float = 1.0  # from SI to the unit

    @property
    def si_unit(self) -> str:
        """The unit in which Python has the value: SI, hours for a life."""
        return self.unit if self.factor == 1.0 else _SI_UNITS[self.unit]


LIVES = tuple(each.name for each in OBSERVABLES if each.unit == "h")
_CLEARANCES = tuple(each.name for each in OBSERVABLES if each.name.endswith("_clearance"))
_MEANS = ("equivalent_load", "static_safety", "inner_equivalent_load", "outer_equivalent_load", "land_eccentricity")
_POWERS = tuple(each.name for each in OBSERVABLES if each.name.endswith("_power"))
_OBSERVED = {each.name: each for each in OBSERVABLES}


def _observed(names) -> list[Column]:
    return [Column(name, _OBSERVED[name].unit, f"{_OBSERVED[name].meaning}; mean") for name in names]


RESULTS = (
    Column("cage_slip", "%", "cage slip, 1 - cage speed / ideal cage speed (Deng 2017, eq. 17), mean", 100.0),
    Column("cage_slip_minimum", "%", "least cage slip at an instant", 100.0),
    Column("cage_slip_maximum", "%", "largest cage slip at an instant", 100.0),
    *_observed(LIVES),
    Column("inner_load_maximum", "N", "largest normal force between a roller and the inner raceway"),
    Column("outer_load_maximum", "N", "largest normal force between a roller and the outer raceway"),
    Column("loaded_rollers", "", "rollers between both raceways at an instant, mean"),
    *(Column(name, "um", f"{_OBSERVED[name].meaning}; mean", 1e6) for name in _CLEARANCES),
    *_observed(_MEANS),
    *_observed(_POWERS),
    Column("simulated", "s", "simulated time; results are of its end"),
)
OTHER_STATE = (
    Column("other_slip", "%", "cage slip of another state in which the bearing stays under the same conditions; NaN where none was found", 100.0),
    Column("other_rating_life", "h", "rating life in that state"),
)
TEXTS = (
    Column("status", "", "ok; unsettled: slip or life was still changing at the end; failed: the run stopped early; refused: the scene is invalid"),
    Column("reason", "", "why the status is not ok"),
    Column("warnings", "", "laws used outside of their ranges, and the makers' minimum load if the load is below, each with its worst value"),
)


def run_until_settled(scene: Scene, duration: float = DURATION, longest: float | None = None, start: np.void | None = None) -> Outcome:
    """Run a scene under its constant conditions until slip, temperature and life rest; with a thermal network in equilibrium.

    See `bearing_sim.sweep.settling` for the criterion.

    Parameters
    ----------
    scene : of any level; level ``steady`` solves for its operating point without a table.
    duration : of the shortest run [s]; one of a slow bearing takes 15 cage turns.
    longest : of the longest run [s]; 1000 s or 2000 cage turns where absent, and never less than the shortest run.
    start : sample to begin from, see `bearing_sim.simulation.Simulation.reset`; ideal rolling where absent.

    Raises
    ------
    IntegrationError
        The run stopped early, or there is no thermal equilibrium.
    """
    if scene.level == "steady" and scene.table.correction != "none":
        raise IntegrationError(
            f"table.correction = {scene.table.correction}: points at level steady are solved for one by one, without a table; "
            "use table.correction=none, or the level of the correction"
        )
    run = Simulation(scene, table=empty_table() if scene.level == "steady" else None, start=start)
    shortest = shortest_run(scene, duration)
    longest = longest_run(scene) if longest is None else max(longest, shortest)
    begin_in_equilibrium(run, shortest, longest, start)
    return advance_until_settled(run, shortest, longest)


def point_row(scene: Scene, duration: float = DURATION, longest: float | None = None) -> dict:
    """Return the results of a scene by the names of `RESULTS`, `OTHER_STATE` and `TEXTS`, in their units; NaN if the run failed.

    Parameters
    ----------
    scene, duration, longest : see `run_until_settled`.
    """
    try:
        outcome = run_until_settled(scene, duration, longest)
    except IntegrationError as error:
        return empty_row(FAILED, str(error))
    found = results_of(outcome)
    window = outcome.window
    found |= dict.fromkeys(results_without_rule(scene, float(np.hypot(window["load_y"], window["load_z"]).mean())), math.nan)
    row = {column.name: column.factor * found[column.name] for column in RESULTS}
    judged = {"status": OK if outcome.settled else UNSETTLED, "reason": outcome.reason}
    warnings = cell([*outside(scene, window), *below_minimum_load(scene, window)])
    return row | _other_state(scene, outcome) | judged | {"warnings": warnings}


def _other_state(scene: Scene, outcome: Outcome) -> dict[str, float]:
    """Return the results of the other state whose slip is farthest from that of a run; NaN where there is none."""
    others = other_states(scene, outcome, skid_load=False).states
    other = max(others, key=lambda state: abs(state.cage_slip - outcome.slip), default=None)
    slip, life = (math.nan, math.nan) if other is None else (other.cage_slip, other.rating_life)
    return {"other_slip": 100.0 * slip, "other_rating_life": life}


def results_of(outcome: Outcome) -> dict[str, float]:
    """Return the results of a run by the names of `RESULTS`, in SI, lives in hours."""
    window, slip = outcome.window, outcome.window["cage_slip"]
    found = {"cage_slip": outcome.slip, "cage_slip_minimum": slip.min(), "cage_slip_maximum": slip.max(), "simulated": round(outcome.simulated, 9)}
    for ring in ("inner", "outer"):
        found[f"{ring}_load_maximum"] = window[f"{ring}_load_maximum"].max()
    found["loaded_rollers"] = (window["inner_load"] > 0.0).sum(axis=1).mean()
    found |= {name: mean_life(window[name]) for name in LIVES}
    found |= {name: window[name].mean() for name in (*_CLEARANCES, *_MEANS, *_POWERS)}
    found["shaft_power"] = power_loss(window)
    return {name: float(value) for name, value in found.items()}


def empty_row(status: str, reason: str) -> dict:
    """Return the row of a point without results."""
    return {column.name: math.nan for column in (*RESULTS, *OTHER_STATE)} | {"status": status, "reason": reason, "warnings": ""}
