# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The common phase of several lines over a record, and its mean rate with a standard error.

A comb's lines share one phase: line j advances by ``multiplier_j`` times as much.  It is followed from segment to segment by maximum likelihood
for lines of unknown amplitude in noise, and a straight line is then fitted to it.  What remains is white noise of the phase and a random walk,
because rollers slip a little differently at every pass; both are estimated, so that the standard error holds for either.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.special

_CANDIDATES = 64  # phases tried at once
_ROUNDS = 4
_BENDS = np.concatenate(([0.0], np.geomspace(1e-6, 1e8, 43)))  # variance of an integrated walk over the record, over that of the noise
_ASTRAY = 4.0  # times the usual deviation from a smooth course, beyond which a segment does not count
_WALKS = np.concatenate(([0.0], np.geomspace(1e-4, 1e4, 33)))  # variance of a step of the walk over that of the noise


class Track(NamedTuple):
    """A phase over a record.

    Attributes
    ----------
    places : middle of each segment, in turns of the shaft, shape (n,).
    phases : common phase there beyond the lines' nominal one, in turns, shape (n,).
    score : likelihood ratio of the lines in a segment, mean over the segments (1 for each line is noise).
    """

    places: np.ndarray
    phases: np.ndarray
    score: float


class Course(NamedTuple):
    """A smooth phase over a record.

    Attributes
    ----------
    phases : at the places of the track, in turns, shape (n,).
    error : its standard error, root mean square, in turns.
    """

    phases: np.ndarray
    error: float


class Rate(NamedTuple):
    """Mean rate of a phase [turn per turn of the shaft] with its standard error."""

    value: float
    standard_error: float


def half_overlapping(count: int, parts: int) -> tuple[np.ndarray, int]:
    """Return where half overlapping parts of so many samples begin, shape (parts,), and how long each is."""
    length = int(2 * count / (parts + 1))
    return (np.arange(parts) * (count - length) / max(parts - 1, 1)).astype(int), length


