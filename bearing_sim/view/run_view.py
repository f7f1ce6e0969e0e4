# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Everything that is shown of one run: pictures, maps, series, and the text that describes the run."""

import math
import time as wall
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rerun as rr

from bearing_sim.messages.bands import Bands
from bearing_sim.messages.events import Event, Level, MeasuredClearance, Measurement, Record
from bearing_sim.messages.topics import ZERO_CELSIUS
from bearing_sim.scene.scene import Scene
from bearing_sim.view import section
from bearing_sim.view.bands import BandSeries
from bearing_sim.view.blueprint import LIVE_WINDOW, Extent, blueprint
from bearing_sim.view.drawings import CageDrawing, HeatDrawing, SectionDrawing, SolidDrawing, clearance_drawing, labels, power_drawing
from bearing_sim.view.load_map import LoadMap, label_distance, map_size
from bearing_sim.view.plots import TIMELINE, RunSeries

_WHIRL = """The cage's displacement and its {play} have a factor of their own, which the title says; cage orbit: the position of
its centre in the {play}{seen} and its path in the last turns, dots where samples are too far apart for a line.
"""
_GUIDES = {
    "outer_ring": "green: guide land on the outer ring. ",
    "inner_ring": "green: guide land on the inner ring. ",
    "roller": "",
    "full_complement": "",
}


def _whirl(scene: Scene) -> str:
    if not scene.cage_whirls:
        return ""
    cage = scene.bearing.cage
    seen = ", seen from the inner ring's centre," if cage.guidance == "inner_ring" else ""
    return _WHIRL.format(play="guide clearance" if cage.has_lands else "play in the pockets that guide it", seen=seen)


_HEAT = """**Temperatures** colour shaft, rings, rollers and housing; the housing is drawn as thick as a ring.

"""
_BENDING = """Blue line: the outer raceway as its ring has bent, by the same factor; between rollers it is interpolated. The red line is the raceway
without load.
"""
_TILTS = """The solid picture draws tilts of ring and rollers and skews by factors of their own, which its title says, and the cage's tilt by
the cage's factor. Pressures are Hertz's of laminae, largest
of all rollers; those of the end laminae say how hard edges press, without the rise at a sharp edge.
"""


def _supply_text(scene: Scene) -> str:
    """Return how the oil is supplied, and its fraction in the oil-air mixture or its flow, in words."""
    supply, fraction = scene.lubricant.supply, scene.lubricant.mixture_fraction
    amount = f"{6e4 * supply.flow:.3g} l/min" if fraction is None else f"{100 * fraction:g} % in the air"
    return f"supply {supply.law}, {amount}"


def about(scene: Scene, factor: int) -> str:
    """Return the description of a run as Markdown."""
    bearing, oil, limits = scene.bearing, scene.lubricant, scene.thresholds
    raceway, roller = bearing.outer_raceway, bearing.roller
    return f"""## {scene.name}

{scene.description}

**Bearing** {bearing.name}: {roller.count} rollers {1e3 * roller.diameter:g} x {1e3 * roller.length:g} mm,
outer raceway with {raceway.lobes} lobes, R_low {1e3 * raceway.low_radius:.4f} mm, D {1e6 * raceway.d_value:g} um,
low point at {math.degrees(raceway.installation_angle):g} deg,
play at the low points {1e6 * bearing.radial_clearance_at_low_points:.1f} um (negative: preload).

**Oil** {oil.oil.name}, {oil.temperature - ZERO_CELSIUS:g} °C at the start, {_supply_text(scene)},
traction law {oil.traction.law}.

**Level** {scene.level}.

**Picture**: bodies to scale; every radial departure from the ideal bearing (lobes, play, elastic approach, ring displacement)
is drawn x{factor}. Seen against the x axis: Y right, Z up; azimuth runs from +Y towards +Z. Red line: outer raceway; dashed: ideal
round raceway; {_GUIDES[bearing.cage.guidance]}Rollers are coloured by inner contact load, grey ones carry none. Arrows at the raceways: contact
forces on the rings, full scale of the colours = longest; yellow: radial load on the inner ring, twice that scale as far as there is room.
The orange cage bar and the white marks show rotation. Purple arrows: forces of the pockets on the rollers, scale in the middle.
{_BENDING if scene.outer_ring_bends else ""}{_whirl(scene)}{_TILTS if scene.bodies_tilt else ""}
**Power** by cause: what the shaft puts in by the tractions on the inner ring, the mixture in the cage's bore and guide lands of its own is lost, or
stored for a moment in motion and elastic contacts; the bars are means of the newest samples.

**Running clearance** of the lowest points, diametral, negative: preload, is the sum of what is on the drawing and what fits, rotation, heat and
the contour change; the bars are means of the newest samples.

{_HEAT if scene.uses_ring_temperatures else ""}**Thresholds**: slip {100 * limits.slip_warning:g} % warning,
{100 * limits.slip_error:g} % error; life below {limits.life_warning:g} h warning.

**Loads** of rollers are those of the sampled instants; the largest loads are those of any roller since the sample before, whatever the
interval of samples. The map fills a column without a sample from its neighbours.

**Slip** counts, and is drawn, while the shaft turns at {limits.slip_from_speed * 30 / math.pi:.4g} rpm or faster (thresholds.slip_from_speed).
"""


