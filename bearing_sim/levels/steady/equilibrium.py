# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The thermal equilibrium of a bearing: temperatures at which its losses leave as heat, found without marching through minutes.

Losses follow from temperatures by an operating point of level ``steady`` (clearance, viscosities, tractions), temperatures from losses by the
network at rest.  The search goes back and forth between both.  Where oil thins as it warms it would overshoot, where heat closes the clearance
it would creep, so the change of each round is stretched by the rule of Aitken for vectors (B. M. Irons, R. C. Tuck, Int. J. Numer. Methods
Eng. 1 (1969) 275), and never longer than a warming that a machine could follow.  It starts from a cold bearing and comes from below: it finds
the equilibrium that a start ends in.  Where each kelvin brings more heat than the surroundings take, there is none: the search passes the
limit of the scene, and says at which temperatures the clearance was gone.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import DEFAULT_TOLERANCES, Drive, Model
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.steady.model import forget, new_work, solve_condition
from bearing_sim.levels.steady.operating_point import ANSWER, RESOLUTION, new_orbit
from bearing_sim.model.params import pack
from bearing_sim.model.temperatures import local_model
from bearing_sim.model.thermal_network import POWERS, fit_gaps, start_temperatures, thermal_network
from bearing_sim.physics import thermal_network as physics
from bearing_sim.physics.growth import clearance_at, seats_at
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.thermal_network import NODE, NODES, NetworkInputs
from bearing_sim.scene.scene import Scene

_ROUNDS = 150
_AGREED, _NEARLY = 1e-5, 3.0  # K; of temperatures before and after a round; the second where losses jump at the equilibrium
_FARTHEST = 15.0  # K, of a round
_SHORTEST, _LONGEST = 0.05, 4.0  # factors on the change of a round
_FINE = (1e-8, 1e-8)  # tolerances of the operating point, so that temperatures can agree
_CELSIUS = 273.15


class Equilibrium(NamedTuple):
    """Where a bearing's temperatures come to rest."""

    temperatures: np.ndarray  # of the network's nodes [K], shape (NODES,), see `bearing_sim.physics.thermal_network.NODE`
    powers: dict[str, float]  # losses by the names of the observables, and ``shaft_power`` [W]
    heat_to_oil: float  # [W]
    heat_to_ambient: float  # [W]
    clearance: float  # running, diametral [m]; negative: preload
    cage_slip: float
    converged: bool
    reason: str  # why there is none; empty where it was found
    rounds: int  # operating points solved for


class _Round(NamedTuple):
    """One operating point and the network's temperatures with its losses."""

    answer: np.ndarray
    losses: np.ndarray  # [W], in the order of `POWERS`
    reached: np.ndarray  # temperatures [K]
    flows: tuple[float, float]  # to the oil and to ambient [W]
    clearance: float  # running, diametral [m]
    failure: str  # empty where both were found


