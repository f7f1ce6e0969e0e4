# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What a run takes from the stored state of its bearing, and leaves there: temperatures, and what the monitors have learned."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from bearing_sim.simulation import Inputs, Simulation, begin_at_temperatures
from bearing_sim.watchers.monitoring.monitor import Monitor
from bearing_sim.watchers.monitoring.residual import ResidualMonitor
from bearing_sim.watchers.stored_state.keeper import StateKeeper

if TYPE_CHECKING:
    from bearing_sim.watchers.estimation.live import LiveEstimation


def warm_start(keeper: StateKeeper, now_ns: Callable[[], int]) -> Callable[[Simulation, Inputs], None]:
    """Return the function that begins a run as warm as the bearing is remembered, see `bearing_sim.runtime.solver.Solver`.

    Parameters
    ----------
    now_ns : clock [ns since the epoch]; temperatures of long ago are not used.
    """

    def begin(simulation: Simulation, inputs: Inputs) -> None:
        thermal = keeper.thermal(now_ns())
        if thermal is None or simulation.thermal is None:
            simulation.reset(inputs)
        else:
            begin_at_temperatures(simulation, inputs, np.array(thermal.nodes), np.array(thermal.rings))

    return begin


def recall(keeper: StateKeeper, residual: ResidualMonitor, monitor: Monitor, estimation: "LiveEstimation | None", now_ns: int) -> None:
    """Let monitors continue from what they had learned about the bearing; from nothing if another version of them had learned it.

    Parameters
    ----------
    estimation : continues from what measurements have taught, which says the less, the longer ago that was.
    now_ns : the clock [ns since the epoch]; 0 where it is not known yet.
    """
    learned = keeper.state.learned
    if estimation is not None:
        recall_estimates(keeper, estimation, now_ns)
    try:
        residual.restore(learned.get("cage_slip", {}))
        monitor.temperatures.restore(learned.get("temperatures", {}))
    except (KeyError, TypeError, ValueError):
        residual.restart()
        monitor.temperatures.restore({})


def recall_estimates(keeper: StateKeeper, estimation: "LiveEstimation", now_ns: int) -> None:
    """Let estimates continue from what measurements have taught (see `recall`)."""
    try:
        estimation.restore(keeper.state.learned.get("estimation", {}), max(now_ns - keeper.state.until_ns, 0) * 1e-9)
    except (KeyError, TypeError, ValueError):
        estimation.restore({})


def note(
    keeper: StateKeeper, residual: ResidualMonitor, monitor: Monitor, estimation: "LiveEstimation | None", sample: np.void, time_ns: int
) -> None:
    """Put the temperatures of a sample, taken at an instant [ns since the epoch], and what monitors have learned into the state."""
    keeper.note_thermal(sample, time_ns)
    kept = keeper.state.learned.get("estimation", {})  # a run that does not estimate keeps what another one has learned
    learned = {"cage_slip": residual.learned, "temperatures": monitor.temperatures.learned}
    keeper.state.learned = learned | {"estimation": kept if estimation is None else estimation.learned}
    if estimation is not None:
        keeper.state.note_estimates(time_ns, estimation.estimates)