APPLICATION = "bearing_sim"
ROWS_PER_COLUMN = 1000
_SERVER_MEMORY = "16MB"  # of history for viewers that connect later: more than a minute at 18 rollers, twice what a live view shows
_RATE = 20.0  # [Hz] pictures for those who watch
_MOST_WANTED = 300  # pictures of events in a file


class ViewOptions(NamedTuple):
    """What a view of a run may know besides its scene.

    Attributes
    ----------
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    duration : simulated time that will come [s], where known.
    load_scale : load [N] at the upper end of the colour map, where known; grows by itself when exceeded.
    real_time : True for a run in real time; pictures must not take processor time from it.
    web_port : port on 127.0.0.1 at which browsers are served, besides viewers, or None.
    """

    start_ns: int | None = None
    duration: float | None = None
    load_scale: float | None = None
    real_time: bool = False
    web_port: int | None = None


NOTHING_KNOWN = ViewOptions()


class LiveFrames:
    """Picks pictures for a live viewer: at most ``rate`` per second of wall time, each of the newest sample."""

    def __init__(self, rate: float, clock=wall.monotonic):
        self._interval = 1 / rate
        self._clock = clock
        self._next = -np.inf

    def pick(self, times: np.ndarray) -> list[int]:
        """Return the indices of the samples to draw."""
        now = self._clock()
        if now < self._next:
            return []
        self._next = now + self._interval
        return [len(times) - 1]


class FileFrames:
    """Picks pictures for a file: evenly in simulated time, ``most`` of them over the run.

    Where the run's duration is not known beforehand, the interval doubles each time half of ``most`` have been drawn; it is
    never shorter than ``shortest`` [s].
    """

    def __init__(self, duration: float | None, most: int = 1500, shortest: float = 0.0):
        self._interval = max(duration / most if duration else 0.0, shortest)
        self._fixed = duration is not None
        self._batch = most // 2
        self._drawn = self._wanted = 0
        self._first = self._last = None

    def want(self) -> None:
        """Draw the next sample whatever its time, because an event occurred."""
        if self._wanted < _MOST_WANTED and self._last is not None:
            self._wanted += 1
            self._last = -np.inf

    def pick(self, times: np.ndarray) -> list[int]:
        """Return the indices of the samples to draw."""
        picked = []
        for index, time in enumerate(times):
            if self._last is not None and time < self._last + self._interval * (1 - 1e-6):
                continue
            self._first = time if self._first is None else self._first
            self._last = time
            self._drawn += 1
            picked.append(index)
            if not self._fixed and self._drawn % self._batch == 0:
                self._interval = max(2 * self._interval, 2 * (time - self._first) / self._batch)
        return picked