def vertex(before: np.ndarray, peak: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Return how far from the middle of three equally spaced values the highest point of their parabola is, in their distance; 0 if it has none."""
    bend = before - 2.0 * peak + after
    return np.where(bend < 0.0, 0.5 * (before - after) / np.where(bend < 0.0, bend, 1.0), 0.0)


def follow(signal: np.ndarray, per_turn: float, orders: np.ndarray, multipliers: np.ndarray, noise: np.ndarray, segments: int) -> Track:
    """Follow the common phase of lines.

    Parameters
    ----------
    signal : at equal steps of the shaft's angle, shape (m,).
    per_turn : samples in a turn.
    orders : of the lines, in the order of ``multipliers``, shape (j,).
    multipliers : how much each line's phase advances with the common one, shape (j,).
    noise : density of the noise around each line, |amplitude|^2 per order, shape (j,).
    segments : into how many the record is cut, half overlapping.
    """
    begins, length = half_overlapping(len(signal), segments)
    window = np.hanning(length)
    window /= window.sum()
    turns = length / per_turn
    carriers = window * np.exp(-2j * np.pi * np.outer(orders, np.arange(length) / per_turn))  # (j, length)
    amplitudes = np.stack([carriers @ signal[begin : begin + length] for begin in begins])  # (i, j)
    amplitudes *= np.exp(-2j * np.pi * np.outer(begins / per_turn, orders))
    weights = 1.0 / np.maximum(1.5 * noise / turns, 1e-300)  # a Hann window has 1.5 times the noise of none
    phases = _first_phases(amplitudes, multipliers, weights)
    trial = (np.arange(_CANDIDATES) / _CANDIDATES - 0.5) / np.max(np.abs(multipliers))
    rows = np.arange(segments)
    for _ in range(_ROUNDS):
        aligned = amplitudes * np.exp(-2j * np.pi * np.outer(phases, multipliers))
        gains = ((weights * np.conj(aligned.mean(0)) * aligned) @ np.exp(-2j * np.pi * np.outer(multipliers, trial))).real  # (i, trial)
        best = np.argmax(gains, axis=1)
        fine = vertex(*(gains[rows, (best + shift) % _CANDIDATES] for shift in (-1, 0, 1)))
        phases = phases + trial[best] + np.clip(fine, -0.5, 0.5) * (trial[1] - trial[0])
    aligned = amplitudes * np.exp(-2j * np.pi * np.outer(phases, multipliers))
    return Track((begins + length / 2.0) / per_turn, phases, float(np.mean(np.abs(aligned) ** 2 @ weights)))


def _first_phases(amplitudes: np.ndarray, multipliers: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Return phases from the increments between neighbouring segments: all lines vote for the increment, [turn]."""
    products = (np.conj(amplitudes[:-1]) * amplitudes[1:]) * weights
    lowest = np.min(np.abs(multipliers))
    trial = (np.arange(4 * _CANDIDATES) / (4 * _CANDIDATES) - 0.5) / lowest
    votes = (products @ np.exp(-2j * np.pi * np.outer(multipliers, trial))).real
    return np.concatenate(([0.0], np.cumsum(trial[np.argmax(votes, axis=1)])))


def mean_rate(track: Track) -> Rate:
    """Return the slope of a phase with its standard error, by generalised least squares.

    How large the random walk is beside the white noise is not known: slopes and variances are averaged over ratios of the two, each with its
    restricted likelihood.  The standard error is widened as Student's distribution of as many degrees of freedom as there are independent
    segments, less two.
    """
    at = (track.places - track.places.mean()) / np.ptp(track.places)
    count = len(at)
    step = np.min(np.diff(at))
    overlap = _overlap(count)
    walk = np.minimum.outer(at - at[0], at - at[0]) / step
    fits = [_fitted(overlap + ratio * walk, at, track.phases) for ratio in _WALKS]
    weights = _weights(fits)
    slopes, variances = np.array([(fit.line[1], np.linalg.inv(fit.information)[1, 1] * fit.remainder / (count - 2)) for fit in fits]).T
    slope = float(weights @ slopes)
    variance = float(weights @ (variances + (slopes - slope) ** 2))
    widened = scipy.special.stdtrit(max(2, count // 2 - 2), 0.8413)  # one standard deviation of a normal distribution
    return Rate(slope / np.ptp(track.places), math.sqrt(variance) * widened / np.ptp(track.places))


def smoothed(track: Track) -> Course:
    """Return the phase of a track as a smoothing spline, whose stiffness is averaged over with its restricted likelihood.

    The rate is a random walk, and the phase its integral in white noise (Wahba, Spline Models for Observational Data, SIAM 1990, chapters 1 and 4:
    the likelihood takes noise for a course less often than cross-validation does).  Segments that went astray do not count.
    """
    at = (track.places - track.places[0]) / np.ptp(track.places)
    design = np.stack((np.ones(len(at)), at), axis=1)
    overlap = _overlap(len(at))
    low, high = np.minimum.outer(at, at), np.maximum.outer(at, at)
    integrated = low**2 * (3.0 * high - low) / 6.0
    kept = np.ones(len(at), bool)
    for _ in range(2):
        inside = np.ix_(kept, kept)
        freedom = int(kept.sum()) - 2
        fits = [_fitted(overlap[inside] + ratio * integrated[inside], at[kept], track.phases[kept]) for ratio in _BENDS]
        courses, variances = [], []
        for ratio, fit in zip(_BENDS, fits):
            gain = ratio * np.linalg.solve(fit.lower, integrated[kept]).T  # covariance with the white data, (n, kept)
            courses.append(design @ fit.line + gain @ fit.left)
            rest = design - gain @ fit.design
            variance = ratio * np.diag(integrated) - np.sum(gain**2, axis=1) + np.sum(rest @ np.linalg.inv(fit.information) * rest, axis=1)
            variances.append(variance * fit.remainder / freedom)
        weights = _weights(fits)
        phases = weights @ np.array(courses)
        error = math.sqrt(float(np.mean(weights @ np.maximum(variances, 0.0))))
        deviations = np.abs(track.phases - phases)
        nearby = deviations <= _ASTRAY * 1.4826 * np.median(deviations) + 1e-12
        if nearby.sum() < max(6, len(at) // 2):
            break
        kept = nearby
    return Course(phases, error)


class _Fitted(NamedTuple):
    """A straight line through data by generalised least squares.

    Attributes
    ----------
    lower : Cholesky factor of the covariance, which makes data white.
    design : of the line, whitened, shape (n, 2).
    left : whitened data less the line, shape (n,).
    line : its height and slope.
    information : of these, shape (2, 2).
    remainder : sum of squares that are left.
    likelihood : logarithm of the restricted likelihood.
    """

    lower: np.ndarray
    design: np.ndarray
    left: np.ndarray
    line: np.ndarray
    information: np.ndarray
    remainder: float
    likelihood: float


def _fitted(covariance: np.ndarray, at: np.ndarray, data: np.ndarray) -> _Fitted:
    """Return the straight line through data at places, both of shape (n,), whose covariance is known but for a factor."""
    lower = np.linalg.cholesky(covariance)
    design, white = np.linalg.solve(lower, np.stack((np.ones(len(at)), at), axis=1)), np.linalg.solve(lower, data)
    information = design.T @ design
    line = np.linalg.solve(information, design.T @ white)
    left = white - design @ line
    remainder = max(float(np.sum(left**2)), 1e-300)
    likelihood = -np.log(np.diag(lower)).sum() - 0.5 * np.linalg.slogdet(information)[1] - 0.5 * (len(at) - 2) * np.log(remainder)
    return _Fitted(lower, design, left, line, information, remainder, likelihood)


def _weights(fits: Sequence[_Fitted]) -> np.ndarray:
    """Return the weights of fits by their likelihoods."""
    likelihoods = np.array([fit.likelihood for fit in fits])
    weights = np.exp(likelihoods - likelihoods.max())
    return weights / weights.sum()


def _overlap(count: int) -> np.ndarray:
    """Return the correlation of the noise in half overlapping Hann windows, shape (count, count)."""
    return np.eye(count) + (1.0 / 6.0) * (np.eye(count, k=1) + np.eye(count, k=-1))
