# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thermal equilibrium that a run under constant conditions ends in, found before the run instead of by minutes of it."""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
from bearing_sim.levels.common.observation import oil_at_speed
from bearing_sim.levels.steady.model import Work, forget, new_work, solve_condition
from bearing_sim.levels.steady.operating_point import ANSWER
from bearing_sim.model.params import Lubrication, Params, pack
from bearing_sim.model.sample import NODE_OBSERVABLES
from bearing_sim.model.temperatures import given_temperatures, local_model, lubricate_scene
from bearing_sim.physics.growth import excess_growth
from bearing_sim.physics.lamina_life import EquivalentLoads
from bearing_sim.physics.rating_life import Lives, rate_lives
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, IntegrationError, Simulation, scene_inputs, thermal_nodes
from bearing_sim.sweep.settling import advance_until_settled

SKIDS = 0.05  # slip above which a cage skids: what it does next depends on where it comes from
_ROUNDS, _AVERAGED_FROM = 8, 3
_EQUAL = 1e-2  # K; slip then errs by less than 0.01 points, temperatures by 0.02 K
_AGREED = 0.3  # K; temperatures by the losses of two rounds


def equilibrium_temperatures(scene: Scene, inputs: Inputs, start: np.void | None = None) -> np.ndarray:
    """Return the temperatures of the network's nodes in the equilibrium of level steady [K], as exact as a run resolves.

    Parameters
    ----------
    scene : whose `heat.law` is network.
    inputs : constant conditions.
    start : sample whose temperatures the search begins with where it has them; the losses are those of a cage that begins with its slip.

    Raises
    ------
    IntegrationError
        There is no equilibrium: it says why.
    """
    from bearing_sim.levels.steady.equilibrium import thermal_equilibrium

    known = None if start is None else thermal_nodes(start)
    nearby = known if known is not None and np.isfinite(known).all() else None
    slip = 0.0 if start is None else float(start["cage_slip"])
    found = thermal_equilibrium(scene, inputs, nearby, _EQUAL, begin_at(slip))
    if not found.converged:
        raise IntegrationError(found.reason)
    return found.temperatures


def begin_at(slip: float) -> float:
    """Return the slip from which level steady looks for the state of a cage that slips so: its own in a skid, otherwise that of ideal rolling."""
    return min(slip, 1.0) if slip > SKIDS else 0.0


class OperatingState(NamedTuple):
    """A bearing as warm as it runs under constant conditions."""

    params: Params
    lubrication: Lubrication
    temperatures: np.ndarray  # as a sample holds them, in the order of `NODE_OBSERVABLES` [K]; NaN where the scene's law of heat says nothing


def operating_state(scene: Scene, inputs: Inputs | None = None, nodes: np.ndarray | None = None) -> OperatingState:
    """Return parameters, lubrication and temperatures with which every answer about a scene under constant conditions is computed.

    With a thermal network these are those of `equilibrium_temperatures`, otherwise those that the scene gives, or the oil's.

    Parameters
    ----------
    scene : of any level.
    inputs : constant conditions; the scene's operating block where absent.
    nodes : temperatures of the thermal network's nodes where they are known [K], shape (NODES,); NaN or absent where they are not.

    Raises
    ------
    IntegrationError
        There is no thermal equilibrium: it says why.
    """
    inputs, params = scene_inputs(scene) if inputs is None else inputs, pack(scene)
    if scene.heat.law == "network":
        known = nodes is not None and np.isfinite(nodes).all()
        temperatures = np.array(nodes, float) if known else equilibrium_temperatures(scene, inputs)
        return OperatingState(*local_model(scene, params, inputs.oil_temperature, temperatures), temperatures)
    oil, measured = inputs.oil_temperature, inputs[4:6]
    temperatures = np.full(len(NODE_OBSERVABLES), math.nan)
    if scene.heat.law == "given":
        solids = given_temperatures(scene.heat, oil, measured)
        temperatures[: len(solids)] = solids
    return OperatingState(params, lubricate_scene(scene, params, oil, measured), temperatures)


def steady_model(state: OperatingState, inputs: Inputs) -> Model:
    """Return the model of level steady under constant conditions."""
    drive = Drive(0.0, inputs.shaft_speed, 0.0, inputs.load_y, 0.0, inputs.load_z, 0.0, 0.0)
    return Model(state.params, state.lubrication, drive, DEFAULT_TOLERANCES)


def solved_answer(state: OperatingState, inputs: Inputs, work: Work | None = None, start: float = 0.0) -> np.ndarray:
    """Return the answer of level steady to an operating point, solved for, columns `ANSWER`; NaN where none was found, shape (len(ANSWER),).

    Parameters
    ----------
    state : of the bearing under the inputs.
    inputs : constant conditions.
    work : memory of a bearing with as many rollers, for many points one after the other.
    start : slip at which the cage begins, see `begin_at`.
    """
    work = new_work(state.params) if work is None else work
    forget(work)  # the model is another one
    found = solve_condition(*inputs[:3], steady_model(state, inputs), work, start)
    return work.solved.copy() if found else np.full(len(ANSWER), math.nan)


def lives_of(answer: np.ndarray, model: Model) -> Lives:
    """Return the rating lives of an answer of level steady, in revolutions."""
    params, drive = model.params, model.drive
    oil = oil_at_speed(drive.shaft_speed, model)
    equivalent = EquivalentLoads(*answer[ANSWER.inner_equivalent_load : ANSWER.reference_modification_factor + 1].tolist())
    return rate_lives(math.hypot(drive.load_y, drive.load_z), equivalent, oil, params.life)


def table_condition(state: OperatingState, inputs: Inputs) -> tuple[float, float, float, float, float]:
    """Return where a run at level steady looks a state up: shaft speed [rad/s], load [N], films [K], direction of the load [rad], growth [m]."""
    speed, films = inputs.shaft_speed, state.lubrication.film_temperature
    growth = excess_growth(speed, films, state.lubrication.growth, state.params.mounted)
    return speed, math.hypot(inputs.load_y, inputs.load_z), films, math.atan2(inputs.load_z, inputs.load_y), growth


def simulation_in_equilibrium(scene: Scene) -> Simulation:
    """Return a simulation of a scene at its constant conditions, held at the temperatures of `operating_state` where it has a thermal network.

    Raises
    ------
    IntegrationError
        There is no thermal equilibrium: it says why.
    """
    inputs = scene_inputs(scene)
    return simulation_held_at(scene, inputs, equilibrium_temperatures(scene, inputs)) if scene.heat.law == "network" else Simulation(scene)


def simulation_held_at(scene: Scene, inputs: Inputs, nodes: np.ndarray, start: np.void | None = None) -> Simulation:
    """Return a simulation whose thermal network stays at given temperatures.

    Parameters
    ----------
    inputs : conditions at its start.
    nodes : temperatures of the network's nodes [K]; without a network they count for nothing.
    start : sample to begin from, see `bearing_sim.simulation.Simulation.reset`.
    """
    simulation = Simulation(scene, inputs, start=start, nodes=nodes)
    if simulation.thermal is not None:
        simulation.set_temperatures(nodes)
    return simulation


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