class RunView:
    """Everything that is shown of one run, in a file or at a port.

    Parameters
    ----------
    scene : what runs.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 where viewers may connect, or None; one of both.
    options : what else is known of the run.
    """

    def __init__(self, scene: Scene, path: str | Path | None = None, serve_port: int | None = None, options: ViewOptions = NOTHING_KNOWN):
        start_ns, duration, load_scale, real_time, _ = options
        live = serve_port is not None
        self._recording = rr.RecordingStream(APPLICATION)
        self._recording.set_log_time_enabled(False)  # one timeline: the simulated time
        scale = section.round_up(load_scale) if load_scale else first_load_scale(scene)
        self._drawing = SectionDrawing(self._recording, scene, scale)
        self._solid = SolidDrawing(self._recording, scene)
        self._cage = CageDrawing(self._recording, scene) if scene.cage_whirls else None
        self._bars = (power_drawing(self._recording, scene), clearance_drawing(self._recording, scene))
        self._heat = HeatDrawing(self._recording, scene) if scene.uses_ring_temperatures else None
        sink = rr.GrpcServerSink("127.0.0.1", serve_port, server_memory_limit=_SERVER_MEMORY) if live else rr.FileSink(str(path))
        self._recording.set_sinks(sink, default_blueprint=blueprint(scene, self._drawing.bounds(), live))
        self._recording.send_recording_name(scene.name)
        if start_ns is not None:
            self._recording.send_recording_start_time_nanos(start_ns)
        self._series = RunSeries(self._recording, scene, thin=not live, duration=duration)
        self._bands = BandSeries(self._recording, scene) if scene.estimation.is_asked else None
        self._frames = LiveFrames(_RATE) if live else FileFrames(duration, shortest=2 / _RATE if real_time else 0.0)
        self._details = LiveFrames(rate=10.0) if live else None  # numbers that change faster cannot be read
        self._map_times = LiveFrames(rate=2.0) if live else FileFrames(duration, most=30)
        rows = {"/load_map": None, "/load_map_by_roller": scene.bearing.roller.count}
        span, narrow = LIVE_WINDOW if live else duration or 1.0, scene.cage_whirls
        self._maps = {root: LoadMap(span, rolling=live, narrow=narrow, rollers=count) for root, count in rows.items()}
        self._pending: list[np.ndarray] = []
        self._newest: np.void | None = None
        self._first_time = 0.0
        self._scene, self._live, self._laid_out_measured = scene, live, frozenset()
        for drawing in filter(None, (self._drawing, self._solid, *self._bars, self._cage, self._heat)):
            drawing.draw_still_parts()
        self._series.describe()
        if self._bands is not None:
            self._bands.describe()
        self._recording.log("/about", rr.TextDocument(about(scene, self._drawing.factor), media_type=rr.MediaType.MARKDOWN), static=True)
        self.dropped = 0

    def write(self, record: Record) -> None:
        """Take a record; columns of samples, and bands, may wait for `flush`.  Standard errors of measurements are not shown."""
        match record:
            case Event():
                self._series.write_event(record)
                if not self._live:
                    self._frames.want()
            case Measurement(time, cage_speed, residual):
                self._series.note_measurement(time, cage_speed, residual)
            case MeasuredClearance(time, clearance):
                self._series.note_clearance(time, clearance)
            case Bands():
                if self._bands is not None:
                    self._bands.write(record)
            case np.ndarray() if len(record):
                self._write_samples(record)

    def _write_samples(self, block: np.ndarray) -> None:
        if self._newest is None:
            self._first_time = float(block["time"][0])
            self._series.write_event(Event(float(block["time"][0]), Level.OK, "run.start", "", "the run starts"))
        self._newest = block[-1]
        self._pending.append(block)
        drawn = 0
        for index in self._frames.pick(block["time"]):
            self._follow(block[drawn : index + 1])
            self._draw(block[index])
            drawn = index + 1
        self._follow(block[drawn:])
        entered = 0
        for index in self._map_times.pick(block["time"]):
            self._enter_maps(block[entered : index + 1])
            self._draw_maps(float(block["time"][index]))
            entered = index + 1
        self._enter_maps(block[entered:])
        if sum(map(len, self._pending)) >= ROWS_PER_COLUMN:
            self.flush()

    def write_dropped(self, dropped: int) -> None:
        """Show that ``dropped`` blocks in total were dropped before they reached the view."""
        self.dropped = dropped
        self._series.write_dropped(float(self._newest["time"]) if self._newest is not None else 0.0, dropped)

    def flush(self) -> None:
        """Send the columns of all blocks so far."""
        if self._pending:
            self._series.write(np.concatenate(self._pending))
            self._pending.clear()
            if self._bands is not None and self._series.bucket is not None:
                self._bands.thin(self._series.bucket)
            measured = frozenset(self._series.measured)
            if self._live and measured != self._laid_out_measured:
                self._laid_out_measured = measured
                self._recording.send_blueprint(blueprint(self._scene, self._drawing.bounds(), live=True, measured=measured))
        if self._bands is not None:
            self._bands.flush()

    def close(self) -> None:
        """Send the rest and finish the file."""
        self.flush()
        if self._newest is not None:
            last = float(self._newest["time"])
            self._draw(self._newest)
            self._draw_maps(last)
            if not self._live:  # now that every series is known, its axis can be chosen to hold it
                self._series.finish()
                ranges = self._series.ranges()
                if self._bands is not None:
                    self._bands.finish()
                    ranges |= self._bands.ranges()
                extent = Extent((self._first_time, last), ranges)
                laid_out = blueprint(self._scene, self._drawing.bounds(), live=False, extent=extent, measured=self._series.measured)
                self._recording.send_blueprint(laid_out)
        self._recording.flush(timeout_sec=5.0)
        self._recording.disconnect()

    def _draw(self, sample: np.void) -> None:
        self._recording.set_time(TIMELINE, duration=float(sample["time"]))
        self._drawing.draw(sample)
        self._solid.draw(sample, self._drawing.load_scale)
        if self._details is None or self._details.pick(sample["time"][None]):
            for bars in self._bars:
                bars.draw()
            for drawing in filter(None, (self._cage, self._heat)):
                drawing.draw(sample)
        self._series.write_readout(sample, self.dropped)

    def _follow(self, samples: np.ndarray) -> None:
        """Add samples to what a picture shows of the time before it."""
        self._series.follow(samples)
        for bars in self._bars:
            bars.add(samples)
        if self._cage is not None:
            self._cage.add(samples)

    def _enter_maps(self, samples: np.ndarray) -> None:
        if len(samples):
            for chart in self._maps.values():
                chart.add(samples)

    def _draw_maps(self, time: float) -> None:
        self._recording.set_time(TIMELINE, duration=time)
        narrow, count = self._scene.cage_whirls, self._scene.bearing.roller.count
        width, height = map_size(narrow)
        rows = {
            "/load_map": (np.linspace(0.0, 1.0, 5), ["0° +Y", "90° +Z", "180°", "270°", "360°"]),
            "/load_map_by_roller": (
                np.array([0.5, (count + 1) // 2 - 0.5, count - 0.5]) / count,
                ["no. 1", f"no. {(count + 1) // 2}", f"no. {count}"],
            ),
        }
        for root, chart in self._maps.items():
            picture = rr.EncodedImage(contents=chart.png(self._drawing.load_scale), media_type="image/png")
            self._recording.log(f"{root}/map", picture)
            times = section.round_ticks(chart.start, chart.start + chart.span, most=4 if narrow else 6)
            across = (times - chart.start) / chart.span * width
            self._recording.log(f"{root}/time", labels(section.places(across, 1.02 * height), [f"{time:g} s" for time in times]))
            upwards, names = rows[root]
            beside = section.places(-label_distance(narrow), height * (0.9 - 0.92 * upwards))
            self._recording.log(f"{root}/rows", labels(beside, names))


def first_load_scale(scene: Scene) -> float:
    """Return the first full scale of the colours [N]: five times the mean load of a roller at the scene's operating point, at least 100 N."""
    load = 5 * scene.operating.radial_load / scene.bearing.roller.count
    return section.round_up(max(load, 100.0))
