# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Series of the view: numbers over time as columns, regime lane, log, and the texts beside them."""

import math
from collections.abc import Callable

import numpy as np
import rerun as rr

from bearing_sim.effects import LEVELS, level_of
from bearing_sim.events import Event, Level
from bearing_sim.scene import Scene
from bearing_sim.sinks import colours, section
from bearing_sim.sinks.overview import FULL_ROWS, Lines, Overview, Thinned, bucket_for
from bearing_sim.sinks.rerun_lines import (
    AGGREGATION,
    EACH,
    ENDLESS,
    LINES,
    RPM,
    ZERO_CELSIUS,
    dim,
    further_series,
    measured_series,
    plottable,
    range_path,
    roller_series,
    series,
    threshold_lines,
)

TIMELINE = "sim_time"
END = "/end"  # a point out of sight, a little later than the run: time axes reach it, and their last label has room
REGIMES = {
    "at rest": 0x4A4F5AFF,
    "rolling": 0x0A7F62FF,
    "slipping": 0xC99A00FF,
    "skidding": 0xC8501AFF,
    "overrunning": 0x8A5A8FFF,
}
_LEVEL_COLOURS = {"steady": 0x4A4F5AFF, "slip": 0x2B5C8AFF, "planar": 0x2A7F9EFF, "spatial": 0x3B9C8CFF}
_FALLEN = 0xC8501AFF  # a level that is not the wanted one
LOG_LEVELS = {Level.OK: rr.TextLogLevel.INFO, Level.WARN: rr.TextLogLevel.WARN, Level.ERROR: rr.TextLogLevel.ERROR}


