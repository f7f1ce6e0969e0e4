# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A course of inputs cut into stretches with mean conditions, where each instant would cost too much."""

from typing import NamedTuple

import numpy as np


class Stretches(NamedTuple):
    """Stretches of a course that were not all gap.

    Attributes
    ----------
    middles : mean time of each [s], shape (m,).
    seconds : how long each lasts, less its gaps [s], shape (m,).
    conditions : means over each, columns as the course's, shape (m, 4).
    """

    middles: np.ndarray
    seconds: np.ndarray
    conditions: np.ndarray


def stretches(times: np.ndarray, inputs: np.ndarray, in_gap: np.ndarray, most: int) -> Stretches:
    """Cut a course into stretches of the same length.

    Parameters
    ----------
    times, inputs : instants [s], rising, shape (n,), and conditions there, linear in between, shape (n, 4).
    in_gap : whether the time that ends at an instant is left out, shape (n,).
    most : how many stretches at most.
    """
    edges = np.linspace(times[0], times[-1], most + 1)
    every = np.union1d(times, edges)
    step, middle = np.diff(every), 0.5 * (every[1:] + every[:-1])
    step = np.where(in_gap[np.searchsorted(times, middle)], 0.0, step)
    place = np.clip(np.searchsorted(edges, middle) - 1, 0, most - 1)
    seconds = np.bincount(place, step, most)
    kept = seconds > 0.0

    def mean(values: np.ndarray) -> np.ndarray:
        return np.bincount(place, step * values, most)[kept] / seconds[kept]

    at_middle = [np.interp(middle, times, column) for column in inputs.T]
    return Stretches(mean(middle), seconds[kept], np.stack([mean(column) for column in at_middle], axis=-1))
