# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Polyharmonic splines through scattered points, their errors where a point is left out, and the metric in which distances count best."""

import itertools
import math
from collections.abc import Callable, Sequence

import numpy as np

_SEARCHED, _STEP, _STEEPEST = 150, 0.4, 4.0  # metrics that are tried, first step and largest value of a scale's logarithm or a slope


def spline_functions(there: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Return the functions of the operating point: cubes of the distances from the centres, and planes.

    They are polyharmonic splines (J. Duchon, Lect. Notes Math. 571 (1977) 85).

    Parameters
    ----------
    there : coordinates of operating points, scaled, shape (..., n, c).
    centres : likewise, shape (..., k, c).

    Returns
    -------
    shape (..., n, k + c + 1).
    """
    square = np.square(there).sum(axis=-1)[..., None] + np.square(centres).sum(axis=-1)[..., None, :] - 2.0 * there @ np.swapaxes(centres, -1, -2)
    square = np.maximum(square, 0.0)
    return np.concatenate([square * np.sqrt(square), np.ones((*there.shape[:-1], 1)), there], axis=-1)


def _matrix(centres: np.ndarray, smoothing: float) -> np.ndarray:
    """Return the matrix of the splines of values at centres, shape (k + c + 1, k + c + 1)."""
    square = spline_functions(centres, centres)
    planes = square[:, len(centres) :]
    return np.block([[square[:, : len(centres)] + smoothing * np.eye(len(centres)), planes], [planes.T, np.zeros((planes.shape[1],) * 2)]])


def spline_weights(centres: np.ndarray, values: np.ndarray, smoothing: float = 0.0) -> np.ndarray:
    """Return the weights of `spline_functions` for values at the centres, shapes (k, v) and (k + c + 1, v).

    Parameters
    ----------
    centres, values : see above.
    smoothing : 0 for a spline that passes through all values; the more, the less it follows their noise (G. Wahba, Spline Models for Observational
        Data, 1990, eq. 2.4.2).
    """
    padded = np.concatenate([values, np.zeros((centres.shape[1] + 1, values.shape[1]))])
    return np.linalg.solve(_matrix(centres, smoothing), padded)


def left_out(centres: np.ndarray, values: np.ndarray, smoothing: float = 0.0) -> np.ndarray:
    """Return by how much the spline of all centres but one misses the values there, shape (k, v); parameters as of `spline_weights`.

    S. Rippa, Adv. Comput. Math. 11 (1999) 193: the weight over the diagonal of the inverse.
    """
    inverse = np.linalg.inv(_matrix(centres, smoothing))[: len(centres), : len(centres)]
    return inverse @ values / np.diagonal(inverse)[:, None]


def searched(start: np.ndarray, missed: Callable[[np.ndarray], float]) -> np.ndarray:
    """Return parameters of `metric_of` that miss least, by J. A. Nelder and R. Mead's simplex (Comput. J. 7 (1965) 308), shape of ``start``."""
    from scipy.optimize import minimize  # here, because only fits search

    simplex = start + np.concatenate([np.zeros((1, len(start))), _STEP * np.eye(len(start))])
    found = minimize(
        lambda parameters: missed(parameters) if np.abs(parameters).max() <= _STEEPEST else math.inf,
        start,
        method="Nelder-Mead",
        options={"maxfev": _SEARCHED, "initial_simplex": simplex},
    )
    return found.x


def metric_starts(scales: Sequence[Sequence[float]]) -> list[np.ndarray]:
    """Return the parameters of `metric_of` for all combinations of scales of the first columns, without slopes."""
    slopes = np.zeros(len(scales) * (len(scales) - 1) // 2)
    return [np.concatenate([np.log(chosen), slopes]) for chosen in itertools.product(*scales)]


def metric_of(parameters: np.ndarray, size: int) -> np.ndarray:
    """Return a metric by the logarithms of the scales of its first columns and the slopes between these, shape (size, size).

    Parameters
    ----------
    parameters : c scales and c (c - 1)/2 slopes of c columns.
    size : number of all columns.
    """
    columns = math.isqrt(2 * len(parameters))
    found = np.eye(size)
    scales = np.exp(parameters[:columns])
    found[range(columns), range(columns)] = scales
    rows, others = np.triu_indices(columns, 1)
    found[rows, others] = parameters[columns:] * scales[others]
    return found
