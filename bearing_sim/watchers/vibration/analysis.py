# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""The cage speed out of a vibration record: band, shaft, comb, ratio of cage to shaft with its standard error; or that there is no line.

The limit of the method is part of its answer.  The lines of both raceways add up to Z times the shaft's, whatever the slip, and slip is the
difference of the ratio found from the one that the geometry has without slip: a roller of another size of the same designation moves that by 3 %,
0.03 mm of clearance by 0.04 %.  Without measured diameters slip below 3 % is therefore not claimed; the ratio of cage to shaft is.

Lines are a claim only if nothing else is known that makes them: no slower train whose harmonics they are, no exactly periodic train of a gear, of
the mains or of another machine, no other part of the bearing.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from bearing_sim.scene.display import number
from bearing_sim.watchers.vibration.comb import (
    Fit,
    Prepared,
    Range,
    Spectra,
    free_train,
    prepared,
    promise,
    search,
    spectra,
    train_below,
)
from bearing_sim.watchers.vibration.order_tracking import HIGHEST, HIGHEST_OF_MANY, Shaft, constant_shaft, find_shaft, recorded_shaft
from bearing_sim.watchers.vibration.phase import Rate, Track, follow, mean_rate, smoothed
from bearing_sim.watchers.vibration.regularity import UNKNOWN, Regularity, regularity
from bearing_sim.watchers.vibration.signal import Band, Spectrum, Vibration, VibrationError, candidate_bands, narrow_bands, repetition

CERTAIN = math.log(1e4)
"""[nat] by which noise must be excluded: a false alarm in 10,000 records."""
LARGEST_SLIP = 0.1
"""Slip of the cage up to which lines are looked for where nothing says what is possible (assumption: a loaded bearing has less)."""

PARTS = {"outer_ring": "the outer ring", "inner_ring": "the inner ring", "roller": "a roller", "cage": "the cage"}
"""What may show, in words."""

_ANOTHER_SIZE = 0.03  # by which a roller of another size of the same designation moves the ratio
_NEGATIVE_SLIP = 0.002  # beside that, by clearance and contact angles
_CLEAR_OF_ROLLER = 30.0  # [nat] of a raceway's line from which on the sidebands of a roller's would be seen beside it
_SIDEBAND = 0.2  # of its height, that they have at least: the load zone gives 0.5 to 0.7
_LOUDEST = 500.0  # [nat]
_SIZES = (0.12, 0.3)  # roller diameter over pitch diameter where the geometry is unknown (assumption, wider than the catalogue's 0.12 to 0.25)
_SPIN_TOLERANCE = 0.06
_PER_TURN_OVER_ORDER = 2.6
_FEWEST_TURNS = 20.0
_QUARTERS = 4
_NARROW = 2  # bands of the width of a resonance, the most promising ones, that are searched for all combs
_ENDS = 0.05  # fraction of the record that fades in, and out
_MOST_TRAINS = 6  # of something else, whose lines are left out one after another
_AS_LIKELY = 10.0  # [nat] within which another part is not excluded
_FOREIGN_PRIOR = 0.1  # that a machine nearby has a train of irregular impacts, such as another bearing (assumption: 0.02 to 0.5)
_TRAIN_ORDERS = (0.2, 20.0)  # of such trains, equally likely at any logarithm (assumption)
_MAINS = (50.0, 60.0)  # [Hz]
_SEEN = 0.001  # scatter of impacts over their period from which on it is said to be there, though not for certain
_FEWEST_LINES = {"outer_ring": 2, "inner_ring": 2, "roller": 2, "cage": 3}  # that must be clear: near the cage's other machines have lines, too