class RunSeries:
    """Series of one run into one recording.

    Parameters
    ----------
    recording : rerun.RecordingStream.
    scene : whose thresholds are drawn and whose bearing is described.
    thin : whether a long run is thinned out (see `bearing_sim.sinks.overview`); for files.
    duration : simulated time that will come [s], where known.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene, thin: bool = False, duration: float | None = None):
        self._recording = recording
        self._scene = scene
        self._thin, self._duration = thin, duration
        self._overview: Overview | None = None
        self._measured_overview: Overview | None = None
        self._chosen = False  # whether it is known if the run is thinned out
        self._regime, self._level = "", math.nan
        self._ranges: dict[str, tuple[float, float]] = {}  # lowest and highest value so far, by entity path
        self._slip_ranges: dict[int, tuple[float, float]] = {}  # the same for the slip, by octave of the shaft speed
        self._measured: list[tuple[float, float, float]] = []  # time, cage speed, residual
        self._newest: list[np.ndarray] = []  # the last two blocks written: measurements come before or after those of their times
        self._started: float | None = None
        self.is_measured = False

    def describe(self) -> None:
        """Log names, colours and texts that hold for the whole run."""
        for path, (name, colour, width) in LINES.items():
            line = rr.SeriesLines(names=[name], colors=[colour], widths=[width], aggregation_policy=AGGREGATION.get(path, "Average"))
            self._recording.log(path, line, static=True)
        count = self._scene.bearing.roller.count
        around = colours.load_palette(count)
        for path, name in EACH.items():
            if self._scene.bodies_tilt or not path.startswith("/tilt"):
                names = [f"{name} {j + 1}" for j in range(count)]
                self._recording.log(path, rr.SeriesLines(names=names, colors=around, widths=np.full(count, 1.0)), static=True)
        self._describe_lane("/regime", REGIMES)
        fallen = {_level_state(level, self._scene.level): _FALLEN for level in LEVELS if level != self._scene.level}
        self._describe_lane("/level", {self._scene.level: _LEVEL_COLOURS[self._scene.level]} | fallen)

    def _describe_lane(self, path: str, states: dict[str, int]) -> None:
        configuration = rr.StateConfiguration(values=list(states), labels=list(states), colors=np.array(list(states.values()), np.uint32))
        self._recording.log(path, configuration, static=True)

    def write(self, block: np.ndarray) -> None:
        """Send the columns of a block, in one piece per series."""
        self._started = float(block["time"][0]) if self._started is None else self._started
        values = series(block) | roller_series(self._scene, block) | further_series(self._scene, block)
        lines = Lines(block["time"], {path: plottable(rows) for path, rows in values.items()})
        for path, rows in lines.values.items():
            _widen(self._ranges, path, rows)
        self._note_slip(block)
        self._choose_thinning(block["time"])
        self._send(lines, self._overview)
        self._write_lanes(block)
        self._newest = [*self._newest[-1:], block]
        self._write_measured()

    def note_measurement(self, time: float, cage_speed: float, residual: float) -> None:
        """Take a measured cage speed [rad/s] and its residual slip (see `bearing_sim.sinks.rerun_sink`); written with the next block."""
        self._measured.append((time, cage_speed, residual))

    def finish(self) -> None:
        """Send what waits, and mark the end of the run."""
        self._write_measured()
        for overview in filter(None, (self._overview, self._measured_overview)):
            self._send_thinned(overview.finish())
        if self._newest:
            last = float(self._newest[-1]["time"][-1])
            self._send_level(END, np.array([last + 0.07 * (last - self._started)]), math.nan)

    def _choose_thinning(self, times: np.ndarray) -> None:
        """Choose at the first block with an interval in it whether, and how, the run is thinned out."""
        if self._chosen or not self._thin or len(times) < 2:
            return
        self._chosen = True
        bucket = bucket_for(float(np.median(np.diff(times))), self._duration)
        if bucket is not None:
            whole = FULL_ROWS if self._duration is None else 0
            self._overview, self._measured_overview = Overview(bucket, whole), Overview(bucket, whole)
            self._keep_around(float(times[0]))
            for path, (name, colour, _) in LINES.items():
                names = [f"{name}, lowest", f"{name}, highest"]
                self._recording.log(range_path(path), rr.SeriesLines(names=names, colors=[dim(colour)] * 2, widths=[1.0, 1.0]), static=True)

    def _send(self, lines: Lines, overview: Overview | None) -> None:
        """Send series, or in a long run what is left of them by now."""
        if overview is not None:
            self._send_thinned(overview.add(lines))
            return
        self._send_columns(lines, str)

    def _send_thinned(self, thinned: Thinned | None) -> None:
        if thinned is not None:
            self._send_columns(thinned.lines, str)
            self._send_columns(thinned.ranges, range_path)

    def _send_columns(self, lines: Lines, named: Callable[[str], str]) -> None:
        if not len(lines.times):
            return
        index = [rr.TimeColumn(TIMELINE, duration=lines.times)]
        for path, values in lines.values.items():
            self._recording.send_columns(named(path), indexes=index, columns=rr.Scalars.columns(scalars=values.astype(np.float32)))
        if "/slip/cage" in lines.values and named is str:
            self._write_thresholds(lines.times[[0, -1]])

    def _write_measured(self) -> None:
        if not self._measured or not self._newest:
            return
        rows, self._measured = np.array(self._measured), []
        rows = rows[np.argsort(rows[:, 0], kind="stable")]
        values = measured_series(*rows.T, np.concatenate(self._newest))
        lines = Lines(rows[:, 0], {path: plottable(column) for path, column in values.items()})
        for path, column in lines.values.items():
            _widen(self._ranges, path, column)
        self.is_measured = True
        self._send(lines, self._measured_overview)
        self._send_level("/slip/no_residual", rows[[0, -1], 0], 0.0)

    def _write_thresholds(self, ends: np.ndarray) -> None:
        for path, value in threshold_lines(self._scene).items():
            self._send_level(path, ends, value)
            _widen(self._ranges, path, np.array([value]))

    def _send_level(self, path: str, ends: np.ndarray, value: float) -> None:
        index = [rr.TimeColumn(TIMELINE, duration=ends)]
        self._recording.send_columns(path, indexes=index, columns=rr.Scalars.columns(scalars=np.full(len(ends), value, np.float32)))

    def _note_slip(self, block: np.ndarray) -> None:
        octaves = np.floor(np.log2(np.maximum(np.abs(block["shaft_speed"]), 1e-3)))
        for octave in np.unique(octaves):
            _widen(self._slip_ranges, int(octave), 100 * block["cage_slip"][octaves == octave])

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Return lowest and highest value of each series so far, by entity path.

        The slip counts only where the shaft turns at a good tenth of its highest speed: of a shaft that hardly turns it may
        be anything, and says nothing.
        """
        fast = [span for octave, span in self._slip_ranges.items() if octave >= max(self._slip_ranges) - 3]
        slip = {"/slip/cage": (min(low for low, _ in fast), max(high for _, high in fast))} if fast else {}
        return self._ranges | slip

    def _write_lanes(self, block: np.ndarray) -> None:
        limits = self._scene.thresholds
        for time, slip, level in zip(block["time"].tolist(), block["cage_slip"].tolist(), block["level"].tolist()):
            now = section.regime(slip, limits.slip_warning, limits.slip_error, self._regime)
            if now != self._regime:
                self._regime = now
                self._change_state("/regime", time, now)
            if level != self._level and math.isfinite(level):
                self._level = level
                self._change_state("/level", time, _level_state(LEVELS[int(level)], self._scene.level))

    def _change_state(self, path: str, time: float, state: str) -> None:
        self._recording.set_time(TIMELINE, duration=time)
        self._recording.log(path, rr.StateChange(state=state))
        self._keep_around(time)

    def _keep_around(self, time: float) -> None:
        for overview in filter(None, (self._overview, self._measured_overview)):
            overview.mark(time)

    def write_event(self, event: Event) -> None:
        """Log an event at its own time."""
        self._recording.set_time(TIMELINE, duration=float(event.time))
        self._recording.log("/log", rr.TextLog(f"{event.text}  [{event.code}]", level=LOG_LEVELS[Level(event.level)]))
        self._keep_around(event.time)

    def write_readout(self, sample: np.void, dropped: int) -> None:
        """Log the numbers of one sample as text at the recording's present time."""
        limits = self._scene.thresholds
        slip, life = float(sample["cage_slip"]), float(sample["rating_life"])
        lines = [
            ("level", _level_state(level_of(sample), self._scene.level)),
            ("cage slip", f"**{100 * slip:.2f} %**" if math.isfinite(slip) else "none (at rest)"),
            ("rating life", f"**{_hours(life)}**"),
            *self._further_readout(sample),
            ("damage", f"{1e6 * float(sample['damage']):.3g} millionths of the life"),
            ("shaft", f"{round(RPM * float(sample['shaft_speed'])):,} rpm"),
            ("cage", f"{round(RPM * float(sample['cage_speed'])):,} rpm"),
            ("radial load", f"{math.hypot(sample['load_y'], sample['load_z']):,.0f} N"),
            ("oil", f"{float(sample['oil_temperature']) - ZERO_CELSIUS:.1f} °C"),
            ("rollers loaded", f"{np.count_nonzero(sample['inner_load'] > 0)} of {len(sample['inner_load'])}"),
            ("largest load", f"inner {_newton(sample['inner_load'])}, outer {_newton(sample['outer_load'])}"),
        ]
        if dropped:
            lines.append(("not shown", f"{dropped} blocks dropped"))
        regime = section.regime(slip, limits.slip_warning, limits.slip_error)
        table = "\n".join([f"| cage is | {regime} |", "|---|---|"] + [f"| {name} | {value} |" for name, value in lines])
        self._recording.log("/now", rr.TextDocument(table, media_type=rr.MediaType.MARKDOWN))

    def _further_readout(self, sample: np.void) -> list[tuple[str, str]]:
        """Return the readout's lines that only some scenes have."""
        lines = []
        if not self._scene.life.is_basic:
            lines.append(("life by choice", f"**{_hours(float(sample['modified_rating_life']))}**"))
        if self._scene.bodies_tilt:
            edge, largest = (1e-6 * max(float(sample[f"{ring}_{kind}"]) for ring in ("inner", "outer")) for kind in ("edge_pressure", "pressure"))
            tilt, skew = (1e3 * float(np.abs(sample[name]).max()) for name in ("roller_tilt", "roller_skew"))
            lines.append(("lamina life", f"{_hours(float(sample['lamina_life']))}"))
            known = math.isfinite(largest + edge), math.isfinite(tilt + skew)  # an older recording holds neither
            lines.append(("pressure", f"{largest:.0f} MPa, ends {edge:.0f} MPa" if known[0] else "unknown"))
            lines.append(("most tilt, skew", f"{tilt:.2f}, {skew:.2f} mrad" if known[1] else "unknown"))
        return lines

    def write_dropped(self, time: float, dropped: int) -> None:
        """Log how many blocks the view has missed so far."""
        self._recording.set_time(TIMELINE, duration=time)
        self._recording.log("/sink/dropped", rr.Scalars(float(dropped)))
        text = f"the view missed {dropped} blocks so far: it is slower than the simulation, which goes on undisturbed"
        self._recording.log("/log", rr.TextLog(text, level=rr.TextLogLevel.WARN))


def _level_state(level: str, wanted: str) -> str:
    return level if level == wanted else f"{level}, not {wanted}"


def _widen(ranges: dict, key, values: np.ndarray) -> None:
    """Widen a range so that it holds all finite values."""
    finite = values[np.isfinite(values)]
    if finite.size:
        low, high = ranges.get(key, (np.inf, -np.inf))
        ranges[key] = min(low, float(finite.min())), max(high, float(finite.max()))


def _hours(life: float) -> str:
    if not math.isfinite(life):
        return "endless (at rest)" if life > 0 else "unknown"
    return f"{life:,.0f} h" if life < ENDLESS else "endless"


def _newton(loads: np.ndarray) -> str:
    return f"{float(loads.max()):.0f} N" if np.isfinite(loads).any() else "unknown"
