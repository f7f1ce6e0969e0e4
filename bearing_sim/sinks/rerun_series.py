# Copyright 2026 the bearing_sim maintainers. SPDX-License-Identifier: Apache-2.0
"""Series of the view: numbers over time as columns, regime lane, log, and the texts beside them."""

import math

import numpy as np
import rerun as rr

from bearing_sim.effects import level_of
from bearing_sim.events import Event, Level
from bearing_sim.scene import Scene
from bearing_sim.sinks import colours, section
from bearing_sim.sinks.rerun_power import CAUSES

TIMELINE = "sim_time"
RPM = 30 / math.pi
ZERO_CELSIUS = 273.15
ENDLESS = 1e7  # [h]; a bearing that hardly turns has a life of 1e30 h, which would flatten everything else
REGIMES = {
    "at rest": 0x4A4F5AFF,
    "rolling": 0x0A7F62FF,
    "slipping": 0xC99A00FF,
    "skidding": 0xC8501AFF,
    "overrunning": 0x8A5A8FFF,
}
_LOG_LEVELS = {Level.OK: rr.TextLogLevel.INFO, Level.WARN: rr.TextLogLevel.WARN, Level.ERROR: rr.TextLogLevel.ERROR}

_LINES = {
    "/speed/shaft": ("shaft", colours.BLUE, 2.0),
    "/speed/cage": ("cage", colours.ORANGE, 2.5),
    "/speed/ideal_cage": ("cage without slip", colours.GREY, 1.5),
    "/slip/cage": ("cage slip", colours.BLUE, 2.5),
    "/slip/warning": ("warning", colours.YELLOW, 1.0),
    "/slip/error": ("error", colours.VERMILION, 1.0),
    "/life/log10_hours": ("life", colours.GREEN, 2.5),
    "/life/lamina_log10_hours": ("lamina life", colours.BLUE, 2.0),
    "/life/chosen_log10_hours": ("life by the scene's choice", colours.PURPLE, 2.0),
    "/life/warning": ("warning", colours.YELLOW, 1.0),
    "/damage/ppm": ("damage", colours.PURPLE, 2.5),
    "/load/radial": ("radial load", colours.YELLOW, 2.0),
    "/oil/temperature": ("oil", colours.VERMILION, 2.0),
    "/loads/inner_largest": ("inner, largest", colours.BLUE, 2.0),
    "/loads/outer_largest": ("outer, largest", colours.VERMILION, 2.0),
    "/cage/eccentricity": ("cage eccentricity e/c", colours.ORANGE, 2.0),
    "/loads/pocket_largest": ("on a roller by its pocket, largest", colours.PURPLE, 2.0),
    "/pressure/inner": ("inner, largest", colours.BLUE, 2.0),
    "/pressure/outer": ("outer, largest", colours.VERMILION, 2.0),
    "/pressure/inner_edge": ("inner, end slices", colours.WHITE, 1.0),
    "/pressure/outer_edge": ("outer, end slices", colours.YELLOW, 1.0),
    "/tilt/ring_y": ("ring towards y", colours.BLUE, 2.0),
    "/tilt/ring_z": ("ring towards z", colours.GREEN, 2.0),
    "/tilt/cage_y": ("cage towards y", colours.ORANGE, 2.0),
    "/tilt/cage_z": ("cage towards z", colours.YELLOW, 2.0),
    "/sink/dropped": ("blocks dropped", colours.WHITE, 1.5),
} | {f"/power/{cause}": (name, colour, 2.0) for cause, (name, colour) in CAUSES.items()}

_AGGREGATION = {
    "/loads/pocket_largest": "Max",
    "/loads/inner_largest": "Max",
    "/loads/outer_largest": "Max",
    "/slip/cage": "Max",
}  # where many samples share a pixel


def plottable(values) -> np.ndarray:
    """Return float32 values with NaN, a gap in a plot, wherever there is no finite number."""
    values = np.asarray(values, np.float64)
    return np.where(np.isfinite(values), values, np.nan).astype(np.float32)


def log10_hours(life) -> np.ndarray:
    """Return log10 of a life in hours, NaN where it is endless (more than `ENDLESS`), zero or unknown."""
    life = np.asarray(life, np.float64)
    return np.log10(life, where=(life > 0) & (life <= ENDLESS), out=np.full(life.shape, np.nan))


