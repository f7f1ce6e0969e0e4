# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Whether the passing rollers excite the inner ring on its contacts.

The raceways hold the ring, with what moves with it, by a stiffness that changes as a roller takes the place of the next.  A stiffness that changes
periodically excites oscillations where twice a natural frequency, or the sum of both, is a multiple of the passage of rollers: parametric resonance
(A. H. Nayfeh, D. T. Mook, Nonlinear Oscillations (1979), chapter 5).  Little else than the damping of the contacts limits them, and rollers that
are thrown against their raceways lose most of their life.  A ring may then vibrate or not under the same inputs.

Here the ring's motion about its quasi-static orbit is linear, M x'' + C(t) x' + K(t) x = 0, with the matrices of the raceways at the balance of level
slip.  Its multiplier is the factor by which the least damped motion has changed when the next roller has come (G. Floquet): beyond 1 it grows.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.levels.common.model import write_growth
from bearing_sim.levels.slip.forces import balance_loads
from bearing_sim.levels.slip.state import new_work
from bearing_sim.physics.contact import EXPONENT
from bearing_sim.physics.load_balance import LOAD
from bearing_sim.physics.ring_balance import POINT
from bearing_sim.scene.scene import Scene
from bearing_sim.simulation import Inputs, scene_inputs
from bearing_sim.sweep.thermal import operating_state

_POSITIONS = 64  # of the cage over a pitch; the multiplier then errs by less than 0.001
_HARDLY_DECAYS = 0.99  # multiplier of a motion that decays by no more than a per cent from roller to roller
_HIGHEST = 12  # multiple of one half that is looked at
_SOFTER, _STIFFER, _BETWEEN = 0.8, 1.05, 6  # frequencies of a ring that lifts off its rollers in part, over those of one that does not (assumption)


class Resonance(NamedTuple):
    """The inner ring on its contacts, and how the passing rollers excite it."""

    moving_mass: float  # of the inner ring and of what is rigid on it [kg]
    ring_mass: float  # of the inner ring alone [kg]
    frequencies: tuple[float, float]  # natural ones on the mean stiffness of the raceways, the lower one first [Hz]
    passage: float  # rollers that pass a point of the outer ring [Hz]
    multiplier: float  # see the docstring of the module
    multiplier_nearby: float  # the largest for frequencies from `_SOFTER` to `_STIFFER` times those

    @property
    def ratios(self) -> tuple[float, float]:
        """Both natural frequencies over the passage of rollers."""
        return self.frequencies[0] / self.passage, self.frequencies[1] / self.passage

    @property
    def order(self) -> float:
        """The multiple of one half that a ratio, or the mean of both, is nearest to."""
        low, high = self.ratios
        return min((abs(ratio - 0.5 * n) / n, 0.5 * n) for ratio in (low, high, 0.5 * (low + high)) for n in range(1, _HIGHEST + 1))[1]

    @property
    def excited(self) -> bool:
        """Whether the passing rollers make the ring vibrate."""
        return self.multiplier >= 1.0

    @property
    def may_vibrate(self) -> bool:
        """Whether a ring that vibrates may go on: its frequency falls with its amplitude, and mass and stiffness are not known much better."""
        return self.multiplier_nearby >= _HARDLY_DECAYS


