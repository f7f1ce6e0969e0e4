# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How well bands agree with a sample of level ``steady`` itself at random operating points, and what one band costs.

python test/benchmarks/band_accuracy.py [SCENE] [--points 50] [--samples 1024] [--set FIELD=VALUE ...]
"""

import argparse
import time

import numpy as np

from bearing_sim.estimation.bands import QUANTITIES, BandEstimator, prior_draws
from bearing_sim.estimation.response import ANSWERS, PROBABILITIES, conditions_at, domain_of, scene_fields
from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.response import at_points, obtain_response

COMPARED = QUANTITIES[:3]  # the fourth follows from a life and its past
TOLERANCE = 0.1  # of the width of the band
RATE = 50.0  # Hz
BATCHES = (1, 10)  # samples that are taken at once


def samples_at(conditions, answers):
    """Return samples with the scene's own answers at operating points, as far as a `BandEstimator` reads them."""
    names = ("time", "damage", "shaft_speed", "load_y", "load_z", "oil_temperature", *ANSWERS)
    block = np.zeros(len(conditions), [(name, float) for name in names])
    block["time"] = np.arange(len(conditions))
    block["shaft_speed"], block["oil_temperature"] = conditions[:, 0], conditions[:, 2]
    block["load_y"], block["load_z"] = (conditions[:, 1] * turn(conditions[:, 3]) for turn in (np.cos, np.sin))
    for column, name in enumerate(ANSWERS):
        block[name] = answers[:, column]
    return block


def compare(scene, points, samples, seed):
    """Return the distances of the bands' edges from the exact ones over the width, shape (k, 3, 2), and a sample of each operating point."""
    fields = scene_fields(scene)
    random = np.random.default_rng(seed)
    conditions = conditions_at(random.random((points, 4)), domain_of(scene))
    drawn = prior_draws(len(fields), samples, seed)[0]
    scores = np.concatenate([fields.scores_of(fields.own)[None], drawn])
    answers = at_points(scene, np.tile(scores, (points, 1)), np.repeat(conditions, len(scores), axis=0)).reshape(points, len(scores), -1)
    kept = np.isfinite(answers[:, 0, :4]).all(axis=1)
    print(f"{np.count_nonzero(~kept)} of {points} operating points without an answer of the scene itself")
    print(f"{np.isnan(answers[kept, 1:, 0]).sum()} of {answers[kept, 1:, 0].size} samples without an answer")
    columns = [ANSWERS.index(name) for name in COMPARED]
    exact = np.moveaxis(np.nanquantile(answers[kept][:, 1:, columns], PROBABILITIES, axis=1), 0, -1)
    block = samples_at(conditions[kept], answers[kept, 0])
    found = BandEstimator(scene, obtain_response(scene)).take(block)[:, : len(COMPARED)]
    return np.abs(found - exact) / np.diff(exact, axis=-1), block


def cost(scene, block):
    """Print the processor time of a band, and of bands at `RATE`, for samples that come at once."""
    for size in BATCHES:
        bands = BandEstimator(scene, obtain_response(scene))
        repeats = np.resize(block, 50 * size).reshape(50, size)
        repeats["time"] = np.arange(repeats.size).reshape(repeats.shape) / RATE
        repeats["shaft_speed"] *= 1.0 + 1e-6 * np.arange(repeats.size).reshape(repeats.shape)  # no two alike
        bands.take(repeats[0])
        began = time.process_time()
        for each in repeats[1:]:
            bands.take(each)
        each = (time.process_time() - began) / (49 * size)
        print(f"{size:2d} at once: {1e3 * each:.3f} ms a band, {100.0 * RATE * each:.2f} % of a core at {RATE:g} Hz")


def main():
    """Print the comparison and the cost."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("scene", nargs="?", default="deng2017_table1")
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--samples", type=int, default=1024, help="a power of two")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="FIELD=VALUE")
    given = parser.parse_args()
    scene = load_scene(given.scene, [*given.overrides, "level=steady"])
    response = obtain_response(scene)
    print(f"{scene.name}: {len(response.fields)} uncertain fields, response of {response.points} points in {response.seconds:.0f} s")
    distances, block = compare(scene, given.points, given.samples, given.seed)
    for column, name in enumerate(COMPARED):
        edges = distances[:, column].ravel()
        edges = edges[np.isfinite(edges)]
        within = np.mean(edges <= TOLERANCE) if len(edges) else np.nan
        worst = edges.max() if len(edges) else np.nan
        print(f"{name}: {100 * within:.1f} % of {len(edges)} edges within a tenth of the band's width; largest distance {worst:.3f} widths")
    cost(scene, block)


if __name__ == "__main__":
    main()
