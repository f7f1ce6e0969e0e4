# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The comb of lines that a damaged bearing makes in the envelope of its vibration, and the ratio of cage to shaft speed that fits it best.

With the outer ring at rest, Z rollers, shaft speed w_i and cage speed w_c = c w_i, a spot on the outer raceway is passed Z c times in a turn of
the shaft, a spot on the inner one Z (1 - c) times; the latter turns through the load zone, which gives its lines sidebands one order apart.  A spot
on a roller meets a raceway 2 b times (b: turns of the roller about its axis as seen from the cage), with sidebands c apart, and
whatever is special about one roller or one pocket shows at multiples of c itself.  See Harris and Kotzalas, Rolling Bearing Analysis, 5th ed.,
vol. 1, chapter 10; here c is free, since it is what is asked for.

For lines of unknown amplitude and phase in normal noise the likelihood ratio is the sum of the periodogram over the noise at the lines; of
averaged periodograms it is the sum of the logarithms of their probabilities.  A sideband counts for no more than its centre, so that no
sideband is taken for one.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import scipy.fft
import scipy.special

from bearing_sim.watchers.vibration.phase import half_overlapping

_HARMONICS = 3
_AVERAGES = (1, 4, 16, 64, 256)
_QUICK_AVERAGES = (1, 4, 16)
_OVERLAPPED = 0.947  # independent periodograms in one of half overlapping Hann windows (Welch, IEEE Trans. AU-15, 1967)
_FLOOR_WIDTH = 1.0  # orders over which the noise is a median
_MOST_CANDIDATES = 400_000
_CLEAR = 7.0  # [nat] of a line by itself, a probability of 1e-3 in noise
_LARGEST = 600.0  # [nat] of averages; beyond it the incomplete gamma function underflows
_EXCLUDED = 3.0  # half width of what is left out at whole orders, in bins
_EXPLAINED = 1.0  # half width of what a train of something else explains at its multiples, in widths of a line
_APART = 5.0  # widths of a line between the lines of such a train, at least, so that others are seen between them
_LOWEST_TRAIN = 0.2  # order of the slowest train of something else that is looked for
_LIKE_THE_HIGHER = 0.2  # of the surprise of a line that each lower one of a train of impacts has at least
_TRAIN = 5.0  # [nat] of each of them, at least
_HARMONICS_OF_TRAINS = (1, 2, 3, 4)


class Family(NamedTuple):
    """One kind of comb.

    Attributes
    ----------
    name : of what shows: ``outer_ring``, ``inner_ring``, ``roller`` or ``cage``.
    centres : orders of the centre lines as (constant, factor of c, factor of 2 b).
    sidebands : distances of the sidebands likewise.
    """

    name: str
    centres: tuple[tuple[float, float, float], ...]
    sidebands: tuple[tuple[float, float, float], ...]

    @property
    def lines(self) -> np.ndarray:
        """All lines, each centre before its sidebands: columns constant, factor of c, factor of 2 b, shape (l, 3)."""
        beside = [sign * np.array(side) for side in self.sidebands for sign in (-1.0, 1.0)]
        return np.array([np.array(centre) + shift for centre in self.centres for shift in (np.zeros(3), *beside)])

    def orders(self, ratio: np.ndarray | float, passes: np.ndarray | float = 0.0) -> np.ndarray:
        """Return the orders of all lines at c and 2 b, shape (l, *shape of these)."""
        constant, by_c, by_b = self.lines.T.reshape(3, -1, *[1] * np.ndim(ratio))
        return constant + by_c * ratio + by_b * passes


def families(rollers: int) -> tuple[Family, ...]:
    """Return the combs of a bearing of this many rollers; harmonics count from the first."""
    z, shaft, cage = float(rollers), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    harmonics = range(1, _HARMONICS + 1)
    return (
        Family("outer_ring", tuple((0.0, k * z, 0.0) for k in harmonics), (shaft,)),
        Family("inner_ring", tuple((k * z, -k * z, 0.0) for k in harmonics), (shaft, (2.0, 0.0, 0.0))),
        Family("roller", tuple((0.0, 0.0, float(k)) for k in harmonics[:2]), (cage, (0.0, 2.0, 0.0))),
        Family("cage", tuple((0.0, float(k), 0.0) for k in (1, 2, 3, 4)), ()),
    )


