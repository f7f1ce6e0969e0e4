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

    def lines(self) -> list[tuple[int, tuple[float, float, float]]]:
        """Return all lines: index of the centre, and order as (constant, factor of c, factor of 2 b); each centre before its sidebands."""
        found = []
        for index, centre in enumerate(self.centres):
            found.append((index, centre))
            found += [(index, tuple(a + sign * b for a, b in zip(centre, side))) for side in self.sidebands for sign in (-1.0, 1.0)]
        return found


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
    length = int(2 * len(signal) / (averages + 1))
    turns = length / per_turn
    resolution = 2.0 / turns  # of a Hann window, half of its main lobe
    if resolution * _EXCLUDED > 0.3 or length < 64:
        return None
    begins = (np.arange(averages) * (len(signal) - length) / max(averages - 1, 1)).astype(int)
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
    passes : meetings of a spot on a roller with the raceways in a turn of the shaft, 2 b; NaN for other families.
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
    fits = []
    for family in families(where.range.rollers):
        tried = [_search_family(family, found, count, where.range) for count, found in where.spectra if family.name != "roller" or count >= 4]
        tried = [fit for fit in tried if fit is not None]
        if tried:
            best = max(tried, key=lambda fit: fit.false_alarm)
            fits.append(best._replace(false_alarm=best.false_alarm - math.log(looks * len(families(2)) * len(where.spectra))))
    return sorted(fits, key=lambda fit: -fit.false_alarm)


def promise(signal: np.ndarray, per_turn: float, range_: Range) -> float:
    """Return how clear the best comb of a raceway or of the cage is in a signal [nat], from few spectra: a quick look before `search`."""
    where = prepared(signal, per_turn, range_, _QUICK_AVERAGES)
    quick = [family for family in families(range_.rollers) if family.name != "roller"]
    fits = [_search_family(family, found, count, range_) for family in quick for count, found in where.spectra]
    return max((fit.false_alarm for fit in fits if fit is not None), default=-math.inf)


def free_train(where: Prepared, looks: int = 1) -> Fit | None:
    """Return the clearest comb of a train of impacts of any frequency, whatever makes it; its ``ratio`` is the order of its first line."""
    family = Family("train", tuple((0.0, float(k), 0.0) for k in _HARMONICS_OF_TRAINS), ())
    range_ = where.range._replace(low=_LOWEST_TRAIN, high=float(where.range.rollers))
    fits = [fit for count, found in where.spectra if (fit := _search_family(family, found, count, range_)) is not None]
    if not fits:
        return None
    best = max(fits, key=lambda fit: fit.false_alarm)
    return best._replace(false_alarm=best.false_alarm - math.log(looks * len(where.spectra)))


def train_below(fit: Fit, found: Spectra) -> float | None:
    """Return the order of the train of impacts whose harmonics the lines of a fit are; None if they are the first ones of their own.

    The lower lines of such a train are at least about as high as a higher one is.  All of them must be clear, and two at least: beside lines of other
    machines some are by chance.  Lines at those of the shaft are no evidence, nor are sidebands.

    Parameters
    ----------
    fit : of a family of the bearing.
    found : a periodogram of the signal in which it was found.
    """
    first = first_line(fit)
    own = orders_of(fit.family, fit.ratio, fit.passes)[0]
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


def first_line(fit: Fit) -> float:
    """Return the order of the first centre line of a fit."""
    return float(orders_of(fit.family, fit.ratio, fit.passes)[0][0])


def _search_family(family: Family, found: Spectra, count: int, range_: Range) -> Fit | None:
    """Return the best fit of one family in one spectrum."""
    lines = family.lines()
    steepest = max(abs(factor) for _, (_, factor, _) in lines) or 1.0
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
    scores, lines_at = _scores(family, found, ratios, passes)
    trials = math.log(len(ratios))
    best = None
    for used, score in scores:
        at = int(np.argmax(score))
        chance = -float(_log_gamma_tail(used, score[at])) - trials - math.log(len(scores))
        if best is None or chance > best[0]:
            best = chance, at, float(score[at])
    chance, at, score = best
    ratio, spin = float(ratios[at]), float(passes[at if len(passes) > 1 else 0])
    surprises = np.array([line[at] for line in lines_at])
    orders = np.array([constant + by_c * ratio + by_b * spin for _, (constant, by_c, by_b) in lines])
    clear = tuple(float(order) for order, each in zip(orders, surprises) if each >= _CLEAR)
    return Fit(family, ratio, spin if family.name == "roller" else math.nan, chance, clear, score, count, found.resolution / steepest)


def _scores(family: Family, found: Spectra, ratios: np.ndarray, passes: np.ndarray) -> tuple[list[tuple[int, np.ndarray]], list[np.ndarray]]:
    """Return (number of lines, likelihood ratio of each candidate) of nested parts of a comb, and the surprise of each line.

    The parts are the first one, two, ... centres, without and with sidebands; more lines are only surprising together.
    """
    lines = family.lines()
    surprises = [found.at(constant + by_c * ratios + by_b * passes) for _, (constant, by_c, by_b) in lines]
    without, with_sidebands = np.zeros(len(ratios)), np.zeros(len(ratios))
    scores, used, centre = [], 0, surprises[0]
    per_centre = 1 + 2 * len(family.sidebands)
    for number, each in enumerate(surprises):
        is_centre = number % per_centre == 0
        used += 1
        if is_centre:
            centre = each
            without = without + each
            with_sidebands = with_sidebands + each
        else:
            with_sidebands = with_sidebands + np.minimum(each, centre)
        if (number + 1) % per_centre == 0:
            index = number // per_centre + 1
            scores.append((index, without))
            if family.sidebands:
                scores.append((used, with_sidebands))
    return scores, surprises


def _log_gamma_tail(count: int, total: float) -> float:
    """Return ln of the probability that the sum of independent exponential variables of mean 1 is as large: a finite sum."""
    numbers = np.arange(count)
    terms = numbers * math.log(max(total, 1e-300)) - scipy.special.gammaln(numbers + 1.0)
    largest = float(terms.max())
    return largest + math.log(float(np.exp(terms - largest).sum())) - total


def orders_of(family: Family, ratio: float, passes: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the orders of a family's lines at a ratio, and by how much each moves with the ratio."""
    lines: Sequence[tuple[float, float, float]] = [line for _, line in family.lines()]
    spin = 0.0 if math.isnan(passes) else passes
    return (np.array([constant + by_c * ratio + by_b * spin for constant, by_c, by_b in lines]), np.array([by_c for _, by_c, _ in lines]))
