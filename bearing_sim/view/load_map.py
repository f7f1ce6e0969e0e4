# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Load maps: inner contact load by azimuth, or by roller, and time, as small pictures that grow or roll with the run."""

import io
import math
from collections import deque

import numpy as np
from PIL import Image

from bearing_sim.view.colours import load_palette

AZIMUTH_BINS = 72
COLUMNS = 160
NOT_YET = (13, 14, 17)
NO_LOAD = (44, 47, 55)
_PIXELS = (3, 4)  # height and width of a cell
_NARROW = 2  # times the height in a narrow picture
_SPACINGS = 200  # of samples, whose median is the usual one
_GAP = 3.0  # usual spacings of samples above which nothing is known of the time between two
_PALETTE = np.concatenate(([NOT_YET], load_palette(254), [NO_LOAD])).astype(np.uint8)


class LoadMap:
    """Mean load per azimuth bin, or per roller, and time column.

    Load zones stand still in azimuth, while a roller passes them hundreds of times a second, far more often than most recordings
    take samples: so the map by azimuth shows the bearing at any sampling, the one by roller what a roller meets in fine ones.

    A column narrower than the spacing of samples may have none: it shows what lies between its neighbours.

    Parameters
    ----------
    span : time [s] that the columns cover.
    rolling : True keeps the newest ``span`` seconds; False starts at the first sample and doubles the span when the run outgrows it.
    narrow : True makes pictures for a view that shares its space.
    rollers : how many rollers have a row each; None for rows by azimuth.
    """

    def __init__(self, span: float, rolling: bool, narrow: bool = False, rollers: int | None = None):
        self._narrow = narrow
        self.span = span
        self.start: float | None = None  # time at the left edge [s]; known from the first sample on
        self._rolling = rolling
        self._rollers = rollers
        self._sums = np.zeros((rollers or AZIMUTH_BINS, COLUMNS))
        self._counts = np.zeros((rollers or AZIMUTH_BINS, COLUMNS))
        self._newest = math.nan  # time of the newest sample [s]
        self._spacings: deque[float] = deque(maxlen=_SPACINGS)

    def add(self, block: np.ndarray) -> None:
        """Add the samples of a block, which must not be older than the previous ones."""
        times = block["time"]
        if self.start is None:
            self.start = float(times[0])
        self._spacings.extend(spacing for spacing in np.diff(times[-_SPACINGS - 1 :], prepend=self._newest).tolist() if spacing > 0.0)
        self._newest = float(times[-1])
        self._make_room(self._newest)
        columns = np.floor((times - self.start) / self.span * COLUMNS).astype(int)
        kept = (columns >= 0) & (columns <= COLUMNS)  # a sample on the right edge belongs to the last column
        columns = np.minimum(columns[kept], COLUMNS - 1)
        bins = self._bins(block["roller_angle"][kept])
        cells = (bins, np.broadcast_to(columns[:, None], bins.shape))
        np.add.at(self._sums, cells, np.nan_to_num(block["inner_load"][kept]))
        np.add.at(self._counts, cells, 1.0)

    def _bins(self, azimuth: np.ndarray) -> np.ndarray:
        if self._rollers:
            return np.broadcast_to(np.arange(self._rollers), azimuth.shape)
        turns = azimuth / (2 * math.pi)
        return np.minimum((AZIMUTH_BINS * (turns - np.floor(turns))).astype(int), AZIMUTH_BINS - 1)

    def _make_room(self, newest: float) -> None:
        if self._rolling:
            width = self.span / COLUMNS
            shift = math.ceil((newest - self.start - self.span) / width)
            if shift > 0:
                self.start += shift * width
                for table in (self._sums, self._counts):
                    table[:, : max(COLUMNS - shift, 0)] = table[:, shift:]
                    table[:, max(COLUMNS - shift, 0) :] = 0.0
            return
        while newest > self.start + self.span * (1 + 1e-9):
            self.span *= 2
            for table in (self._sums, self._counts):
                table[:, : COLUMNS // 2] = table[:, ::2] + table[:, 1::2]
                table[:, COLUMNS // 2 :] = 0.0

    def loads(self) -> np.ndarray:
        """Return mean loads [N], shape (AZIMUTH_BINS or rollers, COLUMNS); NaN where there is no sample yet, or in a gap of the run.

        A bin that no roller met while its column lasted takes the value between its neighbours in azimuth, a column without a sample that
        between its neighbours in time.
        """
        means = self._by_column()
        sampled = np.flatnonzero((self._counts > 0).any(axis=0))
        if not len(sampled) or not self._spacings:
            return means
        apart = float(np.median(self._spacings)) * COLUMNS / self.span  # usual spacing of samples, in columns
        for left, right in zip(sampled[:-1].tolist(), sampled[1:].tolist()):
            if 1 < right - left <= _GAP * apart + 1.0:
                share = np.arange(1, right - left) / (right - left)
                means[:, left + 1 : right] = means[:, [left]] + share * (means[:, [right]] - means[:, [left]])
        last = int(sampled[-1])
        means[:, last + 1 : last + 1 + int(apart)] = means[:, [last]]
        return means

    def _by_column(self) -> np.ndarray:
        with np.errstate(invalid="ignore", divide="ignore"):
            means = self._sums / self._counts
        if self._rollers:
            return means
        azimuth = np.arange(AZIMUTH_BINS)
        met = self._counts > 0
        for column in np.flatnonzero(met.any(axis=0) & ~met.all(axis=0)):
            known = met[:, column]
            means[:, column] = np.interp(azimuth, azimuth[known], means[known, column], period=AZIMUTH_BINS)
        return means

    def png(self, load_scale: float) -> bytes:
        """Return the map as PNG: time to the right, azimuth or rollers upwards, colours from 0 to ``load_scale`` [N]."""
        loads = self.loads()
        index = np.clip(1 + 253 * np.nan_to_num(loads) / load_scale, 1, 254).astype(np.uint8)
        index[np.nan_to_num(loads) <= 0] = 255
        index[np.isnan(loads)] = 0
        index = index[np.arange(AZIMUTH_BINS) * len(index) // AZIMUTH_BINS]
        height, width = _pixels(self._narrow)
        return palette_png(index[::-1].repeat(height, axis=0).repeat(width, axis=1), _PALETTE)


def map_size(narrow: bool = False) -> tuple[int, int]:
    """Return width and height of the map's picture [px]; a ``narrow`` one suits a view that shares its space."""
    return COLUMNS * _pixels(narrow)[1], AZIMUTH_BINS * _pixels(narrow)[0]


def label_distance(narrow: bool = False) -> float:
    """Return how far left of the map the middle of its labels stands [px]: they keep their size on the screen."""
    return (0.11 if narrow else 0.085) * map_size(narrow)[0]


def _pixels(narrow: bool) -> tuple[int, int]:
    return (_NARROW if narrow else 1) * _PIXELS[0], _PIXELS[1]


def map_bounds(narrow: bool = False) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the horizontal and vertical range [px] of the map with the labels of its axes."""
    width, height = map_size(narrow)
    return (-1.92 * label_distance(narrow), width + 0.9 * label_distance(narrow)), (-0.06 * height, 1.2 * height)


def palette_png(index: np.ndarray, palette: np.ndarray) -> bytes:
    """Return an indexed picture as PNG.

    Parameters
    ----------
    index : entries of the palette, uint8, shape (height, width).
    palette : RGB colours, uint8, shape (n, 3), n <= 256.
    """
    picture, content = Image.fromarray(index, "P"), io.BytesIO()
    picture.putpalette(palette.tobytes())
    picture.save(content, "PNG")
    return content.getvalue()
