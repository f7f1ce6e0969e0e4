# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How well bands agree with a sample of level ``steady`` itself at random operating points, and what one band costs.

python test/benchmarks/band_accuracy.py [SCENE] [--points 50] [--samples 1024] [--journal FILE] [--set FIELD=VALUE ...]

Remaining life is compared where half of the life is spent at each operating point for itself, and along a course that holds each for as long, until
half of the life is spent: there what is off at one of the points that wear most is off at all that follow.

What no method could better is printed beside: how well the quantiles of one half of the samples agree with those of the other, and, where life
follows slip alone, how well lives by the level's own loads at the slips of the samples themselves agree with the samples' lives.

Where life follows slip alone, its band may be narrower than what the level resolves: two solutions of the same loads from different starts differ
by the tolerance of its load balance.  How far the level's lives are from those at the same slips, computed from another start, is its
resolution; edges that are off by less are counted apart.
"""

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from bearing_sim.scene.loader import load_scene
from bearing_sim.studies.response_points import at_points, obtain_response
from bearing_sim.sweep.tasks import Execution, Journal
from bearing_sim.watchers.estimation.bands import QUANTITIES, BandEstimator
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import ANSWERS, PROBABILITIES, conditions_at, domain_of, prior_draws, scene_fields

RESOLVED = 32  # samples of an operating point by which the level's resolution is found
SPENT = 0.5  # of the life, along the course
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


def samples_of(scene, points, samples, seed, journal):
    """Return operating points, shape (k, 4), and the answers there, of the scene itself first, shape (k, samples + 1, 7)."""
    fields = scene_fields(scene)
    conditions = conditions_at(np.random.default_rng(seed).random((points, 4)), domain_of(scene))
    scores = np.concatenate([fields.scores_of(fields.own)[None], prior_draws(len(fields), samples, seed)])
    tiled = np.tile(scores, (points, 1)), np.repeat(conditions, len(scores), axis=0)
    answers = at_points(scene, *tiled, Execution(journal)).reshape(points, len(scores), -1)
    kept = np.isfinite(answers[:, 0, :4]).all(axis=1)
    print(f"{np.count_nonzero(~kept)} of {points} operating points without an answer of the scene itself")
    print(f"{np.isnan(answers[kept, 1:, 0]).sum()} of {answers[kept, 1:, 0].size} samples without an answer")
    return conditions[kept], answers[kept]


def distances(found, exact):
    """Return how far edges are from the exact ones over the width, and the edges; shape (k, 2) each."""
    edges = np.nanquantile(exact, PROBABILITIES, axis=1).T
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.abs(found - edges) / np.diff(edges, axis=1), edges


def show(name, off, edges, resolution=None):
    """Print how many edges are within the tolerance, and with what the level resolves [1], shape (k,)."""
    width = np.diff(edges, axis=1)
    counted = np.isfinite(off) & (width > 0.0)
    if not counted.any():
        print(f"{name}: no band, its width is 0 at all points")
        return
    within, widths = off <= TOLERANCE, (width / np.abs(edges.mean(axis=1, keepdims=True)))[counted.any(axis=1)]
    said = f"{name}: {100 * within[counted].mean():.1f} % of {counted.sum()} edges within a tenth of the band's width"
    print(f"{said}; largest distance {off[counted].max():.3f} widths; median width {np.median(widths):.2g} of the value")
    if resolution is not None:
        either = within | (off * width <= resolution[:, None] * np.abs(edges))
        said = f"{name}: {100 * either[counted].mean():.1f} % within that or within the level's resolution, {np.median(resolution):.1g} in the median"
        print(f"{said}; at {np.count_nonzero(TOLERANCE * width[:, 0] < resolution * np.abs(edges).min(axis=1))} points a tenth of the width is less")


def show_scatter(name, exact):
    """Print how well the quantiles of the first half of samples agree with those of the second; both halves are nets of Sobol' themselves."""
    half = exact.shape[1] // 2
    off, edges = distances(np.nanquantile(exact[:, :half], PROBABILITIES, axis=1).T, exact[:, half:])
    show(f"{name}, one half of the samples against the other", off, edges)


def show_at_known_slips(scene, conditions, answers):
    """Print how well lives at the slips of the samples themselves agree with the samples' lives: what a response without errors would reach."""
    effects, life = SlipAndOil(scene), ANSWERS.index("rating_life")
    changes = effects.by_slip(conditions, np.nan_to_num(answers[:, :, ANSWERS.index("cage_slip")]))
    found = np.quantile(answers[:, :1, life] * np.exp(changes[:, 1:]), PROBABILITIES, axis=1).T
    show("rating_life, at the samples' own slips", *distances(found, answers[:, 1:, life]))