class Geometry(NamedTuple):
    """What of a bearing determines its lines.

    Attributes
    ----------
    rollers : number of them.
    size : roller diameter over pitch diameter; NaN if unknown.
    is_measured : whether the diameters were measured on this bearing.
    name : for messages.
    largest_slip : of the cage that is possible at the load and the speed of the record; no larger one is looked for.
    """

    rollers: int
    size: float = math.nan
    is_measured: bool = False
    name: str = ""
    largest_slip: float = LARGEST_SLIP

    @property
    def ideal_ratio(self) -> float:
        """Cage over shaft speed without slip, (1 - D_w/d_m)/2; NaN if the size is unknown."""
        return (1.0 - self.size) / 2.0

    @property
    def range(self) -> Range:
        """What is searched for lines of this bearing."""
        is_known = math.isfinite(self.size)
        small, large = (self.size, self.size) if is_known else _SIZES
        play = _NEGATIVE_SLIP + (0.0 if self.is_measured or not is_known else _ANOTHER_SIZE)
        low, high = 0.5 * (1.0 - large) * (1.0 - self.largest_slip - play), 0.5 * (1.0 - small) * (1.0 + play)
        passes = [(1.0 - size**2) / size for size in (large, small)]
        high = min(high, 0.4999)
        return Range(min(low, high), high, self.rollers, (1.0 - 2.0 * _SPIN_TOLERANCE) * passes[0], (1.0 + _SPIN_TOLERANCE) * passes[1])


class Part(NamedTuple):
    """The cage in a part of a record.

    Attributes
    ----------
    begin, end : of the part [s] from the beginning of the record.
    shaft_speed : mean [rad/s].
    ratio : cage over shaft speed; NaN where no line can be followed in it.
    ratio_error : standard error of the ratio, with that of the shaft's angle at the ends of the part, and without that of its mean speed.
    cage_speed, cage_speed_error : [rad/s].
    """

    begin: float
    end: float
    shaft_speed: float
    ratio: float
    ratio_error: float
    cage_speed: float
    cage_speed_error: float


class Analysis(NamedTuple):
    """What a vibration record shows of its bearing.

    Attributes
    ----------
    shaft : frequency, its standard error and where it comes from.
    reason : in words, why there is no line, or why slip is not claimed.
    found : whether there are lines where this bearing may have them; if not, everything about the cage is NaN.
    is_claim : whether they are the bearing's: nothing else is known that makes them.
    alternatives : what they cannot be told apart from, in words; none of a claim.
    shows : what shows: ``outer_ring``, ``inner_ring``, ``roller``, ``cage``; empty if there is no line.
    false_alarm : upper bound of the probability that noise alone looks like this.
    doubt : upper bound of the probability that it is anything else: noise, an exact train, another part, or an irregular train of another machine
        that is in the range of this bearing by chance; 1 where something cannot be told apart.
    jitter : standard deviation of the instants of impacts over their period; NaN where it cannot be told.
    line, line_error : frequency of the fundamental line over the shaft's, and its standard error.
    ratio, ratio_error : cage over shaft speed, and its standard error.
    cage_speed, cage_speed_error : [rad/s].
    passes : meetings of a spot on a roller with the raceways in a turn; NaN for others.
    slip, slip_error : of the cage against the geometry; NaN where the geometry is unknown.
    claims_slip : whether the lines are claimed, the shaft's speed is measured, and the slip is more than what an unknown geometry can feign.
    parts : the same by quarters of the record.
    band : in which the lines are.
    lines : orders of the lines that are clear by themselves.
    """

    shaft: Shaft
    reason: str
    found: bool = False
    is_claim: bool = False
    alternatives: Sequence[str] = ()
    shows: str = ""
    false_alarm: float = 1.0
    doubt: float = 1.0
    jitter: float = math.nan
    line: float = math.nan
    line_error: float = math.nan
    ratio: float = math.nan
    ratio_error: float = math.nan
    cage_speed: float = math.nan
    cage_speed_error: float = math.nan
    passes: float = math.nan
    slip: float = math.nan
    slip_error: float = math.nan
    claims_slip: bool = False
    parts: Sequence[Part] = ()
    band: Band | None = None
    lines: Sequence[float] = ()


