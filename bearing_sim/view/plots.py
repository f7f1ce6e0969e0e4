# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""What is plotted over time: the series of a run with their paths, names, colours and units, and how a long run is thinned out.

An hour at 1 kHz is 3.6 million rows of a hundred numbers; no viewer needs them and none opens them well.  A long run is therefore sent as the lowest,
mean and highest values of buckets of time, and in full around events.
"""

import csv
import math
from collections.abc import Callable, Collection
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rerun as rr

from bearing_sim.messages.events import Event, Level
from bearing_sim.messages.topics import (
    FREQUENCIES,
    LIFE_SYMBOLS,
    MEASURED,
    MEASURED_CHANNELS,
    MEASURED_CLEARANCE,
    SLIP_FROM_SPEED,
    ZERO_CELSIUS,
    characteristic_frequencies,
    largest_loads,
    turns,
)
from bearing_sim.scene.display import RPM, number, quantity_text, shown
from bearing_sim.scene.fidelity import LEVELS, level_of
from bearing_sim.scene.scene import NO_CLEARANCE_LIMIT, Scene
from bearing_sim.view import colours, section

RINGS = ("inner", "outer")
ENDLESS = 1e7  # [h]; a bearing that hardly turns has a life of 1e30 h, which would flatten everything else
LOG_HOURS = "log10 h"
_UNITS = {"°C": (1.0, -ZERO_CELSIUS), "mrad": (1e3, 0.0), "ppm": (1e6, 0.0)}  # scale and offset from SI, where not as `shown` has the quantity


class Series(NamedTuple):
    """A row of ``series.csv``, whose head explains its columns."""

    path: str
    observable: str
    unit: str
    name: str
    colour: tuple[int, int, int, int] | None
    width: float
    kind: str
    threshold: str
    pixel: str
    needs: str

    def values(self, numbers) -> np.ndarray:
        """Return numbers of the observable, in SI (lives: hours), in the unit that is plotted."""
        if self.unit == LOG_HOURS:
            return log10_hours(numbers)
        quantity = shown(self.observable)
        scale, offset = _UNITS.get(self.unit, (quantity.scale, quantity.offset))
        return scale * numbers + offset


def table(name: str) -> list[dict[str, str]]:
    """Return the rows of one of the tables beside this module; lines that begin with ``#`` are comments."""
    with Path(__file__).with_name(f"{name}.csv").open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


SERIES = {
    row["path"]: Series(**row | {"colour": getattr(colours, row["colour"], None), "width": float(row["width"] or 0.0)}) for row in table("series")
}
"""What is plotted over time, by entity path."""
LINES = {path: row for path, row in SERIES.items() if row.kind in ("line", "threshold")}


def below(root: str, ending: str) -> dict[str, Series]:
    """Return the series below an entity path whose observable ends like this, by the rest of their paths."""
    return {path.removeprefix(root): row for path, row in LINES.items() if path.startswith(root) and row.observable.endswith(ending)}


def features(scene: Scene, measured: Collection[str] = ()) -> set[str]:
    """Return what series and plots may need (``needs`` in ``series.csv`` and ``plots.csv``) and a scene has, with the channels that are measured."""
    bearing = scene.bearing
    present = {
        "": True,
        compared_life(scene): True,
        "whirl": scene.cage_whirls,
        "tilts": scene.bodies_tilt,
        "heat": scene.uses_ring_temperatures,
        "bands": scene.estimation.bands,
        "modified_life": not scene.life.is_basic,
        "roller_slip": scene.level != "steady",  # which computes neither slip nor spin of rollers
        "rolling_resistance": scene.lubricant.rolling_resistance.law != "none",
        "seals": bearing.seals.law != "none",
        "flanges": bearing.flanges.present,
        "support": scene.support.is_active,
        "bending": scene.outer_ring_bends,
        "measured_cage": MEASURED in measured,
        "measured_clearance": MEASURED_CLEARANCE in measured,
    }
    return {name for name, is_present in present.items() if is_present}


