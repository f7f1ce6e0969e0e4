# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A stand-in with the interface of `bearing_sim.simulation.Simulation` whose faults and costs a test can dictate."""

import time

import numpy as np

from bearing_sim.model.sample import new_block
from bearing_sim.simulation import Inputs, IntegrationError

START = Inputs(shaft_speed=100.0, load_y=800.0, load_z=0.0, oil_temperature=393.15)


class FakeSimulation:
    """Slip is a hundredth, damage grows with shaft rotation; nothing is compiled."""

    rollers = 6
    thermal = None

    def __init__(self, inputs: Inputs = START):
        self.seconds_per_tick = 0.0
        self.fails_at = lambda time, inputs: False
        self.breaks_at = lambda time: False
        self.calls = []
        self.resets = []
        self.reset(inputs)

    def reset(self, inputs=None):
        self.inputs = inputs or START
        self.resets.append(self.inputs)
        self.time = 0.0
        self.angle = 0.0
        self.sample = self._observe(0.0, self.inputs)

    def advance(self, duration, inputs=None, samples=1):
        inputs = inputs or self.inputs
        if self.seconds_per_tick:
            time.sleep(self.seconds_per_tick)
        if self.breaks_at(self.time):
            raise ZeroDivisionError("a fault of the program")
        if self.fails_at(self.time, inputs):
            raise IntegrationError("step size went to zero at 0.0123 s")
        self.calls.append((self.inputs, inputs))
        block = new_block(samples, self.rollers)
        for k in range(samples):
            share = (k + 1) / samples
            now = Inputs(*(old + share * (new - old) for old, new in zip(self.inputs, inputs)))
            self.angle += 0.5 * duration / samples * (now.shaft_speed + self.inputs.shaft_speed)
            block[k] = self._observe(self.time + share * duration, now)
        self.time += duration
        self.inputs = inputs
        self.sample = block[-1]
        return block

    def _observe(self, now, inputs) -> np.void:
        sample = new_block(1, self.rollers)[0]
        sample["time"], sample["shaft_speed"], sample["shaft_angle"] = now, inputs.shaft_speed, self.angle
        sample["load_y"], sample["load_z"], sample["oil_temperature"] = inputs.load_y, inputs.load_z, inputs.oil_temperature
        sample["inner_ring_temperature_measured"], sample["outer_ring_temperature_measured"] = inputs[4:]
        sample["ideal_cage_speed"], sample["cage_speed"], sample["cage_slip"] = 0.4 * inputs.shaft_speed, 0.396 * inputs.shaft_speed, 0.01
        sample["rating_life"] = sample["modified_rating_life"] = sample["l10"] = sample["l10r"] = 1000.0
        sample["damage"] = 1e-9 * self.angle
        return sample
