# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""All states in which a cage stays under the same inputs, and the load below which it stays in a skid.

Thick oil brakes a cage that is slow beside its rollers more than a light load drives it.  A cage that rolls then goes on rolling, and one that skids,
as after a start with cold oil or while the load was low, goes on skidding.  The scan of an operating point
(`bearing_sim.levels.steady.operating_point`) sees where the mean drive of a cage changes from braking to driving.  Each such slip is a state of its
own.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
from bearing_sim.levels.steady.model import Work, forget, new_work, solve_condition
from bearing_sim.levels.steady.operating_point import ANSWER, CREEP, SCANNED, basin, find_skid_load, stable_balances
from bearing_sim.model.params import pack
from bearing_sim.model.sample import NODE_OBSERVABLES, new_block
from bearing_sim.model.temperatures import local_model, lubricate_scene
from bearing_sim.physics.rating_life import rating_life_revolutions
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, Simulation, scene_inputs

SKIDS = 0.05  # slip above which a cage counts as skidding
_FIRST, _MOST = 1e-3, 0.5  # loads at which the search for a skid load begins and ends, over the static load rating
_STANDSTILL = 1e-3  # rad/s; a cage that stands


class State(NamedTuple):
    """A state in which a cage stays."""

    cage_slip: float
    rating_life: float  # by the loads on both rings [h]
    shaft_power: float  # [W]
    basin: tuple[float, float]  # slips between which a cage comes to it


class States(NamedTuple):
    """What level steady knows of the states of a bearing under constant conditions."""

    found: tuple[State, ...]  # the one to which the cage comes from ideal rolling first; none where no state was found, or at rest
    skid_load: float  # load below which a skid lasts, at the same speed and temperatures [N]; 0 where none does, NaN where it was not sought

    def of(self, slip: float) -> State | None:
        """Return the state to which a cage with such a slip belongs, None where there is none."""
        return min(self.found, key=lambda state: abs(state.cage_slip - slip), default=None)

    def beside(self, slip: float) -> tuple[State, ...]:
        """Return the other states of a bearing whose cage settled with such a slip."""
        own = self.of(slip)
        return tuple(state for state in self.found if state is not own)


def states(scene: Scene, inputs: Inputs | None = None, nodes: np.ndarray | None = None, skid_load: bool = True) -> States:
    """Return the states of a bearing under constant conditions, by level steady.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions; the scene's operating block where absent.
    nodes : temperatures of the thermal network's nodes [K]; absent or NaN where the scene has none.
    skid_load : whether to look for the skid load, which takes longer than the states.
    """
    inputs = scene_inputs(scene) if inputs is None else inputs
    speed, load_y, load_z, oil = inputs[:4]
    if abs(speed) < CREEP:
        return States((), math.nan)
    params = pack(scene)
    if nodes is None or not np.isfinite(nodes).all():
        lubrication = lubricate_scene(scene, params, oil, inputs[4:6])
    else:
        params, lubrication = local_model(scene, params, oil, nodes)
    drive = Drive(0.0, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0)
    model, work = Model(params, lubrication, drive, DEFAULT_TOLERANCES), new_work(params)
    found = tuple(_state(answer, reached, speed, params) for answer, reached in _balances(speed, load_y, load_z, model, work))
    below = math.nan
    if skid_load and found:
        rating = params.life.static_rating
        below = find_skid_load(SKIDS, math.atan2(load_z, load_y), _FIRST * rating, _MOST * rating, model, work.bearing, work.orbit)
    return States(found, float(below))


def states_of_sample(scene: Scene, sample: np.void, inputs: Inputs, skid_load: bool = True) -> States:
    """Return the states of a bearing as warm as in a sample; parameters as of `states`."""
    return states(scene, inputs, np.array([float(sample[name]) for name in NODE_OBSERVABLES]), skid_load)


def _balances(speed: float, load_y: float, load_z: float, model: Model, work: Work):
    """Yield the answer and the basin of each state, see `bearing_sim.levels.steady.operating_point.basin`."""
    forget(work)
    if not solve_condition(speed, load_y, load_z, model, work, to_standstill=True):
        return
    rolling, scanned = tuple(work.basin.tolist()), work.orbit.scanned.copy()
    yield work.solved.copy(), rolling
    for low, high in stable_balances(scanned):
        reached = basin(low, high, scanned)
        if reached == rolling:
            continue
        start = 1.0 if high == len(SCANNED) else float(SCANNED[high])
        if solve_condition(speed, load_y, load_z, model, work, start):
            yield work.solved.copy(), reached


def _state(answer: np.ndarray, reached: tuple[float, float], speed: float, params) -> State:
    revolutions = rating_life_revolutions(answer[ANSWER.inner_equivalent_load], answer[ANSWER.outer_equivalent_load], params.life)
    hours = revolutions * 2.0 * math.pi / (3600.0 * abs(speed))
    return State(float(answer[ANSWER.cage_slip]), float(hours), float(answer[ANSWER.shaft_power]), reached)


def standing_cage(scene: Scene, inputs: Inputs | None = None) -> np.void:
    """Return a sample of a bearing whose cage stands while the shaft turns, to start a simulation in a skid.

    The rollers roll on the inner raceway.

    Parameters
    ----------
    scene : of any level.
    inputs : conditions; the scene's operating block where absent.
    """
    rolling = Simulation(scene, inputs).sample
    sample = new_block(1, scene.bearing.roller.count)[0]
    sample[...] = rolling
    # The spin of rolling is that of an inner raceway that turns by omega_i - omega_c under a cage that is held.
    faster = rolling["shaft_speed"] / (rolling["shaft_speed"] - rolling["cage_speed"])
    sample["roller_spin"] = rolling["roller_spin"] * faster
    sample["cage_speed"] = sample["orbital_speed"] = math.copysign(_STANDSTILL, rolling["shaft_speed"])
    return sample
