# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The angle of the shaft over a record: from its own lines in the vibration, or from a speed that was recorded beside it.

The speed is searched as a path through segments of some turns, by the likelihood of the lines at 1 to 5 times the speed (dynamic programming,
after Viterbi), or as constant, whichever is likelier; the phase of the lines is then followed along the path, at last with the lines at up to 20
times the speed, which tell the angle better the higher they are.
"""

import math
from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np
import scipy.fft
import scipy.interpolate
import scipy.ndimage

from bearing_sim.watchers.vibration.comb import Spectra, spectra
from bearing_sim.watchers.vibration.phase import follow, mean_rate, smoothed, vertex

_HARMONICS = np.arange(1.0, 6.0)
HIGHEST = 6.0
"""Orders that the signals of `find_shaft` need for the shaft's lines."""
HIGHEST_OF_MANY = 22.0
"""Orders that the signal needs by which `find_shaft` sharpens a shaft."""
_MANY_HARMONICS = np.arange(1.0, 21.0)  # by which it does
_SEGMENT_TURNS = 24.0
_MOST_SEGMENTS = 128
_PER_TURN = 16  # samples in a turn, for the shaft's own lines
_PER_TURN_OF_MANY = 56
_FEWEST_OF_MANY = 4  # lines that must deviate in one proportion to sharpen a shaft
_CLEAR = 25.0  # [nat] of all lines above what searching costs; ten of noise have 10, and more than this in one of 10,000 records
_MOST_OF_A_LINE = 60.0  # [nat] that one line counts for being clear
_COUNTED = (4.0, 16.0)  # [nat] from which on a line counts, which noise exceeds in 2 %, and to which: one loud line is not several clear ones
_COST_OF_A_PATH = 16.0  # [nat] by which a varying speed must fit better than a constant one: more than another machine's line gives it
_LIMITS = (1.2, 6.0, 6.0)  # of what a line of a segment counts in each signal; low in the vibration, where those of other machines are loud
_CLEARER = 1.5  # times as clear as a constant speed a varying one must be that counts where the constant one is ambiguous
_AMBIGUOUS = 0.55  # of what the clearest speed counts
_ANOTHER_ROTOR = 33.0  # [nat] that three clear lines count, wherever the clearest are
_LESS_CLEAR = 0.9  # of its lines' surprise that a followed phase must leave, where another machine's line was near
_MOST_FOLLOWED = (64, 16, 8)  # segments in which a phase is followed
_SKIRT_WIDTH = 0.03  # orders about a line, within which what is lower by this factor is taken for its skirt
_SKIRT = 1e-3
_NEAR = 5  # steps of a spectrum around a line
_LOUD = 200.0  # [nat] of a line beyond which it does not count for that
_CLEAR_LINE = 10.0  # [nat] of a line that is followed
_UNREFINED = 0.3  # standard error of a frequency that is the middle of a line, in the lines' distance 1/T
_INSTANTS = 257  # at which the angle of a shaft is kept
_STEEPEST = 0.08  # relative change of speed between segments


class Shaft(NamedTuple):
    """The turning of the shaft over a record.

    Attributes
    ----------
    times : instants [s] from the beginning of the record, shape (n,).
    turns : since then, at these instants, shape (n,).
    frequency : mean [Hz].
    standard_error : of the mean [Hz].
    source : ``lines`` (of the shaft in the vibration), ``recorded`` or ``given``.
    angle_error : standard error of the angle at an instant beside that of the mean speed [turn], which counts in parts of a record.
    """

    times: np.ndarray
    turns: np.ndarray
    frequency: float
    standard_error: float
    source: str
    angle_error: float = 0.0

    def resampled(self, signal: np.ndarray, rate: float, per_turn: float) -> np.ndarray:
        """Return a signal at equal steps of the shaft's angle.

        Parameters
        ----------
        signal : at equal steps of time from the beginning of the record.
        rate : of its samples [Hz].
        per_turn : samples in a turn of the result.
        """
        turns = self.turns[-1] - self.turns[0]
        wanted = self.turns[0] + np.arange(int(turns * per_turn)) / per_turn
        times = scipy.interpolate.PchipInterpolator(self.turns, self.times)(wanted)
        places = np.clip(times * rate, 0.0, len(signal) - 1.0)
        return scipy.interpolate.make_interp_spline(np.arange(len(signal)), signal, k=3)(places)