def analyse(
    vibration: Vibration,
    geometry: Geometry,
    shaft_speed: float | None = None,
    tolerance: float = 0.02,
    band: Band | None = None,
    follows_lines: bool = True,
    parts: int = _QUARTERS,
) -> Analysis:
    """Return what a vibration record shows of a bearing.

    Parameters
    ----------
    vibration : the record; a shaft speed in it is used instead of ``shaft_speed``.
    geometry : of the bearing.
    shaft_speed : about [rad/s]; None where the record has it.
    tolerance : within which the speed is known, relative: the shaft's own lines are searched there, and it is the error where there are none.
    band : in which the envelope is taken; None if it is to be chosen.
    follows_lines : whether the shaft's own lines are used; if not, the speed is taken as it is given.
    parts : into how many the record is cut for the course of the ratio.

    Raises
    ------
    VibrationError
        The record is too short or sampled too slowly for this bearing, or nothing says about how fast the shaft turns.
    """
    low, high = _speed_range(vibration, shaft_speed, tolerance)
    period = repetition(vibration.samples, vibration.rate, 1.0 / low)
    if period is not None:
        about = _about(vibration, low, high, tolerance)
        why = (
            f"the record repeats itself every {period:.6g} s, as no measured one does, which makes lines at all multiples of {1.0 / period:.6g} Hz;"
            " expected one continuous measurement: analyse that, or one period of it"
        )
        return _nothing(about, None, why)
    raw = Spectrum(vibration.samples, vibration.rate)
    faded = Spectrum(vibration.samples, vibration.rate, _ENDS)
    whitened = faded.without_lines()
    range_ = geometry.range
    inner = range_.rollers * (1.0 - range_.low)  # order of the highest fundamental line
    if 2.5 * high * range_.rollers * 0.5 > vibration.rate / 2.0:
        raise VibrationError(
            f"{vibration.name}: {vibration.rate:g} Hz is too slow for {range_.rollers} rollers at {high:.4g} turns per second; expected at least"
            f" {2.5 * high * range_.rollers:.4g} Hz"
        )
    if vibration.duration * low < _FEWEST_TURNS:
        raise VibrationError(
            f"{vibration.name}: {vibration.duration * low:.3g} turns of the shaft in {vibration.duration:.4g} s; expected at least {_FEWEST_TURNS:g}"
        )
    narrowest = min(2.2 * high * inner, raw.highest)
    bands = [band] if band is not None else candidate_bands(whitened, narrowest)
    envelopes = [whitened.envelope(each) for each in bands]
    shaft = _shaft_of(vibration, raw, envelopes, low, high, tolerance, follows_lines)
    range_ = _widened(range_, shaft)
    per_turn = _PER_TURN_OVER_ORDER * (3.0 * inner + 3.0)
    by_angle = [(each, *_by_angle(shaft, *envelope, per_turn)) for each, envelope in zip(bands, envelopes)]
    looks = len(bands)
    if band is None:
        others = [each for each in narrow_bands(whitened, narrowest) if each not in bands]
        looks += len(others)
        tried = [(each, *_by_angle(shaft, *whitened.envelope(each), per_turn)) for each in others]
        by_angle += sorted(tried, key=lambda each: -promise(*each[1:], range_))[:_NARROW]
    places = [_Place(each, signal, per_turn_here, prepared(signal, per_turn_here, range_)) for each, signal, per_turn_here in by_angle]
    trains: list[float] = []
    while True:
        best = _best(places, looks, trains)
        why = _of_a_train(trains[0], shaft) if trains else ""
        if best is None or best.fit.false_alarm < CERTAIN:
            return _nothing(shaft, best.fit if best else None, why or _foreign_train(places, looks, shaft))
        fit, place = best.fit, best.place
        rate = _rate_of(fit, place.signal, place.per_turn)
        fit_there = fit._replace(ratio=fit.ratio + (rate.value if rate else 0.0))
        train = train_below(fit, place.prepared.of(fit)) or train_below(fit_there, place.prepared.finest)
        if train is None or len(trains) == _MOST_TRAINS:
            break
        trains.append(train)
    if train is not None:
        return _nothing(shaft, fit, why)
    if fit.family.name in ("outer_ring", "inner_ring") and not fit.is_clear(fit.first):  # it is clear unless something else makes the others
        return _nothing(shaft, fit, why or "lines at a harmonic only, without the first one: they may be those of anything else")
    if rate is None or abs(rate.value) > 3.0 * fit.resolution or _is_hidden(fit, range_, len(place.signal) / place.per_turn):
        return _nothing(shaft, fit, why)
    beyond = max(range_.low - fit_there.ratio, fit_there.ratio - range_.high)
    if beyond > 3.0 * _ratio_error(fit_there, rate, shaft):
        return _nothing(shaft, fit, why or _of_a_train(fit_there.first, shaft))
    impacts = _regularity_of(fit_there, place, faded, vibration.duration, shaft)
    if impacts.is_sparse:
        return _nothing(shaft, fit, why or "few periods of the lines hold an impact: they are those of something slower")
    alternatives = _alternatives(fit, best.fits, impacts, place, shaft, range_)
    if trains and alternatives:
        return _nothing(shaft, fit, f"{why}; what is left beside it {_not_told_apart(alternatives)}")
    course = tuple(_course(fit_there, shaft, place.signal, place.per_turn, parts))
    doubt = _doubt(fit, best.fits, impacts, range_) if not alternatives else 1.0
    return _completed(fit_there, rate, shaft, geometry, place.band, course, impacts, alternatives, doubt)


