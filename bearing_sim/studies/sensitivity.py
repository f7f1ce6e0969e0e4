# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Bands and Sobol' indices of any function of independent uncertain numbers: what to evaluate it at, and what comes of the values.

The design has two independent samples A and B and, for each number, A with that number's column out of B: N (d + 2) points for
first-order and total indices (Saltelli et al., Comput. Phys. Commun. 181, 2010, 259).  Both samples come out of one scrambled
Sobol' sequence in 2 d dimensions; bands are taken over both.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import stats
from scipy.stats import qmc

from bearing_sim.scene_uncertainty import Range

SHARES = (0.05, 0.50, 0.95)  # of the probability, below the ends of a band and its middle
CONFIDENCE = 0.95  # of all that is said about sampling error
_RESAMPLES = 400


class Design(NamedTuple):
    """Where to evaluate.

    Attributes
    ----------
    base : N, a power of two.
    points : in SI, shape ((d + 2) N, d): A, B, then A with each column in turn out of B.
    """

    base: int
    points: np.ndarray


class Band(NamedTuple):
    """What a value may be, with 95 % confidence intervals for the sampling error of each number: (low, high)."""

    low: float  # 5 % lie below
    middle: float
    high: float  # 95 % lie below
    low_error: tuple[float, float]
    middle_error: tuple[float, float]
    high_error: tuple[float, float]


class Indices(NamedTuple):
    """Sobol' indices of one value, shape (d,), and 95 % confidence intervals of them, shape (d, 2); NaN where the value does not vary.

    first : share of the variance that would be gone if this number alone were known.
    total : share that would be left if all others were known.
    """

    first: np.ndarray
    total: np.ndarray
    first_error: np.ndarray
    total_error: np.ndarray


def distribution(one: Range, own: float):
    """Return the distribution of a range; ``own``, the scene's value [SI], is the peak of a triangular one without a mode."""
    if one.distribution == "log_uniform":
        return stats.loguniform(one.low, one.high)
    width = one.high - one.low
    if one.distribution == "uniform":
        return stats.uniform(one.low, width)
    mode = one.mode if one.mode is not None else own if one.low <= own <= one.high else 0.5 * (one.low + one.high)
    return stats.triang((mode - one.low) / width, one.low, width)


def design(distributions: Sequence, base: int, seed: int) -> Design:
    """Return the points of a study.

    Parameters
    ----------
    distributions : of each number, anything with a method ``ppf``.
    base : N.
    seed : of the scrambling; the same seed gives the same points.

    Raises
    ------
    ValueError
        ``base`` is no power of two: only then is a Sobol' sequence balanced.
    """
    if base < 2 or base & (base - 1):
        raise ValueError(f"{base} samples: expected a power of two from 2 on")
    count = len(distributions)
    places = qmc.Sobol(d=2 * count, scramble=True, seed=np.random.default_rng(seed)).random_base2(base.bit_length() - 1)
    drawn = np.stack([one.ppf(places[:, column::count]) for column, one in enumerate(distributions)], axis=-1)
    first, second = drawn[:, 0], drawn[:, 1]
    mixed = [np.where(np.arange(count) == column, second, first) for column in range(count)]
    return Design(base, np.concatenate([first, second, *mixed]))


def band(values: np.ndarray) -> Band:
    """Return the band of values at the points of a design, or at any independent points.

    Sampling errors are those of order statistics of independent draws (binomial), which do not know how evenly a Sobol' sequence
    spreads: they are upper bounds.

    Parameters
    ----------
    values : shape (n,), NaN left out; infinite ones count.
    """
    ordered = np.sort(values[~np.isnan(values)])
    if not len(ordered):
        return Band(*[np.nan] * 3, *[(np.nan, np.nan)] * 3)
    found = np.quantile(ordered, SHARES, method="inverted_cdf")
    errors = []
    for share in SHARES:
        ranks = stats.binom.ppf([0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], len(ordered), share).astype(int)
        errors.append(tuple(float(ordered[rank]) for rank in np.clip(ranks - [1, 0], 0, len(ordered) - 1)))
    return Band(*map(float, found), *errors)


def indices(values: np.ndarray, base: int, seed: int) -> Indices:
    """Return the Sobol' indices of a value, with bootstrap intervals.

    Parameters
    ----------
    values : at the points of a `design`, in its order, shape ((d + 2) base,).
    base : N.
    seed : of the bootstrap.

    Raises
    ------
    ValueError
        A value is not finite: the design would be no longer balanced.
    """
    if not np.isfinite(values).all():
        raise ValueError(f"{np.count_nonzero(~np.isfinite(values))} of {len(values)} values are not finite: there are no Sobol' indices of them")
    parts = values.reshape(-1, base)
    count = len(parts) - 2
    if np.ptp(values) <= 1e-12 * np.abs(values).max():
        return Indices(*[np.full(count, np.nan)] * 2, *[np.full((count, 2), np.nan)] * 2)
    found = _both(parts)
    lot = np.random.default_rng(seed)
    again = np.array([_both(parts[:, lot.integers(0, base, base)]) for _ in range(_RESAMPLES)])
    ends = np.quantile(again, [0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2], axis=0)
    return Indices(found[0], found[1], ends[:, 0].T, ends[:, 1].T)


def _both(parts: np.ndarray) -> np.ndarray:
    """Return first-order and total indices, shape (2, d)."""
    if len(parts) == 3:  # SciPy squeezes a single number away; all of the variance is its
        return np.ones((2, 1))
    found = stats.sobol_indices(func={"f_A": parts[:1], "f_B": parts[1:2], "f_AB": parts[2:, None]}, n=parts.shape[1])
    return np.array([np.ravel(found.first_order), np.ravel(found.total_order)])