class _Balance:
    """Losses by temperatures, and temperatures by losses, of one operating condition."""

    def __init__(self, scene: Scene, inputs: Sequence[float], slip: float):
        self.scene, self.inputs, self.slip, self.params = scene, inputs, slip, pack(scene)
        self.network = thermal_network(scene, self.params)
        self._work = new_work(self.params)._replace(orbit=new_orbit(scene.bearing.roller.count, tolerances=_FINE))
        self._thermal = physics.new_work()
        self._gaps = fit_gaps(scene)
        self._free = np.zeros(NODES)

    def go(self, temperatures: np.ndarray) -> _Round:
        """Solve for the operating point at temperatures and settle the network with its losses."""
        speed, load_y, load_z, inlet = (float(value) for value in self.inputs[:4])
        params, lubrication = local_model(self.scene, self.params, inlet, temperatures)
        clearance = clearance_at(speed, lubrication.growth, params).running
        model = Model(params, lubrication, Drive(0.0, speed, 0.0, load_y, 0.0, load_z, 0.0, 0.0), DEFAULT_TOLERANCES)
        forget(self._work)
        if not solve_condition(speed, load_y, load_z, model, self._work, self.slip):
            return _Round(self._work.solved, np.zeros(len(POWERS)), temperatures, (math.nan, math.nan), clearance, "no operating point was found")
        resolution = self._work.orbit.resolution  # no fewer angles than before: losses would jump from round to round
        resolution[RESOLUTION.first] = max(resolution[RESOLUTION.first], resolution[RESOLUTION.angles] // 2)
        answer = self._work.solved.copy()
        losses = np.array([answer[getattr(ANSWER, name)] if hasattr(ANSWER, name) else 0.0 for name in POWERS])  # no supports at level steady
        cage = 0.5 * speed * (1.0 - params.raceways.diameter_ratio) * (1.0 - answer[ANSWER.cage_slip])
        bearing = self._work.bearing
        balance_loads(0.0, cage, load_y, load_z, params, bearing)
        loads = np.ascontiguousarray([bearing.loads[LOAD.inner], bearing.loads[LOAD.outer]])
        inputs = NetworkInputs(speed, cage, inlet, *seats_at(speed, lubrication.growth, params.mounted, self._gaps))
        reached = temperatures.copy()
        settled = physics.settle(reached, losses, loads, inputs, self.network, self._free, self._thermal)
        failure = "" if settled else "the network has no temperatures at which all heat leaves"
        return _Round(answer, losses, reached, physics.heat_flows(reached, inputs, self.network, self._thermal), clearance, failure)


def thermal_equilibrium(
    scene: Scene,
    inputs: Sequence[float],
    start: np.ndarray | None = None,
    agreed: float = _AGREED,
    slip: float = 0.0,
) -> Equilibrium:
    """Find the thermal equilibrium of a scene whose `heat.law` is network.

    Parameters
    ----------
    scene : of any level; operating points are those of level steady.
    inputs : shaft speed [rad/s], load y, load z [N] and the temperature of the oil that comes in [K]; `bearing_sim.simulation.Inputs` will do.
    start : temperatures of the nodes to begin with [K]; those of the scene's start where absent.
    agreed : largest difference of temperatures before and after the last round [K].
    slip : at which the cage begins, 0 in ideal rolling, 1 where it stands.

    Returns
    -------
    equilibrium : with ``converged`` false and the reason where there is none below the scene's limit.
    """
    balance, limit = _Balance(scene, inputs, slip), scene.heat.limit
    now = start_temperatures(scene.heat, float(inputs[3])) if start is None else np.array(start, float)
    before, stretch, gone, reason = None, 1.0, None, ""
    for rounds in range(1, _ROUNDS + 1):  # noqa: B007
        found = balance.go(now)
        if gone is None and found.clearance <= 0.0:
            gone = now.copy()
        change = found.reached - now
        largest = float(np.abs(change).max())
        if found.failure or not math.isfinite(largest):
            reason = f"{found.failure or 'temperatures are not finite'} {_warmth(now)}"
            break
        if largest < agreed:
            break
        if now.max() >= limit:
            reason = f"no thermal equilibrium below the limit of {limit - _CELSIUS:.4g} degC{_gone(gone, found.clearance)}"
            break
        if before is not None:
            bend = change - before
            square = float(bend @ bend)
            stretch = float(np.clip(-stretch * (before @ bend) / square, _SHORTEST, _LONGEST)) if square > 0.0 else 1.0
            if before @ change > 0.0 and change @ change >= before @ before:  # it speeds away: no shorter steps
                stretch = _LONGEST
        stretch = min(stretch, _FARTHEST / largest)
        now, before = np.minimum(now + stretch * change, limit), change
    else:
        if largest >= _NEARLY:
            reason = f"temperatures still changed by {largest:.3g} K after {_ROUNDS} rounds, {_warmth(now)}"
    powers = {name: float(loss) for name, loss in zip(POWERS, found.losses)}
    powers["shaft_power"] = float(found.answer[ANSWER.shaft_power])
    return Equilibrium(
        found.reached if not reason else now, powers, *found.flows, found.clearance, float(found.answer[ANSWER.cage_slip]), not reason, reason, rounds
    )


def _warmth(nodes: np.ndarray) -> str:
    return f"with the inner ring at {nodes[NODE.inner_ring] - _CELSIUS:.4g} degC and the outer ring at {nodes[NODE.outer_ring] - _CELSIUS:.4g} degC"


def _gone(nodes: np.ndarray | None, clearance: float) -> str:
    if nodes is None:
        return f"; a running clearance of {1e6 * clearance:.3g} um is left there"
    return f"; the clearance is gone {_warmth(nodes)}, and heat closes it further, to a preload of {-1e6 * clearance:.3g} um at the limit"