def plottable(values) -> np.ndarray:
    """Return float32 values with NaN, a gap in a plot, wherever there is no finite number."""
    values = np.asarray(values, np.float64)
    return np.where(np.isfinite(values), values, np.nan).astype(np.float32)


def log10_hours(life) -> np.ndarray:
    """Return log10 of a life in hours, NaN where it is endless (more than `ENDLESS`), zero or unknown."""
    life = np.asarray(life, np.float64)
    return np.log10(life, where=(life > 0) & (life <= ENDLESS), out=np.full(life.shape, np.nan))


def range_path(path: str) -> str:
    """Return the entity path of lowest and highest values beside the means of a series in a long run."""
    return f"{path}/range"


def dim(colour: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return the colour of the range around a line."""
    return (*(int(0.6 * part) for part in colour[:3]), 255)


def series(scene: Scene, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted of a block, in the units that people read, by entity path.

    There is no slip where the shaft does not turn, slower than the scene's ``thresholds.slip_from_speed``.
    """
    present, slow = features(scene), scene.thresholds.slip_from_speed
    of_samples = [row for row in SERIES.values() if row.observable and not row.threshold and row.kind != "band" and row.needs in present]
    return {
        **{row.path: row.values(block[row.observable]) for row in of_samples},
        "/slip/cage": np.where(turns(block["shaft_speed"], slow), 100 * block["cage_slip"], np.nan),
        "/load/radial": np.hypot(block["load_y"], block["load_z"]),
        **{f"/loads/{ring}_largest": largest_loads(block, ring) for ring in RINGS},
        "/loads/pocket_largest": np.abs(block["pocket_force"]).max(axis=1),
        **{f"/frequency/{each.name}": column for each, column in zip(FREQUENCIES, characteristic_frequencies(block).T)},
        **(roller_series(scene, block) if "roller_slip" in present else {}),
    }


def roller_series(scene: Scene, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return sliding speeds [m/s] and spins [rpm] of all rollers of a block, by entity path, each of shape (n, Z).

    A raceway's surface less the roller's: omega_i R_i - omega_m r_m - omega_b r on the inner ring, and omega_b r - omega_m r_m on the
    outer one, with the spin omega_b positive where the roller rolls on the outer ring (Deng 2017, section 2.3, about a resting frame).
    """
    bearing = scene.bearing
    surface = block["roller_spin"] * bearing.roller.diameter / 2
    orbital = block["orbital_speed"] * block["roller_radius"]
    return {
        "/rollers/inner_sliding": block["shaft_speed"][:, None] * bearing.inner_raceway.radius - orbital - surface,
        "/rollers/outer_sliding": surface - orbital,
        "/rollers/spin": RPM * block["roller_spin"],
    }


def threshold_lines(scene: Scene) -> dict[str, float]:
    """Return where the scene's thresholds stand in the plots, by entity path; only those there are."""
    limits = {row: getattr(scene.thresholds, row.threshold) for row in SERIES.values() if row.threshold}
    lines = {row.path: float(row.values(limit)) for row, limit in limits.items() if limit is not None and limit > NO_CLEARANCE_LIMIT}
    return {path: line for path, line in lines.items() if math.isfinite(line)}  # there is no logarithm of a life of zero, which means none


def measured_series(
    times: np.ndarray, cage_speed: np.ndarray, residual: np.ndarray, block: np.ndarray, slip_from_speed: float = SLIP_FROM_SPEED
) -> dict[str, np.ndarray]:
    """Return what is plotted of a measured cage, by entity path.

    Parameters
    ----------
    times, cage_speed, residual : of the measurements [s, rad/s, fraction], shape (n,).
    block : samples around these times; they know how fast a cage without slip would be.
    slip_from_speed : of the shaft [rad/s], below which there is no slip.
    """
    shaft, ideal = (np.interp(times, block["time"], block[name]) for name in ("shaft_speed", "ideal_cage_speed"))
    turning = turns(shaft, slip_from_speed)
    slip = np.divide(cage_speed, ideal, out=np.full(len(times), np.nan), where=turning)
    return {
        "/speed/cage_measured": RPM * cage_speed,
        "/slip/measured": 100 * (1 - slip),
        "/slip/residual": np.where(turning, 100 * residual, np.nan),
    }


def compared_life(scene: Scene) -> str:
    """Return the observable of the life that is drawn beside the one by the method of the scene: of another standard."""
    return "l10" if scene.life.method == "iso16281" else "l10r"


AROUND = 1.0  # [s] before and after an event that are kept in full
FULL_ROWS = 100_000  # a run of no more is kept in full
_BUCKETS = 8000  # of a run whose length is known: four for each pixel of a wide screen
_LEAST_ROWS = 8  # of a bucket: fewer are not worth it
_BUCKET_WITHOUT_END = 0.2  # [s], of a run of unknown length
_PIECE = 256  # rows that are worth sending: a viewer's memory and time go with the number of pieces
_ROWS_AROUND_EVENTS = 150_000  # kept in full at most; later events are seen in the buckets only


class Lines(NamedTuple):
    """Series over time.

    Attributes
    ----------
    times : [s], shape (n,).
    values : by entity path, each of shape (n,) or (n, k).
    """

    times: np.ndarray
    values: dict[str, np.ndarray]


class Thinned(NamedTuple):
    """What is left of series.

    Attributes
    ----------
    lines : every row where all is kept, and the means of buckets, at their middles, elsewhere; in order of time.
    ranges : lowest and highest value of each bucket of a single series, shape (buckets, 2), at the buckets' middles.
    """

    lines: Lines
    ranges: Lines


def bucket_for(interval: float, duration: float | None) -> float | None:
    """Return the length of a bucket [s] for rows every ``interval`` [s] over ``duration`` [s] (None: unknown); None where all is kept."""
    if duration is None:
        return max(_BUCKET_WITHOUT_END, 2 * _LEAST_ROWS * interval)
    if duration <= FULL_ROWS * interval:
        return None
    return max(duration / _BUCKETS, _LEAST_ROWS * interval)


def _all_of(lines: Lines) -> Thinned:
    return Thinned(lines, Lines(lines.times[:0], {}))


class Overview:
    """Thins out the series of one run.

    Parameters
    ----------
    bucket : length of a bucket [s].
    full_rows : so many rows at the beginning are kept in full.
    """

    def __init__(self, bucket: float, full_rows: int = 0):
        self._bucket = bucket
        self._whole = full_rows  # rows that are still kept in full
        self._allowed = _ROWS_AROUND_EVENTS
        self._marks: list[float] = []
        self._waiting: list[Lines] = []  # not decided yet: an event may follow
        self._decided: list[Thinned] = []  # not handed on yet: too few

    def mark(self, time: float) -> None:
        """Keep in full what lies around an event at ``time`` [s]."""
        self._marks.append(time)

    def add(self, lines: Lines) -> Thinned | None:
        """Take in rows that follow those before; return what is decided by now, once it is enough to be worth sending."""
        if self._whole > 0:
            self._whole -= len(lines.times)
            return _all_of(lines)
        self._waiting.append(lines)
        newest, oldest = float(lines.times[-1]), float(self._waiting[0].times[0])
        limit = np.floor((newest - AROUND) / self._bucket) * self._bucket
        if limit - oldest > max(AROUND, 8 * self._bucket):
            self._decided.append(self._decide(limit))
        return self._handed_on() if sum(len(part.lines.times) for part in self._decided) >= _PIECE else None

    def finish(self) -> Thinned | None:
        """Return what is left of the rows that waited."""
        if self._waiting:
            self._decided.append(self._decide(np.inf))
        return self._handed_on() if self._decided else None

    def _handed_on(self) -> Thinned:
        parts, self._decided = self._decided, []
        ranges = [part.ranges for part in parts if len(part.ranges.times)]
        return Thinned(_joined([part.lines for part in parts]), _joined(ranges) if ranges else parts[0].ranges)

    def _decide(self, limit: float) -> Thinned:
        whole = _joined(self._waiting)
        count = int(np.searchsorted(whole.times, limit))
        decided, rest = _cut(whole, slice(0, count)), _cut(whole, slice(count, None))
        self._waiting = [rest] if len(rest.times) else []
        kept = self._around_events(decided.times)
        full, thin = _cut(decided, kept), _cut(decided, ~kept)
        if not len(thin.times):
            return _all_of(full)
        numbers = np.floor(thin.times / self._bucket)
        starts = np.flatnonzero(np.diff(numbers, prepend=np.nan) != 0)
        middles = (numbers[starts] + 0.5) * self._bucket
        middles = np.clip(middles, thin.times[starts], thin.times[np.append(starts[1:], len(thin.times)) - 1])  # of buckets that events cut
        means = {path: _bucket_means(values, starts) for path, values in thin.values.items()}
        ranges = {
            path: np.stack((np.fmin.reduceat(values, starts), np.fmax.reduceat(values, starts)), axis=1)
            for path, values in thin.values.items()
            if values.ndim == 1
        }
        return Thinned(_in_order(full, Lines(middles, means)), Lines(middles, ranges))

    def _around_events(self, times: np.ndarray) -> np.ndarray:
        """Return which rows lie around an event, shape (n,)."""
        kept = np.zeros(len(times), bool)
        if not len(times):
            return kept
        for mark in self._marks:
            first, end = np.searchsorted(times, (mark - AROUND, mark + AROUND))
            if end - first <= self._allowed:
                self._allowed -= int(np.count_nonzero(~kept[first:end]))
                kept[first:end] = True
        self._marks = [mark for mark in self._marks if mark + AROUND > times[-1]]
        return kept


def _joined(parts: list[Lines]) -> Lines:
    return Lines(
        np.concatenate([part.times for part in parts]), {path: np.concatenate([part.values[path] for part in parts]) for path in parts[0].values}
    )


def _cut(lines: Lines, which) -> Lines:
    return Lines(lines.times[which], {path: values[which] for path, values in lines.values.items()})


def _in_order(one: Lines, other: Lines) -> Lines:
    if not len(one.times):
        return other
    both = _joined([one, other])
    return _cut(both, np.argsort(both.times, kind="stable"))


def _bucket_means(values: np.ndarray, starts: np.ndarray) -> np.ndarray:
    """Return the mean of the known values from each start to the next; NaN where none is known."""
    known = np.isfinite(values)
    sums = np.add.reduceat(np.where(known, values, 0.0), starts, axis=0, dtype=float)
    counts = np.add.reduceat(known, starts, axis=0, dtype=float)
    return np.divide(sums, counts, out=np.full(sums.shape, np.nan), where=counts > 0)


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


def send_columns(recording: rr.RecordingStream, lines: Lines, named: Callable[[str], str] = str) -> None:
    """Send series, each in one piece, under the entity paths that ``named`` makes of theirs; those of bands have both edges."""
    if not len(lines.times):
        return
    index = [rr.TimeColumn(TIMELINE, duration=lines.times)]
    for path, values in lines.values.items():
        if path.endswith("/band"):
            columns = rr.Measurements.columns(values=values.mean(axis=1), variances=(0.5 * (values[:, 1] - values[:, 0])) ** 2)
        else:
            columns = rr.Scalars.columns(scalars=values.astype(np.float32))
        recording.send_columns(named(path), indexes=index, columns=columns)


def send_thinned(recording: rr.RecordingStream, thinned: Thinned) -> None:
    """Send what is left of series: lines and ranges."""
    send_columns(recording, thinned.lines)
    send_columns(recording, thinned.ranges, range_path)


def describe_range(recording: rr.RecordingStream, path: str, name: str, colour: tuple[int, int, int, int]) -> None:
    """Log names and colour of the lowest and highest values beside a series in a long run."""
    names = [f"{name}, lowest", f"{name}, highest"]
    recording.log(range_path(path), rr.SeriesLines(names=names, colors=[dim(colour)] * 2, widths=[1.0, 1.0]), static=True)


def log_event(recording: rr.RecordingStream, event: Event) -> None:
    """Log an event at its own time."""
    recording.set_time(TIMELINE, duration=float(event.time))
    recording.log("/log", rr.TextLog(f"{event.text}  [{event.kind}]", level=LOG_LEVELS[Level(event.level)]))


_MOST_OF_A_PASSAGE = 256  # samples


class PassageLoads:
    """The largest roller loads while one roller takes the place of the next.

    Those since the sample before swing with the places of the rollers, where samples are finer than that.

    Parameters
    ----------
    count : number of rollers.

    Attributes
    ----------
    rows : largest load on the inner and the outer raceway [N] at the newest samples, shape (n, 2).
    """

    def __init__(self, count: int):
        self._count = count
        self._tail = np.empty((0, 1 + len(RINGS)))  # time and loads
        self.rows = self._tail[:, 1:]

    def add(self, block: np.ndarray) -> np.ndarray:
        """Add the samples of a block, and return ``rows`` at them."""
        if not len(block):
            return self.rows[:0]
        known = np.concatenate((self._tail, np.stack([block["time"], *(largest_loads(block, ring) for ring in RINGS)], axis=1)))
        interval = float(np.median(np.diff(known[:, 0]))) if len(known) > 1 else math.inf
        passages = self._count * float(np.median(np.abs(block["cage_speed"]))) * interval / (2 * math.pi)  # from sample to sample
        size = min(math.ceil(1.0 / passages) + 1, _MOST_OF_A_PASSAGE) if 0.0 < passages < 1.0 else 1
        padded = np.concatenate((np.repeat(known[:1, 1:], size - 1, axis=0), known[:, 1:]))
        self.rows = np.lib.stride_tricks.sliding_window_view(padded, size, axis=0).max(axis=-1)[-len(block) :]
        self._tail = known[-_MOST_OF_A_PASSAGE:]
        return self.rows


class RunSeries:
    """Series of one run into one recording.

    Parameters
    ----------
    recording : rerun.RecordingStream.
    scene : whose thresholds are drawn and whose bearing is described.
    thin : whether a long run is thinned out (see `bearing_sim.view.plots`); for files.
    duration : simulated time that will come [s], where known.

    Attributes
    ----------
    measured : what was drawn of `bearing_sim.messages.topics.MEASURED_CHANNELS`.
    bucket : length of the buckets that a long run is thinned out to [s]; None where all is kept.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene, thin: bool = False, duration: float | None = None):
        self._recording = recording
        self._scene = scene
        self._thin, self._duration = thin, duration
        self._overview: Overview | None = None
        self._measured_overviews: dict[str, Overview] = {}  # by channel
        self._chosen = False  # whether it is known if the run is thinned out
        self._regime, self._level = "", math.nan
        self._plotted, self._latest = (PassageLoads(scene.bearing.roller.count) for _ in range(2))
        self._ranges: dict[str, tuple[float, float]] = {}  # lowest and highest value so far, by entity path
        self._slip_ranges: dict[int, tuple[float, float]] = {}  # the same for the slip, by octave of the shaft speed
        self._waiting: dict[str, list[tuple[float, ...]]] = {}  # time and numbers of measurements, by channel
        self._newest: list[np.ndarray] = []  # the last two blocks written: measurements come before or after those of their times
        self._started: float | None = None
        self.bucket: float | None = None
        self.measured: set[str] = set()

    def describe(self) -> None:
        """Log names, colours and texts that hold for the whole run."""
        for path, row in LINES.items():
            line = rr.SeriesLines(names=[row.name], colors=[row.colour], widths=[row.width], aggregation_policy=row.pixel or "Average")
            self._recording.log(path, line, static=True)
        count, present = self._scene.bearing.roller.count, features(self._scene)
        around = colours.load_palette(count)
        for path, row in SERIES.items():
            if row.kind == "each roller" and row.needs in present:
                names = [f"{row.name} {j + 1}" for j in range(count)]
                self._recording.log(path, rr.SeriesLines(names=names, colors=around, widths=np.full(count, row.width)), static=True)
        self._describe_lane("/regime", REGIMES)
        fallen = {_level_state(level, self._scene.level): _FALLEN for level in LEVELS if level != self._scene.level}
        self._describe_lane("/level", {self._scene.level: _LEVEL_COLOURS[self._scene.level]} | fallen)

    def _describe_lane(self, path: str, states: dict[str, int]) -> None:
        configuration = rr.StateConfiguration(values=list(states), labels=list(states), colors=np.array(list(states.values()), np.uint32))
        self._recording.log(path, configuration, static=True)

    def write(self, block: np.ndarray) -> None:
        """Send the columns of a block, in one piece per series."""
        self._started = float(block["time"][0]) if self._started is None else self._started
        values = series(self._scene, block)
        values |= {f"/loads/{ring}_largest": column for ring, column in zip(RINGS, self._plotted.add(block).T)}
        lines = Lines(block["time"], {path: plottable(rows) for path, rows in values.items()})
        for path, rows in lines.values.items():
            _widen(self._ranges, path, rows)
        self._note_slip(block["shaft_speed"], lines.values["/slip/cage"])
        self._choose_thinning(block["time"])
        self._send(lines, self._overview)
        self._write_lanes(block)
        self._newest = [*self._newest[-1:], block]
        self._write_measured()

    def note_measurement(self, time: float, cage_speed: float, residual: float) -> None:
        """Take a measured cage speed [rad/s] and its residual slip (see `bearing_sim.view.sink`); written with the next block."""
        self._waiting.setdefault(MEASURED, []).append((time, cage_speed, residual))

    def note_clearance(self, time: float, clearance: float) -> None:
        """Take a measured running clearance [m]; written with the next block."""
        self._waiting.setdefault(MEASURED_CLEARANCE, []).append((time, clearance))

    def finish(self) -> None:
        """Send what waits, and mark the end of the run."""
        self._write_measured()
        for overview in self._overviews:
            self._send_thinned(overview.finish())
        if self._newest:
            last = float(self._newest[-1]["time"][-1])
            self._send_level(END, np.array([last + 0.07 * (last - self._started)]), math.nan)

    def _choose_thinning(self, times: np.ndarray) -> None:
        """Choose at the first block with an interval in it whether, and how, the run is thinned out."""
        if self._chosen or not self._thin or len(times) < 2:
            return
        self._chosen = True
        self.bucket = bucket = bucket_for(float(np.median(np.diff(times))), self._duration)
        if bucket is not None:
            whole = FULL_ROWS if self._duration is None else 0
            self._overview = Overview(bucket, whole)
            self._measured_overviews = {channel: Overview(bucket, whole) for channel in MEASURED_CHANNELS}
            self._keep_around(float(times[0]))
            for path, row in LINES.items():
                describe_range(self._recording, path, row.name, row.colour)

    def _send(self, lines: Lines, overview: Overview | None) -> None:
        """Send series, or in a long run what is left of them by now."""
        self._send_thinned(_all_of(lines) if overview is None else overview.add(lines))

    def _send_thinned(self, thinned: Thinned | None) -> None:
        if thinned is None:
            return
        send_thinned(self._recording, thinned)
        if "/slip/cage" in thinned.lines.values and len(thinned.lines.times):
            self._write_thresholds(thinned.lines.times[[0, -1]])

    def _write_measured(self) -> None:
        if not self._newest:
            return
        waiting, self._waiting = self._waiting, {}
        for channel, readings in waiting.items():
            rows = np.array(readings)
            rows = rows[np.argsort(rows[:, 0], kind="stable")]
            values = self._cage_lines(rows) if channel == MEASURED else self._clearance_lines(rows)
            self._send(Lines(rows[:, 0], {path: plottable(column) for path, column in values.items()}), self._measured_overviews.get(channel))
            self.measured.add(channel)

    def _cage_lines(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Return what is plotted of a measured cage's times, speeds and residuals, shape (n, 3), by entity path."""
        lines = measured_series(*rows.T, np.concatenate(self._newest), self._scene.thresholds.slip_from_speed)
        for path, column in lines.items():
            _widen(self._ranges, path, column)
        self._send_level("/slip/no_residual", rows[[0, -1], 0], 0.0)
        return lines

    def _clearance_lines(self, rows: np.ndarray) -> dict[str, np.ndarray]:
        """Return what is plotted of the times and values of a measured clearance, shape (n, 2), by entity path."""
        lines = {"/clearance/measured": 1e6 * rows[:, 1]}
        _widen(self._ranges, "/clearance/measured", lines["/clearance/measured"])
        return lines

    def _write_thresholds(self, ends: np.ndarray) -> None:
        for path, value in threshold_lines(self._scene).items():
            self._send_level(path, ends, value)
            _widen(self._ranges, path, np.array([value]))

    def _send_level(self, path: str, ends: np.ndarray, value: float) -> None:
        send_columns(self._recording, Lines(ends, {path: np.full(len(ends), value)}))

    def _note_slip(self, speeds: np.ndarray, slips: np.ndarray) -> None:
        octaves = np.floor(np.log2(np.maximum(np.abs(speeds), 1e-3)))
        for octave in np.unique(octaves):
            _widen(self._slip_ranges, int(octave), slips[octaves == octave])

    def ranges(self) -> dict[str, tuple[float, float]]:
        """Return lowest and highest value of each series so far, by entity path.

        Those of the slip are what its axis needs: a start lasts a moment and may have much more slip than the rest of the run, which would then be
        a flat line; what lies below a good tenth of the highest speed is drawn, but does not choose the axis.
        """
        fast = [span for octave, span in self._slip_ranges.items() if octave >= max(self._slip_ranges) - 3]
        slip = {"/slip/cage": (min(low for low, _ in fast), max(high for _, high in fast))} if fast else {}
        return self._ranges | slip

    def _write_lanes(self, block: np.ndarray) -> None:
        limits = self._scene.thresholds
        slips = np.where(turns(block["shaft_speed"], limits.slip_from_speed), block["cage_slip"], np.nan)
        for time, slip, level in zip(block["time"].tolist(), slips.tolist(), block["level"].tolist()):
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
        for overview in self._overviews:
            overview.mark(time)

    @property
    def _overviews(self) -> list[Overview]:
        return [] if self._overview is None else [self._overview, *self._measured_overviews.values()]

    def write_event(self, event: Event) -> None:
        """Log an event at its own time."""
        log_event(self._recording, event)
        self._keep_around(event.time)

    def follow(self, samples: np.ndarray) -> None:
        """Take the samples up to the next readout, whether they are drawn or not; they are written besides."""
        self._latest.add(samples)

    def write_readout(self, sample: np.void, dropped: int) -> None:
        """Log the numbers of one sample as text at the recording's present time."""
        limits, (basic, modified) = self._scene.thresholds, self._scene.life.symbols
        counted = ("rating_life", basic) if self._scene.life.is_basic else ("modified_rating_life", modified)
        slip = float(sample["cage_slip"]) if turns(sample["shaft_speed"], limits.slip_from_speed) else math.nan
        load = math.hypot(sample["load_y"], sample["load_z"])
        inner, outer = self._latest.rows[-1] if len(self._latest.rows) else (math.nan, math.nan)
        lines = [  # in the order of their importance: what a small window has no room for stands last
            ("cage slip", f"**{quantity_text('cage_slip', slip)}**" if math.isfinite(slip) else "none (at rest)"),
            (f"life, {counted[1]}", f"**{_life_text(sample[counted[0]])}**"),
            ("largest roller load", quantity_text("inner_load_maximum", inner)),
            _readout("shaft_speed", sample),
            ("radial load", quantity_text("radial_load", load)),
            _readout("oil_temperature", sample),
            ("cage", section.regime(slip, limits.slip_warning, limits.slip_error)),
            _readout("cage_speed", sample),
            _readout("running_clearance", sample),
            *self._further_readout(sample),
            ("life used", f"{number(1e6 * float(sample['damage']), 3)} ppm"),
            ("load, outer raceway", quantity_text("outer_load_maximum", outer)),
            ("rollers under load", f"{np.count_nonzero(sample['inner_load'] > 0)} of {len(sample['inner_load'])}"),
            ("level", _level_state(level_of(sample), self._scene.level)),
        ]
        if dropped:
            lines.insert(0, ("not shown", f"{dropped} blocks dropped"))
        head, *rest = (f"| {name} | {value} |" for name, value in lines)
        self._recording.log("/now", rr.TextDocument("\n".join([head, "|---|---|", *rest]), media_type=rr.MediaType.MARKDOWN))

    def _further_readout(self, sample: np.void) -> list[tuple[str, str]]:
        """Return the readout's lines that only some scenes have."""
        lines = []
        if not self._scene.life.is_basic:
            lines.append((f"without oil, {self._scene.life.symbols[0]}", _life_text(sample["rating_life"])))
        compared = compared_life(self._scene)
        lines.append((LIFE_SYMBOLS[compared], _life_text(sample[compared])))
        if self._scene.bodies_tilt:
            edge, largest = (1e-6 * max(float(sample[f"{ring}_{kind}"]) for ring in RINGS) for kind in ("edge_pressure", "pressure"))
            tilt, skew = (1e3 * float(np.abs(sample[name]).max()) for name in ("roller_tilt", "roller_skew"))
            known = math.isfinite(largest + edge), math.isfinite(tilt + skew)  # an older recording holds neither
            lines.append(("pressure", f"{largest:.0f} MPa, ends {edge:.0f} MPa" if known[0] else "unknown"))
            lines.append(("most tilt, skew", f"{tilt:.2f}, {skew:.2f} mrad" if known[1] else "unknown"))
        return lines

    def write_dropped(self, time: float, dropped: int) -> None:
        """Log how many blocks the view has missed so far."""
        self._recording.set_time(TIMELINE, duration=time)
        self._recording.log("/sink/dropped", rr.Scalars(float(dropped)))
        text = f"the view has dropped {dropped} blocks so far because it is slower than the simulation; the simulation itself is not affected"
        self._recording.log("/log", rr.TextLog(text, level=rr.TextLogLevel.WARN))


def _readout(name: str, sample: np.void) -> tuple[str, str]:
    """Return name and value of an observable in words."""
    return shown(name).name, quantity_text(name, float(sample[name]))


def _level_state(level: str, wanted: str) -> str:
    return level if level == wanted else f"{level}, not {wanted}"


def _widen(ranges: dict, key, values: np.ndarray) -> None:
    """Widen a range so that it holds all finite values."""
    finite = values[np.isfinite(values)]
    if finite.size:
        low, high = ranges.get(key, (np.inf, -np.inf))
        ranges[key] = min(low, float(finite.min())), max(high, float(finite.max()))


def _life_text(life: float) -> str:
    return quantity_text("rating_life", float(life))