class _Place(NamedTuple):
    """A band with its envelope by the shaft's angle, and the periodograms of it."""

    band: Band
    signal: np.ndarray
    per_turn: float
    prepared: Prepared


class _Candidate(NamedTuple):
    """The clearest comb of all bands, the place in which it is, and the best combs of other parts there."""

    fit: Fit
    place: _Place
    fits: Sequence[Fit]


def _widened(range_: Range, shaft: Shaft) -> Range:
    """Return a range with the error of the shaft's speed in it, by which all orders are wrong."""
    relative = 2.0 * shaft.standard_error / shaft.frequency
    return range_._replace(low=range_.low * (1.0 - relative), high=min(range_.high * (1.0 + relative), 0.4999))


def _best(places: Sequence[_Place], looks: int, trains: Sequence[float]) -> _Candidate | None:
    """Return the clearest comb beside trains of something else."""
    best: _Candidate | None = None
    for place in places:
        fits = [fit for fit in search(place.prepared.without(trains), looks) if len(fit.clear_lines) >= _FEWEST_LINES[fit.family.name]]
        fits = [fit for fit in fits if not (fit.family.name == "roller" and _is_multiple(fit))]
        if not fits:
            continue
        first = fits[0]
        if first.family.name == "cage":  # a damaged roller has these lines, too, once in a turn of the cage
            rollers = [fit for fit in fits if fit.family.name == "roller" and fit.false_alarm >= CERTAIN]
            first = next((fit for fit in rollers if abs(fit.ratio - first.ratio) < 2.0 * fit.resolution), first)
        if best is None or first.false_alarm > best.fit.false_alarm:
            best = _Candidate(first, place, fits)
    return best


def _is_multiple(fit: Fit) -> bool:
    """Return whether the lines of a roller are at multiples of the cage's: those of any train that is as slow as the cage are, too."""
    parts = fit.passes / fit.ratio
    return abs(parts - round(parts)) * fit.ratio < 2.0 * fit.resolution


def _of_a_train(order: float, shaft: Shaft) -> str:
    return (
        f"a train of impacts at {order:.5g} times the shaft's frequency, {order * shaft.frequency:.5g} Hz, and its harmonics, with no relation to"
        " this bearing"
    )


def _foreign_train(places: Sequence[_Place], looks: int, shaft: Shaft) -> str:
    """Return what the clearest train of impacts is that is not the bearing's, in words; empty if none is clear."""
    fits = [fit for place in places if (fit := free_train(place.prepared, looks)) is not None and len(fit.clear_lines) >= 2]
    best = max(fits, key=lambda fit: fit.false_alarm, default=None)
    return "" if best is None or best.false_alarm < CERTAIN else _of_a_train(best.ratio, shaft)