class Spectra(NamedTuple):
    """An averaged periodogram in orders, as logarithms of probabilities.

    Attributes
    ----------
    surprise : -ln of the probability that noise is as high, shape (n,).
    step : distance of its values in orders.
    resolution : width of a line in orders.
    density : noise |amplitude|^2 per order, shape (n,).
    averages : number of independent periodograms.
    """

    surprise: np.ndarray
    step: float
    resolution: float
    density: np.ndarray
    averages: float

    def at(self, orders: np.ndarray) -> np.ndarray:
        """Return the surprise at orders; zero outside of the spectrum."""
        places = np.rint(np.abs(orders) / self.step).astype(np.int64)
        inside = places < len(self.surprise)
        return np.where(inside, self.surprise[np.where(inside, places, 0)], 0.0)

    def noise_at(self, orders: np.ndarray) -> np.ndarray:
        """Return the density of the noise at orders."""
        return self.density[np.minimum(np.rint(np.abs(orders) / self.step).astype(np.int64), len(self.density) - 1)]

    def without(self, fundamentals: Sequence[float]) -> "Spectra":
        """Return this without the lines at all multiples of some orders, where they are far enough apart to leave others between them."""
        surprise = self.surprise
        for order in fundamentals:
            if order > _APART * self.resolution:
                places = np.arange(len(surprise)) * (self.step / order)
                surprise = np.where(np.abs(places - np.rint(places)) * order < _EXPLAINED * self.resolution, 0.0, surprise)
        return self._replace(surprise=surprise)


