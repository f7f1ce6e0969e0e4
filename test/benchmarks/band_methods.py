# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How well other methods than the response meet the edges of the band of cage slip, from the same settled points.

python test/benchmarks/band_methods.py [SCENE] [--points 50] [--samples 1024] [--journal FILE] [--set FIELD=VALUE ...]

It needs scikit-learn and chaospy, which the package itself does not (`pip install scikit-learn chaospy`).  Methods:

- the response: polynomials of the fields at each operating point, splines over operating points,
- a Gaussian process of slip over operating point and fields together,
- polynomial chaos of slip over both,
- a Gaussian process over operating points of both edges alone, which knows no fields: a posterior of them could not be put in.

All of them see slip on its scale (`bearing_sim.watchers.estimation.response.slip_scale`), and operating points by the coordinates of the response.
"""

import time

import chaospy
import numpy as np
from band_accuracy import TOLERANCE, distances, samples_of, scene_and_arguments
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Matern, WhiteKernel

from bearing_sim.studies.response_points import DRAWS, at_points, design
from bearing_sim.sweep.tasks import Execution, Journal
from bearing_sim.watchers.estimation.bands import prior_draws
from bearing_sim.watchers.estimation.lives import SlipAndOil
from bearing_sim.watchers.estimation.response import (
    ANSWERS,
    PROBABILITIES,
    coordinates,
    domain_of,
    fit_response,
    scene_fields,
    slip_scale,
    transformed,
)

SLIP = ANSWERS.index("cage_slip")
POINTS = 16_384  # that all methods see
SEARCHED, TAKEN = 400, 2_048  # of them by which a Gaussian process finds its lengths, and that it is fitted to
DEGREES, TRUNCATION = (3, 4), 0.75  # of polynomial chaos, and the exponent of its hyperbolic truncation
BAND = 256  # draws of a band


def places(conditions, domain):
    """Return operating points by the coordinates that vary, the angle as a point on a circle, shape (n, c)."""
    there = coordinates(conditions, domain)
    columns = [there[:, :2], there[:, 2:3]] if domain.temperatures[1] > domain.temperatures[0] else [there[:, :2]]
    if domain.period:
        columns.append(np.stack([np.cos(there[:, 3]), np.sin(there[:, 3])], axis=1))
    return np.concatenate(columns, axis=1)


def together(there, fractions):
    """Return inputs of each operating point with all draws of the fields, shape (n m, c + d)."""
    return np.concatenate([np.repeat(there, len(fractions), axis=0), np.tile(fractions, (len(there), 1))], axis=1)


def process(inputs, values, kernel):
    """Return a fitted Gaussian process, its lengths found by few of the points."""
    chosen = np.random.default_rng(0).permutation(len(inputs))[:TAKEN]
    searched = GaussianProcessRegressor(kernel, normalize_y=True).fit(inputs[chosen[:SEARCHED]], values[chosen[:SEARCHED]])
    return GaussianProcessRegressor(searched.kernel_, optimizer=None, normalize_y=True).fit(inputs[chosen], values[chosen])


def chaos(inputs, values, degree):
    """Return a polynomial chaos fitted by least squares, as a function of inputs, and the number of its terms."""
    expansion = chaospy.generate_expansion(degree, chaospy.Iid(chaospy.Uniform(-1.0, 1.0), inputs.shape[1]), cross_truncation=TRUNCATION)
    weights = np.linalg.lstsq(np.array(expansion(*inputs.T)).T, values)[0]
    return lambda asked: np.array(expansion(*asked.T)).T @ weights, len(weights)


class Comparison:
    """What bands of a method are held against.

    Parameters
    ----------
    exact : slip at the operating points, that of the scene's own values first, shape (n, m + 1).
    """

    def __init__(self, exact):
        self.exact, self.own = exact[:, 1:], slip_scale(exact[:, :1])
        self._slips = np.concatenate([-np.geomspace(1.0, 1e-7, 2000), [0.0], np.geomspace(1e-7, 0.999, 20_000)])

    def show(self, name, departures, fitted, band):
        """Print how the edges by departures from the own values agree, shape (n, 2), and the processor time of the fit and of one band [s]."""
        edges = np.interp(self.own + departures, slip_scale(self._slips), self._slips)
        off = distances(edges, self.exact)[0]
        within, size = 100.0 * (off <= TOLERANCE).mean(), np.sqrt((off**2).mean())
        said = f"{name}: {within:.1f} % of {off.size} edges within a tenth of the width, root mean square {size:.3f}"
        print(f"{said}; fit {fitted:.1f} s, a band {1e3 * band:.2f} ms of processor time", flush=True)


def edges_of(departures):
    """Return the edges of bands of departures of shape (n, m), shape (n, 2)."""
    return np.quantile(departures, PROBABILITIES, axis=1).T


def timed(function, *arguments):
    """Return what a function returns and its processor time [s]."""
    began = time.process_time()
    return function(*arguments), time.process_time() - began


def compare(scene, training, conditions, exact):
    """Print the figures of all methods.

    Parameters
    ----------
    scene : of level ``steady``.
    training : operating points and scores of `design`, and the settled answers there.
    conditions : at which bands are compared, shape (n, 4).
    exact : slip there, that of the scene's own values first, shape (n, m + 1).
    """
    fields, domain, effects, against = scene_fields(scene), domain_of(scene), SlipAndOil(scene), Comparison(exact)
    nodes, scores, answers = training
    drawn = np.concatenate([fields.scores_of(fields.own)[None], prior_draws(len(fields), BAND)])

    model, fitted = timed(fit_response, fields, domain, nodes, scores, answers, effects)
    basis = np.concatenate([model.own_basis[None], model.basis_of(drawn[1:])])
    found = model.respond_scaled(conditions, basis)[:, :, SLIP]
    band = timed(model.respond_scaled, conditions[:1], basis)[1]
    against.show("response", edges_of(found[:, 1:] - found[:, :1]), fitted, band)

    slips = transformed(answers)[:, SLIP].reshape(-1, DRAWS)
    kept = np.isfinite(slips).all(axis=1)
    slips, there, asked = slips[kept], places(nodes[::DRAWS][kept], domain), places(conditions, domain)
    inputs = together(there, 2.0 * fields.fractions_of(scores[:DRAWS]) - 1.0)
    wanted = together(asked, 2.0 * fields.fractions_of(drawn) - 1.0)

    def show_direct(name, predict, fitted):
        found, seconds = timed(lambda: np.concatenate([predict(part) for part in np.array_split(wanted, len(asked))]))
        found = found.reshape(len(asked), -1)
        against.show(name, edges_of(found[:, 1:] - found[:, :1]), fitted, seconds / len(asked))

    for degree in DEGREES:
        (predict, terms), fitted = timed(chaos, inputs, slips.ravel(), degree)
        show_direct(f"polynomial chaos of degree {degree}, {terms} terms", predict, fitted)
    smooth = ConstantKernel(1.0) * RBF(np.ones(inputs.shape[1]), (0.05, 1e3)) + WhiteKernel(1e-4, (1e-10, 1.0))
    model, fitted = timed(process, inputs, slips.ravel(), smooth)
    show_direct(f"Gaussian process, {TAKEN} points", model.predict, fitted)
    rough = ConstantKernel(1.0) * Matern(np.ones(there.shape[1]), (0.05, 1e3), nu=2.5) + WhiteKernel(1e-4, (1e-10, 1.0))
    model, fitted = timed(process, there, edges_of(slips[:, 1:] - slips[:, :1]), rough)
    found, seconds = timed(model.predict, asked)
    against.show("Gaussian process of both edges", found, fitted, seconds / len(asked))


def main():
    """Print the comparison."""
    scene, given = scene_and_arguments(__doc__)
    nodes, scores = design(scene, POINTS)
    with Journal(given.journal) as journal:
        training = nodes, scores, at_points(scene, scores, nodes, Execution(journal))
        conditions, answers = samples_of(scene, given.points, given.samples, given.seed, journal)
    compare(scene, training, conditions, answers[:, :, SLIP])


if __name__ == "__main__":
    main()