def _regularity_of(fit: Fit, place: _Place, faded: Spectrum, duration: float, shaft: Shaft) -> Regularity:
    """Return how exactly periodic the impacts of a comb are.

    Parameters
    ----------
    fit : with the ratio as it was measured.
    place : where it was found.
    faded : spectrum of the record, which fades in and out.
    duration : of the record [s].
    shaft : by whose angle the signal of ``place`` is.
    """
    line = fit.first
    numbers = np.arange(1.0, 1.0 + len(fit.family.centres))
    orders = numbers * line
    inside = (orders < 0.48 * place.per_turn) & (np.abs(orders - np.rint(orders)) > 6.0 * place.per_turn / len(place.signal))
    if not inside.any():
        return UNKNOWN
    clear = inside & (place.prepared.of(fit).at(orders) > 3.0)
    inside = clear if clear.any() else inside
    turns = len(place.signal) / place.per_turn
    segments = int(np.clip(max(turns / 8.0, 2.0 * fit.averages), 8, 64))
    track: Track = follow(place.signal, place.per_turn, orders[inside], numbers[inside], place.prepared.finest.noise_at(orders[inside]), segments)
    course = np.interp(angles := np.linspace(0.0, turns, 64 * segments), track.places, smoothed(track).phases)
    phases = line * angles + course
    if np.any(np.diff(phases) <= 0.0):
        return UNKNOWN
    places = np.interp(np.arange(math.ceil(phases[0]), math.floor(phases[-1])), phases, angles)
    hertz = line * shaft.frequency
    return regularity(faded.without_lines(hertz, 4.0 / duration), place.band, shaft, places, hertz, fit.family.name != "outer_ring")


def _alternatives(fit: Fit, fits: Sequence[Fit], impacts: Regularity, place: _Place, shaft: Shaft, range_: Range) -> tuple[str, ...]:
    """Return what else has the lines of a fit, in words."""
    found, line = [], fit.first
    hertz = line * shaft.frequency
    resolution = place.prepared.of(fit).resolution
    if not impacts.is_irregular:
        mains = next(
            (each for each in _MAINS if abs(hertz / each - round(hertz / each)) * each < max(resolution * shaft.frequency, 0.002 * hertz)), None
        )
        source = f", such as the mains of {mains:g} Hz" if mains and hertz > 0.9 * mains else ""
        how = "noise hides whether its impacts are exactly periodic"
        if math.isfinite(impacts.jitter):
            is_small = impacts.jitter < _SEEN
            how = "its impacts are exactly periodic, as far as is seen" if is_small else "something else may feign that its impacts scatter"
        found.append(f"a train of impacts of another machine or of a gear at {hertz:.6g} Hz{source}: {how}")
    others = [each for each in fits if each.family.name != fit.family.name and each.false_alarm > max(fit.false_alarm - _AS_LIKELY, CERTAIN)]
    found += [f"the lines of {PARTS[each.family.name]}" for each in others]
    if fit.family.name == "cage" and not any(each.family.name == "roller" for each in others):
        found.append("a roller that differs, once in a turn of the cage")
    if fit.family.name == "roller" and not _is_modulated_by_cage(fit):
        found.append("a train of impacts of another machine: the cage does not modulate it as it does those of a roller")
    if _may_be_a_roller(fit, place.prepared.of(fit), range_) and not any(each.family.name == "roller" for each in others):
        found.append("the lines of a roller")
    return tuple(found)


def _not_told_apart(alternatives: Sequence[str]) -> str:
    return f"cannot be told apart from {'; or from '.join(alternatives)}"


def _is_modulated_by_cage(fit: Fit) -> bool:
    """Return whether the first line of a roller has clear sidebands on both sides: it passes through the load zone once in a turn of the cage."""
    return all(fit.is_clear(fit.passes + side * fit.ratio) for side in (-1.0, 1.0))


def _doubt(fit: Fit, fits: Sequence[Fit], impacts: Regularity, range_: Range) -> float:
    """Return an upper bound of the probability that something else made the lines of a fit."""
    noise = math.exp(-min(fit.false_alarm, 700.0))
    parts = sum(math.exp(max(each.false_alarm - fit.false_alarm, -700.0)) for each in fits if each.family.name != fit.family.name)
    low, high = fit.family.orders(np.array([range_.low, range_.high]), np.array([range_.passes_low, range_.passes_high]))[0]
    share = abs(math.log(high / low)) / math.log(_TRAIN_ORDERS[1] / _TRAIN_ORDERS[0])
    return min(1.0, noise + parts + impacts.chance + _FOREIGN_PRIOR * share)


