# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What one run looks like in one rerun recording; everything here is called from one thread."""

import time as wall
from pathlib import Path

import numpy as np
import rerun as rr

from bearing_sim.events import Event, Level
from bearing_sim.scene import Scene
from bearing_sim.sinks import section
from bearing_sim.sinks.load_map import LoadMap, label_distance, map_size
from bearing_sim.sinks.rerun_blueprint import LIVE_WINDOW, Extent, blueprint
from bearing_sim.sinks.rerun_cage import CageDrawing
from bearing_sim.sinks.rerun_power import PowerDrawing
from bearing_sim.sinks.rerun_scene import SectionDrawing, labels
from bearing_sim.sinks.rerun_series import TIMELINE, RunSeries, about
from bearing_sim.sinks.rerun_solid import SolidDrawing

APPLICATION = "bearing_sim"
ROWS_PER_COLUMN = 1000
_SERVER_MEMORY = "256MB"
_RATE = 30.0  # [Hz] pictures for those who watch


class LiveFrames:
    """Picks pictures for somebody who watches: at most ``rate`` a second of wall time, each the newest."""

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
        self._drawn = 0
        self._first = self._last = None

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
    """Everything that is shown of one run.

    Parameters
    ----------
    scene : what runs.
    path : .rrd file to write, or None.
    serve_port : port on 127.0.0.1 where viewers may connect, or None.
    start_ns : wall time of sample time 0 [ns since the epoch], or None.
    duration : simulated time that will come [s], where known.
    load_scale : load [N] at the upper end of the colour map, where known; grows by itself when exceeded.
    real_time : True while the run goes on in real time, which pictures must not take processor time from.
    """

    def __init__(
        self,
        scene: Scene,
        path: str | Path | None = None,
        serve_port: int | None = None,
        start_ns: int | None = None,
        duration: float | None = None,
        load_scale: float | None = None,
        real_time: bool = False,
    ):
        live = serve_port is not None
        self._recording = rr.RecordingStream(APPLICATION)
        self._recording.set_log_time_enabled(False)  # one timeline: the simulated time
        scale = section.round_up(load_scale) if load_scale else first_load_scale(scene)
        self._drawing = SectionDrawing(self._recording, scene, scale)
        self._solid = SolidDrawing(self._recording, scene)
        self._cage = CageDrawing(self._recording, scene) if scene.cage_whirls else None
        self._power = PowerDrawing(self._recording)
        sinks = [rr.FileSink(str(path))] if path is not None else []
        if serve_port is not None:
            sinks.append(rr.GrpcServerSink("127.0.0.1", serve_port, server_memory_limit=_SERVER_MEMORY))
        self._recording.set_sinks(*sinks, default_blueprint=blueprint(scene, self._drawing.bounds(), live))
        self._recording.send_recording_name(scene.name)
        if start_ns is not None:
            self._recording.send_recording_start_time_nanos(start_ns)
        self._series = RunSeries(self._recording, scene)
        # A file keeps every picture: half as many for those who watch, evenly spread ones where nobody does.
        in_file = FileFrames(duration, shortest=2 / _RATE if real_time else 0.0)
        self._frames = LiveFrames(_RATE if path is None else _RATE / 2) if live else in_file
        self._details = LiveFrames(rate=10.0) if live else None  # nobody reads numbers faster
        self._map_times = LiveFrames(rate=2.0) if live else FileFrames(duration, most=30)
        self._map = LoadMap(LIVE_WINDOW if live else duration or 1.0, rolling=live, narrow=scene.cage_whirls)
        self._whole_map = LoadMap(duration or 1.0, rolling=False, narrow=scene.cage_whirls) if live and path is not None else None
        self._pending: list[np.ndarray] = []
        self._newest: np.void | None = None
        self._first_time = 0.0
        self._scene, self._has_file = scene, path is not None
        self._drawing.draw_still_parts()
        self._solid.draw_still_parts()
        self._power.draw_still_parts()
        if self._cage is not None:
            self._cage.draw_still_parts()
        self._series.describe()
        self._recording.log("/about", rr.TextDocument(about(scene, self._drawing.factor), media_type=rr.MediaType.MARKDOWN), static=True)
        self.dropped = 0

    def write(self, block: np.ndarray) -> None:
        """Take a block of samples; columns may wait for `flush`."""
        if not len(block):
            return
        if self._newest is None:
            self._first_time = float(block["time"][0])
            self._series.write_event(Event(float(block["time"][0]), Level.OK, "run.start", "the run starts"))
        self._newest = block[-1]
        self._pending.append(block)
        drawn = 0
        for index in self._frames.pick(block["time"]):
            self._follow(block[drawn : index + 1])
            self._draw(block[index])
            drawn = index + 1
        self._follow(block[drawn:])
        if self._whole_map is not None:
            self._whole_map.add(block)
        entered = 0
        for index in self._map_times.pick(block["time"]):
            self._map.add(block[entered : index + 1])
            self._draw_map(self._map, float(block["time"][index]))
            entered = index + 1
        if entered < len(block):
            self._map.add(block[entered:])
        if sum(map(len, self._pending)) >= ROWS_PER_COLUMN:
            self.flush()

    def write_event(self, event: Event) -> None:
        """Take an event."""
        self._series.write_event(event)

    def write_dropped(self, dropped: int) -> None:
        """Show that ``dropped`` blocks in all never arrived here."""
        self.dropped = dropped
        self._series.write_dropped(float(self._newest["time"]) if self._newest is not None else 0.0, dropped)

    def flush(self) -> None:
        """Send the columns of all blocks so far."""
        if self._pending:
            self._series.write(np.concatenate(self._pending))
            self._pending.clear()

    def close(self) -> None:
        """Send the rest and finish the file."""
        self.flush()
        if self._newest is not None:
            last = float(self._newest["time"])
            self._draw(self._newest)
            self._draw_map(self._whole_map or self._map, last)
            if self._has_file:  # now that every series is known, its axis can be chosen to hold it
                extent = Extent((self._first_time, last), self._series.ranges())
                self._recording.send_blueprint(blueprint(self._scene, self._drawing.bounds(), live=False, extent=extent))
        self._recording.flush(timeout_sec=5.0)
        self._recording.disconnect()

    def _draw(self, sample: np.void) -> None:
        self._recording.set_time(TIMELINE, duration=float(sample["time"]))
        self._drawing.draw(sample)
        self._solid.draw(sample, self._drawing.load_scale)
        if self._details is None or self._details.pick(sample["time"][None]):
            self._power.draw()
            if self._cage is not None:
                self._cage.draw(sample)
        self._series.write_readout(sample, self.dropped)

    def _follow(self, samples: np.ndarray) -> None:
        """Take samples into what a picture shows of the time before it."""
        self._power.add(samples)
        if self._cage is not None:
            self._cage.add(samples)

    def _draw_map(self, chart: LoadMap, time: float) -> None:
        narrow = self._scene.cage_whirls
        width, height = map_size(narrow)
        self._recording.set_time(TIMELINE, duration=time)
        self._recording.log("/load_map/map", rr.EncodedImage(contents=chart.png(self._drawing.load_scale), media_type="image/png"))
        times = section.round_ticks(chart.start, chart.start + chart.span)
        across = (times - chart.start) / chart.span * width
        self._label("/load_map/time", np.stack((across, np.full(len(times), 1.02 * height)), axis=1), [f"{time:g} s" for time in times])
        places = np.stack((np.full(5, -label_distance(narrow)), height * np.linspace(0.9, -0.02, 5)), axis=1)
        self._label("/load_map/azimuth", places, ["0° +Y", "90° +Z", "180°", "270°", "360°"])

    def _label(self, path: str, places: np.ndarray, texts: list[str]) -> None:
        self._recording.log(path, labels(places, texts))


def first_load_scale(scene: Scene) -> float:
    """Return a load [N] that the fullest roller will hardly exceed at the scene's operating point: five times its fair share, at least 100 N."""
    share = 5 * scene.operating.radial_load / scene.bearing.roller.count
    return section.round_up(max(share, 100.0))