def spectra(signal: np.ndarray, per_turn: float, averages: int, highest: float, excludes_shaft: bool = True) -> Spectra | None:
    """Return the averaged periodogram of a signal sampled at equal steps of the shaft's angle; None if its resolution is too coarse.

    Parameters
    ----------
    signal : shape (n,).
    per_turn : samples in a turn.
    averages : parts that are averaged, with half overlap.
    highest : order up to which it is wanted.
    excludes_shaft : leave out the shaft's own lines at whole orders, and everything below half the lowest cage order.
    """
    begins, length = half_overlapping(len(signal), averages)
    turns = length / per_turn
    resolution = 2.0 / turns  # of a Hann window, half of its main lobe
    if resolution * _EXCLUDED > 0.3 or length < 64:
        return None
    window = np.hanning(length)
    window /= window.sum()
    count = scipy.fft.next_fast_len(2 * length, real=True)
    step = per_turn / count
    kept = int(highest / step) + 1
    power = np.zeros(min(kept, count // 2 + 1))
    for begin in begins:
        part = signal[begin : begin + length]
        power += np.abs(scipy.fft.rfft((part - part.mean()) * window, count)[: len(power)]) ** 2
    power /= averages
    independent = 1.0 if averages == 1 else max(1.0, _OVERLAPPED * averages)
    floor = _floor(power, max(16, int(_FLOOR_WIDTH / step)), independent)
    surprise = _surprise(power / floor, independent)
    orders = np.arange(len(power)) * step
    if excludes_shaft:
        surprise[np.abs(orders - np.rint(orders)) < _EXCLUDED / turns] = 0.0
    surprise[orders < max(0.1, _EXCLUDED / turns)] = 0.0
    return Spectra(surprise, step, resolution, floor * turns / 1.5, independent)


def _floor(power: np.ndarray, width: int, independent: float) -> np.ndarray:
    """Return the mean of the noise around each bin, from medians over a width of bins."""
    to_mean = independent / scipy.special.gammaincinv(independent, 0.5)
    count = max(1, 2 * len(power) // width)
    edges = np.linspace(0, len(power), count + 1).astype(int)
    low, high = edges[:-1], np.minimum(edges[:-1] + width, len(power))
    width = min(width, len(power))
    windows = np.lib.stride_tricks.sliding_window_view(power, width)
    medians = np.median(windows[np.minimum(low, len(power) - width)], axis=1)
    return np.maximum(np.interp(np.arange(len(power)), (low + high) / 2.0, medians), 1e-300) * to_mean


def _surprise(relative: np.ndarray, independent: float) -> np.ndarray:
    """Return -ln of the probability that the mean of independent exponential variables of mean 1 is as large."""
    if independent == 1.0:
        return relative
    probability = scipy.special.gammaincc(independent, independent * relative)
    with np.errstate(divide="ignore"):
        exact = -np.log(probability)
    x = independent * relative
    far = x - (independent - 1.0) * np.log(np.maximum(x, 1e-300)) + scipy.special.gammaln(independent)  # leading term of the tail
    return np.minimum(np.where(probability > 1e-280, exact, far), _LARGEST)


class Fit(NamedTuple):
    """The comb that fits best.

    Attributes
    ----------
    family : its kind.
    ratio : cage over shaft speed c.
    passes : meetings of a spot on a roller with the raceways in a turn of the shaft, 2 b; 0 for other families.
    false_alarm : -ln of the probability that noise has a comb as clear anywhere in the range that was searched.
    clear_lines : orders of the lines that are clear by themselves.
    score : the likelihood ratio [nat].
    averages : periodograms of the spectrum in which it was found.
    resolution : of the ratio in it.
    """

    family: Family
    ratio: float
    passes: float
    false_alarm: float
    clear_lines: tuple[float, ...]
    score: float
    averages: int
    resolution: float

    @property
    def orders(self) -> np.ndarray:
        """Orders of its lines, as of `Family.lines`."""
        return self.family.orders(self.ratio, self.passes)

    @property
    def first(self) -> float:
        """Order of its first centre line."""
        return float(self.orders[0])

    def is_clear(self, order: float) -> bool:
        """Whether its line at an order is clear by itself."""
        return any(abs(each - order) < 1e-6 for each in self.clear_lines)


class Range(NamedTuple):
    """The range that is searched.

    Attributes
    ----------
    low, high : of the ratio c.
    rollers : number of them.
    passes_low, passes_high : of 2 b, at any c.
    """

    low: float
    high: float
    rollers: int
    passes_low: float
    passes_high: float


class Prepared(NamedTuple):
    """The averaged periodograms of one signal, in which combs are searched.

    Attributes
    ----------
    spectra : (number of averages, periodogram), of those whose resolution is fine enough.
    range : what is searched.
    """

    spectra: Sequence[tuple[int, Spectra]]
    range: Range

    def without(self, fundamentals: Sequence[float]) -> "Prepared":
        """Return this without the lines at all multiples of some orders."""
        return self._replace(spectra=[(count, each.without(fundamentals)) for count, each in self.spectra]) if fundamentals else self

    @property
    def finest(self) -> Spectra:
        """The periodogram of the whole record."""
        return self.spectra[0][1]

    def of(self, fit: "Fit") -> Spectra:
        """Return the periodogram in which a comb was found."""
        return next(each for count, each in self.spectra if count == fit.averages)


def prepared(signal: np.ndarray, per_turn: float, range_: Range, averages: Sequence[int] = _AVERAGES) -> Prepared:
    """Return the periodograms of a signal in which `search` looks.

    Parameters
    ----------
    signal : envelope at equal steps of the shaft's angle.
    per_turn : samples in a turn.
    range_ : what is searched.
    averages : numbers of parts that are averaged.
    """
    highest = min(per_turn / 2.0, _HARMONICS * range_.rollers * (1.0 - range_.low) + 3.0)
    return Prepared([(count, found) for count in averages if (found := spectra(signal, per_turn, count, highest)) is not None], range_)


def search(where: Prepared, looks: int = 1) -> list[Fit]:
    """Return the best fit of each family in a signal, the least probable in noise first.

    Parameters
    ----------
    where : the signal's periodograms.
    looks : how many such signals of one record are searched, which counts in the probability of a false alarm.
    """
    every = families(where.range.rollers)
    fits = (_search_spectra(family, where, looks * len(every)) for family in every)
    return sorted((fit for fit in fits if fit is not None), key=lambda fit: -fit.false_alarm)


def promise(signal: np.ndarray, per_turn: float, range_: Range) -> float:
    """Return how clear the best comb of a raceway or of the cage is in a signal [nat], from few spectra: a quick look before `search`."""
    where = prepared(signal, per_turn, range_, _QUICK_AVERAGES)
    fits = [_search_spectra(family, where, 1) for family in families(range_.rollers) if family.name != "roller"]
    return max((fit.false_alarm for fit in fits if fit is not None), default=-math.inf)


def free_train(where: Prepared, looks: int = 1) -> Fit | None:
    """Return the clearest comb of a train of impacts of any frequency, whatever makes it; its ``ratio`` is the order of its first line."""
    family = Family("train", tuple((0.0, float(k), 0.0) for k in _HARMONICS_OF_TRAINS), ())
    range_ = where.range._replace(low=_LOWEST_TRAIN, high=float(where.range.rollers))
    return _search_spectra(family, where._replace(range=range_), looks)


def train_below(fit: Fit, found: Spectra) -> float | None:
    """Return the order of the train of impacts whose harmonics the lines of a fit are; None if they are the first ones of their own.

    The lower lines of such a train are at least about as high as a higher one is.  All of them must be clear, and two at least: beside lines of other
    machines some are by chance.  Lines at those of the shaft are no evidence, nor are sidebands.

    Parameters
    ----------
    fit : of a family of the bearing.
    found : a periodogram of the signal in which it was found.
    """
    first, own = fit.first, fit.orders
    least = max(_TRAIN, _LIKE_THE_HIGHER * min(float(found.at(np.array([first]))[0]), _LARGEST))
    for parts in range(int(first / max(_LOWEST_TRAIN, 2.0 * found.resolution)), 1, -1):
        numbers = np.arange(1, 2 * parts + 2)
        orders = numbers * (first / parts)
        is_seen = (numbers % parts != 0) & (np.abs(orders - np.rint(orders)) > _EXCLUDED * 0.5 * found.resolution)
        is_seen &= np.min(np.abs(orders[:, None] - own), axis=1) > found.resolution
        seen = orders[is_seen][: max(2, int(is_seen[: parts - 1].sum()))]
        if len(seen) >= 2 and np.all(found.at(seen) >= least):
            return first / parts
    return None


def _search_spectra(family: Family, where: Prepared, trials: int) -> Fit | None:
    """Return the best fit of one family in all spectra of a signal, with the trials in its probability of a false alarm."""
    counted = [each for each in where.spectra if family.name != "roller" or each[0] >= 4]
    fits = [fit for count, found in counted if (fit := _search_family(family, found, count, where.range)) is not None]
    if not fits:
        return None
    best = max(fits, key=lambda fit: fit.false_alarm)
    return best._replace(false_alarm=best.false_alarm - math.log(trials * len(where.spectra)))


def _search_family(family: Family, found: Spectra, count: int, range_: Range) -> Fit | None:
    """Return the best fit of one family in one spectrum."""
    steepest = float(np.abs(family.lines[:, 1]).max()) or 1.0
    candidates = int((range_.high - range_.low) * steepest / (0.5 * found.resolution)) + 2
    if family.name == "roller":
        passes_count = int((range_.passes_high - range_.passes_low) * len(family.centres) / (0.5 * found.resolution)) + 2
        if candidates * passes_count > _MOST_CANDIDATES:
            return None
        ratios, passes = (
            grid.ravel()
            for grid in np.meshgrid(
                np.linspace(range_.low, range_.high, candidates), np.linspace(range_.passes_low, range_.passes_high, passes_count)
            )
        )
    else:
        ratios = np.linspace(range_.low, range_.high, min(candidates, _MOST_CANDIDATES))
        passes = np.zeros(1)
    surprises = found.at(family.orders(ratios, passes))
    scores, best = _scores(surprises, len(family.centres)), None
    for used, score in scores:
        at = int(np.argmax(score))
        chance = -float(_log_gamma_tail(used, score[at])) - math.log(len(ratios)) - math.log(len(scores))
        if best is None or chance > best[0]:
            best = chance, at, float(score[at])
    chance, at, score = best
    ratio, spin = float(ratios[at]), float(passes[at if len(passes) > 1 else 0])
    clear = tuple(family.orders(ratio, spin)[surprises[:, at] >= _CLEAR].tolist())
    return Fit(family, ratio, spin, chance, clear, score, count, found.resolution / steepest)


def _scores(surprises: np.ndarray, centres: int) -> list[tuple[int, np.ndarray]]:
    """Return (number of lines, likelihood ratio of each candidate) of nested parts of a comb.

    The parts are the first one, two, ... centres, without and with sidebands; more lines are only surprising together.

    Parameters
    ----------
    surprises : of each line and candidate, shape (l, n).
    centres : number of centre lines.
    """
    by_centre = surprises.reshape(centres, -1, surprises.shape[1])
    per_centre = by_centre.shape[1]
    without = np.cumsum(by_centre[:, 0], axis=0)
    limited = np.minimum(by_centre, by_centre[:, :1]).reshape(surprises.shape)  # a sideband counts for no more than its centre
    with_sidebands = np.cumsum(limited, axis=0)[per_centre - 1 :: per_centre]
    scores = []
    for number, parts in enumerate(zip(without, with_sidebands), 1):
        scores.append((number, parts[0]))
        if per_centre > 1:
            scores.append((number * per_centre, parts[1]))
    return scores


def _log_gamma_tail(count: int, total: float) -> float:
    """Return ln of the probability that the sum of independent exponential variables of mean 1 is as large: a finite sum."""
    numbers = np.arange(count)
    terms = numbers * math.log(max(total, 1e-300)) - scipy.special.gammaln(numbers + 1.0)
    largest = float(terms.max())
    return largest + math.log(float(np.exp(terms - largest).sum())) - total