def resolution_of(scene, conditions, answers):
    """Return how far the level's lives are at most from those at the same slips, computed from another start [1], shape (k,)."""
    effects, found = SlipAndOil(scene), []
    for condition, answer in zip(conditions, answers[:, :RESOLVED]):
        revolutions = answer[:, ANSWERS.index("rating_life")] * 3600.0 * abs(condition[0]) / (2.0 * np.pi)
        found.append(np.nanmax(np.abs(np.log(revolutions) - effects.rating_lives(condition.tolist(), answer[:, 0].tolist()))))
    return np.array(found)


def compare(scene, response, conditions, answers):
    """Print how far the edges of bands of settled answers are from the exact ones."""
    found = BandEstimator(scene, response).estimate(samples_at(conditions, answers[:, 0]))
    for column, name in enumerate(QUANTITIES[:3]):
        by_slip_alone = name == "rating_life" and ANSWERS.index(name) not in response.varied_answers()
        resolution = resolution_of(scene, conditions, answers) if by_slip_alone else None
        exact = answers[:, 1:, ANSWERS.index(name)]
        show(name, *distances(found[:, column], exact), resolution)
        show_scatter(name, exact)
        if by_slip_alone:
            show_at_known_slips(scene, conditions, answers)


def compare_remaining(scene, response, conditions, answers):
    """Print how far the edges of the band of remaining life are from the exact ones, at each point for itself and along a course."""
    lives = answers[:, :, ANSWERS.index("modified_rating_life")]
    kept = np.isfinite(lives).all(axis=1)
    conditions, answers, rates = conditions[kept], answers[kept], 1.0 / (3600.0 * lives[kept])
    block, column = samples_at(conditions, answers[:, 0]), QUANTITIES.index("remaining_life")
    block["damage"] = SPENT
    found = np.concatenate([BandEstimator(scene, response).estimate(block[k : k + 1])[:, column] for k in range(len(block))])
    exact = np.clip(1.0 - SPENT * rates / rates[:, :1], 0.0, 1.0) / (3600.0 * rates)
    show("remaining_life, each point for itself", *distances(found, exact[:, 1:]))

    hold = SPENT / rates[:, 0].sum()
    spent, memory = np.cumsum(hold * rates, axis=0), 3.0 * hold
    means = rates.copy()
    for k in range(1, len(means)):
        means[k] = means[k - 1] + (1.0 - np.exp(-hold / memory)) * (rates[k] - means[k - 1])
    exact = np.clip(1.0 - spent, 0.0, 1.0) / (3600.0 * means)
    block["time"], block["damage"] = hold * np.arange(1, len(block) + 1), spent[:, 0]
    bands = BandEstimator(replace(scene, thresholds=replace(scene.thresholds, remaining_life_memory=memory)), response)
    show("remaining_life, along a course", *distances(bands.estimate(block)[:, column], exact[:, 1:]))
    print(f"remaining_life: that of the level itself is met to {np.abs(bands.remaining_life / exact[:, 0] - 1.0).max():.1g}")


def cost(scene, response, block):
    """Print the processor time of a band, and of bands at `RATE`, for samples that come at once."""
    for size in BATCHES:
        bands = BandEstimator(scene, response)
        repeats = np.resize(block, 50 * size).reshape(50, size)
        repeats["time"] = np.arange(repeats.size).reshape(repeats.shape) / RATE
        repeats["shaft_speed"] *= 1.0 + 1e-6 * np.arange(repeats.size).reshape(repeats.shape)  # no two alike
        bands.estimate(repeats[0])
        began = time.process_time()
        for each in repeats[1:]:
            bands.estimate(each)
        each = (time.process_time() - began) / (49 * size)
        print(f"{size:2d} at once: {1e3 * each:.3f} ms a band, {100.0 * RATE * each:.2f} % of a core at {RATE:g} Hz")


def scene_and_arguments(description):
    """Return the scene of a comparison at level ``steady`` and the other arguments of its command."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("scene", nargs="?", default="deng2017_table1")
    parser.add_argument("--points", type=int, default=50)
    parser.add_argument("--samples", type=int, default=1024, help="a power of two")
    parser.add_argument("--seed", type=int, default=2)
    parser.add_argument("--journal", type=Path, help="keeps finished samples: the same command resumes")
    parser.add_argument("--set", dest="overrides", action="append", default=[], metavar="FIELD=VALUE")
    given = parser.parse_args()
    return load_scene(given.scene, [*given.overrides, "level=steady"]), given


def main():
    """Print the comparison and the cost."""
    scene, given = scene_and_arguments(__doc__)
    response = obtain_response(scene)
    print(f"{scene.name}: {len(response.fields)} uncertain fields, response of {response.points} points in {response.seconds:.0f} s")
    with Journal(given.journal) as journal:
        conditions, answers = samples_of(scene, given.points, given.samples, given.seed, journal)
    compare(scene, response, conditions, answers)
    compare_remaining(scene, response, conditions, answers)
    cost(scene, response, samples_at(conditions, answers[:, 0]))


if __name__ == "__main__":
    main()