def _by_angle(shaft: Shaft, envelope: np.ndarray, rate: float, per_turn: float) -> tuple[np.ndarray, float]:
    """Return an envelope at equal steps of the shaft's angle, and how many samples a turn has."""
    per_turn = min(per_turn, rate / shaft.frequency)
    return shaft.resampled(envelope - envelope.mean(), rate, per_turn), per_turn


def _speed_range(vibration: Vibration, shaft_speed: float | None, tolerance: float) -> tuple[float, float]:
    """Return between which frequencies [Hz] the shaft turns."""
    if vibration.shaft_speed is not None:
        speeds = np.abs(vibration.shaft_speed) / (2.0 * math.pi)
        low, high = float(speeds.min()), float(speeds.max())
        if not low > 0.0:
            raise VibrationError(f"{vibration.name}: the shaft stands still in the record; expected a part of it in which it turns")
        return low * (1.0 - tolerance), high * (1.0 + tolerance)
    if shaft_speed is None:
        raise VibrationError(
            f"{vibration.name}: about how fast does the shaft turn? the lines of a bearing look like those of a faster shaft; give the speed with"
            " --speed, such as --speed 1500rpm, or a recorded one with --speed-channel"
        )
    frequency = abs(shaft_speed) / (2.0 * math.pi)
    if not 0.0 < frequency < math.inf:
        raise VibrationError(f"a shaft speed of {shaft_speed:g} rad/s; expected one at which the shaft turns")
    return frequency * (1.0 - tolerance), frequency * (1.0 + tolerance)


def _about(vibration: Vibration, low: float, high: float, tolerance: float) -> Shaft:
    """Return the shaft as recorded or given."""
    error = tolerance / math.sqrt(3.0)  # standard deviation of a uniform distribution
    if vibration.shaft_speed is not None:
        return recorded_shaft(vibration.shaft_speed, vibration.rate, error)
    return constant_shaft(0.5 * (low + high), error * 0.5 * (low + high), vibration.duration)


def _shaft_of(vibration, raw: Spectrum, envelopes, low: float, high: float, tolerance: float, follows_lines: bool) -> Shaft:
    """Return the shaft: by its own lines, or as recorded or given."""
    about = _about(vibration, low, high, tolerance)
    if follows_lines:
        spectra_of_two = (Spectrum(envelope, rate) for envelope, rate in envelopes[:2])
        signals = [each.low_passed(HIGHEST * high) for each in (raw, *spectra_of_two)]
        wide = raw.low_passed(HIGHEST_OF_MANY * high)
        found, by_vibration = (find_shaft(some, about, tolerance, wide) for some in (signals, signals[:1]))
        if found is None or by_vibration is None:
            return found or by_vibration or about
        # An envelope has the lines of every train of impacts, and those of a train may be nearer to the expected speed than the shaft's.
        apart = abs(found.frequency - by_vibration.frequency)
        if apart < max(3.0 * math.hypot(found.standard_error, by_vibration.standard_error), 1.0 / vibration.duration):
            return min(found, by_vibration, key=lambda each: each.standard_error)
    return about


def _rate_of(fit: Fit, signal: np.ndarray, per_turn: float) -> Rate | None:
    """Return by how much the ratio differs from that of a fit, with its standard error; None if the phase of the lines cannot be followed."""
    if fit.family.name == "roller":
        return _rate_of_roller(fit, signal, per_turn)
    orders, multipliers = fit.orders, fit.family.lines[:, 1]
    found = spectra(signal, per_turn, 1, per_turn / 2.0)
    inside = (orders > 0.2) & (orders < 0.48 * per_turn) & (np.abs(orders - np.rint(orders)) > 6.0 * per_turn / len(signal))
    averaged = spectra(signal, per_turn, fit.averages, per_turn / 2.0)
    if found is None or averaged is None:
        return None
    inside &= averaged.at(orders) > 3.0
    orders, multipliers = orders[inside], multipliers[inside]
    if not len(orders):
        return None
    noise = found.noise_at(orders)
    turns = len(signal) / per_turn
    segments = int(np.clip(max(turns / 8.0, 2.0 * fit.averages), 8, 256))
    while True:
        track = follow(signal, per_turn, orders, multipliers, noise, segments)
        if track.score > 5.0 + len(orders) or segments <= max(8, fit.averages):
            break
        segments = max(8, fit.averages, int(segments / 1.5))
    return mean_rate(track)