def series(block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted of a block, in the units that people read, by entity path."""
    return {
        "/speed/shaft": RPM * block["shaft_speed"],
        "/speed/cage": RPM * block["cage_speed"],
        "/speed/ideal_cage": RPM * block["ideal_cage_speed"],
        "/slip/cage": 100 * block["cage_slip"],
        "/life/log10_hours": log10_hours(block["rating_life"]),
        "/life/hours": block["rating_life"],
        "/damage/ppm": 1e6 * block["damage"],
        "/load/radial": np.hypot(block["load_y"], block["load_z"]),
        "/oil/temperature": block["oil_temperature"] - ZERO_CELSIUS,
        "/loads/inner_largest": block["inner_load"].max(axis=1),
        "/loads/outer_largest": block["outer_load"].max(axis=1),
        "/loads/pocket_largest": np.abs(block["pocket_force"]).max(axis=1),
        "/loads/each/inner": block["inner_load"],
        "/loads/each/outer": block["outer_load"],
        "/loads/each/pocket": block["pocket_force"],
        "/cage/eccentricity": block["land_eccentricity"],
    } | {f"/power/{cause}": block[f"{cause}_power"] for cause in CAUSES}


def further_series(scene: Scene, block: np.ndarray) -> dict[str, np.ndarray]:
    """Return what is plotted besides `series` because only some scenes have it: lives, tilts, pressures by slices."""
    lines = {}
    if not scene.life.is_basic:
        lines["/life/chosen_log10_hours"] = log10_hours(block["modified_rating_life"])
    if scene.bodies_tilt:
        lines["/life/lamina_log10_hours"] = log10_hours(block["lamina_life"])
        lines |= {f"/tilt/{body}_{axis}": 1e3 * block[f"{body}_tilt_{axis}"] for body in ("ring", "cage") for axis in "yz"}
        lines |= {f"/tilt/each/{name}": 1e3 * block[f"roller_{name}"] for name in ("tilt", "skew")}
        lines |= {f"/pressure/{place}": 1e-6 * block[f"{place}_pressure"] for place in ("inner", "outer", "inner_edge", "outer_edge")}
    return lines


class RunSeries:
    """Series of one run into one recording.

    Parameters
    ----------
    recording : rerun.RecordingStream.
    scene : whose thresholds are drawn and whose bearing is described.
    """

    def __init__(self, recording: rr.RecordingStream, scene: Scene):
        self._recording = recording
        self._scene = scene
        self._regime = ""
        self._ranges: dict[str, tuple[float, float]] = {}  # lowest and highest value so far, by entity path
        self._slip_ranges: dict[int, tuple[float, float]] = {}  # the same for the slip, by octave of the shaft speed

    def describe(self) -> None:
        """Log names, colours and texts that hold for the whole run."""
        for path, (name, colour, width) in _LINES.items():
            line = rr.SeriesLines(names=[name], colors=[colour], widths=[width], aggregation_policy=_AGGREGATION.get(path, "Average"))
            self._recording.log(path, line, static=True)
        count = self._scene.bearing.roller.count
        around = colours.load_palette(count)
        for force in ("inner", "outer", "pocket"):
            names = [f"{force} {j + 1}" for j in range(count)]
            self._recording.log(f"/loads/each/{force}", rr.SeriesLines(names=names, colors=around, widths=np.full(count, 1.0)), static=True)
        for name in ("tilt", "skew") if self._scene.bodies_tilt else ():
            names = [f"{name} {j + 1}" for j in range(count)]
            self._recording.log(f"/tilt/each/{name}", rr.SeriesLines(names=names, colors=around, widths=np.full(count, 1.0)), static=True)
        states = rr.StateConfiguration(values=list(REGIMES), labels=list(REGIMES), colors=np.array(list(REGIMES.values()), np.uint32))
        self._recording.log("/regime", states, static=True)

    def write(self, block: np.ndarray) -> None:
        """Send the columns of a block, in one piece per series."""
        index = [rr.TimeColumn(TIMELINE, duration=block["time"])]
        for path, values in (series(block) | further_series(self._scene, block)).items():
            self._send(path, index, plottable(values))
        self._note_slip(block)
        self._write_thresholds(block["time"][[0, -1]])
        self._write_regimes(block)

    def _write_thresholds(self, ends: np.ndarray) -> None:
        limits = self._scene.thresholds
        lines = {
            "/slip/warning": 100 * limits.slip_warning,
            "/slip/error": 100 * limits.slip_error,
            "/life/warning": float(log10_hours(limits.life_warning)),
        }
        index = [rr.TimeColumn(TIMELINE, duration=ends)]
        for path, value in lines.items():
            self._send(path, index, np.full(2, value, np.float32))

    def _send(self, path: str, index: list[rr.TimeColumn], values: np.ndarray) -> None:
        self._recording.send_columns(path, indexes=index, columns=rr.Scalars.columns(scalars=values))
        _widen(self._ranges, path, values)

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

    def _write_regimes(self, block: np.ndarray) -> None:
        limits = self._scene.thresholds
        for time, slip in zip(block["time"], block["cage_slip"]):
            now = section.regime(float(slip), limits.slip_warning, limits.slip_error, self._regime)
            if now != self._regime:
                self._regime = now
                self._recording.set_time(TIMELINE, duration=float(time))
                self._recording.log("/regime", rr.StateChange(state=now))

    def write_event(self, event: Event) -> None:
        """Log an event at its own time."""
        self._recording.set_time(TIMELINE, duration=float(event.time))
        self._recording.log("/log", rr.TextLog(f"{event.text}  [{event.code}]", level=_LOG_LEVELS[Level(event.level)]))

    def write_readout(self, sample: np.void, dropped: int) -> None:
        """Log the numbers of one sample as text at the recording's present time."""
        limits = self._scene.thresholds
        slip, life = float(sample["cage_slip"]), float(sample["rating_life"])
        lines = [
            ("level", level_of(sample)),
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


_WHIRL = """The cage's displacement and its {play} have a factor of their own, which the title says; cage orbit: the place of
its centre in the {play}{seen} and its path in the last turns, dots where samples are too far apart for a line.
"""
_GUIDES = {"outer_ring": "green: guide land on the outer ring. ", "inner_ring": "green: guide land on the inner ring. ", "roller": ""}


def _whirl(scene: Scene) -> str:
    if not scene.cage_whirls:
        return ""
    cage = scene.bearing.cage
    seen = ", seen from the inner ring's centre," if cage.guidance == "inner_ring" else ""
    return _WHIRL.format(play="guide clearance" if cage.has_lands else "play in the pockets that guide it", seen=seen)


_TILTS = """The solid picture draws tilts of ring and rollers and skews by factors of their own, which its title says, and the cage's tilt by
the cage's factor. Pressures are Hertz's of slices, largest
of all rollers; those of the end slices say how hard edges press, without the rise at a sharp edge.
"""


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

**Oil** {oil.oil.name}, {oil.temperature - ZERO_CELSIUS:g} °C at the start, {100 * oil.mixture_fraction:g} % in the air,
traction law {oil.traction.law}.

**Level** {scene.level}.

**Picture**: bodies to scale; every radial departure from the ideal bearing (lobes, play, elastic approach, ring displacement)
is drawn x{factor}. Seen against the x axis: Y right, Z up; azimuth runs from +Y towards +Z. Red line: outer raceway; dashed: ideal
round raceway; {_GUIDES[bearing.cage.guidance]}Rollers are coloured by inner contact load, grey ones carry none. Arrows at the raceways: contact
forces on the rings, full scale of the colours = longest; yellow: radial load on the inner ring, twice that scale as far as there is room.
The orange cage bar and the white marks show rotation. Purple arrows: forces of the pockets on the rollers, scale in the middle.
{_whirl(scene)}{_TILTS if scene.bodies_tilt else ""}
**Power** by cause: what the shaft puts in by the tractions on the inner ring, the mixture in the cage's bore and guide lands of its own is lost, or
stored for a moment in motion and elastic contacts; the bars are means of the newest samples.

**Thresholds**: slip {100 * limits.slip_warning:g} % warning, {100 * limits.slip_error:g} % error; life below {limits.life_warning:g} h warning.

**Loads** are those of the sampled instants: at constant speed samples may meet the rollers in the same places again and
again, and then the largest load changes with the speed while the bearing's does not.
"""