def constant_shaft(frequency: float, standard_error: float, duration: float, source: str = "given") -> Shaft:
    """Return a shaft that turns at one frequency [Hz] for a duration [s]."""
    times = np.linspace(0.0, duration, _INSTANTS)
    return Shaft(times, frequency * times, frequency, standard_error, source)


def recorded_shaft(speed: np.ndarray, rate: float, relative_error: float) -> Shaft:
    """Return the shaft of a recorded speed [rad/s], one value a sample.

    Parameters
    ----------
    speed : shape (n,); its sign is ignored.
    rate : of the samples [Hz].
    relative_error : standard error of the speed, relative.
    """
    frequency = np.abs(speed) / (2.0 * math.pi)
    times = np.arange(len(speed)) / rate
    turns = np.concatenate(([0.0], np.cumsum(0.5 * (frequency[1:] + frequency[:-1])) / rate))
    kept = np.unique(np.linspace(0, len(speed) - 1, min(len(speed), 4096)).astype(int))
    times, turns = times[kept], turns[kept]
    moving = np.concatenate(([True], np.diff(turns) > 0.0))
    mean = float(turns[-1] / times[-1])
    return Shaft(times[moving], turns[moving], mean, relative_error * mean, "recorded")


def find_shaft(signals: list[tuple[np.ndarray, float]], about: Shaft, tolerance: float, wide: tuple[np.ndarray, float] | None = None) -> Shaft | None:
    """Return the shaft by its own lines; None if they are not clear, or if the lines of something else are nearly as clear.

    Parameters
    ----------
    signals : with the shaft's lines, and their rates [Hz]: the low-passed vibration first, then envelopes.
    about : the shaft as it is known beforehand, constant or recorded.
    tolerance : within which its speed is known, relative.
    wide : the vibration low-passed at `HIGHEST_OF_MANY`, and its rate [Hz]; its higher lines sharpen a shaft that is found.
    """
    turns = float(about.turns[-1])
    per_turn = _PER_TURN * (1.0 + tolerance)
    by_angle = [(about.resampled(signal, rate, per_turn), per_turn) for signal, rate in signals]
    low, high = 1.0 - tolerance, 1.0 + tolerance
    steady, is_ambiguous = _steady(by_angle, turns, low, high)
    candidates = []
    for shaft, cost in ((steady, 0.0), (_path(by_angle, turns, low, high), _COST_OF_A_PATH)):
        if shaft is not None:
            shaft = _refined(by_angle, shaft)
            surprise = _surprise_of_lines(by_angle, shaft)
            clear = float(np.minimum(surprise, _MOST_OF_A_LINE).sum())
            if abs(shaft.frequency - 1.0) < tolerance + 0.5 / turns:
                candidates.append((float(_counted(surprise).sum()) - cost, float(np.minimum(surprise, _LOUD).sum()), clear, shaft))
    if not candidates:
        return None
    chosen = candidates[0]
    for other in candidates[1:]:
        if other[0] > chosen[0] and other[1] > chosen[1]:
            chosen = other
    score, _, clear, shaft = chosen
    surprise = _surprise_of_lines(by_angle, shaft)
    if surprise[0][0] < _CLEAR_LINE and (surprise.max(axis=0) >= _CLEAR_LINE).sum() < 2:
        return None  # one line alone, and not that of an unbalance, may be that of any train of impacts near one of its harmonics
    if clear < _CLEAR + math.log(max(turns * 2.0 * tolerance * 8.0, 1.0)):
        return None
    if is_ambiguous and score < _CLEARER * float(_counted(_surprise_of_lines(by_angle, steady)).sum()):
        return None
    clearest = _clearest(by_angle, shaft)
    spread = _UNREFINED / turns if clearest is None else _disagreement(clearest[0], _PER_TURN, clearest[1])
    if wide is not None:
        by_angle_wide, per_turn_wide = about.resampled(*wide, _PER_TURN_OF_MANY * high), _PER_TURN_OF_MANY * high
        sharpened, orders = _sharpened(by_angle_wide, per_turn_wide, wide[1] / (2.0 * about.frequency), shaft)
        is_clear = _clearness(by_angle, sharpened) >= _LESS_CLEAR * _clearness(by_angle, shaft)
        apart = abs(sharpened.frequency - shaft.frequency) > 3.0 * math.hypot(sharpened.standard_error, shaft.standard_error)
        if len(orders) and is_clear and not apart:
            shaft = sharpened
            spread = _disagreement(shaft.resampled(by_angle_wide, per_turn_wide, _PER_TURN_OF_MANY), _PER_TURN_OF_MANY, orders)
    shaft = shaft._replace(standard_error=math.hypot(shaft.standard_error, spread * shaft.frequency))
    duration = float(about.times[-1])
    times = np.union1d(about.times, np.linspace(0.0, duration, 1024))
    own = scipy.interpolate.PchipInterpolator(shaft.times, shaft.turns)(np.interp(times, about.times, about.turns))
    mean = float(own[-1] / duration)
    return Shaft(times, own, mean, mean * shaft.standard_error / shaft.frequency, "lines", shaft.angle_error)


