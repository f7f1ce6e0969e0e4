# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Shaded bands over time: results of the model between their 5 and 95 % quantiles, and the fields that measurements calibrate.

The viewer shades a `rerun.Measurements` by one standard deviation to either side, so `bearing_sim.view.plots.send_columns` sends the middle of a
band's edges, drawn without a line, with half their distance as that deviation.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import rerun as rr

from bearing_sim.messages.bands import Bands
from bearing_sim.scene.scene import Scene
from bearing_sim.scene.uncertainty import quantities
from bearing_sim.view import colours
from bearing_sim.view.plots import ENDLESS, SERIES, Lines, Overview, Series, send_columns

_ROWS = 500  # that are sent together
_USUAL = 0.97  # of the time the edges of a band lie on the axis: while a shaft starts or stops, slip may be anything


class BandPlot(NamedTuple):
    """How a quantity with its band is drawn.

    Attributes
    ----------
    path : entity path of the shaded band.
    line : entity path of the line of its value; ``""`` where the value is a sample's, which has a line already.
    name : of the line.
    colour : of the line, and of the shade.
    shown : from SI to what is plotted.
    """

    path: str
    line: str
    name: str
    colour: tuple[int, int, int, int]
    shown: Callable[[np.ndarray], np.ndarray]


def _band_plot(row: Series) -> BandPlot:
    """Return how the band of a row of ``series.csv`` is drawn; lives that are endless lie at the upper end of what is plotted."""
    line = row.path.replace("band", "log10_hours") if row.observable == "remaining_life" else ""  # which no sample holds
    return BandPlot(row.path, line, row.name, row.colour, lambda numbers: row.values(np.where(numbers > ENDLESS, ENDLESS, numbers)))


_PLOTS = {row.observable: _band_plot(row) for row in SERIES.values() if row.kind == "band"}
_FIELD_COLOURS = (colours.BLUE, colours.ORANGE, colours.GREEN, colours.YELLOW, colours.PURPLE, colours.VERMILION)


def field_plots(scene: Scene) -> dict[str, BandPlot]:
    """Return how the fields that a scene calibrates are drawn, by path."""
    return {path: _field_plot(path, colour) for path, colour in zip(scene.estimation.calibrated, _FIELD_COLOURS * len(scene.estimation.calibrated))}


def _field_plot(path: str, colour: tuple[int, int, int, int]) -> BandPlot:
    line = f"/estimate/{path.replace('.', '_')}"
    return BandPlot(f"{line}/band", line, path, colour, lambda values: values)


def field_title(path: str) -> str:
    """Return the title of the plot of a calibrated field, with its unit."""
    declared = quantities(Scene).get(path)
    name = path.rpartition(".")[2].replace("_", " ")
    return f"{name} [{declared.unit if declared is not None and declared.unit else '-'}]"


class BandSeries:
    """The bands of one run into one recording.

    Parameters
    ----------
    recording : rerun.RecordingStream.
    scene : whose calibrated fields are drawn.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        self._recording = recording
        self._plots = _PLOTS | field_plots(scene)
        self._waiting: list[Bands] = []
        self._count = 0
        self._overviews: dict[str, Overview] = {}
        self._bucket: float | None = None
        self._edges: dict[str, list[np.ndarray]] = {}  # by entity path

    def describe(self) -> None:
        """Log names and colours."""
        for plot in self._plots.values():
            band = rr.Measurements.from_fields(names=[plot.name], colors=[plot.colour], widths=[0.0])
            self._recording.log(plot.path, band, static=True)
            if plot.line:
                self._recording.log(plot.line, rr.SeriesLines(names=[plot.name], colors=[plot.colour], widths=[2.5]), static=True)

    def thin(self, bucket: float) -> None:
        """Send means over buckets of this length [s] from now on, because the run is long."""
        self._bucket = bucket

    def write(self, bands: Bands) -> None:
        """Take bands; they may wait for `flush`."""
        self._waiting.append(bands)
        self._count += len(bands.times)
        if self._count >= _ROWS:
            self.flush()

    def flush(self) -> None:
        """Send what waits."""
        waiting, self._waiting, self._count = self._waiting, [], 0
        for topic, names in dict.fromkeys((bands.topic, bands.names) for bands in waiting):
            alike = [bands for bands in waiting if (bands.topic, bands.names) == (topic, names)]
            self._take(topic, names, np.concatenate([bands.times for bands in alike]), np.concatenate([bands.numbers for bands in alike]))

    def finish(self) -> None:
        """Send all that is left."""
        self.flush()
        for overview in self._overviews.values():
            thinned = overview.finish()
            if thinned is not None:
                send_columns(self._recording, thinned.lines)

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Return between which values the edges of each band nearly always lie, by entity path."""
        found = {}
        for path, parts in self._edges.items():
            edges = np.concatenate(parts)
            edges = edges[np.isfinite(edges).all(axis=1)]
            if len(edges):
                found[path] = float(np.quantile(edges[:, 0], 1.0 - _USUAL)), float(np.quantile(edges[:, 1], _USUAL))
        return found

    def _take(self, topic: str, names: tuple[str, ...], times: np.ndarray, numbers: np.ndarray) -> None:
        values = {}
        for place, name in enumerate(names):
            plot = self._plots.get(name)
            if plot is None:
                continue
            shown = np.asarray(plot.shown(numbers[:, place]), np.float64)
            values[plot.path] = shown[:, 1:]
            if plot.line:
                values[plot.line] = shown[:, 0]
            self._edges.setdefault(plot.path, []).append(shown[:, 1:].astype(np.float32))
        lines = Lines(times, values)
        if self._bucket is None:
            send_columns(self._recording, lines)
            return
        thinned = self._overviews.setdefault(topic, Overview(self._bucket)).add(lines)
        if thinned is not None:
            send_columns(self._recording, thinned.lines)
