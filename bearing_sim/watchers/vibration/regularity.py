# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""How exactly periodic the impacts of a train are, from the phase of the carrier at each of them.

Rollers stand somewhere in their pockets and slip a little differently at every pass, so that the impacts of a bearing scatter by a fraction of a per
cent to some per cent of their period (Antoni and Randall, J. Vib. Acoust. 125, 2003, 282-289, take it as what makes them second-order
cyclostationary; a gear's are periodic).  The envelope hardly shows 0.2 %; the carrier does, because its period is far shorter.

An impact k that is late by d_k has the complex amplitude z_k = a_k exp(-i w d_k) at the carrier w, against the shape that all impacts have in
common.  Of neighbours, whatever their strengths a_k and the noise n_0 in |z_k|^2 are,

    |<(z_k* z_l)^2>| / <(|z_k|^2 - n_0)(|z_l|^2 - n_0)> = exp(-4 w^2 s^2)

where s is the standard deviation of instants that are normal and independent; noise that is circular adds to neither mean.  Where noise leaves this
too uncertain, |<z_k* z_l>| / <|z_k|^2 - n_0> is looked at, which strengths that vary make smaller, too.
"""

import math
from typing import NamedTuple

import numpy as np

from bearing_sim.watchers.vibration.order_tracking import Shaft
from bearing_sim.watchers.vibration.signal import Band, Spectrum

EXACT = 0.0003
"""Standard deviation of the instants of impacts over their period up to which a train is called exactly periodic (assumption: teeth are met within
some micrometres of their place, 1e-4 of the circumference; rollers have at least 0.2 % of their pitch)."""

# Where no source is named, the numbers below are assumptions, set on the records 0 to 1999 of test/benchmarks/vibration_claims.py.
_DRIFTS = np.linspace(-3.0, 3.0, 121)  # [sample] over the record, and
_PARTS_OF_SAMPLE = np.arange(12) / 12.0  # of a train whose instants may be at whole samples
_LAGS = 8  # neighbours that are compared
_OVERSAMPLED = 4
_WINDOW = 0.5  # of the period, around the highest of the impacts' mean power
_MOST_COLUMNS = 64
_MOST_IMPACTS = 20_000
_PHASES = 48  # of the period, at which the mean power is looked at
_BLOCKS = 8  # by which errors are estimated (jackknife)
_FEWEST = 32  # impacts
_SHARP = 0.2  # standard error of the first ratio up to which it is used
_OTHERWISE = 0.6  # of either ratio, below which other trains and the followed phase, which take a part of it, seldom bring an exact train
_ALONE = 0.25  # of the first ratio, below which it decides alone
_INCOHERENT, _MODULATED = 0.25, 0.06  # of the second ratio, below which strengths that vary do not explain it, at random and in a load zone
_ERRORS, _AGREED = 3.0, 1.0  # standard errors by which one ratio must be below, and the other as well
_MOST = 0.8  # of the periods; a spot in a rotating load zone is loaded in half of them
_LOUD, _QUIET = 1.5, 1.2  # power at the impacts over that between them, of the mean and of that quantile, of a train with few impacts
_CLEAR = 10.0  # power about the impacts over that between them, from which on noise hardly counts
_SPARSE = 6.0  # mean square of the impacts' powers over their squared mean: above it few of the windows hold one; a rotating load zone has 4.6


class Regularity(NamedTuple):
    """How exactly periodic a train is.

    Attributes
    ----------
    jitter : standard deviation of its instants over its period; NaN where it cannot be told.
    is_irregular : whether the instants scatter more than those of an exact train, for certain.
    chance : probability that an exact train looks as irregular.
    is_sparse : whether few of the periods hold an impact: the lines are those of something slower.
    """

    jitter: float
    is_irregular: bool
    chance: float
    is_sparse: bool = False


UNKNOWN = Regularity(math.nan, False, 1.0)


def regularity(spectrum: Spectrum, band: Band, shaft: Shaft, places: np.ndarray, line: float, is_modulated: bool) -> Regularity:
    """Return how exactly periodic a train is.

    Parameters
    ----------
    spectrum : of the record, with the lines of the train and without those of others.
    band : in which its impacts are.
    shaft : by which ``places`` are angles.
    places : at which the train has the same phase once a period [turn of the shaft], increasing, shape (n,).
    line : mean frequency of the train [Hz].
    is_modulated : whether its strengths vary by nature, as in a rotating load zone.
    """
    signal, rate = spectrum.in_band(band, _OVERSAMPLED)
    times = np.interp(places[:_MOST_IMPACTS], shaft.turns - shaft.turns[0], shaft.times)
    period, columns = 1.0 / line, int(_WINDOW / line * rate / _OVERSAMPLED)
    if len(times) < _FEWEST or columns < 3:
        return UNKNOWN
    begin = _begin(signal, rate, times, period)
    columns = min(columns, _MOST_COLUMNS)
    offsets = begin + np.arange(columns) * (_OVERSAMPLED / rate)
    apart = offsets + _WINDOW * period  # between the impacts, where everything else is that is not theirs
    times = times[(times + offsets[0] > 0.0) & (times + apart[-1] < (len(signal) - 2) / rate)]
    if len(times) < _FEWEST:
        return UNKNOWN
    rows, between = (_windows(signal, rate, band.low, times, each) for each in (offsets, apart))
    shapes = np.linalg.svd(rows, full_matrices=False)[2]
    amplitudes = rows @ shapes[0].conj()
    power, power_between = np.abs(amplitudes) ** 2, np.abs(between @ shapes[0].conj()) ** 2
    if np.mean(power) > _LOUD * np.mean(power_between) and np.quantile(power, _MOST) < _QUIET * np.quantile(power_between, _MOST):
        return UNKNOWN._replace(is_sparse=True)
    noise, stands_out = float(np.mean(power_between)), float(np.mean(np.abs(rows) ** 2) / np.mean(np.abs(between) ** 2))
    advance = np.angle(np.sum(shapes[0][:-1].conj() * shapes[0][1:])) * rate / _OVERSAMPLED
    frequency = 2.0 * math.pi * band.low + (advance if advance >= 0.0 else advance + 2.0 * math.pi * rate / _OVERSAMPLED)
    conditions = noise, frequency, period, stands_out > _CLEAR, is_modulated
    found = _judged(amplitudes, *conditions)
    if found.is_irregular:
        samples = float(times[-1] - times[0]) / (len(times) - 1) * spectrum.rate
        rounded = _judged(_as_of_whole_samples(amplitudes, frequency / spectrum.rate, samples), *conditions)
        found = found if rounded.is_irregular else rounded
    return found


def _as_of_whole_samples(amplitudes: np.ndarray, advance: float, period: float) -> np.ndarray:
    """Return amplitudes with the phases that they had without rounding, if they are those of a periodic train whose instants are at whole samples.

    Made-up records have such trains.

    Parameters
    ----------
    amplitudes : shape (n,).
    advance : of the carrier's phase in a sample.
    period : of the train [sample], so well known that it errs by a few samples over the record.
    """
    numbers, best = np.arange(len(amplitudes)), (-1.0, amplitudes)
    for drift in _DRIFTS:
        places = (period + drift / len(numbers)) * numbers
        for part in _PARTS_OF_SAMPLE:
            tried = amplitudes * np.exp(-1j * advance * ((places + part) % 1.0))
            height = abs(np.sum(tried[:-1].conj() * tried[1:]))
            if height > best[0]:
                best = height, tried
    return best[1]


def _windows(signal: np.ndarray, rate: float, low: float, times: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Return a band's signal about each of some times, shape (time, offset), with the phase of its carrier; ``low`` is the band's lower end [Hz]."""
    places = (times[:, None] + offsets) * rate
    before = places.astype(int)
    rows = signal[before] + (places - before) * (signal[before + 1] - signal[before])
    return rows * np.exp(2j * np.pi * low * times)[:, None]  # the envelope's frequencies count from the band's lower end


def _begin(signal: np.ndarray, rate: float, times: np.ndarray, period: float) -> float:
    """Return the time from a place of the train to the beginning of the window that holds most of an impact's power [s]."""
    phases = np.arange(_PHASES) * (period / _PHASES)
    at = ((times[:, None] + phases) * rate).astype(int)
    power = np.mean(np.abs(signal[np.minimum(at, len(signal) - 1)]) ** 2, axis=0)
    half = int(_WINDOW * _PHASES)
    held = np.convolve(np.concatenate((power, power[: half - 1])), np.ones(half), "valid")
    return float(phases[int(np.argmax(held))])


def _judged(amplitudes: np.ndarray, noise: float, frequency: float, period: float, is_clear: bool, is_modulated: bool) -> Regularity:
    """Return the regularity by the complex amplitudes of the impacts.

    Parameters
    ----------
    amplitudes : shape (n,).
    noise : in their squares.
    frequency : of the carrier [rad/s].
    period : of the train [s].
    is_clear : whether the impacts stand out of everything else by themselves, however few of them are strong.
    is_modulated : as of `regularity`.
    """
    power, floor = np.abs(amplitudes) ** 2, (EXACT * period) ** 2
    if np.mean(power) <= noise or not is_clear and np.mean(power**2) > _SPARSE * np.mean(power) ** 2:
        return UNKNOWN
    by_fourth, error_of_fourth = _jackknifed(amplitudes, noise, _fourth_order)
    by_second, error_of_second = _jackknifed(amplitudes, noise, _by_phase if is_clear else _second_order)
    strengths = _OTHERWISE if is_clear else _MODULATED if is_modulated else _INCOHERENT
    surprises = [(strengths * math.exp(-(frequency**2) * floor) - by_second) / error_of_second]
    jitter, alone = math.nan, -math.inf
    if error_of_fourth <= _SHARP:
        jitter = math.sqrt(-math.log(min(max(by_fourth, 1e-3), 1.0))) / (2.0 * frequency * period)
        exact = math.exp(-4.0 * frequency**2 * floor)
        surprises.append((_OTHERWISE * exact - by_fourth) / error_of_fourth)
        alone = (_ALONE * exact - by_fourth) / error_of_fourth
    elif is_clear:
        jitter = math.sqrt(-math.log(min(max(by_second, 1e-3), 1.0))) / (frequency * period)
    agreed = max(surprises) if min(surprises) > _AGREED else -math.inf
    return Regularity(jitter, max(agreed, alone) > _ERRORS, _tail(max(agreed, alone)))


def _tail(surprise: float) -> float:
    """Return the probability that a normal variable is as many standard deviations above its mean."""
    return 0.5 * math.erfc(surprise / math.sqrt(2.0))


def _fourth_order(z: np.ndarray, w: np.ndarray, noise: float) -> tuple[complex, float]:
    return np.sum((z.conj() * w) ** 2), float(np.sum((np.abs(z) ** 2 - noise) * (np.abs(w) ** 2 - noise)))


def _second_order(z: np.ndarray, w: np.ndarray, noise: float) -> tuple[complex, float]:
    return np.sum(z.conj() * w), float(np.sum(0.5 * (np.abs(z) ** 2 + np.abs(w) ** 2) - noise))


def _by_phase(z: np.ndarray, w: np.ndarray, noise: float) -> tuple[complex, float]:
    return np.sum(z.conj() * w), float(np.sum(np.abs(z) * np.abs(w)))


def _jackknifed(amplitudes: np.ndarray, noise: float, sums) -> tuple[float, float]:
    """Return a ratio of sums over neighbours, and its standard error by leaving out blocks of impacts in turn."""
    lags = min(_LAGS, len(amplitudes) // 4)
    blocks = np.array_split(np.arange(len(amplitudes) - lags), _BLOCKS)
    above, below = np.zeros((lags, _BLOCKS), complex), np.zeros((lags, _BLOCKS))
    for lag in range(1, lags + 1):
        for number, block in enumerate(blocks):
            above[lag - 1, number], below[lag - 1, number] = sums(amplitudes[block], amplitudes[block + lag], noise)

    def ratio(kept: np.ndarray) -> float:
        power = float(below[:, kept].sum())
        return float(np.abs(above[:, kept].sum(axis=1)).sum()) / power if power > 0.0 else math.nan

    left_out = np.array([ratio(np.arange(_BLOCKS) != number) for number in range(_BLOCKS)])
    found, error = ratio(np.ones(_BLOCKS, bool)), math.sqrt((_BLOCKS - 1) * float(np.var(left_out)))
    return (found, max(error, 1e-9)) if math.isfinite(found + error) else (1.0, math.inf)
