# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""A record of an accelerometer, and the signals that are made of it: without discrete lines, low-passed, the envelope of a band.

Every filter works on the spectrum of the whole record, so that none has a phase and each can change the sampling rate at once.
"""

import copy
import dataclasses
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.fft
import scipy.ndimage

from bearing_sim.files.tally import Tally

FEWEST_SAMPLES = 1024
_LEAST = 1e-100  # difference of samples, in any unit
_FLOOR_BLOCK = 256  # bins over which the floor of a spectrum is a median
_LINE = 4.0  # times the floor: noise exceeds it in 1.5e-5 of the bins (its magnitude has a Rayleigh distribution)
_SKIRT = 3  # bins on either side of a line that go with it
_NEARBY = 41  # bins around a line which it must exceed as well: what fills more than half of them is no discrete line
_FARTHEST = 200  # bins over which a loud line is cut where the record ends abruptly
_TAPER = 0.1  # fraction of a band's width over which its edges fall off
_OVERSAMPLED = 1.28  # rate of a signal over twice its highest frequency
_EVENED_ORDERS = 1.5  # times the frequency of the shaft over which the level is evened out where repetitions are looked for
_SHORTEST_LAG = 16  # samples
_REPEATED = 0.8  # correlation from which on a record repeats itself
_MULTIPLE = 0.8  # of the highest correlation, that the shortest period has and its multiples have
_LONGER_THAN_A_TURN = 1.05
_LARGEST_ENVELOPE = 20.0  # times its median: what is higher is a knock or a fault of the sensor, not a bearing


class VibrationError(ValueError):
    """A vibration record that cannot be used: the message says what is wrong, where, what was expected and what to do."""


class Band(NamedTuple):
    """A band of frequencies [Hz]."""

    low: float
    high: float

    @property
    def width(self) -> float:
        """Its width [Hz]."""
        return self.high - self.low


@dataclass(frozen=True)
class Vibration:
    """A record of an accelerometer.

    Attributes
    ----------
    samples : shape (n,), in any unit: no result depends on it.
    rate : of the samples [Hz].
    name : of the file and the channel, for messages.
    shaft_speed : shape (n,) [rad/s] at every sample, where a speed was recorded beside the vibration; None where not.
    tally : what of a recording was read; None of other files, which are read whole or not at all.

    Raises
    ------
    VibrationError
        The record is too short, has gaps or no finite rate, or does not vibrate.
    """

    samples: np.ndarray
    rate: float
    name: str = "vibration"
    shaft_speed: np.ndarray | None = None
    tally: Tally | None = None

    def __post_init__(self):
        count, unusable = len(self.samples), np.flatnonzero(~np.isfinite(self.samples))
        if count < FEWEST_SAMPLES:
            raise VibrationError(f"{self.name}: {count} samples; expected at least {FEWEST_SAMPLES}")
        if unusable.size:
            raise VibrationError(
                f"{self.name}: sample {unusable[0]} is {self.samples[unusable[0]]}, and {unusable.size - 1} others are not finite; expected a record"
                " without gaps: cut it at the gap"
            )
        if not 0.0 < self.rate < np.inf:
            raise VibrationError(f"{self.name}: a rate of {self.rate} Hz; expected a positive one")
        low, high = float(np.min(self.samples)), float(np.max(self.samples))
        if 0.0 < high - low < _LEAST or not max(-low, high) < 1.0 / _LEAST:  # squares of such numbers cannot be computed
            raise VibrationError(f"{self.name}: values from {low:g} to {high:g}; expected those of an accelerometer: check the channel")
        if not high > low:
            raise VibrationError(f"{self.name}: all samples are {self.samples[0]}; expected a vibration: check the sensor and the channel")
        if self.shaft_speed is not None and (len(self.shaft_speed) != count or not np.all(np.isfinite(self.shaft_speed))):
            raise VibrationError(f"{self.name}: expected a finite shaft speed at each of the {count} samples")

    @property
    def duration(self) -> float:
        """Its duration [s]."""
        return len(self.samples) / self.rate

    def part(self, begin: int, end: int) -> "Vibration":
        """Return the samples from ``begin`` to before ``end`` as a record."""
        speed = None if self.shaft_speed is None else self.shaft_speed[begin:end]
        return dataclasses.replace(self, samples=self.samples[begin:end], shaft_speed=speed)


class Spectrum:
    """The spectrum of a whole record, from which filtered signals are made.

    Parameters
    ----------
    samples : shape (n,).
    rate : of the samples [Hz].
    ends : fraction of the record over which it fades in and out, so that a line does not leak to its neighbours.
    """

    def __init__(self, samples: np.ndarray, rate: float, ends: float = 0.0):
        self._count = len(samples)
        window = _fading(self._count, ends) if ends else 1.0
        self._lines = scipy.fft.rfft((samples - samples.mean()) * window)
        bins = np.arange(1, _FARTHEST)
        fading = 1.0 if not ends else np.minimum(1.0, (0.5 / ends / bins) ** 2)
        self._skirt = np.concatenate(([1.0], fading / (np.pi * bins)))  # height of a line of 1 so many bins off its peak, at most
        self._step = rate / self._count  # [Hz]
        self.highest = rate / 2.0
        self.rate = rate

    def without_lines(self, spared: float = 0.0, reach: float = 0.0) -> "Spectrum":
        """Return this spectrum with its level evened out, and discrete lines cut out but for those near all multiples of a frequency.

        Parameters
        ----------
        spared : the frequency [Hz]; 0 if no line is spared.
        reach : within which of its multiples lines are spared [Hz].

        Rotors, gears and the mains make lines that are sharper than those of a bearing: its rollers jitter and its cage wanders, which spreads its
        lines at the high frequencies where they are looked for (Borghesani, Pennacchi, Randall, Sawalhi and Ricci, Mechanical Systems and Signal
        Processing 36, 2013, whiten all bins alike; here only the bins of lines are cut).  At high speeds they are still loud in the spectrum of the
        vibration itself, tens of bins wide: a line is cut only where it stands out from the bins next to it.
        """
        magnitude = np.abs(self._lines)
        floor = _floor(magnitude)
        sharp = self._lines.copy()
        sharp[1:-1] -= 0.5 * (self._lines[:-2] + self._lines[2:])  # a Hann window, so that no skirt hides what is next to a line
        sharp = np.abs(sharp)
        nearby = scipy.ndimage.median_filter(sharp, _NEARBY, mode="nearest")
        is_line = scipy.ndimage.binary_dilation(sharp > _LINE * np.maximum(_floor(sharp), nearby), iterations=_SKIRT)
        peaks = [where.start + int(np.argmax(magnitude[where])) for (where,) in scipy.ndimage.find_objects(scipy.ndimage.label(is_line)[0])]
        reaches = np.searchsorted(-self._skirt, -floor[peaks] / np.maximum(magnitude[peaks], 1e-300)) if peaks else ()
        for peak, skirt in zip(peaks, reaches):
            is_line[max(0, peak - skirt) : peak + skirt + 1] = True
        if spared > 0.0:
            places = np.arange(len(magnitude)) * (self._step / spared)
            is_line &= np.abs(places - np.rint(places)) * spared > reach
        gain = np.where(is_line, 0.0, 1.0) / floor
        found = copy.copy(self)
        found._lines = self._lines * gain
        return found

    def low_passed(self, highest: float) -> tuple[np.ndarray, float]:
        """Return the signal below a frequency [Hz], or below half its rate, and its rate [Hz]."""
        highest = min(highest, self.highest)
        rate = min(2.0 * _OVERSAMPLED * highest, self.rate)
        count = max(16, scipy.fft.next_fast_len(int(self._count * rate / self.rate), real=True))
        count = min(count, self._count)
        kept = min(int(highest / self._step) + 1, count // 2 + 1, len(self._lines))
        lines = np.zeros(count // 2 + 1, complex)
        lines[:kept] = self._lines[:kept]
        return scipy.fft.irfft(lines, count) * (count / self._count), count * self._step

    def in_band(self, band: Band, oversampled: int = 1) -> tuple[np.ndarray, float]:
        """Return the complex envelope of a band, and its rate [Hz]; its magnitude is the envelope of the signal in the band.

        Its frequencies are those of the signal less the lower end of the band; ``oversampled`` is its rate over that which holds them.
        """
        low, high = int(band.low / self._step), min(int(band.high / self._step), len(self._lines) - 1)
        lines = self._lines[max(low, 1) : high]
        edge = max(1, int(_TAPER * len(lines)))
        taper = 0.5 - 0.5 * np.cos(np.pi * (np.arange(edge) + 0.5) / edge)
        weights = np.ones(len(lines))
        weights[:edge], weights[-edge:] = taper, taper[::-1]
        count = scipy.fft.next_fast_len(oversampled * len(lines))
        spread = np.zeros(count, complex)
        spread[: len(lines)] = lines * weights
        return scipy.fft.ifft(spread) * (2.0 * count / self._count), count * self._step

    def envelope(self, band: Band) -> tuple[np.ndarray, float]:
        """Return the envelope of a band, limited to 20 times its median, and its rate [Hz]."""
        signal, rate = self.in_band(band)
        envelope = np.abs(signal)
        return np.minimum(envelope, _LARGEST_ENVELOPE * np.median(envelope)), rate

    def kurtosis(self, band: Band, parts: int = 8) -> float:
        """Return how much more impulsive a band is than noise: E|z|^4/(E|z|^2)^2 - 2 of its complex envelope z, median over parts of the record.

        This is the kurtogram's measure (Antoni, Mechanical Systems and Signal Processing 20, 2006, 282-307; 21, 2007, 108-124); the median keeps a
        single knock from choosing the band.
        """
        power = np.abs(self.in_band(band)[0]) ** 2
        return float(np.median([np.mean(each**2) / max(np.mean(each) ** 2, 1e-300) - 2.0 for each in np.array_split(power, parts)]))


def repetition(samples: np.ndarray, rate: float, turn: float) -> float | None:
    """Return the period [s] with which a whole record repeats itself; None if it does not, as no measured one does.

    A loop of samples has lines at all multiples of the rate at which it repeats, and a comb among them by chance.  What repeats is the broadband
    part, at all frequencies alike: the autocorrelation is taken of the spectrum evened out over 1.5 times the frequency of the shaft, so that lines
    of machines count little.  A period below a turn of the shaft is not reported, because machines have such themselves.

    Parameters
    ----------
    samples : of the record.
    rate : of the samples [Hz].
    turn : time of a turn of the shaft [s].
    """
    count = len(samples)
    lines = scipy.fft.rfft(samples - samples.mean())
    blocks = max(1, int(rate / 2.0 / (_EVENED_ORDERS / turn)))
    edges = np.linspace(0, len(lines), blocks + 1).astype(int)
    level = np.add.reduceat(np.abs(lines) ** 2, edges[:-1]) / np.diff(edges)
    level = np.interp(np.arange(len(lines)), (edges[1:] + edges[:-1]) / 2.0, np.maximum(level, 1e-24 * level.max()))
    # The weights widen the peak of the correlation, for a period of no whole number of samples.
    evened = scipy.fft.irfft(lines * np.cos(0.5 * np.pi * np.arange(len(lines)) / len(lines)) / np.sqrt(level), count)
    padded = scipy.fft.next_fast_len(count + count // 2 + 1, real=True)
    lags = np.arange(count // 2 + 1)
    correlation = scipy.fft.irfft(np.abs(scipy.fft.rfft(evened, padded)) ** 2, padded)[: len(lags)]
    energy = np.concatenate(([0.0], np.cumsum(evened**2)))
    correlation /= np.maximum(np.sqrt(energy[count - lags] * (energy[-1] - energy[lags])), 1e-300)
    highest = float(np.max(correlation[_SHORTEST_LAG:]))
    if highest < _REPEATED:
        return None
    lag = _SHORTEST_LAG + int(np.argmax(correlation[_SHORTEST_LAG:] > _MULTIPLE * highest))
    lag += int(np.argmax(correlation[lag : lag + _SHORTEST_LAG]))
    return lag / rate if lag / rate > _LONGER_THAN_A_TURN * turn else None


def _fading(count: int, ends: float) -> np.ndarray:
    """Return a cosine-tapered window that rises and falls over a fraction of its length each."""
    rise = int(ends * (count - 1))
    window = np.ones(count)
    window[: rise + 1] = 0.5 - 0.5 * np.cos(np.pi * np.arange(rise + 1) / (ends * (count - 1)))
    window[count - rise - 1 :] = window[rise::-1]
    return window


def _floor(magnitude: np.ndarray) -> np.ndarray:
    """Return the level of a spectrum without its lines: medians over blocks of bins, joined by straight lines."""
    blocks = max(1, len(magnitude) // _FLOOR_BLOCK)
    edges = np.linspace(0, len(magnitude), blocks + 1).astype(int)
    floors = np.array([np.median(magnitude[low:high]) for low, high in zip(edges, edges[1:])])
    floors = np.maximum(floors, 1e-12 * max(magnitude.max(), 1e-300))
    return np.interp(np.arange(len(magnitude)), (edges[1:] + edges[:-1]) / 2.0, floors)


def kurtogram(spectrum: Spectrum, narrowest: float) -> list[tuple[float, Band]]:
    """Return the bands of a tree of halves and thirds with their kurtosis, the most impulsive first.

    Parameters
    ----------
    spectrum : of the record.
    narrowest : width of a band [Hz] below which it would not hold the lines that are looked for.
    """
    highest, found = spectrum.highest, []
    for parts in (1, 2, 3, 4, 6, 8, 12, 16):
        width = highest / parts
        if width < narrowest and parts > 1:
            break
        bands = [Band(k * width, (k + 1) * width) for k in range(parts)]
        found += [(spectrum.kurtosis(band), band) for band in bands]
    return sorted(found, key=lambda each: -each[0])


def candidate_bands(spectrum: Spectrum, narrowest: float) -> list[Band]:
    """Return the bands in which lines are looked for: the two most impulsive ones, the whole, and quarters of it.

    Where noise covers the impulses no kurtosis shows their band, so that the quarters are tried as well; the false alarms of all are counted.
    """
    ranked = [band for _, band in kurtogram(spectrum, narrowest)]
    parts = next((count for count in (4, 2) if spectrum.highest / count >= narrowest), 1)
    width = spectrum.highest / parts
    bands = [*ranked[:2], Band(0.0, spectrum.highest), *(Band(k * width, (k + 1) * width) for k in range(parts))]
    return list(dict.fromkeys(bands))


def narrow_bands(spectrum: Spectrum, narrowest: float) -> list[Band]:
    """Return half overlapping bands of about the width of a resonance, an eighth of the whole, or wider ones where lines would not fit in."""
    parts = next((count for count in (8, 4, 2) if spectrum.highest / count >= narrowest), 1)
    width = spectrum.highest / parts
    return [Band(0.5 * k * width, (0.5 * k + 1.0) * width) for k in range(2 * parts - 1)]