def ring_resonance(scene: Scene, slip: float = 0.0, inputs: Inputs | None = None, nodes: np.ndarray | None = None) -> Resonance | None:
    """Return how the passing rollers excite the inner ring of a bearing; None at rest, without load, and where no balance was found.

    Parameters
    ----------
    scene : of any level; the outer ring is held, and a shaft that is no rigid part of the ring counts for nothing.
    slip : of the cage.
    inputs : conditions; the scene's operating block where absent.
    nodes : temperatures of the thermal network's nodes [K]; those of its equilibrium where absent or NaN.
    """
    inputs = scene_inputs(scene) if inputs is None else inputs
    speed, load_y, load_z = inputs[:3]
    if speed == 0.0 or math.hypot(load_y, load_z) == 0.0:
        return None
    params, lubrication, _ = operating_state(scene, inputs, nodes)
    count, mass = params.rollers.count, params.ring.mass
    cage = 0.5 * speed * (1.0 - params.raceways.diameter_ratio) * (1.0 - min(slip, 0.999))
    work = new_work(params)
    write_growth(speed, lubrication.growth, work.growth)
    pitch, stiffness, damping = 2.0 * math.pi / count, [], []
    for k in range(_POSITIONS):
        angle = math.copysign(pitch * k / _POSITIONS, cage)
        if not balance_loads(angle, cage, load_y, load_z, params, work):
            return None
        directions = np.stack([work.loads[LOAD.cosine], work.loads[LOAD.sine]])
        series = work.loads[LOAD.slope]
        of_contacts = (directions * series) @ directions.T
        damped = (directions * series * _retardation(work.loads, params.raceways)) @ directions.T
        if work.bending is None:
            stiffness.append(of_contacts)
            damping.append(damped)
            continue
        softer = _softened(angle, cage, load_y, load_z, params, work)
        if softer is None:
            return None
        share = softer @ np.linalg.pinv(of_contacts)  # of a displacement that the contacts take of it
        stiffness.append(softer)
        damping.append(share @ damped @ share.T)
    mean = np.mean(stiffness, axis=0)
    passage = count * abs(cage) / (2.0 * math.pi)

    def multiplier(factor: float) -> float:
        per_mass, interval = factor**2 / mass, 1.0 / (passage * _POSITIONS)
        return _multiplier(np.array(stiffness) * per_mass, np.array(damping) * per_mass, interval)

    frequencies = np.sqrt(np.linalg.eigvalsh(mean) / mass) / (2.0 * math.pi)
    return Resonance(
        mass,
        scene.bearing.inner_raceway.ring_mass,
        (float(frequencies[0]), float(frequencies[1])),
        passage,
        multiplier(1.0),
        max(multiplier(factor) for factor in np.linspace(_SOFTER, _STIFFER, _BETWEEN)),
    )


_PROBED = 1e-3  # of the load, by which it is changed to see how far the inner ring moves


def _softened(cage_angle: float, cage: float, load_y: float, load_z: float, params, work) -> np.ndarray | None:
    """Return the stiffness of rollers, outer ring and housing against the inner ring's displacement [N/m], shape (2, 2); None without a balance."""
    change, compliance = _PROBED * math.hypot(load_y, load_z), np.empty((2, 2))
    for axis, (more_y, more_z) in enumerate(((change, 0.0), (0.0, change))):
        places = []
        for sense in (1.0, -1.0):
            if not balance_loads(cage_angle, cage, load_y + sense * more_y, load_z + sense * more_z, params, work):
                return None
            places.append(work.ring + work.bending.points[POINT.force, -2:])
        compliance[:, axis] = (places[0] - places[1]) / (2.0 * change)
    return np.linalg.inv(0.5 * (compliance + compliance.T))


def _retardation(loads: np.ndarray, raceways) -> np.ndarray:
    """Return damping over stiffness of each roller's two contacts in series [s], both taken as the inner one."""
    depth, damping = np.maximum(loads[LOAD.approach] - loads[LOAD.outer_penetration], 0.0), raceways.damping
    return damping.hysteresis * depth / EXPONENT + damping.time * depth / (depth + damping.depth + 1e-300)


def _multiplier(stiffness: np.ndarray, damping: np.ndarray, interval: float) -> float:
    """Return the largest magnitude of the multipliers of x'' + C x' + K x = 0, with matrices that are constant over each interval [s]."""
    from scipy.linalg import expm

    blocks = np.zeros((len(stiffness), 4, 4))
    blocks[:, :2, 2:] = np.eye(2) * interval
    blocks[:, 2:, :2], blocks[:, 2:, 2:] = -stiffness * interval, -damping * interval
    over = np.eye(4)
    for each in expm(blocks):
        over = each @ over
    return float(np.abs(np.linalg.eigvals(over)).max())