def _is_hidden(fit: Fit, range_: Range, turns: float) -> bool:
    """Return whether a comb of the inner ring may be the second harmonic of one of the outer ring whose first is under a line of the shaft."""
    if fit.family.name != "inner_ring":
        return False
    half = 0.5 * range_.rollers * (1.0 - fit.ratio)
    covered = abs(half - round(half)) < 4.5 / turns
    return covered and range_.low <= half / range_.rollers <= range_.high


def _may_be_a_roller(fit: Fit, found: Spectra, range_: Range) -> bool:
    """Return whether the first line of a raceway may be that of a roller, or a sideband of it.

    A roller passes through the load zone once in a turn of the cage, so that its line has sidebands there that are nearly as high; a raceway's has
    not.  It may also be at half the frequency, where a roller meets one raceway only.
    """
    line = fit.first
    if fit.family.name not in ("outer_ring", "inner_ring") or not any(
        part * range_.passes_low - range_.high <= line <= part * range_.passes_high + range_.high for part in (0.5, 1.0)
    ):
        return False
    ratios = np.arange(range_.low, range_.high + found.step, found.step)
    height = min(float(found.at(np.array([line]))[0]), _LOUDEST)
    beside = max(float(found.at(line + ratios).max()), float(found.at(line - ratios).max()))
    return height < _CLEAR_OF_ROLLER or beside > _SIDEBAND * height


def _rate_of_roller(fit: Fit, signal: np.ndarray, per_turn: float) -> Rate | None:
    """Return the same for a roller, whose lines have no common phase because it turns as it likes: from the likelihood around the fit."""
    found = spectra(signal, per_turn, fit.averages, per_turn / 2.0)
    if found is None:
        return None
    reach = 2.0 * found.resolution
    ratios, passes = (each.ravel() for each in np.meshgrid(*(np.linspace(at - reach, at + reach, 161) for at in (fit.ratio, fit.passes))))
    likelihood = found.at(fit.family.orders(ratios, passes)).sum(axis=0)
    weights = np.exp(likelihood - likelihood.max())
    mean = float(weights @ ratios / weights.sum())
    spread = math.sqrt(float(weights @ (ratios - mean) ** 2 / weights.sum()))
    return Rate(mean - fit.ratio, math.hypot(spread, 0.25 * found.resolution / math.sqrt(fit.averages)))


