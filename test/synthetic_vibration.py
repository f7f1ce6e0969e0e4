# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Synthetic vibration of a bearing whose cage speed is known, for checking what `bearing_sim.watchers.vibration.analysis` finds.

A spot on a raceway or a roller is met at the instants that the kinematics give; each meeting excites a decaying oscillation of the housing.
Rollers stand somewhere in their pockets, anew at each meeting, and the cage's speed wanders.  To it come the shaft's own lines, two machines
nearby with the lines of their rotors and gears, and noise.
"""

import math
from typing import NamedTuple

import numpy as np
import scipy.signal

from bearing_sim.watchers.vibration.signal import Vibration

_DAMPING = 0.04  # of the housing's oscillation, relative (assumption: bolted steel, 0.01 to 0.1)
_WANDERINGS = 40  # of the cage speed over a record


class Machine(NamedTuple):
    """A synthetic bearing at work.

    Attributes
    ----------
    shows : what has a spot: ``outer_ring``, ``inner_ring``, ``roller``, or nothing if empty.
    rollers : number of them.
    size : roller diameter over pitch diameter.
    slip : of the cage, mean.
    shaft_speed : mean [rad/s].
    ramp : change of the shaft speed over the record, relative to the mean.
    pocket_play : standard deviation of a roller's place in its pocket, over the pitch of the rollers.
    wandering : standard deviation of the slowly varying part of the cage speed, relative.
    signal_to_noise : power of the impacts over that of the noise [dB].
    interfering : number of machines nearby; each is as loud as the impacts and noise together.
    shaft_lines : amplitude of the shaft's own lines, over the root mean square of the impacts and noise together.
    """

    shows: str
    rollers: int
    size: float
    slip: float
    shaft_speed: float
    ramp: float = 0.0
    pocket_play: float = 0.01
    wandering: float = 2e-4
    signal_to_noise: float = 0.0
    interfering: int = 2
    shaft_lines: float = 0.3

    @property
    def ratio(self) -> float:
        """Cage over shaft speed, mean."""
        return 0.5 * (1.0 - self.size) * (1.0 - self.slip)


class Synthetic(NamedTuple):
    """A synthetic record with its truth.

    Attributes
    ----------
    vibration : the record, without a shaft speed.
    ratio : cage over shaft speed, mean over this record.
    shaft_frequency : mean over this record [Hz].
    resonance : frequency of the housing's oscillation [Hz]; NaN where nothing shows.
    """

    vibration: Vibration
    ratio: float
    shaft_frequency: float
    resonance: float


def record(machine: Machine, rate: float, duration: float, rng: np.random.Generator) -> Synthetic:
    """Return a record of a machine.

    Parameters
    ----------
    machine : what is simulated.
    rate : of the samples [Hz].
    duration : of the record [s].
    rng : source of everything random.
    """
    count = int(rate * duration)
    time = np.arange(count) / rate
    shaft = _turns(time, machine.shaft_speed / (2.0 * math.pi), machine.ramp)
    knots = rng.normal(0.0, machine.wandering, _WANDERINGS)
    wander = np.interp(time, np.linspace(0.0, duration, _WANDERINGS), knots)
    cage = np.concatenate(([0.0], np.cumsum(np.diff(shaft) * machine.ratio * (1.0 + wander[1:])))) + rng.random()
    impacts, resonance = (np.zeros(count), math.nan) if not machine.shows else _impacts(machine, shaft, cage, rate, rng)
    noise = rng.normal(size=count)
    power = np.mean(impacts**2)
    if power > 0.0:
        noise *= math.sqrt(power) * 10.0 ** (-machine.signal_to_noise / 20.0)
    vibration = impacts + noise
    level = math.sqrt(np.mean(vibration**2))
    for order in (1.0, 2.0, 3.0):
        vibration = vibration + machine.shaft_lines * level / order * np.cos(2.0 * math.pi * (order * shaft + rng.random()))
    for _ in range(machine.interfering):
        vibration = vibration + level * _neighbour(time, machine.shaft_speed / (2.0 * math.pi), rate, rng)
    turned = shaft[-1] - shaft[0]
    return Synthetic(Vibration(vibration, rate, name="synthetic"), (cage[-1] - cage[0]) / turned, turned / time[-1], resonance)


def _turns(time: np.ndarray, frequency: float, ramp: float) -> np.ndarray:
    """Return the turns of a shaft whose speed rises linearly by ``ramp`` over the record."""
    middle, duration = time - 0.5 * time[-1], time[-1]
    return frequency * (time + ramp * (middle**2 - middle[0] ** 2) / (2.0 * duration))


def _impacts(machine: Machine, shaft: np.ndarray, cage: np.ndarray, rate: float, rng: np.random.Generator) -> tuple[np.ndarray, float]:
    """Return the oscillation of the housing by the impacts of a spot, and its frequency [Hz]."""
    if machine.shows == "roller":
        spin = (1.0 - machine.size**2) / (2.0 * machine.size)
        phase = 2.0 * spin * (shaft + 0.002 * np.cumsum(rng.normal(size=len(shaft))) / math.sqrt(rate))  # both raceways; rollers skid at random
        play = 0.0
    else:
        phase = machine.rollers * (cage if machine.shows == "outer_ring" else shaft - cage)
        play = machine.pocket_play
    meetings = np.arange(math.ceil(phase[0]), math.floor(phase[-1]) + 1)
    instants = np.interp(meetings + play * rng.normal(size=len(meetings)), phase, np.arange(len(shaft)))
    at = instants.astype(int)
    load = {
        "outer_ring": 1.0 + 0.2 * np.cos(2.0 * math.pi * shaft[at]),
        "inner_ring": np.maximum(0.0, np.cos(2.0 * math.pi * shaft[at])) ** 1.5,
        "roller": np.maximum(0.0, np.cos(2.0 * math.pi * cage[at])) ** 1.5,
    }[machine.shows]
    blows = np.zeros(len(shaft))
    strengths = load * (1.0 + 0.2 * rng.normal(size=len(at)))
    fraction = instants - at
    np.add.at(blows, at, strengths * (1.0 - fraction))
    np.add.at(blows, np.minimum(at + 1, len(blows) - 1), strengths * fraction)
    frequency = rng.uniform(0.1, 0.35) * rate
    lasting = np.arange(int(8.0 / (2.0 * math.pi * _DAMPING * frequency) * rate) + 1) / rate
    ringing = np.exp(-2.0 * math.pi * _DAMPING * frequency * lasting) * np.sin(2.0 * math.pi * frequency * lasting)
    return scipy.signal.oaconvolve(blows, ringing)[: len(shaft)], frequency


def _neighbour(time: np.ndarray, shaft: float, rate: float, rng: np.random.Generator) -> np.ndarray:
    """Return the vibration of another machine, of root mean square 1: harmonics of its rotor, and a gear's mesh that its shaft modulates."""
    frequency = shaft * math.exp(rng.uniform(-1.0, 1.0))
    angle = 2.0 * math.pi * frequency * time
    rotor = sum(math.exp(-0.3 * order) * np.cos(order * angle + 2.0 * math.pi * rng.random()) for order in range(1, 9))
    mesh = int(rng.integers(17, 60))
    while mesh * frequency > 0.4 * rate:
        mesh //= 2
    modulated = 1.0 + 0.5 * np.cos(angle + 2.0 * math.pi * rng.random())
    gear = sum(np.cos(order * mesh * angle + 2.0 * math.pi * rng.random()) / order for order in (1, 2, 3) if order * mesh * frequency < 0.45 * rate)
    total = rotor + modulated * gear
    return total / math.sqrt(np.mean(total**2))
