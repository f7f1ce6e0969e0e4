# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thermal equilibrium that a run under constant conditions ends in, found before the run instead of by minutes of it."""

import numpy as np

from bearing_sim.levels.steady.equilibrium import thermal_equilibrium
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, thermal_nodes
from bearing_sim.sweep.settling import advance_until_settled

_ROUNDS, _AVERAGED_FROM = 8, 3
_EQUAL, _BALANCED = 1e-2, 1e-4  # K, and of the shaft power; slip then errs by less than 0.01 points, temperatures by 0.02 K
_AGREED = 0.3  # K; temperatures by the losses of two rounds


def equilibrium_temperatures(scene: Scene, inputs: Inputs, start: np.void | None = None) -> np.ndarray:
    """Return the temperatures of the network's nodes in the equilibrium of level steady [K], as exact as a run resolves.

    Parameters
    ----------
    scene : whose `heat.law` is network.
    inputs : constant conditions.
    start : sample whose temperatures the search begins with where it has them.

    Raises
    ------
    IntegrationError
        There is no equilibrium: it says why.
    """
    known = None if start is None else thermal_nodes(start)
    nearby = known if known is not None and np.isfinite(known).all() else None
    found = thermal_equilibrium(scene, inputs, nearby, _EQUAL, _BALANCED)
    if not found.converged:
        raise IntegrationError(found.reason)
    return found.temperatures


def begin_in_equilibrium(simulation: Simulation, shortest: float, longest: float, start: np.void | None = None) -> None:
    """Bring a simulation with a thermal network to its start, with the temperatures in which it will stay; without a network do nothing.

    The equilibrium is that of level steady.  At another level its own losses correct it: run until settled with temperatures held, let the
    network rest with the losses of the run's end, and again, until temperatures agree to 0.3 K.  Losses of rattling cages scatter from run to run:
    from the fourth round on temperatures are the mean of the rounds since the third.

    Parameters
    ----------
    simulation : under constant conditions.
    shortest, longest : simulated time of the shortest and the longest run [s], see `bearing_sim.sweep.settling.advance_until_settled`.
    start : sample to begin from, see `bearing_sim.simulation.Simulation.reset`; the search begins with its temperatures where it has them.

    Raises
    ------
    IntegrationError
        There is no equilibrium: it says why; or the losses of the level scatter so much that none was found.
    """
    if simulation.thermal is None:
        return
    inputs = simulation.inputs
    nodes = equilibrium_temperatures(simulation.scene, inputs, start)
    if simulation.scene.level != "steady":
        nodes = _refined(simulation, nodes, shortest, longest, start)
    simulation.reset(inputs, nodes, start)


def _refined(simulation: Simulation, nodes: np.ndarray, shortest: float, longest: float, start: np.void | None) -> np.ndarray:
    simulation.reset(simulation.inputs, nodes, start)
    for done in range(_ROUNDS):
        simulation.set_temperatures(nodes)
        outcome = advance_until_settled(simulation, shortest, longest)
        before, at_rest = nodes, simulation.thermal.rest(outcome.window, simulation.inputs.oil_temperature)
        nodes = before + (at_rest - before) / max(done - _AVERAGED_FROM + 2, 1)
        change = float(np.abs(nodes - before).max())
        if change < _AGREED:
            return nodes
        if nodes.max() >= simulation.scene.heat.limit:
            limit = simulation.scene.heat.limit - 273.15
            raise IntegrationError(f"no thermal equilibrium below the limit of {limit:.4g} degC at level {simulation.scene.level}")
    raise IntegrationError(
        f"no thermal equilibrium at level {simulation.scene.level}: temperatures still change by {change:.3g} K from round to round"
    )
