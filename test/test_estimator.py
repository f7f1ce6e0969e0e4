# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The estimator against machines with known fields, whose slip is a closed form that only the response's polynomials have been fitted to."""

import math

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import qmc

from bearing_sim.estimation.estimator import Estimator
from bearing_sim.estimation.response import conditions_at, domain_of, fit_response, scene_fields
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.estimator import samples

QUANTITY, SCALE, RADIUS = "lubricant.mixture_fraction", "lubricant.traction_scale", "bearing.outer_raceway.low_radius"
FIELDS = (QUANTITY, SCALE, RADIUS)
OTHERS = ("lubricant.temperature", "bearing.cage.guide_clearance", "bearing.cage.pocket_friction", "bearing.cage.land_friction")
NOISE = 0.002  # of a reading of slip
POINT = np.array([4712.0, 800.0, 393.15, 0.0])  # speed, load, oil temperature, direction of the load
COURSE = np.array([POINT, POINT * [0.6, 1.0, 1.0, 1.0], POINT * [1.0, 4.0, 1.0, 1.0], POINT * [0.7, 2.0, 1.03, 1.0], POINT * [1.1, 0.5, 0.98, 1.0]])


@pytest.fixture(scope="module")
def scene():
    ranges = [f"uncertainty.{path}=null" for path in OTHERS] + [f"uncertainty.{RADIUS}=[34.8600 mm, 34.8650 mm]"]
    return load_scene("deng2017_table1", ["level=steady", *ranges, f"estimation.calibrated=[{', '.join(FIELDS)}]"])


def slip_of(fields, scores, conditions):
    """Return the slip of a machine: oil and traction act as one at every condition, the clearance more, the lighter the load."""
    quantity, scale, radius = 4.0 * fields.fractions_of(np.asarray(scores)) - 2.0
    speed, load, kelvin = conditions[0] / 4712.0, conditions[1] / 800.0, (conditions[2] - 393.15) / 20.0
    free = 0.06 * speed * load**-0.6 * math.exp(0.3 * quantity - 0.2 * scale + 0.2 * radius * (1.0 - 0.4 * math.log(load)) - 0.1 * kelvin)
    return free / (1.0 + free)


@pytest.fixture(scope="module")
def response(scene):
    fields, domain = scene_fields(scene), domain_of(scene)
    uniform = qmc.Sobol(7, seed=np.random.default_rng(1)).random(2048)
    conditions, scores = conditions_at(uniform[:, :4], domain), ndtri(np.clip(uniform[:, 4:], 1e-5, 1.0 - 1e-5))
    answers = np.full((len(scores), 6), math.nan)
    answers[:, 0] = [slip_of(fields, *each) for each in zip(scores, conditions)]
    answers[:, 1:3], answers[:, 3] = 300.0, 5e-6 * scores[:, 2]
    print(fit_response(fields, domain, conditions, scores, answers).errors)
    assert tuple(one.field for one in fields.ranges) == FIELDS
    return fit_response(fields, domain, conditions, scores, answers)


class Rig:
    """A machine with a noisy cage sensor, beside the samples of the scene's own values."""

    def __init__(self, scene, response, scores, seed=0):
        self.scene, self.response, self.scores, self.now = scene, response, np.array(scores, float), 0.0
        self.random = np.random.default_rng(seed)

    def run(self, estimator, seconds, conditions=POINT, offset=0.0, wild=0.0, noise=NOISE):
        """Advance by seconds of one condition, second by second; return when a change was told first."""
        told = math.nan
        slip, own = slip_of(self.response.fields, self.scores, conditions) + offset, slip_of(self.response.fields, self.response.nominal, conditions)
        for _ in range(round(seconds)):
            times = self.now + 0.1 * np.arange(1.0, 11.0)
            block = samples(self.scene, times, np.repeat(conditions[None], 10, axis=0), np.full(10, own))
            readings = slip + noise * self.random.normal(size=10)
            readings[self.random.random(10) < wild] = -0.8
            for time, reading, ideal in zip(times, readings, block["ideal_cage_speed"]):
                estimator.measure(float(time), float((1.0 - reading) * ideal))
            estimator.take(block)
            self.now += 1.0
            if math.isnan(told) and any(event.kind == "calibration.change" for event in estimator.events(self.now)):
                told = self.now
        return told

    def sample(self, conditions=POINT):
        own = slip_of(self.response.fields, self.response.nominal, conditions)
        return samples(self.scene, np.array([self.now]), conditions[None], np.array([own]))[0]


def test_a_measured_cage_moves_the_prediction_to_it_and_narrows_its_band(scene, response):
    rig, estimator = Rig(scene, response, [1.0, -0.5, 0.6]), Estimator(scene, response)
    truth = slip_of(response.fields, rig.scores, POINT)
    before = estimator.prediction(rig.sample())
    rig.run(estimator, 120)
    after = estimator.prediction(rig.sample())
    assert after.mean() == pytest.approx(truth, abs=5e-4) and before.std() > 0.01
    assert abs(after.mean() - truth) < 3.0 * after.std() < 0.1 * before.std()