def _course(fit: Fit, shaft: Shaft, signal: np.ndarray, per_turn: float, parts: int) -> Iterator[Part]:
    """Yield the cage in parts of a record."""
    duration = float(shaft.times[-1])
    ends = np.linspace(0.0, duration, parts + 1)
    turns = np.interp(ends, shaft.times, shaft.turns)
    within = fit._replace(averages=max(1, fit.averages // parts))
    for begin, end, first, last in zip(ends, ends[1:], turns, turns[1:]):
        part = signal[int((first - turns[0]) * per_turn) : int((last - turns[0]) * per_turn)]
        speed = 2.0 * math.pi * (last - first) / (end - begin)
        rate = _rate_of(within, part, per_turn) if last - first >= _FEWEST_TURNS else None
        if rate is None or abs(rate.value) > 3.0 * max(fit.resolution, 1.0 / (last - first)):
            rate = Rate(math.nan, math.nan)
        ratio = fit.ratio + rate.value
        of_angle = math.sqrt(2.0) * shaft.angle_error / (last - first)
        by_angle = math.hypot(rate.standard_error, abs(_of_shaft(fit) - ratio) * of_angle)
        by_time = math.hypot(rate.standard_error, _of_shaft(fit) * math.hypot(of_angle, shaft.standard_error / shaft.frequency))
        yield Part(float(begin), float(end), float(speed), ratio, by_angle, ratio * speed, speed * by_time)


def _ratio_error(fit: Fit, rate: Rate, shaft: Shaft) -> float:
    """Return the standard error of a ratio with that of the shaft's speed in it.

    A line is measured in Hz: where the shaft's own frequency is not known well, its order and the ratio are not either.
    """
    by_c = fit.family.centres[0][1]
    by_shaft = fit.first / by_c if by_c else fit.ratio
    return math.hypot(rate.standard_error, by_shaft * shaft.standard_error / shaft.frequency)


def _of_shaft(fit: Fit) -> float:
    """Return how much the cage speed that follows from a line depends on the shaft's: an outer line gives it whatever the shaft does."""
    constant, by_c, _ = fit.family.centres[0]
    return constant / by_c if by_c else 1.0


def _completed(
    fit: Fit,
    rate: Rate,
    shaft: Shaft,
    geometry: Geometry,
    band: Band,
    course: Sequence[Part],
    impacts: Regularity,
    alternatives: Sequence[str],
    doubt: float,
) -> Analysis:
    """Return the result with the errors of the shaft in it; ``fit`` has the ratio as it was measured."""
    relative, by_c = shaft.standard_error / shaft.frequency, fit.family.centres[0][1]
    ratio_error, shaft_speed = _ratio_error(fit, rate, shaft), 2.0 * math.pi * shaft.frequency
    slip, slip_error = 1.0 - fit.ratio / geometry.ideal_ratio, ratio_error / geometry.ideal_ratio
    reason = _why_slip_is_not_claimed(slip, slip_error, geometry, shaft, alternatives)
    return Analysis(
        shaft,
        reason,
        found=True,
        is_claim=not alternatives,
        alternatives=alternatives,
        shows=fit.family.name,
        false_alarm=math.exp(-min(fit.false_alarm, 700.0)),
        doubt=doubt,
        jitter=impacts.jitter,
        line=fit.first,
        line_error=math.hypot(by_c * rate.standard_error, fit.first * relative) if by_c else math.nan,
        ratio=fit.ratio,
        ratio_error=ratio_error,
        cage_speed=fit.ratio * shaft_speed,
        cage_speed_error=shaft_speed * math.hypot(rate.standard_error, _of_shaft(fit) * relative),
        passes=fit.passes or math.nan,
        slip=slip,
        slip_error=slip_error,
        claims_slip=not reason,
        parts=course,
        band=band,
        lines=fit.clear_lines,
    )


def _why_slip_is_not_claimed(slip: float, slip_error: float, geometry: Geometry, shaft: Shaft, alternatives: Sequence[str]) -> str:
    """Return in words why slip is not claimed; empty if it is."""
    if alternatives:
        return f"no claim: the lines {_not_told_apart(alternatives)}"
    if math.isnan(slip):
        return "slip is not claimed: the diameters are unknown"
    if shaft.source == "given":
        return "slip is not claimed: no line of the shaft and no recorded speed says how fast the shaft turned; record it, and use --speed-channel"
    if slip < -3.0 * slip_error - _NEGATIVE_SLIP:
        above = f"the ratio is {-100.0 * slip:.2f} % above that without slip by the drawing, which no cage reaches"
        return f"slip is not claimed: {above}; measure the diameters"
    if not geometry.is_measured and slip <= _ANOTHER_SIZE + 2.0 * slip_error:
        return (
            f"slip is not claimed: {100.0 * slip:.2f} % against the drawing is no more than what a roller of another size of the same designation"
            " does (3 %); measure the diameters"
        )
    return ""


def rarity(chance: float) -> str:
    """Return one over a probability in words: a figure beyond what any plant records says nothing more."""
    return number(1.0 / chance, 2) if chance > 1e-6 else "more than a million"


def _nothing(shaft: Shaft, fit: Fit | None, doubt: str = "") -> Analysis:
    """Return the result for a record without lines of the bearing; ``fit`` is the clearest comb, if any has enough lines, ``doubt`` why not that."""
    chance = 1.0 if fit is None else math.exp(-max(0.0, min(fit.false_alarm, 700.0)))
    if doubt:
        why = doubt
    elif fit is None:
        why = "no comb has enough lines that are clear by themselves"
    elif fit.false_alarm < CERTAIN:
        often = f"in one of {rarity(chance)} records" if chance < 0.5 else "in most records"
        why = f"noise alone gives a comb as clear as the best {often}"
    else:
        why = "the lines do not keep together over the record, or may be the harmonics of a line that coincides with one of the shaft's"
    return Analysis(shaft, f"no line of this bearing: {why}", false_alarm=chance)