class _Lines(NamedTuple):
    """Spectra of segments of one signal: what each bin counts, (segment, bin), and the distance of bins [Hz]."""

    counted: np.ndarray
    step: float

    def comb(self, frequencies: np.ndarray) -> np.ndarray:
        """Return the sum over the shaft's harmonics at frequencies, shape (segment, frequency)."""
        total = np.zeros((len(self.counted), len(frequencies)))
        for harmonic in _HARMONICS:
            places = np.rint(harmonic * frequencies / self.step).astype(int)
            inside = places < self.counted.shape[1]
            total[:, inside] += self.counted[:, places[inside]]
        return total


def _lines(
    signal: np.ndarray, rate: float, begins: np.ndarray, seconds: float, counted: Callable[[np.ndarray], np.ndarray], skirts: float = 0.0
) -> _Lines:
    """Return the lines of segments of a signal; beside a loud one, within ``skirts`` [Hz], none counts that is lower by `_SKIRT`."""
    length = int(seconds * rate)
    window = np.hanning(length)
    count = scipy.fft.next_fast_len(4 * length, real=True)
    rows = []
    for begin in (begins * rate).astype(int):
        part = signal[max(0, min(begin, len(signal) - length)) :][:length]
        power = np.abs(scipy.fft.rfft((part - part.mean()) * window, count)) ** 2
        floors = np.array([np.median(each) for each in np.array_split(power, max(1, len(power) // 256))])
        floor = np.interp(np.arange(len(power)), (np.arange(len(floors)) + 0.5) * len(power) / len(floors), floors) / math.log(2.0)
        relative = power / np.maximum(floor, 1e-300)
        beside = scipy.ndimage.maximum_filter1d(relative, 2 * int(skirts * count / rate) + 1)
        rows.append(np.where(relative < _SKIRT * beside, 0.0, relative))
    return _Lines(counted(np.array(rows)), rate / count)


def _counted_in_segment(surprise: np.ndarray, limit: float) -> np.ndarray:
    """Return what a line of a segment counts: the logarithm of its power, so that its middle counts most, and little above a limit."""
    logarithm = np.log1p(surprise)
    return np.minimum(logarithm, limit) + 0.05 * np.maximum(logarithm - limit, 0.0)


def _counted(surprise: np.ndarray) -> np.ndarray:
    """Return what a line of the whole record counts."""
    low, high = _COUNTED
    return np.clip(surprise - low, 0.0, high - low)


def _clearness(signals, shaft: Shaft) -> float:
    """Return how much of the lines is where a shaft has them."""
    return float(np.minimum(_surprise_of_lines(signals, shaft), _LOUD).sum())


def _surprise_of_lines(signals, shaft: Shaft) -> np.ndarray:
    """Return -ln of the probability that noise is as high as each of the shaft's lines over the whole record, (signal, line)."""
    found = np.zeros((len(signals), len(_HARMONICS)))
    for row, (signal, rate) in zip(found, signals):
        whole = spectra(shaft.resampled(signal, rate, _PER_TURN), _PER_TURN, 1, HIGHEST, excludes_shaft=False)
        if whole is not None:
            row[:] = whole.at(_HARMONICS)
    return found


def _steady(signals, duration: float, low: float, high: float) -> tuple[Shaft, bool]:
    """Return a shaft of constant speed, and whether another speed is nearly as clear."""
    frequencies = np.linspace(low, high, int((high - low) * 10.0 * duration) + 2)
    skirts = _SKIRT_WIDTH if len(signals) == 1 else 0.0  # an envelope has no lines as loud as those of the vibration
    score = sum(_lines(signal, rate, np.zeros(1), duration, _counted, skirts).comb(frequencies)[0] for signal, rate in signals)
    loudness = sum(_lines(signal, rate, np.zeros(1), duration, np.log1p).comb(frequencies)[0] for signal, rate in signals)
    at = int(np.argmax(score + 1e-3 * loudness))  # the middle of lines that count in full beside it, too
    elsewhere = score[np.abs(frequencies - frequencies[at]) > 4.0 / duration]
    is_ambiguous = bool(len(elsewhere)) and elsewhere.max() > min(_AMBIGUOUS * score[at], _ANOTHER_ROTOR)
    return constant_shaft(float(frequencies[at]), 0.0, duration, "lines"), is_ambiguous


def _path(signals, duration: float, low: float, high: float) -> Shaft | None:
    """Return a shaft of varying speed."""
    turns = duration * low
    segments = int(min(_MOST_SEGMENTS, 2.0 * turns / _SEGMENT_TURNS))
    if segments < 6:
        return None
    seconds = 2.0 * duration / (segments + 1)
    begins = np.linspace(0.0, duration - seconds, segments)
    frequencies = np.arange(low, high, 0.25 / seconds)
    if len(frequencies) < 2:
        return None
    limited = [partial(_counted_in_segment, limit=limit) for limit in _LIMITS]
    score = sum(_lines(signal, rate, begins, seconds, counted).comb(frequencies) for (signal, rate), counted in zip(signals, limited))
    reach = max(1, min(len(frequencies) - 1, int(_STEEPEST * high / (0.25 / seconds))))
    steps = np.arange(-reach, reach + 1)
    cost = 2.0 * (steps / reach) ** 2
    total, came = score[0], []
    for row in score[1:]:
        padded = np.pad(total, reach, constant_values=-math.inf)
        windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1) - cost
        best = np.argmax(windows, axis=1)
        came.append(best - reach)
        total = windows[np.arange(len(best)), best] + row
    at = [int(np.argmax(total))]
    for moves in reversed(came):
        at.append(at[-1] + int(moves[at[-1]]))
    path = frequencies[at[::-1]]
    middles = begins + 0.5 * seconds
    knots = np.concatenate(([0.0], middles, [duration]))
    smooth = scipy.interpolate.make_smoothing_spline(middles, path)
    speeds = np.clip(smooth(knots), low, high)
    times = np.linspace(0.0, duration, 8 * segments)
    course = scipy.interpolate.PchipInterpolator(knots, speeds)
    turned = course.antiderivative()(times)
    return Shaft(times, turned, float(turned[-1] / duration), 0.0, "lines")


def _refined(signals, shaft: Shaft) -> Shaft:
    """Return the shaft with the phase of its lines followed as long as that leaves them clear; in longer segments where it does not in short ones."""
    shaft = shaft._replace(standard_error=_UNREFINED / shaft.turns[-1] * shaft.frequency)
    before = _clearness(signals, shaft)
    for most in _MOST_FOLLOWED:
        followed = 0
        while followed < 2:
            clearest = _clearest(signals, shaft)
            changed = None if clearest is None else _followed(shaft, clearest[0], _PER_TURN, *clearest[1:], most)
            if changed is None or (after := _clearness(signals, changed)) < (1.0 if followed else _LESS_CLEAR) * before:
                break
            shaft, before, followed = changed, after, followed + 1
        if followed:
            break
    return shaft


def _sharpened(signal: np.ndarray, per_turn: float, highest: float, shaft: Shaft) -> tuple[Shaft, np.ndarray]:
    """Return the shaft with the phase of its lines up to high orders followed in one signal, and these orders; none where too few are clear.

    Parameters
    ----------
    signal : by the angle as it was known beforehand.
    per_turn : samples in a turn of it.
    highest : order up to which it has lines.
    shaft : by the same angle.
    """
    orders = _MANY_HARMONICS[_MANY_HARMONICS < highest - 1.0]
    sharpened, used = shaft._replace(angle_error=0.0), orders[:0]
    for _ in range(2):
        resampled = sharpened.resampled(signal, per_turn, _PER_TURN_OF_MANY)
        near, kept, noise = _clear_lines(resampled, _PER_TURN_OF_MANY, HIGHEST_OF_MANY, orders)
        if len(kept) < _FEWEST_OF_MANY:
            break
        changed = _followed(sharpened, resampled, _PER_TURN_OF_MANY, kept, noise)
        if changed is None:
            break
        error = max(changed.angle_error, sharpened.angle_error)  # a phase that has been followed once deviates less than it errs
        of_ends = math.sqrt(2.0) * error / changed.turns[-1] * changed.frequency
        sharpened, used = changed._replace(angle_error=error, standard_error=max(changed.standard_error, of_ends)), kept
    return sharpened if len(used) else shaft, used


def _disagreement(signal: np.ndarray, per_turn: float, orders: np.ndarray) -> float:
    """Return the relative standard error of a mean speed by leaving out each line in turn (jackknife), since one may be another machine's.

    Parameters
    ----------
    signal : by the shaft's angle.
    per_turn : samples in a turn of it.
    orders : of its lines.
    """
    if len(orders) < 2:
        return _UNREFINED * per_turn / len(signal)
    found = spectra(signal, per_turn, 1, orders[-1] + 1.0, excludes_shaft=False)
    around = np.log(np.maximum(found.at(orders[:, None] + np.arange(-_NEAR, _NEAR + 1) * found.step), 1e-300))  # (order, shift)
    best = np.clip(np.argmax(around, axis=1), 1, 2 * _NEAR - 1)
    before, peak, after = (around[np.arange(len(orders)), best + shift] for shift in (-1, 0, 1))
    rates = (best - _NEAR + np.clip(vertex(before, peak, after), -1.0, 1.0)) * found.step / orders
    weights = np.exp(peak) * orders**2
    left_out = (weights @ rates - weights * rates) / (weights.sum() - weights)
    return math.sqrt((len(rates) - 1) * float(np.var(left_out)))


def _clearest(signals, shaft: Shaft) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Return the signal in which the shaft's lines are clearest, by its angle, the orders of these lines and the noise around them."""
    found = []
    for signal, rate in signals:
        resampled = shaft.resampled(signal, rate, _PER_TURN)
        near, orders, noise = _clear_lines(resampled, _PER_TURN, HIGHEST, _HARMONICS)
        if len(orders):
            found.append((near.sum(), resampled, orders, noise))
    return max(found, key=lambda each: each[0])[1:] if found else None


def _clear_lines(signal: np.ndarray, per_turn: float, highest: float, orders: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return how clear each of the lines is that are clear and agree, their orders, and the noise around them; empty if there is none."""
    found = spectra(signal, per_turn, 1, highest, excludes_shaft=False)
    if found is None:
        return (orders[:0],) * 3
    near, kept = _agreeing(found, orders)
    # No line counts for more than several others, since it may be another machine's.
    return near[kept], orders[kept], found.noise_at(orders[kept]) * np.maximum(1.0, near[kept] / _MOST_OF_A_LINE)


def _followed(shaft: Shaft, signal: np.ndarray, per_turn: float, orders: np.ndarray, noise: np.ndarray, most: int = 64) -> Shaft | None:
    """Return the shaft with the common phase of its lines followed in a signal by its angle; None if it would turn back somewhere.

    The record is cut into ``most`` segments at most.
    """
    segments = int(np.clip(shaft.turns[-1] / 8.0, 6, most))
    while True:
        track = follow(signal, per_turn, orders, orders, noise, segments)
        if track.score > 5.0 + len(orders) or segments <= 8:
            break
        segments = max(8, segments // 2)
    rate, smooth = mean_rate(track), smoothed(track)
    course = scipy.interpolate.PchipInterpolator(track.places, smooth.phases)
    corrected = shaft.turns + course(np.clip(shaft.turns, track.places[0], track.places[-1]))
    outside = np.where(shaft.turns < track.places[0], shaft.turns - track.places[0], np.maximum(shaft.turns - track.places[-1], 0.0))
    corrected += outside * rate.value
    if np.any(np.diff(corrected) <= 0.0):
        return None
    corrected -= corrected[0]
    mean = float(corrected[-1] / shaft.times[-1])
    of_ends = math.sqrt(2.0) * smooth.error / shaft.turns[-1]
    return shaft._replace(turns=corrected, frequency=mean, standard_error=max(float(rate.standard_error), of_ends) * mean, angle_error=smooth.error)


def _agreeing(found: Spectra, orders: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return how clear each line is near its order, and which of the clear ones deviate from theirs in the same proportion.

    Lines of other machines close to a harmonic deviate by another one; of two sets the larger counts, then the one with lower harmonics.
    """
    shifts = np.arange(-_NEAR, _NEAR + 1) * found.step
    around = found.at(orders[:, None] + shifts)  # (order, shift)
    best = np.argmax(around, axis=1)
    near = around[np.arange(len(orders)), best]
    deviations, tolerances = shifts[best] / orders, 0.4 * found.resolution / orders
    agree = np.abs(deviations[:, None] - deviations) < np.hypot(tolerances[:, None], tolerances)
    agree &= (near > _CLEAR_LINE) & (near > _CLEAR_LINE)[:, None]
    return near, agree[np.argmax(agree @ (1.0 + 0.1 / orders))]
